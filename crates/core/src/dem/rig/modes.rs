//! Small vibrations of a rig about the state that it is in: normal modes, and what they let through.
//!
//! A closed contact with normal n, stiffness K = dF/dδ, force F and distance d of the centres answers relative displacements with
//!
//!   B = K n nᵀ − (F/d)(1 − n nᵀ)
//!
//! of which the second part is what the force itself does as the contact turns (1 the unit matrix). The dynamical matrix is the sum of
//! all B over √(m m'); its eigenvalues are ω². K is that of unloading: a small wave squeezes and releases, and a contact that has yielded
//! releases elastically.

use super::eigen;
use super::flat::Face;
use super::simulation::Simulation;
use super::{Body, Rig};

/// Normal modes, the slowest first.
#[derive(Clone, Debug, PartialEq)]
pub struct Modes {
    /// ω² (1/s²); below zero where the state is no stable one, and about zero for what moves freely.
    pub squared: Vec<f64>,
    /// Sphere and axis of each degree of freedom.
    pub freedoms: Vec<(usize, usize)>,
    /// Of each mode √m u of every degree of freedom, of unit length.
    pub shapes: Vec<Vec<f64>>,
    /// √m of each degree of freedom (√kg).
    roots: Vec<f64>,
}

/// A rig whose small vibrations are not known.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ModesError {
    /// Something in it is left out of the equations.
    #[error("small vibrations do not know {0}")]
    Part(&'static str),
    /// The matrix would be too large.
    #[error("{freedoms} degrees of freedom are too many: up to {MOST} are worked out")]
    Size {
        /// How many there are.
        freedoms: usize,
    },
}

/// Degrees of freedom, at most: the work grows with their cube.
const MOST: usize = 2000;

impl Modes {
    /// The modes of a rig as it stands.
    ///
    /// # Errors
    /// See [`ModesError`]: friction and rotation, mirrors, rigid bodies, bars and flats that can move are not in it.
    pub fn of<const D: usize>(simulation: &Simulation<D>) -> Result<Self, ModesError> {
        let rig = simulation.rig();
        known(rig)?;
        let mut place = vec![[None; D]; rig.sample.spheres.len()];
        let mut freedoms = Vec::new();
        for (i, held) in rig.held.iter().enumerate() {
            for k in (0..D).filter(|&k| !held[k]) {
                place[i][k] = Some(freedoms.len());
                freedoms.push((i, k));
            }
        }
        if freedoms.len() > MOST {
            return Err(ModesError::Size { freedoms: freedoms.len() });
        }
        let roots: Vec<f64> = freedoms.iter().map(|&(i, _)| rig.mass[i].sqrt()).collect();
        let mut matrix = vec![vec![0.0; freedoms.len()]; freedoms.len()];
        for contact in simulation.view().contacts() {
            let normal = contact.normal;
            let (ends, turning) = match contact.bodies {
                [Body::Sphere(a), Body::Sphere(b)] => {
                    let radius = |i: usize| rig.sample.spheres[i].radius;
                    ([Some(a), Some(b)], contact.force / (radius(a) + radius(b) - contact.overlap))
                }
                [Body::Flat(f), Body::Sphere(i)] | [Body::Sphere(i), Body::Flat(f)] => {
                    // A plane does not turn its force; edges and corners are left out.
                    if rig.flats[f].face != Face::Plane && simulation.view().flat(f).moved != [0.0; D] {
                        return Err(ModesError::Part("plates that have moved"));
                    }
                    ([Some(i), None], 0.0)
                }
                [Body::Flat(_), Body::Flat(_)] => continue,
            };
            for j in 0..D {
                for k in 0..D {
                    let across = f64::from(u8::from(j == k)) - normal[j] * normal[k];
                    let block = contact.stiffness * normal[j] * normal[k] - turning * across;
                    for (p, first) in ends.iter().enumerate() {
                        for (q, second) in ends.iter().enumerate() {
                            let (Some(first), Some(second)) = (first, second) else { continue };
                            let (Some(row), Some(column)) = (place[*first][j], place[*second][k]) else { continue };
                            let sign = if p == q { 1.0 } else { -1.0 };
                            matrix[row][column] += sign * block / (roots[row] * roots[column]);
                        }
                    }
                }
            }
        }
        let (eigenvalues, vectors) = eigen::symmetric(matrix);
        let mut order: Vec<usize> = (0..freedoms.len()).collect();
        order.sort_by(|&a, &b| eigenvalues[a].total_cmp(&eigenvalues[b]));
        Ok(Self {
            squared: order.iter().map(|&n| eigenvalues[n]).collect(),
            shapes: order.iter().map(|&n| vectors[n].clone()).collect(),
            freedoms,
            roots,
        })
    }

    /// Frequencies (Hz), the lowest first; zero for what moves freely.
    pub fn frequencies(&self) -> Vec<f64> {
        self.squared.iter().map(|squared| squared.max(0.0).sqrt() / std::f64::consts::TAU).collect()
    }

    /// How far the spheres `seen` move along an axis over how far those `driven` do, both on the mean, while the latter are driven by a
    /// harmonic force along it, at each frequency (Hz). Stiffness has a loss factor, k (1 + i loss).
    pub fn transmission(&self, axis: usize, [driven, seen]: [&[usize]; 2], frequencies: &[f64], loss: f64) -> Vec<f64> {
        // Of each mode the mean displacement of some spheres.
        let mean = |of: &[usize]| -> Vec<f64> {
            let chosen: Vec<usize> = (0..self.freedoms.len())
                .filter(|&n| self.freedoms[n].1 == axis && of.contains(&self.freedoms[n].0))
                .collect();
            let mean = |shape: &Vec<f64>| {
                chosen.iter().map(|&n| shape[n] / self.roots[n]).sum::<f64>() / chosen.len().max(1) as f64
            };
            self.shapes.iter().map(mean).collect()
        };
        let (driven, seen) = (mean(driven), mean(seen));
        let ratio = |frequency: &f64| {
            let squared = (std::f64::consts::TAU * frequency).powi(2);
            // Σ a/(ω_n² (1 + i loss) − ω²) as real and imaginary part.
            let (mut at_driven, mut at_seen) = ([0.0; 2], [0.0; 2]);
            for n in 0..self.squared.len() {
                let (real, imaginary) = (self.squared[n] - squared, loss * self.squared[n].abs());
                let size = real * real + imaginary * imaginary;
                for (sum, response) in [(&mut at_driven, driven[n]), (&mut at_seen, seen[n])] {
                    sum[0] += driven[n] * response * real / size;
                    sum[1] -= driven[n] * response * imaginary / size;
                }
            }
            at_seen[0].hypot(at_seen[1]) / at_driven[0].hypot(at_driven[1])
        };
        frequencies.iter().map(ratio).collect()
    }
}

/// Refuses what the equations leave out.
fn known<const D: usize>(rig: &Rig<D>) -> Result<(), ModesError> {
    let parts = [
        (rig.has_friction(), "friction"),
        (!rig.mirrors.is_empty(), "mirrors; take the periodic crystal"),
        (!rig.clusters.is_empty(), "rigid bodies of several spheres"),
        (!rig.bars.is_empty(), "bars"),
        (rig.flats.iter().any(|flat| flat.mass.is_finite()), "flats that can move"),
    ];
    match parts.into_iter().find(|(present, _)| *present) {
        Some((_, what)) => Err(ModesError::Part(what)),
        None => Ok(()),
    }
}
