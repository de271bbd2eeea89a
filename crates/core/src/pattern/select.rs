//! Which spheres are meant.

use crate::lattice::CrystalSite;

/// Spheres by their site and place; all conditions hold together. The default means all spheres.
#[derive(Clone, Debug, PartialEq)]
pub struct Selection<const D: usize> {
    /// First and last layer, from 1.
    pub layers: Option<[u32; 2]>,
    /// First and last column of the layer, from 1.
    pub columns: Option<[u32; 2]>,
    /// Indices of sites, from 0, in increasing order.
    pub sites: Option<Vec<usize>>,
    /// Along each axis, between which places (m) the centre lies.
    pub ranges: [Option<[f64; 2]>; D],
}

impl<const D: usize> Default for Selection<D> {
    fn default() -> Self {
        Self { layers: None, columns: None, sites: None, ranges: [None; D] }
    }
}

/// Room (m) at both ends of a range, so that centres on its edge lie within: lengths in other units are rounded. A picometre
/// is a billionth of a sphere.
const EDGE: f64 = 1e-12;

impl<const D: usize> Selection<D> {
    /// Whether the sphere on a site, the `index`-th of its crystal, is meant; its centre (m) may have moved.
    pub fn holds(&self, index: usize, site: &CrystalSite<D>, centre: &[f64; D]) -> bool {
        let between =
            |range: &Option<[u32; 2]>, at: u32| range.is_none_or(|[first, last]| (first..=last).contains(&at));
        between(&self.layers, site.layer)
            && between(&self.columns, site.column)
            && self.sites.as_ref().is_none_or(|sites| sites.binary_search(&index).is_ok())
            && self
                .ranges
                .iter()
                .zip(centre)
                .all(|(range, x)| range.is_none_or(|[low, high]| (low - EDGE..=high + EDGE).contains(x)))
    }
}
