//! Arrival of a wave that decays on its way through a lens.

use super::Lens;
use crate::ray::{Fate, Trace};
use crate::wave::Decay;

/// Steps to a row.
const STEPS: f64 = 4.0;

/// Rays that start this part of the half width to either side bound the tube in which a ray's energy runs.
const BESIDE: f64 = 0.03;

/// A tube never counts as narrower than this part of what it was: where rays cross, a wave is as wide as a few spheres.
const NARROWEST: f64 = 0.1;

impl Lens {
    /// When the ray that starts at a distance `x` (m) from the axis comes to `depth` (m), in a wave that decays: each piece of
    /// its way takes as long as in the uniform crystal of that material at the amplitude that the wave has there. `decays` are
    /// those of the palette under the impact, in its order.
    ///
    /// The amplitude falls as in the uniform crystals, and grows with the crowding of rays: the energy in a tube of rays of
    /// width w is kept but for the decay, so that F is proportional to w^(−1/2), contacts being springs. The way itself is that
    /// of the plain bound. None if the ray does not come there.
    pub fn arrival_decaying(&self, decays: &[Decay], x: f64, depth: f64) -> Option<f64> {
        let optics = self.optics();
        let half_width = optics.half_width();
        let trace = optics.trace(x);
        // Two rays beside it, both inside: on a mirror line the tube is cut in halves, which changes no ratio.
        let beside = BESIDE * half_width;
        let places = [(x - beside).max(0.0), (x + beside).min(half_width * (1.0 - 1e-7))];
        let bounds = places.map(|x| optics.trace(x));
        let width = |z: f64| -> Option<f64> {
            let [left, right] = [place(&bounds[0], z)?, place(&bounds[1], z)?];
            Some(((right - left).abs() / (places[1] - places[0])).max(NARROWEST))
        };
        let step = self.lattice.row_spacing() / STEPS;
        let count = (depth / step).ceil().max(1.0);
        let mut force = decays.first()?.start;
        let (mut time, mut before, mut wide) = (0.0, [place(&trace, 0.0)?, 0.0], 1.0);
        for k in 1..=count as u32 {
            let z = depth * f64::from(k) / count;
            let here = [place(&trace, z)?, z];
            let middle = [0.5 * (before[0] + here[0]), 0.5 * (before[1] + here[1])];
            let decay = decays.get(usize::from(self.form.at(middle, 0.0)))?;
            let way = (here[0] - before[0]).hypot(here[1] - before[1]);
            // A tube whose bounds are lost goes on as it was.
            let now = width(z).unwrap_or(wide);
            force *= (wide / now).sqrt();
            let next = decay.after(force, way);
            time += way / decay.speed_at((force * next).sqrt());
            (force, before, wide) = (next, here, now);
        }
        Some(time)
    }
}

fn place(trace: &Trace, z: f64) -> Option<f64> {
    // Of a ray that ends in the crystal, as far as it goes.
    let reaches = trace.fate == Fate::Arrived || trace.path.points.last().is_some_and(|end| end[1] >= z);
    reaches.then(|| trace.path.at_depth(z))?.map(|(x, _)| x)
}
