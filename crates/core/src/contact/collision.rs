//! A head-on collision of two bodies under a law.

use super::{History, NormalLaw};

/// What a head-on collision comes to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Collision {
    /// Speed of parting over that of closing.
    pub restitution: f64,
    /// Greatest force (N).
    pub force_max: f64,
    /// Greatest overlap (m).
    pub overlap_max: f64,
    /// From the first touch until the force is gone (s).
    pub duration: f64,
}

/// Steps in the time in which the spheres would come as near as they do at their first speed.
const STEPS: f64 = 4000.0;

/// Two bodies of reduced mass m̄ (kg) meet at a speed (m/s): m̄ δ'' = −F(δ, δ'), by velocity Verlet with the predicted velocity in the
/// force, until it has gone. A sphere that meets a flat at v is two spheres that meet at 2 v. Good to some 10⁻⁵ where the law has no jumps.
pub fn collide(law: &impl NormalLaw, reduced_mass: f64, speed: f64) -> Collision {
    let step = depth(law, reduced_mass, speed) / (STEPS * speed);
    let (mut overlap, mut velocity, mut acceleration) = (0.0, speed, 0.0);
    let mut history = History::new();
    let (mut force_max, mut overlap_max, mut time) = (0.0_f64, 0.0_f64, 0.0);
    // What is pressed in for good takes no longer than this to part; it only guards against a law that never lets go.
    for _ in 0..1000 * STEPS as u64 {
        overlap += step * (velocity + 0.5 * step * acceleration);
        let (force, next) = law.respond(overlap, velocity + step * acceleration, &history);
        history = next;
        let new = -force / reduced_mass;
        velocity += 0.5 * step * (acceleration + new);
        acceleration = new;
        time += step;
        (force_max, overlap_max) = (force_max.max(force), overlap_max.max(overlap));
        if velocity <= 0.0 && (overlap <= 0.0 || force <= 0.0 && velocity < 0.0 && law.stored(overlap, &history) <= 0.0)
        {
            break;
        }
    }
    Collision { restitution: -velocity / speed, force_max, overlap_max, duration: time }
}

/// About how near the bodies come: where the work of the contact has used up their energy.
fn depth(law: &impl NormalLaw, reduced_mass: f64, speed: f64) -> f64 {
    let energy = 0.5 * reduced_mass * speed * speed;
    let (mut overlap, mut work, mut last) = (1e-15, 0.0, 0.0);
    while work < energy && overlap < 1.0 {
        let next = 1.02 * overlap;
        let left = (1.0 - work / energy).sqrt() * speed;
        let force = law.force(next, left, &History::new());
        work += 0.5 * (last + force) * (next - overlap);
        (overlap, last) = (next, force);
    }
    overlap
}
