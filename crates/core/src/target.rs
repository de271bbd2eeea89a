//! What is wanted, and where: the focal and the protected region, and the time window in which the impact is judged.

use serde::{Deserialize, Serialize};

use crate::lattice::{Block, CrystalSite, HexagonalSheet, Site};

/// A rectangle of the crystal: whole rows between two distances from the axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Region {
    /// First and last row, both included, from 1.
    pub rows: [u32; 2],
    /// Least and greatest distance from the axis (m), both included.
    pub x: [f64; 2],
}

impl Region {
    /// Whether a site lies in the region; its edges count as inside to one part in 10⁹ of the diameter.
    pub fn contains(&self, site: &Site, diameter: f64) -> bool {
        let slack = 1e-9 * diameter;
        (self.rows[0]..=self.rows[1]).contains(&site.row) && site.x >= self.x[0] - slack && site.x <= self.x[1] + slack
    }

    /// Indices of the sites inside, in the lattice's order.
    pub fn sites(&self, lattice: &HexagonalSheet) -> Vec<usize> {
        let sites = lattice.sites();
        (0..sites.len()).filter(|&i| self.contains(&sites[i], lattice.diameter())).collect()
    }

    /// The row midway between first and last; a half where their number is even.
    pub fn mid_row(&self) -> f64 {
        f64::from(self.rows[0] + self.rows[1]) / 2.0
    }
}

/// A part of a crystal in space about the axis x = y = 0, itself and its image in the plane x = 0. Edges count as inside.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "shape", rename_all = "kebab-case")]
pub enum SpaceRegion {
    /// Whole layers between two distances from the plane x = 0 and two places along y.
    Box {
        /// First and last layer, both included, from 1.
        layers: [u32; 2],
        /// Least and greatest distance from the plane x = 0 (m).
        x: [f64; 2],
        /// Lowest and highest y (m).
        y: [f64; 2],
    },
    /// Whole layers between two distances from the axis: a disc or a ring.
    Cylinder {
        /// First and last layer, both included, from 1.
        layers: [u32; 2],
        /// Least and greatest distance from the axis (m).
        r: [f64; 2],
    },
    /// All within a distance of a point, and its image.
    Sphere {
        /// The point (m), x not negative.
        centre: [f64; 3],
        /// The distance (m).
        radius: f64,
    },
}

impl SpaceRegion {
    /// Whether a site lies inside; edges count as inside to one part in 10⁹ of the diameter.
    pub fn contains(&self, site: &CrystalSite<3>, diameter: f64) -> bool {
        let slack = 1e-9 * diameter;
        let within = |[low, high]: [f64; 2], at: f64| (low - slack..=high + slack).contains(&at);
        let ([x, y, z], holds) = (site.centre, |[a, b]: [u32; 2]| (a..=b).contains(&site.layer));
        match *self {
            Self::Box { layers, x: across, y: along } => holds(layers) && within(across, x.abs()) && within(along, y),
            Self::Cylinder { layers, r } => holds(layers) && within(r, x.hypot(y)),
            Self::Sphere { centre: [a, b, c], radius } => {
                let apart = (x.abs() - a).hypot(y - b).hypot(z - c);
                apart <= radius + slack
            }
        }
    }

    /// Indices of the block's sites inside, in its order, each once for every sphere of the whole crystal that it stands for.
    pub fn sites(&self, block: &Block) -> Vec<usize> {
        on(block, |site| self.contains(site, block.diameter()))
    }

    /// First and last layer that it reaches, with layers so far apart (m) and so many of them.
    pub fn layers(&self, spacing: f64, last: u32) -> [u32; 2] {
        match *self {
            Self::Box { layers, .. } | Self::Cylinder { layers, .. } => layers,
            Self::Sphere { centre, radius } => {
                let layer = |z: f64| (z / spacing + 1.0).clamp(1.0, f64::from(last));
                let edge = 1e-9;
                [(layer(centre[2] - radius) - edge).ceil() as u32, (layer(centre[2] + radius) + edge).floor() as u32]
            }
        }
    }

    /// Least and greatest distance from the axis (m) of what lies inside it, as seen by a lens of revolution.
    pub fn distances(&self) -> [f64; 2] {
        match *self {
            Self::Cylinder { r, .. } => r,
            Self::Box { x, y, .. } => {
                let near = if y[0] <= 0.0 && y[1] >= 0.0 { 0.0 } else { y[0].abs().min(y[1].abs()) };
                [x[0].hypot(near), x[1].hypot(y[0].abs().max(y[1].abs()))]
            }
            Self::Sphere { centre: [x, y, _], radius } => {
                let middle = x.hypot(y);
                [(middle - radius).max(0.0), middle + radius]
            }
        }
    }
}

/// Indices of a block's sites that are wanted, each once for every sphere that it stands for.
fn on(block: &Block, wanted: impl Fn(&CrystalSite<3>) -> bool) -> Vec<usize> {
    let sites = block.sites().iter().zip(block.copies()).enumerate();
    let wanted = sites.filter(|(_, (site, _))| wanted(site));
    wanted.flat_map(|(index, (_, &copies))| std::iter::repeat_n(index, usize::from(copies))).collect()
}

/// The sites of a target's regions on a crystal; scores are means over these.
#[derive(Clone, Debug, PartialEq)]
pub struct TargetSites {
    /// Those of all focal regions, each once: F is the mean over these.
    pub focal: Vec<usize>,
    /// Those of each focal region, with its share of the blow.
    pub foci: Vec<(Vec<usize>, f64)>,
    /// Those of the protected region: P is the mean over these.
    pub protected: Vec<usize>,
}

/// A region where energy is wanted, and how much of the blow.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Focus<R = Region> {
    /// Where.
    #[serde(flatten)]
    pub region: R,
    /// Its part of the blow; those of all foci sum to 1.
    #[serde(default = "whole", skip_serializing_if = "is_whole")]
    pub share: f64,
}

fn whole() -> f64 {
    1.0
}

fn is_whole(share: &f64) -> bool {
    *share == 1.0
}

/// Where energy is wanted and where it is not.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Target<R = Region> {
    /// The focal regions, one or several, in the order of the design file. In JSON a single one is no list.
    #[serde(rename = "focus", with = "one_or_several")]
    pub foci: Vec<Focus<R>>,
    /// The protected region.
    pub protect: R,
}

impl Target<SpaceRegion> {
    /// The sites of its regions, each once for every sphere of the whole crystal that it stands for.
    pub fn on(&self, block: &Block) -> TargetSites {
        let wanted =
            |site: &CrystalSite<3>| self.foci.iter().any(|focus| focus.region.contains(site, block.diameter()));
        TargetSites {
            focal: on(block, wanted),
            foci: self.foci.iter().map(|focus| (focus.region.sites(block), focus.share)).collect(),
            protected: self.protect.sites(block),
        }
    }
}

impl Target {
    /// The sites of its regions.
    pub fn on(&self, lattice: &HexagonalSheet) -> TargetSites {
        TargetSites {
            focal: self.focal_sites(lattice),
            foci: self.foci.iter().map(|focus| (focus.region.sites(lattice), focus.share)).collect(),
            protected: self.protect.sites(lattice),
        }
    }

    /// With one focal region.
    pub fn one(focus: Region, protect: Region) -> Self {
        Self { foci: vec![Focus { region: focus, share: 1.0 }], protect }
    }

    /// Indices of the sites of all focal regions, each once, in the lattice's order: F is the mean over these.
    pub fn focal_sites(&self, lattice: &HexagonalSheet) -> Vec<usize> {
        let (sites, diameter) = (lattice.sites(), lattice.diameter());
        (0..sites.len()).filter(|&i| self.wants(&sites[i], diameter)).collect()
    }

    /// Whether energy is wanted at a site.
    pub fn wants(&self, site: &Site, diameter: f64) -> bool {
        self.foci.iter().any(|focus| focus.region.contains(site, diameter))
    }

    /// First and last row of any focal region.
    pub fn focal_rows(&self) -> [u32; 2] {
        let rows = self.foci.iter().map(|focus| focus.region.rows);
        rows.reduce(|[a, b], [c, d]| [a.min(c), b.max(d)]).unwrap_or_default()
    }

    /// The focal regions with their names, `focal`, or `focal 1` and so on where there are several.
    pub fn named_foci(&self) -> Vec<(&Region, String)> {
        let name = |k: usize| if self.foci.len() > 1 { format!("focal {}", k + 1) } else { "focal".to_owned() };
        self.foci.iter().enumerate().map(|(k, focus)| (&focus.region, name(k))).collect()
    }

    /// The initial-wave window in seconds, one for all arrangements of a design file:
    ///
    ///   T = (depth of the regions' far edge + 10 rows) / V + 120 µs
    ///
    /// with `slowest_speed` V (m/s), the wave-speed bound of the slowest material present. It ends the run; maxima are
    /// taken over 0..T and energies are those at T. The first term is the passage of the first front, the second leaves
    /// room for the bound not being reached and for the pulse's own length.
    pub fn window(&self, lattice: &HexagonalSheet, slowest_speed: f64) -> f64 {
        let far = self.focal_rows()[1].max(self.protect.rows[1]);
        window(lattice.depth(f64::from(far + 10)), slowest_speed)
    }
}

/// The same in any dimension, with the `depth` (m) that the first front has to pass.
pub fn window(depth: f64, slowest_speed: f64) -> f64 {
    depth / slowest_speed + 120e-6
}

/// One region as it is, several as a list.
mod one_or_several {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    use super::Focus;

    #[derive(Deserialize)]
    #[serde(untagged)]
    enum Foci<R> {
        One(Focus<R>),
        Several(Vec<Focus<R>>),
    }

    pub fn serialize<R: Serialize, S: Serializer>(foci: &[Focus<R>], serializer: S) -> Result<S::Ok, S::Error> {
        match foci {
            [one] => one.serialize(serializer),
            several => several.serialize(serializer),
        }
    }

    pub fn deserialize<'de, R: Deserialize<'de>, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<Vec<Focus<R>>, D::Error> {
        Ok(match Foci::deserialize(deserializer)? {
            Foci::One(one) => vec![one],
            Foci::Several(several) => several,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::{BlockSide, Cell};

    /// Stored results of one focus read as before, and several come back as they went.
    #[test]
    fn one_focus_is_stored_without_a_list() {
        let region = |first: u32, x: f64| Region { rows: [first, first + 2], x: [x, x + 1.0] };
        let one = Target::one(region(3, 0.0), region(9, 4.0));
        let text = serde_json::to_string(&one).unwrap();
        assert_eq!(text, r#"{"focus":{"rows":[3,5],"x":[0.0,1.0]},"protect":{"rows":[9,11],"x":[4.0,5.0]}}"#);
        let focus = |region, share| Focus { region, share };
        let several =
            Target { foci: vec![focus(region(3, 0.0), 0.25), focus(region(5, 2.0), 0.75)], protect: region(9, 4.0) };
        for target in [one, several] {
            let text = serde_json::to_string(&target).unwrap();
            assert_eq!(serde_json::from_str::<Target>(&text).unwrap(), target);
        }
    }

    /// A disc about the axis as a box and a sphere that hold the same, and of each the spheres of the whole crystal: 1 + 6 in a layer.
    #[test]
    fn regions_in_space_count_spheres_of_the_whole() {
        let sides = [BlockSide::Mirror, BlockSide::Free];
        let block = Block::new(Cell::<3>::named("hcp").unwrap(), 1.0, 5, [8, 5], 3, sides).unwrap();
        let spacing = block.layer_spacing();
        let disc = SpaceRegion::Cylinder { layers: [3, 3], r: [0.0, 1.0] };
        let ball = SpaceRegion::Sphere { centre: [0.0, 0.0, 2.0 * spacing], radius: 0.5 };
        let cube = SpaceRegion::Box { layers: [3, 3], x: [0.0, 1.0], y: [-0.9, 0.9] };
        assert_eq!((disc.sites(&block).len(), ball.sites(&block).len()), (7, 1));
        assert_eq!(cube.sites(&block), disc.sites(&block));
        // Twelve neighbours, three of them in each layer beside.
        let all = SpaceRegion::Sphere { centre: [0.0, 0.0, 2.0 * spacing], radius: 1.0 };
        assert_eq!((all.sites(&block).len(), all.layers(spacing, 5)), (13, [2, 4]));
        let ring = SpaceRegion::Sphere { centre: [2.0, 0.0, 2.0 * spacing], radius: 0.5 };
        assert_eq!((ring.sites(&block).len(), ring.distances()), (2, [1.5, 2.5]));
        let target = Target { foci: vec![Focus { region: disc, share: 1.0 }], protect: ring };
        let text = serde_json::to_string(&target).unwrap();
        assert!(text.starts_with(r#"{"focus":{"shape":"cylinder","layers":[3,3],"r":[0.0,1.0]}"#), "{text}");
        assert_eq!(serde_json::from_str::<Target<SpaceRegion>>(&text).unwrap(), target);
        assert_eq!(target.on(&block).focal.len(), 7);
    }

    /// Foci may overlap; a site in both counts once.
    #[test]
    fn sites_of_overlapping_foci_count_once() {
        let lattice = HexagonalSheet::new(1.0, 12, 6.0).unwrap();
        let region = |rows, x| Focus { region: Region { rows, x }, share: 0.5 };
        let target = Target {
            foci: vec![region([3, 5], [0.0, 2.0]), region([4, 6], [1.0, 3.0])],
            protect: Region { rows: [9, 9], x: [0.0, 1.0] },
        };
        let each: Vec<usize> = target.foci.iter().flat_map(|focus| focus.region.sites(&lattice)).collect();
        let mut union = each.clone();
        union.sort_unstable();
        union.dedup();
        assert!(union.len() < each.len());
        assert_eq!(target.focal_sites(&lattice), union);
        assert_eq!(target.focal_rows(), [3, 6]);
    }
}
