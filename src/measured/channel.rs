//! What a column of measurements means in a rig: the same quantity under the same name as in the records of `simulate`.

use crate::dem::rig::View;
use crate::setup::PreparedRig;

/// One scalar of a running rig.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channel {
    /// Of a flat along its normal: how far it has moved (0), its velocity (1), what presses on it (2).
    Flat(usize, u8),
    /// Of a bar: the velocity of its end (0), the force at it (1).
    Bar(usize, u8),
    /// Mean velocity along the wave of a layer, by its number from 1.
    Layer(u32),
    /// Of a sphere along an axis: displacement (0), velocity (1), net contact force on the whole of it (2).
    Sphere(usize, usize, u8),
}

const FLAT: [&str; 3] = ["_moved_m", "_velocity_m_s", "_force_N"];
const BAR: [&str; 2] = ["_velocity_m_s", "_force_N"];
/// Before and behind the letter of the axis.
const SPHERE: [[&str; 2]; 3] = [["u", "_m"], ["v", "_m_s"], ["F", "_N"]];

impl Channel {
    /// The channel of a name, such as `bar_force_N` of a flat called `bar`, `bar_1_force_N`, `layer_5_m_s` or `sphere_5_3_vz_m_s` (layer 5,
    /// column 3).
    ///
    /// # Errors
    /// Words that say what names there are in this rig.
    pub fn find<const D: usize>(name: &str, prepared: &PreparedRig<D>) -> Result<Self, String> {
        let rig = &prepared.rig;
        for (k, flat) in rig.flats.iter().enumerate() {
            let what =
                name.strip_prefix(flat.name.as_str()).and_then(|end| FLAT.iter().position(|known| *known == end));
            if let Some(what) = what {
                return Ok(Self::Flat(k, what as u8));
            }
        }
        for k in 0..rig.bars.len() {
            let end = name.strip_prefix(&format!("bar_{}", k + 1));
            if let Some(what) = end.and_then(|end| BAR.iter().position(|known| *known == end)) {
                return Ok(Self::Bar(k, what as u8));
            }
        }
        let layer = name.strip_prefix("layer_").and_then(|rest| rest.strip_suffix("_m_s"));
        let layer = layer.and_then(|layer| layer.parse().ok()).filter(|layer| (1..=prepared.layers).contains(layer));
        if let Some(layer) = layer {
            return Ok(Self::Layer(layer));
        }
        Self::sphere(name, prepared).ok_or_else(|| {
            let flats = rig.flats.iter().map(|flat| format!("{}_force_N", flat.name));
            let bars = (1..=rig.bars.len()).map(|k| format!("bar_{k}_force_N"));
            let others = [format!("layer_1_m_s to layer_{}_m_s", prepared.layers), "sphere_LAYER_COLUMN_vz_m_s".to_owned()];
            let known: Vec<String> = flats.chain(bars).chain(others).collect();
            format!(
                "\"{name}\" is no record of this rig; there are {} (also _velocity_m_s and _moved_m of flats, u_m and F_N of spheres)",
                known.join(", ")
            )
        })
    }

    fn sphere<const D: usize>(name: &str, prepared: &PreparedRig<D>) -> Option<Self> {
        let mut parts = name.strip_prefix("sphere_")?.splitn(3, '_');
        let [layer, column]: [u32; 2] = [parts.next()?.parse().ok()?, parts.next()?.parse().ok()?];
        let quantity = parts.next()?;
        let place = prepared.sites.iter().position(|site| [site.layer, site.column] == [layer, column])?;
        let axes = ["z", "xz", "xyz"][D - 1];
        let (what, axis) = SPHERE.iter().enumerate().find_map(|(what, [before, behind])| {
            let letter = quantity.strip_prefix(before)?.strip_suffix(behind)?;
            Some((what, axes.find(letter).filter(|_| letter.len() == 1)?))
        })?;
        Some(Self::Sphere(place, axis, what as u8))
    }

    /// Its value now.
    pub fn value<const D: usize>(self, view: &View<'_, D>, prepared: &PreparedRig<D>) -> f64 {
        let rig = &prepared.rig;
        match self {
            Self::Flat(k, what) => {
                let (state, normal) = (view.flat(k), rig.flats[k].normal);
                let along = |v: &[f64; D]| (0..D).map(|k| v[k] * normal[k]).sum::<f64>();
                match what {
                    0 => along(&state.moved),
                    1 => along(&state.velocity),
                    _ => -along(&state.force),
                }
            }
            Self::Bar(k, what) => {
                let bar = &rig.bars[k];
                let velocity = match bar.body {
                    crate::dem::rig::Body::Sphere(i) => view.velocity(i)[bar.axis],
                    crate::dem::rig::Body::Flat(k) => view.flat(k).velocity[bar.axis],
                };
                let incident = bar.incident.as_ref().map_or(0.0, |curve| curve.value(view.time()));
                if what == 0 { velocity } else { 2.0 * incident - bar.impedance * velocity }
            }
            Self::Layer(layer) => {
                let members = || (0..prepared.sites.len()).filter(|&i| prepared.sites[i].layer == layer);
                members().map(|i| view.velocity(i)[D - 1]).sum::<f64>() / (members().count() as f64).max(1.0)
            }
            Self::Sphere(i, axis, 0) => view.displacement(i)[axis],
            Self::Sphere(i, axis, 1) => view.velocity(i)[axis],
            Self::Sphere(i, axis, _) => view.whole_force(i)[axis],
        }
    }
}
