//! The best layouts that were found for the lens problem and for other targets, `designs/optimum/`, scored anew.
//!
//! Published here is `designs/optimum/figures.csv`: what `granulens check` says of each at 5e-8 s, under the design's own impact or under
//! the worst of the five of the robust ones, each measure by itself; of the lens problem from 0 to 350 us, of others over their design's window.

use super::laws::stored;
use super::{Part, Row, RowError, Verdict};
use crate::Context;
use crate::dem::{ForcePulse, Strike};
use crate::design::Design;
use crate::evaluate::{Evaluator, Overrides};
use crate::layout::Layout;
use crate::score::{Measure, Scores};

/// Layouts by file name.
type Files = &'static [(&'static str, &'static str)];

macro_rules! files {
    ($($name:literal),* $(,)?) => { &[$(($name, include_str!(concat!("../../designs/optimum/", $name)))),*] };
}

/// Those for one impact.
const ONE: Files = files![
    "five-rows-5-25-3.csv",
    "five-rows-5-25-protected.csv",
    "five-rows-5-25.csv",
    "five-rows-5-29-basin.csv",
    "five-rows-5-29-protected.csv",
    "five-rows-5-29.csv",
    "four-rows-5-25-2.csv",
    "four-rows-5-25-3.csv",
    "four-rows-5-25.csv",
    "four-rows-5-29-basin-1.csv",
    "four-rows-5-29-basin-2.csv",
    "four-rows-5-29-basin-3.csv",
    "four-rows-5-29-first.csv",
    "four-rows-5-29-from-lens.csv",
    "four-rows-5-29-protected-2.csv",
    "four-rows-5-29-protected-3.csv",
    "four-rows-5-29-protected.csv",
    "four-rows-5-29-second.csv",
    "four-rows-5-29.csv",
    "laws/four-rows-5-29-laws.csv",
    "real/scattered.csv",
    "two-rows-5-25.csv",
];

/// Those for five.
const FIVE: Files = files!["five-rows-5-25-robust.csv", "four-robust.csv"];

/// Those of other targets and other blows, each in a folder called as its design.
const OTHERS: &[(&str, &str, Files)] = &[
    ("deep.toml", include_str!("../../designs/deep.toml"), files!["deep/deep.csv"]),
    ("off-axis.toml", include_str!("../../designs/off-axis.toml"), files!["off-axis/off-axis.csv"]),
    ("real.toml", include_str!("../../designs/real.toml"), files!["real/real-basin.csv", "real/real.csv"]),
    ("ring.toml", include_str!("../../designs/ring.toml"), files!["ring/ring.csv"]),
    ("shield.toml", include_str!("../../designs/shield.toml"), files!["shield/shield.csv"]),
];

/// The lens problem's design, and how much of the impact is scored (s).
const LENS_PROBLEM: (&str, &str) = ("thesis-lens.toml", include_str!("../../designs/thesis-lens.toml"));
const WINDOW: f64 = 350e-6;

/// Force (N) and duration (s) of the five impacts.
const IMPACTS: [[f64; 2]; 5] = [[10.5e3, 20e-6], [26e3, 20e-6], [52e3, 20e-6], [26e3, 10e-6], [26e3, 40e-6]];

const FIGURES: &str = include_str!("../../designs/optimum/figures.csv");

pub(super) const ROWS: &[Row] = &[
    Row {
        id: "optimum-one",
        claim: "C, G and Q of the best layouts, 26 kN for 20 us",
        source: "designs/optimum/figures.csv",
        reason: "the same program: the last digit that is written",
        formula: false,
        expected: Verdict::Holds,
        seconds: 8.0,
        measure: |context| scores(LENS_PROBLEM, ONE, (&[], Some(WINDOW)), context),
    },
    Row {
        id: "optimum-five",
        claim: "least C and G under five impacts of the layouts that are to stand them",
        source: "designs/optimum/figures.csv",
        reason: "the same program: the last digit that is written",
        formula: false,
        expected: Verdict::Holds,
        seconds: 20.0,
        measure: |context| scores(LENS_PROBLEM, FIVE, (&IMPACTS, Some(WINDOW)), context),
    },
    Row {
        id: "optimum-others",
        claim: "C, G and Q of the best layouts for other targets and blows",
        source: "designs/optimum/figures.csv",
        reason: "the same program: the last digit that is written",
        formula: false,
        expected: Verdict::Holds,
        seconds: 8.0,
        measure: |context| {
            let of = |&(name, text, files): &(&'static str, &'static str, Files)| {
                scores((name, text), files, (&[], None), context)
            };
            Ok(OTHERS.iter().map(of).collect::<Result<Vec<_>, RowError>>()?.concat())
        },
    },
];

/// Of every layout the worst C, G and Q under some impacts, each by itself; under the design's own where none is named, and over its own window.
/// Q is left out where brass alone cannot stand one of them.
fn scores(
    (name, text): (&str, &str),
    files: Files,
    (impacts, window): (&[[f64; 2]], Option<f64>),
    context: &Context,
) -> Result<Vec<Part>, RowError> {
    let failed = |error: &dyn std::fmt::Display| RowError::Stopped(error.to_string());
    let design = Design::parse(format!("designs/{name}"), text).map_err(|error| failed(&error))?;
    // It only grows, so that the layouts before keep their meaning.
    let mut host = Layout {
        lattice: design.lattice.clone(),
        palette: vec![design.host.clone()],
        materials: vec![0; design.lattice.len()],
    };
    let mut layouts = Vec::new();
    for (_, text) in files {
        let layout = stored(&host, text)?;
        host.palette = layout.palette;
        layouts.push(layout.materials);
    }
    let impacts: Vec<Strike> = match impacts {
        [] => vec![design.impact],
        impacts => impacts.iter().map(|&[force, duration]| ForcePulse { force, duration }.into()).collect(),
    };
    let overrides = Overrides { step: Some(5e-8), window, ..Overrides::default() };
    let evaluator =
        Evaluator::new(&design, &impacts, host.palette, overrides, context).map_err(|error| failed(&error))?;
    let runs = evaluator.scores(&layouts, context).map_err(|error| failed(&error))?;
    let mut parts = Vec::new();
    for ((name, _), runs) in files.iter().zip(runs) {
        if let Some(stop) = runs.iter().find_map(|run| run.stop.clone()) {
            return Err(stop.into());
        }
        let Some(said) = FIGURES.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(',')) else {
            return Err(RowError::Stopped(format!("designs/optimum/figures.csv has no line of {name}")));
        };
        let worst = |of: &dyn Fn(&Scores) -> Option<f64>, pick: fn(f64, f64) -> f64| {
            runs.iter().map(|run| of(&run.scores)).collect::<Option<Vec<_>>>()?.into_iter().reduce(pick)
        };
        let ours = [
            (Measure::Contrast, worst(&|scores| scores.contrast, f64::min)),
            (Measure::FocalGain, worst(&|scores| scores.focal_gain, f64::min)),
            (Measure::Protection, worst(&|scores| scores.protection, f64::max)),
        ];
        for ((measure, ours), said) in ours.into_iter().zip(said.split(',')).filter(|(_, said)| !said.is_empty()) {
            let said: f64 = said.parse().map_err(|error: std::num::ParseFloatError| failed(&error))?;
            let what = format!("{name}, {}", measure.symbol());
            parts.push(Part::near(what, said, ours.unwrap_or(f64::NAN), "", 1e-9));
        }
    }
    Ok(parts)
}
