//! Which spheres touch, and whether others are about to meet.

use super::boundary::Mirror;
use crate::sample::Sample;

/// Two touching spheres, at rest.
#[derive(Clone, Copy, Debug)]
pub(super) struct Touch<const D: usize> {
    /// Indices, the lower one first.
    pub pair: [usize; 2],
    /// From the centre of the first to that of the second (m).
    pub offset: [f64; D],
    /// |offset|² − (r₁ + r₂)² (m²); exactly zero where the spheres just touch.
    pub gap: f64,
    /// r₁ + r₂ (m)
    pub reach: f64,
}

/// A sphere that touches its own image in a mirror.
#[derive(Clone, Copy, Debug)]
pub(super) struct SelfTouch {
    pub sphere: usize,
    pub axis: usize,
    pub inward: f64,
    /// Its diameter (m)
    pub reach: f64,
}

/// The contacts of a packing at rest.
#[derive(Clone, Debug)]
pub(super) struct Touching<const D: usize> {
    /// In order of the first sphere, then the second.
    pub pairs: Vec<Touch<D>>,
    /// In order of the sphere.
    pub images: Vec<SelfTouch>,
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

/// Spheres nearer than this part of their reach count as touching, and their gap as zero.
const TOUCHING: f64 = 1e-9;

impl<const D: usize> Touching<D> {
    /// Finds all contacts of a packing at rest.
    pub fn find(sample: &Sample<D>, mirrors: &[Mirror]) -> Result<Self, OverlapAtRest> {
        let spheres = &sample.spheres;
        let centres: Vec<[f64; D]> = spheres.iter().map(|s| s.centre).collect();
        let mut pairs = Vec::new();
        let mut overlapping = None;
        Cells::new(&centres, widest(sample) * (1.0 + TOUCHING)).pairs(|i, j| {
            let offset: [f64; D] = std::array::from_fn(|k| centres[j][k] - centres[i][k]);
            let reach = spheres[i].radius + spheres[j].radius;
            let gap = offset.iter().map(|x| x * x).sum::<f64>().sqrt() - reach;
            if gap < -TOUCHING * reach {
                overlapping.get_or_insert(OverlapAtRest { pair: [i, j], overlap: -gap });
            } else if gap <= TOUCHING * reach {
                pairs.push(Touch { pair: [i, j], offset, gap: 0.0, reach });
            }
        });
        if let Some(error) = overlapping {
            return Err(error);
        }
        pairs.sort_by_key(|touch| touch.pair);

        let mut images = Vec::new();
        for (i, sphere) in spheres.iter().enumerate() {
            for mirror in mirrors.iter().filter(|mirror| !mirror.carries(&sphere.centre, sphere.radius)) {
                let gap = mirror.distance(&sphere.centre) - sphere.radius;
                if gap < -TOUCHING * sphere.radius {
                    return Err(OverlapAtRest { pair: [i, i], overlap: -2.0 * gap });
                }
                if gap <= TOUCHING * sphere.radius {
                    images.push(SelfTouch {
                        sphere: i,
                        axis: mirror.axis,
                        inward: mirror.inward,
                        reach: 2.0 * sphere.radius,
                    });
                }
            }
        }
        Ok(Self { pairs, images })
    }
}

/// Diameter of the largest sphere (m).
fn widest<const D: usize>(sample: &Sample<D>) -> f64 {
    sample.spheres.iter().map(|s| 2.0 * s.radius).fold(0.0, f64::max)
}

/// Centres sorted into cubes, so that near pairs are found without looking at all pairs.
struct Cells<'a, const D: usize> {
    centres: &'a [[f64; D]],
    width: f64,
    sorted: Vec<([i64; D], usize)>,
}

impl<'a, const D: usize> Cells<'a, D> {
    fn new(centres: &'a [[f64; D]], width: f64) -> Self {
        let mut cells = Self { centres, width, sorted: Vec::new() };
        cells.sorted = (0..centres.len()).map(|i| (cells.home(i), i)).collect();
        cells.sorted.sort_unstable();
        cells
    }

    fn home(&self, sphere: usize) -> [i64; D] {
        self.centres[sphere].map(|x| (x / self.width).floor() as i64)
    }

    /// Visits every pair i < j whose centres are nearer than the cells are wide, and some that are not.
    fn pairs(&self, mut visit: impl FnMut(usize, usize)) {
        for i in 0..self.centres.len() {
            let home = self.home(i);
            for code in 0..3_usize.pow(D as u32) {
                let near: [i64; D] = std::array::from_fn(|k| home[k] + (code / 3_usize.pow(k as u32) % 3) as i64 - 1);
                let from = self.sorted.partition_point(|(cell, j)| (cell, *j) <= (&near, i));
                for &(_, j) in self.sorted[from..].iter().take_while(|(cell, _)| *cell == near) {
                    visit(i, j);
                }
            }
        }
    }
}

/// Looks for two spheres that are no contact of the packing at rest and whose surfaces are nearer than `margin` (m) now.
pub(super) fn nearing_strangers<const D: usize>(
    sample: &Sample<D>,
    mirrors: &[Mirror],
    centres: &[[f64; D]],
    known: impl Fn(usize, usize) -> bool,
    margin: f64,
) -> Option<[usize; 2]> {
    let spheres = &sample.spheres;
    let mut found = None;
    Cells::new(centres, widest(sample) + margin).pairs(|i, j| {
        let squared: f64 = (0..D).map(|k| (centres[j][k] - centres[i][k]).powi(2)).sum();
        let near = spheres[i].radius + spheres[j].radius + margin;
        if squared < near * near && !known(i, j) {
            found.get_or_insert([i, j]);
        }
    });
    // A sphere and its own image; with the image of another it meets no sooner than with that other itself.
    let image = (0..spheres.len()).find(|&i| {
        mirrors.iter().any(|mirror| {
            !mirror.carries(&spheres[i].centre, spheres[i].radius)
                && 2.0 * (mirror.distance(&centres[i]) - spheres[i].radius) < margin
                && !known(i, i)
        })
    });
    found.or(image.map(|i| [i, i]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::find;
    use crate::sample::Sphere;

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

    /// In an open sheet of R rows by C columns each row has C − 1 contacts and each pair of rows 2C − 1.
    #[test]
    fn a_hexagonal_sheet_has_its_contacts() {
        assert_eq!(Touching::find(&sheet(7, 9), &[]).unwrap().pairs.len(), 7 * 8 + 6 * 17);
    }

    /// Second neighbours lie √3 diameters apart.
    #[test]
    fn strangers_are_found_from_the_second_neighbours_gap_on() {
        let sample = sheet(7, 9);
        let pairs = Touching::find(&sample, &[]).unwrap().pairs;
        let known = |i, j| pairs.binary_search_by_key(&[i, j], |touch| touch.pair).is_ok();
        let centres: Vec<_> = sample.spheres.iter().map(|s| s.centre).collect();
        let gap = 3_f64.sqrt() - 1.0;
        assert_eq!(nearing_strangers(&sample, &[], &centres, known, gap - 1e-9), None);
        assert!(nearing_strangers(&sample, &[], &centres, known, gap + 1e-9).is_some());
    }

    #[test]
    fn spheres_half_a_diameter_from_a_mirror_touch_their_image() {
        let mirror = Mirror { axis: 0, position: 0.0, inward: 1.0 };
        let touching = Touching::find(&sheet(4, 5), &[mirror]).unwrap();
        let spheres: Vec<usize> = touching.images.iter().map(|t| t.sphere).collect();
        assert_eq!(spheres, [5, 15]);
    }

    #[test]
    fn overlapping_spheres_are_refused() {
        let mut sample = sheet(2, 2);
        sample.spheres[1].centre[0] -= 0.01;
        assert_eq!(Touching::find(&sample, &[]).map(|_| ()).unwrap_err().pair, [0, 1]);
    }
}
