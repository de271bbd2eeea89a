//! Chapter 6: the lens in three dimensions that figure 6.1 announces; nobody has published one.

use super::Wanted::Above;
use super::{Part, Row, RowError, Verdict};
use crate::Context;
use crate::design::SpaceDesign;
use crate::evaluate::{EvaluatorError, Forces, Overrides, SpaceComparison, compare_in_space};
use crate::outcome::ArrangementOutcome;
use crate::score::Measure;

const REASON: &str = "to focus is to send more to the focus than past it, and more than the host alone does; a lens that is worth building does \
                      more than every flat strip of the same material";

pub(super) const ROWS: &[Row] = &[
    Row {
        id: "6.1-small",
        claim: "an impact lens focuses in three dimensions: a plano-convex one of brass, revolved, in 24 layers of 14 x 16 spheres of 440c",
        source: "fig. 6.1, an outlook",
        reason: REASON,
        formula: false,
        expected: Verdict::HoldsInPart,
        seconds: 6.0,
        measure: |context| lens(include_str!("../../designs/space/revolved-lens.toml"), context),
    },
    Row {
        id: "6.1-full",
        claim: "the same of the lens of chapter 5 at full size, revolved, in 50 layers of 33 x 38 spheres of 440c",
        source: "fig. 6.1, an outlook",
        reason: REASON,
        formula: false,
        expected: Verdict::HoldsInPart,
        seconds: 45.0,
        measure: |context| lens(include_str!("../../designs/space/thesis-lens.toml"), context),
    },
];

/// C and G of the lens, and both over the best that any strip of one layer up to the lens's height comes to; at the design's own force.
fn lens(text: &str, context: &Context) -> Result<Vec<Part>, RowError> {
    let said = |error: &dyn std::fmt::Display| RowError::Stopped(error.to_string());
    let design = SpaceDesign::parse_in_space("lens.toml", text).map_err(|error| said(&error))?;
    let design = SpaceDesign { seeds: 0, ..design };
    let (body, materials) = design.propose_in_space().map_err(|error| said(&error))?;
    let Some(request) = &design.lens else { return Err(RowError::Stopped("no lens".to_owned())) };
    let comparison = SpaceComparison::of_lens(&design, (&body, request, materials), Overrides::default())
        .map_err(|error| said(&error))?
        .over(Forces::ONE);
    let outcome = compare_in_space(&comparison, context).map_err(|error| match error {
        EvaluatorError::Interrupted => RowError::Interrupted,
        error => said(&error),
    })?;
    if let Some(stop) = outcome.arrangements.iter().find_map(|arrangement| arrangement.stop.clone()) {
        return Err(stop.into());
    }
    let of = |a: &ArrangementOutcome, measure| a.scores.get(measure).unwrap_or(f64::NAN);
    let best = |measure: Measure| {
        let flat = outcome.arrangements.iter().filter(|a| a.kind.starts_with("strip-") || a.kind.starts_with("flat-"));
        flat.map(|a| (of(a, measure), a.name.clone())).max_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or_default()
    };
    let lens = &outcome.arrangements[0];
    let mut parts = vec![
        Part::words("contrast C", "focuses", of(lens, Measure::Contrast), "", Above(1.0)),
        Part::words("gain G over the host alone", "focuses", of(lens, Measure::FocalGain), "", Above(1.0)),
    ];
    for (measure, name) in [(Measure::Contrast, "C"), (Measure::FocalGain, "G")] {
        let (value, strip) = best(measure);
        let what = format!("{name} over that of the best strip, {strip} with {value:.3}");
        parts.push(Part::words(what, "worth building", of(lens, measure) / value, "", Above(1.0)));
    }
    Ok(parts)
}
