//! A design under somebody's hands: its text, changes to it, and what rays say of it.
//!
//! The text of the design file is the design: what controls and drags change are its keys, and everything else, comments among it,
//! stays as it is. So what the page shows is what the command line makes of that text.

use std::time::Instant;

use granulens::design::Design;
use granulens::evaluate::{proposal, trace_fronts};
use granulens::layout::Layout;
use granulens::lens::{Family, Lens, Quantity};
use granulens::material::{Material, aliases, library};
use granulens::page;
use granulens::report;
use granulens::target::Region;
use serde::Deserialize;
use serde_json::{Map, Value, json};
use toml_edit::{DocumentMut, Item, TableLike};

use super::Opened;
use super::server::Shared;
use crate::cli::failure::Failure;
use crate::cli::propose;

/// Longest design file (bytes).
const MOST_TEXT: usize = 200_000;

/// Most spheres of the half that are drawn and followed live; a simulation of so many takes seconds.
const MOST_SPHERES: usize = 20_000;

/// Rays that are drawn, and behind wavefronts.
const RAYS: usize = 33;
const FRONT_RAYS: usize = 201;

/// What the page begins with.
pub fn opened(opened: &Opened) -> Value {
    json!({
        "text": opened.text,
        "file": opened.path,
        "given": opened.given,
        "study": opened.study,
        "layout": opened.layout.as_ref().map(|(palette, materials)| json!({ "palette": palette, "materials": materials })),
        "version": env!("CARGO_PKG_VERSION"),
        "commit": granulens::outcome::COMMIT,
        "inks": (0..18).map(page::ink).map(|ink| json!([ink.fill, ink.text, ink.letter])).collect::<Vec<_>>(),
        "scale": report::scale_colours(),
        "families": Family::ALL.map(|family| json!({
            "name": family.name(), "takes_others": family.takes_others(), "radius": family.radius(), "has_axis": family.has_axis(),
            "parameters": family.parameters().iter().map(|parameter| json!({
                "name": parameter.name, "about": parameter.about, "range": parameter.range,
                "quantity": match parameter.quantity {
                    Quantity::Count => "count",
                    Quantity::Number => "number",
                    Quantity::Length => "length",
                },
            })).collect::<Vec<_>>(),
        })).to_vec(),
        "laws": granulens::contact::LawKind::ALL.iter().map(|law| law.name()).collect::<Vec<_>>(),
    })
}

/// A change: the key with its sections, as `target.focus.rows`, of several foci `target.focus.0.rows`; and its value as JSON, null to
/// leave it out.
#[derive(Deserialize)]
struct Edit {
    key: String,
    value: Value,
}

/// A text, with changes.
#[derive(Deserialize)]
pub struct Asked {
    text: String,
    #[serde(default)]
    edits: Vec<Edit>,
    /// The crystal whose sites the page knows.
    #[serde(default)]
    known: String,
}

/// What becomes of the text, what it means, and which lens it asks for.
pub fn look(asked: Asked, shared: &Shared) -> Result<Value, Failure> {
    let begun = Instant::now();
    let mut text = asked.text;
    let mut answer = Map::new();
    if !asked.edits.is_empty() {
        text = edited(&text, &asked.edits)?;
    }
    answer.insert("text".to_owned(), json!(text));
    if let Ok(document) = text.parse::<DocumentMut>() {
        answer.insert("keys".to_owned(), keys(&document));
    }
    match read(&text, shared) {
        Err(failure) => {
            answer.insert("error".to_owned(), failure.told());
        }
        Ok(design) => {
            answer.insert("design".to_owned(), told(&design, &asked.known));
            match design.lens.is_some().then(|| propose(&design)) {
                None => {}
                Some(Ok(lens)) => {
                    answer.insert("lens".to_owned(), lens_told(&design, &lens));
                }
                Some(Err(failure)) => {
                    answer.insert("unreachable".to_owned(), failure.told());
                }
            }
        }
    }
    answer.insert("ms".to_owned(), json!(begun.elapsed().as_secs_f64() * 1e3));
    Ok(Value::Object(answer))
}

/// A design of a text, of a size that can be followed.
pub fn read(text: &str, shared: &Shared) -> Result<Design, Failure> {
    if text.len() > MOST_TEXT {
        return Err(Failure::input("a design file may have 200 kB at most here"));
    }
    let design = Design::parse(&shared.opened.path, text)?;
    match design.lattice.len() {
        count if count > MOST_SPHERES => Err(Failure::input_with_help(
            format!("the half crystal has {count} spheres, more than the {MOST_SPHERES} that can be followed live"),
            "Choose fewer rows or a smaller half width, or use granulens run.",
        )),
        _ => Ok(design),
    }
}

/// A layout of a design by names of materials and places among these.
pub fn laid(design: &Design, names: &[String], places: &[u8]) -> Result<Layout, Failure> {
    let wrong = |message: String| Failure::input_with_help(message, "Begin again from the proposed lens.");
    if places.len() != design.lattice.len() {
        let (is, wants) = (places.len(), design.lattice.len());
        return Err(wrong(format!("the painted layout has {is} spheres, and the crystal of the design {wants}")));
    }
    // As a layout file is read: what the design names first.
    let mut palette = design.palette();
    let mut place_of = Vec::new();
    for name in names {
        let material = design.material(name)?;
        place_of.push(palette.iter().position(|known| *known == material));
        if place_of.last() == Some(&None) {
            let used = places.iter().any(|&place| usize::from(place) == place_of.len() - 1);
            if used {
                palette.push(material);
            }
            *place_of.last_mut().expect("one was pushed") = Some(palette.len() - 1);
        }
    }
    let place = |&place: &u8| match place_of.get(usize::from(place)) {
        Some(Some(found)) => Ok(*found as u8),
        _ => Err(wrong(format!("the painted layout names no material {place}"))),
    };
    let materials = places.iter().map(place).collect::<Result<Vec<u8>, _>>()?;
    Ok(Layout { lattice: design.lattice.clone(), palette, materials })
}

/// The text with some keys changed, as a person would change them.
fn edited(text: &str, edits: &[Edit]) -> Result<String, Failure> {
    let mut document: DocumentMut = text.parse().map_err(|error| {
        Failure::input_with_help(format!("the text is no TOML: {error}"), "Mend it in the text below, or undo.")
    })?;
    for Edit { key, value } in edits {
        let path: Vec<&str> = key.split('.').collect();
        let fail = || Failure::input(format!("{key}: there is no place for it in this file"));
        let (last, sections) = path.split_last().ok_or_else(fail)?;
        let table = descend(document.as_table_mut(), sections, !value.is_null());
        let Some(table) = table else {
            if value.is_null() {
                continue;
            }
            return Err(fail());
        };
        if value.is_null() {
            table.remove(last);
            continue;
        }
        let mut written =
            literal(value).ok_or_else(|| Failure::input(format!("{key}: {value} is no value of TOML")))?;
        match table.get_mut(last).and_then(Item::as_value_mut) {
            // Blanks and the comment behind it stay.
            Some(old) => {
                *written.decor_mut() = old.decor().clone();
                *old = written;
            }
            None => {
                table.insert(last, Item::Value(written));
            }
        }
    }
    Ok(document.to_string())
}

/// The table below some sections, made on the way where that is wanted.
fn descend<'a>(table: &'a mut dyn TableLike, sections: &[&str], make: bool) -> Option<&'a mut dyn TableLike> {
    let Some((first, rest)) = sections.split_first() else { return Some(table) };
    if make && table.get(first).is_none() {
        table.insert(first, toml_edit::table());
    }
    let item = table.get_mut(first)?;
    if let (Some(place), Some(_)) =
        (rest.first().and_then(|place| place.parse::<usize>().ok()), item.as_array_of_tables())
    {
        return descend(item.as_array_of_tables_mut()?.get_mut(place)?, &rest[1..], make);
    }
    descend(item.as_table_like_mut()?, rest, make)
}

fn literal(value: &Value) -> Option<toml_edit::Value> {
    Some(match value {
        Value::String(text) => text.as_str().into(),
        Value::Bool(is) => (*is).into(),
        Value::Number(number) => match number.as_i64() {
            Some(whole) => whole.into(),
            None => number.as_f64()?.into(),
        },
        Value::Array(items) => {
            let items = items.iter().map(literal).collect::<Option<Vec<_>>>()?;
            toml_edit::Value::Array(items.into_iter().collect())
        }
        Value::Null | Value::Object(_) => return None,
    })
}

/// Every key of the text with its value as JSON, below its sections.
fn keys(document: &DocumentMut) -> Value {
    let mut found = Map::new();
    gather(document.as_table(), String::new(), &mut found);
    Value::Object(found)
}

fn gather(table: &dyn TableLike, above: String, found: &mut Map<String, Value>) {
    for (key, item) in table.iter() {
        let name = format!("{above}{key}");
        if let Some(several) = item.as_array_of_tables() {
            for (k, each) in several.iter().enumerate() {
                gather(each, format!("{name}.{k}."), found);
            }
        } else if let Some(below) = item.as_table_like() {
            gather(below, format!("{name}."), found);
        } else if let Some(value) = item.as_value() {
            found.insert(name, as_json(value));
        }
    }
}

fn as_json(value: &toml_edit::Value) -> Value {
    match value {
        toml_edit::Value::String(text) => json!(text.value()),
        toml_edit::Value::Integer(number) => json!(number.value()),
        toml_edit::Value::Float(number) => json!(number.value()),
        toml_edit::Value::Boolean(is) => json!(is.value()),
        toml_edit::Value::Array(items) => Value::Array(items.iter().map(as_json).collect()),
        other => json!(other.to_string().trim()),
    }
}

/// What the checked design says. Lengths in diameters where they are on the crystal.
fn told(design: &Design, known: &str) -> Value {
    let lattice = &design.lattice;
    let diameter = lattice.diameter();
    let sizes: Vec<f64> = (1..=lattice.rows()).map(|row| lattice.row_diameter(row)).collect();
    let packing = lattice.packing().name();
    let crystal = format!("{packing}/{diameter}/{sizes:?}/{}/{}", lattice.rows(), lattice.half_width());
    let sites = (crystal != known).then(|| {
        let sites = lattice.sites();
        json!({
            "row": sites.iter().map(|site| site.row).collect::<Vec<_>>(),
            "column": sites.iter().map(|site| site.column).collect::<Vec<_>>(),
            "x": sites.iter().map(|site| site.x / diameter).collect::<Vec<_>>(),
            "z": sites.iter().map(|site| site.z / diameter).collect::<Vec<_>>(),
        })
    });
    let region = |region: &Region| json!({ "rows": region.rows, "x": region.x.map(|x| x / diameter) });
    let materials: Vec<Material> = library().into_iter().chain(design.own_materials.iter().cloned()).collect();
    json!({
        "name": design.name,
        "diameter_m": diameter,
        "rows": lattice.rows(),
        "half_width": lattice.half_width() / diameter,
        "row_spacing": lattice.row_spacing() / diameter,
        "crystal": crystal,
        "sites": sites,
        "spheres": lattice.len(),
        "host": design.host.name,
        "impact": design.impact_in_words(),
        "foci": design.target.foci.iter().map(|focus| region(&focus.region)).collect::<Vec<_>>(),
        "protect": region(&design.target.protect),
        "palette": design.palette().iter().map(|material| &material.name).collect::<Vec<_>>(),
        "reference": design.reference().map(|material| &material.name),
        "materials": materials.iter().map(|material| json!({
            "name": material.name, "aliases": aliases(&material.name), "source": material.source,
        })).collect::<Vec<_>>(),
        "notes": design.notes,
    })
}

/// The proposed lens: its sites, numbers, rays and wavefronts.
fn lens_told(design: &Design, lens: &Lens) -> Value {
    let per_diameter = |lines: &[Vec<[f64; 2]>]| -> Vec<Vec<[f64; 2]>> {
        let short = |x: f64| (x / design.lattice.diameter() * 1e4).round() / 1e4;
        lines.iter().map(|line| line.iter().map(|point| point.map(short)).collect()).collect()
    };
    let mut proposed = proposal(design, lens);
    let faces = per_diameter(&std::mem::take(&mut proposed.faces));
    proposed.rays.clear();
    let fronts = trace_fronts(lens, FRONT_RAYS);
    json!({
        "palette": lens.palette.iter().map(|material| &material.name).collect::<Vec<_>>(),
        "materials": lens.materials,
        "words": crate::cli::design::words(design, lens),
        "proposal": proposed,
        "faces": faces,
        "rays": per_diameter(&lens.sample_rays(RAYS)),
        "fronts": fronts.iter().map(|front| json!({ "time_s": front.time, "lines": per_diameter(&front.lines) })).collect::<Vec<_>>(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn change(key: &str, value: Value) -> Edit {
        Edit { key: key.to_owned(), value }
    }

    fn after(text: &str, edits: &[Edit]) -> String {
        edited(text, edits).ok().expect("the text has a place for it")
    }

    #[test]
    fn a_change_leaves_comments_and_all_else_alone() {
        let text = super::super::FIRST;
        let edits = [change("target.focus.rows", json!([20, 24])), change("impact.force", json!("12 kN"))];
        let changed = after(text, &edits);
        let differ: Vec<_> = text.lines().zip(changed.lines()).filter(|(a, b)| a != b).map(|(_, b)| b).collect();
        assert_eq!(
            differ,
            [
                "force = \"12 kN\"                        # on every sphere of row 1",
                "focus = { rows = [20, 24], x = [\"0 D\", \"2.5 D\"] }       # energy is wanted here ..."
            ]
        );
        let back = [change("target.focus.rows", json!([30, 34])), change("impact.force", json!("26 kN"))];
        assert_eq!(after(&changed, &back), text);
    }

    #[test]
    fn keys_come_go_and_are_found_in_several_foci() {
        let text = super::super::FIRST;
        let with = after(text, &[change("run.accuracy", json!("1 %")), change("lens.stages", json!(3))]);
        assert!(with.contains("[run]\naccuracy = \"1 %\"") && with.contains("stages = 3"));
        let without = after(&with, &[change("run.accuracy", Value::Null), change("lens.stages", Value::Null)]);
        assert!(!without.contains("accuracy") && !without.contains("stages"));
        let foci = "[[target.focus]]\nrows = [1, 2]\n[[target.focus]]\nrows = [3, 4] # mine\n";
        let moved = after(foci, &[change("target.focus.1.rows", json!([5, 6]))]);
        assert_eq!(moved, foci.replace("[3, 4]", "[5, 6]"));
        assert_eq!(keys(&moved.parse().unwrap())["target.focus.1.rows"], json!([5, 6]));
        assert!(edited(foci, &[change("target.focus.2.rows", json!([5, 6]))]).is_err());
    }
}
