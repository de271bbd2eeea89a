//! Output that survives a closed pipe, Ctrl-C, and progress.

use std::io::Write as _;
use std::sync::{LazyLock, Mutex, PoisonError};

use indicatif::{ProgressBar, ProgressStyle};

use granulens::{Context, Progress};

use super::Common;

/// Stopped by the first Ctrl-C.
static CONTEXT: LazyLock<Context> = LazyLock::new(|| {
    let context = Context::default();
    let asked = context.clone();
    // A handler that cannot be set leaves Ctrl-C as it was: the program then ends at once.
    let _ = ctrlc::set_handler(move || {
        if asked.stopped() {
            std::process::exit(130);
        }
        asked.stop();
    });
    context
});

/// The context of all work of a command: the first Ctrl-C asks it to stop, the second ends the program at once.
pub fn context() -> &'static Context {
    &CONTEXT
}

/// Why data did not reach standard output, if so.
static UNSAID: Mutex<Option<std::io::Error>> = Mutex::new(None);

/// Prints data. A reader who has closed the pipe has seen enough; any other failure is told when the command ends, see [`unsaid`].
pub fn emit(text: &str) {
    let mut out = std::io::stdout().lock();
    let end = if text.ends_with('\n') { "" } else { "\n" };
    let written = [text, end].iter().try_for_each(|part| out.write_all(part.as_bytes())).and_then(|()| out.flush());
    if let Err(error) = written
        && error.kind() != std::io::ErrorKind::BrokenPipe
    {
        UNSAID.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
    }
}

/// Why some of the data did not reach standard output, if so.
pub fn unsaid() -> Option<std::io::Error> {
    UNSAID.lock().unwrap_or_else(PoisonError::into_inner).take()
}

/// Prints one JSON value as data.
pub fn emit_json(value: &impl serde::Serialize) {
    emit(&pretty(value));
}

/// A JSON value as text for people and programs.
pub fn pretty(value: &impl serde::Serialize) -> String {
    // The values printed here have string keys, and numbers that are not finite become null: this cannot fail.
    serde_json::to_string_pretty(value).unwrap_or_default() + "\n"
}

/// Prints words for a person; with --json nothing but an error's object goes to stderr.
pub fn note(common: &Common, text: &str) {
    if !common.quiet && !common.json {
        say(text);
    }
}

/// Prints a line on stderr, if anyone still reads it.
pub fn say(text: &str) {
    let _ = writeln!(std::io::stderr().lock(), "{text}");
}

/// A bar on stderr that counts what is finished; hidden where stderr is no terminal.
pub struct Count(ProgressBar);

impl Count {
    pub fn new(common: &Common, length: usize, what: &str) -> Self {
        let bar = if common.quiet { ProgressBar::hidden() } else { ProgressBar::new(length as u64) };
        let template = format!("{{bar:30}} {{pos}}/{{len}} {what}, {{elapsed}} ({{eta}} left) {{msg}}");
        if let Ok(style) = ProgressStyle::with_template(&template) {
            bar.set_style(style);
        }
        bar.tick();
        Self(bar)
    }

    pub fn finished(&self, name: &str) {
        self.0.set_message(name.to_owned());
        self.0.inc(1);
    }

    /// The context of work whose progress the bar shows.
    pub fn context(&self) -> Context {
        let bar = self.0.clone();
        context().telling(move |progress| {
            if let Progress::Finished { count, name } = *progress {
                if !name.is_empty() {
                    bar.set_message(name.to_owned());
                }
                bar.inc(count);
            }
        })
    }

    /// So many more are done, whatever their names.
    pub fn advance(&self, count: u64) {
        self.0.inc(count);
    }

    pub fn done(self) {
        self.0.finish_and_clear();
    }
}

/// A bar on stderr that follows a quantity; hidden where stderr is no terminal.
pub struct Steps(ProgressBar);

impl Steps {
    /// Up to a known end, in a unit.
    pub fn new(common: &Common, end: f64, unit: &str) -> Self {
        let bar = if common.quiet { ProgressBar::hidden() } else { ProgressBar::new(end.ceil() as u64) };
        if let Ok(style) = ProgressStyle::with_template(&format!(
            "{{bar:30}} {{pos}}/{{len}} {unit}, {{elapsed}} ({{eta}} left) {{msg}}"
        )) {
            bar.set_style(style);
        }
        Self(bar)
    }

    /// To an end that is not known.
    pub fn unbounded(common: &Common) -> Self {
        let bar = if common.quiet { ProgressBar::hidden() } else { ProgressBar::new_spinner() };
        if let Ok(style) = ProgressStyle::with_template("{spinner} {elapsed} {msg}") {
            bar.set_style(style);
        }
        Self(bar)
    }

    pub fn at(&self, position: f64, message: &str) {
        self.0.set_position(position as u64);
        self.0.set_message(message.to_owned());
    }

    /// The context of a pile that settles while the bar is shown.
    pub fn context(&self) -> Context {
        let bar = self.0.clone();
        context().telling(move |progress| {
            if let Progress::Settling { time, kinetic } = *progress {
                bar.set_position(time as u64);
                bar.set_message(format!("settling: {time:.0} tau_c, kinetic energy {kinetic:.1e} m g d"));
            }
        })
    }

    pub fn done(self) {
        self.0.finish_and_clear();
    }
}
