//! Drawings as pages of PDF. Coordinates in the file are millimetres: one matrix a page turns them into points.

use pdf_writer::{Content, Finish as _, Name, Pdf, Rect, Ref, Str, TextStr};

use super::drawing::{Anchor, Colour, Drawing, Face, Pen, Point, Shape, symbol};
use super::glyphs;
use super::piece::Mark;

/// Points in a millimetre.
const POINTS: f64 = 72.0 / 25.4;

/// A sheet of paper.
pub struct Page<'a> {
    /// Width and height (mm).
    pub size: Point,
    /// What is drawn on it, from its upper left corner.
    pub drawing: Drawing,
    /// Below that, a part of a larger drawing.
    pub view: Option<View<'a>>,
}

/// A part of a drawing, seen through a window of the page.
pub struct View<'a> {
    pub drawing: &'a Drawing,
    /// The window's upper left corner on the page (mm).
    pub corner: Point,
    /// Its size (mm).
    pub size: Point,
    /// The point of the drawing that lies in that corner (mm).
    pub origin: Point,
    /// 1 where the drawing is seen at its true size.
    pub scale: f64,
}

fn f(x: f64) -> f32 {
    // Ten nanometres are more than any printer resolves, and keep the file short.
    ((x * 1e5).round() / 1e5) as f32
}

/// A document; spheres of each material, of the given diameter (mm), are drawn once and placed many times.
pub fn document(title: &str, marks: &[Mark], diameter: f64, pages: &[Page]) -> Vec<u8> {
    let mut pdf = Pdf::new();
    let (catalog, tree, info) = (Ref::new(1), Ref::new(2), Ref::new(3));
    let fonts = [(Name(b"F"), Ref::new(4)), (Name(b"B"), Ref::new(5)), (Name(b"C"), Ref::new(6))];
    let mut next = 7;
    let mut take = || {
        next += 1;
        Ref::new(next - 1)
    };
    let names: Vec<String> = (0..marks.len()).map(|k| format!("S{k}")).collect();
    let symbols: Vec<Ref> = marks.iter().map(|_| take()).collect();
    let sheets: Vec<[Ref; 2]> = pages.iter().map(|_| [take(), take()]).collect();

    let mut root = pdf.catalog(catalog);
    root.pages(tree);
    // Readers then offer to print at the true size.
    root.viewer_preferences().pair(Name(b"PrintScaling"), Name(b"None"));
    root.finish();
    pdf.document_info(info).title(TextStr(title)).creator(TextStr("granulens"));
    pdf.pages(tree).kids(sheets.iter().map(|[page, _]| *page)).count(sheets.len() as i32);
    for ((_, font), base) in fonts.iter().zip([&b"Helvetica"[..], b"Helvetica-Bold", b"Courier"]) {
        pdf.type1_font(*font).base_font(Name(base)).encoding_predefined(Name(b"WinAnsiEncoding"));
    }
    for (mark, id) in marks.iter().zip(&symbols) {
        let mut content = Content::new();
        paint(&mut content, &symbol(mark, diameter), diameter, None);
        let bytes = content.finish();
        let reach = f(0.6 * diameter);
        let mut form = pdf.form_xobject(*id, &bytes);
        form.bbox(Rect::new(-reach, -reach, reach, reach));
        let mut resources = form.resources();
        resources.fonts().pairs(fonts);
        resources.finish();
        form.finish();
    }
    for (page, [id, content_id]) in pages.iter().zip(&sheets) {
        let [width, height] = page.size;
        let mut content = Content::new();
        content.transform([POINTS as f32, 0.0, 0.0, -POINTS as f32, 0.0, (POINTS * height) as f32]);
        if let Some(View { drawing, corner, size, origin, scale }) = &page.view {
            content.save_state();
            content.rect(f(corner[0]), f(corner[1]), f(size[0]), f(size[1])).clip_nonzero().end_path();
            let shift = [0, 1].map(|k| f(corner[k] - scale * origin[k]));
            content.transform([f(*scale), 0.0, 0.0, f(*scale), shift[0], shift[1]]);
            let seen = [origin[0], origin[1], origin[0] + size[0] / scale, origin[1] + size[1] / scale];
            paint(&mut content, drawing, diameter, Some(seen));
            content.restore_state();
        }
        paint(&mut content, &page.drawing, diameter, None);
        pdf.stream(*content_id, &content.finish());
        let mut sheet = pdf.page(*id);
        sheet.media_box(Rect::new(0.0, 0.0, (POINTS * width) as f32, (POINTS * height) as f32));
        sheet.parent(tree).contents(*content_id);
        let mut resources = sheet.resources();
        resources.fonts().pairs(fonts);
        let mut objects = resources.x_objects();
        for (name, symbol) in names.iter().zip(&symbols) {
            objects.pair(Name(name.as_bytes()), *symbol);
        }
        objects.finish();
        resources.finish();
        sheet.finish();
    }
    pdf.finish()
}

fn stroke(content: &mut Content, pen: &Pen) {
    let [r, g, b] = rgb(pen.colour);
    content.set_stroke_rgb(r, g, b).set_line_width(f(pen.width));
    content.set_dash_pattern(pen.dash.iter().flatten().map(|x| f(*x)), 0.0);
}

fn fill(content: &mut Content, colour: Colour) {
    let [r, g, b] = rgb(colour);
    content.set_fill_rgb(r, g, b);
}

fn rgb(colour: Colour) -> [f32; 3] {
    colour.map(|part| f(f64::from(part) / 255.0))
}

/// Paints what lies within a box, or all.
fn paint(content: &mut Content, drawing: &Drawing, diameter: f64, seen: Option<[f64; 4]>) {
    let outside = |shape: &Shape| {
        seen.is_some_and(|seen| {
            let bounds = shape.bounds(diameter);
            bounds[0] > seen[2] || bounds[2] < seen[0] || bounds[1] > seen[3] || bounds[3] < seen[1]
        })
    };
    for shape in drawing.shapes.iter().filter(|shape| !outside(shape)) {
        match shape {
            Shape::Disc { centre, radius, fill: colour, pen } => {
                circle(content, *centre, *radius);
                finish(content, *colour, pen.as_ref(), |content| {
                    circle(content, *centre, *radius);
                });
            }
            Shape::Box { corner, size, fill: colour, pen } => {
                let path = |content: &mut Content| {
                    content.rect(f(corner[0]), f(corner[1]), f(size[0]), f(size[1]));
                };
                path(content);
                finish(content, *colour, pen.as_ref(), path);
            }
            Shape::Lines { segments, pen } => {
                stroke(content, pen);
                for [from, to] in segments {
                    content.move_to(f(from[0]), f(from[1])).line_to(f(to[0]), f(to[1]));
                }
                content.stroke();
            }
            Shape::Text { at, size, anchor, face, text } => {
                let text = glyphs::plain(text);
                let width = size * glyphs::width(&text, *face);
                let left = match anchor {
                    Anchor::Start => at[0],
                    Anchor::Middle => at[0] - 0.5 * width,
                    Anchor::End => at[0] - width,
                };
                let font = match face {
                    Face::Plain => Name(b"F"),
                    Face::Bold => Name(b"B"),
                    Face::Fixed => Name(b"C"),
                };
                fill(content, super::drawing::BLACK);
                content.begin_text().set_font(font, f(*size));
                content.set_text_matrix([1.0, 0.0, 0.0, -1.0, f(left), f(at[1])]);
                content.show(Str(text.as_bytes())).end_text();
            }
            Shape::Sphere { at, material } => {
                let name = format!("S{material}");
                content.save_state().transform([1.0, 0.0, 0.0, 1.0, f(at[0]), f(at[1])]);
                content.x_object(Name(name.as_bytes())).restore_state();
            }
        }
    }
}

/// Fills and draws the path that was begun; a path is spent by either, so that it is laid anew for the second.
fn finish(content: &mut Content, colour: Option<Colour>, pen: Option<&Pen>, again: impl Fn(&mut Content)) {
    match (colour, pen) {
        (Some(colour), pen) => {
            fill(content, colour);
            content.fill_nonzero();
            if let Some(pen) = pen {
                again(content);
                stroke(content, pen);
                content.stroke();
            }
        }
        (None, Some(pen)) => {
            stroke(content, pen);
            content.stroke();
        }
        (None, None) => {
            content.end_path();
        }
    }
}

/// Four cubic arcs, which leave a circle by 2.7e-4 of its radius at most: less than a micrometre for a sphere of 6 mm.
fn circle(content: &mut Content, [x, y]: Point, radius: f64) {
    let k = 4.0 / 3.0 * (2.0_f64.sqrt() - 1.0) * radius;
    let (r, cx, cy) = (radius, x, y);
    content.move_to(f(cx + r), f(cy));
    for [x1, y1, x2, y2, x3, y3] in
        [[r, k, k, r, 0.0, r], [-k, r, -r, k, -r, 0.0], [-r, -k, -k, -r, 0.0, -r], [k, -r, r, -k, r, 0.0]]
    {
        content.cubic_to(f(cx + x1), f(cy + y1), f(cx + x2), f(cy + y2), f(cx + x3), f(cy + y3));
    }
    content.close_path();
}
