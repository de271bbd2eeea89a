//! Why no lens serves a target, and which target near it could be served.

use std::fmt;

use super::Family;
use super::problem::{Candidate, LEAST_GAIN, Problem};
use super::solve::Grid;
use crate::units::Dimension::{Angle, Length};

/// What keeps lenses from serving a target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Limit {
    /// The lens material is not slower than the host by enough, or not at all.
    SpeedRatio {
        /// Host over lens.
        ratio: f64,
    },
    /// The greatest angle of the curved face.
    InterfaceAngle {
        /// As asked for (rad).
        max: f64,
    },
    /// The rows that may hold lens material.
    Rows {
        /// As asked for.
        rows: [u32; 2],
        /// Last row in front of the focal region.
        last_free: u32,
    },
    /// The apex row, back row or radius that the request fixes.
    Fixed,
    /// The region itself: no lens of this family before it serves it, whatever it is made of.
    Region(Family),
}

impl fmt::Display for Limit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::SpeedRatio { ratio } if *ratio <= 1.0 => {
                write!(
                    f,
                    "the lens material is not slower than the host (host/lens {ratio:.3}) and would spread the wave"
                )
            }
            Self::SpeedRatio { ratio } => write!(f, "the speed ratio host/lens of {ratio:.3} bends rays too little"),
            Self::InterfaceAngle { max } => write!(f, "max_interface_angle = {} is too small", Angle.show(*max)),
            Self::Rows { rows: [first, _], last_free } if first >= last_free => {
                write!(
                    f,
                    "the lens may begin in row {first} and has to end in front of the focal region, by row {last_free}"
                )
            }
            Self::Rows { rows: [first, last], .. } => write!(f, "the lens may only lie in rows {first} to {last}"),
            Self::Fixed => f.write_str("the apex_row, back_row or radius given"),
            Self::Region(family) if family.spares() => {
                f.write_str("no shield in front of the region turns rays away from it")
            }
            Self::Region(family) => write!(f, "no {} lens in front of the region sends rays there", family.name()),
        }
    }
}

/// A focal region of the same extent at another depth that an allowed lens serves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// Its middle row.
    pub mid_row: f64,
    /// Fraction of the struck width that some allowed lens sends through it; at least, as the search is coarse.
    pub fraction: f64,
}

/// No lens within the limits serves the target: it sends less than 1 % of the struck width more through the focal region than straight
/// rays do, or its material is not slower than its host, so that its faces spread a wave that they are to gather.
#[derive(Clone, Debug, PartialEq)]
pub struct Unreachable {
    /// Family of the lens.
    pub family: Family,
    /// Which of several foci is meant, from 0.
    pub focus: Option<usize>,
    /// Name of the lens material.
    pub material: String,
    /// Distances from the axis between which rays should pass (m).
    pub x: [f64; 2],
    /// Middle row of the focal region.
    pub mid_row: f64,
    /// Fraction that the best allowed lens reaches; none if the limits allow no lens.
    pub fraction: Option<f64>,
    /// Fraction without a lens.
    pub fraction_without: f64,
    /// Whether the material is slower than the host, or the family does not gather: otherwise fractions have no say.
    pub may_gather: bool,
    /// Each of these limits, relaxed alone, would make the target reachable; if none would, the least set that does
    /// together.
    pub binding: Vec<Limit>,
    /// The nearest region of the same extent that is reachable within all limits.
    pub nearest: Option<Nearest>,
}

impl std::error::Error for Unreachable {}

impl fmt::Display for Unreachable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [low, high] = self.x.map(|x| Length.show(x));
        if let Some(focus) = self.focus {
            write!(f, "focus {}: ", focus + 1)?;
        }
        if let ([reason], false) = (&self.binding[..], self.may_gather) {
            // What such a lens sends through a region off the axis it has spread, and rays would count it as a success.
            return write!(
                f,
                "unreachable: a {} lens of {} gathers nothing, since {reason}. Ask for a slower material, or for a family that spreads \
                 or turns: plano-concave, prism.",
                self.family.name(),
                self.material
            );
        }
        write!(
            f,
            "unreachable: no allowed {} of {} sends at least {:.0} % more of {} {} {low} to {high} off the axis at row {} than \
             straight rays do ({:.1} %",
            match (self.family.spares(), self.focus) {
                (true, _) => "shield",
                (_, None) => "lens",
                (_, Some(_)) => "part of a lens",
            },
            self.material,
            100.0 * LEAST_GAIN,
            if self.focus.is_some() { "its strip" } else { "the struck width" },
            if self.family.spares() { "past" } else { "through" },
            self.mid_row,
            100.0 * self.fraction_without
        )?;
        match self.fraction {
            Some(fraction) => write!(f, "; the best lens {:.1} %). ", 100.0 * fraction)?,
            None => f.write_str("; the limits leave no lens at all). ")?,
        }
        let limits: Vec<String> = self.binding.iter().map(Limit::to_string).collect();
        write!(f, "What binds: {}.", limits.join("; "))?;
        match self.nearest {
            Some(Nearest { mid_row, fraction }) => {
                write!(f, " Nearest reachable middle row: {mid_row}, with at least {:.1} %.", 100.0 * fraction)
            }
            None => f.write_str(" No other depth is reachable either."),
        }
    }
}

/// Steepest front that is tried where the limit on the angle is relaxed (degrees).
const STEEPEST: f64 = 89.0;

/// Host over lens that is tried where the limit on the speeds is relaxed; material pairs of metals stay below 4.
const FASTEST: f64 = 10.0;

impl Unreachable {
    /// Finds out why, by relaxing one limit after the other. `best` is the best lens that was found, where one was sought.
    pub(super) fn explain(problem: &Problem, material: &str, best: Option<Candidate>) -> Self {
        // Of families that are not solved at once, a coarse search tells as much.
        let grid = if problem.is_fast() { Grid::fine(problem) } else { Grid::coarse(problem) };
        let best = best.or_else(|| problem.best(grid));
        let comparable = problem.may_gain();
        Self {
            family: problem.family,
            focus: None,
            material: material.to_owned(),
            x: problem.region,
            mid_row: problem.mid_row,
            fraction: best.map(|candidate| candidate.fraction),
            fraction_without: problem.without(),
            may_gather: comparable,
            binding: if comparable { binding(problem) } else { vec![speed_ratio(problem)] },
            nearest: if comparable { nearest(problem) } else { None },
        }
    }
}

fn speed_ratio(problem: &Problem) -> Limit {
    Limit::SpeedRatio { ratio: problem.speeds[0] / problem.speeds[1] }
}

fn relax<'a>(problem: &Problem<'a>, limits: &[Limit]) -> Problem<'a> {
    let mut relaxed = problem.clone();
    for limit in limits {
        match limit {
            Limit::SpeedRatio { .. } => relaxed.speeds[1] = relaxed.speeds[0] / FASTEST,
            Limit::InterfaceAngle { .. } => relaxed.max_angle = relaxed.max_angle.max(STEEPEST.to_radians()),
            Limit::Rows { .. } => relaxed.rows = [1, problem.last_free_row],
            Limit::Fixed => (relaxed.apex_row, relaxed.back_row, relaxed.radius) = (None, None, None),
            Limit::Region(_) => {}
        }
    }
    relaxed
}

fn reachable(problem: &Problem) -> Option<Candidate> {
    problem.best(Grid::coarse(problem)).filter(|candidate| problem.gains(candidate))
}

fn binding(problem: &Problem) -> Vec<Limit> {
    let mut limits = vec![
        Limit::Rows { rows: problem.rows, last_free: problem.last_free_row },
        Limit::InterfaceAngle { max: problem.max_angle },
        speed_ratio(problem),
    ];
    if problem.apex_row.is_some() || problem.back_row.is_some() || problem.radius.is_some() {
        limits.insert(0, Limit::Fixed);
    }
    let helps = |limits: &[Limit]| reachable(&relax(problem, limits)).is_some();
    let alone: Vec<Limit> = limits.iter().copied().filter(|&limit| helps(&[limit])).collect();
    if !alone.is_empty() {
        return alone;
    }
    if !helps(&limits) {
        return vec![Limit::Region(problem.family)];
    }
    // Together they help: leave out what is not needed.
    let mut needed = limits;
    for k in (0..needed.len()).rev() {
        let mut fewer = needed.clone();
        fewer.remove(k);
        if helps(&fewer) {
            needed = fewer;
        }
    }
    needed
}

/// Tries regions of as many rows at other depths, nearest first; in crystals of more than 200 rows not every row.
fn nearest(problem: &Problem) -> Option<Nearest> {
    let last = problem.stack.rows.checked_sub(problem.region_rows)? + 1;
    // Of several foci the others stay where they are.
    let here = (problem.mid_row - f64::from(problem.region_rows - 1) / 2.0).round() as i64;
    let others = if here > i64::from(problem.last_free_row) + 1 { problem.last_free_row } else { u32::MAX };
    let stride = last.div_ceil(200) as usize;
    let shifts = (stride as i64..=i64::from(last)).step_by(stride).flat_map(|shift| [-shift, shift]);
    shifts.filter_map(|shift| u32::try_from(here + shift).ok()).filter(|first| (1..=last).contains(first)).find_map(
        |first| {
            let mut moved = problem.clone();
            moved.last_free_row = others.min(first - 1);
            moved.mid_row = f64::from(first) + f64::from(problem.region_rows - 1) / 2.0;
            moved.depth = problem.stack.depth(moved.mid_row);
            reachable(&moved).map(|candidate| Nearest { mid_row: moved.mid_row, fraction: candidate.fraction })
        },
    )
}
