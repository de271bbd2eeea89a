//! Many impacts on beds: depth against speed with error bars, and the page about them.

use super::chart::{COLOURS, Chart, Line};
use super::frame::{Figure, Frame, Provenance, table};
use super::svg::escape;
use crate::bed::{Cell, Fitted, Scaling};
use crate::stats::Mean;

/// Half the width of the ends of an error bar, over the range of speeds.
const CAP: f64 = 0.008;

/// Mean depth at the end against speed, a line for each kind of friction, with the 95 % intervals of the means.
pub fn draw_ensemble(name: &str, cells: &[Cell]) -> String {
    let widest = cells.iter().map(|cell| cell.speed).fold(f64::MIN_POSITIVE, f64::max);
    let mut kinds = Vec::new();
    for cell in cells {
        if !kinds.contains(&cell.friction) {
            kinds.push(cell.friction);
        }
    }
    // Kinds stand a little beside one another, so that no interval hides another.
    let middle = 0.5 * (kinds.len() as f64 - 1.0);
    let mut lines = Vec::new();
    for (k, kind) in kinds.into_iter().enumerate() {
        let mut here: Vec<&Cell> = cells.iter().filter(|cell| cell.friction == kind).collect();
        here.sort_by(|a, b| a.speed.total_cmp(&b.speed));
        let place = |speed: f64| speed + 1.2 * (k as f64 - middle) * CAP * widest;
        let line = |name: &str, points: Vec<[f64; 2]>| Line {
            name: name.to_owned(),
            colour: COLOURS[k % COLOURS.len()].to_owned(),
            dashed: false,
            points,
        };
        for cell in &here {
            let (x, depth) = (place(cell.speed), cell.final_depth_d);
            let half = depth.interval.unwrap_or(0.0);
            let (low, high, cap) = (depth.mean - half, depth.mean + half, CAP * widest);
            lines.push(line("", vec![[x, low], [x, high]]));
            lines.push(line("", vec![[x - cap, low], [x + cap, low]]));
            lines.push(line("", vec![[x - cap, high], [x + cap, high]]));
        }
        lines.push(line(kind.name(), here.iter().map(|cell| [place(cell.speed), cell.final_depth_d.mean]).collect()));
    }
    let chart = Chart {
        title: format!("{name}: depth at the end, means of several beds with 95 % intervals"),
        labels: ["speed of the intruder (d/τ_c)".to_owned(), "depth below the surface (d)".to_owned()],
        lines,
    };
    chart.svg()
}

/// The page of an ensemble, complete in itself: what depth does with speed, the picture (`depth.svg`), the means of each kind of impact.
pub fn ensemble_page(name: &str, cells: &[Cell], scaling: &[Scaling], picture: &str, provenance: Provenance) -> String {
    let shown = |Mean { mean, interval, .. }: Mean| match interval {
        Some(interval) => format!("{mean:.2} \u{b1} {interval:.2}"),
        None => format!("{mean:.2}"),
    };
    let rows: Vec<Vec<String>> = cells
        .iter()
        .map(|cell| {
            let means = [cell.final_depth_d, cell.max_depth_d, cell.overshoot_d, cell.peak_force].map(shown);
            let own = [cell.friction.name().to_owned(), format!("{}", cell.speed), cell.samples.to_string()];
            own.into_iter().chain(means).chain([cell.stopped.to_string()]).collect()
        })
        .collect();
    let headings = [
        "friction",
        "speed (d/\u{3c4}_c)",
        "impacts",
        "depth at the end (d)",
        "greatest depth (d)",
        "overshoot (d)",
        "greatest force (m d/\u{3c4}_c\u{b2})",
        "stopped",
    ];
    let impacts: usize = cells.iter().map(|cell| cell.samples).sum();
    let deepest = cells.iter().max_by(|a, b| a.final_depth_d.mean.total_cmp(&b.final_depth_d.mean));
    let deepest = deepest.map_or(String::new(), |cell| {
        let depth = shown(cell.final_depth_d);
        format!(
            " Deepest at the end: <b>{depth} d</b>, {} friction at {} d/\u{3c4}_c.",
            escape(cell.friction.name()),
            cell.speed
        )
    });
    let exponent = |of: &str, fit: Option<Fitted>| {
        fit.map(|fit| format!("{of} to the power {:.2} \u{b1} {:.2}", fit.value, fit.interval))
    };
    let exponents = scaling.iter().filter_map(|Scaling { friction, by_speed, by_drop }| {
        let each = [exponent("speed", *by_speed), exponent("whole drop", *by_drop)];
        let each: Vec<String> = each.into_iter().flatten().collect();
        (!each.is_empty()).then(|| {
            format!("<p>{} friction: depth at the end as {}.</p>\n", escape(friction.name()), each.join(", as "))
        })
    });
    let exponents: String = exponents.collect();
    let page = Frame {
        title: name,
        kind: "Impacts on granular beds by granulens, over several beds for each kind of friction and each speed.",
        verdict: format!("<p>{impacts} impacts came to their end.{deepest}</p>\n{exponents}"),
        figures: vec![Figure {
            file: "depth.svg",
            svg: picture,
            caption: "Depth at the end over the speed of the intruder: means over the beds with 95 % intervals.".to_owned(),
            numbers: Some("ensemble.csv".to_owned()),
        }],
        sections: vec![(
            "Means",
            "<p>\u{b1}: half the 95 % interval of the mean. Single impacts: <a href=\"impacts.csv\">impacts.csv</a>.</p>\n".to_owned()
                + &table(&headings, &rows),
        )],
        provenance,
    };
    page.html()
}
