//! Patterns of materials over a crystal.

use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::SeedableRng;

use crate::lattice::{Crystal, hexagonal_distance};
use crate::stats::fraction;

/// How choices, numbered from 0, are spread over the sites of a crystal. Lengths in metres, angles in radians; x lies across
/// the wave, z along it.
#[derive(Clone, Debug, PartialEq)]
pub enum Pattern {
    /// Choice 0 everywhere.
    Uniform,
    /// The choices by turns, layer by layer, beginning with choice 0 in layer `first`; layers before it are left out.
    Layers {
        /// From 1.
        first: u32,
    },
    /// Stripes with the choices by turns. They run at `angle` to the x axis, rising towards +z; the first begins at `origin`
    /// (x, z) and goes on towards larger z.
    Stripes {
        /// Angle between stripes and x axis.
        angle: f64,
        /// Width of each, across the stripe.
        widths: Vec<f64>,
        /// A point on the edge where choice 0 begins.
        origin: [f64; 2],
    },
    /// Choice 0 behind two faces that meet in `apex` (x, z), each at `angle` to the x axis; the apex points against the wave.
    Wedge {
        /// Where the faces meet.
        apex: [f64; 2],
        /// Angle between each face and the x axis.
        angle: f64,
    },
    /// Choice 0 in an equilateral triangle whose base of so many spheres lies in the last layer and ends at its side.
    Triangle {
        /// Spheres along the base.
        spheres: u32,
        /// Which end of the last layer.
        side: Side,
    },
    /// The choices by turns in rings about `centre`: (x, y) in space, (x, z) in a sheet. Choice 0 reaches half a ring width
    /// far, so that rings one diameter wide hold one ring of sites each.
    Rings {
        /// Hexagons with corners along x, or circles.
        shape: RingShape,
        /// Width of a ring.
        width: f64,
        /// Middle.
        centre: [f64; 2],
    },
    /// Given for each site of the crystal, in their order; none leaves a site out.
    Listed(Vec<Option<usize>>),
    /// Each site for itself by chance.
    Mix {
        /// Share of each choice; together 1.
        fractions: Vec<f64>,
        /// Seed.
        seed: u64,
    },
}

/// An end of a layer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The lowest x.
    Left,
    /// The highest x.
    Right,
}

/// Kind of ring.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RingShape {
    /// Regular hexagons with corners along x.
    Hexagon,
    /// Circles.
    Circle,
}

/// A pattern that does not fit its crystal.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PatternError {
    /// It needs an axis across the wave.
    #[error("needs a sheet or a crystal in space; a chain has no axis across the wave")]
    Chain,
    /// Stripes or mixes whose list has another length than that of the materials.
    #[error("has {0} widths or fractions for {1} materials")]
    Count(usize, usize),
    /// Numbers that make no pattern.
    #[error("{0}")]
    Value(&'static str),
}

impl Pattern {
    /// The choice for each site, below `count`; none where the pattern leaves a site out.
    ///
    /// The map from a seed to a mix never changes: site k takes the choice in whose share the k-th output of xoshiro256++ falls,
    /// its state filled from the seed by SplitMix64 (Blackman & Vigna 2018), the upper 53 bits taken as a number from 0 to 1.
    ///
    /// # Errors
    /// See [`PatternError`].
    pub fn choices<const D: usize>(
        &self,
        crystal: &Crystal<D>,
        count: usize,
    ) -> Result<Vec<Option<usize>>, PatternError> {
        self.check::<D>(count)?;
        let mut chance = match self {
            Self::Mix { seed, .. } => Some(Xoshiro256PlusPlus::seed_from_u64(*seed)),
            _ => None,
        };
        // Places on an edge belong behind it, whatever the rounding of their coordinates.
        let slack = 1e-9 * crystal.diameter();
        let last = crystal.sites().iter().filter(|site| site.layer == crystal.layers()).map(|site| site.centre);
        let ends = last.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], c| [a.min(c[0]), b.max(c[0])]);
        let choice = |site: &crate::lattice::CrystalSite<D>| {
            let (x, z) = (site.centre[0], site.centre[D - 1]);
            match self {
                Self::Uniform => Some(0),
                Self::Layers { first } => site.layer.checked_sub(*first).map(|behind| behind as usize % count),
                Self::Stripes { angle, widths, origin } => {
                    let along = (z - origin[1]) * angle.cos() - (x - origin[0]) * angle.sin() + slack;
                    let mut within = along.rem_euclid(widths.iter().sum());
                    widths.iter().position(|width| {
                        within -= width;
                        within < 0.0
                    })
                }
                Self::Wedge { apex, angle } => (z - apex[1] + slack >= (x - apex[0]).abs() * angle.tan()).then_some(0),
                Self::Triangle { spheres, side } => {
                    let base = f64::from(spheres - 1) * crystal.diameter();
                    let [low, high] = match side {
                        Side::Left => [ends[0], ends[0] + base],
                        Side::Right => [ends[1] - base, ends[1]],
                    };
                    let inset = (f64::from(crystal.layers() - 1) * crystal.layer_spacing() - z) / 3_f64.sqrt();
                    (low + inset - slack <= x && x <= high - inset + slack).then_some(0)
                }
                Self::Rings { shape, width, centre } => {
                    let (a, b) = (x - centre[0], site.centre[1] - centre[1]);
                    let radius = match shape {
                        RingShape::Hexagon => hexagonal_distance(a, b),
                        RingShape::Circle => a.hypot(b),
                    };
                    Some(((radius + slack) / width + 0.5) as usize % count)
                }
                Self::Mix { .. } | Self::Listed(_) => None,
            }
        };
        if let Self::Listed(choices) = self {
            return Ok(choices.clone());
        }
        Ok(crystal
            .sites()
            .iter()
            .map(|site| match (self, &mut chance) {
                (Self::Mix { fractions, .. }, Some(chance)) => Some(draw(fractions, chance)),
                _ => choice(site),
            })
            .collect())
    }

    fn check<const D: usize>(&self, count: usize) -> Result<(), PatternError> {
        if D == 1 && !matches!(self, Self::Uniform | Self::Layers { .. } | Self::Mix { .. } | Self::Listed(_)) {
            return Err(PatternError::Chain);
        }
        let fail = |ok: bool, rule| if ok { Ok(()) } else { Err(PatternError::Value(rule)) };
        let positive = |values: &[f64]| values.iter().all(|&v| v.is_finite() && v > 0.0);
        match self {
            Self::Stripes { widths: values, .. } | Self::Mix { fractions: values, .. } if values.len() != count => {
                Err(PatternError::Count(values.len(), count))
            }
            Self::Stripes { widths, .. } => fail(positive(widths), "has a width that is not more than zero"),
            Self::Mix { fractions, .. } => {
                // Written in decimals; nobody means another sum.
                let sum: f64 = fractions.iter().sum();
                fail(positive(fractions) && (sum - 1.0).abs() < 1e-6, "has fractions whose sum is not 1")
            }
            Self::Rings { width, .. } => fail(positive(&[*width]), "has a ring width that is not more than zero"),
            Self::Wedge { angle, .. } => {
                fail((0.0..std::f64::consts::FRAC_PI_2).contains(angle), "has an angle outside 0 to 90 deg")
            }
            Self::Triangle { spheres, .. } => fail(*spheres > 0, "has no spheres along its base"),
            Self::Listed(choices) => fail(
                choices.iter().flatten().all(|&choice| choice < count),
                "chooses among more materials than there are",
            ),
            _ => fail(count > 0, "has no materials"),
        }
    }
}

/// The choice in whose share the next random number falls.
fn draw(fractions: &[f64], chance: &mut Xoshiro256PlusPlus) -> usize {
    let mut left = fraction(chance);
    for (k, fraction) in fractions.iter().enumerate() {
        left -= fraction;
        if left < 0.0 {
            return k;
        }
    }
    fractions.len() - 1
}
