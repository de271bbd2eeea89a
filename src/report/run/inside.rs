//! What goes on inside a sheet, from the frames of its run.

use std::collections::BTreeMap;
use std::path::Path;

use super::{RunReportError, table};
use crate::motion::{self, follow};
use crate::network::{ANGLE, Carrier, Chains, frames, read_frame};
use crate::report::inside::{View, draw_motion, draw_network};
use crate::run::{Series, Summary};
use crate::units::Dimension::Time;

/// The force network at its moment, and non-affine motion from the first frame to the last; none of a run without frames.
pub(super) fn pictures(folder: &Path, summary: &Summary) -> Result<Vec<(String, String)>, RunReportError> {
    let mut pictures = Vec::new();
    let place = folder.join("frames");
    if !place.is_dir() || summary.dimension != 2 {
        return Ok(pictures);
    }
    let files = frames(&place)?;
    let (when, why) = moment(folder)?;
    let moment = files.get(when).or(files.last());
    let marked = marked(folder, summary);
    let view = View { marked: &marked, ..View::CRYSTAL };
    if let Some(files) = moment {
        let named = read_frame(files)?;
        let time = named.time.map_or(String::new(), |time| format!(" at {}, {why}", Time.show(time)));
        let mean = named.network.mean(Carrier::Contacts);
        let title = format!("{}{time}", summary.name);
        let chains = Chains::new(&named.network, ANGLE);
        let drawn = chains.and_then(|chains| draw_network(&title, &named.network, mean, &chains, view));
        pictures.extend(drawn.filter(|_| mean > 0.0).map(|svg| ("network.svg".to_owned(), svg)));
    }
    if let [[before, _], .., [after, _]] = &files[..] {
        let moved = motion::read(before, after)?;
        let diameter = moved.diameter.unwrap_or(1.0);
        if let Ok(locals) = follow(&moved.before, &moved.after, motion::RADIUS * diameter, moved.period) {
            let title = format!("{}, from first to last", summary.name);
            pictures.push(("motion.svg".to_owned(), draw_motion(&title, &moved.before, &locals, diameter, view)));
        }
    }
    Ok(pictures)
}

/// Which frame shows most: that with the greatest kinetic energy of the first region, or, without regions, with most energy stored in
/// contacts. Samples and frames are as many.
fn moment(folder: &Path) -> Result<(usize, String), RunReportError> {
    let of =
        |name: &str, column: &dyn Fn(&[String]) -> Option<usize>| -> Result<Option<(usize, String)>, RunReportError> {
            let path = folder.join(name);
            if !path.exists() {
                return Ok(None);
            }
            let record = Series::read(&path, usize::MAX)?;
            let Some(column) = column(&record.names) else { return Ok(None) };
            let values = record.columns[column].iter().enumerate();
            let most = values.max_by(|a, b| a.1.total_cmp(b.1)).map(|(k, _)| k);
            Ok(most.map(|k| (k, record.names[column].clone())))
        };
    let kinetic = |names: &[String]| names.iter().position(|name| name.ends_with("_kinetic_J"));
    if let Some((k, column)) = of("regions.csv", &kinetic)? {
        let region = column.trim_end_matches("_kinetic_J");
        return Ok((k, format!("when the kinetic energy of \"{region}\" is greatest")));
    }
    let stored = |names: &[String]| names.iter().position(|name| name == "stored_J");
    let found = of("energies.csv", &stored)?.map_or(0, |(k, _)| k);
    Ok((found, "when contacts store most".to_owned()))
}

/// Spheres of another material than most.
fn marked(folder: &Path, summary: &Summary) -> Vec<([f64; 2], f64)> {
    let text = std::fs::read_to_string(folder.join("spheres-final.csv")).unwrap_or_default();
    let Some((spheres, _)) = summary.arrivals.first().and_then(|column| table(&text, 2, column)) else {
        return Vec::new();
    };
    let mut counts = BTreeMap::new();
    spheres.iter().for_each(|sphere| *counts.entry(sphere.first_material).or_insert(0) += 1);
    let usual = counts.get(&true) >= counts.get(&false);
    let others = spheres.iter().filter(|sphere| sphere.first_material != usual);
    others.map(|sphere| ([sphere.centre[0], sphere.centre[1]], 0.5 * sphere.diameter)).collect()
}
