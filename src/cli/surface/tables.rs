//! What `granulens surface` lists, as tables and as JSON.

use std::fmt::Write as _;

use granulens::design::Shelf;
use granulens::wave::{DISSIPATED_AT, Interface, Medium, Point, Setting, Surface as Grid, dissipation};
use serde_json::{Value, json};

use super::super::Common;
use super::super::console::{emit, emit_json};
use super::super::failure::Failure;
use super::super::folder::write_json;
use super::price;

/// Lists pairs: speeds, their ratio, critical angle, impedance ratio, F_p.
pub fn pairs(common: &Common, media: &[Medium], pairs: &[Interface], setting: &Setting) -> Result<(), Failure> {
    let rows: Vec<Value> = pairs.iter().map(|pair| pair_json(media, pair)).collect();
    let numbers = json!({
        "format": granulens::outcome::FORMAT,
        "dimension": setting.dimension.number(),
        "diameter_m": setting.diameter,
        "constants": setting.constants.name(),
        "pairs": rows,
    });
    write_json(common, &numbers)?;
    if common.json {
        emit_json(&numbers);
        return Ok(());
    }
    let name = |k: usize| media[k].label.as_str();
    let wide = pairs.iter().flat_map(|p| p.media.map(|k| name(k).chars().count())).max().unwrap_or(0).max(6);
    let mut text = format!(
        "{:<wide$} {:<wide$} {:>7} {:>7} {:>6} {:>8} {:>7} {:>8} {:>8} {:>8} {:>8}\n\
         {:<wide$} {:<wide$} {:>7} {:>7} {:>6} {:>8} {:>7} {:>8} {:>8} {:>8} {:>8}\n",
        "faster",
        "slower",
        "V fast",
        "V slow",
        "ratio",
        "critical",
        "Z ratio",
        "F_p fast",
        "F_p slow",
        "F_p both",
        "density",
        "",
        "",
        "m/s",
        "m/s",
        "",
        "deg",
        "",
        "N",
        "N",
        "N",
        "kg/m3"
    );
    for pair in pairs {
        let critical = pair.critical_angle.map_or("-".to_owned(), |angle| format!("{:.1}", angle.to_degrees()));
        let ([fast, slow], [v, w], [f, g]) = (pair.media.map(name), pair.speeds, pair.plastic_forces);
        let _ = writeln!(
            text,
            "{fast:<wide$} {slow:<wide$} {v:>7.1} {w:>7.1} {:>6.3} {critical:>8} {:>7.3} {f:>8.0} {g:>8.0} {:>8.0} \
             {:>8.0}",
            pair.speed_ratio, pair.impedance_ratio, pair.interface_force, pair.density
        );
    }
    emit(&text);
    Ok(())
}

/// Lists media: density, stiffness, speed, impedance, F_p.
pub fn list(common: &Common, media: &[Medium], setting: &Setting, shelf: &Shelf) -> Result<(), Failure> {
    let bounds: Vec<_> =
        media.iter().map(|m| m.bound(setting.dimension, setting.diameter, setting.constants)).collect();
    let lost = |medium: &Medium| {
        let pair = medium.pair(setting.diameter, setting.constants);
        dissipation(&pair, setting.amplitude.unwrap_or(DISSIPATED_AT))
    };
    let core = |medium: &Medium| medium.core_force(setting.diameter, setting.constants);
    let rows: Vec<Value> = media
        .iter()
        .zip(&bounds)
        .map(|(medium, bound)| {
            json!({
                "name": medium.name, "label": medium.label, "kind": medium.kind.name(),
                "density_kg_m3": medium.density(), "stiffness_N_m": bound.stiffness, "speed_m_s": bound.speed,
                "impedance_kg_m2_s": medium.impedance(bound), "fully_plastic_force_N": bound.plastic_force,
                "shell_over_radius": medium.shell, "core_force_N": core(medium),
                "dissipation_J": lost(medium), "price_of_a_sphere": price(shelf, medium),
            })
        })
        .collect();
    let numbers = json!({
        "format": granulens::outcome::FORMAT,
        "dimension": setting.dimension.number(),
        "diameter_m": setting.diameter,
        "constants": setting.constants.name(),
        "media": rows,
    });
    write_json(common, &numbers)?;
    if common.json {
        emit_json(&numbers);
        return Ok(());
    }
    let wide = media.iter().map(|m| m.label.chars().count()).max().unwrap_or(0).max(6);
    let mut text = format!(
        "{:<wide$} {:<10} {:>8} {:>9} {:>8} {:>10} {:>8} {:>8}\n{:<wide$} {:<10} {:>8} {:>9} {:>8} {:>10} {:>8} {:>8}\n",
        "medium",
        "",
        "density",
        "stiffness",
        "V",
        "Z",
        "F_p",
        "E_lost",
        "",
        "",
        "kg/m3",
        "MN/m",
        "m/s",
        "Mkg/(m2 s)",
        "N",
        "mJ"
    );
    for (medium, bound) in media.iter().zip(&bounds) {
        let _ = write!(
            text,
            "{:<wide$} {:<10} {:>8.0} {:>9.3} {:>8.1} {:>10.3} {:>8.0} {:>8.0}",
            medium.label,
            medium.kind.name(),
            medium.density(),
            bound.stiffness / 1e6,
            bound.speed,
            medium.impedance(bound) / 1e6,
            bound.plastic_force,
            1e3 * lost(medium)
        );
        text.push_str(&match core(medium) {
            Some(core) if core < bound.plastic_force => {
                format!("  plasticity reaches the core at about {core:.0} N, below F_p: the bound is out of reach\n")
            }
            Some(core) => format!("  up to about {core:.0} N, where plasticity reaches the core\n"),
            None => "\n".to_owned(),
        });
    }
    let amplitude = setting.amplitude.unwrap_or(DISSIPATED_AT);
    let _ = writeln!(text, "\nE_lost: what a contact dissipates that is loaded once to {amplitude} F_p");
    emit(&text);
    Ok(())
}

fn pair_json(media: &[Medium], pair: &Interface) -> Value {
    let name = |k: usize| &media[k].name;
    json!({
        "faster": name(pair.media[0]), "slower": name(pair.media[1]),
        "speed_faster_m_s": pair.speeds[0], "speed_slower_m_s": pair.speeds[1], "speed_ratio": pair.speed_ratio,
        "critical_angle_deg": pair.critical_angle.map(f64::to_degrees), "impedance_ratio": pair.impedance_ratio,
        "fully_plastic_force_faster_N": pair.plastic_forces[0],
        "fully_plastic_force_slower_N": pair.plastic_forces[1],
        "fully_plastic_force_interface_N": pair.interface_force, "density_kg_m3": pair.density,
    })
}

/// The numbers of a picture.
pub fn grid_json(grid: &Grid, points: &[Point]) -> Value {
    let values = |k: usize| grid.nodes[k].iter().map(|node| node.value).collect::<Vec<_>>();
    let column = grid.setting.value.column();
    let points: Vec<Value> = points
        .iter()
        .map(|p| json!({ "label": p.label, "kind": p.kind.name(), "x": p.place[0], "y": p.place[1], column: p.value }))
        .collect();
    json!({
        "format": granulens::outcome::FORMAT,
        "x": { "axis": grid.axes[0].name(), "values": values(0) },
        "y": { "axis": grid.axes[1].name(), "values": values(1) },
        column: grid.values,
        "points": points,
    })
}
