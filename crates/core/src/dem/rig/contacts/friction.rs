//! What friction does at closed contacts.
//!
//! Three rules. [`Grip`], of disks with springs and dashpots: a spring of constant stiffness and a dashpot under one cap, as Kondic et
//! al. have it, for any [`Lanes`]. [`coulomb`], of all other rigs: a spring whose stiffness may follow the overlap, and which never gives back more than
//! was put in; it resists rolling too. [`spread`]: many springs side by side, of which those at the rim slip first.

use crate::dem::rig::bodies::{dot, times};
use crate::dem::rig::law::Slip;
use crate::dem::rig::{Rig, Spring};
use crate::real::Lanes;

use super::account::Account;
use super::react::{Meeting, NEARLY_ONE, one_over_root};

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

/// What [`coulomb`] knows of a contact, one or several side by side.
#[derive(Clone, Copy)]
pub struct Coulomb<V> {
    /// μ
    pub coefficient: V,
    /// k_t (N/m), constant part
    pub stiffness: V,
    /// k_t over √δ (N/m^1.5), Mindlin's part
    pub mindlin: V,
}

impl Slip {
    /// What [`coulomb`] asks for.
    #[inline(always)]
    pub fn sliding(&self) -> Coulomb<f64> {
        Coulomb { coefficient: self.coefficient, stiffness: self.stiffness, mindlin: self.mindlin }
    }

    /// That of rolling: the same spring under another cap.
    #[inline(always)]
    pub fn of_rolling(&self) -> Coulomb<f64> {
        Coulomb { coefficient: self.rolling, ..self.sliding() }
    }

    /// k_t at an overlap.
    #[inline(always)]
    pub fn stiffness_at(&self, overlap: f64) -> f64 {
        self.sliding().stiffness_at(overlap.sqrt())
    }
}

impl<V: Lanes> Coulomb<V> {
    /// k_t at an overlap of this root.
    #[inline(always)]
    fn stiffness_at(&self, root: V) -> V {
        self.stiffness + self.mindlin * root
    }

    /// The mean of k_t while the overlap changes between two, whose roots these are, at a constant rate. ∫√δ dδ between a and b is
    /// (2/3)(b^{3/2} − a^{3/2}).
    #[inline(always)]
    fn mean_stiffness(&self, [a, b]: [V; 2]) -> V {
        let (zero, sum) = (V::splat(0.0), a + b);
        let mean = (a * a + a * b + b * b) / (V::splat(1.5) * sum);
        self.stiffness + self.mindlin * V::select(zero.lt(sum), mean, zero)
    }
}

/// Friction after one step, by [`coulomb`] or [`spread`].
#[derive(Clone, Copy)]
pub struct Rubbed<V, const D: usize> {
    /// The force that holds the first end back, and drags the second along.
    pub drag: [V; D],
    /// ξ (m)
    pub stretch: [V; D],
    /// Work done against it during the step (J).
    pub work: V,
    /// What its dashpot takes (W).
    pub power: V,
}

impl<V: Lanes, const D: usize> Rubbed<V, D> {
    /// A dashpot beside the spring, c (kg/s) times the sliding (m/s), their sum under the same cap (N): its share lies between T and T + c u,
    /// or, in three dimensions, is the projection on the circle of radius μ |F_n|, and opposes the sliding in both.
    #[inline(always)]
    pub fn damp(&mut self, cap: V, damping: V, sliding: &[V; D], (power_before, step): (V, f64)) {
        let spring = self.drag;
        for k in 0..D {
            self.drag[k] = self.drag[k] + damping * sliding[k];
        }
        let size = dot(&self.drag, &self.drag).sqrt();
        let cut = V::select(cap.lt(size), cap / size, V::splat(1.0));
        for k in 0..D {
            self.drag[k] = self.drag[k] * cut;
            self.power = self.power + (self.drag[k] - spring[k]) * sliding[k];
        }
        self.work = self.work + V::splat(0.5 * step) * (power_before + self.power);
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
pub fn coulomb<V: Lanes, const D: usize>(
    slip: &Coulomb<V>,
    (overlap, normal): (V, &[V; D]),
    (push, way): (V, &[V; D]),
    ([overlap_before, force_before], stretch): ([V; 2], &[V; D]),
) -> Rubbed<V, D> {
    let (zero, one, half) = (V::splat(0.0), V::splat(1.0), V::splat(0.5));
    let (force_before, force) = (force_before.max(-force_before), push.max(-push));
    let cap = slip.coefficient * force;
    let roots = [overlap_before.sqrt(), overlap.sqrt()];
    let (was, now) = (slip.stiffness_at(roots[0]), slip.stiffness_at(roots[1]));
    let during = slip.mean_stiffness(roots);
    let turned = turned_into_plane(stretch, normal);
    // T and ξ, as if nothing slid; and the stiffness by which what exceeds the cap is slip.
    let (springs, softens) = (zero.lt(now), now.lt(was));
    let yielding = V::select(softens, now, during);
    let mut drag = [zero; D];
    for k in 0..D {
        let stretched = V::select(softens, now * (turned[k] + way[k]), was * turned[k] + during * way[k]);
        drag[k] = V::select(springs, stretched, zero);
    }
    let held = dot(&turned, &turned);
    let squared = dot(&drag, &drag);
    let (slips, mut work) = ((cap * cap).lt(squared), zero);
    if V::any(slips) {
        let size = squared.sqrt();
        let cut = V::select(slips, cap / size, one);
        drag = times(&drag, cut);
        let slid = (size - cap) / yielding;
        work = V::select(slips, half * slip.coefficient * (force_before + force) * slid, zero);
    }
    let softness = one / now;
    let mut now_stretch = *stretch;
    for k in 0..D {
        now_stretch[k] = V::select(springs, drag[k] * softness, stretch[k]);
    }
    let grown = (dot(&drag, &drag) - was * was * held) / (V::splat(2.0) * during);
    let fallen = half * during * (dot(&now_stretch, &now_stretch) - held);
    work = V::select(springs, work + V::select(softens, fallen, grown), zero);
    Rubbed { drag, stretch: now_stretch, work, power: zero }
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
) -> Rubbed<f64, D> {
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
        let own = turned_into_plane(&std::array::from_fn(|k| one[k]), normal);
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

/// A vector turned into the plane across the normal, without changing its length.
#[inline(always)]
fn turned_into_plane<V: Lanes, const D: usize>(vector: &[V; D], normal: &[V; D]) -> [V; D] {
    let length = dot(vector, vector);
    let along = dot(vector, normal);
    let mut turned = *vector;
    for k in 0..D {
        turned[k] = turned[k] - along * normal[k];
    }
    let (left, zero, one) = (dot(&turned, &turned), V::splat(0.0), V::splat(1.0));
    // √(length/left), which are nearly the same as long as the normal turns by little in a step.
    let rest = (length - left) / V::select(zero.lt(length), length, one);
    let mut factor = one_over_root(rest);
    let far = V::splat(NEARLY_ONE).lt(rest);
    if V::any(far) {
        factor = V::select(far, V::select(zero.lt(left), (length / left).sqrt(), one), factor);
    }
    times(&turned, factor)
}
