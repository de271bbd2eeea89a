//! Rays through media that interfaces part, between mirror lines.

use nalgebra::Vector2;

use super::curve::{Curve, Meeting};
use super::fan::Optics;
use super::path::Path;
use super::snell::{Passage, TotalReflection, pass};

/// A curve with a medium on either side.
pub struct Interface {
    /// Where it is.
    pub curve: Box<dyn Curve>,
    /// Wave speeds (m/s) on its first and on its second side.
    pub speeds: [f64; 2],
    /// What it is called when a ray ends there: `front`, `back of lens 2`.
    pub name: String,
}

/// Media and interfaces between mirror lines x = 0 and x = half width, from row 1 (z = 0) to the last row.
///
/// The interfaces have to part the plane into media without contradiction: what is beyond one is what the next says it
/// is in front of it.
pub struct Scene {
    /// All interfaces.
    pub interfaces: Vec<Interface>,
    /// Wave speed at row 1 (m/s).
    pub speed: f64,
    /// Distance from the axis to the far mirror line (m).
    pub half_width: f64,
    /// Depth of the last row (m).
    pub end: f64,
    /// How many total reflections of a ray are followed; the next ends it.
    pub reflections: u32,
}

/// How a ray ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fate {
    /// It came to the last row.
    Arrived,
    /// It came back to row 1.
    Returned,
    /// The interface with this index reflects it totally, once more than is followed.
    Reflected(usize, TotalReflection),
    /// It runs along the interface with this index.
    Grazing(usize),
    /// It met more than a thousand interfaces and mirror lines.
    Trapped,
}

/// What a ray met.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// It passed the interface with this index.
    Passed(usize),
    /// The interface with this index reflected it totally.
    Reflected(usize),
    /// The mirror line at the axis or, if true, at the half width.
    Mirror(bool),
    /// Nothing: its way is curved, and this is a point of it.
    Bent,
}

/// A ray: its way, what it met at each inner corner, and its end.
#[derive(Clone, Debug, PartialEq)]
pub struct Trace {
    /// Corners and times.
    pub path: Path,
    /// What is at the corners between the first and the last.
    pub events: Vec<Event>,
    /// How it ended.
    pub fate: Fate,
}

/// More corners than that have no meaning for a wave.
const MOST_CORNERS: usize = 1000;

impl Scene {
    /// Follows a ray from any point (m) along a unit vector, through a medium of `speed` (m/s) at first.
    pub fn trace_from(&self, start: [f64; 2], direction: Vector2<f64>, speed: f64) -> Trace {
        // Nothing that the ray meets within this is not the place that it comes from.
        let least = 1e-9 * self.half_width;
        let (mut point, mut direction, mut speed) = (Vector2::from(start), direction, speed);
        let mut trace =
            Trace { path: Path { points: vec![start], times: vec![0.0] }, events: Vec::new(), fate: Fate::Trapped };
        let (mut time, mut reflections) = (0.0, 0);
        while trace.events.len() < MOST_CORNERS {
            let (border, side) = self.border(point, direction, least);
            let met = self.nearest(point, direction, least).filter(|(_, meeting)| meeting.distance <= border);
            let distance = met.map_or(border, |(_, meeting)| meeting.distance);
            point += direction * distance;
            time += distance / speed;
            if met.is_none() {
                // Exactly on the line, so that folding and crossings need no tolerance.
                match side {
                    Side::Axis => point.x = 0.0,
                    Side::Far => point.x = self.half_width,
                    Side::Start => point.y = 0.0,
                    Side::End => point.y = self.end,
                }
            }
            trace.path.points.push(point.into());
            trace.path.times.push(time);
            let Some((index, meeting)) = met else {
                match side {
                    Side::Start => trace.fate = Fate::Returned,
                    Side::End => trace.fate = Fate::Arrived,
                    Side::Axis | Side::Far => {
                        direction.x = -direction.x;
                        trace.events.push(Event::Mirror(matches!(side, Side::Far)));
                        continue;
                    }
                }
                return trace;
            };
            let [first, second] = self.interfaces[index].speeds;
            let speeds = if direction.dot(&meeting.normal) >= 0.0 { [first, second] } else { [second, first] };
            match pass(direction, meeting.normal, speeds[0], speeds[1]) {
                Passage::Refracted(onward) => {
                    (direction, speed) = (onward, speeds[1]);
                    trace.events.push(Event::Passed(index));
                }
                Passage::Reflected(onward, _) if reflections < self.reflections => {
                    direction = onward;
                    reflections += 1;
                    trace.events.push(Event::Reflected(index));
                }
                Passage::Reflected(_, total) => {
                    trace.fate = Fate::Reflected(index, total);
                    return trace;
                }
                Passage::Grazing(_) => {
                    trace.fate = Fate::Grazing(index);
                    return trace;
                }
            }
        }
        trace
    }

    /// Distance to the rim of the crystal, and which side of it is there.
    fn border(&self, point: Vector2<f64>, direction: Vector2<f64>, least: f64) -> (f64, Side) {
        let mut found = (f64::INFINITY, Side::End);
        for (from, along, to, side) in [
            (point.x, direction.x, 0.0, Side::Axis),
            (point.x, direction.x, self.half_width, Side::Far),
            (point.y, direction.y, 0.0, Side::Start),
            (point.y, direction.y, self.end, Side::End),
        ] {
            // Only a side that the ray goes towards: one that it starts from is behind it, however close.
            let towards = if matches!(side, Side::Axis | Side::Start) { along < 0.0 } else { along > 0.0 };
            let distance = ((to - from) / along).max(0.0);
            if towards && distance < found.0 {
                found = (distance, side);
            }
        }
        // A ray along neither axis always meets a side; the least way keeps rounding from standing still.
        (if found.0.is_finite() { found.0 } else { least }, found.1)
    }

    fn nearest(&self, point: Vector2<f64>, direction: Vector2<f64>, least: f64) -> Option<(usize, Meeting)> {
        let meetings = self.interfaces.iter().enumerate();
        meetings
            .filter_map(|(index, interface)| Some((index, interface.curve.meet(point, direction, least)?)))
            .min_by(|a, b| a.1.distance.total_cmp(&b.1.distance))
    }
}

impl Optics for Scene {
    fn trace(&self, x: f64) -> Trace {
        self.trace_from([x, 0.0], Vector2::y(), self.speed)
    }

    fn half_width(&self) -> f64 {
        self.half_width
    }

    fn failure(&self, fate: &Fate) -> Option<String> {
        let name = |index: &usize| self.interfaces[*index].name.as_str();
        Some(match fate {
            Fate::Arrived => return None,
            Fate::Returned => "came back to row 1".to_owned(),
            Fate::Reflected(index, total) => format!("ends at the {}: {total}", name(index)),
            Fate::Grazing(index) => format!("runs along the {}, met at the critical angle", name(index)),
            Fate::Trapped => format!("does not come out after {MOST_CORNERS} corners"),
        })
    }
}

#[derive(Clone, Copy)]
enum Side {
    Axis,
    Far,
    Start,
    End,
}

#[cfg(test)]
#[path = "scene_tests.rs"]
mod tests;
