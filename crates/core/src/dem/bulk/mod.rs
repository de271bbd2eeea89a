//! One large crystal in space: equal spheres in rows of a lattice, materials mixed at will, any contact law, neighbours fixed.
//!
//! In: a [`Sample`] and an [`Impact`], as for [`simulate`](super::simulate). Out: a [`Bulk`] that is advanced and looked at, and the same
//! [`Record`]. Where `simulate` follows a list of contacts, here two rows that lie alike have all their contacts alike, so that
//! nothing is looked up: contacts stand along the rows in the vector registers, with what they remember beside them in memory, and forces
//! and motion are one pass through it. Rows that the wave has not reached are not visited. Laws, loads, the schemes of Verlet and Adams,
//! mirrors and periods are those of `simulate`, with which it agrees to rounding; the bits depend neither on the number of threads nor
//! on the width of the registers.
//!
//! - `rows`: the rows of a sample, who touches whom, and who does not
//! - `section`: rows with all that belongs to them in memory, and the seams between sections
//! - `sweep`: one step of a section or a seam; `motion`: how its rows move
//! - `strangers`: spheres that are no neighbours and meet all the same
//! - `guard`: what stops a run; `look`: what it came to; `checkpoint`: all that the rest of it depends on

mod checkpoint;
mod guard;
mod look;
mod motion;
mod rows;
mod section;
mod strangers;
mod sweep;
#[cfg(test)]
mod tests;

pub use checkpoint::BulkCheckpointError;
pub use rows::RowsError;

use std::marker::PhantomData;

use rows::Neighbours;
use section::{Cut, Keep, LEAST, Seam, Section, Store, cut};
use strangers::Strangers;
use sweep::{SeamStep, SectionStep, Terms};

use super::arrival::{ArrivalTracker, Grain};
use super::record::ARRIVAL;
use super::share::each_of;
use super::sheet::kinds::kind;
use super::sheet::numbers::Numbers;
use super::step::Coefficients;
use super::{Impact, Integrator, Record, Stop, steps_in};
use crate::Context;
use crate::contact::{AnyLaw, LaneLaw, Pair, WithLaw};
use crate::material::Material;
use crate::real::Width;
use crate::sample::Sample;

/// What is kept of a run besides motion, greatest speeds and forces.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Recording {
    /// Work and losses contact by contact, for the energy ledger: 24 bytes a contact.
    pub energies: bool,
    /// First arrivals.
    pub arrivals: Arrivals,
}

/// Which first arrivals are recorded.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Arrivals {
    /// None.
    #[default]
    None,
    /// When a speed (m/s) was first reached: 8 bytes a sphere.
    Speed(f64),
    /// When 1 % of each sphere's own greatest speed was first reached: some 0.3 kB a sphere in a wave, 1 kB at most.
    OwnMaximum,
}

/// A crystal that is not followed by its rows.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BulkError {
    /// Its spheres.
    #[error(transparent)]
    Rows(#[from] RowsError),
    /// More materials than tables of laws hold.
    #[error("{0} materials; up to five are followed")]
    Materials(usize),
    /// A scheme with several sweeps a step.
    #[error("the scheme rk4; verlet and adams are known here")]
    Scheme,
    /// Planes and walls across no axis.
    #[error("planes or walls across no axis; those across x, y and z are known here")]
    Faces,
    /// A step that is no positive number.
    #[error("a step of {0} s must be positive")]
    Step(f64),
}

/// A crystal in motion.
#[derive(Clone, Debug)]
pub struct Bulk {
    materials: Vec<Material>,
    impact: Impact,
    recording: Recording,
    width: Width,
    found: Neighbours,
    terms: Terms,
    /// The law of each kind of pair; the first is none.
    laws: Vec<AnyLaw>,
    sections: Vec<Section>,
    seams: Vec<Seam>,
    home: Vec<[u32; 2]>,
    strangers: Strangers,
    steps: u64,
    /// Work of the load so far, and in the step to come (J).
    work: [f64; 2],
    exit: [f64; 2],
    /// The greatest force so far for which each kind of pair has been judged (N).
    judged: Vec<f64>,
    stiffest: Option<Stiffest>,
}

/// The contact that asks for the finest step so far.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stiffest {
    /// Its spheres, indices.
    pub spheres: [usize; 2],
    /// The greatest stiffness that it can show after what it has carried (N/m).
    pub stiffness: f64,
    /// m₁ m₂/(m₁ + m₂) (kg)
    pub reduced_mass: f64,
}

/// Crystals of so many spheres are followed by their rows where it is left to the program.
pub const MANY: usize = 20_000;

impl Bulk {
    /// A crystal at rest, or moving as the impact says.
    ///
    /// # Errors
    /// See [`BulkError`]: what is refused here [`simulate`](super::simulate) follows.
    pub fn new(sample: &Sample<3>, impact: &Impact, recording: Recording, width: Width) -> Result<Self, BulkError> {
        Self::cut(sample, impact, recording, width, LEAST)
    }

    /// With so few spheres in a section.
    fn cut(
        sample: &Sample<3>,
        impact: &Impact,
        recording: Recording,
        width: Width,
        least: usize,
    ) -> Result<Self, BulkError> {
        if impact.integrator == Integrator::Rk4 {
            return Err(BulkError::Scheme);
        }
        if !impact.faces.is_empty() {
            return Err(BulkError::Faces);
        }
        if !(impact.step > 0.0 && impact.step.is_finite()) {
            return Err(BulkError::Step(impact.step));
        }
        let mut used: Vec<usize> = Vec::new();
        for sphere in &sample.spheres {
            if used.last() != Some(&sphere.material) && !used.contains(&sphere.material) {
                used.push(sphere.material);
            }
        }
        if used.len() > 5 {
            return Err(BulkError::Materials(used.len()));
        }
        used.sort_unstable();
        let materials: Vec<Material> = used.iter().map(|&material| sample.materials[material].clone()).collect();
        let mut place = vec![0_u8; sample.materials.len()];
        used.iter().zip(1..).for_each(|(&material, number)| place[material] = number);
        let mut found = Neighbours::find(sample, &impact.mirrors, &impact.periods)?;
        let (laws, tables) = laws(&materials, impact, found.diameter);
        let keep = Keep {
            own: impact.law.own_memory().is_some(),
            accounts: recording.energies,
            past: impact.integrator == Integrator::Adams,
        };
        let arrivals = match recording.arrivals {
            Arrivals::None => section::Arrivals::None,
            Arrivals::Speed(speed) => section::Arrivals::Speed(speed, Vec::new()),
            Arrivals::OwnMaximum => section::Arrivals::Own(Vec::new()),
        };
        let material = |sphere: usize| place[sample.spheres[sphere].material];
        let Cut { sections, seams, home } = cut(&found, least, keep, &material, &impact.struck, &arrivals);
        let mut inverse_mass = [0.0; 16];
        for (material, inverse) in materials.iter().zip(&mut inverse_mass[1..]) {
            *inverse = 1.0 / material.sphere_mass(found.diameter);
        }
        let terms = Terms {
            offsets: std::mem::take(&mut found.offsets),
            diameter: found.diameter,
            tables,
            inverse_mass,
            step: impact.step,
            coefficients: Coefficients::of(impact.integrator, impact.step),
            steps: 0,
            time: 0.0,
            grain: Grain::of(sample.spheres.len(), ARRIVAL),
            load_now: [0.0; 2],
            load: [0.0; 2],
        };
        let strangers = Strangers::new(&found, &terms.offsets);
        let judged = vec![0.0; laws.len()];
        let mut bulk = Self {
            materials,
            impact: impact.clone(),
            recording,
            width,
            found,
            terms,
            laws,
            sections,
            seams,
            home,
            strangers,
            steps: 0,
            work: [0.0; 2],
            exit: [0.0; 2],
            judged,
            stiffest: None,
        };
        bulk.begin();
        Ok(bulk)
    }

    /// The load (N) in a step, along the last axis and the first.
    fn load(&self, step: u64) -> [f64; 2] {
        let load = self.impact.pulse.during(step, self.impact.step);
        [load, self.impact.slope * load]
    }

    /// Sets in motion what moves at the start, and predicts the first step.
    fn begin(&mut self) {
        self.terms.load = self.load(0);
        for (i, speed) in self.impact.moving.clone() {
            let (section, place, row) = self.place(i);
            let section = &mut self.sections[section];
            section.predicted[2].get_mut()[place] = speed;
            section.x[2].get_mut()[place] = self.terms.step * speed;
            (section.active[row], section.any_active) = (true, true);
            let mass = 1.0 / self.terms.inverse_mass[usize::from(section.kinds[place])];
            self.work[0] += 0.5 * (section.weight(place) * mass) * speed * speed;
        }
        self.push_first();
    }

    /// The load's part in the first step.
    fn push_first(&mut self) {
        if self.terms.load == [0.0; 2] {
            return;
        }
        for section in &mut self.sections {
            for row in 0..section.rows.len() {
                let struck = section.rows[row].struck;
                if struck[0] < struck[1] {
                    (section.active[row], section.any_active) = (true, true);
                    section.work -= section.pushed(struck, self.terms.load);
                    section.strike(&self.terms, struck);
                    section.work += section.pushed(struck, self.terms.load);
                }
            }
            self.work[1] += section.work;
        }
    }

    /// Sets every sphere in motion (m/s), by its index; before the first step, in place of what the impact says.
    pub fn set_velocities(&mut self, velocity: impl Fn(usize) -> [f64; 3]) {
        debug_assert_eq!(self.steps, 0, "spheres are set in motion before the first step");
        let work = self.work[1];
        for section in &mut self.sections {
            section.x.iter_mut().chain(&mut section.predicted).for_each(|numbers| numbers.get_mut().fill(0.0));
            section.active.fill(false);
            (section.any_active, section.work) = (false, 0.0);
        }
        self.work = [0.0; 2];
        for sphere in 0..self.len() {
            let velocity = velocity(sphere);
            if velocity == [0.0; 3] {
                continue;
            }
            let (section, place, row) = self.place(sphere);
            let section = &mut self.sections[section];
            let mobility = section.mobility(place);
            let mass = 1.0 / self.terms.inverse_mass[usize::from(section.kinds[place])];
            for axis in (0..3).filter(|&axis| mobility[axis] != 0.0) {
                section.predicted[axis].get_mut()[place] = velocity[axis];
                section.x[axis].get_mut()[place] = self.terms.step * velocity[axis];
                self.work[0] += 0.5 * (section.weight(place) * mass) * velocity[axis] * velocity[axis];
            }
            (section.active[row], section.any_active) = (true, true);
        }
        if work != 0.0 {
            self.push_first();
        }
    }

    /// Section of a sphere, its place there, and its row.
    fn place(&self, sphere: usize) -> (usize, usize, usize) {
        let row = self.found.rows.partition_point(|row| row.first <= sphere) - 1;
        let [section, in_section] = self.home[row].map(|index| index as usize);
        (section, self.sections[section].rows[in_section].place + sphere - self.found.rows[row].first, in_section)
    }

    /// The contact that asks for the finest step, as last looked at.
    pub fn stiffest(&self) -> Option<Stiffest> {
        self.stiffest
    }

    /// Spheres.
    pub fn len(&self) -> usize {
        self.found.rows.last().map_or(0, |row| row.first + row.count)
    }

    /// Never: a crystal has spheres.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Bytes that it occupies per sphere.
    pub fn bytes_per_sphere(&self) -> f64 {
        let numbers = |numbers: &Numbers| 8 * numbers.length;
        let store = |store: &Store| numbers(&store.numbers) + store.kinds.len();
        let of_section = |section: &Section| {
            let motion = section.x.iter().chain(&section.predicted).chain(&section.force);
            let arrivals = match &section.arrivals {
                section::Arrivals::None => 0,
                section::Arrivals::Speed(_, times) => 8 * times.len(),
                section::Arrivals::Own(trackers) => trackers.iter().map(ArrivalTracker::bytes).sum(),
            };
            motion
                .chain([&section.past, &section.speed_squared, &section.acceleration_squared])
                .map(numbers)
                .sum::<usize>()
                + section.kinds.len()
                + store(&section.store)
                + size_of_val(&section.rows[..])
                + size_of_val(&section.bundles[..])
                + size_of_val(&section.images[..])
                + size_of_val(&section.on_mirrors[..])
                + arrivals
        };
        let of_seam = |seam: &Seam| {
            seam.on_upper.iter().chain(&seam.on_lower).map(numbers).sum::<usize>()
                + store(&seam.store)
                + size_of_val(&seam.bundles[..])
        };
        let found = size_of_val(&self.found.rows[..])
            + size_of_val(&self.found.contacts[..])
            + size_of_val(&self.found.strangers[..])
            + size_of_val(&self.found.on_mirrors[..])
            + size_of_val(&self.home[..]);
        let all = self.sections.iter().map(of_section).sum::<usize>() + self.seams.iter().map(of_seam).sum::<usize>();
        (all + found) as f64 / self.len() as f64
    }

    /// Steps done so far.
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// Time at the last accepted step (s).
    pub fn time(&self) -> f64 {
        self.steps as f64 * self.impact.step
    }

    /// Advances by so many steps, on the threads of the current pool. `context` is asked before each.
    ///
    /// # Errors
    /// What makes the result worthless, or the request to stop. What stops a run does not depend on how it was cut into calls.
    pub fn advance(&mut self, steps: u64, context: &Context) -> Result<(), Stop> {
        for _ in 0..steps {
            if context.stopped() {
                return Err(Stop::Interrupted { time_s: self.time() });
            }
            self.advance_one()?;
        }
        Ok(())
    }

    fn advance_one(&mut self) -> Result<(), Stop> {
        self.terms.steps = self.steps + 1;
        self.terms.time = (self.steps + 1) as f64 * self.impact.step;
        self.terms.load_now = self.terms.load;
        self.terms.load = self.load(self.steps + 1);
        let fastest = self.impact.law.choose(OneStep(self));
        self.steps += 1;
        self.work[0] += self.work[1];
        self.work[1] = self.sections.iter().map(|section| section.work).sum();
        self.see_exit();
        self.watch(fastest)
    }
}

/// An impact from start to end, recorded as [`simulate`](super::simulate) does. None where this is no crystal of rows, or ceases to be one.
pub(super) fn recorded(sample: &Sample<3>, impact: &Impact, context: &Context) -> Option<Record<3>> {
    let recording = Recording { energies: true, arrivals: Arrivals::OwnMaximum };
    let mut bulk = Bulk::new(sample, impact, recording, Width::widest()).ok()?;
    match bulk.advance(steps_in(impact.window, impact.step), context) {
        Err(Stop::Met { .. }) => None,
        done => Some(bulk.record(done.err())),
    }
}

/// The law of each kind of pair, and the tables from which lanes look up its numbers.
fn laws(materials: &[Material], impact: &Impact, diameter: f64) -> (Vec<AnyLaw>, Vec<[f64; 16]>) {
    struct Numbers<'a>(&'a [AnyLaw]);
    impl WithLaw<Vec<[f64; 16]>> for Numbers<'_> {
        fn with<L: LaneLaw>(self) -> Vec<[f64; 16]> {
            let mut tables = vec![[0.0; 16]; L::PARAMETERS];
            for (place, law) in self.0.iter().enumerate() {
                for (table, number) in tables.iter_mut().zip(L::parameters(law)) {
                    table[place] = number;
                }
            }
            tables
        }
    }
    let of = |a: usize, b: usize| {
        let pair = Pair::new([&materials[a], &materials[b]], [0.5 * diameter; 2], impact.constants);
        AnyLaw::new(impact.law, &pair)
    };
    // Where there is no pair the first law stands, which is asked and not heard.
    let mut laws = vec![of(0, 0); 16];
    for a in 0..materials.len() {
        for b in 0..=a {
            laws[usize::from(kind(a as u8, b as u8))] = of(a, b);
        }
    }
    let tables = impact.law.choose(Numbers(&laws));
    (laws, tables)
}

/// One step under a law, the greatest v² after it.
struct OneStep<'a>(&'a mut Bulk);

impl WithLaw<f64> for OneStep<'_> {
    fn with<L: LaneLaw>(self) -> f64 {
        let Bulk { terms, sections, seams, width, .. } = self.0;
        let (terms, width, law) = (&*terms, *width, PhantomData::<L>);
        let active: Vec<bool> = sections.iter().map(|section| section.any_active).collect();
        let mut jobs = Vec::new();
        for (k, seam) in seams.iter_mut().enumerate().filter(|(k, seam)| active[*k] || active[k + 1] || seam.acts) {
            jobs.push(SeamStep { terms, seam, sides: [&sections[k], &sections[k + 1]], law });
        }
        each(jobs, |job| width.run(job));
        let mut jobs = Vec::new();
        let count = sections.len();
        for (k, section) in sections.iter_mut().enumerate() {
            let seams = [k.checked_sub(1).map(|k| &seams[k]), (k + 1 < count).then(|| &seams[k])];
            if active[k] || seams.iter().flatten().any(|seam| seam.acts) {
                jobs.push(SectionStep { terms, section, seams, law });
            } else {
                section.work = 0.0;
            }
        }
        each(jobs, |job| width.run(job)).into_iter().fold(0.0, f64::max)
    }
}

/// On several threads where there are some.
fn each<P: Send, T: Send>(jobs: Vec<P>, work: impl Fn(P) -> T + Sync) -> Vec<T> {
    if jobs.len() < 2 || rayon::current_num_threads() < 2 {
        return jobs.into_iter().map(work).collect();
    }
    each_of(jobs, work)
}
