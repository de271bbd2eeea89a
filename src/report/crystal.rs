//! The crystal on paper: where sites come to lie, and what is drawn over them in every picture alike.
//!
//! x runs to the right, depth z downwards, both to the same scale. A map shows the simulated half, or both halves by
//! mirroring it about the crystal's axis; of a piece whose halves differ it shows each half as it is.

use std::collections::HashMap;

use super::colour::{LEVELS, MISSING, Scale};
use super::svg::{Anchor, Shapes, Svg};
use crate::lattice::Site;
use crate::outcome::{Outcome, Proposal};
use crate::target::{Region, Target};

/// Steps from corner to corner of a site's cell, a regular hexagon standing on a corner, in diameters: the part of the sheet
/// that is nearer to this site than to any other. Filled cells leave no gaps between spheres.
const CORNER: [f64; 2] = [0.5, 0.288_675_134_594_812_9];

/// How much of the crystal a picture shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extent {
    /// The simulated half, x ≥ 0.
    Half,
    /// The whole piece.
    Both,
}

/// What a picture needs to know of a crystal.
#[derive(Clone, Copy)]
pub struct Ground<'a> {
    /// Its sites.
    pub sites: &'a [Site],
    /// Sphere diameter (m).
    pub diameter: f64,
    /// Distance from the axis to the far mirror line (m).
    pub half_width: f64,
    /// Where energy is wanted and where it is not.
    pub target: &'a Target,
}

impl<'a> From<&'a Outcome> for Ground<'a> {
    fn from(outcome: &'a Outcome) -> Self {
        let Outcome { sites, diameter, half_width, target, .. } = outcome;
        Self { sites, diameter: *diameter, half_width: *half_width, target }
    }
}

/// A crystal placed in a picture.
#[derive(Clone, Copy)]
pub struct Crystal<'a> {
    ground: Ground<'a>,
    extent: Extent,
    /// Pixels per metre.
    scale: f64,
    /// Where x = 0, z = 0 lies (px).
    origin: [f64; 2],
}

impl<'a> Crystal<'a> {
    /// Places the crystal with the upper left corner of its frame at `corner`, as large as `room` (width and height) allows
    /// but with spheres of at most 40 pixels.
    pub fn new(ground: impl Into<Ground<'a>>, extent: Extent, corner: [f64; 2], room: [f64; 2]) -> Self {
        let ground = ground.into();
        let [width, height] = Self::scaled(ground, extent, corner, 1.0).size();
        Self::scaled(ground, extent, corner, (room[0] / width).min(room[1] / height).min(40.0))
    }

    fn scaled(ground: Ground<'a>, extent: Extent, corner: [f64; 2], per_diameter: f64) -> Self {
        let left = match extent {
            Extent::Half => 0.5 * per_diameter,
            Extent::Both => (ground.half_width / ground.diameter + 0.5) * per_diameter,
        };
        let origin = [corner[0] + left, corner[1] + 2.0 * CORNER[1] * per_diameter];
        Self { ground, extent, scale: per_diameter / ground.diameter, origin }
    }

    /// Upper left corner of the frame around all cells (px).
    pub fn corner(&self) -> [f64; 2] {
        let left = if self.extent == Extent::Half { 0.0 } else { -self.ground.half_width };
        let [x, y] = self.place([left, 0.0]);
        [x - self.diameter() / 2.0, y - 2.0 * CORNER[1] * self.diameter()]
    }

    /// Width and height of the frame (px).
    pub fn size(&self) -> [f64; 2] {
        let right = self.place([self.ground.half_width, self.deepest()]);
        let [left, top] = self.corner();
        [right[0] + self.diameter() / 2.0 - left, right[1] + 2.0 * CORNER[1] * self.diameter() - top]
    }

    /// Where a point (x, z) (m) lies (px).
    pub fn place(&self, [x, z]: [f64; 2]) -> [f64; 2] {
        [self.origin[0] + x * self.scale, self.origin[1] + z * self.scale]
    }

    /// A sphere's diameter (px).
    pub fn diameter(&self) -> f64 {
        self.ground.diameter * self.scale
    }

    /// The greatest depth of a site (m).
    fn deepest(&self) -> f64 {
        self.ground.sites.iter().map(|site| site.z).fold(0.0, f64::max)
    }

    /// Where rows are not those of a hexagonal sheet of equal spheres: how far (m) the cells of each row reach up and down, half way to the rows beside
    /// it, and whether rows stand straight below each other.
    fn uneven(&self) -> Option<(Vec<[f64; 2]>, bool)> {
        let (sites, diameter) = (self.ground.sites, self.ground.diameter);
        let first: Vec<&Site> = sites.iter().filter(|site| site.column == 1).collect();
        let spacing = 0.75_f64.sqrt() * diameter;
        let is_even = |two: &[&Site]| (two[1].z - two[0].z - spacing).abs() < 1e-6 * diameter && two[0].x != two[1].x;
        if first.windows(2).all(is_even) {
            return None;
        }
        let half = |from: usize| first.get(from..from + 2).map(|two| 0.5 * (two[1].z - two[0].z));
        let ends = |row: usize| {
            let (up, down) = (row.checked_sub(1).and_then(half), half(row));
            [up.or(down), down.or(up)].map(|way| way.unwrap_or(0.5 * diameter))
        };
        Some(((0..first.len()).map(ends).collect(), first.windows(2).all(|two| two[0].x == two[1].x)))
    }

    /// The signs with which x is drawn: the half, or the half and its mirror image.
    fn sides(&self) -> &'static [f64] {
        if self.extent == Extent::Half { &[1.0] } else { &[1.0, -1.0] }
    }

    /// Where the spheres lie that a number of a list is of: by site, of one that is as long as there are sites, two in a mirrored picture
    /// but for those on the axis; in one twice as long those of the sites are followed by those of their images.
    pub fn places(&self, index: usize, length: usize) -> impl Iterator<Item = [f64; 2]> + '_ {
        let sites = self.ground.sites.len();
        let site = self.ground.sites[index % sites];
        let on_axis = site.x.abs() < 1e-9 * self.ground.diameter;
        let sides = match (length > sites, index < sites) {
            (false, _) if !on_axis => self.sides(),
            (_, true) => &[1.0][..],
            (_, false) if on_axis || self.extent == Extent::Half => &[],
            (_, false) => &[-1.0],
        };
        sides.iter().map(move |side| self.place([side * site.x, site.z]))
    }

    /// Fills the cells of a list of numbers, `length` long, see [`places`](Self::places), with their colours; white where there is none.
    pub fn map(&self, svg: &mut Svg, scale: &Scale, length: usize, value: impl Fn(usize) -> Option<f64>) {
        let mut levels = vec![Shapes::default(); LEVELS + 1];
        let [half, quarter] = CORNER.map(|c| c * self.diameter());
        // To a tenth of a pixel: maps are most of a page's weight, and the stroke below closes what rounding opens.
        let tenths = |point: [f64; 2]| point.map(|c| (c * 10.0).round() / 10.0);
        let steps = [[half, quarter], [0.0, 2.0 * quarter], [-half, quarter], [-half, -quarter], [0.0, -2.0 * quarter]];
        let steps = steps.map(tenths);
        let uneven = self.uneven();
        for index in 0..length.max(self.ground.sites.len()) {
            let chosen = value(index).map_or(LEVELS, |v| scale.level(v));
            for [x, y] in self.places(index, length) {
                if let Some((rows, _)) = &uneven {
                    let row = self.ground.sites[index % self.ground.sites.len()].row as usize - 1;
                    let [up, down] = rows[row].map(|way| way * self.scale);
                    let steps = [[2.0 * half, 0.0], [0.0, up + down], [-2.0 * half, 0.0]].map(tenths);
                    levels[chosen].closed(tenths([x - half, y - up]), &steps);
                    continue;
                }
                levels[chosen].closed(tenths([x, y - 2.0 * quarter]), &steps);
            }
        }
        for (k, shapes) in levels.iter().enumerate() {
            let colour = if k == LEVELS { MISSING.to_owned() } else { scale.colour(k) };
            // The thin stroke closes the seams that anti-aliasing leaves between cells.
            svg.path(shapes.data(), &format!(r#"fill="{colour}" stroke="{colour}" stroke-width="0.9""#));
        }
    }

    /// Lines between cells of different material, of all sites, or of them and then of their images.
    pub fn boundaries(&self, svg: &mut Svg, layout: &[u8], attributes: &str) {
        // Along x in half diameters: neighbours are two such steps away in the row, one in the rows beside it.
        let position = |x: f64| (2.0 * x / self.ground.diameter).round() as i64;
        let sites = self.ground.sites;
        let halves_differ = layout.len() > sites.len() && self.extent == Extent::Both;
        let shown = if halves_differ { layout.len() } else { sites.len().min(layout.len()) };
        let x = |k: usize| if k < sites.len() { sites[k].x } else { -sites[k % sites.len()].x };
        let places: HashMap<(u32, i64), u8> =
            (0..shown).map(|k| ((sites[k % sites.len()].row, position(x(k))), layout[k])).collect();
        let [half, quarter] = CORNER.map(|c| c * self.diameter());
        let mut lines = Shapes::default();
        let uneven = self.uneven();
        for k in 0..shown {
            let (site, own, p) = (&sites[k % sites.len()], layout[k], position(x(k)));
            if k >= sites.len() && p == 0 {
                continue;
            }
            let differs = |row: u32, p: i64| places.get(&(row, p)).is_some_and(|&other| other != own);
            // Each pair once: the neighbours to the right, below left and below right.
            let edges = [
                (differs(site.row, p + 2), [half, -quarter], [half, quarter]),
                (differs(site.row + 1, p - 1), [-half, quarter], [0.0, 2.0 * quarter]),
                (differs(site.row + 1, p + 1), [half, quarter], [0.0, 2.0 * quarter]),
            ];
            let edges = match &uneven {
                None => edges,
                Some((rows, is_square)) => {
                    let [up, down] = rows[site.row as usize - 1].map(|way| way * self.scale);
                    let middle = if *is_square { half } else { 0.0 };
                    let below = if *is_square { [0, 0] } else { [-1, 1] };
                    [
                        (differs(site.row, p + 2), [half, -up], [half, down]),
                        (differs(site.row + 1, p + below[0]), [-half, down], [middle, down]),
                        (!is_square && differs(site.row + 1, p + below[1]), [middle, down], [half, down]),
                    ]
                }
            };
            let sides = if halves_differ { &[1.0][..] } else { self.sides() };
            for &side in sides {
                let [x, y] = self.place([side * x(k), site.z]);
                for (_, from, to) in edges.iter().filter(|edge| edge.0) {
                    lines.segment([x + side * from[0], y + from[1]], [x + side * to[0], y + to[1]]);
                }
            }
        }
        svg.path(lines.data(), &format!(r#"fill="none" stroke-linecap="round" {attributes}"#));
    }

    /// The rectangles (px) that a region covers: corner and size. One where it meets the axis, or in the half; else two.
    fn rectangles(&self, region: &Region) -> Vec<([f64; 2], [f64; 2])> {
        // Centres are D/2 apart in x from row to row, so D/4 beyond the region parts what is inside from what is not;
        // at the rim, and at the axis of the half, whole spheres are enclosed.
        let quarter = self.ground.diameter / 4.0;
        let rim = self.ground.half_width - quarter;
        let right = region.x[1] + if region.x[1] > rim { 2.0 * quarter } else { quarter };
        let meets_axis = region.x[0] < quarter;
        let left = match (meets_axis, self.extent) {
            (true, Extent::Half) => -2.0 * quarter,
            (true, Extent::Both) => -right,
            (false, _) => region.x[0] - quarter,
        };
        let spacing = 0.75_f64.sqrt() * self.ground.diameter;
        let depth = |row: f64| (row - 1.0) * spacing;
        let [top, bottom] = match self.uneven() {
            None => [depth(f64::from(region.rows[0]) - 0.5), depth(f64::from(region.rows[1]) + 0.5)],
            Some((rows, _)) => {
                let at = |row: u32| self.ground.sites.iter().find(|site| site.row == row).map_or(0.0, |site| site.z);
                let [first, last] = region.rows;
                [at(first) - rows[first as usize - 1][0], at(last) + rows[last as usize - 1][1]]
            }
        };
        let rectangle = |a: f64, b: f64| {
            let ([x1, y1], [x2, y2]) = (self.place([a.min(b), top]), self.place([a.max(b), bottom]));
            ([x1, y1], [x2 - x1, y2 - y1])
        };
        let sides = if meets_axis { &[1.0][..] } else { self.sides() };
        sides.iter().map(|side| rectangle(side * left, side * right)).collect()
    }

    /// Outlines the focal regions (solid) and the protected one (dashed): a white line with a dark edge, to be seen on
    /// every colour.
    pub fn regions(&self, svg: &mut Svg, width: f64) {
        let target = self.ground.target;
        let foci = target.foci.iter().map(|focus| (&focus.region, ""));
        for (region, dash) in foci.chain([(&target.protect, r#"stroke-dasharray="5 3""#)]) {
            for (corner, size) in self.rectangles(region) {
                svg.rectangle(corner, size, &format!(r##"fill="none" stroke="#222" stroke-width="{}""##, width + 1.6));
                svg.rectangle(corner, size, &format!(r##"fill="none" stroke="#fff" stroke-width="{width}" {dash}"##));
            }
        }
    }

    /// Writes the regions' names into them, or above them where they are too low for a line of text.
    pub fn name_regions(&self, svg: &mut Svg, size: f64) {
        let target = self.ground.target;
        for (region, name) in target.named_foci().into_iter().chain([(&target.protect, "protected".to_owned())]) {
            for ([x, y], [width, height]) in self.rectangles(region) {
                // Bold letters are some 0.6 of their size wide.
                let size = size.min(width / (0.6 * name.len() as f64));
                let middle = if height > 2.0 * size { y + height / 2.0 + size * 0.35 } else { y - size * 0.5 };
                halo(svg, [x + width / 2.0, middle], size, Anchor::Middle, &name);
            }
        }
    }

    /// The rays of the proposal, cut off at the frame.
    pub fn rays(&self, svg: &mut Svg, proposal: &Proposal, attributes: &str) {
        svg.clipped(self.corner(), self.size(), |svg| {
            for ray in &proposal.rays {
                self.mirrored(svg, ray, attributes);
            }
        });
    }

    /// The ideal faces of the lens.
    pub fn faces(&self, svg: &mut Svg, proposal: &Proposal, attributes: &str) {
        for face in &proposal.faces {
            self.mirrored(svg, face, attributes);
        }
    }

    /// A line (m) and, in a mirrored picture, its mirror image.
    pub fn mirrored(&self, svg: &mut Svg, line: &[[f64; 2]], attributes: &str) {
        for side in self.sides() {
            let points: Vec<_> = line.iter().map(|&[x, z]| self.place([side * x, z])).collect();
            svg.polyline(&points, attributes);
        }
    }

    /// Row numbers to the left of the frame: row 1 and every fifth, tenth, ... so that they do not crowd.
    pub fn row_numbers(&self, svg: &mut Svg, size: f64) {
        let spacing = 0.75_f64.sqrt() * self.diameter();
        let rounds = [5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000];
        let every = rounds.into_iter().find(|&n| f64::from(n) * spacing >= 40.0).unwrap_or(10_000);
        let left = self.corner()[0] - 4.0;
        for site in self.ground.sites.iter().filter(|s| s.column == 1 && (s.row == 1 || s.row % every == 0)) {
            let y = self.place([0.0, site.z])[1];
            svg.line([left, y], [left + 3.0, y], r##"stroke="#555""##);
            svg.text([left - 3.0, y + size * 0.36], size, Anchor::End, "", &site.row.to_string());
        }
    }
}

/// Text on a white halo, legible on any background.
pub fn halo(svg: &mut Svg, at: [f64; 2], size: f64, anchor: Anchor, text: &str) {
    let attributes =
        r##"font-weight="bold" stroke="#fff" stroke-width="3.5" stroke-linejoin="round" paint-order="stroke""##;
    svg.text(at, size, anchor, attributes, text);
}
