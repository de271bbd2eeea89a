//! The step that is chosen: it passes its own guard, and what it gives is as accurate as is said.

use granulens::contact::{Constants, Dashpot, LawKind, Pair};
use granulens::dem::rig::{Loss, Rig, RigStop, Simulation, SpringDashpot};
use granulens::dem::{MoveIn, Spheres};
use granulens::material::find;
use rayon::prelude::*;

use super::*;

/// A case from the field, run as it is.
fn case(name: &str) -> Ran {
    let text = std::fs::read_to_string(shipped(&format!("tests/data/cases/{name}.toml"))).unwrap();
    match Setup::parse(format!("{name}.toml"), &text).unwrap() {
        Setup::One(prepared) => Ran::of(&prepared),
        Setup::Two(prepared) => Ran::of(&prepared),
        Setup::Three(prepared) => Ran::of(&prepared),
    }
}

/// The last value of a column.
fn last(ran: &Ran, file: &str, column: &str) -> f64 {
    *ran.series(file).column(column).last().unwrap()
}

/// Events of a kind: time, and the value of a column.
fn events(ran: &Ran, kind: &str, column: usize) -> Vec<[f64; 2]> {
    let text = std::fs::read_to_string(ran.folder.path().join("events.csv")).unwrap();
    let rows = text.lines().map(|line| line.split(',').collect::<Vec<_>>()).filter(|row| row[1] == kind);
    rows.map(|row| [row[0].parse().unwrap(), row[column].parse().unwrap()]).collect()
}

/// What a blow is measured by.
#[derive(Clone, Copy, Debug)]
struct Collision {
    peak: f64,
    /// From the touch until the surfaces, moving on as at the end, would part.
    lasts: f64,
}

/// Follows a blow of two spheres, or of one and a flat, that touch after `free` (s).
fn blow<const D: usize>(rig: Rig<D>, step: f64, steps: u64, free: f64) -> Result<Collision, RigStop>
where
    Spheres: MoveIn<D>,
{
    let mut simulation = Simulation::new(rig, step).unwrap();
    let mut peak = 0.0_f64;
    // Every law of a file remembers its greatest force, though the contact may open between two looks.
    simulation.follow(steps, &Context::default(), |view| {
        view.contacts().for_each(|contact| peak = peak.max(contact.force_max));
    })?;
    let (view, rig) = (simulation.view(), simulation.rig());
    let (apart, speed) = match rig.flats.first() {
        Some(flat) => {
            let normal = flat.normal;
            let along = |v: [f64; D]| (0..D).map(|k| v[k] * normal[k]).sum::<f64>();
            (flat.distance(&[0.0; D], &view.position(0)).0 - rig.sample.spheres[0].radius, along(view.velocity(0)))
        }
        None => {
            let (a, b) = (view.position(0), view.position(1));
            let between: [f64; D] = std::array::from_fn(|k| b[k] - a[k]);
            let distance = between.iter().map(|x| x * x).sum::<f64>().sqrt();
            let (u, v) = (view.velocity(0), view.velocity(1));
            let speed = (0..D).map(|k| (v[k] - u[k]) * between[k]).sum::<f64>() / distance;
            (distance - rig.sample.spheres[0].radius - rig.sample.spheres[1].radius, speed)
        }
    };
    Ok(Collision { peak, lasts: simulation.time() - apart / speed - free })
}

/// One of the three hundred.
#[derive(Clone, Copy, Debug)]
struct Trial {
    law: &'static str,
    metals: [&'static str; 2],
    /// Closing speed along the normal (m/s).
    speed: f64,
    place: Place,
    /// Accuracy class.
    class: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Place {
    HeadOn,
    Oblique,
    Flat,
}

/// All that a file can name but the four published laws, which have a test of their own: their force ends with a jump after a blow below yield.
fn laws() -> Vec<&'static str> {
    let named = LawKind::ALL.iter().filter(|law| !law.makes_energy()).map(|law| law.name());
    named.chain([SpringDashpot::NAME]).collect()
}

const METALS: [[&str; 2]; 7] =
    [["440c", "440c"], ["brass", "brass"], ["440c", "brass"], ["al", "al"], ["302", "302"], ["wc", "wc"], ["wc", "al"]];
/// Of both spheres (m).
const DIAMETER: f64 = 0.02;
const STIFFNESS: f64 = 2e7;

/// The four published laws.
fn published() -> Vec<&'static str> {
    LawKind::ALL.iter().filter(|law| law.makes_energy()).map(|law| law.name()).collect()
}

fn trials(laws: &[&'static str]) -> Vec<Trial> {
    let trial = |n: usize| {
        // Every law in every place, with either class.
        let round = n / laws.len();
        let place = [Place::HeadOn, Place::Oblique, Place::Flat][round % 3];
        let metals = METALS[(n + round) % 7];
        Trial {
            law: laws[n % laws.len()],
            metals: if place == Place::Flat { [metals[0]; 2] } else { metals },
            // Evenly over the logarithm, by the golden ratio.
            speed: 0.01 * 3000_f64.powf((n as f64 * 0.618_033_988_749_895).fract()),
            place,
            class: if round.is_multiple_of(5) { 1e-2 } else { 1e-3 },
        }
    };
    (0..300).map(trial).collect()
}

impl Trial {
    fn restitution(&self) -> f64 {
        0.2 + 0.8 * (self.speed * 7.0).fract()
    }

    fn masses(&self) -> [f64; 2] {
        self.metals.map(|name| find(name, &[]).unwrap().sphere_mass(DIAMETER))
    }

    /// Of the two spheres; a flat is an equal sphere that comes from the other side.
    fn reduced(&self) -> f64 {
        let [a, b] = self.masses();
        a * b / (a + b)
    }

    /// Peak force and duration under Hertz's law (Johnson 1985, section 11.4).
    fn hertz(&self) -> Collision {
        let [a, b] = self.metals.map(|name| find(name, &[]).unwrap());
        let k = Pair::new([&a, &b], [0.5 * DIAMETER; 2], Constants::Code).hertz_coefficient();
        let overlap = (5.0 * self.reduced() * self.speed * self.speed / (4.0 * k)).powf(0.4);
        Collision { peak: k * overlap.powf(1.5), lasts: 2.943_275_2 * overlap / self.speed }
    }

    /// Peak force and duration of δ″ + 2β δ′ + ω₀² δ = 0 until the force ends; then the surfaces part at the speed they have.
    fn damped(&self) -> Collision {
        let mass = self.reduced();
        let law = Dashpot::with_restitution(STIFFNESS, mass, self.restitution(), true);
        let (natural, beta) = ((STIFFNESS / mass).sqrt(), 0.5 * law.damping / mass);
        assert!(beta < natural, "underdamped: restitution above e^-2");
        let omega = (natural * natural - beta * beta).sqrt();
        let at = |t: f64| {
            let (sin, cos) = (omega * t).sin_cos();
            let decay = self.speed * (-beta * t).exp();
            let (overlap, speed) = (decay * sin / omega, decay * (cos - beta / omega * sin));
            (overlap, speed, STIFFNESS * overlap + law.damping * speed)
        };
        let end = (std::f64::consts::PI - (2.0 * beta * omega).atan2(omega * omega - beta * beta)) / omega;
        let peak = (0..=100_000).map(|k| at(end * f64::from(k) / 1e5).2).fold(0.0, f64::max);
        let (overlap, speed, _) = at(end);
        Collision { peak, lasts: end - overlap / speed }
    }

    /// The file of a lab that gives no step, and the time until the touch.
    fn text(&self) -> (String, f64) {
        let Self { law, metals: [a, b], speed, place, class } = *self;
        // They come from as far as they go in a blow under Hertz's law, which none outlasts by ten times.
        let lasts = if law == "spring-dashpot" { self.damped().lasts } else { self.hertz().lasts };
        let free = 0.731 * lasts;
        let gap = speed * free;
        let law = match law {
            "spring-dashpot" => {
                format!("kind = \"{law}\"\nstiffness = \"{STIFFNESS} N/m\"\nrestitution = {}\n", self.restitution())
            }
            _ => format!("kind = \"{law}\"\n"),
        };
        let run = format!("[run]\nwindow = \"{} s\"\naccuracy = \"{} %\"\n", 12.0 * lasts, class * 100.0);
        let pattern = format!("[[pattern]]\nkind = \"layers\"\nmaterials = [\"{a}\", \"{b}\"]\n");
        let head = |packing: &str, layers: u32, more: &str| {
            format!(
                "{HEAD}[crystal]\npacking = \"{packing}\"\ndiameter = \"{DIAMETER} m\"\nlayers = {layers}\n\
                 material = \"{a}\"\n{more}[law]\n{law}{run}"
            )
        };
        let moving = |speed: f64| format!("[[moving]]\nlayers = 1\nvelocity = \"{speed} m/s\"\n");
        let text = match place {
            Place::HeadOn => {
                head("chain", 2, "")
                    + &format!("{pattern}[[edit]]\nlayers = 2\nmove = [\"{gap} m\"]\n{}", moving(speed))
            }
            // A flat stands for a sphere that comes as fast from the other side, as far away.
            Place::Flat => {
                head("chain", 1, "")
                    + &format!(
                        "[[flat]]\nname = \"plane\"\npoint = [\"{} m\"]\nnormal = [-1]\n{}",
                        0.5 * DIAMETER + 0.5 * gap,
                        moving(0.5 * speed)
                    )
            }
            // Half a diameter aside: the normal lies 30 degrees off the way, which is then longer.
            Place::Oblique => {
                let cosine = 0.75_f64.sqrt();
                let apart = DIAMETER * cosine + gap / cosine;
                head("square", 2, "x = [\"0 D\", \"0 D\"]\n")
                    + &format!(
                        "{pattern}[[edit]]\nlayers = 2\nmove = [\"{} m\", \"{} m\"]\n{}",
                        0.5 * DIAMETER,
                        apart - DIAMETER,
                        moving(speed / cosine)
                    )
            }
        };
        (text, free)
    }

    /// What the chosen step gives, what is right, and how that is known.
    ///
    /// `residual` is the part of the energy that the ledger may miss, where it is not the rig's own.
    fn measure(&self, residual: Option<f64>) -> (Result<Collision, RigStop>, Collision) {
        let (text, free) = self.text();
        fn both<const D: usize>(
            prepared: &PreparedRig<D>,
            free: f64,
            residual: Option<f64>,
        ) -> (Result<Collision, RigStop>, Collision)
        where
            Spheres: MoveIn<D>,
        {
            let (step, steps) = (prepared.plan.step, prepared.plan.steps());
            let mut rig = prepared.rig.clone();
            rig.residual_limit = residual.unwrap_or(rig.residual_limit);
            let tenth = Rig { resolution: None, ..rig.clone() };
            let finer = blow(tenth, 0.1 * step, 10 * steps, free);
            (blow(rig, step, steps, free), finer.unwrap_or(Collision { peak: f64::NAN, lasts: f64::NAN }))
        }
        let (found, finer) = match Setup::parse("blow.toml", &text).unwrap() {
            Setup::One(prepared) => both(&prepared, free, residual),
            Setup::Two(prepared) => both(&prepared, free, residual),
            Setup::Three(_) => unreachable!(),
        };
        // In an oblique blow the normal turns as the spheres pass.
        let right = match (self.law, self.place) {
            (_, Place::Oblique) => finer,
            ("hertz", _) => self.hertz(),
            ("spring-dashpot", _) => self.damped(),
            _ => finer,
        };
        (found, right)
    }
}

/// Three hundred blows over laws, metals, 0.01 to 30 m/s, head-on, oblique and on flats, with the step that is chosen: no guard stops one, and
/// peak force and duration are those of the closed form, or of a tenth of the step, within the accuracy class.
#[test]
fn three_hundred_blows_hold_their_class() {
    let found: Vec<_> = trials(&laws()).into_par_iter().map(|trial| (trial, trial.measure(None))).collect();
    let mut wrong = Vec::new();
    for (trial, (found, right)) in &found {
        let Ok(found) = found else {
            wrong.push(format!("{trial:?}: {found:?}"));
            continue;
        };
        let errors = [found.peak / right.peak - 1.0, found.lasts / right.lasts - 1.0];
        if !errors.iter().all(|error| error.abs() <= trial.class) {
            wrong.push(format!("{trial:?}: peak {:+.2e}, duration {:+.2e}", errors[0], errors[1]));
        }
    }
    assert!(wrong.is_empty(), "{} of {}:\n{}", wrong.len(), found.len(), wrong.join("\n"));
}

/// As many blows under the four published laws. From three times the yield force on they hold their class as all laws do. In gentler blows the force jumps where unloading begins
/// and where the contact ends, since the overlap at which it would be zero is below zero: at which moment of a step that comes is not seen, so that balance, duration and peak are off
/// by up to a step's part of the blow, to first order in ω h, whatever the scheme; the guard of the balance may stop a run for that, and no other guard does.
#[test]
fn blows_under_the_published_laws_hold_their_class_but_for_the_jump_at_their_end() {
    let found: Vec<_> = trials(&published()).into_par_iter().map(|trial| (trial, trial.measure(Some(1.0)))).collect();
    let (mut wrong, mut below) = (Vec::new(), 0);
    for (trial, (found, right)) in &found {
        let Ok(found) = found else {
            wrong.push(format!("{trial:?}: {found:?}"));
            continue;
        };
        let [a, b] = trial.metals.map(|name| find(name, &[]).unwrap());
        let pair = Pair::new([&a, &b], [0.5 * DIAMETER; 2], Constants::Code);
        let is_gentle = right.peak < 3.0 * pair.regions(1.0).yield_force;
        below += usize::from(is_gentle);
        // The class asks for ω h; a contact's duration is 2.9 times its 1/ω or more.
        let first_order = if trial.class > 5e-3 { 0.25 } else { 0.08 };
        let most = if is_gentle { first_order } else { trial.class };
        let errors = [found.peak / right.peak - 1.0, found.lasts / right.lasts - 1.0];
        if errors.iter().any(|error| error.is_nan() || error.abs() > most) {
            wrong.push(format!("{trial:?}, gentle {is_gentle}: peak {:+.2e}, duration {:+.2e}", errors[0], errors[1]));
        }
    }
    assert!((10..290).contains(&below), "{below} gentle blows");
    assert!(wrong.is_empty(), "{} of {}, {below} of them gentle:\n{}", wrong.len(), found.len(), wrong.join("\n"));
    // With the guard as it is nothing but the balance stops a blow, missed by the first order of a step.
    for (trial, (found, _)) in
        trials(&published()).into_par_iter().map(|trial| (trial, trial.measure(None))).collect::<Vec<_>>()
    {
        let misses = match &found {
            Ok(_) => 0.0,
            Err(RigStop::Residual { residual, .. }) => residual.abs(),
            Err(other) => panic!("{trial:?}: {other}"),
        };
        assert!(misses < if trial.class > 5e-3 { 0.25 } else { 0.08 }, "{trial:?}: {found:?}");
    }
}

/// Chung and Ooi (2011), tests 1 and 2: 10.697 kN, 274.1 um, 40.3 us of two glass balls at 10 m/s each; 11.370 kN, 731.7 us of an aluminium
/// ball of 0.1 m on a plane.
#[test]
fn published_blows_come_out_with_the_chosen_step() {
    for (name, force, overlap, lasts, class) in [
        ("pair", 10.697e3, Some(274.1e-6), 40.3e-6, 1e-3),
        ("pair-1pc", 10.697e3, Some(274.1e-6), 40.3e-6, 1e-2),
        ("plane", 11.370e3, None, 731.7e-6, 1e-3),
    ] {
        let ran = case(&format!("03-own-guard/{name}"));
        assert_eq!(ran.ending, Ending::Complete, "{name}");
        let peak = events(&ran, "force-peak", 5)[0][1];
        assert!((peak / force - 1.0).abs() < class, "{name}: {peak}");
        let [closed, opened] = ["closes", "opens"].map(|kind| events(&ran, kind, 4)[0]);
        if let Some(overlap) = overlap {
            assert!((opened[1] / overlap - 1.0).abs() < class, "{name}: {}", opened[1]);
        }
        // An event is seen at the end of its step.
        let found = opened[0] - closed[0];
        assert!((found - lasts).abs() < ran.summary.method.step_s + class * lasts, "{name}: {found}");
    }
    let push = case("03-own-guard/push");
    assert_eq!(push.ending, Ending::Complete);
    // 10 N take the ball across 1 mm in √(2 s m/F).
    let exact = (2.0 * 1e-3 * find("440c", &[]).unwrap().sphere_mass(0.01) / 10.0).sqrt();
    let touch = events(&push, "closes", 4)[0][0];
    assert!((touch - exact).abs() < 1.01 * push.summary.method.step_s, "{touch} {exact}");
}

/// A ball falls 0.3 m freely: it touches at √(2·0.4/9.81) = 0.28557 s with 2.8014 m/s, and leaves as fast; one rolls down an incline of 30
/// degrees with (5/7) g sin 30° = 3.5036 m/s².
#[test]
fn a_fall_is_foreseen() {
    for name in ["fall", "fall-fine"] {
        let ran = case(&format!("04-falling-ball/{name}"));
        assert_eq!(ran.ending, Ending::Complete, "{name}");
        let touch = events(&ran, "closes", 6)[0];
        let exact = (2.0 * 0.4 / 9.81_f64).sqrt();
        assert!((touch[0] - exact).abs() < ran.summary.method.step_s + 1e-6, "{name}: {}", touch[0]);
        let leaves = ran.series("spheres.csv");
        // At the end of the window it is on its way up and down again: energy tells the speed with which it left.
        let (height, speed) = (leaves.column("uz_m"), leaves.column("vz_m_s"));
        let (height, speed) = (height.last().unwrap(), speed.last().unwrap());
        let left = (speed * speed + 2.0 * 9.81 * (0.4 - height)).sqrt();
        assert!((left / 2.8014 - 1.0).abs() < 1e-3, "{name}: {left}");
    }
    let ran = case("04-falling-ball/incline");
    assert_eq!(ran.ending, Ending::Complete);
    let speed = last(&ran, "spheres.csv", "vx_m_s");
    assert!((speed / 0.3504 - 1.0).abs() < 2e-3, "{speed}");
}

/// A ball that lies on a floor under the published law rebounds ever faster; the run says so, which law does it, and what to take. Under the
/// consistent one no rebound is faster than the one before, but for rounding, and nothing is said.
#[test]
fn a_law_that_makes_energy_says_so() {
    for name in ["rest", "rest-auto"] {
        let ran = case(&format!("05-resting-ball/{name}"));
        let told = ran
            .summary
            .warnings
            .iter()
            .find(|words| words.contains("gave back"))
            .unwrap_or_else(|| panic!("{name}: {:?} {:?}", ran.summary.warnings, ran.summary.energies));
        assert!(told.contains("\"thesis\"") && told.contains('%') && told.contains("\"consistent\""), "{told}");
        assert_eq!(ran.summary.gains[0].law, "thesis");
    }
    let ran = case("05-resting-ball/rest-consistent");
    assert_eq!(ran.ending, Ending::Complete);
    assert!(!ran.summary.warnings.iter().any(|words| words.contains("gave back")), "{:?}", ran.summary.warnings);
    let rebounds: Vec<f64> = events(&ran, "opens", 6).into_iter().map(|[_, speed]| -speed).collect();
    let most = rebounds.iter().copied().fold(0.0, f64::max);
    assert!(most <= rebounds.first().copied().unwrap_or(0.0) * (1.0 + 1e-3), "{rebounds:?}");
}

/// Restitution is of each pair, from its own masses and stiffness, to 0.1 % at the step that is chosen and at the one that is given, for
/// forces that are cut at zero and such that pull.
#[test]
fn restitution_is_that_of_each_pair() {
    for (name, e) in [
        ("auto-0.2", 0.2),
        ("fine-0.2", 0.2),
        ("auto-0.5", 0.5),
        ("auto-1", 1.0),
        ("heavy", 0.5),
        ("half-size", 0.5),
        ("double-size", 0.5),
        ("unequal", 0.5),
    ] {
        let ran = case(&format!("06-restitution/{name}"));
        assert_eq!(ran.ending, Ending::Complete, "{name}");
        let velocities = ran.series("spheres.csv");
        let [.., a, b] = velocities.column("vz_m_s") else { panic!("no velocities") };
        assert!(((b - a) / e - 1.0).abs() < 1e-3, "{name}: {}", b - a);
    }
    let plane = last(&case("06-restitution/plane"), "spheres.csv", "vz_m_s");
    assert!((-plane / 0.5 - 1.0).abs() < 1e-3, "{plane}");
    // With the chosen step, over the range of restitutions.
    for pull in [false, true] {
        for e in [0.05, 0.1, 0.3, 0.7, 0.9, 1.0] {
            for gap in ["0.13 um", "0.31 um", "0.59 um", "0.87 um"] {
                let prepared = chain(&format!(
                    "{HEAD}[crystal]\npacking = \"chain\"\ndiameter = \"10 mm\"\nlayers = 2\nmaterial = \"440c\"\n\
                     [[pattern]]\nkind = \"layers\"\nmaterials = [\"440c\", \"al\"]\ndiameters = [\"10 mm\", \"7 mm\"]\n\
                     [law]\nkind = \"spring-dashpot\"\nstiffness = \"1 MN/m\"\nrestitution = {e}\npull = {pull}\n\
                     [[edit]]\nlayers = 2\nmove = [\"{gap}\"]\n\
                     [[moving]]\nlayers = 1\nvelocity = \"1 m/s\"\n[run]\nwindow = \"2 ms\"\n"
                ));
                let mut simulation = Simulation::new(prepared.rig, prepared.plan.step).unwrap();
                simulation.advance(prepared.plan.steps(), &Context::default()).unwrap();
                let found = simulation.view().velocity(1)[0] - simulation.view().velocity(0)[0];
                assert!((found / e - 1.0).abs() < 1e-3, "e {e}, pull {pull}, gap {gap}: {found}");
            }
        }
    }
    // η is a number of the restitution alone.
    assert_eq!(Loss::with_restitution(1.0, true), Loss::Ratio(0.0));
}

/// A heavy piston crushes a light ball against a wall, which presses far harder than any blow of the ball's own mass: the run begins again with
/// half the step, says so, and ends where a run with that step given does, to the bit, and with the same bytes where it was interrupted.
#[test]
fn what_was_not_foreseen_is_run_again_with_half_the_step() {
    let text = |step: &str| {
        format!(
            "{HEAD}[crystal]\npacking = \"chain\"\ndiameter = \"10 mm\"\nlayers = 1\nmaterial = \"440c\"\n\
             [law]\nkind = \"hertz\"\n[sides]\nz = [\"free\", \"wall\"]\n\
             [[flat]]\nname = \"piston\"\nat = \"front\"\nmass = \"300 kg\"\nvelocity = \"1 m/s\"\n\
             [run]\nwindow = \"2 ms\"\n{step}[record]\nevery = \"20 us\"\n"
        )
    };
    let ran = Ran::of(&chain(&text("")));
    assert_eq!(ran.ending, Ending::Complete);
    let prepared = chain(&text(""));
    let times = prepared.plan.step / ran.summary.method.step_s;
    assert!(times >= 2.0 && times.log2().fract() == 0.0, "{times}");
    assert!(ran.summary.method.step_reason.contains("begun again"), "{}", ran.summary.method.step_reason);
    let given = Ran::of(&chain(&text(&format!("step = \"{:?} s\"\n", ran.summary.method.step_s))));
    assert_eq!(given.ending, Ending::Complete);
    let read = |ran: &Ran, name: &str| std::fs::read_to_string(ran.folder.path().join(name)).unwrap();
    for file in ["energies.csv", "flats.csv", "spheres.csv"] {
        // Samples lie at whole steps of another length; the last one at the window's end.
        assert_eq!(read(&ran, file).lines().last(), read(&given, file).lines().last(), "{file}");
    }
    // Interrupted after the run has begun again, and taken up.
    let folder = tempfile::tempdir().unwrap();
    let keeping = |resume| Keeping { resume, every: Duration::ZERO };
    let total = prepared.plan.steps();
    let (_, ending) =
        run::run(&prepared, folder.path(), keeping(false), &until(move |done, of| of > total && done > of / 3))
            .unwrap();
    assert!(matches!(ending, Ending::Interrupted { .. }), "{ending:?}");
    let (summary, ending) = run::run(&prepared, folder.path(), keeping(true), &Context::default()).unwrap();
    assert_eq!((ending, summary.method.step_s), (Ending::Complete, ran.summary.method.step_s));
    for file in ["energies.csv", "flats.csv", "spheres.csv"] {
        assert!(read(&ran, file) == std::fs::read_to_string(folder.path().join(file)).unwrap(), "{file}");
    }
}
