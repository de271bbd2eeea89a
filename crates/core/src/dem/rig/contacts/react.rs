//! What contacts do: the force and the couple of two overlapping ends.
//!
//! A contact is one pure function of where its ends are, how they move and what it remembers, [`react`], for pairs of spheres
//! ([`react_pair`]) and for faces (`faces`) alike. Its geometry is written for any [`Lanes`]: one contact at a time, or in lanes
//! (`lanes`).

use crate::dem::rig::bodies::{Bodies, cross, dot, spin_cross, times};
use crate::dem::rig::dashpot::Ended;
use crate::dem::rig::law::{Begun, ContactLaw, PairLaw, Slip};
use crate::dem::rig::pairs::Near;
use crate::dem::rig::spins::Spins;
use crate::real::Lanes;

use super::account::Account;
use super::friction::{Grip, Held, Rub, Rubbed, coulomb, spread};

/// The velocities at which forces are asked for, and the step that led here.
#[derive(Clone, Copy)]
pub struct Predicted<'a, const D: usize> {
    pub velocity: &'a [[f64; D]],
    /// r ω of each sphere (m/s), or ω where arms end in the contact; not asked for without friction.
    pub turn: &'a Spins<D>,
    pub flat_velocity: &'a [[f64; D]],
    /// (s)
    pub step: f64,
}

/// What a closed contact does: the force on its second end, and the couple per lever arm on both.
#[derive(Clone, Copy, Debug)]
pub struct Reaction<const D: usize> {
    pub force: [f64; D],
    /// The part of it that is no force of this state, but an impulse over the step in which the contact began or ended.
    pub excess: [f64; D],
    pub twist: [f64; 3],
    /// The couple on the second end that resists rolling (N m); the first has the opposite.
    pub roll: [f64; 3],
    /// By what each end's couple is multiplied besides its `lever`.
    pub arms: [f64; 2],
}

/// What a contact remembers.
#[derive(Clone, Copy, Debug)]
pub struct Past<M, const D: usize> {
    /// Of its normal law.
    pub memory: M,
    /// ξ, the tangential spring (m).
    pub stretch: [f64; D],
    pub account: Account,
}

/// The state of two ends that overlap.
pub struct Meeting<V, const D: usize> {
    pub overlap: V,
    pub closing_speed: V,
    /// From the first end to the second.
    pub normal: [V; D],
    /// Velocity of the first end's centre relative to the second's.
    pub approach: [V; D],
    /// a₁ ω₁ + a₂ ω₂ with the lever arms a
    pub turn: [V; 3],
    /// One over the distance of two spheres' centres (1/m).
    pub inverse: V,
}

impl<V: Lanes, const D: usize> Meeting<V, D> {
    /// Velocity of the first end's surface relative to the second's, in the tangent plane.
    #[inline(always)]
    pub fn sliding(&self) -> [V; D] {
        sliding(&self.approach, &self.turn, &self.normal)
    }
}

/// Velocity of the first end's surface relative to the second's, across a normal.
#[inline(always)]
pub fn sliding<V: Lanes, const D: usize>(approach: &[V; D], turn: &[V; 3], normal: &[V; D]) -> [V; D] {
    let (along, turn) = (dot(approach, normal), spin_cross(turn, normal));
    let mut sliding = *approach;
    for k in 0..D {
        sliding[k] = sliding[k] - along * normal[k] + turn[k];
    }
    sliding
}

/// How far (m) the first end's surface slides over the second's in a step: from the centres' distance at its end, and the mean velocities and
/// turns over it, which hold half a step before.
#[inline(always)]
pub fn slid<V: Lanes, const D: usize>(
    (between, inverse): (&[V; D], V),
    approach: &[V; D],
    turn: &[V; 3],
    step: f64,
) -> [V; D] {
    let mut middle = *between;
    for k in 0..D {
        middle[k] = between[k] + V::splat(0.5 * step) * approach[k];
    }
    // As long as half a step changes the distance by little, from that at its end.
    let squared = dot(&middle, &middle);
    let rest = V::splat(1.0) - squared * (inverse * inverse);
    let mut of_middle = inverse * one_over_root(rest);
    let far = V::splat(NEARLY_ONE).lt(rest.max(-rest));
    if V::any(far) {
        of_middle = V::select(far, V::splat(1.0) / squared.sqrt(), of_middle);
    }
    times(&sliding(approach, turn, &times(&middle, of_middle)), V::splat(step))
}

/// Up to which x its series is exact to rounding: what is left out is 231/1024 x⁶.
pub const NEARLY_ONE: f64 = 1.0 / 1024.0;

/// 1/√(1 − x) for |x| ≤ [`NEARLY_ONE`], without a root or a quotient, of which a processor does few at a time.
#[inline(always)]
pub fn one_over_root<V: Lanes>(x: V) -> V {
    let c = V::splat;
    c(1.0) + x * (c(0.5) + x * (c(0.375) + x * (c(0.3125) + x * (c(0.273_437_5) + x * c(0.246_093_75)))))
}

/// The part of a step in which a contact has been closed that closed within it: it has slid for that part only.
#[inline(always)]
pub fn since<V: Lanes>(overlap_before: V, overlap: V, closing_speed: V, step: f64) -> V {
    let (zero, way) = (V::splat(0.0), closing_speed * V::splat(step));
    let whole = V::or(zero.lt(overlap_before), V::lt(way, overlap));
    V::select(whole, V::splat(1.0), overlap / way)
}

/// Overlap over the radii's sum from which on a contact counts as closed; as in `dem::contacts`.
pub const CLOSED: f64 = 1e-15;

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
    Meeting { overlap, closing_speed, normal, approach: *approach, turn: *turn, inverse }
}

/// Where the lever arms of contact forces end.
#[derive(Clone, Copy, Debug)]
pub enum Arms<'a> {
    /// At the radii, which `lever` holds already.
    Radius,
    /// In the middle of the overlap, of spheres of these radii (m): |Δ| = a₁ + a₂, so that a pair keeps its angular momentum.
    Contact(&'a [f64]),
}

impl Arms<'_> {
    /// Of two spheres, besides `lever`.
    #[inline(always)]
    fn of(&self, [a, b]: [usize; 2], overlap: f64) -> [f64; 2] {
        match self {
            Self::Radius => [1.0; 2],
            Self::Contact(radius) => [radius[a] - 0.5 * overlap, radius[b] - 0.5 * overlap],
        }
    }
}

/// How the bodies moved from the accepted step before to here, and how they are predicted to move now.
#[derive(Clone, Copy)]
pub struct Motion<'a, const D: usize> {
    pub bodies: &'a Bodies<D>,
    pub lever: &'a [f64],
    pub arms: Arms<'a>,
    pub predicted: Predicted<'a, D>,
}

impl<const D: usize> Motion<'_, D> {
    /// The sum of two spheres' radii (m).
    #[inline(always)]
    fn reach(&self, [a, b]: [usize; 2]) -> f64 {
        match self.arms {
            Arms::Radius => self.lever[a] + self.lever[b],
            Arms::Contact(radius) => radius[a] + radius[b],
        }
    }

    /// Mean of r ω (or ω) over the step.
    #[inline(always)]
    pub fn mean_turn(&self, sphere: usize) -> [f64; 3] {
        let (now, before) = (self.predicted.turn.get(sphere), self.bodies.spin.get(sphere));
        std::array::from_fn(|k| 0.5 * (now[k] + self.lever[sphere] * before[k]))
    }

    /// Mean velocity over the step: Verlet's displacement by it.
    #[inline(always)]
    pub fn mean_velocity(&self, sphere: usize) -> [f64; D] {
        let (now, before) = (&self.predicted.velocity[sphere], &self.bodies.velocity[sphere]);
        std::array::from_fn(|k| 0.5 * (now[k] + before[k]))
    }
}

/// How far one end has turned against the other during a step, and on which radius it rolls.
#[derive(Clone, Copy, Debug, Default)]
pub struct Rolls {
    /// R_r (m)
    pub radius: f64,
    /// By what the first end has turned more than the second (rad).
    pub turned: [f64; 3],
}

/// The reaction of two spheres and what the contact remembers then, if they overlap or have just parted.
#[inline(always)]
pub fn react_pair<const D: usize, L: ContactLaw, const TURNING: bool>(
    near: &Near<D>,
    motion: Motion<D>,
    (pair_law, reduced): (&PairLaw<L>, f64),
    past: &Past<L::Memory, D>,
    mut held: Held<'_>,
) -> Option<(Reaction<D>, Past<L::Memory, D>)> {
    let Predicted { velocity, turn, step, .. } = motion.predicted;
    let (offset, gap) = near.lies();
    let [a, b] = near.ends.map(|end| end as usize);
    let reach = motion.reach([a, b]);
    let (from, to) = (&motion.bodies.displacement[a], &motion.bodies.displacement[b]);
    let mut shift = [0.0; D];
    for k in 0..D {
        shift[k] = to[k] - from[k];
    }
    let (between, excess) = between(&offset, &shift, gap);
    let closed = excess > 2.0 * CLOSED * reach * reach;
    if !closed && past.account.overlap == 0.0 {
        return None;
    }
    let mut approach = [0.0; D];
    for k in 0..D {
        approach[k] = velocity[a][k] - velocity[b][k];
    }
    let mut meeting = meet::<f64, D>((&between, excess), reach, &approach, &[0.0; 3]);
    if !closed {
        held.numbers.fill(0.0);
        return Some(release::<D, L>(&meeting, (pair_law, reduced), past, step));
    }
    let (mut arms, mut way, mut rolls) = ([1.0; 2], [0.0; D], Rolls::default());
    if TURNING {
        arms = motion.arms.of([a, b], meeting.overlap);
        let together =
            |first: [f64; 3], second: [f64; 3]| std::array::from_fn(|k| arms[0] * first[k] + arms[1] * second[k]);
        meeting.turn = together(turn.get(a), turn.get(b));
        if !by_grip::<D, L>() && step > 0.0 {
            let (first, second) = (motion.mean_velocity(a), motion.mean_velocity(b));
            let approach: [f64; D] = std::array::from_fn(|k| first[k] - second[k]);
            let turned = [motion.mean_turn(a), motion.mean_turn(b)];
            if pair_law.slip.rolling > 0.0 {
                let turned = std::array::from_fn(|k| (turned[0][k] - turned[1][k]) * step);
                rolls = Rolls { radius: pair_law.slip.rolling_radius, turned };
            }
            way = slid((&between, meeting.inverse), &approach, &together(turned[0], turned[1]), step);
        }
    }
    let (reaction, past) =
        react::<D, L, TURNING>(&meeting, (&way, rolls), (pair_law, reduced), past, (&mut held, step));
    Some((Reaction { arms, ..reaction }, past))
}

/// Whether friction is [`Grip`]'s.
#[inline(always)]
fn by_grip<const D: usize, L: ContactLaw>() -> bool {
    L::GRIPS && D == 2
}

/// What the normal force still does of a contact that has just opened, whose overlap is negative, and what is remembered then.
#[inline(always)]
pub fn release<const D: usize, L: ContactLaw>(
    meeting: &Meeting<f64, D>,
    (pair_law, reduced): (&PairLaw<L>, f64),
    past: &Past<L::Memory, D>,
    step: f64,
) -> (Reaction<D>, Past<L::Memory, D>) {
    let (memory, mut account) = (past.memory, past.account);
    let before = [account.overlap, account.force];
    let Ended { acts, last } = pair_law.normal.end(before, -meeting.overlap, meeting.closing_speed, reduced, &memory);
    account.open(last, step);
    let force = meeting.normal.map(|n| acts * n);
    (
        Reaction { force, excess: force, twist: [0.0; 3], roll: [0.0; 3], arms: [1.0; 2] },
        Past { memory, stretch: [0.0; D], account },
    )
}

/// Normal and tangential force of a closed contact, whose ends slid by `way` (m) and rolled during the step, and what it remembers then.
#[inline(always)]
pub fn react<const D: usize, L: ContactLaw, const TURNING: bool>(
    meeting: &Meeting<f64, D>,
    (way, rolls): (&[f64; D], Rolls),
    (pair_law, reduced): (&PairLaw<L>, f64),
    past: &Past<L::Memory, D>,
    (held, step): (&mut Held<'_>, f64),
) -> (Reaction<D>, Past<L::Memory, D>) {
    let Meeting { overlap, closing_speed, normal, .. } = meeting;
    let (mut twist, mut roll, mut stretch, mut account) = ([0.0; 3], [0.0; 3], past.stretch, past.account);
    let (push, acts, memory) = if past.account.overlap > 0.0 {
        let (push, memory) = pair_law.normal.respond(*overlap, *closing_speed, reduced, &past.memory);
        (push, push, memory)
    } else {
        let Begun { acts, force, onset, memory } =
            pair_law.normal.begin(*overlap, *closing_speed, reduced, &past.memory, step);
        account.force = onset;
        (force, acts, memory)
    };
    let mut force = normal.map(|n| acts * n);
    if TURNING && (pair_law.slip.coefficient > 0.0 || pair_law.slip.rolling > 0.0) {
        let slip = &pair_law.slip;
        let damping = slip.rate * reduced;
        if by_grip::<D, L>() {
            let rub = gripped(slip, damping, meeting, push, (&mut stretch, step));
            (force[0], force[D - 1]) = (force[0] + rub.drag[0], force[D - 1] + rub.drag[1]);
            twist[2] = rub.twist;
            account.rub(rub.power, step);
        } else {
            let since = since(past.account.overlap, *overlap, *closing_speed, step);
            let slipped = (push, &way.map(|x| since * x));
            let rubbed = sprung(slip, damping, meeting, slipped, (&stretch, &account), (&mut *held, step));
            for k in 0..D {
                force[k] += rubbed.drag[k];
            }
            (twist, stretch) = (cross(&rubbed.drag, normal), rubbed.stretch);
            account.friction_work += rubbed.work;
            account.power = rubbed.power;
            if let Some(rolled) = held.rolled(slip) {
                let upright: [f64; 3] = std::array::from_fn(|k| if k < D { normal[k] } else { 0.0 });
                let about = dot(&rolls.turned, &upright);
                // The part about the normal is no rolling.
                let way = std::array::from_fn(|k| since * rolls.radius * (rolls.turned[k] - about * upright[k]));
                let before = ([account.overlap, account.force], &*rolled);
                let resists = coulomb(&slip.of_rolling(), (*overlap, &upright), (push, &way), before);
                *rolled = resists.stretch;
                roll = resists.drag.map(|force| rolls.radius * force);
                account.friction_work += resists.work;
            }
        }
    }
    account.push(*overlap, push);
    let excess = normal.map(|n| (acts - push) * n);
    (Reaction { force, excess, twist, roll, arms: [1.0; 2] }, Past { memory, stretch, account })
}

/// The force of friction on the second end of a closed contact as it is now, under the normal force `push`: its law over a step of no
/// length, so that its springs stay as they are.
pub fn friction<const D: usize, L: ContactLaw>(
    meeting: &Meeting<f64, D>,
    (pair_law, reduced): (&PairLaw<L>, f64),
    push: f64,
    (stretch, account): (&[f64; D], &Account),
    mut held: Held<'_>,
) -> [f64; D] {
    let slip = &pair_law.slip;
    let damping = slip.rate * reduced;
    if by_grip::<D, L>() {
        let rub = gripped(slip, damping, meeting, push, (&mut { *stretch }, 0.0));
        let mut drag = [0.0; D];
        (drag[0], drag[D - 1]) = (rub.drag[0], rub.drag[1]);
        return drag;
    }
    sprung(slip, damping, meeting, (push, &[0.0; D]), (stretch, account), (&mut held, 0.0)).drag
}

/// Friction by [`Grip`], in the plane, over a step (s) at whose end the spring is stretched by what stands in `stretch` then.
#[inline(always)]
fn gripped<const D: usize>(
    slip: &Slip,
    damping: f64,
    meeting: &Meeting<f64, D>,
    push: f64,
    (stretch, step): (&mut [f64; D], f64),
) -> Rub<f64> {
    let grip = Grip { coefficient: slip.coefficient, stiffness: slip.stiffness, damping };
    let (plane, mut spring) = (meeting.in_plane(), [stretch[0], stretch[D - 1]]);
    let rub = match slip.stiffness > 0.0 {
        true => grip.rub::<true>(&plane, push, &mut spring, step),
        false => grip.rub::<false>(&plane, push, &mut spring, step),
    };
    (stretch[0], stretch[D - 1]) = (spring[0], spring[1]);
    rub
}

/// Friction by springs in any dimension, of a contact whose ends slid by `way` (m) under the normal force `push`.
#[inline(always)]
fn sprung<const D: usize>(
    slip: &Slip,
    damping: f64,
    meeting: &Meeting<f64, D>,
    (push, way): (f64, &[f64; D]),
    (stretch, account): (&[f64; D], &Account),
    (held, step): (&mut Held<'_>, f64),
) -> Rubbed<f64, D> {
    let place = (meeting.overlap, &meeting.normal);
    let mut rubbed = match held.springs(slip) {
        Some(springs) => spread(slip, place, (push, way), account, springs),
        None => coulomb(&slip.sliding(), place, (push, way), ([account.overlap, account.force], stretch)),
    };
    if damping > 0.0 {
        rubbed.damp(slip.coefficient * push.abs(), damping, &meeting.sliding(), (account.power, step));
    }
    rubbed
}

impl<const D: usize> Meeting<f64, D> {
    /// Its first and last component, which are all of it in the plane.
    #[inline(always)]
    fn in_plane(&self) -> Meeting<f64, 2> {
        let plane = |v: &[f64; D]| [v[0], v[D - 1]];
        let Self { overlap, closing_speed, turn, inverse, .. } = *self;
        Meeting { overlap, closing_speed, turn, inverse, normal: plane(&self.normal), approach: plane(&self.approach) }
    }
}
