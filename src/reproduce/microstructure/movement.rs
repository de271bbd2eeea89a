//! How grains move, and where the energy goes.

use std::sync::Arc;

use super::super::Wanted::{Above, Below};
use super::super::kondic::{lattice, rubbing, settled, usual};
use super::super::{Part, Row, RowError, Verdict};
use super::{EVERY, WINDOW, above, watch};
use crate::Context;
use crate::bed::{Bed, Grains};
use crate::motion::{RADIUS, follow};

pub(super) const ROWS: &[Row] = &[
    Row {
        id: "K-4-motion",
        claim: "affine and non-affine motion are stronger with kinetic friction than with static",
        source: "Kondic 2012, figs 24, 25",
        reason: "means over four beds, grains and intervals of 2 τ_c from the impact on; the order is claimed",
        formula: false,
        expected: Verdict::Holds,
        seconds: 30.0,
        measure: motion,
    },
    Row {
        id: "K-4-motion-hexagonal",
        claim: "on hexagonal beds too, affine and non-affine motion are stronger with kinetic friction",
        source: "Kondic 2012, figs 26, 27",
        reason: "means over grains and intervals of 2 τ_c while the intruder is in the bed; the order is claimed",
        formula: false,
        expected: Verdict::HoldsInPart,
        seconds: 10.0,
        measure: motion_hexagonal,
    },
    Row {
        id: "K-5-energy",
        claim: "energy decreases all the time, faster with friction, kinetic energy too; the exchange of potential and elastic energy goes on \
                longer than there is kinetic energy",
        source: "Kondic 2012, fig. 28",
        reason: "no rise above 10⁻³ of what was there at first, over four beds; what is left, kinetic and in all, 40 τ_c after the start",
        formula: false,
        expected: Verdict::Holds,
        seconds: 20.0,
        measure: energy,
    },
];

/// Mean D²_min (d²) and mean size of A·u (d), u a grain's displacement over the interval, from the first touch on.
fn moved(bed: &Bed, grains: Grains, window: f64, context: &Context) -> Result<[f64; 2], RowError> {
    let (mut sums, mut count) = ([0.0; 2], 0.0);
    let mut before: Option<Vec<[f64; 2]>> = None;
    let period = bed.periodic.then_some(bed.width);
    watch(bed, grains, window, context, |moment, frame| {
        let after = frame.places();
        if let Some(before) = before.take().filter(|_| moment.depth > 0.0) {
            for (k, local) in follow(&before, &after, RADIUS, period).into_iter().flatten().enumerate() {
                let (Some(d2min), Some(map)) = (local.d2min, local.map) else { continue };
                let u = [after[k][0] - before[k][0], after[k][1] - before[k][1]];
                let along = map.map(|row| row[0] * u[0] + row[1] * u[1]);
                sums[0] += d2min;
                sums[1] += along[0].hypot(along[1]);
                count += 1.0;
            }
        }
        before = Some(after);
    })?;
    Ok(sums.map(|sum| sum / count))
}

fn compared(beds: &[Arc<Bed>], window: f64, context: &Context) -> Result<[Vec<f64>; 2], RowError> {
    let mut over: [Vec<f64>; 2] = Default::default();
    for bed in beds {
        let kinetic = moved(bed, rubbing(0.5, 0.0), window, context)?;
        let fixed = moved(bed, rubbing(0.5, 0.8), window, context)?;
        for (k, over) in over.iter_mut().enumerate() {
            over.push(kinetic[k] / fixed[k]);
        }
    }
    Ok(over)
}

const NON_AFFINE: &str = "D²_min, kinetic over static";
const AFFINE: &str = "affine motion, kinetic over static";

fn motion(context: &Context) -> Result<Vec<Part>, RowError> {
    let [non_affine, affine] = compared(&usual(context)?, WINDOW, context)?;
    let parts = [above(NON_AFFINE, "stronger", &non_affine, 1.0), above(AFFINE, "stronger", &affine, 1.0)];
    Ok(parts.concat())
}

fn motion_hexagonal(context: &Context) -> Result<Vec<Part>, RowError> {
    let [non_affine, affine] = compared(&[settled(lattice(), context)?], 60.0, context)?;
    Ok(vec![
        Part::words(NON_AFFINE, "much stronger", non_affine[0], "", Above(1.0)),
        Part::words(AFFINE, "stronger", affine[0], "", Above(1.0)),
    ])
}

fn energy(context: &Context) -> Result<Vec<Part>, RowError> {
    const WHEN: f64 = 40.0;
    let beds = usual(context)?;
    let mut rise = 0.0_f64;
    // Of all energy, and of the kinetic one, what is left then of what was there at first.
    let mut left = [[0.0; 2]; 3];
    // How far potential and elastic energy swing at the end, over the kinetic energy there.
    let mut swing = 0.0;
    for (left, grains) in left.iter_mut().zip([rubbing(0.0, 0.0), rubbing(0.5, 0.0), rubbing(0.5, 0.8)]) {
        for bed in &beds {
            let (mut last, mut first) = (f64::INFINITY, None);
            let (mut least, mut most, mut moving) = (f64::INFINITY, f64::NEG_INFINITY, 0.0_f64);
            let part = 1.0 / beds.len() as f64;
            watch(bed, grains, WINDOW, context, |moment, _| {
                let e = &moment.energy;
                let elastic = e.stored + e.tangential_stored;
                let total = e.kinetic + elastic + e.potential;
                let [all, kinetic] = *first.get_or_insert([total, e.kinetic]);
                rise = rise.max((total - last) / all);
                last = total;
                if (moment.time - WHEN).abs() < 0.5 * EVERY {
                    left[0] += part * total / all;
                    left[1] += part * e.kinetic / kinetic;
                }
                if moment.time > 0.5 * WINDOW {
                    (least, most) = (least.min(elastic), most.max(elastic));
                    moving = moving.max(e.kinetic);
                }
            })?;
            swing += part / 3.0 * (most - least) / moving;
        }
    }
    let [smooth, kinetic, fixed] = left;
    Ok(vec![
        Part::words("greatest rise over what was there", "monotonous decrease", rise, "", Below(1e-3)),
        Part::words("left after 40 τ_c, μ = 0.5 kinetic over μ = 0", "faster", kinetic[0] / smooth[0], "", Below(1.0)),
        Part::words("the same, static", "faster", fixed[0] / smooth[0], "", Below(1.0)),
        Part::words("kinetic energy left, kinetic over μ = 0", "faster", kinetic[1] / smooth[1], "", Below(1.0)),
        Part::words("the same, static", "faster", fixed[1] / smooth[1], "", Below(1.0)),
        Part::words("swing of elastic over kinetic energy after 60 τ_c", "persists", swing, "", Above(1.0)),
    ])
}
