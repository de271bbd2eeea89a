//! The variables of a design surface, and the value at one of its points.

use std::f64::consts::{FRAC_PI_2, PI};

use super::{DISSIPATED_AT, Dimension, Medium, Value, critical_angle, dissipation, speed_reached};
use crate::contact::{Constants, Pair};
use crate::material::Material;

/// Where media are shown on an axis of amplitudes (F_p) if no amplitude is given.
pub(super) const SHOWN_AT: f64 = 10.0;

/// A design variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// K, the stiffness of the fully plastic contact (N/m), of spheres of the setting's diameter.
    Stiffness,
    /// ρ, the mean density (kg/m³).
    Density,
    /// σ_y, the quasistatic yield stress (Pa) of the partner that yields first.
    YieldStress,
    /// E, Young's modulus (Pa); of a dimer that of the uniform medium with the same E*.
    Modulus,
    /// R (m), the radius of the spheres.
    Radius,
    /// The contact force in F_p.
    Amplitude,
    /// The dimension of the packing, 1, 2 or 3.
    Dimension,
}

impl Axis {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::Stiffness,
        Self::Density,
        Self::YieldStress,
        Self::Modulus,
        Self::Radius,
        Self::Amplitude,
        Self::Dimension,
    ];

    /// The name used on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Stiffness => "stiffness",
            Self::Density => "density",
            Self::YieldStress => "yield-stress",
            Self::Modulus => "modulus",
            Self::Radius => "radius",
            Self::Amplitude => "amplitude",
            Self::Dimension => "dimension",
        }
    }
}

/// What is shown, and everything on which it depends.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    /// What is shown.
    pub value: Value,
    /// What speeds and impedances are compared with; none where nothing is.
    pub against: Option<Medium>,
    /// Density, modulus, Poisson's ratio and yield stress.
    pub material: Material,
    /// K (N/m); none where it follows from the material.
    pub stiffness: Option<f64>,
    /// The packing.
    pub dimension: Dimension,
    /// Contact force in F_p; none for the bound itself.
    pub amplitude: Option<f64>,
    /// Diameter of the spheres (m), at which K and forces are meant.
    pub diameter: f64,
    /// The fitted constants of the contact law.
    pub constants: Constants,
}

impl Setting {
    /// The setting with one variable at another value.
    pub fn with(&self, axis: Axis, value: f64) -> Self {
        let mut setting = self.clone();
        match axis {
            Axis::Stiffness => setting.stiffness = Some(value),
            Axis::Density => setting.material.density = value,
            Axis::YieldStress => setting.material.yield_stress = value,
            Axis::Modulus => setting.material.youngs_modulus = value,
            Axis::Radius => setting.diameter = 2.0 * value,
            Axis::Amplitude => setting.amplitude = Some(value),
            // Nodes of this axis are whole numbers.
            Axis::Dimension => {
                setting.dimension = Dimension::from_number(value as u8).unwrap_or(self.dimension);
            }
        }
        setting
    }

    /// V = A g √(3 K/(π R ρ)) (m/s), g the fraction of the bound that is reached at the amplitude, one without it.
    ///
    /// None where nothing can be said: at less than 0.35 F_p, and where K follows from a yield stress above a tenth of the
    /// modulus, past which the contact law was not fitted. Where K is given apart from the material, g is that of the material.
    pub fn speed(&self) -> Option<f64> {
        if self.stiffness.is_none() {
            self.material.check().ok()?;
        }
        let pair = Pair::new([&self.material; 2], [0.5 * self.diameter; 2], self.constants);
        self.speed_of(&pair, self.stiffness.unwrap_or_else(|| pair.plastic_stiffness()), self.material.density)
    }

    fn speed_of(&self, pair: &Pair, stiffness: f64, density: f64) -> Option<f64> {
        let reached = self.amplitude.map_or(Some(1.0), |amplitude| speed_reached(pair, density, amplitude))?;
        let chain = (3.0 * stiffness / (PI * 0.5 * self.diameter * density)).sqrt();
        let speed = self.dimension.factor() * reached * chain;
        speed.is_finite().then_some(speed)
    }

    /// The value that is shown, in SI; none where nothing can be said.
    pub fn value(&self) -> Option<f64> {
        if self.stiffness.is_none() {
            self.material.check().ok()?;
        }
        let pair = Pair::new([&self.material; 2], [0.5 * self.diameter; 2], self.constants);
        let stiffness = self.stiffness.unwrap_or_else(|| pair.plastic_stiffness());
        self.value_of(&pair, stiffness, self.material.density)
    }

    fn value_of(&self, pair: &Pair, stiffness: f64, density: f64) -> Option<f64> {
        let speed = || self.speed_of(pair, stiffness, density);
        let other = || {
            let medium = self.against.as_ref()?;
            let pair = medium.pair(self.diameter, self.constants);
            Some((self.speed_of(&pair, pair.plastic_stiffness(), medium.density())?, medium.density()))
        };
        Some(match self.value {
            Value::Speed => speed()?,
            Value::SpeedRatio => speed()? / other()?.0,
            Value::CriticalAngle => critical_angle([speed()?, other()?.0]).unwrap_or(FRAC_PI_2),
            Value::ImpedanceRatio => {
                let (other_speed, other_density) = other()?;
                speed()? * density / (other_speed * other_density)
            }
            Value::PlasticForce => pair.plastic_force(),
            Value::Dissipation => dissipation(pair, self.amplitude.unwrap_or(DISSIPATED_AT)),
        })
    }

    /// The value of a medium, in SI; none where nothing can be said.
    pub fn value_of_medium(&self, medium: &Medium) -> Option<f64> {
        let pair = medium.pair(self.diameter, self.constants);
        self.value_of(&pair, pair.plastic_stiffness(), medium.density())
    }

    /// Where a medium lies on an axis. On those that say nothing of what it is made of, at the setting's own value.
    pub fn place(&self, medium: &Medium, axis: Axis) -> f64 {
        let pair = medium.pair(self.diameter, self.constants);
        match axis {
            Axis::Stiffness => pair.plastic_stiffness(),
            Axis::Density => medium.density(),
            Axis::YieldStress => pair.yield_stress,
            Axis::Modulus => medium.equivalent_modulus(),
            Axis::Radius => 0.5 * self.diameter,
            Axis::Amplitude => self.amplitude.unwrap_or(SHOWN_AT),
            Axis::Dimension => f64::from(self.dimension.number()),
        }
    }
}
