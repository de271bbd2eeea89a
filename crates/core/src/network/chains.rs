//! Force chains, after Peters, Muthuswamy, Wibowo and Tordesillas, *Characterization of force chains in granular material*, PRE 72,
//! 041307 (2005).
//!
//! A grain is in a chain if its load, the greater principal value of its force moment Σ f ⊗ l/2 over its contacts, is above
//! the mean, and the chain goes on along the principal direction: in each of its two senses to the grain it touches whose centre is
//! nearest to it in angle, at most [`ANGLE`] off, that is loaded too and finds it the same way. Peters et al. go from grain to grain
//! and need such an agreement in neither; asking both ways makes chains independent of where one begins. Chains have three grains
//! or more.

use super::fabric::{StressTensor, add, virial};
use super::{Branch, Network};

/// The greatest angle between a principal direction and the way to the next grain (rad): 45 degrees, as Peters et al. take.
pub const ANGLE: f64 = std::f64::consts::FRAC_PI_4;

/// The force chains of a network.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Chains {
    /// Grains of each chain from end to end, the end with the lower number first; longest first. A ring begins with its lowest.
    pub chains: Vec<Vec<u32>>,
    /// Grains whose load is above the mean.
    pub loaded: usize,
}

impl Chains {
    /// Of a network, with the greatest angle (rad); none where places are not known.
    pub fn new(network: &Network, angle: f64) -> Option<Self> {
        let branches = network.branches()?;
        let moments = moments(network, branches);
        let principal: Vec<(f64, [f64; 2])> = moments.iter().map(principal).collect();
        let touching = {
            let mut touching = vec![false; network.grains()];
            network.contacts().iter().flat_map(|c| c.grains).for_each(|i| touching[i as usize] = true);
            touching
        };
        let loads = (0..principal.len()).filter(|&i| touching[i]).map(|i| principal[i].0);
        let mean = super::mean(loads.collect());
        let loaded: Vec<bool> = principal.iter().zip(&touching).map(|((load, _), &on)| on && *load > mean).collect();
        // Of each grain and sense the contact that lies best along the principal direction, by the cosine.
        let mut best: Vec<[Option<(f64, u32)>; 2]> = vec![[None; 2]; principal.len()];
        let least = angle.cos();
        for (contact, branch) in network.contacts().iter().zip(branches) {
            let [a, b] = contact.grains.map(|i| i as usize);
            if !(loaded[a] && loaded[b]) {
                continue;
            }
            for (from, to, sign) in [(a, b, 1.0), (b, a, -1.0)] {
                let [x, z] = branch.vector.map(|x| sign * x / branch.length());
                let along = x * principal[from].1[0] + z * principal[from].1[1];
                let sense = &mut best[from][usize::from(along < 0.0)];
                let better = sense
                    .is_none_or(|(known, other)| along.abs() > known || (along.abs() == known && (to as u32) < other));
                if along.abs() >= least && better {
                    *sense = Some((along.abs(), to as u32));
                }
            }
        }
        let next = |i: u32| best[i as usize].iter().flatten().map(|&(_, other)| other);
        let links: Vec<Vec<u32>> = (0..best.len() as u32)
            .map(|i| next(i).filter(|&other| next(other).any(|back| back == i)).collect())
            .collect();
        Some(Self { chains: paths(&links), loaded: loaded.iter().filter(|&&on| on).count() })
    }
}

/// Force moment of each grain: half of f ⊗ l of each of its contacts.
fn moments(network: &Network, branches: &[Branch]) -> Vec<StressTensor> {
    let mut moments = vec![[[0.0; 2]; 2]; network.grains()];
    for (contact, branch) in network.contacts().iter().zip(branches) {
        let half = virial(contact, branch).map(|row| row.map(|value| 0.5 * value));
        for &i in &contact.grains {
            moments[i as usize] = add(moments[i as usize], half);
        }
    }
    moments
}

/// The greater principal value of the symmetric part, and its direction.
fn principal(&[[xx, xz], [zx, zz]]: &StressTensor) -> (f64, [f64; 2]) {
    let (mean, half, shear) = (0.5 * (xx + zz), 0.5 * (xx - zz), 0.5 * (xz + zx));
    let turn = 0.5 * shear.atan2(half);
    (mean + half.hypot(shear), [turn.cos(), turn.sin()])
}

/// Paths and rings of three or more, where each has two links at most.
fn paths(links: &[Vec<u32>]) -> Vec<Vec<u32>> {
    let mut seen = vec![false; links.len()];
    let mut chains = Vec::new();
    let count = links.len() as u32;
    // Ends first; what is left then are rings.
    let ends = (0..count).filter(|&i| links[i as usize].len() == 1);
    for begin in ends.chain(0..count) {
        if seen[begin as usize] {
            continue;
        }
        let mut chain = Vec::new();
        let mut at = Some(begin);
        while let Some(i) = at {
            seen[i as usize] = true;
            chain.push(i);
            at = links[i as usize].iter().copied().find(|&other| !seen[other as usize]);
        }
        if chain.len() >= 3 {
            chains.push(chain);
        }
    }
    chains.sort_by(|a, b| b.len().cmp(&a.len()).then(a.cmp(b)));
    chains
}

#[cfg(test)]
mod tests {
    use super::super::Contact;
    use super::*;

    /// A column of five under load between weak side contacts is one chain; a bend of 90 degrees ends it.
    #[test]
    fn a_loaded_column_is_a_chain() {
        let place = |i: u32| match i {
            0..5 => [0.0, f64::from(i)],
            _ => [1.0, f64::from(i - 5)],
        };
        let mut list: Vec<(u32, u32, f64)> = (0..4).map(|i| (i, i + 1, 10.0)).collect();
        list.extend((0..5).map(|i| (i, i + 5, 0.1)));
        let of = |list: &[(u32, u32, f64)]| {
            let contacts = list.iter().map(|&(a, b, normal)| Contact { grains: [a, b], normal, tangential: 0.0 });
            let branches = list.iter().map(|&(a, b, _)| Branch::between(place(a), place(b), None));
            let network = Network::new(10, contacts.collect(), Some(branches.collect())).unwrap();
            Chains::new(&network, ANGLE).unwrap()
        };
        assert_eq!(of(&list), Chains { chains: vec![vec![0, 1, 2, 3, 4]], loaded: 5 });
        // The same the other way round.
        let turned: Vec<(u32, u32, f64)> = list.iter().rev().map(|&(a, b, f)| (b, a, f)).collect();
        assert_eq!(of(&turned), of(&list));
        // Without the middle contact two pairs are left, which are no chains.
        list.remove(1);
        list.remove(1);
        assert!(of(&list).chains.is_empty());
    }
}
