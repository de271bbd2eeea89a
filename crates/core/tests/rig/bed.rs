//! Impacts on a bed of 5971 disks, from its given initial state, against an independent solution with a step of 0.001.

use granulens_core::dem::rig::{Arm, LawBook, Loss, Rig, Simulation};
use granulens_core::sample::{Sample, Sphere};

use crate::friction::{STIFFNESS, damping, friction};
use crate::reference::{Table, material};
use crate::rigs::GO;

const STIFFNESS_RATIO: f64 = 4000.0;

/// The bed of the file with its wall and an intruder of D 10 and mass 100, at speed v, 5 above the surface.
pub fn bed(speed: f64, kt: f64) -> Rig<2> {
    let table = Table::read("beds/bed1.csv");
    let mut spheres = Vec::new();
    for row in 0..table.len() {
        let centre = [table.number(row, "x"), table.number(row, "y")];
        let material = table.number(row, "type") as usize - 1;
        spheres.push(Sphere { centre, radius: 0.5 * table.number(row, "diameter"), material });
    }
    let surface = 55.45720033175587;
    spheres.push(Sphere { centre: [50.0, surface + 10.0], radius: 5.0, material: 0 });
    let intruder = spheres.len() - 1;
    let wall = (Loss::Rate(damping(0.1)), friction(0.9, 0.1, kt));
    let laws = LawBook::Dashpot {
        stiffness: STIFFNESS,
        materials: vec![(Loss::Rate(damping(0.5)), friction(0.5, 0.5, kt)), wall],
        cut: false,
        arm: Arm::Radius,
    };
    let held = spheres.iter().map(|s| [s.material == 1; 2]).collect();
    let mass: Vec<f64> = spheres.iter().map(|s| 4.0 * s.radius * s.radius).collect();
    let inertia = spheres.iter().zip(&mass).map(|(s, m)| 0.5 * m * s.radius * s.radius).collect();
    let mut rig = Rig::new(Sample { materials: vec![material("440c"); 2], spheres }, laws);
    (rig.held, rig.mass, rig.inertia) = (held, mass, inertia);
    rig.velocity[intruder] = [0.0, -speed];
    rig.gravity = [0.0, -std::f64::consts::PI.powi(2) / (2.0 * STIFFNESS_RATIO)];
    rig.periods = [Some(100.0), None];
    (rig.precompressed, rig.residual_limit, rig.overlap_limit) = (true, 0.05, Some(0.9));
    rig
}

/// Positions at t = 12, as the intruder is a diameter deep, at a step of 0.02. The independent code with half-step velocities
/// differs from its own fine solution by 1.8e-4 in the median and 1.3e-3 for nine in ten; a second-order step must do better.
#[test]
fn a_bed_is_struck_as_in_the_independent_solution() {
    for (kt, file) in
        [(0.0, "positions_b1_v0.70_mu0.5_kin_fine_t12.csv"), (0.8, "positions_b1_v0.70_mu0.5_stat_fine_t12.csv")]
    {
        let mut simulation = Simulation::new(bed(0.7, kt), 0.02).unwrap();
        simulation.advance(600, &GO).unwrap();
        let table = Table::read(&format!("beds/{file}"));
        let view = simulation.view();
        let mut apart: Vec<f64> = (0..table.len())
            .filter_map(|row| {
                let i = match table.number(row, "type") as usize {
                    1 => table.number(row, "row") as usize - 1,
                    3 => simulation.rig().mass.len() - 1,
                    _ => return None,
                };
                let [x, y] = view.position(i);
                let dx = x - table.number(row, "x");
                Some((dx - 100.0 * (dx / 100.0).round()).hypot(y - table.number(row, "y")))
            })
            .collect();
        apart.sort_by(f64::total_cmp);
        let (median, ninety) = (apart[apart.len() / 2], apart[apart.len() * 9 / 10]);
        println!("k_t {kt}: median {median:.2e}, 90 % {ninety:.2e}, residual {:?}", simulation.ledger().residual());
        assert!(median < 1.8e-4 && ninety < 1.3e-3, "k_t {kt}: {median} {ninety}");
    }
}

/// The intruder's depth: to the digits of the early trajectory (a hundredth of a grain up to t = 24), and later within the
/// spread that the growth of differences allows, which the independent code finds to be 0.4 d for one bed at other steps.
#[test]
fn the_intruder_comes_as_deep_as_in_the_independent_solution() {
    for (kt, file) in [(0.0, "impact_b1_v0.70_mu0.5_kin.csv"), (0.8, "impact_b1_v0.70_mu0.5_stat.csv")] {
        let mut simulation = Simulation::new(bed(0.7, kt), 0.02).unwrap();
        let table = Table::read(&format!("beds/{file}"));
        let intruder = simulation.rig().mass.len() - 1;
        for row in 1..=200 {
            simulation.advance(25, &GO).unwrap();
            let time = table.number(row, "t");
            assert!((simulation.time() - time).abs() < 1e-9);
            let depth = 55.45720033175587 - (simulation.view().position(intruder)[1] - 5.0);
            let (theirs, allowed) = (table.number(row, "D"), if time <= 24.0 { 0.01 } else { 0.5 });
            assert!((depth - theirs).abs() < allowed, "k_t {kt}, t {time}: {depth} and {theirs}");
        }
        // Peak force on the intruder at t = 9.5: known to be 7.5 (kinetic) and 8.5 (static) at this sampling.
        let ledger = simulation.ledger();
        assert!(ledger.friction > ledger.dissipated && ledger.residual().unwrap().abs() < 0.03, "{ledger:?}");
    }
}
