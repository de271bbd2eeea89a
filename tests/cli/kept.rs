//! Nothing of a user's is lost: what may be replaced, what is written through, what is refused.

use super::Desk;

/// An output never takes the place of an input of the same command, by force neither.
#[test]
fn no_command_replaces_what_it_reads() {
    let desk = Desk::with_layout();
    desk.write("own.json", "{}");
    desk.run(&["run", "small.toml", "--quiet", "--out", "results"]).ok();
    let files = ["small.toml", "small.csv", "results/layout.csv"];
    let before = files.map(|name| desk.read(name));
    for force in [&[][..], &["--force"]] {
        let calls: [&[&str]; 7] = [
            &["design", "small.toml", "--out", "small.toml"],
            &["trace", "small.toml", "--out", "./small.toml"],
            &["check", "small.csv", "--design", "small.toml", "--out", "small.csv"],
            &["check", "small.csv", "--design", "small.toml", "--spheres", "small.toml"],
            &["compare", "small.toml", "small.csv", "--out", "small.csv"],
            &["export", "small.toml", "--xyz", "small.toml", "--window", "30 us"],
            &["run", "results/../small.toml", "--out", "small.toml"],
        ];
        for call in calls {
            let ran = desk.run(&[call, force].concat());
            assert_eq!((ran.code, ran.stdout.as_str()), (2, ""), "{call:?} {force:?}: {}", ran.stderr);
            assert_eq!(files.map(|name| desk.read(name)), before, "{call:?} {force:?}");
        }
    }
    // Neither does a folder that holds an input.
    desk.write("inside.toml", super::SMALL);
    let inside = desk.run(&["compare", "small.toml", "results/layout.csv", "--out", "results/layout.csv", "--force"]);
    assert!(inside.code == 2 && inside.stderr.contains("is read by this command"), "{}", inside.stderr);
    let trace = desk.run(&["trace", "small.toml", "--out", "one.svg", "--spots", "one.svg"]);
    assert!(trace.code == 2 && trace.stderr.contains("two outputs"), "{}", trace.stderr);
}

/// A second run replaces what the first wrote; not what was edited since, or made by hand, unless by force.
#[test]
fn only_what_nobody_changed_is_replaced() {
    let desk = Desk::with_layout();
    desk.write("states.csv", "d,v,dmax,Fmax\n1e-6,0,0,0\n");
    desk.write("study.toml", super::studies::STUDY);
    desk.run(&["study", "run", "study.toml", "--out", "s", "--quiet"]).ok();
    let check = ["check", "small.csv", "--design", "small.toml", "--quiet"];
    let calls: [(&str, Vec<&str>); 8] = [
        ("a.csv", vec!["design", "small.toml", "--quiet", "--out", "a.csv"]),
        ("a.svg", vec!["trace", "small.toml", "--quiet", "--out", "a.svg"]),
        ("a.json", [&check[..], &["--out", "a.json"]].concat()),
        ("b.csv", [&check[..], &["--spheres", "b.csv"]].concat()),
        ("c.csv", vec!["contact", "--pair", "440c,brass", "--states", "states.csv", "--quiet", "--out", "c.csv"]),
        ("b.json", vec!["materials", "--quiet", "--out", "b.json"]),
        ("d.csv", vec!["study", "export", "study.toml", "--out", "s", "--quiet", "--layout", "d.csv"]),
        ("e.xyz", vec!["export", "small.toml", "--quiet", "--window", "30 us", "--xyz", "e.xyz"]),
    ];
    for (file, call) in calls {
        desk.write(file, "mine");
        let refused = desk.run(&call);
        assert_eq!((refused.code, desk.read(file).as_str()), (2, "mine"), "{call:?}");
        assert!(refused.stderr.contains("--force"), "{call:?}: {}", refused.stderr);
        desk.run(&[&call[..], &["--force"]].concat()).ok();
        desk.run(&call).ok();
        let written = desk.read(file);
        assert_ne!(written, "mine");
        // One character more.
        let edited = written.clone() + " ";
        desk.write(file, &edited);
        assert_eq!((desk.run(&call).code, desk.read(file)), (2, edited), "{call:?}");
    }
}

/// Edits of a folder of results are the user's too.
#[test]
fn an_edited_folder_is_replaced_by_force_only() {
    let desk = Desk::new();
    desk.write("rig.toml", RIG);
    let calls: [(&[&str], &str, &[&str]); 2] = [
        (&["run", "small.toml", "--quiet", "--out", "out"], "out", &["layout.csv", "report.html", "notes.txt"]),
        (&["simulate", "rig.toml", "--quiet", "--out", "rig"], "rig", &["energies.csv", "trial.json"]),
    ];
    for (call, folder, files) in calls {
        desk.run(call).ok();
        desk.run(call).ok();
        for file in files {
            let path = format!("{folder}/{file}");
            let before = std::fs::read_to_string(desk.path(&path)).unwrap_or_default();
            desk.write(&path, format!("{before}\n"));
            let refused = desk.run(call);
            assert!(refused.code == 2 && refused.stderr.contains(file), "{call:?}: {}", refused.stderr);
            assert_eq!(desk.read(&path), format!("{before}\n"));
            desk.run(&[call, &["--force"]].concat()).ok();
        }
        desk.run(call).ok();
    }
}

pub const RIG: &str = "format = 1\nkind = \"rig\"\nname = \"chain\"\n[crystal]\npacking = \"chain\"\ndiameter = \"8 mm\"\nlayers = 5\n\
                   material = \"440c\"\n[[moving]]\nlayers = 1\nvelocity = \"2 m/s\"\n[run]\nwindow = \"20 us\"\n";

/// Data that do not reach standard output, or a file, are no success.
#[cfg(target_os = "linux")]
#[test]
fn a_full_device_is_told() {
    let desk = Desk::with_layout();
    desk.write("states.csv", "d,v,dmax,Fmax\n1e-6,0,0,0\n");
    let calls: [&[&str]; 8] = [
        &["materials"],
        &["design", "small.toml", "-q"],
        &["design", "small.toml", "-q", "--json"],
        &["trace", "small.toml", "-q", "--json"],
        &["compare", "small.toml", "-q", "--json"],
        &["contact", "--pair", "440c,440c", "--states", "states.csv"],
        &["speed", "--material", "440c"],
        &["--help"],
    ];
    for call in calls {
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_granulens"));
        let full = std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
        let ran = command.current_dir(desk.path(".")).args(call).stdout(full).output().unwrap();
        let said = String::from_utf8_lossy(&ran.stderr);
        assert_eq!(ran.status.code(), Some(2), "{call:?}: {said}");
        assert!(said.contains("standard output cannot be written: No space left on device"), "{call:?}: {said}");
    }
    let file = desk.run(&["design", "small.toml", "--out", "/dev/full"]);
    assert!(file.code == 2 && file.stderr.contains("/dev/full: cannot be written"), "{}", file.stderr);
}

/// Devices and pipes take what is written; links stay links.
#[cfg(unix)]
#[test]
fn devices_pipes_and_links_are_written_through() {
    use std::os::unix::fs::FileTypeExt as _;
    let desk = Desk::new();
    let layout = desk.run(&["design", "small.toml", "--quiet"]).ok().stdout;
    let pipe = desk.path("pipe");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let reader = std::thread::spawn({
        let pipe = pipe.clone();
        move || std::fs::read_to_string(pipe).unwrap()
    });
    desk.run(&["design", "small.toml", "--quiet", "--out", "pipe"]).ok();
    assert_eq!(reader.join().unwrap(), layout);
    assert!(std::fs::metadata(&pipe).unwrap().file_type().is_fifo());
    desk.run(&["design", "small.toml", "--quiet", "--out", "/dev/null"]).ok();
    assert!(std::fs::metadata("/dev/null").unwrap().file_type().is_char_device());
    let ran = desk.run(&["design", "small.toml", "--quiet", "--out", "/dev/stdout"]).ok();
    assert!(ran.stdout.starts_with(&layout), "and then the words");

    desk.write("real.csv", "");
    std::os::unix::fs::symlink("real.csv", desk.path("link.csv")).unwrap();
    desk.run(&["design", "small.toml", "--quiet", "--out", "link.csv"]).ok();
    assert!(std::fs::symlink_metadata(desk.path("link.csv")).unwrap().is_symlink());
    assert_eq!(desk.read("real.csv"), layout);
    desk.write("real.csv", "old\n");
    desk.run(&["design", "small.toml", "--quiet", "--out", "link.csv"]).ok();
    assert!(std::fs::symlink_metadata(desk.path("link.csv")).unwrap().is_symlink());
    assert_eq!(desk.read("real.csv"), layout, "who names a link means what it leads to");
    std::fs::create_dir(desk.path("far")).unwrap();
    std::os::unix::fs::symlink("far", desk.path("near")).unwrap();
    desk.run(&["run", "small.toml", "--quiet", "--out", "near"]).ok();
    assert!(std::fs::symlink_metadata(desk.path("near")).unwrap().is_symlink());
    assert!(desk.path("far/report.html").exists());
}

/// A byte order mark, with which some editors begin UTF-8, is no part of any file that is read.
#[test]
fn a_byte_order_mark_is_skipped_by_every_reader() {
    let desk = Desk::with_layout();
    let with_mark = |name: &str, text: &str| desk.write(name, format!("\u{feff}{text}"));
    let pulse = "[[load]]\nkind = \"force\"\nlayers = 1\npulse = \"table\"\nfile = \"pulse.csv\"\n[run]";
    with_mark("pulse.csv", "time_s,force_N\n0,0\n5e-6,1000\n20e-6,0\n");
    with_mark("rig.toml", &RIG.replace("[run]", pulse));
    with_mark("states.csv", "d,v,dmax,Fmax\n1e-5,1,0,0\n");
    with_mark("marked.toml", super::SMALL);
    with_mark("marked.csv", &desk.read("small.csv"));
    with_mark(
        "study.toml",
        &super::studies::STUDY.replace("small.toml", "marked.toml").replace("\"random\"", "\"marked.csv\""),
    );
    let bed = "format = 1\nkind = \"bed\"\nname = \"bed\"\n[bed]\nfile = \"settled.csv\"\n\
               [intruder]\nshape = \"disk\"\ndiameter = 2\nspeed = 0.5\n[run]\nwindow = 1\n";
    with_mark("bed.toml", bed);
    let rows: String = (0..12).map(|k| format!("grain,{},0.5,1\n", 0.5 + f64::from(k))).collect();
    with_mark("settled.csv", &format!("# width 12.0 d, sides periodic\nkind,x_d,y_d,diameter_d\n{rows}"));
    let calls: [&[&str]; 6] = [
        &["simulate", "rig.toml", "--quiet"],
        &["contact", "--pair", "440c,440c", "--states", "states.csv"],
        &["design", "marked.toml", "--quiet"],
        &["check", "marked.csv", "--design", "marked.toml", "--quiet"],
        &["study", "run", "study.toml", "--quiet"],
        &["impact", "bed.toml", "--quiet"],
    ];
    for call in calls {
        let ran = desk.run(call);
        assert_eq!(ran.code, 0, "{call:?}: {}", ran.stderr);
    }
}
