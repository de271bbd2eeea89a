//! Studies side by side as a page: what each came to, and how fast.

use super::chart::{COLOURS, Chart, Line};
use super::digits::significant;
use super::frame::{self, Figure, Frame, Provenance};
use super::svg::escape;
use crate::score::Measure;
use crate::study::Report;

/// One of the studies.
pub struct ComparedStudy<'a> {
    /// Its folder.
    pub name: &'a str,
    /// What it came to.
    pub report: &'a Report,
    /// Evaluations after which its loss was within 5 % of the best of all, where steps are the same.
    pub soon: Option<u64>,
    /// Sites on which its best layout differs from that of the first.
    pub differs: Option<usize>,
}

/// The page, complete in itself. `alike`: whether all search for the same; only then is one called the best. `words` is the table of the terminal.
pub fn compared_page(studies: &[ComparedStudy<'_>], alike: bool, words: &str, provenance: Provenance) -> String {
    let ratios = [Measure::Contrast, Measure::FocalGain, Measure::Protection];
    let text = |count: Option<u64>| count.map_or("\u{2013}".to_owned(), |count| count.to_string());
    let rows: Vec<Vec<String>> = studies
        .iter()
        .map(|study| {
            let best = study.report.state.best.as_ref();
            let score = |measure: Measure| {
                best.and_then(|best| best.scores.get(measure))
                    .map_or("\u{2013}".to_owned(), |value| significant(value, 4))
            };
            let methods: Vec<&str> = study.report.state.stages.iter().map(|stage| stage.method.as_str()).collect();
            let head =
                [study.name.to_owned(), study.report.seed.to_string(), study.report.state.evaluations.to_string()];
            let tail = [text(study.soon), text(study.differs.map(|count| count as u64)), methods.join(" > ")];
            head.into_iter().chain(ratios.map(score)).chain(tail).collect()
        })
        .collect();
    let headings = [
        "study",
        "seed",
        "evaluations",
        "C",
        "G",
        "Q",
        "evaluations to 5 %",
        "sites that differ from the first",
        "methods",
    ];
    let picture = convergence(studies);
    let figures = picture.iter().map(|svg| Figure {
        file: "study.json",
        svg,
        caption: "The number that is made small, of the best layout so far that keeps the limits, at each study's finest step, over its evaluations.".to_owned(),
        numbers: None,
    });
    let page = Frame {
        title: "Studies side by side",
        kind: "Searches of layouts by granulens, compared by what each came to and how fast.",
        verdict: verdict(studies, alike),
        figures: figures.collect(),
        sections: vec![
            ("What each came to", frame::table(&headings, &rows)),
            ("In words", format!("<pre>{}</pre>\n", frame::escape_lines(words.trim_end()))),
        ],
        provenance,
    };
    page.html()
}

fn verdict(studies: &[ComparedStudy<'_>], alike: bool) -> String {
    if !alike {
        return "<p>These are <b>different problems</b> (design, materials, sites, impacts, tolerances or objective differ): each stands by \
                itself, and none is called the best.</p>\n"
            .to_owned();
    }
    let loss = |study: &&ComparedStudy<'_>| study.report.state.best.as_ref().map(|best| best.loss);
    let best = studies.iter().filter(|study| loss(study).is_some());
    let best = best.min_by(|a, b| loss(a).partial_cmp(&loss(b)).unwrap_or(std::cmp::Ordering::Equal));
    match best {
        None => "<p class=\"failure\">No study found a layout that keeps its limits.</p>\n".to_owned(),
        Some(study) => {
            let step = study.report.method.as_ref().map_or(String::new(), |method| {
                format!(", at a step of {}", crate::units::Dimension::Time.show(method.step_s))
            });
            format!(
                "<p>The best of {} studies of one problem is <b class=\"better\">{}</b>, by the loss of its best layout{}.</p>\n",
                studies.len(),
                escape(study.name),
                escape(&step)
            )
        }
    }
}

/// The loss so far over the evaluations, a line for each study at its finest step.
fn convergence(studies: &[ComparedStudy<'_>]) -> Option<String> {
    let mut lines = Vec::new();
    for (k, study) in studies.iter().enumerate() {
        let state = &study.report.state;
        let Some(finest) = state.history.iter().map(|h| h.step).reduce(f64::min) else { continue };
        let mut points: Vec<[f64; 2]> = Vec::new();
        for found in state.history.iter().filter(|h| h.step == finest && h.within_limits) {
            let at = found.evaluations as f64;
            points.extend(points.last().map(|last| [at, last[1]]));
            points.push([at, found.loss]);
        }
        points.extend(points.last().map(|last| [state.evaluations as f64, last[1]]));
        if points.is_empty() {
            continue;
        }
        lines.push(Line {
            name: study.name.to_owned(),
            colour: COLOURS[k % COLOURS.len()].to_owned(),
            dashed: k >= COLOURS.len(),
            points,
        });
    }
    (!lines.is_empty()).then(|| {
        let labels = ["evaluations".to_owned(), "loss".to_owned()];
        Chart { title: "The best so far".to_owned(), labels, lines }.svg()
    })
}
