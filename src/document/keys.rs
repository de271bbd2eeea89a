//! A file as written: which keys there are and where each value stands, nothing about their meaning.
//!
//! Every key is optional here and every value may be anything, so that what is missing or of the wrong type is reported
//! by the check, in the same words as everything else. Only unknown keys and values in the place of sections are found here.

use std::fmt;
use std::marker::PhantomData;
use std::ops::Range;

use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{Deserialize, Deserializer, MapAccess, SeqAccess, Visitor};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::error::{DocumentError, Source, did_you_mean, nearest};

/// A value and where it stands, if it was written.
pub(crate) type Written = Option<Spanned<toml::Value>>;
/// A section (or inline table) and where its header stands, if it was written.
pub(crate) type Section<T> = Option<Spanned<Keys<T>>>;
/// Sections that may be repeated, `[[pattern]]`, in the order of the file.
pub(crate) type Sections<T> = Option<Vec<Spanned<Keys<T>>>>;

/// A section that is written once, `[target.focus]`, or several times, `[[target.focus]]`.
pub(crate) type OneOrSeveral<T> = Option<Spanned<Times<T>>>;

/// How often a section is written.
pub(crate) enum Times<T> {
    Once(T),
    Several(Vec<Spanned<Keys<T>>>),
}

/// Declares the keys of a section.
macro_rules! section {
    ($name:ident: $type:ty { $($(#[$attribute:meta])* $key:ident),* $(,)? }) => {
        #[derive(serde::Deserialize)]
        #[serde(deny_unknown_fields)]
        pub(crate) struct $name { $($(#[$attribute])* pub $key: $type),* }
        impl $name {
            #[cfg(test)]
            pub const KEYS: &[&str] = &[$(stringify!($key)),*];
        }
    };
}
pub(crate) use section;

/// The name of the k-th of repeated sections, counted from 1: `pattern[2]`.
pub(crate) fn numbered(key: &str, index: usize) -> String {
    format!("{key}[{}]", index + 1)
}

/// The key without the numbers of repeated sections.
fn unnumbered(key: &str) -> String {
    key.split('[').map(|part| part.split_once(']').map_or(part, |(_, rest)| rest)).collect()
}

/// Two lists of examples as one, for files that share sections.
pub(crate) const fn joined<const N: usize>(
    first: &'static [&'static str],
    second: &'static [&'static str],
) -> [&'static str; N] {
    let mut all = [""; N];
    let mut k = 0;
    while k < N {
        all[k] = if k < first.len() { first[k] } else { second[k - first.len()] };
        k += 1;
    }
    all
}

/// How a key, given with its sections, is written below the header of its section.
pub(crate) fn example(examples: &[&str], key: &str) -> Option<String> {
    let key = &unnumbered(key);
    let pattern = match key.strip_prefix("materials.").and_then(|rest| rest.rsplit_once('.')) {
        Some((_, property)) => format!("materials.*.{property}"),
        None => key.to_owned(),
    };
    // The bounds of a threshold are shown with their braces.
    let pattern = match pattern.strip_suffix(".min").or(pattern.strip_suffix(".max")) {
        Some(threshold) => threshold.to_owned(),
        None => pattern,
    };
    let section = pattern.rfind('.').map_or(0, |dot| dot + 1);
    // Keys that several sections share are listed once.
    let shared = format!("*.{}", &pattern[section..]);
    let lines = || examples.iter().chain(super::own::EXAMPLES);
    let listed = |key: &str| lines().find(|line| line.split(" = ").next() == Some(key));
    match listed(&pattern) {
        Some(line) => Some(line[section..].to_owned()),
        None => listed(&shared).map(|line| line[2..].to_owned()),
    }
}

/// Asserts that every key of the sections has an example, and that this is TOML: messages rely on it.
#[cfg(test)]
pub(crate) fn assert_examples(examples: &[&str], sections: &[(&str, &[&str])]) {
    for (section, keys) in sections {
        for key in *keys {
            let key = key.trim_start_matches("r#");
            let example = example(examples, &format!("{section}.{key}")).expect(key);
            DeTable::parse(&example).expect(&example);
        }
    }
}

/// The keys of a section: reads only from a table, where a derived reader would also take a list.
pub(crate) struct Keys<T>(pub T);

const NOT_A_TABLE: &str = "a section with keys";
/// What the reader expects of repeated sections.
const NOT_A_LIST: &str = "a sequence";

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Keys<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct TableOnly<T>(PhantomData<T>);
        impl<'de, T: Deserialize<'de>> Visitor<'de> for TableOnly<T> {
            type Value = T;
            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str(NOT_A_TABLE)
            }
            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<T, A::Error> {
                T::deserialize(MapAccessDeserializer::new(map))
            }
        }
        deserializer.deserialize_map(TableOnly(PhantomData)).map(Keys)
    }
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Times<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Either<T>(PhantomData<T>);
        impl<'de, T: Deserialize<'de>> Visitor<'de> for Either<T> {
            type Value = Times<T>;
            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str(NOT_A_TABLE)
            }
            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Times<T>, A::Error> {
                T::deserialize(MapAccessDeserializer::new(map)).map(Times::Once)
            }
            fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<Times<T>, A::Error> {
                Vec::deserialize(SeqAccessDeserializer::new(list)).map(Times::Several)
            }
        }
        deserializer.deserialize_any(Either(PhantomData))
    }
}

/// Reads the keys of `T` from a parsed text; unknown ones are refused if `T` does so.
pub(crate) fn read<'a, T: Deserialize<'a>>(
    source: Source<'a>,
    root: &Spanned<DeTable<'a>>,
) -> Result<T, DocumentError> {
    T::deserialize(toml::Deserializer::from(root.clone())).map_err(|error| {
        let place = error.span().unwrap_or(0..0);
        let found = find(root.get_ref(), &place, "");
        let key = found.as_ref().map_or(String::new(), |(key, _)| key.clone());
        let is_table = found.is_some_and(|(_, is_table)| is_table);
        let (section, name) = key.rsplit_once('.').unwrap_or(("", &key));
        let (what, expected) = error.message().rsplit_once("expected ").unwrap_or((error.message(), ""));
        let (message, help) = if what.starts_with("unknown field") {
            // What follows lists the known keys between backticks.
            unknown_key(source, section, name, is_table, expected.split('`').skip(1).step_by(2).collect())
        } else if expected.starts_with(NOT_A_LIST) {
            (format!("{key} must be a section that can be repeated."), format!("Write it as [[{key}]]."))
        } else if expected.starts_with(NOT_A_TABLE) {
            not_a_section(source, &key, &source.written(place.clone()))
        } else {
            // Of what TOML can hold, only whole numbers beyond 64 bits reach this.
            let help = source.example(&key).map_or(String::new(), |example| format!("Write it like {example}."));
            (format!("{key} = {} is out of range.", source.written(place.clone())), help)
        };
        source.error(Some(place), Some(&key), message, help)
    })
}

fn unknown_key(source: Source, section: &str, name: &str, is_table: bool, known: Vec<&str>) -> (String, String) {
    if !section.is_empty() {
        let near = did_you_mean(nearest(name, known.iter().copied()));
        return (
            format!("{section}.{name} is no known key."),
            format!("{near}Known in {section} are {}.", known.join(", ")),
        );
    }
    let (keys, sections): (Vec<&str>, Vec<&str>) = known.into_iter().partition(|key| source.example(key).is_some());
    if is_table {
        let sections: Vec<String> = sections.iter().map(|section| format!("[{section}]")).collect();
        let near = did_you_mean(nearest(&format!("[{name}]"), sections.iter().map(String::as_str)));
        (format!("[{name}] is no known section."), format!("{near}Known are {}.", sections.join(", ")))
    } else {
        let near = did_you_mean(nearest(name, keys.iter().copied()));
        let (last, before) = keys.split_last().map_or((&"", &[][..]), |(last, before)| (last, before));
        let help = format!("{near}Only {} and {last} stand before the first section.", before.join(", "));
        (format!("{name} is no known key."), help)
    }
}

fn not_a_section(source: Source, key: &str, written: &str) -> (String, String) {
    if let Some(example) = source.example(key) {
        return (format!("{key} = {written} must be keys in braces."), format!("Write it like {example}."));
    }
    let help = match key.strip_prefix("materials.") {
        Some(_) => {
            "Below [materials] stand only sections, each named after a material, like [materials.my-steel].".to_owned()
        }
        None => format!("Write [{key}] on a line of its own and its keys below."),
    };
    let shown = if written.starts_with("[[") { written.to_owned() } else { format!("{key} = {written}") };
    (format!("{shown} must be a section."), help)
}

/// The key (with its sections) that stands, or whose value stands, at `place`, and whether it is a section.
pub(super) fn find(table: &DeTable, place: &Range<usize>, above: &str) -> Option<(String, bool)> {
    table.iter().find_map(|(name, value)| {
        let key = if above.is_empty() { name.get_ref().to_string() } else { format!("{above}.{}", name.get_ref()) };
        let (inside, is_table) = match value.get_ref() {
            DeValue::Table(inner) => (find(inner, place, &key), true),
            DeValue::Array(items) => {
                let inside = items.iter().enumerate().find_map(|(k, item)| match item.get_ref() {
                    DeValue::Table(inner) => find(inner, place, &numbered(&key, k)),
                    _ => None,
                });
                (inside, items.iter().any(|item| matches!(item.get_ref(), DeValue::Table(_))))
            }
            _ => (None, false),
        };
        let here = [name.span(), value.span()].iter().any(|span| span.contains(&place.start));
        inside.or(here.then_some((key, is_table)))
    })
}
