//! A layout and the design by which it is judged, of a sheet or of a crystal in space: what a workshop is given, and what is asked of either kind.

use super::{
    Comparison, EvaluatorError, Forces, ImpactLoad, Overrides, Plan, PlanError, SpaceComparison, Subject, add_piece,
    common_plan, judged, judged_in_space,
};
use crate::Context;
use crate::dem::Strike;
use crate::design::{Design, DesignRef, SpaceDesign};
use crate::lattice::Block;
use crate::layout::Layout;
use crate::material::Material;
use crate::outcome::Verdict;
use crate::score::Scores;

/// A layout under its design.
#[derive(Clone, Copy, Debug)]
pub enum Drawing<'a> {
    /// Of a sheet, whose halves may be drawn differently.
    Plane(&'a Design, Subject<'a>),
    /// Of a crystal in space, whose halves are each other's image as drawn.
    Space(&'a SpaceDesign, &'a Layout<Block>),
}

impl<'a> From<(&'a Design, Subject<'a>)> for Drawing<'a> {
    fn from((design, subject): (&'a Design, Subject<'a>)) -> Self {
        Self::Plane(design, subject)
    }
}

impl<'a> From<(&'a SpaceDesign, &'a Layout<Block>)> for Drawing<'a> {
    fn from((design, layout): (&'a SpaceDesign, &'a Layout<Block>)) -> Self {
        Self::Space(design, layout)
    }
}

impl<'a> Drawing<'a> {
    /// The design.
    pub fn design(self) -> DesignRef<'a> {
        match self {
            Self::Plane(design, _) => design.into(),
            Self::Space(design, _) => design.into(),
        }
    }

    /// Whether it is a crystal in space.
    pub fn is_in_space(self) -> bool {
        matches!(self, Self::Space(..))
    }

    /// The materials that may occur.
    pub fn palette(self) -> &'a [Material] {
        match self {
            Self::Plane(_, subject) => &subject.layout.palette,
            Self::Space(_, layout) => &layout.palette,
        }
    }

    /// Sites of the half.
    pub fn sites(self) -> usize {
        match self {
            Self::Plane(_, subject) => subject.layout.materials.len(),
            Self::Space(_, layout) => layout.materials.len(),
        }
    }

    /// Whether a sphere of its own stands on a place, a site of the half or, behind these, a site's image: one on the axis is its own, and between periods one on the far
    /// rim.
    pub fn stands(self, place: usize) -> bool {
        let Some(site) = place.checked_sub(self.sites()) else { return true };
        match self {
            Self::Plane(_, subject) => subject.layout.lattice.sites()[site].x > 0.0,
            Self::Space(_, layout) => layout.lattice.copies()[site] == 2,
        }
    }

    /// The material of every site of the half; where the halves are drawn differently, behind them those of the sites' images.
    pub fn materials(self) -> Vec<u8> {
        match self {
            Self::Plane(_, subject) => subject.drawn(),
            Self::Space(_, layout) => layout.materials.clone(),
        }
    }

    /// The materials, places in the palette, that occur.
    pub fn letters(self) -> Vec<u8> {
        let held = self.materials();
        (0..self.palette().len() as u8).filter(|letter| held.contains(letter)).collect()
    }

    /// Whether its halves are drawn differently.
    pub fn halves_differ(self) -> bool {
        matches!(self, Self::Plane(_, Subject { left: Some(_), .. }))
    }

    /// What it says by itself: counts, masses and costs.
    pub fn scores(self) -> Scores {
        match self {
            Self::Plane(design, subject) => subject.scores(|material| design.price(material)),
            Self::Space(design, layout) => {
                let mut scores = Scores::default();
                add_piece(&mut scores, design, layout);
                scores
            }
        }
    }

    /// Step and window for it alone.
    ///
    /// # Errors
    /// See [`PlanError`].
    pub fn plan(self, overrides: Overrides) -> Result<Plan, PlanError> {
        self.plan_under(&[], overrides)
    }

    /// Step and window for it under the design's impact and in space, where all that strikes acts in lanes, under others too.
    ///
    /// # Errors
    /// See [`PlanError`].
    pub fn plan_under(self, others: &[Strike], overrides: Overrides) -> Result<Plan, PlanError> {
        match self {
            Self::Plane(design, subject) => Plan::new(design, overrides, &subject.layout.palette),
            Self::Space(design, layout) => {
                // What Q refers to is simulated beside it.
                let mut palette = layout.palette.clone();
                palette.extend(design.reference().filter(|material| !layout.palette.contains(material)).cloned());
                let loads: Vec<ImpactLoad> =
                    std::iter::once(design.impact).chain(others.iter().copied()).map(ImpactLoad::from).collect();
                common_plan(design, &loads, overrides, &palette)
            }
        }
    }

    /// The verdict of `compare` over the usual forces.
    ///
    /// # Errors
    /// See [`EvaluatorError`].
    pub fn verdict(self, overrides: Overrides, context: &Context) -> Result<Vec<Verdict>, EvaluatorError> {
        let name = "layout".to_owned();
        match self {
            Self::Plane(design, subject) => {
                judged(&Comparison::of_layout(design, name, subject, overrides)?.over(Forces::USUAL), context)
            }
            Self::Space(design, layout) => {
                let comparison = SpaceComparison::of_layout(design, name, layout.clone(), overrides)?;
                judged_in_space(&comparison.over(Forces::USUAL), context)
            }
        }
    }
}
