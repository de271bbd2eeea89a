//! Crystals without end across the wave, uniform or layered, and waves through them.

use super::RowError;
use crate::Context;
use crate::contact::{LawKind, Pair};
use crate::dem::rig::{Arrival, Body, Curve, LawBook, Load, LoadKind, Rig, Simulation};
use crate::dem::{MoveIn, Spheres};
use crate::lattice::{Cell, Crystal, Outline, Width};
use crate::material::{Material, find};
use crate::pattern::{Build, Pattern, Selection};

/// Sphere diameter of all experiments and simulations of the source but where it says otherwise (m).
pub(super) const DIAMETER: f64 = 6.35e-3;

/// A library material by its name.
pub(super) fn material(name: &str) -> Material {
    find(name, &[]).unwrap_or_else(|error| unreachable!("a name of the library: {error}"))
}

/// The source's model material: E = 100 GPa, ν taken as 0.3, without rate hardening.
pub(super) fn model(density: f64, yield_stress: f64) -> Material {
    Material {
        name: "model".to_owned(),
        density,
        youngs_modulus: 100e9,
        poisson_ratio: 0.3,
        yield_stress,
        rate_constant: 0.0,
        source: "Burgoyne 2016, sections 4.2.2 and 5.2".to_owned(),
    }
}

/// A chain, hexagonal sheet or hexagonal close packing, 50 layers deep as in the source, with its materials by turns.
pub(super) struct Stack<const D: usize> {
    pub cell: Cell<D>,
    /// Layer 1 has the first.
    pub materials: Vec<Material>,
    pub law: LawKind,
}

/// What strikes the first layer.
#[derive(Clone, Copy)]
pub(super) enum Loading {
    /// This force at each contact below the first layer (N), for so long (s).
    Force(f64, f64),
    /// This velocity for ever (m/s).
    Velocity(f64),
    /// The first sphere moves at the start (m/s).
    Flying(f64),
}

pub(super) const LAYERS: u32 = 50;

impl<const D: usize> Stack<D> {
    /// The wider a crystal without end across the wave is, the longer it takes and nothing else: these are the narrowest in
    /// which no sphere meets two images of another.
    fn crystal(&self) -> Result<Crystal<D>, RowError> {
        let widths: &[Width] = match D {
            1 => &[],
            2 => &[Width::Cells(4)],
            _ => &[Width::Cells(4), Width::Cells(2)],
        };
        Ok(Crystal::new(self.cell, DIAMETER, LAYERS, widths, Outline::All)?)
    }

    /// The contact of the first two layers.
    pub fn pair(&self) -> Pair {
        let materials = [&self.materials[0], &self.materials[1 % self.materials.len()]];
        Pair::new(materials, [0.5 * DIAMETER; 2], Default::default())
    }

    /// The step (s): the fastest wave, of elastic contacts at this force, takes 50 of them from layer to layer.
    fn step(&self, force: f64) -> f64 {
        let pair = self.pair();
        let stiffness = 1.5 * (pair.hertz_coefficient().powi(2) * force).cbrt();
        let stiffness = stiffness.max(pair.plastic_stiffness());
        let lightest = self.materials.iter().map(|m| m.sphere_mass(DIAMETER)).fold(f64::INFINITY, f64::min);
        0.02 * (lightest / stiffness).sqrt()
    }

    /// The crystal, ready to be struck, watching for the arrivals named.
    pub fn struck(&self, loading: Loading, arrivals: Vec<Arrival>) -> Result<Simulation<D>, RowError>
    where
        Spheres: MoveIn<D>,
    {
        let crystal = self.crystal()?;
        let mut build = Build::new(crystal.clone(), self.materials.clone());
        let palette: Vec<usize> = (0..self.materials.len()).collect();
        if palette.len() > 1 {
            build.paint(&Pattern::Layers { first: 1 }, &Selection::default(), &palette, None)?;
        }
        let (sample, _) = build.sample();
        let mut rig = Rig::new(sample, LawBook::named(self.law));
        rig.periods = crystal.periods();
        let first: Vec<usize> =
            crystal.sites().iter().enumerate().filter(|(_, site)| site.layer == 1).map(|(k, _)| k).collect();
        let mut direction = [0.0; D];
        direction[D - 1] = 1.0;
        let bodies = first.iter().copied().map(Body::Sphere).collect();
        let greatest = match loading {
            Loading::Force(contact, duration) => {
                // 1, 2 or 3 contacts below each sphere share its force, at 0, 30 or 35.26 degrees.
                let factor = [1.0, 3.0_f64.sqrt(), 6.0_f64.sqrt()][D - 1];
                let curve = Curve::Square { peak: factor * contact, start: 0.0, duration };
                rig.loads.push(Load { bodies, direction, kind: LoadKind::Force, curve });
                2.0 * contact
            }
            Loading::Velocity(speed) => {
                let curve = Curve::Square { peak: speed, start: 0.0, duration: 1.0 };
                rig.loads.push(Load { bodies, direction, kind: LoadKind::Velocity, curve });
                self.collision_force(2.0 * speed)
            }
            Loading::Flying(speed) => {
                first.iter().for_each(|&k| rig.velocity[k][D - 1] = speed);
                self.collision_force(speed)
            }
        };
        Ok(Simulation::new(rig, self.step(greatest))?.recording(arrivals))
    }

    /// Greatest force (N) of an elastic collision at this speed (Johnson 1985, section 11.4): an upper bound for plastic ones.
    fn collision_force(&self, speed: f64) -> f64 {
        let k = self.pair().hertz_coefficient();
        let mass = self.materials.iter().map(|m| m.sphere_mass(DIAMETER)).fold(0.0, f64::max);
        k * (5.0 * 0.5 * mass * speed * speed / (4.0 * k)).powf(0.6)
    }

    /// When each layer was reached (s) by a wave after a blow: its speed there is 1 % of the greatest of the first sphere
    /// (section 2.1.2).
    pub fn arrivals(&self, loading: Loading, last: u32, context: &Context) -> Result<Vec<f64>, RowError>
    where
        Spheres: MoveIn<D>,
    {
        let mut simulation = self.struck(loading, vec![Arrival::FirstSphere(0.01)])?;
        reach(&mut simulation, last, context)
    }

    /// Mean speed of the wave (m/s) between two layers.
    pub fn speed(&self, loading: Loading, between: [u32; 2], context: &Context) -> Result<f64, RowError>
    where
        Spheres: MoveIn<D>,
    {
        let times = self.arrivals(loading, between[1], context)?;
        let spacing = self.cell.layer_spacing() * DIAMETER;
        let [a, b] = between.map(|layer| layer as usize - 1);
        Ok((b - a) as f64 * spacing / (times[b] - times[a]))
    }
}

/// Follows a wave until it has reached a layer by the first threshold watched; gives the times (s) for all layers up to it.
pub(super) fn reach<const D: usize>(
    simulation: &mut Simulation<D>,
    last: u32,
    context: &Context,
) -> Result<Vec<f64>, RowError> {
    let per_layer = simulation.rig().sample.spheres.len() / LAYERS as usize;
    // A thousand steps a layer is a tenth of the slowest elastic wave's speed.
    for _ in 0..10 * LAYERS {
        simulation.advance(100, context)?;
        // Across the wave all spheres of a layer move alike: the first stands for it.
        let times: Option<Vec<f64>> =
            simulation.arrivals(0).chunks(per_layer).take(last as usize).map(|layer| layer[0]).collect();
        if let Some(times) = times {
            return Ok(times);
        }
    }
    Err(RowError::NoWave(format!("layer {last}")))
}

/// The slope of y over x on logarithmic scales: the exponent of the power law that fits best.
pub(super) fn exponent(points: &[(f64, f64)]) -> f64 {
    let n = points.len() as f64;
    let logs = || points.iter().map(|&(x, y)| (x.ln(), y.ln()));
    let (mx, my) = (logs().map(|(x, _)| x).sum::<f64>() / n, logs().map(|(_, y)| y).sum::<f64>() / n);
    let over = logs().map(|(x, y)| (x - mx) * (y - my)).sum::<f64>();
    over / logs().map(|(x, _)| (x - mx).powi(2)).sum::<f64>()
}

/// So many numbers from `from` to `to`, by equal factors.
pub(super) fn spread(from: f64, to: f64, count: u32) -> Vec<f64> {
    (0..count).map(|k| from * (to / from).powf(f64::from(k) / f64::from(count - 1))).collect()
}
