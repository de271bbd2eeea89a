//! The one table of what can be measured of a layout: name, symbol, unit, which way is better, where it comes from, and how it is
//! read from [`Scores`]. Files, options, JSON, CSV, tables and pages take all of this from here.
//!
//! A new measure is a row of the table, and a line where it is computed.

use serde::{Deserialize, Serialize};

use crate::units::Dimension;

/// Unit of a measure, always SI.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// A plain number.
    Ratio,
    /// A number of things, which may be zero.
    Count,
    /// Of whatever currency the prices are in.
    Money,
    /// J
    Joule,
    /// kg m/s
    NewtonSecond,
    /// N
    Newton,
    /// s
    Second,
    /// kg
    Kilogram,
}

impl Unit {
    /// As it is written; empty for plain numbers, counts and prices.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Ratio | Self::Count | Self::Money => "",
            Self::Joule => "J",
            Self::NewtonSecond => "kg m/s",
            Self::Newton => "N",
            Self::Second => "s",
            Self::Kilogram => "kg",
        }
    }

    /// What a quantity in a file is read as; none for plain numbers, and for momenta, which no file writes with a unit.
    pub const fn dimension(self) -> Option<Dimension> {
        match self {
            Self::Ratio | Self::Count | Self::Money | Self::NewtonSecond => None,
            Self::Joule => Some(Dimension::Energy),
            Self::Newton => Some(Dimension::Force),
            Self::Second => Some(Dimension::Time),
            Self::Kilogram => Some(Dimension::Mass),
        }
    }
}

/// Which way a measure gets better.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Better {
    /// The greater the better.
    Greater,
    /// The smaller the better.
    Smaller,
    /// As one wants it.
    Neither,
}

/// What has to be known for a measure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Needs {
    /// Each sphere's greatest kinetic energy, which every run gives.
    Energies,
    /// The rivals' runs under the same impact too.
    Rivals,
    /// A run with full records.
    Records,
    /// The layout alone.
    Layout,
}

/// A field of [`Scores`] as a number.
trait Cell {
    fn number(&self) -> Option<f64>;
    fn of(value: Option<f64>) -> Self;
}

impl Cell for f64 {
    fn number(&self) -> Option<f64> {
        Some(*self)
    }
    fn of(value: Option<f64>) -> Self {
        value.unwrap_or(0.0)
    }
}

impl Cell for Option<f64> {
    fn number(&self) -> Option<f64> {
        *self
    }
    fn of(value: Option<f64>) -> Self {
        value
    }
}

impl Cell for Option<u64> {
    fn number(&self) -> Option<f64> {
        self.map(|count| count as f64)
    }
    fn of(value: Option<f64>) -> Self {
        value.map(|count| count as u64)
    }
}

/// What the table says of a measure besides its value.
struct Row {
    measure: Measure,
    name: &'static str,
    column: &'static str,
    symbol: &'static str,
    unit: Unit,
    better: Better,
    needs: Needs,
    definition: &'static str,
    get: fn(&Scores) -> Option<f64>,
    set: fn(&mut Scores, Option<f64>),
}

/// Makes the measures, the scores that hold them, and the table, of one list.
macro_rules! measures {
    ($(
        $(#[doc = $doc:literal])+
        $variant:ident $field:ident: $type:ty, $column:literal, $symbol:literal, $unit:ident, $better:ident, $needs:ident
        $(, or $old:literal)* $(; $skip:literal)?
    )*) => {
        /// What can be measured of a layout.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        #[non_exhaustive]
        pub enum Measure {
            $( $(#[doc = $doc])+ $variant, )*
        }

        /// The measures of one layout, or of several runs of it taken together. Ratios are none where they have no denominator,
        /// others where they are not known.
        #[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
        #[serde(default)]
        pub struct Scores {
            $(
                $(#[doc = $doc])+
                #[serde(rename = $column $(, alias = $old)* $(, skip_serializing_if = $skip)?)]
                pub $field: $type,
            )*
            /// F of each focal region by itself (J); empty with a single one.
            #[serde(rename = "foci_mean_J", skip_serializing_if = "Vec::is_empty")]
            pub foci: Vec<f64>,
        }

        const TABLE: &[Row] = &[$(
            Row {
                measure: Measure::$variant,
                name: stringify!($field),
                column: $column,
                symbol: $symbol,
                unit: Unit::$unit,
                better: Better::$better,
                needs: Needs::$needs,
                definition: concat!($($doc),+),
                get: |scores| Cell::number(&scores.$field),
                set: |scores, value| scores.$field = Cell::of(value),
            },
        )*];

        impl Measure {
            /// All of them, in the order of the table.
            pub const ALL: &[Self] = &[$( Self::$variant ),*];
        }
    };
}

measures! {
    /// Mean over the focal region, or all of them taken together, of each sphere's greatest kinetic energy.
    FocalMean focal_mean: f64, "focal_mean_J", "F", Joule, Greater, Energies, or "F"
    /// Mean over the protected region of each sphere's greatest kinetic energy.
    ProtectedMean protected_mean: f64, "protected_mean_J", "P", Joule, Smaller, Energies, or "P"
    /// F/P.
    Contrast contrast: Option<f64>, "contrast", "C", Ratio, Greater, Energies, or "C"
    /// F over that of the host alone.
    FocalGain focal_gain: Option<f64>, "focal_gain", "G", Ratio, Greater, Energies, or "G"
    /// P over that of the design's lens material alone.
    Protection protection: Option<f64>, "protection", "Q", Ratio, Smaller, Energies, or "Q"
    /// How evenly several focal regions are served: of their means over their shares the least over the greatest.
    Balance balance: Option<f64>, "balance", "balance", Ratio, Greater, Energies; "Option::is_none"
    /// P of the layout that is compared over P of this one: below 1 the former protects better.
    ProtectedRatio protected_ratio: Option<f64>, "protected_ratio", "Plens/P", Ratio, Neither, Rivals; "Option::is_none"
    /// P over the least P of all baselines.
    ProtectionBest protection_best: Option<f64>, "protection_best", "Q best", Ratio, Smaller, Rivals, or "Q_best"; "Option::is_none"
    /// Mean over the focal region of each sphere's greatest momentum.
    FocalMomentum focal_momentum: Option<f64>, "focal_momentum_kg_m_s", "focal p", NewtonSecond, Greater, Records; "Option::is_none"
    /// Mean over the protected region of each sphere's greatest momentum.
    ProtectedMomentum protected_momentum: Option<f64>, "protected_momentum_kg_m_s", "protected p", NewtonSecond, Smaller, Records; "Option::is_none"
    /// Greatest force at one contact of the focal region's spheres.
    FocalForce focal_force: Option<f64>, "focal_force_N", "focal force", Newton, Greater, Records; "Option::is_none"
    /// Greatest force at one contact of the protected region's spheres.
    ProtectedForce protected_force: Option<f64>, "protected_force_N", "protected force", Newton, Smaller, Records; "Option::is_none"
    /// When the first sphere of the focal region reached 1 % of its own greatest speed.
    FocalArrival focal_arrival: Option<f64>, "focal_arrival_s", "focal arrival", Second, Neither, Records; "Option::is_none"
    /// When the first sphere of the protected region reached 1 % of its own greatest speed.
    ProtectedArrival protected_arrival: Option<f64>, "protected_arrival_s", "protected arrival", Second, Neither, Records; "Option::is_none"
    /// Greatest momentum of the last row of the simulated half along the axis.
    FarMomentum far_momentum: Option<f64>, "far_momentum_kg_m_s", "far momentum", NewtonSecond, Smaller, Records, or "exit_momentum_kg_m_s"; "Option::is_none"
    /// Greatest total contact force on the last row of the simulated half along the axis.
    FarForce far_force: Option<f64>, "far_force_N", "far force", Newton, Smaller, Records, or "exit_force_N"; "Option::is_none"
    /// The part of the work of the load that contacts have dissipated at the end.
    Dissipation dissipation: Option<f64>, "dissipation", "dissipation", Ratio, Neither, Records; "Option::is_none"
    /// Work of the load on the simulated half.
    WorkIn work_in: Option<f64>, "work_in_J", "work in", Joule, Neither, Records; "Option::is_none"
    /// Kinetic energy of the simulated half at the end.
    Kinetic kinetic: Option<f64>, "kinetic_J", "kinetic", Joule, Neither, Records; "Option::is_none"
    /// Energy that the contacts would still give back at the end.
    Stored stored: Option<f64>, "stored_J", "stored", Joule, Neither, Records; "Option::is_none"
    /// Work done on the contacts less what they store, and losses by friction.
    Dissipated dissipated: Option<f64>, "dissipated_J", "lost", Joule, Neither, Records; "Option::is_none"
    /// What the energy ledger leaves open: (work in − kinetic − stored − dissipated)/work in, signed.
    Residual residual: Option<f64>, "residual", "residual", Ratio, Neither, Records; "Option::is_none"
    /// Σ ½ δ_max F_max (Burgoyne 2016, eq. 5.6), which overestimates the dissipation.
    Estimate eq_5_6: Option<f64>, "eq_5_6_J", "eq. 5.6", Joule, Neither, Records; "Option::is_none"
    /// Mass of the simulated half, spheres on its mirror lines counting as halves.
    HalfMass half_mass: Option<f64>, "half_mass_kg", "mass, half", Kilogram, Smaller, Layout, or "mass_kg"; "Option::is_none"
    /// Price of the spheres of the simulated half, those on its mirror lines counting as halves.
    HalfCost half_cost: Option<f64>, "half_cost", "cost, half", Money, Smaller, Layout, or "cost"; "Option::is_none"
    /// Sites of the simulated half that do not hold the host.
    HalfSpheres half_spheres: Option<u64>, "half_spheres", "spheres, half", Count, Smaller, Layout, or "spheres"; "Option::is_none"
    /// Mass of the piece to be built, host included.
    PieceMass piece_mass: Option<f64>, "piece_mass_kg", "mass, piece", Kilogram, Smaller, Layout; "Option::is_none"
    /// Price of all spheres of the piece to be built, host included.
    PieceCost piece_cost: Option<f64>, "piece_cost", "cost, piece", Money, Smaller, Layout; "Option::is_none"
    /// Spheres of the piece to be built that are not of the host.
    PieceSpheres piece_spheres: Option<u64>, "piece_spheres", "spheres, piece", Count, Smaller, Layout; "Option::is_none"
    /// Spheres in the free rows of a study that touch no other of their material.
    Lone lone: Option<u64>, "lone", "lone", Count, Smaller, Layout; "Option::is_none"
    /// Groups of touching spheres of one material other than the host.
    Islands islands: Option<u64>, "islands", "islands", Count, Smaller, Layout; "Option::is_none"
}

/// Spellings of 0.1 that are not the name with `-` in place of `_`.
const OLD: &[(&str, Measure)] = &[
    ("focal_energy", Measure::FocalMean),
    ("protected_energy", Measure::ProtectedMean),
    ("mass", Measure::HalfMass),
    ("cost", Measure::HalfCost),
    ("spheres", Measure::HalfSpheres),
];

impl Measure {
    fn row(self) -> &'static Row {
        &TABLE[self as usize]
    }

    /// The name in files, options and JSON.
    pub fn name(self) -> &'static str {
        self.row().name
    }

    /// The name with its unit at the end, as JSON and CSV have it.
    pub fn column(self) -> &'static str {
        self.row().column
    }

    /// The symbol in tables and pictures.
    pub fn symbol(self) -> &'static str {
        self.row().symbol
    }

    /// Its unit.
    pub fn unit(self) -> Unit {
        self.row().unit
    }

    /// Which way it gets better.
    pub fn better(self) -> Better {
        self.row().better
    }

    /// What has to be known for it.
    pub fn needs(self) -> Needs {
        self.row().needs
    }

    /// What it is, in a sentence.
    pub fn definition(self) -> &'static str {
        self.row().definition.trim()
    }

    /// By its name, or by its spelling of version 0.1, such as `focal-gain`.
    pub fn find(name: &str) -> Option<Self> {
        let name = name.replace('-', "_");
        let row = TABLE.iter().find(|row| row.name == name).map(|row| row.measure);
        row.or_else(|| OLD.iter().find(|(old, _)| *old == name).map(|(_, measure)| *measure))
    }

    /// The better of two values; the first where neither is, or both are alike.
    pub fn best(self, a: f64, b: f64) -> f64 {
        match self.better() {
            Better::Greater if b > a => b,
            Better::Smaller if b < a => b,
            _ => a,
        }
    }
}

impl Scores {
    /// The value of a measure, where it is known.
    pub fn get(&self, measure: Measure) -> Option<f64> {
        (measure.row().get)(self)
    }

    /// Gives a measure a value.
    pub fn set(&mut self, measure: Measure, value: Option<f64>) {
        (measure.row().set)(self, value);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_in_order_and_every_column_is_name_and_unit() {
        for (k, (row, &measure)) in TABLE.iter().zip(Measure::ALL).enumerate() {
            assert_eq!((row.measure, measure as usize), (measure, k));
            let unit = match measure.unit() {
                Unit::Ratio | Unit::Count | Unit::Money => String::new(),
                unit => format!("_{}", unit.name().replace([' ', '/'], "_")),
            };
            assert_eq!(measure.column(), format!("{}{unit}", measure.name()));
            assert!(measure.definition().ends_with('.'), "{}", measure.name());
            let alike = |other: &&Row| other.name == row.name || other.symbol == row.symbol;
            assert_eq!(TABLE.iter().filter(alike).count(), 1, "{}", row.name);
        }
    }

    /// A value that is put into one measure comes out of that one alone, and as JSON below its column.
    #[test]
    fn getters_and_setters_are_those_of_their_fields() {
        for &measure in Measure::ALL {
            let mut scores = Scores::default();
            scores.set(measure, Some(3.0));
            for &other in Measure::ALL {
                let expected = if other == measure { Some(3.0) } else { Scores::default().get(other) };
                assert_eq!(scores.get(other), expected, "{}", other.name());
            }
            let json = serde_json::to_value(&scores).unwrap();
            assert_eq!(json[measure.column()].as_f64(), Some(3.0), "{}", measure.name());
            assert_eq!(serde_json::from_value::<Scores>(json).unwrap(), scores);
        }
    }

    #[test]
    fn spellings_of_the_first_version_are_found() {
        for (old, measure) in [
            ("focal-gain", Measure::FocalGain),
            ("focal-energy", Measure::FocalMean),
            ("protected-energy", Measure::ProtectedMean),
            ("protection-best", Measure::ProtectionBest),
            ("far-momentum", Measure::FarMomentum),
            ("mass", Measure::HalfMass),
            ("cost", Measure::HalfCost),
            ("focal_mean", Measure::FocalMean),
        ] {
            assert_eq!(Measure::find(old), Some(measure), "{old}");
        }
        assert_eq!(Measure::find("brightness"), None);
        assert!(Measure::ALL.iter().all(|&measure| Measure::find(measure.name()) == Some(measure)));
    }
}
