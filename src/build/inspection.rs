//! Which spheres to measure first.
//!
//! Ranked by the greatest kinetic energy that each sphere carried when the layout was simulated under the design's impact, least first.
//! Where the wave is strong, spheres are pressed into each
//! other by many times what their diameters differ; where it is weak, a gap of some micrometres is as wide as the overlap. Measured
//! (`docs/build.md`), not proved; it is no sensitivity.

use std::fmt::Write as _;

use super::piece::Piece;

/// A sphere of the piece with what it carried.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inspected {
    /// Index among the piece's spheres.
    pub sphere: usize,
    /// Greatest kinetic energy (J).
    pub energy: f64,
}

/// All spheres of the piece, those that matter most first; `max_kinetic` is by site of the simulated half, or then by the sites' images
/// too (J).
pub fn inspection(piece: &Piece, max_kinetic: &[f64], sites: usize) -> Vec<Inspected> {
    let place = |sphere: usize| {
        let at = &piece.spheres[sphere];
        if at.x < 0.0 && max_kinetic.len() > sites { sites + at.site } else { at.site }
    };
    let mut list: Vec<Inspected> =
        (0..piece.spheres.len()).map(|sphere| Inspected { sphere, energy: max_kinetic[place(sphere)] }).collect();
    // A stable sort: of equals, mirror images among them, in order of rows and columns.
    list.sort_by(|a, b| a.energy.total_cmp(&b.energy));
    list
}

/// The same of the layers of a crystal in space: with each sphere the index of its layer among the pieces.
pub fn inspection_of_layers(layers: &[Piece], max_kinetic: &[f64]) -> Vec<(usize, Inspected)> {
    let of = |(k, piece)| inspection(piece, max_kinetic, max_kinetic.len()).into_iter().map(move |one| (k, one));
    let mut list: Vec<(usize, Inspected)> = layers.iter().enumerate().flat_map(of).collect();
    list.sort_by(|a, b| a.1.energy.total_cmp(&b.1.energy));
    list
}

/// The same as a table.
pub fn layers_inspection_csv(layers: &[Piece], list: &[(usize, Inspected)]) -> String {
    let mut text = "rank,layer,row,column,letter,material,max_kinetic_J\n".to_owned();
    for (rank, (layer, Inspected { sphere, energy })) in (1..).zip(list) {
        let piece = &layers[*layer];
        let sphere = &piece.spheres[*sphere];
        let (mark, number) = (piece.mark(sphere), piece.number());
        let (row, column) = (sphere.row, sphere.column);
        let _ = writeln!(text, "{rank},{number},{row},{column},{},{},{energy:.6e}", mark.letter, mark.material);
    }
    text
}

/// As a table.
pub fn inspection_csv(piece: &Piece, list: &[Inspected]) -> String {
    let mut text = "rank,row,column,letter,material,max_kinetic_J\n".to_owned();
    for (rank, Inspected { sphere, energy }) in (1..).zip(list) {
        let sphere = &piece.spheres[*sphere];
        let mark = piece.mark(sphere);
        let _ =
            writeln!(text, "{rank},{},{},{},{},{energy:.6e}", sphere.row, sphere.column, mark.letter, mark.material);
    }
    text
}
