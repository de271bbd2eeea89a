//! `granulens tolerance`: will the layout still work once a workshop has made it?

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use granulens::dem::Integrator;
use granulens::design::{AnyDesign, DesignRef};
use granulens::evaluate::{
    Drawing, OverLawsError, Overrides, Subject, evaluate_in_space, impact, impact_in_space, method, over_laws, refer,
};
use granulens::outcome::FORMAT;
use granulens::output;
use granulens::report::Provenance;
use granulens::score::Measure;
use granulens::tolerance::{
    Criterion, INTERVAL, KeptError, MOST_SAMPLES, Samples, State, Told, Tolerances, Workshop, WorkshopError, as_built,
    assumed, derivative_runs, distributions, indices, indices_runs, indices_words, inverse, inverse_words, page,
    rechoose, sensitivity, sites, sites_runs, yield_of,
};
use serde_json::json;

use super::compare::read_piece;
use super::console::{Count, context, emit, emit_json, note, pretty};
use super::cost::{Part, arrangement, tell};
use super::failure::Failure;
use super::{Common, Motion, command_line};

/// Before it is built: what a layout is worth once a workshop has made it
///
/// Tells how much each score changes with each thing that may turn out otherwise, and which share of pieces does what is asked. With --out a folder
/// keeps all of it: the pieces, which later runs go on from and ask other thresholds of, the numbers as JSON, and a page.
#[derive(clap::Args)]
pub struct Tolerance {
    /// Layout, CSV with the header row,column,x,z,diameter,material or, in space, layer,column,x,y,z,diameter,material
    layout: PathBuf,
    /// Design file: everything but the materials
    #[arg(long, value_name = "FILE")]
    design: PathBuf,
    /// What may turn out otherwise, TOML; without it diameters are of grade G100 and all else is nominal
    #[arg(long, value_name = "FILE")]
    tolerances: Option<PathBuf>,
    /// Pieces to make [default: those of the file of tolerances, or 500]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=u64::from(MOST_SAMPLES)))]
    samples: Option<u64>,
    /// What one wrong sphere costs at each site of a sheet, the worst single one, and the worst pair among the worst
    #[arg(long)]
    sites: bool,
    /// Elementary effects (Morris): which quantities matter anywhere within their limits
    #[arg(long)]
    indices: bool,
    /// What grade, friction and part of wrong spheres may be, for so many of the pieces, such as "95 %"
    #[arg(long = "for", value_name = "PERCENT", value_parser = super::fraction)]
    wanted: Option<f64>,
    /// What it wins to measure all spheres of a piece and choose the K worst anew
    #[arg(long, value_name = "K", value_parser = clap::value_parser!(u32).range(1..))]
    rechoose: Option<u32>,
    #[command(flatten)]
    motion: Motion,
}

/// Pieces of each rung of --for, where more are made for the yield.
const OF_RUNG: u64 = 200;

/// Files of the folder.
const PIECES: &str = "pieces.csv";
const NUMBERS: &str = "tolerance.json";
const PAGE: &str = "report.html";

/// The scores that are told of besides those that are asked.
const TOLD: [Measure; 3] = [Measure::Contrast, Measure::FocalGain, Measure::Protection];

impl Tolerance {
    pub fn run(self, common: &Common) -> Result<(), Failure> {
        match AnyDesign::read(&self.design)? {
            AnyDesign::Plane(mut design) => {
                super::asks_equal_spheres(&design, "tolerance")?;
                let read = read_piece(common, &design, &self.layout)?;
                let subject = Subject::from(&read);
                // As in check and compare: what Q refers to where the design does not say it.
                let warning = refer(&mut design, &subject.layout.palette, &subject.drawn());
                self.judge(common, Drawing::Plane(&design, subject), warning)
            }
            AnyDesign::Space(mut design) => {
                let layout = super::space::read(&design, &self.layout)?;
                let warning = refer(&mut design, &layout.palette, &layout.materials);
                self.judge(common, Drawing::Space(&design, &layout), warning)
            }
        }
    }

    fn judge(&self, common: &Common, drawing: Drawing<'_>, warning: Option<String>) -> Result<(), Failure> {
        let design = drawing.design();
        let tolerances = match &self.tolerances {
            Some(path) => Tolerances::read(path, drawing)?,
            None => Tolerances::usual(),
        };
        let seed = common.seed.or(tolerances.seed).unwrap_or(1);
        let count = self.samples.unwrap_or(tolerances.samples);
        // Rigs know Verlet only.
        let integrator =
            if tolerances.state == State::Settled { Some(Integrator::Verlet) } else { self.motion.integrator };
        let overrides = Overrides { integrator, ..self.motion.overrides(common) };
        let plan = tolerances.plan(drawing, overrides).map_err(|error| match drawing {
            Drawing::Plane(design, _) => Failure::of_plan(design, &overrides, &error),
            Drawing::Space(design, _) => Failure::of_plan(design, &overrides, &error),
        })?;
        let thresholds = tolerances.thresholds.as_deref().unwrap_or(design.thresholds());
        let asked: Vec<Measure> = thresholds.iter().map(|threshold| threshold.measure).collect();
        let workshop = Workshop::new(drawing, &tolerances, &plan, &asked)?;
        if tolerances.state == State::Settled && (self.sites || self.rechoose.is_some()) {
            return Err(Failure::input_with_help(
                "--sites and --rechoose judge pieces on nominal sites, and the file of tolerances says state = \"settled\".",
                "Leave them out, or take a file with state = \"nominal-sites\".",
            ));
        }
        if self.sites && drawing.is_in_space() {
            return Err(super::space::refuse("--sites"));
        }
        if common.dry_run {
            return self.cost(common, &workshop, count);
        }
        let folder = common.out.as_deref();
        let mut samples = Samples::new(&workshop, seed);
        if let Some(folder) = folder {
            begin(common, folder, &mut samples)?;
        }
        let given = Overrides {
            step: Some(plan.step),
            window: Some(plan.window),
            integrator: Some(plan.integrator),
            ..overrides
        };
        let criterion = Criterion::new(drawing, &tolerances, given, context())?;

        let known = samples.list.len();
        let more = [
            if self.sites { sites_runs(&workshop) } else { 0 },
            if self.indices { indices_runs(&workshop) } else { 0 },
        ];
        let runs = sensitivity_runs(&workshop) + (count as usize).saturating_sub(known) + more.iter().sum::<usize>();
        let bar = Count::new(common, runs, "pieces");
        let working = bar.context();
        let found = sensitivity(&workshop, &asked, seed, &working)?;
        let grown = samples.grow(&workshop, count, &working, |samples| match folder {
            Some(folder) => Ok(output::write(&folder.join(PIECES), samples.csv().as_bytes(), common.force)?),
            None => Ok(()),
        });
        if let Err(failure) = grown {
            bar.done();
            let kept = samples.list.len();
            return Err(match (failure, folder) {
                (Failure::Interrupted(_), Some(_)) => Failure::Interrupted(format!(
                    "{kept} of {count} pieces are kept; the same command goes on from there"
                )),
                (failure, _) => failure,
            });
        }
        let mut measures: Vec<Measure> = TOLD.to_vec();
        measures.extend(
            asked.iter().filter(|measure| !TOLD.contains(measure) && workshop.measures().any(|m| m == **measure)),
        );
        let of_layout = drawing.scores();
        let (share, stopped) = yield_of(&samples, count as usize, &criterion, &of_layout);
        let mut words = String::new();
        let mut files: Vec<(&str, String)> = Vec::new();
        let mut maps = Vec::new();
        let mut more = BTreeMap::new();
        if !tolerances.laws.is_empty() {
            let over =
                over_laws(drawing, &tolerances.laws, self.motion.overrides(common), context()).map_err(|error| {
                    match error {
                        OverLawsError::Evaluate(error) => error.into(),
                        error @ OverLawsError::Plan { .. } => Failure::input(error.to_string()),
                    }
                })?;
            words += &over.table();
            more.insert("laws", json!(over));
        }
        if let Drawing::Plane(design, subject) = drawing
            && self.sites
        {
            let found = sites(&workshop, &working)?;
            words += &found.words();
            files.push(("sites.csv", found.csv()));
            let map = found.map(design, subject);
            maps.push(map.clone());
            files.push(("sites.svg", map));
            more.insert("sites", json!(found));
        }
        if self.indices {
            let found = indices(&workshop, seed, &working)?;
            words += &indices_words(&found);
            more.insert("indices", json!(found));
        }
        if let Some(wanted) = self.wanted {
            let asked = (wanted, count.min(OF_RUNG), seed);
            let found = inverse(&workshop, &criterion, asked, &of_layout, &working)?;
            words += &inverse_words(&found, wanted);
            more.insert("inverse", json!({ "wanted": wanted, "found": found }));
        }
        if let Some(spheres) = self.rechoose {
            let energy = match drawing {
                Drawing::Plane(design, subject) => {
                    subject.on_places(&subject.evaluate(design, &plan, context())?.record.max_kinetic)
                }
                Drawing::Space(design, layout) => {
                    evaluate_in_space(design, layout, &plan, context())?.record.max_kinetic
                }
            };
            let with = (&of_layout, &energy[..]);
            let found = rechoose(&workshop, &criterion, (spheres as usize, seed), with, &working)?;
            words += &found.words();
            more.insert("rechoose", json!(found));
        }
        bar.done();
        let told = Told {
            format: FORMAT,
            design: design.name().to_owned(),
            layout: self.layout.display().to_string(),
            state: match tolerances.state {
                State::NominalSites => "nominal-sites",
                State::Settled => "settled",
            },
            assumed: assumed(&tolerances, workshop.quantities(), self.tolerances.is_some()),
            share: share.share,
            interval: share.interval,
            interval_method: INTERVAL,
            yield_of: criterion.words.clone(),
            baseline: criterion.baseline.clone(),
            passed: share.passed,
            samples: share.of,
            stopped,
            seed,
            quantities: workshop.quantities().to_vec(),
            as_built: as_built(&found),
            no_derivatives: found.no_derivatives,
            sensitivity: found.changes,
            distribution: distributions(&samples, count as usize, &measures),
            method: match design {
                DesignRef::Plane(design) => method(design, &plan),
                DesignRef::Space(design) => method(design, &plan),
            },
            warnings: plan.warnings.iter().cloned().chain(warning).collect(),
            more,
            words,
        };
        if let Some(folder) = folder {
            let (file, text) = (design.path().display().to_string(), design.text().to_owned());
            let provenance =
                Provenance::new(command_line(), file, text).by(&told.method).with("Random seed", seed.to_string());
            let page = page(&told, provenance, &criterion, &samples, &measures, &maps);
            for (name, text) in &files {
                output::write(&folder.join(name), text.as_bytes(), common.force)?;
            }
            output::write(&folder.join(NUMBERS), pretty(&told).as_bytes(), common.force)?;
            output::write(&folder.join(PAGE), page.as_bytes(), common.force)?;
            note(common, &format!("kept: {}", folder.display()));
        }
        if common.json {
            emit_json(&told);
        } else {
            emit(&told.words());
            told.warnings.iter().for_each(|warning| note(common, &format!("warning: {warning}")));
        }
        Ok(())
    }

    /// What it would cost.
    fn cost(&self, common: &Common, workshop: &Workshop, count: u64) -> Result<(), Failure> {
        let (drawing, plan) = (workshop.drawing(), workshop.plan());
        let alone = match drawing {
            Drawing::Plane(design, subject) => arrangement(&subject.layout.sample(), &impact(design, plan))?,
            Drawing::Space(design, layout) => arrangement(&layout.sample_in_space(), &impact_in_space(design, plan))?,
        };
        // In lanes without records a run takes about a fifth of one with them; whole pieces are two halves, and rigs find their contacts.
        let each = match (workshop.tolerances().state, workshop.tolerances().halves_alike) {
            (State::Settled, _) => 12.0 * alone,
            // Every other piece is struck by a plate, beside uniform crystals of its own.
            _ if workshop.tolerances().impact.projectile.is_some() && !drawing.is_in_space() => 18.0 * alone,
            (_, true) => 0.3 * alone,
            (_, false) => 0.6 * alone,
        };
        let runs = 8 * sensitivity_runs(workshop) as u64;
        let mut parts = vec![
            Part::new("runs for the sensitivities, pieces under 8 forces each", runs, Some(each * runs as f64)),
            Part::new("pieces for the yield", count, Some(each * count as f64)),
        ];
        let runs = derivative_runs(workshop);
        if runs > 0 {
            parts.push(Part::new("derivatives, under 8 forces", runs, Some(8.0 * alone * runs as f64)));
        }
        tell(common, &parts)
    }
}

/// Pieces that sensitivities take.
fn sensitivity_runs(workshop: &Workshop) -> usize {
    1 + workshop.quantities().iter().map(|quantity| if quantity.kind.is_random() { 16 } else { 2 }).sum::<usize>()
}

/// Takes up what a folder keeps, and finds out at once whether it can be written.
fn begin(common: &Common, folder: &Path, samples: &mut Samples) -> Result<(), Failure> {
    output::check_known(folder, &[PIECES])?;
    let pieces = folder.join(PIECES);
    if pieces.exists() {
        // Not among what the command is given: it may be written anew.
        let text =
            std::fs::read_to_string(&pieces).map_err(|error| Failure::of_file(&pieces, None, &error.to_string()))?;
        match samples.restore(&pieces, &text) {
            Err(_) if common.force => samples.list.clear(),
            taken => taken?,
        }
    }
    for name in [PIECES, NUMBERS, PAGE] {
        output::check(&folder.join(name), common.force)?;
    }
    Ok(())
}

impl From<WorkshopError> for Failure {
    fn from(error: WorkshopError) -> Self {
        match error {
            WorkshopError::Evaluator(error) => error.into(),
            WorkshopError::Held(error) => error.into(),
            WorkshopError::Records(_)
            | WorkshopError::Halves
            | WorkshopError::Projectile
            | WorkshopError::Sheets(_) => Self::input(error.to_string()),
        }
    }
}

impl From<KeptError> for Failure {
    fn from(error: KeptError) -> Self {
        let line = error.line.map(|line| line as u64);
        Self::of_file(&error.path, line, &error.message)
    }
}
