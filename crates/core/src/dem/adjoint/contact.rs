//! One contact as a function of numbers of any kind: what a run does at it, its slopes, and its slopes transposed.

use crate::contact::{AnyLaw, ForceLaw as _, History};
use crate::dem::neighbour::{SelfTouch, Touch};
use crate::real::{Dual, Number};

/// Where a contact is.
#[derive(Clone, Copy)]
pub(super) enum Place {
    /// Between two spheres.
    Pair(Touch<2>),
    /// Of a sphere with its image in a mirror.
    Image(SelfTouch),
}

/// What a contact depends on besides the motion of its spheres.
#[derive(Clone, Copy)]
pub(super) struct Make<N> {
    /// As in [`Touch`] and [`SelfTouch`].
    pub gap: N,
    pub reach: N,
    pub law: AnyLaw<N>,
}

/// How its spheres move: the second's displacement less the first's (m), and the first's velocity less the second's (m/s); for an image
/// the sphere's own.
#[derive(Clone, Copy)]
pub(super) struct Motion<N> {
    pub shift: [N; 2],
    pub approach: [N; 2],
}

/// What a contact answers. The two laws that lenses are designed with are compiled into the loop around, others stand apart.
#[inline(always)]
fn under<N: Number>(law: &AnyLaw<N>, overlap: N, closing_speed: N, history: &History<N>) -> (N, History<N>) {
    match law {
        AnyLaw::Thesis(law) | AnyLaw::ThesisStatic(law) => law.respond(overlap, closing_speed, history),
        AnyLaw::Consistent(law) | AnyLaw::ConsistentStatic(law) => law.respond(overlap, closing_speed, history),
        other => other.respond(overlap, closing_speed, history),
    }
}

/// The force on the second sphere, or on the one with an image (N), and what the contact remembers then. None while it is open.
/// The same operations in the same order as the sweep of a run, so that their bits are the same.
#[inline(always)]
pub(super) fn respond<N: Number>(
    place: &Place,
    make: &Make<N>,
    motion: &Motion<N>,
    history: &History<N>,
    closed: f64,
) -> Option<([N; 2], History<N>)> {
    let zero = N::splat(0.0);
    match place {
        Place::Pair(touch) => {
            let least = N::splat(2.0 * closed) * make.reach * make.reach;
            let mut excess = -make.gap;
            let mut between = [zero; 2];
            for k in 0..2 {
                let shift = motion.shift[k];
                excess = excess - shift * (N::splat(2.0 * touch.offset[k]) + shift);
                between[k] = N::splat(touch.offset[k]) + shift;
            }
            if !N::all(least.lt(excess)) {
                return None;
            }
            let distance = (between[0] * between[0] + between[1] * between[1]).sqrt();
            let sum = make.reach + distance;
            let quotient = N::splat(1.0) / (sum * distance);
            let overlap = excess * (quotient * distance);
            let inverse = quotient * sum;
            let mut closing_speed = zero;
            for k in 0..2 {
                between[k] = between[k] * inverse;
                closing_speed = closing_speed + motion.approach[k] * between[k];
            }
            let (push, history) = under(&make.law, overlap, closing_speed, history);
            Some(([push * between[0], push * between[1]], history))
        }
        Place::Image(touch) => {
            let (two, inward) = (N::splat(2.0), N::splat(touch.inward));
            let overlap = -(two * inward * motion.shift[touch.axis] + make.gap);
            if !N::all((N::splat(closed) * make.reach).lt(overlap)) {
                return None;
            }
            let closing_speed = -(two * inward * motion.approach[touch.axis]);
            let (push, history) = under(&make.law, overlap, closing_speed, history);
            let mut force = [zero; 2];
            force[touch.axis] = inward * push;
            Some((force, history))
        }
    }
}

/// Quantities of each sphere that a contact depends on: density, Young's modulus, yield stress and radius, each as its logarithm.
pub(super) const QUANTITIES: usize = 4;
/// What a contact's slopes are with respect to: shift, approach, what it remembers, and the quantities of both spheres.
const SLOPES: usize = 2 + 2 + 3 + 2 * QUANTITIES;
/// As many numbers as fill whole registers.
const WIDE: usize = SLOPES.next_multiple_of(8);
/// Outcomes: the force and what is remembered.
const OUTCOMES: usize = 2 + 3;

/// A number with its slopes.
pub(super) type Sloped = Dual<f64, WIDE>;

/// A contact's make with its slopes by the quantities of its spheres.
pub(super) fn sloped_by_quantities(value: f64, slopes: &[f64; 2 * QUANTITIES]) -> Sloped {
    let mut number = Sloped::constant(value);
    number.slopes[7..SLOPES].copy_from_slice(slopes);
    number
}

/// The slopes of a contact's outcomes.
pub(super) struct Slopes([[f64; WIDE]; OUTCOMES]);

/// What an objective gains by a contact's inputs.
#[derive(Clone, Copy)]
pub(super) struct Gains {
    pub shift: [f64; 2],
    pub approach: [f64; 2],
    pub history: [f64; 3],
    pub quantities: [f64; 2 * QUANTITIES],
}

/// The slopes in this state. None while the contact is open: nothing depends on anything then, and what it remembers stays.
#[inline(always)]
pub(super) fn slopes(
    place: &Place,
    make: &Make<Sloped>,
    motion: &Motion<f64>,
    history: &History,
    closed: f64,
) -> Option<Slopes> {
    let variable = |value: f64, which: usize| Sloped::variable(value, which);
    let motion = Motion {
        shift: [variable(motion.shift[0], 0), variable(motion.shift[1], 1)],
        approach: [variable(motion.approach[0], 2), variable(motion.approach[1], 3)],
    };
    let history = History {
        overlap_max: variable(history.overlap_max, 4),
        force_max: variable(history.force_max, 5),
        own: variable(history.own, 6),
    };
    let (force, after) = respond(place, make, &motion, &history, closed)?;
    Some(Slopes([force[0].slopes, force[1].slopes, after.overlap_max.slopes, after.force_max.slopes, after.own.slopes]))
}

impl Slopes {
    /// What is gained by the inputs, from what is gained by the force and by what is remembered after the step.
    #[inline(always)]
    pub fn transposed(&self, force: [f64; 2], history: [f64; 3]) -> Gains {
        let outcomes = [force[0], force[1], history[0], history[1], history[2]];
        let mut gains = [0.0; WIDE];
        for (row, gain) in self.0.iter().zip(outcomes) {
            for k in 0..WIDE {
                gains[k] += row[k] * gain;
            }
        }
        let mut quantities = [0.0; 2 * QUANTITIES];
        quantities.copy_from_slice(&gains[7..SLOPES]);
        Gains {
            shift: [gains[0], gains[1]],
            approach: [gains[2], gains[3]],
            history: [gains[4], gains[5], gains[6]],
            quantities,
        }
    }
}
