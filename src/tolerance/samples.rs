//! Pieces that were made and simulated, and the file that keeps them: more can be added, and other thresholds asked of them, later.

use std::fmt::{Debug, Write as _};
use std::path::{Path, PathBuf};

use super::criterion::Criterion;
use super::piece::Piece;
use super::workshop::{Made, Workshop, WorkshopError};
use super::yields::Share;
use crate::Context;
use crate::design::{Design, DesignRef};
use crate::outcome::VERSION;
use crate::score::{Measure, Scores};
use crate::study::Key;

/// One piece.
#[derive(Clone, Debug, PartialEq)]
pub struct Sample {
    /// Its quantities.
    pub values: Vec<f64>,
    /// What it does; not to be trusted where it was stopped.
    pub scores: Scores,
    /// Why a guard stopped it, if so: it then does nothing that is asked.
    pub stop: Option<String>,
}

/// Pieces 1 to n of a workshop.
#[derive(Clone, Debug, PartialEq)]
pub struct Samples {
    /// What their numbers follow from, hashed.
    key: String,
    seed: u64,
    measures: Vec<Measure>,
    quantities: Vec<String>,
    /// Piece by piece.
    pub list: Vec<Sample>,
}

/// Why kept pieces cannot be gone on from.
#[derive(Debug, thiserror::Error)]
#[error("{}:{} {message}", .path.display(), .line.map_or(String::new(), |line| format!("{line}:")))]
pub struct KeptError {
    /// The file.
    pub path: PathBuf,
    /// The line, from 1, where there is one to blame.
    pub line: Option<usize>,
    /// What is wrong.
    pub message: String,
}

/// How the file begins.
const HEAD: &str = "# granulens pieces, format 1, ";

impl Samples {
    /// None yet, of a workshop.
    pub fn new(workshop: &Workshop, seed: u64) -> Self {
        Self {
            key: key(workshop, seed),
            seed,
            measures: workshop.measures().collect(),
            quantities: workshop.quantities().iter().map(|quantity| quantity.name.clone()).collect(),
            list: Vec::new(),
        }
    }

    /// Makes pieces until there are `count`; `kept` is called now and then with what there is. Which pieces these are does not depend on how many
    /// there were.
    ///
    /// # Errors
    /// See [`WorkshopError`]; the pieces that were finished are there.
    pub fn grow<E: From<WorkshopError>>(
        &mut self,
        workshop: &Workshop,
        count: u64,
        context: &Context,
        mut kept: impl FnMut(&Self) -> Result<(), E>,
    ) -> Result<(), E> {
        const BLOCK: u64 = 128;
        while (self.list.len() as u64) < count {
            let first = self.list.len() as u64;
            let numbers = first..count.min(first + BLOCK);
            let pieces: Vec<Piece> = numbers.map(|k| Piece::made(workshop.quantities(), self.seed, k)).collect();
            let runs = workshop.runs(&pieces, &[1.0], context)?;
            for (piece, Made { scores, stop }) in pieces.into_iter().zip(runs.into_iter().flatten()) {
                self.list.push(Sample { values: piece.values, scores, stop });
            }
            kept(self)?;
        }
        Ok(())
    }

    /// How many of the first `count` do what is asked.
    pub fn share(&self, count: usize, criterion: &Criterion, of_layout: &Scores) -> Share {
        let all = &self.list[..count.min(self.list.len())];
        let does = |sample: &&Sample| sample.stop.is_none() && criterion.admits(&sample.scores, of_layout);
        Share::of(all.iter().filter(does).count() as u64, all.len() as u64)
    }

    /// A score of the first `count` pieces that ran to their end, in order of its size.
    pub fn sorted(&self, count: usize, measure: Measure) -> Vec<f64> {
        let all = self.list.iter().take(count).filter(|sample| sample.stop.is_none());
        let mut values: Vec<f64> = all.filter_map(|sample| sample.scores.get(measure)).collect();
        values.sort_by(f64::total_cmp);
        values
    }

    /// As CSV, numbers to the last bit; SI.
    pub fn csv(&self) -> String {
        let mut text = format!("{HEAD}seed {}, of {}\npiece", self.seed, self.key);
        self.quantities.iter().for_each(|name| text += &format!(",{name}"));
        self.measures.iter().for_each(|measure| text += &format!(",{}", measure.column()));
        text += ",stop\n";
        for (k, sample) in self.list.iter().enumerate() {
            let _ = write!(text, "{}", k + 1);
            sample.values.iter().for_each(|value| {
                let _ = write!(text, ",{value}");
            });
            for &measure in &self.measures {
                let _ = match sample.scores.get(measure) {
                    Some(value) => write!(text, ",{value}"),
                    None => write!(text, ","),
                };
            }
            let stop = sample.stop.as_deref().unwrap_or_default().replace([',', '"', '\n'], ";");
            let _ = writeln!(text, ",{stop}");
        }
        crate::output::marked(text)
    }

    /// Takes up the pieces of a file, which must be of the same workshop.
    ///
    /// # Errors
    /// See [`KeptError`].
    pub fn restore(&mut self, path: &Path, text: &str) -> Result<(), KeptError> {
        let fail = |line: Option<usize>, message: String| KeptError { path: path.to_owned(), line, message };
        let mut lines = text.lines();
        let head = lines.next().unwrap_or_default();
        if !head.starts_with(HEAD) {
            return Err(fail(Some(1), "is no file of pieces.".to_owned()));
        }
        if !head.contains(&format!(", of {}", self.key)) {
            let message = "holds pieces of something else: another layout, design, set of tolerances, seed, step or version. Choose another \
                           place with --out, or begin anew there with --force.";
            return Err(fail(Some(1), message.to_owned()));
        }
        let columns = 2 + self.quantities.len() + self.measures.len();
        self.list.clear();
        for (k, line) in lines.enumerate().skip(1) {
            let cells: Vec<&str> = line.split(',').collect();
            let damaged = || fail(Some(k + 2), "is damaged. Restore it, or begin anew with --force.".to_owned());
            if cells.len() != columns || cells[0].parse() != Ok(k) {
                return Err(damaged());
            }
            let number = |cell: &&str| cell.parse::<f64>().map_err(|_| damaged());
            let (values, rest) = cells[1..columns - 1].split_at(self.quantities.len());
            let values = values.iter().map(number).collect::<Result<Vec<_>, _>>()?;
            let mut scores = Scores::default();
            for (&measure, cell) in self.measures.iter().zip(rest) {
                scores.set(measure, if cell.is_empty() { None } else { Some(number(cell)?) });
            }
            let stop = Some(cells[columns - 1].to_owned()).filter(|stop| !stop.is_empty());
            self.list.push(Sample { values, scores, stop });
        }
        Ok(())
    }
}

/// What pieces follow from: everything but what is asked of them, and how many there are.
fn key(workshop: &Workshop, seed: u64) -> String {
    let design = match workshop.drawing().design() {
        DesignRef::Plane(design) => physics(design),
        DesignRef::Space(design) => physics(design),
    };
    let mut tolerances = workshop.tolerances().clone();
    (tolerances.thresholds, tolerances.seed, tolerances.samples) = (None, None, 0);
    let (drawing, plan) = (workshop.drawing(), workshop.plan());
    let mut key = Key::empty();
    // Since wrong spheres on one side stand there alone, and no image of a sphere on the axis is a sphere.
    key.add(b"places");
    key.add(design.as_bytes());
    key.add(format!("{tolerances:?}").as_bytes());
    key.add(format!("{:?} {:?}", drawing.palette(), drawing.materials()).as_bytes());
    key.add(format!("{} {:?} {:?}", plan.integrator, plan.step, plan.window).as_bytes());
    key.add(format!("{:?} {seed} {VERSION}", workshop.measures().collect::<Vec<_>>()).as_bytes());
    key.text()
}

/// All of a design that pieces follow from.
fn physics<L: Clone + Debug, R: Clone + Debug>(design: &Design<L, R>) -> String {
    let mut design = design.clone();
    (design.name, design.path, design.text) = Default::default();
    design.thresholds.clear();
    design.prices.clear();
    design.notes.clear();
    format!("{design:?}")
}
