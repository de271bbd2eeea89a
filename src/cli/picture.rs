//! Figures as files: how they are drawn for a paper, and as what.

use std::path::Path;

use granulens::report::{self, Look, Palette};
use granulens::units::Dimension::Length;

use super::Common;
use super::failure::Failure;
use super::folder::{write_bytes, write_file};

/// How a figure is drawn for a paper.
#[derive(clap::Args)]
pub struct Paper {
    /// Width as printed, such as "86 mm" for a column; titles are then left to the caption
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true, value_parser = width)]
    width: Option<f64>,
    /// Size of letters in points, from 4 to 24, where a width is given [default: 8]
    #[arg(long, value_name = "POINTS", requires = "width", value_parser = points)]
    font_size: Option<f64>,
    /// Colours: viridis or grey
    #[arg(long, value_name = "NAME", value_parser = palette)]
    palette: Option<Palette>,
}

fn width(text: &str) -> Result<f64, String> {
    let width = Length.parse(text).map_err(|error| error.to_string())?;
    if (0.03..=1.0).contains(&width) { Ok(width) } else { Err("must lie from 30 mm to 1 m".to_owned()) }
}

fn points(text: &str) -> Result<f64, String> {
    let size: f64 =
        text.trim().trim_end_matches("pt").trim().parse().map_err(|_| "must be a number of points".to_owned())?;
    if (4.0..=24.0).contains(&size) { Ok(size) } else { Err("must lie from 4 to 24 points".to_owned()) }
}

fn palette(text: &str) -> Result<Palette, String> {
    let found = Palette::ALL.iter().find(|(name, _)| *name == text);
    found.map(|(_, palette)| *palette).ok_or_else(|| "known are viridis and grey".to_owned())
}

impl Paper {
    /// As figures are asked for it.
    pub fn look(&self) -> Look {
        Look { width: self.width, font_size: self.font_size, palette: self.palette.unwrap_or_default(), labelled: None }
    }
}

/// What a figure may be written as.
pub const KINDS: [&str; 3] = ["svg", "pdf", "png"];

/// Whether a file is to hold something of that kind.
pub fn ends_in(path: &Path, wanted: &str) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(wanted))
}

/// Writes a picture as the file's name says: PDF, PNG, else SVG.
pub fn write_picture(common: &Common, path: &Path, svg: &str) -> Result<(), Failure> {
    let drawn = match () {
        () if ends_in(path, "pdf") => report::pdf(svg),
        () if ends_in(path, "png") => report::png(svg),
        () => return write_file(common, path, svg),
    };
    write_bytes(common, path, &drawn.map_err(|error| Failure::input(format!("{}: {error}", path.display())))?)
}
