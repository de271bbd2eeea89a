//! A contact's force-displacement curve as a figure and as a table: loading with its regions, one unloading.

use std::fmt::Write as _;

use super::chart::{COLOURS, Chart, Line, Mark};
use super::look::Look;
use crate::contact::{AnyLaw, ForceLaw as _, History, Pair};

/// How far the curve runs, in units of δ_p: somewhat past what the law was fitted for.
const EXTENT: f64 = 2.5;

/// Closing speeds (m/s) for which the loading curve is drawn: at rest, and one that shows the rate effect.
const FAST: f64 = 10.0;

/// Intervals of a curve.
const PARTS: u32 = 400;

/// A pair's curve.
pub struct ContactCurve {
    /// Overlap (m), and force (N) of loading at rest, of loading at 10 m/s, and of unloading from the end.
    points: Vec<[f64; 4]>,
    /// Overlaps (m) at which it yields and from which on it is fully plastic, at rest.
    regions: [f64; 2],
}

impl ContactCurve {
    /// Of a law of a pair of spheres.
    pub fn new(law: &AnyLaw, pair: &Pair) -> Self {
        let regions = pair.regions(1.0);
        let end = EXTENT * regions.plastic_overlap;
        let fresh = History::new();
        let history = law.recalled(end, law.force(end, 0.0, &fresh));
        let point = |k: u32| {
            let overlap = end * f64::from(k) / f64::from(PARTS);
            let loading = |speed: f64| law.force(overlap, speed, &fresh);
            [overlap, loading(0.0), loading(FAST), law.force(overlap, -FAST, &history)]
        };
        Self { points: (0..=PARTS).map(point).collect(), regions: [regions.yield_overlap, regions.plastic_overlap] }
    }

    /// As SVG, on a screen or in a paper: loading at rest and at 10 m/s, unloading from the end of the curve, and where the regions meet.
    pub fn svg(&self, title: &str, look: &Look) -> String {
        let line = |name: &str, column: usize, colour: usize, dashed: bool| Line {
            name: name.to_owned(),
            colour: COLOURS[colour].to_owned(),
            dashed,
            points: self.points.iter().map(|point| [1e6 * point[0], point[column]]).collect(),
        };
        let mut lines = vec![line("unloading", 3, 5, false), line("loading, quasistatic", 1, 0, false)];
        // A pair that does not harden has one loading curve only.
        let hardens = self.points.iter().any(|point| point[1] != point[2]);
        if hardens {
            lines.push(line("loading at 10 m/s", 2, 1, true));
        }
        let labels = ["overlap (µm)".to_owned(), "force (N)".to_owned()];
        let names = ["yield", "fully plastic"];
        let marks: Vec<Mark> = (self.regions.iter().zip(names))
            .map(|(overlap, name)| Mark { at: 1e6 * overlap, name: name.to_owned() })
            .collect();
        Chart { title: title.to_owned(), labels, lines }.drawn(&marks, look)
    }

    /// As CSV; SI.
    pub fn csv(&self) -> String {
        let mut text = String::from("overlap_m,loading_N,loading_at_10_m_s_N,unloading_N\n");
        for [overlap, slow, fast, back] in &self.points {
            let _ = writeln!(text, "{overlap:e},{slow:e},{fast:e},{back:e}");
        }
        text
    }
}
