//! Frames of beds and rigs as tables, with the names of their CSV files: a row for each body and contact of a moment.

use super::{Column, Columns};
use crate::bed::{End, Frame, FrameBody, FrameContact};

/// The bodies of a moment: `frame,time`, then the columns of `-grains.csv`.
pub fn frame_bodies(number: u64, frame: &Frame) -> Columns {
    let bodies = &frame.bodies;
    let of = |of: fn(&FrameBody) -> f64| Column::numbers(bodies.iter().map(of));
    let [count, time] = moment(number, frame.time, bodies.len());
    Columns(vec![
        ("frame", count),
        ("time", time),
        ("id", Column::Whole((1..=bodies.len() as i64).collect())),
        ("x", of(|body| body.place[0])),
        ("z", of(|body| body.place[1])),
        ("diameter", of(|body| body.diameter)),
        ("vx", of(|body| body.velocity[0])),
        ("vz", of(|body| body.velocity[1])),
        ("spin", of(|body| body.spin)),
        ("fx", of(|body| body.force[0])),
        ("fz", of(|body| body.force[1])),
        ("kind", Column::Text(bodies.iter().map(|body| Some(body.role.name().to_owned())).collect())),
    ])
}

/// The contacts of a moment: `frame,time`, then the columns of `-contacts.csv`; `i` or `j` is 0 of what is no body, and `flat` says what it is
/// called. `flats` are the names of flats.
pub fn frame_contacts(number: u64, frame: &Frame, flats: &[String]) -> Columns {
    let contacts = &frame.contacts;
    let of = |of: fn(&FrameContact) -> f64| Column::numbers(contacts.iter().map(of));
    let end = |k: usize| {
        let id = |contact: &FrameContact| contact.ends[k].body().map_or(0, |i| i as i64 + 1);
        Column::Whole(contacts.iter().map(id).collect())
    };
    let called = |contact: &FrameContact| {
        contact.ends.iter().find_map(|end| match end {
            End::Body(_) => None,
            End::Flat(k) => flats.get(*k as usize).cloned(),
            End::Mirror => Some(crate::bed::MIRROR.to_owned()),
        })
    };
    let [count, time] = moment(number, frame.time, contacts.len());
    Columns(vec![
        ("frame", count),
        ("time", time),
        ("i", end(0)),
        ("j", end(1)),
        ("x_i", of(|contact| contact.places[0][0])),
        ("z_i", of(|contact| contact.places[0][1])),
        ("x_j", of(|contact| contact.places[1][0])),
        ("z_j", of(|contact| contact.places[1][1])),
        ("normal_N", of(|contact| contact.normal)),
        ("tangential_N", of(|contact| contact.tangential)),
        ("flat", Column::Text(contacts.iter().map(called).collect())),
    ])
}

fn moment(number: u64, time: f64, rows: usize) -> [Column; 2] {
    [Column::Whole(vec![number as i64; rows]), Column::Number(vec![Some(time); rows])]
}
