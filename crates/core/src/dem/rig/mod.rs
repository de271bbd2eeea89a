//! Anything a lab can build: spheres that may part and meet anew, flats, sides, bars, and whatever strikes or holds them.
//!
//! In: a [`Rig`], which says what stands where, how it is held and what acts on it. Out: a [`Simulation`] that is advanced,
//! looked at, stored and taken up again. Where [`simulate`](super::simulate) follows one pulse through a crystal whose
//! contacts are those of its lattice, a rig finds its contacts as it goes; friction, rotation and gravity can be switched on.
//!
//! - `cluster`: spheres bound to each other
//! - `flat`: rigid faces, fixed, moved or free; `curve`: what a load is over time
//! - `law`: which law holds between which bodies; `dashpot`: springs and dashpots
//! - `pairs`: who is near whom, with a skin; `bodies`, `spins`, `contacts`: the state and the forces, as parallel arrays
//! - `machine`: one step, by velocity Verlet or Adams's scheme; `engine`: a machine whatever its law
//! - `simulation`: from start to end; `check`, `guard`: what is refused and what stops a run; `view`: what can be looked at
//! - `peaks`, `ledger`: what each sphere felt, and where the energy went, by mechanism
//! - `impact`: an impact on a crystal as a rig, with friction
//! - `preload`: a crystal squeezed to rest; `modes`: its small vibrations, `eigen`: of a symmetric matrix
//! - `checkpoint`: the state as bytes, and back
//!
//! Positions are displacements from where the spheres lay at the start, as everywhere in [`dem`](super).

mod bodies;
mod check;
mod checkpoint;
mod cluster;
mod contacts;
mod curve;
mod dashpot;
mod eigen;
mod engine;
mod peaks;
mod flat;
mod guard;
mod impact;
mod law;
mod ledger;
mod machine;
mod modes;
mod pairs;
mod preload;
mod simulation;
mod spins;
mod view;

pub use check::RigError;
pub use cluster::{Cluster, ClusterState};
pub use curve::{Curve, CurveError};
pub use dashpot::{Loss, SpringDashpot};
pub use flat::{Face, Flat, FlatContact};
pub use guard::RigStop;
pub use impact::{rig_step, simulate_as_rig};
pub use law::{Arm, Friction, Law, LawBook, PairRule, Spring};
pub use ledger::{EnergyLedger, Gain};
pub use modes::{Modes, ModesError};
pub use peaks::Arrival;
pub use preload::{Precompressed, PreloadError, Squeeze, precompress};
pub(super) use simulation::Driven;
pub use simulation::Simulation;
pub use view::{FlatState, Touching, View};

use std::fmt;

use super::Mirror;
use crate::sample::Sample;

/// Everything that is simulated together. The last axis is depth: waves run along +, gravity usually too.
#[derive(Clone, Debug)]
pub struct Rig<const D: usize> {
    /// The spheres.
    pub sample: Sample<D>,
    /// Mass of each sphere (kg).
    pub mass: Vec<f64>,
    /// Moment of inertia of each sphere (kg m²); used only with friction.
    pub inertia: Vec<f64>,
    /// Velocity of each sphere at the start (m/s).
    pub velocity: Vec<[f64; D]>,
    /// Spin of each sphere at the start (rad/s): about the axis out of the plane (the last of three) in two dimensions, as a
    /// vector in three.
    pub spin: Vec<[f64; 3]>,
    /// For each sphere the axes along which it cannot move.
    pub held: Vec<[bool; D]>,
    /// Planes of symmetry.
    pub mirrors: Vec<Mirror>,
    /// Per axis the period (m) after which the rig repeats itself, if it does.
    pub periods: [Option<f64>; D],
    /// Rigid faces.
    pub flats: Vec<Flat<D>>,
    /// Rigid bodies made of several of the spheres.
    pub clusters: Vec<Cluster<D>>,
    /// Half-infinite elastic bars that spheres or flats are fixed to.
    pub bars: Vec<Bar>,
    /// Forces and prescribed velocities.
    pub loads: Vec<Load<D>>,
    /// Constant acceleration of everything that is not held (m/s²).
    pub gravity: [f64; D],
    /// Drag per mass on spheres (1/s): −drag · m · v. For settling; zero in physics.
    pub drag: f64,
    /// Contact laws and friction.
    pub laws: LawBook,
    /// Whether spheres may overlap at the start: a squeezed crystal, a settled bed. Otherwise an overlap is refused.
    pub precompressed: bool,
    /// Box that spheres must not leave: lower and upper corner (m).
    pub domain: Option<[[f64; D]; 2]>,
    /// Overlap over the sum of radii above which the run is stopped, in place of the limits of the laws.
    pub overlap_limit: Option<f64>,
    /// Part of the energy put in that the ledger may miss before the run is stopped.
    pub residual_limit: f64,
    /// Greatest step times √(K/m̄), with the stiffness K and the reduced mass m̄ of any contact, at which the run is as accurate as is
    /// asked for; beyond it the run is stopped. Without, only stability counts.
    pub resolution: Option<f64>,
}

/// A sphere or a flat.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Body {
    /// By its index in the sample.
    Sphere(usize),
    /// By its index in [`Rig::flats`].
    Flat(usize),
}

/// In words, counted from 1.
impl fmt::Display for Body {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Sphere(i) => write!(f, "sphere {}", i + 1),
            Self::Flat(k) => write!(f, "flat {}", k + 1),
        }
    }
}

/// A half-infinite one-dimensional elastic medium, such as a Hopkinson bar, that a body is fixed to: it answers motion along
/// `axis` with the force −Z v (its exact impedance), and brings an incoming force pulse F_i(t) to bear with 2 F_i.
#[derive(Clone, Debug, PartialEq)]
pub struct Bar {
    /// What is fixed to it.
    pub body: Body,
    /// Index of the axis along which the bar lies.
    pub axis: usize,
    /// Z = ρ c A (kg/s)
    pub impedance: f64,
    /// The incoming force pulse at the bar's end (N), if any; positive along +axis.
    pub incident: Option<Curve>,
}

/// What acts on bodies over time.
#[derive(Clone, Debug, PartialEq)]
pub struct Load<const D: usize> {
    /// On which bodies; each feels the whole of it.
    pub bodies: Vec<Body>,
    /// Direction, a unit vector.
    pub direction: [f64; D],
    /// Force or velocity.
    pub kind: LoadKind,
    /// Force (N) or velocity (m/s) over time.
    pub curve: Curve,
}

/// How a load acts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LoadKind {
    /// A force; zero after the curve's end.
    Force,
    /// The velocity along the load's direction is prescribed until the curve ends, whatever else acts; then the body is
    /// free. A prescribed body does not move across that direction meanwhile.
    Velocity,
}

impl<const D: usize> Rig<D> {
    /// Whether any contact has friction, so that spheres turn.
    pub fn has_friction(&self) -> bool {
        self.frictions().next().is_some()
    }

    /// Every kind of friction in it.
    pub fn frictions(&self) -> impl Iterator<Item = &Friction> {
        self.laws.frictions().chain(self.flats.iter().filter_map(|flat| flat.contact.friction.as_ref()))
    }

    /// For each sphere the cluster that it belongs to.
    fn clustered(&self) -> Vec<Option<u32>> {
        let mut of = vec![None; self.sample.spheres.len()];
        for (c, cluster) in self.clusters.iter().enumerate() {
            for &i in &cluster.members {
                of[i] = Some(c as u32);
            }
        }
        of
    }

    /// Spheres at rest, free, of their materials' mass, with the moment of inertia of solid spheres; nothing acts on them.
    pub fn new(sample: Sample<D>, laws: LawBook) -> Self {
        let count = sample.spheres.len();
        let mass: Vec<f64> = (0..count).map(|i| sample.mass(i)).collect();
        let inertia = mass.iter().zip(&sample.spheres).map(|(m, s)| 0.4 * m * s.radius * s.radius).collect();
        Self {
            mass,
            inertia,
            velocity: vec![[0.0; D]; count],
            spin: vec![[0.0; 3]; count],
            held: vec![[false; D]; count],
            mirrors: Vec::new(),
            periods: [None; D],
            flats: Vec::new(),
            clusters: Vec::new(),
            bars: Vec::new(),
            loads: Vec::new(),
            gravity: [0.0; D],
            drag: 0.0,
            laws,
            precompressed: false,
            domain: None,
            overlap_limit: None,
            residual_limit: super::RESIDUAL_LIMIT,
            resolution: None,
            sample,
        }
    }
}
