//! What goes on inside a packing as pictures: the force network with its chains, and non-affine motion.

use std::collections::BTreeSet;

use super::chart::ticks;
use super::colour::{LEVELS, Scale, level};
use super::crystal::{Crystal, Extent};
use super::digits::significant;
use super::maps::{BAR, ROWS, SITES};
use super::svg::{Anchor, Shapes, Svg};
use crate::motion::Local;
use crate::network::{ANGLE, Branch, Carrier, Chains, Network};
use crate::outcome::{Inside, Outcome};

/// Longer side of what is drawn (px).
const SIDE: f64 = 860.0;
/// Room at the left, above, at the right and below (px).
const ROOM: [f64; 4] = [20.0, 44.0, 110.0, 40.0];

/// How places are put on paper.
#[derive(Clone, Copy, Debug)]
pub struct View<'a> {
    /// The name of the unit that lengths are shown in, and how many of it a length of 1 is.
    pub unit: (&'a str, f64),
    /// Whether z grows downwards, as the depth of a crystal does, rather than upwards, as height does.
    pub down: bool,
    /// Grains that stand out: centres and radii.
    pub marked: &'a [([f64; 2], f64)],
}

impl View<'_> {
    /// Heights, in a unit of length that is not known.
    pub const PLAIN: View<'static> = View { unit: ("unit of length", 1.0), down: false, marked: &[] };
    /// Depths in a crystal, given in metres.
    pub const CRYSTAL: View<'static> = View { unit: ("mm", 1e3), down: true, marked: &[] };
}

/// A paper for places (x, z), with a title and a scale bar for lengths.
struct Sheet<'a> {
    view: View<'a>,
    low: [f64; 2],
    high: [f64; 2],
    /// Pixels per unit of length.
    size: f64,
}

impl<'a> Sheet<'a> {
    fn around(view: View<'a>, places: impl Iterator<Item = [f64; 2]>, margin: f64) -> Self {
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for place in places {
            for k in 0..2 {
                (low[k], high[k]) = (low[k].min(place[k] - margin), high[k].max(place[k] + margin));
            }
        }
        let long = (high[0] - low[0]).max(high[1] - low[1]);
        Self { view, low, high, size: if long > 0.0 { SIDE / long } else { 1.0 } }
    }

    fn extent(&self) -> [f64; 2] {
        [(self.high[0] - self.low[0]) * self.size, (self.high[1] - self.low[1]) * self.size]
    }

    fn at(&self, [x, z]: [f64; 2]) -> [f64; 2] {
        let down = if self.view.down { z - self.low[1] } else { self.high[1] - z };
        [ROOM[0] + (x - self.low[0]) * self.size, ROOM[1] + down * self.size]
    }

    fn begin(&self, title: &str) -> Svg {
        let [width, height] = self.extent();
        let mut svg = Svg::new(ROOM[0] + width + ROOM[2], ROOM[1] + height + ROOM[3], title);
        svg.text([ROOM[0], 24.0], 14.0, Anchor::Start, r#"font-weight="bold""#, title);
        for (place, radius) in self.view.marked {
            svg.circle(self.at(*place), radius * self.size, r##"fill="#f0e2bd""##);
        }
        svg
    }

    /// The frame, the bar of colours, and a bar of a round length.
    fn finish(&self, mut svg: Svg, scale: &Scale, label: &str, beyond: [bool; 2]) -> String {
        let [width, height] = self.extent();
        svg.rectangle([ROOM[0], ROOM[1]], [width, height], r##"fill="none" stroke="#555""##);
        let corner = [ROOM[0] + width + 24.0, ROOM[1] + 14.0];
        scale.bar(&mut svg, corner, (height - 28.0).clamp(40.0, 300.0), label, 1.0, beyond);
        let (name, many) = self.view.unit;
        let round = ticks(0.0, many * (self.high[0] - self.low[0]) / 3.0, 3).last().copied().unwrap_or(1.0);
        let below = ROOM[1] + height + 14.0;
        let (from, to) = ([ROOM[0], below], [ROOM[0] + round / many * self.size, below]);
        svg.line(from, to, r##"stroke="#222" stroke-width="3""##);
        svg.text([to[0] + 8.0, below + 4.0], 12.0, Anchor::Start, "", &format!("{round} {name}"));
        svg.finish()
    }
}

/// A force network: contacts as lines, as broad and as dark as their normal force is great, and force chains below them. None where
/// places are not known.
pub fn draw_network(title: &str, network: &Network, mean: f64, chains: &Chains, view: View) -> Option<String> {
    let branches = network.branches()?;
    let ends = |branch: &Branch| {
        let Branch { from, vector } = *branch;
        [from, [from[0] + vector[0], from[1] + vector[1]]]
    };
    let length = branches.iter().map(Branch::length).sum::<f64>() / branches.len().max(1) as f64;
    let sheet = Sheet::around(view, branches.iter().flat_map(ends), 0.5 * length);
    let title = format!("{title}: normal forces in multiples of the mean; chains of three or more in blue");
    let mut svg = sheet.begin(&title);
    let of = |c: usize| network.contacts()[c].normal.abs() / mean;
    let scale = Scale::linear((0..branches.len()).map(of).fold(0.0, f64::max));
    let linked = linked(chains);
    let [width, height] = sheet.extent();
    svg.clipped([ROOM[0], ROOM[1]], [width, height], |svg| {
        let mut under = Shapes::default();
        for (contact, branch) in network.contacts().iter().zip(branches) {
            if linked.contains(&pair(contact.grains)) {
                let [from, to] = ends(branch);
                under.segment(sheet.at(from), sheet.at(to));
            }
        }
        below_chains(svg, &under, length * sheet.size);
        let lines = (0..branches.len()).map(|c| (of(c), ends(&branches[c]).map(|end| sheet.at(end))));
        by_force(svg, &scale, 0.5 * length * sheet.size, lines);
    });
    Some(sheet.finish(svg, &scale, "normal force over mean", [false, false]))
}

/// Two grains, the lower number first.
fn pair([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

/// Pairs of grains that are next to each other in a chain.
fn linked(chains: &Chains) -> BTreeSet<[u32; 2]> {
    chains.chains.iter().flat_map(|chain| chain.windows(2).map(|two| pair([two[0], two[1]]))).collect()
}

/// Paints what lies below chains; `length` is that of a contact (px).
fn below_chains(svg: &mut Svg, under: &Shapes, length: f64) {
    let broad = 0.7 * length;
    let attributes = format!(r##"stroke="#bcd9ee" stroke-width="{broad:.2}" stroke-linecap="round" fill="none""##);
    svg.path(under.data(), &attributes);
}

/// Lines whose forces are on a scale from zero, those of one colour together, the strongest on top and as broad as `broad` (px).
fn by_force(svg: &mut Svg, scale: &Scale, broad: f64, lines: impl Iterator<Item = (f64, [[f64; 2]; 2])>) {
    let mut levels = vec![Shapes::default(); LEVELS];
    for (force, [from, to]) in lines {
        levels[scale.level(force)].segment(from, to);
    }
    for (k, shapes) in levels.iter().enumerate() {
        let width = broad * ((k as f64 + 0.5) / LEVELS as f64).sqrt();
        let colour = level(k);
        svg.path(shapes.data(), &format!(r#"fill="none" stroke="{colour}" stroke-width="{width:.2}""#));
    }
}

/// A lens from inside, both halves: its contacts when the focal region has most kinetic energy, and D²_min once all is over.
pub(super) fn draw_lens(outcome: &Outcome, inside: &Inside) -> Option<String> {
    const TOP: f64 = 36.0;
    let lens = outcome.arrangements.first()?;
    let rows: Vec<u32> = outcome.sites.iter().map(|site| site.row).collect();
    let network = inside.network(&rows, [1, u32::MAX])?;
    let (mean, branches) = (network.mean(Carrier::Contacts), network.branches()?);
    if mean == 0.0 {
        return None;
    }
    let room = [392.0, 620.0];
    let [width, height] = Crystal::new(outcome, Extent::Both, [0.0, 0.0], room).size();
    let column = ROWS + width + BAR;
    let panels = if inside.d2min.is_empty() { 1.0 } else { 2.0 };
    let title = format!("{}: force network at the moment of focus, and damage", outcome.manifest.name);
    let mut svg = Svg::new(column * panels, TOP + height + 20.0, &title);
    let begin = |svg: &mut Svg, k: usize, heading: &str| {
        let left = column * k as f64;
        let crystal = Crystal::new(outcome, Extent::Both, [left + ROWS, TOP], room);
        svg.text([left + ROWS + width / 2.0, 20.0], 14.0, Anchor::Middle, r#"font-weight="bold""#, heading);
        svg.text_upwards([left + 14.0, TOP + height / 2.0], 12.0, "", "row");
        crystal.row_numbers(svg, 11.0);
        crystal
    };
    let finish = |svg: &mut Svg, k: usize, crystal: &Crystal, scale: &Scale, (label, unit): (&str, f64), beyond| {
        let right = column * k as f64 + ROWS + width + 14.0;
        crystal.regions(svg, 2.0);
        scale.bar(svg, [right, TOP + 12.0], height - 24.0, label, unit, beyond);
    };

    let crystal = begin(&mut svg, 0, &format!("contacts at {} us", significant(1e6 * inside.moment, 3)));
    let of = |c: usize| network.contacts()[c].normal.abs() / mean;
    let scale = Scale::linear((0..branches.len()).map(of).fold(0.0, f64::max));
    let linked = linked(&Chains::new(&network, ANGLE)?);
    // A contact over the seam is drawn at both sides, and cut off there.
    let lines = |c: usize| {
        let [x, z] = branches[c].vector;
        let [from, to] = network.contacts()[c].grains.map(|i| inside.places[i as usize]);
        let seam = (to[0] - from[0] - x).abs() > 0.5 * inside.period;
        let own = [from, [from[0] + x, from[1] + z]];
        let other = [[to[0] - x, to[1] - z], to];
        [Some(own), seam.then_some(other)].into_iter().flatten().map(|line| line.map(|end| crystal.place(end)))
    };
    svg.clipped(crystal.corner(), crystal.size(), |svg| {
        let mut under = Shapes::default();
        for c in (0..branches.len()).filter(|&c| linked.contains(&pair(network.contacts()[c].grains))) {
            lines(c).for_each(|[from, to]| under.segment(from, to));
        }
        below_chains(svg, &under, crystal.diameter());
        let all = (0..branches.len()).flat_map(|c| lines(c).map(move |line| (of(c), line)));
        by_force(svg, &scale, 0.5 * crystal.diameter(), all);
    });
    crystal.boundaries(&mut svg, &lens.layout, r##"stroke="#c2410c" stroke-width="0.9""##);
    let label = format!("normal force over the mean, {} N", significant(mean, 3));
    finish(&mut svg, 0, &crystal, &scale, (&label, 1.0), [false, false]);

    if !inside.d2min.is_empty() {
        let values = || inside.d2min.iter().copied().flatten();
        let scale = Scale::logarithmic(values());
        let crystal = begin(&mut svg, 1, &format!("damage after {} us", significant(1e6 * inside.until, 3)));
        crystal.map(&mut svg, &scale, inside.d2min.len(), |site| inside.d2min[site]);
        for line in SITES {
            crystal.boundaries(&mut svg, &lens.layout, line);
        }
        let below = values().any(|value| value < scale.low());
        finish(&mut svg, 1, &crystal, &scale, ("D²_min (mm²)", 1e-6), [false, below]);
    }
    Some(svg.finish())
}

/// Non-affine motion: grains where they were, coloured by D²_min on a logarithmic scale; those without it are hollow. `diameter` is that
/// of the circles.
pub fn draw_motion(title: &str, places: &[[f64; 2]], locals: &[Local], diameter: f64, view: View) -> String {
    let sheet = Sheet::around(view, places.iter().copied(), 0.5 * diameter);
    let mut svg = sheet.begin(&format!("{title}: D²_min, what no affine map of a neighbourhood explains"));
    let (name, many) = view.unit;
    let of = |local: &Local| local.d2min.map(|d2min| many * many * d2min);
    let scale = Scale::logarithmic(locals.iter().filter_map(of));
    let below = locals.iter().filter_map(of).any(|value| value < scale.low());
    for (place, local) in places.iter().zip(locals) {
        let fill = of(local).map_or("none".to_owned(), |value| level(scale.level(value)));
        let is_marked = view.marked.iter().any(|(marked, _)| marked == place);
        let rim =
            if is_marked { r##"stroke="#111" stroke-width="0.9""## } else { r##"stroke="#888" stroke-width="0.25""## };
        let attributes = format!(r##"fill="{fill}" {rim}"##);
        svg.circle(sheet.at(*place), 0.5 * diameter * sheet.size, &attributes);
    }
    let label = if many == 1.0 { "D²_min (length squared)".to_owned() } else { format!("D²_min ({name}²)") };
    sheet.finish(svg, &scale, &label, [false, below])
}
