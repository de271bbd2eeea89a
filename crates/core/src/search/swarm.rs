//! A swarm of particles within bounds.

use argmin::core::{PopulationState, State};
use argmin::solver::particleswarm::{Particle, ParticleSwarm};
use rand_xoshiro_of_argmin::Xoshiro256PlusPlus;
use rand_xoshiro_of_argmin::rand_core::SeedableRng;

use super::lockstep::Lockstep;
use super::method::Row;
use super::{Optimizer, Rng, parametric, sane};

/// Over the parameters of a parametrisation.
pub(super) const METHOD: Row = Row {
    name: "lens-family-swarm",
    about: "a particle swarm over the lens family's parameters",
    begin: |begin| parametric::by(begin, Optimizer::Swarm),
    ..parametric::METHOD
};

/// Particles: two registers of eight.
const PARTICLES: usize = 16;

/// All particles within this part of the bounds have come together.
const TOGETHER: f64 = 1e-3;

type Swarming =
    Lockstep<ParticleSwarm<Vec<f64>, f64, Xoshiro256PlusPlus>, PopulationState<Particle<Vec<f64>, f64>, f64>>;

/// Particle swarm optimisation as argmin has it: the first particle at a start, the others anywhere within bounds. When all have
/// come together it begins anew with all of them anywhere.
pub struct Swarm {
    bounds: Vec<[f64; 2]>,
    rng: Rng,
    /// Where the particles of a swarm begin, until their losses are told.
    first: Vec<Vec<f64>>,
    swarming: Option<Swarming>,
    restarts: u64,
}

impl Swarm {
    /// Within `bounds`, a lower and an upper one for each parameter.
    pub fn new(start: &[f64], bounds: Vec<[f64; 2]>, seed: u64) -> Self {
        let mut swarm = Self { bounds, rng: Rng::new(seed), first: Vec::new(), swarming: None, restarts: 0 };
        swarm.first = (0..PARTICLES).map(|_| swarm.anywhere()).collect();
        swarm.first[0] = start.iter().zip(&swarm.bounds).map(|(x, [from, to])| x.clamp(*from, *to)).collect();
        swarm
    }

    /// How often it has begun anew.
    pub fn restarts(&self) -> u64 {
        self.restarts
    }

    /// A point within the bounds.
    fn anywhere(&mut self) -> Vec<f64> {
        let rng = &mut self.rng;
        self.bounds.iter().map(|[from, to]| from + (to - from) * rng.unit()).collect()
    }

    /// The points whose losses are wanted next.
    pub fn ask(&mut self) -> Vec<Vec<f64>> {
        if self.swarming.as_ref().is_some_and(|swarming| self.is_together(swarming)) {
            self.restarts += 1;
            self.swarming = None;
            self.first = (0..PARTICLES).map(|_| self.anywhere()).collect();
        }
        match &mut self.swarming {
            Some(swarming) => swarming.ask(),
            None => self.first.clone(),
        }
    }

    /// The losses of what was asked for last, in its order.
    pub fn tell(&mut self, losses: &[f64]) {
        let losses: Vec<f64> = losses.iter().map(|&loss| sane(loss)).collect();
        match &mut self.swarming {
            Some(swarming) => swarming.tell(&losses),
            None => self.begin(&losses),
        }
    }

    fn begin(&mut self, losses: &[f64]) {
        let particles: Vec<_> = std::mem::take(&mut self.first)
            .into_iter()
            .zip(losses)
            .map(|(position, &loss)| {
                // Half the way to another point, as in the standard of 2011.
                let other = self.anywhere();
                let velocity = other.iter().zip(&position).map(|(to, from)| 0.5 * (to - from)).collect();
                Particle::new(position, loss, velocity)
            })
            .collect();
        let bounds = self.bounds.iter().map(|[from, to]| (*from, *to)).unzip();
        let solver = ParticleSwarm::new(bounds, particles.len())
            .with_rng_generator(Xoshiro256PlusPlus::seed_from_u64(self.rng.bits()));
        self.swarming = Lockstep::new(solver, PopulationState::new().population(particles), &[]);
    }

    /// Whether all particles are at one place.
    fn is_together(&self, swarming: &Swarming) -> bool {
        let Some(particles) = swarming.state().get_population() else { return false };
        (0..self.bounds.len()).all(|k| {
            let [from, to] = self.bounds[k];
            let of = || particles.iter().map(|particle| particle.position[k]);
            of().fold(f64::NEG_INFINITY, f64::max) - of().fold(f64::INFINITY, f64::min) <= TOGETHER * (to - from)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The lowest of many dips (Rastrigin's function), at the origin; the same for the same seed.
    #[test]
    fn a_swarm_stays_within_bounds_and_finds_the_lowest_dip() {
        let dips =
            |x: &[f64]| -> f64 { x.iter().map(|x| 10.0 + x * x - 10.0 * (2.0 * std::f64::consts::PI * x).cos()).sum() };
        let search = || {
            let mut swarm = Swarm::new(&[9.0, 2.0], vec![[-3.0, 5.0]; 2], 5);
            let mut best = f64::INFINITY;
            for _ in 0..250 {
                let points = swarm.ask();
                assert!(points.iter().flatten().all(|x| (-3.0..=5.0).contains(x)));
                let losses: Vec<f64> = points.iter().map(|x| dips(x)).collect();
                best = losses.iter().copied().fold(best, f64::min);
                swarm.tell(&losses);
            }
            (best, swarm.restarts())
        };
        let (best, restarts) = search();
        assert!(best < 1e-3, "{best} after {restarts}");
        assert_eq!((best, restarts), search());
    }
}
