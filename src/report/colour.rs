//! Colours for numbers and for materials, and the bar that explains them.

use super::digits::significant;
use super::svg::{Anchor, Svg};

/// Viridis at equal steps from 0 to 1, between which colours are interpolated in sRGB. Lightness rises evenly, so the maps
/// survive a greyscale printer and colour-blind readers. Source: S. van der Walt & N. Smith, "viridis", matplotlib 1.5
/// (2015), every 32nd entry of the table, released under CC0.
const VIRIDIS: [[u8; 3]; 9] = [
    [68, 1, 84],
    [71, 45, 123],
    [59, 82, 139],
    [44, 114, 142],
    [33, 145, 140],
    [40, 174, 128],
    [94, 201, 98],
    [173, 220, 48],
    [253, 231, 37],
];

/// From dark to light without hue, for papers that are printed so: equal steps of lightness, the ends neither black nor white.
const GREYS: [[u8; 3]; 9] = [
    [38, 38, 38],
    [62, 62, 62],
    [86, 86, 86],
    [111, 111, 111],
    [137, 137, 137],
    [163, 163, 163],
    [190, 190, 190],
    [217, 217, 217],
    [245, 245, 245],
];

/// Which colours a surface is painted with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Palette {
    /// Viridis.
    #[default]
    Viridis,
    /// Greys.
    Grey,
}

impl Palette {
    /// Their names, for options.
    pub const ALL: [(&'static str, Self); 2] = [("viridis", Self::Viridis), ("grey", Self::Grey)];

    fn table(self) -> &'static [[u8; 3]] {
        match self {
            Self::Viridis => &VIRIDIS,
            Self::Grey => &GREYS,
        }
    }
}

/// From blue by white to red at equal steps, between which colours are interpolated in sRGB; both ends are equally dark, and
/// colour-blind readers tell them apart. Source: the diverging scheme RdBu of eleven classes, C. Brewer and M. Harrower,
/// ColorBrewer 2.0 (Apache 2.0), from its last entry to its first.
const BLUE_TO_RED: [[u8; 3]; 11] = [
    [5, 48, 97],
    [33, 102, 172],
    [67, 147, 195],
    [146, 197, 222],
    [209, 229, 240],
    [247, 247, 247],
    [253, 219, 199],
    [244, 165, 130],
    [214, 96, 77],
    [178, 24, 43],
    [103, 0, 31],
];

/// Number of colours that a map uses: more than an eye tells apart, few enough to paint each as one element.
pub const LEVELS: usize = 64;

/// What is painted where there is no value.
pub const MISSING: &str = "#ffffff";

/// Fill colour of a material by its index in the outcome's list.
pub fn material(index: usize) -> &'static str {
    crate::page::ink(index).fill
}

/// The colour of one of [`LEVELS`] levels, from dark (0) to light.
pub fn level(level: usize) -> String {
    mixed(&VIRIDIS, level.min(LEVELS - 1) as f64 / (LEVELS - 1) as f64)
}

/// The colour at a place from 0 to 1 in a table of colours at equal steps.
fn mixed(table: &[[u8; 3]], place: f64) -> String {
    let position = place * (table.len() - 1) as f64;
    let below = (position as usize).min(table.len() - 2);
    let share = position - below as f64;
    let mix = |k: usize| {
        let (a, b) = (f64::from(table[below][k]), f64::from(table[below + 1][k]));
        (a + (b - a) * share).round() as u8
    };
    format!("#{:02x}{:02x}{:02x}", mix(0), mix(1), mix(2))
}

/// The colours of all levels, for a page that paints maps of its own: of values from low to high, and of values on both sides of zero.
pub fn scale_colours() -> [Vec<String>; 2] {
    let diverging = Scale::diverging(-1.0, 1.0);
    [(0..LEVELS).map(level).collect(), (0..LEVELS - 1).map(|k| diverging.colour(k)).collect()]
}

/// From values to colours: one range for all maps of a figure. Values outside take the colour of the nearer end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    low: f64,
    high: f64,
    kind: Kind,
    palette: Palette,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Linear,
    Logarithmic,
    Diverging,
}

impl Scale {
    /// Proportional to the value, from zero.
    pub fn linear(high: f64) -> Self {
        Self {
            low: 0.0,
            high: if high.is_finite() && high > 0.0 { high } else { 1.0 },
            kind: Kind::Linear,
            palette: Palette::Viridis,
        }
    }

    /// Proportional to the value, on both sides of zero: white there, blue below and red above, equal values on either side
    /// equally strong. The scale reaches from `low` to `high`, between which zero lies.
    pub fn diverging(low: f64, high: f64) -> Self {
        let end = |value: f64| if value.is_finite() { value } else { 0.0 };
        let (low, high) = (end(low).min(0.0), end(high).max(0.0));
        let high = if high > low { high } else { 1.0 };
        Self { low, high, kind: Kind::Diverging, palette: Palette::Viridis }
    }

    /// Proportional to the logarithm, over the values that there are: from the greatest down to one that only a fiftieth
    /// of the positive ones lie below, but over one to three decades.
    pub fn logarithmic(values: impl IntoIterator<Item = f64>) -> Self {
        let mut values: Vec<f64> = values.into_iter().filter(|v| v.is_finite() && *v > 0.0).collect();
        values.sort_by(f64::total_cmp);
        let high = values.last().copied().unwrap_or(1.0);
        let low = values.get(values.len() / 50).copied().unwrap_or(high);
        Self { low: low.clamp(high / 1e3, high / 10.0), high, kind: Kind::Logarithmic, palette: Palette::Viridis }
    }

    /// Proportional to the logarithm between two positive values.
    pub fn between(low: f64, high: f64) -> Self {
        // Equal ends would leave no extent to divide by.
        Self { low, high: high.max(low * 1.01), kind: Kind::Logarithmic, palette: Palette::Viridis }
    }

    /// With other colours.
    pub fn painted(self, palette: Palette) -> Self {
        Self { palette, ..self }
    }

    /// The upper end; values above it are not told apart.
    pub fn high(&self) -> f64 {
        self.high
    }

    /// The lower end; values below it are not told apart.
    pub fn low(&self) -> f64 {
        self.low
    }

    /// Where a value lies, 0 at the lower end and 1 at the upper one, without a limit.
    fn position(&self, value: f64) -> f64 {
        if self.kind == Kind::Logarithmic {
            if value > 0.0 { (value / self.low).ln() / (self.high / self.low).ln() } else { 0.0 }
        } else {
            (value - self.low) / (self.high - self.low)
        }
    }

    /// The value that lies at a place, 0 at the lower end and 1 at the upper one.
    fn value(&self, place: f64) -> f64 {
        if self.kind == Kind::Logarithmic {
            self.low * (self.high / self.low).powf(place)
        } else {
            self.low + place * (self.high - self.low)
        }
    }

    /// The level of a value; the ends of the scale hold all that lies beyond them.
    pub fn level(&self, value: f64) -> usize {
        if self.kind == Kind::Diverging {
            // An odd number of levels, of which the one in the middle is that of zero.
            let part = (value / self.high.max(-self.low)).clamp(-1.0, 1.0);
            return ((0.5 + 0.5 * part) * (LEVELS - 2) as f64).round() as usize;
        }
        let position = self.position(value).clamp(0.0, 1.0);
        ((position * LEVELS as f64) as usize).min(LEVELS - 1)
    }

    /// The colour of a level of this scale.
    pub fn colour(&self, at: usize) -> String {
        match self.kind {
            Kind::Diverging => mixed(&BLUE_TO_RED, at.min(LEVELS - 2) as f64 / (LEVELS - 2) as f64),
            Kind::Linear | Kind::Logarithmic => {
                mixed(self.palette.table(), at.min(LEVELS - 1) as f64 / (LEVELS - 1) as f64)
            }
        }
    }

    /// Round values within the scale.
    fn ticks(&self) -> Vec<f64> {
        if self.kind == Kind::Logarithmic {
            let first = self.low.log10().floor() as i32;
            let last = self.high.log10().ceil() as i32;
            // Few decades hold too few of the steps 1, 2, 5.
            let steps =
                if self.high < 30.0 * self.low { &[1.0, 1.5, 2.0, 3.0, 5.0, 7.0][..] } else { &[1.0, 2.0, 5.0] };
            (first..=last)
                .flat_map(|power| steps.iter().map(move |m| m * 10_f64.powi(power)))
                .filter(|&t| t >= self.low * 0.999 && t <= self.high * 1.001)
                .collect()
        } else {
            super::chart::ticks(self.low, self.high, 6)
        }
    }

    /// Paints the bar, upright, with its ticks to the right. `beyond` says whether values lie above and below the scale;
    /// arrowheads in the end colours then show that the bar goes on.
    pub fn bar(&self, svg: &mut Svg, corner: [f64; 2], height: f64, label: &str, unit_size: f64, beyond: [bool; 2]) {
        self.sized_bar(svg, corner, height, label, (unit_size, 1.0), beyond);
    }

    /// The same with letters and everything beside the bar `size` times as large.
    pub fn sized_bar(
        &self,
        svg: &mut Svg,
        [x, y]: [f64; 2],
        height: f64,
        label: &str,
        (unit_size, size): (f64, f64),
        beyond: [bool; 2],
    ) {
        const WIDTH: f64 = 14.0;
        let step = height / LEVELS as f64;
        for k in 0..LEVELS {
            // A little overlap hides the seams that anti-aliasing leaves between neighbours.
            let top = y + height - (k + 1) as f64 * step;
            let overlap = if k == 0 { 0.0 } else { 0.6 };
            let value = self.value((k as f64 + 0.5) / LEVELS as f64);
            let fill = format!(r#"fill="{}""#, self.colour(self.level(value)));
            svg.rectangle([x, top], [WIDTH, step + overlap], &fill);
        }
        let (middle, bottom) = (x + WIDTH / 2.0, y + height);
        let outline = r##"stroke="#555" stroke-width="0.7""##;
        svg.rectangle([x, y], [WIDTH, height], &format!(r#"fill="none" {outline}"#));
        if beyond[0] {
            let head = [[x, y - 2.0], [x + WIDTH, y - 2.0], [middle, y - 12.0]];
            svg.polygon(&head, &format!(r#"fill="{}" {outline}"#, self.colour(self.level(self.high))));
        }
        if beyond[1] {
            let head = [[x, bottom + 2.0], [x + WIDTH, bottom + 2.0], [middle, bottom + 12.0]];
            svg.polygon(&head, &format!(r#"fill="{}" {outline}"#, self.colour(self.level(self.low))));
        }
        for tick in self.ticks() {
            let at = bottom - self.position(tick) * height;
            svg.line([x + WIDTH, at], [x + WIDTH + 4.0, at], r##"stroke="#555""##);
            let words = significant(tick / unit_size, 2);
            svg.text([x + WIDTH + 7.0, at + 4.0 * size], 11.0 * size, Anchor::Start, "", &words);
        }
        svg.text_upwards([x + WIDTH + 48.0 * size, y + height / 2.0], 12.0 * size, "", label);
    }
}

/// Round numbers from zero to `high`: steps of 1, 2 or 5, at most `count` of them.
pub fn ticks(high: f64, count: usize) -> Vec<f64> {
    let step = round_up(high / count as f64);
    (0..=count).map(|k| k as f64 * step).filter(|&t| t <= high * 1.000_001).collect()
}

/// The next number of the form 1, 2 or 5 times a power of ten; one where there is none.
pub fn round_up(value: f64) -> f64 {
    if !(value.is_finite() && value > 0.0) {
        return 1.0;
    }
    let power = 10_f64.powf(value.log10().floor());
    [1.0, 2.0, 5.0].map(|m| m * power).into_iter().find(|&c| c >= value * 0.999_999).unwrap_or(10.0 * power)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_map_runs_from_dark_to_light() {
        assert_eq!(level(0), "#440154");
        assert_eq!(level(LEVELS - 1), "#fde725");
        let lightness = |k: usize| {
            let text = level(k);
            let channel = |at: usize| f64::from(u8::from_str_radix(&text[at..at + 2], 16).unwrap());
            0.2126 * channel(1) + 0.7152 * channel(3) + 0.0722 * channel(5)
        };
        assert!((1..LEVELS).all(|k| lightness(k) > lightness(k - 1)));
    }

    #[test]
    fn values_beyond_the_scale_take_its_ends() {
        for scale in [Scale::linear(2.0), Scale::logarithmic([0.5, 2.0])] {
            assert_eq!(scale.level(-1.0), 0);
            assert_eq!(scale.level(0.0), 0);
            assert_eq!(scale.level(1e9), LEVELS - 1);
        }
        // Nothing moved: no division by zero.
        assert_eq!(Scale::linear(0.0).level(0.0), 0);
        assert_eq!(Scale::logarithmic([0.0, f64::NAN]).level(0.0), 0);
    }

    /// White at rest, equally strong on both sides, and nothing below zero where nothing goes back.
    #[test]
    fn a_diverging_scale_is_white_at_zero() {
        let scale = Scale::diverging(-1.0, 4.0);
        assert_eq!(scale.colour(scale.level(0.0)), "#f7f7f7");
        assert_eq!(scale.colour(scale.level(4.0)), "#67001f");
        // A quarter of the way to blue, as strong as a quarter of the way to red.
        let middle = scale.level(0.0);
        assert_eq!(middle - scale.level(-1.0), scale.level(1.0) - middle);
        assert!(scale.level(-1.0) > scale.level(-9.0), "the bar ends before the map does");
        assert_eq!(scale.ticks(), [-1.0, 0.0, 1.0, 2.0, 3.0, 4.0]);
        assert_eq!(Scale::diverging(0.0, 0.0).level(0.0), middle);
    }

    #[test]
    fn ticks_are_round() {
        assert_eq!(ticks(0.5, 6), [0.0, 0.1, 0.2, 0.300_000_000_000_000_04, 0.4, 0.5]);
        assert_eq!(round_up(0.31), 0.5);
        assert_eq!(round_up(7.0), 10.0);
        assert_eq!(round_up(f64::NAN), 1.0);
    }
}
