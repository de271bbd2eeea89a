//! What a workshop gets: from a layout to drawings, lists and a frame.
//!
//! In: a [`Piece`], the layout as it is to be built, with the letter and the hatching of each material. Out: the texts and bytes of
//! files; nothing here writes one. Lengths of drawings are in millimetres, x to the right from the crystal's axis and y down from row 1, as
//! z is.
//!
//! - `piece`: what is built, a sheet or the layers of a crystal in space, and how its materials are told apart
//! - `drawing`: shapes on paper; `pdf`, `svg`: the same shapes as files; `glyphs`: widths of letters
//! - `map`: the assembly map at 1:1; `pages`: the map cut into sheets of paper
//! - `dxf`: the map for CAD
//! - `parts`: how many of what, `spares`: and how many besides; `placement`: row by row, to tick
//! - `frame`: the walls that stand for the mirror lines, as a solid, `tray`: those of a crystal in space, `three_mf`: as slicers take it; `walls`: what they change
//! - `inspection`: which spheres to measure first; `sorted`: which sphere of a measured batch goes where
//! - `diff`: what differs between two layouts

mod diff;
mod drawing;
mod dxf;
mod frame;
mod glyphs;
mod inspection;
mod map;
mod pages;
mod parts;
mod pdf;
mod piece;
mod placement;
mod sorted;
mod spares;
mod svg;
mod three_mf;
mod tray;
mod walls;

pub use crate::page::Hatch;
pub use diff::{Change, changes};
pub use dxf::dxf;
pub use frame::{Frame, Solid};
pub use inspection::{Inspected, inspection, inspection_csv, inspection_of_layers, layers_inspection_csv};
pub use map::map_svg;
pub use pages::{Paper, map_pdf, maps_pdf};
pub use parts::{Part, parts, parts_csv, parts_in_space, total_cost};
pub use piece::{Kind, Mark, Piece};
pub use placement::{layers_csv, placement_csv, placement_pdf, placements_pdf};
pub use sorted::{
    Ball, BatchError, Placing, layers_placings_csv, placings, placings_csv, placings_of_layers, read_batch,
};
pub use spares::{Spares, Yield};
pub use tray::Tray;
pub use walls::{WallEffect, in_walls};
