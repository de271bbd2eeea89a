//! What can be measured of a layout: scores of its simulations, and what the layout itself says.

use serde::{Deserialize, Serialize};

use super::Entry;
use super::entry::Scored;
use crate::lattice::HexagonalSheet;
use crate::material::Material;

/// What can be measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// C = F/P
    Contrast,
    /// G = F/F(all host)
    FocalGain,
    /// Q = P/P(all lens material)
    Protection,
    /// How evenly several focal regions are served: of their means over their shares the least over the greatest
    Balance,
    /// P over the least P of all baselines
    AgainstBest,
    /// F (J)
    FocalEnergy,
    /// P (J)
    ProtectedEnergy,
    /// Mean over the focal region of each sphere's greatest momentum (kg m/s)
    FocalMomentum,
    /// The same over the protected region (kg m/s)
    ProtectedMomentum,
    /// Greatest force at one contact of the focal region (N)
    FocalForce,
    /// Greatest force at one contact of the protected region (N)
    ProtectedForce,
    /// When the wave arrives in the focal region (s)
    FocalArrival,
    /// When it arrives in the protected region (s)
    ProtectedArrival,
    /// Greatest momentum of the last row along the axis (kg m/s)
    FarMomentum,
    /// Greatest total contact force on the last row along the axis (N)
    FarForce,
    /// The part of the work of the load that contacts dissipate
    Dissipation,
    /// Mass of the simulated half (kg)
    Mass,
    /// Price of all spheres of the simulated half, those on its mirror lines counting as halves
    Cost,
    /// Spheres that are not of the host
    Spheres,
    /// Spheres in the free rows that touch no other of their material
    Lone,
    /// Groups of touching spheres of one material other than the host
    Islands,
}

impl Measure {
    /// Names as they are written in files.
    pub const NAMES: [(&str, Self); 21] = [
        ("contrast", Self::Contrast),
        ("focal-gain", Self::FocalGain),
        ("protection", Self::Protection),
        ("balance", Self::Balance),
        ("protection-best", Self::AgainstBest),
        ("focal-energy", Self::FocalEnergy),
        ("protected-energy", Self::ProtectedEnergy),
        ("focal-momentum", Self::FocalMomentum),
        ("protected-momentum", Self::ProtectedMomentum),
        ("focal-force", Self::FocalForce),
        ("protected-force", Self::ProtectedForce),
        ("focal-arrival", Self::FocalArrival),
        ("protected-arrival", Self::ProtectedArrival),
        ("far-momentum", Self::FarMomentum),
        ("far-force", Self::FarForce),
        ("dissipation", Self::Dissipation),
        ("mass", Self::Mass),
        ("cost", Self::Cost),
        ("spheres", Self::Spheres),
        ("lone", Self::Lone),
        ("islands", Self::Islands),
    ];

    /// The name as it is written in files.
    pub fn name(self) -> &'static str {
        Self::NAMES.iter().find(|(_, measure)| *measure == self).map_or("", |(name, _)| name)
    }

    /// Whether it needs a run with full records.
    pub fn is_felt(self) -> bool {
        matches!(
            self,
            Self::FocalMomentum
                | Self::ProtectedMomentum
                | Self::FocalForce
                | Self::ProtectedForce
                | Self::FocalArrival
                | Self::ProtectedArrival
                | Self::FarMomentum
                | Self::FarForce
                | Self::Dissipation
        )
    }

    /// Whether it is a number of things, which may be zero.
    pub fn is_count(self) -> bool {
        matches!(self, Self::Spheres | Self::Lone | Self::Islands)
    }
}

/// How the scores under several impacts become one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Over {
    /// The impact under which a score is worst for what is asked of it, for each score by itself.
    #[default]
    Worst,
    /// The mean of all impacts.
    Mean,
}

/// Which of several values counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The least.
    Least,
    /// The greatest.
    Most,
}

/// What a layout itself says, without a simulation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Fabric {
    /// Mass of the simulated half, spheres on its mirror lines counting as halves (kg)
    #[serde(rename = "mass_kg")]
    pub mass: f64,
    /// Price of the same spheres; 0 where neither study nor design has prices.
    #[serde(default)]
    pub cost: f64,
    /// Spheres that are not of the host.
    pub spheres: u64,
    /// Spheres in the free rows that touch no other of their material.
    pub lone: u64,
    /// Groups of touching spheres of one material other than the host.
    pub islands: u64,
}

/// Who touches whom, and what weighs what: from a layout's letters to its [`Fabric`].
#[derive(Clone, Debug)]
pub struct Loom {
    /// Neighbours of every site.
    beside: Vec<Vec<usize>>,
    /// Sites that touch their own image in a mirror line, and so are never alone.
    mirrored: Vec<bool>,
    /// Share of each sphere that lies in the simulated half.
    weight: Vec<f64>,
    free: Vec<bool>,
    /// Mass of a sphere of each material of the palette (kg).
    mass: Vec<f64>,
    /// Price of one.
    price: Vec<f64>,
}

impl Loom {
    /// For layouts on a lattice whose `free` sites may change. The first of the palette is the host; `prices` are those of a
    /// sphere of each of the palette.
    pub fn new(lattice: &HexagonalSheet, free: &[usize], palette: &[Material], prices: &[f64]) -> Self {
        let (sites, diameter, far) = (lattice.sites(), lattice.diameter(), lattice.half_width());
        let mut beside = vec![Vec::new(); sites.len()];
        for (i, a) in sites.iter().enumerate() {
            // Sites stand row by row; a neighbour is at most one row away.
            for (j, b) in sites.iter().enumerate().skip(i + 1).take_while(|(_, b)| b.row <= a.row + 1) {
                if (a.x - b.x).hypot(a.z - b.z) < 1.1 * diameter {
                    beside[i].push(j);
                    beside[j].push(i);
                }
            }
        }
        // From a mirror line: on it, or half a diameter away and so touching the own image.
        let gap = |x: f64| x.min(far - x) / diameter;
        let mirrored = sites.iter().map(|site| (0.25..0.75).contains(&gap(site.x))).collect();
        let weight = sites.iter().map(|site| if gap(site.x) < 0.25 { 0.5 } else { 1.0 }).collect();
        let mut is_free = vec![false; sites.len()];
        free.iter().for_each(|&i| is_free[i] = true);
        let mass = palette.iter().map(|material| material.sphere_mass(diameter)).collect();
        Self { beside, mirrored, weight, free: is_free, mass, price: prices.to_vec() }
    }

    /// Of a layout, an index into the palette for every site.
    pub fn fabric(&self, materials: &[u8]) -> Fabric {
        let alike = |i: usize| self.beside[i].iter().copied().filter(move |&j| materials[j] == materials[i]);
        let lone = |i: &usize| self.free[*i] && !self.mirrored[*i] && alike(*i).next().is_none();
        let mut seen = vec![false; materials.len()];
        let mut islands = 0;
        for begin in 0..materials.len() {
            if materials[begin] == 0 || seen[begin] {
                continue;
            }
            islands += 1;
            let mut edge = vec![begin];
            seen[begin] = true;
            while let Some(i) = edge.pop() {
                for j in alike(i) {
                    if !seen[j] {
                        seen[j] = true;
                        edge.push(j);
                    }
                }
            }
        }
        let weighed =
            |each: &[f64]| materials.iter().zip(&self.weight).map(|(&m, weight)| weight * each[usize::from(m)]).sum();
        Fabric {
            mass: weighed(&self.mass),
            cost: weighed(&self.price),
            spheres: materials.iter().filter(|&&m| m != 0).count() as u64,
            lone: (0..materials.len()).filter(lone).count() as u64,
            islands,
        }
    }
}

/// A measure of one layout over all impacts: the value that counts, where every impact gives one.
pub fn value(measure: Measure, entry: &Entry, fabric: &Fabric, over: Over, side: Side) -> Option<f64> {
    let score: fn(&Scored) -> Option<f64> = match measure {
        Measure::Contrast => |scored| scored.contrast,
        Measure::FocalGain => |scored| scored.focal_gain,
        Measure::Protection => |scored| scored.protection,
        Measure::Balance => |scored| scored.balance,
        Measure::AgainstBest => |scored| scored.against_best,
        Measure::FocalEnergy => |scored| Some(scored.focal_mean),
        Measure::ProtectedEnergy => |scored| Some(scored.protected_mean),
        Measure::FocalMomentum => |scored| Some(scored.felt?.momentum[0]),
        Measure::ProtectedMomentum => |scored| Some(scored.felt?.momentum[1]),
        Measure::FocalForce => |scored| Some(scored.felt?.force[0]),
        Measure::ProtectedForce => |scored| Some(scored.felt?.force[1]),
        Measure::FocalArrival => |scored| scored.felt?.arrival[0],
        Measure::ProtectedArrival => |scored| scored.felt?.arrival[1],
        Measure::FarMomentum => |scored| Some(scored.felt?.far_momentum),
        Measure::FarForce => |scored| Some(scored.felt?.far_force),
        Measure::Dissipation => |scored| Some(scored.felt?.dissipation),
        Measure::Mass => return Some(fabric.mass),
        Measure::Cost => return Some(fabric.cost),
        Measure::Spheres => return Some(fabric.spheres as f64),
        Measure::Lone => return Some(fabric.lone as f64),
        Measure::Islands => return Some(fabric.islands as f64),
    };
    let values: Vec<f64> = entry.impacts.iter().map(score).collect::<Option<_>>()?;
    match (over, side) {
        (Over::Mean, _) => (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64),
        (Over::Worst, Side::Least) => values.into_iter().reduce(f64::min),
        (Over::Worst, Side::Most) => values.into_iter().reduce(f64::max),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material;

    /// Eight rows of four; by hand.
    #[test]
    fn lone_spheres_and_islands_are_counted_as_drawn() {
        let lattice = HexagonalSheet::new(6.35e-3, 8, 3.5).unwrap();
        let palette = ["440c", "brass"].map(|name| material::find(name, &[]).unwrap());
        let at = |row, column| lattice.index(row, column).unwrap();
        let free: Vec<usize> = (at(3, 1)..=at(6, 4)).collect();
        let loom = Loom::new(&lattice, &free, &palette, &[0.5, 2.0]);
        let mut layout = vec![0; lattice.len()];
        assert_eq!(loom.fabric(&layout).islands, 0);
        // One in the midst, one that touches its image in the axis, two that touch across rows.
        layout[at(4, 3)] = 1;
        layout[at(6, 1)] = 1;
        let fabric = loom.fabric(&layout);
        assert_eq!((fabric.spheres, fabric.lone, fabric.islands), (2, 1, 2));
        layout[at(5, 3)] = 1;
        let fabric = loom.fabric(&layout);
        assert_eq!((fabric.spheres, fabric.lone, fabric.islands), (3, 0, 2));
        // Half the crystal: 4 rows with a sphere on the axis, 4 with one on the far line.
        let all = loom.fabric(&vec![0; lattice.len()]);
        let half = (lattice.len() as f64 - 4.0) * palette[0].sphere_mass(6.35e-3);
        assert!((all.mass / half - 1.0).abs() < 1e-12);
        assert_eq!(all.cost, 0.5 * (lattice.len() as f64 - 4.0));
        assert_eq!(fabric.cost, all.cost + 1.5 * 2.0 + 0.75 * 0.0 + 1.5);
    }
}
