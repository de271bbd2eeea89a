//! All contacts of a packing: geometry at rest, law, history and energy, as parallel arrays; and the force sweep.

use super::body::{Grains, square};
use super::neighbour::{SelfTouch, Touch, Touching};
use crate::contact::{History, NormalLaw};
use crate::real::Lanes;

/// The law of every contact.
pub(super) trait Laws<V: Lanes>: Sync {
    /// The law of one design.
    type One: NormalLaw;
    /// The force of a contact in this state; images follow the pairs.
    fn force(&self, contact: usize, overlap: V, closing_speed: V, history: &History<V>) -> V;
    /// The force, and the history after an accepted step.
    fn respond(&self, contact: usize, overlap: V, closing_speed: V, history: &History<V>) -> (V, History<V>);
    /// The law of a contact in one of the designs.
    fn one(&self, contact: usize, lane: usize) -> Self::One;
}

/// A contact's part of the energy ledger.
#[derive(Clone, Copy, Debug)]
pub(super) struct Account<V> {
    /// Overlap and force at the last accepted step; zero while open.
    pub overlap: V,
    pub force: V,
    /// ∫F dδ by the trapezoidal rule over accepted steps (J)
    pub work: V,
}

impl<V: Lanes> Account<V> {
    fn new() -> Self {
        let zero = V::splat(0.0);
        Self { overlap: zero, force: zero, work: zero }
    }

    /// Advances the work by one accepted step; `overlap` is not negative.
    #[inline(always)]
    fn accept(&mut self, overlap: V, force: V) {
        let half = V::splat(0.5);
        self.work = self.work + half * (self.force + force) * (overlap - self.overlap);
        (self.overlap, self.force) = (overlap, force);
    }
}

/// What a sweep does besides adding up forces.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Sweep {
    /// Nothing: the state is not accepted.
    Try,
    /// Histories advance.
    Accept,
    /// Histories and energy accounts advance.
    AcceptAndAccount,
}

/// Contacts as parallel arrays: row c of each is contact c, in order of the first sphere.
pub(super) struct Contacts<V, const D: usize, L> {
    pub pairs: Vec<Touch<D>>,
    pub images: Vec<SelfTouch>,
    /// What each contact remembers: pairs, then images.
    pub history: Vec<History<V>>,
    /// Its part of the energy ledger; empty where none is kept.
    pub account: Vec<Account<V>>,
    /// Pairs weigh 1, or 1/2 where they lie in a mirror; images 1/2.
    pub weight: Vec<f64>,
    pub laws: L,
    /// For each sphere the number of pairs whose first sphere comes before it.
    first_pair: Vec<usize>,
}

/// Overlap over the sum of radii from which on a contact counts as closed. At 10⁻¹⁵ it carries some 10⁻¹⁶ N. Without it the
/// numerical fore-runner of a wave would cross a row per step, with denormal numbers in it, and nothing be left to skip.
pub(super) const CLOSED: f64 = 1e-15;

impl<V: Lanes, const D: usize, L: Laws<V>> Contacts<V, D, L> {
    /// With `accounts` false no energy ledger is kept.
    pub fn new(touching: Touching<D>, grains: &Grains<V, D>, laws: L, accounts: bool) -> Self {
        let Touching { pairs, images } = touching;
        let spheres = grains.weight.len();
        // A pair in a mirror plane is shared by both halves: both of its spheres lie on the same plane.
        let in_plane = |touch: &Touch<D>| {
            let [a, b] = touch.pair;
            (0..D).any(|k| grains.mobility[a][k] == 0.0 && grains.mobility[b][k] == 0.0 && touch.offset[k] == 0.0)
        };
        let weight = pairs.iter().map(|touch| if in_plane(touch) { 0.5 } else { 1.0 });
        let weight: Vec<f64> = weight.chain(images.iter().map(|_| 0.5)).collect();
        let first_pair = (0..=spheres).map(|i| pairs.partition_point(|touch| touch.pair[0] < i)).collect();
        let history = vec![History::new(); weight.len()];
        let account = if accounts { vec![Account::new(); weight.len()] } else { Vec::new() };
        Self { pairs, images, history, account, weight, laws, first_pair }
    }

    /// The force in a closed contact; its memories advance as `sweep` says.
    #[inline(always)]
    fn push(&mut self, contact: usize, overlap: V, closing_speed: V, sweep: Sweep) -> V {
        if sweep == Sweep::Try {
            return self.laws.force(contact, overlap, closing_speed, &self.history[contact]);
        }
        let (force, history) = self.laws.respond(contact, overlap, closing_speed, &self.history[contact]);
        self.history[contact] = history;
        if sweep == Sweep::AcceptAndAccount {
            self.account[contact].accept(overlap, force);
        }
        force
    }

    /// An open contact does no work from here on.
    #[inline(always)]
    fn open(&mut self, contact: usize, sweep: Sweep) {
        let zero = V::splat(0.0);
        if sweep == Sweep::AcceptAndAccount && V::any(zero.lt(self.account[contact].overlap)) {
            self.account[contact].accept(zero, zero);
        }
    }

    /// Adds up the contact forces on the simulated part of every sphere, at the given displacements and velocities, for all
    /// spheres that the wave has reached; extends `reached` to those it reaches now.
    #[inline(always)]
    pub fn sweep(
        &mut self,
        displacement: &[[V; D]],
        velocity: &[[V; D]],
        force: &mut [[V; D]],
        reached: &mut usize,
        sweep: Sweep,
    ) {
        let zero = V::splat(0.0);
        let two = V::splat(2.0);
        for sum in &mut force[..*reached] {
            *sum = [zero; D];
        }
        let mut touched = *reached;
        for c in 0..self.first_pair[*reached] {
            let Touch { pair: [a, b], offset, gap, reach } = self.pairs[c];
            let (from, to) = (displacement[a], displacement[b]);
            let mut between = [zero; D];
            // S² − |Δ|² with Δ = offset + shift, without the cancellation of two nearly equal squares.
            let mut excess = -V::splat(gap);
            for k in 0..D {
                let shift = to[k] - from[k];
                excess = excess - shift * (V::splat(2.0 * offset[k]) + shift);
                between[k] = V::splat(offset[k]) + shift;
            }
            let closed = V::splat(2.0 * CLOSED * reach * reach).lt(excess);
            if !V::any(closed) {
                self.open(c, sweep);
                continue;
            }
            let distance = square(&between).sqrt();
            // One quotient for both: overlap = (S² − |Δ|²)/(S + |Δ|), and 1/|Δ| for the normal.
            let sum = V::splat(reach) + distance;
            let quotient = V::splat(1.0) / (sum * distance);
            let overlap = V::select(closed, excess * (quotient * distance), zero);
            let inverse = quotient * sum;
            let (of_a, of_b) = (velocity[a], velocity[b]);
            let mut closing_speed = zero;
            for k in 0..D {
                between[k] = between[k] * inverse;
                closing_speed = closing_speed + (of_a[k] - of_b[k]) * between[k];
            }
            let push = self.push(c, overlap, closing_speed, sweep) * V::splat(self.weight[c]);
            while touched <= b {
                force[touched] = [zero; D];
                touched += 1;
            }
            for k in 0..D {
                force[a][k] = force[a][k] - push * between[k];
                force[b][k] = force[b][k] + push * between[k];
            }
        }
        for k in 0..self.images.len() {
            let (contact, SelfTouch { sphere, axis, inward, reach }) = (self.pairs.len() + k, self.images[k]);
            if sphere >= *reached {
                break;
            }
            let inward = V::splat(inward);
            let overlap = -(two * inward * displacement[sphere][axis]);
            let closed = V::splat(CLOSED * reach).lt(overlap);
            if !V::any(closed) {
                self.open(contact, sweep);
                continue;
            }
            let overlap = V::select(closed, overlap, zero);
            let closing_speed = -(two * inward * velocity[sphere][axis]);
            let push = self.push(contact, overlap, closing_speed, sweep);
            force[sphere][axis] = force[sphere][axis] + inward * push;
        }
        *reached = touched;
    }

    /// Whether two spheres (or a sphere and its image, given twice) are one of the contacts.
    pub fn holds(&self, i: usize, j: usize) -> bool {
        if i == j {
            return self.images.binary_search_by_key(&i, |touch| touch.sphere).is_ok();
        }
        self.pairs[self.first_pair[i]..self.first_pair[i + 1]].iter().any(|touch| touch.pair[1] == j)
    }

    /// Radii sum by which an overlap of this contact is judged (m).
    pub fn reach(&self, contact: usize) -> f64 {
        match self.pairs.get(contact) {
            Some(touch) => touch.reach,
            None => self.images[contact - self.pairs.len()].reach,
        }
    }

    /// The spheres of a contact; an image's sphere twice.
    pub fn spheres(&self, contact: usize) -> [usize; 2] {
        match self.pairs.get(contact) {
            Some(touch) => touch.pair,
            None => [self.images[contact - self.pairs.len()].sphere; 2],
        }
    }
}
