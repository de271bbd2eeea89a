//! What an evaluation depends on, hashed.

use std::path::{Path, PathBuf};

use super::{Entry, Stage, Start, Study, Work};
use crate::contact::LawKind;
use crate::dem::Strike;
use crate::design::DesignRef;
use crate::evaluate::{Detail, Plan};
use crate::lattice::BlockSide;
use crate::search::Assignment;

/// Where FNV-1a begins.
const BEGIN: u128 = 0x6c62_272e_07bb_0142_62b8_2175_6295_c58d;

/// Hashes what the scores of a study's layouts depend on.
#[derive(Clone, Copy, Debug)]
pub struct Key(u128);

impl Key {
    /// Of nothing yet.
    pub(crate) fn empty() -> Self {
        Self(BEGIN)
    }

    /// Everything but the layout: what the design's text says, impacts, materials, integrator, step and window.
    pub fn new(study: &Study, plan: &Plan) -> Self {
        let mut key = Self(BEGIN);
        key.add(said(study.design().text()).as_bytes());
        key.add(format!("{:?}", study.palette).as_bytes());
        key.add(plan.integrator.to_string().as_bytes());
        let impacts = study.impacts.iter().flat_map(|impact| match impact.strike {
            Strike::Pulse(pulse) => [pulse.force, pulse.duration],
            // No pulse lasts less than nothing.
            Strike::Projectile(flat) => [flat.speed, -flat.mass],
        });
        for number in impacts.chain([plan.step, plan.window]) {
            key.add(&number.to_bits().to_le_bytes());
        }
        // Only where they are there, so that journals from before keep their meaning.
        for (k, impact) in study.impacts.iter().enumerate().filter(|(_, impact)| !impact.is_symmetric()) {
            key.add(
                format!("{k} {:?} {:?}", impact.angle.to_bits(), impact.place.map(|x| x.map(f64::to_bits))).as_bytes(),
            );
        }
        for (k, law) in study.impacts.iter().enumerate().filter_map(|(k, impact)| Some((k, impact.law?))) {
            key.add(format!("{k} {law}").as_bytes());
        }
        for (law, step) in &plan.own_steps {
            key.add(format!("step {law} {}", step.to_bits()).as_bytes());
        }
        if !study.forces.is_one() {
            key.add(format!("forces {} {}", study.forces.count(), study.forces.band().to_bits()).as_bytes());
        }
        for case in study.cases().into_iter().skip(study.impacts.len() * study.forces.count()) {
            key.add(format!("{:?}", case.imperfection.wrong).as_bytes());
            case.imperfection.radii.iter().for_each(|radius| key.add(&radius.to_bits().to_le_bytes()));
        }
        if let DesignRef::Space(design) = study.design() {
            // Spheres that touch a wall and lie on the plane of symmetry met it twice as stiff in 0.2.
            if matches!(design.lattice.sides()[1], BlockSide::Wall | BlockSide::Mirror) {
                key.add(b"walled corners");
            }
            // And layouts with all of a crystal's symmetries were simulated in its half: rounding moved.
            if design.lattice.sixth().is_some() {
                key.add(b"sixths");
            }
        }
        if study.detail() == Detail::Everything {
            key.add(b"felt");
        }
        if study.has_rivals() {
            key.add(b"rivals");
        }
        key
    }

    /// FNV-1a, 128 bits; the length first, so that parts cannot run into each other.
    pub(crate) fn add(&mut self, bytes: &[u8]) {
        for byte in (bytes.len() as u64).to_le_bytes().iter().chain(bytes) {
            self.0 = (self.0 ^ u128::from(*byte)).wrapping_mul(0x0000_0000_0100_0000_0000_0000_0000_013b);
        }
    }

    /// With a layout, as hexadecimal text.
    pub fn of(mut self, materials: &[u8]) -> String {
        self.add(materials);
        self.text()
    }

    /// As hexadecimal text.
    pub(crate) fn text(self) -> String {
        format!("{:032x}", self.0)
    }

    /// What [`text`](Self::text) gave.
    pub(super) fn from_text(text: &str) -> Option<Self> {
        u128::from_str_radix(text, 16).ok().map(Self)
    }

    /// The entries of a journal that belong to the study as it is now, by assignment.
    pub fn own<'a>(self, study: &Study, entries: &'a [Entry]) -> Vec<(Assignment, &'a Entry)> {
        let alphabet = study.alphabet.len() as u8;
        let cases = study.cases().len() / study.forces.count();
        let own = |entry: &'a Entry| {
            let assignment = entry.assignment(study.variables(), alphabet)?;
            (self.of(&study.materials(&assignment)) == entry.key && entry.impacts.len() == cases)
                .then_some((assignment, entry))
        };
        entries.iter().filter_map(own).collect()
    }
}

impl Study {
    /// What is asked, hashed: design, materials, what may change, impacts, tolerances and objective. Studies that are alike in it
    /// can be compared, whatever their methods and seeds.
    pub fn problem(&self) -> String {
        let mut key = Key(BEGIN);
        key.add(said(self.design().text()).as_bytes());
        let tolerance = self.tolerance.map(|tolerance| (tolerance.wrong, tolerance.radii, tolerance.members));
        let asked = (
            &self.palette,
            &self.alphabet,
            &self.free,
            &self.impacts,
            tolerance,
            &self.objective,
            self.window,
            self.forces,
        );
        key.add(as_hashed(&format!("{asked:?}")).as_bytes());
        if self.is_tied() {
            key.add(format!("{:?}", self.groups).as_bytes());
        }
        key.text()
    }

    /// How it is looked for, hashed: the problem, starts, methods and steps, and seeds; not how long. Two runs that are alike in it come to the
    /// same, wherever their files lie: what starts hold is hashed, and of a file its name.
    pub fn settings(&self) -> String {
        let named = |start: &Start| match start {
            Start::File(path) => Start::File(path.file_name().map_or_else(|| path.clone(), PathBuf::from)),
            _ => start.clone(),
        };
        self.settings_with(&self.starts.iter().map(named).collect::<Vec<_>>())
    }

    /// The same as 0.2 hashed it, with the ways to starts: as they are given now, which depends on the folder from which a study is begun, and as they were given
    /// from the folder above the study's.
    pub(super) fn settings_of_before(&self) -> [String; 2] {
        [self.settings_with(&self.starts), self.settings_with(&self.starts_from_above())]
    }

    /// The starts, files by the ways to them from the folder above the study's.
    fn starts_from_above(&self) -> Vec<Start> {
        let folder = self.path.parent().unwrap_or(Path::new(""));
        let here = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        // Where the folder has no name, or cannot be asked for it, the ways are those given.
        let name = here.canonicalize().ok().and_then(|whole| Some(PathBuf::from(whole.file_name()?)));
        let from_above = |start: &Start| match (start, &name) {
            (Start::File(path), Some(name)) => {
                Start::File(path.strip_prefix(folder).map_or_else(|_| path.clone(), |way| name.join(way)))
            }
            _ => start.clone(),
        };
        self.starts.iter().map(from_above).collect()
    }

    fn settings_with(&self, starts: &[Start]) -> String {
        let mut key = Key(BEGIN);
        key.add(self.problem().as_bytes());
        // How long a climb is decides about its temperature all along.
        let length = |stage: &Stage| if stage.work == Work::Climb { stage.evaluations } else { 0 };
        let stages: Vec<_> = self.stages.iter().map(|stage| Stage { evaluations: length(stage), ..*stage }).collect();
        let looked = (self.seed, self.tolerance, starts, &self.bases, stages, &self.rungs);
        key.add(as_hashed(&format!("{looked:?}")).as_bytes());
        key.text()
    }
}

/// What types and their fields are called in a text that is hashed, whatever they are called by now: folders and journals of 0.1 and 0.2 are still known.
const HASHED: [(&str, &str); 7] = [
    ("ImpactLoad {", "Blow {"),
    (" strike: Pulse(", " pulse: "),
    (" }), angle: ", " }, angle: "),
    ("Objective { terms:", "Objective { wishes:"),
    ("Term {", "Wish {"),
    (" goal: ", " aim: "),
    (" aggregate: ", " over: "),
];

fn as_hashed(text: &str) -> String {
    HASHED.iter().fold(text.to_owned(), |text, (now, then)| text.replace(now, then))
}

/// What a design's text says, whatever its comments, spaces and the order of its keys.
fn said(text: &str) -> String {
    // A text that is no TOML is no design.
    let Ok(mut table) = text.parse::<toml::Table>() else { return text.to_owned() };
    // A design that names no law has this one.
    if let Some(crystal) = table.get_mut("crystal").and_then(toml::Value::as_table_mut)
        && crystal.get("law").and_then(toml::Value::as_str) == Some(LawKind::Thesis.name())
    {
        crystal.remove("law");
    }
    format!("{table:?}")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What 0.2.0 wrote of four studies of the repository, into settings.json and beside the journal: a name that changes in here must change nothing
    /// in there, or journals would be lost and folders taken for those of other studies.
    #[test]
    fn hashes_are_those_of_version_0_2() {
        let known: [(&str, &str, &str, &[&str]); 4] = [
            (
                "two-materials",
                "a21d650261d6ed3b621a0b711c1d9fec",
                "f157af067b5b29a567a22ac6e0b15d51",
                &["d0905b32ccd2b8e172dd4e7a13704622"],
            ),
            (
                "four-materials-robust",
                "825378a1b1f3756deeb45c2ad1b92b22",
                "4ec84855b50079e03afd0f8475de905f",
                &[
                    "327ed3e7e0c7e9e1e5d5b157701187f4",
                    "44c0d16cee538b94a4fc9bf06f901364",
                    "7f95ef958f2c63ffe1c4a2cb46867754",
                    "8c3b57cd9cb805b081bc8a43e7d62944",
                ],
            ),
            (
                "four-materials-tolerance",
                "662cf2b51e234d5887261b16a9e77d33",
                "2e96663bf3a88dc433052f9e6c43bc8b",
                &["7f95ef958f2c63ffe1c4a2cb46867754"],
            ),
            (
                "four-materials-gain",
                "2146474d154db10dafdcd452b4ad8739",
                "771a42aa487a45f7c06aae394d830e35",
                &[
                    "1f40fad2f5df6c192f00650eaf607a1b",
                    "367e36445d1fb5887d6cf7580e9fbc68",
                    "f4816a9e10b58c933273514dacf34688",
                ],
            ),
        ];
        for (name, problem, settings, keys) in known {
            // From the repository's folder, from its own, and by the whole way.
            let path = format!("studies/{name}.toml");
            let study = Study::read(Path::new(&path), None).unwrap();
            assert_eq!(study.problem(), problem, "{name}");
            assert_eq!(study.settings_of_before(), [settings; 2], "{name}");
            for path in [Path::new(env!("CARGO_MANIFEST_DIR")).join(&path), Path::new("src/../").join(&path)] {
                let again = Study::read(&path, None).unwrap();
                assert_eq!(again.settings_of_before()[1], settings, "{}", path.display());
                assert_eq!(again.settings(), study.settings(), "{}", path.display());
            }
            let of = |rung: usize| Key::new(&study.at(rung), &study.plan(rung).unwrap()).text();
            let mut found: Vec<String> = (0..study.rungs.len()).map(of).collect();
            found.sort();
            assert_eq!(found, keys, "{name}");
        }
    }
}
