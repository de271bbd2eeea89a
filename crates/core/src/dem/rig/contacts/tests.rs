use super::sections::Sections;
use super::{Contacts, Predicted, Sums};
use crate::contact::{Constants, LawKind};
use crate::dem::rig::bodies::Bodies;
use crate::dem::rig::dashpot::SpringDashpot;
use crate::dem::rig::law::{ByDashpot, ByMaterial, ContactLaw as _, SolidLaw};
use crate::dem::rig::pairs::Finder;
use crate::dem::rig::{Arm, Flat, FlatContact, Friction, Law, LawBook, Loss, Rig, Spring};
use crate::real::Width;
use crate::sample::{Sample, Sphere};

/// What a few sweeps over jostling disks of two materials come to, in so many sections: all forces and torques, and what contacts
/// remember; one contact at a time where there is no width.
fn jostled(
    width: Option<Width>,
    (losses, cut): ([Loss; 2], bool),
    grip: [Spring; 2],
    sections: usize,
) -> [Vec<f64>; 2] {
    let mut state = 7_u64;
    let mut draw = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let spheres: Vec<Sphere<2>> = (0..400)
        .map(|i| Sphere {
            centre: [f64::from(i % 20) + 0.1 * draw(), f64::from(i / 20) + 0.1 * draw()],
            radius: 0.45 + 0.1 * draw(),
            material: usize::from(i % 20 == 3),
        })
        .collect();
    let friction = |spring| Some(Friction { coefficient: 0.3, spring, damping: 0.7, rolling: 0.0 });
    let materials = losses.into_iter().zip(grip).map(|(loss, spring)| (loss, friction(spring))).collect::<Vec<_>>();
    let maker = ByDashpot { stiffness: 4.9, materials: materials.clone(), cut };
    let laws = LawBook::Dashpot { stiffness: 4.9, materials, cut, arm: Arm::Radius };
    let material = crate::material::find("440c", &[]).unwrap();
    let mut rig = Rig::new(Sample { materials: vec![material; 2], spheres }, laws);
    rig.periods = [Some(20.0), None];
    let (finder, mut bodies) = (Finder::new(&rig), Bodies::new(&rig));
    let mut contacts = Contacts::<2, SpringDashpot>::new(&rig, 1.0);
    contacts.renew(&rig, &finder, &bodies, &maker);
    contacts.sections = Sections::so_many(&contacts.near, 400, sections);
    contacts.width = width.unwrap_or(Width::Scalar);
    if width.is_none() {
        // With shares, even of one, contacts are taken one at a time.
        contacts.share = vec![1.0; contacts.near.len()];
    }
    let mut sums = Sums::new(400, 0);
    let mut felt = Vec::new();
    for _ in 0..10 {
        for i in 0..400 {
            bodies.velocity[i] = [draw() - 0.5, draw() - 0.5];
            bodies.spin.set(i, &[0.0, 0.0, draw() - 0.5]);
            for k in 0..2 {
                bodies.displacement[i][k] += 0.1 * bodies.velocity[i][k];
            }
        }
        let predicted = Predicted {
            velocity: &bodies.velocity.clone(),
            turn: &bodies.spin.times(&contacts.lever),
            flat_velocity: &[],
            step: 0.1,
        };
        contacts.sweep(&rig, &bodies, predicted, &mut sums);
        felt.extend(sums.force.iter().flatten().chain(sums.torque.numbers()));
    }
    let closed = contacts.account.overlap.iter().filter(|&&overlap| overlap > 0.0).count();
    assert!(closed > 100 && closed < contacts.len() - 100, "{closed} of {}", contacts.len());
    let accounts = (0..contacts.len()).flat_map(|c| contacts.account.at(c).numbers());
    [felt, accounts.chain((0..contacts.len()).map(|c| contacts.tangential_stored(c))).collect()]
}

fn bits(numbers: &[f64]) -> Vec<u64> {
    numbers.iter().map(|number| number.to_bits()).collect()
}

const RATES: ([Loss; 2], bool) = ([Loss::Rate(1.4), Loss::Rate(4.6)], false);

const GRIPS: [[Spring; 2]; 3] = [[Spring::None; 2], [Spring::Constant(3.9); 2], [Spring::Constant(3.9), Spring::None]];

/// Contacts side by side do what they do one at a time, to the bit: with springs, without, and with both kinds together.
#[test]
fn every_width_gives_the_same_forces() {
    let ratios = [Loss::Ratio(0.4), Loss::Ratio(1.3)];
    for dashpots in [RATES, (ratios, false), (ratios, true)] {
        for grip in GRIPS {
            let one_at_a_time = jostled(None, dashpots, grip, 1).map(|numbers| bits(&numbers));
            for width in Width::available() {
                let side_by_side = jostled(Some(width), dashpots, grip, 1).map(|numbers| bits(&numbers));
                assert!(side_by_side == one_at_a_time, "{width:?} {dashpots:?} {grip:?}");
            }
        }
    }
}

/// In sections contacts do the same, and forces are the same sums in another order: of some eight terms, each rounded to a part of
/// the greatest force.
#[test]
fn sections_give_the_same_sums() {
    for (grip, width) in GRIPS.into_iter().zip([None, Some(Width::widest()), None]) {
        let [felt, remembered] = jostled(width, RATES, grip, 1);
        for sections in [2, 3, 8, 600] {
            let [felt_in_sections, remembered_in_sections] = jostled(width, RATES, grip, sections);
            assert!(bits(&remembered) == bits(&remembered_in_sections), "{sections}");
            let apart = felt.iter().zip(&felt_in_sections).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            let greatest = felt.iter().fold(0.0_f64, |greatest, force| greatest.max(force.abs()));
            assert!(
                apart < 8.0 * f64::EPSILON * greatest && felt.len() == felt_in_sections.len(),
                "{sections}: {apart:e}"
            );
        }
    }
}

/// What a few sweeps over jostling spheres of two metals in a box come to: all forces and torques, and what contacts remember. `kinds` of radii;
/// one contact at a time where there is no width.
fn jostled_solids<const D: usize>(
    width: Option<Width>,
    (law, friction): (LawKind, Option<Friction>),
    (kinds, sections): (usize, usize),
) -> [Vec<f64>; 2] {
    let mut state = 11_u64;
    let mut draw = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let (side, size) = (if D == 2 { 16_usize } else { 6 }, 6e-3);
    let count = side.pow(D as u32);
    let spheres: Vec<Sphere<D>> = (0..count)
        .map(|i| Sphere {
            centre: std::array::from_fn(|k| size * ((i / side.pow(k as u32) % side) as f64 + 0.01 * draw())),
            radius: 0.5 * size * (1.0 + 0.01 * ((i * 7) % kinds) as f64 / kinds as f64),
            material: usize::from(i % 5 == 3),
        })
        .collect();
    let materials: Vec<_> = ["440c", "brass-260"].map(|name| crate::material::find(name, &[]).unwrap()).into();
    let book = |friction| LawBook::Materials {
        law: Law::Named(law),
        constants: Constants::default(),
        pairs: Vec::new(),
        friction,
    };
    let mut rig = Rig::new(Sample { materials: materials.clone(), spheres }, book(friction));
    rig.periods[0] = Some(size * side as f64);
    let binder =
        ByMaterial { law: Law::Named(law), constants: Constants::default(), pairs: Vec::new(), friction, materials };
    let (finder, mut bodies) = (Finder::new(&rig), Bodies::new(&rig));
    let mut contacts = Contacts::<D, SolidLaw>::new(&rig, 2.0);
    contacts.renew(&rig, &finder, &bodies, &binder);
    contacts.sections = Sections::so_many(&contacts.near, count, sections);
    contacts.width = width.unwrap_or(Width::Scalar);
    assert!(contacts.beside.is_some());
    if width.is_none() {
        contacts.beside = None;
    }
    let (mut sums, mut felt, step) = (Sums::new(count, 0), Vec::new(), 1e-6);
    for _ in 0..12 {
        let before = bodies.velocity.clone();
        for i in 0..count {
            bodies.velocity[i] = std::array::from_fn(|_| 40.0 * (draw() - 0.5));
            bodies.spin.set(i, &[0, 1, 2].map(|_| 3e3 * (draw() - 0.5)));
            for k in 0..D {
                bodies.displacement[i][k] += step * bodies.velocity[i][k];
            }
        }
        let velocity = std::mem::replace(&mut bodies.velocity, before);
        let turn = bodies.spin.times(&contacts.lever);
        let predicted = Predicted { velocity: &velocity, turn: &turn, flat_velocity: &[], step };
        contacts.sweep(&rig, &bodies, predicted, &mut sums);
        felt.extend(sums.force.iter().flatten().chain(sums.torque.numbers()));
    }
    let closed = contacts.account.overlap.iter().filter(|&&overlap| overlap > 0.0).count();
    assert!(closed > 100 && closed < contacts.len() - 100, "{closed} of {}", contacts.len());
    let accounts = (0..contacts.len()).flat_map(|c| contacts.account.at(c).numbers());
    let memories = contacts.memory.iter().flat_map(SolidLaw::numbers);
    let remembered = accounts.chain(memories).chain((0..contacts.len()).map(|c| contacts.tangential_stored(c)));
    [felt, remembered.collect()]
}

/// Spheres of metals side by side do what they do one at a time, to the bit: under every kind of friction that registers take, with few kinds of
/// pairs and with many, in the plane and in space.
#[test]
fn every_width_gives_the_same_forces_on_spheres() {
    let friction = |spring, damping| Some(Friction { coefficient: 0.2, spring, damping, rolling: 0.0 });
    let frictions =
        [None, friction(Spring::Mindlin, 0.0), friction(Spring::Constant(1e7), 3e4), friction(Spring::None, 3e5)];
    for law in [LawKind::Thesis, LawKind::Hertz, LawKind::Consistent] {
        for friction in frictions {
            for kinds in [2, 9] {
                let case = (law, friction);
                let plane = jostled_solids::<2>(None, case, (kinds, 1)).map(|numbers| bits(&numbers));
                let space = jostled_solids::<3>(None, case, (kinds, 3)).map(|numbers| bits(&numbers));
                for width in Width::available() {
                    let of = jostled_solids::<2>(Some(width), case, (kinds, 1)).map(|numbers| bits(&numbers));
                    assert!(of == plane, "{width:?} {case:?} {kinds} in the plane");
                    let of = jostled_solids::<3>(Some(width), case, (kinds, 3)).map(|numbers| bits(&numbers));
                    assert!(of == space, "{width:?} {case:?} {kinds} in space");
                }
            }
        }
    }
}

/// Two spheres that meet after the first list was made, above a flat with a law of its own: the pair has its own law, though the flat's stands first.
#[test]
fn a_flat_s_own_law_is_not_that_of_pairs() {
    let book = LawBook::named(LawKind::Consistent);
    let material = crate::material::find("440c", &[]).unwrap();
    let at = |z: f64| Sphere { centre: [0.0, 0.0, z], radius: 3e-3, material: 0 };
    let sample = Sample { materials: vec![material.clone()], spheres: vec![at(3e-3), at(30e-3)] };
    let mut rig = Rig::new(sample, book);
    let law = Some(Law::Named(LawKind::Hertz));
    rig.flats.push(Flat {
        contact: FlatContact { law, ..FlatContact::default() },
        ..Flat::wall("floor", [0.0; 3], [0.0, 0.0, 1.0])
    });
    let named = Law::Named(LawKind::Consistent);
    let maker = ByMaterial {
        law: named,
        constants: Constants::default(),
        pairs: Vec::new(),
        friction: None,
        materials: vec![material],
    };
    let of = |width: Option<Width>| {
        let (finder, mut bodies) = (Finder::new(&rig), Bodies::new(&rig));
        let mut contacts = Contacts::<3, SolidLaw>::new(&rig, 2.0);
        contacts.renew(&rig, &finder, &bodies, &maker);
        assert_eq!((contacts.near.len(), contacts.faces.len()), (0, 1));
        // The upper one has come down to the lower one.
        bodies.displacement[1][2] = -21e-3 - 40e-6;
        contacts.renew(&rig, &finder, &bodies, &maker);
        contacts.width = width.unwrap_or(Width::Scalar);
        assert!(contacts.near.len() == 1 && contacts.beside.is_some());
        if width.is_none() {
            contacts.beside = None;
        }
        let mut sums = Sums::new(2, 1);
        let velocity = [[0.0; 3], [0.0, 0.0, -3.0]];
        let turn = bodies.spin.times(&contacts.lever);
        let predicted = Predicted { velocity: &velocity, turn: &turn, flat_velocity: &[[0.0; 3]], step: 1e-7 };
        contacts.sweep(&rig, &bodies, predicted, &mut sums);
        sums.force[1][2]
    };
    let one_at_a_time = of(None);
    assert!(one_at_a_time > 100.0);
    for width in Width::available() {
        assert_eq!(of(Some(width)).to_bits(), one_at_a_time.to_bits(), "{width:?}");
    }
}
