//! The comparison for a terminal, at most a hundred columns wide.

use std::fmt::Write as _;

use super::digits::{short, significant};
use super::summary::{
    AGAINST, CONTRAST, DISSIPATED, FOCAL, GAIN, Line, PROTECTED, PROTECTION, Quantity, lines, worst_residual,
};
use crate::outcome::{Outcome, Scores};
use crate::target::Focus;

const COLUMNS: [&Quantity; 7] = [&FOCAL, &PROTECTED, &CONTRAST, &GAIN, &PROTECTION, &AGAINST, &DISSIPATED];

/// Longest name that keeps the table within a hundred columns.
const NAME: usize = 18;
/// Width of a terminal that any reader has (columns).
const WIDTH: usize = 100;

/// The comparison as aligned columns with what they mean below; ends with a line feed.
///
/// ```text
/// arrangement         spheres        F (J)  ...
/// lens                    139        0.331  ...
/// random-lens-rows      102±8  0.264±0.026  ...
/// ```
pub fn table(outcome: &Outcome) -> String {
    let lines = lines(outcome);
    let head: Vec<String> =
        ["arrangement", "spheres"].into_iter().chain(COLUMNS.iter().map(|c| c.head)).map(str::to_owned).collect();
    let rows: Vec<Vec<String>> = std::iter::once(head).chain(lines.iter().map(row)).collect();
    let widths: Vec<usize> =
        (0..rows[0].len()).map(|k| rows.iter().map(|row| row[k].chars().count()).max().unwrap_or(0)).collect();
    // Two spaces between columns where they fit.
    let gap = if widths.iter().sum::<usize>() + 2 * (widths.len() - 1) <= WIDTH { "  " } else { " " };
    let mut text = String::new();
    for row in &rows {
        let mut line = format!("{:<width$}", row[0], width = widths[0]);
        for (cell, width) in row.iter().zip(&widths).skip(1) {
            let _ = write!(line, "{gap}{cell:>width$}");
        }
        let _ = writeln!(text, "{}", line.trim_end());
    }
    text.push('\n');
    let protect = &outcome.target.protect;
    let span = |x: [f64; 2]| {
        let [from, to] = x.map(|x| short(x / outcome.diameter));
        format!("x {from} to {to} D")
    };
    let foci: Vec<String> = outcome
        .target
        .foci
        .iter()
        .map(|Focus { region, .. }| format!("rows {}-{}, {}", region.rows[0], region.rows[1], span(region.x)))
        .collect();
    let _ = writeln!(
        text,
        "F, P: mean over the focal ({}) and the protected region\n(rows {}-{}, {}) of each sphere's greatest kinetic energy.",
        foci.join("; "),
        protect.rows[0],
        protect.rows[1],
        span(protect.x)
    );
    if outcome.target.foci.len() > 1 {
        text.push_str(&by_focus(&lines));
    }
    text.push_str("C = F/P; G = F/F(all-host); Q = P/P(all-lens); Plens/P: below 1 the lens protects better\nthan this arrangement; lost: dissipated in all contacts.\n");
    text.push_str("Spheres (those not of the host) and energies are those of the simulated half.\n");
    if let Some(seeds) = lines.iter().map(|line| line.members.len()).max().filter(|&n| n > 1) {
        let _ = writeln!(text, "±: standard deviation over {seeds} seeds.");
    }
    if let Some(residual) = worst_residual(outcome) {
        let _ = writeln!(text, "Energy ledger closes to {} of the work put in.", significant(residual, 2));
    }
    for warning in &outcome.warnings {
        let _ = writeln!(text, "warning: {warning}");
    }
    text
}

fn row(line: &Line) -> Vec<String> {
    let name = if line.name.chars().count() > NAME {
        line.name.chars().take(NAME - 1).chain(std::iter::once('…')).collect()
    } else {
        line.name.to_owned()
    };
    [name, line.spheres()].into_iter().chain(COLUMNS.iter().map(|column| line.show(column))).collect()
}

/// F of each focus and how evenly they are served, an arrangement a line.
fn by_focus(lines: &[Line]) -> String {
    let mut text =
        String::from("By focus, F of each (J), and balance: of these over their shares the least over the greatest:\n");
    for line in lines {
        let members = line.members.len().max(1) as f64;
        let foci = line.members.iter().map(|member| member.scores.foci.len()).min().unwrap_or(0);
        let mean = |of: &dyn Fn(&Scores) -> f64| line.members.iter().map(|m| of(&m.scores)).sum::<f64>() / members;
        let each: Vec<String> = (0..foci).map(|k| significant(mean(&|scores| scores.foci[k]), 3)).collect();
        let balance = significant(mean(&|scores| scores.balance.unwrap_or(0.0)), 2);
        let _ = writeln!(text, "  {:<NAME$} {}; {balance}", line.name, each.join(", "));
    }
    text
}
