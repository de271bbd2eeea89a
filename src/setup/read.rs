//! From the rig file as written to the checked setup.

use std::path::Path;

use super::acts::Stage;
use super::crystal::Seeds;
use super::file::{EXAMPLES, RigFile};
use super::{NO_CHANCE, PreparedRig, Setup, SphereSite, crystal, intruder, laws, place, plan, preload, record};
use crate::dem::rig::Rig;
use crate::dem::{MoveIn, Spheres};
use crate::document::{self, DocumentError, Scope, Source, Written, is_plain_name};
use crate::lattice::Cell;
use crate::material::Material;

/// The format that is read.
const FORMAT: u32 = 1;

#[derive(serde::Deserialize)]
struct Opening {
    format: Written,
    kind: Written,
}

/// Whether a text says that it is a rig; what is no TOML is none.
pub(super) fn is_rig(path: &Path, text: &str) -> bool {
    let source = Source { path, text, examples: EXAMPLES };
    let opening = document::parse(source).and_then(|root| document::read::<Opening>(source, &root));
    opening.is_ok_and(|opening| opening.kind.is_some())
}

/// Everything that is wrong is told at once.
pub(super) fn setup(path: &Path, text: &str, first_seed: Option<u64>) -> Result<Setup, DocumentError> {
    document::all(Source { path, text, examples: EXAMPLES }, |text| check(path, text, first_seed))
}

fn check(path: &Path, text: &str, first_seed: Option<u64>) -> Result<Setup, DocumentError> {
    let source = Source { path, text, examples: EXAMPLES };
    document::expect(source, document::Kind::Rig)?;
    let root = document::parse(source)?;
    let top = Scope::root(source);
    let Opening { format, kind } = document::read(source, &root)?;
    top.required("kind", &kind)?.choice("kind of file", &[("rig", ())])?;
    let format = top.required("format", &format)?;
    if format.whole(0..=u32::MAX)? != FORMAT {
        let help = "This version of granulens reads format 1; a file of a later format needs a later version.";
        return Err(format.fail("must be 1", help));
    }
    let file: RigFile = document::read(source, &root)?;
    let name = top.required("name", &file.name)?;
    if !is_plain_name(name.text()?) {
        return Err(name.fail(
            "must be 1 to 100 letters (a to z), digits, - and _",
            "It names the output folder. Write it like name = \"drop-tower\".",
        ));
    }
    let own = match top.section("materials", &file.materials) {
        Some((_, sections)) => document::materials(source, sections)?,
        None => Vec::new(),
    };
    let help = "Add the section [crystal] with packing, diameter, layers and material.";
    let (scope, crystal) = top.required_section("crystal", &file.crystal, help)?;
    let packing = scope.required("packing", &crystal.packing)?;
    let reading = Reading { path, text, name: name.text()?, top: &top, file: &file, own: &own, first_seed };
    #[derive(Clone, Copy)]
    enum Any {
        One(Cell<1>),
        Two(Cell<2>),
        Three(Cell<3>),
    }
    let chains = Cell::<1>::ALL.iter().map(|&cell| (cell.name(), Any::One(cell)));
    let sheets = Cell::<2>::ALL.iter().map(|&cell| (cell.name(), Any::Two(cell)));
    let solids = Cell::<3>::ALL.iter().map(|&cell| (cell.name(), Any::Three(cell)));
    let known: Vec<(&str, Any)> = chains.chain(sheets).chain(solids).collect();
    Ok(match packing.choice("packing", &known)? {
        Any::One(cell) => Setup::One(reading.prepared(cell)?),
        Any::Two(cell) => Setup::Two(reading.prepared(cell)?),
        Any::Three(cell) => Setup::Three(reading.prepared(cell)?),
    })
}

/// A file whose dimension is known.
struct Reading<'a> {
    path: &'a Path,
    text: &'a str,
    name: &'a str,
    top: &'a Scope<'a>,
    file: &'a RigFile,
    own: &'a [Material],
    first_seed: Option<u64>,
}

impl Reading<'_> {
    fn prepared<const D: usize>(&self, cell: Cell<D>) -> Result<PreparedRig<D>, DocumentError>
    where
        Spheres: MoveIn<D>,
    {
        let Self { top, file, own, .. } = *self;
        let section = top.required_section("crystal", &file.crystal, "")?;
        let patterns = top.sections("pattern", &file.pattern);
        let mut seeds = Seeds { first: self.first_seed, used: Vec::new() };
        let edits = top.sections("edit", &file.edit);
        let built = crystal::build(cell, &section, &patterns, &edits, own, &mut seeds)?;
        let mut palette = built.build.palette().to_vec();
        let mut strikers = Vec::new();
        for (scope, section) in top.sections("intruder", &file.intruder) {
            let material = intruder::material(&scope, section, &mut palette, own)?;
            strikers.push((scope, section, material));
        }
        // Flats that are named come before walls, which take the names of sides.
        let mut flats = Vec::new();
        for (scope, section) in top.sections("flat", &file.flat) {
            let material = match scope.optional("material", &section.material) {
                Some(entry) => Some(crystal::place_in(&mut palette, &entry, own)?),
                None => None,
            };
            flats.push((scope, section, material));
        }
        let crystal = built.build.crystal();
        let sections = (&file.law, &file.pair, &file.friction);
        let mut notes = Vec::new();
        let laws = laws::laws(top, sections, &palette, own, &mut notes)?;
        let (mut sample, sites) = built.build.sample();
        sample.materials = palette;
        let mut intruders = Vec::new();
        let mut stage = Stage { rig: Rig::new(sample, laws), crystal, sites };
        for (meant, axes) in &built.held {
            for i in stage.spheres(meant) {
                stage.rig.held[i] = std::array::from_fn(|k| stage.rig.held[i][k] || axes[k]);
            }
        }
        for (scope, section, material) in flats {
            stage.flat(&scope, section, material)?;
        }
        if let Some((scope, section)) = top.section("sides", &file.sides) {
            stage.sides(&scope, section)?;
        }
        for (scope, section, material) in strikers {
            intruders.push(intruder::place(&mut stage, &scope, section, material, &intruders)?);
        }
        for (scope, section) in top.sections("bar", &file.bar) {
            stage.bar(&scope, section, own)?;
        }
        for (scope, section) in top.sections("load", &file.load) {
            stage.load(&scope, section)?;
        }
        for (scope, section) in top.sections("moving", &file.moving) {
            stage.moving(&scope, section)?;
        }
        if let Some((scope, section)) = top.section("gravity", &file.gravity) {
            let entry = scope.required("acceleration", &section.acceleration)?;
            stage.rig.gravity = place::along_wave(&entry, crate::units::Dimension::Acceleration)?;
        }
        let preload = match top.section("preload", &file.preload) {
            Some((scope, section)) => Some(preload::preload(&mut stage.rig, stage.sites.len(), &scope, section)?),
            None => None,
        };
        let help = "Add the section [run] with window, like window = \"400 us\".";
        let (scope, section) = top.required_section("run", &file.run, help)?;
        let mut plan = plan::plan(&mut stage.rig, (crystal.diameter(), stage.sites.len()), &scope, section)?;
        plan.warnings.splice(0..0, notes);
        if self.first_seed.is_some() && seeds.used.is_empty() {
            plan.warnings.push(NO_CHANCE.to_owned());
        }
        for (name, angle, width) in &built.stripes {
            let (across, along) = (stage.rig.periods[0].filter(|_| D > 1), stage.rig.periods[D - 1]);
            // So many times the stripes repeat within the period.
            let times = [across.map(|p| p * angle.sin() / width), along.map(|p| p * angle.cos() / width)];
            if times.into_iter().flatten().any(|times| (times - times.round()).abs() > 1e-6) {
                plan.warnings
                    .push(format!("{name}: the stripes do not repeat with the period; there is a seam at the sides"));
            }
        }
        let mut record = record::default::<D>(plan.steps(), stage.sites.len(), stage.rig.flats.len() + intruders.len());
        if let Some((scope, section)) = top.section("record", &file.record) {
            let numbers = (plan.step, crystal.diameter(), crystal.layers());
            record = record::read(&scope, section, record, numbers, |meant| stage.spheres(meant))?;
        }
        let numbers = (crystal.diameter(), crystal.layers());
        record.regions = record::regions(&top.sections("region", &file.region), numbers, |meant| stage.spheres(meant))?;
        let site = |&site: &usize| {
            let site = &crystal.sites()[site];
            SphereSite { layer: site.layer, column: site.column }
        };
        Ok(PreparedRig {
            name: self.name.to_owned(),
            path: self.path.to_owned(),
            text: self.text.to_owned(),
            intruders,
            sites: stage.sites.iter().map(site).collect(),
            layers: crystal.layers(),
            diameter: crystal.diameter(),
            rig: stage.rig,
            preload,
            seeds: seeds.used,
            plan,
            record,
        })
    }
}
