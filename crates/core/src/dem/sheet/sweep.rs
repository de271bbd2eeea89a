//! One step of some rows of a sheet: forces, kick and drift in one pass through memory.
//!
//! Bonds are visited once. Those within a row and to the row below are computed register by register; the part of a
//! bond's force that belongs to the next place of the same row is carried there in a register, the part of the next row
//! in a buffer of one row. A row's forces are then complete when the pass reaches it, and nothing looks at its old
//! positions any more, so that it can be moved at once.
//!
//! The order of the sums is that of the stencil and the same wherever a band of rows begins, so any number of bands gives
//! the same bits.

use super::grid::{Ghost, Store};
use super::kinds::Kinds;
use crate::contact::hertz_over_distance;
use crate::real::{Kernel, Lanes};

/// What does not change from step to step.
#[derive(Clone, Debug)]
pub(super) struct Fixed {
    pub store: Store,
    pub kinds: Kinds,
    /// Distance of neighbours at rest, in diameters.
    pub spacing: f64,
    /// k of each kind of bond (N/m^{3/2})
    pub stiffness: [f64; 16],
    /// h² √D/m of each kind of sphere (m^{3/2}/N): by what a force over k D^{3/2} changes the displacement per step.
    pub response: [f64; 16],
}

/// Forces on the spheres of one row by those of a neighbouring one, over D^{3/2}.
#[derive(Clone, Debug, Default)]
pub(super) struct RowForce {
    pub x: Vec<f64>,
    pub z: Vec<f64>,
}

impl RowForce {
    pub fn zero(length: usize) -> Self {
        Self { x: vec![0.0; length], z: vec![0.0; length] }
    }
}

/// Displacements (diameters) and displacements per step half a step before, of some rows.
pub(super) struct Rows<'a> {
    pub x: &'a mut [f64],
    pub z: &'a mut [f64],
    pub step_x: &'a mut [f64],
    pub step_z: &'a mut [f64],
    /// Square of the greatest displacement per step so far, where it is watched.
    pub fastest: Option<&'a mut [f64]>,
}

/// Part of a step that a sweep does.
#[derive(Clone, Copy, PartialEq)]
pub(super) struct Part {
    /// By which part of a step's change velocities change.
    pub kick: f64,
    /// How many steps' displacement follows.
    pub drift: f64,
}

/// A band of rows, swept.
pub(super) struct Band<'a> {
    pub fixed: &'a Fixed,
    /// The first one, in the sheet.
    pub first: usize,
    pub rows: Rows<'a>,
    /// By the row above the first one.
    pub above: &'a RowForce,
    /// By the row below the last one.
    pub below: &'a RowForce,
    /// Work space, a row each.
    pub buffers: &'a mut [RowForce; 2],
    pub part: Part,
}

/// The bonds between two rows that lie in different bands.
pub(super) struct Seam<'a> {
    pub fixed: &'a Fixed,
    /// The upper one, in the sheet.
    pub row: usize,
    /// x and z of the upper row, then of the lower one.
    pub upper: [&'a [f64]; 2],
    pub lower: [&'a [f64]; 2],
    /// What the upper row feels, and what the lower one does.
    pub on_upper: &'a mut RowForce,
    pub on_lower: &'a mut RowForce,
}

/// Numbers of `Fixed` in registers.
struct Constants<V> {
    half: V,
    height: V,
    whole: V,
    gap: V,
    closed: V,
}

impl<V: Lanes> Constants<V> {
    #[inline(always)]
    fn new(fixed: &Fixed) -> Self {
        let a = fixed.spacing;
        Self {
            half: V::splat(0.5 * a),
            height: V::splat(0.75_f64.sqrt() * a),
            whole: V::splat(a),
            gap: V::splat(a * a - 1.0),
            closed: V::splat(2.0 * super::super::contacts::CLOSED),
        }
    }

    /// The force on the second of two spheres over D^{3/2}, and by how much their squared distance (in diameters) falls short
    /// of 1. `offset` lies between them at rest.
    #[inline(always)]
    fn bond(&self, stiffness: V, offset: [V; 2], from: [V; 2], to: [V; 2]) -> ([V; 2], V) {
        let shift = [to[0] - from[0], to[1] - from[1]];
        let between = [offset[0] + shift[0], offset[1] + shift[1]];
        // 1 − |Δ|² with Δ = offset + shift, without the cancellation of two nearly equal squares.
        let excess = -self.gap - (shift[0] * (offset[0] + between[0]) + shift[1] * (offset[1] + between[1]));
        let excess = V::select(self.closed.lt(excess), excess, V::splat(0.0));
        let push = stiffness * hertz_over_distance(excess);
        ([push * between[0], push * between[1]], excess)
    }
}

/// The bonds of one register of places with the row below.
struct Below<V> {
    /// Force on the places by the row below, negative.
    pull: [V; 2],
    /// Force on the same places of the row below.
    push: [V; 2],
    excess: V,
}

/// Tables and constants, and the kinds of one row.
struct RowBonds<'a, V> {
    constants: &'a Constants<V>,
    stiffness: &'a [f64; 16],
    beside: &'a [u8],
    straight: &'a [u8],
    slanted: &'a [u8],
}

impl<'a, V: Lanes> RowBonds<'a, V> {
    #[inline(always)]
    fn new(constants: &'a Constants<V>, fixed: &'a Fixed, row: usize) -> Self {
        let here = row * fixed.store.stride..(row + 1) * fixed.store.stride;
        Self {
            constants,
            stiffness: &fixed.stiffness,
            beside: &fixed.kinds.beside[here.clone()],
            straight: &fixed.kinds.straight[here.clone()],
            slanted: &fixed.kinds.slanted[here],
        }
    }

    #[inline(always)]
    fn stiffness(&self, kinds: &[u8], at: usize) -> V {
        V::lookup(self.stiffness, V::index(&kinds[at..at + V::LANES]))
    }

    /// `SHIFTED` in rows 2, 4, ...; `carry` is the slanted bond of the register before.
    #[inline(always)]
    fn below<const SHIFTED: bool, const ALONG: bool>(
        &self,
        at: usize,
        here: [V; 2],
        next: [V; 2],
        lower: &[&[f64]; 2],
        carry: &mut [V; 2],
    ) -> Below<V> {
        let Constants { half, height, .. } = *self.constants;
        let (left, right) = ([-half, height], [half, height]);
        let under = [V::load(&lower[0][at..]), V::load(&lower[1][at..])];
        let straight = self.stiffness(self.straight, at);
        let slanted = self.stiffness(self.slanted, at);
        let (straight, slanted) = if SHIFTED {
            let beyond = at + if ALONG { 1 } else { V::LANES };
            let under_next = [V::load(&lower[0][beyond..]), V::load(&lower[1][beyond..])];
            (self.constants.bond(straight, left, here, under), self.constants.bond(slanted, right, here, under_next))
        } else {
            (self.constants.bond(straight, right, here, under), self.constants.bond(slanted, left, next, under))
        };
        let own = [straight.0[0] + slanted.0[0], straight.0[1] + slanted.0[1]];
        let moved = [one_on::<V, ALONG>(slanted.0[0], carry[0]), one_on::<V, ALONG>(slanted.0[1], carry[1])];
        let moved = [straight.0[0] + moved[0], straight.0[1] + moved[1]];
        *carry = slanted.0;
        let excess = straight.1.max(slanted.1);
        if SHIFTED { Below { pull: own, push: moved, excess } } else { Below { pull: moved, push: own, excess } }
    }
}

/// What belongs to the next place: the numbers moved one place on along a row, or those of the place before.
#[inline(always)]
fn one_on<V: Lanes, const ALONG: bool>(own: V, before: V) -> V {
    if ALONG { own.after(before) } else { before }
}

/// Puts the images of neighbours into a row.
#[inline(always)]
pub(super) fn place_images(ghosts: &[Ghost], site: usize, x: &mut [f64], z: &mut [f64]) {
    for &(to, from, sign) in ghosts {
        for lane in 0..site {
            x[to * site + lane] = sign * x[from * site + lane];
            z[to * site + lane] = z[from * site + lane];
        }
    }
}

impl Kernel for Seam<'_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Lanes>(self) {
        match (self.row % 2 == 1, self.fixed.store.site == 1) {
            (false, false) => self.compute::<V, false, false>(),
            (false, true) => self.compute::<V, false, true>(),
            (true, false) => self.compute::<V, true, false>(),
            (true, true) => self.compute::<V, true, true>(),
        }
    }
}

impl Seam<'_> {
    #[inline(always)]
    fn compute<V: Lanes, const SHIFTED: bool, const ALONG: bool>(self) {
        let constants = Constants::new(self.fixed);
        let bonds = RowBonds::<V>::new(&constants, self.fixed, self.row);
        let beside = if ALONG { 1 } else { V::LANES };
        let mut carry = [V::splat(0.0); 2];
        for at in (0..self.fixed.store.swept).step_by(V::LANES) {
            let here = [V::load(&self.upper[0][at..]), V::load(&self.upper[1][at..])];
            let next = [V::load(&self.upper[0][at + beside..]), V::load(&self.upper[1][at + beside..])];
            let below = bonds.below::<SHIFTED, ALONG>(at, here, next, &self.lower, &mut carry);
            below.pull[0].store(&mut self.on_upper.x[at..]);
            below.pull[1].store(&mut self.on_upper.z[at..]);
            below.push[0].store(&mut self.on_lower.x[at..]);
            below.push[1].store(&mut self.on_lower.z[at..]);
        }
    }
}

impl Kernel for Band<'_> {
    /// The greatest 1 − |Δ|², |Δ| in diameters.
    type Output = f64;

    #[inline(always)]
    fn run<V: Lanes>(self) -> f64 {
        if self.fixed.store.site == 1 { self.sweep::<V, true>() } else { self.sweep::<V, false>() }
    }
}

impl Band<'_> {
    #[inline(always)]
    fn sweep<V: Lanes, const ALONG: bool>(self) -> f64 {
        let Self { fixed, first, rows, above, below, buffers: [above_next, spare], part } = self;
        let (mut above_next, mut spare) = (above_next, spare);
        let Store { stride, site, ref ghosts, .. } = fixed.store;
        let constants = Constants::new(fixed);
        let mut response = fixed.response;
        response.iter_mut().for_each(|response| *response *= part.kick);
        let mut excess = V::splat(0.0);
        let count = rows.x.len() / stride;
        let mut watched = rows.fastest;
        for k in 0..count {
            let here = k * stride..(k + 1) * stride;
            let (x, lower_x) = rows.x[here.start..].split_at_mut(stride);
            let (z, lower_z) = rows.z[here.start..].split_at_mut(stride);
            let mut row = Row {
                bonds: RowBonds::new(&constants, fixed, first + k),
                sphere: &fixed.kinds.sphere[(first + k) * stride..(first + k + 1) * stride],
                response: &response,
                drift: V::splat(part.drift),
                x,
                z,
                step_x: &mut rows.step_x[here.clone()],
                step_z: &mut rows.step_z[here.clone()],
                fastest: watched.as_deref_mut().map(|fastest| &mut fastest[here]),
                above: if k == 0 { above } else { spare },
            };
            let swept = fixed.store.swept;
            let deepest = if k + 1 == count {
                row.sweep::<false, true, ALONG>(swept, [&[], &[]], above_next, below)
            } else if (first + k) % 2 == 1 {
                row.sweep::<true, false, ALONG>(swept, [lower_x, lower_z], above_next, below)
            } else {
                row.sweep::<false, false, ALONG>(swept, [lower_x, lower_z], above_next, below)
            };
            excess = excess.max(deepest);
            place_images(&ghosts[(first + k) % 2], site, row.x, row.z);
            std::mem::swap(&mut above_next, &mut spare);
        }
        let mut greatest = 0.0;
        for lane in 0..V::LANES {
            greatest = f64::max(greatest, excess.lane(lane));
        }
        greatest
    }
}

/// A row while it is swept.
struct Row<'a, V> {
    bonds: RowBonds<'a, V>,
    sphere: &'a [u8],
    response: &'a [f64; 16],
    drift: V,
    x: &'a mut [f64],
    z: &'a mut [f64],
    step_x: &'a mut [f64],
    step_z: &'a mut [f64],
    fastest: Option<&'a mut [f64]>,
    above: &'a RowForce,
}

impl<V: Lanes> Row<'_, V> {
    /// `LAST` in the band's last row, whose forces by the row below are in `below`.
    #[inline(always)]
    fn sweep<const SHIFTED: bool, const LAST: bool, const ALONG: bool>(
        &mut self,
        swept: usize,
        lower: [&[f64]; 2],
        above_next: &mut RowForce,
        below: &RowForce,
    ) -> V {
        let zero = V::splat(0.0);
        let beside = if ALONG { 1 } else { V::LANES };
        let across = [self.bonds.constants.whole, zero];
        let (mut carry, mut slanted) = ([zero; 2], [zero; 2]);
        let mut excess = zero;
        for at in (0..swept).step_by(V::LANES) {
            let here = [V::load(&self.x[at..]), V::load(&self.z[at..])];
            let next = [V::load(&self.x[at + beside..]), V::load(&self.z[at + beside..])];
            let stiffness = self.bonds.stiffness(self.bonds.beside, at);
            let (right, deepest) = self.bonds.constants.bond(stiffness, across, here, next);
            excess = excess.max(deepest);
            let left = [one_on::<V, ALONG>(right[0], carry[0]), one_on::<V, ALONG>(right[1], carry[1])];
            carry = right;
            let pull = if LAST {
                [V::load(&below.x[at..]), V::load(&below.z[at..])]
            } else {
                let found = self.bonds.below::<SHIFTED, ALONG>(at, here, next, &lower, &mut slanted);
                excess = excess.max(found.excess);
                found.push[0].store(&mut above_next.x[at..]);
                found.push[1].store(&mut above_next.z[at..]);
                found.pull
            };
            let response = V::lookup(self.response, V::index(&self.sphere[at..at + V::LANES]));
            let above = [V::load(&self.above.x[at..]), V::load(&self.above.z[at..])];
            let old = [V::load(&self.step_x[at..]), V::load(&self.step_z[at..])];
            let mut new = [zero; 2];
            for k in 0..2 {
                let force = (above[k] + (left[k] - right[k])) - pull[k];
                new[k] = old[k] + response * force;
            }
            new[0].store(&mut self.step_x[at..]);
            new[1].store(&mut self.step_z[at..]);
            (here[0] + self.drift * new[0]).store(&mut self.x[at..]);
            (here[1] + self.drift * new[1]).store(&mut self.z[at..]);
            if let Some(fastest) = &mut self.fastest {
                // Velocity at the step's beginning: the mean of those half a step before and after.
                let twice = [old[0] + new[0], old[1] + new[1]];
                let square = V::splat(0.25) * (twice[0] * twice[0] + twice[1] * twice[1]);
                square.max(V::load(&fastest[at..])).store(&mut fastest[at..]);
            }
        }
        excess
    }
}
