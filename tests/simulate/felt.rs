//! What a crystal's spheres felt is the same from `check`, `simulate`, a rig of it and a batch: one meaning of every recorded quantity.

use std::path::Path;
use std::process::Command;

use granulens::Context;
use granulens::dem::{Integrator, simulate_batch};
use granulens::evaluate::{Overrides, Plan};
use granulens::real::Width;
use granulens::setup::Setup;

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

/// The same crystal as a lab would describe it.
const RIG: &str = r#"format = 1
kind = "rig"
name = "mirrored-rig"
[crystal]
packing = "hexagonal"
diameter = "6.35 mm"
layers = 8
x = ["0 D", "3 D"]
material = "stainless-440c"
[sides]
x = "mirror"
[[load]]
kind = "force"
layers = 1
pulse = "square"
peak = "10 kN"
duration = "20 us"
[law]
kind = "thesis"
[run]
window = "40 us"
"#;

/// What the same spheres felt by each of four ways.
struct Told {
    /// Step, window, integrator, law, constants, version, commit.
    how: Vec<serde_json::Value>,
    kinetic: Vec<f64>,
    force: Vec<f64>,
    dissipated: Vec<f64>,
}

/// All follow the same crystal by velocity Verlet at the step that the same rule chooses; what differs is the order of sums, and, of
/// contacts 2e-8 of a diameter open, rounding of places.
#[test]
fn check_simulate_rig_and_batch_mean_the_same_by_what_a_sphere_felt() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
    write("mirrored.toml", DESIGN);
    write("rig.toml", RIG);
    let design = granulens::design::Design::read(folder.path().join("mirrored.toml")).unwrap();
    let layout = granulens::layout::Layout::new(design.lattice.clone(), vec![design.host.clone()], |_| 0);
    write("host.csv", &granulens::layout::write(&layout));
    let check = ["check", "host.csv", "--design", "mirrored.toml", "--integrator", "verlet"];
    run(folder.path(), &[&check[..], &["--spheres", "checked.csv", "--out", "checked.json", "--quiet"]].concat());
    run(folder.path(), &["simulate", "mirrored.toml", "--out", "simulated", "--quiet"]);
    run(folder.path(), &["simulate", "rig.toml", "--out", "rig", "--quiet"]);

    let told = |json: &str, table: &str, force: &str| {
        let (json, table): (serde_json::Value, String) = (serde_json::from_str(&read(json)).unwrap(), read(table));
        let how = ["step_s", "window_s", "integrator", "law", "constants", "version", "commit"];
        Told {
            how: how.map(|key| json[key].clone()).to_vec(),
            kinetic: column(&table, "max_kinetic_J"),
            force: column(&table, force),
            dissipated: column(&table, "dissipated_J"),
        }
    };
    let checked = told("checked.json", "checked.csv", "max_net_force_N");
    let x = column(&read("checked.csv"), "x");
    let on_mirrors = x.iter().filter(|&x| !(1e-9..=3.0 * 6.35e-3 - 1e-9).contains(x)).count();
    assert_eq!(on_mirrors, 8);
    assert!(checked.how.iter().all(|value| !value.is_null()), "{:?}", checked.how);
    for name in ["simulated", "rig"] {
        let told = told(&format!("{name}/trial.json"), &format!("{name}/spheres-final.csv"), "max_force_N");
        assert_eq!(told.how, checked.how, "{name}");
        for (what, here, there) in [
            ("kinetic", &checked.kinetic, &told.kinetic),
            ("force", &checked.force, &told.force),
            ("dissipated", &checked.dissipated, &told.dissipated),
        ] {
            assert_eq!(here.len(), there.len(), "{name}");
            for (i, (a, b)) in here.iter().zip(there).enumerate() {
                assert!((a - b).abs() <= 1e-9 * a.abs().max(1e-6), "{name}: {what} of sphere {i}: {a} and {b}");
            }
        }
    }

    // Batches follow the same arithmetic as a run alone.
    let overrides = Overrides { integrator: Some(Integrator::Verlet), ..Overrides::default() };
    let plan = Plan::new(&design, overrides, &layout.palette).unwrap();
    assert_eq!(checked.how[0], plan.step);
    let impact = granulens::evaluate::impact(&design, &plan);
    let batch = simulate_batch(&[layout.sample()], &impact, Width::widest(), &Context::default()).unwrap();
    let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(&batch[0].max_kinetic), bits(&checked.kinetic));
}

/// One rule chooses the step of a crystal and of a rig of it, whatever class, force, pulse and materials: contacts share the load by
/// their angles.
#[test]
fn a_rig_of_a_crystal_has_the_step_of_its_design() {
    for (force, duration, class, host) in [
        ("26 kN", "20 us", "0.1 %", "stainless-440c"),
        ("3 kN", "7 us", "1 %", "brass-260"),
        ("10 kN", "500 ns", "0.1 %", "aluminium-2017"),
    ] {
        let exchanged = |text: &str, material: &str| {
            text.replace("10 kN", force)
                .replace("20 us", duration)
                .replace(&format!("{material} = \"stainless-440c\""), &format!("{material} = \"{host}\""))
                .replace("[run]\n", &format!("[run]\naccuracy = \"{class}\"\n"))
        };
        let design = granulens::design::Design::parse("a.toml", &exchanged(DESIGN, "host")).unwrap();
        let overrides = Overrides { integrator: Some(Integrator::Verlet), ..Overrides::default() };
        let plan = Plan::new(&design, overrides, std::slice::from_ref(&design.host)).unwrap();
        let Setup::Two(rig) = Setup::parse("rig.toml", &exchanged(RIG, "material")).unwrap() else { unreachable!() };
        assert_eq!(
            rig.plan.step, plan.step,
            "{force} {duration} {class}: {} {}",
            rig.plan.step_reason, plan.step_reason
        );
    }
}
