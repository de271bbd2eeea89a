//! What stops a run.

use super::section::{BLOCK, Store};
use super::{Bulk, Stiffest};
use crate::contact::{NormalLaw as _, OVERLAP_LIMIT};
use crate::dem::{Stop, stable_step};

/// Steps between two looks at contacts.
const WATCH: u64 = 64;

impl Bulk {
    /// After a step, with the greatest v² in it (m²/s²).
    pub(super) fn watch(&mut self, fastest: f64) -> Result<(), Stop> {
        let time_s = self.time();
        if !fastest.is_finite() {
            let sphere = self.first_without_speed();
            return Err(Stop::NotFinite { sphere: sphere + 1, time_s });
        }
        if fastest.sqrt() * self.impact.step > self.found.diameter {
            return Err(Stop::Leap { step_s: self.impact.step });
        }
        self.watch_strangers(fastest.sqrt())?;
        if self.steps.is_multiple_of(WATCH) {
            self.judge()?;
        }
        Ok(())
    }

    fn first_without_speed(&self) -> usize {
        let finite = |&i: &usize| self.velocity(i).iter().all(|v| v.is_finite());
        (0..self.len()).find(|i| !finite(i)).unwrap_or(0)
    }

    /// Looks at all contacts: whether any is deeper than its law says, or too stiff for the step. Speeds that are none end in no maximum.
    pub(super) fn judge(&mut self) -> Result<(), Stop> {
        let time_s = self.time();
        for section in self.sections.iter().filter(|section| section.any_active) {
            let numbers = section.predicted.iter().flat_map(|numbers| numbers.get());
            if !numbers.fold(0.0, |sum: f64, v| sum + 0.0 * v).eq(&0.0) {
                return Err(Stop::NotFinite { sphere: self.first_without_speed() + 1, time_s });
            }
        }
        // The greatest overlap and force of each kind of pair, and where.
        let mut deepest = [(0.0_f64, 0_usize, 0_usize); 16];
        let mut strongest = deepest;
        let stores =
            self.sections.iter().map(|section| &section.store).chain(self.seams.iter().map(|seam| &seam.store));
        for (at, store) in stores.enumerate() {
            for k in 0..store.kinds.len() {
                let [overlap, force] = memory(store, k);
                let kind = usize::from(store.kinds[k]);
                if overlap > deepest[kind].0 {
                    deepest[kind] = (overlap, at, k);
                }
                if force > strongest[kind].0 {
                    strongest[kind] = (force, at, k);
                }
            }
        }
        for kind in 1..16 {
            let (overlap, at, k) = deepest[kind];
            let overlap_ratio = overlap / self.found.diameter;
            let limit = self.laws[kind].overlap_limit();
            if overlap_ratio > OVERLAP_LIMIT && overlap_ratio > limit {
                let spheres = self.spheres_of(at, k);
                return Err(Stop::Overlap { spheres, overlap_ratio, limit, time_s });
            }
            let (force, at, k) = strongest[kind];
            if force <= self.judged[kind] {
                continue;
            }
            self.judged[kind] = force;
            let stiffness = self.laws[kind].stiffness_max(force);
            let spheres = self.spheres_of(at, k);
            let mass = spheres.map(|sphere| self.mass(sphere - 1));
            let reduced_mass = mass[0] * mass[1] / (mass[0] + mass[1]);
            if self.stiffest.is_none_or(|known| stiffness * known.reduced_mass > known.stiffness * reduced_mass) {
                let spheres = spheres.map(|sphere| sphere - 1);
                self.stiffest = Some(Stiffest { spheres, stiffness, reduced_mass });
            }
            let limit_s = self.impact.integrator.stability() * stable_step::<3>(stiffness, mass[0].min(mass[1]));
            if self.impact.step > limit_s {
                return Err(Stop::Step { step_s: self.impact.step, limit_s, stiffness, spheres, time_s });
            }
        }
        Ok(())
    }

    /// The spheres of contact `k` of a store, from 1; stores are those of the sections, then those of the seams.
    fn spheres_of(&self, store: usize, k: usize) -> [usize; 2] {
        let mut found = [0; 2];
        self.each_contact(&mut |contact| {
            if contact.store == store && contact.slot as usize * BLOCK + contact.k == k {
                found = contact.spheres.map(|sphere| sphere + 1);
            }
        });
        found
    }
}

/// Greatest overlap (m) and force (N) of contact `k` of a store.
fn memory(store: &Store, k: usize) -> [f64; 2] {
    let at = store.at(0, k);
    let numbers = store.numbers.get();
    [numbers[at], numbers[at + BLOCK]]
}
