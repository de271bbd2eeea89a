//! What a lens's spheres felt is the same from `check` and from `simulate`: one meaning of every recorded quantity.

use std::path::Path;
use std::process::Command;

/// A crystal with spheres on both mirror lines, short enough for contacts not to open and close.
const DESIGN: &str = r#"format = 1
name = "mirrored"
[crystal]
packing = "hexagonal-2d"
diameter = "6.35 mm"
rows = 8
half_width = 3.0
sides = "mirror"
host = "stainless-440c"
[impact]
kind = "force-pulse"
force = "10 kN"
duration = "20 us"
[target]
focus = { rows = [5, 6], x = ["0 D", "1 D"] }
protect = { rows = [5, 6], x = ["2 D", "3 D"] }
[run]
window = "40 us"
"#;

fn run(folder: &Path, arguments: &[&str]) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_granulens"));
    let output = command.current_dir(folder).args(arguments).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

/// A column of a table by its name.
fn column(text: &str, name: &str) -> Vec<f64> {
    let mut lines = text.lines();
    let place = lines.next().unwrap().split(',').position(|head| head == name).unwrap_or_else(|| panic!("{name}"));
    lines.map(|line| line.split(',').nth(place).unwrap().parse().unwrap()).collect()
}

/// Both follow the same crystal by velocity Verlet at the step that the same rule chooses; what differs is the order of sums.
#[test]
fn a_check_and_a_rig_mean_the_same_by_the_force_on_a_sphere() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("mirrored.toml"), DESIGN).unwrap();
    let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
    let design = granulens::design::Design::read(folder.path().join("mirrored.toml")).unwrap();
    let layout = granulens::layout::Layout::new(design.lattice, vec![design.host.clone()], |_| 0);
    std::fs::write(folder.path().join("host.csv"), granulens::layout::write(&layout)).unwrap();
    let check = ["check", "host.csv", "--design", "mirrored.toml", "--integrator", "verlet"];
    run(folder.path(), &[&check[..], &["--spheres", "checked.csv", "--out", "checked.json", "--quiet"]].concat());
    run(folder.path(), &["simulate", "mirrored.toml", "--out", "simulated", "--quiet"]);

    let [checked, simulated] = [read("checked.json"), read("simulated/trial.json")];
    let [checked, simulated]: [serde_json::Value; 2] =
        [checked, simulated].map(|text| serde_json::from_str(&text).unwrap());
    for key in ["step_s", "window_s", "integrator", "law", "constants", "version", "commit"] {
        assert_eq!(checked[key], simulated[key], "{key}");
    }
    let [checked, simulated] = [read("checked.csv"), read("simulated/spheres-final.csv")];
    let pairs =
        [("max_net_force_N", "max_force_N"), ("max_kinetic_J", "max_kinetic_J"), ("dissipated_J", "dissipated_J")];
    let x = column(&checked, "x");
    let on_mirrors = x.iter().filter(|&x| !(1e-9..=3.0 * 6.35e-3 - 1e-9).contains(x)).count();
    assert_eq!(on_mirrors, 8);
    for (here, there) in pairs {
        for (i, (a, b)) in column(&checked, here).into_iter().zip(column(&simulated, there)).enumerate() {
            assert!((a - b).abs() <= 1e-9 * a.abs().max(1e-6), "{here} of sphere {i}: {a} and {b}");
        }
    }
}
