use super::*;

/// Twelve sites in three rows.
fn space(letters: u8) -> Space {
    Space::sheet((0..12).map(|k| [k / 4, k % 4]), letters)
}

/// A rugged loss: random fields, couplings of neighbours, and of triples.
fn rugged(seed: u64) -> impl Fn(&Assignment) -> f64 {
    let mut rng = Rng::new(seed);
    let fields: Vec<f64> = (0..36).map(|_| rng.nearly_normal()).collect();
    let triples: Vec<f64> = (0..12 * 125).map(|_| rng.nearly_normal()).collect();
    move |assignment: &Assignment| {
        (0..12)
            .map(|k| {
                let letters = [assignment[k], assignment[(k + 1) % 12], assignment[(k + 5) % 12]].map(usize::from);
                fields[3 * k + letters[0].min(2)] + triples[125 * k + 25 * letters[0] + 5 * letters[1] + letters[2]]
            })
            .sum()
    }
}

/// One number, as it is told to a method.
fn single(total: f64) -> Loss {
    Loss { total, miss: 0.0, parts: vec![total] }
}

/// The least loss of all assignments.
fn brute_force(loss: impl Fn(&Assignment) -> f64) -> f64 {
    (0..4096_u32).map(|bits| loss(&(0..12).map(|k| (bits >> k & 1) as u8).collect())).fold(f64::INFINITY, f64::min)
}

#[test]
fn every_method_finds_the_optimum_of_a_space_that_can_be_enumerated() {
    for seed in 1..=5 {
        let loss = rugged(100 + seed);
        let optimum = brute_force(&loss);
        // Painters and curves have spaces of their own, below.
        let any = |method: &Method| !method.takes_parametrisation() && method.name() != "curves";
        for (name, method) in Method::all().filter(any).map(|method| (method.name(), method)) {
            let mut search = Rounds::new(method, &space(2), vec![vec![0; 12]], None, seed);
            let mut asked = 0;
            while search.best().is_none_or(|(_, best)| best > optimum) {
                let assignments = search.ask();
                asked += assignments.len();
                assert!(asked < 40_000, "{name}, seed {seed}: {:?} is not {optimum}", search.best());
                search.tell(&assignments.iter().map(|assignment| single(loss(assignment))).collect::<Vec<_>>());
            }
        }
    }
}

/// In each of four columns no site, or a run of the three: what is between two curves, 2401 assignments of the 4096.
#[test]
fn curves_find_the_best_of_what_they_can_bound() {
    let runs: [&[u32]; 7] = [&[], &[0], &[1], &[2], &[0, 1], &[1, 2], &[0, 1, 2]];
    let between = |mut k: usize| -> Assignment {
        let mut assignment = vec![0; 12];
        for column in 0..4 {
            runs[k % 7].iter().for_each(|&row| assignment[row as usize * 4 + column] = 1);
            k /= 7;
        }
        assignment
    };
    for seed in 1..=5 {
        let loss = rugged(100 + seed);
        let optimum = (0..2401).map(|k| loss(&between(k))).fold(f64::INFINITY, f64::min);
        let mut search = Rounds::new("curves".parse().unwrap(), &space(2), vec![vec![0; 12]], None, seed);
        let mut asked = 0;
        while search.best().is_none_or(|(_, best)| best > optimum) {
            let assignments = search.ask();
            asked += assignments.len();
            assert!(asked < 40_000, "seed {seed}: {:?} is not {optimum}", search.best());
            search.tell(&assignments.iter().map(|assignment| single(loss(assignment))).collect::<Vec<_>>());
        }
        // Nor anything that no two curves bound.
        assert_eq!(search.best().map(|(_, loss)| loss), Some(optimum), "seed {seed}");
    }
}

/// Runs of one letter, from one parameter to the other, each site with a gain or a cost of its own: 78 runs and none at all.
#[test]
fn every_driver_finds_the_optimum_of_a_family_that_can_be_enumerated() {
    let decode = |x: &[f64]| -> Assignment {
        let (from, to) = (x[0].min(x[1]), x[0].max(x[1]));
        (0..12).map(|k| u8::from((from..=to).contains(&f64::from(k)))).collect()
    };
    for seed in 1..=5 {
        let mut rng = Rng::new(seed);
        let gains: Vec<f64> = (0..12).map(|_| rng.nearly_normal()).collect();
        let loss = |assignment: &Assignment| {
            assignment.iter().zip(&gains).map(|(&letter, gain)| f64::from(letter) * gain).sum()
        };
        let ends = || (0..12).map(f64::from);
        let all = ends().flat_map(|from| ends().map(move |to| [from, to]));
        let optimum: f64 = all.map(|x| loss(&decode(&x))).fold(0.0, f64::min);
        for method in Method::all().filter(|method| method.takes_parametrisation()) {
            let parametrisation = Parametrisation {
                start: vec![2.0, 9.0],
                spread: 3.0,
                bounds: vec![[-0.4, 11.4]; 2],
                decode: std::sync::Arc::new(decode),
                surrogate: None,
                batch: BATCH,
            };
            let mut search = Rounds::new(method, &space(2), Vec::new(), Some(parametrisation), seed);
            let mut asked = 0;
            while search.best().is_none_or(|(_, best)| best > optimum) {
                let assignments = search.ask();
                asked += assignments.len();
                assert!(
                    !assignments.is_empty() && asked < 10_000,
                    "{method:?}, seed {seed}: {:?} is not {optimum}",
                    search.best()
                );
                search.tell(&assignments.iter().map(|assignment| single(loss(assignment))).collect::<Vec<_>>());
            }
        }
    }
}

/// Of two losses that contradict each other: every point of the true front is found, and no other.
#[test]
fn nsga_finds_the_whole_front_of_a_space_that_can_be_enumerated() {
    let all: Vec<Assignment> = (0..4096_u32).map(|bits| (0..12).map(|k| (bits >> k & 1) as u8).collect()).collect();
    for seed in 1..=3 {
        let (one, two) = (rugged(seed), rugged(50 + seed));
        // A limit that a fifth or so of the assignments misses.
        let loss = |assignment: &Assignment| {
            let parts = vec![one(assignment), two(assignment)];
            Loss {
                total: parts[0] + parts[1],
                miss: (f64::from(assignment[0] + assignment[1] + assignment[2]) - 2.0).max(0.0),
                parts,
            }
        };
        let losses: Vec<Loss> = all.iter().map(loss).collect();
        let truth: Vec<&Loss> = front(&losses).into_iter().map(|k| &losses[k]).collect();
        let mut search = Nsga::new(&space(2), Vec::new(), seed);
        let mut asked = 0;
        loop {
            let assignments = search.ask();
            asked += assignments.len();
            if assignments.is_empty() || asked > 4000 {
                break;
            }
            search.tell(&assignments.iter().map(loss).collect::<Vec<_>>());
            assert!(search.front().all(|(assignment, found)| *found == loss(assignment)));
        }
        assert!(truth.iter().all(|wanted| search.front().any(|(_, found)| found == *wanted)), "seed {seed}");
        assert!(search.front().all(|(_, found)| truth.contains(&found)), "seed {seed}");
        assert!(search.best().is_some_and(|(assignment, _)| loss(assignment).miss == 0.0));
    }
}

#[test]
fn what_is_called_one_opt_is() {
    for (seed, letters) in [(1, 2), (2, 3), (3, 4)] {
        for reach in [Reach::Flips, Reach::Swaps, Reach::Pairs] {
            let loss = rugged(seed);
            let start = space(letters).random(&mut Rng::new(seed));
            let mut search = LocalSearch::new(&space(letters), start, None, 7, reach, seed);
            loop {
                let assignments = search.ask();
                if assignments.is_empty() {
                    break;
                }
                assert!(assignments.iter().all(|assignment| assignment.len() == 12));
                search.tell(&assignments.iter().map(&loss).collect::<Vec<_>>());
            }
            assert_eq!(
                search.local_optimality(),
                if reach == Reach::Pairs { LocalOptimality::TwoOpt } else { LocalOptimality::OneOpt }
            );
            let (best, least) = search.best().unwrap();
            assert_eq!(loss(best), least);
            let changed = |site: usize, letter: u8, other: usize, another: u8| {
                let mut changed = best.clone();
                changed[site] = letter;
                changed[other] = another;
                loss(&changed)
            };
            for site in 0..12 {
                for letter in 0..letters {
                    assert!(changed(site, letter, site, letter) >= least);
                }
                for other in (0..12).filter(|&other| other != site) {
                    if reach == Reach::Swaps && space(letters).neighbours().contains(&[site, other]) {
                        assert!(changed(site, best[other], other, best[site]) >= least);
                    }
                    for k in 0..if reach == Reach::Pairs { letters * letters } else { 0 } {
                        assert!(changed(site, k % letters, other, k / letters) >= least);
                    }
                }
            }
        }
    }
}

/// Cooled to nothing an annealing ends, and where it ends few flips help; while hot it goes uphill too.
#[test]
fn an_annealing_begins_hot_and_ends_cold() {
    let loss = rugged(6);
    let mut search = Annealing::new(&space(3), vec![0; 12], 2000, 4, 1);
    let (mut batches, mut rises) = (0, [0; 2]);
    let mut before = f64::INFINITY;
    loop {
        let assignments = search.ask();
        if assignments.is_empty() {
            break;
        }
        search.tell(&assignments.iter().map(&loss).collect::<Vec<_>>());
        let now = loss(&search.current().0);
        assert_eq!(now, search.current().1);
        rises[usize::from(search.tried() > 1000)] += usize::from(now > before);
        before = now;
        batches += 1;
        assert!(batches < 5000);
    }
    assert!(rises[0] > 5 * rises[1], "{rises:?}");
}

/// An assignment that is a level set is found again from itself, to the sites on its rim.
#[test]
fn a_level_set_is_fitted_by_its_own_kind() {
    let space = Space::sheet((0..400).map(|k| [5 + k / 20, 1 + k % 20]), 3);
    let waves = Waves::new(&space, 5);
    let mut rng = Rng::new(4);
    for _ in 0..10 {
        let weights: Vec<f64> = (0..waves.dimension()).map(|_| rng.nearly_normal()).collect();
        let assignment = waves.assignment(&weights);
        let again = waves.assignment(&waves.fit(&assignment));
        let differ = assignment.iter().zip(&again).filter(|(a, b)| a != b).count();
        // Of two assignments that have nothing to do with each other 267 sites differ.
        assert!(differ < 60, "{differ}");
    }
}

#[test]
fn exponentials_are_those_of_the_library() {
    for k in -7000..=7000 {
        let x = f64::from(k) / 10.0;
        assert!((exp(x) / x.exp() - 1.0).abs() < 1e-12, "{x}");
    }
}

#[test]
fn a_search_follows_from_its_seed() {
    let path = |method: Method, seed: u64| {
        let mut search = Rounds::new(method, &space(3), vec![vec![0; 12]], None, seed);
        let loss = rugged(9);
        let mut path = Vec::new();
        for _ in 0..100 {
            let assignments = search.ask();
            search.tell(&assignments.iter().map(|assignment| single(loss(assignment))).collect::<Vec<_>>());
            path.push(assignments);
        }
        path
    };
    // Bayesian searches are for few parameters, not for level sets; `bayes` has tests of its own.
    for method in Method::all().filter(|method| !method.takes_batch()) {
        assert_eq!(path(method, 1), path(method, 1));
        assert_ne!(path(method, 1), path(method, 2));
    }
}

/// A failed evaluation never becomes a best one, and does not stop a search.
#[test]
fn what_fails_is_avoided() {
    let loss = rugged(4);
    let failing = |assignment: &Assignment| match assignment[3] {
        1 => Loss::failed(),
        _ => single(loss(assignment)),
    };
    // Bayesian searches are for few parameters, not for level sets; `bayes` has tests of its own.
    for method in Method::all().filter(|method| !method.takes_batch()) {
        let mut search = Rounds::new(method, &space(2), vec![vec![1; 12]], None, 1);
        for _ in 0..200 {
            let assignments = search.ask();
            search.tell(&assignments.iter().map(failing).collect::<Vec<_>>());
        }
        let (best, least) = search.best().unwrap();
        assert!(best[3] == 0 && least.is_finite());
    }
}

#[test]
fn level_sets_use_every_letter_and_are_smooth() {
    let space = Space::sheet((0..400).map(|k| [5 + k / 20, 1 + k % 20]), 3);
    let mut rng = Rng::new(1);
    let (mut counts, mut walls) = ([0; 3], 0);
    for _ in 0..100 {
        let assignment = level_set(&space, &mut rng);
        assignment.iter().for_each(|&letter| counts[usize::from(letter)] += 1);
        walls += (0..400).filter(|k| k % 20 > 0 && assignment[*k] != assignment[k - 1]).count();
    }
    assert!(counts.iter().all(|&count| (10_000..17_000).contains(&count)), "{counts:?}");
    // Of independent letters two in three neighbours would differ.
    assert!(walls < 100 * 380 / 5, "{walls}");
}
