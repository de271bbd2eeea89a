//! The wave speed at each site of a layout.

use std::collections::HashMap;

use super::{Decay, Dimension, mixture_speed};
use crate::contact::Constants;
use crate::lattice::Site;
use crate::layout::Layout;

/// Wave speed (m/s) at each site, in the lattice's order: that of a random mixture of what the site and its neighbours are made of,
/// since a wave is several spheres long and cannot tell single ones apart.
///
/// With `decays`, one for each material of the palette, the speed is that of a wave that decays: a mixture with parts pₖ takes
/// Σ pₖ/rₖ of the time that it takes by the bound, rₖ the part of the bound that the uniform crystal of material k reaches in the
/// site's row.
pub fn site_speeds(layout: &Layout, constants: Constants, decays: Option<&[Decay]>) -> Vec<f64> {
    let lattice = &layout.lattice;
    let kinds = layout.palette.len();
    // Few mixtures occur, and each takes some microseconds.
    let mut known: HashMap<Vec<u32>, f64> = HashMap::new();
    let mut bound = |parts: &[f64], counts: Vec<u32>| -> f64 {
        *known.entry(counts).or_insert_with(|| {
            let parts: Vec<_> = layout.palette.iter().zip(parts.iter().copied()).collect();
            mixture_speed(Dimension::Two, &parts, lattice.diameter(), constants)
        })
    };
    let neighbourhood = |site: &Site| {
        let (row, column) = (i64::from(site.row), i64::from(site.column));
        // Odd rows begin on the axis, even ones half a diameter off it.
        let left = if site.row.is_multiple_of(2) { 0 } else { -1 };
        let around = [(0, 0), (0, -1), (0, 1), (-1, left), (-1, left + 1), (1, left), (1, left + 1)];
        let mut counts = vec![0; kinds];
        for (down, across) in around {
            let place = u32::try_from(row + down).ok().zip(u32::try_from(column + across).ok());
            if let Some(index) = place.and_then(|(row, column)| lattice.index(row, column)) {
                counts[usize::from(layout.materials[index])] += 1;
            }
        }
        counts
    };
    let speed = |site: &Site| {
        let counts = neighbourhood(site);
        let whole = f64::from(counts.iter().sum::<u32>());
        let parts: Vec<f64> = counts.iter().map(|&count| f64::from(count) / whole).collect();
        let slower = decays.map_or(1.0, |decays| {
            decays.iter().zip(&parts).map(|(decay, part)| part / decay.reached(site.row)).sum::<f64>()
        });
        bound(&parts, counts) / slower
    };
    lattice.sites().iter().map(speed).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::HexagonalSheet;
    use crate::material::find;
    use crate::wave::{RowPassage, bound};

    /// Away from the other material a site has its own bound; a row next to it is a mixture, slower than the host's and faster
    /// than the lens's. A decay of r makes every site r times as fast.
    #[test]
    fn a_site_runs_as_its_neighbourhood_does() {
        let palette = ["440c", "brass"].map(|name| find(name, &[]).unwrap());
        let sheet = HexagonalSheet::new(6.35e-3, 12, 4.0).unwrap();
        let layout = Layout::new(sheet.clone(), palette.to_vec(), |site| u8::from(site.row > 6));
        let speeds = site_speeds(&layout, Constants::Code, None);
        let own = palette.each_ref().map(|m| bound(Dimension::Two, [m, m], 6.35e-3, Constants::Code).speed);
        for (site, speed) in sheet.sites().iter().zip(&speeds) {
            match site.row {
                ..=5 => assert!((speed / own[0] - 1.0).abs() < 1e-12),
                6 | 7 => assert!((own[1]..own[0]).contains(speed)),
                _ => assert!((speed / own[1] - 1.0).abs() < 1e-12),
            }
        }
        let decay = |reached: f64| {
            let rows = [0.0, 1.0].map(|depth| RowPassage { depth, arrival: depth / reached, force: 1.0 });
            Decay::measured(1.0, &rows).unwrap()
        };
        let slower = site_speeds(&layout, Constants::Code, Some(&[decay(0.8), decay(0.8)]));
        assert!(slower.iter().zip(&speeds).all(|(a, b)| (a / b - 0.8).abs() < 1e-12));
        let one = site_speeds(&layout, Constants::Code, Some(&[decay(0.5), decay(1.0)]));
        assert!((one[0] / own[0] - 0.5).abs() < 1e-12 && (one[one.len() - 1] / own[1] - 1.0).abs() < 1e-12);
    }
}
