//! Which part of a load on a sphere the strongest of its contacts hands on.
//!
//! At the front of a wave a sphere stands between the load and neighbours that are still at rest. Where the contacts ahead are all as
//! stiff and its neighbours do not give way, a force F d moves it by u with Σ nₖ nₖᵀ u = F d / k, and contact k carries k nₖ·u: a half over
//! cos 30° in a hexagonal sheet, a third over √(2/3) in a close-packed crystal, all of it in a chain.

use crate::dem::rig::{Body, Face, Load, Rig};
use crate::period::nearest_image;

/// Spheres this many radii apart count as touching.
const TOUCH: f64 = 1e-6;

/// The force in the strongest contact of a load's bodies over the load on each: 1 for flats, and where a sphere would slip away between
/// its contacts or stands before none.
pub(super) fn handed_on<const D: usize>(rig: &Rig<D>, load: &Load<D>) -> f64 {
    // Of very many bodies among very many the first tell.
    let looked_at = (200_000_000 / rig.sample.spheres.len().max(1)).max(1);
    let part = |body: &Body| match *body {
        Body::Sphere(i) => strongest(&ahead(rig, i, &load.direction), &load.direction).unwrap_or(1.0),
        Body::Flat(_) => 1.0,
    };
    load.bodies.iter().take(looked_at).map(part).fold(0.0, f64::max)
}

/// Unit vectors from a sphere to what it touches ahead: spheres, their mirror images and nearest periodic ones, and planes.
fn ahead<const D: usize>(rig: &Rig<D>, i: usize, direction: &[f64; D]) -> Vec<[f64; D]> {
    let own = &rig.sample.spheres[i];
    let mut normals: Vec<[f64; D]> = Vec::new();
    let mut see = |normal: [f64; D]| {
        // A sphere on a mirror is its own image.
        let known = normals.iter().any(|known| (0..D).all(|k| (known[k] - normal[k]).abs() < TOUCH));
        if dot(&normal, direction) > TOUCH && !known {
            normals.push(normal);
        }
    };
    for (j, other) in rig.sample.spheres.iter().enumerate() {
        let reach = own.radius + other.radius;
        let images = rig.mirrors.iter().map(|mirror| {
            let mut centre = other.centre;
            centre[mirror.axis] = 2.0 * mirror.position - centre[mirror.axis];
            centre
        });
        for centre in std::iter::once(other.centre).chain(images) {
            let between: [f64; D] = std::array::from_fn(|k| {
                let apart = centre[k] - own.centre[k];
                rig.periods[k].map_or(apart, |period| nearest_image(apart, period))
            });
            let distance = dot(&between, &between).sqrt();
            if distance > TOUCH * reach && distance <= reach * (1.0 + TOUCH) && (j != i || distance > 0.5 * reach) {
                see(between.map(|x| x / distance));
            }
        }
    }
    for flat in rig.flats.iter().filter(|flat| flat.face == Face::Plane) {
        if flat.distance(&[0.0; D], &own.centre).0 <= own.radius * (1.0 + TOUCH) {
            see(flat.normal.map(|x| -x));
        }
    }
    normals
}

/// The greatest force of contacts along these normals that together hold 1 along a direction; none where they cannot, or one would have
/// to pull.
fn strongest<const D: usize>(normals: &[[f64; D]], direction: &[f64; D]) -> Option<f64> {
    // [Σ n nᵀ | d], brought to the form of Gauss and Jordan.
    let mut rows: [([f64; D], f64); D] =
        std::array::from_fn(|a| (std::array::from_fn(|b| normals.iter().map(|n| n[a] * n[b]).sum()), direction[a]));
    let mut moved = [0.0; D];
    let mut rank = 0;
    for column in 0..D {
        let pivot = (rank..D).max_by(|&a, &b| rows[a].0[column].abs().total_cmp(&rows[b].0[column].abs()))?;
        if rows[pivot].0[column].abs() < TOUCH {
            continue;
        }
        rows.swap(rank, pivot);
        let (own, right) = rows[rank];
        for (a, row) in rows.iter_mut().enumerate() {
            if a != rank {
                let factor = row.0[column] / own[column];
                (0..D).for_each(|b| row.0[b] -= factor * own[b]);
                row.1 -= factor * right;
            }
        }
        rank += 1;
    }
    if rows[rank..].iter().any(|(_, right)| right.abs() > TOUCH) {
        return None;
    }
    for (row, right) in &rows[..rank] {
        let column = (0..D).find(|&b| row[b].abs() >= TOUCH)?;
        moved[column] = right / row[column];
    }
    let forces = normals.iter().map(|normal| dot(normal, &moved));
    forces.map(|force| (force >= -TOUCH).then_some(force)).try_fold(0.0_f64, |most, force| Some(most.max(force?)))
}

fn dot<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    (0..D).map(|k| a[k] * b[k]).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Symmetric contacts at an angle α to the force hold 1/(m cos α) each.
    #[test]
    fn contacts_share_a_force_by_their_angles() {
        assert_eq!(strongest(&[[1.0]], &[1.0]), Some(1.0));
        let (half, height) = (0.5, 0.75_f64.sqrt());
        let pair = [[half, height], [-half, height]];
        assert!((strongest(&pair, &[0.0, 1.0]).unwrap() * 3.0_f64.sqrt() - 1.0).abs() < 1e-12);
        let three: Vec<[f64; 3]> = (0..3)
            .map(|k| {
                let turn = f64::from(k) * 2.0 / 3.0 * std::f64::consts::PI;
                [turn.cos() / 3.0_f64.sqrt(), turn.sin() / 3.0_f64.sqrt(), (2.0_f64 / 3.0).sqrt()]
            })
            .collect();
        assert!((strongest(&three, &[0.0, 0.0, 1.0]).unwrap() * 6.0_f64.sqrt() - 1.0).abs() < 1e-12);
        // A contact in line with the force takes all that two beside it leave: 1/(1 + 2 cos² α).
        assert!((strongest(&[pair[0], pair[1], [0.0, 1.0]], &[0.0, 1.0]).unwrap() - 0.4).abs() < 1e-12);
        // One alone lets the sphere slip; none holds nothing.
        assert_eq!(strongest(&pair[..1], &[0.0, 1.0]), None);
        assert_eq!(strongest::<2>(&[], &[0.0, 1.0]), None);
    }
}
