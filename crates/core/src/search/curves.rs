//! Choices between free curves: each letter but the first fills a band whose two faces run over the columns as they like.

use super::method::{Parameters, Row};
use super::{Assignment, Parametrisation, Space, parametric};

/// CMA-ES over the faces of bands, one band for each letter but the first; from those that are nearest to the start.
pub(super) const METHOD: Row = Row {
    name: "curves",
    about: "CMA-ES over bands between free curves, one for each material but the first",
    parameters: Parameters::Fields(Parametrisation::curves),
    ..parametric::METHOD
};

/// The bands of a space: faces by their heights at knots, which stand evenly over the columns.
#[derive(Clone, Debug)]
pub struct Bands {
    knots: usize,
    alphabet: u8,
    /// For each site its row, from -1 for the first to 1 for the last.
    rows: Vec<f64>,
    /// For each site by how much of each knot's height a face runs over it.
    shares: Vec<Vec<f64>>,
    /// Half the distance of two rows, in these units.
    rim: f64,
}

impl Bands {
    /// Faces with `knots` heights each, at least two.
    pub fn new(space: &Space, knots: usize) -> Self {
        let knots = knots.max(2);
        let [(first, height), (left, width)] = [space.range(0), space.range(1)];
        Self {
            knots,
            alphabet: space.alphabet,
            rows: space.sites.iter().map(|site| 2.0 * (f64::from(site[0]) - first) / height - 1.0).collect(),
            shares: space.sites.iter().map(|site| shares((f64::from(site[1]) - left) / width, knots)).collect(),
            rim: 1.0 / height,
        }
    }

    /// On each site the letter whose band it lies in, of several the one it lies in deepest; the first letter in none.
    /// `heights` are of each letter in turn its face before and its face behind, at every knot.
    pub fn assignment(&self, heights: &[f64]) -> Assignment {
        let over = |face: &[f64], shares: &[f64]| face.iter().zip(shares).map(|(y, share)| y * share).sum::<f64>();
        let deepest = |(&row, shares): (&f64, &Vec<f64>)| {
            let mut best = (0.0, 0);
            for (letter, band) in (1..self.alphabet).zip(heights.chunks(2 * self.knots)) {
                let (before, behind) = band.split_at(self.knots);
                let depth = (row - over(before, shares)).min(over(behind, shares) - row);
                if depth > best.0 {
                    best = (depth, letter);
                }
            }
            best.1
        };
        self.rows.iter().zip(&self.shares).map(deepest).collect()
    }

    /// The heights whose bands come near to an assignment: at every knot the mean of where the letter begins and where it ends in the
    /// columns around. A band is closed where its letter is not.
    pub fn fit(&self, assignment: &[u8]) -> Vec<f64> {
        (1..self.alphabet).flat_map(|letter| self.faces(assignment, letter)).collect()
    }

    /// Of one letter: its face before, then its face behind.
    fn faces(&self, assignment: &[u8], letter: u8) -> Vec<f64> {
        // Of each column, known by its shares, where the letter begins and ends.
        let mut columns: Vec<(&[f64], [f64; 2])> = Vec::new();
        for ((row, shares), _) in
            self.rows.iter().zip(&self.shares).zip(assignment).filter(|(_, there)| **there == letter)
        {
            let column = match columns.iter().position(|(known, _)| known == shares) {
                Some(column) => column,
                None => {
                    columns.push((shares, [f64::INFINITY, f64::NEG_INFINITY]));
                    columns.len() - 1
                }
            };
            let [begins, ends] = &mut columns[column].1;
            (*begins, *ends) = (begins.min(row - self.rim), ends.max(row + self.rim));
        }
        let mean = |knot: usize, side: usize| {
            let share = |shares: &[f64]| shares[knot].max(0.0);
            let (sum, all) = columns
                .iter()
                .fold((0.0, 0.0), |(sum, all), (shares, ends)| (sum + share(shares) * ends[side], all + share(shares)));
            if all > 0.0 { sum / all } else { 0.0 }
        };
        [0, 1]
            .into_iter()
            .flat_map(|side| (0..self.knots).map(move |knot| (knot, side)))
            .map(|(k, s)| mean(k, s))
            .collect()
    }
}

/// By how much of each knot's height a cubic through all of them (Catmull-Rom: slopes by the neighbours' difference) runs over
/// `x` from 0 to 1; level at both ends, since crystals go on there as in a mirror.
fn shares(x: f64, knots: usize) -> Vec<f64> {
    let last = knots - 1;
    let at = x * last as f64;
    let left = (at as usize).min(last - 1);
    let t = at - left as f64;
    let (t2, t3) = (t * t, t * t * t);
    let mut shares = vec![0.0; knots];
    shares[left] += 2.0 * t3 - 3.0 * t2 + 1.0;
    shares[left + 1] += 3.0 * t2 - 2.0 * t3;
    for (knot, slope) in [(left, t3 - 2.0 * t2 + t), (left + 1, t3 - t2)] {
        if knot > 0 && knot < last {
            shares[knot + 1] += 0.5 * slope;
            shares[knot - 1] -= 0.5 * slope;
        }
    }
    shares
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cubic that is level at both ends is a cubic between two knots; a straight line away from the ends stays one; and
    /// whatever the knots, shares add up to one.
    #[test]
    fn faces_run_through_their_knots() {
        for knots in 2..8 {
            for step in 0..=40 {
                let x = f64::from(step) / 40.0;
                let shares = shares(x, knots);
                assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-14, "{knots} {x}");
                let line: f64 = shares.iter().enumerate().map(|(k, share)| k as f64 * share).sum();
                let (at, last) = (x * (knots - 1) as f64, (knots - 1) as f64);
                if at >= 1.0 && at <= last - 1.0 {
                    assert!((line - at).abs() < 1e-13, "{knots} {x}: {line}");
                }
                if knots == 2 {
                    assert!((line - x * x * (3.0 - 2.0 * x)).abs() < 1e-14, "{x}: {line}");
                }
            }
            for knot in 0..knots {
                let at = shares(knot as f64 / (knots - 1) as f64, knots);
                assert!((at[knot] - 1.0).abs() < 1e-12, "{knots} {knot}: {at:?}");
            }
        }
    }

    /// With a knot on every column any assignment of runs is a pair of curves, and is found again exactly; what lies in two bands
    /// goes to the one that it lies in deeper.
    #[test]
    fn bands_are_found_again_from_what_they_paint() {
        let space = Space::sheet((0..180).map(|k| [7 + k / 10, 3 + k % 10]), 3);
        let bands = Bands::new(&space, 10);
        let letter = |site: &[u32; 3]| match (site[0] - 7, site[1] - 3) {
            (row, column) if row >= 2 && row < 6 + column % 4 => 1,
            (row, column) if row >= 11 && row + column / 3 < 17 => 2,
            _ => 0,
        };
        let assignment: Assignment = space.sites.iter().map(letter).collect();
        assert_eq!(bands.assignment(&bands.fit(&assignment)), assignment);
        // Letter 1 from row 0 to 12 of 0 to 17, letter 2 from 4 to 17: the middle of 4 and 12 parts them.
        let heights = |row: f64| 2.0 * row / 17.0 - 1.0;
        let level = |from: f64, to: f64| [vec![heights(from); 10], vec![heights(to); 10]].concat();
        let both = bands.assignment(&[level(-0.5, 12.25), level(4.25, 17.5)].concat());
        let parted = |site: &[u32; 3]| if site[0] - 7 <= 8 { 1 } else { 2 };
        assert_eq!(both, space.sites.iter().map(parted).collect::<Assignment>());
        // Closed bands leave the first letter.
        assert_eq!(bands.assignment(&bands.fit(&[0; 180])), vec![0; 180]);
    }
}
