//! `granulens bench`: what the user's own design costs on this machine.

use std::path::PathBuf;
use std::time::Instant;

use granulens::dem::{
    BatchError, Impact, Phases, simulate, simulate_batch, simulate_batch_timed, simulate_batch_with_friction, steps_in,
};
use granulens::design::{Accuracy, Design};
use granulens::evaluate::{Comparison, impact, method};
use granulens::outcome::Method;
use granulens::real::Width;
use granulens::sample::{Sample, Sphere};
use granulens::search::Rng;
use rayon::prelude::*;
use serde::Serialize;

use super::console::{context, emit, emit_json, note};
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
    /// Measure crystals as built beside perfect ones, in turn: radii scattered by 0.1 %, 1 % wrong spheres; and with friction 0.2
    #[arg(long)]
    built: bool,
    /// How many designs side by side: 1 without vector registers, 4 with AVX2, 8 with AVX-512 [default: the most that this machine has]
    #[arg(long, value_name = "N", value_parser = width)]
    lanes: Option<Width>,
    #[command(flatten)]
    motion: Motion,
}

fn width(text: &str) -> Result<Width, String> {
    let known = [Width::Scalar, Width::Four, Width::Eight];
    let wanted = known.into_iter().find(|width| width.lanes().to_string() == text).ok_or("known are 1, 4 and 8")?;
    if wanted.is_available() { Ok(wanted) } else { Err("this processor has no registers that wide".to_owned()) }
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
    /// With what, and how.
    #[serde(flatten)]
    method: Method,
    spheres: usize,
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
    /// Crystals as built, with --built.
    #[serde(skip_serializing_if = "Option::is_none")]
    built: Option<Built>,
}

/// One design of a full batch on one core, as built and perfect, measured in turn (ms).
#[derive(Serialize)]
struct Built {
    perfect_ms: f64,
    built_ms: f64,
    with_friction_ms: f64,
    /// Over perfect ones.
    ratio: f64,
    ratio_with_friction: f64,
    /// Batches of each kind.
    rounds: usize,
}

/// Coefficient of friction of what is measured with some.
const FRICTION: f64 = 0.2;
/// Batches of each kind, in turn; the medians of their times count.
const ROUNDS: usize = 7;

/// Crystals of a layout with radii up to 0.1 % too small and one sphere in a hundred of another material, each in its own way.
fn as_built(drawn: &Sample<2>, count: usize) -> Vec<Sample<2>> {
    let materials = drawn.materials.len() as u64;
    let mut rng = Rng::new(1);
    let sphere = |sphere: &Sphere<2>, rng: &mut Rng| {
        let radius = sphere.radius * (1.0 - 1e-3 * rng.unit());
        let (wrong, shift) = (rng.unit() < 0.01, 1 + rng.below(materials.max(2) - 1));
        let material = if wrong { (sphere.material + shift as usize) % materials as usize } else { sphere.material };
        Sphere { radius, material, ..*sphere }
    };
    let one = |rng: &mut Rng| Sample {
        materials: drawn.materials.clone(),
        spheres: drawn.spheres.iter().map(|drawn| sphere(drawn, rng)).collect(),
    };
    (0..count).map(|_| one(&mut rng)).collect()
}

/// Perfect crystals and such as are built, with friction and without, in turn.
fn measure_built(drawn: &Sample<2>, impact: &Impact, width: Width) -> Result<Built, Failure> {
    let lanes = width.lanes();
    let perfect = vec![drawn.clone(); lanes];
    let refused = |error: BatchError| Failure::input(error.to_string());
    let mut times = [const { Vec::new() }; 3];
    for round in 0..=ROUNDS {
        // Other crystals every time.
        let built = as_built(drawn, lanes * (round + 1)).split_off(lanes * round);
        for (k, times) in times.iter_mut().enumerate() {
            let begun = Instant::now();
            match k {
                0 => simulate_batch(&perfect, impact, width, context()).map_err(refused)?,
                1 => simulate_batch(&built, impact, width, context()).map_err(refused)?,
                _ => simulate_batch_with_friction(&built, impact, FRICTION, None, width, context()).map_err(refused)?,
            };
            // The first round warms caches and clocks.
            if round > 0 {
                times.push(1e3 * begun.elapsed().as_secs_f64() / lanes as f64);
            }
        }
    }
    let [perfect_ms, built_ms, with_friction_ms] = times.map(|mut times| {
        times.sort_by(f64::total_cmp);
        times[times.len() / 2]
    });
    let (ratio, ratio_with_friction) = (built_ms / perfect_ms, with_friction_ms / perfect_ms);
    Ok(Built { perfect_ms, built_ms, with_friction_ms, ratio, ratio_with_friction, rounds: ROUNDS })
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
        let method = method(&design, &comparison.plan);
        note(common, &method.words());
        let impact = impact(&design, &comparison.plan);
        let sample = comparison.subject.sample();
        let width = self.lanes.unwrap_or_else(Width::widest);
        let lanes = width.lanes();
        let batch: Vec<Sample<2>> = vec![sample.clone(); lanes];
        let group = || {
            simulate_batch_timed(&batch, &impact, width, context()).map_err(|error| Failure::input(error.to_string()))
        };

        // The first run warms caches and clocks; the best of three is what the machine can do.
        let (one, (_, phases)) = best(group)?;
        let one = one / lanes as f64;
        let threads = rayon::current_num_threads();
        let all =
            best(|| (0..threads).into_par_iter().map(|_| group()).collect::<Result<Vec<_>, _>>())?.0 / lanes as f64;
        let (alone, record) =
            best(|| simulate(&sample, &impact, context()).map_err(|error| Failure::input(error.to_string())))?;
        let built = if self.built { Some(measure_built(&sample, &impact, width)?) } else { None };
        if context().stopped() {
            return Err(Failure::Interrupted("nothing was measured to the end".to_owned()));
        }
        let steps = steps_in(impact.window, impact.step);
        let arrangements = comparison.len();
        let figures = Figures {
            format: granulens::outcome::FORMAT,
            design: design.name.clone(),
            spheres: sample.spheres.len(),
            method,
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
            built,
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
    let built = f.built.as_ref().map_or(String::new(), |built| {
        format!(
            "| one design of a batch, perfect, in turn with the next | {:.1} ms |\n| as built: radii 0.1 %, 1 % wrong spheres | {:.1} ms, {:.2} times |\n\
             | the same with friction {FRICTION} | {:.1} ms, {:.2} times |\n",
            built.perfect_ms, built.built_ms, built.ratio, built.with_friction_ms, built.ratio_with_friction
        )
    });
    let mut text = format!(
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
        f.method.step_s,
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
    );
    text += &built;
    text
}
