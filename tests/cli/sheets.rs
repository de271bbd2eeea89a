//! Sheets in square packing and of rows of several sizes: what takes them, and what says that it does not.

use super::Desk;

const D: f64 = 6.35e-3;

/// A design without a lens.
fn design(packing: &str, diameters: &str) -> String {
    format!(
        r#"format = 1
name = "other"
[crystal]
packing = "{packing}"
diameter = "6.35 mm"
{diameters}
rows = 14
half_width = 5
sides = "mirror"
host = "stainless-440c"
law = "thesis"
[impact]
kind = "force-pulse"
force = "6 kN"
duration = "20 us"
[target]
focus = {{ rows = [10, 11], x = ["0 D", "1 D"] }}
protect = {{ rows = [10, 11], x = ["3 D", "5 D"] }}
[compare]
material = "brass-260"
seeds = 1
[run]
window = "150 us"
"#
    )
}

/// Rows of these diameters (m), laid by the rule of docs/sheets.md, with a block of brass from row 4 to 6 beside the axis.
fn layout(square: bool, sizes: &[f64]) -> String {
    let mut text = "row,column,x,z,diameter,material\n".to_owned();
    let (mut z, mut before) = (0.0, 0.0);
    for row in 1..=14_usize {
        let d = sizes[(row - 1) % sizes.len()];
        if row > 1 {
            let aside = if square { 0.0 } else { 0.5 * D };
            z += (0.25 * f64::powi(before + d, 2) - aside * aside).sqrt();
        }
        before = d;
        let first = if square || row % 2 == 1 { 0.0 } else { 0.5 };
        for (column, x) in (0..).map(|k| first + f64::from(k)).take_while(|x| *x <= 5.0).enumerate() {
            let material = if (4..=6).contains(&row) && x < 1.6 { "brass-260" } else { "stainless-440c" };
            text += &format!("{row},{},{},{z},{d},{material}\n", column + 1, x * D);
        }
    }
    text
}

/// Checked, compared, searched, simulated, exported and built; the host alone carries a plane wave, the same in every column.
#[test]
fn a_square_sheet_is_judged_as_any_other() {
    let desk = Desk::new();
    desk.write("square.toml", design("square-2d", ""));
    desk.write("layout.csv", layout(true, &[D]));
    let host = layout(true, &[D]).replace("brass-260", "stainless-440c");
    desk.write("host.csv", host);
    let of = |layout: &str| desk.run(&["check", layout, "--design", "square.toml", "--json"]).ok().json();
    let (drawn, plain) = (of("layout.csv"), of("host.csv"));
    assert!((plain["contrast"].as_f64().unwrap() - 1.0).abs() < 1e-9, "{plain}");
    assert!((drawn["contrast"].as_f64().unwrap() - 1.0).abs() > 1e-3, "{drawn}");
    assert!(drawn["focal_gain"].is_number() && drawn["protection"].is_number(), "{drawn}");
    let compared = desk.run(&["compare", "square.toml", "layout.csv", "--forces", "1", "--json"]).ok().json();
    assert_eq!(compared["arrangements"][0]["scores"]["contrast"].as_f64(), drawn["contrast"].as_f64());
    let study = "format = 1\ndesign = \"square.toml\"\nmaterials = [\"stainless-440c\", \"brass-260\"]\nrows = [2, 8]\n\
                 objective = { contrast = { maximise = 1 } }\nseed = 1\nstart = \"random\"\nmethod = \"anneal\"\nbudget = 16\nstep = \"5e-7 s\"\n";
    desk.write("study.toml", study);
    desk.run(&["study", "run", "study.toml", "--out", "found"]).ok();
    assert!(desk.read("found/best.csv").contains("# square-2d, "), "{:.300}", desk.read("found/best.csv"));
    desk.run(&["check", "found/best.csv", "--design", "square.toml"]).ok();
    desk.run(&["simulate", "square.toml", "--out", "rig"]).ok();
    desk.run(&["export", "layout.csv", "--design", "square.toml", "--lammps", "deck"]).ok();
    let built = desk.run(&["build", "layout.csv", "--design", "square.toml", "--out", "shop", "--json"]).ok().json();
    assert_eq!(built["spheres"], 14 * 11);
    desk.run(&["diff", "layout.csv", "host.csv"]).ok();
    desk.write("lens.toml", design("square-2d", "") + "[lens]\nfamily = \"plano-convex\"\nmaterial = \"brass-260\"\n");
    for (asked, said) in [
        (&["design", "lens.toml"][..], "a square packing as in chains"),
        (&["trace", "square.toml", "layout.csv"][..], "hexagonal sheet of equal spheres"),
    ] {
        let refused = desk.run(asked);
        assert!(refused.code == 2 && refused.stderr.contains(said), "{asked:?}: {}", refused.stderr);
    }
}

/// The same of rows of three sizes, in either packing; their lines say what each sphere is.
#[test]
fn rows_of_several_sizes_are_judged_too() {
    for (packing, square) in [("hexagonal-2d", false), ("square-2d", true)] {
        let desk = Desk::new();
        let sizes = [D, 5.5e-3, 6e-3];
        desk.write("sizes.toml", design(packing, "diameters = [\"6.35 mm\", \"5.5 mm\", \"6 mm\"]"));
        desk.write("layout.csv", layout(square, &sizes));
        let checked = desk.run(&["check", "layout.csv", "--design", "sizes.toml", "--json"]).ok().json();
        let compared = desk.run(&["compare", "sizes.toml", "layout.csv", "--forces", "2", "--json"]).ok().json();
        let first = &compared["arrangements"][0]["scores"];
        assert_eq!(first["contrast"].as_f64(), checked["contrast"].as_f64());
        // The mass of all spheres of the piece, those of the axis once.
        let mass: f64 = layout(square, &sizes)
            .lines()
            .skip(1)
            .map(|line| {
                let cells: Vec<&str> = line.split(',').collect();
                let [x, d]: [f64; 2] = [2, 4].map(|k| cells[k].parse().unwrap());
                let density = if cells[5] == "brass-260" { 8530.0 } else { 7800.0 };
                let copies = if x == 0.0 { 1.0 } else { 2.0 };
                copies * density * std::f64::consts::PI / 6.0 * d.powi(3)
            })
            .sum();
        let told = checked["piece"]["mass_kg"].as_f64().unwrap();
        assert!((told / mass - 1.0).abs() < 0.02, "{told} {mass}");
        desk.run(&["simulate", "sizes.toml", "--out", "rig"]).ok();
        desk.write("wrong.csv", layout(square, &[D]));
        for (asked, said) in [
            (&["check", "wrong.csv", "--design", "sizes.toml"][..], "z = "),
            (&["build", "layout.csv", "--design", "sizes.toml", "--out", "shop"][..], "rows of several sizes"),
            (&["tolerance", "layout.csv", "--design", "sizes.toml"][..], "rows of several sizes"),
        ] {
            let refused = desk.run(asked);
            assert!(refused.code == 2 && refused.stderr.contains(said), "{asked:?}: {}", refused.stderr);
        }
        desk.write("small.toml", design(packing, "diameters = [\"6.35 mm\", \"7 mm\"]"));
        let refused = desk.run(&["check", "layout.csv", "--design", "small.toml"]);
        assert!(refused.code == 2 && refused.stderr.contains("row 2 has spheres of 0.007 m"), "{}", refused.stderr);
    }
}
