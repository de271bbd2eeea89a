//! Usage errors and wrong design files: what a person reads, and what a script gets. `tests/design_errors.rs` has a table of
//! wrong design files; here it is how the program shows them.

use super::{Desk, keys};

const KEYS: [&str; 7] = ["kind", "exit_code", "file", "line", "key", "message", "help"];

#[test]
fn usage_errors_are_said_in_words() {
    let desk = Desk::new();
    let calls: [&[&str]; 9] = [
        &["frobnicate"],
        &["check", "small.csv"],
        &["run", "small.toml", "--stp", "1e-7 s"],
        &["check", "small.csv", "--design", "small.toml", "--integrator", "euler"],
        &["contact", "--pair", "440c"],
        &["contact", "--pair", "440c,bras"],
        &["contact", "--pair", "440c,brass", "--diameter", "3"],
        &["contact", "--pair", "440c,brass", "--law", "herz"],
        &["speed", "--material", "440c", "--diameter", "-6 mm"],
    ];
    let heard = calls.map(|call| {
        let ran = desk.run(call);
        assert_eq!((ran.code, ran.stdout.as_str()), (2, ""), "{call:?}");
        let json = desk.run(&[call, &["--json"]].concat());
        let error = json.json_error();
        assert_eq!((json.code, json.stdout.as_str(), keys(&error)), (2, "", KEYS.to_vec()), "{call:?}");
        assert_eq!((&error["kind"], &error["line"]), (&"input".into(), &serde_json::Value::Null), "{call:?}");
        assert_eq!(json.stderr.lines().count(), 1, "one object in one line");
        format!("$ granulens {}\n{}\n", call.join(" "), ran.stderr)
    });
    insta::assert_snapshot!(heard.concat());
}

#[test]
fn without_a_subcommand_there_is_help() {
    let desk = Desk::new();
    let bare = desk.run(&[]);
    assert_eq!(bare.code, 2);
    assert!(bare.stderr.contains("Usage: granulens"), "{}", bare.stderr);
    assert_eq!(desk.run(&["--json"]).json_error()["kind"], "input");
    let help = desk.run(&["--help"]).ok();
    for words in [
        "run",
        "design",
        "check",
        "compare",
        "materials",
        "contact",
        "speed",
        "surface",
        "Exit codes:",
        "130  interrupted",
    ] {
        assert!(help.stdout.contains(words), "{words}");
    }
    let run = desk.run(&["run", "--help"]).ok();
    assert!(
        run.stdout.contains("appears when it is complete") && run.stdout.contains("--window <TIME>"),
        "{}",
        run.stdout
    );
    assert!(desk.run(&["--version"]).ok().stdout.starts_with("granulens "));
}

#[test]
fn design_errors_are_drawn_and_are_json() {
    let desk = Desk::new();
    desk.design_with("unit.toml", "16 kN", "16");
    desk.design_with("name.toml", "\"brass-260\"", "\"bras-260\"");
    desk.design_with("key.toml", "half_width", "halfwidth");
    desk.write("cut.toml", &super::SMALL[..190]);
    desk.write("bytes.toml", [b'a', 0xff, b'\n']);
    let heard = ["unit.toml", "name.toml", "key.toml", "cut.toml", "bytes.toml", "smal.toml", "."].map(|name| {
        let ran = desk.run(&["run", name]);
        assert_eq!((ran.code, ran.stdout.as_str()), (2, ""), "{name}");
        let json = desk.run(&["run", name, "--json"]).json_error();
        assert_eq!(keys(&json), KEYS, "{name}");
        assert_eq!(json["file"], name);
        let at = json["line"].as_u64().map_or(String::new(), |line| format!("{line}:"));
        assert!(ran.stderr.contains(&format!("{name}:{at} ")), "{name}: {}", ran.stderr);
        assert!(json["message"].as_str().unwrap().starts_with(&format!("{name}:{at} ")), "{json}");
        assert!(json["help"].as_str().is_some_and(|help| !help.is_empty()), "{name}");
        ran.stderr + "\n"
    });
    insta::assert_snapshot!(heard.concat());
    let unit = desk.run(&["design", "unit.toml", "--json"]).json_error();
    assert_eq!((&unit["line"], &unit["key"]), (&12.into(), &"impact.force".into()));
    assert!(!desk.path("reports").exists());
}

/// Long lines stay whole where no terminal wraps them, so that `grep FILE:LINE` finds them.
#[test]
fn quiet_does_not_silence_errors() {
    let desk = Desk::new();
    let name = format!("{}.toml", "a-rather-long-name".repeat(6));
    desk.design_with(&name, "16 kN", "16");
    let quiet = desk.run(&["run", &name, "--quiet"]);
    assert_eq!((quiet.code, quiet.stdout.as_str()), (2, ""));
    assert!(quiet.stderr.contains(&format!("{name}:12: impact.force = \"16\" has no unit.")), "{}", quiet.stderr);
}

#[cfg(unix)]
#[test]
fn names_that_are_no_text_are_names_all_the_same() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt as _;
    let desk = Desk::new();
    let name = OsStr::from_bytes(b"\xff.toml");
    std::fs::write(desk.0.path().join(name), super::SMALL).unwrap();
    desk.command(&["design", "--quiet"]).arg(name).assert().code(0);
    desk.command(&["design", "--bad"]).arg(name).assert().code(2);
    desk.command(&["run", "--json", "--window", "60 us", "--quiet"]).arg(name).assert().code(0);
}
