//! The design's lens family as a few real parameters.

use std::sync::Arc;

use super::Study;
use crate::lens::Shape;
use crate::search::Painter;

impl Study {
    /// Apex row, back row and radius of the design's lens, each a number of about one: what the method `lens-family` searches.
    /// None where the design has no lens, or its material or the host may not be chosen.
    pub(super) fn painter(&self) -> Option<Painter> {
        let (design, request) = (&self.design, self.design.lens.as_ref()?);
        let lens =
            crate::lens::propose(&design.lattice, &design.host, request, &design.target, design.constants).ok()?;
        let letter = |name: &str| {
            let of = |&place: &u8| self.palette[usize::from(place)].name == name;
            self.letters.iter().position(of).map(|letter| letter as u8)
        };
        let (host, inside) = (letter(&design.host.name)?, letter(&request.material.name)?);
        let lattice = design.lattice;
        let sites: Vec<_> = self.free.iter().map(|&i| lattice.sites()[i]).collect();
        let [first, last] = [sites.first()?.row, sites.last()?.row];
        // Four rows, and a seventh of the curvature, to a standard deviation of one and a half.
        let rows = 8.0 / 3.0;
        let curvature = 0.1 / lens.radius;
        let start =
            vec![f64::from(lens.apex_row) / rows, f64::from(lens.back_row) / rows, 1.0 / (lens.radius * curvature)];
        let paint = move |x: &[f64]| {
            let row = |x: f64| (x * rows).round().clamp(f64::from(first), f64::from(last)) as u32;
            let (apex_row, back_row) = (row(x[0]), row(x[1]));
            // A curvature of nothing is a flat strip; one beyond a hemisphere has no more to give.
            let radius = 1.0 / (x[2] * curvature).clamp(1e-3 / lattice.half_width(), 2.0 / lattice.diameter());
            let shape = Shape { apex_row, back_row, radius };
            sites.iter().map(|site| if shape.contains(&lattice, site) { inside } else { host }).collect()
        };
        Some(Painter { start, spread: 1.5, paint: Arc::new(paint) })
    }
}
