//! The lens that was found: its data of first order, its sites, its rays.

use std::collections::{BTreeMap, HashMap};

use super::first_order::{FirstOrder, Prescription};
use super::form::{Form, Surrounds};
use super::fraction::{Fan, passing, passing_of, without};
use super::graded::fractions;
use super::parts::{FocusRays, Part};
use super::plano_convex::Shape;
use super::problem::{LEAST_GAIN, Problem};
use super::raster::{Raster, raster};
use super::solve::FAN;
use super::{Family, LensRequest};
use crate::contact::Constants;
use crate::lattice::{HexagonalSheet, Site};
use crate::layout::Layout;
use crate::material::Material;
use crate::ray::{Event, Fate, Optics, Trace, fan, fan_between};
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
    /// Where it lies and how it is shaped.
    pub prescription: Prescription,
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
    /// Its parts, in order across the crystal: one unless there are several foci.
    pub parts: Vec<Part>,
    /// What rays bring to each focus, in the order of the target.
    pub foci: Vec<FocusRays>,
    /// Fraction of the struck width that rays send through the focal region at its mid depth; of several, through any.
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

/// A part that was found: where it was sought, and what it is.
pub(super) struct Found<'a> {
    pub problem: Problem<'a>,
    pub shape: Shape,
    pub form: Form,
    /// Indices of the foci that it is for.
    pub foci: Vec<usize>,
}

impl Found<'_> {
    /// What fraction of its strip's rays it would send to its focus if no other part were there.
    fn alone(&self) -> f64 {
        let speeds = self.problem.palette_speeds();
        let optics = self.form.optics(self.problem.surrounds(&speeds));
        passing(&*optics, self.problem.window, (self.problem.depth, self.problem.region), RAYS, self.problem.symmetry)
    }

    /// The part in the lens that rays run through, followed by those of its strip, `own`.
    fn part(&self, optics: &dyn Optics, own: &[Trace]) -> Part {
        let Self { problem, shape, form, foci } = self;
        let [low, high] = problem.window;
        let [_, thickness] = form.extent(problem.axis, problem.stack.half_width);
        let aimed = problem.family.has_axis() && (low..=high).contains(&problem.axis);
        Part {
            foci: foci.clone(),
            window: problem.window,
            prescription: Prescription {
                apex_row: shape.apex_row,
                back_row: shape.back_row,
                radius: problem.family.radius().map(|_| shape.radius),
                parameters: problem.parameters(),
                axis: problem.axis,
                rim_angle: form.steepest(),
                aperture: form.covered(problem.window),
                thickness,
                focal_length: if aimed { focal_length(optics, problem.axis) } else { None },
            },
            fraction: passing_of(own, &[(problem.depth, problem.region)], problem.stack.half_width, problem.symmetry),
            fraction_without: without(&[problem.region], problem.window, problem.symmetry),
        }
    }
}

impl Lens {
    /// Of parts beside each other, or one, which are known to have a form.
    pub(super) fn evaluate(
        lattice: &HexagonalSheet,
        found: &[Found],
        host: &Material,
        request: &LensRequest,
        target: &Target,
        constants: Constants,
    ) -> Self {
        let Found { problem, shape, .. } = &found[0];
        let one = found.len() == 1;
        let family = problem.family;
        let form = if one { found[0].form.clone() } else { Form::beside(found.iter().map(|part| part.form.clone())) };
        let speeds = problem.palette_speeds();
        let half_width = lattice.half_width();
        let optics = form.optics(problem.surrounds(&speeds));
        let by_fan = problem.is_fast();
        let traces = fan(&*optics, RAYS);
        let goal = |region: &Region| (lattice.depth(region.mid_row()), region.x);
        let share = |goals: &[(f64, [f64; 2])]| passing_of(&traces, goals, half_width, problem.symmetry);
        let goals: Vec<(f64, [f64; 2])> = target.foci.iter().map(|focus| goal(&focus.region)).collect();
        let whole = [0.0, half_width];
        // Where one lens of all the width serves several foci, they are the same region.
        let same = goals.iter().all(|goal| *goal == goals[0]);
        let fraction = match goals[0] {
            (depth, x) if by_fan => Fan::new(FAN, shape.rim_angle(lattice), problem.speeds).fraction(
                &shape.bench(lattice, problem.speeds),
                depth,
                x,
            ),
            _ => share(&goals),
        };
        let fraction_without = without(&goals.iter().map(|goal| goal.1).collect::<Vec<_>>(), whole, problem.symmetry);
        let protected = [share(&[goal(&target.protect)]), without(&[target.protect.x], whole, problem.symmetry)];
        let palette: Vec<Material> = [host, &request.material].into_iter().chain(&request.others).cloned().collect();
        let rule = request.raster.unwrap_or(family.row().raster);
        let materials = sites(lattice, problem, &form, &palette, rule, request.seed, constants);
        let [_, thickness] = form.extent(problem.axis, half_width);
        let aperture = found.iter().map(|part| part.form.extent(part.problem.axis, half_width)[0]).fold(0.0, f64::max);
        let foci: Vec<FocusRays> = target
            .foci
            .iter()
            .map(|focus| {
                let of = if same { fraction } else { share(&[goal(&focus.region)]) };
                let straight = without(&[focus.region.x], whole, problem.symmetry);
                FocusRays {
                    fraction: of,
                    fraction_without: straight,
                    arrival: arrival(&traces, &focus.region, lattice),
                    gain: gain(&palette, &speeds, of, straight),
                }
            })
            .collect();
        let arrivals = foci.iter().filter_map(|focus| focus.arrival);
        let first_order = FirstOrder {
            arrival: arrivals.reduce(|[a, b], [c, d]| [a.min(c), b.max(d)]),
            gain: gain(&palette, &speeds, fraction, fraction_without),
        };
        let crossing = if by_fan {
            let bench = shape.bench(lattice, problem.speeds);
            let paraxial = shape.paraxial_crossing(lattice, problem.speeds).filter(|&depth| depth <= bench.end);
            [paraxial, bench.trace(bench.aperture()).ok().and_then(|path| path.axis_crossing())]
        } else if problem.axis > 0.0 || !family.has_axis() || !one {
            // Off the axis, or all one way: no ray is the innermost.
            [None, None]
        } else {
            let inner = 1e-4 * half_width;
            let outer = ((problem.axis + aperture).min(half_width)) * (1.0 - 1e-7);
            [inner, outer].map(|x| optics.trace(x)).map(|trace| trace.path.axis_crossing())
        };
        let mut warnings = failures(&*optics, &traces);
        let mut parts = Vec::new();
        for part in found {
            // A single part has all rays.
            let own = if one { None } else { Some(fan_between(&*optics, part.problem.window, RAYS)) };
            parts.push(part.part(&*optics, own.as_ref().unwrap_or(&traces)));
        }
        match one {
            true => warnings.extend(beside(problem.axis, aperture, half_width)),
            false => warnings.extend(doubts(found, &parts, half_width)),
        }
        let rows = parts.iter().map(|part: &Part| &part.prescription);
        Self {
            lattice: lattice.clone(),
            family,
            prescription: Prescription {
                apex_row: rows.clone().map(|of| of.apex_row).min().unwrap_or(shape.apex_row),
                back_row: rows.map(|of| of.back_row).max().unwrap_or(shape.back_row),
                radius: family.radius().filter(|_| one).map(|_| shape.radius),
                parameters: if one { problem.parameters() } else { BTreeMap::new() },
                axis: problem.axis,
                rim_angle: if by_fan { shape.rim_angle(lattice) } else { form.steepest() },
                aperture,
                thickness,
                focal_length: if !family.has_axis() || !one { None } else { focal_length(&*optics, problem.axis) },
            },
            host_speed: problem.speeds[0],
            lens_speed: problem.speeds[1],
            spheres: materials.iter().filter(|&&m| m != 0).count(),
            parts,
            foci,
            fraction,
            fraction_without,
            protected,
            crossing,
            first_order,
            warnings,
            palette,
            materials,
            form,
            speeds,
        }
    }

    /// First row, last row and radius (of families without one, 1 m).
    pub fn shape(&self) -> Shape {
        let Prescription { apex_row, back_row, radius, .. } = self.prescription;
        Shape { apex_row, back_row, radius: radius.unwrap_or(1.0) }
    }

    /// The lens laid on the lattice: index 0 of the palette is the host, 1 the lens material.
    pub fn layout(&self) -> Layout {
        Layout { lattice: self.lattice.clone(), palette: self.palette.clone(), materials: self.materials.clone() }
    }

    /// First and last row that hold anything but the host. The first is behind the apex row if that has no sphere on the
    /// axis.
    pub fn rows(&self) -> [u32; 2] {
        let held: Vec<u32> =
            self.lattice.sites().iter().zip(&self.materials).filter(|(_, m)| **m != 0).map(|(s, _)| s.row).collect();
        let Prescription { apex_row, back_row, .. } = self.prescription;
        [held.first().copied().unwrap_or(apex_row), held.last().copied().unwrap_or(back_row)]
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

/// Materials of all sites.
fn sites(
    lattice: &HexagonalSheet,
    problem: &Problem,
    form: &Form,
    palette: &[Material],
    rule: Raster,
    seed: u64,
    constants: Constants,
) -> Vec<u8> {
    let diameter = lattice.diameter();
    let slack = 1e-9 * diameter;
    let pure = problem.palette_speeds();
    let mixed = |pair: [usize; 2], part: f64| {
        let parts = [(&palette[pair[0]], 1.0 - part), (&palette[pair[1]], part)];
        mixture_speed(Dimension::Two, &parts, diameter, constants)
    };
    let all = lattice.sites();
    // Sites below each other have the same mixture.
    let mut mixtures: HashMap<u64, Vec<f64>> = HashMap::new();
    if let (Form::Elements(_), Raster::Nearest) = (form, rule) {
        return all.iter().map(|site| form.at([site.x, site.z], slack)).collect();
    }
    let mut parts = |site: &Site| match form {
        Form::Graded(profile) if form.at([site.x, site.z], slack) != 0 => {
            let mix = || fractions(profile.slowness(site.x), &pure, mixed);
            mixtures.entry(site.x.to_bits()).or_insert_with(mix).clone()
        }
        Form::Graded(_) => (0..palette.len()).map(|k| if k == 0 { 1.0 } else { 0.0 }).collect(),
        Form::Elements(_) => cell(form, palette.len(), [site.x, site.z], diameter, lattice.half_width()),
    };
    raster(lattice, rule, seed, &all.iter().map(&mut parts).collect::<Vec<_>>())
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

/// Which rays do not come through, by reason.
fn failures(optics: &dyn Optics, traces: &[Trace]) -> Vec<String> {
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
    let part = |count: usize| 100.0 * count as f64 / traces.len() as f64;
    reasons.into_iter().map(|(words, count)| format!("{:.0} % of the rays: each {words}", part(count))).collect()
}

/// What passes beside a lens.
fn beside(axis: f64, aperture: f64, half_width: f64) -> Option<String> {
    let reach = axis.max(half_width - axis);
    (aperture < 0.999 * reach).then(|| {
        format!(
            "the lens reaches {} from its axis; {:.0} % of the struck width passes beside it",
            Length.show(aperture),
            100.0 * (reach - aperture) / half_width
        )
    })
}

/// What a part leaves beside it, and what its neighbours take from its rays.
fn doubts(found: &[Found], parts: &[Part], half_width: f64) -> Vec<String> {
    let of = |(found, part): (&Found, &Part)| -> Vec<String> {
        let name = format!("the part for focus {}", found.foci[0] + 1);
        let width = part.window[1] - part.window[0];
        let beside = (part.prescription.aperture < 0.999 * width).then(|| {
            let percent = 100.0 * (width - part.prescription.aperture) / half_width;
            format!(
                "{name} covers {} of its strip of {}; {percent:.0} % of the struck width passes beside it",
                Length.show(part.prescription.aperture),
                Length.show(width)
            )
        });
        let alone = found.alone();
        let lost = (part.fraction < alone - LEAST_GAIN).then(|| {
            format!("{name}: {:.0} % of its strip's rays come to the focus, {:.0} % if the other parts were not in their way",
                100.0 * part.fraction, 100.0 * alone)
        });
        beside.into_iter().chain(lost).collect()
    };
    found.iter().zip(parts).flat_map(of).collect()
}
