//! The section [lens]: which family, of what, and what is already decided about it.

use std::collections::BTreeMap;

use super::file::LensFile;
use super::{DesignError, any, region};
use crate::contact::Constants;
use crate::document::{self, Entry, Scope, Written};
use crate::lattice::{HexagonalSheet, SheetPacking};
use crate::lens::{Family, LensRequest, Parameter, Quantity, Raster, Stack, Symmetry};
use crate::material::{Material, library};
use crate::target::Target;
use crate::units::Dimension;

/// The palette of a layout is counted in bytes, and nobody buys more.
const MOST_OTHERS: usize = 10;

pub(super) fn read(
    section: &(Scope, &LensFile),
    lattice: &HexagonalSheet,
    host: &Material,
    target: &Target,
    regions: &Scope,
    own: &[Material],
    constants: Constants,
) -> Result<(LensRequest, Option<String>), DesignError> {
    let (scope, file) = section;
    if let Some(entry) = scope.optional("symmetry", &file.symmetry)
        && entry.choice("symmetry", &SYMMETRIES)? == Symmetry::Axis
    {
        return Err(entry.fail(
            "is a body of revolution, which no sheet holds: crystal.packing is hexagonal-2d",
            "Leave it out, or choose a packing in space: hcp or fcc-111.",
        ));
    }
    scope.forbid(
        &[("layers", &file.layers), ("apex_layer", &file.apex_layer), ("back_layer", &file.back_layer)],
        "a sheet",
        "It has rows: rows, apex_row, back_row.",
    )?;
    if !lattice.is_close_packed() {
        let why = match lattice.packing() {
            SheetPacking::Square => {
                "waves run along the rows and columns of a square packing as in chains, and are not bent"
            }
            SheetPacking::Hexagonal => "rays know the waves of equal spheres alone",
        };
        return Err(scope.fail(
            &format!("asks for a lens by rays, which this crystal has none of: {why}"),
            "Leave out [lens] and name compare.material; check, compare, study and simulate take layouts of your own.",
        ));
    }
    let ground = Lying {
        stack: lattice.into(),
        row: "row",
        keys: [("rows", &file.rows), ("apex_row", &file.apex_row), ("back_row", &file.back_row)],
        foci: target.foci.len(),
        first_focal: target.focal_rows()[0],
    };
    let (request, candidates) = request(section, &ground, host, regions, own)?;
    Ok(any::best(request, &candidates, lattice, host, target, constants))
}

/// How a lens goes on out of its plane.
pub(super) const SYMMETRIES: [(&str, Symmetry); 2] = [("plane", Symmetry::Plane), ("axis", Symmetry::Axis)];

/// In what a lens lies: the layers of a crystal, what one is called, and how the keys that count them are written.
pub(super) struct Lying<'a> {
    pub stack: Stack,
    pub row: &'a str,
    pub keys: [(&'a str, &'a Written); 3],
    pub foci: usize,
    pub first_focal: u32,
}

/// What is asked for, and the materials that it may be of, of which the request holds the first.
pub(super) fn request(
    (scope, file): &(Scope, &LensFile),
    ground: &Lying,
    host: &Material,
    regions: &Scope,
    own: &[Material],
) -> Result<(LensRequest, Vec<Material>), DesignError> {
    let Lying { stack, row: name, keys: [(rows_key, rows), (apex_key, apex), (back_key, back)], foci, .. } = *ground;
    let families = Family::names();
    let written = scope.required("family", &file.family)?;
    let family = written.choice("lens family", &families)?;
    if foci > 1 && !family.is_split() && !family.spares() {
        let split: Vec<&str> =
            Family::ALL.iter().filter(|family| family.is_split()).map(|family| family.name()).collect();
        return Err(written.fail(
            &format!("cannot be split among {foci} focal regions"),
            &format!("Ask for one that can: {}; or leave one target.focus.", split.join(", ")),
        ));
    }
    let foreign = |entry: &Entry| {
        let material = document::chosen(entry, own)?;
        if material.name == host.name {
            return Err(entry.fail(
                "is the material of the crystal, crystal.host",
                "Choose another; a lens bends a wave only where its material differs from what surrounds it.",
            ));
        }
        Ok(material)
    };
    let mut candidates = candidates(&scope.required("material", &file.material)?, host, own, foreign)?;
    let material = candidates[0].clone();
    let others = match scope.optional("others", &file.others) {
        Some(entry) => others(&entry, family, &material, foreign)?,
        None => Vec::new(),
    };
    candidates.retain(|candidate| !others.iter().any(|other| other.name == candidate.name));
    let focus = ground.first_focal;
    let rows = match scope.optional(rows_key, rows) {
        Some(entry) => {
            let [first, last] = region::rows(&entry, (name, stack.rows))?;
            if last >= focus {
                return Err(entry.fail_as(
                    &entry.range_text(),
                    &format!("reaches into the focal region, which begins in {name} {focus}"),
                    &format!("End it at {name} {} or before.", focus - 1),
                ));
            }
            if first == last {
                return Err(entry.fail_as(
                    &entry.range_text(),
                    &format!("is a single {name}"),
                    &format!("Give the lens at least two {name}s, one for its apex and one for its flat face."),
                ));
            }
            [first, last]
        }
        None if focus >= 4 => [2, focus - 1],
        None => {
            return Err(regions.fail(
                &format!(
                    "leaves no room for a lens: focus begins in {name} {focus}, {name} 1 is struck, and a lens needs two {name}s between"
                ),
                &format!("Begin target.focus.{rows_key} at {name} 4 or later."),
            ));
        }
    };
    let [first, last] = rows;
    let within = format!("must lie within the lens's {name}s, {first} to {last}");
    let row = |key: &str, written, allowed: [u32; 2], help: &str| -> Result<Option<u32>, DesignError> {
        let Some(entry) = scope.optional(key, written) else { return Ok(None) };
        let row = entry.whole(1..=stack.rows)?;
        match row {
            _ if !(first..=last).contains(&row) => Err(entry.fail(&within, &format!("Change it, or lens.{rows_key}."))),
            _ if !(allowed[0]..=allowed[1]).contains(&row) => {
                Err(entry.fail(&format!("must lie from {} to {}", allowed[0], allowed[1]), help))
            }
            _ => Ok(Some(row)),
        }
    };
    let before_back = format!("The apex lies at least one {name} in front of the flat face, lens.{back_key}.");
    let apex_row = row(apex_key, apex, [first, last - 1], &before_back)?;
    let after_apex = apex_row.unwrap_or(first);
    let help = format!("The flat face lies at least one {name} behind the apex, in {name} {after_apex}.");
    let back_row = row(back_key, back, [after_apex + 1, last], &help)?;
    let radius = match scope.optional("radius", &file.radius) {
        Some(entry) if family.radius().is_none() => {
            return Err(entry.fail(
                &format!("has no meaning for a lens of the family {}", family.name()),
                "Leave it out: its faces follow from the rows and the focal region.",
            ));
        }
        Some(entry) => match entry.length(stack.diameter)? {
            radius if radius > 0.0 => Some(radius),
            _ => return Err(entry.fail("must be more than zero", &entry.write_it_like())),
        },
        None => None,
    };
    let max_interface_angle = match scope.optional("max_interface_angle", &file.max_interface_angle) {
        Some(entry) => match entry.quantity(Dimension::Angle)? {
            angle if angle > 0.0 && angle < 90.0_f64.to_radians() => angle,
            _ => return Err(entry.fail("must lie between 0 and 90 deg, both excluded", &entry.write_it_like())),
        },
        None => 60.0_f64.to_radians(),
    };
    let axis = match scope.optional("axis", &file.axis) {
        Some(entry) if !family.has_axis() => {
            let rule = format!("has no meaning for a lens of the family {}", family.name());
            return Err(entry.fail(&rule, "Leave it out: its edge lies on the axis or on the far mirror line."));
        }
        Some(entry) if foci > 1 && family.is_split() => {
            return Err(entry.fail(
                &format!("has no meaning with {foci} focal regions, each of which has a part with an axis of its own"),
                "Leave it out: each part stands before its own region.",
            ));
        }
        Some(entry) => Some(axis(&entry, &stack)?),
        None => None,
    };
    let mut parameters = BTreeMap::new();
    let stages = scope.optional("stages", &file.stages);
    let below = scope.optional("parameters", &file.parameters);
    let below = below.as_ref().map(Entry::fields).transpose()?.unwrap_or_default();
    // The key stages is older than parameters are.
    let given = stages.map(|entry| ("stages".to_owned(), entry)).into_iter().chain(below);
    for (key, entry) in given {
        let value = parameter(&key, &entry, family, stack.diameter)?;
        if parameters.insert(key, value).is_some() {
            return Err(entry.fail("is given twice", "Leave one of the two out."));
        }
        let least = family.values(&parameters, stack.diameter).map_or(1, |values| family.least_span(&values)) + 1;
        if last - first + 1 < least {
            return Err(entry.fail(
                &format!("needs {least} {name}s, and the lens may lie in {name}s {first} to {last}"),
                &format!("Ask for fewer, or widen lens.{rows_key}: a stage takes two {name}s, and one of host lies between two."),
            ));
        }
    }
    let raster = match scope.optional("raster", &file.raster) {
        Some(entry) => Some(entry.choice("raster", &Raster::ALL.map(|raster| (raster.name(), raster)))?),
        None => None,
    };
    let seed = match scope.optional("seed", &file.seed) {
        Some(entry) if raster != Some(Raster::Random) => {
            return Err(entry.fail("has no use without a random raster", "Leave it out, or write raster = \"random\"."));
        }
        Some(entry) => entry.seed()?,
        None => 1,
    };
    let request = LensRequest {
        family,
        material,
        others,
        rows,
        max_interface_angle,
        apex_row,
        back_row,
        radius,
        parameters,
        axis,
        raster,
        seed,
        symmetry: Symmetry::default(),
    };
    Ok((request, candidates))
}

/// The value (SI) of one of the family's own parameters.
fn parameter(key: &str, entry: &Entry, family: Family, diameter: f64) -> Result<f64, DesignError> {
    let Some(Parameter { quantity, range: [least, most], .. }) =
        family.parameters().iter().find(|known| known.name == key).copied()
    else {
        let others = Family::ALL.iter().filter(|other| other.parameters().iter().any(|known| known.name == key));
        let others: Vec<&str> = others.map(|family| family.name()).collect();
        let names: Vec<&str> = family.parameters().iter().map(|known| known.name).collect();
        let help = match (&others[..], &names[..]) {
            ([], []) => "Leave it out: the family has none.".to_owned(),
            ([], names) => format!("Its parameters are {}.", names.join(", ")),
            (others, _) => format!("Leave it out, or ask for the family {}.", others.join(" or ")),
        };
        return Err(entry.fail(&format!("is no parameter of the family {}", family.name()), &help));
    };
    let value = match quantity {
        Quantity::Count => return Ok(f64::from(entry.whole(least as u32..=most as u32)?)),
        Quantity::Number => {
            entry.number().map_err(|_| entry.fail("must be a plain number", &format!("Write it like {key} = -0.5.")))?
        }
        Quantity::Length => entry.length(diameter).map_err(|_| {
            let help = format!(
                "Write it like {key} = \"0.2 D\", with D for the diameter of a sphere, or in another unit of length."
            );
            entry.fail("is no length", &help)
        })?,
    };
    let unit = quantity.unit(diameter);
    // Lengths in other units are rounded.
    let slack = 1e-9 * (most - least);
    if (least - slack..=most + slack).contains(&(value / unit)) {
        return Ok(value);
    }
    let d = if quantity == Quantity::Length { " D" } else { "" };
    Err(entry.fail(&format!("must lie from {least}{d} to {most}{d}"), "Leave it out to have it sought."))
}

/// The materials that the lens may be of: one, or all that are named, or with "any" all that are known.
fn candidates(
    entry: &Entry,
    host: &Material,
    own: &[Material],
    foreign: impl Fn(&Entry) -> Result<Material, DesignError>,
) -> Result<Vec<Material>, DesignError> {
    if !entry.is_list() && entry.text()? == "any" {
        return Ok(library().into_iter().chain(own.iter().cloned()).filter(|known| known.name != host.name).collect());
    }
    let mut found: Vec<Material> = Vec::new();
    for item in entry.one_or_more() {
        let next = foreign(&item)?;
        if found.iter().any(|known| known.name == next.name) {
            return Err(item.fail("is named twice", "Name each material that the lens may be of once."));
        }
        found.push(next);
    }
    if found.is_empty() {
        return Err(entry.fail("names no material", "Name one or several, or write \"any\" for all that are known."));
    }
    Ok(found)
}

/// Further materials, all different from host and lens and from each other.
fn others(
    entry: &Entry,
    family: Family,
    material: &Material,
    foreign: impl Fn(&Entry) -> Result<Material, DesignError>,
) -> Result<Vec<Material>, DesignError> {
    if !family.takes_others() {
        return Err(entry.fail(
            &format!("has no meaning for a lens of the family {}, which is of one material", family.name()),
            "Leave it out, or ask for one of the families stages and graded.",
        ));
    }
    let mut found: Vec<Material> = Vec::new();
    for item in entry.items()? {
        let next = foreign(&item)?;
        if next.name == material.name || found.iter().any(|known| known.name == next.name) {
            return Err(
                item.fail("is named twice", "Name each material of the lens once, in lens.material or lens.others.")
            );
        }
        found.push(next);
    }
    if found.len() > MOST_OTHERS {
        return Err(entry.fail(&format!("names more than {MOST_OTHERS} materials"), "Choose fewer."));
    }
    Ok(found)
}

fn axis(entry: &Entry, stack: &Stack) -> Result<f64, DesignError> {
    let half_width = stack.half_width;
    let axis = entry.length(stack.diameter)?;
    // Lengths in other units are rounded.
    if !(0.0..=half_width * (1.0 + 1e-9)).contains(&axis) {
        let edge = half_width / stack.diameter;
        let help = "A design describes the half x >= 0; a lens off the axis has its mirror image on the other side.";
        return Err(entry.fail(&format!("must lie in the half crystal, from 0 D to {edge} D"), help));
    }
    Ok(axis.min(half_width))
}
