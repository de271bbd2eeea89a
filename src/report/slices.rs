//! Pictures of a crystal in space: a section along the axis, and layers from above.

use std::borrow::Cow;

use super::colour::Scale;
use super::svg::{Anchor, Svg};
use crate::design::SpaceDesign;
use crate::lattice::CrystalSite;
use crate::outcome::SpaceSite;
use crate::page::ink;
use crate::target::{SpaceRegion, Target};

/// What is drawn.
pub(super) struct Slices<'a> {
    pub name: &'a str,
    /// Those of the half.
    pub sites: Cow<'a, [SpaceSite]>,
    pub target: &'a Target<SpaceRegion>,
    /// Of all spheres (m)
    pub diameter: f64,
    /// From the axis to the edge along x (m).
    pub half_width: f64,
}

/// What a sphere is painted by.
pub(super) enum Paint<'a> {
    Material(&'a [u8]),
    Energy(&'a [f64], &'a Scale),
}

impl Paint<'_> {
    fn of(&self, index: usize) -> String {
        match self {
            Self::Material(layout) => ink(layout.get(index).copied().map_or(0, usize::from)).fill.to_owned(),
            Self::Energy(energies, scale) => scale.colour(scale.level(energies.get(index).copied().unwrap_or(0.0))),
        }
    }
}

/// How a region is outlined: thin, so that what it holds is seen.
const FOCAL: &str = r##"fill="none" stroke="#d00000" stroke-width="1.2""##;
const PROTECTED: &str = r##"fill="none" stroke="#0050d0" stroke-width="1.2" stroke-dasharray="4 3""##;

impl<'a> Slices<'a> {
    /// The crystal of a design.
    pub fn of(name: &'a str, design: &'a SpaceDesign) -> Self {
        let block = &design.lattice;
        Self {
            name,
            sites: Cow::Owned(SpaceSite::all(block)),
            target: &design.target,
            diameter: block.diameter(),
            half_width: block.half_widths()[0],
        }
    }

    /// Spheres of both halves, with where they lie along x (m).
    pub fn spheres(&self, wanted: impl Fn(&SpaceSite) -> bool) -> Vec<(usize, f64, &SpaceSite)> {
        let sites = self.sites.iter().enumerate().filter(|(_, site)| wanted(site));
        let sides = |site: &SpaceSite| if site.x < 1e-9 { vec![1.0] } else { vec![1.0, -1.0] };
        sites.flat_map(|(index, site)| sides(site).into_iter().map(move |side| (index, side * site.x, site))).collect()
    }

    /// 1 of a sphere of a focal region, 2 of the protected one, else 0.
    pub fn region(&self, site: &SpaceSite) -> u8 {
        let site = CrystalSite { layer: site.layer, column: site.column, centre: [site.x, site.y, site.z] };
        let holds = |solid: &SpaceRegion| solid.contains(&site, self.diameter);
        if self.target.foci.iter().any(|focus| holds(&focus.region)) {
            1
        } else {
            u8::from(holds(&self.target.protect)) * 2
        }
    }

    /// The regions, and how each is outlined.
    fn regions(&self) -> impl Iterator<Item = (&SpaceRegion, &'static str)> {
        let foci = self.target.foci.iter().map(|focus| (&focus.region, FOCAL));
        foci.chain([(&self.target.protect, PROTECTED)])
    }

    fn last(&self) -> u32 {
        self.sites.iter().map(|site| site.layer).max().unwrap_or(1)
    }

    /// At most so many layers, evenly over those wanted.
    fn some(&self, wanted: impl Fn(u32) -> bool, most: usize) -> Vec<u32> {
        let all: Vec<u32> = (1..=self.last()).filter(|&layer| wanted(layer)).collect();
        let stride = all.len().div_ceil(most).max(1);
        all.into_iter().step_by(stride).collect()
    }

    /// At most so many of the layers in which a layout has anything but the host.
    pub fn holding(&self, layout: &[u8], most: usize) -> Vec<u32> {
        let held = |layer| self.sites.iter().zip(layout).any(|(site, &material)| site.layer == layer && material != 0);
        self.some(held, most)
    }

    /// At most so many of the layers of the regions.
    pub fn scored(&self, most: usize) -> Vec<u32> {
        let spacing = self.spacing();
        let within = |layer| {
            self.regions().any(|(solid, _)| {
                let [first, last] = solid.layers(spacing, self.last());
                (first..=last).contains(&layer)
            })
        };
        self.some(within, most)
    }

    /// Of layers (m)
    fn spacing(&self) -> f64 {
        (2.0_f64 / 3.0).sqrt() * self.diameter
    }

    /// Spheres within 0.45 D of the plane y = 0, painted in as many ways as there are panels, each with its name.
    pub fn section(&self, panels: &[(String, Paint)], bar: Option<&Scale>) -> String {
        let diameter = self.diameter;
        let pixel = (300.0 / (2.0 * self.half_width / diameter + 1.0)).min(14.0);
        let deepest = self.sites.iter().map(|site| site.z).fold(0.0, f64::max) / diameter;
        let (wide, high) = (2.0 * self.half_width / diameter * pixel, deepest * pixel);
        let (left, top, gap) = (30.0, 54.0, 36.0);
        let space = if bar.is_some() { 100.0 } else { 0.0 };
        let title = format!("{}: section along the axis, |y| < 0.45 D", self.name);
        // Bold letters of this size are some eight pixels wide.
        let width = (left + panels.len() as f64 * (wide + pixel + gap) + space).max(8.0 * title.len() as f64 + left);
        let mut svg = Svg::new(width, top + high + 2.0 * pixel + 20.0, self.name);
        svg.text([left, 22.0], 14.0, Anchor::Start, r#"font-weight="bold""#, &title);
        for (k, (name, paint)) in panels.iter().enumerate() {
            let middle = left + k as f64 * (wide + pixel + gap) + 0.5 * (wide + pixel);
            svg.text([middle, 42.0], 12.0, Anchor::Middle, "", name);
            let to = |x: f64, z: f64| [middle + x / diameter * pixel, top + 0.5 * pixel + z / diameter * pixel];
            for (index, x, site) in self.spheres(|site| site.y.abs() < 0.45 * diameter) {
                svg.circle(to(x, site.z), 0.5 * pixel, &format!(r#"fill="{}""#, paint.of(index)));
            }
            for (solid, style) in self.regions() {
                self.outline(&mut svg, solid, style, &to, pixel);
            }
        }
        if let Some(energy) = bar {
            let at = [left + panels.len() as f64 * (wide + pixel + gap), top + 10.0];
            energy.bar(&mut svg, at, (high - 20.0).max(60.0), "greatest kinetic energy (J)", 1.0, [true, false]);
        }
        svg.finish()
    }

    /// A region where the plane y = 0 cuts it, half a sphere wider all round.
    fn outline(&self, svg: &mut Svg, solid: &SpaceRegion, style: &str, to: &impl Fn(f64, f64) -> [f64; 2], pixel: f64) {
        let (rim, spacing) = (0.5 * self.diameter, self.spacing());
        let across = match *solid {
            SpaceRegion::Sphere { centre: [x, y, z], radius } => {
                let radius = (radius * radius - y * y).max(0.0).sqrt();
                for side in if x > 0.0 { vec![1.0, -1.0] } else { vec![1.0] } {
                    svg.circle(to(side * x, z), (radius + rim) / self.diameter * pixel, style);
                }
                return;
            }
            SpaceRegion::Box { y, .. } if y[0] > rim || y[1] < -rim => return,
            SpaceRegion::Box { x, .. } | SpaceRegion::Cylinder { r: x, .. } => x,
        };
        let [first, last] = solid.layers(spacing, self.last()).map(|layer| f64::from(layer - 1) * spacing);
        let ranges = match across[0] <= rim {
            true => vec![[-across[1] - rim, across[1] + rim]],
            false => vec![[across[0] - rim, across[1] + rim], [-across[1] - rim, rim - across[0]]],
        };
        for [from, upto] in ranges {
            let ([left, top], [right, bottom]) = (to(from, first - rim), to(upto, last + rim));
            svg.rectangle([left, top], [right - left, bottom - top], style);
        }
    }

    /// Layers from above, each with its name and its paint.
    pub fn layers(&self, panels: &[(String, u32, Paint)], bar: Option<&Scale>) -> String {
        let diameter = self.diameter;
        let [low, high] = self.sites.iter().fold([0.0_f64; 2], |[a, b], site| [a.min(site.y), b.max(site.y)]);
        let pixel = (150.0 / (2.0 * self.half_width / diameter + 1.0)).min(10.0);
        let (wide, tall) = ((2.0 * self.half_width / diameter + 1.0) * pixel, ((high - low) / diameter + 1.0) * pixel);
        let (left, top, gap, columns) = (20.0, 40.0, 18.0, 4);
        let rows = panels.len().div_ceil(columns).max(1);
        let space = if bar.is_some() { 100.0 } else { 0.0 };
        let size = [left + columns as f64 * (wide + gap) + space, top + rows as f64 * (tall + 36.0) + 10.0];
        let mut svg = Svg::new(size[0], size[1], self.name);
        let title = format!("{}: layers from above", self.name);
        svg.text([left, 22.0], 14.0, Anchor::Start, r#"font-weight="bold""#, &title);
        for (k, (name, layer, paint)) in panels.iter().enumerate() {
            let corner =
                [left + (k % columns) as f64 * (wide + gap), top + (k / columns) as f64 * (tall + 36.0) + 20.0];
            svg.text([corner[0] + 0.5 * wide, corner[1] - 6.0], 11.0, Anchor::Middle, "", name);
            let to = |x: f64, y: f64| {
                [corner[0] + x / diameter * pixel + 0.5 * wide, corner[1] + ((high - y) / diameter + 0.5) * pixel]
            };
            for (index, x, site) in self.spheres(|site| site.layer == *layer) {
                svg.circle(to(x, site.y), 0.5 * pixel, &format!(r#"fill="{}""#, paint.of(index)));
            }
            for (solid, style) in self.regions() {
                self.around(&mut svg, solid, style, *layer, &to, pixel);
            }
        }
        if let Some(energy) = bar {
            let at = [left + columns as f64 * (wide + gap) + 10.0, top + 20.0];
            let long = (size[1] - top - 60.0).clamp(80.0, 260.0);
            energy.bar(&mut svg, at, long, "greatest kinetic energy (J)", 1.0, [true, false]);
        }
        svg.finish()
    }

    /// A region where a layer cuts it, half a sphere wider all round.
    fn around(
        &self,
        svg: &mut Svg,
        solid: &SpaceRegion,
        style: &str,
        layer: u32,
        to: &impl Fn(f64, f64) -> [f64; 2],
        pixel: f64,
    ) {
        let (rim, spacing) = (0.5 * self.diameter, self.spacing());
        let [first, last] = solid.layers(spacing, self.last());
        if !(first..=last).contains(&layer) {
            return;
        }
        let sides = |x: f64| if x > 0.0 { vec![1.0, -1.0] } else { vec![1.0] };
        match *solid {
            SpaceRegion::Cylinder { r: [inner, outer], .. } => {
                let within = if inner > rim { vec![inner - rim, outer + rim] } else { vec![outer + rim] };
                for radius in within {
                    svg.circle(to(0.0, 0.0), radius / self.diameter * pixel, style);
                }
            }
            SpaceRegion::Sphere { centre: [x, y, z], radius } => {
                let apart = f64::from(layer - 1) * spacing - z;
                let cut = (radius * radius - apart * apart).max(0.0).sqrt();
                for side in sides(x) {
                    svg.circle(to(side * x, y), (cut + rim) / self.diameter * pixel, style);
                }
            }
            SpaceRegion::Box { x: [from, upto], y: [low, high], .. } => {
                for side in sides(from - rim) {
                    let [a, b] = if from > rim { [from - rim, upto + rim] } else { [-upto - rim, upto + rim] };
                    let ends = [side * a, side * b];
                    let (x0, x1) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
                    let ([left, top], [right, bottom]) = (to(x0, high + rim), to(x1, low - rim));
                    svg.rectangle([left, top], [right - left, bottom - top], style);
                }
            }
        }
    }
}
