//! The page: one file of HTML with its script and style from the binary, and the state as server-sent events.
//!
//! In: a [`Hub`]. Out: HTTP on a loopback address.
//!
//! | path | what |
//! |---|---|
//! | `/` and its assets | the page; no other host is asked for anything |
//! | `/events` | [`Update`]s as they come, at most [`LEAST_PAUSE`] apart, at least one each [`LONGEST_PAUSE`] |
//! | `/state` | everything once, for other programs |
//! | `/setup` | train and track as described |
//!
//! A browser that joins late gets all in its first update; one that was away reconnects by itself and does, too.

use super::hub::{Hub, LinkHealth, View};
use super::setup::Setup;
use super::state::{Now, PastRun, Point, UNSETTLED};
use serde::Serialize;
use std::io::{self, Write};
use std::net::{Ipv4Addr, SocketAddr, TcpListener};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;
use tiny_http::{Header, Request, Response, Server};

/// A recording played at once makes more updates than an eye takes.
pub const LEAST_PAUSE: Duration = Duration::from_millis(100);
/// The age of what is shown is shown.
pub const LONGEST_PAUSE: Duration = Duration::from_secs(1);
/// Browsers that are told at once; each has a thread.
const MOST_BROWSERS: usize = 32;

struct Asset {
    path: &'static str,
    kind: &'static str,
    text: &'static str,
}

macro_rules! asset {
    ($path:literal, $kind:literal, $file:literal) => {
        Asset {
            path: $path,
            kind: $kind,
            text: include_str!(concat!("../../assets/", $file)),
        }
    };
}

const ASSETS: [Asset; 6] = [
    asset!("/", "text/html", "display/index.html"),
    asset!("/display.css", "text/css", "display/display.css"),
    asset!("/display.js", "text/javascript", "display/display.js"),
    asset!("/charts.js", "text/javascript", "display/charts.js"),
    asset!("/uplot.js", "text/javascript", "uplot/uPlot.iife.min.js"),
    asset!("/uplot.css", "text/css", "uplot/uPlot.min.css"),
];

/// What a browser is told.
#[derive(Debug, Serialize)]
pub struct Update<'a> {
    epoch: u32,
    /// Points from this one on take the place of what the browser has.
    from: usize,
    points: &'a [Point],
    now: &'a Now,
    link: LinkHealth,
    #[serde(skip_serializing_if = "Option::is_none")]
    previous: Option<&'a [Point]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    past: Option<&'a [PastRun]>,
}

/// What a browser has.
#[derive(Clone, Copy, Debug, Default)]
struct Cursor {
    version: u64,
    epoch: Option<u32>,
    points: usize,
    ended: Option<u32>,
}

impl Cursor {
    fn update<'a>(&mut self, view: View<'a>) -> Update<'a> {
        let View {
            state,
            link,
            version,
        } = view;
        let anew = self.epoch != Some(state.epoch);
        let from = if anew {
            0
        } else {
            self.points
                .min(state.points.len())
                .saturating_sub(UNSETTLED)
        };
        let more_runs = self.ended != Some(state.ended);
        *self = Self {
            version,
            epoch: Some(state.epoch),
            points: state.points.len(),
            ended: Some(state.ended),
        };
        Update {
            epoch: state.epoch,
            from,
            points: state.points.get(from..).unwrap_or_default(),
            now: &state.now,
            link,
            previous: anew.then_some(&state.previous[..]),
            past: more_runs.then_some(&state.past[..]),
        }
    }
}

/// The page's server.
pub struct Page {
    server: Server,
    address: SocketAddr,
    hub: Arc<Hub>,
    setup: String,
    browsers: Arc<AtomicUsize>,
}

impl Page {
    /// On this port of the loopback interface; 0 takes a free one.
    ///
    /// # Errors
    /// The port is taken.
    pub fn bind(port: u16, hub: Arc<Hub>, setup: &Setup) -> io::Result<Self> {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port))?;
        let address = listener.local_addr()?;
        Ok(Self {
            server: Server::from_listener(listener, None).map_err(io::Error::other)?,
            address,
            hub,
            setup: serde_json::to_string(setup)?,
            browsers: Arc::default(),
        })
    }

    /// Where it is.
    pub fn url(&self) -> String {
        format!("http://{}/", self.address)
    }

    /// Answers until the process ends.
    pub fn serve(&self) {
        for request in self.server.incoming_requests() {
            // A browser that has gone is no matter of ours.
            let _ = self.answer(request);
        }
    }

    fn answer(&self, request: Request) -> io::Result<()> {
        if !self.is_ours(&request) {
            return request.respond(Response::empty(403));
        }
        let path = request.url().split('?').next().unwrap_or_default();
        if let Some(asset) = ASSETS.iter().find(|asset| asset.path == path) {
            return send(request, asset.kind, asset.text.to_owned());
        }
        match path {
            "/setup" => send(request, "application/json", self.setup.clone()),
            "/state" => {
                let json = self
                    .hub
                    .view(|view| serde_json::to_string(&Cursor::default().update(view)))?;
                send(request, "application/json", json)
            }
            "/events" => self.listen(request),
            _ => request.respond(Response::empty(404)),
        }
    }

    /// A page of another site must not read this one under a name of its own (DNS rebinding).
    fn is_ours(&self, request: &Request) -> bool {
        let port = self.address.port();
        let host = request
            .headers()
            .iter()
            .find(|header| header.field.equiv("Host"));
        host.is_none_or(|host| {
            [format!("127.0.0.1:{port}"), format!("localhost:{port}")]
                .iter()
                .any(|ours| host.value.as_str() == ours)
        })
    }

    fn listen(&self, request: Request) -> io::Result<()> {
        if self.browsers.fetch_add(1, Ordering::Relaxed) >= MOST_BROWSERS {
            self.browsers.fetch_sub(1, Ordering::Relaxed);
            return request.respond(Response::empty(503));
        }
        let (hub, browsers) = (Arc::clone(&self.hub), Arc::clone(&self.browsers));
        let tell = move || {
            // Ends when the browser has gone.
            let _ = tell(&hub, request.into_writer());
            browsers.fetch_sub(1, Ordering::Relaxed);
        };
        std::thread::Builder::new().spawn(tell).map(drop)
    }
}

fn send(request: Request, kind: &str, text: String) -> io::Result<()> {
    let mut response = Response::from_string(text);
    let headers = [
        format!("Content-Type: {kind}; charset=utf-8"),
        "Cache-Control: no-store".to_owned(),
        "Content-Security-Policy: default-src 'self'; img-src 'self' data:".to_owned(),
        "X-Content-Type-Options: nosniff".to_owned(),
    ];
    for header in headers {
        // Of our own making: none is malformed.
        if let Ok(header) = header.parse::<Header>() {
            response.add_header(header);
        }
    }
    request.respond(response)
}

fn tell(hub: &Hub, mut browser: impl Write) -> io::Result<()> {
    browser.write_all(
        b"HTTP/1.1 200 OK\r\nContent-Type: text/event-stream\r\nCache-Control: no-store\r\nConnection: close\r\n\r\nretry: 1000\n\n",
    )?;
    let mut cursor = Cursor::default();
    loop {
        let json = hub.wait(cursor.version, LONGEST_PAUSE, |view| {
            serde_json::to_string(&cursor.update(view))
        })?;
        write!(browser, "data: {json}\n\n")?;
        browser.flush()?;
        std::thread::sleep(LEAST_PAUSE);
    }
}
