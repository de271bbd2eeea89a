//! How grains moved between two files of places.

use std::collections::BTreeMap;
use std::path::Path;

pub use granulens_core::motion::*;

use crate::columns::{Table, TableError};

/// Grains of two files, in the order of the first.
#[derive(Debug)]
pub struct Moved {
    /// What the files call each grain.
    pub names: Vec<String>,
    /// Places before.
    pub before: Vec<[f64; 2]>,
    /// Places after.
    pub after: Vec<[f64; 2]>,
    /// Mean diameter, where the first file has a column `diameter`.
    pub diameter: Option<f64>,
    /// Period that the first file names, if any.
    pub period: Option<f64>,
}

/// Reads places before and after: CSV with the columns `id,x,z`, each grain once in both. With a column `kind` only rows of the kind
/// `grain` count, as in frames.
///
/// # Errors
/// See [`TableError`]; a grain that is in one file alone.
pub fn read(before: &Path, after: &Path) -> Result<Moved, TableError> {
    let one = |path: &Path| {
        let mut table = Table::read(path)?.swap_remove(0);
        // Of a frame the grains, not the disks of walls and intruder.
        if table.has("kind") {
            let grains: Vec<bool> = table.labels("kind")?.iter().map(|kind| *kind == "grain").collect();
            table.retain(&grains);
        }
        Ok::<Table, TableError>(table)
    };
    let (first, second) = (one(before)?, one(after)?);
    let names = first.labels("id")?;
    let known = by_name(&first, &names)?;
    let others = second.labels("id")?;
    let there = by_name(&second, &others)?;
    let (old, new) = (places(&first)?, places(&second)?);
    if let Some(alone) = others.iter().position(|name| !known.contains_key(name)) {
        let message = format!("grain {} is not in {}.", others[alone], before.display());
        return Err(second.blame(alone, message, "Both files must hold the same grains."));
    }
    let moved = names.iter().enumerate().map(|(k, name)| match there.get(name) {
        Some(&place) => Ok(new[place]),
        None => {
            let message = format!("grain {name} is not in {}.", after.display());
            Err(first.blame(k, message, "Both files must hold the same grains."))
        }
    });
    let after = moved.collect::<Result<Vec<_>, _>>()?;
    let diameter = match first.has("diameter") && !first.is_empty() {
        true => Some(first.numbers("diameter")?.iter().sum::<f64>() / first.len() as f64),
        false => None,
    };
    let names = names.iter().map(|&name| name.to_owned()).collect();
    Ok(Moved { names, before: old, after, diameter, period: first.period })
}

fn by_name<'a>(table: &Table, names: &[&'a str]) -> Result<BTreeMap<&'a str, usize>, TableError> {
    let mut known = BTreeMap::new();
    for (k, &name) in names.iter().enumerate() {
        if let Some(first) = known.insert(name, k) {
            let message = format!("grain {name} is in line {} already.", table.line(first));
            return Err(table.blame(k, message, "Give each grain once."));
        }
    }
    Ok(known)
}

fn places(table: &Table) -> Result<Vec<[f64; 2]>, TableError> {
    let (x, z) = (table.numbers("x")?, table.numbers("z")?);
    Ok(x.into_iter().zip(z).map(|(x, z)| [x, z]).collect())
}
