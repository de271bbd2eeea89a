//! Force networks from files: contacts as CSV or as LAMMPS dumps them, and frames of impacts and rigs.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

pub use granulens_core::network::*;

use crate::columns::{Table, TableError};

/// A network, and what its grains are called.
#[derive(Debug)]
pub struct Named {
    /// Time, or number of the step; where it is known.
    pub time: Option<f64>,
    /// The period along x, if any.
    pub period: Option<f64>,
    /// The network.
    pub network: Network,
    /// Of each grain what the file calls it.
    pub names: Vec<String>,
    /// Pairs without any force that a dump lists, which do not touch.
    pub apart: usize,
}

/// Networks of a file of contacts, shown one after another: `i,j,x_i,z_i,x_j,z_j,normal_N,tangential_N`, of which the places and
/// `tangential_N` may be missing. `columns` gives columns other names first; `period` stands in place of the file's own. Of a folder of
/// frames each is shown, its grains alone: what touches walls or an intruder is left out. With `layer`, only grains between these two
/// heights or depths.
///
/// # Errors
/// See [`TableError`]; those of `show`.
pub fn read<E: From<TableError>>(
    path: &Path,
    columns: &[(String, String)],
    period: Option<f64>,
    layer: Option<[f64; 2]>,
    mut show: impl FnMut(Named) -> Result<(), E>,
) -> Result<(), E> {
    if path.is_dir() {
        for [grains, contacts] in frames(path)? {
            show(of_frame(&grains, &contacts, period, layer)?)?;
        }
        return Ok(());
    }
    for mut table in Table::read(path)? {
        table.rename(columns)?;
        if let Some(layer) = layer {
            let (first, second) = (within(&table, "z_i", layer)?, within(&table, "z_j", layer)?);
            let wanted: Vec<bool> = first.iter().zip(&second).map(|(first, second)| *first && *second).collect();
            table.retain(&wanted);
        }
        show(of_table(table, period, None)?)?;
    }
    Ok(())
}

/// The files of the frames in a folder, grains and contacts of each, in order.
///
/// # Errors
/// A folder that cannot be read or holds none.
pub fn frames(folder: &Path) -> Result<Vec<[PathBuf; 2]>, TableError> {
    let blame = |message: &str| {
        TableError {
        path: folder.to_owned(),
        line: None,
        message: message.to_owned(),
        help: "Name a folder of frames, OUT/frames: of impact with record.every in the bed file, of simulate with --frames.".to_owned(),
    }
    };
    let entries = std::fs::read_dir(folder).map_err(|error| blame(&format!("cannot be read: {error}.")))?;
    let names = entries.flatten().map(|entry| entry.file_name().to_string_lossy().into_owned());
    let mut stems: Vec<String> =
        names.filter_map(|name| name.strip_suffix("-contacts.csv").map(str::to_owned)).collect();
    stems.sort_unstable();
    if stems.is_empty() {
        return Err(blame("holds no frames with contacts."));
    }
    let place = |stem: &String| ["grains", "contacts"].map(|what| folder.join(format!("{stem}-{what}.csv")));
    Ok(stems.iter().map(place).collect())
}

/// Which rows have a number that lies between two others.
fn within(table: &Table, name: &str, [from, to]: [f64; 2]) -> Result<Vec<bool>, TableError> {
    Ok(table.numbers(name)?.into_iter().map(|z| (from..=to).contains(&z)).collect())
}

fn of_frame(grains: &Path, contacts: &Path, period: Option<f64>, layer: Option<[f64; 2]>) -> Result<Named, TableError> {
    let mut bodies = Table::read(grains)?.swap_remove(0);
    if let Some(layer) = layer {
        let wanted = within(&bodies, "z", layer)?;
        bodies.retain(&wanted);
    }
    let (ids, kinds) = (bodies.labels("id")?, bodies.labels("kind")?);
    let of = ids.iter().zip(kinds).filter(|(_, kind)| *kind == "grain").map(|(id, _)| Label::of(id));
    let mut table = Table::read(contacts)?.swap_remove(0);
    let known: BTreeMap<Label, u32> = of.map(|label| (label, 0)).collect();
    let among = |label: &&str| known.contains_key(&Label::of(label));
    let wanted: Vec<bool> =
        table.labels("i")?.iter().zip(table.labels("j")?).map(|(i, j)| among(i) && among(&j)).collect();
    table.retain(&wanted);
    of_table(table, period, Some(known))
}

/// The network of the grains of one frame, by its two files.
///
/// # Errors
/// See [`TableError`].
pub fn read_frame([grains, contacts]: &[PathBuf; 2]) -> Result<Named, TableError> {
    of_frame(grains, contacts, None, None)
}

/// The columns with places.
const PLACES: [&str; 4] = ["x_i", "z_i", "x_j", "z_j"];

/// The network of a table, of these grains, or of those that it names.
fn of_table(mut table: Table, period: Option<f64>, all: Option<BTreeMap<Label, u32>>) -> Result<Named, TableError> {
    let tangential = |table: &Table| match table.has("tangential_N") {
        true => table.numbers("tangential_N"),
        false => Ok(vec![0.0; table.len()]),
    };
    let mut apart = 0;
    // A pair style's local compute lists all pairs within its cutoff, whether they touch or not.
    if table.dump {
        let (normal, along) = (table.numbers("normal_N")?, tangential(&table)?);
        let wanted: Vec<bool> = normal.iter().zip(&along).map(|(n, t)| *n != 0.0 || *t != 0.0).collect();
        apart = wanted.iter().filter(|&&wanted| !wanted).count();
        table.retain(&wanted);
    }
    let (first, second) = (table.labels("i")?, table.labels("j")?);
    let mut known = all.unwrap_or_default();
    for label in first.iter().chain(&second) {
        known.entry(Label::of(label)).or_insert(0);
    }
    known.values_mut().zip(0..).for_each(|(number, n)| *number = n);
    let (normal, along) = (table.numbers("normal_N")?, tangential(&table)?);
    let contacts: Vec<Contact> = (0..table.len())
        .map(|k| Contact {
            grains: [first[k], second[k]].map(|label| known[&Label::of(label)]),
            normal: normal[k],
            tangential: along[k],
        })
        .collect();
    let period = period.or(table.period);
    // Fabric, chains and stress are of the plane.
    let in_space = ["y_i", "y_j"].iter().filter(|name| table.has(name)).any(|name| {
        let across = table.numbers(name).unwrap_or_default();
        across.iter().any(|y| *y != across[0])
    });
    let branches = match !in_space && PLACES.iter().any(|name| table.has(name)) {
        false => None,
        true => {
            let [xi, zi, xj, zj] = PLACES.map(|name| table.numbers(name));
            let (xi, zi, xj, zj) = (xi?, zi?, xj?, zj?);
            let branch = |k: usize| Branch::between([xi[k], zi[k]], [xj[k], zj[k]], period);
            Some((0..table.len()).map(branch).collect())
        }
    };
    let names: Vec<String> = known.keys().map(Label::to_string).collect();
    let network = Network::new(names.len(), contacts, branches).map_err(|error| match error {
        NetworkError::Itself { contact } => {
            table.blame(contact, format!("grain {} touches itself.", first[contact]), "Leave the line out.")
        }
        NetworkError::Twice { first: one, second: two } => table.blame(
            two,
            format!("grains {} and {} touch in line {} already.", first[two], second[two], table.line(one)),
            "Give each contact once.",
        ),
        NetworkError::Centre { contact } => {
            table.blame(contact, "both grains have their centres in one place.", "Give the centres of the grains.")
        }
        // What is no number was found as it was read, and grains were counted here.
        error => table.blame(0, format!("{error}."), "Look at the numbers."),
    })?;
    Ok(Named { time: table.time, period, network, names, apart })
}

/// A grain's name: numbers by size, others behind them by the alphabet; 7 and 7.0 are the same.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Label {
    Number(i64),
    Word(String),
}

impl Label {
    fn of(text: &str) -> Self {
        let whole = |x: &f64| x.fract() == 0.0 && x.abs() < 9e15;
        match text.parse::<i64>() {
            Ok(number) => Self::Number(number),
            // Spreadsheets and data frames may write whole numbers so.
            Err(_) => match text.parse::<f64>().ok().filter(whole) {
                Some(number) => Self::Number(number as i64),
                None => Self::Word(text.to_owned()),
            },
        }
    }
}

impl std::fmt::Display for Label {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Number(number) => number.fmt(f),
            Self::Word(word) => word.fmt(f),
        }
    }
}
