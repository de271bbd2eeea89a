//! Transmission over frequency, and where the normal modes lie.

use super::chart::{COLOURS, Chart, Line};

/// Below this (dB) nothing is told apart: what gets through is then less than a millionth of the driven amplitude.
const FLOOR: f64 = -120.0;

/// Draws transmission, amplitude over amplitude, over frequencies (Hz), in decibels; and below it a stroke for each normal mode.
pub fn transmission(name: &str, frequencies: &[f64], transmission: &[f64], modes: &[f64]) -> String {
    let points: Vec<[f64; 2]> = (frequencies.iter().zip(transmission))
        .map(|(frequency, part)| [frequency * 1e-3, (20.0 * part.log10()).max(FLOOR)])
        .collect();
    let low = points.iter().map(|p| p[1]).fold(0.0, f64::min);
    let line = |name: &str, colour: &str, points| Line {
        name: name.to_owned(),
        colour: colour.to_owned(),
        dashed: false,
        points,
    };
    let strokes = modes.iter().enumerate().map(|(k, mode)| {
        let at = mode * 1e-3;
        let name = if k == 0 { "normal modes" } else { "" };
        line(name, COLOURS[1], vec![[at, 1.08 * low], [at, 1.02 * low]])
    });
    let lines = std::iter::once(line("transmission", COLOURS[0], points)).chain(strokes).collect();
    Chart {
        title: format!("{name}: last layer over first"),
        labels: ["frequency (kHz)".to_owned(), "transmission (dB)".to_owned()],
        lines,
    }
    .svg()
}
