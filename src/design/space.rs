//! What differs of a design in space: how its crystal is laid, its regions, and a lens that is revolved or extruded.

use std::path::Path;

use super::check::{Ground, checked};
use super::file::{CrystalFile, LensFile, TargetFile};
use super::lens::{Lying, SYMMETRIES, request};
use super::region::{self, Keys, MOST_FOCI, how, share};
use super::{DesignError, SpaceDesign};
use crate::document::{Entry, Scope};
use crate::lattice::{Block, BlockError, BlockSide, Cell, Layered, Outline};
use crate::lens::{Body, Continued, LensError, LensRequest, Raster, Stack, Symmetry, propose_body};
use crate::material::Material;
use crate::target::{Focus, Region, SpaceRegion, Target};
use crate::units::Dimension;

/// Packings of designs in space.
pub(super) const PACKINGS: [&str; 2] = ["hcp", "fcc-111"];

/// Whether a text asks for one of them; what else is wrong with it the check tells.
pub(super) fn is_in_space(text: &str) -> bool {
    let table = text.parse::<toml::Table>().ok();
    let packing = table.as_ref().and_then(|table| table.get("crystal")?.get("packing")?.as_str());
    packing.is_some_and(|packing| PACKINGS.contains(&packing))
}

pub(super) fn design(path: &Path, text: &str) -> Result<SpaceDesign, DesignError> {
    checked(path, text, block, target, lens)
}

fn block(scope: &Scope, file: &CrystalFile) -> Result<Block, DesignError> {
    let packing = scope.required("packing", &file.packing)?.choice("packing", &PACKINGS.map(|name| (name, name)))?;
    scope.forbid(
        &[("rows", &file.rows), ("half_width", &file.half_width)],
        "a crystal in space",
        "Its size is layers and cells.",
    )?;
    scope.forbid(&[("friction", &file.friction)], "a design in space", "Leave it out; rigs in space know friction.")?;
    scope.forbid(&[("diameters", &file.diameters)], "a crystal in space", "Its spheres are equal.")?;
    let diameter = scope.required("diameter", &file.diameter)?.positive(Dimension::Length)?;
    let layers = scope.required("layers", &file.layers)?.whole(2..=100_000)?;
    let cells = scope.required("cells", &file.cells)?;
    let [wide, high] = cells.pair()?;
    let wide = wide.whole(4..=10_000)?;
    let high = high.whole(3..=10_000)?;
    let axis_layer = match scope.optional("axis_layer", &file.axis_layer) {
        Some(entry) => entry.whole(1..=layers)?,
        None => 1,
    };
    let entry = scope.required("sides", &file.sides)?;
    let side = |entry: &Entry| {
        let all = [
            ("mirror", BlockSide::Mirror),
            ("period", BlockSide::Period),
            ("wall", BlockSide::Wall),
            ("free", BlockSide::Free),
        ];
        entry.choice("kind of sides", &all)
    };
    let sides = if entry.is_list() {
        let [x, y] = entry.pair()?;
        [side(&x)?, side(&y)?]
    } else {
        [side(&entry)?; 2]
    };
    let sites = f64::from(layers) * f64::from(wide) * f64::from(high);
    crate::memory::suffices(sites, crate::memory::DESIGN_SITE)
        .map_err(|rule| scope.fail(&rule, "Choose fewer layers or cells, or run it where there is more."))?;
    let cell = Cell::<3>::named(packing).ok_or_else(|| scope.fail("has no such packing", ""))?;
    let radius = 0.5 * f64::from(wide);
    let outline = match scope.optional("outline", &file.outline) {
        None => Outline::All,
        Some(outline) => {
            let all =
                [("rectangle", Outline::All), ("round", Outline::Disk(radius)), ("hexagon", Outline::Hexagon(radius))];
            let chosen = outline.choice("outline", &all)?;
            let around = [[BlockSide::Free; 2], [BlockSide::Wall; 2]];
            if chosen != Outline::All && !around.contains(&sides) {
                let help = "Write sides = \"free\", or sides = \"wall\" for a wall around it.";
                return Err(entry.fail("is neither free nor a wall, and the outline is not a rectangle", help));
            }
            chosen
        }
    };
    let block = Block::new(cell, diameter, layers, [wide, high], axis_layer, sides);
    block.and_then(|block| block.within(outline)).map_err(|error| match error {
        BlockError::Outline => cells.fail(
            &format!("does not hold an outline that reaches {radius} D from the axis"),
            "Add cells along y: each is √3 D wide.",
        ),
        BlockError::Mirror => entry.fail(
            "has a mirror along y, where a close packing is not its own image",
            "Write period, wall or free for y, like sides = [\"mirror\", \"period\"].",
        ),
        error => scope.fail(&format!("cannot be laid: {error}"), "Change layers or cells."),
    })
}

fn target((scope, file): &(Scope, &TargetFile), block: &Block) -> Result<Target<SpaceRegion>, DesignError> {
    let foci = scope.one_or_several("focus", &file.focus, &how("focus"))?;
    if foci.len() > MOST_FOCI {
        return Err(scope.fail(&format!("has {} foci, more than {MOST_FOCI}", foci.len()), "Leave fewer of them."));
    }
    let (place, protect) = scope.required_section("protect", &file.protect, &how("protect"))?;
    let mut wanted = Vec::new();
    for (scope, file) in &foci {
        wanted.push((solid(scope, &Keys::from(file), block)?, share(scope, &file.share, foci.len())?));
    }
    let protect = solid(&place, &Keys::from(&protect), block)?;
    for ((focus, _), (scope, _)) in wanted.iter().zip(&foci) {
        let diameter = block.diameter();
        let shared =
            block.sites().iter().find(|site| focus.contains(site, diameter) && protect.contains(site, diameter));
        if let Some(site) = shared {
            let [x, y, _] = site.centre.map(|x| (x / diameter * 1e3).round() / 1e3);
            return Err(place.fail(
                &format!(
                    "shares spheres with {}, such as that of layer {} at x = {x} D, y = {y} D",
                    scope.name(),
                    site.layer
                ),
                "Move or shrink one of them; energy cannot be wanted and unwanted in the same sphere.",
            ));
        }
    }
    let sum: f64 = wanted.iter().map(|(_, share)| share).sum();
    Ok(Target {
        foci: wanted.into_iter().map(|(region, share)| Focus { region, share: share / sum }).collect(),
        protect,
    })
}

/// A region: `layers` with `r`, a disc or ring about the axis; `layers` with `x` and `y`, a box; `centre` and `radius`, a sphere.
fn solid<'a>(scope: &Scope<'a>, keys: &Keys<'a>, block: &Block) -> Result<SpaceRegion, DesignError> {
    let Keys { rows, layers, x, y, r, centre, radius } = *keys;
    scope.forbid(&[("rows", rows)], "a region in space", "Write layers.")?;
    let diameter = block.diameter();
    let range = |key: &str, written, least: f64| -> Result<[f64; 2], DesignError> {
        let entry = scope.required(key, written)?;
        let [low, high] = entry.pair()?;
        let ends = [low.length(diameter)?, high.length(diameter)?];
        let shown = entry.range_text();
        if ends[0] > ends[1] {
            return Err(entry.fail_as(&shown, "is reversed", "Write the lower end first."));
        }
        if ends[0] < least {
            return Err(entry.fail_as(
                &shown,
                "begins below zero",
                "Begin at \"0 D\" or beyond: a design describes the half x >= 0, and distances are not negative.",
            ));
        }
        Ok(ends)
    };
    let solid = match (scope.optional("centre", centre), scope.optional("r", r)) {
        (Some(entry), _) => {
            let strange = [("layers", layers), ("r", r), ("x", x), ("y", y)];
            scope.forbid(&strange, "a region that is a sphere", "A sphere is centre and radius.")?;
            let items = entry.items()?;
            let [x, y, z] = &items[..] else {
                return Err(entry.refuse("must be a list of three lengths: x, y and the depth below layer 1"));
            };
            let centre = [x.length(diameter)?, y.length(diameter)?, z.length(diameter)?];
            if centre[0] < 0.0 {
                return Err(
                    entry.fail("lies at x below zero", "A design describes the half x >= 0; the other is its image.")
                );
            }
            let entry = scope.required("radius", radius)?;
            match entry.length(diameter)? {
                radius if radius >= 0.0 => SpaceRegion::Sphere { centre, radius },
                _ => return Err(entry.fail("must not be negative", &entry.write_it_like())),
            }
        }
        (None, of_disc) => {
            let within = region::rows(&scope.required("layers", layers)?, ("layer", block.layers()))?;
            scope.forbid(
                &[("radius", radius)],
                "this region",
                "A sphere is centre and radius; a disc is layers and r.",
            )?;
            if of_disc.is_some() || (x.is_none() && y.is_none()) {
                scope.forbid(
                    &[("x", x), ("y", y)],
                    "a region about the axis",
                    "A box is layers, x and y; a disc or ring layers and r.",
                )?;
                SpaceRegion::Cylinder { layers: within, r: range("r", r, 0.0)? }
            } else {
                SpaceRegion::Box { layers: within, x: range("x", x, 0.0)?, y: range("y", y, f64::NEG_INFINITY)? }
            }
        }
    };
    if solid.sites(block).is_empty() {
        return Err(
            scope.fail("holds no sphere", "Widen or move it; layers lie 0.816 D apart, and x = y = 0 is the axis.")
        );
    }
    let [half, high] = block.half_widths();
    let beyond = match solid {
        SpaceRegion::Box { x, y, .. } => x[1] > half * (1.0 + 1e-9) || y[1].max(-y[0]) > high * (1.0 + 1e-9),
        SpaceRegion::Cylinder { r, .. } => r[1] > half.hypot(high) * (1.0 + 1e-9),
        SpaceRegion::Sphere { centre, .. } => centre[0] > half * (1.0 + 1e-9) || centre[1].abs() > high * (1.0 + 1e-9),
    };
    if beyond {
        let [half, high] = [half, high].map(|x| (x / diameter * 1e3).round() / 1e3);
        return Err(scope
            .fail("reaches outside the crystal", &format!("It ends at x = {half} D and y = -{high} D and {high} D.")));
    }
    Ok(solid)
}

fn lens(
    section: &(Scope, &LensFile),
    ground: Ground<Block, SpaceRegion>,
    regions: &Scope,
    own: &[Material],
) -> Result<(LensRequest, Option<String>), DesignError> {
    let (scope, file) = section;
    let block = ground.lattice;
    scope.forbid(
        &[("rows", &file.rows), ("apex_row", &file.apex_row), ("back_row", &file.back_row)],
        "a crystal in space",
        "It has layers: layers, apex_layer, back_layer.",
    )?;
    scope.forbid(&[("axis", &file.axis)], "a lens in space", "Its axis is that of the crystal, x = y = 0.")?;
    if ground.target.foci.len() > 1 {
        return Err(regions.fail(
            "has several foci, which no lens in space serves yet",
            "Leave one target.focus, or leave out [lens] and judge layouts of your own.",
        ));
    }
    let symmetry = match scope.optional("symmetry", &file.symmetry) {
        Some(entry) => entry.choice("symmetry", &SYMMETRIES)?,
        None => Symmetry::Axis,
    };
    let [first_focal, _] = ground.target.foci[0].region.layers(block.layer_spacing(), block.layers());
    let lying = Lying {
        stack: Stack::across(block),
        row: "layer",
        keys: [("layers", &file.layers), ("apex_layer", &file.apex_layer), ("back_layer", &file.back_layer)],
        foci: 1,
        first_focal,
    };
    let (mut request, candidates) = request(section, &lying, ground.host, regions, own)?;
    if candidates.len() > 1 {
        let entry = scope.required("material", &file.material)?;
        return Err(entry.fail("names several materials", "Name one: in space the best of several is not sought."));
    }
    if let Some(entry) = scope.optional("raster", &file.raster)
        && request.raster == Some(Raster::Diffused)
    {
        return Err(
            entry.fail("has no meaning in space", "Write raster = \"nearest\", or \"random\" for a graded lens.")
        );
    }
    request.symmetry = symmetry;
    Ok((request, None))
}

impl SpaceDesign {
    /// What the crystal is to a lens: to its edge, or the circle of the same area.
    pub fn stack(&self, symmetry: Symmetry) -> Stack {
        match symmetry {
            Symmetry::Axis => Stack::round(&self.lattice),
            Symmetry::Plane => Stack::across(&self.lattice),
        }
    }

    /// The target as rays see it: layers, and distances from the axis or from the plane x = 0.
    pub fn target_of_rays(&self, symmetry: Symmetry) -> Target {
        let (block, target) = (&self.lattice, &self.target);
        let seen = |solid: &SpaceRegion| {
            let x = match (symmetry, *solid) {
                (Symmetry::Axis, _) => solid.distances(),
                (Symmetry::Plane, SpaceRegion::Box { x, .. }) => x,
                (Symmetry::Plane, SpaceRegion::Cylinder { r, .. }) => [0.0, r[1]],
                (Symmetry::Plane, SpaceRegion::Sphere { centre, radius }) => {
                    [(centre[0] - radius).max(0.0), centre[0] + radius]
                }
            };
            Region { rows: solid.layers(block.layer_spacing(), block.layers()), x }
        };
        Target {
            foci: target.foci.iter().map(|f| Focus { region: seen(&f.region), share: f.share }).collect(),
            protect: seen(&target.protect),
        }
    }

    /// The lens that the design asks for, and the material of every site.
    ///
    /// # Errors
    /// No lens is asked for; none can be.
    pub fn propose_in_space(&self) -> Result<(Body, Vec<u8>), DesignError> {
        let request = self.lens.as_ref().ok_or_else(|| {
            let help = "Describe one, or compare a layout of your own: granulens compare DESIGN.toml LAYOUT.csv.";
            self.blame("lens", "[lens] is missing: nothing is asked for.".to_owned(), help.to_owned())
        })?;
        let (body, _, materials) = self.laid(request).map_err(|error| self.blame_body(&error))?;
        Ok((body, materials))
    }

    /// A lens for this design, its palette, and the material of every site.
    ///
    /// # Errors
    /// There is no such lens.
    pub fn laid(&self, request: &LensRequest) -> Result<(Body, Vec<Material>, Vec<u8>), LensError> {
        let block = &self.lattice;
        let continued = match request.symmetry {
            Symmetry::Axis => Continued::Revolved,
            Symmetry::Plane => Continued::Extruded(2.0 * block.half_widths()[1]),
        };
        let (stack, target) = (self.stack(request.symmetry), self.target_of_rays(request.symmetry));
        let body = propose_body(&stack, continued, &self.host, request, &target, self.constants)?;
        let palette = self.palette_of_lens(request);
        let centres = block.sites().iter().map(|site| site.centre);
        let rule = (request.raster.unwrap_or_default(), request.seed);
        let materials = body.materials(centres, &palette, block.diameter(), rule, self.constants);
        Ok((body, palette, materials))
    }

    /// Host, lens material, further ones.
    pub fn palette_of_lens(&self, request: &LensRequest) -> Vec<Material> {
        [&self.host, &request.material].into_iter().chain(&request.others).cloned().collect()
    }

    /// In space rows are layers.
    fn blame_body(&self, error: &LensError) -> DesignError {
        let key = match error {
            LensError::Rows { .. } | LensError::Span { .. } => "lens.layers",
            LensError::ApexRow { .. } => "lens.apex_layer",
            LensError::BackRow { .. } => "lens.back_layer",
            LensError::FocusRows { .. } => "target.focus.layers",
            LensError::OffAxis => "target.focus",
            _ => return self.blame_lens(error),
        };
        let help = match error {
            LensError::OffAxis => "Aim at a region on the axis, or leave out [lens].",
            _ => "Leave it out to have it solved.",
        };
        let words = error.to_string().replace("row", "layer");
        self.blame(key, format!("{key}: {}.", words.trim_end_matches('.')), help.to_owned())
    }
}
