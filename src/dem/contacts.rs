//! All contacts of a packing: geometry at rest, law, history and energy, as parallel arrays.

use super::body::{Grains, dot, square};
use super::neighbour::{SelfTouch, Touch, Touching};
use crate::contact::{ForceLaw, History};
use crate::real::Real;

/// The law of every contact.
pub(super) trait Laws<V: Real>: Sync {
    /// The law's type, the same for all contacts.
    type Law: ForceLaw<V>;
    /// The law of a contact; images follow the pairs.
    fn of(&self, contact: usize) -> Self::Law;
}

/// What a contact remembers, and its part of the energy ledger.
#[derive(Clone, Copy, Debug)]
pub(super) struct Memory<V> {
    pub history: History<V>,
    /// Overlap and force at the last accepted step; zero while open.
    pub overlap: V,
    pub force: V,
    /// ∫F dδ by the trapezoidal rule over accepted steps [J]
    pub work: V,
}

impl<V: Real> Memory<V> {
    fn new() -> Self {
        let zero = V::splat(0.0);
        Self { history: History::new(), overlap: zero, force: zero, work: zero }
    }

    /// Advances the work by one accepted step; `overlap` is not negative.
    #[inline(always)]
    fn accept(&mut self, overlap: V, force: V) {
        let half = V::splat(0.5);
        self.work = self.work + half * (self.force + force) * (overlap - self.overlap);
        (self.overlap, self.force) = (overlap, force);
    }

    /// The force in a closed contact; with `ACCEPT` history and work advance.
    #[inline(always)]
    fn push<const ACCEPT: bool>(&mut self, law: &impl ForceLaw<V>, overlap: V, closing_speed: V) -> V {
        if ACCEPT {
            let (force, history) = law.respond(overlap, closing_speed, &self.history);
            self.history = history;
            self.accept(overlap, force);
            force
        } else {
            law.force(overlap, closing_speed, &self.history)
        }
    }
}

/// Contacts as parallel arrays: row c of each is contact c, in order of the first sphere.
pub(super) struct Contacts<V, const D: usize, L> {
    pub pairs: Vec<Touch<D>>,
    pub images: Vec<SelfTouch>,
    /// Pairs, then images.
    pub memory: Vec<Memory<V>>,
    /// Pairs weigh 1, or 1/2 where they lie in a mirror; images 1/2.
    pub weight: Vec<f64>,
    pub laws: L,
    /// For each sphere the number of pairs whose first sphere comes before it.
    first_pair: Vec<usize>,
}

impl<V: Real, const D: usize, L: Laws<V>> Contacts<V, D, L> {
    pub fn new(touching: Touching<D>, grains: &Grains<V, D>, laws: L) -> Self {
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
        let memory = vec![Memory::new(); weight.len()];
        Self { pairs, images, memory, weight, laws, first_pair }
    }

    /// Adds up the contact forces on the simulated part of every sphere, at the given displacements and velocities, for all
    /// spheres that the wave has reached; extends `grains.reached` to those it reaches now. With `ACCEPT` the
    /// contacts' memories advance.
    #[inline(always)]
    pub fn sweep<const ACCEPT: bool>(
        &mut self,
        displacement: &[[V; D]],
        velocity: &[[V; D]],
        force: &mut [[V; D]],
        reached: &mut usize,
    ) {
        let zero = V::splat(0.0);
        let two = V::splat(2.0);
        force[..*reached].fill([zero; D]);
        let mut touched = *reached;
        for c in 0..self.first_pair[*reached] {
            let Touch { pair: [a, b], offset, gap, reach } = self.pairs[c];
            let offset = offset.map(V::splat);
            let shift: [V; D] = std::array::from_fn(|k| displacement[b][k] - displacement[a][k]);
            // S² − |Δ|² with Δ = offset + shift, without the cancellation of two nearly equal squares.
            let excess = -(V::splat(gap) + two * dot(&offset, &shift) + square(&shift));
            let memory = &mut self.memory[c];
            if !V::any(zero.lt(excess)) {
                if ACCEPT && V::any(zero.lt(memory.overlap)) {
                    memory.accept(zero, zero);
                }
                continue;
            }
            let between: [V; D] = std::array::from_fn(|k| offset[k] + shift[k]);
            let distance = square(&between).sqrt();
            let overlap = (excess / (V::splat(reach) + distance)).max(zero);
            let normal: [V; D] = between.map(|x| x / distance);
            let closing: [V; D] = std::array::from_fn(|k| velocity[a][k] - velocity[b][k]);
            let closing_speed = dot(&closing, &normal);
            let magnitude = memory.push::<ACCEPT>(&self.laws.of(c), overlap, closing_speed);
            if b >= touched {
                force[touched..=b].fill([zero; D]);
                touched = b + 1;
            }
            let push = magnitude * V::splat(self.weight[c]);
            for k in 0..D {
                force[a][k] = force[a][k] - push * normal[k];
                force[b][k] = force[b][k] + push * normal[k];
            }
        }
        let pairs = self.pairs.len();
        for (k, touch) in self.images.iter().enumerate() {
            let SelfTouch { sphere, axis, inward } = *touch;
            if sphere >= *reached {
                break;
            }
            let inward = V::splat(inward);
            let overlap = -(two * inward * displacement[sphere][axis]);
            let memory = &mut self.memory[pairs + k];
            if !V::any(zero.lt(overlap)) {
                if ACCEPT && V::any(zero.lt(memory.overlap)) {
                    memory.accept(zero, zero);
                }
                continue;
            }
            let overlap = overlap.max(zero);
            let closing_speed = -(two * inward * velocity[sphere][axis]);
            let magnitude = memory.push::<ACCEPT>(&self.laws.of(pairs + k), overlap, closing_speed);
            force[sphere][axis] = force[sphere][axis] + inward * magnitude;
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

    /// Radii sum by which an overlap of this contact is judged [m].
    pub fn reach(&self, contact: usize, radius_of: impl Fn(usize) -> f64) -> f64 {
        match self.pairs.get(contact) {
            Some(touch) => touch.reach,
            None => 2.0 * radius_of(self.images[contact - self.pairs.len()].sphere),
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
