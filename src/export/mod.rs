//! Files for other tools: LAMMPS, OVITO, ParaView.
//!
//! In: a [`Rig`] or a running [`Simulation`](crate::dem::rig::Simulation). Out: text. Nothing here writes files.
//!
//! - here: the whole crystal of a layout, as a rig that repeats itself
//! - `lammps`: data file, input deck and trajectory of a rig of Hertz contacts
//! - `columns`: tables as CSV and Parquet; `frames`: frames of beds and rigs as such
//! - `xyz`: frames in extended XYZ; `vtp`: spheres and contacts as VTK PolyData, and their collection over time

mod columns;
mod frames;
mod lammps;
mod vtp;
mod xyz;

#[cfg(feature = "parquet")]
pub use columns::ParquetFile;
pub use columns::{Column, Columns};
pub use frames::{frame_bodies, frame_contacts};
pub use lammps::{Deck, DeckError, deck, dump_frame};
pub use vtp::{bed_bodies, bed_contacts, collection, contacts, spheres};
pub use xyz::{bed_frame, frame};

use crate::contact::{Constants, LawKind};
use crate::dem::Strike;
use crate::dem::rig::{Body, Law, LawBook, Rig};
use crate::lattice::{HexagonalSheet, Site};
use crate::layout::Layout;
use crate::sample::{Sample, Sphere};

/// The whole crystal of a layout under a pulse on its first row: both halves, repeating itself across the wave after twice the
/// half width. It moves as the half between its mirrors does, to rounding.
///
/// Spheres stand in the order of the layout's sites, each with its mirror image, if it has one, right behind it.
pub fn whole_crystal(layout: &Layout, strike: impl Into<Strike>, law: LawKind, constants: Constants) -> Rig<2> {
    let sheet = &layout.lattice;
    let half_width = sheet.half_width();
    let sites = sheet.sites();
    let mut spheres = Vec::new();
    let mut struck = Vec::new();
    for (site, is_image) in whole_places(sheet) {
        let (material, site) = (layout.materials[site], &sites[site]);
        if site.row == 1 {
            struck.push(Body::Sphere(spheres.len()));
        }
        let x = if is_image { -site.x } else { site.x };
        let radius = 0.5 * sheet.row_diameter(site.row);
        spheres.push(Sphere { centre: [x, site.z], radius, material: usize::from(material) });
    }
    let sample = Sample { materials: layout.palette.clone(), spheres };
    let laws = LawBook::Materials { law: Law::Named(law), constants, pairs: Vec::new(), friction: None };
    let mut rig = Rig::new(sample, laws);
    rig.periods[0] = Some(2.0 * half_width);
    rig.strike(strike.into(), struck, -0.5 * sheet.row_diameter(1));
    rig
}

/// The spheres of a whole sheet that repeats itself after twice the half width: the site of each, and whether it is the site's image.
pub fn whole_places(sheet: &HexagonalSheet) -> Vec<(usize, bool)> {
    let half_width = sheet.half_width();
    let images = |(site, place): (usize, Site)| {
        // A site on a mirror line is its own image; on the far one the image lies a period away.
        let on_mirror = place.x == 0.0 || (half_width - place.x).abs() < 0.5e-9 * sheet.diameter();
        [(site, false), (site, true)].into_iter().take(if on_mirror { 1 } else { 2 })
    };
    sheet.sites().into_iter().enumerate().flat_map(images).collect()
}

/// Coordinates in space: a chain lies along y, a sheet in the x-y plane with its depth along y.
fn in_space<const D: usize>(vector: [f64; D]) -> [f64; 3] {
    match D {
        1 => [0.0, vector[0], 0.0],
        2 => [vector[0], vector[1], 0.0],
        _ => [vector[0], vector[1], vector[2]],
    }
}

/// Between which coordinates in space the spheres of a rig lie, the origin among them.
fn ends<const D: usize>(rig: &Rig<D>) -> [[f64; 2]; 3] {
    let radius = rig.sample.spheres.iter().map(|s| s.radius).fold(0.0, f64::max);
    let mut ends = [[-radius, radius]; 3];
    for sphere in &rig.sample.spheres {
        let centre = in_space(sphere.centre);
        for k in 0..3 {
            ends[k] = [ends[k][0].min(centre[k] - radius), ends[k][1].max(centre[k] + radius)];
        }
    }
    ends
}

/// The axis in space of one of the rig's.
const fn axis_in_space<const D: usize>(axis: usize) -> usize {
    if D == 1 { 1 } else { axis }
}
