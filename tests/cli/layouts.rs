//! Layout files: what is written can be read and edited, and what is wrong is said with its line.

use granulens::Context;
use granulens::evaluate::{Overrides, Plan, Subject};
use granulens::score::Measure;

use super::Desk;

const HEADER: &str = "row,column,x,z,diameter,material\n";

#[test]
fn a_proposed_layout_is_read_back() {
    let desk = Desk::with_layout();
    let text = desk.read("small.csv");
    assert!(text.starts_with("# granulens layout, format 1;") && text.contains(HEADER));
    assert_eq!(text.lines().filter(|line| !line.starts_with('#')).count(), 61);
    assert_eq!(desk.run(&["design", "small.toml"]).ok().stdout, text);

    let check = |name: &str| desk.run(&["check", name, "--design", "small.toml", "--json"]).ok().json();
    let as_written = check("small.csv");
    // A spreadsheet's copy: byte order mark, CRLF, aliases and quotes, other rows first, fewer digits.
    let mut rows: Vec<String> = text.lines().filter(|line| !line.starts_with('#')).skip(1).map(str::to_owned).collect();
    rows.reverse();
    let spreadsheet = format!("\u{feff}{HEADER}{}\n", rows.join("\n"))
        .replace("brass-260", "\"brass\"")
        .replace("0.019049999999999997", "0.01905")
        .replace('\n', "\r\n");
    desk.write("copy.csv", spreadsheet);
    let copied = check("copy.csv");
    for key in ["focal_mean_J", "protected_mean_J", "dissipated_J", "steps"] {
        assert_eq!(as_written[key], copied[key], "{key}");
    }
    // One sphere exchanged by hand, for a material that the design does not name.
    desk.write("edited.csv", text.replacen("brass-260", "302", 1));
    assert_ne!(check("edited.csv")["focal_mean_J"], as_written["focal_mean_J"]);
}

#[test]
fn the_whole_piece_has_both_halves() {
    let desk = Desk::new();
    desk.run(&["design", "small.toml", "--full", "--out", "full.csv"]).ok();
    let text = desk.read("full.csv");
    // Rows with a sphere on the axis hold 9, the others 10.
    assert_eq!(text.lines().filter(|line| !line.starts_with('#')).count(), 1 + 6 * 9 + 6 * 10);
    // It can be checked as it is, and so can the JSON of a run.
    desk.run(&["run", "small.toml", "--quiet", "--out", "results"]).ok();
    desk.run(&["design", "small.toml", "--out", "half.csv"]).ok();
    let check = |name: &str| desk.run(&["check", name, "--design", "small.toml", "--json"]).ok().json();
    let half = check("half.csv");
    for name in ["full.csv", "results/layout-full.csv", "results/layout.json", "results/layout.csv"] {
        let whole = check(name);
        for key in ["focal_mean_J", "protected_mean_J", "dissipated_J", "steps"] {
            assert_eq!(half[key], whole[key], "{name}: {key}");
        }
    }
    let short: String = text.lines().filter(|line| !line.starts_with("5,2,")).map(|line| format!("{line}\n")).collect();
    desk.write("short.csv", short);
    let refused = desk.run(&["check", "short.csv", "--design", "small.toml"]);
    assert!(refused.code == 2 && refused.stderr.contains("row 5, the sphere at x = -"), "{}", refused.stderr);
}

/// A piece with one sphere left of the axis that its image is not: simulated whole. Its mirror image does the same; the half does not.
#[test]
fn a_lopsided_piece_is_simulated_whole() {
    let desk = Desk::new();
    desk.run(&["design", "small.toml", "--full", "--out", "full.csv"]).ok();
    let text = desk.read("full.csv");
    let lopsided = text.replacen("stainless-440c", "brass-260", 1);
    desk.write("lopsided.csv", &lopsided);
    // Columns count from the left: 9 and 10 by turns.
    let mirrored = |line: &str| {
        let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
        let Ok(row) = cells[0].parse::<u32>() else { return format!("{line}\n") };
        let (column, x): (u32, f64) = (cells[1].parse().unwrap(), cells[2].parse().unwrap());
        (cells[1], cells[2]) = ((10 + u32::from(row % 2 == 0) - column).to_string(), (-x).to_string());
        cells.join(",") + "\n"
    };
    desk.write("mirrored.csv", lopsided.lines().map(mirrored).collect::<String>());
    let check = |name: &str| {
        let ran = desk
            .run(&["check", name, "--design", "small.toml", "--spheres", "felt.csv", "--out", "felt.json", "--force"])
            .ok();
        assert_eq!(ran.stderr.contains("simulated whole"), name != "full.csv", "{name}: {}", ran.stderr);
        (desk.json("felt.json"), desk.read("felt.csv"))
    };
    let [(even, half), (one, felt), (other, _)] = ["full.csv", "lopsided.csv", "mirrored.csv"].map(check);
    assert_eq!((half.lines().count(), felt.lines().count()), (1 + 60, 1 + 114));
    for key in ["focal_mean_J", "protected_mean_J", "contrast", "focal_gain", "dissipated_J", "work_in_J"] {
        let of = |json: &serde_json::Value| json[key].as_f64().unwrap();
        assert!((of(&one) / of(&other) - 1.0).abs() < 1e-9, "{key}: {} {}", of(&one), of(&other));
        assert_ne!(of(&one), of(&even), "{key}");
        assert!((of(&one) / of(&even) - 1.0).abs() < 0.2, "{key}: one sphere of row 1 does not change everything");
    }
    let brass = lopsided.lines().filter(|line| line.ends_with("brass-260")).count();
    assert_eq!(one["piece"]["counts"][1], brass);
    assert!(one["half"].is_null());
    let refused = desk.run(&["export", "lopsided.csv", "--design", "small.toml", "--xyz", "a.xyz"]);
    assert!(refused.code == 2 && refused.stderr.contains("not each other's images"), "{}", refused.stderr);
}

/// What takes a layout takes a piece whose halves differ, and says of it what `check` says.
#[test]
fn a_lopsided_piece_is_compared_reported_built_and_judged() {
    let desk = Desk::new();
    desk.run(&["design", "small.toml", "--full", "--out", "full.csv"]).ok();
    let lopsided = desk.read("full.csv").replacen("stainless-440c", "brass-260", 1);
    desk.write("lopsided.csv", &lopsided);
    let check = |more: &[&str]| {
        let ran = desk.run(&[&["check", "lopsided.csv", "--design", "small.toml", "--json"], more].concat());
        assert!(ran.code == 0 || ran.code == 3, "{}", ran.stderr);
        ran.json()
    };
    let checked = check(&["--forces", "8"]);

    let compared = desk.run(&["compare", "small.toml", "lopsided.csv", "--json"]).ok().json();
    let first = &compared["arrangements"][0];
    for key in ["focal_mean_J", "protected_mean_J", "contrast", "focal_gain", "protection", "dissipated_J"] {
        assert_eq!(first["scores"][key], checked[key], "{key}");
    }
    assert_eq!(first["over_forces"]["contrast_mean"], checked["contrast_mean"]);
    let judged = compared["verdict"].as_array().unwrap();
    let of = |measure: &str| judged.iter().find(|v| v["measure"] == measure).unwrap()["value"].as_f64().unwrap();
    assert!((of("contrast") / checked["contrast_mean"].as_f64().unwrap() - 1.0).abs() < 1e-12);

    let told = desk.run(&["diff", "full.csv", "lopsided.csv", "--design", "small.toml", "--json"]).ok().json();
    assert_eq!((&told["sites"], &told["spheres"]), (&1.into(), &1.into()));
    assert!(told["changes"][0]["x"].as_f64().unwrap() < 0.0, "{}", told["changes"]);
    assert_eq!(told["contrast"]["b"], checked["contrast"]);
    let told = desk.run(&["diff", "lopsided.csv", "full.csv", "--json"]).ok().json();
    assert_eq!((&told["changes"][0]["from"], &told["changes"][0]["spheres"]), (&"brass-260".into(), &1.into()));

    desk.run(&["report", "small.toml", "lopsided.csv", "--out", "page", "--quiet"]).ok();
    let spheres = |text: &str| text.lines().filter(|line| !line.starts_with('#')).count() - 1;
    assert_eq!(spheres(&desk.read("page/layout-full.csv")), 114);
    assert!(!desk.path("page/layout.csv").exists(), "half of it says nothing of the other half");
    let felt = desk.read("page/spheres.csv");
    assert_eq!(felt.lines().filter(|line| line.starts_with("lopsided,")).count(), 114);
    assert_eq!(felt.lines().filter(|line| line.starts_with("all-host,")).count(), 60);

    desk.run(&["build", "lopsided.csv", "--design", "small.toml", "--out", "shop", "--quiet"]).ok();
    let materials = |text: &str| -> Vec<String> {
        let lines = text.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit()));
        lines.map(|line| line.rsplit(',').next().unwrap().to_owned()).collect()
    };
    assert_eq!(materials(&desk.read("shop/layout-full.csv")), materials(&lopsided));
    let brass = materials(&lopsided).iter().filter(|material| *material == "brass-260").count();
    let told = desk.json("shop/build.json");
    let parts = told["parts"].as_array().unwrap();
    assert_eq!(parts.iter().find(|part| part["material"] == "brass-260").unwrap()["count"], brass);
    assert_eq!(spheres(&desk.read("shop/inspection.csv")), 114);

    let gate = &check(&["--gate"])["gate"];
    let line = |name: &str| gate["lines"].as_array().unwrap().iter().find(|line| line["check"] == name).unwrap();
    let value = line("C against baselines")["number"].as_str().unwrap();
    assert!(value.starts_with(&format!("{:.4}", of("contrast"))), "{value}");
    assert_eq!(line("stack under gravity")["word"], "pass");
    assert!(line("second blow")["number"].as_str().unwrap().contains("dents"));

    let tolerance = ["tolerance", "lopsided.csv", "--design", "small.toml", "--samples", "8", "--json"];
    let told = desk.run(&tolerance).ok().json();
    assert_eq!(told["samples"], 8);
    desk.write("alike.toml", "format = 1\nhalves = \"alike\"\n[diameter]\ngrade = \"G100\"\n");
    let refused = desk.run(&[&tolerance[..], &["--tolerances", "alike.toml"]].concat());
    assert!(refused.code == 2 && refused.stderr.contains("those of this layout differ"), "{}", refused.stderr);
}

/// Halves that are alike, simulated whole, are worth what the half is worth, to the growth of rounding.
#[test]
fn two_halves_that_are_alike_are_the_half() {
    let desk = Desk::with_layout();
    let design = granulens::design::Design::read(desk.path("small.toml")).unwrap();
    let layout = granulens::layout::read(&desk.path("small.csv"), &design.lattice, &[], &[]).unwrap();
    let plan = Plan::new(&design, Overrides::default(), &layout.palette).unwrap();
    let evaluate =
        |left| Subject { layout: &layout, left }.evaluate(&design, &plan, &Context::default()).unwrap().scores;
    let (half, whole) = (evaluate(None), evaluate(Some(&layout.materials[..])));
    for measure in [
        Measure::FocalMean,
        Measure::ProtectedMean,
        Measure::WorkIn,
        Measure::Kinetic,
        Measure::Dissipated,
        Measure::FarMomentum,
        Measure::FocalForce,
        Measure::ProtectedArrival,
        Measure::PieceMass,
    ] {
        let [half, whole] = [&half, &whole].map(|scores| scores.get(measure).unwrap());
        assert!((whole / half - 1.0).abs() < 1e-9, "{}: {whole} {half}", measure.name());
    }
}

/// A spreadsheet that shows few digits: positions to a thousandth of a diameter are the sites', which is said.
#[test]
fn rounded_positions_are_snapped_and_said() {
    let desk = Desk::with_layout();
    let text = desk.read("small.csv");
    let rounded: String = text
        .lines()
        .map(|line| {
            let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
            if !line.starts_with('#') && cells.len() == 6 {
                for cell in &mut cells[2..4] {
                    *cell = cell.parse::<f64>().map_or(cell.clone(), |value| format!("{value:.5}"));
                }
            }
            cells.join(",") + "\n"
        })
        .collect();
    assert_ne!(rounded, text);
    desk.write("rounded.csv", rounded);
    let exact = desk.run(&["check", "small.csv", "--design", "small.toml", "--json"]).ok().json();
    let snapped = desk.run(&["check", "rounded.csv", "--design", "small.toml"]).ok();
    assert!(snapped.stderr.contains("as rounding makes them"), "{}", snapped.stderr);
    let snapped = desk.run(&["check", "rounded.csv", "--design", "small.toml", "--json"]).ok();
    assert_eq!((&snapped.json()["focal_mean_J"], snapped.stderr.as_str()), (&exact["focal_mean_J"], ""));
}

/// An edit of the layout's text.
type Edit<'a> = &'a dyn Fn(&str) -> String;

/// Hears what is said of each edit of the small layout; every answer names file and line, where there is one to blame.
fn page(edits: &[(&str, Edit<'_>)]) -> String {
    let desk = Desk::with_layout();
    let text = desk.read("small.csv");
    let mut page = String::new();
    for (what, edit) in edits {
        desk.write("bad.csv", edit(&text));
        let ran = desk.run(&["check", "bad.csv", "--design", "small.toml"]);
        assert_eq!((ran.code, ran.stdout.as_str()), (2, ""), "{what}: {}", ran.stderr);
        let json = desk.run(&["check", "bad.csv", "--design", "small.toml", "--json"]).json_error();
        assert_eq!((&json["kind"], &json["file"]), (&"input".into(), &"bad.csv".into()), "{what}");
        let line = json["line"].as_u64().map_or(String::new(), |line| format!("{line}:"));
        assert!(ran.stderr.contains(&format!("bad.csv:{line} ")), "{what}: {}", ran.stderr);
        page += &format!("## {what} (column {})\n{}\n", json["key"], ran.stderr);
    }
    page
}

#[test]
fn rows_that_are_missing_double_or_strange() {
    let replaced = |old: &'static str, new: &'static str| {
        move |text: &str| {
            assert!(text.contains(old), "{old}");
            text.replacen(old, new, 1)
        }
    };
    let without = |begin: &'static str| {
        move |text: &str| text.lines().filter(|line| !line.starts_with(begin)).map(|line| format!("{line}\n")).collect()
    };
    insta::assert_snapshot!(page(&[
        ("a line is missing", &without("5,2,")),
        ("the first line is missing", &without("1,1,")),
        ("cut short", &|text| text[..text.find("\n7,3").unwrap()].to_owned()),
        ("header only", &|_| HEADER.to_owned()),
        ("given twice, behind a comment", &|text| text.replacen(
            "\n5,3,",
            "\n# again\n\n5,2,0.00635,0.02199704525612474,0.00635,brass\n5,3,",
            1
        )),
        ("row beyond the last", &replaced("\n12,5,", "\n13,5,")),
        ("column beyond the last", &replaced("\n5,5,", "\n5,6,")),
        ("row 0", &replaced("\n5,5,", "\n0,5,")),
        ("row is no number", &replaced("\n5,5,", "\nfive,5,")),
        ("too few values", &replaced("\n5,2,0.00635,", "\n5,2,")),
        ("too many values", &replaced("\n5,2,", "\n5,2,9,")),
        ("one value", &replaced("\n5,3,", "\nbrass here\n5,3,")),
    ]));
}

#[test]
fn values_that_do_not_fit() {
    let line = |new: &'static str| {
        move |text: &str| {
            let old = text.lines().find(|line| line.starts_with("5,2,")).unwrap();
            text.replacen(old, new, 1)
        }
    };
    insta::assert_snapshot!(page(&[
        ("x off by 2e-3 D", &line("5,2,0.0063627,0.02199704525612474,0.00635,brass")),
        ("z in mm", &line("5,2,0.00635,21.997,0.00635,brass")),
        ("x with a unit", &line("5,2,6.35 mm,0.02199704525612474,0.00635,brass")),
        ("x is NaN", &line("5,2,NaN,0.02199704525612474,0.00635,brass")),
        ("z is infinite", &line("5,2,0.00635,inf,0.00635,brass")),
        ("another diameter", &line("5,2,0.00635,0.02199704525612474,0.0095,brass")),
        ("negative diameter", &line("5,2,0.00635,0.02199704525612474,-0.00635,brass")),
        ("unknown material", &line("5,2,0.00635,0.02199704525612474,0.00635,bras-260")),
        ("unknown material like no other", &line("5,2,0.00635,0.02199704525612474,0.00635,cheese")),
        ("no material", &line("5,2,0.00635,0.02199704525612474,0.00635,")),
    ]));
}

#[test]
fn files_that_are_no_layout() {
    insta::assert_snapshot!(page(&[
        ("empty", &|_| String::new()),
        ("comments only", &|_| "# nothing\n\n".to_owned()),
        ("header missing", &|text| text.replacen(HEADER, "", 1)),
        ("columns in another order", &|text| text.replacen("row,column", "column,row", 1)),
        ("semicolons", &|text| text.replace(',', ";")),
        ("a design file", &|_| super::SMALL.to_owned()),
        ("a quote is not closed", &|text| text.replacen("\n5,2,", "\n\"5,2,", 1)),
    ]));
}

#[test]
fn files_that_cannot_be_read() {
    let desk = Desk::new();
    desk.write("binary.csv", [0x72, 0x6f, 0x77, 0xff, 0xfe]);
    let heard = ["nowhere.csv", "binary.csv", "."].map(|name| {
        let ran = desk.run(&["check", name, "--design", "small.toml"]);
        assert_eq!((ran.code, ran.stdout.as_str()), (2, ""), "{name}");
        ran.stderr
    });
    insta::assert_snapshot!(heard.concat());
}
