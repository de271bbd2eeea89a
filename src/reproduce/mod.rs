//! Published numbers and claims, each beside what this program gives, with a verdict.
//!
//! In: nothing. Out: [`Row`]s that can be run one by one or all together. What is ours is computed when a row runs; of the
//! published side only numbers and words are kept. A row knows which verdict it is expected to come to, so that a change
//! that makes a claim fail, or a failing one hold, is noticed.
//!
//! - here: rows, parts and verdicts; `table`: the rows as text
//! - `chapter3`: the contact law; `chapter4`: chains; `uniform`: sheets and close packings (5.2); `guided`: stripes and wedges
//!   (5.3.1, 5.3.2); `lens`: the impact lens (5.3.3)
//! - `crystals`: uniform and layered crystals, struck; `wedge`: the angle by which an interface bends a wave
//! - `space`: the lens in three dimensions (6.1)
//! - `kondic`: impacts on granular beds; `microstructure`: forces between their grains and how these move
//! - `laws`: the lens under other contact laws; `optimum`: the best layouts that were found
//!
//! Source of the claims: Burgoyne 2016, by section, figure and equation; those named K are of Kondic et al. 2012.

mod chapter3;
mod chapter4;
mod crystals;
mod guided;
mod kondic;
mod laws;
mod lens;
mod microstructure;
mod optimum;
mod space;
mod table;
mod uniform;
mod wedge;

pub use table::{list, markdown};
pub use wedge::Wedge;

use std::fmt;
use std::time::Instant;

use rayon::prelude::*;
use serde::Serialize;

use crate::Context;
use crate::dem::rig::{RigError, RigStop};
use crate::dem::{OverlapAtRest, Stop};
use crate::lattice::{CrystalError, LatticeError};
use crate::pattern::PatternError;

/// A published claim, and how it is put to the test.
#[derive(Clone, Copy)]
pub struct Row {
    /// Name, which begins with the section.
    pub id: &'static str,
    /// What is claimed, in our words.
    pub claim: &'static str,
    /// Where.
    pub source: &'static str,
    /// Why the tolerances are what they are.
    pub reason: &'static str,
    /// Whether the numbers are said to follow from a published formula.
    pub formula: bool,
    /// What the row is expected to come to.
    pub expected: Verdict,
    /// About how long it takes (s), on one core.
    pub seconds: f64,
    measure: fn(&Context) -> Result<Vec<Part>, RowError>,
}

/// What came of a claim.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// Every part of it holds.
    Holds,
    /// Some parts hold, some do not.
    HoldsInPart,
    /// No part of it holds.
    DoesNotHold,
    /// The published number is not what the published formula and values give.
    DoesNotFollow,
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Holds => "holds",
            Self::HoldsInPart => "holds in part",
            Self::DoesNotHold => "does not hold",
            Self::DoesNotFollow => "does not follow from the published formula",
        })
    }
}

/// One number of a claim.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Part {
    /// Which number.
    pub what: String,
    /// What is published, as a number with its unit or in words.
    pub published: String,
    /// What we find, in `unit`.
    pub ours: f64,
    /// The unit; empty for ratios.
    pub unit: &'static str,
    /// What ours must be for this part to hold.
    pub wanted: Wanted,
}

/// What a number must be.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Wanted {
    /// A value, to a relative tolerance.
    Near {
        /// The value.
        value: f64,
        /// Largest relative deviation.
        relative: f64,
    },
    /// A value, to an absolute tolerance.
    Within {
        /// The value.
        value: f64,
        /// Largest deviation.
        absolute: f64,
    },
    /// Above this.
    Above(f64),
    /// Below this.
    Below(f64),
}

impl Part {
    /// A published number (in `unit`), met to a relative tolerance.
    pub fn near(what: impl Into<String>, published: f64, ours: f64, unit: &'static str, relative: f64) -> Self {
        let wanted = Wanted::Near { value: published, relative };
        Self { what: what.into(), published: format!("{published} {unit}").trim().to_owned(), ours, unit, wanted }
    }

    /// Words, and what they ask of ours.
    pub fn words(what: impl Into<String>, words: &str, ours: f64, unit: &'static str, wanted: Wanted) -> Self {
        Self { what: what.into(), published: words.to_owned(), ours, unit, wanted }
    }

    /// Whether ours is what it must be; never for a number that is not finite.
    pub fn holds(&self) -> bool {
        match self.wanted {
            Wanted::Near { value, relative } => (self.ours - value).abs() <= relative * value.abs(),
            Wanted::Within { value, absolute } => (self.ours - value).abs() <= absolute,
            Wanted::Above(limit) => self.ours.is_finite() && self.ours > limit,
            Wanted::Below(limit) => self.ours.is_finite() && self.ours < limit,
        }
    }

    /// Ours over the value less one, or ours less the value, where there is one.
    pub fn deviation(&self) -> Option<f64> {
        match self.wanted {
            Wanted::Near { value, .. } => Some(self.ours / value - 1.0),
            Wanted::Within { value, .. } => Some(self.ours - value),
            _ => None,
        }
    }
}

/// A row that was run.
#[derive(Clone, Debug)]
pub struct Finding {
    /// The row.
    pub row: &'static Row,
    /// Its numbers, or why there are none.
    pub parts: Result<Vec<Part>, RowError>,
    /// How long it took (s).
    pub seconds: f64,
}

impl fmt::Debug for Row {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.id)
    }
}

impl Finding {
    /// What the numbers come to; none where there are none.
    pub fn verdict(&self) -> Option<Verdict> {
        let parts = self.parts.as_ref().ok()?;
        let held = parts.iter().filter(|part| part.holds()).count();
        Some(match (held, parts.len() - held) {
            (_, 0) => Verdict::Holds,
            (0, _) if self.row.formula => Verdict::DoesNotFollow,
            (0, _) => Verdict::DoesNotHold,
            _ => Verdict::HoldsInPart,
        })
    }

    /// What is wrong: another verdict than expected, or none.
    pub fn deviates(&self) -> Option<String> {
        match (&self.parts, self.verdict()) {
            (Err(error), _) => Some(format!("{}: {error}", self.row.id)),
            (_, Some(verdict)) if verdict != self.row.expected => {
                Some(format!("{}: {verdict}; expected was: {}", self.row.id, self.row.expected))
            }
            _ => None,
        }
    }

    /// Whether the run was asked to stop before it had an answer.
    pub fn interrupted(&self) -> bool {
        matches!(self.parts, Err(RowError::Interrupted))
    }
}

/// Why a row has no numbers.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RowError {
    /// The caller asked for it.
    #[error("interrupted")]
    Interrupted,
    /// Its rig cannot be set in motion.
    #[error(transparent)]
    Rig(#[from] RigError),
    /// A guard stopped the run.
    #[error("{0}")]
    Stopped(String),
    /// Its crystal cannot be laid.
    #[error(transparent)]
    Crystal(#[from] CrystalError),
    /// Its sheet cannot be laid.
    #[error(transparent)]
    Lattice(#[from] LatticeError),
    /// Its pattern cannot be painted.
    #[error(transparent)]
    Pattern(#[from] PatternError),
    /// Its spheres overlap at rest.
    #[error("{0}")]
    Overlap(String),
    /// A wave did not get as far as it is looked at.
    #[error("the wave did not reach {0}")]
    NoWave(String),
}

impl From<RigStop> for RowError {
    fn from(stop: RigStop) -> Self {
        match stop {
            RigStop::Interrupted { .. } => Self::Interrupted,
            stop => Self::Stopped(stop.to_string()),
        }
    }
}

impl From<Stop> for RowError {
    fn from(stop: Stop) -> Self {
        match stop {
            Stop::Interrupted { .. } => Self::Interrupted,
            stop => Self::Stopped(stop.to_string()),
        }
    }
}

impl From<OverlapAtRest> for RowError {
    fn from(error: OverlapAtRest) -> Self {
        Self::Overlap(error.to_string())
    }
}

/// All rows, in the order of the source.
pub fn rows() -> Vec<&'static Row> {
    let of_burgoyne = [chapter3::ROWS, chapter4::ROWS, uniform::ROWS, guided::ROWS, lens::ROWS, space::ROWS];
    let of_beds = kondic::ROWS.iter().chain(microstructure::rows());
    of_burgoyne.into_iter().flatten().chain(of_beds).chain(laws::ROWS).chain(optimum::ROWS).collect()
}

/// The rows that `name` means: one by its whole name, or all of a chapter or section, as `4` or `5.3.2`; `K` and `K-3` are those of
/// Kondic et al. 2012, `laws` those of the lens under other contact laws, `optimum` the best layouts that were found.
pub fn select(name: &str) -> Vec<&'static Row> {
    let all = rows();
    // A row's name may begin another's.
    if let Some(row) = all.iter().find(|row| row.id == name) {
        return vec![row];
    }
    let within = |row: &&'static Row| row.id.strip_prefix(name).is_some_and(|rest| rest.starts_with(['.', '-']));
    let numbered = match name.strip_prefix('K') {
        Some(section) => section.strip_prefix('-').is_none_or(|rest| !rest.contains('-')),
        None if ["laws", "optimum"].contains(&name) => true,
        None => name.starts_with(|c: char| c.is_ascii_digit()) && !name.contains('-'),
    };
    all.into_iter().filter(|row| numbered && within(row)).collect()
}

impl Row {
    /// Runs it. The context is asked now and then whether to go on.
    pub fn run(&'static self, context: &Context) -> Finding {
        let begun = Instant::now();
        let parts = if context.stopped() { Err(RowError::Interrupted) } else { (self.measure)(&context.silent()) };
        Finding { row: self, parts, seconds: begun.elapsed().as_secs_f64() }
    }
}

/// Runs rows side by side, the longest first; the findings come in the order of the rows. The context is told of each as it ends.
pub fn run(rows: &[&'static Row], context: &Context) -> Vec<Finding> {
    let mut order: Vec<usize> = (0..rows.len()).collect();
    order.sort_by(|&a, &b| rows[b].seconds.total_cmp(&rows[a].seconds));
    let run = |k: usize| {
        let finding = rows[k].run(context);
        context.finished(finding.row.id);
        (k, finding)
    };
    // One at a time to each thread, so that long rows do not queue behind one another.
    let mut findings: Vec<(usize, Finding)> = order.into_par_iter().with_max_len(1).map(run).collect();
    findings.sort_by_key(|(k, _)| *k);
    findings.into_iter().map(|(_, finding)| finding).collect()
}
