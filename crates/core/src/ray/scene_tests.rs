//! Rays against closed forms.

use std::f64::consts::FRAC_1_SQRT_2;

use super::*;
use crate::ray::Optics;
use crate::ray::{Circle, Conic, Graph, Polyline, Segment, caustic, fan, least_spot, spot, wavefront};

type Vector = Vector2;

fn scene(curve: impl Curve + 'static, speeds: [f64; 2]) -> Scene {
    let interfaces = vec![Interface::new(Box::new(curve), speeds, "face")];
    Scene { interfaces, speed: speeds[0], half_width: 10.0, end: 100.0, reflections: 0 }
}

fn along(degrees: f64) -> Vector {
    let angle = degrees.to_radians();
    Vector::new(angle.sin(), angle.cos())
}

/// A flat front and a back z = z_b − s with x² = (n² − 1) s² + 2 (n − 1) f s bring a plane wave of a slow lens (n = host over
/// lens) to one point f behind the vertex: a hyperbola with c = −1/((n − 1) f) and k = −n². Round-off only.
#[test]
fn a_hyperbolic_back_brings_all_rays_to_one_point_at_one_time() {
    let (n, f, vertex) = (1.7, 20.0, 15.0);
    let back =
        Conic { vertex: Vector::new(0.0, vertex), curvature: -1.0 / ((n - 1.0) * f), constant: -n * n, x: [0.0, 10.0] };
    // All of the crystal in front of it is lens.
    let scene = scene(back, [1.0, n]);
    let traces = fan(&scene, 101);
    let focus = spot(&traces, vertex + f, Some(0.0)).unwrap();
    assert_eq!(focus.rays, 101);
    assert!(focus.radius < 1e-12 && focus.times[1] - focus.times[0] < 1e-12, "{focus:?}");
    let least = least_spot(&traces, [vertex + 10.0, vertex + 30.0], Some(0.0)).unwrap();
    assert!((least.depth - vertex - f).abs() < 0.02, "{least:?}");
}

/// An elliptic front, k = −1/n², brings a plane wave in a fast host to one point inside the slow medium, f = n R/(n − 1)
/// behind its vertex.
#[test]
fn an_elliptic_front_brings_all_rays_to_one_point_within() {
    let (n, radius, vertex) = (1.7, 12.0, 5.0);
    let front =
        Conic { vertex: Vector::new(0.0, vertex), curvature: 1.0 / radius, constant: -1.0 / (n * n), x: [0.0, 9.0] };
    let scene = Scene { half_width: 9.0, ..scene(front, [n, 1.0]) };
    let focus = spot(&fan(&scene, 50), vertex + n * radius / (n - 1.0), Some(0.0)).unwrap();
    assert_eq!(focus.rays, 50);
    assert!(focus.radius < 1e-12 && focus.times[1] - focus.times[0] < 1e-12, "{focus:?}");
}

/// The aplanatic points of a circle (Weierstrass): rays within a slow circle (n) from a point R/n off its centre leave it
/// as if from one point n R off. Traced back, all leave along lines through that point.
#[test]
fn a_circle_is_free_of_error_between_its_aplanatic_points() {
    let (n, radius, centre) = (1.5, 4.0, Vector::new(5.0, 50.0));
    let scene = scene(Circle { centre, radius }, [1.0, n]);
    let source = centre + Vector::new(0.0, -radius / n);
    let image = centre + Vector::new(0.0, -n * radius);
    for degrees in [-80.0, -30.0, -5.0, 5.0, 20.0, 60.0, 89.0] {
        let trace = scene.trace_from(source.into(), along(degrees), 1.0);
        let [a, b] = [trace.path.points[1], trace.path.points[2]].map(Vector::from);
        assert_eq!(trace.events[0], Event::Passed(0));
        let (way, off) = ((b - a).normalize(), image - a);
        assert!((way.x * off.y - way.y * off.x).abs() < 1e-12, "{degrees}");
    }
}

/// Rays from one focus of an ellipse are reflected to the other, all at the same time, however they start: here totally,
/// out of a medium so slow that nothing passes. Also with the ellipse's lower half as a graph met by bracketing, whose
/// normal is a difference: to its stated 1e-10.
#[test]
fn an_ellipse_reflects_one_focus_to_the_other() {
    let (a, b) = (5.0_f64, 3.0_f64);
    let c = (a * a - b * b).sqrt();
    let centre = Vector::new(5.0, 50.0);
    let foci = [centre - Vector::new(c, 0.0), centre + Vector::new(c, 0.0)];
    let conic = Conic {
        vertex: centre + Vector::new(0.0, b),
        curvature: -b / (a * a),
        constant: (a * a) / (b * b) - 1.0,
        x: [0.0, 10.0],
    };
    let height = move |x: f64| centre.y + b * (1.0 - ((x - centre.x) / a).powi(2)).max(0.0).sqrt();
    let graph = Graph { height, x: [0.0, 10.0], z: [centre.y, centre.y + b], parts: 64 };
    let conic = Scene { reflections: 1, ..scene(conic, [1.0, 1e9]) };
    let graph = Scene { reflections: 1, ..scene(graph, [1.0, 1e9]) };
    for (scene, tolerance) in [(conic, 1e-12), (graph, 1e-8)] {
        for degrees in [-35.0, 0.0, 20.0, 50.0, 70.0] {
            let trace = scene.trace_from(foci[0].into(), along(degrees), 1.0);
            let [mirror, onward] = [trace.path.points[1], trace.path.points[2]].map(Vector::from);
            assert_eq!(trace.events[0], Event::Reflected(0));
            let (way, off) = ((onward - mirror).normalize(), foci[1] - mirror);
            assert!((way.x * off.y - way.y * off.x).abs() < tolerance, "{degrees}");
            assert!((trace.path.times[1] + off.norm() - 2.0 * a).abs() < tolerance);
        }
    }
}

/// A prism of angle α turns a ray by θ₁ + arcsin(sin α √(n² − sin²θ₁) − sin θ₁ cos α) − α, least at the symmetric passage where
/// n = sin((α + δ)/2)/sin(α/2). Round-off only.
#[test]
fn a_prism_deviates_by_the_closed_form() {
    let (n, apex) = (1.6_f64, 40.0_f64.to_radians());
    // Its edge at (5, 20), faces at ±α/2 from the x axis's normal: front runs down to the left, back down to the right.
    let edge = Vector::new(9.0, 50.0);
    let [front, back] = [-0.5 * apex, 0.5 * apex].map(|turn: f64| edge - Vector::new(turn.cos(), -turn.sin()) * 9.0);
    let interfaces = vec![
        Interface::new(Box::new(Segment { from: front, to: edge }), [n, 1.0], "front"),
        Interface::new(Box::new(Segment { from: back, to: edge }), [1.0, n], "back"),
    ];
    let prism = Scene { interfaces, speed: n, half_width: 10.0, end: 100.0, reflections: 0 };
    for degrees in [20.0_f64, 30.0, 45.0, 60.0] {
        let incidence = degrees.to_radians();
        let face = (edge - front).normalize();
        let normal = Vector::new(-face.y, face.x);
        // From the thick side's normal towards the edge.
        let direction = normal * incidence.cos() + face * incidence.sin();
        let start = (front + edge) * 0.5 - direction * 3.0;
        let trace = prism.trace_from(start.into(), direction, n);
        assert_eq!(trace.events[..2], [Event::Passed(0), Event::Passed(1)], "{degrees}");
        let [a, b] = [trace.path.points[2], trace.path.points[3]].map(Vector::from);
        let turned = (b - a).normalize().dot(&direction).acos();
        let out = (apex.sin() * (n * n - incidence.sin().powi(2)).sqrt() - incidence.sin() * apex.cos()).asin();
        assert!((turned - (incidence + out - apex)).abs() < 1e-12, "{degrees}: {turned}");
    }
}

/// Parallel rays reflected by a circle touch its nephroid: a ray that meets it at incidence θ touches at R cos θ/2 from there
/// (J. Bernoulli). Neighbours 1e-5 apart leave 1e-9.
#[test]
fn the_caustic_of_a_circular_mirror_is_the_nephroid() {
    let radius = 8.0;
    let mirror = Conic { vertex: Vector::new(0.0, 50.0), curvature: -1.0 / radius, constant: 0.0, x: [0.0, 7.9] };
    let scene = Scene { half_width: 10.0, reflections: 1, ..scene(mirror, [1.0, 1e9]) };
    let lines = caustic(&scene, 200);
    let points: Vec<[f64; 2]> = lines.into_iter().flatten().filter(|p| p[1] > 30.0).collect();
    assert!(points.len() > 60);
    for [x, z] in points {
        // In units of R about its centre: x = sin³ θ, and the height by x = sin θ − sin 2θ cos θ/2.
        let sine = (x / radius).cbrt();
        let cosine = (1.0 - sine * sine).sqrt();
        let height = cosine - 0.5 * cosine * (1.0 - 2.0 * sine * sine);
        let expected = 50.0 - radius + radius * height;
        assert!((z - expected).abs() < 1e-7, "{x} {z} {expected}");
    }
}

/// Fermat: the time of a ray through two curved faces is stationary against shifts of the places where it meets them.
#[test]
fn travel_time_is_stationary_for_any_pair_of_faces() {
    let [host, lens] = [1344.68, 791.08];
    let front = Conic { vertex: Vector::new(0.0, 4.0), curvature: 0.05, constant: -2.0, x: [0.0, 10.0] };
    let back = Conic { vertex: Vector::new(0.0, 16.0), curvature: -0.04, constant: 0.5, x: [0.0, 10.0] };
    let interfaces = vec![
        Interface::new(Box::new(front), [host, lens], "front"),
        Interface::new(Box::new(back), [lens, host], "back"),
    ];
    let scene = Scene { interfaces, speed: host, half_width: 10.0, end: 30.0, reflections: 0 };
    for x in [1.0, 4.0, 7.0] {
        let trace = scene.trace(x);
        assert_eq!(trace.events[..2], [Event::Passed(0), Event::Passed(1)]);
        let depth = 20.0;
        let (x_end, time_end) = trace.path.at_depth(depth).unwrap();
        let (entry, exit) = (trace.path.points[1][0], trace.path.points[2][0]);
        let time = |entry: f64, exit: f64| {
            let (top, bottom) = (4.0 + front.sag(entry), 16.0 + back.sag(exit));
            top / host + (exit - entry).hypot(bottom - top) / lens + (x_end - exit).hypot(depth - bottom) / host
        };
        assert!((time(entry, exit) / time_end - 1.0).abs() < 1e-12);
        for (i, j) in [(1e-4, 0.0), (0.0, 1e-4)] {
            let slope = (time(entry + i, exit + j) - time(entry - i, exit - j)) / 2e-4;
            assert!(slope.abs() * host < 1e-7, "{slope} at {x}");
        }
    }
}

/// The same circle as conic, as full circle, as bracketed graph and as fine polyline.
#[test]
fn all_kinds_of_curves_agree() {
    let (radius, vertex) = (15.0, 5.0);
    let conic = Conic { vertex: Vector::new(0.0, vertex), curvature: 1.0 / radius, constant: 0.0, x: [0.0, 10.0] };
    let height = move |x: f64| vertex + conic.sag(x);
    let graph = Graph { height, x: [0.0, 10.0], z: [vertex, height(10.0)], parts: 32 };
    let corners = (0..=20_000).map(|k| f64::from(k) * 5e-4).map(|x| Vector::new(x, height(x))).collect();
    let circle = Circle { centre: Vector::new(0.0, vertex + radius), radius };
    let speeds = [1.3, 0.8];
    let end = |curve: Scene, x: f64| curve.trace(x).path.at_depth(25.0).unwrap();
    for x in [0.0, 0.7, 3.0, 9.0] {
        let exact = end(scene(conic, speeds), x);
        // Outside is its second side; rays come from there. It closes at a depth of 35.
        let others = [
            (end(Scene { speed: speeds[0], ..scene(circle, [speeds[1], speeds[0]]) }, x), 1e-12),
            (end(scene(Graph { height, ..graph }, speeds), x), 1e-8),
            (end(scene(Polyline(Vec::clone(&corners)), speeds), x), 2e-3),
        ];
        for ((place, time), tolerance) in others {
            assert!((place - exact.0).abs() < tolerance && (time - exact.1).abs() < tolerance, "{x} {tolerance}");
        }
    }
}

/// At the critical angle exactly, at a straight interface, a ray runs along it; beyond, it is reflected, followed or not.
#[test]
fn what_does_not_pass_is_named() {
    let step = Segment { from: Vector::new(0.0, 20.0), to: Vector::new(10.0, 20.0) };
    let blocked = scene(step, [1.0, 2.0_f64.sqrt()]);
    let start = [1.0, 15.0];
    let grazing = blocked.trace_from(start, Vector::new(FRAC_1_SQRT_2, FRAC_1_SQRT_2), 1.0);
    assert_eq!(grazing.fate, Fate::Grazing(0));
    let total = blocked.trace_from(start, along(50.0), 1.0);
    let Fate::Reflected(0, reflection) = total.fate else { panic!("{:?}", total.fate) };
    assert!(
        (reflection.critical.to_degrees() - 45.0).abs() < 1e-9
            && (reflection.incidence.to_degrees() - 50.0).abs() < 1e-9
    );
    let words = blocked.failure(&total.fate).unwrap();
    assert_eq!(words, "ends at the face: total reflection: incidence at 50.0 degrees, critical angle 45.0 degrees");
    let followed = Scene { reflections: 1, ..scene(step, [1.0, 2.0_f64.sqrt()]) }.trace_from(start, along(50.0), 1.0);
    assert_eq!(followed.fate, Fate::Returned);
    // Up again over 20 and across by 20 tan 50° = 23.8 from x = 7.0: it crosses 10, 20 and 30.
    let mirrors = [true, false, true].map(Event::Mirror);
    assert_eq!((followed.events[0], &followed.events[1..]), (Event::Reflected(0), &mirrors[..]));
    assert!(followed.path.times.windows(2).all(|t| t[1] > t[0]));
    assert_eq!(blocked.trace(3.0).fate, Fate::Arrived);
}

/// Light between two mirrors and nothing else: a zigzag of the length of its unfolded way.
#[test]
fn mirror_lines_fold_the_way() {
    let empty = Scene { interfaces: Vec::new(), speed: 2.0, half_width: 10.0, end: 100.0, reflections: 0 };
    let trace = empty.trace_from([4.0, 0.0], along(-60.0), 2.0);
    let unfolded = 4.0 - 100.0 * 3.0_f64.sqrt();
    let [x, z] = *trace.path.points.last().unwrap();
    let wrapped = unfolded.abs() % 20.0;
    assert!((x - wrapped.min(20.0 - wrapped)).abs() < 1e-10 && z == 100.0);
    assert!((trace.path.times.last().unwrap() - 100.0).abs() < 1e-10);
    // A plane front stays one.
    let front = wavefront(&fan(&empty, 11), 7.0);
    assert_eq!(front.len(), 1);
    assert!(front[0].len() == 11 && front[0].iter().all(|p| (p[1] - 14.0).abs() < 1e-12));
}

/// The landing at a depth is that of the whole way, to the last bit, wherever rays go: through both faces, beside the lens, over
/// mirror lines, and not at all.
#[test]
fn a_landing_is_where_the_way_goes() {
    let front = Conic { vertex: Vector::new(0.0, 4.0), curvature: 0.12, constant: -0.5, x: [0.0, 7.0] };
    let back = Conic { vertex: Vector::new(0.0, 14.0), curvature: -0.05, constant: 0.0, x: [0.0, 7.0] };
    let interfaces =
        vec![Interface::new(Box::new(front), [2.0, 1.0], "front"), Interface::new(Box::new(back), [1.0, 2.0], "back")];
    let scene = Scene { interfaces, speed: 2.0, half_width: 10.0, end: 60.0, reflections: 0 };
    let (mut met, mut lost, mut mirrored) = (vec![Event::Bent], 0, 0);
    for k in 0..200 {
        let x = 0.05 * f64::from(k);
        let trace = scene.trace(x);
        for depth in [2.0, 10.0, 20.0, 59.0] {
            let landing = scene.landing(x, depth, &mut met);
            assert_eq!(landing, trace.path.at_depth(depth).map(|place| place.0), "{x} {depth}");
            match trace.path.leg_at(depth) {
                Some(leg) => assert_eq!(met, trace.events[..leg]),
                None => lost += 1,
            }
            mirrored += usize::from(met.contains(&Event::Mirror(false)));
        }
    }
    assert!(lost > 0 && mirrored > 0, "{lost} {mirrored}");
}
