//! The program itself, killed while it writes.

use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use granulens::search::Rng;

use crate::{Desk, STUDY};

fn start(desk: &Desk, folder: &str) -> Child {
    Command::new(env!("CARGO_BIN_EXE_granulens"))
        .args(["study", "run", "study.toml", "--quiet", "--out", folder])
        .current_dir(desk.path("."))
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap()
}

fn size(path: &Path) -> u64 {
    std::fs::metadata(path).map_or(0, |file| file.len())
}

/// Twenty times: when the journal has grown by a random number of bytes, or has not grown at all, the process is killed, without
/// a chance to tidy up. What the last run leaves is what an undisturbed one does.
#[test]
fn a_study_killed_twenty_times_ends_as_if_it_had_not_been() {
    let desk = Desk::new(STUDY);
    assert!(start(&desk, "whole").wait().unwrap().success());
    let journal = desk.path("killed/journal.jsonl");
    let mut rng = Rng::new(7);
    let step = size(&desk.path("whole/journal.jsonl")) / 20;
    let mut killed = 0;
    while killed < 20 {
        let mut child = start(&desk, "killed");
        let until = size(&journal) + rng.below(step);
        while size(&journal) < until && child.try_wait().unwrap().is_none() {
            std::thread::sleep(Duration::from_micros(200));
        }
        if child.try_wait().unwrap().is_some() {
            break;
        }
        child.kill().unwrap();
        child.wait().unwrap();
        killed += 1;
    }
    assert!(killed >= 10, "it came to its end after {killed} kills");
    assert!(start(&desk, "killed").wait().unwrap().success());
    for name in ["journal.jsonl", "study.json", "best.csv"] {
        let of = |folder: &str| std::fs::read(desk.path(folder).join(name)).unwrap();
        assert!(of("whole") == of("killed"), "{name}");
    }
}
