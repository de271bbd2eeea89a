//! Many impacts: each run is kept as it finishes, so that a command given again goes on where the last one stopped.

use std::path::{Path, PathBuf};

use granulens::bed::{
    Bed, BedFile, Case, Cell, Ensemble, Measures, Origin, Outcome, Pile, measure, scaling, strike, summarise,
};
use granulens::dem::rig::RigStop;
use granulens::output;
use granulens::report::{Provenance, draw_ensemble, ensemble_page};
use granulens::stats::Mean;
use rayon::prelude::*;
use serde_json::json;

use super::super::Common;
use super::super::console::{Count, context, emit, emit_json, note, pretty};
use super::super::failure::Failure;
use super::super::folder::write_file;
use super::beds::{load, place, pour};
use super::method::BedMethod;

/// A bed of the ensemble at rest, with its seed.
struct Sample {
    seed: Option<u64>,
    bed: Bed,
    measures: Measures,
}

/// Makes all impacts that are not kept yet, and writes tables and figure.
pub fn run(common: &Common, path: &Path, file: &BedFile, ensemble: &Ensemble, fresh: bool) -> Result<(), Failure> {
    let folder = common.out.clone().unwrap_or_else(|| Path::new("reports").join(format!("{}-ensemble", file.name)));
    output::check_known(&folder, &["impacts", "ensemble.json"])?;
    let samples = samples(common, path, file, ensemble, fresh)?;
    let cases = ensemble.cases();
    let missing: Vec<&Case> = cases.iter().filter(|case| kept(&folder, file, &samples, case).is_none()).collect();
    note(common, &format!("{} impacts, {} of them kept from before", cases.len(), cases.len() - missing.len()));
    if missing.is_empty() {
        note(common, "nothing was to be done");
    }
    let bar = Count::new(common, missing.len(), "impacts");
    let made: Vec<Result<(), Failure>> = missing
        .into_par_iter()
        .with_max_len(1)
        .map(|case| {
            let Sample { seed, bed, measures } = &samples[case.sample as usize];
            let course = strike(bed, &case.of(&file.impact), context(), |_| ())
                .map_err(|error| Failure::input(format!("{}: {error}", path.display())))?;
            if matches!(course.stop, Some(RigStop::Interrupted { .. })) {
                return Err(Failure::Interrupted(format!(
                    "the finished impacts are kept in {}; give the command again to go on",
                    folder.display()
                )));
            }
            let outcome = Outcome::new(case, *seed, measures, &course);
            output::keep(&keeping(&folder, file, seed, case), pretty(&outcome).as_bytes())?;
            bar.finished(&format!("{} at {}", case.friction.name(), case.speed));
            Ok(())
        })
        .collect();
    bar.done();
    made.into_iter().collect::<Result<Vec<()>, Failure>>()?;
    let outcomes: Vec<Outcome> = cases.iter().filter_map(|case| kept(&folder, file, &samples, case)).collect();
    if outcomes.len() < cases.len() {
        return Err(Failure::input(format!("{}: impacts that were kept have vanished", folder.display())));
    }
    let cells = summarise(ensemble, &outcomes);
    let mut numbers = json!(BedMethod::of(&file.impact));
    numbers["format"] = json!(granulens::outcome::FORMAT);
    numbers["name"] = json!(file.name);
    numbers["cells"] = json!(cells);
    numbers["impacts"] = json!(outcomes);
    let scaling = scaling(ensemble, &outcomes, &file.impact);
    numbers["scaling"] = json!(scaling);
    write_file(common, &folder.join("ensemble.json"), &pretty(&numbers))?;
    write_file(common, &folder.join("ensemble.csv"), &table(&cells))?;
    write_file(common, &folder.join("impacts.csv"), &rows(&outcomes))?;
    write_file(common, &folder.join("bed.toml"), &file.text)?;
    let picture = draw_ensemble(&file.name, &cells);
    write_file(common, &folder.join("depth.svg"), &picture)?;
    let page = ensemble_page(&file.name, &cells, &scaling, &picture, provenance(file, &samples));
    write_file(common, &folder.join("ensemble.html"), &page)?;
    if common.json {
        emit_json(&numbers);
    } else {
        emit(&words(&cells));
    }
    note(common, &format!("tables and figure: {}", folder.display()));
    let stops: Vec<String> = outcomes.iter().filter_map(|outcome| outcome.stop.clone()).collect();
    if stops.is_empty() { Ok(()) } else { Err(Failure::Guard(stops)) }
}

/// What repeats an ensemble.
fn provenance(file: &BedFile, samples: &[Sample]) -> Provenance {
    let path = file.path.display().to_string();
    let method = BedMethod::of(&file.impact);
    let seeds: Vec<String> = samples.iter().filter_map(|sample| Some(sample.seed?.to_string())).collect();
    Provenance::new(format!("granulens impact {path}"), path, file.text.clone())
        .with("granulens", method.build())
        .with("Method", method.words())
        .with("Random seeds of the beds", if seeds.is_empty() { "none".to_owned() } else { seeds.join(", ") })
}

/// The beds, of successive seeds; those that are not kept settle now, side by side.
fn samples(
    common: &Common,
    path: &Path,
    file: &BedFile,
    ensemble: &Ensemble,
    fresh: bool,
) -> Result<Vec<Sample>, Failure> {
    let sample = |seed, bed: Bed| Sample { seed, measures: measure(&bed), bed };
    let first = match &file.origin {
        Origin::Pile(pile) => *pile,
        Origin::File(_) if ensemble.samples > 1 => {
            return Err(Failure::input(format!(
                "{}: a bed from a file is one sample, and {} are asked for; pour it instead (bed.width, bed.height, bed.seed)",
                path.display(),
                ensemble.samples
            )));
        }
        Origin::File(place) => return Ok(vec![sample(None, load(place)?)]),
    };
    let grains = &file.impact.grains;
    let piles: Vec<Pile> =
        (0..u64::from(ensemble.samples)).map(|k| Pile { seed: first.seed.wrapping_add(k), ..first }).collect();
    let bar = Count::new(common, piles.len(), "beds");
    let beds: Vec<Result<Sample, Failure>> = piles
        .par_iter()
        .with_max_len(1)
        .map(|pile| {
            let kept = place(pile, grains);
            let bed = if kept.exists() && !fresh { load(&kept)? } else { pour(path, pile, grains, context())?.0 };
            bar.finished(&format!("bed of seed {}", pile.seed));
            Ok(sample(Some(pile.seed), bed))
        })
        .collect();
    bar.done();
    beds.into_iter().collect()
}

/// Where the outcome of a case is kept: its name tells it from the same case of another file.
fn keeping(folder: &Path, file: &BedFile, seed: &Option<u64>, case: &Case) -> PathBuf {
    let recipe = format!("{} {:?} {:?} {seed:?}", env!("CARGO_PKG_VERSION"), file.origin, case.of(&file.impact));
    let key = crc32fast::hash(recipe.as_bytes());
    let seed = seed.map_or("file".to_owned(), |seed| seed.to_string());
    folder.join("impacts").join(format!("{}-v{}-seed-{seed}-{key:08x}.json", case.friction.name(), case.speed))
}

/// The outcome of a case, if it is kept whole.
fn kept(folder: &Path, file: &BedFile, samples: &[Sample], case: &Case) -> Option<Outcome> {
    let text = std::fs::read_to_string(keeping(folder, file, &samples[case.sample as usize].seed, case)).ok()?;
    serde_json::from_str(&text).ok()
}

fn number(value: Option<f64>) -> String {
    value.map_or(String::new(), |value| format!("{value:?}"))
}

fn table(cells: &[Cell]) -> String {
    let mut text = "friction,speed_d_per_tau_c,samples,stopped".to_owned();
    for name in ["final_depth_d", "max_depth_d", "overshoot_d", "peak_force"] {
        text += &format!(",{name},{name}_deviation,{name}_interval95");
    }
    for cell in cells {
        text += &format!("\n{},{:?},{},{}", cell.friction.name(), cell.speed, cell.samples, cell.stopped);
        for Mean { mean, deviation, interval } in measures(cell) {
            text += &format!(",{mean:?},{},{}", number(deviation), number(interval));
        }
    }
    text + "\n"
}

fn measures(cell: &Cell) -> [Mean; 4] {
    [cell.final_depth_d, cell.max_depth_d, cell.overshoot_d, cell.peak_force]
}

fn rows(outcomes: &[Outcome]) -> String {
    let mut text =
        "friction,speed_d_per_tau_c,seed,volume_fraction,coordination,final_depth_d,max_depth_d,overshoot_d,\
                    peak_force,peak_force_time_tau_c,stop\n"
            .to_owned();
    for o in outcomes {
        text += &format!(
            "{},{:?},{},{:?},{:?},{:?},{:?},{:?},{:?},{:?},{}\n",
            o.friction.name(),
            o.speed,
            o.seed.map_or(String::new(), |seed| seed.to_string()),
            o.volume_fraction,
            o.coordination,
            o.final_depth_d,
            o.max_depth_d,
            o.overshoot_d,
            o.peak_force,
            o.peak_force_time_tau_c,
            o.stop.as_deref().unwrap_or("").replace(',', ";")
        );
    }
    text
}

fn words(cells: &[Cell]) -> String {
    let of = |Mean { mean, deviation, interval }: Mean| match (deviation, interval) {
        (Some(deviation), Some(interval)) => format!("{mean:.2} +- {interval:.2} ({deviation:.2})"),
        _ => format!("{mean:.2}"),
    };
    let mut text = "mean +- half the 95 % interval of the mean (standard deviation of single impacts)\n\n\
                    | friction | speed (d/tau_c) | impacts | depth at the end (d) | greatest depth (d) | overshoot (d) | \
                    greatest force (m d/tau_c^2) |\n|---|---|---|---|---|---|---|\n"
        .to_owned();
    for cell in cells {
        let columns = measures(cell).map(of).join(" | ");
        text += &format!("| {} | {} | {} | {columns} |\n", cell.friction.name(), cell.speed, cell.samples);
    }
    text
}
