//! Quantity by quantity: what each does to each score by itself, and what all do together where that can be said.
//!
//! Scores behind a lens scatter with the force by a percent, so that every piece is judged over eight forces within 1 %, and what is below
//! the scatter of such means counts as not resolved. A quantity with limits is set to both of them. One of chance (diameters within a lot, wrong
//! spheres, holes) is drawn for sixteen pieces: its change is that of their mean, its spread their standard deviation.
//!
//! Of what has a derivative (densities, moduli and yield stresses of materials, the force) the change to the limits, a secant, stands beside what the adjoint
//! says at the piece as drawn. Where both agree the derivative counts, which knows nothing of the limits.

use serde::Serialize;

use super::State;
use super::piece::Piece;
use super::quantity::{Kind, Quantity};
use super::workshop::{Made, Workshop, WorkshopError};
use crate::Context;
use crate::dem::{GradientError, Stop};
use crate::evaluate::{Drawing, EvaluatorError, Forces, MEASURES, SensitivityError, Shared, shared_slopes};
use crate::score::{Measure, geometric};
use crate::stats::Mean;

/// The scores of which sensitivities are told besides those of thresholds.
const JUDGED: [Measure; 3] = [Measure::Contrast, Measure::FocalGain, Measure::Protection];

/// Pieces of chance.
const DRAWN: u64 = 16;

/// What one quantity does to one score.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Change {
    /// Which quantity.
    pub quantity: String,
    /// Which score, by its name.
    pub score: String,
    /// Of the two changes of the score, to the quantity's limits, the greater; of chance that of the mean. In the score's own unit.
    pub change: f64,
    /// Whether the change is proportional to the quantity within its limits, to a fifth of itself and what is not resolved; of chance,
    /// whether the mean stays where it is, to a fifth of the spread.
    pub linear: bool,
    /// The change over the score as drawn.
    pub relative: f64,
    /// The quantity's limits.
    pub limits: [f64; 2],
    /// What the score is there; of chance as drawn, and the mean.
    pub at: [f64; 2],
    /// Standard deviation over pieces of chance.
    pub spread: Option<f64>,
    /// What the change is known to: twice the standard error of the difference of two such means.
    pub noise: f64,
    /// Whether the change is greater than that.
    pub resolved: bool,
    /// The change to the upper limit as the derivative at the piece as drawn says; none of what has no derivative.
    pub by_derivative: Option<f64>,
    /// What is believed of it.
    pub believed: Believed,
}

/// From what the part of a quantity in a score as built is taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Believed {
    /// The derivative: between the limits the score changes as it says.
    Derivative,
    /// The change from limit to limit: there is no derivative, it says something else, or the change is not proportional at all.
    Secant,
    /// The spread over pieces of chance.
    Pieces,
}

impl Believed {
    /// The word.
    pub fn name(self) -> &'static str {
        match self {
            Self::Derivative => "derivative",
            Self::Secant => "secant",
            Self::Pieces => "pieces",
        }
    }
}

/// Whether a derivative's change to the upper limit and half of that from limit to limit are the same: to a fifth of the greater, as a response counts as
/// proportional, or to what the latter is known to.
fn agree(derivative: f64, half: f64, noise: f64) -> bool {
    (derivative - half).abs() <= (0.2 * derivative.abs().max(half.abs())).max(0.5 * noise)
}

/// What each quantity does, worst first for each score.
#[derive(Clone, Debug, PartialEq)]
pub struct Sensitivity {
    /// For each score what it is as drawn, the mean over the forces.
    pub nominal: Vec<(Measure, f64)>,
    /// By score, then by size.
    pub changes: Vec<Change>,
    /// Quantities at a limit of which a guard stopped a piece.
    pub stopped: Vec<String>,
    /// Why there are no derivatives, where some quantity would have one.
    pub no_derivatives: Option<String>,
}

/// A score as built, by root-sum-square.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AsBuilt {
    /// Which score.
    pub score: String,
    /// As drawn.
    pub nominal: f64,
    /// Its standard deviation: √Σ s², s being the change over √3 of a quantity with limits, between which all values are as likely, by what is
    /// [believed](Believed) of it, and the spread of one of chance. None where that would mislead.
    pub rss: Option<f64>,
    /// Why there is none.
    pub refused: Option<String>,
}

/// Runs of one piece over the forces, as one score.
fn mean(runs: &[Made], measure: Measure) -> Option<f64> {
    let values: Option<Vec<f64>> =
        runs.iter().map(|run| run.scores.get(measure).filter(|_| run.stop.is_none())).collect();
    values.map(|values| geometric(&values))
}

/// Measures what each quantity of a workshop does to the scores of a design's verdict and to those in `asked`.
///
/// # Errors
/// See [`WorkshopError`].
pub fn sensitivity(
    workshop: &Workshop,
    asked: &[Measure],
    seed: u64,
    context: &Context,
) -> Result<Sensitivity, WorkshopError> {
    let quantities = workshop.quantities();
    let factors = Forces::USUAL.about(1.0);
    // As drawn, then of each quantity its pieces.
    let mut pieces = vec![Piece::nominal(quantities)];
    let mut parts = Vec::new();
    for (which, quantity) in quantities.iter().enumerate() {
        let begin = pieces.len();
        if quantity.kind.is_random() {
            let drawn = (0..DRAWN).map(|k| Piece::made(quantities, seed ^ 0x7365_6e73, k).seed);
            pieces.extend(drawn.map(|seed| Piece::with(quantities, which, quantity.limits[1], seed)));
        } else {
            pieces.extend(quantity.limits.map(|value| Piece::with(quantities, which, value, 0)));
        }
        parts.push(begin..pieces.len());
    }
    let runs = workshop.runs(&pieces, &factors, context)?;
    let (slopes, no_derivatives) = match slopes(workshop, &factors, context) {
        Ok(slopes) => (slopes, None),
        Err(NoSlopes::Interrupted) => return Err(EvaluatorError::Interrupted.into()),
        Err(NoSlopes::Why(words)) => (Vec::new(), Some(words)),
    };
    let mut measures: Vec<Measure> = JUDGED.to_vec();
    measures.extend(
        asked.iter().filter(|measure| !JUDGED.contains(measure) && workshop.measures().any(|m| m == **measure)),
    );
    let (mut nominal, mut changes, mut stopped) = (Vec::new(), Vec::new(), Vec::new());
    for measure in measures {
        let Some(drawn) = mean(&runs[0], measure) else { continue };
        nominal.push((measure, drawn));
        let values: Vec<f64> = runs[0].iter().filter_map(|run| run.scores.get(measure)).collect();
        let scatter = Mean::of(&values).deviation.unwrap_or(0.0);
        let noise = 2.0 * (2.0 / factors.len() as f64).sqrt() * scatter;
        let mut of_score = Vec::new();
        for (quantity, part) in quantities.iter().zip(&parts) {
            let found: Vec<Option<f64>> = runs[part.clone()].iter().map(|runs| mean(runs, measure)).collect();
            let Some(found) = found.into_iter().collect::<Option<Vec<f64>>>() else {
                if !stopped.contains(&quantity.name) {
                    stopped.push(quantity.name.clone());
                }
                continue;
            };
            let random = quantity.kind.is_random();
            let slope = slopes.iter().find(|of| of.measure == measure).and_then(|of| slope(of, quantity.kind));
            let by_derivative = slope.map(|slope| drawn * slope * quantity.limits[1]);
            let (at, change, linear, spread, noise) = if random {
                let Mean { mean, deviation, .. } = Mean::of(&found);
                let spread = deviation.unwrap_or(0.0);
                let error =
                    2.0 * (spread * spread / found.len() as f64 + scatter * scatter / factors.len() as f64).sqrt();
                let shift = mean - drawn;
                ([drawn, mean], shift, shift.abs() <= error.max(0.2 * spread), Some(spread), error)
            } else {
                let [low, high] = [found[0], found[1]];
                let changes = [low - drawn, high - drawn];
                let change = if changes[0].abs() > changes[1].abs() { changes[0] } else { changes[1] };
                // Where the nominal value lies between the limits, as at a straight line; where it is at one of them, only the way is known.
                let [from, to] = quantity.limits;
                let inside = (quantity.nominal - from) / (to - from);
                let straight = low + inside * (high - low);
                let linear = (0.05..=0.95).contains(&inside)
                    && (straight - drawn).abs() <= 0.2 * 0.5 * (high - low).abs() + noise;
                ([low, high], change, linear || change.abs() <= noise, None, noise)
            };
            of_score.push(Change {
                quantity: quantity.name.clone(),
                score: measure.name().to_owned(),
                change,
                linear,
                relative: change / drawn,
                limits: quantity.limits,
                at,
                spread,
                noise,
                resolved: change.abs().max(spread.unwrap_or(0.0)) > noise,
                believed: match by_derivative {
                    _ if random => Believed::Pieces,
                    Some(slope) if linear && agree(slope, 0.5 * (at[1] - at[0]), noise) => Believed::Derivative,
                    _ => Believed::Secant,
                },
                by_derivative,
            });
        }
        let size = |change: &Change| change.change.abs().max(change.spread.unwrap_or(0.0));
        of_score.sort_by(|a, b| size(b).total_cmp(&size(a)));
        changes.extend(of_score);
    }
    Ok(Sensitivity { nominal, changes, stopped, no_derivatives })
}

/// Why there are no derivatives.
enum NoSlopes {
    Interrupted,
    Why(String),
}

/// Whether a quantity has a derivative.
fn has_slope(quantity: &Quantity) -> bool {
    matches!(quantity.kind, Kind::Density(_) | Kind::Modulus(_) | Kind::YieldStress(_) | Kind::Force)
}

/// The slope of ln of a score by a quantity, where it has one: all are relative.
fn slope(of: &Shared, kind: Kind) -> Option<f64> {
    match kind {
        Kind::Density(material) => Some(of.density[material]),
        Kind::Modulus(material) => Some(of.youngs_modulus[material]),
        Kind::YieldStress(material) => Some(of.yield_stress[material]),
        Kind::Force => of.force,
        _ => None,
    }
}

/// Whether the force is among what may turn out otherwise.
fn has_force(workshop: &Workshop) -> bool {
    workshop.quantities().iter().any(|quantity| quantity.kind == Kind::Force)
}

/// Runs whose derivatives [`sensitivity`] takes: of the piece under each force, and of the uniform crystals too where the force may differ.
pub fn derivative_runs(workshop: &Workshop) -> u64 {
    let crystals = if has_force(workshop) { 3 } else { 1 };
    let wanted = workshop.quantities().iter().any(has_slope) && refusal(workshop).is_none();
    if wanted { (crystals * Forces::USUAL.count()) as u64 } else { 0 }
}

/// Why pieces of a workshop have no derivatives.
fn refusal(workshop: &Workshop) -> Option<&'static str> {
    let drawing = workshop.drawing();
    match workshop.tolerances().state {
        _ if drawing.is_in_space() => Some("derivatives are those of sheets; in space changes are from limit to limit"),
        State::Settled => Some("pieces that have settled are rigs, which have no derivatives"),
        State::NominalSites if drawing.halves_differ() => {
            Some("derivatives are those of a half, and the halves of this piece differ")
        }
        State::NominalSites if drawing.design().impact().projectile().is_some() => {
            Some("derivatives are those under a force pulse")
        }
        State::NominalSites => None,
    }
}

/// Derivatives of all scores that have some, where a quantity wants them.
fn slopes(workshop: &Workshop, factors: &[f64], context: &Context) -> Result<Vec<Shared>, NoSlopes> {
    if !workshop.quantities().iter().any(has_slope) {
        return Ok(Vec::new());
    }
    let why = refusal(workshop);
    let (None, Drawing::Plane(design, subject)) = (why, workshop.drawing()) else {
        return Err(NoSlopes::Why(why.unwrap_or_default().to_owned()));
    };
    // Q has none without what it refers to.
    let exists = |measure: &Measure| *measure != Measure::Protection || design.reference().is_some();
    let measures: Vec<Measure> = MEASURES.into_iter().filter(exists).collect();
    let asked = (&measures[..], factors, has_force(workshop));
    shared_slopes(design, subject.layout, workshop.plan(), asked, context).map_err(|error| match error {
        SensitivityError::Stopped(Stop::Interrupted { .. })
        | SensitivityError::Gradient(GradientError::Stopped(Stop::Interrupted { .. })) => NoSlopes::Interrupted,
        error => NoSlopes::Why(error.to_string()),
    })
}

/// Each score as built.
pub fn as_built(sensitivity: &Sensitivity) -> Vec<AsBuilt> {
    let of = |&(measure, nominal): &(Measure, f64)| {
        let score = measure.name().to_owned();
        let own = || sensitivity.changes.iter().filter(|change| change.score == score);
        let bent: Vec<&str> = own().filter(|change| !change.linear).map(|change| change.quantity.as_str()).collect();
        let refused = match (&sensitivity.stopped[..], &bent[..]) {
            ([], []) => None,
            ([], bent) => Some(format!("not proportional to {}: see the yield instead", bent.join(", "))),
            (stopped, _) => Some(format!("a guard stopped pieces at a limit of {}", stopped.join(", "))),
        };
        let square = |change: &Change| {
            let secant = 0.5 * (change.at[1] - change.at[0]);
            let half = change.by_derivative.filter(|_| change.believed == Believed::Derivative).unwrap_or(secant);
            let part = change.spread.unwrap_or(half / 3.0_f64.sqrt());
            part * part
        };
        let rss = refused.is_none().then(|| own().map(square).sum::<f64>().sqrt());
        AsBuilt { score, nominal, rss, refused }
    };
    sensitivity.nominal.iter().map(of).collect()
}
