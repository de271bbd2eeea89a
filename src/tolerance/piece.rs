//! One piece as a workshop made it: from the values of quantities and a seed to what is simulated.

use super::Tolerances;
use super::quantity::{Kind, Quantity};
use crate::dem::{ForcePulse, Projectile, Strike};
use crate::evaluate::{Drawing, ImpactLoad, Imperfection, LoadCase};
use crate::material::Material;
use crate::search::Rng;

/// A piece: what its quantities are, in their order, and where its chance comes from.
#[derive(Clone, Debug, PartialEq)]
pub struct Piece {
    /// A value for each quantity.
    pub values: Vec<f64>,
    /// Its random numbers.
    pub seed: u64,
}

/// A generator for one purpose of one piece: purposes have nothing in common, and none depends on which others there are.
fn rng(seed: u64, purpose: u64) -> Rng {
    let mut first = Rng::new(seed ^ purpose.wrapping_mul(0x9e37_79b9_7f4a_7c15));
    Rng::new(first.bits())
}

/// The greatest of the diameters on all places (m), by which sites are as far apart as they are; images of sites that are their own image do not count.
pub(super) fn largest(drawing: Drawing<'_>, diameters: &[f64]) -> f64 {
    let stand = diameters.iter().enumerate().filter(|&(place, _)| drawing.stands(place));
    stand.map(|(_, &diameter)| diameter).fold(0.0, f64::max)
}

impl Piece {
    /// As drawn.
    pub fn nominal(quantities: &[Quantity]) -> Self {
        Self { values: quantities.iter().map(|quantity| quantity.nominal).collect(), seed: 0 }
    }

    /// The k-th piece of a workshop: it depends on the seed and on k alone, so that more pieces can be made later.
    pub fn made(quantities: &[Quantity], seed: u64, k: u64) -> Self {
        let seed = Rng::new(seed.wrapping_add(k.wrapping_mul(0xd1b5_4a32_d192_ed03))).bits();
        let value = |quantity: &Quantity| {
            let [low, high] = quantity.limits;
            match quantity.kind.is_random() {
                true => high,
                false => low + (high - low) * rng(seed, quantity.kind.stream()).unit(),
            }
        };
        Self { values: quantities.iter().map(value).collect(), seed }
    }

    /// With one quantity at a value, all others as drawn.
    pub fn with(quantities: &[Quantity], which: usize, value: f64, seed: u64) -> Self {
        let mut piece = Self { seed, ..Self::nominal(quantities) };
        piece.values[which] = value;
        piece
    }

    fn value(&self, quantities: &[Quantity], kind: Kind) -> Option<f64> {
        quantities.iter().zip(&self.values).find(|(quantity, _)| quantity.kind == kind).map(|(_, value)| *value)
    }

    /// Which places, sites or sites and images, hold a sphere of another material, and by how many letters it is another; `alphabet` are
    /// those of the layout.
    fn wrong(&self, quantities: &[Quantity], places: usize, alphabet: usize) -> Vec<(usize, u8)> {
        let chance = self.value(quantities, Kind::Wrong).unwrap_or(0.0);
        let mut rng = rng(self.seed, Kind::Wrong.stream());
        let others = alphabet.saturating_sub(1) as u64;
        // Two numbers for every place, so that a greater chance only adds.
        let drawn = (0..places).map(|place| (place, rng.unit(), 1 + rng.below(others.max(1)) as u8));
        drawn.filter(|&(_, u, _)| others > 0 && u < chance).map(|(place, _, shift)| (place, shift)).collect()
    }

    /// Diameter of the sphere on every place (m), zero where there is none.
    pub fn diameters(&self, tolerances: &Tolerances, quantities: &[Quantity], drawing: Drawing<'_>) -> Vec<f64> {
        let built = self.materials_on_places(tolerances, quantities, drawing);
        let (mut lot, mut holes) = (rng(self.seed, Kind::Lot.stream()), rng(self.seed, Kind::Vacancies.stream()));
        let variation = self.value(quantities, Kind::Lot).unwrap_or(0.0);
        let vacant = self.value(quantities, Kind::Vacancies).unwrap_or(0.0);
        let offset: Vec<f64> =
            (0..drawing.palette().len()).map(|m| self.value(quantities, Kind::Offset(m)).unwrap_or(0.0)).collect();
        let diameter = drawing.design().diameter();
        let of = |&letter: &u8| {
            let (u, v) = (lot.unit(), holes.unit());
            if v < vacant { 0.0 } else { diameter + offset[usize::from(letter)] + variation * (u - 0.5) }
        };
        built.iter().map(of).collect()
    }

    /// What is built otherwise than drawn, but for diameters.
    fn misplaced(&self, tolerances: &Tolerances, quantities: &[Quantity], drawing: Drawing<'_>) -> Imperfection {
        let alphabet = drawing.letters();
        let wrong = self.wrong(quantities, tolerances.places(drawing.sites()), alphabet.len());
        let materials = self.materials(quantities, drawing.palette());
        Imperfection { alphabet, wrong, materials, ..Imperfection::default() }
    }

    fn materials_on_places(&self, tolerances: &Tolerances, quantities: &[Quantity], drawing: Drawing<'_>) -> Vec<u8> {
        let mut drawn = drawing.materials();
        // Of all places first: what is wrong on one side is so there alone.
        if drawn.len() < tolerances.places(drawing.sites()) {
            drawn.extend_from_within(..);
        }
        self.misplaced(tolerances, quantities, drawing).built(&drawn)
    }

    /// The palette as it turned out; empty where all of it is as drawn.
    fn materials(&self, quantities: &[Quantity], drawn: &[Material]) -> Vec<Material> {
        let mut palette = drawn.to_vec();
        for (quantity, &value) in quantities.iter().zip(&self.values) {
            match quantity.kind {
                Kind::Modulus(m) => palette[m].youngs_modulus *= 1.0 + value,
                Kind::Density(m) => palette[m].density *= 1.0 + value,
                Kind::YieldStress(m) => palette[m].yield_stress *= 1.0 + value,
                Kind::RateConstant(m) => palette[m].rate_constant *= 1.0 + value,
                _ => {}
            }
        }
        if palette == drawn { Vec::new() } else { palette }
    }

    /// What strikes it.
    pub fn load(&self, drawing: Drawing<'_>, quantities: &[Quantity], factor: f64) -> ImpactLoad {
        let value = |kind| self.value(quantities, kind).unwrap_or(0.0);
        let impact = drawing.design().impact();
        let strength = factor * (1.0 + value(Kind::Force)) * impact.strength();
        let strike = match impact.with_strength(strength) {
            Strike::Pulse(ForcePulse { force, duration }) => {
                Strike::Pulse(ForcePulse { force, duration: duration * (1.0 + value(Kind::Duration)) })
            }
            flat => flat,
        };
        let off = value(Kind::OffCentre);
        let place = match drawing {
            Drawing::Plane(design, _) if off != 0.0 => {
                let half = design.lattice.half_width();
                Some([(off - half).max(-half), (off + half).min(half)])
            }
            _ => None,
        };
        ImpactLoad {
            strike,
            angle: value(Kind::Angle),
            place,
            law: None,
            friction: self.value(quantities, Kind::Friction),
        }
    }

    /// The projectile that strikes it in place of the pulse, if one does: parts of the force are parts of its speed.
    pub fn projectile(&self, tolerances: &Tolerances, quantities: &[Quantity], factor: f64) -> Option<Projectile> {
        let value = |kind| self.value(quantities, kind).unwrap_or(0.0);
        let projectile = tolerances.impact.projectile.filter(|_| value(Kind::Projectile) >= 0.5)?;
        Some(Projectile { speed: projectile.speed * factor * (1.0 + value(Kind::Force)), ..projectile })
    }

    /// Diameters (m), zero where there is none, and materials of the spheres on all places, and the palette as it turned out.
    pub fn parts(
        &self,
        tolerances: &Tolerances,
        quantities: &[Quantity],
        drawing: Drawing<'_>,
    ) -> (Vec<f64>, Vec<u8>, Vec<Material>) {
        let palette = self.materials(quantities, drawing.palette());
        (
            self.diameters(tolerances, quantities, drawing),
            self.materials_on_places(tolerances, quantities, drawing),
            if palette.is_empty() { drawing.palette().to_vec() } else { palette },
        )
    }

    /// As it is simulated on the nominal sites, struck with a part of the design's force. Sites are as far apart as the largest of its spheres needs.
    pub fn case(
        &self,
        tolerances: &Tolerances,
        quantities: &[Quantity],
        drawing: Drawing<'_>,
        factor: f64,
    ) -> LoadCase {
        let diameters = self.diameters(tolerances, quantities, drawing);
        self.case_of(tolerances, quantities, drawing, factor, &diameters)
    }

    /// The same with other diameters on its places (m).
    pub fn case_of(
        &self,
        tolerances: &Tolerances,
        quantities: &[Quantity],
        drawing: Drawing<'_>,
        factor: f64,
        diameters: &[f64],
    ) -> LoadCase {
        let mut imperfection = self.misplaced(tolerances, quantities, drawing);
        let largest = largest(drawing, diameters);
        if diameters.iter().any(|&diameter| diameter != largest) {
            // That of a place where nothing stands is none's.
            imperfection.radii = diameters.iter().map(|diameter| (diameter / largest).min(1.0)).collect();
        } else if diameters.len() > drawing.sites() && !imperfection.wrong.is_empty() {
            // Says that the other side is not alike.
            imperfection.radii = vec![1.0; diameters.len()];
        }
        let mut load = self.load(drawing, quantities, factor);
        // In space it is a mirror in the lanes that moves.
        if let Some(thrown) = self.projectile(tolerances, quantities, factor).filter(|_| drawing.is_in_space()) {
            load.strike = Strike::Projectile(thrown);
        }
        LoadCase { load, imperfection, halves_differ: drawing.halves_differ() }
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::design::Design;
    use crate::evaluate::Subject;
    use crate::layout::Layout;
    use crate::tolerance::quantities;

    /// What is wrong on one side is so there alone, and no image of a sphere on the axis says how far apart sites are.
    #[test]
    fn a_piece_is_wrong_where_it_is_wrong() {
        let design = Design::read(Path::new("designs/quickstart.toml")).unwrap();
        let palette = ["440c", "brass"].map(|name| crate::material::find(name, &[]).unwrap()).to_vec();
        let layout = Layout::new(design.lattice.clone(), palette, |site| (site.row % 2) as u8);
        let drawing = Drawing::from((&design, Subject::from(&layout)));
        let tolerances = Tolerances { wrong: 0.002, halves_alike: false, lot: 5e-6, ..Tolerances::drawn() };
        let quantities = quantities(&tolerances, drawing, 0.0);
        let sites = drawing.sites();
        let drawn = layout.materials.repeat(2);
        let (mut right_alone, mut of_none) = (0, 0);
        for k in 0..100 {
            let piece = Piece::made(&quantities, 1, k);
            let (diameters, built, _) = piece.parts(&tolerances, &quantities, drawing);
            let wrong: Vec<usize> =
                piece.wrong(&quantities, 2 * sites, 2).into_iter().map(|(place, _)| place).collect();
            let off: Vec<usize> = (0..2 * sites).filter(|&place| built[place] != drawn[place]).collect();
            assert_eq!(off, wrong, "piece {k}");
            right_alone += usize::from(!wrong.is_empty() && wrong.iter().all(|&place| place < sites));
            let greatest = (0..2 * sites).max_by(|&a, &b| diameters[a].total_cmp(&diameters[b])).unwrap();
            if greatest >= sites && layout.lattice.sites()[greatest - sites].x == 0.0 {
                of_none += 1;
                assert!(largest(drawing, &diameters) < diameters[greatest]);
            } else {
                assert_eq!(largest(drawing, &diameters), diameters[greatest]);
            }
        }
        assert!(right_alone > 0 && of_none > 0, "{right_alone} {of_none}");
    }
}
