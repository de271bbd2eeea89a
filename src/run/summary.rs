//! What a run came to.

use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::tables::threshold_name;
use super::{Ending, RunError, SUMMARY, events, series};
use crate::dem::rig::{EnergyLedger, Gain, Simulation};
use crate::evaluate::gain_words;
use crate::outcome::Method;
use crate::setup::{Intruder, PreparedRig};

/// The format of `run.json`.
const FORMAT: u32 = 1;

/// A run in numbers; everything else is in the files beside it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// 1
    pub format: u32,
    /// Name of the rig.
    pub name: String,
    /// The file, as it was named.
    #[serde(default)]
    pub file: String,
    /// With what, and how.
    #[serde(flatten)]
    pub method: Method,
    /// 1, 2 or 3
    pub dimension: usize,
    /// Number of spheres.
    pub spheres: usize,
    /// Number of layers.
    pub layers: u32,
    /// Distance of neighbouring sites (m).
    pub diameter_m: f64,
    /// Seeds of what was drawn by chance, in the order of the rig file; with `--seed` they are not those that it names.
    #[serde(default)]
    pub seeds: Vec<u64>,
    /// Steps between two samples.
    pub every: u64,
    /// Time reached (s).
    pub time_s: f64,
    /// Steps done.
    pub steps: u64,
    /// Whether the run came to its end, by the window or by a guard.
    pub finished: bool,
    /// The guard that stopped it, in words.
    pub stop: Option<String>,
    /// What a reader should know before trusting the numbers.
    pub warnings: Vec<String>,
    /// Where the energy is and went (J).
    pub energies: EnergyLedger,
    /// What the ledger does not account for, relative.
    pub residual: Option<f64>,
    /// What contacts gave back beyond what was put into them, by law; beyond the ledger's tolerance there is a warning.
    #[serde(default)]
    pub gains: Vec<Gain>,
    /// Greatest speed of any sphere (m/s).
    pub max_speed_m_s: f64,
    /// Flats with what they felt.
    pub flats: Vec<BodySummary>,
    /// Intruders with what they felt.
    #[serde(default)]
    pub intruders: Vec<BodySummary>,
    /// Spheres with a series over time.
    pub recorded: Vec<Recorded>,
    /// How many events of each kind are in `events.csv`.
    #[serde(default)]
    pub events: BTreeMap<String, u64>,
    /// Columns of first arrivals in `spheres-final.csv`.
    pub arrivals: Vec<String>,
    /// What is drawn.
    pub pictures: Vec<String>,
}

impl Summary {
    /// The ledger (J) by name: what did not take part is not listed; what was put in and what is left over always are.
    pub fn energy_rows(&self) -> Vec<(&'static str, f64)> {
        let ledger = &self.energies;
        let mut rows = vec![
            ("put in", ledger.work_in),
            ("kinetic", ledger.kinetic),
            ("stored in contacts", ledger.stored),
            ("stored in tangential springs", ledger.tangential_stored),
            ("potential", ledger.potential),
            ("dissipated in contacts", ledger.dissipated),
            ("friction", ledger.friction),
            ("into bars, drag", ledger.absorbed),
            ("left over", ledger.left()),
        ];
        rows.retain(|(name, value)| *value != 0.0 || ["put in", "left over"].contains(name));
        rows
    }
}

/// A flat or an intruder in numbers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BodySummary {
    /// Its name.
    pub name: String,
    /// Its mass (kg); none where it is infinite.
    pub mass_kg: Option<f64>,
    /// Greatest force that pressed on it, of the samples (N); of an intruder the size of the net force.
    pub peak_force_n: f64,
    /// When (s).
    pub peak_time_s: f64,
    /// Velocity at the end (m/s), of a flat along its normal, of an intruder along the wave.
    pub velocity_m_s: f64,
}

/// A sphere with a series over time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Recorded {
    /// From 1.
    pub sphere: usize,
    /// From 1.
    pub layer: u32,
    /// From 1.
    pub column: u32,
}

/// What a run has come to, in few numbers.
pub(super) struct Reached {
    pub time: f64,
    pub steps: u64,
    pub ledger: EnergyLedger,
    pub max_speed: f64,
}

impl Summary {
    /// Of a crystal without flats and other bodies.
    pub(super) fn of<const D: usize>(prepared: &PreparedRig<D>, reached: &Reached, ending: &Ending) -> Self {
        Self {
            time_s: reached.time,
            steps: reached.steps,
            finished: !matches!(ending, Ending::Interrupted { .. }),
            stop: match ending {
                Ending::Stopped(stop) => Some(stop.words("s", &|body| prepared.name_of(body))),
                _ => None,
            },
            energies: reached.ledger,
            residual: reached.ledger.residual(),
            max_speed_m_s: reached.max_speed,
            ..Self::beginning(prepared)
        }
    }

    /// Of a run that has only begun.
    pub(super) fn beginning<const D: usize>(prepared: &PreparedRig<D>) -> Self {
        let recorded =
            |&i: &usize| Recorded { sphere: i + 1, layer: prepared.sites[i].layer, column: prepared.sites[i].column };
        Self {
            format: FORMAT,
            name: prepared.name.clone(),
            file: prepared.path.display().to_string(),
            method: prepared.method(),
            dimension: D,
            spheres: prepared.sites.len(),
            layers: prepared.layers,
            diameter_m: prepared.diameter,
            seeds: prepared.seeds.clone(),
            every: prepared.record.every,
            time_s: 0.0,
            steps: 0,
            finished: false,
            stop: None,
            warnings: prepared.plan.warnings.clone(),
            energies: EnergyLedger::default(),
            residual: None,
            gains: Vec::new(),
            max_speed_m_s: 0.0,
            flats: Vec::new(),
            intruders: Vec::new(),
            recorded: prepared.record.spheres.iter().map(recorded).collect(),
            events: BTreeMap::new(),
            arrivals: prepared.record.arrivals.iter().map(|&a| format!("arrival_{}_s", threshold_name(a))).collect(),
            pictures: prepared.record.pictures.iter().map(|picture| picture.name().to_owned()).collect(),
        }
    }

    pub(super) fn new<const D: usize>(
        prepared: &PreparedRig<D>,
        simulation: &Simulation<D>,
        ending: &Ending,
        folder: &Path,
    ) -> Result<Self, RunError> {
        let ledger = simulation.ledger();
        let gains = simulation.gains();
        let mut warnings = prepared.plan.warnings.clone();
        warnings.extend(gains.iter().filter_map(|gain| gain_words(gain, ledger.at_hand, prepared.rig.residual_limit)));
        let mut flats = Vec::new();
        if !prepared.rig.flats.is_empty() {
            // Of the samples, a line at a time: time, then three columns for each flat.
            let mut peaks = vec![[f64::NEG_INFINITY, 0.0, 0.0]; prepared.rig.flats.len()];
            series::scan(&folder.join("flats.csv"), |values| {
                for (peak, state) in peaks.iter_mut().zip(values[1..].chunks_exact(3)) {
                    if state[2] > peak[0] {
                        (peak[0], peak[1]) = (state[2], values[0]);
                    }
                    peak[2] = state[1];
                }
            })?;
            flats.extend(prepared.rig.flats.iter().zip(peaks).map(|(flat, [force, time, velocity])| BodySummary {
                name: flat.name.clone(),
                mass_kg: Some(flat.mass).filter(|mass| mass.is_finite()),
                peak_force_n: force,
                peak_time_s: time,
                velocity_m_s: velocity,
            }));
        }
        let mut intruders = Vec::new();
        if !prepared.intruders.is_empty() {
            let mut peaks = vec![[0.0_f64; 3]; prepared.intruders.len()];
            series::scan(&folder.join("intruders.csv"), |values| {
                let mut rest = &values[1..];
                for (peak, intruder) in peaks.iter_mut().zip(&prepared.intruders) {
                    let (state, others) =
                        rest.split_at((3 * D + usize::from(intruder.cluster.is_some())).min(rest.len()));
                    rest = others;
                    let force = state[2 * D..3 * D].iter().map(|f| f * f).sum::<f64>().sqrt();
                    if force > peak[0] {
                        (peak[0], peak[1]) = (force, values[0]);
                    }
                    peak[2] = state[2 * D - 1];
                }
            })?;
            let of = |(intruder, [force, time, velocity]): (&Intruder, [f64; 3])| BodySummary {
                name: intruder.name.clone(),
                mass_kg: Some(intruder.mass),
                peak_force_n: force,
                peak_time_s: time,
                velocity_m_s: velocity,
            };
            intruders.extend(prepared.intruders.iter().zip(peaks).map(of));
        }
        let mut counts: BTreeMap<String, u64> =
            prepared.record.events.iter().map(|event| (event.name().to_owned(), 0)).collect();
        if !counts.is_empty() {
            series::lines(&folder.join(events::FILE), |line| {
                if let Some(count) = line.split(',').nth(1).and_then(|name| counts.get_mut(name)) {
                    *count += 1;
                }
            })?;
        }
        let reached = Reached {
            time: simulation.time(),
            steps: simulation.steps(),
            ledger,
            max_speed: simulation.greatest_speed().into_iter().take(prepared.sites.len()).fold(0.0, f64::max),
        };
        Ok(Self { gains, warnings, flats, intruders, events: counts, ..Self::of(prepared, &reached, ending) })
    }

    /// That of the run in a folder.
    ///
    /// # Errors
    /// A file that cannot be read, or is none of these.
    pub fn read(folder: &Path) -> Result<Self, RunError> {
        let path = folder.join(SUMMARY);
        let fail = |error| RunError::File { path: path.clone(), error };
        let text = std::fs::read_to_string(&path).map_err(fail)?;
        serde_json::from_str(&text).map_err(|error| fail(error.into()))
    }

    /// As the text of `run.json`.
    pub fn json(&self) -> String {
        // Its keys are text and what is not finite becomes null: this cannot fail.
        serde_json::to_string_pretty(self).unwrap_or_default() + "\n"
    }
}
