//! Lens families, solved from a target, laid on the lattice.
//!
//! In: a lattice, the host, a [`LensRequest`] and a target. Out: a [`Lens`], or why there is none that serves the target.
//! Rays only, at the wave-speed bounds of the two materials; nothing is simulated.
//!
//! - `plano_convex`: the shape of the one family there is, and which sites it covers
//! - `fraction`: how much of the struck width rays send through the focal region
//! - `solve`: the search for the shape that sends most
//! - `unreachable`: why no lens serves a target, and which target near it could be served
//! - `check`: whether a request makes sense

mod check;
mod fraction;
mod plano_convex;
mod solve;
mod unreachable;

pub use check::LensError;
pub use plano_convex::Shape;
pub use unreachable::{Limit, Nearest, Unreachable};

use crate::contact::Constants;
use crate::lattice::HexagonalSheet;
use crate::layout::Layout;
use crate::material::Material;
use crate::ray::Bench;
use crate::target::Target;
use crate::wave::{Bound, Dimension, bound};
use fraction::Fan;
use solve::{Grid, Problem};

/// What kind of lens is asked for, and what is already decided about it.
#[derive(Clone, Debug, PartialEq)]
pub struct LensRequest {
    /// Material of the lens; the crystal's host surrounds it.
    pub material: Material,
    /// First and last row that may hold lens material.
    pub rows: [u32; 2],
    /// Greatest angle of the curved face against the rows (rad); at most 60 degrees unless asked for.
    pub max_interface_angle: f64,
    /// The row of the apex on the axis, where given.
    pub apex_row: Option<u32>,
    /// The last row of the lens (its flat face), where given.
    pub back_row: Option<u32>,
    /// Radius of the curved face (m), where given.
    pub radius: Option<f64>,
}

/// A plano-convex lens and what rays make of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Lens {
    /// The crystal that it lies in.
    pub lattice: HexagonalSheet,
    /// Row of the apex on the axis.
    pub apex_row: u32,
    /// Last row, that of the flat face.
    pub back_row: u32,
    /// Radius of the curved face (m).
    pub radius: f64,
    /// Greatest angle of the curved face against the rows (rad).
    pub rim_angle: f64,
    /// Half aperture (m).
    pub aperture: f64,
    /// Wave-speed bound of the host (m/s).
    pub host_speed: f64,
    /// Wave-speed bound of the lens material (m/s).
    pub lens_speed: f64,
    /// Number of spheres of lens material in the half crystal.
    pub spheres: usize,
    /// Fraction of the struck width that rays send through the focal region at its mid depth.
    pub fraction: f64,
    /// The same fraction without a lens.
    pub fraction_without: f64,
    /// Depths (m) at which the innermost and the outermost ray come to the axis, where they do within the crystal.
    pub crossing: [Option<f64>; 2],
}

/// Finds the lens that sends the largest fraction of the struck width through the focal region at its mid depth.
///
/// All apex rows, back rows and radii are tried that the request's limits allow and that leave the lens in front of the
/// focal region; what the request fixes stays fixed. Of lenses whose fractions differ by less than
/// 10⁻⁶ the one of fewest spheres is taken. If apex, back and radius are all given, nothing is sought and a small fraction is no error.
///
/// # Errors
/// [`LensError::Unreachable`] if no such lens sends more than straight rays do; the others if the request contradicts
/// itself or the crystal.
pub fn propose(
    lattice: &HexagonalSheet,
    host: &Material,
    request: &LensRequest,
    target: &Target,
    constants: Constants,
) -> Result<Lens, LensError> {
    check::check(lattice, request, target)?;
    let speed = |material| -> Bound { bound(Dimension::Two, [material; 2], lattice.diameter(), constants) };
    let problem = Problem::new(lattice, [speed(host).speed, speed(&request.material).speed], request, target);
    if let (Some(apex_row), Some(back_row), Some(radius)) = (request.apex_row, request.back_row, request.radius) {
        return Ok(Lens::evaluate(&problem, Shape { apex_row, back_row, radius }));
    }
    match problem.best(Grid::FINE) {
        Some(best) if problem.gains(&best) && problem.converges() => Ok(Lens::evaluate(&problem, best.shape)),
        _ => Err(LensError::Unreachable(Box::new(Unreachable::explain(&problem, &request.material.name)))),
    }
}

impl Lens {
    fn evaluate(problem: &Problem, shape: Shape) -> Self {
        let lattice = problem.lattice;
        let bench = shape.bench(lattice, problem.speeds);
        let fan = Fan::new(Grid::FINE.rays, shape.rim_angle(lattice), problem.speeds);
        let paraxial = shape.paraxial_crossing(lattice, problem.speeds).filter(|&depth| depth <= bench.end);
        let rim = bench.trace(bench.aperture()).ok().and_then(|path| path.axis_crossing());
        Self {
            lattice: *lattice,
            apex_row: shape.apex_row,
            back_row: shape.back_row,
            radius: shape.radius,
            rim_angle: shape.rim_angle(lattice),
            aperture: bench.aperture(),
            host_speed: problem.speeds[0],
            lens_speed: problem.speeds[1],
            spheres: shape.count(lattice),
            fraction: fan.fraction(&bench, problem.depth, problem.region),
            fraction_without: problem.without(),
            crossing: [paraxial, rim],
        }
    }

    /// Apex, back and radius.
    pub fn shape(&self) -> Shape {
        Shape { apex_row: self.apex_row, back_row: self.back_row, radius: self.radius }
    }

    /// The lens as rays see it.
    pub fn bench(&self) -> Bench {
        self.shape().bench(&self.lattice, [self.host_speed, self.lens_speed])
    }

    /// The lens laid on the lattice: index 0 of the palette is the host, 1 the lens material.
    pub fn layout(&self, host: &Material, material: &Material) -> Layout {
        let shape = self.shape();
        let palette = vec![host.clone(), material.clone()];
        Layout::new(self.lattice, palette, |site| u8::from(shape.contains(&self.lattice, site)))
    }

    /// First and last row that hold lens material. The first is behind the apex row if that has no sphere on the axis.
    pub fn rows(&self) -> [u32; 2] {
        self.shape().rows(&self.lattice)
    }

    /// Depth of the flat face (m).
    pub fn back_depth(&self) -> f64 {
        self.bench().back
    }

    /// The curved face as a polyline (x, z) (m), from the axis to the rim.
    pub fn front_polyline(&self) -> Vec<[f64; 2]> {
        const STEPS: u32 = 48;
        let bench = self.bench();
        let rim = (self.aperture / self.radius).min(1.0).asin();
        (0..=STEPS)
            .map(|step| self.radius * (rim * f64::from(step) / f64::from(STEPS)).sin())
            .map(|x| [x, bench.apex + bench.sag(x)])
            .collect()
    }

    /// `count` rays, evenly from the axis to the mirror line, as polylines (x, z) (m). They run to the last row, except
    /// those that a face reflects totally, which end there.
    pub fn sample_rays(&self, count: usize) -> Vec<Vec<[f64; 2]>> {
        let bench = self.bench();
        let spacing = bench.half_width / (count.max(2) - 1) as f64;
        (0..count)
            .map(|k| (k as f64 * spacing).min(bench.half_width))
            .map(|x| bench.trace(x).unwrap_or_else(|stray| stray.path).points)
            .collect()
    }
}

#[cfg(test)]
mod tests;
