//! A layout of one's own, scored beside the uniform crystals: a brass strip with a hole on the axis.
//!
//!     cargo run --release --example own_layout

use granulens::Context;
use granulens::design::Design;
use granulens::evaluate::{Forces, Overrides, Plan, beside_uniform};
use granulens::layout::Layout;
use granulens::material::find;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let design = Design::read("designs/quickstart.toml")?;
    let palette = vec![design.host.clone(), find("brass-260", &[])?];
    let hole = 3.0 * design.lattice.diameter();
    let layout = Layout::new(design.lattice.clone(), palette, |site| {
        let in_strip = (5..=16).contains(&site.row) && site.x > hole;
        u8::from(in_strip)
    });
    let plan = Plan::new(&design, Overrides::default(), &layout.palette)?;
    let found = beside_uniform(&design, &layout, &plan, Forces::ONE, &Context::default())?;
    let scores = &found.evaluation.scores;
    println!(
        "C {:.2}  G {:.2}  Q {:.2}",
        scores.contrast.unwrap_or(f64::NAN),
        or(scores.focal_gain),
        or(scores.protection)
    );
    Ok(())
}

/// A ratio is missing where a guard stopped what it refers to.
fn or(value: Option<f64>) -> f64 {
    value.unwrap_or(f64::NAN)
}
