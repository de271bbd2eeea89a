//! `granulens impact`: an intruder strikes a granular bed.
//!
//! - `beds`: beds at rest, kept and used again
//! - `ensemble`: many impacts, and what they come to on average
//! - `record`: impacts whose frames are kept
//! - `cost`: how long they would take
//! - `method`: with what, and how

mod beds;
mod cost;
mod ensemble;
mod method;
mod record;

use std::path::{Path, PathBuf};
use std::time::Instant;

use granulens::bed::{
    Bed, BedFile, Course, Drag, Ensemble, Moment, Origin, Rubbing, listen, measure, stop_words, strike,
};
use granulens::dem::rig::RigStop;
use granulens::output::Folder;
use granulens::report::{BedPictures, BedRecord, Provenance, draw_bed};
use serde::Serialize;

use super::Common;
use super::console::{Steps, context, emit, emit_json, note, pretty};
use super::failure::Failure;
use super::folder::begin;
use beds::{load, place, pour};
use method::BedMethod;
use record::Recording;

/// Strike a granular bed with an intruder: depth, forces, energies
///
/// The bed is poured and settles first, or comes from a file; settled beds are kept in reports/beds and used again. The output
/// folder, reports/NAME unless --out names another, appears when it is complete.
///
/// With --samples, or a section [ensemble] in the file, beds of several seeds are struck at each of the speeds and with each kind
/// of friction, and means with their 95 % intervals are given. Runs are kept as they finish: run again to go on after a stop.
///
/// With record.every in the file, every grain and contact is kept at these times, as OUT/frames/000012-grains.csv and
/// 000012-contacts.csv, which network, motion and export read. Stopped, such an impact goes on when it is given again.
#[derive(clap::Args)]
pub struct Impact {
    /// Bed file, such as designs/bed.toml
    bed: PathBuf,
    /// Speed of the intruder, in place of the file's
    #[arg(long, value_name = "D_PER_TAU")]
    speed: Option<f64>,
    /// Let the bed settle anew, even if a settled one is kept
    #[arg(long)]
    fresh: bool,
    /// Measure the speed of sound in the bed too
    #[arg(long, conflicts_with = "samples")]
    sound: bool,
    /// Strike so many beds, of successive seeds, in place of the number in the file
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    samples: Option<u32>,
}

/// What --json prints; lengths in mean diameters, times in collision times, forces in m d/tau_c^2.
#[derive(Serialize)]
struct Numbers<'a> {
    format: u32,
    name: &'a str,
    #[serde(flatten)]
    method: BedMethod,
    seed: Option<u64>,
    speed: f64,
    grains: usize,
    volume_fraction: f64,
    coordination: f64,
    surface_d: f64,
    true_restitution: f64,
    sound_speed: Option<f64>,
    final_depth_d: f64,
    final_swing_d: f64,
    max_depth_d: f64,
    overshoot_d: f64,
    peak_force: f64,
    peak_force_time_tau_c: f64,
    time_tau_c: f64,
    work_in: f64,
    lost_in_contacts: f64,
    lost_by_friction: f64,
    drag: Option<Drag>,
    residual: Option<f64>,
    seconds: f64,
    settled_in_seconds: Option<f64>,
    stop: Option<String>,
}

impl Impact {
    pub fn run(self, common: &Common) -> Result<(), Failure> {
        let mut file = BedFile::read(&self.bed)?;
        if let Some(speed) = self.speed {
            if !(0.0..=10.0).contains(&speed) {
                return Err(Failure::input(format!("--speed = {speed} must lie from 0 to 10")));
            }
            file.impact.intruder.speed = speed;
        }
        if let (Some(seed), Origin::Pile(pile)) = (common.seed, &mut file.origin) {
            pile.seed = seed;
        }
        note(common, &BedMethod::of(&file.impact).words());
        if common.dry_run {
            return cost::of(common, &file, self.ensemble(&file).as_ref(), self.fresh);
        }
        if let Some(ensemble) = self.ensemble(&file) {
            if file.record.is_some() {
                return Err(Failure::input_with_help(
                    format!("{}: [record] is for single impacts, and many are asked for", self.bed.display()),
                    "Leave the section out, or strike one bed at one speed.",
                ));
            }
            return ensemble::run(common, &self.bed, &file, &ensemble, self.fresh);
        }
        let place = common.out.clone().unwrap_or_else(|| Path::new("reports").join(&file.name));
        let folder = begin(common, &place)?;
        let (bed, settled_in) = self.prepare(common, &file)?;
        let measures = measure(&bed);
        let grains = &file.impact.grains;
        let heard = match self.sound {
            true => Some(listen(&bed, grains, context()).map_err(|error| Failure::input(error.to_string()))?),
            false => None,
        };
        let begun = Instant::now();
        let bar = Steps::new(common, file.impact.window, "tau_c");
        let told = |moment: &Moment| bar.at(moment.time, &format!("depth {:.2} d", moment.depth));
        let recording = file.record.map(|plan| (plan, Recording::beside(&place)));
        let course = match &recording {
            Some((plan, recording)) => recording.strike(common, &bed, &file, *plan, told)?,
            None => strike(&bed, &file.impact, context(), told)
                .map_err(|error| Failure::input(format!("{}: {error}", self.bed.display())))?,
        };
        bar.done();
        let seconds = begun.elapsed().as_secs_f64();
        let record =
            BedRecord { impact: &file.impact, bed: &bed, measures: &measures, sound: heard.as_ref(), course: &course };
        let numbers = numbers(&file, &record, [Some(seconds), settled_in]);
        if let Some((_, recording)) = recording {
            recording.finish(folder.path())?;
        }
        write(&file, &record, &numbers, folder)?;
        if common.json {
            emit_json(&numbers);
        } else {
            emit(&words(&numbers));
        }
        note(common, &format!("report: {}", place.join("impact.html").display()));
        match course.stop {
            Some(stop @ RigStop::Interrupted { .. }) => {
                Err(Failure::Interrupted(format!("{}; what was followed is in {}", stop_words(&stop), place.display())))
            }
            Some(stop) => Err(Failure::Guard(vec![stop_words(&stop)])),
            None => Ok(()),
        }
    }

    /// Many impacts, if the file or the command asks for them; a speed of the command is the only one.
    fn ensemble(&self, file: &BedFile) -> Option<Ensemble> {
        let speeds = vec![file.impact.intruder.speed];
        let mut ensemble = match (&file.ensemble, self.samples) {
            (Some(ensemble), _) => ensemble.clone(),
            (None, Some(samples)) => Ensemble { samples, speeds: speeds.clone(), friction: vec![Rubbing::AsGiven] },
            (None, None) => return None,
        };
        ensemble.samples = self.samples.unwrap_or(ensemble.samples);
        if self.speed.is_some() {
            ensemble.speeds = speeds;
        }
        Some(ensemble)
    }

    /// The bed at rest: from its file, from an earlier run, or settled now, with the seconds that took.
    fn prepare(&self, common: &Common, file: &BedFile) -> Result<(Bed, Option<f64>), Failure> {
        let pile = match &file.origin {
            Origin::File(path) => return Ok((load(path)?, None)),
            Origin::Pile(pile) => pile,
        };
        let path = place(pile, &file.impact.grains);
        if path.exists() && !self.fresh {
            note(common, &format!("bed: {} (settled before)", path.display()));
            return Ok((load(&path)?, None));
        }
        note(common, "the bed settles, once: 6000 grains in some ten seconds, 90 000 in some minutes");
        let bar = Steps::unbounded(common);
        let bed = pour(&self.bed, pile, &file.impact.grains, &bar.context());
        bar.done();
        let (bed, seconds) = bed?;
        note(common, &format!("bed: {} (settled in {seconds:.0} s)", path.display()));
        Ok((bed, Some(seconds)))
    }
}

/// Fills the folder and puts it in its place.
fn write(file: &BedFile, record: &BedRecord<'_>, numbers: &Numbers, folder: Folder) -> Result<(), Failure> {
    let save = |name: &str, text: &str| folder.write(name, text.as_bytes());
    save("impact.json", &pretty(numbers))?;
    save("bed.toml", &file.text)?;
    save("impact.csv", &moments(record.course))?;
    save("pair-correlation.csv", &pairs("r_d,g", &record.measures.pair_correlation))?;
    if let Some(sound) = record.sound {
        save("sound.csv", &pairs("time_tau_c,force_change", &sound.bottom))?;
    }
    save("grains.csv", &grains(record))?;
    let BedPictures { pictures, page } = draw_bed(&file.name, record, &words(numbers), provenance(file));
    for (name, svg) in &pictures {
        save(name, svg)?;
    }
    save("impact.html", &page)?;
    Ok(folder.finish()?)
}

/// What repeats an impact.
fn provenance(file: &BedFile) -> Provenance {
    let path = file.path.display().to_string();
    let impact = &file.impact;
    let (mut command, mut seeds) =
        (format!("granulens impact {path} --speed {}", impact.intruder.speed), "none".to_owned());
    if let Origin::Pile(pile) = &file.origin {
        command += &format!(" --seed {}", pile.seed);
        seeds = pile.seed.to_string();
    }
    let method = BedMethod::of(impact);
    Provenance::new(command, path, file.text.clone())
        .with("granulens", method.build())
        .with("Method", method.words())
        .with("Random seed", seeds)
}

/// Two columns below their heads.
fn pairs(heads: &str, rows: &[[f64; 2]]) -> String {
    let rows: String = rows.iter().map(|[x, y]| format!("{x:.3},{y:.6e}\n")).collect();
    format!("{heads}\n{rows}")
}

/// Where every grain was and came to, and the greatest force that it felt.
fn grains(record: &BedRecord<'_>) -> String {
    let BedRecord { bed, course, .. } = record;
    let mut text = "x0_d,y0_d,diameter_d,x_d,y_d,greatest_force\n".to_owned();
    for ((disk, [x, y]), force) in bed.grains.iter().zip(&course.grains).zip(&course.grain_force) {
        let [x0, y0] = disk.centre;
        text += &format!("{x0:?},{y0:?},{:?},{x:?},{y:?},{force:.6e}\n", disk.diameter);
    }
    text
}

/// A guard's words; times are in collision times here.
fn numbers<'a>(
    file: &'a BedFile,
    record: &BedRecord<'_>,
    [seconds, settled_in_seconds]: [Option<f64>; 2],
) -> Numbers<'a> {
    let &BedRecord { bed, measures, course, sound, .. } = record;
    let grains = &file.impact.grains;
    let last = &course.moments[course.moments.len() - 1];
    Numbers {
        format: granulens::outcome::FORMAT,
        name: &file.name,
        method: BedMethod::of(&file.impact),
        seed: match &file.origin {
            Origin::Pile(pile) => Some(pile.seed),
            Origin::File(_) => None,
        },
        speed: file.impact.intruder.speed,
        grains: bed.grains.len(),
        volume_fraction: measures.volume_fraction,
        coordination: measures.coordination,
        surface_d: measures.surface,
        true_restitution: grains.true_restitution(grains.dashpot_rate(grains.grains.restitution)),
        sound_speed: sound.map(|sound| sound.speed),
        final_depth_d: course.final_depth,
        final_swing_d: course.final_swing,
        max_depth_d: course.max_depth,
        overshoot_d: course.overshoot(),
        peak_force: course.peak_force[0],
        peak_force_time_tau_c: course.peak_force[1],
        time_tau_c: last.time,
        work_in: last.energy.work_in,
        lost_in_contacts: last.energy.dissipated,
        lost_by_friction: last.energy.friction,
        drag: Drag::of(&course.moments),
        residual: last.energy.residual(),
        seconds: seconds.unwrap_or(0.0),
        settled_in_seconds,
        stop: course.stop.as_ref().map(stop_words),
    }
}

fn words(n: &Numbers) -> String {
    let mut text = format!(
        "bed: {} grains, volume fraction {:.3}, coordination {:.2}, surface at {:.2} d\n\
         restitution of a head-on collision of two mean grains: {:.4}\n",
        n.grains, n.volume_fraction, n.coordination, n.surface_d, n.true_restitution
    );
    if let Some(speed) = n.sound_speed {
        text += &format!("speed of sound: {speed:.2} d/tau_c\n");
    }
    text += &format!(
        "impact at {:.3} d/tau_c, followed for {:.0} tau_c in {:.1} s\n\
         depth: {:.2} d at the end (swings by {:.2} d), {:.2} d at most, overshoot {:.2} d\n\
         greatest force on the intruder: {:.2} m d/tau_c^2 at {:.1} tau_c\n\
         energy: {:.2} in contacts and {:.2} by friction lost of {:.2} m d^2/tau_c^2; {:.1e} of it not accounted for\n",
        n.speed,
        n.time_tau_c,
        n.seconds,
        n.final_depth_d,
        n.final_swing_d,
        n.max_depth_d,
        n.overshoot_d,
        n.peak_force,
        n.peak_force_time_tau_c,
        hundredths(n.lost_in_contacts),
        hundredths(n.lost_by_friction),
        n.work_in,
        n.residual.unwrap_or(0.0)
    );
    text + &n.drag.as_ref().map_or(String::new(), resistance)
}

/// Poncelet's law of the force, and what stopped the intruder.
fn resistance(drag: &Drag) -> String {
    let Drag { constant, per_depth, per_speed_squared, explained, impulse, stopping_time, .. } = drag;
    format!(
        "force by Poncelet's law: ({:.3} +- {:.3}) + ({:.3} +- {:.3}) D + ({:.2} +- {:.2}) u^2, {:.0} % of its variance\n\
         impulse {impulse:.1} m d/tau_c over the {stopping_time:.1} tau_c from touch to stop\n",
        constant.value,
        constant.interval,
        per_depth.value,
        per_depth.interval,
        per_speed_squared.value,
        per_speed_squared.interval,
        100.0 * explained
    )
}

/// Rounded, and nothing that rounding made is a negative zero.
fn hundredths(x: f64) -> f64 {
    (x * 100.0).round() / 100.0 + 0.0
}

fn moments(course: &Course) -> String {
    let mut text =
        "time_tau_c,depth_d,vx,vy,turn,fx,fy,work_in,kinetic,stored,tangential_stored,potential,dissipated,friction\n"
            .to_owned();
    for m in &course.moments {
        let e = &m.energy;
        let row = [
            m.time,
            m.depth,
            m.velocity[0],
            m.velocity[1],
            m.turn,
            m.force[0],
            m.force[1],
            e.work_in,
            e.kinetic,
            e.stored,
            e.tangential_stored,
            e.potential,
            e.dissipated,
            e.friction,
        ];
        text += &(row.map(|x| format!("{x:.9e}")).join(",") + "\n");
    }
    text
}
