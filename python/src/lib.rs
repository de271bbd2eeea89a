//! The native part of the Python package `granulens`: arrays and dicts in, arrays and dicts out. Classes with a face for notebooks, pictures
//! on an axis and engines are Python, beside it.
//!
//! - `failure`: errors with the words of the command line; `running`: long calls without the interpreter's lock, and Ctrl-C
//! - `values`: arrays, tables and nested results
//! - `material`: materials, contacts and wave speeds; `surface`: design surfaces
//! - `design`: designs, lenses, layouts; `evaluate`: layouts to scores; `simulate`: one impact with its records
//! - `rig`, `bed`: anything a lab can build, and granular beds; `frames`: all of it at moments; `inside`: force networks and motion
//! - `robust`: how scores change with every sphere, and what pieces as made are worth
//! - `study`: searches, here or on an engine

mod bed;
mod design;
mod evaluate;
mod failure;
mod frames;
mod inside;
mod material;
mod rig;
mod robust;
mod running;
mod simulate;
mod space;
mod study;
mod surface;
mod values;

use pyo3::prelude::pymodule;

#[pymodule]
mod _granulens {
    #[pymodule_export]
    use super::bed::{Bed, Packing};
    #[pymodule_export]
    use super::design::{Design, Layout, Lens, merge_text};
    #[pymodule_export]
    use super::evaluate::Evaluator;
    #[pymodule_export]
    use super::frames::read_frames;
    #[pymodule_export]
    use super::inside::{motion, network};
    #[pymodule_export]
    use super::material::{Material, collide, contact, contact_path, find_material, materials, wave_speed};
    #[pymodule_export]
    use super::rig::Rig;
    #[pymodule_export]
    use super::robust::{sensitivity, tolerance};
    #[pymodule_export]
    use super::simulate::simulate;
    #[pymodule_export]
    use super::space::{SpaceDesign, SpaceLayout};
    #[pymodule_export]
    use super::study::{Study, evaluate_lines};
    #[pymodule_export]
    use super::surface::surface;
    use pyo3::prelude::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", granulens::outcome::VERSION)?;
        module.add("__commit__", granulens::outcome::COMMIT)
    }
}
