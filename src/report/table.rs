//! The comparison for a terminal, at most a hundred columns wide.

use std::fmt::Write as _;

use super::digits::{short, significant};
use super::frame;
use super::summary::{
    AGAINST, CONTRAST, Column, DISSIPATED, FOCAL, GAIN, Line, PIECE, PROTECTED, PROTECTION, lines, worst_residual,
};
use super::svg::escape;
use super::verdict;
use crate::outcome::{Outcome, Scores, SpaceOutcome};
use crate::score::Measure;
use crate::target::{Focus, Region, SpaceRegion};

const COLUMNS: [&Column; 8] = [&PIECE, &FOCAL, &PROTECTED, &CONTRAST, &GAIN, &PROTECTION, &AGAINST, &DISSIPATED];

/// Longest name that keeps the table within a hundred columns.
const NAME: usize = 18;
/// Width of a terminal that any reader has (columns).
const WIDTH: usize = 100;

/// The verdict, then the comparison as aligned columns with what they mean below; ends with a line feed.
///
/// ```text
/// verdict over 8 forces from 25.7 kN to 26.3 kN; ...
///   C 2.44: better than flat-height (1.00 ±0.02), ...
///
/// arrangement         piece        F [J]  ...
/// lens                  278        0.331  ...
/// random-lens-rows    200±9  0.264±0.026  ...
/// ```
pub fn table(outcome: &Outcome) -> String {
    let span = |x: [f64; 2]| {
        let [from, to] = x.map(|x| short(x / outcome.diameter));
        format!("x {from} to {to} D")
    };
    let region = |region: &Region| format!("rows {}-{}, {}", region.rows[0], region.rows[1], span(region.x));
    let foci: Vec<String> = outcome.target.foci.iter().map(|Focus { region: of, .. }| region(of)).collect();
    const PIECE: &str =
        "The piece is both halves, its spheres those not of the host; energies are of the simulated half.\n";
    filled(outcome, [&foci.join("; "), &region(&outcome.target.protect)], PIECE)
}

/// The same in space, where strips of 1, 2, ... layers stand among the arrangements.
pub fn space_table(outcome: &SpaceOutcome) -> String {
    let region = |solid: &SpaceRegion| solid_words(solid, outcome.diameter);
    let foci: Vec<String> = outcome.target.foci.iter().map(|focus| region(&focus.region)).collect();
    const PIECE: &str =
        "The piece is the whole crystal, its spheres those not of the host; F and P are means over its spheres.\n";
    filled(outcome, [&foci.join("; "), &region(&outcome.target.protect)], PIECE)
}

/// The same for a page: the table, and what is below it line by line; the verdict is not among it.
pub(super) fn space_section(outcome: &SpaceOutcome) -> String {
    let rows = rows(&lines(outcome));
    let head: Vec<&str> = rows[0].iter().map(String::as_str).collect();
    let text = space_table(outcome);
    // Below the table is what follows its last row.
    let last = rows.last().map_or("", |row| &row[0]);
    let below = text.lines().skip_while(|line| !line.starts_with(last)).skip_while(|line| !line.is_empty());
    let notes: Vec<&str> = below.filter(|line| !line.is_empty()).collect();
    frame::table(&head, &rows[1..]) + &format!("<p class=\"quiet\">{}</p>\n", escape(&notes.join(" ")))
}

/// A region in space in words: `layers 15-17, r 0 to 1.5 D`.
pub fn solid_words(solid: &SpaceRegion, diameter: f64) -> String {
    let span = |x: [f64; 2]| {
        let [from, to] = x.map(|x| short(x / diameter));
        format!("{from} to {to} D")
    };
    match *solid {
        SpaceRegion::Box { layers: [a, b], x, y } => format!("layers {a}-{b}, x {}, y {}", span(x), span(y)),
        SpaceRegion::Cylinder { layers: [a, b], r } => format!("layers {a}-{b}, r {}", span(r)),
        SpaceRegion::Sphere { centre, radius } => {
            let [x, y, z] = centre.map(|x| short(x / diameter));
            format!("within {} D of x {x} D, y {y} D, depth {z} D", short(radius / diameter))
        }
    }
}

fn filled<S, R, P>(outcome: &Outcome<S, R, P>, [focal, protected]: [&str; 2], piece: &str) -> String {
    let lines = lines(outcome);
    let rows = rows(&lines);
    let widths: Vec<usize> =
        (0..rows[0].len()).map(|k| rows.iter().map(|row| row[k].chars().count()).max().unwrap_or(0)).collect();
    // Two spaces between columns where they fit.
    let gap = if widths.iter().sum::<usize>() + 2 * (widths.len() - 1) <= WIDTH { "  " } else { " " };
    let mut text = String::new();
    if !outcome.verdict.is_empty() {
        text.push_str(&wrapped(&format!("verdict over {}:", verdict::over(outcome)), ""));
        verdict::lines(outcome).iter().for_each(|line| text.push_str(&wrapped(line, "  ")));
        text.push('\n');
    }
    for row in &rows {
        let mut line = format!("{:<width$}", row[0], width = widths[0]);
        for (cell, width) in row.iter().zip(&widths).skip(1) {
            let _ = write!(line, "{gap}{cell:>width$}");
        }
        let _ = writeln!(text, "{}", line.trim_end());
    }
    text.push('\n');
    let _ = writeln!(
        text,
        "F, P: mean over the focal ({focal}) and the protected region\n({protected}) of each sphere's greatest kinetic energy.",
    );
    if outcome.target.foci.len() > 1 {
        text.push_str(&by_focus(&lines));
    }
    let reference = match &outcome.reference {
        Some(material) => format!("all-lens, flat strips and mixtures are of {material}"),
        None => "no Q, strips and mixtures: there is but one material".to_owned(),
    };
    let _ = writeln!(text, "C = F/P; G = F/F(all-host); Q = P/P(all-lens);\n{reference}.");
    text.push_str("Plens/P: below 1 the first protects better than this arrangement; lost: in all contacts.\n");
    text.push_str(piece);
    if let Some(seeds) = lines.iter().map(|line| line.members.len()).max().filter(|&n| n > 1) {
        let _ = writeln!(text, "±: standard deviation over {seeds} seeds.");
    }
    if let Some(residual) = worst_residual(outcome) {
        let _ = writeln!(text, "Energy ledger closes to {} of the work put in.", significant(residual, 2));
    }
    text.push_str(&wrapped(&outcome.manifest.method.words(), ""));
    for warning in &outcome.warnings {
        let _ = writeln!(text, "warning: {warning}");
    }
    text
}

/// The table's cells, its head first.
fn rows(lines: &[Line]) -> Vec<Vec<String>> {
    let head = |column: &&Column| match column.measure {
        Measure::PieceSpheres => "piece".to_owned(),
        _ => column.heading(),
    };
    let head: Vec<String> = std::iter::once("arrangement".to_owned()).chain(COLUMNS.iter().map(head)).collect();
    std::iter::once(head).chain(lines.iter().map(row)).collect()
}

/// A sentence within the width of a terminal, broken between words; what follows the first line stands further in.
fn wrapped(sentence: &str, indent: &str) -> String {
    let mut lines = vec![indent.to_owned()];
    for word in sentence.split(' ') {
        let line = lines.last().map_or(0, |line| line.chars().count());
        let first = lines.last().is_some_and(|line| line.trim().is_empty());
        if !first && line + 1 + word.chars().count() > WIDTH {
            lines.push(format!("{indent}  "));
        }
        if let Some(line) = lines.last_mut() {
            if !line.trim().is_empty() {
                line.push(' ');
            }
            line.push_str(word);
        }
    }
    lines.join("\n") + "\n"
}

fn row(line: &Line) -> Vec<String> {
    let name = if line.name.chars().count() > NAME {
        line.name.chars().take(NAME - 1).chain(std::iter::once('…')).collect()
    } else {
        line.name.to_owned()
    };
    std::iter::once(name).chain(COLUMNS.iter().map(|column| line.show(column))).collect()
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
