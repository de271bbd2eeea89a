//! What rays and first arrivals say of a design, without a simulation.

use super::proposal;
use crate::design::Design;
use crate::layout::Layout;
use crate::lens::Lens;
use crate::outcome::{FORMAT, Front, SpotDiagram, Traced, TracedDecay, TracedFocus, TracedRay, TracedSpot};
use crate::ray::{Eikonal, Spot, Trace, caustic, fan, least_spot, spot, wavefront};
use crate::target::{Focus, Region};
use crate::wave::{Decay, Dimension, bound, doubtful_passages, site_speeds};

/// Rays behind spots, caustic and wavefronts.
const FINE: usize = 601;

/// First arrivals are found on a mesh so many times finer than the lattice.
const MESH: u32 = 4;

/// Traces a design's lens with `rays` rays to be drawn; wavefronts every `interval` (s), or at some round time.
///
/// With `decays`, one for each material of the lens's palette, first arrivals are those of a wave that decays; rays always run at
/// the bound.
pub fn trace_lens(
    design: &Design,
    lens: &Lens,
    rays: usize,
    interval: Option<f64>,
    decays: Option<&[Decay]>,
) -> Traced {
    let optics = lens.optics();
    let fine = fan(&*optics, FINE);
    let times = times_of(&fine, interval);
    let ray = |trace: Trace| TracedRay {
        failure: optics.failure(&trace.fate),
        points: trace.path.points,
        times: trace.path.times,
    };
    let end = design.lattice.depth(f64::from(design.lattice.rows()));
    let behind = lens.faces().into_iter().flatten().map(|point| point[1]).fold(0.0, f64::max);
    let layout = lens.layout();
    let mut traced = trace_layout(design, &layout, &eikonal(design, &layout, None), decays, |_| times.clone());
    for (k, focus) in traced.foci.iter_mut().enumerate() {
        focus.rays = spot_diagram(design, lens, &fine, k);
        focus.arrival[0] = lens.foci[k].arrival.map(|range| range[0]);
    }
    // Several foci have each their own.
    let spots = match &traced.foci[..] {
        [focus] => [focus.rays.spot, least_spot(&fine, [behind, end], edge(lens, lens.prescription.axis)).map(told)],
        _ => [None, None],
    };
    Traced {
        proposal: Some(proposal(design, lens)),
        rays: fan(&*optics, rays).into_iter().map(ray).collect(),
        wavefronts: fronts(&fine, &times),
        caustic: caustic(&*optics, FINE),
        spots,
        focal_arrival: [lens.first_order.arrival.map(|range| range[0]), traced.focal_arrival[1]],
        ..traced
    }
}

/// When wavefronts are drawn: every `interval` (s), or at some round time, up to the last ray's end.
fn times_of(rays: &[Trace], interval: Option<f64>) -> Vec<f64> {
    let latest = rays.iter().filter_map(|trace| trace.path.times.last().copied()).fold(0.0, f64::max);
    times(interval.unwrap_or_else(|| round(latest / 20.0)), latest)
}

fn fronts(rays: &[Trace], times: &[f64]) -> Vec<Front> {
    times.iter().map(|&time| Front { time, lines: wavefront(rays, time) }).collect()
}

/// Wavefronts of a lens by `rays` rays, at round times: a millisecond, where [`trace_lens`] also finds first arrivals and the caustic.
pub fn trace_fronts(lens: &Lens, rays: usize) -> Vec<Front> {
    let rays = fan(&*lens.optics(), rays);
    fronts(&rays, &times_of(&rays, None))
}

/// Rays of a spot diagram in a report.
const DRAWN: usize = 121;

/// The spot diagrams of a design's lens, one for each focal region.
pub(super) fn spot_diagrams(design: &Design, lens: &Lens) -> Vec<SpotDiagram> {
    let rays = fan(&*lens.optics(), DRAWN);
    (0..design.target.foci.len()).map(|k| spot_diagram(design, lens, &rays, k)).collect()
}

/// That of the k-th region, by those of the rays over the whole width that start in its strip.
fn spot_diagram(design: &Design, lens: &Lens, rays: &[Trace], k: usize) -> SpotDiagram {
    let (lattice, region) = (&lens.lattice, &design.target.foci[k].region);
    let part = lens.parts.iter().find(|part| part.foci.contains(&k));
    let (strip, axis) = part
        .map_or(([0.0, lattice.half_width()], lens.prescription.axis), |part| (part.window, part.prescription.axis));
    let depth = lattice.depth(region.mid_row());
    // A ray on the line between two strips belongs to neither.
    let slack = 1e-9 * lattice.half_width();
    let own = [if strip[0] > 0.0 { strip[0] + slack } else { 0.0 }, strip[1] - slack];
    let own: Vec<&Trace> = rays.iter().filter(|trace| (own[0]..=own[1]).contains(&trace.path.points[0][0])).collect();
    let passages = own.iter().filter_map(|trace| {
        let (x, time) = trace.path.at_depth(depth)?;
        Some([trace.path.points[0][0], x, time])
    });
    let passages = passages.collect();
    SpotDiagram { depth, x: region.x, strip, passages, spot: spot(own, depth, edge(lens, axis)).map(told) }
}

/// A lens on either mirror line has its image beyond it: its spot lies there, not in the middle of one half.
fn edge(lens: &Lens, axis: f64) -> Option<f64> {
    [0.0, lens.lattice.half_width()].into_iter().find(|edge| *edge == axis)
}

fn told(spot: Spot) -> TracedSpot {
    TracedSpot { depth: spot.depth, centre: spot.centre, radius: spot.radius, rays: spot.rays }
}

/// First arrivals in any layout, and where they are at times (s) chosen for the latest of them. `plain` are those by the bound.
fn trace_layout(
    design: &Design,
    layout: &Layout,
    plain: &Eikonal,
    decays: Option<&[Decay]>,
    times: impl Fn(f64) -> Vec<f64>,
) -> Traced {
    let lattice = &layout.lattice;
    let decaying = decays.map(|decays| eikonal(design, layout, Some(decays)));
    let eikonal = decaying.as_ref().unwrap_or(plain);
    let first_arrival = eikonal.at_sites();
    let times = times(first_arrival.iter().copied().fold(0.0, f64::max));
    let isochrones = times
        .iter()
        .zip(eikonal.isochrones(&times))
        .map(|(&time, pieces)| Front { time, lines: pieces.into_iter().map(|piece| piece.to_vec()).collect() });
    let isochrones = isochrones.collect();
    let sites = lattice.sites();
    let first = |region: &Region, arrivals: &[f64]| {
        let mid = region.mid_row();
        let in_middle = |site: &usize| (f64::from(sites[*site].row) - mid).abs() <= 0.5;
        region.sites(lattice).into_iter().filter(in_middle).map(|site| arrivals[site]).min_by(f64::total_cmp)
    };
    let by_bound = plain.at_sites();
    let foci: Vec<TracedFocus> = design
        .target
        .foci
        .iter()
        .map(|Focus { region, .. }| TracedFocus {
            rays: SpotDiagram {
                depth: lattice.depth(region.mid_row()),
                x: region.x,
                strip: [0.0, lattice.half_width()],
                passages: Vec::new(),
                spot: None,
            },
            arrival: [None, first(region, &by_bound)],
            arrival_decaying: decays.and_then(|_| first(region, &first_arrival)),
        })
        .collect();
    let earliest = |of: fn(&TracedFocus) -> Option<f64>| foci.iter().filter_map(of).min_by(f64::total_cmp);
    let materials: Vec<String> = layout.palette.iter().map(|material| material.name.clone()).collect();
    let warnings = match decays {
        Some(_) => {
            let used = |k: &usize| layout.materials.iter().any(|&material| usize::from(material) == *k);
            let impedance = |k: usize| {
                let material = &layout.palette[k];
                let speed = bound(Dimension::Two, [material; 2], lattice.diameter(), design.constants).speed;
                (material.name.as_str(), material.density * speed)
            };
            doubtful_passages(&(0..layout.palette.len()).filter(used).map(impedance).collect::<Vec<_>>())
        }
        None => Vec::new(),
    };
    let told = decays.unwrap_or_default().iter().zip(&materials).map(|(decay, material)| TracedDecay {
        material: material.clone(),
        reached: decay.speeds().to_vec(),
        force: decay.forces().to_vec(),
    });
    Traced {
        format: FORMAT,
        name: design.name.clone(),
        impact: design.impact_in_words(),
        diameter: lattice.diameter(),
        half_width: lattice.half_width(),
        target: design.target.clone(),
        decays: told.collect(),
        materials,
        layout: layout.materials.clone(),
        proposal: None,
        decay_method: None,
        rays: Vec::new(),
        wavefronts: Vec::new(),
        caustic: Vec::new(),
        spots: [None, None],
        isochrones,
        focal_arrival: [None, earliest(|focus| focus.arrival[1])],
        focal_arrival_decaying: earliest(|focus| focus.arrival_decaying),
        foci,
        first_arrival,
        warnings,
        sites,
    }
}

/// First arrivals in any layout, without rays: nobody knows its faces. Isochrones every `interval` (s), or at some round
/// time. `decays` as for [`trace_lens`], for the layout's palette.
pub fn trace_arrivals(design: &Design, layout: &Layout, interval: Option<f64>, decays: Option<&[Decay]>) -> Traced {
    let plain = eikonal(design, layout, None);
    trace_layout(design, layout, &plain, decays, |latest| {
        times(interval.unwrap_or_else(|| round(latest / 20.0)), latest)
    })
}

/// First arrivals at the speeds of [`site_speeds`].
pub(super) fn eikonal(design: &Design, layout: &Layout, decays: Option<&[Decay]>) -> Eikonal {
    Eikonal::of_plane_wave(&layout.lattice, &site_speeds(layout, design.constants, decays), MESH)
}

/// The least of 1, 2, 5 times a power of ten that is not below a number.
fn round(least: f64) -> f64 {
    let power = 10.0_f64.powf(least.log10().floor());
    [1.0, 2.0, 5.0, 10.0].into_iter().map(|k| k * power).find(|step| *step >= least * (1.0 - 1e-9)).unwrap_or(least)
}

/// More lines than that would be a black picture.
const MOST_FRONTS: usize = 200;

fn times(interval: f64, latest: f64) -> Vec<f64> {
    (1..=MOST_FRONTS).map(|k| k as f64 * interval).take_while(|time| *time < latest).collect()
}
