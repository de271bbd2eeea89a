//! `granulens impact`: small beds, kept beds, what is refused. Every bed file of `designs/` is run with fewer grains.

use super::{Desk, names, shipped};

/// A shipped bed file for a bed of a few hundred soft grains, which settles in a moment.
fn smaller(file: &str) -> String {
    let mut text = std::fs::read_to_string(shipped(&format!("designs/{file}"))).unwrap();
    for (from, to) in [
        ("width = 100", "width = 24"),
        ("height = 60", "height = 9"),
        ("stiffness = 4000 ", "stiffness = 100 "),
        ("\nmass = 100", "\nmass = 9"),
        ("speed = 0.7", "speed = 0.5\nheight = 0.5"),
        ("window = 400", "window = 30"),
    ] {
        assert!(text.contains(from), "{file} does not contain {from:?}");
        text = text.replacen(from, to, 1);
    }
    let sizes = [
        ("\ndiameter = 10", "\ndiameter = 3"),
        ("half_width = 5\nhalf_height = 10", "half_width = 1.5\nhalf_height = 3"),
    ];
    sizes.iter().fold(text, |text, (from, to)| text.replacen(from, to, 1))
}

const FILES: [&str; 11] = [
    "bed.svg",
    "bed.toml",
    "depth.svg",
    "energy.svg",
    "force.svg",
    "grains.csv",
    "impact.csv",
    "impact.html",
    "impact.json",
    "pair-correlation.csv",
    "pair-correlation.svg",
];

#[test]
fn every_shipped_bed_is_struck() {
    for file in ["bed.toml", "bed-static.toml", "bed-hexagonal.toml", "bed-ogive.toml"] {
        let desk = Desk::new();
        desk.write("bed.toml", smaller(file));
        let json = desk.run(&["impact", "bed.toml", "--json", "--out", "out"]).ok().json();
        let number = |key: &str| json[key].as_f64().unwrap_or_else(|| panic!("{file}: {key}"));
        assert_eq!(names(&desk.path("out")), FILES, "{file}");
        assert!((0.75..0.95).contains(&number("volume_fraction")), "{file}: {json}");
        assert!((3.0..6.5).contains(&number("coordination")), "{file}: {json}");
        assert!(number("max_depth_d") > 0.0 && number("peak_force") > 0.0, "{file}: {json}");
        assert!((number("time_tau_c") - 30.0).abs() < 1e-9 && number("residual").abs() < 0.05, "{file}: {json}");
        // The bed is kept, and the second run strikes the same.
        assert!(json["settled_in_seconds"].is_number() && names(&desk.path("reports/beds")).len() == 1);
        let again = desk.run(&["impact", "bed.toml", "--json", "--out", "out"]).ok().json();
        assert!(again["settled_in_seconds"].is_null());
        assert_eq!(again["final_depth_d"], json["final_depth_d"], "{file}");
    }
}

#[test]
fn a_bed_from_a_file_and_other_speeds() {
    let desk = Desk::new();
    desk.write("bed.toml", smaller("bed.toml"));
    desk.run(&["impact", "bed.toml", "--quiet"]).ok();
    let kept = names(&desk.path("reports/beds")).remove(0);
    let text = smaller("bed.toml");
    let from = text.find("[bed]").unwrap();
    let to = text.find("[grains]").unwrap();
    let other = format!("{}[bed]\nfile = \"reports/beds/{kept}\"\n\n{}", &text[..from], &text[to..]);
    desk.write("other.toml", other.replace("name = \"bed\"", "name = \"other\""));
    let slow = desk.run(&["impact", "other.toml", "--json", "--speed", "0.1"]).ok().json();
    let fast = desk.run(&["impact", "other.toml", "--json", "--sound"]).ok().json();
    assert!(slow["max_depth_d"].as_f64() < fast["max_depth_d"].as_f64(), "{slow} {fast}");
    assert!(slow["seed"].is_null() && (0.5..5.0).contains(&fast["sound_speed"].as_f64().unwrap()), "{fast}");
    // What the speed was read from is kept and drawn: nothing at first, then a rise through 5 % of the most at the surface's
    // height over the speed.
    let heard = std::fs::read_to_string(desk.path("reports/other/sound.csv")).unwrap();
    let rows: Vec<Vec<f64>> =
        heard.lines().skip(1).map(|line| line.split(',').map(|x| x.parse().unwrap()).collect()).collect();
    let most = rows.iter().map(|row| row[1]).fold(0.0, f64::max);
    let arrival = rows.iter().find(|row| row[1] >= 0.05 * most).unwrap()[0];
    let height = arrival * fast["sound_speed"].as_f64().unwrap();
    // To 2 d: the surface above the middle is not the mean one.
    assert!((height - fast["surface_d"].as_f64().unwrap()).abs() < 2.0, "{height} {fast}");
    assert!(desk.path("reports/other/sound.svg").exists());
}

#[test]
fn what_makes_no_bed_is_refused() {
    let desk = Desk::new();
    desk.write("bed.toml", smaller("bed.toml").replace("spread = 0.2", "spread = 2"));
    let error = desk.run(&["impact", "bed.toml", "--json"]);
    assert_eq!((error.code, error.json_error()["key"].clone()), (2, "bed.spread".into()));
    assert!(!desk.path("reports").join("bed").exists());
    desk.write("gone.toml", "format = 1\nkind = \"bed\"\nname = \"gone\"\n[bed]\nfile = \"none.csv\"\n[intruder]\nshape = \"disk\"\ndiameter = 3\nspeed = 0.5\n");
    let error = desk.run(&["impact", "gone.toml"]);
    assert!(error.code == 2 && error.stderr.contains("none.csv"), "{}", error.stderr);
    assert!(desk.run(&["impact", "bed.toml", "--speed", "-1"]).code == 2);
}

/// Two speeds, two kinds of friction and three beds: means of what is kept; a lost run alone is made again, to the same bits for
/// any number of threads.
#[test]
fn an_ensemble_is_taken_up_and_does_not_depend_on_threads() {
    let text = smaller("bed.toml") + "\n[ensemble]\nspeeds = [0.2, 0.5]\nfriction = [\"kinetic\", \"static\"]\n";
    let desk = Desk::new();
    desk.write("bed.toml", text.clone());
    let run = |threads: &str| {
        desk.run(&["impact", "bed.toml", "--samples", "3", "--json", "--out", "out", "--threads", threads]).ok().json()
    };
    let first = run("2");
    let cells = first["cells"].as_array().unwrap();
    assert_eq!((cells.len(), first["impacts"].as_array().unwrap().len()), (4, 12));
    let depth = |cell: usize| cells[cell]["final_depth_d"]["mean"].as_f64().unwrap();
    let of_cell = |cell: usize| {
        let runs = first["impacts"].as_array().unwrap()[3 * cell..3 * cell + 3].iter();
        runs.map(|run| run["final_depth_d"].as_f64().unwrap()).sum::<f64>() / 3.0
    };
    assert!(depth(1) > depth(0) && (depth(2) - of_cell(2)).abs() < 1e-12, "{first}");
    let files = || {
        ["ensemble.csv", "ensemble.json", "impacts.csv", "depth.svg"]
            .map(|name| std::fs::read(desk.path("out").join(name)).unwrap())
    };
    let (before, kept) = (files(), names(&desk.path("out/impacts")));
    assert_eq!(kept.len(), 12);
    std::fs::remove_file(desk.path("out/impacts").join(&kept[5])).unwrap();
    let again = desk.run(&["impact", "bed.toml", "--samples", "3", "--out", "out", "--threads", "1"]).ok();
    assert!(again.stderr.contains("12 impacts, 11 of them kept"), "{}", again.stderr);
    assert!(files() == before && names(&desk.path("out/impacts")) == kept);

    desk.write("twice.toml", text.replace("[0.2, 0.5]", "[0.2, 0.2]"));
    let error = desk.run(&["impact", "twice.toml", "--json"]);
    assert_eq!((error.code, error.json_error()["key"].clone()), (2, "ensemble.speeds".into()));
}
