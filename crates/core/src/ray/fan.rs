//! What the rays of a plane impact make together: spot, caustic and wavefronts.

use super::scene::{Event, Fate, Trace};

/// What a plane impact runs through, for rays.
pub trait Optics: Send + Sync {
    /// Follows the ray that starts at a distance `x` (m) from the axis, 0 ≤ x ≤ half width.
    fn trace(&self, x: f64) -> Trace;

    /// Where that ray first passes `depth` (m) on its way down, as a distance from the axis (m); what it has met until then is left in
    /// `met`, whatever was there before. None if it does not come there. The same as by [`trace`](Self::trace), with nothing kept of the way: searches
    /// ask for many of these.
    fn landing(&self, x: f64, depth: f64, met: &mut Vec<Event>) -> Option<f64> {
        let Trace { path, events, .. } = self.trace(x);
        let leg = path.leg_at(depth)?;
        met.clear();
        met.extend(events.get(..leg)?);
        Some(path.on_leg(leg, depth)?.0)
    }

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
pub fn fan_between(optics: &dyn Optics, strip: [f64; 2], count: usize) -> Vec<Trace> {
    starts(strip, count).map(|x| optics.trace(x)).collect()
}

/// Where the rays of such a fan start (m).
pub fn starts([from, to]: [f64; 2], count: usize) -> impl Iterator<Item = f64> {
    let last = count.max(2) - 1;
    // On the axis there is nothing to keep away from: a ray along it stays on it.
    let first = if from > 0.0 { INSET } else { 0.0 };
    (0..count).map(move |k| from + (to - from) * (k as f64 / last as f64).clamp(first, 1.0 - INSET))
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

/// Depths that are looked at for the smallest spot.
const DEPTHS: usize = 1000;

/// The depth between two (m) at which the spot is smallest, on a grid of a thousandth of the way.
///
/// On a leg a ray's place is linear in the depth, and so its share in the sum of squares is a parabola: what each leg adds to the
/// coefficients is noted where it begins and taken off where it ends. These sums carry round-off of some 10⁻⁸ of the fan's width in
/// the radius, so the spot is then measured itself at the best depth and its neighbours.
pub fn least_spot(traces: &[Trace], [low, high]: [f64; 2], about: Option<f64>) -> Option<Spot> {
    let arrived = || traces.iter().filter(|trace| trace.fate == Fate::Arrived);
    let depth = |k: usize| low + (high - low) * k as f64 / DEPTHS as f64;
    // The first of the depths that is no less than this one.
    let from = |z: f64| ((z - low) / (high - low) * DEPTHS as f64).ceil().clamp(0.0, (DEPTHS + 1) as f64) as usize;
    let mut changes = vec![[0.0; 6]; DEPTHS + 2];
    for trace in arrived() {
        let mut next = 0;
        for leg in trace.path.points.windows(2) {
            let ([x0, z0], [x1, z1]) = (leg[0], leg[1]);
            // A ray counts where it first passes a depth.
            let (begins, ends) = (from(z0).max(next), from(z1.next_up()));
            if begins >= ends || z1 <= z0 {
                continue;
            }
            next = ends;
            let slope = (x1 - x0) / (z1 - z0);
            let start = x0 + slope * (low - z0) - about.unwrap_or(0.0);
            let sums = [1.0, start, slope, start * start, start * slope, slope * slope];
            for (place, sign) in [(begins, 1.0), (ends, -1.0)] {
                changes[place].iter_mut().zip(sums).for_each(|(sum, change)| *sum += sign * change);
            }
        }
    }
    let mut sums = [0.0; 6];
    let mut best: Option<(f64, usize)> = None;
    for (k, change) in changes.iter().enumerate().take(DEPTHS + 1) {
        sums.iter_mut().zip(change).for_each(|(sum, change)| *sum += change);
        let [count, start, slope, squares, products, slopes] = sums;
        let down = depth(k) - low;
        let centre = if about.is_some() { 0.0 } else { (start + down * slope) / count };
        let squared = (squares + down * (2.0 * products + down * slopes)) / count - centre * centre;
        if count > 0.5 && best.is_none_or(|(least, _)| squared < least) {
            best = Some((squared, k));
        }
    }
    let (_, k) = best?;
    let near = (k.saturating_sub(1)..=(k + 1).min(DEPTHS)).filter_map(|k| spot(traces, depth(k), about));
    near.min_by(|a, b| a.radius.total_cmp(&b.radius))
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
