//! The numbers that contact laws leave to their user, as keys of [crystal].

use super::file::CrystalFile;
use crate::contact::Tuning;
use crate::document::{DocumentError, Scope};

/// Reads them; what is not written is as usual.
pub(super) fn tuning(scope: &Scope, file: &CrystalFile) -> Result<Tuning, DocumentError> {
    let mut tuning = Tuning::default();
    let Tuning { hardness, unlike_hardness, spring_back, spring_back_growth, restitution, hardening } = &mut tuning;
    let mut written = Vec::new();
    for (key, value, place) in [
        ("hardness", &file.hardness, hardness),
        ("unlike_hardness", &file.unlike_hardness, unlike_hardness),
        ("spring_back", &file.spring_back, spring_back),
        ("spring_back_growth", &file.spring_back_growth, spring_back_growth),
        ("restitution", &file.restitution, restitution),
        ("hardening", &file.hardening, hardening),
    ] {
        if let Some(entry) = scope.optional(key, value) {
            *place = entry.number()?;
            written.push((key, entry));
        }
    }
    if let Err(error) = tuning.check() {
        let named = written.iter().find(|(key, _)| *key == error.name);
        let rule = format!("must lie from {} to {}", error.least, error.most);
        return Err(match named {
            Some((_, entry)) => entry.refuse(&rule),
            None => scope.fail(&error.to_string(), "Leave it out for the usual one."),
        });
    }
    Ok(tuning)
}
