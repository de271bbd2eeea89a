//! The way of a ray between the mirror lines.

/// The way of a ray.
#[derive(Clone, Debug, PartialEq)]
pub struct Path {
    /// Corners (x, z) (m): start, faces, mirror lines, end.
    pub points: Vec<[f64; 2]>,
    /// Time at which the front passes each corner (s), 0 at the start.
    pub times: Vec<f64>,
}

impl Path {
    /// A way that begins at a point (m), with room for so many corners.
    pub(super) fn from(start: [f64; 2], corners: usize) -> Self {
        let mut path = Self { points: Vec::with_capacity(corners), times: Vec::with_capacity(corners) };
        path.points.push(start);
        path.times.push(0.0);
        path
    }

    /// Place (m) and time (s) at which the ray passes a depth; none if it does not come there.
    pub fn at_depth(&self, depth: f64) -> Option<(f64, f64)> {
        self.on_leg(self.leg_at(depth)?, depth)
    }

    /// The first of the legs between corners on which the ray passes a depth; none if it does not come there.
    pub fn leg_at(&self, depth: f64) -> Option<usize> {
        self.points.windows(2).position(|leg| (leg[0][1]..=leg[1][1]).contains(&depth))
    }

    /// The same on one of the legs between corners; none if that does not come there.
    pub fn on_leg(&self, leg: usize, depth: f64) -> Option<(f64, f64)> {
        let part = part_at([self.points[leg][1], self.points[leg + 1][1]], depth)?;
        let ([x0, _], [x1, _]) = (self.points[leg], self.points[leg + 1]);
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

/// Which part of a leg between two depths, the second no less, a depth takes; none if it lies beyond them.
fn part_at([z0, z1]: [f64; 2], depth: f64) -> Option<f64> {
    (z0..=z1).contains(&depth).then(|| if z1 > z0 { (depth - z0) / (z1 - z0) } else { 0.0 })
}

/// Where a leg down between two points passes a depth.
pub(super) fn across([[x0, z0], [x1, z1]]: [[f64; 2]; 2], depth: f64) -> Option<f64> {
    Some(x0 + part_at([z0, z1], depth)? * (x1 - x0))
}

/// The place between the mirror lines to which an unfolded `x` belongs.
pub(super) fn fold(x: f64, half_width: f64) -> f64 {
    let wrapped = x.abs() % (2.0 * half_width);
    wrapped.min(2.0 * half_width - wrapped)
}
