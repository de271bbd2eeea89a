//! The design's lens family as a few real parameters.

use std::sync::Arc;

use super::Study;
use crate::evaluate::Glance;
use crate::lens::{Lens, LensRequest, propose};
use crate::material::Material;
use crate::search::Painter;

/// Rows to a unit of the parameters.
const ROWS: f64 = 8.0 / 3.0;

/// Distance of the lens's axis to a unit (diameters of spheres).
const AXIS: f64 = 2.0;

/// First standard deviation of every parameter: some four rows, three diameters, 15 % of the curvature.
const SPREAD: f64 = 1.5;

impl Study {
    /// First row, last row, curvature and place of the design's lens, each a number of about one: what the method `lens-family`
    /// searches. Where the family has no curvature or no axis of its own these do nothing. None where the design has no lens,
    /// or a material that its lenses are made of may not be chosen.
    pub(super) fn painter(&self) -> Option<Painter> {
        let (design, request) = (self.design.clone(), self.design.lens.clone()?);
        let lens = propose(&design.lattice, &design.host, &request, &design.target, design.constants).ok()?;
        let letter = |material: &Material| {
            let of = |&place: &u8| self.palette[usize::from(place)] == *material;
            self.letters.iter().position(of).map(|letter| letter as u8)
        };
        // Letters by the place of a material in a lens's palette.
        let letters: Vec<u8> = lens.palette.iter().map(letter).collect::<Option<_>>()?;
        let host = letters[0];
        let free = self.free.clone();
        let sites = design.lattice.sites();
        let [first, last] = [sites[*free.first()?].row, sites[*free.last()?].row];
        let curvature = lens.radius.map_or(1.0, |radius| 0.1 / radius);
        let diameter = design.lattice.diameter();
        let start = vec![
            f64::from(lens.apex_row) / ROWS,
            f64::from(lens.back_row) / ROWS,
            lens.radius.map_or(0.0, |radius| 1.0 / (radius * curvature)),
            lens.axis / (AXIS * diameter),
        ];
        let has_radius = lens.radius.is_some();
        // Of the rows and the axis what there is; a quarter of the design's curvature to four times as much.
        let rows = [f64::from(first) / ROWS, f64::from(last) / ROWS];
        let bent = if has_radius { [start[2] / 4.0, start[2] * 4.0] } else { [-1.0, 1.0] };
        let bounds = vec![rows, rows, bent, [0.0, design.lattice.half_width() / (AXIS * diameter)]];
        let paint = move |x: &[f64]| {
            let row = |x: f64| (x * ROWS).round().clamp(f64::from(first), f64::from(last)) as u32;
            // Half the width of the crystal bends nothing, and a sphere's own radius is as round as it gets.
            let bent = (x[2] * curvature).clamp(1e-2 / design.lattice.half_width(), 2.0 / diameter);
            let wanted = LensRequest {
                apex_row: Some(row(x[0])),
                back_row: Some(row(x[1])),
                radius: has_radius.then(|| 1.0 / bent),
                axis: request
                    .family
                    .has_axis()
                    .then(|| (x[3] * AXIS * diameter).clamp(0.0, design.lattice.half_width())),
                rows: [first, last],
                ..request.clone()
            };
            // A lens that cannot be is no lens.
            let lens = propose(&design.lattice, &design.host, &wanted, &design.target, design.constants).ok();
            let place = |lens: &Lens, i: usize| letters.get(usize::from(lens.materials[i])).copied().unwrap_or(host);
            free.iter().map(|&i| lens.as_ref().map_or(host, |lens| place(lens, i))).collect()
        };
        let study = self.clone();
        let guess = move |choice: &[u8]| Glance::Bound.delay(&study.design, &study.layout(choice));
        Some(Painter { start, spread: SPREAD, bounds, paint: Arc::new(paint), guess: Some(Arc::new(guess)) })
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    /// The repository's study: its start is the design's lens, and a longer one has more spheres.
    #[test]
    fn the_first_parameters_paint_the_designs_lens() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("studies/two-materials.toml");
        let study = Study::read(&path, None).unwrap();
        let painter = study.painter().unwrap();
        let painted = (painter.paint)(&painter.start);
        assert_eq!(painted, study.first()[0]);
        assert!(painter.start.iter().zip(&painter.bounds).all(|(x, [from, to])| (from..=to).contains(&x)));
        // The wave is late behind the lens, and as late everywhere behind none.
        let guess = painter.guess.clone().unwrap();
        assert!(guess(&painted) > 1e-6 && guess(&vec![0; painted.len()]).abs() < 1e-12);
        let mut longer = painter.start.clone();
        longer[1] += 3.0 / ROWS;
        let count = |choice: &[u8]| choice.iter().filter(|&&letter| letter != 0).count();
        assert!(count(&(painter.paint)(&longer)) > count(&painted) + 30);
        // Parameters out of all bounds still paint something.
        for x in [-1e9, 1e9] {
            assert_eq!((painter.paint)(&[x; 4]).len(), painted.len());
        }
    }
}
