//! What a bed is like: volume fraction, coordination, pair correlation, and where its surface lies.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::{Bed, Disk};
use crate::period::nearest_image;

/// Numbers of a bed at rest.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Measures {
    /// Number of grains.
    pub grains: usize,
    /// Height of the surface over its middle (d): mean of the highest tops in bins one wide within 5 of the middle.
    pub surface: f64,
    /// Part of the area that disks cover, three diameters or more from bottom, surface and walls.
    pub volume_fraction: f64,
    /// Mean number of contacts of a grain, walls included.
    pub coordination: f64,
    /// Pair correlation g(r) of grains in the bulk, in bins 0.05 wide from 0 on: (middle of the bin (d), g).
    pub pair_correlation: Vec<[f64; 2]>,
}

/// How far from an edge the bulk begins (d).
const EDGE: f64 = 3.0;
/// Bins of the pair correlation: their width and how far they reach (d).
const BIN: f64 = 0.05;
const REACH: f64 = 6.0;

/// Measures a bed.
pub fn measure(bed: &Bed) -> Measures {
    let surface = surface(bed, 0.5 * bed.width);
    let sides = if bed.periodic { [0.0, bed.width] } else { [EDGE, bed.width - EDGE] };
    let heights = [EDGE, surface - EDGE];
    Measures {
        grains: bed.grains.len(),
        surface,
        volume_fraction: volume_fraction(bed, sides, heights),
        coordination: coordination(bed),
        pair_correlation: pair_correlation(bed, sides, heights),
    }
}

/// Height of the surface around `middle` (d): mean of the highest tops in the ten bins one wide within 5 of it; bins without
/// grains do not count.
pub fn surface(bed: &Bed, middle: f64) -> f64 {
    let mut tops = [f64::NEG_INFINITY; 10];
    for Disk { centre: [x, y], diameter } in &bed.grains {
        let mut x = x - middle;
        if bed.periodic {
            x = nearest_image(x, bed.width);
        }
        let bin = (x + 5.0).floor();
        if (0.0..10.0).contains(&bin) {
            let top = &mut tops[bin as usize];
            *top = top.max(y + 0.5 * diameter);
        }
    }
    let known: Vec<f64> = tops.into_iter().filter(|top| top.is_finite()).collect();
    known.iter().sum::<f64>() / known.len().max(1) as f64
}

/// Area of the part of a disk of radius `r` that lies below a line at height `h` over its centre.
fn area_below(r: f64, h: f64) -> f64 {
    let h = h.clamp(-r, r);
    r * r * (h / r).asin() + h * (r * r - h * h).sqrt() + 0.5 * std::f64::consts::PI * r * r
}

fn volume_fraction(bed: &Bed, sides: [f64; 2], heights: [f64; 2]) -> f64 {
    let window = (sides[1] - sides[0]) * (heights[1] - heights[0]);
    let mut covered = 0.0;
    for Disk { centre: [x, y], diameter } in &bed.grains {
        let r = 0.5 * diameter;
        if !bed.periodic && !(sides[0]..sides[1]).contains(x) {
            continue;
        }
        covered += area_below(r, heights[1] - y) - area_below(r, heights[0] - y);
    }
    if window > 0.0 { covered / window } else { f64::NAN }
}

/// Pairs of disks nearer than `reach` between centres, each once; over periodic sides by the nearest images.
fn pairs(disks: &[Disk], period: Option<f64>, reach: f64, mut visit: impl FnMut(usize, usize, f64)) {
    let low = disks.iter().map(|d| d.centre[1]).fold(f64::INFINITY, f64::min);
    // Rows as high as the reach, each in order of x; a disk far away makes no empty ones.
    let mut rows: BTreeMap<usize, Vec<(f64, usize)>> = BTreeMap::new();
    for (i, Disk { centre: [x, y], .. }) in disks.iter().enumerate() {
        let row = ((y - low) / reach).floor() as usize;
        rows.entry(row).or_default().push((period.map_or(*x, |period| x.rem_euclid(period)), i));
    }
    rows.values_mut().for_each(|row| row.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))));
    for (&k, row) in &rows {
        let above = k.checked_add(1).and_then(|k| rows.get(&k)).map_or(&[][..], Vec::as_slice);
        for (n, &(x, i)) in row.iter().enumerate() {
            let beside = near(&row[n + 1..], x, period, reach);
            for &(other, j) in beside.into_iter().chain(near(above, x, period, reach)).flatten() {
                let dx = period.map_or(x - other, |period| nearest_image(x - other, period));
                let dy = disks[i].centre[1] - disks[j].centre[1];
                // Most are too far: they cost no root.
                let squared = dx * dx + dy * dy;
                if squared < reach * reach {
                    visit(i.min(j), i.max(j), squared.sqrt());
                }
            }
        }
    }
}

/// The part of a row in order of x that lies within `reach` of `x`, and what of it does so over either side.
fn near(row: &[(f64, usize)], x: f64, period: Option<f64>, reach: f64) -> [&[(f64, usize)]; 3] {
    let between = |low: f64, high: f64| {
        let from = row.partition_point(|other| other.0 < low);
        &row[from..from + row[from..].partition_point(|other| other.0 <= high)]
    };
    match period {
        // So narrow that each disk is near all, and once.
        Some(period) if period <= 2.0 * reach => [row, &[], &[]],
        Some(period) => [-period, 0.0, period].map(|shift| between(x + shift - reach, x + shift + reach)),
        None => [between(x - reach, x + reach), &[], &[]],
    }
}

fn coordination(bed: &Bed) -> f64 {
    let disks: Vec<Disk> = bed.grains.iter().chain(&bed.walls).copied().collect();
    let widest = disks.iter().map(|d| d.diameter).fold(0.0, f64::max);
    let (count, mut contacts) = (bed.grains.len(), 0_usize);
    pairs(&disks, bed.periodic.then_some(bed.width), widest, |i, j, apart| {
        if apart < 0.5 * (disks[i].diameter + disks[j].diameter) {
            contacts += usize::from(i < count) + usize::from(j < count);
        }
    });
    contacts as f64 / count.max(1) as f64
}

/// g(r) around grains at least `REACH` inside the bulk, so that every ring around them is full.
fn pair_correlation(bed: &Bed, sides: [f64; 2], heights: [f64; 2]) -> Vec<[f64; 2]> {
    let inside = |disk: &Disk| {
        let [x, y] = disk.centre;
        (bed.periodic || (sides[0] + REACH..sides[1] - REACH).contains(&x))
            && (heights[0] + REACH..heights[1] - REACH).contains(&y)
    };
    let bins = (REACH / BIN).round() as usize;
    let mut counts = vec![0_u64; bins];
    let centres = bed.grains.iter().filter(|disk| inside(disk)).count();
    pairs(&bed.grains, bed.periodic.then_some(bed.width), REACH, |i, j, apart| {
        let bin = ((apart / BIN) as usize).min(bins - 1);
        counts[bin] += u64::from(inside(&bed.grains[i])) + u64::from(inside(&bed.grains[j]));
    });
    let bulk = bed.grains.iter().filter(|d| (heights[0]..heights[1]).contains(&d.centre[1])).count() as f64;
    let width = if bed.periodic { bed.width } else { sides[1] - sides[0] };
    let density = bulk / (width * (heights[1] - heights[0]));
    (0..bins)
        .map(|k| {
            let (inner, outer) = (k as f64 * BIN, (k + 1) as f64 * BIN);
            let ring = std::f64::consts::PI * (outer * outer - inner * inner);
            let expected = centres as f64 * density * ring;
            [0.5 * (inner + outer), if expected > 0.0 { counts[k] as f64 / expected } else { 0.0 }]
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use rand_xoshiro::Xoshiro256PlusPlus;
    use rand_xoshiro::rand_core::SeedableRng;

    use super::*;
    use crate::bed::{Packing, Pile, Sides};
    use crate::stats::fraction;

    /// Touching disks on a hexagonal lattice cover π/(2√3) of the plane; in a periodic bed of R rows by C columns, squeezed by a
    /// thousandth, there are 3RC − 2C contacts among grains, and the lowest row touches walls.
    #[test]
    fn a_hexagonal_bed_has_its_numbers() {
        let pile = Pile {
            packing: Packing::Hexagonal,
            width: 30.0,
            height: 40.0,
            spread: 0.0,
            seed: 1,
            sides: Sides::Periodic,
        };
        let (mut bed, _) = pile.lay();
        bed.grains.iter_mut().for_each(|disk| disk.diameter = 1.001);
        bed.walls.clear();
        let measures = measure(&bed);
        let covered = PI / (2.0 * 3.0_f64.sqrt()) * 1.001 * 1.001;
        // The window's edges cut rows: up to a row's part of its height, 1/33, is not averaged out exactly.
        assert!((measures.volume_fraction / covered - 1.0).abs() < 0.02, "{}", measures.volume_fraction);
        assert_eq!(measures.coordination, 2.0 * (3.0 * 40.0 - 2.0) / 40.0);
        let surface = 0.5 + 39.0 * 0.75_f64.sqrt() + 0.5005;
        assert!((measures.surface - surface).abs() < 1e-12);
        // Six neighbours at distance 1: the ring's integral of g is 6 over the density.
        let ring: f64 = (measures.pair_correlation.iter())
            .filter(|[r, _]| (0.9..1.1).contains(r))
            .map(|[r, g]| g * 2.0 * PI * r * BIN)
            .sum();
        let density = 1.0 / 0.75_f64.sqrt();
        assert!((ring * density / 6.0 - 1.0).abs() < 0.05, "{}", ring * density);
    }

    /// Pairs found by rows are those found by comparing all with all: over sides that repeat far apart and close by, and without.
    #[test]
    fn pairs_are_all_pairs_in_reach() {
        let mut chance = Xoshiro256PlusPlus::seed_from_u64(3);
        let mut draw = || fraction(&mut chance);
        for width in [3.0, 11.0, 40.0] {
            let disks: Vec<Disk> = (0..300)
                .map(|_| Disk { centre: [width * (3.0 * draw() - 1.0), 20.0 * draw()], diameter: 1.0 })
                .collect();
            for (period, reach) in [(None, 1.5), (Some(width), 1.5), (Some(width), 6.0)] {
                let mut found = Vec::new();
                pairs(&disks, period, reach, |i, j, apart| found.push((i, j, apart)));
                found.sort_by_key(|&(i, j, _)| (i, j));
                let mut expected = Vec::new();
                for i in 0..disks.len() {
                    for j in i + 1..disks.len() {
                        let mut dx = disks[i].centre[0] - disks[j].centre[0];
                        if let Some(period) = period {
                            dx -= period * (dx / period).round();
                        }
                        let apart = dx.hypot(disks[i].centre[1] - disks[j].centre[1]);
                        if apart < reach {
                            expected.push((i, j, apart));
                        }
                    }
                }
                assert_eq!(found.len(), expected.len(), "{width} {period:?} {reach}");
                for (found, expected) in found.iter().zip(&expected) {
                    assert!((found.0, found.1) == (expected.0, expected.1), "{found:?} {expected:?}");
                    assert!((found.2 - expected.2).abs() < 1e-12, "{found:?} {expected:?}");
                }
            }
        }
    }

    /// Half a disk lies below its middle, all of it below its top.
    #[test]
    fn parts_of_disks_are_exact() {
        assert!((area_below(2.0, 0.0) - 2.0 * PI).abs() < 1e-12);
        assert!((area_below(2.0, 5.0) - 4.0 * PI).abs() < 1e-12);
        // A segment of height r/2: r² (2π/3 − √3/4) is left below.
        assert!((area_below(1.0, 0.5) - (2.0 * PI / 3.0 + 3.0_f64.sqrt() / 4.0)).abs() < 1e-12);
    }
}
