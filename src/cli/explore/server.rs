//! Who may ask, and what is answered.
//!
//! The server listens on the loopback interface alone. Everything lies below a random token of 128 bits, so that other programs and
//! other users cannot guess it, and nothing is answered to a page of another origin or under another name of this machine, by which a
//! foreign page could make a browser ask. Bodies are limited.

use std::io::{Read as _, Write as _};
use std::net::SocketAddr;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use serde_json::{Value, json};
use tiny_http::{Method, Request};

use granulens::Context;

use super::work::{Work, caught};
use super::{Opened, assets, desk, play, rank, save, scene, slow, study, surface};
use crate::cli::failure::Failure;

/// Longest body of a request (bytes): a layout of a million spheres.
const MOST_BODY: u64 = 4 << 20;

/// Threads that answer. Most wait for a computation of some tab; the pool of these is shared.
const THREADS: usize = 12;

/// How often it is looked whether the server is to end.
const PATIENCE: Duration = Duration::from_millis(100);

/// What is answered.
pub struct Answer {
    status: u16,
    kind: &'static str,
    body: Vec<u8>,
}

impl Answer {
    /// A file of the page.
    pub fn file(kind: &'static str, body: impl Into<Vec<u8>>) -> Self {
        Self { status: 200, kind, body: body.into() }
    }

    /// An object.
    pub fn json(value: &Value) -> Self {
        Self::file("application/json", value.to_string())
    }

    fn refused(status: u16, message: &str) -> Self {
        let body = json!({ "error": { "kind": "refused", "message": message } }).to_string();
        Self { status, kind: "application/json", body: body.into() }
    }
}

impl From<Failure> for Answer {
    fn from(failure: Failure) -> Self {
        Self::json(&json!({ "error": failure.told() }))
    }
}

/// What all requests share.
pub struct Shared {
    pub opened: Opened,
    pub work: Work,
    /// One save at a time.
    pub saving: Mutex<()>,
    pub study: study::Runner,
    /// Threads for proposals alone: those of simulations are busy for tenths of a second at a time, and a drag is to be followed meanwhile.
    proposals: rayon::ThreadPool,
}

/// Threads for proposals.
const PROPOSING: usize = 4;

/// A server that listens.
pub struct Server {
    listener: Arc<tiny_http::Server>,
    here: SocketAddr,
    token: String,
    shared: Arc<Shared>,
}

impl Server {
    pub fn new(opened: Opened, port: u16) -> Result<Self, Failure> {
        let fail = |what: &str, error: &dyn std::fmt::Display| {
            Failure::input_with_help(format!("{what}: {error}"), "Leave --port out to have a free one chosen.")
        };
        let listener =
            tiny_http::Server::http(("127.0.0.1", port)).map_err(|error| fail("the page cannot be served", &error))?;
        let here = listener.server_addr().to_ip().ok_or_else(|| fail("the page cannot be served", &"no address"))?;
        let mut token = [0; 16];
        getrandom::fill(&mut token).map_err(|error| fail("there are no random numbers", &error))?;
        let token = token.map(|byte| format!("{byte:02x}")).concat();
        let threads = rayon::current_num_threads().min(PROPOSING);
        let proposals = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .map_err(|error| fail("there are no threads", &error))?;
        let shared = Shared {
            opened,
            work: Work::default(),
            saving: Mutex::default(),
            study: study::Runner::default(),
            proposals,
        };
        Ok(Self { listener: Arc::new(listener), here, token, shared: Arc::new(shared) })
    }

    /// Where the page is.
    pub fn address(&self) -> String {
        format!("http://{}/{}/", self.here, self.token)
    }

    /// Answers until it is to end; what is under way is stopped then.
    pub fn serve(self, context: &Context) {
        let ended = Arc::new(Context::default());
        let gate = Arc::new(Gate { hosts: hosts(self.here), token: self.token });
        let threads: Vec<_> = (0..THREADS)
            .map(|_| {
                let (listener, ended) = (Arc::clone(&self.listener), Arc::clone(&ended));
                let (gate, shared) = (Arc::clone(&gate), Arc::clone(&self.shared));
                std::thread::spawn(move || {
                    while !ended.stopped() {
                        if let Ok(Some(request)) = listener.recv_timeout(PATIENCE) {
                            reply(request, &gate, &shared);
                        }
                    }
                })
            })
            .collect();
        while !context.stopped() {
            std::thread::sleep(PATIENCE);
        }
        ended.stop();
        self.shared.work.stop_all();
        self.shared.study.end();
        for thread in threads {
            let _ = thread.join();
        }
    }
}

/// The names under which this machine is asked.
fn hosts(here: SocketAddr) -> [String; 2] {
    let port = here.port();
    [format!("127.0.0.1:{port}"), format!("localhost:{port}")]
}

/// Who may pass.
struct Gate {
    hosts: [String; 2],
    token: String,
}

/// What a request says of itself.
#[derive(Default)]
struct Asking<'a> {
    host: Option<&'a str>,
    origin: Option<&'a str>,
    site: Option<&'a str>,
    kind: Option<&'a str>,
}

impl Gate {
    /// The path below the token, or why there is none.
    fn admit<'a>(&self, asking: &Asking, post: bool, path: &'a str) -> Result<&'a str, (u16, &'static str)> {
        let is_own = |host: &str| self.hosts.iter().any(|own| own.eq_ignore_ascii_case(host));
        // A name that leads here by a foreign hand, or none.
        if !asking.host.is_some_and(is_own) {
            return Err((403, "this address is not that of the page"));
        }
        let foreign = |origin: &str| !origin.strip_prefix("http://").is_some_and(is_own);
        if asking.origin.is_some_and(foreign)
            || asking.site.is_some_and(|site| !["same-origin", "none"].contains(&site))
        {
            return Err((403, "other pages may not ask"));
        }
        // What a form of a foreign page could send is no JSON.
        if post && !asking.kind.is_some_and(|kind| kind.starts_with("application/json")) {
            return Err((415, "JSON is expected"));
        }
        let (token, rest) = path.strip_prefix('/').and_then(|path| path.split_once('/')).unwrap_or(("", ""));
        if same(token.as_bytes(), self.token.as_bytes()) {
            Ok(rest.split('?').next().unwrap_or(""))
        } else {
            Err((404, "there is nothing here"))
        }
    }
}

/// Whether two texts are the same, in a time that does not tell where they differ.
fn same(a: &[u8], b: &[u8]) -> bool {
    a.len() == b.len() && a.iter().zip(b).fold(0, |differs, (a, b)| differs | (a ^ b)) == 0
}

fn reply(mut request: Request, gate: &Gate, shared: &Shared) {
    let answer = admitted(&mut request, gate, shared);
    let reason = match answer.status {
        200 => "OK",
        403 => "Forbidden",
        404 => "Not Found",
        405 => "Method Not Allowed",
        413 => "Content Too Large",
        415 => "Unsupported Media Type",
        _ => "Internal Server Error",
    };
    let mut text = format!(
        "HTTP/1.1 {} {reason}\r\nContent-Type: {}\r\nContent-Length: {}\r\nConnection: close\r\nCache-Control: no-store\r\n\
         Referrer-Policy: no-referrer\r\nX-Content-Type-Options: nosniff\r\nCross-Origin-Resource-Policy: same-origin\r\n\
         Content-Security-Policy: default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; \
         connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'\r\n\r\n",
        answer.status,
        answer.kind,
        answer.body.len()
    )
    .into_bytes();
    if *request.method() != Method::Head {
        text.extend(answer.body);
    }
    // A connection that is kept holds one of the few threads of tiny_http, and a browser keeps six: then others would wait for ever.
    // In one piece: what comes in several would wait for the browser's word on the first, some 40 ms.
    let mut writer = request.into_writer();
    let _ = writer.write_all(&text).and_then(|()| writer.flush());
}

fn admitted(request: &mut Request, gate: &Gate, shared: &Shared) -> Answer {
    let header = |name: &'static str| {
        request.headers().iter().find(|header| header.field.equiv(name)).map(|header| header.value.as_str())
    };
    let asking = Asking {
        host: header("Host"),
        origin: header("Origin"),
        site: header("Sec-Fetch-Site"),
        kind: header("Content-Type"),
    };
    let post = *request.method() == Method::Post;
    let url = request.url().to_owned();
    let path = match gate.admit(&asking, post, &url) {
        Ok(path) => path,
        Err((status, message)) => return Answer::refused(status, message),
    };
    match (request.method(), path.strip_prefix("api/")) {
        (Method::Get | Method::Head, None) => {
            assets::find(path).unwrap_or_else(|| Answer::refused(404, "there is nothing here"))
        }
        (Method::Post, Some(name)) => {
            let mut body = Vec::new();
            let read = request.as_reader().take(MOST_BODY + 1).read_to_end(&mut body);
            if body.len() as u64 > MOST_BODY {
                return Answer::refused(413, "a request may have 4 MB at most");
            }
            match read {
                Ok(_) => asked(name, &body, shared),
                Err(_) => Answer::refused(400, "the request could not be read"),
            }
        }
        _ => Answer::refused(405, "this cannot be asked in this way"),
    }
}

/// A question of the page.
fn asked(name: &str, body: &[u8], shared: &Shared) -> Answer {
    let answer = caught(|| match name {
        "open" => Ok(Answer::json(&desk::opened(&shared.opened))),
        "design" => of(body, |asked| shared.proposals.install(|| desk::look(asked, shared))),
        "scene" => of(body, |asked| scene::simulate(asked, shared)),
        "cancel" => of(body, |asked| scene::cancel(&asked, shared)),
        "play" => asks(body).and_then(|asked| play::play(&asked, shared)),
        "rank" => of(body, |asked| rank::ranking(&asked, shared)),
        "swaps" => of(body, |asked| slow::exchanged(&asked, shared)),
        "sensitivity" => of(body, |asked| slow::derivatives(&asked, shared)),
        "surface" => of(body, |asked| surface::show(&asked, shared)),
        "studies" => study::list(shared).map(|value| Answer::json(&value)),
        "study" => of(body, |asked| study::show(&asked, shared)),
        "study-start" => of(body, |asked| study::start(&asked, shared)),
        "study-stop" => study::stop(shared).map(|value| Answer::json(&value)),
        "study-layout" => of(body, |asked| study::layout(&asked, shared)),
        "study-compare" => of(body, |asked| study::side_by_side(&asked, shared)),
        "save" => of(body, |asked| {
            let _one = shared.saving.lock().unwrap_or_else(PoisonError::into_inner);
            save::save(asked, shared)
        }),
        _ => Ok(Answer::refused(404, "there is nothing here")),
    });
    match answer {
        Ok(Ok(answer)) => answer,
        Ok(Err(failure)) => failure.into(),
        Err(words) => Answer::json(&json!({ "error": {
            "kind": "crash",
            "message": format!("the computation crashed: {words}"),
            "help": "This is a fault of granulens. The page goes on; change the design, or run it on the command line and report what it says.",
        } })),
    }
}

/// Reads what is asked.
fn asks<T: serde::de::DeserializeOwned>(body: &[u8]) -> Result<T, Failure> {
    serde_json::from_slice(body).map_err(|error| Failure::input(format!("the request: {error}")))
}

/// Reads what is asked, and answers it.
fn of<T: serde::de::DeserializeOwned>(
    body: &[u8],
    answer: impl FnOnce(T) -> Result<Value, Failure>,
) -> Result<Answer, Failure> {
    answer(asks(body)?).map(|value| Answer::json(&value))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gate() -> Gate {
        Gate { hosts: hosts(([127, 0, 0, 1], 8000).into()), token: "secret".to_owned() }
    }

    const OWN: Asking =
        Asking { host: Some("127.0.0.1:8000"), origin: None, site: None, kind: Some("application/json") };

    #[test]
    fn only_the_own_page_passes() {
        let gate = gate();
        assert_eq!(gate.admit(&OWN, true, "/secret/api/design?x"), Ok("api/design"));
        assert_eq!(gate.admit(&Asking { host: Some("LOCALHOST:8000"), ..OWN }, false, "/secret/"), Ok(""));
        let origin = Some("http://localhost:8000");
        assert!(gate.admit(&Asking { origin, site: Some("same-origin"), ..OWN }, true, "/secret/api/design").is_ok());
        for (asking, status) in [
            (Asking { host: Some("evil.example:8000"), ..OWN }, 403),
            (Asking { host: Some("127.0.0.1:9000"), ..OWN }, 403),
            (Asking { host: None, ..OWN }, 403),
            (Asking { origin: Some("http://evil.example"), ..OWN }, 403),
            (Asking { origin: Some("null"), ..OWN }, 403),
            (Asking { origin: Some("https://127.0.0.1:8000"), ..OWN }, 403),
            (Asking { site: Some("cross-site"), ..OWN }, 403),
            (Asking { site: Some("same-site"), ..OWN }, 403),
            (Asking { kind: Some("text/plain"), ..OWN }, 415),
            (Asking { kind: None, ..OWN }, 415),
        ] {
            assert_eq!(gate.admit(&asking, true, "/secret/api/design").unwrap_err().0, status);
        }
        for path in ["/", "", "/secret", "/secre/", "/secrett/", "//secret/", "/x/secret/", "*"] {
            assert_eq!(gate.admit(&OWN, false, path), Err((404, "there is nothing here")), "{path}");
        }
    }
}
