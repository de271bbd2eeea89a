//! Two media side by side, and which media give what is wanted.

use super::{Dimension, Medium, critical_angle};
use crate::contact::{Constants, Pair};

/// The plane between two crystals of one packing, from the faster to the slower.
#[derive(Clone, Debug, PartialEq)]
pub struct Interface {
    /// The faster medium and the slower one, as indices into the list they were taken from.
    pub media: [usize; 2],
    /// Wave-speed bounds of the two (m/s).
    pub speeds: [f64; 2],
    /// V_fast/V_slow
    pub speed_ratio: f64,
    /// Angle of incidence (rad) from which on a wave out of the slower medium is totally reflected; none at equal speeds.
    pub critical_angle: Option<f64>,
    /// Z_fast/Z_slow with Z = ρ V; 1 reflects nothing at normal incidence, to first order.
    pub impedance_ratio: f64,
    /// F_p (N) of the contacts within the two media.
    pub plastic_forces: [f64; 2],
    /// F_p (N) of the contact between a sphere of one and a sphere of the other; the lowest, where dimers meet.
    pub interface_force: f64,
    /// Mean of the two densities (kg/m³), by which pairs are compared in weight.
    pub density: f64,
}

impl Interface {
    fn new(media: &[Medium], [a, b]: [usize; 2], dimension: Dimension, diameter: f64, constants: Constants) -> Self {
        let of = |k: usize| media[k].bound(dimension, diameter, constants);
        let [fast, slow] = if of(a).speed >= of(b).speed { [a, b] } else { [b, a] };
        let (x, y) = (of(fast), of(slow));
        let touching = media[fast].materials.iter().flat_map(|p| media[slow].materials.iter().map(move |q| [p, q]));
        let interface_force = touching
            .map(|pair| Pair::new(pair, [0.5 * diameter; 2], constants).plastic_force())
            .fold(f64::INFINITY, f64::min);
        Self {
            media: [fast, slow],
            speeds: [x.speed, y.speed],
            speed_ratio: x.speed / y.speed,
            critical_angle: critical_angle([x.speed, y.speed]),
            impedance_ratio: media[fast].impedance(&x) / media[slow].impedance(&y),
            plastic_forces: [x.plastic_force, y.plastic_force],
            interface_force,
            density: 0.5 * (media[fast].density() + media[slow].density()),
        }
    }
}

/// What happens between every two of the media, for spheres of `diameter` (m) in a crystal of that dimension: n (n − 1)/2 interfaces of n media, pairs
/// in the order of the list.
pub fn interfaces(media: &[Medium], dimension: Dimension, diameter: f64, constants: Constants) -> Vec<Interface> {
    let pairs = (0..media.len()).flat_map(|a| (a + 1..media.len()).map(move |b| [a, b]));
    pairs.map(|pair| Interface::new(media, pair, dimension, diameter, constants)).collect()
}

fn within(value: f64, wanted: f64, tolerance: f64) -> bool {
    (value - wanted).abs() <= tolerance * wanted
}

/// Indices of the media whose wave-speed bound is `speed` (m/s) within the relative `tolerance`, lightest first.
pub fn find_speed(
    media: &[Medium],
    speed: f64,
    tolerance: f64,
    dimension: Dimension,
    constants: Constants,
) -> Vec<usize> {
    // Any diameter would do: the speed does not depend on it.
    let reaches = |medium: &Medium| within(medium.bound(dimension, 1e-2, constants).speed, speed, tolerance);
    let mut found: Vec<usize> = (0..media.len()).filter(|&k| reaches(&media[k])).collect();
    found.sort_by(|&a, &b| media[a].density().total_cmp(&media[b].density()));
    found
}

/// The interfaces whose speed ratio V_fast/V_slow is `ratio` within the relative `tolerance`, lightest first.
pub fn find_ratio(mut interfaces: Vec<Interface>, ratio: f64, tolerance: f64) -> Vec<Interface> {
    interfaces.retain(|interface| within(interface.speed_ratio, ratio, tolerance));
    interfaces.sort_by(|a, b| a.density.total_cmp(&b.density));
    interfaces
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::library;

    /// Burgoyne 2016, section 4.3: a chain at 629 m/s is the dimer of aluminium and tungsten carbide.
    #[test]
    fn the_published_dimer_is_found_by_its_speed() {
        let media = Medium::all(&library());
        assert_eq!(media.len(), 15);
        let found = find_speed(&media, 629.0, 0.02, Dimension::One, Constants::Code);
        assert_eq!(found.iter().map(|&k| media[k].label.as_str()).collect::<Vec<_>>(), ["al+wc"]);
        let wide = find_speed(&media, 800.0, 0.25, Dimension::One, Constants::Code);
        assert!(wide.len() > 5 && wide.windows(2).all(|w| media[w[0]].density() <= media[w[1]].density()));
    }

    /// The lens of Burgoyne 2016, section 5.3.3: 440c and brass, a ratio of 1344.7/791.1 = 1.70 and 36 degrees.
    #[test]
    fn the_lens_pair_is_found_by_its_ratio() {
        let media: Vec<Medium> = library().iter().map(Medium::uniform).collect();
        let all = interfaces(&media, Dimension::Two, 6.35e-3, Constants::Code);
        assert_eq!(all.len(), 10);
        assert!(all.iter().all(|i| i.speed_ratio >= 1.0 && i.speeds[0] >= i.speeds[1]));
        let found = find_ratio(all, 1.7, 0.005);
        let lens = found.iter().find(|i| i.media.map(|k| media[k].label.as_str()) == ["440c", "brass"]).unwrap();
        assert!((lens.speed_ratio - 1344.7 / 791.1).abs() < 2e-4);
        assert!((lens.critical_angle.unwrap().to_degrees() - 36.04).abs() < 0.01);
        assert!((lens.impedance_ratio - 1344.7 * 7650.0 / (791.1 * 8530.0)).abs() < 2e-4);
        // The contact of the two yields as its softer partner does, on a stiffer one.
        assert!(lens.interface_force < lens.plastic_forces[0]);
    }
}
