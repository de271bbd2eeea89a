//! Measurement against prediction, record by record: arrival, peak, residual.

use serde::Serialize;

use super::{Data, Prediction, align};

/// Part of a record's greatest change at which it counts as arrived: above the noise of most instruments, early on the front.
const ARRIVED: f64 = 0.1;

/// What is read off one curve.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Features {
    /// When it has first changed by a tenth of its greatest change (s), on the clock of the measurement.
    pub arrival_s: f64,
    /// Its greatest value by size, with its sign, in SI.
    pub peak: f64,
    /// When (s).
    pub peak_time_s: f64,
}

/// One record beside its prediction.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Matched {
    /// Its name.
    pub name: String,
    /// Values that were compared.
    pub samples: usize,
    /// Of the measurement.
    pub measured: Features,
    /// Of the prediction.
    pub predicted: Features,
    /// Root of the mean square difference, in SI.
    pub rms: f64,
    /// The same over the measured peak.
    pub rms_over_peak: f64,
    /// Correlation of neighbouring residuals: about zero for noise, near 1 where curves differ in shape.
    pub neighbours: f64,
}

/// All records on one clock.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// Measured time − predicted time (s).
    pub offset_s: f64,
    /// Record by record.
    pub records: Vec<Matched>,
}

/// Greatest size of each record, the scale of its residuals before anything is known of its noise.
pub(super) fn peaks(data: &Data) -> Vec<f64> {
    let most =
        |values: &[f64]| values.iter().filter(|value| value.is_finite()).fold(0.0, |most: f64, v| most.max(v.abs()));
    data.records.iter().map(|record| most(&record.values)).collect()
}

/// Compares at an offset, or at the one at which measurement and prediction differ least; none where they hardly overlap.
pub fn compare(data: &Data, prediction: &Prediction, offset: Option<f64>) -> Option<Comparison> {
    let scales = peaks(data);
    let offset = match offset {
        Some(offset) => offset,
        None => align::offset(data, prediction, &scales)?,
    };
    let residuals = align::residuals(data, prediction, offset, &scales);
    align::misfit(&residuals, data)?;
    let records = data.records.iter().enumerate().map(|(k, record)| {
        let known: Vec<f64> = residuals[k].iter().flatten().map(|r| r * scales[k]).collect();
        let rms = (known.iter().map(|r| r * r).sum::<f64>() / known.len().max(1) as f64).sqrt();
        let at_start = prediction.values[k][0];
        let measured = data.times.iter().copied().zip(record.values.iter().copied()).filter(|(_, v)| v.is_finite());
        let times = (0..prediction.values[k].len()).map(|n| offset + n as f64 * prediction.interval);
        // Only as long as something was measured.
        let seen = |time: &f64| (data.times[0]..=data.times[data.times.len() - 1]).contains(time);
        let predicted = times.zip(prediction.values[k].iter().copied()).filter(|(time, _)| seen(time));
        Matched {
            name: record.name.clone(),
            samples: known.len(),
            measured: features(measured, at_start),
            predicted: features(predicted, at_start),
            rms,
            rms_over_peak: rms / scales[k],
            neighbours: neighbours(&known),
        }
    });
    Some(Comparison { offset_s: offset, records: records.collect() })
}

/// Correlation of each residual with the next.
pub(super) fn neighbours(residuals: &[f64]) -> f64 {
    let mean = residuals.iter().sum::<f64>() / residuals.len().max(1) as f64;
    let square: f64 = residuals.iter().map(|r| (r - mean) * (r - mean)).sum();
    let product: f64 = residuals.windows(2).map(|w| (w[0] - mean) * (w[1] - mean)).sum();
    if square > 0.0 { product / square } else { 0.0 }
}

fn features(curve: impl Iterator<Item = (f64, f64)>, at_start: f64) -> Features {
    let points: Vec<(f64, f64)> = curve.collect();
    let most =
        |of: &dyn Fn(f64) -> f64| {
            points.iter().copied().fold((0.0, 0.0, 0.0), |best: (f64, f64, f64), (time, value)| {
                if of(value) > best.2 { (time, value, of(value)) } else { best }
            })
        };
    let (peak_time_s, peak, _) = most(&|value| value.abs());
    let (_, _, change) = most(&|value| (value - at_start).abs());
    let level = ARRIVED * change;
    let passed = points.iter().position(|(_, value)| (value - at_start).abs() >= level).unwrap_or(0);
    let arrival_s = match (passed.checked_sub(1).map(|before| points[before]), points.get(passed)) {
        (Some((t0, v0)), Some((t1, v1))) => {
            let [a, b] = [(v0 - at_start).abs(), (v1 - at_start).abs()];
            t0 + (t1 - t0) * if b > a { (level - a) / (b - a) } else { 1.0 }
        }
        (_, point) => point.map_or(0.0, |(time, _)| *time),
    };
    Features { arrival_s, peak, peak_time_s }
}
