//! The bed file: as written, then as checked.
//!
//! All numbers are in mean diameters d, collision times τ_c and masses of a mean disk, so they have no units in the file.

use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

use super::{
    Arm, BedImpact, Body, Damping, Ensemble, FramePlan, Grains, Intruder, Outline, Packing, Pile, Rubbing, Sides,
    Surface,
};
use crate::document::{self, DocumentError, Entry, Scope, Section, Source, Written, is_plain_name, section};

/// A checked bed file.
#[derive(Clone, Debug, PartialEq)]
pub struct BedFile {
    /// The file, as it was named.
    pub path: PathBuf,
    /// Its text.
    pub text: String,
    /// Name, fit for files and folders.
    pub name: String,
    /// Where the bed comes from.
    pub origin: Origin,
    /// The impact.
    pub impact: BedImpact,
    /// Many impacts in place of one, where they are asked for.
    pub ensemble: Option<Ensemble>,
    /// Which frames are kept, where any are.
    pub record: Option<FramePlan>,
}

/// Where a bed comes from.
#[derive(Clone, Debug, PartialEq)]
pub enum Origin {
    /// It is poured and settles.
    Pile(Pile),
    /// A file made by an earlier run, or by hand.
    File(PathBuf),
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct Top {
    #[expect(dead_code, reason = "read before all else; here it only is a known key")]
    format: Written,
    #[expect(dead_code, reason = "read before all else; here it only is a known key")]
    kind: Written,
    name: Written,
    bed: Section<BedSection>,
    grains: Section<GrainsSection>,
    walls: Section<WallsSection>,
    intruder: Section<IntruderSection>,
    run: Section<RunSection>,
    ensemble: Section<EnsembleSection>,
    record: Section<RecordSection>,
}

#[derive(serde::Deserialize)]
struct Kind {
    format: Written,
    kind: Written,
}

section!(BedSection: Written { packing, width, height, spread, sides, seed, file });
section!(GrainsSection: Written {
    stiffness, gravity, restitution, friction, tangential_stiffness, damping, pull, arm
});
section!(WallsSection: Written { restitution, friction, tangential_stiffness });
section!(IntruderSection: Written {
    shape, diameter, half_width, half_height, width, mass, body, turns, speed, height, place
});
section!(RunSection: Written { window, step, sample });
section!(EnsembleSection: Written { samples, speeds, friction });
section!(RecordSection: Written { every, contacts });

/// How each key is written, for messages.
pub(crate) const EXAMPLES: &[&str] = &[
    "format = 1",
    "kind = \"bed\"",
    "name = \"bed\"",
    "bed.packing = \"random\"",
    "bed.width = 100",
    "bed.height = 60",
    "bed.spread = 0.2",
    "bed.sides = \"periodic\"",
    "bed.seed = 1",
    "bed.file = \"bed1.csv\"",
    "grains.stiffness = 4000",
    "grains.gravity = 1.0",
    "grains.restitution = 0.5",
    "grains.friction = 0.5",
    "grains.tangential_stiffness = 0.8",
    "grains.damping = \"kondic\"",
    "grains.pull = true",
    "grains.arm = \"contact\"",
    "walls.restitution = 0.1",
    "walls.friction = 0.9",
    "walls.tangential_stiffness = 0.8",
    "intruder.shape = \"disk\"",
    "intruder.diameter = 10",
    "intruder.half_width = 5",
    "intruder.half_height = 10",
    "intruder.width = 10",
    "intruder.mass = 100",
    "intruder.body = \"solid\"",
    "intruder.turns = true",
    "intruder.speed = 0.7",
    "intruder.height = 5",
    "intruder.place = 0.5",
    "run.window = 400",
    "run.step = 0.02",
    "run.sample = 0.5",
    "record.every = 2",
    "record.contacts = true",
    "ensemble.samples = 10",
    "ensemble.speeds = [0.1, 0.4, 0.7]",
    "ensemble.friction = [\"kinetic\", \"static\"]",
];

/// Most grains that a file may ask for.
const MOST_GRAINS: f64 = 2e6;

impl BedFile {
    /// Reads and checks a bed file.
    ///
    /// # Errors
    /// The file cannot be read, or what is wrong with it, the first thing and the others.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, DocumentError> {
        let path = path.as_ref();
        Self::parse(path, &document::text(path)?)
    }

    /// Checks the text of a bed file; `path` is named in messages, and a bed's file is looked for beside it.
    ///
    /// # Errors
    /// What is wrong with it, the first thing and the others.
    pub fn parse(path: impl AsRef<Path>, text: &str) -> Result<Self, DocumentError> {
        let path = path.as_ref();
        document::all(Source { path, text, examples: EXAMPLES }, |text| Self::check(path, text))
    }

    fn check(path: &Path, text: &str) -> Result<Self, DocumentError> {
        let source = Source { path, text, examples: EXAMPLES };
        let other = || document::expect(source, document::Kind::Bed);
        let root = document::parse(source).or_else(|error| other().and(Err(error)))?;
        let top = Scope::root(source);
        let Kind { format, kind } = document::read(source, &root)?;
        if kind.is_none() {
            other()?;
        }
        let format = top.required("format", &format)?;
        if format.whole(0..=u32::MAX)? != 1 {
            return Err(format.fail("must be 1", "A file of a later format needs a later version of granulens."));
        }
        let kind = top.required("kind", &kind)?;
        if kind.text()? != "bed" {
            return Err(kind.fail("is no bed", "granulens impact reads beds: kind = \"bed\"."));
        }
        let file: Top = document::read(source, &root)?;
        let name = top.required("name", &file.name)?;
        if !is_plain_name(name.text()?) {
            let help = "It names the output folder. Write it like name = \"bed\".";
            return Err(name.fail("must be 1 to 100 letters (a to z), digits, - and _", help));
        }
        let bed = top.required_section("bed", &file.bed, "Add the section [bed] with packing, width and height.")?;
        let origin = read_origin(&bed, path)?;
        let mut grains = match top.section("grains", &file.grains) {
            Some(section) => read_grains(&section)?,
            None => Grains::default(),
        };
        grains.walls.tangential_stiffness = grains.grains.tangential_stiffness;
        if let Some((scope, walls)) = top.section("walls", &file.walls) {
            grains.walls =
                read_surface(&scope, [&walls.restitution, &walls.friction, &walls.tangential_stiffness], grains.walls)?;
        }
        let intruder =
            top.required_section("intruder", &file.intruder, "Add the section [intruder] with shape and speed.")?;
        let place = number(&intruder.0, "place", &intruder.1.place, 0.5, 0.0..=1.0)?;
        let intruder = read_intruder(&intruder)?;
        let mut impact = BedImpact { place, ..BedImpact::new(grains, intruder, 400.0) };
        if let Origin::Pile(pile) = &origin {
            impact.step = grains.step(1.0 - pile.spread);
        }
        if let Some((scope, run)) = top.section("run", &file.run) {
            impact.step = number(&scope, "step", &run.step, impact.step, 1e-6..=0.2)?;
            impact.window = number(&scope, "window", &run.window, impact.window, impact.step..=1e7)?;
            impact.sample = number(&scope, "sample", &run.sample, impact.sample, impact.step..=impact.window)?;
        }
        let ensemble = match top.section("ensemble", &file.ensemble) {
            Some(section) => Some(read_ensemble(&section, impact.intruder.speed)?),
            None => None,
        };
        let record = match top.section("record", &file.record) {
            Some(section) => Some(read_record(&section, &impact)?),
            None => None,
        };
        Ok(Self {
            path: path.to_owned(),
            text: text.to_owned(),
            name: name.text()?.to_owned(),
            origin,
            impact,
            ensemble,
            record,
        })
    }
}

fn read_record((scope, file): &(Scope, &RecordSection), impact: &BedImpact) -> Result<FramePlan, DocumentError> {
    let entry = scope.required("every", &file.every)?;
    let every = within(&entry, impact.sample..=impact.window)?;
    let plan = FramePlan { every, contacts: truth(scope, "contacts", &file.contacts, true)? };
    if plan.looks(impact.sample).is_none() {
        let rule = format!("must be a multiple of run.sample, {}", impact.sample);
        let near = (every / impact.sample).round() * impact.sample;
        return Err(entry.fail(&rule, &format!("Write record.every = {near}.")));
    }
    Ok(plan)
}

fn read_ensemble((scope, file): &(Scope, &EnsembleSection), speed: f64) -> Result<Ensemble, DocumentError> {
    let samples = match scope.optional("samples", &file.samples) {
        Some(entry) => entry.whole(1..=10_000)?,
        None => 1,
    };
    let speeds = match scope.optional("speeds", &file.speeds) {
        Some(entry) => {
            let speeds =
                entry.one_or_more().iter().map(|item| within(item, 0.0..=10.0)).collect::<Result<Vec<_>, _>>()?;
            let twice = (1..speeds.len()).any(|k| speeds[..k].contains(&speeds[k]));
            if speeds.is_empty() || twice {
                return Err(entry.refuse("must name at least one speed, each once"));
            }
            speeds
        }
        None => vec![speed],
    };
    let known = [("none", Rubbing::None), ("kinetic", Rubbing::Kinetic), ("static", Rubbing::Static)];
    let friction = match scope.optional("friction", &file.friction) {
        Some(entry) => {
            let items = entry.one_or_more();
            let kinds = items.iter().map(|item| item.choice("kind of friction", &known));
            let kinds = kinds.collect::<Result<Vec<_>, _>>()?;
            let twice = (1..kinds.len()).any(|k| kinds[..k].contains(&kinds[k]));
            if kinds.is_empty() || twice {
                return Err(entry.refuse("must name at least one kind of friction, each once"));
            }
            kinds
        }
        None => vec![Rubbing::AsGiven],
    };
    Ok(Ensemble { samples, speeds, friction })
}

/// A number within a range, or its default.
fn number(
    scope: &Scope,
    key: &str,
    written: &Written,
    usual: f64,
    range: RangeInclusive<f64>,
) -> Result<f64, DocumentError> {
    match scope.optional(key, written) {
        Some(entry) => within(&entry, range),
        None => Ok(usual),
    }
}

fn within(entry: &Entry, range: RangeInclusive<f64>) -> Result<f64, DocumentError> {
    let value = entry.number()?;
    if range.contains(&value) {
        return Ok(value);
    }
    Err(entry.fail(&format!("must lie from {} to {}", range.start(), range.end()), &entry.write_it_like()))
}

fn truth(scope: &Scope, key: &str, written: &Written, usual: bool) -> Result<bool, DocumentError> {
    match scope.optional(key, written) {
        Some(entry) => entry.yes(),
        None => Ok(usual),
    }
}

fn read_origin((scope, bed): &(Scope, &BedSection), path: &Path) -> Result<Origin, DocumentError> {
    if let Some(entry) = scope.optional("file", &bed.file) {
        let others = [&bed.packing, &bed.width, &bed.height, &bed.spread, &bed.sides, &bed.seed];
        if others.into_iter().any(Option::is_some) {
            return Err(
                entry.fail("stands beside other keys", "A bed comes from a file, or is poured: keep one of both.")
            );
        }
        return Ok(Origin::File(path.parent().unwrap_or(Path::new("")).join(entry.text()?)));
    }
    let packing = match scope.optional("packing", &bed.packing) {
        Some(entry) => entry.choice("packing", &[("random", Packing::Random), ("hexagonal", Packing::Hexagonal)])?,
        None => Packing::Random,
    };
    let sides = match scope.optional("sides", &bed.sides) {
        Some(entry) => entry.choice("kind of sides", &[("periodic", Sides::Periodic), ("walls", Sides::Walls)])?,
        None => Sides::Periodic,
    };
    let width = within(&scope.required("width", &bed.width)?, 10.0..=1e6)?;
    let height = scope.required("height", &bed.height)?;
    let tall = within(&height, 1.0..=1e6)?;
    if width * tall > MOST_GRAINS {
        let rule = format!("makes {:.0} grains with the width, above {MOST_GRAINS:.0}", width * tall);
        return Err(height.fail(&rule, "Choose a smaller bed."));
    }
    crate::memory::suffices(width * tall, crate::memory::RIG_SPHERE)
        .map_err(|rule| height.fail(&rule, "Choose a smaller bed, or run it where there is more."))?;
    let spread = number(scope, "spread", &bed.spread, 0.2, 0.0..=0.6)?;
    if packing == Packing::Hexagonal
        && let Some(entry) = scope.optional("spread", &bed.spread).filter(|_| spread > 0.0)
    {
        return Err(entry.fail(
            "does not go with a hexagonal packing",
            "Its disks are of one size: leave it out, or pack at random.",
        ));
    }
    let seed = match scope.optional("seed", &bed.seed) {
        Some(entry) => entry.seed()?,
        None => 1,
    };
    let spread = if packing == Packing::Hexagonal { 0.0 } else { spread };
    Ok(Origin::Pile(Pile { packing, width, height: tall, spread, seed, sides }))
}

fn read_surface(scope: &Scope, [e, mu, kt]: [&Written; 3], usual: Surface) -> Result<Surface, DocumentError> {
    let surface = Surface {
        restitution: number(scope, "restitution", e, usual.restitution, 0.01..=1.0)?,
        friction: number(scope, "friction", mu, usual.friction, 0.0..=10.0)?,
        tangential_stiffness: number(scope, "tangential_stiffness", kt, usual.tangential_stiffness, 0.0..=1.0)?,
    };
    if surface.restitution == 1.0 && surface.friction > 0.0 && surface.tangential_stiffness == 0.0 {
        let help =
            "Its damping follows from the restitution. Write friction = 0, or give tangential_stiffness, like 0.8.";
        return Err(scope.fail("has friction without damping and without a spring, which would do nothing", help));
    }
    Ok(surface)
}

fn read_grains((scope, file): &(Scope, &GrainsSection)) -> Result<Grains, DocumentError> {
    let usual = Grains::default();
    let damping = match scope.optional("damping", &file.damping) {
        Some(entry) => entry.choice("damping", &[("kondic", Damping::Kondic), ("exact", Damping::Exact)])?,
        None => usual.damping,
    };
    let arm = match scope.optional("arm", &file.arm) {
        Some(entry) => entry.choice("end of lever arms", &[("radius", Arm::Radius), ("contact", Arm::Contact)])?,
        None => usual.arm,
    };
    Ok(Grains {
        stiffness: number(scope, "stiffness", &file.stiffness, usual.stiffness, 10.0..=1e9)?,
        gravity: number(scope, "gravity", &file.gravity, usual.gravity, 1e-3..=100.0)?,
        grains: read_surface(scope, [&file.restitution, &file.friction, &file.tangential_stiffness], usual.grains)?,
        walls: usual.walls,
        damping,
        cut: !truth(scope, "pull", &file.pull, !usual.cut)?,
        arm,
    })
}

fn read_intruder((scope, file): &(Scope, &IntruderSection)) -> Result<Intruder, DocumentError> {
    #[derive(Clone, Copy, PartialEq)]
    enum Shape {
        Disk,
        Ellipse,
        Ogive,
        Flat,
    }
    let known = [("disk", Shape::Disk), ("ellipse", Shape::Ellipse), ("ogive", Shape::Ogive), ("flat", Shape::Flat)];
    let entry = scope.required("shape", &file.shape)?;
    let shape = entry.choice("shape", &known)?;
    let size = |(key, written): (&str, _)| within(&scope.required(key, written)?, 0.5..=1000.0);
    let [diameter, half_width, half_height, width] = [
        ("diameter", &file.diameter),
        ("half_width", &file.half_width),
        ("half_height", &file.half_height),
        ("width", &file.width),
    ];
    let forbid = |keys: &[_]| scope.forbid(keys, "this shape", "Leave it out, or change intruder.shape.");
    let outline = match shape {
        Shape::Disk => {
            forbid(&[half_width, half_height, width])?;
            Outline::Disk { diameter: size(diameter)? }
        }
        Shape::Ellipse | Shape::Ogive => {
            forbid(&[diameter, width])?;
            let (wide, high) = (size(half_width)?, size(half_height)?);
            let entry = scope.required("half_height", &file.half_height)?;
            if wide <= 1.0 || high <= 1.0 {
                return Err(entry.fail("or half_width is not above 1", "A shell is made of disks of diameter 1."));
            }
            match shape {
                Shape::Ellipse => Outline::Ellipse { half_width: wide, half_height: high },
                _ if high < wide => {
                    let instead = "An ogive is at least as high as wide; take an ellipse.";
                    return Err(entry.fail("is less than half_width", instead));
                }
                _ => Outline::Ogive { half_width: wide, half_height: high },
            }
        }
        Shape::Flat => {
            forbid(&[diameter, half_width, half_height])?;
            Outline::Flat { width: size(width)? }
        }
    };
    let body = match scope.optional("body", &file.body) {
        Some(entry) => entry.choice("body", &[("solid", Body::Solid), ("hollow", Body::Hollow)])?,
        None => Body::Solid,
    };
    // Kondic et al. 2012 keep ogives from turning, so that they do not fall sideways.
    let turns = truth(scope, "turns", &file.turns, shape == Shape::Disk)?;
    if shape == Shape::Flat && turns {
        let entry = scope.required("turns", &file.turns)?;
        return Err(entry.fail("does not go with a flat", "Flats do not turn: leave it out."));
    }
    Ok(Intruder {
        outline,
        mass: number(scope, "mass", &file.mass, outline.usual_mass(), 1e-3..=1e9)?,
        body,
        turns,
        speed: within(&scope.required("speed", &file.speed)?, 0.0..=10.0)?,
        height: number(scope, "height", &file.height, 5.0, 0.0..=1000.0)?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const BED: &str = "format = 1\nkind = \"bed\"\nname = \"bed\"\n[bed]\nwidth = 100\nheight = 60\n\
                       [intruder]\nshape = \"disk\"\ndiameter = 10\nspeed = 0.7\n";

    /// Messages rely on it.
    #[test]
    fn every_key_has_an_example_that_is_toml() {
        let sections = [
            ("bed", BedSection::KEYS),
            ("grains", GrainsSection::KEYS),
            ("walls", WallsSection::KEYS),
            ("intruder", IntruderSection::KEYS),
            ("run", RunSection::KEYS),
            ("ensemble", EnsembleSection::KEYS),
            ("record", RecordSection::KEYS),
        ];
        document::assert_examples(EXAMPLES, &sections);
    }

    #[test]
    fn what_is_left_out_is_the_paper_s_default() {
        let file = BedFile::parse("bed.toml", BED).unwrap();
        assert_eq!(file.impact.grains, Grains::default());
        assert_eq!(file.impact.intruder.mass, 100.0);
        let Origin::Pile(pile) = file.origin else { panic!("not poured") };
        assert_eq!((pile.packing, pile.spread, pile.sides, pile.seed), (Packing::Random, 0.2, Sides::Periodic, 1));
    }

    #[test]
    fn faults_are_named_with_line_key_and_way_out() {
        for (from, to, fault) in [
            ("kind = \"bed\"", "kind = \"rig\"", "bed.toml:2: kind = \"rig\" is no bed."),
            ("width = 100", "width = 1", "bed.toml:5: bed.width = 1 must lie from 10 to 1000000."),
            (
                "height = 60",
                "height = 60\nfile = \"x.csv\"",
                "bed.toml:7: bed.file = \"x.csv\" stands beside other keys.",
            ),
            ("height = 60", "depth = 60", "bed.toml:6: bed.depth is no known key."),
            ("shape = \"disk\"", "shape = \"dis\"", "bed.toml:8: intruder.shape = \"dis\" is no known shape."),
            (
                "diameter = 10",
                "diameter = 10\nwidth = 3",
                "bed.toml:10: intruder.width = 3 does not belong to this shape.",
            ),
            (
                "diameter = 10",
                "diameter = 10\nhalf_height = 3",
                "bed.toml:10: intruder.half_height = 3 does not belong to this shape.",
            ),
            ("speed = 0.7", "", "bed.toml:7: intruder.speed is missing."),
            ("speed = 0.7", "speed = nan", "bed.toml:10: intruder.speed = nan is not a finite number."),
            ("speed = 0.7", "speed = 0.7\nturns = 1", "bed.toml:11: intruder.turns = 1 must be true or false."),
        ] {
            let error = BedFile::parse("bed.toml", &BED.replacen(from, to, 1)).unwrap_err();
            assert_eq!(error.to_string(), fault);
            assert!(!error.help.is_empty());
        }
    }

    #[test]
    fn all_faults_are_told_at_once() {
        let text =
            BED.replace("width = 100", "width = 1").replace("\"disk\"", "\"dis\"").replace("speed = 0.7", "speed = 70");
        let error = BedFile::parse("bed.toml", &text).unwrap_err();
        let lines: Vec<_> = std::iter::once(&error).chain(error.others()).map(|error| error.line).collect();
        assert_eq!(lines, [Some(5), Some(8), Some(10)], "{:?}", error.others());
    }
}
