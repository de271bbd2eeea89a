//! The other way round: how coarse a grade, how much friction, how many wrong spheres leave a wanted share of pieces.
//!
//! Pieces of all rungs have the same random numbers, so that they differ by the rung alone.

use serde::Serialize;

use super::Tolerances;
use super::criterion::Criterion;
use super::grade::GRADES;
use super::samples::Samples;
use super::workshop::{Workshop, WorkshopError};
use super::yields::Share;
use crate::score::Scores;
use crate::{Context, Progress};

/// A rung that was tried.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Rung {
    /// The grade, the coefficient, or the part of wrong spheres.
    pub value: String,
    /// How many pieces keep what is asked.
    #[serde(flatten)]
    pub share: Share,
}

/// What one tolerance may be.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Inverse {
    /// Which: `diameter.grade`, `friction` or `wrong`.
    pub quantity: &'static str,
    /// The coarsest rung whose share of pieces is as wanted, of those that were made; none where the finest is not.
    pub most: Option<String>,
    /// The coarsest that is so surely: the whole of its interval is.
    pub surely: Option<String>,
    /// The rungs that were tried, from the finest on.
    pub tried: Vec<Rung>,
}

/// Coefficients of friction: lubricated to dry.
const FRICTION: [f64; 8] = [0.0, 0.02, 0.05, 0.1, 0.15, 0.2, 0.3, 0.5];
/// Parts of wrong spheres.
const WRONG: [f64; 9] = [0.0, 0.0002, 0.0005, 0.001, 0.002, 0.005, 0.01, 0.02, 0.05];

/// What is changed, and what its rungs are called.
fn ladders(tolerances: &Tolerances, in_space: bool) -> Vec<(&'static str, Vec<(String, Tolerances)>)> {
    let any = tolerances
        .grade
        .is_some_and(|grade| tolerances.offset == grade.any_gauge && grade.any_gauge != grade.one_gauge);
    let with = |change: &dyn Fn(&mut Tolerances)| {
        let mut changed = tolerances.clone();
        change(&mut changed);
        changed
    };
    let grades = GRADES.iter().map(|grade| (grade.name.to_owned(), with(&|t| t.take(grade, any)))).collect();
    let friction = FRICTION.iter().map(|&mu| (format!("{mu}"), with(&|t| t.friction = Some([mu; 2])))).collect();
    let wrong = WRONG.iter().map(|&part| (format!("{} %", 100.0 * part), with(&|t| t.wrong = part))).collect();
    let mut all = vec![("diameter.grade", grades), ("friction", friction), ("wrong", wrong)];
    // Crystals in space know no friction.
    all.retain(|&(quantity, _)| !in_space || quantity != "friction");
    all
}

/// Finds for each of them, all others as they are, the coarsest rung with at least `wanted` of the pieces, by halving.
///
/// # Errors
/// See [`WorkshopError`].
pub fn inverse(
    workshop: &Workshop,
    criterion: &Criterion,
    (wanted, count, seed): (f64, u64, u64),
    of_layout: &Scores,
    context: &Context,
) -> Result<Vec<Inverse>, WorkshopError> {
    let mut all = Vec::new();
    for (quantity, rungs) in ladders(workshop.tolerances(), workshop.drawing().is_in_space()) {
        let mut known: Vec<Option<Share>> = vec![None; rungs.len()];
        let mut look = |k: usize| -> Result<Share, WorkshopError> {
            if let Some(share) = known[k] {
                return Ok(share);
            }
            let shop = Workshop::new(workshop.drawing(), &rungs[k].1, workshop.plan(), &criterion.measures())?;
            let mut samples = Samples::new(&shop, seed);
            samples.grow(&shop, count, &context.silent(), |_| Ok::<_, WorkshopError>(()))?;
            context.tell(Progress::Finished { count, name: "" });
            let share = samples.share(count as usize, criterion, of_layout);
            known[k] = Some(share);
            Ok(share)
        };
        // Between a rung that does and one that does not; shares fall from rung to rung, but for chance.
        let (mut does, mut not) = (None, rungs.len());
        if look(0)?.share >= wanted {
            does = Some(0);
            while not > does.unwrap_or(0) + 1 {
                let middle = does.unwrap_or(0).midpoint(not);
                if look(middle)?.share >= wanted { does = Some(middle) } else { not = middle }
            }
        }
        let surely = (0..rungs.len()).rev().find(|&k| known[k].is_some_and(|share| share.interval[0] >= wanted));
        let name = |k: usize| rungs[k].0.clone();
        let tried = known.iter().enumerate().filter_map(|(k, share)| Some(Rung { value: name(k), share: (*share)? }));
        all.push(Inverse { quantity, most: does.map(name), surely: surely.map(name), tried: tried.collect() });
    }
    Ok(all)
}

/// In words.
pub fn inverse_words(found: &[Inverse], wanted: f64) -> String {
    let mut text = String::new();
    for Inverse { quantity, most, surely, tried } in found {
        let wanted = 100.0 * wanted;
        text += &match (most, surely) {
            (Some(most), Some(surely)) => {
                format!("{quantity} for {wanted} % of pieces: up to {most}, surely up to {surely}")
            }
            (Some(most), None) => format!("{quantity} for {wanted} % of pieces: up to {most}, none surely"),
            (None, _) => format!("{quantity} for {wanted} % of pieces: none will do"),
        };
        let tried: Vec<String> = tried.iter().map(|rung| format!("{}: {}", rung.value, rung.share.words())).collect();
        text += &format!(" ({})\n", tried.join("; "));
    }
    text
}
