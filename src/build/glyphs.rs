//! Text in the fonts that every reader of PDF has.

use super::drawing::Face;
use crate::page::letter_width;

/// The text with what these fonts lack replaced.
pub fn plain(text: &str) -> String {
    text.chars().map(|c| if (' '..='~').contains(&c) { c } else { '?' }).collect()
}

/// Width of a text over the size of its font.
pub fn width(text: &str, face: Face) -> f64 {
    let of = |c: char| match face {
        Face::Plain => letter_width(c, false),
        Face::Bold => letter_width(c, true),
        Face::Fixed => 0.6,
    };
    text.chars().map(of).sum()
}
