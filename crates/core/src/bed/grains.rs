//! What the grains of a bed are like, and the laws that follow.

use std::f64::consts::PI;

use serde::{Deserialize, Serialize};

use super::settle::STEP;
use super::{Bed, Disk};
use crate::contact::Dashpot;
use crate::dem::rig::{Arm, Friction, LawBook, Loss, Rig, Spring};
use crate::material::Material;
use crate::sample::{Sample, Sphere};

/// How the dashpot's constant follows from the restitution asked for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Damping {
    /// γ_n = −2 ln e_n/τ_c, as Kondic et al. 2012 have it. The true restitution then differs: 0.491 for e_n = 0.5.
    #[default]
    Kondic,
    /// γ_n of each pair solved for, so that its head-on collisions have exactly the restitution e_n.
    Exact,
}

/// Restitution and friction of a kind of disk.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Surface {
    /// e_n
    pub restitution: f64,
    /// μ
    pub friction: f64,
    /// k_t over k; zero is kinetic friction, 0.8 static (Kondic et al. 2012).
    pub tangential_stiffness: f64,
}

/// What the grains of a bed are like.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Grains {
    /// k_n, the stiffness over m g/d of the gravity by which τ_c is defined.
    pub stiffness: f64,
    /// Gravity over that by which τ_c is defined.
    pub gravity: f64,
    /// Between grains, and between grains and the intruder.
    pub grains: Surface,
    /// Against walls.
    pub walls: Surface,
    /// How restitution sets the dashpot.
    pub damping: Damping,
    /// Whether forces are cut at zero, so that contacts never pull.
    pub cut: bool,
    /// Where the lever arms of friction end.
    #[serde(default)]
    pub arm: Arm,
}

/// Spring stiffness in the units of beds, π²/2: half a period of two disks of mass 1 is then 1.
pub const SPRING: f64 = PI * PI / 2.0;

impl Default for Grains {
    /// The default of Kondic et al. 2012: k_n 4000, e_n 0.5, μ 0.5, kinetic friction; walls μ 0.9, e_n 0.1.
    fn default() -> Self {
        Self {
            stiffness: 4000.0,
            gravity: 1.0,
            grains: Surface { restitution: 0.5, friction: 0.5, tangential_stiffness: 0.0 },
            walls: Surface { restitution: 0.1, friction: 0.9, tangential_stiffness: 0.0 },
            damping: Damping::Kondic,
            cut: false,
            arm: Arm::Radius,
        }
    }
}

impl Grains {
    /// Gravity (d/τ_c²).
    pub fn fall(&self) -> f64 {
        self.gravity * SPRING / self.stiffness
    }

    /// The dashpot's γ_n (1/τ_c) for a restitution, of two disks of mass 1.
    pub fn dashpot_rate(&self, restitution: f64) -> f64 {
        match self.damping {
            Damping::Kondic => -2.0 * restitution.ln(),
            Damping::Exact => Dashpot::with_restitution(SPRING, 0.5, restitution, self.cut).damping / 0.5,
        }
    }

    /// The step (τ_c) of an impact on grains down to a diameter (d): 1/50 of a collision of mean grains, or, where restitution is to be
    /// exact, that at which it is so to 0.1 % between any of them and at walls, (1 + η) ω h = 0.065; see [`Loss::Ratio`].
    pub fn step(&self, smallest: f64) -> f64 {
        let mass = smallest * smallest;
        let needed = |surface: &Surface, reduced: f64| match Loss::with_restitution(surface.restitution, self.cut) {
            Loss::Ratio(ratio) => 0.065 / ((1.0 + ratio) * (SPRING / reduced).sqrt()),
            Loss::Rate(_) => f64::INFINITY,
        };
        match self.damping {
            Damping::Kondic => STEP,
            Damping::Exact => STEP.min(needed(&self.grains, 0.5 * mass)).min(needed(&self.walls, mass)),
        }
    }

    /// Restitution of a head-on collision of two disks of mass 1 with the dashpot's γ_n (1/τ_c), in closed form. Lighter disks
    /// collide for a shorter time and rebound with a little more, heavier ones with less.
    pub fn true_restitution(&self, rate: f64) -> f64 {
        let mean = 0.5;
        Dashpot { stiffness: SPRING, damping: rate * mean, cut: self.cut }.restitution(mean)
    }

    /// Laws between grains (material 0) and with walls (material 1), with friction or without.
    pub fn laws(&self, with_friction: bool) -> LawBook {
        let of = |surface: &Surface| {
            let rate = self.dashpot_rate(surface.restitution);
            let spring = match surface.tangential_stiffness {
                0.0 => Spring::None,
                part => Spring::Constant(part * SPRING),
            };
            let friction = Friction { coefficient: surface.friction, spring, damping: 0.5 * rate, rolling: 0.0 };
            let loss = match self.damping {
                Damping::Kondic => Loss::Rate(rate),
                Damping::Exact => Loss::with_restitution(surface.restitution, self.cut),
            };
            (loss, (with_friction && surface.friction > 0.0).then_some(friction))
        };
        let materials = vec![of(&self.grains), of(&self.walls)];
        LawBook::Dashpot { stiffness: SPRING, materials, cut: self.cut, arm: self.arm }
    }

    /// A bed as a rig at rest: grains first, then walls. Masses D², moments of inertia m D²/8.
    pub fn rig(&self, bed: &Bed, with_friction: bool) -> Rig<2> {
        let sphere = |disk: &Disk, material| Sphere { centre: disk.centre, radius: 0.5 * disk.diameter, material };
        let grains = bed.grains.iter().map(|disk| sphere(disk, 0));
        let spheres: Vec<Sphere<2>> = grains.chain(bed.walls.iter().map(|disk| sphere(disk, 1))).collect();
        let materials = vec![placeholder("grains"), placeholder("walls")];
        let mut rig = Rig::new(Sample { materials, spheres }, self.laws(with_friction));
        for (i, sphere) in rig.sample.spheres.iter().enumerate() {
            let diameter = 2.0 * sphere.radius;
            rig.mass[i] = diameter * diameter;
            rig.inertia[i] = rig.mass[i] * diameter * diameter / 8.0;
            rig.held[i] = [sphere.material == 1; 2];
        }
        rig.gravity = [0.0, -self.fall()];
        rig.periods = [bed.periodic.then_some(bed.width), None];
        rig.precompressed = true;
        // Soft disks overlap by a third under a hard blow (Kondic et al. 2012); contacts begin and end with a jump of the
        // dashpot's force, which the trapezoids of the ledger resolve to a few percent of what it takes.
        (rig.overlap_limit, rig.residual_limit) = (Some(0.9), 0.1);
        rig
    }
}

/// Disks have laws of their own; of materials only the number matters.
fn placeholder(name: &str) -> Material {
    Material {
        name: name.to_owned(),
        density: 1.0,
        youngs_modulus: 1.0,
        poisson_ratio: 0.3,
        yield_stress: 1.0,
        rate_constant: 0.0,
        source: "Kondic et al. 2012".to_owned(),
    }
}

#[cfg(test)]
mod tests {

    use super::*;
    use crate::Context;
    use crate::dem::rig::Simulation;

    /// With exact damping any two grains rebound with the restitution asked for to 0.1 % at the step that is chosen, wherever in a step they
    /// meet, and so does a grain at a wall; with Kondic's they do not.
    #[test]
    fn exact_damping_is_exact_for_every_pair() {
        let rebound = |grains: &Grains, diameters: [f64; 2], fixed: bool, gap: f64| {
            let reach = 0.5 * (diameters[0] + diameters[1]);
            let disk = |x: f64, diameter| Disk { centre: [x, 5.0], diameter };
            let mut bed =
                Bed { grains: vec![disk(5.0, diameters[0])], walls: Vec::new(), width: 10.0, periodic: false };
            let other = disk(5.0 + reach + gap, diameters[1]);
            if fixed {
                bed.walls.push(other)
            } else {
                bed.grains.push(other)
            }
            let mut rig = grains.rig(&bed, false);
            (rig.gravity, rig.velocity[0]) = ([0.0; 2], [0.2, 0.0]);
            let mut simulation = Simulation::new(rig, grains.step(0.6)).unwrap();
            simulation.advance(1000, &Context::default()).unwrap();
            let view = simulation.view();
            (view.velocity(1)[0] - view.velocity(0)[0]) / 0.2
        };
        for (cut, e) in [(false, 0.5), (false, 0.1), (true, 0.5), (false, 0.9)] {
            let of = |restitution| Surface { restitution, ..Grains::default().grains };
            let exact = Grains { damping: Damping::Exact, cut, grains: of(e), walls: of(e), ..Grains::default() };
            for (diameters, fixed) in
                [([1.0, 1.0], false), ([0.6, 0.6], false), ([0.6, 1.4], false), ([0.7, 0.5], true)]
            {
                for gap in [0.0, 0.0007, 0.0013, 0.0029] {
                    let found = rebound(&exact, diameters, fixed, gap);
                    assert!((found / e - 1.0).abs() < 1e-3, "{e} {cut} {diameters:?} {gap}: {found}");
                }
            }
        }
        let kondic = rebound(&Grains::default(), [0.6, 0.6], false, 0.0);
        assert!((kondic / 0.5 - 1.0).abs() > 0.05, "{kondic}");
    }

    /// The dashpot solved for gives the restitution asked for, where Kondic's gives less (or more, cut at zero).
    #[test]
    fn exact_damping_has_the_restitution_asked_for() {
        for cut in [false, true] {
            for e in [0.1, 0.5, 0.9] {
                let exact = Grains { damping: Damping::Exact, cut, ..Grains::default() };
                assert!((exact.true_restitution(exact.dashpot_rate(e)) - e).abs() < 1e-12);
            }
        }
        let kondic = Grains::default();
        assert!((kondic.true_restitution(kondic.dashpot_rate(0.5)) - 0.49132).abs() < 5e-6);
    }
}
