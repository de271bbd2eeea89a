//! An impact on a crystal as a rig: where friction acts, or where spheres meet that did not touch at rest.

use super::{
    Arrival, Body, Curve, Flat, FlatContact, Friction, Law, LawBook, Load, LoadKind, Rig, RigError, RigStop, Simulation,
};
use crate::Context;
use crate::dem::follow::first_top;
use crate::dem::{ForcePulse, Impact, Integrator, Ledger, MoveIn, Projectile, Record, Spheres, Stop, Strike, steps_in};
use crate::sample::Sample;

impl<const D: usize> Rig<D> {
    /// What strikes: a load on the struck bodies along the last axis, or a smooth flat whose face touches them at `top` (m) on that axis. As of all flats
    /// the mass is the whole one, whatever mirrors leave of it.
    pub fn strike(&mut self, strike: Strike, struck: Vec<Body>, top: f64) {
        let along = std::array::from_fn(|axis| if axis + 1 == D { 1.0 } else { 0.0 });
        match strike {
            Strike::Pulse(ForcePulse { force, duration }) => {
                let curve = Curve::Square { peak: force, start: 0.0, duration };
                self.loads.push(Load { bodies: struck, direction: along, kind: LoadKind::Force, curve });
            }
            Strike::Projectile(Projectile { mass, speed, .. }) => {
                let held = std::array::from_fn(|axis| axis + 1 < D);
                let (point, velocity) = (along.map(|along| top * along), along.map(|along| speed * along));
                // Where spheres rub each other it is smooth all the same.
                let rubs = matches!(self.laws, LawBook::Materials { friction: Some(_), .. });
                let contact = FlatContact { friction: rubs.then(|| Friction::mindlin(0.0)), ..FlatContact::default() };
                self.flats.push(Flat { mass, velocity, held, contact, ..Flat::wall("projectile", point, along) });
            }
        }
    }
}

/// Follows an impact as [`simulate`](crate::dem::simulate) does, with friction if asked for, and with contacts that come and
/// go. By the impact's scheme and step; where that is Runge-Kutta's, by velocity Verlet. Losses by friction count as dissipated; the springs of friction as stored.
///
/// # Errors
/// See [`RigError`]. A run that a guard stops is no error: its record says why.
pub fn simulate_as_rig<const D: usize>(
    sample: &Sample<D>,
    impact: &Impact,
    friction: Option<Friction>,
    context: &Context,
) -> Result<Record<D>, RigError>
where
    Spheres: MoveIn<D>,
{
    if !impact.faces.is_empty() {
        return Err(RigError::Faces);
    }
    let laws =
        LawBook::Materials { law: Law::Named(impact.law), constants: impact.constants, pairs: Vec::new(), friction };
    let mut rig = Rig::new(sample.clone(), laws);
    rig.mirrors.clone_from(&impact.mirrors);
    for period in &impact.periods {
        rig.periods[period.axis] = Some(period.length);
    }
    let mut direction = [0.0; D];
    let pulse = impact.pulse;
    // A load has one direction; the slope makes it longer than its part along the last axis.
    let slope = if D > 1 { impact.slope } else { 0.0 };
    let length = (1.0 + slope * slope).sqrt();
    direction[0] = slope / length;
    direction[D - 1] = 1.0 / length;
    rig.loads = vec![Load {
        bodies: impact.struck.iter().map(|&i| Body::Sphere(i)).collect(),
        direction,
        kind: LoadKind::Force,
        curve: Curve::Square { peak: pulse.force * length, start: 0.0, duration: pulse.duration },
    }];
    if let Some(flat) = impact.projectile {
        rig.loads.clear();
        let mass = flat.mass * 2.0_f64.powi(rig.mirrors.len() as i32);
        let front = flat.front.unwrap_or_else(|| first_top(&[sample], &impact.struck));
        rig.strike(Projectile { mass, ..flat }.into(), Vec::new(), front);
    }
    for &(i, speed) in &impact.moving {
        rig.velocity[i][D - 1] = speed;
    }
    let mass = rig.mass.clone();
    let step = impact.step;
    let integrator = if impact.integrator == Integrator::Rk4 { Integrator::Verlet } else { impact.integrator };
    let mut simulation = Simulation::by(integrator, rig, step)?.recording(vec![Arrival::OwnMaximum(0.01)]);
    let (mut exit_momentum, mut exit_force) = (0.0_f64, 0.0_f64);
    let stop = simulation
        .follow(steps_in(impact.window, step), context, |view| {
            let momentum: f64 =
                impact.exit.iter().map(|&i| view.simulated_fraction(i) * mass[i] * view.velocity(i)[D - 1]).sum();
            let force: f64 = impact.exit.iter().map(|&i| view.net_force(i)[D - 1]).sum();
            exit_momentum = exit_momentum.max(momentum);
            exit_force = exit_force.max(force);
        })
        .err();
    let spheres = sample.spheres.len();
    let contacts = simulation.contacts_ever();
    let mut max_contact_force = vec![0.0_f64; spheres];
    let mut estimate = 0.0;
    for contact in &contacts {
        estimate += contact.weight * 0.5 * contact.overlap_max * contact.force_max;
        for i in contact.spheres {
            max_contact_force[i] = max_contact_force[i].max(contact.force_max);
        }
    }
    let energy = simulation.ledger();
    let view = simulation.view();
    Ok(Record {
        max_kinetic: (0..spheres).zip(simulation.greatest_speed()).map(|(i, v)| 0.5 * mass[i] * v * v).collect(),
        max_net_force: simulation.greatest_force(),
        max_contact_force,
        arrival: simulation.arrivals(0),
        dissipated: simulation.dissipated(),
        contacts,
        ledger: Ledger {
            work_in: energy.work_in,
            kinetic: energy.kinetic,
            stored: energy.stored + energy.tangential_stored,
            dissipated: energy.dissipated + energy.friction + energy.absorbed,
            estimate,
        },
        exit_momentum,
        exit_force,
        projectile: impact
            .projectile
            .map(|_| view.flat(0))
            .map(|flat| [flat.moved, flat.velocity].map(|along| along[D - 1])),
        displacement: (0..spheres).map(|i| view.displacement(i)).collect(),
        velocity: (0..spheres).map(|i| view.velocity(i)).collect(),
        steps: simulation.steps(),
        stop: stop.map(translate),
    })
}

/// The step (s) by which velocity Verlet follows what was planned for an integrator and a step.
pub fn rig_step(integrator: Integrator, step: f64) -> f64 {
    if integrator == Integrator::Adams { 0.5 * step } else { step }
}

/// A rig's guard in the words of an impact; on a crystal without flats every body is a sphere.
fn translate(stop: RigStop) -> Stop {
    let sphere = |body: Body| match body {
        Body::Sphere(i) | Body::Flat(i) => i + 1,
    };
    match stop {
        RigStop::Interrupted { time } => Stop::Interrupted { time_s: time },
        RigStop::NotFinite { body, time } | RigStop::Escaped { body, time } => {
            Stop::NotFinite { sphere: sphere(body), time_s: time }
        }
        RigStop::Overlap { bodies, ratio, limit, time } => {
            Stop::Overlap { spheres: bodies.map(sphere), overlap_ratio: ratio, limit, time_s: time }
        }
        RigStop::Step { step, limit, stiffness, bodies, time }
        | RigStop::Coarse { step, limit, stiffness, bodies, time } => {
            Stop::Step { step_s: step, limit_s: limit, stiffness, spheres: bodies.map(sphere), time_s: time }
        }
        RigStop::Residual { residual, .. } => Stop::Residual { residual },
    }
}
