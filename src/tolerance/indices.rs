//! Which quantities matter anywhere within the limits, and which only together with others: elementary effects.
//!
//! Sampler: M. D. Morris, Technometrics 33, 161 (1991): each quantity's limits are cut into a grid of four levels; a trajectory begins at a
//! random point of the grid and changes one quantity after the other, in random order, by Δ = 2/3 of its limits. μ* is the mean of the absolute
//! changes over Δ (F. Campolongo and others, Environ. Model. Softw. 22, 1509, 2007), σ their standard deviation: a σ as great as μ* means
//! that the effect depends on where the others are. Intervals are of 95 %, by resampling trajectories. Chance keeps its random numbers along a
//! trajectory and differs from one to the next.

use serde::Serialize;

use super::piece::Piece;
use super::workshop::{Made, Workshop, WorkshopError};
use crate::Context;
use crate::evaluate::Forces;
use crate::score::{Measure, geometric};
use crate::search::Rng;
use crate::stats::Mean;

/// Trajectories.
const TRAJECTORIES: u64 = 12;
/// Times that these are resampled.
const RESAMPLED: usize = 1000;
const DELTA: f64 = 2.0 / 3.0;

/// The indices of one quantity for one score.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Index {
    /// Which quantity.
    pub quantity: String,
    /// Which score.
    pub score: &'static str,
    /// μ*, over the score as drawn: by how much it changes while the quantity goes from one limit to the other.
    pub mu_star: f64,
    /// Its interval.
    pub interval: [f64; 2],
    /// σ, likewise.
    pub sigma: f64,
}

/// How many pieces that takes, each under eight forces.
pub fn indices_runs(workshop: &Workshop) -> usize {
    1 + TRAJECTORIES as usize * (1 + workshop.quantities().len())
}

/// Elementary effects of all quantities on C, G and Q, over eight forces.
///
/// # Errors
/// See [`WorkshopError`].
pub fn indices(workshop: &Workshop, seed: u64, context: &Context) -> Result<Vec<Index>, WorkshopError> {
    let quantities = workshop.quantities();
    let mut rng = Rng::new(seed ^ 0x6d6f_7272_6973);
    let mut pieces = vec![Piece::nominal(quantities)];
    // Of each trajectory the order in which quantities change, and the sign.
    let mut ways: Vec<Vec<(usize, f64)>> = Vec::new();
    for _ in 0..TRAJECTORIES {
        let chance = rng.bits();
        // Two of the four levels lie below the middle; from there a change goes up, from above down.
        let mut at: Vec<f64> = quantities.iter().map(|_| rng.below(4) as f64 / 3.0).collect();
        let mut order: Vec<usize> = (0..quantities.len()).collect();
        for k in (1..order.len()).rev() {
            order.swap(k, rng.below(k as u64 + 1) as usize);
        }
        let piece = |at: &[f64]| {
            let value = |(quantity, part): (&super::Quantity, &f64)| {
                quantity.limits[0] + part * (quantity.limits[1] - quantity.limits[0])
            };
            Piece { values: quantities.iter().zip(at).map(value).collect(), seed: chance }
        };
        pieces.push(piece(&at));
        let mut way = Vec::new();
        for which in order {
            let sign = if at[which] < 0.5 { 1.0 } else { -1.0 };
            at[which] += sign * DELTA;
            pieces.push(piece(&at));
            way.push((which, sign));
        }
        ways.push(way);
    }
    let runs = workshop.runs(&pieces, &Forces::USUAL.about(1.0), context)?;
    let mut all = Vec::new();
    for measure in [Measure::Contrast, Measure::FocalGain, Measure::Protection] {
        let score = |runs: &[Made]| {
            let values: Vec<f64> =
                runs.iter().filter(|run| run.stop.is_none()).filter_map(|run| run.scores.get(measure)).collect();
            (!values.is_empty()).then(|| geometric(&values))
        };
        let Some(drawn) = score(&runs[0]) else { continue };
        // By trajectory and quantity.
        let mut effects = vec![vec![0.0; quantities.len()]; ways.len()];
        for (t, way) in ways.iter().enumerate() {
            let begin = 1 + t * (1 + quantities.len());
            for (k, &(which, sign)) in way.iter().enumerate() {
                let pair = [score(&runs[begin + k]), score(&runs[begin + k + 1])];
                if let [Some(before), Some(after)] = pair {
                    effects[t][which] = sign * (after - before) / (DELTA * drawn);
                }
            }
        }
        let mut of_score = Vec::new();
        for (which, quantity) in quantities.iter().enumerate() {
            let own: Vec<f64> = effects.iter().map(|effects| effects[which]).collect();
            let mu_star = own.iter().map(|effect| effect.abs()).sum::<f64>() / own.len() as f64;
            let mut means: Vec<f64> = (0..RESAMPLED)
                .map(|_| {
                    (0..own.len()).map(|_| own[rng.below(own.len() as u64) as usize].abs()).sum::<f64>()
                        / own.len() as f64
                })
                .collect();
            means.sort_by(f64::total_cmp);
            let at = |part: f64| super::quantile(&means, part).unwrap_or(mu_star);
            of_score.push(Index {
                quantity: quantity.name.clone(),
                score: measure.name(),
                mu_star,
                interval: [at(0.025), at(0.975)],
                sigma: Mean::of(&own).deviation.unwrap_or(0.0),
            });
        }
        of_score.sort_by(|a, b| b.mu_star.total_cmp(&a.mu_star));
        all.extend(of_score);
    }
    Ok(all)
}

/// As a table.
pub fn indices_words(found: &[Index]) -> String {
    let mut text = "| score | quantity | mu* | 95 % | sigma |\n|---|---|---|---|---|\n".to_owned();
    for Index { quantity, score, mu_star, interval: [low, high], sigma } in found {
        let [mu_star, low, high, sigma] = [mu_star, low, high, sigma].map(|part| 100.0 * part);
        text += &format!("| {score} | {quantity} | {mu_star:.1} % | {low:.1} to {high:.1} % | {sigma:.1} % |\n");
    }
    text
}
