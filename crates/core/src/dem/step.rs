//! One step forward in time.
//!
//! - `multistep`: a predictor and a corrector around one force sweep, by a table of coefficients: velocity Verlet, and Adams's
//!   scheme of fourth order
//! - here: Runge-Kutta of fourth order, the reference to compare with. It takes four sweeps and a fifth, at the accepted state,
//!   that advances the contacts' memories, as Burgoyne 2016, appendix A.2.3, does

mod multistep;

use multistep::Past;
pub(super) use multistep::{Coefficients, Scheme};

use super::Integrator;
use super::body::Grains;
use super::clock::{Clock, Phase};
use super::contacts::{Contacts, Laws, Pass, Sweep};
use super::load::{ForcePulse, Strike};
use crate::real::Lanes;

/// The load on the struck spheres, and the work it has done.
pub(super) struct Drive<V> {
    /// One for all designs, or one for each.
    pulses: Vec<ForcePulse>,
    /// Load along the first axis over that along the last.
    slope: f64,
    pub struck: Vec<usize>,
    /// One more than the last struck sphere.
    reach: usize,
    /// Work on the simulated parts (J)
    pub work: V,
}

impl<V: Lanes> Drive<V> {
    /// `work` has been put in before the start (J).
    pub fn new(strikes: &[Strike], slope: f64, struck: &[usize], work: f64) -> Self {
        let none = ForcePulse { force: 0.0, duration: 0.0 };
        let pulses = strikes.iter().map(|strike| strike.pulse().unwrap_or(none)).collect();
        let reach = struck.iter().max().map_or(0, |last| last + 1);
        Self { pulses, slope, struck: struck.to_vec(), reach, work: V::splat(work) }
    }

    /// The mean load (N) during a step, where it acts in any of the designs.
    #[inline(always)]
    fn during(&self, step_index: u64, step: f64) -> Option<V> {
        let mut load = V::splat(self.pulses[0].during(step_index, step));
        for (lane, pulse) in self.pulses.iter().enumerate().skip(1).take(V::LANES - 1) {
            load.set_lane(lane, pulse.during(step_index, step));
        }
        V::any(V::splat(0.0).lt(load)).then_some(load)
    }

    /// The axes along which a load acts, with its components; a straight one acts along the last alone.
    #[inline(always)]
    fn components<const D: usize>(&self, load: V) -> impl Iterator<Item = (usize, V)> + use<V, D> {
        let across = (D > 1 && self.slope != 0.0).then_some((0, V::splat(self.slope) * load));
        [Some((D - 1, load)), across].into_iter().flatten()
    }
}

/// Advances spheres and contacts by steps of one length.
pub(super) struct Stepper<V, const D: usize> {
    pub integrator: Integrator,
    /// What the sweep of an accepted state advances.
    accept: Sweep,
    pub step: f64,
    pub count: u64,
    pub clock: Clock,
    force: Vec<[V; D]>,
    /// The velocities that the force is evaluated with.
    predicted: Vec<[V; D]>,
    stages: Option<Stages<V, D>>,
    coefficients: Coefficients,
    past: Past<V, D>,
}

/// Work space of Runge-Kutta: the displacement that is tried, and the weighted sums of the stages' slopes.
struct Stages<V, const D: usize> {
    displacement: Vec<[V; D]>,
    velocity_sum: Vec<[V; D]>,
    acceleration_sum: Vec<[V; D]>,
}

impl<V: Lanes, const D: usize> Stepper<V, D> {
    pub fn new(integrator: Integrator, accept: Sweep, step: f64, spheres: usize) -> Self {
        let zeros = || vec![[V::splat(0.0); D]; spheres];
        let stages = (integrator == Integrator::Rk4).then(|| Stages {
            displacement: zeros(),
            velocity_sum: zeros(),
            acceleration_sum: zeros(),
        });
        let (force, predicted, clock) = (zeros(), zeros(), Clock::new(false));
        let (coefficients, past) = (Coefficients::of(integrator, step), Past::new(spheres));
        Self { integrator, accept, step, count: 0, clock, force, predicted, stages, coefficients, past }
    }

    /// Time (s) at the last accepted step.
    pub fn time(&self) -> f64 {
        self.count as f64 * self.step
    }

    /// One accepted step.
    #[inline(always)]
    pub fn advance(
        &mut self,
        grains: &mut Grains<V, D>,
        contacts: &mut Contacts<'_, V, D>,
        laws: &dyn Laws<V, D>,
        drive: &mut Drive<V>,
    ) {
        grains.reached = grains.reached.max(drive.reach);
        // Batches of Runge-Kutta run one design at a time, so that it is not compiled for registers.
        if const { V::LANES > 1 } {
            self.multistep(grains, contacts, laws, drive);
        } else if self.integrator == Integrator::Rk4 {
            self.runge_kutta(grains, contacts, laws, drive);
        } else {
            self.multistep(grains, contacts, laws, drive);
        }
        self.count += 1;
        self.clock.lap(Phase::Motion);
    }

    /// Adds up the contact forces, by what velocities are to be seen.
    #[inline(always)]
    fn sweep(&mut self, grains: &mut Grains<V, D>, contacts: &mut Contacts<'_, V, D>, laws: &dyn Laws<V, D>) {
        let Grains { displacement, reached, .. } = grains;
        let (velocity, force) = (&self.predicted, &mut self.force);
        laws.sweep(Pass { contacts, displacement, velocity, force, reached, sweep: self.accept });
        grains.hold(&mut self.force);
    }

    fn runge_kutta(
        &mut self,
        grains: &mut Grains<V, D>,
        contacts: &mut Contacts<'_, V, D>,
        laws: &dyn Laws<V, D>,
        drive: &mut Drive<V>,
    ) {
        let Some(stages) = &mut self.stages else { return };
        let load = drive.during(self.count, self.step);
        let zero = [V::splat(0.0); D];
        stages.displacement.copy_from_slice(&grains.displacement);
        self.predicted.copy_from_slice(&grains.velocity);
        stages.velocity_sum.fill(zero);
        stages.acceleration_sum.fill(zero);

        let mut plate_sums = [V::splat(0.0); 2];
        if let Some(plate) = &mut contacts.plate {
            plate.seen = [plate.displacement, plate.velocity];
        }

        // Share of the slope in the mean, and how far the next stage lies from the start.
        for (share, ahead) in [(1.0, 0.5), (2.0, 0.5), (2.0, 1.0), (1.0, 0.0)] {
            let share = V::splat(share);
            let ahead = V::splat(ahead * self.step);
            let (displacement, velocity) = (&stages.displacement[..], &self.predicted[..]);
            let (force, reached) = (&mut self.force[..], &mut grains.reached);
            laws.sweep(Pass { contacts, displacement, velocity, force, reached, sweep: Sweep::Try });
            grains.hold(&mut self.force);
            if let Some(plate) = &mut contacts.plate {
                plate.stage(&mut plate_sums, share, ahead);
            }
            for i in 0..grains.reached {
                let mut acceleration = grains.acceleration_of(i, &self.force[i]);
                if let Some(load) = load
                    && drive.struck.contains(&i)
                {
                    for (k, load) in drive.components::<D>(load) {
                        if grains.mobility[i][k] != 0.0 {
                            acceleration[k] = acceleration[k] + load * grains.inverse_mass[i];
                        }
                    }
                }
                for k in 0..D {
                    let velocity = self.predicted[i][k];
                    stages.velocity_sum[i][k] = stages.velocity_sum[i][k] + share * velocity;
                    stages.acceleration_sum[i][k] = stages.acceleration_sum[i][k] + share * acceleration[k];
                    stages.displacement[i][k] = grains.displacement[i][k] + ahead * velocity;
                    self.predicted[i][k] = grains.velocity[i][k] + ahead * acceleration[k];
                }
            }
        }
        let sixth = V::splat(self.step / 6.0);
        for i in 0..grains.reached {
            for k in 0..D {
                let moved = sixth * stages.velocity_sum[i][k];
                if let Some(load) = load
                    && drive.struck.contains(&i)
                {
                    for (_, load) in drive.components::<D>(load).filter(|&(axis, _)| axis == k) {
                        drive.work = drive.work + load * V::splat(grains.weight[i]) * moved;
                    }
                }
                grains.displacement[i][k] = grains.displacement[i][k] + moved;
                grains.velocity[i][k] = grains.velocity[i][k] + sixth * stages.acceleration_sum[i][k];
            }
        }
        if let Some(plate) = &mut contacts.plate {
            plate.accept(plate_sums, sixth);
        }
        // Spins follow by the predictor and corrector of Verlet's table; the stages see them, and the springs, as they were.
        let [b, m] = [self.coefficients.velocity, self.coefficients.corrector].map(|row| row.map(V::splat));
        if let Some(friction) = &mut contacts.friction {
            friction.predict(grains.reached, b);
        }
        self.predicted.copy_from_slice(&grains.velocity);
        self.sweep(grains, contacts, laws);
        if let Some(friction) = &mut contacts.friction {
            friction.correct(grains.reached, m);
        }
        for i in 0..grains.reached {
            grains.acceleration[i] = grains.acceleration_of(i, &self.force[i]);
        }
    }
}
