//! Contacts of spheres under laws of materials, several side by side in the lanes of a vector register, in the plane and in space.
//!
//! What the spheres do stands in rows of their own, made once a step, so that a contact reads a few lines of memory an end. The physics is that of one
//! contact at a time (`react`, `friction`), and so are the bits.

use crate::contact::{AnyLaw, Asked, History, LaneLaw as _};
use crate::dem::rig::bodies::{Bodies, cross, only, times};
use crate::dem::rig::law::{PairLaw, Slip, SolidLaw};
use crate::dem::rig::pairs::Near;
use crate::dem::rig::spins;
use crate::dem::share::rows;
use crate::real::{Job, Kernel, Lanes};

use super::friction::{Coulomb, coulomb};
use super::react::{CLOSED, Meeting, Predicted, between, meet, since, slid};
use super::sections::{Piece, Spill};

/// Kinds of contacts whose numbers registers hold at once; where there are more, each group of contacts has tables of its own.
const KINDS: usize = 16;

/// Numbers of a kind's law, with which it is, and of its friction: μ, k_t's two parts, γ_t.
const NUMBERS: usize = AnyLaw::PARAMETERS + 4;

/// The laws of all pairs, if they are of one name each with numbers of its own.
#[derive(Default)]
pub struct Looked {
    /// Number k of each kind, where there are few kinds.
    tables: Vec<[f64; KINDS]>,
    /// The kind of each contact then.
    place: Vec<u8>,
    /// The numbers of each kind behind those of another, where there are many.
    numbers: Vec<f64>,
    /// Whether friction has a dashpot anywhere.
    pub damped: bool,
}

impl Looked {
    /// Of pairs whose laws stand in these places; none where laws differ by more than their numbers, or friction is more than one spring.
    pub fn of(pair_laws: &[PairLaw<SolidLaw>], pair_law: &[u32]) -> Option<Self> {
        let mut used = vec![false; pair_laws.len()];
        pair_law.iter().for_each(|&place| used[place as usize] = true);
        let used = || pair_laws.iter().zip(&used).filter(|(_, used)| **used).map(|(pair_law, _)| pair_law);
        let mut kind = None;
        for PairLaw { normal, slip } in used() {
            let SolidLaw::Named(law) = normal else { return None };
            if *kind.get_or_insert(law.kind()) != law.kind() || slip.spread || slip.rolling > 0.0 {
                return None;
            }
        }
        let mut looked = Self { damped: used().any(|pair_law| pair_law.slip.rate > 0.0), ..Self::default() };
        let numbers = pair_laws.iter().flat_map(numbers);
        if pair_laws.len() > KINDS {
            looked.numbers = numbers.collect();
            return Some(looked);
        }
        looked.tables = vec![[0.0; KINDS]; NUMBERS];
        for (n, number) in numbers.enumerate() {
            looked.tables[n % NUMBERS][n / NUMBERS] = number;
        }
        // The law's number is read where the first kind stands, which may be that of a flat, or of pairs that are no longer near.
        looked.tables[0] = [kind.map_or(0.0, |kind| f64::from(kind as u8)); KINDS];
        looked.place = pair_law.iter().map(|&place| place as u8).collect();
        Some(looked)
    }
}

/// The numbers of a kind.
fn numbers(PairLaw { normal, slip }: &PairLaw<SolidLaw>) -> Vec<f64> {
    let mut numbers = match normal {
        SolidLaw::Named(law) => AnyLaw::parameters(law),
        // Of a flat, which no pair has.
        SolidLaw::Tabulated(_) | SolidLaw::SpringDashpot(_) => vec![0.0; AnyLaw::PARAMETERS],
    };
    let Slip { coefficient, stiffness, mindlin, rate, .. } = *slip;
    numbers.extend([coefficient, stiffness, mindlin, rate]);
    numbers
}

/// What spheres do, a row each of groups of four: displacement (m) and radius (m); predicted velocity (m/s) and spin about x (1/s); with friction the
/// mean velocity over the step and the spin about y; the mean spin and the spin about z.
pub type Rows<const GROUPS: usize> = [[f64; 4]; GROUPS];

/// Groups without friction, and with it.
pub const STRAIGHT: usize = 2;
pub const TURNING: usize = 4;

/// Rows of bodies that are predicted to move so.
pub fn rows_of<const D: usize, const GROUPS: usize>(
    bodies: &Bodies<D>,
    radius: &[f64],
    predicted: Predicted<'_, D>,
) -> Vec<Rows<GROUPS>> {
    let Predicted { velocity, turn, .. } = predicted;
    rows(velocity.len(), |i| {
        let mut row = [[0.0; 4]; GROUPS];
        row[0][..D].copy_from_slice(&bodies.displacement[i]);
        row[0][3] = radius[i];
        row[1][..D].copy_from_slice(&velocity[i]);
        if GROUPS == TURNING {
            let (now, before) = (turn.get(i), bodies.spin.get(i));
            for k in 0..D {
                row[2][k] = 0.5 * (velocity[i][k] + bodies.velocity[i][k]);
            }
            for k in 0..3 {
                row[3][k] = 0.5 * (now[k] + before[k]);
                row[1 + k][3] = now[k];
            }
        }
        row
    })
}

/// The contacts of a section.
pub struct Sweep<'a, const D: usize, const GROUPS: usize> {
    pub near: &'a [Near<D>],
    pub rows: &'a [Rows<GROUPS>],
    pub looked: &'a Looked,
    pub pair_law: &'a [u32],
    pub reduced: &'a [f64],
    /// See [`Contacts`](super::Contacts); may be empty.
    pub share: &'a [f64],
    pub piece: Piece<'a, D, [f64; 3]>,
    pub step: f64,
}

impl<const D: usize, const GROUPS: usize> Kernel for Sweep<'_, D, GROUPS> {
    type Output = ();

    #[inline(always)]
    fn run<V: Lanes>(mut self) {
        let count = self.piece.account.overlap.len();
        let mut own = vec![[0.0; KINDS]; if self.looked.tables.is_empty() { NUMBERS } else { 0 }];
        let mut n = 0;
        while V::LANES > 1 && n + V::LANES <= count {
            self.react::<V>(n, &mut own);
            n += V::LANES;
        }
        while n < count {
            self.react_one(n, &mut own);
            n += 1;
        }
    }
}

/// The law of contacts side by side, compiled once for each width and not in every sweep.
struct Responded<'a, V: Lanes>(Asked<'a, V>);

impl<V: Lanes> Job for Responded<'_, V> {
    type Output = (V, History<V>);
    #[inline(always)]
    fn run(self) -> Self::Output {
        AnyLaw::respond_at(&self.0)
    }
}

/// As many numbers as any register holds, and more.
type Row = [f64; 8];

/// What stands in a lane of columns.
#[inline(always)]
fn row(columns: &[Row; 3], lane: usize) -> [f64; 3] {
    [columns[0][lane], columns[1][lane], columns[2][lane]]
}

/// A group of rows as columns.
#[inline(always)]
fn group<V: Lanes, const GROUPS: usize>(rows: &[&Rows<GROUPS>; 8], group: usize) -> [V; 4] {
    let mut of = [&[0.0; 4]; 8];
    for lane in 0..V::LANES {
        of[lane] = &rows[lane][group];
    }
    V::columns(&of)
}

/// The first components of four.
#[inline(always)]
fn vector<V: Lanes, const D: usize>(wide: &[V; 4]) -> [V; D] {
    let mut vector = [wide[0]; D];
    vector.copy_from_slice(&wide[..D]);
    vector
}

/// a − b
#[inline(always)]
fn apart<V: Lanes, const D: usize>(a: &[V; 4], b: &[V; 4]) -> [V; D] {
    let mut apart = vector(a);
    for k in 0..D {
        apart[k] = a[k] - b[k];
    }
    apart
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

impl<const D: usize, const GROUPS: usize> Sweep<'_, D, GROUPS> {
    /// The contact in place n of the section, in code that all widths share.
    #[inline(never)]
    fn react_one(&mut self, n: usize, own: &mut [[f64; KINDS]]) {
        self.react::<f64>(n, own);
    }

    /// Contacts from place n of the section on.
    #[inline(always)]
    fn react<V: Lanes>(&mut self, n: usize, own: &mut [[f64; KINDS]]) {
        let (c, zero, half) = (self.piece.first + n, V::splat(0.0), V::splat(0.5));
        let near = &self.near[c..][..V::LANES];
        let (mut first, mut second, mut rest) = ([&self.rows[0]; 8], [&self.rows[0]; 8], [&[0.0; 4]; 8]);
        for lane in 0..V::LANES {
            let [a, b] = near[lane].ends;
            (first[lane], second[lane]) = (&self.rows[a as usize], &self.rows[b as usize]);
            rest[lane] = &near[lane].rest;
        }
        let (from, to) = (group::<V, GROUPS>(&first, 0), group::<V, GROUPS>(&second, 0));
        let rest = V::columns(&rest);
        let reach = from[3] + to[3];
        let (apart_now, excess) = between(&vector(&rest), &apart(&to, &from), rest[3]);
        let closed = (V::splat(2.0 * CLOSED) * reach * reach).lt(excess);
        let overlap_before = V::load(&self.piece.account.overlap[n..]);
        let was = zero.lt(overlap_before);
        if !V::any(V::or(closed, was)) {
            return;
        }
        let velocity = (group::<V, GROUPS>(&first, 1), group::<V, GROUPS>(&second, 1));
        let approach: [V; D] = apart(&velocity.0, &velocity.1);
        let mut meeting = meet::<V, D>((&apart_now, excess), reach, &approach, &[zero; 3]);

        let places = &self.pair_law[c..][..V::LANES];
        let (tables, place) = match self.looked.tables.is_empty() {
            false => (&self.looked.tables[..], V::index(&self.looked.place[c..])),
            true => {
                // The law's number stands first, for all.
                for lane in 0..V::LANES {
                    let numbers = &self.looked.numbers[places[lane] as usize * NUMBERS..][..NUMBERS];
                    for k in 0..NUMBERS {
                        own[k][lane] = numbers[k];
                    }
                }
                (&own[..], V::index(&[0, 1, 2, 3, 4, 5, 6, 7]))
            }
        };
        let Meeting { overlap, closing_speed, normal, .. } = meeting;
        let memories = &mut self.piece.memory[n..][..V::LANES];
        let [overlap_max, force_max, own_memory] = V::load_threes(memories.as_flattened());
        let history = History { overlap_max, force_max, own: own_memory };
        let asked = Asked { tables, place, overlap, closing_speed, history: &history };
        let (push, after) = V::outlined(Responded(asked));
        // Only closed contacts change their memories.
        let after = [
            V::select(closed, after.overlap_max, overlap_max),
            V::select(closed, after.force_max, force_max),
            V::select(closed, after.own, own_memory),
        ];
        V::store_threes(&after, memories.as_flattened_mut());

        let push = V::select(closed, push, zero);
        let overlap = V::select(closed, overlap, zero);
        let force_before = V::load(&self.piece.account.force[n..]);
        let mut force = times(&normal, push);
        let (mut twist, mut arms) = ([zero; 3], [zero; 2]);
        if GROUPS == TURNING {
            let of_friction = &tables[AnyLaw::PARAMETERS..];
            let [coefficient, stiffness, mindlin, rate] = [
                V::lookup(&of_friction[0], place),
                V::lookup(&of_friction[1], place),
                V::lookup(&of_friction[2], place),
                V::lookup(&of_friction[3], place),
            ];
            let slip = Coulomb { coefficient, stiffness, mindlin };
            arms = [from[3] - half * overlap, to[3] - half * overlap];
            let power_before = V::load(&self.piece.account.power[n..]);
            let lost = V::load(&self.piece.account.friction_work[n..]);
            let mut stretch = [zero; D];
            for k in 0..D {
                stretch[k] = V::load(&self.piece.stretch[k][n..]);
            }
            let mean_velocity = (group::<V, GROUPS>(&first, 2), group::<V, GROUPS>(&second, 2));
            let mean_spin = (group::<V, GROUPS>(&first, 3), group::<V, GROUPS>(&second, 3));
            let mean: [V; D] = apart(&mean_velocity.0, &mean_velocity.1);
            let turned = together(&arms, &vector(&mean_spin.0), &vector(&mean_spin.1));
            let way = slid(&apart_now, &mean, &turned, self.step);
            let part = since(overlap_before, overlap, closing_speed, self.step);
            let way = times(&way, part);
            let before = ([overlap_before, V::select(was, force_before, zero)], &stretch);
            let mut rubbed = coulomb(&slip, (overlap, &normal), (push, &way), before);
            if self.looked.damped {
                let spin = [velocity.0[3], mean_velocity.0[3], mean_spin.0[3]];
                let other = [velocity.1[3], mean_velocity.1[3], mean_spin.1[3]];
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
            V::select(rubs, rubbed.power, V::select(closed, power_before, zero))
                .store(&mut self.piece.account.power[n..]);
        }
        let account = &mut self.piece.account;
        let work = V::load(&account.work[n..]) + half * (force_before + push) * (overlap - overlap_before);
        work.store(&mut account.work[n..]);
        overlap.store(&mut account.overlap[n..]);
        push.store(&mut account.force[n..]);
        if !self.share.is_empty() {
            let share = V::load(&self.share[c..]);
            (force, twist) = (times(&force, share), times(&twist, share));
        }
        self.give(near, (force, twist, arms));
    }

    /// Gives the ends their forces and couples, in the order of the contacts.
    #[inline(always)]
    fn give<V: Lanes>(&mut self, near: &[Near<D>], (force, twist, arms): ([V; D], [V; 3], [V; 2])) {
        let Piece { first_sphere, force: sum, twist: couple, spill, .. } = &mut self.piece;
        let mut forces: [Row; D] = [[0.0; 8]; D];
        let mut couples: [[Row; 3]; 2] = [[[0.0; 8]; 3]; 2];
        for k in 0..D {
            force[k].store(&mut forces[k]);
        }
        if GROUPS == TURNING {
            for k in 0..3 {
                (arms[0] * twist[k]).store(&mut couples[0][k]);
                (arms[1] * twist[k]).store(&mut couples[1][k]);
            }
        }
        for lane in 0..V::LANES {
            let [a, b] = near[lane].ends;
            let (a, b) = (a as usize - *first_sphere, b as usize - *first_sphere);
            for k in 0..D {
                sum[a][k] -= forces[k][lane];
            }
            if GROUPS == TURNING {
                spins::add::<D>(couple, a, 1.0, &row(&couples[0], lane));
            }
            if b < sum.len() {
                for k in 0..D {
                    sum[b][k] += forces[k][lane];
                }
                if GROUPS == TURNING {
                    spins::add::<D>(couple, b, 1.0, &row(&couples[1], lane));
                }
            } else {
                let mut force = [0.0; D];
                for k in 0..D {
                    force[k] = forces[k][lane];
                }
                spill.push(Spill { sphere: near[lane].ends[1], force, twist: row(&couples[1], lane) });
            }
        }
    }
}
