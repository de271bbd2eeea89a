//! `granulens sensitivity`: how scores change with every sphere.

use std::fmt::Write as _;
use std::path::PathBuf;

use granulens::design::Design;
use granulens::evaluate::{MEASURES, Plan, Sensitivities, SensitivityError, impact, method, sensitivities};
use granulens::layout::Layout;
use granulens::outcome::{FORMAT, Method};
use granulens::report::sensitivity_csv;
use granulens::score::Measure;
use serde_json::{Value, json};

use super::compare::read_layout;
use super::console::{context, emit, emit_json, note};
use super::cost::{Part, arrangement, tell};
use super::failure::Failure;
use super::folder::{probe, write_file};
use super::{Common, Motion};

/// How scores change with every sphere: derivatives by the adjoint of the run, each beside a secant that says how far it holds
///
/// Derivatives are of the logarithm of a measure by the logarithms of density, Young's modulus, yield stress and radius of each sphere: -0.5 says that
/// one per cent more of the quantity takes 0.5 % off the measure. Where the secant, over one per cent of density, says otherwise the derivative is
/// called not linear: it is right, and useless. With --out a table, a line for each sphere and measure.
#[derive(clap::Args)]
pub struct SensitivityOf {
    /// Layout, CSV with the header row,column,x,z,diameter,material
    layout: PathBuf,
    /// Design file: everything but the materials
    #[arg(long, value_name = "FILE")]
    design: PathBuf,
    /// Of which measures: focal_mean, protected_mean, contrast, focal_gain, protection
    #[arg(long, value_name = "LIST", value_delimiter = ',', default_value = "focal_mean,protected_mean,contrast")]
    #[arg(value_parser = measure)]
    of: Vec<Measure>,
    #[command(flatten)]
    motion: Motion,
}

fn measure(name: &str) -> Result<Measure, String> {
    let known = || MEASURES.map(Measure::name).join(", ");
    let found = Measure::find(name).filter(|measure| MEASURES.contains(measure));
    found.ok_or_else(|| format!("there are derivatives of {}", known()))
}

/// How many spheres the words name.
const NAMED: usize = 8;

impl SensitivityOf {
    pub fn run(self, common: &Common) -> Result<(), Failure> {
        let design = Design::read(&self.design)?;
        let layout = read_layout(common, &design, &self.layout)?;
        let overrides = self.motion.overrides(common);
        let plan = Plan::new(&design, overrides, &layout.palette)
            .map_err(|error| Failure::of_plan(&design, &overrides, &error))?;
        if common.dry_run {
            let alone = arrangement(&layout.sample(), &impact(&design, &plan))?;
            return tell(common, &cost(alone, layout.materials.len()));
        }
        probe(common, common.out.as_ref())?;
        let how = method(&design, &plan);
        note(common, &how.words());
        plan.warnings.iter().for_each(|warning| note(common, &format!("warning: {warning}")));
        let found = sensitivities(&design, &layout, &plan, &self.of, context()).map_err(|error| failure(&error))?;
        if let Some(path) = &common.out {
            let material = |site: usize| &layout.palette[usize::from(layout.materials[site])].name[..];
            write_file(common, path, &sensitivity_csv(&layout.lattice.sites(), material, &found.of))?;
        }
        if common.json {
            emit_json(&self.told(&design, &layout, &found, &how));
        } else {
            emit(&words(&layout, &found));
        }
        Ok(())
    }

    fn told(&self, design: &Design, layout: &Layout, found: &Sensitivities, how: &Method) -> Value {
        let sites = layout.lattice.sites();
        let mut told = json!(how);
        let rest = json!({
            "format": FORMAT,
            "design": design.name,
            "layout": self.layout.display().to_string(),
            "focal_mean_J": found.means[0],
            "protected_mean_J": found.means[1],
            "bytes": found.bytes,
            "sites": (0..sites.len()).map(|i| json!({
                "row": sites[i].row, "column": sites[i].column, "x": sites[i].x, "z": sites[i].z,
                "material": layout.palette[usize::from(layout.materials[i])].name,
            })).collect::<Vec<_>>(),
            "sensitivities": found.of,
        });
        if let (Value::Object(told), Value::Object(rest)) = (&mut told, rest) {
            told.extend(rest);
        }
        told
    }
}

pub(super) fn failure(error: &SensitivityError) -> Failure {
    let help = match error {
        SensitivityError::Nothing(_) => "Take a longer --window, so that the wave reaches the region.",
        SensitivityError::Gradient(granulens::dem::GradientError::RungeKutta) => {
            "Leave --integrator out, or name adams or verlet."
        }
        SensitivityError::Gradient(granulens::dem::GradientError::Projectile) => {
            "Take a design whose impact is a force pulse."
        }
        SensitivityError::Measure(_) => "Ask for focal_mean, protected_mean, contrast, focal_gain or protection.",
        SensitivityError::Gradient(_) | SensitivityError::Batch(_) | SensitivityError::Stopped(_) => {
            "granulens check says what stops the run."
        }
    };
    Failure::input_with_help(error.to_string(), help)
}

/// What derivatives and secants cost, of a run that takes `alone` (s).
pub(super) fn cost(alone: f64, sites: usize) -> [Part; 2] {
    [
        Part::new("derivatives", 1, Some(8.0 * alone)),
        Part::new("secants, a crystal for each sphere", sites as u64, Some(alone * sites as f64 / 5.0)),
    ]
}

fn words(layout: &Layout, found: &Sensitivities) -> String {
    let sites = layout.lattice.sites();
    let mut text = String::new();
    for one in &found.of {
        let _ = writeln!(text, "{}: {}; by the impact's force {:+.3}", one.measure.name(), one.trust(), one.force);
        let mut order: Vec<usize> = (0..sites.len()).collect();
        order.sort_by(|&a, &b| one.secant_density[b].abs().total_cmp(&one.secant_density[a].abs()));
        let _ = writeln!(
            text,
            "  {:>4} {:>6} {:<16} {:>10} {:>10} {:>10} {:>10} {:>10}  linear",
            "row", "column", "material", "density", "secant", "modulus", "yield", "radius"
        );
        for &i in order.iter().take(NAMED) {
            let _ = writeln!(
                text,
                "  {:>4} {:>6} {:<16} {:>+10.4} {:>+10.4} {:>+10.4} {:>+10.4} {:>+10.4}  {}",
                sites[i].row,
                sites[i].column,
                layout.palette[usize::from(layout.materials[i])].name,
                one.density[i],
                one.secant_density[i],
                one.youngs_modulus[i],
                one.yield_stress[i],
                one.radius[i],
                if one.linear[i] { "yes" } else { "no" }
            );
        }
    }
    text
}
