//! Lens families, solved from a target, laid on the lattice.
//!
//! In: a lattice, the host, a [`LensRequest`] and a target. Out: a [`Lens`], or why there is none that serves the target.
//! Rays only, at the wave-speed bounds of the materials; nothing is simulated.
//!
//! - `family`: the table of families, a file for each, and the form that each takes between two rows; `equal_time`, `graded`, `plano_convex` for theirs
//! - `form`: a lens as a shape: faces, what rays and sites see of it
//! - `raster`: from the smooth shape to sites
//! - `parts`: one lens for several foci, cut into strips
//! - `fraction`: how much of the struck width rays send through a region
//! - `problem`: what is sought, within which limits; `solve`: the search for the form that sends most; `seek`: over the
//!   parameters that a family has beside rows and radius
//! - `proposed`: the lens that was found; `first_order`: what to know of it before anything is simulated
//! - `symmetry`: a sheet's lens or a body of revolution: what is struck, areas and volumes; `stack`: the layers that it lies in
//! - `body`: lenses in space, revolved or extruded, and what they lay on sites
//! - `unreachable`: why no lens serves a target, and which target near it could be served
//! - `check`: whether a request makes sense

mod body;
mod check;
mod equal_time;
mod family;
mod first_order;
mod form;
mod fraction;
mod graded;
mod parts;
mod plano_convex;
mod problem;
mod proposed;
mod raster;
mod seek;
mod solve;
mod stack;
mod symmetry;
mod unreachable;

pub use body::{Body, Continued, propose_body};
pub use check::LensError;
pub use equal_time::EqualTime;
pub use family::{EvenAsphere, Family, Parameter, Quantity};
pub use first_order::{FirstOrder, Prescription};
pub use form::{Element, Face, Form};
pub use graded::Profile;
pub use parts::{FocusRays, Part};
pub use plano_convex::Shape;
pub use proposed::Lens;
pub use raster::Raster;
pub use stack::Stack;
pub use symmetry::Symmetry;
pub use unreachable::{Limit, Nearest, Unreachable};

use std::collections::BTreeMap;

use crate::contact::Constants;
use crate::lattice::HexagonalSheet;
use crate::material::Material;
use crate::target::Target;
use crate::wave::{Dimension, bound};
use parts::Strip;
use problem::{Candidate, Problem};
use proposed::Found;
use solve::Grid;

/// What kind of lens is asked for, and what is already decided about it.
#[derive(Clone, Debug, PartialEq)]
pub struct LensRequest {
    /// The family.
    pub family: Family,
    /// Material of the lens; the crystal's host surrounds it.
    pub material: Material,
    /// Further materials, for families that take them: stages use them in turn, graded lenses mix neighbours in speed.
    pub others: Vec<Material>,
    /// First and last row that may hold lens material.
    pub rows: [u32; 2],
    /// Greatest angle of a curved face against the rows (rad); at most 60 degrees unless asked for.
    pub max_interface_angle: f64,
    /// The first row of the lens, where given: of a plano-convex one that of the apex on the axis.
    pub apex_row: Option<u32>,
    /// The last row of the lens, where given: of a plano-convex one that of its flat face.
    pub back_row: Option<u32>,
    /// Radius of the curved face (m), where given; of an aspheric lens the distance from its back, on its axis, to the point
    /// where rays meet, of a graded slab the focal length aimed at.
    pub radius: Option<f64>,
    /// Distance of the lens's own axis from that of the crystal (m), where given. A lens off the axis has its mirror image on
    /// the other side. Left out, it is 0 for plano-convex lenses; others stand before their region: on the axis or the far
    /// mirror line if it touches one of them, otherwise before its middle.
    pub axis: Option<f64>,
    /// What is given of the family's own parameters ([`Family::parameters`]), by name and in SI. What is left out is sought, or as it usually is.
    pub parameters: BTreeMap<String, f64>,
    /// How sites take their material; left out, diffused for graded lenses, nearest for all others.
    pub raster: Option<Raster>,
    /// Seed for the random raster.
    pub seed: u64,
    /// In space, whether it is the same all along y or revolved about the axis; without meaning in a sheet.
    pub symmetry: Symmetry,
}

impl LensRequest {
    /// A request in which nothing but family, material and rows is decided.
    pub fn new(family: Family, material: Material, rows: [u32; 2]) -> Self {
        Self {
            family,
            material,
            others: Vec::new(),
            rows,
            max_interface_angle: 60.0_f64.to_radians(),
            apex_row: None,
            back_row: None,
            radius: None,
            axis: None,
            parameters: BTreeMap::new(),
            raster: None,
            seed: 1,
            symmetry: Symmetry::default(),
        }
    }

    /// The values (SI) of the family's parameters with which a search begins: as given, or as they usually are.
    fn values(&self, diameter: f64) -> Result<Vec<f64>, LensError> {
        self.family.values(&self.parameters, diameter)
    }

    /// The places of the parameters that are sought.
    fn open(&self) -> Vec<usize> {
        let all = self.family.parameters().iter().enumerate();
        all.filter(|(_, of)| of.is_sought && !self.parameters.contains_key(of.name)).map(|(k, _)| k).collect()
    }
}

/// Finds the lens of the family that sends the largest fraction of the struck width through the focal region at its mid
/// depth; of a shield, the one that sends the smallest through the protected region.
///
/// All first rows, last rows and radii are tried that the request's limits allow and that leave the lens in front of the
/// region; what the request fixes stays fixed. Parameters of the family's own that the request leaves open are sought from what they usually are, together
/// with the radius; what is found there is a good one, and not the best for certain. Of lenses whose fractions differ by less than
/// 10⁻⁶ the one of fewest spheres is taken. If first row, last row and radius (of families that have one) are all given,
/// nothing is sought and a small fraction is no error.
///
/// For several focal regions the struck width is cut into strips in proportion to their shares, and each strip takes a part
/// that is sought in the same way for its own region, from the rays of its own strip; all in front of the first of the regions.
/// What rays make of the lens as a whole is traced through all parts.
///
/// # Errors
/// [`LensError::Unreachable`] if no such lens, or no such part for one of the regions, does better than straight rays do; the
/// others if the request contradicts itself or the crystal.
pub fn propose(
    lattice: &HexagonalSheet,
    host: &Material,
    request: &LensRequest,
    target: &Target,
    constants: Constants,
) -> Result<Lens, LensError> {
    check::check(&lattice.into(), request, target)?;
    let speed = |material| bound(Dimension::Two, [material; 2], lattice.diameter(), constants).speed;
    let speeds = [speed(host), speed(&request.material)];
    let strips = if target.foci.len() > 1 && request.family.is_split() {
        parts::split(&target.foci, lattice)
    } else {
        vec![Strip { foci: (0..target.foci.len()).collect(), window: [0.0, lattice.half_width()] }]
    };
    let mut parts = Vec::new();
    for strip in &strips {
        let mut problem = match &strips[..] {
            [_] => Problem::new(lattice.into(), Some(lattice), speeds, request, target),
            _ => Problem::part(lattice, speeds, request, target, strip),
        };
        problem.others = request.others.iter().map(speed).collect();
        let focus = (strips.len() > 1).then(|| strip.foci[0]);
        let shape = shape(&mut problem, request, focus)?;
        let Some(form) = problem.form([shape.apex_row, shape.back_row], 1.0 / shape.radius) else {
            return Err(unreachable(&problem, request, focus, None));
        };
        parts.push(Found { problem, shape, form, foci: strip.foci.clone() });
    }
    Ok(Lens::evaluate(lattice, &parts, host, request, target, constants))
}

/// The best shape that solves a problem, for the focus with this index where there are several.
fn shape(problem: &mut Problem, request: &LensRequest, focus: Option<usize>) -> Result<Shape, LensError> {
    let needs_radius = request.family.radius().is_some();
    let given = match (request.apex_row, request.back_row, request.radius) {
        (Some(apex_row), Some(back_row), Some(radius)) if needs_radius => Some(Shape { apex_row, back_row, radius }),
        _ => None,
    };
    // What cannot gather needs no fine search to say so.
    let fine = given.is_none() && (problem.may_gain() || !needs_radius);
    let mut best = fine.then(|| problem.best(Grid::fine(problem))).flatten();
    if !problem.open.is_empty() && problem.may_gain() {
        best = problem.seek(best.or_else(|| given.map(|shape| problem.judged(shape))));
    }
    let shape = match (request.apex_row, request.back_row) {
        // With its rows given, only the side of a prism's edge is open.
        (Some(_), Some(_)) if !needs_radius => best.map(|best| best.shape),
        _ => given.or(best.filter(|best| problem.gains(best) && problem.may_gain()).map(|best| best.shape)),
    };
    shape.ok_or_else(|| unreachable(problem, request, focus, best))
}

fn unreachable(problem: &Problem, request: &LensRequest, focus: Option<usize>, best: Option<Candidate>) -> LensError {
    let why = Unreachable::explain(problem, &request.material.name, best);
    LensError::Unreachable(Box::new(Unreachable { focus, ..why }))
}

#[cfg(test)]
mod tests;
