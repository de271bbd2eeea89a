//! `trace`: rays of a proposed lens, first arrivals of any layout.

use super::Desk;

#[test]
fn rays_are_drawn_and_are_json() {
    let desk = Desk::new();
    let ran = desk.run(&["trace", "small.toml", "--out", "rays.svg"]).ok();
    assert!(
        ran.stdout.contains("first arrival in the focal row") && ran.stdout.contains("focal row: "),
        "{}",
        ran.stdout
    );
    let svg = desk.read("rays.svg");
    assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"));
    for words in ["rays by Snell", "where they are at equal times", "first arrival on the lattice", "protected"] {
        assert!(svg.contains(words), "{words}");
    }
    assert_eq!(desk.run(&["trace", "small.toml", "--quiet"]).ok().stdout, svg);
    let json = desk.run(&["trace", "small.toml", "--rays", "7", "--interval", "10 us", "--json"]).ok().json();
    let rays = json["rays"].as_array().unwrap();
    assert_eq!(rays.len(), 7);
    for ray in rays {
        let [points, times] = ["points_m", "times_s"].map(|key| ray[key].as_array().unwrap());
        assert_eq!(points.len(), times.len());
        assert!(times.windows(2).all(|pair| pair[1].as_f64() >= pair[0].as_f64()));
    }
    assert_eq!(json["wavefronts"][1]["time_s"], 20e-6);
    // Every site is reached, row 1 at once, and no wave is faster than the host's.
    let speed = json["proposal"]["host_speed_m_s"].as_f64().unwrap();
    for (site, time) in json["sites"].as_array().unwrap().iter().zip(json["first_arrival_s"].as_array().unwrap()) {
        let (z, time) = (site["z"].as_f64().unwrap(), time.as_f64().unwrap());
        assert!(time >= z / speed * (1.0 - 1e-12) && (site["row"] != 1 || time == 0.0), "{site} {time}");
    }
}

/// A layout has first arrivals and no rays; that of the lens the same ones.
#[test]
fn layouts_have_first_arrivals() {
    let desk = Desk::with_layout();
    let lens = desk.run(&["trace", "small.toml", "--json"]).ok().json();
    let layout = desk.run(&["trace", "small.toml", "small.csv", "--json"]).ok().json();
    assert_eq!(lens["first_arrival_s"], layout["first_arrival_s"]);
    assert!(layout["rays"].as_array().unwrap().is_empty() && layout["proposal"].is_null());
    let words = desk.run(&["trace", "small.toml", "small.csv", "--out", "a.svg"]).ok().stdout;
    assert!(words.contains("eikonal") && !words.contains("by rays"), "{words}");
    let wrong = desk.run(&["trace", "small.toml", "none.csv"]);
    assert_eq!(wrong.code, 2);
}
