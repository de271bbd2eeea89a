//! How a number is distributed, with the bounds that are asked of it.

use super::colour::round_up;
use super::digits::short;
use super::svg::{Anchor, Svg};

/// Room for the bars (px), and around them: left, top, right, bottom.
const ROOM: [f64; 2] = [640.0, 260.0];
const MARGIN: [f64; 4] = [64.0, 40.0, 24.0, 52.0];

/// A bound: where it lies and what it is called.
pub(crate) type Bound = (f64, String);

/// Numbers in bars of equal width; `bounds` are drawn as lines across.
pub(crate) fn histogram(title: &str, label: &str, values: &[f64], bounds: &[Bound]) -> String {
    let [left, top, right, bottom] = MARGIN;
    let mut svg = Svg::new(left + ROOM[0] + right, top + ROOM[1] + bottom, title);
    svg.text([left, 22.0], 14.0, Anchor::Start, r#"font-weight="bold""#, title);
    let finite: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
    let all = || finite.iter().copied().chain(bounds.iter().map(|bound| bound.0));
    let (low, high) = (all().fold(f64::INFINITY, f64::min), all().fold(f64::NEG_INFINITY, f64::max));
    if finite.is_empty() {
        svg.text([left, top + 40.0], 12.0, Anchor::Start, "", "no piece ran to its end");
        return svg.finish();
    }
    // About the square root of their number, but never fewer than a few, on round borders.
    let bars = (finite.len() as f64).sqrt().clamp(6.0, 30.0);
    let width = round_up(((high - low) / bars).max(1e-9 * high.abs()).max(f64::MIN_POSITIVE));
    let first = (low / width).floor();
    let count = ((high / width).floor() - first) as usize + 1;
    let mut heights = vec![0_usize; count];
    for value in &finite {
        heights[((value / width).floor() - first).clamp(0.0, (count - 1) as f64) as usize] += 1;
    }
    let greatest = heights.iter().copied().max().unwrap_or(1).max(1) as f64;
    let x = |value: f64| left + (value / width - first) / count as f64 * ROOM[0];
    let y = |height: f64| top + ROOM[1] * (1.0 - height / (1.05 * greatest));
    let step = round_up(greatest / 5.0).max(1.0);
    for k in 0..=(greatest / step) as usize {
        let at = y(step * k as f64);
        svg.line([left, at], [left + ROOM[0], at], r##"stroke="#e2e2e2""##);
        svg.text([left - 8.0, at + 4.0], 11.0, Anchor::End, "", &short(step * k as f64));
    }
    for (k, &height) in heights.iter().enumerate().filter(|(_, height)| **height > 0) {
        let from = x((first + k as f64) * width);
        let size = [ROOM[0] / count as f64 - 1.0, y(0.0) - y(height as f64)];
        svg.rectangle([from + 0.5, y(height as f64)], size, r##"fill="#3f7fb0""##);
    }
    let every = round_up(width * count as f64 / 8.0).max(width);
    let mut tick = ((first * width) / every).ceil() * every;
    while tick <= (first + count as f64) * width * (1.0 + 1e-9) {
        svg.line([x(tick), top + ROOM[1]], [x(tick), top + ROOM[1] + 5.0], r##"stroke="#555""##);
        svg.text([x(tick), top + ROOM[1] + 19.0], 11.0, Anchor::Middle, "", &short(tick));
        tick += every;
    }
    svg.rectangle([left, top], ROOM, r##"fill="none" stroke="#555""##);
    for (k, (at, name)) in bounds.iter().enumerate() {
        svg.line(
            [x(*at), top],
            [x(*at), top + ROOM[1]],
            r##"stroke="#d55e00" stroke-width="2" stroke-dasharray="6 4""##,
        );
        // A name stands where there is room for it.
        let is_left = x(*at) > left + 0.6 * ROOM[0];
        let (to, anchor) = if is_left { (-6.0, Anchor::End) } else { (6.0, Anchor::Start) };
        svg.text([x(*at) + to, top + 16.0 + 16.0 * k as f64], 12.0, anchor, r##"fill="#a04600""##, name);
    }
    svg.text([left + ROOM[0] / 2.0, top + ROOM[1] + 40.0], 12.0, Anchor::Middle, "", label);
    svg.text_upwards([18.0, top + ROOM[1] / 2.0], 12.0, "", "pieces");
    svg.finish()
}
