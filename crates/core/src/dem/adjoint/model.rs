//! A run as a function of numbers of any kind: the same steps as those of `step::multistep`, over the contacts that a run has found.

use super::contact::{Answer, Make, Memory, Motion, Place, QUANTITIES, Rub, respond};
use crate::contact::{AnyLaw, Constants, History, LawKind, Pair};
use crate::dem::body::Grains;
use crate::dem::boundary::Surface;
use crate::dem::contacts::CLOSED;
use crate::dem::friction::{Spring, mindlin};
use crate::dem::impact::Impact;
use crate::dem::list::List;
use crate::dem::neighbour::{SelfTouch, image_gap};
use crate::dem::size::gap_squared;
use crate::dem::step::Coefficients;
use crate::material::Material;
use crate::real::Number;
use crate::sample::Sample;

/// What does not change with a number's kind.
pub(super) struct Frame {
    pub places: Vec<Place>,
    /// Which spheres meet; an image's sphere twice.
    pub ends: Vec<[usize; 2]>,
    pub weight: Vec<f64>,
    /// For each sphere the number of pairs whose first sphere comes before it.
    pub first_pair: Vec<usize>,
    pub pairs: usize,
    /// The make of each contact, by number.
    pub kind: Vec<usize>,
    pub mobility: Vec<[f64; 2]>,
    /// Which spheres are struck.
    pub struck: Vec<usize>,
    /// The load's components over its strength.
    pub direction: [f64; 2],
    pub step: f64,
    pub coefficients: Coefficients,
    /// μ; none without friction.
    pub friction: Option<f64>,
    /// Spheres that move or are struck at the start end before this one.
    pub reached: usize,
}

/// What the run is made of.
#[derive(Clone)]
pub(super) struct Model<N> {
    /// 1/m of the whole sphere (1/kg)
    pub inverse_mass: Vec<N>,
    /// 1/I (1/(kg m²)), zero on mirrors; empty without friction.
    pub inverse_inertia: Vec<N>,
    /// The makes of contacts: one of each kind, or one of each contact.
    pub makes: Vec<Make<N>>,
}

/// The motion at one moment.
#[derive(Clone)]
pub(super) struct State<N> {
    pub displacement: Vec<[N; 2]>,
    pub velocity: Vec<[N; 2]>,
    /// Accelerations by contacts, now, one and two steps ago.
    pub acceleration: [Vec<[N; 2]>; 3],
    pub history: Vec<History<N>>,
    /// Rotation; empty without friction.
    pub turning: Turning<N>,
    pub reached: usize,
}

/// Rotation of all spheres and the springs of all contacts; empty without friction.
#[derive(Clone, Default)]
pub(super) struct Turning<N> {
    /// ω (1/s), and its derivative by contacts, now, one and two steps ago.
    pub spin: Vec<N>,
    pub acceleration: [Vec<N>; 3],
    /// Images have one too, which stays as it is.
    pub spring: Vec<Spring<N>>,
}

/// Room for one step: velocities and spins in the force, forces and couples.
pub(super) struct Scratch<N> {
    pub predicted: Vec<[N; 2]>,
    pub spins: Vec<N>,
    force: Vec<[N; 2]>,
    couple: Vec<N>,
}

impl<N: Number> Scratch<N> {
    pub fn new(frame: &Frame) -> Self {
        let (zero, turning) = (N::splat(0.0), frame.turning());
        let zeros = || vec![[zero; 2]; frame.mobility.len()];
        Self { predicted: zeros(), spins: vec![zero; turning], force: zeros(), couple: vec![zero; turning] }
    }
}

impl<N: Number> State<N> {
    pub fn at_start(frame: &Frame, moving: &[(usize, f64)]) -> Self {
        let zeros = || vec![[N::splat(0.0); 2]; frame.mobility.len()];
        let mut velocity = zeros();
        for &(i, speed) in moving {
            velocity[i][1] = N::splat(speed);
        }
        Self {
            displacement: zeros(),
            velocity,
            acceleration: [zeros(), zeros(), zeros()],
            history: vec![History::new(); frame.places.len()],
            turning: Turning::at_start(frame),
            reached: frame.reached,
        }
    }
}

impl<N: Number> Turning<N> {
    fn at_start(frame: &Frame) -> Self {
        let turning = frame.turning();
        let zeros = || vec![N::splat(0.0); turning];
        let springs = if turning > 0 { frame.places.len() } else { 0 };
        Self { spin: zeros(), acceleration: [zeros(), zeros(), zeros()], spring: vec![Spring::none(); springs] }
    }
}

/// How a contact's spheres move; without friction there are no spins.
#[inline(always)]
pub(super) fn motion<N: Number>(
    place: &Place,
    [a, b]: [usize; 2],
    displacement: &[[N; 2]],
    (velocity, spins): (&[[N; 2]], &[N]),
) -> Motion<N> {
    let spin = |i: usize| spins.get(i).copied().unwrap_or_else(|| N::splat(0.0));
    let spins = [spin(a), spin(b)];
    match place {
        Place::Pair(_) => {
            let (from, to, of_a, of_b) = (displacement[a], displacement[b], velocity[a], velocity[b]);
            let (shift, approach) = ([to[0] - from[0], to[1] - from[1]], [of_a[0] - of_b[0], of_a[1] - of_b[1]]);
            Motion { shift, approach, spins }
        }
        Place::Image(..) => Motion { shift: displacement[a], approach: velocity[a], spins },
    }
}

/// What a contact remembers; without friction there are no springs.
#[inline(always)]
pub(super) fn memory<N: Number>(state: &State<N>, contact: usize) -> Memory<N> {
    let spring = state.turning.spring.get(contact).copied().unwrap_or_else(Spring::none);
    Memory { history: state.history[contact], spring }
}

impl Frame {
    /// Contacts that may act while spheres before this one are reached.
    pub fn contacts_of(&self, reached: usize) -> impl Iterator<Item = usize> + use<'_> {
        let images = (self.pairs..self.places.len()).take_while(move |&c| self.ends[c][0] < reached);
        (0..self.first_pair[reached]).chain(images)
    }

    /// How many spheres may turn: all or, without friction, none.
    pub fn turning(&self) -> usize {
        if self.friction.is_some() { self.mobility.len() } else { 0 }
    }

    /// What spheres do before forces are known: displacements after the step, and, in `scratch`, velocities and spins in the force.
    pub fn glide<N: Number>(&self, model: &Model<N>, state: &mut State<N>, load: N, scratch: &mut Scratch<N>) {
        let (h, half) = (N::splat(self.step), N::splat(0.5 * self.step));
        let [s1, s2] = self.coefficients.displacement.map(N::splat);
        let [b1, b2] = self.coefficients.velocity.map(N::splat);
        let State { displacement, velocity, acceleration: [now, one, two], reached, .. } = state;
        // Of another moment there may be something in it.
        scratch.predicted[*reached..].fill([N::splat(0.0); 2]);
        scratch.spins.iter_mut().skip(*reached).for_each(|spin| *spin = N::splat(0.0));
        for i in 0..*reached {
            for k in 0..2 {
                let first = now[i][k] - one[i][k];
                let second = first - (one[i][k] - two[i][k]);
                let mean = half * now[i][k] + (s1 * first + s2 * second);
                displacement[i][k] = displacement[i][k] + h * (velocity[i][k] + mean);
                scratch.predicted[i][k] = velocity[i][k] + (h * now[i][k] + (b1 * first + b2 * second));
            }
        }
        let Turning { spin, acceleration: [now, one, two], .. } = &state.turning;
        for i in 0..spin.len().min(*reached) {
            let first = now[i] - one[i];
            let second = first - (one[i] - two[i]);
            scratch.spins[i] = spin[i] + (h * now[i] + (b1 * first + b2 * second));
        }
        for &i in &self.struck {
            for k in 0..2 {
                if self.mobility[i][k] == 0.0 || self.direction[k] == 0.0 {
                    continue;
                }
                let push = N::splat(self.direction[k]) * load * model.inverse_mass[i];
                state.displacement[i][k] = state.displacement[i][k] + h * half * push;
                scratch.predicted[i][k] = scratch.predicted[i][k] + h * push;
                state.velocity[i][k] = state.velocity[i][k] + h * push;
            }
        }
    }

    /// The state after one step under a load (N).
    pub fn advance<N: Number>(&self, model: &Model<N>, state: &mut State<N>, load: N, scratch: &mut Scratch<N>) {
        let half = N::splat(0.5 * self.step);
        self.glide(model, state, load, scratch);
        self.sweep(model, state, scratch);
        let [m2, m3] = self.coefficients.corrector.map(N::splat);
        let correct = |speed: &mut N, [now, one, two]: [&mut N; 3], new: N| {
            let (first, before, earlier) = (new - *now, *now - *one, *one - *two);
            let second = first - before;
            let third = second - (before - earlier);
            *speed = *speed + (half * (*now + new) - (m2 * second + m3 * third));
            (*two, *one, *now) = (*one, *now, new);
        };
        let State { velocity, acceleration: [now, one, two], turning, reached, .. } = state;
        for i in 0..*reached {
            let inverse = model.inverse_mass[i];
            for k in 0..2 {
                let new = scratch.force[i][k] * (inverse * N::splat(self.mobility[i][k]));
                correct(&mut velocity[i][k], [&mut now[i][k], &mut one[i][k], &mut two[i][k]], new);
            }
        }
        let Turning { spin, acceleration: [now, one, two], .. } = turning;
        for i in 0..spin.len().min(*reached) {
            let new = -(scratch.couple[i] * model.inverse_inertia[i]);
            correct(&mut spin[i], [&mut now[i], &mut one[i], &mut two[i]], new);
        }
    }

    fn sweep<N: Number>(&self, model: &Model<N>, state: &mut State<N>, scratch: &mut Scratch<N>) {
        let Scratch { predicted, spins, force, couple } = scratch;
        let zero = [N::splat(0.0); 2];
        force[..state.reached].fill(zero);
        couple.fill(zero[0]);
        let mut touched = state.reached;
        for c in self.contacts_of(state.reached) {
            let (place, [a, b]) = (&self.places[c], self.ends[c]);
            let motion = motion(place, [a, b], &state.displacement, (predicted, spins));
            let make = &model.makes[self.kind[c]];
            let Some(answer) = respond::<_, true>(place, make, &motion, &memory(state, c), CLOSED) else {
                // An open contact forgets its spring.
                state.turning.spring.iter_mut().skip(c).take(1).for_each(|spring| *spring = Spring::none());
                continue;
            };
            let Answer { push, drag, couple: turns, memory } = answer;
            state.history[c] = memory.history;
            if let Place::Image(..) = place {
                let weight = N::splat(self.weight[c]);
                for k in 0..2 {
                    force[a][k] = force[a][k] + push[k] * weight;
                }
                continue;
            }
            while touched <= b {
                force[touched] = zero;
                touched += 1;
            }
            let weight = N::splat(self.weight[c]);
            for k in 0..2 {
                force[a][k] = force[a][k] - push[k] * weight;
                force[b][k] = force[b][k] + push[k] * weight;
            }
            if self.friction.is_some() {
                state.turning.spring[c] = memory.spring;
                for k in 0..2 {
                    force[a][k] = force[a][k] - drag[k] * weight;
                    force[b][k] = force[b][k] + drag[k] * weight;
                }
                couple[a] = couple[a] + turns[0];
                couple[b] = couple[b] + turns[1];
            }
        }
        state.reached = touched;
    }

    /// Of the crystal `sample`, whose contacts have been found, with friction of a coefficient where there is one.
    pub fn new(
        sample: &Sample<2>,
        (impact, friction): (&Impact, Option<f64>),
        list: &List<2>,
        grains: &Grains<f64, 2>,
    ) -> Self {
        let pairs = list.pairs.iter().map(|touch| Place::Pair(*touch));
        // Of an image the part of the sphere on which its force acts.
        let weight = (0..list.len()).map(|c| if c < list.pairs.len() { list.weight[c] } else { 2.0 * list.weight[c] });
        let last = impact.struck.iter().copied().chain(impact.moving.iter().map(|&(i, _)| i)).max();
        Self {
            places: pairs.chain(list.images.iter().map(image)).collect(),
            ends: list.ends(),
            weight: weight.collect(),
            first_pair: list.first_pair.clone(),
            pairs: list.pairs.len(),
            kind: (0..list.len()).collect(),
            mobility: grains.mobility.clone(),
            struck: impact.struck.clone(),
            direction: [impact.slope, 1.0],
            step: impact.step,
            coefficients: Coefficients::of(impact.integrator, impact.step),
            friction,
            reached: last.map_or(0, |last| last + 1).min(sample.spheres.len()),
        }
    }
}

/// A relative change by which numbers of laws are differentiated: its square is their error, rounding over it the other one.
const CHANGE: f64 = 1e-5;
/// Which quantity the yield stress is.
const YIELD_STRESS: usize = 2;

/// A contact's law, and its slopes by the logarithms of its spheres' quantities. Where two spheres yield at the same stress the law has
/// a kink, since the softer one's counts: then the mean of both sides.
fn law_with_slopes(
    materials: [&Material; 2],
    radii: [f64; 2],
    (kind, constants): (LawKind, Constants),
) -> (AnyLaw, Vec<[f64; 2 * QUANTITIES]>) {
    let alike = materials[0] == materials[1];
    let made = |materials: [&Material; 2], radii: [f64; 2]| {
        let mut pair = Pair::new(materials, radii, constants);
        // Like materials stay like ones while they are varied.
        if alike && materials[0] != materials[1] {
            pair.yield_stress /= constants.tuning.unlike_hardness;
        }
        AnyLaw::new(kind, &pair)
    };
    let law = made(materials, radii);
    let mut slopes = vec![[0.0; 2 * QUANTITIES]; law.list().len()];
    let yield_alike = materials[0].yield_stress == materials[1].yield_stress;
    for which in 0..2 * QUANTITIES {
        // The kink's two sides: one sphere softer with the other, and not at all. Their mean is half of both together.
        let together = yield_alike && which % QUANTITIES == YIELD_STRESS;
        let varied = |factor: f64| {
            let (mut materials, mut radii) = (materials.map(Material::clone), radii);
            for (sphere, material) in materials.iter_mut().enumerate() {
                if sphere != which / QUANTITIES && !together {
                    continue;
                }
                match which % QUANTITIES {
                    0 => material.density *= factor,
                    1 => material.youngs_modulus *= factor,
                    YIELD_STRESS => material.yield_stress *= factor,
                    _ => radii[sphere] *= factor,
                }
            }
            made([&materials[0], &materials[1]], radii).list()
        };
        let (more, less) = (varied(1.0 + CHANGE), varied(1.0 - CHANGE));
        let span = (if together { 2.0 } else { 1.0 }) * ((1.0 + CHANGE).ln() - (1.0 - CHANGE).ln());
        for ((slopes, more), less) in slopes.iter_mut().zip(more).zip(less) {
            slopes[which] = (more - less) / span;
        }
    }
    (law, slopes)
}

/// What contacts of a kind are made of, and how that changes with the quantities of their spheres.
pub(super) struct Kind {
    numbers: Vec<f64>,
    slopes: Vec<[f64; 2 * QUANTITIES]>,
    law: AnyLaw,
    /// μ, and the step (s), where it rubs.
    friction: Option<[f64; 2]>,
}

impl Kind {
    /// `gap` and `reach` as in [`Make`].
    fn new(
        sample: &Sample<2>,
        (impact, friction): (&Impact, Option<f64>),
        (place, ends): (&Place, [usize; 2]),
        [gap, reach]: [f64; 2],
    ) -> Self {
        let spheres = ends.map(|i| &sample.spheres[i]);
        let (radii, materials) =
            (spheres.map(|sphere| sphere.radius), spheres.map(|sphere| &sample.materials[sphere.material]));
        let (law, mut slopes) = law_with_slopes(materials, radii, (impact.law, impact.constants));
        let mut numbers = law.list();
        // The radii's part in geometry. A sphere and its image change together, so that each bears half.
        let (mut gap_by, mut reach_by) = ([0.0; 2 * QUANTITIES], [0.0; 2 * QUANTITIES]);
        for (sphere, radius) in radii.iter().enumerate() {
            let which = sphere * QUANTITIES + 3;
            reach_by[which] = *radius;
            gap_by[which] = match place {
                Place::Pair(_) => -2.0 * reach * radius,
                Place::Image(..) => -radius,
            };
        }
        numbers.extend([gap, reach]);
        slopes.extend([gap_by, reach_by]);
        let friction = friction.filter(|_| matches!(place, Place::Pair(_)));
        if friction.is_some() {
            let [stiffness, relative @ ..] = mindlin(sample, ends);
            let mut stiffness_by = [0.0; 2 * QUANTITIES];
            for (part, which) in relative.into_iter().zip([1, QUANTITIES + 1, 3, QUANTITIES + 3]) {
                stiffness_by[which] = stiffness * part;
            }
            for (sphere, radius) in radii.into_iter().enumerate() {
                let mut by = [0.0; 2 * QUANTITIES];
                by[sphere * QUANTITIES + 3] = radius;
                numbers.push(radius);
                slopes.push(by);
            }
            numbers.push(stiffness);
            slopes.push(stiffness_by);
        }
        Self { numbers, slopes, law, friction: friction.map(|coefficient| [coefficient, impact.step]) }
    }

    /// A make in numbers that know as much of the slopes as `number` lets them.
    pub fn make<N: Number>(&self, number: &dyn Fn(f64, &[f64; 2 * QUANTITIES]) -> N) -> Make<N> {
        let numbers: Vec<N> =
            self.numbers.iter().zip(&self.slopes).map(|(&value, slopes)| number(value, slopes)).collect();
        let (numbers, rub) = match self.friction {
            None => (&numbers[..], None),
            Some([coefficient, step]) => {
                let [rest @ .., a, b, stiffness] = &numbers[..] else { unreachable!("they are the last three") };
                (rest, Some(Rub { coefficient, step, radii: [*a, *b], stiffness: *stiffness }))
            }
        };
        let [of_law @ .., gap, reach] = numbers else { unreachable!("gap and reach come before") };
        Make { gap: *gap, reach: *reach, law: self.law.with(of_law), rub }
    }
}

/// 1/m of whole spheres (1/kg), zero where a site is empty.
pub(super) fn inverse_masses(sample: &Sample<2>) -> Vec<f64> {
    let mass = (0..sample.spheres.len()).map(|i| sample.mass(i));
    mass.map(|mass| if mass > 0.0 { 1.0 / mass } else { 0.0 }).collect()
}

/// 1/I of whole spheres (1/(kg m²)), zero where a sphere does not turn; empty without friction.
pub(super) fn inverse_inertias(sample: &Sample<2>, frame: &Frame, grains: &Grains<f64, 2>) -> Vec<f64> {
    let of = |i: usize| {
        let radius = sample.spheres[i].radius;
        let turns = grains.weight[i] == 1.0 && radius > 0.0;
        if turns { 2.5 * grains.inverse_mass[i] / (radius * radius) } else { 0.0 }
    };
    (0..frame.turning()).map(of).collect()
}

/// The kinds of contacts; the frame learns which contact is of which.
pub(super) fn kinds(sample: &Sample<2>, impact: &Impact, frame: &mut Frame) -> Vec<Kind> {
    let mut kinds = Vec::new();
    let mut seen = Vec::new();
    for (c, place) in frame.places.iter().enumerate() {
        let spheres = frame.ends[c].map(|i| &sample.spheres[i]);
        let geometry = match place {
            Place::Pair(touch) => [gap_squared(sample, touch.pair, &touch.offset), touch.reach],
            Place::Image(touch, _) => [image_gap(sample, touch.sphere, &touch.surface), touch.reach],
        };
        // A contact with an image has the numbers of one with an equal sphere, but its gap is a length.
        let is_image = matches!(place, Place::Image(..));
        let one = (is_image, spheres.map(|sphere| sphere.material), spheres.map(|sphere| sphere.radius), geometry);
        frame.kind[c] = seen.iter().position(|known| *known == one).unwrap_or_else(|| {
            kinds.push(Kind::new(sample, (impact, frame.friction), (place, frame.ends[c]), geometry));
            seen.push(one);
            seen.len() - 1
        });
    }
    kinds
}

/// The contact of a sphere with its image: of a sheet in a mirror across an axis.
fn image(touch: &SelfTouch<2>) -> Place {
    match touch.surface {
        Surface::Mirror(mirror) => Place::Image(*touch, mirror),
        Surface::Face(_) => unreachable!("faces across no axis are in space"),
    }
}
