//! Forces between grains as a network, and how grains moved; of any program.

use granulens::motion::{RADIUS, follow};
use granulens::network::{
    ANGLE, Bar, Branch, Carrier, Chains, Contact, Fabric, Network, Part, Topology, default_thresholds,
};
use granulens::report;
use numpy::{PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::failure::{Failure, Result};
use crate::values::{Table, maybe, numbers, points, shaped, vector};

fn column<'py>(name: &str, values: &Bound<'py, PyAny>) -> Result<Vec<f64>> {
    numbers(name, values)
}

/// A force network: components, loops, how long each lasts, chains and fabric; see `granulens.network`.
#[pyfunction]
#[pyo3(signature = (i, j, normal, tangential = None, places = None, *, grains = None, period = None, on = "contacts", force = "normal", thresholds = None, title = ""))]
#[expect(clippy::too_many_arguments, reason = "keywords of Python")]
pub fn network<'py>(
    py: Python<'py>,
    i: PyReadonlyArray1<'py, i64>,
    j: PyReadonlyArray1<'py, i64>,
    normal: &Bound<'py, PyAny>,
    tangential: Option<&Bound<'py, PyAny>>,
    places: Option<[Bound<'py, PyAny>; 4]>,
    grains: Option<usize>,
    period: Option<f64>,
    on: &str,
    force: &str,
    thresholds: Option<&Bound<'py, PyAny>>,
    title: &str,
) -> PyResult<Bound<'py, PyDict>> {
    let normal = column("normal", normal)?;
    let tangential = tangential.map_or_else(|| Ok(vec![0.0; normal.len()]), |values| column("tangential", values))?;
    let (i, j) = (i.as_array(), j.as_array());
    if i.len() != normal.len() || j.len() != normal.len() || tangential.len() != normal.len() {
        return Err(Failure::input("i, j, normal and tangential must be equally long").into());
    }
    let grain = |name: &str, number: i64| {
        u32::try_from(number).map_err(|_| Failure::input(format!("{name} = {number} must number a grain, from 0 on")))
    };
    let contacts = (0..normal.len())
        .map(|k| {
            Ok(Contact { grains: [grain("i", i[k])?, grain("j", j[k])?], normal: normal[k], tangential: tangential[k] })
        })
        .collect::<Result<Vec<_>>>()?;
    let most = contacts.iter().flat_map(|contact| contact.grains).max().map_or(0, |most| most as usize + 1);
    let branches = match places {
        None => None,
        Some(places) => {
            let [xi, zi, xj, zj] = places.each_ref().map(|values| column("places", values));
            let (xi, zi, xj, zj) = (xi?, zi?, xj?, zj?);
            if [&xi, &zi, &xj, &zj].iter().any(|column| column.len() != normal.len()) {
                return Err(Failure::input("places must be four columns as long as normal").into());
            }
            Some((0..normal.len()).map(|k| Branch::between([xi[k], zi[k]], [xj[k], zj[k]], period)).collect())
        }
    };
    let carrier = match on {
        "contacts" => Carrier::Contacts,
        "particles" => Carrier::Particles,
        other => return Err(Failure::input(format!("on = {other} must be contacts or particles")).into()),
    };
    let part = match force {
        "normal" => Part::Normal,
        "tangential" => Part::Tangential,
        other => return Err(Failure::input(format!("force = {other} must be normal or tangential")).into()),
    };
    let thresholds = thresholds.map_or_else(|| Ok(default_thresholds()), |values| column("thresholds", values))?;
    if let Some(wrong) = thresholds.iter().find(|x| !(x.is_finite() && **x >= 0.0)) {
        return Err(Failure::input(format!("thresholds: {wrong} is no multiple of the mean force, from 0 on")).into());
    }
    let network = Network::new(grains.unwrap_or(most), contacts, branches).map_err(Failure::from)?;
    let found = py.detach(|| {
        Topology::new(&network, carrier, part, thresholds)
            .map(|topology| (topology, Fabric::new(&network), Chains::new(&network, ANGLE)))
    });
    let (topology, fabric, chains) = found.ok_or_else(|| {
        Failure::with_help(
            "no contact has a normal force, so that there is no mean to measure by",
            "Give the normal forces.",
        )
    })?;
    let counts = |values: &[usize]| vector(py, values.iter().map(|&value| value as i64).collect());
    let bars = |bars: &[Bar]| -> PyResult<Bound<'py, PyAny>> {
        let flat: Vec<f64> = bars.iter().flat_map(|bar| [bar.birth, bar.death.unwrap_or(f64::NAN)]).collect();
        let count = bars.len();
        shaped(py, flat, [count, 2])
    };
    let svg = chains.as_ref().and_then(|chains| {
        report::draw_network(title, &network, network.mean(Carrier::Contacts), chains, report::View::PLAIN)
    });
    let chains = chains.map(|chains| {
        let each = chains.chains.iter().map(|chain| vector(py, chain.iter().map(|&grain| i64::from(grain)).collect()));
        each.collect::<Vec<_>>()
    });
    let tensor = |tensor: Option<granulens::network::StressTensor>| {
        tensor.map(|tensor| shaped(py, tensor.concat(), [2, 2])).transpose()
    };
    Table::new(py)
        .with("grains", network.grains())?
        .with("mean_force", topology.mean_force)?
        .with("thresholds", vector(py, topology.thresholds.clone()))?
        .with("components", counts(&topology.components))?
        .with("loops", counts(&topology.loops))?
        .with("holes", counts(&topology.holes))?
        .with("persistence0", bars(&topology.persistence0)?)?
        .with("persistence1", bars(&topology.persistence1)?)?
        .with("coordination", fabric.coordination)?
        .with("coordination_without_rattlers", fabric.coordination_without_rattlers)?
        .with("rattlers", vector(py, fabric.rattlers.iter().map(|&grain| i64::from(grain)).collect()))?
        .with("fabric", tensor(fabric.tensor)?)?
        .with("virial", tensor(fabric.virial)?)?
        .with("chains", chains)?
        .with("svg", svg)
        .map(|table| table.0)
}

/// How grains moved between two moments, each with its neighbours: the affine map around each and what it leaves, D2_min.
///
/// Parameters
/// ----------
/// before, after : array of float64, shape (n, 2)
///     Places of the same grains.
/// radius : float
///     Radius of the neighbourhood, in the unit of the places; 2.5 where left out.
/// period : float, optional
///     Period along the first axis.
///
/// Returns
/// -------
/// dict of arrays, one entry per grain
///     neighbours : int64; d2min, gradient_norm, rotation_rad, shear_strain : float64, NaN with fewer than three neighbours; map, shape
///     (n, 4), row by row
#[pyfunction]
#[pyo3(signature = (before, after, *, radius = None, period = None))]
pub fn motion<'py>(
    py: Python<'py>,
    before: PyReadonlyArray2<'py, f64>,
    after: PyReadonlyArray2<'py, f64>,
    radius: Option<f64>,
    period: Option<f64>,
) -> PyResult<Bound<'py, PyDict>> {
    let places = |name: &str, array: &PyReadonlyArray2<'py, f64>| -> Result<Vec<[f64; 2]>> {
        let array = array.as_array();
        match array.ncols() {
            2 => Ok(array.rows().into_iter().map(|row| [row[0], row[1]]).collect()),
            columns => Err(Failure::input(format!("{name} must have shape (n, 2), not (n, {columns})"))),
        }
    };
    let (before, after) = (places("before", &before)?, places("after", &after)?);
    let radius = radius.unwrap_or(RADIUS);
    let locals = py.detach(|| follow(&before, &after, radius, period)).map_err(Failure::from)?;
    let map = locals.iter().map(|local| {
        let [[a, b], [c, d]] = local.map.unwrap_or([[f64::NAN; 2]; 2]);
        [a, b, c, d]
    });
    Table::new(py)
        .with("neighbours", vector(py, locals.iter().map(|local| local.neighbours as i64).collect()))?
        .with("d2min", maybe(py, locals.iter().map(|local| local.d2min)))?
        .with("gradient_norm", maybe(py, locals.iter().map(granulens::motion::Local::gradient_norm)))?
        .with("rotation_rad", maybe(py, locals.iter().map(granulens::motion::Local::rotation)))?
        .with("shear_strain", maybe(py, locals.iter().map(granulens::motion::Local::shear)))?
        .with("map", points(py, map.collect())?)
        .map(|table| table.0)
}
