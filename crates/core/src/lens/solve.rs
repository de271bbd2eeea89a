//! The search for the lens that sends most of the struck width through the focal region.
//!
//! For every pair of apex and back row, curvatures 1/R from flat to the limit are tried on a grid (curvature rather than
//! radius, because its range is finite), and the best of good pairs are refined by golden section. Deep crystals are first
//! searched at every k-th row.

use std::cell::RefCell;
use std::collections::HashMap;
use std::rc::Rc;

use argmin::core::{CostFunction, Error, Executor, State};
use argmin::solver::goldensectionsearch::GoldenSectionSearch;

use super::fraction::Fan;
use super::plano_convex::Shape;
use super::problem::{Candidate, Problem};

/// Fractions that differ by less are equal, and then fewer spheres are better. It is below every error of the ray picture;
/// its use is to treat as equal the many lenses that send all of the width through.
pub(super) const TIE: f64 = 1e-6;

/// Pairs of rows are refined if their best on the grid is within this of the best of all: more than the fraction changes
/// between neighbouring curvatures of the grid at a maximum, which is a cusp where the edge of the region cuts off the
/// rim's rays on one side and those from halfway out on the other (0.04 for the published target).
const WORTH_REFINING: f64 = 0.1;

/// On the side of the caustic the fraction falls like a square root: to have 1e-5 of it takes 1e-10 of the curvature.
const CURVATURE: f64 = 1e-10;

/// The greatest curvature that is as good as the best is found to this part of it: the face moves by no more than that of a lens's thickness.
const EDGE: f64 = 1e-8;

/// By the same root a curvature to 1e-4 leaves 1e-2 of the fraction open; three times that for its factor.
const WORTH_FINISHING: f64 = 0.03;

/// Rays of the fan for plano-convex lenses on the axis.
pub(super) const FAN: usize = 256;

/// How finely to search.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grid {
    /// Rays in the fan for the grid
    scan_rays: usize,
    /// Rays in the fan for refining
    rays: usize,
    /// Curvatures from flat to the limit
    curvatures: u32,
    /// Apex and back rows to try at most, each, before the neighbourhood of the best is searched
    rows: u32,
    /// Whether curvatures and rows are refined
    refine: bool,
    /// Most pairs of rows to refine
    most: usize,
    /// To what relative accuracy a curvature is refined
    curvature: f64,
}

impl Grid {
    /// For the solution.
    pub(super) fn fine(problem: &Problem) -> Self {
        match problem.family {
            _ if problem.is_fast() => Self {
                scan_rays: 32,
                rays: FAN,
                curvatures: 32,
                rows: 40,
                refine: true,
                most: usize::MAX,
                curvature: CURVATURE,
            },
            // A ray takes many steps through a graded slab.
            family if family.row().is_mixed => {
                Self { scan_rays: 17, rays: 65, curvatures: 8, rows: 6, refine: true, most: 3, curvature: 1e-2 }
            }
            // Rays through any form take some hundred times as long as those of the fan.
            _ => Self { scan_rays: 33, rays: 129, curvatures: 10, rows: 8, refine: true, most: 6, curvature: 1e-3 },
        }
    }

    /// To find out whether there is any lens that helps.
    pub(super) fn coarse(problem: &Problem) -> Self {
        let fine = Self::fine(problem);
        match problem.is_fast() {
            true => Self { scan_rays: 64, rays: 64, curvatures: 12, rows: 12, refine: false, ..fine },
            false => Self { scan_rays: 17, rays: 17, curvatures: 6, rows: 5, refine: false, ..fine },
        }
    }
}

impl Problem<'_> {
    /// The best lens that the limits allow; none if they allow none.
    pub(super) fn best(&self, grid: Grid) -> Option<Candidate> {
        let fan = |count| Fan::new(count, self.max_angle, self.speeds);
        let [scan_rays, rays] = match self.is_fast() {
            true => [Rays::Fan(fan(grid.scan_rays).without_turns()), Rays::Fan(fan(grid.rays))],
            false => [grid.scan_rays, grid.rays].map(Rays::Traced),
        };
        Search { problem: self, scan_rays, rays, grid, known: RefCell::default(), scanned: RefCell::default() }.run()
    }
}

/// One search.
struct Search<'a> {
    problem: &'a Problem<'a>,
    scan_rays: Rays,
    rays: Rays,
    grid: Grid,
    /// Fractions that have been found by `rays`, by rows and the bits of the curvature: neighbourhoods overlap.
    known: RefCell<HashMap<([u32; 2], u64), f64>>,
    /// Pairs of rows that have been looked at, likewise.
    scanned: RefCell<HashMap<[u32; 2], Option<Rc<Scan>>>>,
}

/// By what rays are followed.
enum Rays {
    /// The fan for plano-convex lenses on the axis
    Fan(Fan),
    /// So many rays through any form
    Traced(usize),
}

/// Curvatures of one pair of rows, and the fraction at each by the coarser fan.
struct Scan {
    rows: [u32; 2],
    curvatures: Vec<f64>,
    fractions: Vec<f64>,
    best: usize,
}

impl Scan {
    /// The fraction at the best of the grid.
    fn most(&self) -> f64 {
        self.fractions[self.best]
    }
}

impl Search<'_> {
    fn fraction(&self, rows: [u32; 2], curvature: f64) -> f64 {
        let key = (rows, curvature.to_bits());
        if let Some(&fraction) = self.known.borrow().get(&key) {
            return fraction;
        }
        let fraction = self.fraction_by(&self.rays, rows, curvature);
        self.known.borrow_mut().insert(key, fraction);
        fraction
    }

    fn fraction_by(&self, rays: &Rays, [apex_row, back_row]: [u32; 2], curvature: f64) -> f64 {
        match rays {
            Rays::Fan(fan) => {
                let shape = Shape { apex_row, back_row, radius: 1.0 / curvature };
                let bench = shape.bench(self.problem.stack, self.problem.speeds);
                fan.fraction(&bench, self.problem.depth, self.problem.region)
            }
            Rays::Traced(count) => self.problem.served([apex_row, back_row], curvature, *count),
        }
    }

    fn candidate(&self, [apex_row, back_row]: [u32; 2], curvature: f64) -> Candidate {
        let fraction = self.fraction([apex_row, back_row], curvature);
        // A radius that is given is kept to the last digit.
        let radius = self.problem.radius.unwrap_or(1.0 / curvature);
        Candidate { shape: Shape { apex_row, back_row, radius }, fraction }
    }

    fn scan(&self, rows: [u32; 2]) -> Option<Rc<Scan>> {
        if let Some(scan) = self.scanned.borrow().get(&rows) {
            return scan.clone();
        }
        let scan = self.scan_anew(rows).map(Rc::new);
        self.scanned.borrow_mut().insert(rows, scan.clone());
        scan
    }

    fn scan_anew(&self, rows: [u32; 2]) -> Option<Scan> {
        let problem = self.problem;
        if rows[1] - rows[0] < problem.family.least_span(&problem.values) {
            return None;
        }
        let place = problem.place(rows);
        let curvatures: Vec<f64> = match problem.radius {
            Some(radius) if 1.0 / radius > problem.family.greatest_curvature(&place) * (1.0 + 1e-9) => return None,
            Some(radius) => vec![1.0 / radius],
            None => problem.family.curvatures(&place, self.grid.curvatures),
        };
        let fractions: Vec<f64> = curvatures.iter().map(|&c| self.fraction_by(&self.scan_rays, rows, c)).collect();
        let best = (0..fractions.len()).max_by(|&a, &b| fractions[a].total_cmp(&fractions[b]))?;
        Some(Scan { rows, curvatures, fractions, best })
    }

    fn run(&self) -> Option<Candidate> {
        let [apex_rows, back_rows] = self.problem.row_ranges();
        let (apexes, stride) = self.strided(apex_rows);
        let (backs, other_stride) = self.strided(back_rows);
        let pairs = apexes.iter().flat_map(|&a| backs.iter().filter(move |&&b| b > a).map(move |&b| [a, b]));
        let scans: Vec<Rc<Scan>> = pairs.filter_map(|rows| self.scan(rows)).collect();
        let best_of_grid = scans.iter().map(|scan| scan.fractions[scan.best]).max_by(f64::total_cmp)?;
        if !self.grid.refine || self.problem.radius.is_some() {
            return self.choose(scans.iter().map(|scan| (&**scan, scan.curvatures[scan.best])).collect());
        }
        let mut worth: Vec<&Scan> =
            scans.iter().map(Rc::as_ref).filter(|scan| scan.most() >= best_of_grid - WORTH_REFINING).collect();
        if worth.len() > self.grid.most {
            worth.sort_by(|a, b| b.fractions[b.best].total_cmp(&a.fractions[a.best]));
            worth.truncate(self.grid.most);
        }
        // First roughly, to 1e-4 of the curvature; then those to the end that may still win.
        let rough: Vec<(&Scan, f64)> =
            worth.iter().map(|&scan| (scan, self.refine(scan, self.grid.curvature.max(1e-4)))).collect();
        let fractions: Vec<f64> = rough.iter().map(|(scan, c)| self.fraction(scan.rows, *c)).collect();
        let leader = fractions.iter().copied().max_by(f64::total_cmp)?;
        let may_win = rough.iter().zip(&fractions).filter(|(_, fraction)| **fraction >= leader - WORTH_FINISHING);
        let mut best =
            self.choose(may_win.map(|((scan, _), _)| (*scan, self.refine(scan, self.grid.curvature))).collect())?;
        let mut stride = stride.max(other_stride) / 2;
        while stride >= 1 {
            best = self.descend(best, stride, apex_rows, back_rows);
            stride /= 2;
        }
        Some(best)
    }

    /// Every k-th row of a range and its last, and k.
    fn strided(&self, [low, high]: [u32; 2]) -> (Vec<u32>, u32) {
        if high < low {
            return (Vec::new(), 1);
        }
        let stride = (high - low).div_ceil(self.grid.rows).max(1);
        let mut rows: Vec<u32> = (low..=high).step_by(stride as usize).collect();
        if rows.last() != Some(&high) {
            rows.push(high);
        }
        (rows, stride)
    }

    /// Moves apex and back by `stride` rows as long as that makes the lens better.
    fn descend(&self, mut best: Candidate, stride: u32, apex_rows: [u32; 2], back_rows: [u32; 2]) -> Candidate {
        let inside = |row: i64, range: [u32; 2]| u32::try_from(row).ok().filter(|r| (range[0]..=range[1]).contains(r));
        loop {
            let mut scans = self.scan([best.shape.apex_row, best.shape.back_row]).into_iter().collect::<Vec<_>>();
            for (i, j) in [(-1, -1), (-1, 0), (-1, 1), (0, -1), (0, 1), (1, -1), (1, 0), (1, 1)] {
                let apex = inside(i64::from(best.shape.apex_row) + i * i64::from(stride), apex_rows);
                let back = inside(i64::from(best.shape.back_row) + j * i64::from(stride), back_rows);
                if let (Some(a), Some(b)) = (apex, back)
                    && a < b
                {
                    scans.extend(self.scan([a, b]));
                }
            }
            match self.choose(scans.iter().map(|scan| (&**scan, self.refine(scan, self.grid.curvature))).collect()) {
                Some(better) if better.shape != best.shape && self.is_better(&better, &best) => best = better,
                _ => return best,
            }
        }
    }

    fn is_better(&self, new: &Candidate, old: &Candidate) -> bool {
        let gain = new.fraction - old.fraction;
        let problem = self.problem;
        gain > TIE || (gain > -TIE && problem.count(&new.shape) < problem.count(&old.shape))
    }

    /// The curvature near the best of the grid at which the fraction is greatest, to a relative `tolerance`.
    fn refine(&self, scan: &Scan, tolerance: f64) -> f64 {
        let (start, last) = (scan.curvatures[scan.best], scan.curvatures.len() - 1);
        if !self.problem.family.is_curved() {
            return start;
        }
        let at_start = self.fraction(scan.rows, start);
        if last == 0 || at_start >= 1.0 - 0.1 * TIE {
            return start;
        }
        let low = if scan.best > 0 { scan.curvatures[scan.best - 1] } else { 0.1 * start };
        let high = scan.curvatures[(scan.best + 1).min(last)];
        let cost = Loss { search: self, rows: scan.rows };
        // Both fail only for empty intervals and starts outside them, which these are not; the grid's best stands then.
        let Ok(section) = GoldenSectionSearch::new(low, high).and_then(|s| s.with_tolerance(tolerance)) else {
            return start;
        };
        let run = Executor::new(cost, section).configure(|state| state.param(start).max_iters(60)).run();
        let refined = run.ok().and_then(|result| result.state().get_best_param().copied());
        refined.filter(|&curvature| self.fraction(scan.rows, curvature) > at_start).unwrap_or(start)
    }

    /// Of lenses that are equal to the best, the one of fewest spheres; then the one that reaches least deep.
    ///
    /// Each takes the greatest curvature that is still as good, as the front then cuts off most sites. That takes many fractions to
    /// find, but the number of spheres there lies between those at the ends of its bracket: who cannot win is left out.
    fn choose(&self, refined: Vec<(&Scan, f64)>) -> Option<Candidate> {
        let candidates: Vec<(&Scan, f64, f64)> =
            refined.into_iter().map(|(scan, c)| (scan, c, self.fraction(scan.rows, c))).collect();
        let least = candidates.iter().map(|c| c.2).max_by(f64::total_cmp)? - TIE;
        let mut equal: Vec<(usize, &Scan, [f64; 2])> = candidates
            .into_iter()
            .filter(|c| c.2 >= least)
            .map(|(scan, curvature, _)| {
                let ends = self.bracket(scan, curvature, least);
                (ends.map(|c| self.count(scan.rows, c)).into_iter().min().unwrap_or(0), scan, ends)
            })
            .collect();
        let key = |count: usize, [apex, back]: [u32; 2]| (count, back, apex);
        equal.sort_by_key(|(fewest, scan, _)| key(*fewest, scan.rows));
        let mut best: Option<((usize, u32, u32), Candidate)> = None;
        for (fewest, scan, ends) in equal {
            if best.is_some_and(|(found, _)| found < key(fewest, scan.rows)) {
                break;
            }
            let candidate = self.candidate(scan.rows, self.most_curved(scan.rows, ends, least));
            let own = key(self.problem.count(&candidate.shape), scan.rows);
            if best.is_none_or(|(found, _)| own < found) {
                best = Some((own, candidate));
            }
        }
        best.map(|(_, candidate)| candidate)
    }

    /// Number of spheres, if it grows or falls with the curvature alone; otherwise none.
    fn count(&self, [apex_row, back_row]: [u32; 2], curvature: f64) -> usize {
        match self.problem.family.row().is_monotonic {
            true => self.problem.count(&Shape { apex_row, back_row, radius: 1.0 / curvature }),
            false => 0,
        }
    }

    /// A curvature that sends `least` through, and a greater one that does not: the same if there is none on the grid.
    fn bracket(&self, scan: &Scan, curvature: f64, least: f64) -> [f64; 2] {
        if !self.problem.family.is_curved() || self.problem.radius.is_some() {
            return [curvature; 2];
        }
        // What is much less by the coarse fan is less.
        let good = |&k: &usize| {
            scan.curvatures[k] >= curvature
                && scan.fractions[k] >= least - WORTH_REFINING
                && self.fraction(scan.rows, scan.curvatures[k]) >= least
        };
        let last_good = (0..scan.curvatures.len()).rev().find(good);
        let low = last_good.map_or(curvature, |k| scan.curvatures[k]);
        [low, scan.curvatures.iter().copied().find(|&c| c > low).unwrap_or(low)]
    }

    /// The greatest curvature in such a bracket that still sends `least` through, by bisection.
    fn most_curved(&self, rows: [u32; 2], [mut low, mut high]: [f64; 2], least: f64) -> f64 {
        while high - low > EDGE * high.abs() {
            let middle = 0.5 * (low + high);
            *(if self.fraction(rows, middle) >= least { &mut low } else { &mut high }) = middle;
        }
        low
    }
}

/// What golden section minimises: minus the fraction, over the curvature.
struct Loss<'a> {
    search: &'a Search<'a>,
    rows: [u32; 2],
}

impl CostFunction for Loss<'_> {
    type Param = f64;
    type Output = f64;

    fn cost(&self, curvature: &f64) -> Result<f64, Error> {
        Ok(-self.search.fraction(self.rows, *curvature))
    }
}
