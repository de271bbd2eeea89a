//! A rig of one's own: a chain of ten steel spheres, the first of which comes in at 1 m/s. What leaves at the other end.
//!
//!     cargo run --release --example rig

use granulens::Context;
use granulens::contact::{Constants, LawKind};
use granulens::dem::rig::{Law, LawBook, Rig, Simulation};
use granulens::material::find;
use granulens::sample::{Sample, Sphere};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let steel = find("440c", &[])?;
    let radius = 5e-3;
    let spheres = (0..10).map(|k| Sphere { centre: [2.0 * radius * f64::from(k)], radius, material: 0 }).collect();
    let sample = Sample { materials: vec![steel], spheres };
    let law = Law::Named(LawKind::Consistent);
    let laws = LawBook::Materials { law, constants: Constants::default(), pairs: Vec::new(), friction: None };
    let mut rig = Rig::new(sample, laws);
    rig.velocity[0] = [1.0];
    let put_in: f64 = rig.mass[0];
    let mut simulation = Simulation::new(rig, 1e-7)?;
    simulation.advance(5000, &Context::default())?;
    let (view, ledger) = (simulation.view(), simulation.ledger());
    let velocity = |i: usize| view.velocity(i)[0];
    let momentum: f64 = simulation.rig().mass.iter().zip(0..).map(|(mass, i)| mass * velocity(i)).sum();
    println!(
        "after {:.0} us the last sphere moves at {:.3} m/s; kinetic energy {:.3e} J",
        1e6 * simulation.time(),
        velocity(9),
        ledger.kinetic
    );
    assert!((momentum / put_in - 1.0).abs() < 1e-9, "contacts hand momentum on");
    Ok(())
}
