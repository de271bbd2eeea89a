//! Geometric rays through a plano-convex lens: Snell's law, paths and arrival times.
//!
//! Points are (x, z), distance from the axis and depth, in metres. Rays start at row 1 (z = 0) along +z, as the plane wave
//! of the impact does, are reflected at the mirror lines x = 0 and x = half width, and end at the last row. A face only
//! refracts: what part of the wave it reflects below the critical angle is not considered.

use nalgebra::Vector2;

/// A wave that meets a faster medium so obliquely that nothing passes.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("total reflection: incidence at {:.1} degrees, critical angle {:.1} degrees", .incidence.to_degrees(), .critical.to_degrees())]
pub struct TotalReflection {
    /// Angle between ray and normal [rad].
    pub incidence: f64,
    /// arcsin(V_in/V_out) [rad]
    pub critical: f64,
}

/// Direction of the refracted ray: sin θ_out / sin θ_in = V_out / V_in, angles against the normal.
///
/// Directions and normal are unit vectors; the sense of the normal does not matter. In terms of the interface's angle θ_i and
/// the wave's angles θ₁, θ₂ against the rows this is θ₂ = θ_i − arcsin((V₂/V₁) sin(θ_i − θ₁)), Burgoyne 2016, eq. 5.5.
///
/// # Errors
/// Beyond the critical angle.
pub fn refract(
    direction: Vector2<f64>,
    normal: Vector2<f64>,
    speed_in: f64,
    speed_out: f64,
) -> Result<Vector2<f64>, TotalReflection> {
    let ratio = speed_out / speed_in;
    let along = direction.dot(&normal);
    let normal = if along < 0.0 { -normal } else { normal };
    let cosine = along.abs();
    let sine_squared = ratio * ratio * (1.0 - cosine * cosine).max(0.0);
    if sine_squared > 1.0 {
        return Err(TotalReflection { incidence: cosine.acos(), critical: (1.0 / ratio).asin() });
    }
    Ok(direction * ratio + normal * ((1.0 - sine_squared).sqrt() - ratio * cosine))
}

/// A face of the lens.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Face {
    /// The circular arc that the wave meets first.
    Front,
    /// The flat face.
    Back,
}

impl std::fmt::Display for Face {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Front => "curved front",
            Self::Back => "flat back",
        })
    }
}

/// Direction in the lens of a ray along +z that meets the front at x = radius × `sine`, x ≥ 0.
///
/// It depends on the place on the arc only through the angle of the face, whose sine this is. `speeds` are those of the
/// host and of the lens.
///
/// # Errors
/// Total reflection at the front.
pub fn enter(sine: f64, speeds: [f64; 2]) -> Result<Vector2<f64>, TotalReflection> {
    let normal = Vector2::new(sine, -(1.0 - sine * sine).max(0.0).sqrt());
    refract(Vector2::y(), normal, speeds[0], speeds[1])
}

/// Direction behind the flat back of a ray that has the direction `inside` in the lens.
///
/// # Errors
/// Total reflection at the back.
pub fn leave(inside: Vector2<f64>, speeds: [f64; 2]) -> Result<Vector2<f64>, TotalReflection> {
    refract(inside, Vector2::y(), speeds[1], speeds[0])
}

/// A crystal with a plano-convex lens in it, as rays see it.
///
/// The front is a circular arc, convex towards the impact, with its apex on the axis; the back is flat. The lens ends where
/// the two meet, or at the mirror line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bench {
    /// Depth of the front on the axis [m].
    pub apex: f64,
    /// Radius of the front [m].
    pub radius: f64,
    /// Depth of the back [m].
    pub back: f64,
    /// Distance from the axis to the far mirror line [m].
    pub half_width: f64,
    /// Depth of the last row [m].
    pub end: f64,
    /// Wave speeds of host and lens [m/s].
    pub speeds: [f64; 2],
}

/// The way of a ray.
#[derive(Clone, Debug, PartialEq)]
pub struct Path {
    /// Corners (x, z) [m]: start, faces, mirror lines, end.
    pub points: Vec<[f64; 2]>,
    /// Time at which the front passes each corner [s], 0 at the start.
    pub times: Vec<f64>,
}

/// Why a ray does not come out of the back of the lens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reason {
    /// It passes beside the lens.
    Beside,
    /// A face reflects it totally.
    TotalReflection(Face, TotalReflection),
    /// It meets the front again from inside before it reaches the back.
    LeavesThroughFront,
}

/// A ray that does not come out of the back of the lens.
#[derive(Clone, Debug, PartialEq)]
pub struct Stray {
    /// Why.
    pub reason: Reason,
    /// Its way as far as it is followed: to the end of the crystal beside the lens, otherwise to the face.
    pub path: Path,
}

impl std::fmt::Display for Stray {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match &self.reason {
            Reason::Beside => f.write_str("the ray passes beside the lens"),
            Reason::TotalReflection(face, reflection) => write!(f, "the ray ends at the {face}: {reflection}"),
            Reason::LeavesThroughFront => f.write_str("the ray leaves the lens through its curved front"),
        }
    }
}

impl std::error::Error for Stray {}

impl Bench {
    /// Depth of the arc below its apex at a distance `x` ≤ radius from the axis [m].
    pub fn sag(&self, x: f64) -> f64 {
        self.radius - (self.radius * self.radius - x * x).max(0.0).sqrt()
    }

    /// Half aperture: where the front meets the back, or the mirror line if that comes first [m].
    pub fn aperture(&self) -> f64 {
        let thickness = (self.back - self.apex).min(self.radius);
        (thickness * (2.0 * self.radius - thickness)).sqrt().min(self.half_width)
    }

    /// Follows the ray that starts at a distance `x` from the axis, 0 ≤ x ≤ half width.
    ///
    /// # Errors
    /// [`Stray`] if it does not come out of the back of the lens.
    pub fn trace(&self, x: f64) -> Result<Path, Stray> {
        let [host, lens] = self.speeds;
        let mut walk = Walk::from(x, self.half_width);
        let stray = |walk: Walk, reason| Err(Stray { reason, path: walk.path });
        // The rim is inside the lens in spite of round-off.
        if x > self.aperture() * (1.0 + 1e-12) {
            walk.to(x, self.end, host);
            return stray(walk, Reason::Beside);
        }
        let entry = self.apex + self.sag(x);
        walk.to(x, entry, host);
        let inside = match enter(x / self.radius, self.speeds) {
            Ok(direction) => direction,
            Err(reflection) => return stray(walk, Reason::TotalReflection(Face::Front, reflection)),
        };
        let slope = inside.x / inside.y;
        let exit = x + slope * (self.back - entry);
        if let Some(depth) = self.leaves_at(x, entry, slope, exit) {
            walk.to(x + slope * (depth - entry), depth, lens);
            return stray(walk, Reason::LeavesThroughFront);
        }
        walk.to(exit, self.back, lens);
        match leave(inside, self.speeds) {
            Ok(behind) => walk.to(exit + behind.x / behind.y * (self.end - self.back), self.end, host),
            Err(reflection) => return stray(walk, Reason::TotalReflection(Face::Back, reflection)),
        }
        Ok(walk.path)
    }

    /// Depth at which a ray that entered at (`x`, `entry`) and would be at `exit` at the back meets the front from inside.
    ///
    /// The lens is convex, so a ray that is within the aperture at the back has been in the lens all the way; so has one
    /// that came to the mirror line below the front. Any other meets the arc once more.
    pub(crate) fn leaves_at(&self, x: f64, entry: f64, slope: f64, exit: f64) -> Option<f64> {
        let aperture = self.aperture();
        if exit.abs() <= aperture * (1.0 + 1e-12) {
            return None;
        }
        if aperture >= self.half_width {
            let mirror = entry + (self.half_width.copysign(exit) - x) / slope;
            if mirror >= self.apex + self.sag(self.half_width) {
                return None;
            }
        }
        // Second intersection of the line through (x, entry) with the circle around (0, apex + radius).
        let (dx, dz) = (x, entry - self.apex - self.radius);
        Some(entry - 2.0 * (dx * slope + dz) / (1.0 + slope * slope))
    }
}

/// Builds a path from straight legs in a plane without mirrors, and folds it back between them.
struct Walk {
    x: f64,
    half_width: f64,
    path: Path,
}

impl Walk {
    fn from(x: f64, half_width: f64) -> Self {
        Self { x, half_width, path: Path { points: vec![[x, 0.0]], times: vec![0.0] } }
    }

    /// Goes straight to the unfolded place `x` at `depth`.
    fn to(&mut self, x: f64, depth: f64, speed: f64) {
        let (x0, last) = (self.x, self.path.points.len() - 1);
        let (z0, t0) = (self.path.points[last][1], self.path.times[last]);
        let duration = (x - x0).hypot(depth - z0) / speed;
        let (low, high) = (x.min(x0) / self.half_width, x.max(x0) / self.half_width);
        let mut mirrors: Vec<f64> = (low.floor() as i64 + 1..high.ceil() as i64)
            .map(|k| (k as f64 * self.half_width - x0) / (x - x0))
            .collect();
        mirrors.sort_by(f64::total_cmp);
        for part in mirrors {
            let folded = fold(x0 + part * (x - x0), self.half_width);
            let on_line = if folded < 0.5 * self.half_width { 0.0 } else { self.half_width };
            self.path.points.push([on_line, z0 + part * (depth - z0)]);
            self.path.times.push(t0 + part * duration);
        }
        self.path.points.push([fold(x, self.half_width), depth]);
        self.path.times.push(t0 + duration);
        self.x = x;
    }
}

/// The place between the mirror lines to which an unfolded `x` belongs.
fn fold(x: f64, half_width: f64) -> f64 {
    let wrapped = x.abs() % (2.0 * half_width);
    wrapped.min(2.0 * half_width - wrapped)
}

impl Path {
    /// Place [m] and time [s] at which the ray passes a depth; none if it does not come there.
    pub fn at_depth(&self, depth: f64) -> Option<(f64, f64)> {
        let leg = self.points.windows(2).position(|leg| (leg[0][1]..=leg[1][1]).contains(&depth))?;
        let ([x0, z0], [x1, z1]) = (self.points[leg], self.points[leg + 1]);
        let part = if z1 > z0 { (depth - z0) / (z1 - z0) } else { 0.0 };
        let (t0, t1) = (self.times[leg], self.times[leg + 1]);
        Some((x0 + part * (x1 - x0), t0 + part * (t1 - t0)))
    }

    /// Depth at which the ray first comes to the axis [m]; none if it does not, or runs along it.
    pub fn axis_crossing(&self) -> Option<f64> {
        if self.points[0][0] == 0.0 {
            return None;
        }
        self.points.iter().find(|point| point[0] == 0.0).map(|point| point[1])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 440c and brass.
    const SPEEDS: [f64; 2] = [1344.68, 791.08];

    fn unit(angle: f64) -> Vector2<f64> {
        Vector2::new(angle.sin(), angle.cos())
    }

    /// In units of the diameter: rows 5 to 16 and a radius of 16.5/sin 60°.
    fn thesis_bench() -> Bench {
        let spacing = 0.75_f64.sqrt();
        let radius = 16.5 / 60.0_f64.to_radians().sin();
        Bench {
            apex: 4.0 * spacing,
            radius,
            back: 15.0 * spacing,
            half_width: 16.5,
            end: 49.0 * spacing,
            speeds: SPEEDS,
        }
    }

    /// Burgoyne 2016, fig. 5.14: an interface at 60° bends the wave by 60° − 30.6° = 29.4° (printed to 0.1°).
    #[test]
    fn a_sixty_degree_interface_bends_the_wave_by_the_published_angle() {
        let interface = 60.0_f64.to_radians();
        let refracted = refract(Vector2::y(), unit(interface), SPEEDS[0], SPEEDS[1]).unwrap();
        let bend = refracted.x.atan2(refracted.y);
        let equation_5_5 = interface - (SPEEDS[1] / SPEEDS[0] * interface.sin()).asin();
        assert!((bend - equation_5_5).abs() < 1e-14);
        assert!((bend.to_degrees() - 29.4).abs() < 0.05);
    }

    /// A refracted ray sent back takes the same way; the direction stays a unit vector. Round-off only.
    #[test]
    fn refraction_is_reversible() {
        for degrees in [-50.0_f64, -20.0, 0.0, 10.0, 35.0, 80.0] {
            let direction = unit(degrees.to_radians());
            let normal = unit(0.3);
            let Ok(refracted) = refract(direction, normal, SPEEDS[0], SPEEDS[1]) else {
                panic!("into the slower medium")
            };
            assert!((refracted.norm() - 1.0).abs() < 1e-14);
            let back = refract(-refracted, normal, SPEEDS[1], SPEEDS[0]).unwrap();
            assert!((back + direction).norm() < 1e-13);
        }
    }

    #[test]
    fn beyond_the_critical_angle_nothing_passes() {
        let critical = (SPEEDS[1] / SPEEDS[0]).asin();
        let normal = Vector2::y();
        let grazing = refract(unit(critical - 1e-6), normal, SPEEDS[1], SPEEDS[0]).unwrap();
        // 1e-6 rad below the critical angle the ray is within √(2e-6 tan θ) = 1.2e-3 of grazing.
        assert!(grazing.y > 0.0 && grazing.y < 2e-3);
        let reflected = refract(unit(critical + 1e-6), normal, SPEEDS[1], SPEEDS[0]).unwrap_err();
        assert!((reflected.critical - critical).abs() < 1e-14);
        assert!((reflected.incidence - critical - 1e-6).abs() < 1e-12);
    }

    /// Fermat: with the ends held, the time is stationary against shifts of the points on both faces. A shift of 1e-4 D off
    /// a path that was not stationary would change the time by some 1e-5 D over the speed; second order leaves 1e-9.
    #[test]
    fn travel_time_is_stationary() {
        let bench = thesis_bench();
        for x in [2.0, 8.0, 14.0] {
            let path = bench.trace(x).unwrap();
            let (entry, exit) = (path.points[1][0], path.points[2][0]);
            let depth = 20.0 * 0.75_f64.sqrt();
            let (x_end, time_end) = path.at_depth(depth).unwrap();
            let time = |entry: f64, exit: f64| {
                let front = bench.apex + bench.sag(entry);
                front / SPEEDS[0]
                    + (exit - entry).hypot(bench.back - front) / SPEEDS[1]
                    + (x_end - exit).hypot(depth - bench.back) / SPEEDS[0]
            };
            assert!((time(entry, exit) / time_end - 1.0).abs() < 1e-12);
            for (i, j) in [(1e-4, 0.0), (0.0, 1e-4)] {
                let slope = (time(entry + i, exit + j) - time(entry - i, exit - j)) / 2e-4;
                assert!(slope.abs() * SPEEDS[0] < 1e-7, "{slope} at {x}");
            }
        }
    }

    /// Rays close to the axis of a thin plano-convex lens meet at f = R/(V_host/V_lens − 1) behind it.
    #[test]
    fn a_thin_lens_has_the_textbook_focal_length() {
        let bench = Bench { apex: 1.0, radius: 10.0, back: 1.0001, half_width: 3.0, end: 100.0, speeds: SPEEDS };
        let focal = 10.0 / (SPEEDS[0] / SPEEDS[1] - 1.0);
        let crossing = bench.trace(1e-3).unwrap().axis_crossing().unwrap();
        assert!((crossing - bench.back - focal).abs() < 1e-3);
    }

    #[test]
    fn rays_that_the_lens_does_not_pass_on_say_why() {
        let bench = Bench { back: 8.0 * 0.75_f64.sqrt(), ..thesis_bench() };
        assert!(bench.aperture() < 13.0);
        let beside = bench.trace(14.0).unwrap_err();
        assert_eq!(beside.reason, Reason::Beside);
        assert_eq!(beside.path.at_depth(bench.end).unwrap().0, 14.0);

        // Into a faster lens the front reflects from asin(791/1345) = 36° on, x = 11.2.
        let faster = Bench { speeds: [SPEEDS[1], SPEEDS[0]], ..thesis_bench() };
        assert!(faster.trace(8.0).is_ok());
        let stray = faster.trace(11.3).unwrap_err();
        assert!(matches!(stray.reason, Reason::TotalReflection(Face::Front, _)));
        assert_eq!(stray.path.points.len(), 2);

        // A lens of a third of the host's speed sends the rim's ray to its back beyond asin(1/3) = 19°.
        let slower = Bench { speeds: [3.0, 1.0], ..thesis_bench() };
        let stray = slower.trace(16.0).unwrap_err();
        assert!(matches!(stray.reason, Reason::TotalReflection(Face::Back, _)));
        assert_eq!(stray.path.points.last().unwrap()[1], slower.back);
    }

    /// A fast, strongly curved lens throws a ray out through its own front, where it meets the circle again.
    #[test]
    fn a_ray_may_leave_through_the_front() {
        let bench = Bench { apex: 0.0, radius: 1.0, back: 0.9, half_width: 2.0, end: 3.0, speeds: [1.0, 1.5] };
        let stray = bench.trace(0.66).unwrap_err();
        assert_eq!(stray.reason, Reason::LeavesThroughFront);
        let [x, z] = *stray.path.points.last().unwrap();
        assert!((x.hypot(z - 1.0) - 1.0).abs() < 1e-12 && z < bench.back);
    }

    /// Mirror lines turn rays round; the time along a path is its length over the speeds.
    #[test]
    fn mirrors_keep_the_ray_in_the_crystal() {
        let bench = Bench { half_width: 16.5, end: 200.0, ..thesis_bench() };
        let path = bench.trace(16.0).unwrap();
        assert!(path.points.iter().all(|p| (0.0..=16.5).contains(&p[0])));
        assert!(path.points.len() > 6);
        let mut time = 0.0;
        for (k, leg) in path.points.windows(2).enumerate() {
            let speed = SPEEDS[usize::from(k == 1)];
            time += (leg[1][0] - leg[0][0]).hypot(leg[1][1] - leg[0][1]) / speed;
        }
        assert!((time / path.times.last().unwrap() - 1.0).abs() < 1e-12);
        assert_eq!(path.axis_crossing().unwrap(), path.points[3][1]);
    }
}
