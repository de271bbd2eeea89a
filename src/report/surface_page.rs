//! A design surface as a page: the picture, and under the pointer the numbers behind it.

use serde_json::{Value, json};

use super::files::ReportError;
use super::look::Look;
use super::surface::{CORNER, PLOT, caption, shown, surface};
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

/// The page, complete in itself: picture, numbers and the few lines of script that show those under the pointer.
///
/// # Errors
/// If the template does not fit its content.
pub fn surface_page(grid: &Surface, points: &[Point]) -> Result<String, ReportError> {
    let (title, ..) = shown(&grid.setting);
    // A script ends where "</" does, whatever it is in.
    let data = surface_data(grid, points).to_string().replace("</", "<\\/");
    let mut environment = minijinja::Environment::new();
    environment.set_auto_escape_callback(|_| minijinja::AutoEscape::Html);
    let content = minijinja::context! {
        title,
        picture => minijinja::Value::from_safe_string(surface(grid, points, &Look::default())),
        data => minijinja::Value::from_safe_string(data),
        script => minijinja::Value::from_safe_string(crate::page::SURFACE.to_owned()),
    };
    Ok(environment.render_named_str("surface_page.html", include_str!("surface_page.html"), content)?)
}
