//! A crystal as rows of touching spheres, and who lies where to whom: two rows that lie alike have neighbours that lie alike.
//!
//! So neighbours are found row by row, in time and memory that go with the number of rows, and are held as strands: contact k of a strand is
//! between sphere a + k and sphere b + k, and all of them have one offset.

use std::collections::BTreeMap;

use crate::dem::boundary::{Mirror, Period};
use crate::dem::neighbour::{NEAR, OverlapAtRest, image_gap};
use crate::dem::size::{TOUCHING, reference_radius};
use crate::sample::Sample;

/// Longer rows are cut, so that what is laid by for one row stays in the nearest cache. A multiple of eight.
pub const MOST_IN_ROW: usize = 512;

/// Spheres that follow each other along the first axis, each touching the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// Index of the first in the sample.
    pub first: usize,
    pub count: usize,
    /// Centre of the first (m).
    pub centre: [f64; 3],
}

/// Pairs of spheres of two rows, each with the same offset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Strand {
    /// The two rows; the first does not come after the second.
    pub rows: [usize; 2],
    /// Where in them the pairs begin.
    pub from: [usize; 2],
    pub count: usize,
    /// Place in the table of offsets.
    pub offset: usize,
}

/// From one centre to the other, or its nearest image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Offset {
    /// (m)
    pub between: [f64; 3],
    /// |between|² − D² (m²); exactly zero where the spheres just touch.
    pub gap_squared: f64,
    /// The part of a contact that belongs to the simulated half.
    pub weight: f64,
}

/// Spheres of a row that touch their own image in a mirror, or nearly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImageStrand {
    pub row: usize,
    pub from: usize,
    pub count: usize,
    pub axis: usize,
    pub inward: f64,
    /// From surface to surface at rest (m).
    pub gap: f64,
    /// The part of each sphere that belongs to the simulated half.
    pub part: f64,
}

/// A sphere on mirrors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OnMirror {
    pub row: usize,
    pub at: usize,
    /// The part of it that belongs to the simulated half.
    pub weight: f64,
    /// Per axis 1/weight, or 0 across a mirror.
    pub mobility: [f64; 3],
}

/// Rows, and all pairs that count.
#[derive(Clone, Debug)]
pub struct Neighbours {
    /// Sphere diameter (m).
    pub diameter: f64,
    pub rows: Vec<Row>,
    pub offsets: Vec<Offset>,
    /// What touches or nearly touches at rest, in order of the first row.
    pub contacts: Vec<Strand>,
    /// All other pairs nearer than two diameters.
    pub strangers: Vec<Strand>,
    pub images: Vec<ImageStrand>,
    pub on_mirrors: Vec<OnMirror>,
}

/// Why a packing is not followed by its rows.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RowsError {
    /// It cannot be simulated as it lies.
    #[error(transparent)]
    Overlap(#[from] OverlapAtRest),
    /// Radii differ, or there are none.
    #[error("spheres of one size are asked for, each sphere there")]
    Sizes,
    /// Most spheres have no neighbour beside them.
    #[error("{rows} rows of {spheres} spheres: in a crystal whose first axis lies along rows, rows are longer")]
    Short {
        /// Rows.
        rows: usize,
        /// Spheres.
        spheres: usize,
    },
}

impl Neighbours {
    /// Finds the rows of a sample and all neighbours.
    ///
    /// # Errors
    /// See [`RowsError`].
    pub fn find(sample: &Sample<3>, mirrors: &[Mirror], periods: &[Period]) -> Result<Self, RowsError> {
        let radius = reference_radius(sample);
        if sample.spheres.is_empty() || sample.spheres.iter().any(|sphere| sphere.radius != radius) {
            return Err(RowsError::Sizes);
        }
        let rows = rows(sample, 2.0 * radius);
        if 3 * rows.len() > sample.spheres.len() {
            return Err(RowsError::Short { rows: rows.len(), spheres: sample.spheres.len() });
        }
        let mut found = Self {
            diameter: 2.0 * radius,
            rows,
            offsets: Vec::new(),
            contacts: Vec::new(),
            strangers: Vec::new(),
            images: Vec::new(),
            on_mirrors: Vec::new(),
        };
        found.find_images(sample, mirrors)?;
        found.find_pairs(periods)?;
        Ok(found)
    }

    fn find_images(&mut self, sample: &Sample<3>, mirrors: &[Mirror]) -> Result<(), OverlapAtRest> {
        let radius = 0.5 * self.diameter;
        for (row, &Row { first, count, .. }) in self.rows.iter().enumerate() {
            let carried = self.on_mirrors.len();
            for at in 0..count {
                let centre = &sample.spheres[first + at].centre;
                let (mut weight, mut mobility) = (1.0, [1.0; 3]);
                for mirror in mirrors.iter().filter(|mirror| mirror.carries(centre, radius)) {
                    weight *= 0.5;
                    mobility[mirror.axis] = 0.0;
                }
                if weight < 1.0 {
                    let mobility = mobility.map(|part: f64| part / weight);
                    self.on_mirrors.push(OnMirror { row, at, weight, mobility });
                }
            }
            for mirror in mirrors {
                for at in 0..count {
                    let sphere = first + at;
                    let gap = image_gap(sample, sphere, &(*mirror).into());
                    if mirror.carries(&sample.spheres[sphere].centre, radius) || gap > 2.0 * NEAR * radius {
                        continue;
                    }
                    if gap < -TOUCHING * radius {
                        return Err(OverlapAtRest { pair: [sphere; 2], overlap: -gap });
                    }
                    let Mirror { axis, inward, .. } = *mirror;
                    let part = self.on_mirrors[carried..].iter().find(|on| on.at == at).map_or(1.0, |on| on.weight);
                    match self.images.last_mut() {
                        Some(last)
                            if last.row == row
                                && last.from + last.count == at
                                && (last.axis, last.inward, last.gap, last.part) == (axis, inward, gap, part) =>
                        {
                            last.count += 1;
                        }
                        _ => self.images.push(ImageStrand { row, from: at, count: 1, axis, inward, gap, part }),
                    }
                }
            }
        }
        Ok(())
    }

    fn find_pairs(&mut self, periods: &[Period]) -> Result<(), OverlapAtRest> {
        let reach = 2.0 * self.diameter * (1.0 - TOUCHING);
        // Rows by where they lie across, in cells as wide as is looked.
        let period = |axis: usize| periods.iter().find(|period| period.axis == axis).map(|period| period.length);
        let cells = [1, 2].map(|axis| period(axis).map(|length| (length / reach).floor().max(1.0)));
        let home = |row: &Row| -> [i64; 2] {
            std::array::from_fn(|k| match (period(k + 1), cells[k]) {
                (Some(length), Some(count)) => {
                    ((row.centre[k + 1] / length * count).floor() as i64).rem_euclid(count as i64)
                }
                _ => (row.centre[k + 1] / reach).floor() as i64,
            })
        };
        let mut by_cell: BTreeMap<[i64; 2], Vec<usize>> = BTreeMap::new();
        for (index, row) in self.rows.iter().enumerate() {
            by_cell.entry(home(row)).or_default().push(index);
        }
        let beside = |k: usize, at: i64| -> Vec<i64> {
            let mut all: Vec<i64> = (-1..=1).map(|step| at + step).collect();
            if let Some(count) = cells[k] {
                all.iter_mut().for_each(|cell| *cell = cell.rem_euclid(count as i64));
                all.sort_unstable();
                all.dedup();
            }
            all
        };
        let on_mirrors = std::mem::take(&mut self.on_mirrors);
        let weights = Weights::new(&on_mirrors, self.rows.len());
        let mut offsets = Offsets { diameter: self.diameter, by_place: BTreeMap::new(), all: Vec::new() };
        for a in 0..self.rows.len() {
            let at = home(&self.rows[a]);
            let mut others: Vec<usize> = Vec::new();
            for y in beside(0, at[0]) {
                for z in beside(1, at[1]) {
                    others.extend(by_cell.get(&[y, z]).into_iter().flatten().filter(|&&b| b >= a));
                }
            }
            others.sort_unstable();
            for b in others {
                self.between_rows([a, b], reach, periods, &weights, &mut offsets)?;
            }
        }
        self.offsets = offsets.all;
        self.on_mirrors = on_mirrors;
        Ok(())
    }

    /// All pairs of two rows.
    fn between_rows(
        &mut self,
        rows: [usize; 2],
        reach: f64,
        periods: &[Period],
        weights: &Weights<'_>,
        offsets: &mut Offsets,
    ) -> Result<(), OverlapAtRest> {
        let [a, b] = rows.map(|row| self.rows[row]);
        let straight: [f64; 3] = std::array::from_fn(|k| b.centre[k] - a.centre[k]);
        let across = Period::nearest(periods, [0.0, straight[1], straight[2]]);
        if across[1].powi(2) + across[2].powi(2) >= reach * reach {
            return Ok(());
        }
        let along = periods.iter().find(|period| period.axis == 0).map_or(0.0, |period| period.length);
        let images: &[f64] = if along > 0.0 { &[-1.0, 0.0, 1.0] } else { &[0.0] };
        let mut shifts: Vec<i64> = Vec::new();
        for image in images {
            let middle = (-(straight[0] + image * along) / self.diameter).round() as i64;
            shifts.extend(middle - 3..=middle + 3);
        }
        shifts.sort_unstable();
        shifts.dedup();
        for shift in shifts {
            // A pair of one row is told from its first sphere.
            if rows[0] == rows[1] && shift <= 0 {
                continue;
            }
            let between = [straight[0] + shift as f64 * self.diameter, straight[1], straight[2]];
            let between = Period::nearest(periods, between);
            let distance = between.iter().map(|x| x * x).sum::<f64>().sqrt();
            if distance >= reach {
                continue;
            }
            let from = [(-shift).max(0) as usize, shift.max(0) as usize];
            let end = (a.count as i64).min(b.count as i64 - shift);
            let count = end - from[0] as i64;
            if count <= 0 {
                continue;
            }
            let gap = distance - self.diameter;
            if gap < -TOUCHING * self.diameter {
                return Err(OverlapAtRest { pair: [a.first + from[0], b.first + from[1]], overlap: -gap });
            }
            let strand = Strand { rows, from, count: count as usize, offset: 0 };
            if gap <= NEAR * self.diameter {
                for (part, weight) in weights.parts(&strand, &between) {
                    self.contacts.push(Strand { offset: offsets.place(between, weight), ..part });
                }
            } else {
                self.strangers.push(Strand { offset: offsets.place(between, 1.0), ..strand });
            }
        }
        Ok(())
    }
}

/// The few offsets that occur, each once.
struct Offsets {
    diameter: f64,
    by_place: BTreeMap<([i64; 3], u64), usize>,
    all: Vec<Offset>,
}

impl Offsets {
    fn place(&mut self, between: [f64; 3], weight: f64) -> usize {
        // Places that differ by rounding are one.
        let grid = between.map(|x| (x / self.diameter / (8.0 * TOUCHING)).round() as i64);
        *self.by_place.entry((grid, weight.to_bits())).or_insert_with(|| {
            let squared = between.iter().map(|x| x * x).sum::<f64>();
            let touches = (squared.sqrt() - self.diameter).abs() <= TOUCHING * self.diameter;
            let gap_squared = if touches { 0.0 } else { squared - self.diameter * self.diameter };
            self.all.push(Offset { between, gap_squared, weight });
            self.all.len() - 1
        })
    }
}

/// Spheres on mirrors, row by row.
struct Weights<'a> {
    on_mirrors: &'a [OnMirror],
    /// Where those of each row begin.
    first: Vec<usize>,
}

impl<'a> Weights<'a> {
    fn new(on_mirrors: &'a [OnMirror], rows: usize) -> Self {
        let first = (0..=rows).map(|row| on_mirrors.partition_point(|sphere| sphere.row < row)).collect();
        Self { on_mirrors, first }
    }

    fn of(&self, row: usize, at: usize) -> Option<&OnMirror> {
        self.on_mirrors[self.first[row]..self.first[row + 1]].iter().find(|sphere| sphere.at == at)
    }

    /// A strand cut where the weight of its contacts changes: a pair in a mirror plane is shared by both halves.
    fn parts(&self, strand: &Strand, between: &[f64; 3]) -> Vec<(Strand, f64)> {
        let [a, b] = strand.rows;
        if self.first[a] == self.first[a + 1] || self.first[b] == self.first[b + 1] {
            return vec![(*strand, 1.0)];
        }
        let weight = |k: usize| {
            let (first, second) = (self.of(a, strand.from[0] + k), self.of(b, strand.from[1] + k));
            let in_plane = first.zip(second).is_some_and(|(first, second)| {
                (0..3).any(|axis| first.mobility[axis] == 0.0 && second.mobility[axis] == 0.0 && between[axis] == 0.0)
            });
            if in_plane { 0.5 } else { 1.0 }
        };
        let weights: Vec<f64> = (0..strand.count).map(weight).collect();
        let mut parts: Vec<(Strand, f64)> = Vec::new();
        for (k, &weight) in weights.iter().enumerate() {
            match parts.last_mut() {
                Some((part, of_part)) if *of_part == weight => part.count += 1,
                _ => {
                    let from = strand.from.map(|from| from + k);
                    parts.push((Strand { from, count: 1, ..*strand }, weight));
                }
            }
        }
        parts
    }
}

fn rows(sample: &Sample<3>, diameter: f64) -> Vec<Row> {
    let mut rows: Vec<Row> = Vec::new();
    for (i, sphere) in sample.spheres.iter().enumerate() {
        if let Some(row) = rows.last_mut() {
            let expected = row.centre[0] + row.count as f64 * diameter;
            let off = [sphere.centre[0] - expected, sphere.centre[1] - row.centre[1], sphere.centre[2] - row.centre[2]];
            if row.count < MOST_IN_ROW && off.iter().all(|off| off.abs() <= TOUCHING * diameter) {
                row.count += 1;
                continue;
            }
        }
        rows.push(Row { first: i, count: 1, centre: sphere.centre });
    }
    rows
}
