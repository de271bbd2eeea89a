//! The comparison as a page: words, tables, and for each record its curves and what is left between them.

use std::fmt::Write as _;

use super::{Comparison, Data, Fit, Prediction};
use crate::report::{COLOURS, Chart, Figure, Frame, Line, Provenance, escape};
use crate::units::Dimension::Time;

/// The unit at the end of a record's name.
fn unit(name: &str) -> &'static str {
    if name.ends_with("_N") {
        "N"
    } else if name.ends_with("_m_s") {
        "m/s"
    } else {
        "m"
    }
}

/// Words and tables as HTML.
fn above(comparison: &Comparison, fitted: Option<(&Fit, &Comparison)>) -> String {
    let mut html = format!(
        "<p>Measured time = predicted time + {}. A record has arrived when it has changed by a tenth of its greatest change.</p>\n",
        Time.show(comparison.offset_s)
    );
    html += &table("As the file says", comparison);
    if let Some((fit, after)) = fitted {
        let _ = write!(
            html,
            "<h2>Fitted, in {} simulations</h2>\n<table><tr><th>input</th><th>start</th><th>fitted</th><th>95 % interval</th></tr>\n",
            fit.runs
        );
        for input in &fit.inputs {
            let interval =
                input.interval.map_or("not told by these records".to_owned(), |half| format!("&plusmn; {half:.2e}"));
            let bound = if input.at_bound { ", at the end of its range" } else { "" };
            let _ = writeln!(
                html,
                "<tr><td>{} ({})</td><td>{}</td><td>{:.4}{bound}</td><td>{interval}</td></tr>",
                escape(&input.input),
                input.meaning,
                input.start,
                input.value
            );
        }
        html.push_str("</table>\n");
        if after.records.iter().any(|record| record.neighbours > 0.5) {
            html.push_str(
                "<p>Residuals hang together from sample to sample: curves differ in shape, and the intervals, which take \
                 residuals for noise, are too narrow.</p>\n",
            );
        }
        html += &table("With what was fitted", after);
    }
    html
}

fn table(title: &str, comparison: &Comparison) -> String {
    let mut html = format!(
        "<h2>{title}</h2>\n<div class=\"wide\"><table><tr><th>record</th>\
         <th>arrival, measured</th><th>predicted</th><th>peak, measured</th><th>predicted</th><th>rms difference</th><th>over the \
         peak</th></tr>\n"
    );
    for record in &comparison.records {
        let (m, p, unit) = (&record.measured, &record.predicted, unit(&record.name));
        let _ = writeln!(
            html,
            "<tr><td>{}</td><td>{}</td><td>{}</td><td>{:.4e} {unit}</td><td>{:.4e} {unit}</td><td>{:.3e} {unit}</td><td>{:.1} \
             %</td></tr>",
            escape(&record.name),
            Time.show(m.arrival_s),
            Time.show(p.arrival_s),
            m.peak,
            p.peak,
            record.rms,
            100.0 * record.rms_over_peak
        );
    }
    html.push_str("</table>\n");
    html
}

/// The page; `before` is the prediction as the file says.
pub fn page(
    title: &str,
    provenance: Provenance,
    data: &Data,
    (before, comparison): (&Prediction, &Comparison),
    fitted: Option<(&Fit, &Comparison)>,
) -> String {
    let micro = |time: f64| 1e6 * time;
    let mut pictures = Vec::new();
    for (k, record) in data.records.iter().enumerate() {
        let points = |value: &dyn Fn(usize, f64) -> Option<f64>| -> Vec<[f64; 2]> {
            let times = data.times.iter().enumerate();
            times.filter_map(|(n, time)| Some([micro(*time), value(n, *time)?])).collect()
        };
        let measured = |n: usize| Some(record.values[n]).filter(|value| value.is_finite());
        let line = |name: &str, colour: usize, dashed, points| Line {
            name: name.to_owned(),
            colour: COLOURS[colour].to_owned(),
            dashed,
            points,
        };
        let at = |prediction: &Prediction, offset: f64, time: f64| prediction.at(k, time - offset);
        let offset = comparison.offset_s;
        let mut lines = vec![
            line("measured", 5, false, points(&|n, _| measured(n))),
            line("predicted", 0, true, points(&|_, time| at(before, offset, time))),
        ];
        let mut left =
            vec![line("as the file says", 0, true, points(&|n, time| Some(measured(n)? - at(before, offset, time)?)))];
        if let Some((fit, _)) = fitted {
            let after = |time: f64| at(&fit.prediction, fit.offset, time);
            lines.push(line("fitted", 1, false, points(&|_, time| after(time))));
            left.push(line("fitted", 1, false, points(&|n, time| Some(measured(n)? - after(time)?))));
        }
        let unit = unit(&record.name);
        let chart = |title: String, lines| Chart { title, labels: ["time (us)".to_owned(), unit.to_owned()], lines };
        pictures.push((record.name.clone(), chart(record.name.clone(), lines).svg()));
        let title = format!("{}: measured less predicted", record.name);
        pictures.push((title.clone(), chart(title, left).svg()));
    }
    let figures = pictures.iter().map(|(title, svg)| Figure {
        file: "curves.csv",
        svg,
        caption: format!("{title}, on the clock of the measurement."),
        numbers: None,
    });
    let frame = Frame {
        title,
        kind: "Measured histories on the prediction, by granulens. Numbers are in the files beside this page.",
        verdict: above(comparison, fitted),
        figures: figures.collect(),
        sections: Vec::new(),
        provenance,
    };
    frame.html()
}

/// The curves as a table: for each record what was measured and what was predicted, with what was fitted where something was.
pub fn curves_csv(data: &Data, prediction: &Prediction, offset: f64) -> String {
    let mut text = "time_s".to_owned();
    for record in &data.records {
        let _ = write!(text, ",{0}_measured,{0}_predicted", record.name);
    }
    text.push('\n');
    let shown = |value: Option<f64>| value.map_or(String::new(), |value| format!("{value:e}"));
    for (n, time) in data.times.iter().enumerate() {
        let _ = write!(text, "{time:e}");
        for (k, record) in data.records.iter().enumerate() {
            let measured = Some(record.values[n]).filter(|value| value.is_finite());
            let _ = write!(text, ",{},{}", shown(measured), shown(prediction.at(k, time - offset)));
        }
        text.push('\n');
    }
    text
}
