//! All contacts of a packing: geometry at rest, law, history and energy, as parallel arrays; and the force sweep.

use super::body::{Grains, square};
use super::boundary::{Mirror, Surface};
use super::friction::Friction;
use super::list::List;
use super::neighbour::{SelfTouch, Touch, Touching, image_gap};
use super::plate::Plate;
use super::size::{self, Size, gap_squared};
use crate::contact::{AnyLaw, History, NormalLaw};
use crate::real::{Job, Lanes};
use crate::sample::Sample;

/// The law of every contact, as it is asked in a sweep; images follow the pairs.
pub(super) trait Respond<V: Lanes> {
    /// The force of a contact in this state.
    fn force(&self, contact: usize, overlap: V, closing_speed: V, history: &History<V>) -> V;
    /// The force, and the history after an accepted step.
    fn respond(&self, contact: usize, overlap: V, closing_speed: V, history: &History<V>) -> (V, History<V>);
}

/// The law of every contact, whatever its type: what is compiled anew for each is the sweep alone.
pub(super) trait Laws<V: Lanes, const D: usize> {
    /// Does a sweep.
    fn sweep(&self, pass: Pass<'_, '_, V, D>);
    /// The law of a contact in one of the designs.
    fn one(&self, contact: usize, lane: usize) -> &AnyLaw;
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

/// Contacts as parallel arrays: row c of each is contact c.
pub(super) struct Contacts<'a, V, const D: usize> {
    samples: &'a [&'a Sample<D>],
    pub list: List<D>,
    /// What each contact remembers.
    pub history: Vec<History<V>>,
    /// Its part of the energy ledger; empty where none is kept.
    pub account: Vec<Account<V>>,
    keeps_accounts: bool,
    /// Whether contacts of unequal size are images of each other; see [`size`](super::size).
    are_similar: bool,
    /// Where radii differ.
    sizes: Option<Vec<Size<V>>>,
    /// Friction and rotation, in the plane only.
    pub friction: Option<Friction<V>>,
    /// What strikes the first layer, where it is a flat: the mirror that moves.
    pub plate: Option<Plate<V>>,
}

/// Overlap over the sum of radii from which on a contact counts as closed. At 10⁻¹⁵ it carries some 10⁻¹⁶ N. Without it the
/// numerical fore-runner of a wave would cross a row per step, with denormal numbers in it, and nothing be left to skip.
pub(super) const CLOSED: f64 = 1e-15;
/// The same in single precision, in which speeds are squared that follow from it.
const CLOSED_IN_SINGLE: f64 = 1e-9;

const fn closed<V: Lanes>() -> f64 {
    if V::IS_SINGLE { CLOSED_IN_SINGLE } else { CLOSED }
}

impl<'a, V: Lanes, const D: usize> Contacts<'a, V, D> {
    /// Of packings with the same centres, one per lane. With `accounts` false no energy ledger is kept.
    pub fn new(
        samples: &'a [&'a Sample<D>],
        touching: Touching<D>,
        grains: &Grains<V, D>,
        are_similar: bool,
        accounts: bool,
    ) -> Self {
        let list = List::new(touching, &grains.carried);
        let count = list.len();
        let mut contacts = Self {
            samples,
            list,
            history: vec![History::new(); count],
            account: if accounts { vec![Account::new(); count] } else { Vec::new() },
            keeps_accounts: accounts,
            are_similar,
            sizes: (!size::are_alike(samples)).then(Vec::new),
            friction: None,
            plate: None,
        };
        contacts.measure();
        contacts
    }

    /// With friction (μ), followed by steps of one length (s).
    pub fn rub(&mut self, coefficient: f64, grains: &Grains<V, D>, step: f64) {
        debug_assert_eq!(D, 2, "friction is written for the plane");
        let mut friction = Friction::new(self.samples, grains, coefficient, step);
        friction.renumber(self.samples, &self.list.pairs, &[], self.keeps_accounts);
        self.friction = Some(friction);
    }

    /// Finds the sizes of the contacts, where radii differ.
    fn measure(&mut self) {
        let Some(sizes) = &mut self.sizes else { return };
        sizes.clear();
        for touch in &self.list.pairs {
            let gap = |one: &Sample<D>| gap_squared(one, touch.pair, &touch.offset);
            sizes.push(Size::new(self.samples, touch.pair, self.are_similar, &gap));
        }
        for touch in &self.list.images {
            let gap = |one: &Sample<D>| image_gap(one, touch.sphere, &touch.surface);
            sizes.push(Size::new(self.samples, [touch.sphere; 2], self.are_similar, &gap));
        }
    }

    /// Takes up contacts between spheres that have come near each other, and of spheres with their image in a surface.
    pub fn restore(
        &mut self,
        pairs: &[[usize; 2]],
        images: &[(usize, Surface)],
        surfaces: &[Surface],
        grains: &Grains<V, D>,
        laws: &mut dyn Laws<V, D>,
    ) -> Result<(), NoRoom> {
        let from = self.list.restore(self.samples[0], pairs, images, surfaces, &grains.carried);
        self.history = from.iter().map(|c| c.map_or_else(History::new, |c| self.history[c])).collect();
        if self.keeps_accounts {
            self.account = from.iter().map(|c| c.map_or_else(Account::new, |c| self.account[c])).collect();
        }
        self.measure();
        if let Some(friction) = &mut self.friction {
            friction.renumber(self.samples, &self.list.pairs, &from, self.keeps_accounts);
        }
        if laws.renumber(&from, &self.list.ends()) { Ok(()) } else { Err(NoRoom) }
    }

    /// The force in a closed contact; its memories advance as `sweep` says.
    #[inline(always)]
    fn push<const PLAIN: bool>(
        &mut self,
        laws: &impl Respond<V>,
        contact: usize,
        overlap: V,
        closing_speed: V,
        sweep: Sweep,
    ) -> V {
        let (mut seen, mut speed) = (overlap, closing_speed);
        if PLAIN {
            let (force, history) = laws.respond(contact, seen, speed, &self.history[contact]);
            self.history[contact] = history;
            return force;
        }
        if let Some(sizes) = &self.sizes {
            (seen, speed) = (overlap * sizes[contact].overlap, closing_speed * sizes[contact].speed);
        }
        let mut force;
        if sweep == Sweep::Try {
            force = laws.force(contact, seen, speed, &self.history[contact]);
        } else {
            let history;
            (force, history) = laws.respond(contact, seen, speed, &self.history[contact]);
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

    /// See [`Pass`]. `PLAIN`: memories advance, no account is kept, spheres are equal and there is no friction.
    #[inline(always)]
    fn sweep<const PLAIN: bool>(
        &mut self,
        laws: &impl Respond<V>,
        (displacement, velocity): (&[[V; D]], &[[V; D]]),
        force: &mut [[V; D]],
        reached: &mut usize,
        sweep: Sweep,
    ) {
        let zero = V::splat(0.0);
        let two = V::splat(2.0);
        for sum in &mut force[..*reached] {
            *sum = [zero; D];
        }
        if !PLAIN && let Some(friction) = &mut self.friction {
            friction.begin();
        }
        if let Some(plate) = &mut self.plate {
            plate.force = zero;
        }
        let mut touched = *reached;
        for c in 0..self.list.first_pair[*reached] {
            let Touch { pair: [a, b], offset, gap, reach } = self.list.pairs[c];
            let (from, to) = (displacement[a], displacement[b]);
            let mut between = [zero; D];
            // S² − |Δ|² with Δ = offset + shift, without the cancellation of two nearly equal squares.
            let (mut gap, mut least) = (V::splat(gap), V::splat(2.0 * closed::<V>() * reach * reach));
            let mut reach = V::splat(reach);
            if !PLAIN && let Some(sizes) = &self.sizes {
                (gap, reach) = (sizes[c].gap, sizes[c].reach);
                least = V::splat(2.0 * closed::<V>()) * reach * reach;
            }
            let mut excess = -gap;
            for k in 0..D {
                let shift = to[k] - from[k];
                excess = excess - shift * (V::splat(2.0 * offset[k]) + shift);
                between[k] = V::splat(offset[k]) + shift;
            }
            let closed = least.lt(excess);
            if !V::any(closed) {
                if PLAIN {
                    continue;
                }
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
            let push = self.push::<PLAIN>(laws, c, overlap, closing_speed, sweep);
            let weight = V::splat(self.list.weight[c]);
            while touched <= b {
                force[touched] = [zero; D];
                touched += 1;
            }
            for k in 0..D {
                force[a][k] = force[a][k] - push * weight * between[k];
                force[b][k] = force[b][k] + push * weight * between[k];
            }
            if !PLAIN
                && D == 2
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
        for k in 0..self.list.images.len() {
            let (contact, touch) = (self.list.pairs.len() + k, self.list.images[k]);
            let SelfTouch { sphere, surface, gap, reach, .. } = touch;
            if sphere >= *reached {
                break;
            }
            let (mut gap, mut reach) = (V::splat(gap), V::splat(reach));
            if !PLAIN && let Some(sizes) = &self.sizes {
                (gap, reach) = (sizes[contact].gap, sizes[contact].reach);
            }
            // Faces across no axis are in space only: the plane knows nothing of them.
            let mut turned = None;
            let (axis, inward, mut moved, mut speed) = match surface {
                Surface::Face(face) if const { D == 3 } => {
                    let (normal, moved) = face.approach(&touch.centre, &displacement[sphere]);
                    let mut speed = zero;
                    for k in 0..D {
                        speed = speed + velocity[sphere][k] * normal[k];
                    }
                    turned = Some(normal);
                    (0, V::splat(1.0), moved, speed)
                }
                Surface::Face(_) => continue,
                Surface::Mirror(Mirror { axis, inward, .. }) => {
                    (axis, V::splat(inward), displacement[sphere][axis], velocity[sphere][axis])
                }
            };
            let plate = match &self.plate {
                Some(plate) if surface == Surface::Mirror(plate.mirror) => Some(plate.seen),
                _ => None,
            };
            if let Some([way, velocity]) = plate {
                (moved, speed) = (moved - way, speed - velocity);
            }
            let overlap = -(two * inward * moved + gap);
            let closed = (V::splat(closed::<V>()) * reach).lt(overlap);
            if !V::any(closed) {
                if !PLAIN {
                    self.open(contact, sweep);
                }
                continue;
            }
            let overlap = V::select(closed, overlap, zero);
            let closing_speed = -(two * inward * speed);
            let push = self.push::<PLAIN>(laws, contact, overlap, closing_speed, sweep);
            // On the simulated part of the sphere.
            let push = inward * (push * V::splat(2.0 * self.list.weight[contact]));
            if let Some(normal) = turned {
                for k in 0..D {
                    force[sphere][k] = force[sphere][k] + push * normal[k];
                }
                continue;
            }
            force[sphere][axis] = force[sphere][axis] + push;
            if plate.is_some()
                && let Some(plate) = &mut self.plate
            {
                plate.force = plate.force - push;
            }
        }
        *reached = touched;
    }

    /// Radii sum by which an overlap of this contact is judged in one of the designs (m).
    pub fn radii_sum(&self, contact: usize, lane: usize) -> f64 {
        match (&self.sizes, self.list.pairs.get(contact)) {
            (Some(sizes), _) => sizes[contact].reach.lane(lane),
            (None, Some(touch)) => touch.reach,
            (None, None) => self.list.images[contact - self.list.pairs.len()].reach,
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
    pub fn stiffness(&self, laws: &dyn Laws<V, D>, contact: usize, lane: usize) -> f64 {
        let law = laws.one(contact, lane);
        self.ratio(contact, lane) * law.stiffness_max(self.history[contact].force_max.lane(lane))
    }
}

impl<const D: usize> Contacts<'_, f64, D> {
    /// Energy (J) that a contact would give back. Energies go as ρ³.
    pub fn stored(&self, laws: &dyn Laws<f64, D>, contact: usize) -> f64 {
        let ratio = self.ratio(contact, 0);
        let law = laws.one(contact, 0);
        ratio.powi(3) * law.stored(self.account[contact].overlap / ratio, &self.history[contact])
    }
}

/// Adds up the contact forces on the simulated part of every sphere, at the given displacements and velocities, for all spheres that the
/// wave has reached; extends `reached` to those it reaches now.
pub(super) struct Pass<'a, 's, V, const D: usize> {
    pub contacts: &'a mut Contacts<'s, V, D>,
    pub displacement: &'a [[V; D]],
    pub velocity: &'a [[V; D]],
    pub force: &'a mut [[V; D]],
    pub reached: &'a mut usize,
    pub sweep: Sweep,
}

impl<V: Lanes, const D: usize> Pass<'_, '_, V, D> {
    /// Does it under laws of one type, in a function of its own.
    pub fn under(self, laws: &impl Respond<V>) {
        V::outlined(Under::<V, D, _, false> { pass: self, laws });
    }

    /// As [`under`](Self::under), where it pays with a function for crystals as most are: designs side by side in the plane, of equal spheres
    /// without friction. In single precision there are no others.
    pub fn quickly_under(self, laws: &impl Respond<V>) {
        if const { V::LANES > 1 && D == 2 } {
            let Contacts { sizes, friction, .. } = &*self.contacts;
            if V::IS_SINGLE || (sizes.is_none() && friction.is_none()) {
                debug_assert!(self.sweep == Sweep::Accept, "a batch keeps no account");
                return V::outlined(Under::<V, D, _, true> { pass: self, laws });
            }
        }
        if const { !V::IS_SINGLE } {
            self.under(laws);
        }
    }
}

struct Under<'a, 's, 'l, V, const D: usize, L, const PLAIN: bool> {
    pass: Pass<'a, 's, V, D>,
    laws: &'l L,
}

impl<V: Lanes, const D: usize, L: Respond<V>, const PLAIN: bool> Job for Under<'_, '_, '_, V, D, L, PLAIN> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Pass { contacts, displacement, velocity, force, reached, sweep } = self.pass;
        contacts.sweep::<PLAIN>(self.laws, (displacement, velocity), force, reached, sweep);
    }
}
