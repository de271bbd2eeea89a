//! Contacts of spheres under laws of materials, several side by side in the lanes of a vector register, in the plane and in space.
//!
//! What the spheres do stands in lines of their own, made once a step, so that a contact reads one or two lines of memory an end; forces are summed up in rows
//! that a register takes at once. The physics is that of one contact at a time (`react`, `friction`), and so are the bits.

use crate::contact::{AnyLaw, Asked, Hertz, History, LaneLaw as _, LawKind};
use crate::dem::rig::bodies::{Bodies, cross, only, times};
use crate::dem::rig::law::{End, PairLaw, Slip, SolidLaw};
use crate::dem::rig::pairs::Near;
use crate::dem::rig::spins::Spins;
use crate::dem::share::{cut, pieces};
use crate::real::{Kernel, Lanes, fetch_ahead};

use super::friction::{Coulomb, coulomb};
use super::react::{CLOSED, Meeting, Predicted, between, meet, since, slid};
use super::sections::{Piece, Spill};

/// Kinds of contacts whose numbers registers hold at once; where there are more, they are read from rows.
const KINDS: usize = 16;

/// So many contacts ahead memory is asked for what they remember: it lies in more rows than a processor follows by itself.
const AHEAD: usize = 32;

/// Numbers of a kind: the sum of radii, both radii, the first number of its law; its friction: μ, k_t's two parts, γ_t.
const NUMBERS: usize = 8;

/// The laws of all pairs, if they are of one name each with numbers of its own.
#[derive(Default)]
pub struct Looked {
    /// Numbers of each kind of contact, as rows; and, where there are few kinds, as tables.
    kinds: Vec<[[f64; 4]; NUMBERS / 4]>,
    tables: Vec<[f64; KINDS]>,
    /// The kind of each contact then.
    place: Vec<u8>,
    /// The numbers of each kind's law, with which it is, behind those of another; as tables where there are few.
    numbers: Vec<f64>,
    of_law: Vec<[f64; KINDS]>,
    /// Whether the law is Hertz's, which asks for its number and the overlap alone.
    hertz: bool,
    /// Whether friction has a dashpot anywhere.
    damped: bool,
    /// Room for what spheres do.
    pub lines: Vec<Line>,
}

impl Looked {
    /// Of pairs of such spheres whose laws stand in these places; none where laws differ by more than their numbers, or friction is more than one spring.
    pub fn of<const D: usize>(
        pair_laws: &[PairLaw<SolidLaw>],
        pair_law: &[u32],
        near: &[Near<D>],
        ends: &[End],
    ) -> Option<Self> {
        let mut radii: Vec<Option<[f64; 2]>> = vec![None; pair_laws.len()];
        for (&place, pair) in pair_law.iter().zip(near) {
            radii[place as usize].get_or_insert_with(|| pair.ends.map(|end| ends[end as usize].radius));
        }
        let used = || pair_laws.iter().zip(&radii).filter(|(_, radii)| radii.is_some()).map(|(pair_law, _)| pair_law);
        let mut kind = None;
        for PairLaw { normal, slip } in used() {
            let SolidLaw::Named(law) = normal else { return None };
            if *kind.get_or_insert(law.kind()) != law.kind() || slip.spread || slip.rolling > 0.0 {
                return None;
            }
        }
        let mut looked = Self {
            damped: used().any(|pair_law| pair_law.slip.rate > 0.0),
            hertz: kind == Some(LawKind::Hertz),
            ..Self::default()
        };
        for (PairLaw { normal, slip }, radii) in pair_laws.iter().zip(radii) {
            let of_law = match normal {
                SolidLaw::Named(law) => AnyLaw::parameters(law),
                // Of a flat, which no pair has.
                SolidLaw::Tabulated(_) | SolidLaw::SpringDashpot(_) => vec![0.0; AnyLaw::PARAMETERS],
            };
            let ([a, b], Slip { coefficient, stiffness, mindlin, rate, .. }) = (radii.unwrap_or_default(), *slip);
            looked.kinds.push([[a + b, a, b, of_law[1]], [coefficient, stiffness, mindlin, rate]]);
            looked.numbers.extend(of_law);
        }
        if pair_laws.len() <= KINDS {
            let table = |number: &dyn Fn(usize) -> f64| {
                std::array::from_fn(|k| if k < pair_laws.len() { number(k) } else { 0.0 })
            };
            looked.tables = (0..NUMBERS).map(|n| table(&|k| looked.kinds[k][n / 4][n % 4])).collect();
            looked.of_law =
                (0..AnyLaw::PARAMETERS).map(|n| table(&|k| looked.numbers[k * AnyLaw::PARAMETERS + n])).collect();
            // The law's number is read where the first kind stands, which may be that of a flat, or of pairs that are no longer near.
            looked.of_law[0] = [kind.map_or(0.0, |kind| f64::from(kind as u8)); KINDS];
            looked.place = pair_law.iter().map(|&place| place as u8).collect();
        }
        Some(looked)
    }

    /// Four numbers of each of the contacts from place c on.
    #[inline(always)]
    fn four<V: Lanes, const GROUP: usize>(&self, c: usize, pair_law: &[u32]) -> [V; 4] {
        if self.tables.is_empty() {
            let mut rows = [&[0.0; 4]; 8];
            for lane in 0..V::LANES {
                rows[lane] = &self.kinds[pair_law[c + lane] as usize][GROUP];
            }
            return V::columns(&rows);
        }
        let place = V::index(&self.place[c..]);
        let tables = &self.tables[4 * GROUP..][..4];
        [
            V::lookup(&tables[0], place),
            V::lookup(&tables[1], place),
            V::lookup(&tables[2], place),
            V::lookup(&tables[3], place),
        ]
    }
}

/// What a sphere does, in a line of memory of its own: displacement (m) and velocity (m/s); with friction, in a second line, the mean velocity over the step and
/// the mean spin (1/s). In the last places of the last three groups stands the spin.
#[derive(Clone, Copy, Default)]
#[repr(align(64))]
pub struct Line([[f64; 4]; 2]);

/// Lines of a sphere without friction, and with it.
pub const STRAIGHT: usize = 1;
pub const TURNING: usize = 2;

/// Fills lines with bodies that are predicted to move so.
pub fn fill<const D: usize, const LINES: usize>(
    bodies: &Bodies<D>,
    predicted: Predicted<'_, D>,
    lines: &mut Vec<Line>,
) {
    let Predicted { velocity, turn, .. } = predicted;
    lines.resize(LINES * velocity.len(), Line::default());
    let mut left = &mut lines[..];
    let take = |range: std::ops::Range<usize>| (cut(&mut left, LINES * range.len()), range.start);
    pieces(velocity.len(), take, |(lines, first)| {
        for (n, lines) in lines.as_chunks_mut::<LINES>().0.iter_mut().enumerate() {
            let i = first + n;
            lines[0].0[0][..D].copy_from_slice(&bodies.displacement[i]);
            lines[0].0[1][..D].copy_from_slice(&velocity[i]);
            if LINES == TURNING {
                let (now, before) = (turn.get(i), bodies.spin.get(i));
                let [mean, spin] = &mut lines[1].0;
                for k in 0..D {
                    mean[k] = 0.5 * (velocity[i][k] + bodies.velocity[i][k]);
                }
                for k in 0..3 {
                    spin[k] = 0.5 * (now[k] + before[k]);
                }
                (mean[3], spin[3]) = (now[1], now[2]);
                lines[0].0[1][3] = now[0];
            }
        }
    });
}

/// The contacts of a section.
pub struct Sweep<'a, const D: usize, const LINES: usize> {
    pub near: &'a [Near<D>],
    pub lines: &'a [[Line; LINES]],
    pub looked: &'a Looked,
    pub pair_law: &'a [u32],
    pub reduced: &'a [f64],
    /// See [`Contacts`](super::Contacts); may be empty.
    pub share: &'a [f64],
    pub piece: Piece<'a, D, [f64; 3]>,
    pub step: f64,
}

/// Sums over the contacts of each sphere of a section, and last those of spheres of other sections: force (N), couple (N m).
struct Felt {
    force: Vec<[f64; 4]>,
    couple: Vec<[f64; 4]>,
}

impl<const D: usize, const LINES: usize> Kernel for Sweep<'_, D, LINES> {
    type Output = ();

    #[inline(always)]
    fn run<V: Lanes>(mut self) {
        let count = self.piece.account.overlap.len();
        let rows = |any: bool| vec![[0.0; 4]; if any { self.piece.force.len() + 1 } else { 0 }];
        let mut felt = Felt { force: rows(true), couple: rows(LINES == TURNING) };
        let mut n = 0;
        while V::LANES > 1 && n + V::LANES <= count {
            self.fetch(n + AHEAD, V::LANES);
            self.react::<V>(n, &mut felt);
            n += V::LANES;
        }
        while n < count {
            self.react_one(n, &mut felt);
            n += 1;
        }
        let Piece { force, twist, .. } = &mut self.piece;
        for (sum, felt) in force.iter_mut().zip(&felt.force) {
            sum.copy_from_slice(&felt[..D]);
        }
        if LINES == TURNING {
            let row = Spins::<D>::ROW;
            for (sum, felt) in twist.chunks_exact_mut(row).zip(&felt.couple) {
                sum.copy_from_slice(if D == 2 { &felt[2..3] } else { &felt[..row] });
            }
        }
    }
}

/// The same group of some spheres.
#[inline(always)]
fn group<'a, V: Lanes, const LINES: usize>(of: &[&'a [Line; LINES]; 8], group: usize) -> [&'a [f64; 4]; 8] {
    let mut rows = [&of[0][group / 2].0[group % 2]; 8];
    for lane in 0..V::LANES {
        rows[lane] = &of[lane][group / 2].0[group % 2];
    }
    rows
}

/// The first components of four.
#[inline(always)]
fn vector<V: Lanes, const D: usize>(wide: &[V; 4]) -> [V; D] {
    let mut vector = [wide[0]; D];
    vector.copy_from_slice(&wide[..D]);
    vector
}

/// Four numbers of which the last are zero.
#[inline(always)]
fn widened<V: Lanes, const D: usize>(vector: &[V; D]) -> [V; 4] {
    let mut wide = [V::splat(0.0); 4];
    wide[..D].copy_from_slice(vector);
    wide
}

/// a₁ ω₁ + a₂ ω₂
#[inline(always)]
fn together<V: Lanes>(arms: &[V; 2], first: &[V; 3], second: &[V; 3]) -> [V; 3] {
    let mut sum = [arms[0]; 3];
    for k in 0..3 {
        sum[k] = arms[0] * first[k] + arms[1] * second[k];
    }
    sum
}

impl<const D: usize, const LINES: usize> Sweep<'_, D, LINES> {
    /// Asks for what contacts from place n on will read.
    #[inline(always)]
    fn fetch(&self, n: usize, lanes: usize) {
        let (c, Piece { account, memory, stretch, .. }) = (self.piece.first + n, &self.piece);
        fetch_ahead(self.near, c, lanes * size_of::<Near<D>>());
        fetch_ahead(memory, n, lanes * size_of::<[f64; 3]>());
        fetch_ahead(account.overlap, n, 8 * lanes);
        fetch_ahead(account.force, n, 8 * lanes);
        fetch_ahead(account.work, n, 8 * lanes);
        if LINES == TURNING {
            fetch_ahead(account.friction_work, n, 8 * lanes);
            for k in 0..D {
                fetch_ahead(stretch[k], n, 8 * lanes);
            }
        }
    }

    /// The contact in place n of the section, in code that all widths share.
    #[inline(never)]
    fn react_one(&mut self, n: usize, felt: &mut Felt) {
        self.react::<f64>(n, felt);
    }

    /// The law's numbers of contacts from place c on, where there are many kinds.
    #[inline(never)]
    fn own_tables(&self, c: usize, lanes: usize) -> Vec<[f64; KINDS]> {
        let mut own = vec![[0.0; KINDS]; AnyLaw::PARAMETERS];
        for lane in 0..lanes {
            let from = self.pair_law[c + lane] as usize * AnyLaw::PARAMETERS;
            for (table, number) in own.iter_mut().zip(&self.looked.numbers[from..]) {
                table[lane] = *number;
            }
        }
        own
    }

    /// The force of contacts from place c on, and what they remember then.
    #[inline(always)]
    fn responded<V: Lanes>(&self, c: usize, (overlap, closing_speed): (V, V), history: &History<V>) -> (V, History<V>) {
        if self.looked.tables.is_empty() {
            let own = self.own_tables(c, V::LANES);
            let place = V::index(&[0, 1, 2, 3, 4, 5, 6, 7]);
            return AnyLaw::respond_at(&Asked { tables: &own, place, overlap, closing_speed, history });
        }
        let place = V::index(&self.looked.place[c..]);
        AnyLaw::respond_at(&Asked { tables: &self.looked.of_law, place, overlap, closing_speed, history })
    }

    /// Contacts from place n of the section on.
    #[inline(always)]
    fn react<V: Lanes>(&mut self, n: usize, felt: &mut Felt) {
        let (c, zero, half) = (self.piece.first + n, V::splat(0.0), V::splat(0.5));
        let near = &self.near[c..][..V::LANES];
        let (mut first, mut second, mut rest) = ([&self.lines[0]; 8], [&self.lines[0]; 8], [&[0.0; 4]; 8]);
        for lane in 0..V::LANES {
            let [a, b] = near[lane].ends;
            (first[lane], second[lane]) = (&self.lines[a as usize], &self.lines[b as usize]);
            rest[lane] = &near[lane].rest;
        }
        let shift = V::columns_apart(&group::<V, LINES>(&second, 0), &group::<V, LINES>(&first, 0));
        let rest = V::columns(&rest);
        let [reach, first_radius, second_radius, number] = self.looked.four::<V, 0>(c, self.pair_law);
        let (apart_now, excess) = between(&vector::<V, D>(&rest), &vector(&shift), rest[3]);
        let closed = (V::splat(2.0 * CLOSED) * reach * reach).lt(excess);
        let overlap_before = V::load(&self.piece.account.overlap[n..]);
        let was = zero.lt(overlap_before);
        if !V::any(V::or(closed, was)) {
            return;
        }
        let mut approach = [zero; D];
        // Hertz's law asks for no speed, and friction only where a contact has just closed.
        if !self.looked.hertz || (LINES == TURNING && (self.looked.damped || !V::all(was))) {
            let velocity = V::columns_apart(&group::<V, LINES>(&first, 1), &group::<V, LINES>(&second, 1));
            approach = vector(&velocity);
        }
        let mut meeting = meet::<V, D>((&apart_now, excess), reach, &approach, &[zero; 3]);

        let Meeting { mut overlap, closing_speed, normal, .. } = meeting;
        let [overlap_max, force_max, own_memory] = V::load_threes(self.piece.memory[n..][..V::LANES].as_flattened());
        let history = History { overlap_max, force_max, own: own_memory };
        let (push, after) = if self.looked.hertz {
            // Friction asks for the same root.
            overlap = V::select(closed, overlap, zero);
            let force = Hertz { coefficient: number }.of_root(overlap, overlap.sqrt());
            (force, history.advanced(overlap, force))
        } else {
            self.responded(c, (overlap, closing_speed), &history)
        };
        // Only closed contacts change their memories, and under Hertz's law only those that are pressed as never before.
        let changes = V::or(overlap_max.lt(after.overlap_max), force_max.lt(after.force_max));
        if !self.looked.hertz || V::any(V::and(closed, changes)) {
            let after = [
                V::select(closed, after.overlap_max, overlap_max),
                V::select(closed, after.force_max, force_max),
                V::select(closed, after.own, own_memory),
            ];
            V::store_threes(&after, self.piece.memory[n..][..V::LANES].as_flattened_mut());
        }

        let push = V::select(closed, push, zero);
        let overlap = V::select(closed, overlap, zero);
        let force_before = V::load(&self.piece.account.force[n..]);
        let account = &mut self.piece.account;
        let work = V::load(&account.work[n..]) + half * (force_before + push) * (overlap - overlap_before);
        work.store(&mut account.work[n..]);
        overlap.store(&mut account.overlap[n..]);
        push.store(&mut account.force[n..]);
        let mut force = times(&normal, push);
        let (mut twist, mut arms) = ([zero; 3], [zero; 2]);
        if LINES == TURNING {
            let [coefficient, stiffness, mindlin, rate] = self.looked.four::<V, 1>(c, self.pair_law);
            let slip = Coulomb { coefficient, stiffness, mindlin };
            arms = [first_radius - half * overlap, second_radius - half * overlap];
            let lost = V::load(&self.piece.account.friction_work[n..]);
            let mut stretch = [zero; D];
            for k in 0..D {
                stretch[k] = V::load(&self.piece.stretch[k][n..]);
            }
            let velocity = V::columns_apart(&group::<V, LINES>(&first, 2), &group::<V, LINES>(&second, 2));
            let mean: [V; D] = vector(&velocity);
            let spins = (V::columns(&group::<V, LINES>(&first, 3)), V::columns(&group::<V, LINES>(&second, 3)));
            let turned = together(&arms, &vector(&spins.0), &vector(&spins.1));
            let mut way = slid((&apart_now, meeting.inverse), &mean, &turned, self.step);
            if !V::all(was) {
                way = times(&way, since(overlap_before, overlap, closing_speed, self.step));
            }
            let before = ([overlap_before, V::select(was, force_before, zero)], &stretch);
            let mut rubbed = coulomb(&slip, (overlap, &normal), (push, &way), before);
            let power_before = if self.looked.damped { V::load(&self.piece.account.power[n..]) } else { zero };
            if self.looked.damped {
                let first_of = |k: usize| V::columns(&group::<V, LINES>(&first, k))[3];
                let second_of = |k: usize| V::columns(&group::<V, LINES>(&second, k))[3];
                let spin = [first_of(1), first_of(2), first_of(3)];
                let other = [second_of(1), second_of(2), second_of(3)];
                meeting.turn = together(&arms, &spin, &other);
                let damping = rate * V::load(&self.reduced[c..]);
                let cap = slip.coefficient * push.max(-push);
                let mut damped = rubbed;
                damped.damp(cap, damping, &meeting.sliding(), (power_before, self.step));
                let is_damped = zero.lt(rate);
                for k in 0..D {
                    rubbed.drag[k] = V::select(is_damped, damped.drag[k], rubbed.drag[k]);
                }
                rubbed.work = V::select(is_damped, damped.work, rubbed.work);
                rubbed.power = V::select(is_damped, damped.power, rubbed.power);
            }
            // Where the coefficient is zero there is no friction, nor where a contact has opened: its spring is lost, and its dashpot at rest.
            let rubs = V::and(closed, zero.lt(slip.coefficient));
            for k in 0..D {
                force[k] = force[k] + V::select(rubs, rubbed.drag[k], zero);
                let kept = V::select(closed, stretch[k], zero);
                V::select(rubs, rubbed.stretch[k], kept).store(&mut self.piece.stretch[k][n..]);
            }
            twist = only(rubs, &cross(&rubbed.drag, &normal));
            let ends = lost + V::splat(0.5 * self.step) * power_before;
            let lost = V::select(rubs, lost + rubbed.work, V::select(closed, lost, ends));
            lost.store(&mut self.piece.account.friction_work[n..]);
            if self.looked.damped {
                V::select(rubs, rubbed.power, V::select(closed, power_before, zero))
                    .store(&mut self.piece.account.power[n..]);
            }
        }
        if !self.share.is_empty() {
            let share = V::load(&self.share[c..]);
            (force, twist) = (times(&force, share), times(&twist, share));
        }
        self.give(near, (force, twist, arms), felt);
    }

    /// Gives the ends their forces and couples, in the order of the contacts.
    #[inline(always)]
    fn give<V: Lanes>(&mut self, near: &[Near<D>], (force, twist, arms): ([V; D], [V; 3], [V; 2]), felt: &mut Felt) {
        let (first, beyond) = (self.piece.first_sphere, self.piece.force.len());
        let (mut places, mut spills) = ([[0; 2]; 8], false);
        for lane in 0..V::LANES {
            let [a, b] = near[lane].ends;
            let b = b as usize - first;
            places[lane] = [a as usize - first, b.min(beyond)];
            spills |= b >= beyond;
        }
        V::exchange(&widened(&force), &places, &mut felt.force);
        let couples = [times(&twist, arms[0]), times(&twist, arms[1])];
        if LINES == TURNING {
            V::add_to_rows(&widened(&couples[0]), &widened(&couples[1]), &places, &mut felt.couple);
        }
        if spills {
            for lane in (0..V::LANES).filter(|&lane| places[lane][1] == beyond) {
                let (mut pushed, mut turned) = ([0.0; D], [0.0; 3]);
                for k in 0..D {
                    pushed[k] = force[k].lane(lane);
                }
                for k in 0..3 {
                    turned[k] = couples[1][k].lane(lane);
                }
                self.piece.spill.push(Spill { sphere: near[lane].ends[1], force: pushed, twist: turned });
            }
        }
    }
}
