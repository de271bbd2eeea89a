//! An intruder on a bed of some 6000 disks: time per step, with kinetic and with static friction; and on fifteen such beds side by
//! side, with one thread and with two.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use granulens::Context;
use granulens::bed::{Bed, BedImpact, Body, Disk, Grains, Intruder, Outline, strike};

/// The reference bed of the tests.
fn bed() -> Bed {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/data/beds/bed1.csv");
    let text = std::fs::read_to_string(path).expect("the reference bed");
    let mut bed = Bed { grains: Vec::new(), walls: Vec::new(), width: 100.0, periodic: true };
    for line in text.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit())) {
        let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().expect("a number")).collect();
        let disk = Disk { centre: [cells[2], cells[3]], diameter: cells[4] };
        if cells[1] == 1.0 { bed.grains.push(disk) } else { bed.walls.push(disk) }
    }
    bed
}

fn impacts(criterion: &mut Criterion) {
    let (bed, go) = (bed(), Context::default());
    let mut group = criterion.benchmark_group("bed, 6172 disks, to t = 20 (1000 steps)");
    group.sample_size(10);
    for (name, tangential_stiffness) in [("kinetic friction", 0.0), ("static friction", 0.8)] {
        let mut grains = Grains::default();
        grains.grains.tangential_stiffness = tangential_stiffness;
        grains.walls.tangential_stiffness = tangential_stiffness;
        let outline = Outline::Disk { diameter: 10.0 };
        let intruder = Intruder { outline, mass: 100.0, body: Body::Solid, turns: true, speed: 0.7, height: 0.0 };
        let impact = BedImpact { sample: 20.0, ..BedImpact::new(grains, intruder, 20.0) };
        group.bench_function(name, |bencher| {
            bencher.iter(|| black_box(strike(&bed, &impact, &go, |_| ())));
        });
    }
    group.finish();
}

/// The bed repeats sideways, so that copies of it beside one another are at rest as it is.
fn side_by_side(bed: &Bed, copies: usize) -> Bed {
    let repeat = |disks: &[Disk]| {
        let shifted =
            |k: usize, disk: &Disk| Disk { centre: [disk.centre[0] + k as f64 * bed.width, disk.centre[1]], ..*disk };
        (0..copies).flat_map(|k| disks.iter().map(move |disk| shifted(k, disk))).collect()
    };
    Bed {
        grains: repeat(&bed.grains),
        walls: repeat(&bed.walls),
        width: copies as f64 * bed.width,
        periodic: bed.periodic,
    }
}

fn many(criterion: &mut Criterion) {
    let (bed, go) = (side_by_side(&bed(), 15), Context::default());
    let mut group = criterion.benchmark_group("bed, 92 566 disks, to t = 6 (300 steps)");
    group.sample_size(10);
    let outline = Outline::Disk { diameter: 10.0 };
    let intruder = Intruder { outline, mass: 100.0, body: Body::Solid, turns: true, speed: 0.7, height: 0.0 };
    let impact = BedImpact { sample: 6.0, ..BedImpact::new(Grains::default(), intruder, 6.0) };
    for threads in [1, 2] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        group.bench_function(format!("threads: {threads}"), |bencher| {
            bencher.iter(|| pool.install(|| black_box(strike(&bed, &impact, &go, |_| ()))));
        });
    }
    group.finish();
}

criterion_group!(benches, impacts, many);
criterion_main!(benches);
