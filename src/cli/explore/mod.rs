//! `granulens explore`: a page on this machine that shows the lens while its target is dragged.
//!
//! - `server`: who may ask, and what is answered; `assets`: what the page is made of
//! - `work`: computations that newer ones take the place of, and crashes that become messages
//! - `desk`: a design under somebody's hands: its text, changes to it, what rays say
//! - `scene`: a layout under the design's impact: energies, scores, verdict
//! - `play`: the wave, frame by frame; `rank`: which material; `surface`: the design surface; `study`: searches
//! - `slow`: maps that take seconds, of what exchanging or changing single spheres does
//! - `save`: design, layout and report as files

mod assets;
mod desk;
mod play;
mod rank;
mod save;
mod scene;
mod server;
mod slow;
mod study;
mod surface;
mod work;

use std::path::{Path, PathBuf};

use granulens::design::Design;
use granulens::outcome::Outcome;
use granulens::study::Study;

use super::Common;
use super::console::{context, emit, note};
use super::failure::Failure;

/// Design by hand and eye: a page in the browser that shows the lens, its rays and its energies while they are dragged
///
/// The page is served to this machine alone, under an address that nobody can guess; it needs no network. Ctrl-C ends it.
#[derive(clap::Args)]
pub struct Explore {
    /// Design file, study file, or the outcome.json of a report; without, a design to begin with
    file: Option<PathBuf>,
    /// Only print the address, and leave it to others to open it
    #[arg(long)]
    no_open: bool,
    /// Port [default: a free one]
    #[arg(long, value_name = "N", default_value_t = 0, hide_default_value = true)]
    port: u16,
}

/// What the page begins with.
pub struct Opened {
    /// The design file's text.
    pub text: String,
    /// Its name, for messages.
    pub path: PathBuf,
    /// Whether that file holds the text.
    pub given: bool,
    /// A layout that was given: names of materials, and for each site a place among these.
    pub layout: Option<(Vec<String>, Vec<u8>)>,
    /// The study file, where one was given.
    pub study: Option<PathBuf>,
}

impl Explore {
    pub fn run(self, common: &Common) -> Result<(), Failure> {
        let opened = open(self.file.as_deref())?;
        let server = server::Server::new(opened, self.port)?;
        let address = server.address();
        note(common, "explorer: open the address in a browser on this machine; Ctrl-C ends it");
        emit(&address);
        if !self.no_open && !browse(&address) {
            note(common, "note: no browser could be started; open the address by hand");
        }
        server.serve(context());
        note(common, "explorer: ended");
        Ok(())
    }
}

/// A design to begin with.
const FIRST: &str = include_str!("first.toml");

fn open(file: Option<&Path>) -> Result<Opened, Failure> {
    let Some(path) = file else {
        return Ok(Opened {
            text: FIRST.to_owned(),
            path: PathBuf::from("design.toml"),
            given: false,
            layout: None,
            study: None,
        });
    };
    if path.extension().is_some_and(|extension| extension == "json") {
        return of_outcome(path);
    }
    let text = granulens::input::text(path).unwrap_or_default();
    if text.parse::<toml::Table>().is_ok_and(|table| table.get("design").is_some_and(toml::Value::is_str)) {
        let study = Study::read(path, None).map_err(Failure::from)?;
        let Some(Design { text, path: design, .. }) = study.design.plane().cloned() else {
            return Err(Failure::input_with_help(
                format!("{}: searches a crystal in space, and explore shows sheets", path.display()),
                "Run it with granulens study run; its page is report.html in the study's folder.",
            ));
        };
        return Ok(Opened { text, path: design, given: true, layout: None, study: Some(path.to_owned()) });
    }
    let design = Design::read(path)?;
    Ok(Opened { text: design.text, path: path.to_owned(), given: true, layout: None, study: None })
}

/// The design of a stored outcome, with the layout that it is about.
fn of_outcome(path: &Path) -> Result<Opened, Failure> {
    let text = granulens::input::text(path).map_err(|error| Failure::input(format!("{}: {error}", path.display())))?;
    let outcome: Outcome = serde_json::from_str(&text).map_err(|error| {
        Failure::input_with_help(
            format!("{}: is no outcome of granulens: {error}", path.display()),
            "An outcome is outcome.json in the folder of granulens run, or what granulens compare --out writes.",
        )
    })?;
    let path = PathBuf::from(&outcome.manifest.design_file);
    Design::parse(&path, &outcome.manifest.design)?;
    let first = outcome.arrangements.into_iter().next().filter(|_| outcome.proposal.is_none());
    Ok(Opened {
        text: outcome.manifest.design,
        path,
        given: false,
        layout: first.map(|first| (outcome.materials, first.layout)),
        study: None,
    })
}

/// Opens the address in the user's browser, and says whether that could be begun.
fn browse(address: &str) -> bool {
    use std::process::{Command, Stdio};
    let (program, arguments): (&str, &[&str]) = match std::env::consts::OS {
        "macos" => ("open", &[]),
        "windows" => ("rundll32", &["url.dll,FileProtocolHandler"]),
        _ => ("xdg-open", &[]),
    };
    let mut command = Command::new(program);
    command.args(arguments).arg(address).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    match command.spawn() {
        // It is waited for, so that no process without a parent is left.
        Ok(mut child) => {
            std::thread::spawn(move || child.wait());
            true
        }
        Err(_) => false,
    }
}
