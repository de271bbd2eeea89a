//! What is recorded: events as they happen, regions, sampled maxima and losses.

use granulens::contact::{Constants, Pair};
use granulens::dem::rig::Simulation;
use granulens::material::find;

use super::*;

/// A line of `events.csv`; NaN where a cell is empty.
#[derive(Debug)]
struct Line {
    time: f64,
    event: String,
    bodies: [String; 2],
    overlap: f64,
    force: f64,
    speed: f64,
    dissipated: f64,
}

fn events(ran: &Ran) -> Vec<Line> {
    let text = std::fs::read_to_string(ran.folder.path().join("events.csv")).unwrap();
    let line = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        assert_eq!(cells.len(), 9, "{line}");
        let number = |k: usize| cells[k].parse().unwrap_or(f64::NAN);
        Line {
            time: number(0),
            event: cells[1].to_owned(),
            bodies: [cells[2].to_owned(), cells[3].to_owned()],
            overlap: number(4),
            force: number(5),
            speed: number(6),
            dissipated: number(7),
        }
    };
    text.lines().skip(1).map(line).collect()
}

/// Two spheres of 10 mm, of which the first comes at `speed` (m/s).
fn pair(law: &str, speed: f64, rest: &str) -> PreparedRig<1> {
    chain(&format!(
        "{HEAD}[crystal]\npacking = \"chain\"\ndiameter = \"10 mm\"\nlayers = 2\nmaterial = \"440c\"\n[law]\nkind = \"{law}\"\n\
         [[moving]]\nlayers = 1\nvelocity = \"{speed} m/s\"\n[run]\nwindow = \"300 us\"\nstep = \"0.05 us\"\n[record]\n{rest}"
    ))
}

fn steel() -> (Pair, f64) {
    let steel = find("440c", &[]).unwrap();
    (Pair::new([&steel, &steel], [5e-3; 2], Constants::Code), steel.sphere_mass(0.01))
}

/// A collision under Hertz's law, event by event: it lasts 2.943275 δ/v and reaches δ = (5 m* v²/4k)^{2/5}, F = k δ^{3/2}
/// (Johnson 1985, section 11.4). Some 900 steps of it: the greatest overlap is seen within half a step of its moment, (π/900)²/8 =
/// 1.5e-6 of it too low, and Verlet's error is of that order; times are those of steps.
#[test]
fn a_collision_is_told_event_by_event() {
    let ran = Ran::of(&pair(
        "hertz",
        1.0,
        "events = [\"closes\", \"opens\", \"yields\", \"arrives\", \"force-peak\", \"speed-peak\"]\narrivals = [\"0.5 m/s\", \"1 um\", \"1 %\"]\n",
    ));
    let (pair, mass) = steel();
    let k = pair.hertz_coefficient();
    let overlap = (5.0 * 0.5 * mass / (4.0 * k)).powf(0.4);
    let (force, lasts, step) = (k * overlap.powf(1.5), 2.943275 * overlap, 0.05e-6);
    let lines = events(&ran);
    assert!(lines.is_sorted_by(|a, b| a.time <= b.time), "{lines:?}");
    let of = |event: &str| lines.iter().filter(|line| line.event == event).collect::<Vec<_>>();

    let ([closes], [opens]) = (&of("closes")[..], &of("opens")[..]) else { panic!("{lines:?}") };
    assert_eq!(closes.bodies, ["1", "2"]);
    // They touch at the start: closed after the first step, at the speed at which they meet.
    assert!((closes.time / step - 1.0).abs() < 1e-9 && (closes.speed - 1.0).abs() < 1e-3, "{closes:?}");
    assert!((opens.time - lasts).abs() < 2.0 * step, "{opens:?} {lasts}");
    assert!((opens.overlap / overlap - 1.0).abs() < 1e-5 && (opens.force / force - 1.0).abs() < 1e-5, "{opens:?}");
    // One step before it opens all but a trace of the speed is back: (h/t_c)^{5/2} of the energy is still stored.
    assert!((opens.speed + 1.0).abs() < 1e-5, "{opens:?}");
    assert!(of("yields").is_empty());

    // Both spheres feel the contact's force, at half time.
    let peaks = of("force-peak");
    assert_eq!(peaks.iter().map(|peak| peak.bodies[0].as_str()).collect::<Vec<_>>(), ["1", "2"]);
    assert!(peaks.iter().all(|peak| peak.force == opens.force && (peak.time - 0.5 * lasts).abs() < step), "{peaks:?}");
    // The first is fastest at the start; the second keeps its greatest speed, which is no peak.
    let fastest = of("speed-peak");
    assert!(
        matches!(&fastest[..], [one] if one.bodies[0] == "1" && one.speed == 1.0 && one.time == 0.0),
        "{fastest:?}"
    );

    // Arrivals are those of the table of spheres; the relative one is known only there.
    let arrives = of("arrives");
    for column in ["arrival_0.5_m_s_s", "arrival_1e-6_m_s"] {
        for (i, expected) in ran.spheres(column).into_iter().enumerate() {
            let same =
                |line: &&&Line| line.bodies[0] == (i + 1).to_string() && (line.time / expected - 1.0).abs() < 1e-12;
            assert_eq!(arrives.iter().filter(same).count(), 1, "{column}: sphere {} at {expected}: {arrives:?}", i + 1);
        }
    }
    assert_eq!(arrives.len(), 4);
    assert_eq!(ran.summary.events.values().sum::<u64>(), lines.len() as u64);
    assert_eq!(ran.summary.events["arrives"], 4);
}

/// A contact yields where its force passes F_y, and not before: two spheres that meet at v store (2/5) F_y δ_y = ½ m* v² when they
/// are just about to. What is seen is seen within a step: in h the force grows by 1.5 v h/δ_y of itself.
#[test]
fn contacts_yield_at_the_closed_form_speed() {
    let (pair, mass) = steel();
    let regions = pair.regions(1.0);
    let speed = (0.8 * regions.yield_force * regions.yield_overlap / (0.5 * mass)).sqrt();
    let yields = |speed: f64| {
        let ran = Ran::of(&self::pair("consistent", speed, "events = [\"yields\", \"opens\"]\n"));
        let lines = events(&ran);
        let opens = lines.iter().find(|line| line.event == "opens").unwrap().dissipated;
        (lines.into_iter().filter(|line| line.event == "yields").collect::<Vec<_>>(), opens)
    };
    let (none, lost) = yields(0.999 * speed);
    // Elastic: nothing is lost but what trapezoids over some 900 steps miss.
    assert!(none.is_empty() && lost.abs() < 1e-5 * 0.25 * mass * speed * speed, "{none:?} {lost}");
    let (one, lost) = yields(1.5 * speed);
    let [one] = &one[..] else { panic!("{one:?}") };
    let growth = 1.5 * 1.5 * speed * 0.05e-6 / regions.yield_overlap;
    assert!((1.0..1.0 + growth).contains(&(one.force / regions.yield_force)), "{one:?} {}", regions.yield_force);
    assert!(lost > 0.0);
}

/// With `events_of = "chosen"` only what happens to the chosen spheres is written; flats go by their names.
#[test]
fn events_are_those_of_the_chosen_spheres() {
    let lines = |of: &str| {
        events(&Ran::of(&sheet(&format!(
            "{HEAD}[crystal]\npacking = \"square\"\ndiameter = \"6 mm\"\nlayers = 3\nx = [\"0 D\", \"3 D\"]\nmaterial = \"brass\"\n\
             [[flat]]\nname = \"ram\"\nat = \"front\"\nmass = \"10 g\"\nvelocity = \"3 m/s\"\n[run]\nwindow = \"40 us\"\n\
             [record]\ncolumns = 2\nevents = [\"closes\", \"yields\"]\nevents_of = \"{of}\"\n"
        ))))
    };
    let (all, chosen) = (lines("all"), lines("chosen"));
    let spheres = ["2", "6", "10"];
    let expected: Vec<_> =
        all.iter().filter(|line| line.bodies.iter().any(|body| spheres.contains(&body.as_str()))).collect();
    assert_eq!(chosen.len(), expected.len());
    assert!(chosen.len() >= 6 && all.len() == 4 * chosen.len(), "{} {}", chosen.len(), all.len());
    assert!(chosen.iter().any(|line| line.bodies[0] == "ram" && line.event == "closes"));
    // Each contact yields once, after it has closed.
    for line in all.iter().filter(|line| line.event == "yields") {
        assert_eq!(all.iter().filter(|other| other.event == "yields" && other.bodies == line.bodies).count(), 1);
        assert!(
            all.iter().any(|other| other.event == "closes" && other.bodies == line.bodies && other.time <= line.time)
        );
    }
}

/// Regions that fill the crystal share its energies: kinetic and dissipated, those of the ledger, over time; a sphere on a
/// mirror counts half. Sums of some hundred numbers: 1e-12.
#[test]
fn regions_share_the_energies() {
    let region = |name: &str, layers: &str| format!("[[region]]\nname = \"{name}\"\nlayers = {layers}\n");
    let prepared = sheet(&format!(
        "{HEAD}[crystal]\npacking = \"hexagonal\"\ndiameter = \"6 mm\"\nlayers = 8\nx = [\"0 D\", \"5 D\"]\nmaterial = \"brass\"\n\
         [sides]\nx = \"mirror\"\n\
         [[load]]\nkind = \"force\"\nlayers = 1\npulse = \"square\"\npeak = \"3 kN\"\nduration = \"10 us\"\n\
         [run]\nwindow = \"60 us\"\n[record]\nquantities = [\"maxima\", \"dissipated\"]\ncontacts = \"chosen\"\ncolumns = 1\n{}{}",
        region("front", "[1, 3]"),
        region("back", "[4, 8]"),
    ));
    let ran = Ran::of(&prepared);
    let (regions, energies) = (ran.series("regions.csv"), ran.series("energies.csv"));
    for quantity in ["kinetic_J", "dissipated_J"] {
        let whole = energies.column(quantity);
        let largest = whole.iter().copied().fold(0.0, f64::max);
        for (k, whole) in whole.iter().enumerate() {
            let sum = regions.column(&format!("front_{quantity}"))[k] + regions.column(&format!("back_{quantity}"))[k];
            assert!((sum - whole).abs() < 1e-12 * largest, "{quantity} {k}: {sum} {whole}");
        }
    }
    // The mean of greatest kinetic energies is that of the table of spheres, and the last samples of maxima are its maxima.
    let finals = ran.series("regions-final.csv");
    let (layer, kinetic) = (ran.spheres("layer"), ran.spheres("max_kinetic_J"));
    let front: Vec<f64> = (0..layer.len()).filter(|&i| layer[i] <= 3.0).map(|i| kinetic[i]).collect();
    let mean = front.iter().sum::<f64>() / front.len() as f64;
    assert!((finals.column("mean_max_kinetic_J")[0] / mean - 1.0).abs() < 1e-12);
    let series = ran.series("spheres.csv");
    for (k, sphere) in series.column("sphere").iter().enumerate().rev().take(8) {
        let i = *sphere as usize - 1;
        for column in ["max_speed_m_s", "max_force_N", "dissipated_J"] {
            assert_eq!(series.column(column)[k], ran.spheres(column)[i], "{column} of sphere {sphere}");
        }
    }
    // Contacts of the chosen spheres only.
    let contacts = ran.series("contacts.csv");
    let chosen: Vec<f64> =
        (0..layer.len()).filter(|&i| prepared.sites[i].column == 1).map(|i| (i + 1) as f64).collect();
    assert!(contacts.column("a").len() > 20);
    for (a, b) in contacts.column("a").iter().zip(contacts.column("b")) {
        assert!(chosen.contains(a) || chosen.contains(b), "{a} {b}");
    }
}

/// A sheet that a heavy flat falls on and shears, with all records.
const TABLES: &str = r#"
format = 1
kind = "rig"
name = "tables"
[crystal]
packing = "hexagonal"
diameter = "6 mm"
layers = 6
x = ["0 D", "5 D"]
material = "brass"
[law]
kind = "thesis"
[friction]
coefficient = 0.3
spring = "mindlin"
[gravity]
acceleration = "9.81 m/s2"
[[flat]]
name = "ram"
point = ["0 m", "-3 mm"]
normal = [0.0, 1.0]
mass = "0.1 kg"
velocity = ["2 m/s", "8 m/s"]
[run]
window = "60 us"
step = "0.1 us"
[record]
quantities = ["position", "displacement", "velocity", "force", "dissipated"]
contacts = "all"
"#;

/// Tables hold what the state is, column by column: a run beside, to the same bits, whose contacts, spheres and energies are looked at by name.
#[test]
fn columns_hold_the_state_of_their_name() {
    let Ok(Setup::Two(prepared)) = Setup::parse(shipped("rig.toml"), TABLES) else { panic!() };
    let ran = Ran::of(&prepared);
    let mut simulation = Simulation::new(prepared.rig.clone(), prepared.plan.step).unwrap();
    simulation.advance(prepared.plan.steps(), &Context::default()).unwrap();
    let (view, ledger) = (simulation.view(), simulation.ledger());
    let contacts = ran.series("contacts.csv");
    let end = *contacts.column("time_s").last().unwrap();
    let first = contacts.column("time_s").iter().position(|&time| time == end).unwrap();
    let touching: Vec<_> = view.contacts().collect();
    assert!(touching.len() > 10 && contacts.column("time_s").len() - first == touching.len());
    for (row, contact) in touching.iter().enumerate() {
        for (column, value) in [
            ("nx", contact.normal[0]),
            ("nz", contact.normal[1]),
            ("overlap_m", contact.overlap),
            ("closing_m_s", contact.closing_speed),
            ("force_N", contact.force),
            ("tangential_N", contact.tangential),
            ("overlap_max_m", contact.overlap_max),
            ("force_max_N", contact.force_max),
            ("stored_J", contact.stored),
            ("dissipated_J", contact.dissipated),
        ] {
            assert_eq!(contacts.column(column)[first + row], value, "{column} of contact {row}");
        }
    }
    let spheres = ran.series("spheres.csv");
    let count = prepared.rig.mass.len();
    let last = spheres.column("time_s").len() - count;
    for i in 0..count {
        for (column, value) in [
            ("sphere", (i + 1) as f64),
            ("x_m", view.position(i)[0]),
            ("z_m", view.position(i)[1]),
            ("ux_m", view.displacement(i)[0]),
            ("uz_m", view.displacement(i)[1]),
            ("vx_m_s", view.velocity(i)[0]),
            ("vz_m_s", view.velocity(i)[1]),
            ("Fx_N", view.net_force(i)[0]),
            ("Fz_N", view.net_force(i)[1]),
            ("dissipated_J", simulation.dissipated()[i]),
        ] {
            assert_eq!(spheres.column(column)[last + i], value, "{column} of sphere {}", i + 1);
        }
    }
    let energies = ran.series("energies.csv");
    for (column, value) in [
        ("work_in_J", ledger.work_in),
        ("kinetic_J", ledger.kinetic),
        ("stored_J", ledger.stored),
        ("tangential_stored_J", ledger.tangential_stored),
        ("potential_J", ledger.potential),
        ("dissipated_J", ledger.dissipated),
        ("friction_J", ledger.friction),
        ("absorbed_J", ledger.absorbed),
    ] {
        assert_eq!(*energies.column(column).last().unwrap(), value, "{column}");
    }
    let flats = ran.series("flats.csv");
    for (column, value) in [("ram_moved_m", view.flat(0).moved[1]), ("ram_velocity_m_s", view.flat(0).velocity[1])] {
        assert_eq!(*flats.column(column).last().unwrap(), value, "{column}");
    }
    // What is drawn is in the unit that stands beside it: the highest number on the axis is a round one below the greatest force.
    granulens::report::draw_run(ran.folder.path()).unwrap();
    let drawn = std::fs::read_to_string(ran.folder.path().join("flats.svg")).unwrap();
    let greatest = 1e-3 * flats.column("ram_force_N").iter().copied().fold(0.0, f64::max);
    let numbers = drawn.split("</text>").filter_map(|part| part.rsplit('>').next()?.parse::<f64>().ok());
    let along_y: Vec<f64> =
        numbers.scan(f64::NEG_INFINITY, |last, x| (x > std::mem::replace(last, x)).then_some(x)).collect();
    let top = along_y.last().unwrap();
    assert!(drawn.contains("force (kN)") && *top > 0.5 * greatest && *top < 1.06 * greatest, "{along_y:?} {greatest}");
}
