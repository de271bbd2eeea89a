//! The numbers that contact laws leave to their user, as keys of [crystal], or of a rig's [law].

use crate::contact::Tuning;
use crate::document::{DocumentError, Scope, Written};

/// Reads them, in the order of [`Tuning`]; what is not written is as usual.
pub(crate) fn tuning<'a>(scope: &Scope<'a>, written: [&'a Written; 6]) -> Result<Tuning, DocumentError> {
    let keys = ["hardness", "unlike_hardness", "spring_back", "spring_back_growth", "restitution", "hardening"];
    let mut tuning = Tuning::default();
    let Tuning { hardness, unlike_hardness, spring_back, spring_back_growth, restitution, hardening } = &mut tuning;
    let places = [hardness, unlike_hardness, spring_back, spring_back_growth, restitution, hardening];
    let mut given = Vec::new();
    for ((key, value), place) in keys.into_iter().zip(written).zip(places) {
        if let Some(entry) = scope.optional(key, value) {
            *place = entry.number()?;
            given.push((key, entry));
        }
    }
    if let Err(error) = tuning.check() {
        let named = given.iter().find(|(key, _)| *key == error.name);
        let rule = format!("must lie from {} to {}", error.least, error.most);
        return Err(match named {
            Some((_, entry)) => entry.refuse(&rule),
            None => scope.fail(&error.to_string(), "Leave it out for the usual one."),
        });
    }
    Ok(tuning)
}
