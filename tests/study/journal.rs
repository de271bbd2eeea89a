//! Journals that are torn, damaged, foreign, or of other settings.

use granulens::Context;
use granulens::search::Rng;
use granulens::study::{Journal, Study, run};

use crate::{DESIGN, Desk, STUDY, Told};

#[test]
fn a_flipped_bit_is_found_and_its_evaluation_done_anew() {
    let desk = Desk::new(STUDY);
    let (state, _) = desk.run().unwrap();
    let journal = desk.journal();
    let header = journal.iter().position(|&byte| byte == b'\n').unwrap() + 1;
    let mut rng = Rng::new(2);
    for _ in 0..20 {
        let mut flipped = journal.clone();
        let at = header + rng.below((journal.len() - header) as u64) as usize;
        flipped[at] ^= 1 << rng.below(8);
        // A flip that ends the last line's end makes it a torn one.
        desk.put(&flipped);
        let (again, told) = desk.run().unwrap();
        assert_eq!(again, state, "byte {at}");
        assert!((1..=2).contains(&told.simulated), "byte {at}: {}", told.simulated);
        assert!(!told.warnings.is_empty());
    }
    let mut flipped = journal.clone();
    flipped[header / 2] ^= 1;
    desk.put(&flipped);
    let refusal = desk.run().map(|_| ()).unwrap_err().to_string();
    assert!(refusal.contains("no whole first line") && refusal.contains("left alone"), "{refusal}");
    assert!(desk.journal() == flipped);
}

#[test]
fn foreign_files_are_refused_and_left_alone() {
    let desk = Desk::new(STUDY);
    // A header as a later version would write it, with its right checksum.
    let later = b"{\"journal\":\"granulens-study\",\"format\":3,\"version\":\"9.9.9\",\"crc\":\"CRC\"}\n";
    for (text, says) in [(&later[..], "first line"), (b"dear diary\n", "first line"), (b"dear diary", "no journal")] {
        desk.put(text);
        let refusal = desk.run().map(|_| ()).unwrap_err().to_string();
        assert!(refusal.contains(says), "{refusal}");
        assert!(desk.journal() == text);
    }
}

#[test]
fn a_second_run_waits_for_the_first() {
    let desk = Desk::new(STUDY);
    let held = Journal::open(&desk.path("journal.jsonl")).unwrap();
    let refusal = desk.run().map(|_| ()).unwrap_err().to_string();
    assert!(refusal.contains("another run is writing"), "{refusal}");
    drop(held);
}

#[test]
fn evaluations_of_other_settings_are_not_used() {
    let desk = Desk::new(&STUDY.replace("600", "200"));
    desk.run().unwrap();
    std::fs::write(desk.path("tiny.toml"), DESIGN.replace("16 kN", "12 kN")).unwrap();
    let (_, told) = desk.run().unwrap();
    assert_eq!(told.simulated, 200);
    assert!(told.warnings[0].contains("200 evaluations of the journal belong to other settings"));
}

/// Step and window need not stand in the design: those that are given to a study count too, each by itself.
#[test]
fn evaluations_of_another_step_or_window_are_not_used() {
    let desk = Desk::new(&STUDY.replace("600", "100"));
    desk.run().unwrap();
    let study = desk.study();
    let window = study.plan(0).unwrap().window;
    let longer = Study { window: Some(1.5 * window), ..study.clone() };
    let mut told = Told::default();
    run(&longer, &desk.path("journal.jsonl"), &Context::default(), &mut told).unwrap();
    assert_eq!(told.simulated, 100);
    assert!(
        told.warnings[0].contains("100 evaluations of the journal belong to other settings"),
        "{:?}",
        told.warnings
    );
    let mut finer = study;
    finer.rungs[0].step = Some(2e-7);
    let mut told = Told::default();
    run(&finer, &desk.path("journal.jsonl"), &Context::default(), &mut told).unwrap();
    assert_eq!(told.simulated, 100);
}

/// A comment, an empty line, another order of keys: the design says the same, and nothing is evaluated anew.
#[test]
fn what_is_said_counts_and_not_how() {
    let desk = Desk::new(&STUDY.replace("600", "200"));
    let before = desk.run().unwrap().0;
    let (first, rest) = DESIGN.split_once('\n').unwrap();
    let (second, rest) = rest.split_once('\n').unwrap();
    let told_anew = format!("# The same.\n\n{second}\n{first}   # as before\n{rest}");
    assert!(first.contains('=') && second.contains('='), "two keys to exchange: {first}, {second}");
    std::fs::write(desk.path("tiny.toml"), told_anew).unwrap();
    let (state, told) = desk.run().unwrap();
    assert_eq!((told.simulated, told.warnings.len()), (0, 0));
    assert_eq!(state, before);
}
