//! Geometric rays: Snell's law at interfaces of any shape, paths, arrival times, and what a fan of rays makes together.
//!
//! Points are (x, z), distance from the axis and depth, in metres. The rays of an impact start at row 1 (z = 0) along +z, as
//! its plane wave does, are reflected at the mirror lines x = 0 and x = half width, and end at the last row. An interface
//! refracts or reflects totally: what part of the wave it reflects below the critical angle is not considered, nor that the
//! wave slows down as it decays.
//!
//! - `snell`: what happens at an interface, as types: [`Passage`], never NaN
//! - `curve`: interfaces: straight, circular, conic, polylines, and any curve z(x) by bracketing
//! - `scene`: media and interfaces; a ray through all of them, with its [`Fate`]
//! - `slab`: a flat slab whose speed changes across it
//! - `fan`: many rays together: spot, caustic, wavefronts
//! - `eikonal`: first arrivals on the lattice, without rays; `mesh`: the points they are found at
//! - `path`: the way of one ray
//! - `plano_convex`: the plano-convex lens by itself, for searches
//! - `vector`: points and directions

mod plano_convex;
mod curve;
mod eikonal;
mod fan;
mod mesh;
mod path;
mod scene;
mod slab;
mod snell;
mod vector;

pub use curve::{Circle, Conic, Curve, Graph, Meeting, Polyline, Segment};
pub use eikonal::Eikonal;
pub use fan::{Optics, Spot, caustic, fan, fan_between, least_spot, spot, starts, wavefront};
pub use path::Path;
pub use plano_convex::{Face, PlanoConvex, Reason, Stray, enter, leave};
pub use scene::{Event, Fate, Interface, Scene, Trace};
pub use slab::Slab;
pub use snell::{Passage, TotalReflection, pass, reflect, refract};
pub use vector::Vector2;
