//! A lens as a shape: its faces, what lies between them, and what rays and sites see of it.

use crate::ray::Vector2;

use super::equal_time::EqualTime;
use super::family::EvenAsphere;
use super::graded::Profile;
use super::symmetry::Symmetry;
use crate::ray::{Conic, Curve, Graph, Interface, Optics, Scene, Segment, Slab};

/// One face, z over x in 0 ≤ x ≤ half width (m).
#[derive(Clone, Debug, PartialEq)]
pub enum Face {
    /// A flat, circular or conic face.
    Conic(Conic),
    /// A face in pieces, in order of x, with steps along z where they do not meet.
    Zoned(Vec<Conic>),
    /// The face of equal travel time.
    EqualTime(EqualTime),
    /// A conic face with terms of higher order.
    EvenAsphere(EvenAsphere),
    /// A straight face between two points (x, z) (m), in order of x.
    Ramp {
        /// First point.
        from: [f64; 2],
        /// Last point.
        to: [f64; 2],
    },
}

impl Face {
    /// A flat face.
    pub(super) fn flat(z: f64, x: [f64; 2]) -> Self {
        Self::Conic(Conic { vertex: Vector2::new(0.0, z), curvature: 0.0, constant: 0.0, x })
    }

    /// Its depth (m).
    pub fn height(&self, x: f64) -> f64 {
        let on = |conic: &Conic| conic.vertex.y + conic.sag(x - conic.vertex.x);
        match self {
            Self::Conic(conic) => on(conic),
            // Beyond the last piece that goes on.
            Self::Zoned(pieces) => pieces.iter().find(|p| x <= p.x[1]).or(pieces.last()).map_or(f64::NAN, on),
            Self::EqualTime(face) => face.height(x),
            Self::EvenAsphere(face) => face.height(x),
            Self::Ramp { from, to } => from[1] + (to[1] - from[1]) * (x - from[0]) / (to[0] - from[0]),
        }
    }

    /// What rays meet, on the range `x` of the element.
    fn curves(&self, x: [f64; 2]) -> Vec<Box<dyn Curve>> {
        let within = |range: [f64; 2]| [range[0].max(x[0]), range[1].min(x[1])];
        let piece = |conic: &Conic| Conic { x: within(conic.x), ..*conic };
        match self {
            Self::Conic(conic) => vec![Box::new(piece(conic))],
            Self::Zoned(pieces) => {
                let mut curves: Vec<Box<dyn Curve>> = Vec::new();
                let inside: Vec<Conic> = pieces.iter().map(piece).filter(|p| p.x[0] < p.x[1]).collect();
                for pair in inside.windows(2) {
                    let at = pair[0].x[1];
                    let ends = [&pair[0], &pair[1]].map(|p| Vector2::new(at, p.vertex.y + p.sag(at - p.vertex.x)));
                    // Second side: the lens. Where the next piece lies nearer to the impact the step's lens is beyond it,
                    // at larger x, and the segment runs towards −z, so that its normal points there.
                    curves.push(Box::new(Segment { from: ends[0], to: ends[1] }));
                }
                curves.extend(inside.into_iter().map(|piece| Box::new(piece) as Box<dyn Curve>));
                curves
            }
            Self::Ramp { from, to } => vec![Box::new(Segment { from: (*from).into(), to: (*to).into() })],
            Self::EqualTime(face) => {
                let x = within(face.x());
                let face = face.clone();
                let z = face.range();
                vec![Box::new(Graph { height: move |x| face.height(x), x, z, parts: 24 })]
            }
            Self::EvenAsphere(face) => {
                let (face, x) = (*face, within(face.x()));
                vec![Box::new(Graph { height: move |x| face.height(x), x, z: face.z, parts: 24 })]
            }
        }
    }

    /// The face as points (x, z) (m) on a range of x.
    fn points(&self, x: [f64; 2]) -> Vec<[f64; 2]> {
        const STEPS: u32 = 48;
        let mut places: Vec<f64> =
            (0..=STEPS).map(|k| x[0] + (x[1] - x[0]) * f64::from(k) / f64::from(STEPS)).collect();
        if let Self::Zoned(pieces) = self {
            // Both ends of a step.
            let ends = pieces.iter().map(|p| p.x[1]).filter(|end| *end < x[1]);
            places.extend(ends.flat_map(|end| [end, end + 1e-9 * (x[1] - x[0])]));
            places.sort_by(f64::total_cmp);
        }
        places.into_iter().map(|x| [x, self.height(x)]).collect()
    }
}

/// A homogeneous part of a lens: what lies between two faces.
#[derive(Clone, Debug, PartialEq)]
pub struct Element {
    /// The face that the wave meets first.
    pub front: Face,
    /// The face through which it leaves.
    pub back: Face,
    /// Where it begins and ends across the crystal (m); there its faces meet, or a mirror line is.
    pub x: [f64; 2],
    /// Its material, as an index into the palette: 1 is the lens material.
    pub material: u8,
}

/// A lens as a shape.
#[derive(Clone, Debug, PartialEq)]
pub enum Form {
    /// Elements one behind the other.
    Elements(Vec<Element>),
    /// A flat slab of graded speed.
    Graded(Profile),
}

/// The crystal around a form, for rays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Surrounds<'a> {
    /// Wave speeds (m/s) of the palette: host first.
    pub speeds: &'a [f64],
    /// Distance from the axis to the far mirror line (m).
    pub half_width: f64,
    /// Depth of the last row (m).
    pub end: f64,
}

impl Form {
    /// What rays run through.
    pub(super) fn optics(&self, around: Surrounds) -> Box<dyn Optics> {
        let (speed, half_width, end) = (around.speeds[0], around.half_width, around.end);
        match self {
            Self::Elements(elements) => {
                let mut interfaces = Vec::new();
                for (k, element) in elements.iter().enumerate() {
                    let inside = around.speeds[usize::from(element.material)];
                    let of = if elements.len() > 1 { format!(" of part {}", k + 1) } else { String::new() };
                    let faces = [(&element.front, [speed, inside], "front"), (&element.back, [inside, speed], "back")];
                    for (face, speeds, name) in faces {
                        let curves = face.curves(element.x).into_iter();
                        interfaces.extend(curves.map(|curve| Interface::new(curve, speeds, format!("{name}{of}"))));
                    }
                }
                interfaces.extend(walls(elements, around));
                Box::new(Scene { interfaces, speed, half_width, end, reflections: 0 })
            }
            Self::Graded(profile) => {
                let profile = profile.clone();
                let depth = profile.depth;
                Box::new(Slab { depth, slowness: move |x| profile.with_slope(x), host: speed, half_width, end })
            }
        }
    }

    /// Which part of the vertical line at `x` (m) between two depths (m) the material with this index takes; of a graded
    /// form everything within its slab counts.
    pub(super) fn between(&self, x: f64, [top, bottom]: [f64; 2]) -> Vec<(u8, f64)> {
        let overlap = |front: f64, back: f64| (back.min(bottom) - front.max(top)).max(0.0) / (bottom - top);
        match self {
            Self::Elements(elements) => elements
                .iter()
                .filter(|element| (element.x[0]..=element.x[1]).contains(&x))
                .map(|element| (element.material, overlap(element.front.height(x), element.back.height(x))))
                .collect(),
            Self::Graded(profile) => vec![(1, overlap(profile.depth[0], profile.depth[1]))],
        }
    }

    /// The material at a point (m), faces included to within `slack` (m): an index into the palette, 0 the host.
    pub(super) fn at(&self, [x, z]: [f64; 2], slack: f64) -> u8 {
        match self {
            Self::Elements(elements) => elements
                .iter()
                .find(|element| {
                    (element.x[0] - slack..=element.x[1] + slack).contains(&x)
                        && z >= element.front.height(x) - slack
                        && z <= element.back.height(x) + slack
                })
                .map_or(0, |element| element.material),
            Self::Graded(profile) => u8::from((profile.depth[0] - slack..=profile.depth[1] + slack).contains(&z)),
        }
    }

    /// The faces as lines of points (x, z) (m).
    pub fn faces(&self, half_width: f64) -> Vec<Vec<[f64; 2]>> {
        match self {
            Self::Elements(elements) => {
                elements.iter().flat_map(|e| [e.front.points(e.x), e.back.points(e.x)]).collect()
            }
            Self::Graded(profile) => profile.depth.map(|z| vec![[0.0, z], [half_width, z]]).into(),
        }
    }

    /// Whether every element has some width: a part of a lens may lie beyond the reach of its faces.
    pub(super) fn is_there(&self) -> bool {
        match self {
            Self::Elements(elements) => elements.iter().all(|element| element.x[0] < element.x[1]),
            Self::Graded(_) => true,
        }
    }

    /// Several forms beside each other as one; graded ones have no place in it.
    pub(super) fn beside(forms: impl IntoIterator<Item = Self>) -> Self {
        let elements = forms.into_iter().flat_map(|form| match form {
            Self::Elements(elements) => elements,
            Self::Graded(_) => Vec::new(),
        });
        Self::Elements(elements.collect())
    }

    /// Greatest angle of a face against the rows (rad); steps of zones do not count.
    pub fn steepest(&self) -> f64 {
        let Self::Elements(elements) = self else { return 0.0 };
        let faces = elements.iter().flat_map(|e| [(&e.front, e.x), (&e.back, e.x)]);
        faces
            .map(|(face, x)| match face {
                Face::Conic(conic) => steepest(conic, x),
                Face::Zoned(pieces) => pieces.iter().map(|p| steepest(p, x)).fold(0.0, f64::max),
                Face::EqualTime(face) => face.steepest(x),
                Face::EvenAsphere(face) => face.steepest(x),
                Face::Ramp { from, to } => ((to[1] - from[1]) / (to[0] - from[0])).abs().atan(),
            })
            .fold(0.0, f64::max)
    }

    /// How much each material of a palette of so many takes, host excluded: area of both halves (m²) or volume of the body (m³).
    /// Of a graded form all counts as the second.
    pub fn extents(&self, palette: usize, half_width: f64, symmetry: Symmetry) -> Vec<f64> {
        let mut extents = vec![0.0; palette];
        match self {
            Self::Elements(elements) => {
                for e in elements {
                    let thickness = |x: f64| e.back.height(x) - e.front.height(x);
                    extents[usize::from(e.material)] += symmetry.extent(e.x, thickness);
                }
            }
            Self::Graded(profile) => {
                extents[1] = symmetry.extent([0.0, half_width], |_| profile.depth[1] - profile.depth[0]);
            }
        }
        extents
    }

    /// How much of a window (m) it covers.
    pub(super) fn covered(&self, window: [f64; 2]) -> f64 {
        let ends = match self {
            Self::Elements(elements) => elements.iter().map(|e| e.x).reduce(|[a, b], [c, d]| [a.min(c), b.max(d)]),
            Self::Graded(_) => Some(window),
        };
        ends.map_or(0.0, |[low, high]| high.min(window[1]) - low.max(window[0]))
    }

    /// How far across the lens reaches from its axis (m), and its greatest extent along the wave (m).
    pub(super) fn extent(&self, axis: f64, half_width: f64) -> [f64; 2] {
        match self {
            Self::Elements(elements) => {
                let reach = |e: &Element| (axis - e.x[0]).max(e.x[1] - axis);
                let aperture = elements.iter().map(reach).fold(0.0, f64::max);
                let points: Vec<f64> = self.faces(half_width).into_iter().flatten().map(|p| p[1]).collect();
                let [low, high] =
                    [points.iter().copied().fold(f64::INFINITY, f64::min), points.iter().copied().fold(0.0, f64::max)];
                [aperture, high - low]
            }
            Self::Graded(profile) => [axis.max(half_width - axis), profile.depth[1] - profile.depth[0]],
        }
    }
}

/// Slopes grow with the distance from the vertex, on every conic.
fn steepest(conic: &Conic, x: [f64; 2]) -> f64 {
    let ends = [conic.x[0].max(x[0]), conic.x[1].min(x[1])];
    ends.map(|x| conic.slope(x - conic.vertex.x).abs().atan()).into_iter().fold(0.0, f64::max)
}

/// Walls along z where elements end, between the mirror lines, with some thickness: parts of a lens that are made for different
/// foci adjoin, and seldom with equal faces.
fn walls(elements: &[Element], around: Surrounds) -> Vec<Interface> {
    let least = 1e-9 * around.half_width;
    let inside = |x: &f64| *x > least && *x < around.half_width - least;
    let mut ends: Vec<f64> = elements.iter().flat_map(|element| element.x).filter(inside).collect();
    ends.sort_by(f64::total_cmp);
    ends.dedup_by(|a, b| *a - *b < least);
    let mut walls = Vec::new();
    for x in ends {
        // What lies on either side: depths of front and back, and the speed between them.
        let beside = |side: f64| -> Vec<([f64; 2], f64)> {
            let reaches = |e: &&Element| e.x[0] < x + side * 2.0 * least && x + side * 2.0 * least < e.x[1];
            let of = |e: &Element| ([e.front.height(x), e.back.height(x)], around.speeds[usize::from(e.material)]);
            elements.iter().filter(reaches).map(of).collect()
        };
        let sides = [beside(-1.0), beside(1.0)];
        let mut depths: Vec<f64> = sides.iter().flatten().flat_map(|(depths, _)| *depths).collect();
        depths.sort_by(f64::total_cmp);
        for pair in depths.windows(2).filter(|pair| pair[1] - pair[0] > least) {
            let middle = 0.5 * (pair[0] + pair[1]);
            let speeds = sides.each_ref().map(|side| {
                let here = side.iter().find(|([front, back], _)| (*front..*back).contains(&middle));
                here.map_or(around.speeds[0], |(_, speed)| *speed)
            });
            if speeds[0] != speeds[1] {
                // Towards −z, so that its second side is that of greater x.
                let wall = Segment { from: Vector2::new(x, pair[1]), to: Vector2::new(x, pair[0]) };
                walls.push(Interface::new(Box::new(wall), speeds, "side of a part"));
            }
        }
    }
    walls
}
