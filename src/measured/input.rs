//! What of a rig is uncertain, and is fitted.

use std::fmt;

use crate::dem::rig::{Friction, LawBook, Rig};

/// An uncertain input.
#[derive(Clone, Debug, PartialEq)]
pub enum Input {
    /// A factor on all that strikes: loads, bars' incoming pulses, velocities at the start.
    Amplitude,
    /// A factor on the yield stress of all materials, or of one.
    YieldStress(Option<String>),
    /// The coefficient of friction.
    Friction,
}

/// An input that a rig does not have.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum InputError {
    /// No such input.
    #[error("\"{0}\" is no input to fit; known are amplitude, yield_stress, yield_stress:MATERIAL and friction")]
    Unknown(String),
    /// No such material in the rig.
    #[error("yield_stress:{0}: the rig holds no {0}, but {1}")]
    Material(String, String),
    /// Laws with friction of their own.
    #[error(
        "friction: the contacts of this rig have a friction of their own for each material, which cannot be fitted"
    )]
    OwnFriction,
    /// Nothing strikes.
    #[error("amplitude: nothing strikes in this rig, so that there is nothing to scale")]
    Nothing,
    /// An input is asked for twice.
    #[error("{0} is asked for twice")]
    Twice(String),
}

impl fmt::Display for Input {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Amplitude => f.write_str("amplitude"),
            Self::YieldStress(None) => f.write_str("yield_stress"),
            Self::YieldStress(Some(material)) => write!(f, "yield_stress:{material}"),
            Self::Friction => f.write_str("friction"),
        }
    }
}

impl std::str::FromStr for Input {
    type Err = InputError;
    fn from_str(text: &str) -> Result<Self, InputError> {
        match text.split_once(':') {
            None if text == "amplitude" => Ok(Self::Amplitude),
            None if text == "yield_stress" => Ok(Self::YieldStress(None)),
            None if text == "friction" => Ok(Self::Friction),
            Some(("yield_stress", material)) => Ok(Self::YieldStress(Some(material.to_owned()))),
            _ => Err(InputError::Unknown(text.to_owned())),
        }
    }
}

impl Input {
    /// What its value means.
    pub fn meaning(&self) -> &'static str {
        match self {
            Self::Amplitude | Self::YieldStress(_) => "times that of the file",
            Self::Friction => "coefficient",
        }
    }

    /// Its value as the file has it.
    pub fn start<const D: usize>(&self, rig: &Rig<D>) -> f64 {
        match (self, &rig.laws) {
            (Self::Friction, LawBook::Materials { friction, .. }) => {
                friction.map_or(0.0, |friction| friction.coefficient)
            }
            _ => 1.0,
        }
    }

    /// Between which values it is sought.
    pub fn range(&self) -> [f64; 2] {
        match self {
            Self::Amplitude | Self::YieldStress(_) => [0.2, 5.0],
            Self::Friction => [0.0, 1.5],
        }
    }

    /// A change of it that shows in records, for differences.
    pub fn nudge(&self) -> f64 {
        match self {
            Self::Amplitude | Self::YieldStress(_) => 2e-3,
            Self::Friction => 5e-3,
        }
    }

    /// Whether a rig has it.
    ///
    /// # Errors
    /// See [`InputError`].
    pub fn check<const D: usize>(&self, rig: &Rig<D>) -> Result<(), InputError> {
        match self {
            Self::Amplitude => {
                let moves = |v: &[f64; D]| v.iter().any(|v| *v != 0.0);
                let strikes = !rig.loads.is_empty()
                    || rig.bars.iter().any(|bar| bar.incident.is_some())
                    || rig.flats.iter().any(|flat| moves(&flat.velocity))
                    || rig.velocity.iter().any(moves)
                    || rig.clusters.iter().any(|cluster| moves(&cluster.velocity));
                if strikes { Ok(()) } else { Err(InputError::Nothing) }
            }
            Self::YieldStress(Some(name)) => {
                let names = || rig.sample.materials.iter().map(|material| material.name.as_str());
                if names().any(|known| known == name) {
                    return Ok(());
                }
                Err(InputError::Material(name.clone(), names().collect::<Vec<_>>().join(", ")))
            }
            Self::Friction if matches!(rig.laws, LawBook::Dashpot { .. }) => Err(InputError::OwnFriction),
            Self::YieldStress(None) | Self::Friction => Ok(()),
        }
    }

    /// The rig with this input at a value.
    pub fn set<const D: usize>(&self, rig: &mut Rig<D>, value: f64) {
        match self {
            Self::Amplitude => {
                let scale = |v: &mut [f64; D]| v.iter_mut().for_each(|v| *v *= value);
                rig.loads.iter_mut().for_each(|load| load.curve = load.curve.scaled(value));
                rig.bars
                    .iter_mut()
                    .filter_map(|bar| bar.incident.as_mut())
                    .for_each(|curve| *curve = curve.scaled(value));
                rig.flats.iter_mut().for_each(|flat| scale(&mut flat.velocity));
                rig.velocity.iter_mut().for_each(scale);
                rig.clusters.iter_mut().for_each(|cluster| scale(&mut cluster.velocity));
            }
            Self::YieldStress(of) => {
                let meant = |name: &str| of.as_ref().is_none_or(|of| of == name);
                rig.sample
                    .materials
                    .iter_mut()
                    .filter(|material| meant(&material.name))
                    .for_each(|material| material.yield_stress *= value);
            }
            Self::Friction => {
                if let LawBook::Materials { friction, .. } = &mut rig.laws {
                    let set = |known: Friction| Friction { coefficient: value, ..known };
                    *friction = Some(friction.map_or_else(|| Friction::mindlin(value), set));
                }
            }
        }
    }
}
