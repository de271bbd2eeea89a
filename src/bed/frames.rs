//! Frames as files: every body and closed contact at moments, two CSV files a moment, of impacts on beds and of rigs in the plane.
//!
//! `000012-grains.csv`: `id,x,z,diameter,vx,vz,spin,fx,fz,kind`, what [`motion`](crate::motion) reads; `000012-contacts.csv`:
//! `i,j,x_i,z_i,x_j,z_j,normal_N,tangential_N`, what [`network`](crate::network) reads, in the units of beds or SI. A comment before
//! the names says time and period. Numbers are as short as they read back exactly. Grains come first, then the disks of walls, then those
//! of the intruder. Flats have no number but a name: `intruder` on a bed; what touches its own image in a mirror touches `mirror`.

use std::collections::BTreeMap;
use std::path::PathBuf;

use super::{End, Frame, FrameBody, FrameContact, Role};
use crate::columns::{Table, TableError};

/// Which frames of an impact are kept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FramePlan {
    /// Time between two frames (τ_c).
    pub every: f64,
    /// Whether contacts are kept too.
    pub contacts: bool,
}

impl FramePlan {
    /// Looks between two frames of an impact that is looked at every `sample` (τ_c); none where no whole number of them fits.
    pub fn looks(&self, sample: f64) -> Option<u64> {
        let looks = self.every / sample;
        (looks > 0.5 && (looks - looks.round()).abs() <= 1e-9 * looks).then(|| looks.round() as u64)
    }
}

/// Names of the two files of a frame.
pub fn names(number: u64) -> [String; 2] {
    ["grains", "contacts"].map(|what| format!("{number:06}-{what}.csv"))
}

/// What the numbers of a bed's frames are in.
pub const UNITS: &str = "tau_c; lengths in d, velocities in d/tau_c, forces in m d/tau_c^2";
/// What those of a rig's frames are in.
pub const SI: &str = "s; SI units";
/// The name of an image in a mirror.
pub const MIRROR: &str = "mirror";

/// Writes the texts of the two files of a frame into `to`, in place of what it held: many frames are written into the room of one. Numbers are in
/// `units` ([`UNITS`] or [`SI`]); `flats` are called so.
pub fn texts_into(to: &mut [String; 2], number: u64, frame: &Frame, units: &str, flats: &[&str]) {
    let [grains, contacts] = to;
    let period = frame.period.map_or(String::new(), |period| format!("; period_x = {period:?}"));
    let comment = format!("# granulens frame {number}, time = {:?} {units}{period}\n", frame.time);
    for (text, names) in [
        (&mut *grains, "id,x,z,diameter,vx,vz,spin,fx,fz,kind\n"),
        (&mut *contacts, "i,j,x_i,z_i,x_j,z_j,normal_N,tangential_N\n"),
    ] {
        text.clear();
        text.push_str(&comment);
        text.push_str(names);
    }
    // Millions of numbers are written: by their shortest digits, without the machinery of formats.
    let mut digits = zmij::Buffer::new();
    let mut number = |text: &mut String, value: f64| {
        text.push(',');
        text.push_str(digits.format(value));
    };
    let mut id = itoa::Buffer::new();
    // Places are written many times and made once: where in the text of the grains each stands, its comma before it.
    let mut places = Vec::with_capacity(frame.bodies.len());
    for (k, body) in frame.bodies.iter().enumerate() {
        let FrameBody { role, place: [x, z], diameter, velocity, spin, force } = body;
        grains.push_str(id.format(k + 1));
        let from = grains.len();
        number(grains, *x);
        number(grains, *z);
        places.push(from..grains.len());
        let values = [*diameter, velocity[0], velocity[1], *spin, force[0], force[1]];
        values.into_iter().for_each(|value| number(grains, value));
        grains.push(',');
        grains.push_str(role.name());
        grains.push('\n');
    }
    for contact in &frame.contacts {
        for (k, end) in contact.ends.iter().enumerate() {
            if k > 0 {
                contacts.push(',');
            }
            contacts.push_str(match end {
                End::Body(i) => id.format(i + 1),
                End::Flat(k) => flats.get(*k as usize).unwrap_or(&"flat"),
                End::Mirror => MIRROR,
            });
        }
        for (end, [x, z]) in contact.ends.iter().zip(contact.places) {
            match end.body() {
                Some(i) => contacts.push_str(&grains[places[i].clone()]),
                None => {
                    number(contacts, x);
                    number(contacts, z);
                }
            }
        }
        number(contacts, contact.normal);
        number(contacts, contact.tangential);
        contacts.push('\n');
    }
}

/// A frame from its two files.
///
/// # Errors
/// See [`TableError`].
pub fn read(files: &[PathBuf; 2]) -> Result<Frame, TableError> {
    read_named(files).map(|(frame, _)| frame)
}

/// A frame from its two files, and the names of its flats.
///
/// # Errors
/// See [`TableError`].
pub fn read_named([grains, contacts]: &[PathBuf; 2]) -> Result<(Frame, Vec<String>), TableError> {
    let table = Table::read(grains)?.swap_remove(0);
    let [x, z, diameter, vx, vz, spin, fx, fz] =
        ["x", "z", "diameter", "vx", "vz", "spin", "fx", "fz"].map(|name| table.numbers(name));
    let (x, z, diameter, vx, vz, spin, fx, fz) = (x?, z?, diameter?, vx?, vz?, spin?, fx?, fz?);
    let (ids, kinds) = (table.labels("id")?, table.labels("kind")?);
    let body = |k: usize| {
        let role = [Role::Grain, Role::Wall, Role::Intruder].into_iter().find(|role| role.name() == kinds[k]);
        let role = role.ok_or_else(|| {
            let message = format!("kind = \"{}\" is not known.", kinds[k]);
            table.blame(k, message, "It is grain, wall or intruder.")
        })?;
        Ok(FrameBody {
            role,
            place: [x[k], z[k]],
            diameter: diameter[k],
            velocity: [vx[k], vz[k]],
            spin: spin[k],
            force: [fx[k], fz[k]],
        })
    };
    let bodies = (0..table.len()).map(body).collect::<Result<Vec<_>, TableError>>()?;
    let known: BTreeMap<&str, u32> = ids.into_iter().zip(0..).collect();
    let pairs = Table::read(contacts)?.swap_remove(0);
    let (first, second) = (pairs.labels("i")?, pairs.labels("j")?);
    let [xi, zi, xj, zj, normal, tangential] =
        ["x_i", "z_i", "x_j", "z_j", "normal_N", "tangential_N"].map(|name| pairs.numbers(name));
    let (xi, zi, xj, zj, normal, tangential) = (xi?, zi?, xj?, zj?, normal?, tangential?);
    // What is no body is a flat, or a mirror; flats are numbered as they come.
    let mut flats: Vec<&str> = Vec::new();
    let mut end = |name| match known.get(name) {
        Some(&i) => End::Body(i),
        None if name == MIRROR => End::Mirror,
        None => {
            let place = flats.iter().position(|known| *known == name).unwrap_or(flats.len());
            if place == flats.len() {
                flats.push(name);
            }
            End::Flat(place as u32)
        }
    };
    let mut contact = |k: usize| FrameContact {
        ends: [end(first[k]), end(second[k])],
        places: [[xi[k], zi[k]], [xj[k], zj[k]]],
        normal: normal[k],
        tangential: tangential[k],
    };
    let contacts = (0..pairs.len()).map(&mut contact).collect();
    let flats = flats.into_iter().map(str::to_owned).collect();
    Ok((Frame { time: table.time.unwrap_or(0.0), period: table.period, bodies, contacts }, flats))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is written reads back to the last bit, a flat intruder too.
    #[test]
    fn frames_read_back_as_they_were_written() {
        let body = |role, x: f64| FrameBody {
            role,
            place: [x, 1.0 / 3.0],
            diameter: 0.9,
            velocity: [0.1, -1e-17],
            spin: -0.3,
            force: [1e300, 0.1 + 0.2],
        };
        // Where an end is a body, its place is the body's.
        let contact = |ends: [End; 2], normal| FrameContact {
            ends,
            places: [[1.0 / 7.0, 1.0 / 3.0], [if ends[1] == End::Body(0) { 1.0 / 7.0 } else { 0.5 }, 1.0 / 3.0]],
            normal,
            tangential: -0.01,
        };
        let frame = Frame {
            time: 12.5,
            period: Some(10.0),
            bodies: vec![body(Role::Grain, 1.0 / 7.0), body(Role::Wall, 0.5), body(Role::Intruder, 3.0)],
            contacts: vec![
                contact([End::Body(0), End::Body(1)], 2.0),
                contact([End::Flat(0), End::Body(1)], -0.5),
                contact([End::Body(0), End::Mirror], 0.5),
                contact([End::Flat(1), End::Body(0)], 0.5),
            ],
        };
        let folder = tempfile::tempdir().unwrap();
        let files = names(3).map(|name| folder.path().join(name));
        // What another frame left behind is gone.
        let mut texts = ["of another frame".to_owned(), String::new()];
        texts_into(&mut texts, 3, &frame, UNITS, &["intruder", "wall"]);
        for (file, text) in files.iter().zip(texts) {
            std::fs::write(file, text).unwrap();
        }
        assert_eq!(read(&files).unwrap(), frame);
        // And the network of such a folder holds the grains alone.
        let mut seen = 0;
        crate::network::read(folder.path(), &[], None, None, |named| {
            seen += 1;
            assert_eq!((named.time, named.period, named.network.grains()), (Some(12.5), Some(10.0), 1));
            Ok::<(), TableError>(())
        })
        .unwrap();
        assert_eq!(seen, 1);
    }
}
