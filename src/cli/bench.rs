//! `granulens bench`: what the user's own design costs on this machine.

use std::path::PathBuf;
use std::time::Instant;

use granulens::dem::{Phases, simulate, simulate_batch_timed, steps_in};
use granulens::design::{Accuracy, Design};
use granulens::evaluate::{Comparison, impact};
use granulens::real::Width;
use granulens::sample::Sample;
use rayon::prelude::*;
use serde::Serialize;

use super::console::{emit, emit_json, interrupt, note};
use super::failure::Failure;
use super::{Common, Motion, propose};

/// Measure what simulations of a design cost here: per sphere and step, per contact, per design in a batch
///
/// Simulates the design's lens for a moment, alone with full records and in batches as searches do, and estimates what run and
/// a search cost. Times are wall-clock: a busy machine shows.
#[derive(clap::Args)]
pub struct Bench {
    /// Design file, such as designs/thesis-lens.toml
    design: PathBuf,
    /// Accuracy class for which the step is chosen, also where the design gives one: "0.1 %" or "1 %"
    #[arg(long, value_name = "CLASS", value_parser = accuracy)]
    accuracy: Option<Accuracy>,
    #[command(flatten)]
    motion: Motion,
}

fn accuracy(text: &str) -> Result<Accuracy, String> {
    match text.replace(' ', "").as_str() {
        "0.1%" => Ok(Accuracy::TenthPercent),
        "1%" => Ok(Accuracy::OnePercent),
        _ => Err("known are \"0.1 %\" and \"1 %\"".to_owned()),
    }
}

/// What --json prints.
#[derive(Serialize)]
struct Figures {
    format: u32,
    design: String,
    spheres: usize,
    step_s: f64,
    window_s: f64,
    steps: u64,
    threads: usize,
    lanes: usize,
    /// One design of a full batch on one core (ms).
    ms_per_design: f64,
    /// The same with all threads busy, per design and core (ms).
    ms_per_design_all_threads: f64,
    designs_per_second: f64,
    /// All threads over one.
    speedup: f64,
    sphere_steps_per_second: f64,
    contact_steps_per_second: f64,
    /// Parts of a batch's time: finding contacts and laws; moving spheres; forces and memories of contacts; maxima and guards.
    share_preparing: f64,
    share_motion: f64,
    share_contacts: f64,
    share_watching: f64,
    /// One arrangement alone, with full records and ledger (ms).
    ms_with_records: f64,
    arrangements: usize,
    /// What `run` will take (s).
    run_s: f64,
    /// What a search of 5000 evaluations will take (s).
    search_5000_s: f64,
}

impl Bench {
    pub fn run(self, common: &Common) -> Result<(), Failure> {
        let mut design = Design::read(&self.design)?;
        if let Some(accuracy) = self.accuracy {
            design.accuracy = accuracy;
            match (self.motion.step, design.step.take()) {
                (Some(_), _) => note(common, "--step says the step, so --accuracy changes nothing"),
                (None, Some(_)) => note(common, "--accuracy chooses the step in place of the design's run.step"),
                (None, None) => {}
            }
        }
        let lens = propose(&design)?;
        let overrides = self.motion.overrides(common);
        let comparison = Comparison::of_lens(&design, &lens, overrides)
            .map_err(|error| Failure::of_plan(&design, &overrides, &error))?;
        note(common, &format!("step: {}", comparison.plan.step_reason));
        let impact = impact(&design, &comparison.plan);
        let sample = comparison.subject.sample();
        let width = Width::widest();
        let lanes = width.lanes();
        let batch: Vec<Sample<2>> = vec![sample.clone(); lanes];
        let group = || {
            simulate_batch_timed(&batch, &impact, width, interrupt()).map_err(|error| Failure::input(error.to_string()))
        };

        // The first run warms caches and clocks; the best of three is what the machine can do.
        let (one, (_, phases)) = best(group)?;
        let one = one / lanes as f64;
        let threads = rayon::current_num_threads();
        let all =
            best(|| (0..threads).into_par_iter().map(|_| group()).collect::<Result<Vec<_>, _>>())?.0 / lanes as f64;
        let (alone, record) =
            best(|| simulate(&sample, &impact, interrupt()).map_err(|error| Failure::input(error.to_string())))?;
        if interrupt().load(std::sync::atomic::Ordering::Relaxed) {
            return Err(Failure::Interrupted("nothing was measured to the end".to_owned()));
        }
        let steps = steps_in(impact.window, impact.step);
        let arrangements = comparison.len();
        let figures = Figures {
            format: granulens::outcome::FORMAT,
            design: design.name.clone(),
            spheres: sample.spheres.len(),
            step_s: impact.step,
            window_s: impact.window,
            steps,
            threads,
            lanes,
            ms_per_design: 1e3 * one,
            ms_per_design_all_threads: 1e3 * all,
            designs_per_second: threads as f64 / all,
            speedup: threads as f64 * one / all,
            sphere_steps_per_second: sample.spheres.len() as f64 * steps as f64 / one,
            contact_steps_per_second: record.contacts.len() as f64 * steps as f64 / one,
            share_preparing: share(&phases, phases.preparing),
            share_motion: share(&phases, phases.motion),
            share_contacts: share(&phases, phases.contacts),
            share_watching: share(&phases, phases.watching),
            ms_with_records: 1e3 * alone,
            arrangements,
            run_s: alone * arrangements as f64 / threads as f64,
            search_5000_s: 5000.0 * all / threads as f64,
        };
        if common.json {
            emit_json(&figures);
        } else {
            emit(&words(&figures));
        }
        Ok(())
    }
}

fn share(phases: &Phases, part: f64) -> f64 {
    part / phases.total().max(f64::MIN_POSITIVE)
}

/// The least time (s) of three runs, and what the first gave.
fn best<T>(run: impl Fn() -> Result<T, Failure>) -> Result<(f64, T), Failure> {
    let given = run()?;
    let mut best = f64::INFINITY;
    for _ in 0..3 {
        let begun = Instant::now();
        run()?;
        best = best.min(begun.elapsed().as_secs_f64());
    }
    Ok((best, given))
}

fn words(f: &Figures) -> String {
    format!(
        "{}: {} spheres, {} steps of {:.3e} s\n\n\
         | figure | value |\n|---|---|\n\
         | one design of a batch of {}, one core | {:.1} ms |\n\
         | the same with {} threads busy, per design and core | {:.1} ms |\n\
         | designs per second, {} threads | {:.1} |\n\
         | speed-up of {} threads | {:.2} |\n\
         | sphere-steps per second and core | {:.1} M |\n\
         | steps of contacts that ever close, per second and core | {:.1} M |\n\
         | of a batch's time: contacts | {:.0} % |\n\
         | moving spheres | {:.0} % |\n\
         | maxima and guards | {:.0} % |\n\
         | finding contacts and laws | {:.1} % |\n\
         | one arrangement alone, with full records | {:.0} ms |\n\
         | granulens run, {} arrangements | {:.1} s |\n\
         | a search of 5000 evaluations | {:.0} s |\n",
        f.design,
        f.spheres,
        f.steps,
        f.step_s,
        f.lanes,
        f.ms_per_design,
        f.threads,
        f.ms_per_design_all_threads,
        f.threads,
        f.designs_per_second,
        f.threads,
        f.speedup,
        1e-6 * f.sphere_steps_per_second,
        1e-6 * f.contact_steps_per_second,
        100.0 * f.share_contacts,
        100.0 * f.share_motion,
        100.0 * f.share_watching,
        100.0 * f.share_preparing,
        f.ms_with_records,
        f.arrangements,
        f.run_s,
        f.search_5000_s,
    )
}
