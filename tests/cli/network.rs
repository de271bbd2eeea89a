//! `network` and `motion`: instruments that read files of any program.

use super::{Desk, names, shipped};

/// Two squares side by side; the diagonal 1-5 cuts the right one. Forces 8 to 1, mean 4.5.
pub const SQUARES: &str = "i,j,x_i,z_i,x_j,z_j,normal_N,tangential_N
0,1,0,0,1,0,8,0
1,2,1,0,2,0,7,0
3,4,0,1,1,1,6,0
4,5,1,1,2,1,5,0
0,3,0,0,0,1,4,0
1,4,1,0,1,1,3,0
2,5,2,0,2,1,2,0
1,5,1,0,2,1,1,9
";

#[test]
fn a_network_of_contacts_has_its_numbers() {
    let desk = Desk::new();
    desk.write("contacts.csv", SQUARES);
    let json = desk.run(&["network", "contacts.csv", "--json", "--thresholds", "0,0.3,1,1.2,2"]).ok().json();
    assert_eq!(json["mean_force"], 4.5);
    assert_eq!(json["components"], serde_json::json!([1, 1, 2, 2, 0]));
    assert_eq!(json["loops"], serde_json::json!([3, 2, 0, 0, 0]));
    assert_eq!(json["holes"], serde_json::json!([1, 2, 0, 0, 0]));
    assert_eq!(json["persistence0"], serde_json::json!([[8.0 / 4.5, null], [6.0 / 4.5, 4.0 / 4.5]]));
    assert_eq!(json["persistence1"], serde_json::json!([[3.0 / 4.5, null], [2.0 / 4.5, 1.0 / 4.5]]));
    assert_eq!((&json["coordination"], &json["rattlers"]), (&serde_json::json!(16.0 / 6.0), &serde_json::json!(0)));

    let json = desk.run(&["network", "contacts.csv", "--json", "--tangential"]).ok().json();
    assert_eq!(json["thresholds"].as_array().unwrap().len(), 101);
    assert_eq!((&json["thresholds"][3], &json["thresholds"][100]), (&serde_json::json!(0.15), &serde_json::json!(5.0)));
    assert_eq!((&json["mean_force"], &json["components"][39]), (&serde_json::json!(4.5), &serde_json::json!(1)));
    assert_eq!(json["components"][40], 0, "9 does not exceed twice 4.5");

    let json = desk.run(&["network", "contacts.csv", "--json", "--on", "particles"]).ok().json();
    assert_eq!(json["mean_force"], 12.0);

    let text = desk.run(&["network", "contacts.csv", "--thresholds", "0,1"]).ok();
    assert_eq!(text.stdout, "threshold,components,loops,holes\n0,1,3,1\n1,2,0,0\n");
    assert!(text.stderr.contains("6 grains, 8 contacts"), "{}", text.stderr);

    desk.run(&["network", "contacts.csv", "--json", "--cell", "0.5", "--out", "found"]).ok();
    let found = desk.json("found/network.json");
    assert_eq!(found["holes"][0], 1);
    let area = |cell: &serde_json::Value| cell["stress"][0][0].as_f64().unwrap() * 0.25;
    let sum: f64 = found["stress"]["cells"].as_array().unwrap().iter().map(area).sum();
    assert!((sum - found["virial"][0][0].as_f64().unwrap()).abs() < 1e-12);
    for name in ["network.csv", "persistence.csv", "chains.csv", "stress.csv"] {
        assert!(desk.read(&format!("found/{name}")).lines().count() >= 1, "{name}");
    }
}

/// Columns in another order with others between, a byte order mark, comments, spaces, grains by name, and no places.
#[test]
fn contacts_may_be_written_in_many_ways() {
    let desk = Desk::new();
    desk.write("contacts.csv", SQUARES);
    let usual = desk.run(&["network", "contacts.csv", "--json"]).ok().json();
    let mut text = "\u{feff}# from elsewhere\r\nnote, normal_N, j, i\r\n".to_owned();
    for line in SQUARES.lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        text += &format!("x, -{}.0, g{}, g{}\r\n", cells[6], cells[1], cells[0]);
    }
    desk.write("other.csv", text);
    let other = desk.run(&["network", "other.csv", "--json"]).ok().json();
    for key in ["mean_force", "components", "loops", "holes", "persistence0", "persistence1", "coordination"] {
        assert_eq!(usual[key], other[key], "{key}");
    }
    assert!(other["fabric"].is_null() && other["chains"].is_null() && !usual["fabric"].is_null());
}

/// Two moments of a dump of LAMMPS: columns told by --columns, the box's period, pairs that do not touch left out.
#[test]
fn dumps_of_lammps_are_read() {
    let desk = Desk::new();
    let moment = |step: u32, force: u32| {
        format!(
            "ITEM: TIMESTEP\n{step}\nITEM: NUMBER OF ENTRIES\n4\nITEM: BOX BOUNDS pp ff pp\n0 3\n-1 5\n-0.5 0.5\n\
             ITEM: ENTRIES index c_1[1] c_1[2] c_2[1]\n1 1 2 {force}\n2 2 3 2\n3 1 3 2\n4 1 4 0\n"
        )
    };
    desk.write("dump.local", moment(100, 2) + &moment(200, 5));
    let columns = "i=c_1[1],j=c_1[2],normal_N=c_2[1]";
    let ran = desk.run(&["network", "dump.local", "--columns", columns, "--json"]).ok().json();
    assert_eq!((&ran["frames"][0]["time"], &ran["frames"][1]["time"]), (&100.0.into(), &200.0.into()));
    assert_eq!((&ran["frames"][1]["mean_force"], &ran["frames"][1]["contacts"]), (&3.0.into(), &3.into()));
    let one = desk.run(&["network", "dump.local", "--columns", columns, "--json", "--frame", "1"]).ok().json();
    assert_eq!(one, ran["frames"][1]);
    let short = desk.run(&["network", "dump.local", "--json"]);
    assert!(short.code == 2 && short.stderr.contains("has no column normal_N"), "{}", short.stderr);
}

#[test]
fn wrong_contacts_hear_what_is_wrong() {
    let desk = Desk::new();
    for (from, to, fault) in [
        ("1,4,1,0", "4,4,1,0", ":7: grain 4 touches itself"),
        ("2,5,2,0", "1,0,2,0", ":8: grains 1 and 0 touch in line 2 already"),
        ("1,5,1,0,2,1,1,9", "1,5,1,0,2,1,NaN,9", ":9: normal_N = \"NaN\" is no finite number"),
        ("1,5,1,0,2,1,1,9", "1,5,1,0,2,1,9", ":9: the line has 7 values, and the header names 8 columns"),
        ("normal_N", "force", "has no column normal_N"),
        ("0,1,0,0,1,0", ",1,0,0,1,0", ":2: i is empty"),
    ] {
        desk.write("contacts.csv", SQUARES.replacen(from, to, 1));
        let ran = desk.run(&["network", "contacts.csv"]);
        assert!(ran.code == 2 && ran.stdout.is_empty() && ran.stderr.contains(fault), "{fault}: {}", ran.stderr);
    }
    desk.write("contacts.csv", SQUARES);
    for arguments in [["--period-x", "-1"], ["--thresholds", "1,-2"], ["--on", "grains"], ["--frame", "3"]] {
        let ran = desk.run(&[&["network", "contacts.csv"], &arguments[..]].concat());
        assert!(ran.code == 2 && ran.stdout.is_empty(), "{arguments:?}: {}", ran.stderr);
    }
    assert_eq!(desk.run(&["network", "nothing.csv"]).code, 2);
}

/// A shear of a square lattice leaves nothing; the table has the columns that scripts read.
#[test]
fn motion_writes_its_table() {
    let desk = Desk::new();
    let places = |shear: f64| -> String {
        let rows = (0..36).map(|k| (f64::from(k % 6), f64::from(k / 6), k));
        rows.fold("x,id,z\n".to_owned(), |text, (x, z, k)| text + &format!("{},g{k},{z}\n", x + shear * z))
    };
    desk.write("before.csv", places(0.0));
    desk.write("after.csv", places(0.25));
    let text = desk.run(&["motion", "before.csv", "after.csv", "--radius", "1.5"]).ok().stdout;
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some("id,x,z,d2min,a11,a12,a21,a22,neighbours"));
    let rows: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
    assert_eq!((rows.len(), rows[7][0], rows[7][8], rows[0][8]), (36, "g7", "8", "3"));
    for row in &rows {
        let number = |k: usize| row[k].parse::<f64>().unwrap();
        assert!(number(3) < 1e-28 && (number(5) - 0.25).abs() < 1e-14 && (number(4) - 1.0).abs() < 1e-14, "{row:?}");
    }
    // Below three neighbours nothing is said.
    let text = desk.run(&["motion", "before.csv", "after.csv", "--radius", "1.2"]).ok().stdout;
    assert_eq!(text.lines().nth(1), Some("g0,0,0,,,,,,2"));
    desk.run(&["motion", "before.csv", "after.csv", "--out", "moved.csv", "--radius", "1.2"]).ok();
    assert_eq!(desk.read("moved.csv"), text);
    let json = desk.run(&["motion", "before.csv", "after.csv", "--json", "--period-x", "6"]).ok().json();
    assert_eq!((&json["radius"], json["grains"].as_array().unwrap().len()), (&2.5.into(), 36));

    desk.write("after.csv", places(0.25).replace("g7,", "g99,"));
    let ran = desk.run(&["motion", "before.csv", "after.csv"]);
    assert!(ran.code == 2 && ran.stderr.contains("after.csv:9: grain g99 is not in before.csv"), "{}", ran.stderr);
    let ran = desk.run(&["motion", "before.csv", "before.csv", "--period-x", "4"]);
    assert!(ran.code == 2 && ran.stderr.contains("more than half the period"), "{}", ran.stderr);
}

/// Layers of a network by height, alone.
#[test]
fn a_layer_of_a_network_is_looked_at_alone() {
    let desk = Desk::new();
    desk.write("contacts.csv", SQUARES);
    let json = desk.run(&["network", "contacts.csv", "--json", "--z", "0.5,2"]).ok().json();
    assert_eq!((&json["grains"], &json["contacts"], &json["mean_force"]), (&3.into(), &2.into(), &5.5.into()));
    let ran = desk.run(&["network", "contacts.csv", "--z", "2,1"]);
    assert!(ran.code == 2 && ran.stderr.contains("--z"), "{}", ran.stderr);
}

/// Frames of a lens under its impact: one network per sample, balanced by what `simulate` says itself, and pictures of both. What a
/// sphere does with its own image at the mirrors is no contact of two.
#[test]
fn frames_of_a_lens_are_kept_and_drawn() {
    let desk = Desk::new();
    let design = shipped("designs/thesis-lens.toml");
    let ran = desk.run(&["simulate", &design, "--frames", "--out", "lens", "--quiet"]).ok();
    assert!(ran.stdout.contains("850 spheres"), "{}", ran.stdout);
    let regions = desk.read("lens/regions.csv");
    assert!(regions.starts_with("time_s,focus_velocity_m_s,focus_kinetic_J,"), "{regions}");
    // Before the wave sets out nothing is pressed: the first network is empty.
    let found = desk.run(&["network", "lens/frames", "--json", "--thresholds", "0,1"]).ok();
    let frames = found.json()["frames"].as_array().unwrap().clone();
    assert_eq!((frames.len(), frames[0]["grains"].as_u64()), (regions.lines().count() - 1, Some(850)));
    assert_eq!(frames[0]["mean_force"].as_f64(), Some(0.0));
    assert!(frames[1]["mean_force"].as_f64().unwrap() > 100.0, "{}", frames[1]["mean_force"]);
    let page = desk.read("lens/report.html");
    for (name, words) in [("network", "kinetic energy of"), ("motion", "mm²")] {
        let svg = desk.read(&format!("lens/{name}.svg"));
        assert!(svg.contains(words) && page.contains(words), "{name}");
    }
}

/// What a report says of the inside of its lens: the network of its contacts at the moment of focus, the same as `network` finds in them, alike on
/// both sides of the axis; that moment, and how spheres have moved, as a run of the half sheet between mirrors has them.
#[test]
fn a_report_looks_inside_its_lens() {
    let desk = Desk::new();
    desk.design_with("small.toml", "half_width = 4.5", "half_width = 8.5");
    desk.run(&["run", "small.toml", "--out", "run", "--quiet"]).ok();
    let outcome = desk.json("run/outcome.json");
    let (inside, page) = (&outcome["inside"], desk.read("run/report.html"));
    for words in [
        "id=\"inside\"",
        "contacts at",
        "damage after",
        "before the lens, rows 1 to 2",
        "in it, rows 3 to 5",
        "behind it, rows 6 to 10",
    ] {
        assert!(page.contains(words), "{words}");
    }
    assert_eq!(desk.json("run/numbers.json")["inside"]["parts"], inside["parts"]);

    // Its contacts are those that are written, and measured alike: rows are told apart by depths half a row away.
    let row = 6.35e-3 * 0.75_f64.sqrt();
    for part in inside["parts"].as_array().unwrap() {
        let [first, last] = [0, 1].map(|k| part["rows"][k].as_f64().unwrap());
        let layer = format!("{},{}", (first - 1.5) * row, (last - 0.5) * row);
        let call = ["network", "run/contacts.csv", "--json", "--thresholds", "1", &format!("--z={layer}")];
        let found = desk.run(&call).ok().json();
        assert_eq!((&found["components"][0], &found["loops"][0]), (&part["components"], &part["loops"]), "{part}");
        assert_eq!(found["mean_force"], part["mean_force_N"], "{part}");
        let (xx, zz) = (found["virial"][0][0].as_f64().unwrap(), found["virial"][1][1].as_f64().unwrap());
        let said = part["along_over_across"].as_f64().unwrap();
        assert!((zz / xx - said).abs() < 1e-9 * said.abs(), "{part}");
    }

    // Both sides are alike: each contact has an image with the same force. Spheres come behind their images.
    let spheres: Vec<(u64, bool)> = serde_json::from_value(inside["spheres"].clone()).unwrap();
    let image = |i: u64| {
        let (site, other) = spheres[i as usize];
        spheres.iter().position(|&(k, side)| k == site && side != other).map_or(i, |k| k as u64)
    };
    let contacts: Vec<(u64, u64, f64, f64)> = serde_json::from_value(inside["contacts"].clone()).unwrap();
    let most = contacts.iter().map(|contact| contact.2).fold(0.0, f64::max);
    let forces: std::collections::BTreeMap<(u64, u64), f64> =
        contacts.iter().map(|&(i, k, force, _)| ((i.min(k), i.max(k)), force)).collect();
    assert!(contacts.len() > 100, "{}", contacts.len());
    for (&(i, k), force) in &forces {
        let (i, k) = (image(i), image(k));
        let other = forces.get(&(i.min(k), i.max(k))).copied().unwrap_or(0.0);
        assert!((force - other).abs() < 1e-6 * most, "{i} {k}: {force} {other}");
    }

    // The half between its mirrors, sampled by itself.
    desk.run(&["simulate", "small.toml", "--frames", "--out", "half", "--quiet"]).ok();
    let regions = desk.read("half/regions.csv");
    let column = regions.lines().next().unwrap().split(',').position(|name| name == "focus_kinetic_J").unwrap();
    let rows: Vec<Vec<f64>> =
        regions.lines().skip(1).map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect()).collect();
    let focus = rows.iter().max_by(|a, b| a[column].total_cmp(&b[column])).unwrap()[0];
    let between = rows[1][0] - rows[0][0] + 100e-6 / 200.0;
    let moment = inside["moment_s"].as_f64().unwrap();
    assert!((moment - focus).abs() <= between, "{moment} {focus}");

    // Where a neighbourhood lies within the half it has moved as there.
    let frames = names(&desk.path("half/frames"));
    let grains: Vec<String> =
        frames.iter().filter(|name| name.ends_with("grains.csv")).map(|name| format!("half/frames/{name}")).collect();
    let moved = desk.run(&["motion", &grains[0], &grains[grains.len() - 1], "--json"]).ok().json();
    let (mut compared, d2min) = (0, inside["d2min_m2"].as_array().unwrap());
    let most = d2min.iter().filter_map(serde_json::Value::as_f64).fold(0.0, f64::max);
    for (site, grain) in moved["grains"].as_array().unwrap().iter().enumerate() {
        let x = grain["x"].as_f64().unwrap() / 6.35e-3;
        if (2.6..5.9).contains(&x) {
            let (whole, half) = (d2min[site].as_f64().unwrap(), grain["d2min"].as_f64().unwrap());
            assert!((whole - half).abs() < 1e-6 * most, "{site}: {whole} {half}");
            compared += 1;
        }
    }
    assert!(compared > 30 && most > 0.0, "{compared} {most}");
}
