//! Elastic hexagonal sheets: million sphere-steps per second of processor time.
//!
//! `cargo bench -p granulens-benches --bench sheet`, or `cargo bench --bench sheet -- 20000 1000000` for sizes of one's own, or with
//! `--case NAME` for one case. With `--export FOLDER STEPS closed|impact SIZE` a crystal is written for LAMMPS, and
//! where its spheres are after so many steps, for `benches/against_lammps.py`. What the figures mean: `benches/README.md`.

mod clock;

use std::fmt::Write as _;
use std::path::Path;
use std::time::Instant;

use clock::{peak_memory, processor_time};
use granulens::contact::LawKind;
use granulens::dem::rig::{Body, Curve, Law, LawBook, Load, LoadKind, Rig};
use granulens::dem::sheet::{Grid, Sheet, Sides};
use granulens::export::deck;
use granulens::material::{Material, find};
use granulens::real::Width;
use granulens::sample::{Sample, Sphere};
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};

const DIAMETER: f64 = 6.35e-3;
const STEP: f64 = 5e-8;

/// A nearly square sheet of about so many spheres, its sides periodic.
fn grid(spheres: usize, squeezed: bool) -> Grid {
    let side = (spheres as f64).sqrt();
    let rows = 2 * (0.5 * side).round() as usize;
    let spacing = if squeezed { (1.0 - 1e-3) * DIAMETER } else { DIAMETER };
    let columns = (spheres as f64 / rows as f64).round() as usize;
    Grid { rows, columns: [columns; 2], diameter: DIAMETER, spacing, sides: Sides::Periodic, joined: squeezed }
}

fn metals() -> Vec<Material> {
    ["440c", "brass", "al"].iter().map(|name| find(name, &[]).expect("a library material")).collect()
}

/// Three metals mixed at random, another mixture for each seed.
fn mix(grid: &Grid, seed: usize) -> Vec<u8> {
    let mut chance = Xoshiro256PlusPlus::seed_from_u64(seed as u64);
    (0..grid.len()).map(|_| (chance.next_u64() % 3) as u8).collect()
}

/// Velocities of up to 0.5 mm/s.
fn shaken(grid: &Grid) -> Vec<[f64; 2]> {
    let mut chance = Xoshiro256PlusPlus::seed_from_u64(0);
    let mut speed = || 1e-3 * ((chance.next_u64() >> 11) as f64 / (1_u64 << 53) as f64 - 0.5);
    (0..grid.len()).map(|_| [speed(), speed()]).collect()
}

/// Force on every sphere of the first row (N), and how long it lasts (s), where the crystal is not squeezed.
const BLOW: (f64, f64) = (100.0, 20e-6);

/// Crystals squeezed by 0.1 % and shaken a little, so that all contacts are closed; or just touching, and struck on the first row.
fn sheet(grid: Grid, designs: usize, width: Width) -> Sheet {
    let mixes: Vec<Vec<u8>> = (0..designs).map(|seed| mix(&grid, seed)).collect();
    let mixes: Vec<&[u8]> = mixes.iter().map(Vec::as_slice).collect();
    let mut sheet = Sheet::new(grid, &metals(), &mixes, STEP, width).expect("a sheet");
    if grid.joined {
        sheet.set_velocities(&shaken(&grid));
    } else {
        sheet.strike(BLOW.0, BLOW.1, &(0..grid.columns[0]).collect::<Vec<_>>());
    }
    sheet
}

/// The first crystal as a rig.
fn rig(grid: &Grid) -> Rig<2> {
    let sphere = |([row, column], material): ([usize; 2], u8)| Sphere {
        centre: grid.centre(row, column),
        radius: 0.5 * grid.diameter,
        material: usize::from(material),
    };
    let spheres = grid.sites().zip(mix(grid, 0)).map(sphere).collect();
    let law = Law::Named(LawKind::Hertz);
    let laws = LawBook::Materials { law, constants: Default::default(), pairs: Vec::new(), friction: None };
    let mut rig = Rig::new(Sample { materials: metals(), spheres }, laws);
    let depth = grid.rows as f64 * 0.75_f64.sqrt() * grid.spacing;
    rig.periods = [Some(grid.columns[0] as f64 * grid.spacing), grid.joined.then_some(depth)];
    rig.precompressed = grid.joined;
    if grid.joined {
        rig.velocity = shaken(grid);
    } else {
        let curve = Curve::Square { peak: BLOW.0, start: 0.0, duration: BLOW.1 };
        let bodies = (0..grid.columns[0]).map(Body::Sphere).collect();
        rig.loads.push(Load { bodies, direction: [0.0, 1.0], kind: LoadKind::Force, curve });
    }
    rig
}

/// Writes the deck, and the centres after its last step.
fn export(folder: &Path, steps: u64, grid: Grid) {
    let deck = deck(&rig(&grid), STEP, steps, steps).expect("a deck");
    let mut sheet = sheet(grid, 1, Width::widest());
    sheet.advance(steps, 1).expect("a calm sheet");
    let mut centres = String::new();
    for ([row, column], moved) in grid.sites().zip(sheet.displacements(0)) {
        let rest = grid.centre(row, column);
        let _ = writeln!(centres, "{:e} {:e}", rest[0] + moved[0], rest[1] + moved[1]);
    }
    std::fs::create_dir_all(folder).expect("a folder");
    for (name, text) in [("crystal.data", deck.data), ("in.crystal", deck.input), ("centres.txt", centres)] {
        std::fs::write(folder.join(name), text).expect("room on the disk");
    }
}

/// Million sphere-steps per second: of processor time, and of time that passes. A struck sheet is followed for 200 µs.
fn rate(make: impl Fn() -> Sheet, designs: usize, threads: usize, millions: f64) -> [f64; 2] {
    let mut sheet = make();
    let spheres = sheet.grid().len() * designs;
    let closed = sheet.grid().joined;
    let steps = if closed { ((millions * 1e6 / spheres as f64) as u64).max(20) } else { 4000 };
    // Caches and clocks are warm after a tenth of that.
    sheet.advance(steps / 10 + 1, threads).expect("a calm sheet");
    if !closed {
        sheet = make();
    }
    let (begun, before) = (Instant::now(), processor_time(Instant::now()));
    sheet.advance(steps, threads).expect("a calm sheet");
    let work = 1e-6 * spheres as f64 * steps as f64;
    [work / (processor_time(begun) - before), work / begun.elapsed().as_secs_f64()]
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|argument| argument != "--bench").collect();
    let one = arguments.iter().position(|argument| argument == "--case").and_then(|at| arguments.get(at + 1));
    let mut sizes: Vec<usize> = arguments.iter().filter_map(|argument| argument.parse().ok()).collect();
    if let Some(at) = arguments.iter().position(|argument| argument == "--export") {
        let [folder, steps, kind, size] = &arguments[at + 1..at + 5] else { unreachable!("five of them") };
        let number = |text: &String| text.parse::<usize>().expect("a number");
        return export(Path::new(folder), number(steps) as u64, grid(number(size), kind == "closed"));
    }
    if sizes.is_empty() {
        sizes = vec![2_000, 20_000, 200_000, 1_000_000];
    }
    let width = Width::widest();
    let lanes = width.lanes();
    type Case = (&'static str, bool, usize, Width, usize);
    let cases: [Case; 6] = [
        ("closed", true, 1, width, 1),
        ("closed-scalar", true, 1, Width::Scalar, 1),
        ("closed-batch", true, lanes, width, 1),
        ("impact", false, 1, width, 1),
        ("impact-batch", false, lanes, width, 1),
        ("closed-threads", true, 1, width, rayon::current_num_threads()),
    ];
    println!(
        "{:>9} {:>15} {:>8} {:>8} {:>12} {:>12}",
        "spheres", "case", "crystals", "threads", "M/s of work", "M/s passing"
    );
    for &spheres in &sizes {
        for &(name, squeezed, designs, width, threads) in &cases {
            if one.is_some_and(|one| one != name) {
                continue;
            }
            let grid = grid(spheres, squeezed);
            let millions = if width == Width::Scalar { 20.0 } else { 100.0 };
            let [work, passing] = rate(|| sheet(grid, designs, width), designs, threads, millions);
            println!("{:>9} {name:>15} {designs:>8} {threads:>8} {work:>12.1} {passing:>12.1}", grid.len());
        }
        if let Some(bytes) = peak_memory().filter(|_| one.is_some()) {
            println!("peak memory of the process: {:.0} bytes a sphere", bytes / spheres as f64);
        }
    }
}
