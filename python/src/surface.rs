//! Design surfaces.

use granulens::contact::Constants;
use granulens::report;
use granulens::wave::{self, Axis, Dimension, Medium, Setting, Surface as Grid, Value};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::failure::{Failure, Result};
use crate::material::MaterialLike;
use crate::values::{Length, Table, maybe, vector};

fn axis(name: &str) -> Result<Axis> {
    Axis::ALL.into_iter().find(|axis| axis.name() == name).ok_or_else(|| {
        let known: Vec<&str> = Axis::ALL.iter().map(|axis| axis.name()).collect();
        Failure::input(format!("unknown axis {name}; known are {}", known.join(", ")))
    })
}

/// The least and the greatest place of the media along an axis, with a margin.
fn range(axis: Axis, k: usize, points: &[wave::Point], diameter: f64) -> [f64; 2] {
    match axis {
        Axis::Amplitude => wave::AMPLITUDES,
        Axis::Radius => [diameter / 16.0, 4.0 * diameter],
        _ => {
            let places = points.iter().map(|point| point.place[k]);
            let [low, high] = places.fold([f64::INFINITY, 0.0], |[l, h], p| [f64::min(l, p), f64::max(h, p)]);
            [low / 1.25, high * 1.25]
        }
    }
}

/// A value over two design variables, as a picture and as arrays; see `granulens.surface`.
#[pyfunction]
#[pyo3(signature = (value, x, y, x_range, y_range, shape, material, against, dimension, diameter, constants, amplitude))]
#[expect(clippy::too_many_arguments, reason = "keywords of Python")]
pub fn surface<'py>(
    py: Python<'py>,
    value: &str,
    x: Option<&str>,
    y: Option<&str>,
    x_range: Option<[f64; 2]>,
    y_range: Option<[f64; 2]>,
    shape: [usize; 2],
    material: MaterialLike,
    against: Option<MaterialLike>,
    dimension: u8,
    diameter: Length,
    constants: &str,
    amplitude: Option<f64>,
) -> PyResult<Bound<'py, PyDict>> {
    let value = Value::ALL.into_iter().find(|known| known.name() == value).ok_or_else(|| {
        let known: Vec<&str> = Value::ALL.iter().map(|value| value.name()).collect();
        Failure::input(format!("unknown value {value}; known are {}", known.join(", ")))
    })?;
    let own = value.axes();
    let axes = [x.map_or(Ok(own[0]), axis)?, y.map_or(Ok(own[1]), axis)?];
    let material = material.material(&[])?;
    let against = against.map_or_else(|| Ok(material.clone()), |other| other.material(&[]))?;
    let diameter = diameter.metres("diameter")?;
    let constants: Constants = constants.parse().map_err(Failure::from)?;
    let dimension = Dimension::from_number(dimension)
        .ok_or_else(|| Failure::input(format!("dimension = {dimension} must be 1, 2 or 3")))?;
    if let Some(amplitude) = amplitude
        && !(amplitude >= wave::AMPLITUDES[0] && amplitude.is_finite())
    {
        let message =
            format!("amplitude = {amplitude}: below {} F_p contacts stay mostly elastic", wave::AMPLITUDES[0]);
        return Err(Failure::with_help(message, "Give the contact force as a multiple of F_p, from 0.35.").into());
    }
    if shape.iter().any(|&count| !(2..=2000).contains(&count)) {
        return Err(Failure::input(format!("shape = {shape:?} must be two numbers from 2 to 2000")).into());
    }
    let against = Some(Medium::uniform(&against));
    let setting = Setting { value, against, material, stiffness: None, dimension, amplitude, diameter, constants };
    let library = granulens::material::library();
    let mut media = Medium::all(&library);
    media.extend(Medium::published_engineered(&library));
    let points = wave::points(&media, axes, &setting);
    let ranges = [
        x_range.unwrap_or_else(|| range(axes[0], 0, &points, diameter)),
        y_range.unwrap_or_else(|| range(axes[1], 1, &points, diameter)),
    ];
    let grid = Grid::new(axes, ranges, shape, &setting).map_err(Failure::from)?;
    if grid.range().is_none() {
        return Err(Failure::with_help(
            "nothing can be said anywhere on this surface",
            "The yield stress must be below a tenth of the modulus, where the contact law's fit ends.",
        )
        .into());
    }
    let [nx, ny] = [grid.nodes[0].len(), grid.nodes[1].len()];
    let values = (0..ny).flat_map(|j| (0..nx).map(move |i| (i, j))).map(|(i, j)| grid.at(i, j));
    let media = Table::new(py)
        .with("label", points.iter().map(|p| p.label.as_str()).collect::<Vec<_>>())?
        .with("kind", points.iter().map(|p| p.kind.name()).collect::<Vec<_>>())?
        .with("x", vector(py, points.iter().map(|p| p.place[0]).collect()))?
        .with("y", vector(py, points.iter().map(|p| p.place[1]).collect()))?
        .with("value", vector(py, points.iter().map(|p| p.value).collect()))?;
    let nodes = |k: usize| vector(py, grid.nodes[k].iter().map(|node| node.value).collect::<Vec<f64>>());
    Ok(Table::new(py)
        .with("column", value.column())?
        .with("axes", axes.map(Axis::name))?
        .with("x", nodes(0))?
        .with("y", nodes(1))?
        .with("values", maybe(py, values).call_method1("reshape", (ny, nx))?)?
        .with("media", media.0)?
        .with("svg", report::surface(&grid, &points, &report::Look::default()))?
        .0)
}
