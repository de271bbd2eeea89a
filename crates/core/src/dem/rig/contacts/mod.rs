//! All candidate contacts, as parallel arrays, and the force sweep over them.
//!
//! Pairs of spheres come first, then contacts with faces: flats, and mirrors, in which a sphere meets its own image. What one
//! contact does is worked out in one place (`react`) and added up in order of the contacts, or, where there are many, of those of each
//! section, which threads share out: the same sums for any number of threads.
//!
//! - `react`: what contacts do; `friction`: its tangential part; `faces`: contacts with flats and mirrors
//! - `sweep`: forces on all bodies; several contacts side by side: `lanes` for disks with springs and dashpots, `solids` for spheres under laws of materials
//! - `swept`: which of these a law has
//! - `list`: how the list changes
//! - `sections`: parts of the list of pairs that threads share out
//! - `account`: what contacts have carried and lost

mod account;
mod faces;
mod friction;
mod lanes;
mod list;
mod react;
mod sections;
mod solids;
mod sweep;
mod swept;
#[cfg(test)]
mod tests;

use std::collections::{BTreeMap, HashMap};

pub(super) use account::Account;
pub(super) use faces::{Facing, NearFace};
pub(super) use react::Predicted;
pub(super) use sweep::{Excess, Sums};
pub(super) use swept::Swept;

use super::bodies::{Bodies, dot};
use super::law::{End, PairLaw};
use super::pairs::Near;
use super::{Arm, Body, Rig};
use crate::dem::share::parts;
use crate::real::Width;
use account::Accounts;
use friction::{More, Row};
use sections::Sections;

/// A contact's memories that outlive its being near.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Kept<M> {
    pub memory: M,
    pub work: f64,
    pub friction_work: f64,
    /// The part of both works that is simulated.
    pub weight: f64,
}

impl<M> Kept<M> {
    /// What the contact has lost (J); open, it holds nothing.
    pub fn loss(&self) -> f64 {
        self.weight * (self.work + self.friction_work)
    }
}

/// What the guards ask of a contact.
#[derive(Clone, Copy, Debug)]
pub(super) struct Strain {
    pub bodies: [Body; 2],
    /// Greatest overlap so far over what it is judged by.
    pub ratio: f64,
    /// What that may be.
    pub limit: f64,
    /// Greatest stiffness that it can show (N/m).
    pub stiffness: f64,
}

/// Key of a pair, and of a face contact.
pub(super) type PairKey<const D: usize> = ([u32; 2], [i8; D]);
pub(super) type FaceKey = (u32, Facing);

/// Contacts as parallel arrays: row c of each is contact c, pairs first, then faces.
pub(super) struct Contacts<const D: usize, L: Swept<D>> {
    pub near: Vec<Near<D>>,
    pub faces: Vec<NearFace>,
    /// Part of a pair that belongs to the simulated part of a symmetric rig; empty where all is simulated.
    share: Vec<f64>,
    /// Place of a contact's law in `pair_laws`.
    pair_law: Vec<u32>,
    /// Reduced mass m̄ (kg).
    reduced: Vec<f64>,
    pair_laws: Vec<PairLaw<L>>,
    known_bonds: HashMap<[u32; 2], u32>,
    pub memory: Vec<L::Memory>,
    /// ξ, the tangential spring (m), along each axis; empty without friction.
    pub stretch: [Vec<f64>; D],
    /// What friction remembers besides: `more.count()` numbers of each contact.
    pub extra: Vec<f64>,
    more: More,
    pub account: Accounts,
    /// Memories of contacts that are no longer near.
    pub kept_pairs: BTreeMap<PairKey<D>, Kept<L::Memory>>,
    pub kept_faces: BTreeMap<FaceKey, Kept<L::Memory>>,
    /// What contacts without memory lost before they were dropped: normal and tangential (J), and by sphere.
    pub lost: [f64; 2],
    pub lost_by_sphere: Vec<f64>,
    /// What contacts had borne when they were dropped, for the guards' next look.
    pub dropped: Vec<Strain>,
    /// Overlap, closing and sliding of a contact with each flat over those of sphere and flat: 2 where it stands for an equal sphere.
    flat_factor: Vec<f64>,
    /// Whether it is of a material of its own.
    flat_is_own: Vec<bool>,
    /// Kinds of spheres: those of one kind have the same laws.
    class: Vec<u32>,
    ends: Vec<End>,
    turning: bool,
    /// Overlap over the sum of radii that is allowed in place of what the laws allow.
    overlap_limit: Option<f64>,
    sections: Sections<D>,
    /// What spins and couples per lever arm are multiplied by: the radius (m), or 1 where arms end in the contact.
    pub lever: Vec<f64>,
    /// All radii (m) where arms end in the contact, else none.
    radius: Vec<f64>,
    /// What pairs side by side have besides.
    beside: L::Beside,
    width: Width,
}

impl<const D: usize, L: Swept<D>> Contacts<D, L> {
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
        let in_contact = rig.laws.arm() == Arm::Contact;
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
            pair_law: Vec::new(),
            reduced: Vec::new(),
            pair_laws: Vec::new(),
            known_bonds: HashMap::new(),
            memory: Vec::new(),
            stretch: std::array::from_fn(|_| Vec::new()),
            extra: Vec::new(),
            more: More::of(rig),
            account: Accounts::default(),
            kept_pairs: BTreeMap::new(),
            kept_faces: BTreeMap::new(),
            lost: [0.0; 2],
            lost_by_sphere: vec![0.0; count],
            dropped: Vec::new(),
            flat_is_own: rig.flats.iter().map(|flat| flat.contact.is_own()).collect(),
            flat_factor: rig.flats.iter().map(|flat| if flat.contact.is_own() { 1.0 } else { face_factor }).collect(),
            class,
            lever: ends.iter().map(|end| if in_contact { 1.0 } else { end.radius }).collect(),
            radius: ends.iter().map(|end| end.radius).filter(|_| in_contact).collect(),
            ends,
            turning: rig.has_friction(),
            overlap_limit: rig.overlap_limit,
            sections: Sections::of(&[], count),
            beside: L::Beside::default(),
            width: Width::widest(),
        }
    }

    /// Number of contacts, open ones included.
    pub fn len(&self) -> usize {
        self.near.len() + self.faces.len()
    }

    /// The law of a contact.
    pub fn normal_law(&self, c: usize) -> &L {
        &self.pair_laws[self.pair_law[c] as usize].normal
    }

    /// The part of a contact's force that is simulated.
    pub fn share(&self, c: usize) -> f64 {
        match c.checked_sub(self.near.len()) {
            Some(f) => self.faces[f].share,
            None if self.share.is_empty() => 1.0,
            None => self.share[c],
        }
    }

    /// The part of a contact's works and energies that is simulated.
    pub fn weight(&self, c: usize) -> f64 {
        match c.checked_sub(self.near.len()) {
            Some(f) => match self.faces[f].facing {
                Facing::Flat(flat) => self.faces[f].share / self.flat_factor[flat as usize],
                Facing::Mirror(_) => 0.5,
            },
            None => self.share(c),
        }
    }

    /// Overlap, closing and sliding of a contact over those of its two bodies.
    pub fn face_scale(&self, c: usize) -> f64 {
        match c.checked_sub(self.near.len()).map(|f| self.faces[f].facing) {
            Some(Facing::Flat(flat)) => self.flat_factor[flat as usize],
            Some(Facing::Mirror(_)) => 2.0,
            None => 1.0,
        }
    }

    /// The same over those that records show: of a flat they show the sphere's own, of a mirror those of sphere and image.
    pub fn shown_scale(&self, c: usize) -> f64 {
        match c.checked_sub(self.near.len()).map(|f| self.faces[f].facing) {
            Some(Facing::Flat(flat)) => self.flat_factor[flat as usize],
            Some(Facing::Mirror(_)) | None => 1.0,
        }
    }

    /// What a contact that carries or has carried force has borne.
    fn strain(&self, c: usize) -> Option<Strain> {
        let [overlap, force] = self.greatest(c);
        let law = self.normal_law(c);
        (overlap > 0.0).then(|| Strain {
            bodies: self.bodies(c),
            ratio: overlap / self.radii_sum(c),
            limit: self.overlap_limit(c),
            stiffness: law.stiffness_max(force),
        })
    }

    /// What the contacts have borne that went beyond the greatest overlap allowed, or a stiffness over reduced mass (1/s²); and those
    /// that were dropped, whatever they bore.
    pub fn strains(&self, stiffness_over_mass: f64) -> Vec<Strain> {
        let bold = |c: &usize| {
            let [overlap, force] = self.greatest(*c);
            if overlap == 0.0 {
                return false;
            }
            let law = self.normal_law(*c);
            overlap > self.overlap_limit(*c) * self.radii_sum(*c)
                || law.stiffness_max(force) > stiffness_over_mass * self.reduced[*c]
        };
        let found = parts(self.len(), |range| range.filter(bold).filter_map(|c| self.strain(c)).collect::<Vec<_>>());
        self.dropped.iter().copied().chain(found.into_iter().flatten()).collect()
    }

    /// The greatest overlap that a contact may have, over what it is judged by: that asked for or its law's, and no more than its law is known for.
    fn overlap_limit(&self, c: usize) -> f64 {
        let law = self.normal_law(c);
        self.overlap_limit.unwrap_or_else(|| law.overlap_limit()).min(law.range() / self.radii_sum(c))
    }

    /// Greatest overlap (m) and force (N) so far, where the law remembers them; else the present ones.
    fn greatest(&self, c: usize) -> [f64; 2] {
        L::greatest(&self.memory[c]).unwrap_or([self.account.overlap[c], self.account.force[c]])
    }

    /// By what an overlap is judged (m): the sum of radii, a sphere's diameter at a face; its radius at a flat of a material of its own, into
    /// which it goes as deep as two equal spheres into each other at twice the overlap.
    pub fn radii_sum(&self, c: usize) -> f64 {
        match c.checked_sub(self.near.len()) {
            Some(f) => {
                let own = matches!(self.faces[f].facing, Facing::Flat(flat) if self.flat_is_own[flat as usize]);
                if own { self.faces[f].radius } else { 2.0 * self.faces[f].radius }
            }
            None => self.near[c].ends.map(|end| self.ends[end as usize].radius).iter().sum(),
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
        if self.account.overlap[c] == 0.0 {
            return None;
        }
        if let Some(f) = c.checked_sub(self.near.len()) {
            return self.faces[f].standing(rig, bodies).map(|standing| standing.normal);
        }
        let (near, (offset, _)) = (&self.near[c], self.near[c].lies());
        let [a, b] = near.ends;
        let (from, to) = (bodies.displacement[a as usize], bodies.displacement[b as usize]);
        let between: [f64; D] = std::array::from_fn(|k| offset[k] + to[k] - from[k]);
        let distance = dot(&between, &between).sqrt();
        Some(between.map(|x| x / distance))
    }

    /// dF/dx of a closed contact (N/m), by how far its bodies are from each other.
    pub fn stiffness(&self, c: usize) -> f64 {
        self.face_scale(c) * self.normal_law(c).stiffness(self.account.overlap[c], self.reduced[c], &self.memory[c])
    }

    /// How fast a contact's overlap grows (m/s), with the normal from its first body to its second.
    pub fn closing_speed(&self, bodies: &Bodies<D>, c: usize, normal: &[f64; D]) -> f64 {
        let along = |velocity: &[f64; D]| dot(velocity, normal);
        match c.checked_sub(self.near.len()) {
            Some(f) => {
                let speed = -along(&bodies.velocity[self.faces[f].sphere as usize]);
                let of_face = match self.faces[f].facing {
                    Facing::Flat(flat) => along(&bodies.flat_velocity[flat as usize]),
                    Facing::Mirror(_) => 0.0,
                };
                self.face_scale(c) * (speed + of_face)
            }
            None => {
                let [a, b] = self.near[c].ends.map(|i| along(&bodies.velocity[i as usize]));
                a - b
            }
        }
    }

    /// Force (N) of a contact's tangential spring.
    pub fn tangential(&self, c: usize) -> f64 {
        if let Some(row) = self.row(c) {
            return dot(&row.force(), &row.force()).sqrt();
        }
        self.spring(c).map_or(0.0, |[stiffness, squared]| stiffness * squared.sqrt())
    }

    /// Force of friction (N) on the second body of a closed contact: its law, of the present velocities and spring.
    pub fn friction(&self, bodies: &Bodies<D>, c: usize, normal: &[f64; D]) -> [f64; D] {
        let pair_law = &self.pair_laws[self.pair_law[c] as usize];
        if !self.turning || pair_law.slip.coefficient == 0.0 {
            return [0.0; D];
        }
        let account = self.account.at(c);
        let (overlap, push, factor) = (account.overlap, account.force, self.face_scale(c));
        // Where arms end in the contact they are as long as the overlap leaves them.
        let depth = if c < self.near.len() { 0.5 * overlap } else { overlap / factor };
        let turn_of = |i: usize| {
            let arm = self.radius.get(i).map_or(self.lever[i], |radius| radius - depth);
            bodies.spin.get(i).map(|spin| factor * arm * spin)
        };
        let (first, second, turn) = match c.checked_sub(self.near.len()) {
            None => {
                let [a, b] = self.near[c].ends.map(|i| i as usize);
                let (one, other) = (turn_of(a), turn_of(b));
                (bodies.velocity[a], bodies.velocity[b], std::array::from_fn(|k| one[k] + other[k]))
            }
            Some(f) => match self.faces[f] {
                NearFace { facing: Facing::Flat(flat), sphere, .. } => {
                    let sphere = sphere as usize;
                    (bodies.flat_velocity[flat as usize], bodies.velocity[sphere], turn_of(sphere))
                }
                // Sphere and image slide alike.
                NearFace { facing: Facing::Mirror(_), .. } => return [0.0; D],
            },
        };
        let approach: [f64; D] = std::array::from_fn(|k| factor * (first[k] - second[k]));
        let closing_speed = dot(&approach, normal);
        let meeting = react::Meeting { overlap, closing_speed, normal: *normal, approach, turn, inverse: 0.0 };
        let stretch: [f64; D] = std::array::from_fn(|k| self.stretch[k][c]);
        let mut numbers = self.extra_of(c).to_vec();
        let held = friction::Held { more: self.more, numbers: &mut numbers };
        react::friction::<D, L>(&meeting, (pair_law, self.reduced[c]), push, (&stretch, &account), held)
    }

    /// ½ k_t ξ² (J), what a contact's tangential springs hold, and that against rolling.
    pub fn tangential_stored(&self, c: usize) -> f64 {
        let slid = match self.row(c) {
            Some(row) => row.stored(),
            None => self.spring(c).map_or(0.0, |[stiffness, squared]| 0.5 * stiffness * squared),
        };
        let rolled = self.more.rolled(self.extra_of(c)).map_or(0.0, |rolled| {
            0.5 * self.pair_laws[self.pair_law[c] as usize].slip.stiffness_at(self.account.overlap[c])
                * dot(rolled, rolled)
        });
        slid + rolled
    }

    /// What friction remembers of a contact besides.
    fn extra_of(&self, c: usize) -> &[f64] {
        let count = self.more.count::<D>();
        self.extra.get(c * count..(c + 1) * count).unwrap_or(&[])
    }

    /// The row of springs of a contact whose friction is spread over it.
    fn row(&self, c: usize) -> Option<Row<'_, D>> {
        let slip = &self.pair_laws[self.pair_law[c] as usize].slip;
        (self.turning && slip.spread).then(|| Row::of(slip, self.more.springs(self.extra_of(c))))
    }

    /// Whether there are tangential springs.
    pub fn has_tangential_springs(&self) -> bool {
        self.turning
            && self.pair_laws.iter().any(|pair_law| pair_law.slip.stiffness > 0.0 || pair_law.slip.mindlin > 0.0)
    }

    /// k_t (N/m) and ξ² (m²), with friction.
    fn spring(&self, c: usize) -> Option<[f64; 2]> {
        let slip = &self.pair_laws[self.pair_law[c] as usize].slip;
        self.turning.then(|| {
            let stretch: [f64; D] = std::array::from_fn(|k| self.stretch[k][c]);
            [slip.stiffness_at(self.account.overlap[c]), dot(&stretch, &stretch)]
        })
    }
}
