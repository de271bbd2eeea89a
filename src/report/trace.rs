//! Rays, wavefronts and first arrivals on paper.

use super::crystal::{Crystal, Extent, Ground};
use super::drawing::{axis, impact, spheres, swatch};
use super::svg::{Anchor, Shapes, Svg};
use crate::outcome::{Front, Traced};
use crate::units::Dimension;

/// Room for the crystal (px).
const ROOM: [f64; 2] = [720.0, 900.0];

/// Margins around the crystal: left (row numbers), top (impact), right (times), bottom (legend) (px).
const MARGIN: [f64; 4] = [52.0, 78.0, 74.0, 150.0];

const RAY: &str = r##"stroke="#c0202a" stroke-width="1" stroke-opacity="0.8""##;
const FACE: &str = r##"stroke="#1f4e9c" stroke-width="3" stroke-linecap="round""##;
const WAVE: &str = r##"stroke="#111" stroke-width="1.5""##;
const FIRST: &str = r##"stroke="#0a7d4f" stroke-width="1.4" stroke-dasharray="1.5 3" stroke-linecap="round""##;
const CAUSTIC: &str = r##"stroke="#e07b00" stroke-width="3.2" stroke-linecap="round""##;

/// The picture of a traced design, both halves: spheres pale, faces, rays, their wavefronts at equal times, the caustic, first
/// arrivals at the same times, the regions, and a legend.
pub fn trace(traced: &Traced) -> String {
    let ground = Ground {
        sites: &traced.sites,
        diameter: traced.diameter,
        half_width: traced.half_width,
        target: &traced.target,
    };
    let crystal = Crystal::new(ground, Extent::Both, [MARGIN[0], MARGIN[1]], ROOM);
    let [width, height] = crystal.size();
    let full = [MARGIN[0] + width.max(560.0) + MARGIN[2], MARGIN[1] + height + MARGIN[3]];
    let mut svg = Svg::new(full[0], full[1], &format!("{}: rays and wavefronts", traced.name));
    impact(&mut svg, &crystal, &traced.impact);
    svg.group(r#"opacity="0.35""#, |svg| spheres(svg, &crystal, traced.materials.len(), &traced.layout));
    axis(&mut svg, &crystal);
    svg.clipped(crystal.corner(), crystal.size(), |svg| {
        for ray in &traced.rays {
            crystal.mirrored(svg, &ray.points, RAY);
        }
        for front in &traced.isochrones {
            first_arrivals(svg, &crystal, front);
        }
        for front in &traced.wavefronts {
            for line in &front.lines {
                crystal.mirrored(svg, line, WAVE);
            }
        }
        for line in &traced.caustic {
            crystal.mirrored(svg, line, CAUSTIC);
        }
    });
    if let Some(proposal) = &traced.proposal {
        crystal.faces(&mut svg, proposal, FACE);
    }
    crystal.regions(&mut svg, 2.0);
    crystal.name_regions(&mut svg, 13.0);
    crystal.row_numbers(&mut svg, 11.0);
    svg.text_upwards([14.0, MARGIN[1] + height / 2.0], 12.0, "", "row, counted along the wave (depth z)");
    times(&mut svg, &crystal, traced);
    legend(&mut svg, traced, MARGIN[1] + height + 44.0);
    svg.finish()
}

/// The pieces of one isochrone as one element, and its mirror image.
fn first_arrivals(svg: &mut Svg, crystal: &Crystal, front: &Front) {
    let mut pieces = Shapes::default();
    for side in [1.0, -1.0] {
        for line in &front.lines {
            if let [from, to] = line[..] {
                let [from, to] = [from, to].map(|[x, z]| crystal.place([side * x, z]));
                pieces.segment(from, to);
            }
        }
    }
    svg.path(pieces.data(), &format!(r#"fill="none" {FIRST}"#));
}

/// The time of each first arrival at the right rim, as far as there is room.
fn times(svg: &mut Svg, crystal: &Crystal, traced: &Traced) {
    let right = crystal.corner()[0] + crystal.size()[0] + 5.0;
    let mut last = f64::NEG_INFINITY;
    // First arrivals reach the rim, which rays may leave; their times are the same.
    for front in &traced.isochrones {
        let at_rim = front.lines.iter().flatten().filter(|p| p[0] > 0.97 * traced.half_width).map(|p| p[1]);
        let Some(depth) = at_rim.max_by(f64::total_cmp) else { continue };
        let y = crystal.place([0.0, depth])[1];
        if y - last > 14.0 {
            svg.text([right, y + 4.0], 11.0, Anchor::Start, "", &Dimension::Time.show(front.time));
            last = y;
        }
    }
}

fn legend(svg: &mut Svg, traced: &Traced, top: f64) {
    let left = MARGIN[0] + 8.0;
    for (k, name) in traced.materials.iter().enumerate() {
        let y = top + 21.0 * k as f64;
        swatch(svg, [left, y], k);
        svg.text([left + 16.0, y + 4.0], 12.0, Anchor::Start, "", name);
    }
    let first = match traced.decays.is_empty() {
        true => "first arrival on the lattice, same times",
        false => "first arrival of a wave that decays, same times",
    };
    let lines: [(&str, &str, bool); 5] = [
        (FACE, "faces", traced.proposal.is_some()),
        (RAY, "rays by Snell\u{2019}s law", !traced.rays.is_empty()),
        (WAVE, "where they are at equal times", !traced.wavefronts.is_empty()),
        (CAUSTIC, "caustic: where rays crowd", !traced.caustic.is_empty()),
        (FIRST, first, !traced.isochrones.is_empty()),
    ];
    for (k, (style, words, _)) in lines.iter().filter(|line| line.2).enumerate() {
        let (x, y) = (left + 230.0, top + 21.0 * k as f64);
        svg.line([x, y], [x + 28.0, y], style);
        svg.text([x + 36.0, y + 4.0], 12.0, Anchor::Start, "", words);
    }
}
