//! One impact on one crystal, by the discrete-element method.

pub mod load;

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

/// How positions and velocities are advanced.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Integrator {
    /// Velocity Verlet with the predicted velocity in the force: one force sweep per step. The default.
    #[default]
    Verlet,
    /// Classical Runge-Kutta of fourth order: five sweeps per step; the reference to compare with.
    Rk4,
}

impl fmt::Display for Integrator {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Verlet => "verlet",
            Self::Rk4 => "rk4",
        })
    }
}

impl FromStr for Integrator {
    type Err = String;
    fn from_str(name: &str) -> Result<Self, String> {
        match name {
            "verlet" => Ok(Self::Verlet),
            "rk4" => Ok(Self::Rk4),
            _ => Err(format!("unknown integrator \"{name}\"; known are verlet, rk4")),
        }
    }
}
