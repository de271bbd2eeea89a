//! What the rays of a plane impact make together: spot, caustic and wavefronts.

use super::scene::{Fate, Trace};

/// What a plane impact runs through, for rays.
pub trait Optics: Send + Sync {
    /// Follows the ray that starts at a distance `x` (m) from the axis, 0 ≤ x ≤ half width.
    fn trace(&self, x: f64) -> Trace;

    /// Distance from the axis to the far mirror line (m).
    fn half_width(&self) -> f64;

    /// Why a ray did not come to the last row, in words; none if it did.
    fn failure(&self, fate: &Fate) -> Option<String>;
}

/// Rays keep this part of the half width away from mirror lines, where a lens may end in an edge of no thickness.
const INSET: f64 = 1e-7;

/// `count` rays, evenly from the axis to the far mirror line, both (nearly) included.
pub fn fan(optics: &dyn Optics, count: usize) -> Vec<Trace> {
    fan_between(optics, [0.0, optics.half_width()], count)
}

/// `count` rays, evenly over a strip of the struck width (m), its ends (nearly) included.
pub fn fan_between(optics: &dyn Optics, [from, to]: [f64; 2], count: usize) -> Vec<Trace> {
    let last = count.max(2) - 1;
    // On the axis there is nothing to keep away from: a ray along it stays on it.
    let first = if from > 0.0 { INSET } else { 0.0 };
    let places = (0..count).map(|k| from + (to - from) * (k as f64 / last as f64).clamp(first, 1.0 - INSET));
    places.map(|x| optics.trace(x)).collect()
}

/// Where and when rays pass a depth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// Depth (m).
    pub depth: f64,
    /// Mean distance from the axis (m); of one about a mirror line, both halves taken together, that line.
    pub centre: f64,
    /// Root of the mean squared distance from the centre (m).
    pub radius: f64,
    /// Earliest and latest passage (s).
    pub times: [f64; 2],
    /// Number of rays.
    pub rays: usize,
}

/// The spot that rays make at `depth` (m) about a mirror line at `about` (m), across which the other half lies, or, without
/// one, about their own centre; none if no ray passes it.
pub fn spot<'a>(traces: impl IntoIterator<Item = &'a Trace>, depth: f64, about: Option<f64>) -> Option<Spot> {
    let passages: Vec<(f64, f64)> =
        traces.into_iter().filter(|t| t.fate == Fate::Arrived).filter_map(|trace| trace.path.at_depth(depth)).collect();
    spot_of(&passages, depth, about)
}

/// Whether a ray never turns back towards row 1.
fn goes_down(trace: &Trace) -> bool {
    trace.path.points.windows(2).all(|leg| leg[0][1] <= leg[1][1])
}

/// The spot of passages, each a place (m) and a time (s).
fn spot_of(passages: &[(f64, f64)], depth: f64, about: Option<f64>) -> Option<Spot> {
    if passages.is_empty() {
        return None;
    }
    let mean = |value: &dyn Fn(f64) -> f64| passages.iter().map(|p| value(p.0)).sum::<f64>() / passages.len() as f64;
    let centre = about.unwrap_or_else(|| mean(&|x| x));
    let radius = mean(&|x| (x - centre).powi(2)).sqrt();
    let times =
        passages.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], &(_, t)| [low.min(t), high.max(t)]);
    Some(Spot { depth, centre, radius, times, rays: passages.len() })
}

/// The depth between two (m) at which the spot is smallest, on a grid of a thousandth of the way.
pub fn least_spot(traces: &[Trace], [low, high]: [f64; 2], about: Option<f64>) -> Option<Spot> {
    // Depths only grow, so a ray's leg is never left upwards: what is above it is not looked at again.
    let arrived = traces.iter().filter(|trace| trace.fate == Fate::Arrived && goes_down(trace));
    let mut legs: Vec<(&Trace, usize)> = arrived.map(|trace| (trace, 0)).collect();
    if legs.len() < traces.iter().filter(|trace| trace.fate == Fate::Arrived).count() {
        let spots = (0..=1000).filter_map(|k| spot(traces, low + (high - low) * f64::from(k) / 1000.0, about));
        return spots.min_by(|a, b| a.radius.total_cmp(&b.radius));
    }
    let mut passages = Vec::with_capacity(legs.len());
    let spots = (0..=1000).filter_map(|k| {
        let depth = low + (high - low) * f64::from(k) / 1000.0;
        passages.clear();
        for (trace, leg) in &mut legs {
            let points = &trace.path.points;
            while *leg + 2 < points.len() && points[*leg + 1][1] < depth {
                *leg += 1;
            }
            passages.extend(trace.path.on_leg(*leg, depth));
        }
        spot_of(&passages, depth, about)
    });
    spots.min_by(|a, b| a.radius.total_cmp(&b.radius))
}

/// The caustic: the curve that neighbouring rays touch, along which rays crowd. One line of points (m) for each stretch of
/// starting places whose rays meet the same interfaces, and each leg of their ways.
///
/// Every one of `count` rays is traced with two neighbours 10⁻⁶ of the half width to either side, and the point is where
/// these cross: the envelope to second order of that distance.
pub fn caustic(optics: &dyn Optics, count: usize) -> Vec<Vec<[f64; 2]>> {
    let step = 1e-6 * optics.half_width();
    let mut lines: Vec<Vec<[f64; 2]>> = Vec::new();
    // By leg: the line that is being drawn, and what its rays have met.
    let mut open: Vec<Option<usize>> = Vec::new();
    let mut before = None;
    for k in 0..count {
        let x = optics.half_width() * (k as f64 + 0.5) / count as f64;
        let (left, right) = (optics.trace(x - step), optics.trace(x + step));
        let same = left.events == right.events;
        if !same || before.as_ref() != Some(&left.events) {
            open.clear();
        }
        before = same.then(|| left.events.clone());
        if !same {
            continue;
        }
        for leg in 1..left.path.points.len() - 1 {
            let ends = [&left, &right].map(|t| [t.path.points[leg], t.path.points[leg + 1]]);
            open.resize(open.len().max(leg + 1), None);
            match crossing(ends) {
                Some(point) => match open[leg] {
                    Some(line) => lines[line].push(point),
                    None => {
                        open[leg] = Some(lines.len());
                        lines.push(vec![point]);
                    }
                },
                None => open[leg] = None,
            }
        }
    }
    lines.retain(|line| line.len() > 1);
    lines
}

/// Where two legs cross, if both reach there.
fn crossing([[a, b], [c, d]]: [[[f64; 2]; 2]; 2]) -> Option<[f64; 2]> {
    let (first, second) = ([b[0] - a[0], b[1] - a[1]], [d[0] - c[0], d[1] - c[1]]);
    let denominator = first[0] * second[1] - first[1] * second[0];
    let between = [c[0] - a[0], c[1] - a[1]];
    let part = (between[0] * second[1] - between[1] * second[0]) / denominator;
    let other = (between[0] * first[1] - between[1] * first[0]) / denominator;
    let within = |part: f64| part > 0.0 && part <= 1.0;
    (within(part) && within(other)).then(|| [a[0] + part * first[0], a[1] + part * first[1]])
}

/// Where the wave is at a time (s): a line (m) for each stretch of neighbouring rays that have met the same interfaces until
/// then.
pub fn wavefront(traces: &[Trace], time: f64) -> Vec<Vec<[f64; 2]>> {
    let mut lines: Vec<Vec<[f64; 2]>> = Vec::new();
    let mut before = None;
    for trace in traces {
        let Some((point, leg)) = at_time(trace, time) else {
            before = None;
            continue;
        };
        // A front goes on where the rays have only just met, or not yet met, what their neighbours have.
        let met = &trace.events[..leg.min(trace.events.len())];
        let joins = before.is_some_and(|earlier: &[_]| earlier.starts_with(met) || met.starts_with(earlier));
        match lines.last_mut() {
            Some(line) if joins => line.push(point),
            _ => lines.push(vec![point]),
        }
        before = Some(met);
    }
    lines.retain(|line| line.len() > 1);
    lines
}

/// Where a ray is at a time, and on which of its legs.
fn at_time(trace: &Trace, time: f64) -> Option<([f64; 2], usize)> {
    let leg = trace.path.times.windows(2).position(|ends| (ends[0]..=ends[1]).contains(&time))?;
    let [start, end] = [trace.path.points[leg], trace.path.points[leg + 1]];
    let [t0, t1] = [trace.path.times[leg], trace.path.times[leg + 1]];
    let part = if t1 > t0 { (time - t0) / (t1 - t0) } else { 0.0 };
    Some(([start[0] + part * (end[0] - start[0]), start[1] + part * (end[1] - start[1])], leg))
}
