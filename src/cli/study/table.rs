//! A journal as a table: a line for each evaluation and each case it was judged by.

use granulens::export::{Column, Columns};
use granulens::score::{Measure, Needs, Scores, Unit};
use granulens::study::{Rung, Study};

/// A line before it is cut into columns.
struct Line<'a> {
    step: f64,
    evaluation: usize,
    crystal: usize,
    case: &'a granulens::evaluate::LoadCase,
    scores: Scores,
    judged: &'a granulens::study::Judged,
}

/// A study's evaluations at each of its steps; crystal 0 is the one as drawn.
pub fn journal(study: &Study, rungs: &[(f64, Rung)]) -> Columns {
    let cases = study.cases();
    let lines: Vec<Line> = rungs
        .iter()
        .flat_map(|(step, rung)| rung.all().iter().enumerate().map(move |(k, judged)| (*step, k + 1, judged)))
        .flat_map(|(step, evaluation, judged)| {
            // Of several forces the line has the first, and scores over all of them.
            let places = cases.iter().step_by(study.forces.count()).zip(&judged.entry.impacts).enumerate();
            places.map(move |(place, (case, scores))| {
                let crystal = place / study.impacts.len();
                let mut scores = scores.clone();
                scores.add_layout(&judged.stats);
                Line { step, evaluation, crystal, case, scores, judged }
            })
        })
        .collect();
    let whole = |of: &dyn Fn(&Line) -> u64| Column::Whole(lines.iter().map(|line| of(line) as i64).collect());
    let maybe = |of: &dyn Fn(&Line) -> Option<f64>| {
        Column::Number(lines.iter().map(|line| of(line).filter(|value| value.is_finite())).collect())
    };
    let number = |of: &dyn Fn(&Line) -> f64| maybe(&|line| Some(of(line)));
    let text = |of: &dyn Fn(&Line) -> Option<String>| Column::Text(lines.iter().map(of).collect());
    let value = |measure: Measure| {
        let number = |line: &Line| line.scores.get(measure);
        match measure.unit() {
            Unit::Count => (measure.column(), whole(&|line| number(line).unwrap_or_default() as u64)),
            _ => (measure.column(), maybe(&number)),
        }
    };
    // Ledgers are not kept, and a ratio to the first has no first.
    let kept = |measure: &&Measure| {
        let ledger = measure.needs() == Needs::Records && measure.unit() == Unit::Joule;
        !ledger && !matches!(measure, Measure::ProtectedRatio | Measure::Residual)
    };
    let measures = |layout: bool| {
        let of = move |measure: &&Measure| (measure.needs() == Needs::Layout) == layout;
        Measure::ALL.iter().filter(kept).filter(of).map(|&measure| value(measure)).collect::<Vec<_>>()
    };
    let mut table = vec![
        ("step_s", number(&|line| line.step)),
        ("evaluation", whole(&|line| line.evaluation as u64)),
        ("crystal", whole(&|line| line.crystal as u64)),
        ("force_N", maybe(&|line| Some(line.case.load.strike.pulse()?.force))),
        ("duration_s", maybe(&|line| line.case.load.strike.duration())),
        ("angle_rad", number(&|line| line.case.load.angle)),
        ("x_from_m", maybe(&|line| Some(line.case.load.place?[0]))),
        ("x_to_m", maybe(&|line| Some(line.case.load.place?[1]))),
    ];
    table.extend(measures(false));
    table.push(("loss", number(&|line| line.judged.loss.total)));
    table.push(("miss", number(&|line| line.judged.loss.miss)));
    table.extend(measures(true));
    table.push(("stop", text(&|line| line.judged.entry.stop.clone())));
    table.push(("layout", text(&|line| Some(line.judged.entry.layout.clone()))));
    table.push(("projectile_kg", maybe(&|line| Some(line.case.load.strike.projectile()?.mass))));
    table.push(("speed_m_s", maybe(&|line| Some(line.case.load.strike.projectile()?.speed))));
    Columns(table)
}
