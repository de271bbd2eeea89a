//! What rays and first arrivals say of a design, without a simulation.

use super::proposal;
use crate::design::Design;
use crate::layout::Layout;
use crate::lens::Lens;
use crate::outcome::{FORMAT, Front, Traced, TracedDecay, TracedRay, TracedSpot};
use crate::ray::{Eikonal, Spot, Trace, caustic, fan, least_spot, spot, wavefront};
use crate::wave::{Decay, site_speeds};

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
    let latest = fine.iter().filter_map(|trace| trace.path.times.last().copied()).fold(0.0, f64::max);
    let times = times(interval.unwrap_or_else(|| round(latest / 20.0)), latest);
    let ray = |trace: Trace| TracedRay {
        failure: optics.failure(&trace.fate),
        points: trace.path.points,
        times: trace.path.times,
    };
    // A lens on either mirror line has its image beyond it: its spot lies there, not in the middle of one half.
    let edge = [0.0, lens.lattice.half_width()].into_iter().find(|edge| *edge == lens.axis);
    let about =
        |spot: Spot| TracedSpot { depth: spot.depth, centre: spot.centre, radius: spot.radius, rays: spot.rays };
    let [depth, end] =
        [design.target.focus.mid_row(), f64::from(design.lattice.rows())].map(|row| design.lattice.depth(row));
    let behind = lens.faces().into_iter().flatten().map(|point| point[1]).fold(0.0, f64::max);
    let layout = lens.layout();
    let traced = trace_layout(design, &layout, &eikonal(design, &layout, None), decays, |_| times.clone());
    Traced {
        proposal: Some(proposal(design, lens)),
        rays: fan(&*optics, rays).into_iter().map(ray).collect(),
        wavefronts: times.iter().map(|&time| Front { time, lines: wavefront(&fine, time) }).collect(),
        caustic: caustic(&*optics, FINE),
        spots: [spot(&fine, depth, edge), least_spot(&fine, [behind, end], edge)].map(|spot| spot.map(about)),
        focal_arrival: [lens.first_order.arrival.map(|range| range[0]), traced.focal_arrival[1]],
        ..traced
    }
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
    let isochrone = |&time: &f64| {
        let lines = eikonal.isochrone(time).into_iter().map(|piece| piece.to_vec()).collect();
        Front { time, lines }
    };
    let focus = design.target.focus.sites(lattice);
    let mid = design.target.focus.mid_row();
    let sites = lattice.sites();
    let in_middle = focus.iter().filter(|&&site| (f64::from(sites[site].row) - mid).abs() <= 0.5);
    let middle: Vec<usize> = in_middle.copied().collect();
    let first = |arrivals: &[f64]| middle.iter().map(|&site| arrivals[site]).min_by(f64::total_cmp);
    let materials: Vec<String> = layout.palette.iter().map(|material| material.name.clone()).collect();
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
        target: design.target,
        decays: told.collect(),
        materials,
        layout: layout.materials.clone(),
        proposal: None,
        rays: Vec::new(),
        wavefronts: Vec::new(),
        caustic: Vec::new(),
        spots: [None, None],
        isochrones: times.iter().map(isochrone).collect(),
        focal_arrival: [None, first(&plain.at_sites())],
        focal_arrival_decaying: decays.and_then(|_| first(&first_arrival)),
        first_arrival,
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
