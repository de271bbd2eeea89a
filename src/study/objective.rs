//! What is wanted: measures to one number, of which less is better, and to several where they are traded.

use serde::Deserialize;
use toml::Table;

use super::aggregate::{Aggregate, Extreme, value};
use super::source::Source;
use super::{Entry, StudyError};
use crate::layout::LayoutStats;
use crate::real::Number;
use crate::score::{Measure, Unit};
use crate::search::Loss;

/// What is wanted of a measure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Goal {
    /// As great as can be.
    Maximise,
    /// As small as can be.
    Minimise,
    /// As near to a value as can be.
    Target(f64),
}

/// A measure, what is wanted of it, and its limits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Term {
    /// Which measure.
    pub measure: Measure,
    /// What is wanted; none where it has limits only.
    pub goal: Option<Goal>,
    /// How much the goal counts beside the others.
    pub weight: f64,
    /// It has to be at least this.
    pub min: Option<f64>,
    /// It has to be at most this.
    pub max: Option<f64>,
}

/// All that is wanted.
#[derive(Clone, Debug, PartialEq)]
pub struct Objective {
    /// At least one of them has an goal.
    pub terms: Vec<Term>,
    /// How the scores under several impacts become one.
    pub aggregate: Aggregate,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct TermFile {
    maximise: Option<f64>,
    minimise: Option<f64>,
    target: Option<f64>,
    weight: Option<f64>,
    min: Option<f64>,
    max: Option<f64>,
}

/// What to write, for those who wrote something else.
const LIKE: &str = "Write it like contrast = { maximise = 1 } or focal_gain = { min = 1.3 }: maximise and minimise take a \
                    weight, target a value and its weight beside it.";

impl Objective {
    /// From the section of a study file.
    pub(super) fn read(source: &Source<'_>, table: &Table, aggregate: Aggregate) -> Result<Self, StudyError> {
        let mut terms = Vec::new();
        for (name, written) in table {
            let Some(measure) = Measure::find(name).filter(|measure| *measure != Measure::ProtectedRatio) else {
                let known: Vec<&str> = Measure::ALL.iter().map(|measure| measure.name()).collect();
                let known = known.join(", ");
                return Err(source.fail(name, format!("objective: unknown measure {name}; known are {known}.")));
            };
            let fail = |message: String| source.fail(name, format!("objective.{name}: {message}"));
            let term: TermFile = written.clone().try_into().map_err(|error: toml::de::Error| {
                fail(format!("{}. {LIKE}", error.message().trim_end_matches('.').replace('\n', " ")))
            })?;
            if terms.iter().any(|known: &Term| known.measure == measure) {
                return Err(fail(format!("{} is asked for twice.", measure.name())));
            }
            terms.push(term.check(measure).map_err(fail)?);
        }
        if terms.iter().all(|term| term.goal.is_none()) {
            return Err(source.fail("objective", format!("objective asks for nothing. {LIKE}")));
        }
        Ok(Self { terms, aggregate })
    }

    /// Whether all limits are kept.
    pub fn is_met(&self, entry: &Entry, stats: &LayoutStats) -> bool {
        entry.stop.is_none() && self.loss(entry, stats).miss == 0.0
    }

    /// The numbers to make small. Each goal gives ln of what is to be small, -ln of what is to be great, |ln| of what
    /// is off a target, and of a count ln(1 + it); these are the parts, and their weighted sum is the total, to which each
    /// limit that is missed by the part v of it adds
    ///
    ///   4 v + 20 v²
    ///
    /// which is continuous, so that a search may pass through what is not allowed, and rises from its first moment by more
    /// than an goal commonly gains there, so that it does not stay. Failed is what a guard stopped.
    pub fn loss(&self, entry: &Entry, stats: &LayoutStats) -> Loss {
        self.finite_loss(entry, stats)
            .filter(|loss| entry.stop.is_none() && loss.is_finite())
            .unwrap_or_else(Loss::failed)
    }

    fn finite_loss(&self, entry: &Entry, stats: &LayoutStats) -> Option<Loss> {
        let mut loss = Loss { total: 0.0, miss: 0.0, parts: Vec::new() };
        for term in &self.terms {
            let value = |extreme: Extreme| value(term.measure, entry, stats, self.aggregate, extreme);
            let ln = |value: f64| {
                let value = if term.measure.unit() == Unit::Count { 1.0 + value } else { value };
                if value.is_normal() && value > 0.0 { Number::ln(value) } else { f64::NAN }
            };
            if let Some(goal) = term.goal {
                let part = match goal {
                    Goal::Maximise => -ln(value(Extreme::Least)?),
                    Goal::Minimise => ln(value(Extreme::Most)?),
                    Goal::Target(target) => {
                        let off = |value: f64| (ln(value) - ln(target)).abs();
                        off(value(Extreme::Least)?).max(off(value(Extreme::Most)?))
                    }
                };
                loss.total += term.weight * part;
                loss.parts.push(part);
            }
            let mut limit = |v: f64| {
                if v > 0.0 {
                    loss.miss += v;
                    loss.total += 4.0 * v + 20.0 * v * v;
                }
            };
            // A limit of no lone sphere at all is missed by as many as there are.
            let part_of = |limit: f64| if limit > 0.0 { limit } else { 1.0 };
            if let Some(min) = term.min {
                limit((min - value(Extreme::Least)?) / part_of(min));
            }
            if let Some(max) = term.max {
                limit((value(Extreme::Most)? - max) / part_of(max));
            }
        }
        Some(loss)
    }

    /// Whether the loss can only rise with P, and only fall with F, and depends on nothing else.
    pub fn follows_energies(&self) -> bool {
        self.terms.iter().all(|term| match term.measure {
            Measure::Contrast | Measure::FocalGain | Measure::FocalMean => {
                term.max.is_none() && matches!(term.goal, None | Some(Goal::Maximise))
            }
            Measure::Protection | Measure::ProtectedMean => {
                term.min.is_none() && matches!(term.goal, None | Some(Goal::Minimise))
            }
            _ => false,
        })
    }

    /// The measures with an goal, in the order of a loss's parts.
    pub fn goals(&self) -> impl Iterator<Item = &Term> {
        self.terms.iter().filter(|term| term.goal.is_some())
    }
}

impl TermFile {
    fn check(self, measure: Measure) -> Result<Term, String> {
        let counted = measure.unit() == Unit::Count;
        let sound = |name: &str, value: Option<f64>| match value {
            Some(value) if !(value.is_finite() && (value > 0.0 || (counted && value == 0.0))) => {
                Err(format!("{name} = {value} must be positive."))
            }
            _ => Ok(()),
        };
        sound("target", self.target)?;
        sound("min", self.min)?;
        sound("max", self.max)?;
        if let (Some(min), Some(max)) = (self.min, self.max)
            && min > max
        {
            return Err(format!("min = {min} is above max = {max}."));
        }
        let (goal, weight) = match (self.maximise, self.minimise, self.target, self.weight) {
            (Some(weight), None, None, None) => (Some(Goal::Maximise), weight),
            (None, Some(weight), None, None) => (Some(Goal::Minimise), weight),
            (None, None, Some(target), weight) => (Some(Goal::Target(target)), weight.unwrap_or(1.0)),
            (None, None, None, None) if self.min.is_some() || self.max.is_some() => (None, 1.0),
            _ => {
                return Err(format!("asks for none or for several of maximise, minimise, target, min and max. {LIKE}"));
            }
        };
        if !(weight.is_finite() && weight > 0.0) {
            return Err(format!("a weight of {weight} must be positive."));
        }
        Ok(Term { measure, goal, weight, min: self.min, max: self.max })
    }
}
