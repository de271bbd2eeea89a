//! The speed of a random mixture.

use std::f64::consts::PI;

use super::Dimension;
use crate::contact::{Constants, Pair};
use crate::material::Material;

/// Wave speed (m/s) of spheres of `diameter` (m) whose materials are drawn at random, each with its fraction.
///
///   V = A √(3 K/(π R ρ)),   1/K = Σ pᵢ pⱼ / Kᵢⱼ,   ρ = Σ pᵢ ρᵢ
///
/// Long waves see the mean mass and, in a chain, where all contacts carry the same force, the mean compliance: there this is
/// exact. In sheets and close packings softer contacts can be bypassed and it is an estimate from below. Of one material it
/// is [`bound`](super::bound). Fractions sum to 1.
pub fn mixture_speed(dimension: Dimension, parts: &[(&Material, f64)], diameter: f64, constants: Constants) -> f64 {
    let radius = 0.5 * diameter;
    let mut compliance = 0.0;
    for (a, p) in parts {
        for (b, q) in parts {
            compliance += p * q / Pair::new([a, b], [radius; 2], constants).plastic_stiffness();
        }
    }
    let density: f64 = parts.iter().map(|(material, part)| part * material.density).sum();
    dimension.factor() * (3.0 / (compliance * PI * radius * density)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::find;
    use crate::wave::bound;

    /// The ends are the uniform crystals. In between: a chain of N random springs and masses in series has stiffness
    /// N/Σ(1/K) and mass Σ m, and its long waves the speed D √(stiffness × N/mass); of 40 000 random spheres within 1 %.
    #[test]
    fn a_mixture_is_a_chain_of_its_mean_compliance_and_mass() {
        let [steel, brass] = ["440c", "brass"].map(|name| find(name, &[]).unwrap());
        let speed = |part: f64| {
            mixture_speed(Dimension::One, &[(&steel, 1.0 - part), (&brass, part)], 6.35e-3, Constants::Code)
        };
        for (part, pure) in [(0.0, &steel), (1.0, &brass)] {
            let expected = bound(Dimension::One, [pure; 2], 6.35e-3, Constants::Code).speed;
            assert!((speed(part) / expected - 1.0).abs() < 1e-12);
        }
        let coins = crate::layout::random_choice(7, 40_000);
        let of = |k: usize| if coins[k] == 1 { &brass } else { &steel };
        let (mut compliance, mut mass) = (0.0, 0.0);
        for k in 1..coins.len() {
            let pair = Pair::new([of(k - 1), of(k)], [3.175e-3; 2], Constants::Code);
            compliance += 1.0 / pair.plastic_stiffness();
            mass += of(k).sphere_mass(6.35e-3);
        }
        let chain = 6.35e-3 * (coins.len() - 1) as f64 / (compliance * mass).sqrt();
        assert!((chain / speed(0.5) - 1.0).abs() < 0.01, "{chain} {}", speed(0.5));
    }
}
