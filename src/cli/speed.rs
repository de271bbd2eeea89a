//! `granulens speed`: the closed-form bound of the wave speed.

use granulens::contact::Constants;
use granulens::material::find;
use granulens::wave::{Dimension, bound};
use serde_json::json;

use super::console::{emit, emit_json};
use super::failure::Failure;
use super::folder::write_json;
use super::{Common, length};

/// The closed-form bound of the wave speed (Burgoyne 2016, eqs 4.7 and 5.3)
///
/// With --out, the numbers are written as JSON too.
#[derive(clap::Args)]
pub struct Speed {
    /// Material; give two for a dimer with mixed contacts
    #[arg(long = "material", value_name = "NAME", required = true)]
    materials: Vec<String>,
    /// 1 chain, 2 hexagonal sheet, 3 close packing
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u8).range(1..=3))]
    dimension: u8,
    /// Sphere diameter; the speed does not depend on it
    #[arg(long, default_value = "6.35 mm", allow_hyphen_values = true, value_parser = length)]
    diameter: f64,
    /// Set of fitted constants: code, text, sixteenth-inch or eq-4.7
    #[arg(long, default_value_t = Constants::Code)]
    constants: Constants,
}

impl Speed {
    pub fn run(self, common: &Common) -> Result<(), Failure> {
        let materials: Vec<_> = self.materials.iter().map(|name| find(name, &[])).collect::<Result<_, _>>()?;
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
        let dimension = match self.dimension {
            1 => Dimension::One,
            2 => Dimension::Two,
            _ => Dimension::Three,
        };
        let bound = bound(dimension, pair, self.diameter, self.constants);
        let names: Vec<&str> = materials.iter().map(|m| m.name.as_str()).collect();
        let numbers = json!({
            "format": granulens::outcome::FORMAT,
            "materials": names,
            "dimension": self.dimension,
            "diameter_m": self.diameter,
            "constants": self.constants.name(),
            "speed_m_s": bound.speed,
            "stiffness_N_m": bound.stiffness,
            "fully_plastic_force_N": bound.plastic_force,
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
                self.dimension,
                bound.stiffness,
                bound.plastic_force,
                self.constants
            ));
        }
        Ok(())
    }
}
