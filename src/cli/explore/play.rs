//! The wave as it runs: frames of a layout, and of a baseline beside it, by the rig that `granulens simulate` sets up of a design.

use granulens::dem::rig::{Arrival, Gain, RigStop, Simulation};
use granulens::design::Design;
use granulens::layout::Layout;
use granulens::setup::{PreparedRig, Setup};
use serde::Deserialize;
use serde_json::{Value, json};

use super::desk::read;
use super::scene::{Painted, comparison};
use super::server::{Answer, Shared};
use super::work::Job;
use crate::cli::failure::Failure;

/// What a frame holds of each sphere: speed (m/s), kinetic energy (J), net contact force (N), dissipated so far (J); in this order, so
/// many of each.
const CHANNELS: usize = 4;

/// Most numbers of a run (4 bytes each).
const MOST: usize = 16_000_000;

#[derive(Deserialize)]
pub struct Asked {
    text: String,
    #[serde(default)]
    layout: Option<Painted>,
    /// Name of a baseline to be shown beside.
    #[serde(default)]
    beside: Option<String>,
    frames: usize,
    tab: String,
}

/// One run, frame by frame.
struct Run {
    name: String,
    materials: Vec<u8>,
    frames: Vec<f32>,
    times: Vec<f64>,
    ledger: Vec<Value>,
    arrival: Vec<Option<f64>>,
    speed: Vec<f64>,
    force: Vec<f64>,
    gains: Vec<Gain>,
    stop: Option<String>,
}

/// A header as JSON, its length before it (4 bytes, little-endian), filled up to a multiple of four; then the frames, run by run, as
/// little-endian 32-bit numbers.
pub fn play(asked: &Asked, shared: &Shared) -> Result<Answer, Failure> {
    let job = shared.work.begin(&asked.tab, "play");
    let design = read(&asked.text, shared)?;
    let comparison = comparison(&design, asked.layout.as_ref())?;
    let mut layouts = vec![(comparison.name.clone(), comparison.subject.clone())];
    if let Some(name) = &asked.beside {
        let found =
            comparison.arrangement(name).ok_or_else(|| Failure::input(format!("there is no baseline {name}")))?;
        layouts.push((name.clone(), found));
    }
    let frames = asked.frames.clamp(2, 600);
    let numbers = layouts.len() * (frames + 1) * design.lattice.len() * CHANNELS;
    if numbers > MOST {
        return Err(Failure::input_with_help(
            format!("{frames} frames of {} spheres are more than a page holds", design.lattice.len()),
            "Choose fewer frames or a smaller crystal, or write them with granulens export --vtp.",
        ));
    }
    let follow = |(name, layout): &(String, Layout)| run(&design, name, layout, frames, &job);
    let runs = match &layouts[..] {
        [one, other] => {
            let (one, other) = rayon::join(|| follow(one), || follow(other));
            vec![one?, other?]
        }
        all => all.iter().map(follow).collect::<Result<_, _>>()?,
    };
    let mut header = json!({
        "channels": CHANNELS,
        "spheres": design.lattice.len(),
        "palette": comparison.subject.palette.iter().map(|material| &material.name).collect::<Vec<_>>(),
        "runs": runs.iter().map(|run| json!({
            "name": run.name, "materials": run.materials, "times_s": run.times, "ledger": run.ledger, "arrival": run.arrival,
            "greatest_speed": run.speed, "greatest_force": run.force, "stop": run.stop,
            "gain_J": run.gains.iter().map(|gain| gain.energy).sum::<f64>(),
        })).collect::<Vec<_>>(),
    })
    .to_string();
    while !header.len().is_multiple_of(4) {
        header.push(' ');
    }
    let mut bytes = (header.len() as u32).to_le_bytes().to_vec();
    bytes.extend(header.into_bytes());
    for run in &runs {
        run.frames.iter().for_each(|number| bytes.extend(number.to_le_bytes()));
    }
    Ok(Answer::file("application/octet-stream", bytes))
}

fn run(design: &Design, name: &str, layout: &Layout, frames: usize, job: &Job) -> Result<Run, Failure> {
    let Setup::Two(PreparedRig { rig, plan, .. }) = Setup::of_layout(design, layout)? else {
        return Err(Failure::input("a design is a sheet"));
    };
    let failed = |error: &dyn std::fmt::Display| Failure::input(format!("{name} cannot be run: {error}"));
    // The convention of records: reached at 1 % of its own greatest speed.
    let simulation = Simulation::new(rig, plan.step).map_err(|error| failed(&error))?;
    let mut simulation = simulation.recording(vec![Arrival::OwnMaximum(0.01)]);
    let steps = plan.steps();
    let mut run = Run {
        name: name.to_owned(),
        materials: layout.materials.clone(),
        frames: Vec::with_capacity((frames + 1) * layout.materials.len() * CHANNELS),
        times: Vec::new(),
        ledger: Vec::new(),
        arrival: Vec::new(),
        speed: Vec::new(),
        force: Vec::new(),
        gains: Vec::new(),
        stop: None,
    };
    take(&simulation, &mut run);
    for frame in 1..=frames {
        let until = steps * frame as u64 / frames as u64;
        match simulation.advance(until.saturating_sub(simulation.steps()), job.context()) {
            Ok(()) => {}
            Err(RigStop::Interrupted { .. }) => {
                return Err(Failure::Interrupted("a newer run took its place".to_owned()));
            }
            Err(stop) => {
                run.stop = Some(stop.to_string());
                take(&simulation, &mut run);
                break;
            }
        }
        take(&simulation, &mut run);
    }
    run.arrival = simulation.arrivals(0);
    run.speed = simulation.greatest_speed();
    run.force = simulation.greatest_force();
    run.gains = simulation.gains();
    Ok(run)
}

/// Adds the present state as a frame.
fn take(simulation: &Simulation<2>, run: &mut Run) {
    let (rig, view) = (simulation.rig(), simulation.view());
    let spheres = rig.sample.spheres.len();
    let speed = |k: usize| view.velocity(k).iter().map(|v| v * v).sum::<f64>().sqrt();
    let kinetic = |k: usize| 0.5 * rig.mass[k] * speed(k) * speed(k);
    let frame = &mut run.frames;
    frame.extend((0..spheres).map(|k| speed(k) as f32));
    frame.extend((0..spheres).map(|k| kinetic(k) as f32));
    frame.extend((0..spheres).map(|k| view.net_force_size(k) as f32));
    frame.extend(simulation.dissipated().into_iter().map(|lost| lost as f32));
    run.times.push(simulation.time());
    run.ledger.push(json!(simulation.ledger()));
}
