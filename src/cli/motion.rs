//! `granulens motion`: affine and non-affine motion of grains between two moments.

use std::path::PathBuf;

use granulens::motion::{Local, Moved, RADIUS, follow, read};
use granulens::report::{View, draw_motion};
use serde_json::json;

use super::Common;
use super::console::{emit, emit_json, note, pretty};
use super::failure::Failure;
use super::folder::write_file;

/// How grains really moved: the affine map around each that fits best, and what it leaves, D2_min (Falk and Langer 1998)
///
/// Reads places before and after as CSV with the columns id,x,z, others ignored, and writes
/// id,x,z,d2min,a11,a12,a21,a22,neighbours: x,z before; d2min, the sum over the neighbours within the radius before of the squared
/// distance from where the map would take them (Kondic et al. 2012, eq. 4); the map by rows; empty below three neighbours. With
/// --json also the norm of the displacement gradient, rotation and strain.
#[derive(clap::Args)]
pub struct Motion {
    /// Places before: CSV with id,x,z
    before: PathBuf,
    /// Places after, of the same grains
    after: PathBuf,
    /// Radius of the neighbourhood [default: 2.5 mean diameters, by a column diameter of BEFORE; 2.5 without one]
    #[arg(long, value_name = "R", allow_hyphen_values = true)]
    radius: Option<f64>,
    /// Period along x
    #[arg(long, value_name = "L", allow_hyphen_values = true)]
    period_x: Option<f64>,
    /// Draw D2_min as a map, as SVG to this file
    #[arg(long, value_name = "FILE")]
    map: Option<PathBuf>,
}

impl Motion {
    pub fn run(self, common: &Common) -> Result<(), Failure> {
        let moved = read(&self.before, &self.after)?;
        let radius = self.radius.unwrap_or(RADIUS * moved.diameter.unwrap_or(1.0));
        let period = self.period_x.or(moved.period);
        let locals = follow(&moved.before, &moved.after, radius, period).map_err(|error| {
            Failure::input_with_help(
                error.to_string(),
                "See --radius and --period-x; the period is that of the bed's sides.",
            )
        })?;
        if let Some(path) = &self.map {
            let stem = self.after.file_stem().map_or(String::new(), |stem| stem.to_string_lossy().into_owned());
            // Without diameters circles as large as neighbourhoods of twenty grains have room for.
            let diameter = moved.diameter.unwrap_or(0.4 * radius);
            write_file(common, path, &draw_motion(&stem, &moved.before, &locals, diameter, View::PLAIN))?;
        }
        let known: Vec<f64> = locals.iter().filter_map(|local| local.d2min).collect();
        let mean = known.iter().sum::<f64>() / known.len().max(1) as f64;
        note(
            common,
            &format!(
                "{} grains, radius {radius}, mean D2_min {mean:.6e} over the {} with three neighbours or more",
                locals.len(),
                known.len()
            ),
        );
        if common.json {
            let numbers = json!({
                "format": granulens::outcome::FORMAT,
                "radius": radius,
                "period_x": period,
                "mean_d2min": (!known.is_empty()).then_some(mean),
                "grains": locals.iter().enumerate().map(|(k, local)| json!({
                    "id": moved.names[k],
                    "x": moved.before[k][0],
                    "z": moved.before[k][1],
                    "d2min": local.d2min,
                    "map": local.map,
                    "neighbours": local.neighbours,
                    "gradient_norm": local.gradient_norm(),
                    "rotation_rad": local.rotation(),
                    "strain": local.strain(),
                    "shear_strain": local.shear(),
                })).collect::<Vec<_>>(),
            });
            return match &common.out {
                Some(path) => write_file(common, path, &pretty(&numbers)),
                None => {
                    emit_json(&numbers);
                    Ok(())
                }
            };
        }
        let text = table(&moved, &locals);
        match &common.out {
            Some(path) => write_file(common, path, &text),
            None => {
                emit(&text);
                Ok(())
            }
        }
    }
}

fn table(moved: &Moved, locals: &[Local]) -> String {
    let mut text = "id,x,z,d2min,a11,a12,a21,a22,neighbours\n".to_owned();
    for (k, Local { neighbours, d2min, map }) in locals.iter().enumerate() {
        let [x, z] = moved.before[k];
        let number = |value: Option<f64>| value.map_or(String::new(), |value| value.to_string());
        let map = [[0, 0], [0, 1], [1, 0], [1, 1]].map(|[i, k]| number(map.map(|map| map[i][k]))).join(",");
        text += &format!("{},{x},{z},{},{map},{neighbours}\n", moved.names[k], number(*d2min));
    }
    text
}
