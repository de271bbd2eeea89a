//! What rays and first arrivals say of a design, without a simulation.

use std::collections::HashMap;

use super::proposal;
use crate::contact::Constants;
use crate::design::Design;
use crate::lattice::Site;
use crate::layout::Layout;
use crate::lens::Lens;
use crate::outcome::{FORMAT, Front, Traced, TracedRay, TracedSpot};
use crate::ray::{Eikonal, Spot, Trace, caustic, fan, least_spot, spot, wavefront};
use crate::wave::{Dimension, mixture_speed};

/// Rays behind spots, caustic and wavefronts.
const FINE: usize = 601;

/// First arrivals are found on a mesh so many times finer than the lattice.
const MESH: u32 = 4;

/// Traces a design's lens with `rays` rays to be drawn; wavefronts every `interval` (s), or at some round time.
pub fn trace_lens(design: &Design, lens: &Lens, rays: usize, interval: Option<f64>) -> Traced {
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
    let traced = trace_layout(design, &lens.layout(), &times);
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

/// First arrivals in any layout, and where they are at the given times (s).
fn trace_layout(design: &Design, layout: &Layout, times: &[f64]) -> Traced {
    let lattice = &layout.lattice;
    let eikonal = eikonal(design, layout);
    let first_arrival = eikonal.at_sites();
    let isochrone = |&time: &f64| {
        let lines = eikonal.isochrone(time).into_iter().map(|piece| piece.to_vec()).collect();
        Front { time, lines }
    };
    let focus = design.target.focus.sites(lattice);
    let mid = design.target.focus.mid_row();
    let sites = lattice.sites();
    let in_middle = focus.iter().filter(|&&site| (f64::from(sites[site].row) - mid).abs() <= 0.5);
    let first = in_middle.map(|&site| first_arrival[site]).min_by(f64::total_cmp);
    Traced {
        format: FORMAT,
        name: design.name.clone(),
        impact: design.impact_in_words(),
        diameter: lattice.diameter(),
        half_width: lattice.half_width(),
        target: design.target,
        materials: layout.palette.iter().map(|material| material.name.clone()).collect(),
        layout: layout.materials.clone(),
        proposal: None,
        rays: Vec::new(),
        wavefronts: Vec::new(),
        caustic: Vec::new(),
        spots: [None, None],
        isochrones: times.iter().map(isochrone).collect(),
        focal_arrival: [None, first],
        first_arrival,
        sites,
    }
}

/// First arrivals in any layout, without rays: nobody knows its faces. Isochrones every `interval` (s), or at some round
/// time.
pub fn trace_arrivals(design: &Design, layout: &Layout, interval: Option<f64>) -> Traced {
    let latest = eikonal(design, layout).at_sites().into_iter().fold(0.0, f64::max);
    trace_layout(design, layout, &times(interval.unwrap_or_else(|| round(latest / 20.0)), latest))
}

pub(super) fn eikonal(design: &Design, layout: &Layout) -> Eikonal {
    let lattice = &layout.lattice;
    Eikonal::of_plane_wave(lattice, &local_speeds(layout, design.constants), MESH)
}

/// Speed at each site: that of a random mixture of what it and its neighbours are made of. A wave is several spheres long
/// and cannot tell single ones apart.
pub(super) fn local_speeds(layout: &Layout, constants: Constants) -> Vec<f64> {
    let lattice = &layout.lattice;
    let kinds = layout.palette.len();
    // Few mixtures occur, and each takes some microseconds.
    let mut known: HashMap<Vec<u32>, f64> = HashMap::new();
    let mut speed = |counts: Vec<u32>| -> f64 {
        if let Some(&speed) = known.get(&counts) {
            return speed;
        }
        let whole = f64::from(counts.iter().sum::<u32>());
        let parts: Vec<_> =
            layout.palette.iter().zip(&counts).map(|(m, &count)| (m, f64::from(count) / whole)).collect();
        let speed = mixture_speed(Dimension::Two, &parts, lattice.diameter(), constants);
        known.insert(counts, speed);
        speed
    };
    let neighbourhood = |site: &Site| {
        let (row, column) = (i64::from(site.row), i64::from(site.column));
        // Odd rows begin on the axis, even ones half a diameter off it.
        let left = if site.row.is_multiple_of(2) { 0 } else { -1 };
        let around = [(0, 0), (0, -1), (0, 1), (-1, left), (-1, left + 1), (1, left), (1, left + 1)];
        let mut counts = vec![0; kinds];
        for (down, across) in around {
            let place = u32::try_from(row + down).ok().zip(u32::try_from(column + across).ok());
            if let Some(index) = place.and_then(|(row, column)| lattice.index(row, column)) {
                counts[usize::from(layout.materials[index])] += 1;
            }
        }
        counts
    };
    lattice.sites().iter().map(neighbourhood).map(&mut speed).collect()
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
