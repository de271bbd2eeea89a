//! What Burgoyne (2016, section 5.3.3) says of an impact lens, measured on this outcome.
//!
//! The statements are about one lens under one impact, and are judged on no other: of other designs nothing is claimed.

use serde::Serialize;

use super::digits::{short, significant};
use super::maps::at;
use super::profiles::{random_kinds, rows, sites_of};
use crate::outcome::{ArrangementOutcome, Outcome};
use crate::target::Region;

/// A published statement and what was measured.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Claim {
    /// The statement.
    pub claim: &'static str,
    /// Where it is made.
    pub source: &'static str,
    /// What holds here, with numbers.
    pub measured: String,
    /// Whether it holds here.
    pub holds: bool,
}

/// Every claim that this outcome can decide; those whose baseline was not run are left out.
pub fn claims(outcome: &Outcome) -> Vec<Claim> {
    let Some(lens) = outcome.arrangements.first().filter(|_| outcome.is_published) else { return Vec::new() };
    let views: Vec<View> =
        (0..outcome.target.foci.len()).map(|focus| View { outcome, lens, focus, rows: rows(outcome, focus) }).collect();
    [
        at_each(&views, View::peak_in_focus),
        at_each(&views, View::focusing_by_row),
        of_all(&views, View::raised_focus),
        at_each(&views, View::lowest_opposite),
        at_each(&views, View::as_low_as_random),
        at_each(&views, View::random_range),
        at_each(&views, View::below_lens_material_behind),
        of_all(&views, View::more_dissipated),
        at_each(&views, View::dissipation_follows_focus),
        of_all(&views, View::estimate_of_dissipation),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// A claim about the lens as a whole.
fn of_all<'a>(views: &[View<'a>], claim: fn(&View<'a>) -> Option<Claim>) -> Option<Claim> {
    views.first().and_then(claim)
}

/// What was measured at each focus as one: it holds if it does at all of them. None if it cannot be decided at one.
fn at_each<'a>(views: &[View<'a>], claim: fn(&View<'a>) -> Option<Claim>) -> Option<Claim> {
    let claims: Vec<Claim> = views.iter().map(claim).collect::<Option<_>>()?;
    if claims.len() < 2 {
        return claims.into_iter().next();
    }
    let measured = claims.iter().enumerate().map(|(k, claim)| format!("Focus {}: {}", k + 1, claim.measured));
    Some(Claim {
        measured: measured.collect::<Vec<_>>().join(" "),
        holds: claims.iter().all(|claim| claim.holds),
        ..*claims.first()?
    })
}

struct View<'a> {
    outcome: &'a Outcome,
    lens: &'a ArrangementOutcome,
    /// Which of the foci.
    focus: usize,
    /// Rows before, in and behind the focus.
    rows: [u32; 3],
}

impl View<'_> {
    fn kind(&self, kind: &str) -> Option<&ArrangementOutcome> {
        self.outcome.arrangements.iter().find(|a| a.kind == kind)
    }

    /// Sites of a row with their greatest kinetic energies.
    fn row(&self, arrangement: &ArrangementOutcome, row: u32) -> Vec<(f64, f64)> {
        let list = &arrangement.record.max_kinetic;
        let sites = sites_of(self.outcome, row).into_iter();
        sites.filter_map(|i| Some((self.outcome.sites[i].x / self.outcome.diameter, at(list, i)?))).collect()
    }

    /// The focal region.
    fn focus(&self) -> &Region {
        &self.outcome.target.foci[self.focus].region
    }

    /// The values of a row within a region's range of x.
    fn within(&self, arrangement: &ArrangementOutcome, row: u32, region: &Region) -> Vec<f64> {
        let range = region.x.map(|x| x / self.outcome.diameter);
        let inside = |x: f64| x >= range[0] - 1e-9 && x <= range[1] + 1e-9;
        self.row(arrangement, row).into_iter().filter(|p| inside(p.0)).map(|p| p.1).collect()
    }

    fn peak_in_focus(&self) -> Option<Claim> {
        let row = self.row(self.lens, self.rows[1]);
        let &(x, peak) = row.iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
        let nearest = row.iter().map(|p| p.0).fold(f64::MAX, f64::min);
        let inside = self.focus().x.map(|x| x / self.outcome.diameter);
        let whether = if x <= nearest { ", the sphere nearest the axis" } else { "" };
        Some(Claim {
            claim: "A very clear peak of the kinetic energy within the focal region.",
            source: "fig 5.21c",
            measured: format!(
                "In row {} the greatest value, {} J, is at x = {} D{whether}.",
                self.rows[1],
                significant(peak, 3),
                short(x)
            ),
            holds: x >= inside[0] - 1e-9 && x <= inside[1] + 1e-9,
        })
    }

    fn focusing_by_row(&self) -> Option<Claim> {
        let ratio = |row: u32| {
            let focal = mean(&self.within(self.lens, row, self.focus()))?;
            let protected = mean(&self.within(self.lens, row, &self.outcome.target.protect))?;
            (protected > 0.0).then(|| focal / protected)
        };
        let [before, at, behind] = self.rows;
        let ratios = [ratio(before)?, ratio(at)?, ratio(behind)?];
        Some(Claim {
            claim: "Energy gathers at the focus; behind it the wave diverges and becomes more even.",
            source: "figs 5.21b to d",
            measured: format!(
                "Focal over protected range of x: {:.2} in row {before}, {:.2} in row {at}, {:.2} in row {behind}.",
                ratios[0], ratios[1], ratios[2]
            ),
            holds: ratios[1] > ratios[0] && ratios[1] > ratios[2],
        })
    }

    fn raised_focus(&self) -> Option<Claim> {
        let host = self.kind("all-host")?;
        let gain = self.lens.scores.focal_gain.filter(|g| g.is_finite())?;
        Some(Claim {
            claim: "The lens directs significant portions of the energy to the focus: more arrives there than without it.",
            source: "section 5.3.3",
            measured: format!(
                "F = {} J with the lens and {} J in the host alone: G = {gain:.3}. P = {} J and {} J.{}",
                significant(self.lens.scores.focal_mean, 3),
                significant(host.scores.focal_mean, 3),
                significant(self.lens.scores.protected_mean, 3),
                significant(host.scores.protected_mean, 3),
                if gain <= 1.0 && self.lens.scores.contrast.is_some_and(|c| c > 1.0) {
                    " This lens focuses by lowering the rest, not by raising the focus."
                } else {
                    ""
                }
            ),
            holds: gain > 1.0,
        })
    }

    fn lowest_opposite(&self) -> Option<Claim> {
        let lowest = |a: &ArrangementOutcome| least(&self.within(a, self.rows[1], &self.outcome.target.protect));
        let own = lowest(self.lens)?;
        let others: Vec<(&str, f64)> = self
            .outcome
            .arrangements
            .iter()
            .skip(1)
            .filter(|a| a.seed.is_none())
            .filter_map(|a| Some((a.name.as_str(), lowest(a)?)))
            .collect();
        let least = others.iter().map(|o| o.1).min_by(f64::total_cmp)?;
        let list: Vec<String> = others.iter().map(|(name, v)| format!("{name} {}", significant(*v, 3))).collect();
        Some(Claim {
            claim: "The minimum on the side opposite the focus is lower than there in any uniform or flat arrangement.",
            source: "fig 5.21c",
            measured: format!(
                "Row {}, protected range: lens {} J; {} J.",
                self.rows[1],
                significant(own, 3),
                list.join(", ")
            ),
            holds: own < least,
        })
    }

    /// All values of a row over the seeds of the mixture that fills everything behind the lens's front.
    fn random_row(&self) -> Option<(usize, Vec<f64>)> {
        let (_, members) = random_kinds(self.outcome).into_iter().find(|(kind, _)| *kind == "random-behind")?;
        let all: Vec<f64> = members.iter().flat_map(|m| self.row(m, self.rows[1])).map(|p| p.1).collect();
        (!all.is_empty()).then_some((members.len(), all))
    }

    fn as_low_as_random(&self) -> Option<Claim> {
        let (seeds, all) = self.random_row()?;
        let own = least(&self.row(self.lens, self.rows[1]).iter().map(|p| p.1).collect::<Vec<_>>())?;
        let lowest = least(&all)?;
        let ratio = (lowest > 0.0).then(|| own / lowest)?;
        Some(Claim {
            claim: "The minimum of the random arrangements in the focal row almost exactly matches that of the lens.",
            source: "fig 5.22c",
            measured: format!(
                "Lens {} J, lowest sphere of {seeds} seeds {} J: ratio {ratio:.2} (taken to match within 10 %).",
                significant(own, 3),
                significant(lowest, 3)
            ),
            holds: (ratio - 1.0).abs() <= 0.1,
        })
    }

    fn random_range(&self) -> Option<Claim> {
        let (seeds, all) = self.random_row()?;
        let (low, high) = (least(&all)?, all.iter().copied().fold(0.0, f64::max));
        let ratio = (low > 0.0).then(|| high / low)?;
        Some(Claim {
            claim: "The random arrangements' maximum in the focal row is nearly double their minimum.",
            source: "fig 5.22c",
            measured: format!(
                "{} to {} J over {seeds} seeds: ratio {ratio:.2} (taken to hold from 1.7 to 2.3; it depends on the seeds).",
                significant(low, 3),
                significant(high, 3)
            ),
            holds: (1.7..=2.3).contains(&ratio),
        })
    }

    fn below_lens_material_behind(&self) -> Option<Claim> {
        let uniform = self.row(self.kind("all-lens")?, self.rows[2]);
        let own = self.row(self.lens, self.rows[2]);
        let lower = own.iter().zip(&uniform).filter(|(a, b)| a.1 < b.1).count();
        let count = own.len().min(uniform.len());
        (count > 0).then(|| Claim {
            claim: "Behind the focus the energy stays lower in most places than in uniform lens material.",
            source: "fig 5.21d",
            measured: format!("Row {}: lower at {lower} of {count} spheres.", self.rows[2]),
            holds: 2 * lower > count,
        })
    }

    fn more_dissipated(&self) -> Option<Claim> {
        let uniform: Vec<_> = ["all-host", "all-lens"].into_iter().filter_map(|kind| self.kind(kind)).collect();
        let lost = |a: &ArrangementOutcome| a.scores.dissipated.unwrap_or(f64::NAN);
        let own = lost(self.lens);
        let share = |a: &ArrangementOutcome| a.scores.dissipation.unwrap_or(f64::NAN) * 100.0;
        let list: Vec<String> = uniform
            .iter()
            .map(|a| format!("{} {} J ({} %)", a.name, significant(lost(a), 4), significant(share(a), 3)))
            .collect();
        (!uniform.is_empty()).then(|| Claim {
            claim: "The lens dissipates more energy in all than the uniform arrangements.",
            source: "section 5.3.3",
            measured: format!(
                "Lens {} J ({} % of the work put in); {}.",
                significant(own, 4),
                significant(share(self.lens), 3),
                list.join(", ")
            ),
            holds: uniform.iter().all(|a| own > lost(a)),
        })
    }

    fn dissipation_follows_focus(&self) -> Option<Claim> {
        let region = |region: &Region| {
            let sites = self.outcome.sites.iter().enumerate();
            let inside = sites.filter(|(_, site)| region.contains(site, self.outcome.diameter));
            mean(&inside.filter_map(|(i, _)| at(&self.lens.record.dissipated, i)).collect::<Vec<_>>())
        };
        let (focal, protected) = (region(self.focus())?, region(&self.outcome.target.protect)?);
        let times = if protected > 0.0 { format!(", {:.1} times", focal / protected) } else { String::new() };
        Some(Claim {
            claim: "Significantly more energy is dissipated in the focal region, very little opposite it.",
            source: "fig 5.18a",
            measured: format!(
                "{} mJ per sphere in the focal region, {} mJ in the protected one{times} (taken to hold from 2 times).",
                significant(focal * 1e3, 3),
                significant(protected * 1e3, 3)
            ),
            holds: focal >= 2.0 * protected && focal > 0.0,
        })
    }

    fn estimate_of_dissipation(&self) -> Option<Claim> {
        let scores = &self.lens.scores;
        let (estimate, lost) = (scores.eq_5_6?, scores.dissipated?);
        (lost > 0.0).then(|| Claim {
            claim: "½ δ_max F_max approximates the energy dissipated at a contact.",
            source: "eq. 5.6",
            measured: format!(
                "Summed over contacts {} J, dissipated by the ledger {} J, put in {} J: the estimate is {:.2} times the loss (taken to hold within 10 %).",
                significant(estimate, 4),
                significant(lost, 4),
                significant(scores.work_in.unwrap_or(f64::NAN), 4),
                estimate / lost
            ),
            holds: (estimate / lost - 1.0).abs() <= 0.1,
        })
    }
}

fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

fn least(values: &[f64]) -> Option<f64> {
    values.iter().copied().min_by(f64::total_cmp)
}
