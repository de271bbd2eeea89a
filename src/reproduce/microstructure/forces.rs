//! Forces between grains: chains before the impact, what friction does to them, and where the front runs.

use super::super::Wanted::{Above, Below};
use super::super::kondic::{lattice, rubbing, settled, usual};
use super::super::{Part, Row, RowError, Verdict};
use super::{above, of_each, ratios, watch};
use crate::Context;
use crate::bed::{Bed, Frame, Grains};
use crate::network::{ANGLE, Chains, Contact, Network, Part as Force};
use crate::search::Rng;
use crate::stats::Mean;

pub(super) const ROWS: &[Row] = &[
    Row {
        id: "K-4-chains",
        claim: "before the impact there are force chains, due to gravitational compaction",
        source: "Kondic 2012, section IV A, fig. 13a",
        reason: "more grains in chains than with the same forces shuffled among the contacts; forces that grow with depth: Pearson's r above \
                 a half",
        formula: false,
        expected: Verdict::Holds,
        seconds: 2.0,
        measure: chains,
    },
    Row {
        id: "K-4-tangential-force",
        claim: "static friction increases tangential forces significantly, and normal forces hardly, in disordered and hexagonal beds",
        source: "Kondic 2012, section IV A, figs 13 to 20",
        reason: "means over contacts and the 24 τ_c after the touch; significantly: by more than a quarter; hardly: within a tenth",
        formula: false,
        expected: Verdict::Holds,
        seconds: 15.0,
        measure: tangential_force,
    },
    Row {
        id: "K-4-peak-force",
        claim: "the force on the intruder is similar whatever the friction and the order, a little larger with static friction",
        source: "Kondic 2012, fig. 21",
        reason: "greatest force; similar: within a factor of one and a half",
        formula: false,
        expected: Verdict::Holds,
        seconds: 15.0,
        measure: peak_force,
    },
    Row {
        id: "K-4-front",
        claim: "the front is isotropic with disorder, and runs along rays in a hexagonal bed",
        source: "Kondic 2012, section IV A, figs 13, 17",
        reason: "greatest over mean of what the front adds to the grains' force in eleven directions below the impact, 6 to 14 d away: \
                 1 if isotropic; rays stand out by more than twice, disorder by less",
        formula: false,
        expected: Verdict::HoldsInPart,
        seconds: 10.0,
        measure: front,
    },
];

/// Time after which the front has gone through the bed (τ_c), and somewhat more.
const EARLY: f64 = 30.0;

/// Grains in chains over those with the forces shuffled, and Pearson's r of a grain's force and its depth.
fn chains(context: &Context) -> Result<Vec<Part>, RowError> {
    const SHUFFLES: u64 = 20;
    let beds = usual(context)?;
    let (mut over, mut with_depth) = (Vec::new(), Vec::new());
    for bed in &beds {
        watch(bed, rubbing(0.5, 0.0), 0.0, context, |_, frame| {
            let Ok(network) = frame.network() else { return };
            let Some(found) = in_chains(&network) else { return };
            let shuffled = (0..SHUFFLES).filter_map(|seed| in_chains(&shuffled(&network, seed)?)).sum::<f64>();
            over.push(found * SHUFFLES as f64 / shuffled);
            let forces = network.grain_forces(Force::Normal);
            let rows: Vec<[f64; 2]> =
                frame.places().iter().zip(&forces).map(|(place, &force)| [-place[1], force]).collect();
            with_depth.push(super::network::pearson(&rows));
        })?;
    }
    let mut parts = above("grains in chains, over shuffled forces", "chains", &over, 1.0).to_vec();
    parts.push(Part::words("r of force and depth", "compaction", Mean::of(&with_depth).mean, "", Above(0.5)));
    Ok(parts)
}

fn in_chains(network: &Network) -> Option<f64> {
    Some(Chains::new(network, ANGLE)?.chains.iter().map(Vec::len).sum::<usize>() as f64)
}

/// The same contacts, each with the forces of another.
fn shuffled(network: &Network, seed: u64) -> Option<Network> {
    let mut rng = Rng::new(seed);
    let mut order: Vec<usize> = (0..network.contacts().len()).collect();
    for k in (1..order.len()).rev() {
        order.swap(k, rng.below(k as u64 + 1) as usize);
    }
    let of = |(contact, &other): (&Contact, &usize)| {
        let Contact { normal, tangential, .. } = network.contacts()[other];
        Contact { normal, tangential, ..*contact }
    };
    let contacts = network.contacts().iter().zip(&order).map(of).collect();
    Network::new(network.grains(), contacts, network.branches().map(<[_]>::to_vec)).ok()
}

/// Mean sizes of normal and tangential forces over contacts and frames, from the touch on.
fn mean_forces(bed: &Bed, grains: Grains, context: &Context) -> Result<[f64; 2], RowError> {
    let (mut sums, mut count) = ([0.0; 2], 0.0);
    let of = |frame: &Frame, sums: &mut [f64; 2], count: &mut f64| {
        let Ok(network) = frame.network() else { return };
        for contact in network.contacts() {
            sums[0] += contact.normal.abs();
            sums[1] += contact.tangential.abs();
            *count += 1.0;
        }
    };
    watch(bed, grains, EARLY, context, |moment, frame| {
        if moment.depth > 0.0 {
            of(frame, &mut sums, &mut count);
        }
    })?;
    Ok(sums.map(|sum| sum / count))
}

fn tangential_force(context: &Context) -> Result<Vec<Part>, RowError> {
    let mut parts = Vec::new();
    for (name, beds) in [("disordered", usual(context)?), ("hexagonal", vec![settled(lattice(), context)?])] {
        let (mut normal, mut tangential) = (Vec::new(), Vec::new());
        for bed in &beds {
            let kinetic = mean_forces(bed, rubbing(0.5, 0.0), context)?;
            let fixed = mean_forces(bed, rubbing(0.5, 0.8), context)?;
            normal.push(fixed[0] / kinetic[0]);
            tangential.push(fixed[1] / kinetic[1]);
        }
        let what = format!("tangential, static over kinetic, {name}");
        parts.push(Part::words(what, "significantly more", Mean::of(&tangential).mean, "", Above(1.25)));
        let what = format!("normal, static over kinetic, {name}: off 1 by");
        parts.push(Part::words(what, "hardly", (Mean::of(&normal).mean - 1.0).abs(), "", Below(0.1)));
    }
    Ok(parts)
}

fn peak_force(context: &Context) -> Result<Vec<Part>, RowError> {
    let most = |bed: &Bed, grains: Grains| -> Result<f64, RowError> {
        let mut most = 0.0_f64;
        let impact = crate::bed::BedImpact::new(grains, super::disk(super::SPEED), EARLY);
        super::watch_impact(bed, &impact, context, |moment, _| most = most.max(moment.force[1]))?;
        Ok(most)
    };
    let beds = usual(context)?;
    let of = |grains: Grains| of_each(&beds, |bed| most(bed, grains));
    let (smooth, kinetic, fixed) = (of(rubbing(0.0, 0.0))?, of(rubbing(0.5, 0.0))?, of(rubbing(0.5, 0.8))?);
    let ordered = most(&*settled(lattice(), context)?, rubbing(0.5, 0.0))?;
    // How far from 1, up or down.
    let apart = |ratios: &[f64]| {
        let mean = Mean::of(ratios).mean;
        mean.max(1.0 / mean)
    };
    let over = ratios(&fixed, &kinetic);
    Ok(vec![
        Part::words("μ = 0 against kinetic, factor", "similar", apart(&ratios(&smooth, &kinetic)), "", Below(1.5)),
        Part::words("static against kinetic, factor", "similar", apart(&over), "", Below(1.5)),
        Part::words(
            "hexagonal against disordered, factor",
            "similar",
            apart(&[ordered / Mean::of(&kinetic).mean]),
            "",
            Below(1.5),
        ),
        Part::words("static over kinetic", "larger", Mean::of(&over).mean, "", Above(1.0)),
    ])
}

/// What the front adds to the grains' force below the impact, in eleven directions from side to side: greatest over mean, at the
/// moment when it has gone so far.
fn outstanding(bed: &Bed, context: &Context) -> Result<f64, RowError> {
    // Of 15° each, of which the rays of a hexagonal bed, at 60°, are the middle of two; the outermost run along the surface.
    const DIRECTIONS: usize = 11;
    let (mut rest, mut found) = (Vec::new(), f64::NAN);
    let mut touched = None;
    let middle = 0.5 * bed.width;
    watch(bed, rubbing(0.5, 0.0), 24.0, context, |moment, frame| {
        let Ok(network) = frame.network() else { return };
        let forces = network.grain_forces(Force::Normal);
        if rest.is_empty() {
            rest.clone_from(&forces);
        }
        if touched.is_none() && moment.force[1] > 0.0 {
            touched = Some(moment.time);
        }
        // The front travels 2 d/τ_c: between 4 and 8 τ_c after the touch it is 8 to 16 d away.
        if touched.is_some_and(|begun| (moment.time - begun - 6.0).abs() < 1.0) {
            let level = moment.depth;
            let top = frame.places().iter().map(|place| place[1]).fold(0.0, f64::max) - level.max(0.0);
            let (mut sums, mut counts) = ([0.0; DIRECTIONS], [0.0; DIRECTIONS]);
            for (k, [x, z]) in frame.places().into_iter().enumerate() {
                let (x, z) = (x - middle, top - z);
                if !(6.0..14.0).contains(&x.hypot(z)) || z <= 0.0 {
                    continue;
                }
                // From one side, through straight down, to the other.
                let angle = z.atan2(x) / std::f64::consts::PI;
                let direction = (angle * (DIRECTIONS + 1) as f64).round() as usize;
                if !(1..=DIRECTIONS).contains(&direction) {
                    continue;
                }
                let direction = direction - 1;
                sums[direction] += (forces[k] - rest[k]).max(0.0);
                counts[direction] += 1.0;
            }
            let means: Vec<f64> = sums.iter().zip(counts).map(|(sum, count)| sum / f64::max(count, 1.0)).collect();
            found = means.iter().copied().fold(0.0, f64::max) * DIRECTIONS as f64 / means.iter().sum::<f64>();
        }
    })?;
    Ok(found)
}

fn front(context: &Context) -> Result<Vec<Part>, RowError> {
    let random = of_each(&usual(context)?, |bed| outstanding(bed, context))?;
    let ordered = outstanding(&*settled(lattice(), context)?, context)?;
    Ok(vec![
        Part::words("greatest over mean, disordered", "isotropic", Mean::of(&random).mean, "", Below(2.0)),
        Part::words("greatest over mean, hexagonal", "rays", ordered, "", Above(2.0)),
    ])
}
