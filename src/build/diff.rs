//! What differs between two layouts of one lattice.

use crate::lattice::Site;
use crate::layout::Layout;

/// A site that holds another material.
#[derive(Clone, Debug, PartialEq)]
pub struct Change {
    /// Where, in the simulated half.
    pub site: Site,
    /// Spheres of the piece that it stands for: one on the axis, else two.
    pub spheres: usize,
    /// Material in the first layout.
    pub from: String,
    /// Material in the second.
    pub to: String,
}

/// All changes, in the lattice's order; none where the lattices differ.
pub fn changes(a: &Layout, b: &Layout) -> Option<Vec<Change>> {
    if a.lattice != b.lattice {
        return None;
    }
    let name = |layout: &Layout, k: usize| layout.palette[usize::from(layout.materials[k])].name.clone();
    let sites = a.lattice.sites();
    Some(
        (0..sites.len())
            .map(|k| Change {
                site: sites[k],
                spheres: if sites[k].x > 0.0 { 2 } else { 1 },
                from: name(a, k),
                to: name(b, k),
            })
            .filter(|change| change.from != change.to)
            .collect(),
    )
}
