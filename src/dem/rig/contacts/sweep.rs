//! The force sweep over all contacts.

use std::any::Any;

use rayon::prelude::*;

use super::Contacts;
use super::account::AccountRows;
use super::faces::{Facing, NearFace};
use super::lanes::{Disks, Receiver, Sweep};
use super::react::{Meeting, Reaction, Trial, react, react_pair};
use crate::dem::rig::Rig;
use crate::dem::rig::bodies::{Bodies, dot};
use crate::dem::rig::law::{Bonding, SpringDashpot};
use crate::dem::rig::turns::{Turns, axes_of_spin};

/// From so many contacts on a sweep is worth sharing among threads.
pub const MANY: usize = 60_000;

/// Force sums on all bodies.
#[derive(Clone, Debug)]
pub struct Sums<const D: usize> {
    pub force: Vec<[f64; D]>,
    pub torque: Turns<D>,
    pub flat: Vec<[f64; D]>,
}

impl<const D: usize> Sums<D> {
    pub fn new(spheres: usize, flats: usize) -> Self {
        Self { force: vec![[0.0; D]; spheres], torque: Turns::still(spheres), flat: vec![[0.0; D]; flats] }
    }

    fn clear<const TURNING: bool>(&mut self) {
        self.force.fill([0.0; D]);
        if TURNING {
            self.torque.numbers_mut().fill(0.0);
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
                let at = (plane(&bodies.displacement), plane(trial.velocity), trial.spin.numbers());
                let force = sums.force.as_flattened_mut().as_chunks_mut().0;
                disks.sweep_disks::<TURNING>(trial.step, shared, at, force, sums.torque.numbers_mut());
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
                sums.torque.add(a, 1.0, &twist);
                sums.torque.add(b, 1.0, &twist);
            }
        }
        if TURNING {
            for (torque, end) in sums.torque.numbers_mut().chunks_exact_mut(Turns::<D>::AXES.max(1)).zip(&*ends) {
                torque.iter_mut().for_each(|torque| *torque *= end.radius);
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
        let add = |(i, (force, torque)): (usize, (&mut [f64; D], &mut [f64]))| {
            let mut sum = ([0.0; D], [0.0; 3]);
            for &code in &by_sphere[first_of[i] as usize..first_of[i + 1] as usize] {
                let reaction = &reactions[code as usize / 2];
                for k in 0..D {
                    if code % 2 == 1 {
                        sum.0[k] += reaction.force[k];
                    } else {
                        sum.0[k] -= reaction.force[k];
                    }
                }
                if TURNING {
                    for k in 0..3 {
                        sum.1[k] += reaction.twist[k];
                    }
                }
            }
            *force = sum.0;
            for (torque, k) in torque.iter_mut().zip(axes_of_spin::<D>()) {
                *torque = ends[i].radius * sum.1[k];
            }
        };
        let force = sums.force.par_iter_mut();
        if Turns::<D>::AXES > 0 {
            let torque = sums.torque.numbers_mut().par_chunks_exact_mut(Turns::<D>::AXES);
            force.zip(torque).enumerate().with_min_len(1024).for_each(add);
        } else {
            force.enumerate().with_min_len(1024).for_each(|(i, force)| add((i, (force, &mut []))));
        }
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
            let slips = TURNING && matches!(facing, Facing::Flat(_));
            let turn = if slips { spin.get(i).map(|w| w * radius) } else { [0.0; 3] };
            let overlap = factor * (radius - distance);
            let meeting = Meeting { overlap, closing_speed: factor * along, normal, approach, turn };
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
                sums.torque.add(i, radius, &twist);
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

/// Pairs of numbers of the plane, known to be so only where the law is.
fn plane<const D: usize>(rows: &[[f64; D]]) -> &[[f64; 2]] {
    rows.as_flattened().as_chunks().0
}

impl Contacts<2, SpringDashpot> {
    /// As `add_all` or, `shared` among threads, `react_all`, in the lanes of vector registers.
    fn sweep_disks<const TURNING: bool>(
        &mut self,
        step: f64,
        shared: bool,
        (at, velocity, spin): (&[[f64; 2]], &[[f64; 2]], &[f64]),
        force: &mut [[f64; 2]],
        torque: &mut [f64],
    ) {
        let mut turn = std::mem::take(&mut self.turn);
        if TURNING {
            for ((turn, spin), lever) in turn.iter_mut().zip(spin).zip(&self.lever) {
                *turn = lever * spin;
            }
        }
        let disks = Disks { at, velocity, turn: &turn };
        if self.bonds.iter().any(|bond| bond.slip.stiffness > 0.0) {
            self.sweep_kind::<TURNING, true>(step, shared, disks, force, torque);
        } else {
            self.sweep_kind::<TURNING, false>(step, shared, disks, force, torque);
        }
        self.turn = turn;
    }

    fn sweep_kind<const TURNING: bool, const SPRING: bool>(
        &mut self,
        step: f64,
        shared: bool,
        disks: Disks<'_>,
        force: &mut [[f64; 2]],
        torque: &mut [f64],
    ) {
        let Self { near, lines, lever, bonds, bond, reduced, memory, stretch, account, .. } = self;
        let (lines, bonds, bond, reduced) = (&*lines, &bonds[..], &bond[..], &reduced[..]);
        let (pairs, width) = (near.len(), self.width);
        let sweep = |first, account, stretch, receiver| Sweep::<TURNING, SPRING> {
            lines,
            disks,
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
            force.par_iter_mut().zip(torque).enumerate().with_min_len(1024).for_each(|(i, (force, torque))| {
                let mut sum = [0.0; 3];
                for &code in &by_sphere[first_of[i] as usize..first_of[i + 1] as usize] {
                    let [x, y, twist] = reactions[code as usize / 2];
                    let sign = if code % 2 == 1 { 1.0 } else { -1.0 };
                    sum[0] += sign * x;
                    sum[1] += sign * y;
                    sum[2] += twist;
                }
                *force = [sum[0], sum[1]];
                *torque = lever[i] * sum[2];
            });
            return;
        }
        force.fill([0.0; 2]);
        if TURNING {
            torque.fill(0.0);
        }
        let (account, _) = account.rows().split_at(pairs);
        let stretch = stretch.each_mut().map(|axis| axis.as_mut_slice());
        width.run(sweep(0, account, stretch, Receiver::Disks { force, twist: torque }));
        if TURNING {
            for (torque, lever) in torque.iter_mut().zip(lever) {
                *torque *= *lever;
            }
        }
    }
}
