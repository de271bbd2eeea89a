//! Rigid faces: walls, anvils, impactors.

use super::law::{Friction, Law};

/// A rigid plane or a bounded piece of one. It moves as a whole and does not turn.
///
/// A sphere against a flat counts as two equal spheres at twice the overlap and twice the closing speed (Burgoyne 2016,
/// appendix A.1, 2.c.ii), unless the flat is of a material of its own.
#[derive(Clone, Debug, PartialEq)]
pub struct Flat<const D: usize> {
    /// Name, for records and messages.
    pub name: String,
    /// A point of the plane (m).
    pub point: [f64; D],
    /// Unit normal, towards the spheres.
    pub normal: [f64; D],
    /// Which part of the plane there is.
    pub face: Face<D>,
    /// Mass (kg); infinite for a flat that keeps its velocity whatever strikes it.
    pub mass: f64,
    /// Velocity at the start (m/s); a wall has none.
    pub velocity: [f64; D],
    /// The axes along which it cannot move.
    pub held: [bool; D],
    /// As what spheres meet it.
    pub contact: FlatContact,
}

/// As what spheres meet a flat; by default as a sphere like themselves.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FlatContact {
    /// Index of its material in the sample: it is met as an elastic half-space of that, a sphere without curvature. E*, yield stress and
    /// friction are those of the two materials, r* is the sphere's radius, overlap and speeds are the sphere's own; strain rates are those of two
    /// spheres of its size.
    pub material: Option<usize>,
    /// Law of its contacts, in place of that between the materials.
    pub law: Option<Law>,
    /// Friction at it, in place of that between the materials.
    pub friction: Option<Friction>,
}

impl FlatContact {
    /// Whether it is met as what it is, not as a sphere like the one that meets it.
    pub(super) fn is_own(&self) -> bool {
        self.material.is_some()
    }

    /// Whether there is nothing of its own about it.
    pub(super) fn is_usual(&self) -> bool {
        *self == Self::default()
    }
}

/// Which part of its plane a flat covers.
#[derive(Clone, Debug, PartialEq)]
pub enum Face<const D: usize> {
    /// All of it: a half-space of solid behind the plane.
    Plane,
    /// The piece between corners: two in the plane (a line), three or more in space (a convex polygon, in order around).
    /// It has no thickness; a sphere feels its nearest point, an edge or corner where that is it.
    Polygon(Vec<[f64; D]>),
}

fn dot<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    (0..D).map(|k| a[k] * b[k]).sum()
}

fn minus<const D: usize>(a: &[f64; D], b: &[f64; D]) -> [f64; D] {
    std::array::from_fn(|k| a[k] - b[k])
}

/// The point nearest to `at` on the line from `a` to `b`.
fn on_line<const D: usize>(at: &[f64; D], a: &[f64; D], b: &[f64; D]) -> [f64; D] {
    let along = minus(b, a);
    let share = (dot(&minus(at, a), &along) / dot(&along, &along)).clamp(0.0, 1.0);
    std::array::from_fn(|k| a[k] + share * along[k])
}

impl<const D: usize> Flat<D> {
    /// A wall: fixed, unbounded.
    pub fn wall(name: impl Into<String>, point: [f64; D], normal: [f64; D]) -> Self {
        Self {
            name: name.into(),
            point,
            normal,
            face: Face::Plane,
            mass: f64::INFINITY,
            velocity: [0.0; D],
            held: [true; D],
            contact: FlatContact::default(),
        }
    }

    /// Distance (m) of a centre from the flat moved by `moved`, and the unit vector from the flat to the centre. For a
    /// plane the distance is negative behind it.
    pub fn distance(&self, moved: &[f64; D], centre: &[f64; D]) -> (f64, [f64; D]) {
        // Differences are taken before the displacement is added: a sphere that touches at rest does so exactly.
        let at = minus(centre, moved);
        let height = dot(&minus(&at, &self.point), &self.normal);
        let Face::Polygon(corners) = &self.face else { return (height, self.normal) };
        let nearest = match corners.as_slice() {
            [a, b] => on_line(&at, a, b),
            _ => self.nearest_in_polygon(&at, height, corners),
        };
        let apart = minus(&at, &nearest);
        let distance = dot(&apart, &apart).sqrt();
        if distance == 0.0 { (0.0, self.normal) } else { (distance, apart.map(|x| x / distance)) }
    }

    /// The foot of the perpendicular where it lies within all edges, else the nearest point of an edge.
    fn nearest_in_polygon(&self, at: &[f64; D], height: f64, corners: &[[f64; D]]) -> [f64; D] {
        let foot: [f64; D] = std::array::from_fn(|k| at[k] - height * self.normal[k]);
        let centre: [f64; D] =
            std::array::from_fn(|k| corners.iter().map(|c| c[k]).sum::<f64>() / corners.len() as f64);
        let edges = || corners.iter().zip(corners.iter().cycle().skip(1));
        // Inside a convex polygon the foot lies on the centre's side of every edge.
        let within = edges().all(|(a, b)| {
            let along = minus(b, a);
            let scale = dot(&along, &along);
            let across = |p: &[f64; D]| {
                let from = minus(p, a);
                let share = dot(&from, &along) / scale;
                std::array::from_fn::<f64, D, _>(|k| from[k] - share * along[k])
            };
            dot(&across(&foot), &across(&centre)) >= 0.0
        });
        if within {
            return foot;
        }
        edges()
            .map(|(a, b)| on_line(at, a, b))
            .min_by(|p, q| dot(&minus(at, p), &minus(at, p)).total_cmp(&dot(&minus(at, q), &minus(at, q))))
            .unwrap_or(foot)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square plate of side 2 about the origin: above its middle, beside an edge, beyond a corner.
    #[test]
    fn the_nearest_point_of_a_plate_is_face_edge_or_corner() {
        let corners = vec![[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]];
        let plate = Flat { face: Face::Polygon(corners), ..Flat::wall("plate", [0.0; 3], [0.0, 0.0, 1.0]) };
        let moved = [0.0, 0.0, 0.5];
        let distance = |x, y, z| plate.distance(&moved, &[x, y, z + 0.5]).0;
        assert!((distance(0.3, -0.9, 2.0) - 2.0).abs() < 1e-15);
        assert!((distance(4.0, 0.5, 4.0) - 5.0).abs() < 1e-15);
        assert!((distance(3.0, 4.0, 6.0) - 7.0).abs() < 1e-15);
        let (_, normal) = plate.distance(&moved, &[4.0, 0.5, 4.5]);
        assert!((normal[0] - 0.6).abs() < 1e-15 && (normal[2] - 0.8).abs() < 1e-15);
    }

    #[test]
    fn a_plane_counts_depth_behind_it_as_negative() {
        let wall = Flat::wall("wall", [0.0, 1.0], [0.0, -1.0]);
        assert_eq!(wall.distance(&[0.0, 0.0], &[7.0, 1.5]).0, -0.5);
        assert_eq!(wall.distance(&[0.0, 1.0], &[7.0, 1.5]).0, 0.5);
    }
}
