//! Crystals of any structure and size, by layers across the wave.

use super::Cell;

/// One site of a crystal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CrystalSite<const D: usize> {
    /// Layer, from 1 (struck) on.
    pub layer: u32,
    /// Place within the layer, from 1 on, in order of y, then x.
    pub column: u32,
    /// Centre (m); the last axis is depth, 0 in layer 1.
    pub centre: [f64; D],
}

/// How far a crystal reaches along an axis across the wave.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Width {
    /// So many unit cells, after which it may repeat itself: centres from 0 to, but not including, the period.
    Cells(u32),
    /// Centres from the first to the second place, both included, in diameters.
    Between(f64, f64),
}

/// Which sites across the wave there are, beyond the widths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outline {
    /// All.
    All,
    /// Those whose centres lie in a regular hexagon of this circumradius (in diameters) about x = y = 0, corners along x.
    Hexagon(f64),
    /// Those whose centres lie within this distance (in diameters) of x = y = 0.
    Disk(f64),
}

/// Why a crystal cannot be laid.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CrystalError {
    /// The sphere diameter is not a positive number.
    #[error("diameter {0} m must be positive")]
    Diameter(f64),
    /// No layers, or more than the indices hold.
    #[error("{0} layers: a crystal has 1 to 1000000 of them")]
    Layers(u32),
    /// One width for each axis across the wave.
    #[error("{0} widths are given, a crystal of this kind has {1}")]
    Widths(usize, usize),
    /// A width that holds nothing or is not finite.
    #[error("the width along {axis} must be one or more cells, or reach from a lower to a higher place")]
    Width {
        /// x or y
        axis: char,
    },
    /// Nothing lies within.
    #[error("layer {0} holds no site")]
    Empty(u32),
    /// More sites than can be simulated.
    #[error("more than {} million sites", MOST_SITES / 1_000_000)]
    Large,
}

/// Above this a crystal would not fit into the memory of an ordinary computer.
const MOST_SITES: usize = 10_000_000;

/// Sites beyond an edge by less than this (in diameters) lie on it: widths in other units are rounded.
const EDGE: f64 = 1e-9;

/// A chain, a sheet or a crystal in space: sites one diameter apart, in layers across the wave.
///
/// ```
/// use granulens_core::lattice::{Cell, Crystal, Outline, Width};
/// // Fifteen rows of 18 and 17 spheres by turns (Burgoyne 2016, section 2.2.3).
/// let cell = Cell::<2>::named("hexagonal").unwrap();
/// let sheet = Crystal::new(cell, 6.35e-3, 15, &[Width::Between(0.0, 17.0)], Outline::All).unwrap();
/// assert_eq!(sheet.sites().len(), 263);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Crystal<const D: usize> {
    cell: Cell<D>,
    diameter: f64,
    layers: u32,
    periods: [Option<f64>; D],
    sites: Vec<CrystalSite<D>>,
}

impl<const D: usize> Crystal<D> {
    /// Lays a crystal of spheres of `diameter` (m): `layers` deep, with a width for each axis across the wave.
    ///
    /// # Errors
    /// See [`CrystalError`].
    pub fn new(
        cell: Cell<D>,
        diameter: f64,
        layers: u32,
        widths: &[Width],
        outline: Outline,
    ) -> Result<Self, CrystalError> {
        if !(diameter.is_finite() && diameter > 0.0) {
            return Err(CrystalError::Diameter(diameter));
        }
        if !(1..=1_000_000).contains(&layers) {
            return Err(CrystalError::Layers(layers));
        }
        if widths.len() != D - 1 {
            return Err(CrystalError::Widths(widths.len(), D - 1));
        }
        let mut cells = Vec::new();
        let mut expected = f64::from(layers);
        for (width, (edge, axis)) in widths.iter().zip(cell.edges().into_iter().zip(['x', 'y'])) {
            let range = match *width {
                Width::Cells(count) if count > 0 => 0..i64::from(count),
                Width::Between(low, high) if low <= high && low.abs() < 1e9 && high.abs() < 1e9 => {
                    (low / edge).floor() as i64 - 1..(high / edge).ceil() as i64 + 1
                }
                _ => return Err(CrystalError::Width { axis }),
            };
            expected *= (range.end - range.start) as f64;
            cells.push(range);
        }
        if expected > MOST_SITES as f64 {
            return Err(CrystalError::Large);
        }

        let mut sites = Vec::new();
        for layer in 0..layers {
            let first = sites.len();
            for basis in cell.layer(layer) {
                across(&cells, &mut |at| {
                    let mut place = [0.0; D];
                    for (k, &n) in at.iter().enumerate() {
                        place[k] = (12 * n + i64::from(basis[k])) as f64 * cell.edges()[k] / 12.0;
                    }
                    if within(&place, widths) && encloses(outline, &place) {
                        let mut centre = place.map(|x| x * diameter);
                        centre[D - 1] = f64::from(layer) * (cell.layer_spacing() * diameter);
                        sites.push(CrystalSite { layer: layer + 1, column: 0, centre });
                    }
                });
            }
            let row = &mut sites[first..];
            if row.is_empty() {
                return Err(CrystalError::Empty(layer + 1));
            }
            let order = |site: &CrystalSite<D>| std::array::from_fn::<f64, D, _>(|k| site.centre[D - 1 - k]);
            row.sort_by(|a, b| order(a).partial_cmp(&order(b)).unwrap_or(std::cmp::Ordering::Equal));
            row.iter_mut().zip(1..).for_each(|(site, column)| site.column = column);
        }
        let mut periods = [None; D];
        for (k, width) in widths.iter().enumerate() {
            if let Width::Cells(count) = width {
                periods[k] = Some(f64::from(*count) * cell.edges()[k] * diameter);
            }
        }
        Ok(Self { cell, diameter, layers, periods, sites })
    }

    /// Structure and orientation.
    pub fn cell(&self) -> Cell<D> {
        self.cell
    }

    /// Sphere diameter, the distance of nearest neighbours (m).
    pub fn diameter(&self) -> f64 {
        self.diameter
    }

    /// Number of layers.
    pub fn layers(&self) -> u32 {
        self.layers
    }

    /// Distance between layers (m).
    pub fn layer_spacing(&self) -> f64 {
        self.cell.layer_spacing() * self.diameter
    }

    /// Along each axis, the distance (m) after which the crystal goes on like itself, where its width is given in cells.
    pub fn periods(&self) -> [Option<f64>; D] {
        self.periods
    }

    /// All sites, layer by layer. Indices elsewhere count in this order.
    pub fn sites(&self) -> &[CrystalSite<D>] {
        &self.sites
    }
}

/// Visits every cell across the wave.
fn across(cells: &[std::ops::Range<i64>], visit: &mut impl FnMut(&[i64])) {
    match cells {
        [] => visit(&[]),
        [x] => x.clone().for_each(|n| visit(&[n])),
        [x, y, ..] => y.clone().for_each(|m| x.clone().for_each(|n| visit(&[n, m]))),
    }
}

fn within<const D: usize>(place: &[f64; D], widths: &[Width]) -> bool {
    widths.iter().zip(place).all(|(width, x)| match *width {
        Width::Cells(_) => true,
        Width::Between(low, high) => (low - EDGE..=high + EDGE).contains(x),
    })
}

/// Whether a place (in diameters) is within it.
pub(super) fn encloses<const D: usize>(outline: Outline, place: &[f64; D]) -> bool {
    let x = if D > 1 { place[0] } else { 0.0 };
    let y = if D > 2 { place[1] } else { 0.0 };
    match outline {
        Outline::All => true,
        Outline::Hexagon(radius) => hexagonal_distance(x, y) <= radius + EDGE,
        Outline::Disk(radius) => x.hypot(y) <= radius + EDGE,
    }
}

/// Circumradius of the regular hexagon about the origin, corners along x, that passes through a point.
pub fn hexagonal_distance(x: f64, y: f64) -> f64 {
    let half = 0.75_f64.sqrt();
    // Distances along the normals of its three pairs of edges, over that of an edge from the middle.
    [y, half * x + 0.5 * y, half * x - 0.5 * y].into_iter().map(f64::abs).fold(0.0, f64::max) / half
}
