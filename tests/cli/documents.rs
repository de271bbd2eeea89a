//! What README and docs say can be typed is typed: every command in them is run, those that take long as a dry run, and the numbers
//! that they promise are compared with what is computed.

use std::path::Path;

use granulens::search::Rng;

use super::network::SQUARES;
use super::{Desk, names, shipped};

/// Commands that take more than some seconds; their files are read and checked, and their cost is told.
const LONG: [&str; 10] = [
    "run designs/gallery",
    "run designs/space",
    "compare designs/space",
    "study run",
    "reproduce",
    "impact",
    "simulate designs/drop",
    "simulate LONG",
    "tolerance",
    "sensitivity",
];

/// The page of explore serves until it is stopped: tests/browser opens it. Frames of a bed are those of a run that is only counted here, as
/// are the pieces that spares follow from.
const ELSEWHERE: [&str; 3] =
    ["explore", "export reports/NAME", "build lens.csv --design designs/quickstart.toml --out shop --yield lens-made"];

/// The files of the tutorial, and what its long commands answered when they were last run, by the script beside it.
const TUTORIAL: &str = "docs/tutorial";

/// The commands of a page: lines of its code that begin with the program's name, in words as a shell takes them.
fn commands(page: &str) -> Vec<Vec<String>> {
    let mut fenced = false;
    let mut found = Vec::new();
    for line in page.lines() {
        if line.trim_start().starts_with("```") {
            fenced = !fenced;
        }
        let is_code = fenced || line.starts_with("    ");
        if let Some(rest) = line.trim_start().strip_prefix("granulens ").filter(|_| is_code) {
            found.push(words(rest));
        }
    }
    found
}

/// Words of a command line; a comment ends it.
fn words(line: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let mut quoted = false;
    for c in line.chars() {
        match c {
            '"' => quoted = !quoted,
            '#' if !quoted && words.last().is_some_and(String::is_empty) => break,
            ' ' if !quoted => {
                if words.last().is_some_and(|word| !word.is_empty()) {
                    words.push(String::new());
                }
            }
            c => words.last_mut().unwrap().push(c),
        }
    }
    words.retain(|word| !word.is_empty());
    words
}

/// The repository's own files, and those that the pages take for a user's.
fn desk() -> Desk {
    let desk = Desk::new();
    for folder in ["designs", "designs/gallery", "designs/space", "designs/tolerances", "studies", TUTORIAL] {
        std::fs::create_dir_all(desk.path(folder)).unwrap();
        for name in names(Path::new(&shipped(folder))) {
            let (from, to) = (shipped(&format!("{folder}/{name}")), desk.path(&format!("{folder}/{name}")));
            if Path::new(&from).is_file() {
                std::fs::copy(from, to).unwrap();
            }
        }
    }
    let copy = |from: &str, to: &str| std::fs::copy(desk.path(from), desk.path(to)).unwrap();
    for name in names(Path::new(&shipped(TUTORIAL))) {
        copy(&format!("{TUTORIAL}/{name}"), &name);
    }
    copy("designs/quickstart.toml", "DESIGN.toml");
    copy("designs/drop-tower-hcp.toml", "LONG.toml");
    desk.run(&["design", "DESIGN.toml", "--out", "LAYOUT.csv"]).ok();
    copy("LAYOUT.csv", "lens.csv");
    let lens = desk.read("lens.csv");
    desk.write("edited.csv", lens.replacen("brass-260", "stainless-440c", 3));
    copy("edited.csv", "best.csv");
    copy("DESIGN.toml", "my-lens.toml");
    copy("lens.csv", "my-lens.csv");
    desk.write("STUDY.toml", super::studies::STUDY);
    // Two studies that were run.
    for (name, seed) in [("a", "1"), ("b", "2")] {
        desk.write("study.toml", super::studies::STUDY);
        desk.run(&["study", "run", "study.toml", "--seed", seed, "--out", &format!("reports/{name}")]).ok();
    }
    // Contacts and places of another program, and the same after a shear.
    desk.write("contacts.csv", SQUARES);
    let columns = "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ENTRIES\n2\nITEM: BOX BOUNDS pp pp pp\n0 3\n0 3\n0 1\n\
                   ITEM: ENTRIES c_pair[1] c_pair[2] c_force[1] c_force[2]\n1 2 3.0 0.5\n2 3 2.0 0.1\n";
    desk.write("contacts.dump", columns);
    let mut rng = Rng::new(1);
    let places: Vec<[f64; 2]> = (0..30).map(|_| [10.0 * rng.unit(), 10.0 * rng.unit()]).collect();
    let table = |shear: f64| {
        let rows: String =
            places.iter().enumerate().map(|(k, [x, z])| format!("{k},{},{z}\n", x + shear * z)).collect();
        format!("id,x,z\n{rows}")
    };
    desk.write("before.csv", table(0.0));
    desk.write("after.csv", table(0.05));
    desk.write("states.csv", "d,v,dmax,Fmax\n1e-6,0,0,0\n");
    let curve: String = (1..40).map(|k| format!("{}e-6,{}\n", k, 2e9 * (f64::from(k) * 1e-6).powf(1.5))).collect();
    desk.write("curve.csv", format!("overlap_m,force_N\n{curve}"));
    // An instrument that saw the bar of the sliding rig as it is predicted.
    desk.run(&["simulate", "designs/sliding-rig.toml", "--out", "slid", "--quiet"]).ok();
    let flats = desk.read("slid/flats.csv");
    let heads: Vec<&str> = flats.lines().next().unwrap().split(',').collect();
    let force = heads.iter().position(|head| *head == "bar_force_N").unwrap();
    let rows =
        flats.lines().map(|line| line.split(',').collect::<Vec<_>>()).map(|row| format!("{},{}\n", row[0], row[force]));
    desk.write("data.csv", rows.collect::<String>());
    let mut batch = "id,material,diameter_mm\n".to_owned();
    for (count, material) in [(300, "brass-260"), (1700, "stainless-440c")] {
        batch.extend((0..count).map(|k| format!("{material}-{k},{material},{:.5}\n", 6.35 + 1e-5 * f64::from(k % 37))));
    }
    desk.write("batch.csv", batch);
    desk.write("my.toml", "format = 1\n[prices]\nbrass-260 = 0.35\nstainless-440c = 0.12\n");
    desk
}

#[test]
fn commands_are_found_as_a_shell_reads_them() {
    let page = "text granulens run\n```sh\ngranulens a --b \"c d\"   # e\n```\n    granulens f#g\ngranulens h\n";
    assert_eq!(commands(page), [vec!["a", "--b", "c d"], vec!["f#g"]]);
}

/// Every command of every page: those that take seconds are run and end with 0, the others are read, checked and counted.
#[test]
fn the_commands_of_the_pages_do_what_they_say() {
    let mut pages = vec!["README.md".to_owned()];
    pages.extend(
        names(Path::new(&shipped("docs")))
            .into_iter()
            .filter(|name| name.ends_with(".md"))
            .map(|name| format!("docs/{name}")),
    );
    let desk = desk();
    let (mut run, mut wrong) = (0, Vec::new());
    for page in pages {
        for mut command in commands(&std::fs::read_to_string(shipped(&page)).unwrap()) {
            let line = command.join(" ");
            if ELSEWHERE.iter().any(|elsewhere| line.starts_with(elsewhere)) {
                continue;
            }
            if LONG.iter().any(|long| line.starts_with(long)) || line.contains("--gate") {
                command.push("--dry-run".to_owned());
            }
            // What pages make twice is theirs.
            command.extend(["--force", "--quiet"].map(str::to_owned));
            let ran = desk.run(&command.iter().map(String::as_str).collect::<Vec<_>>());
            run += 1;
            // What a search asks for next is not there yet.
            let asks = line.starts_with("study ask") && ran.code == 4;
            if ran.code != 0 && !asks {
                wrong.push(format!(
                    "{page}: granulens {line}: {} {}",
                    ran.code,
                    ran.stderr.lines().take(3).collect::<Vec<_>>().join(" ")
                ));
            }
        }
    }
    assert!(run > 60, "{run}");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Text in one line, without emphasis.
fn flat(text: &str) -> String {
    text.replace("**", "").split_whitespace().collect::<Vec<_>>().join(" ")
}

/// README's table is what its first command prints, arrangement by arrangement, and the guide to how well ledgers close holds.
#[test]
fn the_table_of_the_readme_is_the_one_that_is_printed() {
    let readme = std::fs::read_to_string(shipped("README.md")).unwrap();
    let desk = desk();
    let ran = desk.run(&["run", "designs/quickstart.toml", "--quiet", "--out", "quick"]).ok();
    let outcome = desk.json("quick/outcome.json");
    let printed: Vec<Vec<&str>> = ran.stdout.lines().map(|line| line.split_whitespace().collect()).collect();
    let rows: Vec<&str> = readme.lines().filter(|line| line.starts_with("| ")).collect();
    let rows = &rows[1..8];
    let arrangements = outcome["arrangements"].as_array().unwrap();
    assert!(rows[0].contains("lens") && arrangements.len() > rows.len(), "{rows:?}");
    for row in rows {
        let cells: Vec<String> = row.trim_matches('|').split(" | ").map(|cell| flat(cell).trim().to_owned()).collect();
        // What stands behind the name in one printed line, which holds one column more.
        let (last, before) = cells[1..].split_last().unwrap();
        let found = printed
            .iter()
            .any(|line| line.windows(before.len()).any(|part| part == before) && line.last() == Some(&last.as_str()));
        assert!(found, "{row} is not in:\n{}", ran.stdout);
    }
}

/// Sentences with numbers that are computed from files of the repository, as `check` computes them: the text, how it is checked, and
/// what stands for `{C}`, `{G}` and `{Q}` in it, with so many digits.
const PROMISED: [(&str, &str, &[&str], [usize; 3]); 5] = [
    (
        "README.md",
        "two materials with C {C}, G {G} and Q {Q} (at a step of 5·10⁻⁸ s)",
        &["studies/two-materials-5000-best.csv", "--design", "designs/quickstart.toml", "--step", "5e-8 s"],
        [2, 2, 2],
    ),
    (
        "README.md",
        "and four with {C}, {G} and {Q};",
        &["studies/four-materials-5000-best.csv", "--design", "designs/quickstart.toml", "--step", "5e-8 s"],
        [2, 2, 3],
    ),
    (
        "README.md",
        "takes the published lens from C {C}, G {G}, Q {Q} to",
        &["designs/thesis-lens.csv", "--design", "designs/thesis-lens.toml"],
        [2, 2, 2],
    ),
    (
        "README.md",
        "to {C}, {G}, {Q}, and 0.3 to",
        &["designs/thesis-lens.csv", "--design", "friction-0.1.toml"],
        [2, 2, 2],
    ),
    (
        "README.md",
        "and 0.3 to {C}, {G}, {Q}.",
        &["designs/thesis-lens.csv", "--design", "friction-0.3.toml"],
        [2, 2, 2],
    ),
];

#[test]
fn promised_numbers_are_computed_ones() {
    let desk = desk();
    let thesis = desk.read("designs/thesis-lens.toml");
    for mu in ["0.1", "0.3"] {
        desk.write(&format!("friction-{mu}.toml"), thesis.replace("[crystal]", &format!("[crystal]\nfriction = {mu}")));
    }
    for (page, sentence, check, digits) in PROMISED {
        let checked = desk.run(&[&["check"], check, &["--json"]].concat()).ok().json();
        let mut said = sentence.to_owned();
        for ((mark, key), digits) in
            [("{C}", "contrast"), ("{G}", "focal_gain"), ("{Q}", "protection")].into_iter().zip(digits)
        {
            said = said.replace(mark, &format!("{:.digits$}", checked[key].as_f64().unwrap()));
        }
        let text = flat(&std::fs::read_to_string(shipped(page)).unwrap());
        assert!(text.contains(&said), "{page} does not say: {said}");
    }
}

/// Commands of a page with the lines of their answers that it shows: blocks of `console`.
fn transcripts(page: &str) -> Vec<(String, Vec<String>)> {
    let mut shown: Vec<(String, Vec<String>)> = Vec::new();
    let mut inside = false;
    for line in page.lines() {
        match line {
            "```console" => inside = true,
            "```" => inside = false,
            _ if !inside => {}
            line => match (line.strip_prefix("$ granulens "), shown.last_mut()) {
                (Some(command), _) => shown.push((command.to_owned(), Vec::new())),
                (None, Some((_, lines))) => lines.push(line.trim_end().to_owned()),
                (None, None) => panic!("an answer without a command: {line}"),
            },
        }
    }
    shown
}

/// Every line that the tutorial shows as an answer is one; those of commands that take a minute are in the stored answers, and the files that
/// it shows are the ones that are there.
#[test]
fn the_tutorial_shows_what_is_answered() {
    let page = std::fs::read_to_string(shipped("docs/tutorial.md")).unwrap();
    let desk = desk();
    for file in ["sensor.toml", "pad-study.toml"] {
        assert!(page.contains(desk.read(file).trim_end()), "{file} is not shown as it is");
    }
    let stored = transcripts(&format!("```console\n{}```\n", desk.read("answers.txt")));
    let shown = transcripts(&page);
    assert!(shown.len() > 8 && stored.len() > 2, "{} {}", shown.len(), stored.len());
    for (command, lines) in shown {
        let long = stored.iter().find(|(known, _)| *known == command);
        let mut asked = words(&command);
        if long.is_some() {
            asked.push("--dry-run".to_owned());
        }
        let ran = desk.run(&asked.iter().map(String::as_str).collect::<Vec<_>>()).ok();
        let fresh: Vec<&str> = ran.stdout.lines().chain(ran.stderr.lines()).map(str::trim_end).collect();
        let answered = long.map_or(fresh, |(_, lines)| lines.iter().map(String::as_str).collect());
        for line in lines {
            assert!(
                answered.contains(&line.as_str()),
                "{command} does not answer\n{line}\nbut\n{}",
                answered.join("\n")
            );
        }
    }
}
