//! What a study has come to, in words.

use std::fmt::Write as _;

use granulens::study::{
    BaselineScores, Ended, Fabric, Found, GlanceState, Loses, Quantiles, Spread, StageState, State, Summary,
};
use granulens::units::Dimension::Time;

/// What a study has come to.
pub fn words(state: &State) -> String {
    let mut text = format!("{} evaluations, {} stopped by a guard, ", state.evaluations, state.stopped);
    text.push_str(match state.ended {
        Ended::Budget => "the budget is used up\n",
        Ended::NothingNew => "nothing new within reach\n",
        Ended::Time => "the time is over\n",
        Ended::Interrupted => "interrupted\n",
    });
    if state.stages.len() > 1 {
        for stage in &state.stages {
            let best = stage.best.as_ref().map_or_else(|| "-".to_owned(), scores);
            let missed = if stage.within_limits { "" } else { "  (misses a limit)" };
            let StageState { method, evaluations, .. } = stage;
            let _ = writeln!(text, "  {method:13} {:>8} {evaluations:>7}  {best}{missed}", Time.show(stage.step));
        }
    }
    if let Some(start) = &state.start {
        let _ = writeln!(text, "start  {}", scores(&start.summary));
    }
    if let Some(best) = state.found() {
        let name = if best.within_limits { "best  " } else { "none within the limits; the nearest to them" };
        let _ = writeln!(text, "{name} {}", scores(&best.summary));
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
    for glance in &state.glances {
        if let Some(correlation) = glance.rank_correlation {
            let GlanceState { name, shared, .. } = glance;
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
        if let Some(knee) = front.knee.and_then(|knee| front.layouts.get(knee)) {
            let _ = writeln!(text, "  knee {}", scores(&knee.summary));
        }
    }
    if let Some(loses) = &state.tolerance {
        text.push_str(&loses_words(loses));
    }
    state.baselines.iter().for_each(|baseline| text.push_str(&baseline_words(baseline)));
    text
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
fn loses_words(loses: &Loses) -> String {
    let show = |quantiles: Option<Quantiles>| {
        let percent = |Quantiles { median, ninety }| format!("{:.1} % ({:.1} %)", 100.0 * median, 100.0 * ninety);
        quantiles.map_or_else(|| "-".to_owned(), percent)
    };
    let Loses { crystals, stopped, contrast, focal_gain, protection } = *loses;
    format!(
        "built otherwise than drawn, {crystals} crystals, {stopped} stopped: median loss (90 %) C {}  G {}  Q {}\n",
        show(contrast),
        show(focal_gain),
        show(protection)
    )
}

fn remarks(best: &Found) -> String {
    let limits = if best.within_limits { "within the limits" } else { "MISSES A LIMIT" };
    let proof = match (best.one_opt, best.two_opt) {
        (_, true) => "; no change of one or two spheres improves it (2-opt)",
        (true, _) => "; no flip of one sphere improves it (1-opt)",
        _ => "",
    };
    let Fabric { spheres, lone, .. } = best.summary.fabric;
    format!("evaluation {}, {limits}{proof}; {spheres} spheres not of the host, {lone} alone", best.evaluation)
}

pub fn scores(summary: &Summary) -> String {
    let show = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |value| format!("{value:.4}"));
    format!("C {}  G {}  Q {}", show(summary.contrast), show(summary.focal_gain), show(summary.protection))
}
