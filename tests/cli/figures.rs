//! Figures for papers: their sizes, letters and kinds of files; own materials; pages that are handed on.

use roxmltree::Document;

use super::Desk;

/// Own materials alone, without a design: one of them has the values of the library's 440c.
fn shelf() -> String {
    let steel = granulens::material::find("440c", &[]).unwrap();
    let of = |name: &str, density: f64| {
        format!(
            "[materials.{name}]\ndensity = \"{density} kg/m3\"\nyoungs_modulus = \"{} Pa\"\npoisson_ratio = {}\n\
             yield_stress = \"{} Pa\"\nrate_constant = {}\nsource = \"test\"\n",
            steel.youngs_modulus, steel.poisson_ratio, steel.yield_stress, steel.rate_constant
        )
    };
    of("my-steel", steel.density)
        + &of("light", 0.5 * steel.density)
        + &of("heavy", 2.0 * steel.density)
        + &of("middle", 1.1 * steel.density)
}

#[test]
fn own_materials_need_no_design() {
    let desk = Desk::new();
    desk.write("my.toml", shelf());
    let speed =
        |arguments: &[&str]| desk.run(&[&["speed", "--json"], arguments].concat()).ok().json()["speed_m_s"].clone();
    assert_eq!(speed(&["--material", "my-steel", "--materials", "my.toml"]), speed(&["--material", "440c"]));
    let contact =
        |arguments: &[&str]| desk.run(&[&["contact", "--json", "--law", "thesis"], arguments].concat()).ok().json();
    assert_eq!(contact(&["--pair", "my-steel,brass", "--materials", "my.toml"]), contact(&["--pair", "440c,brass"]));
    let listed = desk.run(&["surface", "--materials", "my.toml", "--json"]).ok().stdout;
    assert!(listed.contains("my-steel"), "{listed}");
    // All that is wrong is told.
    desk.write("wrong.toml", shelf().replace("kg/m3", "kg").replace("poisson_ratio = ", "poisson_ratio = 2"));
    let refused = desk.run(&["speed", "--material", "440c", "--materials", "wrong.toml", "--json"]);
    let error = refused.json_error();
    assert_eq!((refused.code, error["others"].as_array().unwrap().len()), (2, 7), "{error}");
    let unknown = desk.run(&["speed", "--material", "440c", "--materials", "none.toml"]);
    assert!(unknown.code == 2 && unknown.stderr.contains("no such file"), "{}", unknown.stderr);
}

/// In a column of 86 mm letters have the size asked for, indices stand below the line, and nothing lies outside.
#[test]
fn a_figure_for_a_column_has_its_width_and_letters() {
    let desk = Desk::new();
    let paper = ["--width", "86 mm", "--font-size", "8"];
    let calls: [&[&str]; 3] = [
        &["surface", "--out", "a.svg", "--no-dimers"],
        &["surface", "--x", "yield-stress", "--y", "amplitude", "--out", "b.svg", "--palette", "grey"],
        &["contact", "--pair", "440c,brass", "--out", "c.svg"],
    ];
    for call in calls {
        desk.run(&[call, &paper].concat()).ok();
        let text = desk.read(call[call.iter().position(|word| *word == "--out").unwrap() + 1]);
        let svg = Document::parse(&text).unwrap();
        let root = svg.root_element();
        assert_eq!(root.attribute("width"), Some("86.000mm"), "{call:?}");
        let view: Vec<f64> = root.attribute("viewBox").unwrap().split(' ').map(|x| x.parse().unwrap()).collect();
        let points_of_a_pixel = 86.0 / 25.4 * 72.0 / view[2];
        for node in svg.descendants().filter(|node| node.has_tag_name("text")) {
            let size: f64 = node.attribute("font-size").unwrap().parse().unwrap();
            let size = size * points_of_a_pixel;
            assert!((7.0..=9.5).contains(&size), "{call:?}: {size} points: {:?}", node.text());
            let place = |name: &str| node.attribute(name).unwrap().parse::<f64>().unwrap();
            assert!((0.0..=view[2]).contains(&place("x")) && (0.0..=view[3]).contains(&place("y")), "{call:?}");
            assert!(!node.text().unwrap_or_default().contains("F_p"), "{call:?}");
        }
    }
    let refused = desk.run(&["surface", "--out", "a.svg", "--width", "5 mm"]);
    assert!(refused.code == 2 && refused.stderr.contains("30 mm"), "{}", refused.stderr);
    let refused = desk.run(&["surface", "--out", "a.svg", "--font-size", "8"]);
    assert_eq!(refused.code, 2, "letters have a size where a width is given");
}

/// A page of the width asked for, for every command that draws.
#[test]
fn figures_are_written_as_pdf() {
    let desk = Desk::with_layout();
    let calls: [(&[&str], &str); 4] = [
        (&["surface", "--out", "s.pdf", "--width", "86 mm"], "s.pdf"),
        (&["contact", "--pair", "440c,440c", "--out", "c.pdf", "--width", "86 mm"], "c.pdf"),
        (&["trace", "small.toml", "--out", "t.pdf", "--spots", "spots.pdf"], "t.pdf"),
        (&["report", "small.toml", "small.csv", "--pdf", "--out", "r", "--forces", "1"], "r/kinetic-lens.pdf"),
    ];
    for (call, file) in calls {
        desk.run(call).ok();
        let bytes = std::fs::read(desk.path(file)).unwrap();
        let text = String::from_utf8_lossy(&bytes);
        assert!(text.starts_with("%PDF-") && text.contains("/Helvetica") && text.ends_with("%%EOF"), "{call:?}");
        if call.contains(&"86 mm") {
            assert!(text.contains("/MediaBox [0 0 243.77"), "{call:?}");
        }
    }
    assert!(desk.path("spots.pdf").is_file() && desk.path("r/report.html").is_file());
}

/// The curve as a table is what the law says state by state.
#[test]
fn a_contact_s_curve_is_written_as_csv() {
    let desk = Desk::new();
    desk.run(&["contact", "--pair", "440c,brass", "--law", "thesis", "--out", "curve.csv"]).ok();
    let rows: Vec<Vec<f64>> = desk
        .read("curve.csv")
        .lines()
        .skip(1)
        .map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect())
        .collect();
    assert_eq!(rows.len(), 401);
    for (speed, column) in [(0.0, 1), (10.0, 2)] {
        let states: String = rows.iter().map(|row| format!("{:e},{speed},0,0\n", row[0])).collect();
        desk.write("states.csv", format!("d,v,dmax,Fmax\n{states}"));
        let told =
            desk.run(&["contact", "--pair", "440c,brass", "--law", "thesis", "--states", "states.csv"]).ok().stdout;
        let forces: Vec<f64> =
            told.lines().skip(1).map(|line| line.split(',').nth(4).unwrap().parse().unwrap()).collect();
        assert_eq!(forces.len(), rows.len());
        for (row, force) in rows.iter().zip(forces) {
            assert!((row[column] - force).abs() <= 1e-9 * force.abs(), "{row:?} {force}");
        }
    }
}

/// Of a crowd no name lies on another; what is chosen is drawn, and what is not known is told.
#[test]
fn a_crowd_of_media_stays_legible() {
    let desk = Desk::new();
    desk.write("my.toml", shelf());
    let draw = |more: &[&str]| {
        desk.run(&[&["surface", "--materials", "my.toml", "--out", "crowd.svg", "--force"], more].concat()).ok();
        let text = desk.read("crowd.svg");
        let svg = Document::parse(&text).unwrap();
        let names = svg
            .descendants()
            .filter(|node| node.attribute("paint-order").is_some() && node.attribute("font-weight").is_some());
        names
            .map(|node| {
                let number = |name: &str| node.attribute(name).unwrap().parse::<f64>().unwrap();
                let text: String =
                    node.descendants().filter_map(|part| part.text().filter(|_| part.is_text())).collect();
                ([number("x"), number("y")], number("font-size"), text)
            })
            .collect::<Vec<_>>()
    };
    let crowd = draw(&[]);
    assert!(crowd.len() > 20, "{}", crowd.len());
    for (k, ([x, y], size, text)) in crowd.iter().enumerate() {
        for ([other_x, other_y], _, other) in &crowd[..k] {
            // Letters are half as wide as high, rather more.
            let [left, right] = if x < other_x { [(x, text), (other_x, other)] } else { [(other_x, other), (x, text)] };
            let beside = left.0 + 0.5 * size * left.1.chars().count() as f64 <= *right.0 + 1.0;
            assert!(beside || (y - other_y).abs() >= 0.9 * size, "{text} on {other}");
        }
    }
    assert!(draw(&["--no-dimers"]).iter().all(|(_, _, text)| !text.contains('+')));
    let only = draw(&["--only", "440c,brass+440c"]);
    assert_eq!(only.len(), 2, "{only:?}");
    let named = draw(&["--label", "my-steel"]);
    assert!(named.len() == 1 && named[0].2.starts_with("my-steel: "), "{named:?}");
    let refused = desk.run(&["surface", "--out", "x.svg", "--only", "unobtainium"]);
    assert!(refused.code == 2 && refused.stderr.contains("There are "), "{}", refused.stderr);
}

/// One file, small, without script or foreign requests, with what repeats it.
#[test]
fn pages_can_be_handed_on() {
    let desk = Desk::with_layout();
    desk.write("study.toml", super::studies::STUDY);
    desk.write("rig.toml", super::kept::RIG);
    let calls: [(&[&str], &str, &str); 4] = [
        (&["run", "small.toml", "--out", "run", "--seed", "3"], "run/report.html", "granulens run small.toml --seed 3"),
        (
            &["report", "small.toml", "small.csv", "--out", "own"],
            "own/report.html",
            "granulens report small.toml small.csv",
        ),
        (&["study", "run", "study.toml", "--out", "s"], "s/report.html", "granulens study run study.toml --seed 1"),
        (&["simulate", "rig.toml", "--out", "rig"], "rig/report.html", "granulens simulate rig.toml"),
    ];
    for (call, file, command) in calls {
        desk.run(&[call, &["--quiet"]].concat()).ok();
        let page = desk.read(file);
        assert!(page.len() < 1_500_000, "{file}: {}", page.len());
        assert!(!page.contains("<script") && !page.contains("src=\"http") && !page.contains("@import"), "{file}");
        for words in [command, "CRC-32 ", ", commit ", "prefers-color-scheme: dark", "@media print", "viewport"] {
            assert!(page.contains(words), "{file}: {words}");
        }
        // What it comes to, then pictures, then tables.
        let place = |words: &str| page.find(words).unwrap_or_else(|| panic!("{file}: {words}"));
        assert!(place("<h1>") < place("<figure") && place("<figure") < place("id=\"repeat\""), "{file}");
    }
    // The numbers of maps and profiles, sphere by sphere.
    let spheres = desk.read("run/spheres.csv");
    let outcome = desk.json("run/outcome.json");
    let arrangements = outcome["arrangements"].as_array().unwrap().len();
    assert_eq!(spheres.lines().count(), 1 + 60 * arrangements);
    // Results are drawn anew from their numbers alone.
    for folder in ["run", "s", "rig"] {
        let before = desk.read(&format!("{folder}/report.html"));
        desk.run(&["report", folder, "--quiet"]).ok();
        let drawn = if folder == "run" { "run-drawn" } else { folder };
        let body = |page: &str| page.split("<!--").next().unwrap().to_owned();
        assert_eq!(body(&desk.read(&format!("{drawn}/report.html"))), body(&before), "{folder}");
    }
    let refused = desk.run(&["report", ".", "--quiet"]);
    assert!(refused.code == 2 && refused.stderr.contains("holds no results"), "{}", refused.stderr);
}
