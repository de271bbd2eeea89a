//! The tray of a crystal in space: a floor and a wall around it, as a closed solid.
//!
//! The layers lie in it one upon the other, the struck one on top. The wall touches the outermost spheres: four flat sides around a rectangle, six around a
//! hexagon, and around a round crystal a cylinder, which is cut into so many flats that none stands off it by more than some micrometres. It ends at the centres
//! of the struck layer, so that what strikes meets spheres half a diameter before it could meet the wall.

use std::f64::consts::PI;

use super::frame::Solid;
use super::piece::Piece;
use crate::lattice::Outline;

/// Lengths of the tray (mm).
#[derive(Clone, Debug, PartialEq)]
pub struct Tray {
    /// Corners of the inner face of the wall, counter-clockwise seen from the struck side: x, y from the crystal's axis.
    pub inner: Vec<[f64; 2]>,
    /// The same of the outer face.
    pub outer: Vec<[f64; 2]>,
    /// Of the wall above the floor.
    pub height: f64,
    /// Thickness of the floor.
    pub floor: f64,
    /// How wide it is inside, across x and y.
    pub width: [f64; 2],
}

/// Flats of a cylinder.
const FLATS: usize = 240;

impl Tray {
    /// Around the layers of a crystal, of which the deepest is `depth` below the first, with so much room between it and the wall; wall and floor are as
    /// thick as they are said to be (mm).
    pub fn new((layers, outline): (&[Piece], Outline), depth: f64, clearance: f64, [wall, floor]: [f64; 2]) -> Self {
        let radius = layers.first().map_or(0.0, |layer| 0.5 * layer.diameter);
        let places = || layers.iter().flat_map(|layer| layer.spheres.iter().map(move |sphere| layer.place(sphere)));
        // How far the outermost spheres reach along a direction.
        let reach = |[x, y]: [f64; 2]| {
            let along = places().map(|at| at[0] * x + at[1] * y).fold(f64::NEG_INFINITY, f64::max);
            along + radius + clearance
        };
        // A regular polygon whose sides are so far from the axis; the first corner stands at an angle.
        let regular = |sides: usize, to_side: f64, first: f64| -> Vec<[f64; 2]> {
            let step = 2.0 * PI / sides as f64;
            let corner = to_side / (0.5 * step).cos();
            (0..sides).map(|k| first + step * k as f64).map(|at| [corner * at.cos(), corner * at.sin()]).collect()
        };
        let (inner, outer) = match outline {
            Outline::All => {
                let [right, top, left, bottom] = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]].map(reach);
                let around = |more: f64| {
                    let [l, b, r, t] = [-left - more, -bottom - more, right + more, top + more];
                    vec![[l, b], [r, b], [r, t], [l, t]]
                };
                (around(0.0), around(wall))
            }
            Outline::Hexagon(_) => {
                let normals = (0..6).map(|k| PI / 6.0 + PI / 3.0 * f64::from(k));
                let to_side = normals.map(|at| reach([at.cos(), at.sin()])).fold(0.0, f64::max);
                (regular(6, to_side, 0.0), regular(6, to_side + wall, 0.0))
            }
            Outline::Disk(_) => {
                let far = places().map(|[x, y]| x.hypot(y)).fold(0.0, f64::max) + radius + clearance;
                (regular(FLATS, far, 0.0), regular(FLATS, far + wall, 0.0))
            }
        };
        let across = |axis: usize| {
            let ends = inner.iter().map(|corner| corner[axis]);
            ends.clone().fold(f64::NEG_INFINITY, f64::max) - ends.fold(f64::INFINITY, f64::min)
        };
        let width = [across(0), across(1)];
        Self { inner, outer, height: depth + radius, floor, width }
    }

    /// Floor and wall (mm³).
    pub fn volume(&self) -> f64 {
        let area = |corners: &[[f64; 2]]| {
            let sides = corners.iter().zip(corners.iter().cycle().skip(1));
            0.5 * sides.map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum::<f64>()
        };
        area(&self.outer) * (self.floor + self.height) - area(&self.inner) * self.height
    }

    /// The surface: z up from the floor on which the last layer lies.
    pub fn solid(&self) -> Solid {
        let (low, high) = (-self.floor, self.height);
        let at = |[x, y]: [f64; 2], z: f64| [x, y, z];
        let mut triangles = Vec::new();
        let count = self.inner.len();
        for k in 0..count {
            let next = (k + 1) % count;
            let ([a, b], [c, d]) = ([self.outer[k], self.outer[next]], [self.inner[k], self.inner[next]]);
            let mut quad = |corners: [[f64; 3]; 4]| {
                triangles.push([corners[0], corners[1], corners[2]]);
                triangles.push([corners[0], corners[2], corners[3]]);
            };
            quad([at(a, low), at(b, low), at(b, high), at(a, high)]);
            quad([at(d, 0.0), at(c, 0.0), at(c, high), at(d, high)]);
            quad([at(a, high), at(b, high), at(d, high), at(c, high)]);
            // Fans from the first corner, below and on the floor.
            if k > 0 && next > 0 {
                triangles.push([at(self.outer[0], low), at(b, low), at(a, low)]);
                triangles.push([at(self.inner[0], 0.0), at(c, 0.0), at(d, 0.0)]);
            }
        }
        Solid { triangles }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::build::piece::Kind;
    use crate::layout::PieceSphere;

    /// Every directed edge occurs once and its opposite once, so that the surface is closed and looks outwards; what it encloses is what floor and wall hold; and
    /// the wall touches the outermost spheres and cuts none.
    #[test]
    fn trays_are_closed_and_touch_the_outermost_spheres() {
        let sphere = |x: f64, y: f64| PieceSphere { row: 1, column: 1, x, z: -y, material: 0, site: 0 };
        let third = PI / 3.0;
        let corner = |k: u8| sphere(0.03 * (third * f64::from(k)).cos(), 0.03 * (third * f64::from(k)).sin());
        let hexagon: Vec<PieceSphere> = (0..6).map(corner).collect();
        for outline in [Outline::All, Outline::Hexagon(5.0), Outline::Disk(5.0)] {
            let piece = Piece {
                name: "one".to_owned(),
                diameter: 6.0,
                spheres: hexagon.clone(),
                marks: Vec::new(),
                rows: 1,
                kind: Kind::Layer { number: 1, of: 1, below: Vec::new() },
            };
            let tray = Tray::new((std::slice::from_ref(&piece), outline), 20.0, 0.0, [8.0, 4.0]);
            let solid = tray.solid();
            let mut edges: BTreeMap<[[u64; 3]; 2], i32> = BTreeMap::new();
            for triangle in &solid.triangles {
                let corners = triangle.map(|corner| corner.map(f64::to_bits));
                for k in 0..3 {
                    *edges.entry([corners[k], corners[(k + 1) % 3]]).or_default() += 1;
                }
            }
            assert!(edges.iter().all(|([a, b], count)| *count == 1 && edges.get(&[*b, *a]) == Some(&1)), "{outline:?}");
            assert!((solid.volume() / tray.volume() - 1.0).abs() < 1e-12, "{outline:?}");
            // From every centre to the nearest side, by its line.
            let sides: Vec<_> = tray.inner.iter().zip(tray.inner.iter().cycle().skip(1)).collect();
            let gap = |at: [f64; 2]| {
                let off = |(a, b): &(&[f64; 2], &[f64; 2])| {
                    let along = [b[0] - a[0], b[1] - a[1]];
                    (along[0] * (at[1] - a[1]) - along[1] * (at[0] - a[0])) / along[0].hypot(along[1])
                };
                sides.iter().map(off).fold(f64::INFINITY, f64::min) - 3.0
            };
            let gaps: Vec<f64> = piece.spheres.iter().map(|sphere| gap(piece.place(sphere))).collect();
            let least = gaps.iter().copied().fold(f64::INFINITY, f64::min);
            // A flat of the cylinder stands off it by r (1/cos(pi/240) - 1) at most, 3 um of 33 mm.
            assert!(least > -1e-9 && least < 3e-3, "{outline:?}: {gaps:?}");
        }
    }
}
