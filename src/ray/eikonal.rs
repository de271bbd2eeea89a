//! First arrivals on the lattice, without rays: a second opinion where rays cross or nobody knows the faces.

use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

use crate::lattice::HexagonalSheet;

/// First arrivals of the impact's plane wave where the speed changes from site to site.
///
/// Solves |∇t| = 1/V by fast marching on equilateral triangles (R. Kimmel and J. A. Sethian, Computing geodesic paths on
/// manifolds, 1998): the sites themselves, or a mesh `finer` times as fine, in which each point has the speed of the site
/// nearest to it. Times are of first order in the mesh. Diffraction is not known to it, nor any wave but the first.
#[derive(Clone, Debug, PartialEq)]
pub struct Eikonal {
    lattice: HexagonalSheet,
    finer: u32,
    /// Half steps of the mesh from mirror line to mirror line.
    width: i64,
    rows: u32,
    /// Arrival time at each point of the mesh (s), row by row.
    times: Vec<f64>,
}

/// A point to be settled next; the earliest first, of equal ones the one of lower index, so that the order is always the
/// same.
#[derive(PartialEq)]
struct Trial {
    time: f64,
    point: usize,
}

impl Eq for Trial {}

impl PartialOrd for Trial {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Trial {
    fn cmp(&self, other: &Self) -> Ordering {
        self.time.total_cmp(&other.time).then(self.point.cmp(&other.point))
    }
}

impl Eikonal {
    /// Arrivals of a wave that starts along all of row 1 at time 0. `speeds` (m/s) are those of the sites, in the lattice's
    /// order; `finer` is at least 1.
    pub fn of_plane_wave(lattice: &HexagonalSheet, speeds: &[f64], finer: u32) -> Self {
        let mut solver = Self::empty(lattice, finer);
        let first_row: Vec<(usize, f64)> = (0..solver.points(0)).map(|point| (point, 0.0)).collect();
        solver.march(speeds, &first_row);
        solver
    }

    /// The same from a point at (x, z) (m), taken to the nearest of the mesh.
    pub fn of_point(lattice: &HexagonalSheet, speeds: &[f64], finer: u32, [x, z]: [f64; 2]) -> Self {
        let mut solver = Self::empty(lattice, finer);
        let nearest = (0..solver.times.len()).min_by(|&a, &b| {
            let off = |point| {
                let at: [f64; 2] = solver.at(point);
                (at[0] - x).hypot(at[1] - z)
            };
            off(a).total_cmp(&off(b))
        });
        solver.march(speeds, &[(nearest.unwrap_or(0), 0.0)]);
        solver
    }

    fn empty(lattice: &HexagonalSheet, finer: u32) -> Self {
        let finer = finer.max(1);
        let width = (2.0 * lattice.half_width() / lattice.diameter()).round() as i64 * i64::from(finer);
        let rows = (lattice.rows() - 1) * finer + 1;
        let mut solver = Self { lattice: *lattice, finer, width, rows, times: Vec::new() };
        solver.times = vec![f64::INFINITY; solver.start(rows)];
        solver
    }

    /// Mesh step (m).
    fn step(&self) -> f64 {
        self.lattice.diameter() / f64::from(self.finer)
    }

    /// Number of points in a mesh row, from 0 on. Even ones begin on the axis, odd ones half a step off it.
    fn points(&self, row: u32) -> usize {
        let first = i64::from(row % 2);
        ((self.width - first) / 2 + 1) as usize
    }

    /// Index of the first point of a mesh row.
    fn start(&self, row: u32) -> usize {
        (row as usize / 2) * (self.points(0) + self.points(1)) + if row % 2 == 1 { self.points(0) } else { 0 }
    }

    /// Mesh row and half steps from the axis.
    fn place(&self, point: usize) -> (u32, i64) {
        let pair = self.points(0) + self.points(1);
        let (mut row, mut rest) = (2 * (point / pair) as u32, point % pair);
        if rest >= self.points(0) {
            (row, rest) = (row + 1, rest - self.points(0));
        }
        (row, 2 * rest as i64 + i64::from(row % 2))
    }

    fn at(&self, point: usize) -> [f64; 2] {
        let (row, half_steps) = self.place(point);
        [half_steps as f64 * 0.5 * self.step(), f64::from(row) * 0.75_f64.sqrt() * self.step()]
    }

    /// The point at a mesh row and so many half steps from the axis, mirrored into the crystal.
    fn index(&self, row: i64, half_steps: i64) -> Option<usize> {
        let row = u32::try_from(row).ok().filter(|row| *row < self.rows)?;
        let inside = half_steps.abs();
        let inside = if inside > self.width { 2 * self.width - inside } else { inside };
        Some(self.start(row) + usize::try_from(inside / 2).ok()?)
    }

    /// The six neighbours, in order around the point.
    fn around(&self, point: usize) -> [Option<usize>; 6] {
        let (row, p) = self.place(point);
        let row = i64::from(row);
        [(0, 2), (1, 1), (1, -1), (0, -2), (-1, -1), (-1, 1)].map(|(down, across)| self.index(row + down, p + across))
    }

    /// Slowness of every point: that of the nearest site.
    fn slowness(&self, speeds: &[f64]) -> Vec<f64> {
        let (diameter, spacing) = (self.lattice.diameter(), self.lattice.row_spacing());
        let nearest = |point: usize| {
            let [x, z] = self.at(point);
            let row = (z / spacing).floor() as u32 + 1;
            let beside = [row, row + 1].into_iter().filter(|row| *row <= self.lattice.rows());
            let sites = beside.flat_map(|row| {
                let first = if row.is_multiple_of(2) { 0.5 } else { 0.0 };
                let column = ((x / diameter - first).round().max(0.0) as u32 + 1).min(self.lattice.columns(row));
                self.lattice.site(row, column).zip(self.lattice.index(row, column))
            });
            sites
                .min_by(|(a, _), (b, _)| (a.x - x).hypot(a.z - z).total_cmp(&(b.x - x).hypot(b.z - z)))
                .map_or(0, |s| s.1)
        };
        (0..self.times.len()).map(|point| 1.0 / speeds[nearest(point)]).collect()
    }

    fn march(&mut self, speeds: &[f64], sources: &[(usize, f64)]) {
        let slowness = self.slowness(speeds);
        let delay = self.step();
        let mut settled = vec![false; self.times.len()];
        let mut trials = BinaryHeap::new();
        for &(point, time) in sources {
            self.times[point] = time;
            trials.push(Reverse(Trial { time, point }));
        }
        while let Some(Reverse(Trial { time, point })) = trials.pop() {
            if settled[point] || time > self.times[point] {
                continue;
            }
            settled[point] = true;
            for next in self.around(point).into_iter().flatten() {
                if settled[next] {
                    continue;
                }
                // What the triangles between settled neighbours say.
                let around = self.around(next);
                let known = |k: usize| around[k % 6].filter(|&n| settled[n]).map(|n| self.times[n]);
                let per_step = slowness[next] * delay;
                let earliest = (0..6)
                    .filter_map(|k| Some(update(known(k)?, known(k + 1), per_step)))
                    .fold(f64::INFINITY, f64::min);
                if earliest < self.times[next] {
                    self.times[next] = earliest;
                    trials.push(Reverse(Trial { time: earliest, point: next }));
                }
            }
        }
    }

    /// Where the wave is at a time (s): straight pieces (m), one for each triangle of the mesh that it crosses.
    pub fn isochrone(&self, time: f64) -> Vec<[[f64; 2]; 2]> {
        let mut pieces = Vec::new();
        for point in 0..self.times.len() {
            let (row, p) = self.place(point);
            // The triangles to the right of a point: with its neighbours below and above.
            for down in [1, -1] {
                let corners = [(0, 0), (0, 2), (down, 1)].map(|(down, across)| (i64::from(row) + down, p + across));
                if corners.iter().any(|(_, p)| *p > self.width) {
                    continue;
                }
                let [Some(a), Some(b), Some(c)] = corners.map(|(row, p)| self.index(row, p)) else { continue };
                let reached = [a, b, c].map(|corner| self.times[corner] < time);
                if reached[0] == reached[1] && reached[1] == reached[2] {
                    continue;
                }
                let mut crossed = [[a, b], [b, c], [c, a]].into_iter().filter_map(|side| self.crossed(side, time));
                if let (Some(from), Some(to)) = (crossed.next(), crossed.next()) {
                    pieces.push([from, to]);
                }
            }
        }
        pieces
    }

    /// Where the wave crosses a side of a triangle at a time.
    fn crossed(&self, [a, b]: [usize; 2], time: f64) -> Option<[f64; 2]> {
        let (start, end) = (self.times[a], self.times[b]);
        if (start < time) == (end < time) {
            return None;
        }
        let part = (time - start) / (end - start);
        let ([x0, z0], [x1, z1]) = (self.at(a), self.at(b));
        Some([x0 + part * (x1 - x0), z0 + part * (z1 - z0)])
    }

    /// First arrivals at the sites (s), in the lattice's order.
    pub fn at_sites(&self) -> Vec<f64> {
        let site = |row: u32, x: f64| {
            let half_steps = (2.0 * x / self.step()).round() as i64;
            self.index(i64::from((row - 1) * self.finer), half_steps).map_or(f64::INFINITY, |point| self.times[point])
        };
        self.lattice.sites().iter().map(|s| site(s.row, s.x)).collect()
    }
}

/// Arrival at the corner of an equilateral triangle from one or two of the others, and `per_step`, slowness times side.
///
/// A plane wave that has the times a and b there comes through the triangle if (4/3)(u² − u v + v²) = s² with u = (t − a)/h
/// and v = (t − b)/h has a solution whose direction lies between the two sides; otherwise the first wave runs along a side.
fn update(a: f64, b: Option<f64>, per_step: f64) -> f64 {
    let Some(b) = b else { return a + per_step };
    let along = a.min(b) + per_step;
    // With u the slower side's: u² − u (u − d) + (u − d)² = 3/4 s², d = b − a.
    let d = b - a;
    let discriminant = 3.0 * (per_step * per_step - d * d);
    if discriminant < 0.0 {
        return along;
    }
    let u = 0.5 * (d + discriminant.sqrt());
    let v = u - d;
    if u >= 0.5 * v && v >= 0.5 * u && u > 0.0 { a + u } else { along }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector2;

    use super::*;
    use crate::ray::refract;

    fn sheet(rows: u32, half_width: f64) -> HexagonalSheet {
        HexagonalSheet::new(1.0, rows, half_width).unwrap()
    }

    /// A plane front stays one, and layers only add up. Round-off.
    #[test]
    fn a_plane_wave_arrives_when_it_should() {
        let sheet = sheet(30, 7.5);
        for finer in [1, 2, 3] {
            let arrivals = Eikonal::of_plane_wave(&sheet, &vec![2.0; sheet.len()], finer).at_sites();
            for (site, time) in sheet.sites().iter().zip(arrivals) {
                assert!((time - site.z / 2.0).abs() < 1e-12, "{site:?} {time}");
            }
        }
    }

    /// From a point in a uniform medium t = r/V. The error falls with the mesh: by a factor of 1.5 at least per halving, as
    /// fast marching about a point is of the order h ln(1/h).
    #[test]
    fn circles_about_a_point_converge() {
        let sheet = sheet(30, 12.5);
        let middle = sheet.site(15, 1).unwrap();
        let worst = |finer: u32| {
            let arrivals = Eikonal::of_point(&sheet, &vec![1.0; sheet.len()], finer, [middle.x, middle.z]).at_sites();
            let sites = sheet.sites();
            let errors = sites.iter().zip(arrivals).map(|(s, t)| (t - (s.x - middle.x).hypot(s.z - middle.z)).abs());
            errors.fold(0.0, f64::max)
        };
        let errors = [1, 2, 4, 8].map(worst);
        println!("{errors:?}");
        assert!(errors.windows(2).all(|e| e[0] / e[1] > 1.5), "{errors:?}");
        // A graph of the six bonds alone would be 15 % late between them, 1.9 at the rim.
        assert!(errors[0] < 0.6, "{errors:?}");
    }

    /// A plane wave through an interface at 30 and 45 degrees: behind it t = k·r with k by Snell's law. The interface is cut
    /// into sites, so times are uncertain by the part of a diameter by which these miss it, over the difference of the
    /// slownesses; the mean error behind it falls with the mesh until that is left.
    #[test]
    fn a_tilted_interface_refracts_by_snells_law() {
        let (sheet, speeds) = (sheet(60, 30.0), [1.7, 1.0]);
        for degrees in [30.0_f64, 45.0] {
            let angle = degrees.to_radians();
            let slope = -angle.tan();
            let at = |x: f64| 35.0 + slope * x;
            let of_sites: Vec<f64> =
                sheet.sites().iter().map(|s| if s.z < at(s.x) { speeds[0] } else { speeds[1] }).collect();
            let normal = Vector2::new(angle.sin(), angle.cos());
            let onward = refract(Vector2::y(), normal, speeds[0], speeds[1]).unwrap() / speeds[1];
            let arrivals = Eikonal::of_plane_wave(&sheet, &of_sites, 6).at_sites();
            // Away from the mirror lines, whose images of the interface come later or meet it.
            let (mut sum, mut count) = (0.0, 0.0);
            for (site, time) in sheet.sites().iter().zip(arrivals) {
                let depth = site.z - at(site.x);
                if !(10.0..20.0).contains(&site.x) || !(2.0..10.0).contains(&depth) {
                    continue;
                }
                let foot = Vector2::new(site.x, at(site.x));
                let expected = foot.y / speeds[0] + onward.dot(&(Vector2::new(site.x, site.z) - foot));
                sum += time - expected;
                count += 1.0;
            }
            let mean: f64 = sum / count;
            // Half a diameter of misplaced interface, over the difference of the slownesses.
            assert!(count > 50.0 && mean.abs() < 0.5 * (1.0 / speeds[1] - 1.0 / speeds[0]), "{degrees} {mean} {count}");
            println!("{degrees} {mean} {count}");
        }
    }
}
