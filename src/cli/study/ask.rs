//! `granulens study ask`.

use std::path::{Path, PathBuf};
use std::time::Instant;

use granulens::outcome::FORMAT;
use granulens::search::{Assignment, Rng};
use granulens::study::{Asking, Study, asked_in, merge, run_with};
use serde_json::json;

use super::events::Meter;
use super::merge::tell;
use super::read;
use super::run::{Ran, begin, finish};
use crate::cli::console::{context, emit, emit_json, note};
use crate::cli::failure::Failure;
use crate::cli::{Band, Common};

#[derive(clap::Args)]
pub struct Ask {
    /// Study file
    study: PathBuf,
    /// Layout files to ask for, in place of what the search asks for next
    #[arg(value_name = "LAYOUT.csv", conflicts_with = "random")]
    layouts: Vec<PathBuf>,
    /// Ask for so many random layouts, in place of what the search asks for next; the same for the same seed
    #[arg(long, value_name = "N")]
    random: Option<usize>,
    #[command(flatten)]
    forces: Band,
}

impl Ask {
    pub fn run(self, common: &Common) -> Result<(), Failure> {
        let study = read(&self.study, &self.forces, common)?;
        let folder = begin(common, &study)?;
        if asked_in(&folder).exists() {
            let merged = merge(&folder)?;
            if !common.json {
                tell(common, &folder, &merged);
            }
        }
        let (mut asking, warnings) = Asking::open(&study, &folder)?;
        warnings.iter().for_each(|warning| note(common, &format!("note: {warning}")));
        let given = match self.random {
            Some(count) => {
                let mut rng = Rng::new(study.seed);
                (0..count).map(|_| study.space().random(&mut rng)).collect()
            }
            None => self.layouts.iter().map(|path| assignment(&study, path)).collect::<Result<Vec<_>, _>>()?,
        };
        if given.is_empty() && self.random.is_none() {
            let begun = Instant::now();
            let mut meter = Meter::new(common, study.budget(), false);
            let state = run_with(&study, &folder.join("journal.jsonl"), &mut asking, context(), &mut meter)?;
            note(common, &format!("{} layouts asked for, {} waited for", asking.asked, asking.waiting));
            let seconds = begun.elapsed().as_secs_f64();
            return finish(Ran { study: &study, folder: &folder, state, meter, seconds }, common);
        }
        let rung = study.stages.last().map_or(0, |stage| stage.rung);
        asking.ask(rung, &given.iter().collect::<Vec<&Assignment>>())?;
        if common.json {
            emit_json(&json!({ "format": FORMAT, "asked": asking.asked, "waiting": asking.waiting }));
        } else {
            emit(&format!(
                "{} layouts asked for in {}; {} had been before",
                asking.asked,
                asked_in(&folder).display(),
                asking.waiting
            ));
        }
        Ok(())
    }
}

/// A layout of the study's from a file.
fn assignment(study: &Study, path: &Path) -> Result<Assignment, Failure> {
    let layout = study.design().read_layout(path, &study.palette)?;
    study.assignment(layout.materials()).ok_or_else(|| {
        Failure::input_with_help(
            format!("{}: differs from the study's start where nothing may change, or holds a material that may not be chosen", path.display()),
            "Widen rows or layers, x, r or materials of the study, or ask for another layout.",
        )
    })
}
