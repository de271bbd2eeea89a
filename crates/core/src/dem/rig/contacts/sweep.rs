//! The force sweep over all contacts.

use super::Contacts;
use super::faces::{Facing, NearFace, Standing};
use super::friction::Held;
use super::lanes::{Disks, Sweep};
use super::react::{Arms, Meeting, Motion, Past, Predicted, Reaction, Rolls, react, react_pair, release, sliding};
use super::sections::{Piece, Spill};
use super::solids;
use super::swept::Swept;
use crate::dem::rig::bodies::{Bodies, dot};
use crate::dem::rig::dashpot::SpringDashpot;
use crate::dem::rig::law::SolidLaw;
use crate::dem::rig::spins::{self, Spins};
use crate::dem::rig::{Body, Rig};

/// Force sums on all bodies.
#[derive(Clone, Debug)]
pub struct Sums<const D: usize> {
    pub force: Vec<[f64; D]>,
    pub torque: Spins<D>,
    pub flat: Vec<[f64; D]>,
    /// What in these sums is no force of the state, but an impulse over the step; see [`SpringDashpot`].
    pub excess: Vec<Excess<D>>,
}

/// By how much (N) what acts on a body over one step exceeds the force of a contact, where that has just begun or ended.
#[derive(Clone, Copy, Debug)]
pub struct Excess<const D: usize> {
    pub body: Body,
    pub force: [f64; D],
}

impl<const D: usize> Excess<D> {
    /// On both ends of a pair, of which the second is pushed by `force`.
    #[inline(always)]
    pub fn of_pair(ends: [u32; 2], force: [f64; D]) -> [Self; 2] {
        let [a, b] = ends.map(|end| Body::Sphere(end as usize));
        [Self { body: a, force: force.map(|f| -f) }, Self { body: b, force }]
    }
}

impl<const D: usize> Sums<D> {
    pub fn new(spheres: usize, flats: usize) -> Self {
        Self {
            force: vec![[0.0; D]; spheres],
            torque: Spins::still(spheres),
            flat: vec![[0.0; D]; flats],
            excess: Vec::new(),
        }
    }
}

impl<const D: usize, L: Swept<D>> Contacts<D, L> {
    /// Adds up the forces on all spheres and flats at the given velocities; memories advance by one step.
    pub fn sweep(&mut self, rig: &Rig<D>, bodies: &Bodies<D>, predicted: Predicted<D>, sums: &mut Sums<D>) {
        if self.turning {
            self.sweep_pairs::<true>(bodies, predicted, sums);
            self.sweep_faces::<true>(rig, bodies, predicted, sums);
        } else {
            self.sweep_pairs::<false>(bodies, predicted, sums);
            self.sweep_faces::<false>(rig, bodies, predicted, sums);
        }
    }

    fn sweep_pairs<const TURNING: bool>(&mut self, bodies: &Bodies<D>, predicted: Predicted<D>, sums: &mut Sums<D>) {
        sums.flat.fill([0.0; D]);
        L::sweep::<TURNING>(self, bodies, predicted, sums);
    }

    /// The pairs one by one.
    pub(super) fn sweep_any<const TURNING: bool>(
        &mut self,
        bodies: &Bodies<D>,
        predicted: Predicted<D>,
        sums: &mut Sums<D>,
    ) {
        let Self {
            near, share, pair_law, reduced, pair_laws, memory, stretch, account, lever, radius, sections, ..
        } = self;
        let each = self.more.count::<D>();
        let extra = if TURNING { &mut self.extra[..each * near.len()] } else { &mut [] };
        let (near, share, pair_law, reduced) = (&near[..], &share[..], &pair_law[..], &reduced[..]);
        let (pair_laws, lever) = (&pair_laws[..], &lever[..]);
        let motion = Motion { bodies, lever, arms: arms(radius), predicted };
        let more = self.more;
        sections.run(memory, account.rows(), (stretch, extra), (lever, TURNING), sums, |piece| {
            let Piece { first, first_sphere, memory, mut account, stretch, extra, .. } = piece;
            let Piece { force: sum, twist: couple, lever, spill, excess: beyond, .. } = piece;
            for n in 0..account.overlap.len() {
                let c = first + n;
                let share = if share.is_empty() { 1.0 } else { share[c] };
                let past = Past {
                    memory: memory[n],
                    stretch: spring_at::<D, TURNING>(stretch.each_ref().map(|axis| &axis[..]), n),
                    account: account.at(n),
                };
                let law = (&pair_laws[pair_law[c] as usize], reduced[c]);
                let held = Held { more, numbers: if TURNING { &mut extra[n * each..][..each] } else { &mut [] } };
                let reaction = react_pair::<D, L, TURNING>(&near[c], motion, law, &past, held);
                let Some((Reaction { force, excess, twist, roll, arms }, now)) = reaction else { continue };
                (memory[n], _) = (now.memory, account.put(n, now.account));
                if TURNING {
                    for k in 0..D {
                        stretch[k][n] = now.stretch[k];
                    }
                }
                let (force, twist) = (force.map(|f| share * f), twist.map(|f| share * f));
                let roll = roll.map(|couple| share * couple);
                if excess != [0.0; D] {
                    beyond.extend(Excess::of_pair(near[c].ends, excess.map(|f| share * f)));
                }
                let [a, b] = near[c].ends.map(|end| end as usize - first_sphere);
                add(&mut sum[a], -1.0, &force);
                if TURNING {
                    spins::add::<D>(couple, a, arms[0], &twist);
                    spins::add::<D>(couple, a, -1.0, &roll);
                }
                if b < sum.len() {
                    add(&mut sum[b], 1.0, &force);
                    if TURNING {
                        spins::add::<D>(couple, b, arms[1], &twist);
                        spins::add::<D>(couple, b, 1.0, &roll);
                    }
                } else {
                    let twist = std::array::from_fn(|k| arms[1] * twist[k] + roll[k]);
                    spill.push(Spill { sphere: near[c].ends[1], force, twist });
                }
            }
            if TURNING {
                spins::multiply::<D>(couple, lever);
            }
        });
    }

    fn sweep_faces<const TURNING: bool>(
        &mut self,
        rig: &Rig<D>,
        bodies: &Bodies<D>,
        predicted: Predicted<D>,
        sums: &mut Sums<D>,
    ) {
        let mut first = 0;
        while first < self.faces.len() {
            let sphere = self.faces[first].sphere;
            let count = self.faces[first..].iter().take_while(|face| face.sphere == sphere).count();
            let all = first..first + count;
            if count > 1 {
                // What passes from one face to another has passed before any of them reacts.
                for face in all.clone() {
                    let _ = self.stands(face, &all, rig, bodies);
                }
            }
            for face in all.clone() {
                match self.stands(face, &all, rig, bodies) {
                    Some(standing) => self.face_reacts::<TURNING>(face, standing, bodies, predicted, sums),
                    None => self.face_opens(face, rig, bodies, predicted, sums),
                }
            }
            first += count;
        }
    }

    /// A face contact that is not closed now; if it was, it opens.
    fn face_opens(
        &mut self,
        face: usize,
        rig: &Rig<D>,
        bodies: &Bodies<D>,
        predicted: Predicted<D>,
        sums: &mut Sums<D>,
    ) {
        let c = self.near.len() + face;
        let mut row = self.account.at(c);
        if row.overlap == 0.0 {
            return;
        }
        let NearFace { sphere, facing, radius, share, .. } = self.faces[face];
        let (i, factor) = (sphere as usize, self.face_scale(c));
        let (distance, normal) = self.faces[face].apart(rig, bodies);
        if distance < radius {
            // Another face has taken its place.
            row.open(0.0, predicted.step);
        } else {
            let flat = match facing {
                Facing::Flat(flat) => Some(flat as usize),
                Facing::Mirror(_) => None,
            };
            let face_velocity = flat.map_or([0.0; D], |flat| predicted.flat_velocity[flat]);
            let approach = std::array::from_fn(|k| factor * (face_velocity[k] - predicted.velocity[i][k]));
            let (overlap, closing_speed) = (factor * (radius - distance), dot(&approach, &normal));
            let meeting = Meeting { overlap, closing_speed, normal, approach, turn: [0.0; 3], inverse: 0.0 };
            let past = Past { memory: self.memory[c], stretch: [0.0; D], account: row };
            let law = (&self.pair_laws[self.pair_law[c] as usize], self.reduced[c]);
            let (Reaction { force, excess, .. }, now) = release::<D, L>(&meeting, law, &past, predicted.step);
            row = now.account;
            let force = force.map(|f| share * f);
            add(&mut sums.force[i], 1.0, &force);
            if let Some(flat) = flat {
                add(&mut sums.flat[flat], -1.0, &force);
            }
            sums.exceed(i, flat, excess.map(|f| share * f));
        }
        self.account.put(c, row);
        self.stretch.iter_mut().filter_map(|axis| axis.get_mut(c)).for_each(|part| *part = 0.0);
        let each = self.more.count::<D>();
        self.extra.iter_mut().skip(c * each).take(each).for_each(|part| *part = 0.0);
    }

    fn face_reacts<const TURNING: bool>(
        &mut self,
        face: usize,
        Standing { depth, distance, normal }: Standing<D>,
        bodies: &Bodies<D>,
        predicted: Predicted<D>,
        sums: &mut Sums<D>,
    ) {
        let c = self.near.len() + face;
        let NearFace { sphere, facing, share, .. } = self.faces[face];
        let i = sphere as usize;
        // The face is the first end: where it stands for an equal sphere, that sphere moves and turns so that the contact is the
        // centre of symmetry of both. All that one sphere does then counts twice.
        let factor = self.face_scale(c);
        let moving = |sphere: &[f64; D], face: &[f64; D]| -> [f64; D] {
            std::array::from_fn(|k| factor * (face[k] - sphere[k]))
        };
        let flat = match facing {
            Facing::Flat(flat) => Some(flat as usize),
            Facing::Mirror(_) => None,
        };
        let still = [0.0; D];
        let approach = moving(&predicted.velocity[i], flat.map_or(&still, |flat| &predicted.flat_velocity[flat]));
        let overlap = factor * depth;
        let mut meeting =
            Meeting { overlap, closing_speed: dot(&approach, &normal), normal, approach, turn: [0.0; 3], inverse: 0.0 };
        let past = Past {
            memory: self.memory[c],
            stretch: spring_at::<D, TURNING>(self.stretch.each_ref().map(|axis| axis.as_slice()), c),
            account: self.account.at(c),
        };
        let law = (&self.pair_laws[self.pair_law[c] as usize], self.reduced[c]);
        let step = predicted.step;
        let arm = if self.radius.is_empty() { 1.0 } else { distance };
        let slips = flat.filter(|_| TURNING);
        let each = self.more.count::<D>();
        let numbers = if TURNING { &mut self.extra[c * each..][..each] } else { &mut [] };
        let mut held = Held { more: self.more, numbers };
        let (Reaction { force, excess, twist, roll, .. }, now) = if let Some(flat) = slips {
            let motion = Motion { bodies, lever: &self.lever, arms: arms(&self.radius), predicted };
            meeting.turn = predicted.turn.get(i).map(|turn| factor * arm * turn);
            let before = &bodies.flat_velocity[flat];
            let of_flat = std::array::from_fn(|k| 0.5 * (before[k] + predicted.flat_velocity[flat][k]));
            let turned = motion.mean_turn(i);
            // Against a flat a sphere rolls on its own radius; as for sliding, all that one sphere does counts twice where the flat stands for another.
            let rolls =
                Rolls { radius: factor * law.0.slip.rolling_radius, turned: turned.map(|turn| -factor * turn * step) };
            let turn = turned.map(|turn| factor * arm * turn);
            let way = sliding(&moving(&motion.mean_velocity(i), &of_flat), &turn, &normal).map(|u| u * step);
            react::<D, L, true>(&meeting, (&way, rolls), law, &past, (&mut held, step))
        } else {
            react::<D, L, false>(&meeting, (&still, Rolls::default()), law, &past, (&mut held, step))
        };
        (self.memory[c], _) = (now.memory, self.account.put(c, now.account));
        if TURNING {
            for k in 0..D {
                self.stretch[k][c] = now.stretch[k];
            }
        }
        let force = force.map(|f| share * f);
        add(&mut sums.force[i], 1.0, &force);
        if slips.is_some() {
            sums.torque.add(i, self.lever[i] * arm, &twist.map(|f| share * f));
            sums.torque.add(i, 1.0, &roll.map(|couple| share * couple));
        }
        if let Some(flat) = flat {
            add(&mut sums.flat[flat], -1.0, &force);
        }
        sums.exceed(i, flat, excess.map(|f| share * f));
    }
}

impl<const D: usize> Sums<D> {
    /// Notes the excess of a contact of a sphere with a flat, or with its image.
    fn exceed(&mut self, sphere: usize, flat: Option<usize>, force: [f64; D]) {
        if force != [0.0; D] {
            self.excess.push(Excess { body: Body::Sphere(sphere), force });
            let on_flat = |flat| Excess { body: Body::Flat(flat), force: force.map(|f| -f) };
            self.excess.extend(flat.map(on_flat));
        }
    }
}

/// Where arms end, of contacts that know their spheres' radii only if in the contact.
fn arms(radius: &[f64]) -> Arms<'_> {
    if radius.is_empty() { Arms::Radius } else { Arms::Contact(radius) }
}

/// ξ of a contact (m).
#[inline(always)]
fn spring_at<const D: usize, const TURNING: bool>(stretch: [&[f64]; D], c: usize) -> [f64; D] {
    std::array::from_fn(|k| if TURNING { stretch[k][c] } else { 0.0 })
}

impl<const D: usize> Contacts<D, SolidLaw> {
    /// As `sweep_any`, in the lanes of vector registers, with so many lines of numbers for each sphere: [`solids::TURNING`] where spheres turn.
    pub(super) fn sweep_solids<const LINES: usize>(
        &mut self,
        bodies: &Bodies<D>,
        predicted: Predicted<D>,
        sums: &mut Sums<D>,
    ) {
        let Self { near, share, lever, pair_law, reduced, memory, stretch, account, sections, width, beside, .. } =
            self;
        let Some(looked) = beside else { return };
        solids::fill::<D, LINES>(bodies, predicted, &mut looked.lines);
        let looked = &*looked;
        let (near, share, pair_law, reduced) = (&near[..], &share[..], &pair_law[..], &reduced[..]);
        let (lines, step, turning) = (looked.lines.as_chunks().0, predicted.step, LINES == solids::TURNING);
        sections.run(memory, account.rows(), (stretch, &mut []), (lever, turning), sums, |piece| {
            width.run(solids::Sweep::<D, LINES> { near, lines, looked, pair_law, reduced, share, piece, step });
        });
    }
}

impl Contacts<2, SpringDashpot> {
    /// As `sweep_any`, in the lanes of vector registers.
    pub(super) fn sweep_disks<const TURNING: bool>(
        &mut self,
        bodies: &Bodies<2>,
        Predicted { velocity, turn, step, .. }: Predicted<2>,
        sums: &mut Sums<2>,
    ) {
        let disks = Disks { at: &bodies.displacement, velocity, turn: turn.numbers() };
        if self.pair_laws.iter().any(|pair_law| pair_law.slip.stiffness > 0.0) {
            self.sweep_kind::<TURNING, true>(step, disks, sums);
        } else {
            self.sweep_kind::<TURNING, false>(step, disks, sums);
        }
    }

    fn sweep_kind<const TURNING: bool, const SPRING: bool>(&mut self, step: f64, disks: Disks<'_>, sums: &mut Sums<2>) {
        let Self {
            beside: lines, lever, pair_laws, pair_law, reduced, memory, stretch, account, sections, width, ..
        } = self;
        let (lines, pair_laws, pair_law, reduced) = (&*lines, &pair_laws[..], &pair_law[..], &reduced[..]);
        sections.run(memory, account.rows(), (stretch, &mut []), (lever, TURNING), sums, |piece| {
            width.run(Sweep::<TURNING, SPRING> { lines, disks, pair_laws, pair_law, reduced, piece, step });
        });
    }
}

#[inline(always)]
fn add<const D: usize>(sum: &mut [f64; D], factor: f64, force: &[f64; D]) {
    for k in 0..D {
        sum[k] += factor * force[k];
    }
}
