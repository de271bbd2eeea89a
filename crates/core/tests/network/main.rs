//! Force networks against closed forms, brute force and GUDHI.
//!
//! - `made`: networks made by hand, and what must change nothing
//! - `brute`: persistence by the plainest reduction there is, on random networks
//! - `gudhi`: persistence as GUDHI gives it, stored with the script that asked it
//! - `motion`: the affine map around each grain

mod brute;
mod gudhi;
mod made;
mod motion;

use granulens_core::network::{Contact, Network};

/// A network of contacts (grain, grain, normal, tangential).
fn network(contacts: &[(u32, u32, f64, f64)]) -> Network {
    let grains = contacts.iter().map(|c| c.0.max(c.1) as usize + 1).max().unwrap_or(0);
    let contact = |&(a, b, normal, tangential): &(u32, u32, f64, f64)| Contact { grains: [a, b], normal, tangential };
    Network::new(grains, contacts.iter().map(contact).collect(), None).unwrap()
}

/// Contacts at random between so many grains, each pair with a chance of one in `rare`; forces of `levels` values.
fn random(seed: u64, grains: u32, rare: u64, levels: u64) -> Vec<(u32, u32, f64, f64)> {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    let mut next = |below: u64| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) % below
    };
    let mut contacts = Vec::new();
    for a in 0..grains {
        for b in a + 1..grains {
            if next(rare) == 0 {
                let force = |n: u64| (n + 1) as f64 / levels as f64;
                contacts.push((a, b, force(next(levels)), force(next(levels)) - 0.5));
            }
        }
    }
    contacts
}
