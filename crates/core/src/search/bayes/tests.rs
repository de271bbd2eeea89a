use super::*;

/// A function with its bounds and its least value.
struct Problem {
    name: &'static str,
    loss: fn(&[f64]) -> f64,
    bounds: Vec<[f64; 2]>,
    least: f64,
}

/// F. H. Branin's of two parameters, with three lowest places.
fn branin(x: &[f64]) -> f64 {
    use std::f64::consts::PI;
    let bent = x[1] - 5.1 / (4.0 * PI * PI) * x[0] * x[0] + 5.0 / PI * x[0] - 6.0;
    bent * bent + 10.0 * (1.0 - 1.0 / (8.0 * PI)) * x[0].cos() + 10.0
}

/// J. K. Hartman's of three parameters: four dips, of which one is the lowest.
fn hartman(x: &[f64]) -> f64 {
    const DEPTH: [f64; 4] = [1.0, 1.2, 3.0, 3.2];
    const STEEP: [[f64; 3]; 4] = [[3.0, 10.0, 30.0], [0.1, 10.0, 35.0], [3.0, 10.0, 30.0], [0.1, 10.0, 35.0]];
    const PLACE: [[f64; 3]; 4] =
        [[0.3689, 0.1170, 0.2673], [0.4699, 0.4387, 0.7470], [0.1091, 0.8732, 0.5547], [0.0381, 0.5743, 0.8828]];
    let dip = |k: usize| (0..3).map(|j| STEEP[k][j] * (x[j] - PLACE[k][j]).powi(2)).sum::<f64>();
    -(0..4).map(|k| DEPTH[k] * (-dip(k)).exp()).sum::<f64>()
}

/// Four parameters that hang together (called Trid): least −d (d + 4)(d − 1)/6 = −16 at (4, 6, 6, 4).
fn trid(x: &[f64]) -> f64 {
    let own: f64 = x.iter().map(|x| (x - 1.0) * (x - 1.0)).sum();
    own - x.windows(2).map(|pair| pair[0] * pair[1]).sum::<f64>()
}

fn problems() -> [Problem; 3] {
    [
        Problem { name: "branin", loss: branin, bounds: vec![[-5.0, 10.0], [0.0, 15.0]], least: 0.397_887 },
        Problem { name: "hartman", loss: hartman, bounds: vec![[0.0, 1.0]; 3], least: -3.862_78 },
        Problem { name: "trid", loss: trid, bounds: vec![[-16.0, 16.0]; 4], least: -16.0 },
    ]
}

impl Problem {
    /// Where both searches begin: off the middle, which is too good a place for some.
    fn start(&self) -> Vec<f64> {
        self.bounds.iter().map(|[from, to]| from + 0.3 * (to - from)).collect()
    }

    /// Evaluations until the least value is met to 1 %, as Jones et al. count them; `most` where it is not.
    fn count(&self, most: usize, mut ask: impl FnMut(&[f64]) -> Vec<Vec<f64>>) -> usize {
        let mut count = 0;
        let mut losses = Vec::new();
        while count < most {
            let points = ask(&losses);
            losses = points.iter().map(|point| (self.loss)(point)).collect();
            let met = losses.iter().position(|loss| loss - self.least < 0.01 * self.least.abs());
            if let Some(place) = met {
                return count + place + 1;
            }
            count += points.len();
        }
        most
    }

    fn bayes(&self, batch: usize, seed: u64) -> usize {
        let mut search = Bayes::new(&self.start(), self.bounds.clone(), batch, seed);
        self.count(300, |losses| {
            search.tell(losses);
            let points = search.ask(&mut |_| true);
            let within =
                |point: &Vec<f64>| point.iter().zip(&self.bounds).all(|(x, [from, to])| (from..=to).contains(&x));
            assert!(points.iter().all(within), "{points:?}");
            points
        })
    }

    /// CMA-ES with as many points a generation as its author recommends, in parts of the bounds, beyond which it may look.
    fn cma(&self, seed: u64) -> usize {
        let scale = |point: &[f64]| -> Vec<f64> {
            point.iter().zip(&self.bounds).map(|(x, [from, to])| from + (to - from) * x).collect()
        };
        let mut search = Cma::new(vec![0.3; self.bounds.len()], 0.3, 0, seed);
        self.count(2000, |losses| {
            if !losses.is_empty() {
                search.tell(losses);
            }
            search.ask().iter().map(|point| scale(point)).collect()
        })
    }
}

/// What Jones et al. report of Branin's function, 28 evaluations, is what a search one by one takes here too. CMA-ES takes 80 and
/// more of it, 100 and more of Hartman's, 156 and more of the third; batches of four take 35 at most, 0.4 times as many on the
/// seed where they are nearest, 0.2 times over all. Half on every seed leaves room for another sequence of random numbers.
#[test]
fn it_takes_half_the_evaluations_of_cma_es_or_less() {
    for problem in problems() {
        for seed in 1..=5 {
            let (batches, cma) = (problem.bayes(4, seed), problem.cma(seed));
            println!("{}, seed {seed}: {batches} evaluations, CMA-ES {cma}", problem.name);
            assert!(2 * batches < cma, "{}, seed {seed}: {batches}, CMA-ES {cma}", problem.name);
        }
    }
}

/// Everything that is asked for in so many batches.
fn path(seed: u64, batches: usize, loss: impl Fn(&[f64]) -> f64) -> Vec<Vec<f64>> {
    let mut search = Bayes::new(&[0.0, 3.0], vec![[-5.0, 10.0], [0.0, 15.0]], 3, seed);
    let mut path = Vec::new();
    for _ in 0..batches {
        let points = search.ask(&mut |_| true);
        search.tell(&points.iter().map(|point| loss(point)).collect::<Vec<_>>());
        path.extend(points);
    }
    path
}

#[test]
fn it_follows_from_its_seed_on_any_number_of_threads() {
    let on = |threads: usize, seed: u64| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| path(seed, 8, branin))
    };
    let one = on(1, 1);
    assert!((2..4).all(|threads| on(threads, 1) == one));
    assert_ne!(on(1, 2), one);
    assert_eq!((one.len(), &one[0]), (8 + 7 * 3, &vec![0.0, 3.0]));
}

/// One point in each slice of every parameter; but for the start, which is in some slice of its own.
#[test]
fn the_first_points_are_a_latin_hypercube() {
    let points = path(1, 1, branin);
    for (k, from) in [(0, -5.0), (1, 0.0)] {
        let mut slices: Vec<usize> =
            points[1..].iter().map(|point| ((point[k] - from) / 15.0 * 8.0) as usize).collect();
        slices.sort_unstable();
        slices.dedup();
        assert_eq!(slices.len(), points.len() - 1);
    }
}

/// Failures count as the worst that is known, wherever they are; losses that are all alike, or all failed, tell nothing, and
/// points are then drawn anywhere.
#[test]
fn failures_and_losses_that_tell_nothing_are_survived() {
    let half = path(1, 12, |x| if x[0] > 6.0 { f64::NAN } else { branin(x) });
    let lowest = half.iter().filter(|x| x[0] <= 6.0).map(|x| branin(x)).fold(f64::INFINITY, f64::min);
    assert!(lowest < 1.0, "{lowest}");
    for nothing in [0.0, f64::INFINITY, f64::NAN] {
        let points = path(1, 3, |_| nothing);
        assert_eq!(points.len(), 8 + 2 * 3);
        assert!(points.iter().flatten().all(|x| (-5.0..=15.0).contains(x)));
    }
}

/// It asks for what is accepted only, for nothing else where that is all, and goes on when there is more.
#[test]
fn it_asks_for_what_is_accepted() {
    let mut search = Bayes::new(&[0.1], vec![[0.0, 1.0]], 2, 1);
    let mut left = search.ask(&mut |x| x[0] < 0.5);
    assert!(left.len() == 4 && left.iter().all(|x| x[0] < 0.5), "{left:?}");
    for _ in 0..5 {
        search.tell(&left.iter().map(|x| x[0].sin()).collect::<Vec<_>>());
        left = search.ask(&mut |x| x[0] < 0.5);
        assert!(left.len() == 2 && left.iter().all(|x| x[0] < 0.5), "{left:?}");
        assert!(search.ask(&mut |_| false).is_empty());
    }
}

/// Against the integral of what is below the least known, over the normal density: the sum over ±8
/// deviations in 16 000 parts leaves some 10⁻⁷ of the deviation at the kink.
#[test]
fn expected_improvements_are_those_of_the_integral() {
    let points = rows(&[vec![0.1, 0.2], vec![0.8, 0.3], vec![0.5, 0.9], vec![0.3, 0.6]]);
    let data = Dataset::new(points, Array1::from(vec![1.0, 0.4, 0.7, 0.9]));
    let process = Process::params(ConstantMean::default(), Matern52Corr::default());
    let process = process.theta_tuning(ThetaTuning::Fixed(Array1::from_elem(2, 0.7))).fit(&data).unwrap();
    let at = [vec![0.7, 0.3], vec![0.2, 0.8], vec![0.95, 0.1], vec![0.55, 0.5]];
    let (mean, variance) = process.predict_valvar(&rows(&at)).unwrap();
    let closed = improvements(&process, 0.4, &at);
    for k in 0..at.len() {
        let deviation = variance[k].sqrt();
        let below = |j: usize| {
            let z = (j as f64 + 0.5) / 1000.0 - 8.0;
            (0.4 - mean[k] - deviation * z).max(0.0) * (-0.5 * z * z).exp()
        };
        let sum: f64 = (0..16_000).map(below).sum::<f64>() / 1000.0 / (2.0 * std::f64::consts::PI).sqrt();
        assert!((closed[k] - sum).abs() < 1e-6 * deviation && closed[k] > 0.0, "{} {sum}", closed[k]);
    }
    // Where it is known there is nothing to gain.
    assert!(improvements(&process, 0.4, &[vec![0.8, 0.3]])[0] < 1e-4);
}
