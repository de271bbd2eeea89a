//! What goes on inside a lens, as it is stored: its force network at the moment of focus, and how its crystal has moved once all is over.

use serde::{Deserialize, Serialize};

use crate::network::{ANGLE, Branch, Carrier, Chains, Contact, Fabric, Network, Part, Topology};

/// Inside the whole sheet, both halves, which repeats itself across.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Inside {
    /// When the spheres of the focal regions have most kinetic energy, of the moments that were looked at (s).
    #[serde(rename = "moment_s")]
    pub moment: f64,
    /// Until when the spheres were followed (s).
    #[serde(rename = "until_s")]
    pub until: f64,
    /// After which the sheet repeats itself across (m).
    #[serde(rename = "period_m")]
    pub period: f64,
    /// The site of each sphere, and whether it is the site's image on the other side of the axis.
    pub spheres: Vec<(u32, bool)>,
    /// Where each sphere is at the moment (m): across and depth.
    #[serde(rename = "places_m")]
    pub places: Vec<[f64; 2]>,
    /// Its closed contacts.
    pub contacts: Vec<Touch>,
    /// Parts of the sheet, each measured by its own mean force.
    pub parts: Vec<PartOfNetwork>,
    /// D²_min of each site from rest to the end, within 2.5 diameters (m²); none with fewer than three neighbours, empty where the sheet is too
    /// narrow for such a neighbourhood.
    #[serde(rename = "d2min_m2")]
    pub d2min: Vec<Option<f64>>,
}

/// A closed contact: numbers of two spheres, normal and tangential force (N).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Touch(pub u32, pub u32, pub f64, pub f64);

/// The force network of some rows.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PartOfNetwork {
    /// `before the lens`, `in it` or `behind it`.
    pub name: String,
    /// First and last row.
    pub rows: [u32; 2],
    /// Spheres that touch another one of them.
    pub touching: usize,
    /// Contacts of one of these.
    pub coordination: f64,
    /// Mean normal force (N).
    #[serde(rename = "mean_force_N")]
    pub mean_force: f64,
    /// Greatest normal force over the mean.
    pub greatest: f64,
    /// Components above the mean force.
    pub components: usize,
    /// Loops above the mean force.
    pub loops: usize,
    /// Total persistence of loops, in multiples of the mean.
    pub persistence_of_loops: f64,
    /// Share of the touching spheres that are in force chains.
    pub in_chains: f64,
    /// Virial along the blow over that across it; none where nothing presses across.
    pub along_over_across: Option<f64>,
}

impl Inside {
    /// The force network of the spheres in some rows; `rows` gives the row of each site. None of a sheet so narrow that two spheres touch over both
    /// sides.
    pub fn network(&self, rows: &[u32], [first, last]: [u32; 2]) -> Option<Network> {
        let row = |i: u32| rows[self.spheres[i as usize].0 as usize];
        let within = |touch: &&Touch| [touch.0, touch.1].into_iter().all(|i| (first..=last).contains(&row(i)));
        let (contacts, branches) = self
            .contacts
            .iter()
            .filter(within)
            .map(|&Touch(i, k, normal, tangential)| {
                let [from, to] = [i, k].map(|i| self.places[i as usize]);
                (Contact { grains: [i, k], normal, tangential }, Branch::between(from, to, Some(self.period)))
            })
            .unzip();
        Network::new(self.spheres.len(), contacts, Some(branches)).ok()
    }

    /// Measures of the network in some rows; none where nothing presses there.
    pub fn measure(&self, name: &str, rows: &[u32], span: [u32; 2]) -> Option<PartOfNetwork> {
        let network = self.network(rows, span)?;
        let topology = Topology::new(&network, Carrier::Contacts, Part::Normal, vec![1.0])?;
        let chains = Chains::new(&network, ANGLE)?;
        let virial = Fabric::new(&network).virial?;
        let mut touches = vec![false; network.grains()];
        network.contacts().iter().flat_map(|contact| contact.grains).for_each(|i| touches[i as usize] = true);
        let touching = touches.into_iter().filter(|touches| *touches).count();
        if touching == 0 {
            return None;
        }
        let most = network.contacts().iter().map(|contact| contact.normal.abs()).fold(0.0, f64::max);
        Some(PartOfNetwork {
            name: name.to_owned(),
            rows: span,
            touching,
            coordination: 2.0 * network.contacts().len() as f64 / touching as f64,
            mean_force: topology.mean_force,
            greatest: most / topology.mean_force,
            components: topology.components[0],
            loops: topology.loops[0],
            persistence_of_loops: Topology::total_persistence(&topology.persistence1),
            in_chains: chains.chains.iter().map(Vec::len).sum::<usize>() as f64 / touching as f64,
            along_over_across: (virial[0][0] > 0.0).then(|| virial[1][1] / virial[0][0]),
        })
    }
}
