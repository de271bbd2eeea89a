//! What went wrong, as text or as JSON, and the exit codes.

use std::process::ExitCode;

use granulens::design::{Design, DesignError};
use granulens::evaluate::PlanError;
use granulens::layout::LayoutFileError;
use granulens::lens::LensError;
use serde_json::{Map, Value, json};

/// Why the program does not end with 0.
pub enum Failure {
    /// Usage or input: 2.
    Input(Box<Input>),
    /// A guard stopped a run: 1.
    Guard(String),
    /// Thresholds of the design file that are not met: 3.
    Threshold(Vec<String>),
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
    /// The same with the place in the file drawn.
    drawn: Option<miette::Report>,
}

impl Failure {
    pub fn input(message: impl Into<String>) -> Self {
        Self::Input(Box::new(Input { message: message.into(), ..Input::default() }))
    }

    pub fn usage(message: String) -> Self {
        Self::input(message.trim().trim_start_matches("error: ").to_owned())
    }

    /// A file that cannot be written.
    pub fn write(path: &std::path::Path, error: &std::io::Error) -> Self {
        Self::Input(Box::new(Input {
            file: Some(path.display().to_string()),
            message: format!("{}: cannot be written: {error}", path.display()),
            help: Some("Choose another place with --out.".to_owned()),
            ..Input::default()
        }))
    }

    /// A lens that cannot be, of a design.
    pub fn of_lens(design: &Design, error: &LensError) -> Self {
        Self::Input(Box::new(Input {
            file: Some(design.path.display().to_string()),
            key: Some("lens".to_owned()),
            message: format!("{}: lens: {error}", design.path.display()),
            ..Input::default()
        }))
    }

    /// A step or window that cannot be, of a design.
    pub fn of_plan(design: &Design, error: &PlanError) -> Self {
        Self::Input(Box::new(Input {
            file: Some(design.path.display().to_string()),
            key: Some(match error {
                PlanError::Step { .. } => "run.step".to_owned(),
                PlanError::Window { .. } => "run.window".to_owned(),
            }),
            message: format!("{}: {error}", design.path.display()),
            help: Some(error.help()),
            ..Input::default()
        }))
    }

    /// Prints itself on stderr and gives the exit code.
    pub fn print(self, json: bool) -> ExitCode {
        let (kind, code) = match &self {
            Self::Guard(_) => ("guard", 1),
            Self::Input(_) => ("input", 2),
            Self::Threshold(_) => ("threshold", 3),
            Self::Interrupted(_) => ("interrupted", 130),
        };
        if json {
            let mut error = Map::new();
            error.insert("kind".to_owned(), json!(kind));
            error.insert("exit_code".to_owned(), json!(code));
            match self {
                Self::Input(input) => {
                    let Input { file, line, key, message, help, .. } = *input;
                    let fields = [("file", json!(file)), ("line", json!(line)), ("key", json!(key))];
                    error.extend(fields.into_iter().map(|(name, value)| (name.to_owned(), value)));
                    error.insert("message".to_owned(), json!(message));
                    error.insert("help".to_owned(), json!(help));
                }
                Self::Guard(message) | Self::Interrupted(message) => {
                    error.insert("message".to_owned(), json!(message));
                }
                Self::Threshold(missed) => {
                    error.insert("message".to_owned(), json!(missed.join("; ")));
                }
            }
            eprintln!("{}", json!({ "format": granulens::outcome::FORMAT, "error": Value::Object(error) }));
        } else {
            match self {
                Self::Input(input) => match *input {
                    Input { drawn: Some(report), .. } => eprintln!("{report:?}"),
                    Input { message, help, .. } => {
                        eprintln!("error: {message}");
                        if let Some(help) = help {
                            eprintln!("  help: {help}");
                        }
                    }
                },
                Self::Guard(message) => eprintln!("failed: {message}"),
                Self::Threshold(missed) => missed.iter().for_each(|line| eprintln!("threshold not met: {line}")),
                Self::Interrupted(message) => eprintln!("interrupted: {message}"),
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
            help: Some(error.help.clone()),
            drawn: Some(miette::Report::new(error)),
        }))
    }
}

impl From<LayoutFileError> for Failure {
    fn from(error: LayoutFileError) -> Self {
        Self::Input(Box::new(Input {
            file: Some(error.path.display().to_string()),
            line: error.line,
            message: error.to_string(),
            ..Input::default()
        }))
    }
}

impl From<granulens::material::UnknownMaterial> for Failure {
    fn from(error: granulens::material::UnknownMaterial) -> Self {
        Self::input(error.to_string())
    }
}

impl From<granulens::dem::OverlapAtRest> for Failure {
    fn from(error: granulens::dem::OverlapAtRest) -> Self {
        Self::input(error.to_string())
    }
}

impl From<granulens::report::ReportError> for Failure {
    fn from(error: granulens::report::ReportError) -> Self {
        Self::input(error.to_string())
    }
}
