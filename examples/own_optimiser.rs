//! An optimiser of one's own: random exchanges, kept where they raise the contrast. Eight layouts are simulated side by side.
//!
//!     cargo run --release --example own_optimiser

use granulens::Context;
use granulens::design::Design;
use granulens::evaluate::{Evaluator, Overrides};
use granulens::lens::propose;
use granulens::search::Rng;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let design = Design::read("designs/quickstart.toml")?;
    let request = design.lens.as_ref().ok_or("the design asks for no lens")?;
    let lens = propose(&design.lattice, &design.host, request, &design.target, design.constants)?;
    let mut best = lens.layout();
    let never = Context::default();
    let coarse = Overrides { step: Some(4e-7), ..Overrides::default() };
    let evaluator = Evaluator::new(&design, &[design.impact], best.palette.clone(), coarse, &never)?;
    let contrast = |layouts: &[Vec<u8>]| -> Result<Vec<f64>, Box<dyn std::error::Error>> {
        let runs = evaluator.scores(layouts, &never)?;
        Ok(runs.iter().map(|run| run[0].scores.contrast.unwrap_or(0.0)).collect())
    };
    let mut value = contrast(&[best.materials.clone()])?[0];
    println!("the lens: C {value:.2}");
    let free: Vec<usize> =
        (0..best.materials.len()).filter(|&i| (5..=25).contains(&design.lattice.sites()[i].row)).collect();
    let mut rng = Rng::new(1);
    for _ in 0..10 {
        let tries: Vec<Vec<u8>> = (0..8)
            .map(|_| {
                let mut materials = best.materials.clone();
                let site = free[rng.below(free.len() as u64) as usize];
                materials[site] = 1 - materials[site];
                materials
            })
            .collect();
        for (materials, c) in tries.iter().zip(contrast(&tries)?) {
            if c > value {
                (value, best.materials) = (c, materials.clone());
            }
        }
    }
    println!("after 80 tries: C {value:.2}");
    Ok(())
}
