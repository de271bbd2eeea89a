//! The network of forces: its components under either friction, and its loops against the intruder's deceleration.

use super::super::Wanted::Above;
use super::super::kondic::{pile, rubbing, settled, usual};
use super::super::{Part, Row, RowError, Verdict};
use super::{WINDOW, above, lower_end, watch};
use crate::Context;
use crate::bed::{Bed, Frame, Grains};
use crate::network::{Carrier, Part as Force, Topology};
use crate::stats::Mean;

pub(super) const ROWS: &[Row] = &[
    Row {
        id: "K-4-components",
        claim: "the network of normal forces has more components with static friction than with kinetic",
        source: "Kondic 2012, fig. 22",
        reason: "numbers of components, over thresholds 0 to 5 and time, bed by bed over four beds; the order is claimed",
        formula: false,
        expected: Verdict::Holds,
        seconds: 30.0,
        measure: components,
    },
    Row {
        id: "K-4-tangential-components",
        claim: "the network of tangential forces has more components with static friction than with kinetic",
        source: "Kondic 2012, fig. 23",
        reason: "as for normal forces; in multiples of the mean normal force",
        formula: false,
        expected: Verdict::Holds,
        seconds: 30.0,
        measure: tangential,
    },
    Row {
        id: "K-beyond-persistence",
        claim: "measures of the network's topology are clearly correlated with the dynamics of the intruder",
        source: "Takahashi, Clark, Majmudar and Kondic, PRE 97, 012906 (2018)",
        reason: "Pearson's r over frames from touch to stop between the loops' total persistence and the intruder's deceleration, mean over \
                 ten beds; clear: its 95 % interval lies above a half",
        formula: false,
        expected: Verdict::DoesNotHold,
        seconds: 60.0,
        measure: persistence,
    },
];

/// Topology of a frame's network; none of a frame without contacts.
fn topology(frame: &Frame, carrier: Carrier, part: Force, thresholds: &[f64]) -> Option<Topology> {
    let network = frame.network().ok().filter(|network| !network.contacts().is_empty())?;
    Topology::new(&network, carrier, part, thresholds.to_vec())
}

/// Mean number of components per grain over thresholds, of one bed: before and after this time (τ_c), over frames.
fn of_components(bed: &Bed, part: Force, grains: Grains, context: &Context) -> Result<[f64; 2], RowError> {
    const LATE: f64 = 60.0;
    let thresholds: Vec<f64> = (0..=25).map(|k| f64::from(k) / 5.0).collect();
    let (mut sums, mut counts) = ([0.0; 2], [0.0; 2]);
    watch(bed, grains, WINDOW, context, |moment, frame| {
        if let Some(found) = topology(frame, Carrier::Particles, part, &thresholds).filter(|_| moment.depth > 0.0) {
            let late = usize::from(moment.time > LATE);
            let number = found.components.iter().sum::<usize>() as f64 / thresholds.len() as f64;
            sums[late] += number / bed.grains.len() as f64;
            counts[late] += 1.0;
        }
    })?;
    Ok([sums[0] / counts[0], sums[1] / counts[1]])
}

fn more_components(part: Force, context: &Context) -> Result<Vec<Part>, RowError> {
    let mut over: [Vec<f64>; 2] = Default::default();
    for bed in usual(context)? {
        let kinetic = of_components(&bed, part, rubbing(0.5, 0.0), context)?;
        let fixed = of_components(&bed, part, rubbing(0.5, 0.8), context)?;
        for (k, over) in over.iter_mut().enumerate() {
            over.push(fixed[k] / kinetic[k]);
        }
    }
    let [early, late] = over;
    let of = |when: &str, over: &[f64]| above(&format!("static over kinetic, {when}"), "more", over, 1.0);
    Ok(of("up to 60 τ_c", &early).into_iter().chain(of("60 to 120 τ_c", &late)).collect())
}

fn components(context: &Context) -> Result<Vec<Part>, RowError> {
    more_components(Force::Normal, context)
}

fn tangential(context: &Context) -> Result<Vec<Part>, RowError> {
    more_components(Force::Tangential, context)
}

/// Pearson's correlation of two columns.
pub(super) fn pearson(rows: &[[f64; 2]]) -> f64 {
    let count = rows.len() as f64;
    let mean: [f64; 2] = std::array::from_fn(|k| rows.iter().map(|row| row[k]).sum::<f64>() / count);
    let of = |i: usize, k: usize| rows.iter().map(|row| (row[i] - mean[i]) * (row[k] - mean[k])).sum::<f64>();
    of(0, 1) / (of(0, 0) * of(1, 1)).sqrt()
}

fn persistence(context: &Context) -> Result<Vec<Part>, RowError> {
    // In force, and in multiples of the mean.
    let mut found: [Vec<f64>; 2] = Default::default();
    for seed in 1..=10 {
        let bed = settled(pile(0.2, 60.0, seed), context)?;
        let (mut absolute, mut relative) = (Vec::new(), Vec::new());
        let mut stopped = false;
        watch(&bed, rubbing(0.5, 0.0), 60.0, context, |moment, frame| {
            stopped |= moment.depth > 0.0 && moment.velocity[1] >= 0.0;
            if moment.depth <= 0.0 || stopped {
                return;
            }
            if let Some(topology) = topology(frame, Carrier::Contacts, Force::Normal, &[0.0]) {
                let total = Topology::total_persistence(&topology.persistence1);
                absolute.push([total * topology.mean_force, moment.force[1]]);
                relative.push([total, moment.force[1]]);
            }
        })?;
        found[0].push(pearson(&absolute));
        found[1].push(pearson(&relative));
    }
    let of = |what: &str, values: &[f64]| {
        [
            Part::words(format!("mean r, persistence {what}"), "clear", Mean::of(values).mean, "", Above(0.5)),
            Part::words(format!("its lower end, {what}"), "clear", lower_end(values), "", Above(0.5)),
        ]
    };
    Ok(of("in force", &found[0]).into_iter().chain(of("in multiples of the mean force", &found[1])).collect())
}
