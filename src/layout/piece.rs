//! The whole piece of a layout: the simulated half and its mirror image about the axis.

use super::Layout;

/// A sphere of the piece to be built.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PieceSphere {
    /// Row, from 1 (struck) on.
    pub row: u32,
    /// Column of the whole row, from 1 on in order of x.
    pub column: u32,
    /// From the axis (m), on both sides of it.
    pub x: f64,
    /// Depth below row 1 (m).
    pub z: f64,
    /// Index into the layout's palette.
    pub material: u8,
    /// Index of the site of the simulated half that it stands for.
    pub site: usize,
}

/// All spheres of the piece, row by row from left to right. A sphere on the axis is one sphere; one on the far mirror line is two,
/// one at each rim.
pub fn whole(layout: &Layout) -> Vec<PieceSphere> {
    let sites = layout.lattice.sites();
    let mut spheres = Vec::with_capacity(2 * sites.len());
    let mut begin = 0;
    for row in 1..=layout.lattice.rows() {
        let end = begin + layout.lattice.columns(row) as usize;
        let right = begin..end;
        let left = right.clone().rev().filter(|&site| sites[site].x > 0.0).map(|site| (site, -sites[site].x));
        let whole = left.chain(right.map(|site| (site, sites[site].x)));
        spheres.extend((1..).zip(whole).map(|(column, (site, x))| PieceSphere {
            row,
            column,
            x,
            z: sites[site].z,
            material: layout.materials[site],
            site,
        }));
        begin = end;
    }
    spheres
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::HexagonalSheet;
    use crate::material;

    /// Half width 2.5 D: odd rows at 0, 1, 2 are five spheres of the piece, even rows at 0.5, 1.5, 2.5 six, with one at each rim;
    /// half width 2 D: odd rows 0, 1, 2 are five, even rows 0.5, 1.5 four.
    #[test]
    fn the_axis_is_one_sphere_and_the_rim_two() {
        for (half_width, expected) in [(2.5, [5, 6]), (2.0, [5, 4])] {
            let lattice = HexagonalSheet::new(1e-2, 4, half_width).unwrap();
            let layout = Layout::new(lattice.clone(), vec![material::find("440c", &[]).unwrap()], |_| 0);
            let spheres = whole(&layout);
            for row in 1..=4 {
                let xs: Vec<f64> = spheres.iter().filter(|s| s.row == row).map(|s| s.x / 1e-2).collect();
                assert_eq!(xs.len(), expected[(row as usize + 1) % 2], "row {row} of half width {half_width}");
                assert!(xs.windows(2).all(|pair| (pair[1] - pair[0] - 1.0).abs() < 1e-12), "{xs:?}");
                assert!((xs[0] + xs[xs.len() - 1]).abs() < 1e-12);
            }
            assert!(spheres.iter().all(|s| (s.x.abs() - lattice.sites()[s.site].x).abs() < 1e-15));
        }
    }
}
