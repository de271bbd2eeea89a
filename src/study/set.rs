//! What a layout is judged by: impacts of several strengths, lengths, directions and places, and crystals that are not
//! built as drawn.

use std::f64::consts::FRAC_PI_2;

use serde::Deserialize;

use super::source::Source;
use super::{Study, StudyError};
use crate::contact::LawKind;
use crate::dem::{ForcePulse, Strike};
use crate::design::{Design, DesignRef};
use crate::evaluate::{Evaluated, ImpactLoad, Imperfection, LoadCase};
use crate::search::Rng;
use crate::units::Dimension::{Angle, Force, Fraction, Length, Time};

/// More are taken for a slip.
const MOST_IMPACTS: usize = 64;
const MOST_CRYSTALS: u64 = 1000;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ImpactFile {
    force: String,
    duration: String,
    angle: Option<String>,
    x: Option<[String; 2]>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ToleranceFile {
    wrong: Option<String>,
    radii: Option<String>,
    #[serde(default)]
    members: u64,
    #[serde(default = "reported")]
    reported: u64,
    seed: Option<u64>,
}

fn reported() -> u64 {
    32
}

/// How crystals that are built differ from the drawing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// The part of the sites that may change that hold a wrong sphere, of another of the materials; at least one sphere.
    pub wrong: Option<f64>,
    /// Spheres are smaller than they should by up to this part of their radius, each as likely as the other.
    pub radii: Option<f64>,
    /// Crystals by which every layout is judged beside the one as drawn.
    pub members: u64,
    /// Other crystals with which the best layout is built at the end.
    pub reported: u64,
    /// Seed of them all.
    pub seed: u64,
}

/// The impacts of a file; the design's own if there is none.
pub(super) fn read_impacts(
    source: &Source<'_>,
    files: &[ImpactFile],
    design: DesignRef<'_>,
) -> Result<Vec<ImpactLoad>, StudyError> {
    if files.len() > MOST_IMPACTS {
        let message = format!("{} impacts are given; at most {MOST_IMPACTS} can be.", files.len());
        return Err(source.fail_in("impact", MOST_IMPACTS, "", message));
    }
    let mut impacts = Vec::new();
    for (k, file) in files.iter().enumerate() {
        let fail = |key: &'static str| move |message: String| source.fail_in("impact", k, key, message);
        let force = source.quantity(Force, "force", &file.force, fail("force"))?;
        let duration = source.quantity(Time, "duration", &file.duration, fail("duration"))?;
        let angle = match &file.angle {
            None => 0.0,
            Some(text) => Angle.parse(text).map_err(|error| fail("angle")(format!("angle: {error}")))?,
        };
        if angle.abs() >= FRAC_PI_2 * (1.0 - 1e-9) {
            let text = file.angle.as_deref().unwrap_or_default();
            return Err(fail("angle")(format!(
                "angle = \"{text}\" must lie between -90 deg and 90 deg; 0 deg is along the axis."
            )));
        }
        let place = match (design, &file.x) {
            (_, None) => None,
            (DesignRef::Plane(design), Some(x)) => Some(read_place(x, design).map_err(fail("x"))?),
            (DesignRef::Space(_), Some(_)) => {
                return Err(fail("x")("x: in space all of layer 1 is struck. Leave it out.".to_owned()));
            }
        };
        if angle != 0.0 && matches!(design, DesignRef::Space(_)) {
            return Err(fail("angle")("angle: in space impacts are along the axis. Leave it out.".to_owned()));
        }
        let strike = Strike::Pulse(ForcePulse { force, duration });
        let impact = ImpactLoad { strike, angle, place, law: None, friction: None };
        if impacts.contains(&impact) {
            return Err(fail("force")("the impact is given twice.".to_owned()));
        }
        impacts.push(impact);
    }
    if impacts.is_empty() {
        impacts.push(design.impact().into());
    }
    Ok(impacts)
}

/// Each impact under each of the laws that a file names; all under the design's own if it names none. Names are those of the command line.
pub(super) fn under_laws(
    source: &Source<'_>,
    names: &[String],
    impacts: Vec<ImpactLoad>,
) -> Result<Vec<ImpactLoad>, StudyError> {
    let mut laws: Vec<LawKind> = Vec::new();
    for name in names {
        let law = name.parse().map_err(|error| source.fail("laws", format!("laws: {error}.")))?;
        if laws.contains(&law) {
            return Err(source.fail("laws", format!("laws names {law} twice.")));
        }
        laws.push(law);
    }
    if laws.len() * impacts.len() > MOST_IMPACTS {
        let message = format!("{} impacts under {} laws are more than {MOST_IMPACTS}.", impacts.len(), laws.len());
        return Err(source.fail("laws", message));
    }
    if laws.is_empty() {
        return Ok(impacts);
    }
    Ok(laws
        .iter()
        .flat_map(|&law| impacts.iter().map(move |&impact| ImpactLoad { law: Some(law), ..impact }))
        .collect())
}

/// Two distances from the axis (m), written with units or in sphere diameters.
pub(super) fn distances(key: &str, written: &[String; 2], diameter: f64) -> Result<[f64; 2], String> {
    let mut distances = [0.0; 2];
    for (distance, text) in distances.iter_mut().zip(written) {
        *distance = match text.trim().strip_suffix('D').map(|number| number.trim().parse::<f64>()) {
            Some(Ok(diameters)) if diameters.is_finite() => diameters * diameter,
            _ => Length
                .parse(text)
                .map_err(|error| format!("{key}: {error} Sphere diameters are good too: \"-2.5 D\"."))?,
        };
    }
    Ok(distances)
}

/// Two distances from the axis, between which at least one sphere of row 1 is.
fn read_place(written: &[String; 2], design: &Design) -> Result<[f64; 2], String> {
    let lattice = &design.lattice;
    let [from, to] = distances("x", written, lattice.diameter())?;
    let slack = 1e-9 * lattice.diameter();
    let holds = |x: f64| (from - slack..=to + slack).contains(&x);
    if !lattice.sites().iter().take_while(|site| site.row == 1).any(|site| holds(site.x) || holds(-site.x)) {
        return Err(format!(
            "x = [\"{}\", \"{}\"] holds no sphere of row 1; write the lesser first, negative to the left of the axis, \
             such as [\"-2 D\", \"3 D\"].",
            written[0], written[1]
        ));
    }
    Ok([from, to])
}

impl Tolerance {
    pub(super) fn read(source: &Source<'_>, file: &ToleranceFile, seed: u64) -> Result<Self, StudyError> {
        let part = |key: &str, text: &Option<String>, most: f64, words: &str| match text {
            None => Ok(None),
            Some(text) => {
                let fail = |message: String| source.fail(key, format!("tolerance.{message}"));
                let part = source.quantity(Fraction, key, text, fail)?;
                if part <= most { Ok(Some(part)) } else { Err(fail(format!("{key} = \"{text}\" must be {words}."))) }
            }
        };
        let wrong = part("wrong", &file.wrong, 0.5, "at most 50 %, a part of the sites")?;
        let radii = part("radii", &file.radii, 0.05, "at most 5 %, a part of the radius")?;
        if wrong.is_none() && radii.is_none() {
            let message =
                "tolerance: says neither wrong nor radii. Write it like wrong = \"1 %\" or radii = \"0.1 %\".";
            return Err(source.fail("[tolerance]", message.to_owned()));
        }
        for (key, count) in [("members", file.members), ("reported", file.reported)] {
            if count > MOST_CRYSTALS {
                let message = format!("tolerance.{key} = {count} must be at most {MOST_CRYSTALS}.");
                return Err(source.fail(key, message));
            }
        }
        Ok(Self { wrong, radii, members: file.members, reported: file.reported, seed: file.seed.unwrap_or(seed) })
    }
}

impl Study {
    /// What every layout is judged by: each impact on the crystal as drawn, then on each of the tolerance's members; where several
    /// forces are asked for, each of these with every one of them.
    pub fn cases(&self) -> Vec<LoadCase> {
        let members = self.tolerance.map_or(0, |tolerance| tolerance.members);
        let mut imperfections = vec![Imperfection::default()];
        imperfections.extend(self.imperfections(0, members));
        self.under_each_impact(&imperfections)
    }

    /// Flaws under each impact, one imperfection after the other.
    pub(super) fn under_each_impact(&self, imperfections: &[Imperfection]) -> Vec<LoadCase> {
        let under = |load: &ImpactLoad| -> Vec<ImpactLoad> {
            let with = |strength| ImpactLoad { strike: load.strike.with_strength(strength), ..*load };
            self.forces.about(load.strike.strength()).into_iter().map(with).collect()
        };
        let of = |imperfection: &Imperfection| -> Vec<LoadCase> {
            let loads = self.impacts.iter().flat_map(under);
            loads.map(|load| LoadCase { imperfection: imperfection.clone(), ..LoadCase::from(load) }).collect()
        };
        imperfections.iter().flat_map(of).collect()
    }

    /// Runs in all cases, parted by impact: each part has a run for every force.
    pub fn by_impact<'a>(&self, runs: &'a [Evaluated]) -> Vec<&'a [Evaluated]> {
        runs.chunks(self.forces.count()).collect()
    }

    /// `count` crystals that are not as drawn; those of different streams have nothing in common.
    pub(super) fn imperfections(&self, stream: u64, count: u64) -> Vec<Imperfection> {
        let Some(tolerance) = self.tolerance else { return Vec::new() };
        let mut seeds = Rng::new(tolerance.seed.wrapping_add(stream << 32) ^ 0x746f_6c65_7261_6e63);
        (0..count).map(|_| self.imperfection(&tolerance, &mut Rng::new(seeds.bits()))).collect()
    }

    fn imperfection(&self, tolerance: &Tolerance, rng: &mut Rng) -> Imperfection {
        let mut left = self.free.clone();
        let others = self.alphabet.len() as u64 - 1;
        let wrong = tolerance
            .wrong
            .filter(|_| others > 0)
            .map_or(0, |part| ((part * self.free.len() as f64).round() as usize).clamp(1, self.free.len()));
        let wrong = (0..wrong)
            .map(|_| {
                let site = left.swap_remove(rng.below(left.len() as u64) as usize);
                (site, 1 + rng.below(others) as u8)
            })
            .collect();
        let radii = tolerance
            .radii
            .map_or_else(Vec::new, |part| (0..self.design().sites()).map(|_| 1.0 - part * rng.unit()).collect());
        Imperfection { alphabet: self.alphabet.clone(), wrong, radii, ..Imperfection::default() }
    }
}
