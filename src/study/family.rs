//! The design's lens family as a few real parameters.

use std::collections::{BTreeMap, HashMap};
use std::sync::{Arc, Mutex, PoisonError};

use super::{Study, free};
use crate::design::DesignRef;
use crate::evaluate::ArrivalSurrogate;
use crate::lens::{LensError, LensRequest, Parameter, propose};
use crate::material::Material;
use crate::search::{Assignment, BATCH, Parametrisation};

/// Rows to a unit of the parameters.
const ROWS: f64 = 8.0 / 3.0;

/// Distance of the lens's axis to a unit (diameters of spheres).
const AXIS: f64 = 2.0;

/// Units to the range of a parameter that the family has of its own.
const UNITS: f64 = 15.0;

/// First standard deviation of every parameter: some four rows, three diameters, 15 % of the curvature, a tenth of the range of others.
const SPREAD: f64 = 1.5;

/// What rays say of the lenses that were painted: by layout how much more of them runs through the focus, and less through the
/// protected region, than without a lens. A layout of spheres has no faces to trace rays through; the lens that it was laid from has.
#[derive(Clone, Debug, Default)]
pub(super) struct RayNotes(Arc<Mutex<HashMap<Assignment, f64>>>);

impl RayNotes {
    /// Of two lenses with the same spheres the first counts.
    fn note(&self, assignment: &Assignment, lens: Option<&Laid>) {
        let mut notes = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        notes.entry(assignment.clone()).or_insert_with(|| lens.map_or(0.0, |lens| lens.gathers));
    }

    /// What they said of a layout.
    pub fn of(&self, assignment: &Assignment) -> Option<f64> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).get(assignment).copied()
    }
}

/// A lens as it was laid on a crystal.
pub(super) struct Laid {
    /// First and last row, in space layer.
    rows: [u32; 2],
    /// Of curvature (m), where the family has one.
    radius: Option<f64>,
    /// Its distance from the crystal's axis (m).
    axis: f64,
    /// The family's own parameters, by the names that results have.
    parameters: BTreeMap<String, f64>,
    /// For several foci there are several.
    parts: usize,
    pub palette: Vec<Material>,
    pub materials: Vec<u8>,
    /// By how much more of the rays runs through the focus, and less through the protected region, than without it.
    gathers: f64,
}

impl Laid {
    /// The lens that a design asks for.
    ///
    /// # Errors
    /// There is no such lens.
    pub fn new(design: DesignRef<'_>, request: &LensRequest) -> Result<Self, LensError> {
        let gathers = |fraction: f64, without: f64, [protected, open]: [f64; 2]| fraction / without - protected / open;
        match design {
            DesignRef::Plane(design) => {
                let lens = propose(&design.lattice, &design.host, request, &design.target, design.constants)?;
                Ok(Self {
                    rows: [lens.prescription.apex_row, lens.prescription.back_row],
                    radius: lens.prescription.radius,
                    axis: lens.prescription.axis,
                    parameters: lens.prescription.parameters,
                    parts: lens.parts.len(),
                    gathers: gathers(lens.fraction, lens.fraction_without, lens.protected),
                    palette: lens.palette,
                    materials: lens.materials,
                })
            }
            DesignRef::Space(design) => {
                let (body, palette, materials) = design.laid(request)?;
                Ok(Self {
                    rows: [body.apex_row, body.back_row],
                    radius: body.radius,
                    axis: 0.0,
                    parameters: body.parameters,
                    parts: 1,
                    gathers: gathers(body.fraction, body.fraction_without, body.protected),
                    palette,
                    materials,
                })
            }
        }
    }
}

impl Study {
    /// First row, last row, curvature, in a sheet the place of the design's lens, and what its family has of its own and the design leaves open, each a
    /// number of about one: what the method `lens-family` searches. Where the family has no curvature or no axis of its own these do nothing. None where the design has no lens,
    /// a material that its lenses are made of may not be chosen, or several focal regions split it into parts. What rays say of
    /// each lens is taken down in `notes`.
    pub(super) fn parametrisation(&self, notes: &RayNotes) -> Option<Parametrisation> {
        let request = self.design().lens()?.clone();
        let lens = Laid::new(self.design(), &request).ok().filter(|lens| lens.parts == 1)?;
        let letter = |material: &Material| {
            let of = |&place: &u8| self.palette[usize::from(place)] == *material;
            self.alphabet.iter().position(of).map(|letter| letter as u8)
        };
        // Letters by the place of a material in a lens's palette.
        let alphabet: Vec<u8> = lens.palette.iter().map(letter).collect::<Option<_>>()?;
        let host = alphabet[0];
        let rows_of = free::rows_of(self.design());
        let [first, last] = [rows_of[*self.free.first()?], rows_of[*self.free.last()?]];
        let curvature = lens.radius.map_or(1.0, |radius| 0.1 / radius);
        let diameter = self.design().diameter();
        let across = match self.design() {
            DesignRef::Plane(design) => design.lattice.half_width(),
            DesignRef::Space(design) => design.stack(request.symmetry).half_width,
        };
        let mut start = vec![
            f64::from(lens.rows[0]) / ROWS,
            f64::from(lens.rows[1]) / ROWS,
            lens.radius.map_or(0.0, |radius| 1.0 / (radius * curvature)),
        ];
        let has_radius = lens.radius.is_some();
        // Of the rows and the axis what there is; a quarter of the design's curvature to four times as much.
        let rows = [f64::from(first) / ROWS, f64::from(last) / ROWS];
        let bent = if has_radius { [start[2] / 4.0, start[2] * 4.0] } else { [-1.0, 1.0] };
        let mut bounds = vec![rows, rows, bent];
        // In space the axis is that of the crystal.
        let moves = self.design.plane().is_some();
        if moves {
            start.push(lens.axis / (AXIS * diameter));
            bounds.push([0.0, across / (AXIS * diameter)]);
        }
        let open = request.family.parameters().iter();
        let open: Vec<&Parameter> =
            open.filter(|own| own.is_sought && !request.parameters.contains_key(own.name)).collect();
        let others = start.len();
        for own in &open {
            let [least, most] = own.range;
            let value = lens.parameters.get(&own.key()).map_or(own.usual, |value| value / own.quantity.unit(diameter));
            start.push(UNITS * (value - least) / (most - least));
            bounds.push([0.0, UNITS]);
        }
        let (study, notes) = (self.clone(), notes.clone());
        let decode = move |x: &[f64]| {
            let row = |x: f64| (x * ROWS).round().clamp(f64::from(first), f64::from(last)) as u32;
            // Half the width of the crystal bends nothing, and a sphere's own radius is as round as it gets.
            let bent = (x[2] * curvature).clamp(1e-2 / across, 2.0 / diameter);
            let own = open.iter().zip(&x[others..]).map(|(own, x)| {
                let [least, most] = own.range;
                let value = least + (most - least) * (x / UNITS).clamp(0.0, 1.0);
                (own.name.to_owned(), value * own.quantity.unit(diameter))
            });
            let wanted = LensRequest {
                parameters: request.parameters.clone().into_iter().chain(own).collect(),
                apex_row: Some(row(x[0])),
                back_row: Some(row(x[1])),
                radius: has_radius.then(|| 1.0 / bent),
                axis: (moves && request.family.has_axis()).then(|| (x[3] * AXIS * diameter).clamp(0.0, across)),
                rows: [first, last],
                ..request.clone()
            };
            // A lens that cannot be is no lens.
            let lens = Laid::new(study.design(), &wanted).ok();
            let place = |lens: &Laid, i: usize| alphabet.get(usize::from(lens.materials[i])).copied().unwrap_or(host);
            let of = |group: &Vec<usize>| lens.as_ref().map_or(host, |lens| place(lens, group[0]));
            let assignment: Assignment = study.groups.iter().map(of).collect();
            notes.note(&assignment, lens.as_ref());
            assignment
        };
        let study = self.clone();
        let surrogate = move |assignment: &[u8]| match study.design() {
            DesignRef::Plane(design) => ArrivalSurrogate::Bound.delay(design, &study.sheet(design, assignment)),
            DesignRef::Space(_) => 0.0,
        };
        Some(Parametrisation {
            start,
            spread: SPREAD,
            bounds,
            decode: Arc::new(decode),
            surrogate: Some(Arc::new(surrogate)),
            batch: BATCH,
        })
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::design::AnyDesign;
    use crate::lens::Family;

    /// The repository's study: its start is the design's lens, and a longer one has more spheres.
    #[test]
    fn the_first_parameters_paint_the_designs_lens() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("studies/two-materials.toml");
        let study = Study::read(&path, None).unwrap();
        let notes = RayNotes::default();
        let parametrisation = study.parametrisation(&notes).unwrap();
        let painted = (parametrisation.decode)(&parametrisation.start);
        assert_eq!(painted, study.first()[0]);
        assert!(
            parametrisation.start.iter().zip(&parametrisation.bounds).all(|(x, [from, to])| (from..=to).contains(&x))
        );
        // The wave is late behind the lens, and as late everywhere behind none.
        let surrogate = parametrisation.surrogate.clone().unwrap();
        assert!(surrogate(&painted) > 1e-6 && surrogate(&vec![0; painted.len()]).abs() < 1e-12);
        // So do rays: the design's lens gathers them where they are wanted, as its proposal says.
        let design = study.design.plane().unwrap();
        let lens = design.lens.clone().unwrap();
        let lens = propose(&design.lattice, &design.host, &lens, &design.target, design.constants).unwrap();
        let gathered = lens.fraction / lens.fraction_without - lens.protected[0] / lens.protected[1];
        assert!(gathered > 0.5 && (notes.of(&painted).unwrap() - gathered).abs() < 0.02 * gathered);
        assert_eq!(notes.of(&vec![0; painted.len()]), None);
        let mut longer = parametrisation.start.clone();
        longer[1] += 3.0 / ROWS;
        let count = |assignment: &[u8]| assignment.iter().filter(|&&letter| letter != 0).count();
        assert!(count(&(parametrisation.decode)(&longer)) > count(&painted) + 30);
        // What a family has of its own is searched too, from where rays left it.
        let mut other = study.clone();
        let mut asked = design.clone();
        asked.lens.as_mut().unwrap().family = Family::EvenAsphere;
        let proposed = asked.propose().unwrap();
        other.design = AnyDesign::Plane(Box::new(asked));
        let own = other.parametrisation(&RayNotes::default()).unwrap();
        assert_eq!((own.start.len(), own.bounds.len()), (7, 7));
        let laid = (own.decode)(&own.start);
        assert_eq!(count(&laid), proposed.spheres);
        let mut flatter = own.start.clone();
        flatter[4] = 0.0;
        assert_ne!((own.decode)(&flatter), laid);
        // Parameters out of all bounds still paint something.
        for x in [-1e9, 1e9] {
            assert_eq!((parametrisation.decode)(&[x; 4]).len(), painted.len());
        }
    }
}
