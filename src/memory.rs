//! How much memory there is, and whether a run fits into it: told before it begins, as a program that runs out of memory says nothing.
//!
//! What is known of the system is read from Linux's files; elsewhere nothing is refused.

use std::fs;

/// Bytes for each sphere of a rig that runs: state, contacts, neighbours, records. Measured, as greatest resident size of a process, at
/// 2.1, 2.2 and 2.0 kB in sheets of 40 000, 250 000 and 1 000 000 spheres.
pub(crate) const RIG_SPHERE: f64 = 2.0e3;
/// Bytes for each site of a lens design that is simulated with full records: measured at 470 with 320 000 sites.
pub(crate) const DESIGN_SITE: f64 = 470.0;
/// What the program needs beside (bytes).
const BASE: f64 = 2e7;

/// Refuses what needs more memory than there is: in words, to stand behind what asks for it.
pub(crate) fn suffices(spheres: f64, each: f64) -> Result<(), String> {
    let needed = spheres * each + BASE;
    match available() {
        Some(free) if needed > free => Err(format!(
            "makes some {} spheres, whose simulation takes some {} of memory, and there are {}",
            thousands(spheres),
            bytes(needed),
            bytes(free)
        )),
        _ => Ok(()),
    }
}

fn thousands(count: f64) -> String {
    match count {
        count if count >= 1e6 => format!("{:.1} million", 1e-6 * count),
        count if count >= 1e4 => format!("{:.0} thousand", 1e-3 * count),
        count => format!("{count:.0}"),
    }
}

fn bytes(count: f64) -> String {
    if count >= 1e9 { format!("{:.1} GB", 1e-9 * count) } else { format!("{:.0} MB", 1e-6 * count) }
}

/// Memory that this process may still take (bytes): the least of what the machine has, what its group may take, and what its own
/// address space may hold. None where that is not known.
fn available() -> Option<f64> {
    let text = |path: &str| fs::read_to_string(path).ok();
    let number = |text: &str| text.split_whitespace().find_map(|word| word.parse::<f64>().ok());
    let line = |text: &str, begin: &str| text.lines().find_map(|line| number(line.strip_prefix(begin)?));
    let machine =
        text("/proc/meminfo").and_then(|text| line(&text, "MemAvailable:")).map(|kilobytes| 1024.0 * kilobytes);
    let group = text("/sys/fs/cgroup/memory.max")
        .and_then(|most| number(&most))
        .zip(text("/sys/fs/cgroup/memory.current").and_then(|taken| number(&taken)))
        .map(|(most, taken)| most - taken);
    let own = text("/proc/self/limits")
        .and_then(|text| line(&text, "Max address space"))
        .zip(text("/proc/self/status").and_then(|text| line(&text, "VmSize:")))
        .map(|(most, taken)| most - 1024.0 * taken);
    [machine, group, own].into_iter().flatten().reduce(f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_fit_is_refused_and_what_is_small_is_not() {
        suffices(1000.0, RIG_SPHERE).unwrap();
        if let Some(free) = available() {
            assert!(free > 1e6);
            let refused = suffices(2.0 * free / RIG_SPHERE, RIG_SPHERE).unwrap_err();
            assert!(refused.contains(" spheres") && refused.contains("of memory"), "{refused}");
        }
    }
}
