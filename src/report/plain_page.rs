//! A page of pictures below some words, complete in itself: it needs no network.

use super::svg::escape;

/// A page under a title, with HTML `above` the pictures.
pub fn plain_page<'a>(title: &str, above: &str, pictures: impl Iterator<Item = &'a str>) -> String {
    let title = escape(title);
    let figures: String = pictures.map(|svg| format!("<figure>{svg}</figure>\n")).collect();
    format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>{title}</title>\n<style>body {{ \
         font-family: Helvetica, Arial, sans-serif; max-width: 62rem; margin: 2rem auto; padding: 0 1rem; }} figure {{ margin: \
         2rem 0; }} svg {{ max-width: 100%; height: auto; }} pre {{ background: #f4f4f4; padding: 1rem; overflow-x: auto; \
         }}</style>\n</head>\n<body>\n<h1>{title}</h1>\n{above}{figures}</body>\n</html>\n"
    )
}
