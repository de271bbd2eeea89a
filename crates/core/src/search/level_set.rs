//! Smooth assignments: a low-order field for each letter, and on each site the letter whose field is highest.

use super::cma::cholesky;
use super::method::{Parameters, Row};
use super::{Assignment, Parametrisation, Rng, Space, parametric};

/// CMA-ES over the coefficients of level sets, the first from that which is nearest to the start.
pub(super) const METHOD: Row = Row {
    name: "level-set",
    about: "CMA-ES over low-order fields, whose signs decide each sphere",
    parameters: Parameters::Fields(Parametrisation::level_sets),
    ..parametric::METHOD
};

/// Half waves each way of a random assignment.
const RANDOM_ORDER: usize = 5;

/// The products of `order` cosines each way at every site, across and down and in space along y too: what smooth fields are made of.
/// Across and along y they are even about the axis.
///
/// cos(m π x) is the Chebyshev polynomial T_m of cos(π x), for which 1 - 2 (3 x² - 2 x³) stands in (off by 0.01 at
/// most), so that nothing depends on a platform's mathematical library.
#[derive(Clone, Debug)]
pub struct Waves {
    /// How many weights a field takes.
    each: usize,
    alphabet: u8,
    /// For each site the products, those of the fewest half waves first.
    products: Vec<Vec<f64>>,
}

/// The part of a field that is given to a product of so many half waves together: less for shorter ones.
fn share(waves: usize) -> f64 {
    1.0 / (1.0 + 0.5 * waves as f64)
}

impl Waves {
    /// Over the sites' rectangle, each way up to `order` - 1 half waves.
    pub fn new(space: &Space, order: usize) -> Self {
        let ranges = [space.range(0), space.range(1)];
        let axis = space.adjacency.as_ref().map_or(0, |adjacency| adjacency.axis);
        let farthest = space.sites.iter().map(|site| site[2].abs_diff(axis)).max().unwrap_or(0).max(1);
        let deep = if space.is_deep() { order } else { 1 };
        let products = |site: &[u32; 3]| {
            let [down, across] = [0, 1].map(|k| half_waves((f64::from(site[k]) - ranges[k].0) / ranges[k].1, order));
            let along = half_waves(f64::from(site[2].abs_diff(axis)) / f64::from(farthest), deep);
            let mut products = Vec::with_capacity(order * order * deep);
            for (m, d) in down.iter().enumerate() {
                for (n, a) in across.iter().enumerate() {
                    for (l, b) in along.iter().enumerate() {
                        products.push(share(m + n + l) * d * a * b);
                    }
                }
            }
            products
        };
        let each = order * order * deep;
        Self { each, alphabet: space.alphabet, products: space.sites.iter().map(products).collect() }
    }

    /// How many weights an assignment takes: a field for every letter but the first, whose field is zero.
    pub fn dimension(&self) -> usize {
        self.each * usize::from(self.alphabet.max(1) - 1)
    }

    /// On each site the letter whose field is highest; of several the first.
    pub fn assignment(&self, weights: &[f64]) -> Assignment {
        let highest = |products: &Vec<f64>| {
            let mut best = (0.0, 0);
            for (letter, field) in (1..self.alphabet).zip(weights.chunks(self.each)) {
                let height: f64 = field.iter().zip(products).map(|(w, p)| w * p).sum();
                if height > best.0 {
                    best = (height, letter);
                }
            }
            best.1
        };
        self.products.iter().map(highest).collect()
    }

    /// The weights whose fields come nearest to an assignment: for each letter the least squares of its field to 1 where it
    /// stands and -1 elsewhere, held small where the sites do not tell.
    pub fn fit(&self, assignment: &[u8]) -> Vec<f64> {
        let n = self.each;
        let mut normal = vec![0.0; n * n];
        for products in &self.products {
            for i in 0..n {
                for j in 0..n {
                    normal[i * n + j] += products[i] * products[j];
                }
            }
        }
        let ridge = 1e-3 * self.products.len().max(1) as f64;
        (0..n).for_each(|i| normal[i * n + i] += ridge);
        // With the ridge it is positive definite.
        let Some(lower) = cholesky(&normal, n) else { return vec![0.0; self.dimension()] };
        let field = |letter: u8| {
            let mut x: Vec<f64> = (0..n)
                .map(|i| {
                    let sign = |&there: &u8| if there == letter { 1.0 } else { -1.0 };
                    self.products.iter().zip(assignment).map(|(p, there)| p[i] * sign(there)).sum()
                })
                .collect();
            for i in 0..n {
                let before: f64 = (0..i).map(|k| lower[i * n + k] * x[k]).sum();
                x[i] = (x[i] - before) / lower[i * n + i];
            }
            for i in (0..n).rev() {
                let behind: f64 = (i + 1..n).map(|k| lower[k * n + i] * x[k]).sum();
                x[i] = (x[i] - behind) / lower[i * n + i];
            }
            x
        };
        let zero = field(0);
        (1..self.alphabet)
            .flat_map(|letter| {
                let x = field(letter);
                // Heights count from that of the first letter's field.
                x.into_iter().zip(&zero).map(|(x, zero)| 0.5 * (x - zero)).collect::<Vec<f64>>()
            })
            .collect()
    }
}

/// A smooth random assignment: for each letter a random field of up to four half waves each way; the highest field has the site.
pub fn level_set(space: &Space, rng: &mut Rng) -> Assignment {
    let waves = Waves::new(space, RANDOM_ORDER);
    let fields: Vec<Vec<f64>> =
        (0..space.alphabet).map(|_| (0..waves.each).map(|_| rng.nearly_normal()).collect()).collect();
    // The letters' fields less the first one's, so that all letters are alike.
    let weights: Vec<f64> =
        fields.iter().skip(1).flat_map(|field| field.iter().zip(&fields[0]).map(|(w, first)| w - first)).collect();
    waves.assignment(&weights)
}

/// About cos(m π x), m from 0 on.
fn half_waves(x: f64, order: usize) -> Vec<f64> {
    let u = 1.0 - 2.0 * x * x * (3.0 - 2.0 * x);
    let mut waves = vec![1.0; order];
    if order > 1 {
        waves[1] = u;
    }
    for m in 2..order {
        waves[m] = 2.0 * u * waves[m - 1] - waves[m - 2];
    }
    waves
}
