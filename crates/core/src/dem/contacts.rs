//! All contacts of a packing: geometry at rest, law, history and energy, as parallel arrays; and the force sweep.

use super::body::{Grains, square};
use super::boundary::Mirror;
use super::friction::Friction;
use super::neighbour::{SelfTouch, Touch, Touching, image_gap};
use super::size::{self, Size, gap_squared};
use crate::contact::{History, NormalLaw};
use crate::real::Lanes;
use crate::sample::Sample;

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
    /// Renumbers the contacts: new contact c is the old contact `from[c]`, or one that has come up between the spheres
    /// `ends[c]`. False if there is no room for its law.
    fn renumber(&mut self, from: &[Option<usize>], ends: &[[usize; 2]]) -> bool;
}

/// More kinds of pairs than a table of laws for designs side by side holds.
#[derive(Debug)]
pub(super) struct NoRoom;

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

/// Contacts as parallel arrays: row c of each is contact c, in order of the first sphere. Those between spheres that come near
/// only later are put in between, so that forces are added in the same order whenever that is.
pub(super) struct Contacts<'a, V, const D: usize, L> {
    samples: &'a [&'a Sample<D>],
    pub pairs: Vec<Touch<D>>,
    pub images: Vec<SelfTouch>,
    /// What each contact remembers: pairs, then images.
    pub history: Vec<History<V>>,
    /// Its part of the energy ledger; empty where none is kept.
    pub account: Vec<Account<V>>,
    keeps_accounts: bool,
    /// Pairs weigh 1, or 1/2 where they lie in a mirror; images 1/2.
    pub weight: Vec<f64>,
    pub laws: L,
    /// Where radii differ.
    sizes: Option<Vec<Size<V>>>,
    /// Friction and rotation, in the plane only.
    pub friction: Option<Friction<V>>,
    /// For each sphere the number of pairs whose first sphere comes before it.
    first_pair: Vec<usize>,
}

/// Overlap over the sum of radii from which on a contact counts as closed. At 10⁻¹⁵ it carries some 10⁻¹⁶ N. Without it the
/// numerical fore-runner of a wave would cross a row per step, with denormal numbers in it, and nothing be left to skip.
pub(super) const CLOSED: f64 = 1e-15;

impl<'a, V: Lanes, const D: usize, L: Laws<V>> Contacts<'a, V, D, L> {
    /// Of packings with the same centres, one per lane. With `accounts` false no energy ledger is kept.
    pub fn new(
        samples: &'a [&'a Sample<D>],
        mirrors: &[Mirror],
        touching: Touching<D>,
        grains: &Grains<V, D>,
        laws: L,
        accounts: bool,
    ) -> Self {
        let Touching { pairs, images } = touching;
        let count = pairs.len() + images.len();
        let sizes = (!size::are_alike(samples)).then(Vec::new);
        let mut contacts = Self {
            samples,
            pairs,
            images,
            history: vec![History::new(); count],
            account: if accounts { vec![Account::new(); count] } else { Vec::new() },
            keeps_accounts: accounts,
            weight: Vec::new(),
            laws,
            sizes,
            friction: None,
            first_pair: Vec::new(),
        };
        contacts.describe(mirrors, grains);
        contacts
    }

    /// With friction (μ), followed by steps of one length (s).
    #[must_use]
    pub fn with_friction(mut self, coefficient: f64, grains: &Grains<V, D>, step: f64) -> Self {
        debug_assert_eq!(D, 2, "friction is written for the plane");
        let mut friction = Friction::new(self.samples, grains, coefficient, step);
        friction.renumber(self.samples, &self.pairs, |_| None, self.keeps_accounts);
        self.friction = Some(friction);
        self
    }

    /// Finds what follows from which contacts there are.
    fn describe(&mut self, mirrors: &[Mirror], grains: &Grains<V, D>) {
        // A pair in a mirror plane is shared by both halves: both of its spheres lie on the same plane.
        let in_plane = |touch: &Touch<D>| {
            let [a, b] = touch.pair;
            (0..D).any(|k| grains.mobility[a][k] == 0.0 && grains.mobility[b][k] == 0.0 && touch.offset[k] == 0.0)
        };
        let weight = self.pairs.iter().map(|touch| if in_plane(touch) { 0.5 } else { 1.0 });
        self.weight = weight.chain(self.images.iter().map(|_| 0.5)).collect();
        let spheres = grains.weight.len();
        self.first_pair = (0..=spheres).map(|i| self.pairs.partition_point(|touch| touch.pair[0] < i)).collect();
        if let Some(sizes) = &mut self.sizes {
            let samples = self.samples;
            let of_pair = |touch: &Touch<D>| {
                Size::new(samples, touch.pair, L::One::is_similar(), |one| gap_squared(one, touch.pair))
            };
            let of_image = |touch: &SelfTouch| {
                let mirror = mirrors.iter().find(|mirror| touch.is_in(mirror));
                let gap = |one: &Sample<D>| mirror.map_or(touch.gap, |mirror| image_gap(one, touch.sphere, mirror));
                Size::new(samples, [touch.sphere; 2], L::One::is_similar(), gap)
            };
            *sizes = self.pairs.iter().map(of_pair).chain(self.images.iter().map(of_image)).collect();
        }
    }

    /// Takes up contacts between spheres that have come near each other, and of spheres with their image in a mirror.
    pub fn take_up(
        &mut self,
        pairs: &[[usize; 2]],
        images: &[(usize, Mirror)],
        mirrors: &[Mirror],
        grains: &Grains<V, D>,
    ) -> Result<(), NoRoom> {
        let first = self.samples[0];
        let old = self.pairs.len();
        let mut all: Vec<_> = self.pairs.iter().copied().enumerate().map(|(c, touch)| (touch, Some(c))).collect();
        all.extend(pairs.iter().map(|&pair| (Touch::new(first, pair), None)));
        all.sort_by_key(|(touch, _)| touch.pair);
        let mut all_images: Vec<_> =
            self.images.iter().copied().enumerate().map(|(c, touch)| (touch, Some(old + c))).collect();
        all_images.extend(images.iter().map(|(sphere, mirror)| (SelfTouch::new(first, *sphere, mirror), None)));
        let place = |touch: &SelfTouch| mirrors.iter().position(|mirror| touch.is_in(mirror));
        all_images.sort_by_key(|(touch, _)| (touch.sphere, place(touch)));

        let from: Vec<Option<usize>> =
            all.iter().map(|(_, from)| *from).chain(all_images.iter().map(|(_, from)| *from)).collect();
        self.pairs = all.into_iter().map(|(touch, _)| touch).collect();
        self.images = all_images.into_iter().map(|(touch, _)| touch).collect();
        self.history = from.iter().map(|c| c.map_or_else(History::new, |c| self.history[c])).collect();
        if self.keeps_accounts {
            self.account = from.iter().map(|c| c.map_or_else(Account::new, |c| self.account[c])).collect();
        }
        self.describe(mirrors, grains);
        if let Some(friction) = &mut self.friction {
            friction.renumber(self.samples, &self.pairs, |c| from[c], self.keeps_accounts);
        }
        let ends: Vec<[usize; 2]> = (0..from.len()).map(|c| self.spheres(c)).collect();
        if self.laws.renumber(&from, &ends) { Ok(()) } else { Err(NoRoom) }
    }

    /// The force in a closed contact; its memories advance as `sweep` says.
    #[inline(always)]
    fn push(&mut self, contact: usize, overlap: V, closing_speed: V, sweep: Sweep) -> V {
        let (mut seen, mut speed) = (overlap, closing_speed);
        if let Some(sizes) = &self.sizes {
            (seen, speed) = (overlap * sizes[contact].overlap, closing_speed * sizes[contact].speed);
        }
        let mut force;
        if sweep == Sweep::Try {
            force = self.laws.force(contact, seen, speed, &self.history[contact]);
        } else {
            let history;
            (force, history) = self.laws.respond(contact, seen, speed, &self.history[contact]);
            self.history[contact] = history;
        }
        if let Some(sizes) = &self.sizes {
            force = force * sizes[contact].force;
        }
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
        if let Some(friction) = &mut self.friction {
            friction.begin();
        }
        let mut touched = *reached;
        for c in 0..self.first_pair[*reached] {
            let Touch { pair: [a, b], offset, gap, reach } = self.pairs[c];
            let (from, to) = (displacement[a], displacement[b]);
            let mut between = [zero; D];
            // S² − |Δ|² with Δ = offset + shift, without the cancellation of two nearly equal squares.
            let (mut gap, mut reach) = (V::splat(gap), V::splat(reach));
            if let Some(sizes) = &self.sizes {
                (gap, reach) = (sizes[c].gap, sizes[c].reach);
            }
            let mut excess = -gap;
            for k in 0..D {
                let shift = to[k] - from[k];
                excess = excess - shift * (V::splat(2.0 * offset[k]) + shift);
                between[k] = V::splat(offset[k]) + shift;
            }
            let closed = (V::splat(2.0 * CLOSED) * reach * reach).lt(excess);
            if !V::any(closed) {
                self.open(c, sweep);
                if let (Some(friction), true) = (&mut self.friction, sweep != Sweep::Try) {
                    friction.open(c);
                }
                continue;
            }
            let distance = square(&between).sqrt();
            // One quotient for both: overlap = (S² − |Δ|²)/(S + |Δ|), and 1/|Δ| for the normal.
            let sum = reach + distance;
            let quotient = V::splat(1.0) / (sum * distance);
            let overlap = V::select(closed, excess * (quotient * distance), zero);
            let inverse = quotient * sum;
            let (of_a, of_b) = (velocity[a], velocity[b]);
            let mut closing_speed = zero;
            for k in 0..D {
                between[k] = between[k] * inverse;
                closing_speed = closing_speed + (of_a[k] - of_b[k]) * between[k];
            }
            let push = self.push(c, overlap, closing_speed, sweep);
            let weight = V::splat(self.weight[c]);
            while touched <= b {
                force[touched] = [zero; D];
                touched += 1;
            }
            for k in 0..D {
                force[a][k] = force[a][k] - push * weight * between[k];
                force[b][k] = force[b][k] + push * weight * between[k];
            }
            if D == 2
                && let Some(friction) = &mut self.friction
            {
                let tangent = [-between[D - 1], between[0]];
                let across = (of_a[0] - of_b[0]) * tangent[0] + (of_a[D - 1] - of_b[D - 1]) * tangent[1];
                let drag =
                    friction.rub(c, [a, b], (overlap, closing_speed), (push, across), sweep != Sweep::Try) * weight;
                for (k, tangent) in [(0, tangent[0]), (D - 1, tangent[1])] {
                    force[a][k] = force[a][k] - drag * tangent;
                    force[b][k] = force[b][k] + drag * tangent;
                }
            }
        }
        for k in 0..self.images.len() {
            let (contact, SelfTouch { sphere, axis, inward, gap, reach }) = (self.pairs.len() + k, self.images[k]);
            if sphere >= *reached {
                break;
            }
            let inward = V::splat(inward);
            let (mut gap, mut reach) = (V::splat(gap), V::splat(reach));
            if let Some(sizes) = &self.sizes {
                (gap, reach) = (sizes[contact].gap, sizes[contact].reach);
            }
            let overlap = -(two * inward * displacement[sphere][axis] + gap);
            let closed = (V::splat(CLOSED) * reach).lt(overlap);
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

    /// The second spheres of the pairs whose first is sphere `i`, in order.
    pub fn partners(&self, i: usize) -> impl Iterator<Item = usize> + '_ {
        self.pairs[self.first_pair[i]..self.first_pair[i + 1]].iter().map(|touch| touch.pair[1])
    }

    /// Whether a sphere's image in a mirror is one of the contacts.
    pub fn holds_image(&self, sphere: usize, mirror: &Mirror) -> bool {
        let from = self.images.partition_point(|touch| touch.sphere < sphere);
        self.images[from..].iter().take_while(|touch| touch.sphere == sphere).any(|touch| touch.is_in(mirror))
    }

    /// Radii sum by which an overlap of this contact is judged in one of the designs (m).
    pub fn reach(&self, contact: usize, lane: usize) -> f64 {
        match (&self.sizes, self.pairs.get(contact)) {
            (Some(sizes), _) => sizes[contact].reach.lane(lane),
            (None, Some(touch)) => touch.reach,
            (None, None) => self.images[contact - self.pairs.len()].reach,
        }
    }

    /// ρ, by which lengths of this contact's memory are multiplied in one of the designs.
    fn ratio(&self, contact: usize, lane: usize) -> f64 {
        self.sizes.as_ref().map_or(1.0, |sizes| 1.0 / sizes[contact].overlap.lane(lane))
    }

    /// The greatest overlap (m) and force (N) so far in one of the designs.
    pub fn greatest(&self, contact: usize, lane: usize) -> (f64, f64) {
        let (ratio, history) = (self.ratio(contact, lane), &self.history[contact]);
        (ratio * history.overlap_max.lane(lane), ratio * ratio * history.force_max.lane(lane))
    }

    /// The greatest stiffness (N/m) that a contact can show in one of the designs after what it has carried. K goes as ρ.
    pub fn stiffness(&self, contact: usize, lane: usize) -> f64 {
        let law = self.laws.one(contact, lane);
        self.ratio(contact, lane) * law.stiffness_max(self.history[contact].force_max.lane(lane))
    }

    /// The spheres of a contact; an image's sphere twice.
    pub fn spheres(&self, contact: usize) -> [usize; 2] {
        match self.pairs.get(contact) {
            Some(touch) => touch.pair,
            None => [self.images[contact - self.pairs.len()].sphere; 2],
        }
    }
}

impl<const D: usize, L: Laws<f64>> Contacts<'_, f64, D, L> {
    /// Energy (J) that a contact would give back. Energies go as ρ³.
    pub fn stored(&self, contact: usize) -> f64 {
        let ratio = self.ratio(contact, 0);
        let law = self.laws.one(contact, 0);
        ratio.powi(3) * law.stored(self.account[contact].overlap / ratio, &self.history[contact])
    }
}
