//! One impact on one crystal, by the discrete-element method.
//!
//! In: a [`Sample`](crate::sample::Sample) (who sits where, made of what), mirrors, and a load (what hits it, how hard). Out: a
//! [`Record`], what each sphere felt and when. Nothing here knows why it is asked. Spheres, normal forces, δ ≪ R; SI.
//!
//! - `load`, `boundary`: what strikes the crystal and where it ends
//! - `neighbour`: which spheres touch; `list`: which contacts there are, in order; `strangers`: which others may come to; `size`: contacts of unequal spheres
//! - `body`, `contacts`, `table`: the state, the forces and the laws, as parallel arrays
//! - `plate`: a rigid flat that strikes
//! - `friction`: tangential forces and rotation in the plane
//! - `step`: velocity Verlet, Adams's multistep scheme and Runge-Kutta
//! - `record`, `ledger`: what was felt, where the energy went; `arrival`: when a sphere was first reached
//! - `guard`: what stops a run; `clock`: where its time goes
//! - `follow`: a run from start to end; `impact`: of one design, with what is recorded; `batch`: of many on one lattice at once
//! - `dimension`: in how many dimensions all this is compiled
//! - `adjoint`: how scores change with each sphere: derivatives of a run
//! - `share`: long loops on several threads
//! - `checkpoint`: states as bytes
//! - `sheet`: large hexagonal sheets of elastic spheres, by a stencil in place of lists
//! - `rig`: everything else that a lab can build: contacts that come and go, flats, bars, friction, gravity
//!
//! Only spheres that the wave has reached are stepped. Those beyond are exactly at rest (displacements are held, not
//! positions), so leaving them out changes no bit.

mod adjoint;
mod arrival;
mod batch;
mod body;
mod boundary;
pub mod bulk;
mod checkpoint;
mod clock;
mod contacts;
mod dimension;
mod follow;
mod friction;
mod guard;
mod impact;
mod ledger;
mod list;
mod load;
mod neighbour;
mod plate;
mod record;
pub mod rig;
mod share;
pub mod sheet;
mod size;
mod step;
mod strangers;
mod table;

pub use adjoint::{Gradient, GradientError, Gradients, gradient};
pub use batch::{
    BatchError, Limit, PeakEnergies, screen_batch, simulate_batch, simulate_batch_timed, simulate_batch_under,
    simulate_batch_with_friction, simulate_batch_within,
};
pub use boundary::{Face, Mirror, Period};
pub use checkpoint::{CheckpointError, sealed, sealed_behind, unsealed};
pub use clock::Phases;
pub use dimension::{InAny, MoveIn, Spheres};
pub use guard::{OVERLAP_WARNING, RESIDUAL_LIMIT, Stop, stable_step};
pub use impact::{ContactRecord, Impact, Record, simulate, simulate_with_friction, steps_in};
pub use ledger::Ledger;
pub use load::{ForcePulse, Projectile, Strike};
pub use neighbour::OverlapAtRest;

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

/// How positions and velocities are advanced.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Integrator {
    /// Velocity Verlet with the predicted velocity in the force: one force sweep per step.
    Verlet,
    /// Multistep, of fourth order in smooth motion, also with one force sweep per step: 1.7 times Verlet's step at the same accuracy.
    /// The default.
    #[default]
    Adams,
    /// Classical Runge-Kutta of fourth order: five sweeps per step; the reference to compare with.
    Rk4,
}

impl Integrator {
    /// The greatest stable ωh over Verlet's, which is 2.
    pub const fn stability(self) -> f64 {
        match self {
            Self::Verlet => 1.0,
            Self::Adams => 0.705,
            // 1.41 in truth, of which no use is made.
            Self::Rk4 => 1.0,
        }
    }
}

impl fmt::Display for Integrator {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Verlet => "verlet",
            Self::Adams => "adams",
            Self::Rk4 => "rk4",
        })
    }
}

impl FromStr for Integrator {
    type Err = String;
    fn from_str(name: &str) -> Result<Self, String> {
        match name {
            "verlet" => Ok(Self::Verlet),
            "adams" => Ok(Self::Adams),
            "rk4" => Ok(Self::Rk4),
            _ => Err(format!("unknown integrator \"{name}\"; known are verlet, adams, rk4")),
        }
    }
}
