//! `granulens speed`: the closed-form bound of the wave speed.

use std::path::PathBuf;

use granulens::contact::Pair;
use granulens::design::Shelf;
use granulens::wave::{REACHED_ERROR, bound, speed_reached};
use serde_json::json;

use super::console::{emit, emit_json};
use super::failure::Failure;
use super::folder::write_json;
use super::{Common, Crystal};

/// The closed-form bound of the wave speed (Burgoyne 2016, eqs 4.7 and 5.3)
///
/// With --out, the numbers are written as JSON too.
#[derive(clap::Args)]
pub struct Speed {
    /// Material; give two for a dimer with mixed contacts
    #[arg(long = "material", value_name = "NAME", required = true)]
    materials: Vec<String>,
    /// File with own materials, [materials.NAME], alone or in a design
    #[arg(long = "materials", value_name = "FILE")]
    own: Option<PathBuf>,
    #[command(flatten)]
    crystal: Crystal,
    /// Contact force in F_p, from 0.35: the speed to be expected there, beside the bound
    #[arg(long, value_name = "NUMBER", allow_hyphen_values = true)]
    amplitude: Option<f64>,
}

impl Speed {
    pub fn run(self, common: &Common) -> Result<(), Failure> {
        let shelf = self.own.as_ref().map(Shelf::read).transpose()?.unwrap_or_default();
        let materials: Vec<_> = self.materials.iter().map(|name| shelf.find(name)).collect::<Result<_, _>>()?;
        let pair = match materials.as_slice() {
            [one] => [one, one],
            [one, two] => [one, two],
            more => {
                return Err(Failure::input_with_help(
                    format!("--material is given {} times; there is no closed form for more than two", more.len()),
                    "Give one material for a uniform crystal, two for a dimer.",
                ));
            }
        };
        let Crystal { dimension, diameter, constants } = self.crystal;
        let contact = Pair::new(pair, [0.5 * diameter; 2], constants);
        let density = 0.5 * (pair[0].density + pair[1].density);
        let reached = match self.amplitude {
            Some(amplitude) => Some((
                amplitude,
                speed_reached(&contact, density, amplitude).ok_or_else(|| {
                    Failure::input_with_help(
                        format!("--amplitude {amplitude}: contacts stay mostly elastic, and no speed is known"),
                        "Give the contact force as a multiple of F_p, from 0.35.",
                    )
                })?,
            )),
            None => None,
        };
        let bound = bound(self.crystal.dimension(), pair, diameter, constants);
        let names: Vec<&str> = materials.iter().map(|m| m.name.as_str()).collect();
        let numbers = json!({
            "format": granulens::outcome::FORMAT,
            "materials": names,
            "dimension": dimension,
            "diameter_m": diameter,
            "constants": constants.name(),
            "speed_m_s": bound.speed,
            "stiffness_N_m": bound.stiffness,
            "fully_plastic_force_N": bound.plastic_force,
            "amplitude_F_p": reached.map(|(amplitude, _)| amplitude),
            "expected_speed_m_s": reached.map(|(_, part)| part * bound.speed),
        });
        write_json(common, &numbers)?;
        if common.json {
            emit_json(&numbers);
        } else {
            emit(&format!(
                "{}: wave-speed bound {:.1} m/s in {}D, contact stiffness {:.4e} N/m, fully plastic from {:.1} N on \
                 (constants {})",
                names.join(" + "),
                bound.speed,
                dimension,
                bound.stiffness,
                bound.plastic_force,
                constants
            ));
            if let Some((amplitude, part)) = reached {
                emit(&format!(
                    "at {amplitude} F_p, {:.1} N on each contact, a steady wave runs at {:.1} m/s, {part:.3} of the bound \
                     (to {} %)",
                    amplitude * bound.plastic_force,
                    part * bound.speed,
                    100.0 * REACHED_ERROR
                ));
            }
        }
        Ok(())
    }
}
