//! Grades of balls: what a maker promises of diameters.
//!
//! A *lot* is made in one go: the mean diameters of its balls lie within the lot's variation. What the lot's own mean is, is another matter:
//! it is sorted into gauges, and may be as far from the nominal diameter as the grade allows.

/// What a grade promises.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grade {
    /// `G100`; grades of ABMA that ISO does not know end with A.
    pub name: &'static str,
    /// V_DwL (m): greatest less smallest mean diameter of the balls of a lot.
    pub lot: f64,
    /// How far a lot's mean may lie from the gauge that was ordered (m): half the gauge interval I_G. Where balls are not sorted into
    /// gauges, as far as from the nominal diameter.
    pub one_gauge: f64,
    /// How far it may lie from the nominal diameter (m), where any of the preferred gauges may be delivered.
    pub any_gauge: f64,
    /// Where this is printed.
    pub source: &'static str,
}

const ISO: &str = "ISO 3290-1:2014, table of grades: lot diameter variation, gauge interval, preferred gauges";
const ABMA: &str = "ABMA Std 10A, table of grades: lot diameter variation, nominal ball diameter tolerance";

const fn iso(name: &'static str, lot: f64, interval: f64, gauges: f64) -> Grade {
    Grade {
        name,
        lot: lot * 1e-6,
        one_gauge: 0.5e-6 * interval,
        any_gauge: gauges * 1e-6 + 0.5e-6 * interval,
        source: ISO,
    }
}

const fn abma(name: &'static str, lot: f64, tolerance: f64) -> Grade {
    Grade { name, lot: lot * 1e-6, one_gauge: tolerance * 1e-6, any_gauge: tolerance * 1e-6, source: ABMA }
}

/// All grades, the finest first (ISO 3290-1:2014 and ABMA Std 10A). Of ISO lot variation, gauge interval and outermost preferred gauge (µm); of ABMA, above G200, lot variation
/// and tolerance of the nominal diameter (µm).
pub const GRADES: &[Grade] = &[
    iso("G3", 0.13, 0.5, 5.0),
    iso("G5", 0.25, 1.0, 5.0),
    iso("G10", 0.5, 1.0, 9.0),
    iso("G16", 0.8, 2.0, 10.0),
    iso("G20", 1.0, 2.0, 10.0),
    iso("G24", 1.2, 2.0, 12.0),
    iso("G28", 1.4, 2.0, 12.0),
    iso("G40", 2.0, 4.0, 16.0),
    iso("G60", 3.0, 6.0, 18.0),
    iso("G100", 5.0, 10.0, 40.0),
    iso("G200", 10.0, 15.0, 60.0),
    abma("G500", 25.0, 50.0),
    abma("G1000", 50.0, 125.0),
    abma("G2000", 100.0, 250.0),
];

impl Grade {
    /// By its name.
    pub fn find(name: &str) -> Option<&'static Self> {
        GRADES.iter().find(|grade| grade.name.eq_ignore_ascii_case(name))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A coarser grade of a standard promises no more in any respect.
    #[test]
    fn grades_are_in_order() {
        for pair in GRADES.windows(2).filter(|pair| pair[0].source == pair[1].source) {
            assert!(pair[0].lot < pair[1].lot, "{}", pair[1].name);
            assert!(
                pair[0].one_gauge <= pair[1].one_gauge && pair[0].any_gauge <= pair[1].any_gauge,
                "{}",
                pair[1].name
            );
        }
        let g100 = Grade::find("g100").unwrap();
        assert!((g100.lot - 5e-6).abs() < 1e-18 && (g100.one_gauge - 5e-6).abs() < 1e-18);
        assert_eq!(Grade::find("G7"), None);
    }
}
