//! What layouts are judged by: impacts at an angle and off the axis, crystals that are not built as drawn, and measures
//! beyond energies.

use granulens::Context;
use granulens::contact::LawKind;
use granulens::dem::{ForcePulse, Stop};
use granulens::design::{AnyDesign, Design};
use granulens::evaluate::{
    Detail, Evaluated, Evaluator, ImpactLoad, Imperfection, LoadCase, Overrides, Plan, evaluate,
};
use granulens::layout::Layout;
use granulens::score::{Measure, Needs, Scores};
use granulens::study::{Ended, Study};

use crate::{Desk, STUDY};

const PULSE: ForcePulse = ForcePulse { force: 16e3, duration: 20e-6 };

/// Scores of one layout of the tiny crystal in some cases, with all that can be recorded if `detail`.
fn scores(study: &Study, layout: &[u8], cases: &[LoadCase], detail: Detail) -> Vec<Scores> {
    let never = Context::default();
    let evaluator = Evaluator::new(&study.design, cases, study.palette.clone(), study.overrides(0), &never).unwrap();
    let runs = evaluator.recording(detail).scores(&[layout.to_vec()], &never).unwrap().remove(0);
    assert!(runs.iter().all(|run: &Evaluated| run.stop.is_none()));
    runs.into_iter().map(|run| run.scores).collect()
}

/// A layout in which nothing is alike by chance.
fn layout(study: &Study) -> Vec<u8> {
    study.materials(&[0, 1, 1, 0, 1, 0, 0, 1, 0, 1, 1, 1])
}

fn assert_alike(a: &Scores, b: &Scores, tolerance: f64) {
    for &measure in Measure::ALL.iter().filter(|measure| measure.needs() != Needs::Layout) {
        // The residual is rounding.
        let values = [a, b].map(|scores| scores.get(measure));
        let [Some(a), Some(b)] = values else {
            assert_eq!(values, [None, None], "{}", measure.name());
            continue;
        };
        assert!(
            (a - b).abs() <= tolerance * a.abs() || measure == Measure::Residual,
            "{}: {a} and {b}",
            measure.name()
        );
    }
}

/// The whole crystal between its walls, struck on all of row 1, is its half between mirrors: the same but for rounding, which
/// grows in contacts that open and close.
#[test]
fn both_halves_under_a_straight_blow_are_one_half() {
    let desk = Desk::new(STUDY);
    let study = desk.study();
    let straight = ImpactLoad::from(PULSE);
    let whole = ImpactLoad { place: Some([-1.0, 1.0]), ..straight };
    assert!(straight.is_symmetric() && !whole.is_symmetric());
    let of = scores(&study, &layout(&study), &[straight.into(), whole.into()], Detail::Everything);
    assert_alike(&of[0], &of[1], 1e-9);
    // Without full records the energies are the same bits.
    let energies = scores(&study, &layout(&study), &[straight.into(), whole.into()], Detail::Energies);
    for (one, two) in of.iter().zip(&energies) {
        for &measure in Measure::ALL.iter().filter(|measure| measure.needs() == Needs::Energies) {
            assert_eq!(one.get(measure), two.get(measure), "{}", measure.name());
        }
    }
}

/// Layouts are symmetric, so that a blow from the left does what its mirror image from the right does; a straight one does
/// something else.
#[test]
fn blows_from_left_and_right_are_alike() {
    let desk = Desk::new(STUDY);
    let study = desk.study();
    let straight = ImpactLoad::from(PULSE);
    let at = |angle: f64| ImpactLoad { angle, ..straight }.into();
    let off = |from: f64, to: f64| ImpactLoad { place: Some([from * 6.35e-3, to * 6.35e-3]), ..straight }.into();
    let cases = [straight.into(), at(0.35), at(-0.35), off(0.0, 2.0), off(-2.0, 0.0)];
    let of = scores(&study, &layout(&study), &cases, Detail::Everything);
    assert_alike(&of[1], &of[2], 1e-9);
    assert_alike(&of[3], &of[4], 1e-9);
    for other in [&of[1], &of[3]] {
        assert!((other.contrast.unwrap() / of[0].contrast.unwrap() - 1.0).abs() > 1e-3, "{other:?} {:?}", of[0]);
    }
}

/// Against the ledger and the contacts of the same run by itself.
#[test]
fn what_is_felt_is_what_the_records_say() {
    let desk = Desk::new(STUDY);
    let study = desk.study();
    let (design, palette) = (study.design.plane().unwrap(), study.palette.clone());
    let drawn = Layout { lattice: design.lattice.clone(), palette, materials: study.materials(&[1; 12]) };
    let felt = scores(&study, &drawn.materials, &[PULSE.into()], Detail::Everything).remove(0);
    let dissipation = felt.dissipation.unwrap();
    let plan = Plan::new(design, study.overrides(0), &study.palette).unwrap();
    let record = evaluate(design, &drawn, &plan, &Context::default()).unwrap().record;
    assert!((dissipation - record.ledger.dissipated / record.ledger.work_in).abs() < 1e-15);
    assert!(dissipation > 0.5 && dissipation < 1.0);
    let sites = design.target.protect.sites(&design.lattice);
    let of_region = record.contacts.iter().filter(|contact| contact.spheres.iter().any(|i| sites.contains(i)));
    let greatest = of_region.map(|contact| contact.force_max).fold(0.0, f64::max);
    assert_eq!(felt.protected_force, Some(greatest));
    let momentum: f64 = sites
        .iter()
        .map(|&i| {
            let mass = study.palette[usize::from(drawn.materials[i])].sphere_mass(6.35e-3);
            // p = m v with v from the greatest energy.
            mass * (2.0 * record.max_kinetic[i] / mass).sqrt()
        })
        .sum();
    assert!((felt.protected_momentum.unwrap() / (momentum / sites.len() as f64) - 1.0).abs() < 1e-12);
    assert_eq!(felt.protected_arrival, sites.iter().filter_map(|&i| record.arrival[i]).reduce(f64::min));
}

/// A crystal with a wrong sphere is the crystal with that sphere, and one whose spheres have all their nominal radius is the
/// crystal as drawn.
#[test]
fn flaws_are_what_they_say() {
    let desk = Desk::new(STUDY);
    let study = desk.study();
    let drawn = layout(&study);
    let site = study.free[4];
    let wrong = Imperfection { alphabet: study.alphabet.clone(), wrong: vec![(site, 1)], ..Imperfection::default() };
    let mut swapped = drawn.clone();
    swapped[site] = 1 - swapped[site];
    let nominal = Imperfection { radii: vec![1.0; drawn.len()], ..Imperfection::default() };
    let smaller = Imperfection {
        radii: (0..drawn.len()).map(|i| 1.0 - 1e-4 * (i % 7) as f64).collect(),
        ..Imperfection::default()
    };
    let cases = [Imperfection::default(), wrong, nominal, smaller]
        .map(|imperfection| LoadCase { imperfection, ..LoadCase::from(PULSE) });
    let of = scores(&study, &drawn, &cases, Detail::Energies);
    assert_eq!(of[1], scores(&study, &swapped, &cases[..1], Detail::Energies)[0]);
    assert_ne!(of[1], of[0]);
    assert_eq!(of[2], of[0]);
    // Gaps of some micrometres change something, and not everything.
    let change = (of[3].contrast.unwrap() / of[0].contrast.unwrap() - 1.0).abs();
    assert!(change > 1e-4 && change < 0.5, "{change}");
}

/// Layouts of crystals whose radii scatter, with friction and without, stand side by side in the lanes: each has the bits that it has alone.
#[test]
fn scattered_radii_and_friction_have_the_bits_of_one_by_one() {
    let desk = Desk::new(STUDY);
    let study = desk.study();
    let never = Context::default();
    let sites = study.design().sites();
    let scattered = |k: usize| Imperfection {
        radii: (0..sites).map(|i| 1.0 - 1e-4 * ((7 * i + k) % 11) as f64).collect(),
        ..Imperfection::default()
    };
    let cases: Vec<LoadCase> = [None, Some(0.2)]
        .into_iter()
        .flat_map(|friction| {
            let load = ImpactLoad { friction, ..ImpactLoad::from(PULSE) };
            (0..3).map(move |k| (load, k))
        })
        .map(|(load, k)| LoadCase { imperfection: scattered(k), ..LoadCase::from(load) })
        .collect();
    // More than a vector register holds.
    let layouts: Vec<Vec<u8>> = (0..11)
        .map(|k| study.materials(&std::array::from_fn::<u8, 12, _>(|i| u8::from(i % 5 == k % 5 || i == k))))
        .collect();
    let of = |cases: &[LoadCase]| {
        Evaluator::new(&study.design, cases, study.palette.clone(), study.overrides(0), &never).unwrap()
    };
    let together = of(&cases).scores(&layouts, &never).unwrap();
    for (k, case) in cases.iter().enumerate() {
        let alone = of(std::slice::from_ref(case));
        for (layout, runs) in layouts.iter().zip(&together) {
            let one = alone.scores(std::slice::from_ref(layout), &never).unwrap();
            assert_eq!(one[0][0], runs[k], "case {k}");
        }
    }
}

/// A run that has come above its limit is one that ends above it; the others are not touched by that.
#[test]
fn a_run_ends_when_its_limit_is_out_of_reach() {
    let desk = Desk::new(STUDY);
    let study = desk.study();
    let never = Context::default();
    let overrides = Overrides { step: Some(2e-8), ..study.overrides(0) };
    let evaluator = Evaluator::new(&study.design, &[PULSE], study.palette.clone(), overrides, &never).unwrap();
    let layouts: Vec<Vec<u8>> =
        (0..12).map(|k| study.materials(&std::array::from_fn::<u8, 12, _>(|i| u8::from(i % 4 == k % 4)))).collect();
    let whole = evaluator.scores(&layouts, &never).unwrap();
    // Every second one may come to what it does come to, the others to half of it.
    let most: Vec<f64> =
        whole.iter().zip(0..).map(|(of, k)| of[0].scores.protected_mean * [1.001, 0.5][k % 2]).collect();
    let within =
        evaluator.scores_within(&layouts, &most.iter().map(|&most| vec![most]).collect::<Vec<_>>(), &never).unwrap();
    for (k, (whole, within)) in whole.iter().zip(&within).enumerate() {
        if k % 2 == 0 {
            assert_eq!(within, whole);
        } else {
            assert!(matches!(within[0].stop, Some(Stop::Beyond { .. })), "{k} {:?}", within[0].stop);
            assert!(
                within[0].scores.protected_mean > most[k]
                    && within[0].scores.protected_mean <= whole[0].scores.protected_mean
            );
        }
    }
}

const TOLERANT: &str = "budget = 60\n[tolerance]\nwrong = \"10 %\"\nmembers = 2\nreported = 9\n[[impact]]\n\
                        force = \"16 kN\"\nduration = \"20 us\"\n[[impact]]\nforce = \"16 kN\"\n\
                        duration = \"20 us\"\nangle = \"15 deg\"\n";

/// Moves what has to stand above sections to the front.
fn tolerant() -> String {
    format!("{}{TOLERANT}", STUDY.replace("budget = 600\n", "")).replace("budget = 60\n[tol", "[tol").replacen(
        "format = 1",
        "format = 1\nbudget = 60",
        1,
    )
}

/// Every layout is judged as drawn and as built; the end says what the best loses; and all of it follows from the file.
#[test]
fn crystals_not_built_as_drawn_are_members_of_the_set() {
    let desk = Desk::new(&tolerant());
    let study = desk.study();
    assert_eq!(study.cases().len(), 2 * 3);
    let (state, told) = desk.run().unwrap();
    assert_eq!((state.ended, told.simulated), (Ended::Budget, 60));
    let best = state.found().unwrap();
    assert_eq!(best.entry.impacts.len(), 6);
    let worst = best.entry.impacts.iter().filter_map(|scored| scored.contrast).reduce(f64::min);
    assert_eq!(best.scores.contrast, worst);
    let loses = state.tolerance.unwrap();
    assert_eq!((loses.crystals, loses.stopped), (9, 0));
    let contrast = loses.contrast.unwrap();
    assert!(contrast.median <= contrast.ninety && contrast.ninety > 0.0);
    let (again, told) = desk.run().unwrap();
    assert_eq!((again, told.simulated), (state.clone(), 0));
    // Other crystals are other settings.
    std::fs::write(desk.path("study.toml"), tolerant().replace("members = 2", "members = 2\nseed = 9")).unwrap();
    assert_eq!(desk.run().unwrap().1.simulated, 60);
}

/// A study that asks for what is felt, with a limit on what spheres cost.
#[test]
fn studies_ask_for_forces_arrival_dissipation_and_cost() {
    let objective = STUDY.lines().find(|line| line.starts_with("objective")).unwrap();
    let asked = "objective = { protected-force = { minimise = 1 }, dissipation = { maximise = 0.5 }, \
                 focal-arrival = { max = 1e-3 }, far-momentum = { max = 100 }, cost = { max = 40 } }\n\
                 prices = { stainless-440c = 1, brass-260 = 3 }";
    let desk = Desk::new(&STUDY.replace("600", "150").replace(objective, asked));
    let (state, _) = desk.run().unwrap();
    let best = state.best.clone().unwrap();
    // 28 whole spheres of 1, and 2 more for each of brass, less where it lies on a mirror line.
    assert!((28.0..=40.0).contains(&best.scores.half_cost.unwrap()));
    let force = |found: &granulens::study::Found| found.entry.impacts[0].protected_force;
    assert!(force(&best) < force(state.start.as_ref().unwrap()) || best.loss <= state.start.as_ref().unwrap().loss);
    let (again, told) = desk.run().unwrap();
    assert_eq!((again, told.simulated), (state, 0));
}

/// P over that of the best baseline: of the crystal that is the quietest of them it is one.
#[test]
fn protection_is_compared_with_the_best_baseline() {
    let objective = STUDY.lines().find(|line| line.starts_with("objective")).unwrap();
    let asked = "objective = { contrast = { maximise = 1 }, protection-best = { max = 2 } }";
    let desk = Desk::new(&STUDY.replace("600", "60").replace(objective, asked));
    let (state, _) = desk.run().unwrap();
    let scored = state.best.unwrap().entry.impacts[0].clone();
    let best = scored.protection_best.unwrap();
    assert!(best <= 2.0);
    // Q refers to one of the baselines, the crystal of brass alone: the best of all is not louder.
    assert!(best >= scored.protection.unwrap() * (1.0 - 1e-12));
    let study = desk.study();
    let never = Context::default();
    let uniform = [0, 1].map(|material| vec![material; study.design().sites()]);
    let evaluator = Evaluator::new(&study.design, &study.cases(), study.palette.clone(), study.overrides(0), &never)
        .unwrap()
        .against(&uniform, &never)
        .unwrap();
    let runs = evaluator.scores(&uniform, &never).unwrap();
    let [host, brass] = [&runs[0][0], &runs[1][0]].map(|run| run.scores.protection_best.unwrap());
    assert_eq!(host.min(brass), 1.0);
    let of_means = runs[0][0].scores.protected_mean / runs[1][0].scores.protected_mean;
    assert!((host / brass / of_means - 1.0).abs() < 1e-14);
}

/// A study without prices has those of its design, and may add what these leave out; the two may not contradict each other.
#[test]
fn prices_may_stand_in_the_design() {
    let objective = STUDY.lines().find(|line| line.starts_with("objective")).unwrap();
    let cost = |prices: &str, of_design: &str| {
        let asked = format!("objective = {{ cost = {{ minimise = 1 }} }}\n{prices}");
        let desk = Desk::new(&STUDY.replace(objective, &asked));
        let design = std::fs::read_to_string(desk.path("tiny.toml")).unwrap();
        std::fs::write(desk.path("tiny.toml"), design + of_design).unwrap();
        let study = Study::read(&desk.path("study.toml"), None).map_err(|error| error.to_string())?;
        Ok::<f64, String>(study.counter.stats(&layout(&study)).half.cost.unwrap())
    };
    let both = "\n[prices]\nstainless-440c = 1\nbrass = 3\n";
    let of_design = cost("", both).unwrap();
    assert_eq!(of_design, cost("prices = { stainless-440c = 1, brass-260 = 3 }", "").unwrap());
    assert_eq!(of_design, cost("prices = { brass = 3 }", "\n[prices]\nstainless-440c = 1\n").unwrap());
    assert_eq!(of_design, cost("prices = { brass-260 = 3.0 }", both).unwrap());
    let refusal = cost("prices = { brass = 4 }", both).unwrap_err();
    assert!(refusal.contains("study.toml:6: prices: brass-260 = 4 here, and 3 in the design."), "{refusal}");
    let refusal = cost("", "\n[prices]\nbrass = 3\n").unwrap_err();
    assert!(refusal.contains("study nor design says that of stainless-440c"), "{refusal}");
}

#[test]
fn wrong_sets_hear_their_line() {
    for (old, new, says) in [
        ("15 deg", "90 deg", "study.toml:20: angle = \"90 deg\" must lie between"),
        ("15 deg", "15 mm", "study.toml:20: angle:"),
        ("angle = \"15 deg\"", "x = [\"9 D\", \"10 D\"]", "study.toml:20: x = [\"9 D\", \"10 D\"] holds no sphere"),
        ("angle = \"15 deg\"", "x = [\"9\", \"10 D\"]", "study.toml:20: x:"),
        ("angle = \"15 deg\"", "", "study.toml:18: the impact is given twice"),
        ("10 %", "60 %", "study.toml:11: tolerance.wrong = \"60 %\" must be at most 50 %"),
        ("wrong = \"10 %\"", "radii = \"6 %\"", "study.toml:11: tolerance.radii = \"6 %\" must be at most 5 %"),
        ("wrong = \"10 %\"", "", "study.toml:10: tolerance: says neither"),
        ("members = 2", "members = 2000", "study.toml:12: tolerance.members = 2000 must be at most"),
    ] {
        let text = tolerant();
        assert!(text.contains(old), "{old}");
        let desk = Desk::new(&text.replacen(old, new, 1));
        let refusal = Study::read(&desk.path("study.toml"), None).unwrap_err().to_string();
        assert!(refusal.contains(says), "{refusal}");
    }
    let objective = STUDY.lines().find(|line| line.starts_with("objective")).unwrap();
    for (written, says) in [
        (
            "objective = { cost = { minimise = 1 } }\nprices = { brass = \"3\" }",
            "study.toml:6: prices.brass = \"3\" must be a number",
        ),
        (
            "objective = { cost = { minimise = 1 } }\nprices = { brass = 1, brass-260 = 2 }",
            "study.toml:6: prices.brass-260 = 2 is the second price of this material",
        ),
        (
            "objective = { cost = { minimise = 1 } }",
            "study.toml:5: cost is asked for, but [prices] of neither study nor design says that of stainless-440c",
        ),
        (
            "objective = { cost = { minimise = 1 } }\nprices = { stainless-440c = 1 }",
            "study.toml:5: cost is asked for, but [prices] of neither study nor design says that of brass-260",
        ),
        (
            "objective = { cost = { minimise = 1 } }\nprices = { stainles = 1 }",
            "study.toml:6: prices.stainles = 1 is the price of no known material. Known are",
        ),
        (
            "objective = { cost = { minimise = 1 } }\nprices = { brass = -1 }",
            "study.toml:6: prices.brass = -1 must not be negative. Write the price of one sphere",
        ),
    ] {
        let desk = Desk::new(&STUDY.replace(objective, written));
        let refusal = Study::read(&desk.path("study.toml"), None).unwrap_err().to_string();
        assert!(refusal.contains(says), "{refusal}");
    }
}

/// A study that names laws judges every layout under each of them, its worst counts, and a case under a law has the bits of a design with that law at its
/// step: the one that it would choose, or the same part of it that a given step is of what the design's law would choose.
/// Without laws nothing changes, journals among it: their key is then the one that it always was.
#[test]
fn a_study_judges_under_each_law() {
    let plain = Desk::new(STUDY);
    let desk = Desk::new(&format!("laws = [\"thesis\", \"mdr-static\"]\n{STUDY}"));
    let study = desk.study();
    let laws: Vec<_> = study.impacts.iter().map(|impact| impact.law).collect();
    assert_eq!(laws, [Some(LawKind::Thesis), Some(LawKind::MdrStatic)]);
    assert!(plain.study().impacts.iter().all(|impact| impact.law.is_none()));
    let layout = layout(&study);
    let both = scores(&study, &layout, &study.cases(), Detail::Energies);
    let chosen = |law| {
        let AnyDesign::Plane(design) = &study.design else { panic!("a sheet") };
        let free = Design { law, step: None, ..(**design).clone() };
        Plan::new(&free, Overrides::default(), &study.palette).unwrap().step
    };
    let (given, plan) = (4e-7, study.plan(0).unwrap());
    let own = plan.step_under(LawKind::MdrStatic);
    let part = own / given / (chosen(LawKind::MdrStatic) / chosen(LawKind::Thesis));
    assert_eq!((plan.step, plan.step_under(LawKind::Thesis)), (given, given));
    // Less what makes it divide the pulse.
    let in_pulse = PULSE.duration / own;
    assert!(own < given && (0.9..=1.0 + 1e-6).contains(&part), "{own} of {given}");
    assert!((in_pulse - in_pulse.round()).abs() < 1e-9, "{in_pulse} steps in the pulse");
    assert_eq!(both[0], scores(&plain.study(), &layout, &plain.study().cases(), Detail::Energies)[0]);
    let mut other = plain.study();
    if let AnyDesign::Plane(design) = &mut other.design {
        (design.law, design.step) = (LawKind::MdrStatic, Some(own));
    }
    let alone = scores(&other, &layout, &other.cases(), Detail::Energies);
    assert_eq!(both[1], alone[0]);
    let mut free = desk.study();
    if let AnyDesign::Plane(design) = &mut free.design {
        design.step = None;
    }
    let plan = free.plan(0).unwrap();
    for law in [LawKind::Thesis, LawKind::MdrStatic] {
        assert_eq!(plan.step_under(law), chosen(law), "{law}");
    }
    assert!((both[0].contrast.unwrap() / both[1].contrast.unwrap() - 1.0).abs() > 1e-3);
    let wrong = Desk::new(&format!("laws = [\"herz\"]\n{STUDY}"));
    let error = Study::read(&wrong.path("study.toml"), None).unwrap_err().to_string();
    assert!(error.contains("unknown contact law"), "{error}");
}
