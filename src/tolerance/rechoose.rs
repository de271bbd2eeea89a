//! What it wins to measure all spheres of a piece and to take others in place of the worst.
//!
//! A sphere that is too small leaves gaps, which matter where the wave is weak: contacts there are pressed together by little. So spheres are ranked by what
//! they lack of the largest, over the square root of the greatest kinetic energy at their site as drawn, to which the overlap of a plastic contact is
//! proportional. The worst are exchanged for as many new ones of their lots, the largest for the worst, where these are larger.

use serde::Serialize;

use super::Kind;
use super::criterion::Criterion;
use super::piece::{Piece, largest};
use super::workshop::{Made, Workshop, WorkshopError};
use super::yields::Share;
use crate::score::{Measure, Scores};
use crate::search::Rng;
use crate::stats::Mean;
use crate::{Context, Progress};

/// Pieces by which it is judged.
const PIECES: u64 = 64;

/// Pieces before and after.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Rechosen {
    /// Spheres that were exchanged in each piece.
    pub spheres: usize,
    /// Pieces.
    pub pieces: u64,
    /// Mean C of the pieces before and after.
    pub contrast: [f64; 2],
    /// What one piece wins in C, and half of the 95 % interval of that mean.
    pub win: [f64; 2],
    /// How many keep what is asked, before and after.
    #[serde(rename = "yield")]
    pub share: [Share; 2],
}

/// Exchanges so many spheres in each of some pieces; `energy` is the greatest kinetic energy at each site, or place, as drawn (J).
///
/// # Errors
/// See [`WorkshopError`].
pub fn rechoose(
    workshop: &Workshop,
    criterion: &Criterion,
    (spheres, seed): (usize, u64),
    (of_layout, energy): (&Scores, &[f64]),
    context: &Context,
) -> Result<Rechosen, WorkshopError> {
    let (drawing, tolerances) = (workshop.drawing(), workshop.tolerances());
    let quantities = workshop.quantities();
    let variation =
        quantities.iter().find(|quantity| quantity.kind == Kind::Lot).map_or(0.0, |quantity| quantity.limits[1]);
    let mut cases = Vec::new();
    for k in 0..PIECES {
        let piece = Piece::made(quantities, seed, k);
        let (mut diameters, materials, _) = piece.parts(tolerances, quantities, drawing);
        cases.push(piece.case_of(tolerances, quantities, drawing, 1.0, &diameters));
        let largest = largest(drawing, &diameters);
        let need = |place: usize| (largest - diameters[place]) / energy[place % energy.len()].max(1e-12).sqrt();
        let mut order: Vec<usize> =
            (0..diameters.len()).filter(|&place| diameters[place] > 0.0 && drawing.stands(place)).collect();
        order.sort_by(|&a, &b| need(b).total_cmp(&need(a)));
        let mut rng = Rng::new(piece.seed ^ 0x7265_6368);
        // New ones of each lot, as many as are exchanged of it.
        let worst = &order[..spheres.min(order.len())];
        let nominal = drawing.design().diameter();
        let offset = |m: u8| {
            let of = quantities.iter().position(|quantity| quantity.kind == Kind::Offset(usize::from(m)));
            of.map_or(0.0, |which| piece.values[which])
        };
        for letter in 0..drawing.palette().len() as u8 {
            let places: Vec<usize> = worst.iter().copied().filter(|&place| materials[place] == letter).collect();
            let mut fresh: Vec<f64> =
                places.iter().map(|_| nominal + offset(letter) + variation * (rng.unit() - 0.5)).collect();
            fresh.sort_by(|a, b| b.total_cmp(a));
            for (place, new) in places.into_iter().zip(fresh) {
                diameters[place] = diameters[place].max(new);
            }
        }
        cases.push(piece.case_of(tolerances, quantities, drawing, 1.0, &diameters));
    }
    let runs = workshop.cases(&cases, context)?;
    context.tell(Progress::Finished { count: 2 * PIECES, name: "" });
    let contrast = |made: &Made| made.scores.get(Measure::Contrast).filter(|_| made.stop.is_none()).unwrap_or(0.0);
    let [before, after]: [Vec<&Made>; 2] = [0, 1].map(|k| runs.iter().skip(k).step_by(2).collect());
    let mean = |all: &[&Made]| all.iter().map(|made| contrast(made)).sum::<f64>() / all.len() as f64;
    let wins: Vec<f64> = before.iter().zip(&after).map(|(a, b)| contrast(b) - contrast(a)).collect();
    let Mean { mean: win, interval, .. } = Mean::of(&wins);
    let share = |all: &[&Made]| {
        let does = all.iter().filter(|made| made.stop.is_none() && criterion.admits(&made.scores, of_layout));
        Share::of(does.count() as u64, all.len() as u64)
    };
    Ok(Rechosen {
        spheres,
        pieces: PIECES,
        contrast: [mean(&before), mean(&after)],
        win: [win, interval.unwrap_or(0.0)],
        share: [share(&before), share(&after)],
    })
}

impl Rechosen {
    /// In words.
    pub fn words(&self) -> String {
        let Self { spheres, pieces, contrast: [before, after], win: [win, half], share } = self;
        format!(
            "{spheres} spheres measured and chosen anew in each of {pieces} pieces: C {before:.4} before, {after:.4} after ({win:+.4} +- {half:.4}); \
             yield {} before, {} after\n",
            share[0].words(),
            share[1].words()
        )
    }
}
