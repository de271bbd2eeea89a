//! Whether contacts gave back more than was put into them, and what is said of it.

use crate::contact::LawKind;
use crate::dem::ContactRecord;
use crate::dem::rig::Gain;
use crate::units::Dimension::{Energy, Fraction};

/// What the contacts of one run, all under one law, gave back beyond what was put into them.
pub(crate) fn gain(law: LawKind, contacts: &[ContactRecord]) -> Gain {
    let given = |contact: &ContactRecord| (contact.weight * (contact.stored - contact.work)).max(0.0);
    Gain { law: law.name().to_owned(), energy: contacts.iter().map(given).sum() }
}

/// Says of a law that it has made energy, where that is a greater part of the energy at hand (J) than the ledger tolerates; of a law
/// that cannot, that the step did.
pub(crate) fn gain_words(gain: &Gain, at_hand: f64, tolerated: f64) -> Option<String> {
    let share = gain.energy / at_hand;
    if share.is_nan() || share <= tolerated {
        return None;
    }
    let law = &gain.law;
    let begun = format!(
        "contacts under the law \"{law}\" gave back {} more than was put into them, {} of the energy at hand",
        Energy.show(gain.energy),
        Fraction.show(share)
    );
    Some(match law.parse().is_ok_and(LawKind::makes_energy) {
        true => format!("{begun}: in gentle contacts this law makes energy; take \"consistent\", which never does"),
        false => format!("{begun}: this law makes none, so the step does; halve it"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a contact has lost makes up for nothing that another has made.
    #[test]
    fn only_what_is_given_back_counts_and_only_beyond_what_is_tolerated() {
        let contact = |work, stored| ContactRecord {
            spheres: [0, 1],
            weight: 0.5,
            overlap_max: 1e-6,
            force_max: 1.0,
            work,
            stored,
        };
        let made = gain(LawKind::Thesis, &[contact(1.0, 0.2), contact(-0.1, 0.0), contact(1.0, 1.3)]);
        assert!((made.energy - 0.2).abs() < 1e-15);
        assert_eq!(gain_words(&made, 1000.0, 1e-3), None);
        let words = gain_words(&made, 10.0, 1e-3).unwrap();
        assert!(words.contains("\"thesis\"") && words.contains("2 %") && words.contains("\"consistent\""), "{words}");
        let numerical = Gain { law: "hertz".to_owned(), energy: 0.2 };
        assert!(gain_words(&numerical, 10.0, 1e-3).unwrap().contains("halve it"));
    }
}
