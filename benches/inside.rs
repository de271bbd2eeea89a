//! All measures of one frame, one core: a hexagonal bed of 6000 and of 90 000 grains with forces drawn at random. Wanted: under 50 ms
//! and under a second.
//!
//!     cargo bench -p granulens-benches --bench inside

use std::hint::black_box;
use std::time::Instant;

use granulens::motion::{RADIUS, follow};
use granulens::network::{
    ANGLE, Branch, Carrier, Chains, Contact, Fabric, Network, Part, StressMap, Topology, default_thresholds,
};
use granulens::search::Rng;

/// A hexagonal bed, periodic across, so wide and high.
struct Bed {
    width: usize,
    places: Vec<[f64; 2]>,
    contacts: Vec<Contact>,
}

impl Bed {
    fn new(width: usize, height: usize) -> Self {
        let mut rng = Rng::new(1);
        let (mut places, mut contacts) = (Vec::new(), Vec::new());
        for row in 0..height {
            for column in 0..width {
                places.push([column as f64 + 0.5 * (row % 2) as f64, row as f64 * 0.75_f64.sqrt()]);
                let shift = row % 2;
                let above = [(column + width + shift - 1) % width, (column + shift) % width];
                let near = [(row, (column + 1) % width), (row + 1, above[0]), (row + 1, above[1])];
                for (other_row, other) in near.into_iter().filter(|(row, _)| *row < height) {
                    // As in a bed, a third of the neighbours do not touch, and forces are distributed exponentially.
                    if rng.unit() < 2.0 / 3.0 {
                        let grains = [(row * width + column) as u32, (other_row * width + other) as u32];
                        let normal = -(1.0 - rng.unit()).ln();
                        contacts.push(Contact { grains, normal, tangential: normal * (rng.unit() - 0.5) });
                    }
                }
            }
        }
        Self { width, places, contacts }
    }

    /// Everything that `network` and `motion` find, and how many numbers that is.
    fn measure(&self, after: &[[f64; 2]]) -> usize {
        let period = Some(self.width as f64);
        let branch = |contact: &Contact| {
            let [from, to] = contact.grains.map(|i| self.places[i as usize]);
            Branch::between(from, to, period)
        };
        let branches = self.contacts.iter().map(branch).collect();
        let network = Network::new(self.places.len(), self.contacts.clone(), Some(branches)).unwrap();
        let mut count = 0;
        for carrier in [Carrier::Contacts, Carrier::Particles] {
            let topology = Topology::new(&network, carrier, Part::Normal, default_thresholds()).unwrap();
            count += topology.persistence0.len() + topology.persistence1.len();
        }
        count += Chains::new(&network, ANGLE).unwrap().chains.len();
        count += Fabric::new(&network).rattlers.len();
        count += StressMap::new(&network, 2.0, period).unwrap().cells.len();
        count + follow(&self.places, after, RADIUS, period).unwrap().len()
    }
}

fn main() {
    println!("grains   contacts   all measures (ms, best of 5)   wanted");
    for (width, height, wanted) in [(100, 60, 50.0), (300, 300, 1000.0)] {
        let bed = Bed::new(width, height);
        let mut rng = Rng::new(2);
        let after: Vec<[f64; 2]> = bed.places.iter().map(|p| p.map(|x| x + 0.1 * rng.unit())).collect();
        let once = || {
            let begun = Instant::now();
            black_box(bed.measure(&after));
            begun.elapsed().as_secs_f64() * 1e3
        };
        let best = (0..5).map(|_| once()).fold(f64::INFINITY, f64::min);
        println!("{:6} {:10} {best:20.1} {wanted:20.0}", bed.places.len(), bed.contacts.len());
    }
}
