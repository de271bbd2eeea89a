//! The table of families: what each is called, which numbers it has, and the form that it takes between two rows.
//!
//! A family is a [`Row`] in its own file and a line in the table. All that differs from family to family stands in its row: nobody asks
//! elsewhere which one it is.

mod aspheric;
mod biconvex;
mod even_asphere;
mod fresnel;
mod graded;
mod hollow;
mod parameter;
mod plano_convex;
mod prism;
mod stages;

pub use even_asphere::EvenAsphere;
pub use parameter::{Parameter, Quantity};

use crate::ray::{Conic, Vector2};

use super::form::{Element, Face, Form};
use super::plano_convex::least_radius;
use super::raster::Raster;

/// Makes the type of the lines: a doc comment, the name in code, the row.
macro_rules! families {
    ($($(#[$doc:meta])* $family:ident: $row:path,)*) => {
        /// A family of lenses.
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
        pub enum Family {
            $($(#[$doc])* $family),*
        }

        impl Family {
            /// All of them.
            pub const ALL: [Self; [$(stringify!($family)),*].len()] = [$(Self::$family),*];

            pub(super) const fn row(self) -> &'static Row {
                match self { $(Self::$family => &$row),* }
            }
        }
    };
}

families! {
    /// Circular front, convex towards the impact; flat back. Gathers.
    #[default]
    PlanoConvex: plano_convex::FAMILY,
    /// Circular front, hollow towards the impact; flat back. Spreads.
    PlanoConcave: hollow::PLANO_CONCAVE,
    /// Two circular faces of one radius, both convex. Gathers, each face turning rays half as much.
    Biconvex: biconvex::FAMILY,
    /// Curved front of equal travel time, flat back: all rays come to one point.
    AsphericFront: aspheric::FRONT,
    /// Flat front, hyperbolic back: all rays come to one point.
    AsphericBack: aspheric::BACK,
    /// Conic front with terms of fourth and sixth order, flat back. Gathers.
    EvenAsphere: even_asphere::FAMILY,
    /// A plano-convex front folded into zones, so that a thin layer turns rays as a thick lens does.
    Fresnel: fresnel::FAMILY,
    /// Several plano-convex lenses one behind the other, each of which turns rays little.
    Stages: stages::FAMILY,
    /// A flat slab mixed of host and lens material, slowest on its axis. Gathers.
    Graded: graded::FAMILY,
    /// A wedge that turns all rays one way.
    Prism: prism::FAMILY,
    /// A plano-concave lens about the protected region, which turns rays away from it.
    Shield: hollow::SHIELD,
}

/// What bends rays, as far as it can be chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Bend {
    /// A curvature that is sought, from flat to the greatest that the limits allow; what 1 over it is called.
    Sought(&'static str),
    /// A distance: left out, it is that to the middle of the region.
    Aimed(&'static str),
    /// Nothing, but on which side the edge lies.
    Side,
}

/// What a family is.
pub(super) struct Row {
    /// As design files write it.
    pub name: &'static str,
    /// What it is called where several names are read.
    pub aliases: &'static [&'static str],
    pub bend: Bend,
    /// What its bend is called at the head of a line.
    pub heading: &'static str,
    /// Its numbers beside two rows and the bend.
    pub parameters: &'static [Parameter],
    /// Whether it spares the protected region, rather than serving the focal one.
    pub spares: bool,
    /// Whether it gathers, which only what is slower than its host does.
    pub gathers: bool,
    /// Whether it can be split among several foci.
    pub is_split: bool,
    /// Whether it makes sense to give it an axis of its own.
    pub has_axis: bool,
    /// Whether it stands on the crystal's axis unless another is asked for; the others stand before their region.
    pub is_central: bool,
    /// Whether it takes further materials.
    pub takes_others: bool,
    /// Whether its material is a mixture, down to the slowest of all.
    pub is_mixed: bool,
    /// Whether a single one on the axis of a sheet is what the fan traces (`ray::PlanoConvex`), a hundred times as fast.
    pub has_fan: bool,
    /// Whether its number of spheres grows or falls with the curvature alone.
    pub is_monotonic: bool,
    /// How sites take their material where nobody says.
    pub raster: Raster,
    /// Least number of rows that it takes, less one.
    pub least_span: fn(&[f64]) -> u32,
    /// Greatest curvature (1/m) that the limits allow.
    pub greatest: fn(&Place) -> f64,
    /// The form between two rows; none if there is none.
    pub form: fn(&Place, f64) -> Option<Form>,
}

/// A lens with a curved face, as most are.
const PLAIN: Row = Row {
    name: "",
    aliases: &[],
    bend: Bend::Sought("radius"),
    heading: "Radius of the curved face",
    parameters: &[],
    spares: false,
    gathers: true,
    is_split: true,
    has_axis: true,
    is_central: false,
    takes_others: false,
    is_mixed: false,
    has_fan: false,
    is_monotonic: true,
    raster: Raster::Nearest,
    least_span: |_| 1,
    greatest: |place| greatest(place.thickness(), place.widest(), place.max_angle),
    form: |_, _| None,
};

impl Family {
    /// As design files write it.
    pub const fn name(self) -> &'static str {
        self.row().name
    }

    /// All names by which files may call families, the usual ones first.
    pub fn names() -> Vec<(&'static str, Self)> {
        let usual = Self::ALL.into_iter().map(|family| (family.name(), family));
        let aliases = Self::ALL.into_iter().flat_map(|of| of.row().aliases.iter().map(move |&alias| (alias, of)));
        usual.chain(aliases).collect()
    }

    /// The family of a name.
    pub fn find(name: &str) -> Option<Self> {
        Self::names().into_iter().find(|(known, _)| *known == name).map(|(_, family)| family)
    }

    /// What its radius is called: that of a curved face, the distance at which an aspheric lens gathers, or the focal length
    /// of a graded slab; none if it has none.
    pub const fn radius(self) -> Option<&'static str> {
        match self.row().bend {
            Bend::Sought(name) | Bend::Aimed(name) => Some(name),
            Bend::Side => None,
        }
    }

    /// The same at the head of a line.
    pub const fn radius_heading(self) -> &'static str {
        self.row().heading
    }

    /// Its numbers beside first row, last row and radius.
    pub const fn parameters(self) -> &'static [Parameter] {
        self.row().parameters
    }

    /// Whether there is a curvature to choose: an aspheric lens is made for the middle of its region.
    pub(super) const fn is_curved(self) -> bool {
        matches!(self.row().bend, Bend::Sought(_))
    }

    /// Whether it spares the protected region, rather than serving the focal one.
    pub const fn spares(self) -> bool {
        self.row().spares
    }

    /// Whether it can be split among several foci: a graded slab is one, a plano-concave lens gathers nowhere, and a shield is
    /// about the protected region, which is one.
    pub const fn is_split(self) -> bool {
        self.row().is_split
    }

    /// Whether it makes sense to give it an axis of its own: a prism has none.
    pub const fn has_axis(self) -> bool {
        self.row().has_axis
    }

    /// Whether it takes further materials.
    pub const fn takes_others(self) -> bool {
        self.row().takes_others
    }

    /// Least number of rows that it takes with these values of its parameters, less one.
    pub fn least_span(self, values: &[f64]) -> u32 {
        (self.row().least_span)(values)
    }

    /// Greatest curvature (1/m) that the limits allow.
    pub(super) fn greatest_curvature(self, place: &Place) -> f64 {
        (self.row().greatest)(place)
    }

    /// The curvatures to try: `count` from flat to the greatest; the sign of what has none is the side of its edge.
    pub(super) fn curvatures(self, place: &Place, count: u32) -> Vec<f64> {
        match self.row().bend {
            Bend::Aimed(_) => vec![1.0 / (place.focus - place.depth[1])],
            Bend::Side => vec![1.0, -1.0],
            Bend::Sought(_) => {
                let greatest = self.greatest_curvature(place);
                (1..=count).map(|k| greatest * f64::from(k) / f64::from(count)).collect()
            }
        }
    }

    /// The form between two rows; none if there is none within the limits.
    pub(super) fn form(self, place: &Place, curvature: f64) -> Option<Form> {
        (self.row().form)(place, curvature).filter(|form| form.is_there() && form.steepest() <= place.max_angle + 1e-9)
    }
}

/// Where a form is to be made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Place<'a> {
    /// Depths of the first and the last row (m).
    pub depth: [f64; 2],
    /// Distance between rows (m).
    pub spacing: f64,
    /// What it may take of the crystal's width (m): from mirror line to mirror line, or the strip of one of several foci.
    pub window: [f64; 2],
    /// Where the lens's own axis lies (m); that of a part of a lens may lie outside its strip.
    pub axis: f64,
    /// Depth at which rays shall meet (m).
    pub focus: f64,
    /// Wave speeds (m/s) of host and lens material.
    pub speeds: [f64; 2],
    /// Greatest angle of a face (rad).
    pub max_angle: f64,
    /// Values of the family's parameters, in its order (SI).
    pub values: &'a [f64],
    /// Number of further materials.
    pub others: u32,
}

impl Place<'_> {
    /// Distance from the lens's axis to the farther end of the window (m).
    fn widest(&self) -> f64 {
        (self.axis - self.window[0]).max(self.window[1] - self.axis)
    }

    fn thickness(&self) -> f64 {
        self.depth[1] - self.depth[0]
    }

    /// The part of the window within `reach` of the lens's axis.
    fn within(&self, reach: f64) -> [f64; 2] {
        [(self.axis - reach).max(self.window[0]), (self.axis + reach).min(self.window[1])]
    }

    /// A conic face about the lens's axis with its vertex at a depth.
    fn conic(&self, z: f64, curvature: f64, constant: f64, x: [f64; 2]) -> Conic {
        Conic { vertex: Vector2::new(self.axis, z), curvature, constant, x }
    }
}

/// A form of one piece of the lens material.
fn one(front: Face, back: Face, x: [f64; 2]) -> Form {
    Form::Elements(vec![Element { front, back, x, material: 1 }])
}

/// Greatest curvature 1/R (1/m) of a face that has a sag of `thickness` at the distance `widest` or meets the other before,
/// and is nowhere steeper than `max_angle`.
fn greatest(thickness: f64, widest: f64, max_angle: f64) -> f64 {
    1.0 / least_radius(thickness, widest, max_angle)
}

/// How far a circular face of a `curvature` reaches until it has sagged by `thickness`.
fn reach(thickness: f64, curvature: f64, widest: f64) -> f64 {
    let sag = thickness.min(1.0 / curvature);
    (sag * (2.0 / curvature - sag)).sqrt().min(widest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_known_once_each() {
        let names: Vec<&str> = Family::names().into_iter().map(|(name, _)| name).collect();
        assert!(names.iter().enumerate().all(|(k, name)| !names[..k].contains(name)), "{names:?}");
        assert_eq!(Family::find("grin"), Some(Family::Graded));
        assert_eq!(Family::find("GRIN"), None);
        for family in Family::ALL {
            assert_eq!(Family::find(family.name()), Some(family));
            for parameter in family.parameters() {
                let [least, most] = parameter.range;
                assert!((least..=most).contains(&parameter.usual) && !parameter.about.is_empty(), "{parameter:?}");
            }
        }
    }
}
