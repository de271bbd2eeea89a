//! All candidate contacts, as parallel arrays, and the force sweep over them.
//!
//! Pairs of spheres come first, then contacts with faces: flats, and mirrors, in which a sphere meets its own image. What one
//! contact does is worked out in one place (`react`) and added up in order of the contacts, either at once or, on several
//! threads, by first storing the reactions and then adding up sphere by sphere: the same sums in the same order.

use std::collections::{BTreeMap, HashMap};

use rayon::prelude::*;

use super::bodies::{Bodies, axes_of_spin, cross, dot, spin_cross};
use super::flat::Face;
use super::law::{Binder, Bond, Bonding, End, Slip, reduced_mass};
use super::pairs::{Finder, Near, TOUCHING};
use super::{Body, Rig};
use crate::sample::Sphere;

/// What a face contact is made with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Facing {
    Flat(u32),
    Mirror(u32),
}

/// A sphere near a face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct NearFace {
    pub sphere: u32,
    pub facing: Facing,
    /// Distance of the surfaces at the start (m), exactly zero where they just touched. For unbounded faces.
    pub gap: f64,
    pub radius: f64,
    /// The part of the contact's force that belongs to the simulated part of a symmetric rig.
    pub share: f64,
}

/// What a contact remembers besides its normal law's memory.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Account {
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
    fn open(&mut self, step: f64) {
        self.accept(0.0, 0.0);
        self.slid += 0.5 * step * self.power;
        (self.power, self.wound) = (0.0, 0.0);
    }
}

/// A contact's memories that outlive its being near.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Kept<M> {
    pub memory: M,
    pub work: f64,
    pub slid: f64,
    /// Parts of both works that are simulated.
    pub weight: f64,
    pub share: f64,
}

impl<M> Kept<M> {
    /// What the contact has lost (J); open, it holds nothing.
    pub fn loss(&self) -> f64 {
        self.weight * self.work + self.share * self.slid
    }
}

/// The velocities at which forces are asked for, and the step that follows.
#[derive(Clone, Copy)]
pub(super) struct Trial<'a, const D: usize> {
    pub velocity: &'a [[f64; D]],
    pub spin: &'a [[f64; 3]],
    pub flat_velocity: &'a [[f64; D]],
    /// (s)
    pub step: f64,
}

/// What a closed contact does: the force on its second end, and the couple per lever arm on both.
#[derive(Clone, Copy, Debug)]
struct Reaction<const D: usize> {
    force: [f64; D],
    twist: [f64; 3],
}

/// The state of two ends that overlap.
struct Meeting<const D: usize> {
    overlap: f64,
    closing_speed: f64,
    /// From the first end to the second.
    normal: [f64; D],
    /// Velocity of the first end's surface relative to the second's, in the tangent plane.
    sliding: [f64; D],
}

/// What the guards ask of a contact.
#[derive(Clone, Copy, Debug)]
pub(super) struct Strain {
    pub bodies: [Body; 2],
    /// Greatest overlap so far over what it is judged by.
    pub ratio: f64,
    /// Overlap over the range of its law.
    pub range_used: f64,
    /// Greatest stiffness that it can show (N/m).
    pub stiffness: f64,
}

/// Key of a pair, and of a face contact.
pub(super) type PairKey<const D: usize> = ([u32; 2], [i8; D]);
pub(super) type FaceKey = (u32, Facing);

/// Contacts as parallel arrays: row c of each is contact c, pairs first, then faces.
pub(super) struct Contacts<const D: usize, L: Bonding> {
    pub near: Vec<Near<D>>,
    pub faces: Vec<NearFace>,
    /// Part of a pair that belongs to the simulated part of a symmetric rig; empty where all is simulated.
    share: Vec<f64>,
    /// Place of a contact's law in `bonds`.
    bond: Vec<u32>,
    /// Reduced mass m̄ (kg).
    reduced: Vec<f64>,
    bonds: Vec<Bond<L>>,
    known_bonds: HashMap<[u32; 2], u32>,
    pub memory: Vec<L::Memory>,
    /// ξ, the tangential spring (m); empty without friction.
    pub stretch: Vec<[f64; D]>,
    pub account: Vec<Account>,
    /// Memories of contacts that are no longer near.
    pub kept_pairs: BTreeMap<PairKey<D>, Kept<L::Memory>>,
    pub kept_faces: BTreeMap<FaceKey, Kept<L::Memory>>,
    /// What contacts without memory lost before they were dropped: normal and tangential (J), and by sphere.
    pub lost: [f64; 2],
    pub lost_by_sphere: Vec<f64>,
    /// What contacts had borne when they were dropped, for the guards' next look.
    pub dropped: Vec<Strain>,
    /// Overlap and closing speed of a face contact over those of sphere and face: 2 where a face stands for an equal sphere.
    face_factor: f64,
    /// Kinds of spheres: those of one kind have the same laws.
    class: Vec<u32>,
    ends: Vec<End>,
    turning: bool,
    /// For sums on several threads: the contacts of each sphere, in order, and which end it is.
    by_sphere: Vec<(u32, bool)>,
    first_of: Vec<u32>,
    reactions: Vec<Option<Reaction<D>>>,
}

/// Overlap over the radii's sum from which on a contact counts as closed; see `dem::contacts`.
const CLOSED: f64 = 1e-15;

/// The same for bounded faces, whose distance is that of absolute positions.
const CLOSED_EDGE: f64 = 1e-11;

/// From so many contacts on a sweep is worth sharing among threads.
const MANY: usize = 20_000;

impl<const D: usize, L: Bonding> Contacts<D, L> {
    /// No contact yet. `face_factor` is 2 where a face stands for an equal sphere (Burgoyne 2016, appendix A.1), 1 where
    /// it is met as it is.
    pub fn new(rig: &Rig<D>, bodies: &Bodies<D>, face_factor: f64) -> Self {
        let count = rig.sample.spheres.len();
        let clustered = rig.clustered();
        let ends: Vec<End> = (0..count)
            .map(|i| {
                let sphere = &rig.sample.spheres[i];
                let fixed = rig.held[i].iter().all(|&held| held);
                End {
                    material: sphere.material,
                    radius: sphere.radius,
                    mass: match clustered[i] {
                        Some(cluster) => rig.clusters[cluster as usize].mass,
                        None if fixed => f64::INFINITY,
                        None => rig.mass[i],
                    },
                }
            })
            .collect();
        let mut kinds: HashMap<(usize, u64), u32> = HashMap::new();
        let class = ends
            .iter()
            .map(|end| {
                let next = kinds.len() as u32;
                *kinds.entry((end.material, end.radius.to_bits())).or_insert(next)
            })
            .collect();
        debug_assert_eq!(bodies.weight.len(), count);
        Self {
            near: Vec::new(),
            faces: Vec::new(),
            share: Vec::new(),
            bond: Vec::new(),
            reduced: Vec::new(),
            bonds: Vec::new(),
            known_bonds: HashMap::new(),
            memory: Vec::new(),
            stretch: Vec::new(),
            account: Vec::new(),
            kept_pairs: BTreeMap::new(),
            kept_faces: BTreeMap::new(),
            lost: [0.0; 2],
            lost_by_sphere: vec![0.0; count],
            dropped: Vec::new(),
            face_factor,
            class,
            ends,
            turning: rig.laws.has_friction(),
            by_sphere: Vec::new(),
            first_of: Vec::new(),
            reactions: Vec::new(),
        }
    }

    /// Looks anew who is near whom; memories go with their contact.
    pub fn renew(&mut self, rig: &Rig<D>, finder: &Finder<D>, bodies: &Bodies<D>, binder: &impl Binder<L>) {
        let near = finder.find(rig, &bodies.displacement);
        let faces = near_faces(rig, finder, bodies);
        self.replace(rig, near, faces, bodies, binder);
    }

    /// Puts another list in the place of the present one; memories go with their contact.
    pub fn replace(
        &mut self,
        rig: &Rig<D>,
        near: Vec<Near<D>>,
        faces: Vec<NearFace>,
        bodies: &Bodies<D>,
        binder: &impl Binder<L>,
    ) {
        let old_pairs = self.near.len();
        let mut memory = Vec::with_capacity(near.len() + faces.len());
        let mut account = Vec::with_capacity(near.len() + faces.len());
        let mut stretch = Vec::with_capacity(if self.turning { near.len() + faces.len() } else { 0 });
        let turning = self.turning;
        let mut take = |from: Option<usize>, kept: Option<Kept<L::Memory>>, old: &Self| {
            match (from, kept) {
                (Some(c), _) => {
                    memory.push(old.memory[c]);
                    account.push(old.account[c]);
                    if turning {
                        stretch.push(old.stretch[c]);
                    }
                }
                (None, kept) => {
                    memory.push(kept.map_or_else(L::Memory::default, |kept| kept.memory));
                    account.push(kept.map_or_else(Account::default, |kept| Account {
                        work: kept.work,
                        slid: kept.slid,
                        ..Account::default()
                    }));
                    if turning {
                        stretch.push([0.0; D]);
                    }
                }
            };
        };
        // Both lists are in order of their keys: one walk through both.
        let mut c = 0;
        let mut dropped = Vec::new();
        for pair in &near {
            while c < old_pairs && self.near[c].key() < pair.key() {
                dropped.push(c);
                c += 1;
            }
            if c < old_pairs && self.near[c].key() == pair.key() {
                take(Some(c), None, self);
                c += 1;
            } else {
                let kept = if self.kept_pairs.is_empty() { None } else { self.kept_pairs.remove(&pair.key()) };
                take(None, kept, self);
            }
        }
        dropped.extend(c..old_pairs);
        let mut f = 0;
        let key = |face: &NearFace| (face.sphere, face.facing);
        for face in &faces {
            while f < self.faces.len() && key(&self.faces[f]) < key(face) {
                dropped.push(old_pairs + f);
                f += 1;
            }
            if f < self.faces.len() && key(&self.faces[f]) == key(face) {
                take(Some(old_pairs + f), None, self);
                f += 1;
            } else {
                let kept = self.kept_faces.remove(&key(face));
                take(None, kept, self);
            }
        }
        dropped.extend((f..self.faces.len()).map(|f| old_pairs + f));
        for c in dropped {
            self.drop_contact(c, bodies);
        }
        self.near = near;
        self.faces = faces;
        (self.memory, self.account, self.stretch) = (memory, account, stretch);
        self.bind(rig, binder);
        self.share = match rig.mirrors.is_empty() {
            true => Vec::new(),
            false => self.near.iter().map(|pair| share_in_mirrors(rig, pair)).collect(),
        };
        self.index();
    }

    /// Keeps what a contact remembers that is no longer near.
    fn drop_contact(&mut self, c: usize, bodies: &Bodies<D>) {
        let Account { work, slid, .. } = self.account[c];
        let memory = self.memory[c];
        if memory == L::Memory::default() && work == 0.0 && slid == 0.0 {
            return;
        }
        self.dropped.extend(self.strain(c));
        if L::NUMBERS == 0 {
            self.lost[0] += self.weight(c) * work;
            self.lost[1] += self.share(c) * slid;
            for (sphere, part) in self.spheres(c) {
                let energy = part * (self.weight(c) * work + self.share(c) * slid);
                self.lost_by_sphere[sphere] += energy / bodies.weight[sphere];
            }
            return;
        }
        let kept = Kept { memory, work, slid, weight: self.weight(c), share: self.share(c) };
        match self.near.get(c) {
            Some(pair) => {
                self.kept_pairs.insert(pair.key(), kept);
            }
            None => {
                let face = &self.faces[c - self.near.len()];
                self.kept_faces.insert((face.sphere, face.facing), kept);
            }
        }
    }

    fn bind<B: Binder<L>>(&mut self, rig: &Rig<D>, binder: &B) {
        self.bond.clear();
        self.reduced.clear();
        let class = |i: u32| if B::BY_SIZE { self.class[i as usize] } else { self.ends[i as usize].material as u32 };
        for c in 0..self.near.len() + self.faces.len() {
            let (key, ends) = match self.near.get(c) {
                Some(pair) => (pair.ends.map(class), pair.ends.map(|i| self.ends[i as usize])),
                None => {
                    let face = &self.faces[c - self.near.len()];
                    let end = self.ends[face.sphere as usize];
                    let mass = match face.facing {
                        Facing::Flat(f) => rig.flats[f as usize].mass,
                        Facing::Mirror(_) => end.mass,
                    };
                    // A face counts as a sphere like the one that it meets.
                    ([class(face.sphere); 2], [end, End { mass, ..end }])
                }
            };
            self.reduced.push(reduced_mass(ends));
            let next = self.bonds.len() as u32;
            let place = *self.known_bonds.entry(key).or_insert(next);
            if place == next {
                self.bonds.push(binder.bond(ends));
            }
            self.bond.push(place);
        }
    }

    /// Which contacts each sphere has, for sums on several threads.
    fn index(&mut self) {
        self.by_sphere.clear();
        self.first_of.clear();
        self.reactions.clear();
        if self.near.len() < MANY {
            return;
        }
        self.first_of.resize(self.class.len() + 1, 0);
        for pair in &self.near {
            for end in pair.ends {
                self.first_of[end as usize + 1] += 1;
            }
        }
        for i in 0..self.class.len() {
            self.first_of[i + 1] += self.first_of[i];
        }
        let mut next = self.first_of.clone();
        self.by_sphere.resize(2 * self.near.len(), (0, false));
        for (c, pair) in self.near.iter().enumerate() {
            for (side, end) in pair.ends.into_iter().enumerate() {
                self.by_sphere[next[end as usize] as usize] = (c as u32, side == 1);
                next[end as usize] += 1;
            }
        }
        self.reactions.resize(self.near.len(), None);
    }

    /// Number of contacts, open ones included.
    pub fn len(&self) -> usize {
        self.near.len() + self.faces.len()
    }

    /// The law of a contact.
    pub fn normal_law(&self, c: usize) -> &L {
        &self.bonds[self.bond[c] as usize].normal
    }

    /// The part of a contact's force that is simulated.
    pub fn share(&self, c: usize) -> f64 {
        match c.checked_sub(self.near.len()) {
            Some(f) => self.faces[f].share,
            None if self.share.is_empty() => 1.0,
            None => self.share[c],
        }
    }

    /// The part of ∫F dδ that is simulated.
    pub fn weight(&self, c: usize) -> f64 {
        match c.checked_sub(self.near.len()) {
            Some(f) => match self.faces[f].facing {
                Facing::Flat(_) => self.faces[f].share / self.face_factor,
                Facing::Mirror(_) => 0.5,
            },
            None => self.share(c),
        }
    }

    /// What a contact that carries or has carried force has borne.
    pub fn strain(&self, c: usize) -> Option<Strain> {
        let account = &self.account[c];
        let [overlap, force] = L::greatest(&self.memory[c]).unwrap_or([account.overlap, account.force]);
        let law = self.normal_law(c);
        (overlap > 0.0).then(|| Strain {
            bodies: self.bodies(c),
            ratio: overlap / self.reach(c),
            range_used: overlap / law.range(),
            stiffness: law.stiffness_max(force),
        })
    }

    /// By what an overlap is judged (m): the sum of radii, a sphere's diameter at a face.
    pub fn reach(&self, c: usize) -> f64 {
        match c.checked_sub(self.near.len()) {
            Some(f) => 2.0 * self.faces[f].radius,
            None => self.near[c].reach,
        }
    }

    /// The bodies of a contact; a sphere twice where it meets its own image.
    pub fn bodies(&self, c: usize) -> [Body; 2] {
        match c.checked_sub(self.near.len()) {
            Some(f) => {
                let sphere = Body::Sphere(self.faces[f].sphere as usize);
                match self.faces[f].facing {
                    Facing::Flat(flat) => [Body::Flat(flat as usize), sphere],
                    Facing::Mirror(_) => [sphere, sphere],
                }
            }
            None => self.near[c].ends.map(|i| Body::Sphere(i as usize)),
        }
    }

    /// The spheres of a contact, each with its part of what the contact loses: half, or all at a flat.
    pub fn spheres(&self, c: usize) -> impl Iterator<Item = (usize, f64)> + use<D, L> {
        let of = match c.checked_sub(self.near.len()) {
            Some(f) => [Some((self.faces[f].sphere as usize, 1.0)), None],
            None => self.near[c].ends.map(|i| Some((i as usize, 0.5))),
        };
        of.into_iter().flatten()
    }

    /// Adds up the forces on all spheres and flats at the given velocities and spins; memories advance by one step.
    pub fn sweep(&mut self, rig: &Rig<D>, bodies: &Bodies<D>, trial: Trial<D>, sums: &mut Sums<D>) {
        if self.turning {
            self.sweep_pairs::<true>(bodies, trial, sums);
            self.sweep_faces::<true>(rig, bodies, trial, sums);
        } else {
            self.sweep_pairs::<false>(bodies, trial, sums);
            self.sweep_faces::<false>(rig, bodies, trial, sums);
        }
    }

    fn sweep_pairs<const TURNING: bool>(&mut self, bodies: &Bodies<D>, trial: Trial<D>, sums: &mut Sums<D>) {
        let Self { near, share, bond, reduced, bonds, memory, stretch, account, ends, .. } = self;
        let displacement = &bodies.displacement;
        let mut spare = [0.0; D];
        if self.first_of.is_empty() || rayon::current_num_threads() == 1 {
            sums.clear::<TURNING>();
            for c in 0..near.len() {
                let share = if share.is_empty() { 1.0 } else { share[c] };
                let stretch = if TURNING { &mut stretch[c] } else { &mut spare };
                let bond = (&bonds[bond[c] as usize], reduced[c]);
                let reaction = react_pair::<D, L, TURNING>(
                    &near[c],
                    displacement,
                    trial,
                    ends,
                    bond,
                    &mut memory[c],
                    stretch,
                    &mut account[c],
                    share,
                );
                let Some(Reaction { force, twist }) = reaction else { continue };
                let [a, b] = near[c].ends.map(|i| i as usize);
                for k in 0..D {
                    sums.force[a][k] -= force[k];
                    sums.force[b][k] += force[k];
                }
                if TURNING {
                    for k in axes_of_spin::<D>() {
                        sums.torque[a][k] += ends[a].radius * twist[k];
                        sums.torque[b][k] += ends[b].radius * twist[k];
                    }
                }
            }
            return;
        }
        // Each contact on its own, in any order; then each sphere's sum over its contacts, in their order.
        const GRAIN: usize = 2048;
        let near: &[Near<D>] = near;
        let (share, bond, reduced): (&[f64], &[u32], &[f64]) = (share, bond, reduced);
        let (bonds, ends): (&[Bond<L>], &[End]) = (bonds, ends);
        let rows = self
            .reactions
            .par_chunks_mut(GRAIN)
            .zip(memory[..near.len()].par_chunks_mut(GRAIN))
            .zip(account[..near.len()].par_chunks_mut(GRAIN))
            .enumerate();
        let work = |chunk: usize,
                    reactions: &mut [Option<Reaction<D>>],
                    memory: &mut [L::Memory],
                    account: &mut [Account],
                    mut stretch: Option<&mut [[f64; D]]>| {
            let mut spare = [0.0; D];
            for n in 0..reactions.len() {
                let c = chunk * GRAIN + n;
                let share = if share.is_empty() { 1.0 } else { share[c] };
                let stretch = stretch.as_mut().map_or(&mut spare, |stretch| &mut stretch[n]);
                let bond = (&bonds[bond[c] as usize], reduced[c]);
                reactions[n] = react_pair::<D, L, TURNING>(
                    &near[c],
                    displacement,
                    trial,
                    ends,
                    bond,
                    &mut memory[n],
                    stretch,
                    &mut account[n],
                    share,
                );
            }
        };
        if TURNING {
            rows.zip(stretch[..near.len()].par_chunks_mut(GRAIN)).for_each(
                |((chunk, ((reactions, memory), account)), stretch)| {
                    work(chunk, reactions, memory, account, Some(stretch));
                },
            );
        } else {
            rows.for_each(|(chunk, ((reactions, memory), account))| work(chunk, reactions, memory, account, None));
        }
        let (by_sphere, first_of, reactions) = (&self.by_sphere, &self.first_of, &self.reactions);
        sums.force.par_iter_mut().zip(sums.torque.par_iter_mut()).enumerate().with_min_len(1024).for_each(
            |(i, (force, torque))| {
                *force = [0.0; D];
                *torque = [0.0; 3];
                for &(c, second) in &by_sphere[first_of[i] as usize..first_of[i + 1] as usize] {
                    let Some(reaction) = &reactions[c as usize] else { continue };
                    for k in 0..D {
                        if second {
                            force[k] += reaction.force[k];
                        } else {
                            force[k] -= reaction.force[k];
                        }
                    }
                    if TURNING {
                        for k in axes_of_spin::<D>() {
                            torque[k] += ends[i].radius * reaction.twist[k];
                        }
                    }
                }
            },
        );
        sums.clear_flats();
    }

    fn sweep_faces<const TURNING: bool>(
        &mut self,
        rig: &Rig<D>,
        bodies: &Bodies<D>,
        trial: Trial<D>,
        sums: &mut Sums<D>,
    ) {
        let Trial { velocity, spin, flat_velocity, step } = trial;
        let mut spare = [0.0; D];
        for f in 0..self.faces.len() {
            let c = self.near.len() + f;
            let NearFace { sphere, facing, radius, share, .. } = self.faces[f];
            let i = sphere as usize;
            let Some((distance, normal)) = self.face_distance(rig, bodies, f) else {
                if self.account[c].overlap > 0.0 {
                    self.account[c].open(step);
                    if TURNING {
                        self.stretch[c] = [0.0; D];
                    }
                }
                continue;
            };
            let (factor, face_velocity) = match facing {
                Facing::Flat(flat) => (self.face_factor, flat_velocity[flat as usize]),
                Facing::Mirror(_) => (2.0, [0.0; D]),
            };
            let mut approach = [0.0; D];
            for k in 0..D {
                approach[k] = face_velocity[k] - velocity[i][k];
            }
            let along = dot(&approach, &normal);
            let mut sliding = [0.0; D];
            let slips = TURNING && matches!(facing, Facing::Flat(_));
            if slips {
                let turn = spin_cross(&spin[i].map(|w| w * radius), &normal);
                for k in 0..D {
                    sliding[k] = approach[k] - along * normal[k] + turn[k];
                }
            }
            let meeting =
                Meeting { overlap: factor * (radius - distance), closing_speed: factor * along, normal, sliding };
            let stretch = if TURNING { &mut self.stretch[c] } else { &mut spare };
            let bond = (&self.bonds[self.bond[c] as usize], self.reduced[c]);
            let Reaction { force, twist } = if slips {
                react::<D, L, true>(&meeting, bond, &mut self.memory[c], stretch, &mut self.account[c], step, share)
            } else {
                react::<D, L, false>(&meeting, bond, &mut self.memory[c], stretch, &mut self.account[c], step, share)
            };
            for k in 0..D {
                sums.force[i][k] += force[k];
            }
            if slips {
                for k in axes_of_spin::<D>() {
                    sums.torque[i][k] += radius * twist[k];
                }
            }
            if let Facing::Flat(flat) = facing {
                for k in 0..D {
                    sums.flat[flat as usize][k] -= force[k];
                }
            }
        }
    }

    /// Distance of a sphere's centre from the face and the unit vector from face to sphere, where they overlap.
    fn face_distance(&self, rig: &Rig<D>, bodies: &Bodies<D>, f: usize) -> Option<(f64, [f64; D])> {
        let NearFace { sphere, facing, gap, radius, .. } = self.faces[f];
        let moved = &bodies.displacement[sphere as usize];
        match facing {
            Facing::Mirror(m) => {
                let mirror = &rig.mirrors[m as usize];
                let mut normal = [0.0; D];
                normal[mirror.axis] = mirror.inward;
                let apart = gap + mirror.inward * moved[mirror.axis];
                (apart < -CLOSED * radius).then_some((radius + apart, normal))
            }
            Facing::Flat(flat) => {
                let (flat, face) = (&rig.flats[flat as usize], flat as usize);
                if flat.face == Face::Plane {
                    let mut apart = gap;
                    for k in 0..D {
                        apart += flat.normal[k] * (moved[k] - bodies.flat_moved[face][k]);
                    }
                    return (apart < -CLOSED * radius).then_some((radius + apart, flat.normal));
                }
                let centre = rig.sample.spheres[sphere as usize].centre;
                let at: [f64; D] = std::array::from_fn(|k| centre[k] + moved[k]);
                let (distance, normal) = flat.distance(&bodies.flat_moved[face], &at);
                (distance < radius * (1.0 - CLOSED_EDGE)).then_some((distance, normal))
            }
        }
    }

    /// Normal of a contact (from its first body to its second), where it is closed.
    pub fn normal(&self, rig: &Rig<D>, bodies: &Bodies<D>, c: usize) -> Option<[f64; D]> {
        if let Some(f) = c.checked_sub(self.near.len()) {
            return self.face_distance(rig, bodies, f).map(|(_, normal)| normal);
        }
        let Near { ends: [a, b], offset, .. } = self.near[c];
        let (from, to) = (bodies.displacement[a as usize], bodies.displacement[b as usize]);
        let between: [f64; D] = std::array::from_fn(|k| offset[k] + to[k] - from[k]);
        let distance = dot(&between, &between).sqrt();
        (self.account[c].overlap > 0.0).then(|| between.map(|x| x / distance))
    }

    /// Force (N) of a contact's tangential spring.
    pub fn tangential(&self, c: usize) -> f64 {
        if self.stretch.is_empty() {
            return 0.0;
        }
        let slip = &self.bonds[self.bond[c] as usize].slip;
        slip.stiffness_at(self.account[c].overlap) * dot(&self.stretch[c], &self.stretch[c]).sqrt()
    }
}

impl Slip {
    #[inline(always)]
    fn stiffness_at(&self, overlap: f64) -> f64 {
        if self.mindlin > 0.0 { self.stiffness + self.mindlin * overlap.sqrt() } else { self.stiffness }
    }
}

/// Force sums on all bodies.
#[derive(Clone, Debug)]
pub(super) struct Sums<const D: usize> {
    pub force: Vec<[f64; D]>,
    pub torque: Vec<[f64; 3]>,
    pub flat: Vec<[f64; D]>,
}

impl<const D: usize> Sums<D> {
    pub fn new(spheres: usize, flats: usize) -> Self {
        Self { force: vec![[0.0; D]; spheres], torque: vec![[0.0; 3]; spheres], flat: vec![[0.0; D]; flats] }
    }

    fn clear<const TURNING: bool>(&mut self) {
        self.force.fill([0.0; D]);
        if TURNING {
            self.torque.fill([0.0; 3]);
        }
        self.clear_flats();
    }

    fn clear_flats(&mut self) {
        self.flat.fill([0.0; D]);
    }
}

/// The reaction of two spheres, if they overlap.
#[inline(always)]
#[expect(clippy::too_many_arguments, reason = "the columns of one row of parallel arrays")]
fn react_pair<const D: usize, L: Bonding, const TURNING: bool>(
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
fn react<const D: usize, L: Bonding, const TURNING: bool>(
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

/// 1/2 for a pair that lies in a mirror, on which both its spheres lie.
fn share_in_mirrors<const D: usize>(rig: &Rig<D>, pair: &Near<D>) -> f64 {
    let mut share = 1.0;
    for mirror in &rig.mirrors {
        let on = |i: u32| {
            let sphere = &rig.sample.spheres[i as usize];
            mirror.carries(&sphere.centre, sphere.radius)
        };
        if pair.ends.into_iter().all(on) {
            share *= 0.5;
        }
    }
    share
}

impl NearFace {
    /// A sphere and a face that it is near.
    pub fn of<const D: usize>(rig: &Rig<D>, bodies: &Bodies<D>, sphere: usize, facing: Facing) -> Self {
        let Sphere { centre, radius, .. } = rig.sample.spheres[sphere];
        let (gap, share) = match facing {
            // A flat crosses the mirrors of its rig, so that of a sphere on them it meets the simulated part.
            Facing::Flat(f) => (rig.flats[f as usize].distance(&[0.0; D], &centre).0 - radius, bodies.weight[sphere]),
            Facing::Mirror(m) => (rig.mirrors[m as usize].distance(&centre) - radius, 1.0),
        };
        let gap = if gap.abs() <= TOUCHING * radius { 0.0 } else { gap };
        Self { sphere: sphere as u32, facing, gap, radius, share }
    }
}

/// Spheres near flats and mirrors, in order of their keys.
fn near_faces<const D: usize>(rig: &Rig<D>, finder: &Finder<D>, bodies: &Bodies<D>) -> Vec<NearFace> {
    let mut faces = Vec::new();
    if rig.flats.is_empty() && rig.mirrors.is_empty() {
        return faces;
    }
    for (i, sphere) in rig.sample.spheres.iter().enumerate() {
        let radius = sphere.radius;
        let skin = finder.leeway[i] + finder.common;
        let at: [f64; D] = std::array::from_fn(|k| sphere.centre[k] + bodies.displacement[i][k]);
        for (f, flat) in rig.flats.iter().enumerate() {
            if flat.distance(&bodies.flat_moved[f], &at).0 - radius < skin {
                faces.push(NearFace::of(rig, bodies, i, Facing::Flat(f as u32)));
            }
        }
        for (m, mirror) in rig.mirrors.iter().enumerate() {
            if !mirror.carries(&sphere.centre, radius) && mirror.distance(&at) - radius < skin {
                faces.push(NearFace::of(rig, bodies, i, Facing::Mirror(m as u32)));
            }
        }
    }
    faces
}
