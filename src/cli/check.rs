//! `granulens check`: simulate a layout under a design's impact.

use std::fmt::Write as _;
use std::path::PathBuf;
use std::time::Instant;

use granulens::dem::Stop;
use granulens::design::{Design, Measure};
use granulens::evaluate::{Evaluation, Plan, evaluate, impact};
use granulens::layout::{Baseline, Layout};
use granulens::outcome::{Checked, FORMAT};
use granulens::units::Dimension::{Energy, Time};

use super::compare::read_layout;
use super::console::{emit, emit_json, interrupt, note};
use super::cost::{Part, arrangement, tell};
use super::failure::Failure;
use super::folder::{probe, write_file, write_json};
use super::over_laws::UnderLaws;
use super::{Common, Motion};

/// Simulate a layout file, proposed or edited by hand, under a design's impact
///
/// With --out, the numbers are written as JSON too.
#[derive(clap::Args)]
pub struct Check {
    /// Layout, CSV with the header row,column,x,z,diameter,material
    layout: PathBuf,
    /// Design file: everything but the materials
    #[arg(long, value_name = "FILE")]
    design: PathBuf,
    #[command(flatten)]
    motion: Motion,
    #[command(flatten)]
    under: UnderLaws,
    /// Write what each sphere felt as CSV
    #[arg(long, value_name = "FILE")]
    spheres: Option<PathBuf>,
    /// Exit with 3 where a threshold of the design file is not met
    #[arg(long)]
    strict: bool,
}

impl Check {
    pub fn run(self, common: &Common) -> Result<(), Failure> {
        let design = Design::read(&self.design)?;
        let layout = read_layout(&design, &self.layout)?;
        let overrides = self.motion.overrides(common);
        let plan = Plan::new(&design, overrides, &layout.palette)
            .map_err(|error| Failure::of_plan(&design, &overrides, &error))?;
        if common.dry_run {
            let seconds = arrangement(&layout.sample(), &impact(&design, &plan))?;
            return tell(common, &[Part::new("the layout, with full records", 1, Some(seconds))]);
        }
        self.under.chosen(&design)?;
        probe(self.spheres.as_ref())?;
        probe(common.out.as_ref())?;
        let begun = Instant::now();
        let evaluation = evaluate(&design, &layout, &plan, interrupt())?;
        let seconds = begun.elapsed().as_secs_f64();
        let mut warnings = evaluation.warnings("this layout");
        let Evaluation { mut scores, mut record, .. } = evaluation;
        if self.strict
            && record.stop.is_none()
            && design.thresholds.iter().any(|t| matches!(t.measure, Measure::FocalGain | Measure::Protection))
        {
            let mut uniform = |baseline: Baseline| -> Result<_, Failure> {
                if layout.palette.len() < 2 {
                    return Ok(None);
                }
                let uniform = evaluate(&design, &baseline.layout(&layout, [1, 1]), &plan, interrupt())?;
                match uniform.record.stop {
                    None => return Ok(Some(uniform.scores)),
                    Some(stop @ Stop::Interrupted { .. }) => record.stop = Some(stop),
                    // Ratios to it would mean nothing; a threshold on one is not met.
                    Some(stop) => warnings.push(format!("FAILED: {}: {stop}", baseline.name())),
                }
                Ok(None)
            };
            let [host, lens] = [uniform(Baseline::AllHost)?, uniform(Baseline::AllLens)?];
            scores.relate(None, host.as_ref(), lens.as_ref());
        }
        if let Some(path) = &self.spheres {
            write_file(path, &spheres(&layout, &record))?;
        }
        let laws = match &record.stop {
            None => self.under.scores(&design, &layout, overrides)?,
            Some(_) => None,
        };
        let checked = Checked {
            format: FORMAT,
            design: design.name.clone(),
            layout: self.layout.display().to_string(),
            scores,
            step_s: plan.step,
            steps: record.steps,
            window_s: plan.window,
            law: design.law_name(),
            constants: design.constants.to_string(),
            integrator: plan.integrator.to_string(),
            seconds,
            warnings: plan.warnings.iter().cloned().chain(warnings).collect(),
            laws,
            stop: record.stop,
        };
        write_json(common, &checked)?;
        if common.json {
            emit_json(&checked);
        } else {
            emit(&words(&checked));
            checked.laws.iter().for_each(|laws| emit(&laws.table()));
            checked.warnings.iter().for_each(|warning| note(common, &format!("warning: {warning}")));
        }
        match &checked.stop {
            Some(stop @ Stop::Interrupted { .. }) => {
                Err(Failure::Interrupted(format!("{stop}; shown is what was computed")))
            }
            Some(stop) => Err(Failure::Guard(vec![stop.to_string()])),
            None if self.strict => {
                if design.thresholds.is_empty() {
                    note(
                        common,
                        &format!("{} sets no [thresholds]; --strict has nothing to ask", self.design.display()),
                    );
                }
                thresholds(&design, &checked)
            }
            None => Ok(()),
        }
    }
}

fn thresholds(design: &Design, checked: &Checked) -> Result<(), Failure> {
    let missed: Vec<String> = design
        .thresholds
        .iter()
        .filter_map(|threshold| {
            let name = threshold.measure.name();
            match threshold.measure.of(&checked.scores) {
                Some(value) if threshold.admits(value) => None,
                Some(value) => {
                    let bound = |word: &str, limit: Option<f64>| limit.map(|limit| format!("{word} {limit}"));
                    let wanted: Vec<_> = [bound("at least", threshold.min), bound("at most", threshold.max)]
                        .into_iter()
                        .flatten()
                        .collect();
                    Some(format!("{name} = {value}, wanted {}", wanted.join(" and ")))
                }
                None => Some(format!("{name} has no value here: its denominator is zero or its baseline is missing")),
            }
        })
        .collect();
    if missed.is_empty() { Ok(()) } else { Err(Failure::Threshold(missed)) }
}

fn words(checked: &Checked) -> String {
    let scores = &checked.scores;
    let foci = match scores.balance {
        Some(balance) => {
            let each: Vec<String> = scores.foci.iter().map(|mean| Energy.show(*mean)).collect();
            format!("by focus           {}; balance {balance:.3}\n", each.join(", "))
        }
        None => String::new(),
    };
    let contrast = scores.contrast.map_or_else(|| "-".to_owned(), |c| format!("{c:.4}"));
    format!(
        "focal mean F       {}\n\
         {foci}protected mean P   {}\n\
         contrast F/P       {contrast}\n\
         work in            {}\n\
         kinetic            {}\n\
         stored             {}\n\
         dissipated         {} (eq. 5.6 estimates {})\n\
         residual           {:.1e}\n\
         exit momentum      {:.4} kg m/s, peak force {:.0} N on the last row\n\
         law {}, constants {}, {} steps of {} ({}), window {}, {:.2} s",
        Energy.show(scores.focal_mean),
        Energy.show(scores.protected_mean),
        Energy.show(scores.work_in),
        Energy.show(scores.kinetic),
        Energy.show(scores.stored),
        Energy.show(scores.dissipated),
        Energy.show(scores.eq_5_6),
        scores.residual,
        scores.exit_momentum,
        scores.exit_force,
        checked.law,
        checked.constants,
        checked.steps,
        Time.show(checked.step_s),
        checked.integrator,
        Time.show(checked.window_s),
        checked.seconds,
    )
}

/// What each sphere felt, as CSV; SI.
fn spheres(layout: &Layout, record: &granulens::dem::Record<2>) -> String {
    let mut text = String::from(
        "row,column,x,z,material,max_kinetic_J,max_net_force_N,max_contact_force_N,arrival_s,dissipated_J\n",
    );
    for (i, site) in layout.lattice.sites().iter().enumerate() {
        let material = &layout.palette[usize::from(layout.materials[i])].name;
        let arrival = record.arrival[i].map_or_else(String::new, |time| time.to_string());
        let _ = writeln!(
            text,
            "{},{},{},{},{material},{},{},{},{arrival},{}",
            site.row,
            site.column,
            site.x,
            site.z,
            record.max_kinetic[i],
            record.max_net_force[i],
            record.max_contact_force[i],
            record.dissipated[i],
        );
    }
    text
}
