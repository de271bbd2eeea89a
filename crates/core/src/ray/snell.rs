//! What happens to a ray at an interface.

use crate::ray::Vector2;

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
pub fn refract(direction: Vector2, normal: Vector2, speed_in: f64, speed_out: f64) -> Result<Vector2, TotalReflection> {
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

/// Direction of the reflected ray; the sense of the unit normal does not matter.
pub fn reflect(direction: Vector2, normal: Vector2) -> Vector2 {
    direction - normal * (2.0 * direction.dot(&normal))
}

/// What an interface does to a ray, with the unit vector along which it goes on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Passage {
    /// It goes on in the other medium.
    Refracted(Vector2),
    /// It meets the interface at the critical angle, to round-off, and runs along it.
    Grazing(Vector2),
    /// Nothing passes: it goes on in the same medium.
    Reflected(Vector2, TotalReflection),
}

impl Passage {
    /// The direction in which the ray goes on.
    pub fn direction(&self) -> Vector2 {
        match *self {
            Self::Refracted(direction) | Self::Grazing(direction) | Self::Reflected(direction, _) => direction,
        }
    }
}

/// Within this of 1, the squared sine of the refracted angle is that of a ray along the interface: round-off of the unit
/// vectors.
const GRAZING: f64 = 1e-14;

/// What becomes of a ray at an interface, by [`refract`] and [`reflect`]. Speeds are positive and finite; directions and
/// normal are unit vectors.
pub fn pass(direction: Vector2, normal: Vector2, speed_in: f64, speed_out: f64) -> Passage {
    let along = direction.dot(&normal);
    let sine_squared = (speed_out / speed_in).powi(2) * (1.0 - along * along).max(0.0);
    if speed_out > speed_in && (sine_squared - 1.0).abs() < GRAZING {
        let tangent = direction - normal * along;
        return Passage::Grazing(tangent / tangent.norm());
    }
    match refract(direction, normal, speed_in, speed_out) {
        Ok(refracted) => Passage::Refracted(refracted),
        Err(total) => Passage::Reflected(reflect(direction, normal), total),
    }
}
