//! What a wrong design file hears. Each page of `tests/snapshots` lists cases: what was written wrong, the one-line error,
//! and below it what to try.

use std::fmt::Write as _;
use std::path::Path;

use granulens::contact::{Constants, LawKind};
use granulens::dem::Integrator;
use granulens::design::{Accuracy, Design, DesignError};
use granulens::score::Measure;
use proptest::prelude::*;

/// A good file with every key there is.
const GOOD: &str = r#"format = 1
name = "thesis-lens"
[crystal]
packing = "hexagonal-2d"
diameter = "6.35 mm"
rows = 50
half_width = 16.5
sides = "mirror"
host = "440c"
law = "hertz"
constants = "text"
[impact]
kind = "force-pulse"
force = "26 kN"
duration = "20 us"
[target]
focus = { rows = [30, 34], x = ["0 D", "2.5 D"] }
protect = { rows = [30, 34], x = ["12 D", "104.775 mm"] }
[lens]
family = "plano-convex"
material = "my-steel"
apex_row = 5
back_row = 16
radius = "19 D"
max_interface_angle = "60 deg"
rows = [3, 20]
[run]
integrator = "rk4"
step = "1e-7 s"
accuracy = "1 %"
window = "350 us"
[compare]
seeds = 7
first_seed = 11
[thresholds]
contrast = { min = 2 }
dissipated = { min = "0.3 J", max = "40 J" }
[materials.my-steel]
density = "7800 kg/m3"
youngs_modulus = "200 GPa"
poisson_ratio = 0.3
yield_stress = "900 MPa"
rate_constant = 0.02
source = "own measurement, 2026"
"#;

/// The good file with one piece of its text exchanged.
fn with(old: &str, new: &str) -> String {
    assert!(GOOD.contains(old), "the good file does not contain {old:?}");
    GOOD.replacen(old, new, 1)
}

fn refusal(what: &str, text: &str) -> DesignError {
    match Design::parse("bad.toml", text) {
        Err(error) => error,
        Ok(_) => panic!("accepted: {what}"),
    }
}

fn entry(page: &mut String, what: &str, error: &DesignError) {
    let _ = writeln!(page, "{what}\n    {error}\n    {}\n", error.help);
}

/// A page of cases, each a piece of the good file and what stands there instead.
fn page(cases: &[(&str, &str)]) -> String {
    let mut page = String::new();
    for (old, new) in cases {
        let what = if new.is_empty() { format!("without {old}") } else { (*new).to_owned() };
        let what = what.trim().replace('\n', " | ");
        entry(&mut page, &what, &refusal(&what, &with(old, new)));
    }
    page
}

#[test]
fn the_good_file_is_read_as_written() {
    let design = Design::parse("good.toml", GOOD).unwrap();
    assert_eq!(design.name, "thesis-lens");
    assert_eq!((design.path.as_path(), design.text.as_str()), (Path::new("good.toml"), GOOD));
    assert_eq!((design.lattice.diameter(), design.lattice.rows(), design.lattice.len()), (6.35e-3, 50, 850));
    assert_eq!(design.host.name, "stainless-440c");
    assert_eq!((design.law, design.constants), (LawKind::Hertz, Constants::Text));
    assert_eq!((design.impact.strength(), design.impact.duration()), (26e3, Some(20e-6)));
    assert_eq!((design.target.foci[0].region.rows, design.target.foci[0].region.x), ([30, 34], [0.0, 2.5 * 6.35e-3]));
    assert_eq!(design.target.protect.x, [12.0 * 6.35e-3, 104.775 / 1000.0]);
    let lens = design.lens.as_ref().unwrap();
    assert_eq!((lens.material.name.as_str(), lens.rows), ("my-steel", [3, 20]));
    assert_eq!((lens.apex_row, lens.back_row, lens.radius), (Some(5), Some(16), Some(19.0 * 6.35e-3)));
    assert_eq!(lens.max_interface_angle, 60.0_f64.to_radians());
    assert_eq!((design.integrator, design.accuracy), (Integrator::Rk4, Accuracy::OnePercent));
    assert_eq!((design.step, design.window), (Some(1e-7), Some(350e-6)));
    assert_eq!((design.seeds, design.first_seed), (7, 11));
    let [contrast, dissipated] = design.thresholds[..] else { panic!("two thresholds") };
    assert_eq!((contrast.measure, contrast.min, contrast.max), (Measure::Contrast, Some(2.0), None));
    assert_eq!((dissipated.measure, dissipated.min, dissipated.max), (Measure::Dissipated, Some(0.3), Some(40.0)));
    assert!(contrast.admits(2.0) && !contrast.admits(1.9) && !contrast.admits(f64::NAN));
    assert_eq!(design.material("my-steel").unwrap().youngs_modulus, 200e9);
    assert_eq!(design.material("brass").unwrap().name, "brass-260");
    assert_eq!(design.material("my-stel").unwrap_err().nearest.as_deref(), Some("my-steel"));
}

#[test]
fn what_is_left_out_has_its_default() {
    let required = &GOOD[..GOOD.find("[run]").unwrap()];
    let text = required
        .replace("law = \"hertz\"\nconstants = \"text\"\n", "")
        .replace("my-steel\"\napex_row = 5\nback_row = 16\nradius = \"19 D\"\n", "brass\"\n")
        .replace("max_interface_angle = \"60 deg\"\nrows = [3, 20]\n", "");
    let design = Design::parse("short.toml", &text).unwrap();
    assert_eq!((design.law, design.constants), (LawKind::Thesis, Constants::Code));
    assert_eq!((design.integrator, design.accuracy), (Integrator::Adams, Accuracy::TenthPercent));
    assert_eq!((design.step, design.window, design.seeds, design.first_seed), (None, None, 5, 1));
    assert!(design.thresholds.is_empty() && design.own_materials.is_empty());
    let lens = design.lens.unwrap();
    assert_eq!((lens.rows, lens.max_interface_angle), ([2, 29], 60.0_f64.to_radians()));
    assert_eq!((lens.apex_row, lens.back_row, lens.radius), (None, None, None));
    let without = &text[..text.find("[lens]").unwrap()];
    assert_eq!(Design::parse("short.toml", without).unwrap().lens, None);
}

#[test]
fn every_design_that_ships_is_sound() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("designs");
    let mut names = Vec::new();
    for file in std::fs::read_dir(folder).unwrap() {
        let path = file.unwrap().path();
        // Rig files lie there too; `tests/simulate` runs them.
        let text = std::fs::read_to_string(&path).unwrap_or_default();
        let is_design = || !["rig", "bed"].iter().any(|kind| text.contains(&format!("kind = \"{kind}\"")));
        if path.extension().is_some_and(|extension| extension == "toml") && is_design() {
            names.push(Design::read(&path).unwrap_or_else(|error| panic!("{error} {}", error.help)).name);
        }
    }
    assert!(["thesis-lens", "quickstart"].iter().all(|name| names.iter().any(|found| found == name)), "{names:?}");
}

/// Line breaks of other systems, a byte-order mark and sub-sections in place of inline tables change nothing.
#[test]
fn other_ways_of_writing_the_same_are_read_alike() {
    let lens = |text: &str| {
        let design = Design::parse("good.toml", text).unwrap_or_else(|error| panic!("{error} {}", error.help));
        (design.lens, design.target, design.thresholds)
    };
    let good = lens(GOOD);
    assert_eq!(lens(&GOOD.replace('\n', "\r\n")), good);
    assert_eq!(lens(&format!("\u{feff}{GOOD}")), good);
    let focus = "focus = { rows = [30, 34], x = [\"0 D\", \"2.5 D\"] }\n";
    let moved = "[target.focus]\nrows = [\n  30,\n  34,\n]\nx = [\"0mm\", \"2.5D\"]\n[lens]\n";
    assert_eq!(lens(&with(focus, "").replace("[lens]\n", moved)), good);
}

#[test]
fn wrong_text() {
    let page = page(&[
        ("force = \"26 kN\"", "force = 26 kN"),
        ("name = \"thesis-lens\"", "name = thesis-lens"),
        ("name = \"thesis-lens\"", "name = \"thesis-lens"),
        ("rows = 50\n", "rows = 50\nrows = 60\n"),
        ("rows = 50", "rows 50"),
        ("x = [\"0 D\", \"2.5 D\"] }", "x = [\"0 D\", \"2.5 D\""),
        ("[crystal]\n", "[crystal\n"),
        ("rows = 50", "rows = 050"),
        ("thesis-lens", "thesis\\lens"),
        ("focus = { rows = [30, 34],", "focus = { rows = [30, 34"),
        ("[run]\n", "[impact]\n"),
        ("rows = 50", "rows = 99999999999999999999"),
        ("format = 1\n", ""),
        ("format = 1", "format = 2\ncolour = \"blue\""),
        ("format = 1", "format = \"1\""),
        ("name = \"thesis-lens\"\n", ""),
        ("thesis-lens", "thesis lens/../2"),
        ("name = \"thesis-lens\"", "name = 5"),
    ]);
    insta::assert_snapshot!(page);
}

#[test]
fn wrong_keys_and_sections() {
    let page = page(&[
        ("diameter = ", "diametre = "),
        ("force = ", "power = "),
        ("name = ", "nam = "),
        ("[crystal]", "[crytsal]"),
        ("[run]", "[[run]]"),
        ("[run]\nintegrator", "[run.fast]\nintegrator"),
        ("rows = [30, 34], x", "row = [30, 34], x"),
        ("contrast = { min", "contrasts = { min"),
        ("{ min = 2 }", "{ least = 2 }"),
        ("{ min = 2 }", "2"),
        ("force = ", "\"for\\nce\" = "),
        ("poisson_ratio", "poissons_ratio"),
        ("[materials.my-steel]", "[materials]"),
        ("[impact]\nkind = \"force-pulse\"\nforce = \"26 kN\"\nduration = \"20 us\"\n", ""),
        ("rows = 50\n", ""),
        ("focus = { rows = [30, 34], x = [\"0 D\", \"2.5 D\"] }\n", ""),
        ("focus = { rows = [30, 34], x = [\"0 D\", \"2.5 D\"] }", "focus = [30, 34]"),
        ("focus = { rows = [30, 34], ", "focus = { "),
        ("material = \"my-steel\"\n", ""),
    ]);
    insta::assert_snapshot!(page);
}

#[test]
fn wrong_crystal_and_impact() {
    let page = page(&[
        ("\"hexagonal-2d\"", "\"hexagonal\""),
        ("\"6.35 mm\"", "6.35"),
        ("\"6.35 mm\"", "\"6.35\""),
        ("\"6.35 mm\"", "\"6.35 kg\""),
        ("\"6.35 mm\"", "\"-6.35 mm\""),
        ("\"6.35 mm\"", "\"nan mm\""),
        ("\"6.35 mm\"", "nan"),
        ("\"6.35 mm\"", "\"1e400 mm\""),
        ("\"6.35 mm\"", "[6.35, \"mm\"]"),
        ("rows = 50", "rows = 1"),
        ("rows = 50", "rows = 50.5"),
        ("rows = 50", "rows = -50"),
        ("half_width = 16.5", "half_width = 16.3"),
        ("half_width = 16.5", "half_width = inf"),
        ("half_width = 16.5", "half_width = \"16.5 D\""),
        ("rows = 50\nhalf_width = 16.5", "rows = 90000\nhalf_width = 40000"),
        ("\"mirror\"", "\"wall\""),
        ("\"440c\"", "\"stainles-440c\""),
        ("\"440c\"", "\"unobtainium\""),
        ("\"440c\"", "440"),
        ("law = \"hertz\"", "law = \"thesis_static\""),
        ("constants = \"text\"", "constants = \"eq-4.8\""),
        ("\"force-pulse\"", "\"piston\""),
        ("\"26 kN\"", "26"),
        ("\"26 kN\"", "\"0 kN\""),
        ("\"26 kN\"", "\"lots\""),
        ("\"20 us\"", "\"-20 us\""),
        ("\"20 us\"", "\"20 parsecs\""),
    ]);
    insta::assert_snapshot!(page);
}

#[test]
fn wrong_target() {
    let focus = "rows = [30, 34], x = [\"0 D\", \"2.5 D\"]";
    let page = page(&[
        (focus, "rows = [34, 30], x = [\"0 D\", \"2.5 D\"]"),
        (focus, "rows = [0, 34], x = [\"0 D\", \"2.5 D\"]"),
        (focus, "rows = [30, 51], x = [\"0 D\", \"2.5 D\"]"),
        (focus, "rows = [30, 99999999999], x = [\"0 D\", \"2.5 D\"]"),
        (focus, "rows = 30, x = [\"0 D\", \"2.5 D\"]"),
        (focus, "rows = [30, 32, 34], x = [\"0 D\", \"2.5 D\"]"),
        (focus, "rows = [30, \"34\"], x = [\"0 D\", \"2.5 D\"]"),
        (focus, "rows = [30, 34], x = [\"2.5 D\", \"0 D\"]"),
        (focus, "rows = [30, 34], x = [\"-1 D\", \"2.5 D\"]"),
        (focus, "rows = [30, 34], x = [\"15 D\", \"17 D\"]"),
        (focus, "rows = [30, 34], x = [\"0.2 D\", \"0.4 D\"]"),
        (focus, "rows = [30, 30], x = [\"1 mm\", \"3 mm\"]"),
        (focus, "rows = [30, 34], x = [0, 2.5]"),
        (focus, "rows = [30, 34], x = [\"0\", \"2.5 D\"]"),
        (focus, "rows = [30, 34], x = [\"0 D\", \"2.5 d\"]"),
        (focus, "rows = [30, 34], x = [\"0 D\", \"inf D\"]"),
        (focus, "rows = [30, 34], x = [\"0 D\", \"two D\"]"),
        (focus, "rows = [28, 30], x = [\"0 D\", \"12.5 D\"]"),
    ]);
    insta::assert_snapshot!(page);
}

#[test]
fn wrong_foci() {
    let focus = "focus = { rows = [30, 34], x = [\"0 D\", \"2.5 D\"] }";
    let first = "{ rows = [26, 28], x = [\"0 D\", \"2 D\"] }";
    let list = |second: &str| format!("focus = [{first}, {second}]");
    let good = list("{ rows = [30, 34], x = [\"7 D\", \"9 D\"], share = 3 }");
    let design = Design::parse("good.toml", &with(focus, &good).replace("rows = [3, 20]", "")).unwrap();
    assert_eq!(design.target.foci.iter().map(|focus| focus.share).collect::<Vec<_>>(), [0.25, 0.75]);
    let changes: Vec<(&str, String)> = vec![
        (focus, "focus = []".to_owned()),
        (focus, "focus = 3".to_owned()),
        (focus, list("3")),
        (focus, list("{ rows = [30, 34] }")),
        (focus, list("{ rows = [30, 34], x = [\"7 D\", \"9 D\"], part = 3 }")),
        (focus, list("{ rows = [30, 60], x = [\"7 D\", \"9 D\"] }")),
        (focus, list("{ rows = [30, 34], x = [\"7 D\", \"9 D\"], share = 0 }")),
        (focus, list("{ rows = [30, 34], x = [\"7 D\", \"9 D\"], share = \"half\" }")),
        (focus, list("{ rows = [30, 34], x = [\"7 D\", \"12 D\"] }")),
        (focus, focus.replace(" }", ", share = 1 }")),
        (focus, format!("focus = [{}]", [first; 7].join(", "))),
    ];
    let mut page = page(&changes.iter().map(|(old, new)| (*old, new.as_str())).collect::<Vec<_>>());
    let several = with(focus, &good);
    for (old, new) in [
        ("\"plano-convex\"", "\"graded\""),
        ("\"plano-convex\"", "\"plano-convex\"\naxis = \"3 D\""),
        ("rows = [3, 20]", "rows = [3, 26]"),
    ] {
        entry(&mut page, &format!("with two foci: {new}"), &refusal(new, &several.replace(old, new)));
    }
    insta::assert_snapshot!(page);
}

#[test]
fn wrong_lens() {
    let rows = "rows = [3, 20]";
    let mut page = page(&[
        ("\"plano-convex\"", "\"plano-convexe\""),
        ("\"plano-convex\"", "\"prism\""),
        ("\"plano-convex\"", "\"plano-convex\"\naxis = \"17 D\""),
        ("\"plano-convex\"", "\"plano-convex\"\nstages = 3"),
        ("\"plano-convex\"", "\"stages\"\nstages = 8"),
        ("\"plano-convex\"", "\"plano-convex\"\nparameters = { conic = 1 }"),
        ("\"plano-convex\"", "\"even-asphere\"\nparameters = 3"),
        ("\"plano-convex\"", "\"even-asphere\"\nparameters = { conic = 40 }"),
        ("\"plano-convex\"", "\"even-asphere\"\nparameters = { sag_4 = 0.5 }"),
        ("\"plano-convex\"", "\"even-asphere\"\nparameters = { sag_8 = \"1 D\" }"),
        ("\"plano-convex\"", "\"plano-convex\"\nothers = [\"brass\"]"),
        ("\"plano-convex\"", "\"graded\"\nothers = [\"brass\", \"brass-260\"]"),
        ("\"plano-convex\"", "\"graded\"\nothers = \"brass\""),
        ("\"plano-convex\"", "\"graded\"\nraster = \"fine\""),
        ("\"plano-convex\"", "\"graded\"\nseed = 3"),
        ("\"plano-convex\"", "\"plano-convex\"\nsymmetry = \"axis\""),
        ("\"plano-convex\"", "\"plano-convex\"\nsymmetry = \"round\""),
        ("material = \"my-steel\"", "material = \"bras\""),
        ("material = \"my-steel\"", "material = \"stainless-440c\""),
        ("apex_row = 5", "apex_row = 2"),
        ("apex_row = 5", "apex_row = 20"),
        ("apex_row = 5", "apex_row = 16"),
        ("apex_row = 5", "apex_row = 60"),
        ("back_row = 16", "back_row = 21"),
        ("apex_row = 5\nback_row = 16", "back_row = 3"),
        ("radius = \"19 D\"", "radius = \"0 D\""),
        ("radius = \"19 D\"", "radius = 19"),
        ("\"60 deg\"", "\"90 deg\""),
        ("\"60 deg\"", "\"0 deg\""),
        (rows, "rows = [3, 60]"),
        (rows, "rows = [3, 30]"),
        (rows, "rows = [20, 3]"),
        (rows, "rows = [5, 5]"),
    ]);
    let shallow = with("rows = [30, 34], x = [\"0 D\"", "rows = [3, 5], x = [\"0 D\"").replace(rows, "");
    entry(&mut page, "no lens.rows and a focus from row 3 on", &refusal("a shallow focus", &shallow));
    insta::assert_snapshot!(page);
}

#[test]
fn wrong_run_compare_and_thresholds() {
    let page = page(&[
        ("\"rk4\"", "\"rk5\""),
        ("\"1e-7 s\"", "\"0 s\""),
        ("\"1e-7 s\"", "1e-7"),
        ("\"1e-7 s\"", "\"1e-4 s\""),
        ("\"1e-7 s\"", "\"1e-16 s\""),
        ("\"1 %\"", "\"5 %\""),
        ("\"1 %\"", "0.01"),
        ("\"350 us\"", "\"20 us\""),
        ("seeds = 7", "seeds = 1001"),
        ("seeds = 7", "seeds = -1"),
        ("first_seed = 11", "first_seed = 1.5"),
        ("{ min = 2 }", "{ min = \"2 J\" }"),
        ("{ min = 2 }", "{ min = nan }"),
        ("{ min = 2 }", "{ }"),
        ("{ min = 2 }", "{ min = 2, max = 1 }"),
        ("\"40 J\"", "40"),
    ]);
    insta::assert_snapshot!(page);
}

#[test]
fn wrong_materials() {
    let page = page(&[
        ("[materials.my-steel]", "[materials.brass-260]"),
        ("[materials.my-steel]", "[materials.302]"),
        ("[materials.my-steel]", "[materials.\"my, steel\"]"),
        ("\"7800 kg/m3\"", "\"-7800 kg/m3\""),
        ("\"7800 kg/m3\"", "7800"),
        ("\"200 GPa\"", "\"0 GPa\""),
        ("\"200 GPa\"", "\"200 gigapascal\""),
        ("poisson_ratio = 0.3", "poisson_ratio = 0.7"),
        ("\"900 MPa\"", "\"900 GPa\""),
        ("rate_constant = 0.02", "rate_constant = 2"),
        ("rate_constant = 0.02\n", ""),
        ("\"own measurement, 2026\"", "\" \""),
    ]);
    insta::assert_snapshot!(page);
}

/// Files that are not there, no text, or cut off. The folder's own name is cut from the messages.
#[test]
fn wrong_files() {
    let folder = tempfile::tempdir().unwrap();
    let mut page = String::new();
    let mut read = |what: &str, file: &str| {
        let mut error = Design::read(folder.path().join(file)).expect_err(what);
        error.file = error.file.strip_prefix(folder.path()).unwrap().to_owned();
        error.help = error.help.replace(&format!("{}{}", folder.path().display(), std::path::MAIN_SEPARATOR), "");
        entry(&mut page, what, &error);
    };
    read("missing, in an empty folder", "lens.toml");
    std::fs::write(folder.path().join("thesis-lens.toml"), GOOD).unwrap();
    read("missing, beside a file of nearly that name", "thesis-lense.toml");
    read("missing, beside a file of another name", "quartz.toml");
    read("missing, in a missing folder", "nowhere/thesis-lens.toml");
    std::fs::create_dir(folder.path().join("folder")).unwrap();
    read("a folder", "folder");
    std::fs::write(folder.path().join("latin-1.toml"), b"format = 1\nname = \"lens\" # f\xfcr Messing\n").unwrap();
    read("not UTF-8", "latin-1.toml");
    std::fs::write(folder.path().join("empty.toml"), "").unwrap();
    read("empty", "empty.toml");
    std::fs::write(folder.path().join("cut.toml"), &GOOD[..GOOD.find("mm\"").unwrap()]).unwrap();
    read("cut off within a value", "cut.toml");
    std::fs::write(folder.path().join("half.toml"), &GOOD[..GOOD.find("[impact]").unwrap()]).unwrap();
    read("cut off between sections", "half.toml");
    insta::assert_snapshot!(page);
}

/// What `--json` prints, and the excerpt that a terminal shows.
#[test]
fn an_error_knows_its_place() {
    let error = refusal("a number without unit", &with("\"26 kN\"", "26"));
    assert_eq!(
        (error.file.as_path(), error.line, error.key.as_deref()),
        (Path::new("bad.toml"), Some(14), Some("impact.force"))
    );
    let excerpt = excerpt(&error);
    insta::assert_snapshot!(excerpt);
}

fn excerpt(error: &DesignError) -> String {
    let mut shown = String::new();
    let handler = miette::GraphicalReportHandler::new_themed(miette::GraphicalTheme::none());
    handler.render_report(&mut shown, error).expect("the place lies within the text");
    shown
}

#[test]
fn a_file_cut_anywhere_is_read_or_refused() {
    for at in 0..GOOD.len() {
        let _ = Design::parse("cut.toml", &GOOD[..at]).map_err(|error| excerpt(&error));
        let _ = Design::parse("cut.toml", &GOOD[at..]).map_err(|error| excerpt(&error));
    }
}

/// Pieces that are odd at one place or another.
const ODD: &[&str] = &[
    "",
    "\"",
    "[",
    "]",
    "{",
    "}",
    "=",
    "\n",
    "-",
    "0",
    "1e999",
    "nan",
    "-inf",
    "é",
    "\u{feff}",
    "\0",
    "D",
    "\"D\"",
    "%",
    "[[run]]",
    "[a.b.c]",
    "x.y = 1",
    "1979-05-27",
    "99999999999",
    "true",
    "\"\"\"",
    "expected `",
    "[\"0 D\"]",
    "100000",
    "50000",
];

proptest! {
    /// Whatever is done to the good file, the answer is a design or an error whose line is one of the text.
    #[test]
    fn a_garbled_file_is_read_or_refused(
        edits in prop::collection::vec((any::<prop::sample::Index>(), 0..12_usize, prop::sample::select(ODD)), 1..4)
    ) {
        let mut text = GOOD.to_owned();
        for (at, length, piece) in edits {
            let boundary = |at: usize| (0..=at.min(text.len())).rev().find(|&at| text.is_char_boundary(at)).unwrap();
            let start = boundary(at.index(text.len()));
            let end = boundary(start + length).max(start);
            text.replace_range(start..end, piece);
        }
        if let Err(error) = Design::parse("garbled.toml", &text) {
            prop_assert!(error.line.is_none_or(|line| (1..=text.lines().count().max(1)).contains(&line)), "{error}\n{text}");
            prop_assert!(!error.to_string().contains('\n'), "{error}");
            prop_assert!(!error.help.is_empty(), "{error}");
            excerpt(&error);
        }
    }

    /// The same with whole lines left out or exchanged.
    #[test]
    fn shuffled_lines_are_read_or_refused(
        edits in prop::collection::vec((any::<prop::sample::Index>(), prop::option::of(any::<prop::sample::Index>())), 1..6)
    ) {
        let mut lines: Vec<&str> = GOOD.lines().collect();
        for (at, other) in edits {
            let at = at.index(lines.len());
            match other {
                Some(other) => lines[at] = GOOD.lines().nth(other.index(GOOD.lines().count())).unwrap(),
                None => { lines.remove(at); }
            }
        }
        let _ = Design::parse("shuffled.toml", &lines.join("\n")).map_err(|error| error.to_string());
    }
}
