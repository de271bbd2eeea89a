//! Störmer's and Adams's multistep scheme: fourth order where the motion is smooth, for one force sweep per step.
//!
//! With a the contacts' acceleration, ∇a = aₙ − aₙ₋₁ and ∇² the difference of such differences, a cubic through past and
//! present accelerations gives
//!
//!   x(n+1) = x + h v + h² (1/2 + 1/6 ∇ + 1/8 ∇²) aₙ              (Störmer)
//!   velocity in the force = v + h (1 + 1/2 ∇ + 5/12 ∇²) aₙ       (Adams and Bashforth)
//!   v(n+1) = v + h (1 − 1/2 ∇ − 1/12 ∇² − 1/24 ∇³) a(n+1)        (Adams and Moulton)
//!
//! (Hairer, Nørsett and Wanner, Solving Ordinary Differential Equations I, sections III.1 and III.10.) A load is constant over a
//! step and adds its exact motion. The accelerations before the start are zero, as those of a crystal at rest are. Where
//! contacts open, yield or begin to unload, accelerations have kinks and the order is lost for that step, as in every scheme; what is
//! gained on the lens problem all the same is in `benches/README.md`. Stable up to ωh = 1.41, where Verlet is up to 2; damps the
//! fastest motion by (ωh)⁵/160 a step or so, which the energy ledger shows.

use super::{Drive, Stepper};
use crate::dem::body::Grains;
use crate::dem::clock::Phase;
use crate::dem::contacts::{Contacts, Laws};
use crate::real::Lanes;

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
    pub(super) fn adams<L: Laws<V>>(
        &mut self,
        grains: &mut Grains<V, D>,
        contacts: &mut Contacts<V, D, L>,
        drive: &mut Drive<V>,
    ) {
        let Some(past) = &mut self.past else { return };
        let part = |share: f64| V::splat(share * self.step);
        let (h, half) = (part(1.0), part(0.5));
        let (sixth, eighth, five_twelfths) = (part(1.0 / 6.0), part(1.0 / 8.0), part(5.0 / 12.0));
        let load = drive.pulse.during(self.count, self.step);

        // The load's work is found from where the spheres were before.
        if load > 0.0 {
            for &i in &drive.struck {
                for (k, load) in drive.components::<D>(load) {
                    if load != 0.0 && grains.mobility[i][k] != 0.0 {
                        drive.work = drive.work - V::splat(load * grains.weight[i]) * grains.displacement[i][k];
                    }
                }
            }
        }
        for i in 0..grains.reached {
            for k in 0..D {
                let (velocity, now, one) = (grains.velocity[i][k], grains.acceleration[i][k], past.one[i][k]);
                let first = now - one;
                let second = first - (one - past.two[i][k]);
                let mean = half * now + (sixth * first + eighth * second);
                grains.displacement[i][k] = grains.displacement[i][k] + h * (velocity + mean);
                self.trial[i][k] = velocity + (h * now + (half * first + five_twelfths * second));
            }
        }
        if load > 0.0 {
            for &i in &drive.struck {
                for (k, load) in drive.components::<D>(load) {
                    // What lies on a mirror does not move across it.
                    if load == 0.0 || grains.mobility[i][k] == 0.0 {
                        continue;
                    }
                    let push = V::splat(load) * grains.inverse_mass[i];
                    grains.displacement[i][k] = grains.displacement[i][k] + h * half * push;
                    self.trial[i][k] = self.trial[i][k] + h * push;
                    grains.velocity[i][k] = grains.velocity[i][k] + h * push;
                    drive.work = drive.work + V::splat(load * grains.weight[i]) * grains.displacement[i][k];
                }
            }
        }
        self.clock.lap(Phase::Motion);
        contacts.sweep(&grains.displacement, &self.trial, &mut self.force, &mut grains.reached, self.accept);
        self.clock.lap(Phase::Contacts);
        let (twelfth, last) = (part(1.0 / 12.0), part(1.0 / 24.0));
        for i in 0..grains.reached {
            let new = grains.acceleration_of(i, &self.force[i]);
            for k in 0..D {
                let (now, one, two) = (grains.acceleration[i][k], past.one[i][k], past.two[i][k]);
                let (first, before, earlier) = (new[k] - now, now - one, one - two);
                let second = first - before;
                let third = second - (before - earlier);
                let mean = half * (now + new[k]) - (twelfth * second + last * third);
                grains.velocity[i][k] = grains.velocity[i][k] + mean;
            }
            past.two[i] = past.one[i];
            past.one[i] = grains.acceleration[i];
            grains.acceleration[i] = new;
        }
    }
}
