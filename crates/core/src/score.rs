//! What was recorded against what was wanted.

use serde::{Deserialize, Serialize};

use crate::dem::Record;
use crate::lattice::HexagonalSheet;
use crate::target::Target;

/// Scores of one arrangement; `null` where a ratio has no denominator.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Scores {
    /// F: mean over the focal region, or all of them taken together, of each sphere's maximum kinetic energy (J).
    #[serde(rename = "focal_mean_J")]
    pub focal_mean: f64,
    /// The same over each focal region by itself (J); empty with a single one.
    #[serde(default, rename = "foci_mean_J", skip_serializing_if = "Vec::is_empty")]
    pub foci: Vec<f64>,
    /// How evenly the foci have been served, from 0 to 1: see [`balance`]; none with a single one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub balance: Option<f64>,
    /// P: the same over the protected region (J).
    #[serde(rename = "protected_mean_J")]
    pub protected_mean: f64,
    /// C = F/P
    pub contrast: Option<f64>,
    /// G = F / F of the all-host arrangement
    pub focal_gain: Option<f64>,
    /// Q = P / P of the all-lens-material arrangement
    pub protection: Option<f64>,
    /// P of the subject (the lens) / P of this arrangement: how well the subject protects against this baseline; below 1 it
    /// protects better.
    pub protected_ratio: Option<f64>,
    /// Work of the load (J).
    #[serde(rename = "work_in_J")]
    pub work_in: f64,
    /// Kinetic energy at the end (J).
    #[serde(rename = "kinetic_J")]
    pub kinetic: f64,
    /// Energy that the contacts would still give back at the end (J).
    #[serde(rename = "stored_J")]
    pub stored: f64,
    /// Work done on the contacts less what they store (J).
    #[serde(rename = "dissipated_J")]
    pub dissipated: f64,
    /// (work in − kinetic − stored − dissipated)/work in, signed
    pub residual: f64,
    /// Σ ½ δ_max F_max (Burgoyne 2016, eq. 5.6), which overestimates the dissipation (J).
    #[serde(rename = "eq_5_6_J")]
    pub eq_5_6: f64,
    /// Greatest momentum of the last row along z (kg m/s).
    #[serde(rename = "exit_momentum_kg_m_s")]
    pub exit_momentum: f64,
    /// Greatest total contact force on the last row along z (N).
    #[serde(rename = "exit_force_N")]
    pub exit_force: f64,
}

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
pub fn balance(means: &[f64], target: &Target) -> Option<f64> {
    let each = || means.iter().zip(&target.foci).map(|(mean, focus)| mean / focus.share);
    let [least, most] = [each().reduce(f64::min)?, each().reduce(f64::max)?];
    if means.len() > 1 { ratio(least, most) } else { None }
}

/// `a` over `b`, where `b` is not zero.
pub fn ratio(a: f64, b: f64) -> Option<f64> {
    (b > 0.0).then(|| a / b)
}

impl Scores {
    /// Scores one arrangement by itself; the ratios to baselines follow by [`relate`](Self::relate).
    pub fn new(record: &Record<2>, lattice: &HexagonalSheet, target: &Target) -> Self {
        let [focal_mean, protected_mean] = means(&record.max_kinetic, lattice, target);
        let ledger = &record.ledger;
        let foci = focal_means(&record.max_kinetic, lattice, target);
        Self {
            focal_mean,
            balance: balance(&foci, target),
            foci: if foci.len() > 1 { foci } else { Vec::new() },
            protected_mean,
            contrast: ratio(focal_mean, protected_mean),
            focal_gain: None,
            protection: None,
            protected_ratio: None,
            work_in: ledger.work_in,
            kinetic: ledger.kinetic,
            stored: ledger.stored,
            dissipated: ledger.dissipated,
            residual: ledger.residual().unwrap_or(0.0),
            eq_5_6: ledger.estimate,
            exit_momentum: record.exit_momentum,
            exit_force: record.exit_force,
        }
    }

    /// Adds G = F/F(all host), Q = P/P(all lens material) and P(subject)/P.
    pub fn relate(&mut self, subject: Option<&Scores>, all_host: Option<&Scores>, all_lens: Option<&Scores>) {
        self.protected_ratio = subject.and_then(|subject| ratio(subject.protected_mean, self.protected_mean));
        self.focal_gain = all_host.and_then(|host| ratio(self.focal_mean, host.focal_mean));
        self.protection = all_lens.and_then(|lens| ratio(self.protected_mean, lens.protected_mean));
    }
}
