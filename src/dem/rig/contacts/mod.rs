//! All candidate contacts, as parallel arrays, and the force sweep over them.
//!
//! Pairs of spheres come first, then contacts with faces: flats, and mirrors, in which a sphere meets its own image. What one
//! contact does is worked out in one place (`react`) and added up in order of the contacts, either at once or, on several
//! threads, by first storing the reactions and then adding up sphere by sphere: the same sums in the same order.
//!
//! - `react`: what contacts do; `faces`: contacts with flats and mirrors
//! - `sweep`: forces on all bodies; `lanes`: the same for disks with springs and dashpots, several contacts side by side
//! - `account`: what contacts have carried and lost

mod account;
mod faces;
mod lanes;
mod react;
mod sweep;

use std::any::Any;
use std::collections::{BTreeMap, HashMap};

pub(super) use account::Account;
pub(super) use faces::{Facing, NearFace};
pub(super) use react::Trial;
pub(super) use sweep::Sums;

use super::bodies::{Bodies, dot};
use super::law::{Binder, Bond, Bonding, End, SpringDashpot, reduced_mass};
use super::pairs::{Finder, Near};
use super::{Body, Rig};
use crate::real::Width;
use account::Accounts;
use faces::near_faces;
use lanes::Lines;
use react::Reaction;
use sweep::MANY;

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
    /// ξ, the tangential spring (m), along each axis; empty without friction.
    pub stretch: [Vec<f64>; D],
    pub account: Accounts,
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
    /// For sums on several threads: the contacts of each sphere, in order, twice their index, plus one where it is the second
    /// end.
    by_sphere: Vec<u32>,
    first_of: Vec<u32>,
    reactions: Vec<Reaction<D>>,
    /// As `reactions`, of disks in lanes.
    flat_reactions: Vec<[f64; 3]>,
    /// For disks in lanes: the pairs as parallel arrays, all radii (m), and r ω of all (m/s).
    lines: Lines,
    lever: Vec<f64>,
    turn: Vec<f64>,
    width: Width,
}

impl<const D: usize, L: Bonding> Contacts<D, L> {
    /// No contact yet. `face_factor` is 2 where a face stands for an equal sphere (Burgoyne 2016, appendix A.1), 1 where
    /// it is met as it is.
    pub fn new(rig: &Rig<D>, face_factor: f64) -> Self {
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
        Self {
            near: Vec::new(),
            faces: Vec::new(),
            share: Vec::new(),
            bond: Vec::new(),
            reduced: Vec::new(),
            bonds: Vec::new(),
            known_bonds: HashMap::new(),
            memory: Vec::new(),
            stretch: std::array::from_fn(|_| Vec::new()),
            account: Accounts::default(),
            kept_pairs: BTreeMap::new(),
            kept_faces: BTreeMap::new(),
            lost: [0.0; 2],
            lost_by_sphere: vec![0.0; count],
            dropped: Vec::new(),
            face_factor,
            class,
            lever: ends.iter().map(|end| end.radius).collect(),
            turn: vec![0.0; count],
            ends,
            turning: rig.laws.has_friction(),
            by_sphere: Vec::new(),
            first_of: Vec::new(),
            reactions: Vec::new(),
            flat_reactions: Vec::new(),
            lines: Lines::default(),
            width: Width::widest(),
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
        let mut account = Accounts::with_capacity(near.len() + faces.len());
        let turning = self.turning;
        let mut stretch: [Vec<f64>; D] =
            std::array::from_fn(|_| Vec::with_capacity(if turning { near.len() + faces.len() } else { 0 }));
        let mut take = |from: Option<usize>, kept: Option<Kept<L::Memory>>, old: &Self| {
            match (from, kept) {
                (Some(c), _) => {
                    memory.push(old.memory[c]);
                    account.push(old.account.at(c));
                    if turning {
                        for k in 0..D {
                            stretch[k].push(old.stretch[k][c]);
                        }
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
                        stretch.iter_mut().for_each(|axis| axis.push(0.0));
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
        if let Some(disks) = (self as &mut dyn Any).downcast_mut::<Contacts<2, SpringDashpot>>() {
            disks.lines = Lines::of(&disks.near);
        }
        self.index();
    }

    /// Keeps what a contact remembers that is no longer near.
    fn drop_contact(&mut self, c: usize, bodies: &Bodies<D>) {
        let Account { work, slid, .. } = self.account.at(c);
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
        let mut last = None;
        for c in 0..self.near.len() + self.faces.len() {
            let (key, ends, counted) = match self.near.get(c) {
                Some(pair) => (pair.ends.map(class), pair.ends.map(|i| self.ends[i as usize]), 1.0),
                None => {
                    let face = &self.faces[c - self.near.len()];
                    let end = self.ends[face.sphere as usize];
                    // Where a flat stands for an equal sphere the closing speed counts double, and the mass that is slowed half.
                    let (mass, counted) = match face.facing {
                        Facing::Flat(f) => (rig.flats[f as usize].mass, self.face_factor),
                        Facing::Mirror(_) => (end.mass, 1.0),
                    };
                    // A face counts as a sphere like the one that it meets.
                    ([class(face.sphere); 2], [end, End { mass, ..end }], counted)
                }
            };
            self.reduced.push(reduced_mass(ends) / counted);
            // Most contacts have the law of the one before.
            let place = match last {
                Some((known, place)) if known == key => place,
                _ => {
                    let next = self.bonds.len() as u32;
                    let place = *self.known_bonds.entry(key).or_insert(next);
                    if place == next {
                        self.bonds.push(binder.bond(ends));
                    }
                    place
                }
            };
            last = Some((key, place));
            self.bond.push(place);
        }
    }

    /// Which contacts each sphere has, for sums on several threads.
    fn index(&mut self) {
        self.by_sphere.clear();
        self.first_of.clear();
        self.reactions.clear();
        self.flat_reactions.clear();
        if self.near.len() < MANY || rayon::current_num_threads() == 1 {
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
        self.by_sphere.resize(2 * self.near.len(), 0);
        for (c, pair) in self.near.iter().enumerate() {
            for (side, end) in pair.ends.into_iter().enumerate() {
                self.by_sphere[next[end as usize] as usize] = (2 * c + side) as u32;
                next[end as usize] += 1;
            }
        }
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
    fn strain(&self, c: usize) -> Option<Strain> {
        let [overlap, force] = self.greatest(c);
        let law = self.normal_law(c);
        (overlap > 0.0).then(|| Strain {
            bodies: self.bodies(c),
            ratio: overlap / self.reach(c),
            range_used: overlap / law.range(),
            stiffness: law.stiffness_max(force),
        })
    }

    /// What the contacts have borne that went beyond an overlap ratio, the range of their law, or a stiffness over reduced
    /// mass (1/s²); and those that were dropped, whatever they bore.
    pub fn strains(&self, ratio: f64, stiffness_over_mass: f64) -> Vec<Strain> {
        let mut strains = self.dropped.clone();
        for c in 0..self.len() {
            let [overlap, force] = self.greatest(c);
            if overlap == 0.0 {
                continue;
            }
            let law = self.normal_law(c);
            if overlap > ratio * self.reach(c)
                || overlap > law.range()
                || law.stiffness_max(force) > stiffness_over_mass * self.reduced[c]
            {
                strains.extend(self.strain(c));
            }
        }
        strains
    }

    /// Greatest overlap (m) and force (N) so far, where the law remembers them; else the present ones.
    fn greatest(&self, c: usize) -> [f64; 2] {
        L::greatest(&self.memory[c]).unwrap_or([self.account.overlap[c], self.account.force[c]])
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

    /// Normal of a contact (from its first body to its second), where it is closed.
    pub fn normal(&self, rig: &Rig<D>, bodies: &Bodies<D>, c: usize) -> Option<[f64; D]> {
        if let Some(f) = c.checked_sub(self.near.len()) {
            return self.faces[f].overlapping(rig, bodies).map(|(_, normal)| normal);
        }
        let Near { ends: [a, b], offset, .. } = self.near[c];
        let (from, to) = (bodies.displacement[a as usize], bodies.displacement[b as usize]);
        let between: [f64; D] = std::array::from_fn(|k| offset[k] + to[k] - from[k]);
        let distance = dot(&between, &between).sqrt();
        (self.account.overlap[c] > 0.0).then(|| between.map(|x| x / distance))
    }

    /// How fast a contact's overlap grows (m/s), with the normal from its first body to its second.
    pub fn closing_speed(&self, bodies: &Bodies<D>, c: usize, normal: &[f64; D]) -> f64 {
        let along = |velocity: &[f64; D]| dot(velocity, normal);
        match c.checked_sub(self.near.len()) {
            Some(f) => {
                let speed = -along(&bodies.velocity[self.faces[f].sphere as usize]);
                match self.faces[f].facing {
                    Facing::Flat(flat) => self.face_factor * (speed + along(&bodies.flat_velocity[flat as usize])),
                    Facing::Mirror(_) => 2.0 * speed,
                }
            }
            None => {
                let [a, b] = self.near[c].ends.map(|i| along(&bodies.velocity[i as usize]));
                a - b
            }
        }
    }

    /// Force (N) of a contact's tangential spring.
    pub fn tangential(&self, c: usize) -> f64 {
        self.spring(c).map_or(0.0, |[stiffness, squared]| stiffness * squared.sqrt())
    }

    /// ½ k_t ξ² (J), what a contact's tangential spring holds.
    pub fn wound(&self, c: usize) -> f64 {
        self.spring(c).map_or(0.0, |[stiffness, squared]| 0.5 * stiffness * squared)
    }

    /// Whether there are tangential springs.
    pub fn winds(&self) -> bool {
        self.turning && self.bonds.iter().any(|bond| bond.slip.stiffness > 0.0 || bond.slip.mindlin > 0.0)
    }

    /// k_t (N/m) and ξ² (m²), with friction.
    fn spring(&self, c: usize) -> Option<[f64; 2]> {
        let slip = &self.bonds[self.bond[c] as usize].slip;
        self.turning.then(|| {
            let stretch: [f64; D] = std::array::from_fn(|k| self.stretch[k][c]);
            [slip.stiffness_at(self.account.overlap[c]), dot(&stretch, &stretch)]
        })
    }
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
