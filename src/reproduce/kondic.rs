//! Kondic et al. 2012: impacts on granular beds.
//!
//! Beds are 0.6 of the published ones in every length, the intruder too (2400 grains, D 6 and mass 36 in place of 6000, 10 and
//! 100), and every figure is a mean over beds of four seeds: the published curves are single runs, and one run is known to
//! about half a diameter only. Beds settle without friction.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use super::Wanted::{Above, Below, Within};
use super::{Part, Row, RowError, Verdict};
use crate::Context;
use crate::bed::{
    Bed, BedImpact, Body, Course, Grains, Intruder, Outline, Packing, Pile, SettleError, Sides, SoundError, listen,
    measure, settle, strike,
};

pub(super) const ROWS: &[Row] = &[
    Row {
        id: "K-2-beds",
        claim: "random beds cover 0.85 to 0.86 of the area, whatever their polydispersity, a hexagonal one 0.91",
        source: "Kondic 2012, section II",
        reason: "0.01: the scatter that is stated; the middle of the range",
        formula: false,
        expected: Verdict::Holds,
        seconds: 20.0,
        measure: beds,
    },
    Row {
        id: "K-2-sound",
        claim: "a push travels through the bed at about 2 d/τ_c with kinetic friction, 2.4 with static",
        source: "Kondic 2012, section II",
        reason: "0.3: where a front begins is a matter of definition, and shallower beds are less compressed",
        formula: false,
        expected: Verdict::Holds,
        seconds: 5.0,
        measure: sound,
    },
    Row {
        id: "K-3-speed",
        claim: "faster intruders go deeper, linearly with speed for larger speeds; the faster ones overshoot",
        source: "Kondic 2012, figs 2, 8b",
        reason: "linear: slopes above and below v = 0.7 within a quarter of each other",
        formula: false,
        expected: Verdict::Holds,
        seconds: 20.0,
        measure: speed,
    },
    Row {
        id: "K-3-friction",
        claim: "friction makes penetration shallower, static friction more than kinetic, at μ 0.1 less so; strong static \
                friction removes the overshoot",
        source: "Kondic 2012, fig. 6",
        reason: "orders of means over four beds; an overshoot below a tenth of a diameter counts as none",
        formula: false,
        expected: Verdict::HoldsInPart,
        seconds: 20.0,
        measure: friction,
    },
    Row {
        id: "K-3-restitution",
        claim: "a larger restitution gives a deeper penetration; a small one does not remove the overshoot",
        source: "Kondic 2012, fig. 5",
        reason: "orders of means over four beds; an overshoot is more than a tenth of a diameter",
        formula: false,
        expected: Verdict::Holds,
        seconds: 12.0,
        measure: restitution,
    },
    Row {
        id: "K-3-hexagonal",
        claim: "on a hexagonal bed the intruder rebounds out of it and ends far shallower, at a depth that does not depend on \
                speed",
        source: "Kondic 2012, figs 7, 8",
        reason: "\"does not depend\": within one diameter",
        formula: false,
        expected: Verdict::Holds,
        seconds: 8.0,
        measure: hexagonal,
    },
    Row {
        id: "K-3-polydispersity",
        claim: "the degree of polydispersity has no significant effect on depth as long as the bed is disordered",
        source: "Kondic 2012, fig. 8a",
        reason: "one diameter, the scatter of beds that section III B states",
        formula: false,
        expected: Verdict::Holds,
        seconds: 40.0,
        measure: polydispersity,
    },
    Row {
        id: "K-3-gravity",
        claim: "weaker gravity gives a deeper penetration, whose greatest depth is reached later",
        source: "Kondic 2012, fig. 9",
        reason: "orders of means over four beds; gravities of Mars, Earth and Jupiter at v = 1",
        formula: false,
        expected: Verdict::Holds,
        seconds: 15.0,
        measure: gravity,
    },
    Row {
        id: "K-3-shape",
        claim: "depth grows with the aspect ratio of an elliptic ogive, approximately linearly",
        source: "Kondic 2012, fig. 3",
        reason: "linear: the middle one of three within a diameter of the mean of the other two",
        formula: false,
        expected: Verdict::Holds,
        seconds: 20.0,
        measure: shape,
    },
    Row {
        id: "K-3-body",
        claim: "an upright hollow intruder goes as deep as a solid one",
        source: "Kondic 2012, section III A",
        reason: "10⁻⁹: what cannot turn has no use for a moment of inertia",
        formula: false,
        expected: Verdict::Holds,
        seconds: 5.0,
        measure: hollow,
    },
    Row {
        id: "K-3-size",
        claim: "the width of the bed makes a difference of less than a diameter in depth",
        source: "Kondic 2012, fig. 11",
        reason: "the number that is stated; 60 and 120 wide, means over four beds",
        formula: false,
        expected: Verdict::Holds,
        seconds: 20.0,
        measure: size,
    },
];

/// Seeds of the beds.
pub(super) const SEEDS: [u64; 4] = [1, 2, 3, 4];
/// Speed of the default impact (d/τ_c).
pub(super) const SPEED: f64 = 0.7;

pub(super) fn pile(spread: f64, width: f64, seed: u64) -> Pile {
    Pile { packing: Packing::Random, width, height: 36.0, spread, seed, sides: Sides::Periodic }
}

/// A settled bed; those of earlier rows are taken again.
pub(super) fn settled(pile: Pile, context: &Context) -> Result<Arc<Bed>, RowError> {
    type Place = Arc<Mutex<Option<Arc<Bed>>>>;
    static BEDS: Mutex<BTreeMap<String, Place>> = Mutex::new(BTreeMap::new());
    let place = {
        let mut beds = BEDS.lock().unwrap_or_else(PoisonError::into_inner);
        Arc::clone(beds.entry(format!("{pile:?}")).or_default())
    };
    let mut kept = place.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(bed) = &*kept {
        return Ok(Arc::clone(bed));
    }
    let bed = settle(&pile, &Grains::default(), context).map_err(|error| match error {
        SettleError::Stop(stop) => RowError::from(stop),
        SettleError::Rig(error) => RowError::Rig(error),
        error => RowError::Stopped(error.to_string()),
    })?;
    let bed = Arc::new(bed.bed);
    *kept = Some(Arc::clone(&bed));
    Ok(bed)
}

pub(super) fn usual(context: &Context) -> Result<Vec<Arc<Bed>>, RowError> {
    SEEDS.into_iter().map(|seed| settled(pile(0.2, 60.0, seed), context)).collect()
}

pub(super) fn disk(speed: f64) -> Intruder {
    let outline = Outline::Disk { diameter: 6.0 };
    Intruder { outline, mass: 36.0, body: Body::Solid, turns: true, speed, height: 3.0 }
}

/// How long impacts are followed (τ_c), and those after which the intruder flies.
const WINDOW: f64 = 200.0;
const FLIGHT: f64 = 1000.0;

fn follow(bed: &Bed, grains: Grains, intruder: Intruder, window: f64, context: &Context) -> Result<Course, RowError> {
    let course = strike(bed, &BedImpact::new(grains, intruder, window), context, |_| ())?;
    match course.stop {
        Some(stop) => Err(stop.into()),
        None => Ok(course),
    }
}

/// Means over beds: final depth, overshoot (d), time of the greatest depth (τ_c).
struct Mean {
    depth: f64,
    overshoot: f64,
    deepest: f64,
}

fn mean(beds: &[Arc<Bed>], grains: Grains, intruder: Intruder, context: &Context) -> Result<Mean, RowError> {
    let mut mean = Mean { depth: 0.0, overshoot: 0.0, deepest: 0.0 };
    let part = 1.0 / beds.len() as f64;
    for bed in beds {
        let course = follow(bed, grains, intruder, WINDOW, context)?;
        mean.depth += part * course.final_depth;
        mean.overshoot += part * course.overshoot();
        let deepest = course.moments.iter().max_by(|a, b| a.depth.total_cmp(&b.depth));
        mean.deepest += part * deepest.map_or(0.0, |moment| moment.time);
    }
    Ok(mean)
}

/// The default grains with this coefficient of friction and k_t over k.
pub(super) fn rubbing(coefficient: f64, spring: f64) -> Grains {
    let mut grains = Grains::default();
    grains.grains.friction = coefficient;
    (grains.grains.tangential_stiffness, grains.walls.tangential_stiffness) = (spring, spring);
    grains
}

fn beds(context: &Context) -> Result<Vec<Part>, RowError> {
    let mut parts = Vec::new();
    for spread in [0.1, 0.2, 0.4] {
        let bed = settled(pile(spread, 60.0, SEEDS[0]), context)?;
        let wanted = Within { value: 0.855, absolute: 0.01 };
        let what = format!("volume fraction, r = {spread}");
        parts.push(Part::words(what, "0.85 to 0.86", measure(&bed).volume_fraction, "", wanted));
    }
    let bed = settled(lattice(), context)?;
    let wanted = Within { value: 0.91, absolute: 0.01 };
    parts.push(Part::words("volume fraction, hexagonal", "0.91", measure(&bed).volume_fraction, "", wanted));
    Ok(parts)
}

fn sound(context: &Context) -> Result<Vec<Part>, RowError> {
    let bed = settled(pile(0.2, 60.0, SEEDS[0]), context)?;
    let mut parts = Vec::new();
    for (name, spring, published) in [("kinetic", 0.0, 2.0), ("static", 0.8, 2.4)] {
        let heard = listen(&bed, &rubbing(0.5, spring), context).map_err(|error| match error {
            SoundError::Stop(stop) => RowError::from(stop),
            SoundError::Rig(error) => RowError::Rig(error),
            error => RowError::NoWave(error.to_string()),
        })?;
        let wanted = Within { value: published, absolute: 0.3 };
        parts.push(Part::words(name, &format!("{published} d/τ_c"), heard.speed, "d/τ_c", wanted));
    }
    Ok(parts)
}

fn speed(context: &Context) -> Result<Vec<Part>, RowError> {
    let beds = usual(context)?;
    let of = |speed: f64| mean(&beds, Grains::default(), disk(speed), context);
    let [slow, middle, fast, fastest] = [of(0.1)?, of(0.4)?, of(SPEED)?, of(1.0)?];
    let slopes = [(fast.depth - middle.depth) / 0.3, (fastest.depth - fast.depth) / 0.3];
    Ok(vec![
        Part::words("depth at v = 0.4 over that at 0.1", "deeper", middle.depth / slow.depth, "", Above(1.0)),
        Part::words("depth at v = 0.7 over that at 0.4", "deeper", fast.depth / middle.depth, "", Above(1.0)),
        Part::words("depth at v = 1.0 over that at 0.7", "deeper", fastest.depth / fast.depth, "", Above(1.0)),
        Part::words("slope above v = 0.7 over that below", "linear", slopes[1] / slopes[0], "", {
            Within { value: 1.0, absolute: 0.25 }
        }),
        Part::words("overshoot at v = 1.0", "some", fastest.overshoot, "d", Above(0.1)),
    ])
}

fn friction(context: &Context) -> Result<Vec<Part>, RowError> {
    let beds = usual(context)?;
    let of = |coefficient, spring| mean(&beds, rubbing(coefficient, spring), disk(SPEED), context);
    let smooth = of(0.0, 0.0)?;
    let ([weak, weak_static], [kinetic, fixed]) = ([of(0.1, 0.0)?, of(0.1, 0.8)?], [of(0.5, 0.0)?, of(0.5, 0.8)?]);
    let (less, gap) = (kinetic.depth - fixed.depth, weak.depth - weak_static.depth);
    Ok(vec![
        Part::words("depth with μ = 0 less that with 0.1", "deeper", smooth.depth - weak.depth, "d", Above(0.0)),
        Part::words("with μ = 0.1 less with 0.5", "deeper", weak.depth - kinetic.depth, "d", Above(0.0)),
        Part::words("kinetic less static, μ = 0.5", "significantly", less, "d", Above(1.0)),
        Part::words("kinetic less static, μ = 0.1, over that at 0.5", "similar", gap / less, "", Below(0.5)),
        Part::words("overshoot with static friction, μ = 0.5", "removed", fixed.overshoot, "d", Below(0.1)),
    ])
}

fn restitution(context: &Context) -> Result<Vec<Part>, RowError> {
    let beds = usual(context)?;
    let of = |restitution: f64| {
        let mut grains = Grains::default();
        grains.grains.restitution = restitution;
        mean(&beds, grains, disk(SPEED), context)
    };
    let [lively, usual, dull] = [of(0.9)?, of(0.5)?, of(0.1)?];
    Ok(vec![
        Part::words("depth with e_n 0.9 less that with 0.5", "deeper", lively.depth - usual.depth, "d", Above(0.0)),
        Part::words("with 0.5 less with 0.1", "deeper", usual.depth - dull.depth, "d", Above(0.0)),
        Part::words("overshoot with 0.1", "not removed", dull.overshoot, "d", Above(0.1)),
    ])
}

pub(super) fn lattice() -> Pile {
    Pile { packing: Packing::Hexagonal, spread: 0.0, ..pile(0.0, 60.0, 1) }
}

fn hexagonal(context: &Context) -> Result<Vec<Part>, RowError> {
    let bed = settled(lattice(), context)?;
    let random = mean(&usual(context)?, Grains::default(), disk(SPEED), context)?;
    let (mut depths, mut highest) = (Vec::new(), f64::INFINITY);
    for speed in [0.4, SPEED, 1.0] {
        let course = follow(&bed, Grains::default(), disk(speed), FLIGHT, context)?;
        depths.push(course.final_depth);
        if speed == SPEED {
            let hit = course.moments.iter().position(|m| m.depth > 0.0).unwrap_or(course.moments.len());
            highest = course.moments[hit..].iter().map(|m| m.depth).fold(f64::INFINITY, f64::min);
        }
    }
    let range = depths.iter().copied().fold(f64::MIN, f64::max) - depths.iter().copied().fold(f64::MAX, f64::min);
    Ok(vec![
        Part::words("least depth after the impact, v = 0.7", "outside", highest, "d", Below(0.0)),
        Part::words(
            "depth over that in random beds, v = 0.7",
            "much smaller",
            depths[1] / random.depth,
            "",
            Below(0.5),
        ),
        Part::words("range of depths, v = 0.4 to 1", "independent", range, "d", Below(1.0)),
    ])
}

fn polydispersity(context: &Context) -> Result<Vec<Part>, RowError> {
    let mut depths = Vec::new();
    for spread in [0.1, 0.2, 0.4] {
        let beds = SEEDS.into_iter().map(|seed| settled(pile(spread, 60.0, seed), context));
        let beds = beds.collect::<Result<Vec<_>, _>>()?;
        depths.push(mean(&beds, Grains::default(), disk(SPEED), context)?.depth);
    }
    let wanted = Within { value: 0.0, absolute: 1.0 };
    Ok(vec![
        Part::words("depth with r = 0.1 less that with 0.2", "no effect", depths[0] - depths[1], "d", wanted),
        Part::words("with r = 0.4 less with 0.2", "no effect", depths[2] - depths[1], "d", wanted),
    ])
}

fn gravity(context: &Context) -> Result<Vec<Part>, RowError> {
    let beds = usual(context)?;
    // Beds were prepared under the Earth's gravity; here they meet the other at once, and lie still within 10⁻³ d of depth.
    let of = |gravity: f64| mean(&beds, Grains { gravity, ..Grains::default() }, disk(1.0), context);
    let [mars, earth, jupiter] = [of(369.0 / 980.0)?, of(1.0)?, of(2479.0 / 980.0)?];
    Ok(vec![
        Part::words("depth on Mars over that on Earth", "deeper", mars.depth / earth.depth, "", Above(1.0)),
        Part::words("depth on Jupiter over that on Earth", "shallower", jupiter.depth / earth.depth, "", Below(1.0)),
        Part::words("greatest depth on Mars less on Earth", "later", mars.deepest - earth.deepest, "τ_c", Above(0.0)),
    ])
}

/// An upright ellipse of half-width 3 and a disk's mass.
fn ellipse(half_height: f64, body: Body) -> Intruder {
    let outline = Outline::Ellipse { half_width: 3.0, half_height };
    Intruder { outline, body, turns: false, ..disk(SPEED) }
}

fn shape(context: &Context) -> Result<Vec<Part>, RowError> {
    let beds = usual(context)?;
    let of = |half_height| mean(&beds, Grains::default(), ellipse(half_height, Body::Solid), context);
    let [round, longer, long] = [of(3.0)?.depth, of(4.5)?.depth, of(6.0)?.depth];
    let wanted = Within { value: 0.0, absolute: 1.0 };
    Ok(vec![
        Part::words("depth with b/a = 1.5 over that of a disk", "deeper", longer / round, "", Above(1.0)),
        Part::words("with b/a = 2 over that with 1.5", "deeper", long / longer, "", Above(1.0)),
        Part::words("with 1.5 less the mean of 1 and 2", "linear", longer - 0.5 * (round + long), "d", wanted),
    ])
}

fn hollow(context: &Context) -> Result<Vec<Part>, RowError> {
    let bed = settled(pile(0.2, 60.0, SEEDS[0]), context)?;
    let of = |body| follow(&bed, Grains::default(), ellipse(4.5, body), WINDOW, context);
    let apart = of(Body::Hollow)?.final_depth - of(Body::Solid)?.final_depth;
    Ok(vec![Part::words("depth of a hollow less that of a solid one", "none", apart.abs(), "d", Below(1e-9))])
}

fn size(context: &Context) -> Result<Vec<Part>, RowError> {
    let wide = SEEDS.into_iter().map(|seed| settled(pile(0.2, 120.0, seed), context));
    let wide = wide.collect::<Result<Vec<_>, _>>()?;
    let of = |beds: &[Arc<Bed>]| mean(beds, Grains::default(), disk(SPEED), context);
    let apart = of(&wide)?.depth - of(&usual(context)?)?.depth;
    Ok(vec![Part::words(
        "depth in a bed twice as wide less that in the usual one",
        "none",
        apart.abs(),
        "d",
        Below(1.0),
    )])
}
