//! `granulens diff`: what differs between two layouts.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use granulens::build::{Change, changes};
use granulens::dem::Stop;
use granulens::design::Design;
use granulens::evaluate::{Forces, Plan, Subject, beside_uniform, method};
use granulens::layout;
use granulens::outcome::{COMMIT, FORMAT, Method, VERSION};
use serde_json::{Value, json};

use super::compare::read_piece;
use super::console::{context, emit, emit_json, note};
use super::cost::{Part, arrangement, tell};
use super::failure::Failure;
use super::folder::{probe, write_json};
use super::{Common, Motion};

/// Which spheres differ between two layouts of one crystal and, with a design, what that does to C, G and Q
#[derive(clap::Args)]
pub struct Diff {
    /// Layout, CSV with the header row,column,x,z,diameter,material
    a: PathBuf,
    /// The layout to compare it with
    b: PathBuf,
    /// Design file under whose impact both are simulated
    #[arg(long, value_name = "FILE")]
    design: Option<PathBuf>,
    #[command(flatten)]
    motion: Motion,
}

/// C, G and Q.
type Ratios = [Option<f64>; 3];
const NAMES: [&str; 3] = ["contrast", "focal_gain", "protection"];

impl Diff {
    pub fn run(self, common: &Common) -> Result<(), Failure> {
        let design = self.design.as_ref().map(Design::read).transpose()?;
        let read = |path: &Path| match &design {
            Some(design) => read_piece(common, design, path),
            None => Ok(layout::read_piece(path, &layout::lattice_of(path)?, &[], &[])?),
        };
        let (a, b) = (read(&self.a)?, read(&self.b)?);
        let (a, b) = (Subject::from(&a), Subject::from(&b));
        let changes = changes(a, b).ok_or_else(|| {
            let size = |piece: Subject<'_>| {
                let lattice = &piece.layout.lattice;
                format!(
                    "{} rows, {} m half wide, spheres of {} m",
                    lattice.rows(),
                    lattice.half_width(),
                    lattice.diameter()
                )
            };
            let names = [&self.a, &self.b].map(|path| path.display());
            Failure::input_with_help(
                format!("the crystals differ: {} has {}, {} has {}.", names[0], size(a), names[1], size(b)),
                "Compare layouts of one crystal.",
            )
        })?;
        if common.dry_run {
            let mut parts = Vec::new();
            if let Some(design) = &design {
                let plan = self.plan(design, a, b, common)?;
                let alone = arrangement(&a.layout.sample(), &granulens::evaluate::impact(design, &plan))?;
                parts.push(Part::new(
                    "both layouts and the uniform crystals of host and lens material",
                    4,
                    Some(4.0 * alone),
                ));
            }
            return tell(common, &parts);
        }
        probe(common, common.out.as_ref())?;
        let mut how = None;
        let ratios = match &design {
            Some(design) => {
                let plan = self.plan(design, a, b, common)?;
                note(common, &how.insert(method(design, &plan)).words());
                Some([ratios(design, a, &plan)?, ratios(design, b, &plan)?])
            }
            None => None,
        };
        let told = self.json(&changes, ratios.as_ref(), how);
        write_json(common, &told)?;
        if common.json {
            emit_json(&told);
        } else {
            emit(&self.words(&changes, ratios.as_ref()));
        }
        Ok(())
    }

    /// One step and window for both layouts.
    fn plan(&self, design: &Design, a: Subject<'_>, b: Subject<'_>, common: &Common) -> Result<Plan, Failure> {
        let mut palette = a.layout.palette.clone();
        palette.extend(b.layout.palette.iter().filter(|material| !a.layout.palette.contains(material)).cloned());
        let overrides = self.motion.overrides(common);
        Plan::new(design, overrides, &palette).map_err(|error| Failure::of_plan(design, &overrides, &error))
    }

    fn json(&self, changes: &[Change], ratios: Option<&[Ratios; 2]>, method: Option<Method>) -> Value {
        let listed = changes.iter().map(|change| {
            json!({
                "row": change.site.row, "column": change.site.column, "x": change.site.x, "z": change.site.z,
                "spheres": change.spheres, "from": change.from, "to": change.to,
            })
        });
        let counted = counted(changes).into_iter().map(
            |((from, to), [sites, spheres])| json!({ "from": from, "to": to, "sites": sites, "spheres": spheres }),
        );
        let mut told = match method {
            Some(method) => json!(method),
            None => json!({ "version": VERSION, "commit": COMMIT }),
        };
        let differing = json!({
            "format": FORMAT,
            "a": self.a.display().to_string(),
            "b": self.b.display().to_string(),
            "sites": changes.len(),
            "spheres": changes.iter().map(|change| change.spheres).sum::<usize>(),
            "counts": counted.collect::<Vec<_>>(),
            "changes": listed.collect::<Vec<_>>(),
        });
        if let (Value::Object(told), Value::Object(differing)) = (&mut told, differing) {
            told.extend(differing);
        }
        if let Some([a, b]) = ratios {
            for (k, name) in NAMES.into_iter().enumerate() {
                let change = a[k].zip(b[k]).map(|(a, b)| b - a);
                told[name] = json!({ "a": a[k], "b": b[k], "change": change });
            }
        }
        told
    }

    fn words(&self, changes: &[Change], ratios: Option<&[Ratios; 2]>) -> String {
        let spheres: usize = changes.iter().map(|change| change.spheres).sum();
        let mut text = format!("{} sites differ, {spheres} spheres of the piece\n", changes.len());
        for ((from, to), [sites, spheres]) in counted(changes) {
            let _ = writeln!(text, "  {from} -> {to}: {sites} sites, {spheres} spheres");
        }
        if !changes.is_empty() {
            text.push_str("\n| row | column | from | to |\n|---|---|---|---|\n");
        }
        for Change { site, from, to, .. } in changes {
            let _ = writeln!(text, "| {} | {} | {from} | {to} |", site.row, site.column);
        }
        if let Some([a, b]) = ratios {
            let [of_a, of_b] = [&self.a, &self.b].map(|path| path.display());
            let _ = writeln!(text, "\n| | {of_a} | {of_b} | change |\n|---|---|---|---|");
            let shown = |value: Option<f64>| value.map_or("-".to_owned(), |value| format!("{value:.4}"));
            for (k, symbol) in ["C", "G", "Q"].into_iter().enumerate() {
                let change = a[k].zip(b[k]).map_or("-".to_owned(), |(a, b)| format!("{:+.4}", b - a));
                let _ = writeln!(text, "| {symbol} | {} | {} | {change} |", shown(a[k]), shown(b[k]));
            }
        }
        text
    }
}

/// Sites and spheres by what they change from and to.
fn counted(changes: &[Change]) -> BTreeMap<(&str, &str), [usize; 2]> {
    let mut counts: BTreeMap<(&str, &str), [usize; 2]> = BTreeMap::new();
    for change in changes {
        let [sites, spheres] = counts.entry((&change.from, &change.to)).or_default();
        *sites += 1;
        *spheres += change.spheres;
    }
    counts
}

/// C, G and Q of a layout: G against the host alone, Q against the design's lens material alone.
fn ratios(design: &Design, piece: Subject<'_>, plan: &Plan) -> Result<Ratios, Failure> {
    let beside = beside_uniform(design, piece, plan, Forces::ONE, context())?;
    let stops = beside.evaluation.record.stop.iter().chain(beside.stopped.iter().map(|(_, stop)| stop));
    match stops.into_iter().next() {
        None => {}
        Some(Stop::Interrupted { .. }) => return Err(Failure::Interrupted("nothing is told".to_owned())),
        Some(stop) => return Err(Failure::Guard(vec![stop.to_string()])),
    }
    let scores = &beside.evaluation.scores;
    Ok([scores.contrast, scores.focal_gain, scores.protection])
}
