//! A design surface: the wave-speed bound over stiffness and density, and where the library's metals lie on it.
//!
//!     cargo run --release --example surface

use granulens::contact::Constants;
use granulens::material::{find, library};
use granulens::wave::{Axis, Dimension, Medium, Setting, Surface, Value};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let setting = Setting {
        value: Value::Speed,
        against: None,
        material: find("440c", &[])?,
        stiffness: None,
        dimension: Dimension::Two,
        amplitude: None,
        diameter: 6.35e-3,
        constants: Constants::default(),
    };
    let axes = [Axis::Stiffness, Axis::Density];
    let surface = Surface::new(axes, [[2e6, 1e8], [1e3, 2e4]], [60, 40], &setting)?;
    if let Some([least, most]) = surface.range() {
        println!("from {least:.0} to {most:.0} m/s");
    }
    for material in library() {
        let medium = Medium::uniform(&material);
        if let Some(speed) = setting.value_of_medium(&medium) {
            let [k, rho] = axes.map(|axis| setting.place(&medium, axis));
            println!("{:<18} K {k:.3e} N/m, {rho:.0} kg/m3: {speed:.0} m/s", material.name);
        }
    }
    Ok(())
}
