//! `granulens design`: propose a lens by ray tracing.

use std::path::PathBuf;

use granulens::design::Design;
use granulens::evaluate::{laid, proposal, validity};
use granulens::layout;
use granulens::lens::Lens;
use granulens::units::Dimension::{Force, Length};
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
        let laid = laid(&design, &lens);
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
    let layout = laid(design, lens);
    let [host, material] = [&layout.palette[0], &layout.palette[1]];
    let diameter = design.lattice.diameter();
    let in_diameters = |length: f64| format!("{:.2} D", length / diameter);
    let critical = granulens::wave::critical_angle([lens.host_speed, lens.lens_speed])
        .map_or_else(|| "none".to_owned(), |angle| format!("{:.1} deg", angle.to_degrees()));
    let crossing = |depth: Option<f64>| match depth {
        Some(z) => format!("crosses the axis at row {:.1}", z / design.lattice.row_spacing() + 1.0),
        None => "does not cross the axis".to_owned(),
    };
    let [mid, x] = [design.target.focus.mid_row(), design.target.focus.x[1] / diameter];
    format!(
        "speeds: {} {:.0} m/s, {} {:.0} m/s (bound, 2D), ratio {:.3}, critical angle {critical}\n\
         impact: {} per sphere, {} per contact; {}: {}; {}: {}\n\
         lens: rows {} to {}, radius {} ({}), rim angle {:.1} deg, half aperture {}, {} spheres\n\
         rays: {:.1} % of the struck width reach the focus (row {mid}, x <= {x:.1} D), {:.1} % without the lens; innermost \
         ray {}, rim ray {}",
        host.name,
        lens.host_speed,
        material.name,
        lens.lens_speed,
        lens.host_speed / lens.lens_speed,
        Force.show(design.impact.force),
        Force.show(granulens::wave::contact_force(design.impact.force)),
        host.name,
        validity(design, host).words(),
        material.name,
        validity(design, material).words(),
        lens.apex_row,
        lens.back_row,
        in_diameters(lens.radius),
        Length.show(lens.radius),
        lens.rim_angle.to_degrees(),
        in_diameters(lens.aperture),
        layout.count(1),
        100.0 * lens.fraction,
        100.0 * lens.fraction_without,
        crossing(lens.crossing[0]),
        crossing(lens.crossing[1]),
    )
}
