//! What may turn out otherwise than drawn, each within its limits.

use serde::Serialize;

use super::Tolerances;
use crate::evaluate::Drawing;
use crate::units::Dimension;

/// Which quantity; those of a material name its place in the palette.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kind {
    /// Variation of diameters within a lot.
    Lot,
    /// How far the mean diameter of a material's lot lies from the nominal one.
    Offset(usize),
    /// E
    Modulus(usize),
    /// ρ
    Density(usize),
    /// σ_y
    YieldStress(usize),
    /// C of the rate factor
    RateConstant(usize),
    /// Sites without a sphere.
    Vacancies,
    /// Spheres of another of the layout's materials.
    Wrong,
    /// μ
    Friction,
    /// Force of the blow.
    Force,
    /// Its duration.
    Duration,
    /// Its angle to the axis.
    Angle,
    /// How far it strikes beside the axis.
    OffCentre,
    /// Whether a projectile strikes in place of the pulse: from one half on.
    Projectile,
}

impl Kind {
    /// Whether it says how much chance there is, rather than having a value itself.
    pub fn is_random(self) -> bool {
        matches!(self, Self::Lot | Self::Vacancies | Self::Wrong)
    }

    /// A number of its own, from which its random numbers follow.
    pub(super) fn stream(self) -> u64 {
        let of = |k: u64, material: usize| k + 16 * material as u64;
        match self {
            Self::Lot => 1,
            Self::Vacancies => 2,
            Self::Wrong => 3,
            Self::Friction => 4,
            Self::Force => 5,
            Self::Duration => 6,
            Self::Angle => 7,
            Self::OffCentre => 8,
            Self::Projectile => 14,
            Self::Offset(m) => of(9, m),
            Self::Modulus(m) => of(10, m),
            Self::Density(m) => of(11, m),
            Self::YieldStress(m) => of(12, m),
            Self::RateConstant(m) => of(13, m),
        }
    }
}

/// A quantity within its limits. Diameters, distances (m) and angles (rad) are differences from the nominal value, other quantities parts
/// of it, but chances and friction, which are as they are. Within limits all values are as likely.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Quantity {
    /// Its name in files and tables, with the material where it is one's.
    pub name: String,
    /// Which.
    #[serde(skip)]
    pub kind: Kind,
    /// Least and greatest; of a random one zero and how much there is.
    pub limits: [f64; 2],
    /// What it is as drawn.
    pub nominal: f64,
    /// What numbers are measured in.
    pub unit: &'static str,
}

impl Quantity {
    /// A value in words.
    pub fn show(&self, value: f64) -> String {
        match self.kind {
            Kind::Lot | Kind::Offset(_) | Kind::OffCentre => Dimension::Length.show(value),
            Kind::Angle => Dimension::Angle.show(value),
            Kind::Friction => format!("{value}"),
            Kind::Projectile => if value < 0.5 { "pulse" } else { "projectile" }.to_owned(),
            _ => Dimension::Fraction.show(value),
        }
    }

    /// Its limits in words.
    pub fn limits_in_words(&self) -> String {
        let [low, high] = self.limits;
        match self.kind {
            kind if kind.is_random() => self.show(high),
            Kind::Friction if low == high => self.show(high),
            Kind::Projectile => "pulse or projectile".to_owned(),
            _ if low == -high => format!("+- {}", self.show(high)),
            _ => format!("{} to {}", self.show(low), self.show(high)),
        }
    }
}

/// The quantities that may turn out otherwise, of a layout; those of materials for each that it holds.
pub fn quantities(tolerances: &Tolerances, drawing: Drawing<'_>, friction: f64) -> Vec<Quantity> {
    let palette = drawing.palette();
    let mut list = Vec::new();
    let mut add = |name: String, kind: Kind, limits: [f64; 2], nominal: f64, unit: &'static str| {
        if limits != [nominal; 2] {
            list.push(Quantity { name, kind, limits, nominal, unit });
        }
    };
    let used: Vec<usize> = drawing.letters().into_iter().map(usize::from).collect();
    let both = |limit: f64| [-limit, limit];
    add("diameter.lot".to_owned(), Kind::Lot, [0.0, tolerances.lot], 0.0, "m");
    let mut of_material = |what: &str, limit: f64, unit: &'static str, kind: fn(usize) -> Kind| {
        for &m in &used {
            add(format!("{what}:{}", palette[m].name), kind(m), both(limit), 0.0, unit);
        }
    };
    of_material("diameter.offset", tolerances.offset, "m", Kind::Offset);
    of_material("youngs_modulus", tolerances.youngs_modulus, "part", Kind::Modulus);
    of_material("density", tolerances.density, "part", Kind::Density);
    of_material("yield_stress", tolerances.yield_stress, "part", Kind::YieldStress);
    of_material("rate_constant", tolerances.rate_constant, "part", Kind::RateConstant);
    add("vacancies".to_owned(), Kind::Vacancies, [0.0, tolerances.vacancies], 0.0, "part");
    if used.len() > 1 {
        add("wrong".to_owned(), Kind::Wrong, [0.0, tolerances.wrong], 0.0, "part");
    }
    if let Some(limits) = tolerances.friction {
        add("friction".to_owned(), Kind::Friction, limits, friction, "");
    }
    let impact = &tolerances.impact;
    add("impact.force".to_owned(), Kind::Force, both(impact.force), 0.0, "part");
    add("impact.duration".to_owned(), Kind::Duration, both(impact.duration), 0.0, "part");
    add("impact.angle".to_owned(), Kind::Angle, both(impact.angle), 0.0, "rad");
    add("impact.off_centre".to_owned(), Kind::OffCentre, both(impact.off_centre), 0.0, "m");
    let last = if impact.projectile.is_some() { 1.0 } else { 0.0 };
    add("impact.projectile".to_owned(), Kind::Projectile, [0.0, last], 0.0, "");
    list
}
