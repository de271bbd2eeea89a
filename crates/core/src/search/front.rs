//! What several losses at once mean: who dominates whom, the front, its volume and its knee.

use super::Loss;

impl Loss {
    /// Whether this is at least as good in every part and better in one. What misses limits is worse than what keeps
    /// them, and of two that miss, the one that misses by more (K. Deb et al., IEEE Trans. Evol. Comput. 6 (2002), definition 1).
    pub fn dominates(&self, other: &Self) -> bool {
        if self.miss != other.miss {
            return self.miss < other.miss;
        }
        let pairs = || self.parts.iter().zip(&other.parts);
        pairs().all(|(a, b)| a <= b) && pairs().any(|(a, b)| a < b)
    }
}

/// Indices of those that none of the others dominates, in order; of several that are alike the first.
pub fn front(losses: &[Loss]) -> Vec<usize> {
    let beaten = |k: usize| {
        losses.iter().enumerate().any(|(j, other)| other.dominates(&losses[k]) || (j < k && *other == losses[k]))
    };
    (0..losses.len()).filter(|&k| !beaten(k)).collect()
}

/// For each its rank: 0 on the front, 1 on the front of the rest, and so on.
pub(super) fn ranks(losses: &[Loss]) -> Vec<usize> {
    let mut rank = vec![usize::MAX; losses.len()];
    let mut left: Vec<usize> = (0..losses.len()).collect();
    for level in 0.. {
        let (next, rest): (Vec<usize>, Vec<usize>) =
            left.iter().copied().partition(|&k| !left.iter().any(|&j| losses[j].dominates(&losses[k])));
        if left.is_empty() {
            break;
        }
        next.iter().for_each(|&k| rank[k] = level);
        left = rest;
    }
    rank
}

/// For each of some, how far apart its neighbours along each part are, over the part's extent; infinite at the ends
/// (Deb et al. 2002, section III B).
pub(super) fn crowding(losses: &[Loss], some: &[usize]) -> Vec<f64> {
    let mut distance = vec![0.0; some.len()];
    let parts = some.first().map_or(0, |&k| losses[k].parts.len());
    for part in 0..parts {
        let value = |place: usize| losses[some[place]].parts[part];
        let mut order: Vec<usize> = (0..some.len()).collect();
        order.sort_by(|&a, &b| value(a).total_cmp(&value(b)));
        let (Some(&first), Some(&last)) = (order.first(), order.last()) else { continue };
        let extent = value(last) - value(first);
        distance[first] = f64::INFINITY;
        distance[last] = f64::INFINITY;
        if extent > 0.0 && extent.is_finite() {
            order.windows(3).for_each(|three| distance[three[1]] += (value(three[2]) - value(three[0])) / extent);
        }
    }
    distance
}

/// The volume that points dominate below a reference: what lies between them and it, counted once. Points that do not
/// lie below the reference in every part add nothing. By slices along the last part: exact, for few points and parts.
pub fn hypervolume(points: &[Vec<f64>], reference: &[f64]) -> f64 {
    let inside: Vec<&[f64]> = points
        .iter()
        .map(Vec::as_slice)
        .filter(|point| point.len() == reference.len() && point.iter().zip(reference).all(|(p, r)| p < r))
        .collect();
    volume(&inside, reference)
}

fn volume(points: &[&[f64]], reference: &[f64]) -> f64 {
    let Some((&end, rest)) = reference.split_last() else { return if points.is_empty() { 0.0 } else { 1.0 } };
    if points.is_empty() {
        return 0.0;
    }
    let last = rest.len();
    let mut order = points.to_vec();
    order.sort_by(|a, b| a[last].total_cmp(&b[last]));
    (0..order.len())
        .map(|k| {
            let to = order.get(k + 1).map_or(end, |next| next[last]);
            let height = to - order[k][last];
            if height > 0.0 { height * volume(&order[..=k], rest) } else { 0.0 }
        })
        .sum()
}

/// The place of the point of a front that lies furthest below the plane through the front's ends, every part counted over
/// its extent (I. Das, Struct. Optim. 18 (1999)); the only one of a single point.
pub fn knee(points: &[Vec<f64>]) -> Option<usize> {
    let parts = points.first()?.len();
    let range = |part: usize| {
        let of = || points.iter().map(move |point| point[part]);
        (of().fold(f64::INFINITY, f64::min), of().fold(f64::NEG_INFINITY, f64::max))
    };
    let ranges: Vec<(f64, f64)> = (0..parts).map(range).collect();
    let height = |point: &Vec<f64>| -> f64 {
        let relative = |(value, (least, most)): (&f64, &(f64, f64))| {
            let extent = most - least;
            if extent > 0.0 { (value - least) / extent } else { 0.0 }
        };
        point.iter().zip(&ranges).map(relative).sum()
    };
    (0..points.len()).min_by(|&a, &b| height(&points[a]).total_cmp(&height(&points[b])))
}

/// Spearman's rank correlation of two series of equal length: that of their ranks, those of equal values being their
/// mean. None for fewer than three values, or where all are alike.
pub fn rank_correlation(a: &[f64], b: &[f64]) -> Option<f64> {
    if a.len() != b.len() || a.len() < 3 {
        return None;
    }
    let ranks = |values: &[f64]| -> Vec<f64> {
        let below = |value: &f64| values.iter().filter(|other| *other < value).count() as f64;
        let alike = |value: &f64| values.iter().filter(|other| *other == value).count() as f64;
        // From the middle, so that their mean is zero.
        let middle = (values.len() as f64 - 1.0) / 2.0;
        values.iter().map(|value| below(value) + (alike(value) - 1.0) / 2.0 - middle).collect()
    };
    let (a, b) = (ranks(a), ranks(b));
    let dot = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>();
    let size = (dot(&a, &a) * dot(&b, &b)).sqrt();
    (size > 0.0).then(|| dot(&a, &b) / size)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn loss(miss: f64, parts: &[f64]) -> Loss {
        Loss { total: parts.iter().sum(), miss, parts: parts.to_vec() }
    }

    #[test]
    fn limits_come_before_losses() {
        assert!(loss(0.0, &[9.0, 9.0]).dominates(&loss(0.1, &[1.0, 1.0])));
        assert!(loss(0.1, &[9.0, 9.0]).dominates(&loss(0.2, &[1.0, 1.0])));
        assert!(!loss(0.0, &[1.0, 2.0]).dominates(&loss(0.0, &[2.0, 1.0])));
        assert!(!loss(0.0, &[1.0, 2.0]).dominates(&loss(0.0, &[1.0, 2.0])));
    }

    #[test]
    fn the_front_and_what_lies_behind_it() {
        let losses = [[1.0, 4.0], [2.0, 2.0], [3.0, 3.0], [4.0, 1.0], [4.0, 4.0], [2.0, 2.0]].map(|p| loss(0.0, &p));
        assert_eq!(front(&losses), [0, 1, 3]);
        assert_eq!(ranks(&losses), [0, 0, 1, 0, 2, 0]);
        let crowding = crowding(&losses, &[0, 1, 3]);
        assert_eq!(crowding, [f64::INFINITY, 2.0, f64::INFINITY]);
    }

    /// Counted out: steps of unit squares, and of unit cubes.
    #[test]
    fn volumes_are_those_of_the_union_of_boxes() {
        let flat = [[1.0, 4.0], [2.0, 2.0], [4.0, 1.0], [3.0, 3.0]].map(|p| p.to_vec());
        assert_eq!(hypervolume(&flat, &[5.0, 5.0]), 4.0 + 6.0 + 1.0);
        let cubes = [[0.0, 1.0, 1.0], [1.0, 0.0, 1.0], [1.0, 1.0, 0.0]].map(|p| p.to_vec());
        assert_eq!(hypervolume(&cubes, &[2.0; 3]), 4.0);
        assert_eq!(hypervolume(&[vec![3.0, 0.0]], &[2.0, 2.0]), 0.0);
        assert_eq!(hypervolume(&[], &[2.0, 2.0]), 0.0);
    }

    #[test]
    fn the_knee_bulges_most() {
        let points = [[0.0, 10.0], [1.0, 2.0], [4.0, 1.5], [10.0, 0.0]].map(|p| p.to_vec());
        assert_eq!(knee(&points), Some(1));
        assert_eq!(knee(&[]), None);
    }

    /// 1 - 6 Σd²/(n (n² - 1)) where no values are alike; ties by hand.
    #[test]
    fn ranks_correlate_as_spearman_says() {
        let a = [1.0, 2.0, 3.0, 4.0, 5.0];
        assert_eq!(rank_correlation(&a, &[10.0, 20.0, 30.0, 1e3, 1e9]), Some(1.0));
        assert_eq!(rank_correlation(&a, &[5.0, 4.0, 3.0, 2.0, 1.0]), Some(-1.0));
        let mixed = rank_correlation(&a, &[2.0, 1.0, 4.0, 3.0, 5.0]).unwrap();
        assert!((mixed - (1.0 - 6.0 * 4.0 / (5.0 * 24.0))).abs() < 1e-15);
        assert_eq!(rank_correlation(&a, &[1.0; 5]), None);
        let tied = rank_correlation(&[1.0, 2.0, 3.0], &[1.0, 1.0, 2.0]).unwrap();
        assert!((tied - 0.75_f64.sqrt()).abs() < 1e-15);
    }
}
