//! A study in shards: ask, evaluate, merge; as job arrays; which settings differ.

use crate::studies::STUDY;
use crate::{Desk, SMALL};

fn desk() -> Desk {
    let desk = Desk::new();
    desk.write("study.toml", STUDY);
    desk
}

const FILES: [&str; 2] = ["study.json", "best.csv"];

/// Without the time that it took nothing differs.
fn results(desk: &Desk, folder: &str) -> Vec<String> {
    FILES
        .iter()
        .map(|name| desk.read(&format!("{folder}/{name}")))
        .chain([desk.read(&format!("{folder}/journal.jsonl"))])
        .collect()
}

#[test]
fn ask_evaluate_and_merge_end_as_run_does() {
    let desk = desk();
    desk.run(&["study", "run", "study.toml", "--out", "whole"]).ok();
    let refused = desk.run(&["evaluate", "study.toml", "--shard", "1/2", "--out", "s"]);
    assert!(refused.code == 2 && refused.stderr.contains("granulens study ask begins one"), "{}", refused.stderr);
    let mut rounds = 0;
    loop {
        let asked = desk.run(&["study", "ask", "study.toml", "--out", "s"]);
        if asked.code == 0 {
            break;
        }
        assert!(asked.code == 4 && asked.stderr.contains("asked.jsonl"), "{}", asked.stderr);
        let waiting = desk.run(&["study", "merge", "study.toml", "--out", "s", "--json"]);
        assert_eq!(waiting.code, 4);
        for shard in ["2/2", "1/2"] {
            let ran = desk.run(&["evaluate", "study.toml", "--shard", shard, "--out", "s", "--json"]).ok().json();
            assert_eq!(ran["part"].as_u64(), ran["known"].as_u64().zip(ran["evaluated"].as_u64()).map(|(a, b)| a + b));
        }
        let merged = desk.run(&["study", "merge", "study.toml", "--out", "s", "--json"]).ok().json();
        assert_eq!(merged["asked"], merged["answered"]);
        rounds += 1;
    }
    assert!(rounds > 1);
    assert_eq!(results(&desk, "whole"), results(&desk, "s"));
    let known = desk.run(&["study", "run", "study.toml", "--out", "s"]).ok();
    assert!(known.stderr.contains("nothing was to be done"), "{}", known.stderr);
}

#[test]
fn layouts_of_ones_own_and_random_ones_are_asked_for() {
    let desk = desk();
    desk.run(&["study", "run", "study.toml", "--out", "whole"]).ok();
    let asked = desk.run(&["study", "ask", "study.toml", "--out", "s", "--random", "20", "--json"]).ok().json();
    assert_eq!((&asked["asked"], &asked["waiting"]), (&20.into(), &0.into()));
    let again = desk.run(&["study", "ask", "study.toml", "--out", "s", "--random", "20", "--json"]).ok();
    assert!(again.stdout.contains("\"asked\": 0"), "{}", again.stdout);
    desk.run(&["study", "ask", "study.toml", "whole/best.csv", "--out", "s"]).ok();
    for shard in ["1/3", "2/3", "3/3"] {
        desk.run(&["evaluate", "study.toml", "--shard", shard, "--out", "s"]).ok();
    }
    desk.run(&["study", "merge", "study.toml", "--out", "s"]).ok();
    let shown = desk.run(&["study", "show", "study.toml", "--out", "s", "--json"]).ok().json();
    let whole = desk.run(&["study", "show", "study.toml", "--out", "whole", "--json"]).ok().json();
    assert_eq!(shown["evaluations"], 21);
    assert!(shown["best"]["contrast"].as_f64() >= whole["best"]["contrast"].as_f64());
    // Another crystal's layout is none of this study's.
    desk.write("big.toml", SMALL.replace("rows = 12", "rows = 14"));
    desk.run(&["design", "big.toml", "--out", "big.csv"]).ok();
    assert_eq!(desk.run(&["study", "ask", "study.toml", "big.csv", "--out", "s"]).code, 2);
}

#[test]
fn why_says_which_setting_differs() {
    let desk = desk();
    desk.run(&["study", "run", "study.toml", "--out", "s"]).ok();
    let why = |desk: &Desk| desk.run(&["study", "show", "study.toml", "--out", "s", "--why"]).ok().stdout;
    assert!(why(&desk).contains("used: 40 at a step of"), "{}", why(&desk));
    desk.write("small.toml", SMALL.replace("16 kN", "15 kN"));
    let said = why(&desk);
    assert!(
        said.contains("not used: 40") && said.contains("design.impact.force: \"16 kN\" then, \"15 kN\" now"),
        "{said}"
    );
}

/// The scripts run with a cluster that is played here: each task in turn, the first of them killed at its begin.
#[cfg(unix)]
#[test]
fn job_arrays_end_as_run_does_though_a_task_is_lost() {
    use std::os::unix::fs::PermissionsExt as _;
    let desk = desk();
    // study.json says how the study was named, and job scripts name it from the root.
    let named = desk.path("study.toml").canonicalize().unwrap().display().to_string();
    desk.run(&["study", "run", &named, "--out", "whole"]).ok();
    let slurm = ["study", "slurm", "study.toml", "--shards", "3", "--cpus", "1", "--out", "s"];
    desk.run(&slurm).ok();
    // It is granulens's own, and written anew.
    desk.run(&slurm).ok();
    let array = desk.read("s/array.sh");
    assert!(array.contains("#SBATCH --array=1-3\n") && array.contains("--signal=B:TERM@60"), "{array}");
    desk.write(
        "sbatch",
        "#!/usr/bin/env bash\n\
         set -u\n\
         [ \"$1\" = --wait ] || exit 9\n\
         code=0\n\
         for task in 1 2 3; do\n\
           if [ \"$task\" = 1 ] && [ ! -e lost ]; then touch lost; code=137; continue; fi\n\
           SLURM_ARRAY_TASK_ID=$task SLURM_CPUS_PER_TASK=1 bash \"$2\" || code=$?\n\
         done\n\
         exit $code\n",
    );
    let path = desk.path("sbatch");
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o755)).unwrap();
    let folder = path.parent().unwrap().display().to_string();
    let ran = std::process::Command::new("bash")
        .arg("s/drive.sh")
        .current_dir(path.parent().unwrap())
        .env("PATH", format!("{folder}:{}", std::env::var("PATH").unwrap()))
        .env("GRANULENS", env!("CARGO_BIN_EXE_granulens"))
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&ran.stderr).into_owned();
    assert!(ran.status.success(), "{said}");
    assert!(said.contains("a task did not come to its end"), "{said}");
    assert_eq!(results(&desk, "whole")[..2], results(&desk, "s")[..2]);
    assert!(desk.path("lost").exists());
}
