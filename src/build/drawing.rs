//! Shapes on paper, in millimetres, x to the right and y down; the same for every kind of file.

use super::glyphs;
use super::piece::Mark;

/// A point or a size (mm).
pub type Point = [f64; 2];

/// Red, green and blue.
pub type Colour = [u8; 3];

pub const BLACK: Colour = [0, 0, 0];
pub const WHITE: Colour = [255, 255, 255];
pub const GREY: Colour = [110, 110, 110];

/// How a line is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pen {
    /// Width (mm).
    pub width: f64,
    pub colour: Colour,
    /// Length of dashes and of the gaps between them (mm).
    pub dash: Option<[f64; 2]>,
}

impl Pen {
    /// An unbroken black line.
    pub const fn black(width: f64) -> Self {
        Self { width, colour: BLACK, dash: None }
    }

    /// The same with dashes and gaps of these lengths (mm).
    pub const fn dashed(self, dash: [f64; 2]) -> Self {
        Self { dash: Some(dash), ..self }
    }

    /// The same in another colour.
    pub const fn coloured(self, colour: Colour) -> Self {
        Self { colour, ..self }
    }
}

/// Where a text is anchored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    Start,
    Middle,
    End,
}

/// What a text looks like.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Face {
    Plain,
    Bold,
    /// All letters equally wide.
    Fixed,
}

#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A circle, filled, drawn or both.
    Disc { centre: Point, radius: f64, fill: Option<Colour>, pen: Option<Pen> },
    /// Straight lines.
    Lines { segments: Vec<[Point; 2]>, pen: Pen },
    /// A rectangle by its upper left corner and its size.
    Box { corner: Point, size: Point, fill: Option<Colour>, pen: Option<Pen> },
    /// A line of text; the point lies on its baseline. `size` is that of the font (mm).
    Text { at: Point, size: f64, anchor: Anchor, face: Face, text: String },
    /// A sphere of a material, drawn at its true size about a point.
    Sphere { at: Point, material: usize },
}

/// Shapes, first ones below.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Drawing {
    pub shapes: Vec<Shape>,
}

impl Drawing {
    pub fn disc(&mut self, centre: Point, radius: f64, fill: Option<Colour>, pen: Option<Pen>) {
        self.shapes.push(Shape::Disc { centre, radius, fill, pen });
    }

    pub fn line(&mut self, from: Point, to: Point, pen: Pen) {
        self.lines(vec![[from, to]], pen);
    }

    pub fn lines(&mut self, segments: Vec<[Point; 2]>, pen: Pen) {
        if !segments.is_empty() {
            self.shapes.push(Shape::Lines { segments, pen });
        }
    }

    pub fn rectangle(&mut self, corner: Point, size: Point, fill: Option<Colour>, pen: Option<Pen>) {
        self.shapes.push(Shape::Box { corner, size, fill, pen });
    }

    pub fn text(&mut self, at: Point, size: f64, anchor: Anchor, text: impl Into<String>) {
        self.shapes.push(Shape::Text { at, size, anchor, face: Face::Plain, text: text.into() });
    }

    pub fn bold(&mut self, at: Point, size: f64, anchor: Anchor, text: impl Into<String>) {
        self.shapes.push(Shape::Text { at, size, anchor, face: Face::Bold, text: text.into() });
    }

    pub fn fixed(&mut self, at: Point, size: f64, text: impl Into<String>) {
        self.shapes.push(Shape::Text { at, size, anchor: Anchor::Start, face: Face::Fixed, text: text.into() });
    }

    pub fn sphere(&mut self, at: Point, material: usize) {
        self.shapes.push(Shape::Sphere { at, material });
    }

    /// A scale from a point to the right, or down: a line of 100 mm with a stroke at every 10 mm, and words.
    pub fn ruler(&mut self, [x, y]: Point, down: bool) {
        let at = |along: f64, beside: f64| if down { [x - beside, y + along] } else { [x + along, y - beside] };
        let pen = Pen::black(0.2);
        self.line(at(0.0, 0.0), at(RULER, 0.0), pen);
        let stroke = |k: i32| {
            let along = f64::from(k);
            let length = [1.2, 2.0, 3.2][usize::from(k % 5 == 0) + usize::from(k % 10 == 0)];
            [at(along, 0.0), at(along, length)]
        };
        self.lines((0..=RULER as i32).map(stroke).collect(), Pen::black(0.1));
    }
}

/// Length of rulers (mm).
pub const RULER: f64 = 100.0;

impl Shape {
    /// A box that holds it (mm): left, top, right, bottom.
    pub fn bounds(&self, diameter: f64) -> [f64; 4] {
        let around = |[x, y]: Point, reach: f64| [x - reach, y - reach, x + reach, y + reach];
        let join = |a: [f64; 4], b: [f64; 4]| [a[0].min(b[0]), a[1].min(b[1]), a[2].max(b[2]), a[3].max(b[3])];
        match self {
            Self::Disc { centre, radius, pen, .. } => around(*centre, radius + pen.map_or(0.0, |pen| 0.5 * pen.width)),
            Self::Lines { segments, pen } => {
                segments.iter().flatten().map(|point| around(*point, 0.5 * pen.width)).reduce(join).unwrap_or([0.0; 4])
            }
            Self::Box { corner: [x, y], size: [width, height], .. } => [*x, *y, x + width, y + height],
            Self::Text { at: [x, y], size, anchor, face, text } => {
                let width = glyphs::width(text, *face) * size;
                let left = x - match anchor {
                    Anchor::Start => 0.0,
                    Anchor::Middle => 0.5 * width,
                    Anchor::End => width,
                };
                [left, y - size, left + width, y + 0.3 * size]
            }
            Self::Sphere { at, .. } => around(*at, 0.5 * diameter + SPHERE_PEN.width),
        }
    }
}

/// The outline of a sphere; the line's middle is the sphere's surface.
pub const SPHERE_PEN: Pen = Pen::black(0.12);

/// A sphere of a material about the origin: fill, hatching, outline, and the letter on a white disc.
pub fn symbol(mark: &Mark, diameter: f64) -> Drawing {
    let radius = 0.5 * diameter;
    let mut drawing = Drawing::default();
    drawing.disc([0.0, 0.0], radius, Some(mark.colour), None);
    drawing.lines(mark.hatch.chords(radius), Pen::black(0.03 * diameter));
    drawing.disc([0.0, 0.0], radius, None, Some(SPHERE_PEN));
    drawing.disc([0.0, 0.0], 0.3 * diameter, Some(WHITE), None);
    let size = 0.42 * diameter / mark.letter.len().max(1) as f64;
    drawing.bold([0.0, 0.36 * size], size, Anchor::Middle, mark.letter.clone());
    drawing
}
