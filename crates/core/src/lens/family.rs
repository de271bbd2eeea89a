//! The families of lenses, and the form that each takes between two rows.

use crate::ray::Vector2;

use super::equal_time::EqualTime;
use super::form::{Element, Face, Form};
use super::graded::Profile;
use super::plano_convex::least_radius;
use crate::ray::Conic;

/// A family of lenses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Family {
    /// Circular front, convex towards the impact; flat back. Gathers.
    #[default]
    PlanoConvex,
    /// Circular front, hollow towards the impact; flat back. Spreads.
    PlanoConcave,
    /// Two circular faces of one radius, both convex. Gathers, each face turning rays half as much.
    Biconvex,
    /// Curved front of equal travel time, flat back: all rays come to one point.
    AsphericFront,
    /// Flat front, hyperbolic back: all rays come to one point.
    AsphericBack,
    /// A plano-convex front folded into zones, so that a thin layer turns rays as a thick lens does.
    Fresnel,
    /// Several plano-convex lenses one behind the other, each of which turns rays little.
    Stages,
    /// A flat slab mixed of host and lens material, slowest on its axis. Gathers.
    Graded,
    /// A wedge that turns all rays one way.
    Prism,
    /// A plano-concave lens about the protected region, which turns rays away from it.
    Shield,
}

impl Family {
    /// All of them.
    pub const ALL: [Self; 10] = [
        Self::PlanoConvex,
        Self::PlanoConcave,
        Self::Biconvex,
        Self::AsphericFront,
        Self::AsphericBack,
        Self::Fresnel,
        Self::Stages,
        Self::Graded,
        Self::Prism,
        Self::Shield,
    ];

    /// As design files write it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::PlanoConvex => "plano-convex",
            Self::PlanoConcave => "plano-concave",
            Self::Biconvex => "biconvex",
            Self::AsphericFront => "aspheric-front",
            Self::AsphericBack => "aspheric-back",
            Self::Fresnel => "fresnel",
            Self::Stages => "stages",
            Self::Graded => "graded",
            Self::Prism => "prism",
            Self::Shield => "shield",
        }
    }

    /// What its radius is called: that of a circular face, the distance at which an aspheric lens gathers, or the focal length
    /// of a graded slab; none if it has none.
    pub const fn radius(self) -> Option<&'static str> {
        match self {
            Self::Prism => None,
            Self::AsphericFront | Self::AsphericBack => Some("focal distance"),
            Self::Graded => Some("focal length"),
            _ => Some("radius"),
        }
    }

    /// Whether there is a curvature to choose: an aspheric lens is made for the middle of its region.
    pub(super) const fn is_curved(self) -> bool {
        !matches!(self, Self::AsphericFront | Self::AsphericBack | Self::Prism)
    }

    /// Whether it can be split among several foci: a graded slab is one, a plano-concave lens gathers nowhere, and a shield is
    /// about the protected region, which is one.
    pub const fn is_split(self) -> bool {
        !matches!(self, Self::PlanoConcave | Self::Graded | Self::Shield)
    }

    /// Whether it makes sense to give it an axis of its own: a prism has none.
    pub const fn has_axis(self) -> bool {
        !matches!(self, Self::Prism)
    }

    /// Whether it takes further materials.
    pub const fn takes_others(self) -> bool {
        matches!(self, Self::Stages | Self::Graded)
    }

    /// Least number of rows that it takes with so many stages, less one.
    pub const fn least_span(self, stages: u32) -> u32 {
        match self {
            // Each stage two rows, one of host between two.
            Self::Stages => 3 * stages - 2,
            _ => 1,
        }
    }
}

/// Where a form is to be made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Place {
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
    /// Number of stages.
    pub stages: u32,
    /// Number of further materials.
    pub others: u32,
}

impl Place {
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

    /// Depths of first and last row of a stage; whole rows, one of host between two stages.
    fn stage(&self, k: u32) -> [f64; 2] {
        let rows = (self.thickness() / self.spacing).round() + 1.0;
        let each = ((rows - f64::from(self.stages - 1)) / f64::from(self.stages)).floor();
        let first = f64::from(k) * (each + 1.0);
        // The last takes what is left over.
        let last = if k + 1 == self.stages { rows - 1.0 } else { first + each - 1.0 };
        [first, last].map(|row| self.depth[0] + row * self.spacing)
    }
}

/// Greatest curvature 1/R (1/m) of a face that has a sag of `thickness` at the distance `widest` or meets the other before,
/// and is nowhere steeper than `max_angle`.
fn greatest(thickness: f64, widest: f64, max_angle: f64) -> f64 {
    1.0 / least_radius(thickness, widest, max_angle)
}

impl Family {
    /// Greatest curvature (1/m) that the limits allow; 1 where there is nothing to choose.
    pub(super) fn greatest_curvature(self, place: &Place) -> f64 {
        let (thickness, widest) = (place.thickness(), place.widest());
        match self {
            Self::PlanoConvex => greatest(thickness, widest, place.max_angle),
            Self::Biconvex => greatest(0.5 * thickness, widest, place.max_angle),
            Self::Stages => {
                let [first, last] = place.stage(0);
                greatest(last - first, widest, place.max_angle)
            }
            Self::Fresnel => place.max_angle.sin() / widest,
            Self::PlanoConcave | Self::Shield => {
                // The face has to have risen by no more than the rows allow at the farther mirror line.
                let sag = thickness - HOLLOW * place.spacing;
                let by_rows = if sag > 0.0 { 2.0 * sag / (sag * sag + widest * widest) } else { 0.0 };
                let quarter = 1.0 / widest;
                by_rows.min(place.max_angle.sin() / widest).min(quarter)
            }
            // Half the depth to the focus is the shortest that a thick slab is given.
            Self::Graded => 2.0 / (place.focus - place.depth[1]),
            // Rays may be made to meet anywhere behind the lens.
            Self::AsphericFront | Self::AsphericBack => f64::INFINITY,
            Self::Prism => 1.0,
        }
    }

    /// The curvatures to try: `count` from flat to the greatest; a prism's sign is the side of its edge.
    pub(super) fn curvatures(self, place: &Place, count: u32) -> Vec<f64> {
        match self {
            Self::AsphericFront | Self::AsphericBack => vec![1.0 / (place.focus - place.depth[1])],
            Self::Prism => vec![1.0, -1.0],
            _ => {
                let greatest = self.greatest_curvature(place);
                (1..=count).map(|k| greatest * f64::from(k) / f64::from(count)).collect()
            }
        }
    }

    /// The form between two rows; none if there is none within the limits.
    pub(super) fn form(self, place: &Place, curvature: f64) -> Option<Form> {
        let Place { depth: [first, last], window, axis, speeds: [host, lens], .. } = *place;
        let conic = |z: f64, curvature: f64, constant: f64, x: [f64; 2]| Conic {
            vertex: Vector2::new(axis, z),
            curvature,
            constant,
            x,
        };
        let one =
            |front: Face, back: Face, x: [f64; 2]| Some(Form::Elements(vec![Element { front, back, x, material: 1 }]));
        match self {
            Self::PlanoConvex => Some(Form::Elements(vec![plano_convex(place, [first, last], curvature, 1)])),
            Self::Stages => Some(Form::Elements(
                (0..place.stages)
                    .map(|k| {
                        let material = 1 + u8::try_from(k % (place.others + 1)).unwrap_or(0);
                        plano_convex(place, place.stage(k), curvature, material)
                    })
                    .collect(),
            )),
            Self::Biconvex => {
                let x = place.within(reach(0.5 * (last - first), curvature, place.widest()));
                let [front, back] = [conic(first, curvature, 0.0, x), conic(last, -curvature, 0.0, x)];
                one(Face::Conic(front), Face::Conic(back), x)
            }
            Self::PlanoConcave | Self::Shield => {
                let vertex = last - HOLLOW * place.spacing;
                let front = conic(vertex, -curvature, 0.0, window);
                (curvature > 0.0).then(|| one(Face::Conic(front), Face::flat(last, window), window))?
            }
            Self::AsphericFront => {
                let front = EqualTime::new(first, last, last + 1.0 / curvature, axis, place.widest(), [host, lens])?;
                let x = place.within(front.aperture());
                one(Face::EqualTime(front), Face::flat(last, x), x)
            }
            Self::AsphericBack => {
                let n = host / lens;
                let focal = 1.0 / curvature;
                if n <= 1.0 || focal <= 0.0 {
                    return None;
                }
                // x² = (n² − 1) s² + 2 (n − 1) f s, with s how much thinner the lens is.
                let (thick, widest) = (last - first, place.widest());
                let rim = ((n * n - 1.0) * thick * thick + 2.0 * (n - 1.0) * focal * thick).sqrt();
                let x = place.within(rim.min(widest));
                one(Face::flat(first, x), Face::Conic(conic(last, -1.0 / ((n - 1.0) * focal), -n * n, x)), x)
            }
            Self::Fresnel => {
                let step = last - first;
                let base = conic(first, curvature, 0.0, window);
                let zones = (base.sag(place.widest()) / step).ceil();
                // One zone is a plano-convex lens.
                if !(2.0..=MOST_ZONES).contains(&zones) {
                    return None;
                }
                // Ring k lies where the sag of the unfolded face is from k to k + 1 steps.
                let radius = |k: f64| (k * step * (2.0 / curvature - k * step)).max(0.0).sqrt().min(place.widest());
                let mut pieces: Vec<Conic> = Vec::new();
                for k in (0..zones as u32).map(f64::from) {
                    let (inner, outer) = (radius(k), if k + 1.0 == zones { place.widest() } else { radius(k + 1.0) });
                    for [a, b] in [[axis - outer, axis - inner], [axis + inner, axis + outer]] {
                        let x = [a.max(window[0]), b.min(window[1])];
                        if x[1] > x[0] {
                            pieces.push(conic(first - k * step, curvature, 0.0, x));
                        }
                    }
                }
                pieces.sort_by(|a, b| a.x[0].total_cmp(&b.x[0]));
                one(Face::Zoned(pieces), Face::flat(last, window), window)
            }
            Self::Graded => (last < place.focus).then(|| {
                Form::Graded(Profile {
                    depth: [first, last],
                    axis,
                    focal_length: 1.0 / curvature,
                    slowness: [1.0 / host, 1.0 / lens],
                })
            }),
            Self::Prism => {
                // The edge lies at the far mirror line or, if negative, on the axis; thickest at the other. Of a part likewise.
                let slope = (last - first) / (window[1] - window[0]);
                let ends = if curvature > 0.0 { [first, last] } else { [last, first] };
                let front = Face::Ramp { from: [window[0], ends[0]], to: [window[1], ends[1]] };
                (slope.atan() <= place.max_angle + 1e-9).then(|| one(front, Face::flat(last, window), window))?
            }
        }
        .filter(|form| form.is_there() && form.steepest() <= place.max_angle + 1e-9)
    }
}

/// Thickness on the axis of a lens that is hollow there, in rows: with it the row at the back is all of the lens.
const HOLLOW: f64 = 0.5;

/// A ring of fewer sites than one has no meaning.
const MOST_ZONES: f64 = 20.0;

/// How far a circular face of a `curvature` reaches until it has sagged by `thickness`.
fn reach(thickness: f64, curvature: f64, widest: f64) -> f64 {
    let sag = thickness.min(1.0 / curvature);
    (sag * (2.0 / curvature - sag)).sqrt().min(widest)
}

fn plano_convex(place: &Place, [first, last]: [f64; 2], curvature: f64, material: u8) -> Element {
    let x = place.within(reach(last - first, curvature, place.widest()));
    let front = Conic { vertex: Vector2::new(place.axis, first), curvature, constant: 0.0, x };
    Element { front: Face::Conic(front), back: Face::flat(last, x), x, material }
}
