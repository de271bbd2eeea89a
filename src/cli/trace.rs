//! `granulens trace`: rays, wavefronts and first arrivals.

use std::path::PathBuf;

use granulens::design::Design;
use granulens::evaluate::{Overrides, Plan, calibrate, method, trace_arrivals, trace_lens};
use granulens::material::Material;
use granulens::outcome::{Method, Traced, TracedFocus};
use granulens::report;
use granulens::units::Dimension::{Force, Length, Time};
use granulens::wave::Decay;

use super::console::{context, emit, emit_json, note};
use super::failure::Failure;
use super::folder::probe_all;
use super::picture::write_picture;
use super::{Common, propose, time};

/// Trace rays through the proposed lens: paths, wavefronts, caustic and first arrivals; milliseconds, no sphere moves
///
/// The picture goes to stdout as SVG, or to the file of --out, as SVG or PDF; with --json the rays go to stdout in its place. Of a layout
/// nobody knows the faces: for one that is given only first arrivals are found, by the eikonal equation on the lattice.
#[derive(clap::Args)]
pub struct Trace {
    /// Design file, such as designs/quickstart.toml
    design: PathBuf,
    /// Layout, one line per sphere, in place of the proposed lens
    layout: Option<PathBuf>,
    /// Write the spot diagram, where rays pass the focal row, as SVG or PDF to this file
    #[arg(long, value_name = "FILE")]
    spots: Option<PathBuf>,
    /// Number of rays to draw
    #[arg(long, default_value_t = 24, value_name = "N", value_parser = clap::value_parser!(u16).range(2..=10_000))]
    rays: u16,
    /// Time between wavefronts, such as "20 us" [default: a round time]
    #[arg(long, value_name = "TIME", allow_hyphen_values = true, value_parser = time)]
    interval: Option<f64>,
    /// First arrivals of a wave that decays: the uniform crystal of each material is struck first, which takes a part of a second,
    /// and every site runs at the part of the bound that is reached there
    #[arg(long)]
    decay: bool,
}

impl Trace {
    pub fn run(self, common: &Common) -> Result<(), Failure> {
        if self.spots.is_some() && self.layout.is_some() {
            return Err(Failure::input_with_help(
                "--spots: a layout has no rays, as nobody knows its faces",
                "Leave the layout out to trace the lens that the design proposes.",
            ));
        }
        let design = Design::read(&self.design)?;
        if !design.lattice.is_close_packed() {
            return Err(Failure::input_with_help(
                format!(
                    "{}: rays and first arrivals are those of a hexagonal sheet of equal spheres",
                    self.design.display()
                ),
                "Simulate it: granulens check LAYOUT.csv --design DESIGN.toml --spheres FILE.csv says when the wave came to each sphere.",
            ));
        }
        probe_all(common, &[common.out.as_ref(), self.spots.as_ref()])?;
        let mut how = None;
        let mut traced = match &self.layout {
            Some(path) => {
                let layout = super::compare::read_layout(common, &design, path)?;
                let decays = self.decays(common, &design, &layout.palette, &mut how)?;
                trace_arrivals(&design, &layout, self.interval, decays.as_deref())
            }
            None => {
                let lens = propose(&design)?;
                let decays = self.decays(common, &design, &lens.palette, &mut how)?;
                trace_lens(&design, &lens, usize::from(self.rays), self.interval, decays.as_deref())
            }
        };
        traced.decay_method = how;
        let picture = report::trace(&traced);
        if let Some(path) = &common.out {
            write_picture(common, path, &picture)?;
            note(common, &format!("picture: {}", path.display()));
        }
        if let Some(path) = &self.spots {
            let rays: Vec<_> = traced.foci.iter().map(|focus| &focus.rays).collect();
            write_picture(common, path, &report::spot_diagram(&traced.name, traced.diameter, &rays))?;
            note(common, &format!("spot diagram: {}", path.display()));
        }
        traced.warnings.iter().for_each(|warning| note(common, &format!("warning: {warning}")));
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

impl Trace {
    /// How the wave decays in each material, where that is asked for, and how that was found.
    fn decays(
        &self,
        common: &Common,
        design: &Design,
        palette: &[Material],
        how: &mut Option<Method>,
    ) -> Result<Option<Vec<Decay>>, Failure> {
        if !self.decay {
            return Ok(None);
        }
        let overrides = Overrides::default();
        let plan =
            Plan::new(design, overrides, palette).map_err(|error| Failure::of_plan(design, &overrides, &error))?;
        note(common, &format!("uniform crystals: {}", how.insert(method(design, &plan)).words()));
        let found = calibrate(design, &plan, palette, context())?;
        let named = found.into_iter().zip(palette).map(|(decay, material)| {
            decay.ok_or_else(|| {
                Failure::input_with_help(
                    format!(
                        "--decay: the impact sends no wave down a uniform crystal of {}: it is too weak for it, or too strong",
                        material.name
                    ),
                    "Change impact.force or impact.duration, or trace without --decay.",
                )
            })
        });
        Ok(Some(named.collect::<Result<_, _>>()?))
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
    if traced.foci.len() > 1 {
        lines.extend(traced.foci.iter().enumerate().map(|(k, focus)| of_focus(k, focus, traced.diameter)));
    }
    let [rays, eikonal] = traced.focal_arrival;
    let by_rays = if traced.proposal.is_some() { format!("{} by rays, ", shown(rays)) } else { String::new() };
    lines.push(format!(
        "first arrival in the focal row: {by_rays}{} by the eikonal equation on the lattice",
        shown(eikonal)
    ));
    if let Some(decaying) = traced.focal_arrival_decaying {
        let every = (traced.decays[0].reached.len() / 5).max(1);
        let told = |k: usize, decay: &granulens::outcome::TracedDecay| {
            format!("{:.2} in row {} ({})", decay.reached[k], k + 1, Force.show(decay.force[k]))
        };
        lines.push(format!("in a wave that decays: {} by the eikonal equation", Time.show(decaying)));
        for decay in &traced.decays {
            let rows: Vec<String> = (every / 2..decay.reached.len()).step_by(every).map(|k| told(k, decay)).collect();
            lines.push(format!("{}: of the bound {}", decay.material, rows.join(", ")));
        }
    }
    lines.join("\n")
}

/// What comes to one of several foci.
fn of_focus(k: usize, focus: &TracedFocus, diameter: f64) -> String {
    let rays = &focus.rays;
    let spot = rays.spot.map_or(String::new(), |spot| {
        format!(", centre {} off the axis, mean radius {:.2} D", Length.show(spot.centre), spot.radius / diameter)
    });
    let shown = |time: Option<f64>| time.map_or("never".to_owned(), |time| Time.show(time));
    format!(
        "focus {} (row {:.1}): {} of its {} rays come into it{spot}; first arrival {} by rays, {} by the eikonal equation",
        k + 1,
        rays.depth / (0.75_f64.sqrt() * diameter) + 1.0,
        rays.inside(),
        rays.passages.len(),
        shown(focus.arrival[0]),
        shown(focus.arrival[1]),
    )
}
