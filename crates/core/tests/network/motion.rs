use granulens_core::motion::{Local, MotionError, follow};

/// Places at random in a square, the same for a seed.
fn scattered(seed: u64, count: usize, side: f64) -> Vec<[f64; 2]> {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    let mut next = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1_u64 << 53) as f64 * side
    };
    (0..count).map(|_| [next(), next()]).collect()
}

/// Any affine motion leaves nothing, to rounding, and the map is the one that was applied; its rotation and strain are those of the
/// closed forms.
#[test]
fn affine_motion_leaves_nothing() {
    let before = scattered(1, 400, 15.0);
    for map in
        [[[1.0, 0.0], [0.0, 1.0]], [[1.2, 0.7], [-0.3, 0.4]], [[0.0, -1.0], [1.0, 0.0]], [[-2.0, 1.0], [3.0, 5.0]]]
    {
        let apply = |[x, z]: [f64; 2]| [map[0][0] * x + map[0][1] * z + 7.0, map[1][0] * x + map[1][1] * z - 3.0];
        let after: Vec<[f64; 2]> = before.iter().copied().map(apply).collect();
        for local in follow(&before, &after, 2.5, None).unwrap() {
            let (Some(d2min), Some(found)) = (local.d2min, local.map) else { panic!("{local:?}") };
            // 35 neighbours within 2.5, each off by some roundings of places of 100: 35 (10⁻¹⁴·100)².
            assert!(d2min < 1e-22 * 100.0, "{d2min}");
            for (found, map) in found.iter().flatten().zip(map.iter().flatten()) {
                assert!((found - map).abs() < 1e-11, "{found} {map}");
            }
        }
    }
    let (sin, cos) = 0.3_f64.sin_cos();
    let turned = Local { neighbours: 9, d2min: Some(0.0), map: Some([[cos, -sin], [sin, cos]]) };
    assert!((turned.rotation().unwrap() - 0.3).abs() < 1e-15 && turned.shear().unwrap() < 1e-15);
    let sheared = Local { neighbours: 9, d2min: Some(0.0), map: Some([[1.0, 0.2], [0.0, 1.0]]) };
    let [xx, xz, zz] = sheared.strain().unwrap();
    assert!(xx.abs() < 1e-15 && (xz - 0.1).abs() < 1e-15 && (zz - 0.02).abs() < 1e-15);
}

/// A shear that keeps the period: places that left through a side and came in by the other change nothing.
#[test]
fn periodic_sides_change_nothing() {
    let (period, count) = (12.0, 300);
    let before = scattered(5, count, period);
    let noise = scattered(6, count, 0.4);
    let after: Vec<[f64; 2]> =
        before.iter().zip(&noise).map(|([x, z], [dx, dz])| [x + 0.4 * z + dx, 1.1 * z + dz]).collect();
    let wrapped: Vec<[f64; 2]> = after.iter().map(|[x, z]| [x.rem_euclid(period), *z]).collect();
    let (plain, folded) =
        (follow(&before, &after, 2.5, Some(period)).unwrap(), follow(&before, &wrapped, 2.5, Some(period)).unwrap());
    for (plain, folded) in plain.iter().zip(&folded) {
        assert_eq!(plain.neighbours, folded.neighbours);
        assert!((plain.d2min.unwrap() - folded.d2min.unwrap()).abs() < 1e-10);
    }
    // All shifted sideways by part of a period, which moves the seam.
    let moved = |places: &[[f64; 2]]| -> Vec<[f64; 2]> {
        places.iter().map(|[x, z]| [(x + 5.3).rem_euclid(period), *z]).collect()
    };
    for (plain, moved) in plain.iter().zip(follow(&moved(&before), &moved(&after), 2.5, Some(period)).unwrap()) {
        assert_eq!(plain.neighbours, moved.neighbours);
        assert!((plain.d2min.unwrap() - moved.d2min.unwrap()).abs() < 1e-10);
    }
}

/// The neighbours found by rows are all within the radius, and only they; with a period as narrow as can be too.
#[test]
fn neighbours_are_those_within_the_radius() {
    for (period, radius) in [(None, 2.5), (Some(9.0), 2.5), (Some(9.0), 4.5), (None, 0.3), (None, 40.0)] {
        let places = scattered(9, 250, 9.0);
        let found = follow(&places, &places, radius, period).unwrap();
        for (i, found) in found.iter().enumerate() {
            let near = |other: &[f64; 2]| {
                let mut x = other[0] - places[i][0];
                x -= period.map_or(0.0, |period| period * (x / period).round());
                x.hypot(other[1] - places[i][1]) <= radius
            };
            assert_eq!(found.neighbours, places.iter().filter(|place| near(place)).count() - 1);
            assert_eq!(found.d2min.is_some(), found.neighbours >= 3);
        }
    }
}

/// Grains in a row: what leaves the line cannot be told, but what is left along it can.
#[test]
fn neighbours_on_a_line_have_no_map() {
    let before: Vec<[f64; 2]> = (0..5).map(|k| [f64::from(k), 2.0 * f64::from(k)]).collect();
    let mut after = before.clone();
    for local in follow(&before, &after, 20.0, None).unwrap() {
        assert!(local.d2min.unwrap() < 1e-25 && local.map.is_none() && local.neighbours == 4);
    }
    after[2] = [2.0, 4.5];
    let around_middle = follow(&before, &after, 20.0, None).unwrap()[2];
    // All four neighbours move by −0.5 along z against it, which no linear map of a symmetric row makes: 4 · 0.25.
    assert!((around_middle.d2min.unwrap() - 1.0).abs() < 1e-12, "{around_middle:?}");
}

#[test]
fn what_cannot_be_followed_is_refused() {
    let places = [[0.0, 0.0], [1.0, 0.0]];
    assert_eq!(follow(&places, &places[..1], 1.0, None), Err(MotionError::Count { before: 2, after: 1 }));
    assert_eq!(follow(&places, &places, 0.0, None), Err(MotionError::Radius(0.0)));
    assert_eq!(follow(&places, &places, 2.0, Some(3.0)), Err(MotionError::Wide { radius: 2.0, period: 3.0 }));
    assert_eq!(follow(&places, &[[0.0, 0.0], [f64::NAN, 0.0]], 1.0, None), Err(MotionError::Number(1)));
}

/// As OVITO's atomic strain modifier has it, to 10⁻¹⁰ (it differs from a least-squares fit in numpy by some 10⁻¹⁴): D²_min and
/// the map, with open and periodic sides.
#[test]
fn motion_is_ovito_s() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/motion/strain.json");
    let cases: Vec<serde_json::Value> = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    assert_eq!(cases.len(), 3);
    for case in &cases {
        let rows = |name: &str| -> Vec<Vec<f64>> {
            let of = |row: &serde_json::Value| row.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect();
            case[name].as_array().unwrap().iter().map(of).collect()
        };
        let places = |name: &str| -> Vec<[f64; 2]> { rows(name).iter().map(|row| [row[0], row[1]]).collect() };
        let radius = case["radius"].as_f64().unwrap();
        let found = follow(&places("before"), &places("after"), radius, case["period"].as_f64()).unwrap();
        let (d2min, maps) = (case["d2min"].as_array().unwrap(), rows("map"));
        assert_eq!((found.len(), d2min.len()), (180, 180));
        for ((local, d2min), map) in found.iter().zip(d2min).zip(&maps) {
            let (ours, theirs) = (local.d2min.unwrap(), d2min.as_f64().unwrap());
            assert!((ours - theirs).abs() < 1e-10 * theirs.max(1.0), "{}: {ours} {theirs}", case["name"]);
            for (ours, theirs) in local.map.unwrap().iter().flatten().zip(map) {
                assert!((ours - theirs).abs() < 1e-10, "{}: {ours} {theirs}", case["name"]);
            }
        }
    }
}
