//! Rays through a flat slab whose speed changes across it.

use crate::ray::Vector2;

use super::fan::Optics;
use super::path::{Path, fold};
use super::scene::{Event, Fate, Interface, Scene, Trace};
use super::snell::TotalReflection;

/// A flat slab in which the slowness s = 1/V depends on the distance from the axis alone, in a host that does not change.
///
/// In the slab a ray obeys dx/dz = p/q, dp/dz = s s′/q, dt/dz = s²/q, where (p, q) is the slowness along its way and q, which
/// nothing along z changes, is s at the place where the plane wave enters (Hamilton's equations of the eikonal |∇t| = s;
/// M. Born and E. Wolf, Principles of Optics, section 3.2). Behind the flat back p is kept, which is Snell's law.
pub struct Slab<F> {
    /// Depth of front and back (m).
    pub depth: [f64; 2],
    /// s(x) (s/m) and s′(x) (s/m²) for 0 ≤ x ≤ half width.
    pub slowness: F,
    /// Wave speed of the host (m/s).
    pub host: f64,
    /// Distance from the axis to the far mirror line (m).
    pub half_width: f64,
    /// Depth of the last row (m).
    pub end: f64,
}

/// Steps through the slab of a ray whose way is kept, each with a corner, and of one whose landing is all that is asked for.
const KEPT: usize = 24;
const LANDING: usize = 8;

/// Steps are halved until p² + q² is s² at the back to this, over q², but not more often than [`HALVINGS`] times: where a ray comes to
/// the end of the slab or to a mirror line, its speed has a kink that no order helps with.
const OFF: f64 = 1e-8;
const HALVINGS: u32 = 3;

/// A ray within the slab.
#[derive(Clone, Copy)]
struct State {
    /// Distance from the axis (m), unfolded.
    x: f64,
    /// p/q, its slope dx/dz.
    slope: f64,
    /// (s)
    time: f64,
}

impl<F: Fn(f64) -> [f64; 2] + Send + Sync> Slab<F> {
    /// s and s′ at an unfolded place.
    fn at(&self, x: f64) -> [f64; 2] {
        if x > 0.0 && x < self.half_width {
            return (self.slowness)(x);
        }
        let [s, change] = (self.slowness)(fold(x, self.half_width));
        let halves = x / self.half_width;
        // On a mirror line the two sides cancel, and in every other image x runs backwards.
        let sense = if halves == halves.floor() { 0.0 } else { 1.0 - 2.0 * halves.floor().rem_euclid(2.0) };
        [s, sense * change]
    }

    /// Crosses the slab from `x` in steps of the fifth order, tells `each` the states from that at the front, 0, on, and gives that
    /// at the back.
    ///
    /// x″ = s s′/q² knows nothing of the slope: four evaluations a step by E. Nyström's method of 1925 (E. Hairer, S. P. Nørsett
    /// and G. Wanner, Solving Ordinary Differential Equations I, section II.14). The time is summed by the weights of the
    /// slope, which are of the same order.
    fn cross(&self, x: f64, steps: usize, each: &mut impl FnMut(usize, State)) -> State {
        let [q, _] = self.at(x);
        let (per_q, per_square) = (1.0 / q, 1.0 / (q * q));
        let h = (self.depth[1] - self.depth[0]) / steps as f64;
        let bend = |x: f64| {
            let [s, change] = self.at(x);
            (s * change * per_square, s * s * per_q)
        };
        let mut state = State { x, slope: 0.0, time: self.depth[0] / self.host };
        each(0, state);
        for k in 1..=steps {
            let State { x, slope, time } = state;
            let (way, square) = (h * slope, h * h);
            let (k1, t1) = bend(x);
            let (k2, t2) = bend(x + way / 5.0 + square / 50.0 * k1);
            let (k3, t3) = bend(x + way * (2.0 / 3.0) + square / 27.0 * (7.0 * k2 - k1));
            let (k4, t4) = bend(x + way + square / 70.0 * (21.0 * k1 - 4.0 * k2 + 18.0 * k3));
            state = State {
                x: x + way + square / 336.0 * (14.0 * k1 + 100.0 * k2 + 54.0 * k3),
                slope: slope + h / 336.0 * (14.0 * k1 + 125.0 * k2 + 162.0 * k3 + 35.0 * k4),
                time: time + h / 336.0 * (14.0 * t1 + 125.0 * t2 + 162.0 * t3 + 35.0 * t4),
            };
            each(k, state);
        }
        state
    }

    /// How far p² + q² is from s², over q².
    fn off(&self, start: f64, state: State) -> f64 {
        let ([q, _], [s, _]) = (self.at(start), self.at(state.x));
        (state.slope * state.slope + 1.0 - (s / q).powi(2)).abs()
    }

    /// The state at the back, by so many steps or, where these do not suffice, more: then `each` hears of all states again.
    fn behind(&self, x: f64, mut steps: usize, mut each: impl FnMut(usize, State)) -> State {
        let mut state = self.cross(x, steps, &mut each);
        for _ in 0..HALVINGS {
            if self.off(x, state) <= OFF {
                break;
            }
            steps *= 2;
            state = self.cross(x, steps, &mut each);
        }
        state
    }

    /// The sine of the angle behind the back of a ray that entered at `x`, by the slowness across, over that of the host, which is
    /// kept; mirrored as often as the ray was.
    fn sine(&self, x: f64, state: State) -> f64 {
        let [q, _] = self.at(x);
        let sine = state.slope * q * self.host;
        let turned = (state.x / self.half_width).floor() as i64 % 2 != 0;
        if turned { -sine } else { sine }
    }

    /// The host behind the slab.
    fn host(&self) -> Scene {
        Scene {
            interfaces: Vec::<Interface>::new(),
            speed: self.host,
            half_width: self.half_width,
            end: self.end,
            reflections: 0,
        }
    }
}

/// The unit vector down at an angle of this sine.
fn down(sine: f64) -> Vector2 {
    Vector2::new(sine, (1.0 - sine * sine).sqrt())
}

impl<F: Fn(f64) -> [f64; 2] + Send + Sync> Optics for Slab<F> {
    fn half_width(&self) -> f64 {
        self.half_width
    }

    fn trace(&self, start: f64) -> Trace {
        let mut states = Vec::with_capacity(KEPT + 1);
        let state = self.behind(start, KEPT, |k, state| {
            if k == 0 {
                states.clear();
            }
            states.push(state);
        });
        let steps = states.len() - 1;
        let mut path = Path::from([start, 0.0], KEPT + 6);
        for (k, State { x, time, .. }) in states.iter().enumerate().step_by(steps / KEPT) {
            let part = k as f64 / steps as f64;
            path.points.push([fold(*x, self.half_width), self.depth[0] + part * (self.depth[1] - self.depth[0])]);
            path.times.push(*time);
        }
        let mut events = vec![Event::Passed(0)];
        events.resize(KEPT, Event::Bent);
        let sine = self.sine(start, state);
        if sine.abs() >= 1.0 {
            let [s, _] = self.at(state.x);
            let total = TotalReflection {
                incidence: (sine / self.host / s).abs().min(1.0).asin(),
                critical: (1.0 / (self.host * s)).min(1.0).asin(),
            };
            return Trace { path, events, fate: Fate::Reflected(1, total) };
        }
        events.push(Event::Passed(1));
        let back = [fold(state.x, self.half_width), self.depth[1]];
        let rest = self.host().trace_from(back, down(sine), self.host);
        path.points.extend(&rest.path.points[1..]);
        path.times.extend(rest.path.times[1..].iter().map(|t| t + state.time));
        events.extend(rest.events);
        Trace { path, events, fate: rest.fate }
    }

    fn landing(&self, start: f64, depth: f64, met: &mut Vec<Event>) -> Option<f64> {
        if depth <= self.depth[1] {
            // In front of the slab or within it there is a way to be kept.
            let trace = self.trace(start);
            let leg = trace.path.leg_at(depth)?;
            met.clear();
            met.extend_from_slice(&trace.events[..leg]);
            return Some(trace.path.on_leg(leg, depth)?.0);
        }
        let state = self.behind(start, LANDING, |_, _| ());
        let sine = self.sine(start, state);
        met.clear();
        met.push(Event::Passed(0));
        met.resize(KEPT, Event::Bent);
        met.push(Event::Passed(1));
        let back = [fold(state.x, self.half_width), self.depth[1]];
        if sine.abs() < 1.0 { self.host().landing_from(back, down(sine), depth, met) } else { None }
    }

    fn failure(&self, fate: &Fate) -> Option<String> {
        match fate {
            Fate::Arrived => None,
            Fate::Reflected(_, total) => Some(format!("ends at the back: {total}")),
            Fate::Returned | Fate::Grazing(_) | Fate::Trapped => Some("does not come out".to_owned()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ray::{fan, spot};

    fn slab<F: Fn(f64) -> [f64; 2] + Send + Sync>(slowness: F, depth: [f64; 2]) -> Slab<F> {
        Slab { depth, slowness, host: 1.0, half_width: 10.0, end: 100.0 }
    }

    /// s = s₀ sech(g x) brings a plane wave to one point π/(2 g) deep, wherever it enters (A. Mikaelian 1951), in the time
    /// of the axis. 1e-5 of a half width of 10 is far less than a sphere; what the steps leave is less.
    #[test]
    fn the_hyperbolic_secant_focuses_exactly() {
        let (g, s) = (0.2, 2.0);
        let depth = std::f64::consts::FRAC_PI_2 / g;
        let slab = slab(move |x: f64| [1.0, -g * (g * x).tanh()].map(|k| k * s / (g * x).cosh()), [5.0, 5.0 + depth]);
        for x in [0.5, 2.0, 5.0, 9.0] {
            for steps in [KEPT, LANDING] {
                let State { x: end, time, .. } = slab.behind(x, steps, |_, _| ());
                assert!(end.abs() < 1e-5, "{x} {end}");
                assert!((time - 5.0 - s * depth).abs() < 1e-5, "{x} {time}");
            }
        }
    }

    /// Twice the steps divide the error by 2⁵, in place, slope, time and p² + q² − s²: by more than 24, as there are terms of higher order too.
    #[test]
    fn the_steps_are_of_the_fifth_order() {
        let slab = slab(|x| [2.0 / (1.0 + 0.05 * x * x), -0.2 * x / (1.0 + 0.05 * x * x).powi(2)], [5.0, 15.0]);
        let end = |steps| slab.cross(3.0, steps, &mut |_, _| ());
        let exact = end(512);
        let errors = [16, 32, 64].map(|steps| {
            let state = end(steps);
            let off = slab.off(3.0, state);
            [state.x - exact.x, state.slope - exact.slope, state.time - exact.time, off].map(f64::abs)
        });
        for k in 0..4 {
            for pair in errors.windows(2) {
                assert!(pair[0][k] > 24.0 * pair[1][k], "{errors:?}");
            }
        }
    }

    /// The landing is that of the whole way, to what eight steps leave: 1e-5 of a half width of 10 is far less than a sphere.
    #[test]
    fn a_landing_is_where_the_way_goes() {
        let slab = slab(|x| [2.0 / (1.0 + 0.01 * x * x), -0.04 * x / (1.0 + 0.01 * x * x).powi(2)], [5.0, 12.0]);
        let mut met = Vec::new();
        for x in [0.0, 0.7, 3.0, 6.0, 9.9] {
            let trace = slab.trace(x);
            for depth in [3.0, 8.0, 14.0, 30.0] {
                let leg = trace.path.leg_at(depth).unwrap();
                let whole = trace.path.at_depth(depth).unwrap().0;
                let landing = slab.landing(x, depth, &mut met).unwrap();
                assert!((landing - whole).abs() < 1e-5, "{x} {depth} {landing} {whole}");
                assert_eq!(met, trace.events[..leg]);
            }
        }
    }

    /// Of one speed it does nothing but delay.
    #[test]
    fn a_uniform_slab_only_delays() {
        let traces = fan(&slab(|_| [2.0, 0.0], [5.0, 15.0]), 7);
        let spot = spot(&traces, 50.0, Some(0.0)).unwrap();
        assert!((spot.times[0] - 60.0).abs() < 1e-10 && (spot.times[1] - 60.0).abs() < 1e-10);
        assert!(traces.iter().all(|t| t.path.points.len() == t.events.len() + 2));
    }
}
