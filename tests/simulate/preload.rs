//! Squeezed crystals: at rest, in small vibrations, and struck.

use std::f64::consts::{PI, TAU};

use granulens::contact::{Constants, Pair};
use granulens::dem::rig::{Modes, Simulation};
use granulens::material::find;

use super::*;

const D: f64 = 0.01;

/// A chain of 440c and another metal in turn, with Hertz contacts, fixed or periodic ends, squeezed by a force (N).
fn squeezed(layers: u32, other: &str, ends: &str, force: f64, more: &str) -> PreparedRig<1> {
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

fn modes(prepared: &PreparedRig<1>) -> Modes {
    Modes::of(&Simulation::new(prepared.rig.clone(), prepared.plan.step).unwrap()).unwrap()
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
    let prepared = squeezed(40, "al", "periodic", force, RUN);
    let found = modes(&prepared);
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
    let prepared = sheet(&text(sides, "[preload]\nstrain = [\"0.05 %\", \"0.1 %\"]\n"));
    let preload = prepared.preload.clone().unwrap();
    assert!(preload.unbalanced < 1e-7 && preload.force.iter().all(|&force| force > 10.0), "{preload}");
    let ran = Ran::of(&prepared);
    assert_eq!(ran.ending, Ending::Complete);
    let stored = ran.summary.energies.stored;
    assert!(ran.summary.energies.kinetic < 1e-9 * stored, "{:?}", ran.summary.energies);
    // Nothing holds a free sheet.
    let error =
        Setup::parse("rig.toml", &text("[sides]\nx = \"periodic\"\n", "[preload]\nforce = \"10 N\"\n")).unwrap_err();
    assert!(error.to_string().contains("preload"), "{error}");
}

/// Points to a sphere's diameter at which a wave's shape is known.
const POINTS: usize = 40;

/// G(φ) = (1 + φ)^(3/2) − 1: what the force of a squeezed contact gains with the overlap, in units of its own.
fn gain(phi: f64) -> f64 {
    (1.0 + phi) * (1.0 + phi).sqrt() - 1.0
}

/// The wave that runs along a squeezed chain without changing its shape: the overlap φ that it adds to a contact at x diameters from its crest, whose own
/// is 1 and where it is `crest`. Newton's law for φ(x − V t) is V² φ'' = G(x + 1) − 2 G(x) + G(x − 1) in units of √(k √δ₀/m), integrated twice
/// V² φ(x) = ∫ (1 − |s|) G(x + s) ds over |s| < 1 (K. Ahnert, A. Pikovsky, Phys. Rev. E 79, 026209, 2009), which is iterated with the crest held.
/// V, and φ on both sides of the crest as far as it is felt.
fn travelling(crest: f64) -> (f64, Vec<f64>) {
    let half = ((6.0 + 6.0 / crest.sqrt()) * POINTS as f64) as usize;
    let mut phi: Vec<f64> = (0..=2 * half)
        .map(|i| {
            let x = (i as f64 - half as f64) / POINTS as f64;
            crest / (x * (0.8 * (crest / (1.0 + crest)).sqrt())).cosh().powi(2)
        })
        .collect();
    for _ in 0..5000 {
        let gained: Vec<f64> = phi.iter().map(|&phi| gain(phi)).collect();
        let at = |i: usize, s: isize| i.checked_add_signed(s).and_then(|i| gained.get(i)).copied().unwrap_or(0.0);
        let width = POINTS as isize;
        let felt = |i: usize| -> f64 {
            let parts = (1 - width..width).map(|s| (1.0 - s.unsigned_abs() as f64 / POINTS as f64) * at(i, s));
            parts.sum::<f64>() / POINTS as f64
        };
        let next: Vec<f64> = (0..phi.len()).map(felt).collect();
        let scale = crest / next[half];
        let moved = phi.iter().zip(&next).map(|(old, new)| (scale * new - old).abs()).fold(0.0, f64::max);
        phi = next.into_iter().map(|felt| scale * felt).collect();
        if moved < 1e-10 * crest {
            return (scale.recip().sqrt(), phi);
        }
    }
    panic!("no wave with a crest of {crest}");
}

/// From sound to the solitary wave: a squeezed chain is driven with the wave's own shape, so that nothing else runs along it, and the crest goes from sphere to sphere
/// at the speed of the shape, to the 0.1 % of the step's class. Nesterenko's closed form for waves that are long against a sphere (Dynamics of Heterogeneous Materials,
/// 2001, eq. 1.115), V = c₀ √((4/15)(3 + 2 f^(5/3) − 5 f^(2/3)))/(f^(2/3) − 1), f the greatest force over that of the preload, is met as the wave gets long, and missed by up to
/// 1.3 % where it is five spheres long.
#[test]
fn a_squeezed_chain_carries_waves_from_the_sonic_to_the_solitary_limit() {
    // So little that the deepest of the waves stays far within the spheres.
    let (force, count) = (1.0, 150);
    let prepared = squeezed(count, "440c", "fixed", force, RUN);
    let steel = find("440c", &[]).unwrap();
    let k = Pair::new([&steel; 2], [0.5 * D; 2], Constants::Code).hertz_coefficient();
    let rest = (force / k).powf(2.0 / 3.0);
    // Of time: of speed in spheres a second is the reciprocal.
    let unit = (mass("440c") / (k * rest.sqrt())).sqrt();
    let sound = 1.5_f64.sqrt();
    for (crest, long) in [(0.1, 1e-4), (0.3, 5e-4), (3.0, 5e-3), (30.0, 1.1e-2), (1000.0, 1.3e-2)] {
        let (speed, phi) = travelling(crest);
        let f: f64 = (1.0_f64 + crest).powf(1.5);
        let closed = sound * (4.0 / 15.0 * (3.0 + 2.0 * f.powf(5.0 / 3.0) - 5.0 * f.powf(2.0 / 3.0))).sqrt()
            / (f.powf(2.0 / 3.0) - 1.0);
        assert!(
            (closed / speed - 1.0).abs() < long,
            "crest {crest}: {closed} by the closed form, {speed} by the shape"
        );

        // The crest begins at the contact of spheres 45 and 46.
        let half = phi.len() / 2;
        let at = |contact: isize| {
            let i = half as isize + (contact - 45) * POINTS as isize;
            usize::try_from(i).ok().and_then(|i| phi.get(i)).copied().unwrap_or(0.0)
        };
        let mut rig = prepared.rig.clone();
        let spheres = rig.sample.spheres.len() as isize;
        for n in 0..spheres {
            let shift: f64 = (n..spheres - 1).map(at).sum();
            // m V v = ∫ G dx over the sphere's own diameter.
            let mut gained = 0.0;
            for part in 0..POINTS as isize {
                let i = half as isize + (n - 46) * POINTS as isize + part;
                let g = |i: isize| usize::try_from(i).ok().and_then(|i| phi.get(i)).map_or(0.0, |&phi| gain(phi));
                gained += 0.5 * (g(i) + g(i + 1)) / POINTS as f64;
            }
            let n = n as usize;
            rig.sample.spheres[n].centre[0] += rest * shift;
            rig.velocity[n][0] = rest / unit * gained / speed;
        }
        // A stiffer contact than that of the preload.
        let step = 0.5 * prepared.plan.step / (1.0 + crest).powf(0.25);
        let mut simulation = Simulation::new(rig, step).unwrap();
        let marks = [70, 120];
        let steps = ((marks[1] + 20 - 45) as f64 / speed * unit / step) as u64;
        let mut heard = [(0.0, 0.0); 2];
        let (mut before, mut number) = ([[0.0; 2]; 2], 0.0);
        simulation
            .follow(steps, &Context::default(), |view| {
                number += 1.0;
                for (which, &sphere) in marks.iter().enumerate() {
                    let now = view.velocity(sphere)[0];
                    let [older, old] = before[which];
                    if old > heard[which].1 && old >= now && old >= older {
                        // The top of the parabola through three steps.
                        let top = 0.5 * (older - now) / (older - 2.0 * old + now);
                        heard[which] = ((number - 1.0 + top) * step, old);
                    }
                    before[which] = [old, now];
                }
            })
            .unwrap();
        let found = (marks[1] - marks[0]) as f64 / (heard[1].0 - heard[0].0) * unit;
        assert!((found / speed - 1.0).abs() < 1e-3, "crest {crest}: {found}, the shape's {speed}");
        // It is the shape that was put in: the crest is as fast as before.
        assert!((heard[1].1 / heard[0].1 - 1.0).abs() < 1e-2, "crest {crest}: {heard:?}");
    }
}
