//! Before it is built: what a layout is worth once a workshop has made it.
//!
//! In: a layout under its design, a [`Drawing`], and [`Tolerances`], what may turn out otherwise and by how much. Out: how much each score changes with each
//! quantity, which share of pieces does what is asked, and what to do about it. Sheets and crystals in space are made alike; what settles in a frame, friction,
//! oblique blows, derivatives and maps are of sheets. Every piece is a [`Piece`], values and a seed, so that
//! the k-th one is the same whoever makes it and whenever; pieces are simulated side by side.
//!
//! - `grade`: what makers of balls promise; `file`: tolerances as written; `quantity`: what may turn out otherwise
//! - `piece`: one piece as made; `workshop`: makes and simulates many
//! - `criterion`: what is asked of a piece; `yields`: how many do; `samples`: pieces that are kept, and their file
//! - `sensitivity`: quantity by quantity; `indices`: anywhere within the limits; `sites`: site by site
//! - `inverse`: what tolerances may be; `rechoose`: what measuring wins
//! - `told`: all of it as JSON and in words; `page`: as a page

mod criterion;
mod file;
mod grade;
mod indices;
mod inverse;
mod page;
mod piece;
mod quantity;
mod rechoose;
mod samples;
mod sensitivity;
mod sites;
mod told;
mod workshop;
mod yields;

pub use criterion::{Criterion, best_baseline};
pub use file::MOST_SAMPLES;
pub use grade::{GRADES, Grade};
pub use indices::{Index, indices, indices_runs, indices_words};
pub use inverse::{Inverse, Rung, inverse, inverse_words};
pub use page::page;
pub use piece::Piece;
pub use quantity::{Kind, Quantity, quantities};
pub use rechoose::{Rechosen, rechoose};
pub use samples::{KeptError, Sample, Samples};
pub use sensitivity::{AsBuilt, Believed, Change, Sensitivity, as_built, derivative_runs, sensitivity};
pub use sites::{Sites, WrongSphere, sites, sites_runs};
pub use told::{Distribution, Told, assumed, distributions, yield_of};
pub use workshop::{Made, Workshop, WorkshopError};
pub use yields::{INTERVAL, Share, quantile};

use crate::contact::LawKind;
use crate::dem::{Projectile, Strike};
use crate::design::Threshold;
use crate::evaluate::{Drawing, Overrides, Plan, PlanError};

/// How unequal spheres lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// Centres on the nominal sites, which are as far apart as the largest sphere of the piece needs.
    NominalSites,
    /// Settled in the frame under gravity, which acts along the axis, from the struck row to the end wall.
    Settled,
}

/// How far the blow may be from the design's.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ImpactLimits {
    /// Of the force, a part of it.
    pub force: f64,
    /// Of the duration, a part of it.
    pub duration: f64,
    /// From the axis, to both sides (rad).
    pub angle: f64,
    /// Beside the axis, to both sides (m).
    pub off_centre: f64,
    /// What may strike in place of the pulse.
    pub projectile: Option<Projectile>,
}

/// What may turn out otherwise than drawn. Limits are to both sides, and between them all values are as likely.
#[derive(Clone, Debug, PartialEq)]
pub struct Tolerances {
    /// How unequal spheres lie.
    pub state: State,
    /// Whether both halves of the piece turn out alike, so that one of them says all. Of a real piece they do not.
    pub halves_alike: bool,
    /// The grade of the balls, where it is one.
    pub grade: Option<&'static Grade>,
    /// Where the numbers of diameters come from, in words.
    pub diameters_from: String,
    /// Greatest less smallest diameter of a lot (m).
    pub lot: f64,
    /// How far a lot's mean may lie from the nominal diameter (m); each material is a lot.
    pub offset: f64,
    /// Of E, a part of it.
    pub youngs_modulus: f64,
    /// Of ρ, a part of it.
    pub density: f64,
    /// Of σ_y, a part of it.
    pub yield_stress: f64,
    /// Of the rate constant, a part of it.
    pub rate_constant: f64,
    /// The chance of a site to hold no sphere.
    pub vacancies: f64,
    /// The chance of a site to hold a sphere of another of the layout's materials.
    pub wrong: f64,
    /// Room between the piece and each side wall (m).
    pub side_gap: f64,
    /// Room between the piece and the end wall (m).
    pub end_gap: f64,
    /// The coefficient of friction, least and greatest; the design's where there is none.
    pub friction: Option<[f64; 2]>,
    /// Of the blow.
    pub impact: ImpactLimits,
    /// Contact laws besides the design's, as the uncertainty of the model.
    pub laws: Vec<LawKind>,
    /// What is asked of a piece; the design's thresholds where there are none.
    pub thresholds: Option<Vec<Threshold>>,
    /// Pieces that are made.
    pub samples: u64,
    /// The seed.
    pub seed: Option<u64>,
}

/// Pieces that are made where nobody says how many: a share near 92 % is then known to 2.5 %.
const SAMPLES: u64 = 500;

impl Tolerances {
    /// Nothing turns out otherwise.
    pub fn drawn() -> Self {
        Self {
            state: State::NominalSites,
            halves_alike: false,
            grade: None,
            diameters_from: String::new(),
            lot: 0.0,
            offset: 0.0,
            youngs_modulus: 0.0,
            density: 0.0,
            yield_stress: 0.0,
            rate_constant: 0.0,
            vacancies: 0.0,
            wrong: 0.0,
            side_gap: 0.0,
            end_gap: 0.0,
            friction: None,
            impact: ImpactLimits::default(),
            laws: Vec::new(),
            thresholds: None,
            samples: SAMPLES,
            seed: None,
        }
    }

    /// Diameters of grade G100, one gauge ordered for all lots, and nothing else: what is assumed where nobody says more.
    pub fn usual() -> Self {
        let mut tolerances = Self::drawn();
        if let Some(grade) = Grade::find("G100") {
            tolerances.take(grade, false);
        }
        tolerances
    }

    /// With the diameters of a grade; `any` of its gauges may be delivered, or the one that is ordered.
    pub fn take(&mut self, grade: &'static Grade, any: bool) {
        (self.lot, self.offset) = (grade.lot, if any { grade.any_gauge } else { grade.one_gauge });
        let gauge = if any { "any gauge" } else { "one gauge for all lots" };
        self.diameters_from = format!("{} ({}), {gauge}", grade.name, grade.source);
        self.grade = Some(grade);
    }

    /// What is asked that only sheets have.
    fn of_sheets(&self) -> Option<&'static str> {
        let Self { impact, .. } = self;
        let asked = [
            (self.state == State::Settled, "state = \"settled\""),
            (self.side_gap != 0.0 || self.end_gap != 0.0, "the room of [frame]"),
            (self.friction.is_some(), "contact.friction"),
            (impact.angle != 0.0, "impact.angle"),
            (impact.off_centre != 0.0, "impact.off_centre"),
        ];
        asked.into_iter().find_map(|(is_asked, what)| is_asked.then_some(what))
    }

    /// Step and window for all pieces, under all that may strike them.
    ///
    /// # Errors
    /// See [`PlanError`].
    pub fn plan(&self, drawing: Drawing<'_>, overrides: Overrides) -> Result<Plan, PlanError> {
        let fastest = |flat: Projectile| Projectile { speed: (1.0 + self.impact.force) * flat.speed, ..flat };
        let thrown: Vec<Strike> = self.impact.projectile.map(|flat| fastest(flat).into()).into_iter().collect();
        drawing.plan_under(&thrown, overrides)
    }

    /// For so many sites of the half, the places whose spheres turn out each in their own way.
    pub fn places(&self, sites: usize) -> usize {
        if self.halves_alike { sites } else { 2 * sites }
    }
}
