//! What all pages share: one style sheet, and colours, letters and hatchings of materials that everybody can tell apart.
//!
//! Reports and the explorer put these into what they make; a page needs no network. Nothing here knows what a page says.

mod hatch;
mod letters;
mod palette;

pub use hatch::Hatch;
pub(crate) use letters::letter_width;
pub use palette::{Ink, MATERIALS, ink};

/// The rules of every page: type, tables, figures, notes, dark and light, narrow screens, paper. It goes into a `<style>`.
const RULES: &str = include_str!("look.css");

/// What a design surface says at a place, as a script.
pub const SURFACE: &str = include_str!("surface.js");

/// The style sheet: the rules, and the materials as `--material-0`, `--letter-0` and so on.
pub fn look() -> String {
    let inks = MATERIALS.iter().enumerate();
    let named = inks.map(|(k, ink)| format!("--material-{k}: {}; --letter-{k}: {};", ink.fill, ink.text));
    format!("{RULES}\n:root {{ {} }}\n", named.collect::<Vec<_>>().join(" "))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A page that is handed on must not ask anyone for anything, and a `<style>` ends where `</` does.
    #[test]
    fn the_style_sheet_asks_for_nothing() {
        let look = look();
        assert!(!look.contains("url(") && !look.contains("@import") && !look.contains("</"));
        assert!(look.contains("--material-7: #f5e960"));
    }
}
