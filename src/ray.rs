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
    /// Angle between ray and normal (rad).
    pub incidence: f64,
    /// arcsin(V_in/V_out) (rad)
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
    /// Depth of the front on the axis (m).
    pub apex: f64,
    /// Radius of the front (m).
    pub radius: f64,
    /// Depth of the back (m).
    pub back: f64,
    /// Distance from the axis to the far mirror line (m).
    pub half_width: f64,
    /// Depth of the last row (m).
    pub end: f64,
    /// Wave speeds of host and lens (m/s).
    pub speeds: [f64; 2],
}

/// The way of a ray.
#[derive(Clone, Debug, PartialEq)]
pub struct Path {
    /// Corners (x, z) (m): start, faces, mirror lines, end.
    pub points: Vec<[f64; 2]>,
    /// Time at which the front passes each corner (s), 0 at the start.
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
    /// Depth of the arc below its apex at a distance `x` ≤ radius from the axis (m).
    pub fn sag(&self, x: f64) -> f64 {
        self.radius - (self.radius * self.radius - x * x).max(0.0).sqrt()
    }

    /// Half aperture: where the front meets the back, or the mirror line if that comes first (m).
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
    /// Place (m) and time (s) at which the ray passes a depth; none if it does not come there.
    pub fn at_depth(&self, depth: f64) -> Option<(f64, f64)> {
        let leg = self.points.windows(2).position(|leg| (leg[0][1]..=leg[1][1]).contains(&depth))?;
        let ([x0, z0], [x1, z1]) = (self.points[leg], self.points[leg + 1]);
        let part = if z1 > z0 { (depth - z0) / (z1 - z0) } else { 0.0 };
        let (t0, t1) = (self.times[leg], self.times[leg + 1]);
        Some((x0 + part * (x1 - x0), t0 + part * (t1 - t0)))
    }

    /// Depth at which the ray first comes to the axis (m); none if it does not, or runs along it.
    pub fn axis_crossing(&self) -> Option<f64> {
        if self.points[0][0] == 0.0 {
            return None;
        }
        self.points.iter().find(|point| point[0] == 0.0).map(|point| point[1])
    }
}

#[cfg(test)]
mod tests;
