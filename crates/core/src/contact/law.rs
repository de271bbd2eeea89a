//! The laws by name, and one type that holds any of them.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use super::{Consistent, ElastoPlastic, ForceLaw, Hertz, HertzThesis, History, LinearPlastic, NormalLaw, Pair};

/// A contact law by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LawKind {
    /// The published elastic-plastic law with rate (Burgoyne 2016, appendix A.2.1).
    Thesis,
    /// The same with the rate off.
    ThesisStatic,
    /// The energy-consistent variant of `Thesis`, with rate.
    Consistent,
    /// Hertz, without memory.
    Hertz,
    /// Hertz as appendix A.2.1 has it with plasticity off: clipped by history.
    HertzThesis,
    /// Loading at the fully plastic stiffness from the start, with rate; unloading as `Thesis` (Burgoyne 2016, eq. 4.2).
    Linear,
    /// The same with the rate off.
    LinearStatic,
}

/// The fitted constants of c₁, δ_p and c₂, which differ between the text and the code of Burgoyne 2016.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Constants {
    /// Appendix A.2.1: c₁ = 6.304 − 6.76 q^−0.137, lengths in units of 0.0635 in = 1.6129 mm. The default.
    #[default]
    Code,
    /// Eq. 3.9: lengths in units of 1.59 mm; c₁ as the code has it, since the printed 6.30 is 6.304 rounded (6.30 itself
    /// would give F_p = 582.4 N instead of 583.3 N for E = 100 GPa, σ_y = 500 MPa).
    Text,
    /// As `Text` with the length that was meant, 1/16 in = 1.5875 mm, which gives the quoted F_p = 584 N.
    SixteenthInch,
    /// Eqs 4.7 and 5.2: c₁ = 6.30 − 6.76 q^−0.14; lengths as eq. 3.9.
    #[serde(rename = "eq-4.7")]
    Equation47,
}

/// A name that is none of those known.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("unknown {what} \"{name}\"; known are {}", .known.join(", "))]
pub struct UnknownName {
    what: &'static str,
    name: String,
    known: Vec<&'static str>,
}

macro_rules! named {
    ($type:ty, $what:literal, { $($variant:ident = $name:literal),* $(,)? }) => {
        impl $type {
            /// All of them, in the order in which they are listed to users.
            pub const ALL: &'static [Self] = &[$(Self::$variant),*];

            /// The name used in files and on the command line.
            pub const fn name(self) -> &'static str {
                match self { $(Self::$variant => $name),* }
            }
        }
        impl fmt::Display for $type {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(self.name())
            }
        }
        impl FromStr for $type {
            type Err = UnknownName;
            fn from_str(name: &str) -> Result<Self, UnknownName> {
                let found = Self::ALL.iter().copied().find(|known| known.name() == name);
                found.ok_or_else(|| UnknownName {
                    what: $what,
                    name: name.to_owned(),
                    known: Self::ALL.iter().map(|known| known.name()).collect(),
                })
            }
        }
    };
}

named!(LawKind, "contact law", {
    Thesis = "thesis",
    ThesisStatic = "thesis-static",
    Consistent = "consistent",
    Hertz = "hertz",
    HertzThesis = "hertz-thesis",
    Linear = "linear",
    LinearStatic = "linear-static",
});

named!(Constants, "set of constants", {
    Code = "code",
    Text = "text",
    SixteenthInch = "sixteenth-inch",
    Equation47 = "eq-4.7",
});

impl Constants {
    /// c₁ = offset − 6.76 q^−exponent: (offset, exponent).
    pub(super) const fn pressure_fit(self) -> (f64, f64) {
        match self {
            Self::Code | Self::Text | Self::SixteenthInch => (6.304, 0.137),
            Self::Equation47 => (6.30, 0.14),
        }
    }

    /// c₁ at q = E*/σ.
    pub(super) fn pressure_ratio(self, ratio: f64) -> f64 {
        let (offset, exponent) = self.pressure_fit();
        offset - 6.76 * ratio.powf(-exponent)
    }

    /// r* in units of the length at which the fit was made.
    pub(super) fn scale(self, radius: f64) -> f64 {
        match self {
            Self::Code => radius / (0.0635 * 0.0254),
            Self::Text | Self::Equation47 => radius / 0.00159,
            Self::SixteenthInch => radius / (0.0254 / 16.0),
        }
    }
}

/// Any of the laws, for one pair of spheres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AnyLaw {
    /// See [`ElastoPlastic`].
    ElastoPlastic(ElastoPlastic),
    /// See [`Consistent`].
    Consistent(Consistent),
    /// See [`LinearPlastic`].
    Linear(LinearPlastic),
    /// See [`Hertz`].
    Hertz(Hertz),
    /// See [`HertzThesis`].
    HertzThesis(HertzThesis),
}

impl AnyLaw {
    /// The law `kind` between the spheres of `pair`.
    pub fn new(kind: LawKind, pair: &Pair) -> Self {
        let rate = matches!(kind, LawKind::Thesis | LawKind::Linear);
        match kind {
            LawKind::Thesis | LawKind::ThesisStatic => Self::ElastoPlastic(ElastoPlastic::new(pair, rate)),
            LawKind::Linear | LawKind::LinearStatic => Self::Linear(LinearPlastic::new(pair, rate)),
            LawKind::Consistent => Self::Consistent(Consistent::new(pair)),
            LawKind::Hertz => Self::Hertz(Hertz::new(pair)),
            LawKind::HertzThesis => Self::HertzThesis(HertzThesis(Hertz::new(pair))),
        }
    }

    /// Whether the contact is yielding in this state, `history` being that after the step: it is loaded as never before, and
    /// beyond its onset of yield. That is δ_y at the present rate for the published law and δ_y at rest for the consistent one,
    /// which never yields before; the linear law yields from the start, the elastic ones never.
    pub fn yields(&self, overlap: f64, closing_speed: f64, history: &History) -> bool {
        let onset = match self {
            Self::ElastoPlastic(law) => law.yield_onset(closing_speed),
            Self::Consistent(law) => law.yield_onset(),
            Self::Linear(_) => 0.0,
            Self::Hertz(_) | Self::HertzThesis(_) => return false,
        };
        closing_speed >= 0.0 && overlap >= history.overlap_max && overlap > onset
    }
}

impl ForceLaw<f64> for AnyLaw {
    fn force(&self, overlap: f64, closing_speed: f64, history: &History) -> f64 {
        match self {
            Self::ElastoPlastic(law) => law.force(overlap, closing_speed, history),
            Self::Consistent(law) => law.force(overlap, closing_speed, history),
            Self::Linear(law) => law.force(overlap, closing_speed, history),
            Self::Hertz(law) => law.force(overlap, closing_speed, history),
            Self::HertzThesis(law) => law.force(overlap, closing_speed, history),
        }
    }
    fn respond(&self, overlap: f64, closing_speed: f64, history: &History) -> (f64, History) {
        match self {
            Self::ElastoPlastic(law) => law.respond(overlap, closing_speed, history),
            Self::Consistent(law) => law.respond(overlap, closing_speed, history),
            Self::Linear(law) => law.respond(overlap, closing_speed, history),
            Self::Hertz(law) => law.respond(overlap, closing_speed, history),
            Self::HertzThesis(law) => law.respond(overlap, closing_speed, history),
        }
    }
}

impl NormalLaw for AnyLaw {
    fn stored(&self, overlap: f64, history: &History) -> f64 {
        match self {
            Self::ElastoPlastic(law) => law.stored(overlap, history),
            Self::Consistent(law) => law.stored(overlap, history),
            Self::Linear(law) => law.stored(overlap, history),
            Self::Hertz(law) => law.stored(overlap, history),
            Self::HertzThesis(law) => law.stored(overlap, history),
        }
    }
    fn stiffness_max(&self, force_max: f64) -> f64 {
        match self {
            Self::ElastoPlastic(law) => law.stiffness_max(force_max),
            Self::Consistent(law) => law.stiffness_max(force_max),
            Self::Linear(law) => law.stiffness_max(force_max),
            Self::Hertz(law) => law.stiffness_max(force_max),
            Self::HertzThesis(law) => law.stiffness_max(force_max),
        }
    }
}
