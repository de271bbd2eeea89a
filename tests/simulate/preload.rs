//! Squeezed crystals: at rest, in small vibrations, and struck.

use std::f64::consts::{PI, TAU};

use granulens::contact::{Constants, Pair};
use granulens::dem::rig::{Modes, Simulation};
use granulens::material::find;

use super::*;

const D: f64 = 0.01;

/// A chain of 440c and another metal in turn, with Hertz contacts, fixed or periodic ends, squeezed by a force (N).
fn squeezed(layers: u32, other: &str, ends: &str, force: f64, more: &str) -> Bench<1> {
    chain(&format!(
        "{HEAD}[crystal]\npacking = \"chain\"\ndiameter = \"{D} m\"\nlayers = {layers}\nmaterial = \"440c\"\n\
         [[pattern]]\nkind = \"layers\"\nmaterials = [\"440c\", \"{other}\"]\n\
         [sides]\nz = \"{ends}\"\n[law]\nkind = \"hertz\"\n[preload]\nforce = \"{force} N\"\n{more}"
    ))
}

const RUN: &str = "[run]\nwindow = \"10 us\"\n";

fn mass(name: &str) -> f64 {
    find(name, &[]).unwrap().sphere_mass(D)
}

/// K = dF/dδ = (3/2) k^(2/3) F^(1/3) of two metals under a force.
fn stiffness(metals: [&str; 2], force: f64) -> f64 {
    let [a, b] = metals.map(|name| find(name, &[]).unwrap());
    let k = Pair::new([&a, &b], [0.5 * D; 2], Constants::Code).hertz_coefficient();
    1.5 * k.powf(2.0 / 3.0) * force.powf(1.0 / 3.0)
}

fn modes(bench: &Bench<1>) -> Modes {
    Modes::of(&Simulation::new(bench.rig.clone(), bench.plan.step).unwrap()).unwrap()
}

/// Between fixed ends n spheres have ω_k = 2 √(K/m) sin(k π/(2(n + 1))); in a ring of n, ω = 2 √(K/m) |sin(π k/n)|, each but the first and last
/// twice. To the tolerance of the rest and of K as a difference quotient.
#[test]
fn a_squeezed_chain_has_the_modes_of_the_closed_form() {
    let force = 100.0;
    let natural = (stiffness(["440c"; 2], force) / mass("440c")).sqrt();
    let fixed = squeezed(22, "440c", "fixed", force, RUN);
    let preload = fixed.preload.as_ref().unwrap();
    assert!((preload.force[0] / force - 1.0).abs() < 1e-8 && preload.unbalanced < 1e-7, "{preload}");
    let found = modes(&fixed);
    assert_eq!(found.squared.len(), 20);
    for (k, squared) in found.squared.iter().enumerate() {
        let exact = 2.0 * natural * ((k + 1) as f64 * PI / (2.0 * 21.0)).sin();
        assert!((squared.sqrt() / exact - 1.0).abs() < 1e-6, "{k}: {} {exact}", squared.sqrt());
    }
    let found = modes(&squeezed(20, "440c", "periodic", force, RUN));
    let mut exact: Vec<f64> = (0..20).map(|k| 2.0 * natural * (PI * f64::from(k) / 20.0).sin()).collect();
    exact.sort_by(f64::total_cmp);
    for (squared, exact) in found.squared.iter().zip(&exact) {
        assert!((squared - exact * exact).abs() < 1e-5 * natural * natural, "{squared} {exact}");
    }
}

/// A chain of two metals has no mode between √(2K/m₁) and √(2K/m₂), the heavier and the lighter mass, nor above √(2K(1/m₁ + 1/m₂)): the edges of
/// its bands, which a ring has among its modes. Nothing gets through the gap.
#[test]
fn a_dimer_has_the_band_edges_of_the_closed_form() {
    let force = 80.0;
    let bench = squeezed(40, "al", "periodic", force, RUN);
    let found = modes(&bench);
    let (k, heavy, light) = (stiffness(["440c", "al"], force), mass("440c"), mass("al"));
    let edges = [(2.0 * k / heavy).sqrt(), (2.0 * k / light).sqrt(), (2.0 * k * (1.0 / heavy + 1.0 / light)).sqrt()];
    let frequencies: Vec<f64> = found.squared.iter().map(|squared| squared.max(0.0).sqrt()).collect();
    for (found, exact) in [frequencies[19], frequencies[20], frequencies[39]].into_iter().zip(edges) {
        assert!((found / exact - 1.0).abs() < 1e-6, "{found} {exact}");
    }
    // Through a finite chain: the middle of the gap is damped from cell to cell.
    let chain = squeezed(42, "al", "fixed", force, RUN);
    let spheres = [&[1_usize][..], &[40][..]];
    let at = |omega: f64| modes(&chain).transmission(0, spheres, &[omega / TAU], 1e-3)[0];
    assert!(at(0.5 * (edges[0] + edges[1])) < 1e-6, "{}", at(0.5 * (edges[0] + edges[1])));
    assert!(at(0.3 * edges[0]) > 1e-3);
}

/// A hexagonal sheet squeezed along both axes keeps its force over a run in which nothing strikes it: it is at rest.
#[test]
fn a_squeezed_sheet_stays_at_rest() {
    let text = |sides: &str, preload: &str| {
        format!(
            "{HEAD}[crystal]\npacking = \"hexagonal\"\ndiameter = \"6.35 mm\"\nlayers = 8\ncells = [6]\nmaterial = \"440c\"\n\
             [[edit]]\nlayers = 4\ncolumns = 3\nmaterial = \"brass\"\n{sides}[law]\nkind = \"hertz\"\n{preload}\
             [run]\nwindow = \"200 us\"\n"
        )
    };
    let sides = "[sides]\nx = \"periodic\"\nz = \"wall\"\n";
    let bench = sheet(&text(sides, "[preload]\nstrain = [\"0.05 %\", \"0.1 %\"]\n"));
    let preload = bench.preload.clone().unwrap();
    assert!(preload.unbalanced < 1e-7 && preload.force.iter().all(|&force| force > 10.0), "{preload}");
    let ran = Ran::of(&bench);
    assert_eq!(ran.ending, Ending::Complete);
    let stored = ran.summary.energies.stored;
    assert!(ran.summary.energies.kinetic < 1e-9 * stored, "{:?}", ran.summary.energies);
    // Nothing holds a free sheet.
    let error =
        Setup::parse("rig.toml", &text("[sides]\nx = \"periodic\"\n", "[preload]\nforce = \"10 N\"\n")).unwrap_err();
    assert!(error.to_string().contains("preload"), "{error}");
}
