//! The keys of a kind of file as JSON Schema (draft 7), which editors check files by while they are written.

use serde_json::{Map, Value, json};

use super::{FileKind, Key, Section};

impl FileKind {
    /// The schema of such files.
    pub fn schema(self) -> Value {
        let keys = self.keys();
        let mut top = Map::new();
        let mut required = Vec::new();
        for section in &keys.sections {
            match section.name.as_str() {
                "" => {
                    top.extend(section.keys.iter().map(|key| (short(key).to_owned(), of_key(key))));
                    required.extend(section.keys.iter().filter(|key| key.required).map(short));
                }
                // The sections of own materials are named by their user.
                "materials.*" => {
                    top.insert(
                        "materials".to_owned(),
                        json!({ "type": "object", "additionalProperties": of_section(section) }),
                    );
                }
                name if name.contains('.') => {}
                name => {
                    top.insert(name.to_owned(), self.of_named(section));
                    if section.required {
                        required.push(name);
                    }
                }
            }
        }
        if matches!(self, Self::Design | Self::Rig) {
            let own = Self::Materials.schema()["properties"]["materials"].clone();
            top.insert("materials".to_owned(), own);
        }
        json!({
            "$schema": "http://json-schema.org/draft-07/schema#",
            "title": keys.title,
            "description": keys.about,
            "type": "object",
            "properties": top,
            "required": required,
            "additionalProperties": false,
        })
    }

    /// A section, with the sections below it.
    fn of_named(self, section: &Section) -> Value {
        // Their keys are names of measures or materials.
        if matches!(section.name.as_str(), "thresholds" | "objective" | "prices") {
            return open(&section.about);
        }
        let mut schema = of_section(section);
        for key in section.keys.iter().filter(|key| key.takes == "region") {
            let below = self.keys().sections.iter().find(|below| below.name == key.name);
            if let Some(region) = below.map(of_section) {
                let several = json!({ "type": "array", "items": region });
                schema["properties"][short(key)] = json!({ "description": key.meaning, "anyOf": [region, several] });
            }
        }
        if section.many { json!({ "type": "array", "items": schema }) } else { schema }
    }
}

fn short(key: &Key) -> &str {
    key.name.rsplit('.').next().unwrap_or_default()
}

fn open(about: &str) -> Value {
    json!({ "type": "object", "description": about })
}

fn of_section(section: &Section) -> Value {
    let properties: Map<String, Value> = section.keys.iter().map(|key| (short(key).to_owned(), of_key(key))).collect();
    let required: Vec<&str> = section.keys.iter().filter(|key| key.required).map(short).collect();
    json!({
        "type": "object",
        "description": section.about,
        "properties": properties,
        "required": required,
        "additionalProperties": false,
    })
}

fn of_key(key: &Key) -> Value {
    let mut meaning = key.meaning.clone();
    for (label, text) in [("Range", &key.range), ("Default", &key.default), ("Example", &key.example)] {
        if !text.is_empty() {
            meaning += &format!(" {label}: {text}.");
        }
    }
    let mut schema = of_type(&key.takes, &key.choices);
    schema["description"] = meaning.into();
    schema
}

fn of_type(takes: &str, choices: &[String]) -> Value {
    if let Some(item) = takes.strip_prefix("list of ") {
        let item = of_type(item, choices);
        return json!({ "anyOf": [{ "type": "array", "items": item }, item] });
    }
    if let Some(item) = takes.strip_prefix("pair of ") {
        let item = of_type(item, choices);
        return json!({ "anyOf": [{ "type": "array", "items": item, "minItems": 1, "maxItems": 2 }, item] });
    }
    match takes {
        // A side may be a list of two.
        "choice" => json!({ "anyOf": [{ "enum": choices }, { "type": "array", "items": { "enum": choices } }] }),
        "whole" => json!({ "type": "integer" }),
        "number" => json!({ "type": "number" }),
        "truth" => json!({ "type": ["boolean", "string"] }),
        "region" | "bounds" | "wish" | "table" => json!({ "type": "object" }),
        "name" => json!({ "type": "string", "pattern": "^[A-Za-z0-9_-]{1,100}$" }),
        // Quantities are text with a unit; vectors of them are lists; zero may be without.
        _ => json!({ "type": ["string", "number", "array"] }),
    }
}
