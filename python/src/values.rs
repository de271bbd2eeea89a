//! Arrays, tables and nested results.

use numpy::{IntoPyArray as _, PyArrayMethods as _};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use serde_json::Value;

use crate::failure::{Failure, Result};

/// A vector as an array, without a copy.
pub fn vector<T: numpy::Element>(py: Python<'_>, values: Vec<T>) -> Bound<'_, PyAny> {
    values.into_pyarray(py).into_any()
}

/// Rows of the same length one after the other, as an array of some shape, without a copy.
pub fn shaped<'py>(
    py: Python<'py>,
    flat: Vec<f64>,
    shape: impl numpy::ndarray::IntoDimension,
) -> PyResult<Bound<'py, PyAny>> {
    Ok(flat.into_pyarray(py).reshape(shape)?.into_any())
}

/// Points as an array of shape (n, D).
pub fn points<'py, const D: usize>(py: Python<'py>, points: Vec<[f64; D]>) -> PyResult<Bound<'py, PyAny>> {
    let count = points.len();
    shaped(py, points.into_flattened(), [count, D])
}

/// Numbers that may be missing: NaN where they are.
pub fn maybe(py: Python<'_>, values: impl IntoIterator<Item = Option<f64>>) -> Bound<'_, PyAny> {
    vector(py, values.into_iter().map(|value| value.unwrap_or(f64::NAN)).collect())
}

/// Anything that is stored as JSON, as dicts, lists and arrays: lists of numbers become arrays, also nested ones whose rows are as long as
/// each other; numbers that are missing in them become NaN.
pub fn nested<'py>(py: Python<'py>, value: &impl serde::Serialize) -> PyResult<Bound<'py, PyAny>> {
    let value = serde_json::to_value(value).map_err(|error| Failure::input(error.to_string()))?;
    of_json(py, &value)
}

pub fn of_json<'py>(py: Python<'py>, value: &Value) -> PyResult<Bound<'py, PyAny>> {
    Ok(match value {
        Value::Null => py.None().into_bound(py),
        Value::Bool(value) => value.into_pyobject(py)?.to_owned().into_any(),
        Value::Number(number) => match number.as_i64() {
            Some(whole) => whole.into_pyobject(py)?.into_any(),
            None => number.as_f64().unwrap_or(f64::NAN).into_pyobject(py)?.into_any(),
        },
        Value::String(text) => text.into_pyobject(py)?.into_any(),
        Value::Object(map) => {
            let dict = PyDict::new(py);
            for (key, value) in map {
                dict.set_item(key, of_json(py, value)?)?;
            }
            dict.into_any()
        }
        Value::Array(items) => match array(py, items)? {
            Some(array) => array,
            None => {
                let items = items.iter().map(|item| of_json(py, item)).collect::<PyResult<Vec<_>>>()?;
                PyList::new(py, items)?.into_any()
            }
        },
    })
}

/// A list of numbers, or of rows of numbers, as an array.
fn array<'py>(py: Python<'py>, items: &[Value]) -> PyResult<Option<Bound<'py, PyAny>>> {
    if items.is_empty() || items.iter().all(Value::is_null) {
        return Ok(None);
    }
    if let Some(whole) = items.iter().map(Value::as_i64).collect::<Option<Vec<_>>>() {
        return Ok(Some(vector(py, whole)));
    }
    let number = |item: &Value| if item.is_null() { Some(f64::NAN) } else { item.as_f64() };
    let row = |items: &[Value]| items.iter().map(number).collect::<Option<Vec<f64>>>();
    if let Some(numbers) = row(items) {
        return Ok(Some(vector(py, numbers)));
    }
    let rows = items.iter().map(|item| item.as_array().and_then(|items| row(items))).collect::<Option<Vec<_>>>();
    match rows {
        Some(rows) if rows[0].len() > 1 && rows.iter().all(|row| row.len() == rows[0].len()) => {
            let shape = [rows.len(), rows[0].len()];
            Ok(Some(shaped(py, rows.concat(), shape)?))
        }
        _ => Ok(None),
    }
}

/// A table: names and columns.
pub struct Table<'py>(pub Bound<'py, PyDict>);

impl<'py> Table<'py> {
    pub fn new(py: Python<'py>) -> Self {
        Self(PyDict::new(py))
    }

    pub fn with(self, name: &str, column: impl IntoPyObject<'py>) -> PyResult<Self> {
        self.0.set_item(name, column)?;
        Ok(self)
    }
}

/// A length with its unit as text, or a number of metres.
#[derive(FromPyObject)]
pub enum Length {
    Metres(f64),
    Text(String),
}

impl Length {
    pub fn metres(&self, name: &str) -> Result<f64> {
        let metres = match self {
            Self::Metres(metres) => *metres,
            Self::Text(text) => granulens::units::Dimension::Length
                .parse(text)
                .map_err(|error| Failure::input(format!("{name}: {error}")))?,
        };
        if metres > 0.0 && metres.is_finite() {
            Ok(metres)
        } else {
            Err(Failure::input(format!("{name} = {metres} must be positive, in metres or as text such as \"6.35 mm\"")))
        }
    }
}

/// A time with its unit as text, or a number of seconds.
#[derive(FromPyObject)]
pub enum Time {
    Seconds(f64),
    Text(String),
}

impl Time {
    pub fn seconds(&self, name: &str) -> Result<f64> {
        let seconds = match self {
            Self::Seconds(seconds) => *seconds,
            Self::Text(text) => granulens::units::Dimension::Time
                .parse(text)
                .map_err(|error| Failure::input(format!("{name}: {error}")))?,
        };
        if seconds > 0.0 && seconds.is_finite() {
            Ok(seconds)
        } else {
            Err(Failure::input(format!(
                "{name} = {seconds} must be positive, in seconds or as text such as \"0.1 us\""
            )))
        }
    }
}

/// A list of numbers, whatever holds them.
pub fn numbers(name: &str, values: &Bound<'_, PyAny>) -> Result<Vec<f64>> {
    let fail = || Failure::input(format!("{name} must be numbers in one row"));
    if let Ok(array) = values.extract::<numpy::PyReadonlyArray1<'_, f64>>() {
        return Ok(array.as_array().to_vec());
    }
    values.extract::<Vec<f64>>().map_err(|_| fail())
}
