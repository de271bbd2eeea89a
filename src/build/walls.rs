//! What the frame's walls change, by simulation: the whole piece between walls, beside the half between its mirrors.
//!
//! A mirror line cuts through the outermost spheres of every other row; a wall cannot, and touches these spheres from outside. Rows
//! between end half a diameter before it. Both are simulated as rigs that find their contacts, so that nothing but the walls differs.

use rayon::prelude::*;
use serde::Serialize;

use crate::Context;
use crate::design::Design;
use crate::evaluate::{Frame, HeldError, ImpactLoad, Plan, Subject, held_energies, held_spheres};
use crate::score::{means, ratio};

/// F, P and C of one way of holding the piece.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WallEffect {
    /// What holds it, in words.
    pub held: &'static str,
    /// F (J)
    #[serde(rename = "focal_mean_J")]
    pub focal_mean: f64,
    /// P (J)
    #[serde(rename = "protected_mean_J")]
    pub protected_mean: f64,
    /// C = F/P
    pub contrast: Option<f64>,
}

/// The piece between side walls, and with an end wall too; then as it was designed, between mirrors and with a free end.
///
/// # Errors
/// See [`HeldError`].
pub fn in_walls(
    design: &Design,
    subject: Subject<'_>,
    plan: &Plan,
    context: &Context,
) -> Result<Vec<WallEffect>, HeldError> {
    let walls = |end_gap| Frame::Walls { side_gap: 0.0, end_gap };
    let ways = [
        ("mirrors, end free", Frame::Mirrors),
        ("side walls, end free", walls(None)),
        ("side walls and end wall", walls(Some(0.0))),
    ];
    let load = ImpactLoad::from(design.impact);
    ways.into_par_iter()
        .map(|(held, frame)| {
            let spheres = held_spheres(subject);
            let energies =
                held_energies((design, plan), &subject.layout.palette, spheres, (frame, &load, None), context)?;
            let [focal_mean, protected_mean] = means(&energies, &design.lattice, &design.target);
            Ok(WallEffect { held, focal_mean, protected_mean, contrast: ratio(focal_mean, protected_mean) })
        })
        .collect()
}
