//! The page's server: on the loopback interface, for one scene, and for the page that knows its
//! token.
//!
//! Nothing of a request is a path. The page's files are compiled in, and the scene was chosen on
//! the command line. To look from another machine takes a tunnel:
//! `ssh -L PORT:127.0.0.1:PORT host`.

mod guard;
mod http;

use std::collections::{BTreeMap, HashMap};
use std::io;
use std::net::{Ipv4Addr, Shutdown, SocketAddrV4, TcpListener, TcpStream};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use firsthit::Error;
use firsthit::watch::Watch;
use serde_json::{Value, json};

use crate::answer::{Answer, AnswerError};
use crate::page_files;
use crate::viewer::{Viewer, lock};
use guard::Guard;
use http::{Method, Reader, Refusal, Request, Response, Status};

/// The most connections; more are turned away.
const MOST_CONNECTIONS: usize = 16;
/// A connection that says nothing for so long ends.
const IDLE: Duration = Duration::from_secs(60);
/// The most silence of a connection that has not asked with the token.
const IDLE_STRANGER: Duration = Duration::from_secs(5);
/// The time after the last question of a page at which the server ends.
const LINGERS: Duration = Duration::from_secs(180);
/// The time between two checks whether the server is to end.
const POLL: Duration = Duration::from_millis(20);

/// A server that listens.
#[derive(Debug)]
pub struct Server {
    listener: TcpListener,
    shared: Arc<Shared>,
    /// The time after the last question of a page at which it ends; `None`: never.
    lingers: Option<Duration>,
}

/// A connection that is open.
#[derive(Debug)]
struct Open {
    stream: TcpStream,
    /// Whether it has shown the token.
    is_known: bool,
}

impl Open {
    fn end(&self) {
        // It may be gone already.
        let _ = self.stream.shutdown(Shutdown::Both);
    }
}

/// The state that all connections share.
#[derive(Debug)]
struct Shared {
    viewer: Arc<Viewer>,
    guard: Guard,
    port: u16,
    is_stopped: AtomicBool,
    /// The number of connections so far.
    connections: AtomicU64,
    /// The open connections, by their numbers.
    open: Mutex<BTreeMap<u64, Open>>,
    /// The time at which a page asked last.
    asked: Mutex<Option<Instant>>,
    /// The number of the newest frame that each page has asked for.
    newest: Mutex<HashMap<String, Arc<AtomicU64>>>,
}

impl Server {
    /// Listens on a port of 127.0.0.1; on 0 the system chooses one.
    ///
    /// # Errors
    ///
    /// Where the port is taken, or the system has no random numbers.
    pub fn bind(viewer: impl Into<Arc<Viewer>>, port: u16) -> io::Result<Self> {
        let listener = TcpListener::bind(SocketAddrV4::new(Ipv4Addr::LOCALHOST, port))?;
        listener.set_nonblocking(true)?;
        let port = listener.local_addr()?.port();
        let shared = Arc::new(Shared {
            viewer: viewer.into(),
            guard: Guard::new(port)?,
            port,
            is_stopped: AtomicBool::new(false),
            connections: AtomicU64::new(0),
            open: Mutex::default(),
            asked: Mutex::new(None),
            newest: Mutex::default(),
        });
        Ok(Self { listener, shared, lingers: Some(LINGERS) })
    }

    /// Sets the time after the last question of a page at which the server ends; `None`: never.
    #[must_use]
    pub fn lingering(self, lingers: Option<Duration>) -> Self {
        Self { lingers, ..self }
    }

    /// The page's address. Its fragment is the token: browsers do not send fragments, and the page
    /// takes it out of the address bar.
    pub fn address(&self) -> String {
        let Shared { guard, port, .. } = &*self.shared;
        format!("http://127.0.0.1:{port}/#{}", guard.token())
    }

    /// Answers until `is_stopped` says so, or until no page has asked for as long as it lingers:
    /// three minutes by default. Then all connections end.
    pub fn run(&self, is_stopped: &dyn Fn() -> bool) {
        loop {
            let silence = lock(&self.shared.asked).map(|asked| asked.elapsed());
            let is_left = (self.lingers.zip(silence)).is_some_and(|(most, silence)| silence > most);
            if is_left || is_stopped() {
                self.shared.is_stopped.store(true, Ordering::Relaxed);
                for open in lock(&self.shared.open).values() {
                    open.end();
                }
                return;
            }
            match self.listener.accept() {
                Ok((stream, _)) => self.take(stream),
                Err(error) if error.kind() == io::ErrorKind::WouldBlock => std::thread::sleep(POLL),
                // One that was broken off, or too many open files: the next may do better.
                Err(_) => std::thread::sleep(POLL),
            }
        }
    }

    /// Serves a connection in a thread of its own.
    fn take(&self, mut stream: TcpStream) {
        let number = self.shared.connections.fetch_add(1, Ordering::Relaxed);
        let mut open = lock(&self.shared.open);
        if open.len() >= MOST_CONNECTIONS {
            // Who has not shown the token makes room for who may: the oldest of them.
            let strangers = || open.iter().filter(|(_, open)| !open.is_known);
            let Some(oldest) = strangers().map(|(&number, _)| number).next() else {
                // A page that is slow or gone must not disturb others, here and below.
                let _ = Response::bare(Status::BUSY).write(&mut stream, true);
                return;
            };
            if let Some(stranger) = open.remove(&oldest) {
                stranger.end();
            }
        }
        let Ok(again) = stream.try_clone() else {
            return;
        };
        let is_known = false;
        let newcomer = Open { stream: again, is_known };
        open.insert(number, newcomer);
        drop(open);
        let place = Place { shared: Arc::clone(&self.shared), number };
        let serve = move || drop(place.shared.serve(&stream, number));
        // Where no thread begins the place is free again with what it would have done.
        drop(std::thread::Builder::new().name("page".into()).spawn(serve));
    }
}

/// The place of a connection among the others, until that ends.
struct Place {
    shared: Arc<Shared>,
    number: u64,
}

impl Drop for Place {
    fn drop(&mut self) {
        lock(&self.shared.open).remove(&self.number);
    }
}

/// The number of requests that the reader of a connection finds before the connection ends or one
/// is refused. It is for fuzzing.
#[doc(hidden)]
pub fn requests(from: &mut dyn io::Read) -> usize {
    let mut reader = Reader::new(from, IDLE);
    std::iter::from_fn(|| reader.next().ok()).take_while(|(_, is_last)| !is_last).count()
}

/// The client that waits for an answer. Work for one that is gone ends, and so does all work when
/// the server does.
struct Caller<'a> {
    shared: &'a Shared,
    stream: &'a TcpStream,
    /// The time at which it was last known to be there.
    seen: Mutex<Instant>,
}

impl Caller<'_> {
    /// Whether it has closed the connection. Asked of the system now and then: work asks often.
    fn is_gone(&self) -> bool {
        let mut seen = lock(&self.seen);
        if seen.elapsed() < POLL {
            return false;
        }
        *seen = Instant::now();
        match self.stream.peek(&mut [0]) {
            Ok(count) => count == 0,
            Err(error) => error.kind() != io::ErrorKind::WouldBlock,
        }
    }

    /// Does work that ends when its client is gone.
    fn during<T>(&self, work: impl FnOnce() -> T) -> T {
        // A look at the connection must not wait. Where it cannot be had, work is done to its end.
        let _ = self.stream.set_nonblocking(true);
        let done = work();
        let _ = self.stream.set_nonblocking(false);
        done
    }
}

impl Watch for Caller<'_> {
    fn is_stopped(&self) -> bool {
        self.shared.is_stopped.load(Ordering::Relaxed) || self.is_gone()
    }
}

/// Ends a frame when its page has asked for a newer one.
struct Superseded<'a> {
    caller: &'a Caller<'a>,
    newest: Arc<AtomicU64>,
    own: u64,
}

impl Watch for Superseded<'_> {
    fn is_stopped(&self) -> bool {
        self.newest.load(Ordering::Relaxed) != self.own || self.caller.is_stopped()
    }
}

impl Shared {
    /// Answers the requests of a connection.
    fn serve(&self, stream: &TcpStream, number: u64) -> io::Result<()> {
        stream.set_nonblocking(false)?;
        stream.set_nodelay(true)?;
        // Who has not shown the token holds no place for long.
        stream.set_read_timeout(Some(IDLE_STRANGER))?;
        stream.set_write_timeout(Some(IDLE))?;
        let mut reader = Reader::new(stream, IDLE);
        let mut to = stream;
        loop {
            match reader.next() {
                Ok(_) if self.is_stopped.load(Ordering::Relaxed) => return Ok(()),
                Ok((request, is_last)) => {
                    if let Err(status) = self.guard.check(&request) {
                        return Response::bare(status).write(&mut to, true);
                    }
                    if request.method == Method::Post {
                        stream.set_read_timeout(Some(IDLE))?;
                        if let Some(open) = lock(&self.open).get_mut(&number) {
                            open.is_known = true;
                        }
                    }
                    self.answer(&request, stream).write(&mut to, is_last)?;
                    if is_last {
                        return Ok(());
                    }
                }
                Err(Refusal::Gone) => return Ok(()),
                Err(Refusal::Status(status)) => return Response::bare(status).write(&mut to, true),
            }
        }
    }

    fn answer(&self, request: &Request, stream: &TcpStream) -> Response {
        match request.method {
            Method::Get => match page_files::file(&request.path) {
                Some((kind, body)) => Response::new(Status::OK, kind, body),
                None => Response::bare(Status::NOT_FOUND),
            },
            Method::Post => {
                *lock(&self.asked) = Some(Instant::now());
                let caller = Caller { shared: self, stream, seen: Mutex::new(Instant::now()) };
                let answer = caller.during(|| self.question(request, &caller));
                answer.unwrap_or_else(|response| response)
            }
        }
    }

    fn question(&self, request: &Request, caller: &Caller<'_>) -> Result<Response, Response> {
        let question = request.path.strip_prefix('/').unwrap_or_default();
        match question {
            "alive" => Ok(found(&json!({}))),
            "info" => {
                let mut info = self.viewer.info();
                // The page reads files with the module.
                info["opens_files"] = true.into();
                Ok(found(&info))
            }
            "frame" => {
                let page = request.header("x-firsthit-page").unwrap_or_default();
                self.frame(&request.body, page, caller)
            }
            _ => {
                let answer = self.viewer.answer(question, &request.body, caller);
                answer.map(|answer| found(&answer.json)).map_err(|error| refused(&error))
            }
        }
    }

    fn frame(&self, body: &[u8], page: &str, caller: &Caller<'_>) -> Result<Response, Response> {
        let newest = {
            let mut pages = lock(&self.newest);
            if pages.len() >= MOST_CONNECTIONS && !pages.contains_key(page) {
                // Pages of long ago: what is asked for just now is held by who makes it.
                pages.retain(|_, newest| Arc::strong_count(newest) > 1);
            }
            Arc::clone(pages.entry(page.to_owned()).or_default())
        };
        let own = newest.fetch_add(1, Ordering::Relaxed) + 1;
        let watch = Superseded { caller, newest, own };
        let started = Instant::now();
        let answer = self.viewer.answer("frame", body, &watch);
        let Answer { mut json, pixels } = answer.map_err(|error| refused(&error))?;
        json["seconds"] = started.elapsed().as_secs_f64().into();
        let kind = match json.get("dtype") {
            None => "image/png",
            Some(_) => "application/octet-stream",
        };
        Ok(Response {
            extra: Some(("X-Firsthit-Frame", json.to_string())),
            ..Response::new(Status::OK, kind, pixels)
        })
    }
}

fn found(value: &Value) -> Response {
    Response::new(Status::OK, "application/json", value.to_string())
}

fn refused(error: &AnswerError) -> Response {
    let status = match error {
        AnswerError::Unknown(_) => Status::NOT_FOUND,
        AnswerError::Failed(Error::Interrupted) => Status::SUPERSEDED,
        AnswerError::Malformed(_) | AnswerError::Failed(_) => Status::BAD_REQUEST,
    };
    failed(status, &error.to_string())
}

fn failed(status: Status, why: &str) -> Response {
    Response::new(status, "application/json", json!({"error": why}).to_string())
}
