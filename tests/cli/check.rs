//! `check`: one layout under a design's impact.

use super::{Desk, keys, shipped};

/// What scripts rely on.
const PROMISED: [&str; 16] = [
    "focal_mean_J",
    "protected_mean_J",
    "contrast",
    "work_in_J",
    "kinetic_J",
    "stored_J",
    "dissipated_J",
    "residual",
    "eq_5_6_J",
    "step_s",
    "steps",
    "window_s",
    "law",
    "seconds",
    "warnings",
    "format",
];

const CHECK: [&str; 4] = ["check", "small.csv", "--design", "small.toml"];

#[test]
fn json_has_every_promised_key() {
    let desk = Desk::with_layout();
    let ran = desk.run(&[&CHECK[..], &["--json"]].concat()).ok();
    let json = ran.json();
    for key in PROMISED {
        assert!(keys(&json).contains(&key), "{key}");
    }
    let number = |key: &str| json[key].as_f64().unwrap_or_else(|| panic!("{key}"));
    assert!((number("contrast") - number("focal_mean_J") / number("protected_mean_J")).abs() < 1e-12);
    let spent = number("kinetic_J") + number("stored_J") + number("dissipated_J");
    let residual = (number("work_in_J") - spent) / number("work_in_J");
    assert!((number("residual") - residual).abs() < 1e-12 && residual.abs() < 2e-4);
    assert!((number("step_s") * number("steps") / number("window_s") - 1.0).abs() < 1e-2);
    assert_eq!((&json["law"], &json["stop"]), (&"thesis".into(), &serde_json::Value::Null));
    assert_eq!(ran.stderr, "", "with --json, warnings are in the object");

    let ran = desk.run(&[&CHECK[..], &["--out", "numbers.json", "--quiet"]].concat()).ok();
    assert!(ran.stdout.contains("focal mean F") && ran.stderr.is_empty());
    let stored = desk.json("numbers.json");
    assert!(PROMISED.iter().filter(|&&key| key != "seconds").all(|key| stored[key] == json[key]));
}

/// The figures of the published problem are asserted in `tests/physics`; here, that the program gives them.
#[test]
fn the_lens_problem_takes_in_734_joules() {
    let desk = Desk::new();
    let [layout, design] = ["designs/thesis-lens.csv", "designs/thesis-lens.toml"].map(shipped);
    let json = desk.run(&["check", &layout, "--design", &design, "--window", "60 us", "--json"]).ok().json();
    assert!((json["work_in_J"].as_f64().unwrap() - 734.0).abs() < 1.0);
    assert!(json["contrast"].is_null(), "the protected region is not reached within 60 us");
    let warnings = json["warnings"].to_string();
    assert!(warnings.contains("the window ends before the wave reaches"), "{warnings}");
    let text = desk.run(&["check", &layout, "--design", &design, "--window", "60 us"]).ok();
    assert!(text.stdout.contains("contrast F/P       -"), "{}", text.stdout);
    assert!(
        text.stdout.contains("focal gain G       ") && text.stdout.contains("protection Q       "),
        "{}",
        text.stdout
    );
    assert!(text.stderr.contains("warning: ") && !text.stdout.contains("warning: "));
}

#[test]
fn every_design_that_ships_is_checked_briefly() {
    let desk = Desk::new();
    let folder = |folder: &str| super::names(std::path::Path::new(&shipped(&format!("designs/{folder}"))));
    let gallery = folder("gallery").into_iter().map(|name| format!("gallery/{name}"));
    // One for each family, and one for several foci.
    assert_eq!(gallery.len(), granulens::lens::Family::ALL.len() + 1);
    for name in folder("").into_iter().chain(gallery) {
        let Some(stem) = name.strip_suffix(".toml") else { continue };
        let design = shipped(&format!("designs/{name}"));
        // Rigs and beds are no lens designs.
        let text = std::fs::read_to_string(&design).unwrap();
        if ["kind = \"rig\"", "kind = \"bed\""].iter().any(|kind| text.contains(kind)) {
            continue;
        }
        desk.run(&["design", &design, "--out", "proposed.csv", "--quiet"]).ok();
        let layout = shipped(&format!("designs/{stem}.csv"));
        let layouts = ["proposed.csv".to_owned(), layout];
        for layout in layouts.iter().filter(|layout| desk.path(layout).exists()) {
            let json = desk.run(&["check", layout, "--design", &design, "--window", "40 us", "--json"]).ok().json();
            assert!(json["work_in_J"].as_f64().unwrap() > 0.0, "{name}");
        }
    }
}

#[test]
fn spheres_are_written_as_csv() {
    let desk = Desk::new();
    let [layout, design] = ["designs/thesis-lens.csv", "designs/thesis-lens.toml"].map(shipped);
    let check = ["check", &layout, "--design", &design, "--spheres", "spheres.csv", "--window", "40 us", "--quiet"];
    desk.run(&check).ok();
    let text = desk.read("spheres.csv");
    let mut lines = text.lines();
    let header = "row,column,x,z,material,max_kinetic_J,max_net_force_N,max_contact_force_N,arrival_s,dissipated_J";
    assert_eq!(lines.next(), Some(header));
    let rows: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
    assert_eq!(rows.len(), 850);
    assert!(rows.iter().all(|row| row.len() == 10));
    assert_eq!(rows[0][..5], ["1", "1", "0", "0", "stainless-440c"]);
    assert!(rows[0][8].parse::<f64>().unwrap() > 0.0);
    assert_eq!(rows[849][8], "", "the last row has not moved after 40 us");
}

#[test]
fn step_window_and_integrator_can_be_set() {
    let desk = Desk::with_layout();
    let check = |more: &[&str]| desk.run(&[&CHECK[..], &["--json"], more].concat()).ok().json();
    let json = check(&["--step", "5e-8 s", "--window", "50 us", "--integrator", "rk4"]);
    assert_eq!((json["step_s"].as_f64(), json["window_s"].as_f64()), (Some(5e-8), Some(5e-5)));
    assert_eq!((json["steps"].as_u64(), &json["integrator"]), (Some(1000), &"rk4".into()));
    let verlet = check(&["--step", "5e-8 s", "--window", "50 us", "--integrator", "verlet"]);
    let [a, b] = [&json, &verlet].map(|json| json["kinetic_J"].as_f64().unwrap());
    assert!(a != b && (a / b - 1.0).abs() < 1e-3, "{a} and {b} J");

    let coarse = check(&["--step", "3e-7 s"])["warnings"].to_string();
    assert!(coarse.contains("a step of 300 ns misses the 0.1 % class, which asks for"), "{coarse}");
    let said = desk.run(&[&CHECK[..], &["--step", "3e-7 s"]].concat()).ok().stderr;
    assert!(said.contains("warning: a step of 300 ns misses"), "{said}");
}

#[test]
fn steps_and_windows_with_which_nothing_can_be_simulated() {
    let desk = Desk::with_layout();
    desk.design_with("step.toml", "[run]", "[run]\nstep = \"2 us\"");
    desk.design_with("window.toml", "window = \"100 us\"", "window = \"5 us\"");
    let calls: [&[&str]; 7] = [
        &["check", "small.csv", "--design", "small.toml", "--step", "2 us"],
        &["check", "small.csv", "--design", "step.toml"],
        &["check", "small.csv", "--design", "small.toml", "--window", "5 us"],
        &["compare", "window.toml"],
        &["run", "small.toml", "--step", "0 s"],
        &["run", "small.toml", "--step", "5e-8"],
        &["run", "small.toml", "--window", "NaN us"],
    ];
    let heard = calls.map(|call| {
        let ran = desk.run(call);
        assert_eq!((ran.code, ran.stdout.as_str()), (2, ""), "{call:?}");
        format!("$ granulens {}\n{}\n", call.join(" "), ran.stderr)
    });
    insta::assert_snapshot!(heard.concat());
    let json = desk.run(&["compare", "step.toml", "--json"]).json_error();
    assert_eq!((&json["key"], &json["file"]), (&"run.step".into(), &"step.toml".into()));
    let line =
        std::iter::zip(1.., desk.read("step.toml").lines()).find(|(_, line)| line.starts_with("step")).unwrap().0;
    assert_eq!(json["line"], line);
    assert!(!desk.path("reports").exists());
}

#[test]
fn a_guard_stops_an_absurd_impact() {
    let desk = Desk::with_layout();
    desk.design_with("absurd.toml", "16 kN", "5000 kN");
    let check = ["check", "small.csv", "--design", "absurd.toml"];
    let text = desk.run(&check);
    assert_eq!(text.code, 1);
    assert!(text.stdout.contains("focal mean F"), "what was computed is shown");
    let failed = text.stderr.lines().last().unwrap();
    assert!(failed.starts_with("failed: spheres ") && failed.contains("beyond the contact law's range"), "{failed}");
    let json = desk.run(&[&check[..], &["--json"]].concat());
    assert_eq!((json.code, &json.json()["stop"]["guard"]), (1, &"overlap".into()));
    assert_eq!(json.json_error()["kind"], "guard");

    let run = desk.run(&["run", "absurd.toml", "--out", "absurd", "--json"]);
    assert_eq!(run.code, 1);
    let words = run.json_error()["message"].to_string();
    // Twice if brass, which is heavier, is driven together a little less far.
    assert!(words.matches(" overlap by ").count() <= 2, "one reason is said once: {words}");
    assert!(run.json()["warnings"].to_string().contains("FAILED"));
    assert!(desk.path("absurd/report.html").exists(), "a failed run has its report too");
}

#[test]
fn strict_asks_for_the_thresholds() {
    let desk = Desk::with_layout();
    let thresholds = |name: &str, text: &str| desk.write(name, format!("{}[thresholds]\n{text}\n", super::SMALL));
    thresholds("met.toml", "contrast = { min = 0.01 }\nfocal_gain = { min = 0.01 }");
    thresholds("missed.toml", "contrast = { min = 50 }\nprotection = { max = 1e-6 }");
    let check = |design: &str, more: &[&str]| desk.run(&[&["check", "small.csv", "--design", design], more].concat());
    let met = check("met.toml", &["--strict", "--json"]).ok().json();
    assert!(met["focal_gain"].as_f64().is_some(), "a threshold's baseline is simulated");
    // Without --strict they are told, and the code is 0; all five scores are there either way.
    let told = check("missed.toml", &["--json"]).ok().json();
    let thresholds = told["thresholds"].as_array().unwrap();
    assert!(thresholds.len() == 2 && thresholds.iter().all(|asked| asked["met"] == false), "{thresholds:?}");
    assert!(["contrast", "focal_gain", "protection"].iter().all(|key| told[*key].is_f64()), "{told}");
    assert!(check("missed.toml", &[]).ok().stdout.contains("threshold MISSED   contrast = "));
    let missed = check("missed.toml", &["--strict", "--quiet"]);
    assert_eq!(missed.code, 3);
    assert_eq!(missed.stderr.lines().filter(|line| line.starts_with("threshold not met: ")).count(), 2);
    assert!(missed.stdout.contains("contrast F/P"), "the numbers are shown all the same");
    let json = check("missed.toml", &["--strict", "--json"]);
    assert_eq!((json.code, &json.json_error()["kind"]), (3, &"threshold".into()));
    // Aluminium alone gives way under this impact: nothing is left to measure protection by.
    let soft = |text: &str| text.replace("brass-260", "aluminium-2017").replace("16 kN", "26 kN");
    desk.write("soft.toml", soft(&desk.read("missed.toml")));
    desk.write("soft.csv", soft(&desk.read("small.csv")));
    let gone = desk.run(&["check", "soft.csv", "--design", "soft.toml", "--strict"]);
    assert_eq!(gone.code, 3, "{}", gone.stderr);
    assert!(gone.stderr.contains("warning: FAILED: all-lens: spheres"), "{}", gone.stderr);
    assert!(gone.stderr.contains("protection has no value here"), "{}", gone.stderr);
    let compared = desk.run(&["compare", "soft.toml", "--json"]);
    assert_eq!(
        (compared.code, &compared.json()["arrangements"][0]["scores"]["protection"]),
        (1, &serde_json::Value::Null)
    );
    let nothing = check("small.toml", &["--strict"]).ok();
    assert!(nothing.stderr.contains("sets no [thresholds]"), "{}", nothing.stderr);
}

/// Under other laws the same layout has other scores; the range holds them all, and the design's own law gives those of the check itself.
#[test]
fn scores_have_a_range_over_laws() {
    let desk = Desk::with_layout();
    let json = desk.run(&[&CHECK[..], &["--laws", "thesis,mdr-static,thornton", "--json"]].concat()).ok().json();
    let each = json["laws"]["each"].as_array().unwrap();
    assert_eq!(
        each.iter().map(|one| one["law"].as_str().unwrap()).collect::<Vec<_>>(),
        ["thesis", "mdr-static", "thornton"]
    );
    assert_eq!(each[0]["contrast"], json["contrast"]);
    for measure in ["contrast", "focal_gain", "protection"] {
        let values: Vec<f64> = each.iter().map(|one| one[measure].as_f64().unwrap()).collect();
        let [low, high] = [0, 1].map(|end| json["laws"]["range"][measure][end].as_f64().unwrap());
        assert!(values.iter().all(|value| (low..=high).contains(value)) && low < high, "{measure}: {values:?}");
    }
    let text = desk.run(&[&CHECK[..], &["--laws", "thesis,mdr-static"]].concat()).ok().stdout;
    assert!(text.contains("under the law") && text.contains("greatest"), "{text}");
    let wrong = desk.run(&[&CHECK[..], &["--laws", "herz"]].concat());
    assert!(wrong.code == 2 && wrong.stderr.contains("unknown contact law"), "{}", wrong.stderr);
}
