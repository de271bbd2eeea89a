//! The force sweep over all contacts.

use std::any::Any;

use rayon::prelude::*;

use super::Contacts;
use super::account::AccountRows;
use super::faces::{Facing, NearFace};
use super::lanes::{Moving, Receiver, Sweep};
use super::react::{Meeting, Reaction, Trial, react, react_pair};
use crate::dem::rig::Rig;
use crate::dem::rig::bodies::{Bodies, axes_of_spin, dot, spin_cross};
use crate::dem::rig::law::{Bonding, SpringDashpot};

/// From so many contacts on a sweep is worth sharing among threads.
pub const MANY: usize = 60_000;

/// Force sums on all bodies.
#[derive(Clone, Debug)]
pub struct Sums<const D: usize> {
    pub force: Vec<[f64; D]>,
    pub torque: Vec<[f64; 3]>,
    pub flat: Vec<[f64; D]>,
}

impl<const D: usize> Sums<D> {
    pub fn new(spheres: usize, flats: usize) -> Self {
        Self { force: vec![[0.0; D]; spheres], torque: vec![[0.0; 3]; spheres], flat: vec![[0.0; D]; flats] }
    }

    fn clear<const TURNING: bool>(&mut self) {
        self.force.fill([0.0; D]);
        if TURNING {
            self.torque.fill([0.0; 3]);
        }
        self.clear_flats();
    }

    fn clear_flats(&mut self) {
        self.flat.fill([0.0; D]);
    }
}

/// Contacts that one thread works on at a time.
const GRAIN: usize = 2048;

/// Successive pairs, from `first` on.
struct Chunk<'a, const D: usize, M, R> {
    first: usize,
    memory: &'a mut [M],
    account: AccountRows<'a>,
    stretch: [&'a mut [f64]; D],
    reactions: &'a mut [R],
}

impl<const D: usize, L: Bonding> Contacts<D, L> {
    /// Adds up the forces on all spheres and flats at the given velocities and spins; memories advance by one step.
    pub fn sweep(&mut self, rig: &Rig<D>, bodies: &Bodies<D>, trial: Trial<D>, sums: &mut Sums<D>) {
        if self.turning {
            self.sweep_pairs::<true>(bodies, trial, sums);
            self.sweep_faces::<true>(rig, bodies, trial, sums);
        } else {
            self.sweep_pairs::<false>(bodies, trial, sums);
            self.sweep_faces::<false>(rig, bodies, trial, sums);
        }
    }

    fn sweep_pairs<const TURNING: bool>(&mut self, bodies: &Bodies<D>, trial: Trial<D>, sums: &mut Sums<D>) {
        let shared = !self.first_of.is_empty() && rayon::current_num_threads() > 1;
        // Of disks in lanes both are done at once.
        if (self as &mut dyn Any).downcast_mut::<Contacts<2, SpringDashpot>>().is_some_and(|disks| {
            let in_lanes = disks.share.is_empty();
            if in_lanes {
                disks.gather(bodies.displacement.as_flattened(), trial.velocity.as_flattened(), trial.spin);
                disks.sweep_disks::<TURNING>(trial.step, shared, sums.force.as_flattened_mut(), &mut sums.torque);
            }
            in_lanes
        }) {
            sums.clear_flats();
        } else if shared {
            self.react_all::<TURNING>(bodies, trial);
            self.add_up::<TURNING>(sums);
        } else {
            self.add_all::<TURNING>(bodies, trial, sums);
        }
    }

    /// One contact after the other.
    fn add_all<const TURNING: bool>(&mut self, bodies: &Bodies<D>, trial: Trial<D>, sums: &mut Sums<D>) {
        let Self { near, share, bond, reduced, bonds, memory, stretch, account, ends, .. } = self;
        sums.clear::<TURNING>();
        let mut account = account.rows();
        for c in 0..near.len() {
            let share = if share.is_empty() { 1.0 } else { share[c] };
            let bond = (&bonds[bond[c] as usize], reduced[c]);
            let mut spring = spring_at::<D, TURNING>(stretch.each_ref().map(|axis| axis.as_slice()), c);
            let mut row = account.at(c);
            let reaction = react_pair::<D, L, TURNING>(
                &near[c],
                &bodies.displacement,
                trial,
                ends,
                bond,
                &mut memory[c],
                &mut spring,
                &mut row,
                share,
            );
            account.put(c, row);
            if TURNING {
                for k in 0..D {
                    stretch[k][c] = spring[k];
                }
            }
            let Some(Reaction { force, twist }) = reaction else { continue };
            let [a, b] = near[c].ends.map(|i| i as usize);
            for k in 0..D {
                sums.force[a][k] -= force[k];
                sums.force[b][k] += force[k];
            }
            if TURNING {
                for k in axes_of_spin::<D>() {
                    sums.torque[a][k] += ends[a].radius * twist[k];
                    sums.torque[b][k] += ends[b].radius * twist[k];
                }
            }
        }
    }

    /// Each contact on its own, in any order.
    fn react_all<const TURNING: bool>(&mut self, bodies: &Bodies<D>, trial: Trial<D>) {
        let Self { near, share, bond, reduced, bonds, memory, stretch, account, ends, reactions, .. } = self;
        reactions.resize(near.len(), Reaction::NONE);
        let (near, share, bond, reduced) = (&near[..], &share[..], &bond[..], &reduced[..]);
        let (bonds, ends) = (&bonds[..], &ends[..]);
        let work = |chunk: Chunk<'_, D, L::Memory, Reaction<D>>| {
            let Chunk { first, memory, mut account, stretch, reactions } = chunk;
            for n in 0..reactions.len() {
                let c = first + n;
                let share = if share.is_empty() { 1.0 } else { share[c] };
                let mut spring = spring_at::<D, TURNING>(stretch.each_ref().map(|axis| &axis[..]), n);
                let mut row = account.at(n);
                let reaction = react_pair::<D, L, TURNING>(
                    &near[c],
                    &bodies.displacement,
                    trial,
                    ends,
                    (&bonds[bond[c] as usize], reduced[c]),
                    &mut memory[n],
                    &mut spring,
                    &mut row,
                    share,
                );
                reactions[n] = reaction.unwrap_or(Reaction::NONE);
                account.put(n, row);
                if TURNING {
                    for k in 0..D {
                        stretch[k][n] = spring[k];
                    }
                }
            }
        };
        chunks(&mut memory[..near.len()], account.rows(), stretch, reactions).into_par_iter().for_each(work);
    }

    /// Each sphere's sum over its contacts, in their order.
    fn add_up<const TURNING: bool>(&self, sums: &mut Sums<D>) {
        let (by_sphere, first_of, reactions, ends) = (&self.by_sphere, &self.first_of, &self.reactions, &self.ends);
        sums.force.par_iter_mut().zip(sums.torque.par_iter_mut()).enumerate().with_min_len(1024).for_each(
            |(i, (force, torque))| {
                *force = [0.0; D];
                *torque = [0.0; 3];
                for &code in &by_sphere[first_of[i] as usize..first_of[i + 1] as usize] {
                    let reaction = &reactions[code as usize / 2];
                    for k in 0..D {
                        if code % 2 == 1 {
                            force[k] += reaction.force[k];
                        } else {
                            force[k] -= reaction.force[k];
                        }
                    }
                    if TURNING {
                        for k in axes_of_spin::<D>() {
                            torque[k] += ends[i].radius * reaction.twist[k];
                        }
                    }
                }
            },
        );
        sums.clear_flats();
    }

    fn sweep_faces<const TURNING: bool>(
        &mut self,
        rig: &Rig<D>,
        bodies: &Bodies<D>,
        trial: Trial<D>,
        sums: &mut Sums<D>,
    ) {
        let Trial { velocity, spin, flat_velocity, step } = trial;
        for f in 0..self.faces.len() {
            let c = self.near.len() + f;
            let NearFace { sphere, facing, radius, share, .. } = self.faces[f];
            let i = sphere as usize;
            let Some((distance, normal)) = self.faces[f].overlapping(rig, bodies) else {
                if self.account.overlap[c] > 0.0 {
                    let mut row = self.account.at(c);
                    row.open(step);
                    self.account.put(c, row);
                    self.stretch.iter_mut().filter_map(|axis| axis.get_mut(c)).for_each(|part| *part = 0.0);
                }
                continue;
            };
            let (factor, face_velocity) = match facing {
                Facing::Flat(flat) => (self.face_factor, flat_velocity[flat as usize]),
                Facing::Mirror(_) => (2.0, [0.0; D]),
            };
            let mut approach = [0.0; D];
            for k in 0..D {
                approach[k] = face_velocity[k] - velocity[i][k];
            }
            let along = dot(&approach, &normal);
            let mut sliding = [0.0; D];
            let slips = TURNING && matches!(facing, Facing::Flat(_));
            if slips {
                let turn = spin_cross(&spin[i].map(|w| w * radius), &normal);
                for k in 0..D {
                    sliding[k] = approach[k] - along * normal[k] + turn[k];
                }
            }
            let meeting =
                Meeting { overlap: factor * (radius - distance), closing_speed: factor * along, normal, sliding };
            let mut spring = spring_at::<D, TURNING>(self.stretch.each_ref().map(|axis| axis.as_slice()), c);
            let mut row = self.account.at(c);
            let bond = (&self.bonds[self.bond[c] as usize], self.reduced[c]);
            let Reaction { force, twist } = if slips {
                react::<D, L, true>(&meeting, bond, &mut self.memory[c], &mut spring, &mut row, step, share)
            } else {
                react::<D, L, false>(&meeting, bond, &mut self.memory[c], &mut spring, &mut row, step, share)
            };
            self.account.put(c, row);
            if TURNING {
                for k in 0..D {
                    self.stretch[k][c] = spring[k];
                }
            }
            for k in 0..D {
                sums.force[i][k] += force[k];
            }
            if slips {
                for k in axes_of_spin::<D>() {
                    sums.torque[i][k] += radius * twist[k];
                }
            }
            if let Facing::Flat(flat) = facing {
                for k in 0..D {
                    sums.flat[flat as usize][k] -= force[k];
                }
            }
        }
    }
}

/// ξ of a contact (m).
#[inline(always)]
fn spring_at<const D: usize, const TURNING: bool>(stretch: [&[f64]; D], c: usize) -> [f64; D] {
    std::array::from_fn(|k| if TURNING { stretch[k][c] } else { 0.0 })
}

/// All pairs in chunks; `memory` and `reactions` hold one row per pair.
fn chunks<'a, const D: usize, M, R>(
    mut memory: &'a mut [M],
    mut account: AccountRows<'a>,
    stretch: &'a mut [Vec<f64>; D],
    mut reactions: &'a mut [R],
) -> Vec<Chunk<'a, D, M, R>> {
    let mut stretch = stretch.each_mut().map(|axis| axis.as_mut_slice());
    let (mut chunks, mut first) = (Vec::with_capacity(reactions.len() / GRAIN + 1), 0);
    while !reactions.is_empty() {
        let size = GRAIN.min(reactions.len());
        let (memory_here, memory_rest) = memory.split_at_mut(size);
        let (account_here, account_rest) = account.split_at(size);
        let (reactions_here, reactions_rest) = reactions.split_at_mut(size);
        let stretch_here = std::array::from_fn(|k| {
            let axis = std::mem::take(&mut stretch[k]);
            let (here, rest) = axis.split_at_mut(size.min(axis.len()));
            stretch[k] = rest;
            here
        });
        chunks.push(Chunk {
            first,
            memory: memory_here,
            account: account_here,
            stretch: stretch_here,
            reactions: reactions_here,
        });
        (memory, account, reactions, first) = (memory_rest, account_rest, reactions_rest, first + size);
    }
    chunks
}

impl Contacts<2, SpringDashpot> {
    /// What the contacts ask of each disk, side by side; positions and velocities as pairs of numbers.
    fn gather(&mut self, displacement: &[f64], velocity: &[f64], spin: &[[f64; 3]]) {
        let turning = self.turning;
        self.moving.clear();
        let of = |i: usize| Moving {
            at: [displacement[2 * i], displacement[2 * i + 1]],
            velocity: [velocity[2 * i], velocity[2 * i + 1]],
            turn: if turning { self.lever[i] * spin[i][2] } else { 0.0 },
        };
        if self.first_of.is_empty() {
            self.moving.extend((0..self.lever.len()).map(of));
        } else {
            self.moving.par_extend((0..self.lever.len()).into_par_iter().with_min_len(2048).map(of));
        }
    }

    /// As `add_all` or, `shared` among threads, `react_all`, in the lanes of vector registers.
    fn sweep_disks<const TURNING: bool>(
        &mut self,
        step: f64,
        shared: bool,
        force: &mut [f64],
        torque: &mut [[f64; 3]],
    ) {
        if self.bonds.iter().any(|bond| bond.slip.stiffness > 0.0) {
            self.sweep_kind::<TURNING, true>(step, shared, force, torque);
        } else {
            self.sweep_kind::<TURNING, false>(step, shared, force, torque);
        }
    }

    fn sweep_kind<const TURNING: bool, const SPRING: bool>(
        &mut self,
        step: f64,
        shared: bool,
        force: &mut [f64],
        torque: &mut [[f64; 3]],
    ) {
        let Self { near, lines, moving, bond, reduced, bonds, memory, stretch, account, lever, .. } = self;
        let (lines, moving, bonds, bond, reduced) = (&*lines, &moving[..], &bonds[..], &bond[..], &reduced[..]);
        let (pairs, width) = (near.len(), self.width);
        let sweep = |first, account, stretch, receiver| Sweep::<TURNING, SPRING> {
            lines,
            moving,
            bonds,
            bond,
            reduced,
            first,
            account,
            stretch,
            receiver,
            step,
        };
        if shared {
            let reactions = &mut self.flat_reactions;
            reactions.resize(pairs, [0.0; 3]);
            chunks(&mut memory[..pairs], account.rows(), stretch, reactions).into_par_iter().for_each(
                |Chunk { first, account, stretch, reactions, .. }| {
                    width.run(sweep(first, account, stretch, Receiver::List(reactions)));
                },
            );
            // As `add_up`.
            let (by_sphere, first_of, reactions) = (&self.by_sphere, &self.first_of, &*reactions);
            force.par_chunks_exact_mut(2).zip(torque).enumerate().with_min_len(1024).for_each(
                |(i, (force, torque))| {
                    let mut sum = [0.0; 3];
                    for &code in &by_sphere[first_of[i] as usize..first_of[i + 1] as usize] {
                        let [x, y, twist] = reactions[code as usize / 2];
                        let sign = if code % 2 == 1 { 1.0 } else { -1.0 };
                        sum[0] += sign * x;
                        sum[1] += sign * y;
                        sum[2] += lever[i] * twist;
                    }
                    force.copy_from_slice(&sum[..2]);
                    torque[2] = sum[2];
                },
            );
            return;
        }
        self.pull.clear();
        self.pull.resize(moving.len(), [0.0; 3]);
        let (account, _) = account.rows().split_at(pairs);
        let stretch = stretch.each_mut().map(|axis| axis.as_mut_slice());
        width.run(sweep(0, account, stretch, Receiver::Disks { pull: &mut self.pull, lever }));
        for ((force, torque), [x, y, turn]) in force.chunks_exact_mut(2).zip(torque).zip(&self.pull) {
            force.copy_from_slice(&[*x, *y]);
            torque[2] = *turn;
        }
    }
}
