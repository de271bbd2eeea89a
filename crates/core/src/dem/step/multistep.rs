//! Predictor and corrector around one force sweep a step: velocity Verlet, and Störmer's and Adams's multistep scheme.
//!
//! With a the contacts' acceleration, ∇a = aₙ − aₙ₋₁, ∇² the difference of such differences and so on,
//!
//!   x(n+1) = x + h v + h² (1/2 + s₁ ∇ + s₂ ∇²) aₙ
//!   velocity in the force = v + h (1 + b₁ ∇ + b₂ ∇²) aₙ
//!   v(n+1) = v + h (1 − 1/2 ∇ − m₂ ∇² − m₃ ∇³) a(n+1)
//!
//! | | s₁ | s₂ | b₁ | b₂ | m₂ | m₃ |
//! |---|---|---|---|---|---|---|
//! | Verlet | 0 | 0 | 0 | 0 | 0 | 0 |
//! | Störmer; Adams and Bashforth; Adams and Moulton | 1/6 | 1/8 | 1/2 | 5/12 | 1/12 | 1/24 |
//!
//! (Hairer, Nørsett and Wanner, Solving Ordinary Differential Equations I, sections III.1 and III.10.) Verlet with the predicted
//! velocity v + h a in the force is of second order although the force depends on velocity; with the velocity at half step it would
//! be of first. Adams's is of fourth order where the motion is smooth. A load is constant over a step and adds its exact motion. The
//! accelerations before the start are zero, as those of a crystal at rest are. Where contacts open, yield or begin to unload,
//! accelerations have kinks and the order is lost for that step, as in every scheme; what is gained on the lens problem all the same
//! is in `benches/README.md`. Adams's is stable up to ωh = 1.41, Verlet up to 2; it damps the fastest motion by (ωh)⁵/160 a step or
//! so, which the energy ledger shows.

use super::{Drive, Stepper};
use crate::dem::Integrator;
use crate::dem::body::Grains;
use crate::dem::clock::Phase;
use crate::dem::contacts::{Contacts, Laws};
use crate::real::Lanes;

/// The table of a scheme, each entry times the step.
#[derive(Clone, Copy, Debug)]
pub(in crate::dem) struct Coefficients {
    /// s₁ h, s₂ h
    pub displacement: [f64; 2],
    /// b₁ h, b₂ h
    pub velocity: [f64; 2],
    /// m₂ h, m₃ h
    pub corrector: [f64; 2],
}

impl Coefficients {
    pub fn of(integrator: Integrator, step: f64) -> Self {
        let [displacement, velocity, corrector] = match integrator {
            Integrator::Adams => [[1.0 / 6.0, 1.0 / 8.0], [0.5, 5.0 / 12.0], [1.0 / 12.0, 1.0 / 24.0]],
            Integrator::Verlet | Integrator::Rk4 => [[0.0; 2]; 3],
        };
        let times_step = |row: [f64; 2]| row.map(|share| share * step);
        Self {
            displacement: times_step(displacement),
            velocity: times_step(velocity),
            corrector: times_step(corrector),
        }
    }
}

/// A table in registers: what comes of accelerations of now, one and two steps ago.
pub(in crate::dem) struct Scheme<V> {
    /// h (s)
    pub step: V,
    half: V,
    displacement: [V; 2],
    velocity: [V; 2],
    corrector: [V; 2],
}

impl<V: Lanes> Scheme<V> {
    #[inline(always)]
    fn new(table: &Coefficients, step: f64) -> Self {
        Self {
            step: V::splat(step),
            half: V::splat(0.5 * step),
            displacement: table.displacement.map(V::splat),
            velocity: table.velocity.map(V::splat),
            corrector: table.corrector.map(V::splat),
        }
    }

    /// What a step adds to the velocity in its mean, and in the force.
    #[inline(always)]
    pub fn predict(&self, now: V, [one, two]: [V; 2]) -> [V; 2] {
        let ([s1, s2], [b1, b2]) = (self.displacement, self.velocity);
        let first = now - one;
        let second = first - (one - two);
        let mean = self.half * now + (s1 * first + s2 * second);
        [mean, self.step * now + (b1 * first + b2 * second)]
    }

    /// What it adds to the velocity in truth, once the new acceleration is known.
    #[inline(always)]
    pub fn correct(&self, new: V, now: V, [one, two]: [V; 2]) -> V {
        let [m2, m3] = self.corrector;
        let (first, before, earlier) = (new - now, now - one, one - two);
        let second = first - before;
        let third = second - (before - earlier);
        self.half * (now + new) - (m2 * second + m3 * third)
    }
}

/// Accelerations of all spheres one and two steps ago.
pub(super) struct Past<V, const D: usize> {
    one: Vec<[V; D]>,
    two: Vec<[V; D]>,
}

impl<V: Lanes, const D: usize> Past<V, D> {
    pub fn new(spheres: usize) -> Self {
        let zeros = || vec![[V::splat(0.0); D]; spheres];
        Self { one: zeros(), two: zeros() }
    }
}

impl<V: Lanes, const D: usize> Stepper<V, D> {
    #[inline(always)]
    pub(super) fn multistep(
        &mut self,
        grains: &mut Grains<V, D>,
        contacts: &mut Contacts<'_, V, D>,
        laws: &dyn Laws<V, D>,
        drive: &mut Drive<V>,
    ) {
        let past = &self.past;
        let scheme = Scheme::new(&self.coefficients, self.step);
        let (h, half) = (scheme.step, scheme.half);
        let load = drive.during(self.count, self.step);

        // The load's work is found from where the spheres were before.
        if let Some(load) = load {
            for &i in &drive.struck {
                for (k, load) in drive.components::<D>(load) {
                    if grains.mobility[i][k] != 0.0 {
                        drive.work = drive.work - load * V::splat(grains.weight[i]) * grains.displacement[i][k];
                    }
                }
            }
        }
        for i in 0..grains.reached {
            for k in 0..D {
                let velocity = grains.velocity[i][k];
                let [mean, change] = scheme.predict(grains.acceleration[i][k], [past.one[i][k], past.two[i][k]]);
                grains.displacement[i][k] = grains.displacement[i][k] + h * (velocity + mean);
                self.predicted[i][k] = velocity + change;
            }
        }
        if let Some(load) = load {
            for &i in &drive.struck {
                for (k, load) in drive.components::<D>(load) {
                    // What lies on a mirror does not move across it.
                    if grains.mobility[i][k] == 0.0 {
                        continue;
                    }
                    let push = load * grains.inverse_mass[i];
                    grains.displacement[i][k] = grains.displacement[i][k] + h * half * push;
                    self.predicted[i][k] = self.predicted[i][k] + h * push;
                    grains.velocity[i][k] = grains.velocity[i][k] + h * push;
                    drive.work = drive.work + load * V::splat(grains.weight[i]) * grains.displacement[i][k];
                }
            }
        }
        if let Some(friction) = &mut contacts.friction {
            friction.predict(grains.reached, scheme.velocity);
        }
        if let Some(plate) = &mut contacts.plate {
            plate.predict(&scheme);
        }
        self.clock.lap(Phase::Motion);
        self.sweep(grains, contacts, laws);
        let past = &mut self.past;
        self.clock.lap(Phase::Contacts);
        if let Some(friction) = &mut contacts.friction {
            friction.correct(grains.reached, scheme.corrector);
        }
        if let Some(plate) = &mut contacts.plate {
            plate.correct(&scheme);
        }
        for i in 0..grains.reached {
            let new = grains.acceleration_of(i, &self.force[i]);
            for k in 0..D {
                let mean = scheme.correct(new[k], grains.acceleration[i][k], [past.one[i][k], past.two[i][k]]);
                grains.velocity[i][k] = grains.velocity[i][k] + mean;
            }
            past.two[i] = past.one[i];
            past.one[i] = grains.acceleration[i];
            grains.acceleration[i] = new;
        }
    }
}
