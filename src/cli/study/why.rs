//! Why evaluations of a journal are used or not, in words.

use granulens::study::{Difference, Why};

/// A few lines for the evaluations of one kind.
pub fn words(why: &Why) -> String {
    let count = why.evaluations;
    let at = why.step.as_ref().map_or(String::new(), |step| format!(" at a step of {step}"));
    if why.used {
        return format!("used: {count}{at}, made under the present settings\n");
    }
    let mut text = format!("not used: {count}{at}\n");
    match &why.differences {
        None => text.push_str(
            "  under settings that are not known: by a version that did not note them, or of another design's folder\n",
        ),
        Some(differences) => differences.iter().for_each(|difference| text.push_str(&said(difference))),
    }
    if why.anew > 0 {
        text.push_str(&format!("  {} of these layouts were evaluated anew for that\n", why.anew));
    }
    text
}

fn said(Difference { setting, now, then }: &Difference) -> String {
    // Constants of a material are a long list: that they differ is enough where their own keys stand in the design.
    let short = |value: &Option<String>| match value {
        Some(value) if value.chars().count() > 60 => "other values".to_owned(),
        Some(value) => value.clone(),
        None => "not set".to_owned(),
    };
    match (now, then) {
        (None, Some(then)) if then.ends_with("sites differ") => format!("  {setting}: {then}\n"),
        _ => format!("  {setting}: {} then, {} now\n", short(then), short(now)),
    }
}
