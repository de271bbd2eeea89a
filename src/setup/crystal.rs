//! The sections [crystal], [[pattern]] and [[edit]]: what stands where.

use super::file::{CrystalFile, EditFile, PatternFile};
use super::listed;
use super::place::{named_axes, no_axis, range, selection, vector};
use crate::document::{DocumentError, Entry, Scope, chosen};
use crate::lattice::{Cell, Crystal, Outline, Width};
use crate::material::Material;
use crate::pattern::{Build, Change, Pattern, RingShape, Selection, Side};
use crate::units::Dimension;

/// A crystal with its spheres, and which of them are held along which axes.
pub(super) struct Built<const D: usize> {
    pub build: Build<D>,
    pub held: Vec<(Selection<D>, [bool; D])>,
    /// Stripes: their section, angle (rad) and the width (m) after which they repeat.
    pub stripes: Vec<(String, f64, f64)>,
}

/// The seeds of patterns by chance.
pub(super) struct Seeds {
    /// In place of the first one of the file; those after it follow it.
    pub first: Option<u64>,
    /// Those in use, in order of the file.
    pub used: Vec<u64>,
}

impl Seeds {
    /// The seed in use where the file says `written`.
    fn take(&mut self, written: u64) -> u64 {
        let seed = self.first.map_or(written, |first| first.wrapping_add(self.used.len() as u64));
        self.used.push(seed);
        seed
    }
}

/// Lays the crystal, paints the patterns one over the other, and makes the edits.
pub(super) fn build<const D: usize>(
    cell: Cell<D>,
    section: &(Scope, &CrystalFile),
    patterns: &[(Scope, &PatternFile)],
    edits: &[(Scope, &EditFile)],
    own: &[Material],
    seeds: &mut Seeds,
) -> Result<Built<D>, DocumentError> {
    let (scope, file) = section;
    let crystal = lay(cell, scope, file)?;
    let mut palette = vec![chosen(&scope.required("material", &file.material)?, own)?];
    let mut sequence = Vec::new();
    for (scope, file) in patterns {
        if scope.optional("kind", &file.kind).is_some_and(|kind| kind.text().is_ok_and(|kind| kind == "layout")) {
            let entry = scope.required("file", &file.file)?;
            sequence.push(Given::Sites(listed::layout(&crystal, &entry, &mut palette, own)?));
            continue;
        }
        let entry = scope.required("materials", &file.materials)?;
        let materials =
            entry.one_or_more().iter().map(|item| place_in(&mut palette, item, own)).collect::<Result<Vec<_>, _>>()?;
        sequence.push(Given::Materials(materials));
    }
    let mut changed = Vec::new();
    for (scope, file) in edits {
        let entry = scope.optional("material", &file.material);
        changed.push(entry.map(|entry| place_in(&mut palette, &entry, own)).transpose()?);
    }

    let (diameter, layers) = (crystal.diameter(), crystal.layers());
    let mut build = Build::new(crystal, palette);
    let mut stripes = Vec::new();
    for ((scope, file), given) in patterns.iter().zip(sequence) {
        if let Pattern::Stripes { angle, widths, .. } = paint(&mut build, scope, file, given, seeds)? {
            stripes.push((scope.name().to_owned(), angle, widths.iter().sum()));
        }
    }
    if D == 1 {
        build.close_chain();
    }
    let mut held = Vec::new();
    for ((scope, file), material) in edits.iter().zip(changed) {
        let meant = selection(scope, file.place(), diameter, layers)?;
        let mut changes = Vec::new();
        changes.extend(material.map(Change::Material));
        if let Some(entry) = scope.optional("diameter", &file.diameter) {
            changes.push(Change::Radius(0.5 * entry.positive(Dimension::Length)?));
        }
        if let Some(entry) = scope.optional("move", &file.r#move) {
            changes.push(Change::Move(vector(&entry, |item| item.length(diameter))?));
        }
        if let Some(entry) = scope.optional("remove", &file.remove) {
            changes.extend(entry.yes()?.then_some(Change::Remove));
        }
        let hold = scope.optional("hold", &file.hold).map(|entry| named_axes::<D>(&entry)).transpose()?;
        if changes.is_empty() && hold.is_none() {
            return Err(scope.fail("changes nothing", "Give material, diameter, move, remove or hold."));
        }
        // A move of one sphere does not hide it from a second edit: places are those of the sites.
        if changes.iter().any(|&change| build.change(&meant, change) == 0) {
            return Err(
                scope.fail("means no sphere", "Check layers, columns and places, and earlier edits that remove.")
            );
        }
        held.extend(hold.map(|hold| (meant, hold)));
    }
    if build.sample().0.spheres.is_empty() {
        return Err(scope.fail("holds no sphere any more", "Remove fewer of them."));
    }
    Ok(Built { build, held, stripes })
}

/// What a pattern paints with.
enum Given {
    /// Materials, by their places in the palette, among which the pattern chooses.
    Materials(Vec<usize>),
    /// The material of every site.
    Sites(Vec<Option<usize>>),
}

/// A material's place in the palette, where it is added if it is new.
pub(super) fn place_in(palette: &mut Vec<Material>, entry: &Entry, own: &[Material]) -> Result<usize, DocumentError> {
    let material = chosen(entry, own)?;
    Ok(palette.iter().position(|known| known.name == material.name).unwrap_or_else(|| {
        palette.push(material);
        palette.len() - 1
    }))
}

fn lay<const D: usize>(cell: Cell<D>, scope: &Scope, file: &CrystalFile) -> Result<Crystal<D>, DocumentError> {
    let diameter = scope.required("diameter", &file.diameter)?.positive(Dimension::Length)?;
    let layers = scope.required("layers", &file.layers)?.whole(1..=1_000_000)?;
    let cells = match scope.optional("cells", &file.cells) {
        Some(entry) => {
            let items = entry.one_or_more();
            if items.len() != D - 1 {
                let rule = format!("must give one number of cells for each axis across the wave, {} here", D - 1);
                return Err(entry.refuse(&rule));
            }
            Some(items.iter().map(|item| item.whole(1..=1_000_000)).collect::<Result<Vec<_>, _>>()?)
        }
        None => None,
    };
    let hexagon = scope.optional("hexagon", &file.hexagon);
    let disk = scope.optional("disk", &file.disk);
    let outline = match (&hexagon, &disk) {
        (Some(entry), _) | (_, Some(entry)) if D < 3 || cells.is_some() => {
            return Err(
                entry.fail("bounds the layers of a crystal in space", "Use it without cells, in three dimensions.")
            );
        }
        (Some(_), Some(disk)) => return Err(disk.fail("is given beside hexagon", "Keep one of them.")),
        (Some(entry), None) => match entry.whole(1..=2001)? {
            across if across % 2 == 0 => {
                return Err(
                    entry.fail("must be odd", "It counts the spheres from corner to corner, one in the middle.")
                );
            }
            across => Outline::Hexagon(f64::from(across / 2)),
        },
        (None, Some(entry)) => Outline::Disk(0.5 * entry.length(diameter)? / diameter),
        (None, None) => Outline::All,
    };
    let reach = match outline {
        Outline::Hexagon(radius) | Outline::Disk(radius) => Some(radius + 1.0),
        Outline::All => None,
    };
    let mut widths = Vec::new();
    for (k, (name, written)) in [("x", &file.x), ("y", &file.y)].into_iter().enumerate() {
        let entry = scope.optional(name, written);
        let width = match (entry, &cells, reach) {
            (Some(entry), ..) if k >= D - 1 => return Err(no_axis::<D>(&entry)),
            (None, ..) if k >= D - 1 => continue,
            (Some(entry), Some(_), _) => return Err(entry.fail("is given beside cells", "Keep one of them.")),
            (Some(entry), None, _) => {
                let [low, high] = range(&entry, diameter)?;
                Width::Between(low / diameter, high / diameter)
            }
            (None, Some(cells), _) => Width::Cells(cells[k]),
            (None, None, Some(reach)) => Width::Between(-reach, reach),
            (None, None, None) => {
                // Without an outline a width is needed; its absence is said with its example.
                return Err(scope.required(name, written).err().unwrap_or_else(|| scope.fail("has no width", "")));
            }
        };
        widths.push(width);
    }
    let (wide, part): (Vec<f64>, f64) = (
        widths
            .iter()
            .map(|width| match *width {
                Width::Between(low, high) => high - low,
                Width::Cells(cells) => f64::from(cells),
            })
            .collect(),
        // A disk, or a hexagon, within its square.
        if matches!(outline, Outline::All) { 1.0 } else { 0.7 },
    );
    crate::memory::suffices(part * f64::from(layers) * wide.iter().product::<f64>(), crate::memory::RIG_SPHERE)
        .map_err(|rule| {
            scope.fail(&rule, "Build fewer layers or a narrower crystal, or run it where there is more.")
        })?;
    Crystal::new(cell, diameter, layers, &widths, outline)
        .map_err(|error| scope.fail(&format!("cannot be laid: {error}"), "Change layers, widths or outline."))
}

fn paint<const D: usize>(
    build: &mut Build<D>,
    scope: &Scope,
    file: &PatternFile,
    given: Given,
    seeds: &mut Seeds,
) -> Result<Pattern, DocumentError> {
    let (materials, mut sites) = match given {
        Given::Materials(materials) => (materials, Vec::new()),
        Given::Sites(sites) => ((0..build.palette().len()).collect(), sites),
    };
    let (diameter, layers) = (build.crystal().diameter(), build.crystal().layers());
    let length = |entry: &Entry| entry.length(diameter);
    let angle = || scope.required("angle", &file.angle)?.quantity(Dimension::Angle);
    let origin = |name: &str, written| -> Result<[f64; 2], DocumentError> {
        match scope.optional(name, written) {
            Some(entry) => vector::<2>(&entry, length),
            None => Ok([0.0; 2]),
        }
    };
    let rings = |shape| -> Result<Pattern, DocumentError> {
        let width = match scope.optional("width", &file.width) {
            Some(entry) => entry.length(diameter)?,
            None => diameter,
        };
        Ok(Pattern::Rings { shape, width, centre: origin("centre", &file.centre)? })
    };
    let kinds: Vec<(&str, Kind)> = Kind::ALL.to_vec();
    let kind = scope.required("kind", &file.kind)?;
    let pattern = match kind.choice("kind of pattern", &kinds)? {
        Kind::Uniform => Pattern::Uniform,
        Kind::Layers => Pattern::Layers {
            first: match scope.optional("first", &file.first) {
                Some(entry) => entry.whole(1..=layers)?,
                None => 1,
            },
        },
        Kind::Stripes => {
            let widths = scope.required("widths", &file.widths)?;
            Pattern::Stripes {
                angle: angle()?,
                widths: widths.one_or_more().iter().map(length).collect::<Result<_, _>>()?,
                origin: origin("origin", &file.origin)?,
            }
        }
        Kind::Wedge => Pattern::Wedge { apex: vector(&scope.required("apex", &file.apex)?, length)?, angle: angle()? },
        Kind::Triangle => Pattern::Triangle {
            spheres: scope.required("spheres", &file.spheres)?.whole(1..=100_000)?,
            side: scope
                .required("side", &file.side)?
                .choice("side", &[("left", Side::Left), ("right", Side::Right)])?,
        },
        Kind::Hexagons => rings(RingShape::Hexagon)?,
        Kind::Circles => rings(RingShape::Circle)?,
        Kind::Layout => Pattern::Listed(std::mem::take(&mut sites)),
        Kind::Mix => {
            let fractions = scope.required("fractions", &file.fractions)?;
            Pattern::Mix {
                fractions: fractions.one_or_more().iter().map(Entry::number).collect::<Result<_, _>>()?,
                seed: seeds.take(scope.required("seed", &file.seed)?.seed()?),
            }
        }
    };
    let written = [
        ("materials", if matches!(pattern, Pattern::Listed(_)) { &file.materials } else { &None }),
        ("diameters", if matches!(pattern, Pattern::Listed(_)) { &file.diameters } else { &None }),
        ("file", &file.file),
        ("first", &file.first),
        ("angle", &file.angle),
        ("widths", &file.widths),
        ("origin", &file.origin),
        ("apex", &file.apex),
        ("spheres", &file.spheres),
        ("side", &file.side),
        ("width", &file.width),
        ("centre", &file.centre),
        ("fractions", &file.fractions),
        ("seed", &file.seed),
    ];
    let uses: &[&str] = match pattern {
        Pattern::Uniform => &[],
        Pattern::Layers { .. } => &["first"],
        Pattern::Stripes { .. } => &["angle", "widths", "origin"],
        Pattern::Wedge { .. } => &["apex", "angle"],
        Pattern::Triangle { .. } => &["spheres", "side"],
        Pattern::Rings { .. } => &["width", "centre"],
        Pattern::Mix { .. } => &["fractions", "seed"],
        Pattern::Listed(_) => &["file"],
    };
    for (name, written) in written.into_iter().filter(|(name, _)| !uses.contains(name)) {
        if let Some(entry) = scope.optional(name, written) {
            return Err(entry.fail("has no meaning for this kind of pattern", "Leave it out, or change the kind."));
        }
    }
    let radii = match scope.optional("diameters", &file.diameters) {
        Some(entry) => {
            let radii: Vec<f64> = entry
                .one_or_more()
                .iter()
                .map(|item| Ok(0.5 * item.positive(Dimension::Length)?))
                .collect::<Result<_, DocumentError>>()?;
            if radii.len() != materials.len() {
                return Err(entry.refuse(&format!("has {} diameters for {} materials", radii.len(), materials.len())));
            }
            Some(radii)
        }
        None => None,
    };
    let meant = selection(scope, file.place(), diameter, layers)?;
    let painted = build
        .paint(&pattern, &meant, &materials, radii.as_deref())
        .map_err(|error| kind.fail(&format!("cannot be painted: it {error}"), "Change the pattern or the crystal."))?;
    if painted == 0 {
        return Err(scope.fail("holds no sphere of the crystal", "Move or widen it."));
    }
    Ok(pattern)
}

/// The kinds of pattern by name.
#[derive(Clone, Copy)]
enum Kind {
    Uniform,
    Layers,
    Stripes,
    Wedge,
    Triangle,
    Hexagons,
    Circles,
    Mix,
    Layout,
}

impl Kind {
    const ALL: &'static [(&'static str, Self)] = &[
        ("uniform", Self::Uniform),
        ("layers", Self::Layers),
        ("stripes", Self::Stripes),
        ("wedge", Self::Wedge),
        ("triangle", Self::Triangle),
        ("hexagons", Self::Hexagons),
        ("circles", Self::Circles),
        ("mix", Self::Mix),
        ("layout", Self::Layout),
    ];
}
