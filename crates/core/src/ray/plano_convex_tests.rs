use super::*;

/// 440c and brass.
const SPEEDS: [f64; 2] = [1344.68, 791.08];

fn unit(angle: f64) -> Vector2 {
    Vector2::new(angle.sin(), angle.cos())
}

/// In units of the diameter: rows 5 to 16 and a radius of 16.5/sin 60°.
fn thesis_bench() -> PlanoConvex {
    let spacing = 0.75_f64.sqrt();
    let radius = 16.5 / 60.0_f64.to_radians().sin();
    PlanoConvex {
        apex: 4.0 * spacing,
        radius,
        back: 15.0 * spacing,
        half_width: 16.5,
        end: 49.0 * spacing,
        speeds: SPEEDS,
    }
}

/// Burgoyne 2016, fig. 5.14: an interface at 60° bends the wave by 60° − 30.6° = 29.4° (printed to 0.1°).
#[test]
fn a_sixty_degree_interface_bends_the_wave_by_the_published_angle() {
    let interface = 60.0_f64.to_radians();
    let refracted = refract(Vector2::y(), unit(interface), SPEEDS[0], SPEEDS[1]).unwrap();
    let bend = refracted.x.atan2(refracted.y);
    let equation_5_5 = interface - (SPEEDS[1] / SPEEDS[0] * interface.sin()).asin();
    assert!((bend - equation_5_5).abs() < 1e-14);
    assert!((bend.to_degrees() - 29.4).abs() < 0.05);
}

/// A refracted ray sent back takes the same way; the direction stays a unit vector. Round-off only.
#[test]
fn refraction_is_reversible() {
    for degrees in [-50.0_f64, -20.0, 0.0, 10.0, 35.0, 80.0] {
        let direction = unit(degrees.to_radians());
        let normal = unit(0.3);
        let Ok(refracted) = refract(direction, normal, SPEEDS[0], SPEEDS[1]) else { panic!("into the slower medium") };
        assert!((refracted.norm() - 1.0).abs() < 1e-14);
        let back = refract(-refracted, normal, SPEEDS[1], SPEEDS[0]).unwrap();
        assert!((back + direction).norm() < 1e-13);
    }
}

#[test]
fn beyond_the_critical_angle_nothing_passes() {
    let critical = (SPEEDS[1] / SPEEDS[0]).asin();
    let normal = Vector2::y();
    let grazing = refract(unit(critical - 1e-6), normal, SPEEDS[1], SPEEDS[0]).unwrap();
    // 1e-6 rad below the critical angle the ray is within √(2e-6 tan θ) = 1.2e-3 of grazing.
    assert!(grazing.y > 0.0 && grazing.y < 2e-3);
    let reflected = refract(unit(critical + 1e-6), normal, SPEEDS[1], SPEEDS[0]).unwrap_err();
    assert!((reflected.critical - critical).abs() < 1e-14);
    assert!((reflected.incidence - critical - 1e-6).abs() < 1e-12);
}

/// Fermat: with the ends held, the time is stationary against shifts of the points on both faces. A shift of 1e-4 D off
/// a path that was not stationary would change the time by some 1e-5 D over the speed; second order leaves 1e-9.
#[test]
fn travel_time_is_stationary() {
    let bench = thesis_bench();
    for x in [2.0, 8.0, 14.0] {
        let path = bench.trace(x).unwrap();
        let (entry, exit) = (path.points[1][0], path.points[2][0]);
        let depth = 20.0 * 0.75_f64.sqrt();
        let (x_end, time_end) = path.at_depth(depth).unwrap();
        let time = |entry: f64, exit: f64| {
            let front = bench.apex + bench.sag(entry);
            front / SPEEDS[0]
                + (exit - entry).hypot(bench.back - front) / SPEEDS[1]
                + (x_end - exit).hypot(depth - bench.back) / SPEEDS[0]
        };
        assert!((time(entry, exit) / time_end - 1.0).abs() < 1e-12);
        for (i, j) in [(1e-4, 0.0), (0.0, 1e-4)] {
            let slope = (time(entry + i, exit + j) - time(entry - i, exit - j)) / 2e-4;
            assert!(slope.abs() * SPEEDS[0] < 1e-7, "{slope} at {x}");
        }
    }
}

/// Rays close to the axis of a thin plano-convex lens meet at f = R/(V_host/V_lens − 1) behind it.
#[test]
fn a_thin_lens_has_the_textbook_focal_length() {
    let bench = PlanoConvex { apex: 1.0, radius: 10.0, back: 1.0001, half_width: 3.0, end: 100.0, speeds: SPEEDS };
    let focal = 10.0 / (SPEEDS[0] / SPEEDS[1] - 1.0);
    let crossing = bench.trace(1e-3).unwrap().axis_crossing().unwrap();
    assert!((crossing - bench.back - focal).abs() < 1e-3);
}

#[test]
fn rays_that_the_lens_does_not_pass_on_say_why() {
    let bench = PlanoConvex { back: 8.0 * 0.75_f64.sqrt(), ..thesis_bench() };
    assert!(bench.aperture() < 13.0);
    let beside = bench.trace(14.0).unwrap_err();
    assert_eq!(beside.reason, Reason::Beside);
    assert_eq!(beside.path.at_depth(bench.end).unwrap().0, 14.0);

    // Into a faster lens the front reflects from asin(791/1345) = 36° on, x = 11.2.
    let faster = PlanoConvex { speeds: [SPEEDS[1], SPEEDS[0]], ..thesis_bench() };
    assert!(faster.trace(8.0).is_ok());
    let stray = faster.trace(11.3).unwrap_err();
    assert!(matches!(stray.reason, Reason::TotalReflection(Face::Front, _)));
    assert_eq!(stray.path.points.len(), 2);

    // A lens of a third of the host's speed sends the rim's ray to its back beyond asin(1/3) = 19°.
    let slower = PlanoConvex { speeds: [3.0, 1.0], ..thesis_bench() };
    let stray = slower.trace(16.0).unwrap_err();
    assert!(matches!(stray.reason, Reason::TotalReflection(Face::Back, _)));
    assert_eq!(stray.path.points.last().unwrap()[1], slower.back);
}

/// A fast, strongly curved lens throws a ray out through its own front, where it meets the circle again.
#[test]
fn a_ray_may_leave_through_the_front() {
    let bench = PlanoConvex { apex: 0.0, radius: 1.0, back: 0.9, half_width: 2.0, end: 3.0, speeds: [1.0, 1.5] };
    let stray = bench.trace(0.66).unwrap_err();
    assert_eq!(stray.reason, Reason::LeavesThroughFront);
    let [x, z] = *stray.path.points.last().unwrap();
    assert!((x.hypot(z - 1.0) - 1.0).abs() < 1e-12 && z < bench.back);
}

/// Mirror lines turn rays round; the time along a path is its length over the speeds.
#[test]
fn mirrors_keep_the_ray_in_the_crystal() {
    let bench = PlanoConvex { half_width: 16.5, end: 200.0, ..thesis_bench() };
    let path = bench.trace(16.0).unwrap();
    assert!(path.points.iter().all(|p| (0.0..=16.5).contains(&p[0])));
    assert!(path.points.len() > 6);
    let mut time = 0.0;
    for (k, leg) in path.points.windows(2).enumerate() {
        let speed = SPEEDS[usize::from(k == 1)];
        time += (leg[1][0] - leg[0][0]).hypot(leg[1][1] - leg[0][1]) / speed;
    }
    assert!((time / path.times.last().unwrap() - 1.0).abs() < 1e-12);
    assert_eq!(path.axis_crossing().unwrap(), path.points[3][1]);
}
