//! A machine whatever its law, and its state to and from numbers.

use std::collections::BTreeMap;

use super::bodies::Bodies;
use super::checkpoint::{Motion, State};
use super::cluster::ClusterState;
use super::contacts::{Account, Facing, Kept, NearFace, Strain, Sums, Swept};
use super::law::LawMaker;
use super::ledger::EnergyLedger;
use super::machine::{Machine, Past};
use super::pairs::{Near, pair};
use super::view::Touching;
use super::{Body, Rig};
use crate::dem::{ContactRecord, Integrator};

/// A machine of any law.
pub(super) trait Engine<const D: usize>: Send {
    fn begin(&mut self, rig: &Rig<D>);
    fn advance(&mut self, rig: &Rig<D>);
    /// Goes on by a scheme, from a start or a state that is taken up.
    fn go_by(&mut self, integrator: Integrator);
    fn integrator(&self) -> Integrator;
    fn count(&self) -> u64;
    fn bodies(&self) -> &Bodies<D>;
    fn sums(&self) -> &Sums<D>;
    fn ledger(&self, rig: &Rig<D>) -> EnergyLedger;
    /// The ledger, of which the energy at hand is remembered.
    fn look(&mut self, rig: &Rig<D>) -> EnergyLedger;
    /// Number of contacts, open ones included.
    fn contacts(&self) -> usize;
    /// A contact that is closed.
    fn touching(&self, rig: &Rig<D>, c: usize) -> Option<Touching<D>>;
    /// Sum of the sizes of the normal forces (N) on each sphere.
    fn normal_force_sum(&self) -> Vec<f64>;
    /// What contacts have borne beyond the overlap that is allowed, or a stiffness over reduced mass (1/s²), and those dropped since
    /// `forget_dropped`.
    fn strains(&self, stiffness_over_mass: f64) -> Vec<Strain>;
    fn forget_dropped(&mut self);
    /// What contacts have taken from each sphere (J).
    fn dissipated(&self) -> Vec<f64>;
    /// What contacts have given back beyond what was put into them (J), by the materials of the two; a flat or an image is of the
    /// material of the sphere that it meets.
    fn gains(&self, rig: &Rig<D>) -> BTreeMap<[usize; 2], f64>;
    /// Every contact of spheres and mirrors that ever closed.
    fn contacts_ever(&self) -> Vec<ContactRecord>;
    fn save(&self) -> State;
    fn load(&mut self, rig: &Rig<D>, state: State) -> bool;
}

impl<const D: usize, L: Swept<D>, B: LawMaker<L>> Engine<D> for Machine<D, L, B> {
    fn begin(&mut self, rig: &Rig<D>) {
        Machine::begin(self, rig);
    }
    fn advance(&mut self, rig: &Rig<D>) {
        Machine::advance(self, rig);
    }
    fn go_by(&mut self, integrator: Integrator) {
        Machine::go_by(self, integrator);
    }
    fn integrator(&self) -> Integrator {
        if self.past.is_some() { Integrator::Adams } else { Integrator::Verlet }
    }
    fn count(&self) -> u64 {
        self.count
    }
    fn bodies(&self) -> &Bodies<D> {
        &self.bodies
    }
    fn sums(&self) -> &Sums<D> {
        &self.sums
    }
    fn ledger(&self, rig: &Rig<D>) -> EnergyLedger {
        Machine::ledger(self, rig)
    }
    fn look(&mut self, rig: &Rig<D>) -> EnergyLedger {
        Machine::look(self, rig)
    }
    fn contacts(&self) -> usize {
        self.contacts.len()
    }

    fn touching(&self, rig: &Rig<D>, c: usize) -> Option<Touching<D>> {
        let contacts = &self.contacts;
        let normal = contacts.normal(rig, &self.bodies, c)?;
        let Account { overlap, force, work, friction_work, .. } = contacts.account.at(c);
        let (law, memory) = (contacts.normal_law(c), &contacts.memory[c]);
        let stored = law.stored(overlap, memory) + contacts.tangential_stored(c);
        let [overlap_max, force_max] = L::greatest(memory).unwrap_or([overlap, force]);
        let closing_speed = contacts.closing_speed(&self.bodies, c, &normal);
        let (weight, scale) = (contacts.weight(c), contacts.shown_scale(c));
        Some(Touching {
            closing_speed: closing_speed / scale,
            yields: law.yields(overlap, closing_speed, memory),
            stiffness: contacts.stiffness(c),
            bodies: contacts.bodies(c),
            normal,
            overlap: overlap / scale,
            force,
            tangential: contacts.tangential(c),
            friction: contacts.friction(&self.bodies, c, &normal),
            overlap_max: overlap_max / scale,
            force_max,
            stored: weight * stored,
            dissipated: weight * (work + friction_work - stored),
        })
    }

    fn normal_force_sum(&self) -> Vec<f64> {
        let contacts = &self.contacts;
        let mut pressed = vec![0.0; self.bodies.velocity.len()];
        for (c, force) in contacts.account.force.iter().enumerate().filter(|(_, force)| **force != 0.0) {
            for (sphere, _) in contacts.spheres(c) {
                pressed[sphere] += force.abs();
            }
        }
        pressed
    }

    fn strains(&self, stiffness_over_mass: f64) -> Vec<Strain> {
        self.contacts.strains(stiffness_over_mass)
    }

    fn forget_dropped(&mut self) {
        self.contacts.dropped.clear();
    }

    fn dissipated(&self) -> Vec<f64> {
        let (contacts, bodies) = (&self.contacts, &self.bodies);
        let mut sum = contacts.lost_by_sphere.clone();
        for c in 0..contacts.len() {
            let Account { overlap, work, friction_work, .. } = contacts.account.at(c);
            if work == 0.0 && friction_work == 0.0 {
                continue;
            }
            let stored = contacts.normal_law(c).stored(overlap, &contacts.memory[c]);
            let loss = contacts.weight(c) * (work - stored + friction_work - contacts.tangential_stored(c));
            for (sphere, part) in contacts.spheres(c) {
                sum[sphere] += part * loss / bodies.weight[sphere];
            }
        }
        for (([a, b], _), kept) in &contacts.kept_pairs {
            for i in [*a as usize, *b as usize] {
                sum[i] += 0.5 * kept.loss() / bodies.weight[i];
            }
        }
        for ((sphere, _), kept) in &contacts.kept_faces {
            sum[*sphere as usize] += kept.loss() / bodies.weight[*sphere as usize];
        }
        sum
    }

    fn gains(&self, rig: &Rig<D>) -> BTreeMap<[usize; 2], f64> {
        let contacts = &self.contacts;
        let material = |i: usize| rig.sample.spheres[i].material;
        let mut gains = BTreeMap::new();
        let mut count = |[a, b]: [usize; 2], lost: f64| {
            if lost < 0.0 {
                let pair = [material(a), material(b)];
                *gains.entry([pair[0].min(pair[1]), pair[0].max(pair[1])]).or_insert(0.0) -= lost;
            }
        };
        for c in 0..contacts.len() {
            let Account { overlap, work, .. } = contacts.account.at(c);
            if work == 0.0 && overlap == 0.0 {
                continue;
            }
            let of = match contacts.bodies(c) {
                [Body::Sphere(a), Body::Sphere(b)] => [a, b],
                [Body::Sphere(i), Body::Flat(_)] | [Body::Flat(_), Body::Sphere(i)] => [i, i],
                [Body::Flat(_), Body::Flat(_)] => continue,
            };
            count(of, contacts.weight(c) * (work - contacts.normal_law(c).stored(overlap, &contacts.memory[c])));
        }
        for (([a, b], _), kept) in &contacts.kept_pairs {
            count([*a as usize, *b as usize], kept.weight * kept.work);
        }
        for ((sphere, _), kept) in &contacts.kept_faces {
            count([*sphere as usize; 2], kept.weight * kept.work);
        }
        gains
    }

    fn contacts_ever(&self) -> Vec<ContactRecord> {
        let contacts = &self.contacts;
        let sphere = |body| match body {
            Body::Sphere(i) => Some(i),
            Body::Flat(_) => None,
        };
        let mut records = Vec::new();
        for c in 0..contacts.len() {
            let [Some(a), Some(b)] = contacts.bodies(c).map(sphere) else { continue };
            let account = contacts.account.at(c);
            let [overlap_max, force_max] = L::greatest(&contacts.memory[c]).unwrap_or([account.overlap, account.force]);
            if overlap_max > 0.0 {
                let stored = contacts.normal_law(c).stored(account.overlap, &contacts.memory[c]);
                let (weight, work) = (contacts.weight(c), account.work);
                records.push(ContactRecord { spheres: [a, b], weight, overlap_max, force_max, work, stored });
            }
        }
        for (([a, b], _), kept) in &contacts.kept_pairs {
            if let Some([overlap_max, force_max]) = L::greatest(&kept.memory) {
                let (spheres, weight, work) = ([*a as usize, *b as usize], kept.weight, kept.work);
                records.push(ContactRecord { spheres, weight, overlap_max, force_max, work, stored: 0.0 });
            }
        }
        records.sort_by_key(|record| record.spheres);
        records
    }

    fn save(&self) -> State {
        let contacts = &self.contacts;
        let flat = |rows: &[[f64; D]]| rows.as_flattened().to_vec();
        let b = &self.bodies;
        let face = |facing: Facing| match facing {
            Facing::Flat(f) => (false, f),
            Facing::Mirror(m) => (true, m),
        };
        let kept = |kept: &Kept<L::Memory>| {
            let mut numbers = vec![kept.work, kept.friction_work, kept.weight];
            numbers.extend(L::numbers(&kept.memory));
            numbers
        };
        State {
            step: self.step,
            count: self.count,
            motion: Motion {
                displacement: flat(&b.displacement),
                velocity: flat(&b.velocity),
                acceleration: flat(&b.acceleration),
                spin: b.spin.numbers().to_vec(),
                spin_rate: b.spin_rate.numbers().to_vec(),
                flat_moved: flat(&b.flat_moved),
                flat_velocity: flat(&b.flat_velocity),
                flat_acceleration: flat(&b.flat_acceleration),
                seen: flat(&self.seen),
                flat_seen: flat(&self.flat_seen),
                skin: self.finder.skin.clone(),
                force: flat(&self.sums.force),
                torque: self.sums.torque.numbers().to_vec(),
                flat_force: flat(&self.sums.flat),
                clusters: b.clusters.iter().flat_map(ClusterState::numbers).collect(),
            },
            integrator: self.integrator(),
            past: self.past.as_ref().map(Past::accelerations),
            work_in: self.work_in,
            absorbed: self.absorbed,
            at_hand: self.at_hand,
            held_back: self.held_back,
            near: contacts.near.iter().map(|pair| pair.ends).collect(),
            images: contacts.near.iter().flat_map(|pair| pair.image).collect(),
            faces: contacts.faces.iter().map(|f| (f.sphere, face(f.facing).0, face(f.facing).1)).collect(),
            memory: contacts.memory.iter().flat_map(L::numbers).collect(),
            stretch: contacts.stretch.concat(),
            extra: contacts.extra.clone(),
            account: (0..contacts.len()).flat_map(|c| contacts.account.at(c).numbers()).collect(),
            kept_pairs: contacts.kept_pairs.iter().map(|((ends, image), k)| (*ends, image.to_vec(), kept(k))).collect(),
            kept_faces: contacts
                .kept_faces
                .iter()
                .map(|((sphere, facing), k)| ((*sphere, face(*facing).0, face(*facing).1), kept(k)))
                .collect(),
            lost: contacts.lost,
            lost_by_sphere: contacts.lost_by_sphere.clone(),
            ..State::default()
        }
    }

    fn load(&mut self, rig: &Rig<D>, state: State) -> bool {
        let spheres = rig.sample.spheres.len();
        let facing = |mirror: bool, place: u32| if mirror { Facing::Mirror(place) } else { Facing::Flat(place) };
        let image = |numbers: &[i8]| std::array::from_fn(|k| numbers.get(k).copied().unwrap_or(0));
        let known = |i: u32| (i as usize) < spheres;
        let face_known = |&(sphere, mirror, place): &(u32, bool, u32)| {
            known(sphere) && (place as usize) < if mirror { rig.mirrors.len() } else { rig.flats.len() }
        };
        if state.images.len() != D * state.near.len()
            || !state.near.iter().all(|ends| ends[0] < ends[1] && ends.iter().all(|&i| known(i)))
            || !state.faces.iter().all(face_known)
        {
            return false;
        }
        let near: Vec<Near<D>> = (state.near.iter().zip(state.images.chunks(D.max(1))))
            .map(|(ends, shift)| pair(rig, ends.map(|i| i as usize), image(shift)))
            .collect();
        // Sections and renewals rely on their order.
        if !near.is_sorted_by(|a, b| a.key() < b.key()) {
            return false;
        }
        let faces: Vec<NearFace> = (state.faces.iter())
            .map(|&(sphere, mirror, place)| NearFace::of(rig, &self.bodies, sphere as usize, facing(mirror, place)))
            .collect();
        let count = near.len() + faces.len();
        self.contacts.replace(rig, near, faces, &self.bodies, &self.maker);
        let contacts = &mut self.contacts;
        let mut fits = state.memory.len() == count * L::NUMBERS
            && state.account.len() == count * Account::NUMBERS
            && state.extra.len() == contacts.extra.len()
            && state.stretch.len() == contacts.stretch.iter().map(Vec::len).sum::<usize>()
            && state.lost_by_sphere.len() == spheres;
        if !fits {
            return false;
        }
        for c in 0..count {
            contacts.memory[c] = L::from_numbers(&state.memory[c * L::NUMBERS..(c + 1) * L::NUMBERS]);
            let numbers = &state.account[c * Account::NUMBERS..(c + 1) * Account::NUMBERS];
            contacts.account.put(c, Account::from_numbers(numbers));
        }
        for (axis, numbers) in contacts.stretch.iter_mut().zip(state.stretch.chunks(count.max(1))) {
            axis.copy_from_slice(numbers);
        }
        contacts.extra = state.extra;
        let kept = |numbers: &[f64]| {
            let [work, friction_work, weight, memory @ ..] = numbers else { return None };
            (memory.len() == L::NUMBERS).then(|| Kept {
                memory: L::from_numbers(memory),
                work: *work,
                friction_work: *friction_work,
                weight: *weight,
            })
        };
        for (ends, shift, numbers) in &state.kept_pairs {
            let Some(kept) = kept(numbers) else { return false };
            fits &= ends.iter().all(|&i| known(i));
            contacts.kept_pairs.insert((*ends, image(shift)), kept);
        }
        for (face, numbers) in &state.kept_faces {
            let Some(kept) = kept(numbers) else { return false };
            fits &= face_known(face);
            contacts.kept_faces.insert((face.0, facing(face.1, face.2)), kept);
        }
        contacts.lost = state.lost;
        contacts.lost_by_sphere = state.lost_by_sphere;
        (self.count, self.at_hand) = (state.count, state.at_hand);
        (self.work_in, self.absorbed, self.held_back) = (state.work_in, state.absorbed, state.held_back);
        let b = &mut self.bodies;
        let m = &state.motion;
        let clusters = &m.clusters;
        let arrays = [
            (b.displacement.as_flattened_mut(), &m.displacement),
            (b.velocity.as_flattened_mut(), &m.velocity),
            (b.acceleration.as_flattened_mut(), &m.acceleration),
            (b.spin.numbers_mut(), &m.spin),
            (b.spin_rate.numbers_mut(), &m.spin_rate),
            (b.flat_moved.as_flattened_mut(), &m.flat_moved),
            (b.flat_velocity.as_flattened_mut(), &m.flat_velocity),
            (b.flat_acceleration.as_flattened_mut(), &m.flat_acceleration),
            (self.seen.as_flattened_mut(), &m.seen),
            (self.flat_seen.as_flattened_mut(), &m.flat_seen),
            (&mut self.finder.skin[..], &m.skin),
            (self.sums.force.as_flattened_mut(), &m.force),
            (self.sums.torque.numbers_mut(), &m.torque),
            (self.sums.flat.as_flattened_mut(), &m.flat_force),
        ];
        fits &= clusters.len() == b.clusters.len() * ClusterState::<D>::NUMBERS;
        for (array, numbers) in arrays {
            fits &= array.len() == numbers.len();
            if fits {
                array.copy_from_slice(numbers);
            }
        }
        if fits {
            let parts = clusters.chunks(ClusterState::<D>::NUMBERS);
            b.clusters = parts.map(ClusterState::from_numbers).collect();
        }
        match &mut self.past {
            Some(past) => fits && state.past.as_ref().is_some_and(|accelerations| past.restore(accelerations)),
            None => fits && state.past.is_none(),
        }
    }
}
