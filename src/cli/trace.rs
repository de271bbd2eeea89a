//! `granulens trace`: rays, wavefronts and first arrivals.

use std::path::PathBuf;

use granulens::design::Design;
use granulens::evaluate::{trace_arrivals, trace_lens};
use granulens::outcome::Traced;
use granulens::report;
use granulens::units::Dimension::{Length, Time};

use super::console::{emit, emit_json, note};
use super::failure::Failure;
use super::folder::write_file;
use super::{Common, propose, time};

/// Trace rays through the proposed lens: paths, wavefronts, caustic and first arrivals; milliseconds, no sphere moves
///
/// The picture goes to stdout as SVG, or to the file of --out; with --json the rays go to stdout in its place. Of a layout
/// nobody knows the faces: for one that is given only first arrivals are found, by the eikonal equation on the lattice.
#[derive(clap::Args)]
pub struct Trace {
    /// Design file, such as designs/quickstart.toml
    design: PathBuf,
    /// Layout, one line per sphere, in place of the proposed lens
    layout: Option<PathBuf>,
    /// Number of rays to draw
    #[arg(long, default_value_t = 24, value_name = "N", value_parser = clap::value_parser!(u16).range(2..=10_000))]
    rays: u16,
    /// Time between wavefronts, such as "20 us" [default: a round time]
    #[arg(long, value_name = "TIME", allow_hyphen_values = true, value_parser = time)]
    interval: Option<f64>,
}

impl Trace {
    pub fn run(self, common: &Common) -> Result<(), Failure> {
        let design = Design::read(&self.design)?;
        let traced = match &self.layout {
            Some(path) => {
                let layout = super::compare::read_layout(&design, path)?;
                trace_arrivals(&design, &layout, self.interval)
            }
            None => trace_lens(&design, &propose(&design)?, usize::from(self.rays), self.interval),
        };
        let picture = report::trace(&traced);
        if let Some(path) = &common.out {
            write_file(path, &picture)?;
            note(common, &format!("picture: {}", path.display()));
        }
        match (common.json, &common.out) {
            (true, _) => emit_json(&traced),
            (false, Some(_)) => emit(&words(&traced)),
            (false, None) => {
                note(common, &words(&traced));
                emit(&picture);
            }
        }
        Ok(())
    }
}

/// What rays say, for a person.
fn words(traced: &Traced) -> String {
    let shown = |time: Option<f64>| time.map_or("never".to_owned(), |time| Time.show(time));
    let row = |depth: f64| depth / (0.75_f64.sqrt() * traced.diameter) + 1.0;
    let mut lines = Vec::new();
    if traced.proposal.is_some() {
        let lost = traced.rays.iter().filter(|ray| ray.failure.is_some()).count();
        lines.push(format!("rays: {} traced, {lost} of them end in the crystal", traced.rays.len()));
        for (name, spot) in ["focal row", "least spot"].iter().zip(&traced.spots) {
            if let Some(spot) = spot {
                lines.push(format!(
                    "{name}: {} rays at row {:.1}, centre {} off the axis, mean radius {} ({:.2} D)",
                    spot.rays,
                    row(spot.depth),
                    Length.show(spot.centre),
                    // Round-off of a perfect focus is no length.
                    Length.show(if spot.radius < 1e-9 * traced.diameter { 0.0 } else { spot.radius }),
                    spot.radius / traced.diameter
                ));
            }
        }
    }
    let [rays, eikonal] = traced.focal_arrival;
    let by_rays = if traced.proposal.is_some() { format!("{} by rays, ", shown(rays)) } else { String::new() };
    lines.push(format!(
        "first arrival in the focal row: {by_rays}{} by the eikonal equation on the lattice",
        shown(eikonal)
    ));
    lines.join("\n")
}
