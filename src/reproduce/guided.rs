//! Sections 5.3.1 and 5.3.2: stripes that turn a wave, interfaces that bend it.

use super::Wanted::{Above, Below, Near, Within};
use super::crystals::{DIAMETER, material, model};
use super::wedge::Wedge;
use super::{Part, Row, RowError, Verdict};
use crate::Context;
use crate::contact::{Constants, LawKind, Pair};
use crate::dem::rig::{Body, Curve, LawBook, Load, LoadKind, Rig, Simulation};
use crate::lattice::{Cell, Crystal, Outline, Width};
use crate::material::Material;
use crate::pattern::{Build, Pattern, Selection};

pub(super) const ROWS: &[Row] = &[
    Row {
        id: "5.3.1-stripes",
        claim: "stripes of aluminium and 440c at 60° turn the motion of a plastic wave along them, that of an elastic one \
                hardly",
        source: "fig. 5.11",
        reason: "a stripe lies 30° off the wave: turned is more than half of that, hardly less than a third of it. Stripes of one \
                 row each, 20 µs; their width and the pulse are not printed",
        formula: false,
        expected: Verdict::Holds,
        seconds: 3.0,
        measure: stripes,
    },
    Row {
        id: "5.3.2-amplitude",
        claim: "440c to brass at 60°: the angle grows with amplitude, within a few degrees of Snell's over a decade, and \
                in the end exceeds it",
        source: "fig. 5.14, blue",
        reason: "\"a few degrees\": 4. Snell's with the speeds 1344.7 and 791.1 m/s",
        formula: false,
        expected: Verdict::Holds,
        seconds: 15.0,
        measure: amplitude,
    },
    Row {
        id: "5.3.2-static",
        claim: "without rate the angle tends to that of linear contacts",
        source: "fig. 5.14, red",
        reason: "\"identical\": 1 degree, twice what threshold and region move it by",
        formula: false,
        expected: Verdict::HoldsInPart,
        seconds: 12.0,
        measure: without_rate,
    },
    Row {
        id: "5.3.2-linear",
        claim: "with linear contacts the angle does not depend on amplitude and is about 2° below Snell's",
        source: "fig. 5.14, cyan",
        reason: "1 degree, twice what threshold and region move it by",
        formula: false,
        expected: Verdict::Holds,
        seconds: 10.0,
        measure: linear,
    },
    Row {
        id: "5.3.2-elastic",
        claim: "with Hertzian contacts the angle does not depend on amplitude and differs greatly from Snell's",
        source: "fig. 5.14, orange",
        reason: "constant to 1 degree; \"greatly\": more than the \"few degrees\", 4, of the plastic law",
        formula: false,
        expected: Verdict::Holds,
        seconds: 10.0,
        measure: elastic,
    },
    Row {
        id: "5.3.2-density-60",
        claim: "60°, only the density differs: Snell's law predicts the angle",
        source: "fig. 5.13b, blue",
        reason: SHARE,
        formula: false,
        expected: Verdict::Holds,
        seconds: 10.0,
        measure: |context| varied(60.0, By::Density, &[0.8, 0.65, 0.5], context),
    },
    Row {
        id: "5.3.2-yield-60",
        claim: "60°, only the yield stress differs: the angle tends to Snell's as the amplitude grows",
        source: "fig. 5.13b, red",
        reason: "nearer at 10 F_p than at 2 F_p",
        formula: false,
        expected: Verdict::Holds,
        seconds: 10.0,
        measure: yield_tends,
    },
    Row {
        id: "5.3.2-density-30",
        claim: "30°, only the density differs: Snell's law predicts the angle",
        source: "fig. 5.13c, blue",
        reason: SHARE,
        formula: false,
        expected: Verdict::Holds,
        seconds: 10.0,
        measure: |context| varied(30.0, By::Density, &[0.8, 0.65, 0.5], context),
    },
    Row {
        id: "5.3.2-faster-15",
        claim: "15° into a faster material (lighter; brass to 440c): Snell's law predicts the angle",
        source: "fig. 5.15b",
        reason: "14 % of the angle, as above. In 440c behind brass at 2 F_p of brass the contacts do not get as far as F_p, \
                 which the source names as the limit",
        formula: false,
        expected: Verdict::HoldsInPart,
        seconds: 15.0,
        measure: |context| faster(15.0, &[1.25, 1.5, 1.75], context),
    },
    Row {
        id: "5.3.2-faster-30",
        claim: "30° into a faster material (lighter; brass to 440c): good predictions, less so at higher speed ratios",
        source: "fig. 5.15c",
        reason: "as at 15°; total reflection begins at a ratio of 2",
        formula: false,
        expected: Verdict::HoldsInPart,
        seconds: 15.0,
        measure: |context| faster(30.0, &[1.25, 1.5], context),
    },
];

fn stripes(context: &Context) -> Result<Vec<Part>, RowError> {
    let mut parts = Vec::new();
    for (law, words) in [(LawKind::Thesis, "turned"), (LawKind::Hertz, "hardly")] {
        let angle = turned(law, context)?.to_degrees();
        let wanted = if law == LawKind::Thesis { Above(15.0) } else { Below(10.0) };
        let what = format!("{law}: direction of motion off the wave's in layers 14 to 22");
        parts.push(Part::words(what, words, angle, "°", wanted));
    }
    Ok(parts)
}

/// Angle (rad) between depth and the momentum of layers 14 to 22, each sphere taken when it was fastest.
fn turned(law: LawKind, context: &Context) -> Result<f64, RowError> {
    let cell = Cell::<2>::named("hexagonal").unwrap_or(Cell::<2>::ALL[0]);
    // Sixteen wide and not fifteen, so that stripes of one row each, by turns, fit round.
    let crystal = Crystal::new(cell, DIAMETER, 25, &[Width::Cells(16)], Outline::All)?;
    let steel = material("440c");
    let mut build = Build::new(crystal.clone(), vec![steel.clone(), material("al")]);
    let width = 0.75_f64.sqrt() * DIAMETER;
    let pattern = Pattern::Stripes { angle: 60_f64.to_radians(), widths: vec![width; 2], origin: [0.0, 0.0] };
    let behind = Selection { layers: Some([11, 25]), ..Selection::default() };
    build.paint(&pattern, &behind, &[1, 0], None)?;
    let (sample, _) = build.sample();
    let sites = crystal.sites();
    let of_layers = |first: u32, last: u32| (0..sites.len()).filter(move |&k| (first..=last).contains(&sites[k].layer));
    let mut rig = Rig::new(sample, LawBook::named(law));
    rig.periods = crystal.periods();
    let pair = Pair::new([&steel, &steel], [0.5 * DIAMETER; 2], Constants::Code);
    let peak = 3.0_f64.sqrt() * 2.0 * pair.plastic_force();
    rig.loads.push(Load {
        bodies: of_layers(1, 1).map(Body::Sphere).collect(),
        direction: [0.0, 1.0],
        kind: LoadKind::Force,
        curve: Curve::Square { peak, start: 0.0, duration: 20e-6 },
    });
    let mut simulation = Simulation::new(rig, 5e-8)?;
    let mut fastest = vec![[0.0; 2]; sites.len()];
    let square = |v: &[f64; 2]| v[0] * v[0] + v[1] * v[1];
    // 125 µs: the wave has reached the free end and is not yet back in the layers looked at.
    for _ in 0..250 {
        simulation.advance(10, context)?;
        let view = simulation.view();
        for (k, fastest) in fastest.iter_mut().enumerate() {
            let velocity = view.velocity(k);
            if square(&velocity) > square(fastest) {
                *fastest = velocity;
            }
        }
    }
    let mass = &simulation.rig().mass;
    let momentum =
        of_layers(14, 22).fold([0.0; 2], |[x, z], k| [x + mass[k] * fastest[k][0], z + mass[k] * fastest[k][1]]);
    Ok(momentum[0].abs().atan2(momentum[1]))
}

/// 440c to brass at 60 degrees.
fn steel_to_brass(law: LawKind, amplitude: f64) -> Wedge {
    Wedge { materials: ["440c", "brass"].map(material), law, angle: 60_f64.to_radians(), amplitude }
}

fn bends(law: LawKind, amplitudes: &[f64], context: &Context) -> Result<Vec<f64>, RowError> {
    let bend = |&amplitude: &f64| Ok(steel_to_brass(law, amplitude).bend(context)?.to_degrees());
    amplitudes.iter().map(bend).collect()
}

fn snell() -> f64 {
    steel_to_brass(LawKind::Thesis, 1.0).snell().to_degrees()
}

/// For angles of any size.
const SHARE: &str = "14 % of the angle, which is 4 of the 29.4 degrees above";

/// A few degrees.
const FEW: f64 = 4.0;

fn amplitude(context: &Context) -> Result<Vec<Part>, RowError> {
    let amplitudes = [0.5, 1.0, 2.0, 5.0, 10.0];
    let angles = bends(LawKind::Thesis, &amplitudes, context)?;
    let snell = snell();
    let words = format!("Snell {snell:.1}°");
    let within = Within { value: snell, absolute: FEW };
    let mut parts: Vec<Part> = amplitudes
        .iter()
        .zip(&angles)
        .map(|(amplitude, &angle)| Part::words(format!("{amplitude} F_p"), &words, angle, "°", within))
        .collect();
    let least = angles.windows(2).map(|pair| pair[1] - pair[0]).fold(f64::INFINITY, f64::min);
    parts.push(Part::words("least growth from one to the next", "grows", least, "°", Above(0.0)));
    parts.push(Part::words("at 10 F_p less Snell's", "exceeds", angles[4] - snell, "°", Above(0.0)));
    Ok(parts)
}

fn without_rate(context: &Context) -> Result<Vec<Part>, RowError> {
    let angles = bends(LawKind::ThesisStatic, &[1.0, 5.0, 10.0], context)?;
    let linear = bends(LawKind::LinearStatic, &[2.0], context)?[0];
    let apart = |k: usize| (angles[k] - linear).abs();
    Ok(vec![
        Part::words(
            "nearer to the linear one at 10 F_p than at 1 F_p by",
            "tends",
            apart(0) - apart(2),
            "°",
            Above(0.0),
        ),
        Part::words("from 5 to 10 F_p", "constant", angles[2] - angles[1], "°", Within { value: 0.0, absolute: 1.0 }),
        Part::words(
            "at 10 F_p",
            &format!("linear {linear:.1}°"),
            angles[2],
            "°",
            Within { value: linear, absolute: 1.0 },
        ),
    ])
}

fn linear(context: &Context) -> Result<Vec<Part>, RowError> {
    let angles = bends(LawKind::LinearStatic, &[1.0, 10.0], context)?;
    Ok(vec![
        Part::words("from 1 to 10 F_p", "constant", angles[1] - angles[0], "°", Within { value: 0.0, absolute: 1.0 }),
        Part::words("Snell's less ours", "2°", snell() - angles[0], "°", Within { value: 2.0, absolute: 1.0 }),
    ])
}

fn elastic(context: &Context) -> Result<Vec<Part>, RowError> {
    let angles = bends(LawKind::Hertz, &[0.5, 5.0], context)?;
    Ok(vec![
        Part::words("from 0.5 to 5 F_p", "constant", angles[1] - angles[0], "°", Within { value: 0.0, absolute: 1.0 }),
        Part::words("Snell's less ours", "differs greatly", snell() - angles[0], "°", Above(FEW)),
    ])
}

/// What the second material differs in.
#[derive(Clone, Copy)]
enum By {
    Density,
    Yield,
}

/// The source's model material, and one in which the speed is `ratio` times its own.
fn model_wedge(degrees: f64, by: By, ratio: f64, amplitude: f64) -> Wedge {
    let first = model(5000.0, 1000e6);
    let with = |stress: f64| Wedge {
        materials: [first.clone(), Material { yield_stress: stress, ..first.clone() }],
        law: LawKind::ThesisStatic,
        angle: degrees.to_radians(),
        amplitude,
    };
    match by {
        By::Density => {
            let second = Material { density: first.density / (ratio * ratio), ..first.clone() };
            Wedge { materials: [first.clone(), second], ..with(first.yield_stress) }
        }
        By::Yield => {
            // The speed rises with the yield stress: halve the interval until it is found to rounding.
            let (mut low, mut high) = (0.01 * first.yield_stress, first.yield_stress);
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                if with(middle).speed_ratio() < ratio { low = middle } else { high = middle }
            }
            with(low)
        }
    }
}

fn against_snell(what: String, wedge: &Wedge, context: &Context) -> Result<Part, RowError> {
    let (snell, ours) = (wedge.snell().to_degrees(), wedge.bend(context)?.to_degrees());
    Ok(Part::words(what, &format!("Snell {snell:.1}°"), ours, "°", Near { value: snell, relative: FEW / 29.4 }))
}

fn varied(degrees: f64, by: By, ratios: &[f64], context: &Context) -> Result<Vec<Part>, RowError> {
    let part =
        |&ratio: &f64| against_snell(format!("speed ratio {ratio}"), &model_wedge(degrees, by, ratio, 2.0), context);
    ratios.iter().map(part).collect()
}

fn yield_tends(context: &Context) -> Result<Vec<Part>, RowError> {
    let part = |ratio: f64| {
        let off = |amplitude: f64| {
            let wedge = model_wedge(60.0, By::Yield, ratio, amplitude);
            Ok::<_, RowError>((wedge.bend(context)? - wedge.snell()).to_degrees().abs())
        };
        let what = format!("speed ratio {ratio}: off Snell's at 10 F_p less that at 2 F_p");
        Ok(Part::words(what, "tends", off(10.0)? - off(2.0)?, "°", Below(0.0)))
    };
    [0.8, 0.65].into_iter().map(part).collect()
}

fn faster(degrees: f64, ratios: &[f64], context: &Context) -> Result<Vec<Part>, RowError> {
    let mut parts = varied(degrees, By::Density, ratios, context)?;
    let wedge = Wedge {
        materials: ["brass", "440c"].map(material),
        law: LawKind::Thesis,
        angle: degrees.to_radians(),
        amplitude: 2.0,
    };
    parts.push(against_snell(format!("brass to 440c, ratio {:.2}", wedge.speed_ratio()), &wedge, context)?);
    Ok(parts)
}
