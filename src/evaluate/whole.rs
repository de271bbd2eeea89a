//! A piece whose halves differ: what it is beside its right half, and its evaluation as a whole.

use std::sync::atomic::AtomicBool;

use super::blow::{Blow, Field, Flaw};
use super::{Doubts, EvaluateError, Evaluation, Plan};
use crate::dem::{simulate, simulate_with_friction};
use crate::design::Design;
use crate::layout::{Bill, Layout};
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

impl Subject<'_> {
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
    pub fn evaluate(&self, design: &Design, plan: &Plan, interrupt: &AtomicBool) -> Result<Evaluation, EvaluateError> {
        let Some(left) = self.left else { return super::evaluate(design, self.layout, plan, interrupt) };
        let field = Field::new(design, plan, &Blow::from(design.impact), true);
        let lattice = &self.layout.lattice;
        // The places of the other side stand behind those of the half.
        let both = [&self.layout.materials[..], left].concat();
        let sample = field.sample(&self.layout.palette, lattice.diameter(), &both, &Flaw::default());
        let record = match field.friction {
            Some(coefficient) => simulate_with_friction(&sample, &field.impact, coefficient, interrupt)?,
            None => simulate(&sample, &field.impact, interrupt)?,
        };
        let folded = field.folded(&record.max_kinetic);
        let within = (lattice, &design.target);
        let mut scores = Scores::of_energies(&folded, within.0, within.1);
        scores.add_records(&record, within, |site| field.on(site), 0.5, |sphere| sample.mass(sphere));
        let piece = self.piece(|material| design.price(material)).amount;
        (scores.piece_mass, scores.piece_cost, scores.piece_spheres) =
            (Some(piece.mass), piece.cost, Some(piece.spheres));
        let doubts = Doubts::of(&record, &sample, &folded, design);
        Ok(Evaluation { scores, record, doubts })
    }
}
