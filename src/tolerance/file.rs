//! The file of tolerances: what a workshop gets wrong, and by how much at most.

use std::path::Path;

use super::grade::{GRADES, Grade};
use super::{ImpactLimits, State, Tolerances};
use crate::contact::LawKind;
use crate::dem::Projectile;
use crate::design::{THRESHOLDS, ThresholdsFile, thresholds};
use crate::document::{self, DocumentError, Entry, Scope, Section, Source, Written, joined, section};
use crate::evaluate::{Drawing, Subject};
use crate::units::Dimension::{Angle, Fraction, Length, Mass, Speed};

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct TolerancesFile {
    format: Written,
    state: Written,
    halves: Written,
    samples: Written,
    seed: Written,
    laws: Written,
    diameter: Section<DiameterFile>,
    material: Section<MaterialFile>,
    piece: Section<PieceFile>,
    frame: Section<FrameFile>,
    contact: Section<ContactFile>,
    impact: Section<ImpactFile>,
    thresholds: Section<ThresholdsFile>,
}

section!(DiameterFile: Written { grade, gauge, lot, offset });
section!(MaterialFile: Written { youngs_modulus, density, yield_stress, rate_constant });
section!(PieceFile: Written { vacancies, wrong });
section!(FrameFile: Written { side_gap, end_gap });
section!(ContactFile: Written { friction });
section!(ImpactFile: Written { force, duration, angle, off_centre, projectile_mass, projectile_speed });

/// How each key is written, for messages.
const EXAMPLES: &[&str] = &joined::<{ OWN.len() + THRESHOLDS.len() }>(OWN, THRESHOLDS);

const OWN: &[&str] = &[
    "format = 1",
    "state = \"nominal-sites\"",
    "halves = \"independent\"",
    "samples = 500",
    "seed = 1",
    "laws = [\"consistent\", \"mdr\"]",
    "diameter.grade = \"G100\"",
    "diameter.gauge = \"one\"",
    "diameter.lot = \"5 um\"",
    "diameter.offset = \"5 um\"",
    "material.youngs_modulus = \"2 %\"",
    "material.density = \"1 %\"",
    "material.yield_stress = \"10 %\"",
    "material.rate_constant = \"20 %\"",
    "piece.vacancies = \"0.1 %\"",
    "piece.wrong = \"0.5 %\"",
    "frame.side_gap = \"20 um\"",
    "frame.end_gap = \"20 um\"",
    "contact.friction = [0, 0.2]",
    "impact.force = \"5 %\"",
    "impact.duration = \"5 %\"",
    "impact.angle = \"2 deg\"",
    "impact.off_centre = \"1 D\"",
    "impact.projectile_mass = \"500 g\"",
    "impact.projectile_speed = \"20 m/s\"",
];

/// The greatest parts that are no slip.
const MOST_PART: f64 = 0.5;
/// A diameter that differs by more than this part of itself is of another size.
const MOST_DIAMETER: f64 = 0.05;
/// More pieces are taken for a slip.
pub const MOST_SAMPLES: u32 = 1_000_000;

impl Tolerances {
    /// Reads a file of tolerances for a layout, of which design and lattice count.
    ///
    /// # Errors
    /// The file cannot be read, or the first thing that is wrong with it.
    pub fn read<'a>(path: &Path, drawing: impl Into<Drawing<'a>>) -> Result<Self, DocumentError> {
        let text = document::text(path)?;
        Self::parse(path, &text, drawing)
    }

    /// Checks the text of such a file; `path` is only named in messages.
    ///
    /// # Errors
    /// The first thing that is wrong with it.
    pub fn parse<'a>(path: &Path, text: &str, drawing: impl Into<Drawing<'a>>) -> Result<Self, DocumentError> {
        let drawing = drawing.into();
        let source = Source { path, text, examples: EXAMPLES };
        let root = document::parse(source)
            .or_else(|error| document::expect(source, document::Kind::Tolerances).and(Err(error)))?;
        document::expect(source, document::Kind::Tolerances)?;
        let file: TolerancesFile = document::read(source, &root)?;
        let top = Scope::root(source);
        let format = top.required("format", &file.format)?;
        if format.whole(0..=u32::MAX)? != 1 {
            return Err(format.fail("must be 1", "This version of granulens reads format 1."));
        }
        if drawing.is_in_space() {
            forbid_sheets(&top, &file)?;
        }
        let mut tolerances = Self::drawn();
        if let Some(state) = top.optional("state", &file.state) {
            let known = [("nominal-sites", State::NominalSites), ("settled", State::Settled)];
            tolerances.state = state.choice("state of the piece", &known)?;
        }
        if let Some(halves) = top.optional("halves", &file.halves) {
            tolerances.halves_alike = halves.choice("way of the halves", &[("independent", false), ("alike", true)])?;
        }
        if let Some(samples) = top.optional("samples", &file.samples) {
            tolerances.samples = u64::from(samples.whole(1..=MOST_SAMPLES)?);
        }
        tolerances.seed = top.optional("seed", &file.seed).map(|seed| seed.seed()).transpose()?;
        if let Some(laws) = top.optional("laws", &file.laws) {
            tolerances.laws = read_laws(&laws)?;
        }
        let diameter = drawing.design().diameter();
        if let Some((scope, file)) = top.section("diameter", &file.diameter) {
            read_diameter(&scope, file, diameter, &mut tolerances)?;
        }
        if let Some((scope, file)) = top.section("material", &file.material) {
            tolerances.youngs_modulus = part(scope.optional("youngs_modulus", &file.youngs_modulus), MOST_PART)?;
            tolerances.density = part(scope.optional("density", &file.density), MOST_PART)?;
            tolerances.yield_stress = part(scope.optional("yield_stress", &file.yield_stress), MOST_PART)?;
            tolerances.rate_constant = part(scope.optional("rate_constant", &file.rate_constant), 1.0)?;
        }
        if let Some((scope, file)) = top.section("piece", &file.piece) {
            tolerances.vacancies = part(scope.optional("vacancies", &file.vacancies), MOST_PART)?;
            tolerances.wrong = part(scope.optional("wrong", &file.wrong), MOST_PART)?;
        }
        if let Some((scope, file)) = top.section("frame", &file.frame) {
            tolerances.side_gap = gap(scope.optional("side_gap", &file.side_gap), diameter)?;
            tolerances.end_gap = gap(scope.optional("end_gap", &file.end_gap), diameter)?;
        }
        if let Some((scope, file)) = top.section("contact", &file.contact) {
            tolerances.friction = scope.optional("friction", &file.friction).map(|entry| range(&entry)).transpose()?;
        }
        if let Some((scope, file)) = top.section("impact", &file.impact) {
            tolerances.impact = read_impact(&scope, file, drawing)?;
        }
        if let Some(section) = top.section("thresholds", &file.thresholds) {
            tolerances.thresholds = Some(thresholds(&section)?);
        }
        Ok(tolerances)
    }
}

/// What pieces in space do not have.
fn forbid_sheets(top: &Scope, file: &TolerancesFile) -> Result<(), DocumentError> {
    const IN_SPACE: &str = "a crystal in space";
    const ON_SITES: &str = "Leave it out: pieces in space stand on their sites, without walls and friction.";
    const STRAIGHT: &str = "Leave it out: in space the blow is straight, on all of layer 1.";
    if let Some(state) = top.optional("state", &file.state)
        && state.text()? == "settled"
    {
        return Err(state.fail(
            "does not belong to a crystal in space",
            "Write state = \"nominal-sites\": how spheres settle in a frame is of sheets.",
        ));
    }
    if let Some((scope, file)) = top.section("frame", &file.frame) {
        scope.forbid(&[("side_gap", &file.side_gap), ("end_gap", &file.end_gap)], IN_SPACE, ON_SITES)?;
    }
    if let Some((scope, file)) = top.section("contact", &file.contact) {
        scope.forbid(&[("friction", &file.friction)], IN_SPACE, ON_SITES)?;
    }
    if let Some((scope, file)) = top.section("impact", &file.impact) {
        scope.forbid(&[("angle", &file.angle), ("off_centre", &file.off_centre)], IN_SPACE, STRAIGHT)?;
    }
    Ok(())
}

fn read_laws(entry: &Entry) -> Result<Vec<LawKind>, DocumentError> {
    let known: Vec<(&str, LawKind)> = LawKind::ALL.iter().map(|law| (law.name(), *law)).collect();
    entry.items()?.iter().map(|item| item.choice("contact law", &known)).collect()
}

fn read_diameter(
    scope: &Scope,
    file: &DiameterFile,
    diameter: f64,
    tolerances: &mut Tolerances,
) -> Result<(), DocumentError> {
    let gauge = match scope.optional("gauge", &file.gauge) {
        Some(gauge) => gauge.choice("way to order", &[("one", false), ("any", true)])?,
        None => false,
    };
    match scope.optional("grade", &file.grade) {
        Some(entry) => {
            let name = entry.text()?;
            let grade = Grade::find(name).ok_or_else(|| {
                let known: Vec<&str> = GRADES.iter().map(|grade| grade.name).collect();
                entry.fail("is no known grade of balls", &format!("Known are {}.", known.join(", ")))
            })?;
            tolerances.take(grade, gauge);
        }
        None => scope.forbid(&[("gauge", &file.gauge)], "diameters without a grade", "Add grade = \"G100\".")?,
    }
    // Own numbers take the place of the grade's.
    let own = |key, value| match scope.optional(key, value) {
        Some(entry) => {
            let length = entry.length(diameter)?;
            if (0.0..=MOST_DIAMETER * diameter).contains(&length) {
                Ok(Some(length))
            } else {
                Err(entry.fail("must be 0 to 5 % of the diameter", &entry.write_it_like()))
            }
        }
        None => Ok(None),
    };
    let (lot, offset) = (own("lot", &file.lot)?, own("offset", &file.offset)?);
    if lot.is_some() || offset.is_some() {
        let words =
            if tolerances.grade.is_some() { " but for numbers of the file's own" } else { "numbers of the file's own" };
        tolerances.diameters_from = format!("{}{words}", tolerances.diameters_from);
    }
    tolerances.lot = lot.unwrap_or(tolerances.lot);
    tolerances.offset = offset.unwrap_or(tolerances.offset);
    Ok(())
}

fn part(entry: Option<Entry>, most: f64) -> Result<f64, DocumentError> {
    let Some(entry) = entry else { return Ok(0.0) };
    let part = entry.quantity(Fraction)?;
    if (0.0..=most).contains(&part) {
        Ok(part)
    } else {
        Err(entry.fail(&format!("must lie between 0 and {} %", 100.0 * most), &entry.write_it_like()))
    }
}

fn gap(entry: Option<Entry>, diameter: f64) -> Result<f64, DocumentError> {
    let Some(entry) = entry else { return Ok(0.0) };
    let gap = entry.length(diameter)?;
    if (0.0..=diameter).contains(&gap) {
        Ok(gap)
    } else {
        Err(entry.fail("must lie between nothing and a diameter", &entry.write_it_like()))
    }
}

fn range(entry: &Entry) -> Result<[f64; 2], DocumentError> {
    let limits = if entry.is_list() {
        let [low, high] = entry.pair()?;
        [low.number()?, high.number()?]
    } else {
        [entry.number()?; 2]
    };
    if (0.0..=limits[1]).contains(&limits[0]) && limits[1] <= 2.0 {
        Ok(limits)
    } else {
        Err(entry.fail("must lie between 0 and 2, the smaller number first", &entry.write_it_like()))
    }
}

fn read_impact(scope: &Scope, file: &ImpactFile, drawing: Drawing<'_>) -> Result<ImpactLimits, DocumentError> {
    let angle = match scope.optional("angle", &file.angle) {
        Some(entry) => {
            let angle = entry.quantity(Angle)?;
            if !(0.0..=1.0).contains(&angle) {
                return Err(entry.fail("must lie between 0 deg and 57 deg", &entry.write_it_like()));
            }
            angle
        }
        None => 0.0,
    };
    let off_centre = match (scope.optional("off_centre", &file.off_centre), drawing) {
        (Some(entry), Drawing::Plane(_, Subject { layout, .. })) => {
            let half = layout.lattice.half_width();
            let off = entry.length(layout.lattice.diameter())?;
            if !(0.0..=half).contains(&off) {
                let half = Length.show(half);
                return Err(
                    entry.fail(&format!("must lie between 0 and the half width, {half}"), &entry.write_it_like())
                );
            }
            off
        }
        _ => 0.0,
    };
    let projectile = match (
        scope.optional("projectile_mass", &file.projectile_mass),
        scope.optional("projectile_speed", &file.projectile_speed),
    ) {
        (None, None) => None,
        (Some(mass), Some(speed)) => {
            let above_zero = |entry: &Entry, dimension| {
                let value = entry.quantity(dimension)?;
                let fail = || entry.fail("must be greater than zero", &entry.write_it_like());
                if value > 0.0 { Ok(value) } else { Err(fail()) }
            };
            Some(Projectile { mass: above_zero(&mass, Mass)?, speed: above_zero(&speed, Speed)?, front: None })
        }
        (Some(one), None) => {
            return Err(one.fail("asks for projectile_speed beside it", "Add projectile_speed = \"20 m/s\"."));
        }
        (None, Some(one)) => {
            return Err(one.fail("asks for projectile_mass beside it", "Add projectile_mass = \"500 g\"."));
        }
    };
    Ok(ImpactLimits {
        projectile,
        force: part(scope.optional("force", &file.force), MOST_PART)?,
        duration: part(scope.optional("duration", &file.duration), MOST_PART)?,
        angle,
        off_centre,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::assert_examples;

    /// Messages rely on it.
    #[test]
    fn every_key_has_an_example_that_is_toml() {
        assert_examples(
            EXAMPLES,
            &[
                ("diameter", DiameterFile::KEYS),
                ("material", MaterialFile::KEYS),
                ("piece", PieceFile::KEYS),
                ("frame", FrameFile::KEYS),
                ("contact", ContactFile::KEYS),
                ("impact", ImpactFile::KEYS),
            ],
        );
    }
}
