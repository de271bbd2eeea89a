//! The design surface: the wave speed, or what goes with it, over stiffness and density, with all known media on it.

use granulens::design::Design;
use granulens::report::{surface, surface_data};
use granulens::wave::{self, Medium, Setting, Surface, Value as Shown};
use serde::Deserialize;
use serde_json::{Value, json};

use super::desk::read;
use super::server::Shared;
use crate::cli::design::all_materials;
use crate::cli::failure::Failure;
use crate::cli::surface::GRID;

#[derive(Deserialize)]
pub struct Asked {
    text: String,
    /// Which value: see `granulens surface --value`.
    value: String,
}

/// Picture and numbers, with what the design names marked.
pub fn show(asked: &Asked, shared: &Shared) -> Result<Value, Failure> {
    let design = read(&asked.text, shared)?;
    let value = Shown::ALL.into_iter().find(|value| value.name() == asked.value);
    let value = value.ok_or_else(|| Failure::input(format!("there is no value {}", asked.value)))?;
    let setting = setting(&design, value);
    let axes = value.axes();
    let materials = all_materials(&design);
    let mut media = Medium::all(&materials);
    media.extend(Medium::published_engineered(&materials));
    let points = wave::points(&media, axes, &setting);
    let ends = |k: usize| {
        let places = points.iter().map(|point| point.place[k]);
        let [low, high] = places.fold([f64::INFINITY, 0.0], |[l, h], p| [f64::min(l, p), f64::max(h, p)]);
        // A margin in which labels find room.
        [low / 1.25, high * 1.25]
    };
    let grid =
        Surface::new(axes, [ends(0), ends(1)], GRID, &setting).map_err(|error| Failure::input(error.to_string()))?;
    Ok(json!({
        "svg": surface(&grid, &points, &granulens::report::Look::default()),
        "data": surface_data(&grid, &points),
        "own": design.palette().iter().map(|material| Medium::uniform(material).label).collect::<Vec<_>>(),
        "names": materials.iter().map(|material| json!([Medium::uniform(material).label, material.name])).collect::<Vec<_>>(),
        "values": Shown::ALL.map(Shown::name).to_vec(),
    }))
}

/// The crystal of the design: a sheet of its spheres, against its host.
fn setting(design: &Design, value: Shown) -> Setting {
    Setting {
        value,
        against: Some(Medium::uniform(&design.host)),
        material: design.host.clone(),
        stiffness: None,
        dimension: wave::Dimension::Two,
        amplitude: None,
        diameter: design.lattice.diameter(),
        constants: design.constants,
    }
}
