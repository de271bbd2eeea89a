//! What went wrong, as text or as JSON, and the exit codes.

use std::io::{self, IsTerminal as _};
use std::process::ExitCode;

use granulens::design::{Design, DesignError};
use granulens::evaluate::{EvaluatorError, Overrides, PlanError};
use granulens::layout::LayoutFileError;
use granulens::output::OutputError;
use granulens::setup::SetupError;
use granulens::study::{ClaimError, StudyError};
use serde_json::{Map, Value, json};

use super::console::say;

/// Why the program does not end with 0.
pub enum Failure {
    /// Usage or input: 2.
    Input(Box<Input>),
    /// A guard stopped one or more runs: 1.
    Guard(Vec<String>),
    /// Rows of `reproduce` that do not come to their expected verdicts: 1.
    Deviation(Vec<String>),
    /// Thresholds of the design file that are not met: 3.
    Threshold(Vec<String>),
    /// Lines of the gate fail, thresholds that are not met beside others: 3.
    Gate {
        /// Thresholds.
        missed: Vec<String>,
        /// Other lines.
        failed: Vec<String>,
    },
    /// Others have to evaluate first what a study asks for: 4.
    Asked(String),
    /// Ctrl-C: 130.
    Interrupted(String),
}

/// What was wrong, where, and what to try.
#[derive(Default)]
pub struct Input {
    file: Option<String>,
    line: Option<u64>,
    key: Option<String>,
    message: String,
    help: Option<String>,
    /// What else is wrong with the file.
    others: Vec<Value>,
    /// The same with the place in the file drawn.
    drawn: Option<miette::Report>,
}

/// How errors are drawn: wrapped for a terminal, but whole lines for a file or a pipe, so that FILE:LINE stays together.
pub fn draw_errors() {
    let wrap = io::stderr().is_terminal();
    let options = move || miette::MietteHandlerOpts::new().wrap_lines(wrap).break_words(false);
    // Fails only if a way of drawing is chosen already, and none is.
    let _ = miette::set_hook(Box::new(move |_| Box::new(options().build())));
}

impl Failure {
    pub fn input(message: impl Into<String>) -> Self {
        Self::Input(Box::new(Input { message: message.into(), ..Input::default() }))
    }

    /// What clap says of the command line: the fault, and below it usage and hints.
    pub fn usage(error: &clap::Error) -> Self {
        let text = error.to_string();
        let text = text.trim().trim_start_matches("error: ");
        let (message, help) = match error.kind() {
            clap::error::ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => ("no subcommand is given", text),
            _ => text.split_once("\n\n").unwrap_or((text, "")),
        };
        Self::input_with_help(message, help.trim())
    }

    pub fn input_with_help(message: impl Into<String>, help: impl Into<String>) -> Self {
        let help = Some(help.into()).filter(|help| !help.is_empty());
        Self::Input(Box::new(Input { message: message.into(), help, ..Input::default() }))
    }

    /// What is wrong with a file, or one line of it.
    pub fn of_file(path: &std::path::Path, line: Option<u64>, message: &str) -> Self {
        let file = path.display().to_string();
        let at = line.map_or(String::new(), |line| format!("{line}:"));
        let message = format!("{file}:{at} {message}");
        Self::Input(Box::new(Input { file: Some(file), line, message, ..Input::default() }))
    }

    /// A step or window that cannot be: of the command line where it was given there, or of the design.
    pub fn of_plan<L, R>(design: &Design<L, R>, overrides: &Overrides, error: &PlanError) -> Self {
        let (name, given) = match error {
            PlanError::Step { .. } => ("step", overrides.step),
            PlanError::Window { .. } => ("window", overrides.window),
        };
        if given.is_some() {
            let key = Some(format!("--{name}"));
            let (message, help) = (format!("--{error}"), Some(error.help()));
            return Self::Input(Box::new(Input { key, message, help, ..Input::default() }));
        }
        design.blame_plan(error).into()
    }

    /// The word for its kind, and the exit code.
    fn kind(&self) -> (&'static str, u8) {
        match self {
            Self::Guard(_) => ("guard", 1),
            Self::Deviation(_) => ("deviation", 1),
            Self::Input(_) => ("input", 2),
            Self::Threshold(_) => ("threshold", 3),
            Self::Gate { .. } => ("gate", 3),
            Self::Asked(_) => ("asked", 4),
            Self::Interrupted(_) => ("interrupted", 130),
        }
    }

    /// As an object: its kind, what was wrong, where, and what to try.
    pub fn told(self) -> Value {
        let mut error = Map::new();
        let (kind, code) = self.kind();
        error.insert("kind".to_owned(), json!(kind));
        error.insert("exit_code".to_owned(), json!(code));
        match self {
            Self::Input(input) => {
                let Input { file, line, key, message, help, others, .. } = *input;
                let fields = [("file", json!(file)), ("line", json!(line)), ("key", json!(key))];
                error.extend(fields.into_iter().map(|(name, value)| (name.to_owned(), value)));
                error.insert("message".to_owned(), json!(message));
                error.insert("help".to_owned(), json!(help));
                if !others.is_empty() {
                    error.insert("others".to_owned(), json!(others));
                }
            }
            Self::Guard(messages) | Self::Deviation(messages) | Self::Threshold(messages) => {
                error.insert("message".to_owned(), json!(messages.join("; ")));
            }
            Self::Gate { missed, failed } => {
                error.insert("message".to_owned(), json!([missed, failed].concat().join("; ")));
            }
            Self::Asked(message) | Self::Interrupted(message) => {
                error.insert("message".to_owned(), json!(message));
            }
        }
        Value::Object(error)
    }

    /// Prints itself on stderr and gives the exit code.
    pub fn print(self, json: bool) -> ExitCode {
        let (_, code) = self.kind();
        if json {
            say(&json!({ "format": granulens::outcome::FORMAT, "error": self.told() }).to_string());
        } else {
            match self {
                Self::Input(input) => match *input {
                    Input { drawn: Some(report), .. } => say(format!("{report:?}").trim_end()),
                    Input { message, help, .. } => {
                        say(&format!("error: {message}"));
                        if let Some(help) = help {
                            say(&format!("  help: {help}"));
                        }
                    }
                },
                Self::Guard(messages) => messages.iter().for_each(|line| say(&format!("failed: {line}"))),
                Self::Deviation(rows) => rows.iter().for_each(|line| say(&format!("deviates: {line}"))),
                Self::Threshold(missed) => missed.iter().for_each(|line| say(&format!("threshold not met: {line}"))),
                Self::Gate { missed, failed } => {
                    missed.iter().for_each(|line| say(&format!("threshold not met: {line}")));
                    failed.iter().for_each(|line| say(&format!("gate: {line}")));
                }
                Self::Asked(message) => say(&format!("asked: {message}")),
                Self::Interrupted(message) => say(&format!("interrupted: {message}")),
            }
        }
        ExitCode::from(code)
    }
}

impl From<DesignError> for Failure {
    fn from(error: DesignError) -> Self {
        Self::Input(Box::new(Input {
            file: Some(error.file.display().to_string()),
            line: error.line.map(|line| line as u64),
            key: error.key.clone(),
            message: error.to_string(),
            help: Some(error.help.clone()).filter(|help| !help.is_empty()),
            others: error.others().iter().map(other).collect(),
            drawn: Some(miette::Report::new(error)),
        }))
    }
}

/// Another fault of the same file, as JSON.
fn other(error: &DesignError) -> Value {
    json!({ "line": error.line, "key": error.key, "message": error.to_string(), "help": error.help })
}

impl From<granulens::columns::TableError> for Failure {
    fn from(error: granulens::columns::TableError) -> Self {
        Self::Input(Box::new(Input {
            file: Some(error.path.display().to_string()),
            line: error.line,
            message: error.to_string(),
            help: Some(error.help),
            ..Input::default()
        }))
    }
}

impl From<OutputError> for Failure {
    fn from(error: OutputError) -> Self {
        Self::Input(Box::new(Input {
            file: Some(error.path().display().to_string()),
            message: error.to_string(),
            help: Some(error.help().to_owned()),
            ..Input::default()
        }))
    }
}

impl From<LayoutFileError> for Failure {
    fn from(error: LayoutFileError) -> Self {
        Self::Input(Box::new(Input {
            file: Some(error.path.display().to_string()),
            line: error.line,
            key: error.key.map(str::to_owned),
            message: error.to_string(),
            help: error.help.clone(),
            others: Vec::new(),
            drawn: Some(miette::Report::new(error)),
        }))
    }
}

impl From<StudyError> for Failure {
    fn from(error: StudyError) -> Self {
        match error {
            StudyError::Layout(error) => (*error).into(),
            StudyError::File(error) => (*error).into(),
            StudyError::Journal { path, message } => Self::of_file(&path, None, &message),
            StudyError::Engine(message) => Self::input(message),
            StudyError::Evaluator(EvaluatorError::Plan(error)) => {
                Self::input_with_help(format!("the study's {error}."), error.help())
            }
            StudyError::Evaluator(error) => error.into(),
        }
    }
}

impl From<ClaimError> for Failure {
    fn from(error: ClaimError) -> Self {
        match error {
            ClaimError::Output(error) => error.into(),
            error => Self::input_with_help(error.to_string(), error.help()),
        }
    }
}

impl From<EvaluatorError> for Failure {
    fn from(error: EvaluatorError) -> Self {
        let words = error.to_string();
        match error {
            EvaluatorError::Interrupted => Self::Interrupted(words),
            EvaluatorError::Baseline { .. } => Self::Guard(vec![words]),
            EvaluatorError::Plan(error) => Self::input_with_help(words, error.help()),
            EvaluatorError::Batch(_) | EvaluatorError::Overlap(_) => Self::input(words),
            EvaluatorError::NoReference => Self::input_with_help(
                words,
                "Name it in the design: lens.material, or compare.material where there is no lens.",
            ),
        }
    }
}

impl From<SetupError> for Failure {
    fn from(error: SetupError) -> Self {
        match error {
            SetupError::File(error) => error.into(),
            SetupError::Lens { design, error } => design.blame_lens(&error).into(),
            SetupError::Plan { design, error } => Self::of_plan(&design, &Overrides::default(), &error),
        }
    }
}

impl From<granulens::material::UnknownMaterial> for Failure {
    fn from(error: granulens::material::UnknownMaterial) -> Self {
        Self::input(error.to_string())
    }
}

impl From<granulens::evaluate::EvaluateError> for Failure {
    fn from(error: granulens::evaluate::EvaluateError) -> Self {
        Self::input(error.to_string())
    }
}

impl From<granulens::report::RunReportError> for Failure {
    fn from(error: granulens::report::RunReportError) -> Self {
        Self::input(error.to_string())
    }
}

impl From<granulens::report::ReportError> for Failure {
    fn from(error: granulens::report::ReportError) -> Self {
        Self::input(error.to_string())
    }
}
