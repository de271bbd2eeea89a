//! Depth against speed over many impacts, with error bars.

use super::chart::{COLOURS, Chart, Line};
use crate::bed::Cell;

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
