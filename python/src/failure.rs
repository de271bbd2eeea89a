//! Errors: what is wrong, where, and what to try, in the words of the command line.

use granulens::columns::TableError;
use granulens::design::DesignError;
use granulens::evaluate::{EvaluateError, EvaluatorError};
use granulens::layout::LayoutFileError;
use granulens::output::OutputError;
use granulens::run::RunError;
use granulens::setup::SetupError;
use granulens::study::StudyError;
use pyo3::prelude::*;

/// What becomes an exception of `granulens`.
#[derive(Debug, Default)]
pub struct Failure {
    kind: Kind,
    message: String,
    help: Option<String>,
    file: Option<String>,
    line: Option<u64>,
    key: Option<String>,
}

#[derive(Debug, Default, Clone, Copy)]
enum Kind {
    /// What was given cannot be.
    #[default]
    Input,
    /// A guard stopped a run on which everything rests.
    Guard,
    /// Ctrl-C.
    Interrupted,
}

pub type Result<T> = std::result::Result<T, Failure>;

impl Failure {
    pub fn input(message: impl Into<String>) -> Self {
        Self { message: message.into(), ..Self::default() }
    }

    pub fn with_help(message: impl Into<String>, help: impl Into<String>) -> Self {
        let help = Some(help.into()).filter(|help| !help.is_empty());
        Self { message: message.into(), help, ..Self::default() }
    }

    pub fn interrupted(message: impl Into<String>) -> Self {
        Self { kind: Kind::Interrupted, message: message.into(), ..Self::default() }
    }

    pub fn guard(message: impl Into<String>) -> Self {
        Self { kind: Kind::Guard, message: message.into(), ..Self::default() }
    }
}

impl From<Failure> for PyErr {
    fn from(failure: Failure) -> Self {
        if let Kind::Interrupted = failure.kind {
            return pyo3::exceptions::PyKeyboardInterrupt::new_err(failure.message);
        }
        Python::attach(|py| {
            let name = match failure.kind {
                Kind::Guard => "GuardError",
                _ => "InputError",
            };
            let Failure { message, help, file, line, key, .. } = failure;
            let made = py
                .import("granulens._errors")
                .and_then(|module| module.getattr(name))
                .and_then(|class| class.call1((message, help, file, line, key)));
            match made {
                Ok(error) => Self::from_value(error),
                Err(error) => error,
            }
        })
    }
}

/// Errors that know neither file nor way out.
macro_rules! plain {
    ($($error:ty),* $(,)?) => { $(
        impl From<$error> for Failure {
            fn from(error: $error) -> Self {
                Self::input(error.to_string())
            }
        }
    )* };
}

plain!(
    granulens::material::UnknownMaterial,
    granulens::material::MaterialError,
    granulens::contact::UnknownName,
    granulens::contact::TuningError,
    granulens::evaluate::ForcesError,
    granulens::study::ShardError,
    granulens::network::NetworkError,
    granulens::motion::MotionError,
    granulens::bed::StoreError,
    granulens::dem::rig::RigError,
    granulens::wave::SurfaceError,
    granulens::report::RunReportError,
    granulens::units::UnitError,
);

impl From<DesignError> for Failure {
    fn from(error: DesignError) -> Self {
        Self {
            message: error.to_string(),
            help: Some(error.help.clone()),
            file: Some(error.file.display().to_string()),
            line: error.line.map(|line| line as u64),
            key: error.key.clone(),
            kind: Kind::Input,
        }
    }
}

impl From<LayoutFileError> for Failure {
    fn from(error: LayoutFileError) -> Self {
        Self {
            message: error.to_string(),
            help: error.help.clone(),
            file: Some(error.path.display().to_string()),
            line: error.line,
            key: error.key.map(str::to_owned),
            kind: Kind::Input,
        }
    }
}

impl From<TableError> for Failure {
    fn from(error: TableError) -> Self {
        Self {
            message: error.to_string(),
            help: Some(error.help.clone()),
            file: Some(error.path.display().to_string()),
            line: error.line,
            ..Self::default()
        }
    }
}

impl From<OutputError> for Failure {
    fn from(error: OutputError) -> Self {
        let file = Some(error.path().display().to_string());
        Self { message: error.to_string(), help: Some(error.help().to_owned()), file, ..Self::default() }
    }
}

impl From<EvaluateError> for Failure {
    fn from(error: EvaluateError) -> Self {
        Self::input(error.to_string())
    }
}

impl From<EvaluatorError> for Failure {
    fn from(error: EvaluatorError) -> Self {
        let words = error.to_string();
        match error {
            EvaluatorError::Interrupted => Self::interrupted(words),
            EvaluatorError::Baseline { .. } => Self::guard(words),
            EvaluatorError::Plan(error) => Self::with_help(words, error.help()),
            EvaluatorError::NoReference => Self::with_help(
                words,
                "Name it in the design: lens.material, or compare.material where there is no lens.",
            ),
            _ => Self::input(words),
        }
    }
}

impl From<SetupError> for Failure {
    fn from(error: SetupError) -> Self {
        match error {
            SetupError::File(error) => error.into(),
            SetupError::Lens { design, error } => design.blame_lens(&error).into(),
            SetupError::Plan { design, error } => design.blame_plan(&error).into(),
        }
    }
}

impl From<StudyError> for Failure {
    fn from(error: StudyError) -> Self {
        let words = error.to_string();
        match error {
            StudyError::File(error) => (*error).into(),
            StudyError::Layout(error) => (*error).into(),
            StudyError::Journal { path, .. } => {
                Self { message: words, file: Some(path.display().to_string()), ..Self::default() }
            }
            StudyError::Evaluator(error) => error.into(),
            StudyError::Engine(_) => Self::input(words),
        }
    }
}

impl From<RunError> for Failure {
    fn from(error: RunError) -> Self {
        Self::with_help(error.to_string(), error.help())
    }
}
