//! How well arrivals behind lenses are predicted, by the plain bound and by a wave that decays.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use granulens::design::Design;
use granulens::evaluate::{Overrides, Plan, calibrate, evaluate};
use granulens::lens::propose;

/// Deviations of arrivals on the axis, rows 15 to 46, from those simulated (rms, s): by the plain bound, and in a wave
/// calibrated on the two uniform crystals.
fn deviations(design: &str) -> [f64; 2] {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("designs").join(design);
    let design = Design::read(&path).unwrap();
    let request = design.lens.as_ref().unwrap();
    let lens = propose(&design.lattice, &design.host, request, &design.target, design.constants).unwrap();
    let plan = Plan::new(&design, Overrides::default(), &lens.palette).unwrap();
    let go = AtomicBool::new(false);
    let decays = calibrate(&design, &plan, &lens.palette, &go).unwrap();
    let decays: Vec<_> = decays.into_iter().map(Option::unwrap).collect();
    let record = evaluate(&design, &lens.layout(), &plan, &go).unwrap().record;
    let optics = lens.optics();
    let (mut plain, mut decaying) = (0.0, 0.0);
    for row in 15..=46 {
        let depth = design.lattice.depth(f64::from(row));
        let simulated = record.arrival[design.lattice.index(row, 1).unwrap()].unwrap();
        let bound = optics.trace(0.0).path.at_depth(depth).unwrap().1;
        let decayed = lens.arrival_decaying(&decays, 0.0, depth).unwrap();
        plain += (simulated - bound).powi(2);
        decaying += (simulated - decayed).powi(2);
    }
    [plain, decaying].map(|sum: f64| (sum / 32.0).sqrt())
}

/// For single lenses the wave that decays is nearer to the simulation than the plain bound; nothing of these lenses enters its
/// calibration. Of two stages it is not (4.9 against 4.5 us): the second refracts a wave whose amplitude is already off.
#[test]
fn a_wave_that_decays_arrives_nearer_to_the_simulated_time() {
    for design in ["gallery/plano-convex.toml", "gallery/aspheric-back.toml", "gallery/biconvex.toml"] {
        let [plain, decaying] = deviations(design);
        println!("{design}: plain bound {:.2} us, decaying {:.2} us", 1e6 * plain, 1e6 * decaying);
        assert!(decaying < 0.8 * plain, "{design}: {decaying} {plain}");
    }
}
