//! No bytes make a reader panic: designs, rig files, studies, layouts, journals, checkpoints, tables, states of a contact.
//!
//! Bounded and seeded: mutations of what the project itself ships, of `tests/corpus/` (inputs that once did harm, or come near
//! it), and for formats with a checksum of bodies that were sealed anew, so that what lies behind it is reached too. Set
//! FUZZ_ROUNDS for a longer run.

mod mutate;

use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::time::Duration;

use granulens::contact::{LawKind, Tabulated};
use granulens::dem::rig::{Arrival, Curve, Flat, Friction, Law, LawBook, Rig, Simulation};
use granulens::design::Design;
use granulens::lattice::HexagonalSheet;
use granulens::material::find;
use granulens::sample::{Sample, Sphere};
use granulens::setup::{PreparedRig, Setup};
use granulens::study::{Journal, Study};
use granulens::{Context, Progress};
use granulens::{layout, run};

use mutate::Mutations;

/// Mutations of each kind of input.
fn rounds(most: u64) -> u64 {
    std::env::var("FUZZ_ROUNDS").ok().and_then(|text| text.parse().ok()).unwrap_or(most)
}

fn project(path: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// Files below a folder with an ending, in order of name; at most `most` bytes of each.
fn files(folder: &str, ending: &str, most: usize) -> Vec<Vec<u8>> {
    let mut paths: Vec<PathBuf> = fs::read_dir(project(folder))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.is_file())
        .collect();
    paths.sort();
    let wanted = |path: &&PathBuf| path.extension().is_some_and(|extension| extension == ending);
    paths
        .iter()
        .filter(wanted)
        .map(|path| fs::read(path).unwrap())
        .map(|mut bytes| {
            bytes.truncate(most);
            bytes
        })
        .collect()
}

/// Reads every input of the corpus and `most` mutations of it; a panic is reported with the bytes that led to it.
fn withstands(name: &str, corpus: Vec<Vec<u8>>, most: u64, read: impl Fn(&[u8])) {
    assert!(!corpus.is_empty(), "{name}: the corpus is empty");
    let mut mutations = Mutations::new(&corpus, 1);
    let all = corpus.iter().cloned().chain((0..rounds(most)).map(|_| mutations.next_input()).collect::<Vec<_>>());
    for (number, bytes) in all.enumerate() {
        if catch_unwind(AssertUnwindSafe(|| read(&bytes))).is_err() {
            panic!("{name}: input {number} makes it panic:\n{}", String::from_utf8_lossy(&bytes));
        }
    }
}

#[test]
fn design_files() {
    let mut corpus = files("designs", "toml", 20_000);
    corpus.extend(files("tests/corpus", "toml", 20_000));
    withstands("design", corpus, 1500, |bytes| {
        if let Ok(text) = std::str::from_utf8(bytes)
            && let Err(error) = Design::parse("fuzz.toml", text)
        {
            // What the user hears is made of the file too.
            let _ = (error.to_string(), format!("{:?}", miette::Report::new(error)));
        }
    });
}

#[test]
fn rig_files() {
    let mut corpus = files("designs", "toml", 20_000);
    corpus.extend(files("tests/corpus", "toml", 20_000));
    withstands("rig", corpus, 600, |bytes| {
        if let Ok(text) = std::str::from_utf8(bytes)
            && let Err(error) = Setup::parse(project("designs/fuzz.toml"), text)
        {
            let _ = (error.to_string(), format!("{:?}", miette::Report::new(error)));
        }
    });
}

#[test]
fn studies() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("designs")).unwrap();
    for name in ["designs/quickstart.toml", "designs/thesis-lens.toml"] {
        fs::copy(project(name), folder.path().join(name)).unwrap();
    }
    fs::create_dir(folder.path().join("studies")).unwrap();
    let path = folder.path().join("studies/fuzz.toml");
    withstands("study", files("studies", "toml", 20_000), 300, |bytes| {
        fs::write(&path, bytes).unwrap();
        if let Err(error) = Study::read(&path, None) {
            let _ = error.to_string();
        }
    });
}

#[test]
fn layouts() {
    let sheet = HexagonalSheet::new(6.35e-3, 50, 16.5).unwrap();
    let palette = ["440c", "brass"].map(|name| find(name, &[]).unwrap());
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("layout.csv");
    let mut corpus = files("designs", "csv", 6000);
    corpus.extend(files("tests/corpus", "csv", 6000));
    withstands("layout", corpus, 1500, |bytes| {
        fs::write(&path, bytes).unwrap();
        if let Err(error) = layout::read(&path, &sheet, &palette, &[]) {
            let _ = (error.to_string(), format!("{:?}", miette::Report::new(error)));
        }
    });
}

#[test]
fn records() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("record.csv");
    let mut corpus = files("designs", "csv", 3000);
    corpus.push(b"time_s,a,b\n0,1,2\n1e-6,3,\n2e-6,x,4\n".to_vec());
    withstands("record", corpus, 800, |bytes| {
        fs::write(&path, bytes).unwrap();
        for most in [0, 1, 5, usize::MAX] {
            let _ = run::Series::read(&path, most);
        }
    });
}

#[test]
fn journals() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("journal.jsonl");
    // A journal as it is begun, and lines of objects.
    let header = {
        let _ = Journal::open(&path).unwrap();
        fs::read(&path).unwrap()
    };
    let line = br#"{"key":"00ff","layout":"a5","evaluations":[[1.0,null,2e300]],"stop":null,"F":1.0,"P":0.5}"#;
    let corpus = vec![header.clone(), [&header[..], line, b"\n"].concat(), line.to_vec()];
    withstands("journal", corpus.clone(), 1000, |bytes| {
        fs::write(&path, bytes).unwrap();
        let _ = Journal::read(&path);
    });
    // The same with every line sealed anew.
    withstands("sealed journal", corpus, 1000, |bytes| {
        let mut text = header.clone();
        for line in bytes.split(|&byte| byte == b'\n') {
            let end = line.windows(8).position(|window| window == b",\"crc\":\"").map_or(line, |at| &line[..at]);
            let body = [end.strip_suffix(b"}").unwrap_or(end), b"}"].concat();
            let seal = format!(",\"crc\":\"{:08x}\"}}\n", crc32fast::hash(&body));
            text.extend(&body[..body.len() - 1]);
            text.extend(seal.as_bytes());
        }
        fs::write(&path, &text).unwrap();
        let _ = Journal::read(&path);
    });
}

/// A rig with all that a checkpoint can hold: contacts, a wall, springs of friction, arrivals of every kind.
fn rig() -> Simulation<2> {
    let sphere = |x: f64, z: f64| Sphere { centre: [x * 6.35e-3, z * 6.35e-3], radius: 3.175e-3, material: 0 };
    let spheres = vec![sphere(0.0, 0.0), sphere(1.0, 0.0), sphere(0.5, 0.75_f64.sqrt()), sphere(1.5, 0.75_f64.sqrt())];
    let sample = Sample { materials: vec![find("440c", &[]).unwrap()], spheres };
    let laws = LawBook::Materials {
        law: Law::Named(LawKind::Thesis),
        constants: Default::default(),
        pairs: Vec::new(),
        friction: Some(Friction::mindlin(0.3)),
    };
    let mut rig = Rig::new(sample, laws);
    rig.velocity[0] = [0.5, 3.0];
    rig.periods[0] = Some(6.0 * 6.35e-3);
    rig.flats.push(Flat::wall("floor", [0.0, 1.4 * 6.35e-3], [0.0, -1.0]));
    let watched =
        vec![Arrival::OwnMaximum(0.01), Arrival::FirstSphere(0.01), Arrival::Speed(0.1), Arrival::Displacement(1e-6)];
    Simulation::new(rig, 1e-7).unwrap().recording(watched)
}

#[test]
fn checkpoints() {
    let go = Context::default();
    let mut simulation = rig();
    let mut corpus = vec![simulation.checkpoint()];
    for _ in 0..3 {
        simulation.advance(60, &go).unwrap();
        corpus.push(simulation.checkpoint());
    }
    let restore = |bytes: &[u8]| {
        let mut simulation = rig();
        if simulation.restore(bytes).is_ok() {
            // Whatever it holds, it is a state: guards may stop it, nothing may panic.
            let _ = simulation.advance(70, &go);
            let _ = (simulation.arrivals(0), simulation.arrivals(3), simulation.ledger(), simulation.checkpoint());
            let _ = simulation.view().contacts().count();
        }
    };
    withstands("checkpoint", corpus.clone(), 2000, restore);
    // Twenty letters, a version, a checksum of the rest.
    withstands("sealed checkpoint", corpus.clone(), 6000, |bytes| {
        let body = bytes.get(28..).unwrap_or_default();
        let sealed = [&corpus[0][..24], &crc32fast::hash(body).to_le_bytes(), body].concat();
        restore(&sealed);
    });
}

/// Three spheres in a row, recorded often.
fn prepared() -> PreparedRig<1> {
    let text = r#"
        format = 1
        kind = "rig"
        name = "chain"
        [crystal]
        packing = "chain"
        diameter = "6.35 mm"
        layers = 3
        material = "440c"
        [[load]]
        kind = "force"
        layers = 1
        pulse = "square"
        peak = "1 kN"
        duration = "10 us"
        [run]
        window = "20 us"
        step = "0.2 us"
        [record]
        every = "2 us"
        contacts = true
    "#;
    match Setup::parse("fuzz.toml", text) {
        Ok(Setup::One(prepared)) => prepared,
        other => panic!("{other:?}"),
    }
}

/// A run that is taken up from any bytes either goes on to its end or says why not; its streams are cut where the bytes say.
#[test]
fn checkpoints_of_trials() {
    let (prepared, go) = (prepared(), Context::default());
    let folder = tempfile::tempdir().unwrap();
    let (begun, tried) = (folder.path().join("begun"), folder.path().join("tried"));
    let keeping = |resume| run::Keeping { resume, every: Duration::from_secs(3600) };
    let stop = Context::default();
    let asked = stop.clone();
    let context = stop.telling(move |progress| {
        if matches!(progress, Progress::Steps { done: 40.., .. }) {
            asked.stop();
        }
    });
    let (_, ending) = run::run(&prepared, &begun, keeping(false), &context).unwrap();
    assert!(matches!(ending, run::Ending::Interrupted { .. }), "{ending:?}");
    let whole = fs::read(begun.join("checkpoint")).unwrap();
    let opening = whole.iter().position(|&byte| byte == b'\n').unwrap() + 1;
    let restore = |bytes: &[u8]| {
        let _ = fs::remove_dir_all(&tried);
        fs::create_dir(&tried).unwrap();
        for entry in fs::read_dir(&begun).unwrap() {
            let entry = entry.unwrap();
            fs::copy(entry.path(), tried.join(entry.file_name())).unwrap();
        }
        fs::write(tried.join("checkpoint"), bytes).unwrap();
        match run::run(&prepared, &tried, keeping(true), &go) {
            Ok((summary, _)) => drop(summary.json()),
            Err(error) => drop((error.to_string(), error.help())),
        }
    };
    withstands("trial", vec![whole.clone()], 300, restore);
    withstands("sealed trial", vec![whole.clone()], 900, |bytes| {
        let body = bytes.get(opening + 4..).unwrap_or_default();
        restore(&[&whole[..opening], &crc32fast::hash(body).to_le_bytes(), body].concat());
    });
}

/// The states that `contact` evaluates are read by the program itself.
#[test]
fn states_of_a_contact() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("states.csv");
    let corpus = vec![
        b"# states\nd,v,dmax,Fmax\n1e-6,1,0,0\n1e-5,-1,2e-5,300\n-1e-6,0,0,0\n".to_vec(),
        b"Fmax,dmax,v,d,more\n1e308,1e308,1e308,1e308,x\n0,1e-300,-1e308,1e-5,\n".to_vec(),
    ];
    withstands("states", corpus, 150, |bytes| {
        fs::write(&path, bytes).unwrap();
        let mut command = assert_cmd::Command::cargo_bin("granulens").unwrap();
        let output = command.args(["contact", "--pair", "440c,brass", "--states"]).arg(&path).output().unwrap();
        let code = output.status.code();
        assert!(matches!(code, Some(0 | 2)), "{code:?}: {}", String::from_utf8_lossy(&output.stderr));
    });
}

/// Found by a longer run: two spheres as far from each other as whole numbers go, which their periods bring together again.
#[test]
fn spheres_gone_astray() {
    let (period, step) = (2_f64.powi(-5), 2_f64.powi(-23));
    let sphere = |z: f64| Sphere { centre: [0.0, z], radius: 3.175e-3, material: 0 };
    let sample = Sample { materials: vec![find("440c", &[]).unwrap()], spheres: vec![sphere(0.0), sphere(6.35e-3)] };
    let mut rig = Rig::new(sample, LawBook::named(LawKind::Hertz));
    rig.periods[0] = Some(period);
    // Powers of two: after a step both are some 10^31 whole periods away, one on each side.
    (rig.velocity[0], rig.velocity[1]) = ([2_f64.powi(123), 0.0], [-2_f64.powi(123), 0.0]);
    let _ = Simulation::new(rig, step).unwrap().advance(70, &Context::default());
}

/// Tables of numbers, from the bytes of a file: points are pairs of doubles.
#[test]
fn tabulated_curves() {
    let bytes =
        |points: &[(f64, f64)]| points.iter().flat_map(|p| [p.0.to_le_bytes(), p.1.to_le_bytes()].concat()).collect();
    let corpus: Vec<Vec<u8>> = vec![
        bytes(&[(0.0, 0.0), (1e-6, 10.0), (2e-6, 30.0), (5e-6, 100.0)]),
        bytes(&[(0.0, 0.0), (1.0, f64::NAN)]),
        bytes(&[(0.0, 0.0), (f64::MIN_POSITIVE, f64::MAX), (f64::MAX, f64::INFINITY)]),
    ];
    withstands("table", corpus, 4000, |bytes| {
        let number = |at: &[u8]| f64::from_le_bytes([at[0], at[1], at[2], at[3], at[4], at[5], at[6], at[7]]);
        let points: Vec<(f64, f64)> = bytes.chunks_exact(16).map(|pair| (number(pair), number(&pair[8..]))).collect();
        if let Ok(curve) = Curve::table(&points) {
            for &(time, _) in &points {
                let _ = (curve.value(time), curve.integral(time), curve.mean(time, 2.0 * time + 1.0));
            }
        }
        if let Ok(law) = Tabulated::new(&points) {
            use granulens::contact::{ForceLaw as _, History, NormalLaw as _};
            for &(overlap, _) in &points {
                let (force, history) = law.respond(overlap, 1.0, &History::new());
                let _ =
                    (law.stored(overlap, &history), law.force(0.5 * overlap, -1.0, &history), law.stiffness_max(force));
            }
        }
    });
}

/// The mutations differ, and are the same in every run.
#[test]
fn mutations_are_many_and_repeat() {
    let corpus = vec![b"[crystal]\nrows = 50\n".to_vec(), b"a,b,c\n1,2,3\n".to_vec()];
    let draw = || {
        let mut mutations = Mutations::new(&corpus, 7);
        (0..500).map(|_| mutations.next_input()).collect::<Vec<_>>()
    };
    let mut inputs = draw();
    assert_eq!(inputs, draw());
    inputs.sort();
    inputs.dedup();
    assert!(inputs.len() > 400, "{} of 500 differ", inputs.len());
    assert!(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/corpus").is_dir());
}

#[test]
fn bed_files_and_beds() {
    let corpus = files("designs", "toml", 20_000);
    withstands("bed", corpus, 400, |bytes| {
        if let Ok(text) = std::str::from_utf8(bytes)
            && let Err(error) = granulens::bed::BedFile::parse("designs/fuzz.toml", text)
        {
            let _ = (error.to_string(), format!("{:?}", miette::Report::new(error)));
        }
    });
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bed.csv");
    let bed = b"# width 9.0 d, sides walls\nkind,x_d,y_d,diameter_d\ngrain,1.5,0.5,1.0\nwall,0.25,-0.25,0.5\n".to_vec();
    withstands("settled bed", vec![bed], 400, |bytes| {
        fs::write(&path, bytes).unwrap();
        match granulens::bed::read(&path) {
            Ok(bed) => drop(granulens::bed::measure(&bed)),
            Err(error) => drop(error.to_string()),
        }
    });
}
