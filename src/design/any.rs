//! `lens.material = "any"`, or a list: the material whose lens serves the target best by rays.

use crate::contact::Constants;
use crate::lattice::HexagonalSheet;
use crate::lens::{LensRequest, propose};
use crate::material::Material;
use crate::target::Target;

/// The request with the best of some materials, and what was found of each, in words. A lens that gathers is the better the more of
/// the struck width its rays send to the focus, a shield the less they send past what is protected; of equals the first is taken, and
/// where none serves the target the first too, so that it is told why.
pub(super) fn best(
    request: LensRequest,
    materials: &[Material],
    lattice: &HexagonalSheet,
    host: &Material,
    target: &Target,
    constants: Constants,
) -> (LensRequest, Option<String>) {
    if materials.len() < 2 {
        return (request, None);
    }
    let shield = request.family.spares();
    let asked = |material: &Material| LensRequest { material: material.clone(), ..request.clone() };
    let value = |material: &Material| {
        let lens = propose(lattice, host, &asked(material), target, constants).ok()?;
        Some(if shield { lens.protected[0] } else { lens.fraction })
    };
    let found: Vec<Option<f64>> = materials.iter().map(value).collect();
    let better = |a: f64, b: f64| if shield { a < b } else { a > b };
    let mut best = None;
    for (k, value) in found.iter().enumerate() {
        if let Some(value) = *value
            && best.is_none_or(|(_, least)| better(value, least))
        {
            best = Some((k, value));
        }
    }
    let taken = &materials[best.map_or(0, |(k, _)| k)];
    let told = |(material, value): (&Material, &Option<f64>)| match value {
        Some(value) => format!("{} {:.1} %", material.name, 100.0 * value),
        None => format!("{} none", material.name),
    };
    let all: Vec<String> = materials.iter().zip(&found).map(told).collect();
    let goal = if shield { "past what is protected" } else { "to the focus" };
    let note =
        format!("lens.material: {} is taken; of the struck width rays send {goal}: {}", taken.name, all.join(", "));
    (asked(taken), Some(note))
}
