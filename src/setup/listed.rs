//! Patterns given site by site: layouts of lenses as files.

use std::collections::HashMap;

use crate::document::{DocumentError, Entry};
use crate::lattice::{Crystal, HexagonalSheet};
use crate::layout;
use crate::material::Material;

/// The material of every site of a hexagonal sheet, as places in the palette, from a layout's file, which holds the half x ≥ 0;
/// the other half, where the crystal has it, is its mirror image.
pub(super) fn layout<const D: usize>(
    crystal: &Crystal<D>,
    entry: &Entry,
    palette: &mut Vec<Material>,
    own: &[Material],
) -> Result<Vec<Option<usize>>, DocumentError> {
    let path = entry.path()?;
    let misfit = |rule: &str| {
        let help = "A layout fits crystal.packing = \"hexagonal\" with its axis at x = 0, as [\"0 D\", \"16.5 D\"] or \
                    [\"-16.5 D\", \"16.5 D\"].";
        entry.fail(rule, help)
    };
    if crystal.cell().name() != "hexagonal" || D != 2 {
        return Err(misfit("is a layout of a hexagonal sheet, and the crystal is none"));
    }
    let diameter = crystal.diameter();
    // Sites lie half a diameter apart across the wave.
    let position = |x: f64| (2.0 * x.abs() / diameter).round() as u32;
    let width = crystal.sites().iter().map(|site| position(site.centre[0])).max().unwrap_or(0);
    let lattice = HexagonalSheet::new(diameter, crystal.layers(), 0.5 * f64::from(width))
        .map_err(|error| misfit(&format!("does not fit the crystal: {error}")))?;
    let read = layout::read(&path, &lattice, palette, own).map_err(|error| {
        let help = error.help.clone().unwrap_or_default();
        let mut refused = DocumentError::of_file(&path, error.message.clone(), help);
        refused.line = error.line.map(|line| line as usize);
        refused
    })?;
    *palette = read.palette;
    let sites = lattice.sites();
    let material: HashMap<(u32, u32), usize> =
        sites.iter().zip(&read.materials).map(|(site, &m)| ((site.row, position(site.x)), usize::from(m))).collect();
    let of = |layer: u32, x: f64| material.get(&(layer, position(x))).copied();
    let listed: Vec<Option<usize>> = crystal.sites().iter().map(|site| of(site.layer, site.centre[0])).collect();
    if listed.contains(&None) {
        return Err(misfit("does not fit the crystal, whose sites lie beside those of the layout"));
    }
    Ok(listed)
}
