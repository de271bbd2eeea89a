//! What contacts do: the normal and the tangential force of two overlapping ends.
//!
//! Geometry and friction are written for any [`Lanes`]: one contact at a time, or in lanes (`lanes`).

use crate::dem::rig::bodies::{cross, dot, spin_cross};
use crate::dem::rig::dashpot::Ended;
use crate::dem::rig::law::{Bond, Bonding, Slip};
use crate::dem::rig::pairs::Near;
use crate::dem::rig::turns::Turns;
use crate::real::Lanes;

use super::account::Account;

/// The velocities at which forces are asked for, and the step that follows.
#[derive(Clone, Copy)]
pub struct Trial<'a, const D: usize> {
    pub velocity: &'a [[f64; D]],
    /// r ω of each sphere (m/s); not asked for without friction.
    pub turn: &'a Turns<D>,
    pub flat_velocity: &'a [[f64; D]],
    /// (s)
    pub step: f64,
}

/// What a closed contact does: the force on its second end, and the couple per lever arm on both.
#[derive(Clone, Copy, Debug)]
pub struct Reaction<const D: usize> {
    pub force: [f64; D],
    pub twist: [f64; 3],
}

/// The state of two ends that overlap.
pub struct Meeting<V, const D: usize> {
    pub overlap: V,
    pub closing_speed: V,
    /// From the first end to the second.
    pub normal: [V; D],
    /// Velocity of the first end's centre relative to the second's.
    pub approach: [V; D],
    /// r₁ ω₁ + r₂ ω₂
    pub turn: [V; 3],
}

/// What friction does at a contact.
pub struct Rub<V, const D: usize> {
    /// The force that holds the first end back, and drags the second along.
    pub drag: [V; D],
    /// The couple per lever arm on both.
    pub twist: [V; 3],
    /// What it takes (W).
    pub power: V,
}

/// Overlap over the radii's sum from which on a contact counts as closed; as in `dem::contacts`.
pub const CLOSED: f64 = 1e-15;

impl Slip {
    #[inline(always)]
    pub fn stiffness_at(&self, overlap: f64) -> f64 {
        if self.mindlin > 0.0 { self.stiffness + self.mindlin * overlap.sqrt() } else { self.stiffness }
    }
}

/// From the centre of the first sphere to that of the second, Δ = offset + shift, and S² − |Δ|² with S² − |offset|² = −gap:
/// without the cancellation of two nearly equal squares. Positive where they overlap.
#[inline(always)]
pub fn between<V: Lanes, const D: usize>(offset: &[V; D], shift: &[V; D], gap: V) -> ([V; D], V) {
    let mut between = *offset;
    let mut excess = -gap;
    for k in 0..D {
        excess = excess - shift[k] * (V::splat(2.0) * offset[k] + shift[k]);
        between[k] = offset[k] + shift[k];
    }
    (between, excess)
}

/// Two overlapping spheres of radii's sum `reach`, with the velocity of the first relative to the second and
/// `turn` = r₁ ω₁ + r₂ ω₂.
#[inline(always)]
pub fn meet<V: Lanes, const D: usize>(
    (between, excess): (&[V; D], V),
    reach: V,
    approach: &[V; D],
    turn: &[V; 3],
) -> Meeting<V, D> {
    let distance = dot(between, between).sqrt();
    // One quotient for both: overlap = (S² − |Δ|²)/(S + |Δ|), and 1/|Δ| for the normal.
    let sum = reach + distance;
    let quotient = V::splat(1.0) / (sum * distance);
    let overlap = excess * (quotient * distance);
    let inverse = quotient * sum;
    let mut normal = *between;
    for k in 0..D {
        normal[k] = between[k] * inverse;
    }
    let closing_speed = dot(approach, &normal);
    Meeting { overlap, closing_speed, normal, approach: *approach, turn: *turn }
}

/// Friction at closed contacts.
pub struct Grip<V> {
    /// μ
    pub coefficient: V,
    /// k_t (N/m)
    pub stiffness: V,
    /// γ_t m̄ (kg/s)
    pub damping: V,
}

impl<V: Lanes> Grip<V> {
    /// The force that the first end's sliding meets, F_t = k_t ξ + γ_t m̄ u, at most μ |F_n|; ξ advances by one step. Without
    /// `SPRING` k_t is zero, and ξ is left alone.
    #[inline(always)]
    pub fn rub<const D: usize, const SPRING: bool>(
        &self,
        meeting: &Meeting<V, D>,
        push: V,
        stretch: &mut [V; D],
        step: f64,
    ) -> Rub<V, D> {
        if D == 2 {
            return self.rub_in_plane::<D, SPRING>(meeting, push, stretch, step);
        }
        let (zero, normal) = (V::splat(0.0), &meeting.normal);
        // Velocity of the first end's surface relative to the second's, in the tangent plane.
        let (along, turn) = (dot(&meeting.approach, normal), spin_cross(&meeting.turn, normal));
        let mut sliding = meeting.approach;
        for k in 0..D {
            sliding[k] = sliding[k] - along * normal[k] + turn[k];
        }
        let mut drag = [zero; D];
        if SPRING {
            // ξ is turned into the tangent plane, then follows the sliding: ξ̇ = u.
            let along = dot(stretch, normal);
            for k in 0..D {
                stretch[k] = stretch[k] + (V::splat(step) * sliding[k] - along * normal[k]);
                drag[k] = self.stiffness * stretch[k] + self.damping * sliding[k];
            }
        } else {
            for k in 0..D {
                drag[k] = self.damping * sliding[k];
            }
        }
        let cap = self.coefficient * push.max(-push);
        let (most, squared) = (cap * cap, dot(&drag, &drag));
        let slips = most.lt(squared);
        if V::any(slips) {
            let shorter = V::select(slips, cap / squared.sqrt(), V::splat(1.0));
            let softness =
                if SPRING { V::select(zero.lt(self.stiffness), V::splat(1.0) / self.stiffness, zero) } else { zero };
            for k in 0..D {
                drag[k] = drag[k] * shorter;
                if SPRING {
                    let kept = (drag[k] - self.damping * sliding[k]) * softness;
                    stretch[k] = V::select(slips, kept, stretch[k]);
                }
            }
        }
        Rub { twist: cross(&drag, normal), power: dot(&drag, &sliding), drag }
    }

    /// The same in the plane, where friction has one direction: a force is cut to its cap without a root.
    #[inline(always)]
    fn rub_in_plane<const D: usize, const SPRING: bool>(
        &self,
        meeting: &Meeting<V, D>,
        push: V,
        stretch: &mut [V; D],
        step: f64,
    ) -> Rub<V, D> {
        let zero = V::splat(0.0);
        let mut tangent = meeting.normal;
        (tangent[0], tangent[D - 1]) = (-meeting.normal[D - 1], meeting.normal[0]);
        let slide = dot(&meeting.approach, &tangent) + meeting.turn[2];
        let (mut wound, damped) = (zero, self.damping * slide);
        let mut drag = damped;
        if SPRING {
            // ξ is turned into the tangent, then follows the sliding: ξ̇ = u.
            wound = dot(stretch, &tangent) + V::splat(step) * slide;
            drag = self.stiffness * wound + damped;
        }
        let cap = self.coefficient * push.max(-push);
        let cut = drag.min(cap).max(-cap);
        if SPRING {
            let slips = cap.lt(drag.max(-drag));
            if V::any(slips) {
                let softness = V::select(zero.lt(self.stiffness), V::splat(1.0) / self.stiffness, zero);
                wound = V::select(slips, (cut - damped) * softness, wound);
            }
            for k in 0..D {
                stretch[k] = wound * tangent[k];
            }
        }
        for k in 0..D {
            tangent[k] = cut * tangent[k];
        }
        Rub { drag: tangent, twist: [zero, zero, -cut], power: cut * slide }
    }
}

/// The reaction of two spheres, if they overlap.
#[inline(always)]
#[expect(clippy::too_many_arguments, reason = "the columns of one row of parallel arrays")]
pub fn react_pair<const D: usize, L: Bonding, const TURNING: bool>(
    near: &Near<D>,
    displacement: &[[f64; D]],
    trial: Trial<D>,
    (bond, reduced): (&Bond<L>, f64),
    memory: &mut L::Memory,
    stretch: &mut [f64; D],
    account: &mut Account,
    share: f64,
) -> Option<Reaction<D>> {
    let Trial { velocity, turn, step, .. } = trial;
    let Near { ends: [a, b], offset, gap, reach, .. } = *near;
    let (a, b) = (a as usize, b as usize);
    let (from, to) = (&displacement[a], &displacement[b]);
    let mut shift = [0.0; D];
    for k in 0..D {
        shift[k] = to[k] - from[k];
    }
    let (between, excess) = between(&offset, &shift, gap);
    let closed = excess > 2.0 * CLOSED * reach * reach;
    if !closed && account.overlap == 0.0 {
        return None;
    }
    let mut approach = [0.0; D];
    for k in 0..D {
        approach[k] = velocity[a][k] - velocity[b][k];
    }
    if !closed {
        let meeting = meet::<f64, D>((&between, excess), reach, &approach, &[0.0; 3]);
        *stretch = [0.0; D];
        return release::<D, L>(&meeting, (bond, reduced), memory, account, step, share);
    }
    let mut turns = [0.0; 3];
    if TURNING {
        let (first, second) = (turn.get(a), turn.get(b));
        for k in 0..3 {
            turns[k] = first[k] + second[k];
        }
    }
    let meeting = meet::<f64, D>((&between, excess), reach, &approach, &turns);
    Some(react::<D, L, TURNING>(&meeting, (bond, reduced), memory, stretch, account, step, share))
}

/// What the normal force still does of a contact that has just opened, whose overlap is negative.
#[inline(always)]
pub fn release<const D: usize, L: Bonding>(
    meeting: &Meeting<f64, D>,
    (bond, reduced): (&Bond<L>, f64),
    memory: &L::Memory,
    account: &mut Account,
    step: f64,
    share: f64,
) -> Option<Reaction<D>> {
    let before = [account.overlap, account.force];
    let Ended { acts, last } = bond.normal.end(before, -meeting.overlap, meeting.closing_speed, reduced, memory);
    account.open(last, step);
    (acts != 0.0).then(|| Reaction { force: meeting.normal.map(|n| share * acts * n), twist: [0.0; 3] })
}

/// Normal and tangential force of a closed contact; its memories advance by one step.
#[inline(always)]
pub fn react<const D: usize, L: Bonding, const TURNING: bool>(
    meeting: &Meeting<f64, D>,
    (bond, reduced): (&Bond<L>, f64),
    memory: &mut L::Memory,
    stretch: &mut [f64; D],
    account: &mut Account,
    step: f64,
    share: f64,
) -> Reaction<D> {
    let Meeting { overlap, closing_speed, normal, .. } = meeting;
    let (push, acts) = if account.overlap > 0.0 {
        let (push, next) = bond.normal.respond(*overlap, *closing_speed, reduced, memory);
        *memory = next;
        (push, push)
    } else {
        let begun = bond.normal.begin(*overlap, *closing_speed, reduced, memory, step);
        (*memory, account.force) = (begun.memory, begun.onset);
        (begun.force, begun.acts)
    };
    let mut force = normal.map(|n| share * acts * n);
    let (mut twist, mut power) = ([0.0; 3], 0.0);
    if TURNING && bond.slip.coefficient > 0.0 {
        let slip = &bond.slip;
        let stiffness = slip.stiffness_at(*overlap);
        let grip = Grip { coefficient: slip.coefficient, stiffness, damping: slip.rate * reduced };
        let rub = if stiffness > 0.0 {
            grip.rub::<D, true>(meeting, push, stretch, step)
        } else {
            grip.rub::<D, false>(meeting, push, stretch, step)
        };
        power = rub.power;
        for k in 0..D {
            force[k] += share * rub.drag[k];
        }
        twist = rub.twist.map(|couple| share * couple);
    }
    account.accept(*overlap, push, power, step);
    Reaction { force, twist }
}
