use granulens_core::network::{Bar, Carrier, Filtration, Part, Topology, default_thresholds};

use super::{network, random};

fn bar(birth: f64, death: impl Into<Option<f64>>) -> Bar {
    Bar { birth, death: death.into() }
}

/// Two squares that share a side, one of them with a diagonal. On contacts: the diagonal cuts its square into two triangles,
/// which are filled as their last contact enters.
#[test]
fn two_squares_side_by_side() {
    // 3-4-5 above 0-1-2; the diagonal 1-5 cuts the right square.
    let made = network(&[
        (0, 1, 8.0, 0.0),
        (1, 2, 7.0, 0.0),
        (3, 4, 6.0, 0.0),
        (4, 5, 5.0, 0.0),
        (0, 3, 4.0, 0.0),
        (1, 4, 3.0, 0.0),
        (2, 5, 2.0, 0.0),
        (1, 5, 1.0, 0.0),
    ]);
    let filtration = Filtration::new(&made, Carrier::Contacts, Part::Normal);
    assert_eq!(filtration.components(), [bar(8.0, None), bar(6.0, 4.0)]);
    assert_eq!(filtration.loops(), [bar(3.0, None), bar(2.0, 1.0)]);
    let topology = Topology::new(&made, Carrier::Contacts, Part::Normal, vec![0.0, 0.3, 1.0, 1.2, 2.0]).unwrap();
    // The mean is 4.5: above 0, 1.35, 4.5, 5.4 and 9.
    assert_eq!(topology.mean_force, 4.5);
    assert_eq!(topology.components, [1, 1, 2, 2, 0]);
    assert_eq!(topology.loops, [3, 2, 0, 0, 0]);
    assert_eq!(topology.holes, [1, 2, 0, 0, 0]);
    assert_eq!(topology.persistence0, [bar(8.0 / 4.5, None), bar(6.0 / 4.5, 4.0 / 4.5)]);
}

/// On particles: a ring of four whose grains carry 3, 3, 3, 3 together with a spur.
#[test]
fn a_grain_carries_the_sum_at_its_contacts() {
    let made = network(&[(0, 1, 1.0, 0.5), (1, 2, -2.0, 0.0), (2, 3, 1.0, 0.0), (3, 0, 2.0, 0.0), (0, 4, 0.5, 0.0)]);
    assert_eq!(made.grain_forces(Part::Normal), [3.5, 3.0, 3.0, 3.0, 0.5]);
    let topology = Topology::new(&made, Carrier::Particles, Part::Normal, vec![0.0, 0.5, 1.2, 2.0]).unwrap();
    assert_eq!(topology.mean_force, 2.6);
    assert_eq!(topology.components, [1, 1, 1, 0]);
    assert_eq!((topology.loops, topology.holes), (vec![1, 1, 0, 0], vec![1, 1, 0, 0]));
    // By the tangential force, measured by the mean of the normal one.
    let topology = Topology::new(&made, Carrier::Contacts, Part::Tangential, vec![0.0, 0.3, 0.5]).unwrap();
    assert_eq!((topology.mean_force, topology.components), (1.3, vec![1, 1, 0]));
}

/// A closed surface: three caps make a hollow tetrahedron, which has no loop left; an octahedron neither, without one face's
/// contact a hole of four.
#[test]
fn hollow_bodies_have_no_loops() {
    let tetrahedron: Vec<(u32, u32, f64, f64)> =
        [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)].map(|(a, b)| (a, b, 1.0, 0.0)).into();
    assert!(Filtration::new(&network(&tetrahedron), Carrier::Contacts, Part::Normal).loops().is_empty());
    let octahedron: Vec<(u32, u32, f64, f64)> = (0..6_u32)
        .flat_map(|a| (a + 1..6).map(move |b| (a, b)))
        .filter(|&(a, b)| a + b != 5)
        .map(|(a, b)| (a, b, f64::from(a + b), 0.0))
        .collect();
    let loops = Filtration::new(&network(&octahedron), Carrier::Contacts, Part::Normal).loops();
    assert!(loops.iter().all(|bar| bar.death.is_some()), "{loops:?}");
}

/// A ring round a cylinder never dies, and a second ring beside it, joined by triangles, is the same loop.
#[test]
fn a_loop_round_periodic_sides_stays() {
    let ring = |first: u32| (0..6).map(move |k| (first + k, first + (k + 1) % 6, 2.0, 0.0));
    let mut contacts: Vec<(u32, u32, f64, f64)> = ring(0).collect();
    let loops = |contacts: &[_]| Filtration::new(&network(contacts), Carrier::Contacts, Part::Normal).loops();
    assert_eq!(loops(&contacts), [bar(2.0, None)]);
    contacts.extend(ring(6));
    contacts.extend((0..6).flat_map(|k| [(k, 6 + k, 1.0, 0.0), (k, 6 + (k + 1) % 6, 1.0, 0.0)]));
    assert_eq!(loops(&contacts), [bar(2.0, None), bar(2.0, 1.0)]);
}

/// Equal forces: nothing exceeds their mean, and components and loops appear at once.
#[test]
fn equal_forces_enter_together() {
    let mut contacts = random(7, 30, 6, 1);
    contacts.iter_mut().for_each(|c| c.2 = 0.1);
    let topology = Topology::new(&network(&contacts), Carrier::Contacts, Part::Normal, default_thresholds()).unwrap();
    assert_eq!(topology.mean_force, 0.1);
    for (threshold, components) in topology.thresholds.iter().zip(&topology.components) {
        assert_eq!(*components == 0, *threshold >= 1.0, "{threshold}");
    }
    assert!(topology.persistence0.iter().chain(&topology.persistence1).all(|b| *b == bar(1.0, None)));
}

/// Other numbers for the grains, contacts in another order and either grain first: all the same, to the last bit.
#[test]
fn names_and_order_change_nothing() {
    for seed in 0..20 {
        let contacts = random(seed + 50, 24, 3, [3, 999_983][seed as usize % 2]);
        let grains = contacts.iter().map(|c| c.0.max(c.1) + 1).max().unwrap();
        let other = |i: u32| (i * 7 + 3) % grains;
        assert!(!grains.is_multiple_of(7));
        let mut renamed: Vec<(u32, u32, f64, f64)> = contacts
            .iter()
            .enumerate()
            .map(|(n, &(a, b, f, t))| match n % 2 {
                0 => (other(a), other(b), f, t),
                _ => (other(b), other(a), f, t),
            })
            .collect();
        renamed.rotate_left(contacts.len() / 3);
        renamed.reverse();
        for carrier in [Carrier::Contacts, Carrier::Particles] {
            for part in [Part::Normal, Part::Tangential] {
                let of = |contacts| Topology::new(&network(contacts), carrier, part, default_thresholds());
                assert_eq!(of(&contacts), of(&renamed), "seed {seed}");
            }
        }
    }
}

/// Ninety thousand grains of a hexagonal sheet with one force: the longest chains of links there are. In less than ten seconds even
/// on a busy machine without optimisation; the benchmark `network` says how long it takes.
#[test]
fn large_sheets_of_equal_forces_take_no_longer() {
    let (columns, rows) = (300_u32, 300_u32);
    let at = |c: u32, r: u32| r * columns + c % columns;
    let mut contacts = Vec::new();
    for r in 0..rows {
        for c in 0..columns {
            contacts.push((at(c, r), at(c + 1, r), 1.0, 0.0));
            if r + 1 < rows {
                contacts.push((at(c, r), at(c + r % 2, r + 1), 1.0, 0.0));
                contacts.push((at(c, r), at(c + columns - 1 + r % 2, r + 1), 1.0, 0.0));
            }
        }
    }
    let begun = std::time::Instant::now();
    let topology = Topology::new(&network(&contacts), Carrier::Contacts, Part::Normal, default_thresholds()).unwrap();
    // A cylinder: one loop round it, and all else is filled.
    assert_eq!(topology.persistence1, [bar(1.0, None)]);
    assert_eq!((topology.components[0], topology.holes[0]), (1, 1));
    assert!(begun.elapsed().as_secs_f64() < 10.0, "{:?}", begun.elapsed());
}
