//! Files for other tools, read back by other readers; and LAMMPS as a witness.

mod lammps;
mod readers;
mod views;

use granulens::Context;
use granulens::contact::{Constants, LawKind};
use granulens::dem::ForcePulse;
use granulens::dem::rig::{Rig, Simulation};
use granulens::export::whole_crystal;
use granulens::lattice::HexagonalSheet;
use granulens::layout::Layout;
use granulens::material::find;

static GO: std::sync::LazyLock<Context> = std::sync::LazyLock::new(Context::default);

const DIAMETER: f64 = 6.35e-3;

/// A small lens: brass about the axis in rows 4 to 8 of a sheet of 440c, 12 rows deep and 9 diameters around.
fn layout() -> Layout {
    let sheet = HexagonalSheet::new(DIAMETER, 12, 4.5).unwrap();
    let palette = ["440c", "brass"].map(|name| find(name, &[]).unwrap()).to_vec();
    Layout::new(sheet, palette, |site| u8::from((4..=8).contains(&site.row) && site.x < 2.2 * DIAMETER))
}

fn rig(law: LawKind) -> Rig<2> {
    whole_crystal(&layout(), ForcePulse { force: 2e3, duration: 20e-6 }, law, Constants::Code)
}

fn run(rig: Rig<2>, step: f64, steps: u64) -> Simulation<2> {
    let mut simulation = Simulation::new(rig, step).unwrap();
    simulation.advance(steps, &GO).unwrap();
    simulation
}

/// The command writes what is asked for, at once, and leaves alone what is there.
#[test]
fn the_command_writes_all_three() {
    let folder = tempfile::tempdir().unwrap();
    let design = concat!(env!("CARGO_MANIFEST_DIR"), "/designs/quickstart.toml");
    let export = |arguments: &[&str]| {
        let mut command = assert_cmd::Command::cargo_bin("granulens").unwrap();
        command.current_dir(folder.path()).args(["export", design, "--window", "40 us", "--every", "10 us"]);
        command.args(arguments).output().unwrap()
    };
    let output = export(&["--xyz", "frames.xyz", "--vtp", "frames", "--lammps", "deck"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
    let spheres = 2 * 850 - 50;
    assert_eq!(read("frames.xyz").lines().filter(|line| *line == spheres.to_string()).count(), 5);
    for list in ["frames/spheres.pvd", "frames/contacts.pvd"] {
        let text = read(list);
        let document = roxmltree::Document::parse(&text).unwrap();
        let files: Vec<_> = document.descendants().filter_map(|node| node.attribute("file")).collect();
        assert_eq!(files.len(), 5);
        assert!(files.iter().all(|file| folder.path().join("frames").join(file).is_file()));
    }
    assert!(read("deck/crystal.data").contains(&format!("{spheres} atoms")));
    assert_eq!(read("deck/granulens.dump").matches("ITEM: TIMESTEP").count(), 5);
    let again = export(&["--vtp", "frames"]);
    assert_eq!(again.status.code(), Some(2));
    assert!(String::from_utf8(again.stderr).unwrap().contains("frames exists and is left alone"));
    assert_eq!(export(&[]).status.code(), Some(2));
}

/// Rig files too: in one and three dimensions, with flats; for LAMMPS where it has the same laws, else with the reason.
#[test]
fn the_command_takes_rig_files() {
    let folder = tempfile::tempdir().unwrap();
    let export = |design: &str, arguments: &[&str]| {
        let mut command = assert_cmd::Command::cargo_bin("granulens").unwrap();
        let design = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("designs").join(design);
        command.current_dir(folder.path()).arg("export").arg(design).args(arguments).output().unwrap()
    };
    let short = ["--window", "20 us", "--every", "10 us"];
    let frames = |text: &str| text.lines().filter(|line| line.starts_with("Lattice=")).count();
    for (design, spheres) in [("column-1d.toml", 50), ("drop-tower-hcp.toml", 0)] {
        let output = export(design, &[&short[..], &["--xyz", "rig.xyz"]].concat());
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let text = std::fs::read_to_string(folder.path().join("rig.xyz")).unwrap();
        assert_eq!(frames(&text), 3, "{design}");
        assert!(spheres == 0 || text.starts_with(&format!("{spheres}\n")));
    }
    let hertz = folder.path().join("hertz.toml");
    let column = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/designs/column-1d.toml")).unwrap();
    std::fs::write(&hertz, column.replace("kind = \"thesis\"", "kind = \"hertz\"")).unwrap();
    let output = export(hertz.to_str().unwrap(), &[&short[..], &["--step", "0.1 us", "--lammps", "deck"]].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(std::fs::read_to_string(folder.path().join("deck/crystal.data")).unwrap().contains("50 atoms"));
    let refused = export("column-1d.toml", &[&short[..], &["--lammps", "other"]].concat());
    assert_eq!(refused.status.code(), Some(2));
    assert!(String::from_utf8(refused.stderr).unwrap().contains("no counterpart of the contact law \"thesis\""));
    assert!(!folder.path().join("other").exists());
}
