//! A design surface as a page: the picture, and under the pointer the numbers behind it.

use serde_json::{Value, json};

use super::digits::significant;
use super::frame::{Figure, Frame, Provenance, table};
use super::look::Look;
use super::surface::{CORNER, PLOT, caption, shown, surface};
use super::svg::escape;
use crate::wave::{Axis, Node, Point, Surface};

/// The numbers behind a surface: its axes with grid lines, the values, the media.
pub fn surface_data(grid: &Surface, points: &[Point]) -> Value {
    let (title, _, unit) = shown(&grid.setting);
    let axis = |k: usize| {
        let (caption, unit) = caption(grid.axes[k], grid.setting.diameter);
        let places = |of: fn(&Node) -> f64| grid.nodes[k].iter().map(of).collect::<Vec<_>>();
        json!({
            "caption": caption, "unit": unit, "linear": grid.axes[k] == Axis::Dimension,
            "places": places(|node| node.place), "values": places(|node| node.value),
        })
    };
    let media: Vec<_> = points
        .iter()
        .map(|point| {
            json!({ "label": point.label, "kind": point.kind.name(), "place": point.place, "value": point.value })
        })
        .collect();
    json!({
        "title": title, "unit": unit, "corner": CORNER, "plot": PLOT, "x": axis(0), "y": axis(1),
        "values": grid.values, "media": media,
    })
}

/// The page, complete in itself: picture, media, and the few lines of script that show the numbers under the pointer.
pub fn surface_page(grid: &Surface, points: &[Point], provenance: Provenance) -> String {
    let (title, _, unit) = shown(&grid.setting);
    let picture = surface(grid, points, &Look::default());
    let captions = [0, 1].map(|k| caption(grid.axes[k], grid.setting.diameter));
    let rows: Vec<Vec<String>> = points
        .iter()
        .map(|point| {
            let place = [0, 1].map(|k| significant(point.place[k] / captions[k].1, 4));
            let own = [point.label.clone(), point.kind.name().to_owned()];
            own.into_iter().chain(place).chain([significant(point.value / unit, 4)]).collect()
        })
        .collect();
    let headings = ["medium", "", captions[0].0.as_str(), captions[1].0.as_str(), title.as_str()];
    let found = |best: fn(f64, f64) -> f64| {
        let value = points.iter().map(|point| point.value).filter(|value| value.is_finite()).reduce(best)?;
        points.iter().find(|point| point.value == value)
    };
    let verdict = match (found(f64::min), found(f64::max)) {
        (Some(least), Some(most)) => format!(
            "<p>Of {} media the least is <b>{}</b> of {}, the greatest <b>{}</b> of {}.</p>\n",
            points.len(),
            significant(least.value / unit, 4),
            escape(&least.label),
            significant(most.value / unit, 4),
            escape(&most.label)
        ),
        _ => String::new(),
    };
    let here = "<div id=\"here\" aria-live=\"polite\">Move the pointer over the picture: here stand its coordinates, the value there, and the nearest \
                medium.</div>\n";
    let page = Frame {
        title: &title,
        kind: "A design surface by granulens: what a crystal of close-packed spheres does, over properties of its material.",
        verdict: verdict + STYLE,
        figures: vec![Figure {
            file: "",
            svg: &picture,
            caption: "The surface with the media on it; its numbers are in the table beside this page.".to_owned(),
            numbers: None,
        }],
        sections: vec![("Media", here.to_owned() + &table(&headings, &rows))],
        provenance,
    };
    // A script ends where "</" does, whatever it is in.
    let data = surface_data(grid, points).to_string().replace("</", "<\\/");
    page.html_with(&format!(
        "\"use strict\";\nconst data = {data};\n{}{}",
        crate::page::SURFACE,
        include_str!("surface_page.js")
    ))
}

/// The line that answers the pointer stays in sight below the picture.
const STYLE: &str = "<style>#here { position: sticky; bottom: 0; padding: .6rem .9rem; min-height: 4.2rem; line-height: 1.45; border-top: 1px solid; \
                     background: Canvas; } tr.near td { outline: 2px solid; } @media print { #here { display: none; } }</style>\n";
