//! The command line: one file per subcommand. Data goes to stdout, words to stderr.
//!
//! - `failure`: what went wrong, as text or JSON, and the exit codes
//! - `console`: output that survives a closed pipe, Ctrl-C, progress
//! - `folder`: where output goes; `picture`: figures as files
//! - `cost`: what a command would cost; `help`: what the help of each says

mod bench;
mod build;
mod check;
mod compare;
mod console;
mod contact;
mod cost;
mod design;
mod diff;
mod evaluate;
mod explore;
mod export;
mod failure;
mod folder;
mod help;
mod impact;
mod init;
mod keys;
mod materials;
mod measured;
mod modes;
mod motion;
mod network;
mod over_laws;
mod picture;
mod report;
mod reproduce;
mod run;
mod sensitivity;
mod shell;
mod simulate;
mod space;
mod speed;
mod surface;
mod study;
mod tolerance;
mod trace;
mod tuning;

use std::io::IsTerminal as _;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Args, FromArgMatches as _, Parser, Subcommand};
use granulens::design::Design;
use granulens::evaluate::{Forces, Overrides};
use granulens::units::Dimension;

use console::{emit, unsaid};
use failure::Failure;

/// Design impact lenses: packings of metal spheres that steer an impact wave to where it does no harm.
#[derive(Parser)]
#[command(name = "granulens", version = VERSION, max_term_width = 100)]
#[command(after_help = EXIT_CODES)]
struct Cli {
    #[command(subcommand)]
    command: Command,
    #[command(flatten)]
    common: Common,
}

/// Two builds of one version are told apart by the commit.
const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), " (commit ", env!("GRANULENS_COMMIT"), ")");

const EXIT_CODES: &str = "Exit codes:
  0    done
  1    a guard stopped a run, or a row of reproduce deviates
  2    usage or input
  3    the gate fails or a threshold of the design file is not met (check --strict),
       or no layout keeps a study's limits
  4    a study asks for evaluations that are not there yet (study ask, study merge, evaluate)
  130  interrupted; what was finished is kept";

/// Options of every subcommand.
#[derive(Args)]
struct Common {
    /// Print one JSON object on stdout, and no words; errors become one JSON object on stderr
    #[arg(long, global = true)]
    json: bool,
    /// No progress, no notes
    #[arg(long, short, global = true)]
    quiet: bool,
    /// Number of threads; results do not depend on it
    #[arg(long, global = true, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// First random seed, in place of the design file's
    #[arg(long, global = true, value_name = "SEED")]
    seed: Option<u64>,
    /// Where to write: a folder of results, or the file that the command makes
    #[arg(long, global = true, value_name = "PATH")]
    out: Option<PathBuf>,
    /// Replace files and folders of results that others wrote or changed; never what the command itself reads
    #[arg(long, global = true)]
    force: bool,
    /// Read and check everything, say what the command would cost, and do nothing
    #[arg(long, global = true)]
    dry_run: bool,
}

/// What each does is said at its own arguments, from where the help takes it.
#[derive(Subcommand)]
enum Command {
    Run(run::Run),
    Design(design::Propose),
    Trace(trace::Trace),
    Simulate(simulate::Simulate),
    Modes(modes::Modes),
    Check(check::Check),
    Compare(compare::Compare),
    Report(report::Report),
    Diff(diff::Diff),
    Explore(explore::Explore),
    Measured(measured::Measured),
    Build(build::Build),
    Tolerance(tolerance::Tolerance),
    Sensitivity(sensitivity::SensitivityOf),
    Materials(materials::Materials),
    Contact(contact::Contact),
    Speed(speed::Speed),
    Surface(Box<surface::Surface>),
    Study(study::Study),
    Evaluate(evaluate::Evaluate),
    Reproduce(reproduce::Reproduce),
    Export(Box<export::Export>),
    Impact(impact::Impact),
    Network(network::NetworkOf),
    Motion(motion::Motion),
    Bench(bench::Bench),
    Init(init::Init),
    Keys(keys::KeysOf),
    Schema(keys::Schema),
    Completions(shell::Completions),
    Man(shell::Man),
}

impl Command {
    /// Whether it can take long: then --dry-run says how long.
    fn simulates(&self) -> bool {
        match self {
            Self::Study(study) => study.simulates(),
            Self::Report(report) => report.simulates(),
            Self::Evaluate(_) => true,
            Self::Run(_) | Self::Simulate(_) | Self::Check(_) | Self::Compare(_) => true,
            Self::Reproduce(_) | Self::Export(_) | Self::Impact(_) => true,
            Self::Diff(_) | Self::Build(_) | Self::Measured(_) | Self::Tolerance(_) => true,
            Self::Sensitivity(_) => true,
            Self::Design(_) | Self::Modes(_) | Self::Trace(_) | Self::Materials(_) | Self::Contact(_) => false,
            Self::Speed(_) | Self::Surface(_) | Self::Bench(_) => false,
            Self::Network(_) | Self::Motion(_) | Self::Explore(_) => false,
            Self::Init(_) | Self::Keys(_) | Self::Schema(_) | Self::Completions(_) | Self::Man(_) => false,
        }
    }
}

pub fn main() -> ExitCode {
    let parsed = help::command().try_get_matches().and_then(|matches| Cli::from_arg_matches(&matches));
    let cli = match parsed {
        Ok(cli) => cli,
        Err(error) if error.use_stderr() && std::env::args_os().any(|arg| arg == "--json") => {
            return Failure::usage(&error).print(true);
        }
        Err(error) if error.use_stderr() => error.exit(),
        // Help and version are what was asked for, so they are data.
        Err(error) => {
            let text =
                if std::io::stdout().is_terminal() { error.render().ansi().to_string() } else { error.to_string() };
            emit(&text);
            return ended(Ok(()), false);
        }
    };
    if let Some(threads) = cli.common.threads {
        // Fails only if a pool exists already, and none does.
        let _ = rayon::ThreadPoolBuilder::new().num_threads(threads.into()).build_global();
    }
    failure::draw_errors();
    let common = &cli.common;
    let done = match cli.command {
        _ if common.dry_run && !cli.command.simulates() => Err(Failure::input_with_help(
            "--dry-run is for commands that simulate; this one takes seconds at most",
            "Leave it out.",
        )),
        Command::Run(command) => command.run(common),
        Command::Design(command) => command.run(common),
        Command::Trace(command) => command.run(common),
        Command::Simulate(command) => command.run(common),
        Command::Modes(command) => command.run(common),
        Command::Check(command) => command.run(common),
        Command::Compare(command) => command.run(common),
        Command::Report(command) => command.run(common),
        Command::Diff(command) => command.run(common),
        Command::Explore(command) => command.run(common),
        Command::Measured(command) => command.run(common),
        Command::Build(command) => command.run(common),
        Command::Tolerance(command) => command.run(common),
        Command::Sensitivity(command) => command.run(common),
        Command::Materials(command) => command.run(common),
        Command::Contact(command) => command.run(common),
        Command::Speed(command) => command.run(common),
        Command::Surface(command) => command.run(common),
        Command::Study(command) => command.run(common),
        Command::Evaluate(command) => command.run(common),
        Command::Reproduce(command) => command.run(common),
        Command::Export(command) => command.run(common),
        Command::Impact(command) => command.run(common),
        Command::Network(command) => command.run(common),
        Command::Motion(command) => command.run(common),
        Command::Bench(command) => command.run(common),
        Command::Init(command) => command.run(common),
        Command::Keys(command) => command.run(common),
        Command::Schema(command) => command.run(common),
        Command::Completions(command) => command.run(),
        Command::Man(command) => command.run(common),
    };
    ended(done, common.json)
}

/// The exit code; what went wrong is said. Data that did not come through are no success either.
fn ended(done: Result<(), Failure>, json: bool) -> ExitCode {
    let done = done.and_then(|()| match unsaid() {
        Some(error) => Err(Failure::input_with_help(
            format!("standard output cannot be written: {error}"),
            "What was printed is cut. Make room, or send it elsewhere.",
        )),
        None => Ok(()),
    });
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.print(json),
    }
}

/// The command that gives the same numbers: this one, without where they go, how loud and on how many threads.
fn command_line() -> String {
    let mut words = vec!["granulens".to_owned()];
    // A name that is no text stands as it is shown.
    let mut given = std::env::args_os().skip(1).map(|word| word.to_string_lossy().into_owned());
    while let Some(word) = given.next() {
        match word.as_str() {
            "--out" | "--threads" => drop(given.next()),
            "--quiet" | "-q" | "--json" | "--force" | "--dry-run" => {}
            // An empty word, and one that a shell would part, stand in quotes.
            word if word.starts_with("--out=") || word.starts_with("--threads=") => {}
            word if word.is_empty() || word.contains([' ', '"', '\'', '*', '$', '&', ';', '(', ')']) => {
                words.push(format!("\"{}\"", word.replace('"', "\\\"")));
            }
            word => words.push(word.to_owned()),
        }
    }
    words.join(" ")
}

/// The crystal that a wave-speed bound is asked of.
#[derive(Args)]
struct Crystal {
    /// 1 chain, 2 hexagonal sheet, 3 close packing
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u8).range(1..=3))]
    dimension: u8,
    /// Sphere diameter: stiffness and forces are meant at it; the speed does not depend on it
    #[arg(long, default_value = "6.35 mm", allow_hyphen_values = true, value_parser = length)]
    diameter: f64,
    /// Set of fitted constants: code, text, sixteenth-inch or eq-4.7
    #[arg(long, default_value_t = granulens::contact::Constants::Code)]
    constants: granulens::contact::Constants,
}

impl Crystal {
    fn dimension(&self) -> granulens::wave::Dimension {
        granulens::wave::Dimension::from_number(self.dimension).expect("the parser lets pass 1 to 3")
    }
}

/// How the motion is followed, where it differs from the design file.
#[derive(Args)]
struct Motion {
    /// verlet, adams or rk4
    #[arg(long, value_name = "NAME")]
    integrator: Option<granulens::dem::Integrator>,
    /// Time step, such as "5e-8 s"
    #[arg(long, value_name = "TIME", allow_hyphen_values = true, value_parser = time)]
    step: Option<f64>,
    /// Window, such as "250 us"
    #[arg(long, value_name = "TIME", allow_hyphen_values = true, value_parser = time)]
    window: Option<f64>,
}

impl Motion {
    fn overrides(&self, common: &Common) -> Overrides {
        Overrides { integrator: self.integrator, step: self.step, window: self.window, first_seed: common.seed }
    }
}

/// Over how many forces a layout is judged.
#[derive(Args)]
struct Band {
    /// Judge over so many forces, evenly spaced about the design's own: the score is exp of the mean of ln, ± the standard
    /// deviation of one force's score [default: 8 of run and compare, 1 of check and studies]
    #[arg(long, value_name = "N")]
    forces: Option<usize>,
    /// How far the outermost of them lie from the design's own [default: "1 %"]
    #[arg(long, value_name = "PERCENT", requires = "forces", value_parser = fraction)]
    band: Option<f64>,
}

impl Band {
    /// As asked for, or else as usual.
    fn or(&self, usual: Forces) -> Result<Forces, Failure> {
        let Some(count) = self.forces else { return Ok(usual) };
        Forces::new(count, self.band.unwrap_or(Forces::USUAL.band())).map_err(|error| {
            Failure::input_with_help(format!("--forces: {error}"), "Write it like --forces 8 --band \"1 %\".")
        })
    }
}

fn fraction(text: &str) -> Result<f64, String> {
    Dimension::Fraction.parse(text).map_err(|error| error.to_string())
}

fn time(text: &str) -> Result<f64, String> {
    let time = Dimension::Time.parse(text).map_err(|error| error.to_string())?;
    if time > 0.0 { Ok(time) } else { Err("must be positive".to_owned()) }
}

fn length(text: &str) -> Result<f64, String> {
    let length = Dimension::Length.parse(text).map_err(|error| error.to_string())?;
    if length > 0.0 { Ok(length) } else { Err("must be positive".to_owned()) }
}

/// The design's lens, proposed.
fn propose(design: &Design) -> Result<granulens::lens::Lens, Failure> {
    Ok(design.propose()?)
}

/// Refuses a sheet whose rows have spheres of several sizes, where all are taken for equal.
fn asks_equal_spheres(design: &granulens::design::Design, what: &str) -> Result<(), failure::Failure> {
    if design.lattice.is_equal() {
        return Ok(());
    }
    Err(failure::Failure::input_with_help(
        format!(
            "{what} takes sheets of equal spheres alone, and this one has rows of several sizes (crystal.diameters)"
        ),
        "check, compare, study, simulate and export take it.",
    ))
}
