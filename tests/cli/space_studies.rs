//! Studies of designs in space: as in the plane they run, stop, go on with the same bits and leave a layout that `check` takes.

use super::Desk;
use super::space::SMALL;

const STUDY: &str = r#"format = 1
design = "space.toml"
materials = ["stainless-440c", "brass-260"]
layers = [2, 5]
r = ["0 D", "3 D"]
objective = { contrast = { maximise = 1 } }
seed = 1
start = "lens"
[[stage]]
method = "level-set"
evaluations = 24
order = 3
step = "5e-7 s"
[[stage]]
method = "climb"
evaluations = 32
screen = "5e-7 s"
step = "2.5e-7 s"
"#;

/// The study without its stages, by another method.
fn by(method: &str, more: &str) -> String {
    let head = STUDY.split("[[stage]]").next().unwrap();
    format!("{head}{more}\nbudget = 16\nstep = \"5e-7 s\"\nmethod = \"{method}\"\n")
}

fn desk() -> Desk {
    let desk = Desk::new();
    desk.write("space.toml", SMALL);
    desk.write("study.toml", STUDY);
    desk
}

/// What is found has the scores that `check` gives it at the study's step, to the last bit; a page shows it; strips of one layer up to all free
/// ones stand among what it is compared with.
#[test]
fn a_study_in_space_finds_a_layout_that_checks() {
    let desk = desk();
    let ran = desk.run(&["study", "run", "study.toml", "--out", "s", "--json"]).ok().json();
    let best = &ran["study"]["best"];
    let checked =
        desk.run(&["check", "s/best.csv", "--design", "space.toml", "--step", "2.5e-7 s", "--json"]).ok().json();
    for key in ["contrast", "focal_gain", "protection", "piece_mass_kg", "piece_spheres"] {
        assert!(best[key].is_number() && best[key] == checked[key], "{key}: {} {}", best[key], checked[key]);
    }
    assert_eq!(ran["study"]["finals"][0]["exact"]["contrast"], best["contrast"]);
    let names: Vec<&str> =
        ran["study"]["baselines"].as_array().unwrap().iter().filter_map(|b| b["name"].as_str()).collect();
    assert!(
        ["strip-1", "strip-2", "strip-3", "flat-height", "all-host"].iter().all(|n| names.contains(n)),
        "{names:?}"
    );
    let page = desk.read("s/report.html");
    assert!(page.contains("section along the axis") && page.contains("layers from above"), "{page:.300}");
    // Only the free spheres differ from the lens.
    desk.run(&["design", "space.toml", "--out", "lens.csv"]).ok();
    let start = desk.run(&["check", "lens.csv", "--design", "space.toml", "--json"]).ok().json();
    assert!(best["contrast"].as_f64() > start["contrast"].as_f64(), "{best} {start}");
    let (lens, best) = (desk.read("lens.csv"), desk.read("s/best.csv"));
    let spheres = |text: &str| {
        text.lines()
            .filter(|line| line.starts_with(|c: char| c.is_ascii_digit()))
            .map(str::to_owned)
            .collect::<Vec<_>>()
    };
    let (lens, best) = (spheres(&lens), spheres(&best));
    assert_eq!(lens.len(), best.len());
    let differing: Vec<&String> = lens.iter().zip(&best).filter(|(a, b)| a != b).map(|(a, _)| a).collect();
    assert!(!differing.is_empty());
    for line in differing {
        let cells: Vec<f64> = line.split(',').take(5).map(|cell| cell.parse().unwrap()).collect();
        assert!((2.0..=5.0).contains(&cells[0]) && cells[2].hypot(cells[3]) <= 3.0001 * 6.35e-3, "{line}");
    }
}

/// A run that ended early goes on where it was, on any number of threads, and its journal and its end have the bits of one that did not.
#[test]
fn a_study_in_space_goes_on_to_the_same_bits() {
    let desk = desk();
    desk.run(&["study", "run", "study.toml", "--out", "whole"]).ok();
    let journal = desk.read("whole/journal.jsonl");
    let lines: Vec<&str> = journal.split_inclusive('\n').collect();
    assert!(lines.len() > 40, "{}", lines.len());
    desk.run(&["study", "run", "study.toml", "--out", "cut"]).ok();
    // As if it had been killed in the middle of the climb.
    desk.write("cut/journal.jsonl", lines[..lines.len() - 9].concat());
    desk.run(&["study", "run", "study.toml", "--out", "cut", "--threads", "1"]).ok();
    assert_eq!(desk.read("cut/journal.jsonl"), journal);
    for name in ["best.csv", "study.json"] {
        assert_eq!(desk.read(&format!("cut/{name}")), desk.read(&format!("whole/{name}")), "{name}");
    }
    // Settings that changed are told.
    desk.write("study.toml", STUDY.replace("r = [\"0 D\", \"3 D\"]", "r = [\"0 D\", \"3 D\"]\nwindow = \"60 us\""));
    let why = desk.run(&["study", "show", "study.toml", "--out", "whole", "--why"]).ok();
    assert!(why.stdout.contains("window"), "{}", why.stdout);
}

/// With the symmetry of a body of revolution all spheres of a layer at one distance hold one material, by every method, and likewise all along y.
#[test]
fn spheres_that_change_together_are_alike() {
    let desk = desk();
    for (symmetry, methods) in [
        ("axis", &["level-set", "anneal", "genetic", "local", "curves", "lens-family", "local-swaps"][..]),
        ("plane", &["level-set", "nsga2"][..]),
    ] {
        for (k, method) in methods.iter().enumerate() {
            let folder = format!("{symmetry}-{k}");
            let start = if symmetry == "plane" { "start = \"random\"" } else { "start = \"lens\"" };
            let text = by(method, &format!("symmetry = \"{symmetry}\""))
                .replace("start = \"lens\"", start)
                .replace("r = [\"0 D\", \"3 D\"]\n", "");
            desk.write("tied.toml", text);
            desk.run(&["study", "run", "tied.toml", "--out", &folder]).ok();
            let mut held = std::collections::BTreeMap::new();
            let layout = desk.read(&format!("{folder}/best.csv"));
            for line in layout.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit())) {
                let cells: Vec<&str> = line.split(',').collect();
                let [x, y] = [2, 3].map(|k| cells[k].parse::<f64>().unwrap() / 6.35e-3);
                let far = if symmetry == "axis" { x.hypot(y) } else { x };
                let place = (cells[0].to_owned(), (far * 1e6).round() as i64);
                let known = held.entry(place).or_insert_with(|| cells[6].to_owned());
                assert_eq!(known, cells[6], "{method}: {line}");
            }
            assert!(held.values().any(|material| material == "brass-260"), "{method}");
        }
    }
}

/// Others may evaluate what it asks for.
#[test]
fn shards_evaluate_what_a_study_in_space_asks_for() {
    let desk = desk();
    desk.write("study.toml", by("anneal", ""));
    desk.run(&["study", "run", "study.toml", "--out", "here"]).ok();
    for _ in 0..20 {
        let asked = desk.run(&["study", "ask", "study.toml", "--out", "there"]);
        if asked.code == 0 {
            break;
        }
        assert_eq!(asked.code, 4, "{}", asked.stderr);
        for shard in ["1/2", "2/2"] {
            desk.run(&["evaluate", "study.toml", "--shard", shard, "--out", "there"]).ok();
        }
    }
    assert_eq!(desk.read("there/best.csv"), desk.read("here/best.csv"));
    assert_eq!(desk.read("there/journal.jsonl"), desk.read("here/journal.jsonl"));
    // Layouts of one's own too.
    desk.run(&["study", "ask", "study.toml", "here/best.csv", "--out", "own"]).ok();
}

/// Members built with flaws are judged beside the layout as drawn, and the best is told with what it loses: of flaws that are none nothing.
#[test]
fn a_study_in_space_judges_what_is_built_otherwise() {
    let desk = desk();
    let with = |tolerance: &str| format!("{}[tolerance]\n{tolerance}\n", by("level-set", ""));
    let run = |name: &str, text: String| {
        desk.write("study.toml", text);
        desk.run(&["study", "run", "study.toml", "--out", name, "--json"]).ok().json()["study"].clone()
    };
    let flawed = run("flawed", with("radii = \"0.2 %\"\nwrong = \"3 %\"\nmembers = 2\nreported = 4"));
    let loses = &flawed["tolerance"];
    assert_eq!((&loses["crystals"], &loses["stopped"]), (&4.into(), &0.into()), "{flawed}");
    let lost = loses["contrast"]["90_percent"].as_f64().unwrap();
    assert!(lost.abs() > 1e-4 && lost < 1.0, "{loses}");
    // Radii within 10⁻¹² of each other touch: what is left is rounding.
    let same = run("same", with("radii = \"1e-10 %\"\nmembers = 1\nreported = 2"));
    let lost = same["tolerance"]["contrast"]["90_percent"].as_f64().unwrap();
    assert!(lost.abs() < 1e-6, "{}", same["tolerance"]);
}

#[test]
fn what_is_wrong_with_a_study_in_space_is_said() {
    let desk = desk();
    let cases = [
        ("layers = [2, 5]", "rows = [2, 5]", "rows is for the other kind of crystal"),
        ("layers = [2, 5]", "layers = [2, 10]", "layers 1 to 9"),
        ("layers = [2, 5]", "layers = [2, 7]", "layer 7 of a scored region"),
        ("layers = [2, 5]\n", "", "layers is missing"),
        ("r = [\"0 D\", \"3 D\"]", "r = [\"30 D\", \"31 D\"]", "hold no sphere"),
        ("seed = 1", "seed = 1\nsymmetry = \"round\"", "\"axis\""),
        (
            "[[stage]]\nmethod = \"level-set\"",
            "[[impact]]\nforce = \"20 kN\"\nduration = \"20 us\"\nangle = \"5 deg\"\n[[stage]]\nmethod = \"level-set\"",
            "along the axis",
        ),
    ];
    for (old, new, said) in cases {
        assert!(STUDY.contains(old), "{old}");
        desk.write("wrong.toml", STUDY.replacen(old, new, 1));
        let ran = desk.run(&["study", "run", "wrong.toml", "--out", "w"]);
        assert!(
            ran.code == 2 && ran.stderr.contains(said) && ran.stderr.contains("wrong.toml"),
            "{new}: {}",
            ran.stderr
        );
        assert!(!desk.names().contains(&"w".to_owned()));
    }
    // Of a sheet there are no layers.
    desk.write("small.toml", super::SMALL);
    desk.write("wrong.toml", STUDY.replace("space.toml", "small.toml"));
    let ran = desk.run(&["study", "run", "wrong.toml", "--out", "w"]);
    assert!(ran.code == 2 && ran.stderr.contains("layers is for the other kind"), "{}", ran.stderr);
    let ran = desk.run(&["explore", "study.toml"]);
    assert!(ran.code == 2 && ran.stderr.contains("explore shows sheets"), "{}", ran.stderr);
}

/// `build` draws every layer at 1:1 and lists its spheres in the order of laying: the same spheres as in the whole layout, with the parts that it
/// is made of.
#[test]
fn a_lens_in_space_is_built_layer_by_layer() {
    let desk = desk();
    desk.run(&["design", "space.toml", "--out", "lens.csv"]).ok();
    let told = desk.run(&["build", "lens.csv", "--design", "space.toml", "--out", "shop", "--json"]).ok().json();
    let lines = |name: &str| {
        desk.read(name)
            .lines()
            .map(str::to_owned)
            .filter(|line| line.starts_with(|c: char| c.is_ascii_digit()))
            .collect()
    };
    let (placed, whole): (Vec<String>, Vec<String>) = (lines("shop/placement.csv"), lines("shop/layout-full.csv"));
    assert_eq!(placed.len(), whole.len());
    assert_eq!(told["spheres"], placed.len());
    // Layer, x, y and material of both, to a hundredth of a millimetre.
    let place = |line: &String, [x, y, material]: [usize; 3], unit: f64| {
        let cells: Vec<&str> = line.split(',').collect();
        let at = |k: usize| (cells[k].parse::<f64>().unwrap() * unit).round() as i64;
        (cells[0].parse::<u32>().unwrap(), at(x), at(y), cells[material].to_owned())
    };
    let mut built: Vec<_> = placed.iter().map(|line| place(line, [3, 4, 6], 1e2)).collect();
    let layers: Vec<u32> = built.iter().map(|(layer, ..)| *layer).collect();
    assert!(layers.is_sorted_by(|a, b| a >= b) && layers[0] == 9, "the struck layer is laid last");
    let mut drawn: Vec<_> = whole.iter().map(|line| place(line, [1, 2, 5], 1e5)).collect();
    built.sort();
    drawn.sort();
    // The list has hundredths of a millimetre, which may be rounded the other way.
    type Placed = (u32, i64, i64, String);
    let same =
        |(a, b): &(&Placed, &Placed)| (a.0, &a.3) == (b.0, &b.3) && (a.1 - b.1).abs() <= 1 && (a.2 - b.2).abs() <= 1;
    assert_eq!(built.len(), drawn.len());
    assert!(
        built.iter().zip(&drawn).all(|pair| same(&pair)),
        "{:?}",
        built.iter().zip(&drawn).find(|pair| !same(pair))
    );
    // Rows from above and columns from the left are numbered without gaps.
    let mut last = (0, 0, 0);
    for line in &placed {
        let [layer, row, column]: [u32; 3] = std::array::from_fn(|k| line.split(',').nth(k).unwrap().parse().unwrap());
        let next = match last {
            (l, r, c) if l == layer && r == row => column == c + 1,
            (l, r, _) if l == layer => (row, column) == (r + 1, 1),
            _ => (row, column) == (1, 1),
        };
        assert!(next, "{line}");
        last = (layer, row, column);
    }
    let count = |material: &str| built.iter().filter(|(.., of)| of == material).count();
    for part in told["parts"].as_array().unwrap() {
        assert_eq!(part["count"], count(part["material"].as_str().unwrap()), "{part}");
    }
    for layer in 1..=9 {
        let map = desk.read(&format!("shop/map-layer-{layer}.svg"));
        assert!(
            map.contains(&format!("LAYER {layer} of 9")) && map.contains("this ruler is 100 mm long"),
            "{map:.300}"
        );
    }
    for name in ["map-a4.pdf", "map-a3.pdf", "map-letter.pdf", "placement.pdf"] {
        let pdf = std::fs::read(desk.path(&format!("shop/{name}"))).unwrap();
        assert!(pdf.starts_with(b"%PDF") && pdf.len() > 5000, "{name}");
    }
    assert!(desk.read("shop/parts.csv").lines().last().unwrap().starts_with("all,"));
    // All spheres are ranked, by what they carried: spheres that stand for each other carried the same.
    let ranked: Vec<String> = lines("shop/inspection.csv");
    let energy: Vec<f64> = ranked.iter().map(|line| line.split(',').nth(6).unwrap().parse().unwrap()).collect();
    assert!(energy.len() == placed.len() && energy.is_sorted() && energy[0] < energy[energy.len() - 1]);
    let named = |line: &String| line.split(',').skip(1).take(3).map(str::to_owned).collect::<Vec<_>>();
    let unique: std::collections::BTreeSet<Vec<String>> = ranked.iter().map(named).collect();
    assert_eq!(unique.len(), placed.len());
    // Ten spheres along x on one plane of symmetry and beside it, so 10 D + D between the walls, and the clearance at both sides.
    let wide = |told: &serde_json::Value| told["frame_mm"]["width"][0].as_f64().unwrap();
    assert!((wide(&told) - 11.0 * 6.35).abs() < 1e-6, "{told}");
    let loose =
        desk.run(&["build", "lens.csv", "--design", "space.toml", "--out", "x", "--clearance", "1 mm", "--json"]);
    assert!((wide(&loose.ok().json()) - wide(&told) - 2.0).abs() < 1e-6);
    assert!(std::fs::read(desk.path("shop/frame.3mf")).unwrap().starts_with(b"PK"));
    // A measured batch: every sphere has its place, the nearest to the nominal diameter where the list begins.
    let balls = |material: &str| {
        let count = count(material);
        (0..count + 2).map(|k| format!("{material}-{k},{material},{}", 6.35 + 1e-5 * k as f64)).collect::<Vec<_>>()
    };
    let batch = [vec!["id,material,diameter_mm".to_owned()], balls("stainless-440c"), balls("brass-260")].concat();
    desk.write("batch.csv", batch.join("\n"));
    desk.run(&["build", "lens.csv", "--design", "space.toml", "--out", "sorted", "--sorted", "batch.csv"]).ok();
    let sorted: Vec<String> = lines("sorted/sorted.csv");
    assert_eq!(sorted.len(), placed.len());
    let first = named(&ranked[0]);
    let of_first = sorted.iter().find(|line| line.split(',').take(3).eq(first.iter().map(String::as_str))).unwrap();
    assert!(of_first.split(',').nth(5).unwrap().ends_with("-0"), "{of_first}");
    assert_eq!(desk.read("sorted/sorted.csv").lines().filter(|line| line.starts_with("left,")).count(), 4);
    let refused = desk.run(&["build", "lens.csv", "--design", "space.toml", "--out", "y", "--yield", "made"]);
    assert!(refused.code == 2 && refused.stderr.contains("no such file"), "{}", refused.stderr);
}
