//! What each sphere and contact felt, written when the run is over.

use std::fmt::Write as _;
use std::io;
use std::path::Path;

use super::streams::{append, axes, contact_header, contact_row};
use super::{RunError, write};
use crate::dem::rig::{Arrival, Body, Simulation};
use crate::output::keep_by;
use crate::setup::{Labels, PreparedRig};

/// What each sphere felt at most, and when it was reached.
pub(super) struct Peaks {
    /// (m/s)
    pub speed: Vec<f64>,
    /// (N)
    pub force: Vec<f64>,
    /// (J)
    pub dissipated: Vec<f64>,
    /// By threshold (s).
    pub arrivals: Vec<Vec<Option<f64>>>,
}

impl Peaks {
    fn of<const D: usize>(simulation: &Simulation<D>, thresholds: usize) -> Self {
        Self {
            speed: simulation.greatest_speed(),
            force: simulation.greatest_force(),
            dissipated: simulation.dissipated(),
            arrivals: (0..thresholds).map(|k| simulation.arrivals(k)).collect(),
        }
    }
}

/// Writes the tables of spheres, layers and contacts, and that of regions where there are any. Spheres and contacts may be many: their tables are never in
/// memory as a whole.
pub(super) fn write_all<const D: usize>(
    folder: &Path,
    prepared: &PreparedRig<D>,
    simulation: &Simulation<D>,
) -> Result<(), RunError> {
    let peaks = Peaks::of(simulation, prepared.record.arrivals.len());
    write_peaks(folder, prepared, &peaks, &|i| simulation.view().simulated_fraction(i))?;
    let labels = prepared.labels();
    keep_by(&folder.join("contacts-final.csv"), |file| {
        writeln!(file, "{}", contact_header::<D>())?;
        let mut row = String::new();
        for touching in simulation.view().contacts() {
            row.clear();
            contact_row(&mut row, &labels, &touching);
            writeln!(file, "{row}")?;
        }
        Ok(())
    })?;
    Ok(keep_by(&folder.join("contacts-ever.csv"), |file| contacts_ever(&labels, simulation, file))?)
}

/// Writes the tables of spheres and layers, and that of regions where there are any; `part` tells how much of a sphere is simulated.
pub(super) fn write_peaks<const D: usize>(
    folder: &Path,
    prepared: &PreparedRig<D>,
    peaks: &Peaks,
    part: &dyn Fn(usize) -> f64,
) -> Result<(), RunError> {
    keep_by(&folder.join("spheres-final.csv"), |file| spheres(prepared, peaks, file))?;
    write(&folder.join("layers-final.csv"), layers(prepared, peaks).as_bytes())?;
    if !prepared.record.regions.is_empty() {
        write(&folder.join("regions-final.csv"), regions(prepared, peaks, part).as_bytes())?;
    }
    Ok(())
}

/// One line per contact of spheres that ever closed: its greatest overlap and force, and what it took.
fn contacts_ever<const D: usize>(
    labels: &Labels,
    simulation: &Simulation<D>,
    file: &mut dyn io::Write,
) -> io::Result<()> {
    writeln!(file, "sphere_a,sphere_b,max_overlap_m,max_force_N,work_J,stored_J,dissipated_J")?;
    let mut row = String::new();
    for contact in simulation.contacts_ever() {
        row.clear();
        let [a, b] = contact.spheres.map(|i| labels.of(Body::Sphere(i)));
        let _ = write!(row, "{a},{b}");
        let [work, stored] = [contact.work, contact.stored].map(|energy| contact.weight * energy);
        append(&mut row, [contact.overlap_max, contact.force_max, work, stored, work - stored]);
        writeln!(file, "{row}")?;
    }
    Ok(())
}

/// One line per sphere: where it lay, what it is, what it felt at most, when the wave came. Empty where it did not.
fn spheres<const D: usize>(prepared: &PreparedRig<D>, peaks: &Peaks, file: &mut dyn io::Write) -> io::Result<()> {
    let (rig, Peaks { speed, force, dissipated, arrivals }) = (&prepared.rig, peaks);
    let mut text = "sphere,layer,column".to_owned();
    axes::<D>().iter().for_each(|axis| text += &format!(",{axis}_m"));
    text += ",diameter_m,material,max_speed_m_s,max_kinetic_J,max_force_N,dissipated_J";
    prepared.record.arrivals.iter().for_each(|arrival| text += &format!(",arrival_{}_s", threshold_name(*arrival)));
    writeln!(file, "{text}")?;
    for (i, (sphere, site)) in rig.sample.spheres.iter().zip(&prepared.sites).enumerate() {
        text.clear();
        let _ = write!(text, "{},{},{}", i + 1, site.layer, site.column);
        append(&mut text, sphere.centre);
        let _ = write!(text, ",{:?},{}", 2.0 * sphere.radius, rig.sample.materials[sphere.material].name);
        append(&mut text, [speed[i], 0.5 * rig.mass[i] * speed[i] * speed[i], force[i], dissipated[i]]);
        for times in arrivals {
            match times[i] {
                Some(time) => append(&mut text, [time]),
                None => text.push(','),
            }
        }
        writeln!(file, "{text}")?;
    }
    Ok(())
}

/// One line per layer: how many spheres it has, what they dissipated, the fastest of them, and the mean of the arrivals that
/// there were.
fn layers<const D: usize>(prepared: &PreparedRig<D>, peaks: &Peaks) -> String {
    let Peaks { speed, dissipated, arrivals, .. } = peaks;
    let mut text = "layer,spheres,dissipated_J,max_speed_m_s".to_owned();
    prepared.record.arrivals.iter().for_each(|arrival| text += &format!(",arrival_{}_s", threshold_name(*arrival)));
    text.push('\n');
    let mut members = vec![Vec::new(); prepared.layers as usize];
    prepared.sites.iter().enumerate().for_each(|(i, site)| members[site.layer as usize - 1].push(i));
    for (layer, members) in (1..).zip(members) {
        let _ = write!(text, "{layer},{}", members.len());
        let lost: f64 = members.iter().map(|&i| dissipated[i]).sum();
        append(&mut text, [lost, members.iter().map(|&i| speed[i]).fold(0.0, f64::max)]);
        for times in arrivals {
            let came: Vec<f64> = members.iter().filter_map(|&i| times[i]).collect();
            if came.is_empty() {
                text.push(',');
            } else {
                append(&mut text, [came.iter().sum::<f64>() / came.len() as f64]);
            }
        }
        text.push('\n');
    }
    text
}

/// One line per region: the mean of its spheres' greatest kinetic energies, as the scores of lenses have it, the greatest of
/// their speeds and forces, and what their simulated parts dissipated.
fn regions<const D: usize>(prepared: &PreparedRig<D>, peaks: &Peaks, part: &dyn Fn(usize) -> f64) -> String {
    let (rig, Peaks { speed, force, dissipated, .. }) = (&prepared.rig, peaks);
    let mut text = "region,spheres,mean_max_kinetic_J,max_speed_m_s,max_force_N,dissipated_J\n".to_owned();
    for region in &prepared.record.regions {
        let members = &region.spheres;
        let sum = |value: &dyn Fn(usize) -> f64| members.iter().map(|&i| value(i)).sum::<f64>();
        let most = |values: &[f64]| members.iter().map(|&i| values[i]).fold(0.0, f64::max);
        let _ = write!(text, "{},{}", region.name, members.len());
        let kinetic = sum(&|i| 0.5 * rig.mass[i] * speed[i] * speed[i]) / members.len() as f64;
        append(&mut text, [kinetic, most(speed), most(force), sum(&|i| part(i) * dissipated[i])]);
        text.push('\n');
    }
    text
}

/// A threshold as part of a column's name.
pub(super) fn threshold_name(arrival: Arrival) -> String {
    match arrival {
        Arrival::OwnMaximum(part) => format!("{}_of_own", part),
        Arrival::FirstSphere(part) => format!("{}_of_first", part),
        Arrival::Speed(speed) => format!("{speed}_m_s"),
        Arrival::Displacement(distance) => format!("{distance:?}_m"),
    }
}
