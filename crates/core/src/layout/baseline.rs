//! What a lens is compared with: flat strips, uniform crystals and random mixtures of the same two materials.

use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};

use super::Layout;
use crate::lattice::Layered;

const HOST: u8 = 0;

/// An arrangement that a lens has to beat (Burgoyne 2016, figs 5.21 and 5.22).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Baseline {
    /// A strip of lens material over the rows that the lens spans.
    FlatSameHeight,
    /// A strip from the lens's first row on, of the whole rows that come nearest to the lens's number of spheres.
    FlatSameCount,
    /// A strip of so many whole layers from the lens's first on.
    Strip(u32),
    /// No lens.
    AllHost,
    /// Lens material everywhere.
    AllLens,
    /// A fair coin for every site of the lens's rows.
    RandomLensRows(u64),
    /// A fair coin for every site from the lens's first row to the last row of the crystal.
    RandomBehind(u64),
}

impl Baseline {
    /// The whole set, with `seeds` random arrangements of each kind from seed `first_seed` on.
    pub fn set(first_seed: u64, seeds: u64) -> Vec<Self> {
        let numbers = || (0..seeds).map(move |k| first_seed.wrapping_add(k));
        [Self::FlatSameHeight, Self::FlatSameCount, Self::AllHost, Self::AllLens]
            .into_iter()
            .chain(numbers().map(Self::RandomLensRows))
            .chain(numbers().map(Self::RandomBehind))
            .collect()
    }

    /// Short name for tables and files: `flat-height`, ..., `random-behind-3`.
    pub fn name(self) -> String {
        match self {
            Self::RandomLensRows(seed) | Self::RandomBehind(seed) => format!("{}-{seed}", self.kind()),
            Self::Strip(layers) => format!("strip-{layers}"),
            _ => self.kind().to_owned(),
        }
    }

    /// The name without the seed or the number of layers.
    pub fn kind(self) -> &'static str {
        match self {
            Self::FlatSameHeight => "flat-height",
            Self::FlatSameCount => "flat-count",
            Self::Strip(_) => "strip",
            Self::AllHost => "all-host",
            Self::AllLens => "all-lens",
            Self::RandomLensRows(_) => "random-lens-rows",
            Self::RandomBehind(_) => "random-behind",
        }
    }

    /// The random seed, where the arrangement has one.
    pub fn seed(self) -> Option<u64> {
        match self {
            Self::RandomLensRows(seed) | Self::RandomBehind(seed) => Some(seed),
            _ => None,
        }
    }

    /// Lays the baseline for a lens that occupies `rows` (first, last) of `lens`'s lattice, of its host, the first of its palette, and
    /// of `material`, another place in it.
    pub fn layout<L: Layered + Clone>(self, lens: &Layout<L>, rows: [u32; 2], material: u8) -> Layout<L> {
        let count = lens.materials.iter().filter(|&&m| m != HOST).count();
        self.layout_of_count(lens, rows, material, count)
    }

    /// The same where what it is laid for has another number of sites of the half that do not hold the host, as the mean of two halves
    /// that differ.
    pub fn layout_of_count<L: Layered + Clone>(
        self,
        lens: &Layout<L>,
        rows: [u32; 2],
        material: u8,
        count: usize,
    ) -> Layout<L> {
        let lattice = &lens.lattice;
        let strip = |first: u32, last: u32| {
            let mut materials = vec![HOST; lens.materials.len()];
            for layer in first..=last.min(lattice.layers()) {
                materials[lattice.layer(layer)].fill(material);
            }
            Layout { lattice: lattice.clone(), palette: lens.palette.clone(), materials }
        };
        let random = |seed: u64, first: u32, last: u32| {
            let sites = lattice.layer(first).start..lattice.layer(last).end;
            let coins = random_choice(seed, sites.len());
            let mut layout = strip(1, 0);
            for (site, coin) in layout.materials[sites].iter_mut().zip(coins) {
                *site = if coin == 1 { material } else { HOST };
            }
            layout
        };
        match self {
            Self::FlatSameHeight => strip(rows[0], rows[1]),
            Self::FlatSameCount => strip(rows[0], last_row_of_same_count(lens, count, rows[0])),
            Self::Strip(layers) => strip(rows[0], rows[0] + layers.max(1) - 1),
            Self::AllHost => strip(1, 0),
            Self::AllLens => strip(1, lattice.layers()),
            Self::RandomLensRows(seed) => random(seed, rows[0], rows[1]),
            Self::RandomBehind(seed) => random(seed, rows[0], lattice.layers()),
        }
    }
}

/// The last row of the strip from `first` on whose number of spheres is nearest to what is wanted; the thinner of two alike.
fn last_row_of_same_count<L: Layered>(lens: &Layout<L>, wanted: usize, first: u32) -> u32 {
    let mut count = 0;
    let mut best = (usize::MAX, first);
    for row in first..=lens.lattice.layers() {
        count += lens.lattice.layer(row).len();
        let miss = count.abs_diff(wanted);
        if miss < best.0 {
            best = (miss, row);
        }
    }
    best.1
}

/// `count` fair coins, 0 (host) or 1 (lens material), for the sites of a random region in the lattice's order (row by row,
/// each in order of x, in the simulated half).
///
/// The map from seed to coins never changes: coin k is the highest bit of the k-th output of xoshiro256++ whose state is
/// filled from the seed by SplitMix64 (Blackman & Vigna 2018).
pub fn random_choice(seed: u64, count: usize) -> Vec<u8> {
    let mut generator = Xoshiro256PlusPlus::seed_from_u64(seed);
    (0..count).map(|_| (generator.next_u64() >> 63) as u8).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::{Block, BlockSide, Cell, HexagonalSheet};
    use crate::material::find;

    fn lens() -> Layout {
        let sheet = HexagonalSheet::new(6.35e-3, 50, 16.5).unwrap();
        let palette = vec![find("440c", &[]).unwrap(), find("brass", &[]).unwrap()];
        // 139 spheres in rows 5 to 16: eight whole rows and three more.
        Layout::new(sheet, palette, |s| u8::from((5..13).contains(&s.row) || (s.row == 16 && s.column <= 3)))
    }

    #[test]
    fn strips_have_the_height_or_the_count_of_the_lens() {
        let lens = lens();
        assert_eq!(Baseline::FlatSameHeight.layout(&lens, [5, 16], 1).count(1), 204);
        assert_eq!(Baseline::FlatSameCount.layout(&lens, [5, 16], 1).count(1), 136);
        assert_eq!(Baseline::AllHost.layout(&lens, [5, 16], 1).count(1), 0);
        assert_eq!(Baseline::AllLens.layout(&lens, [5, 16], 1).count(1), 850);
    }

    /// In the plane as in space, of whole layers.
    #[test]
    fn strips_have_their_layers() {
        assert_eq!(Baseline::Strip(3).layout(&lens(), [5, 16], 1).count(1), 51);
        let sides = [BlockSide::Mirror, BlockSide::Free];
        let block = Block::new(Cell::<3>::named("hcp").unwrap(), 1.0, 8, [6, 4], 1, sides).unwrap();
        let materials = vec![0; block.sites().len()];
        let host = Layout { lattice: block, palette: lens().palette, materials };
        let strip = Baseline::Strip(2).layout(&host, [3, 5], 1);
        let held = |layer: u32| strip.materials[host.lattice.layer(layer)].iter().all(|&m| m == 1);
        assert_eq!((1..=8).filter(|&layer| held(layer)).collect::<Vec<_>>(), [3, 4]);
        assert_eq!(strip.count(1), host.lattice.layer(3).len() + host.lattice.layer(4).len());
    }

    #[test]
    fn random_rows_stay_within_their_rows() {
        let lens = lens();
        for (baseline, rows) in [(Baseline::RandomLensRows(3), 5..=16), (Baseline::RandomBehind(3), 5..=50)] {
            let layout = baseline.layout(&lens, [5, 16], 1);
            let outside =
                layout.lattice.sites().iter().zip(&layout.materials).any(|(s, &m)| m == 1 && !rows.contains(&s.row));
            assert!(!outside);
            // 204 and 782 fair coins: five standard deviations about one half.
            let (count, sites) = (layout.count(1) as f64, (rows.count() * 17) as f64);
            assert!((count - 0.5 * sites).abs() < 2.5 * sites.sqrt());
        }
    }

    /// The first outputs of xoshiro256++ seeded by SplitMix64(1), computed from the published algorithms in another
    /// language; a change of this map would silently change every published comparison.
    #[test]
    fn the_map_from_seed_to_coins_never_changes() {
        assert_eq!(random_choice(1, 16), EXPECTED_SEED_1);
        assert_eq!(random_choice(2, 16), EXPECTED_SEED_2);
    }
    const EXPECTED_SEED_1: [u8; 16] = [1, 1, 0, 1, 0, 1, 1, 1, 0, 0, 1, 0, 0, 0, 0, 0];
    const EXPECTED_SEED_2: [u8; 16] = [1, 1, 1, 0, 0, 1, 0, 1, 0, 1, 1, 1, 1, 1, 1, 0];
}
