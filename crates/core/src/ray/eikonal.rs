//! First arrivals on the lattice, without rays: a second opinion where rays cross or nobody knows the faces.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::mesh::{Mesh, NONE};
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
    mesh: Mesh,
    /// Arrival time at each point of the mesh (s), row by row.
    times: Vec<f64>,
}

/// A point to be settled next: the bits of its time, which order as times from 0 on do, and its index. The earliest comes first,
/// of equal ones that of lower index, so that the order is always the same.
type Trial = Reverse<(u64, u32)>;

impl Eikonal {
    /// Arrivals of a wave that starts along all of row 1 at time 0. `speeds` (m/s) are those of the sites, in the lattice's
    /// order; `finer` is at least 1.
    pub fn of_plane_wave(lattice: &HexagonalSheet, speeds: &[f64], finer: u32) -> Self {
        let mut solver = Self::empty(lattice, finer);
        let first_row: Vec<usize> = (0..solver.mesh.points(0)).collect();
        solver.march(speeds, &first_row);
        solver
    }

    /// The same from a point at (x, z) (m), taken to the nearest of the mesh.
    pub fn of_point(lattice: &HexagonalSheet, speeds: &[f64], finer: u32, [x, z]: [f64; 2]) -> Self {
        let mut solver = Self::empty(lattice, finer);
        let off = |[a, b]: [f64; 2]| (a - x).hypot(b - z);
        let nearest = solver.places().enumerate().min_by(|a, b| off(a.1).total_cmp(&off(b.1))).map_or(0, |n| n.0);
        solver.march(speeds, &[nearest]);
        solver
    }

    fn empty(lattice: &HexagonalSheet, finer: u32) -> Self {
        let finer = finer.max(1);
        let mesh = Mesh::new(lattice, finer);
        Self { lattice: lattice.clone(), finer, times: vec![f64::INFINITY; mesh.len()], mesh }
    }

    /// Where all points of the mesh lie (m), in order.
    fn places(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        (0..self.mesh.rows).flat_map(move |row| (0..self.mesh.points(row)).map(move |k| self.mesh.at(row, k)))
    }

    /// Slowness of every point: that of the nearest site.
    fn slowness(&self, speeds: &[f64]) -> Vec<f64> {
        let (diameter, spacing) = (self.lattice.diameter(), self.lattice.row_spacing());
        let nearest = |[x, z]: [f64; 2]| {
            let row = (z / spacing).floor() as u32 + 1;
            let beside = [row, row + 1].into_iter().filter(|row| *row <= self.lattice.rows());
            let sites = beside.flat_map(|row| {
                let first = if row.is_multiple_of(2) { 0.5 } else { 0.0 };
                let column = ((x / diameter - first).round().max(0.0) as u32 + 1).min(self.lattice.columns(row));
                self.lattice.site(row, column).zip(self.lattice.index(row, column))
            });
            let off = |dx: f64, dz: f64| dx * dx + dz * dz;
            sites.min_by(|(a, _), (b, _)| off(a.x - x, a.z - z).total_cmp(&off(b.x - x, b.z - z))).map_or(0, |s| s.1)
        };
        self.places().map(|place| 1.0 / speeds[nearest(place)]).collect()
    }

    fn march(&mut self, speeds: &[f64], sources: &[usize]) {
        let slowness = self.slowness(speeds);
        let neighbours = self.mesh.neighbours();
        let delay = self.mesh.step;
        let mut settled = vec![false; self.times.len()];
        let mut trials: BinaryHeap<Trial> = BinaryHeap::new();
        for &point in sources {
            self.times[point] = 0.0;
            trials.push(Reverse((0.0_f64.to_bits(), point as u32)));
        }
        while let Some(Reverse((time, index))) = trials.pop() {
            let (time, point) = (f64::from_bits(time), index as usize);
            if settled[point] || time > self.times[point] {
                continue;
            }
            settled[point] = true;
            for next in neighbours[point].into_iter().filter(|next| *next != NONE) {
                let corner = next as usize;
                if settled[corner] {
                    continue;
                }
                // What the triangles say that this point belongs to: what others say has been heard before. Beside a mirror line
                // it may be in two places around its neighbour.
                let around = &neighbours[corner];
                let known = |k: usize| {
                    let other = around[k % 6] as usize;
                    (other < settled.len() && settled[other]).then(|| self.times[other])
                };
                let per_step = slowness[corner] * delay;
                let mut earliest = self.times[corner];
                for k in (0..6).filter(|&k| around[k] == index) {
                    earliest = earliest.min(update(time, known(k + 1), per_step));
                    if let Some(before) = known(k + 5) {
                        earliest = earliest.min(update(before, Some(time), per_step));
                    }
                }
                if earliest < self.times[corner] {
                    self.times[corner] = earliest;
                    trials.push(Reverse((earliest.to_bits(), next)));
                }
            }
        }
    }

    /// Where the wave is at each of some times (s), in ascending order: straight pieces (m), one for each triangle of the mesh that it
    /// crosses.
    pub fn isochrones(&self, times: &[f64]) -> Vec<Vec<[[f64; 2]; 2]>> {
        let mut fronts = vec![Vec::new(); times.len()];
        let corner = |row: u32, k: usize| (self.times[self.mesh.start(row) + k], self.mesh.at(row, k));
        for row in 0..self.mesh.rows {
            for k in 1..self.mesh.points(row) {
                // The triangles below and above two neighbours in a row.
                for tip in [Some(row + 1).filter(|row| *row < self.mesh.rows), row.checked_sub(1)].into_iter().flatten()
                {
                    let third = corner(tip, if row % 2 == 0 { k - 1 } else { k });
                    let [a, b, c] = [corner(row, k - 1), corner(row, k), third];
                    let [low, high] = [a.0.min(b.0).min(c.0), a.0.max(b.0).max(c.0)];
                    let first = times.partition_point(|time| *time <= low);
                    for (front, &time) in
                        fronts[first..].iter_mut().zip(&times[first..]).take_while(|(_, time)| **time <= high)
                    {
                        let mut crossed = [[a, b], [b, c], [c, a]].into_iter().filter_map(|side| crossing(side, time));
                        if let (Some(from), Some(to)) = (crossed.next(), crossed.next()) {
                            front.push([from, to]);
                        }
                    }
                }
            }
        }
        fronts
    }

    /// First arrivals at the sites (s), in the lattice's order.
    pub fn at_sites(&self) -> Vec<f64> {
        let site = |row: u32, x: f64| {
            let half_steps = (2.0 * x / self.mesh.step).round() as i64;
            self.mesh
                .index(i64::from((row - 1) * self.finer), half_steps)
                .map_or(f64::INFINITY, |point| self.times[point])
        };
        self.lattice.sites().iter().map(|s| site(s.row, s.x)).collect()
    }
}

/// Where the wave crosses a side of a triangle, whose ends have each a time and a place, at a time.
fn crossing([(start, from), (end, to)]: [(f64, [f64; 2]); 2], time: f64) -> Option<[f64; 2]> {
    if (start < time) == (end < time) {
        return None;
    }
    let part = (time - start) / (end - start);
    Some([from[0] + part * (to[0] - from[0]), from[1] + part * (to[1] - from[1])])
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
    use crate::ray::Vector2;

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
