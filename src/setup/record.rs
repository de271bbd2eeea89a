//! The sections [record] and [[region]]: what is written, how often, and what is drawn.

use super::file::{RecordFile, RegionFile};
use super::place::selection;
use crate::dem::rig::Arrival;
use crate::document::{DocumentError, Entry, Scope, is_plain_name};
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
    /// Which closed contacts are written at every sample.
    pub contacts: Contacts,
    /// Whether every body and contact is kept at every sample, as two files that `network`, `motion` and `export` read.
    pub frames: bool,
    /// Parts of the crystal of which sums are written.
    pub regions: Vec<Region>,
    /// What is written when it happens.
    pub events: Vec<Event>,
    /// Whether events of all bodies are written, or only those of `spheres`.
    pub events_of_all: bool,
    /// First arrivals, each by its threshold.
    pub arrivals: Vec<Arrival>,
    /// What is drawn at the end.
    pub pictures: Vec<Picture>,
}

/// Which contacts are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Contacts {
    /// None.
    None,
    /// Those of the spheres whose motion is written.
    Chosen,
    /// All.
    All,
}

/// A part of the crystal.
#[derive(Clone, Debug, PartialEq)]
pub struct Region {
    /// Its name, fit for the heads of columns.
    pub name: String,
    /// Its spheres.
    pub spheres: Vec<usize>,
}

/// What happens to a contact or a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// A contact begins to carry force.
    Closes,
    /// A contact ceases to carry force.
    Opens,
    /// A contact yields for the first time.
    Yields,
    /// A sphere is reached, by each absolute threshold of the record.
    Arrives,
    /// The net force on a sphere or flat has passed a peak above all before.
    ForcePeak,
    /// The speed of a sphere has passed a peak above all before.
    SpeedPeak,
}

impl Event {
    /// Names in files.
    pub const ALL: &'static [(&'static str, Self)] = &[
        ("closes", Self::Closes),
        ("opens", Self::Opens),
        ("yields", Self::Yields),
        ("arrives", Self::Arrives),
        ("force-peak", Self::ForcePeak),
        ("speed-peak", Self::SpeedPeak),
    ];

    /// Name in files.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(_, event)| *event == self).map_or("", |(name, _)| name)
    }
}

/// What can be written of a sphere over time.
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
    /// Greatest speed (m/s) and net contact force (N) so far.
    Maxima,
    /// What its contacts have taken from it so far (J): half of each, all at flats.
    Dissipated,
}

/// A picture drawn from a record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Picture {
    /// Mean velocity along the wave of each layer, over time.
    XT,
    /// Its spectrum, over wave number and frequency.
    Spectrum,
    /// Velocity along the wave of the recorded spheres.
    Velocities,
    /// Forces on flats and intruders.
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
        ("maxima", Self::Maxima),
        ("dissipated", Self::Dissipated),
    ];
}

impl Picture {
    /// Names in files.
    pub const ALL: &'static [(&'static str, Self)] = &[
        ("x-t", Self::XT),
        ("spectrum", Self::Spectrum),
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

/// What there is in place of frames in space.
pub const SPACE: &str =
    "Ask for record.quantities and record.contacts = true: spheres.csv and contacts.csv then hold the same.";

/// Samples in a window whose distance is not given.
const SAMPLES: u64 = 200;

/// Up to this number of spheres all are recorded where none are chosen.
const FEW: usize = 60;

/// What a run of `steps` steps of `step` (s) records where nothing is asked for.
pub(super) fn default<const D: usize>(steps: u64, spheres: usize, pressed: usize) -> RecordPlan {
    let mut pictures = vec![Picture::XT, Picture::Energies];
    if spheres <= FEW {
        pictures.insert(1, Picture::Velocities);
    }
    if pressed > 0 {
        pictures.push(Picture::Flats);
    }
    if D > 1 {
        pictures.push(Picture::Arrivals);
    }
    RecordPlan {
        every: (steps / SAMPLES).max(1),
        spheres: if spheres <= FEW { (0..spheres).collect() } else { Vec::new() },
        quantities: vec![Quantity::Displacement, Quantity::Velocity],
        contacts: Contacts::None,
        frames: false,
        regions: Vec::new(),
        events: Vec::new(),
        events_of_all: true,
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
        plan.contacts = match entry.text() {
            Ok(_) => entry.choice("choice of contacts", &[("all", Contacts::All), ("chosen", Contacts::Chosen)])?,
            Err(_) if entry.yes()? => Contacts::All,
            Err(_) => Contacts::None,
        };
        if plan.contacts == Contacts::Chosen && plan.spheres.is_empty() {
            return Err(entry.fail("means no sphere", "Choose spheres by record.layers, columns, x, y or z."));
        }
    }
    if let Some(entry) = scope.optional("frames", &file.frames) {
        plan.frames = entry.yes()?;
        if plan.frames && D == 3 {
            return Err(entry.fail("keeps frames of chains and sheets, and this crystal is in space", SPACE));
        }
    }
    if let Some(entry) = scope.optional("arrivals", &file.arrivals) {
        plan.arrivals = entry.one_or_more().iter().map(arrival).collect::<Result<_, _>>()?;
    }
    if let Some(entry) = scope.optional("events", &file.events) {
        plan.events = listed(&entry, "event", Event::ALL)?;
        if plan.events.contains(&Event::Arrives) && !plan.arrivals.iter().any(|arrival| arrival.is_absolute()) {
            let help = "Add a speed or a distance to record.arrivals, like \"0.1 m/s\" or \"191 um\"; parts of a greatest \
                        speed are known only at the end, and stand in spheres-final.csv.";
            return Err(entry.fail("asks for arrivals that are known when they happen, and none is", help));
        }
    }
    if let Some(entry) = scope.optional("events_of", &file.events_of) {
        plan.events_of_all = entry.choice("choice of bodies", &[("all", true), ("chosen", false)])?;
        if !plan.events_of_all && plan.spheres.is_empty() {
            return Err(entry.fail("means no sphere", "Choose spheres by record.layers, columns, x, y or z."));
        }
    }
    if let Some(entry) = scope.optional("pictures", &file.pictures) {
        plan.pictures = listed(&entry, "picture", Picture::ALL)?;
    }
    Ok(plan)
}

/// Reads the sections [[region]].
pub(super) fn regions<const D: usize>(
    sections: &[(Scope, &RegionFile)],
    (diameter, layers): (f64, u32),
    chosen: impl Fn(&Selection<D>) -> Vec<usize>,
) -> Result<Vec<Region>, DocumentError> {
    let mut regions: Vec<Region> = Vec::new();
    for (scope, file) in sections {
        let name = scope.required("name", &file.name)?;
        if !is_plain_name(name.text()?) {
            return Err(name.refuse("must be 1 to 100 letters (a to z), digits, - and _"));
        }
        if regions.iter().any(|region| name.text().is_ok_and(|name| region.name == name)) {
            return Err(name.fail("is the name of another region", "Choose another name."));
        }
        let spheres = chosen(&selection(scope, file.place(), diameter, layers)?);
        if spheres.is_empty() {
            return Err(scope.fail("means no sphere", "Widen layers, columns or places."));
        }
        regions.push(Region { name: name.text()?.to_owned(), spheres });
    }
    Ok(regions)
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
