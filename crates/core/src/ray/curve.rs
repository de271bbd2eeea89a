//! Interfaces: curves that rays meet.

use crate::ray::Vector2;

type Vector = Vector2;

/// Where a ray meets a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Meeting {
    /// From the ray's origin (m).
    pub distance: f64,
    /// Unit normal there; it points from the curve's first side to its second.
    pub normal: Vector,
}

/// A curve that separates two media, its first side and its second.
pub trait Curve: Send + Sync {
    /// The first place, farther than `least` (m) from `origin` (m), where the ray along the unit vector `direction` meets
    /// the curve.
    fn meet(&self, origin: Vector, direction: Vector, least: f64) -> Option<Meeting>;

    /// Depths z (m) beyond which it is not, as far as that is known; generous by far more than round-off.
    fn depths(&self) -> [f64; 2] {
        [f64::NEG_INFINITY, f64::INFINITY]
    }
}

/// The depths of some points of a curve that reaches no farther, and 10⁻⁵ of its `extent` (m) more.
fn around(points: impl IntoIterator<Item = f64>, extent: f64) -> [f64; 2] {
    let [low, high] =
        points.into_iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], z| [low.min(z), high.max(z)]);
    let margin = 1e-5 * (extent.abs() + high - low);
    [low - margin, high + margin]
}

/// A straight piece. Its second side is that of +z where it runs along +x.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// First end (m).
    pub from: Vector,
    /// Last end (m).
    pub to: Vector,
}

/// How far beyond its ends, over its length, a piece still counts: round-off, so that nothing slips through where two
/// pieces join.
const END_SLACK: f64 = 1e-12;

impl Curve for Segment {
    fn meet(&self, origin: Vector, direction: Vector, least: f64) -> Option<Meeting> {
        let along = self.to - self.from;
        let cross = |a: Vector, b: Vector| a.x * b.y - a.y * b.x;
        let denominator = cross(direction, along);
        if denominator == 0.0 {
            return None;
        }
        let to_start = self.from - origin;
        let (distance, part) = (cross(to_start, along) / denominator, cross(to_start, direction) / denominator);
        let inside = (-END_SLACK..=1.0 + END_SLACK).contains(&part);
        (inside && distance > least)
            .then(|| Meeting { distance, normal: Vector::new(-along.y, along.x) / along.norm() })
    }

    fn depths(&self) -> [f64; 2] {
        around([self.from.y, self.to.y], self.to.x - self.from.x)
    }
}

/// Straight pieces from corner to corner, sides as those of [`Segment`].
#[derive(Clone, Debug, PartialEq)]
pub struct Polyline(pub Vec<Vector>);

impl Curve for Polyline {
    fn meet(&self, origin: Vector, direction: Vector, least: f64) -> Option<Meeting> {
        let pieces = self.0.windows(2).map(|ends| Segment { from: ends[0], to: ends[1] });
        nearest(pieces.filter_map(|piece| piece.meet(origin, direction, least)))
    }

    fn depths(&self) -> [f64; 2] {
        let extent = |corner: Option<&Vector>| corner.map_or(0.0, |corner| corner.x);
        around(self.0.iter().map(|corner| corner.y), extent(self.0.last()) - extent(self.0.first()))
    }
}

fn nearest(meetings: impl Iterator<Item = Meeting>) -> Option<Meeting> {
    meetings.min_by(|a, b| a.distance.total_cmp(&b.distance))
}

/// A full circle; its second side is outside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Circle {
    /// Its centre (m).
    pub centre: Vector,
    /// Its radius (m).
    pub radius: f64,
}

impl Curve for Circle {
    fn meet(&self, origin: Vector, direction: Vector, least: f64) -> Option<Meeting> {
        let from = origin - self.centre;
        let half = from.dot(&direction);
        let roots = quadratic(1.0, 2.0 * half, from.norm_squared() - self.radius * self.radius)?;
        let meeting = |distance: f64| Meeting { distance, normal: (from + direction * distance) / self.radius };
        nearest(roots.into_iter().filter(|&distance| distance > least).map(meeting))
    }
}

/// Real roots of a t² + b t + c, without cancellation; twice the same where a vanishes.
fn quadratic(a: f64, b: f64, c: f64) -> Option<[f64; 2]> {
    let discriminant = b * b - 4.0 * a * c;
    if discriminant < 0.0 {
        return None;
    }
    let q = -0.5 * (b + discriminant.sqrt().copysign(b));
    let roots = [q / a, c / q];
    match roots.map(f64::is_finite) {
        [true, true] => Some(roots),
        [true, false] => Some([roots[0]; 2]),
        [false, true] => Some([roots[1]; 2]),
        [false, false] => None,
    }
}

/// A piece of a conic about an axis along z; its second side is that of +z.
///
///   z − z₀ = c r² / (1 + √(1 − (1 + k) c² r²)),   r = x − x₀
///
/// with curvature c at the vertex (x₀, z₀), positive where the curve bends towards +z, and the conic constant k: a circle
/// has 0, ellipses −1 < k < 0 (k > 0 at the end of the minor axis), the parabola −1, hyperbolas k < −1 (M. Born and E. Wolf, Principles of Optics, on
/// aspherical surfaces). With c = 0 it is straight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conic {
    /// (x₀, z₀) (m)
    pub vertex: Vector,
    /// c (1/m)
    pub curvature: f64,
    /// k
    pub constant: f64,
    /// Least and greatest x of the piece (m).
    pub x: [f64; 2],
}

impl Conic {
    /// z at a distance `r` from the axis, over z₀ (m); that of the widest place where the conic is not as wide.
    pub fn sag(&self, r: f64) -> f64 {
        let root = (1.0 - (1.0 + self.constant) * (self.curvature * r).powi(2)).max(0.0).sqrt();
        self.curvature * r * r / (1.0 + root)
    }

    /// dz/dx at a distance `r` from the axis; infinite at the widest place of a closed conic.
    pub fn slope(&self, r: f64) -> f64 {
        self.curvature * r / (1.0 - (1.0 + self.constant) * (self.curvature * r).powi(2)).max(0.0).sqrt()
    }
}

impl Curve for Conic {
    fn meet(&self, origin: Vector, direction: Vector, least: f64) -> Option<Meeting> {
        let (c, g) = (self.curvature, (1.0 + self.constant) * self.curvature);
        let from = origin - self.vertex;
        let (d, z) = (direction, from.y);
        let slack = END_SLACK * (self.x[1] - self.x[0]);
        let within = |x: f64| (self.x[0] - slack..=self.x[1] + slack).contains(&x);
        if c == 0.0 {
            // Every second face is flat, and needs no root.
            let distance = -z / d.y;
            return (distance > least && distance.is_finite() && within(from.x + distance * d.x + self.vertex.x))
                .then(|| Meeting { distance, normal: Vector::y() });
        }
        // c r² + (1 + k) c s² − 2 s = 0 with s = z − z₀.
        let roots = quadratic(
            c * d.x * d.x + g * d.y * d.y,
            2.0 * (c * from.x * d.x + g * z * d.y - d.y),
            c * from.x * from.x + g * z * z - 2.0 * z,
        )?;
        let place = |distance: f64| {
            let (r, s) = (from.x + distance * d.x, z + distance * d.y);
            // The branch through the vertex, where the root in the equation of z is not negative.
            let root = 1.0 - g * s;
            (distance > least && root >= 0.0 && within(r + self.vertex.x)).then_some((distance, r, root))
        };
        let first = roots.into_iter().filter_map(place).min_by(|a, b| a.0.total_cmp(&b.0));
        first.map(|(distance, r, root)| Meeting { distance, normal: Vector::new(-c * r, root).normalize() })
    }

    fn depths(&self) -> [f64; 2] {
        // The sag grows with the distance from the axis.
        let [low, high] = self.x;
        let places = [low, high, self.vertex.x.clamp(low, high)];
        around(places.map(|x| self.vertex.y + self.sag(x - self.vertex.x)), high - low)
    }
}

/// Any curve z(x), met by bracketing: its second side is that of +z.
///
/// The way of the ray over the curve's range of x and z is cut into parts; where it changes from one side to the other the
/// crossing is found by secants, safeguarded by bisection, to round-off. A ray that crosses the curve twice within one part is missed: choose more
/// parts than the curve has bends.
pub struct Graph<F> {
    /// z(x) (m).
    pub height: F,
    /// Least and greatest x (m).
    pub x: [f64; 2],
    /// Least and greatest z in that range (m).
    pub z: [f64; 2],
    /// Parts of the way to look at.
    pub parts: u32,
}

impl<F: Fn(f64) -> f64 + Send + Sync> Curve for Graph<F> {
    fn meet(&self, origin: Vector, direction: Vector, least: f64) -> Option<Meeting> {
        // The part of the ray within the curve's rectangle.
        let (mut near, mut far) = (least, f64::INFINITY);
        let margin = END_SLACK * (self.x[1] - self.x[0] + self.z[1] - self.z[0]);
        for (from, along, [low, high]) in [(origin.x, direction.x, self.x), (origin.y, direction.y, self.z)] {
            let (low, high) = (low - margin, high + margin);
            if along == 0.0 {
                if !(low..=high).contains(&from) {
                    return None;
                }
                continue;
            }
            let ends = [(low - from) / along, (high - from) / along];
            (near, far) = (near.max(ends[0].min(ends[1])), far.min(ends[0].max(ends[1])));
        }
        if near > far || !far.is_finite() {
            return None;
        }
        if direction.x == 0.0 {
            // Down or up along z it is met where it lies.
            let distance = ((self.height)(origin.x.clamp(self.x[0], self.x[1])) - origin.y) / direction.y;
            return (distance > least).then(|| Meeting { distance, normal: self.normal(origin.x) });
        }
        let above = |distance: f64| {
            let point = origin + direction * distance;
            point.y - (self.height)(point.x.clamp(self.x[0], self.x[1]))
        };
        let place = |k: u32| near + (far - near) * f64::from(k) / f64::from(self.parts);
        let mut start = above(near);
        for k in 1..=self.parts {
            let end = above(place(k));
            if (start < 0.0) != (end < 0.0) {
                let distance = crossed([place(k - 1), place(k)], [start, end], above);
                return Some(Meeting { distance, normal: self.normal((origin + direction * distance).x) });
            }
            start = end;
        }
        None
    }

    fn depths(&self) -> [f64; 2] {
        around(self.z, self.x[1] - self.x[0])
    }
}

/// The place between two at which the sign changes, to round-off: secants by the Illinois rule, which halves the weight of an
/// end that stays (M. Dowell and P. Jarratt 1971), and every fourth time a bisection.
fn crossed([mut low, mut high]: [f64; 2], mut at: [f64; 2], value: impl Fn(f64) -> f64) -> f64 {
    let negative_at_low = at[0] < 0.0;
    // Bisections alone would exhaust the digits of any bracket in 64 of these.
    for k in 0..256 {
        let secant = low - at[0] * (high - low) / (at[1] - at[0]);
        let middle = if k % 4 == 3 || !(low..=high).contains(&secant) { 0.5 * (low + high) } else { secant };
        if middle <= low || middle >= high || high - low <= 2.0 * f64::EPSILON * high.abs() {
            return middle.clamp(low, high);
        }
        let here = value(middle);
        if (here < 0.0) == negative_at_low {
            (low, at) = (middle, [here, 0.5 * at[1]]);
        } else {
            (high, at) = (middle, [0.5 * at[0], here]);
        }
    }
    0.5 * (low + high)
}

impl<F: Fn(f64) -> f64> Graph<F> {
    /// By second-order differences over 10⁻⁶ of the width, one-sided at the ends: they leave some 10⁻¹⁰ of error in the
    /// direction of a smooth curve.
    fn normal(&self, x: f64) -> Vector {
        let step = 1e-6 * (self.x[1] - self.x[0]);
        let height = |steps: f64| (self.height)(x + steps * step);
        let differences = if x - step < self.x[0] {
            -3.0 * height(0.0) + 4.0 * height(1.0) - height(2.0)
        } else if x + step > self.x[1] {
            3.0 * height(0.0) - 4.0 * height(-1.0) + height(-2.0)
        } else {
            height(1.0) - height(-1.0)
        };
        Vector::new(-differences / (2.0 * step), 1.0).normalize()
    }
}
