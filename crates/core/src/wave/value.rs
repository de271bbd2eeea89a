//! What a design surface shows over its variables.

use super::Axis;
use crate::contact::{ElastoPlastic, ForceLaw, History, NormalLaw, Pair};

/// A value over design variables.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Value {
    /// V (m/s): the bound or, at an amplitude, the speed to be expected.
    #[default]
    Speed,
    /// V over that of the medium that is compared with.
    SpeedRatio,
    /// arcsin(V_slow/V_fast) (rad) against the medium that is compared with: 90 degrees where the two are equally fast.
    CriticalAngle,
    /// Z = ρ V over that of the medium that is compared with; 1 reflects nothing at normal incidence, to first order.
    ImpedanceRatio,
    /// F_p (N) at rest.
    PlasticForce,
    /// What one contact dissipates that is loaded once to the amplitude and unloaded, at rest (J).
    Dissipation,
}

/// The amplitude (F_p) at which dissipation is meant where none is given: that of the published lens.
pub const DISSIPATED_AT: f64 = 5.0;

impl Value {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::Speed,
        Self::SpeedRatio,
        Self::CriticalAngle,
        Self::ImpedanceRatio,
        Self::PlasticForce,
        Self::Dissipation,
    ];

    /// The name used on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Speed => "speed",
            Self::SpeedRatio => "speed-ratio",
            Self::CriticalAngle => "critical-angle",
            Self::ImpedanceRatio => "impedance-ratio",
            Self::PlasticForce => "plastic-force",
            Self::Dissipation => "dissipation",
        }
    }

    /// The name used in tables, with its unit in SI.
    pub fn column(self) -> &'static str {
        match self {
            Self::Speed => "speed_m_s",
            Self::SpeedRatio => "speed_ratio",
            Self::CriticalAngle => "critical_angle_rad",
            Self::ImpedanceRatio => "impedance_ratio",
            Self::PlasticForce => "fully_plastic_force_N",
            Self::Dissipation => "dissipation_J",
        }
    }

    /// What it is shown over where nothing else is asked for: the thesis's axes where they matter.
    pub fn axes(self) -> [Axis; 2] {
        match self {
            Self::PlasticForce | Self::Dissipation => [Axis::YieldStress, Axis::Modulus],
            _ => [Axis::Stiffness, Axis::Density],
        }
    }

    /// Whether a variable has any influence on it. What is compared is compared in one packing, which cancels; a stiffness alone
    /// fixes neither F_p nor what is dissipated.
    pub fn depends_on(self, axis: Axis) -> bool {
        match self {
            Self::Speed => axis != Axis::Radius,
            Self::SpeedRatio | Self::CriticalAngle | Self::ImpedanceRatio => {
                !matches!(axis, Axis::Radius | Axis::Dimension)
            }
            Self::PlasticForce => matches!(axis, Axis::YieldStress | Axis::Modulus | Axis::Radius),
            Self::Dissipation => matches!(axis, Axis::YieldStress | Axis::Modulus | Axis::Radius | Axis::Amplitude),
        }
    }
}

/// Energy (J) that a contact takes up when it is loaded at rest to `amplitude` F_p, less what it gives back when it opens.
///
/// The loading is integrated over the contact's own curve (Burgoyne 2016, eqs 3.1 to 3.9, s = 1); what is given back is that of
/// its law of unloading.
pub fn dissipation(pair: &Pair, amplitude: f64) -> f64 {
    let law = ElastoPlastic::new(pair, false);
    let regions = pair.regions(1.0);
    let force = |overlap: f64| law.force(overlap, 1e-9, &History::new());
    // To the force wanted: on the straight line of region III, below it by halving.
    let wanted = amplitude * regions.plastic_force;
    let end = if amplitude >= 1.0 {
        regions.plastic_overlap + (wanted - regions.plastic_force) / pair.plastic_stiffness()
    } else {
        let (mut low, mut high) = (0.0, regions.plastic_overlap);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            *(if force(middle) < wanted { &mut low } else { &mut high }) = middle;
        }
        low
    };
    let ends = [0.0, regions.yield_overlap.min(end), regions.plastic_overlap.min(end), end];
    let work: f64 = ends.windows(2).map(|piece| simpson(&force, [piece[0], piece[1]])).sum();
    work - law.stored(end, &History::new().advanced(end, wanted))
}

/// Simpson's rule in 32 parts: on the smooth pieces of a curve, of the fourth order.
fn simpson(curve: &impl Fn(f64) -> f64, [from, to]: [f64; 2]) -> f64 {
    const PARTS: u32 = 32;
    let step = (to - from) / f64::from(PARTS);
    let weight = |k: u32| match k {
        0 | PARTS => 1.0,
        odd if odd % 2 == 1 => 4.0,
        _ => 2.0,
    };
    (0..=PARTS).map(|k| weight(k) * curve(from + step * f64::from(k))).sum::<f64>() * step / 3.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::Constants;
    use crate::material::find;

    /// Far above F_p the curve is the line p₀ π (2 r* δ + c₂) and next to nothing is given back: a/2 (1 + …) of F_p δ_p. By hand: the
    /// line from δ_p, region II by its antiderivative, region I as (2/5) F_y δ_y, and unloading as (2/5) F (δ − δ_r) of a Hertzian
    /// contact of the radius R_p (physics of appendix A.2.1). Simpson's rule leaves 1e-6 of the logarithm in region II.
    #[test]
    fn dissipation_is_the_area_between_the_curves() {
        let steel = find("440c", &[]).unwrap();
        let pair = Pair::new([&steel; 2], [3.175e-3; 2], Constants::Code);
        let r = pair.regions(1.0);
        for amplitude in [1.0, 2.0, 5.0, 17.0] {
            let force = amplitude * r.plastic_force;
            let end = r.plastic_overlap + (force - r.plastic_force) / pair.plastic_stiffness();
            let slope = (r.plastic_force / r.plastic_overlap - r.yield_force / r.yield_overlap)
                / (r.plastic_overlap / r.yield_overlap).ln();
            let alpha = r.yield_force / r.yield_overlap - slope * r.yield_overlap.ln();
            let second = |d: f64| 0.5 * alpha * d * d + slope * (0.5 * d * d * d.ln() - 0.25 * d * d);
            let loading = 0.4 * r.yield_force * r.yield_overlap + second(r.plastic_overlap) - second(r.yield_overlap)
                + 0.5 * (force + r.plastic_force) * (end - r.plastic_overlap);
            let area = (2.0 * force + r.yield_force) / (2.0 * std::f64::consts::PI * 1.6 * pair.yield_stress);
            let radius = 4.0 * pair.modulus / (3.0 * force) * area.powf(1.5);
            let opening = (3.0 * force / (4.0 * pair.modulus * radius.sqrt())).powf(2.0 / 3.0);
            let exact = loading - 0.4 * force * opening;
            assert!((dissipation(&pair, amplitude) / exact - 1.0).abs() < 1e-5, "{amplitude} {exact}");
        }
    }

    /// Lengths grow as R, forces as R², so energies as R³, and a stronger contact loses more.
    #[test]
    fn dissipation_grows_with_size_and_amplitude() {
        let brass = find("brass", &[]).unwrap();
        let of = |radius: f64, amplitude| dissipation(&Pair::new([&brass; 2], [radius; 2], Constants::Code), amplitude);
        assert!((of(2e-3, 5.0) / of(1e-3, 5.0) - 8.0).abs() < 1e-9);
        let losses: Vec<f64> = [0.5, 1.0, 2.0, 5.0, 10.0].map(|a| of(3e-3, a)).to_vec();
        assert!(losses.windows(2).all(|pair| pair[1] > pair[0]), "{losses:?}");
    }
}
