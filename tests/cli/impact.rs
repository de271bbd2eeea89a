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

/// Frames of an impact are kept as it goes: the same course as without, files that `network`, `motion` and `export` read, contacts
/// that add up to the force on each grain, and nothing left beside the results.
#[test]
fn frames_of_an_impact_are_kept() {
    let desk = Desk::new();
    desk.write("bed.toml", smaller("bed.toml"));
    let plain = desk.run(&["impact", "bed.toml", "--json", "--out", "plain"]).ok().json();
    desk.write("bed.toml", smaller("bed.toml") + "\n[record]\nevery = 2\n");
    let kept = desk.run(&["impact", "bed.toml", "--json", "--out", "out"]).ok().json();
    assert_eq!((&plain["final_depth_d"], &plain["peak_force"]), (&kept["final_depth_d"], &kept["peak_force"]));
    assert_eq!(desk.read("plain/impact.csv"), desk.read("out/impact.csv"));
    let files = names(&desk.path("out/frames"));
    assert_eq!((files.len(), &files[0][..]), (32, "000000-contacts.csv"));
    assert!(!desk.path("out.unfinished").exists());

    // Σ of the contacts' forces over each grain is the force that the frame gives it: friction is of the velocities at the end of the
    // step, forces of those predicted for it, which differ by a step's acceleration.
    let rows = |name: &str| -> Vec<Vec<String>> {
        let text = desk.read(&format!("out/frames/{name}"));
        text.lines().skip(2).map(|line| line.split(',').map(str::to_owned).collect()).collect()
    };
    let number = |text: &String| text.parse::<f64>().unwrap();
    let bodies = rows("000010-grains.csv");
    let mut sums = vec![[0.0; 2]; bodies.len() + 1];
    let mut most = 0.0_f64;
    for contact in rows("000010-contacts.csv") {
        let [i, j] = [0, 1].map(|k| contact[k].parse::<usize>().unwrap());
        let v: Vec<f64> = contact[2..].iter().map(number).collect();
        let (mut x, z) = (v[2] - v[0], v[3] - v[1]);
        x -= 24.0 * (x / 24.0).round();
        let length = x.hypot(z);
        let (x, z) = (x / length, z / length);
        let force = [v[4] * x - v[5] * z, v[4] * z + v[5] * x];
        most = most.max(v[4].abs());
        for k in 0..2 {
            sums[i][k] -= force[k];
            sums[j][k] += force[k];
        }
    }
    for (k, body) in bodies.iter().enumerate().filter(|(_, body)| body[9] == "grain") {
        for axis in 0..2 {
            let (sum, force) = (sums[k + 1][axis], number(&body[7 + axis]));
            assert!((sum - force).abs() < 0.02 * most, "body {}: {sum} {force}, greatest {most}", body[0]);
        }
    }

    let networks = desk.run(&["network", "out/frames", "--json", "--on", "particles", "--quiet"]).ok().json();
    let frames = networks["frames"].as_array().unwrap();
    assert_eq!((frames.len(), &frames[3]["time"]), (16, &serde_json::json!(6.0)));
    assert_eq!(frames[0]["grains"], kept["grains"]);
    let moved = desk.run(&["motion", "out/frames/000001-grains.csv", "out/frames/000008-grains.csv"]).ok();
    assert_eq!(moved.stdout.lines().count() as u64, kept["grains"].as_u64().unwrap() + 1);
    desk.run(&["export", "out/frames", "--xyz", "bed.xyz", "--vtp", "vtk"]).ok();
    // Bodies and contacts of 16 moments, a list of either, and the manifest.
    assert_eq!(names(&desk.path("vtk")).len(), 35);
    assert!(desk.read("bed.xyz").starts_with(&format!("{}\n", bodies.len())));

    desk.write("bed.toml", smaller("bed.toml") + "\n[record]\nevery = 0.7\n");
    let ran = desk.run(&["impact", "bed.toml"]);
    assert!(ran.code == 2 && ran.stderr.contains("record.every"), "{}", ran.stderr);
    desk.write("bed.toml", smaller("bed.toml") + "\n[record]\nevery = 2\n");
    let ran = desk.run(&["impact", "bed.toml", "--samples", "2"]);
    assert!(ran.code == 2 && ran.stderr.contains("[record] is for single impacts"), "{}", ran.stderr);
}
