//! How a population has children, and what it begins with.

use std::collections::HashSet;

use super::{Choice, Dice, Space, level_set};

/// A child has one parent's letters in a rectangle and the other's elsewhere, then a block of one letter or single flips.
pub(super) fn child(space: &Space, dice: &mut Dice, [a, b]: [&Choice; 2]) -> Choice {
    let mut child = a.clone();
    if dice.below(100) < 85 {
        let extent = space.extent();
        for site in space.rectangle(dice, 2 * extent) {
            child[site] = b[site];
        }
    }
    if dice.below(100) < 40 {
        let letter = dice.below(u64::from(space.letters)) as u8;
        for site in space.rectangle(dice, 5) {
            child[site] = letter;
        }
    }
    while dice.below(100) < 60 {
        space.flip(&mut child, dice);
    }
    child
}

/// What is given, each uniform choice, and smooth random ones until there are `count`; none twice.
pub(super) fn first(
    space: &Space,
    dice: &mut Dice,
    given: Vec<Choice>,
    count: usize,
    known: &mut HashSet<Choice>,
) -> Vec<Choice> {
    let uniform = (0..space.letters).map(|letter| vec![letter; space.sites.len()]);
    let mut first: Vec<Choice> = given.into_iter().chain(uniform).collect();
    while first.len() < count {
        first.push(level_set(space, dice));
    }
    first.retain(|choice| known.insert(choice.clone()));
    first
}
