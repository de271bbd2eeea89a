//! What the help of each command says: of the options of all commands only those that mean something there, and of `--out` what it is there.
//! The page of all commands, `man --page`, is made of the same.

use std::fmt::Write as _;

use clap::{Arg, ArgAction, Command, CommandFactory as _};

use super::Cli;

/// What the options of all commands are to one of them, by its name with that of the command above.
struct Own {
    name: &'static str,
    /// What `--out` names; empty where nothing can be written.
    out: &'static str,
    /// Which other options mean nothing there.
    idle: &'static [&'static str],
}

/// Commands that simulate nothing and take no seed.
const STILL: &[&str] = &["dry_run", "seed"];
/// Commands that compute nothing.
const TEXT: &[&str] = &["dry_run", "seed", "threads"];
/// Commands that answer with text alone.
const PRINT: &[&str] = &["dry_run", "seed", "threads", "json", "force", "quiet"];

const COMMANDS: [Own; 38] = [
    Own { name: "run", out: "Folder of results [default: reports/NAME]", idle: &[] },
    Own { name: "design", out: "Where to write the layout, or the ranking as JSON", idle: STILL },
    Own { name: "trace", out: "Where to write the picture, SVG, PDF or PNG by its ending", idle: STILL },
    Own { name: "simulate", out: "Folder of results", idle: &[] },
    Own { name: "modes", out: "Where to write the transmission, a picture by its ending", idle: &["dry_run"] },
    Own { name: "check", out: "Where to write the numbers as JSON", idle: &[] },
    Own { name: "compare", out: "Where to write the outcome as JSON", idle: &[] },
    Own {
        name: "report",
        out: "Folder of the report [default: reports/DESIGN-LAYOUT, or where the results stand]",
        idle: &[],
    },
    Own { name: "diff", out: "Where to write the differences as JSON", idle: &["seed"] },
    Own { name: "explore", out: "", idle: &["dry_run", "seed", "json", "force"] },
    Own { name: "measured", out: "Folder of results [default: measured/NAME]", idle: &[] },
    Own { name: "build", out: "Folder for the workshop", idle: &["seed"] },
    Own { name: "tolerance", out: "Folder that keeps the pieces, the numbers and a page", idle: &[] },
    Own { name: "sensitivity", out: "Where to write the sensitivities", idle: &["seed"] },
    Own { name: "materials", out: "Where to write the list as JSON", idle: TEXT },
    Own {
        name: "contact",
        out: "Where to write the curve, SVG, PDF, PNG or CSV by its ending, or the numbers as JSON",
        idle: STILL,
    },
    Own { name: "speed", out: "Where to write the speeds as JSON", idle: TEXT },
    Own {
        name: "surface",
        out: "Where to write the surface, SVG, PDF, PNG, HTML, CSV or JSON by its ending",
        idle: STILL,
    },
    Own { name: "study run", out: "Folder of the study [default: reports/NAME]", idle: &[] },
    Own { name: "study ask", out: "Folder of the study [default: reports/NAME]", idle: &["dry_run"] },
    Own { name: "study merge", out: "Folder of the study [default: reports/NAME]", idle: &["dry_run"] },
    Own { name: "study slurm", out: "Folder of the study [default: reports/NAME]", idle: &["dry_run", "threads"] },
    Own {
        name: "study show",
        out: "Folder of the study [default: reports/NAME]",
        idle: &["dry_run", "threads", "force"],
    },
    Own { name: "study export", out: "Folder of the study [default: reports/NAME]", idle: &["dry_run", "threads"] },
    Own { name: "study compare", out: "Where to write the page", idle: TEXT },
    Own { name: "evaluate", out: "Folder of the study [default: reports/NAME]", idle: &[] },
    Own { name: "reproduce", out: "Where to write the table, as Markdown, or JSON by its ending", idle: &["seed"] },
    Own { name: "export", out: "Where to write the numbers as JSON", idle: &["seed"] },
    Own { name: "impact", out: "Folder of results [default: reports/NAME]", idle: &[] },
    Own { name: "network", out: "Folder of tables and pictures", idle: STILL },
    Own { name: "motion", out: "Where to write the table, or with --json the numbers", idle: STILL },
    Own { name: "bench", out: "", idle: &["dry_run", "seed", "force"] },
    Own { name: "init", out: "Where to write the file", idle: TEXT },
    Own { name: "keys", out: "Where to write the keys as JSON", idle: TEXT },
    Own { name: "schema", out: "Where to write the schema", idle: &["dry_run", "seed", "threads", "json", "quiet"] },
    Own { name: "completions", out: "", idle: PRINT },
    Own { name: "man", out: "Folder of the pages", idle: &["dry_run", "seed", "threads", "json", "quiet"] },
    // It only holds others.
    Own { name: "study", out: "Folder of the study [default: reports/NAME]", idle: &[] },
];

/// The command line with its help.
pub fn command() -> Command {
    let mut top = Cli::command();
    // The options of all commands then stand at each.
    top.build();
    each(top, "")
}

fn each(mut command: Command, above: &str) -> Command {
    for below in command.get_subcommands_mut() {
        let name = format!("{above}{}", below.get_name());
        let own = COMMANDS.iter().find(|own| own.name == name);
        *below = each(std::mem::take(below), &format!("{name} "));
        if let Some(own) = own {
            *below = std::mem::take(below).mut_args(|arg| at(arg, own));
        }
    }
    command
}

fn at(arg: Arg, own: &Own) -> Arg {
    let id = arg.get_id().as_str().to_owned();
    match id.as_str() {
        "out" if own.out.is_empty() => arg.hide(true),
        "out" => arg.help(own.out),
        id if own.idle.contains(&id) => arg.hide(true),
        _ => arg,
    }
}

/// All of it on one page, as Markdown.
pub fn page() -> String {
    let mut text = String::from(
        "# All commands\n\nWhat `granulens COMMAND --help` says. Every command knows `--json`, `--quiet`, `--threads`, `--seed` and `--out`; listed are those that \
         mean something there. Made by `granulens man --page`.\n",
    );
    let top = command();
    for below in top.get_subcommands().filter(|below| below.get_name() != "help") {
        section(&mut text, below, "granulens ");
    }
    let codes = top.get_after_help().map(ToString::to_string).unwrap_or_default();
    let _ = write!(text, "\n## Exit codes\n\n```text\n{}\n```\n", codes.trim_start_matches("Exit codes:\n"));
    text
}

fn section(text: &mut String, command: &Command, above: &str) {
    let name = format!("{above}{}", command.get_name());
    let about = command.get_long_about().or(command.get_about()).map(ToString::to_string).unwrap_or_default();
    let _ = write!(text, "\n## {name}\n\n{}\n", about.trim());
    let holds: Vec<&Command> = command.get_subcommands().filter(|below| below.get_name() != "help").collect();
    if !holds.is_empty() {
        holds.into_iter().for_each(|below| section(text, below, &format!("{name} ")));
        return;
    }
    let usage = command.clone().render_usage().to_string();
    let usage = usage.trim_start_matches("Usage: ");
    let usage = if usage.starts_with("granulens") { usage.to_owned() } else { format!("granulens {usage}") };
    let _ = write!(text, "\n```text\n{usage}\n```\n");
    let shown = |arg: &&Arg| !arg.is_hide_set() && !matches!(arg.get_id().as_str(), "help" | "version");
    let args: Vec<&Arg> = command.get_arguments().filter(shown).collect();
    if args.is_empty() {
        return;
    }
    text.push_str("\n| | default | |\n|---|---|---|\n");
    for arg in args {
        text.push_str(&row(arg));
    }
}

fn row(arg: &Arg) -> String {
    let takes = matches!(arg.get_action(), ArgAction::Set | ArgAction::Append);
    let names: Vec<String> = arg.get_value_names().unwrap_or_default().iter().map(ToString::to_string).collect();
    let value = if names.is_empty() { arg.get_id().as_str().to_uppercase() } else { names.join(" ") };
    let written = match (arg.get_long(), arg.get_short()) {
        (None, None) => format!("<{value}>"),
        (long, short) => {
            let long = long.map(|long| format!("--{long}"));
            let short = short.map(|short| format!("-{short}"));
            let both: Vec<String> = short.into_iter().chain(long).collect();
            if takes { format!("{} <{value}>", both.join(", ")) } else { both.join(", ") }
        }
    };
    let usual: Vec<String> =
        arg.get_default_values().iter().map(|value| value.to_string_lossy().into_owned()).collect();
    let usual = if takes { usual.join(" ") } else { String::new() };
    let mut means =
        arg.get_long_help().or(arg.get_help()).map(ToString::to_string).unwrap_or_default().replace('\n', " ");
    let choices: Vec<String> = arg.get_possible_values().iter().map(|value| value.get_name().to_owned()).collect();
    if takes && !choices.is_empty() {
        means += &format!(". One of {}", choices.join(", "));
    }
    // What looks like HTML, or ends a cell, is text.
    let cell = |text: &str| text.replace('|', "\\|").replace('<', "&lt;");
    format!("| `{written}` | {} | {} |\n", cell(&usual), cell(means.trim()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(command: &Command, above: &str, found: &mut Vec<String>) {
        for below in command.get_subcommands().filter(|below| below.get_name() != "help") {
            let name = format!("{above}{}", below.get_name());
            all(below, &format!("{name} "), found);
            found.push(name);
        }
    }

    #[test]
    fn every_command_is_listed() {
        let mut names = Vec::new();
        all(&command(), "", &mut names);
        names.sort();
        let mut listed: Vec<_> = COMMANDS.iter().map(|own| own.name.to_owned()).collect();
        listed.sort();
        assert_eq!(names, listed);
    }

    #[test]
    fn help_fits_a_hundred_columns() {
        fn check(command: &mut Command) {
            for text in [command.render_help().to_string(), command.render_long_help().to_string()] {
                let wide = text.lines().find(|line| line.chars().count() > 100);
                assert_eq!(wide, None, "{}", command.get_name());
            }
            command.get_subcommands_mut().for_each(check);
        }
        check(&mut command());
    }

    #[test]
    fn what_means_nothing_is_not_in_the_help() {
        let mut top = command();
        let help =
            |top: &mut Command, name: &str| top.find_subcommand_mut(name).unwrap().render_long_help().to_string();
        let keys = help(&mut top, "keys");
        assert!(!keys.contains("--dry-run") && !keys.contains("--seed") && keys.contains("--json"), "{keys}");
        assert!(help(&mut top, "run").contains("--dry-run"));
        // Still taken, as they were: a script gives all of them the same options.
        assert!(command().try_get_matches_from(["granulens", "keys", "--seed", "3"]).is_ok());
    }

    /// With every command, what it takes and what it means.
    #[test]
    fn the_page_of_all_commands_has_all() {
        let page = page();
        let holds = |name: &str| COMMANDS.iter().any(|own| own.name.starts_with(&format!("{name} ")));
        for own in COMMANDS.iter().filter(|own| !holds(own.name)) {
            let section = page.split("\n## ").find(|section| section.starts_with(&format!("granulens {}\n", own.name)));
            let section = section.unwrap_or_else(|| panic!("{} is not there", own.name));
            assert_eq!(section.contains("`--out <PATH>`"), !own.out.is_empty(), "{section}");
            assert_eq!(section.contains("`--dry-run`"), !own.idle.contains(&"dry_run"), "{section}");
        }
    }
}
