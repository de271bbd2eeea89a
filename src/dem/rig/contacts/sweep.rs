//! The force sweep over all contacts.

use rayon::prelude::*;

use super::Contacts;
use super::faces::{Facing, NearFace};
use super::react::{Account, Meeting, Reaction, Trial, react, react_pair};
use crate::dem::rig::Rig;
use crate::dem::rig::bodies::{Bodies, axes_of_spin, dot, spin_cross};
use crate::dem::rig::law::{Bond, Bonding, End};
use crate::dem::rig::pairs::Near;

/// From so many contacts on a sweep is worth sharing among threads.
pub const MANY: usize = 20_000;

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
        let Self { near, share, bond, reduced, bonds, memory, stretch, account, ends, .. } = self;
        let displacement = &bodies.displacement;
        let mut spare = [0.0; D];
        if self.first_of.is_empty() || rayon::current_num_threads() == 1 {
            sums.clear::<TURNING>();
            for c in 0..near.len() {
                let share = if share.is_empty() { 1.0 } else { share[c] };
                let stretch = if TURNING { &mut stretch[c] } else { &mut spare };
                let bond = (&bonds[bond[c] as usize], reduced[c]);
                let reaction = react_pair::<D, L, TURNING>(
                    &near[c],
                    displacement,
                    trial,
                    ends,
                    bond,
                    &mut memory[c],
                    stretch,
                    &mut account[c],
                    share,
                );
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
            return;
        }
        // Each contact on its own, in any order; then each sphere's sum over its contacts, in their order.
        const GRAIN: usize = 2048;
        let near: &[Near<D>] = near;
        let (share, bond, reduced): (&[f64], &[u32], &[f64]) = (share, bond, reduced);
        let (bonds, ends): (&[Bond<L>], &[End]) = (bonds, ends);
        let rows = self
            .reactions
            .par_chunks_mut(GRAIN)
            .zip(memory[..near.len()].par_chunks_mut(GRAIN))
            .zip(account[..near.len()].par_chunks_mut(GRAIN))
            .enumerate();
        let work = |chunk: usize,
                    reactions: &mut [Option<Reaction<D>>],
                    memory: &mut [L::Memory],
                    account: &mut [Account],
                    mut stretch: Option<&mut [[f64; D]]>| {
            let mut spare = [0.0; D];
            for n in 0..reactions.len() {
                let c = chunk * GRAIN + n;
                let share = if share.is_empty() { 1.0 } else { share[c] };
                let stretch = stretch.as_mut().map_or(&mut spare, |stretch| &mut stretch[n]);
                let bond = (&bonds[bond[c] as usize], reduced[c]);
                reactions[n] = react_pair::<D, L, TURNING>(
                    &near[c],
                    displacement,
                    trial,
                    ends,
                    bond,
                    &mut memory[n],
                    stretch,
                    &mut account[n],
                    share,
                );
            }
        };
        if TURNING {
            rows.zip(stretch[..near.len()].par_chunks_mut(GRAIN)).for_each(
                |((chunk, ((reactions, memory), account)), stretch)| {
                    work(chunk, reactions, memory, account, Some(stretch));
                },
            );
        } else {
            rows.for_each(|(chunk, ((reactions, memory), account))| work(chunk, reactions, memory, account, None));
        }
        let (by_sphere, first_of, reactions) = (&self.by_sphere, &self.first_of, &self.reactions);
        sums.force.par_iter_mut().zip(sums.torque.par_iter_mut()).enumerate().with_min_len(1024).for_each(
            |(i, (force, torque))| {
                *force = [0.0; D];
                *torque = [0.0; 3];
                for &(c, second) in &by_sphere[first_of[i] as usize..first_of[i + 1] as usize] {
                    let Some(reaction) = &reactions[c as usize] else { continue };
                    for k in 0..D {
                        if second {
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
        let mut spare = [0.0; D];
        for f in 0..self.faces.len() {
            let c = self.near.len() + f;
            let NearFace { sphere, facing, radius, share, .. } = self.faces[f];
            let i = sphere as usize;
            let Some((distance, normal)) = self.faces[f].overlapping(rig, bodies) else {
                if self.account[c].overlap > 0.0 {
                    self.account[c].open(step);
                    if TURNING {
                        self.stretch[c] = [0.0; D];
                    }
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
            let stretch = if TURNING { &mut self.stretch[c] } else { &mut spare };
            let bond = (&self.bonds[self.bond[c] as usize], self.reduced[c]);
            let Reaction { force, twist } = if slips {
                react::<D, L, true>(&meeting, bond, &mut self.memory[c], stretch, &mut self.account[c], step, share)
            } else {
                react::<D, L, false>(&meeting, bond, &mut self.memory[c], stretch, &mut self.account[c], step, share)
            };
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
