//! Rays through a flat slab whose speed changes across it.

use nalgebra::Vector2;

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

/// Steps through the slab, of the fourth order; corners that are kept of them.
const STEPS: usize = 48;
const CORNERS: usize = 24;

impl<F: Fn(f64) -> [f64; 2] + Send + Sync> Slab<F> {
    /// x, p and time along z: their derivatives.
    fn along(&self, [x, p, _]: [f64; 3], q: f64) -> [f64; 3] {
        let [s, change] = if x > 0.0 && x < self.half_width {
            (self.slowness)(x)
        } else {
            let [s, change] = (self.slowness)(fold(x, self.half_width));
            let halves = x / self.half_width;
            // On a mirror line the two sides cancel, and in every other image x runs backwards.
            let sense = if halves == halves.floor() { 0.0 } else { 1.0 - 2.0 * halves.floor().rem_euclid(2.0) };
            [s, sense * change]
        };
        [p / q, s * change / q, s * s / q]
    }

    fn cross(&self, x: f64) -> Vec<[f64; 3]> {
        let [q, _] = (self.slowness)(x);
        let h = (self.depth[1] - self.depth[0]) / STEPS as f64;
        let moved = |y: [f64; 3], k: [f64; 3], h: f64| [0, 1, 2].map(|i| y[i] + h * k[i]);
        let mut states = Vec::with_capacity(STEPS + 1);
        states.push([x, 0.0, self.depth[0] / self.host]);
        for _ in 0..STEPS {
            let y = states[states.len() - 1];
            let a = self.along(y, q);
            let b = self.along(moved(y, a, 0.5 * h), q);
            let c = self.along(moved(y, b, 0.5 * h), q);
            let d = self.along(moved(y, c, h), q);
            states.push([0, 1, 2].map(|i| y[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i])));
        }
        states
    }
}

impl<F: Fn(f64) -> [f64; 2] + Send + Sync> Optics for Slab<F> {
    fn half_width(&self) -> f64 {
        self.half_width
    }

    fn trace(&self, x: f64) -> Trace {
        let states = self.cross(x);
        let mut path = Path { points: vec![[x, 0.0]], times: vec![0.0] };
        for (k, [x, _, time]) in states.iter().enumerate().step_by(STEPS / CORNERS) {
            let part = k as f64 / STEPS as f64;
            path.points.push([fold(*x, self.half_width), self.depth[0] + part * (self.depth[1] - self.depth[0])]);
            path.times.push(*time);
        }
        let mut events = vec![Event::Passed(0)];
        events.resize(CORNERS, Event::Bent);
        let [unfolded, p, time] = states[STEPS];
        // Slowness across, over that of the host: the sine of the angle behind the slab, mirrored as often as the ray was.
        let sine = p * self.host;
        let turned = (unfolded / self.half_width).floor() as i64 % 2 != 0;
        let sine = if turned { -sine } else { sine };
        if sine.abs() >= 1.0 {
            let [slowness, _] = (self.slowness)(fold(unfolded, self.half_width));
            let total = TotalReflection {
                incidence: (p / slowness).abs().min(1.0).asin(),
                critical: (1.0 / (self.host * slowness)).min(1.0).asin(),
            };
            return Trace { path, events, fate: Fate::Reflected(1, total) };
        }
        events.push(Event::Passed(1));
        let behind = Scene {
            interfaces: Vec::<Interface>::new(),
            speed: self.host,
            half_width: self.half_width,
            end: self.end,
            reflections: 0,
        };
        let start = *path.points.last().unwrap_or(&[x, 0.0]);
        let rest = behind.trace_from(start, Vector2::new(sine, (1.0 - sine * sine).sqrt()), self.host);
        path.points.extend(&rest.path.points[1..]);
        path.times.extend(rest.path.times[1..].iter().map(|t| t + time));
        events.extend(rest.events);
        Trace { path, events, fate: rest.fate }
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
    /// of the axis. 1e-5 of a half width of 10 is far less than a sphere; 48 steps of the fourth order leave less.
    #[test]
    fn the_hyperbolic_secant_focuses_exactly() {
        let (g, s) = (0.2, 2.0);
        let depth = std::f64::consts::FRAC_PI_2 / g;
        let slab = slab(move |x: f64| [1.0, -g * (g * x).tanh()].map(|k| k * s / (g * x).cosh()), [5.0, 5.0 + depth]);
        for x in [0.5, 2.0, 5.0, 9.0] {
            let states = slab.cross(x);
            let [x_end, _, time] = states[STEPS];
            assert!(x_end.abs() < 1e-5, "{x} {x_end}");
            assert!((time - 5.0 - s * depth).abs() < 1e-5, "{x} {time}");
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
