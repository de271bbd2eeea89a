//! Large crystals in space: million sphere-steps per second of processor time, every sphere counted at every step.
//!
//! `cargo bench -p granulens-benches --bench bulk`, or with sizes of one's own, `--case NAME` for one case, `--checkpoint FILE` to write one at the end.
//! With `--export FOLDER STEPS crossing|closed SIZE` a crystal under Hertz's law is written for LAMMPS, and where its spheres are after so many steps, for
//! `benches/against_lammps.py --space`. What the figures mean: `benches/README.md`.

mod clock;

use std::fmt::Write as _;
use std::io::BufWriter;
use std::path::Path;
use std::time::Instant;

use clock::{peak_memory, processor_time};
use granulens::Context;
use granulens::contact::{Constants, LawKind};
use granulens::dem::bulk::{Arrivals, Bulk, Recording};
use granulens::dem::rig::{Body, Curve, Law, LawBook, Load, LoadKind, Rig};
use granulens::dem::{ForcePulse, Impact, Integrator, Period};
use granulens::export::deck;
use granulens::lattice::{Cell, Crystal, Outline, Width as Cells};
use granulens::material::find;
use granulens::real::Width;
use granulens::sample::{Sample, Sphere};
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};

const DIAMETER: f64 = 6.35e-3;
const STEP: f64 = 1e-7;
/// On every sphere of layer 1 (N), and how long (s).
const BLOW: (f64, f64) = (15e3, 20e-6);
/// By which a crystal contracts in a second where all of its contacts are to be closed: 3 mm in a metre and 100 steps.
const CONTRACTION: f64 = 300.0;

#[derive(Clone, Copy, PartialEq)]
enum Materials {
    /// 440c, brass and 302, sphere by sphere at random.
    Random,
    /// A lens of brass in 440c.
    Lens,
}

/// A nearly cubic HCP crystal of about so many spheres.
struct Case {
    crystal: Crystal<3>,
    sample: Sample<3>,
    closed: bool,
}

impl Case {
    fn new(size: usize, materials: Materials, closed: bool) -> Self {
        let side = ((size as f64).cbrt() / 2.0).round() as u32 * 2;
        let cell = Cell::<3>::named("hcp").expect("a structure");
        let cells = [Cells::Cells(side), Cells::Cells(side / 2)];
        let crystal = Crystal::new(cell, DIAMETER, side, &cells, Outline::All).expect("a crystal");
        let mut chance = Xoshiro256PlusPlus::seed_from_u64(1);
        let middle = crystal.sites()[crystal.sites().len() / 2].centre;
        let radius = 0.35 * f64::from(side) * DIAMETER;
        let mut material = |centre: &[f64; 3]| match materials {
            Materials::Random => (chance.next_u64() % 3) as usize,
            // A ball's cap: convex towards the blow.
            Materials::Lens => {
                let [x, y, z] = [0, 1, 2].map(|k| centre[k] - middle[k]);
                usize::from(z < 0.0 && x * x + y * y + z * z < radius * radius)
            }
        };
        let sphere = |centre| Sphere { centre, radius: 0.5 * DIAMETER, material: material(&centre) };
        let spheres = crystal.sites().iter().map(|site| site.centre).map(sphere).collect();
        let materials = ["440c", "brass", "302"].iter().map(|name| find(name, &[]).expect("a material")).collect();
        Self { crystal, sample: Sample { materials, spheres }, closed }
    }

    fn len(&self) -> usize {
        self.sample.spheres.len()
    }

    /// Spheres of the first layer.
    fn struck(&self) -> Vec<usize> {
        if self.closed {
            Vec::new()
        } else {
            (0..self.crystal.sites().iter().filter(|site| site.layer == 1).count()).collect()
        }
    }

    /// Towards the middle (m/s).
    fn velocity(&self, sphere: usize) -> [f64; 3] {
        let [centre, middle] = [sphere, self.len() / 2].map(|i| self.sample.spheres[i].centre);
        std::array::from_fn(|k| if self.closed { -CONTRACTION * (centre[k] - middle[k]) } else { 0.0 })
    }

    fn periods(&self) -> [Option<f64>; 3] {
        // Free sides where the crystal contracts.
        let of = |axis: usize| self.crystal.periods()[axis].filter(|_| !self.closed && axis < 2);
        [of(0), of(1), None]
    }

    /// Steps in which a pulse crosses it, at a pace that the slowest front of these mixtures keeps.
    fn steps(&self) -> u64 {
        let depth = self.sample.spheres.iter().map(|sphere| sphere.centre[2]).fold(0.0, f64::max);
        if self.closed { 100 } else { (depth / 1100.0 / STEP) as u64 }
    }

    fn bulk(&self, law: LawKind, integrator: Integrator, recording: Recording, width: Width) -> Bulk {
        let period = |(axis, length): (usize, Option<f64>)| length.map(|length| Period { axis, length });
        let impact = Impact {
            mirrors: Vec::new(),
            periods: self.periods().into_iter().enumerate().filter_map(period).collect(),
            law,
            constants: Constants::default(),
            pulse: ForcePulse { force: BLOW.0, duration: BLOW.1 },
            slope: 0.0,
            struck: self.struck(),
            faces: Vec::new(),
            moving: Vec::new(),
            projectile: None,
            exit: Vec::new(),
            integrator,
            step: STEP,
            window: 1.0,
        };
        let mut bulk = Bulk::new(&self.sample, &impact, recording, width).expect("a crystal of rows");
        if self.closed {
            bulk.set_velocities(|sphere| self.velocity(sphere));
        }
        bulk
    }

    /// The same as a rig under Hertz's law.
    fn rig(&self) -> Rig<3> {
        let law = Law::Named(LawKind::Hertz);
        let laws = LawBook::Materials { law, constants: Constants::default(), pairs: Vec::new(), friction: None };
        let mut rig = Rig::new(self.sample.clone(), laws);
        rig.periods = self.periods();
        rig.velocity = (0..self.len()).map(|sphere| self.velocity(sphere)).collect();
        if !self.closed {
            let curve = Curve::Square { peak: BLOW.0, start: 0.0, duration: BLOW.1 };
            let bodies = self.struck().into_iter().map(Body::Sphere).collect();
            rig.loads.push(Load { bodies, direction: [0.0, 0.0, 1.0], kind: LoadKind::Force, curve });
        }
        rig
    }

    /// Writes the deck, and the centres after its last step.
    fn export(&self, folder: &Path, steps: u64) {
        let deck = deck(&self.rig(), STEP, steps, steps).expect("a deck");
        let mut bulk = self.bulk(LawKind::Hertz, Integrator::Verlet, Recording::default(), Width::widest());
        bulk.advance(steps, &Context::default()).expect("a calm crystal");
        let mut centres = String::new();
        for (i, sphere) in self.sample.spheres.iter().enumerate() {
            let moved = bulk.displacement(i);
            let at: [f64; 3] = std::array::from_fn(|k| sphere.centre[k] + moved[k]);
            let _ = writeln!(centres, "{:e} {:e} {:e}", at[0], at[1], at[2]);
        }
        std::fs::create_dir_all(folder).expect("a folder");
        for (name, text) in [("crystal.data", deck.data), ("in.crystal", deck.input), ("centres.txt", centres)] {
            std::fs::write(folder.join(name), text).expect("room on the disk");
        }
    }
}

/// Everything on so many threads.
fn on(threads: usize, work: impl FnOnce() + Send) {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads").install(work);
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|argument| argument != "--bench").collect();
    let after =
        |name: &str| arguments.iter().position(|argument| argument == name).and_then(|at| arguments.get(at + 1));
    if let Some(at) = arguments.iter().position(|argument| argument == "--export") {
        let [folder, steps, kind, size] = &arguments[at + 1..at + 5] else { unreachable!("five of them") };
        let number = |text: &String| text.parse::<usize>().expect("a number");
        return Case::new(number(size), Materials::Random, kind == "closed")
            .export(Path::new(folder), number(steps) as u64);
    }
    let most = after("--steps").and_then(|steps| steps.parse().ok()).unwrap_or(u64::MAX);
    let sizes = arguments.iter().enumerate().filter(|(at, _)| *at == 0 || !arguments[at - 1].starts_with("--"));
    let mut sizes: Vec<usize> = sizes.filter_map(|(_, argument)| argument.parse().ok()).collect();
    if sizes.is_empty() {
        sizes = vec![100_000, 1_000_000];
    }
    let (bare, full) = (Recording::default(), Recording { energies: true, arrivals: Arrivals::Speed(0.1) });
    type Row = (&'static str, Materials, bool, LawKind, Integrator, Recording, usize);
    let cases: [Row; 8] = [
        ("crossing", Materials::Random, false, LawKind::Thesis, Integrator::Verlet, bare, 1),
        ("crossing-lens", Materials::Lens, false, LawKind::Thesis, Integrator::Verlet, bare, 1),
        ("crossing-adams", Materials::Lens, false, LawKind::Thesis, Integrator::Adams, bare, 1),
        ("crossing-full", Materials::Lens, false, LawKind::Thesis, Integrator::Verlet, full, 1),
        ("crossing-hertz", Materials::Random, false, LawKind::Hertz, Integrator::Verlet, bare, 1),
        ("closed", Materials::Random, true, LawKind::Thesis, Integrator::Verlet, bare, 1),
        ("closed-lens", Materials::Lens, true, LawKind::Thesis, Integrator::Verlet, bare, 1),
        ("threads", Materials::Lens, false, LawKind::Thesis, Integrator::Verlet, bare, 2),
    ];
    println!(
        "{:>9} {:>15} {:>8} {:>12} {:>12} {:>7} {:>8} {:>9}",
        "spheres", "case", "threads", "M/s of work", "M/s passing", "steps", "reached", "B/sphere"
    );
    let one = after("--case");
    for &size in &sizes {
        for &(name, materials, closed, law, integrator, recording, threads) in &cases {
            if one.is_some_and(|one| one != name) {
                continue;
            }
            let case = Case::new(size, materials, closed);
            let mut bulk = case.bulk(law, integrator, recording, Width::widest());
            let steps = case.steps().min(most);
            let (begun, before) = (Instant::now(), processor_time(Instant::now()));
            on(threads, || bulk.advance(steps, &Context::default()).expect("a calm crystal"));
            let work = 1e-6 * case.len() as f64 * steps as f64;
            println!(
                "{:>9} {name:>15} {threads:>8} {:>12.1} {:>12.1} {steps:>7} {:>8} {:>9.0}",
                case.len(),
                work / (processor_time(begun) - before),
                work / begun.elapsed().as_secs_f64(),
                bulk.reached(),
                bulk.bytes_per_sphere(),
            );
            if recording.energies {
                println!("{:?}, left over {:?} of it", bulk.ledger(), bulk.ledger().residual());
            }
            if let Some(path) = after("--checkpoint") {
                let begun = Instant::now();
                let mut file = BufWriter::new(std::fs::File::create(path).expect("room on the disk"));
                bulk.save(&mut file).expect("room on the disk");
                println!("a checkpoint took {:.1} s", begun.elapsed().as_secs_f64());
            }
        }
    }
    if let Some(bytes) = peak_memory().filter(|_| sizes.len() == 1) {
        println!("peak memory of the process: {:.0} bytes a sphere", bytes / sizes[0] as f64);
    }
}
