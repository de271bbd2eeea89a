//! One design to one outcome: proposes the lens, lays its baselines, simulates all of them alike, and scores them.
//!
//! - `plan`: step and window, chosen once for all arrangements; `stiffest`: what bounds the step
//! - `compare`: the lens and its baselines, in parallel; `beside`: one layout beside the uniform crystals alone
//! - `decay`: how waves decay in the uniform crystals of a design
//! - `traced`: what rays and first arrivals say, without a simulation
//! - `batch`: many layouts at once, in vector lanes, for those who search; `load`: what strikes them, straight or at an angle, and
//!   what is built otherwise than drawn
//! - `forces`: one score of several forces; `verdict`: better, equal or worse than what a lens has to beat
//! - `surrogate`: what is guessed without a simulation; `glimpse`: a comparison by energies alone, as fast as it can be
//! - `laws`: one layout under several contact laws; `rank`: which material and family
//! - `held`: the whole piece between mirrors, or in a frame; `settle`: how unequal spheres lie in it under gravity
//! - `sensitivity`: how scores change with every sphere, by the adjoint; `swaps`: what exchanging single spheres does
//! - `whole`: pieces whose halves differ
//! - `space`: crystals in space: lens, baselines and strips in lanes; `part`: the half of them, or a sixth
//! - `drawing`: a layout under its design, of either kind
//! - `made`: laws that gave back more than was put in

mod batch;
mod beside;
mod load;
mod compare;
mod decay;
mod drawing;
mod forces;
mod surrogate;
mod glimpse;
mod held;
mod laws;
mod made;
mod part;
mod plan;
mod rank;
mod sensitivity;
mod settle;
mod space;
mod stiffest;
mod swaps;
mod traced;
mod verdict;
mod whole;

pub use batch::{Detail, Evaluated, Evaluator, EvaluatorError};
pub use beside::{Beside, beside_uniform, refer, unnamed};
pub use compare::{Comparison, compare, judged, proposal, stops};
pub use decay::{calibrate, decay};
pub use drawing::Drawing;
pub use forces::{Forces, ForcesError};
pub use glimpse::glimpse;
pub use held::{Frame, HeldError, HeldSphere, held_energies, held_spheres, settled};
pub use laws::{LawScores, OverLaws, OverLawsError, Ranges, design_laws, over_laws};
pub use load::{ImpactLoad, Imperfection, LoadCase};
pub use part::{part_in_space, simulated_fraction};
pub use plan::{Overrides, Plan, PlanError, common_plan};
pub use rank::{Ranked, rank};
pub use sensitivity::{
    Derivatives, MEASURES, SECANT, Sensitivities, SensitivityError, Shared, sensitivities, shared_slopes,
};
pub use settle::SettleError;
pub use space::{
    SpaceBeside, SpaceComparison, beside_in_space, compare_in_space, evaluate_in_space, impact_in_space,
    judged_in_space, strips,
};
pub use surrogate::ArrivalSurrogate;
pub use swaps::{Swap, Swaps, swaps};
pub use traced::{trace_arrivals, trace_fronts, trace_lens};
pub use whole::Subject;

pub(crate) use made::gain_words;
pub(crate) use part::contacts_of_half;
pub(crate) use space::add_piece;
pub(crate) use stiffest::{IN_PULSE, Stiffest, dividing, divisor, overshoot};

use crate::Context;
use crate::contact::Pair;
use crate::dem::rig::Gain;
use crate::dem::{
    ContactRecord, ForcePulse, Impact, Mirror, OVERLAP_WARNING, OverlapAtRest, RESIDUAL_LIMIT, Record, Strike,
    simulate, simulate_with_friction,
};
use crate::design::{Design, DesignRef};
use crate::lattice::{HexagonalSheet, SheetPacking};
use crate::layout::Layout;
use crate::material::Material;
use crate::outcome::{COMMIT, Method, VERSION};
use crate::sample::Sample;
use crate::score::Scores;
use crate::target::TargetSites;
use crate::units::Dimension::Length;
use crate::wave::{Dimension, Validity, driving_force};

/// One arrangement, simulated and scored.
#[derive(Clone, Debug)]
pub struct Evaluation<const D: usize = 2> {
    /// The numbers; ratios to uniform crystals are not there yet.
    pub scores: Scores,
    /// What each sphere and contact felt.
    pub record: Record<D>,
    /// What limits the trust in the numbers.
    pub doubts: Doubts,
}

impl<const D: usize> Evaluation<D> {
    /// What a reader should know before trusting the numbers.
    pub fn warnings(&self, name: &str) -> Vec<String> {
        self.doubts.words(name)
    }
}

/// An arrangement that cannot be simulated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EvaluateError {
    /// Spheres that overlap at rest; no layout on a lattice has such.
    #[error(transparent)]
    Overlap(#[from] OverlapAtRest),
}

/// Simulates and scores one arrangement of a design.
///
/// # Errors
/// See [`EvaluateError`].
pub fn evaluate(design: &Design, layout: &Layout, plan: &Plan, context: &Context) -> Result<Evaluation, EvaluateError> {
    let sample = layout.sample();
    let record = simulated(design, &sample, plan, context)?;
    let within = design.target.on(&layout.lattice);
    let mut scores = Scores::of_sites(&record.max_kinetic, &within);
    scores.add_records(&record, &within, |site| [site; 2], 1.0, |sphere| sample.mass(sphere));
    scores.add_layout(&layout.stats(|material| design.price(material)));
    let doubts = Doubts::of(&record, &sample, &record.max_kinetic, (design, layout.lattice.diameter()), &within);
    Ok(Evaluation { scores, record, doubts })
}

/// With what, and how, a plan's runs are made.
pub fn method<L, R>(design: &Design<L, R>, plan: &Plan) -> Method {
    Method {
        version: VERSION.to_owned(),
        commit: COMMIT.to_owned(),
        law: design.law_name(),
        constants: Some(design.constants.to_string()),
        integrator: plan.integrator.to_string(),
        step_s: plan.step,
        step_reason: plan.step_reason.clone(),
        window_s: plan.window,
        window_reason: plan.window_reason.clone(),
    }
}

/// What each sphere of a layout feels under a design's impact.
fn simulated(design: &Design, sample: &Sample<2>, plan: &Plan, context: &Context) -> Result<Record<2>, EvaluateError> {
    let impact = impact(design, plan);
    Ok(match design.friction {
        Some(coefficient) => simulate_with_friction(sample, &impact, coefficient, context)?,
        None => simulate(sample, &impact, context)?,
    })
}

/// The design's impact: a pulse on row 1, or half of a projectile before it, mirrors on both sides, the far end free.
pub fn impact(design: &Design, plan: &Plan) -> Impact {
    let lattice = &design.lattice;
    let sites = lattice.sites();
    let row = |number: u32| (0..sites.len()).filter(|&i| sites[i].row == number).collect();
    let impact = Impact {
        mirrors: vec![
            Mirror { axis: 0, position: 0.0, inward: 1.0 },
            Mirror { axis: 0, position: lattice.half_width(), inward: -1.0 },
        ],
        law: design.law,
        constants: design.constants,
        pulse: NO_PULSE,
        periods: Vec::new(),
        slope: 0.0,
        struck: row(1),
        faces: Vec::new(),
        moving: Vec::new(),
        projectile: None,
        exit: row(lattice.rows()),
        integrator: plan.integrator,
        step: plan.step,
        window: plan.window,
    };
    impact.struck_by(design.impact.of_part(0.5))
}

/// Strengths of one strike as forces (N), or as speeds (m/s).
pub fn parted(strike: Strike, strengths: Vec<f64>) -> (Vec<f64>, Vec<f64>) {
    match strike {
        Strike::Pulse(_) => (strengths, Vec::new()),
        Strike::Projectile(_) => (Vec::new(), strengths),
    }
}

/// What stands for the pulse of an impact until it is said what strikes.
const NO_PULSE: ForcePulse = ForcePulse { force: 0.0, duration: 0.0 };

/// The force (N) on each struck sphere of a material: a pulse's own, or what a projectile's first wave carries.
pub fn struck_force<L, R>(design: &Design<L, R>, dimension: Dimension, material: &Material, diameter: f64) -> f64 {
    match design.impact {
        Strike::Pulse(pulse) => pulse.force,
        Strike::Projectile(flat) => driving_force(dimension, flat.speed, material, diameter, design.constants),
    }
}

/// As what waves see a sheet: a square packing is chains beside each other, for waves along its rows and columns.
pub fn dimension_of(lattice: &HexagonalSheet) -> Dimension {
    match lattice.packing() {
        SheetPacking::Hexagonal => Dimension::Two,
        SheetPacking::Square => Dimension::One,
    }
}

/// How strong the impact is for each material: contact force over F_p, and what that means for the wave-speed bound.
pub fn validity<'a>(design: impl Into<DesignRef<'a>>, material: &Material) -> Validity {
    fn of<L, R>(design: &Design<L, R>, dimension: Dimension, diameter: f64, material: &Material) -> Validity {
        let force = struck_force(design, dimension, material, diameter);
        Validity::new(dimension, force, material, diameter, design.constants)
    }
    let design = design.into();
    match design {
        DesignRef::Plane(sheet) => of(sheet, dimension_of(&sheet.lattice), design.diameter(), material),
        DesignRef::Space(crystal) => of(crystal, Dimension::Three, design.diameter(), material),
    }
}

/// What limits the trust in one run's numbers, as measured on it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Doubts {
    /// Greatest overlap (m), and over the diameter.
    overlap: [f64; 2],
    /// Greatest overlap over δ_p; zero for elastic laws.
    depth: f64,
    /// Spheres of the focal and the protected region that the wave had not reached at the end.
    unreached: usize,
    /// What contacts gave back beyond what was put into them, and the energy at hand (J).
    made: Option<(Gain, f64)>,
}

impl Doubts {
    /// Greatest overlap over the diameter.
    pub fn greatest_overlap(&self) -> f64 {
        self.overlap[1]
    }

    /// Greatest overlap over δ_p; zero for elastic laws.
    pub fn greatest_depth(&self) -> f64 {
        self.depth
    }

    /// `max_kinetic` is that of every site of the half.
    fn of<const D: usize, L, R>(
        record: &Record<D>,
        sample: &Sample<D>,
        max_kinetic: &[f64],
        (design, diameter): (&Design<L, R>, f64),
        sites: &TargetSites,
    ) -> Self {
        let overlap = record.contacts.iter().map(|contact| contact.overlap_max).fold(0.0, f64::max);
        let depth = |contact: &ContactRecord| {
            let materials = contact.spheres.map(|i| &sample.materials[sample.spheres[i].material]);
            let radii = contact.spheres.map(|i| sample.spheres[i].radius);
            let pair = Pair::new(materials, radii, design.constants);
            contact.overlap_max / pair.regions(1.0).plastic_overlap
        };
        let depth = if design.law.is_plastic() { record.contacts.iter().map(depth).fold(0.0, f64::max) } else { 0.0 };
        let strongest = max_kinetic.iter().copied().fold(0.0, f64::max);
        let mut wanted = [&sites.focal[..], &sites.protected].concat();
        wanted.sort_unstable();
        wanted.dedup();
        let unreached = wanted.into_iter().filter(|&site| max_kinetic[site] <= UNREACHED * strongest).count();
        // Of a run that was stopped early nobody expects that it gets there.
        let unreached = if record.stop.is_none() { unreached } else { 0 };
        let made = Some((made::gain(design.law, &record.contacts), record.ledger.work_in));
        Self { overlap: [overlap, overlap / diameter], depth, unreached, made }
    }

    /// The worst of both.
    fn worse(self, other: Self) -> Self {
        let overlap = if other.overlap[1] > self.overlap[1] { other.overlap } else { self.overlap };
        let unreached = self.unreached.max(other.unreached);
        let share = |made: &Option<(Gain, f64)>| made.as_ref().map_or(0.0, |(gain, at_hand)| gain.energy / at_hand);
        let made = if share(&other.made) > share(&self.made) { other.made } else { self.made };
        Self { overlap, depth: self.depth.max(other.depth), unreached, made }
    }

    /// In words, one doubt each; `whose` says where it was found: `lens`, `15 arrangements`.
    fn words(&self, whose: &str) -> Vec<String> {
        let mut words = Vec::new();
        if self.unreached > 0 {
            words.push(format!(
                "{whose}: the window ends before the wave reaches {} of the spheres in the focal and the protected region; \
                 lengthen it",
                self.unreached
            ));
        }
        let [overlap, ratio] = self.overlap;
        if ratio > OVERLAP_WARNING {
            words.push(format!(
                "{whose}: overlaps reach {} ({:.1} % of the diameter); from {:.1} % on contacts 60 degrees apart on a \
                 sphere grow into each other",
                Length.show(overlap),
                100.0 * ratio,
                100.0 * OVERLAP_WARNING
            ));
        }
        let made = self.made.as_ref().and_then(|(gain, at_hand)| made::gain_words(gain, *at_hand, RESIDUAL_LIMIT));
        words.extend(made.map(|made| format!("{whose}: {made}")));
        if self.depth > FITTED_DEPTH {
            words.push(format!(
                "{whose}: overlaps reach {:.1} delta_p; the law was fitted up to about {FITTED_DEPTH} delta_p \
                 (Burgoyne 2016, section 2.1.1) and is extrapolated along its straight line",
                self.depth
            ));
        }
        words
    }
}

/// Greatest kinetic energy of a sphere over that of any, below which no wave has passed it. In the lens problem the
/// protected spheres come to some 1e-3; ahead of a front motion falls off faster than exponentially.
const UNREACHED: f64 = 1e-6;

/// Overlap over δ_p up to which the plastic laws were fitted (Burgoyne 2016, section 2.1.1).
const FITTED_DEPTH: f64 = 2.0;

#[cfg(test)]
mod tests {
    use super::*;

    /// Each doubt is told above its limit and not below it, with the number that it is about.
    #[test]
    fn doubts_are_told_above_their_limits_only() {
        let words = |doubts: Doubts| doubts.words("this layout").join("\n");
        let overlap = |ratio: f64| words(Doubts { overlap: [ratio * 6.35e-3, ratio], ..Doubts::default() });
        assert_eq!(overlap(0.99 * OVERLAP_WARNING), "");
        assert!(overlap(0.2).contains("overlaps reach 1.27 mm (20.0 % of the diameter)"), "{}", overlap(0.2));
        let depth = |depth: f64| words(Doubts { depth, ..Doubts::default() });
        assert_eq!(depth(0.99 * FITTED_DEPTH), "");
        assert!(depth(12.5).contains("overlaps reach 12.5 delta_p"), "{}", depth(12.5));
        let unreached = |unreached: usize| words(Doubts { unreached, ..Doubts::default() });
        assert_eq!(unreached(0), "");
        assert!(unreached(3).contains("reaches 3 of the spheres"), "{}", unreached(3));
    }
}
