//! Layouts as text: CSV, one line per sphere, enough to build the piece; and JSON.
//!
//! Header `row,column,x,z,diameter,material`; SI; lines that start with `#` are comments. Row 1 is struck, columns count
//! from 1 in order of x, x = 0 is the crystal's axis, z = 0 is row 1.

use std::fmt::Write as _;

use serde_json::json;

use super::read::HEADER;
use super::{Layout, PieceSphere, whole};
use crate::output::marked;

/// The layout's format number, written in the first comment line.
const FORMAT: u32 = 1;

/// The simulated half as CSV text.
pub fn write(layout: &Layout) -> String {
    let mut text = preamble(layout, "simulated half, x >= 0");
    for (site, &material) in layout.lattice.sites().iter().zip(&layout.materials) {
        line(&mut text, [site.row, site.column], site.x, site.z, layout, material);
    }
    marked(text)
}

/// The whole piece as CSV text: the simulated half and its mirror image about the axis, columns counted anew from the left.
pub fn write_full(layout: &Layout) -> String {
    write_piece(layout, &whole(layout))
}

/// A whole piece, whose halves may differ, as CSV text; `spheres` are those of [`whole`], of any of the layout's materials.
pub fn write_piece(layout: &Layout, spheres: &[PieceSphere]) -> String {
    let mut text = preamble(layout, "whole piece, both halves");
    for sphere in spheres {
        line(&mut text, [sphere.row, sphere.column], sphere.x, sphere.z, layout, sphere.material);
    }
    marked(text)
}

fn preamble(layout: &Layout, extent: &str) -> String {
    let lattice = &layout.lattice;
    let mut text = format!("# granulens layout, format {FORMAT}; {extent}; lengths in metres\n");
    let _ = writeln!(
        text,
        "# {}, diameter {} m{}, {} rows, half width {} m; row 1 is struck, x = 0 is the crystal's axis",
        lattice.packing().name(),
        lattice.diameter(),
        if lattice.is_equal() { "" } else { " between columns, rows of their own" },
        lattice.rows(),
        lattice.half_width()
    );
    text.push_str(&HEADER.join(","));
    text.push('\n');
    text
}

fn line(text: &mut String, [row, column]: [u32; 2], x: f64, z: f64, layout: &Layout, material: u8) {
    let name = &layout.palette[usize::from(material)].name;
    let _ = writeln!(text, "{row},{column},{x},{z},{},{name}", layout.lattice.row_diameter(row));
}

/// The simulated half as JSON text: the same columns as the CSV.
pub fn write_json(layout: &Layout) -> String {
    let lattice = &layout.lattice;
    let spheres = lattice.sites().into_iter().zip(&layout.materials).map(|(site, &material)| {
        json!({
            "row": site.row, "column": site.column, "x": site.x, "z": site.z,
            "diameter": lattice.row_diameter(site.row), "material": layout.palette[usize::from(material)].name,
        })
    });
    let layout = json!({
        "format": FORMAT, "packing": lattice.packing().name(), "diameter_m": lattice.diameter(), "rows": lattice.rows(),
        "half_width_m": lattice.half_width(), "spheres": spheres.collect::<Vec<_>>(),
    });
    format!("{layout:#}\n")
}
