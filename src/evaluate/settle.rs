//! How unequal spheres lie in a frame under gravity: the place of least energy near the sites that they were laid on.
//!
//! Contacts are Hertz's, walls rigid, without friction; energy, elastic and of height, is made least by the fast inertial relaxation engine (E. Bitzek
//! and others, Phys. Rev. Lett. 97, 170201, 2006), motion whose velocity is turned along the force and set to zero where it climbs. Spheres
//! move by as much as diameters differ, so who may touch whom is found once.

use crate::contact::Pair;
use crate::design::Design;
use crate::material::Material;

use super::held::HeldSphere;

/// Standard gravity (m/s²).
pub const GRAVITY: f64 = 9.806_65;

/// Walls: at how much to both sides of the axis, and how deep (m).
#[derive(Clone, Copy, Debug)]
pub(super) struct Room {
    pub side: f64,
    pub depth: f64,
}

/// Net force on any sphere, as a part of its weight, at which it lies.
const STILL: f64 = 1e-2;
/// Steps after which nothing more is expected.
const MOST: u32 = 60_000;

/// A piece that comes to rest nowhere near its sites.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SettleError {
    /// A sphere leaves its site.
    #[error("the stack does not stand under gravity: the sphere of row {row} at x = {x} mm leaves its site")]
    Falls {
        /// Its row.
        row: u32,
        /// Where it lay (mm from the axis).
        x: f64,
    },
    /// No rest was found.
    #[error("no rest was found under gravity: a net force of {part} of a sphere's weight is left")]
    Restless {
        /// Over the sphere's weight.
        part: f64,
    },
}

/// Moves spheres to where they lie; also by how far the farthest has moved (m).
pub(super) fn settle(
    design: &Design,
    palette: &[Material],
    spheres: &mut [HeldSphere],
    room: Room,
) -> Result<f64, SettleError> {
    let contacts = Contacts::new(design, palette, spheres, room);
    let count = spheres.len();
    let mass: Vec<f64> = spheres.iter().map(|s| palette[s.material].sphere_mass(s.diameter).max(1e-9)).collect();
    // With unit masses in place of their own light spheres are no slower than heavy ones; the place of rest is the same.
    let unit = mass.iter().sum::<f64>() / count.max(1) as f64;
    let start: Vec<[f64; 2]> = spheres.iter().map(|sphere| sphere.centre).collect();
    let (mut moved, mut velocity) = (vec![[0.0; 2]; count], vec![[0.0; 2]; count]);
    let diameter = design.lattice.diameter();
    // A tenth of the period of a contact that carries what lies above it.
    let weight = unit * GRAVITY * f64::from(design.lattice.rows());
    let stiffness = 1.5 * contacts.stiffest.powf(2.0 / 3.0) * weight.cbrt();
    let longest = 0.6 * (unit / stiffness).sqrt();
    let (mut step, mut mix, mut downhill) = (0.3 * longest, 0.1, 0);
    let mut force = vec![[0.0; 2]; count];
    let mut left = f64::INFINITY;
    for iteration in 0..MOST {
        contacts.forces(&moved, &mass, &mut force);
        if iteration % 50 == 0 {
            let over = |(f, m): (&[f64; 2], &f64)| f[0].hypot(f[1]) / (m * GRAVITY);
            left = force.iter().zip(&mass).map(over).fold(0.0, f64::max);
            if left < STILL {
                break;
            }
            if let Some(k) = moved.iter().position(|by| by[0].hypot(by[1]) > 0.25 * diameter) {
                return Err(SettleError::Falls { row: spheres[k].row, x: 1e3 * start[k][0] });
            }
        }
        let dot = |a: &[[f64; 2]], b: &[[f64; 2]]| a.iter().zip(b).map(|(a, b)| a[0] * b[0] + a[1] * b[1]).sum::<f64>();
        if dot(&force, &velocity) > 0.0 {
            let scale = (dot(&velocity, &velocity) / dot(&force, &force).max(f64::MIN_POSITIVE)).sqrt();
            for (v, f) in velocity.iter_mut().zip(&force) {
                *v = std::array::from_fn(|k| (1.0 - mix) * v[k] + mix * scale * f[k]);
            }
            downhill += 1;
            if downhill > 5 {
                step = (1.1 * step).min(longest);
                mix *= 0.99;
            }
        } else {
            velocity.iter_mut().for_each(|v| *v = [0.0; 2]);
            (step, mix, downhill) = (0.5 * step, 0.1, 0);
        }
        for i in 0..count {
            for k in 0..2 {
                velocity[i][k] += step * force[i][k] / unit;
                moved[i][k] += step * velocity[i][k];
            }
        }
    }
    if left >= STILL {
        return Err(SettleError::Restless { part: left });
    }
    for (sphere, by) in spheres.iter_mut().zip(&moved) {
        sphere.centre = std::array::from_fn(|k| sphere.centre[k] + by[k]);
    }
    Ok(moved.iter().map(|by| by[0].hypot(by[1])).fold(0.0, f64::max))
}

/// Who may touch whom, with the coefficients of Hertz's law.
struct Contacts {
    /// Indices, the way from the first centre to the second (m), sum of radii (m), coefficient.
    pairs: Vec<(usize, usize, [f64; 2], f64, f64)>,
    /// Index, axis, the wall's side of it, gap at the start (m), coefficient.
    walls: Vec<(usize, usize, f64, f64, f64)>,
    stiffest: f64,
}

impl Contacts {
    fn new(design: &Design, palette: &[Material], spheres: &[HeldSphere], room: Room) -> Self {
        let diameter = design.lattice.diameter();
        let there = |i: &usize| spheres[*i].diameter > 0.0;
        let coefficient = |i: usize, j: usize| {
            let materials = [i, j].map(|k| &palette[spheres[k].material]);
            Pair::new(materials, [i, j].map(|k| 0.5 * spheres[k].diameter), design.constants).hertz_coefficient()
        };
        let mut pairs = Vec::new();
        // In order of rows, so that those below are near in the list.
        for i in (0..spheres.len()).filter(there) {
            let near = (i + 1..spheres.len()).take_while(|&j| spheres[j].row <= spheres[i].row + 1);
            for j in near.filter(there) {
                let way: [f64; 2] = std::array::from_fn(|k| spheres[j].centre[k] - spheres[i].centre[k]);
                if way[0].hypot(way[1]) < 1.3 * diameter {
                    let reach = 0.5 * (spheres[i].diameter + spheres[j].diameter);
                    pairs.push((i, j, way, reach, coefficient(i, j)));
                }
            }
        }
        let mut walls = Vec::new();
        for i in (0..spheres.len()).filter(there) {
            let (radius, [x, z]) = (0.5 * spheres[i].diameter, spheres[i].centre);
            // A sphere against a flat counts as two equal ones at twice the overlap.
            let k = coefficient(i, i) * 2.0_f64.powf(1.5);
            for (axis, side, gap) in
                [(0, -1.0, x + room.side - radius), (0, 1.0, room.side - x - radius), (1, 1.0, room.depth - z - radius)]
            {
                if gap < diameter {
                    walls.push((i, axis, side, gap, k));
                }
            }
        }
        let stiffest = pairs.iter().map(|pair| pair.4).chain(walls.iter().map(|wall| wall.4)).fold(0.0, f64::max);
        Self { pairs, walls, stiffest }
    }

    fn forces(&self, moved: &[[f64; 2]], mass: &[f64], force: &mut [[f64; 2]]) {
        for (f, m) in force.iter_mut().zip(mass) {
            *f = [0.0, m * GRAVITY];
        }
        for &(i, j, way, reach, k) in &self.pairs {
            let apart: [f64; 2] = std::array::from_fn(|a| way[a] + moved[j][a] - moved[i][a]);
            let squared = apart[0] * apart[0] + apart[1] * apart[1];
            if squared < reach * reach {
                let distance = squared.sqrt();
                let overlap = reach - distance;
                let push = k * overlap * overlap.sqrt() / distance;
                for a in 0..2 {
                    force[i][a] -= push * apart[a];
                    force[j][a] += push * apart[a];
                }
            }
        }
        for &(i, axis, side, gap, k) in &self.walls {
            let overlap = side * moved[i][axis] - gap;
            if overlap > 0.0 {
                force[i][axis] -= side * k * overlap * overlap.sqrt();
            }
        }
    }
}
