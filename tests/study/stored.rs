//! The layouts in `studies/`, against what is said about them in `docs/optimiser.md`.

use std::path::{Path, PathBuf};

use granulens::Context;
use granulens::dem::Integrator;
use granulens::design::Design;
use granulens::evaluate::{Evaluated, Evaluator, Overrides, evaluate};
use granulens::layout;
use granulens::material;
use granulens::score::Measure;
use granulens::study::Study;

/// C, G and Q as they were quoted of a layout that no table has any more, at 5e-8 s.
const QUOTED: (&str, [f64; 3]) = ("studies/two-materials-found.csv", [5.025, 1.3375, 0.6496]);

/// C and G of `studies/four-materials-robust-best.csv` under the worst of five impacts, at 5e-8 s.
const SAID_OF_FIVE: [f64; 2] = [4.802, 1.514];

fn repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// Cells of a line of a table, without emphasis.
fn cells(line: &str) -> Vec<String> {
    line.trim().trim_matches('|').split('|').map(|cell| cell.replace("**", "").trim().to_owned()).collect()
}

/// A number as it is written, and half a unit of its last digit.
fn written(text: &str) -> Option<(f64, f64)> {
    let value = text.parse::<f64>().ok()?;
    let digits = text.split_once('.').map_or(0, |(_, digits)| digits.len());
    Some((value, 0.5 * 10.0_f64.powi(-(digits as i32))))
}

/// What a page says of a stored layout: its file, C, G and Q as they are written, and the command that gives them: design and options.
struct Said {
    file: String,
    scores: [(f64, f64); 3],
    command: Vec<String>,
}

/// The rows that begin with the file of a layout, of all tables of a page with the columns C, G and Q, each with the last command above it that
/// compares or checks a layout.
fn said(page: &str) -> Vec<Said> {
    let mut found = Vec::new();
    let (mut command, mut columns) = (Vec::new(), None);
    let mut text = String::new();
    for line in page.lines() {
        if !line.starts_with('|') {
            (text, columns) = (text + " " + line, None);
            let begins = ["`granulens compare ", "`granulens check "];
            if let Some(begin) = begins.iter().filter_map(|begin| text.rfind(begin)).max()
                && let Some(end) = text[begin + 1..].find('`')
            {
                let words = text[begin + 1..begin + 1 + end].replace('"', " \u{1} ");
                // A quantity is two words in one pair of quotes.
                command = words.split('\u{1}').enumerate().fold(Vec::new(), |mut all: Vec<String>, (k, part)| {
                    let quoted = k % 2 == 1;
                    let parts = if quoted { vec![part.trim()] } else { part.split_whitespace().collect() };
                    all.extend(parts.into_iter().map(str::to_owned));
                    all
                });
            }
            continue;
        }
        let cells = cells(line);
        let of = |name: &str| cells.iter().position(|cell| cell == name);
        if let (Some(c), Some(g), Some(q)) = (of("C"), of("G"), of("Q")) {
            columns = Some([c, g, q]);
        } else if let (Some(columns), Some(file)) =
            (columns, cells[0].strip_prefix('`').and_then(|cell| cell.split_once('`')))
            && file.0.ends_with(".csv")
            && repository(file.0).is_file()
            && let [Some(c), Some(g), Some(q)] = columns.map(|k| cells.get(k).and_then(|cell| written(cell)))
        {
            found.push(Said { file: file.0.to_owned(), scores: [c, g, q], command: command.clone() });
        }
    }
    found
}

/// What tables of docs/optimiser.md say of stored layouts is what the command above them gives: to the digits that are written, and 0.1 % beside; at half of
/// its step to the 1 % that late pushes on single spheres are worth. All layouts of one command side by side, so that they share the vector lanes.
#[test]
fn stored_layouts_are_as_good_as_is_said() {
    let page = std::fs::read_to_string(repository("docs/optimiser.md")).unwrap();
    let mut all = said(&page);
    assert!(all.len() >= 6, "the table of stored layouts is missing");
    let command = all[0].command.clone();
    let scores = QUOTED.1.map(|value| (value, 0.0));
    all.push(Said { file: QUOTED.0.to_owned(), scores, command });
    // Every layout that a search came to is told of.
    for file in
        ["studies", "designs/optimum"].iter().filter_map(|folder| std::fs::read_dir(repository(folder)).ok()).flatten()
    {
        let name = file.unwrap().file_name().into_string().unwrap();
        let is_told = page.contains(name.trim_end_matches(".csv")) || !name.ends_with("-best.csv");
        assert!(is_told, "docs/optimiser.md says nothing of {name}");
    }
    let mut commands: Vec<Vec<String>> = all.iter().map(|said| said.command.clone()).collect();
    commands.sort();
    commands.dedup();
    for command in commands {
        let design =
            command.iter().find(|word| word.ends_with(".toml")).expect("a command above each table of layouts");
        let option = |name: &str| {
            let value = command.iter().position(|word| word == name).map(|k| &command[k + 1]);
            value.map(|text| granulens::units::Dimension::Time.parse(text).unwrap())
        };
        let (step, window) = (option("--step").expect("a step is said"), option("--window").unwrap_or(350e-6));
        let design = Design::read(repository(design)).unwrap();
        let own: Vec<&Said> = all.iter().filter(|said| said.command == command).collect();
        let mut palette = vec![design.host.clone(), material::find("brass-260", &[]).unwrap()];
        let mut layouts = Vec::new();
        for said in &own {
            let layout =
                layout::read(&repository(&said.file), &design.lattice, &palette, &design.own_materials).unwrap();
            // It only grows, so that the layouts before keep their meaning.
            palette = layout.palette;
            layouts.push(layout.materials);
        }
        let never = Context::default();
        for (step, tolerance) in [(step, 1e-3), (0.5 * step, 1e-2)] {
            let overrides = Overrides { step: Some(step), window: Some(window), ..Overrides::default() };
            let evaluator = Evaluator::new(&design, &[design.impact], palette.clone(), overrides, &never).unwrap();
            for (said, runs) in own.iter().zip(evaluator.scores(&layouts, &never).unwrap()) {
                assert_eq!(runs[0].stop, None);
                let scores = &runs[0].scores;
                let found = [scores.contrast, scores.focal_gain, scores.protection].map(Option::unwrap);
                for (found, (value, half)) in found.into_iter().zip(said.scores) {
                    let off = (found - value).abs();
                    assert!(off <= tolerance * value + half, "{} at {step}: {found} is not {value}", said.file);
                }
            }
        }
    }
}

/// Where a table lists the values of several seeds, the mean beside them and its interval are those of the list: half of the 95 % interval, by Student.
#[test]
fn means_of_long_tables_are_those_of_the_values_beside_them() {
    let page = std::fs::read_to_string(repository("docs/optimiser.md")).unwrap();
    let mut compared = 0;
    let mut look = |list: &str, mean: &str| {
        let Some((mean, half)) = mean.split_once('±') else { return };
        let (Some((mean, of_mean)), Some((half, of_half))) = (written(mean.trim()), written(half.trim())) else {
            return;
        };
        let values: Option<Vec<(f64, f64)>> = list.split(',').map(|value| written(value.trim())).collect();
        let Some(values) = values.filter(|values| values.len() > 2) else { return };
        // Each value is rounded too.
        let rounded = values.iter().map(|value| value.1).fold(0.0, f64::max);
        let found = granulens::stats::Mean::of(&values.iter().map(|value| value.0).collect::<Vec<_>>());
        assert!((found.mean - mean).abs() <= of_mean + rounded, "{list}: {} is not {mean}", found.mean);
        let interval = found.interval.unwrap();
        assert!((interval - half).abs() <= of_half + 3.0 * rounded, "{list}: {interval} is not {half}");
        compared += 1;
    };
    for line in page.lines().filter(|line| line.starts_with('|')) {
        let cells = cells(line);
        for (k, cell) in cells.iter().enumerate() {
            // In one cell, or in the next.
            match cell.split_once(':') {
                Some((list, mean)) => look(list, mean),
                None => look(cell, cells.get(k + 1).map_or("", String::as_str)),
            }
        }
        // Or over the cells of a row.
        if let Some((last, values)) = cells.split_last().filter(|(last, _)| last.contains('±')) {
            let values: Vec<&str> = values.iter().skip(1).map(String::as_str).collect();
            look(&values.join(", "), last);
        }
    }
    assert!(compared >= 8, "{compared}");
}

/// Under the worst of the five impacts of `four-materials-robust.toml`, each of C and G by itself.
#[test]
fn a_stored_layout_stands_five_impacts() {
    let study = Study::read(&repository("studies/four-materials-robust.toml"), None).unwrap();
    let file = repository("studies/four-materials-robust-best.csv");
    let layout = layout::read(&file, &study.design.plane().unwrap().lattice, &study.palette, &[]).unwrap();
    let never = Context::default();
    let overrides = Overrides {
        integrator: Some(Integrator::Adams),
        step: Some(5e-8),
        window: Some(350e-6),
        ..Overrides::default()
    };
    let evaluator = Evaluator::new(&study.design, &study.cases(), layout.palette, overrides, &never).unwrap();
    let runs: Vec<Evaluated> = evaluator.scores(&[layout.materials], &never).unwrap().remove(0);
    assert_eq!(runs.len(), 5);
    assert!(runs.iter().all(|run| run.stop.is_none()));
    let worst = |measure| runs.iter().map(|run| run.scores.get(measure).unwrap()).fold(f64::MAX, f64::min);
    let found = [worst(Measure::Contrast), worst(Measure::FocalGain)];
    for (found, said) in found.into_iter().zip(SAID_OF_FIVE) {
        assert!((found / said - 1.0).abs() < 1e-3, "{found} is not {said}");
    }
}

/// `check` and `compare` say of every stored layout, under each of the five impacts, what batches say, to the last bit: also where
/// spheres meet that do not touch at rest.
#[test]
fn stored_layouts_have_the_same_scores_one_by_one() {
    let study = Study::read(&repository("studies/four-materials-robust.toml"), None).unwrap();
    let mut palette = study.palette.clone();
    let mut layouts = Vec::new();
    for file in std::fs::read_dir(repository("studies")).unwrap() {
        let path = file.unwrap().path();
        if path.extension().is_none_or(|extension| extension != "csv") {
            continue;
        }
        let layout = layout::read(&path, &study.design.plane().unwrap().lattice, &palette, &[]).unwrap();
        palette = layout.palette.clone();
        layouts.push(layout);
    }
    assert!(layouts.len() >= 9);
    let never = Context::default();
    let overrides = Overrides { step: Some(2e-7), window: Some(350e-6), ..Overrides::default() };
    let cases = study.cases();
    let evaluator = Evaluator::new(&study.design, &cases, palette, overrides, &never).unwrap();
    let numbers: Vec<Vec<u8>> = layouts.iter().map(|layout| layout.materials.clone()).collect();
    let mut arose = 0;
    for (layout, marks) in layouts.iter().zip(evaluator.scores(&numbers, &never).unwrap()) {
        let sample = layout.sample();
        for (case, marks) in cases.iter().zip(marks) {
            let design = Design { impact: case.load.strike, ..study.design.plane().unwrap().clone() };
            let alone = evaluate(&design, layout, evaluator.plan(), &never).unwrap();
            let said = [alone.scores.focal_mean, alone.scores.protected_mean];
            assert_eq!([marks.scores.focal_mean, marks.scores.protected_mean], said, "{:?}", case.load);
            let late = alone.record.contacts.iter().filter(|contact| {
                let [a, b] = contact.spheres.map(|i| sample.spheres[i].centre);
                (a[0] - b[0]).hypot(a[1] - b[1]) > 1.1 * layout.lattice.diameter()
            });
            arose += late.count();
        }
    }
    assert!(arose > 0);
}
