//! What can be wrong with a rig before it is set in motion.

use std::fmt;

use super::pairs::Finder;
use super::{Body, LoadKind, Rig};
use crate::dem::Integrator;

/// A rig that cannot be set in motion.
#[derive(Clone, Debug, PartialEq)]
pub enum RigError {
    /// Two bodies overlap before anything happens, and the rig is not said to be precompressed.
    Overlap {
        /// The two.
        bodies: [Body; 2],
        /// By how much (m).
        overlap: f64,
    },
    /// A period within which a sphere would meet two images of another.
    Period {
        /// The period (m).
        period: f64,
        /// What it must be at least (m).
        least: f64,
    },
    /// An array of the rig has not one entry per sphere.
    Shape(&'static str),
    /// A number of the rig is not finite, or not positive where it must be.
    Value {
        /// What it is.
        what: &'static str,
        /// Whose.
        body: Body,
        /// Its value.
        value: f64,
    },
    /// A load or bar names a body that is not there.
    Missing {
        /// The body.
        body: Body,
        /// How many of its kind there are.
        count: usize,
    },
    /// A scheme that rigs do not know.
    Scheme(Integrator),
    /// Faces across no axis: rigs know planes across axes.
    Faces,
    /// The step is not positive, or too large for the contacts present at the start.
    Step {
        /// The step (s).
        step: f64,
        /// What it must stay below (s).
        limit: f64,
    },
    /// A member of a cluster that does not exist, belongs to two, is held, moved or loaded by itself; or a cluster that makes no sense.
    Cluster(usize, &'static str),
    /// Friction in space between mirrors, on which spheres could spin about one axis only.
    MirroredFriction,
    /// Friction without a spring and without damping, which would do nothing.
    Frictionless,
    /// A body is fixed to a bar and has its velocity prescribed.
    Bound(Body),
}

impl std::error::Error for RigError {}

impl fmt::Display for RigError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.words(&|body| body.to_string()))
    }
}

impl RigError {
    /// In words, with bodies as `name` calls them.
    pub fn words(&self, name: &dyn Fn(Body) -> String) -> String {
        match self {
            Self::Overlap { bodies: [a, b], overlap } => {
                format!("{} and {} overlap by {overlap:.3e} m before the impact", name(*a), name(*b))
            }
            Self::Period { period, least } => {
                format!("a period of {period:.3e} m is too short; these spheres need {least:.3e} m")
            }
            Self::Shape(what) => format!("{what} has not one entry per sphere"),
            Self::Value { what, body, value } => {
                format!("{what} of {} is {value}, which cannot be simulated", name(*body))
            }
            Self::Missing { body, count } => {
                format!("a load or bar acts on {}, and there are only {count}", name(*body))
            }
            Self::Scheme(scheme) => {
                format!("rigs are advanced by verlet or adams, not by {scheme}, which asks for forces several times a step")
            }
            Self::Faces => "rigs know planes of symmetry across axes, and walls as flats; this impact has others".to_owned(),
            Self::Step { step, limit } => {
                format!("a step of {step:.3e} s cannot be used; it must be positive and below {limit:.3e} s")
            }
            Self::Cluster(which, why) => format!("cluster {which} cannot be simulated: {why}"),
            Self::MirroredFriction => {
                "friction in space does not go with mirrors; simulate the whole crystal".to_owned()
            }
            Self::Frictionless => {
                "friction without a spring and without damping would do nothing, nor would resistance to rolling without a \
                 spring; it needs one of both, such as the spring of elastic spheres (Mindlin)"
                    .to_owned()
            }
            Self::Bound(body) => {
                format!("{} is fixed to a bar, so that its velocity cannot be prescribed", name(*body))
            }
        }
    }
}

/// What can be wrong with a rig by itself.
pub(super) fn check<const D: usize>(rig: &Rig<D>, step: f64) -> Result<(), RigError> {
    let count = rig.sample.spheres.len();
    let shapes = [
        ("mass", rig.mass.len()),
        ("inertia", rig.inertia.len()),
        ("velocity", rig.velocity.len()),
        ("spin", rig.spin.len()),
        ("held", rig.held.len()),
    ];
    if let Some((what, _)) = shapes.into_iter().find(|(_, len)| *len != count) {
        return Err(RigError::Shape(what));
    }
    if !(step > 0.0 && step.is_finite()) {
        return Err(RigError::Step { step, limit: f64::INFINITY });
    }
    let positive = |what, body, value: f64| match value > 0.0 && value.is_finite() {
        true => Ok(()),
        false => Err(RigError::Value { what, body, value }),
    };
    for (i, sphere) in rig.sample.spheres.iter().enumerate() {
        let body = Body::Sphere(i);
        positive("the radius", body, sphere.radius)?;
        positive("the mass", body, rig.mass[i])?;
        positive("the moment of inertia", body, rig.inertia[i])?;
        let numbers = sphere.centre.iter().chain(&rig.velocity[i]).chain(&rig.spin[i]);
        if let Some(&value) = numbers.into_iter().find(|x| !x.is_finite()) {
            return Err(RigError::Value { what: "a coordinate, velocity or spin", body, value });
        }
    }
    for (f, flat) in rig.flats.iter().enumerate() {
        let body = Body::Flat(f);
        if flat.mass.is_nan() || flat.mass <= 0.0 {
            return Err(RigError::Value { what: "the mass", body, value: flat.mass });
        }
        let length = flat.normal.iter().map(|n| n * n).sum::<f64>().sqrt();
        if length.is_nan() || (length - 1.0).abs() > 1e-9 {
            return Err(RigError::Value { what: "the length of the normal", body, value: length });
        }
    }
    let present = |body: Body| {
        let (place, count) = match body {
            Body::Sphere(i) => (i, count),
            Body::Flat(f) => (f, rig.flats.len()),
        };
        if place < count { Ok(()) } else { Err(RigError::Missing { body, count }) }
    };
    rig.loads.iter().flat_map(|load| &load.bodies).try_for_each(|&body| present(body))?;
    for bar in &rig.bars {
        present(bar.body)?;
        positive("the impedance of the bar", bar.body, bar.impedance)?;
        let prescribed = rig.loads.iter().filter(|load| load.kind == LoadKind::Velocity);
        if prescribed.flat_map(|load| &load.bodies).any(|&body| body == bar.body) {
            return Err(RigError::Bound(bar.body));
        }
    }
    let mut member = vec![false; count];
    for (c, cluster) in rig.clusters.iter().enumerate() {
        let wrong = |why| Err(RigError::Cluster(c + 1, why));
        for &i in &cluster.members {
            if i >= count || std::mem::replace(&mut member[i], true) {
                return wrong("a member does not exist or belongs to two clusters");
            }
            let loaded = rig.loads.iter().flat_map(|load| &load.bodies).chain(rig.bars.iter().map(|bar| &bar.body));
            if rig.held[i].contains(&true) || loaded.into_iter().any(|&body| body == Body::Sphere(i)) {
                return wrong("a member is held, loaded or fixed to a bar by itself");
            }
        }
        let numbers = cluster.centre.iter().chain(&cluster.velocity).chain([&cluster.spin]);
        if cluster.members.is_empty() || !numbers.into_iter().all(|x| x.is_finite()) {
            return wrong("it has no members, or a number that is not finite");
        }
        if !(cluster.mass > 0.0 && cluster.inertia > 0.0 && cluster.mass.is_finite() && cluster.inertia.is_finite()) {
            return wrong("mass and moment of inertia must be positive");
        }
        if cluster.turns && D != 2 {
            return wrong("only in the plane can a cluster turn");
        }
        if !rig.mirrors.is_empty() {
            return wrong("clusters do not go with mirrors");
        }
    }
    if D == 3 && rig.has_friction() && !rig.mirrors.is_empty() {
        return Err(RigError::MirroredFriction);
    }
    if rig.frictions().any(|friction| friction.does_nothing()) {
        return Err(RigError::Frictionless);
    }
    let least = Finder::new(rig).shortest_period();
    for period in rig.periods.into_iter().flatten() {
        if period.is_nan() || period < least {
            return Err(RigError::Period { period, least });
        }
    }
    Ok(())
}
