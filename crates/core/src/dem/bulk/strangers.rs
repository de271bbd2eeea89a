//! Spheres that are no neighbours at rest may meet all the same; that none has is proven as the run goes.
//!
//! As long as no two of them can have come as far as they were apart when last looked at, nobody looks. Then all pairs that lie nearer than two
//! diameters at rest are looked at, strand by strand. For those further apart it is enough that no contact of the crystal is torn: a way of k
//! contacts leads to a sphere 0.7 k diameters away or further (in FCC; in HCP more), and where each of them is displaced by less than 0.3
//! diameters the ends come nearer by less than 0.3 k, so that more than one diameter is left from k = 3 on. Where contacts are torn, spheres
//! at their ends are looked for in the neighbourhood of all others.

use std::collections::{BTreeMap, BTreeSet};

use super::Bulk;
use super::rows::{Neighbours, Offset, Strand};
use super::section::Section;
use super::sweep::beyond;
use crate::dem::share::rows as rows_of;
use crate::dem::{Period, Stop};
use crate::real::{Kernel, Lanes};

/// Displacement of a contact over the diameter up to which it is sound, and from which on it counts as torn.
const SOUND: f64 = 0.3;
const TORN: f64 = 0.25;
/// Pairs nearer than this part of a diameter, surface to surface, are taken to meet.
const NEAR: f64 = 0.01;
/// How far from a torn end, centre to centre in diameters, others are looked for.
const AROUND: f64 = 1.3;
/// A quarter is added to what speeds at the accepted steps say of the way between them.
const BETWEEN: f64 = 1.25;

/// Row and place of a sphere at the end of a torn contact, and where it is (m).
type End = ([usize; 2], [f64; 3]);

/// When to look again.
#[derive(Clone, Copy, Debug)]
pub struct Strangers {
    /// How far the fastest spheres have come at most since the last look (m).
    pub way: f64,
    /// How far two of them may come towards each other until the next (m).
    pub room: f64,
}

impl Strangers {
    pub fn new(found: &Neighbours, offsets: &[Offset]) -> Self {
        let distance = |strand: &Strand| offsets[strand.offset].between.iter().map(|x| x * x).sum::<f64>().sqrt();
        let nearest = found.strangers.iter().map(distance).fold(2.0 * found.diameter, f64::min);
        let room = (nearest - found.diameter).min(SOUND * found.diameter);
        Self { way: 0.0, room }
    }
}

/// The least squared distance of the pairs of a strand (m²), and the greatest squared displacement against each other.
struct Look<'a> {
    offset: [f64; 3],
    sides: [&'a Section; 2],
    places: [usize; 2],
    count: usize,
}

impl Kernel for Look<'_> {
    type Output = [f64; 2];
    #[inline(always)]
    fn run<V: Lanes>(self) -> [f64; 2] {
        let Self { offset, sides: [a, b], places, count } = self;
        let (mut least, mut most) = (V::splat(f64::INFINITY), V::splat(0.0));
        let (a, b) = ([0, 1, 2].map(|k| &a.x[k].get()[places[0]..]), [0, 1, 2].map(|k| &b.x[k].get()[places[1]..]));
        for k in (0..count).step_by(V::LANES) {
            let (mut squared, mut moved) = (V::splat(0.0), V::splat(0.0));
            for axis in 0..3 {
                let shift = V::load(&b[axis][k..]) - V::load(&a[axis][k..]);
                let between = V::splat(offset[axis]) + shift;
                squared = squared + between * between;
                moved = moved + shift * shift;
            }
            if let Some(none) = beyond::<V>(count - k) {
                squared = squared + none;
                moved = V::select(squared.lt(V::splat(f64::INFINITY)), moved, V::splat(0.0));
            }
            (least, most) = (squared.min(least), moved.max(most));
        }
        let lanes = (0..V::LANES).map(|lane| least.lane(lane));
        [lanes.fold(f64::INFINITY, f64::min), most.greatest()]
    }
}

impl Bulk {
    /// Spheres have come by at most their greatest speed (m/s) in a step: looks whether strangers have met, where they can have.
    pub(super) fn watch_strangers(&mut self, speed: f64) -> Result<(), Stop> {
        let (step, diameter) = (self.impact.step, self.found.diameter);
        self.strangers.way += BETWEEN * speed * step;
        // What is seen is where spheres will be after the next step.
        if 2.0 * (self.strangers.way + BETWEEN * speed * step) < self.strangers.room {
            return Ok(());
        }
        let nearest = self.nearest_strangers();
        let mut room = self.images_apart()?.min(nearest.0 - diameter);
        if room < NEAR * diameter {
            let spheres = self.pair_within(&nearest.1, nearest.0 * (1.0 + 1e-9));
            return Err(Stop::Met { spheres, time_s: self.time() });
        }
        let (stretch, torn) = self.torn();
        room = room.min((SOUND * diameter - stretch).max((SOUND - TORN) * diameter));
        if !torn.is_empty() {
            room = room.min(self.around(&torn)? - diameter);
        }
        self.strangers = Strangers { way: 0.0, room };
        Ok(())
    }

    fn look(&self, strand: &Strand) -> Option<[f64; 2]> {
        let homes = strand.rows.map(|row| self.home[row].map(|index| index as usize));
        let sides = homes.map(|[section, _]| &self.sections[section]);
        if !(sides[0].active[homes[0][1]] || sides[1].active[homes[1][1]]) {
            return None;
        }
        let place = |k: usize| sides[k].rows[homes[k][1]].place + strand.from[k];
        let offset = self.terms.offsets[strand.offset].between;
        Some(self.width.run(Look { offset, sides, places: [place(0), place(1)], count: strand.count }))
    }

    /// The distance of the nearest strangers within two diameters (m), and their strand.
    fn nearest_strangers(&self) -> (f64, Strand) {
        let all = &self.found.strangers;
        let none = self.terms.diameter * 2.0;
        let squared = rows_of(all.len(), |k| self.look(&all[k]).map_or(f64::INFINITY, |[least, _]| least));
        let (mut nearest, mut at) = (none * none, 0);
        for (k, &squared) in squared.iter().enumerate() {
            if squared < nearest {
                (nearest, at) = (squared, k);
            }
        }
        (nearest.sqrt(), all.get(at).copied().unwrap_or(self.found.contacts[0]))
    }

    /// Of a strand the pair that is as near as this (m), from 1.
    fn pair_within(&self, strand: &Strand, distance: f64) -> [usize; 2] {
        let offset = self.terms.offsets[strand.offset].between;
        let pair = |k: usize| [0, 1].map(|side| self.found.rows[strand.rows[side]].first + strand.from[side] + k);
        let apart = |k: usize| {
            let [a, b] = pair(k).map(|sphere| self.predicted_displacement(sphere));
            (0..3).map(|axis| (offset[axis] + b[axis] - a[axis]).powi(2)).sum::<f64>().sqrt()
        };
        let at = (0..strand.count).find(|&k| apart(k) <= distance).unwrap_or(0);
        pair(at).map(|sphere| sphere + 1)
    }

    fn predicted_displacement(&self, sphere: usize) -> [f64; 3] {
        let (section, place, _) = self.place(sphere);
        [0, 1, 2].map(|axis| self.sections[section].x[axis].get()[place])
    }

    /// Where a sphere is (m).
    fn predicted_centre(&self, row: usize, at: usize) -> [f64; 3] {
        let [section, in_section] = self.home[row].map(|index| index as usize);
        let section = &self.sections[section];
        let place = section.rows[in_section].place + at;
        let rest = self.found.rows[row].centre;
        let along = [at as f64 * self.found.diameter, 0.0, 0.0];
        std::array::from_fn(|axis| rest[axis] + along[axis] + section.x[axis].get()[place])
    }

    /// The least gap between a sphere that does not touch its image and that (m).
    fn images_apart(&self) -> Result<f64, Stop> {
        let radius = 0.5 * self.found.diameter;
        let mut least = 2.0 * self.found.diameter;
        for (row, of_row) in self.found.rows.iter().enumerate().filter(|(row, _)| self.is_active(*row)) {
            for mirror in &self.impact.mirrors {
                let rest = of_row.centre[mirror.axis];
                let step = if mirror.axis == 0 { self.found.diameter } else { 0.0 };
                for at in 0..of_row.count {
                    let away = (rest + at as f64 * step - mirror.position) * mirror.inward;
                    if away < 1.1 * radius {
                        continue;
                    }
                    let centre = self.predicted_centre(row, at);
                    let gap = 2.0 * (mirror.distance(&centre) - radius);
                    if gap < NEAR * self.found.diameter {
                        return Err(Stop::Met { spheres: [of_row.first + at + 1; 2], time_s: self.time() });
                    }
                    least = least.min(gap);
                }
            }
        }
        Ok(least)
    }

    fn is_active(&self, row: usize) -> bool {
        let [section, in_section] = self.home[row].map(|index| index as usize);
        self.sections[section].active[in_section]
    }

    /// The greatest displacement in a contact that is not torn (m), and row and place of spheres at the ends of those that are.
    fn torn(&self) -> (f64, BTreeSet<[usize; 2]>) {
        let contacts = &self.found.contacts;
        let limit = TORN * self.found.diameter;
        let most = rows_of(contacts.len(), |k| self.look(&contacts[k]).map_or(0.0, |[_, most]| most.sqrt()));
        let (mut stretch, mut torn) = (0.0_f64, BTreeSet::new());
        for (strand, &most) in contacts.iter().zip(&most) {
            if most <= limit {
                stretch = stretch.max(most);
                continue;
            }
            for k in 0..strand.count {
                let ends = [0, 1].map(|side| [strand.rows[side], strand.from[side] + k]);
                let [a, b] = ends.map(|[row, at]| self.predicted_displacement(self.found.rows[row].first + at));
                let moved = (0..3).map(|axis| (b[axis] - a[axis]).powi(2)).sum::<f64>().sqrt();
                if moved > limit {
                    torn.extend(ends);
                } else {
                    stretch = stretch.max(moved);
                }
            }
        }
        (stretch, torn)
    }

    /// The least distance between a torn end and another sphere two diameters from it at rest or further (m), as far as is looked.
    fn around(&self, torn: &BTreeSet<[usize; 2]>) -> Result<f64, Stop> {
        let (diameter, periods) = (self.found.diameter, &self.impact.periods);
        let width = AROUND * diameter;
        let cells: [Option<i64>; 3] = std::array::from_fn(|axis| {
            let period = periods.iter().find(|period| period.axis == axis)?;
            Some((period.length / width).floor().max(1.0) as i64)
        });
        let home = |centre: &[f64; 3]| -> [i64; 3] {
            std::array::from_fn(|axis| match periods.iter().find(|period| period.axis == axis) {
                Some(Period { length, .. }) => {
                    let count = cells[axis].unwrap_or(1);
                    ((centre[axis] / length * count as f64).floor() as i64).rem_euclid(count)
                }
                None => (centre[axis] / width).floor() as i64,
            })
        };
        let mut by_cell: BTreeMap<[i64; 3], Vec<End>> = BTreeMap::new();
        for &[row, at] in torn {
            let centre = self.predicted_centre(row, at);
            let cell = home(&centre);
            // Known in all cells around, so that others look into their own alone.
            let mut around = BTreeSet::new();
            for code in 0..27_i64 {
                let steps = [code % 3 - 1, code / 3 % 3 - 1, code / 9 - 1];
                around.insert(std::array::from_fn::<i64, 3, _>(|axis| {
                    let at = cell[axis] + steps[axis];
                    cells[axis].map_or(at, |count| at.rem_euclid(count))
                }));
            }
            for cell in around {
                by_cell.entry(cell).or_default().push(([row, at], centre));
            }
        }
        let rest = |[row, at]: [usize; 2]| {
            let [x, y, z] = self.found.rows[row].centre;
            [x + at as f64 * diameter, y, z]
        };
        let apart = |from: &[f64; 3], to: &[f64; 3]| {
            let between: [f64; 3] = Period::nearest(periods, std::array::from_fn(|axis| to[axis] - from[axis]));
            between.iter().map(|x| x * x).sum::<f64>().sqrt()
        };
        let nearest = rows_of(self.found.rows.len(), |row| {
            let mut nearest = (width, [[row, 0]; 2]);
            for at in 0..self.found.rows[row].count {
                let centre = self.predicted_centre(row, at);
                for (end, of_end) in by_cell.get(&home(&centre)).into_iter().flatten() {
                    let distance = apart(of_end, &centre);
                    // Nearer ones stand in strands.
                    if distance < nearest.0
                        && *end != [row, at]
                        && apart(&rest(*end), &rest([row, at])) >= 2.0 * diameter * (1.0 - 1e-6)
                    {
                        nearest = (distance, [*end, [row, at]]);
                    }
                }
            }
            nearest
        });
        let least = nearest.into_iter().fold((width, [[0; 2]; 2]), |a, b| if b.0 < a.0 { b } else { a });
        if least.0 < (1.0 + NEAR) * diameter {
            let mut spheres = least.1.map(|[row, at]| self.found.rows[row].first + at + 1);
            spheres.sort_unstable();
            return Err(Stop::Met { spheres, time_s: self.time() });
        }
        Ok(least.0)
    }
}
