//! The constants of two touching spheres.

use super::Constants;
use crate::material::Material;

/// Pair constants in SI.
///
///   1/E* = (1−ν₁²)/E₁ + (1−ν₂²)/E₂,   1/r* = 1/r₁ + 1/r₂
///
/// Yield stress *and* rate constant are those of the partner with the lower yield stress (Burgoyne 2016, section 4.2.2 for
/// the yield stress; for C the same is assumed); between unlike materials times [`Tuning::unlike_hardness`](super::Tuning).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    /// E* (Pa)
    pub modulus: f64,
    /// r* (m)
    pub radius: f64,
    /// r₁ + r₂ (m)
    pub radii_sum: f64,
    /// σ_y (Pa) of the partner that yields first
    pub yield_stress: f64,
    /// C of that partner
    pub rate_constant: f64,
    /// ν of that partner
    pub poisson_ratio: f64,
    /// Reduced mass of two solid spheres (kg)
    pub reduced_mass: f64,
    /// The set of fitted constants, and what laws leave open
    pub constants: Constants,
}

/// Overlap, force and fitted parameters at which the regions of the elastic-plastic law meet, for a given σ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Regions {
    /// δ_y (m), onset of yield
    pub yield_overlap: f64,
    /// F_y (N)
    pub yield_force: f64,
    /// δ_p (m), onset of full plasticity
    pub plastic_overlap: f64,
    /// F_p (N)
    pub plastic_force: f64,
    /// c₁, contact pressure over yield stress
    pub pressure_ratio: f64,
    /// c₂ (m²), offset of the squared contact radius
    pub area_offset: f64,
}

impl Pair {
    /// Two spheres of the given materials and radii (m). A radius without end is that of a half-space: r* is then the other's radius, and
    /// strain rates, which go by r₁ + r₂, are those of two spheres of its size.
    pub fn new(materials: [&Material; 2], radii: [f64; 2], constants: Constants) -> Self {
        let [a, b] = materials;
        let compliance = |m: &Material| (1.0 - m.poisson_ratio * m.poisson_ratio) / m.youngs_modulus;
        let softer = if b.yield_stress < a.yield_stress { b } else { a };
        let factor = if a == b { 1.0 } else { constants.tuning.unlike_hardness };
        let [m, n] = [a.sphere_mass(2.0 * radii[0]), b.sphere_mass(2.0 * radii[1])];
        Self {
            modulus: 1.0 / (compliance(a) + compliance(b)),
            radius: 1.0 / (1.0 / radii[0] + 1.0 / radii[1]),
            radii_sum: match radii.map(f64::is_finite) {
                [true, false] => 2.0 * radii[0],
                [false, true] => 2.0 * radii[1],
                _ => radii[0] + radii[1],
            },
            yield_stress: factor * softer.yield_stress,
            rate_constant: softer.rate_constant,
            poisson_ratio: softer.poisson_ratio,
            reduced_mass: match [m, n].map(f64::is_finite) {
                [true, false] => m,
                [false, true] => n,
                _ => m * n / (m + n),
            },
            constants,
        }
    }

    /// Coefficient of Hertz's law F = k δ^{3/2}: k = (4/3) E* √r* (Burgoyne 2016, eq. 3.1; Johnson 1985, eq. 4.23).
    pub fn hertz_coefficient(&self) -> f64 {
        4.0 / 3.0 * self.modulus * self.radius.sqrt()
    }

    /// Where the regions meet for a yield stress of `factor` times the quasistatic one (Burgoyne 2016, eqs 3.2, 3.5, 3.9).
    pub fn regions(&self, factor: f64) -> Regions {
        use std::f64::consts::PI;
        let stress = factor * self.yield_stress;
        let ratio = self.modulus / stress;
        let scale = self.constants.scale(self.radius);
        let yield_overlap = self.radius / 4.0 * (1.6 * PI / ratio).powi(2);
        let plastic_overlap = (0.00428 / ratio + 1.47e-5) * scale;
        let pressure_ratio = self.constants.pressure_ratio(ratio);
        let area_offset = (1.01e-9 - 3.99e-6 / ratio) * scale * scale;
        Regions {
            yield_overlap,
            yield_force: self.hertz_coefficient() * yield_overlap.powf(1.5),
            plastic_overlap,
            plastic_force: pressure_ratio * stress * PI * (2.0 * self.radius * plastic_overlap + area_offset),
            pressure_ratio,
            area_offset,
        }
    }

    /// Stiffness of the fully plastic contact, K = 2 π r* σ_y c₁ (N/m) (Burgoyne 2016, eq. 5.2; K_1D and K_L there).
    pub fn plastic_stiffness(&self) -> f64 {
        let ratio = self.modulus / self.yield_stress;
        2.0 * std::f64::consts::PI * self.radius * self.yield_stress * self.constants.pressure_ratio(ratio)
    }

    /// F_p (N) at rest: the force from which on the contact is fully plastic (Burgoyne 2016, eq. 3.5).
    pub fn plastic_force(&self) -> f64 {
        self.regions(1.0).plastic_force
    }
}
