//! The graded lens: a flat slab, slow at its axis and as fast as the host farther out.

/// Slowness across a graded slab.
///
/// So that all rays of a plane wave come to a point f behind the slab at one time, a slab so thin that rays do not bend in
/// it has to delay the axis by as much as the others have farther to go:
///
///   s(x) = s_lens − (√(r² + f²) − f)/(V_host L),   r = |x − axis|, L the thickness,
///
/// down to the slowness of the host, where it ends. A thick slab bends rays already inside, which brings the point nearer;
/// the solver chooses f by tracing.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    /// Depth of front and back (m).
    pub depth: [f64; 2],
    /// Where its axis lies (m).
    pub axis: f64,
    /// f (m)
    pub focal_length: f64,
    /// Slowness (s/m) of the host and of the slowest material.
    pub slowness: [f64; 2],
}

impl Profile {
    /// s (s/m) at a distance `x` (m) from the lens axis of the crystal.
    pub fn slowness(&self, x: f64) -> f64 {
        let [host, lens] = self.slowness;
        let r = (x - self.axis).abs();
        // Lengths of metres and millimetres: nothing over- or underflows, and hypot costs several times as much.
        let longer = (r * r + self.focal_length * self.focal_length).sqrt() - self.focal_length;
        (lens - longer * host / (self.depth[1] - self.depth[0])).clamp(host.min(lens), host.max(lens))
    }

    /// s (s/m) and its slope ds/dx (s/m²) at the same place; none where the slab has ended as the host.
    pub(super) fn with_slope(&self, x: f64) -> [f64; 2] {
        let [host, lens] = self.slowness;
        let off = x - self.axis;
        let way = (off * off + self.focal_length * self.focal_length).sqrt();
        let thickness = self.depth[1] - self.depth[0];
        let free = lens - (way - self.focal_length) * host / thickness;
        let kept = free.clamp(host.min(lens), host.max(lens));
        [kept, if kept == free { -off / way * host / thickness } else { 0.0 }]
    }
}

/// Fractions of the palette's materials, host first, whose random mixture has the slowness wanted: of the two that are
/// nearest to it in the order of their speeds. `speed` is that of a mixture of two (indices into the palette) with the given
/// fraction of the second.
pub(super) fn fractions(slowness: f64, pure: &[f64], speed: impl Fn([usize; 2], f64) -> f64) -> Vec<f64> {
    let mut order: Vec<usize> = (0..pure.len()).collect();
    order.sort_by(|&a, &b| pure[b].total_cmp(&pure[a]));
    let wanted = 1.0 / slowness;
    let mut parts = vec![0.0; pure.len()];
    let pair = order.windows(2).find(|pair| pure[pair[1]] <= wanted);
    match pair {
        Some(&[fast, slow]) if wanted < pure[fast] => {
            // The speed falls from the faster to the slower, possibly not evenly: bisected to round-off.
            let (mut low, mut high) = (0.0, 1.0);
            for _ in 0..50 {
                let middle = 0.5 * (low + high);
                *(if speed([fast, slow], middle) > wanted { &mut low } else { &mut high }) = middle;
            }
            parts[fast] = 1.0 - 0.5 * (low + high);
            parts[slow] = 0.5 * (low + high);
        }
        Some(&[fast, _]) => parts[fast] = 1.0,
        _ => parts[order[order.len() - 1]] = 1.0,
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mixtures_are_of_neighbours_in_speed() {
        let linear = |pure: &'static [f64]| move |[a, b]: [usize; 2], part: f64| pure[a] + part * (pure[b] - pure[a]);
        let pure: &'static [f64] = &[4.0, 1.0, 2.0];
        for (wanted, expected) in [
            (5.0, [1.0, 0.0, 0.0]),
            (3.0, [0.5, 0.0, 0.5]),
            (1.5, [0.0, 0.5, 0.5]),
            (1.0, [0.0, 1.0, 0.0]),
            (0.5, [0.0, 1.0, 0.0]),
        ] {
            let parts = fractions(1.0 / wanted, pure, linear(pure));
            assert!(parts.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9), "{wanted} {parts:?}");
        }
    }

    /// Central differences over 10⁻⁶ leave 10⁻¹² of second order and 10⁻¹⁰ of round-off.
    #[test]
    fn the_slope_is_that_of_the_slowness() {
        let profile = Profile { depth: [3.0, 9.0], axis: 2.0, focal_length: 10.0, slowness: [1.0, 2.0] };
        for x in [0.0, 1.3, 2.0, 3.7, 9.0, 13.0, 20.0] {
            let [s, slope] = profile.with_slope(x);
            let difference = (profile.slowness(x + 1e-6) - profile.slowness(x - 1e-6)) / 2e-6;
            assert!(s == profile.slowness(x) && (slope - difference).abs() < 1e-9, "{x} {slope} {difference}");
        }
    }

    #[test]
    fn a_graded_slab_is_slowest_at_its_axis_and_ends_as_the_host() {
        let profile = Profile { depth: [3.0, 9.0], axis: 2.0, focal_length: 10.0, slowness: [1.0, 2.0] };
        assert_eq!(profile.slowness(2.0), 2.0);
        assert_eq!(profile.slowness(0.0), profile.slowness(4.0));
        assert_eq!(profile.slowness(40.0), 1.0);
        // Equal time: what the slab delays less is what the way is longer.
        let (r, thickness) = (3.0_f64, 6.0);
        let saved = (2.0 - profile.slowness(2.0 + r)) * thickness;
        assert!((saved - (r.hypot(10.0) - 10.0)).abs() < 1e-12);
    }
}
