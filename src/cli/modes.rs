//! `granulens modes`: small vibrations of a rig, and what they let through.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use granulens::dem::rig::Modes as NormalModes;
use granulens::dem::{MoveIn, Spheres};
use granulens::report;
use granulens::setup::{PreparedRig, Setup};
use serde_json::json;

use super::Common;
use super::console::{emit, emit_json, note};
use super::failure::Failure;
use super::folder::{probe, write_file};
use super::picture::{KINDS, ends_in, write_picture};

/// Normal modes of a rig as it stands before it is struck, and its transmission over frequency
///
/// The contacts must carry forces: squeeze the crystal with the section [preload]. Small vibrations about that state; normal forces
/// alone. Transmission is how far the last layer moves along the wave over how far the first does, while a force drives the first.
/// With --out, frequency and transmission as a picture (.svg) or as CSV (.csv).
#[derive(clap::Args)]
pub struct Modes {
    /// Rig file
    file: PathBuf,
    /// Loss factor of the stiffness, by which resonances are bounded
    #[arg(long, default_value_t = 0.002, value_name = "NUMBER", value_parser = loss)]
    loss: f64,
    /// Frequencies at which transmission is given, from zero to a little above the highest mode
    #[arg(long, default_value_t = 400, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=1_000_000))]
    points: u32,
}

fn loss(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(loss) if loss > 0.0 && loss < 1.0 => Ok(loss),
        _ => Err("must be a number between 0 and 1".to_owned()),
    }
}

/// What --out asks for.
#[derive(Clone, Copy)]
enum Kind {
    Picture,
    Table,
}

impl Kind {
    fn of(path: &Path) -> Result<Self, Failure> {
        match () {
            () if KINDS.iter().any(|kind| ends_in(path, kind)) => Ok(Self::Picture),
            () if ends_in(path, "csv") => Ok(Self::Table),
            _ => Err(Failure::input_with_help(
                format!("--out {}: is neither a picture nor a table", path.display()),
                "Let the name end in .svg, .pdf, .png or .csv.",
            )),
        }
    }
}

/// Modes that are listed in words.
const LISTED: usize = 12;

impl Modes {
    pub fn run(self, common: &Common) -> Result<(), Failure> {
        match Setup::read_seeded(&self.file, common.seed)? {
            Setup::One(prepared) => self.prepared(&prepared, common),
            Setup::Two(prepared) => self.prepared(&prepared, common),
            Setup::Three(prepared) => self.prepared(&prepared, common),
        }
    }

    fn prepared<const D: usize>(&self, prepared: &PreparedRig<D>, common: &Common) -> Result<(), Failure>
    where
        Spheres: MoveIn<D>,
    {
        let out = match &common.out {
            Some(path) => Some((path, Kind::of(path)?)),
            None => None,
        };
        probe(common, common.out.as_ref())?;
        prepared.plan.warnings.iter().for_each(|warning| note(common, &format!("warning: {warning}")));
        if let Some(preload) = &prepared.preload {
            note(common, &preload.to_string());
        }
        let blame = |message: String, help: &str| {
            Failure::input_with_help(format!("{}: {message}", prepared.path.display()), help)
        };
        let simulation = prepared
            .simulation()
            .map_err(|error| blame(error.words(&|body| prepared.name_of(body)), "Change the rig file."))?;
        let modes = NormalModes::of(&simulation).map_err(|error| blame(error.to_string(), "Leave it out."))?;
        let highest = modes.frequencies().last().copied().unwrap_or(0.0);
        if highest == 0.0 {
            let help = "Squeeze the crystal: [preload] with strain or force, and sides that hold it.";
            return Err(blame("no contact answers to a small displacement".to_owned(), help));
        }
        let layer = |wanted: u32| -> Vec<usize> {
            (0..prepared.sites.len())
                .filter(|&i| prepared.sites[i].layer == wanted && !prepared.rig.held[i][D - 1])
                .collect()
        };
        let free = |mut layers: Box<dyn Iterator<Item = u32>>| {
            layers.find(|&l| !layer(l).is_empty()).map(layer).unwrap_or_default()
        };
        let (first, last) = (free(Box::new(1..=prepared.layers)), free(Box::new((1..=prepared.layers).rev())));
        let over: Vec<f64> = (1..=self.points).map(|k| 1.2 * highest * f64::from(k) / f64::from(self.points)).collect();
        let transmission = modes.transmission(D - 1, [&first, &last], &over, self.loss);
        if let Some((path, kind)) = out {
            match kind {
                Kind::Picture => {
                    let picture = report::transmission(&prepared.name, &over, &transmission, &modes.frequencies());
                    write_picture(common, path, &picture)?;
                }
                Kind::Table => {
                    let rows =
                        over.iter().zip(&transmission).map(|(frequency, part)| format!("{frequency:?},{part:?}\n"));
                    let text: String = std::iter::once("frequency_Hz,transmission\n".to_owned()).chain(rows).collect();
                    write_file(common, path, &text)?;
                }
            }
            note(common, &format!("transmission: {}", path.display()));
        }
        let frequencies = modes.frequencies();
        let unstable = modes.squared.iter().filter(|&&squared| squared < -1e-6 * highest * highest).count();
        if unstable > 0 {
            note(common, &format!("warning: {unstable} modes grow instead of vibrating: the state is no stable one"));
        }
        if common.json {
            emit_json(&json!({
                "format": granulens::outcome::FORMAT,
                "name": prepared.name,
                "freedoms": modes.freedoms.len(),
                "frequencies_Hz": frequencies,
                "unstable": unstable,
                "loss": self.loss,
                "over_Hz": over,
                "transmission": transmission,
            }));
            return Ok(());
        }
        let mut text = format!(
            "{}: {} modes, up to {:.1} Hz\n\n| mode | frequency (Hz) |\n|---|---|\n",
            prepared.name,
            frequencies.len(),
            highest
        );
        for (k, frequency) in frequencies.iter().enumerate().take(LISTED) {
            let _ = writeln!(text, "| {} | {frequency:.2} |", k + 1);
        }
        let gaps = gaps(&frequencies);
        if !gaps.is_empty() {
            text += "\n| no mode from (Hz) | to (Hz) |\n|---|---|\n";
            for [from, to] in gaps {
                let _ = writeln!(text, "| {from:.1} | {to:.1} |");
            }
        }
        emit(&text);
        Ok(())
    }
}

/// Gaps between neighbouring frequencies that are wider than a tenth of all, and than five times the mean distance.
fn gaps(frequencies: &[f64]) -> Vec<[f64; 2]> {
    let highest = frequencies.last().copied().unwrap_or(0.0);
    let mean = highest / frequencies.len().max(1) as f64;
    let wide = |pair: &&[f64]| pair[1] - pair[0] > (0.1 * highest).max(5.0 * mean) && pair[0] > 0.0;
    frequencies.windows(2).filter(wide).map(|pair| [pair[0], pair[1]]).collect()
}
