//! What the wave does in the layout, and what the models leave open.

use super::{GateError, Line, Look, Word, given};
use crate::dem::Stop;
use crate::design::Design;
use crate::evaluate::{
    Drawing, EvaluatorError, Subject, design_laws, evaluate, evaluate_in_space, over_laws, validity,
};
use crate::layout::{Baseline, Layout, PieceSphere};
use crate::outcome::{Verdict, Word as Judged};
use crate::score::Measure;
use crate::units::Dimension::{Angle, Force};
use crate::wave::{self, AMPLITUDES, Dimension};

/// Differences in C that no contact law decides.
const UNDECIDED: f64 = 0.2;

/// Overlap over δ_p up to which the plastic laws were fitted, and over the diameter from which on contacts 60° apart grow into each other.
const FITTED: f64 = 2.0;

pub(super) fn lines(look: &Look) -> Result<Vec<Line>, GateError> {
    let overrides = given(look.plan, look.plan.step, look.plan.window);
    let judgement = look.drawing.verdict(overrides, look.context)?;
    let mut lines = strength(look);
    lines.push(overlaps(look));
    if let Drawing::Plane(design, subject) = look.drawing {
        lines.push(interfaces(design, subject));
    }
    lines.extend(verdict(&judgement));
    lines.push(laws(look, &judgement)?);
    lines.extend(behind(look)?);
    Ok(lines)
}

/// Whether the impact is strong enough for the bound by which lenses are designed.
fn strength(look: &Look) -> Vec<Line> {
    let row = row(look);
    let line = |letter: u8| {
        let material = &look.drawing.palette()[usize::from(letter)];
        let validity = validity(look.drawing.design(), material);
        let word = if validity.speed_reached.is_some() { Word::Pass } else { Word::Warn };
        Line::new(
            &format!("impact on {}", material.name),
            word,
            validity.words(),
            format!(
                "at least {} F_p at a contact of {row} 1, from where on the speed of a wave is known",
                AMPLITUDES[0]
            ),
            "Rays and proposals use the bound of the wave speed; where it does not hold, only the simulation counts.",
        )
    };
    look.drawing.letters().into_iter().map(line).collect()
}

/// What its layers are called.
fn row(look: &Look) -> &'static str {
    if look.drawing.is_in_space() { "layer" } else { "row" }
}

fn overlaps(look: &Look) -> Line {
    let doubts = look.seen.doubts;
    let (over_diameter, depth) = (doubts.greatest_overlap(), doubts.greatest_depth());
    let limit = crate::dem::OVERLAP_WARNING;
    let word = if over_diameter > limit || depth > FITTED { Word::Warn } else { Word::Pass };
    Line::new(
        "overlaps",
        word,
        format!("{:.2} % of the diameter, {depth:.1} delta_p", 100.0 * over_diameter),
        format!("{:.1} % and {FITTED} delta_p", 100.0 * limit),
        "Beyond, the law is extrapolated, and contacts on one sphere grow into each other.",
    )
}

/// Where a wave that comes straight down passes from a slow to a fast material more obliquely than it can.
fn interfaces(design: &Design, subject: Subject<'_>) -> Line {
    let Layout { lattice, palette, .. } = subject.layout;
    // Of halves that differ all spheres; of others the half, which says the same.
    let all = subject.spheres();
    let sites: Vec<&PieceSphere> = all.iter().filter(|s| subject.left.is_some() || s.x >= 0.0).collect();
    let diameter = lattice.diameter();
    let speed: Vec<f64> =
        palette.iter().map(|m| wave::bound(Dimension::Two, [m, m], diameter, design.constants).speed).collect();
    let of = |site: usize| speed[usize::from(sites[site].material)];
    let (mut count, mut above, mut worst) = (0_usize, 0_usize, 0.0_f64);
    for (i, site) in sites.iter().enumerate() {
        // Around a site, out to two diameters: whether a faster material lies below, and which way speed rises.
        let near = |j: &usize| {
            let [dx, dz] = [sites[*j].x - site.x, sites[*j].z - site.z];
            dx.hypot(dz) < 2.1 * diameter
        };
        let rows = sites.iter().enumerate().filter(|(_, other)| other.row.abs_diff(site.row) <= 2).map(|(j, _)| j);
        let around: Vec<usize> = rows.filter(near).collect();
        let touches = |j: &&usize| {
            let [dx, dz] = [sites[**j].x - site.x, sites[**j].z - site.z];
            dx.hypot(dz) < 1.1 * diameter && dz > 0.0 && of(**j) > of(i)
        };
        let Some(&below) = around.iter().find(touches) else { continue };
        let gradient = around.iter().fold([0.0; 2], |[gx, gz], &j| {
            let rise = if of(j) > of(i) { 1.0 } else { 0.0 };
            [gx + rise * (sites[j].x - site.x), gz + rise * (sites[j].z - site.z)]
        });
        let Some(critical) = wave::critical_angle([of(i), of(below)]) else { continue };
        let angle = gradient[0].abs().atan2(gradient[1].max(0.0));
        count += 1;
        worst = worst.max(angle);
        if angle > critical {
            above += 1;
        }
    }
    let why = "A wave from the slower side is then thrown back whole; in a searched layout that may be wanted.";
    let number = match count {
        0 => "no passage from a slower to a faster material downwards".to_owned(),
        _ => format!(
            "{above} of {count} sites over a faster material above its critical angle; steepest {}",
            Angle.show(worst)
        ),
    };
    let word = if above > 0 { Word::Warn } else { Word::Pass };
    Line::new("interface angles", word, number, "the critical angle of each pair of materials", why)
}

/// Better than what it has to beat.
fn verdict(judgement: &[Verdict]) -> Vec<Line> {
    let measures = [Measure::Contrast, Measure::FocalGain, Measure::Protection];
    let line = |measure: Measure| {
        let own: Vec<_> = judgement.iter().filter(|verdict| verdict.measure == measure.name()).collect();
        let hardest = own.iter().copied().reduce(|a, b| if measure.best(a.best, b.best) == b.best { b } else { a })?;
        let word = if hardest.word == Judged::Better { Word::Pass } else { Word::Warn };
        let said = match hardest.word {
            Judged::Better => "better",
            Judged::Equal => "equal",
            Judged::Worse => "worse",
            Judged::Undecided => "undecided",
        };
        Some(Line::new(
            &format!("{} against baselines", measure.symbol()),
            word,
            format!("{:.4}, {said}", hardest.value),
            format!("better than {} ({:.4}) by two standard deviations", hardest.arrangement, hardest.best),
            "A flat strip, a uniform crystal or a random mixture is easier to build.",
        ))
    };
    measures.into_iter().filter_map(line).collect()
}

/// What other contact laws make of it.
fn laws(look: &Look, judgement: &[Verdict]) -> Result<Line, GateError> {
    let overrides = crate::evaluate::Overrides { window: Some(look.plan.window), ..Default::default() };
    let over = over_laws(look.drawing, &design_laws(look.drawing.design()), overrides, look.context)?;
    let best = judgement
        .iter()
        .filter(|verdict| verdict.measure == Measure::Contrast.name())
        .map(|verdict| verdict.best)
        .fold(0.0, f64::max);
    let show = |symbol: &str, range: Option<[f64; 2]>| match range {
        Some([low, high]) => format!("{symbol} {low:.3} to {high:.3}"),
        None => format!("{symbol} -"),
    };
    let range = &over.range;
    let number = [show("C", range.contrast), show("G", range.focal_gain), show("Q", range.protection)].join(", ");
    let least = range.contrast.map_or(0.0, |range| range[0]);
    let all_finished = over.each.iter().all(|one| one.stop.is_none());
    let word = if least > (1.0 + UNDECIDED) * best && all_finished { Word::Pass } else { Word::Warn };
    Ok(Line::new(
        "elastic-plastic laws",
        word,
        number,
        format!("C at least 20 % above the best baseline's {best:.3} under every law"),
        "Which law holds is not known: differences below 20 % in C are not decided by any.",
    ))
}

/// What stands behind the piece.
fn behind(look: &Look) -> Result<Vec<Line>, GateError> {
    let (plan, context) = (look.plan, look.context);
    let (host, stop) = match look.drawing {
        Drawing::Plane(design, subject) => {
            let host = Baseline::AllHost.layout(subject.layout, [1, 1], 0);
            let host = evaluate(design, &host, plan, context).map_err(EvaluatorError::from)?;
            (host.scores, host.record.stop)
        }
        Drawing::Space(design, layout) => {
            let host = Baseline::AllHost.layout(layout, [1, 1], 0);
            let host = evaluate_in_space(design, &host, plan, context).map_err(EvaluatorError::from)?;
            (host.scores, host.record.stop)
        }
    };
    match stop {
        None => {}
        Some(Stop::Interrupted { .. }) => return Err(EvaluatorError::Interrupted.into()),
        Some(_) => return Ok(Vec::new()),
    }
    let (own, host) = (look.seen.scores, &host);
    let row = row(look);
    let line = |check: &str, measure: Measure, show: &dyn Fn(f64) -> String, why: &str| {
        let (own, host) = (own.get(measure)?, host.get(measure)?);
        // The whole piece is two halves.
        let word = if own > host { Word::Warn } else { Word::Pass };
        let number = format!("{} on the last {row} of the whole piece", show(2.0 * own));
        let limit = format!("{} behind the host alone", show(2.0 * host));
        Some(Line::new(check, word, number, limit, why))
    };
    let force =
        line("force behind", Measure::FarForce, &|force| Force.show(force), "What the piece stands on has to bear it.");
    let impulse = line(
        "impulse behind",
        Measure::FarMomentum,
        &|momentum| format!("{momentum:.3} N s"),
        "It is what moves the support, whatever is lost on the way.",
    );
    Ok([force, impulse].into_iter().flatten().collect())
}
