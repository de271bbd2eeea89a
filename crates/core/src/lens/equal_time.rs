//! The front of equal travel time: with a flat back it brings all rays of a plane wave to one point.

/// The curved front of a lens with a flat back that brings a plane wave to one point behind it, exactly.
///
/// A ray that is to arrive under the angle θ leaves the back (depth b) at a distance (f − b) tan θ from the axis, with f the
/// depth of the point. In the lens it runs under θ′, sin θ′ = (V/V_host) sin θ. Equal time to the point (Fermat) fixes how far,
/// u, it has run in the lens:
///
///   u = (T − b/V_host − (f − b)/(V_host cos θ)) / (1/V − cos θ′/V_host)
///
/// with T the time along the axis. So the front is known as a curve over θ. It is kept as a table, between whose places a
/// cubic with the exact slopes (Snell) is taken: to 10⁻⁹ of the aperture.
#[derive(Clone, Debug, PartialEq)]
pub struct EqualTime {
    axis: f64,
    /// Distance from the axis, depth (m), and slope, in order of the distance.
    nodes: Vec<[f64; 3]>,
}

/// Places in the table.
const NODES: usize = 257;

impl EqualTime {
    /// A front with its apex at `apex`, for a flat back at `back` and a point at `focus` (depths, m), about an axis at `axis`
    /// (m), out to the distance `widest` (m) or to where it meets the back. `speeds` are those of host and lens.
    ///
    /// None if the lens is not slower than the host, or the order is not apex, back, focus.
    pub(super) fn new(apex: f64, back: f64, focus: f64, axis: f64, widest: f64, speeds: [f64; 2]) -> Option<Self> {
        let [host, lens] = speeds;
        if !(lens < host && apex < back && back < focus) {
            return None;
        }
        let ratio = lens / host;
        let node = |angle: f64| {
            let (sine, cosine) = (ratio * angle.sin(), (1.0 - (ratio * angle.sin()).powi(2)).sqrt());
            let lag = (focus - back) / host * (1.0 - 1.0 / angle.cos());
            let way = ((back - apex) * (1.0 / lens - 1.0 / host) + lag) / (1.0 / lens - cosine / host);
            let across = (focus - back) * angle.tan() + way * sine;
            // The ray is turned from +z to θ′ there; the face's normal lies along the change of its slowness.
            let slope = (sine / lens) / (cosine / lens - 1.0 / host);
            (way, [across, back - way * cosine, slope])
        };
        let fits = |angle: f64| {
            let (way, [across, ..]) = node(angle);
            way >= 0.0 && across <= widest
        };
        // The greatest angle: at the rim, or at the width asked for.
        let (mut low, mut high) = (0.0, 89.0_f64.to_radians());
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            *(if fits(middle) { &mut low } else { &mut high }) = middle;
        }
        let nodes: Vec<[f64; 3]> = (0..NODES).map(|k| node(low * k as f64 / (NODES - 1) as f64).1).collect();
        // A front that folds back on itself is none.
        nodes.windows(2).all(|pair| pair[1][0] > pair[0][0]).then_some(Self { axis, nodes })
    }

    /// Its reach to either side of the axis (m).
    pub(super) fn aperture(&self) -> f64 {
        self.nodes[NODES - 1][0]
    }

    /// Least and greatest x (m).
    pub(super) fn x(&self) -> [f64; 2] {
        [self.axis - self.aperture(), self.axis + self.aperture()]
    }

    /// Least and greatest depth (m).
    pub(super) fn range(&self) -> [f64; 2] {
        [self.nodes[0][1], self.nodes[NODES - 1][1]]
    }

    /// Greatest angle against the rows (rad) within a range of x (m).
    pub(super) fn steepest(&self, x: [f64; 2]) -> f64 {
        let reach = (self.axis - x[0]).max(x[1] - self.axis);
        let within = self.nodes.iter().filter(|node| node[0] <= reach * (1.0 + 1e-9));
        within.map(|node| node[2].atan()).fold(0.0, f64::max)
    }

    /// Depth (m); beyond its reach that of the rim.
    pub(super) fn height(&self, x: f64) -> f64 {
        let r = (x - self.axis).abs().min(self.aperture());
        let k = self.nodes.partition_point(|node| node[0] <= r).clamp(1, NODES - 1);
        let ([x0, z0, s0], [x1, z1, s1]) = (self.nodes[k - 1], self.nodes[k]);
        let h = x1 - x0;
        let t = (r - x0) / h;
        let u = 1.0 - t;
        z0 * u * u * (1.0 + 2.0 * t) + z1 * t * t * (1.0 + 2.0 * u) + h * t * u * (s0 * u - s1 * t)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Travel times through the front at places between the nodes, found by minimising over the place of exit (Fermat),
    /// without Snell's law: all equal to that of the axis.
    #[test]
    fn all_ways_take_the_same_time() {
        let [host, lens] = [1344.68, 791.08];
        let (apex, back, focus) = (4.0, 15.0, 27.0);
        let front = EqualTime::new(apex, back, focus, 0.0, 14.0, [host, lens]).unwrap();
        let on_axis = apex / host + (back - apex) / lens + (focus - back) / host;
        let time = |x: f64, exit: f64| {
            let z = front.height(x);
            z / host + (x - exit).hypot(back - z) / lens + exit.hypot(focus - back) / host
        };
        assert!(front.aperture() > 10.0);
        for k in 1..=40 {
            let x = 0.0247 * f64::from(k) * front.aperture();
            let (mut low, mut high) = (0.0, x);
            for _ in 0..200 {
                let third = (high - low) / 3.0;
                if time(x, low + third) < time(x, high - third) { high -= third } else { low += third }
            }
            let least = time(x, 0.5 * (low + high));
            assert!((least / on_axis - 1.0).abs() < 1e-9, "{x} {least} {on_axis}");
        }
    }

    #[test]
    fn what_cannot_gather_is_none() {
        assert_eq!(EqualTime::new(4.0, 15.0, 27.0, 0.0, 14.0, [791.0, 1344.0]), None);
        assert_eq!(EqualTime::new(4.0, 15.0, 14.0, 0.0, 14.0, [1344.0, 791.0]), None);
    }
}
