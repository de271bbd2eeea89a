//! What strikes a bed.

use std::f64::consts::PI;

use serde::{Deserialize, Serialize};

use super::Disk;
use crate::dem::rig::{Cluster, Flat, Rig};
use crate::sample::Sphere;

/// Outline of an intruder, standing upright.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "shape", rename_all = "kebab-case")]
pub enum Outline {
    /// A disk.
    Disk {
        /// Diameter (d).
        diameter: f64,
    },
    /// An ellipse, as a rigid shell of disks (Kondic et al. 2012).
    Ellipse {
        /// Half its width (d).
        half_width: f64,
        /// Half its height (d).
        half_height: f64,
    },
    /// Pointed below and above: two arcs that meet in tips, as a rigid shell of disks.
    Ogive {
        /// Half its width (d).
        half_width: f64,
        /// Half its height (d), at least half its width.
        half_height: f64,
    },
    /// A rigid flat as wide as this, without thickness, that does not turn.
    Flat {
        /// Width (d).
        width: f64,
    },
}

/// How an intruder's mass lies, which sets its moment of inertia.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Body {
    /// Evenly over the outline.
    #[default]
    Solid,
    /// In a shell one diameter thick.
    Hollow,
}

/// An intruder.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Intruder {
    /// Its outline.
    #[serde(flatten)]
    pub outline: Outline,
    /// Its mass (that of a disk of diameter d).
    pub mass: f64,
    /// How it lies.
    pub body: Body,
    /// Whether it can turn.
    pub turns: bool,
    /// Its downward speed at the start (d/τ_c).
    pub speed: f64,
    /// How high its lowest point is over the surface at the start (d).
    pub height: f64,
}

/// Diameter of the disks that shells are made of (d).
const SHELL: f64 = 1.0;

impl Outline {
    /// Half its height (d).
    pub fn half_height(&self) -> f64 {
        match *self {
            Self::Disk { diameter } => 0.5 * diameter,
            Self::Ellipse { half_height, .. } | Self::Ogive { half_height, .. } => half_height,
            Self::Flat { .. } => 0.0,
        }
    }

    /// Half its width (d).
    pub fn half_width(&self) -> f64 {
        match *self {
            Self::Disk { diameter } => 0.5 * diameter,
            Self::Ellipse { half_width, .. } | Self::Ogive { half_width, .. } => half_width,
            Self::Flat { width } => 0.5 * width,
        }
    }

    /// Mass of a disk as wide as it, the mass Kondic et al. 2012 give to every shape.
    pub fn usual_mass(&self) -> f64 {
        (2.0 * self.half_width()).powi(2)
    }

    /// Points of the outline `inset` inside it, evenly spaced along it, about `apart` from each other, a multiple of so many.
    fn points(&self, inset: f64, apart: f64, multiple: usize) -> Vec<[f64; 2]> {
        let [a, b] = [self.half_width() - inset, self.half_height() - inset];
        // A fine polygon once around, then even steps along it.
        const FINE: usize = 7200;
        let at = |k: usize| -> [f64; 2] {
            let angle = 2.0 * PI * k as f64 / FINE as f64;
            match self {
                Self::Ogive { .. } => {
                    // Arcs through both tips and the widest points: radius (a² + b²)/(2a) about (±(a − radius), 0).
                    let radius = (a * a + b * b) / (2.0 * a);
                    let y = b * angle.sin();
                    let x = (radius * radius - y * y).max(0.0).sqrt() - (radius - a);
                    [if angle.cos() >= 0.0 { x } else { -x }, y]
                }
                _ => [a * angle.cos(), b * angle.sin()],
            }
        };
        let mut along = vec![0.0];
        for k in 0..FINE {
            let (p, q) = (at(k), at(k + 1));
            along.push(along[k] + (q[0] - p[0]).hypot(q[1] - p[1]));
        }
        let length = along[FINE];
        let count = ((length / apart).ceil().max(3.0) as usize).next_multiple_of(multiple);
        (0..count).map(|n| at(along.partition_point(|&s| s < n as f64 * length / count as f64))).collect()
    }

    /// Centres of the disks of its shell, from its centre (d): half a diameter apart, so that no grain finds its way between two,
    /// and each with its mirror image about the upright axis, on which both ends lie.
    pub fn shell(&self) -> Vec<[f64; 2]> {
        // Counted from the rightmost one on, the ends are a quarter and three quarters around.
        let points = self.points(0.5 * SHELL, 0.5 * SHELL, 4);
        let quarter = points.len() / 4;
        let end = self.half_height() - 0.5 * SHELL;
        let right = points[..quarter].iter().chain(&points[3 * quarter + 1..]);
        [[0.0, end], [0.0, -end]].into_iter().chain(right.flat_map(|&[x, y]| [[x, y], [-x, y]])).collect()
    }

    /// Square of the radius of gyration (d²): moment of inertia over mass.
    pub fn gyration(&self, body: Body) -> f64 {
        match (self, body) {
            (Self::Flat { width }, _) => width * width / 12.0,
            (Self::Disk { diameter }, Body::Solid) => diameter * diameter / 8.0,
            (Self::Disk { diameter }, Body::Hollow) => {
                let (outer, inner) = (0.5 * diameter, (0.5 * diameter - 1.0).max(0.0));
                0.5 * (outer * outer + inner * inner)
            }
            (Self::Ellipse { half_width: a, half_height: b }, Body::Solid) => 0.25 * (a * a + b * b),
            (Self::Ogive { .. }, Body::Solid) => {
                // ∫(x² + y²) dA/A over strips of half-width w(y): (w³/3 + w y²) and w.
                let (a, b) = (self.half_width(), self.half_height());
                let radius = (a * a + b * b) / (2.0 * a);
                let (mut second, mut area) = (0.0, 0.0);
                for k in 0..4000 {
                    let y = b * (k as f64 + 0.5) / 4000.0;
                    let w = (radius * radius - y * y).sqrt() - (radius - a);
                    second += w * w * w / 3.0 + w * y * y;
                    area += w;
                }
                second / area
            }
            (_, Body::Hollow) => {
                let ring = self.points(0.5 * SHELL, 0.1, 1);
                ring.iter().map(|[x, y]| x * x + y * y).sum::<f64>() / ring.len() as f64
            }
        }
    }
}

impl Intruder {
    /// Puts the intruder into a rig of a bed, its lowest point `height` over `surface` at `x`.
    pub fn place(&self, rig: &mut Rig<2>, x: f64, surface: f64) {
        let centre = [x, surface + self.height + self.outline.half_height()];
        let velocity = [0.0, -self.speed];
        let inertia = self.mass * self.outline.gyration(self.body);
        let add = |rig: &mut Rig<2>, Disk { centre, diameter }: Disk| {
            rig.sample.spheres.push(Sphere { centre, radius: 0.5 * diameter, material: 0 });
            rig.mass.push(self.mass);
            rig.inertia.push(inertia);
            rig.velocity.push(velocity);
            rig.spin.push([0.0; 3]);
            rig.held.push([false; 2]);
            rig.sample.spheres.len() - 1
        };
        match self.outline {
            Outline::Disk { diameter } => {
                let disk = add(rig, Disk { centre, diameter });
                if !self.turns {
                    // Without friction torques have nothing to turn; with it, an inertia beyond all others holds it.
                    rig.inertia[disk] = inertia * 1e12;
                }
            }
            Outline::Flat { width } => rig.flats.push(Flat {
                face: crate::dem::rig::Face::Polygon(vec![[x - 0.5 * width, centre[1]], [x + 0.5 * width, centre[1]]]),
                mass: self.mass,
                velocity,
                held: [true, false],
                ..Flat::wall("intruder", centre, [0.0, -1.0])
            }),
            Outline::Ellipse { .. } | Outline::Ogive { .. } => {
                // Half a diameter apart, so that no grain finds its way between two.
                let shell = self.outline.points(0.5 * SHELL, 0.5 * SHELL, 1);
                let members = (shell.into_iter())
                    .map(|[dx, dy]| add(rig, Disk { centre: [x + dx, centre[1] + dy], diameter: SHELL }))
                    .collect();
                rig.clusters.push(Cluster {
                    members,
                    centre,
                    mass: self.mass,
                    inertia,
                    turns: self.turns,
                    velocity,
                    spin: 0.0,
                });
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A circle written as an ellipse or as a shell has the radius of gyration of a disk, R²/2, and of a ring, R²; every
    /// outline's disks reach its extents.
    #[test]
    fn outlines_have_their_extents_and_inertia() {
        let circle = Outline::Ellipse { half_width: 5.0, half_height: 5.0 };
        assert!((circle.gyration(Body::Solid) - 12.5).abs() < 1e-12);
        assert!((circle.gyration(Body::Hollow) - 4.5 * 4.5).abs() < 1e-6);
        // An ogive as high as wide is a disk.
        let round = Outline::Ogive { half_width: 5.0, half_height: 5.0 };
        assert!((round.gyration(Body::Solid) / 12.5 - 1.0).abs() < 1e-5);
        for outline in [
            Outline::Ellipse { half_width: 4.0, half_height: 9.0 },
            Outline::Ogive { half_width: 4.0, half_height: 9.0 },
        ] {
            let points = outline.points(0.5, 0.5, 1);
            let extent = |k: usize| points.iter().map(|p| p[k].abs()).fold(0.0, f64::max) + 0.5;
            assert!((extent(0) - 4.0).abs() < 0.02 && (extent(1) - 9.0).abs() < 0.05, "{outline:?}");
            for (k, p) in points.iter().enumerate() {
                let q = points[(k + 1) % points.len()];
                assert!((p[0] - q[0]).hypot(p[1] - q[1]) < 0.51, "{outline:?}: no gaps");
            }
            // A shell is its own mirror image, and its ends lie on the axis.
            let shell = outline.shell();
            assert!(shell.iter().all(|p| shell.contains(&[0.0 - p[0], p[1]])), "{outline:?}");
            assert_eq!(shell.iter().filter(|p| p[0] == 0.0 && (p[1].abs() - 8.5).abs() < 1e-9).count(), 2);
            let nearest = |p: &[f64; 2]| {
                let others = shell.iter().filter(|q| *q != p);
                others.map(|q| (p[0] - q[0]).hypot(p[1] - q[1])).fold(f64::INFINITY, f64::min)
            };
            assert!(shell.iter().all(|p| (0.4..0.51).contains(&nearest(p))), "{outline:?}");
        }
    }
}
