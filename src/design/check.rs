//! From the file as written to the checked design, section by section in the order of the file.

use std::collections::BTreeMap;
use std::path::Path;

use super::file::{CompareFile, CrystalFile, DesignFile, EXAMPLES, ImpactFile, LensFile, RunFile, TargetFile};
use super::tuning::tuning;
use super::{Accuracy, Design, DesignError, lens, prices, region, space, threshold};
use crate::contact::{Constants, LawKind};
use crate::dem::{ForcePulse, Integrator, Projectile, Strike};
use crate::document::{self, Scope, Source, Written, is_plain_name};
use crate::lattice::{HexagonalSheet, SheetPacking};
use crate::lens::LensRequest;
use crate::material::Material;
use crate::target::Target;
use crate::units::Dimension;

/// The format that is read.
const FORMAT: u32 = 1;

/// Random layouts of each kind: the default and the most that may be asked for.
const SEEDS: u64 = 5;
const MOST_SEEDS: u64 = 1000;

/// Above this a crystal and what is recorded of it would not fit into the memory of an ordinary computer.
const MOST_SPHERES: usize = 10_000_000;

/// A pulse cut into more steps than this is taken for a slip of the prefix; no law here needs a hundredth of them.
const MOST_STEPS_IN_PULSE: f64 = 1e7;

pub(super) fn design(path: &Path, text: &str) -> Result<Design, DesignError> {
    checked(path, text, sheet, region::target, |section, design, regions, own| {
        let Ground { lattice, host, constants, target } = design;
        lens::read(section, lattice, host, target, regions, own, constants)
    })
}

/// What the lens of a design is read beside.
pub(super) struct Ground<'a, L, R> {
    pub lattice: &'a L,
    pub host: &'a Material,
    pub constants: Constants,
    pub target: &'a Target<R>,
}

/// Checks a text, with what differs of sheets and of crystals in space: how the sites are laid, and how regions and lens are read.
pub(super) fn checked<L, R>(
    path: &Path,
    text: &str,
    lattice: impl Fn(&Scope, &CrystalFile) -> Result<L, DesignError>,
    target: impl Fn(&(Scope, &TargetFile), &L) -> Result<Target<R>, DesignError>,
    request: impl Fn(
        &(Scope, &LensFile),
        Ground<L, R>,
        &Scope,
        &[Material],
    ) -> Result<(LensRequest, Option<String>), DesignError>,
) -> Result<Design<L, R>, DesignError> {
    let source = Source { path, text, examples: EXAMPLES };
    let root =
        document::parse(source).or_else(|error| document::expect(source, document::Kind::Design).and(Err(error)))?;
    let top = Scope::root(source);
    // The format is read first: another one may have other keys.
    let Opening { format, kind } = document::read(source, &root)?;
    if let Some(kind) = top.optional("kind", &kind) {
        return Err(kind.fail(
            "says that this is no lens design",
            "A rig is run with granulens simulate, a bed with granulens impact; a design file has no kind.",
        ));
    }
    document::expect(source, document::Kind::Design)?;
    let format = top.required("format", &format)?;
    if format.whole(0..=u32::MAX)? != FORMAT {
        return Err(format.fail(
            "must be 1",
            "This version of granulens reads format 1; a file of a later format needs a later version.",
        ));
    }
    let file: DesignFile = document::read(source, &root)?;

    let name = top.required("name", &file.name)?;
    if !is_plain_name(name.text()?) {
        return Err(name.fail(
            "must be 1 to 100 letters (a to z), digits, - and _",
            "It names the output folder. Write it like name = \"thesis-lens\".",
        ));
    }
    let own_materials = match top.section("materials", &file.materials) {
        Some((_, sections)) => document::materials(source, sections)?,
        None => Vec::new(),
    };
    let prices = match top.section("prices", &file.prices) {
        Some(section) => prices::read(&section, &own_materials)?,
        None => BTreeMap::new(),
    };
    let crystal = top.required_section(
        "crystal",
        &file.crystal,
        "Add the section [crystal] with packing, diameter, rows, half_width, sides and host.",
    )?;
    let crystal = read_crystal(&crystal, lattice, &own_materials)?;
    let mut notes = crystal.notes;
    let impact = top.required_section(
        "impact",
        &file.impact,
        "Add the section [impact] with kind, force and duration, or, of a projectile, kind, mass and speed.",
    )?;
    let impact = read_impact(&impact)?;
    let regions = top.required_section("target", &file.target, "Add the section [target] with focus and protect.")?;
    let target = target(&regions, &crystal.lattice)?;
    let lens = match top.section("lens", &file.lens) {
        Some(section) => {
            let ground = Ground {
                lattice: &crystal.lattice,
                host: &crystal.host,
                constants: crystal.constants,
                target: &target,
            };
            let (request, note) = request(&section, ground, &regions.0, &own_materials)?;
            notes.extend(note);
            Some(request)
        }
        None => None,
    };
    let run = match top.section("run", &file.run) {
        Some(run) => read_run(&run, &impact)?,
        None => Run::default(),
    };
    let Compare { seeds, first_seed, material } = match top.section("compare", &file.compare) {
        Some(compare) => read_compare(&compare, &crystal.host, &own_materials)?,
        None => Compare { seeds: SEEDS, first_seed: 1, material: None },
    };
    let thresholds = match top.section("thresholds", &file.thresholds) {
        Some(thresholds) => threshold::read(&thresholds)?,
        None => Vec::new(),
    };
    Ok(Design {
        name: name.text()?.to_owned(),
        path: path.to_owned(),
        text: text.to_owned(),
        lattice: crystal.lattice,
        host: crystal.host,
        own_materials,
        prices,
        notes,
        law: crystal.law,
        friction: crystal.friction,
        constants: crystal.constants,
        impact,
        target,
        lens,
        integrator: run.integrator,
        step: run.step,
        accuracy: run.accuracy,
        window: run.window,
        compared_with: material,
        first_seed,
        seeds,
        thresholds,
    })
}

#[derive(serde::Deserialize)]
struct Opening {
    format: Written,
    kind: Written,
}

/// What is said where a file or command names no contact law.
pub(crate) const NO_LAW: &str =
    "is left out: the published law is taken, thesis; to design, write \"consistent\", which never makes energy";

struct Crystal<L> {
    lattice: L,
    host: Material,
    notes: Vec<String>,
    law: LawKind,
    friction: Option<f64>,
    constants: Constants,
}

/// The sites of a sheet.
fn sheet(scope: &Scope, file: &CrystalFile) -> Result<HexagonalSheet, DesignError> {
    let packing = scope.required("packing", &file.packing)?;
    if let Ok(name) = packing.text()
        && space::PACKINGS.contains(&name)
    {
        return Err(packing.fail(
            "is a crystal in space, which this command does not take",
            "granulens design, run, check, compare, tolerance, study and build take it, and a rig of it granulens simulate; Python has SpaceDesign for it; explore takes sheets.",
        ));
    }
    // What is in space has been told apart; it is named for those who slip.
    let [hexagonal, square] = SheetPacking::ALL.map(|packing| (packing.name(), packing));
    let spatial = space::PACKINGS.map(|name| (name, SheetPacking::Hexagonal));
    let chosen = packing.choice("packing", &[&[hexagonal, square], &spatial[..]].concat())?;
    scope.forbid(
        &[
            ("layers", &file.layers),
            ("cells", &file.cells),
            ("axis_layer", &file.axis_layer),
            ("outline", &file.outline),
        ],
        "a sheet",
        "Its size is rows and half_width.",
    )?;
    let diameter = scope.required("diameter", &file.diameter)?.positive(Dimension::Length)?;
    let rows = scope.required("rows", &file.rows)?.whole(2..=100_000)?;
    let width = scope.required("half_width", &file.half_width)?;
    let lattice = HexagonalSheet::packed(chosen, diameter, rows, width.number()?).map_err(|_| {
        width.fail(
            "must be a multiple of 0.5, from 1 to 50000 (diameters)",
            "The mirror line passes through the centres of spheres or midway between them. Write it like half_width = 16.5.",
        )
    })?;
    if lattice.len() > MOST_SPHERES {
        return Err(scope.fail(
            &format!("has {} spheres, more than {} million", lattice.len(), MOST_SPHERES / 1_000_000),
            "Choose fewer rows or a smaller half_width.",
        ));
    }
    crate::memory::suffices(lattice.len() as f64, crate::memory::DESIGN_SITE).map_err(|rule| {
        scope.fail(&rule, "Choose fewer rows or a smaller half_width, or run it where there is more.")
    })?;
    let lattice = match scope.optional("diameters", &file.diameters) {
        None => lattice,
        Some(entry) => {
            let items = entry.items()?;
            let sizes = items.iter().map(|item| item.length(diameter)).collect::<Result<Vec<f64>, _>>()?;
            lattice.with_diameters(&sizes).map_err(|error| {
                entry.fail(
                    &format!("cannot be laid: {error}"),
                    "Write a diameter for each row, from row 1 on, or a few that come again and again; none is greater than crystal.diameter, \
                     the distance of columns.",
                )
            })?
        }
    };
    let sides = scope.required("sides", &file.sides)?;
    let known = [("mirror", true), ("period", false), ("wall", false), ("free", false)];
    if !sides.choice("kind of sides", &known)? {
        return Err(sides.fail("is for crystals in space", "The sides of a sheet are mirrors: sides = \"mirror\"."));
    }
    Ok(lattice)
}

fn read_crystal<L>(
    (scope, file): &(Scope, &CrystalFile),
    lattice: impl Fn(&Scope, &CrystalFile) -> Result<L, DesignError>,
    own: &[Material],
) -> Result<Crystal<L>, DesignError> {
    let lattice = lattice(scope, file)?;
    let host = document::chosen(&scope.required("host", &file.host)?, own)?;
    let mut notes = Vec::new();
    let law = match scope.optional("law", &file.law) {
        Some(law) => {
            law.choice("contact law", &LawKind::ALL.iter().map(|&law| (law.name(), law)).collect::<Vec<_>>())?
        }
        None => {
            notes.push(format!("crystal.law {NO_LAW}"));
            LawKind::Thesis
        }
    };
    let constants = match scope.optional("constants", &file.constants) {
        Some(set) => {
            set.choice("set of constants", &Constants::ALL.iter().map(|&set| (set.name(), set)).collect::<Vec<_>>())?
        }
        None => Constants::default(),
    };
    let CrystalFile { hardness, unlike_hardness, spring_back, spring_back_growth, restitution, hardening, .. } = file;
    let written = [hardness, unlike_hardness, spring_back, spring_back_growth, restitution, hardening];
    let constants = Constants { tuning: tuning(scope, written)?, ..constants };
    let friction = match scope.optional("friction", &file.friction) {
        Some(entry) => match entry.number()? {
            0.0 => None,
            mu if (0.0..=2.0).contains(&mu) => Some(mu),
            _ => {
                return Err(entry.fail("must lie from 0 to 2", "Steel on steel has 0.1 to 0.6; leave it out for none."));
            }
        },
        None => None,
    };
    Ok(Crystal { lattice, host, notes, law, friction, constants })
}

/// Kinds of impacts by name, and whether it is a flat that strikes.
pub(super) const IMPACTS: [(&str, bool); 2] = [("force-pulse", false), ("projectile", true)];

fn read_impact((scope, file): &(Scope, &ImpactFile)) -> Result<Strike, DesignError> {
    if scope.required("kind", &file.kind)?.choice("kind of impact", &IMPACTS)? {
        let strange = [("force", &file.force), ("duration", &file.duration)];
        scope.forbid(&strange, "a projectile", "It has mass and speed, and stays until it is thrown back.")?;
        return Ok(Strike::Projectile(Projectile {
            mass: scope.required("mass", &file.mass)?.positive(Dimension::Mass)?,
            speed: scope.required("speed", &file.speed)?.positive(Dimension::Speed)?,
            front: None,
        }));
    }
    scope.forbid(&[("mass", &file.mass), ("speed", &file.speed)], "a force pulse", "It has force and duration.")?;
    Ok(Strike::Pulse(ForcePulse {
        force: scope.required("force", &file.force)?.positive(Dimension::Force)?,
        duration: scope.required("duration", &file.duration)?.positive(Dimension::Time)?,
    }))
}

#[derive(Default)]
struct Run {
    integrator: Integrator,
    step: Option<f64>,
    accuracy: Accuracy,
    window: Option<f64>,
}

fn read_run((scope, file): &(Scope, &RunFile), impact: &Strike) -> Result<Run, DesignError> {
    let integrator = match scope.optional("integrator", &file.integrator) {
        Some(name) => {
            let known = [("verlet", Integrator::Verlet), ("adams", Integrator::Adams), ("rk4", Integrator::Rk4)];
            name.choice("integrator", &known)?
        }
        None => Integrator::default(),
    };
    let duration = impact.duration();
    let pulse = duration.map_or(String::new(), |duration| Dimension::Time.show(duration));
    let step = match scope.optional("step", &file.step) {
        Some(entry) => match entry.positive(Dimension::Time)? {
            step if duration.is_some_and(|duration| step > duration) => {
                return Err(entry.fail(
                    &format!("is longer than the pulse, impact.duration = {pulse}"),
                    "Shorten it to a small part of the pulse, or leave it out to have it chosen.",
                ));
            }
            step if duration.is_some_and(|duration| duration / step > MOST_STEPS_IN_PULSE) => {
                return Err(entry.fail(
                    &format!("cuts the pulse of {pulse} into more than {} million steps", MOST_STEPS_IN_PULSE / 1e6),
                    "Check its unit, or leave it out to have it chosen.",
                ));
            }
            step => Some(step),
        },
        None => None,
    };
    let accuracy = match scope.optional("accuracy", &file.accuracy) {
        Some(entry) => {
            let wanted = entry.quantity(Dimension::Fraction)?;
            let known = [Accuracy::TenthPercent, Accuracy::OnePercent];
            let same = |known: &Accuracy| (wanted / known.fraction() - 1.0).abs() < 1e-9; // rounding of the percentage
            known.into_iter().find(same).ok_or_else(|| {
                entry.fail("must be \"0.1 %\" or \"1 %\"", "For any other accuracy give run.step instead.")
            })?
        }
        None => Accuracy::default(),
    };
    let window = match scope.optional("window", &file.window) {
        Some(entry) => match entry.positive(Dimension::Time)? {
            window if duration.is_some_and(|duration| window <= duration) => {
                return Err(entry.fail(
                    &format!("is not longer than the pulse, impact.duration = {pulse}"),
                    "Lengthen it so that the wave can cross the crystal, or leave it out to have it chosen.",
                ));
            }
            window => Some(window),
        },
        None => None,
    };
    Ok(Run { integrator, step, accuracy, window })
}

/// Number of seeds, the first of them, and what baselines are made of where it is not the lens's material.
struct Compare {
    seeds: u64,
    first_seed: u64,
    material: Option<Material>,
}

fn read_compare(
    (scope, file): &(Scope, &CompareFile),
    host: &Material,
    own: &[Material],
) -> Result<Compare, DesignError> {
    let seeds = match scope.optional("seeds", &file.seeds) {
        Some(entry) => match entry.seed()? {
            seeds if seeds > MOST_SEEDS => {
                return Err(entry.fail(
                    &format!("must be at most {MOST_SEEDS}"),
                    "It is the number of random layouts of each kind, and each is a simulation of its own.",
                ));
            }
            seeds => seeds,
        },
        None => SEEDS,
    };
    let first_seed = match scope.optional("first_seed", &file.first_seed) {
        Some(entry) => entry.seed()?,
        None => 1,
    };
    let material = match scope.optional("material", &file.material) {
        Some(entry) => match document::chosen(&entry, own)? {
            material if material == *host => {
                return Err(entry.fail(
                    "is the material of the crystal, crystal.host",
                    "Name what flat strips and random mixtures are to be made of, or leave it out for that of the lens.",
                ));
            }
            material => Some(material),
        },
        None => None,
    };
    Ok(Compare { seeds, first_seed, material })
}
