//! A close-packed crystal in space about the axis of a lens, held as its half x ≥ 0.

use std::collections::HashMap;
use std::f64::consts::PI;
use std::ops::Range;
use std::sync::Arc;

use super::crystal::encloses;
use super::{Cell, CrystalSite, Layered, Outline};

/// How a block ends along an axis across the wave.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BlockSide {
    /// Between mirror planes; along x only, where the structure is its own image.
    Mirror,
    /// It repeats itself.
    Period,
    /// At a smooth wall that touches the outermost spheres and is as their mirror image; a round or hexagonal one about such an outline.
    Wall,
    /// Nothing holds it.
    Free,
}

/// Why a block cannot be laid.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BlockError {
    /// The sphere diameter is not a positive number.
    #[error("diameter {0} m must be positive")]
    Diameter(f64),
    /// Its layers are no close-packed ones across the wave.
    #[error("layers of {0} are not close-packed across the wave; those of hcp and fcc-111 are")]
    Structure(&'static str),
    /// Too few layers or cells, or more sites than can be simulated.
    #[error("{0} layers of {1} by {2} cells: it has 2 layers and 4 by 3 cells at least, and ten million sites at most")]
    Size(u32, u32, u32),
    /// A mirror across an axis along which the structure has none.
    #[error("y has no mirror: a close packing is not its own image there")]
    Mirror,
    /// An outline between sides that are neither free nor one wall.
    #[error("a round or hexagonal crystal has free sides, or a wall around it")]
    Sides,
    /// An outline that reaches beyond the cells, or holds no sphere of a layer.
    #[error("an outline must lie within the cells and hold spheres of every layer")]
    Outline,
}

/// A crystal of close-packed layers across the wave, HCP or FCC along (111), symmetric about the plane x = 0, of which the half x ≥ 0
/// is held. The axis of the lens, x = y = 0, passes through the centre of a sphere in one of the layers, and so in all that lie
/// straight above each other.
///
/// ```
/// use granulens_core::lattice::{Block, BlockSide, Cell, Layered};
/// let sides = [BlockSide::Period, BlockSide::Period];
/// let block = Block::new(Cell::<3>::named("hcp").unwrap(), 6.35e-3, 24, [14, 8], 4, sides).unwrap();
/// // Of 14 x 16 spheres a layer, those on the planes x = 0 and x = 7 D, which are each 8, count once.
/// assert_eq!((block.layer(1).len(), block.spheres()), (14 * 8 + 8, 24 * 14 * 16));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Block {
    cell: Cell<3>,
    diameter: f64,
    cells: [u32; 2],
    axis_layer: u32,
    sides: [BlockSide; 2],
    outline: Outline,
    sites: Arc<[CrystalSite<3>]>,
    copies: Arc<[u8]>,
    /// Where each layer begins, and where the last ends.
    starts: Arc<[usize]>,
}

/// A sixth of a crystal, between two planes of symmetry through the axis, and how the half x ≥ 0 is made of its images.
#[derive(Clone, Debug, PartialEq)]
pub struct Sixth {
    /// Sites of the half that lie in it, on its planes too, in order.
    pub sites: Vec<usize>,
    /// For each site of the half the place in `sites` of the one that it is an image of, and what makes of a direction across the axis there that at the image.
    pub images: Vec<(usize, [[f64; 2]; 2])>,
}

impl Sixth {
    /// Direction of the plane of symmetry beside x = 0, into the sixth.
    pub fn normal() -> [f64; 3] {
        [-0.5, 0.75_f64.sqrt(), 0.0]
    }
}

/// Steps between neighbours, each followed by its opposite, by layers, halves of a diameter along x and √3/6 diameters along y: within a
/// layer, then from one to the next, where any site has three of each six.
const STEPS: [[i64; 3]; 18] = [
    [0, 2, 0],
    [0, -2, 0],
    [0, 1, 3],
    [0, -1, -3],
    [0, 1, -3],
    [0, -1, 3],
    [1, 0, 2],
    [-1, 0, -2],
    [1, 1, -1],
    [-1, -1, 1],
    [1, -1, -1],
    [-1, 1, 1],
    [1, 0, -2],
    [-1, 0, 2],
    [1, -1, 1],
    [-1, 1, -1],
    [1, 1, 1],
    [-1, -1, -1],
];

/// Close-packed structures across whose layers the wave runs.
const CLOSE: [&str; 2] = ["hcp", "fcc-111"];

const MOST_SITES: f64 = 1e7;

impl Block {
    /// Lays a block of spheres of `diameter` (m): so many layers of so many unit cells along x (one diameter wide) and y (√3 diameters), with
    /// the axis through a sphere of `axis_layer`.
    ///
    /// # Errors
    /// See [`BlockError`].
    pub fn new(
        cell: Cell<3>,
        diameter: f64,
        layers: u32,
        cells: [u32; 2],
        axis_layer: u32,
        sides: [BlockSide; 2],
    ) -> Result<Self, BlockError> {
        if !(diameter.is_finite() && diameter > 0.0) {
            return Err(BlockError::Diameter(diameter));
        }
        if !CLOSE.contains(&cell.name()) {
            return Err(BlockError::Structure(cell.name()));
        }
        let [wide, high] = cells;
        let expected = f64::from(layers) * f64::from(wide) * f64::from(high);
        if layers < 2 || wide < 4 || high < 3 || expected > MOST_SITES {
            return Err(BlockError::Size(layers, wide, high));
        }
        if sides[1] == BlockSide::Mirror {
            return Err(BlockError::Mirror);
        }
        // In halves of a diameter along x and, along y, sixths of the cell, √3/6 diameters.
        let place = |basis: [u8; 3]| [i64::from(basis[0]) / 6, i64::from(basis[1]) / 2];
        let axis = cell.layer(axis_layer.saturating_sub(1)).next().map_or([0, 0], place);
        let (far, edge) = (i64::from(wide), 3 * i64::from(high));
        let [unit_x, unit_y] = [0.5 * diameter, diameter / 12.0_f64.sqrt()];
        let spacing = cell.layer_spacing() * diameter;
        let (mut sites, mut copies, mut starts) = (Vec::new(), Vec::new(), vec![0]);
        for layer in 0..layers {
            let mut places: Vec<[i64; 2]> = Vec::new();
            for basis in cell.layer(layer) {
                let [x, y] = place(basis);
                let columns = (0..=far).filter(|at| (at + axis[0] - x).rem_euclid(2) == 0);
                let rows = (-edge..=edge).filter(|at| (at + axis[1] - y).rem_euclid(6) == 0);
                let rows = rows.filter(|at| sides[1] != BlockSide::Period || *at < edge);
                places.extend(rows.flat_map(|y| columns.clone().map(move |x| [x, y])));
            }
            places.sort_by_key(|&[x, y]| [y, x]);
            for ([x, y], column) in places.into_iter().zip(1..) {
                let centre = [x as f64 * unit_x, y as f64 * unit_y, f64::from(layer) * spacing];
                sites.push(CrystalSite { layer: layer + 1, column, centre });
                // Of a period the two rims are one.
                copies.push(if x == 0 || (x == far && sides[0] == BlockSide::Period) { 1 } else { 2 });
            }
            starts.push(sites.len());
        }
        let (sites, copies, starts) = (sites.into(), copies.into(), starts.into());
        Ok(Self { cell, diameter, cells, axis_layer, sides, outline: Outline::All, sites, copies, starts })
    }

    /// Of the same crystal what lies within an outline about the axis, with free sides or a wall around it. About a sphere's centre close packings keep three
    /// planes of symmetry at 60 degrees, and so does a disk, or a hexagon whose corners lie along x.
    ///
    /// # Errors
    /// Other sides; an outline that reaches beyond the cells, or holds nothing of a layer.
    pub fn within(self, outline: Outline) -> Result<Self, BlockError> {
        let reach = match outline {
            Outline::All => return Ok(self),
            Outline::Hexagon(radius) => [radius, 0.75_f64.sqrt() * radius],
            Outline::Disk(radius) => [radius; 2],
        };
        if ![[BlockSide::Free; 2], [BlockSide::Wall; 2]].contains(&self.sides) {
            return Err(BlockError::Sides);
        }
        let most = self.half_widths().map(|half| half / self.diameter * (1.0 + 1e-9));
        if !(reach[0] <= most[0] && reach[1] <= most[1]) {
            return Err(BlockError::Outline);
        }
        let (mut sites, mut copies, mut starts) = (Vec::new(), Vec::new(), vec![0]);
        for layer in 1..=self.layers() {
            let held = |&i: &usize| encloses(outline, &self.sites[i].centre.map(|at| at / self.diameter));
            for (i, column) in self.layer(layer).filter(held).zip(1..) {
                sites.push(CrystalSite { column, ..self.sites[i] });
                copies.push(self.copies[i]);
            }
            if starts.last() == Some(&sites.len()) {
                return Err(BlockError::Outline);
            }
            starts.push(sites.len());
        }
        Ok(Self { outline, sites: sites.into(), copies: copies.into(), starts: starts.into(), ..self })
    }

    /// What of its cells there is.
    pub fn outline(&self) -> Outline {
        self.outline
    }

    /// Radius of the disk of the area of its cross-section (m).
    pub fn disk(&self) -> f64 {
        let [x, y] = self.half_widths();
        match self.outline {
            Outline::All => (4.0 * x * y / PI).sqrt(),
            // An area of 3/2 √3 R².
            Outline::Hexagon(radius) => radius * self.diameter * (1.5 * 3.0_f64.sqrt() / PI).sqrt(),
            Outline::Disk(radius) => radius * self.diameter,
        }
    }

    /// Structure.
    pub fn cell(&self) -> Cell<3> {
        self.cell
    }

    /// Sphere diameter D (m).
    pub fn diameter(&self) -> f64 {
        self.diameter
    }

    /// Unit cells of the whole crystal along x and y.
    pub fn cells(&self) -> [u32; 2] {
        self.cells
    }

    /// A layer in which the axis passes through the centre of a sphere.
    pub fn axis_layer(&self) -> u32 {
        self.axis_layer
    }

    /// How it ends along x and y.
    pub fn sides(&self) -> [BlockSide; 2] {
        self.sides
    }

    /// Distance between layers, √(2/3) D (m).
    pub fn layer_spacing(&self) -> f64 {
        self.cell.layer_spacing() * self.diameter
    }

    /// From the axis to the edge along x and y (m): to the far plane of symmetry, or half a period.
    pub fn half_widths(&self) -> [f64; 2] {
        let [wide, high] = self.cells.map(f64::from);
        [0.5 * wide * self.diameter, 0.75_f64.sqrt() * high * self.diameter]
    }

    /// The sites of the half x ≥ 0, layer by layer, each in order of y, then x; centres from the axis on.
    pub fn sites(&self) -> &[CrystalSite<3>] {
        &self.sites
    }

    /// For each site the spheres of the whole crystal that it stands for: one on the plane x = 0, two beside it.
    pub fn copies(&self) -> &[u8] {
        &self.copies
    }

    /// Spheres of the whole crystal.
    pub fn spheres(&self) -> usize {
        self.copies.iter().map(|&copies| usize::from(copies)).sum()
    }

    /// A site's place in whole numbers: halves of a diameter along x, sixths of a cell, √3/6 D, along y. Of sites [a, b] of a layer those with the
    /// same 3a² + b² are as far from the axis.
    pub fn place(&self, index: usize) -> [i64; 2] {
        let [x, y, _] = self.sites[index].centre;
        [(2.0 * x / self.diameter).round() as i64, (y * 12.0_f64.sqrt() / self.diameter).round() as i64]
    }

    /// What of a round or hexagonal crystal lies between the plane x = 0 and the one at 60 degrees to it, a sixth: all else is its image in three planes of
    /// symmetry. None of a rectangle, whose rim is not turned into itself.
    pub fn sixth(&self) -> Option<Sixth> {
        if self.outline == Outline::All {
            return None;
        }
        let places: Vec<(u32, [i64; 2])> =
            self.sites.iter().enumerate().map(|(i, site)| (site.layer, self.place(i))).collect();
        // The other plane holds the places [a, a].
        let is_inside = |[a, b]: [i64; 2]| b >= a;
        let sites: Vec<usize> = (0..places.len()).filter(|&i| is_inside(places[i].1)).collect();
        let at: HashMap<(u32, [i64; 2]), usize> = sites.iter().enumerate().map(|(k, &i)| (places[i], k)).collect();
        let (sine, cosine) = (0.75_f64.sqrt(), 0.5);
        let image = |&(layer, [a, b]): &(u32, [i64; 2])| {
            if is_inside([a, b]) {
                return Some((*at.get(&(layer, [a, b]))?, [[1.0, 0.0], [0.0, 1.0]]));
            }
            // In the other plane, and from there, if need be, in x = 0; and the way back.
            let across = (a + b) / 2;
            let back = if across < 0 { -1.0 } else { 1.0 };
            let turn = [[cosine * back, sine], [sine * back, -cosine]];
            Some((*at.get(&(layer, [across.abs(), (3 * a - b) / 2]))?, turn))
        };
        let images = places.iter().map(image).collect::<Option<Vec<_>>>()?;
        Some(Sixth { sites, images })
    }

    /// For each site the sites of the half that the eighteen steps between close-packed neighbours lead to: twelve of them inside.
    /// Beyond the plane x = 0 and a far plane of symmetry lie images, beyond a period the other rim.
    pub fn beside(&self) -> Vec<[Option<usize>; 18]> {
        let far = i64::from(self.cells[0]);
        let edge = 3 * i64::from(self.cells[1]);
        let at: HashMap<(u32, [i64; 2]), usize> =
            self.sites.iter().enumerate().map(|(i, site)| ((site.layer, self.place(i)), i)).collect();
        let folded = matches!(self.sides[0], BlockSide::Mirror | BlockSide::Period);
        let to = |index: usize, [down, across, along]: [i64; 3]| {
            let [x, y] = self.place(index);
            let x = (x + across).abs();
            let x = if folded && x > far { 2 * far - x } else { x };
            let y = match self.sides[1] {
                BlockSide::Period => (y + along + edge).rem_euclid(2 * edge) - edge,
                _ => y + along,
            };
            let layer = u32::try_from(i64::from(self.sites[index].layer) + down).ok()?;
            at.get(&(layer, [x, y])).copied()
        };
        (0..self.sites.len()).map(|index| STEPS.map(|step| to(index, step))).collect()
    }

    /// A site's place by whole numbers, each about one diameter or row: layer, along x from the axis on, along y from the far end on.
    pub fn coordinates(&self, index: usize) -> [u32; 3] {
        let ([x, y], edge) = (self.place(index), 3 * i64::from(self.cells[1]));
        [self.sites[index].layer, (x / 2) as u32, ((y + edge + 1) / 3) as u32]
    }

    /// Index of a site in [`sites`](Self::sites); both count from 1.
    pub fn index(&self, layer: u32, column: u32) -> Option<usize> {
        let layer = (1..=self.layers()).contains(&layer).then(|| self.layer(layer))?;
        let index = layer.start + (column as usize).checked_sub(1)?;
        layer.contains(&index).then_some(index)
    }
}

impl Layered for Block {
    fn layers(&self) -> u32 {
        (self.starts.len() - 1) as u32
    }

    fn layer(&self, layer: u32) -> Range<usize> {
        self.starts[layer as usize - 1]..self.starts[layer as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn block(name: &str, axis_layer: u32, sides: [BlockSide; 2]) -> Block {
        Block::new(Cell::<3>::named(name).unwrap(), 1.0, 6, [7, 4], axis_layer, sides).unwrap()
    }

    /// Both halves, each rim once where the crystal repeats itself, have twelve neighbours inside, whichever layer the axis is set by; and
    /// the axis goes through a sphere there.
    #[test]
    fn the_whole_of_a_block_is_a_close_packing() {
        for (name, axis_layer) in [("hcp", 1), ("hcp", 4), ("fcc-111", 1), ("fcc-111", 2), ("fcc-111", 6)] {
            let block = block(name, axis_layer, [BlockSide::Period; 2]);
            let [half, high] = block.half_widths();
            let mut whole: Vec<[f64; 3]> = Vec::new();
            for (site, copies) in block.sites().iter().zip(block.copies()) {
                let [x, y, z] = site.centre;
                whole.push([x, y, z]);
                if *copies == 2 {
                    whole.push([-x, y, z]);
                }
            }
            assert_eq!(whole.len(), 6 * 7 * 8);
            for a in whole.iter().filter(|a| (0.5..4.0).contains(&a[2])) {
                let near = |b: &&[f64; 3]| {
                    let [mut x, mut y, z] = [b[0] - a[0], b[1] - a[1], b[2] - a[2]];
                    x -= 2.0 * half * (x / (2.0 * half)).round();
                    y -= 2.0 * high * (y / (2.0 * high)).round();
                    (x * x + y * y + z * z).sqrt() < 1.0 + 1e-9
                };
                assert_eq!(whole.iter().filter(near).count(), 13, "{name} {axis_layer} {a:?}");
            }
            let on_axis = |site: &CrystalSite<3>| site.centre[0] == 0.0 && site.centre[1] == 0.0;
            assert!(block.sites().iter().any(|site| site.layer == axis_layer && on_axis(site)), "{name} {axis_layer}");
            for (index, site) in block.sites().iter().enumerate() {
                assert_eq!(block.index(site.layer, site.column), Some(index));
            }
            assert_eq!((block.index(7, 1), block.index(1, 1000), block.index(1, 0)), (None, None, None));
        }
    }

    /// Steps lead to what is a diameter away, over images and periods too: to all of it, once for each way there.
    #[test]
    fn steps_lead_to_neighbours() {
        let all = [BlockSide::Period, BlockSide::Mirror, BlockSide::Wall, BlockSide::Free];
        for (name, across) in [("hcp", 0), ("fcc-111", 1), ("hcp", 2), ("fcc-111", 3)] {
            for along in [BlockSide::Period, BlockSide::Free] {
                let block = block(name, 3, [all[across], along]);
                let [half, high] = block.half_widths();
                for (a, steps) in block.sites().iter().zip(block.beside()) {
                    let mut found: Vec<usize> = steps.into_iter().flatten().collect();
                    found.sort_unstable();
                    let mut expected = Vec::new();
                    for (j, b) in block.sites().iter().enumerate() {
                        // Images of b; on a plane of symmetry it is its own.
                        let [x, y, z] = b.centre;
                        let mut xs = vec![x, -x];
                        xs.extend([2.0 * half - x].into_iter().filter(|_| across < 2));
                        let ys =
                            if along == BlockSide::Period { vec![y, y - 2.0 * high, y + 2.0 * high] } else { vec![y] };
                        let mut places: Vec<[f64; 2]> =
                            xs.iter().flat_map(|&x| ys.iter().map(move |&y| [x, y])).collect();
                        places.dedup_by(|p, q| p == q);
                        places.sort_by(|p, q| p.partial_cmp(q).unwrap());
                        places.dedup_by(|p, q| (p[0] - q[0]).abs() < 1e-9 && (p[1] - q[1]).abs() < 1e-9);
                        let apart = |[x, y]: &[f64; 2]| (x - a.centre[0]).hypot(y - a.centre[1]).hypot(z - a.centre[2]);
                        expected.extend(places.iter().filter(|at| (apart(at) - 1.0).abs() < 1e-9).map(|_| j));
                    }
                    assert_eq!(found, expected, "{name} {across} {along:?} {a:?}");
                }
            }
        }
    }

    /// A disk and a hexagon about a sphere are their own images when they are turned by 120 degrees; a layer of a hexagon of circumradius 3 D about
    /// one of its spheres has 1 + 6 + 12 + 18 of them.
    #[test]
    fn outlines_keep_three_planes_of_symmetry() {
        for name in ["hcp", "fcc-111"] {
            for outline in [Outline::Disk(3.4), Outline::Hexagon(3.0)] {
                let block = block(name, 3, [BlockSide::Free; 2]).within(outline).unwrap();
                let turned = |[x, y, z]: [f64; 3]| {
                    let (sine, cosine) = (0.75_f64.sqrt(), -0.5);
                    [(x * cosine - y * sine).abs(), x * sine + y * cosine, z]
                };
                for site in block.sites() {
                    let to = turned(site.centre);
                    let is_there = |other: &CrystalSite<3>| (0..3).all(|k| (other.centre[k] - to[k]).abs() < 1e-9);
                    assert!(block.sites().iter().any(is_there), "{name} {outline:?} {site:?}");
                    assert_eq!(block.index(site.layer, site.column).map(|i| &block.sites()[i]), Some(site));
                }
                if outline == Outline::Hexagon(3.0) {
                    let copies =
                        |layer| block.copies()[block.layer(layer)].iter().map(|&c| usize::from(c)).sum::<usize>();
                    assert_eq!(copies(3), 37);
                }
            }
        }
        let free = [BlockSide::Free; 2];
        assert_eq!(block("hcp", 3, [BlockSide::Period; 2]).within(Outline::Disk(3.0)), Err(BlockError::Sides));
        let one = block("hcp", 3, [BlockSide::Free, BlockSide::Wall]);
        assert_eq!(one.within(Outline::Disk(3.0)), Err(BlockError::Sides));
        assert_eq!(block("hcp", 3, free).within(Outline::Disk(3.6)), Err(BlockError::Outline));
        assert_eq!(block("hcp", 3, free).within(Outline::Disk(f64::NAN)), Err(BlockError::Outline));
    }

    /// Each site of the half is where the way back leads from its image in the sixth, each of these stands for one, two or three of the half, and by areas it is a
    /// third of it.
    #[test]
    fn a_half_is_made_of_images_of_a_sixth() {
        for (name, axis_layer) in [("hcp", 3), ("fcc-111", 1), ("fcc-111", 2)] {
            for outline in [Outline::Disk(3.4), Outline::Hexagon(3.0)] {
                for side in [BlockSide::Free, BlockSide::Wall] {
                    let block = block(name, axis_layer, [side; 2]).within(outline).unwrap();
                    let Sixth { sites, images } = block.sixth().unwrap();
                    let normal = Sixth::normal();
                    let mut whole = vec![0; sites.len()];
                    for (i, (k, turn)) in images.iter().enumerate() {
                        let ([x, y, z], to) = (block.sites()[sites[*k]].centre, block.sites()[i].centre);
                        let led = [turn[0][0] * x + turn[0][1] * y, turn[1][0] * x + turn[1][1] * y, z];
                        assert!((0..3).all(|k| (led[k] - to[k]).abs() < 1e-9), "{name} {outline:?} {to:?} {led:?}");
                        whole[*k] += block.copies()[i];
                    }
                    for (k, &i) in sites.iter().enumerate() {
                        assert_eq!(images[i].0, k);
                        let [x, y, _] = block.sites()[i].centre;
                        let away = normal[0] * x + normal[1] * y;
                        assert!(away > -1e-9, "{away}");
                        let expected = match (x < 1e-9, away < 1e-9) {
                            (true, true) => 1,
                            (false, false) => 6,
                            _ => 3,
                        };
                        assert_eq!(whole[k], expected, "{name} {outline:?} {x} {y}");
                    }
                }
            }
        }
        assert_eq!(block("hcp", 3, [BlockSide::Free; 2]).sixth(), None);
    }

    #[test]
    fn what_cannot_be_laid_is_refused() {
        let cell = Cell::<3>::named("hcp").unwrap();
        let free = [BlockSide::Free; 2];
        assert!(Block::new(cell, 1.0, 6, [3, 4], 1, free).is_err());
        assert!(Block::new(cell, f64::NAN, 6, [7, 4], 1, free).is_err());
        assert!(Block::new(cell, 1.0, 100_000, [7000, 4000], 1, free).is_err());
        let mirrored = [BlockSide::Free, BlockSide::Mirror];
        assert_eq!(Block::new(cell, 1.0, 6, [7, 4], 1, mirrored), Err(BlockError::Mirror));
        assert!(Block::new(Cell::<3>::named("bcc-001").unwrap(), 1.0, 6, [7, 4], 1, free).is_err());
    }
}
