//! The search for the lens that sends most of the struck width through the focal region.
//!
//! For every pair of apex and back row, curvatures 1/R from flat to the limit are tried on a grid (curvature rather than
//! radius, because its range is finite), and the best of good pairs are refined by golden section. Deep crystals are first
//! searched at every k-th row.

use std::cell::RefCell;
use std::collections::HashMap;

use argmin::core::{CostFunction, Error, Executor, State};
use argmin::solver::goldensectionsearch::GoldenSectionSearch;

use super::family::Place;
use super::form::{Form, Surrounds};
use super::fraction::{Fan, passing, without};
use super::parts::Strip;
use super::plano_convex::Shape;
use super::symmetry::Symmetry;
use super::{Family, LensRequest};
use crate::lattice::HexagonalSheet;
use crate::target::{Region, Target};

/// Fractions that differ by less are equal, and then fewer spheres are better. It is below every error of the ray picture;
/// its use is to treat as equal the many lenses that send all of the width through.
pub(super) const TIE: f64 = 1e-6;

/// A lens has to send this much more of the struck width through than straight rays, or it is no lens for the target:
/// ray angles are off by degrees in a crystal (Burgoyne 2016, fig. 5.14), which moves more than this share of the rays.
pub(super) const LEAST_GAIN: f64 = 0.01;

/// Pairs of rows are refined if their best on the grid is within this of the best of all: more than the fraction changes
/// between neighbouring curvatures of the grid at a maximum, which is a cusp where the edge of the region cuts off the
/// rim's rays on one side and those from halfway out on the other (0.04 for the published target).
const WORTH_REFINING: f64 = 0.1;

/// On the side of the caustic the fraction falls like a square root: to have 1e-5 of it takes 1e-10 of the curvature.
const CURVATURE: f64 = 1e-10;

/// By the same root a curvature to 1e-4 leaves 1e-2 of the fraction open; three times that for its factor.
const WORTH_FINISHING: f64 = 0.03;

/// How finely to search.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grid {
    /// Rays in the fan for the grid
    scan_rays: usize,
    /// Rays in the fan for refining
    pub rays: usize,
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
    pub(super) fn fine(family: Family) -> Self {
        match family {
            Family::PlanoConvex => Self {
                scan_rays: 96,
                rays: 256,
                curvatures: 32,
                rows: 40,
                refine: true,
                most: usize::MAX,
                curvature: CURVATURE,
            },
            // A ray takes hundreds of steps through a graded slab.
            Family::Graded => {
                Self { scan_rays: 17, rays: 65, curvatures: 8, rows: 6, refine: true, most: 3, curvature: 1e-2 }
            }
            // Rays through any form take some hundred times as long as those of the fan.
            _ => Self { scan_rays: 33, rays: 129, curvatures: 10, rows: 8, refine: true, most: 6, curvature: 1e-3 },
        }
    }

    /// To find out whether there is any lens that helps.
    pub(super) fn coarse(family: Family) -> Self {
        match family {
            Family::PlanoConvex => {
                Self { scan_rays: 64, rays: 64, curvatures: 12, rows: 12, refine: false, ..Self::fine(family) }
            }
            _ => Self { scan_rays: 17, rays: 17, curvatures: 6, rows: 5, refine: false, ..Self::fine(family) },
        }
    }
}

/// What a lens is sought for, and within which limits.
#[derive(Clone, Debug)]
pub(super) struct Problem<'a> {
    pub lattice: &'a HexagonalSheet,
    pub family: Family,
    /// Of host and lens (m/s)
    pub speeds: [f64; 2],
    /// Of further materials (m/s)
    pub others: Vec<f64>,
    /// The strip that it may take (m): all of the half crystal, or what one of several foci is given
    pub window: [f64; 2],
    /// Where the lens's own axis lies (m)
    pub axis: f64,
    pub stages: u32,
    /// Whether it is a sheet's or a body of revolution
    pub symmetry: Symmetry,
    /// Distances from the axis between which rays shall pass or, of a shield, shall not (m)
    pub region: [f64; 2],
    /// Depth at which they shall (m)
    pub depth: f64,
    /// The same as a row
    pub mid_row: f64,
    /// Number of rows of the region
    pub region_rows: u32,
    /// Last row that the lens may reach, in front of the focal region; 0 if there is none
    pub last_free_row: u32,
    pub rows: [u32; 2],
    pub max_angle: f64,
    pub apex_row: Option<u32>,
    pub back_row: Option<u32>,
    pub radius: Option<f64>,
}

/// A lens and the fraction that it sends through the region.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Candidate {
    pub shape: Shape,
    pub fraction: f64,
}

impl<'a> Problem<'a> {
    /// One lens for the target's only focus or, of a shield, for its protected region.
    pub(super) fn new(lattice: &'a HexagonalSheet, speeds: [f64; 2], request: &LensRequest, target: &Target) -> Self {
        let family = request.family;
        let region = if family == Family::Shield { &target.protect } else { &target.foci[0].region };
        let axis = match family {
            Family::PlanoConvex => 0.0,
            _ => aim(region, lattice),
        };
        let whole = [0.0, lattice.half_width()];
        Self::of(lattice, speeds, request, target, region, whole, request.axis.unwrap_or(axis))
    }

    /// The part of a lens for one of several foci that is given a strip of the width.
    pub(super) fn part(
        lattice: &'a HexagonalSheet,
        speeds: [f64; 2],
        request: &LensRequest,
        target: &Target,
        strip: &Strip,
    ) -> Self {
        let region = &target.foci[strip.foci[0]].region;
        Self::of(lattice, speeds, request, target, region, strip.window, aim(region, lattice))
    }

    fn of(
        lattice: &'a HexagonalSheet,
        speeds: [f64; 2],
        request: &LensRequest,
        target: &Target,
        region: &Region,
        window: [f64; 2],
        axis: f64,
    ) -> Self {
        let family = request.family;
        // No lens may lie in a focal region, nor a shield in the protected one.
        let first = region.rows[0].min(target.focal_rows()[0]);
        Self {
            lattice,
            family,
            speeds,
            others: Vec::new(),
            window,
            axis,
            stages: request.stages,
            symmetry: Symmetry::Plane,
            region: region.x,
            depth: lattice.depth(region.mid_row()),
            mid_row: region.mid_row(),
            region_rows: region.rows[1] - region.rows[0] + 1,
            last_free_row: first - 1,
            rows: request.rows,
            max_angle: request.max_interface_angle,
            apex_row: request.apex_row,
            back_row: request.back_row,
            radius: request.radius.filter(|_| family.radius().is_some()),
        }
    }

    /// Whether the fan for plano-convex lenses on the axis serves.
    pub(super) fn is_fast(&self) -> bool {
        self.family == Family::PlanoConvex
            && self.axis == 0.0
            && self.window == [0.0, self.lattice.half_width()]
            && self.symmetry == Symmetry::Plane
    }

    pub(super) fn fan(&self, grid: Grid, max_angle: f64) -> Fan {
        Fan::new(grid.rays, max_angle, self.speeds)
    }

    /// Speeds (m/s) of host, lens and further materials.
    pub(super) fn palette_speeds(&self) -> Vec<f64> {
        self.speeds.iter().chain(&self.others).copied().collect()
    }

    pub(super) fn surrounds<'s>(&self, speeds: &'s [f64]) -> Surrounds<'s> {
        let end = self.lattice.depth(f64::from(self.lattice.rows()));
        Surrounds { speeds, half_width: self.lattice.half_width(), end }
    }

    fn place(&self, rows: [u32; 2]) -> Place {
        Place {
            depth: rows.map(|row| self.lattice.depth(f64::from(row))),
            spacing: self.lattice.row_spacing(),
            window: self.window,
            axis: self.axis,
            focus: self.depth,
            speeds: self.graded_speeds(),
            max_angle: self.max_angle,
            stages: self.stages,
            others: self.others.len() as u32,
        }
    }

    /// Host and lens; of a graded lens the slowest of all.
    fn graded_speeds(&self) -> [f64; 2] {
        let slowest = self.others.iter().copied().fold(self.speeds[1], f64::min);
        if self.family == Family::Graded { [self.speeds[0], slowest] } else { self.speeds }
    }

    /// The form between two rows; none if there is none within the limits.
    pub(super) fn form(&self, rows: [u32; 2], curvature: f64) -> Option<Form> {
        if rows[1] - rows[0] < self.family.least_span(self.stages) {
            return None;
        }
        self.family.form(&self.place(rows), curvature)
    }

    /// What part of the struck width, or of its strip, is served: passes the region or, of a shield, does not.
    fn served(&self, rows: [u32; 2], curvature: f64, rays: usize) -> f64 {
        let Some(form) = self.form(rows, curvature) else { return 0.0 };
        let speeds = self.palette_speeds();
        let passing = passing(
            &*form.optics(self.surrounds(&speeds)),
            self.window,
            &[(self.depth, self.region)],
            rays,
            self.symmetry,
        );
        if self.family == Family::Shield { 1.0 - passing } else { passing }
    }

    /// Number of sites that a form covers.
    fn count(&self, shape: &Shape) -> usize {
        if self.is_fast() {
            return shape.count(self.lattice);
        }
        let Some(form) = self.form([shape.apex_row, shape.back_row], 1.0 / shape.radius) else { return usize::MAX };
        let slack = 1e-9 * self.lattice.diameter();
        self.lattice.sites().iter().filter(|site| form.at([site.x, site.z], slack) != 0).count()
    }

    /// Fraction without a lens.
    pub(super) fn without(&self) -> f64 {
        let passing = without(&[self.region], self.window, self.symmetry);
        if self.family == Family::Shield { 1.0 - passing } else { passing }
    }

    /// Whether a lens does more than none.
    pub(super) fn gains(&self, candidate: &Candidate) -> bool {
        candidate.fraction > self.without() + LEAST_GAIN
    }

    /// Whether a lens of these materials may serve at all: what gathers does so only if it is slower than its host.
    pub(super) fn may_gain(&self) -> bool {
        matches!(self.family, Family::PlanoConcave | Family::Prism | Family::Shield) || self.speeds[1] < self.speeds[0]
    }

    /// Apex and back rows that may be tried.
    fn row_ranges(&self) -> [[u32; 2]; 2] {
        let last = self.rows[1].min(self.last_free_row);
        let fixed_or = |fixed: Option<u32>, range| fixed.map_or(range, |row| [row, row]);
        [fixed_or(self.apex_row, [self.rows[0], last]), fixed_or(self.back_row, [self.rows[0], last])]
    }

    /// The best lens that the limits allow; none if they allow none.
    pub(super) fn best(&self, grid: Grid) -> Option<Candidate> {
        let rays = |count| match self.is_fast() {
            true => Rays::Fan(Fan::new(count, self.max_angle, self.speeds)),
            false => Rays::Traced(count),
        };
        Search {
            problem: self,
            scan_rays: rays(grid.scan_rays),
            rays: rays(grid.rays),
            grid,
            known: RefCell::default(),
        }
        .run()
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
}

/// By what rays are followed.
enum Rays {
    /// The fan for plano-convex lenses on the axis
    Fan(Fan),
    /// So many rays through any form
    Traced(usize),
}

/// Where a lens stands by itself, and a part of one aims: on a mirror line that the region touches, or in its middle.
pub(super) fn aim(region: &Region, lattice: &HexagonalSheet) -> f64 {
    let near = 0.75 * lattice.diameter();
    match region.x {
        [low, _] if low <= near => 0.0,
        [_, high] if high >= lattice.half_width() - near => lattice.half_width(),
        [low, high] => 0.5 * (low + high),
    }
}

/// Curvatures of one pair of rows, and the fraction at each by the coarser fan.
struct Scan {
    rows: [u32; 2],
    curvatures: Vec<f64>,
    fractions: Vec<f64>,
    best: usize,
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
                let bench = shape.bench(self.problem.lattice, self.problem.speeds);
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

    fn scan(&self, rows: [u32; 2]) -> Option<Scan> {
        let problem = self.problem;
        if rows[1] - rows[0] < problem.family.least_span(problem.stages) {
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
        let scans: Vec<Scan> = pairs.filter_map(|rows| self.scan(rows)).collect();
        let best_of_grid = scans.iter().map(|scan| scan.fractions[scan.best]).max_by(f64::total_cmp)?;
        if !self.grid.refine || self.problem.radius.is_some() {
            return self.choose(scans.iter().map(|scan| (scan, scan.curvatures[scan.best])).collect());
        }
        let mut worth: Vec<&Scan> =
            scans.iter().filter(|scan| scan.fractions[scan.best] >= best_of_grid - WORTH_REFINING).collect();
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
            match self.choose(scans.iter().map(|scan| (scan, self.refine(scan, self.grid.curvature))).collect()) {
                Some(better) if better.shape != best.shape && self.is_better(&better, &best) => best = better,
                _ => return best,
            }
        }
    }

    fn is_better(&self, new: &Candidate, old: &Candidate) -> bool {
        let gain = new.fraction - old.fraction;
        let problem = self.problem;
        gain > TIE || (gain >= 0.0 && problem.count(&new.shape) < problem.count(&old.shape))
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
    fn choose(&self, refined: Vec<(&Scan, f64)>) -> Option<Candidate> {
        let candidates: Vec<(&Scan, f64, f64)> =
            refined.into_iter().map(|(scan, c)| (scan, c, self.fraction(scan.rows, c))).collect();
        let best = candidates.iter().map(|c| c.2).max_by(f64::total_cmp)?;
        let equal = candidates.into_iter().filter(|c| c.2 >= best - TIE);
        equal
            .map(|(scan, curvature, _)| self.candidate(scan.rows, self.most_curved(scan, curvature, best - TIE)))
            .min_by_key(|c| (self.problem.count(&c.shape), c.shape.back_row, c.shape.apex_row))
    }

    /// The greatest curvature that still sends `least` through: the front then cuts off most sites.
    fn most_curved(&self, scan: &Scan, curvature: f64, least: f64) -> f64 {
        if !self.problem.family.is_curved() {
            return curvature;
        }
        let last_good = (0..scan.curvatures.len())
            .rev()
            .find(|&k| scan.curvatures[k] >= curvature && self.fraction(scan.rows, scan.curvatures[k]) >= least);
        let mut low = last_good.map_or(curvature, |k| scan.curvatures[k]);
        let Some(&beyond) = scan.curvatures.iter().find(|&&c| c > low) else { return low };
        let mut high = beyond;
        // 30 halvings of a 32nd of the range: far below what moves a site.
        for _ in 0..30 {
            let middle = 0.5 * (low + high);
            *(if self.fraction(scan.rows, middle) >= least { &mut low } else { &mut high }) = middle;
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
