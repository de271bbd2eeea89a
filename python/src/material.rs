//! Materials, contacts of two spheres, and wave-speed bounds.

use granulens::contact::{AnyLaw, Constants, ForceLaw as _, History, LawKind, Pair};
use granulens::material::{self, aliases, library};
use granulens::wave::{self, Dimension};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::failure::{Failure, Result};
use crate::values::{Length, Table, numbers, vector};

/// A material of spheres, by its constants.
///
/// Parameters
/// ----------
/// name : str
///     Name, for tables and files.
/// density : float
///     Mass density (kg/m^3).
/// youngs_modulus : float
///     Young's modulus (Pa).
/// poisson_ratio : float
///     Poisson's ratio, 0 to 0.5.
/// yield_stress : float
///     Quasistatic yield stress (Pa).
/// rate_constant : float
///     Rate constant C of the yield stress (dimensionless).
/// source : str
///     Where the values are from.
#[pyclass(frozen, module = "granulens", eq, from_py_object)]
#[derive(Clone, PartialEq)]
pub struct Material {
    pub inner: material::Material,
}

#[pymethods]
impl Material {
    #[new]
    #[pyo3(signature = (name, *, density, youngs_modulus, poisson_ratio, yield_stress, rate_constant = 0.0, source = "own"))]
    fn new(
        name: String,
        density: f64,
        youngs_modulus: f64,
        poisson_ratio: f64,
        yield_stress: f64,
        rate_constant: f64,
        source: &str,
    ) -> Result<Self> {
        let source = source.to_owned();
        let inner =
            material::Material { name, density, youngs_modulus, poisson_ratio, yield_stress, rate_constant, source };
        inner.check()?;
        Ok(Self { inner })
    }

    /// Name.
    #[getter]
    fn name(&self) -> &str {
        &self.inner.name
    }
    /// Mass density (kg/m^3).
    #[getter]
    fn density(&self) -> f64 {
        self.inner.density
    }
    /// Young's modulus (Pa).
    #[getter]
    fn youngs_modulus(&self) -> f64 {
        self.inner.youngs_modulus
    }
    /// Poisson's ratio.
    #[getter]
    fn poisson_ratio(&self) -> f64 {
        self.inner.poisson_ratio
    }
    /// Quasistatic yield stress (Pa).
    #[getter]
    fn yield_stress(&self) -> f64 {
        self.inner.yield_stress
    }
    /// Rate constant of the yield stress (dimensionless).
    #[getter]
    fn rate_constant(&self) -> f64 {
        self.inner.rate_constant
    }
    /// Where the values are from.
    #[getter]
    fn source(&self) -> &str {
        &self.inner.source
    }
    fn __repr__(&self) -> String {
        let m = &self.inner;
        format!(
            "Material({:?}, density={}, youngs_modulus={:e}, poisson_ratio={}, yield_stress={:e}, rate_constant={})",
            m.name, m.density, m.youngs_modulus, m.poisson_ratio, m.yield_stress, m.rate_constant
        )
    }
    fn __hash__(&self) -> u64 {
        self.inner.density.to_bits() ^ self.inner.youngs_modulus.to_bits().rotate_left(21)
    }
}

/// A material, or the name of one of the library's.
#[derive(FromPyObject)]
pub enum MaterialLike {
    Material(Material),
    Name(String),
}

impl MaterialLike {
    /// The material; names are also looked for among `own`.
    pub fn material(&self, own: &[material::Material]) -> Result<material::Material> {
        match self {
            Self::Material(material) => Ok(material.inner.clone()),
            Self::Name(name) => Ok(material::find(name, own)?),
        }
    }
}

/// A material of the library by its name or alias.
#[pyfunction]
#[pyo3(signature = (name, /))]
pub fn find_material(name: &str) -> Result<Material> {
    Ok(Material { inner: material::find(name, &[])? })
}

/// The library of materials as a table (a dict of columns, one entry per material).
///
/// Columns: name, aliases (str); density_kg_m3, youngs_modulus_Pa, poisson_ratio, yield_stress_Pa, rate_constant (float64); source (str).
#[pyfunction]
pub fn materials(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    let all = library();
    let column = |of: fn(&material::Material) -> f64| vector(py, all.iter().map(of).collect());
    Ok(Table::new(py)
        .with("name", all.iter().map(|m| m.name.as_str()).collect::<Vec<_>>())?
        .with("aliases", all.iter().map(|m| aliases(&m.name).join(", ")).collect::<Vec<_>>())?
        .with("density_kg_m3", column(|m| m.density))?
        .with("youngs_modulus_Pa", column(|m| m.youngs_modulus))?
        .with("poisson_ratio", column(|m| m.poisson_ratio))?
        .with("yield_stress_Pa", column(|m| m.yield_stress))?
        .with("rate_constant", column(|m| m.rate_constant))?
        .with("source", all.iter().map(|m| m.source.as_str()).collect::<Vec<_>>())?
        .0)
}

/// Two spheres in contact: their pair and law.
fn of_pair(
    a: &MaterialLike,
    b: Option<&MaterialLike>,
    diameters: (&Length, Option<&Length>),
    law: &str,
    constants: &str,
) -> Result<(Pair, AnyLaw, Constants)> {
    let first = a.material(&[])?;
    let second = b.map_or_else(|| Ok(first.clone()), |b| b.material(&[]))?;
    let one = diameters.0.metres("diameter")?;
    let two = diameters.1.map_or(Ok(one), |other| other.metres("diameter_b"))?;
    let constants: Constants = constants.parse()?;
    let kind: LawKind = law.parse()?;
    let pair = Pair::new([&first, &second], [0.5 * one, 0.5 * two], constants);
    let law = AnyLaw::new(kind, &pair);
    Ok((pair, law, constants))
}

/// Where the contact of two spheres yields, and how stiff it is, at rest.
///
/// Returns
/// -------
/// dict
///     effective_modulus_Pa, effective_radius_m, reduced_mass_kg, yield_stress_Pa, yield_overlap_m, yield_force_N, plastic_overlap_m,
///     fully_plastic_force_N, plastic_stiffness_N_m : float
#[pyfunction]
#[pyo3(signature = (a, b = None, *, diameter = Length::Metres(6.35e-3), diameter_b = None, constants = "code"))]
pub fn contact<'py>(
    py: Python<'py>,
    a: MaterialLike,
    b: Option<MaterialLike>,
    diameter: Length,
    diameter_b: Option<Length>,
    constants: &str,
) -> PyResult<Bound<'py, PyDict>> {
    let (pair, ..) = of_pair(&a, b.as_ref(), (&diameter, diameter_b.as_ref()), "thesis", constants)?;
    let regions = pair.regions(1.0);
    Ok(Table::new(py)
        .with("effective_modulus_Pa", pair.modulus)?
        .with("effective_radius_m", pair.radius)?
        .with("reduced_mass_kg", pair.reduced_mass)?
        .with("yield_stress_Pa", pair.yield_stress)?
        .with("rate_constant", pair.rate_constant)?
        .with("yield_overlap_m", regions.yield_overlap)?
        .with("yield_force_N", regions.yield_force)?
        .with("plastic_overlap_m", regions.plastic_overlap)?
        .with("fully_plastic_force_N", regions.plastic_force)?
        .with("plastic_stiffness_N_m", pair.plastic_stiffness())?
        .0)
}

/// The contact force along a path of overlaps: loaded, unloaded and loaded again as the path goes.
///
/// What a contact remembers is advanced from each overlap to the next, as in a simulation.
///
/// Parameters
/// ----------
/// a, b : Material or str
///     The two spheres' materials; b is a where left out.
/// overlap : array of float, shape (n,)
///     Overlaps (m), in the order in which they are passed.
/// closing_speed : float or array of float, shape (n,)
///     How fast the overlap grows (m/s).
/// diameter, diameter_b : float or str
///     Diameters (m, or text with a unit).
/// law : str
///     Contact law, such as thesis, consistent, hertz.
/// constants : str
///     Set of fitted constants: code, text, sixteenth-inch, eq-4.7.
///
/// Returns
/// -------
/// dict of arrays of shape (n,)
///     overlap_m, closing_speed_m_s, force_N, overlap_max_m, force_max_N
#[pyfunction]
#[pyo3(signature = (a, b = None, *, overlap, closing_speed = None, diameter = Length::Metres(6.35e-3), diameter_b = None, law = "thesis", constants = "code"))]
#[expect(clippy::too_many_arguments, reason = "keywords of Python")]
pub fn contact_path<'py>(
    py: Python<'py>,
    a: MaterialLike,
    b: Option<MaterialLike>,
    overlap: &Bound<'py, PyAny>,
    closing_speed: Option<&Bound<'py, PyAny>>,
    diameter: Length,
    diameter_b: Option<Length>,
    law: &str,
    constants: &str,
) -> PyResult<Bound<'py, PyDict>> {
    let (_, law, _) = of_pair(&a, b.as_ref(), (&diameter, diameter_b.as_ref()), law, constants)?;
    let overlap = numbers("overlap", overlap)?;
    let speed = match closing_speed {
        None => vec![0.0; overlap.len()],
        Some(speed) => match speed.extract::<f64>() {
            Ok(speed) => vec![speed; overlap.len()],
            Err(_) => numbers("closing_speed", speed)?,
        },
    };
    if speed.len() != overlap.len() {
        let message = format!("closing_speed has {} values, overlap {}", speed.len(), overlap.len());
        return Err(Failure::input(message).into());
    }
    if let Some(wrong) = overlap.iter().chain(&speed).find(|x| !x.is_finite()) {
        return Err(Failure::input(format!("overlap and closing_speed must be finite numbers, not {wrong}")).into());
    }
    let mut history = History::new();
    let (mut force, mut overlap_max, mut force_max) = (Vec::new(), Vec::new(), Vec::new());
    for (&overlap, &speed) in overlap.iter().zip(&speed) {
        let (found, after) = law.respond(overlap.max(0.0), speed, &history);
        history = after;
        force.push(if overlap > 0.0 { found } else { 0.0 });
        overlap_max.push(history.overlap_max);
        force_max.push(history.force_max);
    }
    Ok(Table::new(py)
        .with("overlap_m", vector(py, overlap))?
        .with("closing_speed_m_s", vector(py, speed))?
        .with("force_N", vector(py, force))?
        .with("overlap_max_m", vector(py, overlap_max))?
        .with("force_max_N", vector(py, force_max))?
        .0)
}

/// Head-on collisions of two spheres, each at a speed.
///
/// Returns
/// -------
/// dict of arrays of shape (n,)
///     speed_m_s, restitution, force_max_N, overlap_max_m, duration_s
#[pyfunction]
#[pyo3(signature = (a, b = None, *, speeds, diameter = Length::Metres(6.35e-3), diameter_b = None, law = "thesis", constants = "code"))]
#[expect(clippy::too_many_arguments, reason = "keywords of Python")]
pub fn collide<'py>(
    py: Python<'py>,
    a: MaterialLike,
    b: Option<MaterialLike>,
    speeds: &Bound<'py, PyAny>,
    diameter: Length,
    diameter_b: Option<Length>,
    law: &str,
    constants: &str,
) -> PyResult<Bound<'py, PyDict>> {
    let (pair, law, _) = of_pair(&a, b.as_ref(), (&diameter, diameter_b.as_ref()), law, constants)?;
    let speeds = numbers("speeds", speeds)?;
    if let Some(wrong) = speeds.iter().find(|speed| !(**speed > 0.0 && speed.is_finite())) {
        return Err(Failure::input(format!("speeds: {wrong} must be a positive speed in m/s")).into());
    }
    let found: Vec<_> =
        speeds.iter().map(|&speed| granulens::contact::collide(&law, pair.reduced_mass, speed)).collect();
    let column = |of: fn(&granulens::contact::Collision) -> f64| vector(py, found.iter().map(of).collect());
    Ok(Table::new(py)
        .with("speed_m_s", vector(py, speeds))?
        .with("restitution", column(|c| c.restitution))?
        .with("force_max_N", column(|c| c.force_max))?
        .with("overlap_max_m", column(|c| c.overlap_max))?
        .with("duration_s", column(|c| c.duration))?
        .0)
}

/// The wave-speed bound of a crystal: uniform, or a dimer of two materials.
///
/// Parameters
/// ----------
/// dimension : int
///     1 chain, 2 hexagonal sheet, 3 close packing.
/// amplitude : float, optional
///     Contact force as a multiple of the fully plastic one (from 0.35): then the speed to be expected is given too.
///
/// Returns
/// -------
/// dict
///     speed_m_s, stiffness_N_m, fully_plastic_force_N : float; expected_speed_m_s : float or None
#[pyfunction]
#[pyo3(signature = (a, b = None, *, dimension = 2, diameter = Length::Metres(6.35e-3), constants = "code", amplitude = None))]
pub fn wave_speed<'py>(
    py: Python<'py>,
    a: MaterialLike,
    b: Option<MaterialLike>,
    dimension: u8,
    diameter: Length,
    constants: &str,
    amplitude: Option<f64>,
) -> PyResult<Bound<'py, PyDict>> {
    let first = a.material(&[])?;
    let second = b.map_or_else(|| Ok(first.clone()), |b| b.material(&[]))?;
    let diameter = diameter.metres("diameter")?;
    let constants: Constants = constants.parse().map_err(Failure::from)?;
    let dimension = Dimension::from_number(dimension)
        .ok_or_else(|| Failure::input(format!("dimension = {dimension} must be 1, 2 or 3")))?;
    let bound = wave::bound(dimension, [&first, &second], diameter, constants);
    let expected = match amplitude {
        None => None,
        Some(amplitude) => {
            let pair = Pair::new([&first, &second], [0.5 * diameter; 2], constants);
            let density = 0.5 * (first.density + second.density);
            let part = wave::speed_reached(&pair, density, amplitude).ok_or_else(|| {
                Failure::with_help(
                    format!("amplitude = {amplitude}: contacts stay mostly elastic, and no speed is known"),
                    "Give the contact force as a multiple of F_p, from 0.35.",
                )
            })?;
            Some(part * bound.speed)
        }
    };
    Ok(Table::new(py)
        .with("speed_m_s", bound.speed)?
        .with("stiffness_N_m", bound.stiffness)?
        .with("fully_plastic_force_N", bound.plastic_force)?
        .with("expected_speed_m_s", expected)?
        .0)
}
