//! How many contacts grains have and which way these point.

use super::{Branch, Contact, Network};

/// A tensor in the plane: [[xx, xz], [zx, zz]].
pub type StressTensor = [[f64; 2]; 2];

/// Means over contacts and grains.
#[derive(Clone, Debug, PartialEq)]
pub struct Fabric {
    /// Mean number of contacts of a grain, 2 E/V.
    pub coordination: f64,
    /// Grains that carry nothing: with fewer than two contacts, counted again as the contacts of those found are taken away.
    pub rattlers: Vec<u32>,
    /// Mean number of contacts of the other grains, among themselves.
    pub coordination_without_rattlers: f64,
    /// Fabric tensor ⟨n ⊗ n⟩ over contacts, n the unit vector from centre to centre (Satake 1982); its trace is 1. None where
    /// places are not known.
    pub tensor: Option<StressTensor>,
    /// Virial Σ f ⊗ l over contacts, compression positive: the mean stress times the area. None where places are not known.
    pub virial: Option<StressTensor>,
}

impl Fabric {
    /// Of a network.
    pub fn new(network: &Network) -> Self {
        let (grains, contacts) = (network.grains(), network.contacts());
        let rattlers = rattlers(network);
        let mut loose = vec![false; grains];
        rattlers.iter().for_each(|&i| loose[i as usize] = true);
        let inner = contacts.iter().filter(|c| c.grains.iter().all(|&i| !loose[i as usize])).count();
        let per =
            |contacts: usize, grains: usize| if grains == 0 { 0.0 } else { 2.0 * contacts as f64 / grains as f64 };
        let count = contacts.len().max(1) as f64;
        Self {
            coordination: per(contacts.len(), grains),
            coordination_without_rattlers: per(inner, grains - rattlers.len()),
            rattlers,
            tensor: network.branches().map(|branches| {
                let square = |branch: &Branch| {
                    let n = branch.vector.map(|x| x / branch.length());
                    outer(n, n)
                };
                branches.iter().map(square).fold([[0.0; 2]; 2], add).map(|row| row.map(|x| x / count))
            }),
            virial: network.branches().map(|branches| {
                let all = contacts.iter().zip(branches);
                all.map(|(contact, branch)| virial(contact, branch)).fold([[0.0; 2]; 2], add)
            }),
        }
    }
}

/// f ⊗ l of one contact: the force on the second grain, and the vector from centre to centre.
pub(super) fn virial(contact: &Contact, branch: &Branch) -> StressTensor {
    let [nx, nz] = branch.vector.map(|x| x / branch.length());
    let force = [contact.normal * nx - contact.tangential * nz, contact.normal * nz + contact.tangential * nx];
    outer(force, branch.vector)
}

pub(super) fn outer(a: [f64; 2], b: [f64; 2]) -> StressTensor {
    a.map(|a| b.map(|b| a * b))
}

pub(super) fn add(a: StressTensor, b: StressTensor) -> StressTensor {
    std::array::from_fn(|i| std::array::from_fn(|k| a[i][k] + b[i][k]))
}

/// Grains that are left with fewer than two contacts, in order.
fn rattlers(network: &Network) -> Vec<u32> {
    let mut around = vec![Vec::new(); network.grains()];
    for contact in network.contacts() {
        let [a, b] = contact.grains;
        around[a as usize].push(b);
        around[b as usize].push(a);
    }
    let mut left: Vec<usize> = around.iter().map(Vec::len).collect();
    let mut open: Vec<u32> = (0..left.len() as u32).filter(|&i| left[i as usize] < 2).collect();
    let mut loose = vec![false; left.len()];
    open.iter().for_each(|&i| loose[i as usize] = true);
    while let Some(i) = open.pop() {
        for &other in &around[i as usize] {
            left[other as usize] = left[other as usize].saturating_sub(1);
            if left[other as usize] < 2 && !loose[other as usize] {
                loose[other as usize] = true;
                open.push(other);
            }
        }
    }
    (0..left.len() as u32).filter(|&i| loose[i as usize]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square with a tail of two: the tail carries nothing; the sides of the square point along both axes alike.
    #[test]
    fn a_square_with_a_tail() {
        let contact = |a, b| Contact { grains: [a, b], normal: 2.0, tangential: 0.0 };
        let pairs = [(0, 1), (1, 2), (2, 3), (3, 0), (3, 4), (4, 5)];
        let places = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.0, 2.0], [0.0, 3.0]];
        let branch = |(a, b): (usize, usize)| Branch::between(places[a], places[b], None);
        let square = Network::new(
            7,
            pairs.iter().map(|&(a, b)| contact(a, b)).collect(),
            Some(pairs.iter().map(|&(a, b)| branch((a as usize, b as usize))).collect()),
        );
        let fabric = Fabric::new(&square.unwrap());
        assert_eq!(fabric.rattlers, [4, 5, 6]);
        assert_eq!((fabric.coordination, fabric.coordination_without_rattlers), (12.0 / 7.0, 2.0));
        assert_eq!(fabric.tensor, Some([[2.0 / 6.0, 0.0], [0.0, 4.0 / 6.0]]));
        assert_eq!(fabric.virial, Some([[4.0, 0.0], [0.0, 8.0]]));
    }
}
