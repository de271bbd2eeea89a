//! `granulens materials`: the library with its sources.

use std::fmt::Write as _;
use std::path::PathBuf;

use granulens::design::Design;
use granulens::material::{aliases, library};
use serde_json::json;

use super::Common;
use super::console::{emit, emit_json};
use super::failure::Failure;
use super::folder::write_json;

/// List the materials, with their sources
///
/// Own ones are written into a design file as [materials.NAME], with density, youngs_modulus, poisson_ratio, yield_stress,
/// rate_constant and source. With --out, the list is written as JSON too.
#[derive(clap::Args)]
pub struct Materials {
    /// Design file whose own materials are listed too
    design: Option<PathBuf>,
}

impl Materials {
    pub fn run(self, common: &Common) -> Result<(), Failure> {
        let mut materials = library();
        if let Some(path) = &self.design {
            materials.extend(Design::read(path)?.own_materials);
        }
        let list: Vec<_> = materials
            .iter()
            .map(|m| {
                json!({
                    "name": m.name, "aliases": aliases(&m.name), "density_kg_m3": m.density,
                    "youngs_modulus_Pa": m.youngs_modulus, "poisson_ratio": m.poisson_ratio,
                    "yield_stress_Pa": m.yield_stress, "rate_constant": m.rate_constant, "source": m.source,
                })
            })
            .collect();
        let list = json!({ "format": granulens::outcome::FORMAT, "materials": list });
        write_json(common, &list)?;
        if common.json {
            emit_json(&list);
            return Ok(());
        }
        let mut text = format!(
            "{:<18} {:>8} {:>7} {:>6} {:>7} {:>7}  {}\n{:<18} {:>8} {:>7} {:>6} {:>7} {:>7}\n",
            "material", "density", "E", "nu", "yield", "rate C", "aliases", "", "kg/m3", "GPa", "", "MPa", ""
        );
        for m in &materials {
            let _ = writeln!(
                text,
                "{:<18} {:>8} {:>7} {:>6} {:>7} {:>7}  {}",
                m.name,
                m.density,
                m.youngs_modulus / 1e9,
                m.poisson_ratio,
                m.yield_stress / 1e6,
                m.rate_constant,
                aliases(&m.name).join(", ")
            );
        }
        text.push_str("\nsources\n");
        for m in &materials {
            let _ = writeln!(text, "{:<18} {}", m.name, m.source);
        }
        emit(&text);
        Ok(())
    }
}
