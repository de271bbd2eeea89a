//! What a workshop gets, and what differs between two layouts.

use std::collections::BTreeMap;

use super::{Desk, shipped};

/// The small piece: odd rows of 9 spheres, even rows of 10.
const SPHERES: usize = 6 * 9 + 6 * 10;

const FILES: [&str; 14] = [
    "build.json",
    "frame.3mf",
    "frame.stl",
    "inspection.csv",
    "layout-full.csv",
    "manifest.json",
    "map-a3.pdf",
    "map-a4.pdf",
    "map-letter.pdf",
    "map.dxf",
    "map.svg",
    "parts.csv",
    "placement.csv",
    "placement.pdf",
];

/// A desk with the small layout built.
fn built(more: &[&str]) -> (Desk, super::Ran) {
    let desk = Desk::with_layout();
    let ran = desk.run(&[&["build", "small.csv", "--design", "small.toml", "--out", "shop", "--json"], more].concat());
    (desk, ran)
}

fn lines(text: &str) -> Vec<Vec<&str>> {
    text.lines().filter(|line| !line.starts_with('#')).skip(1).map(|line| line.split(',').collect()).collect()
}

fn number(text: &str) -> f64 {
    text.parse().unwrap_or_else(|_| panic!("{text} is no number"))
}

/// Counts are those of the full layout, masses those of solid spheres by hand, spares a twentieth rounded up; a second build replaces
/// the first, a folder of something else stays.
#[test]
fn a_workshop_gets_every_file_and_counts_that_agree() {
    let (desk, ran) = built(&[]);
    let told = ran.ok().json();
    assert_eq!(super::names(&desk.path("shop")), FILES);
    let full = desk.read("shop/layout-full.csv");
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    lines(&full).iter().for_each(|line| *counts.entry(line[5]).or_default() += 1);
    assert_eq!(counts.values().sum::<usize>(), SPHERES);
    assert_eq!(told["spheres"], SPHERES);
    let parts = told["parts"].as_array().unwrap();
    assert_eq!(parts.len(), counts.len());
    for part in parts {
        let count = counts[part["material"].as_str().unwrap()];
        let density = if part["material"] == "brass-260" { 8530.0 } else { 7650.0 };
        let mass = count as f64 * density * std::f64::consts::PI / 6.0 * 6.35e-3_f64.powi(3);
        assert_eq!(part["count"], count);
        assert_eq!(part["spares"], count.div_ceil(20));
        assert!((part["mass_kg"].as_f64().unwrap() / mass - 1.0).abs() < 1e-12);
        assert!(part["cost"].is_null(), "the design names no prices");
    }
    let placement = desk.read("shop/placement.csv");
    for (placed, line) in lines(&placement).iter().zip(lines(&full)) {
        assert_eq!((&placed[..2], placed[5]), (&line[..2], line[5]));
        assert!((number(placed[2]) - 1e3 * number(line[2])).abs() < 1e-4);
    }
    assert_eq!(lines(&placement).len(), SPHERES);
    // Both mirrors by another machine and another scheme: the same crystal to the accuracy class of the step.
    let check =
        desk.run(&["check", "small.csv", "--design", "small.toml", "--integrator", "verlet", "--json"]).ok().json();
    let walls = told["walls"].as_array().unwrap();
    assert_eq!(walls.len(), 3);
    let [as_rig, as_check] = [&walls[0]["contrast"], &check["contrast"]].map(|value| value.as_f64().unwrap());
    assert!((as_rig / as_check - 1.0).abs() < 1e-6, "{as_rig} {as_check}");

    desk.run(&["build", "small.csv", "--design", "small.toml", "--out", "shop", "--spares", "50 %"]).ok();
    assert_eq!(desk.json("shop/build.json")["parts"][0]["spares"], (counts["stainless-440c"]).div_ceil(2));
    std::fs::create_dir(desk.path("mine")).unwrap();
    desk.write("mine/notes.txt", "keep");
    assert_eq!(desk.run(&["build", "small.csv", "--design", "small.toml", "--out", "mine"]).code, 2);
    assert_eq!(desk.read("mine/notes.txt"), "keep");
}

/// A yield of 60 % at least asks for four sets: 1 − 0.4⁴ = 97.4 %, 1 − 0.4³ = 93.6 %. Of another design it is refused, and where nothing does.
#[test]
fn spares_follow_from_a_yield() {
    let desk = Desk::with_layout();
    let tolerance = |folder: &str, contrast: f64| {
        let file =
            format!("format = 1\n[diameter]\ngrade = \"G100\"\n[thresholds]\ncontrast = {{ min = {contrast:?} }}\n");
        desk.write("asked.toml", file);
        let asked = ["tolerance", "small.csv", "--design", "small.toml", "--tolerances", "asked.toml"];
        desk.run(&[&asked[..], &["--samples", "12", "--out", folder]].concat()).ok();
    };
    tolerance("easy", 1e-3);
    let build = |from: &str, design: &str| {
        desk.run(&["build", "small.csv", "--design", design, "--out", "shop", "--yield", from, "--json"])
    };
    let told = build("easy", "small.toml").ok().json();
    // 12 of 12: Wilson's interval begins at 12/(12 + 1.96²) = 75.7 %, and 0.243² is 5.9 %, 0.243³ 1.4 %.
    assert!(
        (told["spares"]["yield"]["interval"][0].as_f64().unwrap() - 12.0 / (12.0 + 1.959_964_f64.powi(2))).abs() < 1e-6
    );
    assert_eq!(told["spares"]["sets"], 3);
    for part in told["parts"].as_array().unwrap() {
        let count = part["count"].as_u64().unwrap();
        assert_eq!(part["spares"], count.div_ceil(20) + 2 * count);
    }
    tolerance("hard", 1e3);
    let refused = build("hard/tolerance.json", "small.toml");
    assert!(refused.code == 2 && refused.stderr.contains("spares do not help"), "{}", refused.stderr);
    desk.design_with("other.toml", "name = \"small\"", "name = \"other\"");
    let refused = build("easy", "other.toml");
    assert!(refused.code == 2 && refused.stderr.contains("of the design small, not of other"), "{}", refused.stderr);
    let refused = build("small.csv", "small.toml");
    assert!(refused.code == 2 && refused.stderr.contains("is no tolerance.json"), "{}", refused.stderr);
}

#[test]
fn costs_are_the_prices_of_the_design_file() {
    let desk = Desk::with_layout();
    desk.write("priced.toml", format!("{}[prices]\nbrass-260 = 0.5\nstainless-440c = 0.25\n", super::SMALL));
    let told = desk.run(&["build", "small.csv", "--design", "priced.toml", "--out", "shop", "--json"]).ok().json();
    let mut sum = 0.0;
    for part in told["parts"].as_array().unwrap() {
        let [count, spares] = ["count", "spares"].map(|key| part[key].as_f64().unwrap());
        let cost = (count + spares) * if part["material"] == "brass-260" { 0.5 } else { 0.25 };
        assert_eq!(part["cost"], cost);
        sum += cost;
    }
    assert_eq!(told["cost"], sum);
    assert!(desk.read("shop/parts.csv").lines().last().unwrap().ends_with(&format!(",{sum:.2}")));
}

/// What stands between `stream` and `endstream`.
fn streams(pdf: &[u8]) -> Vec<String> {
    let text = String::from_utf8_lossy(pdf).into_owned();
    text.split("\nstream\n")
        .filter_map(|part| part.split_once("\nendstream").map(|(body, _)| body.to_owned()))
        .collect()
}

/// Straight lines of a page, in the units of its content.
fn segments(content: &str) -> Vec<[f64; 4]> {
    let lines: Vec<&str> = content.lines().collect();
    let pairs = lines.windows(2).filter(|pair| pair[0].ends_with(" m") && pair[1].ends_with(" l"));
    let numbers = |line: &str| -> Vec<f64> { line.split(' ').filter_map(|word| word.parse().ok()).collect() };
    pairs.map(|pair| [numbers(pair[0]), numbers(pair[1])].concat().try_into().unwrap()).collect()
}

/// A point is 1/72 inch: a page's matrix turns millimetres into 2.834646 points, its sheet has the size of the paper, and two rulers on
/// each are 100 mm long. Spheres are circles of 6.35 mm, and every one of them is on the map.
#[test]
fn a_hundred_millimetres_are_a_hundred_millimetres_in_the_pdf() {
    let (desk, ran) = built(&[]);
    ran.ok();
    for (paper, size) in [("a4", [210.0, 297.0]), ("a3", [297.0, 420.0]), ("letter", [215.9, 279.4])] {
        let pdf = std::fs::read(desk.path(&format!("shop/map-{paper}.pdf"))).unwrap();
        let text = String::from_utf8_lossy(&pdf);
        assert!(text.starts_with("%PDF") && text.contains("/PrintScaling /None"));
        let boxes: Vec<Vec<f64>> = text
            .split("/MediaBox [")
            .skip(1)
            .map(|rest| rest.split(']').next().unwrap().split(' ').map(number).collect())
            .collect();
        let streams = streams(&pdf);
        let pages: Vec<&String> = streams.iter().filter(|content| content.starts_with("2.83464")).collect();
        assert!(boxes.len() == pages.len() && pages.len() > 1, "{paper}: {} pages, {} boxes", pages.len(), boxes.len());
        let mut placed = 0;
        for (page, sheet) in pages.iter().zip(&boxes) {
            let matrix: Vec<f64> =
                page.lines().next().unwrap().split(' ').filter_map(|word| word.parse().ok()).collect();
            let points = 72.0 / 25.4;
            assert!((matrix[0] - points).abs() < 1e-6 && (matrix[3] + points).abs() < 1e-6, "{matrix:?}");
            let mut sides = [sheet[2] / matrix[0], sheet[3] / matrix[0]];
            sides.sort_by(f64::total_cmp);
            assert!((sides[0] - size[0]).abs() < 1e-3 && (sides[1] - size[1]).abs() < 1e-3, "{paper}: {sides:?}");
            let long = |across: bool| {
                let of =
                    move |s: &[f64; 4]| if across { [s[2] - s[0], s[3] - s[1]] } else { [s[3] - s[1], s[2] - s[0]] };
                segments(page).iter().map(of).any(|[along, beside]| (along - 100.0).abs() < 1e-4 && beside == 0.0)
            };
            assert!(long(true) && long(false), "{paper}: a ruler of 100 mm is missing");
        }
        // The last pages are at 1:1; a sphere near a seam is on two.
        pages[1..].iter().for_each(|page| placed += page.matches(" Do").count());
        assert!(placed >= SPHERES, "{paper}: {placed}");
        // Symbols: circles about the origin from (r, 0).
        let symbols: Vec<&String> = streams.iter().filter(|content| content.contains("\n3.175 0 m\n")).collect();
        assert_eq!(symbols.len(), 2, "{paper}: two materials");
    }
}

#[test]
fn the_svg_is_in_millimetres() {
    let (desk, ran) = built(&[]);
    ran.ok();
    let text = desk.read("shop/map.svg");
    let document = roxmltree::Document::parse(&text).unwrap();
    let root = document.root_element();
    let view: Vec<f64> = root.attribute("viewBox").unwrap().split(' ').map(number).collect();
    for (name, size) in [("width", view[2]), ("height", view[3])] {
        assert_eq!(number(root.attribute(name).unwrap().strip_suffix("mm").unwrap()), size);
    }
    let spheres: Vec<_> = document
        .descendants()
        .filter(|node| node.attribute("class").is_some_and(|class| class.contains("sphere")))
        .collect();
    // One of each material stands in the legend.
    assert_eq!(spheres.len(), SPHERES + 2);
    let full = desk.read("shop/layout-full.csv");
    for (sphere, line) in spheres.iter().zip(lines(&full)) {
        let circle = sphere.children().find(|node| node.has_tag_name("circle")).unwrap();
        let [x, y, r] = ["cx", "cy", "r"].map(|name| number(circle.attribute(name).unwrap()));
        assert_eq!(2.0 * r, 6.35);
        assert!((x - 1e3 * number(line[2])).abs() < 1e-3 && (y - 1e3 * number(line[3])).abs() < 1e-3);
        let letters: Vec<_> = sphere.children().filter(|node| node.has_tag_name("text")).collect();
        assert_eq!(letters.len(), 1);
    }
}

/// Pairs of a code and a value.
fn tags(dxf: &str) -> Vec<(u16, &str)> {
    let lines: Vec<&str> = dxf.lines().collect();
    lines.chunks(2).map(|pair| (pair[0].trim().parse().unwrap(), pair[1])).collect()
}

#[test]
fn the_dxf_has_a_layer_for_each_material() {
    let (desk, ran) = built(&[]);
    ran.ok();
    let text = desk.read("shop/map.dxf");
    let tags = tags(&text);
    let circles: Vec<_> = tags.split(|tag| tag.0 == 0).filter(|entity| entity.iter().any(|tag| tag.0 == 40)).collect();
    let circles: Vec<_> =
        circles.into_iter().filter(|entity| !entity.iter().any(|tag| tag.0 == 1 || tag.0 == 2)).collect();
    assert_eq!(circles.len(), SPHERES);
    let full = desk.read("shop/layout-full.csv");
    for (circle, line) in circles.iter().zip(lines(&full)) {
        let of = |code: u16| circle.iter().find(|tag| tag.0 == code).unwrap().1;
        assert_eq!(of(8)[2..].to_lowercase(), line[5]);
        assert_eq!(number(of(40)), 3.175);
        assert!(
            (number(of(10)) - 1e3 * number(line[2])).abs() < 1e-9
                && (number(of(20)) + 1e3 * number(line[3])).abs() < 1e-9
        );
    }
}

/// Spheres that carried least come first, and of each material those nearest to nominal go there.
#[test]
fn a_measured_batch_is_sorted_by_where_deviations_matter() {
    let desk = Desk::with_layout();
    let ran = desk.run(&["build", "small.csv", "--design", "small.toml", "--out", "shop"]);
    ran.ok();
    let parts = desk.read("shop/parts.csv");
    // A batch of all that is needed and three more of each, every deviation different.
    let mut batch = "id,material,diameter_mm\n".to_owned();
    let mut serial = 0;
    for part in lines(&parts).iter().filter(|part| part[0] != "all") {
        for _ in 0..part[3].parse::<usize>().unwrap() + 3 {
            serial += 1;
            let sign = if serial % 2 == 0 { 1.0 } else { -1.0 };
            batch += &format!("s{serial},{},{:.5}\n", part[1], 6.35 + sign * 1e-5 * f64::from((serial * 37) % 211));
        }
    }
    desk.write("batch.csv", &batch);
    desk.run(&["build", "small.csv", "--design", "small.toml", "--out", "shop", "--sorted", "batch.csv"]).ok();
    let (sorted, inspection) = (desk.read("shop/sorted.csv"), desk.read("shop/inspection.csv"));
    let (sorted, ranked) = (lines(&sorted), lines(&inspection));
    assert_eq!(sorted.iter().filter(|line| line[0] == "left").count(), 6);
    assert_eq!((sorted.len(), ranked.len()), (SPHERES + 6, SPHERES));
    assert!(ranked.windows(2).all(|pair| number(pair[0][5]) <= number(pair[1][5])));
    let mut ids: Vec<&str> = sorted.iter().map(|line| line[4]).collect();
    ids.sort_unstable();
    ids.dedup();
    assert_eq!(ids.len(), SPHERES + 6, "every sphere of the batch is placed once");
    for material in ["stainless-440c", "brass-260"] {
        let off = |line: &Vec<&str>| number(line[6]).abs();
        let in_order: Vec<f64> = ranked
            .iter()
            .filter(|line| line[4] == material)
            .map(|line| off(sorted.iter().find(|placed| placed[..2] == line[1..3]).unwrap()))
            .collect();
        assert!(in_order.windows(2).all(|pair| pair[0] <= pair[1]), "{material}: {in_order:?}");
        let left = sorted.iter().filter(|line| line[0] == "left" && line[3] == material).map(off);
        assert!(left.fold(f64::INFINITY, f64::min) >= *in_order.last().unwrap());
    }

    let short: String = batch.lines().take(100).map(|line| format!("{line}\n")).collect();
    for (batch, says) in [
        (short, "missing are"),
        (batch.replace("diameter_mm", "diameter"), "the header is"),
        (batch.replacen("6.3", "0.0063", 1), "is not within 5 %"),
        (batch.replacen("brass-260", "brsas", 1), "unknown"),
        (batch.replacen("s2,", "s1,", 1), "is given twice"),
    ] {
        desk.write("bad.csv", batch);
        let refused = desk.run(&["build", "small.csv", "--design", "small.toml", "--out", "no", "--sorted", "bad.csv"]);
        assert_eq!((refused.code, refused.stderr.contains(says)), (2, true), "{says}: {}", refused.stderr);
        assert!(!desk.path("no").exists());
    }
}

/// The frame as STL: closed, and around the piece; the drawing as DXF; the pages as PDF: read back by ezdxf, trimesh and pypdf, where Python
/// has them.
#[test]
fn others_read_back_what_is_written() {
    let (desk, ran) = built(&[]);
    ran.ok();
    let python = std::env::var_os("PYTHON").unwrap_or_else(|| "python3".into());
    let output =
        std::process::Command::new(python).arg(shipped("tests/python/read_back.py")).arg(desk.path("shop")).output();
    match output {
        Ok(output) if output.status.code() == Some(77) => {
            eprint!("skipped: {}", String::from_utf8_lossy(&output.stderr))
        }
        Ok(output) => assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr)),
        Err(error) => eprintln!("skipped: no Python: {error}"),
    }
}

#[test]
fn a_difference_is_listed_and_what_it_does() {
    let desk = Desk::with_layout();
    let text = desk.read("small.csv");
    // The first brass sphere, on the axis or beside it.
    let line = text.lines().find(|line| line.ends_with("brass-260")).unwrap();
    let cells: Vec<&str> = line.split(',').collect();
    desk.write("other.csv", text.replacen(line, &line.replace("brass-260", "stainless-440c"), 1));
    let told = desk.run(&["diff", "small.csv", "other.csv", "--json"]).ok().json();
    let copies = if number(cells[2]) > 0.0 { 2 } else { 1 };
    assert_eq!((&told["sites"], &told["spheres"]), (&1.into(), &copies.into()));
    let change = &told["changes"][0];
    assert_eq!([&change["row"], &change["column"]].map(ToString::to_string), [cells[0], cells[1]]);
    assert_eq!([&change["from"], &change["to"]], ["brass-260", "stainless-440c"]);
    assert!(told.get("contrast").is_none());
    let same = desk.run(&["diff", "small.csv", "small.csv"]).ok();
    assert!(same.stdout.starts_with("0 sites differ"));

    let told = desk.run(&["diff", "small.csv", "other.csv", "--design", "small.toml", "--json"]).ok().json();
    for (side, name) in [("a", "small.csv"), ("b", "other.csv")] {
        let check = desk.run(&["check", name, "--design", "small.toml", "--json"]).ok().json();
        assert_eq!(told["contrast"][side], check["contrast"], "{name}");
    }
    // Uniform crystals are their own measure.
    desk.write("host.csv", text.replace("brass-260", "stainless-440c"));
    let told = desk.run(&["diff", "host.csv", "small.csv", "--design", "small.toml", "--json"]).ok().json();
    assert_eq!(told["focal_gain"]["a"], 1.0);

    let swapped = text.replacen("12,", "11,", 1);
    desk.write("odd.csv", swapped);
    assert_eq!(desk.run(&["diff", "small.csv", "odd.csv"]).code, 2);
    desk.design_with("wide.toml", "rows = 12", "rows = 14");
    desk.run(&["design", "wide.toml", "--out", "wide.csv"]).ok();
    let refused = desk.run(&["diff", "small.csv", "wide.csv"]);
    assert!(refused.code == 2 && refused.stderr.contains("the crystals differ"), "{}", refused.stderr);
}
