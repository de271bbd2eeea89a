//! A look inside a lens under its impact: the rig of its whole sheet, both halves, followed from rest to the end of the window; what its force network is
//! like when the focal regions have most kinetic energy, and what the impact does to the crystal, as D²_min.

use crate::Context;
use crate::bed::Frame;
use crate::dem::rig::{Rig, RigStop, Simulation};
use crate::dem::steps_in;
use crate::design::Design;
use crate::export::{whole_crystal, whole_places};
use crate::layout::Layout;
use crate::motion::{self, RADIUS};
use crate::outcome::{Inside, Touch};
use crate::setup::Setup;

/// How often it is looked at in a window.
const LOOKS: u64 = 200;

/// Why there is no look inside.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum InsideError {
    /// There is no such rig.
    #[error("{0}")]
    Rig(String),
    /// A guard stopped the run, or the caller did.
    #[error("{0}")]
    Stopped(RigStop),
    /// A sheet so narrow that two spheres touch over both sides.
    #[error("the sheet is so narrow that spheres touch over both its sides")]
    Narrow,
}

/// The rig of the whole sheet of a layout under its design's impact, and its step (s).
///
/// # Errors
/// [`InsideError::Rig`].
pub fn rig(design: &Design, layout: &Layout) -> Result<(Rig<2>, f64), InsideError> {
    let Setup::Two(prepared) = Setup::of_layout(design, layout).map_err(|error| InsideError::Rig(error.to_string()))?
    else {
        return Err(InsideError::Rig("it is no sheet".to_owned()));
    };
    let mut rig = whole_crystal(layout, design.impact, design.law, design.constants);
    rig.laws = prepared.rig.laws;
    Ok((rig, prepared.plan.step))
}

/// Looks inside a layout whose lens lies in `lens`, its first and last row, over `window` (s).
///
/// # Errors
/// See [`InsideError`].
pub fn look(
    design: &Design,
    layout: &Layout,
    lens: [u32; 2],
    window: f64,
    context: &Context,
) -> Result<Inside, InsideError> {
    let (rig, step) = rig(design, layout)?;
    let spheres: Vec<(u32, bool)> =
        whole_places(&design.lattice).into_iter().map(|(site, is_image)| (site as u32, is_image)).collect();
    let focal_sites = design.target.on(&design.lattice).focal;
    let focal: Vec<usize> = (0..spheres.len()).filter(|&i| focal_sites.contains(&(spheres[i].0 as usize))).collect();
    let mut simulation = Simulation::new(rig, step).map_err(|error| InsideError::Rig(error.to_string()))?;
    let frame = |simulation: &Simulation<2>| Frame::of(simulation, [spheres.len(), 0]).unwrap_or_default();
    let first = frame(&simulation);
    let (mut most, mut best) = (-1.0, Frame::default());
    let steps = steps_in(window, step);
    let mut left = steps;
    while left > 0 {
        let some = (steps / LOOKS).clamp(1, left);
        left -= some;
        simulation.advance(some, context).map_err(InsideError::Stopped)?;
        let (view, mass) = (simulation.view(), &simulation.rig().mass);
        let energy = |&i: &usize| 0.5 * mass[i] * view.velocity(i).iter().map(|v| v * v).sum::<f64>();
        let kinetic: f64 = focal.iter().map(energy).sum();
        if kinetic > most {
            (most, best) = (kinetic, frame(&simulation));
        }
    }
    let last = frame(&simulation);
    let period = 2.0 * design.lattice.half_width();
    let radius = RADIUS * design.lattice.diameter();
    // A neighbourhood that meets itself round the sides says nothing.
    let locals = motion::follow(&first.places(), &last.places(), radius, Some(period)).unwrap_or_default();
    let own = locals.iter().zip(&spheres).filter(|(_, (_, is_image))| !is_image);
    let touch = |contact: &crate::bed::FrameContact| match contact.ends.map(|end| end.body()) {
        [Some(i), Some(k)] => Some(Touch(i as u32, k as u32, contact.normal, contact.tangential)),
        _ => None,
    };
    let mut inside = Inside {
        moment: best.time,
        until: last.time,
        period,
        places: best.places(),
        contacts: best.contacts.iter().filter_map(touch).collect(),
        parts: Vec::new(),
        d2min: own.map(|(local, _)| local.d2min).collect(),
        spheres,
    };
    let rows: Vec<u32> = design.lattice.sites().iter().map(|site| site.row).collect();
    let focus = design.target.foci.iter().map(|focus| focus.region.rows[1]).max().unwrap_or(0);
    let deepest = design.lattice.rows();
    inside.network(&rows, [1, deepest]).ok_or(InsideError::Narrow)?;
    let parts = [
        ("before the lens", [1, lens[0].saturating_sub(1)]),
        ("in it", lens),
        ("behind it", [lens[1] + 1, focus.max(lens[1]).min(deepest)]),
    ];
    let measured = parts.into_iter().filter(|(_, [first, last])| first <= last);
    inside.parts = measured.filter_map(|(name, span)| inside.measure(name, &rows, span)).collect();
    Ok(inside)
}
