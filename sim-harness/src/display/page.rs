//! The page: one file of HTML with its script and style from the binary, and the state as server-sent events.
//!
//! In: a [`Hub`]. Out: HTTP on a loopback address.
//!
//! | path | what |
//! |---|---|
//! | `/` and its assets | the page; no other host is asked for anything |
//! | `/events` | [`Update`]s as they come, at most [`LEAST_PAUSE`] apart, at least one each [`LONGEST_PAUSE`] |
//! | `/state` | everything once, for other programs |
//! | `/setup` | train and track as described; `described` of an update counts its changes |
//! | `/units` | the resistance as learned of this unit and of those beside it |
//!
//! A browser that joins late gets all in its first update; one that was away reconnects by itself and does, too.

use super::hub::{Connection, Hub, LinkHealth, View};
use super::state::{Now, PastRun, Point, UNSETTLED};
use rundown_wire::Parameters;
use serde::Serialize;
use std::io::{self, Read, Write};
use std::net::{Ipv4Addr, SocketAddr, TcpListener, TcpStream};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::{borrow::Cow, sync::Arc, time::Duration};

/// A recording played at once makes more updates than an eye takes.
pub const LEAST_PAUSE: Duration = Duration::from_millis(100);
/// The age of what is shown is shown.
pub const LONGEST_PAUSE: Duration = Duration::from_secs(1);
/// Connections at once; each has a thread.
const MOST_CONNECTIONS: usize = 64;
/// A browser that takes longer to ask, or to take an answer, has gone.
const REQUEST_TIME: Duration = Duration::from_secs(10);
const LONGEST_REQUEST: usize = 16 * 1024;

const JSON: &str = "application/json";

struct Asset {
    path: &'static str,
    kind: &'static str,
    text: &'static str,
}

macro_rules! asset {
    ($path:literal, $kind:literal, $file:literal) => {
        Asset { path: $path, kind: $kind, text: include_str!(concat!("../../assets/", $file)) }
    };
}

const ASSETS: [Asset; 8] = [
    asset!("/", "text/html", "display/index.html"),
    asset!("/display.css", "text/css", "display/display.css"),
    asset!("/display.js", "text/javascript", "display/display.js"),
    asset!("/axes.js", "text/javascript", "pages/axes.js"),
    asset!("/charts.js", "text/javascript", "display/charts.js"),
    asset!("/uplot.js", "text/javascript", "uplot/uPlot.iife.min.js"),
    asset!("/uplot.css", "text/css", "uplot/uPlot.min.css"),
    asset!("/uplot.txt", "text/plain", "uplot/LICENSE"),
];

#[derive(Debug, Serialize)]
pub struct Update<'a> {
    epoch: u32,
    /// Points from this one on take the place of what the browser has.
    from: usize,
    points: &'a [Point],
    now: &'a Now,
    link: LinkHealth,
    described: u32,
    missing_runs: u32,
    #[serde(skip_serializing_if = "Option::is_none")]
    previous: Option<&'a [Point]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    past: Option<&'a [PastRun]>,
}

#[derive(Clone, Copy, Debug, Default)]
struct Cursor {
    version: u64,
    epoch: Option<u32>,
    points: usize,
    ended: Option<u32>,
}

impl Cursor {
    fn update<'a>(&mut self, view: View<'a>) -> Update<'a> {
        let View { state, link, described, version, .. } = view;
        let restarted = self.epoch != Some(state.epoch);
        let from = if restarted { 0 } else { self.points.min(state.points.len()).saturating_sub(UNSETTLED) };
        let more_runs = self.ended != Some(state.ended);
        *self = Self { version, epoch: Some(state.epoch), points: state.points.len(), ended: Some(state.ended) };
        Update {
            epoch: state.epoch,
            from,
            points: state.points.get(from..).unwrap_or_default(),
            now: &state.now,
            link,
            described,
            missing_runs: state.missing_runs,
            previous: restarted.then_some(&state.previous[..]),
            past: more_runs.then_some(&state.past[..]),
        }
    }
}

/// The page's server: a thread for each connection, a connection for each request.
pub struct PageServer {
    listener: TcpListener,
    address: SocketAddr,
    hub: Arc<Hub>,
    /// Other units, of which only the learned resistance is shown.
    beside: Vec<Arc<Hub>>,
    connections: AtomicUsize,
}

/// A unit among several.
#[derive(Debug, Serialize)]
struct PageUnit {
    source: String,
    connection: Connection,
    parameters: Option<Parameters>,
}

impl PageServer {
    /// On this port of the loopback interface; 0 takes a free one.
    pub fn bind(port: u16, hub: Arc<Hub>, beside: Vec<Arc<Hub>>) -> io::Result<Self> {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port))?;
        Ok(Self { address: listener.local_addr()?, listener, hub, beside, connections: AtomicUsize::new(0) })
    }

    pub fn url(&self) -> String {
        format!("http://{}/", self.address)
    }

    pub fn serve(self) {
        let page = Arc::new(self);
        loop {
            // What fails is one connection: a browser that has gone meanwhile, or too many of them.
            let Ok((browser, _)) = page.listener.accept() else {
                std::thread::sleep(LEAST_PAUSE);
                continue;
            };
            if page.connections.fetch_add(1, Ordering::Relaxed) >= MOST_CONNECTIONS {
                page.connections.fetch_sub(1, Ordering::Relaxed);
                continue;
            }
            let page = Arc::clone(&page);
            std::thread::spawn(move || {
                // A browser that has gone is no matter of ours.
                let _ = page.answer(browser);
                page.connections.fetch_sub(1, Ordering::Relaxed);
            });
        }
    }

    fn answer(&self, mut browser: TcpStream) -> io::Result<()> {
        browser.set_read_timeout(Some(REQUEST_TIME))?;
        browser.set_write_timeout(Some(REQUEST_TIME))?;
        browser.set_nodelay(true)?;
        let (status, kind, text) = match read_request(&mut browser)? {
            None => ("400 Bad Request", "text/plain", Cow::from("no request")),
            Some(request) if !self.is_ours(&request) => ("403 Forbidden", "text/plain", "another host's name".into()),
            Some(request) => match request.path.as_str() {
                "/events" => return tell(&self.hub, browser),
                "/setup" => ("200 OK", JSON, self.setup()?.into()),
                "/units" => ("200 OK", JSON, self.units()?.into()),
                "/state" => ("200 OK", JSON, self.state()?.into()),
                path => match ASSETS.iter().find(|asset| asset.path == path) {
                    Some(asset) => ("200 OK", asset.kind, asset.text.into()),
                    None => ("404 Not Found", "text/plain", "no such page".into()),
                },
            },
        };
        write!(
            browser,
            "HTTP/1.1 {status}\r\nContent-Type: {kind}; charset=utf-8\r\nContent-Length: {}\r\nConnection: close\r\n\
             Cache-Control: no-store\r\nX-Content-Type-Options: nosniff\r\n\
             Content-Security-Policy: default-src 'self'; img-src 'self' data:\r\n\r\n{text}",
            text.len()
        )
    }

    fn state(&self) -> io::Result<String> {
        Ok(self.hub.view(|view| serde_json::to_string(&Cursor::default().update(view)))?)
    }

    fn units(&self) -> io::Result<String> {
        let unit = |View { state, link, .. }: View<'_>| {
            let LinkHealth { source, connection, .. } = link;
            PageUnit { source, connection, parameters: state.now.parameters }
        };
        let all = std::iter::once(&self.hub).chain(&self.beside);
        Ok(serde_json::to_string(&all.map(|hub| hub.view(unit)).collect::<Vec<_>>())?)
    }

    fn setup(&self) -> io::Result<String> {
        Ok(self.hub.view(|view| serde_json::to_string(view.setup))?)
    }

    /// A page of another site must not read this one under a name of its own (DNS rebinding).
    fn is_ours(&self, request: &HttpRequest) -> bool {
        let port = self.address.port();
        let names = [format!("127.0.0.1:{port}"), format!("localhost:{port}")];
        names.contains(&request.host)
    }
}

struct HttpRequest {
    path: String,
    host: String,
}

/// The head of a GET request; nothing if it is none.
fn read_request(browser: &mut impl Read) -> io::Result<Option<HttpRequest>> {
    let mut head = Vec::new();
    let mut piece = [0; 1024];
    loop {
        let read = browser.read(&mut piece)?;
        head.extend(piece.iter().take(read));
        let mut headers = [httparse::EMPTY_HEADER; 64];
        let mut request = httparse::Request::new(&mut headers);
        match request.parse(&head) {
            Ok(httparse::Status::Complete(_)) if request.method == Some("GET") => {
                let host = request.headers.iter().find(|h| h.name.eq_ignore_ascii_case("host"));
                let path = request.path.unwrap_or_default();
                return Ok(Some(HttpRequest {
                    path: path.split('?').next().unwrap_or_default().to_owned(),
                    host: host.map_or_else(String::new, |h| String::from_utf8_lossy(h.value).into()),
                }));
            }
            Ok(httparse::Status::Partial) if read > 0 && head.len() < LONGEST_REQUEST => {}
            _ => return Ok(None),
        }
    }
}

fn tell(hub: &Hub, mut browser: impl Write) -> io::Result<()> {
    browser.write_all(
        b"HTTP/1.1 200 OK\r\nContent-Type: text/event-stream\r\nCache-Control: no-store\r\nConnection: close\r\n\r\nretry: 1000\n\n",
    )?;
    let mut cursor = Cursor::default();
    loop {
        let json = hub.wait(cursor.version, LONGEST_PAUSE, |view| serde_json::to_string(&cursor.update(view)))?;
        // Fails when the browser has gone, which ends it.
        browser.write_all(format!("data: {json}\n\n").as_bytes())?;
        std::thread::sleep(LEAST_PAUSE);
    }
}

#[cfg(test)]
mod tests {
    use rundown::features::FeatureConfig;

    #[test]
    fn the_page_says_at_which_speeds_the_powers_are() {
        let FeatureConfig { max_power_window_kmh, power_window_kmh, .. } = FeatureConfig::default();
        let page = include_str!("../../assets/display/index.html");
        for (name, [from, to]) in [("max", max_power_window_kmh), ("mean", power_window_kmh)] {
            assert!(page.contains(&format!("{name} power <small>{from}\u{2013}{to}</small>")), "{name}");
            assert!(page.to_lowercase().contains(&format!("at {from}\u{2013}{to} km/h")), "{name}");
        }
    }
}
