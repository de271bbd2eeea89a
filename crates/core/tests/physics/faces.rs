//! Planes and walls across no axis: a turned crystal, parts between planes of symmetry, and round walls.

use granulens_core::Context;
use granulens_core::contact::{Constants, LawKind};
use granulens_core::dem::{Face, ForcePulse, Impact, Integrator, Mirror, Record, simulate_batch};
use granulens_core::lattice::{Block, BlockSide, Cell, CrystalSite, Layered, Outline};
use granulens_core::real::Width as Lanes;
use granulens_core::sample::{Sample, Sphere};

use crate::problem::{DIAMETER, run};
use crate::reference::{difference, material};

fn impact(struck: Vec<usize>, mirrors: Vec<Mirror>, faces: Vec<Face>) -> Impact {
    Impact {
        mirrors,
        faces,
        periods: Vec::new(),
        law: LawKind::Thesis,
        constants: Constants::Code,
        // Spheres of a rim have fewer contacts below them to carry it.
        pulse: ForcePulse { force: 8e3, duration: 20e-6 },
        slope: 0.0,
        struck,
        moving: Vec::new(),
        projectile: None,
        exit: Vec::new(),
        integrator: Integrator::Adams,
        step: 1e-7,
        window: 60e-6,
    }
}

fn block(name: &str, cells: [u32; 2], layers: u32) -> Block {
    Block::new(Cell::<3>::named(name).unwrap(), DIAMETER, layers, cells, 3, [BlockSide::Free; 2]).unwrap()
}

fn plane(degrees: f64, position: f64) -> Face {
    let (sine, cosine) = degrees.to_radians().sin_cos();
    Face::Plane { normal: [cosine, sine, 0.0], position }
}

/// By how much two numbers differ, over the greater or over a millionth of the most there is.
fn off(a: f64, b: f64, most: f64) -> f64 {
    difference(a, b, 1e-6 * most)
}

/// Turned by an angle about z, with planes in place of the mirrors across axes, a crystal does what it did, turned: spheres on the plane of symmetry among
/// it, and such that touch a wall besides; alone, and to the same bits beside others, by either scheme.
#[test]
fn a_turned_crystal_moves_as_it_did() {
    let block = block("hcp", [8, 4], 6);
    let sphere = |(i, site): (usize, &CrystalSite<3>)| Sphere {
        centre: site.centre,
        radius: 0.5 * DIAMETER,
        material: i * 7 % 5 % 2,
    };
    let spheres: Vec<Sphere<3>> = block.sites().iter().enumerate().map(sphere).collect();
    let edge = |fold: fn(f64, f64) -> f64, from| spheres.iter().map(|sphere| sphere.centre[1]).fold(from, fold);
    let low = edge(f64::min, f64::INFINITY) - 0.5 * DIAMETER;
    let high = edge(f64::max, f64::NEG_INFINITY) + 0.5 * DIAMETER;
    let mirrors = vec![
        Mirror { axis: 0, position: 0.0, inward: 1.0 },
        Mirror { axis: 1, position: low, inward: 1.0 },
        Mirror { axis: 1, position: high, inward: -1.0 },
    ];
    let straight = Sample { materials: vec![material("440c"), material("brass")], spheres };
    for integrator in [Integrator::Adams, Integrator::Rk4] {
        let impact = Impact { integrator, ..impact(block.layer(1).collect(), Vec::new(), Vec::new()) };
        let before = run(&straight, &Impact { mirrors: mirrors.clone(), ..impact.clone() });
        let fastest = before.velocity.iter().flatten().fold(0.0, |most: f64, v| v.abs().max(most));
        let most = before.max_kinetic.iter().copied().fold(0.0, f64::max);
        for degrees in [37.0_f64, 120.0] {
            let (sine, cosine) = degrees.to_radians().sin_cos();
            let turned = |[x, y, z]: [f64; 3]| [cosine * x - sine * y, sine * x + cosine * y, z];
            let spheres = straight.spheres.iter().map(|sphere| Sphere { centre: turned(sphere.centre), ..*sphere });
            let sample = Sample { spheres: spheres.collect(), ..straight.clone() };
            let faces = vec![plane(degrees, 0.0), plane(degrees + 90.0, low), plane(degrees - 90.0, -high)];
            let impact = Impact { faces, ..impact.clone() };
            let after = run(&sample, &impact);
            assert_eq!(after.stop, None);
            // Rounding and its growth.
            for i in 0..sample.spheres.len() {
                let energies = off(after.max_kinetic[i], before.max_kinetic[i], most);
                let forces = difference(after.max_net_force[i], before.max_net_force[i], 1.0);
                assert!(energies < 1e-8 && forces < 1e-8, "{degrees} sphere {i}: {energies:e} {forces:e}");
                let expected = turned(before.velocity[i]);
                for k in 0..3 {
                    let off = (after.velocity[i][k] - expected[k]).abs() / fastest;
                    assert!(off < 1e-9, "{degrees} sphere {i} axis {k}: {off:e}");
                }
            }
            let (ours, theirs) = (after.ledger, before.ledger);
            assert!(ours.residual().unwrap().abs() < 1e-4, "{ours:?}");
            for (a, b) in
                [(ours.work_in, theirs.work_in), (ours.kinetic, theirs.kinetic), (ours.dissipated, theirs.dissipated)]
            {
                assert!(difference(a, b, 0.0) < 1e-9, "{degrees}: {a} {b}");
            }
            if integrator == Integrator::Adams {
                let batch = [straight_of(&sample), sample];
                let beside = simulate_batch(&batch, &impact, Lanes::widest(), &Context::default()).unwrap();
                assert_eq!(beside[1].max_kinetic, after.max_kinetic);
            }
        }
    }
}

/// The same places in one material.
fn straight_of(sample: &Sample<3>) -> Sample<3> {
    let spheres = sample.spheres.iter().map(|sphere| Sphere { material: 0, ..*sphere }).collect();
    Sample { spheres, ..sample.clone() }
}

/// What may stand around a crystal.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Sides {
    Free,
    Wall,
}

/// A crystal about a sphere, with a body of revolution of brass in it: its whole, and which of its spheres stand for each.
struct Round {
    block: Block,
    whole: Sample<3>,
    struck: Vec<usize>,
}

impl Round {
    fn new(name: &str, outline: Outline, brass: [f64; 2]) -> Self {
        let block = block(name, [10, 6], 9).within(outline).unwrap();
        let (mut spheres, mut struck) = (Vec::new(), Vec::new());
        for (site, &copies) in block.sites().iter().zip(block.copies()) {
            let [x, y, z] = site.centre;
            let is_brass = (3..=5).contains(&site.layer) && (brass[0]..brass[1]).contains(&(x.hypot(y) / DIAMETER));
            for x in [x, -x].into_iter().take(usize::from(copies)) {
                if site.layer == 1 {
                    struck.push(spheres.len());
                }
                spheres.push(Sphere { centre: [x, y, z], radius: 0.5 * DIAMETER, material: usize::from(is_brass) });
            }
        }
        Self { block, whole: Sample { materials: vec![material("440c"), material("brass")], spheres }, struck }
    }

    /// What stands around those of the spheres that lie between two directions (degrees).
    fn walls(&self, sides: Sides, [from, to]: [f64; 2]) -> Vec<Face> {
        let centres = || self.whole.spheres.iter().map(|sphere| sphere.centre);
        let reach = |least: fn([f64; 3], f64, f64) -> f64, degrees: f64| {
            let (sine, cosine) = degrees.to_radians().sin_cos();
            centres().map(|centre| least(centre, cosine, sine)).fold(0.0, f64::max) + 0.5 * DIAMETER
        };
        match (sides, self.block.outline()) {
            (Sides::Free, _) | (_, Outline::All) => Vec::new(),
            (Sides::Wall, Outline::Disk(_)) => {
                vec![Face::Cylinder { radius: reach(|[x, y, _], _, _| x.hypot(y), 0.0) }]
            }
            (Sides::Wall, Outline::Hexagon(_)) => (0..6)
                .map(|k| 60.0 * f64::from(k) - 90.0)
                .filter(|degrees| (from..=to).contains(degrees))
                .map(|degrees| {
                    let way = reach(|[x, y, _], cosine, sine| cosine * x + sine * y, degrees);
                    plane(degrees + 180.0, -way)
                })
                .collect(),
        }
    }

    /// The part between some planes through the axis, and of which sphere of the whole each of its own is.
    fn part(&self, planes: &[f64]) -> (Sample<3>, Vec<usize>) {
        let is_inside = |sphere: &Sphere<3>| {
            planes.iter().all(|degrees| {
                let (sine, cosine) = degrees.to_radians().sin_cos();
                cosine * sphere.centre[0] + sine * sphere.centre[1] > -1e-9 * DIAMETER
            })
        };
        let of: Vec<usize> = (0..self.whole.spheres.len()).filter(|&i| is_inside(&self.whole.spheres[i])).collect();
        let spheres = of.iter().map(|&i| self.whole.spheres[i]).collect();
        (Sample { spheres, ..self.whole.clone() }, of)
    }

    fn run_part(&self, planes: &[f64], walls: Vec<Face>, impact: &Impact) -> (Record<3>, Vec<usize>) {
        let (sample, of) = self.part(planes);
        let struck = (0..of.len()).filter(|&k| self.struck.contains(&of[k])).collect();
        let faces = planes.iter().map(|&degrees| plane(degrees, 0.0)).chain(walls).collect();
        (run(&sample, &Impact { struck, faces, ..impact.clone() }), of)
    }
}

/// About a sphere HCP and FCC along (111) have three planes of symmetry at 60 degrees. Half of a crystal and a sixth move as the whole does, under free sides
/// and between walls; spheres on either plane and on both, and the three around the axis that touch each other, among them.
#[test]
fn a_sixth_moves_as_the_half_and_the_whole() {
    for (name, outline, sides, brass) in [
        ("hcp", Outline::Disk(5.0), Sides::Free, [0.0, 2.6]),
        ("hcp", Outline::Disk(4.8), Sides::Wall, [1.2, 3.1]),
        ("fcc-111", Outline::Hexagon(5.0), Sides::Wall, [0.0, 2.6]),
        ("hcp", Outline::Hexagon(4.5), Sides::Wall, [0.0, 0.0]),
        ("fcc-111", Outline::Disk(5.0), Sides::Free, [0.0, 0.0]),
    ] {
        let round = Round::new(name, outline, brass);
        let impact = impact(Vec::new(), Vec::new(), Vec::new());
        let (whole, _) = round.run_part(&[], round.walls(sides, [-90.0, 270.0]), &impact);
        assert_eq!(whole.stop, None);
        let most = whole.max_kinetic.iter().copied().fold(0.0, f64::max);
        let of_walls = whole.contacts.iter().filter(|contact| contact.spheres[0] == contact.spheres[1]).count();
        assert_eq!(of_walls > 50, sides == Sides::Wall, "{of_walls}");
        for (planes, parts, walls) in [
            (&[0.0][..], 2.0, round.walls(sides, [-90.0, 90.0])),
            (&[0.0, 120.0], 6.0, round.walls(sides, [30.0, 90.0])),
        ] {
            let (part, of) = round.run_part(planes, walls, &impact);
            assert_eq!(part.stop, None);
            let mut greatest = [0.0_f64; 4];
            for (k, &i) in of.iter().enumerate() {
                let offs = [
                    off(part.max_kinetic[k], whole.max_kinetic[i], most),
                    difference(part.max_contact_force[k], whole.max_contact_force[i], 1.0),
                    off(part.dissipated[k], whole.dissipated[i], most),
                    match (part.arrival[k], whole.arrival[i]) {
                        (Some(a), Some(b)) if whole.max_kinetic[i] > 1e-6 * most => difference(a, b, 0.0),
                        _ => 0.0,
                    },
                ];
                (0..4).for_each(|k| greatest[k] = offs[k].max(greatest[k]));
            }
            // Rounding and its growth.
            assert!(greatest.iter().all(|&off| off < 1e-8), "{name} {outline:?} {sides:?} 1/{parts}: {greatest:?}");
            let (ours, theirs) = (part.ledger, whole.ledger);
            for (a, b) in [
                (ours.work_in, theirs.work_in),
                (ours.kinetic, theirs.kinetic),
                (ours.stored, theirs.stored),
                (ours.dissipated, theirs.dissipated),
                (ours.estimate, theirs.estimate),
            ] {
                assert!(difference(parts * a, b, 1e-6 * theirs.work_in) < 1e-9, "{name} 1/{parts}: {a} {b}");
            }
        }
    }
}

/// A smooth round wall pushes towards the axis alone and keeps no energy: whatever strikes whom, the energy is accounted for and the momentum about the axis stays
/// none. Along a radius it is the plane that touches it there.
#[test]
fn a_round_wall_turns_nothing_and_is_a_plane_along_a_radius() {
    let round = Round::new("hcp", Outline::Disk(3.0), [0.0, 1.2]);
    let wall = round.walls(Sides::Wall, [0.0, 0.0]);
    // Some spheres of the first layer, which no symmetry takes into each other.
    let struck: Vec<usize> = round.struck.iter().copied().filter(|i| i * 5 % 7 < 3).collect();
    let elastic = Impact { law: LawKind::Hertz, step: 2e-8, ..impact(struck, Vec::new(), wall) };
    let record = run(&round.whole, &elastic);
    assert_eq!(record.stop, None);
    assert!(record.contacts.iter().filter(|contact| contact.spheres[0] == contact.spheres[1]).count() > 20);
    assert!(record.ledger.residual().unwrap().abs() < 1e-6, "{:?}", record.ledger);
    let about = |i: usize| {
        let ([x, y, _], [u, v, _], [vx, vy, _]) =
            (round.whole.spheres[i].centre, record.displacement[i], record.velocity[i]);
        round.whole.mass(i) * ((x + u) * vy - (y + v) * vx)
    };
    let each: Vec<f64> = (0..round.whole.spheres.len()).map(about).collect();
    let (sum, all) = (each.iter().sum::<f64>(), each.iter().map(|l| l.abs()).sum::<f64>());
    // Forces of contacts are along their lines and add up to no couple at the very places for which they are worked out, so rounding alone.
    assert!(all > 0.0 && (sum / all).abs() < 1e-12, "{:e}", sum / all);

    // Three spheres around the axis, pushed apart by one above them, move along radii.
    let high = (2.0_f64 / 3.0).sqrt() * DIAMETER;
    let from_axis = DIAMETER / 3.0_f64.sqrt();
    let mut spheres = vec![Sphere { centre: [0.0; 3], radius: 0.5 * DIAMETER, material: 0 }];
    spheres.extend([90.0_f64, 210.0, 330.0].map(|degrees| {
        let (sine, cosine) = degrees.to_radians().sin_cos();
        Sphere { centre: [from_axis * cosine, from_axis * sine, high], radius: 0.5 * DIAMETER, material: 0 }
    }));
    let sample = Sample { materials: vec![material("440c")], spheres };
    // Touching, and a hundredth of a diameter away.
    for gap in [0.0, 0.01 * DIAMETER] {
        let reach = from_axis + 0.5 * DIAMETER + gap;
        let planes = [90.0, 210.0, 330.0].map(|degrees: f64| plane(degrees + 180.0, -reach)).to_vec();
        let [between, within] = [planes, vec![Face::Cylinder { radius: reach }]]
            .map(|faces| run(&sample, &impact(vec![0], Vec::new(), faces)));
        assert!(within.contacts.iter().filter(|contact| contact.spheres[0] == contact.spheres[1]).count() == 3);
        for i in 0..4 {
            let off = difference(within.max_kinetic[i], between.max_kinetic[i], 0.0);
            assert!(off < 1e-9, "{gap} sphere {i}: {off:e}");
        }
    }
}
