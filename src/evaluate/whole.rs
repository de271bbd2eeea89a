//! A piece whose halves differ: what it is beside its right half, and its evaluation as a whole.

use super::load::{Field, ImpactLoad, Imperfection};
use super::{Doubts, EvaluateError, Evaluation, Plan};
use crate::Context;
use crate::dem::{simulate, simulate_with_friction};
use crate::design::Design;
use crate::layout::{Bill, Layout, PieceSphere, ReadLayout, whole};
use crate::material::Material;
use crate::score::Scores;

/// What is judged: a layout, which stands for both halves of its piece, or a piece of two halves.
#[derive(Clone, Copy, Debug)]
pub struct Subject<'a> {
    /// The layout, or the right half.
    pub layout: &'a Layout,
    /// Where the halves differ the material of the image of every site, left of the axis.
    pub left: Option<&'a [u8]>,
}

impl<'a> From<&'a Layout> for Subject<'a> {
    fn from(layout: &'a Layout) -> Self {
        Self { layout, left: None }
    }
}

impl<'a> From<&'a ReadLayout> for Subject<'a> {
    fn from(read: &'a ReadLayout) -> Self {
        Self { layout: &read.layout, left: read.left.as_deref() }
    }
}

impl Subject<'_> {
    /// What is drawn: the material of every site of the half; where the halves differ, behind them those of the sites' images.
    pub fn drawn(&self) -> Vec<u8> {
        [&self.layout.materials[..], self.left.unwrap_or_default()].concat()
    }

    /// All spheres of the piece, row by row from left to right.
    pub fn spheres(&self) -> Vec<PieceSphere> {
        let mut spheres = whole(self.layout);
        if let Some(left) = self.left {
            spheres.iter_mut().filter(|sphere| sphere.x < 0.0).for_each(|sphere| sphere.material = left[sphere.site]);
        }
        spheres
    }

    /// Whether any of its spheres is of a material, a place in the palette.
    pub fn holds(&self, material: u8) -> bool {
        self.layout.materials.iter().chain(self.left.unwrap_or_default()).any(|&known| known == material)
    }

    /// First and last row that hold anything but the host; row 1 where none does.
    pub fn rows(&self) -> [u32; 2] {
        let drawn = self.drawn();
        let sites = self.layout.lattice.sites();
        let other = |k: &usize| drawn.iter().skip(*k).step_by(sites.len()).any(|&material| material != 0);
        let rows: Vec<u32> = (0..sites.len()).filter(other).map(|k| sites[k].row).collect();
        [rows.first().copied().unwrap_or(1), rows.last().copied().unwrap_or(1)]
    }

    /// Sites of the half that hold anything but the host, in the mean of both halves.
    pub fn count(&self) -> usize {
        let of = |materials: &[u8]| materials.iter().filter(|&&material| material != 0).count();
        let right = of(&self.layout.materials);
        self.left.map_or(right, |left| (right + of(left)) / 2)
    }

    /// What the spheres of its [record](Self::evaluate) felt, in the order of [`drawn`](Self::drawn).
    pub fn on_places<T: Clone>(&self, felt: &[T]) -> Vec<T> {
        if self.left.is_none() {
            return felt.to_vec();
        }
        let mut of = vec![0; 2 * self.layout.materials.len()];
        let (right, left) = of.split_at_mut(self.layout.materials.len());
        for (k, sphere) in whole(self.layout).iter().enumerate() {
            // A sphere on the axis is its own image.
            if sphere.x >= 0.0 {
                right[sphere.site] = k;
            }
            if sphere.x <= 0.0 {
                left[sphere.site] = k;
            }
        }
        of.into_iter().map(|k| felt[k].clone()).collect()
    }

    /// What it says by itself: counts, masses and costs; of halves that differ those of the piece alone.
    pub fn scores(&self, prices: impl Fn(&Material) -> Option<f64> + Copy) -> Scores {
        let mut scores = Scores::default();
        if self.left.is_none() {
            scores.add_layout(&self.layout.stats(prices));
            return scores;
        }
        let piece = self.piece(prices).amount;
        (scores.piece_mass, scores.piece_cost, scores.piece_spheres) =
            (Some(piece.mass), piece.cost, Some(piece.spheres));
        scores
    }

    /// What the piece to be built is made of: two halves that differ are half of each whole piece.
    pub fn piece(&self, prices: impl Fn(&Material) -> Option<f64> + Copy) -> Bill {
        let right = self.layout.piece(prices);
        let Some(left) = self.left_layout().map(|left| left.piece(prices)) else { return right };
        let mut bill = right;
        bill.counts.iter_mut().zip(&left.counts).for_each(|(count, other)| *count = (*count + other) / 2);
        bill.amount.spheres = (bill.amount.spheres + left.amount.spheres) / 2;
        bill.amount.mass = 0.5 * (bill.amount.mass + left.amount.mass);
        bill.amount.cost = bill.amount.cost.zip(left.amount.cost).map(|(right, left)| 0.5 * (right + left));
        bill
    }

    /// The left half as a layout of its own.
    fn left_layout(&self) -> Option<Layout> {
        let materials = self.left?.to_vec();
        Some(Layout { materials, ..self.layout.clone() })
    }

    /// Simulates and scores it; of halves that differ the whole piece, between smooth walls at both far sides. A region is then scored
    /// by the mean of each sphere and its image, and energies are those of half the piece, as of a symmetric one; the record is that
    /// of the whole piece, row by row from left to right.
    ///
    /// # Errors
    /// See [`EvaluateError`].
    pub fn evaluate(&self, design: &Design, plan: &Plan, context: &Context) -> Result<Evaluation, EvaluateError> {
        if self.left.is_none() {
            return super::evaluate(design, self.layout, plan, context);
        }
        let field = Field::new(design, plan, &ImpactLoad::from(design.impact), true);
        let lattice = &self.layout.lattice;
        // The places of the other side stand behind those of the half.
        let sample = field.sample(&self.layout.palette, &self.drawn(), &Imperfection::default());
        let record = match field.friction {
            Some(coefficient) => simulate_with_friction(&sample, &field.impact, coefficient, context)?,
            None => simulate(&sample, &field.impact, context)?,
        };
        let folded = field.folded(&record.max_kinetic);
        let within = design.target.on(lattice);
        let mut scores = Scores::of_sites(&folded, &within);
        scores.add_records(&record, &within, |site| field.on(site), 0.5, |sphere| sample.mass(sphere));
        let piece = self.scores(|material| design.price(material));
        (scores.piece_mass, scores.piece_cost, scores.piece_spheres) =
            (piece.piece_mass, piece.piece_cost, piece.piece_spheres);
        let doubts = Doubts::of(&record, &sample, &folded, (design, lattice.diameter()), &within);
        Ok(Evaluation { scores, record, doubts })
    }
}
