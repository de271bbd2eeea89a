//! The sections [[intruder]]: rigid bodies that strike the crystal from the front.

use std::ops::Range;

use super::acts::Stage;
use super::file::IntruderFile;
use super::place::{along_wave, no_axis, spin};
use crate::bed::{Body as Filling, Outline};
use crate::dem::rig::Cluster;
use crate::document::{DocumentError, Entry, Scope, is_plain_name};
use crate::material::Material;
use crate::sample::Sphere;
use crate::units::Dimension;

/// What to do about a key of another shape.
const CHANGE: &str = "Leave it out, or change intruder.shape.";

/// A rigid body that strikes the crystal.
#[derive(Clone, Debug, PartialEq)]
pub struct Intruder {
    /// Its name, for records and messages.
    pub name: String,
    /// Its spheres, behind those of the crystal: one, or the shell of a cluster.
    pub members: Range<usize>,
    /// The cluster that they are bound to, by its place in the rig; none for a single ball.
    pub cluster: Option<usize>,
    /// Its mass (kg).
    pub mass: f64,
}

/// What an intruder looks like.
#[derive(Clone, Copy, PartialEq)]
enum Shape {
    Ball,
    Ellipse,
    Ogive,
}

/// Puts an intruder before the crystal; `material` is its place in the sample's list.
pub(super) fn place<const D: usize>(
    stage: &mut Stage<D>,
    scope: &Scope,
    file: &IntruderFile,
    material: usize,
    known: &[Intruder],
) -> Result<Intruder, DocumentError> {
    let name = match scope.optional("name", &file.name) {
        Some(entry) => match entry.text()? {
            name if !is_plain_name(name) => {
                return Err(entry.refuse("must be 1 to 100 letters (a to z), digits, - and _"));
            }
            name if stage.rig.flats.iter().any(|flat| flat.name == name) || known.iter().any(|i| i.name == name) => {
                return Err(entry.fail("is the name of another intruder, flat or wall", "Choose another name."));
            }
            name => name.to_owned(),
        },
        None => format!("intruder-{}", known.len() + 1),
    };
    let shape = scope.required("shape", &file.shape)?;
    let kinds = [("ball", Shape::Ball), ("ellipse", Shape::Ellipse), ("ogive", Shape::Ogive)];
    let outline = match shape.choice("shape of an intruder", &kinds)? {
        Shape::Ball => {
            let foreign = [
                ("half_width", &file.half_width),
                ("half_height", &file.half_height),
                ("shell", &file.shell),
                ("body", &file.body),
            ];
            scope.forbid(&foreign, "this shape", CHANGE)?;
            Solid::Ball(0.5 * scope.required("diameter", &file.diameter)?.positive(Dimension::Length)?)
        }
        kind => {
            scope.forbid(&[("diameter", &file.diameter)], "this shape", CHANGE)?;
            if D != 2 {
                return Err(
                    shape.fail("is an outline in a sheet", "In a chain or in space strike with a ball or a flat.")
                );
            }
            if !stage.rig.mirrors.is_empty() {
                let help = "Give the whole crystal in place of its half, or strike it with a ball on the axis.";
                return Err(shape.fail("does not go with mirrors", help));
            }
            Solid::shell(scope, file, kind, stage.crystal.diameter())?
        }
    };
    let turns = match scope.optional("turns", &file.turns) {
        Some(entry) => entry.yes()?,
        // Kondic et al. 2012 keep ogives from turning, so that they do not fall sideways.
        None => matches!(outline, Solid::Ball(_)),
    };
    let density = &stage.rig.sample.materials[material];
    let mass = match (scope.optional("mass", &file.mass), &outline) {
        (Some(entry), _) => entry.positive(Dimension::Mass)?,
        (None, Solid::Ball(radius)) => density.sphere_mass(2.0 * radius),
        // An outline has no thickness from which a mass would follow.
        (None, Solid::Shell { .. }) => scope.required("mass", &file.mass)?.positive(Dimension::Mass)?,
    };
    let velocity: [f64; D] = along_wave(&scope.required("velocity", &file.velocity)?, Dimension::Speed)?;
    let spin = match scope.optional("spin", &file.spin) {
        Some(entry) if !turns => {
            return Err(entry.fail("is given to a body that does not turn", "Write turns = true, or leave it out."));
        }
        Some(entry) if !stage.rig.has_friction() => {
            return Err(entry.fail("would do nothing without friction", "Add the section [friction], or leave it out."));
        }
        Some(entry) => spin::<D>(&entry)?,
        None => [0.0; 3],
    };
    let centre = before(stage, scope, file, outline.half_height())?;
    Ok(outline.put(stage, Placing { name, centre, velocity, spin, mass, material, turns }))
}

/// Where the centre stands: over the middle of the crystal unless said otherwise, its foremost point `gap` before the plane that
/// touches the first spheres.
fn before<const D: usize>(
    stage: &Stage<D>,
    scope: &Scope,
    file: &IntruderFile,
    half_height: f64,
) -> Result<[f64; D], DocumentError> {
    let diameter = stage.crystal.diameter();
    let gap = match scope.optional("gap", &file.gap) {
        Some(entry) => match entry.length(diameter)? {
            gap if gap < 0.0 => return Err(entry.refuse("must not be negative")),
            gap => gap,
        },
        None => 0.0,
    };
    let mut centre = [0.0; D];
    for (axis, (name, written)) in [("x", &file.x), ("y", &file.y)].into_iter().enumerate() {
        let entry = scope.optional(name, written);
        if axis >= D - 1 {
            if let Some(entry) = entry {
                return Err(no_axis::<D>(&entry));
            }
            continue;
        }
        let [first, last, ..] = stage.extent(axis);
        centre[axis] = entry.map_or(Ok(0.5 * (first + last)), |entry| entry.length(diameter))?;
    }
    let [.., lowest, _] = stage.extent(D - 1);
    centre[D - 1] = lowest - gap - half_height;
    Ok(centre)
}

/// An intruder's body; lengths in metres.
enum Solid {
    /// A ball of this radius.
    Ball(f64),
    /// A rigid shell of spheres along an outline.
    Shell {
        /// Places of its spheres from its centre.
        points: Vec<[f64; 2]>,
        /// Their radius.
        radius: f64,
        half_height: f64,
        /// Square of the radius of gyration.
        gyration: f64,
    },
}

/// What is known of an intruder besides its shape.
struct Placing<const D: usize> {
    name: String,
    centre: [f64; D],
    velocity: [f64; D],
    /// As that of a sphere, see [`Rig`](crate::dem::rig::Rig).
    spin: [f64; 3],
    mass: f64,
    material: usize,
    turns: bool,
}

impl Solid {
    fn shell(scope: &Scope, file: &IntruderFile, kind: Shape, diameter: f64) -> Result<Self, DocumentError> {
        let size = |entry: &Entry| match entry.length(diameter)? {
            size if size > 0.0 => Ok(size),
            _ => Err(entry.refuse("must be more than zero")),
        };
        let shell = match scope.optional("shell", &file.shell) {
            Some(entry) => size(&entry)?,
            None => diameter,
        };
        let half_width = scope.required("half_width", &file.half_width)?;
        let half_height = scope.required("half_height", &file.half_height)?;
        // In diameters of the shell's spheres, as beds count them.
        let [a, b] = [size(&half_width)? / shell, size(&half_height)? / shell];
        for (entry, value) in [(&half_width, a), (&half_height, b)] {
            if value <= 1.0 {
                let help = "Make the outline larger, or intruder.shell smaller.";
                return Err(entry.fail("is not more than the diameter of the shell's spheres", help));
            }
            if value > 1e4 {
                return Err(entry.fail("would take a shell of more than 40000 spheres", "Check its unit."));
            }
        }
        let outline = match kind {
            Shape::Ogive if b < a => {
                let help = "An ogive is at least as high as wide; take an ellipse.";
                return Err(half_height.fail("is less than half_width", help));
            }
            Shape::Ogive => Outline::Ogive { half_width: a, half_height: b },
            _ => Outline::Ellipse { half_width: a, half_height: b },
        };
        let filling = match scope.optional("body", &file.body) {
            Some(entry) => entry.choice("body", &[("solid", Filling::Solid), ("hollow", Filling::Hollow)])?,
            None => Filling::Solid,
        };
        let points = outline.shell().into_iter().map(|point| point.map(|x| x * shell)).collect();
        let gyration = outline.gyration(filling) * shell * shell;
        Ok(Self::Shell { points, radius: 0.5 * shell, half_height: b * shell, gyration })
    }

    fn half_height(&self) -> f64 {
        match self {
            Self::Ball(radius) => *radius,
            Self::Shell { half_height, .. } => *half_height,
        }
    }

    fn put<const D: usize>(self, stage: &mut Stage<D>, placing: Placing<D>) -> Intruder {
        let Placing { name, centre, velocity, spin, mass, material, turns } = placing;
        let rig = &mut stage.rig;
        let first = rig.sample.spheres.len();
        let mut add = |centre: [f64; D], radius: f64, inertia: f64| {
            rig.sample.spheres.push(Sphere { centre, radius, material });
            rig.mass.push(mass);
            rig.inertia.push(inertia);
            rig.velocity.push(velocity);
            rig.spin.push(spin);
            rig.held.push([false; D]);
        };
        let cluster = match self {
            Self::Ball(radius) => {
                // With an inertia beyond all others nothing turns it.
                let inertia = 0.4 * mass * radius * radius;
                add(centre, radius, if turns { inertia } else { 1e12 * inertia });
                None
            }
            Self::Shell { points, radius, gyration, .. } => {
                for [x, z] in points {
                    let mut at = centre;
                    at[0] += x;
                    at[D - 1] += z;
                    add(at, radius, mass * gyration);
                }
                let members = (first..rig.sample.spheres.len()).collect();
                let inertia = mass * gyration;
                rig.clusters.push(Cluster { members, centre, mass, inertia, turns, velocity, spin: spin[2] });
                Some(rig.clusters.len() - 1)
            }
        };
        Intruder { name, members: first..stage.rig.sample.spheres.len(), cluster, mass }
    }
}

/// Its material, as a place in the palette; asked for before the laws, which may name it.
pub(super) fn material(
    scope: &Scope,
    file: &IntruderFile,
    palette: &mut Vec<Material>,
    own: &[Material],
) -> Result<usize, DocumentError> {
    super::crystal::place_in(palette, &scope.required("material", &file.material)?, own)
}
