//! The design of Burgoyne (2016, section 5.3.3), whose published claims can be judged on it and on no other.

use super::Design;
use crate::contact::{Constants, LawKind};
use crate::lens::Family;
use crate::target::Region;

impl Design {
    /// Whether crystal, impact, regions, law and lens are the published ones.
    pub fn is_published(&self) -> bool {
        const DIAMETER: f64 = 6.35e-3;
        let near = |a: f64, b: f64| (a - b).abs() <= 1e-6 * b.abs();
        let is_region = |region: &Region, x: [f64; 2]| {
            region.rows == [30, 34] && (0..2).all(|k| (region.x[k] - x[k] * DIAMETER).abs() < 1e-6 * DIAMETER)
        };
        let Self { lattice, impact, target, .. } = self;
        let crystal = near(lattice.diameter(), DIAMETER)
            && lattice.rows() == 50
            && near(lattice.half_width(), 16.5 * DIAMETER)
            && self.host.name == "stainless-440c";
        let struck = impact.pulse().is_some_and(|pulse| near(pulse.force, 26e3) && near(pulse.duration, 20e-6));
        let law = self.law == LawKind::Thesis && self.constants == Constants::default() && self.friction.is_none();
        let aimed = matches!(&target.foci[..], [one] if is_region(&one.region, [0.0, 2.5]))
            && is_region(&target.protect, [12.0, 16.5]);
        let radius = 16.5 * DIAMETER / 60.0_f64.to_radians().sin();
        let lens = self.lens.as_ref().is_some_and(|lens| {
            lens.family == Family::PlanoConvex
                && lens.material.name == "brass-260"
                && (lens.apex_row, lens.back_row) == (Some(5), Some(16))
                && lens.radius.is_some_and(|given| near(given, radius))
        });
        crystal && struck && law && aimed && lens && self.own_materials.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_published_design_is_known_from_others() {
        let read = |name: &str| Design::read(format!("{}/designs/{name}", env!("CARGO_MANIFEST_DIR"))).unwrap();
        assert!(read("thesis-lens.toml").is_published());
        assert!(!read("quickstart.toml").is_published());
        let mut other = read("thesis-lens.toml");
        other.impact = other.impact.with_strength(12e3);
        assert!(!other.is_published());
    }
}
