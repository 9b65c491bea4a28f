//! Debian's Chromium, driven over WebDriver.

use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use thirtyfour::prelude::*;

/// How long the page may take to show what came: a frame is on it within a second, a process starts within some.
pub const PATIENCE: Duration = Duration::from_secs(15);

/// A browser and its driver; both end with the value.
pub struct Browser {
    driver: WebDriver,
    process: Child,
    port: u16,
}

impl Drop for Browser {
    // Also where a test fails: the driver is asked to end its browsers, and the client not to wait for an answer on the
    // runtime that is being left.
    fn drop(&mut self) {
        let _ = self.driver.clone().leak();
        let asked = TcpStream::connect(("127.0.0.1", self.port)).and_then(|mut stream| {
            stream.write_all(b"GET /shutdown HTTP/1.1\r\nHost: localhost\r\n\r\n")?;
            stream.read(&mut [0; 64])
        });
        let begin = Instant::now();
        while asked.is_ok() && begin.elapsed() < PATIENCE && matches!(self.process.try_wait(), Ok(None)) {
            std::thread::sleep(Duration::from_millis(20));
        }
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// Day or night.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scheme {
    Light,
    Dark,
}

impl Scheme {
    /// The word of the media feature.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Light => "light",
            Self::Dark => "dark",
        }
    }
}

impl Browser {
    /// Starts both.
    pub async fn start() -> Self {
        let port = TcpListener::bind("127.0.0.1:0").and_then(|socket| socket.local_addr()).expect("a free port").port();
        let mut process = Command::new("chromedriver")
            .arg(format!("--port={port}"))
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("chromedriver; `cargo xtask browser` installs it");
        let begin = Instant::now();
        loop {
            let mut capabilities = DesiredCapabilities::chrome();
            // Root has no sandbox, and a container little shared memory.
            for argument in
                ["--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--disable-gpu", "--hide-scrollbars"]
            {
                capabilities.add_arg(argument).expect("an argument");
            }
            match WebDriver::new(format!("http://127.0.0.1:{port}"), capabilities).await {
                Ok(driver) => {
                    return Self { driver, process, port };
                }
                Err(error) if begin.elapsed() > 2 * PATIENCE => {
                    let _ = process.kill();
                    panic!("no browser: {error}");
                }
                Err(_) => tokio::time::sleep(Duration::from_millis(100)).await,
            }
        }
    }

    /// The driver.
    pub const fn driver(&self) -> &WebDriver {
        &self.driver
    }

    /// A screen of this size, and what its owner prefers.
    pub async fn screen(&self, width: u32, height: u32, scheme: Scheme) {
        let tools = self.driver.cdp();
        let size = serde_json::json!({"width": width, "height": height, "deviceScaleFactor": 1, "mobile": false});
        let media = serde_json::json!({"features": [{"name": "prefers-color-scheme", "value": scheme.word()}]});
        tools.send_raw("Emulation.setDeviceMetricsOverride", size).await.expect("a size");
        tools.send_raw("Emulation.setEmulatedMedia", media).await.expect("a scheme");
    }

    /// A script that runs on each page before its own.
    pub async fn before_each_page(&self, script: &str) {
        let source = serde_json::json!({ "source": script });
        let sent = self.driver.cdp().send_raw("Page.addScriptToEvaluateOnNewDocument", source).await;
        sent.expect("a script");
    }

    /// Moves the mouse, or presses or releases it, at this place of the screen, in px; `clicks` in a row.
    pub async fn mouse(&self, kind: &str, [x, y]: [f64; 2], clicks: u32) {
        let button = if kind == "mouseMoved" { "none" } else { "left" };
        let event = serde_json::json!({"type": kind, "x": x, "y": y, "button": button, "clickCount": clicks});
        self.driver.cdp().send_raw("Input.dispatchMouseEvent", event).await.expect("a mouse");
    }

    /// Drags the mouse from one place to another.
    pub async fn drag(&self, from: [f64; 2], to: [f64; 2]) {
        self.mouse("mouseMoved", from, 0).await;
        self.mouse("mousePressed", from, 1).await;
        for step in 1..=8 {
            let share = f64::from(step) / 8.0;
            let between = [0, 1].map(|i| from[i] + share * (to[i] - from[i]));
            self.mouse("mouseMoved", between, 0).await;
        }
        self.mouse("mouseReleased", to, 1).await;
    }

    /// Puts fingers on the screen (`touchStart`), moves them (`touchMove`) or lifts them (`touchEnd`, without places),
    /// px.
    pub async fn touch(&self, kind: &str, places: &[[f64; 2]]) {
        let point = |(id, [x, y]): (usize, &[f64; 2])| serde_json::json!({"id": id, "x": x, "y": y});
        let points: Vec<_> = places.iter().enumerate().map(point).collect();
        let event = serde_json::json!({"type": kind, "touchPoints": points});
        self.driver.cdp().send_raw("Input.dispatchTouchEvent", event).await.expect("fingers");
    }

    /// Waits until a script on the page says true.
    pub async fn wait_for(&self, script: &str) {
        let begin = Instant::now();
        while !self.ask::<bool>(script).await {
            assert!(begin.elapsed() < PATIENCE, "{script}: still not true");
            tokio::time::sleep(Duration::from_millis(20)).await;
        }
    }

    /// What a script on the page says.
    pub async fn ask<T: serde::de::DeserializeOwned>(&self, script: &str) -> T {
        let answer = self.driver.execute(script, Vec::new()).await;
        let answer = answer.unwrap_or_else(|error| panic!("{script}: {error}"));
        answer.convert().unwrap_or_else(|error| panic!("{script}: {error}"))
    }

    /// The text of an element.
    pub async fn text(&self, id: &str) -> String {
        self.ask(&format!("return document.getElementById('{id}').textContent")).await
    }

    /// Waits until an element says so; how long it took.
    pub async fn wait(&self, id: &str, what: &str, mut is: impl FnMut(&str) -> bool) -> Duration {
        let begin = Instant::now();
        loop {
            let text = self.text(id).await;
            if is(&text) {
                return begin.elapsed();
            }
            assert!(begin.elapsed() < PATIENCE, "#{id}: expected {what}, found `{text}`");
            tokio::time::sleep(Duration::from_millis(20)).await;
        }
    }

    /// Presses a key on the page.
    pub async fn press(&self, key: &str) {
        let body = self.driver.find(By::Tag("body")).await.expect("a body");
        body.send_keys(key).await.expect("a key");
    }

    /// Saves a picture of the page in `target/browser`.
    pub async fn picture(&self, name: &str) -> Vec<u8> {
        let png = self.driver.screenshot_as_png().await.expect("a picture");
        let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../target/browser");
        std::fs::create_dir_all(&folder).expect("a folder");
        std::fs::write(folder.join(format!("{name}.png")), &png).expect("written");
        png
    }
}
