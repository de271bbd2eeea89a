//! In how many dimensions spheres move.
//!
//! The loops that move them take minutes to compile, and what is generic is compiled anew in every crate that calls it. So they are compiled here, once for each
//! number of dimensions, and who is generic in it reaches them by a trait.

use super::batch::SideBySide;
use super::impact::Struck;
use super::rig::Driven;

/// Those that [`MoveIn`] is said of.
pub enum Spheres {}

/// `Spheres: MoveIn<D>`: that there is what moves spheres in `D` dimensions. It is there for one, two and three, and asked for by what begins a simulation.
#[diagnostic::on_unimplemented(
    message = "spheres are not known to move in `{D}` dimensions",
    note = "they move in one, two and three; what is generic asks for it by `where Spheres: MoveIn<D>`"
)]
pub trait MoveIn<const D: usize>: Struck<D> + SideBySide<D> + Driven<D> {
    /// What there is in any dimension, where this is one in space.
    fn in_space<T: InAny>(_of: &T::In<D>) -> Option<&T::In<3>> {
        None
    }
}

/// A type that there is in any number of dimensions.
pub trait InAny {
    /// In `D`.
    type In<const D: usize>;
}

impl MoveIn<1> for Spheres {}
impl MoveIn<2> for Spheres {}
impl MoveIn<3> for Spheres {
    fn in_space<T: InAny>(of: &T::In<3>) -> Option<&T::In<3>> {
        Some(of)
    }
}
