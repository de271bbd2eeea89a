//! A conic front with terms of fourth and sixth order, and a flat back: what optical designers call an even asphere.

use super::{PLAIN, Parameter, Place, Quantity, Row, greatest, one};
use crate::lens::form::{Face, Form};

pub(super) const FAMILY: Row = Row {
    name: "even-asphere",
    heading: "Radius of the front at its vertex",
    parameters: &[
        Parameter {
            name: "conic",
            about: "Conic constant of the front: 0 a circle, -1 a parabola, below it a hyperbola, between an ellipse",
            quantity: Quantity::Number,
            range: [-10.0, 10.0],
            usual: 0.0,
            is_sought: true,
        },
        Parameter {
            name: "sag_4",
            about: "How much the term of fourth order adds to the depth of the front at the farther end of its width",
            quantity: Quantity::Length,
            range: [-20.0, 20.0],
            usual: 0.0,
            is_sought: true,
        },
        Parameter {
            name: "sag_6",
            about: "The same of the term of sixth order",
            quantity: Quantity::Length,
            range: [-20.0, 20.0],
            usual: 0.0,
            is_sought: true,
        },
    ],
    is_monotonic: false,
    // Hyperbolas, and what their terms flatten, may begin with more curvature than a circle that is nowhere too steep.
    greatest: |place| 3.0 * greatest(place.thickness(), place.widest(), place.max_angle),
    form,
    ..PLAIN
};

/// The front of an even asphere, z over the distance r from its axis:
///
///   z(r) = z₀ + c r² / (1 + √(1 − (1 + κ) c² r²)) + a₄ (r/w)⁴ + a₆ (r/w)⁶
///
/// with the curvature c at the vertex, the conic constant κ, and w the width to which its terms refer, so that a₄ and a₆ are lengths (W. J.
/// Smith, Modern Optical Engineering, 4th ed. 2008, section 18.2, with other names).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EvenAsphere {
    /// Where its axis lies (m).
    pub axis: f64,
    /// Depth of its vertex (m).
    pub vertex: f64,
    /// c (1/m)
    pub curvature: f64,
    /// κ
    pub conic: f64,
    /// a₄ and a₆ (m)
    pub sags: [f64; 2],
    /// w (m)
    pub width: f64,
    /// How far it reaches from its axis (m).
    pub aperture: f64,
    /// Least and greatest depth of it (m).
    pub z: [f64; 2],
}

/// Places at which a front is looked at: whether it lies in its rows, and how steep it is.
const PLACES: u32 = 256;

impl EvenAsphere {
    /// How far it lies behind its vertex at a distance from its axis (m); not a number beyond where a conic ends.
    fn sag(&self, r: f64) -> f64 {
        let Self { curvature: c, conic, sags: [fourth, sixth], width, .. } = *self;
        let root = (1.0 - (1.0 + conic) * c * c * r * r).sqrt();
        let t = (r / width) * (r / width);
        c * r * r / (1.0 + root) + t * t * (fourth + t * sixth)
    }

    /// dz/dr
    fn slope(&self, r: f64) -> f64 {
        let Self { curvature: c, conic, sags: [fourth, sixth], width, .. } = *self;
        let root = (1.0 - (1.0 + conic) * c * c * r * r).sqrt();
        let t = r / width;
        c * r / root + t * t * t * (4.0 * fourth + 6.0 * t * t * sixth) / width
    }

    /// Depth (m) at a place across the crystal; beyond its reach that of the rim.
    pub(in crate::lens) fn height(&self, x: f64) -> f64 {
        self.vertex + self.sag((x - self.axis).abs().min(self.aperture))
    }

    /// Greatest angle against the rows (rad) within a range of x (m).
    pub(in crate::lens) fn steepest(&self, x: [f64; 2]) -> f64 {
        let reach = (self.axis - x[0]).max(x[1] - self.axis).min(self.aperture);
        let at = |k: u32| self.slope(reach * f64::from(k) / f64::from(PLACES)).abs().atan();
        (0..=PLACES).map(at).fold(0.0, f64::max)
    }

    /// Least and greatest x (m).
    pub(in crate::lens) fn x(&self) -> [f64; 2] {
        [self.axis - self.aperture, self.axis + self.aperture]
    }
}

/// It reaches to where it meets the flat back, or to the end of its window. None where its front would rise above its vertex, or ends before it
/// does either.
fn form(place: &Place, curvature: f64) -> Option<Form> {
    let [first, last] = place.depth;
    let (width, thickness) = (place.widest(), place.thickness());
    let [conic, fourth, sixth] = *place.values else { return None };
    let mut front = EvenAsphere {
        axis: place.axis,
        vertex: first,
        curvature,
        conic,
        sags: [fourth, sixth],
        width,
        aperture: width,
        z: [first, last],
    };
    let mut inside = 0.0;
    let mut greatest = 0.0_f64;
    for k in 1..=PLACES {
        let r = width * f64::from(k) / f64::from(PLACES);
        let sag = front.sag(r);
        // Beyond the end of a conic the sag is no number.
        if sag.is_nan() || sag < -1e-9 * width {
            return None;
        }
        if sag > thickness {
            let (mut low, mut high) = (inside, r);
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                *(if front.sag(middle) <= thickness { &mut low } else { &mut high }) = middle;
            }
            (front.aperture, greatest) = (low, thickness);
            break;
        }
        (inside, greatest) = (r, greatest.max(sag));
    }
    front.z = [first, first + greatest];
    let x = place.within(front.aperture);
    Some(one(Face::EvenAsphere(front), Face::flat(last, x), x))
}

#[cfg(test)]
mod tests {
    use super::super::Place;
    use super::*;
    use crate::lens::form::Surrounds;

    fn place(values: &[f64]) -> Place<'_> {
        Place {
            depth: [2.0, 60.0],
            spacing: 1.0,
            window: [0.0, 10.0],
            axis: 0.0,
            focus: 30.0,
            speeds: [1.7, 1.0],
            max_angle: 1.4,
            values,
            others: 0,
        }
    }

    fn front(form: &Form) -> EvenAsphere {
        let Form::Elements(elements) = form else { panic!("{form:?}") };
        let Face::EvenAsphere(front) = &elements[0].front else { panic!("{:?}", elements[0].front) };
        *front
    }

    /// An ellipse of the constant -1/n² with n the ratio of speeds brings a plane wave to one point in the lens, n R/(n - 1) behind its vertex (Descartes).
    /// Where a curve over x is met is known to round-off, and its normal by differences to some 10⁻⁸, which ways of ten times the radius bring to 10⁻⁶.
    #[test]
    fn an_ellipse_gathers_a_plane_wave_in_one_point() {
        let (n, radius) = (1.7, 12.0);
        let values = [-1.0 / (n * n), 0.0, 0.0];
        let place = place(&values);
        let form = form(&place, 1.0 / radius).unwrap();
        let optics = form.optics(Surrounds { speeds: &place.speeds, half_width: 10.0, end: 80.0 });
        for x in [0.5, 2.0, 5.0, 8.0, 9.9] {
            let crossing = optics.trace(x).path.axis_crossing().unwrap();
            assert!((crossing - (2.0 + n * radius / (n - 1.0))).abs() < 1e-6 * radius, "{x}: {crossing}");
        }
        // A circle does not: its rim gathers nearer.
        let values = [0.0; 3];
        let circle = super::form(&Place { values: &values, ..place }, 1.0 / radius).unwrap();
        let optics = circle.optics(Surrounds { speeds: &place.speeds, half_width: 10.0, end: 80.0 });
        assert!(optics.trace(9.9).path.axis_crossing().unwrap() < 2.0 + n * radius / (n - 1.0) - 1.0);
    }

    /// A parabola sags by c r²/2, and its terms add what they are called by at the end of the width; slopes are the differences of depths.
    #[test]
    fn terms_are_lengths_at_the_end_of_the_width() {
        let values = [-1.0, 0.75, -0.25];
        let form = form(&place(&values), 0.05).unwrap();
        let front = front(&form);
        assert_eq!(front.aperture, 10.0);
        assert!((front.height(10.0) - (2.0 + 0.5 * 0.05 * 100.0 + 0.75 - 0.25)).abs() < 1e-12);
        assert!((front.height(-5.0) - (2.0 + 0.5 * 0.05 * 25.0 + 0.75 / 16.0 - 0.25 / 64.0)).abs() < 1e-12);
        for r in [0.5, 3.0, 9.0] {
            let h = 1e-5;
            let difference = (front.height(r + h) - front.height(r - h)) / (2.0 * h);
            // Third derivative times h²/6, and round-off over h.
            assert!((front.slope(r) - difference).abs() < 1e-9, "{r}");
        }
        assert_eq!(front.z, [2.0, front.height(10.0)]);
    }

    /// It ends where it meets its back, and there is none where it would rise before its vertex or has no end.
    #[test]
    fn it_lies_between_its_rows() {
        let mut thin = place(&[0.0, 0.0, 0.0]);
        thin.depth = [2.0, 4.0];
        let circle = form(&thin, 1.0 / 12.0).unwrap();
        assert!((front(&circle).aperture - (2.0_f64 * (24.0 - 2.0)).sqrt()).abs() < 1e-12);
        assert_eq!(form(&Place { values: &[0.0, -8.0, 0.0], ..thin }, 0.01), None);
        // The ellipse x²/b² = ... of κ = 9 ends at r = R/√10 before it has come to the back.
        assert_eq!(form(&Place { values: &[9.0, 0.0, 0.0], ..place(&[]) }, 0.2), None);
    }
}
