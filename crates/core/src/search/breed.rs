//! How a population has children, and what it begins with.

use std::collections::HashSet;

use super::{Assignment, Rng, Space, level_set};

/// A child has one parent's letters in a rectangle and the other's elsewhere, then a block of one letter or single flips.
fn child(space: &Space, rng: &mut Rng, [a, b]: [&Assignment; 2]) -> Assignment {
    let mut child = a.clone();
    if rng.below(100) < 85 {
        let extent = space.extent();
        for site in space.rectangle(rng, 2 * extent) {
            child[site] = b[site];
        }
    }
    if rng.below(100) < 40 {
        let letter = rng.below(u64::from(space.alphabet)) as u8;
        for site in space.rectangle(rng, 5) {
            child[site] = letter;
        }
    }
    while rng.below(100) < 60 {
        space.flip(&mut child, rng);
    }
    child
}

/// Up to `count` children that are not known yet, of parents that `winner` chooses.
pub(super) fn brood<'a>(
    space: &Space,
    rng: &mut Rng,
    count: usize,
    known: &mut HashSet<Assignment>,
    mut winner: impl FnMut(&mut Rng) -> &'a Assignment,
) -> Vec<Assignment> {
    let mut children = Vec::new();
    // In a small space everything is known sooner or later.
    for _ in 0..20 * count {
        let parents = [winner(rng), winner(rng)];
        let child = child(space, rng, parents);
        if known.insert(child.clone()) {
            children.push(child);
        }
        if children.len() == count {
            break;
        }
    }
    children
}

/// What is given, each uniform assignment, and smooth random ones until there are `count`; none twice.
pub(super) fn first(
    space: &Space,
    rng: &mut Rng,
    given: Vec<Assignment>,
    count: usize,
    known: &mut HashSet<Assignment>,
) -> Vec<Assignment> {
    let uniform = (0..space.alphabet).map(|letter| vec![letter; space.sites.len()]);
    let mut first: Vec<Assignment> = given.into_iter().chain(uniform).collect();
    while first.len() < count {
        first.push(level_set(space, rng));
    }
    first.retain(|assignment| known.insert(assignment.clone()));
    first
}
