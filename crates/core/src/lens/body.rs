//! A lens in space, for close packings: a form that is revolved about the axis or extruded along y, its numbers, and what it lays on sites.

use std::collections::{BTreeMap, HashMap};

use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::SeedableRng;

use super::form::Form;
use super::fraction::{passing, without};
use super::graded::fractions;
use super::problem::Problem;
use super::raster::{Raster, drawn, greatest};
use super::symmetry::Symmetry;
use super::{LensError, LensRequest, Stack, check, shape, unreachable};
use crate::contact::Constants;
use crate::material::Material;
use crate::stats::fraction;
use crate::target::Target;
use crate::wave::{Dimension, bound, mixture_speed};

/// Rays behind the numbers.
const RAYS: usize = 513;

/// How a form z(x) goes on out of its plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Continued {
    /// About the axis.
    Revolved,
    /// Along y, over so long a way (m).
    Extruded(f64),
}

impl Continued {
    /// What it is to rays.
    pub fn symmetry(self) -> Symmetry {
        match self {
            Self::Revolved => Symmetry::Axis,
            Self::Extruded(_) => Symmetry::Plane,
        }
    }
}

/// A lens in space and what rays make of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    /// Its section through the axis: x is the distance from the axis or, of an extruded one, from the plane x = 0.
    pub form: Form,
    /// How it goes on out of that section.
    pub continued: Continued,
    /// First layer.
    pub apex_row: u32,
    /// Last layer.
    pub back_row: u32,
    /// Radius of the curved face (m), or what the family has in its place; none of prisms.
    pub radius: Option<f64>,
    /// The family's own parameters by name, lengths in m and with `_m` at the end.
    pub parameters: BTreeMap<String, f64>,
    /// Wave-speed bounds (m/s) of host and lens material in a close packing.
    pub speeds: [f64; 2],
    /// Fraction of what is struck, a disc or a width, that rays send through the focal region at its mid depth.
    pub fraction: f64,
    /// The same without a lens.
    pub fraction_without: f64,
    /// Fraction that passes the protected region at its mid depth, and the same without a lens.
    pub protected: [f64; 2],
    /// Volume of each material of the palette but the host (m³), the host's place being 0.
    pub volumes: Vec<f64>,
    /// Number of spheres that a close packing has in these, on average over where it lies.
    pub counts: Vec<f64>,
    /// Their mass (kg).
    pub mass: f64,
    /// Greatest angle of a face against the layers (rad).
    pub steepest: f64,
    /// Wave-speed bounds (m/s) of host, lens and further materials.
    palette_speeds: Vec<f64>,
}

/// Finds the lens of the request's family in space as [`propose`](super::propose) finds one in a sheet: with the bounds of
/// close packings and, of a body of revolution, the struck disc weighed by its area. The target says at which distances from the axis, or
/// from the plane x = 0, energy is wanted.
///
/// # Errors
/// As [`propose`](super::propose); [`LensError::OffAxis`] of a lens with an axis of its own off that of the crystal, or for
/// several foci, of which no body of revolution could serve any off the axis by its own part.
pub fn propose_body(
    stack: &Stack,
    continued: Continued,
    host: &Material,
    request: &LensRequest,
    target: &Target,
    constants: Constants,
) -> Result<Body, LensError> {
    check::check(stack, request, target)?;
    let symmetry = continued.symmetry();
    let speed = |material| bound(Dimension::Three, [material; 2], stack.diameter, constants).speed;
    let speeds = [speed(host), speed(&request.material)];
    let mut problem = Problem::new(*stack, None, speeds, request, target);
    if problem.axis != 0.0 || target.foci.len() > 1 {
        return Err(LensError::OffAxis);
    }
    problem.others = request.others.iter().map(speed).collect();
    problem.symmetry = symmetry;
    let shape = shape(&mut problem, request, None)?;
    let Some(form) = problem.form([shape.apex_row, shape.back_row], 1.0 / shape.radius) else {
        return Err(unreachable(&problem, request, None, None));
    };
    let palette: Vec<&Material> = [host, &request.material].into_iter().chain(&request.others).collect();
    let palette_speeds = problem.palette_speeds();
    let optics = form.optics(problem.surrounds(&palette_speeds));
    let passes = |goal| passing(&*optics, problem.window, goal, RAYS, symmetry);
    let straight = |x| without(&[x], problem.window, symmetry);
    let fraction = passes((problem.depth, problem.region));
    let protect = &target.protect;
    let protected = [passes((stack.depth(protect.mid_row()), protect.x)), straight(protect.x)];
    let length = match continued {
        Continued::Revolved => 1.0,
        Continued::Extruded(length) => length,
    };
    let extents = form.extents(palette.len(), stack.half_width, symmetry);
    let volumes: Vec<f64> = extents.into_iter().map(|extent| extent * length).collect();
    let per_volume = Symmetry::Axis.sites(stack.diameter);
    let counts: Vec<f64> = volumes.iter().map(|volume| volume * per_volume).collect();
    let mass = counts.iter().zip(&palette).map(|(count, material)| count * material.sphere_mass(stack.diameter)).sum();
    Ok(Body {
        continued,
        apex_row: shape.apex_row,
        back_row: shape.back_row,
        radius: request.family.radius().map(|_| shape.radius),
        parameters: problem.parameters(),
        speeds,
        fraction,
        fraction_without: straight(problem.region),
        protected,
        volumes,
        counts,
        mass,
        steepest: form.steepest(),
        form,
        palette_speeds,
    })
}

impl Body {
    /// For each centre (m) the material of the palette that the lens lays there, 0 the host. Sites take what their centre lies in; those of a
    /// graded lens the greatest part of their mixture or, with a random `raster`, each by chance.
    ///
    /// `palette`: host, lens material, further ones of the request that it was proposed for.
    pub fn materials(
        &self,
        centres: impl Iterator<Item = [f64; 3]>,
        palette: &[Material],
        diameter: f64,
        (raster, seed): (Raster, u64),
        constants: Constants,
    ) -> Vec<u8> {
        let slack = 1e-9 * diameter;
        let mut chance = (raster == Raster::Random).then(|| Xoshiro256PlusPlus::seed_from_u64(seed));
        let mut mixtures: HashMap<u64, Vec<f64>> = HashMap::new();
        let mixed = |pair: [usize; 2], part: f64| {
            let parts = [(&palette[pair[0]], 1.0 - part), (&palette[pair[1]], part)];
            mixture_speed(Dimension::Three, &parts, diameter, constants)
        };
        let mut lay = |[x, y, z]: [f64; 3]| {
            let across = match self.continued {
                Continued::Revolved => x.hypot(y),
                Continued::Extruded(_) => x.abs(),
            };
            let material = self.form.at([across, z], slack);
            let (Form::Graded(profile), true) = (&self.form, material != 0) else { return material };
            let mix = || fractions(profile.slowness(across), &self.palette_speeds, mixed);
            let parts = mixtures.entry(across.to_bits()).or_insert_with(mix);
            match &mut chance {
                Some(chance) => drawn(parts, fraction(chance)),
                None => greatest(parts),
            }
        };
        centres.map(&mut lay).collect()
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::super::Family;
    use super::super::form::Surrounds;
    use super::*;
    use crate::lattice::{Block, BlockSide, Cell, HexagonalSheet};
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
        let body = propose_body(&(&lattice).into(), Continued::Revolved, &steel, &request, &target(), Constants::Code)
            .unwrap();
        // The rows are a hair thicker than the cap is high: 11 √3/2 D against R (1 − cos 60°), both 9.526 D.
        let h = radius * 0.5;
        let cap = PI * h * h * (3.0 * radius - h) / 3.0;
        assert!((body.volumes[1] / cap - 1.0).abs() < 1e-3, "{} {cap}", body.volumes[1]);
        assert!((body.counts[1] - body.volumes[1] * 2.0_f64.sqrt() / D.powi(3)).abs() < 1e-6);
        assert!((body.mass / (body.counts[1] * brass.sphere_mass(D)) - 1.0).abs() < 1e-12);
        assert!((body.fraction_without - (2.5_f64 / 16.5).powi(2)).abs() < 1e-12);
        // Bounds of close packings are (2/√3)/(3/√8) of the sheet's, for both: the same rays, of which those far out count more.
        let optics = body.form.optics(Surrounds {
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
        let body = propose_body(&(&lattice).into(), Continued::Revolved, &steel, &request, &target(), Constants::Code)
            .unwrap();
        assert!(body.fraction > 0.9 && body.fraction_without < 0.03, "{body:?}");
        let off = LensRequest { axis: Some(3.0 * D), ..request };
        let error = propose_body(&(&lattice).into(), Continued::Revolved, &steel, &off, &target(), Constants::Code)
            .unwrap_err();
        assert_eq!(error, LensError::OffAxis);
    }

    /// Revolved, the reference's lens (R = 7.5 D, layers 4 to 10 of HCP about a sphere of layer 4) holds its 732 spheres: 1, 42, 85, 114, 139, 168
    /// and 183 a layer. Extruded along y, whole rows; and the counts are those of the volume.
    #[test]
    fn bodies_are_laid_on_a_block() {
        let sides = [BlockSide::Period; 2];
        let block = Block::new(Cell::<3>::named("hcp").unwrap(), D, 24, [14, 8], 4, sides).unwrap();
        let (steel, brass) = (find("440c", &[]).unwrap(), find("brass", &[]).unwrap());
        let request = LensRequest {
            apex_row: Some(4),
            back_row: Some(10),
            radius: Some(7.5 * D),
            max_interface_angle: 75_f64.to_radians(),
            ..LensRequest::new(Family::PlanoConvex, brass.clone(), [2, 14])
        };
        let region = |x: [f64; 2]| Region { rows: [15, 17], x: x.map(|x| x * D) };
        let target = Target::one(region([0.0, 1.5]), region([5.0, 7.0]));
        let palette = [steel.clone(), brass];
        let lay = |stack: Stack, continued| {
            let body = propose_body(&stack, continued, &steel, &request, &target, Constants::Code).unwrap();
            let centres = block.sites().iter().map(|site| site.centre);
            let laid = body.materials(centres, &palette, D, (Raster::Nearest, 0), Constants::Code);
            (body, laid)
        };
        let (body, laid) = lay(Stack::round(&block), Continued::Revolved);
        let count = |layer: u32| -> usize {
            let sites = block.sites().iter().zip(block.copies()).zip(&laid);
            sites
                .filter(|((site, _), m)| site.layer == layer && **m == 1)
                .map(|((_, copies), _)| usize::from(*copies))
                .sum()
        };
        assert_eq!((4..=10).map(count).collect::<Vec<_>>(), [1, 42, 85, 114, 139, 168, 183]);
        assert!(body.fraction > 2.0 * body.fraction_without, "{} {}", body.fraction, body.fraction_without);
        let (body, laid) = lay(Stack::across(&block), Continued::Extruded(2.0 * block.half_widths()[1]));
        let sites = block.sites().iter().zip(block.copies()).zip(&laid);
        let total: usize = sites.clone().filter(|(_, m)| **m == 1).map(|((_, copies), _)| usize::from(*copies)).sum();
        // The faces round up or down by half a sphere on each of seven layers of 14 D.
        assert!((total as f64 / body.counts[1] - 1.0).abs() < 0.12, "{total} {}", body.counts[1]);
        for ((site, _), m) in sites {
            let alike = |other: &crate::lattice::CrystalSite<3>| {
                other.layer == site.layer && (other.centre[0] - site.centre[0]).abs() < 1e-9
            };
            let other = block.sites().iter().position(alike).unwrap();
            assert_eq!(laid[other], *m);
        }
    }
}
