//! What is told as a page: words, tables, how scores are distributed, and maps.

use std::fmt::Write as _;

use super::criterion::Criterion;
use super::samples::Samples;
use super::told::Told;
use crate::report::{Bound, Figure, Frame, Provenance, escape, histogram, prose};
use crate::score::Measure;

/// The file beside the page that holds its numbers.
const NUMBERS: &str = "tolerance.json";

/// The page; `maps` are further pictures.
pub fn page(
    told: &Told,
    provenance: Provenance,
    criterion: &Criterion,
    samples: &Samples,
    measures: &[Measure],
    maps: &[String],
) -> String {
    let mut pictures = Vec::new();
    let count = told.samples as usize;
    // Not what no piece has, as Q where the crystal that it refers to cannot be simulated.
    let drawn = measures.iter().map(|&measure| (measure, samples.sorted(count, measure)));
    let drawn: Vec<(Measure, Vec<f64>)> = drawn.filter(|(_, values)| !values.is_empty()).collect();
    for &(measure, ref values) in &drawn {
        let bounds: Vec<Bound> = criterion
            .thresholds
            .iter()
            .filter(|threshold| threshold.measure == measure)
            .flat_map(|threshold| [("at least", threshold.min), ("at most", threshold.max)])
            .filter_map(|(word, bound)| Some((bound?, format!("{word} {:.4}", bound?))))
            .collect();
        let title = format!("{} of {} pieces", measure.name(), values.len());
        let label = match measure.unit().name() {
            "" => format!("{} ({})", measure.name(), measure.symbol()),
            unit => format!("{} ({unit})", measure.name()),
        };
        pictures.push(histogram(&title, &label, values, &bounds));
    }
    pictures.extend(maps.iter().cloned());
    let mut html = String::new();
    let [low, high] = told.interval.map(|end| 100.0 * end);
    let _ = write!(
        html,
        "<p><b>{:.1} % ({low:.1} to {high:.1} %, {})</b> of {} pieces keep {}.</p>\n<ul>",
        100.0 * told.share,
        told.interval_method,
        told.samples,
        escape(&told.yield_of)
    );
    told.assumed.iter().chain(&told.warnings).for_each(|line| {
        let _ = write!(html, "<li>{}</li>", escape(line));
    });
    // What is assumed stands above.
    let words = told.words();
    let rest: Vec<&str> = words.lines().filter(|line| !told.assumed.iter().any(|known| known == line)).collect();
    let _ = write!(html, "</ul>\n{}", prose(&rest.join("\n")));
    let figures = pictures.iter().enumerate().map(|(k, svg)| Figure {
        file: NUMBERS,
        svg,
        caption: match drawn.get(k) {
            Some((measure, _)) => {
                format!("How {} is distributed over the pieces; lines are what is asked.", measure.name())
            }
            None => "What one wrong sphere costs, by where it is.".to_owned(),
        },
        numbers: None,
    });
    let frame = Frame {
        title: &format!("{}: before it is built", told.design),
        kind: "A layout as a workshop makes it, simulated by granulens. Numbers are in the files beside this page.",
        verdict: html,
        figures: figures.collect(),
        sections: Vec::new(),
        provenance,
    };
    frame.html()
}
