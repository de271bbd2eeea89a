//! Friction and rotation in the plane: Coulomb's law with a tangential spring, for one design or several side by side.
//!
//! At a closed contact of two spheres the surface of the first slides over that of the second with
//!
//!   u = (v₁ − v₂)·t + a₁ ω₁ + a₂ ω₂,   a = r − δ/2,
//!
//! t across the normal. The force T that meets it obeys |T| ≤ μ F and comes of a spring of stiffness k_t = 8 G* √(r* δ), with
//! 1/G* = Σ 2 (2 − ν)(1 + ν)/E (Mindlin 1949). While k_t grows the spring is incremental, dT = k_t du; while it falls the force falls
//! with it, T = k_t ξ: so no path of overlap and slip gives work (Thornton and Randall 1988). At the cap the spring is cut
//! back to it. As in rigs; there in any dimension, one contact at a time. Spheres turn by I ω̇ = −Σ a T, I = (2/5) m r². What lies on a mirror
//! does not turn, and a sphere does not slide over its own image.

use super::body::Grains;
use super::neighbour::Touch;
use crate::material::Material;
use crate::real::{Lanes, Number};
use crate::sample::Sample;

/// What the tangential spring of a contact remembers.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spring<V> {
    /// ξ (m)
    pub stretch: V,
    /// √δ at the last accepted step; zero while open.
    pub root: V,
    /// u then (m/s)
    pub slide: V,
    /// T then (N)
    pub force: V,
}

impl<V: Number> Spring<V> {
    /// Of a contact that is open.
    pub fn none() -> Self {
        let zero = V::splat(0.0);
        Self { stretch: zero, root: zero, slide: zero, force: zero }
    }
}

/// How a closed contact slides.
pub(super) struct Slide<V> {
    /// δ (m), and its rate (m/s).
    pub overlap: V,
    pub closing_speed: V,
    /// F (N)
    pub push: V,
    /// The velocity of the first sphere relative to the second along the tangent (m/s).
    pub across: V,
    /// Of both spheres (m).
    pub radii: [V; 2],
    /// ω of both with which forces are found (1/s).
    pub spins: [V; 2],
    /// 8 G* √r* (N/m^{3/2})
    pub stiffness: V,
}

/// What friction answers.
pub(super) struct Slid<V> {
    /// T, on the second sphere along the tangent (N).
    pub force: V,
    /// At which T acts on both (m).
    pub arms: [V; 2],
    /// How far the first end has slid over the second during the step (m).
    way: V,
    /// What the spring remembers then.
    pub spring: Spring<V>,
}

impl<V: Number> Slide<V> {
    /// Under Coulomb's law with a coefficient, over a step (s); none where the state is not accepted.
    #[inline(always)]
    pub fn under(&self, coefficient: f64, step: Option<f64>, before: &Spring<V>) -> Slid<V> {
        let half = V::splat(0.5);
        let &Self { overlap, closing_speed, push, across, radii, spins, stiffness } = self;
        let arms = radii.map(|radius| radius - half * overlap);
        let slide = across + (arms[0] * spins[0] + arms[1] * spins[1]);
        let root = overlap.sqrt();
        // Between accepted states the spring stays as it was.
        let mut way = V::splat(0.0);
        if let Some(step) = step {
            let step = V::splat(step);
            way = half * step * (before.slide + slide);
            let fresh = before.root.lt(V::splat(f64::MIN_POSITIVE));
            if V::any(fresh) {
                // A contact that closed within the step has slid for the part of it since.
                let closing = closing_speed * step;
                let since = V::select(overlap.lt(closing), overlap / closing, V::splat(1.0));
                way = V::select(fresh, since * (step * slide), way);
            }
        }
        let slip = Slip { cap: V::splat(coefficient) * push, stiffness, root, way };
        let (force, stretch) = coulomb(&slip, before);
        Slid { force, arms, way, spring: Spring { stretch, root, slide, force } }
    }
}

/// A contact in a step, as the spring sees it.
struct Slip<V> {
    /// μ F (N)
    cap: V,
    /// k_t/√δ (N/m^{3/2})
    stiffness: V,
    /// √δ
    root: V,
    /// How far the first end has slid over the second during the step (m).
    way: V,
}

/// The force T that holds the first end back, and the spring's ξ after the step.
#[inline(always)]
fn coulomb<V: Number>(slip: &Slip<V>, before: &Spring<V>) -> (V, V) {
    let zero = V::splat(0.0);
    let &Slip { cap, stiffness, root, way } = slip;
    let (was, now) = (stiffness * before.root, stiffness * root);
    // The mean of √δ while δ changes at a constant rate: ∫√δ dδ = (2/3) δ^{3/2}.
    let sum = before.root + root;
    let square = before.root * before.root + before.root * root + root * root;
    let mean = V::select(zero.lt(sum), square / (V::splat(1.5) * sum), zero);
    let stiffened = was * before.stretch + stiffness * mean * way;
    let softened = now * (before.stretch + way);
    let force = V::select(now.lt(was), softened, stiffened).min(cap).max(-cap);
    (force, V::select(zero.lt(now), force / now, zero))
}

/// Rotation of all spheres, and the springs of all contacts.
pub(super) struct Friction<V> {
    /// μ
    coefficient: f64,
    /// (s)
    step: f64,
    /// 1/I (1/(kg m²)); zero on mirrors.
    inverse_inertia: Vec<V>,
    radius: Vec<V>,
    /// ω (1/s), and its derivative now, one and two steps ago.
    pub spin: Vec<V>,
    acceleration: [Vec<V>; 3],
    /// ω with which forces are found.
    predicted: Vec<V>,
    /// Σ a T of each sphere (N m)
    couple: Vec<V>,
    /// 8 G* √r* of each pair.
    stiffness: Vec<V>,
    pub spring: Vec<Spring<V>>,
    /// ∫T u dt of each pair (J), where accounts are kept.
    pub work: Vec<V>,
}

impl<V: Lanes> Friction<V> {
    /// In packings with the same centres, one per lane.
    pub fn new<const D: usize>(samples: &[&Sample<D>], grains: &Grains<V, D>, coefficient: f64, step: f64) -> Self {
        let spheres = grains.weight.len();
        let zeros = || vec![V::splat(0.0); spheres];
        let (mut radius, mut inverse_inertia) = (zeros(), zeros());
        for i in 0..spheres {
            for lane in 0..V::LANES {
                let r = samples[lane.min(samples.len() - 1)].spheres[i].radius;
                radius[i].set_lane(lane, r);
                if grains.weight[i] == 1.0 && r > 0.0 {
                    inverse_inertia[i].set_lane(lane, 2.5 * grains.inverse_mass[i].lane(lane) / (r * r));
                }
            }
        }
        Self {
            coefficient,
            step,
            inverse_inertia,
            radius,
            spin: zeros(),
            acceleration: [zeros(), zeros(), zeros()],
            predicted: zeros(),
            couple: zeros(),
            stiffness: Vec::new(),
            spring: Vec::new(),
            work: Vec::new(),
        }
    }

    /// Follows the contacts: pair c was pair `from[c]`, or is new, as all are that `from` does not name.
    pub fn renumber<const D: usize>(
        &mut self,
        samples: &[&Sample<D>],
        pairs: &[Touch<D>],
        from: &[Option<usize>],
        accounts: bool,
    ) {
        let zero = V::splat(0.0);
        let (spring, work) = (std::mem::take(&mut self.spring), std::mem::take(&mut self.work));
        self.stiffness.clear();
        for (c, touch) in pairs.iter().enumerate() {
            let old = from.get(c).copied().flatten();
            self.spring.push(match old {
                Some(old) => spring[old],
                None => Spring::none(),
            });
            if accounts {
                self.work.push(old.map_or(zero, |old| work[old]));
            }
            let mut stiffness = zero;
            for lane in 0..V::LANES {
                let sample = samples[lane.min(samples.len() - 1)];
                stiffness.set_lane(lane, mindlin(sample, touch.pair)[0]);
            }
            self.stiffness.push(stiffness);
        }
    }

    /// The tangential force at a closed contact that is pushed apart by `push`, on its second sphere along the tangent; the spring
    /// advances if `accepts`. `across` is the velocity of the first sphere relative to the second along the tangent.
    #[inline(always)]
    pub fn rub(
        &mut self,
        contact: usize,
        [a, b]: [usize; 2],
        (overlap, closing_speed): (V, V),
        (push, across): (V, V),
        accepts: bool,
    ) -> V {
        let before = self.spring[contact];
        let slide = Slide {
            overlap,
            closing_speed,
            push,
            across,
            radii: [self.radius[a], self.radius[b]],
            spins: [self.predicted[a], self.predicted[b]],
            stiffness: self.stiffness[contact],
        };
        let Slid { force, arms, way, spring } = slide.under(self.coefficient, accepts.then_some(self.step), &before);
        if accepts {
            self.spring[contact] = spring;
            if let Some(work) = self.work.get_mut(contact) {
                *work = *work + V::splat(0.5) * (before.force + force) * way;
            }
        }
        self.couple[a] = self.couple[a] + arms[0] * force;
        self.couple[b] = self.couple[b] + arms[1] * force;
        force
    }

    /// An open contact forgets.
    #[inline(always)]
    pub fn open(&mut self, contact: usize) {
        let zero = V::splat(0.0);
        if V::any(zero.lt(self.spring[contact].root)) {
            self.spring[contact] = Spring::none();
        }
    }

    /// Before a sweep; `reached` spheres take part.
    #[inline(always)]
    pub fn begin(&mut self) {
        self.couple.fill(V::splat(0.0));
    }

    /// The spins with which forces are to be found, as velocities are predicted; b₁ h and b₂ h from the scheme's table.
    #[inline(always)]
    pub fn predict(&mut self, reached: usize, [b1, b2]: [V; 2]) {
        let h = V::splat(self.step);
        let [now, one, two] = &self.acceleration;
        for i in 0..reached {
            let first = now[i] - one[i];
            let second = first - (one[i] - two[i]);
            self.predicted[i] = self.spin[i] + (h * now[i] + (b1 * first + b2 * second));
        }
    }

    /// The spins after a step, as velocities are corrected; m₂ h and m₃ h from the scheme's table.
    #[inline(always)]
    pub fn correct(&mut self, reached: usize, [m2, m3]: [V; 2]) {
        let half = V::splat(0.5 * self.step);
        let [now, one, two] = &mut self.acceleration;
        for i in 0..reached {
            let new = -(self.couple[i] * self.inverse_inertia[i]);
            let (first, before, earlier) = (new - now[i], now[i] - one[i], one[i] - two[i]);
            let second = first - before;
            let third = second - (before - earlier);
            self.spin[i] = self.spin[i] + (half * (now[i] + new) - (m2 * second + m3 * third));
            (two[i], one[i], now[i]) = (one[i], now[i], new);
        }
    }
}

impl Friction<f64> {
    /// ½ I ω² of all spheres (J). Those on mirrors do not turn.
    pub fn kinetic(&self) -> f64 {
        let of = |(spin, inverse): (&f64, &f64)| if *inverse > 0.0 { 0.5 * spin * spin / inverse } else { 0.0 };
        self.spin.iter().zip(&self.inverse_inertia).map(of).sum()
    }

    /// ½ k_t ξ² of a pair's spring (J).
    pub fn stored(&self, contact: usize) -> f64 {
        let spring = self.spring[contact];
        0.5 * self.stiffness[contact] * spring.root * spring.stretch * spring.stretch
    }
}

/// 8 G* √r* of two spheres; behind it how its logarithm changes with those of both moduli, then of both radii. Zero where one is missing.
pub(super) fn mindlin<const D: usize>(sample: &Sample<D>, pair: [usize; 2]) -> [f64; 5] {
    let compliance = |m: &Material| 2.0 * (2.0 - m.poisson_ratio) * (1.0 + m.poisson_ratio) / m.youngs_modulus;
    let [a, b] = pair.map(|i| &sample.spheres[i]);
    let [first, second] = [a, b].map(|sphere| compliance(&sample.materials[sphere.material]));
    if a.radius * b.radius == 0.0 {
        return [0.0; 5];
    }
    let reduced = 1.0 / (1.0 / a.radius + 1.0 / b.radius);
    let stiffness = 8.0 / (first + second) * reduced.sqrt();
    let part = |compliance: f64| compliance / (first + second);
    [stiffness, part(first), part(second), 0.5 * reduced / a.radius, 0.5 * reduced / b.radius]
}
