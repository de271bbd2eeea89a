//! When a sphere was first reached, in bounded memory.
//!
//! A sphere has been reached when its speed is a part of a greatest speed, its own or another's, which is known at the end of a run only. Until then each
//! step at which it was faster than ever before may be the one that is asked for, but those below that part of the greatest speed so far. No way of keeping
//! less gives every answer to the last bit; so steps in a smooth rise that lie denser than a run's [`Grain`] are left out, and found again between
//! those that were kept. Where a wave rises by more than that in each step, nothing is left out. Where a speed falls and rises to new heights again and again, so that more is
//! kept than [`Grain`] has room for, what is found is when a speed was reached that is the asked one to the grain's quotient.

use serde::{Deserialize, Serialize};

use crate::real::fetch_ahead;

/// In samples of fewer spheres speeds are kept as good as all.
const FEW: usize = 5_000;

/// How dense speeds are kept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grain {
    /// Of two speeds in a smooth rise that are nearer to each other, by their quotient, one is enough.
    quotient: f64,
    /// From so many on also where the rise is not smooth.
    many: usize,
}

impl Grain {
    /// For so many spheres, of which none will be asked for less than this part of a greatest speed: in few as good as all that rise by a thousandth, in more
    /// some dozen.
    pub fn of(spheres: usize, part: f64) -> Self {
        let steps: u16 = if spheres < FEW { 4096 } else { 16 };
        Self { quotient: part.clamp(1e-6, 0.5).powf(-1.0 / f64::from(steps)), many: 2 * usize::from(steps) }
    }
}

/// A sphere's speed at the accepted steps at which it was greater than ever before, as far as they can still matter; and, where it was not at the step
/// before, its speed there.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ArrivalTracker {
    pub points: Vec<Point>,
    /// The last, which most new ones replace: it is at hand without a look at the others. None has a speed of zero.
    pub last: Point,
    /// The speed (m/s) of the one before it.
    pub base: f64,
    pub previous: f64,
}

/// Packed: there are many of them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[repr(C, packed(4))]
pub struct Point {
    /// (m/s)
    pub speed: f64,
    /// Steps until then; of more than there are numbers here, which take years, the last.
    pub steps: u32,
}

impl ArrivalTracker {
    /// The speed (m/s) after so many accepted steps, and whether it is the greatest so far. Speeds below `floor` will not be asked for.
    #[inline(always)]
    pub fn push(&mut self, steps: u64, speed: f64, is_maximum: bool, floor: f64, grain: Grain) {
        if is_maximum {
            let point = Point { speed, steps: steps.try_into().unwrap_or(u32::MAX) };
            if point.steps == self.last.steps.saturating_add(1) && speed <= grain.quotient * self.base {
                self.last = point;
            } else {
                self.keep(point, floor, grain);
            }
        }
        self.previous = speed;
    }

    #[inline(never)]
    fn keep(&mut self, point: Point, floor: f64, Grain { quotient, many }: Grain) {
        let is_first = self.last.speed == 0.0;
        let is_smooth = !is_first && point.steps == self.last.steps.saturating_add(1);
        if self.points.len() >= many && !is_smooth {
            // Where there are many, a fall between two that are near each other is left out with what stands for it.
            let n = self.points.len() - 1;
            let n = if self.points[n].speed < self.points[n - 1].speed { n - 1 } else { n };
            let base = self.points[n].speed;
            if point.speed <= quotient * base {
                self.points.truncate(n + 1);
                (self.base, self.last) = (base, point);
                return;
            }
        }
        // As soon as an eighth can go, whatever room there is: what is kept follows from the speeds alone.
        let eighth = 1 + self.points.len() / 8;
        if self.points.get(eighth).is_some_and(|point| point.speed < floor) {
            // The last below what will be asked for stays, for those between it and the next.
            let below = self.points.iter().skip(1).take_while(|point| point.speed < floor).count();
            self.points.drain(..below);
        }
        if self.points.len() + 2 > self.points.capacity() {
            self.points.reserve_exact(4.max(self.points.len() / 4));
        }
        if !is_first {
            self.points.push(self.last);
        }
        if !is_smooth {
            self.points.push(Point { speed: self.previous, steps: point.steps.saturating_sub(1) });
        }
        self.base = if is_smooth { self.last.speed } else { self.previous };
        self.last = point;
    }

    /// Asks for the memory of the speeds that a greater one is kept with.
    #[inline(always)]
    pub fn fetch(&self) {
        fetch_ahead(&self.points, 0, 64);
        fetch_ahead(&self.points, self.points.len().saturating_sub(1), 64);
    }

    /// The greatest speed so far (m/s); none if there was no motion.
    pub fn maximum(&self) -> Option<f64> {
        Some(self.last.speed).filter(|&speed| speed > 0.0)
    }

    /// When the speed first reached `threshold` (m/s): linear between accepted steps; where some were left out, by the cubic through the logarithms of up
    /// to four speeds around, and in any case between the two nearest.
    pub fn arrival(&self, step: f64, threshold: f64) -> Option<f64> {
        let point = |k: usize| self.points.get(k).copied().unwrap_or(self.last);
        let count = self.maximum().map_or(0, |_| self.points.len() + 1);
        let k = (0..count).find(|&k| point(k).speed >= threshold)?;
        let time = |steps: f64| steps * step;
        let at = |k: usize| [f64::from(point(k).steps), point(k).speed];
        let [end, speed] = at(k);
        let Some(before) = k.checked_sub(1) else { return Some(time(end)) };
        let [begin, speed_before] = at(before);
        if end - begin <= 1.0 {
            let share = (threshold - speed_before) / (speed - speed_before);
            return Some(time(end) - step * (1.0 - share));
        }
        // Neighbours of the same rise.
        let first = before.checked_sub(1).filter(|&first| (0.0..speed_before).contains(&at(first)[1]));
        let last = Some(k + 1).filter(|&last| last < count && at(last)[1] > speed);
        let around = [first, Some(before), Some(k), last].into_iter().flatten().map(at);
        let around: Vec<[f64; 2]> =
            around.filter(|&[_, speed]| speed > 0.0).map(|[n, speed]| [n, speed.ln()]).collect();
        let level = threshold.ln();
        let mut steps = 0.0;
        for (i, &[n, own]) in around.iter().enumerate() {
            let others = around.iter().enumerate().filter(|&(j, _)| j != i);
            steps += others.fold(n, |part, (_, &[_, other])| part * (level - other) / (own - other));
        }
        // Logarithms of speeds that differ by rounding may be one.
        if steps.is_nan() {
            steps = end;
        }
        Some(time(steps.clamp(begin, end)))
    }

    /// Bytes that it occupies.
    pub fn bytes(&self) -> usize {
        size_of::<Self>() + size_of::<Point>() * self.points.capacity()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PART: f64 = 0.01;
    const LARGE: usize = 1_000_000;

    /// Of all speeds after each step, by the definition.
    fn by_definition(speeds: &[f64], threshold: f64) -> Option<f64> {
        let n = speeds.iter().position(|&speed| speed >= threshold)?;
        let before = if n == 0 { 0.0 } else { speeds[n - 1] };
        let share = (threshold - before) / (speeds[n] - before);
        Some((n + 1) as f64 - (1.0 - share))
    }

    fn tracked(speeds: &[f64], grain: Grain) -> ArrivalTracker {
        let (mut tracker, mut top) = (ArrivalTracker::default(), 0.0);
        for (n, &speed) in speeds.iter().enumerate() {
            tracker.push(n as u64 + 1, speed, speed > top, PART * speed, grain);
            top = speed.max(top);
        }
        tracker
    }

    fn top(speeds: &[f64]) -> f64 {
        speeds.iter().copied().fold(0.0, f64::max)
    }

    /// A wave's front, of a step some tenth of its rise: three pulses of which the second is greatest, with flanks as of a solitary wave.
    fn pulses(width: f64) -> Vec<f64> {
        let pulse = |n: f64, at: f64, height: f64| height / ((n - at) / width).cosh().powi(4);
        (0..(90.0 * width) as usize)
            .map(|n| n as f64)
            .map(|n| pulse(n, 20.0 * width, 0.6) + pulse(n, 40.0 * width, 1.0) + pulse(n, 60.0 * width, 0.9))
            .collect()
    }

    /// Where each step is a greater one by far nothing is left out, in any number of spheres below which all are kept.
    #[test]
    fn a_wave_arrives_to_the_bit() {
        for width in [3.0, 7.0, 12.5] {
            let speeds = pulses(width);
            let tracker = tracked(&speeds, Grain::of(100, PART));
            let threshold = PART * top(&speeds);
            assert_eq!(tracker.arrival(1.0, threshold), by_definition(&speeds, threshold), "{width}");
        }
    }

    /// In large crystals it is a hundredth of a step beside, for linear between two steps is no better: on a flank that grows e-fold in τ steps, here a quarter of
    /// the width, the curve is 1/(8 τ) of a step from its chord.
    #[test]
    fn in_large_crystals_an_arrival_is_a_small_part_of_a_step_off() {
        for width in [12.0, 40.0, 400.0] {
            let speeds = pulses(width);
            let tracker = tracked(&speeds, Grain::of(LARGE, PART));
            for part in [PART, 0.02, 0.1] {
                let threshold = part * top(&speeds);
                let found = tracker.arrival(1.0, threshold).unwrap();
                let expected = by_definition(&speeds, threshold).unwrap();
                let off = (found - expected).abs();
                // The chord's, and the cubic's own: 3/128 h⁴ of a fourth derivative like the first, h being ln 100/16 e-folds.
                let bound = 0.125 / (0.25 * width) + 1.6e-4 * 0.25 * width;
                assert!(off < bound, "{width}, {part}: {found} in place of {expected}");
            }
        }
    }

    /// Whatever the speeds, noise that grows among them, a threshold is off by less than the grain, and memory is bounded.
    #[test]
    fn memory_is_bounded_and_so_is_the_threshold() {
        let mut state = 7_u64;
        let mut draw = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        let noise: Vec<f64> = (0..100_000).map(|n| draw() * (1.0 + f64::from(n)).powf(1.5)).collect();
        let slow: Vec<f64> = (1..100_000).map(f64::from).collect();
        for (speeds, most) in [(noise, 1100), (slow, 400)] {
            let grain = Grain::of(LARGE, PART);
            let mut tracker = ArrivalTracker::default();
            let mut top = 0.0;
            for (n, &speed) in speeds.iter().enumerate() {
                tracker.push(n as u64 + 1, speed, speed > top, PART * speed, grain);
                top = speed.max(top);
                assert!(tracker.bytes() < most, "{} bytes after {n} steps", tracker.bytes());
            }
            for part in [PART, 0.03, 0.2, 0.7] {
                let found = tracker.arrival(1.0, part * top).unwrap();
                let at = |factor: f64| by_definition(&speeds, part * top * factor);
                let (early, late) = (at(1.0 / grain.quotient).unwrap(), at(grain.quotient).unwrap_or(f64::INFINITY));
                assert!((early..=late).contains(&found), "{part}: {early} {found} {late}");
            }
        }
    }

    /// Steps beside each other in a rise and far apart in time.
    #[test]
    fn a_first_arrival_of_a_sphere_that_rested_between() {
        let speeds = [0.0, 0.002, 0.004, 0.001, 0.0, 0.003, 0.008, 0.3, 0.1, 1.0, 0.2];
        for spheres in [100, LARGE] {
            let tracker = tracked(&speeds, Grain::of(spheres, PART));
            for threshold in [0.01, 0.1, 0.3, 0.4, 1.0] {
                assert_eq!(tracker.arrival(1.0, threshold), by_definition(&speeds, threshold), "{threshold}");
            }
            assert_eq!(tracker.arrival(1.0, 1.5), None);
        }
    }
}
