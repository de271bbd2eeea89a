//! How the grains of a bed are laid out at first.

use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::SeedableRng;
use serde::{Deserialize, Serialize};

use super::{Bed, Disk};
use crate::stats::fraction;

/// Order of the grains.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Packing {
    /// On a square lattice, with random velocities; it settles into disorder.
    Random,
    /// Touching, on a hexagonal lattice.
    Hexagonal,
}

/// What stands at the sides.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Sides {
    /// The bed repeats itself.
    Periodic,
    /// Walls like the bottom.
    Walls,
}

/// What is poured.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pile {
    /// Order of the grains.
    pub packing: Packing,
    /// Width (d).
    pub width: f64,
    /// Height (d) of as many grains on a square lattice of side d: width times height is their number.
    pub height: f64,
    /// r: diameters are uniform in 1 ± r.
    pub spread: f64,
    /// Seed of diameters and first velocities.
    pub seed: u64,
    /// The sides.
    pub sides: Sides,
}

/// Diameter of the disks that walls are made of, and their distance from each other (d).
const WALL: f64 = 0.5;

/// First velocities are uniform in ± this (d/τ_c) along each axis: some times the speed of a fall over a diameter.
const STIR: f64 = 0.2;

impl Pile {
    /// Grains and walls before they settle, with the first velocity of each grain (d/τ_c).
    pub fn lay(&self) -> (Bed, Vec<[f64; 2]>) {
        let mut chance = Xoshiro256PlusPlus::seed_from_u64(self.seed);
        let (grains, width) = match self.packing {
            Packing::Random => (self.square(&mut chance), self.width),
            Packing::Hexagonal => self.hexagonal(),
        };
        let velocities = grains
            .iter()
            .map(|_| match self.packing {
                Packing::Random => [0; 2].map(|_| STIR * (2.0 * fraction(&mut chance) - 1.0)),
                Packing::Hexagonal => [0.0; 2],
            })
            .collect();
        let top = grains.iter().map(|disk| disk.centre[1]).fold(0.0, f64::max) + 12.0;
        let bottom = (0..(width / WALL).round() as usize)
            .map(|k| Disk { centre: [(k as f64 + 0.5) * WALL, -0.5 * WALL], diameter: WALL });
        let mut walls: Vec<Disk> = bottom.collect();
        if self.sides == Sides::Walls {
            for k in 0..(top / WALL) as usize {
                for x in [-0.5 * WALL, width + 0.5 * WALL] {
                    walls.push(Disk { centre: [x, (k as f64 - 0.5) * WALL], diameter: WALL });
                }
            }
        }
        (Bed { grains, walls, width, periodic: self.sides == Sides::Periodic }, velocities)
    }

    fn diameter(&self, chance: &mut Xoshiro256PlusPlus) -> f64 {
        1.0 + self.spread * (2.0 * fraction(chance) - 1.0)
    }

    fn square(&self, chance: &mut Xoshiro256PlusPlus) -> Vec<Disk> {
        let count = (self.width * self.height).round() as usize;
        // So far apart that the widest do not touch.
        let side = 1.01 * (1.0 + self.spread);
        let columns = ((self.width / side).floor() as usize).max(1);
        let apart = self.width / columns as f64;
        (0..count)
            .map(|i| {
                let centre = [(i % columns) as f64 + 0.5, (i / columns) as f64 + 0.5].map(|n| n * apart);
                Disk { centre, diameter: self.diameter(chance) }
            })
            .collect()
    }

    /// Touching disks of diameter 1, rows along the bottom; a periodic width is rounded to whole columns.
    fn hexagonal(&self) -> (Vec<Disk>, f64) {
        let columns = (self.width.round() as usize).max(1);
        let rows = (self.height.round() as usize).max(1);
        let walled = self.sides == Sides::Walls;
        let mut grains = Vec::new();
        for row in 0..rows {
            let shift = if row % 2 == 1 { 0.5 } else { 0.0 };
            // Between walls every second row has one less.
            let here = if walled && row % 2 == 1 { columns - 1 } else { columns };
            for column in 0..here {
                let centre = [column as f64 + 0.5 + shift, 0.5 + row as f64 * 0.75_f64.sqrt()];
                grains.push(Disk { centre, diameter: 1.0 });
            }
        }
        (grains, columns as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_laid_out_does_not_touch() {
        for (packing, sides) in
            [(Packing::Random, Sides::Periodic), (Packing::Random, Sides::Walls), (Packing::Hexagonal, Sides::Walls)]
        {
            let pile = Pile { packing, width: 20.0, height: 10.0, spread: 0.3, seed: 3, sides };
            let (bed, velocities) = pile.lay();
            assert_eq!(velocities.len(), bed.grains.len());
            let all: Vec<Disk> = bed.grains.iter().chain(&bed.walls).copied().collect();
            for (i, a) in bed.grains.iter().enumerate() {
                for b in &all[i + 1..] {
                    let mut dx = a.centre[0] - b.centre[0];
                    if bed.periodic {
                        dx -= bed.width * (dx / bed.width).round();
                    }
                    let apart = dx.hypot(a.centre[1] - b.centre[1]);
                    assert!(apart > 0.5 * (a.diameter + b.diameter) - 1e-9, "{a:?} {b:?}");
                }
            }
        }
    }

    #[test]
    fn diameters_are_uniform_and_follow_from_the_seed() {
        let pile = |seed| Pile {
            packing: Packing::Random,
            width: 100.0,
            height: 60.0,
            spread: 0.2,
            seed,
            sides: Sides::Periodic,
        };
        let grains = pile(1).lay().0.grains;
        assert_eq!(grains.len(), 6000);
        assert_eq!(grains, pile(1).lay().0.grains);
        assert_ne!(grains, pile(2).lay().0.grains);
        let mean = grains.iter().map(|g| g.diameter).sum::<f64>() / 6000.0;
        let variance = grains.iter().map(|g| (g.diameter - 1.0).powi(2)).sum::<f64>() / 6000.0;
        // Mean 1, variance r²/3; three standard errors of each: 3 r/√(3·6000) and 3 (2r²/√45)/√6000.
        assert!((mean - 1.0).abs() < 3.0 * 0.2 / 18000.0_f64.sqrt(), "{mean}");
        assert!((variance - 0.04 / 3.0).abs() < 3.0 * 0.08 / 45.0_f64.sqrt() / 6000.0_f64.sqrt(), "{variance}");
    }
}
