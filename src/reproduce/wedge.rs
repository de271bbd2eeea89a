//! By which angle an oblique interface bends a plane wave.

use super::RowError;
use super::crystals::DIAMETER;
use super::lens::struck;
use crate::Context;
use crate::contact::{Constants, LawKind, Pair};
use crate::dem::rig::{Arrival, Body, Curve, LawBook, Load, LoadKind, Rig, Simulation};
use crate::dem::{ForcePulse, Impact, Integrator, simulate, steps_in};
use crate::lattice::HexagonalSheet;
use crate::layout::Layout;
use crate::material::Material;
use crate::ray::Eikonal;
use crate::wave::{Decay, Dimension, bound, site_speeds};

/// A wedge of the second material in a sheet of the first: half of it, cut along its axis.
///
/// ```text
///     |  1            ↓ wave
///     |\              x = 0: mirror, apex in row APEX
///     |  \            the face goes down from there at `angle` to the rows
///     | 2  \          refracted where it has passed the face
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Wedge {
    /// What the wave comes through, and what it comes into.
    pub materials: [Material; 2],
    /// Contact law.
    pub law: LawKind,
    /// Between face and rows (rad).
    pub angle: f64,
    /// Force at each contact of the first row over F_p at rest of the first material.
    pub amplitude: f64,
}

/// Row of the apex: the wave has formed by then.
const APEX: f64 = 10.0;
/// Pulse (s), section 5.3.2.
const PULSE: f64 = 20e-6;
/// The fit's distances behind the face, in diameters: past the face's steps, before the sides matter.
const BEHIND: [f64; 2] = [2.5, 9.0];
/// Which part of the region's median greatest speed counts as arrival.
const THRESHOLD: f64 = 0.1;
/// First arrivals are computed on a mesh so many times finer than the lattice.
const MESH: u32 = 4;

impl Wedge {
    /// Speed of the second over that of the first material, by the bound.
    pub fn speed_ratio(&self) -> f64 {
        let speed = |m: &Material| bound(Dimension::Two, [m, m], DIAMETER, Constants::Code).speed;
        speed(&self.materials[1]) / speed(&self.materials[0])
    }

    /// The angle (rad) that Snell's law gives: θ₂ = θ_i − arcsin(V₂/V₁ sin θ_i) (eq. 5.5 for a level wave).
    pub fn snell(&self) -> f64 {
        self.angle - (self.speed_ratio() * self.angle.sin()).asin()
    }

    /// The angle (rad) between the front behind the face and the rows, by a plane through simulated first arrivals.
    ///
    /// # Errors
    /// [`RowError`], where no wave comes or a run stops.
    pub fn bend(&self, context: &Context) -> Result<f64, RowError> {
        let (layout, region) = (self.layout()?, self.region()?);
        let times = self.first_arrivals(&layout, &region, context)?;
        Ok(front(&layout, &region, &times))
    }

    /// The angle (rad) at which first arrivals on the lattice are computed to come, by the same fit to the same spheres: at the
    /// wave-speed bound, and with each material's speed as its uniform crystal has it in each row under the same impact.
    ///
    /// # Errors
    /// As of [`Wedge::bend`].
    pub fn predicted(&self, context: &Context) -> Result<[f64; 2], RowError> {
        let (layout, region) = (self.layout()?, self.region()?);
        let decays = self.decays(layout.lattice.rows(), context)?;
        Ok([None, Some(&decays[..])].map(|decays| {
            let speeds = site_speeds(&layout, Constants::Code, decays);
            let times = Eikonal::of_plane_wave(&layout.lattice, &speeds, MESH).at_sites();
            front(&layout, &region, &region.iter().map(|&k| times[k]).collect::<Vec<_>>())
        }))
    }

    /// How the wave decays in the uniform crystal of either material: in a narrow strip, whose sides are mirrors.
    fn decays(&self, rows: u32, context: &Context) -> Result<Vec<Decay>, RowError> {
        let strip = HexagonalSheet::new(DIAMETER, rows, 1.0)?;
        let decay = |material: &Material| {
            let layout = Layout::new(strip.clone(), vec![material.clone()], |_| 0);
            let record = simulate(&layout.sample(), &self.impact(&strip), context)?;
            if let Some(stop) = record.stop {
                return Err(stop.into());
            }
            crate::evaluate::decay(&strip, material, Constants::Code, &record)
                .ok_or_else(|| RowError::NoWave(format!("the rows of a uniform crystal of {}", material.name)))
        };
        self.materials.iter().map(decay).collect()
    }

    /// Depth of the face (diameters) at a distance from the axis (diameters).
    fn face(&self, x: f64) -> f64 {
        (APEX - 1.0) * 0.75_f64.sqrt() + x * self.angle.tan()
    }

    fn layout(&self) -> Result<Layout, RowError> {
        // Flat faces need a wider sheet until they have gone as deep.
        let half_width = if self.angle > 0.8 { 20.5 } else { 30.5 };
        let across = half_width * self.angle.tan();
        let rows = (APEX + (across + 8.0) / 0.75_f64.sqrt()).ceil() as u32;
        let sheet = HexagonalSheet::new(DIAMETER, rows, half_width)?;
        Ok(Layout::new(sheet, self.materials.to_vec(), |site| {
            u8::from(site.z / DIAMETER >= self.face(site.x / DIAMETER) - 1e-9)
        }))
    }

    /// The spheres whose arrivals are fitted.
    fn region(&self) -> Result<Vec<usize>, RowError> {
        let sheet = self.layout()?.lattice;
        let (sites, half_width) = (sheet.sites(), sheet.half_width() / DIAMETER);
        // Seen along the direction in which Snell's law sends it, the wave of a sphere in the region has come through the
        // middle of the face.
        let direction = [-self.snell().sin(), self.snell().cos()];
        let cosine = -direction[0] * self.angle.sin() + direction[1] * self.angle.cos();
        let region: Vec<usize> = (0..sites.len())
            .filter(|&k| {
                let [x, z] = [sites[k].x, sites[k].z].map(|c| c / DIAMETER);
                let behind = (z - self.face(x)) * self.angle.cos();
                let entered = x - direction[0] * behind / cosine;
                let low = 0.25 * half_width;
                (BEHIND[0]..=BEHIND[1]).contains(&behind)
                    && (low..=half_width - 3.0).contains(&entered)
                    && (2.0..=half_width - 2.0).contains(&x)
            })
            .collect();
        if region.len() < 10 {
            return Err(RowError::NoWave("a region wide enough for a fit".to_owned()));
        }

        Ok(region)
    }

    /// What strikes a sheet of `rows` rows: the first row, mirrors on both sides.
    fn impact(&self, sheet: &HexagonalSheet) -> Impact {
        let first = &self.materials[0];
        let pair = Pair::new([first, first], [0.5 * DIAMETER; 2], Constants::Code);
        let force = 3.0_f64.sqrt() * self.amplitude * pair.plastic_force();
        // Half of the slower bound all the way, and some time for the maxima.
        let speed = |m: &Material| bound(Dimension::Two, [m, m], DIAMETER, Constants::Code).speed;
        let slowest = self.materials.iter().map(speed).fold(f64::INFINITY, f64::min);
        let window = 2.0 * sheet.depth(f64::from(sheet.rows())) / slowest + 2.0 * PULSE;
        Impact {
            pulse: ForcePulse { force, duration: PULSE },
            ..struck(sheet, self.law, Integrator::Verlet, 1e-7, window)
        }
    }

    fn first_arrivals(&self, layout: &Layout, region: &[usize], context: &Context) -> Result<Vec<f64>, RowError> {
        let (sample, impact) = (layout.sample(), self.impact(&layout.lattice));
        let record = simulate(&sample, &impact, context)?;
        if let Some(stop) = record.stop {
            return Err(stop.into());
        }
        let mut peaks: Vec<f64> =
            region.iter().map(|&k| (2.0 * record.max_kinetic[k] / sample.mass(k)).sqrt()).collect();
        peaks.sort_by(f64::total_cmp);

        // The same once more, now that the threshold is known.
        let mut rig = Rig::new(sample.clone(), LawBook::named(self.law));
        rig.mirrors = impact.mirrors;
        rig.loads.push(Load {
            bodies: impact.struck.iter().copied().map(Body::Sphere).collect(),
            direction: [0.0, 1.0],
            kind: LoadKind::Force,
            curve: Curve::Square { peak: impact.pulse.force, start: 0.0, duration: PULSE },
        });
        let threshold = Arrival::Speed(THRESHOLD * peaks[peaks.len() / 2]);
        let mut simulation = Simulation::new(rig, impact.step)?.recording(vec![threshold]);
        for _ in 0..steps_in(impact.window, impact.step).div_ceil(200) {
            simulation.advance(200, context)?;
            let arrivals = simulation.arrivals(0);
            let times: Option<Vec<f64>> = region.iter().map(|&k| arrivals[k]).collect();
            if let Some(times) = times {
                return Ok(times);
            }
        }
        Err(RowError::NoWave("every sphere behind the interface".to_owned()))
    }
}

/// The angle (rad) between the rows and the front that comes to a region at these times.
fn front(layout: &Layout, region: &[usize], times: &[f64]) -> f64 {
    let sites = layout.lattice.sites();
    let places = region.iter().map(|&k| [sites[k].x, sites[k].z]);
    let slope = plane(&places.zip(times.iter().copied()).collect::<Vec<_>>());
    (-slope[0]).atan2(slope[1])
}

/// The slope in both directions of the plane through points with values that has the least squares.
fn plane(points: &[([f64; 2], f64)]) -> [f64; 2] {
    let n = points.len() as f64;
    let [mx, mz, mt] =
        points.iter().fold([0.0; 3], |[x, z, t], (at, time)| [x + at[0] / n, z + at[1] / n, t + time / n]);
    let (mut xx, mut xz, mut zz, mut xt, mut zt) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for ([x, z], t) in points {
        let (x, z, t) = (x - mx, z - mz, t - mt);
        xx += x * x;
        xz += x * z;
        zz += z * z;
        xt += x * t;
        zt += z * t;
    }
    let determinant = xx * zz - xz * xz;
    [(xt * zz - zt * xz) / determinant, (zt * xx - xt * xz) / determinant]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plane_is_found_again() {
        let at = |k: u32| [f64::from(k % 7), f64::from(k / 7)];
        let points: Vec<_> = (0..50).map(|k| (at(k), 3.0 - 0.25 * at(k)[0] + 0.5 * at(k)[1])).collect();
        let [a, b] = plane(&points);
        assert!((a + 0.25).abs() < 1e-12 && (b - 0.5).abs() < 1e-12);
    }
}
