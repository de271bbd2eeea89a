//! One step of a section or a seam: forces of contacts, and motion (`motion`), in one pass through memory.
//!
//! A row's forces are complete when the pass comes to it: its contacts with rows before it have been worked out there, those with rows after
//! it are at its own. Nothing looks at its places after that in this step, so that it is moved at once.

use std::marker::PhantomData;

use super::motion::Move;
use super::rows::{MOST_IN_ROW, Offset};
use super::section::{BLOCK, Bundle, ImageBundle, Placed, Seam, Section, Store, offset_of};
use crate::contact::{Asked, History, LaneLaw};
use crate::dem::arrival::Grain;
use crate::dem::contacts::CLOSED;
use crate::dem::sheet::numbers::Numbers;
use crate::dem::step::Coefficients;
use crate::real::{Kernel, Lanes};

/// What is the same for all sections in a step.
#[derive(Clone, Debug)]
pub struct Terms {
    pub offsets: Vec<Offset>,
    /// Sphere diameter (m).
    pub diameter: f64,
    /// A table for each number of the law.
    pub tables: Vec<[f64; 16]>,
    /// 1/m of each material (1/kg); the first is nothing.
    pub inverse_mass: [f64; 16],
    pub step: f64,
    pub coefficients: Coefficients,
    /// Steps done at the end of this step, and when that is (s).
    pub steps: u64,
    pub time: f64,
    pub grain: Grain,
    /// The load on struck spheres in this step and the next (N), along the last axis and the first.
    pub load_now: [f64; 2],
    pub load: [f64; 2],
}

/// Added to what is found beyond a bundle's last contact, so that it is none: nothing, then infinities.
const BEYOND: [f64; 2 * BLOCK] = {
    let mut beyond = [f64::INFINITY; 2 * BLOCK];
    let mut k = 0;
    while k < BLOCK {
        beyond[k] = 0.0;
        k += 1;
    }
    beyond
};

/// Zero for contacts that are there, infinite beyond; `left` are.
#[inline(always)]
pub fn beyond<V: Lanes>(left: usize) -> Option<V> {
    (left < V::LANES).then(|| V::load(&BEYOND[BLOCK - left..]))
}

/// Forces of the contacts of one bundle, before they are given to the spheres.
type Pushes = [[f64; MOST_IN_ROW]; 3];

/// Displacements and velocities of the spheres on one side.
#[derive(Clone, Copy)]
struct Side<'a> {
    x: [&'a [f64]; 3],
    velocity: [&'a [f64]; 3],
}

impl<'a> Side<'a> {
    #[inline(always)]
    fn new(x: &'a [Numbers; 3], velocity: &'a [Numbers; 3], place: u32) -> Self {
        let from = |numbers: &'a [Numbers; 3]| {
            let [x, y, z] = numbers;
            [&x.get()[place as usize..], &y.get()[place as usize..], &z.get()[place as usize..]]
        };
        Self { x: from(x), velocity: from(velocity) }
    }
}

/// Works out a bundle; takes its forces from the spheres on the first side, from place `on_a` on, and lays them by for those on the second. Says
/// whether any of its contacts is closed.
#[inline(always)]
fn work_out<V: Lanes, L: LaneLaw>(
    terms: &Terms,
    bundle: &Bundle,
    [a, b]: [Side<'_>; 2],
    store: &mut Store,
    (force, on_a): (&mut [Numbers; 3], usize),
    pushes: &mut Pushes,
) -> bool {
    let Offset { between: offset, gap_squared, weight } = *offset_of(&terms.offsets, bundle);
    let (zero, one) = (V::splat(0.0), V::splat(1.0));
    let least = V::splat(2.0 * CLOSED * terms.diameter * terms.diameter);
    let (gap, reach, weight) = (V::splat(-gap_squared), V::splat(terms.diameter), V::splat(weight));
    let rest = offset.map(V::splat);
    let twice = offset.map(|x| V::splat(2.0 * x));
    let count = bundle.count as usize;
    let mut acts = false;
    for k in (0..count).step_by(V::LANES) {
        // D² − |Δ|² with Δ = offset + shift, without the cancellation of two nearly equal squares.
        let mut excess = gap;
        let mut between = rest;
        for axis in 0..3 {
            let shift = V::load(&b.x[axis][k..]) - V::load(&a.x[axis][k..]);
            excess = excess - shift * (twice[axis] + shift);
            between[axis] = between[axis] + shift;
        }
        if let Some(none) = beyond::<V>(count - k) {
            excess = excess - none;
        }
        let closed = least.lt(excess);
        let at = store.at(bundle.slot, k);
        if !V::any(closed) {
            if store.has_account {
                open::<V>(store, at);
            }
            for push in pushes.iter_mut() {
                zero.store(&mut push[k..]);
            }
            continue;
        }
        acts = true;
        let distance = (between[0] * between[0] + between[1] * between[1] + between[2] * between[2]).sqrt();
        // One quotient for both: overlap = (D² − |Δ|²)/(D + |Δ|), and 1/|Δ| for the normal.
        let sum = reach + distance;
        let quotient = one / (sum * distance);
        let overlap = V::select(closed, excess * (quotient * distance), zero);
        let inverse = quotient * sum;
        let mut closing_speed = zero;
        for axis in 0..3 {
            between[axis] = between[axis] * inverse;
            let apart = V::load(&a.velocity[axis][k..]) - V::load(&b.velocity[axis][k..]);
            closing_speed = closing_speed + apart * between[axis];
        }
        let push = respond::<V, L>(terms, store, (bundle.slot, k), overlap, closing_speed);
        let push = V::select(closed, push, zero) * weight;
        for axis in 0..3 {
            let push = push * between[axis];
            push.store(&mut pushes[axis][k..]);
            let sum = &mut force[axis].get_mut()[on_a + k..];
            (V::load(sum) - push).store(sum);
        }
    }
    acts
}

/// The force of contacts, at most a register's; their memories advance.
#[inline(always)]
fn respond<V: Lanes, L: LaneLaw>(
    terms: &Terms,
    store: &mut Store,
    (slot, k): (u32, usize),
    overlap: V,
    closing_speed: V,
) -> V {
    let at = store.at(slot, k);
    let place = V::index(&store.kinds[slot as usize * BLOCK + k..]);
    let (has_own, has_account, account) = (store.has_own, store.has_account, store.fields.saturating_sub(3) * BLOCK);
    let numbers = &mut store.numbers.get_mut()[at..];
    let history = History {
        overlap_max: V::load(numbers),
        force_max: V::load(&numbers[BLOCK..]),
        own: if has_own { V::load(&numbers[2 * BLOCK..]) } else { V::splat(0.0) },
    };
    let asked = Asked { tables: &terms.tables, place, overlap, closing_speed, history: &history };
    let (force, history) = L::respond_at(&asked);
    history.overlap_max.store(numbers);
    history.force_max.store(&mut numbers[BLOCK..]);
    if has_own {
        history.own.store(&mut numbers[2 * BLOCK..]);
    }
    if has_account {
        let account = &mut numbers[account..];
        let (before, at_before) = (V::load(&account[BLOCK..]), V::load(account));
        let work = V::load(&account[2 * BLOCK..]);
        let work = work + V::splat(0.5) * (before + force) * (overlap - at_before);
        overlap.store(account);
        force.store(&mut account[BLOCK..]);
        work.store(&mut account[2 * BLOCK..]);
    }
    force
}

/// Open contacts do no work from here on.
#[inline(always)]
fn open<V: Lanes>(store: &mut Store, at: usize) {
    let zero = V::splat(0.0);
    let account = &mut store.numbers.get_mut()[at + store.fields.saturating_sub(3) * BLOCK..];
    let overlap = V::load(account);
    if !V::any(zero.lt(overlap)) {
        return;
    }
    let work = V::load(&account[2 * BLOCK..]);
    let work = work + V::splat(0.5) * V::load(&account[BLOCK..]) * (zero - overlap);
    zero.store(account);
    zero.store(&mut account[BLOCK..]);
    work.store(&mut account[2 * BLOCK..]);
}

/// Adds what was laid by to the forces on the second side.
#[inline(always)]
fn give<V: Lanes>(pushes: &Pushes, count: usize, force: &mut [Numbers; 3], place: usize) {
    for (push, force) in pushes.iter().zip(force) {
        let force = &mut force.get_mut()[place..];
        for k in (0..count).step_by(V::LANES) {
            let sum = &mut force[k..];
            (V::load(sum) + V::load(&push[k..])).store(sum);
        }
    }
}

/// One step of a seam, as the spheres lie before either of its sides is moved.
pub struct SeamStep<'a, L> {
    pub terms: &'a Terms,
    pub seam: &'a mut Seam,
    pub sides: [&'a Section; 2],
    pub law: PhantomData<L>,
}

impl<L: LaneLaw> Kernel for SeamStep<'_, L> {
    type Output = ();
    #[inline(always)]
    fn run<V: Lanes>(self) {
        let Self { terms, seam, sides: [upper, lower], .. } = self;
        if seam.acts {
            for numbers in seam.on_upper.iter_mut().chain(&mut seam.on_lower) {
                numbers.get_mut().fill(0.0);
            }
        }
        seam.acts = false;
        seam.woken.iter_mut().for_each(Vec::clear);
        let mut pushes = [[0.0; MOST_IN_ROW]; 3];
        let Seam { bundles, store, upper_from, on_upper, on_lower, acts, woken } = seam;
        for bundle in bundles.iter() {
            let [row_a, row_b] = bundle.rows;
            if !(upper.active[row_a as usize] || lower.active[row_b as usize]) {
                continue;
            }
            let sides =
                [Side::new(&upper.x, &upper.predicted, bundle.a), Side::new(&lower.x, &lower.predicted, bundle.b)];
            let on_a = (&mut *on_upper, bundle.a as usize - *upper_from);
            if work_out::<V, L>(terms, bundle, sides, store, on_a, &mut pushes) {
                *acts = true;
                give::<V>(&pushes, bundle.count as usize, on_lower, bundle.b as usize);
                for (woken, row) in woken.iter_mut().zip(bundle.rows) {
                    if woken.last() != Some(&row) {
                        woken.push(row);
                    }
                }
            }
        }
    }
}

/// One step of a section.
pub struct SectionStep<'a, L> {
    pub terms: &'a Terms,
    pub section: &'a mut Section,
    /// The seams above and below, already worked out.
    pub seams: [Option<&'a Seam>; 2],
    pub law: PhantomData<L>,
}

impl<L: LaneLaw> Kernel for SectionStep<'_, L> {
    /// The greatest v² (m²/s²) after the step.
    type Output = f64;
    #[inline(always)]
    fn run<V: Lanes>(self) -> f64 {
        let Self { terms, section, seams: [above, below], .. } = self;
        section.work = 0.0;
        if let Some(seam) = above.filter(|seam| seam.acts) {
            section.take(&seam.on_lower, 0, &seam.woken[1]);
        }
        if let Some(seam) = below.filter(|seam| seam.acts) {
            section.take(&seam.on_upper, seam.upper_from, &seam.woken[0]);
        }
        if !section.any_active {
            return 0.0;
        }
        let mut pushes = [[0.0; MOST_IN_ROW]; 3];
        let mut fastest = 0.0;
        for row in 0..section.rows.len() {
            let Placed { bundles, images, .. } = section.rows[row];
            for k in bundles[0]..bundles[1] {
                let bundle = section.bundles[k as usize];
                let other = bundle.rows[1] as usize;
                if !(section.active[row] || section.active[other]) {
                    continue;
                }
                let sides = [bundle.a, bundle.b].map(|place| Side::new(&section.x, &section.predicted, place));
                let on_a = (&mut section.force, bundle.a as usize);
                if work_out::<V, L>(terms, &bundle, sides, &mut section.store, on_a, &mut pushes) {
                    give::<V>(&pushes, bundle.count as usize, &mut section.force, bundle.b as usize);
                    (section.active[row], section.active[other]) = (true, true);
                }
            }
            if !section.active[row] {
                continue;
            }
            for k in images[0]..images[1] {
                with_images::<V, L>(terms, section, k as usize);
            }
            let moved = V::outlined(Move::<V> { terms, section, row, width: PhantomData });
            fastest = f64::max(fastest, moved);
        }
        fastest
    }
}

impl Section {
    /// Forces across a seam.
    #[inline(always)]
    fn take(&mut self, forces: &[Numbers; 3], from: usize, woken: &[u32]) {
        for (sum, force) in self.force.iter_mut().zip(forces) {
            let length = force.length - BLOCK;
            for (sum, force) in sum.get_mut()[from..from + length].iter_mut().zip(force.get()) {
                *sum += force;
            }
        }
        for &row in woken {
            self.active[row as usize] = true;
            self.any_active = true;
        }
    }
}

/// Contacts of spheres with their own images.
#[inline(always)]
fn with_images<V: Lanes, L: LaneLaw>(terms: &Terms, section: &mut Section, k: usize) {
    let ImageBundle { place, count, slot, axis, inward, gap, part } = section.images[k];
    let (axis, place) = (axis as usize, place as usize);
    let (zero, twice) = (V::splat(0.0), V::splat(2.0 * inward));
    let least = V::splat(CLOSED * terms.diameter);
    for k in (0..count as usize).step_by(V::LANES) {
        let mut overlap = -(twice * V::load(&section.x[axis].get()[place + k..]) + V::splat(gap));
        if let Some(none) = beyond::<V>(count as usize - k) {
            overlap = overlap - none;
        }
        let closed = least.lt(overlap);
        if !V::any(closed) {
            if section.store.has_account {
                let at = section.store.at(slot, k);
                open::<V>(&mut section.store, at);
            }
            continue;
        }
        let overlap = V::select(closed, overlap, zero);
        let closing_speed = -(twice * V::load(&section.predicted[axis].get()[place + k..]));
        let force = respond::<V, L>(terms, &mut section.store, (slot, k), overlap, closing_speed);
        let force = V::splat(inward * part) * V::select(closed, force, zero);
        let sum = &mut section.force[axis].get_mut()[place + k..];
        (V::load(sum) + force).store(sum);
    }
}
