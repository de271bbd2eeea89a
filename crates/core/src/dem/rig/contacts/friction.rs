//! What friction does at closed contacts.
//!
//! Two rules. [`Grip`], of disks with springs and dashpots: a spring of constant stiffness and a dashpot under one cap, as Kondic et
//! al. have it, for any [`Lanes`]. [`coulomb`], of all other rigs: a spring whose stiffness may follow the overlap, and which never gives back more than
//! was put in.

use crate::dem::rig::bodies::dot;
use crate::dem::rig::law::Slip;
use crate::real::Lanes;

use super::account::Account;
use super::react::Meeting;

/// What [`Grip`] does at a contact.
pub struct Rub<V> {
    /// The force that holds the first end back, and drags the second along.
    pub drag: [V; 2],
    /// The couple per lever arm on both, out of the plane.
    pub twist: V,
    /// What it takes (W).
    pub power: V,
}

/// Friction of a constant spring and a dashpot under one cap (Kondic et al. 2012).
pub struct Grip<V> {
    /// μ
    pub coefficient: V,
    /// k_t (N/m)
    pub stiffness: V,
    /// γ_t m̄ (kg/s)
    pub damping: V,
}

impl<V: Lanes> Grip<V> {
    /// The force that the first end's sliding meets in the plane, F_t = k_t ξ + γ_t m̄ u, at most μ |F_n|; ξ advances by one step.
    /// Without `SPRING` k_t is zero, and ξ is left alone. Friction has one direction here: a force is cut to its cap without a root.
    #[inline(always)]
    pub fn rub<const SPRING: bool>(&self, meeting: &Meeting<V, 2>, push: V, stretch: &mut [V; 2], step: f64) -> Rub<V> {
        let zero = V::splat(0.0);
        let mut tangent = [-meeting.normal[1], meeting.normal[0]];
        let slide = dot(&meeting.approach, &tangent) + meeting.turn[2];
        let (mut stretched, damped) = (zero, self.damping * slide);
        let mut drag = damped;
        if SPRING {
            // ξ is turned into the tangent, then follows the sliding: ξ̇ = u.
            stretched = dot(stretch, &tangent) + V::splat(step) * slide;
            drag = self.stiffness * stretched + damped;
        }
        let cap = self.coefficient * push.max(-push);
        let cut = drag.min(cap).max(-cap);
        if SPRING {
            let slips = cap.lt(drag.max(-drag));
            if V::any(slips) {
                let softness = V::select(zero.lt(self.stiffness), V::splat(1.0) / self.stiffness, zero);
                stretched = V::select(slips, (cut - damped) * softness, stretched);
            }
            for k in 0..2 {
                stretch[k] = stretched * tangent[k];
            }
        }
        for k in 0..2 {
            tangent[k] = cut * tangent[k];
        }
        Rub { drag: tangent, twist: -cut, power: cut * slide }
    }
}

impl Slip {
    /// k_t at an overlap.
    #[inline(always)]
    pub fn stiffness_at(&self, overlap: f64) -> f64 {
        if self.mindlin > 0.0 { self.stiffness + self.mindlin * overlap.sqrt() } else { self.stiffness }
    }

    /// The mean of k_t while the overlap changes from one value to another at a constant rate. ∫√δ dδ between a and b is
    /// (2/3)(b^{3/2} − a^{3/2}).
    #[inline(always)]
    fn mean_stiffness(&self, [from, to]: [f64; 2]) -> f64 {
        if self.mindlin == 0.0 {
            return self.stiffness;
        }
        let (a, b) = (from.sqrt(), to.sqrt());
        let sum = a + b;
        let mean = if sum > 0.0 { (a * a + a * b + b * b) / (1.5 * sum) } else { 0.0 };
        self.stiffness + self.mindlin * mean
    }
}

/// Friction after one step, by [`coulomb`].
pub struct Rubbed<const D: usize> {
    /// The force that holds the first end back, and drags the second along.
    pub drag: [f64; D],
    /// ξ (m)
    pub stretch: [f64; D],
    /// Work done against it during the step (J).
    pub work: f64,
    /// What its dashpot takes (W).
    pub power: f64,
}

/// Coulomb's friction with a tangential spring, |T| ≤ μ |F_n|.
///
/// While k_t grows the spring is incremental, dT = k_t du: a force that is there does not change because the contact is pressed
/// harder. While k_t falls the force falls with it, T = k_t ξ: a spring that became softer at the same force would hold more energy
/// than was put in. So on every path ∫T·du ≥ ½ T²/k_t, and no closed path of overlap and slip gives work (Thornton and Randall
/// 1988; "mindlin_rescale" of LAMMPS). At the cap the spring is cut back to it, along its own direction; the contact slides by the
/// rest. A dashpot's γ_t m̄ u acts beside the spring, their sum under the same cap: the dashpot's share lies between T and
/// T + γ_t m̄ u, or, in three dimensions, is the projection on the circle of radius μ |F_n|, and opposes the sliding in both.
///
/// `way` is how far the first end has slid during the step (m), `before` the account of the step before, `stretch` its ξ = T/k_t. Work is counted so that what friction takes is a sum of
/// terms of which none is negative: what a spring loses at constant ξ or T, slip times cap, and the dashpot's power.
#[inline(always)]
pub fn coulomb<const D: usize>(
    slip: &Slip,
    damping: f64,
    meeting: &Meeting<f64, D>,
    (push, way): (f64, &[f64; D]),
    (before, stretch): (&Account, &[f64; D]),
    step: f64,
) -> Rubbed<D> {
    let cap = slip.coefficient * push.abs();
    let [was, now] = [before.overlap, meeting.overlap].map(|overlap| slip.stiffness_at(overlap));
    let (mut drag, mut stretch, mut work) = ([0.0; D], *stretch, 0.0);
    if now > 0.0 {
        turn_into_plane(&mut stretch, &meeting.normal);
        let during = slip.mean_stiffness([before.overlap, meeting.overlap]);
        // T and ξ, as if nothing slid; and the stiffness by which what exceeds the cap is slip.
        let yielding = if now >= was {
            for k in 0..D {
                drag[k] = was * stretch[k] + during * way[k];
            }
            during
        } else {
            for k in 0..D {
                drag[k] = now * (stretch[k] + way[k]);
            }
            now
        };
        let held = dot(&stretch, &stretch);
        let size = dot(&drag, &drag).sqrt();
        if size > cap {
            drag = drag.map(|force| force * (cap / size));
            let slid = (size - cap) / yielding;
            work += 0.5 * slip.coefficient * (before.force.abs() + push.abs()) * slid;
        }
        stretch = drag.map(|force| force / now);
        work += if now >= was {
            (dot(&drag, &drag) - was * was * held) / (2.0 * during)
        } else {
            0.5 * during * (dot(&stretch, &stretch) - held)
        };
    }
    let mut power = 0.0;
    if damping > 0.0 {
        let spring = drag;
        let sliding = meeting.sliding();
        for k in 0..D {
            drag[k] += damping * sliding[k];
        }
        let size = dot(&drag, &drag).sqrt();
        if size > cap {
            drag = drag.map(|force| force * (cap / size));
        }
        for k in 0..D {
            power += (drag[k] - spring[k]) * sliding[k];
        }
        work += 0.5 * step * (before.power + power);
    }
    Rubbed { drag, stretch, work, power }
}

/// Turns a vector into the plane across the normal, without changing its length.
#[inline(always)]
fn turn_into_plane<const D: usize>(vector: &mut [f64; D], normal: &[f64; D]) {
    let length = dot(vector, vector);
    let along = dot(vector, normal);
    if along == 0.0 {
        return;
    }
    for k in 0..D {
        vector[k] -= along * normal[k];
    }
    let left = dot(vector, vector);
    if left > 0.0 {
        let factor = (length / left).sqrt();
        vector.iter_mut().for_each(|part| *part *= factor);
    }
}
