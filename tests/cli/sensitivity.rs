//! How scores change with every sphere.

use serde_json::Value;

use super::{Desk, SMALL};

fn told(desk: &Desk, more: &[&str]) -> Value {
    desk.run(&[&["sensitivity", "small.csv", "--design", "small.toml", "--json"], more].concat()).ok().json()
}

#[test]
fn sensitivities_are_of_what_check_says_and_the_ratios_of_those_of_their_parts() {
    let desk = Desk::with_layout();
    let told = told(&desk, &["--of", "focal_mean,protected_mean,contrast,focal_gain"]);
    let checked = desk.run(&["check", "small.csv", "--design", "small.toml", "--json"]).ok().json();
    for key in ["focal_mean_J", "protected_mean_J", "step_s", "window_s", "law", "integrator"] {
        assert_eq!(told[key], checked[key], "{key}");
    }
    let of = |which: usize, key: &str, site: usize| told["sensitivities"][which][key][site].as_f64().unwrap();
    let sites = told["sites"].as_array().unwrap().len();
    for key in ["d_density", "d_youngs_modulus", "d_yield_stress", "d_radius", "secant_density"] {
        for site in 0..sites {
            let [focal, protected, contrast, gain] = [0, 1, 2, 3].map(|which| of(which, key, site));
            assert!((focal - protected - contrast).abs() <= 1e-12 * (focal.abs() + protected.abs()), "{key}, {site}");
            assert_eq!(focal, gain, "G is F over that of another crystal");
        }
    }
    let matters = (0..sites).any(|site| of(0, "d_density", site).abs() > 0.01);
    assert!(matters, "a wave comes through spheres");
}

/// Over a window in which each sphere is met once nothing has become chaotic: secants and derivatives say the same.
#[test]
fn derivatives_hold_over_a_hundredth_while_the_wave_passes_once() {
    let desk = Desk::with_layout();
    let told = told(&desk, &["--of", "focal_mean", "--window", "45 us"]);
    let share = told["sensitivities"][0]["linear_share"].as_f64().unwrap();
    assert!(share > 0.9, "linear at {share} of the spheres");
}

#[test]
fn the_table_has_a_line_for_each_sphere_and_measure() {
    let desk = Desk::with_layout();
    let of = "focal_mean,contrast";
    desk.run(&["sensitivity", "small.csv", "--design", "small.toml", "--of", of, "--out", "d.csv"]).ok();
    let text = desk.read("d.csv");
    let mut lines = text.lines();
    assert_eq!(
        lines.next(),
        Some(
            "row,column,x,z,material,measure,d_density,d_youngs_modulus,d_yield_stress,d_radius,secant_density,linear"
        )
    );
    let layout = desk.read("small.csv");
    let sites = layout.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit())).count();
    assert_eq!(lines.clone().count(), 2 * sites);
    assert!(lines.all(|line| line.split(',').count() == 12 && (line.ends_with("true") || line.ends_with("false"))));
}

/// With friction too: F and P are those of `check`, derivatives are others than without, and while a wave passes once they hold over a hundredth.
#[test]
fn friction_has_derivatives() {
    let desk = Desk::with_layout();
    desk.write("rubbing.toml", SMALL.replace("sides =", "friction = 0.2\nsides ="));
    let with = |design: &str| {
        let of = ["sensitivity", "small.csv", "--design", design, "--json", "--of", "focal_mean", "--window", "45 us"];
        desk.run(&of).ok().json()
    };
    let (rubbing, plain) = (with("rubbing.toml"), with("small.toml"));
    let checked =
        desk.run(&["check", "small.csv", "--design", "rubbing.toml", "--window", "45 us", "--json"]).ok().json();
    assert_eq!(rubbing["focal_mean_J"], checked["focal_mean_J"]);
    assert_eq!((&rubbing["integrator"], &plain["integrator"]), (&"verlet".into(), &"adams".into()));
    let slopes = |told: &Value| -> Vec<f64> {
        let list = told["sensitivities"][0]["d_density"].as_array().unwrap();
        list.iter().map(|slope| slope.as_f64().unwrap()).collect()
    };
    let (rubbing_by, plain_by) = (slopes(&rubbing), slopes(&plain));
    assert!(rubbing_by.iter().zip(&plain_by).any(|(a, b)| (a - b).abs() > 0.01), "friction changes nothing");
    let share = rubbing["sensitivities"][0]["linear_share"].as_f64().unwrap();
    assert!(share > 0.9, "linear at {share} of the spheres");
}

/// A report's maps and table are those numbers: the same text, and a mark on each sphere at which derivative and secant differ, in each panel of the half
/// and once in the legend.
#[test]
fn a_report_draws_what_the_command_says() {
    let desk = Desk::with_layout();
    desk.run(&["report", "small.toml", "small.csv", "--sensitivity", "--out", "report"]).ok();
    let of = "focal_mean,protected_mean";
    desk.run(&["sensitivity", "small.csv", "--design", "small.toml", "--of", of, "--out", "d.csv"]).ok();
    assert_eq!(desk.read("report/sensitivity.csv"), desk.read("d.csv"));
    let outcome: Value = serde_json::from_str(&desk.read("report/outcome.json")).unwrap();
    let page = desk.read("report/report.html");
    for (which, name, panels) in [(0, "focal", 4), (1, "protected", 2)] {
        let one = &outcome["sensitivities"][which];
        let other = one["linear"].as_array().unwrap().iter().filter(|linear| **linear == false).count();
        let svg = desk.read(&format!("report/sensitivity-{name}.svg"));
        assert_eq!(svg.matches("<circle").count(), panels * other + 1, "{name}");
        assert!(other > 0, "nothing is marked in {name}");
        let share = format!("at {:.0} % of the spheres that matter", 100.0 * one["linear_share"].as_f64().unwrap());
        assert!(svg.contains(&share) && page.contains(&share), "{share}");
    }
    // Drawn anew from its numbers alone, without a simulation, to the same bytes.
    desk.run(&["report", "report", "--out", "anew"]).ok();
    for file in ["sensitivity.csv", "sensitivity-focal.svg", "sensitivity-protected.svg"] {
        assert_eq!(desk.read(&format!("anew/{file}")), desk.read(&format!("report/{file}")), "{file}");
    }
    let ran = desk.run(&["report", "report", "--sensitivity", "--out", "again"]);
    assert!(ran.code == 2 && ran.stderr.contains("nothing is simulated"), "{}", ran.stderr);
    // A run without them has none of it.
    desk.run(&["report", "small.toml", "small.csv", "--out", "plain"]).ok();
    assert!(!desk.path("plain/sensitivity.csv").exists() && !desk.read("plain/outcome.json").contains("sensitivities"));
}

#[test]
fn what_has_no_derivative_is_refused_in_words() {
    let desk = Desk::with_layout();
    desk.write("short.toml", SMALL.replace("duration = \"20 us\"", "duration = \"2 us\""));
    for (more, words) in [
        (["--design", "small.toml", "--integrator", "rk4"], "adams and verlet"),
        (["--design", "small.toml", "--of", "half_mass"], "there are derivatives of"),
        (["--design", "short.toml", "--window", "3 us"], "zero within this window"),
    ] {
        let ran = desk.run(&[&["sensitivity", "small.csv", "--json"], &more[..]].concat());
        assert_eq!(ran.code, 2, "{}", ran.stderr);
        assert!(ran.stderr.contains(words), "{}", ran.stderr);
    }
}
