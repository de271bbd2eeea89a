//! One step, transposed.

use super::Gradient;
use super::contact::{Make, Place, QUANTITIES, Sloped, slopes};
use super::model::{Frame, Model, State, motion};
use crate::dem::contacts::CLOSED;
use crate::real::{Kernel, Lanes, Width};

/// What an objective gains by the state at one moment, and what it has gained by the spheres' quantities since.
pub(super) struct Adjoint {
    pub displacement: Vec<[f64; 2]>,
    pub velocity: Vec<[f64; 2]>,
    pub acceleration: [Vec<[f64; 2]>; 3],
    pub history: Vec<[f64; 3]>,
    /// By ln m.
    mass: Vec<f64>,
    /// By the quantities, mass apart.
    quantities: Vec<[f64; QUANTITIES]>,
    /// By ln of the load.
    load: f64,
    /// Within a step: by the force on each sphere, and by the velocity in the force.
    force: Vec<[f64; 2]>,
    predicted: Vec<[f64; 2]>,
}

impl Adjoint {
    pub fn new(frame: &Frame) -> Self {
        let spheres = frame.mobility.len();
        let zeros = || vec![[0.0; 2]; spheres];
        Self {
            displacement: zeros(),
            velocity: zeros(),
            acceleration: [zeros(), zeros(), zeros()],
            history: vec![[0.0; 3]; frame.places.len()],
            mass: vec![0.0; spheres],
            quantities: vec![[0.0; QUANTITIES]; spheres],
            load: 0.0,
            force: zeros(),
            predicted: zeros(),
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
        let with_mass = |which: usize, power: f64| {
            quantity(which).iter().zip(&self.mass).map(|(by, mass)| by + power * mass).collect()
        };
        Gradient {
            value,
            density: with_mass(0, 1.0),
            youngs_modulus: quantity(1),
            yield_stress: quantity(2),
            radius: with_mass(3, 3.0),
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
    /// The velocities in the force.
    pub predicted: &'a [[f64; 2]],
}

/// A run that can be walked through backwards.
pub(super) struct Back<'a> {
    pub frame: &'a Frame,
    pub plain: &'a Model<f64>,
    /// Makes of contacts, with their slopes.
    pub sloped: &'a [Make<Sloped>],
    /// Slopes of a contact fill registers of this width.
    pub width: Width,
}

/// The part of a step at contacts, compiled for a register's instructions, though what stands side by side are not designs but slopes.
struct AtContacts<'a, 'b> {
    back: &'a Back<'a>,
    step: &'a Step<'a>,
    adjoints: &'b mut [Adjoint],
}

impl Kernel for AtContacts<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Lanes>(self) {
        let Self { back: &Back { frame, sloped, .. }, step: &Step { before, after, predicted }, adjoints } = self;
        for c in frame.contacts_of(before.reached) {
            let (place, [a, b]) = (&frame.places[c], frame.ends[c]);
            let motion = motion(place, [a, b], &after.displacement, predicted);
            let Some(slopes) = slopes(place, &sloped[frame.kind[c]], &motion, &before.history[c], CLOSED) else {
                continue;
            };
            for adjoint in &mut *adjoints {
                let (of_a, of_b) = (adjoint.force[a], adjoint.force[b]);
                let is_pair = matches!(place, Place::Pair(_));
                let weight = frame.weight[c];
                let force = match is_pair {
                    true => [weight * (of_b[0] - of_a[0]), weight * (of_b[1] - of_a[1])],
                    false => of_a,
                };
                let gains = slopes.transposed(force, adjoint.history[c]);
                adjoint.history[c] = gains.history;
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

impl Back<'_> {
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
        let Adjoint { velocity, acceleration: [now, one, two], mass, force, predicted, .. } = adjoint;
        for i in 0..after.reached {
            for k in 0..2 {
                let gain = velocity[i][k];
                let new = now[i][k] + (half - m2 - m3) * gain;
                now[i][k] = one[i][k] + (half + 2.0 * m2 + 3.0 * m3) * gain;
                one[i][k] = two[i][k] - (m2 + 3.0 * m3) * gain;
                two[i][k] = m3 * gain;
                force[i][k] = new * self.plain.inverse_mass[i] * frame.mobility[i][k];
                mass[i] -= new * after.acceleration[0][i][k];
                predicted[i][k] = 0.0;
            }
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
    }
}
