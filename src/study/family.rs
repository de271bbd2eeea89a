//! The design's lens family as a few real parameters.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

use super::Study;
use crate::evaluate::Glance;
use crate::lens::{Lens, LensRequest, propose};
use crate::material::Material;
use crate::search::{BATCH, Choice, Painter};

/// Rows to a unit of the parameters.
const ROWS: f64 = 8.0 / 3.0;

/// Distance of the lens's axis to a unit (diameters of spheres).
const AXIS: f64 = 2.0;

/// First standard deviation of every parameter: some four rows, three diameters, 15 % of the curvature.
const SPREAD: f64 = 1.5;

/// What rays say of the lenses that were painted: by layout how much more of them runs through the focus, and less through the
/// protected region, than without a lens. A layout of spheres has no faces to trace rays through; the lens that it was laid from has.
#[derive(Clone, Debug, Default)]
pub(super) struct RayNotes(Arc<Mutex<HashMap<Choice, f64>>>);

impl RayNotes {
    /// Of two lenses with the same spheres the first counts.
    fn note(&self, choice: &Choice, lens: Option<&Lens>) {
        let gathers = |lens: &Lens| {
            let [protected, open] = lens.protected;
            lens.fraction / lens.fraction_without - protected / open
        };
        let mut notes = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        notes.entry(choice.clone()).or_insert_with(|| lens.map_or(0.0, gathers));
    }

    /// What they said of a layout.
    pub fn of(&self, choice: &Choice) -> Option<f64> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).get(choice).copied()
    }
}

impl Study {
    /// First row, last row, curvature and place of the design's lens, each a number of about one: what the method `lens-family`
    /// searches. Where the family has no curvature or no axis of its own these do nothing. None where the design has no lens,
    /// a material that its lenses are made of may not be chosen, or several focal regions split it into parts. What rays say of
    /// each lens is taken down in `notes`.
    pub(super) fn painter(&self, notes: &RayNotes) -> Option<Painter> {
        let (design, request) = (self.design.clone(), self.design.lens.clone()?);
        let lens = propose(&design.lattice, &design.host, &request, &design.target, design.constants).ok()?;
        if lens.parts.len() > 1 {
            return None;
        }
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
        let curvature = lens.prescription.radius.map_or(1.0, |radius| 0.1 / radius);
        let diameter = design.lattice.diameter();
        let start = vec![
            f64::from(lens.prescription.apex_row) / ROWS,
            f64::from(lens.prescription.back_row) / ROWS,
            lens.prescription.radius.map_or(0.0, |radius| 1.0 / (radius * curvature)),
            lens.prescription.axis / (AXIS * diameter),
        ];
        let has_radius = lens.prescription.radius.is_some();
        // Of the rows and the axis what there is; a quarter of the design's curvature to four times as much.
        let rows = [f64::from(first) / ROWS, f64::from(last) / ROWS];
        let bent = if has_radius { [start[2] / 4.0, start[2] * 4.0] } else { [-1.0, 1.0] };
        let bounds = vec![rows, rows, bent, [0.0, design.lattice.half_width() / (AXIS * diameter)]];
        let notes = notes.clone();
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
            let choice: Choice = free.iter().map(|&i| lens.as_ref().map_or(host, |lens| place(lens, i))).collect();
            notes.note(&choice, lens.as_ref());
            choice
        };
        let study = self.clone();
        let guess = move |choice: &[u8]| Glance::Bound.delay(&study.design, &study.layout(choice));
        Some(Painter {
            start,
            spread: SPREAD,
            bounds,
            paint: Arc::new(paint),
            guess: Some(Arc::new(guess)),
            batch: BATCH,
        })
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
        let notes = RayNotes::default();
        let painter = study.painter(&notes).unwrap();
        let painted = (painter.paint)(&painter.start);
        assert_eq!(painted, study.first()[0]);
        assert!(painter.start.iter().zip(&painter.bounds).all(|(x, [from, to])| (from..=to).contains(&x)));
        // The wave is late behind the lens, and as late everywhere behind none.
        let guess = painter.guess.clone().unwrap();
        assert!(guess(&painted) > 1e-6 && guess(&vec![0; painted.len()]).abs() < 1e-12);
        // So do rays: the design's lens gathers them where they are wanted, as its proposal says.
        let lens = study.design.lens.clone().unwrap();
        let design = &study.design;
        let lens = propose(&design.lattice, &design.host, &lens, &design.target, design.constants).unwrap();
        let gathered = lens.fraction / lens.fraction_without - lens.protected[0] / lens.protected[1];
        assert!(gathered > 0.5 && (notes.of(&painted).unwrap() - gathered).abs() < 0.02 * gathered);
        assert_eq!(notes.of(&vec![0; painted.len()]), None);
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
