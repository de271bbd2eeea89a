//! Components and loops as functions of the threshold, and their bars, in multiples of the mean normal force.

use super::{Bar, Carrier, Filtration, Network, Part};

/// Topology of a network.
#[derive(Clone, Debug, PartialEq)]
pub struct Topology {
    /// Mean normal force: over contacts, or over grains of the sum at each.
    pub mean_force: f64,
    /// Thresholds, in multiples of the mean.
    pub thresholds: Vec<f64>,
    /// Components above each threshold, B₀.
    pub components: Vec<usize>,
    /// Loops of the graph above each threshold: contacts − grains + components.
    pub loops: Vec<usize>,
    /// Loops above each threshold where every three grains that touch each other are filled: those around larger holes.
    pub holes: Vec<usize>,
    /// Bars of components, in multiples of the mean.
    pub persistence0: Vec<Bar>,
    /// Bars of loops of the filled network, in multiples of the mean.
    pub persistence1: Vec<Bar>,
}

/// From 0 to 5 by 0.05.
pub fn default_thresholds() -> Vec<f64> {
    (0..=100).map(|k| f64::from(k) / 20.0).collect()
}

impl Topology {
    /// Of a network by one kind of force, at thresholds that are multiples of the mean *normal* force. Above a threshold is what
    /// exceeds it. None where there are contacts but no normal force to measure by.
    pub fn new(network: &Network, carrier: Carrier, part: Part, thresholds: Vec<f64>) -> Option<Self> {
        let mean_force = network.mean(carrier);
        if mean_force == 0.0 && !network.contacts().is_empty() {
            return None;
        }
        let filtration = Filtration::new(network, carrier, part);
        let bars = filtration.loops();
        let alive = Alive::new(filtration.components());
        let around = Alive::new(&bars);
        let forces = || thresholds.iter().map(|threshold| threshold * mean_force);
        let components: Vec<usize> = forces().map(|force| alive.at(force)).collect();
        let loops = forces()
            .zip(&components)
            .map(|(force, components)| filtration.contacts_above(force) + components - filtration.grains_above(force))
            .collect();
        let holes = forces().map(|force| around.at(force)).collect();
        let multiples = |bars: &[Bar]| -> Vec<Bar> {
            let of =
                |bar: &Bar| Bar { birth: bar.birth / mean_force, death: bar.death.map(|death| death / mean_force) };
            bars.iter().map(of).collect()
        };
        let (persistence0, persistence1) = (multiples(filtration.components()), multiples(&bars));
        Some(Self { mean_force, thresholds, components, loops, holes, persistence0, persistence1 })
    }

    /// Sum of the lengths of bars; what never dies counts down to zero force (Kramár, Goullet, Kondic and Mischaikow,
    /// *Persistence of force networks in compressed granular media*, PRE 87, 042207, 2013).
    pub fn total_persistence(bars: &[Bar]) -> f64 {
        bars.iter().map(|bar| bar.birth - bar.death.unwrap_or(0.0)).sum()
    }
}

/// Births and deaths in order, to be counted.
struct Alive {
    births: Vec<f64>,
    deaths: Vec<f64>,
}

impl Alive {
    fn new(bars: &[Bar]) -> Self {
        let mut births: Vec<f64> = bars.iter().map(|bar| bar.birth).collect();
        let mut deaths: Vec<f64> = bars.iter().filter_map(|bar| bar.death).collect();
        births.sort_unstable_by(f64::total_cmp);
        deaths.sort_unstable_by(f64::total_cmp);
        Self { births, deaths }
    }

    /// How many are there above a force.
    fn at(&self, force: f64) -> usize {
        let above = |values: &[f64]| values.len() - values.partition_point(|&value| value <= force);
        above(&self.births) - above(&self.deaths)
    }
}
