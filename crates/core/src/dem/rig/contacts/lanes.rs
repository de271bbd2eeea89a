//! Contacts of disks with springs and dashpots, several side by side in the lanes of a vector register.
//!
//! In blocks small enough to stay in the nearest memory: what the disks of each pair do is gathered, the forces are worked out
//! (the same physics as one at a time, `react`), and then given to the disks in the order of the contacts.

use crate::dem::rig::dashpot::SpringDashpot;
use crate::dem::rig::law::{End, PairLaw};
use crate::dem::rig::pairs::Near;
use crate::dem::rig::spins;
use crate::dem::share::rows;
use crate::real::{Kernel, Lanes};

use super::friction::Grip;
use super::react::{CLOSED, between, meet};
use super::sections::{Piece, Spill};
use super::sweep::Excess;

/// Near pairs as parallel arrays: row c of each is pair c, as in [`Near`].
#[derive(Default)]
pub struct Lines {
    pub ends: Vec<[u32; 2]>,
    pub offset: [Vec<f64>; 2],
    pub gap: Vec<f64>,
    pub reach: Vec<f64>,
}

impl Lines {
    pub fn of(near: &[Near<2>], spheres: &[End]) -> Self {
        let radius = |end: u32| spheres[end as usize].radius;
        Self {
            ends: rows(near.len(), |c| near[c].ends),
            offset: [0, 1].map(|k| rows(near.len(), |c| near[c].rest[k])),
            gap: rows(near.len(), |c| near[c].rest[3]),
            reach: rows(near.len(), |c| radius(near[c].ends[0]) + radius(near[c].ends[1])),
        }
    }
}

/// What contacts ask of disks: row i of each is disk i.
#[derive(Clone, Copy)]
pub struct Disks<'a> {
    /// Displacement (m) and velocity (m/s).
    pub at: &'a [[f64; 2]],
    pub velocity: &'a [[f64; 2]],
    /// r ω (m/s); not asked for without friction.
    pub turn: &'a [f64],
}

/// The contacts of a section.
pub struct Sweep<'a, const TURNING: bool, const SPRING: bool> {
    pub lines: &'a Lines,
    pub disks: Disks<'a>,
    pub pair_laws: &'a [PairLaw<SpringDashpot>],
    pub pair_law: &'a [u32],
    pub reduced: &'a [f64],
    pub piece: Piece<'a, 2, ()>,
    pub step: f64,
}

/// Contacts in a block.
const BLOCK: usize = 64;

/// What is known of a block of pairs, and what comes of it.
struct Block {
    shift: [[f64; BLOCK]; 2],
    approach: [[f64; BLOCK]; 2],
    turn: [f64; BLOCK],
    force: [[f64; BLOCK]; 2],
    /// The part of the force that is an impulse; kept only where contacts begin and end with a jump.
    excess: [[f64; BLOCK]; 2],
    twist: [f64; BLOCK],
}

impl<const TURNING: bool, const SPRING: bool> Kernel for Sweep<'_, TURNING, SPRING> {
    type Output = ();

    #[inline(always)]
    fn run<V: Lanes>(mut self) {
        let zero = [0.0; BLOCK];
        let mut block = Block {
            shift: [zero; 2],
            approach: [zero; 2],
            turn: zero,
            force: [zero; 2],
            excess: [zero; 2],
            twist: zero,
        };
        let count = self.piece.account.overlap.len();
        let mut begin = 0;
        while begin < count {
            let size = BLOCK.min(count - begin);
            self.gather(begin, size, &mut block);
            let mut n = 0;
            while n + V::LANES <= size {
                self.react::<V>(begin + n, n, &mut block);
                n += V::LANES;
            }
            while n < size {
                self.react::<f64>(begin + n, n, &mut block);
                n += 1;
            }
            self.give(begin, size, &block);
            begin += size;
        }
        if TURNING {
            spins::multiply::<2>(self.piece.twist, self.piece.lever);
        }
    }
}

impl<const TURNING: bool, const SPRING: bool> Sweep<'_, TURNING, SPRING> {
    #[inline(always)]
    fn gather(&self, begin: usize, size: usize, block: &mut Block) {
        let ends = &self.lines.ends[self.piece.first + begin..][..size];
        // Of one length, so that an index is held against it once.
        let Disks { at, velocity, turn } = self.disks;
        let (velocity, turn) = (&velocity[..at.len()], if TURNING { &turn[..at.len()] } else { turn });
        for n in 0..size {
            let [p, q] = [ends[n][0] as usize, ends[n][1] as usize];
            for k in 0..2 {
                block.shift[k][n] = at[q][k] - at[p][k];
                block.approach[k][n] = velocity[p][k] - velocity[q][k];
            }
            if TURNING {
                block.turn[n] = turn[p] + turn[q];
            }
        }
    }

    /// γ or η, μ, k_t and γ_t of contacts from c on.
    #[inline(always)]
    fn constants<V: Lanes>(&self, c: usize) -> [V; 4] {
        let places = &self.pair_law[c..][..V::LANES];
        let of = &self.pair_laws[places[0] as usize];
        let mut constants = [
            V::splat(of.normal.loss.number()),
            V::splat(of.slip.coefficient),
            V::splat(of.slip.stiffness),
            V::splat(of.slip.rate),
        ];
        let mut alike = true;
        for lane in 1..V::LANES {
            alike &= places[lane] == places[0];
        }
        if !alike {
            let mut columns = [[0.0; 8]; 4];
            for lane in 0..V::LANES {
                let of = &self.pair_laws[places[lane] as usize];
                columns[0][lane] = of.normal.loss.number();
                columns[1][lane] = of.slip.coefficient;
                columns[2][lane] = of.slip.stiffness;
                columns[3][lane] = of.slip.rate;
            }
            for k in 0..4 {
                constants[k] = V::load(&columns[k]);
            }
        }
        constants
    }

    /// Contacts of the rows from c on, which stand from place n on in their block.
    #[inline(always)]
    fn react<V: Lanes>(&mut self, c: usize, n: usize, block: &mut Block) {
        let (line, zero, half) = (self.piece.first + c, V::splat(0.0), V::splat(0.5));
        let lines = self.lines;
        let offset = [V::load(&lines.offset[0][line..]), V::load(&lines.offset[1][line..])];
        let shift = [V::load(&block.shift[0][n..]), V::load(&block.shift[1][n..])];
        let reach = V::load(&lines.reach[line..]);
        let (apart, excess) = between(&offset, &shift, V::load(&lines.gap[line..]));
        let closed = (V::splat(2.0 * CLOSED) * reach * reach).lt(excess);
        let before = V::load(&self.piece.account.overlap[c..]);
        if !V::any(V::or(closed, zero.lt(before))) {
            zero.store(&mut block.force[0][n..]);
            zero.store(&mut block.force[1][n..]);
            zero.store(&mut block.excess[0][n..]);
            zero.store(&mut block.excess[1][n..]);
            zero.store(&mut block.twist[n..]);
            return;
        }
        let approach = [V::load(&block.approach[0][n..]), V::load(&block.approach[1][n..])];
        let turn = [zero, zero, V::load(&block.turn[n..])];
        let meeting = meet::<V, 2>((&apart, excess), reach, &approach, &turn);
        let [loss, coefficient, stiffness, slide_rate] = self.constants::<V>(line);
        let reduced = V::load(&self.reduced[line..]);
        // Stiffness, cut and the kind of loss are the same at all contacts of a law book.
        let law = &self.pair_laws[0].normal;
        let force_before = V::load(&self.piece.account.force[c..]);
        let exact = law.loss.is_exact();
        let damping = if exact { loss * (V::splat(law.stiffness) * reduced).sqrt() } else { loss * reduced };
        let mut push = law.push(meeting.overlap, meeting.closing_speed, damping);
        let (mut acts, mut from, mut last, mut release) = (push, force_before, zero, [zero; 2]);
        if exact {
            let old = zero.lt(before);
            let (begins, force, onset) =
                law.begin_all(meeting.overlap, meeting.closing_speed, (damping, reduced), self.step);
            (acts, from) = (V::select(old, push, begins), V::select(old, force_before, onset));
            push = V::select(old, push, force);
            let ended = law.end_all(before, force_before, -meeting.overlap, meeting.closing_speed, damping);
            let parting = V::select(old, ended.acts, zero);
            release = [parting * meeting.normal[0], parting * meeting.normal[1]];
            last = V::select(old, ended.last, zero);
            for k in 0..2 {
                let begun = (acts - push) * meeting.normal[k];
                V::select(closed, begun, release[k]).store(&mut block.excess[k][n..]);
            }
        }
        let mut force = [acts * meeting.normal[0], acts * meeting.normal[1]];
        let (mut twist, mut power) = (zero, zero);
        if TURNING {
            let grip = Grip { coefficient, stiffness, damping: slide_rate * reduced };
            let mut stretch = [zero; 2];
            if SPRING {
                stretch = [V::load(&self.piece.stretch[0][c..]), V::load(&self.piece.stretch[1][c..])];
            }
            let rub = grip.rub::<SPRING>(&meeting, push, &mut stretch, self.step);
            if SPRING {
                V::select(closed, stretch[0], zero).store(&mut self.piece.stretch[0][c..]);
                V::select(closed, stretch[1], zero).store(&mut self.piece.stretch[1][c..]);
            }
            power = V::select(closed, rub.power, zero);
            force = [force[0] + rub.drag[0], force[1] + rub.drag[1]];
            twist = rub.twist;
        }
        V::select(closed, force[0], release[0]).store(&mut block.force[0][n..]);
        V::select(closed, force[1], release[1]).store(&mut block.force[1][n..]);
        V::select(closed, twist, zero).store(&mut block.twist[n..]);
        // As `Account::push` and `rub`; an open contact has neither overlap nor force nor power.
        let overlap = V::select(closed, meeting.overlap, zero);
        let account = &mut self.piece.account;
        let work = half * (from + V::select(closed, push, last)) * (overlap - before);
        let push = V::select(closed, push, zero);
        (V::load(&account.work[c..]) + work).store(&mut account.work[c..]);
        overlap.store(&mut account.overlap[c..]);
        push.store(&mut account.force[c..]);
        if TURNING {
            let rubbed = V::splat(0.5 * self.step) * (V::load(&account.power[c..]) + power);
            (V::load(&account.friction_work[c..]) + rubbed).store(&mut account.friction_work[c..]);
            power.store(&mut account.power[c..]);
        }
    }

    #[inline(always)]
    fn give(&mut self, begin: usize, size: usize, block: &Block) {
        let Piece { first, first_sphere, force, twist, spill, excess, .. } = &mut self.piece;
        let ends = &self.lines.ends[*first + begin..][..size];
        if self.pair_laws[0].normal.loss.is_exact() {
            for n in 0..size {
                let beyond = [block.excess[0][n], block.excess[1][n]];
                if beyond != [0.0; 2] {
                    excess.extend(Excess::of_pair(ends[n], beyond));
                }
            }
        }
        let twist = &mut twist[..force.len()];
        for n in 0..size {
            let [a, b] = ends[n].map(|end| end as usize - *first_sphere);
            for k in 0..2 {
                force[a][k] -= block.force[k][n];
            }
            if TURNING {
                twist[a] += block.twist[n];
            }
            if b < force.len() {
                for k in 0..2 {
                    force[b][k] += block.force[k][n];
                }
                if TURNING {
                    twist[b] += block.twist[n];
                }
            } else {
                let force = [block.force[0][n], block.force[1][n]];
                spill.push(Spill { sphere: ends[n][1], force, twist: [0.0, 0.0, block.twist[n]] });
            }
        }
    }
}
