//! What one contact does: the normal and the tangential force of two overlapping ends.

use crate::dem::rig::bodies::{cross, dot, spin_cross};
use crate::dem::rig::law::{Bond, Bonding, End, Slip};
use crate::dem::rig::pairs::Near;

/// What a contact remembers besides its normal law's memory.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Account {
    /// Overlap (m) and normal force (N) at the last accepted step; zero while open.
    pub overlap: f64,
    pub force: f64,
    /// ∫F dδ by the trapezoidal rule (J)
    pub work: f64,
    /// Work done against the tangential force (J), of which the spring still holds `wound`; its power (W) at the last step.
    pub slid: f64,
    pub power: f64,
    /// ½ k_t ξ² (J)
    pub wound: f64,
}

impl Account {
    /// How many numbers it is.
    pub const NUMBERS: usize = 6;

    pub fn numbers(&self) -> [f64; 6] {
        [self.overlap, self.force, self.work, self.slid, self.power, self.wound]
    }

    /// From its six numbers.
    pub fn from_numbers(n: &[f64]) -> Self {
        Self { overlap: n[0], force: n[1], work: n[2], slid: n[3], power: n[4], wound: n[5] }
    }

    #[inline(always)]
    fn accept(&mut self, overlap: f64, force: f64) {
        self.work += 0.5 * (self.force + force) * (overlap - self.overlap);
        (self.overlap, self.force) = (overlap, force);
    }

    /// The contact opens: what the spring held is lost.
    pub fn open(&mut self, step: f64) {
        self.accept(0.0, 0.0);
        self.slid += 0.5 * step * self.power;
        (self.power, self.wound) = (0.0, 0.0);
    }
}

/// The velocities at which forces are asked for, and the step that follows.
#[derive(Clone, Copy)]
pub struct Trial<'a, const D: usize> {
    pub velocity: &'a [[f64; D]],
    pub spin: &'a [[f64; 3]],
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
pub struct Meeting<const D: usize> {
    pub overlap: f64,
    pub closing_speed: f64,
    /// From the first end to the second.
    pub normal: [f64; D],
    /// Velocity of the first end's surface relative to the second's, in the tangent plane.
    pub sliding: [f64; D],
}

/// Overlap over the radii's sum from which on a contact counts as closed; as in `dem::contacts`.
pub const CLOSED: f64 = 1e-15;

impl Slip {
    #[inline(always)]
    pub fn stiffness_at(&self, overlap: f64) -> f64 {
        if self.mindlin > 0.0 { self.stiffness + self.mindlin * overlap.sqrt() } else { self.stiffness }
    }
}

/// The reaction of two spheres, if they overlap.
#[inline(always)]
#[expect(clippy::too_many_arguments, reason = "the columns of one row of parallel arrays")]
pub fn react_pair<const D: usize, L: Bonding, const TURNING: bool>(
    near: &Near<D>,
    displacement: &[[f64; D]],
    trial: Trial<D>,
    ends: &[End],
    (bond, reduced): (&Bond<L>, f64),
    memory: &mut L::Memory,
    stretch: &mut [f64; D],
    account: &mut Account,
    share: f64,
) -> Option<Reaction<D>> {
    let Trial { velocity, spin, step, .. } = trial;
    let Near { ends: [a, b], offset, gap, reach, .. } = *near;
    let (a, b) = (a as usize, b as usize);
    let (from, to) = (&displacement[a], &displacement[b]);
    let mut between = [0.0; D];
    // S² − |Δ|² with Δ = offset + shift, without the cancellation of two nearly equal squares.
    let mut excess = -gap;
    for k in 0..D {
        let shift = to[k] - from[k];
        excess -= shift * (2.0 * offset[k] + shift);
        between[k] = offset[k] + shift;
    }
    if excess <= 2.0 * CLOSED * reach * reach {
        if account.overlap > 0.0 {
            account.open(step);
            *stretch = [0.0; D];
        }
        return None;
    }
    let distance = dot(&between, &between).sqrt();
    // One quotient for both: overlap = (S² − |Δ|²)/(S + |Δ|), and 1/|Δ| for the normal.
    let sum = reach + distance;
    let quotient = 1.0 / (sum * distance);
    let overlap = excess * (quotient * distance);
    let inverse = quotient * sum;
    let normal = between.map(|x| x * inverse);
    let mut approach = [0.0; D];
    for k in 0..D {
        approach[k] = velocity[a][k] - velocity[b][k];
    }
    let closing_speed = dot(&approach, &normal);
    let mut sliding = [0.0; D];
    if TURNING {
        let (ra, rb) = (ends[a].radius, ends[b].radius);
        let (wa, wb) = (&spin[a], &spin[b]);
        let turn = spin_cross(&std::array::from_fn(|k| ra * wa[k] + rb * wb[k]), &normal);
        for k in 0..D {
            sliding[k] = approach[k] - closing_speed * normal[k] + turn[k];
        }
    }
    let meeting = Meeting { overlap, closing_speed, normal, sliding };
    Some(react::<D, L, TURNING>(&meeting, (bond, reduced), memory, stretch, account, step, share))
}

/// Normal and tangential force of a closed contact; its memories advance by one step.
#[inline(always)]
pub fn react<const D: usize, L: Bonding, const TURNING: bool>(
    meeting: &Meeting<D>,
    (bond, reduced): (&Bond<L>, f64),
    memory: &mut L::Memory,
    stretch: &mut [f64; D],
    account: &mut Account,
    step: f64,
    share: f64,
) -> Reaction<D> {
    let Meeting { overlap, closing_speed, normal, sliding } = meeting;
    let (push, next) = bond.normal.respond(*overlap, *closing_speed, reduced, memory);
    *memory = next;
    account.accept(*overlap, push);
    let mut force = normal.map(|n| share * push * n);
    let mut twist = [0.0; 3];
    if TURNING && bond.slip.coefficient > 0.0 {
        let slip = &bond.slip;
        let (stiffness, damping) = (slip.stiffness_at(*overlap), slip.rate * reduced);
        // ξ is turned into the tangent plane, then follows the sliding: ξ̇ = u.
        let along = dot(stretch, normal);
        let mut drag = [0.0; D];
        for k in 0..D {
            stretch[k] += step * sliding[k] - along * normal[k];
            drag[k] = stiffness * stretch[k] + damping * sliding[k];
        }
        let (cap, squared) = (slip.coefficient * push.abs(), dot(&drag, &drag));
        if squared > cap * cap {
            let shorter = cap / squared.sqrt();
            for k in 0..D {
                drag[k] *= shorter;
                if stiffness > 0.0 {
                    stretch[k] = (drag[k] - damping * sliding[k]) / stiffness;
                }
            }
        }
        // The first end is held back by −drag, the second dragged along.
        let power = dot(&drag, sliding);
        account.slid += 0.5 * step * (account.power + power);
        account.power = power;
        account.wound = 0.5 * stiffness * dot(stretch, stretch);
        for k in 0..D {
            drag[k] *= share;
            force[k] += drag[k];
        }
        twist = cross(normal, &drag.map(|f| -f));
    }
    Reaction { force, twist }
}
