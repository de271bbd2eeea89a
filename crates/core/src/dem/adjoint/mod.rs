//! How scores change with each sphere: the discrete adjoint of a run.
//!
//! A score is a weighted sum of the greatest kinetic energies of spheres. [`gradient`] gives its derivatives with respect to what every sphere is
//! made of, its radius and place, and the load, all at once: the steps of the run are walked through backwards, each transposed. What
//! is differentiated is what was computed, to rounding: the multistep scheme with its predictor, every contact that has come up, and what
//! contacts remember, with friction their springs and all spins too. The greatest energies are taken at the steps at which they fell.
//!
//! - `contact`: one contact as a function of numbers of any kind; its slopes by dual numbers ([`Dual`](crate::real::Dual))
//! - `model`: a run as such a function, with the bits of [`simulate`](super::simulate)
//! - `backward`: the transposed step
//! - `schedule`: which states are kept
//!
//! **A derivative is not a difference.** Spheres that collide many times make scores change on ever smaller scales: over 350 µs those of
//! the protected region hold over a millionth of a density, not over a hundredth. Whoever quotes them puts a secant beside them.

mod backward;
mod contact;
mod model;
mod schedule;
#[cfg(test)]
mod tests;

use backward::{Adjoint, Back, Step};
use contact::{Make, OUTCOMES, OUTCOMES_RUBBING, Sloped, WIDE, WIDE_RUBBING, sloped_by_quantities};
use model::{Frame, Kind, Model, Scratch, State, inverse_inertias, inverse_masses, kinds};
use schedule::blocks;

use super::Integrator;
use super::guard::Stop;
use super::impact::{Impact, contacts_found, steps_in};
use super::neighbour::OverlapAtRest;
use crate::Context;
use crate::real::Width;
use crate::sample::Sample;

/// Derivatives of a weighted sum of greatest kinetic energies (J), with respect to the logarithms of quantities of each sphere: what the sum
/// gains, over what the quantity gains relative to itself.
#[derive(Clone, Debug, PartialEq)]
pub struct Gradient {
    /// The sum (J).
    pub value: f64,
    /// By ln ρ of each sphere (J); its mass follows.
    pub density: Vec<f64>,
    /// By ln E (J).
    pub youngs_modulus: Vec<f64>,
    /// By ln σ_y (J). Where a contact's spheres yield at the same stress, the mean of both sides of the kink.
    pub yield_stress: Vec<f64>,
    /// By ln r, centres in their places (J); mass, contact and gap follow.
    pub radius: Vec<f64>,
    /// By each sphere's place (J/m).
    pub place: Vec<[f64; 2]>,
    /// By the logarithm of the load (J).
    pub load: f64,
}

/// Derivatives of one run, and what they took.
#[derive(Clone, Debug, PartialEq)]
pub struct Gradients {
    /// One for each sum that was asked for.
    pub of: Vec<Gradient>,
    /// Greatest kinetic energy of each sphere (J), as of [`simulate`](super::simulate).
    pub max_kinetic: Vec<f64>,
    /// What states and slopes took at most (bytes).
    pub bytes: usize,
}

/// Why there are no derivatives.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum GradientError {
    /// Spheres overlap before the impact.
    #[error(transparent)]
    Overlap(#[from] OverlapAtRest),
    /// The run ended before its window did.
    #[error("the run has no derivatives: {0}")]
    Stopped(Stop),
    /// Runge-Kutta's scheme has no transposed step here.
    #[error("derivatives are those of the integrators adams and verlet, not of rk4")]
    RungeKutta,
    /// A projectile strikes, whose motion has no transposed step here.
    #[error("derivatives are those under a force pulse, not under a projectile")]
    Projectile,
    /// Faces across no axis, which are in space.
    #[error("derivatives are those of sheets between mirrors across axes; this impact has other faces")]
    Faces,
}

/// Derivatives of sums of greatest kinetic energies over an impact's window, with Coulomb's friction of a coefficient where one is given
/// ([`simulate_with_friction`](super::simulate_with_friction)): each sum is given by its spheres and their weights.
///
/// Takes the time of ten runs or so, whatever the number of spheres, quantities and sums, and memory as the square root of the steps.
///
/// # Errors
/// A packing that cannot be simulated, a run that was stopped or interrupted, or an integrator without a transposed step.
pub fn gradient(
    sample: &Sample<2>,
    impact: &Impact,
    friction: Option<f64>,
    sums: &[Vec<(usize, f64)>],
    context: &Context,
) -> Result<Gradients, GradientError> {
    if impact.integrator == Integrator::Rk4 {
        return Err(GradientError::RungeKutta);
    }
    if impact.projectile.is_some() {
        return Err(GradientError::Projectile);
    }
    if !impact.faces.is_empty() {
        return Err(GradientError::Faces);
    }
    let (list, grains, stop) = contacts_found(sample, impact, friction, context)?;
    if let Some(stop) = stop {
        return Err(GradientError::Stopped(stop));
    }
    let mut frame = Frame::new(sample, (impact, friction), &list, &grains);
    let kinds = kinds(sample, impact, &mut frame);
    let plain = Model {
        inverse_mass: inverse_masses(sample),
        inverse_inertia: inverse_inertias(sample, &frame, &grains),
        makes: kinds.iter().map(|kind| kind.make(&|value, _| value)).collect(),
    };
    let there = There::go(sample, impact, (&frame, &plain), context)?;
    match friction {
        None => there.back::<WIDE, OUTCOMES>(sample, impact, (&frame, &plain, &kinds), sums, context),
        Some(_) => {
            there.back::<WIDE_RUBBING, OUTCOMES_RUBBING>(sample, impact, (&frame, &plain, &kinds), sums, context)
        }
    }
}

/// The way there: the states that begin a block, and when each sphere was fastest.
struct There {
    kept: Vec<State<f64>>,
    fastest: Fastest,
    blocks: Vec<std::ops::Range<u64>>,
}

impl There {
    fn go(
        sample: &Sample<2>,
        impact: &Impact,
        (frame, plain): (&Frame, &Model<f64>),
        context: &Context,
    ) -> Result<Self, GradientError> {
        let mut state = State::at_start(frame, &impact.moving);
        let mut scratch = Scratch::new(frame);
        let mut fastest = Fastest::new(sample.spheres.len());
        fastest.look(0, &state);
        let mut kept = vec![state.clone()];
        let blocks = blocks(steps_in(impact.window, impact.step));
        for block in blocks.iter().rev() {
            for step in block.clone() {
                frame.advance(plain, &mut state, impact.pulse.during(step, impact.step), &mut scratch);
                fastest.look(step + 1, &state);
            }
            kept.push(state.clone());
            stop_if_asked(context, block.end as f64 * impact.step)?;
        }
        kept.pop();
        Ok(Self { kept, fastest, blocks })
    }

    /// And back.
    fn back<const W: usize, const O: usize>(
        mut self,
        sample: &Sample<2>,
        impact: &Impact,
        (frame, plain, kinds): (&Frame, &Model<f64>, &[Kind]),
        sums: &[Vec<(usize, f64)>],
        context: &Context,
    ) -> Result<Gradients, GradientError> {
        let load = |step: u64| impact.pulse.during(step, impact.step);
        let sloped: Vec<Make<Sloped<W>>> = kinds.iter().map(|kind| kind.make(&sloped_by_quantities)).collect();
        let spheres = sample.spheres.len();
        let energy = |i: usize| 0.5 * sample.mass(i) * self.fastest.squared[i];
        let max_kinetic: Vec<f64> = (0..spheres).map(energy).collect();
        let mut scratch = Scratch::new(frame);
        let mut adjoints: Vec<Adjoint> = sums.iter().map(|_| Adjoint::new(frame)).collect();
        let back = Back::<W, O> { frame, plain, sloped: &sloped, width: Width::widest() };
        let mut bytes = 0;
        for block in &self.blocks {
            let mut states = self.kept.pop().into_iter().collect::<Vec<State<f64>>>();
            let mut predicted = Vec::new();
            for step in block.clone() {
                let mut next = states[states.len() - 1].clone();
                frame.advance(plain, &mut next, load(step), &mut scratch);
                states.push(next);
                predicted.push((scratch.predicted.clone(), scratch.spins.clone()));
            }
            let velocities = predicted.len() * (spheres * size_of::<[f64; 2]>() + frame.turning() * size_of::<f64>());
            bytes = bytes.max((self.kept.len() + states.len()) * states[0].bytes() + velocities);
            for (k, pair) in states.windows(2).enumerate().rev() {
                let step = block.start + k as u64;
                for (adjoint, sum) in adjoints.iter_mut().zip(sums) {
                    let falls_now = |&&(i, _): &&(usize, f64)| self.fastest.when[i] == step + 1;
                    for &(i, weight) in sum.iter().filter(falls_now) {
                        adjoint.gain_energy(i, weight * sample.mass(i), pair[1].velocity[i]);
                    }
                }
                let (predicted, spins) = (&predicted[k].0, &predicted[k].1);
                back.step(&Step { before: &pair[0], after: &pair[1], predicted, spins }, load(step), &mut adjoints);
            }
            stop_if_asked(context, block.start as f64 * impact.step)?;
        }
        let value = |sum: &Vec<(usize, f64)>| sum.iter().map(|&(i, weight)| weight * max_kinetic[i]).sum();
        let of = adjoints.into_iter().zip(sums).map(|(adjoint, sum)| adjoint.gradient(value(sum))).collect();
        Ok(Gradients { of, max_kinetic, bytes: bytes + frame.places.len() * size_of::<[f64; 64]>() })
    }
}

fn stop_if_asked(context: &Context, time_s: f64) -> Result<(), GradientError> {
    match context.stopped() {
        true => Err(GradientError::Stopped(Stop::Interrupted { time_s })),
        false => Ok(()),
    }
}

/// Each sphere's greatest v² over accepted steps, and after how many steps it fell.
struct Fastest {
    squared: Vec<f64>,
    when: Vec<u64>,
}

impl Fastest {
    fn new(spheres: usize) -> Self {
        Self { squared: vec![0.0; spheres], when: vec![0; spheres] }
    }

    fn look(&mut self, step: u64, state: &State<f64>) {
        for (i, &[x, z]) in state.velocity.iter().enumerate().take(state.reached) {
            let squared = x * x + z * z;
            if squared > self.squared[i] {
                (self.squared[i], self.when[i]) = (squared, step);
            }
        }
    }
}

impl<N> State<N> {
    /// What it takes.
    fn bytes(&self) -> usize {
        let numbers = 4 * (self.turning.spin.len() + self.turning.spring.len());
        self.displacement.len() * 5 * size_of::<[N; 2]>() + (self.history.len() * 3 + numbers) * size_of::<N>()
    }
}
