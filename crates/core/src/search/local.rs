//! Changes of one site, then of two, in random order and in batches, until none improves.

use super::method::{Again, Begin, ByTotal, Parameters, Round, Row};
use super::rounds::BATCH;
use super::{Assignment, LocalOptimality, Rng, Search, Space, sane, shifted};

/// Flips of single sites, then of two, from the start; then again and again from the best with rectangles and sites changed at random.
pub(super) const FLIPS: Row = Row {
    name: "local",
    about: "flips of single spheres until none improves, then from the best changed at random",
    parameters: Parameters::Letters,
    starts: 1,
    takes_batch: false,
    begin: |begin| first(begin, Reach::Flips),
    improve: None,
    again: Some(|again| kicked(again, Reach::Flips)),
};

/// With exchanges of neighbours too.
pub(super) const SWAPS: Row = Row {
    name: "local-swaps",
    about: "as local, with exchanges of two spheres side by side",
    begin: |begin| first(begin, Reach::Swaps),
    again: Some(|again| kicked(again, Reach::Swaps)),
    ..FLIPS
};

/// With all pairs too.
pub(super) const PAIRS: Row = Row {
    name: "local-pairs",
    about: "as local-swaps, then with flips of any two spheres",
    begin: |begin| first(begin, Reach::Pairs),
    again: Some(|again| kicked(again, Reach::Pairs)),
    ..FLIPS
};

fn first(Begin { space, mut starts, seed, .. }: Begin<'_>, reach: Reach) -> Round {
    Box::new(ByTotal(LocalSearch::new(space, starts.swap_remove(0), None, BATCH, reach, seed)))
}

fn kicked(Again { space, begun, rng, seed }: Again<'_>, reach: Reach) -> Round {
    Box::new(ByTotal(LocalSearch::new(space, begun.kicked(space, rng), None, BATCH, reach, seed)))
}

/// How many sites a local search changes at a time, once no single one helps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Reach {
    /// One site only.
    #[default]
    Flips,
    /// Then the letters of two neighbours, exchanged.
    Swaps,
    /// Then any two sites: there are very many of these pairs.
    Pairs,
}

/// A change of one site's letter.
#[derive(Clone, Copy, Debug)]
struct Flip {
    site: usize,
    shift: u8,
}

#[derive(Clone, Copy, Debug)]
enum Move {
    One(Flip),
    Two(Flip, Flip),
    Exchange([usize; 2]),
}

impl Move {
    fn apply(self, assignment: &mut Assignment, alphabet: u8) {
        let mut flip = |Flip { site, shift }: Flip| assignment[site] = shifted(assignment[site], shift, alphabet);
        match self {
            Self::One(a) => flip(a),
            Self::Two(a, b) => {
                flip(a);
                flip(b);
            }
            Self::Exchange([a, b]) => assignment.swap(a, b),
        }
    }

    fn touches(self, site: usize) -> bool {
        match self {
            Self::One(a) => a.site == site,
            Self::Two(a, b) => a.site == site || b.site == site,
            Self::Exchange(pair) => pair.contains(&site),
        }
    }

    fn meets(self, other: Self) -> bool {
        match self {
            Self::One(a) => other.touches(a.site),
            Self::Two(a, b) => other.touches(a.site) || other.touches(b.site),
            Self::Exchange([a, b]) => other.touches(a) || other.touches(b),
        }
    }
}

/// Moves in a fixed order that is gone through again and again.
#[derive(Clone, Debug)]
struct Ring {
    moves: Vec<Move>,
    next: usize,
    /// Moves of the current assignment that are known not to improve it.
    failed: usize,
}

impl Ring {
    fn new(mut moves: Vec<Move>, rng: &mut Rng) -> Self {
        for k in (1..moves.len()).rev() {
            moves.swap(k, rng.below(k as u64 + 1) as usize);
        }
        Self { moves, next: 0, failed: 0 }
    }

    fn is_done(&self) -> bool {
        self.failed == self.moves.len()
    }

    /// Up to `count` moves that change the assignment, and how many were looked at for that.
    fn upcoming(&self, count: usize, current: &[u8]) -> (Vec<Move>, usize) {
        let (mut found, mut seen) = (Vec::new(), 0);
        while found.len() < count && seen < self.moves.len() - self.failed {
            let next = self.moves[(self.next + seen) % self.moves.len()];
            let idle = matches!(next, Move::Exchange([a, b]) if current[a] == current[b]);
            found.extend((!idle).then_some(next));
            seen += 1;
        }
        (found, seen)
    }

    fn pass(&mut self, seen: usize) {
        self.next = (self.next + seen) % self.moves.len().max(1);
        self.failed += seen;
    }
}

/// Tries the flips of all sites in a random order that is gone through again and again. Of each batch the best
/// improvement is taken; where several improve, they are next tried together. When all flips of one assignment have
/// failed, no flip improves it: that assignment is 1-opt. Within a longer [`Reach`] two sites are then changed at a time, and the
/// search goes back to flips as soon as that helps. It ends when nothing within reach does.
#[derive(Clone, Debug)]
pub struct LocalSearch {
    space: Space,
    batch: usize,
    reach: Reach,
    current: Assignment,
    /// Of the current assignment, once told.
    loss: Option<f64>,
    flips: Ring,
    wider: Ring,
    /// Moves to apply in each assignment that was asked for.
    asked: Vec<Vec<Move>>,
    asking: Asking,
    /// Other moves that improved the assignment before the current one.
    others: Vec<Move>,
}

/// What the last batch was made of.
#[derive(Clone, Copy, Debug)]
enum Asking {
    Flips { seen: usize },
    Wider { seen: usize },
    Together,
}

impl LocalSearch {
    /// Begins at `start`, whose loss may be known; asks for `batch` assignments at a time.
    pub fn new(space: &Space, start: Assignment, loss: Option<f64>, batch: usize, reach: Reach, seed: u64) -> Self {
        let mut rng = Rng::new(seed);
        let flips: Vec<Flip> = (0..space.sites.len())
            .flat_map(|site| (1..space.alphabet.max(1)).map(move |shift| Flip { site, shift }))
            .collect();
        let wider = match reach {
            Reach::Flips => Vec::new(),
            Reach::Swaps => space.neighbours().into_iter().map(Move::Exchange).collect(),
            Reach::Pairs => {
                let mut pairs = Vec::new();
                for (k, &a) in flips.iter().enumerate() {
                    let later = flips[k + 1..].iter().filter(|b| b.site != a.site);
                    pairs.extend(later.map(|&b| Move::Two(a, b)));
                }
                pairs
            }
        };
        let flips = Ring::new(flips.into_iter().map(Move::One).collect(), &mut rng);
        let wider = Ring::new(wider, &mut rng);
        Self {
            space: space.clone(),
            batch: batch.max(1),
            reach,
            current: start,
            loss: loss.map(sane),
            flips,
            wider,
            asked: Vec::new(),
            asking: Asking::Together,
            others: Vec::new(),
        }
    }

    fn with(&self, moves: &[Move]) -> Assignment {
        let mut assignment = self.current.clone();
        moves.iter().for_each(|step| step.apply(&mut assignment, self.space.alphabet));
        assignment
    }
}

impl Search for LocalSearch {
    fn ask(&mut self) -> Vec<Assignment> {
        let others = std::mem::take(&mut self.others);
        self.asked = if self.loss.is_none() {
            vec![Vec::new()]
        } else if !others.is_empty() {
            self.asking = Asking::Together;
            (1..=others.len()).map(|k| others[..k].to_vec()).collect()
        } else {
            let (mut moves, seen) = self.flips.upcoming(self.batch, &self.current);
            self.asking = Asking::Flips { seen };
            if moves.is_empty() {
                let (wider, seen) = self.wider.upcoming(self.batch, &self.current);
                moves = wider;
                self.asking = Asking::Wider { seen };
                if moves.is_empty() {
                    // What is left would change nothing.
                    self.wider.pass(seen);
                }
            }
            moves.into_iter().map(|step| vec![step]).collect()
        };
        self.asked.iter().map(|moves| self.with(moves)).collect()
    }

    fn tell(&mut self, losses: &[f64]) {
        let asked = std::mem::take(&mut self.asked);
        let Some(loss) = self.loss else {
            self.loss = losses.first().map(|&loss| sane(loss));
            return;
        };
        let mut better: Vec<(f64, &Vec<Move>)> =
            losses.iter().map(|&loss| sane(loss)).zip(&asked).filter(|(new, _)| *new < loss).collect();
        better.sort_by(|a, b| a.0.total_cmp(&b.0));
        match self.asking {
            Asking::Flips { seen } => self.flips.pass(seen),
            Asking::Wider { seen } => self.wider.pass(seen),
            Asking::Together => {}
        }
        let Some(&(new, moves)) = better.first() else { return };
        self.current = self.with(moves);
        self.loss = Some(new);
        (self.flips.failed, self.wider.failed) = (0, 0);
        if !matches!(self.asking, Asking::Together) {
            // Of two that touch the same site only the better.
            let mut kept = vec![moves[0]];
            for (_, other) in &better[1..] {
                if !kept.iter().any(|&kept| kept.meets(other[0])) {
                    kept.push(other[0]);
                }
            }
            self.others = kept.split_off(1);
        }
    }

    fn best(&self) -> Option<(&Assignment, f64)> {
        self.loss.map(|loss| (&self.current, loss))
    }

    fn local_optimality(&self) -> LocalOptimality {
        if self.loss.is_none() || !self.others.is_empty() || !self.flips.is_done() {
            LocalOptimality::None
        } else if self.reach == Reach::Pairs && self.wider.is_done() {
            LocalOptimality::TwoOpt
        } else {
            LocalOptimality::OneOpt
        }
    }
}
