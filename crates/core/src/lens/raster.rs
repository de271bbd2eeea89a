//! From a smooth lens to sites: which material each of them holds.

use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::SeedableRng;

use crate::lattice::HexagonalSheet;
use crate::stats::fraction;

/// How sites take their material from a smooth lens.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Raster {
    /// The material at the site's centre; of a mixture the one of the greatest fraction.
    #[default]
    Nearest,
    /// By the area of the site's cell, and what rounding adds or takes is passed on to the sites beside and below (R. W. Floyd
    /// and L. Steinberg 1976), so that areas and mean fractions are kept.
    Diffused,
    /// Drawn at random with the fractions of the site's cell.
    Random,
}

impl Raster {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Nearest, Self::Diffused, Self::Random];

    /// As design files write it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Nearest => "nearest",
            Self::Diffused => "diffused",
            Self::Random => "random",
        }
    }
}

/// Materials for all sites, in the lattice's order, from the `fractions` of the palette in each site's cell.
pub(super) fn raster(lattice: &HexagonalSheet, rule: Raster, seed: u64, fractions: &[Vec<f64>]) -> Vec<u8> {
    match rule {
        Raster::Nearest => fractions.iter().map(|parts| greatest(parts)).collect(),
        Raster::Diffused => diffused(lattice, fractions),
        Raster::Random => {
            let mut generator = Xoshiro256PlusPlus::seed_from_u64(seed);
            fractions.iter().map(|parts| drawn(parts, fraction(&mut generator))).collect()
        }
    }
}

/// The index of the greatest; the last of equal ones, so that a cell half in a lens belongs to it.
pub(super) fn greatest(parts: &[f64]) -> u8 {
    let best = (0..parts.len()).max_by(|&a, &b| parts[a].total_cmp(&parts[b]));
    best.and_then(|k| u8::try_from(k).ok()).unwrap_or(0)
}

pub(super) fn drawn(parts: &[f64], place: f64) -> u8 {
    let mut sum = 0.0;
    let found = parts.iter().position(|part| {
        sum += part;
        place < sum
    });
    found.and_then(|k| u8::try_from(k).ok()).unwrap_or_else(|| greatest(parts))
}

/// Half of what is left goes to the next site of the row, a quarter to each of the two touched below; rows are run through
/// to and fro. Sites of one material are settled and take no part, so that nothing strays from a lens.
fn diffused(lattice: &HexagonalSheet, fractions: &[Vec<f64>]) -> Vec<u8> {
    let mut wanted = fractions.to_vec();
    let mut materials = vec![0; wanted.len()];
    let mixed = |k: usize| fractions[k].iter().all(|part| *part < 1.0 - 1e-9);
    for row in 1..=lattice.rows() {
        let columns: Vec<u32> = match row % 2 {
            0 => (1..=lattice.columns(row)).rev().collect(),
            _ => (1..=lattice.columns(row)).collect(),
        };
        for &column in &columns {
            let Some(here) = lattice.index(row, column) else { continue };
            if !mixed(here) {
                materials[here] = greatest(&fractions[here]);
                continue;
            }
            let chosen = greatest(&wanted[here]);
            materials[here] = chosen;
            let left: Vec<f64> = wanted[here]
                .iter()
                .enumerate()
                .map(|(k, part)| part - if k == usize::from(chosen) { 1.0 } else { 0.0 })
                .collect();
            let next = if row % 2 == 0 { column.checked_sub(1) } else { Some(column + 1) };
            // Odd rows begin on the axis: below column c lie c − 1 and c; below that of an even row c and c + 1.
            let below =
                if row % 2 == 0 { [Some(column), Some(column + 1)] } else { [column.checked_sub(1), Some(column)] };
            let places = [(next.and_then(|c| lattice.index(row, c)), 0.5)]
                .into_iter()
                .chain(below.map(|c| (c.and_then(|c| lattice.index(row + 1, c)), 0.25)))
                .filter_map(|(index, share)| Some((index?, share)))
                .filter(|&(index, _)| mixed(index));
            let places: Vec<(usize, f64)> = places.collect();
            let shares: f64 = places.iter().map(|p| p.1).sum();
            for (index, share) in places {
                for (k, part) in left.iter().enumerate() {
                    wanted[index][k] += part * share / shares;
                }
            }
        }
    }
    materials
}

#[cfg(test)]
mod tests {
    use super::*;

    fn count(materials: &[u8], which: u8) -> f64 {
        materials.iter().filter(|&&m| m == which).count() as f64
    }

    /// A third of one, a half of another and a sixth of the host everywhere: the error that is still on the way at the end
    /// is below one site for each of the last row and column. Drawn at random, within four standard deviations.
    #[test]
    fn mean_fractions_are_kept() {
        let sheet = HexagonalSheet::new(1.0, 40, 20.5).unwrap();
        let parts = [1.0 / 6.0, 1.0 / 3.0, 0.5];
        let fractions = vec![parts.to_vec(); sheet.len()];
        let sites = sheet.len() as f64;
        let laid = raster(&sheet, Raster::Diffused, 0, &fractions);
        let drawn = raster(&sheet, Raster::Random, 5, &fractions);
        for (k, part) in parts.iter().enumerate() {
            assert!((count(&laid, k as u8) - part * sites).abs() < 10.0, "{k} {}", count(&laid, k as u8));
            let deviation = (sites * part * (1.0 - part)).sqrt();
            assert!((count(&drawn, k as u8) - part * sites).abs() < 4.0 * deviation);
        }
        assert_ne!(drawn, raster(&sheet, Raster::Random, 6, &fractions));
        // Diffusion spreads: no row is far from its share, where a coin's would have a standard deviation of 2.2 of 21.
        for row in 3..=40 {
            let start = sheet.index(row, 1).unwrap();
            let here = count(&laid[start..start + 21], 2);
            assert!((here - 10.5).abs() <= 3.5, "{row} {here}");
        }
    }

    #[test]
    fn sites_of_one_material_are_left_alone() {
        let sheet = HexagonalSheet::new(1.0, 6, 4.5).unwrap();
        let fractions: Vec<Vec<f64>> =
            sheet.sites().iter().map(|s| if s.row == 3 { vec![0.4, 0.6] } else { vec![1.0, 0.0] }).collect();
        let laid = raster(&sheet, Raster::Diffused, 0, &fractions);
        for (site, material) in sheet.sites().iter().zip(&laid) {
            assert!(site.row == 3 || *material == 0);
        }
        assert_eq!(count(&laid, 1), 3.0);
    }
}
