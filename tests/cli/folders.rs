//! Where output may go, what is left alone, and what stays of a run that is interrupted.

use super::{Desk, names};

#[test]
fn what_is_no_folder_of_results_is_left_alone() {
    let desk = Desk::with_layout();
    desk.write("file", "mine");
    std::fs::create_dir(desk.path("foreign")).unwrap();
    desk.write("foreign/thesis.tex", "mine");
    std::fs::create_dir(desk.path("empty")).unwrap();
    std::fs::create_dir(desk.path("extension")).unwrap();
    desk.write("extension/manifest.json", "{ \"name\": \"of another program\", \"version\": \"1\" }");
    let before = desk.names();
    let calls: [&[&str]; 9] = [
        &["run", "small.toml", "--out", "file"],
        &["run", "small.toml", "--out", "foreign"],
        &["run", "small.toml", "--out", "extension"],
        &["run", "small.toml", "--out", "."],
        &["run", "../small.toml", "--out", "../empty"],
        &["run", "small.toml", "--out", "file/below"],
        &["design", "small.toml", "--out", "foreign"],
        &["compare", "small.toml", "--quiet", "--out", "file/below.json"],
        &["check", "small.csv", "--design", "small.toml", "--spheres", "file/below.csv"],
    ];
    let heard = calls.map(|call| {
        let mut command = desk.command(call);
        if call[1].starts_with("..") {
            command.current_dir(desk.path("empty"));
        }
        let ran = super::Ran::of(command);
        assert_eq!(ran.code, 2, "{call:?}");
        assert_eq!(ran.stdout, "", "{call:?}: data only when the output is in place");
        format!("$ granulens {}\n{}\n", call.join(" "), ran.stderr)
    });
    insta::assert_snapshot!(heard.concat());
    assert_eq!(
        (desk.names(), desk.read("file"), names(&desk.path("foreign"))),
        (before, "mine".into(), vec!["thesis.tex".into()])
    );
    desk.run(&["run", "small.toml", "--quiet", "--out", "empty"]).ok();
    assert!(desk.path("empty/report.html").exists(), "an empty folder is nobody's");
}

#[test]
fn results_are_replaced_as_a_whole() {
    let desk = Desk::new();
    desk.run(&["run", "small.toml", "--quiet", "--out", "deep/er/results"]).ok();
    let first = desk.read("deep/er/results/numbers.csv");
    desk.run(&["run", "small.toml", "--quiet", "--window", "60 us", "--out", "deep/er/results"]).ok();
    assert_ne!(desk.read("deep/er/results/numbers.csv"), first);
    assert_eq!(names(&desk.path("deep/er")), ["results"]);
}

/// A run that fails before it ends leaves earlier results as they were.
#[cfg(unix)]
#[test]
fn a_folder_without_permission_is_refused_at_once() {
    use std::os::unix::fs::PermissionsExt as _;
    let desk = Desk::new();
    let locked = desk.path("locked");
    std::fs::create_dir(&locked).unwrap();
    let permit = |mode| std::fs::set_permissions(&locked, std::fs::Permissions::from_mode(mode)).unwrap();
    permit(0o555);
    // The superuser writes where he likes; then there is nothing to see here.
    if std::fs::write(desk.path("locked/probe"), "").is_err() {
        let ran = desk.run(&["run", "small.toml", "--out", "locked/results"]);
        assert_eq!((ran.code, ran.stdout.as_str()), (2, ""));
        assert!(ran.stderr.contains("locked/results: cannot be written: Permission denied"), "{}", ran.stderr);
    }
    permit(0o755);
}

#[cfg(unix)]
mod interrupted {
    use std::io::{BufRead as _, BufReader, Read as _};
    use std::process::{Child, Command, Stdio};
    use std::time::Duration;

    use super::super::{Desk, names};

    /// Starts the program, waits until it says `sign`, then a little longer, and presses Ctrl-C. Exit code and stderr.
    fn interrupted(desk: &Desk, arguments: &[&str], sign: Option<&str>) -> (Option<i32>, String, String) {
        let mut command = Command::new(env!("CARGO_BIN_EXE_granulens"));
        command.current_dir(desk.0.path()).args(arguments).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child: Child = command.spawn().unwrap();
        // Read at once: a pipe holds 64 KiB, and who writes more to one that nobody reads never comes to an end.
        let mut stdout = child.stdout.take().unwrap();
        let data = std::thread::spawn(move || {
            let mut text = String::new();
            stdout.read_to_string(&mut text).map(|_| text).unwrap()
        });
        let mut stderr = BufReader::new(child.stderr.take().unwrap());
        let mut said = String::new();
        while sign.is_some_and(|sign| !said.contains(sign)) && stderr.read_line(&mut said).unwrap() > 0 {}
        std::thread::sleep(Duration::from_millis(400));
        let kill = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
        assert!(kill.success(), "ended before it was interrupted: {said}");
        stderr.read_to_string(&mut said).unwrap();
        (child.wait().unwrap().code(), data.join().unwrap(), said)
    }

    /// Many short arrangements: some are finished after any time, and never all.
    fn many(desk: &Desk) {
        let longer = super::super::SMALL.replace("100 us", "400 us");
        desk.write("many.toml", longer.replace("seeds = 2", "seeds = 1000"));
    }

    #[test]
    fn run_keeps_the_numbers_of_what_is_finished() {
        let desk = Desk::new();
        many(&desk);
        std::fs::create_dir(desk.path("out.v2.interrupted")).unwrap();
        desk.write("out.v2.interrupted/mine", "");
        let (code, stdout, said) = interrupted(&desk, &["run", "many.toml", "--out", "out.v2"], Some("step: "));
        assert_eq!((code, stdout.as_str()), (Some(130), ""), "{said}");
        let last = said.lines().last().unwrap();
        assert!(last.starts_with("interrupted: ") && last.ends_with("are in out.v2.interrupted-2"), "{last}");
        assert_eq!(desk.names(), ["many.toml", "out.v2.interrupted", "out.v2.interrupted-2", "small.toml"]);
        assert_eq!(
            names(&desk.path("out.v2.interrupted-2")),
            ["manifest.json", "numbers.csv", "numbers.json", "outcome.json", "spheres.csv"]
        );
        let rows = desk.read("out.v2.interrupted-2/numbers.csv").lines().count() - 1;
        assert!(rows > 0 && last.contains(&format!("{rows} of 2005 arrangements are finished")), "{last}");
    }

    #[test]
    fn compare_shows_what_is_finished() {
        let desk = Desk::new();
        many(&desk);
        let (code, stdout, said) = interrupted(&desk, &["compare", "many.toml", "--json"], None);
        assert_eq!(code, Some(130), "{said}");
        let json: serde_json::Value = serde_json::from_str(&stdout).unwrap();
        assert!(!json["arrangements"].as_array().unwrap().is_empty());
        let error: serde_json::Value = serde_json::from_str(&said).unwrap();
        assert_eq!((&error["error"]["kind"], &error["error"]["exit_code"]), (&"interrupted".into(), &130.into()));
    }

    #[test]
    fn check_shows_what_is_computed() {
        let desk = Desk::with_layout();
        let call = ["check", "small.csv", "--design", "small.toml", "--window", "1 s", "--json"];
        let (code, stdout, said) = interrupted(&desk, &call, None);
        assert_eq!(code, Some(130), "{said}");
        let json: serde_json::Value = serde_json::from_str(&stdout).unwrap();
        assert_eq!(json["stop"]["guard"], "interrupted");
        assert!(json["steps"].as_u64().unwrap() > 0);
    }
}
