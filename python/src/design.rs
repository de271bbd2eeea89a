//! Designs, the lenses that they propose, and layouts.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use granulens::evaluate::{self, Overrides, Plan};
use granulens::layout;
use granulens::outcome::Traced;
use granulens::{input, lens, output, report};
use numpy::PyReadonlyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::failure::{Failure, Result};
use crate::material::{Material, MaterialLike};
use crate::values::{Table, Time, nested, vector};

/// What is asked of a run in place of the design's own.
pub fn overrides(step: Option<&Time>, window: Option<&Time>, integrator: Option<&str>) -> Result<Overrides> {
    Ok(Overrides {
        step: step.map(|step| step.seconds("step")).transpose()?,
        window: window.map(|window| window.seconds("window")).transpose()?,
        integrator: integrator.map(str::parse).transpose().map_err(|error: String| Failure::input(error))?,
        first_seed: None,
    })
}

/// A checked design: a crystal, what strikes it, where energy is wanted and where not, and which lens is asked for.
///
/// `Design(path)` reads a file; `Design.parse(text)` a text; `granulens.design(...)` takes arguments.
#[pyclass(frozen, module = "granulens")]
pub struct Design {
    pub inner: Arc<granulens::design::Design>,
}

#[pymethods]
impl Design {
    #[new]
    fn new(path: PathBuf) -> Result<Self> {
        Ok(Self { inner: Arc::new(granulens::design::Design::read(path)?) })
    }

    /// Checks the text of a design file; path is what messages call it.
    #[staticmethod]
    #[pyo3(signature = (text, path = PathBuf::from("design.toml")))]
    fn parse(text: &str, path: PathBuf) -> Result<Self> {
        Ok(Self { inner: Arc::new(granulens::design::Design::parse(path, text)?) })
    }

    /// Name, fit for files and folders.
    #[getter]
    fn name(&self) -> &str {
        &self.inner.name
    }
    /// The file, as it was named.
    #[getter]
    fn path(&self) -> PathBuf {
        self.inner.path.clone()
    }
    /// The text of the design file.
    #[getter]
    fn text(&self) -> &str {
        &self.inner.text
    }
    /// Number of sites of the simulated half.
    #[getter]
    fn sites(&self) -> usize {
        self.inner.lattice.len()
    }
    /// Number of rows.
    #[getter]
    fn rows(&self) -> u32 {
        self.inner.lattice.rows()
    }
    /// Sphere diameter (m).
    #[getter]
    fn diameter_m(&self) -> f64 {
        self.inner.lattice.diameter()
    }
    /// Distance from the axis to the far mirror line (m).
    #[getter]
    fn half_width_m(&self) -> f64 {
        self.inner.lattice.half_width()
    }
    /// The materials that the design names, host first: what the numbers of a layout stand for where no palette is given.
    #[getter]
    fn palette(&self) -> Vec<Material> {
        self.inner.palette().into_iter().map(|inner| Material { inner }).collect()
    }
    /// Contact law, with friction where there is some.
    #[getter]
    fn law(&self) -> String {
        self.inner.law_name()
    }
    /// What strikes the crystal, in words.
    #[getter]
    fn impact(&self) -> String {
        self.inner.impact_in_words()
    }
    /// Force on each sphere of row 1 (N); none where a projectile strikes.
    #[getter]
    #[pyo3(name = "force_N")]
    fn force(&self) -> Option<f64> {
        Some(self.inner.impact.pulse()?.force)
    }
    /// Duration of the pulse (s); none where a projectile strikes.
    #[getter]
    fn duration_s(&self) -> Option<f64> {
        self.inner.impact.duration()
    }
    /// What the user should know about what the file leaves out.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.inner.notes.clone()
    }

    /// The sites of the simulated half, in the order of all layouts, as a table.
    ///
    /// Columns, shape (sites,): row, column (int64); x_m, z_m (float64); focus, protect (bool), whether in a focal or the protected region.
    fn table<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (lattice, target) = (&self.inner.lattice, &self.inner.target);
        let sites = lattice.sites();
        let within = |some: Vec<usize>| {
            let mut mask = vec![false; sites.len()];
            some.into_iter().for_each(|site| mask[site] = true);
            vector(py, mask)
        };
        Ok(Table::new(py)
            .with("row", vector(py, sites.iter().map(|s| i64::from(s.row)).collect()))?
            .with("column", vector(py, sites.iter().map(|s| i64::from(s.column)).collect()))?
            .with("x_m", vector(py, sites.iter().map(|s| s.x).collect()))?
            .with("z_m", vector(py, sites.iter().map(|s| s.z).collect()))?
            .with("focus", within(target.focal_sites(lattice)))?
            .with("protect", within(target.protect.sites(lattice)))?
            .0)
    }

    /// Integrator, step and window that runs of some materials take, each with its reason.
    ///
    /// Returns
    /// -------
    /// dict
    ///     law, constants, integrator : str; step_s, window_s : float; step_reason, window_reason : str; warnings : list of str
    #[pyo3(signature = (materials = None, *, step = None, window = None, integrator = None))]
    fn plan<'py>(
        &self,
        py: Python<'py>,
        materials: Option<Vec<MaterialLike>>,
        step: Option<Time>,
        window: Option<Time>,
        integrator: Option<&str>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let palette = palette(&self.inner, materials)?;
        let plan = Plan::new(&self.inner, overrides(step.as_ref(), window.as_ref(), integrator)?, &palette);
        let plan = plan.map_err(|error| Failure::from(self.inner.blame_plan(&error)))?;
        let told = nested(py, &evaluate::method(&self.inner, &plan))?;
        told.set_item("warnings", plan.warnings)?;
        Ok(told)
    }

    /// The lens that the design asks for, found by rays.
    fn propose(&self) -> Result<Lens> {
        let inner = self.inner.propose()?;
        Ok(Lens { inner, design: self.inner.clone() })
    }

    /// A layout of this design: read from a file, or one material number for each site.
    ///
    /// Parameters
    /// ----------
    /// materials : path, or array of uint8, shape (sites,)
    ///     A layout file; or the number of the material in the palette for each site.
    /// palette : list of Material or str, optional
    ///     What the numbers stand for, host first; the design's own materials where left out.
    #[pyo3(signature = (materials, palette = None))]
    fn layout(&self, materials: &Bound<'_, PyAny>, palette: Option<Vec<MaterialLike>>) -> PyResult<Layout> {
        let palette = self::palette(&self.inner, palette)?;
        if let Ok(array) = materials.extract::<PyReadonlyArray1<'_, u8>>() {
            let materials = array.as_array().to_vec();
            check(&self.inner, &palette, &materials, 0)?;
            let inner = layout::Layout { lattice: self.inner.lattice.clone(), palette, materials };
            return Ok(Layout { inner, design: self.inner.clone() });
        }
        let path: PathBuf = materials.extract().map_err(|_| {
            Failure::input("a layout is a path, or an array of uint8 with a number for each site".to_owned())
        })?;
        let inner =
            layout::read(&path, &self.inner.lattice, &palette, &self.inner.own_materials).map_err(Failure::from)?;
        Ok(Layout { inner, design: self.inner.clone() })
    }

    fn __repr__(&self) -> String {
        let design = &self.inner;
        format!(
            "<Design {}: {} rows, {} sites, {}>",
            design.name,
            design.lattice.rows(),
            design.lattice.len(),
            design.impact_in_words()
        )
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, (String, PathBuf))> {
        let inner = &slf.get().inner;
        let parse = py.get_type::<Self>().getattr("parse")?;
        Ok((parse, (inner.text.clone(), inner.path.clone())))
    }
}

/// The text of a TOML file: another text, with values of a JSON object put into it, section by section; null takes a value out.
#[pyfunction]
pub fn merge_text(text: &str, json: &str) -> Result<String> {
    let mut table: toml::Table = text.parse().map_err(|error: toml::de::Error| Failure::input(error.to_string()))?;
    let values: serde_json::Map<String, serde_json::Value> =
        serde_json::from_str(json).map_err(|error| Failure::input(error.to_string()))?;
    put(&mut table, values)?;
    Ok(table.to_string())
}

fn put(table: &mut toml::Table, values: serde_json::Map<String, serde_json::Value>) -> Result<()> {
    for (key, value) in values {
        match value {
            serde_json::Value::Null => drop(table.remove(&key)),
            serde_json::Value::Object(inner) => {
                let section = table.entry(&key).or_insert_with(|| toml::Table::new().into());
                if !section.is_table() {
                    *section = toml::Table::new().into();
                }
                if let Some(section) = section.as_table_mut() {
                    put(section, inner)?;
                }
            }
            value => {
                let value = toml::Value::try_from(value).map_err(|error| Failure::input(format!("{key}: {error}")))?;
                table.insert(key, value);
            }
        }
    }
    Ok(())
}

/// The palette that is given, or the design's.
pub fn palette<L, R>(
    design: &granulens::design::Design<L, R>,
    given: Option<Vec<MaterialLike>>,
) -> Result<Vec<granulens::material::Material>> {
    let Some(given) = given else { return Ok(design.palette()) };
    let palette = given.iter().map(|material| material.material(&design.own_materials)).collect::<Result<Vec<_>>>()?;
    match palette.first() {
        Some(first) if *first == design.host => Ok(palette),
        _ => Err(Failure::input(format!("palette must begin with the host, {}", design.host.name))),
    }
}

/// Whether a layout is one of the design's, with materials of the palette.
pub fn check(
    design: &granulens::design::Design,
    palette: &[granulens::material::Material],
    materials: &[u8],
    number: usize,
) -> Result<()> {
    numbers_of(design.lattice.len(), palette, materials, number)
}

/// Whether numbers are those of materials of the palette, one for each of so many sites.
pub fn numbers_of(
    sites: usize,
    palette: &[granulens::material::Material],
    materials: &[u8],
    number: usize,
) -> Result<()> {
    if materials.len() != sites {
        return Err(Failure::input(format!(
            "layouts must be an array of uint8 of shape (n, {sites}), a number for each site; this one has {}",
            materials.len()
        )));
    }
    match materials.iter().position(|&material| usize::from(material) >= palette.len()) {
        None => Ok(()),
        Some(site) => Err(Failure::input(format!(
            "layout {number}, site {site}: {} stands for no material; the palette has {}",
            materials[site],
            palette.len()
        ))),
    }
}

/// A lens that a design proposes.
#[pyclass(frozen, module = "granulens")]
pub struct Lens {
    inner: lens::Lens,
    design: Arc<granulens::design::Design>,
}

impl Lens {
    fn traced(&self, rays: usize, interval: Option<&Time>) -> Result<Traced> {
        if !(2..=10_000).contains(&rays) {
            return Err(Failure::input(format!("rays = {rays} must be 2 to 10000")));
        }
        let interval = interval.map(|time| time.seconds("interval")).transpose()?;
        Ok(evaluate::trace_lens(&self.design, &self.inner, rays, interval, None))
    }
}

#[pymethods]
impl Lens {
    /// The proposal, as `granulens design --json` tells it.
    #[getter]
    fn proposal<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        nested(py, &evaluate::proposal(&self.design, &self.inner))
    }

    /// Which material sits on which site.
    #[getter]
    fn layout(&self) -> Layout {
        Layout { inner: self.inner.layout(), design: self.design.clone() }
    }

    /// Rays, wavefronts, caustic, spots and first arrivals, as `granulens trace --json` tells them; no sphere moves.
    ///
    /// Lengths in m, times in s; a ray's points_m have shape (corners, 2), x and z.
    #[pyo3(signature = (rays = 24, *, interval = None))]
    fn rays<'py>(&self, py: Python<'py>, rays: usize, interval: Option<Time>) -> PyResult<Bound<'py, PyAny>> {
        let traced = self.traced(rays, interval.as_ref())?;
        nested(py, &traced)
    }

    /// The picture of `granulens trace`, as SVG.
    #[pyo3(signature = (rays = 24))]
    fn svg(&self, rays: usize) -> Result<String> {
        Ok(report::trace(&self.traced(rays, None)?))
    }

    fn _repr_svg_(&self) -> Result<String> {
        self.svg(24)
    }

    /// Draws rays and layout on a matplotlib axis; gives the axis.
    #[pyo3(signature = (ax = None, *, rays = 24))]
    fn plot<'py>(slf: &Bound<'py, Self>, ax: Option<Bound<'py, PyAny>>, rays: usize) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("granulens._plot")?.call_method1("lens", (slf, ax, rays))
    }

    fn __repr__(&self) -> String {
        let form = &self.inner.prescription;
        format!("<Lens of {}: rows {} to {}>", self.design.name, form.apex_row, form.back_row)
    }
}

/// A material for every site of a design's crystal.
#[pyclass(frozen, module = "granulens")]
#[derive(Clone)]
pub struct Layout {
    pub inner: layout::Layout,
    pub design: Arc<granulens::design::Design>,
}

#[pymethods]
impl Layout {
    /// The number of the material in the palette for each site: uint8, shape (sites,).
    #[getter]
    fn materials<'py>(&self, py: Python<'py>) -> Bound<'py, PyAny> {
        vector(py, self.inner.materials.clone())
    }

    /// What the numbers stand for, host first.
    #[getter]
    fn palette(&self) -> Vec<Material> {
        self.inner.palette.iter().map(|inner| Material { inner: inner.clone() }).collect()
    }

    /// Name of the design.
    #[getter]
    fn design(&self) -> Design {
        Design { inner: self.design.clone() }
    }

    /// Counts, mass and cost of the piece to be built and of the simulated half.
    #[getter]
    fn bill<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let price = |material: &granulens::material::Material| self.design.price(material);
        Ok(Table::new(py)
            .with("materials", self.inner.palette.iter().map(|m| m.name.as_str()).collect::<Vec<_>>())?
            .with("piece", nested(py, &self.inner.piece(price))?)?
            .with("half", nested(py, &self.inner.half(price))?)?
            .0)
    }

    /// The spheres of the piece to be built, both halves, as a table.
    ///
    /// Columns, shape (spheres,): row, column (int64); x_m, z_m (float64); material (uint8); site (int64), the site of the half.
    fn piece<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let whole = layout::whole(&self.inner);
        Ok(Table::new(py)
            .with("row", vector(py, whole.iter().map(|s| i64::from(s.row)).collect()))?
            .with("column", vector(py, whole.iter().map(|s| i64::from(s.column)).collect()))?
            .with("x_m", vector(py, whole.iter().map(|s| s.x).collect()))?
            .with("z_m", vector(py, whole.iter().map(|s| s.z).collect()))?
            .with("material", vector(py, whole.iter().map(|s| s.material).collect::<Vec<u8>>()))?
            .with("site", vector(py, whole.iter().map(|s| s.site as i64).collect()))?
            .0)
    }

    /// The layout as the text of a CSV file; of the whole piece with full.
    #[pyo3(signature = (full = false))]
    fn csv(&self, full: bool) -> String {
        if full { layout::write_full(&self.inner) } else { layout::write(&self.inner) }
    }

    /// Writes the layout as CSV. A file that granulens did not write, or that was changed since, is replaced with force only.
    #[pyo3(signature = (path, *, force = false, full = false))]
    fn write(&self, path: PathBuf, force: bool, full: bool) -> Result<()> {
        // Each call is a command of its own.
        input::forget();
        Ok(output::write(Path::new(&path), self.csv(full).as_bytes(), force)?)
    }

    /// First arrivals by the eikonal equation on the lattice, as `granulens trace DESIGN LAYOUT --json` tells them.
    fn arrivals<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        nested(py, &evaluate::trace_arrivals(&self.design, &self.inner, None, None))
    }

    /// The crystal with first arrivals, as SVG.
    fn svg(&self) -> String {
        report::trace(&evaluate::trace_arrivals(&self.design, &self.inner, None, None))
    }

    fn _repr_svg_(&self) -> String {
        self.svg()
    }

    /// Draws the half crystal on a matplotlib axis, by material, or by a value for each site; gives the axis.
    #[pyo3(signature = (ax = None, *, values = None, label = ""))]
    fn plot<'py>(
        slf: &Bound<'py, Self>,
        ax: Option<Bound<'py, PyAny>>,
        values: Option<Bound<'py, PyAny>>,
        label: &str,
    ) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("granulens._plot")?.call_method1("layout", (slf, ax, values, label))
    }

    fn __repr__(&self) -> String {
        let some: Vec<String> = self
            .inner
            .palette
            .iter()
            .enumerate()
            .map(|(k, material)| format!("{} {}", self.inner.count(k as u8), material.name))
            .collect();
        format!("<Layout of {}: {}>", self.design.name, some.join(", "))
    }
}
