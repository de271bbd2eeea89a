//! What a study has come to, in words.

use std::fmt::Write as _;

use granulens::evaluate::Forces;
use granulens::score::{Measure, Scores, Spreads};
use granulens::study::{
    BaselineScores, Ended, Final, Found, Quantiles, Robustness, Spread, StageState, State, SurrogateState,
};
use granulens::units::Dimension::{Fraction, Time};

/// What a study has come to.
pub fn words(state: &State) -> String {
    let mut text = format!("{} evaluations, {} stopped by a guard, ", state.evaluations, state.stopped);
    text.push_str(match state.ended {
        Ended::Budget => "the budget is used up\n",
        Ended::NothingNew => "nothing new within reach\n",
        Ended::Time => "the time is over\n",
        Ended::Interrupted => "interrupted\n",
        Ended::Asked => "more are asked for\n",
    });
    if state.stages.len() > 1 {
        for stage in &state.stages {
            let best = stage.best.as_ref().map_or_else(|| "-".to_owned(), |best| scores(best, None));
            let missed = if stage.within_limits { "" } else { "  (misses a limit)" };
            let StageState { method, evaluations, .. } = stage;
            let judged = if stage.judged > 0 { format!("  ({} of them judged)", stage.judged) } else { String::new() };
            let step = Time.show(stage.step);
            let _ = writeln!(text, "  {method:13} {step:>8} {evaluations:>7}  {best}{missed}{judged}");
        }
    }
    if let Some(start) = &state.start {
        let _ = writeln!(text, "start  {}", of(start));
    }
    if let Some(best) = state.found() {
        let name = if best.within_limits { "best  " } else { "none within the limits; the nearest to them" };
        let _ = writeln!(text, "{name} {}", of(best));
        let _ = writeln!(text, "       {}", remarks(best));
    }
    if state.rungs.len() > 1 {
        for rung in &state.rungs {
            if let Some(correlation) = rung.rank_correlation {
                let step = Time.show(rung.step);
                let _ = writeln!(
                    text,
                    "step {step}: rank correlation with the finest {correlation:.3}, over {} layouts",
                    rung.shared
                );
            }
        }
    }
    for surrogate in &state.glances {
        if let Some(correlation) = surrogate.rank_correlation {
            let SurrogateState { name, shared, .. } = surrogate;
            let _ = writeln!(
                text,
                "{name}, without a simulation: rank correlation with the finest {correlation:.3}, over {shared} layouts"
            );
        }
    }
    if let Some(front) = &state.front {
        let volume = front.hypervolume.map_or_else(|| "-".to_owned(), |volume| format!("{volume:.4}"));
        let _ = writeln!(
            text,
            "front of {} with {} layouts, hypervolume against the start {volume}",
            front.measures.join(" and "),
            front.layouts.len()
        );
        let traded: Vec<Measure> = front.measures.iter().filter_map(|name| Measure::find(name)).collect();
        for (place, found) in front.layouts.iter().enumerate() {
            let value = |measure: &Measure| {
                let value = found.scores.get(*measure).unwrap_or(f64::NAN);
                format!("{} {value:.4}", measure.symbol()).trim_end().to_owned()
            };
            let values: Vec<String> = traded.iter().map(value).collect();
            let knee = if front.knee == Some(place) { "  (knee)" } else { "" };
            let _ = writeln!(text, "  place {:3}  {}{knee}", place + 1, values.join("  "));
        }
    }
    if let Some(loses) = &state.tolerance {
        text.push_str(&loses_words(loses));
    }
    for figures in &state.finals {
        text.push_str(&final_words(figures));
    }
    if let Some(strip) = best_strip(&state.baselines) {
        let gain = state.found().and_then(|found| found.scores.focal_gain);
        let gain = gain.map_or_else(|| "-".to_owned(), |gain| format!("{gain:.4}"));
        let _ = writeln!(text, "G {gain}; of uniform strips over the same rows the most is that of {strip}");
    }
    state.baselines.iter().for_each(|baseline| text.push_str(&baseline_words(baseline)));
    text
}

/// Two lines: at the force itself, and over forces about it.
fn final_words(figures: &Final) -> String {
    let Final { step, window, exact, smoothed, scatter } = figures;
    let each = [Measure::Contrast, Measure::FocalGain, Measure::Protection];
    let smoothed: Vec<String> = each
        .iter()
        .zip(scatter)
        .filter_map(|(measure, scatter)| {
            let scatter = scatter.map_or(String::new(), |scatter| format!(" ± {scatter:.4}"));
            Some(format!("{} {:.4}{scatter}", measure.symbol(), smoothed.get(*measure)?))
        })
        .collect();
    let (forces, band) = (Forces::USUAL.count(), Fraction.show(Forces::USUAL.band()));
    format!(
        "at {} to {}, the force itself   {}\n  over {forces} forces within {band}   {}\n",
        Time.show(*step),
        Time.show(*window),
        scores(exact, None),
        smoothed.join("  ")
    )
}

/// G and Q of the strip with the most G, and its name: what there is for nothing.
fn best_strip(baselines: &[BaselineScores]) -> Option<String> {
    let gain = |baseline: &BaselineScores| baseline.focal_gain.map_or(f64::NEG_INFINITY, |gain| gain.mean);
    let strips = baselines.iter().filter(|baseline| baseline.name.starts_with("strip-"));
    let best = strips.max_by(|a, b| gain(a).total_cmp(&gain(b)))?;
    let protection = best.protection.map_or_else(|| "-".to_owned(), |q| format!("{:.4}", q.mean));
    Some(format!("{}, G {:.4}, Q {protection}", best.name, gain(best)))
}

/// A line for a baseline: means with their 95 % confidence intervals where several seeds were taken.
fn baseline_words(baseline: &BaselineScores) -> String {
    let show = |spread: &Option<Spread>| match spread {
        None => "-".to_owned(),
        Some(Spread { mean, half_width: None, .. }) => format!("{mean:.4}"),
        Some(Spread { mean, half_width: Some(half_width), .. }) => format!("{mean:.4}±{half_width:.4}"),
    };
    let BaselineScores { name, contrast, focal_gain, protection, .. } = baseline;
    format!("  {name:22} C {}  G {}  Q {}\n", show(contrast), show(focal_gain), show(protection))
}

/// What is lost by half and by nine tenths of the crystals that are not as drawn, at most.
fn loses_words(loses: &Robustness) -> String {
    let show = |quantiles: Option<Quantiles>| {
        let percent = |Quantiles { median, ninety }| format!("{:.1} % ({:.1} %)", 100.0 * median, 100.0 * ninety);
        quantiles.map_or_else(|| "-".to_owned(), percent)
    };
    let Robustness { crystals, stopped, contrast, focal_gain, protection } = *loses;
    format!(
        "built otherwise than drawn, {crystals} crystals, {stopped} stopped: median loss (90 %) C {}  G {}  Q {}\n",
        show(contrast),
        show(focal_gain),
        show(protection)
    )
}

fn remarks(best: &Found) -> String {
    let limits = if best.within_limits { "within the limits" } else { "MISSES A LIMIT" };
    let local_optimality = match (best.one_opt, best.two_opt) {
        (_, true) => "; no change of one or two spheres improves it (2-opt)",
        (true, _) => "; no flip of one sphere improves it (1-opt)",
        _ => "",
    };
    let count = |measure: Measure| best.scores.get(measure).unwrap_or_default();
    format!(
        "evaluation {}, {limits}{local_optimality}; {} spheres of the piece not of the host; in the half {} touch none of their material",
        best.evaluation,
        count(Measure::PieceSpheres),
        count(Measure::Lone)
    )
}

/// C, G and Q of a layout that was found, with the spread of a single force's where there are several.
pub fn of(found: &Found) -> String {
    // Of several impacts each has a spread of its own.
    let spread = match &found.entry.over_forces[..] {
        [one] => Some(one),
        _ => None,
    };
    scores(&found.scores, spread)
}

/// C, G and Q.
fn scores(scores: &Scores, spreads: Option<&Spreads>) -> String {
    let show = |measure: Measure| {
        let spread = spreads.and_then(|spreads| spreads.deviation(measure));
        let spread = spread.map_or(String::new(), |spread| format!(" ± {spread:.4}"));
        scores.get(measure).map_or_else(|| "-".to_owned(), |value| format!("{value:.4}{spread}"))
    };
    let each = [Measure::Contrast, Measure::FocalGain, Measure::Protection];
    each.map(|measure| format!("{} {}", measure.symbol(), show(measure))).join("  ")
}
