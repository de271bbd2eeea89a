//! What a wrong rig file hears.

use super::*;

/// A rig that is right.
const RIGHT: &str = r#"format = 1
kind = "rig"
name = "test"
[crystal]
packing = "hexagonal"
diameter = "6.35 mm"
layers = 5
x = ["0 D", "4 D"]
material = "brass-260"
[[pattern]]
kind = "stripes"
materials = ["brass-260", "440c"]
angle = "60 deg"
widths = ["1 D", "2 D"]
[sides]
x = ["wall", "free"]
[[flat]]
name = "bar"
at = "front"
mass = "0.1 kg"
velocity = "10 m/s"
[[load]]
kind = "force"
layers = 5
pulse = "half-sine"
peak = "1 kN"
duration = "20 us"
[run]
window = "50 us"
[record]
arrivals = ["1 %"]
"#;

fn heard(text: &str) -> String {
    match Setup::parse("rig.toml", text) {
        Err(error) => format!("{error}\n    {}", error.help),
        Ok(_) => "accepted".to_owned(),
    }
}

#[test]
fn the_right_file_is_right() {
    assert_eq!(heard(RIGHT), "accepted");
}

/// Each change makes one thing wrong; the answer names file, line, key, value, the rule broken and the way out.
#[test]
fn every_slip_is_answered() {
    let slips = [
        ("kind = \"rig\"", "kind = \"lens\""),
        ("format = 1", "format = 7"),
        ("name = \"test\"", "name = \"a/b\""),
        ("[crystal]", "[cristal]"),
        ("packing = \"hexagonal\"", "packing = \"hexagon\""),
        ("packing = \"hexagonal\"", "packing = \"hcp\""),
        ("packing = \"hexagonal\"", "packing = \"chain\""),
        ("diameter = \"6.35 mm\"", "diameter = 6.35"),
        ("layers = 5\nx", "layers = 0\nx"),
        ("x = [\"0 D\", \"4 D\"]", "x = [\"4 D\", \"0 D\"]"),
        ("x = [\"0 D\", \"4 D\"]", "x = [\"0.1 D\", \"0.4 D\"]"),
        ("x = [\"0 D\", \"4 D\"]", ""),
        ("x = [\"0 D\", \"4 D\"]", "cells = [4, 4]"),
        ("x = [\"0 D\", \"4 D\"]", "x = [\"0 D\", \"4 D\"]\nhexagon = 5"),
        ("material = \"brass-260\"", "material = \"bras\""),
        ("[[pattern]]", "[pattern]"),
        ("[[pattern]]", "[[patern]]"),
        ("kind = \"stripes\"", "kind = \"stripe\""),
        ("kind = \"stripes\"", "kind = \"uniform\""),
        ("widths = [\"1 D\", \"2 D\"]", "widths = [\"1 D\"]"),
        ("angle = \"60 deg\"", "angle = \"60\""),
        ("angle = \"60 deg\"", "angles = \"60 deg\""),
        ("angle = \"60 deg\"", "angle = \"60 deg\"\nlayers = [7, 9]"),
        ("angle = \"60 deg\"", "angle = \"60 deg\"\ny = [\"0 D\", \"1 D\"]"),
        ("x = [\"wall\", \"free\"]", "x = \"periodic\""),
        ("x = [\"wall\", \"free\"]", "x = [\"wal\", \"free\"]"),
        ("x = [\"wall\", \"free\"]", "y = \"free\""),
        ("at = \"front\"", "at = \"top\""),
        ("at = \"front\"", "at = \"front\"\npoint = [\"0 D\", \"0 D\"]"),
        ("at = \"front\"", "at = \"front\"\nhexagon = \"12.7 mm\""),
        ("mass = \"0.1 kg\"", "mass = \"0.1 m\""),
        ("velocity = \"10 m/s\"", "velocity = [\"10 m/s\"]"),
        ("kind = \"force\"", "kind = \"push\""),
        ("layers = 5\npulse", "pulse"),
        ("layers = 5\npulse", "flat = \"barr\"\npulse"),
        ("layers = 5\npulse", "columns = 9\npulse"),
        ("peak = \"1 kN\"", "peak = \"1 m/s\""),
        ("pulse = \"half-sine\"", "pulse = \"table\""),
        ("pulse = \"half-sine\"\npeak = \"1 kN\"\nduration = \"20 us\"", "pulse = \"table\"\nfile = \"none.csv\""),
        ("window = \"50 us\"", ""),
        ("window = \"50 us\"", "window = \"50 us\"\nstep = \"1 ms\""),
        ("window = \"50 us\"", "window = \"50 us\"\naccuracy = \"5 %\""),
        ("window = \"50 us\"", "window = \"1 s\"\nstep = \"1e-15 s\""),
        ("arrivals = [\"1 %\"]", "arrivals = [\"1 kN\"]"),
        ("arrivals = [\"1 %\"]", "pictures = [\"xt\"]"),
        ("arrivals = [\"1 %\"]", "arrivals = [\"1 %\"]\nevents = [\"arrives\"]"),
        ("arrivals = [\"1 %\"]", "events = [\"open\"]"),
        ("arrivals = [\"1 %\"]", "contacts = \"some\""),
        ("[run]", "[[region]]\nname = \"a b\"\nlayers = 1\n[run]"),
        ("[run]", "[[region]]\nname = \"end\"\ncolumns = 99\n[run]"),
        ("angle = \"60 deg\"", "angle = \"60 deg\"\nfile = \"lens.csv\""),
        ("kind = \"stripes\"", "kind = \"layout\"\nfile = \"none.csv\""),
        ("[run]", "[law]\nkind = \"spring-dashpot\"\nstiffness = \"1e7 N/m\"\n[run]"),
        ("[run]", "[law]\nkind = \"spring-dashpot\"\nstiffness = \"1e7 N/m\"\nrestitution = 1.5\n[run]"),
        ("[run]", "[law]\nkind = \"hertz\"\nrestitution = 0.5\n[run]"),
        ("[run]", "[[intruder]]\nshape = \"disk\"\nmaterial = \"440c\"\n[run]"),
        ("[run]", "[[intruder]]\nshape = \"ball\"\nmaterial = \"440c\"\nvelocity = \"1 m/s\"\n[run]"),
        (
            "[run]",
            "[[intruder]]\nshape = \"ball\"\nmaterial = \"440c\"\ndiameter = \"1 cm\"\nhalf_width = \"2 D\"\n[run]",
        ),
        ("[run]", "[[intruder]]\nname = \"bar\"\nshape = \"ball\"\nmaterial = \"440c\"\ndiameter = \"1 cm\"\n[run]"),
        (
            "[run]",
            "[[intruder]]\nshape = \"ogive\"\nmaterial = \"440c\"\nhalf_width = \"4 D\"\nhalf_height = \"3 D\"\n[run]",
        ),
        (
            "[run]",
            "[[intruder]]\nshape = \"ogive\"\nmaterial = \"440c\"\nhalf_width = \"2 D\"\nhalf_height = \"3 D\"\n[run]",
        ),
        (
            "x = [\"wall\", \"free\"]",
            "x = \"mirror\"\n[[intruder]]\nshape = \"ogive\"\nmaterial = \"440c\"\nhalf_width = \"2 D\"\nhalf_height = \"3 D\"",
        ),
        ("[run]", "[law]\nkind = \"thesis\"\ntable = \"a.csv\"\n[run]"),
        ("[run]", "[[pair]]\nmaterials = [\"302\", \"440c\"]\nkind = \"hertz\"\n[run]"),
        ("[run]", "[friction]\ncoefficient = -0.1\nspring = \"none\"\n[run]"),
        ("[run]", "[friction]\ncoefficient = 0.1\nspring = \"hard\"\n[run]"),
        ("[run]", "[[edit]]\nlayers = 2\n[run]"),
        ("[run]", "[[edit]]\nlayers = 2\nmove = [\"1 mm\"]\n[run]"),
        ("[run]", "[[edit]]\nlayers = [1, 5]\nremove = true\n[run]"),
        ("[run]", "[[bar]]\nlayers = 5\nmaterial = \"440c\"\n[run]"),
        ("[run]", "[[moving]]\nlayers = 5\n[run]"),
    ];
    let mut answers = String::new();
    for (right, wrong) in slips {
        assert!(RIGHT.contains(right), "{right}");
        let answer = heard(&RIGHT.replacen(right, wrong, 1));
        assert_ne!(answer, "accepted", "{wrong}");
        answers += &format!("{}\n  {answer}\n", wrong.replace('\n', " | "));
    }
    insta::assert_snapshot!(answers);
}

/// Tables say what is wrong with which line.
#[test]
fn tables_are_answered_by_line() {
    let folder = tempfile::tempdir().unwrap();
    let load = "pulse = \"half-sine\"\npeak = \"1 kN\"\nduration = \"20 us\"";
    let text = RIGHT.replace(load, "pulse = \"table\"\nfile = \"pulse.csv\"");
    let heard = |table: &str| {
        std::fs::write(folder.path().join("pulse.csv"), table).unwrap();
        let error = Setup::parse(folder.path().join("rig.toml"), &text).map(|_| ()).unwrap_err().to_string();
        error.rsplit_once("pulse.csv").unwrap().1.to_owned()
    };
    assert_eq!(heard("0,1\n1,2\n"), ":1: \"0,1\" is not the header time_s,force_N.");
    assert_eq!(heard("# by hand\ntime_s,force_N\n0,0\n1e-6,ten\n"), ":4: force_N = \"ten\" is not a finite number.");
    assert_eq!(heard("time_s,force_N\n0,0,0\n"), ":2: has 3 values, expected 2.");
    assert_eq!(heard("time_s,force_N\n0,0\n0,1\n"), ": the time of point 2 is not after that of the point before it.");
    assert_eq!(heard(""), ":1: holds no lines.");
}

/// Any byte cut out of a right file is answered or accepted, never a panic.
#[test]
fn no_file_makes_it_panic() {
    for at in 0..RIGHT.len() {
        let mut text = RIGHT.to_owned();
        text.remove(at);
        let _ = Setup::parse("rig.toml", &text);
    }
}
