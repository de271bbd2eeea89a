//! Eigenvalues and eigenvectors of a real symmetric matrix.
//!
//! Householder's reflections make it tridiagonal, then implicit QL steps with Wilkinson's shift take its off-diagonal to zero (Golub and Van
//! Loan 2013, sections 8.3.1 and 8.3.3). Work and memory grow with n³ and n².

/// The eigenvalues of a symmetric matrix in no order, and of each its eigenvector of unit length, as rows. `rows` is the matrix, row by row.
pub(super) fn symmetric(mut rows: Vec<Vec<f64>>) -> (Vec<f64>, Vec<Vec<f64>>) {
    let n = rows.len();
    // Row k of `basis` is what the k-th direction of the tridiagonal matrix is in the given ones.
    let mut basis: Vec<Vec<f64>> = (0..n).map(|i| (0..n).map(|k| f64::from(u8::from(i == k))).collect()).collect();
    for k in 0..n.saturating_sub(2) {
        // A reflection 1 − v vᵀ of the directions behind k, |v|² = 2, that leaves one entry of column k.
        let below: Vec<f64> = (k + 1..n).map(|i| rows[i][k]).collect();
        let size = below.iter().map(|x| x * x).sum::<f64>().sqrt();
        if below[1..].iter().all(|x| *x == 0.0) || size == 0.0 {
            continue;
        }
        let mut v = below;
        v[0] += size.copysign(v[0]);
        let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
        v.iter_mut().for_each(|x| *x *= std::f64::consts::SQRT_2 / length);
        // A − v wᵀ − w vᵀ with p = A v, w = p − (vᵀp/2) v, on the part behind k; column and row k apart.
        let p: Vec<f64> = (k + 1..n).map(|i| (k + 1..n).map(|j| rows[i][j] * v[j - k - 1]).sum()).collect();
        let half = 0.5 * p.iter().zip(&v).map(|(p, v)| p * v).sum::<f64>();
        let w: Vec<f64> = p.iter().zip(&v).map(|(p, v)| p - half * v).collect();
        for i in k + 1..n {
            for j in k + 1..n {
                rows[i][j] -= v[i - k - 1] * w[j - k - 1] + w[i - k - 1] * v[j - k - 1];
            }
        }
        let along: f64 = (k + 1..n).map(|i| rows[i][k] * v[i - k - 1]).sum();
        for i in k + 1..n {
            rows[i][k] -= along * v[i - k - 1];
            rows[k][i] = rows[i][k];
        }
        let (_, behind) = basis.split_at_mut(k + 1);
        let mut seen = vec![0.0; n];
        for (row, v) in behind.iter().zip(&v) {
            (0..n).for_each(|j| seen[j] += v * row[j]);
        }
        for (row, v) in behind.iter_mut().zip(&v) {
            (0..n).for_each(|j| row[j] -= v * seen[j]);
        }
    }
    let mut diagonal: Vec<f64> = (0..n).map(|i| rows[i][i]).collect();
    let mut beside: Vec<f64> = (1..n).map(|i| rows[i][i - 1]).chain([0.0]).collect();
    drop(rows);
    for first in 0..n {
        loop {
            // The block from `first` on ends where the off-diagonal is lost beside its neighbours.
            let lost = |m: &usize| beside[*m].abs() <= f64::EPSILON * (diagonal[*m].abs() + diagonal[*m + 1].abs());
            let last = (first..n - 1).find(lost).unwrap_or(n - 1);
            if last == first {
                break;
            }
            let gap = (diagonal[first + 1] - diagonal[first]) / (2.0 * beside[first]);
            let shift = diagonal[first] - beside[first] / (gap + gap.hypot(1.0).copysign(gap));
            let mut chased = diagonal[last] - shift;
            let (mut sine, mut cosine, mut taken) = (1.0, 1.0, 0.0);
            let mut whole = true;
            for i in (first..last).rev() {
                let (f, b) = (sine * beside[i], cosine * beside[i]);
                let size = f.hypot(chased);
                beside[i + 1] = size;
                if size == 0.0 {
                    // The block falls apart here.
                    diagonal[i + 1] -= taken;
                    beside[last] = 0.0;
                    whole = false;
                    break;
                }
                (sine, cosine) = (f / size, chased / size);
                let rest = diagonal[i + 1] - taken;
                let turned = (diagonal[i] - rest) * sine + 2.0 * cosine * b;
                taken = sine * turned;
                diagonal[i + 1] = rest + taken;
                chased = cosine * turned - b;
                let (upper, lower) = basis.split_at_mut(i + 1);
                for (one, other) in upper[i].iter_mut().zip(&mut lower[0]) {
                    (*one, *other) = (cosine * *one - sine * *other, sine * *one + cosine * *other);
                }
            }
            if whole {
                diagonal[first] -= taken;
                beside[first] = chased;
                beside[last] = 0.0;
            }
        }
    }
    (diagonal, basis)
}

#[cfg(test)]
mod tests {
    use super::symmetric;

    /// A v = λ v for every pair, and vectors at right angles of unit length, of matrices with equal eigenvalues, zeros and none of either; to
    /// rounding of some n terms.
    #[test]
    fn vectors_are_turned_into_their_multiples() {
        let mut state = 5_u64;
        let mut draw = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        for n in [1, 2, 3, 7, 40, 90] {
            let mut random = vec![vec![0.0; n]; n];
            for i in 0..n {
                for j in 0..=i {
                    (random[i][j], random[j][i]) = {
                        let x = draw();
                        (x, x)
                    };
                }
            }
            // A ring: each but the first and last frequency twice.
            let ring: Vec<Vec<f64>> = (0..n)
                .map(|i| {
                    let mut row = vec![0.0; n];
                    row[i] += 2.0;
                    row[(i + 1) % n] -= 1.0;
                    row[(i + n - 1) % n] -= 1.0;
                    row
                })
                .collect();
            let diagonal =
                (0..n).map(|i| (0..n).map(|j| if i == j { (i / 2) as f64 } else { 0.0 }).collect()).collect();
            for matrix in [random, ring, diagonal, vec![vec![0.0; n]; n]] {
                let matrix: Vec<Vec<f64>> = matrix;
                let (values, vectors) = symmetric(matrix.clone());
                let near = 1e-14 * (n as f64 + 4.0);
                for (k, (value, vector)) in values.iter().zip(&vectors).enumerate() {
                    for i in 0..n {
                        let turned: f64 = (0..n).map(|j| matrix[i][j] * vector[j]).sum();
                        assert!(
                            (turned - value * vector[i]).abs() < near * 4.0,
                            "{n} {k}: {turned} {}",
                            value * vector[i]
                        );
                    }
                    for (l, other) in vectors.iter().enumerate() {
                        let product: f64 = vector.iter().zip(other).map(|(a, b)| a * b).sum();
                        assert!((product - f64::from(u8::from(k == l))).abs() < near, "{n} {k} {l}: {product}");
                    }
                }
            }
        }
    }
}
