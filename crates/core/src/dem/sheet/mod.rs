//! Large hexagonal sheets of equal elastic spheres: Hertz contacts between fixed neighbours, materials mixed at will.
//!
//! In: a [`Grid`] (where the spheres lie), materials for every sphere, and a step. Out: a [`Sheet`] that is advanced and looked
//! at. Where [`simulate`](super::simulate) follows lists of contacts under any law with full records, a sheet follows one
//! law by a stencil: neighbours are known by their places, nothing is looked up but materials, and force, kick and drift are one
//! pass through memory (36 bytes a sphere). One crystal has its columns side by side in the vector registers; several
//! crystals on one grid have a lane each. Rows that the wave has not reached are not swept.
//!
//! The scheme is velocity Verlet as everywhere in [`dem`](super) (Hertz's law knows no velocity, so that the two half kicks
//! between two sweeps can be one): places agree with the other simulators to rounding. The bits depend neither on
//! the number of threads nor on the width of the registers nor on the crystals beside.
//!
//! - `grid`: where the spheres lie, and where their numbers stand
//! - `sweep`: one step of some rows
//! - `kinds`: which materials stand and meet where; `numbers`: memory in cache lines
//! - `look`: energies and velocities; `stop`: what is refused, and what stops a run
//!
//! ```
//! use granulens_core::dem::sheet::{Grid, Sheet, Sides};
//! use granulens_core::material::find;
//! use granulens_core::real::Width;
//!
//! let grid = Grid { rows: 40, columns: [30; 2], diameter: 6.35e-3, spacing: 6.35e-3, sides: Sides::Periodic, joined: false };
//! let metals = [find("440c", &[]).unwrap(), find("brass", &[]).unwrap()];
//! let mixed: Vec<u8> = (0..grid.len()).map(|k| (k % 7 == 0) as u8).collect();
//! let mut sheet = Sheet::new(grid, &metals, &[&mixed], 1e-7, Width::widest()).unwrap();
//! sheet.strike(1.0, 20e-6, &(0..30).collect::<Vec<_>>());
//! sheet.advance(1000, 1).unwrap();
//! assert!(sheet.kinetic_energy(0) > 0.0);
//! ```

mod grid;
pub(super) mod kinds;
mod look;
pub(super) mod numbers;
mod stop;
mod sweep;
#[cfg(test)]
mod tests;

pub use grid::{Grid, GridError, Sides};
pub use stop::{SheetError, SheetStop};

use grid::Store;
use kinds::{Kinds, kind};
use numbers::Numbers;
use sweep::{Band, Fixed, Part, RowForce, Rows, Seam};

use super::share::each_of;
use super::{ForcePulse, stable_step};
use crate::contact::{Constants, Hertz, NormalLaw as _, OVERLAP_LIMIT, Pair};
use crate::material::Material;
use crate::real::Width;

/// Displacements in diameters, and displacements per step as of half a step before.
#[derive(Clone, Debug)]
struct State {
    x: Numbers,
    z: Numbers,
    step_x: Numbers,
    step_z: Numbers,
}

/// Work space of a band of rows: what its first row feels from above and its last from below, and two rows in turn.
#[derive(Clone, Debug)]
struct Room {
    above: RowForce,
    below: RowForce,
    turns: [RowForce; 2],
}

/// One crystal, or several on one grid, in motion.
#[derive(Clone, Debug)]
pub struct Sheet {
    grid: Grid,
    designs: usize,
    width: Width,
    step: f64,
    fixed: Fixed,
    /// Mass of each kind of sphere (kg); the first is nothing.
    mass: [f64; 16],
    state: State,
    fastest: Option<Numbers>,
    pulse: ForcePulse,
    struck: Vec<usize>,
    steps: u64,
    /// Whether velocities have been put half a step back.
    begun: bool,
    /// Rows from here on are at rest and carry no force.
    reached: usize,
    rooms: Vec<Room>,
    /// Greatest overlap so far over the diameter, and of the stiffest kind of pair k (N/m^{3/2}).
    deepest: f64,
    stiffest: f64,
}

impl Sheet {
    /// Crystals at rest, side by side: for each the material of every sphere, row by row, as a place in `materials`. `step` is in
    /// seconds. A lone crystal makes use of the width in its rows.
    ///
    /// # Errors
    /// See [`SheetError`].
    pub fn new(
        grid: Grid,
        materials: &[Material],
        designs: &[&[u8]],
        step: f64,
        width: Width,
    ) -> Result<Self, SheetError> {
        grid.check()?;
        let lanes = width.lanes();
        if designs.is_empty() || designs.len() > lanes.max(1) {
            return Err(SheetError::Designs { designs: designs.len(), lanes });
        }
        for (k, design) in designs.iter().enumerate() {
            if design.len() != grid.len() {
                return Err(SheetError::Length { design: k + 1, given: design.len(), spheres: grid.len() });
            }
        }
        let used = designs.iter().flat_map(|design| design.iter()).copied().max().map_or(0, usize::from);
        if materials.len() > 5 || used >= materials.len() {
            return Err(SheetError::Materials { materials: materials.len(), used });
        }
        if !(step > 0.0 && step.is_finite()) {
            return Err(SheetError::Step(step));
        }
        let store = Store::new(&grid, if designs.len() > 1 { lanes } else { 1 }, lanes);
        let (mut stiffness, mut response, mut mass) = ([0.0; 16], [0.0; 16], [0.0; 16]);
        for (a, first) in materials.iter().enumerate() {
            mass[a + 1] = first.sphere_mass(grid.diameter);
            response[a + 1] = step * step * grid.diameter.sqrt() / mass[a + 1];
            for (b, second) in materials.iter().enumerate() {
                let pair = Pair::new([first, second], [0.5 * grid.diameter; 2], Constants::default());
                stiffness[usize::from(kind(a as u8, b as u8))] = Hertz::new(&pair).coefficient;
            }
        }
        let kinds = Kinds::new(&grid, &store, designs);
        let length = grid.rows * store.stride;
        let zero = || Numbers::zero(length);
        let spacing = grid.spacing / grid.diameter;
        let at_rest = grid.spacing == grid.diameter && !grid.joined;
        Ok(Self {
            grid,
            designs: designs.len(),
            width,
            step,
            mass,
            state: State { x: zero(), z: zero(), step_x: zero(), step_z: zero() },
            fastest: None,
            pulse: ForcePulse { force: 0.0, duration: 0.0 },
            struck: Vec::new(),
            steps: 0,
            begun: false,
            reached: if at_rest { 0 } else { grid.rows },
            rooms: Vec::new(),
            deepest: 1.0 - spacing,
            stiffest: stiffness.iter().copied().fold(0.0, f64::max),
            fixed: Fixed { store, kinds, spacing, stiffness, response },
        })
    }

    /// Strikes spheres of the first row or others with a force (N) along the depth for some time (s) from the start on. The
    /// force of the step that it ends within is scaled, so that the impulse is exact.
    pub fn strike(&mut self, force: f64, duration: f64, spheres: &[usize]) {
        self.pulse = ForcePulse { force, duration };
        let sites: Vec<[usize; 2]> = self.grid.sites().collect();
        self.struck.clear();
        for &sphere in spheres {
            let [row, column] = sites[sphere];
            let at = self.fixed.store.at(row, column);
            self.struck.extend(at..at + self.fixed.store.site);
            self.reached = self.reached.max(row + 1);
        }
    }

    /// Keeps from here on the greatest kinetic energy of each sphere; see [`greatest_kinetic`](Self::greatest_kinetic).
    pub fn watch_speeds(&mut self) {
        if self.fastest.is_none() {
            self.fastest = Some(Numbers::zero(self.state.x.length));
        }
    }

    /// Sets every sphere of every crystal in motion; to be called before the first step. Velocities in m/s, row by row.
    pub fn set_velocities(&mut self, velocity: &[[f64; 2]]) {
        let per_step = self.step / self.grid.diameter;
        for ([row, column], velocity) in self.grid.sites().zip(velocity) {
            if *velocity != [0.0; 2] {
                self.reached = self.reached.max(row + 1);
            }
            let at = self.fixed.store.at(row, column);
            for lane in at..at + self.fixed.store.site {
                self.state.step_x.get_mut()[lane] = velocity[0] * per_step;
                self.state.step_z.get_mut()[lane] = velocity[1] * per_step;
            }
        }
    }

    /// Steps done so far.
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// Where the spheres lie.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Advances all crystals by so many steps, with the rows shared out among as many threads of the current pool as `bands`
    /// says. The bits do not depend on it.
    ///
    /// # Errors
    /// What makes the result worthless; looked at every 64 steps and at the end.
    pub fn advance(&mut self, steps: u64, bands: usize) -> Result<(), SheetStop> {
        const WATCH: u64 = 64;
        if !self.begun {
            // Velocities are kept half a step behind.
            self.pass(Part { kick: -0.5, drift: 0.0 }, 1, false);
            self.begun = true;
        }
        let mut load = if self.steps == 0 { 0.0 } else { self.pulse.during(self.steps - 1, self.step) };
        for k in 0..steps {
            // The force of a step acts half before and half after its middle.
            self.push(load, false);
            self.pass(Part { kick: 1.0, drift: 1.0 }, bands, true);
            load = self.pulse.during(self.steps, self.step);
            self.push(load, true);
            self.steps += 1;
            if k % WATCH == WATCH - 1 || k + 1 == steps {
                self.check()?;
            }
        }
        Ok(())
    }

    /// Half a step's kick by the load; where it comes before the drift, the drift follows it.
    fn push(&mut self, load: f64, drifts: bool) {
        if load == 0.0 {
            return;
        }
        for &at in &self.struck {
            let mass = self.mass[usize::from(self.fixed.kinds.sphere[at])];
            let change = 0.5 * load * self.step * self.step / (mass * self.grid.diameter);
            self.state.step_z.get_mut()[at] += change;
            if drifts {
                self.state.z.get_mut()[at] += change;
            }
        }
        if drifts && self.grid.sides != Sides::Open {
            self.refresh_images();
        }
    }

    /// Copies spheres to their images, in all rows that have been reached.
    fn refresh_images(&mut self) {
        let Store { stride, site, ref ghosts, .. } = self.fixed.store;
        let (x, z) = (self.state.x.get_mut(), self.state.z.get_mut());
        for row in 0..self.reached {
            let here = row * stride..(row + 1) * stride;
            sweep::place_images(&ghosts[row % 2], site, &mut x[here.clone()], &mut z[here]);
        }
    }

    /// One pass over all rows that the wave has reached and the next one.
    fn pass(&mut self, part: Part, bands: usize, watch: bool) {
        let Store { stride, swept, .. } = self.fixed.store;
        let rows = (self.reached + 1).min(self.grid.rows);
        // Bands of two rows at least.
        let bands = bands.clamp(1, (rows / 2).max(1));
        let first = |band: usize| band * rows / bands;
        let zero = || RowForce::zero(stride);
        if self.rooms.len() != bands {
            // Anew: the outermost ones feel nothing from outside, and nothing is ever written there.
            let room = || Room { above: zero(), below: zero(), turns: [zero(), zero()] };
            self.rooms = (0..bands).map(|_| room()).collect();
        }

        // Bonds between bands, at the positions that both sides have now.
        for band in 0..bands {
            let last = first(band + 1) - 1;
            let (next, lower) = if band + 1 < bands { (band + 1, last + 1) } else { (0, 0) };
            if band + 1 == bands && !(self.grid.joined && rows == self.grid.rows) {
                continue;
            }
            let (mut on_upper, mut on_lower) =
                (std::mem::take(&mut self.rooms[band].below), std::mem::take(&mut self.rooms[next].above));
            let (x, z) = (self.state.x.get(), self.state.z.get());
            let row = |k: usize| [&x[k * stride..(k + 1) * stride], &z[k * stride..(k + 1) * stride]];
            self.width.run(Seam {
                fixed: &self.fixed,
                row: last,
                upper: row(last),
                lower: row(lower),
                on_upper: &mut on_upper,
                on_lower: &mut on_lower,
            });
            (self.rooms[band].below, self.rooms[next].above) = (on_upper, on_lower);
        }

        let mut jobs = Vec::with_capacity(bands);
        let [mut x, mut z, mut step_x, mut step_z] = {
            let State { x, z, step_x, step_z } = &mut self.state;
            [x.get_mut(), z.get_mut(), step_x.get_mut(), step_z.get_mut()]
        };
        let mut fastest = self.fastest.as_mut().filter(|_| watch).map(Numbers::get_mut);
        for (band, room) in self.rooms.iter_mut().enumerate() {
            let length = (first(band + 1) - first(band)) * stride;
            let rows = Rows {
                x: front(&mut x, length),
                z: front(&mut z, length),
                step_x: front(&mut step_x, length),
                step_z: front(&mut step_z, length),
                fastest: fastest.as_mut().map(|fastest| front(fastest, length)),
            };
            jobs.push(Band {
                fixed: &self.fixed,
                first: first(band),
                rows,
                above: &room.above,
                below: &room.below,
                buffers: &mut room.turns,
                part,
            });
        }
        let excess = if bands == 1 {
            jobs.into_iter().map(|job| self.width.run(job)).fold(0.0, f64::max)
        } else {
            let width = self.width;
            let found = each_of(jobs, |job| width.run(job));
            found.into_iter().fold(0.0, f64::max)
        };
        self.deepest = self.deepest.max(1.0 - (1.0 - excess).max(0.0).sqrt());
        if rows > self.reached {
            let last = (rows - 1) * stride..(rows - 1) * stride + swept;
            let moves = |numbers: &Numbers| numbers.get()[last.clone()].iter().any(|&step| step != 0.0);
            if moves(&self.state.step_x) || moves(&self.state.step_z) {
                self.reached = rows;
            }
        }
    }

    fn check(&self) -> Result<(), SheetStop> {
        let time_s = self.steps as f64 * self.step;
        if self.deepest > OVERLAP_LIMIT {
            return Err(SheetStop::Overlap { overlap_ratio: self.deepest, time_s });
        }
        let finite = |numbers: &Numbers| numbers.get().iter().all(|step| step.is_finite());
        if !(finite(&self.state.step_x) && finite(&self.state.step_z)) {
            return Err(SheetStop::NotFinite { time_s });
        }
        let law = Hertz { coefficient: self.stiffest };
        let force = self.stiffest * (self.deepest * self.grid.diameter).powf(1.5);
        let lightest = self.mass.iter().copied().filter(|&mass| mass > 0.0).fold(f64::INFINITY, f64::min);
        let limit_s = stable_step::<2>(law.stiffness_max(force), lightest);
        if self.step > limit_s {
            return Err(SheetStop::Step { step_s: self.step, limit_s, time_s });
        }
        Ok(())
    }
}

/// Splits the first numbers off a slice.
fn front<'a>(rest: &mut &'a mut [f64], length: usize) -> &'a mut [f64] {
    let (front, back) = std::mem::take(rest).split_at_mut(length);
    *rest = back;
    front
}
