//! Which law holds at which contact: a table with one entry per kind of pair.

use super::contacts::Laws;
use super::neighbour::Touching;
use crate::contact::{Constants, ForceLaw, Pair};
use crate::sample::Sample;

/// One law per kind of pair, and for each contact its kind.
pub(super) struct LawTable<L> {
    kinds: Vec<L>,
    kind: Vec<u16>,
}

impl<L: ForceLaw<f64> + Copy + Sync> Laws<f64> for LawTable<L> {
    type Law = L;
    #[inline(always)]
    fn of(&self, contact: usize) -> L {
        self.kinds[usize::from(self.kind[contact])]
    }
}

impl<L> LawTable<L> {
    /// Makes a law for every pair of materials and radii that touches: pairs, then images.
    pub fn new<const D: usize>(
        sample: &Sample<D>,
        touching: &Touching<D>,
        constants: Constants,
        make: impl Fn(&Pair) -> L,
    ) -> Self {
        let mut seen: Vec<[(usize, f64); 2]> = Vec::new();
        let mut kinds = Vec::new();
        let ends = |i: usize| (sample.spheres[i].material, sample.spheres[i].radius);
        let pairs = touching.pairs.iter().map(|touch| touch.pair);
        let images = touching.images.iter().map(|touch| [touch.sphere; 2]);
        let kind = pairs
            .chain(images)
            .map(|[a, b]| {
                let mut key = [ends(a), ends(b)];
                key.sort_by(|x, y| x.0.cmp(&y.0).then(x.1.total_cmp(&y.1)));
                let place = seen.iter().position(|known| *known == key).unwrap_or_else(|| {
                    let materials = key.map(|(material, _)| &sample.materials[material]);
                    seen.push(key);
                    kinds.push(make(&Pair::new(materials, key.map(|(_, radius)| radius), constants)));
                    kinds.len() - 1
                });
                place as u16
            })
            .collect();
        Self { kinds, kind }
    }
}
