//! Who stands beside whom in a [`Space`], a hexagonal sheet or a crystal in space, and changes of connected pieces.

use super::{Assignment, Rng, Space};

/// Steps from a site to its six neighbours, by rows and half diameters: along the row, and along the two other close-packed
/// directions; each followed by its opposite.
const STEPS: [[i64; 2]; 6] = [[0, 2], [0, -2], [1, 1], [-1, -1], [1, -1], [-1, 1]];

/// The neighbours of every site. In a sheet rows of even number stand half a diameter further from the axis than those of odd number, and
/// what lies beyond the axis is the image of what lies before it.
#[derive(Clone, Debug)]
pub(super) struct Beside {
    /// For each site and each step the site that it leads to, where that may change.
    beside: Vec<Vec<Option<usize>>>,
    /// Most steps of a site.
    directions: usize,
}

impl Beside {
    pub fn new(space: &Space) -> Self {
        let beside = match &space.adjacency {
            Some(adjacency) => adjacency.beside.clone(),
            None => Self::of_sheet(space),
        };
        Self { directions: beside.iter().map(Vec::len).max().unwrap_or(0), beside }
    }

    fn of_sheet(space: &Space) -> Vec<Vec<Option<usize>>> {
        let first = |row: i64| (row + 1).rem_euclid(2);
        let place: std::collections::HashMap<[i64; 2], usize> = space
            .sites
            .iter()
            .enumerate()
            .map(|(i, &[row, column, _])| ([i64::from(row), first(row.into()) + 2 * i64::from(column)], i))
            .collect();
        // Columns count from 1.
        let image = |x: i64| if x < 2 { 4 - x } else { x };
        space
            .sites
            .iter()
            .map(|&[row, column, _]| {
                let (row, x) = (i64::from(row), first(row.into()) + 2 * i64::from(column));
                STEPS.map(|[down, across]| place.get(&[row + down, image(x + across)]).copied()).to_vec()
            })
            .collect()
    }

    /// The neighbours of a site that may change.
    pub fn neighbours(&self, site: usize) -> impl Iterator<Item = usize> + '_ {
        self.beside[site].iter().copied().flatten().filter(move |&other| other != site)
    }

    /// The site after a step from another.
    pub fn step(&self, site: usize, direction: usize) -> Option<usize> {
        let steps = &self.beside[site];
        steps.get(direction % steps.len().max(1)).copied().flatten()
    }

    /// One of the directions, of which a sheet has six.
    pub fn direction(&self, rng: &mut Rng) -> usize {
        rng.below(self.directions as u64) as usize
    }

    /// All sites that at most `radius` steps lead to, that itself first.
    pub fn disc(&self, middle: usize, radius: u64) -> Vec<usize> {
        let mut disc = vec![middle];
        let mut from = 0;
        for _ in 0..radius {
            let to = disc.len();
            for k in from..to {
                for other in self.neighbours(disc[k]) {
                    if !disc.contains(&other) {
                        disc.push(other);
                    }
                }
            }
            from = to;
        }
        disc
    }

    /// At most `length` sites in line from one, in a close-packed direction.
    pub fn line(&self, site: usize, direction: usize, length: u64) -> Vec<usize> {
        let mut line = vec![site];
        while (line.len() as u64) < length {
            let Some(next) = self.step(line[line.len() - 1], direction).filter(|next| !line.contains(next)) else {
                break;
            };
            line.push(next);
        }
        line
    }

    /// Moves what stands on some sites by one step; what is left behind stays, and what would come from elsewhere than a site that may
    /// change does not come.
    pub fn shift(&self, assignment: &Assignment, sites: &[usize], direction: usize) -> Assignment {
        let mut moved = assignment.clone();
        for &site in sites {
            if let Some(to) = self.step(site, direction) {
                moved[to] = assignment[site];
            }
        }
        moved
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against distances in a sheet of seven rows of five, in diameters: six neighbours inside, fewer at edges, images across the axis.
    #[test]
    fn neighbours_are_a_diameter_away() {
        let space = Space::sheet((0..35).map(|k| [1 + k / 5, 1 + k % 5]), 2);
        let beside = Beside::new(&space);
        let place = |&[row, column, _]: &[u32; 3]| {
            let x = f64::from(column) - if row % 2 == 0 { 0.5 } else { 1.0 };
            [x, f64::from(row) * 0.75_f64.sqrt()]
        };
        let places: Vec<[f64; 2]> = space.sites.iter().map(place).collect();
        for (i, a) in places.iter().enumerate() {
            let touches = |b: &[f64; 2]| {
                [1.0, -1.0].into_iter().any(|side| ((a[0] - side * b[0]).hypot(a[1] - b[1]) - 1.0).abs() < 1e-9)
            };
            let mut found: Vec<usize> = beside.neighbours(i).collect();
            found.sort_unstable();
            found.dedup();
            let expected: Vec<usize> = (0..35).filter(|&j| j != i && touches(&places[j])).collect();
            assert_eq!(found, expected, "{a:?}");
        }
        // Row 4, column 3.
        let middle = 17;
        assert_eq!([0, 1, 2].map(|radius| beside.disc(middle, radius).len()), [1, 7, 19]);
        let line = beside.line(middle, 2, 3);
        assert_eq!(line.iter().map(|&k| places[k][0] - places[middle][0]).collect::<Vec<_>>(), [0.0, 0.5, 1.0]);
    }

    #[test]
    fn a_block_moves_by_one_step() {
        let space = Space::sheet((0..16).map(|k| [1 + k / 4, 1 + k % 4]), 2);
        let beside = Beside::new(&space);
        let assignment: Assignment = (0..16).map(|k| u8::from(k == 5)).collect();
        let moved = beside.shift(&assignment, &[5, 9, 6], 0);
        // Site 5 went to 6, 6 to 7, 9 to 10.
        assert_eq!((0..16).filter(|&k| moved[k] == 1).collect::<Vec<_>>(), [5, 6]);
    }
}
