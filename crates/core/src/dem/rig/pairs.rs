//! Who is near whom: pairs of spheres closer than a skin, found by cells, over periodic sides too.

use std::ops::Range;

use super::Rig;
use crate::dem::share::{joined, parts, rows};

/// Two spheres that touch, or may do so before the list is made anew.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Near<const D: usize> {
    /// Indices, the lower one first.
    pub ends: [u32; 2],
    /// Periods by which the second sphere is shifted.
    pub image: [i8; D],
    /// From the centre of the first to that of the second (its image) where they lay at the start (m), in as many numbers as there are axes; last |offset|²
    /// − (r₁ + r₂)² (m²), exactly zero where the spheres just touched. In one row, which registers take at once.
    pub rest: [f64; 4],
}

impl<const D: usize> Near<D> {
    /// Offset (m) and gap (m²); see `rest`.
    #[inline(always)]
    pub fn lies(&self) -> ([f64; D], f64) {
        let mut offset = [0.0; D];
        offset.copy_from_slice(&self.rest[..D]);
        (offset, self.rest[3])
    }

    /// What tells a pair from all others; lists are in this order.
    pub fn key(&self) -> ([u32; 2], [i8; D]) {
        (self.ends, self.image)
    }
}

/// Spheres nearer than this part of their reach at the start count as touching, and their gap as zero.
pub(super) const TOUCHING: f64 = 1e-9;

/// A sphere this many times as wide as the median one is compared with every other instead of widening the cells.
const BIG: f64 = 2.5;

/// A sphere's skin is how far it gets in so many steps at the speed it has when the list is made, between a least and a greatest part
/// of the median radius. Wider lists hold more pairs that do not touch, narrower ones must be made anew more often; on an impact
/// on a bed this is where the two balance.
const AHEAD: f64 = 160.0;
const LEAST_LEEWAY: f64 = 0.1;
const LEEWAY: f64 = 0.8;

/// The greatest skin over the median radius that the shortest period must leave room for.
const NARROW_LEEWAY: f64 = 0.4;

/// Leeway of big spheres over the median radius.
const BIG_SKIN: f64 = 2.0;

/// Finds near pairs; holds what does not change from list to list.
#[derive(Clone, Debug)]
pub(super) struct Finder<const D: usize> {
    periods: [Option<f64>; D],
    /// How far each sphere may move before the list must be made anew (m): surfaces nearer than the sum of two are near.
    pub skin: Vec<f64>,
    /// The greatest skin of spheres that are not big, and that of flats.
    pub common: f64,
    /// The least.
    least: f64,
    /// Largest diameter of the spheres that go into cells (m).
    widest: f64,
    big: Vec<u32>,
    is_big: Vec<bool>,
    /// Spheres of one cluster never count as near each other.
    clustered: Vec<Option<u32>>,
}

/// Cells in a row along each axis that hold sorted spheres.
struct Grid<const D: usize> {
    low: [f64; D],
    width: [f64; D],
    count: [usize; D],
    periodic: [bool; D],
    /// Where each cell's spheres begin in `packed`.
    start: Vec<u32>,
    packed: Vec<Packed<D>>,
}

/// A sphere in its cell: what a search asks for, side by side.
#[derive(Clone, Copy)]
struct Packed<const D: usize> {
    at: [f64; D],
    /// Radius and skin (m).
    size: f64,
    sphere: u32,
}

impl<const D: usize> Grid<D> {
    fn place(&self, at: &[f64; D]) -> [usize; D] {
        // Clamping keeps neighbours neighbours, so that spheres outside the grid are found too.
        std::array::from_fn(|k| {
            (((at[k] - self.low[k]) / self.width[k]).floor().max(0.0) as usize).min(self.count[k] - 1)
        })
    }

    /// The spheres of the cells from `first` to `last`.
    #[inline]
    fn between(&self, first: usize, last: usize) -> &[Packed<D>] {
        &self.packed[self.start[first] as usize..self.start[last + 1] as usize]
    }

    fn index(&self, place: &[usize; D]) -> usize {
        let mut index = 0;
        for k in 0..D {
            index = index * self.count[k] + place[k];
        }
        index
    }
}

impl<const D: usize> Finder<D> {
    /// With the least skin for all but big spheres, mostly few and fast, who have more than others.
    pub fn new(rig: &Rig<D>) -> Self {
        let mut radii: Vec<f64> = rig.sample.spheres.iter().map(|s| s.radius).collect();
        radii.sort_unstable_by(f64::total_cmp);
        let median = radii.get(radii.len() / 2).copied().unwrap_or(0.0);
        let is_big: Vec<bool> = rig.sample.spheres.iter().map(|s| s.radius > BIG * median).collect();
        let big = (0..is_big.len() as u32).filter(|&i| is_big[i as usize]).collect();
        let widest = radii.iter().rev().find(|&&r| r <= BIG * median).map_or(0.0, |r| 2.0 * r);
        let least = LEAST_LEEWAY * median;
        // Short periods leave less, and a hair for rounding.
        let period = rig.periods.iter().flatten().fold(f64::INFINITY, |shortest, &period| shortest.min(period));
        let common = ((0.25 - 1e-9) * period - 0.5 * widest).min(LEEWAY * median).max(NARROW_LEEWAY * median);
        let skin = is_big.iter().map(|&big| if big { BIG_SKIN * median } else { least }).collect();
        Self { periods: rig.periods, skin, common, least, widest, big, is_big, clustered: rig.clustered() }
    }

    /// Gives each sphere its skin for the list that is made next, by its velocity and the step (s).
    pub fn allow(&mut self, velocity: &[[f64; D]], step: f64) {
        for ((skin, velocity), _) in self.skin.iter_mut().zip(velocity).zip(&self.is_big).filter(|(_, big)| !**big) {
            let squared: f64 = velocity.iter().map(|v| v * v).sum();
            // In this order a velocity that is no number gives a number; a guard will name it.
            *skin = (AHEAD * step * squared.sqrt()).min(self.common).max(self.least);
        }
    }

    /// The shortest period that can be handled (m): a sphere may not be near two images of another.
    pub fn shortest_period(&self) -> f64 {
        2.0 * (self.widest + 2.0 * self.common)
    }

    /// All near pairs, in order of their keys. `displacement` is from the start.
    pub fn find(&self, rig: &Rig<D>, displacement: &[[f64; D]]) -> Vec<Near<D>> {
        let spheres = &rig.sample.spheres;
        let at = |i: usize| -> [f64; D] { std::array::from_fn(|k| spheres[i].centre[k] + displacement[i][k]) };
        let whole = |at: f64, k: usize| self.periods[k].map_or(0.0, |period| (at / period).floor());
        let wrapped = rows(spheres.len(), |i| {
            let mut at = at(i);
            for k in 0..D {
                at[k] -= whole(at[k], k) * self.periods[k].unwrap_or(0.0);
            }
            Packed { at, size: spheres[i].radius + self.skin[i], sphere: i as u32 }
        });
        let turns = rows(spheres.len(), |i| {
            let at = at(i);
            std::array::from_fn(|k| whole(at[k], k) as i32)
        });
        let grid = self.grid(&wrapped);
        let lists = parts(spheres.len(), |these| self.near(rig, &grid, &wrapped, &turns, these));
        joined(lists)
    }

    /// The near pairs of which one of `these` spheres is the first.
    fn near(
        &self,
        rig: &Rig<D>,
        grid: &Grid<D>,
        wrapped: &[Packed<D>],
        turns: &[[i32; D]],
        these: Range<usize>,
    ) -> Vec<Near<D>> {
        let period = self.periods.map(|period| period.unwrap_or(0.0));
        let mut list = Vec::with_capacity(these.len() * (D + 2));
        let mut found: Vec<(u32, [i32; D])> = Vec::new();
        for i in these {
            found.clear();
            let home = wrapped[i];
            let mut visit = |others: &[Packed<D>], shift: &[i32; D]| {
                let at: [f64; D] = std::array::from_fn(|k| home.at[k] - f64::from(shift[k]) * period[k]);
                for other in others {
                    let mut squared = 0.0;
                    for k in 0..D {
                        squared += (other.at[k] - at[k]) * (other.at[k] - at[k]);
                    }
                    let near = home.size + other.size;
                    // Both asked at once: each alone is as good as chance.
                    if (squared < near * near) & (other.sphere > home.sphere) {
                        found.push((other.sphere, *shift));
                    }
                }
            };
            if self.is_big[i] {
                self.shifts(|shift| visit(&wrapped[i + 1..], shift));
            } else {
                self.around(grid, &home.at, &mut visit);
                for &j in &self.big {
                    self.shifts(|shift| visit(&wrapped[j as usize..=j as usize], shift));
                }
            }
            let from = list.len();
            for &(j, shift) in &found {
                let j = j as usize;
                if self.clustered[i].is_some() && self.clustered[i] == self.clustered[j] {
                    continue;
                }
                // Spheres of a run gone astray may be any number of periods apart, until a guard stops it.
                let image = std::array::from_fn(|k| shift[k].wrapping_sub(turns[j][k]).wrapping_add(turns[i][k]) as i8);
                list.push(pair(rig, [i, j], image));
            }
            list[from..].sort_unstable_by_key(Near::key);
        }
        list.shrink_to_fit();
        list
    }

    /// Calls with every combination of −1, 0, 1 periods along the periodic axes.
    fn shifts(&self, mut call: impl FnMut(&[i32; D])) {
        for code in 0..3_usize.pow(D as u32) {
            let shift: [i32; D] = std::array::from_fn(|k| (code / 3_usize.pow(k as u32) % 3) as i32 - 1);
            if (0..D).all(|k| shift[k] == 0 || self.periods[k].is_some()) {
                call(&shift);
            }
        }
    }

    fn grid(&self, wrapped: &[Packed<D>]) -> Grid<D> {
        let ordinary = self.skin.iter().zip(&self.is_big).filter(|(_, big)| !**big);
        let most = ordinary.fold(self.least, |most, (&skin, _)| most.max(skin));
        let least = (self.widest + 2.0 * most).max(f64::MIN_POSITIVE);
        let mut low = [f64::INFINITY; D];
        let mut high = [f64::NEG_INFINITY; D];
        for Packed { at, .. } in wrapped {
            for k in 0..D {
                low[k] = low[k].min(at[k]);
                high[k] = high[k].max(at[k]);
            }
        }
        let mut width = [least; D];
        let mut count = [1_usize; D];
        for k in 0..D {
            let extent = match self.periods[k] {
                Some(period) => {
                    low[k] = 0.0;
                    period
                }
                None => (high[k] - low[k]).max(0.0),
            };
            // No more cells than pay: wide cells are slower, never wrong.
            let most = (4 * wrapped.len() + 64) as f64;
            count[k] = (extent / least).floor().clamp(1.0, most) as usize;
            width[k] = (extent / count[k] as f64).max(least);
        }
        while count.iter().product::<usize>() > 8 * wrapped.len() + 64 {
            for k in 0..D {
                if count[k] > 3 {
                    width[k] *= count[k] as f64 / (count[k] / 2) as f64;
                    count[k] /= 2;
                }
            }
        }
        // Fewer than three cells around a period would be visited twice: one cell then, seen with all its shifts.
        for k in 0..D {
            if self.periods[k].is_some() && count[k] < 3 {
                (count[k], width[k]) = (1, self.periods[k].unwrap_or(least));
            }
        }
        let cells: usize = count.iter().product();
        let periodic = self.periods.map(|p| p.is_some());
        let mut grid = Grid { low, width, count, periodic, start: vec![0; cells + 1], packed: Vec::new() };
        let homes = rows(wrapped.len(), |i| grid.index(&grid.place(&wrapped[i].at)));
        for (i, &home) in homes.iter().enumerate() {
            if !self.is_big[i] {
                grid.start[home + 1] += 1;
            }
        }
        for cell in 0..cells {
            grid.start[cell + 1] += grid.start[cell];
        }
        grid.packed = vec![Packed { at: [0.0; D], size: 0.0, sphere: 0 }; grid.start[cells] as usize];
        let mut next = grid.start.clone();
        for (i, &home) in homes.iter().enumerate() {
            if !self.is_big[i] {
                grid.packed[next[home] as usize] = wrapped[i];
                next[home] += 1;
            }
        }
        grid
    }

    /// Visits all spheres in the cells around a point, with the periods by which they are shifted there.
    #[inline]
    fn around(&self, grid: &Grid<D>, at: &[f64; D], mut visit: impl FnMut(&[Packed<D>], &[i32; D])) {
        let home = grid.place(at);
        let last = D - 1;
        'rows: for code in 0..3_usize.pow(last as u32) {
            let mut place = [0_usize; D];
            let mut shift = [0_i32; D];
            for k in 0..last {
                let step = (code / 3_usize.pow(k as u32) % 3) as isize - 1;
                let cell = home[k] as isize + step;
                if (0..grid.count[k] as isize).contains(&cell) {
                    place[k] = cell as usize;
                } else if grid.periodic[k] {
                    place[k] = cell.rem_euclid(grid.count[k] as isize) as usize;
                    shift[k] = step as i32;
                } else {
                    continue 'rows;
                }
            }
            // Cells in a row along the last axis lie behind one another, but for those over a periodic side.
            let row = grid.index(&place);
            let (here, count) = (home[last], grid.count[last]);
            visit(grid.between(row + here.saturating_sub(1), row + (here + 1).min(count - 1)), &shift);
            if grid.periodic[last] && here == 0 {
                shift[last] = -1;
                visit(grid.between(row + count - 1, row + count - 1), &shift);
            }
            if grid.periodic[last] && here == count - 1 {
                shift[last] = 1;
                visit(grid.between(row, row), &shift);
            }
        }
    }
}

/// The pair of two spheres, the second shifted by so many periods.
pub(super) fn pair<const D: usize>(rig: &Rig<D>, [i, j]: [usize; 2], image: [i8; D]) -> Near<D> {
    let (a, b) = (&rig.sample.spheres[i], &rig.sample.spheres[j]);
    let offset: [f64; D] = std::array::from_fn(|k| {
        b.centre[k] - a.centre[k] + rig.periods[k].map_or(0.0, |period| f64::from(image[k]) * period)
    });
    let reach = a.radius + b.radius;
    let squared: f64 = offset.iter().map(|x| x * x).sum();
    let touching = (squared.sqrt() - reach).abs() <= TOUCHING * reach;
    let mut rest = [0.0, 0.0, 0.0, if touching { 0.0 } else { squared - reach * reach }];
    rest[..D].copy_from_slice(&offset);
    Near { ends: [i as u32, j as u32], image, rest }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::LawKind;
    use crate::dem::rig::LawBook;
    use crate::material::find;
    use crate::sample::{Sample, Sphere};

    /// Scattered spheres of several sizes in a box that repeats along its first axis, some displaced over the side, against
    /// a search of all pairs and images.
    #[test]
    fn near_pairs_are_those_of_an_exhaustive_search() {
        for (count, period) in [(400, 20.0), (30, 5.0)] {
            let mut state = 1_u64;
            let mut draw = move || {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                (state >> 11) as f64 / (1_u64 << 53) as f64
            };
            let spheres: Vec<Sphere<2>> = (0..count)
                .map(|i| Sphere {
                    centre: [period * draw(), 0.05 * f64::from(count) * draw()],
                    radius: if i == 7 && count > 100 { 3.0 } else { 0.3 + 0.2 * draw() },
                    material: 0,
                })
                .collect();
            let sample = Sample { materials: vec![find("440c", &[]).unwrap()], spheres };
            let mut rig = Rig::new(sample, LawBook::named(LawKind::Hertz));
            rig.periods = [Some(period), None];
            let moved: Vec<[f64; 2]> = (0..count).map(|_| [60.0 * draw() - 30.0, draw()]).collect();
            let finder = Finder::new(&rig);
            let list = finder.find(&rig, &moved);
            assert!(list.is_sorted_by(|a, b| a.key() < b.key()), "in order and without doubles");

            let mut expected = Vec::new();
            for i in 0..count as usize {
                for j in i + 1..count as usize {
                    for image in -20_i8..=20 {
                        let (a, b) = (&rig.sample.spheres[i], &rig.sample.spheres[j]);
                        let x = b.centre[0] + moved[j][0] - a.centre[0] - moved[i][0] + f64::from(image) * period;
                        let z = b.centre[1] + moved[j][1] - a.centre[1] - moved[i][1];
                        if x.hypot(z) < a.radius + b.radius + finder.skin[i] + finder.skin[j] {
                            expected.push(([i as u32, j as u32], [image, 0]));
                        }
                    }
                }
            }
            assert_eq!(list.iter().map(Near::key).collect::<Vec<_>>(), expected);
        }
    }
}
