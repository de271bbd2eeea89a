//! Contacts of spheres with faces: flats, and mirrors, in which a sphere meets its own image.
//!
//! Flats that join are one face: where a sphere's nearest point of one also lies on another that is nearer to it, the other alone is
//! met, and takes over what the contact remembers. So a sphere on the seam of two coplanar plates, or on the ridge of two others,
//! is borne once, and an edge that is covered by the neighbouring plate gives no kick.

use std::ops::Range;

use crate::dem::rig::Rig;
use crate::dem::rig::bodies::Bodies;
use crate::dem::rig::flat::Face;
use crate::dem::rig::pairs::{Finder, TOUCHING};
use crate::sample::Sphere;

use super::Contacts;
use super::react::CLOSED;
use super::swept::Swept;

/// How a sphere stands to a face that it overlaps.
#[derive(Clone, Copy, Debug)]
pub struct Standing<const D: usize> {
    /// How far it reaches beyond the face (m), and its centre's distance from it.
    pub depth: f64,
    pub distance: f64,
    /// From the face to the centre.
    pub normal: [f64; D],
}

/// Flats nearer to each other than this part of a sphere's radius join.
const JOINT: f64 = 1e-6;

/// What a face contact is made with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Facing {
    Flat(u32),
    Mirror(u32),
}

/// A sphere near a face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NearFace {
    pub sphere: u32,
    pub facing: Facing,
    /// Distance of the surfaces at the start (m), exactly zero where they just touched. For unbounded faces.
    pub gap: f64,
    pub radius: f64,
    /// The part of the contact's force that belongs to the simulated part of a symmetric rig.
    pub share: f64,
}

/// The same for bounded faces, whose distance is that of absolute positions.
const CLOSED_EDGE: f64 = 1e-11;

impl NearFace {
    /// A sphere and a face that it is near.
    pub fn of<const D: usize>(rig: &Rig<D>, bodies: &Bodies<D>, sphere: usize, facing: Facing) -> Self {
        let Sphere { centre, radius, .. } = rig.sample.spheres[sphere];
        let (gap, share) = match facing {
            // A flat crosses the mirrors of its rig, so that of a sphere on them it meets the simulated part.
            Facing::Flat(f) => (rig.flats[f as usize].distance(&[0.0; D], &centre).0 - radius, bodies.weight[sphere]),
            Facing::Mirror(m) => (rig.mirrors[m as usize].distance(&centre) - radius, 1.0),
        };
        let gap = if gap.abs() <= TOUCHING * radius { 0.0 } else { gap };
        Self { sphere: sphere as u32, facing, gap, radius, share }
    }

    /// Distance of a sphere's centre from the face, and the unit vector from face to sphere, wherever the sphere is.
    pub fn apart<const D: usize>(&self, rig: &Rig<D>, bodies: &Bodies<D>) -> (f64, [f64; D]) {
        let (centre, moved) =
            (rig.sample.spheres[self.sphere as usize].centre, bodies.displacement[self.sphere as usize]);
        match self.facing {
            Facing::Mirror(m) => {
                let mirror = &rig.mirrors[m as usize];
                let mut normal = [0.0; D];
                normal[mirror.axis] = mirror.inward;
                (self.radius + self.gap + mirror.inward * moved[mirror.axis], normal)
            }
            Facing::Flat(flat) => {
                let at = std::array::from_fn(|k| centre[k] + moved[k]);
                rig.flats[flat as usize].distance(&bodies.flat_moved[flat as usize], &at)
            }
        }
    }

    /// How the sphere stands to the face, where they overlap.
    pub fn standing<const D: usize>(&self, rig: &Rig<D>, bodies: &Bodies<D>) -> Option<Standing<D>> {
        let Self { sphere, facing, gap, radius, .. } = *self;
        let moved = &bodies.displacement[sphere as usize];
        match facing {
            Facing::Mirror(m) => {
                let mirror = &rig.mirrors[m as usize];
                let mut normal = [0.0; D];
                normal[mirror.axis] = mirror.inward;
                let apart = gap + mirror.inward * moved[mirror.axis];
                (apart < -CLOSED * radius).then_some(Standing { depth: -apart, distance: radius + apart, normal })
            }
            Facing::Flat(flat) => {
                let (flat, face) = (&rig.flats[flat as usize], flat as usize);
                if flat.face == Face::Plane {
                    let mut apart = gap;
                    for k in 0..D {
                        apart += flat.normal[k] * (moved[k] - bodies.flat_moved[face][k]);
                    }
                    return (apart < -CLOSED * radius).then_some(Standing {
                        depth: -apart,
                        distance: radius + apart,
                        normal: flat.normal,
                    });
                }
                let centre = rig.sample.spheres[sphere as usize].centre;
                let at: [f64; D] = std::array::from_fn(|k| centre[k] + moved[k]);
                let (distance, normal) = flat.distance(&bodies.flat_moved[face], &at);
                (distance < radius * (1.0 - CLOSED_EDGE)).then_some(Standing {
                    depth: radius - distance,
                    distance,
                    normal,
                })
            }
        }
    }
}

/// Spheres near flats and mirrors, in order of their keys.
pub fn near_faces<const D: usize>(rig: &Rig<D>, finder: &Finder<D>, bodies: &Bodies<D>) -> Vec<NearFace> {
    let mut faces = Vec::new();
    if rig.flats.is_empty() && rig.mirrors.is_empty() {
        return faces;
    }
    for (i, sphere) in rig.sample.spheres.iter().enumerate() {
        let radius = sphere.radius;
        let skin = finder.skin[i] + finder.common;
        let at: [f64; D] = std::array::from_fn(|k| sphere.centre[k] + bodies.displacement[i][k]);
        for (f, flat) in rig.flats.iter().enumerate() {
            if flat.distance(&bodies.flat_moved[f], &at).0 - radius < skin {
                faces.push(NearFace::of(rig, bodies, i, Facing::Flat(f as u32)));
            }
        }
        for (m, mirror) in rig.mirrors.iter().enumerate() {
            if !mirror.carries(&sphere.centre, radius) && mirror.distance(&at) - radius < skin {
                faces.push(NearFace::of(rig, bodies, i, Facing::Mirror(m as u32)));
            }
        }
    }
    faces
}

impl<const D: usize, L: Swept<D>> Contacts<D, L> {
    /// How a sphere stands to one of the faces `all` that it is near, if it overlaps it and meets no neighbour in its place.
    pub fn stands(&mut self, face: usize, all: &Range<usize>, rig: &Rig<D>, bodies: &Bodies<D>) -> Option<Standing<D>> {
        let standing = self.faces[face].standing(rig, bodies)?;
        if all.len() > 1
            && let Some(cover) = self.covering(face, &standing, all, rig, bodies)
        {
            let [left, met] = [face, cover].map(|face| self.near.len() + face);
            if self.account.overlap[left] > 0.0 && self.account.overlap[met] == 0.0 {
                self.exchange(left, met);
            }
            return None;
        }
        Some(standing)
    }

    /// The nearest of the flats on which the sphere's nearest point of this one lies too, if nearer than it.
    fn covering(
        &self,
        face: usize,
        standing: &Standing<D>,
        all: &Range<usize>,
        rig: &Rig<D>,
        bodies: &Bodies<D>,
    ) -> Option<usize> {
        let NearFace { sphere, facing: Facing::Flat(_), radius, .. } = self.faces[face] else { return None };
        let (centre, moved) = (rig.sample.spheres[sphere as usize].centre, bodies.displacement[sphere as usize]);
        let point: [f64; D] = std::array::from_fn(|k| centre[k] + moved[k] - standing.distance * standing.normal[k]);
        let mut nearest = (standing.distance, face);
        for other in all.clone().filter(|&other| other != face) {
            let Facing::Flat(f) = self.faces[other].facing else { continue };
            let Some(Standing { distance, .. }) = self.faces[other].standing(rig, bodies) else { continue };
            let away = rig.flats[f as usize].distance(&bodies.flat_moved[f as usize], &point).0;
            if (distance, other) < nearest && away.abs() < JOINT * radius {
                nearest = (distance, other);
            }
        }
        (nearest.1 != face).then_some(nearest.1)
    }

    /// Exchanges all that two contacts remember.
    fn exchange(&mut self, a: usize, b: usize) {
        self.memory.swap(a, b);
        self.stretch.iter_mut().filter(|axis| !axis.is_empty()).for_each(|axis| axis.swap(a, b));
        let count = self.more.count::<D>();
        if !self.extra.is_empty() {
            (0..count).for_each(|k| self.extra.swap(a * count + k, b * count + k));
        }
        let (one, other) = (self.account.at(a), self.account.at(b));
        self.account.put(a, other);
        self.account.put(b, one);
    }
}
