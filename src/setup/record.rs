//! The section [record]: what is written, how often, and what is drawn.

use super::file::RecordFile;
use super::place::selection;
use crate::dem::rig::Arrival;
use crate::document::{DocumentError, Entry, Scope};
use crate::pattern::Selection;
use crate::units::Dimension;

/// What a run writes and draws.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordPlan {
    /// Steps between two samples.
    pub every: u64,
    /// Spheres of which a series over time is written.
    pub spheres: Vec<usize>,
    /// What is written of them.
    pub quantities: Vec<Quantity>,
    /// Whether all closed contacts are written at every sample.
    pub contacts: bool,
    /// First arrivals, each by its threshold.
    pub arrivals: Vec<Arrival>,
    /// What is drawn at the end.
    pub pictures: Vec<Picture>,
}

/// A vector of a sphere that can be written over time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Centre (m).
    Position,
    /// From where it lay (m).
    Displacement,
    /// Velocity (m/s).
    Velocity,
    /// Spin (rad/s).
    Spin,
    /// Net contact force (N).
    Force,
}

/// A picture drawn from a record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Picture {
    /// Mean velocity along the wave of each layer, over time.
    XT,
    /// Velocity along the wave of the recorded spheres.
    Velocities,
    /// Forces on flats.
    Flats,
    /// When the wave arrives at each sphere.
    Arrivals,
    /// Where the energy is and went.
    Energies,
}

impl Quantity {
    /// Names in files.
    pub const ALL: &'static [(&'static str, Self)] = &[
        ("position", Self::Position),
        ("displacement", Self::Displacement),
        ("velocity", Self::Velocity),
        ("spin", Self::Spin),
        ("force", Self::Force),
    ];
}

impl Picture {
    /// Names in files.
    pub const ALL: &'static [(&'static str, Self)] = &[
        ("x-t", Self::XT),
        ("velocities", Self::Velocities),
        ("flats", Self::Flats),
        ("arrivals", Self::Arrivals),
        ("energies", Self::Energies),
    ];

    /// Name in files.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(_, picture)| *picture == self).map_or("", |(name, _)| name)
    }
}

/// Samples in a window whose distance is not given.
const SAMPLES: u64 = 200;

/// Up to this number of spheres all are recorded where none are chosen.
const FEW: usize = 60;

/// What a run of `steps` steps of `step` (s) records where nothing is asked for.
pub(super) fn default<const D: usize>(steps: u64, spheres: usize, flats: usize) -> RecordPlan {
    let mut pictures = vec![Picture::XT, Picture::Energies];
    if spheres <= FEW {
        pictures.insert(1, Picture::Velocities);
    }
    if flats > 0 {
        pictures.push(Picture::Flats);
    }
    if D > 1 {
        pictures.push(Picture::Arrivals);
    }
    RecordPlan {
        every: (steps / SAMPLES).max(1),
        spheres: if spheres <= FEW { (0..spheres).collect() } else { Vec::new() },
        quantities: vec![Quantity::Displacement, Quantity::Velocity],
        contacts: false,
        arrivals: vec![Arrival::OwnMaximum(0.01)],
        pictures,
    }
}

/// Reads [record], over the defaults in `plan`; `chosen` tells which spheres a selection means.
pub(super) fn read<const D: usize>(
    scope: &Scope,
    file: &RecordFile,
    mut plan: RecordPlan,
    (step, diameter, layers): (f64, f64, u32),
    chosen: impl Fn(&Selection<D>) -> Vec<usize>,
) -> Result<RecordPlan, DocumentError> {
    if let Some(entry) = scope.optional("every", &file.every) {
        let steps = (entry.positive(Dimension::Time)? / step).round();
        if steps > 1e12 {
            return Err(entry.fail("is more than 1e12 steps", "Check its unit."));
        }
        plan.every = (steps as u64).max(1);
    }
    let keys = file.place();
    if [keys.layers, keys.columns, keys.x, keys.y, keys.z].iter().any(|key| key.is_some()) {
        plan.spheres = chosen(&selection(scope, keys, diameter, layers)?);
        if plan.spheres.is_empty() {
            return Err(scope.fail("means no sphere", "Widen layers, columns or places."));
        }
        if !plan.pictures.contains(&Picture::Velocities) {
            plan.pictures.insert(1, Picture::Velocities);
        }
    }
    if let Some(entry) = scope.optional("quantities", &file.quantities) {
        plan.quantities = listed(&entry, "quantity", Quantity::ALL)?;
    }
    if let Some(entry) = scope.optional("contacts", &file.contacts) {
        plan.contacts = entry.yes()?;
    }
    if let Some(entry) = scope.optional("arrivals", &file.arrivals) {
        plan.arrivals = entry.one_or_more().iter().map(arrival).collect::<Result<_, _>>()?;
    }
    if let Some(entry) = scope.optional("pictures", &file.pictures) {
        plan.pictures = listed(&entry, "picture", Picture::ALL)?;
    }
    Ok(plan)
}

fn listed<T: Copy + PartialEq>(entry: &Entry, what: &str, known: &[(&str, T)]) -> Result<Vec<T>, DocumentError> {
    let mut list = Vec::new();
    for item in entry.one_or_more() {
        let one = item.choice(what, known)?;
        if list.contains(&one) {
            return Err(item.fail("is named twice", "Keep it once."));
        }
        list.push(one);
    }
    Ok(list)
}

/// A threshold: `"1 %"` of a sphere's own greatest speed, `"1 % of first"` of the first sphere's, a speed or a distance.
fn arrival(entry: &Entry) -> Result<Arrival, DocumentError> {
    let text = entry.text()?;
    let positive = |value: f64| (value > 0.0).then_some(value);
    let part =
        |text: &str| Dimension::Fraction.parse(text).ok().filter(|part| (0.0..1.0).contains(part)).and_then(positive);
    let found = match text.strip_suffix("of first") {
        Some(of_first) => part(of_first).map(Arrival::FirstSphere),
        None => part(text)
            .map(Arrival::OwnMaximum)
            .or_else(|| Dimension::Speed.parse(text).ok().and_then(positive).map(Arrival::Speed))
            .or_else(|| Dimension::Length.parse(text).ok().and_then(positive).map(Arrival::Displacement)),
    };
    found.ok_or_else(|| {
        let help = "Write \"1 %\" of a sphere's greatest speed, \"1 % of first\" of the first sphere's, \"0.1 m/s\" or \"191 um\".";
        entry.fail("is no threshold of arrival", help)
    })
}
