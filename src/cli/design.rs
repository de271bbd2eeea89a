//! `granulens design`: propose a lens by ray tracing.

use std::path::PathBuf;

use granulens::design::Design;
use granulens::evaluate::{proposal, validity};
use granulens::layout;
use granulens::lens::Lens;
use granulens::material::Material;
use granulens::units::Dimension::{Force, Length, Mass, Time};
use serde_json::json;

use super::console::{emit, emit_json, note};
use super::failure::Failure;
use super::folder::write_file;
use super::{Common, propose};

/// Propose a lens from the design's target by ray tracing; milliseconds, nothing is simulated
///
/// The layout goes to stdout as CSV, or to the file of --out.
#[derive(clap::Args)]
pub struct Propose {
    /// Design file, such as designs/quickstart.toml
    design: PathBuf,
    /// Write the whole piece to be built, both halves, in place of the simulated half
    #[arg(long)]
    full: bool,
}

impl Propose {
    pub fn run(self, common: &Common) -> Result<(), Failure> {
        let design = Design::read(&self.design)?;
        let lens = propose(&design)?;
        let laid = lens.layout();
        let text = if self.full { layout::write_full(&laid) } else { layout::write(&laid) };
        if let Some(path) = &common.out {
            write_file(path, &text)?;
            note(common, &format!("layout: {}", path.display()));
        }
        if common.json {
            let proposal = proposal(&design, &lens);
            emit_json(&json!({ "format": granulens::outcome::FORMAT, "name": design.name, "proposal": proposal }));
        } else if common.out.is_none() {
            note(common, &words(&design, &lens));
            emit(&text);
        } else {
            emit(&words(&design, &lens));
        }
        Ok(())
    }
}

/// What is proposed, for a person.
pub fn words(design: &Design, lens: &Lens) -> String {
    let [host, material] = [&lens.palette[0], &lens.palette[1]];
    let diameter = design.lattice.diameter();
    let in_diameters = |length: f64| format!("{:.2} D", length / diameter);
    let critical = granulens::wave::critical_angle([lens.host_speed, lens.lens_speed])
        .map_or_else(|| "none".to_owned(), |angle| format!("{:.1} deg", angle.to_degrees()));
    let crossing = |depth: Option<f64>| match depth {
        Some(z) => format!("crosses the axis at row {:.1}", z / design.lattice.row_spacing() + 1.0),
        None => "does not cross the axis".to_owned(),
    };
    let [mid, x] = [design.target.focus.mid_row(), design.target.focus.x[1] / diameter];
    let of = |material: &Material| format!("{}: {}", material.name, validity(design, material).words());
    let radius = match (lens.family.radius(), lens.radius) {
        (Some(name), Some(radius)) => format!(", {name} {} ({})", in_diameters(radius), Length.show(radius)),
        _ => String::new(),
    };
    let names = lens.palette.iter().zip(&lens.first_order.counts).skip(1);
    let counts: Vec<String> = names.map(|(material, count)| format!("{count} {}", material.name)).collect();
    let first = &lens.first_order;
    let focal = first.focal_length.map_or("none".to_owned(), in_diameters);
    let arrival = first.arrival.map_or("never".to_owned(), |[a, b]| format!("{} to {}", Time.show(a), Time.show(b)));
    let percent = |fraction: f64| format!("{:.1} %", 100.0 * fraction);
    let mut words = format!(
        "speeds: {} {:.0} m/s, {} {:.0} m/s (bound, 2D), ratio {:.3}, critical angle {critical}\n\
         impact: {} per sphere, {} per contact; {}\n\
         lens: rows {} to {}, {}{radius}, steepest {:.1} deg, half aperture {}, {} spheres\n\
         piece: {} in both halves, {}, thickness {}, axis at {}, focal length {focal}\n\
         rays: {} of the struck width reach the focus (row {mid}, x <= {x:.1} D), {} without the lens; {} pass the protected \
         region, {} without; arrival {arrival}; innermost ray {}, rim ray {}",
        host.name,
        lens.host_speed,
        material.name,
        lens.lens_speed,
        lens.host_speed / lens.lens_speed,
        Force.show(design.impact.force),
        Force.show(granulens::wave::contact_force(design.impact.force)),
        lens.palette.iter().map(of).collect::<Vec<_>>().join("; "),
        lens.apex_row,
        lens.back_row,
        lens.family.name(),
        lens.rim_angle.to_degrees(),
        in_diameters(lens.aperture),
        lens.spheres,
        counts.join(", "),
        Mass.show(first.mass),
        in_diameters(first.thickness),
        in_diameters(lens.axis),
        percent(lens.fraction),
        percent(lens.fraction_without),
        percent(lens.protected[0]),
        percent(lens.protected[1]),
        crossing(lens.crossing[0]),
        crossing(lens.crossing[1]),
    );
    if let Some(cost) = first.cost(&lens.palette, &design.prices) {
        words.push_str(&format!("\ncost: {cost:.2} for all spheres of both halves, in the currency of [prices]"));
    }
    for warning in &lens.warnings {
        words.push_str(&format!("\nwarning: {warning}"));
    }
    words
}
