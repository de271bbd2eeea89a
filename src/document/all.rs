//! All that is wrong with a file, told at once.
//!
//! A check stops at the first fault, since what follows may hang on it. To find the others the faulty value is exchanged for one that
//! could have been meant, and the check is made again; several values are tried side by side (the name that is most like it, the key left
//! out, its example, a quarter and four times the example). What all of them come upon next is no consequence of the exchange, and is told
//! too; where they differ, or a fault is not that of a single value, the search ends.

use std::ops::Range;

use toml::de::{DeTable, DeValue};

use super::error::{DocumentError, Source};

/// More faults than these are not looked for.
const MOST: usize = 20;

/// Checks a text; on failure the error holds the other faults too.
pub(crate) fn all<T>(source: Source<'_>, check: impl Fn(&str) -> Result<T, DocumentError>) -> Result<T, DocumentError> {
    check(source.text).map_err(|first| {
        let others = others(source, &first, &|text| check(text).err());
        first.with_others(others)
    })
}

/// A text with values exchanged.
#[derive(Clone)]
struct World {
    text: String,
    /// What was exchanged, in the order in which it was: from where on, bytes before, bytes after.
    edits: Vec<[usize; 3]>,
    /// Sections that were missing and have been put in: what is missing in them is no fault of its own.
    put_in: Vec<String>,
}

impl World {
    fn exchange(&mut self, place: Range<usize>, by: &str) {
        self.edits.push([place.start, place.len(), by.len()]);
        self.text.replace_range(place, by);
    }

    /// Where a place of this text stands in the original.
    fn original(&self, place: Range<usize>) -> Range<usize> {
        let back = |at: usize| {
            self.edits.iter().rev().fold(at, |at, &[start, before, after]| match at {
                at if at < start => at,
                at if at >= start + after => at - after + before,
                _ => start,
            })
        };
        back(place.start)..back(place.end)
    }
}

/// What may stand in the place of a faulty value, from the most likely on.
const WAYS: [Way; 4] = [Way::Leave, Way::Example(1.0), Way::Example(4.0), Way::Example(0.25)];

#[derive(Clone, Copy)]
enum Way {
    Leave,
    Example(f64),
}

/// What else is wrong with a text beside the first fault; `check` says the first of any text.
pub(crate) fn others(
    source: Source<'_>,
    first: &DocumentError,
    check: &dyn Fn(&str) -> Option<DocumentError>,
) -> Vec<DocumentError> {
    // What a file of another kind or format says is not for this reader.
    if matches!(first.key.as_deref(), Some("kind" | "format")) {
        return Vec::new();
    }
    let untouched = World { text: source.text.to_owned(), edits: Vec::new(), put_in: Vec::new() };
    let mut worlds = vec![untouched; WAYS.len()];
    let mut told: Vec<DocumentError> = Vec::new();
    for _ in 0..MOST {
        let fault = told.last().unwrap_or(first);
        let next: Vec<(World, Option<DocumentError>)> =
            worlds.iter().zip(WAYS).filter_map(|(world, way)| exchanged(source, world, way, fault, check)).collect();
        let Some((_, found)) = next.first() else { break };
        let same = |other: &Option<DocumentError>| match (found, other) {
            (Some(a), Some(b)) => (&a.key, &a.message) == (&b.key, &b.message),
            _ => false,
        };
        if !next.iter().all(|(_, other)| same(other)) {
            break;
        }
        let Some((world, Some(found))) = next.first() else { break };
        if std::iter::once(first).chain(&told).any(|known| known.key == found.key) {
            break;
        }
        // The same fault in the original text.
        let place = found.place().map(|place| world.original(place));
        told.push(source.error(place, found.key.as_deref(), found.message.clone(), found.help.clone()));
        worlds = (0..WAYS.len()).map(|k| next[k.min(next.len() - 1)].0.clone()).collect();
    }
    told
}

/// A world in which a fault is no more, and the next one there; none if it cannot be mended by exchanging a value.
fn exchanged(
    source: Source<'_>,
    world: &World,
    way: Way,
    fault: &DocumentError,
    check: &dyn Fn(&str) -> Option<DocumentError>,
) -> Option<(World, Option<DocumentError>)> {
    let mut world = world.clone();
    let mut fault_key = fault.key.clone()?;
    let mut help = format!("{} {}", fault.message, fault.help);
    // What is missing in a section that was put in comes with it.
    for _ in 0..MOST {
        let ways = [Way::Example(f64::NAN), way, Way::Example(1.0)];
        let (mended, next) = ways.into_iter().find_map(|way| {
            let mended = mend(source, &world, way, &fault_key, &help)?;
            let next = check(&mended.text);
            let again = next.as_ref().is_some_and(|next| {
                // Neither the same key again, nor text that is no TOML any more.
                next.key.as_ref().is_none_or(|key| *key == fault_key)
            });
            (!again).then_some((mended, next))
        })?;
        world = mended;
        match &next {
            Some(error) => {
                let key = error.key.clone()?;
                let inside = |section: &String| key.strip_prefix(section).is_some_and(|rest| rest.starts_with('.'));
                if !world.put_in.iter().any(inside) {
                    return Some((world, next));
                }
                help = format!("{} {}", error.message, error.help);
                fault_key = key;
            }
            None => return Some((world, None)),
        }
    }
    None
}

/// Exchanges the value of a key, puts in the key or its section where it is missing, or takes out what is not known. An example of no
/// size stands for the name that is said to be most like.
fn mend(source: Source<'_>, world: &World, way: Way, key: &str, help: &str) -> Option<World> {
    let mut world = world.clone();
    let suggested = || {
        let (_, rest) = help.split_once("id you mean ")?;
        let name: String = rest.trim_start_matches(['"', '[']).chars().take_while(|c| !"\"]?)".contains(*c)).collect();
        Some(name)
    };
    let example = source.example(key).and_then(|line| Some(line.split_once(" = ")?.1.to_owned()));
    let table = DeTable::parse(&world.text).ok()?;
    let Some((name, value, is_section)) = locate(table.get_ref(), key) else {
        let (section, last) = key.rsplit_once('.').unwrap_or(("", key));
        let line = |size: f64| Some(format!("{last} = {}\n", scaled(example.as_deref()?, size)?));
        let at = match section {
            "" => 0,
            _ => {
                let (name, ..) = locate(table.get_ref(), section)?;
                name.start + world.text[name.start..].find('\n')? + 1
            }
        };
        match (way, &example) {
            (Way::Example(size), Some(_)) if !size.is_nan() => world.exchange(at..at, &line(size)?),
            (Way::Example(1.0), None) if section.is_empty() => {
                let end = world.text.len();
                world.exchange(end..end, &format!("\n[{key}]\n"));
                world.put_in.push(key.to_owned());
            }
            _ => return None,
        }
        return Some(world);
    };
    // Keys in braces are a value like others.
    let is_section = is_section && !world.text[value.clone()].starts_with('{');
    let is_unknown =
        help.contains("no known key") || help.contains("no known section") || help.contains("unknown field");
    match way {
        Way::Example(size) if size.is_nan() => {
            let name_of = suggested()?;
            if is_unknown {
                // Not beside a key of this name.
                let (section, _) = key.rsplit_once('.').unwrap_or(("", key));
                let path = if section.is_empty() { name_of.clone() } else { format!("{section}.{name_of}") };
                if locate(table.get_ref(), &path).is_some() {
                    return None;
                }
                world.exchange(name, &name_of);
            } else {
                let written = world.text[value.clone()].to_owned();
                // Of a list the item that is not known is not told: only a single name is exchanged.
                if !written.starts_with(['"', '\'']) {
                    return None;
                }
                world.exchange(value, &format!("\"{name_of}\""));
            }
        }
        _ if is_section => return None,
        Way::Leave => {
            let place = with_comma(&world.text, name.start..value.end);
            let blank: String = world.text[place.clone()].chars().filter(|c| *c == '\n').collect();
            world.exchange(place, &blank);
        }
        Way::Example(_) if is_unknown => return mend(source, &world, Way::Leave, key, help),
        Way::Example(size) => {
            let by = scaled(&example?, size)?;
            world.exchange(value, &by);
        }
    }
    Some(world)
}

/// Within braces a key goes with one of the commas beside it.
fn with_comma(text: &str, place: Range<usize>) -> Range<usize> {
    let after = text[place.end..].find(|c: char| c != ' ').map(|skip| place.end + skip);
    if let Some(at) = after.filter(|&at| text[at..].starts_with(',')) {
        return place.start..at + 1;
    }
    let before = text[..place.start].trim_end_matches(' ');
    if before.ends_with(',') { before.len() - 1..place.end } else { place }
}

/// Where a key, with its sections and their numbers, and its value stand, and whether it is a section.
fn locate(table: &DeTable<'_>, key: &str) -> Option<(Range<usize>, Range<usize>, bool)> {
    let (part, rest) = match key.split_once('.') {
        Some((part, rest)) => (part, Some(rest)),
        None => (key, None),
    };
    let (plain, number) = match part.strip_suffix(']').and_then(|part| part.split_once('[')) {
        Some((plain, number)) => (plain, number.parse::<usize>().ok()?.checked_sub(1)),
        None => (part, None),
    };
    let (name, value) = table.iter().find(|(name, _)| name.get_ref().as_ref() == plain)?;
    let (place, value) = match (value.get_ref(), number) {
        (DeValue::Array(items), Some(k)) => {
            let item = items.get(k)?;
            (item.span(), item)
        }
        _ => (name.span(), value),
    };
    match (value.get_ref(), rest) {
        (DeValue::Table(inner), Some(rest)) => locate(inner, rest),
        // A name with dots, in quotes, is not looked for.
        (_, Some(_)) => None,
        (DeValue::Table(_), None) => Some((place, value.span(), true)),
        (_, None) => Some((place, value.span(), false)),
    }
}

/// An example with its numbers so many times as great; whole ones stay whole.
fn scaled(example: &str, size: f64) -> Option<String> {
    if size.is_nan() || !example.contains(|c: char| c.is_ascii_digit()) {
        return (!size.is_nan()).then(|| example.to_owned());
    }
    let mut text = String::new();
    let mut rest = example;
    while let Some(at) = rest.find(|c: char| c.is_ascii_digit()) {
        let (before, number) = rest.split_at(at);
        let end = number.find(|c: char| !(c.is_ascii_digit() || c == '.')).unwrap_or(number.len());
        let (digits, behind) = number.split_at(end);
        let of_a_name = before.ends_with(|c: char| c.is_ascii_alphabetic() || c == '-' || c == '_' || c == '/');
        text += before;
        text += &match digits.parse::<f64>() {
            Ok(value) if !of_a_name && digits.contains('.') => format!("{:?}", value * size),
            Ok(value) if !of_a_name => format!("{}", (value * size).round().max(1.0)),
            _ => digits.to_owned(),
        };
        rest = behind;
    }
    Some(text + rest)
}

#[cfg(test)]
mod tests {
    use crate::design::Design;
    use crate::setup::Setup;

    fn faults<T>(read: Result<T, super::DocumentError>) -> Vec<String> {
        let error = read.err().unwrap();
        std::iter::once(error.to_string()).chain(error.others().iter().map(ToString::to_string)).collect()
    }

    const DESIGN: &str = r#"format = 1
name = "faulty lens"
[crystal]
packing = "hexagonal-2d"
diameter = "6.35 mn"
rows = 12
half_with = 4.5
sides = "mirror"
host = "stainles-440c"
[impact]
kind = "force-pulse"
force = "16 kN"
[target]
focus = { rows = [8, 10], x = ["0 D", "1 D"] }
protect = { rows = [8, 10], x = ["3 D", "4.5 D"] }
[run]
window = "-100 us"
"#;

    /// Each of the six is told once, where it stands, and nothing else is.
    #[test]
    fn all_faults_of_a_design_are_told() {
        let found = faults(Design::parse("d.toml", DESIGN));
        let expected = [
            "d.toml:7: crystal.half_with is no known key.",
            "d.toml:2: name = \"faulty lens\" must be 1 to 100 letters (a to z), digits, - and _.",
            "d.toml:5: crystal.diameter = \"6.35 mn\" has the unknown unit \"mn\".",
            "d.toml:9: crystal.host = \"stainles-440c\" is no known material.",
            "d.toml:10: impact.duration is missing.",
            "d.toml:17: run.window = \"-100 us\" must be more than zero.",
        ];
        assert_eq!(found, expected);
    }

    /// What only follows from a value that had to be guessed is not told: the focal rows lie beyond some of the numbers of rows that
    /// could have been meant, not beyond all.
    #[test]
    fn what_a_guess_would_cause_is_not_told() {
        let text = DESIGN
            .replace("faulty lens", "lens")
            .replace("mn", "mm")
            .replace("half_with", "half_width")
            .replace("stainles-", "stainless-")
            .replace("force = ", "duration = \"20 us\"\nforce = ")
            .replace("rows = 12", "rows = \"twelve\"")
            .replace("[8, 10]", "[100, 110]");
        let found = faults(Design::parse("d.toml", &text));
        assert_eq!(found, ["d.toml:6: crystal.rows = \"twelve\" must be a whole number."]);
    }

    #[test]
    fn all_faults_of_a_rig_are_told() {
        let text = "format = 1\nkind = \"rig\"\nname = \"r\"\n[crystal]\npacking = \"hexagonal\"\ndiameter = \"8\"\nlayers = 5\n\
                    material = \"440c\"\nx = [\"0 D\", \"3 D\"]\n[[pattern]]\nkind = \"uniform\"\nmaterials = [\"brass\"]\nlayers = 1\n\
                    [[pattern]]\nkind = \"unifrom\"\nmaterials = [\"brass\"]\n[[load]]\nkind = \"force\"\nlayers = 1\n\
                    pulse = \"square\"\npeak = 5\nduration = \"20 us\"\n[run]\nwindow = \"20 us\"\naccuracy = \"7 %\"\n";
        let found = faults(Setup::parse("r.toml", text));
        let lines: Vec<&str> = found.iter().map(|fault| fault.split(' ').next().unwrap()).collect();
        assert_eq!(lines, ["r.toml:6:", "r.toml:15:", "r.toml:21:", "r.toml:25:"], "{found:#?}");
    }
}
