//! Hatchings that tell materials apart where colours do not.

/// Lines across a sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hatch {
    /// Directions of the lines, in degrees from the x axis, counter-clockwise on paper.
    pub directions: &'static [f64],
    /// Lines across a diameter, of each direction.
    pub lines: u32,
}

/// Hatchings in the order in which materials take them; a second round is twice as dense.
const DIRECTIONS: [&[f64]; 7] = [&[], &[45.0], &[-45.0], &[0.0], &[90.0], &[45.0, -45.0], &[0.0, 90.0]];

impl Hatch {
    /// Of the k-th material.
    pub fn of(k: usize) -> Self {
        let round = k / DIRECTIONS.len();
        Self { directions: DIRECTIONS[k % DIRECTIONS.len()], lines: 5 * (1 + round as u32) }
    }

    /// The chords of a circle about the origin.
    pub fn chords(&self, radius: f64) -> Vec<[[f64; 2]; 2]> {
        let pitch = 2.0 * radius / f64::from(self.lines);
        let mut chords = Vec::new();
        for direction in self.directions {
            // y points down on paper.
            let (sin, cos) = direction.to_radians().sin_cos();
            let (along, normal) = ([cos, -sin], [sin, cos]);
            for k in 0..self.lines {
                let offset = (f64::from(k) + 0.5) * pitch - radius;
                let half = (radius * radius - offset * offset).max(0.0).sqrt();
                let end = |sign: f64| std::array::from_fn(|i| offset * normal[i] + sign * half * along[i]);
                chords.push([end(-1.0), end(1.0)]);
            }
        }
        chords
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every chord begins and ends on the circle, and two directions cross.
    #[test]
    fn hatching_stays_within_the_sphere() {
        for k in 0..14 {
            let hatch = Hatch::of(k);
            for [a, b] in hatch.chords(3.175) {
                assert!((a[0].hypot(a[1]) - 3.175).abs() < 1e-12 && (b[0].hypot(b[1]) - 3.175).abs() < 1e-12);
            }
            assert_eq!(hatch.chords(1.0).len(), hatch.directions.len() * hatch.lines as usize);
        }
    }
}
