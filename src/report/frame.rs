//! The frame of pages that are not the report of a comparison: rigs, beds, studies, measurements. Complete in itself, readable without
//! script, with what is needed to repeat it.

use std::fmt::Write as _;

use super::svg::escape;
use crate::outcome::Method;
use crate::output::digest;

/// A picture on a page.
pub struct Figure<'a> {
    /// Its file beside the page; empty where there is none.
    pub file: &'a str,
    /// Itself.
    pub svg: &'a str,
    /// What is seen, as text.
    pub caption: String,
    /// The file beside the page that holds its numbers.
    pub numbers: Option<String>,
}

/// What is needed to repeat what a page shows.
#[derive(Clone, Debug, Default)]
pub struct Provenance {
    /// The command that gives the same numbers.
    pub command: String,
    /// The file that says what was asked.
    pub file: String,
    /// Its text, as read.
    pub text: String,
    /// Further facts: a label and what it labels.
    pub facts: Vec<(String, String)>,
}

impl Provenance {
    /// Of a command on a file.
    pub fn new(command: String, file: String, text: String) -> Self {
        Self { command, file, text, facts: Vec::new() }
    }

    /// With a further fact.
    #[must_use]
    pub fn with(mut self, label: &str, value: impl Into<String>) -> Self {
        self.facts.push((label.to_owned(), value.into()));
        self
    }

    /// With how it was simulated.
    #[must_use]
    pub fn by(self, method: &Method) -> Self {
        use crate::units::Dimension::Time;
        self.with("granulens", format!("{}, commit {}", method.version, method.commit))
            .with("Contact law", &method.law)
            .with("Fitted constants", method.constants.as_deref().unwrap_or("none"))
            .with("Integrator", &method.integrator)
            .with("Step", format!("{}: {}", Time.show(method.step_s), method.step_reason))
            .with("Window", format!("{}: {}", Time.show(method.window_s), method.window_reason))
    }

    fn html(&self) -> String {
        let mut html = String::from("<section id=\"repeat\">\n<h2>How to repeat it</h2>\n");
        let _ = writeln!(html, "<pre>{}</pre>\n<dl>", escape(&self.command));
        let file = (!self.text.is_empty())
            .then(|| ("File".to_owned(), format!("{}, CRC-32 {}", self.file, digest(self.text.as_bytes()))));
        for (label, value) in file.iter().chain(&self.facts) {
            let _ = writeln!(html, "<dt>{}</dt><dd>{}</dd>", escape(label), escape(value));
        }
        html.push_str("</dl>\n");
        if !self.text.is_empty() {
            let _ = writeln!(
                html,
                "<details><summary>{}</summary>\n<pre>{}</pre>\n</details>",
                escape(&self.file),
                escape_lines(&self.text)
            );
        }
        html + "</section>\n"
    }
}

/// A page.
pub struct Frame<'a> {
    /// What stands above.
    pub title: &'a str,
    /// What kind of page it is, and of what, as text.
    pub kind: &'a str,
    /// What it comes to, as HTML; it stands first.
    pub verdict: String,
    /// The pictures, the most telling first: the first three stand above the tables.
    pub figures: Vec<Figure<'a>>,
    /// Tables and words as HTML, each below its heading.
    pub sections: Vec<(&'a str, String)>,
    /// What is needed to repeat it.
    pub provenance: Provenance,
}

/// So many figures stand above the tables.
const FIRST: usize = 3;

impl Frame<'_> {
    /// As HTML that needs no network.
    pub fn html(&self) -> String {
        self.html_with("")
    }

    /// The same with a script at its end, for what answers the pointer; without script the page says all it says.
    pub fn html_with(&self, script: &str) -> String {
        let title = escape(self.title);
        let mut html = format!(
            "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{title}</title>\n<style>\n{}figure svg {{ max-height: 92vh; width: auto; }}\n@media print {{ figure svg {{ max-height: 165mm; }} }}\n</style>\n\
             </head>\n<body>\n<header>\n<h1>{title}</h1>\n<p class=\"quiet\">{}</p>\n</header>\n<main>\n{}",
            crate::page::look(),
            escape(self.kind),
            self.verdict
        );
        let (first, others) = self.figures.split_at(FIRST.min(self.figures.len()));
        html += &figures(first, 0);
        for (heading, section) in &self.sections {
            let _ = writeln!(html, "<section>\n<h2>{}</h2>\n{section}</section>", escape(heading));
        }
        if !others.is_empty() {
            let _ = writeln!(html, "<section>\n<h2>Further figures</h2>\n{}</section>", figures(others, first.len()));
        }
        let script = if script.is_empty() { String::new() } else { format!("<script>\n{script}</script>\n") };
        html + &self.provenance.html() + "</main>\n" + &script + "</body>\n</html>\n"
    }
}

fn figures(figures: &[Figure<'_>], before: usize) -> String {
    let mut html = String::new();
    for (k, Figure { file, svg, caption, numbers }) in figures.iter().enumerate() {
        let link = |file: &str| format!("<a href=\"{0}\">{0}</a>", escape(file));
        let links = std::iter::once(*file).chain(numbers.as_deref()).filter(|file| !file.is_empty()).map(link);
        let links: Vec<String> = links.collect();
        let _ = writeln!(
            html,
            "<figure>\n{svg}<figcaption><b>Figure {}.</b> {} <span class=\"quiet\">{}</span></figcaption>\n</figure>",
            before + k + 1,
            escape(caption),
            links.join(", ")
        );
    }
    html
}

/// Escaped text whose lines stay lines, for a `<pre>`.
pub(crate) fn escape_lines(text: &str) -> String {
    text.lines().map(escape).collect::<Vec<_>>().join("\n")
}

/// A table as HTML; cells are text.
pub(crate) fn table(headings: &[&str], rows: &[Vec<String>]) -> String {
    let cells = |tag: &str, cells: &mut dyn Iterator<Item = &str>| -> String {
        cells.map(|cell| format!("<{tag}>{}</{tag}>", escape(cell))).collect()
    };
    let head = cells("th", &mut headings.iter().copied());
    let rows: String =
        rows.iter().map(|row| format!("<tr>{}</tr>\n", cells("td", &mut row.iter().map(String::as_str)))).collect();
    format!("<div class=\"wide\"><table>\n<thead><tr>{head}</tr></thead>\n<tbody>\n{rows}</tbody></table></div>\n")
}

/// Words of a terminal as HTML: its tables as tables, every other line as a paragraph.
pub(crate) fn prose(text: &str) -> String {
    let mut html = String::new();
    let mut rows: Vec<Vec<String>> = Vec::new();
    for line in text.lines().chain([""]) {
        let cells = line.strip_prefix("| ").and_then(|line| line.trim_end().strip_suffix(" |"));
        match cells {
            Some(cells) => rows.push(cells.split(" | ").map(|cell| cell.trim().to_owned()).collect()),
            // The rule below the heads.
            None if line.starts_with("|---") => {}
            None => {
                if let Some((head, body)) = rows.split_first() {
                    html += &table(&head.iter().map(String::as_str).collect::<Vec<_>>(), body);
                    rows.clear();
                }
                if !line.trim().is_empty() {
                    let _ = writeln!(html, "<p>{}</p>", escape(line));
                }
            }
        }
    }
    html
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_of_a_terminal_are_tables() {
        let html = prose("first < line\n\n| a | b |\n|---|---|\n| 1 | - |\nlast\n");
        let table = table(&["a", "b"], &[vec!["1".to_owned(), "-".to_owned()]]);
        assert_eq!(html, format!("<p>first &lt; line</p>\n{table}<p>last</p>\n"));
    }
}
