//! What happens to contacts and bodies, written when it happens.
//!
//! The state is looked at after every step. A contact closes, opens or yields, and a peak is passed, at the step after which
//! that is seen (closed is what carries force); first arrivals lie between two steps. What must be remembered from step to step is the state of the contacts
//! closed now, which contacts have yielded, and three numbers of each body: it goes into checkpoints, so that a run that is
//! taken up writes the same lines.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use serde::{Deserialize, Serialize};

use super::RunError;
use super::streams::{Stream, append};
use super::tables::threshold_name;
use crate::dem::rig::{Arrival, Body, Touching, View};
use crate::setup::{Event, PreparedRig};

/// Name of the file.
pub(super) const FILE: &str = "events.csv";
/// Its first line.
pub(super) const HEADER: &str = "time_s,event,a,b,overlap_m,force_N,speed_m_s,dissipated_J,threshold";

/// What tells a contact from all others: its two bodies, flats counted after the spheres, and, for a sphere that meets its own
/// image, in which mirror.
type Key = [u32; 3];

/// A contact while it carries force.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Closed {
    key: Key,
    /// Greatest overlap (m) and force (N) since it closed.
    overlap: f64,
    force: f64,
    /// As of the last step: speed at which the overlap grows (m/s), and what the contact has dissipated (J).
    speed: f64,
    dissipated: f64,
}

/// A quantity that rises and falls.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Course {
    now: f64,
    rises: bool,
    /// Greatest peak so far.
    peak: f64,
}

impl Course {
    /// The value after another step; the one before it, if that was a peak above all before.
    fn follow(&mut self, value: f64) -> Option<f64> {
        let before = self.now;
        let peak = self.rises && value < before && before > self.peak;
        if peak {
            self.peak = before;
        }
        self.rises = value > before || (self.rises && value == before);
        self.now = value;
        peak.then_some(before)
    }
}

/// What is remembered from step to step.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct State {
    /// In order of their keys.
    closed: Vec<Closed>,
    yielded: BTreeSet<Key>,
    /// Of the net force, by sphere and then by flat, and of the speed, by sphere; empty where not asked for.
    force: Vec<Course>,
    speed: Vec<Course>,
    /// For each threshold and sphere the value before, NaN once it has been passed.
    before: Vec<Vec<f64>>,
}

/// A line to be written, in order of time.
struct Line {
    time: f64,
    event: Event,
    a: u32,
    b: Option<u32>,
    /// Overlap, force, speed, dissipated.
    values: [Option<f64>; 4],
    threshold: Option<usize>,
}

/// Sees what happens and writes it.
pub(super) struct Events {
    pub stream: Stream,
    pub state: State,
    kinds: Vec<Event>,
    /// For each sphere, then each flat, its name, where what happens to it is written.
    names: Vec<Option<String>>,
    /// For all bodies.
    all_names: Vec<String>,
    spheres: usize,
    /// Thresholds that do not wait for a greatest speed.
    thresholds: Vec<Arrival>,
    closed: Vec<Closed>,
    lines: Vec<Line>,
    row: String,
}

impl Events {
    /// Sees nothing yet; `state` is that of the beginning, or of a checkpoint.
    pub fn new<const D: usize>(prepared: &PreparedRig<D>, stream: Stream, state: Option<State>) -> Self {
        let (spheres, flats) = (prepared.rig.sample.spheres.len(), prepared.rig.flats.len());
        let record = &prepared.record;
        let all_names = prepared.labels().names().to_vec();
        // What happens to an intruder is told by its contacts, and over time in a table of its own.
        let of_all = |place: usize| record.events_of_all && (place < prepared.sites.len() || place >= spheres);
        let meant = |place: usize| of_all(place) || record.spheres.binary_search(&place).is_ok();
        let names = all_names.iter().enumerate().map(|(k, name)| meant(k).then(|| name.clone())).collect();
        let kinds = record.events.clone();
        let when = |kind: Event, count: usize| if kinds.contains(&kind) { count } else { 0 };
        let thresholds: Vec<Arrival> = match kinds.contains(&Event::Arrives) {
            true => record.arrivals.iter().copied().filter(|arrival| arrival.is_absolute()).collect(),
            false => Vec::new(),
        };
        let state = state.unwrap_or_else(|| State {
            force: vec![Course::default(); when(Event::ForcePeak, spheres + flats)],
            speed: vec![Course::default(); when(Event::SpeedPeak, spheres)],
            before: vec![vec![0.0; spheres]; thresholds.len()],
            ..State::default()
        });
        Self {
            stream,
            state,
            kinds,
            names,
            all_names,
            spheres,
            thresholds,
            closed: Vec::new(),
            lines: Vec::new(),
            row: String::new(),
        }
    }

    /// Takes note of how things stand at the start, which is no event.
    pub fn begin<const D: usize>(&mut self, view: &View<'_, D>) {
        self.look_at_contacts(view);
        self.look_at_bodies(view, 0.0);
        self.lines.clear();
    }

    /// Looks at the state after a step (s) and writes what has happened.
    pub fn see<const D: usize>(&mut self, view: &View<'_, D>, step: f64) -> Result<(), RunError> {
        self.look_at_contacts(view);
        self.look_at_bodies(view, step);
        self.look_at_arrivals(view, step);
        // Peaks are of the step before, arrivals lie between the two.
        self.lines.sort_by(|a, b| a.time.total_cmp(&b.time));
        for line in self.lines.drain(..) {
            let row = &mut self.row;
            row.clear();
            let name = |body: u32| self.all_names[body as usize].as_str();
            let _ = write!(row, "{:?},{},{},{}", line.time, line.event.name(), name(line.a), line.b.map_or("", name));
            for value in line.values {
                match value {
                    Some(value) => append(row, [value]),
                    None => row.push(','),
                }
            }
            let threshold = line.threshold.map_or(String::new(), |k| threshold_name(self.thresholds[k]));
            let _ = write!(row, ",{threshold}");
            self.stream.line(row)?;
        }
        Ok(())
    }

    fn look_at_contacts<const D: usize>(&mut self, view: &View<'_, D>) {
        let of_contacts = [Event::Closes, Event::Opens, Event::Yields];
        if !of_contacts.iter().any(|kind| self.kinds.contains(kind)) {
            return;
        }
        let time = view.time();
        let Self { state, kinds, names, lines, closed, spheres, .. } = self;
        let meant = |key: &Key| key[..2].iter().any(|&body| names[body as usize].is_some());
        let mut tell = |event: Event, contact: &Closed, values: [f64; 4]| {
            if kinds.contains(&event) && meant(&contact.key) {
                let [a, b, _] = contact.key;
                lines.push(Line { time, event, a, b: Some(b), values: values.map(Some), threshold: None });
            }
        };
        closed.clear();
        // A contact that yielded parts before its spheres, taken as round, do: where it ceases to carry force.
        for touching in view.contacts().filter(|touching| touching.force != 0.0) {
            let Touching { overlap, force, closing_speed: speed, dissipated, .. } = touching;
            let contact = Closed { key: key(&touching, *spheres), overlap, force, speed, dissipated };
            if touching.yields && state.yielded.insert(contact.key) {
                tell(Event::Yields, &contact, [overlap, force, speed, dissipated]);
            }
            closed.push(contact);
        }
        closed.sort_by_key(|contact| contact.key);
        // Both lists are in order of their keys: one walk through both.
        let mut old = state.closed.iter().peekable();
        for contact in &mut *closed {
            while let Some(gone) = old.next_if(|old| old.key < contact.key) {
                tell(Event::Opens, gone, [gone.overlap, gone.force, gone.speed, gone.dissipated]);
            }
            match old.next_if(|old| old.key == contact.key) {
                Some(before) => {
                    contact.overlap = contact.overlap.max(before.overlap);
                    contact.force = contact.force.max(before.force);
                }
                None => {
                    tell(Event::Closes, contact, [contact.overlap, contact.force, contact.speed, contact.dissipated])
                }
            }
        }
        for gone in old {
            tell(Event::Opens, gone, [gone.overlap, gone.force, gone.speed, gone.dissipated]);
        }
        std::mem::swap(&mut state.closed, closed);
    }

    fn look_at_bodies<const D: usize>(&mut self, view: &View<'_, D>, step: f64) {
        let time = view.time() - step;
        let Self { state, names, lines, spheres, .. } = self;
        let mut tell = |event: Event, body: usize, values: [Option<f64>; 4]| {
            if names[body].is_some() {
                lines.push(Line { time, event, a: body as u32, b: None, values, threshold: None });
            }
        };
        for (body, course) in state.force.iter_mut().enumerate() {
            let force = match body.checked_sub(*spheres) {
                Some(flat) => size(&view.flat(flat).force),
                None => view.net_force_size(body),
            };
            if let Some(peak) = course.follow(force) {
                tell(Event::ForcePeak, body, [None, Some(peak), None, None]);
            }
        }
        for (sphere, course) in state.speed.iter_mut().enumerate() {
            if let Some(peak) = course.follow(size(&view.velocity(sphere))) {
                tell(Event::SpeedPeak, sphere, [None, None, Some(peak), None]);
            }
        }
    }

    fn look_at_arrivals<const D: usize>(&mut self, view: &View<'_, D>, step: f64) {
        let Self { state, names, lines, thresholds, .. } = self;
        for (k, (arrival, before)) in thresholds.iter().zip(&mut state.before).enumerate() {
            let (Arrival::Speed(threshold) | Arrival::Displacement(threshold)) = *arrival else { continue };
            for (i, before) in before.iter_mut().enumerate().filter(|(_, before)| !before.is_nan()) {
                let value = measured(*arrival, view, i);
                if value < threshold {
                    *before = value;
                    continue;
                }
                // Linear between steps, as in the table of spheres.
                let time = view.time() - step * (value - threshold) / (value - *before);
                *before = f64::NAN;
                if names[i].is_some() {
                    let speed = Some(size(&view.velocity(i)));
                    let values = [None, None, speed, None];
                    lines.push(Line { time, event: Event::Arrives, a: i as u32, b: None, values, threshold: Some(k) });
                }
            }
        }
    }
}

/// What a threshold of this kind asks for: speed (m/s), or how far the sphere has moved (m).
fn measured<const D: usize>(arrival: Arrival, view: &View<'_, D>, sphere: usize) -> f64 {
    match arrival {
        Arrival::Displacement(_) => size(&view.displacement(sphere)),
        _ => size(&view.velocity(sphere)),
    }
}

fn size<const D: usize>(vector: &[f64; D]) -> f64 {
    vector.iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn key<const D: usize>(touching: &Touching<D>, spheres: usize) -> Key {
    let number = |body: Body| match body {
        Body::Sphere(i) => i as u32,
        Body::Flat(k) => (spheres + k) as u32,
    };
    let [a, b] = touching.bodies.map(number);
    // The normal tells the mirrors of one sphere apart.
    let mirror = if a == b {
        (0..D)
            .map(|k| (2 * k + usize::from(touching.normal[k] > 0.0), touching.normal[k].abs()))
            .fold((0, 0.0), |most, side| if side.1 > most.1 { side } else { most })
    } else {
        (0, 0.0)
    };
    [a, b, mirror.0 as u32]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A plateau counts once, when it is left; a lower peak after a higher one does not.
    #[test]
    fn peaks_are_those_above_all_before() {
        let mut course = Course::default();
        let peaks: Vec<Option<f64>> =
            [0.0, 1.0, 3.0, 3.0, 2.0, 2.5, 1.0, 4.0, 5.0].into_iter().map(|value| course.follow(value)).collect();
        let mut expected = vec![None; 9];
        expected[4] = Some(3.0);
        assert_eq!(peaks, expected);
        assert_eq!(course.follow(0.0), Some(5.0));
    }
}
