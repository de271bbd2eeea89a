//! What friction does at closed contacts.
//!
//! Three rules. [`Grip`], of disks with springs and dashpots: a spring of constant stiffness and a dashpot under one cap, as Kondic et
//! al. have it, for any [`Lanes`]. [`coulomb`], of all other rigs: a spring whose stiffness may follow the overlap, and which never gives back more than
//! was put in; it resists rolling too. [`spread`]: many springs side by side, of which those at the rim slip first.

use crate::dem::rig::bodies::dot;
use crate::dem::rig::law::Slip;
use crate::dem::rig::{Rig, Spring};
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
    /// That of rolling: the same spring under another cap.
    #[inline(always)]
    pub fn of_rolling(&self) -> Self {
        Self { coefficient: self.rolling, ..*self }
    }

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

/// Friction after one step, by [`coulomb`] or [`spread`].
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

impl<const D: usize> Rubbed<D> {
    /// A dashpot beside the spring, c (kg/s) times the sliding (m/s), their sum under the same cap (N): its share lies between T and T + c u,
    /// or, in three dimensions, is the projection on the circle of radius μ |F_n|, and opposes the sliding in both.
    #[inline(always)]
    pub fn damp(&mut self, cap: f64, damping: f64, sliding: &[f64; D], (power_before, step): (f64, f64)) {
        let spring = self.drag;
        for k in 0..D {
            self.drag[k] += damping * sliding[k];
        }
        let size = dot(&self.drag, &self.drag).sqrt();
        if size > cap {
            self.drag = self.drag.map(|force| force * (cap / size));
        }
        for k in 0..D {
            self.power += (self.drag[k] - spring[k]) * sliding[k];
        }
        self.work += 0.5 * step * (power_before + self.power);
    }
}

/// Coulomb's friction with a tangential spring, |T| ≤ μ |F_n|.
///
/// While k_t grows the spring is incremental, dT = k_t du: a force that is there does not change because the contact is pressed
/// harder. While k_t falls the force falls with it, T = k_t ξ: a spring that became softer at the same force would hold more energy
/// than was put in. So on every path ∫T·du ≥ ½ T²/k_t, and no closed path of overlap and slip gives work (Thornton and Randall
/// 1988; "mindlin_rescale" of LAMMPS). At the cap the spring is cut back to it, along its own direction; the contact slides by the
/// rest.
///
/// `way` is how far the first end has slid during the step (m), `before` the account of the step before, `stretch` its ξ = T/k_t. Work is counted so that what friction takes is a sum of
/// terms of which none is negative: what a spring loses at constant ξ or T, and slip times cap.
#[inline(always)]
pub fn coulomb<const D: usize>(
    slip: &Slip,
    (overlap, normal): (f64, &[f64; D]),
    (push, way): (f64, &[f64; D]),
    (before, stretch): (&Account, &[f64; D]),
) -> Rubbed<D> {
    let cap = slip.coefficient * push.abs();
    let [was, now] = [before.overlap, overlap].map(|overlap| slip.stiffness_at(overlap));
    let (mut drag, mut stretch, mut work) = ([0.0; D], *stretch, 0.0);
    if now > 0.0 {
        turn_into_plane(&mut stretch, normal);
        let during = slip.mean_stiffness([before.overlap, overlap]);
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
    Rubbed { drag, stretch, work, power: 0.0 }
}

/// Springs of a row, at most. Half of them are in contact at least; the tangential restitution of oblique blows is then that of very many
/// springs to 2·10⁻³.
const SPRINGS: usize = 32;

/// Springs side by side, y = x/√r* from the middle of a contact whose edge is at y = √δ: spring i stands at (i + ½) w, the first number is w,
/// then come the ξ of each.
pub struct Row<'a, const D: usize> {
    /// k of each (N/m)
    stiffness: f64,
    stretch: &'a [f64],
}

impl<'a, const D: usize> Row<'a, D> {
    /// Of springs as they are remembered.
    pub fn of(slip: &Slip, springs: &'a [f64]) -> Self {
        Self { stiffness: slip.mindlin * springs[0], stretch: &springs[1..] }
    }

    /// The force of all together (N).
    pub fn force(&self) -> [f64; D] {
        let mut sum = [0.0; D];
        for one in self.stretch.chunks_exact(D) {
            (0..D).for_each(|k| sum[k] += self.stiffness * one[k]);
        }
        sum
    }

    /// What they hold (J).
    pub fn stored(&self) -> f64 {
        0.5 * self.stiffness * self.stretch.iter().map(|part| part * part).sum::<f64>()
    }
}

/// Coulomb's friction that is spread over the contact: each spring of a row slips by itself when its force exceeds μ times the part of the
/// normal force on it, (3/2) F (1 − y²/δ) dy/√δ of Hertz's pressure. The stiffness of each is constant, k = k_t w/√δ, and springs beyond the edge carry
/// nothing: so the middle sticks while the rim slips, and no closed path gives work. See [`Spring::CattaneoMindlin`](crate::dem::rig::Spring).
///
/// The row is as wide as twice the contact at most; when the contact outgrows it, two springs become one, at the mean of both: the force
/// stays, and energy is lost, never gained.
#[inline(always)]
pub fn spread<const D: usize>(
    slip: &Slip,
    (overlap, normal): (f64, &[f64; D]),
    (push, way): (f64, &[f64; D]),
    before: &Account,
    springs: &mut [f64],
) -> Rubbed<D> {
    let edge = overlap.sqrt();
    let (width, stretch) = springs.split_first_mut().expect("a row has a width");
    let held = 0.5 * slip.mindlin * *width * stretch.iter().map(|part| part * part).sum::<f64>();
    if *width == 0.0 {
        // A power of two, of which the edge takes half as many as there are springs, or more.
        let part = edge / SPRINGS as f64;
        *width = 2.0 * f64::from_bits(part.to_bits() & 0x7ff0_0000_0000_0000).max(f64::MIN_POSITIVE);
    }
    while *width * (SPRINGS as f64) < edge {
        for i in 0..SPRINGS {
            for k in 0..D {
                let both = |i: usize| stretch.get(i * D + k).copied().unwrap_or(0.0);
                stretch[i * D + k] = 0.5 * (both(2 * i) + both(2 * i + 1));
            }
        }
        *width *= 2.0;
    }
    let width = *width;
    let stiffness = slip.mindlin * width;
    // μ F over all springs, by the share of each at an overlap.
    let shares = |overlap: f64, force: f64| {
        let share = move |i: usize| {
            let y = (i as f64 + 0.5) * width;
            (overlap - y * y).max(0.0)
        };
        let sum: f64 = (0..SPRINGS).map(share).sum();
        let all = slip.coefficient * force.abs();
        // What reaches no spring is borne by the one in the middle.
        move |i: usize| if sum > 0.0 { all * share(i) / sum } else { all * f64::from(u8::from(i == 0)) }
    };
    let (cap_before, cap) = (shares(before.overlap, before.force), shares(overlap, push));
    let (mut drag, mut work) = ([0.0; D], 0.0);
    for (i, one) in stretch.chunks_exact_mut(D).enumerate() {
        let mut own: [f64; D] = std::array::from_fn(|k| one[k]);
        turn_into_plane(&mut own, normal);
        let mut force: [f64; D] = std::array::from_fn(|k| stiffness * (own[k] + way[k]));
        let (size, cap) = (dot(&force, &force).sqrt(), cap(i));
        if size > cap {
            force = force.map(|part| part * (cap / size));
            work += 0.5 * (cap_before(i) + cap) * (size - cap) / stiffness;
        }
        for k in 0..D {
            drag[k] += force[k];
            one[k] = force[k] / stiffness;
        }
    }
    let holds = 0.5 * stiffness * stretch.iter().map(|part| part * part).sum::<f64>();
    Rubbed { drag, stretch: [0.0; D], work: work + (holds - held), power: 0.0 }
}

/// What friction remembers of each contact besides one spring: the way rolled, three numbers; and a row of springs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct More {
    rolls: bool,
    spread: bool,
}

impl More {
    /// What any friction of a rig asks for.
    pub fn of<const D: usize>(rig: &Rig<D>) -> Self {
        Self {
            rolls: rig.frictions().any(|friction| friction.rolling > 0.0),
            spread: rig.frictions().any(|friction| friction.spring == Spring::CattaneoMindlin),
        }
    }

    /// How many numbers that is.
    pub const fn count<const D: usize>(self) -> usize {
        let rolled = if self.rolls { 3 } else { 0 };
        if self.spread { rolled + 1 + SPRINGS * D } else { rolled }
    }

    /// The way rolled, of a contact's numbers.
    pub fn rolled(self, numbers: &[f64]) -> Option<&[f64; 3]> {
        numbers.first_chunk().filter(|_| self.rolls)
    }

    /// The row of springs, of a contact's numbers.
    pub fn springs(self, numbers: &[f64]) -> &[f64] {
        &numbers[if self.rolls { 3 } else { 0 }..]
    }
}

/// What friction remembers of a contact besides, to be changed.
pub struct Held<'a> {
    pub more: More,
    pub numbers: &'a mut [f64],
}

impl Held<'_> {
    /// The row of springs of a contact whose friction is spread over it.
    #[inline(always)]
    pub fn springs(&mut self, slip: &Slip) -> Option<&mut [f64]> {
        let first = if self.more.rolls { 3 } else { 0 };
        if slip.spread { self.numbers.get_mut(first..) } else { None }
    }

    /// The way rolled of a contact that resists it.
    #[inline(always)]
    pub fn rolled(&mut self, slip: &Slip) -> Option<&mut [f64; 3]> {
        if slip.rolling > 0.0 { self.numbers.first_chunk_mut() } else { None }
    }
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
