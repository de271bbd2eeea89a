//! A rigid flat that strikes the first layer: a mirror that moves.
//!
//! A sphere meets a smooth flat as it meets an equal sphere, its image in the face; so its contact is one with an image, but for the way that the
//! face has come. The flat has one place and one speed in every design, advanced by the table of the scheme as those of spheres are.

use super::boundary::Mirror;
use super::step::Scheme;
use crate::real::Lanes;

/// State of the flat, of every design side by side.
#[derive(Clone, Debug)]
pub(super) struct Plate<V> {
    /// Its face at rest; the crystal lies inward.
    pub mirror: Mirror,
    /// How far it has come (m), and how fast it is (m/s), along the mirror's axis.
    pub displacement: V,
    pub velocity: V,
    /// The place and the speed that contacts see: those that are tried in a step, or were predicted.
    pub seen: [V; 2],
    /// Of all contacts on it (N), by the last sweep.
    pub force: V,
    acceleration: V,
    /// Accelerations one and two steps ago.
    past: [V; 2],
    /// (1/kg)
    inverse_mass: V,
    /// One over the mass before each of the spheres that it strikes (1/kg).
    pub inverse_share: V,
}

impl<V: Lanes> Plate<V> {
    /// A flat of `mass` (kg) behind a face, with a speed (m/s) for each design, before so many spheres.
    pub fn new(mirror: Mirror, mass: f64, speeds: &[f64], spheres: f64) -> Self {
        let zero = V::splat(0.0);
        let mut velocity = zero;
        for lane in 0..V::LANES {
            velocity.set_lane(lane, mirror.inward * speeds[lane.min(speeds.len() - 1)]);
        }
        let (inverse_mass, inverse_share) = (V::splat(1.0 / mass), V::splat(spheres / mass));
        let (seen, past) = ([zero, velocity], [zero; 2]);
        Self {
            mirror,
            displacement: zero,
            velocity,
            seen,
            force: zero,
            acceleration: zero,
            past,
            inverse_mass,
            inverse_share,
        }
    }

    /// Before the sweep of a step.
    #[inline(always)]
    pub fn predict(&mut self, scheme: &Scheme<V>) {
        let [mean, change] = scheme.predict(self.acceleration, self.past);
        self.displacement = self.displacement + scheme.step * (self.velocity + mean);
        self.seen = [self.displacement, self.velocity + change];
    }

    /// After it.
    #[inline(always)]
    pub fn correct(&mut self, scheme: &Scheme<V>) {
        let new = self.force * self.inverse_mass;
        self.velocity = self.velocity + scheme.correct(new, self.acceleration, self.past);
        self.past = [self.acceleration, self.past[0]];
        self.acceleration = new;
    }

    /// A stage of Runge-Kutta, as spheres make it: `share` of the slope in the mean, the next stage `ahead` of the start (s).
    pub fn stage(&mut self, sums: &mut [V; 2], share: V, ahead: V) {
        let (speed, acceleration) = (self.seen[1], self.force * self.inverse_mass);
        *sums = [sums[0] + share * speed, sums[1] + share * acceleration];
        self.seen = [self.displacement + ahead * speed, self.velocity + ahead * acceleration];
    }

    /// The step that its stages make.
    pub fn accept(&mut self, sums: [V; 2], sixth: V) {
        self.displacement = self.displacement + sixth * sums[0];
        self.velocity = self.velocity + sixth * sums[1];
        self.seen = [self.displacement, self.velocity];
    }
}

impl Plate<f64> {
    /// ½ m v² (J)
    pub fn kinetic(&self) -> f64 {
        0.5 * self.velocity * self.velocity / self.inverse_mass
    }

    /// How far it has come (m), and how fast it is (m/s).
    pub fn state(&self) -> [f64; 2] {
        [self.displacement, self.velocity]
    }
}
