//! What differs between two layouts of one lattice.

use crate::evaluate::Subject;
use crate::lattice::Site;

/// A site that holds another material.
#[derive(Clone, Debug, PartialEq)]
pub struct Change {
    /// Where, in the simulated half or, at negative x, at the image of a site of it.
    pub site: Site,
    /// Spheres of the piece that it stands for: one on the axis, else two.
    pub spheres: usize,
    /// Material in the first layout.
    pub from: String,
    /// Material in the second.
    pub to: String,
}

/// All changes, in the lattice's order; none where the lattices differ. Where the halves of one of the two differ every sphere is told for
/// itself, those left of the axis, at negative x with the column of their image, behind the others.
pub fn changes(a: Subject<'_>, b: Subject<'_>) -> Option<Vec<Change>> {
    if a.layout.lattice != b.layout.lattice {
        return None;
    }
    let drawn = [a.drawn(), b.drawn()];
    let halves_differ = a.left.is_some() || b.left.is_some();
    let sites = a.layout.lattice.sites();
    let name = |which: usize, k: usize| {
        let (layout, drawn) = ([a, b][which].layout, &drawn[which]);
        layout.palette[usize::from(drawn[k % drawn.len()])].name.clone()
    };
    let images = (sites.len()..2 * sites.len()).filter(|k| halves_differ && sites[k % sites.len()].x > 0.0);
    Some(
        (0..sites.len())
            .chain(images)
            .map(|k| {
                let mut site = sites[k % sites.len()];
                if k >= sites.len() {
                    site.x = -site.x;
                }
                let spheres = if site.x > 0.0 && !halves_differ { 2 } else { 1 };
                Change { site, spheres, from: name(0, k), to: name(1, k) }
            })
            .filter(|change| change.from != change.to)
            .collect(),
    )
}
