//! Bayesian optimisation: where to look next by a Gaussian process of what is known.

use egobox_gp::GaussianProcess;
use egobox_gp::correlation_models::Matern52Corr;
use egobox_gp::mean_models::ConstantMean;
use egobox_gp::{GpError, ThetaTuning};
use linfa::Dataset;
use linfa::traits::Fit;
use ndarray::{Array1, Array2};

use super::method::{BAYES, Row};
use super::{Cma, Optimizer, Rng, parametric};

/// Over the parameters of a parametrisation.
pub(super) const METHOD: Row = Row {
    name: BAYES,
    about: "Bayesian optimisation of the lens family's parameters, for few and costly evaluations",
    begin: |begin| parametric::by(begin, Optimizer::Bayes),
    takes_batch: true,
    ..parametric::METHOD
};

/// Points asked for before there is a process, for each parameter: with four of them two registers of eight.
const FIRST: usize = 4;

/// Points anywhere, and points near the best known, of which the most promising is sought.
const ANYWHERE: usize = 1024;
const NEAR: usize = 512;

/// The best known that these are near to, and how near: standard deviations in parts of the bounds.
const BEST: usize = 4;
const NEARNESS: [f64; 3] = [0.1, 0.03, 0.01];

/// What the most promising one is moved by: generations of CMA-ES and its first standard deviation.
const GENERATIONS: usize = 12;
const NUDGE: f64 = 0.03;

/// Neighbours differ by less in every parameter, in parts of the bounds; by less than twice that after so many refusals, and so on.
const BESIDE: f64 = 0.02;
const PATIENCE: usize = 8;

/// Variances of what is not smooth over that of the process, of which the likeliest is taken: nothing but rounding; a layout's
/// scores, which jump where a sphere changes; and more of the same.
const ROUGHNESS: [f64; 3] = [1e-10, 1e-4, 1e-2];

/// Inverse lengths of correlation, over the standard deviation of the points along a parameter: where their search begins and
/// ends, egobox's own.
const INVERSE_LENGTH: f64 = ThetaTuning::<f64>::DEFAULT_INIT;
const INVERSE_LENGTHS: (f64, f64) = ThetaTuning::<f64>::DEFAULT_BOUNDS;

/// Places from which the search for them begins, where it begins anew. Not 1, for which egobox draws by the clock.
const PLACES: usize = 6;

/// They are searched for anew when so many times as many points are known.
const GROWTH: f64 = 1.25;

type Process = GaussianProcess<f64, ConstantMean, Matern52Corr>;

/// What a process is like apart from what it knows.
#[derive(Clone)]
struct Nature {
    inverse_lengths: Array1<f64>,
    roughness: f64,
    /// How many points were known when it was found.
    known: usize,
}

/// Efficient global optimisation (D. R. Jones, M. Schonlau & W. J. Welch, J. Glob. Optim. 13 (1998) 455) within bounds: a Latin
/// hypercube, then points of the greatest expected improvement over the best known, by a Gaussian process (egobox-gp) of constant
/// mean with Matérn's correlation (5/2), its lengths by likelihood. Several points at a time are found one after the other, each
/// believed to be what the process says (D. Ginsbourger, R. Le Riche & L. Carraro, 2010: Kriging believer).
pub struct Bayes {
    bounds: Vec<[f64; 2]>,
    batch: usize,
    rng: Rng,
    start: Vec<f64>,
    nature: Option<Nature>,
    /// Points in parts of the bounds, and their losses; not a number where they failed.
    known: Vec<(Vec<f64>, f64)>,
    asked: Vec<Vec<f64>>,
}

impl Bayes {
    /// Around `start`, within `bounds`, a lower and an upper one for each parameter; `batch` points at a time.
    pub fn new(start: &[f64], bounds: Vec<[f64; 2]>, batch: usize, seed: u64) -> Self {
        let part = |(x, [from, to]): (&f64, &[f64; 2])| ((x - from) / (to - from)).clamp(0.0, 1.0);
        let start = start.iter().zip(&bounds).map(part).collect();
        Self { bounds, batch, rng: Rng::new(seed), start, nature: None, known: Vec::new(), asked: Vec::new() }
    }

    /// The points whose losses are wanted next: such that `accept` says yes to, which it is asked once or not at all, the most
    /// promising first. None where it says no to all.
    pub fn ask(&mut self, accept: &mut dyn FnMut(&[f64]) -> bool) -> Vec<Vec<f64>> {
        self.asked.clear();
        let process = if self.known.is_empty() { None } else { self.process() };
        if let Some(process) = process {
            self.ask_process(process, accept);
        } else {
            let first = if self.known.is_empty() { self.hypercube(FIRST * self.bounds.len()) } else { Vec::new() };
            let wanted = first.len().max(self.batch);
            // What is drawn without a process is as good as any other.
            let others: Vec<Vec<f64>> = (0..ANYWHERE).map(|_| self.anywhere()).collect();
            for point in first.into_iter().chain(others) {
                if self.asked.len() < wanted && accept(&self.place(&point)) {
                    self.asked.push(point);
                }
            }
        }
        self.asked.iter().map(|point| self.place(point)).collect()
    }

    /// The losses of what was asked for last, in its order.
    pub fn tell(&mut self, losses: &[f64]) {
        self.known.extend(self.asked.drain(..).zip(losses.iter().copied()));
    }

    /// From parts of the bounds to parameters.
    fn place(&self, point: &[f64]) -> Vec<f64> {
        point.iter().zip(&self.bounds).map(|(part, [from, to])| from + (to - from) * part).collect()
    }

    fn anywhere(&mut self) -> Vec<f64> {
        (0..self.bounds.len()).map(|_| self.rng.unit()).collect()
    }

    /// The start, and points of which one lies in each of as many slices of every parameter.
    fn hypercube(&mut self, count: usize) -> Vec<Vec<f64>> {
        let mut points = vec![Vec::new(); count];
        for _ in 0..self.bounds.len() {
            let mut slices: Vec<usize> = (0..count).collect();
            for k in (1..count).rev() {
                slices.swap(k, self.rng.below(k as u64 + 1) as usize);
            }
            for (point, slice) in points.iter_mut().zip(slices) {
                point.push((slice as f64 + self.rng.unit()) / count as f64);
            }
        }
        points[0] = self.start.clone();
        points
    }

    /// The most promising points one after the other, each believed.
    fn ask_process(&mut self, mut process: Process, accept: &mut dyn FnMut(&[f64]) -> bool) {
        while self.asked.len() < self.batch {
            let mut candidates = self.candidates(&process);
            // Stable: of two that are alike, the first; where nothing is expected anywhere, any.
            candidates.sort_by(|a, b| b.0.total_cmp(&a.0));
            let points = candidates.into_iter().map(|(_, point)| point).collect();
            let Some(point) = self.first_accepted(points, accept) else { return };
            let at = rows(std::slice::from_ref(&point));
            self.asked.push(point);
            let Some(believed) = process.predict(&at).ok().and_then(|mean| process.update(&at, &mean).ok()) else {
                return;
            };
            process = believed;
        }
    }

    /// The first point that is accepted. The neighbours of one that is not are left for the end: they are many where much is
    /// expected, most of them stand for the same, and to find that out may take as long as a simulation.
    fn first_accepted(&self, points: Vec<Vec<f64>>, accept: &mut dyn FnMut(&[f64]) -> bool) -> Option<Vec<f64>> {
        let mut refused: Vec<Vec<f64>> = Vec::new();
        let mut left = Vec::new();
        for point in points {
            let reach = BESIDE * f64::from(1 << (refused.len() / PATIENCE).min(6));
            let beside = |other: &Vec<f64>| other.iter().zip(&point).all(|(a, b)| (a - b).abs() < reach);
            if refused.iter().any(beside) {
                left.push(point);
            } else if accept(&self.place(&point)) {
                return Some(point);
            } else {
                refused.push(point);
            }
        }
        left.into_iter().find(|point| accept(&self.place(point)))
    }

    /// Points and the improvement that is expected of them.
    fn candidates(&mut self, process: &Process) -> Vec<(f64, Vec<f64>)> {
        let mut ranked: Vec<&(Vec<f64>, f64)> = self.known.iter().filter(|(_, loss)| loss.is_finite()).collect();
        ranked.sort_by(|a, b| a.1.total_cmp(&b.1));
        let least = ranked[0].1;
        let best: Vec<Vec<f64>> = ranked.iter().take(BEST).map(|(point, _)| point.clone()).collect();
        let mut points: Vec<Vec<f64>> = (0..ANYWHERE).map(|_| self.anywhere()).collect();
        for k in 0..NEAR {
            let spread = NEARNESS[k / best.len() % NEARNESS.len()];
            let rng = &mut self.rng;
            points.push(
                best[k % best.len()].iter().map(|x| (x + spread * rng.nearly_normal()).clamp(0.0, 1.0)).collect(),
            );
        }
        let mut candidates: Vec<(f64, Vec<f64>)> =
            improvements(process, least, &points).into_iter().zip(points).collect();
        let greatest = candidates.iter().fold(&candidates[0], |a, b| if b.0 > a.0 { b } else { a });
        let mut nudged = Cma::new(greatest.1.clone(), NUDGE, 0, self.rng.bits());
        for _ in 0..GENERATIONS {
            let mut points = nudged.ask();
            points.iter_mut().flatten().for_each(|x| *x = x.clamp(0.0, 1.0));
            let gains = improvements(process, least, &points);
            nudged.tell(&gains.iter().map(|gain| -gain).collect::<Vec<_>>());
            candidates.extend(gains.into_iter().zip(points));
        }
        candidates
    }

    /// A process through what is known, or as near to it as it is rough; none where that tells nothing apart.
    fn process(&mut self) -> Option<Process> {
        let finite = || self.known.iter().map(|(_, loss)| *loss).filter(|loss| loss.is_finite());
        let [least, most] = [finite().fold(f64::INFINITY, f64::min), finite().fold(f64::NEG_INFINITY, f64::max)];
        if most <= least {
            return None;
        }
        let points = rows(&self.known.iter().map(|(point, _)| point.clone()).collect::<Vec<_>>());
        // What failed is as bad as the worst.
        let losses = self.known.iter().map(|(_, loss)| if loss.is_finite() { *loss } else { most }).collect();
        let data = Dataset::new(points, losses);
        let known = self.known.len();
        let near = self.nature.clone().filter(|nature| (known as f64) < GROWTH * nature.known as f64);
        if let Some(mut nature) = near
            && let Ok(process) = fit(&data, &nature.inverse_lengths, nature.roughness, 0)
        {
            nature.inverse_lengths = process.theta().clone();
            self.nature = Some(nature);
            return Some(process);
        }
        let init = Array1::from_elem(self.bounds.len(), INVERSE_LENGTH);
        let fits =
            ROUGHNESS.iter().filter_map(|&roughness| Some((fit(&data, &init, roughness, PLACES).ok()?, roughness)));
        let (process, roughness) = fits.reduce(|a, b| if b.0.likelihood() > a.0.likelihood() { b } else { a })?;
        self.nature = Some(Nature { inverse_lengths: process.theta().clone(), roughness, known });
        Some(process)
    }
}

type Data = Dataset<f64, f64, ndarray::Ix1>;

fn fit(data: &Data, init: &Array1<f64>, roughness: f64, places: usize) -> Result<Process, GpError> {
    let tuning = ThetaTuning::Full { init: init.clone(), bounds: Array1::from_elem(init.len(), INVERSE_LENGTHS) };
    let process = Process::params(ConstantMean::default(), Matern52Corr::default());
    process.theta_tuning(tuning).n_start(places).nugget(roughness).fit(data)
}

fn rows(points: &[Vec<f64>]) -> Array2<f64> {
    let width = points.first().map_or(0, Vec::len);
    Array2::from_shape_fn((points.len(), width), |(row, column)| points[row][column])
}

/// By how much points are expected to fall below `least`: s (z Φ(z) + φ(z)) with z = (least − mean)/s (Jones et al., eq. 15).
fn improvements(process: &Process, least: f64, points: &[Vec<f64>]) -> Vec<f64> {
    let Ok((mean, variance)) = process.predict_valvar(&rows(points)) else { return vec![0.0; points.len()] };
    let expected = |(mean, variance): (&f64, &f64)| {
        let deviation = variance.sqrt();
        if deviation == 0.0 {
            return 0.0;
        }
        let z = (least - mean) / deviation;
        let below = 0.5 * libm::erfc(-z * std::f64::consts::FRAC_1_SQRT_2);
        let density = libm::exp(-0.5 * z * z) / (2.0 * std::f64::consts::PI).sqrt();
        (deviation * (z * below + density)).max(0.0)
    };
    mean.iter().zip(&variance).map(expected).collect()
}

#[cfg(test)]
mod tests;
