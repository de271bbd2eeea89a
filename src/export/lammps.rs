//! LAMMPS: a data file, an input deck, and trajectories in its dump format.
//!
//! The deck runs the rig with the package GRANULAR: `pair_style granular` with `hertz`, F = k √r* δ^{3/2}, k = (4/3) E*, without
//! damping and tangential forces, integrated by `fix nve/sphere`. Both programs then follow the same equations by the same
//! scheme (velocity Verlet; the load is constant over whole steps), so that trajectories differ by rounding and its growth
//! only.

use std::fmt::Write as _;

use super::{axis_in_space, ends, in_space};
use crate::contact::{LawKind, Pair};
use crate::dem::rig::{Body, Curve, Law, LawBook, LoadKind, Rig, Simulation};

/// The two files by which LAMMPS runs a rig.
#[derive(Clone, Debug, PartialEq)]
pub struct Deck {
    /// Spheres, box and velocities, for `read_data`.
    pub data: String,
    /// The commands.
    pub input: String,
}

/// A rig that the deck cannot describe.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DeckError {
    /// Contacts that are not Hertz's.
    #[error("LAMMPS has no counterpart of the contact law \"{0}\"; export with the law hertz")]
    Law(String),
    /// Something else of the rig.
    #[error("the deck cannot describe {0}; leave it out, or take the periodic crystal in place of mirrors")]
    Part(&'static str),
    /// A load that does not cover whole steps from the start.
    #[error("a pulse of {duration:.6e} s is no whole number of steps of {step:.6e} s; choose a step that divides it")]
    Pulse {
        /// How long the load lasts (s).
        duration: f64,
        /// The step (s).
        step: f64,
    },
    /// Numbers of steps that make no run.
    #[error("{steps} steps, looked at every {every}: both must be positive")]
    Steps {
        /// Steps of the run.
        steps: u64,
        /// Steps between two frames.
        every: u64,
    },
}

/// The deck for a run of `steps` steps of `step` (s) that writes a frame every so many steps, as [`dump_frame`] does.
///
/// # Errors
/// See [`DeckError`]: everything but spheres with Hertz contacts, periods, velocities and square pulses that begin at once.
pub fn deck<const D: usize>(rig: &Rig<D>, step: f64, steps: u64, every: u64) -> Result<Deck, DeckError> {
    if steps == 0 || every == 0 {
        return Err(DeckError::Steps { steps, every });
    }
    let pairs = pair_coefficients(rig)?;
    let parts: [(bool, &'static str); 7] = [
        (!rig.clusters.is_empty(), "rigid bodies of several spheres"),
        (!rig.mirrors.is_empty(), "mirrors"),
        (!rig.flats.is_empty(), "flats"),
        (!rig.bars.is_empty(), "bars"),
        (rig.held.iter().flatten().any(|&held| held), "spheres that are held"),
        (rig.gravity.iter().any(|&g| g != 0.0), "gravity"),
        (rig.drag != 0.0, "drag"),
    ];
    if let Some((_, what)) = parts.into_iter().find(|(present, _)| *present) {
        return Err(DeckError::Part(what));
    }
    let loads = loads(rig, step)?;
    Ok(Deck { data: data(rig), input: input(rig, &pairs, &loads, step, steps, every) })
}

/// For each pair of types k (Pa).
fn pair_coefficients<const D: usize>(rig: &Rig<D>) -> Result<Vec<(usize, usize, f64)>, DeckError> {
    let LawBook::Materials { law, constants, pairs, .. } = &rig.laws else {
        return Err(DeckError::Law("spring and dashpot".to_owned()));
    };
    if rig.has_friction() {
        return Err(DeckError::Part("friction"));
    }
    let mut found = Vec::new();
    let materials = &rig.sample.materials;
    for i in 0..materials.len() {
        for j in i..materials.len() {
            let own = pairs.iter().find(|rule| rule.is_of([i, j])).and_then(|rule| rule.law.as_ref());
            match own.unwrap_or(law) {
                Law::Named(LawKind::Hertz) => {}
                Law::Named(other) => return Err(DeckError::Law(other.name().to_owned())),
                Law::Tabulated(_) => return Err(DeckError::Law("a table".to_owned())),
                Law::SpringDashpot(_) => return Err(DeckError::Law("spring-dashpot".to_owned())),
            }
            // Radii do not enter E*.
            let pair = Pair::new([&materials[i], &materials[j]], [1.0; 2], *constants);
            found.push((i + 1, j + 1, 4.0 / 3.0 * pair.modulus));
        }
    }
    Ok(found)
}

/// What pushes which spheres (numbered from 1) for so many steps, with a force in space (N).
struct Push {
    spheres: Vec<usize>,
    force: [f64; 3],
    steps: u64,
}

/// Whether a pulse covers whole steps.
fn is_whole(duration: f64, step: f64) -> bool {
    let whole = (duration / step).round();
    whole >= 1.0 && (duration / step - whole).abs() <= 1e-9
}

fn loads<const D: usize>(rig: &Rig<D>, step: f64) -> Result<Vec<Push>, DeckError> {
    let mut pushes = Vec::new();
    for load in &rig.loads {
        let Curve::Square { peak, start, duration } = load.curve else {
            return Err(DeckError::Part("loads that are no square pulses"));
        };
        if load.kind != LoadKind::Force || start != 0.0 {
            return Err(DeckError::Part("loads other than forces that begin at once"));
        }
        if !is_whole(duration, step) {
            return Err(DeckError::Pulse { duration, step });
        }
        let spheres = load.bodies.iter().map(|body| match body {
            Body::Sphere(k) => Ok(k + 1),
            Body::Flat(_) => Err(DeckError::Part("loads on flats")),
        });
        let force = in_space(load.direction).map(|x| x * peak);
        pushes.push(Push {
            spheres: spheres.collect::<Result<_, _>>()?,
            force,
            steps: (duration / step).round() as u64,
        });
    }
    // The deck ends them one after another.
    pushes.sort_by_key(|push| push.steps);
    Ok(pushes)
}

fn data<const D: usize>(rig: &Rig<D>) -> String {
    let spheres = &rig.sample.spheres;
    let mut text = format!(
        "granulens crystal: spheres of {} (SI)\n\n{} atoms\n{} atom types\n\n",
        rig.sample.materials.iter().map(|m| m.name.as_str()).collect::<Vec<_>>().join(", "),
        spheres.len(),
        rig.sample.materials.len()
    );
    let mut ends = ends(rig);
    for (axis, period) in rig.periods.iter().enumerate() {
        if let Some(period) = period {
            let k = axis_in_space::<D>(axis);
            let low = spheres.iter().map(|s| s.centre[axis]).fold(f64::INFINITY, f64::min);
            ends[k] = [low, low + period];
        }
    }
    for (end, name) in ends.iter().zip(["x", "y", "z"]) {
        let _ = writeln!(text, "{:e} {:e} {name}lo {name}hi", end[0], end[1]);
    }
    // id type diameter density x y z
    text.push_str("\nAtoms # sphere\n\n");
    for (k, sphere) in spheres.iter().enumerate() {
        let diameter = 2.0 * sphere.radius;
        let density = rig.mass[k] / (std::f64::consts::PI / 6.0 * diameter.powi(3));
        let [x, y, z] = in_space(sphere.centre);
        let _ = writeln!(text, "{} {} {diameter:e} {density:e} {x:e} {y:e} {z:e}", k + 1, sphere.material + 1);
    }
    // id vx vy vz and spin
    text.push_str("\nVelocities\n\n");
    for (k, &velocity) in rig.velocity.iter().enumerate() {
        let [x, y, z] = in_space(velocity);
        let _ = writeln!(text, "{} {x:e} {y:e} {z:e} 0 0 0", k + 1);
    }
    text
}

fn input<const D: usize>(
    rig: &Rig<D>,
    pairs: &[(usize, usize, f64)],
    pushes: &[Push],
    step: f64,
    steps: u64,
    every: u64,
) -> String {
    let plane = D < 3;
    let boundary: Vec<&str> = (0..3)
        .map(|k| {
            let repeats = (0..D).any(|axis| axis_in_space::<D>(axis) == k && rig.periods[axis].is_some());
            if repeats || (plane && k == 2) { "p" } else { "s" }
        })
        .collect();
    let radius = rig.sample.spheres.iter().map(|s| s.radius).fold(0.0, f64::max);
    let mut text = format!(
        "# lmp -in in.crystal, with the package GRANULAR\n\
         units si\n\
         atom_style sphere\n\
         dimension {}\n\
         boundary {}\n\
         newton off\n\
         comm_modify vel yes\n\
         read_data crystal.data\n\
         neighbor {:e} bin\n\
         neigh_modify delay 0 every 1 check yes\n\
         pair_style granular\n",
        if plane { 2 } else { 3 },
        boundary.join(" "),
        0.5 * radius
    );
    for (i, j, coefficient) in pairs {
        let _ = writeln!(
            text,
            "pair_coeff {i} {j} hertz {coefficient:e} 0.0 tangential linear_nohistory 0.0 0.0 damping velocity"
        );
    }
    let _ = writeln!(text, "timestep {step:e}\nfix motion all nve/sphere");
    if plane {
        text.push_str("fix plane all enforce2d\n");
    }
    for (k, push) in pushes.iter().enumerate() {
        let k = k + 1;
        let _ = write!(text, "group struck{k} id");
        for (n, sphere) in push.spheres.iter().enumerate() {
            let _ = write!(text, "{}{sphere}", if n > 0 && n % 20 == 0 { " &\n    " } else { " " });
        }
        let [x, y, z] = push.force;
        let _ = writeln!(text, "\nfix push{k} struck{k} addforce {x:e} {y:e} {z:e}");
    }
    let _ = write!(
        text,
        "dump frames all custom {every} lammps.dump id type xu yu zu vx vy vz\n\
         dump_modify frames sort id format float %.17g\n\
         thermo {every}\n"
    );
    // A fix that ends between two runs leaves the first half of the next step without its force, as it must.
    let mut done = 0;
    for (k, push) in pushes.iter().enumerate() {
        let until = push.steps.min(steps);
        if until > done {
            let _ = writeln!(text, "run {}", until - done);
            done = until;
        }
        let _ = writeln!(text, "unfix push{}", k + 1);
    }
    if steps > done {
        let _ = writeln!(text, "run {}", steps - done);
    }
    text
}

/// The present state as a frame of a dump with the columns of the deck's.
pub fn dump_frame<const D: usize>(simulation: &Simulation<D>) -> String {
    let view = simulation.view();
    let spheres = &simulation.rig().sample.spheres;
    let mut text = format!(
        "ITEM: TIMESTEP\n{}\nITEM: NUMBER OF ATOMS\n{}\nITEM: ATOMS id type xu yu zu vx vy vz\n",
        simulation.steps(),
        spheres.len()
    );
    for (k, sphere) in spheres.iter().enumerate() {
        let ([x, y, z], [u, v, w]) = (in_space(view.position(k)), in_space(view.velocity(k)));
        let _ = writeln!(text, "{} {} {x:e} {y:e} {z:e} {u:e} {v:e} {w:e}", k + 1, sphere.material + 1);
    }
    text
}
