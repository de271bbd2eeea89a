//! Where the crystal ends: mirror planes and walls, and where it does not: periods.
//!
//! A mirror stands for the other half of a symmetric crystal. A sphere on it is half a sphere: it keeps no velocity across
//! the plane and carries weight 1/2 in every sum. A sphere half a diameter away touches its own image. A smooth wall is met as a mirror is.
//! Along a period the crystal goes on like itself: a contact across it is one like any other, from a sphere to the nearest image of the other.
//!
//! Planes that meet at an angle π/m stand for 2m − 1 images. No image of a sphere is nearer to another one, or to the sphere itself, than those by which they lie
//! between the planes, so that contacts there, and those with an image in one plane, are all that there are. What several elements of the group of
//! images leave in its place weighs one over their number: a sphere on one plane 1/2, on the line where two meet 1/2m, and contacts alike.

use crate::period::nearest_image;
use crate::real::Lanes;

/// A plane of symmetry across one axis. The simulated half lies on the side that `inward` points to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mirror {
    /// Axis that the plane cuts.
    pub axis: usize,
    /// Where on that axis (m).
    pub position: f64,
    /// +1.0 or −1.0: direction from the plane into the simulated half.
    pub inward: f64,
}

impl Mirror {
    /// Signed distance of a centre from the plane (m), positive inside.
    pub fn distance<const D: usize>(&self, centre: &[f64; D]) -> f64 {
        (centre[self.axis] - self.position) * self.inward
    }

    /// Whether a sphere's centre lies on the plane, to 10⁻⁹ of its radius.
    pub fn carries<const D: usize>(&self, centre: &[f64; D], radius: f64) -> bool {
        self.distance(centre).abs() < 1e-9 * radius
    }
}

/// A face in space that is across no axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Face {
    /// A plane along the last axis, otherwise of any direction, of symmetry or a smooth wall. What is simulated lies where `normal` points to. Two planes of
    /// symmetry that meet do so at an angle of π/m.
    Plane {
        /// Of unit length, across the last axis: what strikes moves no sphere through the plane.
        normal: [f64; 3],
        /// Along the normal (m).
        position: f64,
    },
    /// The inside of a smooth round wall about the last axis. A sphere meets it as it would meet the plane that touches the wall beside it.
    Cylinder {
        /// Of the wall (m).
        radius: f64,
    },
}

impl Face {
    /// Whether what moves along the last axis stays at one distance from it, and its normal is one.
    pub(super) fn is_along_last(&self) -> bool {
        match self {
            Self::Plane { normal, .. } => normal[2].abs() < RIGHT && (dot(normal, normal) - 1.0).abs() < RIGHT,
            Self::Cylinder { radius } => *radius > 0.0,
        }
    }

    /// The direction from it to a sphere that has been moved from its centre, and how much further away that is.
    #[inline(always)]
    pub(super) fn approach<V: Lanes, const D: usize>(&self, centre: &[f64; D], moved: &[V; D]) -> ([V; D], V) {
        let zero = V::splat(0.0);
        let mut normal = [zero; D];
        let mut away = zero;
        match self {
            Self::Plane { normal: given, .. } => {
                for k in 0..D {
                    normal[k] = V::splat(given[k]);
                    away = away + moved[k] * normal[k];
                }
            }
            Self::Cylinder { .. } => {
                // Distances from the axis, and their difference without that of two nearly equal numbers.
                let before = V::splat(centre[0].hypot(centre[1]));
                let (mut squared, mut gained) = (zero, zero);
                for k in 0..2 {
                    normal[k] = V::splat(centre[k]) + moved[k];
                    squared = squared + normal[k] * normal[k];
                    gained = gained + moved[k] * (V::splat(2.0 * centre[k]) + moved[k]);
                }
                let distance = squared.sqrt();
                let inverse = V::splat(1.0) / distance;
                away = zero - gained / (before + distance);
                for k in 0..2 {
                    normal[k] = zero - normal[k] * inverse;
                }
            }
        }
        (normal, away)
    }
}

/// All that a sphere may meet its image in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Surface {
    Mirror(Mirror),
    Face(Face),
}

impl From<Mirror> for Surface {
    fn from(mirror: Mirror) -> Self {
        Self::Mirror(mirror)
    }
}

impl Surface {
    /// Signed distance of a centre (m), positive inside.
    pub fn distance<const D: usize>(&self, centre: &[f64; D]) -> f64 {
        match *self {
            Self::Mirror(mirror) => mirror.distance(centre),
            Self::Face(Face::Plane { normal, position }) => dot(&taken(normal), centre) - position,
            Self::Face(Face::Cylinder { radius }) => radius - centre[0].hypot(centre[1]),
        }
    }

    /// Whether a sphere's centre lies on it, to 10⁻⁹ of its radius; none does on a round wall.
    pub fn carries<const D: usize>(&self, centre: &[f64; D], radius: f64) -> bool {
        match self {
            Self::Mirror(mirror) => mirror.carries(centre, radius),
            Self::Face(Face::Plane { .. }) => self.distance(centre).abs() < 1e-9 * radius,
            Self::Face(Face::Cylinder { .. }) => false,
        }
    }

    /// Direction from it to a centre.
    pub fn normal<const D: usize>(&self, centre: &[f64; D]) -> [f64; D] {
        let mut normal = [0.0; D];
        match *self {
            Self::Mirror(Mirror { axis, inward, .. }) => normal[axis] = inward,
            Self::Face(Face::Plane { normal: given, .. }) => normal = taken(given),
            Self::Face(Face::Cylinder { .. }) => {
                let from_axis = centre[0].hypot(centre[1]);
                (0..2).for_each(|k| normal[k] = -centre[k] / from_axis);
            }
        }
        normal
    }
}

/// The first components; faces are in space, and there these are all.
fn taken<const D: usize>(of_space: [f64; 3]) -> [f64; D] {
    std::array::from_fn(|k| of_space[k])
}

fn dot<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    (0..D).map(|k| a[k] * b[k]).sum()
}

/// Cosines below this are those of right angles.
const RIGHT: f64 = 1e-9;

/// On which surfaces each sphere of a packing lies, a bit for each of them.
#[derive(Clone, Debug)]
pub(super) struct Carried<const D: usize> {
    on: Vec<u32>,
    /// Directions of the surfaces that carry spheres; of the others none is asked for.
    normals: Vec<[f64; D]>,
}

impl<const D: usize> Carried<D> {
    /// Of spheres with these centres and greatest radii (m).
    pub fn new(spheres: impl Iterator<Item = ([f64; D], f64)>, surfaces: &[Surface]) -> Self {
        assert!(surfaces.len() <= 32, "{} faces are more than the 32 that there may be", surfaces.len());
        let on = |(centre, radius): ([f64; D], f64)| {
            let bits = surfaces.iter().enumerate().map(|(k, surface)| u32::from(surface.carries(&centre, radius)) << k);
            bits.fold(0, |all, bit| all | bit)
        };
        let normals = surfaces.iter().map(|surface| surface.normal(&[0.0; D])).collect();
        Self { on: spheres.map(on).collect(), normals }
    }

    fn all(&self, bits: u32) -> impl Iterator<Item = &[f64; D]> {
        self.normals.iter().enumerate().filter(move |(k, _)| bits >> k & 1 == 1).map(|(_, normal)| normal)
    }

    /// How many spheres there are.
    pub fn spheres(&self) -> usize {
        self.on.len()
    }

    /// The part of a sphere that belongs to what is simulated.
    pub fn weight(&self, sphere: usize) -> f64 {
        1.0 / elements(self.all(self.on[sphere]))
    }

    /// That of the contact of two spheres.
    pub fn weight_between(&self, [a, b]: [usize; 2]) -> f64 {
        1.0 / elements(self.all(self.on[a] & self.on[b]))
    }

    /// That of the contact of a sphere with its image in this direction, which belongs to both halves, and to all planes of the sphere's that it lies in.
    pub fn weight_of_image(&self, sphere: usize, towards: &[f64; D]) -> f64 {
        0.5 / elements(self.all(self.on[sphere]).filter(|normal| dot(normal, towards).abs() < RIGHT))
    }

    /// Of each sphere on a plane that is across no axis the directions, at right angles to each other, in which it does not move.
    pub fn held(&self, surfaces: &[Surface]) -> Vec<(usize, Vec<[f64; D]>)> {
        let is_turned = |surface: &Surface| u32::from(matches!(surface, Surface::Face(_)));
        let turned = surfaces.iter().enumerate().fold(0, |bits, (k, surface)| bits | is_turned(surface) << k);
        let held = self.on.iter().enumerate().filter(|(_, on)| **on & turned != 0);
        held.map(|(sphere, &on)| {
            let mut axes: Vec<[f64; D]> = Vec::new();
            for normal in self.all(on) {
                let mut left = *normal;
                for axis in &axes {
                    let along = dot(&left, axis);
                    (0..D).for_each(|k| left[k] -= along * axis[k]);
                }
                let length = dot(&left, &left).sqrt();
                if length > RIGHT {
                    axes.push(left.map(|part| part / length));
                }
            }
            (sphere, axes)
        })
        .collect()
    }
}

/// Elements of the group that planes through one place make: 2 for one, 2m for two at an angle of π/m, and those of groups at right angles multiply.
fn elements<'a, const D: usize>(normals: impl Iterator<Item = &'a [f64; D]>) -> f64 {
    let (mut count, mut before): (f64, Vec<&[f64; D]>) = (1.0, Vec::new());
    for normal in normals {
        let mut aslant = before.iter().map(|other| dot(normal, other)).filter(|cosine| cosine.abs() > RIGHT);
        count *= match (aslant.next(), aslant.next()) {
            (None, _) => 2.0,
            (Some(cosine), None) => {
                let (whole, exact) = fraction_of_half_turn(cosine);
                assert!((whole - exact).abs() < 1e-6, "planes of symmetry meet at 180/{exact} degrees");
                whole
            }
            _ => panic!("a plane of symmetry is aslant to two others"),
        };
        before.push(normal);
    }
    count
}

/// m of two planes that meet at an angle of π/m, by the cosine between their directions; and as it is without rounding to a whole number.
fn fraction_of_half_turn(cosine: f64) -> (f64, f64) {
    let exact = std::f64::consts::PI / (-cosine).acos();
    (exact.round(), exact)
}

/// Along an axis everything repeats itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Period {
    /// The axis.
    pub axis: usize,
    /// After which way (m): three of the greatest diameters or more, so that two spheres meet through one image alone.
    pub length: f64,
}

impl Period {
    /// From one centre to the nearest image of another, where `between` leads from one to the other (m).
    #[inline(always)]
    pub(super) fn nearest<const D: usize>(periods: &[Self], mut between: [f64; D]) -> [f64; D] {
        for Self { axis, length } in periods {
            between[*axis] = nearest_image(between[*axis], *length);
        }
        between
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plane(degrees: f64) -> Surface {
        let (sine, cosine) = degrees.to_radians().sin_cos();
        Surface::Face(Face::Plane { normal: [cosine, sine, 0.0], position: 0.0 })
    }

    /// Between planes that meet at 180/m degrees lies one of 2m parts; a third one across their line halves each.
    #[test]
    fn a_sphere_where_planes_meet_is_shared_by_all_their_images() {
        let across = Surface::Mirror(Mirror { axis: 2, position: 0.0, inward: 1.0 });
        for m in [2.0, 3.0, 4.0, 6.0] {
            // Directions into the part between the half-lines at 0 and 180/m degrees.
            let surfaces = [plane(90.0), plane(180.0 / m - 90.0), across];
            let (sine, cosine) = (std::f64::consts::PI / m).sin_cos();
            let centres = [[0.0; 3], [0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [cosine, sine, 0.0], [1.0, 0.3 * sine, 1.0]];
            let carried = Carried::new(centres.into_iter().map(|centre| (centre, 1e-3)), &surfaces);
            let weights = std::array::from_fn(|i| carried.weight(i));
            assert_eq!(weights, [0.25 / m, 0.5 / m, 0.5, 0.25, 1.0], "{m}");
            assert_eq!(carried.weight_between([0, 1]), 0.5 / m);
            assert_eq!((carried.weight_between([1, 2]), carried.weight_between([2, 3])), (0.5, 1.0));
            // The image in the plane across lies on the sphere's own planes; that in the other plane does not, but for right angles.
            assert_eq!(carried.weight_of_image(1, &[0.0, 0.0, 1.0]), 0.25 / m);
            let aslant = surfaces[1].normal(&centres[2]);
            assert_eq!(carried.weight_of_image(2, &aslant), if m == 2.0 { 0.25 } else { 0.5 });
            let held = carried.held(&surfaces);
            assert_eq!(
                held.iter().map(|(sphere, axes)| (*sphere, axes.len())).collect::<Vec<_>>(),
                [(0, 3), (1, 2), (2, 1), (3, 2)]
            );
        }
    }
}
