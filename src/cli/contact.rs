//! `granulens contact`: a contact's curve, its law at given states or speeds, or fitted to what was measured.

mod fit;
mod states;

use std::path::PathBuf;

use granulens::contact::{AnyLaw, Constants, LawKind, Pair, collide};
use granulens::design::Shelf;
use granulens::report::ContactCurve;
use granulens::units::Dimension::{self, Force, Length};
use serde_json::json;

use super::console::{emit, emit_json, note};
use super::failure::Failure;
use super::folder::{write_file, write_json};
use super::picture::{KINDS, Paper, ends_in, write_picture};
use super::tuning::Tuned;
use super::{Common, length};
use states::States;

/// Draw a contact's force-displacement curve, evaluate the law at given states or speeds, or fit it to what was measured
///
/// The curve, with its regions and an unloading, goes to the file of --out as SVG, PDF or CSV. With --states, the forces and the histories
/// after a step go to stdout as CSV, or to the file of --out; so does, with --speeds, what head-on collisions come to. With --fit, the
/// constants with their intervals.
#[derive(clap::Args)]
pub struct Contact {
    /// The two materials, such as 440c,brass
    #[arg(long, value_name = "A,B")]
    pair: String,
    /// File with own materials, [materials.NAME], alone or in a design
    #[arg(long = "materials", value_name = "FILE")]
    own: Option<PathBuf>,
    /// thesis, consistent, mdr, linear, each also without rate as NAME-static; thornton, walton-braun, tsuji, storakers; hertz,
    /// hertz-thesis; thesis if left out
    #[arg(long)]
    law: Option<LawKind>,
    /// Diameter of both spheres, or of each: "6.35 mm,9.5 mm"
    #[arg(long, default_value = "6.35 mm", allow_hyphen_values = true)]
    diameter: String,
    /// Set of fitted constants: code, text, sixteenth-inch or eq-4.7
    #[arg(long, default_value_t = Constants::Code)]
    constants: Constants,
    #[command(flatten)]
    tuned: Tuned,
    #[command(flatten)]
    paper: Paper,
    /// CSV with the columns d,v,dmax,Fmax in SI, v > 0 closing; dmax = Fmax = 0 is a fresh contact
    #[arg(long, value_name = "FILE")]
    states: Option<PathBuf>,
    /// Closing speeds of head-on collisions in m/s, such as 0.1,1,10, or with their unit
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = speed, conflicts_with = "states")]
    speeds: Vec<f64>,
    /// Fit the law to a measurement: CSV with the columns overlap_m,force_N (slow) or speed_m_s,restitution (of closing)
    #[arg(long, value_name = "FILE", conflicts_with_all = ["states", "speeds"])]
    fit: Option<PathBuf>,
}

/// A speed, in m/s where no unit is written.
fn speed(text: &str) -> Result<f64, String> {
    match text.trim().parse() {
        Ok(speed) => Ok(speed),
        Err(_) => Dimension::Speed.parse(text).map_err(|error| error.to_string()),
    }
}

impl Contact {
    fn law(&self) -> LawKind {
        self.law.unwrap_or(LawKind::Thesis)
    }

    pub fn run(self, common: &Common) -> Result<(), Failure> {
        let pair = self.pair()?;
        if self.law.is_none() {
            note(common, "no --law: the published one is taken, thesis; consistent never makes energy");
        }
        let law = AnyLaw::new(self.law(), &pair);
        if let Some(path) = &self.fit {
            let fit = fit::of_file(path, self.law(), &pair)?;
            let json = fit::json(&fit, self.law());
            if common.out.is_some() {
                write_json(common, &json)?;
            }
            if common.json {
                emit_json(&json);
            } else {
                emit(&fit::words(&fit, self.law()));
            }
            return Ok(());
        }
        if let Some(path) = &self.states {
            let states = States::read(path, &law)?;
            return self.tell(common, "states", states.csv(), json!(states.json()));
        }
        if !self.speeds.is_empty() {
            return self.collisions(common, &law, &pair);
        }
        if let Some(path) = &common.out {
            let title = format!("{} ({}, {} constants)", self.pair.replace(',', " on "), self.law(), self.constants);
            let curve = ContactCurve::new(&law, &pair);
            if ends_in(path, "csv") {
                write_file(common, path, &curve.csv())?;
            } else if KINDS.iter().any(|kind| ends_in(path, kind)) {
                write_picture(common, path, &curve.svg(&title, &self.paper.look()))?;
            } else {
                return Err(Failure::input_with_help(
                    format!("--out {}: the curve is drawn as SVG, PDF or PNG, or written as CSV", path.display()),
                    "Let the name end in .svg, .pdf, .png or .csv.",
                ));
            }
            note(common, &format!("curve: {}", path.display()));
        }
        let regions = pair.regions(1.0);
        if common.json {
            emit_json(&json!({
                "format": granulens::outcome::FORMAT,
                "law": self.law().name(),
                "constants": self.constants.name(),
                "effective_modulus_Pa": pair.modulus,
                "effective_radius_m": pair.radius,
                "yield_stress_Pa": pair.yield_stress,
                "rate_constant": pair.rate_constant,
                "yield_overlap_m": regions.yield_overlap,
                "yield_force_N": regions.yield_force,
                "plastic_overlap_m": regions.plastic_overlap,
                "fully_plastic_force_N": regions.plastic_force,
                "plastic_stiffness_N_m": pair.plastic_stiffness(),
                "pressure_ratio_c1": regions.pressure_ratio,
                "area_offset_c2_m2": regions.area_offset,
            }));
        } else {
            emit(&format!(
                "E* {:.4e} Pa, r* {}, yield stress {:.4e} Pa, rate constant {}\n\
                 at rest: yield at {} and {}, fully plastic from {} and {} on, then {:.4e} N/m",
                pair.modulus,
                Length.show(pair.radius),
                pair.yield_stress,
                pair.rate_constant,
                Length.show(regions.yield_overlap),
                Force.show(regions.yield_force),
                Length.show(regions.plastic_overlap),
                Force.show(regions.plastic_force),
                pair.plastic_stiffness()
            ));
            if common.out.is_none() {
                note(common, "draw the curve with --out FILE.svg, evaluate states with --states FILE.csv");
            }
        }
        Ok(())
    }

    /// A table, as CSV or JSON, to stdout or to the file of --out.
    fn tell(&self, common: &Common, what: &str, csv: String, rows: serde_json::Value) -> Result<(), Failure> {
        if let Some(out) = &common.out {
            write_file(common, out, &csv)?;
        }
        match (common.json, &common.out) {
            (true, _) => {
                emit_json(&json!({ "format": granulens::outcome::FORMAT, "law": self.law().name(), (what): rows }));
            }
            (false, None) => emit(&csv),
            (false, Some(out)) => note(common, &format!("{what}: {}", out.display())),
        }
        Ok(())
    }

    /// Head-on collisions at the speeds asked for.
    fn collisions(&self, common: &Common, law: &AnyLaw, pair: &Pair) -> Result<(), Failure> {
        let mut csv = String::from("speed_m_s,restitution,force_max_N,overlap_max_m,duration_s\n");
        let mut rows = Vec::new();
        for &speed in &self.speeds {
            if !(speed > 0.0 && speed.is_finite()) {
                return Err(Failure::input(format!("--speeds: {speed} must be a positive speed in m/s")));
            }
            let found = collide(law, pair.reduced_mass, speed);
            csv += &format!(
                "{speed},{:.6},{:.6e},{:.6e},{:.6e}\n",
                found.restitution, found.force_max, found.overlap_max, found.duration
            );
            rows.push(json!({
                "speed_m_s": speed, "restitution": found.restitution, "force_max_N": found.force_max,
                "overlap_max_m": found.overlap_max, "duration_s": found.duration,
            }));
        }
        self.tell(common, "collisions", csv, json!(rows))
    }

    fn pair(&self) -> Result<Pair, Failure> {
        let names: Vec<&str> = self.pair.split(',').map(str::trim).collect();
        let [a, b] = names.as_slice() else {
            return Err(Failure::input(format!(
                "--pair \"{}\": expected two materials, such as 440c,brass",
                self.pair
            )));
        };
        let parse = |text: &str| length(text).map_err(|error| Failure::input(format!("--diameter: {error}")));
        let diameters: Vec<f64> = self.diameter.split(',').map(|text| parse(text.trim())).collect::<Result<_, _>>()?;
        let radii = match diameters.as_slice() {
            [both] => [0.5 * both; 2],
            [one, two] => [0.5 * one, 0.5 * two],
            more => {
                return Err(Failure::input(format!("--diameter names {} spheres, expected one or two", more.len())));
            }
        };
        let constants = Constants { tuning: self.tuned.tuning()?, ..self.constants };
        let shelf = self.own.as_ref().map(Shelf::read).transpose()?.unwrap_or_default();
        Ok(Pair::new([&shelf.find(a)?, &shelf.find(b)?], radii, constants))
    }
}
