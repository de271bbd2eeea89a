//! How far a wave falls short of the bound, or exceeds it, by its amplitude.

use std::f64::consts::PI;

use crate::contact::{ElastoPlastic, ForceLaw, History, Pair};

/// Amplitudes, in F_p, for which [`speed_reached`] was fitted. Below the first contacts stay mostly elastic and it says nothing;
/// beyond the last the fitted part is kept.
pub const AMPLITUDES: [f64; 2] = [0.35, 20.0];

/// The same for E*/σ_y; beyond, the fitted part is kept.
const RATIOS: [f64; 2] = [27.5, 220.0];

/// Rate of compression at which contacts of a front work, over the speed of the spheres behind it over their diameter: fitted.
const RATE: f64 = 0.06;

/// ln of what the secant misses: constant, and by ln a, (ln a)² and ln(E*/(82.4 σ_y)), a the amplitude in F_p: fitted.
const MISSED: [f64; 4] = [-0.0357, 0.0048, 0.0026, 0.0066];

/// Greatest deviation of the fit from simulated speeds, those that it was fitted to and others; stated for users.
pub const REACHED_ERROR: f64 = 0.01;

/// Speed over the bound of a steady wave that puts `amplitude` F_p (F_p at rest) on each contact; none below 0.35 F_p.
///
///   V/V_bound = √(F/(δ K)) exp(c₀ + c₁ ln a + c₂ ln² a + c₃ ln(E*/(82.4 σ_y)))
///
/// F/δ is the secant of the contact's curve up to the front's force, as the balance of momentum across a front in a chain
/// has it (ρ U² = stress over strain), at the rate κ v/D, v = F/(m V) D the speed behind the front: so the rate effect, which
/// the bound does not know, is in it, and stiff rate-dependent contacts go above the bound. κ and c are fitted to our own
/// simulations of chains under a lasting force, E/σ_y from 50 to 400, C up to 0.04, 0.35 to 20 F_p (rms 0.3 %, greatest
/// deviation 0.6 %, docs/surfaces.md). Sheets, close packings and dimers follow the same curve to some 1 %. A wave of a short pulse
/// decays: the amplitude is then that of the place.
///
/// `density` is the mean one of the two spheres (kg/m³), whose contact is `pair`.
pub fn speed_reached(pair: &Pair, density: f64, amplitude: f64) -> Option<f64> {
    if !(amplitude >= AMPLITUDES[0] && amplitude.is_finite()) {
        return None;
    }
    let force = amplitude * pair.plastic_force();
    let stiffness = pair.plastic_stiffness();
    let diameter = pair.radii_sum;
    let mass = density * PI / 6.0 * diameter.powi(3);
    // A chain: V² = 3 K/(π R ρ) = K D²/m.
    let bound = diameter * (stiffness / mass).sqrt();
    let closing = RATE * force * diameter / (mass * bound);
    let secant = force / overlap(pair, force, closing);
    let (log, ratio) = (amplitude.min(AMPLITUDES[1]).ln(), pair.modulus / pair.yield_stress);
    let terms = [1.0, log, log * log, (ratio.clamp(RATIOS[0], RATIOS[1]) / 82.4).ln()];
    let missed: f64 = MISSED.iter().zip(terms).map(|(c, term)| c * term).sum();
    Some((secant / stiffness).sqrt() * missed.exp())
}

/// Overlap (m) at which a contact that is loaded for the first time, closing at `speed` (m/s), bears `force` (N).
fn overlap(pair: &Pair, force: f64, speed: f64) -> f64 {
    let law = ElastoPlastic::new(pair, true);
    // Softer than the Hertzian contact, stiffer than the one that yields everywhere at rest.
    let (mut low, mut high) = (0.0, force / pair.plastic_stiffness() + pair.regions(1.0).plastic_overlap);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        *(if law.force(middle, speed, &History::new()) < force { &mut low } else { &mut high }) = middle;
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::Constants;
    use crate::material::{Material, find};

    fn reached(material: &Material, diameter: f64, amplitude: f64) -> Option<f64> {
        let pair = Pair::new([material; 2], [0.5 * diameter; 2], Constants::Code);
        speed_reached(&pair, material.density, amplitude)
    }

    #[test]
    fn an_overlap_bears_its_force() {
        for name in ["440c", "brass"] {
            let material = find(name, &[]).unwrap();
            let pair = Pair::new([&material; 2], [3.175e-3; 2], Constants::Code);
            let law = ElastoPlastic::new(&pair, true);
            for part in [0.01, 0.5, 1.0, 30.0] {
                let force = part * pair.plastic_force();
                let borne = law.force(overlap(&pair, force, 0.4), 0.4, &History::new());
                assert!((borne / force - 1.0).abs() < 1e-12, "{name} {part} {borne}");
            }
        }
    }

    /// Stronger waves are faster, hardening ones too, and size tells through the rate alone; without rate all of it goes to the
    /// bound from below, to the 1 % of the fit.
    #[test]
    fn stronger_waves_are_faster() {
        let (brass, steel) = (find("brass", &[]).unwrap(), find("440c", &[]).unwrap());
        for material in [&brass, &steel] {
            let speeds: Vec<f64> =
                (0..60).filter_map(|k| reached(material, 6.35e-3, AMPLITUDES[0] * 1.1_f64.powi(k))).collect();
            assert!(speeds.len() == 60 && speeds.windows(2).all(|pair| pair[1] > pair[0]));
        }
        assert!((reached(&brass, 6.35e-3, 20.0).unwrap() - 1.0).abs() < 0.01);
        assert!((reached(&brass, 6.35e-3, 2.0).unwrap() / reached(&brass, 0.1, 2.0).unwrap() - 1.0).abs() < 1e-6);
        let soft = Material { rate_constant: 0.0, ..steel.clone() };
        assert!(reached(&steel, 6.35e-3, 5.0) > reached(&soft, 6.35e-3, 5.0));
        assert_eq!(reached(&steel, 6.35e-3, 0.3), None);
        assert_eq!(reached(&steel, 6.35e-3, f64::NAN), None);
    }
}
