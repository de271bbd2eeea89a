//! Frames for OVITO and ParaView, read back: the XML by a strict parser, XYZ by its own header.

use granulens::contact::LawKind;
use granulens::dem::rig::Simulation;
use granulens::export::{collection, contacts, frame, spheres};
use roxmltree::{Document, Node};

use crate::{rig, run};

fn simulation() -> Simulation<2> {
    run(rig(LawKind::Thesis), 1e-7, 400)
}

fn attribute<T: std::str::FromStr>(node: Node, name: &str) -> T {
    node.attribute(name).and_then(|text| text.parse().ok()).unwrap_or_else(|| panic!("{name} of {node:?}"))
}

/// The numbers of a named array, checked against its size.
fn array(piece: Node, section: &str, name: &str, count: usize) -> Vec<f64> {
    let section = piece.children().find(|node| node.has_tag_name(section)).unwrap();
    let array = section.children().find(|node| node.attribute("Name") == Some(name)).unwrap();
    assert_eq!(array.attribute("format"), Some("ascii"));
    let numbers: Vec<f64> = array.text().unwrap_or("").split_whitespace().map(|word| word.parse().unwrap()).collect();
    assert_eq!(numbers.len(), count * attribute::<usize>(array, "NumberOfComponents"), "{name}");
    numbers
}

fn piece<'a>(document: &'a Document) -> Node<'a, 'a> {
    let root = document.root_element();
    assert_eq!((root.tag_name().name(), root.attribute("type")), ("VTKFile", Some("PolyData")));
    root.descendants().find(|node| node.has_tag_name("Piece")).unwrap()
}

#[test]
fn spheres_are_read_back_to_the_bit() {
    let simulation = simulation();
    let text = spheres(&simulation);
    let document = Document::parse(&text).unwrap();
    let piece = piece(&document);
    let count = simulation.rig().sample.spheres.len();
    assert_eq!(attribute::<usize>(piece, "NumberOfPoints"), count);
    assert_eq!(attribute::<usize>(piece, "NumberOfVerts"), count);
    let places = array(piece, "Points", "points", count);
    let velocities = array(piece, "PointData", "velocity", count);
    let energies = array(piece, "PointData", "kinetic_energy", count);
    for k in 0..count {
        let (at, velocity) = (simulation.view().position(k), simulation.view().velocity(k));
        assert_eq!(places[3 * k..3 * k + 3], [at[0], at[1], 0.0]);
        assert_eq!(velocities[3 * k..3 * k + 3], [velocity[0], velocity[1], 0.0]);
    }
    let kinetic: f64 = energies.iter().sum();
    assert!((kinetic / simulation.ledger().kinetic - 1.0).abs() < 1e-12);
    assert_eq!(array(piece, "Verts", "offsets", count)[count - 1], count as f64);
    let radius = array(piece, "PointData", "radius", count);
    assert!(radius.iter().all(|&r| r == 0.5 * crate::DIAMETER));
}

/// Every line is as long as its spheres' distance, and what the lines dissipated is no more than the ledger's.
#[test]
fn contacts_are_lines_with_force_and_dissipation() {
    let simulation = simulation();
    let text = contacts(&simulation);
    let document = Document::parse(&text).unwrap();
    let piece = piece(&document);
    let lines: usize = attribute(piece, "NumberOfLines");
    assert_eq!(lines, simulation.view().contacts().count());
    assert!(lines > 50, "{lines} contacts are closed");
    let points = array(piece, "Points", "points", 2 * lines);
    let overlap = array(piece, "CellData", "overlap", lines);
    let force = array(piece, "CellData", "force", lines);
    for (k, contact) in simulation.view().contacts().enumerate() {
        let [a, b] = [&points[6 * k..6 * k + 3], &points[6 * k + 3..6 * k + 6]];
        let length = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt();
        assert!((length - (crate::DIAMETER - overlap[k])).abs() < 1e-15 * 10.0);
        assert_eq!(force[k], contact.force);
    }
    let dissipated: f64 = array(piece, "CellData", "dissipated", lines).iter().sum();
    assert!(dissipated > 0.0 && dissipated <= simulation.ledger().dissipated * (1.0 + 1e-12));
}

/// A line over the periodic side ends at the image: where the second sphere is, a period away.
#[test]
fn lines_over_the_periodic_side_do_not_cross_the_crystal() {
    let simulation = simulation();
    let text = contacts(&simulation);
    let document = Document::parse(&text).unwrap();
    let piece = piece(&document);
    let lines: usize = attribute(piece, "NumberOfLines");
    let points = array(piece, "Points", "points", 2 * lines);
    let period = simulation.rig().periods[0].unwrap();
    let (view, count) = (simulation.view(), simulation.rig().sample.spheres.len());
    let mut images = 0;
    for line in points.chunks(6) {
        // Its end lies at some sphere's centre, or a period beside it.
        let beside = |shift: f64| {
            (0..count).any(|k| {
                let at = view.position(k);
                (at[0] + shift - line[3]).hypot(at[1] - line[4]) < 1e-15 * 10.0
            })
        };
        if !beside(0.0) {
            assert!(beside(period) || beside(-period), "{line:?}");
            images += 1;
        }
    }
    assert!(images > 0);
}

#[test]
fn a_collection_names_its_files_by_time() {
    let text = collection(&[(0.0, "a-0.vtp".to_owned()), (5e-6, "a-1.vtp".to_owned())]);
    let document = Document::parse(&text).unwrap();
    let sets: Vec<_> = document.descendants().filter(|node| node.has_tag_name("DataSet")).collect();
    assert_eq!(sets.iter().map(|node| attribute::<f64>(*node, "timestep")).collect::<Vec<_>>(), [0.0, 5e-6]);
    assert_eq!(sets[1].attribute("file"), Some("a-1.vtp"));
}

/// The header's properties tell how many words a line has and what they are, as readers of extended XYZ take it.
#[test]
fn xyz_frames_are_what_their_header_says() {
    let simulation = simulation();
    let text = frame(&simulation);
    let mut lines = text.lines();
    let count: usize = lines.next().unwrap().parse().unwrap();
    assert_eq!(count, simulation.rig().sample.spheres.len());
    let header = lines.next().unwrap();
    let value = |key: &str| {
        let rest = header.split_once(&format!("{key}=")).unwrap().1;
        match rest.strip_prefix('"') {
            Some(quoted) => quoted.split('"').next().unwrap(),
            None => rest.split(' ').next().unwrap(),
        }
    };
    let lattice: Vec<f64> = value("Lattice").split(' ').map(|word| word.parse().unwrap()).collect();
    assert_eq!((lattice.len(), lattice[0]), (9, simulation.rig().periods[0].unwrap()));
    assert_eq!(value("pbc"), "T F F");
    assert_eq!(value("Time").parse::<f64>().unwrap(), simulation.time());
    let properties: Vec<&str> = value("Properties").split(':').collect();
    let mut columns = Vec::new();
    for property in properties.chunks(3) {
        let width: usize = property[2].parse().unwrap();
        columns.extend((0..width).map(|k| (property[0], property[1], k)));
    }
    let place = columns.iter().position(|column| *column == ("pos", "R", 0)).unwrap();
    let [species, material] = ["species", "material"]
        .map(|name| columns.iter().position(|column| column.0 == name && column.1 == "S").unwrap());
    for (k, line) in lines.by_ref().take(count).enumerate() {
        let words: Vec<&str> = line.split(' ').collect();
        assert_eq!(words.len(), columns.len());
        for (word, (name, kind, _)) in words.iter().zip(&columns) {
            match *kind {
                "R" => assert!(word.parse::<f64>().unwrap().is_finite(), "{name}"),
                "I" => assert_eq!(word.parse::<usize>().unwrap(), k + 1),
                _ => {}
            }
        }
        assert_eq!(words[place].parse::<f64>().unwrap(), simulation.view().position(k)[0]);
        let made_of = simulation.rig().sample.spheres[k].material;
        assert_eq!(words[material], ["stainless-440c", "brass-260"][made_of]);
        assert_eq!(words[species], ["Fe", "Cu"][made_of]);
    }
    assert_eq!(lines.next(), None);
}
