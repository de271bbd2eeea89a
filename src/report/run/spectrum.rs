//! The spectrum of an x-t diagram: which frequencies run with which wave numbers. In a squeezed crystal its ridge is the dispersion relation.

use std::f64::consts::{PI, TAU};

use super::super::chart::ticks;
use super::super::colour::Scale;
use super::super::digits::short;
use super::super::svg::{Anchor, Svg};
use super::maps::{MARGIN, ROOM, paint};

/// Frequencies shown, at most, and wave numbers, at most.
const FREQUENCIES: usize = 210;
const NUMBERS: usize = 160;

/// What is shown reaches up to the frequency below which this part of the power lies.
const POWER: f64 = 0.999;

/// |V(q, f)| of the velocities (m/s) of layers over equally spaced times (s), to its greatest value; both ways along the wave together.
struct Spectrum {
    /// Wave numbers q (rad/layer), from 0 to π.
    numbers: Vec<f64>,
    /// Frequencies f (Hz), from the lowest on.
    frequencies: Vec<f64>,
    /// For each frequency the amplitude at each wave number.
    amplitude: Vec<Vec<f64>>,
}

/// Σ a_n exp(−i p n) for many p: real and imaginary part.
fn transform(values: impl Iterator<Item = [f64; 2]> + Clone, phase: f64) -> [f64; 2] {
    // One rotation after the other, begun anew before rounding adds up.
    let (sin, cos) = phase.sin_cos();
    let (mut turn, mut sum) = ([1.0, 0.0], [0.0; 2]);
    for (n, [real, imaginary]) in values.enumerate() {
        if n % 256 == 0 {
            let (sin, cos) = (phase * n as f64).sin_cos();
            turn = [cos, -sin];
        }
        sum[0] += real * turn[0] - imaginary * turn[1];
        sum[1] += real * turn[1] + imaginary * turn[0];
        turn = [turn[0] * cos + turn[1] * sin, turn[1] * cos - turn[0] * sin];
    }
    sum
}

impl Spectrum {
    fn of(times: &[f64], layers: &[Vec<f64>]) -> Self {
        let count = times.len();
        let interval = (times[count - 1] - times[0]) / (count - 1) as f64;
        // Hann's window, so that the ends of the record make no waves of their own.
        let window: Vec<f64> = (0..count).map(|k| (PI * (k as f64 + 0.5) / count as f64).sin().powi(2)).collect();
        let many = (layers.len() / 2 + 1).clamp(2, NUMBERS);
        let numbers: Vec<f64> = (0..many).map(|k| PI * k as f64 / (many - 1) as f64).collect();
        // Over the layers first: V(q, t), a complex number for each time.
        let over_layers: Vec<Vec<[f64; 2]>> = numbers
            .iter()
            .map(|&q| {
                (0..count).map(|k| transform(layers.iter().map(|layer| [layer[k] * window[k], 0.0]), q)).collect()
            })
            .collect();
        // A step of frequency is what the window resolves.
        let all = count / 2 + 1;
        let of = |k: usize| -> Vec<f64> {
            let phase = TAU * k as f64 / count as f64;
            let size = |[a, b]: [f64; 2]| a.hypot(b);
            let both = |at: &Vec<[f64; 2]>| {
                // Waves that run the other way have −q: the conjugate's transform at this frequency.
                let there = size(transform(at.iter().copied(), phase));
                there.hypot(size(transform(at.iter().map(|&[a, b]| [a, -b]), phase)))
            };
            over_layers.iter().map(both).collect()
        };
        let mut amplitude: Vec<Vec<f64>> = Vec::new();
        let power = |rows: &[Vec<f64>]| rows.iter().flatten().map(|a| a * a).sum::<f64>();
        // Parseval: the power of all frequencies, without transforming at all of them; of f and −f one half each.
        let whole = over_layers.iter().flatten().map(|[a, b]| a * a + b * b).sum::<f64>() * count as f64;
        while amplitude.len() < all && (amplitude.len() < 8 || power(&amplitude) < POWER * whole) {
            let next = amplitude.len();
            amplitude.push(of(next));
        }
        let shown = (amplitude.len() + amplitude.len() / 8 + 1).min(all);
        (amplitude.len()..shown).for_each(|k| amplitude.push(of(k)));
        let greatest = amplitude.iter().flatten().copied().fold(0.0, f64::max);
        if greatest > 0.0 {
            amplitude.iter_mut().flatten().for_each(|a| *a /= greatest);
        }
        let frequencies = (0..amplitude.len()).map(|k| k as f64 / (count as f64 * interval)).collect();
        Self { numbers, frequencies, amplitude }
    }
}

/// The spectrum of mean velocities along the wave (m/s) over time (s), layer by layer; none of fewer than 16 samples or 4 layers.
pub fn spectrum(title: &str, mut times: &[f64], layers: &[Vec<f64>]) -> Option<String> {
    // The last sample may come sooner than the others.
    if let [.., before, last] = times
        && last - before < (1.0 - 1e-6) * (times[1] - times[0])
    {
        times = &times[..times.len() - 1];
    }
    if times.len() < 16 || layers.len() < 4 {
        return None;
    }
    let Spectrum { numbers, frequencies, amplitude } = Spectrum::of(times, layers);
    let [left, top, right, bottom] = MARGIN;
    let mut svg = Svg::new(left + ROOM[0] + right, top + ROOM[1] + bottom, title);
    svg.text([left, 22.0], 14.0, Anchor::Start, r#"font-weight="bold""#, title);
    let scale = Scale::between(1e-3, 1.0);
    let cells = [numbers.len(), frequencies.len().min(FREQUENCIES)];
    paint(&mut svg, &scale, cells, |column, row| {
        // Upwards, and the greatest of those that share a cell.
        let row = cells[1] - 1 - row;
        let within = row * frequencies.len() / cells[1]..((row + 1) * frequencies.len() / cells[1]);
        amplitude[within].iter().map(|at| at[column]).fold(0.0, f64::max)
    });
    let highest =
        frequencies.last().copied().unwrap_or(1.0) * frequencies.len() as f64 / (frequencies.len() - 1) as f64;
    let (unit, name) = if highest < 1e5 { (1e3, "kHz") } else { (1e6, "MHz") };
    for tick in ticks(0.0, highest / unit, 8) {
        let at = top + (1.0 - tick * unit / highest) * ROOM[1];
        svg.line([left - 5.0, at], [left, at], r##"stroke="#555""##);
        svg.text([left - 9.0, at + 4.0], 11.0, Anchor::End, "", &short(tick));
    }
    for quarter in 0..=4 {
        let at = left + f64::from(quarter) / 4.0 * ROOM[0];
        svg.line([at, top + ROOM[1]], [at, top + ROOM[1] + 5.0], r##"stroke="#555""##);
        let words = ["0", "π/4", "π/2", "3π/4", "π"][quarter as usize];
        svg.text([at, top + ROOM[1] + 19.0], 11.0, Anchor::Middle, "", words);
    }
    svg.rectangle([left, top], ROOM, r##"fill="none" stroke="#555""##);
    svg.text([left + ROOM[0] / 2.0, top + ROOM[1] + 40.0], 12.0, Anchor::Middle, "", "wave number (rad per layer)");
    svg.text_upwards([18.0, top + ROOM[1] / 2.0], 12.0, "", &format!("frequency ({name})"));
    scale.bar(&mut svg, [left + ROOM[0] + 18.0, top], ROOM[1], "amplitude over the greatest", 1.0, [false, true]);
    Some(svg.finish())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A wave cos(q n − ω t), whichever way it runs, is one point of the spectrum: where its wave number and frequency are.
    #[test]
    fn a_plane_wave_is_a_point() {
        for (way, q, cycles) in [(1.0, PI / 4.0, 20.0), (-1.0, PI / 2.0, 37.0)] {
            let interval = 1e-6;
            let times: Vec<f64> = (0..256).map(|k| f64::from(k) * interval).collect();
            let frequency = cycles / (256.0 * interval);
            let layers: Vec<Vec<f64>> = (0..32)
                .map(|n| times.iter().map(|t| (q * f64::from(n) - way * TAU * frequency * t).cos()).collect())
                .collect();
            let found = Spectrum::of(&times, &layers);
            let greatest = (0..found.frequencies.len())
                .flat_map(|f| (0..found.numbers.len()).map(move |k| (f, k)))
                .max_by(|&(f, k), &(g, l)| found.amplitude[f][k].total_cmp(&found.amplitude[g][l]))
                .unwrap();
            assert!((found.numbers[greatest.1] - q).abs() < 1e-12, "{}", found.numbers[greatest.1]);
            assert!(
                (found.frequencies[greatest.0] / frequency - 1.0).abs() < 1e-9,
                "{}",
                found.frequencies[greatest.0]
            );
        }
    }
}
