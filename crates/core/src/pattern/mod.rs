//! Which sphere sits on which site of a crystal: patterns of materials and sizes, then changes to single spheres.
//!
//! In: a [`Crystal`], a palette, [`Pattern`]s painted one over the other, [`Change`]s. Out: the spheres to simulate. Lenses and
//! their baselines have a module of their own, [`layout`](crate::layout); here is everything else that can be built.
//!
//! - `paint`: the patterns; `select`: which spheres are meant

mod paint;
mod select;
#[cfg(test)]
mod tests;

pub use paint::{Pattern, PatternError, RingShape, Side};
pub use select::Selection;

use crate::lattice::Crystal;
use crate::material::Material;
use crate::sample::{Sample, Sphere};

/// A crystal with a sphere, or a vacancy, on every site.
#[derive(Clone, Debug, PartialEq)]
pub struct Build<const D: usize> {
    crystal: Crystal<D>,
    palette: Vec<Material>,
    spheres: Vec<Option<Sphere<D>>>,
}

/// What happens to single spheres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Change<const D: usize> {
    /// Another material, by its place in the palette.
    Material(usize),
    /// Another radius (m); the centre stays.
    Radius(f64),
    /// Moved by so much (m).
    Move([f64; D]),
    /// Taken out: a vacancy.
    Remove,
}

impl<const D: usize> Build<D> {
    /// Equal touching spheres of the palette's first material on all sites.
    pub fn new(crystal: Crystal<D>, palette: Vec<Material>) -> Self {
        let radius = 0.5 * crystal.diameter();
        let spheres = crystal.sites().iter().map(|site| Some(Sphere { centre: site.centre, radius, material: 0 }));
        let spheres = spheres.collect();
        Self { crystal, palette, spheres }
    }

    /// The sites.
    pub fn crystal(&self) -> &Crystal<D> {
        &self.crystal
    }

    /// The materials that sites may hold.
    pub fn palette(&self) -> &[Material] {
        &self.palette
    }

    /// Paints selected sites: those to which the pattern gives choice k take material `materials[k]` and, where radii (m) are
    /// given, `radii[k]`. Sites that the pattern leaves out keep what they hold. Gives the number of sites painted.
    ///
    /// # Errors
    /// A pattern that has no meaning in `D` dimensions.
    pub fn paint(
        &mut self,
        pattern: &Pattern,
        selection: &Selection<D>,
        materials: &[usize],
        radii: Option<&[f64]>,
    ) -> Result<usize, PatternError> {
        let choices = pattern.choices(&self.crystal, materials.len())?;
        let mut painted = 0;
        for (k, (site, choice)) in self.crystal.sites().iter().zip(choices).enumerate() {
            let (Some(choice), Some(sphere)) = (choice, &mut self.spheres[k]) else { continue };
            if selection.holds(k, site, &site.centre) {
                sphere.material = materials[choice];
                if let Some(radii) = radii {
                    sphere.radius = radii[choice];
                }
                painted += 1;
            }
        }
        Ok(painted)
    }

    /// Changes selected spheres; vacancies stay. Gives the number of spheres changed.
    pub fn change(&mut self, selection: &Selection<D>, change: Change<D>) -> usize {
        let mut changed = 0;
        for (k, (site, place)) in self.crystal.sites().iter().zip(&mut self.spheres).enumerate() {
            let Some(sphere) = place else { continue };
            if !selection.holds(k, site, &site.centre) {
                continue;
            }
            match change {
                Change::Material(material) => sphere.material = material,
                Change::Radius(radius) => sphere.radius = radius,
                Change::Move(by) => (0..D).for_each(|axis| sphere.centre[axis] += by[axis]),
                Change::Remove => *place = None,
            }
            changed += 1;
        }
        changed
    }

    /// Closes the gaps of a chain whose spheres differ in size: each touches the one before it, the first stays. Where all
    /// are as large as their sites nothing moves.
    pub fn close_chain(&mut self) {
        let diameter = self.crystal.diameter();
        let mut shift = 0.0;
        let mut before: Option<f64> = None;
        for sphere in self.spheres.iter_mut().flatten() {
            if let Some(radius) = before {
                shift += radius + sphere.radius - diameter;
            }
            sphere.centre[D - 1] += shift;
            before = Some(sphere.radius);
        }
    }

    /// The spheres, in the order of the sites, and for each the index of its site.
    pub fn sample(&self) -> (Sample<D>, Vec<usize>) {
        let filled = || self.spheres.iter().enumerate().filter_map(|(site, sphere)| Some((site, (*sphere)?)));
        let sample = Sample { materials: self.palette.clone(), spheres: filled().map(|(_, sphere)| sphere).collect() };
        (sample, filled().map(|(site, _)| site).collect())
    }
}
