//! Designs of crystals in space, and their layouts: what studies of them are about and find.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use granulens::design::SpaceDesign as Inner;
use granulens::lattice::{Block, Layered};
use granulens::layout;
use granulens::{input, output};
use numpy::PyReadonlyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::design::{numbers_of, palette};
use crate::failure::{Failure, Result};
use crate::material::{Material, MaterialLike};
use crate::values::{Table, nested, vector};

/// A checked design of a crystal in space: `crystal.packing = "hcp"` or `"fcc-111"`.
///
/// `SpaceDesign(path)` reads a file; `SpaceDesign.parse(text)` a text.
#[pyclass(frozen, module = "granulens")]
pub struct SpaceDesign {
    pub inner: Arc<Inner>,
}

#[pymethods]
impl SpaceDesign {
    #[new]
    fn new(path: PathBuf) -> Result<Self> {
        match granulens::design::AnyDesign::read(&path)? {
            granulens::design::AnyDesign::Space(design) => Ok(Self { inner: Arc::new(*design) }),
            granulens::design::AnyDesign::Plane(_) => Err(Failure::with_help(
                format!("{}: crystal.packing is that of a sheet", path.display()),
                "Read it with granulens.Design.",
            )),
        }
    }

    /// Checks the text of a design file; path is what messages call it.
    #[staticmethod]
    #[pyo3(signature = (text, path = PathBuf::from("design.toml")))]
    fn parse(text: &str, path: PathBuf) -> Result<Self> {
        Ok(Self { inner: Arc::new(Inner::parse_in_space(path, text)?) })
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
        self.inner.lattice.sites().len()
    }
    /// Number of layers.
    #[getter]
    fn layers(&self) -> u32 {
        self.inner.lattice.layers()
    }
    /// Sphere diameter (m).
    #[getter]
    fn diameter_m(&self) -> f64 {
        self.inner.lattice.diameter()
    }
    /// The materials that the design names, host first: what the numbers of a layout stand for where no palette is given.
    #[getter]
    fn palette(&self) -> Vec<Material> {
        self.inner.palette().into_iter().map(|inner| Material { inner }).collect()
    }
    /// Contact law.
    #[getter]
    fn law(&self) -> String {
        self.inner.law_name()
    }
    /// What strikes the crystal, in words.
    #[getter]
    fn impact(&self) -> String {
        self.inner.impact_in_words()
    }
    /// What the user should know about what the file leaves out.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.inner.notes.clone()
    }

    /// The sites of the simulated half, x >= 0, in the order of all layouts, as a table.
    ///
    /// Columns, shape (sites,): layer, column (int64); x_m, y_m, z_m (float64), from the axis and from layer 1; copies (uint8), the spheres of
    /// the whole crystal that a site stands for; focus, protect (bool), whether in a focal or the protected region.
    fn table<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let block = &self.inner.lattice;
        let within = self.inner.target.on(block);
        let mask = |some: Vec<usize>| {
            let mut mask = vec![false; block.sites().len()];
            some.into_iter().for_each(|site| mask[site] = true);
            vector(py, mask)
        };
        let along = |axis: usize| vector(py, block.sites().iter().map(|site| site.centre[axis]).collect());
        Ok(Table::new(py)
            .with("layer", vector(py, block.sites().iter().map(|site| i64::from(site.layer)).collect()))?
            .with("column", vector(py, block.sites().iter().map(|site| i64::from(site.column)).collect()))?
            .with("x_m", along(0))?
            .with("y_m", along(1))?
            .with("z_m", along(2))?
            .with("copies", vector(py, block.copies().to_vec()))?
            .with("focus", mask(within.focal))?
            .with("protect", mask(within.protected))?
            .0)
    }

    /// The layout of the lens that the design asks for, found by rays.
    fn propose(&self) -> Result<SpaceLayout> {
        let (_, materials) = self.inner.propose_in_space()?;
        let lens = self.inner.lens.as_ref().ok_or_else(|| Failure::input("the design asks for no lens"))?;
        Ok(SpaceLayout::of(&self.inner, self.inner.palette_of_lens(lens), materials))
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
    fn layout(&self, materials: &Bound<'_, PyAny>, palette: Option<Vec<MaterialLike>>) -> PyResult<SpaceLayout> {
        let palette = self::palette(&self.inner, palette)?;
        if let Ok(array) = materials.extract::<PyReadonlyArray1<'_, u8>>() {
            let materials = array.as_array().to_vec();
            numbers_of(self.sites(), &palette, &materials, 0)?;
            return Ok(SpaceLayout::of(&self.inner, palette, materials));
        }
        let path: PathBuf = materials.extract().map_err(|_| {
            Failure::input("a layout is a path, or an array of uint8 with a number for each site".to_owned())
        })?;
        let inner = layout::read_in_space(&path, &self.inner.lattice, &palette, &self.inner.own_materials)
            .map_err(Failure::from)?;
        Ok(SpaceLayout { inner, design: self.inner.clone() })
    }

    fn __repr__(&self) -> String {
        let (design, block) = (&self.inner, &self.inner.lattice);
        format!(
            "<SpaceDesign {}: {}, {} layers, {} spheres, {}>",
            design.name,
            block.cell().name(),
            block.layers(),
            block.spheres(),
            design.impact_in_words()
        )
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, (String, PathBuf))> {
        let inner = &slf.get().inner;
        let parse = py.get_type::<Self>().getattr("parse")?;
        Ok((parse, (inner.text.clone(), inner.path.clone())))
    }
}

/// A material for every site of a crystal in space.
#[pyclass(frozen, module = "granulens")]
#[derive(Clone)]
pub struct SpaceLayout {
    inner: layout::Layout<Block>,
    design: Arc<Inner>,
}

impl SpaceLayout {
    pub fn of(design: &Arc<Inner>, palette: Vec<granulens::material::Material>, materials: Vec<u8>) -> Self {
        Self { inner: layout::Layout { lattice: design.lattice.clone(), palette, materials }, design: design.clone() }
    }
}

#[pymethods]
impl SpaceLayout {
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

    /// Its design.
    #[getter]
    fn design(&self) -> SpaceDesign {
        SpaceDesign { inner: self.design.clone() }
    }

    /// Counts, mass and cost of the piece to be built.
    #[getter]
    fn bill<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let piece = self.inner.piece_in_space(|material| self.design.price(material));
        Ok(Table::new(py)
            .with("materials", self.inner.palette.iter().map(|m| m.name.as_str()).collect::<Vec<_>>())?
            .with("piece", nested(py, &piece)?)?
            .0)
    }

    /// The layout as the text of a CSV file: the half x >= 0, or every sphere of the crystal with full.
    #[pyo3(signature = (full = false))]
    fn csv(&self, full: bool) -> String {
        if full { layout::write_whole_in_space(&self.inner) } else { layout::write_in_space(&self.inner) }
    }

    /// Writes the layout as CSV. A file that granulens did not write, or that was changed since, is replaced with force only.
    #[pyo3(signature = (path, *, force = false, full = false))]
    fn write(&self, path: PathBuf, force: bool, full: bool) -> Result<()> {
        // Each call is a command of its own.
        input::forget();
        Ok(output::write(Path::new(&path), self.csv(full).as_bytes(), force)?)
    }

    fn __repr__(&self) -> String {
        let count = |k: usize| self.inner.materials.iter().filter(|&&material| usize::from(material) == k).count();
        let named = self.inner.palette.iter().enumerate();
        let some: Vec<String> = named.map(|(k, material)| format!("{} {}", count(k), material.name)).collect();
        format!("<SpaceLayout of {}: {}>", self.design.name, some.join(", "))
    }
}
