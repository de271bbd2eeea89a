//! Which spheres touch at rest or lie so near that their contact is followed from the start.

use super::boundary::{Period, Surface};
use super::size::{TOUCHING, gap_squared};
use crate::sample::{Sample, Sphere};

/// Two spheres that may touch, at rest.
#[derive(Clone, Copy, Debug)]
pub(super) struct Touch<const D: usize> {
    /// Indices, the lower one first.
    pub pair: [usize; 2],
    /// From the centre of the first to that of the second, or its nearest image (m).
    pub offset: [f64; D],
    /// |offset|² − (r₁ + r₂)² (m²) in the first sample; exactly zero where the spheres just touch.
    pub gap: f64,
    /// r₁ + r₂ (m) in the first sample
    pub reach: f64,
}

impl<const D: usize> Touch<D> {
    pub fn new(sample: &Sample<D>, pair: [usize; 2], periods: &[Period]) -> Self {
        let [a, b] = pair.map(|i| &sample.spheres[i]);
        let offset = Period::nearest(periods, std::array::from_fn(|k| b.centre[k] - a.centre[k]));
        Self { pair, offset, gap: gap_squared(sample, pair, &offset), reach: a.radius + b.radius }
    }
}

/// A sphere that may touch its own image in a mirror or another face.
#[derive(Clone, Copy, Debug)]
pub(super) struct SelfTouch<const D: usize> {
    pub sphere: usize,
    pub surface: Surface,
    /// Where the sphere lies at rest (m).
    pub centre: [f64; D],
    /// From surface to surface (m) at rest, in the first sample; exactly zero where they just touch.
    pub gap: f64,
    /// Its diameter (m) in the first sample
    pub reach: f64,
}

impl<const D: usize> SelfTouch<D> {
    pub fn new(sample: &Sample<D>, sphere: usize, surface: &Surface) -> Self {
        let Sphere { centre, radius, .. } = sample.spheres[sphere];
        Self { sphere, surface: *surface, centre, gap: image_gap(sample, sphere, surface), reach: 2.0 * radius }
    }
}

/// From the surface of a sphere of a sample to that of its image (m).
pub(super) fn image_gap<const D: usize>(sample: &Sample<D>, sphere: usize, surface: &Surface) -> f64 {
    let sphere = &sample.spheres[sphere];
    if sphere.radius == 0.0 {
        return f64::INFINITY;
    }
    let gap = surface.distance(&sphere.centre) - sphere.radius;
    if gap.abs() <= TOUCHING * sphere.radius { 0.0 } else { 2.0 * gap }
}

/// The contacts of a packing at rest, and those that are nearly ones.
#[derive(Clone, Debug)]
pub(super) struct Touching<const D: usize> {
    /// In order of the first sphere, then the second.
    pub pairs: Vec<Touch<D>>,
    /// In order of the sphere, then the surface.
    pub images: Vec<SelfTouch<D>>,
    /// Through which some of the pairs touch.
    pub periods: Vec<Period>,
}

/// A packing that cannot be simulated as it lies.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("spheres {} and {} overlap by {overlap} m before the impact", .pair[0] + 1, .pair[1] + 1)]
pub struct OverlapAtRest {
    /// Indices of the two spheres.
    pub pair: [usize; 2],
    /// By how much (m).
    pub overlap: f64,
}

/// Spheres nearer than this part of their reach are followed from the start; others when they come near.
pub(super) const NEAR: f64 = 0.05;

impl<const D: usize> Touching<D> {
    /// Finds the contacts of packings at rest that have the same centres: what is near in any of them. `visit` hears of all other
    /// pairs whose centres are nearer than two of the greatest diameters.
    pub fn find(
        samples: &[&Sample<D>],
        (surfaces, periods): (&[Surface], &[Period]),
        visit: &mut dyn FnMut(usize, usize),
    ) -> Result<Self, OverlapAtRest> {
        let spheres = &samples[0].spheres;
        let centres: Vec<[f64; D]> = spheres.iter().map(|s| s.centre).collect();
        let mut pairs = Vec::new();
        let mut overlapping = None;
        let widest = widest(samples);
        let far = ((1.0 + 2.0 * NEAR) * widest).powi(2);
        Cells::new(&centres, 2.0 * widest, periods).pairs(&mut |i, j| {
            let between: [f64; D] = Period::nearest(periods, std::array::from_fn(|k| centres[j][k] - centres[i][k]));
            let squared = between.iter().map(|x| x.powi(2)).sum::<f64>();
            if squared > far {
                return visit(i, j);
            }
            let distance = squared.sqrt();
            let mut is_near = false;
            for sample in samples {
                let [r, s] = [i, j].map(|k| sample.spheres[k].radius);
                let (gap, reach) = (distance - (r + s), r + s);
                if r * s == 0.0 {
                    continue;
                }
                if gap < -TOUCHING * reach {
                    overlapping.get_or_insert(OverlapAtRest { pair: [i, j], overlap: -gap });
                }
                is_near |= gap <= NEAR * reach;
            }
            if is_near {
                pairs.push(Touch::new(samples[0], [i, j], periods));
            } else {
                visit(i, j);
            }
        });
        if let Some(error) = overlapping {
            return Err(error);
        }
        pairs.sort_by_key(|touch| touch.pair);

        let mut images = Vec::new();
        for i in 0..spheres.len() {
            for surface in surfaces {
                let mut is_near = false;
                for sample in samples {
                    let Sphere { centre, radius, .. } = &sample.spheres[i];
                    if *radius == 0.0 || surface.carries(centre, *radius) {
                        continue;
                    }
                    let gap = image_gap(sample, i, surface);
                    if gap < -TOUCHING * radius {
                        return Err(OverlapAtRest { pair: [i, i], overlap: -gap });
                    }
                    is_near |= gap <= 2.0 * NEAR * radius;
                }
                if is_near {
                    images.push(SelfTouch::new(samples[0], i, surface));
                }
            }
        }
        Ok(Self { pairs, images, periods: periods.to_vec() })
    }
}

/// Diameter of the largest sphere (m).
pub(super) fn widest<const D: usize>(samples: &[&Sample<D>]) -> f64 {
    samples.iter().flat_map(|sample| &sample.spheres).map(|s| 2.0 * s.radius).fold(0.0, f64::max)
}

/// Centres sorted into cubes, so that near pairs are found without looking at all pairs.
struct Cells<'a, const D: usize> {
    centres: &'a [[f64; D]],
    /// Along each axis its edge (m), and after how many cells the first comes again.
    edges: [(f64, Option<i64>); D],
    sorted: Vec<([i64; D], usize)>,
}

impl<'a, const D: usize> Cells<'a, D> {
    /// At least `width` wide, or as wide as a period.
    fn new(centres: &'a [[f64; D]], width: f64, periods: &[Period]) -> Self {
        let edge = |axis: usize| match periods.iter().find(|period| period.axis == axis) {
            Some(Period { length, .. }) => {
                let count = (length / width).floor().max(1.0);
                (length / count, Some(count as i64))
            }
            None => (width, None),
        };
        let mut cells = Self { centres, edges: std::array::from_fn(edge), sorted: Vec::new() };
        cells.sorted = (0..centres.len()).map(|i| (cells.home(i), i)).collect();
        cells.sorted.sort_unstable();
        cells
    }

    fn home(&self, sphere: usize) -> [i64; D] {
        std::array::from_fn(|k| {
            let (edge, count) = self.edges[k];
            let at = (self.centres[sphere][k] / edge).floor() as i64;
            count.map_or(at, |count| at.rem_euclid(count))
        })
    }

    /// The cells next to one along an axis, itself included, each once.
    fn beside(&self, axis: usize, at: i64) -> impl Iterator<Item = i64> + Clone + use<D> {
        let count = self.edges[axis].1;
        let steps = match count {
            Some(1) => 0..=0,
            Some(2) => 0..=1,
            _ => -1..=1,
        };
        steps.map(move |step| count.map_or(at + step, |count| (at + step).rem_euclid(count)))
    }

    /// Visits every pair i < j whose centres are nearer than the cells are wide, and some that are not.
    fn pairs(&self, visit: &mut dyn FnMut(usize, usize)) {
        for i in 0..self.centres.len() {
            let home = self.home(i);
            let beside: [Vec<i64>; D] = std::array::from_fn(|k| self.beside(k, home[k]).collect());
            for code in 0..beside.iter().map(Vec::len).product() {
                let mut left: usize = code;
                let near: [i64; D] = std::array::from_fn(|k| {
                    let cell = beside[k][left % beside[k].len()];
                    left /= beside[k].len();
                    cell
                });
                let from = self.sorted.partition_point(|(cell, j)| (cell, *j) <= (&near, i));
                for &(_, j) in self.sorted[from..].iter().take_while(|(cell, _)| *cell == near) {
                    visit(i, j);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dem::boundary::Mirror;
    use crate::material::find;

    fn sheet(rows: usize, columns: usize) -> Sample<2> {
        let spheres = (0..rows * columns)
            .map(|i| {
                let (row, column) = (i / columns, i % columns);
                let x = column as f64 + if row % 2 == 1 { 0.5 } else { 0.0 };
                Sphere { centre: [x, row as f64 * 0.75_f64.sqrt()], radius: 0.5, material: 0 }
            })
            .collect();
        Sample { materials: vec![find("440c", &[]).unwrap()], spheres }
    }

    fn touching(samples: &[&Sample<2>], surfaces: &[Surface]) -> Result<Touching<2>, OverlapAtRest> {
        Touching::find(samples, (surfaces, &[]), &mut |_, _| {})
    }

    /// In an open sheet of R rows by C columns each row has C − 1 contacts and each pair of rows 2C − 1.
    #[test]
    fn a_hexagonal_sheet_has_its_contacts() {
        assert_eq!(touching(&[&sheet(7, 9)], &[]).unwrap().pairs.len(), 7 * 8 + 6 * 17);
    }

    /// Second neighbours lie √3 diameters apart, third ones two: both are visited, and none that touches.
    #[test]
    fn what_does_not_touch_but_lies_within_two_diameters_is_told() {
        let sample = sheet(7, 9);
        let mut distances = Vec::new();
        Touching::find(&[&sample], (&[], &[]), &mut |i, j| {
            let [a, b] = [i, j].map(|k| sample.spheres[k].centre);
            distances.push((b[0] - a[0]).hypot(b[1] - a[1]));
        })
        .unwrap();
        // Straight down: 9 in each of 5 pairs of rows; by one and a half to each side: 8 and 7 in each of 6.
        let second = distances.iter().filter(|&&d| (d - 3_f64.sqrt()).abs() < 1e-9).count();
        assert_eq!(second, 9 * 5 + (8 + 7) * 6);
        assert!(distances.iter().all(|&d| d > 1.1));
    }

    #[test]
    fn spheres_half_a_diameter_from_a_mirror_touch_their_image() {
        let mirror = Mirror { axis: 0, position: 0.0, inward: 1.0 };
        let touching = touching(&[&sheet(4, 5)], &[mirror.into()]).unwrap();
        let spheres: Vec<usize> = touching.images.iter().map(|t| t.sphere).collect();
        assert_eq!(spheres, [5, 15]);
    }

    /// A gap in one of two packings is no reason to leave the contact out.
    #[test]
    fn what_touches_in_one_packing_counts_for_all() {
        let (whole, mut holed) = (sheet(3, 3), sheet(3, 3));
        holed.spheres[4].radius = 0.0;
        let (alone, both) = (touching(&[&holed], &[]).unwrap(), touching(&[&holed, &whole], &[]).unwrap());
        assert_eq!((alone.pairs.len(), both.pairs.len()), (16 - 6, 16));
        let centre = both.pairs.iter().filter(|touch| touch.pair.contains(&4));
        assert!(centre.clone().count() == 6 && centre.clone().all(|touch| touch.gap == f64::INFINITY));
    }

    #[test]
    fn overlapping_spheres_are_refused() {
        let mut sample = sheet(2, 2);
        sample.spheres[1].centre[0] -= 0.01;
        assert_eq!(touching(&[&sample], &[]).map(|_| ()).unwrap_err().pair, [0, 1]);
    }
}
