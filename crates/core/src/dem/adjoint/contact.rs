//! One contact as a function of numbers of any kind: what a run does at it, its slopes, and its slopes transposed.

use crate::contact::{AnyLaw, ForceLaw as _, History};
use crate::dem::boundary::Mirror;
use crate::dem::friction::{Slid, Slide, Spring};
use crate::dem::neighbour::{SelfTouch, Touch};
use crate::real::{Dual, Number};

/// Where a contact is.
#[derive(Clone, Copy)]
pub(super) enum Place {
    /// Between two spheres.
    Pair(Touch<2>),
    /// Of a sphere with its image in a mirror.
    Image(SelfTouch<2>, Mirror),
}

/// What a contact depends on besides the motion of its spheres.
#[derive(Clone, Copy)]
pub(super) struct Make<N> {
    /// As in [`Touch`] and [`SelfTouch`].
    pub gap: N,
    pub reach: N,
    pub law: AnyLaw<N>,
    /// Of pairs that rub.
    pub rub: Option<Rub<N>>,
}

/// What friction at a pair depends on.
#[derive(Clone, Copy)]
pub(super) struct Rub<N> {
    /// μ
    pub coefficient: f64,
    /// (s)
    pub step: f64,
    /// (m)
    pub radii: [N; 2],
    /// 8 G* √r*
    pub stiffness: N,
}

/// How its spheres move: the second's displacement less the first's (m), and the first's velocity less the second's (m/s); for an image
/// the sphere's own. Spins are zero where there is no friction.
#[derive(Clone, Copy)]
pub(super) struct Motion<N> {
    pub shift: [N; 2],
    pub approach: [N; 2],
    pub spins: [N; 2],
}

/// What a contact remembers. An image, and a pair without friction, has no spring.
#[derive(Clone, Copy)]
pub(super) struct Memory<N> {
    pub history: History<N>,
    pub spring: Spring<N>,
}

/// What a contact does.
#[derive(Clone, Copy)]
pub(super) struct Answer<N> {
    /// The force across it on the second sphere, or on the one with an image (N).
    pub push: [N; 2],
    /// The force along it on the second sphere (N).
    pub drag: [N; 2],
    /// What turns its spheres back (N m).
    pub couple: [N; 2],
    /// What it remembers then.
    pub memory: Memory<N>,
}

/// What a contact answers. The two laws that lenses are designed with are compiled into the loop around where it is `QUICK`, others stand apart: with as
/// many slopes as friction has they would be a third of a megabyte of the program.
#[inline(always)]
fn under<N: Number, const QUICK: bool>(
    law: &AnyLaw<N>,
    overlap: N,
    closing_speed: N,
    history: &History<N>,
) -> (N, History<N>) {
    match law {
        AnyLaw::Thesis(law) | AnyLaw::ThesisStatic(law) if QUICK => law.respond(overlap, closing_speed, history),
        AnyLaw::Consistent(law) | AnyLaw::ConsistentStatic(law) if QUICK => {
            law.respond(overlap, closing_speed, history)
        }
        other => other.respond(overlap, closing_speed, history),
    }
}

/// What it does in this state. None while it is open. The same operations in the same order as the sweep of a run, so that their bits are the same.
#[inline(always)]
pub(super) fn respond<N: Number, const QUICK: bool>(
    place: &Place,
    make: &Make<N>,
    motion: &Motion<N>,
    memory: &Memory<N>,
    closed: f64,
) -> Option<Answer<N>> {
    let zero = N::splat(0.0);
    let Memory { history, spring } = memory;
    let mut between = [zero; 2];
    let (overlap, closing_speed) = match place {
        Place::Pair(touch) => {
            let least = N::splat(2.0 * closed) * make.reach * make.reach;
            let mut excess = -make.gap;
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
            (overlap, closing_speed)
        }
        Place::Image(_, Mirror { axis, inward, .. }) => {
            let (two, inward) = (N::splat(2.0), N::splat(*inward));
            let overlap = -(two * inward * motion.shift[*axis] + make.gap);
            if !N::all((N::splat(closed) * make.reach).lt(overlap)) {
                return None;
            }
            (overlap, -(two * inward * motion.approach[*axis]))
        }
    };
    // Once for both: laws are long in numbers with slopes.
    let (push, history) = under::<N, QUICK>(&make.law, overlap, closing_speed, history);
    let unrubbed = Memory { history, spring: *spring };
    let across = match place {
        Place::Pair(_) => [push * between[0], push * between[1]],
        Place::Image(_, Mirror { axis, inward, .. }) => {
            let mut force = [zero; 2];
            force[*axis] = N::splat(*inward) * push;
            return Some(Answer { push: force, drag: [zero; 2], couple: [zero; 2], memory: unrubbed });
        }
    };
    let Some(Rub { coefficient, step, radii, stiffness }) = make.rub else {
        return Some(Answer { push: across, drag: [zero; 2], couple: [zero; 2], memory: unrubbed });
    };
    let tangent = [-between[1], between[0]];
    let slide = Slide {
        overlap,
        closing_speed,
        push,
        across: motion.approach[0] * tangent[0] + motion.approach[1] * tangent[1],
        radii,
        spins: motion.spins,
        stiffness,
    };
    let Slid { force, arms, spring, .. } = slide.under(coefficient, Some(step), spring);
    Some(Answer {
        push: across,
        drag: [force * tangent[0], force * tangent[1]],
        couple: [arms[0] * force, arms[1] * force],
        memory: Memory { history, spring },
    })
}

/// Quantities of each sphere that a contact depends on: density, Young's modulus, yield stress and radius, each as its logarithm.
pub(super) const QUANTITIES: usize = 4;
/// What a contact's slopes are with respect to: shift, approach, what it remembers, and the quantities of both spheres; ...
const SLOPES: usize = 2 + 2 + 3 + 2 * QUANTITIES;
/// ... where it rubs both spins too, and ξ, √δ and u of its spring.
const SLOPES_RUBBING: usize = SLOPES + 2 + 3;
/// As many numbers as fill whole registers.
pub(super) const WIDE: usize = SLOPES.next_multiple_of(8);
pub(super) const WIDE_RUBBING: usize = SLOPES_RUBBING.next_multiple_of(8);
/// Outcomes: the force and what is remembered; where it rubs, couples and the spring too.
pub(super) const OUTCOMES: usize = 2 + 3;
pub(super) const OUTCOMES_RUBBING: usize = OUTCOMES + 2 + 3;

/// A number with its slopes: so many that it is known whether the contact rubs.
pub(super) type Sloped<const W: usize> = Dual<f64, W>;

/// A contact's make with its slopes by the quantities of its spheres.
pub(super) fn sloped_by_quantities<const W: usize>(value: f64, slopes: &[f64; 2 * QUANTITIES]) -> Sloped<W> {
    let mut number = Sloped::constant(value);
    number.slopes[7..SLOPES].copy_from_slice(slopes);
    number
}

/// The slopes of a contact's outcomes.
pub(super) struct Slopes<const W: usize, const O: usize>([[f64; W]; O]);

/// What an objective gains by what a contact does, or by what it depends on. Zero where there is no friction: spins, couples, springs.
#[derive(Clone, Copy)]
pub(super) struct Outcome {
    pub force: [f64; 2],
    pub history: [f64; 3],
    pub couple: [f64; 2],
    pub spring: [f64; 3],
}

/// What an objective gains by a contact's inputs.
#[derive(Clone, Copy)]
pub(super) struct Gains {
    pub shift: [f64; 2],
    pub approach: [f64; 2],
    pub history: [f64; 3],
    pub quantities: [f64; 2 * QUANTITIES],
    pub spins: [f64; 2],
    pub spring: [f64; 3],
}

/// The slopes in this state. None while the contact is open: then nothing depends on anything, its history stays, and its spring is gone.
#[inline(always)]
pub(super) fn slopes<const W: usize, const O: usize>(
    place: &Place,
    make: &Make<Sloped<W>>,
    motion: &Motion<f64>,
    memory: &Memory<f64>,
    closed: f64,
) -> Option<Slopes<W, O>> {
    let rubs = const { W > WIDE };
    let variable = |value: f64, which: usize| Sloped::variable(value, which);
    let of_friction =
        |value: f64, which: usize| if rubs { variable(value, SLOPES + which) } else { Sloped::constant(value) };
    let (history, spring) = (&memory.history, &memory.spring);
    let motion = Motion {
        shift: [variable(motion.shift[0], 0), variable(motion.shift[1], 1)],
        approach: [variable(motion.approach[0], 2), variable(motion.approach[1], 3)],
        spins: [of_friction(motion.spins[0], 0), of_friction(motion.spins[1], 1)],
    };
    let memory = Memory {
        history: History {
            overlap_max: variable(history.overlap_max, 4),
            force_max: variable(history.force_max, 5),
            own: variable(history.own, 6),
        },
        spring: Spring {
            stretch: of_friction(spring.stretch, 2),
            root: of_friction(spring.root, 3),
            slide: of_friction(spring.slide, 4),
            // Nothing but the account of energies asks for it.
            force: Sloped::constant(spring.force),
        },
    };
    let Answer { push, drag, couple, memory: Memory { history, spring } } = match rubs {
        true => respond::<_, false>(place, make, &motion, &memory, closed)?,
        false => respond::<_, true>(place, make, &motion, &memory, closed)?,
    };
    let force = [push[0] + drag[0], push[1] + drag[1]];
    let all = [force[0], force[1], history.overlap_max, history.force_max, history.own].into_iter().chain([
        couple[0],
        couple[1],
        spring.stretch,
        spring.root,
        spring.slide,
    ]);
    let mut slopes = [[0.0; W]; O];
    slopes.iter_mut().zip(all).for_each(|(slopes, outcome)| *slopes = outcome.slopes);
    Some(Slopes(slopes))
}

impl<const W: usize, const O: usize> Slopes<W, O> {
    /// What is gained by the inputs, from what is gained by the outcomes.
    #[inline(always)]
    pub fn transposed(&self, by: &Outcome) -> Gains {
        let Outcome { force, history, couple, spring } = *by;
        let outcomes = [force[0], force[1], history[0], history[1], history[2]].into_iter();
        let outcomes = outcomes.chain([couple[0], couple[1], spring[0], spring[1], spring[2]]);
        let mut gains = [0.0; W];
        for (row, gain) in self.0.iter().zip(outcomes) {
            for k in 0..W {
                gains[k] += row[k] * gain;
            }
        }
        let mut quantities = [0.0; 2 * QUANTITIES];
        quantities.copy_from_slice(&gains[7..SLOPES]);
        let of_friction = |which: usize| if const { W > WIDE } { gains[SLOPES + which] } else { 0.0 };
        Gains {
            shift: [gains[0], gains[1]],
            approach: [gains[2], gains[3]],
            history: [gains[4], gains[5], gains[6]],
            quantities,
            spins: [of_friction(0), of_friction(1)],
            spring: [of_friction(2), of_friction(3), of_friction(4)],
        }
    }
}
