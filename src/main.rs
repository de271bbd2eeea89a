//! The `granulens` program: argument reading and output around the library.

mod cli;

fn main() -> std::process::ExitCode {
    cli::main()
}
