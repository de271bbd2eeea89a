//! What a second blow on the same piece finds.
//!
//! Contacts that have yielded keep a dent. Put back on their sites, the dents of turned spheres no longer meet each other, and every
//! sphere is smaller than it was: by half of the mean of its contacts' residual overlaps. This is a first estimate: spheres that were not turned find their dents
//! deeper, and of those that settle anew some gaps close.

use super::{GateError, Line, Look, Word, given};
use crate::contact::{AnyLaw, ForceLaw, Pair};
use crate::evaluate::{Drawing, Evaluator, EvaluatorError, ImpactLoad, Imperfection, LoadCase, contacts_of_half};
use crate::score::Measure;
use crate::units::Dimension::Length;

/// Losses of C that are no more than chance: twice what one force's scores scatter by.
const CHANCE: f64 = 0.03;

pub(super) fn line(look: &Look) -> Result<Option<Line>, GateError> {
    let drawing = look.drawing;
    let design = drawing.design();
    if !design.law().is_plastic() {
        return Ok(None);
    }
    let diameter = design.diameter();
    // Of a piece whose halves differ the record is of all spheres.
    let of: Vec<u8> = match drawing {
        Drawing::Plane(_, subject) if subject.left.is_some() => {
            subject.spheres().iter().map(|sphere| sphere.material).collect()
        }
        _ => drawing.materials(),
    };
    let mut sums = vec![[0.0, 0.0]; of.len()];
    let mut deepest = 0.0_f64;
    let of_half = match drawing {
        Drawing::Space(design, layout) => {
            contacts_of_half((design, look.plan), layout, look.context).map_err(EvaluatorError::from)?
        }
        Drawing::Plane(..) => None,
    };
    for contact in of_half.as_deref().unwrap_or(look.seen.contacts) {
        let materials = contact.spheres.map(|i| &drawing.palette()[usize::from(of[i])]);
        let pair = Pair::new(materials, [0.5 * diameter; 2], design.constants());
        let dent = residual(&AnyLaw::new(design.law(), &pair), contact.overlap_max, contact.force_max);
        deepest = deepest.max(dent);
        for sphere in contact.spheres {
            sums[sphere][0] += dent;
            sums[sphere][1] += 1.0;
        }
    }
    let mean = |[sum, count]: &[f64; 2]| if *count > 0.0 { sum / count } else { 0.0 };
    // Half of a dent is each sphere's, and a dent takes a radius.
    let radii: Vec<f64> = sums.iter().map(|sum| 1.0 - mean(sum) / diameter).collect();
    let radii = match drawing {
        Drawing::Plane(_, subject) => subject.on_places(&radii),
        Drawing::Space(..) => radii,
    };
    let dented = Imperfection { radii, ..Imperfection::default() };
    let load = ImpactLoad::from(design.impact());
    let cases = [look.case(load), LoadCase { imperfection: dented, ..look.case(load) }];
    let overrides = given(look.plan, look.plan.step, look.plan.window);
    let evaluator = match Evaluator::new(design, &cases, drawing.palette().to_vec(), overrides, look.context) {
        Err(EvaluatorError::Baseline { .. }) => return Ok(None),
        evaluator => evaluator?,
    };
    let runs = evaluator.scores(&[drawing.materials()], look.context)?.concat();
    let why = "A piece that is struck twice is another piece; spheres that yielded are to be replaced.";
    let check = "second blow";
    if let Some(stop) = runs.iter().find_map(|run| run.stop.as_ref()) {
        return Ok(Some(Line::new(check, Word::Warn, stop.to_string(), "a run to its end", why)));
    }
    let of = |k: usize, measure: Measure| runs[k].scores.get(measure);
    let part = |measure: Measure| Some(of(1, measure)? / of(0, measure)? - 1.0);
    let words = [Measure::Contrast, Measure::FocalGain, Measure::Protection]
        .into_iter()
        .filter_map(|measure| Some(format!("{} {:+.1} %", measure.symbol(), 100.0 * part(measure)?)));
    let word = if part(Measure::Contrast).is_none_or(|part| part < -CHANCE) { Word::Warn } else { Word::Pass };
    let number = format!("{}; dents up to {}", words.collect::<Vec<_>>().join(", "), Length.show(deepest));
    Ok(Some(Line::new(check, word, number, "C falls by 3 % at most, spheres put back on their sites", why)))
}

/// The overlap (m) at which a contact that has been pressed that far carries nothing any more.
fn residual(law: &AnyLaw, overlap_max: f64, force_max: f64) -> f64 {
    let history = law.recalled(overlap_max, force_max);
    // The force rises with the overlap on the way back.
    let (mut open, mut closed) = (0.0, overlap_max);
    for _ in 0..60 {
        let middle = 0.5 * (open + closed);
        if law.force(middle, -1e-9, &history) > 0.0 { closed = middle } else { open = middle }
    }
    open
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::{Constants, LawKind};
    use crate::material::find;

    /// Hertz leaves no dent. The thesis's law leaves d_max − (3 F_max/(4 E* √R_p))^{2/3}, R_p = (4E*/3F_max) ((2F_max + F_y)/(2π 1.6 σ_y))^{3/2}.
    #[test]
    fn dents_are_those_of_the_law() {
        let steel = find("440c", &[]).unwrap();
        let pair = Pair::new([&steel; 2], [3.175e-3; 2], Constants::Code);
        let hertz = AnyLaw::new(LawKind::Hertz, &pair);
        assert!(residual(&hertz, 1e-5, 1e3) < 1e-20);
        let (overlap, force) = (4e-4, 5e3);
        let thesis = AnyLaw::new(LawKind::Thesis, &pair);
        let e = pair.modulus;
        let r = 4.0 * e / (3.0 * force)
            * ((2.0 * force + pair.regions(1.0).yield_force) / (2.0 * std::f64::consts::PI * 1.6 * pair.yield_stress))
                .powf(1.5);
        let expected = overlap - (3.0 * force / (4.0 * e * r.sqrt())).powf(2.0 / 3.0);
        assert!((residual(&thesis, overlap, force) / expected - 1.0).abs() < 1e-9, "{expected}");
    }
}
