//! Frames as Parquet files: one of bodies and one of contacts, a group of rows for each moment.

use std::path::{Path, PathBuf};

use crate::cli::Common;
use crate::cli::failure::Failure;

/// Writes them moment by moment, so that memory holds one.
#[cfg(feature = "parquet")]
pub fn write(common: &Common, place: &Path, frames: &[[PathBuf; 2]]) -> Result<(), Failure> {
    use std::fs::File;
    use std::io::BufWriter;

    use granulens::bed::{FRAME_SI, FRAME_UNITS, Frame, read_frame_named};
    use granulens::export::{Columns, ParquetFile, frame_bodies, frame_contacts};
    use granulens::outcome::{COMMIT, VERSION};
    use serde_json::json;

    let folder = crate::cli::folder::begin(common, place)?;
    let failed = |error: &dyn std::fmt::Display| Failure::input(format!("{}: {error}", place.display()));
    let first = frames.first().map(read_frame_named).transpose()?.map(|(frame, _)| frame).unwrap_or_default();
    let units = if frames.first().is_some_and(|[grains, _]| is_bed(grains)) { FRAME_UNITS } else { FRAME_SI };
    let mut notes = vec![("units", units.to_owned())];
    notes.extend(first.period.map(|period| ("period_x", format!("{period:?}"))));
    let begin = |name: &str, like: Columns| {
        let file = File::create(folder.path().join(format!("{name}.parquet"))).map_err(|error| failed(&error))?;
        ParquetFile::new(BufWriter::new(file), name, &like, &notes).map_err(|error| failed(&error))
    };
    let mut grains = begin("grains", frame_bodies(0, &Frame::default()))?;
    let mut contacts = begin("contacts", frame_contacts(0, &Frame::default(), &[]))?;
    for (number, files) in (0..).zip(frames) {
        let (frame, flats) = read_frame_named(files)?;
        grains.add(&frame_bodies(number, &frame)).map_err(|error| failed(&error))?;
        contacts.add(&frame_contacts(number, &frame, &flats)).map_err(|error| failed(&error))?;
    }
    grains.finish().and_then(|()| contacts.finish()).map_err(|error| failed(&error))?;
    super::finish(folder, json!({ "version": VERSION, "commit": COMMIT }))
}

/// Whether frames are of a bed, as the first line of their files says.
#[cfg(feature = "parquet")]
fn is_bed(grains: &Path) -> bool {
    let text = granulens::input::text(grains).unwrap_or_default();
    text.lines().next().is_some_and(|line| line.contains(granulens::bed::FRAME_UNITS))
}

/// Says that there is nothing to write them with.
#[cfg(not(feature = "parquet"))]
pub fn write(_: &Common, place: &Path, _: &[[PathBuf; 2]]) -> Result<(), Failure> {
    Err(Failure::input_with_help(
        format!("{}: this granulens is built without the feature parquet.", place.display()),
        "pandas.read_csv takes the frames as they are; or build with cargo build --release --features parquet.",
    ))
}
