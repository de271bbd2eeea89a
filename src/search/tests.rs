use super::*;

/// Twelve sites in three rows.
fn space(letters: u8) -> Space {
    Space { sites: (0..12).map(|k| [k / 4, k % 4]).collect(), letters }
}

/// A rugged loss: random fields, couplings of neighbours, and of triples.
fn rugged(seed: u64) -> impl Fn(&Choice) -> f64 {
    let mut dice = Dice::new(seed);
    let fields: Vec<f64> = (0..36).map(|_| dice.bell()).collect();
    let triples: Vec<f64> = (0..12 * 125).map(|_| dice.bell()).collect();
    move |choice: &Choice| {
        (0..12)
            .map(|k| {
                let letters = [choice[k], choice[(k + 1) % 12], choice[(k + 5) % 12]].map(usize::from);
                fields[3 * k + letters[0].min(2)] + triples[125 * k + 25 * letters[0] + 5 * letters[1] + letters[2]]
            })
            .sum()
    }
}

/// The least loss of all choices.
fn brute_force(loss: impl Fn(&Choice) -> f64) -> f64 {
    (0..4096_u32).map(|bits| loss(&(0..12).map(|k| (bits >> k & 1) as u8).collect())).fold(f64::INFINITY, f64::min)
}

#[test]
fn every_method_finds_the_optimum_of_a_space_that_can_be_enumerated() {
    for seed in 1..=5 {
        let loss = rugged(100 + seed);
        let optimum = brute_force(&loss);
        for (name, method) in Method::NAMES {
            let mut search = Rounds::new(method, &space(2), vec![0; 12], seed);
            let mut asked = 0;
            while search.best().is_none_or(|(_, best)| best > optimum) {
                let choices = search.ask();
                asked += choices.len();
                assert!(asked < 40_000, "{name}, seed {seed}: {:?} is not {optimum}", search.best());
                search.tell(&choices.iter().map(&loss).collect::<Vec<_>>());
            }
        }
    }
}

#[test]
fn what_is_called_one_opt_is() {
    for (seed, letters) in [(1, 2), (2, 3), (3, 4)] {
        let loss = rugged(seed);
        let start = space(letters).random(&mut Dice::new(seed));
        let mut search = LocalSearch::new(&space(letters), start, None, 7, seed);
        loop {
            let choices = search.ask();
            if choices.is_empty() {
                break;
            }
            search.tell(&choices.iter().map(&loss).collect::<Vec<_>>());
        }
        assert!(search.one_opt());
        let (best, least) = search.best().unwrap();
        assert_eq!(loss(best), least);
        for site in 0..12 {
            for letter in 0..letters {
                let mut other = best.clone();
                other[site] = letter;
                assert!(loss(&other) >= least);
            }
        }
    }
}

#[test]
fn a_search_follows_from_its_seed() {
    let path = |seed: u64| {
        let mut search = Rounds::new(Method::GeneticLocal, &space(3), vec![0; 12], seed);
        let loss = rugged(9);
        let mut path = Vec::new();
        for _ in 0..100 {
            let choices = search.ask();
            search.tell(&choices.iter().map(&loss).collect::<Vec<_>>());
            path.push(choices);
        }
        path
    };
    assert_eq!(path(1), path(1));
    assert_ne!(path(1), path(2));
}

/// A failed evaluation never becomes a best one, and does not stop a search.
#[test]
fn what_fails_is_avoided() {
    let loss = rugged(4);
    let failing = |choice: &Choice| match choice[3] {
        1 => f64::NAN,
        _ => loss(choice),
    };
    for (_, method) in Method::NAMES {
        let mut search = Rounds::new(method, &space(2), vec![1; 12], 1);
        for _ in 0..200 {
            let choices = search.ask();
            search.tell(&choices.iter().map(failing).collect::<Vec<_>>());
        }
        let (best, least) = search.best().unwrap();
        assert!(best[3] == 0 && least.is_finite());
    }
}

#[test]
fn level_sets_use_every_letter_and_are_smooth() {
    let space = Space { sites: (0..400).map(|k| [5 + k / 20, 1 + k % 20]).collect(), letters: 3 };
    let mut dice = Dice::new(1);
    let (mut counts, mut walls) = ([0; 3], 0);
    for _ in 0..100 {
        let choice = level_set(&space, &mut dice);
        choice.iter().for_each(|&letter| counts[usize::from(letter)] += 1);
        walls += (0..400).filter(|k| k % 20 > 0 && choice[*k] != choice[k - 1]).count();
    }
    assert!(counts.iter().all(|&count| (10_000..17_000).contains(&count)), "{counts:?}");
    // Of independent letters two in three neighbours would differ.
    assert!(walls < 100 * 380 / 5, "{walls}");
}
