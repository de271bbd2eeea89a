//! How a figure for a paper differs from one for a screen.

use super::colour::Palette;

/// What of a figure's look may be chosen.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Look {
    /// How wide it is printed (m); as wide as on a screen where there is none. Titles then are left to the paper's caption.
    pub width: Option<f64>,
    /// Size of letters (points), where the width is chosen; 8 where left out.
    pub font_size: Option<f64>,
    /// Colours.
    pub palette: Palette,
    /// The media whose names are written; all where there is none.
    pub labelled: Option<Vec<String>>,
}

/// Size of letters of a figure for a screen (px): what the sizes in drawings are multiples of.
const SCREEN: f64 = 11.5;

impl Look {
    /// Whether it is for a paper.
    pub fn is_for_paper(&self) -> bool {
        self.width.is_some()
    }

    /// Letters over those on a screen.
    pub fn letters(&self) -> f64 {
        match self.width {
            // A point is 4/3 of a pixel.
            Some(_) => self.font_size.unwrap_or(8.0) * 4.0 / 3.0 / SCREEN,
            None => 1.0,
        }
    }

    /// Width of the picture (px).
    pub fn pixels(&self, screen: f64) -> f64 {
        self.width.map_or(screen, |width| width / 0.0254 * 96.0)
    }

    /// The picture with its printed width in its head, where one was chosen; `size` is its own (px).
    pub(super) fn sized(&self, svg: String, size: [f64; 2]) -> String {
        let Some(width) = self.width else { return svg };
        let (millimetres, height) = (1e3 * width, 1e3 * width * size[1] / size[0]);
        let whole = size.map(f64::ceil);
        let from = format!("width=\"{}\" height=\"{}\" viewBox=\"0 0 {} {}\"", whole[0], whole[1], whole[0], whole[1]);
        let to = format!(
            "width=\"{millimetres:.3}mm\" height=\"{height:.3}mm\" viewBox=\"0 0 {:.3} {:.3}\"",
            size[0], size[1]
        );
        svg.replacen(&from, &to, 1)
    }
}
