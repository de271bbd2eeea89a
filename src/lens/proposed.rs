//! The lens that was found: its data of first order, its sites, its rays.

use std::collections::BTreeMap;

use super::form::{Form, Surrounds};
use super::fraction::{passing, without};
use super::graded::fractions;
use super::plano_convex::Shape;
use super::raster::{Raster, raster};
use super::solve::{Grid, Problem};
use super::{Family, LensRequest};
use crate::contact::Constants;
use crate::lattice::{HexagonalSheet, Site};
use crate::layout::Layout;
use crate::material::Material;
use crate::ray::{Event, Fate, Optics, Trace, fan};
use crate::target::{Region, Target};
use crate::units::Dimension::Length;
use crate::wave::{Dimension, mixture_speed};

/// Rays behind the numbers of a proposal.
const RAYS: usize = 513;

/// A lens and what rays make of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Lens {
    /// The crystal that it lies in.
    pub lattice: HexagonalSheet,
    /// Its family.
    pub family: Family,
    /// Its shape.
    pub form: Form,
    /// First row.
    pub apex_row: u32,
    /// Last row.
    pub back_row: u32,
    /// Radius of the curved face (m); of aspheric lenses the distance at which they gather, of graded slabs the focal length
    /// aimed at; none of prisms.
    pub radius: Option<f64>,
    /// Distance of its own axis from that of the crystal (m).
    pub axis: f64,
    /// Greatest angle of a curved face against the rows (rad).
    pub rim_angle: f64,
    /// Half aperture (m): how far it reaches from its axis.
    pub aperture: f64,
    /// Wave-speed bound of the host (m/s).
    pub host_speed: f64,
    /// Wave-speed bound of the lens material (m/s).
    pub lens_speed: f64,
    /// The materials: host, lens material, further ones.
    pub palette: Vec<Material>,
    /// For each site, in the lattice's order, an index into the palette.
    pub materials: Vec<u8>,
    /// Number of spheres in the half crystal that are not of the host.
    pub spheres: usize,
    /// Fraction of the struck width that rays send through the focal region at its mid depth.
    pub fraction: f64,
    /// The same fraction without a lens.
    pub fraction_without: f64,
    /// The same fraction of the protected region, with the lens and without.
    pub protected: [f64; 2],
    /// Depths (m) at which the innermost and the outermost ray of a lens on the axis come to the axis, where they do within
    /// the crystal.
    pub crossing: [Option<f64>; 2],
    /// Its data of first order.
    pub first_order: FirstOrder,
    /// What a reader should know before trusting the rays.
    pub warnings: Vec<String>,
    speeds: Vec<f64>,
}

/// What is known of a lens from its shape and its rays.
#[derive(Clone, Debug, PartialEq)]
pub struct FirstOrder {
    /// Focal length (m) of rays close to its own axis: their distance from it over their slope behind the lens; negative if they
    /// spread. None if they stay parallel.
    pub focal_length: Option<f64>,
    /// Greatest extent along the wave (m).
    pub thickness: f64,
    /// Number of spheres of each material of the palette in the whole piece, both halves.
    pub counts: Vec<usize>,
    /// Mass of everything but the host in the whole piece (kg).
    pub mass: f64,
    /// Earliest and latest time (s) at which rays come to the middle row of the focal region within it.
    pub arrival: Option<[f64; 2]>,
    /// How many times more rays pass the focal region than without a lens, less what faces reflect: the fraction's gain times
    /// 4 Z Z′/(Z + Z′)² for each of two faces, Z = ρ V. It knows nothing of decay, which in metals outweighs it.
    pub gain: Option<f64>,
}

impl FirstOrder {
    /// What the spheres of the whole piece cost, host included, at `prices` of one sphere by the name of its material; none where the
    /// price of a material that occurs is missing.
    pub fn cost(&self, palette: &[Material], prices: &BTreeMap<String, f64>) -> Option<f64> {
        let used = palette.iter().zip(&self.counts).filter(|(_, count)| **count > 0);
        used.map(|(material, &count)| Some(count as f64 * prices.get(&material.name)?)).sum()
    }
}

impl Lens {
    /// None if the family has no form there.
    pub(super) fn evaluate(
        problem: &Problem,
        shape: Shape,
        host: &Material,
        request: &LensRequest,
        target: &Target,
        constants: Constants,
    ) -> Option<Self> {
        let (lattice, family) = (problem.lattice, problem.family);
        let form = problem.form([shape.apex_row, shape.back_row], 1.0 / shape.radius)?;
        let speeds = problem.palette_speeds();
        let half_width = lattice.half_width();
        let optics = form.optics(problem.surrounds(&speeds));
        let by_fan = problem.is_fast();
        let fraction = if by_fan {
            problem.fan(Grid::fine(family), shape.rim_angle(lattice)).fraction(
                &shape.bench(lattice, problem.speeds),
                lattice.depth(target.focus.mid_row()),
                target.focus.x,
            )
        } else {
            share(&*optics, &target.focus, lattice)
        };
        let fraction_without = without(target.focus.x, half_width);
        let protected = [share(&*optics, &target.protect, lattice), without(target.protect.x, half_width)];
        let palette: Vec<Material> = [host, &request.material].into_iter().chain(&request.others).cloned().collect();
        let rule = request.raster.unwrap_or(if family == Family::Graded { Raster::Diffused } else { Raster::Nearest });
        let materials = sites(problem, &form, &palette, rule, request.seed, constants);
        let [aperture, thickness] = form.extent(problem.axis, half_width);
        let traces = fan(&*optics, RAYS);
        let first_order = FirstOrder {
            focal_length: if family == Family::Prism { None } else { focal_length(&*optics, problem.axis) },
            thickness,
            counts: counts(lattice, &palette, &materials),
            mass: 0.0,
            arrival: arrival(&traces, &target.focus, lattice),
            gain: gain(&palette, &speeds, fraction, fraction_without),
        };
        let mass =
            (1..palette.len()).map(|k| first_order.counts[k] as f64 * palette[k].sphere_mass(lattice.diameter())).sum();
        let crossing = if by_fan {
            let bench = shape.bench(lattice, problem.speeds);
            let paraxial = shape.paraxial_crossing(lattice, problem.speeds).filter(|&depth| depth <= bench.end);
            [paraxial, bench.trace(bench.aperture()).ok().and_then(|path| path.axis_crossing())]
        } else if problem.axis > 0.0 || family == Family::Prism {
            // Off the axis, or all one way: no ray is the innermost.
            [None, None]
        } else {
            let inner = 1e-4 * half_width;
            let outer = ((problem.axis + aperture).min(half_width)) * (1.0 - 1e-7);
            [inner, outer].map(|x| optics.trace(x)).map(|trace| trace.path.axis_crossing())
        };
        Some(Self {
            lattice: *lattice,
            family,
            apex_row: shape.apex_row,
            back_row: shape.back_row,
            radius: family.radius().map(|_| shape.radius),
            axis: problem.axis,
            rim_angle: if by_fan { shape.rim_angle(lattice) } else { form.steepest() },
            aperture,
            host_speed: problem.speeds[0],
            lens_speed: problem.speeds[1],
            spheres: materials.iter().filter(|&&m| m != 0).count(),
            fraction,
            fraction_without,
            protected,
            crossing,
            first_order: FirstOrder { mass, ..first_order },
            warnings: warnings(&*optics, &traces, problem.axis, aperture, half_width),
            palette,
            materials,
            form,
            speeds,
        })
    }

    /// First row, last row and radius (of families without one, 1 m).
    pub fn shape(&self) -> Shape {
        Shape { apex_row: self.apex_row, back_row: self.back_row, radius: self.radius.unwrap_or(1.0) }
    }

    /// The lens laid on the lattice: index 0 of the palette is the host, 1 the lens material.
    pub fn layout(&self) -> Layout {
        Layout { lattice: self.lattice, palette: self.palette.clone(), materials: self.materials.clone() }
    }

    /// First and last row that hold anything but the host. The first is behind the apex row if that has no sphere on the
    /// axis.
    pub fn rows(&self) -> [u32; 2] {
        let held: Vec<u32> =
            self.lattice.sites().iter().zip(&self.materials).filter(|(_, m)| **m != 0).map(|(s, _)| s.row).collect();
        [held.first().copied().unwrap_or(self.apex_row), held.last().copied().unwrap_or(self.back_row)]
    }

    /// What rays run through.
    pub fn optics(&self) -> Box<dyn Optics> {
        let end = self.lattice.depth(f64::from(self.lattice.rows()));
        self.form.optics(Surrounds { speeds: &self.speeds, half_width: self.lattice.half_width(), end })
    }

    /// The faces as lines of points (x, z) (m), x ≥ 0.
    pub fn faces(&self) -> Vec<Vec<[f64; 2]>> {
        self.form.faces(self.lattice.half_width())
    }

    /// `count` rays, evenly from the axis to the mirror line, as polylines (x, z) (m). They run to the last row, except
    /// those that a face reflects totally, which end there.
    pub fn sample_rays(&self, count: usize) -> Vec<Vec<[f64; 2]>> {
        fan(&*self.optics(), count).into_iter().map(|trace| trace.path.points).collect()
    }
}

fn share(optics: &dyn Optics, region: &Region, lattice: &HexagonalSheet) -> f64 {
    passing(optics, lattice.depth(region.mid_row()), region.x, RAYS)
}

/// Materials of all sites.
fn sites(
    problem: &Problem,
    form: &Form,
    palette: &[Material],
    rule: Raster,
    seed: u64,
    constants: Constants,
) -> Vec<u8> {
    let lattice = problem.lattice;
    let diameter = lattice.diameter();
    let slack = 1e-9 * diameter;
    let pure = problem.palette_speeds();
    let mixed = |pair: [usize; 2], part: f64| {
        let parts = [(&palette[pair[0]], 1.0 - part), (&palette[pair[1]], part)];
        mixture_speed(Dimension::Two, &parts, diameter, constants)
    };
    let all = lattice.sites();
    if let (Form::Elements(_), Raster::Nearest) = (form, rule) {
        return all.iter().map(|site| form.at([site.x, site.z], slack)).collect();
    }
    let parts = |site: &Site| match form {
        Form::Graded(profile) if form.at([site.x, site.z], slack) != 0 => {
            fractions(profile.slowness(site.x), &pure, mixed)
        }
        Form::Graded(_) => (0..palette.len()).map(|k| if k == 0 { 1.0 } else { 0.0 }).collect(),
        Form::Elements(_) => cell(form, palette.len(), [site.x, site.z], diameter, lattice.half_width()),
    };
    raster(lattice, rule, seed, &all.iter().map(parts).collect::<Vec<_>>())
}

/// Fractions of the palette in a site's cell, the regular hexagon that is nearer to it than to any other; of a site on a
/// mirror line, in the half that lies in the crystal.
fn cell(form: &Form, palette: usize, [x, z]: [f64; 2], diameter: f64, half_width: f64) -> Vec<f64> {
    const STRIPS: u32 = 16;
    let mut parts = vec![0.0; palette];
    let mut whole = 0.0;
    for k in 0..STRIPS {
        let across = (f64::from(k) + 0.5) / f64::from(STRIPS) - 0.5;
        let at = x + across * diameter;
        if !(0.0..=half_width).contains(&at) {
            continue;
        }
        // The hexagon stands on a corner: 2/√3 high in its middle, half of that at its sides.
        let half_height = (2.0 - 2.0 * across.abs()) / 12.0_f64.sqrt() * diameter;
        whole += half_height;
        for (material, part) in form.between(at, [z - half_height, z + half_height]) {
            parts[usize::from(material)] += part * half_height;
        }
    }
    let lens: f64 = parts.iter().sum();
    parts[0] = whole - lens;
    parts.iter().map(|part| part / whole).collect()
}

/// Spheres of each material in both halves: those on a mirror line once.
fn counts(lattice: &HexagonalSheet, palette: &[Material], materials: &[u8]) -> Vec<usize> {
    let mut counts = vec![0; palette.len()];
    let slack = 1e-9 * lattice.diameter();
    for (site, &material) in lattice.sites().iter().zip(materials) {
        let on_mirror = site.x < slack || site.x > lattice.half_width() - slack;
        counts[usize::from(material)] += if on_mirror { 1 } else { 2 };
    }
    counts
}

/// Slope of a ray beside the lens's axis where it has left the lens.
fn focal_length(optics: &dyn Optics, axis: f64) -> Option<f64> {
    let beside = 1e-4 * optics.half_width();
    let (start, outwards) =
        if axis + beside < optics.half_width() { (axis + beside, 1.0) } else { (axis - beside, -1.0) };
    let trace = optics.trace(start);
    let last = trace.events.iter().rposition(|event| matches!(event, Event::Passed(_)))? + 1;
    let [[x0, z0], [x1, z1]] = [*trace.path.points.get(last)?, *trace.path.points.get(last + 1)?];
    let slope = (x1 - x0) / (z1 - z0) * outwards;
    (slope.abs() > 1e-9).then(|| -beside / slope)
}

fn arrival(traces: &[Trace], focus: &Region, lattice: &HexagonalSheet) -> Option<[f64; 2]> {
    let depth = lattice.depth(focus.mid_row());
    let inside = traces
        .iter()
        .filter_map(|trace| trace.path.at_depth(depth))
        .filter(|(x, _)| (focus.x[0]..=focus.x[1]).contains(x))
        .map(|(_, time)| time);
    inside.fold(None, |range, time| match range {
        None => Some([time, time]),
        Some([low, high]) => Some([time.min(low), time.max(high)]),
    })
}

fn gain(palette: &[Material], speeds: &[f64], fraction: f64, without: f64) -> Option<f64> {
    let [host, lens] = [0, 1].map(|k| palette[k].density * speeds[k]);
    let face = 4.0 * host * lens / (host + lens).powi(2);
    (without > 0.0).then(|| fraction / without * face * face)
}

fn warnings(optics: &dyn Optics, traces: &[Trace], axis: f64, aperture: f64, half_width: f64) -> Vec<String> {
    let mut warnings = Vec::new();
    let mut reasons: Vec<(String, usize)> = Vec::new();
    for trace in traces {
        // Angles differ from ray to ray: the place is enough.
        let Some(words) = optics.failure(&trace.fate) else { continue };
        let words = match trace.fate {
            Fate::Reflected(..) => words.split(':').next().unwrap_or(&words).to_owned() + " by total reflection",
            _ => words,
        };
        match reasons.iter_mut().find(|(known, _)| *known == words) {
            Some((_, count)) => *count += 1,
            None => reasons.push((words, 1)),
        }
    }
    for (words, count) in reasons {
        warnings.push(format!("{:.0} % of the rays: each {words}", 100.0 * count as f64 / traces.len() as f64));
    }
    let reach = axis.max(half_width - axis);
    if aperture < 0.999 * reach {
        let beside = (reach - aperture) / half_width;
        warnings.push(format!(
            "the lens reaches {} from its axis; {:.0} % of the struck width passes beside it",
            Length.show(aperture),
            100.0 * beside
        ));
    }
    warnings
}
