//! A population that exchanges rectangles.

use std::collections::HashSet;

use super::{Choice, Dice, Search, Space, level_set, sane};

/// How many members; how many choices of the first population and of each generation are asked for; and after how many
/// generations without a better best the search ends.
const MEMBERS: usize = 48;
const FIRST: usize = 192;
const CHILDREN: usize = 32;
const PATIENCE: usize = 25;

/// A genetic algorithm. The first population is smooth ([`level_set`]), with each uniform choice and what is given; the
/// best of it are the members. A child has one parent's letters in a rectangle and the other's elsewhere, then a block of
/// one letter or single flips; parents win tournaments of three. Members are the best that are known, all different
/// (elitism). It ends when the best has not improved for 25 generations, or when no new child is found.
#[derive(Clone, Debug)]
pub struct Genetic {
    space: Space,
    dice: Dice,
    members: Vec<(Choice, f64)>,
    asked: Vec<Choice>,
    known: HashSet<Choice>,
    given: Vec<Choice>,
    begun: bool,
    stale: usize,
}

impl Genetic {
    /// Begins with `given` among its first population.
    pub fn new(space: &Space, given: Vec<Choice>, seed: u64) -> Self {
        let (dice, known) = (Dice::new(seed), HashSet::new());
        Self {
            space: space.clone(),
            dice,
            members: Vec::new(),
            asked: Vec::new(),
            known,
            given,
            begun: false,
            stale: 0,
        }
    }

    fn first(&mut self) {
        let uniform = (0..self.space.letters).map(|letter| vec![letter; self.space.sites.len()]);
        let mut first: Vec<Choice> = self.given.drain(..).chain(uniform).collect();
        while first.len() < FIRST {
            first.push(level_set(&self.space, &mut self.dice));
        }
        for choice in first {
            if self.known.insert(choice.clone()) {
                self.asked.push(choice);
            }
        }
    }

    /// The place of the best of three random members; members stand in order.
    fn winner(&mut self) -> usize {
        let end = self.members.len() as u64;
        (0..3).map(|_| self.dice.below(end) as usize).min().unwrap_or(0)
    }

    fn child(&mut self) -> Choice {
        let (a, b) = (self.winner(), self.winner());
        let mut child = self.members[a].0.clone();
        if self.dice.below(100) < 85 {
            let extent = self.space.extent();
            for site in self.space.rectangle(&mut self.dice, 2 * extent) {
                child[site] = self.members[b].0[site];
            }
        }
        if self.dice.below(100) < 40 {
            let letter = self.dice.below(u64::from(self.space.letters)) as u8;
            for site in self.space.rectangle(&mut self.dice, 5) {
                child[site] = letter;
            }
        }
        while self.dice.below(100) < 60 {
            self.space.flip(&mut child, &mut self.dice);
        }
        child
    }
}

impl Search for Genetic {
    fn ask(&mut self) -> Vec<Choice> {
        self.asked.clear();
        if self.space.sites.is_empty() {
            return Vec::new();
        }
        if !self.begun {
            self.begun = true;
            self.first();
        } else if self.stale < PATIENCE {
            // In a small space everything is known sooner or later.
            for _ in 0..20 * CHILDREN {
                let child = self.child();
                if self.known.insert(child.clone()) {
                    self.asked.push(child);
                }
                if self.asked.len() == CHILDREN {
                    break;
                }
            }
        }
        self.asked.clone()
    }

    fn tell(&mut self, losses: &[f64]) {
        let before = self.best().map_or(f64::INFINITY, |(_, loss)| loss);
        self.members.extend(self.asked.drain(..).zip(losses.iter().map(|&loss| sane(loss))));
        // Stable: of two that are alike, the older.
        self.members.sort_by(|a, b| a.1.total_cmp(&b.1));
        self.members.truncate(MEMBERS);
        let after = self.best().map_or(f64::INFINITY, |(_, loss)| loss);
        self.stale = if after < before { 0 } else { self.stale + 1 };
    }

    fn best(&self) -> Option<(&Choice, f64)> {
        self.members.first().map(|(choice, loss)| (choice, *loss))
    }
}
