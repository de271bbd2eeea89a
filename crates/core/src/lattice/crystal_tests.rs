use std::f64::consts::{PI, SQRT_2};

use super::*;

/// A piece without edges: periodic across, and only its middle layers are looked at.
fn bulk<const D: usize>(cell: Cell<D>) -> Crystal<D> {
    let layers = 6 * cell.layers();
    Crystal::new(cell, 1.0, layers, &[Width::Cells(6), Width::Cells(6)][..D - 1], Outline::All).unwrap()
}

/// Distances up to 1.8 diameters from one site in the middle layer, each with how many neighbours lie so far.
fn shells<const D: usize>(crystal: &Crystal<D>) -> Vec<(f64, usize)> {
    let middle = crystal.sites().iter().find(|site| site.layer == crystal.layers() / 2).unwrap().centre;
    let apart = |site: &CrystalSite<D>| {
        let square = |k: usize| {
            let mut x = site.centre[k] - middle[k];
            if let Some(period) = crystal.periods()[k] {
                x -= (x / period).round() * period;
            }
            x * x
        };
        (0..D).map(square).sum::<f64>().sqrt()
    };
    let mut distances: Vec<f64> = crystal.sites().iter().map(apart).filter(|d| (1e-9..1.8).contains(d)).collect();
    distances.sort_by(f64::total_cmp);
    distances.chunk_by(|a, b| b - a < 1e-9).map(|same| (same[0], same.len())).collect()
}

#[track_caller]
fn has_shells<const D: usize>(cell: Cell<D>, expected: &[(f64, usize)]) {
    let found = shells(&bulk(cell));
    assert_eq!(found.len(), expected.len(), "{}: {found:?}", cell.name());
    for (found, expected) in found.iter().zip(expected) {
        assert!((found.0 - expected.0).abs() < 1e-12 && found.1 == expected.1, "{}: {found:?}", cell.name());
    }
}

/// Neighbour shells are those of the textbooks, whatever way the layers lie: so every orientation is the same crystal.
/// HCP differs from FCC in its shells at √(8/3) and √3.
#[test]
fn every_orientation_is_its_crystal() {
    has_shells(Cell::<1>::named("chain").unwrap(), &[(1.0, 2)]);
    for name in ["square", "square-diagonal"] {
        has_shells(Cell::<2>::named(name).unwrap(), &[(1.0, 4), (SQRT_2, 4)]);
    }
    for name in ["hexagonal", "hexagonal-along"] {
        has_shells(Cell::<2>::named(name).unwrap(), &[(1.0, 6), (3_f64.sqrt(), 6)]);
    }
    for name in ["fcc-001", "fcc-110", "fcc-111"] {
        has_shells(Cell::<3>::named(name).unwrap(), &[(1.0, 12), (SQRT_2, 6), (3_f64.sqrt(), 24)]);
    }
    let shells = [(1.0, 12), (SQRT_2, 6), ((8.0 / 3.0_f64).sqrt(), 2), (3_f64.sqrt(), 18)];
    has_shells(Cell::<3>::named("hcp").unwrap(), &shells);
    let edge = 2.0 / 3_f64.sqrt();
    for name in ["bcc-001", "bcc-110"] {
        has_shells(Cell::<3>::named(name).unwrap(), &[(1.0, 8), (edge, 6), (SQRT_2 * edge, 12)]);
    }
}

/// Closed forms: π/4, π/(2√3), π/(3√2), π√3/8.
#[test]
fn packing_fractions_are_the_closed_forms() {
    let close = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-15, "{found} {expected}");
    close(Cell::<1>::ALL[0].packing_fraction(), 1.0);
    for cell in Cell::<2>::ALL {
        let square = cell.name().starts_with("square");
        close(cell.packing_fraction(), if square { PI / 4.0 } else { PI / 12_f64.sqrt() });
    }
    for cell in Cell::<3>::ALL {
        let body = cell.name().starts_with("bcc");
        close(cell.packing_fraction(), if body { PI * 3_f64.sqrt() / 8.0 } else { PI / 18_f64.sqrt() });
    }
}

/// The density of what is laid, by its period and the spacing of its layers, is that of the cell.
#[test]
fn a_periodic_crystal_has_the_density_of_its_cell() {
    for &cell in Cell::<3>::ALL {
        let crystal = bulk(cell);
        let area = crystal.periods()[0].unwrap() * crystal.periods()[1].unwrap();
        let volume = area * crystal.layer_spacing() * f64::from(crystal.layers());
        let filled = crystal.sites().len() as f64 * PI / 6.0 / volume;
        assert!((filled - cell.packing_fraction()).abs() < 1e-12, "{}", cell.name());
    }
}

/// The half crystal of the lens problem, to the bit.
#[test]
fn a_hexagonal_crystal_is_the_hexagonal_sheet() {
    let sheet = HexagonalSheet::new(6.35e-3, 50, 16.5).unwrap();
    let cell = Cell::<2>::named("hexagonal").unwrap();
    let crystal = Crystal::new(cell, 6.35e-3, 50, &[Width::Between(0.0, 16.5)], Outline::All).unwrap();
    let places: Vec<[f64; 2]> = sheet.sites().iter().map(|site| [site.x, site.z]).collect();
    assert!(crystal.sites().iter().map(|site| site.centre).eq(places));
}

/// A hexagon 2n + 1 spheres across holds 3 n (n + 1) + 1 of a close-packed layer. On a triangular hollow of it the layer
/// behind holds, of the hexagon about the first layer's middle, 3 n² (counted by hand for n = 1: three spheres).
#[test]
fn a_hexagon_holds_the_centred_hexagonal_number() {
    let cell = Cell::<3>::named("hcp").unwrap();
    for n in [1, 2, 10] {
        let reach = f64::from(n) + 1.0;
        let widths = [Width::Between(-reach, reach); 2];
        let crystal = Crystal::new(cell, 1.0, 2, &widths, Outline::Hexagon(n.into())).unwrap();
        let count = |layer| crystal.sites().iter().filter(|site| site.layer == layer).count();
        assert_eq!([count(1), count(2)], [(3 * n * (n + 1) + 1) as usize, (3 * n * n) as usize]);
    }
}

#[test]
fn what_is_no_crystal_is_refused() {
    let cell = Cell::<2>::named("square").unwrap();
    let new = |diameter, layers, widths: &[Width]| Crystal::new(cell, diameter, layers, widths, Outline::All);
    assert_eq!(
        new(f64::NAN, 3, &[Width::Cells(1)]).map(drop).unwrap_err().to_string(),
        "diameter NaN m must be positive"
    );
    assert_eq!(new(1.0, 0, &[Width::Cells(1)]).map(drop), Err(CrystalError::Layers(0)));
    assert_eq!(new(1.0, 3, &[]).map(drop), Err(CrystalError::Widths(0, 1)));
    assert_eq!(new(1.0, 3, &[Width::Between(2.0, 1.0)]).map(drop), Err(CrystalError::Width { axis: 'x' }));
    assert_eq!(new(1.0, 3, &[Width::Cells(0)]).map(drop), Err(CrystalError::Width { axis: 'x' }));
    assert_eq!(new(1.0, 3, &[Width::Between(0.1, 0.9)]).map(drop), Err(CrystalError::Empty(1)));
    assert_eq!(new(1.0, 1_000_000, &[Width::Cells(1000)]).map(drop), Err(CrystalError::Large));
}
