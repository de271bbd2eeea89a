//! A study as a page: the best layout, how the search came to it, and what it is compared with.

use super::chart::{COLOURS, Chart, Line};
use super::crystal::{Crystal, Extent, Ground};
use super::digits::significant;
use super::drawing;
use super::frame::{self, Figure, Frame, Provenance};
use super::slices::{Paint, Slices};
use super::svg::{Anchor, Svg, escape};
use super::turned::turned;
use crate::design::{Design, DesignRef};
use crate::layout::{AnyLayout, Layout};
use crate::outcome::Word;
use crate::score::{Measure, Scores};
use crate::study::{BaselineScores, Found, Front, Spread, State};

/// What a study came to, to be drawn.
pub struct StudyPage<'a> {
    /// Its name.
    pub name: &'a str,
    /// What it came to.
    pub state: &'a State,
    /// The design whose layouts were searched.
    pub design: DesignRef<'a>,
    /// The best layout, or the nearest to the limits.
    pub layout: Option<&'a AnyLayout>,
    /// The same in words.
    pub words: &'a str,
    /// What repeats it.
    pub provenance: Provenance,
}

/// C, G and Q.
const RATIOS: [Measure; 3] = [Measure::Contrast, Measure::FocalGain, Measure::Protection];

/// The page, complete in itself.
pub fn study_page(study: &StudyPage<'_>) -> String {
    let state = study.state;
    let mut pictures: Vec<(&str, String, String)> = Vec::new();
    match (study.design, study.layout) {
        (DesignRef::Plane(design), Some(AnyLayout::Plane(layout))) => {
            let caption =
                "The layout that was found, both halves; the focal region is outlined solid, the protected one dashed.";
            pictures.push(("best.csv", best(study.name, design, layout), caption.to_owned()));
        }
        (DesignRef::Space(design), Some(AnyLayout::Space(layout))) => {
            let slices = Slices::of(study.name, design);
            let caption = "The layout that was found, spheres within 0.45 D of the plane y = 0, both halves; the focal region is \
                           outlined solid, the protected one dashed.";
            pictures.push((
                "best.csv",
                slices.section(&[("materials".to_owned(), Paint::Material(&layout.materials))], None),
                caption.to_owned(),
            ));
            let held: Vec<(String, u32, Paint)> = slices
                .holding(&layout.materials, 12)
                .into_iter()
                .map(|layer| (format!("layer {layer}"), layer, Paint::Material(&layout.materials)))
                .collect();
            let caption = "The same, layers from above.";
            pictures.push(("best.csv", slices.layers(&held, None), caption.to_owned()));
        }
        _ => {}
    }
    let (view, script) = match (study.design, study.layout) {
        (DesignRef::Space(design), Some(AnyLayout::Space(layout))) => {
            let names: Vec<String> = layout.palette.iter().map(|material| material.name.clone()).collect();
            turned(&Slices::of(study.name, design), &layout.materials, &names, None)
        }
        _ => (String::new(), String::new()),
    };
    if let Some(picture) = convergence(study.name, state) {
        let caption = "The number that is made small, of the best layout so far, over the evaluations of all stages; a line for each \
                       step, since at another step it is another number. Dashed where a limit is missed.";
        pictures.push(("study.json", picture, caption.to_owned()));
    }
    if let Some(picture) = state.front.as_ref().and_then(|front| traded(study.name, front)) {
        let caption = "The layouts that no other dominates, by the two measures that are traded first.";
        pictures.push(("study.json", picture, caption.to_owned()));
    }
    let figures = pictures
        .iter()
        .map(|(file, svg, caption)| Figure { file, svg, caption: caption.clone(), numbers: None })
        .collect();
    let mut sections = vec![("What it is compared with", compared(state))];
    if state.stages.len() > 1 {
        sections.push(("Stages", stages(state)));
    }
    if !view.is_empty() {
        sections.insert(0, ("Turned by hand", view));
    }
    sections.push(("In words", format!("<pre>{}</pre>\n", frame::escape_lines(study.words.trim_end()))));
    let page = Frame {
        title: study.name,
        kind: "A search of layouts by granulens. Every evaluation is a line of journal.jsonl beside this page.",
        verdict: verdict(state),
        figures,
        sections,
        provenance: study.provenance.clone(),
    };
    page.html_with(&script)
}

/// Whether the limits are kept, and what the best comes to beside the best of what it is compared with.
fn verdict(state: &State) -> String {
    let Some(found) = state.found() else {
        return "<p class=\"failure\">No evaluation has come to its end.</p>\n".to_owned();
    };
    let kept = if found.within_limits {
        "<p>The best layout <b class=\"better\">keeps every limit</b> of the study"
    } else {
        "<p>No layout keeps the study's limits; the nearest <b class=\"worse\">misses one</b>"
    };
    let line = |measure: Measure| {
        let value = found.scores.get(measure)?;
        let rival = |baseline: &BaselineScores| Some((spread(baseline, measure)?.mean, baseline.name.clone()));
        let (best, name) = state
            .baselines
            .iter()
            .filter_map(rival)
            .reduce(|a, b| if measure.best(a.0, b.0) == b.0 { b } else { a })?;
        let word = Word::of(measure, value, best, None).name();
        let symbol = measure.symbol();
        Some(format!(
            "<li>{symbol} {}: <b class=\"{word}\">{word}</b> against {}, the best of what it is compared with, of {}</li>\n",
            significant(value, 3),
            significant(best, 3),
            escape(&name)
        ))
    };
    let lines: String = RATIOS.into_iter().filter_map(line).collect();
    format!(
        "{kept}, after {} evaluations. Of single scores nothing is decided within 4\u{a0}%.</p>\n<ul>\n{lines}</ul>\n",
        state.evaluations
    )
}

fn spread(baseline: &BaselineScores, measure: Measure) -> Option<&Spread> {
    match measure {
        Measure::Contrast => baseline.contrast.as_ref(),
        Measure::FocalGain => baseline.focal_gain.as_ref(),
        _ => baseline.protection.as_ref(),
    }
}

/// C, G and Q of start, best and baselines.
fn compared(state: &State) -> String {
    let shown = |scores: &Scores| {
        RATIOS.map(|measure| scores.get(measure).map_or("–".to_owned(), |value| significant(value, 4))).to_vec()
    };
    let row = |name: &str, found: &Found| std::iter::once(name.to_owned()).chain(shown(&found.scores)).collect();
    let mut rows: Vec<Vec<String>> = Vec::new();
    rows.extend(
        state.found().map(|found| row(if found.within_limits { "best" } else { "nearest to the limits" }, found)),
    );
    rows.extend(state.start.as_ref().map(|start| row("start", start)));
    for baseline in &state.baselines {
        let cells = RATIOS.map(|measure| match spread(baseline, measure) {
            None => "–".to_owned(),
            Some(Spread { mean, half_width: None, .. }) => significant(*mean, 4),
            Some(Spread { mean, half_width: Some(half), .. }) => {
                format!("{} ± {}", significant(*mean, 4), significant(*half, 2))
            }
        });
        rows.push(std::iter::once(baseline.name.clone()).chain(cells).collect());
    }
    let note = "<p class=\"quiet\">± is half the 95 % interval of the mean over seeds. C = F/P; G is F over that of the host alone, Q is P \
                over that of the crystal that the design names.</p>\n";
    frame::table(&["layout", "C", "G", "Q"], &rows) + note
}

fn stages(state: &State) -> String {
    let rows: Vec<Vec<String>> = state
        .stages
        .iter()
        .map(|stage| {
            let best = |measure| {
                let value = stage.best.as_ref().and_then(|best| best.get(measure));
                value.map_or("–".to_owned(), |value| significant(value, 4))
            };
            let step = crate::units::Dimension::Time.show(stage.step);
            let kept = if stage.within_limits { "kept" } else { "missed" };
            let head = [stage.method.clone(), step, stage.evaluations.to_string()];
            head.into_iter().chain(RATIOS.map(best)).chain([kept.to_owned()]).collect()
        })
        .collect();
    frame::table(&["method", "step", "evaluations", "C", "G", "Q", "limits"], &rows)
}

/// The loss of the best so far.
fn convergence(name: &str, state: &State) -> Option<String> {
    let mut lines: Vec<Line> = Vec::new();
    let mut steps: Vec<f64> = Vec::new();
    for improvement in &state.history {
        if !steps.contains(&improvement.step) {
            steps.push(improvement.step);
        }
    }
    for (k, &step) in steps.iter().enumerate() {
        for kept in [false, true] {
            let here = state.history.iter().filter(|h| h.step == step && h.within_limits == kept);
            // What is best stays so until the next is found: a staircase.
            let mut points: Vec<[f64; 2]> = Vec::new();
            for found in here {
                let at = found.evaluations as f64;
                points.extend(points.last().map(|last| [at, last[1]]));
                points.push([at, found.loss]);
            }
            // Up to where the next step or the study begins or ends.
            let Some(&[_, loss]) = points.last() else { continue };
            let next = steps.get(k + 1).and_then(|next| state.history.iter().find(|h| h.step == *next));
            let is_last = kept || !state.history.iter().any(|h| h.step == step && h.within_limits);
            let end = next.map_or(state.evaluations, |next| next.evaluations) as f64;
            if is_last {
                points.push([end, loss]);
            }
            let limits = if kept { "" } else { ", limits missed" };
            lines.push(Line {
                name: format!("step {}{limits}", crate::units::Dimension::Time.show(step)),
                colour: COLOURS[k % COLOURS.len()].to_owned(),
                dashed: !kept,
                points,
            });
        }
    }
    (!lines.is_empty()).then(|| {
        let title = format!("{name}: the best so far");
        Chart { title, labels: ["evaluations".to_owned(), "loss".to_owned()], lines }.svg()
    })
}

/// The front by its first two measures.
fn traded(name: &str, front: &Front) -> Option<String> {
    let [a, b] = [front.measures.first()?, front.measures.get(1)?].map(|name| Measure::find(name));
    let (a, b) = (a?, b?);
    let points: Vec<[f64; 2]> =
        front.layouts.iter().filter_map(|found| Some([found.scores.get(a)?, found.scores.get(b)?])).collect();
    let line = Line { name: "front".to_owned(), colour: COLOURS[0].to_owned(), dashed: false, points };
    let axis = |measure: Measure| format!("{}, {}", measure.symbol(), measure.name());
    let chart = Chart { title: format!("{name}: the front"), labels: [axis(a), axis(b)], lines: vec![line] };
    Some(chart.svg())
}

/// The layout, both halves.
fn best(name: &str, design: &Design, layout: &Layout) -> String {
    const CORNER: [f64; 2] = [52.0, 40.0];
    let sites = layout.lattice.sites();
    let ground = Ground {
        sites: &sites,
        diameter: layout.lattice.diameter(),
        half_width: layout.lattice.half_width(),
        target: &design.target,
    };
    let crystal = Crystal::new(ground, Extent::Both, CORNER, [620.0, 900.0]);
    let [width, height] = crystal.size();
    let counts = layout.piece(|_| None).counts;
    let used: Vec<usize> = (0..layout.palette.len()).filter(|&k| counts[k] > 0).collect();
    let foot = 24.0 + 21.0 * used.len() as f64;
    let title = format!("{name}: the layout that was found");
    let mut svg = Svg::new(CORNER[0] + width + 24.0, CORNER[1] + height + 30.0 + foot, &title);
    svg.text([CORNER[0], 22.0], 14.0, Anchor::Start, r#"font-weight="bold""#, &title);
    drawing::spheres(&mut svg, &crystal, layout.palette.len(), &layout.materials);
    crystal.regions(&mut svg, 2.0);
    crystal.name_regions(&mut svg, 13.0);
    crystal.row_numbers(&mut svg, 11.0);
    for (line, &k) in used.iter().enumerate() {
        let y = CORNER[1] + height + 36.0 + 21.0 * line as f64;
        drawing::swatch(&mut svg, [CORNER[0] + 8.0, y], k);
        let text = format!("{}, {} spheres of the piece", layout.palette[k].name, counts[k]);
        svg.text([CORNER[0] + 24.0, y + 4.0], 12.0, Anchor::Start, "", &text);
    }
    svg.finish()
}
