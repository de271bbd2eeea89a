//! The force sweep over all contacts.

use std::any::Any;

use super::Contacts;
use super::faces::{Facing, NearFace};
use super::lanes::{Disks, Sweep};
use super::react::{Meeting, Reaction, Trial, react, react_pair, release};
use super::sections::{Piece, Spill};
use crate::dem::rig::Rig;
use crate::dem::rig::bodies::{Bodies, dot};
use crate::dem::rig::dashpot::SpringDashpot;
use crate::dem::rig::law::Bonding;
use crate::dem::rig::turns::{self, Turns};

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
}

impl<const D: usize, L: Bonding> Contacts<D, L> {
    /// Adds up the forces on all spheres and flats at the given velocities; memories advance by one step.
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
        sums.flat.fill([0.0; D]);
        let in_lanes = self.share.is_empty();
        let (disks, flat_sums) = (self as &mut dyn Any, sums as &mut dyn Any);
        match (disks.downcast_mut::<Contacts<2, SpringDashpot>>(), flat_sums.downcast_mut::<Sums<2>>()) {
            (Some(disks), Some(sums)) if in_lanes => {
                let at = (plane(&bodies.displacement), plane(trial.velocity), trial.turn.numbers());
                disks.sweep_disks::<TURNING>(trial.step, at, sums);
            }
            _ => self.sweep_any::<TURNING>(bodies, trial, sums),
        }
    }

    fn sweep_any<const TURNING: bool>(&mut self, bodies: &Bodies<D>, trial: Trial<D>, sums: &mut Sums<D>) {
        let Self { near, share, bond, reduced, bonds, memory, stretch, account, lever, sections, .. } = self;
        let (near, share, bond, reduced) = (&near[..], &share[..], &bond[..], &reduced[..]);
        let bonds = &bonds[..];
        sections.run::<_, TURNING>(memory, account.rows(), stretch, lever, sums, |piece| {
            let Piece { first, first_sphere, memory, mut account, stretch, force: sum, twist: couple, lever, spill } =
                piece;
            for n in 0..account.overlap.len() {
                let c = first + n;
                let share = if share.is_empty() { 1.0 } else { share[c] };
                let mut spring = spring_at::<D, TURNING>(stretch.each_ref().map(|axis| &axis[..]), n);
                let mut row = account.at(n);
                let reaction = react_pair::<D, L, TURNING>(
                    &near[c],
                    &bodies.displacement,
                    trial,
                    (&bonds[bond[c] as usize], reduced[c]),
                    &mut memory[n],
                    &mut spring,
                    &mut row,
                    share,
                );
                account.put(n, row);
                if TURNING {
                    for k in 0..D {
                        stretch[k][n] = spring[k];
                    }
                }
                let Some(Reaction { force, twist }) = reaction else { continue };
                let [a, b] = near[c].ends.map(|end| end as usize - first_sphere);
                add(&mut sum[a], -1.0, &force);
                if TURNING {
                    turns::add::<D>(couple, a, 1.0, &twist);
                }
                if b < sum.len() {
                    add(&mut sum[b], 1.0, &force);
                    if TURNING {
                        turns::add::<D>(couple, b, 1.0, &twist);
                    }
                } else {
                    spill.push(Spill { sphere: near[c].ends[1], force, twist });
                }
            }
            if TURNING {
                turns::multiply::<D>(couple, lever);
            }
        });
    }

    fn sweep_faces<const TURNING: bool>(
        &mut self,
        rig: &Rig<D>,
        bodies: &Bodies<D>,
        trial: Trial<D>,
        sums: &mut Sums<D>,
    ) {
        let Trial { velocity, turn, flat_velocity, step } = trial;
        for f in 0..self.faces.len() {
            let c = self.near.len() + f;
            let NearFace { sphere, facing, radius, share, .. } = self.faces[f];
            let i = sphere as usize;
            let Some((distance, normal)) = self.faces[f].overlapping(rig, bodies) else {
                if self.account.overlap[c] > 0.0 {
                    let mut row = self.account.at(c);
                    let (distance, normal) = self.faces[f].apart(rig, bodies);
                    let (factor, face_velocity) = match facing {
                        Facing::Flat(flat) => (self.face_factor, flat_velocity[flat as usize]),
                        Facing::Mirror(_) => (2.0, [0.0; D]),
                    };
                    let mut approach = [0.0; D];
                    for k in 0..D {
                        approach[k] = face_velocity[k] - velocity[i][k];
                    }
                    let (overlap, closing_speed) = (factor * (radius - distance), factor * dot(&approach, &normal));
                    let meeting = Meeting { overlap, closing_speed, normal, approach, turn: [0.0; 3] };
                    let bond = (&self.bonds[self.bond[c] as usize], self.reduced[c]);
                    if let Some(Reaction { force, .. }) =
                        release::<D, L>(&meeting, bond, &self.memory[c], &mut row, step, share)
                    {
                        add(&mut sums.force[i], 1.0, &force);
                        if let Facing::Flat(flat) = facing {
                            add(&mut sums.flat[flat as usize], -1.0, &force);
                        }
                    }
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
            let turn = if slips { turn.get(i) } else { [0.0; 3] };
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

/// Pairs of numbers of the plane, known to be so only where the law is.
fn plane<const D: usize>(rows: &[[f64; D]]) -> &[[f64; 2]] {
    rows.as_flattened().as_chunks().0
}

impl Contacts<2, SpringDashpot> {
    /// As `sweep_any`, in the lanes of vector registers.
    fn sweep_disks<const TURNING: bool>(
        &mut self,
        step: f64,
        (at, velocity, turn): (&[[f64; 2]], &[[f64; 2]], &[f64]),
        sums: &mut Sums<2>,
    ) {
        let disks = Disks { at, velocity, turn };
        if self.bonds.iter().any(|bond| bond.slip.stiffness > 0.0) {
            self.sweep_kind::<TURNING, true>(step, disks, sums);
        } else {
            self.sweep_kind::<TURNING, false>(step, disks, sums);
        }
    }

    fn sweep_kind<const TURNING: bool, const SPRING: bool>(&mut self, step: f64, disks: Disks<'_>, sums: &mut Sums<2>) {
        let Self { lines, lever, bonds, bond, reduced, memory, stretch, account, sections, width, .. } = self;
        let (lines, bonds, bond, reduced) = (&*lines, &bonds[..], &bond[..], &reduced[..]);
        sections.run::<_, TURNING>(memory, account.rows(), stretch, lever, sums, |piece| {
            width.run(Sweep::<TURNING, SPRING> { lines, disks, bonds, bond, reduced, piece, step });
        });
    }
}

#[inline(always)]
fn add<const D: usize>(sum: &mut [f64; D], factor: f64, force: &[f64; D]) {
    for k in 0..D {
        sum[k] += factor * force[k];
    }
}
