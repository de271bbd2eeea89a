//! `granulens measured`: measured histories drawn on the prediction.

use std::path::{Path, PathBuf};

use granulens::dem::rig::RigStop;
use granulens::dem::{MoveIn, Spheres};
use granulens::design::Design;
use granulens::measured::{
    Channel, Comparison, Data, DataError, Fit, Input, InputError, PredictError, compare, curves_csv, fit, page, predict,
};
use granulens::outcome::{Begun, FORMAT};
use granulens::report::Provenance;
use granulens::setup::{PreparedRig, Setup};
use granulens::units::Dimension::Time;
use serde_json::json;

use super::compare::read_layout;
use super::console::{context, emit, emit_json, note, pretty};
use super::failure::Failure;
use super::folder::begin;
use super::{Common, command_line, cost};

/// Draw measured force, velocity or displacement histories on the prediction; fit uncertain inputs
///
/// The data are CSV: time_s, then columns named as the records of granulens simulate: z-high_force_N and bar_velocity_m_s of flats,
/// bar_1_force_N of bars, layer_5_m_s, and sphere_LAYER_COLUMN_vz_m_s of spheres. The page and its numbers go to the folder
/// measured/NAME unless --out names another.
#[derive(clap::Args)]
#[command(group = clap::ArgGroup::new("of").required(true).args(["design", "rig"]))]
pub struct Measured {
    /// Measured histories
    data: PathBuf,
    /// Design file whose lens, or --layout, was built and struck
    #[arg(long, value_name = "FILE")]
    design: Option<PathBuf>,
    /// Layout that was built in place of the design's proposed lens
    #[arg(long, value_name = "FILE", requires = "design")]
    layout: Option<PathBuf>,
    /// Rig file of what was built and struck
    #[arg(long, value_name = "FILE")]
    rig: Option<PathBuf>,
    /// Inputs to fit: amplitude, yield_stress, yield_stress:MATERIAL, friction
    #[arg(long, value_name = "INPUT", value_delimiter = ',')]
    fit: Vec<String>,
    /// Measured time less predicted time, where it is known; else it is found
    #[arg(long, value_name = "TIME", allow_hyphen_values = true, value_parser = offset)]
    offset: Option<f64>,
}

fn offset(text: &str) -> Result<f64, String> {
    Time.parse(text).map_err(|error| error.to_string())
}

impl Measured {
    pub fn run(self, common: &Common) -> Result<(), Failure> {
        let data = Data::read(&self.data)?;
        let mut inputs: Vec<Input> = Vec::new();
        for text in &self.fit {
            let input: Input = text.parse()?;
            if inputs.contains(&input) {
                return Err(InputError::Twice(input.to_string()).into());
            }
            inputs.push(input);
        }
        let setup = match (&self.design, &self.rig, &self.layout) {
            (Some(design), _, Some(layout)) => {
                let design = Design::read(design)?;
                let layout = read_layout(common, &design, layout)?;
                Setup::of_layout(&design, &layout)?
            }
            (Some(file), ..) | (None, Some(file), _) => Setup::read_seeded(file, common.seed)?,
            (None, None, _) => {
                return Err(Failure::input_with_help("no rig is named", "Add --rig RIG.toml or --design DESIGN.toml."));
            }
        };
        match setup {
            Setup::One(prepared) => self.prepared(&prepared, &data, &inputs, common),
            Setup::Two(prepared) => self.prepared(&prepared, &data, &inputs, common),
            Setup::Three(prepared) => self.prepared(&prepared, &data, &inputs, common),
        }
    }

    fn prepared<const D: usize>(
        &self,
        prepared: &PreparedRig<D>,
        data: &Data,
        inputs: &[Input],
        common: &Common,
    ) -> Result<(), Failure>
    where
        Spheres: MoveIn<D>,
    {
        let mut channels = Vec::new();
        for record in &data.records {
            let channel = Channel::find(&record.name, prepared);
            channels.push(channel.map_err(|words| {
                Failure::input_with_help(format!("{}: {words}", self.data.display()), "Rename or leave out the column.")
            })?);
        }
        inputs.iter().try_for_each(|input| input.check(&prepared.rig))?;
        note(common, &prepared.method().words());
        prepared.plan.warnings.iter().for_each(|warning| note(common, &format!("warning: {warning}")));
        if common.dry_run {
            let mut simulation = prepared.simulation().map_err(PredictError::Rig)?;
            let alone = cost::rig(&mut simulation, prepared.plan.steps());
            // A step takes two runs for each input's slope and one to try it; two rounds settle in some five steps each.
            let count = 1 + 10 * (2 * inputs.len() as u64 + u64::from(!inputs.is_empty()));
            let what = "runs of the rig; with --fit a rough guess";
            return cost::tell(common, &[cost::Part::new(what, count, Some(alone * count as f64))]);
        }
        let place = common.out.clone().unwrap_or_else(|| Path::new("measured").join(&prepared.name));
        let folder = begin(common, &place)?;
        let begun = Begun::now();
        let before = predict(prepared, &channels, &[], context())?;
        let apart = || {
            Failure::input_with_help(
                format!("{}: less than half of the values lie in the window of the prediction", self.data.display()),
                "Lengthen run.window, cut the data, or correct --offset.",
            )
        };
        let compared = compare(data, &before, self.offset).ok_or_else(apart)?;
        let fitted = match inputs {
            [] => None,
            inputs => {
                let fit = fit(prepared, data, &channels, inputs, self.offset, context())?.ok_or_else(apart)?;
                let after = compare(data, &fit.prediction, Some(fit.offset)).ok_or_else(apart)?;
                Some((fit, after))
            }
        };
        let told = json!({
            "format": FORMAT,
            "name": prepared.name,
            "data": self.data.display().to_string(),
            "compared": compared,
            "fit": fitted.as_ref().map(|(fit, after)| json!({
                "inputs": fit.inputs, "offset_s": fit.offset, "offset_interval_s": fit.offset_interval, "runs": fit.runs,
                "compared": after,
            })),
        });
        let title = format!("{}: measured and predicted", prepared.name);
        let of_fit = fitted.as_ref().map(|(fit, after)| (fit, after));
        let (best, at) = fitted.as_ref().map_or((&before, compared.offset_s), |(fit, _)| (&fit.prediction, fit.offset));
        let seeds = [prepared.seeds.first().copied().unwrap_or_default(), prepared.seeds.len() as u64];
        let file = (&prepared.name[..], prepared.path.as_path(), &prepared.text[..]);
        let mut manifest = begun.manifest(file, prepared.method(), "as the file says".to_owned(), seeds);
        manifest.command = Some(command_line());
        for (name, text) in [
            ("report.html", page(&title, provenance(prepared), data, (&before, &compared), of_fit)),
            ("curves.csv", curves_csv(data, best, at)),
            ("measured.json", pretty(&told)),
            ("manifest.json", pretty(&manifest)),
        ] {
            folder.write(name, text.as_bytes())?;
        }
        folder.finish()?;
        if common.json {
            emit_json(&told);
        } else {
            emit(&words(&compared, of_fit));
        }
        note(common, &format!("page: {}", place.join("report.html").display()));
        Ok(())
    }
}

fn words(compared: &Comparison, fitted: Option<(&Fit, &Comparison)>) -> String {
    let mut text = format!("measured time = predicted time + {}\n", Time.show(compared.offset_s));
    table(&mut text, compared);
    let Some((fit, after)) = fitted else { return text };
    text += &format!("\nfitted in {} simulations:\n", fit.runs);
    for input in &fit.inputs {
        let interval =
            input.interval.map_or(", not told by these records".to_owned(), |half| format!(" ± {half:.2e} (95 %)"));
        let bound = if input.at_bound { ", at the end of its range" } else { "" };
        text += &format!("  {} = {:.5}{interval}{bound}, {}\n", input.input, input.value, input.meaning);
    }
    text += &format!("  offset {}\n", Time.show(fit.offset));
    table(&mut text, after);
    if after.records.iter().any(|record| record.neighbours > 0.5) {
        text += "\nresiduals hang together from sample to sample: the intervals, which take them for noise, are too narrow\n";
    }
    text
}

fn table(text: &mut String, compared: &Comparison) {
    *text += "\n| record | arrival measured | predicted | peak measured | predicted | rms over peak |\n|---|---|---|---|---|---|\n";
    for record in &compared.records {
        let (m, p) = (&record.measured, &record.predicted);
        *text += &format!(
            "| {} | {} | {} | {:.4e} | {:.4e} | {:.2} % |\n",
            record.name,
            Time.show(m.arrival_s),
            Time.show(p.arrival_s),
            m.peak,
            p.peak,
            100.0 * record.rms_over_peak
        );
    }
}

fn provenance<const D: usize>(prepared: &PreparedRig<D>) -> Provenance {
    Provenance::new(command_line(), prepared.path.display().to_string(), prepared.text.clone()).by(&prepared.method())
}

impl From<DataError> for Failure {
    fn from(error: DataError) -> Self {
        Self::input_with_help(error.to_string(), error.help)
    }
}

impl From<InputError> for Failure {
    fn from(error: InputError) -> Self {
        Self::input_with_help(error.to_string(), "Choose other inputs with --fit.")
    }
}

impl From<PredictError> for Failure {
    fn from(error: PredictError) -> Self {
        match error {
            PredictError::Stopped(RigStop::Interrupted { .. }) => Self::Interrupted("nothing is written".to_owned()),
            error => Self::Guard(vec![error.to_string()]),
        }
    }
}
