//! Many layouts of one design at once: as many in the lanes of a core as these hold, and groups of these in parallel.

use rayon::prelude::*;

use super::load::{AnyField, Field, ImpactLoad, Imperfection, LoadCase};
use super::part::Parts;
use super::{EvaluateError, Overrides, Plan, PlanError, common_plan};
use crate::Context;
use crate::dem::{
    BatchError, Limit, MoveIn, OverlapAtRest, Record, Spheres, Stop, Strike, simulate, simulate_batch_under,
    simulate_with_friction,
};
use crate::design::DesignRef;
use crate::material::Material;
use crate::real::Width;
use crate::sample::Sample;
use crate::score::Scores;
use crate::target::TargetSites;

/// One layout under one impact, as a search needs it.
#[derive(Clone, Debug, PartialEq)]
pub struct Evaluated {
    /// The numbers; what the layout itself says is not among them.
    pub scores: Scores,
    /// Why the run ended early, if it did; its numbers are then not to be trusted.
    pub stop: Option<Stop>,
}

/// How much is recorded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Detail {
    /// Energies only, many layouts side by side.
    #[default]
    Energies,
    /// All that records say too, one layout at a time; some four times the work.
    Everything,
}

/// A design that cannot be evaluated in batches.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EvaluatorError {
    /// A step or window with which nothing can be simulated.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// Layouts that do not go together, or spheres that overlap at rest.
    #[error(transparent)]
    Batch(#[from] BatchError),
    /// Spheres that overlap at rest.
    #[error(transparent)]
    Overlap(#[from] OverlapAtRest),
    /// A guard stopped a uniform crystal, to which others are compared.
    #[error("the crystal of {material} alone, to which layouts are compared, cannot be simulated: {stop}")]
    Baseline {
        /// Its material.
        material: String,
        /// Why.
        stop: Stop,
    },
    /// Q has nothing to refer to.
    #[error("there is no Q: the design names no material for the crystal that it refers to")]
    NoReference,
    /// The request to stop came before anything was evaluated.
    #[error("interrupted before anything was evaluated")]
    Interrupted,
}

impl From<EvaluateError> for EvaluatorError {
    fn from(error: EvaluateError) -> Self {
        match error {
            EvaluateError::Overlap(error) => error.into(),
        }
    }
}

/// What stands side by side has all of these alike: the load but for its pulse, whether a sixth is simulated, unequal radii, and materials of its own.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Kind(usize, bool, bool, bool);

/// Turns layouts of one design into scores, relative to the crystal of host and that of lens material alone under the same
/// impact.
pub struct Evaluator {
    plan: Plan,
    /// Of the half
    sites: usize,
    /// Those of the target's regions.
    within: TargetSites,
    /// What is simulated under each different load.
    fields: Vec<AnyField>,
    /// For each field the first one that differs from it in nothing but the pulse.
    kin: Vec<usize>,
    /// For each member of the set its field and its imperfection.
    cases: Vec<(usize, Imperfection)>,
    palette: Vec<Material>,
    width: Width,
    detail: Detail,
    /// For each field F of the crystal of host alone, P of that of lens material alone (J); the latter 0 where there is none.
    uniform: Vec<[f64; 2]>,
    /// For each field the least P of the rivals (J); none without rivals.
    rivals: Option<Vec<f64>>,
    no_protection: Option<EvaluatorError>,
}

impl Evaluator {
    /// Chooses step and window, and simulates the uniform crystals under each impact. `cases` are impacts, or impacts on
    /// crystals with imperfections; `palette` holds the host and others. What Q refers to is the design's, see [`Design::reference`](crate::design::Design::reference). In space
    /// impacts are straight, on all of layer 1.
    ///
    /// # Errors
    /// See [`EvaluatorError`].
    pub fn new<'d, C: Clone + Into<LoadCase>>(
        design: impl Into<DesignRef<'d>>,
        cases: &[C],
        mut palette: Vec<Material>,
        overrides: Overrides,
        context: &Context,
    ) -> Result<Self, EvaluatorError> {
        let design = design.into();
        let reference = design.reference().map(|reference| {
            palette.iter().position(|material| material == reference).unwrap_or_else(|| {
                palette.push(reference.clone());
                palette.len() - 1
            }) as u8
        });
        let mut evaluator = Self::alone(design, cases, palette, overrides)?;
        let perfect = (0..evaluator.fields.len()).map(|field| (field, Imperfection::default())).collect();
        let members = std::mem::replace(&mut evaluator.cases, perfect);
        let uniform: Vec<u8> = std::iter::once(0).chain(reference).collect();
        let layouts: Vec<_> = uniform.iter().map(|&material| vec![material; evaluator.sites]).collect();
        let runs = evaluator.scores(&layouts, context)?;
        for (runs, &k) in runs.iter().zip(&uniform) {
            let Some(stop) = runs.iter().find_map(|run| run.stop.as_ref()) else { continue };
            if matches!(stop, Stop::Interrupted { .. }) {
                return Err(EvaluatorError::Interrupted);
            }
            let (material, stop) = (evaluator.palette[usize::from(k)].name.clone(), stop.clone());
            let error = EvaluatorError::Baseline { material, stop };
            // Without its host a layout cannot be judged; without lens material alone it has no Q.
            if k == 0 {
                return Err(error);
            }
            evaluator.no_protection = Some(error);
        }
        if reference.is_none() {
            evaluator.no_protection = Some(EvaluatorError::NoReference);
        }
        let protected = |field: usize| match runs.get(1).map(|runs| &runs[field]) {
            Some(Evaluated { scores, stop: None }) => scores.protected_mean,
            _ => 0.0,
        };
        evaluator.uniform =
            runs[0].iter().enumerate().map(|(field, host)| [host.scores.focal_mean, protected(field)]).collect();
        evaluator.cases = members;
        Ok(evaluator)
    }

    /// Without uniform crystals to relate to: there is no G and no Q.
    pub(super) fn alone<'d, C: Clone + Into<LoadCase>>(
        design: impl Into<DesignRef<'d>>,
        cases: &[C],
        palette: Vec<Material>,
        overrides: Overrides,
    ) -> Result<Self, EvaluatorError> {
        let design = design.into();
        let mut loads: Vec<(ImpactLoad, bool)> = Vec::new();
        let mut members = Vec::new();
        for LoadCase { load, imperfection, halves_differ } in cases.iter().cloned().map(Into::into) {
            let of = (load, halves_differ || imperfection.is_one_sided(design.sites()));
            let known = loads.iter().position(|known| *known == of);
            members.push((known.unwrap_or(loads.len()), imperfection));
            if known.is_none() {
                loads.push(of);
            }
        }
        let plan = common_plan(design, &loads.iter().map(|(load, _)| *load).collect::<Vec<_>>(), overrides, &palette)?;
        let field = |(load, whole): &(ImpactLoad, bool)| match design {
            DesignRef::Plane(design) => AnyField::Plane(Box::new(Field::new(design, &plan, load, *whole))),
            DesignRef::Space(design) => AnyField::Space(Box::new(Parts::new(design, &plan, load, *whole))),
        };
        let fields: Vec<AnyField> = loads.iter().map(field).collect();
        let alike = |(load, whole): &(ImpactLoad, bool)| {
            let is_kin = |other: &ImpactLoad| {
                other.strike.is_like(&load.strike) && ImpactLoad { strike: load.strike, ..*other } == *load
            };
            loads.iter().position(|(other, also)| also == whole && is_kin(other))
        };
        let kin = loads.iter().filter_map(alike).collect();
        Ok(Self {
            plan,
            sites: design.sites(),
            within: match design {
                DesignRef::Plane(design) => design.target.on(&design.lattice),
                DesignRef::Space(design) => design.target.on(&design.lattice),
            },
            uniform: vec![[0.0; 2]; fields.len()],
            fields,
            kin,
            cases: members,
            palette,
            width: Width::widest(),
            detail: Detail::Energies,
            rivals: None,
            no_protection: None,
        })
    }

    /// With as much recorded of every layout as is said.
    #[must_use]
    pub fn recording(mut self, detail: Detail) -> Self {
        self.detail = detail;
        self
    }

    /// Compares every layout with the best of some others too, under the same impacts on crystals as drawn.
    ///
    /// # Errors
    /// As [`scores`](Self::scores), and where all of them were stopped by a guard, or on request.
    pub fn against(mut self, layouts: &[Vec<u8>], context: &Context) -> Result<Self, EvaluatorError> {
        let perfect = (0..self.fields.len()).map(|field| (field, Imperfection::default())).collect();
        let cases = std::mem::replace(&mut self.cases, perfect);
        let detail = std::mem::take(&mut self.detail);
        let runs = self.scores(layouts, context)?;
        (self.cases, self.detail) = (cases, detail);
        let least = |field: usize| {
            let finished = runs.iter().map(|runs| &runs[field]).filter(|run| run.stop.is_none());
            finished.map(|run| run.scores.protected_mean).reduce(f64::min).ok_or(EvaluatorError::Interrupted)
        };
        self.rivals = Some((0..self.fields.len()).map(least).collect::<Result<_, _>>()?);
        Ok(self)
    }

    /// Why there is no Q under one of the impacts, if so: a guard stopped the crystal of lens material alone, as it does where
    /// that is too soft for the impact on its first row.
    pub fn no_protection(&self) -> Option<&EvaluatorError> {
        self.no_protection.as_ref()
    }

    /// Step and window.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// Scores of layouts, each an index into the palette for every site of the lattice, or for every place where halves differ: for
    /// each layout those in each case. The bits of a layout's scores depend neither on the number of threads nor on what stands beside it.
    ///
    /// # Errors
    /// See [`EvaluatorError`].
    pub fn scores(&self, layouts: &[Vec<u8>], context: &Context) -> Result<Vec<Vec<Evaluated>>, EvaluatorError> {
        self.scores_up_to(layouts, None, context)
    }

    /// As [`scores`](Self::scores), where a run ends as soon as its P is above what is still of interest (J), given for each layout
    /// and each case: it has [`Stop::Beyond`] then, and F and P are lower bounds. A search that asks for a contrast C and knows that no F
    /// exceeds some F_max loses nothing with F_max/C. Without full records only.
    ///
    /// # Errors
    /// As there.
    pub fn scores_within(
        &self,
        layouts: &[Vec<u8>],
        protected_mean: &[Vec<f64>],
        context: &Context,
    ) -> Result<Vec<Vec<Evaluated>>, EvaluatorError> {
        self.scores_up_to(layouts, Some(protected_mean), context)
    }

    /// What a layout with given F and P (J) would score in one of the cases, by these alone.
    pub fn related(&self, case: usize, focal_mean: f64, protected_mean: f64) -> Scores {
        let contrast = crate::score::ratio(focal_mean, protected_mean);
        let mut scores = Scores { focal_mean, protected_mean, contrast, ..Scores::default() };
        self.relate(&mut scores, self.cases[case].0);
        scores
    }

    fn scores_up_to(
        &self,
        layouts: &[Vec<u8>],
        most: Option<&[Vec<f64>]>,
        context: &Context,
    ) -> Result<Vec<Vec<Evaluated>>, EvaluatorError> {
        // What is built under blows that differ in their pulse alone, each a case and a layout, stands side by side; spheres of unequal
        // size cost more, so they stand together. Materials of a case's own make kinds of contacts of its own, of which the lanes tell
        // sixteen apart.
        let lanes = if self.detail == Detail::Everything { 1 } else { self.width.lanes() };
        let kinds = self.palette.len() * (self.palette.len() + 1) / 2;
        let few = (16 / kinds.max(1)).clamp(1, lanes);
        let kind = |case: usize, layout: usize| {
            let (field, imperfection) = &self.cases[case];
            let is_sixth = self.fields[*field].is_sixth(&layouts[layout], imperfection);
            Kind(self.kin[*field], is_sixth, !imperfection.radii.is_empty(), !imperfection.materials.is_empty())
        };
        let mut built: Vec<(Kind, usize, usize)> = (0..self.cases.len())
            .flat_map(|case| (0..layouts.len()).map(move |layout| (case, layout)))
            .map(|(case, layout)| (kind(case, layout), case, layout))
            .collect();
        built.sort_by_key(|(kind, ..)| *kind);
        let together = |alike: &'_ [(Kind, usize, usize)]| if alike[0].0.3 { few } else { lanes };
        let groups: Vec<&[(Kind, usize, usize)]> =
            built.chunk_by(|a, b| a.0 == b.0).flat_map(|alike| alike.chunks(together(alike))).collect();
        let simulated = groups
            .par_iter()
            .map(|group| self.follow(group, layouts, most, context))
            .collect::<Result<Vec<_>, EvaluatorError>>()?;
        let mut runs: Vec<Vec<Option<Evaluated>>> = vec![vec![None; self.cases.len()]; layouts.len()];
        for (&(_, case, layout), mut run) in groups.into_iter().flatten().zip(simulated.into_iter().flatten()) {
            self.relate(&mut run.scores, self.cases[case].0);
            runs[layout][case] = Some(run);
        }
        Ok(runs.into_iter().map(|of_layout| of_layout.into_iter().flatten().collect()).collect())
    }

    /// Cases and layouts side by side, all under the same impact but for its pulse.
    fn follow(
        &self,
        group: &[(Kind, usize, usize)],
        layouts: &[Vec<u8>],
        most: Option<&[Vec<f64>]>,
        context: &Context,
    ) -> Result<Vec<Evaluated>, EvaluatorError> {
        let Some(&(Kind(_, is_sixth, ..), first, _)) = group.first() else { return Ok(Vec::new()) };
        if context.stopped() {
            // Groups that have not begun do not begin: to prepare each of many takes longer than anybody waits.
            let none = Evaluated { scores: Scores::default(), stop: Some(Stop::Interrupted { time_s: 0.0 }) };
            return Ok(vec![none; group.len()]);
        }
        match &self.fields[self.cases[first].0] {
            AnyField::Plane(field) => {
                self.follow_in(field, group, layouts, most, context, |sample| match field.friction {
                    Some(coefficient) => simulate_with_friction(sample, &field.impact, coefficient, context),
                    None => simulate(sample, &field.impact, context),
                })
            }
            AnyField::Space(parts) => {
                let field = parts.field(is_sixth);
                self.follow_in(field, group, layouts, most, context, |sample| simulate(sample, &field.impact, context))
            }
        }
    }

    fn follow_in<const D: usize>(
        &self,
        field: &Field<D>,
        group: &[(Kind, usize, usize)],
        layouts: &[Vec<u8>],
        most: Option<&[Vec<f64>]>,
        context: &Context,
        recorded: impl Fn(&Sample<D>) -> Result<Record<D>, OverlapAtRest>,
    ) -> Result<Vec<Evaluated>, EvaluatorError>
    where
        Spheres: MoveIn<D>,
    {
        let sample = |&(_, case, layout): &(Kind, usize, usize)| {
            field.sample(&self.palette, &layouts[layout], &self.cases[case].1)
        };
        let samples: Vec<_> = group.iter().map(sample).collect();
        if self.detail == Detail::Everything {
            return samples.iter().map(|sample| Ok(self.scores_of(field, sample, &recorded(sample)?))).collect();
        }
        let limit = most.map(|most| {
            let sites = &self.within.protected;
            let share = 0.5 / sites.len() as f64;
            // P is the mean over sites of the mean of a site and its image, which in the half are one.
            let spheres = sites.iter().flat_map(|&site| field.on(site)).map(|sphere| (sphere, share)).collect();
            Limit { spheres, most: group.iter().map(|&(_, case, layout)| most[layout][case]).collect() }
        });
        let strikes: Vec<Strike> =
            group.iter().map(|&(kind, case, _)| self.fields[self.cases[case].0].impact(kind.1).strike()).collect();
        let (impact, friction) = (&field.impact, field.friction);
        let peak_energies =
            simulate_batch_under(&samples, impact, &strikes, friction, limit.as_ref(), self.width, context)?;
        Ok(peak_energies
            .into_iter()
            .map(|peaks| Evaluated {
                scores: self.energies(&field.folded(&peaks.max_kinetic)),
                stop: peaks.stop.map(|stop| field.named(stop)),
            })
            .collect())
    }

    /// One layout with full records.
    fn scores_of<const D: usize>(&self, field: &Field<D>, sample: &Sample<D>, record: &Record<D>) -> Evaluated {
        let mut scores = self.energies(&field.folded(&record.max_kinetic));
        scores.add_records(record, &self.within, |site| field.on(site), field.share, |sphere| sample.mass(sphere));
        Evaluated { scores, stop: record.stop.clone().map(|stop| field.named(stop)) }
    }

    fn energies(&self, max_kinetic: &[f64]) -> Scores {
        Scores::of_sites(max_kinetic, &self.within)
    }

    fn relate(&self, scores: &mut Scores, field: usize) {
        let [host, lens] = self.uniform[field];
        scores.relate(Some(host), Some(lens));
        scores.protection_best =
            self.rivals.as_ref().and_then(|rivals| crate::score::ratio(scores.protected_mean, rivals[field]));
    }
}
