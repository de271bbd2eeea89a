//! Contacts between spheres of unequal size, and those of designs that differ in their radii.
//!
//! Most laws ([`is_similar`](crate::contact::LawKind::is_similar)) know no length but the two radii, so a contact of r* = ρ r₀ is one
//! of r₀ seen through a magnifying glass
//! (strains and pressures are alike):
//!
//!   F(δ, v; r*, S) = ρ² F(δ/ρ, v S₀/S; r₀, S₀)
//!
//! with S the sum of the radii, by which a closing speed becomes a rate of strain. So one table of laws, made for spheres of one
//! reference radius, serves all radii, and what a contact remembers is kept in the reference's lengths and forces. Other laws are made for each size. Where all
//! radii are alike the reference is that radius, ρ = 1, and nothing is multiplied.

use crate::real::Lanes;
use crate::sample::Sample;

/// Spheres nearer than this part of their reach count as touching, and their gap as zero.
pub(super) const TOUCHING: f64 = 1e-9;

/// The radius (m) for which the laws of a sample with unequal spheres are made.
const REFERENCE: f64 = 1e-3;

/// The radius (m) for which a sample's laws are made: that of its spheres where all are alike. Empty sites do not count.
pub(super) fn reference_radius<const D: usize>(sample: &Sample<D>) -> f64 {
    let mut radii = sample.spheres.iter().map(|sphere| sphere.radius).filter(|&radius| radius > 0.0);
    let Some(first) = radii.next() else { return REFERENCE };
    if radii.all(|radius| radius == first) { first } else { REFERENCE }
}

/// A contact's geometry and size in each design.
#[derive(Clone, Copy, Debug)]
pub(super) struct Size<V> {
    /// As in the contact's `Touch` or `SelfTouch`.
    pub gap: V,
    /// r₁ + r₂ (m)
    pub reach: V,
    /// 1/ρ
    pub overlap: V,
    /// S₀/S
    pub speed: V,
    /// ρ²
    pub force: V,
}

impl<V: Lanes> Size<V> {
    /// Of the contact between two spheres, or a sphere and its image, whose gap in each sample is given.
    /// The law obeys similarity, or is made for each size.
    pub fn new<const D: usize>(
        samples: &[&Sample<D>],
        [a, b]: [usize; 2],
        is_similar: bool,
        gap: &dyn Fn(&Sample<D>) -> f64,
    ) -> Self {
        let one = V::splat(1.0);
        let mut size = Self { gap: one, reach: one, overlap: one, speed: one, force: one };
        for lane in 0..V::LANES {
            let sample = samples[lane.min(samples.len() - 1)];
            let [r, s] = [a, b].map(|i| sample.spheres[i].radius);
            size.gap.set_lane(lane, gap(sample));
            size.reach.set_lane(lane, r + s);
            let reference = reference_radius(sample);
            // A contact with an empty site never closes.
            if !is_similar || (r == reference && s == reference) || r * s == 0.0 {
                continue;
            }
            let ratio = 1.0 / (1.0 / r + 1.0 / s) / (0.5 * reference);
            size.overlap.set_lane(lane, 1.0 / ratio);
            size.speed.set_lane(lane, 2.0 * reference / (r + s));
            size.force.set_lane(lane, ratio * ratio);
        }
        size
    }
}

/// Whether the spheres of all samples have one radius.
pub(super) fn are_alike<const D: usize>(samples: &[&Sample<D>]) -> bool {
    let radius = samples[0].spheres.first().map_or(0.0, |sphere| sphere.radius);
    samples.iter().all(|sample| sample.spheres.iter().all(|sphere| sphere.radius == radius))
}

/// |offset|² − S² (m²) of two spheres of a sample that lie an offset apart (m): exactly zero where they just touch, infinite where one of
/// them is missing.
pub(super) fn gap_squared<const D: usize>(sample: &Sample<D>, [a, b]: [usize; 2], offset: &[f64; D]) -> f64 {
    let [a, b] = [a, b].map(|i| &sample.spheres[i]);
    if a.radius * b.radius == 0.0 {
        return f64::INFINITY;
    }
    let squared = offset.iter().map(|x| x * x).sum::<f64>();
    let reach = a.radius + b.radius;
    if (squared.sqrt() - reach).abs() <= TOUCHING * reach { 0.0 } else { squared - reach * reach }
}
