//! How well arrivals behind lenses and angles behind wedges are predicted, at the plain bound and in a wave that decays.

mod disorder;
#[path = "../../crates/core/tests/physics/reference.rs"]
#[expect(dead_code, reason = "shared with the core's tests, which use all of it")]
mod reference;

use std::path::Path;

use granulens::Context;
use granulens::contact::{Constants, LawKind};
use granulens::design::Design;
use granulens::evaluate::{Overrides, Plan, calibrate, decay, evaluate, trace_lens};
use granulens::layout::Layout;
use granulens::lens::propose;
use granulens::material::Material;
use granulens::reproduce::Wedge;
use granulens::wave::Decay;

use reference::material;

static GO: std::sync::LazyLock<Context> = std::sync::LazyLock::new(Context::default);

fn design(name: &str) -> Design {
    Design::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("designs/gallery").join(name)).unwrap()
}

fn decays(design: &Design, plan: &Plan, palette: &[Material]) -> Vec<Decay> {
    calibrate(design, plan, palette, &GO).unwrap().into_iter().map(Option::unwrap).collect()
}

/// A narrow strip between mirrors is a uniform crystal of any width, but for round-off, which the contacts of neighbouring
/// columns do not share.
#[test]
fn a_strip_decays_as_the_whole_crystal_does() {
    let design = design("plano-convex.toml");
    let brass = [material("brass")];
    let plan = Plan::new(&design, Overrides::default(), &brass).unwrap();
    // As long as the strip is watched.
    let plan = Plan { window: 900e-6, ..plan };
    let strip = &decays(&design, &plan, &brass)[0];
    let layout = Layout::new(design.lattice.clone(), brass.to_vec(), |_| 0);
    let record = evaluate(&design, &layout, &plan, &GO).unwrap().record;
    let whole = decay(&design.lattice, &brass[0], Constants::Code, &record).unwrap();
    for row in 1..=50 {
        assert!((strip.reached(row) / whole.reached(row) - 1.0).abs() < 1e-6, "{row}");
    }
}

/// Deviations of arrivals on the axis, rows 15 to 46, from those simulated (rms, s): of the axial ray at the plain bound, and of
/// first arrivals on the lattice in a wave calibrated on the two uniform crystals.
fn deviations(name: &str) -> [f64; 2] {
    let design = design(name);
    let request = design.lens.as_ref().unwrap();
    let lens = propose(&design.lattice, &design.host, request, &design.target, design.constants).unwrap();
    let plan = Plan::new(&design, Overrides::default(), &lens.palette).unwrap();
    let decays = decays(&design, &plan, &lens.palette);
    let record = evaluate(&design, &lens.layout(), &plan, &GO).unwrap().record;
    let traced = trace_lens(&design, &lens, 2, None, Some(&decays));
    let axial = lens.optics().trace(0.0);
    let mut sums = [0.0; 2];
    for row in 15..=46 {
        let site = design.lattice.index(row, 1).unwrap();
        let simulated = record.arrival[site].unwrap();
        let predicted =
            [axial.path.at_depth(design.lattice.depth(f64::from(row))).unwrap().1, traced.first_arrival[site]];
        for (sum, time) in sums.iter_mut().zip(predicted) {
            *sum += (simulated - time).powi(2);
        }
    }
    sums.map(|sum: f64| (sum / 32.0).sqrt())
}

/// Behind every lens that gathers on the axis, a wave that decays arrives nearer to the simulated time than one at the bound;
/// nothing of the lens enters the calibration. At least a quarter nearer is a gain that no smoothing of rows explains.
#[test]
fn a_wave_that_decays_arrives_nearer_to_the_simulated_time() {
    let (mut plain, mut decaying) = (0.0, 0.0);
    for name in ["plano-convex", "biconvex", "aspheric-front", "aspheric-back", "fresnel", "stages", "graded"] {
        let [bound, decays] = deviations(&format!("{name}.toml"));
        println!("{name}: bound {:.2} us, decaying {:.2} us", 1e6 * bound, 1e6 * decays);
        assert!(decays < 0.75 * bound, "{name}: {decays} {bound}");
        plain += bound * bound / 7.0;
        decaying += decays * decays / 7.0;
    }
    println!("all: bound {:.2} us, decaying {:.2} us", 1e6 * f64::sqrt(plain), 1e6 * f64::sqrt(decaying));
}

/// Wedges of Burgoyne 2016, section 5.3.2, and others: materials, degrees, amplitude in F_p of the first material. At 10 F_p of
/// 440c, which is published too, the uniform crystal of brass is beyond the contact law.
const WEDGES: [([&str; 2], f64, f64); 9] = [
    (["440c", "brass"], 60.0, 0.5),
    (["440c", "brass"], 60.0, 1.0),
    (["440c", "brass"], 60.0, 2.0),
    (["440c", "brass"], 60.0, 5.0),
    (["440c", "brass"], 30.0, 5.0),
    (["302", "brass"], 45.0, 2.0),
    (["al", "brass"], 45.0, 5.0),
    (["brass", "440c"], 15.0, 2.0),
    (["brass", "440c"], 30.0, 2.0),
];

/// Over all wedges, the angle in a wave that decays is nearer to the simulated one than Snell's at the bound.
#[test]
fn a_wave_that_decays_bends_nearer_to_the_simulated_angle() {
    let mut sums = [0.0; 3];
    for (names, degrees, amplitude) in WEDGES {
        let materials = names.map(material);
        let wedge = Wedge { materials, law: LawKind::Thesis, angle: degrees.to_radians(), amplitude };
        let simulated = wedge.bend(&GO).unwrap();
        let [bound, decaying] = wedge.predicted(&GO).unwrap();
        let angles = [wedge.snell(), bound, decaying];
        println!(
            "{} to {}, {degrees} deg, {amplitude} F_p: simulated {:.2}, Snell {:.2}, eikonal {:.2}, decaying {:.2} deg",
            names[0],
            names[1],
            simulated.to_degrees(),
            angles[0].to_degrees(),
            bound.to_degrees(),
            decaying.to_degrees()
        );
        for (sum, angle) in sums.iter_mut().zip(angles) {
            *sum += (angle - simulated).to_degrees().powi(2) / WEDGES.len() as f64;
        }
    }
    let [snell, bound, decaying] = sums.map(f64::sqrt);
    println!("rms: Snell {snell:.2}, eikonal {bound:.2}, decaying {decaying:.2} deg");
    assert!(decaying < 0.75 * snell, "{decaying} {snell}");
}

/// A material of the same wave speed and `times` the impedance: density, modulus and yield stress grow alike.
fn with_impedance(of: Material, times: f64) -> Material {
    Material {
        density: of.density * times,
        youngs_modulus: of.youngs_modulus * times,
        yield_stress: of.yield_stress * times,
        ..of
    }
}

/// It is not the impedances that decide where a wave that decays is nearer than the bound: 440c and brass stay on that side when brass is made so
/// light that they differ 2.1 times, aluminium and brass on the other when they differ 1.5 times only, less than 440c and brass do.
#[test]
fn the_impedance_ratio_does_not_decide_where_decay_holds() {
    for (names, times, degrees, ratio, nearer) in [
        (["440c", "brass"], [1.0, 0.72], 45.0_f64, 2.12, true),
        (["brass", "440c"], [0.72, 1.0], 25.0, 2.12, true),
        (["al", "brass"], [1.0, 0.66], 45.0, 1.50, false),
        (["brass", "al"], [0.66, 1.0], 30.0, 1.50, false),
    ] {
        let materials = [0, 1].map(|k| with_impedance(material(names[k]), times[k]));
        let wedge = Wedge { materials, law: LawKind::Thesis, angle: degrees.to_radians(), amplitude: 2.0 };
        let densities = wedge.materials.each_ref().map(|material| material.density);
        let impedances = densities[1] / densities[0] * wedge.speed_ratio();
        assert!((impedances.max(1.0 / impedances) - ratio).abs() < 0.01, "{names:?} {impedances}");
        let simulated = wedge.bend(&GO).unwrap();
        let [_, decaying] = wedge.predicted(&GO).unwrap();
        let [at_bound, off] = [wedge.snell(), decaying].map(|angle| (angle - simulated).abs().to_degrees());
        println!(
            "{names:?} {ratio}: simulated {:.2}, Snell off {at_bound:.2}, decaying off {off:.2} deg",
            simulated.to_degrees()
        );
        assert_eq!(off < at_bound, nearer, "{names:?}: {off} {at_bound}");
    }
}
