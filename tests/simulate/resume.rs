//! Runs that are killed, interrupted and taken up.

use granulens::Context;
use granulens::dem::Integrator;
use granulens::dem::rig::Simulation;
use granulens::run::RunError;

use super::*;

/// A sheet that is struck by a bar, with friction and everything recorded.
const RIG: &str = r#"
[crystal]
packing = "hexagonal"
diameter = "6.35 mm"
layers = 8
x = ["0 D", "6 D"]
material = "brass-260"
[[pattern]]
kind = "mix"
materials = ["brass-260", "stainless-440c"]
fractions = [0.6, 0.4]
seed = 3
[sides]
x = ["wall", "free"]
z = ["free", "wall"]
[[flat]]
name = "bar"
at = "front"
mass = "50 g"
velocity = "10 m/s"
[friction]
coefficient = 0.2
spring = "mindlin"
[run]
window = "120 us"
[record]
every = "1 us"
quantities = ["position", "displacement", "velocity", "spin", "force", "maxima", "dissipated"]
contacts = true
frames = true
events = ["closes", "opens", "yields", "arrives", "force-peak", "speed-peak"]
arrivals = ["1 %", "1 % of first", "0.5 m/s", "20 um"]
[[region]]
name = "end"
layers = [7, 8]
"#;

fn prepared() -> PreparedRig<2> {
    sheet(&format!("{HEAD}{RIG}"))
}

const NEVER: Duration = Duration::from_secs(3600);

/// Contents of all files, by name, those of frames among them.
pub fn contents(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        if path.is_dir() {
            files.extend(contents(&path).into_iter().map(|(below, bytes)| (format!("{name}/{below}"), bytes)));
        } else {
            files.push((name, std::fs::read(&path).unwrap()));
        }
    }
    files.sort();
    files
}

#[track_caller]
pub fn same(a: &Path, b: &Path) {
    let (a, b) = (contents(a), contents(b));
    assert_eq!(a.iter().map(|f| &f.0).collect::<Vec<_>>(), b.iter().map(|f| &f.0).collect::<Vec<_>>());
    for (one, other) in a.iter().zip(&b) {
        assert!(one.1 == other.1, "{} differs", one.0);
    }
}

/// Places that are spread over the run without a pattern: the golden ratio's multiples.
fn places(count: u64, total: u64) -> impl Iterator<Item = u64> {
    (1..=count).map(move |k| (k as f64 * 0.618_033_988_749_894_9).fract()).map(move |x| (x * total as f64) as u64)
}

/// Ctrl-C at 20 places, each time gone on with: the files are those of a run that nobody disturbed.
#[test]
fn an_interrupted_run_goes_on_to_the_same_bytes() {
    let prepared = prepared();
    let whole = Ran::of(&prepared);
    let mut stops: Vec<u64> = places(20, prepared.plan.steps()).collect();
    stops.sort_unstable();
    let folder = tempfile::tempdir().unwrap();
    let mut resume = false;
    let mut interrupted = 0;
    for stop in stops.into_iter().chain([u64::MAX]) {
        let keeping = Keeping { resume, every: NEVER };
        let (summary, ending) =
            run::run(&prepared, folder.path(), keeping, &until(move |done, _| done >= stop)).unwrap();
        resume = true;
        match ending {
            Ending::Interrupted { time } => {
                assert!(!summary.finished && summary.time_s == time);
                interrupted += 1;
            }
            Ending::Complete => break,
            other => panic!("{other:?}"),
        }
    }
    // Places nearer together than the run looks at the request count once.
    assert!(interrupted >= 10, "{interrupted}");
    same(whole.folder.path(), folder.path());
}

/// A kill leaves the last checkpoint and longer files, the last line perhaps half written.
#[test]
fn a_killed_run_goes_on_to_the_same_bytes() {
    let prepared = prepared();
    let whole = Ran::of(&prepared);
    for stop in places(6, prepared.plan.steps()) {
        let killed = tempfile::tempdir().unwrap();
        let copy = tempfile::tempdir().unwrap();
        let keeping = Keeping { resume: false, every: NEVER };
        let [from, to] = [&killed, &copy].map(|folder| folder.path().to_owned());
        let killing = Context::default().telling(move |progress| {
            let there = matches!(*progress, Progress::Steps { done, .. } if done >= stop);
            if there && std::fs::read_dir(&to).unwrap().next().is_none() {
                for (name, mut bytes) in contents(&from) {
                    // Frames are files of their own: those after the checkpoint are written again.
                    if name.ends_with(".csv") && !name.contains('/') {
                        // More than the rest of the run will write over.
                        bytes.extend(b"0.1,2,3,4\n".repeat(200_000));
                        bytes.extend(b"0.1,2,half a li");
                    }
                    let place = to.join(name);
                    std::fs::create_dir_all(place.parent().unwrap()).unwrap();
                    std::fs::write(place, bytes).unwrap();
                }
            }
        });
        run::run(&prepared, killed.path(), keeping, &killing).unwrap();
        // At the very end there is nothing left to copy.
        if !copy.path().join("checkpoint").exists() {
            continue;
        }
        let keeping = Keeping { resume: true, every: NEVER };
        run::run(&prepared, copy.path(), keeping, &Context::default()).unwrap();
        same(whole.folder.path(), copy.path());
    }
}

/// A folder with a run that was interrupted half way.
fn half_way() -> (PreparedRig<2>, tempfile::TempDir) {
    let prepared = prepared();
    let folder = tempfile::tempdir().unwrap();
    let keeping = Keeping { resume: false, every: NEVER };
    let half = prepared.plan.steps() / 2;
    let (_, ending) = run::run(&prepared, folder.path(), keeping, &until(move |done, _| done >= half)).unwrap();
    assert!(matches!(ending, Ending::Interrupted { .. }));
    (prepared, folder)
}

#[track_caller]
fn refused(prepared: &PreparedRig<2>, folder: &Path, resume: bool) -> RunError {
    let keeping = Keeping { resume, every: NEVER };
    run::run(prepared, folder, keeping, &Context::default()).map(|_| ()).unwrap_err()
}

#[test]
fn a_damaged_checkpoint_is_refused_with_the_reason() {
    let (prepared, folder) = half_way();
    let path = folder.path().join("checkpoint");
    let bytes = std::fs::read(&path).unwrap();
    for at in [40, bytes.len() / 2, bytes.len() - 1] {
        let mut damaged = bytes.clone();
        damaged[at] ^= 16;
        std::fs::write(&path, damaged).unwrap();
        assert!(refused(&prepared, folder.path(), true).to_string().contains("damaged"), "byte {at}");
    }
    std::fs::write(&path, &bytes[..bytes.len() - 7]).unwrap();
    assert!(refused(&prepared, folder.path(), true).to_string().contains("damaged"));
    let later = String::from_utf8_lossy(&bytes[..28]).replace('4', "5").into_bytes();
    std::fs::write(&path, [&later, &bytes[28..]].concat()).unwrap();
    assert!(refused(&prepared, folder.path(), true).to_string().contains("another version"));
    std::fs::write(&path, "what is this?").unwrap();
    assert!(refused(&prepared, folder.path(), true).to_string().contains("no checkpoint"));

    // The right bytes, but a record that lost its end.
    std::fs::write(&path, &bytes).unwrap();
    std::fs::write(folder.path().join("energies.csv"), "time_s\n").unwrap();
    assert!(refused(&prepared, folder.path(), true).to_string().contains("shorter"));
}

#[test]
fn another_rig_does_not_go_on_with_a_run() {
    let (_, folder) = half_way();
    let other = sheet(&format!("{HEAD}{}", RIG.replace("10 m/s", "11 m/s")));
    let error = refused(&other, folder.path(), true);
    assert!(error.to_string().contains("changed"), "{error}");
}

/// Another seed is another rig; it is told apart before anything else.
#[test]
fn another_seed_does_not_go_on_with_a_run() {
    let (prepared, folder) = half_way();
    assert_eq!(prepared.seeds, [3]);
    let file = tempfile::tempdir().unwrap();
    let path = file.path().join("rig.toml");
    std::fs::write(&path, format!("{HEAD}{RIG}")).unwrap();
    let Ok(Setup::Two(other)) = Setup::read_seeded(&path, Some(4)) else { panic!() };
    assert_eq!(other.seeds, [4]);
    assert_ne!(prepared.rig.sample, other.rig.sample);
    let error = refused(&other, folder.path(), true).to_string();
    assert!(error.contains("other seeds (3); give the same --seed"), "{error}");
    // The file's own seed, given from outside, is the file's rig.
    let Ok(Setup::Two(same)) = Setup::read_seeded(&path, Some(3)) else { panic!() };
    assert_eq!(same.rig.sample, prepared.rig.sample);
}

#[test]
fn what_stands_in_the_folder_is_not_lost() {
    let (prepared, folder) = half_way();
    assert!(matches!(refused(&prepared, folder.path(), false), RunError::Unfinished(_)));
    let foreign = tempfile::tempdir().unwrap();
    std::fs::write(foreign.path().join("thesis.txt"), "mine").unwrap();
    assert!(matches!(refused(&prepared, foreign.path(), false), RunError::Foreign(_)));
    assert!(matches!(refused(&prepared, foreign.path(), true), RunError::Nothing(_)));
    // A file of the same name by somebody else.
    std::fs::write(foreign.path().join("trial.json"), "{\"verdict\": \"guilty\"}").unwrap();
    assert!(matches!(refused(&prepared, foreign.path(), false), RunError::Foreign(_)));
    let ran = Ran::of(&prepared);
    assert!(matches!(refused(&prepared, ran.folder.path(), true), RunError::Finished(_)));
    // A finished one is replaced, and what else lies there stays.
    std::fs::write(ran.folder.path().join("measured.csv"), "mine").unwrap();
    let keeping = Keeping { resume: false, every: NEVER };
    run::run(&prepared, ran.folder.path(), keeping, &Context::default()).unwrap();
    assert!(ran.folder.path().join("measured.csv").exists());
}

/// A guard ends the run, keeps what was computed and says what, where and when.
#[test]
fn a_guard_keeps_what_was_computed() {
    let stopped = |old: &str, new: &str| {
        assert!(RIG.contains(old));
        let ran = Ran::of(&sheet(&format!("{HEAD}{}", RIG.replace(old, new))));
        let Ending::Stopped(_) = ran.ending else { panic!("{:?}", ran.ending) };
        assert!(ran.summary.finished && ran.summary.time_s > 0.0 && ran.summary.time_s < 120e-6);
        assert!(ran.folder.path().join("spheres-final.csv").exists());
        assert!(!ran.folder.path().join("checkpoint").exists());
        ran.summary.stop.unwrap()
    };
    let words = stopped("velocity = \"10 m/s\"", "velocity = \"1000 m/s\"");
    assert!(words.contains("overlap by"), "{words}");
    // Bodies are called what the file's author calls them.
    assert!(words.starts_with("flat bar and sphere ") && words.contains("(layer 1, column "), "{words}");
    let words = stopped("window = \"120 us\"", "window = \"120 us\"\nleave = \"0.05 D\"");
    assert!(words.contains("leaves the domain"), "{words}");
    // Stable at rest, not under load.
    let words = stopped("window = \"120 us\"", "window = \"120 us\"\nstep = \"4 us\"");
    assert!(words.contains("unstable") || words.contains("overlap") || words.contains("ledger"), "{words}");
}

/// A rig file chooses its scheme: it stands in the summary, the run is that of the library by it, and one that was interrupted goes on to the same bits.
#[test]
fn a_rig_is_run_by_the_scheme_that_it_asks_for() {
    let [verlet, adams] = ["verlet", "adams"].map(|scheme| {
        let text = RIG.replace("[run]\n", &format!("[run]\nintegrator = \"{scheme}\"\n"));
        assert!(text.contains(scheme));
        sheet(&format!("{HEAD}{text}"))
    });
    let [by_verlet, by_adams] = [&verlet, &adams].map(Ran::of);
    assert_eq!(by_adams.summary.method.integrator, "adams");
    assert_eq!(by_verlet.summary.method.integrator, "verlet");
    let plain = Ran::of(&sheet(&format!("{HEAD}{RIG}")));
    let ends = |ran: &Ran| std::fs::read(ran.folder.path().join("spheres-final.csv")).unwrap();
    assert!(ends(&plain) == ends(&by_verlet) && ends(&by_verlet) != ends(&by_adams));

    let mut simulation = Simulation::by(Integrator::Adams, adams.rig.clone(), adams.plan.step).unwrap();
    simulation = simulation.recording(adams.record.arrivals.clone());
    simulation.advance(adams.plan.steps(), &Context::default()).unwrap();
    let speeds = by_adams.spheres("max_speed_m_s");
    for (i, speed) in speeds.iter().enumerate() {
        assert_eq!(*speed, simulation.greatest_speed()[i], "{i}");
    }

    let folder = tempfile::tempdir().unwrap();
    let half = adams.plan.steps() / 2;
    let keeping = |resume| Keeping { resume, every: NEVER };
    let (_, ending) = run::run(&adams, folder.path(), keeping(false), &until(move |done, _| done >= half)).unwrap();
    assert!(matches!(ending, Ending::Interrupted { .. }), "{ending:?}");
    // The other scheme's file is another file.
    assert!(matches!(refused(&verlet, folder.path(), true), RunError::Checkpoint { .. }));
    run::run(&adams, folder.path(), keeping(true), &Context::default()).unwrap();
    assert!(std::fs::read(folder.path().join("spheres-final.csv")).unwrap() == ends(&by_adams));
}

/// What 0.1 and 0.2 call `run.squeezed` is `run.precompressed`: by either name a sphere that is too large for its place is let in, and without
/// it is not.
#[test]
fn keys_of_older_files_are_read() {
    let rig = |key: &str| {
        let text = format!(
            "{HEAD}[crystal]\npacking = \"chain\"\ndiameter = \"6.35 mm\"\nlayers = 4\nmaterial = \"440c\"\n[[edit]]\ndiameter = \"6.352 mm\"\nlayers = [2, 2]\n\
             [law]\nkind = \"hertz\"\n[run]\nwindow = \"1 us\"\n{key}"
        );
        let prepared = chain(&text);
        Simulation::new(prepared.rig.clone(), prepared.plan.step).map(|_| prepared.rig)
    };
    let [now, before] = ["precompressed = true\n", "squeezed = true\n"].map(|key| rig(key).unwrap());
    assert!(now.precompressed && before.precompressed);
    assert!(rig("").is_err());
}

/// Ten times the window, ten times the samples: the streams grow, what is held does not. The high-water mark of the process
/// (Linux) after the long run is compared with that after the short one; 3 MB are allowed for the allocator, where the
/// records themselves, kept in memory, would take over 40 MB.
#[cfg(target_os = "linux")]
#[test]
fn memory_does_not_grow_with_time() {
    let high_water = || -> u64 {
        let status = std::fs::read_to_string("/proc/self/status").unwrap();
        let line = status.lines().find(|line| line.starts_with("VmHWM")).unwrap();
        line.split_whitespace().nth(1).unwrap().parse().unwrap()
    };
    // A process of its own: tests run side by side in this one.
    if std::env::var_os("GRANULENS_MEMORY").is_none() {
        let mut child = std::process::Command::new(std::env::current_exe().unwrap());
        child.args(["--exact", "resume::memory_does_not_grow_with_time", "--test-threads", "1"]);
        let output = child.env("GRANULENS_MEMORY", "1").output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stdout));
        return;
    }
    let run = |window: &str| {
        let text = RIG.replace("120 us", window).replace("every = \"1 us\"", "every = \"0.2 us\"");
        let ran = Ran::of(&sheet(&format!("{HEAD}{text}")));
        contents(ran.folder.path()).iter().map(|(_, bytes)| bytes.len() as u64).sum::<u64>() / 1024
    };
    run("100 us");
    let before = high_water();
    let written = run("1000 us");
    // `contents` itself holds all files once.
    let grown = high_water() - before;
    assert!(written > 40_000, "{written} kB");
    assert!(grown < written + 3_000, "{grown} kB while {written} kB were written");
}
