//! Quantities as people write them: `"6.35 mm"` to `0.00635` and back.
//!
//! The only place that knows units and prefixes; everything inside granulens is SI.

use std::fmt;

/// What a number measures, and so which units it may be written in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dimension {
    /// Metres inside; `mm` in most files.
    Length,
    /// Seconds inside; `us` in most files.
    Time,
    /// Newtons inside; `kN` in most files.
    Force,
    /// Pascals inside; `GPa` or `MPa` in most files.
    Pressure,
    /// kg/m³ inside.
    Density,
    /// Radians inside; `deg` in most files.
    Angle,
    /// m/s inside.
    Speed,
    /// Kilograms inside.
    Mass,
    /// Joules inside.
    Energy,
    /// N/m inside; `MN/m` in most files.
    Stiffness,
    /// kg/s inside: force over speed at the end of a bar.
    Impedance,
    /// m/s² inside.
    Acceleration,
    /// 1/s inside.
    Rate,
    /// rad/s inside.
    Spin,
    /// A fraction inside; `%` in most files.
    Fraction,
}

type Unit = (&'static str, f64);

impl Dimension {
    /// Every way of writing the unit with its size in SI. The first is shown in messages.
    const fn units(self) -> &'static [Unit] {
        match self {
            Self::Length => &[
                ("mm", 1e-3),
                ("m", 1.0),
                ("cm", 1e-2),
                ("um", 1e-6),
                ("µm", 1e-6),
                ("μm", 1e-6),
                ("nm", 1e-9),
                ("in", 0.0254),
            ],
            Self::Time => &[("us", 1e-6), ("s", 1.0), ("ms", 1e-3), ("µs", 1e-6), ("μs", 1e-6), ("ns", 1e-9)],
            Self::Force => &[("kN", 1e3), ("N", 1.0), ("mN", 1e-3), ("MN", 1e6)],
            Self::Pressure => &[("MPa", 1e6), ("GPa", 1e9), ("Pa", 1.0), ("kPa", 1e3)],
            Self::Density => {
                &[("kg/m3", 1.0), ("kg/m^3", 1.0), ("kg/m³", 1.0), ("g/cm3", 1e3), ("g/cm^3", 1e3), ("g/cm³", 1e3)]
            }
            Self::Angle => &[("deg", std::f64::consts::PI / 180.0), ("rad", 1.0), ("°", std::f64::consts::PI / 180.0)],
            Self::Speed => &[("m/s", 1.0), ("mm/s", 1e-3), ("km/s", 1e3)],
            Self::Mass => &[("kg", 1.0), ("g", 1e-3), ("mg", 1e-6)],
            Self::Energy => &[("J", 1.0), ("mJ", 1e-3), ("kJ", 1e3), ("uJ", 1e-6)],
            Self::Stiffness => &[("MN/m", 1e6), ("N/m", 1.0), ("kN/m", 1e3), ("GN/m", 1e9)],
            Self::Impedance => &[("kg/s", 1.0), ("N s/m", 1.0), ("t/s", 1e3)],
            Self::Acceleration => &[("m/s2", 1.0), ("m/s^2", 1.0), ("m/s²", 1.0), ("mm/s2", 1e-3)],
            Self::Rate => &[("1/s", 1.0), ("1/ms", 1e3), ("1/us", 1e6)],
            Self::Spin => &[("rad/s", 1.0), ("deg/s", std::f64::consts::PI / 180.0)],
            Self::Fraction => &[("%", 1e-2)],
        }
    }

    /// A well-formed value, for messages: `"6.35 mm"`.
    pub const fn example(self) -> &'static str {
        match self {
            Self::Length => "6.35 mm",
            Self::Time => "20 us",
            Self::Force => "26 kN",
            Self::Pressure => "200 GPa",
            Self::Density => "7650 kg/m3",
            Self::Angle => "60 deg",
            Self::Speed => "20 m/s",
            Self::Mass => "2.3 kg",
            Self::Energy => "0.3 J",
            Self::Stiffness => "20 MN/m",
            Self::Impedance => "11000 kg/s",
            Self::Acceleration => "9.81 m/s2",
            Self::Rate => "100 1/s",
            Self::Spin => "50 rad/s",
            Self::Fraction => "0.1 %",
        }
    }

    /// Reads a number with its unit, such as `"26 kN"`, into SI.
    ///
    /// # Errors
    /// When the number or the unit is missing, unknown, or not finite. The message says what was expected.
    ///
    /// ```
    /// use granulens_core::units::Dimension;
    /// assert_eq!(Dimension::Force.parse("26 kN"), Ok(26000.0));
    /// assert!(Dimension::Force.parse("26").is_err());
    /// assert!(Dimension::Force.parse("26 mm").is_err());
    /// ```
    pub fn parse(self, text: &str) -> Result<f64, UnitError> {
        let text = text.trim();
        let split = text
            .char_indices()
            .find(|&(at, c)| {
                let exponent = matches!(c, 'e' | 'E')
                    && text[at + 1..].starts_with(|n: char| n.is_ascii_digit() || n == '-' || n == '+')
                    && text[..at].ends_with(|n: char| n.is_ascii_digit() || n == '.');
                !(c.is_ascii_digit() || matches!(c, '.' | '+' | '-' | '_') || exponent)
            })
            .map_or(text.len(), |(at, _)| at);
        // Lengths come in fractions of an inch; rates have a slash in their unit.
        let (value, split) = match Some(text).filter(|_| matches!(self, Self::Length)).and_then(fraction) {
            Some((value, split)) => (Some(value), split),
            None => (None, split),
        };
        let (number, unit) = (text[..split].trim(), text[split..].trim());
        let fail = |fault| UnitError { dimension: self, text: text.to_owned(), fault };
        if number.is_empty() {
            return Err(fail(Fault::NoNumber));
        }
        let value = match value {
            Some(value) => value,
            None => number.replace('_', "").parse().map_err(|_| fail(Fault::NoNumber))?,
        };
        if unit.is_empty() {
            return Err(fail(Fault::NoUnit));
        }
        let &(_, scale) = self
            .units()
            .iter()
            .find(|(symbol, _)| *symbol == unit)
            .ok_or_else(|| fail(Fault::UnknownUnit(unit.to_owned())))?;
        let si = scaled(value, scale);
        if si.is_finite() { Ok(si) } else { Err(fail(Fault::NotFinite)) }
    }

    /// Writes an SI value with the unit and prefix in which it is most readable: `0.00635` as `6.35 mm`.
    pub fn show(self, si: f64) -> String {
        let units = self.units();
        let (symbol, scale) = units
            .iter()
            .filter(|(symbol, _)| symbol.is_ascii() && !matches!(*symbol, "in" | "cm" | "rad" | "g/cm3" | "g/cm^3"))
            .filter(|&&(_, scale)| {
                let shown = (si / scale).abs();
                (1.0..1000.0).contains(&shown)
            })
            .min_by(|a, b| (si / a.1).abs().total_cmp(&(si / b.1).abs()))
            .copied()
            .unwrap_or(units[0]);
        format!("{} {symbol}", Digits(unscaled(si, scale)))
    }
}

/// The value of a text that begins with a fraction, `3/8` or `1 1/2` or `1-1/2`, and where that ends.
fn fraction(text: &str) -> Option<(f64, usize)> {
    let slash = text.find('/')?;
    let end = text[slash + 1..].find(|c: char| !c.is_ascii_digit()).map_or(text.len(), |at| slash + 1 + at);
    let whole = |digits: &str| digits.parse::<u32>().ok().map(f64::from);
    let below = whole(&text[slash + 1..end]).filter(|&below| below > 0.0)?;
    let (sign, before) = match text[..slash].strip_prefix('-') {
        Some(before) => (-1.0, before),
        None => (1.0, &text[..slash]),
    };
    let (ones, above) = match before.rsplit_once([' ', '-']) {
        Some((ones, above)) => (whole(ones.trim())?, whole(above)?),
        None => (0.0, whole(before)?),
    };
    Some((sign * (ones + above / below), end))
}

/// Multiplies by a unit's size. Decimal prefixes below one are divided instead, so that `20 us` is exactly `20e-6`.
fn scaled(value: f64, scale: f64) -> f64 {
    let inverse = (1.0 / scale).round();
    if scale < 1.0 && (inverse * scale - 1.0).abs() < 1e-15 { value / inverse } else { value * scale }
}

fn unscaled(si: f64, scale: f64) -> f64 {
    let inverse = (1.0 / scale).round();
    if scale < 1.0 && (inverse * scale - 1.0).abs() < 1e-15 { si * inverse } else { si / scale }
}

/// Shows up to six significant digits without trailing zeros.
struct Digits(f64);

impl fmt::Display for Digits {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let rounded: f64 = format!("{:.5e}", self.0).parse().unwrap_or(self.0);
        write!(f, "{rounded}")
    }
}

/// Why a quantity could not be read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnitError {
    dimension: Dimension,
    text: String,
    fault: Fault,
}

#[derive(Clone, Debug, PartialEq, Eq)]
enum Fault {
    NoNumber,
    NoUnit,
    UnknownUnit(String),
    NotFinite,
}

impl fmt::Display for UnitError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.fault {
            Fault::NoNumber => write!(f, "\"{}\" is not a number with a unit", self.text)?,
            Fault::NoUnit => write!(f, "\"{}\" has no unit", self.text)?,
            Fault::UnknownUnit(unit) => write!(f, "\"{}\": unknown unit \"{unit}\"", self.text)?,
            Fault::NotFinite => write!(f, "\"{}\" is not finite", self.text)?,
        }
        let symbols: Vec<&str> = self.dimension.units().iter().map(|u| u.0).filter(|s| s.is_ascii()).collect();
        write!(f, "; write it like \"{}\" (units: {})", self.dimension.example(), symbols.join(", "))
    }
}

impl std::error::Error for UnitError {}

#[cfg(test)]
mod tests {
    use super::Dimension::{Density, Force, Length, Time};

    /// Division by an exact power of ten is correctly rounded, so the parsed value is the literal.
    #[test]
    fn quantities_are_the_literal_they_name() {
        assert_eq!(Length.parse("6.35 mm"), Ok(6.35e-3));
        assert_eq!(Time.parse("20 us"), Ok(20e-6));
        assert_eq!(Time.parse("5e-8 s"), Ok(5e-8));
        assert_eq!(Time.parse("350us"), Ok(350e-6));
        assert_eq!(Force.parse("10.5 kN"), Ok(10500.0));
        assert_eq!(Density.parse("7.65 g/cm3"), Ok(7650.0));
    }

    /// Every unit by its definition (BIPM 2019, the SI brochure; the inch is 25.4 mm), and all that are known.
    #[test]
    fn every_unit_is_what_it_is_defined_as() {
        use super::Dimension::*;
        let degree = std::f64::consts::PI / 180.0;
        let defined: &[(super::Dimension, &[(&str, f64)])] = &[
            (
                Length,
                &[
                    ("nm", 1e-9),
                    ("um", 1e-6),
                    ("µm", 1e-6),
                    ("μm", 1e-6),
                    ("mm", 1e-3),
                    ("cm", 1e-2),
                    ("m", 1.0),
                    ("in", 25.4e-3),
                ],
            ),
            (Time, &[("ns", 1e-9), ("us", 1e-6), ("µs", 1e-6), ("μs", 1e-6), ("ms", 1e-3), ("s", 1.0)]),
            (Force, &[("mN", 1e-3), ("N", 1.0), ("kN", 1e3), ("MN", 1e6)]),
            (Pressure, &[("Pa", 1.0), ("kPa", 1e3), ("MPa", 1e6), ("GPa", 1e9)]),
            // 1 g/cm³ = 10⁻³ kg / 10⁻⁶ m³.
            (
                Density,
                &[("kg/m3", 1.0), ("kg/m^3", 1.0), ("kg/m³", 1.0), ("g/cm3", 1e3), ("g/cm^3", 1e3), ("g/cm³", 1e3)],
            ),
            (Angle, &[("rad", 1.0), ("deg", degree), ("°", degree)]),
            (Speed, &[("mm/s", 1e-3), ("m/s", 1.0), ("km/s", 1e3)]),
            (Mass, &[("mg", 1e-6), ("g", 1e-3), ("kg", 1.0)]),
            (Energy, &[("uJ", 1e-6), ("mJ", 1e-3), ("J", 1.0), ("kJ", 1e3)]),
            (Stiffness, &[("N/m", 1.0), ("kN/m", 1e3), ("MN/m", 1e6), ("GN/m", 1e9)]),
            (Impedance, &[("kg/s", 1.0), ("N s/m", 1.0), ("t/s", 1e3)]),
            (Acceleration, &[("mm/s2", 1e-3), ("m/s2", 1.0), ("m/s^2", 1.0), ("m/s²", 1.0)]),
            (Rate, &[("1/s", 1.0), ("1/ms", 1e3), ("1/us", 1e6)]),
            (Spin, &[("rad/s", 1.0), ("deg/s", degree)]),
            (Fraction, &[("%", 1e-2)]),
        ];
        for (dimension, units) in defined {
            for (unit, si) in *units {
                let read = dimension.parse(&format!("3 {unit}")).unwrap();
                assert!((read / (3.0 * si) - 1.0).abs() < 1e-15, "3 {unit} is {read}");
            }
            let known: Vec<&str> = dimension.units().iter().map(|unit| unit.0).collect();
            let listed: Vec<&str> = units.iter().map(|unit| unit.0).collect();
            assert!(
                known.len() == listed.len() && known.iter().all(|unit| listed.contains(unit)),
                "{known:?} {listed:?}"
            );
        }
    }

    #[test]
    fn inches_come_in_fractions() {
        for (fraction, decimal) in
            [("3/8 in", "0.375 in"), ("1 1/2 in", "1.5 in"), ("1-1/4in", "1.25 in"), ("-1/2 in", "-0.5 in")]
        {
            assert_eq!(Length.parse(fraction), Length.parse(decimal), "{fraction}");
        }
        for wrong in ["3/0 in", "3/ in", "/8 in", "3/8", "3//8 in", "1.5/2 in", "3/8 kN"] {
            assert!(Length.parse(wrong).is_err(), "{wrong}");
        }
        assert_eq!(super::Dimension::Rate.parse("100 1/s"), Ok(100.0));
    }

    #[test]
    fn quantities_show_as_they_were_written() {
        for (dimension, text) in [(Length, "6.35 mm"), (Time, "20 us"), (Force, "26 kN"), (Time, "100 ns")] {
            assert_eq!(dimension.show(dimension.parse(text).unwrap()), text);
        }
        assert_eq!(Density.show(7650.0), "7650 kg/m3");
    }

    #[test]
    fn what_is_wrong_is_named() {
        let message = |text: &str| Force.parse(text).unwrap_err().to_string();
        assert!(message("26").contains("has no unit"));
        assert!(message("26 kg").contains("unknown unit \"kg\""));
        assert!(message("kN").contains("not a number"));
        assert!(message("").contains("not a number"));
        assert!(message("1e999 kN").contains("not finite"));
        assert!(message("nan kN").contains("not a number"));
        assert!(message("é kN").contains("not a number"));
    }
}
