//! The sections [law], [[pair]] and [friction].

use std::sync::Arc;

use super::file::{FrictionFile, LawFile, PairFile};
use super::pulse::{of_table, table};
use crate::contact::{Constants, LawKind, Tabulated};
use crate::dem::rig::{Friction, Law, LawBook, Spring};
use crate::document::{DocumentError, Scope, Section, Sections, Written, chosen};
use crate::material::Material;
use crate::units::Dimension;

/// The laws of a rig whose spheres are of the materials of `palette`.
pub(super) fn laws(
    top: &Scope,
    (law, pairs, friction): (&Section<LawFile>, &Sections<PairFile>, &Section<FrictionFile>),
    palette: &[Material],
    own: &[Material],
) -> Result<LawBook, DocumentError> {
    let mut book = (Law::Named(LawKind::Thesis), Constants::default());
    if let Some((scope, file)) = top.section("law", law) {
        if let Some(law) = named_or_table(&scope, &file.kind, &file.table)? {
            book.0 = law;
        }
        if let Some(entry) = scope.optional("constants", &file.constants) {
            let known: Vec<_> = Constants::ALL.iter().map(|&set| (set.name(), set)).collect();
            book.1 = entry.choice("set of constants", &known)?;
        }
    }
    let mut named = Vec::new();
    for (scope, file) in top.sections("pair", pairs) {
        let entry = scope.required("materials", &file.materials)?;
        let materials = entry
            .one_or_more()
            .iter()
            .map(|item| {
                let material = chosen(item, own)?;
                palette.iter().position(|known| known.name == material.name).ok_or_else(|| {
                    let known: Vec<&str> = palette.iter().map(|material| material.name.as_str()).collect();
                    item.fail("is no material of this rig", &format!("It is made of {}.", known.join(", ")))
                })
            })
            .collect::<Result<Vec<_>, _>>()?;
        let [a, b] = materials[..] else { return Err(entry.refuse("must be a list of two materials")) };
        let law = named_or_table(&scope, &file.kind, &file.table)?;
        let law = law.ok_or_else(|| scope.fail("names no law", "Give kind or table."))?;
        if named.iter().any(|(pair, _)| *pair == [a, b] || *pair == [b, a]) {
            return Err(entry.fail("has a law already", "Keep one [[pair]] for each two materials."));
        }
        named.push(([a, b], law));
    }
    let friction = top.section("friction", friction).map(|(scope, file)| read_friction(&scope, file)).transpose()?;
    Ok(LawBook::Materials { law: book.0, constants: book.1, pairs: named, friction })
}

fn named_or_table(scope: &Scope, kind: &Written, file: &Written) -> Result<Option<Law>, DocumentError> {
    match (scope.optional("kind", kind), scope.optional("table", file)) {
        (Some(_), Some(entry)) => Err(entry.fail("is given beside kind", "Keep one of them.")),
        (Some(entry), None) => {
            let known: Vec<_> = LawKind::ALL.iter().map(|&law| (law.name(), law)).collect();
            Ok(Some(Law::Named(entry.choice("contact law", &known)?)))
        }
        (None, Some(entry)) => {
            let path = entry.path()?;
            let points = table(&path, ["overlap_m", "force_N"])?;
            let law = Tabulated::new(&points).map_err(|error| of_table(&path, &error.to_string()))?;
            Ok(Some(Law::Tabulated(Arc::new(law))))
        }
        (None, None) => Ok(None),
    }
}

fn read_friction(scope: &Scope, file: &FrictionFile) -> Result<Friction, DocumentError> {
    let entry = scope.required("coefficient", &file.coefficient)?;
    let coefficient = entry.number()?;
    if coefficient < 0.0 {
        return Err(entry.refuse("must not be negative"));
    }
    let entry = scope.required("spring", &file.spring)?;
    let spring = match entry.text()? {
        "none" => Spring::None,
        "mindlin" => Spring::Mindlin,
        _ => Spring::Constant(entry.positive(Dimension::Stiffness)?),
    };
    let damping = match scope.optional("damping", &file.damping) {
        Some(entry) => match entry.quantity(Dimension::Rate)? {
            damping if damping < 0.0 => return Err(entry.refuse("must not be negative")),
            damping => damping,
        },
        None => 0.0,
    };
    Ok(Friction { coefficient, spring, damping })
}
