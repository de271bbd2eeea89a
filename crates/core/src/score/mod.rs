//! What was recorded against what was wanted.
//!
//! - `measure`: the one table of what can be measured, and the scores that hold the values; here: how they come from a record
//! - `spread`: one score of several runs

mod measure;
mod spread;

pub use measure::{Better, Measure, Needs, Scores, Unit};
pub use spread::{Spreads, geometric, over_forces};

use crate::dem::Record;
use crate::lattice::HexagonalSheet;
use crate::layout::LayoutStats;
use crate::target::{Target, TargetSites};

/// Mean over sites; none where there are none.
fn mean(values: &[f64], sites: &[usize]) -> Option<f64> {
    (!sites.is_empty()).then(|| sites.iter().map(|&i| values[i]).sum::<f64>() / sites.len() as f64)
}

/// F and P: means over all focal regions, taken together, and over the protected one of each sphere's maximum kinetic energy (J).
pub fn means(max_kinetic: &[f64], lattice: &HexagonalSheet, target: &Target) -> [f64; 2] {
    [target.focal_sites(lattice), target.protect.sites(lattice)].map(|sites| mean(max_kinetic, &sites).unwrap_or(0.0))
}

/// The same mean over each focal region by itself (J), in the order of the target.
pub fn focal_means(max_kinetic: &[f64], lattice: &HexagonalSheet, target: &Target) -> Vec<f64> {
    target.foci.iter().map(|focus| mean(max_kinetic, &focus.region.sites(lattice)).unwrap_or(0.0)).collect()
}

/// How evenly the foci have been served: of their `means`, each over its share, the least over the greatest. 1 where all are
/// as their shares, 0 where one has nothing; none with a single focus.
pub fn balance(means: &[f64], shares: &[f64]) -> Option<f64> {
    let each = || means.iter().zip(shares).map(|(mean, share)| mean / share);
    let [least, most] = [each().reduce(f64::min)?, each().reduce(f64::max)?];
    if means.len() > 1 { ratio(least, most) } else { None }
}

/// `a` over `b`, where `b` is not zero.
pub fn ratio(a: f64, b: f64) -> Option<f64> {
    (b > 0.0).then(|| a / b)
}

impl Scores {
    /// What each site's greatest kinetic energy says: F, P, C, and how evenly several foci are served. Ratios to uniform crystals
    /// follow by [`relate`](Self::relate).
    pub fn of_energies(max_kinetic: &[f64], lattice: &HexagonalSheet, target: &Target) -> Self {
        Self::of_sites(max_kinetic, &target.on(lattice))
    }

    /// The same, with the sites of the target's regions, in any dimension.
    pub fn of_sites(max_kinetic: &[f64], sites: &TargetSites) -> Self {
        let over = |sites: &[usize]| mean(max_kinetic, sites).unwrap_or(0.0);
        let (focal_mean, protected_mean) = (over(&sites.focal), over(&sites.protected));
        let foci: Vec<f64> = sites.foci.iter().map(|(sites, _)| over(sites)).collect();
        let shares: Vec<f64> = sites.foci.iter().map(|(_, share)| *share).collect();
        Self {
            focal_mean,
            protected_mean,
            contrast: ratio(focal_mean, protected_mean),
            balance: balance(&foci, &shares),
            foci: if foci.len() > 1 { foci } else { Vec::new() },
            ..Self::default()
        }
    }

    /// Adds what full records say. `on` names the spheres that stand on a site of the half, one twice where only the half is
    /// simulated; `share` is the part of what was simulated that the half is; `mass` is that of a sphere (kg).
    pub fn add_records<const D: usize>(
        &mut self,
        record: &Record<D>,
        sites: &TargetSites,
        on: impl Fn(usize) -> [usize; 2],
        share: f64,
        mass: impl Fn(usize) -> f64,
    ) {
        let regions =
            [&sites.focal, &sites.protected].map(|sites| sites.iter().flat_map(|&i| on(i)).collect::<Vec<usize>>());
        let momentum = |spheres: &Vec<usize>| {
            let of: Vec<f64> = spheres.iter().map(|&i| (2.0 * mass(i) * record.max_kinetic[i]).sqrt()).collect();
            if of.is_empty() { 0.0 } else { of.iter().sum::<f64>() / of.len() as f64 }
        };
        let force = |spheres: &Vec<usize>| spheres.iter().map(|&i| record.max_contact_force[i]).fold(0.0, f64::max);
        let arrival = |spheres: &Vec<usize>| spheres.iter().filter_map(|&i| record.arrival[i]).reduce(f64::min);
        let [focal, protected] = &regions;
        (self.focal_momentum, self.protected_momentum) = (Some(momentum(focal)), Some(momentum(protected)));
        (self.focal_force, self.protected_force) = (Some(force(focal)), Some(force(protected)));
        (self.focal_arrival, self.protected_arrival) = (arrival(focal), arrival(protected));
        (self.far_momentum, self.far_force) = (Some(share * record.exit_momentum), Some(share * record.exit_force));
        // Of the half first, so that parts are the same bits of whatever was simulated.
        let ledger = record.ledger.times(share);
        self.dissipation = Some(ratio(ledger.dissipated, ledger.work_in).unwrap_or(0.0));
        self.work_in = Some(ledger.work_in);
        self.kinetic = Some(ledger.kinetic);
        self.stored = Some(ledger.stored);
        self.dissipated = Some(ledger.dissipated);
        self.residual = Some(ledger.residual().unwrap_or(0.0));
        self.eq_5_6 = Some(ledger.estimate);
    }

    /// Adds what the layout itself says.
    pub fn add_layout(&mut self, stats: &LayoutStats) {
        let LayoutStats { half, piece, lone, islands } = stats;
        (self.half_mass, self.half_cost, self.half_spheres) = (Some(half.mass), half.cost, Some(half.spheres));
        (self.piece_mass, self.piece_cost, self.piece_spheres) = (Some(piece.mass), piece.cost, Some(piece.spheres));
        (self.lone, self.islands) = (*lone, Some(*islands));
    }

    /// Adds G = F/F(host alone) and Q = P/P(lens material alone), each where its denominator is known.
    pub fn relate(&mut self, host_focal_mean: Option<f64>, lens_protected_mean: Option<f64>) {
        self.focal_gain = host_focal_mean.and_then(|host| ratio(self.focal_mean, host));
        self.protection = lens_protected_mean.and_then(|lens| ratio(self.protected_mean, lens));
    }
}
