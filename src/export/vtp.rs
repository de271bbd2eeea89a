//! VTK PolyData for ParaView: spheres as points, contacts as lines, and the collection that says which file is which time.

use std::fmt::{Display, Write as _};

use super::in_space;
use crate::bed::{Frame, FrameBody, FrameContact};
use crate::dem::rig::{Body, Simulation};
use crate::network::Branch;

/// A named array: name, components, numbers.
type Array<'a> = (&'a str, usize, Vec<f64>);

/// The spheres at present as points. SI. Show them as glyphs of type sphere, scaled by `radius` with factor 2.
pub fn spheres<const D: usize>(simulation: &Simulation<D>) -> String {
    let (rig, view) = (simulation.rig(), simulation.view());
    let spheres = &rig.sample.spheres;
    let vectors = |of: &dyn Fn(usize) -> [f64; D]| (0..spheres.len()).flat_map(|k| in_space(of(k))).collect::<Vec<_>>();
    let each = |of: &dyn Fn(usize) -> f64| (0..spheres.len()).map(of).collect::<Vec<_>>();
    let square = |v: [f64; D]| v.iter().map(|x| x * x).sum::<f64>();
    let arrays = [
        ("radius", 1, each(&|k| spheres[k].radius)),
        ("material", 1, each(&|k| spheres[k].material as f64)),
        ("velocity", 3, vectors(&|k| view.velocity(k))),
        ("displacement", 3, vectors(&|k| view.displacement(k))),
        ("net_force", 3, vectors(&|k| view.net_force(k))),
        ("kinetic_energy", 1, each(&|k| 0.5 * rig.mass[k] * square(view.velocity(k)))),
        ("dissipated", 1, simulation.dissipated()),
    ];
    poly_data(&vectors(&|k| view.position(k)), "Verts", 1, &arrays, &[])
}

/// The closed contacts at present as lines from centre to centre, or to the face that a sphere touches. SI.
///
/// Over a periodic side a line goes on from the first sphere to the image of the second.
pub fn contacts<const D: usize>(simulation: &Simulation<D>) -> String {
    let (rig, view) = (simulation.rig(), simulation.view());
    let radius = |body: Body| match body {
        Body::Sphere(k) => rig.sample.spheres[k].radius,
        Body::Flat(_) => 0.0,
    };
    let mut points = Vec::new();
    let (mut force, mut stored, mut dissipated, mut overlap) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for contact in view.contacts() {
        // A flat never comes alone: one of the two is a sphere.
        let [first, second] = contact.bodies;
        let (sphere, sign) = match (first, second) {
            (Body::Sphere(k), _) => (k, 1.0),
            (_, Body::Sphere(k)) => (k, -1.0),
            _ => continue,
        };
        let flat = matches!(first, Body::Flat(_)) || matches!(second, Body::Flat(_));
        let reach = if flat {
            radius(Body::Sphere(sphere)) - contact.overlap
        } else {
            radius(first) + radius(second) - contact.overlap
        };
        let from = view.position(sphere);
        let to: [f64; D] = std::array::from_fn(|k| from[k] + sign * reach * contact.normal[k]);
        points.extend(in_space(from));
        points.extend(in_space(to));
        force.push(contact.force);
        stored.push(contact.stored);
        dissipated.push(contact.dissipated);
        overlap.push(contact.overlap);
    }
    let arrays = [("force", 1, force), ("stored", 1, stored), ("dissipated", 1, dissipated), ("overlap", 1, overlap)];
    poly_data(&points, "Lines", 2, &[], &arrays)
}

/// The bodies of a bed as points, in the units of beds; `kind` is 0 for grains, 1 for walls, 2 for the intruder.
pub fn bed_bodies(frame: &Frame) -> String {
    let vectors = |of: &dyn Fn(&FrameBody) -> [f64; 2]| frame.bodies.iter().flat_map(|b| in_space(of(b))).collect();
    let each = |of: &dyn Fn(&FrameBody) -> f64| frame.bodies.iter().map(of).collect::<Vec<f64>>();
    let places: Vec<f64> = vectors(&|body| body.place);
    let arrays = [
        ("radius", 1, each(&|body| 0.5 * body.diameter)),
        ("kind", 1, each(&|body| f64::from(body.role as u8))),
        ("velocity", 3, vectors(&|body| body.velocity)),
        ("spin", 1, each(&|body| body.spin)),
        ("net_force", 3, vectors(&|body| body.force)),
    ];
    poly_data(&places, "Verts", 1, &arrays, &[])
}

/// The closed contacts of a bed as lines from centre to centre, in the units of beds; over a periodic side a line goes on to the
/// image.
pub fn bed_contacts(frame: &Frame) -> String {
    let mut points = Vec::new();
    for &FrameContact { places: [from, to], .. } in &frame.contacts {
        let Branch { from, vector } = Branch::between(from, to, frame.period);
        points.extend(in_space(from));
        points.extend(in_space([from[0] + vector[0], from[1] + vector[1]]));
    }
    let normal = frame.contacts.iter().map(|contact| contact.normal).collect();
    let tangential = frame.contacts.iter().map(|contact| contact.tangential).collect();
    poly_data(&points, "Lines", 2, &[], &[("normal_force", 1, normal), ("tangential_force", 1, tangential)])
}

/// A collection of files over time, for the file name ending in `.pvd`: time (s) and file name of each.
pub fn collection(files: &[(f64, String)]) -> String {
    let mut text = String::from(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n<Collection>\n",
    );
    for (time, file) in files {
        let _ = writeln!(text, "<DataSet timestep=\"{time:e}\" part=\"0\" file=\"{file}\"/>");
    }
    text.push_str("</Collection>\n</VTKFile>\n");
    text
}

/// Points (three coordinates each) with cells of so many points one after another.
fn poly_data(points: &[f64], cells: &str, size: usize, of_points: &[Array], of_cells: &[Array]) -> String {
    let (count, cell_count) = (points.len() / 3, points.len() / 3 / size);
    let number = |name: &str| if name == cells { cell_count } else { 0 };
    let mut text = format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"0.1\" byte_order=\"LittleEndian\">\n<PolyData>\n\
         <Piece NumberOfPoints=\"{count}\" NumberOfVerts=\"{}\" NumberOfLines=\"{}\" NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n",
        number("Verts"),
        number("Lines")
    );
    let arrays = |text: &mut String, section: &str, list: &[Array]| {
        let _ = writeln!(text, "<{section}>");
        for (name, components, numbers) in list {
            array(text, "Float64", name, *components, numbers.iter().map(|x| Exact(*x)));
        }
        let _ = writeln!(text, "</{section}>");
    };
    arrays(&mut text, "PointData", of_points);
    arrays(&mut text, "CellData", of_cells);
    text.push_str("<Points>\n");
    array(&mut text, "Float64", "points", 3, points.iter().map(|x| Exact(*x)));
    let _ = writeln!(text, "</Points>\n<{cells}>");
    array(&mut text, "Int64", "connectivity", 1, 0..count);
    array(&mut text, "Int64", "offsets", 1, (1..=cell_count).map(|k| k * size));
    let _ = writeln!(text, "</{cells}>\n</Piece>\n</PolyData>\n</VTKFile>");
    text
}

/// A number with all its digits.
struct Exact(f64);

impl Display for Exact {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{:e}", self.0)
    }
}

fn array(text: &mut String, kind: &str, name: &str, components: usize, numbers: impl Iterator<Item = impl Display>) {
    let _ = write!(
        text,
        "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" format=\"ascii\">"
    );
    for (k, number) in numbers.enumerate() {
        let _ = write!(text, "{}{number}", if k % (4 * components) == 0 { "\n" } else { " " });
    }
    text.push_str("\n</DataArray>\n");
}
