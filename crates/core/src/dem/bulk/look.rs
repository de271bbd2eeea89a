//! What a run has come to: places, velocities, energies, and its record.

use super::section::{Arrivals, Bundle, IMAGE_WEIGHT, Placed, Section, Store, offset_of};
use super::{Bulk, each};
use crate::contact::{History, NormalLaw as _};
use crate::dem::record::ARRIVAL;
use crate::dem::{ContactRecord, Ledger, RESIDUAL_LIMIT, Record, Stop};

/// One contact.
pub(super) struct One<'a> {
    /// Its spheres, indices; the same twice for a sphere and its image.
    pub spheres: [usize; 2],
    pub weight: f64,
    pub in_store: &'a Store,
    /// Place of the store: the sections' first, then the seams'.
    pub store: usize,
    pub slot: u32,
    pub k: usize,
}

impl One<'_> {
    fn history(&self) -> History {
        let field = |field| self.in_store.get(self.slot, self.k, field);
        let own = if self.in_store.has_own { field(2) } else { 0.0 };
        History { overlap_max: field(0), force_max: field(1), own }
    }

    /// Overlap (m) and work so far (J); zero where none is kept.
    fn account(&self) -> [f64; 2] {
        if !self.in_store.has_account {
            return [0.0; 2];
        }
        let account = self.in_store.account();
        [account, account + 2].map(|field| self.in_store.get(self.slot, self.k, field))
    }
}

impl Placed {
    /// The sphere that stands at a place of the row's section.
    fn sphere_at(&self, place: u32) -> usize {
        self.first + place as usize - self.place
    }
}

impl Bulk {
    /// Visits all contacts that can have closed, section by section, then seam by seam.
    pub(super) fn each_contact(&self, visit: &mut dyn FnMut(&One<'_>)) {
        for part in 0..self.parts() {
            self.contacts_of(part, visit);
        }
    }

    /// Sections and seams.
    fn parts(&self) -> usize {
        self.sections.len() + self.seams.len()
    }

    /// The contacts of a section, or of a seam.
    fn contacts_of(&self, part: usize, visit: &mut dyn FnMut(&One<'_>)) {
        let weight = |bundle: &Bundle| offset_of(&self.terms.offsets, bundle).weight;
        let mut all = |count: u32, slot: u32, from: [usize; 2], weight: f64, in_store: &Store| {
            for k in 0..count as usize {
                visit(&One { spheres: from.map(|from| from + k), weight, in_store, store: part, slot, k });
            }
        };
        let Some(seam) = part.checked_sub(self.sections.len()) else {
            let section = &self.sections[part];
            for row in section.rows.iter().filter(|_| section.any_active) {
                for bundle in &section.bundles[row.bundles[0] as usize..row.bundles[1] as usize] {
                    let other = &section.rows[bundle.rows[1] as usize];
                    let from = [row.sphere_at(bundle.a), other.sphere_at(bundle.b)];
                    all(bundle.count, bundle.slot, from, weight(bundle), &section.store);
                }
                for image in &section.images[row.images[0] as usize..row.images[1] as usize] {
                    let weight = IMAGE_WEIGHT * image.part;
                    all(image.count, image.slot, [row.sphere_at(image.place); 2], weight, &section.store);
                }
            }
            return;
        };
        let [upper, lower] = [&self.sections[seam], &self.sections[seam + 1]];
        for bundle in self.seams[seam].bundles.iter().filter(|_| upper.any_active || lower.any_active) {
            let [a, b] = bundle.rows.map(|row| row as usize);
            let from = [upper.rows[a].sphere_at(bundle.a), lower.rows[b].sphere_at(bundle.b)];
            all(bundle.count, bundle.slot, from, weight(bundle), &self.seams[seam].store);
        }
    }

    /// Mass of a sphere (kg), also of those of which only a part is simulated.
    pub(super) fn mass(&self, sphere: usize) -> f64 {
        let (section, place, _) = self.place(sphere);
        self.mass_at(&self.sections[section], place)
    }

    fn mass_at(&self, section: &Section, place: usize) -> f64 {
        self.materials[usize::from(section.kinds[place]) - 1].sphere_mass(self.found.diameter)
    }

    /// Displacement (m) and velocity (m/s) of a sphere.
    fn state_of(&self, sphere: usize) -> [[f64; 3]; 2] {
        let (section, place, row) = self.place(sphere);
        let section = &self.sections[section];
        if !section.active[row] {
            return [[0.0; 3]; 2];
        }
        section.state(&self.terms, place, self.load_on(section, place))
    }

    /// The load that is predicted with (N).
    fn load_on(&self, section: &Section, place: usize) -> [f64; 2] {
        let is_struck = section.struck.binary_search(&(place as u32)).is_ok();
        if is_struck { self.terms.load } else { [0.0; 2] }
    }

    /// How far a sphere has moved (m).
    pub fn displacement(&self, sphere: usize) -> [f64; 3] {
        self.state_of(sphere)[0]
    }

    /// Velocity of a sphere (m/s).
    pub fn velocity(&self, sphere: usize) -> [f64; 3] {
        self.state_of(sphere)[1]
    }

    /// Greatest kinetic energy of each sphere so far (J).
    pub fn max_kinetic(&self) -> Vec<f64> {
        let energy = |(section, place): (&Section, usize)| {
            0.5 * self.mass_at(section, place) * section.speed_squared.get()[place]
        };
        self.places().map(energy).collect()
    }

    /// Section and place of each sphere, in the sample's order.
    fn places(&self) -> impl Iterator<Item = (&Section, usize)> {
        let of = |section| move |at| (section, at);
        self.sections.iter().flat_map(move |section| {
            section.rows.iter().flat_map(move |row| (row.place..row.place + row.count).map(of(section)))
        })
    }

    /// When each sphere was first reached (s), where that is recorded.
    pub fn arrivals(&self) -> Vec<Option<f64>> {
        let of = |(section, place): (&Section, usize)| match &section.arrivals {
            Arrivals::None => None,
            Arrivals::Speed(_, times) => Some(times[place]).filter(|time| !time.is_nan()),
            Arrivals::Own(trackers) => trackers[place].arrival(self.impact.step, ARRIVAL * trackers[place].maximum()?),
        };
        self.places().map(of).collect()
    }

    /// Spheres that the wave has reached, and all others of their rows.
    pub fn reached(&self) -> usize {
        let of = |section: &Section| -> usize {
            section.rows.iter().zip(&section.active).filter(|(_, active)| **active).map(|(row, _)| row.count).sum()
        };
        self.sections.iter().map(of).sum()
    }

    /// Momentum of the exit spheres along the last axis (kg m/s), and the contact force on them (N), at their greatest.
    pub(super) fn see_exit(&mut self) {
        let (mut momentum, mut force) = (0.0, 0.0);
        for &sphere in &self.impact.exit {
            let (section, place, row) = self.place(sphere);
            let section = &self.sections[section];
            if section.active[row] {
                let mass = self.mass_at(section, place) * section.weight(place);
                momentum += mass * self.velocity(sphere)[2];
                force += mass * section.past.get()[place / 8 * section.past_fields * 8 + 16 + place % 8];
            }
        }
        self.exit = [self.exit[0].max(momentum), self.exit[1].max(force)];
    }

    /// Where the energy is, with that of contacts where it is recorded.
    pub fn ledger(&self) -> Ledger {
        let parts = each((0..self.parts()).collect(), |part| {
            let mut ledger = Ledger::default();
            if let Some(section) = self.sections.get(part) {
                self.each_state(section, &mut |place, [_, velocity]| {
                    let mass = self.mass_at(section, place) * section.weight(place);
                    ledger.kinetic += 0.5 * mass * velocity.iter().map(|v| v * v).sum::<f64>();
                });
            }
            self.contacts_of(part, &mut |contact| {
                let history = contact.history();
                let [work, stored] = self.work_and_stored(contact, &history);
                ledger.stored += contact.weight * stored;
                ledger.dissipated += contact.weight * (work - stored);
                ledger.estimate += contact.weight * 0.5 * history.overlap_max * history.force_max;
            });
            ledger
        });
        let mut ledger = Ledger { work_in: self.work[0], ..Ledger::default() };
        for part in parts {
            ledger.kinetic += part.kinetic;
            ledger.stored += part.stored;
            ledger.dissipated += part.dissipated;
            ledger.estimate += part.estimate;
        }
        ledger
    }

    /// Displacement (m) and velocity (m/s) of the spheres of a section that the wave has reached, by their place.
    fn each_state(&self, section: &Section, visit: &mut dyn FnMut(usize, [[f64; 3]; 2])) {
        for (row, _) in section.rows.iter().zip(&section.active).filter(|(_, active)| **active) {
            for place in row.place..row.place + row.count {
                visit(place, section.state(&self.terms, place, self.load_on(section, place)));
            }
        }
    }

    /// What velocity Verlet holds back while forces act (J); see [`EnergyLedger::held_back`](crate::dem::rig::EnergyLedger::held_back).
    pub fn held_back(&self) -> f64 {
        let of = |section: &Section| {
            let mut sum = 0.0;
            for (row, _) in section.rows.iter().zip(&section.active).filter(|(_, active)| **active) {
                for place in row.place..row.place + row.count {
                    let mass = self.mass_at(section, place) * section.weight(place);
                    let now = &section.past.get()[place / 8 * section.past_fields * 8 + place % 8..];
                    sum += mass * [now[0], now[8], now[16]].iter().map(|a| a * a).sum::<f64>();
                }
            }
            0.125 * self.impact.step * self.impact.step * sum
        };
        each(self.sections.iter().collect(), of).into_iter().sum()
    }

    /// Greatest speed of each sphere so far (m/s).
    pub fn max_speed(&self) -> Vec<f64> {
        self.places().map(|(section, place)| section.speed_squared.get()[place].sqrt()).collect()
    }

    /// Velocity of every sphere (m/s), in the sample's order.
    pub fn velocities(&self) -> Vec<[f64; 3]> {
        let of = |section: &Section| {
            let mut at_places = vec![[0.0; 3]; section.kinds.len()];
            self.each_state(section, &mut |place, [_, velocity]| at_places[place] = velocity);
            let rows = section.rows.iter().flat_map(|row| at_places[row.place..row.place + row.count].iter().copied());
            rows.collect::<Vec<_>>()
        };
        each(self.sections.iter().collect(), of).into_iter().flatten().collect()
    }

    /// Greatest net contact force on each sphere so far (N).
    pub fn max_net_force(&self) -> Vec<f64> {
        let force = |(section, place): (&Section, usize)| {
            self.mass_at(section, place) * section.acceleration_squared.get()[place].sqrt()
        };
        self.places().map(force).collect()
    }

    /// Half of each contact's loss so far to each of its spheres (J), of whole spheres also where they lie on a mirror; where energies are recorded.
    pub fn dissipated(&self) -> Vec<f64> {
        let (mut dissipated, weight) = (vec![0.0; self.len()], self.weights());
        self.each_contact(&mut |contact| {
            let [work, stored] = self.work_and_stored(contact, &contact.history());
            for i in contact.spheres {
                dissipated[i] += 0.5 * (work - stored) * contact.weight / weight[i];
            }
        });
        dissipated
    }

    /// The part of each sphere that belongs to the simulated half.
    pub fn weights(&self) -> Vec<f64> {
        let mut weight = vec![1.0; self.len()];
        for sphere in &self.found.on_mirrors {
            weight[self.found.rows[sphere.row].first + sphere.at] = sphere.weight;
        }
        weight
    }

    /// Work of a contact so far, and what of it it would give back (J).
    fn work_and_stored(&self, contact: &One<'_>, history: &History) -> [f64; 2] {
        let [overlap, work] = contact.account();
        if overlap == 0.0 {
            return [work, 0.0];
        }
        let kind = contact.in_store.kinds[contact.slot as usize * 8 + contact.k];
        [work, self.laws[usize::from(kind)].stored(overlap, history)]
    }

    /// All that was recorded; `stop` is why the run ended early, if it did.
    pub fn record(&self, stop: Option<Stop>) -> Record<3> {
        let spheres = self.len();
        let mut max_contact_force = vec![0.0_f64; spheres];
        let mut contacts = Vec::new();
        self.each_contact(&mut |contact| {
            let history = contact.history();
            if history.overlap_max <= 0.0 {
                return;
            }
            let [work, stored] = self.work_and_stored(contact, &history);
            for i in contact.spheres {
                max_contact_force[i] = max_contact_force[i].max(history.force_max);
            }
            contacts.push(ContactRecord {
                spheres: contact.spheres,
                weight: contact.weight,
                overlap_max: history.overlap_max,
                force_max: history.force_max,
                work,
                stored,
            });
        });
        contacts.sort_by_key(|contact| (contact.spheres[0] == contact.spheres[1], contact.spheres));
        let ledger = self.ledger();
        let residual = ledger.residual().filter(|residual| self.recording.energies && residual.abs() > RESIDUAL_LIMIT);
        Record {
            max_kinetic: self.max_kinetic(),
            max_net_force: self.max_net_force(),
            max_contact_force,
            arrival: self.arrivals(),
            dissipated: self.dissipated(),
            contacts,
            ledger,
            exit_momentum: self.exit[0],
            exit_force: self.exit[1],
            projectile: None,
            displacement: (0..spheres).map(|i| self.displacement(i)).collect(),
            velocity: self.velocities(),
            steps: self.steps,
            stop: stop.or(residual.map(|residual| Stop::Residual { residual })),
        }
    }
}
