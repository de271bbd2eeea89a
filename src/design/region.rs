//! The section [target]: regions inside the crystal that hold spheres; what is protected shares none with a focus.

use super::DesignError;
use super::file::{EXAMPLES, FocusFile, RegionFile, TargetFile};
use crate::document::{Entry, Scope, Written, example};
use crate::lattice::{HexagonalSheet, Site};
use crate::target::{Focus, Region, Target};

pub(super) fn target((scope, file): &(Scope, &TargetFile), lattice: &HexagonalSheet) -> Result<Target, DesignError> {
    let foci = scope.one_or_several("focus", &file.focus, &how("focus"))?;
    if foci.len() > MOST_FOCI {
        return Err(scope.fail(
            &format!("has {} foci, more than {MOST_FOCI}", foci.len()),
            "A lens is split among its foci, and so many leave none of them a part to speak of.",
        ));
    }
    let (place, protect) = scope.required_section("protect", &file.protect, &how("protect"))?;
    let mut wanted = Vec::new();
    for (scope, file) in &foci {
        forbid(scope, &Keys::from(file))?;
        wanted.push((region(scope, [&file.rows, &file.x], lattice)?, share(scope, &file.share, foci.len())?));
    }
    forbid(&place, &Keys::from(&protect))?;
    let protect = region(&place, [&protect.rows, &protect.x], lattice)?;
    for ((focus, _), (scope, _)) in wanted.iter().zip(&foci) {
        let both = [focus.rows[0].max(protect.rows[0]), focus.rows[1].min(protect.rows[1])];
        let shared = first_site(lattice, both, |site| {
            focus.contains(site, lattice.diameter()) && protect.contains(site, lattice.diameter())
        });
        if let Some(site) = shared {
            let x = in_diameters(site.x, lattice);
            return Err(place.fail(
                &format!("shares spheres with {}, such as that of row {} at x = {x} D", scope.name(), site.row),
                "Move or shrink one of them; energy cannot be wanted and unwanted in the same sphere.",
            ));
        }
    }
    let sum: f64 = wanted.iter().map(|(_, share)| share).sum();
    Ok(Target {
        foci: wanted.into_iter().map(|(region, share)| Focus { region, share: share / sum }).collect(),
        protect,
    })
}

/// The keys of a region as written, those of sheets and of crystals in space.
pub(super) struct Keys<'a> {
    pub rows: &'a Written,
    pub layers: &'a Written,
    pub x: &'a Written,
    pub y: &'a Written,
    pub r: &'a Written,
    pub centre: &'a Written,
    pub radius: &'a Written,
}

macro_rules! keys_of {
    ($($file:ident),*) => { $(
        impl<'a> From<&&'a $file> for Keys<'a> {
            fn from(file: &&'a $file) -> Self {
                let $file { rows, layers, x, y, r, centre, radius, .. } = file;
                Self { rows, layers, x, y, r, centre, radius }
            }
        }
    )* };
}
keys_of!(FocusFile, RegionFile);

/// Refuses keys that a region of a sheet does not have.
fn forbid<'a>(scope: &Scope<'a>, keys: &Keys<'a>) -> Result<(), DesignError> {
    let Keys { layers, y, r, centre, radius, .. } = *keys;
    let strange = [("layers", layers), ("y", y), ("r", r), ("centre", centre), ("radius", radius)];
    scope.forbid(&strange, "a region of a sheet", "Such a region is rows and x.")
}

/// More leave no strip of a lens of common size two diameters wide.
pub(super) const MOST_FOCI: usize = 6;

/// A focus's part of the blow, over that of the others.
pub(super) fn share(scope: &Scope, written: &Written, foci: usize) -> Result<f64, DesignError> {
    match scope.optional("share", written) {
        None => Ok(1.0),
        Some(entry) if foci == 1 => Err(entry.fail(
            "has no use with a single focus",
            "Leave it out, or write each focus below a [[target.focus]] of its own.",
        )),
        Some(entry) => match entry.number()? {
            share if share > 0.0 => Ok(share),
            _ => Err(entry.fail(
                "must be more than zero",
                "Shares count relative to each other; leave out a focus that gets none.",
            )),
        },
    }
}

pub(super) fn how(key: &str) -> String {
    let example = example(EXAMPLES, &format!("target.{key}")).unwrap_or_default();
    format!("Add it to target, like {example}.")
}

fn region(
    scope: &Scope,
    [written_rows, written_x]: [&Written; 2],
    lattice: &HexagonalSheet,
) -> Result<Region, DesignError> {
    let rows = rows(&scope.required("rows", written_rows)?, ("row", lattice.rows()))?;
    let entry = scope.required("x", written_x)?;
    let [near, far] = entry.pair()?;
    let x = [near.length(lattice.diameter())?, far.length(lattice.diameter())?];
    let shown = entry.range_text();
    // Distances in other units are rounded: edges count as inside, as they do for spheres.
    let slack = 1e-9 * lattice.diameter();
    if x[0] > x[1] {
        return Err(entry.fail_as(&shown, "is reversed", "Write the distance nearer to the axis first."));
    }
    if x[0] < 0.0 {
        let help = "Begin at \"0 D\" or beyond: a design describes the half x >= 0, and the other half mirrors it.";
        return Err(entry.fail_as(&shown, "reaches across the axis", help));
    }
    if x[1] > lattice.half_width() + slack {
        let edge = in_diameters(lattice.half_width(), lattice);
        return Err(entry.fail_as(
            &shown,
            &format!("reaches outside the crystal, whose half_width is {edge} D"),
            &format!("End at \"{edge} D\" or before, or widen the crystal."),
        ));
    }
    let region = Region { rows, x };
    if first_site(lattice, rows, |site| region.contains(site, lattice.diameter())).is_none() {
        let (of, apart) = match rows {
            [only, last] if only == last => (format!("row {only}"), 1.0),
            [first, last] => (format!("rows {first} to {last}"), 0.5),
        };
        return Err(entry.fail_as(
            &shown,
            &format!("holds no sphere of {of}; centres lie {apart} D apart"),
            "Widen it.",
        ));
    }
    Ok(region)
}

/// First and last row of a list of two, in order and inside the crystal.
pub(super) fn rows(entry: &Entry, (name, last_of_crystal): (&str, u32)) -> Result<[u32; 2], DesignError> {
    let [first, last] = entry.pair()?;
    let rows = [first.whole(1..=u32::MAX)?, last.whole(1..=u32::MAX)?];
    let fail = |rule: &str, help: &str| Err(entry.fail_as(&entry.range_text(), rule, help));
    match rows {
        [first, last] if first > last => fail("is reversed", &format!("Write the {name} nearer to the impact first.")),
        [_, last] if last > last_of_crystal => fail(
            &format!("reaches outside the crystal, which has {last_of_crystal} {name}s"),
            &format!("End at {name} {last_of_crystal} or before, or add {name}s to the crystal."),
        ),
        _ => Ok(rows),
    }
}

/// The first site of the given rows that is wanted. Rows repeat in twos, so two of them tell of all; nothing is laid out,
/// which matters in a large crystal.
fn first_site(lattice: &HexagonalSheet, [first, last]: [u32; 2], wanted: impl Fn(&Site) -> bool) -> Option<Site> {
    (first..=last.min(first.saturating_add(1)))
        .flat_map(|row| (1..=lattice.columns(row)).filter_map(move |column| lattice.site(row, column)))
        .find(wanted)
}

/// A length in diameters, free of the digits of rounding.
fn in_diameters(x: f64, lattice: &HexagonalSheet) -> f64 {
    (x / lattice.diameter() * 1e6).round() / 1e6
}
