//! What resists the intruder: its acceleration against speed and depth, and how its depth scales.

use std::sync::Arc;

use super::super::Wanted::Within;
use super::super::kondic::{disk, rubbing, usual};
use super::super::{Part, Row, RowError, Verdict};
use super::watch_impact;
use crate::Context;
use crate::bed::{Bed, BedImpact, Grains, Moment, exponent, strike};

pub(super) const ROWS: &[Row] = &[
    Row {
        id: "K-A-acceleration",
        claim: "at small depths the intruder's acceleration grows as u^k with its speed, k about 1.4 without friction and 1 with kinetic \
                friction, below the 2 of inertial drag",
        source: "Kondic 2012, appendix, fig. 29",
        reason: "0.3: exponents of straight lines through scattered points; moments while the depth is 1 to 3 of five diameters (here 0.6 of \
                 that), speeds 0.1 to 1",
        formula: false,
        expected: Verdict::HoldsInPart,
        seconds: 60.0,
        measure: acceleration,
    },
    Row {
        id: "K-A-drop",
        claim: "depth follows a power of the drop H = h + y, with an exponent close to 1/3, typically a bit smaller",
        source: "Kondic 2012, appendix, fig. 30a",
        reason: "0.1: \"close\"; the drop of the speed of impact, h = v²/2g, v 0.1 to 1, means over four beds",
        formula: false,
        expected: Verdict::Holds,
        seconds: 60.0,
        measure: dropped,
    },
];

/// Speeds of impact (d/τ_c).
const SPEEDS: [f64; 5] = [0.1, 0.2, 0.4, 0.7, 1.0];
/// The intruder's mass (m).
const MASS: f64 = 36.0;

/// Moments of an impact, close to each other.
fn moments(bed: &Bed, grains: Grains, speed: f64, context: &Context) -> Result<Vec<Moment>, RowError> {
    let mut moments = Vec::new();
    let impact = BedImpact { sample: 0.5, ..BedImpact::new(grains, disk(speed), 120.0) };
    watch_impact(bed, &impact, context, |moment, _| moments.push(*moment))?;
    Ok(moments)
}

/// The exponent of acceleration over speed.
fn of_friction(beds: &[Arc<Bed>], grains: Grains, context: &Context) -> Result<f64, RowError> {
    let mut points = Vec::new();
    for bed in beds {
        for speed in SPEEDS {
            let moments = moments(bed, grains, speed, context)?;
            let stop = moments.iter().position(|m| m.depth > 0.0 && m.velocity[1] >= 0.0).unwrap_or(moments.len());
            let shallow = moments[..stop].iter().filter(|m| (0.6..1.8).contains(&m.depth) && m.force[1] > 0.0);
            points.extend(shallow.map(|m| [-m.velocity[1], m.force[1] / MASS]));
        }
    }
    Ok(exponent(&points).map_or(f64::NAN, |k| k.value))
}

fn acceleration(context: &Context) -> Result<Vec<Part>, RowError> {
    let beds = usual(context)?;
    let smooth = of_friction(&beds, rubbing(0.0, 0.0), context)?;
    let kinetic = of_friction(&beds, rubbing(0.5, 0.0), context)?;
    Ok(vec![
        Part::words("k without friction", "1.4", smooth, "", Within { value: 1.4, absolute: 0.3 }),
        Part::words("k with kinetic friction", "1", kinetic, "", Within { value: 1.0, absolute: 0.3 }),
    ])
}

fn dropped(context: &Context) -> Result<Vec<Part>, RowError> {
    let beds = usual(context)?;
    let fall = Grains::default().fall();
    let mut parts = Vec::new();
    for (name, grains) in [("μ = 0", rubbing(0.0, 0.0)), ("kinetic", rubbing(0.5, 0.0)), ("static", rubbing(0.5, 0.8))]
    {
        let mut points = Vec::new();
        for speed in SPEEDS {
            let mut depth = 0.0;
            for bed in &beds {
                let course = strike(bed, &BedImpact::new(grains, disk(speed), 120.0), context, |_| ())?;
                if let Some(stop) = course.stop {
                    return Err(stop.into());
                }
                depth += course.final_depth / beds.len() as f64;
            }
            points.push([0.5 * speed * speed / fall + disk(speed).height + depth, depth]);
        }
        let found = exponent(&points).map_or(f64::NAN, |found| found.value);
        let wanted = Within { value: 1.0 / 3.0, absolute: 0.1 };
        parts.push(Part::words(format!("exponent, {name}"), "close to 1/3", found, "", wanted));
    }
    Ok(parts)
}
