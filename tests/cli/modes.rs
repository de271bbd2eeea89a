//! `granulens modes`: small vibrations of a squeezed rig.

use super::{Desk, shipped};

/// The shipped chain of steel and aluminium: two bands with the gap of the closed form between them, √(2K/m₁) to √(2K/m₂); drawn, and as a table in which
/// nothing passes the gap. What is not squeezed, and what cannot be written, is said.
#[test]
fn a_squeezed_chain_of_two_metals_has_a_gap() {
    let desk = Desk::new();
    let rig = shipped("designs/squeezed-dimer.toml");
    let rig = rig.as_str();
    let json = desk.run(&["modes", rig, "--json", "--out", "modes.csv"]).ok().json();
    let found: Vec<f64> = json["frequencies_Hz"].as_array().unwrap().iter().map(|f| f.as_f64().unwrap()).collect();
    assert_eq!((found.len(), json["unstable"].as_u64()), (80, Some(0)));
    let [steel, aluminium] = ["440c", "al"].map(|name| granulens::material::find(name, &[]).unwrap());
    let pair = granulens::contact::Pair::new([&steel, &aluminium], [5e-3; 2], granulens::contact::Constants::Code);
    let stiffness = 1.5 * pair.hertz_coefficient().powf(2.0 / 3.0) * 80_f64.powf(1.0 / 3.0);
    let edge = |mass: f64| (2.0 * stiffness / mass).sqrt() / std::f64::consts::TAU;
    let [low, high] = [edge(steel.sphere_mass(0.01)), edge(aluminium.sphere_mass(0.01))];
    // Of a finite chain one mode may sit at an end, within the gap; the bands end at their edges.
    let within = found.iter().filter(|f| (1.001 * low..0.999 * high).contains(*f)).count();
    assert!(within <= 1, "{within} of {found:?} between {low} and {high}");
    assert!(found.iter().any(|f| (0.98 * low..1.001 * low).contains(f)), "{low}: {found:?}");
    let table = desk.read("modes.csv");
    let rows: Vec<[f64; 2]> = (table.lines().skip(1))
        .map(|line| {
            let (f, part) = line.split_once(',').unwrap();
            [f.parse().unwrap(), part.parse().unwrap()]
        })
        .collect();
    assert_eq!((table.lines().next(), rows.len()), (Some("frequency_Hz,transmission"), 400));
    let middle = 0.5 * (low + high);
    let passes = rows.iter().find(|row| row[0] > middle).unwrap()[1];
    assert!(passes < 1e-6, "{passes}");
    let text = desk.run(&["modes", rig, "--out", "modes.svg"]).ok();
    assert!(text.stdout.contains("no mode from (Hz)") && text.stderr.contains("squeezed to rest"), "{}", text.stdout);
    assert!(desk.read("modes.svg").contains("transmission (dB)"));
    let refused = desk.run(&["modes", rig, "--out", "modes.bmp"]);
    assert!(
        refused.code == 2 && refused.stderr.contains(".svg, .pdf, .png or .csv"),
        "{} {}",
        refused.code,
        refused.stderr
    );
}
