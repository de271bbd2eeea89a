//! The whole piece as it is held: between mirrors, as it was designed, or between the walls of a frame, with gaps or settled in it.
//!
//! A mirror line cuts through the outermost spheres of every other row; a wall cannot, and touches these spheres from outside. Rows
//! between end half a diameter before it. Pieces are rigs that find their contacts, so that nothing differs but how they are held.

use super::settle::{GRAVITY, Room, SettleError, settle};
use super::{ImpactLoad, Plan, Subject};
use crate::Context;
use crate::dem::rig::{
    Body, Curve, Face, Flat, Friction, Law, LawBook, Load, LoadKind, Rig, RigError, RigStop, Simulation, rig_step,
};
use crate::dem::{Projectile, steps_in};
use crate::design::Design;
use crate::material::Material;
use crate::sample::{Sample, Sphere};

/// A sphere of the whole piece.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeldSphere {
    /// Its centre (m).
    pub centre: [f64; 2],
    /// (m); zero where the site is empty
    pub diameter: f64,
    /// Place in the palette.
    pub material: usize,
    /// Its row.
    pub row: u32,
    /// The site of the half that it stands on, or whose image it does.
    pub site: usize,
}

/// What holds a piece.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Frame {
    /// Mirrors at the sides, as it was designed; the end is free.
    Mirrors,
    /// Side walls that leave so much room at each side (m), and an end wall that leaves so much (m) where there is one.
    Walls {
        /// Room at each side (m).
        side_gap: f64,
        /// Room at the end (m); none where the end is free.
        end_gap: Option<f64>,
    },
    /// Walls at both sides and at the end, in which the spheres have come to rest under gravity along the axis.
    Settled {
        /// Room at each side before they settle (m).
        side_gap: f64,
        /// Room at the end before they settle (m).
        end_gap: f64,
    },
}

/// A piece in a frame that cannot be simulated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum HeldError {
    /// It cannot be set in motion.
    #[error(transparent)]
    Rig(#[from] RigError),
    /// A guard stopped it, or the caller.
    #[error("{0}")]
    Stopped(RigStop),
    /// It does not stand.
    #[error(transparent)]
    Settle(#[from] SettleError),
}

/// The spheres of a piece on their sites, of nominal diameter.
pub fn held_spheres<'a>(of: impl Into<Subject<'a>>) -> Vec<HeldSphere> {
    let subject: Subject<'_> = of.into();
    let lattice = &subject.layout.lattice;
    let of = |s: crate::layout::PieceSphere| HeldSphere {
        centre: [s.x, s.z],
        diameter: lattice.row_diameter(s.row),
        material: usize::from(s.material),
        row: s.row,
        site: s.site,
    };
    subject.spheres().into_iter().map(of).collect()
}

/// Lets spheres settle in a frame with room at each side and at the end: by how far the farthest moves (m).
///
/// # Errors
/// See [`SettleError`].
pub fn settled(
    design: &Design,
    palette: &[Material],
    spheres: &mut [HeldSphere],
    [side_gap, end_gap]: [f64; 2],
) -> Result<f64, SettleError> {
    let room = room(design, spheres, side_gap, end_gap);
    settle(design, palette, spheres, room)
}

/// Walls touch the outermost spheres on their sites, if these are of nominal diameter, but for the gaps.
fn room(design: &Design, spheres: &[HeldSphere], side_gap: f64, end_gap: f64) -> Room {
    let radius = 0.5 * design.lattice.diameter();
    let far = |axis: usize| spheres.iter().map(|sphere| sphere.centre[axis]).fold(0.0, f64::max);
    Room { side: far(0) + radius + side_gap, depth: far(1) + radius + end_gap }
}

/// Greatest kinetic energy by site of the half (J), the mean of a sphere and its image, of a piece under a blow: its own strike, or a projectile
/// that strikes in its direction and place.
///
/// # Errors
/// See [`HeldError`].
pub fn held_energies(
    (design, plan): (&Design, &Plan),
    palette: &[Material],
    mut spheres: Vec<HeldSphere>,
    (frame, load, projectile): (Frame, &ImpactLoad, Option<Projectile>),
    context: &Context,
) -> Result<Vec<f64>, HeldError> {
    let slack = 1e-9 * design.lattice.diameter();
    let half_width = design.lattice.half_width();
    let walls = match frame {
        Frame::Mirrors => {
            // What repeats itself after twice the half width moves as between mirrors; a sphere on the far one is then its own image.
            spheres.retain(|sphere| sphere.centre[0] > slack - half_width);
            None
        }
        Frame::Walls { side_gap, end_gap } => {
            Some((room(design, &spheres, side_gap, end_gap.unwrap_or(0.0)), end_gap.is_some()))
        }
        Frame::Settled { side_gap, end_gap } => {
            let room = room(design, &spheres, side_gap, end_gap);
            settle(design, palette, &mut spheres, room)?;
            Some((room, true))
        }
    };
    let place = load.place.unwrap_or([-half_width, half_width]);
    // Where spheres have settled they still stand in the column of their site.
    let is_struck = |s: &HeldSphere| {
        s.row == 1
            && (place[0] - 0.25 * design.lattice.diameter()..=place[1] + 0.25 * design.lattice.diameter())
                .contains(&s.centre[0])
    };
    let struck: Vec<bool> = spheres.iter().map(is_struck).collect();
    let there: Vec<usize> = (0..spheres.len()).filter(|&k| spheres[k].diameter > 0.0).collect();
    let friction = load.friction.or(design.friction).filter(|&mu| mu > 0.0);
    let mut rig = Rig::new(
        Sample {
            materials: palette.to_vec(),
            spheres: there
                .iter()
                .map(|&k| &spheres[k])
                .map(|s| Sphere { centre: s.centre, radius: 0.5 * s.diameter, material: s.material })
                .collect(),
        },
        LawBook::Materials {
            law: Law::Named(load.law.unwrap_or(design.law)),
            constants: design.constants,
            pairs: Vec::new(),
            friction: friction.map(Friction::mindlin),
        },
    );
    match walls {
        Some((room, has_end)) => {
            rig.flats.push(Flat::wall("left", [-room.side, 0.0], [1.0, 0.0]));
            rig.flats.push(Flat::wall("right", [room.side, 0.0], [-1.0, 0.0]));
            if has_end {
                rig.flats.push(Flat::wall("end", [0.0, room.depth], [0.0, -1.0]));
            }
        }
        None => rig.periods[0] = Some(2.0 * half_width),
    }
    if matches!(frame, Frame::Settled { .. }) {
        rig.precompressed = true;
        rig.gravity = [0.0, GRAVITY];
    }
    let direction = [load.angle.sin(), load.angle.cos()];
    let front: Vec<&HeldSphere> = there.iter().filter(|&&k| struck[k]).map(|&k| &spheres[k]).collect();
    match projectile.or(load.strike.projectile()) {
        None => rig.loads.push(Load {
            bodies: there.iter().enumerate().filter(|&(_, &k)| struck[k]).map(|(body, _)| Body::Sphere(body)).collect(),
            direction,
            kind: LoadKind::Force,
            curve: Curve::Square {
                peak: load.strike.strength(),
                start: 0.0,
                duration: load.strike.duration().unwrap_or(0.0),
            },
        }),
        Some(Projectile { mass, speed, .. }) => {
            // It arrives as it touches the first of the spheres that it strikes.
            let top = front.iter().map(|s| s.centre[1] - 0.5 * s.diameter).fold(f64::INFINITY, f64::min);
            let radius = 0.5 * design.lattice.diameter();
            let ends = front
                .iter()
                .map(|s| s.centre[0])
                .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)]);
            let face = match load.place {
                None => Face::Plane,
                Some(_) => Face::Polygon(vec![[ends[0] - radius, top], [ends[1] + radius, top]]),
            };
            if !front.is_empty() {
                rig.flats.push(Flat {
                    face,
                    mass,
                    velocity: direction.map(|along| speed * along),
                    held: [false; 2],
                    ..Flat::wall("projectile", [0.0, top], [0.0, 1.0])
                });
            }
        }
    }
    let mass = rig.mass.clone();
    let step = rig_step(plan.integrator, plan.step);
    let mut simulation = Simulation::new(rig, step)?.recording(Vec::new());
    simulation.advance(steps_in(plan.window, step), context).map_err(HeldError::Stopped)?;
    let speed = simulation.greatest_speed();
    let mut energy = vec![[0.0, 0.0]; design.lattice.len()];
    for (body, &k) in there.iter().enumerate() {
        energy[spheres[k].site][0] += 0.5 * mass[body] * speed[body] * speed[body];
    }
    // A site that holds nothing counts with nothing.
    spheres.iter().for_each(|sphere| energy[sphere.site][1] += 1.0);
    Ok(energy.into_iter().map(|[sum, count]| if count > 0.0 { sum / count } else { 0.0 }).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layout::Layout;

    fn quickstart() -> (Design, Layout) {
        let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
        let design = Design::read(root.join("designs/quickstart.toml")).unwrap();
        let layout = Layout::new(design.lattice.clone(), design.palette(), |_| 0);
        (design, layout)
    }

    /// Equal spheres in a frame that fits lie where they were laid, but for the overlaps that carry their weight; the end wall carries all of it.
    #[test]
    fn equal_spheres_settle_where_they_were() {
        let (design, layout) = quickstart();
        let mut spheres = held_spheres(&layout);
        let moved = settled(&design, &layout.palette, &mut spheres, [0.0; 2]).unwrap();
        // Some 50 rows, each pressed by at most a third of a micrometre.
        assert!(moved > 1e-7 && moved < 50.0 * 0.4e-6, "{moved}");
        let last: Vec<&HeldSphere> = spheres.iter().filter(|s| s.row == design.lattice.rows()).collect();
        let radius = 0.5 * design.lattice.diameter();
        let floor = spheres.iter().map(|s| design.lattice.depth(f64::from(s.row))).fold(0.0, f64::max) + radius;
        let pair = crate::contact::Pair::new([&layout.palette[0]; 2], [radius; 2], design.constants);
        let push =
            |s: &&HeldSphere| pair.hertz_coefficient() * (2.0 * (s.centre[1] + radius - floor).max(0.0)).powf(1.5);
        let carried: f64 = last.iter().map(push).sum();
        let weight = spheres.len() as f64 * layout.palette[0].sphere_mass(2.0 * radius) * GRAVITY;
        assert!((carried / weight - 1.0).abs() < 1e-2, "{carried} N of {weight} N");
    }

    /// A stack whose floor is missing falls.
    #[test]
    fn a_stack_without_a_floor_does_not_stand() {
        let (design, layout) = quickstart();
        let mut spheres = held_spheres(&layout);
        let fallen = settled(&design, &layout.palette, &mut spheres, [0.0, 0.4 * design.lattice.diameter()]);
        assert!(matches!(fallen, Err(SettleError::Falls { .. })), "{fallen:?}");
    }
}
