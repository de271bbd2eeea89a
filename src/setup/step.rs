//! Which step a rig needs, so that the run is as accurate as is asked for, from what can happen in it.
//!
//! A contact of stiffness K between bodies of reduced mass m̄ moves as fast as ω = √(K/m̄). What decides is the stiffest that may
//! arise. Under a force that is what has carried the greatest one, in a crystal whose contacts are all as stiff (the stability limit
//! over a divisor, as for lenses); in a blow it is the contact of two bodies that meet at the greatest speed. Speeds are bounded from
//! above: given ones, those of prescribed motion, of bars, of a fall, and of what a force drives across a gap. Bounds cost
//! little, since K grows with the speed to the power 2/5 at most. What they miss is seen in the run, which is then begun again
//! with half the step (`run`). A crystal under a pulse has the step that a lens design of the same crystal has with the same scheme.

use crate::contact::{AnyLaw, Dashpot, History, LawKind, NormalLaw, Pair};
use crate::dem::rig::{
    Body, Curve, Face, Flat, FlatContact, Law, LawBook, Load, LoadKind, Loss, Rig, Simulation, Spring,
};
use crate::dem::{Integrator, MoveIn, Spheres};
use crate::design::Accuracy;
use crate::evaluate::{IN_PULSE, Stiffest, dividing, divisor, overshoot};
use crate::material::Material;
use crate::period::nearest_image;
use crate::units::Dimension::{Speed, Stiffness, Time};

use super::handed::handed_on;

/// Greatest ω h of a blow. Verlet's peak force then errs by −0.083 (ω h)² to +0.042 (ω h)² under Hertz's law (the peak lies up to half
/// a step beside a state; the rest is the scheme's), its duration by less.
const fn in_blow(accuracy: Accuracy) -> f64 {
    match accuracy {
        Accuracy::TenthPercent => 0.1,
        Accuracy::OnePercent => 0.3,
    }
}

/// The part of that under a law that turns late ([`LawKind::turns_late`]): the last state before the turn lies up to a whole step beside the
/// peak, whose force then errs by up to −(ω h)²/2. And under [`LawKind::Tsuji`], whose force begins with an infinite slope, so that the balance errs as
/// (ω h)^{5/4}.
const SHARP: f64 = 0.4;

/// Greatest (1 + η) ω h of a blow between springs and dashpots, c = η √(k m̄): restitution is then exact to the class, for e from 0.05
/// to 1, cut or not, wherever in a step the bodies meet (test `restitution_is_that_of_each_pair`).
const fn in_damped_blow(accuracy: Accuracy) -> f64 {
    match accuracy {
        Accuracy::TenthPercent => 0.065,
        Accuracy::OnePercent => 0.2,
    }
}

/// Greatest h √(K/m̄) of any contact that arises in a run whose step was chosen; see [`Rig::resolution`]. A fifth above what is chosen for
/// chains, where it is the most.
pub(super) const fn resolution(accuracy: Accuracy) -> f64 {
    match accuracy {
        Accuracy::TenthPercent => 0.125,
        Accuracy::OnePercent => 0.5,
    }
}

/// The step that a rig needs.
pub(super) struct Needed {
    /// (s); infinite where nothing can happen.
    pub step: f64,
    /// Why, in words.
    pub reason: String,
}

impl Needed {
    fn at_most(&mut self, step: f64, reason: impl FnOnce() -> String) {
        if step < self.step {
            (self.step, self.reason) = (step, reason());
        }
    }
}

/// A kind of body that contacts are made of: the smallest and lightest of a material.
struct Kind {
    material: usize,
    radius: f64,
    mass: f64,
    /// Whether any sphere of the crystal is of it.
    in_crystal: bool,
}

/// The step for a rig whose first `crystal` spheres are those of its crystal, over a window (s).
pub(super) fn needed<const D: usize>(
    rig: &Rig<D>,
    crystal: usize,
    window: f64,
    accuracy: Accuracy,
    integrator: Integrator,
) -> Needed
where
    Spheres: MoveIn<D>,
{
    let class = crate::units::Dimension::Fraction.show(accuracy.fraction());
    let mut needed = Needed { step: f64::INFINITY, reason: "nothing acts".to_owned() };
    let LawBook::Materials { law, .. } = &rig.laws else { return needed };
    let laws = Laws::of(rig, crystal);
    let (speed, why) = greatest_speed(rig, window);
    let closing = 2.0 * speed;

    // What blows press with is handed on to the other contacts of the crystal.
    let mut force = overshoot_of(law) * greatest_force(rig);
    if speed > 0.0 {
        for (a, kind) in laws.kinds.iter().enumerate().filter(|(_, kind)| kind.in_crystal) {
            force = force.max(collision_force(&*laws.between(a, a), kind.mass, closing, kind.radius));
        }
    }
    let materials: &[Material] = &rig.sample.materials;
    let stiffest = Stiffest::find::<D>(
        materials,
        |a| laws.kinds.iter().find(|kind| kind.material == a).map_or(1e3, |kind| 2.0 * kind.radius),
        force,
        |a, b| {
            let place = |m: usize| laws.kinds.iter().position(|kind| kind.material == m);
            // What the palette holds and no sphere is made of has no say.
            place(a).zip(place(b)).map_or(0.0, |(a, b)| laws.between(a, b).stiffness_max(force))
        },
    );
    // Where friction's springs act every scheme is of second order.
    let parts = divisor(accuracy, if rig.has_friction() { Integrator::Verlet } else { integrator });
    if force > 0.0 {
        needed.at_most(stiffest.limit / parts, || format!("{class} class: {} over {parts}", stiffest.words()));
    }

    // Two spheres, or a sphere and a flat with a rule of its own; other flats stand for equal spheres.
    let mut meetings = Vec::new();
    for (a, first) in laws.kinds.iter().enumerate() {
        for (b, second) in laws.kinds.iter().enumerate().skip(a) {
            let names = format!("{} on {}", materials[first.material].name, materials[second.material].name);
            let mass = 1.0 / (1.0 / first.mass + 1.0 / second.mass);
            let (law, size) = (laws.law(first.material, second.material), first.radius.min(second.radius));
            meetings.push((names, law, laws.between(a, b), [mass, first.mass.min(second.mass)], size));
        }
        for flat in rig.flats.iter().filter(|flat| flat.contact != FlatContact::default()) {
            let (law, normal) = laws.at_flat(a, flat);
            let stands_for = if flat.contact.material.is_some() { 1.0 } else { 0.5 };
            let mass = stands_for / (1.0 / first.mass + 1.0 / flat.mass);
            let names = format!("{} on flat {}", materials[first.material].name, flat.name);
            meetings.push((names, law, normal, [mass, first.mass.min(flat.mass)], first.radius));
        }
    }
    for (names, law, normal, [mass, lighter], size) in &meetings {
        if let Law::SpringDashpot(law) = law {
            let natural = (law.stiffness / mass).sqrt();
            let ratio = match law.loss {
                Loss::Ratio(ratio) => ratio,
                Loss::Rate(rate) => rate / natural,
            };
            needed.at_most(in_damped_blow(accuracy) / (natural * (1.0 + ratio)), || {
                format!("{class} class: blows of {names} last {}", Time.show(std::f64::consts::PI / natural))
            });
        } else if speed > 0.0 {
            let sharp = matches!(law, Law::Named(kind) if kind.turns_late() || *kind == LawKind::Tsuji);
            let resolved = if sharp { SHARP * in_blow(accuracy) } else { in_blow(accuracy) };
            let stiffness = normal.stiffness_max(collision_force(&**normal, *lighter, closing, *size));
            needed.at_most(resolved * (mass / stiffness).sqrt(), || {
                format!(
                    "{class} class: blows of {names} at up to {} ({why}), {} at most",
                    Speed.show(closing),
                    Stiffness.show(stiffness)
                )
            });
        }
        for friction in rig.frictions() {
            let Spring::Constant(stiffness) = friction.spring else { continue };
            // A solid sphere gives way to a tangential force 7/2 times as readily, since it turns.
            needed.at_most(in_blow(accuracy) * (mass / (3.5 * stiffness)).sqrt(), || {
                format!("{class} class: the tangential spring of {names}")
            });
        }
    }
    if rig.drag > 0.0 {
        needed.at_most(in_blow(accuracy) / rig.drag, || format!("{class} class: drag"));
    }
    let pulse = shortest_pulse(rig) / IN_PULSE;
    needed.at_most(pulse, || format!("a {IN_PULSE}th of the shortest pulse"));
    needed
}

/// The greatest step up to `step` (s) of which every square pulse of a rig is a whole number; none where there is no such pulse, nor
/// such a step down to a thousandth of the shortest one over that.
pub fn dividing_step<const D: usize>(rig: &Rig<D>, step: f64) -> Option<f64> {
    let square = |load: &Load<D>| match load.curve {
        Curve::Square { duration, .. } => Some(duration),
        _ => None,
    };
    let pulses: Vec<f64> = rig.loads.iter().filter_map(square).collect();
    dividing(step, &pulses)
}

/// The kinds of bodies of a rig, and the laws between them.
struct Laws<'a, const D: usize> {
    rig: &'a Rig<D>,
    kinds: Vec<Kind>,
}

impl<'a, const D: usize> Laws<'a, D> {
    fn of(rig: &'a Rig<D>, crystal: usize) -> Self {
        let mut mass = rig.mass.clone();
        for cluster in &rig.clusters {
            cluster.members.iter().for_each(|&i| mass[i] = cluster.mass);
        }
        let mut kinds: Vec<Kind> = Vec::new();
        for (i, sphere) in rig.sample.spheres.iter().enumerate() {
            let mass = if rig.held[i].iter().all(|&held| held) { f64::INFINITY } else { mass[i] };
            // Of intruders each is a kind of its own: there are few.
            let of_crystal = |kind: &&mut Kind| i < crystal && kind.in_crystal && kind.material == sphere.material;
            match kinds.iter_mut().find(of_crystal) {
                Some(kind) => {
                    kind.radius = kind.radius.min(sphere.radius);
                    kind.mass = kind.mass.min(mass);
                }
                None => {
                    let (material, radius) = (sphere.material, sphere.radius);
                    let known = |kind: &Kind| {
                        (kind.material, kind.radius, kind.mass, kind.in_crystal) == (material, radius, mass, false)
                    };
                    if i < crystal || !kinds.iter().any(known) {
                        kinds.push(Kind { material, radius, mass, in_crystal: i < crystal });
                    }
                }
            }
        }
        // A flat lighter than what it strikes moves in its stead; it is met as a sphere like the one that meets it.
        let lightest = rig.flats.iter().map(|flat| flat.mass).fold(f64::INFINITY, f64::min);
        kinds.iter_mut().for_each(|kind| kind.mass = kind.mass.min(lightest));
        Self { rig, kinds }
    }

    fn law(&self, a: usize, b: usize) -> &'a Law {
        match &self.rig.laws {
            LawBook::Materials { law, pairs, .. } => {
                pairs.iter().find(|rule| rule.is_of([a, b])).and_then(|rule| rule.law.as_ref()).unwrap_or(law)
            }
            LawBook::Dashpot { .. } => unreachable!("rig files name laws by materials"),
        }
    }

    /// The law between a kind and a flat with a rule of its own.
    fn at_flat(&self, a: usize, flat: &'a Flat<D>) -> (&'a Law, Box<dyn NormalLaw>) {
        let LawBook::Materials { constants, .. } = &self.rig.laws else {
            unreachable!("rig files name laws by materials")
        };
        let (kind, contact) = (&self.kinds[a], &flat.contact);
        let other = contact.material.unwrap_or(kind.material);
        let radius = if contact.material.is_some() { f64::INFINITY } else { kind.radius };
        let law = contact.law.as_ref().unwrap_or_else(|| self.law(kind.material, other));
        let materials = [kind.material, other].map(|material| &self.rig.sample.materials[material]);
        (law, normal(law, &Pair::new(materials, [kind.radius, radius], *constants)))
    }

    /// The law between two kinds.
    fn between(&self, a: usize, b: usize) -> Box<dyn NormalLaw> {
        let (a, b) = (&self.kinds[a], &self.kinds[b]);
        let LawBook::Materials { constants, .. } = &self.rig.laws else {
            unreachable!("rig files name laws by materials")
        };
        let materials = [a, b].map(|kind| &self.rig.sample.materials[kind.material]);
        normal(self.law(a.material, b.material), &Pair::new(materials, [a.radius, b.radius], *constants))
    }
}

/// A law between the two of a pair; of a dashpot the spring.
fn normal(law: &Law, pair: &Pair) -> Box<dyn NormalLaw> {
    match law {
        Law::Named(kind) => Box::new(AnyLaw::new(*kind, pair)),
        Law::Tabulated(table) => Box::new((**table).clone()),
        Law::SpringDashpot(law) => Box::new(Dashpot { stiffness: law.stiffness, damping: 0.0, cut: true }),
    }
}

fn overshoot_of(law: &Law) -> f64 {
    match law {
        Law::Named(kind) => overshoot(*kind),
        Law::Tabulated(_) | Law::SpringDashpot(_) => overshoot(LawKind::Hertz),
    }
}

fn size<const D: usize>(vector: &[f64; D]) -> f64 {
    vector.iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn along<const D: usize>(vector: &[f64; D], direction: &[f64; D]) -> f64 {
    (0..D).map(|k| vector[k] * direction[k]).sum()
}

/// The greatest force (N) that contacts are pressed with from outside: by loads, bars, the weight of a column of spheres, and what is
/// squeezed from the start.
fn greatest_force<const D: usize>(rig: &Rig<D>) -> f64
where
    Spheres: MoveIn<D>,
{
    let loads = rig.loads.iter().filter(|load| load.kind == LoadKind::Force);
    let loads = loads.map(|load| load.curve.peak() * handed_on(rig, load));
    let bars = rig.bars.iter().filter_map(|bar| Some(2.0 * bar.incident.as_ref()?.peak()));
    let given = loads.chain(bars).fold(0.0, f64::max);
    let gravity = size(&rig.gravity);
    let mut weight = 0.0;
    if gravity > 0.0 && !rig.sample.spheres.is_empty() {
        let down = rig.gravity.map(|g| g / gravity);
        let [high, low] = extent(rig, &down);
        let smallest = rig.sample.spheres.iter().map(|sphere| 2.0 * sphere.radius).fold(f64::INFINITY, f64::min);
        let heaviest = rig.mass.iter().copied().fold(0.0, f64::max);
        let flats = rig.flats.iter().map(|flat| flat.mass).filter(|mass| mass.is_finite()).fold(0.0, f64::max);
        weight = gravity * (heaviest * (1.0 + (low - high) / smallest) + flats);
    }
    let mut squeezed = 0.0;
    if rig.precompressed {
        // So short a step that nothing refuses it.
        if let Ok(simulation) = Simulation::new(rig.clone(), 1e-15) {
            squeezed = simulation.view().contacts().map(|contact| contact.force).fold(0.0, f64::max);
        }
    }
    given.max(weight) + squeezed
}

/// Where the spheres begin and end along a direction (m).
fn extent<const D: usize>(rig: &Rig<D>, direction: &[f64; D]) -> [f64; 2] {
    rig.sample.spheres.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], sphere| {
        let at = along(&sphere.centre, direction);
        [low.min(at - sphere.radius), high.max(at + sphere.radius)]
    })
}

/// A bound on the speed (m/s) of anything, and what gives most of it.
fn greatest_speed<const D: usize>(rig: &Rig<D>, window: f64) -> (f64, &'static str) {
    let bars = rig.bars.iter().filter_map(|bar| Some(2.0 * bar.incident.as_ref()?.peak() / bar.impedance));
    let motion = rig.loads.iter().filter(|load| load.kind == LoadKind::Velocity).map(|load| load.curve.peak());
    let spins = rig.spin.iter().zip(&rig.sample.spheres).map(|(spin, sphere)| size(spin) * sphere.radius);
    let given = rig.velocity.iter().map(size).chain(rig.flats.iter().map(|flat| size(&flat.velocity)));
    let turning = if rig.has_friction() { spins.fold(0.0, f64::max) } else { 0.0 };
    let parts = [
        (given.fold(0.0, f64::max), "as given"),
        (motion.fold(0.0, f64::max), "by prescribed motion"),
        (bars.fold(0.0, f64::max), "by a bar"),
        (turning, "by its spin"),
        (fall(rig, window), "after a fall"),
        (rig.loads.iter().map(|load| driven(rig, load, window)).fold(0.0, f64::max), "driven by a force across a gap"),
    ];
    let (_, why) = parts.into_iter().fold((0.0, "at rest"), |most, part| if part.0 > most.0 { part } else { most });
    // What is moved by one may be moved by the other too.
    (parts.iter().map(|(speed, _)| speed).sum(), why)
}

/// The speed (m/s) that gravity gives within the window, or down to the floor.
fn fall<const D: usize>(rig: &Rig<D>, window: f64) -> f64 {
    let gravity = size(&rig.gravity);
    if gravity == 0.0 {
        return 0.0;
    }
    let down = rig.gravity.map(|g| g / gravity);
    let [high, low] = extent(rig, &down);
    let floors = rig.flats.iter().filter(|flat| along(&flat.normal, &down) < -0.999 && flat.face == Face::Plane);
    let floor = floors.map(|flat| along(&flat.point, &down)).reduce(f64::max).unwrap_or(f64::INFINITY);
    // What touches is not moved into by rounding.
    let height = (floor.max(low) - high - smallest_extent(rig)).max(0.0);
    (gravity * window).min((2.0 * gravity * height).sqrt())
}

/// The diameter of the smallest sphere (m): by so much less than the rig is high anything can fall.
fn smallest_extent<const D: usize>(rig: &Rig<D>) -> f64 {
    rig.sample.spheres.iter().map(|sphere| 2.0 * sphere.radius).fold(f64::INFINITY, f64::min) * (1.0 - 1e-9)
}

/// Spheres this many radii apart count as touching: what is driven across less gains no speed to speak of.
const TOUCH: f64 = 1e-6;

/// The speed (m/s) that a load gives to one of its bodies before that meets anything: by its impulse, or by its work across the gap
/// ahead.
fn driven<const D: usize>(rig: &Rig<D>, load: &Load<D>, window: f64) -> f64 {
    if load.kind != LoadKind::Force {
        return 0.0;
    }
    let peak = load.curve.peak();
    let lasts = load.curve.end().min(window);
    let mut struck = vec![false; rig.sample.spheres.len()];
    load.bodies.iter().filter_map(|body| sphere_of(*body)).for_each(|i| struck[i] = true);
    let speed = |body: &Body| {
        let (mass, gap) = match *body {
            Body::Sphere(i) => (rig.mass[i], gap_ahead(rig, i, &load.direction, &struck)),
            Body::Flat(f) => {
                let ahead = |sphere: &crate::sample::Sphere<D>| {
                    rig.flats[f].distance(&[0.0; D], &sphere.centre).0 - sphere.radius
                };
                (rig.flats[f].mass, rig.sample.spheres.iter().map(ahead).fold(f64::INFINITY, f64::min).max(0.0))
            }
        };
        (peak * lasts / mass).min((2.0 * peak * gap / mass).sqrt())
    };
    // Of very many bodies among very many the first tell.
    let looked_at = (200_000_000 / rig.sample.spheres.len().max(1)).max(1);
    load.bodies.iter().take(looked_at).map(speed).fold(0.0, f64::max)
}

fn sphere_of(body: Body) -> Option<usize> {
    match body {
        Body::Sphere(i) => Some(i),
        Body::Flat(_) => None,
    }
}

/// How far (m) a sphere may be driven along a direction before it touches another that is not driven with it, or a plane.
fn gap_ahead<const D: usize>(rig: &Rig<D>, i: usize, direction: &[f64; D], struck: &[bool]) -> f64 {
    let own = &rig.sample.spheres[i];
    let mut least = f64::INFINITY;
    for (j, other) in rig.sample.spheres.iter().enumerate() {
        if j == i || struck[j] {
            continue;
        }
        let between: [f64; D] = std::array::from_fn(|k| {
            let apart = other.centre[k] - own.centre[k];
            // Over periodic sides the nearest image is met.
            rig.periods[k].map_or(apart, |period| nearest_image(apart, period))
        });
        let (ahead, reach) = (along(&between, direction), own.radius + other.radius);
        let beside = along(&between, &between) - ahead * ahead;
        if ahead > 0.0 && beside < reach * reach {
            least = least.min(ahead - (reach * reach - beside).sqrt());
        }
    }
    for flat in rig.flats.iter().filter(|flat| flat.face == Face::Plane) {
        let towards = -along(&flat.normal, direction);
        if towards > 0.0 {
            least = least.min((flat.distance(&[0.0; D], &own.centre).0 - own.radius) / towards);
        }
    }
    if least < TOUCH * own.radius { 0.0 } else { least }
}

/// The shortest force or velocity pulse (s).
fn shortest_pulse<const D: usize>(rig: &Rig<D>) -> f64 {
    let duration = |curve: &Curve| match curve {
        Curve::Square { duration, .. } | Curve::HalfSine { duration, .. } | Curve::Triangle { duration, .. } => {
            *duration
        }
        // Its points are as dense as it needs; the mean over each step is exact.
        Curve::Table(_) | Curve::Path(_) => f64::INFINITY,
    };
    let bars = rig.bars.iter().filter_map(|bar| bar.incident.as_ref());
    rig.loads.iter().map(|load| &load.curve).chain(bars).map(duration).fold(f64::INFINITY, f64::min)
}

/// The force at which a contact has taken up ½ m v² of a body of mass `mass` (kg) that comes at `speed` (m/s), at most that
/// at an overlap of half the radius.
fn collision_force(law: &dyn NormalLaw, mass: f64, speed: f64, radius: f64) -> f64 {
    // Each part 2 % longer than the one before: the overlap is found to 1 %, however small it is.
    const GROWTH: f64 = 1.02;
    let (mut left, mut force, mut overlap) = (0.5 * mass * speed * speed, 0.0, 1e-10 * radius);
    while left > 0.0 && overlap < 0.5 * radius {
        let width = (GROWTH - 1.0) * overlap;
        force = law.force(overlap + 0.5 * width, speed, &History::new());
        left -= force * width;
        overlap += width;
    }
    force
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::Constants;
    use crate::material::find;

    /// ½ m v² = (2/5) k δ^{5/2}: F = k (5 m v²/4k)^{3/5} (Johnson 1985, section 11.4); parts of 2 % find the overlap to 1 % and the force
    /// to 1.5 %, at any speed.
    #[test]
    fn the_force_of_a_collision_is_that_of_hertz() {
        let steel = find("440c", &[]).unwrap();
        let radius = 3e-3;
        let pair = Pair::new([&steel, &steel], [radius; 2], Constants::default());
        let mass = steel.sphere_mass(2.0 * radius);
        let k = pair.hertz_coefficient();
        for speed in [1e-3, 0.1, 20.0] {
            let exact = k * (5.0 * mass * speed * speed / (4.0 * k)).powf(0.6);
            let found = collision_force(&AnyLaw::new(LawKind::Hertz, &pair), mass, speed, radius);
            assert!((found / exact - 1.0).abs() < 0.02, "{found} {exact}");
        }
    }
}
