//! One value of a file, read as what its key asks for.

use std::ops::{Range, RangeInclusive};

use toml::{Spanned, Value};

use super::error::{DocumentError, Source, did_you_mean, nearest};
use super::keys::{Keys, OneOrSeveral, Section, Sections, Times, Written, numbered};
use crate::units::Dimension;

/// A section that was written: its keys are asked for by name.
pub(crate) struct Scope<'a> {
    source: Source<'a>,
    name: String,
    place: Range<usize>,
}

impl<'a> Scope<'a> {
    /// What stands before the first section.
    pub fn root(source: Source<'a>) -> Self {
        Self { source, name: String::new(), place: 0..0 }
    }

    /// A section by its name and the place of its header.
    pub fn new(source: Source<'a>, name: String, place: Range<usize>) -> Self {
        Self { source, name, place }
    }

    /// The section's name, with its number where it may be repeated.
    pub fn name(&self) -> &str {
        &self.name
    }

    fn path(&self, key: &str) -> String {
        if self.name.is_empty() { key.to_owned() } else { format!("{}.{key}", self.name) }
    }

    /// A key that may be missing.
    pub fn optional(&self, key: &str, value: &'a Written) -> Option<Entry<'a>> {
        let value = value.as_ref()?;
        Some(Entry {
            source: self.source,
            key: self.path(key),
            place: value.span(),
            value: value.get_ref(),
            item: false,
        })
    }

    /// A key that must be there.
    pub fn required(&self, key: &str, value: &'a Written) -> Result<Entry<'a>, DocumentError> {
        self.optional(key, value).ok_or_else(|| {
            let example = self.source.example(&self.path(key)).unwrap_or_default();
            let place =
                if self.name.is_empty() { "before the first section".to_owned() } else { format!("to {}", self.name) };
            self.missing(key, format!("Add it {place}, like {example}."))
        })
    }

    /// Refuses keys that have no meaning where another key has the value it has: `whose` they are not, and what to do `instead`.
    pub fn forbid(&self, keys: &[(&str, &'a Written)], whose: &str, instead: &str) -> Result<(), DocumentError> {
        match keys.iter().find_map(|(key, written)| self.optional(key, written)) {
            Some(stray) => Err(stray.fail(&format!("does not belong to {whose}"), instead)),
            None => Ok(()),
        }
    }

    /// A section below this one that may be missing.
    pub fn section<T>(&self, key: &str, section: &'a Section<T>) -> Option<(Scope<'a>, &'a T)> {
        let section = section.as_ref()?;
        Some((Self::new(self.source, self.path(key), section.span()), &section.get_ref().0))
    }

    /// Repeated sections below this one, each with its number.
    pub fn sections<T>(&self, key: &str, sections: &'a Sections<T>) -> Vec<(Scope<'a>, &'a T)> {
        sections.as_deref().map_or_else(Vec::new, |sections| self.numbered(key, sections))
    }

    fn numbered<T>(&self, key: &str, sections: &'a [Spanned<Keys<T>>]) -> Vec<(Scope<'a>, &'a T)> {
        let named = |(k, section): (usize, &'a Spanned<Keys<T>>)| {
            (Self::new(self.source, numbered(&self.path(key), k), section.span()), &section.get_ref().0)
        };
        sections.iter().enumerate().map(named).collect()
    }

    /// A section below this one that must be there and may be repeated, each then with its number; `help` says how to write it.
    pub fn one_or_several<T>(
        &self,
        key: &str,
        sections: &'a OneOrSeveral<T>,
        help: &str,
    ) -> Result<Vec<(Scope<'a>, &'a T)>, DocumentError> {
        match sections.as_ref().map(|written| (written.get_ref(), written.span())) {
            Some((Times::Once(section), place)) => Ok(vec![(Self::new(self.source, self.path(key), place), section)]),
            Some((Times::Several(sections), _)) if !sections.is_empty() => Ok(self.numbered(key, sections)),
            _ => Err(self.missing(key, help.to_owned())),
        }
    }

    /// A section below this one that must be there; `help` says how to write it.
    pub fn required_section<T>(
        &self,
        key: &str,
        section: &'a Section<T>,
        help: &str,
    ) -> Result<(Scope<'a>, &'a T), DocumentError> {
        self.section(key, section).ok_or_else(|| {
            let mut error = self.missing(key, help.to_owned());
            if self.name.is_empty() {
                error.message = format!("the section [{key}] is missing.");
            }
            error
        })
    }

    fn missing(&self, key: &str, help: String) -> DocumentError {
        let path = self.path(key);
        let place = (!self.name.is_empty()).then(|| self.place.clone());
        self.source.error(place, Some(&path), format!("{path} is missing."), help)
    }

    /// A complaint about the section as a whole.
    pub fn fail(&self, message: &str, help: &str) -> DocumentError {
        self.source.error(
            Some(self.place.clone()),
            Some(&self.name),
            format!("{} {message}.", self.name),
            help.to_owned(),
        )
    }
}

/// A value with its key, or one item of such a value's list.
pub(crate) struct Entry<'a> {
    source: Source<'a>,
    key: String,
    place: Range<usize>,
    value: &'a Value,
    item: bool,
}

impl<'a> Entry<'a> {
    /// The complaint `KEY = VALUE RULE.` with what to try.
    pub fn fail(&self, rule: &str, help: &str) -> DocumentError {
        let value = self.source.written(self.place.clone());
        // In a list the item is named after the whole value.
        let value = if self.item { format!("{value}: {}", self.value) } else { value };
        self.fail_as(&value, rule, help)
    }

    /// The same with the value shown in another way.
    pub fn fail_as(&self, value: &str, rule: &str, help: &str) -> DocumentError {
        let message = format!("{} = {value} {rule}.", self.key);
        self.source.error(Some(self.place.clone()), Some(&self.key), message, help.to_owned())
    }

    /// "Write it like ..." with this key's example.
    pub fn write_it_like(&self) -> String {
        format!("Write it like {}.", self.source.example(&self.key).unwrap_or_default())
    }

    fn wrong(&self, rule: &str) -> DocumentError {
        self.fail(rule, &self.write_it_like())
    }

    pub fn text(&self) -> Result<&'a str, DocumentError> {
        self.value.as_str().ok_or_else(|| self.wrong("must be text in quotes"))
    }

    /// `true` or `false`.
    pub fn yes(&self) -> Result<bool, DocumentError> {
        self.value.as_bool().ok_or_else(|| self.wrong("must be true or false"))
    }

    /// A finite number without a unit.
    pub fn number(&self) -> Result<f64, DocumentError> {
        let number = match self.value {
            Value::Integer(whole) => *whole as f64,
            Value::Float(number) => *number,
            _ => return Err(self.wrong("must be a plain number")),
        };
        if number.is_finite() { Ok(number) } else { Err(self.wrong("is not a finite number")) }
    }

    /// A whole number within a range; one that ends at `u32::MAX` is open.
    pub fn whole(&self, range: RangeInclusive<u32>) -> Result<u32, DocumentError> {
        let (least, most) = (*range.start(), *range.end());
        let Value::Integer(whole) = *self.value else { return Err(self.wrong("must be a whole number")) };
        let whole = if most == u32::MAX { whole.min(u32::MAX.into()) } else { whole };
        u32::try_from(whole).ok().filter(|whole| range.contains(whole)).ok_or_else(|| match most {
            u32::MAX => self.wrong(&format!("must be a whole number, {least} or more")),
            _ => self.wrong(&format!("must be a whole number from {least} to {most}")),
        })
    }

    /// A whole number from 0 on, as seeds are.
    pub fn seed(&self) -> Result<u64, DocumentError> {
        let seed = self.value.as_integer().and_then(|whole| u64::try_from(whole).ok());
        seed.ok_or_else(|| self.wrong("must be a whole number, 0 or more"))
    }

    /// A number with a unit, in SI.
    pub fn quantity(&self, dimension: Dimension) -> Result<f64, DocumentError> {
        let text = self.unit_text(&units(dimension))?;
        dimension.parse(text).map_err(|error| self.misread(&error.to_string(), &units(dimension)))
    }

    /// A quantity above zero, in SI.
    pub fn positive(&self, dimension: Dimension) -> Result<f64, DocumentError> {
        let value = self.quantity(dimension)?;
        if value > 0.0 { Ok(value) } else { Err(self.wrong("must be more than zero")) }
    }

    /// A length in metres, written with its unit or in sphere diameters: `"2.5 D"`.
    pub fn length(&self, diameter: f64) -> Result<f64, DocumentError> {
        let units = units(Dimension::Length).replacen("(units: ", "(units: D for sphere diameters, ", 1);
        let text = self.unit_text(&units)?;
        let Some(number) = text.trim().strip_suffix('D') else {
            return Dimension::Length.parse(text).map_err(|error| self.misread(&error.to_string(), &units));
        };
        match number.trim().replace('_', "").parse::<f64>() {
            Ok(number) if (number * diameter).is_finite() => Ok(number * diameter),
            Ok(_) => Err(self.fail("is not finite", &self.with_units(&units))),
            Err(_) => Err(self.fail("is not a number with a unit", &self.with_units(&units))),
        }
    }

    /// The text of a quantity; a bare number is told that it lacks a unit.
    fn unit_text(&self, units: &str) -> Result<&'a str, DocumentError> {
        let rule = match self.value {
            Value::String(text) => return Ok(text),
            Value::Float(number) if !number.is_finite() => "is not a finite number",
            Value::Integer(_) | Value::Float(_) => "has no unit",
            _ => "must be a number with its unit, in quotes",
        };
        Err(self.fail(rule, &self.with_units(units)))
    }

    /// A complaint of `units`, which begins with the value in quotes.
    fn misread(&self, complaint: &str, units: &str) -> DocumentError {
        let fault = complaint.rsplit_once("; write it like").map_or(complaint, |(fault, _)| fault);
        let quoted = self.value.as_str().map_or(0, |text| text.trim().len() + 2);
        let rule = fault.get(quoted..).unwrap_or(fault).trim_start_matches(':').trim();
        let rule = if rule.starts_with("unknown unit") { format!("has the {rule}") } else { rule.to_owned() };
        self.fail(&rule, &self.with_units(units))
    }

    fn with_units(&self, units: &str) -> String {
        format!("Write it like {} {units}.", self.source.example(&self.key).unwrap_or_default())
    }

    /// One of a few names.
    pub fn choice<T: Copy>(&self, what: &str, known: &[(&str, T)]) -> Result<T, DocumentError> {
        let name = self.text()?;
        if let Some((_, choice)) = known.iter().find(|(known, _)| *known == name) {
            return Ok(*choice);
        }
        let names: Vec<String> = known.iter().map(|(name, _)| format!("\"{name}\"")).collect();
        let near = nearest(name, known.iter().map(|(name, _)| *name)).map(|near| format!("\"{near}\""));
        let list = match &names[..] {
            [only] => format!("The only one so far is {only}."),
            _ => format!("Known are {}.", names.join(", ")),
        };
        Err(self.fail(&format!("is no known {what}"), &format!("{}{list}", did_you_mean(near.as_deref()))))
    }

    /// The items of a list.
    pub fn items(&self) -> Result<Vec<Entry<'a>>, DocumentError> {
        let items = self.value.as_array().ok_or_else(|| self.wrong("must be a list"))?;
        let item =
            |value| Entry { source: self.source, key: self.key.clone(), place: self.place.clone(), value, item: true };
        Ok(items.iter().map(item).collect())
    }

    /// The values of a table by their keys.
    pub fn fields(&self) -> Result<Vec<(String, Entry<'a>)>, DocumentError> {
        let table = self.value.as_table().ok_or_else(|| self.wrong("must be a table of names and values"))?;
        let field = |(name, value): (&String, &'a Value)| {
            let key = format!("{}.{name}", self.key);
            (name.clone(), Entry { source: self.source, key, place: self.place.clone(), value, item: true })
        };
        Ok(table.iter().map(field).collect())
    }

    /// The items of a list; a value that is no list counts as a list of it alone.
    pub fn one_or_more(&self) -> Vec<Entry<'a>> {
        let item =
            |value, item| Entry { source: self.source, key: self.key.clone(), place: self.place.clone(), value, item };
        match self.value {
            Value::Array(values) => values.iter().map(|value| item(value, true)).collect(),
            value => vec![item(value, self.item)],
        }
    }

    /// Whether it is a list.
    pub fn is_list(&self) -> bool {
        self.value.is_array()
    }

    /// A complaint with how the key is written.
    pub fn refuse(&self, rule: &str) -> DocumentError {
        self.wrong(rule)
    }

    /// A file beside this one.
    pub fn path(&self) -> Result<std::path::PathBuf, DocumentError> {
        let path = self.source.path.parent().unwrap_or(std::path::Path::new("")).join(self.text()?);
        if path.is_file() { Ok(path) } else { Err(self.fail("is no file", "It is looked for beside this file.")) }
    }

    /// The two items of a list `[first, last]`.
    pub fn pair(&self) -> Result<[Entry<'a>; 2], DocumentError> {
        let items = self.value.as_array().map(Vec::as_slice);
        let Some([first, last]) = items else {
            return Err(self.wrong("must be a list of two, the first and the last"));
        };
        Ok([first, last].map(|value| Entry {
            source: self.source,
            key: self.key.clone(),
            place: self.place.clone(),
            value,
            item: true,
        }))
    }

    /// A list of two as it is spoken of, without quotes: `0 D to 2.5 D`.
    pub fn range_text(&self) -> String {
        let item = |value: &Value| value.as_str().map_or_else(|| value.to_string(), str::to_owned);
        let items = self.value.as_array().map_or(&[][..], Vec::as_slice);
        items.iter().map(item).collect::<Vec<_>>().join(" to ")
    }
}

/// The known units of a dimension, as its own messages list them: `(units: kN, N, mN, MN)`.
fn units(dimension: Dimension) -> String {
    let refusal = dimension.parse("").map_or_else(|error| error.to_string(), |_| String::new());
    refusal.find("(units:").map_or(String::new(), |at| refusal[at..].to_owned())
}

/// Whether a name can stand in file names and in tables: letters, digits, `-` and `_`.
pub(crate) fn is_plain_name(name: &str) -> bool {
    (1..=100).contains(&name.len())
        && name.bytes().all(|byte| byte.is_ascii_alphanumeric() || matches!(byte, b'-' | b'_'))
}

/// The place of a section's name, for complaints about the name itself.
pub(crate) fn name_error(
    source: Source,
    name: &Spanned<String>,
    section: &str,
    rule: &str,
    help: &str,
) -> DocumentError {
    let key = format!("{section}.{}", name.get_ref());
    let message = format!("{section}.{} {rule}.", source.written(name.span()));
    source.error(Some(name.span()), Some(&key), message, help.to_owned())
}
