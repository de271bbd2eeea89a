//! What kind of file a text is, so that one of another kind hears what it is and which command takes it.

use super::error::{DocumentError, Source};

/// Files that granulens reads or writes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Design,
    Rig,
    Bed,
    Study,
    Tolerances,
    Layout,
    Journal,
    Results,
}

impl Kind {
    /// With its article, and who takes it.
    fn words(self) -> (&'static str, &'static str) {
        match self {
            Self::Design => {
                ("a lens design", "granulens run, design, trace, compare, simulate, export and bench take designs.")
            }
            Self::Rig => ("a rig", "granulens simulate and export take rigs."),
            Self::Bed => ("a granular bed", "granulens impact takes beds."),
            Self::Study => ("a study", "granulens study run, show and export take studies."),
            Self::Tolerances => {
                ("a file of tolerances", "granulens tolerance LAYOUT --design DESIGN.toml --tolerances FILE takes it.")
            }
            Self::Layout => (
                "a layout",
                "granulens check LAYOUT --design DESIGN.toml takes it, and granulens compare DESIGN.toml LAYOUT.",
            ),
            Self::Journal => ("the journal of a study", "granulens study show STUDY.toml tells what it holds."),
            Self::Results => ("a file of JSON", "Files that say what to do are TOML; results are JSON."),
        }
    }

    /// Of a text, as far as its outlines tell.
    fn of(text: &str) -> Option<Self> {
        let Ok(table) = text.parse::<toml::Table>() else {
            let begins = |line: &str| {
                let line = line.replace(' ', "");
                line.starts_with("row,column,x,z,diameter,material")
                    || line.starts_with("layer,column,x,y,z,diameter,material")
            };
            return match text.trim_start() {
                json if json.starts_with("{\"journal\"") => Some(Self::Journal),
                json if json.starts_with('{') && json.contains("\"spheres\"") && json.contains("\"row\"") => {
                    Some(Self::Layout)
                }
                json if json.starts_with('{') => Some(Self::Results),
                _ if text.lines().take(20).any(begins) => Some(Self::Layout),
                _ => None,
            };
        };
        let holds = |key: &str| table.contains_key(key);
        let is_table = |key: &str| table.get(key).is_some_and(toml::Value::is_table);
        match table.get("kind").and_then(toml::Value::as_str) {
            Some("rig") => Some(Self::Rig),
            Some("bed") => Some(Self::Bed),
            Some(_) => None,
            None if holds("design") && (holds("objective") || holds("materials")) => Some(Self::Study),
            None if is_table("bed") && is_table("intruder") => Some(Self::Bed),
            None if !is_table("crystal") && (is_table("diameter") || is_table("piece") || is_table("material")) => {
                Some(Self::Tolerances)
            }
            None if is_table("crystal") && (is_table("target") || is_table("impact")) => Some(Self::Design),
            None => None,
        }
    }
}

/// Refuses a text that is plainly of another kind than the one that is read.
pub(crate) fn expect(source: Source, wanted: Kind) -> Result<(), DocumentError> {
    match Kind::of(source.text) {
        Some(found) if found != wanted => {
            let ((is, taken), (wants, _)) = (found.words(), wanted.words());
            Err(DocumentError::of_file(source.path, format!("is {is}, and {wants} is wanted."), taken.to_owned()))
        }
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_shipped_file_is_of_its_kind() {
        let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
        let mut seen = [0; 4];
        for folder in ["designs", "designs/gallery", "studies"] {
            for path in std::fs::read_dir(root.join(folder)).unwrap().map(|entry| entry.unwrap().path()) {
                let Ok(text) = std::fs::read_to_string(&path) else { continue };
                let kind = Kind::of(&text);
                if path.extension().is_some_and(|extension| extension == "csv") {
                    let is_layout = text.contains("row,column,x,z,diameter,material");
                    assert_eq!(kind == Some(Kind::Layout), is_layout, "{}", path.display());
                    continue;
                }
                let own = [Kind::Design, Kind::Rig, Kind::Bed, Kind::Study];
                let place =
                    own.iter().position(|known| kind == Some(*known)).unwrap_or_else(|| panic!("{}", path.display()));
                assert_eq!(place == 3, folder == "studies", "{}", path.display());
                seen[place] += 1;
                for wanted in own {
                    let refused = expect(Source { path: &path, text: &text, examples: &[] }, wanted);
                    assert_eq!(refused.is_ok(), kind == Some(wanted));
                }
            }
        }
        assert!(seen.iter().all(|&count| count > 0), "{seen:?}");
    }
}
