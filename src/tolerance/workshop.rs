//! Makes pieces and simulates them, many side by side.

use rayon::prelude::*;

use super::piece::{Piece, largest};
use super::quantity::{Quantity, quantities};
use super::{State, Tolerances};
use crate::dem::Projectile;
use crate::dem::Stop;
use crate::dem::rig::RigStop;
use crate::design::Design;
use crate::evaluate::{
    Detail, Drawing, Evaluator, EvaluatorError, Frame, HeldError, HeldSphere, ImpactLoad, LoadCase, Overrides, Plan,
    Subject, held_energies, held_spheres,
};
use crate::material::Material;
use crate::score::{Measure, Needs, Scores};
use crate::{Context, Progress};

/// Why pieces cannot be simulated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum WorkshopError {
    /// On their sites.
    #[error(transparent)]
    Evaluator(#[from] EvaluatorError),
    /// In their frame.
    #[error(transparent)]
    Held(#[from] HeldError),
    /// What needs full records is asked of pieces in a frame.
    #[error(
        "{0} needs full records, which are kept of pieces on nominal sites under pulses only; ask for another, or leave state = \"settled\" and \
         projectiles out"
    )]
    Records(&'static str),
    /// One half is to say all, of two that differ.
    #[error(
        "halves = \"alike\" is for pieces whose halves are drawn alike, and those of this layout differ; leave it out"
    )]
    Halves,
    /// A design's projectile is to come slanted, beside the axis, or for some time.
    #[error(
        "the design's projectile is a flat that strikes all of row 1 straight: impact.angle, impact.off_centre and impact.duration are those of a pulse; leave them \
         out"
    )]
    Projectile,
    /// What is asked of pieces in space is of sheets.
    #[error("{0} is for sheets, and this design is a crystal in space; leave it out")]
    Sheets(&'static str),
}

/// What a piece does.
#[derive(Clone, Debug, PartialEq)]
pub struct Made {
    /// The numbers; not to be trusted where it was stopped.
    pub scores: Scores,
    /// Why a guard stopped it, or that it does not stand.
    pub stop: Option<String>,
}

/// Pieces simulated between two looks at the progress.
const BLOCK: usize = 128;

/// A workshop that makes one layout.
pub struct Workshop<'a> {
    drawing: Drawing<'a>,
    tolerances: &'a Tolerances,
    plan: &'a Plan,
    quantities: Vec<Quantity>,
    detail: Detail,
}

impl<'a> Workshop<'a> {
    /// With what is asked of its pieces: measures that need full records make it some four times as slow.
    ///
    /// # Errors
    /// Records of pieces that have none, halves that differ of which one is to say all, and in space what is of sheets.
    pub fn new(
        drawing: impl Into<Drawing<'a>>,
        tolerances: &'a Tolerances,
        plan: &'a Plan,
        asked: &[Measure],
    ) -> Result<Self, WorkshopError> {
        let drawing = drawing.into();
        if let Some(what) = tolerances.of_sheets().filter(|_| drawing.is_in_space()) {
            return Err(WorkshopError::Sheets(what));
        }
        if drawing.halves_differ() && tolerances.halves_alike {
            return Err(WorkshopError::Halves);
        }
        let of_pulse = [tolerances.impact.duration, tolerances.impact.angle, tolerances.impact.off_centre];
        if drawing.design().impact().projectile().is_some() && of_pulse.iter().any(|&limit| limit != 0.0) {
            return Err(WorkshopError::Projectile);
        }
        let records = asked.iter().find(|measure| measure.needs() == Needs::Records);
        let detail = match records {
            Some(measure)
                if tolerances.state == State::Settled
                    || (tolerances.impact.projectile.is_some() && !drawing.is_in_space()) =>
            {
                return Err(WorkshopError::Records(measure.name()));
            }
            Some(_) => Detail::Everything,
            None => Detail::Energies,
        };
        let friction = match drawing {
            Drawing::Plane(design, _) => design.friction.unwrap_or(0.0),
            Drawing::Space(..) => 0.0,
        };
        let quantities = quantities(tolerances, drawing, friction);
        Ok(Self { drawing, tolerances, plan, quantities, detail })
    }

    /// What may turn out otherwise.
    pub fn quantities(&self) -> &[Quantity] {
        &self.quantities
    }

    /// What it makes.
    pub fn drawing(&self) -> Drawing<'a> {
        self.drawing
    }

    /// Its tolerances.
    pub fn tolerances(&self) -> &Tolerances {
        self.tolerances
    }

    /// Step and window.
    pub fn plan(&self) -> &Plan {
        self.plan
    }

    /// The measures that are known of its pieces.
    pub fn measures(&self) -> impl Iterator<Item = Measure> + use<> {
        let records = self.detail == Detail::Everything;
        let known = move |needs: Needs| needs == Needs::Energies || (records && needs == Needs::Records);
        Measure::ALL.iter().copied().filter(move |measure| known(measure.needs()) && *measure != Measure::Balance)
    }

    /// Simulates pieces, each struck with these parts of its force: for each piece its runs. The context is told how many are done.
    ///
    /// # Errors
    /// See [`WorkshopError`]. A piece that a guard stops is none.
    pub fn runs(&self, pieces: &[Piece], factors: &[f64], context: &Context) -> Result<Vec<Vec<Made>>, WorkshopError> {
        let mut runs = Vec::with_capacity(pieces.len());
        // Each force has uniform crystals of its own, which many pieces are to share.
        for block in pieces.chunks(if factors.len() > 1 { BLOCK / 2 } else { BLOCK }) {
            runs.extend(self.block(block, factors, context)?);
            context.tell(Progress::Finished { count: block.len() as u64, name: "" });
        }
        Ok(runs)
    }

    fn block(&self, pieces: &[Piece], factors: &[f64], context: &Context) -> Result<Vec<Vec<Made>>, WorkshopError> {
        let Tolerances { state, side_gap, end_gap, .. } = *self.tolerances;
        let Drawing::Plane(design, subject) = self.drawing else {
            return self.on_sites(pieces.iter(), factors, context);
        };
        let drawn = (design, subject);
        if state == State::Settled {
            let all: Vec<&Piece> = pieces.iter().collect();
            return self.held(drawn, &all, factors, Frame::Settled { side_gap, end_gap }, context);
        }
        // A plate has to be followed as a rig, whose sides repeat themselves as mirrors do.
        let is_thrown = |piece: &Piece| piece.projectile(self.tolerances, &self.quantities, 1.0).is_some();
        let thrown: Vec<&Piece> = pieces.iter().filter(|piece| is_thrown(piece)).collect();
        let mut thrown = self.held(drawn, &thrown, factors, Frame::Mirrors, context)?.into_iter();
        let mut pulsed = self.on_sites(pieces.iter().filter(|piece| !is_thrown(piece)), factors, context)?.into_iter();
        let in_order = pieces.iter().filter_map(|piece| if is_thrown(piece) { thrown.next() } else { pulsed.next() });
        Ok(in_order.collect())
    }

    /// Pieces on their sites, side by side.
    fn on_sites<'b>(
        &self,
        pieces: impl Iterator<Item = &'b Piece>,
        factors: &[f64],
        context: &Context,
    ) -> Result<Vec<Vec<Made>>, WorkshopError> {
        let of = |piece: &Piece| -> Vec<LoadCase> {
            let case = |&factor: &f64| piece.case(self.tolerances, &self.quantities, self.drawing, factor);
            factors.iter().map(case).collect()
        };
        let cases: Vec<LoadCase> = pieces.flat_map(of).collect();
        if cases.is_empty() {
            return Ok(Vec::new());
        }
        self.cases(&cases, context).map(|runs| runs.chunks(factors.len()).map(<[_]>::to_vec).collect())
    }

    /// Simulates the layout in any cases, on its sites.
    ///
    /// # Errors
    /// See [`WorkshopError`].
    pub fn cases(&self, cases: &[LoadCase], context: &Context) -> Result<Vec<Made>, WorkshopError> {
        let given = Overrides {
            integrator: Some(self.plan.integrator),
            step: Some(self.plan.step),
            window: Some(self.plan.window),
            first_seed: None,
        };
        let evaluator = Evaluator::new(self.drawing.design(), cases, self.drawing.palette().to_vec(), given, context)?;
        let evaluator = evaluator.recording(self.detail);
        let runs = evaluator.scores(&[self.drawing.materials()], context)?.concat();
        if runs.iter().any(|run| matches!(run.stop, Some(Stop::Interrupted { .. }))) {
            return Err(EvaluatorError::Interrupted.into());
        }
        let made =
            |run: crate::evaluate::Evaluated| Made { scores: run.scores, stop: run.stop.map(|stop| stop.to_string()) };
        Ok(runs.into_iter().map(made).collect())
    }

    /// The same for pieces that settle in their frame, or are struck by a projectile, one by one; uniform crystals, of perfect spheres, are held and
    /// struck alike.
    fn held(
        &self,
        (design, subject): (&Design, Subject<'_>),
        pieces: &[&Piece],
        factors: &[f64],
        frame: Frame,
        context: &Context,
    ) -> Result<Vec<Vec<Made>>, WorkshopError> {
        let layout = subject.layout;
        let sites = layout.materials.len();
        let strikes = |piece: &Piece, factor: f64| {
            let load = piece.load(self.drawing, &self.quantities, factor);
            (load, piece.projectile(self.tolerances, &self.quantities, factor))
        };
        let of = |piece: &Piece| {
            let (diameters, materials, palette) = piece.parts(self.tolerances, &self.quantities, self.drawing);
            // On their sites, which are as far apart as the largest needs, by similarity; in a frame each is as large as it is.
            let largest = largest(self.drawing, &diameters);
            let scale = if frame == Frame::Mirrors { layout.lattice.diameter() / largest } else { 1.0 };
            // As the map has it: places on the other side come after the sites.
            let mut spheres = held_spheres(subject);
            for sphere in &mut spheres {
                let image = sphere.centre[0] < 0.0 && diameters.len() > sites;
                let place = if image { sites + sphere.site } else { sphere.site };
                (sphere.diameter, sphere.material) = (scale * diameters[place], usize::from(materials[place]));
            }
            (spheres, palette)
        };
        let mut loads: Vec<(ImpactLoad, Option<Projectile>)> = Vec::new();
        let mut jobs: Vec<(usize, Vec<HeldSphere>, Vec<Material>)> = Vec::new();
        let mut place = |load: (ImpactLoad, Option<Projectile>)| {
            loads.iter().position(|known| *known == load).unwrap_or_else(|| {
                loads.push(load);
                loads.len() - 1
            })
        };
        for piece in pieces {
            let (spheres, palette) = of(piece);
            for &factor in factors {
                let load = place(strikes(piece, factor));
                jobs.push((load, spheres.clone(), palette.clone()));
            }
        }
        let count = jobs.len();
        let reference = design.reference().cloned();
        let uniform: Vec<Material> = std::iter::once(layout.palette[0].clone()).chain(reference).collect();
        for load in 0..loads.len() {
            for material in &uniform {
                let spheres = held_spheres(layout).into_iter().map(|sphere| HeldSphere { material: 0, ..sphere });
                jobs.push((load, spheres.collect(), vec![material.clone()]));
            }
        }
        let within = (&design.lattice, &design.target);
        let runs: Vec<Made> = jobs
            .into_par_iter()
            .map(|(load, spheres, palette)| {
                let (load, projectile) = &loads[load];
                let held = (frame, load, *projectile);
                match held_energies((design, self.plan), &palette, spheres, held, context) {
                    Ok(energies) => Ok(Made { scores: Scores::of_energies(&energies, within.0, within.1), stop: None }),
                    Err(HeldError::Stopped(RigStop::Interrupted { .. })) => Err(EvaluatorError::Interrupted.into()),
                    Err(HeldError::Rig(error)) => Err(WorkshopError::Held(error.into())),
                    Err(stop) => Ok(Made { scores: Scores::default(), stop: Some(stop.to_string()) }),
                }
            })
            .collect::<Result<_, WorkshopError>>()?;
        let (made, uniform_runs) = runs.split_at(count);
        let mut made = made.to_vec();
        // In the order in which they were put down: pieces, and their blows.
        let struck = pieces.iter().flat_map(|piece| factors.iter().map(|&factor| strikes(piece, factor)));
        for (run, load) in made.iter_mut().zip(struck) {
            let load = loads.iter().position(|known| *known == load).unwrap_or_default();
            let of = |k: usize| {
                let run = uniform_runs.get(uniform.len() * load + k).filter(|_| k < uniform.len());
                run.filter(|run| run.stop.is_none()).map(|run| &run.scores)
            };
            run.scores.relate(of(0).map(|host| host.focal_mean), of(1).map(|lens| lens.protected_mean));
        }
        Ok(made.chunks(factors.len()).map(<[_]>::to_vec).collect())
    }
}
