use super::*;
use crate::lattice::{Cell, Outline, Width};
use crate::material::library;

fn sheet(layers: u32, width: f64) -> Build<2> {
    let cell = Cell::<2>::named("hexagonal").unwrap();
    let crystal = Crystal::new(cell, 1e-2, layers, &[Width::Between(0.0, width)], Outline::All).unwrap();
    Build::new(crystal, library())
}

fn count(build: &Build<2>, material: usize) -> usize {
    build.sample().0.spheres.iter().filter(|sphere| sphere.material == material).count()
}

/// n + (n − 1) + ... + 1 spheres, the base in the corner (Burgoyne 2016, section 2.2.3).
#[test]
fn a_triangle_has_its_triangular_number() {
    let mut rig = sheet(15, 17.0);
    let triangle = Pattern::Triangle { spheres: 10, side: Side::Right };
    assert_eq!(rig.paint(&triangle, &Selection::default(), &[3], None), Ok(55));
    let (sample, _) = rig.sample();
    let last = sample.spheres.last().unwrap();
    assert_eq!((last.material, count(&rig, 3)), (3, 55));
    let tip = sample.spheres.iter().find(|sphere| sphere.material == 3).unwrap();
    assert!((tip.centre[0] - 0.125).abs() < 1e-12 && (tip.centre[1] - 0.05 * 0.75_f64.sqrt()).abs() < 1e-12);
}

/// Stripes along a close-packed line at 60 degrees: sites one diameter apart in x change line, and along a line nothing
/// changes.
#[test]
fn stripes_follow_their_angle() {
    let mut rig = sheet(12, 11.5);
    let angle = 60_f64.to_radians();
    let line = 0.01 * 0.75_f64.sqrt();
    let stripes = Pattern::Stripes { angle, widths: vec![3.0 * line, 2.0 * line], origin: [0.0, 0.0] };
    rig.paint(&stripes, &Selection::default(), &[1, 2], None).unwrap();
    let at = |layer: u32, x: f64| {
        let k = rig.crystal().sites().iter().position(|s| s.layer == layer && (s.centre[0] - x * 0.01).abs() < 1e-9);
        rig.spheres[k.unwrap()].unwrap().material
    };
    let row: Vec<usize> = (0..10).map(|k| at(1, f64::from(k))).collect();
    // s = −x sin 60°: the stripes are counted downwards along x, and s = 0 belongs to the first.
    assert_eq!(row, [1, 2, 2, 1, 1, 1, 2, 2, 1, 1]);
    for start in 0..6 {
        for step in 1..10 {
            let x = f64::from(start) + 0.5 * f64::from(step);
            assert_eq!(at(1 + step, x), at(1, f64::from(start)), "start {start}, step {step}");
        }
    }
}

/// A wedge of 60 degrees along close-packed lines holds 1, 2, 3, ... spheres from its apex on.
#[test]
fn a_wedge_widens_by_one_sphere_a_layer() {
    let mut rig = sheet(9, 12.0);
    let apex = [0.06, rig.crystal().layer_spacing() * 2.0];
    let wedge = Pattern::Wedge { apex, angle: 60_f64.to_radians() };
    rig.paint(&wedge, &Selection::default(), &[1], None).unwrap();
    for layer in 1..=9 {
        let site = |k: &usize| rig.crystal().sites()[*k].layer == layer;
        let inside = (0..rig.spheres.len()).filter(site).filter(|&k| rig.spheres[k].unwrap().material == 1).count();
        assert_eq!(inside, (layer as usize).saturating_sub(2));
    }
}

/// Hexagonal rings of one diameter hold 1, 6, 12, 18, ... sites of a close-packed layer.
#[test]
fn rings_hold_six_more_each() {
    let cell = Cell::<3>::named("hcp").unwrap();
    let widths = [Width::Between(-6.0, 6.0); 2];
    let crystal = Crystal::new(cell, 1e-2, 1, &widths, Outline::Hexagon(5.0)).unwrap();
    let rings = Pattern::Rings { shape: RingShape::Hexagon, width: 1e-2, centre: [0.0; 2] };
    let choices = rings.choices(&crystal, 100).unwrap();
    let sizes: Vec<usize> = (0..6).map(|k| choices.iter().filter(|&&c| c == Some(k)).count()).collect();
    assert_eq!(sizes, [1, 6, 12, 18, 24, 30]);
}

/// 4000 sites: shares within five standard deviations, √(p(1 − p)/4000) each; the same seed is the same mix.
#[test]
fn mixes_have_their_shares() {
    let cell = Cell::<2>::named("square").unwrap();
    let crystal = Crystal::new(cell, 1.0, 50, &[Width::Cells(80)], Outline::All).unwrap();
    let fractions = vec![0.5, 0.3, 0.2];
    let mix = |seed| Pattern::Mix { fractions: fractions.clone(), seed }.choices(&crystal, 3).unwrap();
    let drawn = mix(7);
    for (k, share) in fractions.iter().enumerate() {
        let found = drawn.iter().filter(|&&c| c == Some(k)).count() as f64 / 4000.0;
        assert!((found - share).abs() < 5.0 * (share * (1.0 - share) / 4000.0).sqrt(), "{k}: {found}");
    }
    assert_eq!(drawn, mix(7));
    assert_ne!(drawn, mix(8));
}

/// A dimer of different sizes: centres are the sums of radii apart.
#[test]
fn chains_of_unequal_spheres_touch() {
    let crystal = Crystal::new(Cell::<1>::ALL[0], 1e-2, 6, &[], Outline::All).unwrap();
    let mut chain = Build::new(crystal, library());
    let dimer = Pattern::Layers { first: 1 };
    chain.paint(&dimer, &Selection::default(), &[0, 2], Some(&[5e-3, 2e-3])).unwrap();
    chain.close_chain();
    let (sample, _) = chain.sample();
    for pair in sample.spheres.windows(2) {
        let gap = pair[1].centre[0] - pair[0].centre[0] - pair[0].radius - pair[1].radius;
        assert!(gap.abs() < 1e-15, "{gap}");
    }
    assert_eq!(sample.spheres.iter().map(|s| s.material).collect::<Vec<_>>(), [0, 2, 0, 2, 0, 2]);
}

#[test]
fn single_spheres_are_changed_moved_and_removed() {
    let mut rig = sheet(4, 3.0);
    let one = |layer, column| Selection {
        layers: Some([layer, layer]),
        columns: Some([column, column]),
        ..Selection::default()
    };
    assert_eq!(rig.change(&one(2, 1), Change::Material(3)), 1);
    assert_eq!(rig.change(&one(3, 2), Change::Remove), 1);
    assert_eq!(rig.change(&one(3, 2), Change::Radius(1e-3)), 0);
    assert_eq!(rig.change(&one(4, 1), Change::Move([0.0, 1e-3])), 1);
    let range = Selection { ranges: [Some([0.015, 0.025]), None], ..Selection::default() };
    // x = 2 D in rows 1 and 3, 1.5 and 2.5 D in rows 2 and 4.
    assert_eq!(rig.change(&range, Change::Radius(2e-3)), 6);
    let (sample, sites) = rig.sample();
    assert_eq!((sample.spheres.len(), sites.len()), (13, 13));
    assert_eq!(count(&rig, 3), 1);
    assert!(!sites.contains(&(4 + 3 + 1)));
    let moved = sample.spheres[sites.iter().position(|&s| s == 4 + 3 + 4).unwrap()];
    assert!((moved.centre[1] - 3.0 * rig.crystal().layer_spacing() - 1e-3).abs() < 1e-15);
}

#[test]
fn patterns_that_do_not_fit_are_refused() {
    let crystal = Crystal::new(Cell::<1>::ALL[0], 1e-2, 6, &[], Outline::All).unwrap();
    let wedge = Pattern::Wedge { apex: [0.0; 2], angle: 1.0 };
    assert_eq!(wedge.choices(&crystal, 1), Err(PatternError::Chain));
    let mix = |fractions| Pattern::Mix { fractions, seed: 1 }.choices(&crystal, 2);
    assert_eq!(mix(vec![1.0]), Err(PatternError::Count(1, 2)));
    assert!(matches!(mix(vec![0.5, 0.4]), Err(PatternError::Value(_))));
}
