//! `granulens completions` and `man`: what shells and man know of the commands.

use super::console::emit;
use super::failure::Failure;
use super::folder::begin;
use super::{Common, help};

/// Print the completions of a shell
///
/// For bash: granulens completions bash > ~/.local/share/bash-completion/completions/granulens
#[derive(clap::Args)]
pub struct Completions {
    /// Which shell
    shell: clap_complete::Shell,
}

impl Completions {
    pub fn run(self) -> Result<(), Failure> {
        let mut text = Vec::new();
        clap_complete::generate(self.shell, &mut help::command(), "granulens", &mut text);
        emit(&String::from_utf8_lossy(&text));
        Ok(())
    }
}

/// Write the man pages into a folder, one for each command
#[derive(clap::Args)]
pub struct Man {
    /// Print all commands as one page of Markdown instead
    #[arg(long)]
    page: bool,
}

impl Man {
    pub fn run(self, common: &Common) -> Result<(), Failure> {
        if self.page {
            emit(&help::page());
            return Ok(());
        }
        let Some(place) = &common.out else {
            return Err(Failure::input_with_help(
                "man: where to is not said",
                "Write it like granulens man --out man1.",
            ));
        };
        let folder = begin(common, place)?;
        let top = help::command();
        let of = |command: &clap::Command, name: &str| -> Result<(), Failure> {
            let mut page = Vec::new();
            let man = clap_mangen::Man::new(command.clone()).title(name);
            man.render(&mut page).map_err(|error| Failure::input(format!("man: {error}")))?;
            Ok(folder.write(&format!("{name}.1"), &page)?)
        };
        of(&top, "granulens")?;
        for command in top.get_subcommands() {
            of(command, &format!("granulens-{}", command.get_name()))?;
        }
        Ok(folder.finish()?)
    }
}
