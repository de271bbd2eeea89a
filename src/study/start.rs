//! Where a search begins.

use std::path::{Path, PathBuf};

use super::StudyError;
use super::family::Laid;
use super::source::Source;
use crate::design::DesignRef;
use crate::material::Material;

/// Where a search begins.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Start {
    /// The design's lens.
    Lens,
    /// A smooth random layout that follows from the seed.
    Random,
    /// A layout file.
    File(PathBuf),
}

/// Reads one start: what it is, and the material of every site as a place in the palette, which grows by what is new.
pub(super) fn read(
    source: &Source<'_>,
    start: &str,
    design: DesignRef<'_>,
    palette: &mut Vec<Material>,
    beside: impl Fn(&Path) -> PathBuf,
) -> Result<(Start, Vec<u8>), StudyError> {
    match start {
        "random" => Ok((Start::Random, vec![0; design.sites()])),
        "lens" => {
            let Some(request) = design.lens() else {
                let message = "start = \"lens\", but the design has no [lens]. Try start = \"random\".";
                return Err(source.fail("start", message.to_owned()));
            };
            let laid = Laid::new(design, request)
                .map_err(|error| source.fail("start", format!("start = \"lens\": {error} Try start = \"random\".")))?;
            let place = |material: &Material| {
                palette.iter().position(|known| known == material).unwrap_or_else(|| {
                    palette.push(material.clone());
                    palette.len() - 1
                }) as u8
            };
            let places: Vec<u8> = laid.palette.iter().map(place).collect();
            let base = laid.materials.iter().map(|&m| places[usize::from(m)]).collect();
            Ok((Start::Lens, base))
        }
        name if name.ends_with(".csv") => {
            let path = beside(Path::new(name));
            let read = design.read_layout(&path, palette)?;
            *palette = read.palette().to_vec();
            Ok((Start::File(path), read.materials().to_vec()))
        }
        _ => {
            let message = format!("start = \"{start}\" must be \"lens\", \"random\" or a layout file, NAME.csv.");
            Err(source.fail("start", message))
        }
    }
}
