//! Rows as text: what there is, and what came of it.

use std::fmt::Write as _;

use super::{Finding, Part, Row, Wanted};

/// What rows there are, one line each, with about how long they take.
pub fn list(rows: &[&Row]) -> String {
    let width = rows.iter().map(|row| row.id.len()).max().unwrap_or(0);
    let mut text = String::new();
    for row in rows {
        let _ = writeln!(text, "{:<width$}  {:>5.1} s  {} ({})", row.id, row.seconds, row.claim, row.source);
    }
    text
}

/// The findings as a table in Markdown, which reads as plain text too: one line for each number.
pub fn markdown(findings: &[Finding]) -> String {
    let mut text = String::from(
        "| row | claim | source | number | published | ours | deviation | tolerance | verdict |\n\
         |---|---|---|---|---|---|---|---|---|\n",
    );
    for finding in findings {
        let row = finding.row;
        let verdict = match (finding.verdict(), &finding.parts) {
            (Some(verdict), _) => format!("**{verdict}**"),
            (_, Err(error)) => format!("**failed**: {error}"),
            _ => String::new(),
        };
        let _ = write!(text, "| {} | {} | {} |", row.id, row.claim, row.source);
        let parts = finding.parts.as_deref().unwrap_or_default();
        let Some((first, others)) = parts.split_first() else {
            let _ = writeln!(text, " | | | | | {verdict} |");
            continue;
        };
        let _ = writeln!(text, " {} {verdict} |", cells(first));
        for part in others {
            let _ = writeln!(text, "| | | | {} |", cells(part));
        }
    }
    text.push_str("\nTolerances:\n\n");
    for finding in findings {
        let _ = writeln!(text, "- {}: {}", finding.row.id, finding.row.reason);
    }
    text
}

/// Number, published, ours, deviation, tolerance; a part that does not hold is marked.
fn cells(part: &Part) -> String {
    let deviation = match (part.wanted, part.deviation()) {
        (Wanted::Near { .. }, Some(deviation)) => format!("{:+.2} %", 100.0 * deviation),
        (Wanted::Within { .. }, Some(deviation)) => format!("{deviation:+.3}"),
        _ => String::new(),
    };
    let wanted = match part.wanted {
        Wanted::Near { relative, .. } => format!("{:.2} %", 100.0 * relative),
        Wanted::Within { absolute, .. } => number(absolute),
        Wanted::Above(limit) => format!("above {}", number(limit)),
        Wanted::Below(limit) => format!("below {}", number(limit)),
    };
    let mark = if part.holds() { "" } else { " (no)" };
    let ours = format!("{} {}", number(part.ours), part.unit);
    format!("{} | {} | {} | {deviation} | {wanted}{mark} |", part.what, part.published, ours.trim())
}

/// Five digits, without an exponent where it is short.
fn number(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    let digits = 4 - value.abs().log10().floor() as i32;
    if (-3..=8).contains(&digits) {
        let text = format!("{value:.*}", digits.max(0) as usize);
        if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
    } else {
        format!("{value:.4e}")
    }
}
