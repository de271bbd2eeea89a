//! Every body and closed contact of a bed, or of another rig in the plane, at one moment.

use crate::dem::rig::{Body, Simulation};
use crate::network::{Branch, Contact, Network, NetworkError};

/// What a body of a frame is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// A grain.
    Grain,
    /// An immobile disk of a wall.
    Wall,
    /// The intruder, or one of the disks it is made of.
    Intruder,
}

impl Role {
    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Grain => "grain",
            Self::Wall => "wall",
            Self::Intruder => "intruder",
        }
    }
}

/// A disk of a frame. Units are d, m and τ_c of a bed, SI of another rig.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameBody {
    /// What it is.
    pub role: Role,
    /// Centre; over periodic sides it is not taken back.
    pub place: [f64; 2],
    /// Diameter.
    pub diameter: f64,
    /// Velocity.
    pub velocity: [f64; 2],
    /// Spin, from x towards z.
    pub spin: f64,
    /// Net force of contacts on the whole body.
    pub force: [f64; 2],
}

/// What touches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// A body, by its place in the frame.
    Body(u32),
    /// A flat, by its number.
    Flat(u32),
    /// The first body's own image in a mirror.
    Mirror,
}

impl End {
    /// The body's place in the frame, of a body.
    pub fn body(self) -> Option<usize> {
        match self {
            Self::Body(i) => Some(i as usize),
            Self::Flat(_) | Self::Mirror => None,
        }
    }
}

/// A closed contact of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameContact {
    /// What touches.
    pub ends: [End; 2],
    /// Centres of both; of a flat or a mirror the point that is touched.
    pub places: [[f64; 2]; 2],
    /// Normal force, positive where it presses.
    pub normal: f64,
    /// Tangential force on the second body, along the normal from the first to the second turned from x to z.
    pub tangential: f64,
}

/// All that is in the plane at one moment.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Frame {
    /// Time.
    pub time: f64,
    /// Period along x, if any.
    pub period: Option<f64>,
    /// Grains, then walls, then the disks of the intruder.
    pub bodies: Vec<FrameBody>,
    /// Closed contacts, in a fixed order.
    pub contacts: Vec<FrameContact>,
}

impl Frame {
    /// Of a rig of so many grains and disks of walls. A chain lies along z. None in space.
    pub fn of<const D: usize>(simulation: &Simulation<D>, [grains, walls]: [usize; 2]) -> Option<Self> {
        if D > 2 {
            return None;
        }
        let plane = |v: [f64; D]| [if D == 2 { v[0] } else { 0.0 }, v[D - 1]];
        let (rig, view) = (simulation.rig(), simulation.view());
        let body = |i: usize| FrameBody {
            role: match i {
                i if i < grains => Role::Grain,
                i if i < grains + walls => Role::Wall,
                _ => Role::Intruder,
            },
            place: plane(view.position(i)),
            diameter: 2.0 * rig.sample.spheres[i].radius,
            velocity: plane(view.velocity(i)),
            spin: view.spin(i)[2],
            force: plane(view.whole_force(i)),
        };
        let bodies: Vec<FrameBody> = (0..rig.sample.spheres.len()).map(body).collect();
        let contacts = view
            .contacts()
            .map(|touching| {
                let [x, z] = plane(touching.normal);
                let ends = match touching.bodies {
                    [Body::Sphere(i), Body::Sphere(k)] if i == k => [End::Body(i as u32), End::Mirror],
                    bodies => bodies.map(|body| match body {
                        Body::Sphere(i) => End::Body(i as u32),
                        Body::Flat(k) => End::Flat(k as u32),
                    }),
                };
                let at = |k: usize| ends[k].body().map(|i| bodies[i]);
                // Where a sphere touches a flat or a mirror, its radius less its depth away from its centre. A mirror's normal points to
                // the sphere, and its contact shows the overlap of sphere and image.
                let touched = |sphere: FrameBody, sign: f64, depth: f64| {
                    let far = sign * (0.5 * sphere.diameter - depth);
                    [sphere.place[0] + far * x, sphere.place[1] + far * z]
                };
                let places = match [at(0), at(1)] {
                    [Some(a), Some(b)] => [a.place, b.place],
                    [None, Some(b)] => [touched(b, -1.0, touching.overlap), b.place],
                    [Some(a), None] if ends[1] == End::Mirror => [a.place, touched(a, -1.0, 0.5 * touching.overlap)],
                    [Some(a), None] => [a.place, touched(a, 1.0, touching.overlap)],
                    // A flat never comes alone.
                    [None, None] => [[0.0; 2]; 2],
                };
                let along = plane(touching.friction);
                FrameContact { ends, places, normal: touching.force, tangential: along[1] * x - along[0] * z }
            })
            .collect();
        let period = if D == 2 { rig.periods[0] } else { None };
        Some(Self { time: simulation.time(), period, bodies, contacts })
    }

    /// Number of grains.
    pub fn grains(&self) -> usize {
        self.bodies.iter().take_while(|body| body.role == Role::Grain).count()
    }

    /// The network of the grains among themselves, without walls and intruder.
    ///
    /// # Errors
    /// Two grains that touch over both periodic sides, as only beds do that are two grains wide.
    pub fn network(&self) -> Result<Network, NetworkError> {
        let grains = self.grains();
        let among = |contact: &&FrameContact| contact.ends.iter().all(|end| end.body().is_some_and(|i| i < grains));
        let (contacts, branches) = self
            .contacts
            .iter()
            .filter(among)
            .map(|&FrameContact { ends, places: [from, to], normal, tangential }| {
                let grains = ends.map(|end| end.body().unwrap_or_default() as u32);
                (Contact { grains, normal, tangential }, Branch::between(from, to, self.period))
            })
            .unzip();
        Network::new(grains, contacts, Some(branches))
    }

    /// Centres of the grains.
    pub fn places(&self) -> Vec<[f64; 2]> {
        self.bodies[..self.grains()].iter().map(|body| body.place).collect()
    }
}
