//! Crystals that are followed by their rows.

use granulens::run::is_large;

use super::resume::{contents, same};
use super::*;

const RIG: &str = r#"
[crystal]
packing = "hcp"
diameter = "6.35 mm"
layers = 24
cells = [30, 15]
material = "stainless-440c"
[[pattern]]
kind = "mix"
materials = ["brass-260", "stainless-440c"]
fractions = [0.3, 0.7]
seed = 3
[sides]
x = "periodic"
y = "periodic"
[law]
kind = "thesis"
[[load]]
kind = "force"
layers = 1
pulse = "square"
peak = "12 kN"
duration = "5 us"
[run]
window = "15 us"
step = "100 ns"
[[region]]
name = "middle"
layers = [3, 4]
"#;

const RECORD: &str = "[record]\nevery = \"1 us\"\narrivals = \"0.1 m/s\"\ny = [\"0 D\", \"0.5 D\"]\n";

fn prepared(more: &str) -> PreparedRig<3> {
    solid(&format!("{HEAD}{RIG}{RECORD}{more}"))
}

/// Asked for events as well, the same rig is followed by the machine that looks for contacts: all that both write is the same to rounding.
#[test]
fn a_large_crystal_has_the_records_of_any_rig() {
    let (by_rows, by_contacts) = (prepared(""), prepared("events = \"yields\"\n"));
    assert!(is_large(&by_rows) && !is_large(&by_contacts));
    let (ours, theirs) = (Ran::of(&by_rows), Ran::of(&by_contacts));
    assert_eq!((ours.ending.clone(), theirs.ending.clone()), (Ending::Complete, Ending::Complete));
    for (name, allowed) in [
        ("energies.csv", 1e-9),
        ("layers.csv", 1e-9),
        ("regions.csv", 1e-9),
        ("spheres.csv", 1e-8),
        ("layers-final.csv", 1e-8),
        ("regions-final.csv", 1e-9),
    ] {
        let (ours, theirs) = (ours.series(name), theirs.series(name));
        for column in ours.names.iter().filter(|column| *column != "residual") {
            let (ours, theirs) = (ours.column(column), theirs.column(column));
            assert_eq!(ours.len(), theirs.len(), "{name} {column}");
            let greatest = theirs.iter().copied().filter(|x| x.is_finite()).map(f64::abs).fold(0.0, f64::max);
            for (ours, theirs) in ours.iter().zip(theirs) {
                // Not where both are no numbers.
                let is_off = (ours - theirs).abs() > allowed * greatest;
                assert!(!is_off, "{name} {column}: {ours} and {theirs}");
            }
        }
    }
    let energies = ours.series("energies.csv");
    let residuals = energies.column("residual");
    // As good as the class that was asked for.
    assert!(residuals.iter().all(|residual| residual.abs() < by_rows.rig.residual_limit), "{residuals:?}");
}

/// On one thread and on two, in one go and in pieces, each ended between samples and gone on with from a checkpoint.
#[test]
fn a_large_crystal_goes_on_to_the_same_bytes_on_any_number_of_threads() {
    let prepared = prepared("");
    let on = |threads: usize| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let whole = on(2).install(|| Ran::of(&prepared));
    let folder = tempfile::tempdir().unwrap();
    let mut resume = false;
    for stop in [13, 57, 90, 143, u64::MAX] {
        let keeping = Keeping { resume, every: Duration::ZERO };
        let context = until(move |done, _| done >= stop);
        let (_, ending) = on(1).install(|| run::run(&prepared, folder.path(), keeping, &context)).unwrap();
        resume = true;
        assert_eq!(matches!(ending, Ending::Complete), stop == u64::MAX, "{ending:?}");
    }
    same(whole.folder.path(), folder.path());
    assert!(contents(folder.path()).iter().all(|(name, _)| !name.starts_with("checkpoint")));
}

/// Whatever else a rig has is followed as before.
#[test]
fn what_is_more_than_a_crystal_is_no_large_one() {
    let text = format!("{HEAD}{RIG}");
    assert!(is_large(&solid(&text)));
    for more in [
        "[friction]\ncoefficient = 0.1\nspring = \"mindlin\"\n",
        "[gravity]\nacceleration = \"9.81 m/s2\"\n",
        "[[flat]]\nname = \"anvil\"\nat = \"back\"\n",
        "[[edit]]\nlayers = 24\nhold = [\"z\"]\n",
        "[[load]]\nkind = \"force\"\nlayers = 24\npulse = \"square\"\npeak = \"1 N\"\nduration = \"1 us\"\n",
    ] {
        assert!(!is_large(&solid(&format!("{text}{more}"))), "{more}");
    }
    assert!(!is_large(&solid(&text.replace("layers = 24\ncells", "layers = 12\ncells"))));
    assert!(!is_large(&solid(&text.replace("[run]", "direction = [0.0, 1.0, 1.0]\n[run]"))));
}
