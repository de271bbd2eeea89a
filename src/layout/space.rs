//! Layouts in space as CSV: header `layer,column,x,y,z,diameter,material`; SI; lines that start with `#` are comments.
//!
//! Layer 1 is struck, columns count the spheres of a layer's half x ≥ 0 from 1 in order of y, then x; x = y = 0 is the axis of the lens.

use std::fmt::Write as _;
use std::path::Path;

use super::Layout;
use super::error::{LayoutFileError, Source};
use super::read::{EXACT, ROUNDED};
use super::table::{self, Table};
use crate::lattice::{Block, Layered, Outline};
use crate::material::Material;
use crate::output::marked;

const COLUMNS: [&str; 7] = ["layer", "column", "x", "y", "z", "diameter", "material"];

/// The simulated half as CSV text.
pub fn write_in_space(layout: &Layout<Block>) -> String {
    let block = &layout.lattice;
    let [wide, high] = block.cells();
    let mut text = String::from("# granulens layout, format 1; simulated half, x >= 0; lengths in metres\n");
    let _ = writeln!(
        text,
        "# {}, diameter {} m, {} layers of {wide} by {high} cells{}, axis through a sphere of layer {}; layer 1 is struck",
        block.cell().name(),
        block.diameter(),
        block.layers(),
        match block.outline() {
            Outline::All => "",
            Outline::Disk(_) => ", round",
            Outline::Hexagon(_) => ", a hexagon",
        },
        block.axis_layer()
    );
    let _ = writeln!(text, "{}", COLUMNS.join(","));
    for (site, &material) in block.sites().iter().zip(&layout.materials) {
        let ([x, y, z], name) = (site.centre, &layout.palette[usize::from(material)].name);
        let _ = writeln!(text, "{},{},{x},{y},{z},{},{name}", site.layer, site.column, block.diameter());
    }
    marked(text)
}

/// Every sphere of the whole crystal as CSV text: the half and its image; columns are left out, as the half alone has them.
pub fn write_whole_in_space(layout: &Layout<Block>) -> String {
    let block = &layout.lattice;
    let mut text =
        String::from("# granulens layout, format 1; whole crystal; lengths in metres\nlayer,x,y,z,diameter,material\n");
    for ((site, &copies), &material) in block.sites().iter().zip(block.copies()).zip(&layout.materials) {
        let ([x, y, z], name) = (site.centre, &layout.palette[usize::from(material)].name);
        for x in [x, -x].into_iter().take(usize::from(copies)) {
            let _ = writeln!(text, "{},{x},{y},{z},{},{name}", site.layer, block.diameter());
        }
    }
    marked(text)
}

/// Reads the layout of a block's half. Materials are found by name or alias among `own`, then in the library; the palette starts with
/// `palette`, so that host and lens material keep their places.
///
/// # Errors
/// Every way in which the file can differ from the block: missing, double or strange spheres, positions off by more than a thousandth of
/// the diameter, other diameters, unknown materials.
pub fn read_in_space(
    path: &Path,
    block: &Block,
    palette: &[Material],
    own: &[Material],
) -> Result<Layout<Block>, LayoutFileError> {
    let text = table::text(path)?;
    let source = Source { path, text: &text, columns: &COLUMNS };
    let table = Table::of(source, |found| match found.first() {
        Some(&"row") => "That is a layout of a sheet, and the design is a crystal in space.",
        _ => "Name the seven columns in this order; lengths are in metres.",
    })?;
    let mut palette = palette.to_vec();
    let mut given: Vec<Option<(u8, usize)>> = vec![None; block.sites().len()];
    for row in table.rows() {
        row.check()?;
        let (layer, column) = (row.whole(0)?, row.whole(1)?);
        let Some(index) = block.index(layer, column) else {
            let extent = match (1..=block.layers()).contains(&layer) {
                true => format!("layer {layer} has columns 1 to {}", block.layer(layer).len()),
                false => format!("there are layers 1 to {}", block.layers()),
            };
            let message = format!("layer {layer}, column {column} is no site of the design's crystal: {extent}.");
            let help = "The file holds the simulated half, x >= 0, of the design's crystal.";
            return Err(row.fail(Some(1), message).trying(help));
        };
        let [x, y, z] = block.sites()[index].centre;
        for (k, expected) in (2..).zip([x, y, z, block.diameter()]) {
            let (part, what) = if k == 5 { (EXACT, "spheres of") } else { (ROUNDED, "this site at") };
            let help = "Positions follow from layer and column, in metres, to 1e-3 D; only the materials are free.";
            row.off(k, (row.length(k)?, expected), part * block.diameter(), (what, help))?;
        }
        let material = row.material(6, own)?;
        row.is_first(given[index], || format!("layer {layer}, column {column}"))?;
        given[index] = Some((row.place(6, material, &mut palette)?, row.at));
    }
    if let Some(first) = given.iter().position(Option::is_none) {
        let count = given.iter().filter(|given| given.is_none()).count();
        let (site, [x, y, z]) = (&block.sites()[first], block.sites()[first].centre);
        let others = if count > 1 { format!(", and {} others", count - 1) } else { String::new() };
        let message = format!("layer {}, column {} is missing{others}.", site.layer, site.column);
        let help = format!("Add {},{},{x},{y},{z},{},MATERIAL.", site.layer, site.column, block.diameter());
        return Err(source.error(table.header, None, message).trying(help));
    }
    let materials = given.into_iter().flatten().map(|(material, _)| material).collect();
    Ok(Layout { lattice: block.clone(), palette, materials })
}
