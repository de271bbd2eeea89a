//! Flips of single sites, in random order and in batches, until none improves.

use super::{Choice, Dice, Search, Space, sane, shifted};

/// A change of one site's letter.
#[derive(Clone, Copy, Debug)]
struct Flip {
    site: usize,
    shift: u8,
}

/// Tries the flips of all sites in a random order that is gone through again and again. Of each batch the best
/// improvement is taken; where several improve, they are next tried together. When all flips of one choice have
/// failed, no flip improves it, and the search ends: that choice is 1-opt.
#[derive(Clone, Debug)]
pub struct LocalSearch {
    space: Space,
    batch: usize,
    current: Choice,
    /// Of the current choice, once told.
    loss: Option<f64>,
    order: Vec<Flip>,
    next: usize,
    /// Flips of the current choice that are known not to improve it.
    failed: usize,
    /// Flips to apply in each choice that was asked for.
    asked: Vec<Vec<Flip>>,
    /// Other flips that improved the choice before the current one.
    others: Vec<Flip>,
    together: bool,
}

impl LocalSearch {
    /// Begins at `start`, whose loss may be known; asks for `batch` choices at a time.
    pub fn new(space: &Space, start: Choice, loss: Option<f64>, batch: usize, seed: u64) -> Self {
        let mut dice = Dice::new(seed);
        let mut order: Vec<Flip> = (0..space.sites.len())
            .flat_map(|site| (1..space.letters.max(1)).map(move |shift| Flip { site, shift }))
            .collect();
        for k in (1..order.len()).rev() {
            order.swap(k, dice.below(k as u64 + 1) as usize);
        }
        Self {
            space: space.clone(),
            batch: batch.max(1),
            current: start,
            loss: loss.map(sane),
            order,
            next: 0,
            failed: 0,
            asked: Vec::new(),
            others: Vec::new(),
            together: false,
        }
    }

    fn with(&self, flips: &[Flip]) -> Choice {
        let mut choice = self.current.clone();
        for flip in flips {
            choice[flip.site] = shifted(choice[flip.site], flip.shift, self.space.letters);
        }
        choice
    }
}

impl Search for LocalSearch {
    fn ask(&mut self) -> Vec<Choice> {
        let others = std::mem::take(&mut self.others);
        self.together = !others.is_empty();
        self.asked = if self.loss.is_none() {
            vec![Vec::new()]
        } else if self.together {
            (1..=others.len()).map(|k| others[..k].to_vec()).collect()
        } else {
            let count = self.batch.min(self.order.len() - self.failed);
            (0..count).map(|k| vec![self.order[(self.next + k) % self.order.len()]]).collect()
        };
        self.asked.iter().map(|flips| self.with(flips)).collect()
    }

    fn tell(&mut self, losses: &[f64]) {
        let asked = std::mem::take(&mut self.asked);
        let Some(loss) = self.loss else {
            self.loss = losses.first().map(|&loss| sane(loss));
            return;
        };
        let mut better: Vec<(f64, &Vec<Flip>)> =
            losses.iter().map(|&loss| sane(loss)).zip(&asked).filter(|(new, _)| *new < loss).collect();
        better.sort_by(|a, b| a.0.total_cmp(&b.0));
        if !self.together {
            self.next = (self.next + asked.len()) % self.order.len().max(1);
            self.failed += asked.len();
        }
        if let Some(&(new, flips)) = better.first() {
            self.current = self.with(flips);
            self.loss = Some(new);
            self.failed = 0;
            if !self.together {
                let taken = flips[0].site;
                self.others = better[1..].iter().map(|(_, f)| f[0]).filter(|flip| flip.site != taken).collect();
                // Of two flips of one site only the better.
                let mut seen = Vec::new();
                self.others.retain(|flip| {
                    !seen.contains(&flip.site) && {
                        seen.push(flip.site);
                        true
                    }
                });
            }
        }
    }

    fn best(&self) -> Option<(&Choice, f64)> {
        self.loss.map(|loss| (&self.current, loss))
    }

    fn one_opt(&self) -> bool {
        self.loss.is_some() && self.others.is_empty() && self.failed == self.order.len()
    }
}
