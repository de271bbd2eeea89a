//! What strikes a crystal and what is built of a drawing: the members of a set that a layout is judged by.

use crate::contact::LawKind;
use crate::dem::{ForcePulse, Impact, Mirror, Projectile, Stop, Strike};
use crate::design::{Design, SpaceDesign};
use crate::lattice::Layered;
use crate::material::Material;
use crate::sample::{Sample, Sphere};

use super::part::{Parts, walls};
use super::space::sides;
use super::{Plan, impact};

/// One impact of a set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImpactLoad {
    /// What strikes: the force on each struck sphere, along the direction of the load, and how long it lasts; or a projectile, straight, on all of row 1,
    /// with its mass before the whole crystal.
    pub strike: Strike,
    /// Angle (rad) between the load and the axis, positive towards +x; below a right angle.
    pub angle: f64,
    /// Which spheres of row 1 are struck: those between these two distances from the axis (m), negative to its left. All where
    /// there is none.
    pub place: Option<[f64; 2]>,
    /// The contact law; the design's own where there is none.
    pub law: Option<LawKind>,
    /// The coefficient of friction at every contact; the design's own where there is none.
    pub friction: Option<f64>,
}

impl From<Strike> for ImpactLoad {
    fn from(strike: Strike) -> Self {
        Self { strike, angle: 0.0, place: None, law: None, friction: None }
    }
}

impl From<ForcePulse> for ImpactLoad {
    fn from(pulse: ForcePulse) -> Self {
        Strike::from(pulse).into()
    }
}

impl ImpactLoad {
    /// Whether the motion is that of its mirror image, so that one half of the crystal says all.
    pub fn is_symmetric(&self) -> bool {
        self.angle == 0.0 && self.place.is_none()
    }
}

/// How what is built differs from what is drawn. As long as places are sites of the half, both halves of the crystal differ alike;
/// place n + i, n the number of sites, is the image of site i on the other side of the axis, and then each half is as it is.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Imperfection {
    /// The materials, places in the palette, among which a wrong sphere is.
    pub alphabet: Vec<u8>,
    /// Places that hold a wrong sphere, and how many places further on in `alphabet` its material stands.
    pub wrong: Vec<(usize, u8)>,
    /// For every place its sphere's radius over the nominal one, at most 1, and 0 where it is empty; none where all are nominal.
    pub radii: Vec<f64>,
    /// The palette as it turned out; none where all materials are as drawn.
    pub materials: Vec<Material>,
}

impl Imperfection {
    /// Whether the halves differ each in its own way, of a crystal with so many sites in the half.
    pub fn is_one_sided(&self, sites: usize) -> bool {
        self.radii.len() > sites || self.wrong.iter().any(|&(place, _)| place >= sites)
    }

    /// What is built where `drawn` is wanted, of the half or of all places: a material for every place.
    pub fn built(&self, drawn: &[u8]) -> Vec<u8> {
        let mut built = drawn.to_vec();
        if self.is_one_sided(drawn.len()) {
            built.extend(drawn);
        }
        for &(place, shift) in &self.wrong {
            if let Some(letter) = self.alphabet.iter().position(|&letter| letter == built[place]) {
                built[place] = self.alphabet[(letter + usize::from(shift)) % self.alphabet.len()];
            }
        }
        built
    }
}

/// One member of a set: what strikes, and how what is struck was built.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadCase {
    /// The impact.
    pub load: ImpactLoad,
    /// What is built otherwise than drawn.
    pub imperfection: Imperfection,
    /// Whether both halves are simulated though neither load nor imperfection asks for it, since what is drawn differs in them: its materials
    /// are then those of all sites, and behind them those of their images.
    pub halves_differ: bool,
}

impl From<ImpactLoad> for LoadCase {
    fn from(load: ImpactLoad) -> Self {
        Self { load, imperfection: Imperfection::default(), halves_differ: false }
    }
}

impl<S: Into<Strike>> From<S> for LoadCase {
    fn from(strike: S) -> Self {
        ImpactLoad::from(strike.into()).into()
    }
}

/// The part of a crystal that has to be simulated under a load: its half, or, where the load is not symmetric, the whole
/// between smooth walls at both far sides; or a sixth of a crystal in space. Where loads and layouts are symmetric all say the same.
pub(super) struct Field<const D: usize = 2> {
    /// What strikes it.
    pub impact: Impact,
    /// μ; none without friction.
    pub friction: Option<f64>,
    /// Centre of each sphere (m), and its place: its site in the half, or, on the other side of the axis, as many more as there are sites.
    pub(super) spheres: Vec<([f64; D], usize)>,
    /// Radius of the sphere of each site as drawn (m).
    pub(super) radii: Vec<f64>,
    /// The one or two spheres that stand on each site of the half and on its image.
    pub(super) images: Vec<[usize; 2]>,
    /// The half over what is simulated.
    pub share: f64,
}

impl Field {
    /// Both halves are simulated where the load is not symmetric, and where `whole` asks for it.
    pub fn new(design: &Design, plan: &Plan, load: &ImpactLoad, whole: bool) -> Self {
        let lattice = &design.lattice;
        let sites = lattice.sites();
        let radii = sites.iter().map(|site| 0.5 * lattice.row_diameter(site.row)).collect();
        let friction = load.friction.or(design.friction).filter(|&mu| mu > 0.0);
        let mut impact = impact(design, plan);
        impact.law = load.law.unwrap_or(design.law);
        impact.step = plan.step_under(impact.law);
        let along = match load.strike {
            Strike::Pulse(pulse) => Strike::Pulse(ForcePulse { force: pulse.force * load.angle.cos(), ..pulse }),
            flat => flat,
        };
        let along = facing(along, -0.5 * lattice.row_diameter(1));
        if load.is_symmetric() && !whole {
            impact = impact.struck_by(along.of_part(0.5));
            let spheres = sites.iter().enumerate().map(|(i, site)| ([site.x, site.z], i)).collect();
            let images = (0..sites.len()).map(|i| [i, i]).collect();
            return Self { impact, friction, spheres, radii, images, share: 1.0 };
        }
        impact = impact.struck_by(along);
        impact.slope = load.angle.tan();
        let mut spheres = Vec::new();
        let mut first = 0;
        for row in sites.chunk_by(|a, b| a.row == b.row) {
            let numbered = || row.iter().zip(first..first + row.len());
            let left = numbered().rev().filter(|(site, _)| site.x > 0.0);
            spheres.extend(left.map(|(site, i)| ([-site.x, site.z], sites.len() + i)));
            spheres.extend(numbered().map(|(site, i)| ([site.x, site.z], i)));
            first += row.len();
        }
        let images = images(&spheres, sites.len());
        let row_of = |k: usize| sites[spheres[k].1 % sites.len()].row;
        let on = |row: u32| -> Vec<usize> { (0..spheres.len()).filter(|&k| row_of(k) == row).collect() };
        let slack = 1e-9 * lattice.diameter();
        let is_struck = |&k: &usize| {
            let x = spheres[k].0[0];
            load.place.is_none_or(|[from, to]| (from - slack..=to + slack).contains(&x))
        };
        impact.struck = on(1).into_iter().filter(is_struck).collect();
        impact.exit = on(lattice.rows());
        impact.mirrors =
            [-1.0, 1.0].map(|side| Mirror { axis: 0, position: side * lattice.half_width(), inward: -side }).to_vec();
        Self { impact, friction, spheres, radii, images, share: 0.5 }
    }
}

impl Field<3> {
    /// Of a crystal in space the half x ≥ 0, since what strikes it there is its own image; the whole where `whole` asks for it.
    pub fn in_space(design: &SpaceDesign, plan: &Plan, load: &ImpactLoad, whole: bool) -> Self {
        let block = &design.lattice;
        let mut impact = super::impact_in_space(design, plan);
        impact.law = load.law.unwrap_or(design.law);
        impact.step = plan.step_under(impact.law);
        let strike = facing(load.strike, -0.5 * block.diameter());
        let sites = block.sites();
        let radii = vec![0.5 * block.diameter(); sites.len()];
        if !whole {
            impact = impact.struck_by(strike.of_part(0.5));
            let spheres = sites.iter().enumerate().map(|(i, site)| (site.centre, i)).collect();
            let images = (0..sites.len()).map(|i| [i, i]).collect();
            return Self { impact, friction: None, spheres, radii, images, share: 1.0 };
        }
        let mut spheres: Vec<([f64; 3], usize)> = Vec::new();
        let mut starts = vec![0];
        for layer in 1..=block.layers() {
            let mut held: Vec<([f64; 3], usize)> = Vec::new();
            for i in block.layer(layer) {
                let [x, y, z] = sites[i].centre;
                held.push(([x, y, z], i));
                if block.copies()[i] == 2 {
                    held.push(([-x, y, z], sites.len() + i));
                }
            }
            held.sort_by(|(a, _), (b, _)| a[1].total_cmp(&b[1]).then(a[0].total_cmp(&b[0])));
            spheres.extend(held);
            starts.push(spheres.len());
        }
        (impact.mirrors, impact.periods) = sides(block, true);
        impact.faces = walls(block, true);
        impact.struck = (0..starts[1]).collect();
        impact.exit = (starts[starts.len() - 2]..spheres.len()).collect();
        let images = images(&spheres, sites.len());
        Self { impact: impact.struck_by(strike), friction: None, spheres, radii, images, share: 0.5 }
    }
}

/// The one or two spheres that stand on each site and on its image.
fn images<const D: usize>(spheres: &[([f64; D], usize)], sites: usize) -> Vec<[usize; 2]> {
    let mut images = vec![[usize::MAX, 0]; sites];
    for (k, &(_, place)) in spheres.iter().enumerate() {
        let site = place % sites;
        images[site] = [images[site][0].min(k), k];
    }
    images
}

/// A projectile whose face lies before the first layer as it is drawn, however pieces of it are made.
fn facing(strike: Strike, front: f64) -> Strike {
    match strike {
        Strike::Projectile(flat) => Strike::Projectile(Projectile { front: Some(front), ..flat }),
        pulse => pulse,
    }
}

impl<const D: usize> Field<D> {
    /// The spheres to simulate where a layout is built with its imperfection.
    pub fn sample(&self, palette: &[Material], layout: &[u8], imperfection: &Imperfection) -> Sample<D> {
        let (built, sites) = (imperfection.built(layout), self.images.len());
        // Where the halves are alike a place on the other side is as its site.
        let of = |place: usize, places: usize| if place < places { place } else { place % sites };
        let spheres = self
            .spheres
            .iter()
            .map(|&(centre, place)| Sphere {
                centre,
                radius: self.radii[place % sites]
                    * imperfection.radii.get(of(place, imperfection.radii.len())).unwrap_or(&1.0),
                material: usize::from(built[of(place, built.len())]),
            })
            .collect();
        let materials = if imperfection.materials.is_empty() { palette } else { &imperfection.materials };
        Sample { materials: materials.to_vec(), spheres }
    }

    /// A number of every sphere to one of every site of the half: the mean of a site and its image.
    pub fn folded(&self, values: &[f64]) -> Vec<f64> {
        self.images.iter().map(|&[a, b]| if a == b { values[a] } else { 0.5 * (values[a] + values[b]) }).collect()
    }

    /// Whether what is simulated says all of a layout of the half, built with its imperfection: all sites of which one sphere stands for are alike.
    pub fn stands_for(&self, layout: &[u8], imperfection: &Imperfection) -> bool {
        let (built, sites) = (imperfection.built(layout), self.images.len());
        let radii = &imperfection.radii;
        built.len() == sites
            && radii.len() <= sites
            && self.images.iter().enumerate().all(|(site, &[k, _])| {
                let place = self.spheres[k].1;
                built[site] == built[place] && radii.get(site) == radii.get(place)
            })
    }

    /// A guard's word with the numbers of sites in the half, where a part of it is simulated.
    pub fn named(&self, stop: Stop) -> Stop {
        if self.spheres.len() < self.images.len() { stop.renumbered(|k| self.spheres[k].1) } else { stop }
    }

    /// The spheres on a site and on its image.
    pub fn on(&self, site: usize) -> [usize; 2] {
        self.images[site]
    }
}

/// A field of either dimension.
pub(super) enum AnyField {
    /// Of a sheet.
    Plane(Box<Field>),
    /// Of a crystal in space.
    Space(Box<Parts>),
}

impl AnyField {
    /// What strikes it, or its sixth.
    pub fn impact(&self, is_sixth: bool) -> &Impact {
        match self {
            Self::Plane(field) => &field.impact,
            Self::Space(parts) => &parts.field(is_sixth).impact,
        }
    }

    /// Whether a sixth says all of a layout that is built with an imperfection.
    pub fn is_sixth(&self, layout: &[u8], imperfection: &Imperfection) -> bool {
        matches!(self, Self::Space(parts) if parts.is_sixth(layout, imperfection))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wrong_sphere_is_of_another_of_the_letters() {
        let imperfection =
            Imperfection { alphabet: vec![0, 2, 3], wrong: vec![(1, 1), (2, 2), (3, 1)], ..Imperfection::default() };
        // A material that may not be chosen stays.
        assert_eq!(imperfection.built(&[0, 0, 0, 1, 2]), [0, 2, 3, 1, 2]);
        assert_eq!(imperfection.built(&[3, 3, 3, 3, 3]), [3, 0, 2, 0, 3]);
        // The second of two sites, on the other side of the axis alone.
        let imperfection = Imperfection { wrong: vec![(3, 1)], ..imperfection };
        assert_eq!((imperfection.is_one_sided(2), imperfection.built(&[0, 2])), (true, vec![0, 2, 0, 3]));
    }
}
