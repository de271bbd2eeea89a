//! A contact's force-displacement curve as a figure: loading with its regions, one unloading.

use plotters::prelude::*;

use crate::contact::{AnyLaw, ForceLaw as _, History, Pair};

/// How far the curve runs, in units of δ_p: somewhat past what the law was fitted for.
const EXTENT: f64 = 2.5;

/// Closing speeds (m/s) for which the loading curve is drawn: at rest, and one that shows the rate effect.
const FAST: f64 = 10.0;

/// Size of the picture (px), and the factor by which it is drawn finer, since the backend knows whole pixels only.
const SIZE: [u32; 2] = [760, 500];
const FINER: u32 = 4;

/// Draws the law of a pair of spheres as SVG: loading at rest and at 10 m/s, unloading from the end of the curve, and where
/// the regions meet.
pub fn contact_curve(law: &AnyLaw, pair: &Pair, title: &str) -> String {
    let regions = pair.regions(1.0);
    let end = EXTENT * regions.plastic_overlap;
    let points = 400;
    let overlaps = move || (0..=points).map(move |k| end * f64::from(k) / f64::from(points));
    // Micrometres and newtons, as the axes say.
    let um = 1e6;
    let loading = |speed: f64| -> Vec<(f64, f64)> {
        let fresh = History::new();
        overlaps().map(|d| (d * um, law.force(d, speed, &fresh))).collect()
    };
    let (slow, fast) = (loading(0.0), loading(FAST));
    let history = law.recalled(end, slow.last().map_or(0.0, |p| p.1));
    let unloading: Vec<(f64, f64)> = overlaps().map(|d| (d * um, law.force(d, -FAST, &history))).collect();
    let hardens = slow != fast;
    let top = 1.08 * slow.iter().chain(&fast).map(|p| p.1).fold(0.0, f64::max);

    let mut svg = String::new();
    let drawn = (|| -> Result<(), Box<dyn std::error::Error + '_>> {
        let [width, height] = SIZE.map(|side| side * FINER);
        let area = SVGBackend::with_string(&mut svg, (width, height)).into_drawing_area();
        area.fill(&WHITE)?;
        let mut chart = ChartBuilder::on(&area)
            .caption(title, ("sans-serif", 18 * FINER))
            .margin(14 * FINER)
            .x_label_area_size(44 * FINER)
            .y_label_area_size(66 * FINER)
            .build_cartesian_2d(0.0..end * um, 0.0..top)?;
        chart
            .configure_mesh()
            .x_desc("overlap [µm]")
            .y_desc("force [N]")
            .x_label_formatter(&|x| format!("{x:.0}"))
            .y_label_formatter(&|y| format!("{y:.0}"))
            .light_line_style(WHITE)
            .bold_line_style(RGBColor(225, 225, 225).stroke_width(FINER))
            .axis_style(BLACK.stroke_width(FINER))
            .label_style(("sans-serif", 14 * FINER))
            .draw()?;
        for (place, name) in [(regions.yield_overlap, "yield"), (regions.plastic_overlap, "fully plastic")] {
            let line = [(place * um, 0.0), (place * um, top)];
            chart.draw_series(DashedLineSeries::new(
                line,
                5 * FINER,
                4 * FINER,
                RGBColor(120, 120, 120).stroke_width(FINER),
            ))?;
            chart.draw_series(std::iter::once(Text::new(
                name,
                (place * um + 0.01 * end * um, 0.97 * top),
                ("sans-serif", 14 * FINER).into_font().color(&RGBColor(80, 80, 80)),
            )))?;
        }
        let blue = RGBColor(20, 90, 160);
        let orange = RGBColor(200, 90, 20);
        let grey = RGBColor(60, 60, 60);
        let legend = |colour: RGBColor| {
            move |(x, y): (i32, i32)| {
                PathElement::new(vec![(x, y), (x + 22 * FINER as i32, y)], colour.stroke_width(2 * FINER))
            }
        };
        chart
            .draw_series(LineSeries::new(slow, blue.stroke_width(2 * FINER)))?
            .label("loading, quasistatic")
            .legend(legend(blue));
        // A pair that does not harden has one loading curve only.
        let fast = if hardens { fast } else { Vec::new() };
        chart
            .draw_series(DashedLineSeries::new(fast, 8 * FINER, 4 * FINER, orange.stroke_width(2 * FINER)))?
            .label(if hardens { "loading at 10 m/s" } else { "no rate effect" })
            .legend(legend(orange));
        chart
            .draw_series(LineSeries::new(unloading, grey.stroke_width(FINER)))?
            .label("unloading")
            .legend(legend(grey));
        chart
            .configure_series_labels()
            .position(SeriesLabelPosition::MiddleLeft)
            .legend_area_size(30 * FINER)
            .margin(8 * FINER)
            .background_style(WHITE.mix(0.85))
            .border_style(RGBColor(200, 200, 200))
            .label_font(("sans-serif", 14 * FINER))
            .draw()?;
        area.present()?;
        Ok(())
    })();
    // The backend writes into memory and cannot fail; without a drawing there is nothing to show.
    drop(drawn);
    let [width, height] = SIZE.map(|side| side * FINER);
    let fine = format!("width=\"{width}\" height=\"{height}\"");
    svg.replacen(&fine, &format!("width=\"{}\" height=\"{}\"", SIZE[0], SIZE[1]), 1)
}
