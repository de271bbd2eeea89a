use super::{Arrivals, Bulk, BulkError, Recording};
use crate::Context;
use crate::contact::{Constants, LawKind};
use crate::dem::{Face, ForcePulse, Impact, Integrator, Mirror, Period, Record, Stop, simulate};
use crate::lattice::{Block, BlockSide, Cell, Layered};
use crate::material::find;
use crate::real::Width;
use crate::sample::{Sample, Sphere};

const DIAMETER: f64 = 6.35e-3;
const ALL: Recording = Recording { energies: true, arrivals: Arrivals::OwnMaximum };

/// A block of three metals, mixed by a rule that repeats itself nowhere near.
fn mixed(name: &str, layers: u32, cells: [u32; 2], sides: [BlockSide; 2]) -> (Block, Sample<3>) {
    let block = Block::new(Cell::<3>::named(name).unwrap(), DIAMETER, layers, cells, 1, sides).unwrap();
    let material = |i: usize| [0, 0, 1, 0, 2, 0, 1, 2, 0][(i * i + i / 7) % 9];
    let sphere = |(i, site): (usize, &crate::lattice::CrystalSite<3>)| Sphere {
        centre: site.centre,
        radius: 0.5 * DIAMETER,
        material: material(i),
    };
    let spheres = block.sites().iter().enumerate().map(sphere).collect();
    let materials = ["440c", "brass", "al"].iter().map(|name| find(name, &[]).unwrap()).collect();
    (block, Sample { materials, spheres })
}

/// The half of a block between planes of symmetry, with a period along y, struck on its first layer.
fn impact(block: &Block, law: LawKind, integrator: Integrator) -> Impact {
    let [wide, high] = block.half_widths();
    Impact {
        mirrors: vec![Mirror { axis: 0, position: 0.0, inward: 1.0 }, Mirror { axis: 0, position: wide, inward: -1.0 }],
        periods: vec![Period { axis: 1, length: 2.0 * high }],
        law,
        constants: Constants::Code,
        pulse: ForcePulse { force: 9e3, duration: 20e-6 },
        slope: 0.0,
        struck: block.layer(1).collect(),
        faces: Vec::new(),
        moving: Vec::new(),
        projectile: None,
        exit: block.layer(block.layers()).collect(),
        integrator,
        step: 1e-7,
        window: 60e-6,
    }
}

fn followed(mut bulk: Bulk, impact: &Impact) -> Record<3> {
    let steps = crate::dem::steps_in(impact.window, impact.step);
    let stop = bulk.advance(steps, &Context::default()).err();
    bulk.record(stop)
}

fn off(ours: f64, theirs: f64) -> f64 {
    (ours - theirs).abs() / theirs.abs().max(1e-12)
}

/// The same to rounding and its growth as the machine that looks its contacts up: with history and rate, with a memory of the law's own, without
/// plasticity, by both schemes.
#[test]
fn rows_give_what_a_list_of_contacts_gives() {
    for (name, law, integrator) in [
        ("hcp", LawKind::Thesis, Integrator::Adams),
        ("fcc-111", LawKind::Thesis, Integrator::Verlet),
        ("hcp", LawKind::Consistent, Integrator::Adams),
        ("fcc-111", LawKind::Hertz, Integrator::Adams),
        ("hcp", LawKind::Tsuji, Integrator::Verlet),
    ] {
        let (block, sample) = mixed(name, 14, [10, 4], [BlockSide::Period; 2]);
        let impact = Impact { slope: 0.1, ..impact(&block, law, integrator) };
        let theirs = simulate(&sample, &impact, &Context::default()).unwrap();
        let ours = followed(Bulk::new(&sample, &impact, ALL, Width::widest()).unwrap(), &impact);
        assert_eq!((ours.stop.clone(), theirs.stop.clone(), ours.steps), (None, None, 600), "{name} {law}");
        let near = |what: &str, ours: &[f64], theirs: &[f64], allowed: f64| {
            let greatest = theirs.iter().copied().fold(0.0, f64::max);
            for (i, (ours, theirs)) in ours.iter().zip(theirs).enumerate() {
                let off = (ours - theirs).abs() / theirs.abs().max(1e-6 * greatest);
                assert!(off < allowed, "{name} {law} {what} {i}: {ours} and {theirs}");
            }
        };
        near("kinetic", &ours.max_kinetic, &theirs.max_kinetic, 1e-9);
        near("net force", &ours.max_net_force, &theirs.max_net_force, 1e-9);
        near("contact force", &ours.max_contact_force, &theirs.max_contact_force, 1e-9);
        near("dissipated", &ours.dissipated, &theirs.dissipated, 1e-7);
        let times = |record: &Record<3>| record.arrival.iter().map(|time| time.unwrap_or(0.0)).collect::<Vec<_>>();
        near("arrival", &times(&ours), &times(&theirs), 1e-8);
        for (ours, theirs) in [
            (ours.ledger.work_in, theirs.ledger.work_in),
            (ours.ledger.kinetic, theirs.ledger.kinetic),
            (ours.ledger.stored, theirs.ledger.stored),
            (ours.exit_momentum, theirs.exit_momentum),
            (ours.exit_force, theirs.exit_force),
        ] {
            assert!(off(ours, theirs) < 1e-9, "{name} {law}: {ours} and {theirs}");
        }
        assert_eq!(ours.contacts.len(), theirs.contacts.len());
        for (a, b) in ours.contacts.iter().zip(&theirs.contacts) {
            assert_eq!((a.spheres, a.weight), (b.spheres, b.weight));
        }
        for (a, b) in ours.displacement.iter().zip(&theirs.displacement) {
            assert!((0..3).all(|k| (a[k] - b[k]).abs() < 1e-12), "{name} {law}: {a:?} and {b:?}");
        }
        for (a, b) in ours.velocity.iter().zip(&theirs.velocity) {
            assert!((0..3).all(|k| (a[k] - b[k]).abs() < 1e-7), "{name} {law}: {a:?} and {b:?}");
        }
        // Twice the step would miss it by sixteen times as much, or four.
        let residual = ours.ledger.residual().unwrap().abs();
        assert!(residual < 2e-4, "{name} {law}: {residual:e}");
    }
}

/// Bits depend neither on threads nor on registers; sections are cut small, so that there are many.
#[test]
fn threads_and_registers_give_the_same_bits() {
    let (block, sample) = mixed("hcp", 14, [10, 4], [BlockSide::Period; 2]);
    let impact = impact(&block, LawKind::Thesis, Integrator::Adams);
    let run = |width, threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let bulk = Bulk::cut(&sample, &impact, ALL, width, 100).unwrap();
            assert!(bulk.sections.len() > 4, "{}", bulk.sections.len());
            followed(bulk, &impact)
        })
    };
    let one = run(Width::Scalar, 1);
    assert_eq!(one.stop, None);
    for width in Width::available() {
        assert!(run(width, 2) == one, "{width:?}");
    }
    // Cut otherwise, sums have another order.
    let whole = followed(Bulk::new(&sample, &impact, ALL, Width::widest()).unwrap(), &impact);
    for (a, b) in whole.max_kinetic.iter().zip(&one.max_kinetic) {
        assert!(off(*a, *b) < 1e-9);
    }
}

/// Half between planes of symmetry, and whole with periods.
#[test]
fn half_and_whole_agree() {
    let (block, half) = mixed("hcp", 10, [8, 4], [BlockSide::Period; 2]);
    let of_half = impact(&block, LawKind::Thesis, Integrator::Adams);
    let mut both: Vec<(Sphere<3>, usize)> = Vec::new();
    for (i, (sphere, &copies)) in half.spheres.iter().zip(block.copies()).enumerate() {
        both.push((*sphere, i));
        if copies == 2 {
            let [x, y, z] = sphere.centre;
            both.push((Sphere { centre: [-x, y, z], ..*sphere }, i));
        }
    }
    // In the order of rows.
    let key = |sphere: &Sphere<3>| [2, 1, 0].map(|axis| (sphere.centre[axis] / DIAMETER * 1e3).round() as i64);
    both.sort_by_key(|(sphere, _)| key(sphere));
    let whole = Sample { spheres: both.iter().map(|(sphere, _)| *sphere).collect(), ..half.clone() };
    let [wide, high] = block.half_widths();
    let of_whole = Impact {
        mirrors: Vec::new(),
        periods: vec![Period { axis: 0, length: 2.0 * wide }, Period { axis: 1, length: 2.0 * high }],
        struck: (0..both.len()).filter(|&k| block.layer(1).contains(&both[k].1)).collect(),
        exit: (0..both.len()).filter(|&k| block.layer(10).contains(&both[k].1)).collect(),
        ..of_half.clone()
    };
    let of = |sample, impact| followed(Bulk::new(sample, impact, ALL, Width::widest()).unwrap(), impact);
    let (whole, half) = (of(&whole, &of_whole), of(&half, &of_half));
    assert_eq!((&whole.stop, &half.stop), (&None, &None));
    for (k, (_, i)) in both.iter().enumerate() {
        assert!(off(whole.max_kinetic[k], half.max_kinetic[*i]) < 1e-8, "sphere {k}");
    }
    assert!(off(whole.ledger.work_in, 2.0 * half.ledger.work_in) < 1e-9);
    assert!(off(whole.ledger.dissipated, 2.0 * half.ledger.dissipated) < 1e-7);
    assert!(off(whole.exit_momentum, 2.0 * half.exit_momentum) < 1e-8);
}

/// One call or several, and what the wave has not reached costs nothing and changes nothing.
#[test]
fn a_run_may_be_cut_anywhere() {
    let (block, sample) = mixed("fcc-111", 20, [8, 3], [BlockSide::Period; 2]);
    let impact = Impact { window: 30e-6, ..impact(&block, LawKind::Thesis, Integrator::Adams) };
    let recording = Recording { energies: false, arrivals: Arrivals::Speed(0.1) };
    let mut bulk = Bulk::new(&sample, &impact, recording, Width::widest()).unwrap();
    let never = Context::default();
    for steps in [1, 63, 64, 100, 72] {
        bulk.advance(steps, &never).unwrap();
    }
    assert!(bulk.reached() < bulk.len() && bulk.displacement(bulk.len() - 1) == [0.0; 3]);
    let whole = followed(Bulk::new(&sample, &impact, recording, Width::widest()).unwrap(), &impact);
    assert!(bulk.record(None) == whole);
    let theirs = simulate(&sample, &impact, &never).unwrap();
    for (i, arrival) in whole.arrival.iter().enumerate() {
        assert_eq!(arrival.is_some(), 0.5 * sample.mass(i) * 0.01 < theirs.max_kinetic[i], "sphere {i}");
    }
}

/// A sphere that is shot out of the crystal and comes round by way of the period hits those on the other side: it is named.
#[test]
fn strangers_that_meet_are_named() {
    let (block, sample) = mixed("hcp", 6, [8, 3], [BlockSide::Free; 2]);
    let mut impact = impact(&block, LawKind::Thesis, Integrator::Verlet);
    let depth = 6.0 * block.layer_spacing() + 2.0 * DIAMETER;
    impact.periods = vec![Period { axis: 2, length: depth }];
    impact.mirrors.clear();
    impact.struck.clear();
    let last = block.layer(6).start + 20;
    impact.moving = vec![(last, 100.0)];
    impact.window = 200e-6;
    let mut bulk = Bulk::new(&sample, &impact, ALL, Width::widest()).unwrap();
    match bulk.advance(2000, &Context::default()) {
        Err(Stop::Met { spheres: [a, b], time_s }) => {
            assert!(block.layer(1).contains(&(a - 1)) && b == last + 1, "{a} {b}");
            // To where the first layer begins again: they meet one above the other, or one falls between three that are a layer's distance away.
            let way = depth - 5.0 * block.layer_spacing();
            let nearest = way - DIAMETER..way - block.layer_spacing();
            assert!(nearest.contains(&(100.0 * time_s)), "{time_s}");
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn what_is_no_crystal_of_rows_is_refused() {
    let (block, mut sample) = mixed("hcp", 6, [8, 3], [BlockSide::Free; 2]);
    let impact = impact(&block, LawKind::Thesis, Integrator::Adams);
    let new = |sample: &Sample<3>, impact: &Impact| Bulk::new(sample, impact, ALL, Width::widest()).map(|_| ());
    assert!(matches!(new(&sample, &Impact { integrator: Integrator::Rk4, ..impact.clone() }), Err(BulkError::Scheme)));
    assert!(matches!(new(&sample, &Impact { step: f64::NAN, ..impact.clone() }), Err(BulkError::Step(_))));
    let round = Impact { faces: vec![Face::Cylinder { radius: 1.0 }], ..impact.clone() };
    assert!(matches!(new(&sample, &round), Err(BulkError::Faces)));
    sample.spheres[3].centre[0] -= 0.01 * DIAMETER;
    assert!(matches!(new(&sample, &impact), Err(BulkError::Rows(_))));
    sample.spheres[3].radius *= 0.5;
    assert!(matches!(new(&sample, &impact), Err(BulkError::Rows(_))));
}

/// A checkpoint holds all that the rest of a run depends on; one of another crystal, or a damaged one, is refused.
#[test]
fn a_run_goes_on_from_a_checkpoint_to_the_same_bits() {
    let (block, sample) = mixed("hcp", 14, [10, 4], [BlockSide::Period; 2]);
    let never = Context::default();
    for (law, integrator) in [(LawKind::Thesis, Integrator::Adams), (LawKind::Consistent, Integrator::Verlet)] {
        let impact = impact(&block, law, integrator);
        for arrivals in [Arrivals::None, Arrivals::Speed(1.0), Arrivals::OwnMaximum] {
            let new = |impact: &Impact| {
                let recording = Recording { energies: true, arrivals };
                Bulk::cut(&sample, impact, recording, Width::widest(), 300).unwrap()
            };
            let mut first = new(&impact);
            first.advance(250, &never).unwrap();
            let mut bytes = Vec::new();
            first.save(&mut bytes).unwrap();
            first.advance(350, &never).unwrap();
            let mut second = new(&impact);
            second.restore(&mut &bytes[..]).unwrap();
            assert_eq!(second.steps(), 250);
            second.advance(350, &never).unwrap();
            assert!(second.record(None) == first.record(None));

            let other = Impact { pulse: ForcePulse { force: 1.0, ..impact.pulse }, ..impact.clone() };
            assert!(new(&other).restore(&mut &bytes[..]).is_err());
            assert!(new(&impact).restore(&mut &bytes[..bytes.len() - 9]).is_err());
            let middle = bytes.len() / 2;
            bytes[middle] ^= 1;
            let refused = |bytes: &[u8]| new(&impact).restore(&mut &*bytes).unwrap_err().to_string();
            assert_eq!(refused(&bytes), "the checkpoint is damaged: its checksum does not fit");
            let older = [b"granulens bulk version 2", &bytes[24..]].concat();
            assert_eq!(refused(&older), "the checkpoint has version 2; this program reads version 4");
            assert_eq!(refused(b"granulens checkpoint"), "this is no checkpoint of granulens");
        }
    }
}
