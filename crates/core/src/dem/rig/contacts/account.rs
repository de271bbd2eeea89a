//! What contacts have carried and lost, as parallel arrays.

use super::list::inherited;
use crate::dem::share::cut;

/// What a contact remembers besides its normal law's memory and its tangential spring.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Account {
    /// Overlap (m) and normal force (N) at the last accepted step; zero while open.
    pub overlap: f64,
    pub force: f64,
    /// ∫F dδ by the trapezoidal rule (J)
    pub work: f64,
    /// Work done against the tangential force (J), of which the spring may still hold a part; at the last step the power (W) of all of
    /// it, or, by `coulomb`, of its dashpot.
    pub friction_work: f64,
    pub power: f64,
}

impl Account {
    /// How many numbers it is.
    pub const NUMBERS: usize = 5;

    pub fn numbers(&self) -> [f64; 5] {
        [self.overlap, self.force, self.work, self.friction_work, self.power]
    }

    /// From its five numbers.
    pub fn from_numbers(n: &[f64]) -> Self {
        Self { overlap: n[0], force: n[1], work: n[2], friction_work: n[3], power: n[4] }
    }

    /// Overlap and normal force of a contact after a step.
    #[inline(always)]
    pub fn push(&mut self, overlap: f64, force: f64) {
        self.work += 0.5 * (self.force + force) * (overlap - self.overlap);
        (self.overlap, self.force) = (overlap, force);
    }

    /// The power (W) of its friction after a step.
    #[inline(always)]
    pub fn rub(&mut self, power: f64, step: f64) {
        self.friction_work += 0.5 * step * (self.power + power);
        self.power = power;
    }

    /// The contact opens, its normal force having been `last` (N) when it did; what the spring held is lost.
    pub fn open(&mut self, last: f64, step: f64) {
        self.push(0.0, last);
        self.rub(0.0, step);
        self.force = 0.0;
    }
}

/// Accounts as parallel arrays: row c of each is contact c.
#[derive(Default)]
pub struct Accounts {
    pub overlap: Vec<f64>,
    pub force: Vec<f64>,
    pub work: Vec<f64>,
    pub friction_work: Vec<f64>,
    pub power: Vec<f64>,
}

/// Some successive rows of [`Accounts`].
pub struct AccountRows<'a> {
    pub overlap: &'a mut [f64],
    pub force: &'a mut [f64],
    pub work: &'a mut [f64],
    pub friction_work: &'a mut [f64],
    pub power: &'a mut [f64],
}

/// Row c of the five columns.
#[inline(always)]
fn row([overlap, force, work, friction_work, power]: [&[f64]; 5], c: usize) -> Account {
    Account { overlap: overlap[c], force: force[c], work: work[c], friction_work: friction_work[c], power: power[c] }
}

impl Accounts {
    /// Puts the rows that stood in these places where they stand now; see [`inherited`].
    pub fn inherit(&mut self, from: &[u32]) {
        let Self { overlap, force, work, friction_work, power } = self;
        for column in [overlap, force, work, friction_work, power] {
            *column = inherited(column, from);
        }
    }

    /// Row c.
    pub fn at(&self, c: usize) -> Account {
        let Self { overlap, force, work, friction_work, power } = self;
        row([overlap, force, work, friction_work, power], c)
    }

    /// Replaces row c.
    pub fn put(&mut self, c: usize, account: Account) {
        self.rows().put(c, account);
    }

    /// All rows.
    pub fn rows(&mut self) -> AccountRows<'_> {
        let Self { overlap, force, work, friction_work, power } = self;
        AccountRows { overlap, force, work, friction_work, power }
    }
}

impl<'a> AccountRows<'a> {
    /// The first `count` rows, which the rest is left without.
    pub fn cut(&mut self, count: usize) -> Self {
        let Self { overlap, force, work, friction_work, power } = self;
        Self {
            overlap: cut(overlap, count),
            force: cut(force, count),
            work: cut(work, count),
            friction_work: cut(friction_work, count),
            power: cut(power, count),
        }
    }

    /// Row c.
    #[inline(always)]
    pub fn at(&self, c: usize) -> Account {
        let Self { overlap, force, work, friction_work, power } = self;
        row([overlap, force, work, friction_work, power], c)
    }

    /// Replaces row c.
    #[inline(always)]
    pub fn put(&mut self, c: usize, account: Account) {
        self.overlap[c] = account.overlap;
        self.force[c] = account.force;
        self.work[c] = account.work;
        self.friction_work[c] = account.friction_work;
        self.power[c] = account.power;
    }
}
