//! What a law's numbers are made of besides the materials: the published fit, and what each law leaves open.

use std::fmt;
use std::str::FromStr;

use super::law::{UnknownName, named};

/// The published fit of c₁, δ_p and c₂, and the numbers that laws leave to their user.
#[derive(Clone, Copy, Default, PartialEq)]
pub struct Constants {
    /// Which of the published sets.
    pub set: ConstantSet,
    /// What laws leave open.
    pub tuning: Tuning,
}

/// The fitted constants of c₁, δ_p and c₂, which differ between the text and the code of Burgoyne 2016.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ConstantSet {
    /// Appendix A.2.1: c₁ = 6.304 − 6.76 q^−0.137, lengths in units of 0.0635 in = 1.6129 mm. The default.
    #[default]
    Code,
    /// Eq. 3.9: lengths in units of 1.59 mm; c₁ as the code has it, since the printed 6.30 is 6.304 rounded (6.30 itself
    /// would give F_p = 582.4 N instead of 583.3 N for E = 100 GPa, σ_y = 500 MPa).
    Text,
    /// As `Text` with the length that was meant, 1/16 in = 1.5875 mm, which gives the quoted F_p = 584 N.
    SixteenthInch,
    /// Eqs 4.7 and 5.2: c₁ = 6.30 − 6.76 q^−0.14; lengths as eq. 3.9.
    Equation47,
}

/// Numbers of laws and pairs that no material states.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tuning {
    /// H, the contact pressure that yields over the yield stress (`thornton`).
    pub hardness: f64,
    /// Factor on the yield stress of contacts between unlike materials (every law that yields). 1 takes that of the softer; what a soft
    /// sphere gives a hard one lies between 1 and 1.9.
    pub unlike_hardness: f64,
    /// κ, stiffness on the way back over that of loading (`walton-braun`).
    pub spring_back: f64,
    /// S (1/m), by how much it grows with the greatest force (`walton-braun`).
    pub spring_back_growth: f64,
    /// e (`tsuji`).
    pub restitution: f64,
    /// m, the exponent of σ = σ₀ ε^m (`storakers`).
    pub hardening: f64,
}

impl Tuning {
    /// What is usual.
    pub const USUAL: Self = Self {
        hardness: 2.8,
        unlike_hardness: 1.0,
        spring_back: 5.0,
        spring_back_growth: 0.0,
        restitution: 0.9,
        hardening: 0.1,
    };
}

impl Default for Tuning {
    fn default() -> Self {
        Self::USUAL
    }
}

/// A number outside of what its law can take.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{name} = {value} must lie from {least} to {most}")]
pub struct TuningError {
    /// Which number.
    pub name: &'static str,
    /// What it is.
    pub value: f64,
    /// What it may be.
    pub least: f64,
    /// The same.
    pub most: f64,
}

impl Tuning {
    /// Checks every number against the range in which its law has a meaning.
    ///
    /// # Errors
    /// The first that lies outside.
    pub fn check(&self) -> Result<(), TuningError> {
        let rule = |name, value: f64, least, most| {
            if (least..=most).contains(&value) { Ok(()) } else { Err(TuningError { name, value, least, most }) }
        };
        rule("hardness", self.hardness, 0.5, 10.0)?;
        rule("unlike_hardness", self.unlike_hardness, 0.1, 10.0)?;
        rule("spring_back", self.spring_back, 1.0, 1e4)?;
        rule("spring_back_growth", self.spring_back_growth, 0.0, 1e12)?;
        rule("restitution", self.restitution, 0.01, 1.0)?;
        rule("hardening", self.hardening, 0.0, 0.8)
    }
}

named!(ConstantSet, "set of constants", {
    Code = "code",
    Text = "text",
    SixteenthInch = "sixteenth-inch",
    Equation47 = "eq-4.7",
});

#[expect(non_upper_case_globals, reason = "they are the sets, named as such")]
impl Constants {
    /// See [`ConstantSet::Code`].
    pub const Code: Self = Self::of(ConstantSet::Code);
    /// See [`ConstantSet::Text`].
    pub const Text: Self = Self::of(ConstantSet::Text);
    /// See [`ConstantSet::SixteenthInch`].
    pub const SixteenthInch: Self = Self::of(ConstantSet::SixteenthInch);
    /// See [`ConstantSet::Equation47`].
    pub const Equation47: Self = Self::of(ConstantSet::Equation47);
    /// The sets, in the order in which they are listed to users.
    pub const ALL: &'static [Self] = &[Self::Code, Self::Text, Self::SixteenthInch, Self::Equation47];
}

impl Constants {
    /// A set, with the usual values of what laws leave open.
    pub const fn of(set: ConstantSet) -> Self {
        Self { set, tuning: Tuning::USUAL }
    }

    /// The set's name in files and on the command line.
    pub const fn name(self) -> &'static str {
        self.set.name()
    }

    /// c₁ = offset − 6.76 q^−exponent: (offset, exponent).
    pub(super) const fn pressure_fit(self) -> (f64, f64) {
        match self.set {
            ConstantSet::Code | ConstantSet::Text | ConstantSet::SixteenthInch => (6.304, 0.137),
            ConstantSet::Equation47 => (6.30, 0.14),
        }
    }

    /// c₁ at q = E*/σ.
    pub(super) fn pressure_ratio(self, ratio: f64) -> f64 {
        let (offset, exponent) = self.pressure_fit();
        offset - 6.76 * ratio.powf(-exponent)
    }

    /// r* in units of the length at which the fit was made.
    pub(super) fn scale(self, radius: f64) -> f64 {
        match self.set {
            ConstantSet::Code => radius / (0.0635 * 0.0254),
            ConstantSet::Text | ConstantSet::Equation47 => radius / 0.00159,
            ConstantSet::SixteenthInch => radius / (0.0254 / 16.0),
        }
    }
}

/// The set's name, as it has always been part of keys; what laws leave open only where it is not as usual.
impl fmt::Debug for Constants {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?}", self.set)?;
        if self.tuning == Tuning::default() { Ok(()) } else { write!(f, " {:?}", self.tuning) }
    }
}

impl fmt::Display for Constants {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Constants {
    type Err = UnknownName;
    fn from_str(name: &str) -> Result<Self, UnknownName> {
        Ok(Self::of(name.parse()?))
    }
}
