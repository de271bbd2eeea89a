//! Extended XYZ, as ASE and OVITO read it. The column `species` holds a chemical element, as ASE wants it: the one that a material of
//! the library has most of, X for others. The material itself stands by name in the column `material`.

use std::fmt::Write as _;

use super::{axis_in_space, ends, in_space};
use crate::bed::Frame;
use crate::dem::rig::Simulation;
use crate::material;

/// The present state as a frame; frames of a run stand one after another in a file. SI.
///
/// Columns: number, element, material, centre, velocity, radius, mass, net force of contacts, energy dissipated.
pub fn frame<const D: usize>(simulation: &Simulation<D>) -> String {
    let (rig, view) = (simulation.rig(), simulation.view());
    let spheres = &rig.sample.spheres;
    let mut ends = ends(rig);
    let mut repeats = ["F"; 3];
    for (axis, period) in rig.periods.iter().enumerate() {
        if let Some(period) = period {
            let k = axis_in_space::<D>(axis);
            let low = spheres.iter().map(|s| s.centre[axis]).fold(f64::INFINITY, f64::min);
            (ends[k], repeats[k]) = ([low, low + period], "T");
        }
    }
    let [a, b, c] = ends.map(|end| end[1] - end[0]);
    let mut text = format!(
        "{}\nLattice=\"{a:e} 0 0 0 {b:e} 0 0 0 {c:e}\" Origin=\"{:e} {:e} {:e}\" pbc=\"{}\" \
         Properties=id:I:1:species:S:1:material:S:1:pos:R:3:velo:R:3:radius:R:1:mass:R:1:force:R:3:dissipated:R:1 \
         Time={:e}\n",
        spheres.len(),
        ends[0][0],
        ends[1][0],
        ends[2][0],
        repeats.join(" "),
        view.time()
    );
    let dissipated = simulation.dissipated();
    for (k, sphere) in spheres.iter().enumerate() {
        // Words are separated by spaces; a material's name may hold one.
        let name = &rig.sample.materials[sphere.material].name;
        let _ = write!(text, "{} {} {}", k + 1, element(name), name.replace(char::is_whitespace, "_"));
        let numbers = [in_space(view.position(k)), in_space(view.velocity(k))].concat();
        let force = in_space(view.net_force(k));
        for number in numbers.iter().chain(&[sphere.radius, rig.mass[k]]).chain(&force).chain(&[dissipated[k]]) {
            let _ = write!(text, " {number:e}");
        }
        text.push('\n');
    }
    text
}

/// A frame of a bed, in the units of beds. Species are X, the symbol of no element, which every tool takes; what a body is stands
/// in the column `kind`.
pub fn bed_frame(frame: &Frame) -> String {
    let ends = |k: usize| {
        frame.bodies.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], body| {
            [low.min(body.place[k] - 0.5 * body.diameter), high.max(body.place[k] + 0.5 * body.diameter)]
        })
    };
    let ([mut left, right], [bottom, top]) = (ends(0), ends(1));
    let width = match frame.period {
        Some(period) => {
            left = 0.0;
            period
        }
        None => right - left,
    };
    let repeats = if frame.period.is_some() { "T F F" } else { "F F F" };
    let mut text = format!(
        "{}\nLattice=\"{width:e} 0 0 0 {:e} 0 0 0 1\" Origin=\"{left:e} {bottom:e} -0.5\" pbc=\"{repeats}\" \
         Properties=species:S:1:pos:R:3:velo:R:3:radius:R:1:spin:R:1:force:R:3:kind:S:1:id:I:1 Time={:e}\n",
        frame.bodies.len(),
        top - bottom,
        frame.time
    );
    for (k, body) in frame.bodies.iter().enumerate() {
        text.push('X');
        let numbers = [in_space(body.place), in_space(body.velocity)].concat();
        let rest = [0.5 * body.diameter, body.spin].into_iter().chain(in_space(body.force));
        for number in numbers.into_iter().chain(rest) {
            let _ = write!(text, " {number:e}");
        }
        let _ = writeln!(text, " {} {}", body.role.name(), k + 1);
    }
    text
}

/// The chemical element that a material of the library has most of; X, which stands for none, for others.
fn element(material: &str) -> &'static str {
    match material::canonical(material) {
        Some("stainless-440c" | "stainless-302") => "Fe",
        Some("aluminium-2017") => "Al",
        Some("brass-260") => "Cu",
        Some("tungsten-carbide") => "W",
        _ => "X",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_material_of_the_library_has_its_element() {
        for material in material::library() {
            assert_ne!(element(&material.name), "X", "{}", material.name);
        }
        assert_eq!(element("my-steel"), "X");
    }
}
