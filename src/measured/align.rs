//! The clock of the measurement: measured time = predicted time + offset, one offset for all records of a file.

use super::{Data, Prediction};

/// Offsets tried before the best of them is refined.
const COARSE: usize = 801;
/// Part of the measured values that the prediction must reach.
const SHARE: f64 = 0.5;

/// Differences measured − predicted, each over the scale of its record, for all values that the prediction reaches.
pub(super) fn residuals(data: &Data, prediction: &Prediction, offset: f64, scales: &[f64]) -> Vec<Vec<Option<f64>>> {
    let of = |(k, record): (usize, &super::Record)| {
        let residual = |(time, value): (&f64, &f64)| {
            let predicted = prediction.at(k, time - offset)?;
            value.is_finite().then(|| (value - predicted) / scales[k])
        };
        data.times.iter().zip(&record.values).map(residual).collect()
    };
    data.records.iter().enumerate().map(of).collect()
}

/// Mean square of residuals; none where the prediction reaches too little of what was measured.
pub(super) fn misfit(residuals: &[Vec<Option<f64>>], data: &Data) -> Option<f64> {
    let all = data.records.iter().flat_map(|record| &record.values).filter(|value| value.is_finite()).count();
    let known = || residuals.iter().flatten().flatten();
    let count = known().count();
    (count as f64 >= SHARE * all as f64).then(|| known().map(|r| r * r).sum::<f64>() / count as f64)
}

/// The offset (s) at which measurement and prediction differ least: the best of many over all that leave half of the values
/// comparable, then by the golden section between its neighbours.
pub(super) fn offset(data: &Data, prediction: &Prediction, scales: &[f64]) -> Option<f64> {
    let (first, last) = (data.times[0], data.times[data.times.len() - 1]);
    let [low, high] = [first - prediction.end(), last];
    let step = (high - low) / (COARSE - 1) as f64;
    let cost = |offset: f64| misfit(&residuals(data, prediction, offset, scales), data).unwrap_or(f64::INFINITY);
    let best = (0..COARSE).map(|k| low + step * k as f64).map(|offset| (cost(offset), offset));
    let (least, best) = best.min_by(|a, b| a.0.total_cmp(&b.0))?;
    if !least.is_finite() {
        return None;
    }
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    let [mut a, mut b] = [best - step, best + step];
    let [mut c, mut d] = [b - golden * (b - a), a + golden * (b - a)];
    let [mut at_c, mut at_d] = [cost(c), cost(d)];
    for _ in 0..40 {
        if at_c < at_d {
            (b, d, at_d) = (d, c, at_c);
            c = b - golden * (b - a);
            at_c = cost(c);
        } else {
            (a, c, at_c) = (c, d, at_d);
            d = a + golden * (b - a);
            at_d = cost(d);
        }
    }
    Some(0.5 * (a + b))
}
