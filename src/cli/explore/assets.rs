//! What the page is made of: files inside the program.

use granulens::page;

use super::server::Answer;

const SCRIPT: &str = "text/javascript; charset=utf-8";

/// The modules of the page.
const MODULES: [(&str, &str); 17] = [
    ("app.js", include_str!("page/app.js")),
    ("ask.js", include_str!("page/ask.js")),
    ("chart.js", include_str!("page/chart.js")),
    ("controls.js", include_str!("page/controls.js")),
    ("crystal.js", include_str!("page/crystal.js")),
    ("design.js", include_str!("page/design.js")),
    ("numbers.js", include_str!("page/numbers.js")),
    ("paint.js", include_str!("page/paint.js")),
    ("play.js", include_str!("page/play.js")),
    ("profile.js", include_str!("page/profile.js")),
    ("rank.js", include_str!("page/rank.js")),
    ("save.js", include_str!("page/save.js")),
    ("slow.js", include_str!("page/slow.js")),
    ("state.js", include_str!("page/state.js")),
    ("study.js", include_str!("page/study.js")),
    ("surface.js", include_str!("page/surface.js")),
    ("words.js", include_str!("page/words.js")),
];

/// A file of the page.
pub fn find(path: &str) -> Option<Answer> {
    match path {
        "" => Some(Answer::file("text/html; charset=utf-8", include_str!("page/index.html"))),
        "look.css" => Some(Answer::file("text/css; charset=utf-8", page::look())),
        "explore.css" => Some(Answer::file("text/css; charset=utf-8", include_str!("page/explore.css"))),
        "surface-of.js" => Some(Answer::file(SCRIPT, format!("{}export {{ surfaceOf }};\n", page::SURFACE))),
        "icon.svg" => Some(Answer::file("image/svg+xml", include_str!("page/icon.svg"))),
        _ => MODULES.iter().find(|(name, _)| *name == path).map(|&(_, text)| Answer::file(SCRIPT, text)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whatever a module or the page asks for is there, and nothing lies elsewhere.
    #[test]
    fn the_page_finds_all_that_it_asks_for() {
        let page = include_str!("page/index.html");
        let texts = MODULES.iter().map(|(_, text)| *text).chain([page, include_str!("page/explore.css")]);
        for text in texts {
            assert!(!text.contains("https://") && !text.contains("url("), "a foreign request");
            let named = text.split(['"', '\'']).skip(1).step_by(2).filter(|quoted| quoted.starts_with("./"));
            for name in named.map(|name| &name[2..]).filter(|name| !name.starts_with("api/")) {
                assert!(find(name).is_some(), "{name}");
            }
        }
        assert!(find("../Cargo.toml").is_none() && find("app.js/").is_none());
    }
}
