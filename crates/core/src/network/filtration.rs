//! The superlevel filtration of a network: as a threshold sinks, contacts and grains enter and components merge.

use super::{Carrier, Network, Part, loops};

/// The part of a force range over which a component or loop is there: from `birth` down to `death`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bar {
    /// The force at which it appears as the threshold sinks.
    pub birth: f64,
    /// The force at which it vanishes: a component in an older one, a loop as its last triangle is filled. None if never.
    pub death: Option<f64>,
}

/// A contact of the filtration, and the value at which it enters.
#[derive(Clone, Copy, Debug)]
pub(super) struct Edge {
    pub ends: [u32; 2],
    pub value: f64,
}

/// A network in the order in which it enters.
#[derive(Clone, Debug)]
pub struct Filtration {
    /// The contacts, strongest first.
    pub(super) edges: Vec<Edge>,
    /// Values of the grains that have contacts, strongest first.
    grains: Vec<f64>,
    components: Vec<Bar>,
    /// Of each edge whether it joins two components; each of the others closes a loop.
    joins: Vec<bool>,
    /// Number of the network's grains.
    count: usize,
}

impl Filtration {
    /// Of a network by one kind of force. Grains without contacts are not in it.
    pub fn new(network: &Network, carrier: Carrier, part: Part) -> Self {
        const NONE: f64 = f64::NEG_INFINITY;
        let mut grain = vec![NONE; network.grains()];
        let ends = || network.contacts().iter().map(|contact| contact.grains);
        let mut edges: Vec<Edge> = match carrier {
            Carrier::Contacts => network
                .contacts()
                .iter()
                .map(|contact| Edge { ends: contact.grains, value: contact.size(part) })
                .inspect(|edge| {
                    for &i in &edge.ends {
                        grain[i as usize] = grain[i as usize].max(edge.value);
                    }
                })
                .collect(),
            Carrier::Particles => {
                let sums = network.grain_forces(part);
                ends().flatten().for_each(|i| grain[i as usize] = sums[i as usize]);
                ends().map(|ends| Edge { ends, value: sums[ends[0] as usize].min(sums[ends[1] as usize]) }).collect()
            }
        };
        // Equal values in the order given: bars of length zero are left out, and of the others none depends on it.
        edges.sort_by(|a, b| b.value.total_cmp(&a.value));
        let (components, joins) = components(&grain, &edges);
        let count = grain.len();
        grain.retain(|&value| value != NONE);
        grain.sort_unstable_by(|a, b| b.total_cmp(a));
        Self { edges, grains: grain, components, joins, count }
    }

    /// Components, each with the range over which it is there; those of length zero are left out.
    pub fn components(&self) -> &[Bar] {
        &self.components
    }

    /// Loops of the network with every three grains that touch each other filled, each with the range over which it is there;
    /// those of length zero are left out.
    pub fn loops(&self) -> Vec<Bar> {
        loops::bars(self.count, &self.edges, &self.joins)
    }

    /// Number of contacts above a force.
    pub fn contacts_above(&self, force: f64) -> usize {
        self.edges.partition_point(|edge| edge.value > force)
    }

    /// Number of grains above a force.
    pub fn grains_above(&self, force: f64) -> usize {
        self.grains.partition_point(|&value| value > force)
    }
}

/// Components by union-find: of two that meet, the younger ends (the elder rule).
fn components(grain: &[f64], edges: &[Edge]) -> (Vec<Bar>, Vec<bool>) {
    let mut parent: Vec<u32> = (0..grain.len() as u32).collect();
    // A root is the first of its component to enter, so that its own value is the component's.
    let birth = grain;
    let mut bars = Vec::new();
    let joins = edges
        .iter()
        .map(|&Edge { ends, value }| {
            let [a, b] = ends.map(|end| root(&mut parent, end));
            if a == b {
                return false;
            }
            let (elder, younger) = if birth[a as usize] >= birth[b as usize] { (a, b) } else { (b, a) };
            if birth[younger as usize] > value {
                bars.push(Bar { birth: birth[younger as usize], death: Some(value) });
            }
            parent[younger as usize] = elder;
            true
        })
        .collect();
    let last = (0..grain.len()).filter(|&i| parent[i] == i as u32 && birth[i] > f64::NEG_INFINITY);
    bars.extend(last.map(|i| Bar { birth: birth[i], death: None }));
    sort(&mut bars);
    (bars, joins)
}

/// The root of a component; every second link on the way is shortened.
fn root(parent: &mut [u32], mut i: u32) -> u32 {
    while parent[i as usize] != i {
        parent[i as usize] = parent[parent[i as usize] as usize];
        i = parent[i as usize];
    }
    i
}

/// Greatest birth first; of equal ones the longest first.
pub(super) fn sort(bars: &mut [Bar]) {
    let death = |bar: &Bar| bar.death.unwrap_or(f64::NEG_INFINITY);
    bars.sort_unstable_by(|a, b| b.birth.total_cmp(&a.birth).then(death(a).total_cmp(&death(b))));
}
