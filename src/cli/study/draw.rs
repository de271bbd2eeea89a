//! A study as a page: what was found, against what, and how the search went there.

use std::path::Path;

use granulens::report::{self, Provenance, StudyPage};
use granulens::study::{Report, Study as Studied};

use super::words::words;
use crate::cli::Common;
use crate::cli::console::note;
use crate::cli::failure::Failure;
use crate::cli::folder::write_file;

/// The page of a study that was run or is drawn anew; the layout's materials stand for the study's free sites.
pub fn page(study: &Studied, report: &Report) -> String {
    let name = study.path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    let file = study.path.display().to_string();
    let text = granulens::input::text(&study.path).unwrap_or_default();
    let mut provenance = Provenance::new(format!("granulens study run {file} --seed {}", report.seed), file, text);
    if let Some(method) = &report.method {
        provenance = provenance.by(method);
    }
    let provenance = provenance
        .with("Random seed", report.seed.to_string())
        .with("Design", study.design().path().display().to_string())
        .with("Problem", report.problem.clone().unwrap_or_default())
        .with("Q and baselines refer to", report.reference.clone().unwrap_or_else(|| "nothing".to_owned()));
    let layout = report.state.found().and_then(|found| {
        let assignment = found.entry.assignment(study.variables(), study.alphabet.len() as u8)?;
        Some(study.layout(&assignment))
    });
    report::study_page(&StudyPage {
        name: &name,
        state: &report.state,
        design: study.design(),
        layout: layout.as_ref(),
        words: &words(&report.state),
        provenance,
    })
}

/// Draws the study in a folder anew, from its report alone.
pub fn draw(common: &Common, folder: &Path) -> Result<(), Failure> {
    let report = super::compare::read(folder)?;
    let study = Studied::read(Path::new(&report.study), Some(report.seed))?;
    let place = folder.join("report.html");
    write_file(common, &place, &page(&study, &report))?;
    note(common, &format!("report: {}", place.display()));
    Ok(())
}
