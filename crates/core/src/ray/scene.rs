//! Rays through media that interfaces part, between mirror lines.

use crate::ray::Vector2;

use super::curve::{Curve, Meeting};
use super::fan::Optics;
use super::path::{Path, across};
use super::snell::{Passage, TotalReflection, pass};

/// A curve with a medium on either side.
pub struct Interface {
    /// Where it is.
    pub curve: Box<dyn Curve>,
    /// Wave speeds (m/s) on its first and on its second side.
    pub speeds: [f64; 2],
    /// What it is called when a ray ends there: `front`, `back of lens 2`.
    pub name: String,
    /// Depths (m) beyond which it is not.
    depths: [f64; 2],
}

impl Interface {
    /// A curve with its speeds (m/s) on either side, and its name.
    pub fn new(curve: Box<dyn Curve>, speeds: [f64; 2], name: impl Into<String>) -> Self {
        Self { depths: curve.depths(), curve, speeds, name: name.into() }
    }
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

/// A ray under way.
struct Walk {
    point: Vector2,
    direction: Vector2,
    speed: f64,
    /// Total reflections so far.
    reflections: u32,
}

impl Walk {
    /// Goes to the next corner: how far that is (m), and what is there, or how the ray ends there.
    fn on(&mut self, scene: &Scene, least: f64) -> (f64, Result<Event, Fate>) {
        let (border, side) = scene.border(self.point, self.direction, least);
        let met = scene.nearest(self.point, self.direction, least, border);
        let distance = met.map_or(border, |(_, meeting)| meeting.distance);
        self.point += self.direction * distance;
        let Some((index, meeting)) = met else {
            // Exactly on the line, so that folding and crossings need no tolerance.
            let event = match side {
                Side::Axis | Side::Far => {
                    let far = matches!(side, Side::Far);
                    self.point.x = if far { scene.half_width } else { 0.0 };
                    self.direction.x = -self.direction.x;
                    Ok(Event::Mirror(far))
                }
                Side::Start => {
                    self.point.y = 0.0;
                    Err(Fate::Returned)
                }
                Side::End => {
                    self.point.y = scene.end;
                    Err(Fate::Arrived)
                }
            };
            return (distance, event);
        };
        let [first, second] = scene.interfaces[index].speeds;
        let speeds = if self.direction.dot(&meeting.normal) >= 0.0 { [first, second] } else { [second, first] };
        let event = match pass(self.direction, meeting.normal, speeds[0], speeds[1]) {
            Passage::Refracted(onward) => {
                (self.direction, self.speed) = (onward, speeds[1]);
                Ok(Event::Passed(index))
            }
            Passage::Reflected(onward, _) if self.reflections < scene.reflections => {
                self.direction = onward;
                self.reflections += 1;
                Ok(Event::Reflected(index))
            }
            Passage::Reflected(_, total) => Err(Fate::Reflected(index, total)),
            Passage::Grazing(_) => Err(Fate::Grazing(index)),
        };
        (distance, event)
    }
}

impl Scene {
    /// Nothing that a ray meets within this (m) is not the place that it comes from.
    fn least(&self) -> f64 {
        1e-9 * self.half_width
    }

    /// Follows a ray from any point (m) along a unit vector, through a medium of `speed` (m/s) at first.
    pub fn trace_from(&self, start: [f64; 2], direction: Vector2, speed: f64) -> Trace {
        let least = self.least();
        let mut walk = Walk { point: Vector2::from(start), direction, speed, reflections: 0 };
        // Few rays have more corners than two lenses and two mirror lines make.
        let mut trace = Trace { path: Path::from(start, 8), events: Vec::with_capacity(6), fate: Fate::Trapped };
        let mut time = 0.0;
        while trace.events.len() < MOST_CORNERS {
            let speed = walk.speed;
            let (distance, event) = walk.on(self, least);
            time += distance / speed;
            trace.path.points.push(walk.point.into());
            trace.path.times.push(time);
            match event {
                Ok(event) => trace.events.push(event),
                Err(fate) => {
                    trace.fate = fate;
                    return trace;
                }
            }
        }
        trace
    }

    /// The same as far as the ray first passes `depth` (m) on its way down: its distance from the axis (m) there. What it meets until
    /// then is added to `met`.
    pub(super) fn landing_from(
        &self,
        start: [f64; 2],
        direction: Vector2,
        depth: f64,
        met: &mut Vec<Event>,
    ) -> Option<f64> {
        let least = self.least();
        let mut walk = Walk { point: Vector2::from(start), direction, speed: self.speed, reflections: 0 };
        for _ in 0..=MOST_CORNERS {
            let from = walk.point;
            let (_, event) = walk.on(self, least);
            if let Some(x) = across([from.into(), walk.point.into()], depth) {
                return Some(x);
            }
            met.push(event.ok()?);
        }
        None
    }

    /// Distance to the rim of the crystal, and which side of it is there.
    fn border(&self, point: Vector2, direction: Vector2, least: f64) -> (f64, Side) {
        let mut found = (f64::INFINITY, Side::End);
        // Only a side that the ray goes towards: one that it starts from is behind it, however close.
        for (from, along, [low, high], sides) in [
            (point.x, direction.x, [0.0, self.half_width], [Side::Axis, Side::Far]),
            (point.y, direction.y, [0.0, self.end], [Side::Start, Side::End]),
        ] {
            if along != 0.0 {
                let (to, side) = if along < 0.0 { (low, sides[0]) } else { (high, sides[1]) };
                let distance = ((to - from) / along).max(0.0);
                if distance < found.0 {
                    found = (distance, side);
                }
            }
        }
        // A ray along neither axis always meets a side; the least way keeps rounding from standing still.
        (if found.0.is_finite() { found.0 } else { least }, found.1)
    }

    /// The nearest interface that the ray meets, if it does within `most` (m).
    fn nearest(&self, point: Vector2, direction: Vector2, least: f64, most: f64) -> Option<(usize, Meeting)> {
        let mut found: Option<(usize, Meeting)> = None;
        let mut end = point.y + direction.y * most;
        for (index, interface) in self.interfaces.iter().enumerate() {
            // Most are above or below the way that is left.
            if point.y.max(end) < interface.depths[0] || point.y.min(end) > interface.depths[1] {
                continue;
            }
            if let Some(meeting) = interface.curve.meet(point, direction, least)
                && meeting.distance <= most
                && found.is_none_or(|(_, nearest)| meeting.distance < nearest.distance)
            {
                found = Some((index, meeting));
                end = point.y + direction.y * meeting.distance;
            }
        }
        found
    }
}

impl Optics for Scene {
    fn trace(&self, x: f64) -> Trace {
        self.trace_from([x, 0.0], Vector2::y(), self.speed)
    }

    fn landing(&self, x: f64, depth: f64, met: &mut Vec<Event>) -> Option<f64> {
        met.clear();
        self.landing_from([x, 0.0], Vector2::y(), depth, met)
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
