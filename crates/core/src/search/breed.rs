//! How a population has children, and what it begins with.

use std::collections::HashSet;

use super::{Choice, Dice, Space, level_set};

/// A child has one parent's letters in a rectangle and the other's elsewhere, then a block of one letter or single flips.
fn child(space: &Space, dice: &mut Dice, [a, b]: [&Choice; 2]) -> Choice {
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

/// Up to `count` children that are not known yet, of parents that `winner` chooses.
pub(super) fn brood<'a>(
    space: &Space,
    dice: &mut Dice,
    count: usize,
    known: &mut HashSet<Choice>,
    mut winner: impl FnMut(&mut Dice) -> &'a Choice,
) -> Vec<Choice> {
    let mut children = Vec::new();
    // In a small space everything is known sooner or later.
    for _ in 0..20 * count {
        let parents = [winner(dice), winner(dice)];
        let child = child(space, dice, parents);
        if known.insert(child.clone()) {
            children.push(child);
        }
        if children.len() == count {
            break;
        }
    }
    children
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
