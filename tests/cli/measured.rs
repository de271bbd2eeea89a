//! Measurements drawn on predictions: synthetic data whose answer is known, with noise.

use super::Desk;

/// A chain of ten spheres that is struck, and a wall behind it.
const CHAIN: &str = r#"format = 1
kind = "rig"
name = "chain"
[crystal]
packing = "chain"
diameter = "6.35 mm"
layers = 10
material = "brass-260"
[sides]
z = ["free", "wall"]
[[load]]
kind = "force"
layers = 1
pulse = "half-sine"
peak = "PEAK"
duration = "20 us"
[run]
window = "150 us"
[record]
every = "0.5 us"
"#;

/// Numbers from −√3 to √3 of variance one, by a multiplicative congruence.
fn noise(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5) * 12.0_f64.sqrt()
    }
}

/// What an instrument would have seen of a chain struck with `peak`: the force on the wall and the velocity of sphere 5, every third
/// sample, on a clock that is late by `late` (s), with noise of 2 % of each peak.
fn synthetic(desk: &Desk, name: &str, peak: &str, late: f64, seed: u64) {
    desk.write(&format!("{name}.toml"), CHAIN.replace("PEAK", peak));
    desk.run(&["simulate", &format!("{name}.toml"), "--out", name]).ok();
    let read = |file: &str| -> Vec<Vec<String>> {
        let text = desk.read(&format!("{name}/{file}"));
        text.lines().map(|line| line.split(',').map(str::to_owned).collect()).collect()
    };
    let (flats, spheres) = (read("flats.csv"), read("spheres.csv"));
    let column = |rows: &[Vec<String>], name: &str| rows[0].iter().position(|head| head == name).unwrap();
    let force = column(&flats, "z-high_force_N");
    let (sphere, velocity) = (column(&spheres, "sphere"), column(&spheres, "vz_m_s"));
    let fifth: Vec<f64> =
        spheres[1..].iter().filter(|row| row[sphere] == "5").map(|row| row[velocity].parse().unwrap()).collect();
    let forces: Vec<f64> = flats[1..].iter().map(|row| row[force].parse().unwrap()).collect();
    let times: Vec<f64> = flats[1..].iter().map(|row| row[0].parse().unwrap()).collect();
    let most = |values: &[f64]| values.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
    let (scale_f, scale_v) = (0.02 * most(&forces), 0.02 * most(&fifth));
    let mut draw = noise(seed);
    let mut text = "time_s,z-high_force_N,sphere_5_1_vz_m_s\n".to_owned();
    for k in (0..times.len()).step_by(3) {
        let (f, v) = (forces[k] + scale_f * draw(), fifth[k] + scale_v * draw());
        // Every tenth velocity is missing.
        let v = if k % 30 == 0 { String::new() } else { v.to_string() };
        text += &format!("{},{f},{v}\n", times[k] + late);
    }
    desk.write(&format!("{name}.csv"), text);
}

/// Data made at 1.2 times the amplitude and late by 37 us, with 2 % noise: amplitude and yield stress lie in their intervals, which are
/// tight, and the clock is found to a fraction of a sample.
#[test]
fn known_inputs_are_found_again() {
    let desk = Desk::new();
    desk.write("chain.toml", CHAIN.replace("PEAK", "5 kN"));
    synthetic(&desk, "truth", "6 kN", 37e-6, 7);
    let plain = desk.run(&["measured", "truth.csv", "--rig", "chain.toml", "--out", "plain", "--json"]).ok().json();
    assert!(plain["fit"].is_null());
    let ran = [
        "measured",
        "truth.csv",
        "--rig",
        "chain.toml",
        "--fit",
        "amplitude,yield_stress",
        "--out",
        "fitted",
        "--json",
    ];
    let told = desk.run(&ran).ok().json();
    let fit = &told["fit"];
    for (k, truth) in [(0, 1.2), (1, 1.0)] {
        let [value, interval] = ["value", "interval"].map(|key| fit["inputs"][k][key].as_f64().unwrap());
        // Twice the 95 % interval: one draw of noise in a few ten thousand lies beyond.
        assert!((value - truth).abs() < 2.0 * interval && interval < 0.05 * truth, "{}", fit["inputs"]);
    }
    let offset = fit["offset_s"].as_f64().unwrap();
    assert!((offset - 37e-6).abs() < 0.2e-6, "{offset}");
    // What is left is the noise: 2 % of the peaks, and it does not hang together.
    for record in fit["compared"]["records"].as_array().unwrap() {
        let [rms, neighbours] = ["rms_over_peak", "neighbours"].map(|key| record[key].as_f64().unwrap());
        assert!((0.015..0.025).contains(&rms) && neighbours.abs() < 0.4, "{record}");
        let before = plain["compared"]["records"]
            .as_array()
            .unwrap()
            .iter()
            .find(|other| other["name"] == record["name"])
            .unwrap();
        assert!(before["rms_over_peak"].as_f64().unwrap() > 3.0 * rms, "{before}");
    }
    assert_eq!(super::names(&desk.path("fitted")), ["curves.csv", "manifest.json", "measured.json", "report.html"]);
    let page = desk.read("fitted/report.html");
    assert!(page.contains("z-high_force_N") && page.matches("<svg").count() == 4);
}

/// Without noise and at the file's own inputs nothing is left over but what thinning and interpolation lose.
#[test]
fn the_prediction_lies_on_itself() {
    let desk = Desk::new();
    desk.write("chain.toml", CHAIN.replace("PEAK", "5 kN"));
    desk.run(&["simulate", "chain.toml", "--out", "run"]).ok();
    let text = desk.read("run/flats.csv");
    let rows: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
    let force = rows[0].iter().position(|head| *head == "z-high_force_N").unwrap();
    desk.write("data.csv", rows.iter().map(|row| format!("{},{}\n", row[0], row[force])).collect::<String>());
    let told = desk.run(&["measured", "data.csv", "--rig", "chain.toml", "--offset", "0 s", "--json"]).ok().json();
    for record in
        told["compared"]["records"].as_array().unwrap().iter().filter(|record| record["name"] == "z-high_force_N")
    {
        assert!(record["rms_over_peak"].as_f64().unwrap() < 1e-3, "{record}");
        let [measured, predicted] = ["measured", "predicted"].map(|key| record[key]["arrival_s"].as_f64().unwrap());
        assert!((measured - predicted).abs() < 0.1e-6);
    }
}

#[test]
fn what_is_wrong_with_data_is_said() {
    let desk = Desk::new();
    desk.write("chain.toml", CHAIN.replace("PEAK", "5 kN"));
    let good: String = (0..20).map(|k| format!("{}e-6,{}\n", k, k + 1)).collect();
    for (text, more, says) in [
        (format!("t,z-high_force_N\n{good}"), "", "expected \"time_s\""),
        (format!("time_s,z-high_force_kN\n{good}"), "", "is no record of this rig; there are z-high_force_N"),
        (format!("time_s,sphere_11_1_vz_m_s\n{good}"), "", "is no record of this rig"),
        (format!("time_s,z-high_force_N\n{good}3e-6,1\n"), "", "is not after the time before it"),
        (format!("time_s,z-high_force_N\n{good}1,x\n"), "", "is not a number"),
        ("time_s,z-high_force_N\n0,1\n1,2\n".to_owned(), "", "has 2 values"),
        (format!("time_s,z-high_force_N\n{good}"), "colour", "is no input to fit"),
        (format!("time_s,z-high_force_N\n{good}"), "yield_stress:gold", "the rig holds no gold, but brass-260"),
        (format!("time_s,z-high_force_N\n{good}"), "amplitude,amplitude", "asked for twice"),
    ] {
        desk.write("bad.csv", text);
        let mut arguments = vec!["measured", "bad.csv", "--rig", "chain.toml", "--out", "no"];
        if !more.is_empty() {
            arguments.extend(["--fit", more]);
        }
        let refused = desk.run(&arguments);
        assert_eq!((refused.code, refused.stderr.contains(says)), (2, true), "{says}: {}", refused.stderr);
        assert!(!desk.path("no").exists());
    }
}
