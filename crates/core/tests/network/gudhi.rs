use std::path::PathBuf;

use granulens_core::network::{Bar, Carrier, Filtration, Part};
use serde_json::Value;

use super::network;

/// Bars of components and loops of discs, hexagonal sheets and graphs far from planar, on cylinders too and with few different
/// forces, are those of GUDHI: to rounding, as sums over the contacts of a grain may be added in another order there.
#[test]
fn bars_are_those_of_gudhi() {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/network/bars.json");
    let stored: Vec<Value> = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    assert!(stored.len() > 10);
    for of in &stored {
        let number = |value: &Value| value.as_f64().unwrap();
        let contacts: Vec<(u32, u32, f64, f64)> = of["contacts"]
            .as_array()
            .unwrap()
            .iter()
            .map(|c| (number(&c[0]) as u32, number(&c[1]) as u32, number(&c[2]), number(&c[3])))
            .collect();
        let network = network(&contacts);
        for (carrier, name) in [(Carrier::Contacts, "contacts"), (Carrier::Particles, "particles")] {
            for (part, word) in [(Part::Normal, "normal"), (Part::Tangential, "tangential")] {
                let filtration = Filtration::new(&network, carrier, part);
                let ours = [filtration.components().to_vec(), filtration.loops()];
                for (ours, theirs) in ours.iter().zip(of[format!("{name} {word}")].as_array().unwrap()) {
                    let theirs: Vec<Bar> = theirs
                        .as_array()
                        .unwrap()
                        .iter()
                        .map(|bar| Bar { birth: number(&bar[0]), death: bar[1].as_f64() })
                        // What rounding alone made: the sums of two grains that differ in their order.
                        .filter(|bar| bar.death.is_none_or(|death| bar.birth - death > 1e-12))
                        .collect();
                    let ours: Vec<&Bar> =
                        ours.iter().filter(|bar| bar.death.is_none_or(|death| bar.birth - death > 1e-12)).collect();
                    let said = format!("{} of {}, {name} {word}", ours.len(), of["name"]);
                    assert_eq!(ours.len(), theirs.len(), "{said}");
                    for theirs in theirs {
                        let same = |bar: &&&Bar| {
                            (bar.birth - theirs.birth).abs() < 1e-12
                                && bar.death.is_some() == theirs.death.is_some()
                                && (bar.death.unwrap_or(0.0) - theirs.death.unwrap_or(0.0)).abs() < 1e-12
                        };
                        assert!(ours.iter().any(|bar| same(&bar)), "{said}: {theirs:?}");
                    }
                }
            }
        }
    }
}
