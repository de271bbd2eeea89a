//! What a study came to, as files: `study.json`, and the best layout or the nearest.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::{State, Study, StudyError};
use crate::design::DesignRef;
use crate::evaluate::method;
use crate::outcome::{FORMAT, Method};
use crate::output::{self, OutputError};

/// What `study.json` holds.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Report {
    /// Format number of every JSON file of results.
    pub format: u32,
    /// With what, and how: step and window are those of the last stage.
    #[serde(flatten)]
    pub method: Option<Method>,
    /// What Q and the baselines refer to.
    #[serde(default)]
    pub reference: Option<String>,
    /// Forces about that of each impact, and how far the outermost lie from it.
    #[serde(default)]
    pub forces: usize,
    /// As a part of it.
    #[serde(default)]
    pub band: f64,
    /// The study file, as it was named.
    pub study: String,
    /// Seed of everything random.
    pub seed: u64,
    /// How many sites could change.
    pub sites: usize,
    /// The materials that could be chosen.
    pub materials: Vec<String>,
    /// What was asked, hashed: studies that are alike in it can be compared.
    #[serde(default)]
    pub problem: Option<String>,
    /// What it came to.
    #[serde(flatten)]
    pub state: State,
}

impl Report {
    /// Of a study and what it came to.
    ///
    /// # Errors
    /// A step or window with which nothing can be simulated; a run of the study has none.
    pub fn of(study: &Study, state: State) -> Result<Self, StudyError> {
        let last = study.stages.last().map_or(0, |stage| stage.rung);
        Ok(Self {
            format: FORMAT,
            method: Some(match study.design() {
                DesignRef::Plane(design) => method(design, &study.plan(last)?),
                DesignRef::Space(design) => method(design, &study.plan(last)?),
            }),
            reference: study.design().reference().map(|material| material.name.clone()),
            forces: study.forces.count(),
            band: study.forces.band(),
            study: study.path.display().to_string(),
            seed: study.seed,
            sites: study.free.len(),
            problem: Some(study.problem()),
            materials: study.alphabet.iter().map(|&place| study.palette[usize::from(place)].name.clone()).collect(),
            state,
        })
    }

    /// Writes it into the study's folder, with the best layout; what misses a limit never goes by the name of best.
    ///
    /// # Errors
    /// A file that others wrote or changed, without `force`; what the file system refuses.
    pub fn write(&self, study: &Study, folder: &Path, force: bool) -> Result<(), OutputError> {
        output::write(&folder.join("study.json"), pretty(self).as_bytes(), force)?;
        for (name, found) in [("best.csv", &self.state.best), ("nearest.csv", &self.state.nearest)] {
            let assignment =
                found.as_ref().and_then(|found| found.entry.assignment(study.variables(), study.alphabet.len() as u8));
            if let Some(assignment) = assignment {
                output::write(&folder.join(name), study.layout(&assignment).csv().as_bytes(), force)?;
            }
        }
        Ok(())
    }
}

/// As text for people and programs.
pub(super) fn pretty(value: &impl Serialize) -> String {
    // String keys and finite numbers: this cannot fail.
    serde_json::to_string_pretty(value).unwrap_or_default() + "\n"
}
