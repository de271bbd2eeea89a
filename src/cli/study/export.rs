//! `granulens study export`: the best layout, and the journal as a table.

use std::fmt::Write as _;
use std::path::PathBuf;

use granulens::study::{Entry, Fabric, Rung, Scored, Study as Studied};
use serde_json::json;

use super::best_layout;
use super::show::{Known, find};
use super::words::scores;
use crate::cli::Common;
use crate::cli::console::{emit_json, note};
use crate::cli::failure::Failure;
use crate::cli::folder::write_file;

#[derive(clap::Args)]
pub struct Export {
    /// Study file
    study: PathBuf,
    /// Where to write the best layout, as CSV
    #[arg(long, value_name = "FILE", required_unless_present = "journal")]
    layout: Option<PathBuf>,
    /// Where to write the journal, as CSV: a line for each evaluation and impact
    #[arg(long, value_name = "FILE")]
    journal: Option<PathBuf>,
}

impl Export {
    pub fn run(self, common: &Common) -> Result<(), Failure> {
        let Known { study, rungs, best, .. } = find(&self.study, common)?;
        if let Some(path) = &self.layout {
            let best = best.ok_or_else(|| Failure::input("the journal holds no evaluation that came to its end"))?;
            write_file(path, &best_layout(&study, &best.entry)?)?;
            note(common, &format!("{}: {}", path.display(), scores(&best.summary)));
        }
        let evaluations: usize = rungs.iter().map(|(_, rung)| rung.all().len()).sum();
        if let Some(path) = &self.journal {
            write_file(path, &table(&study, &rungs))?;
            note(common, &format!("{}: {evaluations} evaluations", path.display()));
        }
        if common.json {
            emit_json(&json!({
                "format": granulens::outcome::FORMAT, "layout": self.layout, "journal": self.journal,
                "evaluations": evaluations,
            }));
        }
        Ok(())
    }
}

/// A journal as CSV, a line for each evaluation and impact: no score where there is none.
fn table(study: &Studied, rungs: &[(f64, Rung)]) -> String {
    let mut text =
        "step_s,evaluation,force_N,duration_s,F_J,P_J,C,G,Q,loss,miss,mass_kg,spheres,lone,islands,stop,layout\n"
            .to_owned();
    let show = |value: Option<f64>| value.map_or_else(String::new, |value| value.to_string());
    let finite = |value: f64| if value.is_finite() { value.to_string() } else { String::new() };
    for (step, rung) in rungs {
        for (k, judged) in rung.all().iter().enumerate() {
            let Entry { impacts, stop, layout, .. } = &judged.entry;
            let stop = stop.as_ref().map_or_else(String::new, |stop| format!("\"{}\"", stop.replace('"', "\"\"")));
            let Fabric { mass, spheres, lone, islands } = judged.fabric;
            let [loss, miss] = [judged.loss.total, judged.loss.miss].map(finite);
            for (impact, scored) in study.impacts.iter().zip(impacts) {
                let Scored { focal_mean, protected_mean, .. } = scored;
                let ratios = [scored.contrast, scored.focal_gain, scored.protection].map(show).join(",");
                let _ = writeln!(
                    text,
                    "{step},{},{},{},{focal_mean},{protected_mean},{ratios},{loss},{miss},{mass},{spheres},{lone},\
                     {islands},{stop},{layout}",
                    k + 1,
                    impact.force,
                    impact.duration
                );
            }
        }
    }
    text
}
