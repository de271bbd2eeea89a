use granulens_core::network::{Bar, Carrier, Filtration, Part, Topology};

use super::{network, random};

/// Persistence in dimension 1 as the books define it: the boundary matrix of all simplices in order of entrance, reduced column
/// by column over Z₂.
fn by_the_book(contacts: &[(u32, u32, f64, f64)], carrier: Carrier) -> Vec<Vec<Bar>> {
    let grains = contacts.iter().map(|c| c.0.max(c.1) + 1).max().unwrap();
    let mut value = vec![f64::NEG_INFINITY; grains as usize];
    for &(a, b, force, _) in contacts {
        for i in [a, b] {
            let known = &mut value[i as usize];
            *known = if carrier == Carrier::Contacts { known.max(force) } else { known.max(0.0) + force };
        }
    }
    let of_edge = |&(a, b, force, _): &(u32, u32, f64, f64)| match carrier {
        Carrier::Contacts => force,
        Carrier::Particles => value[a as usize].min(value[b as usize]),
    };
    let mut simplices: Vec<(Vec<u32>, f64)> = Vec::new();
    simplices.extend((0..grains).filter(|&i| value[i as usize] >= 0.0).map(|i| (vec![i], value[i as usize])));
    simplices.extend(contacts.iter().map(|c| (vec![c.0.min(c.1), c.0.max(c.1)], of_edge(c))));
    let edge = |a: u32, b: u32| contacts.iter().find(|c| (c.0.min(c.1), c.0.max(c.1)) == (a, b)).map(of_edge);
    for a in 0..grains {
        for b in a + 1..grains {
            for c in b + 1..grains {
                if let (Some(x), Some(y), Some(z)) = (edge(a, b), edge(b, c), edge(a, c)) {
                    simplices.push((vec![a, b, c], x.min(y).min(z)));
                }
            }
        }
    }
    simplices.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.len().cmp(&b.0.len())));
    let place = |simplex: &[u32]| simplices.iter().position(|(other, _)| other == simplex).unwrap();
    let mut columns: Vec<Vec<usize>> = Vec::new();
    let mut paired = vec![false; simplices.len()];
    let mut bars = vec![Vec::new(), Vec::new(), Vec::new()];
    for (n, (simplex, death)) in simplices.iter().enumerate() {
        let mut column: Vec<usize> = match simplex.len() {
            1 => Vec::new(),
            _ => (0..simplex.len())
                .map(|k| place(&simplex.iter().enumerate().filter(|x| x.0 != k).map(|x| *x.1).collect::<Vec<u32>>()))
                .collect(),
        };
        column.sort_unstable();
        while let Some(other) = column.last().and_then(|low| columns.iter().find(|other| other.last() == Some(low))) {
            let both = column.iter().chain(other).copied();
            let mut sum: Vec<usize> = both.filter(|x| column.contains(x) != other.contains(x)).collect();
            sum.sort_unstable();
            column = sum;
        }
        if let Some(&low) = column.last() {
            (paired[low], paired[n]) = (true, true);
            let birth = simplices[low].1;
            if birth > *death {
                bars[simplices[low].0.len() - 1].push(Bar { birth, death: Some(*death) });
            }
        }
        columns.push(column);
    }
    for (n, (simplex, birth)) in simplices.iter().enumerate() {
        if !paired[n] {
            bars[simplex.len() - 1].push(Bar { birth: *birth, death: None });
        }
    }
    let death = |bar: &Bar| bar.death.unwrap_or(f64::NEG_INFINITY);
    bars.iter_mut()
        .for_each(|bars| bars.sort_by(|a, b| b.birth.total_cmp(&a.birth).then(death(a).total_cmp(&death(b)))));
    bars
}

/// Forces are multiples of 1/levels, a power of two, so that sums are exact and bars agree to the last bit.
#[test]
fn bars_are_those_of_the_plain_reduction() {
    for seed in 0..60 {
        let (grains, rare, levels) = (8 + (seed % 14) as u32, 1 + seed % 5, [2, 8, 1024][seed as usize % 3]);
        let contacts = random(seed + 1, grains, rare, levels);
        if contacts.is_empty() {
            continue;
        }
        for carrier in [Carrier::Contacts, Carrier::Particles] {
            let filtration = Filtration::new(&network(&contacts), carrier, Part::Normal);
            let plain = by_the_book(&contacts, carrier);
            assert_eq!(filtration.components(), plain[0], "components, seed {seed}, {carrier:?}");
            assert_eq!(filtration.loops(), plain[1], "loops, seed {seed}, {carrier:?}");
        }
    }
}

/// Components, loops and holes at each threshold as counted anew from what is above it.
#[test]
fn counts_are_those_of_each_threshold_alone() {
    for seed in 0..40 {
        let contacts = random(seed + 1000, 18, 2 + seed % 6, [3, 1000][seed as usize % 2]);
        if contacts.is_empty() {
            continue;
        }
        let whole = network(&contacts);
        for carrier in [Carrier::Contacts, Carrier::Particles] {
            for part in [Part::Normal, Part::Tangential] {
                let thresholds = vec![0.0, 0.3, 0.7, 1.0, 1.0 + 1e-9, 1.6, 2.5, 40.0];
                let topology = Topology::new(&whole, carrier, part, thresholds.clone()).unwrap();
                let sums = whole.grain_forces(part);
                for (k, threshold) in thresholds.iter().enumerate() {
                    let force = threshold * topology.mean_force;
                    let size = |c: &&(u32, u32, f64, f64)| if part == Part::Normal { c.2.abs() } else { c.3.abs() };
                    let there = |i: u32| sums[i as usize] > force;
                    let left: Vec<(u32, u32, f64, f64)> = contacts
                        .iter()
                        .filter(|c| match carrier {
                            Carrier::Contacts => size(c) > force,
                            Carrier::Particles => there(c.0) && there(c.1),
                        })
                        .map(|c| (c.0, c.1, 1.0, 1.0))
                        .collect();
                    // Grains that stand alone above the threshold are components too.
                    let mut named = [false; 18];
                    left.iter().for_each(|c| (named[c.0 as usize], named[c.1 as usize]) = (true, true));
                    let alone = match carrier {
                        Carrier::Contacts => 0,
                        Carrier::Particles => (0..whole.grains()).filter(|&i| there(i as u32) && !named[i]).count(),
                    };
                    let (components, loops, holes) = match left.is_empty() {
                        true => (0, 0, 0),
                        false => {
                            let plain = by_the_book(&left, Carrier::Contacts);
                            let never = |n: usize| plain[n].iter().filter(|bar| bar.death.is_none()).count();
                            let grains = named.iter().filter(|&&on| on).count();
                            (never(0), left.len() + never(0) - grains, never(1))
                        }
                    };
                    let said = format!("seed {seed}, {carrier:?}, {part:?}, threshold {threshold}");
                    assert_eq!(topology.components[k], components + alone, "{said}");
                    assert_eq!(topology.loops[k], loops, "{said}");
                    assert_eq!(topology.holes[k], holes, "{said}");
                }
            }
        }
    }
}
