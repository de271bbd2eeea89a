//! What a load is over time, and its exact mean over a step.

use std::f64::consts::PI;

/// A quantity over time (s): zero before its start and, as a force, after its end.
#[derive(Clone, Debug, PartialEq)]
pub enum Curve {
    /// `peak` for `duration` seconds from `start` on.
    Square {
        /// Value while it lasts.
        peak: f64,
        /// When it begins (s).
        start: f64,
        /// How long it lasts (s).
        duration: f64,
    },
    /// Half a period of a sine.
    HalfSine {
        /// Value half way.
        peak: f64,
        /// When it begins (s).
        start: f64,
        /// How long it lasts (s).
        duration: f64,
    },
    /// Rises and falls linearly, each for half the duration.
    Triangle {
        /// Value half way.
        peak: f64,
        /// When it begins (s).
        start: f64,
        /// How long it lasts (s).
        duration: f64,
    },
    /// Linear between points (time, value); times increase.
    Table(Table),
    /// The rate at which a quantity changes that is linear between points: constant from each to the next. For displacements
    /// that are prescribed, as their velocity.
    Path(Table),
}

/// Points of a curve that is linear between them.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    times: Vec<f64>,
    values: Vec<f64>,
    /// Integral up to each point.
    integrals: Vec<f64>,
}

/// Points that make no curve.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CurveError {
    /// Fewer than two points.
    #[error("a curve needs at least two points, there are {0}")]
    Short(usize),
    /// A number is not finite.
    #[error("point {0} holds a number that is not finite")]
    NotFinite(usize),
    /// Times do not increase.
    #[error("the time of point {0} is not after that of the point before it")]
    Order(usize),
}

impl Curve {
    /// A curve through points (time in s, value).
    ///
    /// # Errors
    /// See [`CurveError`]; points are counted from 1.
    pub fn table(points: &[(f64, f64)]) -> Result<Self, CurveError> {
        Table::new(points).map(Self::Table)
    }

    /// The rate of change of what lies on lines through points (time in s, value).
    ///
    /// # Errors
    /// See [`CurveError`]; points are counted from 1.
    pub fn path(points: &[(f64, f64)]) -> Result<Self, CurveError> {
        Table::new(points).map(Self::Path)
    }
}

impl Table {
    fn new(points: &[(f64, f64)]) -> Result<Self, CurveError> {
        if points.len() < 2 {
            return Err(CurveError::Short(points.len()));
        }
        if let Some(bad) = points.iter().position(|(t, v)| !t.is_finite() || !v.is_finite()) {
            return Err(CurveError::NotFinite(bad + 1));
        }
        if let Some(bad) = points.windows(2).position(|w| w[1].0 <= w[0].0) {
            return Err(CurveError::Order(bad + 2));
        }
        let mut integrals = vec![0.0];
        for w in points.windows(2) {
            integrals.push(integrals[integrals.len() - 1] + 0.5 * (w[1].0 - w[0].0) * (w[0].1 + w[1].1));
        }
        let (times, values) = points.iter().copied().unzip();
        Ok(Self { times, values, integrals })
    }

    /// Slope from the k-th point to the next.
    fn slope(&self, k: usize) -> f64 {
        (self.values[k + 1] - self.values[k]) / (self.times[k + 1] - self.times[k])
    }

    /// The points between which a time lies, as the index of the first; none before the first and from the last on.
    fn segment(&self, time: f64) -> Option<usize> {
        let after = self.times.partition_point(|&t| t <= time);
        (after > 0 && after < self.times.len()).then(|| after - 1)
    }
}

impl Curve {
    /// The same curve with every value times `factor`.
    pub fn scaled(&self, factor: f64) -> Self {
        let mut curve = self.clone();
        match &mut curve {
            Self::Square { peak, .. } | Self::HalfSine { peak, .. } | Self::Triangle { peak, .. } => *peak *= factor,
            Self::Table(table) | Self::Path(table) => {
                table.values.iter_mut().chain(&mut table.integrals).for_each(|value| *value *= factor);
            }
        }
        curve
    }

    /// Its greatest value, without the sign.
    pub fn peak(&self) -> f64 {
        match self {
            Self::Square { peak, .. } | Self::HalfSine { peak, .. } | Self::Triangle { peak, .. } => peak.abs(),
            Self::Table(table) => table.values.iter().fold(0.0, |most, value| value.abs().max(most)),
            Self::Path(table) => (1..table.times.len()).fold(0.0, |most, k| table.slope(k - 1).abs().max(most)),
        }
    }

    /// When it ends (s).
    pub fn end(&self) -> f64 {
        match self {
            Self::Square { start, duration, .. }
            | Self::HalfSine { start, duration, .. }
            | Self::Triangle { start, duration, .. } => start + duration,
            Self::Table(table) | Self::Path(table) => table.times[table.times.len() - 1],
        }
    }

    /// Its value at a time (s); zero outside.
    pub fn value(&self, time: f64) -> f64 {
        let share = |start: f64, duration: f64| (time - start) / duration;
        match self {
            Self::Square { peak, start, duration } => {
                if (0.0..=1.0).contains(&share(*start, *duration)) {
                    *peak
                } else {
                    0.0
                }
            }
            Self::HalfSine { peak, start, duration } => {
                let x = share(*start, *duration);
                if (0.0..=1.0).contains(&x) { peak * (PI * x).sin() } else { 0.0 }
            }
            Self::Path(table) => table.segment(time).map_or(0.0, |k| table.slope(k)),
            Self::Triangle { peak, start, duration } => {
                peak * (1.0 - (2.0 * share(*start, *duration) - 1.0).abs()).max(0.0)
            }
            Self::Table(table) => {
                let (times, values) = (&table.times, &table.values);
                let after = times.partition_point(|&t| t <= time);
                match (after, after == times.len()) {
                    (0, _) => 0.0,
                    (_, true) => {
                        if time == times[times.len() - 1] {
                            values[values.len() - 1]
                        } else {
                            0.0
                        }
                    }
                    _ => {
                        let share = (time - times[after - 1]) / (times[after] - times[after - 1]);
                        values[after - 1] + share * (values[after] - values[after - 1])
                    }
                }
            }
        }
    }

    /// Its integral from the beginning of time to `time` (s).
    pub fn integral(&self, time: f64) -> f64 {
        let share = |start: f64, duration: f64| ((time - start) / duration).clamp(0.0, 1.0);
        match self {
            Self::Path(table) => {
                let (first, last) = (table.values[0], table.values[table.values.len() - 1]);
                match table.segment(time) {
                    Some(k) => table.values[k] + table.slope(k) * (time - table.times[k]) - first,
                    None if time < table.times[0] => 0.0,
                    None => last - first,
                }
            }
            Self::Square { peak, start, duration } => peak * duration * share(*start, *duration),
            Self::HalfSine { peak, start, duration } => {
                let half = (0.5 * PI * share(*start, *duration)).sin();
                // (1 − cos πx)/π without cancellation.
                peak * duration * 2.0 * half * half / PI
            }
            Self::Triangle { peak, start, duration } => {
                let x = share(*start, *duration);
                let part = if x <= 0.5 { x * x } else { 0.5 - (1.0 - x) * (1.0 - x) };
                peak * duration * part
            }
            Self::Table(table) => {
                let (times, values) = (&table.times, &table.values);
                let after = times.partition_point(|&t| t <= time);
                match (after, after == times.len()) {
                    (0, _) => 0.0,
                    (_, true) => table.integrals[times.len() - 1],
                    _ => {
                        let since = time - times[after - 1];
                        table.integrals[after - 1] + 0.5 * since * (values[after - 1] + self.value(time))
                    }
                }
            }
        }
    }

    /// Its mean from `from` to `to` (s).
    pub fn mean(&self, from: f64, to: f64) -> f64 {
        (self.integral(to) - self.integral(from)) / (to - from)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A curve and its integral scale together, at every time.
    #[test]
    fn scaled_curves_are_so_many_times_as_high() {
        let points = [(1.0, 0.5), (1.5, 3.0), (2.5, -1.0), (3.0, 0.25)];
        let square = Curve::Square { peak: 3.0, start: 1.0, duration: 2.0 };
        for curve in [square, Curve::table(&points).unwrap(), Curve::path(&points).unwrap()] {
            let scaled = curve.scaled(2.5);
            assert_eq!((scaled.peak(), scaled.end()), (2.5 * curve.peak(), curve.end()));
            for time in [0.0, 1.2, 1.9, 2.6, 4.0] {
                assert!((scaled.value(time) - 2.5 * curve.value(time)).abs() < 1e-14);
                assert!((scaled.integral(time) - 2.5 * curve.integral(time)).abs() < 1e-14);
            }
        }
    }

    /// The integral is that of the value: Simpson's rule over a grid that meets every kink is exact for lines, and to
    /// h⁴ f⁗/2880 = 4e-10 for the sine.
    #[test]
    fn integrals_are_those_of_the_values() {
        let (start, duration, peak) = (1.0, 2.0, 3.0);
        let curves = [
            Curve::Square { peak, start, duration },
            Curve::HalfSine { peak, start, duration },
            Curve::Triangle { peak, start, duration },
            Curve::table(&[(1.0, 0.5), (1.5, 3.0), (2.5, -1.0), (3.0, 0.25)]).unwrap(),
        ];
        for curve in &curves {
            let (mut sum, steps) = (0.0, 400);
            for k in 0..steps {
                // One part in 10¹² inside the end points, so that jumps are taken from within.
                let at = |x: f64| curve.value(1.0 + (2.0 * x / f64::from(steps)).clamp(1e-12, 2.0 - 1e-12));
                let k = f64::from(k);
                sum += (at(k) + 4.0 * at(k + 0.5) + at(k + 1.0)) * 2.0 / f64::from(steps) / 6.0;
            }
            assert!((curve.integral(9.0) - sum).abs() < 1e-9, "{curve:?}: {} and {sum}", curve.integral(9.0));
            assert_eq!(curve.integral(0.5), 0.0);
            assert_eq!(curve.end(), 3.0);
            let parts: f64 = (0..700).map(|k| curve.mean(f64::from(k) * 0.01, f64::from(k + 1) * 0.01) * 0.01).sum();
            assert!((parts - curve.integral(7.0)).abs() < 1e-12);
        }
    }

    /// A path is followed exactly: its integral is what the points say, its value the slope between them.
    #[test]
    fn a_path_has_its_slopes() {
        let path = Curve::path(&[(1.0, 0.5), (1.5, 3.0), (2.5, -1.0), (3.0, 0.25)]).unwrap();
        let at = [0.0, 1.0, 1.25, 1.5, 2.0, 2.5, 2.75, 3.0, 4.0].map(|t| (path.value(t), path.integral(t)));
        let slopes = [0.0, 5.0, 5.0, -4.0, -4.0, 2.5, 2.5, 0.0, 0.0];
        let places = [0.0, 0.0, 1.25, 2.5, 0.5, -1.5, -0.875, -0.25, -0.25];
        assert_eq!(at.map(|(slope, _)| slope), slopes);
        assert_eq!(at.map(|(_, place)| place), places);
        assert_eq!((path.peak(), path.end()), (5.0, 3.0));
    }

    #[test]
    fn points_out_of_order_are_refused() {
        assert_eq!(Curve::table(&[(0.0, 1.0)]), Err(CurveError::Short(1)));
        assert_eq!(Curve::table(&[(0.0, 1.0), (0.0, 2.0)]), Err(CurveError::Order(2)));
        assert_eq!(Curve::table(&[(0.0, 1.0), (1.0, f64::NAN)]), Err(CurveError::NotFinite(2)));
    }
}
