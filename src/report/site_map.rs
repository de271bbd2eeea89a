//! A number for every site of a crystal, drawn on the whole piece.

use super::colour::Scale;
use super::crystal::{Crystal, Extent, Ground};
use super::maps::at;
use super::svg::{Anchor, Svg};
use crate::lattice::HexagonalSheet;
use crate::target::Target;

/// Numbers of both signs, white at zero; lines part the materials. Both are by site, and where the halves differ then by image.
pub(crate) fn site_map(
    title: &str,
    label: &str,
    (lattice, target): (&HexagonalSheet, &Target),
    materials: &[u8],
    values: &[f64],
) -> String {
    const TOP: f64 = 36.0;
    const LEFT: f64 = 46.0;
    const BAR: f64 = 110.0;
    let sites = lattice.sites();
    let ground = Ground { sites: &sites, diameter: lattice.diameter(), half_width: lattice.half_width(), target };
    let room = [560.0, 760.0];
    let [width, height] = Crystal::new(ground, Extent::Both, [0.0, 0.0], room).size();
    let mut svg = Svg::new(LEFT + width + BAR, TOP + height + 20.0, title);
    let crystal = Crystal::new(ground, Extent::Both, [LEFT, TOP], room);
    svg.text([LEFT + width / 2.0, 20.0], 14.0, Anchor::Middle, r#"font-weight="bold""#, title);
    // Both signs equally strong.
    let most = values.iter().filter(|value| value.is_finite()).fold(0.0_f64, |most, value| most.max(value.abs()));
    let scale = Scale::diverging(-most, most);
    crystal.map(&mut svg, &scale, values.len(), |place| at(values, place));
    crystal.boundaries(&mut svg, materials, r##"stroke="#222" stroke-width="0.8""##);
    crystal.regions(&mut svg, 2.0);
    crystal.name_regions(&mut svg, 12.0);
    crystal.row_numbers(&mut svg, 11.0);
    svg.text_upwards([14.0, TOP + height / 2.0], 12.0, "", "row");
    scale.bar(&mut svg, [LEFT + width + 14.0, TOP + 12.0], height - 24.0, label, 1.0, [false, false]);
    svg.finish()
}
