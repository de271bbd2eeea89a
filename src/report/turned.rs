//! A crystal in space that the reader can turn: a few lines of script in the page, and a still picture where none runs.

use serde_json::json;

use super::colour::{LEVELS, Scale};
use super::slices::Slices;
use super::svg::{Anchor, Svg, escape};
use crate::outcome::SpaceSite;
use crate::page::ink;

/// Beyond so many spheres only those that hold anything but the host, or are scored, are given to the script: a page that nobody can open helps
/// nobody.
const MOST: usize = 40_000;

/// Degrees about the axis and from the side in which the still picture is seen; the script begins with them.
const TURN: f64 = 25.0;
const TILT: f64 = 20.0;

/// The figure as HTML, and the script that moves it, with what it shows: materials, and, where there are any, energies.
pub(super) fn turned(
    slices: &Slices<'_>,
    materials: &[u8],
    names: &[String],
    energies: Option<(&[f64], &Scale)>,
) -> (String, String) {
    let all = slices.spheres(|_| true);
    let few = all.len() <= MOST;
    let kept =
        |index: usize, site: &SpaceSite| few || materials.get(index).is_some_and(|&m| m > 0) || slices.region(site) > 0;
    let spheres: Vec<(usize, f64, &SpaceSite)> =
        all.into_iter().filter(|(index, _, site)| kept(*index, site)).collect();
    let diameters = |length: f64| (length / slices.diameter * 100.0).round() / 100.0;
    let of = |index: usize| materials.get(index).copied().unwrap_or(0);
    let shade =
        |index: usize| energies.map_or(0, |(energies, scale)| scale.level(energies.get(index).copied().unwrap_or(0.0)));
    let ramp: Vec<String> =
        energies.iter().flat_map(|(_, scale)| (0..LEVELS).map(|level| scale.colour(level))).collect();
    let data = json!({
        "x": spheres.iter().map(|(_, x, _)| diameters(*x)).collect::<Vec<_>>(),
        "y": spheres.iter().map(|(_, _, site)| diameters(site.y)).collect::<Vec<_>>(),
        "z": spheres.iter().map(|(_, _, site)| diameters(site.z)).collect::<Vec<_>>(),
        "material": spheres.iter().map(|(index, ..)| of(*index)).collect::<Vec<_>>(),
        "region": spheres.iter().map(|(_, _, site)| slices.region(site)).collect::<Vec<_>>(),
        "energy": spheres.iter().map(|(index, ..)| shade(*index)).collect::<Vec<_>>(),
        "inks": (0..names.len().max(1)).map(|k| ink(k).fill).collect::<Vec<_>>(),
        "ramp": ramp,
    });
    let legend: Vec<String> = names
        .iter()
        .enumerate()
        .filter(|(k, _)| materials.iter().any(|&m| usize::from(m) == *k))
        .map(|(k, name)| {
            format!("<span style=\"color:{0};background:{0}\">\u{25cf}</span> {1}", ink(k).fill, escape(name))
        })
        .collect();
    let paint = match energies {
        Some(_) => {
            "<label>painted by <select name=\"paint\"><option value=\"material\">material</option>\
             <option value=\"energy\">greatest kinetic energy</option></select></label>\n"
        }
        None => "",
    };
    let html = format!(
        "<figure id=\"turned\">\n<div class=\"still\">{}</div>\n<div class=\"live\" hidden>\n\
         <canvas tabindex=\"0\" role=\"img\" aria-label=\"The crystal, turned by dragging or by the arrow keys\" \
         style=\"width:100%;height:min(26rem,90vw);touch-action:pan-y;cursor:grab\"></canvas>\n<p>\
         <label>turn <input type=\"range\" name=\"turn\" min=\"-180\" max=\"180\" value=\"{TURN}\"></label>\n\
         <label>tilt <input type=\"range\" name=\"tilt\" min=\"-90\" max=\"90\" value=\"{TILT}\"></label>\n\
         <label>cut along y <input type=\"range\" name=\"cut\"></label>\n{paint}\
         <label><input type=\"checkbox\" name=\"host\"> host</label></p>\n</div>\n\
         <figcaption>{}. The struck layer is above. Outlined red: the focal region, blue: the protected one, where they are \
         shown. Drag it, or move the sliders; with the keyboard arrows turn it, plus and minus make it larger and smaller.</figcaption>\n</figure>\n\
         <script type=\"application/json\" id=\"turned-data\">{data}</script>\n",
        still(slices, &spheres, &of),
        legend.join(" \u{b7} "),
    );
    (html, include_str!("turned.js").to_owned())
}

/// What is not the host, as the script begins with it.
fn still(slices: &Slices<'_>, spheres: &[(usize, f64, &SpaceSite)], of: &impl Fn(usize) -> u8) -> String {
    const SIZE: [f64; 2] = [520.0, 420.0];
    let [[sa, ca], [sb, cb]] = [TURN, TILT].map(|degrees| {
        let (sine, cosine) = degrees.to_radians().sin_cos();
        [sine, cosine]
    });
    let all = slices.sites.iter();
    let [far, deep] = all.fold([0.0_f64; 2], |[far, deep], site| [far.max(site.x).max(site.y.abs()), deep.max(site.z)]);
    let scale = SIZE[1] / (2.0 * far.hypot(far).hypot(0.5 * deep) + slices.diameter);
    let mut seen: Vec<(f64, [f64; 2], u8)> = Vec::new();
    for &(index, x, site) in spheres.iter().filter(|(index, ..)| of(*index) > 0) {
        let (y, z) = (site.y, site.z - 0.5 * deep);
        let (u, v) = (x * ca - y * sa, x * sa + y * ca);
        let at = [0.5 * SIZE[0] + scale * u, 0.5 * SIZE[1] + scale * (z * cb + v * sb)];
        seen.push((v * cb - z * sb, at, of(index)));
    }
    // The farthest first.
    seen.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut svg = Svg::new(SIZE[0], SIZE[1], slices.name);
    svg.text([12.0, 20.0], 12.0, Anchor::Start, "", "without the host");
    for (_, at, material) in seen {
        let style = format!(r##"fill="{}" stroke="#444" stroke-width="0.5""##, ink(usize::from(material)).fill);
        svg.circle(at, 0.5 * scale * slices.diameter, &style);
    }
    svg.finish()
}
