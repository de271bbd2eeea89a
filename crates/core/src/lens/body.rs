//! A lens as a body of revolution, for close packings: its form and its numbers, without sites to lie on.

use super::form::Form;
use super::fraction::{passing, without};
use super::problem::Problem;
use super::symmetry::Symmetry;
use super::{LensError, LensRequest, check, shape, unreachable};
use crate::contact::Constants;
use crate::lattice::HexagonalSheet;
use crate::material::Material;
use crate::target::Target;
use crate::wave::bound;

/// Rays behind the numbers.
const RAYS: usize = 513;

/// A body of revolution and what rays make of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    /// Its section through the axis: x is the distance from the axis.
    pub form: Form,
    /// First row.
    pub apex_row: u32,
    /// Last row.
    pub back_row: u32,
    /// Radius of the curved face (m), or what the family has in its place; none of prisms.
    pub radius: Option<f64>,
    /// Wave-speed bounds (m/s) of host and lens material in a close packing.
    pub speeds: [f64; 2],
    /// Fraction of the struck disc that rays send through the focal region, a disc or a ring, at its mid depth.
    pub fraction: f64,
    /// The same without a lens.
    pub fraction_without: f64,
    /// Volume of each material of the palette but the host (m³), the host's place being 0.
    pub volumes: Vec<f64>,
    /// Number of spheres that a close packing has in these, on average over where it lies.
    pub counts: Vec<f64>,
    /// Their mass (kg).
    pub mass: f64,
}

/// Finds the body of revolution of the request's family as [`propose`](super::propose) finds a lens in a sheet: with the bounds of
/// close packings, and the struck disc weighed by its area. The lattice gives the radius of the piece (its half width), and rows
/// and their distance along the wave.
///
/// # Errors
/// As [`propose`](super::propose); [`LensError::OffAxis`] of a lens with an axis of its own off that of the crystal, or for
/// several foci, of which no body of revolution could serve any off the axis by its own part.
pub fn propose_body(
    lattice: &HexagonalSheet,
    host: &Material,
    request: &LensRequest,
    target: &Target,
    constants: Constants,
) -> Result<Body, LensError> {
    check::check(lattice, request, target)?;
    let symmetry = Symmetry::Axis;
    let speed = |material| bound(symmetry.dimension(), [material; 2], lattice.diameter(), constants).speed;
    let speeds = [speed(host), speed(&request.material)];
    let mut problem = Problem::new(lattice, speeds, request, target);
    if problem.axis != 0.0 || target.foci.len() > 1 {
        return Err(LensError::OffAxis);
    }
    problem.others = request.others.iter().map(speed).collect();
    problem.symmetry = symmetry;
    let shape = shape(&problem, request, None)?;
    let Some(form) = problem.form([shape.apex_row, shape.back_row], 1.0 / shape.radius) else {
        return Err(unreachable(&problem, request, None, None));
    };
    let palette: Vec<&Material> = [host, &request.material].into_iter().chain(&request.others).collect();
    let palette_speeds = problem.palette_speeds();
    let optics = form.optics(problem.surrounds(&palette_speeds));
    let goal = (problem.depth, problem.region);
    let fraction = passing(&*optics, problem.window, goal, RAYS, symmetry);
    let volumes = form.extents(palette.len(), lattice.half_width(), symmetry);
    let counts: Vec<f64> = volumes.iter().map(|volume| volume * symmetry.sites(lattice.diameter())).collect();
    let mass =
        counts.iter().zip(&palette).map(|(count, material)| count * material.sphere_mass(lattice.diameter())).sum();
    Ok(Body {
        apex_row: shape.apex_row,
        back_row: shape.back_row,
        radius: request.family.radius().map(|_| shape.radius),
        speeds,
        fraction,
        fraction_without: without(&[problem.region], problem.window, symmetry),
        volumes,
        counts,
        mass,
        form,
    })
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::super::Family;
    use super::*;
    use crate::material::find;
    use crate::target::Region;

    const D: f64 = 6.35e-3;

    fn target() -> Target {
        let region = |rows, x: [f64; 2]| Region { rows, x: x.map(|x| x * D) };
        Target::one(region([30, 34], [0.0, 2.5]), region([30, 34], [12.0, 16.5]))
    }

    /// The published lens turned about its axis: a cap of a sphere, with the volume of one; straight rays come from (2.5/16.5)² of
    /// the disc; and rays come from as much of the disc as was counted ring by ring.
    #[test]
    fn a_plano_convex_body_is_a_cap() {
        let lattice = HexagonalSheet::new(D, 50, 16.5).unwrap();
        let (steel, brass) = (find("440c", &[]).unwrap(), find("brass", &[]).unwrap());
        let radius = 16.5 * D / 60.0_f64.to_radians().sin();
        let request = LensRequest {
            apex_row: Some(5),
            back_row: Some(16),
            radius: Some(radius),
            ..LensRequest::new(Family::PlanoConvex, brass.clone(), [5, 29])
        };
        let body = propose_body(&lattice, &steel, &request, &target(), Constants::Code).unwrap();
        // The rows are a hair thicker than the cap is high: 11 √3/2 D against R (1 − cos 60°), both 9.526 D.
        let h = radius * 0.5;
        let cap = PI * h * h * (3.0 * radius - h) / 3.0;
        assert!((body.volumes[1] / cap - 1.0).abs() < 1e-3, "{} {cap}", body.volumes[1]);
        assert!((body.counts[1] - body.volumes[1] * 2.0_f64.sqrt() / D.powi(3)).abs() < 1e-6);
        assert!((body.mass / (body.counts[1] * brass.sphere_mass(D)) - 1.0).abs() < 1e-12);
        assert!((body.fraction_without - (2.5_f64 / 16.5).powi(2)).abs() < 1e-12);
        // Bounds of close packings are (2/√3)/(3/√8) of the sheet's, for both: the same rays, of which those far out count more.
        let optics = body.form.optics(super::super::form::Surrounds {
            speeds: &body.speeds,
            half_width: lattice.half_width(),
            end: lattice.depth(50.0),
        });
        let depth = lattice.depth(32.0);
        let rings = 20_000;
        let inside = |k: &u32| {
            let x = 16.5 * D * (f64::from(*k) + 0.5) / f64::from(rings);
            optics.trace(x).path.at_depth(depth).is_some_and(|(x, _)| x <= 2.5 * D)
        };
        let area: f64 = (0..rings).filter(inside).map(|k| (2.0 * f64::from(k) + 1.0) / f64::from(rings).powi(2)).sum();
        // Four edges of the region, each within one of 512 ways: 4 × 2/512.
        assert!((body.fraction - area).abs() < 1.6e-2, "{} {area}", body.fraction);
    }

    /// An exact front focuses the whole disc, and left free a body is found that gains.
    #[test]
    fn an_aspheric_body_gathers_the_disc() {
        let lattice = HexagonalSheet::new(D, 50, 16.5).unwrap();
        let (steel, brass) = (find("440c", &[]).unwrap(), find("brass", &[]).unwrap());
        let request = LensRequest::new(Family::AsphericFront, brass, [5, 29]);
        let body = propose_body(&lattice, &steel, &request, &target(), Constants::Code).unwrap();
        assert!(body.fraction > 0.9 && body.fraction_without < 0.03, "{body:?}");
        let off = LensRequest { axis: Some(3.0 * D), ..request };
        let error = propose_body(&lattice, &steel, &off, &target(), Constants::Code).unwrap_err();
        assert_eq!(error, LensError::OffAxis);
    }
}
