//! Force networks: grains that touch and the forces between them, whatever they came from.
//!
//! - `filtration`: which contacts and grains carry more than a threshold; components and how long each lasts
//! - `loops`: loops of the network with its triangles filled, and how long each lasts
//! - `topology`: both as functions of the threshold, in multiples of the mean force
//! - `fabric`: coordination, rattlers, fabric tensor; `stress`: the coarse-grained stress, whose integral is the virial
//! - `chains`: force chains
//!
//! Units are those of the forces and places given; nothing here knows beds, crystals or files.

mod chains;
mod fabric;
mod filtration;
mod loops;
mod stress;
mod topology;

pub use chains::{ANGLE, Chains};
pub use fabric::{Fabric, StressTensor};
pub use filtration::{Bar, Filtration};
pub use stress::{Cell, StressMap};
pub use topology::{Topology, default_thresholds};

use crate::period::nearest_image;

/// Two grains that touch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// The grains, by number from 0.
    pub grains: [u32; 2],
    /// Normal force (N, or what the forces came in; only ratios matter to topology); positive where it presses.
    pub normal: f64,
    /// Tangential force, in the same unit, on the second grain, along the normal from the first to the second turned from x towards z. Where only
    /// sizes are known, its size.
    pub tangential: f64,
}

/// Where the two grains of a contact are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Branch {
    /// Centre of the first grain, (x, z).
    pub from: [f64; 2],
    /// From there to the centre of the second, over a periodic side where that is nearer.
    pub vector: [f64; 2],
}

impl Branch {
    /// Between two centres, with the period along x, if any.
    pub fn between(from: [f64; 2], to: [f64; 2], period: Option<f64>) -> Self {
        let across = to[0] - from[0];
        let vector = [period.map_or(across, |period| nearest_image(across, period)), to[1] - from[1]];
        Self { from, vector }
    }

    /// Length.
    pub fn length(&self) -> f64 {
        self.vector[0].hypot(self.vector[1])
    }
}

/// A network of contacts.
#[derive(Clone, Debug, PartialEq)]
pub struct Network {
    grains: usize,
    contacts: Vec<Contact>,
    branches: Option<Vec<Branch>>,
}

/// What is no network.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum NetworkError {
    /// A grain that touches itself.
    #[error("contact {contact} is of a grain with itself")]
    Itself {
        /// Its place in the list, from 0.
        contact: usize,
    },
    /// Two contacts of the same grains.
    #[error("contacts {first} and {second} are of the same two grains")]
    Twice {
        /// Place of the first in the list, from 0.
        first: usize,
        /// Place of the second.
        second: usize,
    },
    /// A force or place that is no finite number.
    #[error("contact {contact} has a force or place that is no finite number")]
    Number {
        /// Its place in the list, from 0.
        contact: usize,
    },
    /// A grain that is not there.
    #[error("contact {contact} is of a grain beyond the {grains} that there are")]
    Grain {
        /// Its place in the list, from 0.
        contact: usize,
        /// How many grains there are.
        grains: usize,
    },
    /// Two centres in one place.
    #[error("the two grains of contact {contact} have their centres in one place")]
    Centre {
        /// Its place in the list, from 0.
        contact: usize,
    },
    /// As many places as contacts are needed.
    #[error("there are {contacts} contacts and {branches} places of contacts")]
    Branches {
        /// How many contacts there are.
        contacts: usize,
        /// How many places there are.
        branches: usize,
    },
}

/// Which force of a contact is looked at.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Part {
    /// The normal force.
    #[default]
    Normal,
    /// The tangential force.
    Tangential,
}

/// What carries the force that is compared with a threshold.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Carrier {
    /// A contact, by the size of its force; its two grains are there where it is.
    #[default]
    Contacts,
    /// A grain, by the sum of the sizes of the forces at its contacts; a contact is there where both its grains are.
    Particles,
}

impl Network {
    /// Of so many grains, some of which may touch none, their contacts and, where they are known, the places of these.
    ///
    /// # Errors
    /// See [`NetworkError`].
    pub fn new(grains: usize, contacts: Vec<Contact>, branches: Option<Vec<Branch>>) -> Result<Self, NetworkError> {
        for (contact, &Contact { grains: [a, b], normal, tangential }) in contacts.iter().enumerate() {
            if a == b {
                return Err(NetworkError::Itself { contact });
            }
            if a.max(b) as usize >= grains {
                return Err(NetworkError::Grain { contact, grains });
            }
            if !(normal.is_finite() && tangential.is_finite()) {
                return Err(NetworkError::Number { contact });
            }
        }
        if let Some(branches) = &branches {
            if branches.len() != contacts.len() {
                return Err(NetworkError::Branches { contacts: contacts.len(), branches: branches.len() });
            }
            for (contact, Branch { from, vector }) in branches.iter().enumerate() {
                if !from.iter().chain(vector).all(|x| x.is_finite()) {
                    return Err(NetworkError::Number { contact });
                }
                if *vector == [0.0; 2] {
                    return Err(NetworkError::Centre { contact });
                }
            }
        }
        let mut keys: Vec<([u32; 2], usize)> =
            contacts.iter().enumerate().map(|(c, contact)| (ordered(contact.grains), c)).collect();
        keys.sort_unstable();
        if let Some(same) = keys.windows(2).find(|two| two[0].0 == two[1].0) {
            return Err(NetworkError::Twice { first: same[0].1, second: same[1].1 });
        }
        Ok(Self { grains, contacts, branches })
    }

    /// Number of grains.
    pub fn grains(&self) -> usize {
        self.grains
    }

    /// The contacts.
    pub fn contacts(&self) -> &[Contact] {
        &self.contacts
    }

    /// Places of the contacts, where they are known.
    pub fn branches(&self) -> Option<&[Branch]> {
        self.branches.as_deref()
    }

    /// Sum of the sizes of the forces at each grain's contacts.
    pub fn grain_forces(&self, part: Part) -> Vec<f64> {
        // In order of size, so that the order of the contacts changes no bit.
        let mut sizes: Vec<(f64, [u32; 2])> = self.contacts.iter().map(|c| (c.size(part), c.grains)).collect();
        sizes.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        let mut sums = vec![0.0; self.grains];
        for (size, grains) in sizes {
            grains.iter().for_each(|&g| sums[g as usize] += size);
        }
        sums
    }

    /// Mean size of the normal forces: over contacts, or over grains of the sum at each. Zero where there are none.
    pub fn mean(&self, carrier: Carrier) -> f64 {
        mean(match carrier {
            Carrier::Contacts => self.contacts.iter().map(|c| c.size(Part::Normal)).collect(),
            Carrier::Particles => self.grain_forces(Part::Normal),
        })
    }
}

impl Contact {
    /// Size of one of its forces.
    pub fn size(&self, part: Part) -> f64 {
        match part {
            Part::Normal => self.normal.abs(),
            Part::Tangential => self.tangential.abs(),
        }
    }
}

fn ordered([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

/// Mean of numbers that are not negative, in any order to the same bit, and of equal ones exactly that number: where all forces
/// are equal none exceeds the mean. The sum keeps what each addition rounds off (Knuth's two-sum).
fn mean(mut numbers: Vec<f64>) -> f64 {
    if numbers.is_empty() {
        return 0.0;
    }
    numbers.sort_unstable_by(f64::total_cmp);
    let count = numbers.len() as f64;
    let (mut sum, mut rest) = (0.0_f64, 0.0_f64);
    for x in numbers {
        let next = sum + x;
        let of_x = next - sum;
        rest += (sum - (next - of_x)) + (x - of_x);
        sum = next;
    }
    let mean = (sum + rest) / count;
    // What the division rounded off.
    mean + ((-mean).mul_add(count, sum) + rest) / count
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mean_of_equal_numbers_is_that_number() {
        for x in [0.1, 0.7, 1.0 / 3.0, 1e-300, 3.3e7] {
            for count in [1, 3, 10, 49, 1000, 4999] {
                assert_eq!(mean(vec![x; count]), x, "{count} times {x}");
            }
        }
        assert_eq!(mean(Vec::new()), 0.0);
    }

    #[test]
    fn what_is_no_network_is_refused() {
        let contact = |a, b, normal| Contact { grains: [a, b], normal, tangential: 0.0 };
        let of = |contacts| Network::new(3, contacts, None).unwrap_err();
        assert_eq!(of(vec![contact(0, 1, 1.0), contact(1, 1, 1.0)]), NetworkError::Itself { contact: 1 });
        assert_eq!(
            of(vec![contact(0, 1, 1.0), contact(1, 2, 1.0), contact(1, 0, 1.0)]),
            NetworkError::Twice { first: 0, second: 2 }
        );
        assert_eq!(of(vec![contact(0, 1, f64::NAN)]), NetworkError::Number { contact: 0 });
        assert_eq!(of(vec![contact(0, 3, 1.0)]), NetworkError::Grain { contact: 0, grains: 3 });
    }
}
