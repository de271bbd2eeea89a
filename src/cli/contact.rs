//! `granulens contact`: a contact's curve, or its law at given states.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use granulens::contact::{AnyLaw, Constants, ForceLaw as _, History, LawKind, Pair};
use granulens::material::find;
use granulens::report;
use granulens::units::Dimension::{Force, Length};
use serde_json::json;

use super::console::{emit, emit_json, note};
use super::failure::Failure;
use super::folder::write_file;
use super::{Common, length};

/// Draw a contact's force-displacement curve, or evaluate the law at given states
///
/// The curve, with its regions and an unloading, goes to the file of --out as SVG. With --states, the forces and the histories
/// after a step go to stdout as CSV, or to the file of --out.
#[derive(clap::Args)]
pub struct Contact {
    /// The two materials, such as 440c,brass
    #[arg(long, value_name = "A,B")]
    pair: String,
    /// thesis, thesis-static, consistent, hertz, hertz-thesis, linear or linear-static
    #[arg(long, default_value_t = LawKind::Thesis)]
    law: LawKind,
    /// Diameter of both spheres, or of each: "6.35 mm,9.5 mm"
    #[arg(long, default_value = "6.35 mm", allow_hyphen_values = true)]
    diameter: String,
    /// Set of fitted constants: code, text, sixteenth-inch or eq-4.7
    #[arg(long, default_value_t = Constants::Code)]
    constants: Constants,
    /// CSV with the columns d,v,dmax,Fmax in SI, v > 0 closing; forces and histories go to stdout, or to the file of --out
    #[arg(long, value_name = "FILE")]
    states: Option<PathBuf>,
}

impl Contact {
    pub fn run(self, common: &Common) -> Result<(), Failure> {
        let pair = self.pair()?;
        let law = AnyLaw::new(self.law, &pair);
        if let Some(path) = &self.states {
            let rows = states(path, &law)?;
            if let Some(out) = &common.out {
                write_file(out, &csv(&rows))?;
            }
            match (common.json, &common.out) {
                (true, _) => {
                    let rows: Vec<_> = rows
                        .iter()
                        .map(|row| {
                            COLUMNS
                                .into_iter()
                                .map(str::to_owned)
                                .zip(row.map(serde_json::Value::from))
                                .collect::<Row>()
                        })
                        .collect();
                    let law = self.law.name();
                    emit_json(&json!({ "format": granulens::outcome::FORMAT, "law": law, "states": rows }));
                }
                (false, None) => emit(&csv(&rows)),
                (false, Some(out)) => note(common, &format!("states: {}", out.display())),
            }
            return Ok(());
        }
        if let Some(path) = &common.out {
            if path.extension().is_none_or(|extension| !extension.eq_ignore_ascii_case("svg")) {
                return Err(Failure::input_with_help(
                    format!("--out {}: the curve is drawn as SVG only", path.display()),
                    "Let the name end in .svg.",
                ));
            }
            let title = format!("{} ({}, {} constants)", self.pair.replace(',', " on "), self.law, self.constants);
            write_file(path, &report::contact_curve(&law, &pair, &title))?;
            note(common, &format!("curve: {}", path.display()));
        }
        let regions = pair.regions(1.0);
        if common.json {
            emit_json(&json!({
                "format": granulens::outcome::FORMAT,
                "law": self.law.name(),
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
        Ok(Pair::new([&find(a, &[])?, &find(b, &[])?], radii, self.constants))
    }
}

/// The columns written for states: the state, the force, and the history after a step accepted there.
const COLUMNS: [&str; 7] = ["d", "v", "dmax", "Fmax", "F", "dmax_after", "Fmax_after"];

/// One state as a JSON object.
type Row = serde_json::Map<String, serde_json::Value>;

fn csv(rows: &[[f64; 7]]) -> String {
    let mut text = COLUMNS.join(",") + "\n";
    for row in rows {
        let _ = writeln!(text, "{}", row.map(|value| value.to_string()).join(","));
    }
    text
}

/// The law at every state of a CSV file.
fn states(path: &Path, law: &AnyLaw) -> Result<Vec<[f64; 7]>, Failure> {
    let text = std::fs::read_to_string(path)
        .map_err(|error| Failure::of_file(path, None, &format!("cannot be read: {error}")))?;
    // Counted here: the reader takes the place behind the record before for a record's place, comments and all.
    let mut lines = (1..).zip(text.lines()).filter(|(_, line)| !line.starts_with('#') && !line.trim().is_empty());
    let Some((line, header)) = lines.next() else {
        return Err(Failure::of_file(path, None, "holds no lines but comments; expected the columns d,v,dmax,Fmax"));
    };
    let columns: Vec<&str> = cells(header);
    let mut places = [0; 4];
    for (place, name) in places.iter_mut().zip(COLUMNS) {
        *place = columns.iter().position(|&column| column == name).ok_or_else(|| {
            Failure::of_file(path, Some(line), &format!("has no column \"{name}\"; expected d,v,dmax,Fmax"))
        })?;
    }
    let mut rows = Vec::new();
    for (line, text) in lines {
        let cells = cells(text);
        let mut values = [0.0; 4];
        for (value, &place) in values.iter_mut().zip(&places) {
            let fail = |message: String| Failure::of_file(path, Some(line), &format!("{}{message}", columns[place]));
            let cell = cells.get(place).ok_or_else(|| fail(" is missing in this line".to_owned()))?;
            *value = cell
                .parse()
                .ok()
                .filter(|value: &f64| value.is_finite())
                .ok_or_else(|| fail(format!(" = \"{cell}\" is not a finite number")))?;
        }
        let [d, v, dmax, fmax] = values;
        let history = History::yielded_at(dmax, fmax);
        let (force, after) = law.respond(d.max(0.0), v, &history);
        rows.push([d, v, dmax, fmax, force, after.overlap_max, after.force_max]);
    }
    Ok(rows)
}

fn cells(line: &str) -> Vec<&str> {
    line.split(',').map(|cell| cell.trim().trim_matches('"')).collect()
}
