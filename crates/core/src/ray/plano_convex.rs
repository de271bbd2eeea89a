//! The plano-convex lens by itself: faces known in advance, so that a ray takes nanoseconds. The search for a lens of this
//! family traces millions of them.

use crate::ray::Vector2;

use super::path::{Path, fold};
use super::snell::{TotalReflection, refract};

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
pub fn enter(sine: f64, speeds: [f64; 2]) -> Result<Vector2, TotalReflection> {
    let normal = Vector2::new(sine, -(1.0 - sine * sine).max(0.0).sqrt());
    refract(Vector2::y(), normal, speeds[0], speeds[1])
}

/// Direction behind the flat back of a ray that has the direction `inside` in the lens.
///
/// # Errors
/// Total reflection at the back.
pub fn leave(inside: Vector2, speeds: [f64; 2]) -> Result<Vector2, TotalReflection> {
    refract(inside, Vector2::y(), speeds[1], speeds[0])
}

/// A crystal with a plano-convex lens in it, as rays see it.
///
/// The front is a circular arc, convex towards the impact, with its apex on the axis; the back is flat. The lens ends where
/// the two meet, or at the mirror line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanoConvex {
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

impl PlanoConvex {
    /// Depth of the arc below its apex at a distance `x` ≤ radius from the axis (m).
    pub fn sag(&self, x: f64) -> f64 {
        self.radius - (self.radius * self.radius - x * x).max(0.0).sqrt()
    }

    /// Half aperture: where the front meets the back, or the mirror line if that comes first (m).
    pub fn aperture(&self) -> f64 {
        let thickness = (self.back - self.apex).min(self.radius);
        (thickness * (2.0 * self.radius - thickness)).sqrt().min(self.half_width)
    }

    /// Follows the ray that starts at a distance `x` (m) from the axis, 0 ≤ x ≤ half width.
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

#[cfg(test)]
#[path = "plano_convex_tests.rs"]
mod tests;
