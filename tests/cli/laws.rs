//! `materials`, `contact` and `speed`.

use super::{Desk, keys, shipped};

#[test]
fn materials_are_listed_with_sources_and_aliases() {
    let desk = Desk::new();
    let json = desk.run(&["materials", "--json"]).ok().json();
    let list = json["materials"].as_array().unwrap();
    for (name, alias) in [
        ("stainless-440c", "440c"),
        ("stainless-302", "302"),
        ("aluminium-2017", "al"),
        ("brass-260", "brass"),
        ("tungsten-carbide", "wc"),
    ] {
        let material = list.iter().find(|m| m["name"] == name).unwrap_or_else(|| panic!("{name}"));
        assert!(material["aliases"].as_array().unwrap().contains(&alias.into()), "{name}");
        assert!(material["source"].as_str().unwrap().len() > 10, "{name}");
        for key in ["density_kg_m3", "youngs_modulus_Pa", "poisson_ratio", "yield_stress_Pa", "rate_constant"] {
            assert!(material[key].as_f64().is_some(), "{name}: {key}");
        }
    }
    let text = desk.run(&["materials"]).ok();
    assert!(text.stdout.contains("brass-260") && text.stderr.is_empty());

    let own = r#"[materials.my-steel]
density = "7800 kg/m3"
youngs_modulus = "200 GPa"
poisson_ratio = 0.3
yield_stress = "900 MPa"
rate_constant = 0.02
source = "own measurement, 2026"
"#;
    desk.write("own.toml", format!("{}{own}", super::SMALL));
    assert!(desk.run(&["materials", "own.toml"]).ok().stdout.contains("own measurement, 2026"));
    desk.run(&["materials", "--out", "list.json", "--quiet"]).ok();
    assert_eq!(desk.json("list.json"), json);
}

/// Burgoyne 2016, table 4.1 and eq. 4.7 with the constants of the code.
#[test]
fn speeds_are_those_of_the_closed_form() {
    let desk = Desk::new();
    let speed = |arguments: &[&str]| {
        let json = desk.run(&[&["speed", "--json"], arguments].concat()).ok().json();
        assert!(json["stiffness_N_m"].as_f64().unwrap() > 1e7 && json["fully_plastic_force_N"].as_f64().unwrap() > 1.0);
        json["speed_m_s"].as_f64().unwrap()
    };
    let near = |value: f64, expected: f64| assert!((value - expected).abs() < 0.05, "{value}, expected {expected}");
    near(speed(&["--material", "440c"]), 1344.7);
    near(speed(&["--material", "brass"]), 791.1);
    near(speed(&["--material", "al", "--material", "wc"]), 629.0);
    near(speed(&["--material", "wc", "--material", "al"]), 629.0);
    let flat = speed(&["--material", "440c", "--dimension", "2"]) / speed(&["--material", "440c"]);
    assert!((flat - 1.5 / 2.0_f64.sqrt()).abs() < 1e-12, "3/(2 sqrt 2) in two dimensions, not {flat}");

    let text = desk.run(&["speed", "--material", "440c"]).ok();
    assert!(text.stdout.starts_with("stainless-440c: wave-speed bound 1344.7 m/s in 1D"), "{}", text.stdout);
    assert!(text.stderr.is_empty());
    let more = desk.run(&["speed", "--material", "440c", "--material", "al", "--material", "wc"]);
    assert_eq!((more.code, more.stdout.as_str()), (2, ""));
    assert!(more.stderr.contains("two for a dimer"), "{}", more.stderr);
    assert_eq!(desk.run(&["speed", "--material", "440c", "--dimension", "4"]).code, 2);
}

/// The reference table was made with an independent implementation; only the sums' order differs.
#[test]
fn states_give_the_reference_forces_and_histories() {
    let table = std::fs::read_to_string(shipped("tests/data/contact_law_440c-brass.csv")).unwrap();
    let mut lines = table.lines().filter(|line| !line.starts_with('#'));
    assert_eq!(lines.next(), Some("path,d,v,dmax_before,Fmax_before,F,dmax_after,Fmax_after"));
    let rows: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
    assert!(rows.len() > 200);
    // Columns in another order, one too many, and comments.
    let mut states = String::from("# states\nFmax,path,v,d,dmax\n");
    for (k, row) in rows.iter().enumerate() {
        let comment = if k == 50 { "# half of it\n\n" } else { "" };
        states += &format!("{comment}{},{},{},{},{}\n", row[4], row[0], row[2], row[1], row[3]);
    }
    let desk = Desk::new();
    desk.write("states.csv", states);
    let arguments = ["contact", "--pair", "440c,brass", "--states", "states.csv"];
    let ran = desk.run(&arguments).ok();
    let mut ours = ran.stdout.lines();
    assert_eq!(ours.next(), Some("d,v,dmax,Fmax,F,dmax_after,Fmax_after"));
    let number = |text: &str| text.parse::<f64>().unwrap();
    let ours: Vec<Vec<f64>> = ours.map(|line| line.split(',').map(number).collect()).collect();
    assert_eq!(ours.len(), rows.len());
    for (ours, row) in ours.iter().zip(&rows) {
        let theirs: Vec<f64> = row[1..].iter().map(|cell| number(cell)).collect();
        assert_eq!(ours[..4], theirs[..4]);
        for k in 4..7 {
            let off = (ours[k] - theirs[k]).abs();
            assert!(off <= 1e-11 * theirs[k].abs(), "{row:?}: column {k} is {}", ours[k]);
        }
    }

    let json = desk.run(&[&arguments[..], &["--json"]].concat()).ok().json();
    let states = json["states"].as_array().unwrap();
    assert_eq!(keys(&states[0]), ["d", "v", "dmax", "Fmax", "F", "dmax_after", "Fmax_after"]);
    assert!(states.iter().zip(&ours).all(|(state, row)| state["F"].as_f64() == Some(row[4])));
    let quiet = desk.run(&[&arguments[..], &["--out", "after.csv", "--quiet"]].concat()).ok();
    assert_eq!((quiet.stdout.as_str(), quiet.stderr.as_str(), desk.read("after.csv")), ("", "", ran.stdout));
}

#[test]
fn wrong_states_are_refused_with_their_line() {
    let desk = Desk::new();
    let mut page = String::new();
    for (what, text) in [
        ("empty", ""),
        ("no column", "# c\nd,v,dmax\n1,2,3\n"),
        ("no number", "d,v,dmax,Fmax\n# c\n1e-6,0,0,0\n\n1e-6,zero,0,0\n"),
        ("not finite", "d,v,dmax,Fmax\n1e-6,0,0,inf\n"),
        ("short line", "d,v,dmax,Fmax\n1e-6,0,0\n"),
    ] {
        desk.write("states.csv", text);
        let ran = desk.run(&["contact", "--pair", "440c,brass", "--states", "states.csv"]);
        assert_eq!((ran.code, ran.stdout.as_str()), (2, ""), "{what}");
        page += &ran.stderr;
    }
    insta::assert_snapshot!(page);
}

#[test]
fn a_contact_is_drawn_as_svg() {
    let desk = Desk::new();
    let laws = ["thesis", "thesis-static", "hertz", "hertz-thesis", "linear", "linear-static"];
    for law in laws {
        let json =
            desk.run(&["contact", "--pair", "440c,brass", "--law", law, "--out", "curve.svg", "--json"]).ok().json();
        assert_eq!(json["law"], law);
        assert!(json["fully_plastic_force_N"].as_f64().unwrap() > 100.0);
        let svg = desk.read("curve.svg");
        assert!(svg.starts_with("<svg") || svg.starts_with("<?xml"), "{law}");
        assert!(svg.trim_end().ends_with("</svg>") && svg.contains(law), "{law}");
    }
    let unequal = desk.run(&["contact", "--pair", "440c,440c", "--diameter", "6.35 mm,9.5 mm", "--json"]).ok().json();
    let radius = 1.0 / (1.0 / 3.175e-3 + 1.0 / 4.75e-3);
    assert!((unequal["effective_radius_m"].as_f64().unwrap() / radius - 1.0).abs() < 1e-12);
    let other = desk.run(&["contact", "--pair", "440c,brass", "--out", "curve.bmp"]);
    assert_eq!(other.code, 2);
    assert!(!desk.path("curve.bmp").exists());
    assert_eq!(desk.run(&["contact", "--pair", "440c,brass", "--law", "herz"]).code, 2);
}

/// A law with a memory of its own writes it, and reads it where it is given; where not, it follows from dmax and Fmax.
#[test]
fn a_law_tells_what_it_remembers() {
    let desk = Desk::new();
    desk.write("states.csv", "d,v,dmax,Fmax\n0.000254,0,0,0\n0.00025,-1,0.000254,11184.168\n");
    let asked = ["contact", "--pair", "440c,440c", "--law", "mdr-static", "--states"];
    let rows = |text: &str| -> Vec<Vec<String>> {
        text.lines().map(|line| line.split(',').map(str::to_owned).collect()).collect()
    };
    let once = desk.run(&[&asked[..], &["states.csv"]].concat()).ok().stdout;
    let table = rows(&once);
    assert_eq!(table[0].join(","), "d,v,dmax,Fmax,F,dmax_after,Fmax_after,yield_overlap_m,yield_overlap_m_after");
    let number = |row: usize, column: usize| table[row][column].parse::<f64>().unwrap();
    // 440c at 4 % of D, and where it began to yield, computed by another implementation.
    assert!((number(1, 4) - 11184.168).abs() < 1e-3 && number(1, 7) == 0.0);
    assert!((number(1, 8) / 6.35e-3 - 0.00308).abs() < 5e-6 && (number(2, 7) / number(1, 8) - 1.0).abs() < 1e-5);
    // Read back, its own output gives the same forces.
    desk.write("again.csv", &once);
    assert_eq!(rows(&desk.run(&[&asked[..], &["again.csv"]].concat()).ok().stdout)[2][4], table[2][4]);
}

/// Restitution by its closed form (Thornton 1997), and constants fitted to a curve of the program's own.
#[test]
fn collisions_and_fits_are_told() {
    let desk = Desk::new();
    let straight = ["contact", "--pair", "440c,440c", "--law", "walton-braun", "--spring-back", "4"];
    let told = desk.run(&[&straight[..], &["--speeds", "0.1,10"]].concat()).ok().stdout;
    let restitution: Vec<f64> =
        told.lines().skip(1).map(|line| line.split(',').nth(1).unwrap().parse().unwrap()).collect();
    assert!(restitution.len() == 2 && restitution.iter().all(|e| (e - 0.5).abs() < 1e-4), "{told}");
    let mut states = String::from("d,v,dmax,Fmax\n");
    for k in 1..30 {
        states += &format!("{},0,0,0\n", 1e-5 * f64::from(k));
    }
    desk.write("states.csv", states);
    let asked = ["contact", "--pair", "440c,440c", "--law", "mdr-static"];
    let forces = desk.run(&[&asked[..], &["--states", "states.csv", "--json"]].concat()).ok().json();
    let mut curve = String::from("overlap_m,force_N\n");
    for state in forces["states"].as_array().unwrap() {
        curve += &format!("{},{}\n", state["d"], state["F"]);
    }
    desk.write("curve.csv", curve);
    let start = ["contact", "--pair", "brass,brass", "--law", "mdr-static", "--fit", "curve.csv", "--json"];
    let fit = desk.run(&start).ok().json();
    let found = fit["constants"]["yield_stress_Pa"]["value"].as_f64().unwrap();
    assert!((found / 1.9e9 - 1.0).abs() < 1e-2 && fit["deviation"].as_f64().unwrap() < 1e-3, "{fit}");
    desk.write("other.csv", "overlap_m,speed_m_s\n1,2\n");
    for wrong in [&["--fit", "other.csv"][..], &["--speeds", "0"], &["--spring-back", "0.5"]] {
        assert_eq!(desk.run(&[&straight[..5], wrong].concat()).code, 2, "{wrong:?}");
    }
}
