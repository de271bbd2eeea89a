//! One step, transposed.

use super::Gradient;
use super::contact::{Make, Outcome, Place, QUANTITIES, Sloped, slopes};
use super::model::{Frame, Model, State, memory, motion};
use crate::dem::contacts::CLOSED;
use crate::real::{Kernel, Lanes, Width};

/// What an objective gains by the state at one moment, and what it has gained by the spheres' quantities since.
pub(super) struct Adjoint {
    pub displacement: Vec<[f64; 2]>,
    pub velocity: Vec<[f64; 2]>,
    pub acceleration: [Vec<[f64; 2]>; 3],
    pub history: Vec<[f64; 3]>,
    /// By spins, their derivatives, and ξ, √δ and u of springs; empty without friction.
    spin: Vec<f64>,
    turning: [Vec<f64>; 3],
    spring: Vec<[f64; 3]>,
    /// By ln m.
    mass: Vec<f64>,
    /// By ln I; empty without friction.
    inertia: Vec<f64>,
    /// By the quantities, mass apart.
    quantities: Vec<[f64; QUANTITIES]>,
    /// By ln of the load.
    load: f64,
    /// Within a step: by the force on each sphere, and by the velocity in the force.
    force: Vec<[f64; 2]>,
    predicted: Vec<[f64; 2]>,
    /// The same by the couple on each, and by the spin in the force.
    couple: Vec<f64>,
    predicted_spin: Vec<f64>,
}

impl Adjoint {
    pub fn new(frame: &Frame) -> Self {
        let spheres = frame.mobility.len();
        let (zeros, turning) = (|| vec![[0.0; 2]; spheres], || vec![0.0; frame.turning()]);
        Self {
            displacement: zeros(),
            velocity: zeros(),
            acceleration: [zeros(), zeros(), zeros()],
            history: vec![[0.0; 3]; frame.places.len()],
            spin: turning(),
            turning: [turning(), turning(), turning()],
            spring: if frame.friction.is_some() { vec![[0.0; 3]; frame.places.len()] } else { Vec::new() },
            mass: vec![0.0; spheres],
            inertia: turning(),
            quantities: vec![[0.0; QUANTITIES]; spheres],
            load: 0.0,
            force: zeros(),
            predicted: zeros(),
            couple: turning(),
            predicted_spin: turning(),
        }
    }

    /// The objective holds m v²/2 of a sphere at this moment; `mass` is m times its weight.
    pub fn gain_energy(&mut self, sphere: usize, mass: f64, velocity: [f64; 2]) {
        for k in 0..2 {
            self.velocity[sphere][k] += mass * velocity[k];
            self.mass[sphere] += 0.5 * mass * velocity[k] * velocity[k];
        }
    }

    pub fn gradient(self, value: f64) -> Gradient {
        let quantity = |which: usize| self.quantities.iter().map(|of| of[which]).collect::<Vec<f64>>();
        // m goes as the third power of the radius, I as the fifth.
        let with_mass = |which: usize, [of_mass, of_inertia]: [f64; 2]| -> Vec<f64> {
            let inertia = |i: usize| self.inertia.get(i).copied().unwrap_or_default();
            let more = |i: usize| of_mass * self.mass[i] + of_inertia * inertia(i);
            quantity(which).iter().enumerate().map(|(i, by)| by + more(i)).collect()
        };
        Gradient {
            value,
            density: with_mass(0, [1.0, 1.0]),
            youngs_modulus: quantity(1),
            yield_stress: quantity(2),
            radius: with_mass(3, [3.0, 5.0]),
            place: self.displacement,
            load: self.load,
        }
    }
}

/// What the run did in one step.
pub(super) struct Step<'a> {
    pub before: &'a State<f64>,
    /// The corrector leaves displacements as they were predicted.
    pub after: &'a State<f64>,
    /// The velocities in the force, and the spins.
    pub predicted: &'a [[f64; 2]],
    pub spins: &'a [f64],
}

/// A run that can be walked through backwards, whose contacts have `W` slopes and `O` outcomes.
pub(super) struct Back<'a, const W: usize, const O: usize> {
    pub frame: &'a Frame,
    pub plain: &'a Model<f64>,
    /// Makes of contacts, with their slopes.
    pub sloped: &'a [Make<Sloped<W>>],
    /// Slopes of a contact fill registers of this width.
    pub width: Width,
}

/// The part of a step at contacts, compiled for a register's instructions, though what stands side by side are not designs but slopes.
struct AtContacts<'a, 'b, const W: usize, const O: usize> {
    back: &'a Back<'a, W, O>,
    step: &'a Step<'a>,
    adjoints: &'b mut [Adjoint],
}

impl<const W: usize, const O: usize> Kernel for AtContacts<'_, '_, W, O> {
    type Output = ();

    #[inline(always)]
    fn run<V: Lanes>(self) {
        let Self { back: &Back { frame, sloped, .. }, step: &Step { before, after, predicted, spins }, adjoints } =
            self;
        for c in frame.contacts_of(before.reached) {
            let (place, [a, b]) = (&frame.places[c], frame.ends[c]);
            let motion = motion(place, [a, b], &after.displacement, (predicted, spins));
            let slopes = slopes::<W, O>(place, &sloped[frame.kind[c]], &motion, &memory(before, c), CLOSED);
            let Some(slopes) = slopes else {
                // Whatever the spring was, it is forgotten.
                let springs = adjoints.iter_mut().filter_map(|adjoint| adjoint.spring.get_mut(c));
                springs.for_each(|spring| *spring = [0.0; 3]);
                continue;
            };
            for adjoint in &mut *adjoints {
                let (of_a, of_b) = (adjoint.force[a], adjoint.force[b]);
                let is_pair = matches!(place, Place::Pair(_));
                let weight = frame.weight[c];
                let force = match is_pair {
                    true => [weight * (of_b[0] - of_a[0]), weight * (of_b[1] - of_a[1])],
                    false => of_a.map(|by| weight * by),
                };
                let rubs = is_pair && frame.friction.is_some();
                let mut outcome = Outcome { force, history: adjoint.history[c], couple: [0.0; 2], spring: [0.0; 3] };
                if rubs {
                    (outcome.couple, outcome.spring) = ([adjoint.couple[a], adjoint.couple[b]], adjoint.spring[c]);
                }
                let gains = slopes.transposed(&outcome);
                adjoint.history[c] = gains.history;
                if rubs {
                    adjoint.spring[c] = gains.spring;
                    adjoint.predicted_spin[a] += gains.spins[0];
                    adjoint.predicted_spin[b] += gains.spins[1];
                }
                for k in 0..2 {
                    if is_pair {
                        adjoint.displacement[b][k] += gains.shift[k];
                        adjoint.displacement[a][k] -= gains.shift[k];
                        adjoint.predicted[a][k] += gains.approach[k];
                        adjoint.predicted[b][k] -= gains.approach[k];
                    } else {
                        adjoint.displacement[a][k] += gains.shift[k];
                        adjoint.predicted[a][k] += gains.approach[k];
                    }
                }
                for which in 0..QUANTITIES {
                    adjoint.quantities[a][which] += gains.quantities[which];
                    adjoint.quantities[b][which] += gains.quantities[QUANTITIES + which];
                }
            }
        }
    }
}

impl<const W: usize, const O: usize> Back<'_, W, O> {
    /// Turns what objectives gain by the state after a step into what they gain by that before it.
    pub fn step(&self, step: &Step<'_>, load: f64, adjoints: &mut [Adjoint]) {
        for adjoint in &mut *adjoints {
            self.correct(step.after, adjoint);
        }
        self.width.run(AtContacts { back: self, step, adjoints: &mut *adjoints });
        for adjoint in &mut *adjoints {
            self.predict(step.before.reached, load, adjoint);
        }
    }

    /// The corrector's part: what is gained by the new accelerations, and so by forces and masses.
    fn correct(&self, after: &State<f64>, adjoint: &mut Adjoint) {
        let frame = self.frame;
        let (half, [m2, m3]) = (0.5 * frame.step, frame.coefficients.corrector);
        // What is gained by the new acceleration; the others move one step back.
        let corrected = |gain: f64, [now, one, two]: [&mut f64; 3]| {
            let new = *now + (half - m2 - m3) * gain;
            *now = *one + (half + 2.0 * m2 + 3.0 * m3) * gain;
            *one = *two - (m2 + 3.0 * m3) * gain;
            *two = m3 * gain;
            new
        };
        let Adjoint { velocity, acceleration: [now, one, two], mass, force, predicted, .. } = adjoint;
        for i in 0..after.reached {
            for k in 0..2 {
                let new = corrected(velocity[i][k], [&mut now[i][k], &mut one[i][k], &mut two[i][k]]);
                force[i][k] = new * self.plain.inverse_mass[i] * frame.mobility[i][k];
                mass[i] -= new * after.acceleration[0][i][k];
                predicted[i][k] = 0.0;
            }
        }
        let Adjoint { spin, turning: [now, one, two], inertia, couple, predicted_spin, .. } = adjoint;
        for i in 0..spin.len().min(after.reached) {
            let new = corrected(spin[i], [&mut now[i], &mut one[i], &mut two[i]]);
            couple[i] = -(new * self.plain.inverse_inertia[i]);
            inertia[i] -= new * after.turning.acceleration[0][i];
            predicted_spin[i] = 0.0;
        }
    }

    /// The predictor's part.
    fn predict(&self, reached: usize, load: f64, adjoint: &mut Adjoint) {
        let frame = self.frame;
        let (h, half) = (frame.step, 0.5 * frame.step);
        let ([s1, s2], [b1, b2]) = (frame.coefficients.displacement, frame.coefficients.velocity);
        for &i in &frame.struck {
            for k in 0..2 {
                if frame.mobility[i][k] == 0.0 {
                    continue;
                }
                let push = frame.direction[k] * load * self.plain.inverse_mass[i];
                let by_push =
                    h * (half * adjoint.displacement[i][k] + adjoint.predicted[i][k] + adjoint.velocity[i][k]);
                adjoint.mass[i] -= by_push * push;
                adjoint.load += by_push * push;
            }
        }
        let Adjoint { displacement, velocity, acceleration: [now, one, two], predicted, .. } = adjoint;
        for i in 0..reached {
            for k in 0..2 {
                let (by_place, by_predicted) = (h * displacement[i][k], predicted[i][k]);
                velocity[i][k] += by_predicted + by_place;
                now[i][k] += (h + b1 + b2) * by_predicted + (half + s1 + s2) * by_place;
                one[i][k] -= (b1 + 2.0 * b2) * by_predicted + (s1 + 2.0 * s2) * by_place;
                two[i][k] += b2 * by_predicted + s2 * by_place;
            }
        }
        let Adjoint { spin, turning: [now, one, two], predicted_spin, .. } = adjoint;
        for i in 0..spin.len().min(reached) {
            let by_predicted = predicted_spin[i];
            spin[i] += by_predicted;
            now[i] += (h + b1 + b2) * by_predicted;
            one[i] -= (b1 + 2.0 * b2) * by_predicted;
            two[i] += b2 * by_predicted;
        }
    }
}
