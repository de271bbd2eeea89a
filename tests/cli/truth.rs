//! One truth in every number: whichever command is asked, the same layout has the same scores, to the last bit.

use granulens::Context;
use granulens::design::Design;
use granulens::evaluate::{Forces, Overrides, Plan, beside_uniform};
use granulens::lattice::HexagonalSheet;
use granulens::layout::{self, Layout};
use granulens::material::{self, Material};
use granulens::score::{Measure, Scores};
use granulens::search::Rng;
use serde_json::Value;

use super::{Desk, SMALL, names, shipped};

/// What every command says of a layout.
const TOLD: [Measure; 9] = [
    Measure::FocalMean,
    Measure::ProtectedMean,
    Measure::Contrast,
    Measure::FocalGain,
    Measure::Protection,
    Measure::HalfMass,
    Measure::PieceMass,
    Measure::HalfCost,
    Measure::PieceCost,
];

const STEP: &str = "2e-7 s";
const WINDOW: &str = "100 us";

/// Some of the library's metals that stand the impacts here.
const METALS: [&str; 4] = ["stainless-440c", "brass-260", "stainless-302", "aluminium-2017"];

/// A small design drawn by chance: crystal, force, what the lens or, where there is none, the baselines are of.
fn design(rng: &mut Rng) -> String {
    let half_width = 3.5 + 0.5 * rng.below(4) as f64;
    let (rows, force) = (12 + rng.below(3), 5 + rng.below(5));
    let material = METALS[1 + rng.below(2) as usize];
    let prices: String = METALS.iter().map(|name| format!("{name} = {}\n", 0.1 + rng.unit())).collect();
    let text = SMALL
        .replace("rows = 12", &format!("rows = {rows}"))
        .replace("half_width = 4.5", &format!("half_width = {half_width}"))
        .replace("x = [\"3 D\", \"4.5 D\"]", "x = [\"2.5 D\", \"3.5 D\"]")
        .replace("16 kN", &format!("{force} kN"))
        .replace("brass-260", material);
    let (before, lens) = text.split_once("[lens]").unwrap();
    let (_, after) = lens.split_once("[run]").unwrap();
    let text = match rng.below(2) {
        // The lens's material need not be in a layout.
        0 => text.clone(),
        _ => format!("{before}[run]{after}material = \"{material}\"\n"),
    };
    format!("{text}[prices]\n{prices}")
}

/// A layout drawn by chance of the host and one or two others.
fn drawn(design: &Design, rng: &mut Rng) -> Layout {
    let mut palette = vec![design.host.clone()];
    for _ in 0..1 + rng.below(2) {
        let other: Material = material::find(METALS[1 + rng.below(3) as usize], &[]).unwrap();
        if !palette.contains(&other) {
            palette.push(other);
        }
    }
    let letters = palette.len() as u64;
    let materials = (0..design.lattice.len()).map(|_| rng.below(letters) as u8).collect();
    Layout { lattice: design.lattice.clone(), palette, materials }
}

/// The measures as bits, of one JSON object.
fn bits(json: &Value) -> Vec<Option<u64>> {
    TOLD.iter().map(|measure| json[measure.column()].as_f64().map(f64::to_bits)).collect()
}

#[test]
fn every_command_says_the_same_of_a_layout() {
    for seed in 0..6 {
        let mut rng = Rng::new(seed);
        let desk = Desk::new();
        desk.write("design.toml", design(&mut rng));
        let read = Design::read(desk.path("design.toml")).unwrap();
        let layout = drawn(&read, &mut rng);
        desk.write("layout.csv", layout::write(&layout));
        let materials: Vec<String> = layout.palette.iter().map(|m| format!("\"{}\"", m.name)).collect();
        let study = format!(
            "format = 1\ndesign = \"design.toml\"\nmaterials = [{}]\nrows = [1, {}]\nfree_scored_rows = true\nstart = \"layout.csv\"\nmethod = \"local\"\n\
             budget = 1\nstep = \"{STEP}\"\nwindow = \"{WINDOW}\"\nobjective = {{ contrast = {{ maximise = 1 }} }}\n",
            materials.join(", "),
            read.lattice.rows(),
        );
        desk.write("study.toml", study);
        let how = ["--step", STEP, "--window", WINDOW, "--json"];
        let checked = desk.run(&[&["check", "layout.csv", "--design", "design.toml"], &how[..]].concat()).ok().json();
        let compare = [&["compare", "design.toml", "layout.csv", "--forces", "1"], &how[..]].concat();
        let compared = desk.run(&compare).ok().json();
        let searched = desk.run(&["study", "run", "study.toml", "--out", "studied", "--json"]).ok().json();

        let overrides = Overrides { step: Some(2e-7), window: Some(1e-4), ..Overrides::default() };
        let plan = Plan::new(&read, overrides, &layout.palette).unwrap();
        let beside = beside_uniform(&read, &layout, &plan, Forces::ONE, &Context::default()).unwrap();
        let scores: &Scores = &beside.evaluation.scores;
        let own: Vec<Option<u64>> = TOLD.iter().map(|&m| scores.get(m).map(f64::to_bits)).collect();
        assert!(own.iter().all(Option::is_some), "seed {seed}: {scores:?}");
        assert_eq!(bits(&checked), own, "check, seed {seed}");
        assert_eq!(bits(&compared["arrangements"][0]["scores"]), own, "compare, seed {seed}");
        assert_eq!(bits(&searched["study"]["start"]), own, "study, seed {seed}");

        // What Q refers to is said, and is the design's.
        let reference = read.reference().unwrap().name.clone();
        for told in [&checked, &compared] {
            assert_eq!(told["reference"], reference);
        }
    }
}

/// `run` says of its lens what `check` and `compare` say of the layout that it wrote.
#[test]
fn a_run_agrees_with_the_check_of_its_layout() {
    let desk = Desk::new();
    desk.write("priced.toml", format!("{SMALL}[prices]\nstainless-440c = 0.12\nbrass-260 = 0.31\n"));
    let run = desk.run(&["run", "priced.toml", "--out", "ran", "--json"]).ok().json();
    let own = bits(&run["arrangements"][0]["scores"]);
    assert!(own.iter().all(Option::is_some));
    let checked = desk.run(&["check", "ran/layout.csv", "--design", "priced.toml", "--json"]).ok().json();
    let compared = desk.run(&["compare", "priced.toml", "ran/layout.csv", "--json"]).ok().json();
    assert_eq!((bits(&checked), bits(&compared["arrangements"][0]["scores"])), (own.clone(), own));
    // Alike in step, window, law, integrator, materials; the proposal is the run's.
    for key in ["step_s", "window_s", "law", "integrator", "constants", "version", "commit", "materials", "reference"] {
        assert!(!run[key].is_null(), "{key}");
        assert_eq!((&run[key], &compared[key]), (&checked[key], &checked[key]), "{key}");
    }
    assert_eq!(run["proposal"]["piece"]["counts"], checked["piece"]["counts"]);
    assert_eq!((&run["verdict"], run["verdict"].as_array().unwrap().len()), (&compared["verdict"], 9));
}

/// Lines of a layout by their material.
fn counted(text: &str, name: &str) -> u64 {
    text.lines().filter(|line| line.ends_with(&format!(",{name}"))).count() as u64
}

/// What `design` says of the piece is what the layout to be built holds: every design of the gallery, and crystals of odd and even
/// numbers of rows, with spheres on the rim lines or without.
#[test]
fn the_piece_is_what_its_layout_lists() {
    let desk = Desk::new();
    for name in names(std::path::Path::new(&shipped("designs/gallery"))) {
        let file = shipped(&format!("designs/gallery/{name}"));
        desk.run(&["design", &file, "--full", "--out", "full.csv", "--quiet"]).ok();
        let (full, json) = (desk.read("full.csv"), desk.run(&["design", &file, "--json"]).ok().json());
        let proposal = &json["proposal"];
        let named =
            proposal["materials"].as_array().unwrap().iter().zip(proposal["piece"]["counts"].as_array().unwrap());
        for (material, count) in named {
            assert_eq!(counted(&full, material.as_str().unwrap()), count.as_u64().unwrap(), "{name}: {material}");
        }
        let said = desk.run(&["design", &file]).ok().stderr;
        let count = proposal["piece"]["counts"][0].as_u64().unwrap();
        assert!(said.lines().any(|line| line.starts_with(&format!("piece: {count} "))), "{name}: {said}");
    }
    let palette: Vec<Material> = METALS.iter().map(|name| material::find(name, &[]).unwrap()).collect();
    let mut rng = Rng::new(1);
    for (rows, half_width) in [(7, 3.0), (8, 3.0), (7, 3.5), (8, 3.5), (50, 16.5)] {
        let lattice = HexagonalSheet::new(6.35e-3, rows, half_width).unwrap();
        let materials = (0..lattice.len()).map(|_| rng.below(4) as u8).collect();
        let layout = Layout { lattice, palette: palette.clone(), materials };
        let (full, half) = (layout::write_full(&layout), layout::write(&layout));
        let [piece, own] = [layout.piece(|_| Some(1.0)), layout.half(|_| Some(1.0))];
        for (k, name) in METALS.iter().enumerate() {
            assert_eq!((counted(&full, name), counted(&half, name)), (piece.counts[k], own.counts[k]), "{rows} {name}");
        }
        assert_eq!(piece.amount.cost, Some(piece.counts.iter().sum::<u64>() as f64));
    }
}

/// The score over forces is exp of the mean of ln of the forces' own scores, and its spread their standard deviation.
#[test]
fn a_score_over_forces_is_made_of_single_ones() {
    let desk = Desk::with_layout();
    let check = |design: &str, more: &[&str]| {
        desk.run(&[&["check", "small.csv", "--design", design, "--step", STEP, "--json"], more].concat()).ok().json()
    };
    let several = check("small.toml", &["--forces", "3", "--band", "2 %"]);
    assert_eq!(several["forces_N"], serde_json::json!([15680.0, 16000.0, 16320.0]));
    let singles: Vec<Value> = ["15.68 kN", "16 kN", "16.32 kN"]
        .iter()
        .map(|force| {
            desk.design_with("single.toml", "16 kN", force);
            check("single.toml", &[])
        })
        .collect();
    for name in ["contrast", "focal_gain", "protection"] {
        let values: Vec<f64> = singles.iter().map(|json| json[name].as_f64().unwrap()).collect();
        let mean = (values.iter().map(|value| value.ln()).sum::<f64>() / 3.0).exp();
        let average = values.iter().sum::<f64>() / 3.0;
        let deviation = (values.iter().map(|value| (value - average).powi(2)).sum::<f64>() / 2.0).sqrt();
        let told = |of: &str| several[format!("{name}_{of}")].as_f64().unwrap();
        assert!((told("mean") / mean - 1.0).abs() < 1e-12 && (told("sd") / deviation - 1.0).abs() < 1e-9, "{name}");
        assert_eq!(several[name], singles[1][name], "{name} at the design's own force stays");
    }
    let words = desk.run(&["check", "small.csv", "--design", "small.toml", "--forces", "3"]).ok().stdout;
    assert!(words.contains(" ± ") && words.contains("3 forces from 15.84 kN to 16.16 kN"), "{words}");
    let wrong = desk.run(&["check", "small.csv", "--design", "small.toml", "--forces", "0"]);
    assert_eq!(wrong.code, 2, "{}", wrong.stderr);
}

/// A lens that is nothing but the host is worse than no arrangement and better than none where it is the same.
#[test]
fn a_verdict_says_what_a_layout_is_worth() {
    let desk = Desk::with_layout();
    let json = desk.run(&["compare", "small.toml", "small.csv", "--json"]).ok().json();
    let verdict = json["verdict"].as_array().unwrap();
    assert_eq!(json["forces_N"].as_array().unwrap().len(), 8);
    for line in verdict {
        let number = |key: &str| line[key].as_f64().unwrap();
        let near = (number("value") - number("best")).abs() <= 2.0 * number("spread");
        let greater = (number("value") > number("best")) == (line["measure"] != "protection");
        let word = if near {
            "equal"
        } else if greater {
            "better"
        } else {
            "worse"
        };
        assert_eq!(line["word"], word, "{line}");
    }
    let one = desk.run(&["compare", "small.toml", "small.csv", "--forces", "1", "--json"]).ok().json();
    for line in one["verdict"].as_array().unwrap() {
        assert!(line["spread"].is_null(), "{line}");
        let ratio = line["value"].as_f64().unwrap() / line["best"].as_f64().unwrap();
        assert_eq!(line["word"] == "undecided", (ratio - 1.0).abs() <= 0.04, "{line}");
    }
    let text = desk.run(&["compare", "small.toml", "small.csv"]).ok().stdout;
    assert!(text.starts_with("verdict over 8 forces from 15.84 kN to 16.16 kN"), "{text}");
}

/// The page has a line for every measure, with the table's words.
#[test]
fn the_page_of_measures_says_what_the_table_says() {
    let page = std::fs::read_to_string(shipped("docs/measures.md")).unwrap();
    for &measure in Measure::ALL {
        let begin = format!("| `{}` | {} | {} | ", measure.name(), measure.symbol(), measure.unit().name());
        let end = format!(" | {} |", measure.definition());
        assert!(page.lines().any(|line| line.starts_with(&begin) && line.ends_with(&end)), "{begin}...{end}");
    }
}
