//! What a layout is made of: how many spheres, how heavy, at which price; of the piece to be built and of the simulated half.
//!
//! The two are different things. A sphere on the axis is one sphere of the piece; one on the far mirror line is two, one at each
//! rim. In the simulated half both are one site, of which one half of the sphere is simulated.

use serde::{Deserialize, Serialize};

use super::Layout;
use crate::lattice::{Block, BlockSide, HexagonalSheet};
use crate::material::Material;

/// Spheres, mass and price of a part or the whole of a crystal.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Amount {
    /// Spheres, or sites of a half, that do not hold the host.
    pub spheres: u64,
    /// Mass of all, host included (kg).
    #[serde(rename = "mass_kg")]
    pub mass: f64,
    /// Price of all, host included; none where the price of a material that occurs is missing.
    pub cost: Option<f64>,
}

/// Spheres of each material of a palette.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Bill {
    /// How many of each, in the order of the palette; of a half its sites.
    pub counts: Vec<u64>,
    /// The rest.
    #[serde(flatten)]
    pub amount: Amount,
}

/// What a layout itself says, without a simulation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LayoutStats {
    /// The simulated half, spheres on its mirror lines weighing half.
    pub half: Amount,
    /// The piece to be built.
    pub piece: Amount,
    /// Spheres in the free rows of a study that touch no other of their material; none without a study.
    pub lone: Option<u64>,
    /// Groups of touching spheres of one material other than the host.
    pub islands: u64,
}

/// Who touches whom, and what weighs what: from a layout's letters to its [`LayoutStats`].
#[derive(Clone, Debug)]
pub struct LayoutCounter {
    /// Neighbours of every site.
    beside: Vec<Vec<usize>>,
    /// Sites that touch their own image in a mirror line, and so are never alone.
    mirrored: Vec<bool>,
    /// Share of each sphere that lies in the simulated half.
    weight: Vec<f64>,
    /// Spheres of the piece on each site.
    copies: Vec<u64>,
    free: Option<Vec<bool>>,
    /// Volume of the sphere of each site over that of the lattice's diameter.
    volume: Vec<f64>,
    /// Mass of a sphere of that diameter of each material of the palette (kg).
    mass: Vec<f64>,
    /// Price of one, where it is known.
    price: Vec<Option<f64>>,
}

impl LayoutCounter {
    /// For layouts on a lattice whose `free` sites may change, where a study says so. The first of the palette is the host; `prices`
    /// are those of a sphere of each of the palette.
    pub fn new(
        lattice: &HexagonalSheet,
        free: Option<&[usize]>,
        palette: &[Material],
        prices: impl Fn(&Material) -> Option<f64>,
    ) -> Self {
        let (sites, diameter, far) = (lattice.sites(), lattice.diameter(), lattice.half_width());
        let mut beside = vec![Vec::new(); sites.len()];
        for (i, a) in sites.iter().enumerate() {
            // Sites stand row by row; a neighbour is at most one row away.
            for (j, b) in sites.iter().enumerate().skip(i + 1).take_while(|(_, b)| b.row <= a.row + 1) {
                let reach = 0.5 * (lattice.row_diameter(a.row) + lattice.row_diameter(b.row));
                if (a.x - b.x).hypot(a.z - b.z) < 1.1 * reach {
                    beside[i].push(j);
                    beside[j].push(i);
                }
            }
        }
        // From a mirror line: on it, or half a diameter away and so touching the own image.
        let gap = |x: f64| x.min(far - x) / diameter;
        Self {
            mirrored: sites.iter().map(|site| (0.25..0.75).contains(&gap(site.x))).collect(),
            weight: sites.iter().map(|site| if gap(site.x) < 0.25 { 0.5 } else { 1.0 }).collect(),
            copies: sites.iter().map(|site| copies(site.x, diameter)).collect(),
            free: free.map(|free| marked(free, sites.len())),
            volume: sites.iter().map(|site| (lattice.row_diameter(site.row) / diameter).powi(3)).collect(),
            mass: palette.iter().map(|material| material.sphere_mass(diameter)).collect(),
            price: palette.iter().map(prices).collect(),
            beside,
        }
    }

    /// The same of layouts in space.
    pub fn in_space(
        block: &Block,
        free: Option<&[usize]>,
        palette: &[Material],
        prices: impl Fn(&Material) -> Option<f64>,
    ) -> Self {
        let steps = block.beside();
        let folded = matches!(block.sides()[0], BlockSide::Mirror | BlockSide::Period);
        let far = i64::from(block.cells()[0]);
        let weight = |index: usize| match block.place(index)[0] {
            0 => 0.5,
            x if x == far && folded => 0.5,
            _ => 1.0,
        };
        let others = |(index, steps): (usize, &[Option<usize>; 18])| {
            steps.iter().copied().flatten().filter(|&other| other != index).collect()
        };
        Self {
            beside: steps.iter().enumerate().map(others).collect(),
            mirrored: steps.iter().enumerate().map(|(index, steps)| steps.contains(&Some(index))).collect(),
            weight: (0..steps.len()).map(weight).collect(),
            copies: block.copies().iter().map(|&copies| u64::from(copies)).collect(),
            free: free.map(|free| marked(free, steps.len())),
            volume: vec![1.0; steps.len()],
            mass: palette.iter().map(|material| material.sphere_mass(block.diameter())).collect(),
            price: palette.iter().map(prices).collect(),
        }
    }

    /// Of a layout, an index into the palette for every site.
    pub fn stats(&self, materials: &[u8]) -> LayoutStats {
        let alike = |i: usize| self.beside[i].iter().copied().filter(move |&j| materials[j] == materials[i]);
        let lone = |free: &Vec<bool>| {
            let lone = |i: &usize| free[*i] && !self.mirrored[*i] && alike(*i).next().is_none();
            (0..materials.len()).filter(lone).count() as u64
        };
        let mut seen = vec![false; materials.len()];
        let mut islands = 0;
        for begin in 0..materials.len() {
            if materials[begin] == 0 || seen[begin] {
                continue;
            }
            islands += 1;
            let mut edge = vec![begin];
            seen[begin] = true;
            while let Some(i) = edge.pop() {
                for j in alike(i) {
                    if !seen[j] {
                        seen[j] = true;
                        edge.push(j);
                    }
                }
            }
        }
        LayoutStats {
            half: self.half(materials).amount,
            piece: self.piece(materials).amount,
            lone: self.free.as_ref().map(lone),
            islands,
        }
    }

    /// Counts of the piece to be built: as many as lines of its full layout.
    pub fn piece(&self, materials: &[u8]) -> Bill {
        let mut counts = vec![0; self.mass.len()];
        materials.iter().zip(&self.copies).for_each(|(&m, copies)| counts[usize::from(m)] += copies);
        let known = priced(&counts, &self.price);
        // Over the sites in their order, so that the sum's bits do not depend on that of the palette.
        let weighed = |each: &dyn Fn(usize, usize) -> f64| -> f64 {
            let sites = materials.iter().zip(&self.copies).enumerate();
            sites.map(|(site, (&m, &copies))| copies as f64 * each(site, usize::from(m))).sum()
        };
        let amount = Amount {
            spheres: counts.iter().skip(1).sum(),
            mass: weighed(&|site, k| self.volume[site] * self.mass[k]),
            cost: known.then(|| weighed(&|_, k| self.price[k].unwrap_or_default())),
        };
        Bill { counts, amount }
    }

    /// The sites of the simulated half, and what of their spheres lies in it.
    pub fn half(&self, materials: &[u8]) -> Bill {
        let mut counts = vec![0; self.mass.len()];
        materials.iter().for_each(|&m| counts[usize::from(m)] += 1);
        let weighed = |each: &dyn Fn(usize, usize) -> f64| -> f64 {
            let sites = materials.iter().zip(&self.weight).enumerate();
            sites.map(|(site, (&m, weight))| weight * each(site, usize::from(m))).sum()
        };
        let known = priced(&counts, &self.price);
        let amount = Amount {
            spheres: counts.iter().skip(1).sum(),
            mass: weighed(&|site, k| self.volume[site] * self.mass[k]),
            cost: known.then(|| weighed(&|_, k| self.price[k].unwrap_or_default())),
        };
        Bill { counts, amount }
    }
}

/// Spheres of the whole piece that a site of the half at `x` (m) stands for: one on the axis, two beside it.
fn copies(x: f64, diameter: f64) -> u64 {
    if x < 0.25 * diameter { 1 } else { 2 }
}

/// Which of so many sites are among some.
fn marked(some: &[usize], sites: usize) -> Vec<bool> {
    let mut marked = vec![false; sites];
    some.iter().for_each(|&i| marked[i] = true);
    marked
}

/// Whether all materials that occur have a price.
fn priced(counts: &[u64], prices: &[Option<f64>]) -> bool {
    counts.iter().zip(prices).all(|(&count, price)| count == 0 || price.is_some())
}

impl Layout<Block> {
    /// What the whole crystal in space is made of, at prices of one sphere.
    pub fn piece_in_space(&self, prices: impl Fn(&Material) -> Option<f64>) -> Bill {
        LayoutCounter::in_space(&self.lattice, None, &self.palette, prices).piece(&self.materials)
    }
}

impl Layout {
    /// A counter for this layout's lattice and palette.
    fn counter(&self, prices: impl Fn(&Material) -> Option<f64>) -> LayoutCounter {
        LayoutCounter::new(&self.lattice, None, &self.palette, prices)
    }

    /// What the piece to be built is made of, at prices of one sphere.
    pub fn piece(&self, prices: impl Fn(&Material) -> Option<f64>) -> Bill {
        self.counter(prices).piece(&self.materials)
    }

    /// What the simulated half is made of.
    pub fn half(&self, prices: impl Fn(&Material) -> Option<f64>) -> Bill {
        self.counter(prices).half(&self.materials)
    }

    /// All that the layout itself says.
    pub fn stats(&self, prices: impl Fn(&Material) -> Option<f64>) -> LayoutStats {
        self.counter(prices).stats(&self.materials)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material;

    /// Eight rows of four; by hand.
    #[test]
    fn lone_spheres_and_islands_are_counted_as_drawn() {
        let lattice = HexagonalSheet::new(6.35e-3, 8, 3.5).unwrap();
        let palette = ["440c", "brass"].map(|name| material::find(name, &[]).unwrap());
        let at = |row, column| lattice.index(row, column).unwrap();
        let free: Vec<usize> = (at(3, 1)..=at(6, 4)).collect();
        let price = |material: &Material| Some(if material.name == "brass-260" { 2.0 } else { 0.5 });
        let counter = LayoutCounter::new(&lattice, Some(&free), &palette, price);
        let mut layout = vec![0; lattice.len()];
        assert_eq!(counter.stats(&layout).islands, 0);
        // One in the midst, one that touches its image in the axis, two that touch across rows.
        layout[at(4, 3)] = 1;
        layout[at(6, 1)] = 1;
        let stats = counter.stats(&layout);
        assert_eq!((stats.half.spheres, stats.lone, stats.islands), (2, Some(1), 2));
        layout[at(5, 3)] = 1;
        let stats = counter.stats(&layout);
        assert_eq!((stats.half.spheres, stats.lone, stats.islands), (3, Some(0), 2));
        // Half the crystal: 4 rows with a sphere on the axis, 4 with one on the far line.
        let all = counter.stats(&vec![0; lattice.len()]);
        let half = (lattice.len() as f64 - 4.0) * palette[0].sphere_mass(6.35e-3);
        assert!((all.half.mass / half - 1.0).abs() < 1e-12);
        assert_eq!(all.half.cost, Some(0.5 * (lattice.len() as f64 - 4.0)));
        assert_eq!(stats.half.cost.unwrap(), all.half.cost.unwrap() + 3.0 * 1.5);
        // The piece: odd rows of 7, one on the axis and 3 either side; even ones of 8.
        let piece = counter.piece(&layout);
        assert_eq!(piece.counts, [4 * 7 + 4 * 8 - 6, 6]);
        assert_eq!((piece.amount.spheres, piece.amount.cost), (6, Some(54.0 * 0.5 + 6.0 * 2.0)));
        // A missing price matters only where the material occurs.
        let some = LayoutCounter::new(&lattice, None, &palette, |m| (m.name != "brass-260").then_some(0.5));
        assert_eq!(
            (some.piece(&layout).amount.cost, some.half(&vec![0; lattice.len()]).amount.cost),
            (None, all.half.cost)
        );
        assert_eq!(some.stats(&layout).lone, None);
    }
}
