//! A contact law of one's own: a linear spring that loses a part of its energy, here in a collision of two spheres.
//!
//!     cargo run --release --example own_law

use granulens::contact::{ForceLaw, History, NormalLaw, collide};
use granulens::real::Number;

/// F = k δ on the way in, e² k δ on the way out, so that e is the restitution.
struct Lossy<V = f64> {
    stiffness: V,
    restitution: V,
}

impl<V: Number> ForceLaw<V> for Lossy<V> {
    fn force(&self, overlap: V, closing_speed: V, _: &History<V>) -> V {
        let zero = V::splat(0.0);
        let out = self.restitution * self.restitution;
        let part = V::select(zero.lt(closing_speed), V::splat(1.0), out);
        (self.stiffness * part * overlap).max(zero)
    }
}

impl NormalLaw for Lossy {
    fn stored(&self, overlap: f64, _: &History) -> f64 {
        0.5 * self.restitution * self.restitution * self.stiffness * overlap.max(0.0).powi(2)
    }

    fn stiffness_max(&self, _: f64) -> f64 {
        self.stiffness
    }
}

fn main() {
    let law = Lossy { stiffness: 1e6, restitution: 0.8 };
    let (mass, speed) = (0.5e-3, 2.0);
    let found = collide(&law, mass, speed);
    println!(
        "restitution {:.4}, greatest force {:.1} N, {:.1} us",
        found.restitution,
        found.force_max,
        1e6 * found.duration
    );
    // Closed form: F = v sqrt(m k).
    assert!((found.force_max / (speed * (mass * law.stiffness).sqrt()) - 1.0).abs() < 1e-3);
    assert!((found.restitution - law.restitution).abs() < 1e-3);
}
