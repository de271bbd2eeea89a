//! Design surfaces: wave speed and what goes with it over two design variables, and the media as points on it.
//!
//! The sphere's size has no influence on the speed: K is proportional to the radius, so V = A √(3 K/(π R ρ)) does not depend on
//! it. It has on forces and energies.

use super::setting::SHOWN_AT;
use super::{AMPLITUDES, Axis, Dimension, Kind, Medium, Setting};

/// A medium on a design surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// Short name.
    pub label: String,
    /// Which way it is made, and so how it is drawn.
    pub kind: Kind,
    /// Where it lies, along x and y.
    pub place: [f64; 2],
    /// Its own value (SI), which is the surface's at that place only where the variables not shown are the medium's too.
    pub value: f64,
}

/// A grid line of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node {
    /// Where it is drawn. On continuous axes, which are logarithmic, at its value; a dimension is a band, drawn from half
    /// a unit below its number to half a unit above it.
    pub place: f64,
    /// The variable there.
    pub value: f64,
}

/// A surface that cannot be.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SurfaceError {
    /// Twice the same variable.
    #[error("both axes are {0}: choose two different ones")]
    Same(&'static str),
    /// A variable without influence on what is shown.
    #[error("{value} does not depend on {axis}: choose another axis")]
    NoInfluence {
        /// What is shown.
        value: &'static str,
        /// The axis.
        axis: &'static str,
    },
    /// The stiffness and what it follows from.
    #[error("stiffness follows from {0}, so the two cannot be chosen apart")]
    Follows(&'static str),
    /// A range without extent, below zero, or below F_p.
    #[error("{axis} from {from} to {to} (SI): {rule}")]
    Range {
        /// The axis.
        axis: &'static str,
        /// Lower end in SI.
        from: f64,
        /// Upper end in SI.
        to: f64,
        /// What is wrong with it.
        rule: &'static str,
    },
}

/// A value over two variables.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    /// What is along x and along y.
    pub axes: [Axis; 2],
    /// The grid lines along x and along y.
    pub nodes: [Vec<Node>; 2],
    /// The value (SI) at node i of x and j of y, at j × (number along x) + i; none where nothing can be said.
    pub values: Vec<Option<f64>>,
    /// What is shown, and the variables that are no axes.
    pub setting: Setting,
}

impl Surface {
    /// The surface over two ranges in SI, with so many grid lines along each continuous axis, evenly spaced in the
    /// logarithm. A dimension's range is ignored: all three are shown.
    ///
    /// # Errors
    /// [`SurfaceError`]
    pub fn new(
        axes: [Axis; 2],
        ranges: [[f64; 2]; 2],
        count: [usize; 2],
        setting: &Setting,
    ) -> Result<Self, SurfaceError> {
        if axes[0] == axes[1] {
            return Err(SurfaceError::Same(axes[0].name()));
        }
        let chosen = |axis| axes.contains(&axis);
        if let Some(axis) = axes.into_iter().find(|axis| !setting.value.depends_on(*axis)) {
            return Err(SurfaceError::NoInfluence { value: setting.value.name(), axis: axis.name() });
        }
        for cause in [Axis::YieldStress, Axis::Modulus] {
            if chosen(cause) && (chosen(Axis::Stiffness) || setting.stiffness.is_some()) {
                return Err(SurfaceError::Follows(cause.name()));
            }
        }
        let nodes = [nodes(axes[0], ranges[0], count[0])?, nodes(axes[1], ranges[1], count[1])?];
        let rows = nodes[1].iter().flat_map(|y| {
            let row = setting.with(axes[1], y.value);
            nodes[0].iter().map(move |x| row.with(axes[0], x.value).value())
        });
        let values = rows.collect();
        Ok(Self { axes, nodes, values, setting: setting.clone() })
    }

    /// The value (SI) at node i along x and j along y.
    pub fn at(&self, i: usize, j: usize) -> Option<f64> {
        self.values.get(j * self.nodes[0].len() + i).copied().flatten()
    }

    /// The least and greatest value (SI); none where there is none at all.
    pub fn range(&self) -> Option<[f64; 2]> {
        let mut values = self.values.iter().flatten();
        let first = *values.next()?;
        Some(values.fold([first; 2], |[low, high], &v| [low.min(v), high.max(v)]))
    }
}

/// The media as points on a surface of these axes.
pub fn points(media: &[Medium], axes: [Axis; 2], setting: &Setting) -> Vec<Point> {
    let shown_at = axes.contains(&Axis::Amplitude).then_some(SHOWN_AT);
    let setting = Setting { amplitude: setting.amplitude.or(shown_at), ..setting.clone() };
    let point = |medium: &Medium| {
        Some(Point {
            label: medium.label.clone(),
            kind: medium.kind,
            place: axes.map(|axis| setting.place(medium, axis)),
            value: setting.value_of_medium(medium)?,
        })
    };
    media.iter().filter_map(point).collect()
}

fn nodes(axis: Axis, [from, to]: [f64; 2], count: usize) -> Result<Vec<Node>, SurfaceError> {
    if axis == Axis::Dimension {
        let band = |d: Dimension| [-0.5, 0.5].map(|side| f64::from(d.number()) + side);
        let bands = Dimension::ALL.into_iter().flat_map(|d| band(d).map(|place| (place, f64::from(d.number()))));
        return Ok(bands.map(|(place, value)| Node { place, value }).collect());
    }
    let fail = |rule| Err(SurfaceError::Range { axis: axis.name(), from, to, rule });
    if !(from.is_finite() && to.is_finite() && from > 0.0) {
        return fail("both ends must be positive");
    }
    if to < from * 1.001 {
        return fail("the upper end must lie above the lower one");
    }
    if axis == Axis::Amplitude && from < AMPLITUDES[0] {
        return fail("below 0.35 F_p contacts stay mostly elastic and the bound does not apply");
    }
    let count = count.clamp(2, 2000);
    let step = (to / from).ln() / (count - 1) as f64;
    // The ends are exact: the least amplitude must not fall below it by round-off.
    let value = |k: usize| if k + 1 == count { to } else { (from * (step * k as f64).exp()).clamp(from, to) };
    Ok((0..count).map(|k| Node { place: value(k), value: value(k) }).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::{Constants, Pair};
    use crate::material::{find, library};
    use crate::wave::{Value, speed_reached};
    use crate::wave::{bound, contour};

    fn setting() -> Setting {
        Setting {
            value: Value::Speed,
            against: None,
            material: find("440c", &[]).unwrap(),
            stiffness: None,
            dimension: Dimension::One,
            amplitude: None,
            diameter: 6.35e-3,
            constants: Constants::Code,
        }
    }

    fn range(axis: Axis) -> [f64; 2] {
        match axis {
            Axis::Stiffness => [5e6, 1e8],
            Axis::Density => [2e3, 2e4],
            Axis::YieldStress => [1e8, 4e9],
            Axis::Modulus => [5e10, 7e11],
            Axis::Radius => [1e-3, 1e-2],
            Axis::Amplitude => [1.0, 17.0],
            Axis::Dimension => [1.0, 3.0],
        }
    }

    fn every_pair() -> Vec<Surface> {
        let pairs = Axis::ALL.into_iter().flat_map(|x| Axis::ALL.into_iter().map(move |y| [x, y]));
        pairs.filter_map(|axes| Surface::new(axes, axes.map(range), [13, 11], &setting()).ok()).collect()
    }

    /// V = A g √(3 K/(π R ρ)) at every node, with K from an independent route through `bound` where it follows from σ_y, E.
    #[test]
    fn every_node_of_every_surface_is_the_closed_form() {
        let surfaces = every_pair();
        // 6 × 6, without the radius, less six equal ones, and stiffness with yield stress or modulus, either way round.
        assert_eq!(surfaces.len(), 26);
        for surface in surfaces {
            for (j, y) in surface.nodes[1].iter().enumerate() {
                for (i, x) in surface.nodes[0].iter().enumerate() {
                    let value = |axis| {
                        let k = surface.axes.iter().position(|&a| a == axis)?;
                        Some([x.value, y.value][k])
                    };
                    let mut material = setting().material;
                    material.density = value(Axis::Density).unwrap_or(material.density);
                    material.yield_stress = value(Axis::YieldStress).unwrap_or(material.yield_stress);
                    material.youngs_modulus = value(Axis::Modulus).unwrap_or(material.youngs_modulus);
                    let factor = [1.0, 1.125_f64.sqrt(), (4.0_f64 / 3.0).sqrt()];
                    let factor = factor[value(Axis::Dimension).unwrap_or(1.0) as usize - 1];
                    let own = bound(Dimension::One, [&material; 2], 6.35e-3, Constants::Code);
                    let stiff = value(Axis::Stiffness).map_or(1.0, |k| (k / own.stiffness).sqrt());
                    let pair = Pair::new([&material; 2], [3.175e-3; 2], Constants::Code);
                    let reached =
                        value(Axis::Amplitude).map_or(1.0, |a| speed_reached(&pair, material.density, a).unwrap());
                    match surface.at(i, j) {
                        Some(speed) => assert!((speed / (own.speed * factor * stiff * reached) - 1.0).abs() < 1e-12),
                        None => assert!(material.yield_stress >= material.youngs_modulus / 10.0),
                    }
                }
            }
        }
    }

    /// V rises with K, σ_y, E, amplitude and dimension, and falls with density, everywhere.
    #[test]
    fn the_speed_falls_with_density_alone() {
        for surface in every_pair() {
            let [nx, ny] = [surface.nodes[0].len(), surface.nodes[1].len()];
            for (i, j) in (0..ny).flat_map(|j| (0..nx).map(move |i| (i, j))) {
                for (axis, a, b) in [(0, i + 1, j), (1, i, j + 1)] {
                    if a == nx || b == ny {
                        continue;
                    }
                    let nodes = &surface.nodes[axis];
                    let rises = nodes[[a, b][axis]].value > nodes[[i, j][axis]].value;
                    let (Some(here), Some(there)) = (surface.at(i, j), surface.at(a, b)) else { continue };
                    let sign = if surface.axes[axis] == Axis::Density { -1.0 } else { 1.0 };
                    assert!(!rises || sign * (there - here) > 0.0, "{:?}", surface.axes);
                }
            }
        }
    }

    /// A contour is interpolated linearly between nodes h apart in the logarithms, in ln V: it is off by at most
    /// h²/8 max |d² ln V/du²|, which vanishes over K and ρ, where ln V is linear, and is a quarter at half of h.
    #[test]
    fn contour_lines_lie_on_their_level() {
        let worst = |axes: [Axis; 2], count: usize| -> f64 {
            let surface = Surface::new(axes, axes.map(range), [count; 2], &setting()).unwrap();
            let [low, high] = surface.range().unwrap();
            let level = (low * high).sqrt();
            let lines = contour(&surface, level);
            assert!(lines.iter().map(Vec::len).sum::<usize>() > count / 2);
            let off = |[x, y]: [f64; 2]| {
                let speed = setting().with(axes[0], x).with(axes[1], y).speed().unwrap();
                (speed / level).ln().abs()
            };
            lines.into_iter().flatten().map(off).fold(0.0, f64::max)
        };
        assert!(worst([Axis::Stiffness, Axis::Density], 5) < 1e-12);
        let plastic = [Axis::YieldStress, Axis::Modulus];
        // |d² ln V/du²| is below 0.1 where E* > 30 σ_y, and grows towards the end of the fit; h = ln(40)/32 here.
        let (coarse, fine) = (worst(plastic, 33), worst(plastic, 65));
        assert!(coarse < (40.0_f64.ln() / 32.0).powi(2) / 8.0 * 0.2, "{coarse}");
        assert!((2.0..8.0).contains(&(coarse / fine)), "{coarse} {fine}");
    }

    /// The surface passes through every medium's point where both of its variables are shown.
    #[test]
    fn media_lie_on_the_surface_of_stiffness_and_density() {
        let media = Medium::all(&library());
        for dimension in Dimension::ALL {
            let setting = Setting { dimension, ..setting() };
            for point in points(&media, [Axis::Stiffness, Axis::Density], &setting) {
                let there =
                    setting.with(Axis::Stiffness, point.place[0]).with(Axis::Density, point.place[1]).speed().unwrap();
                assert!((there / point.value - 1.0).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn surfaces_that_cannot_be_are_refused_in_words() {
        let refused =
            |axes, ranges, setting: &Setting| Surface::new(axes, ranges, [3, 3], setting).unwrap_err().to_string();
        let density = range(Axis::Density);
        assert!(refused([Axis::Density; 2], [density; 2], &setting()).contains("both axes are density"));
        let axes = [Axis::Stiffness, Axis::Modulus];
        assert!(refused(axes, axes.map(range), &setting()).contains("stiffness follows from modulus"));
        let fixed = setting().with(Axis::Stiffness, 1e7);
        assert!(refused([Axis::YieldStress, Axis::Density], [[1e8, 1e9], density], &fixed).contains("yield-stress"));
        let axes = [Axis::Amplitude, Axis::Density];
        assert!(refused(axes, [[0.3, 5.0], density], &setting()).contains("below 0.35 F_p"));
        for bad in [[1.0, f64::NAN], [-1.0, 1.0], [2.0, 1.0], [3.0, 3.0]] {
            assert!(Surface::new(axes, [[1.0, 9.0], bad], [3, 3], &setting()).is_err());
        }
    }
}
