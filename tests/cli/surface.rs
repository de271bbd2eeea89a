//! `surface`: the picture and its numbers, tables of pairs, and what gives a wanted speed.

use serde_json::Value;

use super::{Desk, keys};

fn labels(value: &Value) -> Vec<&str> {
    value["media"].as_array().unwrap().iter().map(|medium| medium["label"].as_str().unwrap()).collect()
}

/// The picture names both axes with units, and every medium; the table behind it holds the closed form.
#[test]
fn the_surface_is_drawn_with_its_numbers_beside_it() {
    let desk = Desk::new();
    let ran = desk.run(&["surface", "--out", "made/surface.svg"]).ok();
    assert!(ran.stdout.is_empty() && ran.stderr.contains("surface.csv"), "{}", ran.stderr);
    let svg = desk.read("made/surface.svg");
    assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"));
    for words in
        ["(MN/m)", "(kg/m³)", "speed (m/s)", "al+wc: 629", "440c: 1345", "brass: 791", "ρ×5: 492", "ρ×0.2: 3011"]
    {
        assert!(svg.contains(words), "{words}");
    }
    let csv = desk.read("made/surface.csv");
    let mut lines = csv.lines();
    assert_eq!(lines.next(), Some("kind,name,stiffness_N_m,density_kg_m3,speed_m_s"));
    let (mut nodes, mut media) = (0, 0);
    for line in lines {
        // A name may hold a comma, and stands in quotes then as always.
        let numbers: Vec<f64> = line.rsplitn(4, ',').take(3).map(|cell| cell.parse().unwrap()).collect();
        let [speed, density, stiffness] = numbers[..] else { panic!("{line}") };
        let exact = (3.0 * stiffness / (std::f64::consts::PI * 3.175e-3 * density)).sqrt();
        assert!((speed / exact - 1.0).abs() < 1e-12, "{line}");
        if line.starts_with("grid,") { nodes += 1 } else { media += 1 }
    }
    assert_eq!((nodes, media), (97 * 73, 17));
    desk.run(&["surface", "--out", "again.svg", "--quiet"]).ok();
    assert_eq!((desk.read("again.svg"), desk.read("again.csv")), (svg, csv));
}

/// Every value alone is drawn, over axes that matter to it, and every value with one axis given over another.
#[test]
fn every_value_has_axes_of_its_own() {
    let desk = Desk::new();
    for value in ["speed", "speed-ratio", "critical-angle", "impedance-ratio", "plastic-force", "dissipation"] {
        desk.run(&["surface", "--value", value, "--out", "alone.svg"]).ok();
        let csv = desk.read("alone.csv");
        let shown: Vec<&str> = csv.lines().next().unwrap().split(',').skip(2).collect();
        let expected = match value {
            "plastic-force" | "dissipation" => ["yield_stress_Pa", "youngs_modulus_Pa"],
            _ => ["stiffness_N_m", "density_kg_m3"],
        };
        assert_eq!(shown[..2], expected, "{value}");
        for axis in ["--x", "--y"] {
            desk.run(&["surface", "--value", value, axis, "modulus", "--out", "one.svg"]).ok();
        }
    }
}

#[test]
fn any_two_variables_make_a_surface() {
    let desk = Desk::new();
    let axes = ["stiffness", "density", "yield-stress", "modulus", "radius", "amplitude", "dimension"];
    // What has an influence on each value, and under which name it is stored.
    let values: [(&str, &str, &[&str]); 6] = [
        ("speed", "speed_m_s", &["stiffness", "density", "yield-stress", "modulus", "amplitude", "dimension"]),
        ("speed-ratio", "speed_ratio", &["stiffness", "density", "yield-stress", "modulus", "amplitude"]),
        ("critical-angle", "critical_angle_rad", &["stiffness", "density", "yield-stress", "modulus", "amplitude"]),
        ("impedance-ratio", "impedance_ratio", &["stiffness", "density", "yield-stress", "modulus", "amplitude"]),
        ("plastic-force", "fully_plastic_force_N", &["yield-stress", "modulus", "radius"]),
        ("dissipation", "dissipation_J", &["yield-stress", "modulus", "radius", "amplitude"]),
    ];
    for (value, column, influences) in values {
        for (x, y) in axes.iter().flat_map(|x| axes.iter().map(move |y| (*x, *y))) {
            // Both ways round look alike but for speeds.
            if value != "speed" && y < x {
                continue;
            }
            let follows =
                [x, y].contains(&"stiffness") && (["yield-stress", "modulus"].iter().any(|a| [x, y].contains(a)));
            let call =
                ["surface", "--value", value, "--against", "brass", "--x", x, "--y", y, "--out", "s.svg", "--json"];
            let ran = desk.run(&call);
            if x == y || follows || !influences.contains(&x) || !influences.contains(&y) {
                assert_eq!((ran.code, ran.stdout.as_str()), (2, ""), "{value} {x} {y}");
                continue;
            }
            let json = ran.ok().json();
            assert_eq!((&json["x"]["axis"], &json["y"]["axis"]), (&x.into(), &y.into()));
            assert!(json[column].as_array().is_some_and(|values| !values.is_empty()), "{value} {x} {y}");
            let svg = desk.read("s.svg");
            assert!(!svg.contains("NaN") && !svg.contains("inf"), "{value} {x} {y}");
        }
    }
}

/// The page needs no network and holds the numbers of every node and medium; what its script does is looked at in a browser.
#[test]
fn a_surface_is_a_page_too() {
    let desk = Desk::new();
    let call =
        ["surface", "--value", "dissipation", "--x", "yield-stress", "--y", "radius", "--out", "s.html", "--json"];
    let json = desk.run(&call).ok().json();
    let page = desk.read("s.html");
    assert!(page.starts_with("<!doctype html>") && page.trim_end().ends_with("</html>"));
    assert!(!page.contains("http://") || page.matches("http://").count() == page.matches("http://www.w3.org").count());
    let data = page.split("const data = ").nth(1).unwrap().split(";\n").next().unwrap();
    let data: Value = serde_json::from_str(data).unwrap();
    assert_eq!(data["values"], json["dissipation_J"]);
    assert_eq!(data["media"].as_array().unwrap().len(), 17);
    assert_eq!(data["y"]["unit"], 1e-3);
}

#[test]
fn fixed_values_and_ranges_are_those_given() {
    let desk = Desk::new();
    let json = desk
        .run(&[
            "surface",
            "--x",
            "yield-stress",
            "--y",
            "amplitude",
            "--x-range",
            "500 MPa..1.9 GPa",
            "--y-range",
            "2..10",
            "--modulus",
            "200 GPa",
            "--density",
            "7.65 g/cm3",
            "--out",
            "s.svg",
            "--json",
        ])
        .ok()
        .json();
    let end = |value: &Value| value.as_array().unwrap().last().unwrap().as_f64().unwrap();
    assert_eq!((end(&json["x"]["values"]), end(&json["y"]["values"])), (1.9e9, 10.0));
    // 440c, which hardens, at 10 F_p: simulated 1.118 of 1344.7 m/s (tests/physics/amplitude.rs), to the 1 % that is stated.
    assert!((end(&json["speed_m_s"]) / (1.118 * 1344.7) - 1.0).abs() < 0.01);
    let flat = desk.run(&["surface", "--dimension", "2", "--json"]).ok().json();
    assert_eq!((flat["dimension"].as_u64(), labels(&flat).len()), (Some(2), 17));
}

/// Burgoyne 2016, section 4.3: aluminium and tungsten carbide in turn at 629 m/s.
#[test]
fn media_of_a_speed_are_found_lightest_first() {
    let desk = Desk::new();
    let found = desk.run(&["surface", "--find-speed", "629 m/s", "--tolerance", "2 %", "--json"]).ok().json();
    assert_eq!(labels(&found), ["al+wc"]);
    let wide = desk.run(&["surface", "--find-speed", "800 m/s", "--tolerance", "20 %", "--json"]).ok().json();
    let density = |m: &Value| m["density_kg_m3"].as_f64().unwrap();
    let media = wide["media"].as_array().unwrap();
    assert!(media.len() > 4 && media.windows(2).all(|w| density(&w[0]) <= density(&w[1])));
    let none = desk.run(&["surface", "--find-speed", "9 km/s"]).ok();
    assert!(none.stderr.contains("no medium gives 9 km/s within 2 %"), "{}", none.stderr);

    let heavy = ["surface", "--find-speed", "492 m/s", "--coated", "al:5:wc", "--hollow", "wc:0.5", "--json"];
    let found = desk.run(&heavy).ok().json();
    assert_eq!(labels(&found), ["wc core in al, ρ×5"]);
    let medium = &found["media"][0];
    assert!(medium["core_force_N"].as_f64().unwrap() < medium["fully_plastic_force_N"].as_f64().unwrap());
}

#[test]
fn pairs_are_listed_and_found_by_their_ratio() {
    let desk = Desk::new();
    let all = desk.run(&["surface", "--ratios", "--dimension", "2", "--json"]).ok().json();
    assert_eq!(all["pairs"].as_array().unwrap().len(), 10);
    desk.run(&["surface", "--ratios", "--dimension", "2", "--out", "pairs.json", "--quiet"]).ok();
    assert_eq!(desk.json("pairs.json"), all);
    let found = desk.run(&["surface", "--find-ratio", "1.7", "--tolerance", "1 %", "--json"]).ok().json();
    let lens = found["pairs"].as_array().unwrap().iter().find(|pair| pair["slower"] == "brass-260").unwrap();
    assert_eq!(lens["faster"], "stainless-440c");
    assert!((lens["critical_angle_deg"].as_f64().unwrap() - 36.04).abs() < 0.01);
    assert_eq!(keys(lens)[..5], ["faster", "slower", "speed_faster_m_s", "speed_slower_m_s", "speed_ratio"]);
    let more = desk.run(&["surface", "--find-ratio", "1.7", "--tolerance", "1 %", "--dimers", "--json"]).ok().json();
    assert!(more["pairs"].as_array().unwrap().len() > found["pairs"].as_array().unwrap().len());
    let text = desk.run(&["surface", "--ratios"]).ok();
    assert!(text.stdout.starts_with("faster") && text.stdout.lines().count() == 12, "{}", text.stdout);
}

#[test]
fn wrong_requests_are_refused_in_words() {
    let desk = Desk::new();
    let calls: [(&[&str], &str); 23] = [
        (&["--x", "radius", "--out", "s.svg"], "speed does not depend on radius"),
        (&["--value", "plastic-force", "--x", "density", "--out", "s.svg"], "plastic-force does not depend on density"),
        (&["--x", "raduis"], "invalid value 'raduis'"),
        (&["--x", "density", "--y", "density", "--out", "s.svg"], "both axes are density"),
        (&["--x", "modulus", "--y", "stiffness", "--out", "s.svg"], "stiffness follows from modulus"),
        (&["--out", "s.bmp"], "drawn as SVG, PDF or PNG, or as a page"),
        (&["--x-range", "1 MN/m", "--out", "s.svg"], "expected FROM..TO"),
        (&["--x-range", "1..2 MN/m", "--out", "s.svg"], "\"1\" has no unit"),
        (&["--x-range", "2 MN/m..1 MN/m", "--out", "s.svg"], "upper end must lie above"),
        (&["--x-range", "-2 MN/m..1 MN/m", "--out", "s.svg"], "--x-range must be positive"),
        (&["--density", "7 kg/m3", "--out", "s.svg"], "is an axis too"),
        (&["--modulus", "200 GPa", "--out", "s.svg"], "stiffness follows from yield stress and modulus"),
        (&["--amplitude", "0.3"], "below 0.35 F_p"),
        (&["--x", "amplitude", "--x-range", "0.3..5", "--out", "s.svg"], "below 0.35 F_p"),
        (&["--material", "bras"], "did you mean \"brass\"?"),
        (&["--find-speed", "629"], "has no unit"),
        (&["--find-speed", "-629 m/s"], "--find-speed must be positive"),
        (&["--find-speed", "629 m/s", "--tolerance", "2"], "--tolerance: \"2\" has no unit"),
        (&["--find-ratio", "0.5"], "is at least 1"),
        (&["--find-ratio", "1.7", "--ratios"], "cannot be used with"),
        (&["--coated", "al:7:wc"], "cannot weigh 18900 kg/m3"),
        (&["--coated", "al:5"], "expected SHELL:FACTOR:CORE"),
        (&["--hollow", "wc:1.5"], "between 0 and 1, not 1.5"),
    ];
    for (arguments, words) in calls {
        let ran = desk.run(&[&["surface"], arguments].concat());
        assert_eq!((ran.code, ran.stdout.as_str()), (2, ""), "{arguments:?}: {}", ran.stderr);
        assert!(ran.stderr.contains(words), "{arguments:?}: {}", ran.stderr);
        let error = desk.run(&[&["surface"], arguments, &["--json"]].concat()).json_error();
        assert_eq!(error["kind"], "input", "{arguments:?}");
    }
    assert_eq!(desk.names(), ["small.toml"]);
}

/// Cheapest first by the price of a sphere; what has no price comes last. Twice: among media and among pairs.
#[test]
fn what_is_found_is_listed_by_price_where_prices_are_given() {
    let desk = Desk::new();
    let priced = desk.read("small.toml")
        + "\n[prices]\nstainless-440c = 30\nbrass-260 = 9\nmy-steel = 1\n[materials.my-steel]\ndensity = \"7800 kg/m3\"\n\
           youngs_modulus = \"205 GPa\"\npoisson_ratio = 0.29\nyield_stress = \"1.8 GPa\"\nrate_constant = 0.0\n\
           source = \"made up\"\n";
    desk.write("priced.toml", &priced);
    let wide = ["surface", "--find-speed", "1000 m/s", "--tolerance", "60 %", "--materials", "priced.toml", "--json"];
    let found = desk.run(&[&wide[..], &["--sort", "price"]].concat()).ok().json();
    let prices: Vec<Option<f64>> =
        found["media"].as_array().unwrap().iter().map(|medium| medium["price_of_a_sphere"].as_f64()).collect();
    let known = prices.iter().take_while(|price| price.is_some()).count();
    assert!(known >= 5 && prices[known..].iter().all(Option::is_none), "{prices:?}");
    assert!(prices[..known].windows(2).all(|pair| pair[0] <= pair[1]), "{prices:?}");
    assert_eq!((labels(&found)[0], prices[0]), ("my-steel", Some(1.0)));
    let ratios = ["surface", "--ratios", "--materials", "priced.toml", "--sort", "price", "--json"];
    let pairs = desk.run(&ratios).ok().json();
    let first = &pairs["pairs"][0];
    assert_eq!((&first["faster"], &first["slower"]), (&"my-steel".into(), &"brass-260".into()));
    let none = desk.run(&["surface", "--find-speed", "1000 m/s", "--sort", "price"]);
    assert!(none.code == 2 && none.stderr.contains("there are no prices"), "{}", none.stderr);
    // The proposal's cost: spheres of both halves, each at its price.
    let proposal = &desk.run(&["design", "priced.toml", "--json"]).ok().json()["proposal"];
    let counts: Vec<f64> =
        proposal["piece"]["counts"].as_array().unwrap().iter().map(|count| count.as_f64().unwrap()).collect();
    let cost = counts[0] * 30.0 + counts[1] * 9.0;
    assert!((proposal["piece"]["cost"].as_f64().unwrap() / cost - 1.0).abs() < 1e-12);
    for (line, words) in [("brass-260 = -9", "must not be negative"), ("gold = 9", "is the price of no known material")]
    {
        desk.write("wrong.toml", priced.replace("brass-260 = 9", line));
        let ran = desk.run(&["design", "wrong.toml"]);
        assert!(ran.code == 2 && ran.stderr.contains(words) && ran.stderr.contains("prices."), "{}", ran.stderr);
    }
}
