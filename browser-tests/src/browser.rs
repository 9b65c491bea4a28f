//! Debian's Chromium, driven over WebDriver.

use std::net::TcpListener;
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use thirtyfour::prelude::*;

/// How long the page may take to show what came: a frame is on it within a second, a process starts within some.
pub const PATIENCE: Duration = Duration::from_secs(15);

/// A browser and its driver; both end with the value, in this order: the driver ends the browser.
pub struct Browser {
    driver: WebDriver,
    _process: Process,
}

struct Process(Child);

impl Drop for Process {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
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
        let port = TcpListener::bind("127.0.0.1:0")
            .and_then(|socket| socket.local_addr())
            .expect("a free port")
            .port();
        let process = Process(
            Command::new("chromedriver")
                .arg(format!("--port={port}"))
                .stdout(Stdio::null())
                .stderr(Stdio::null())
                .spawn()
                .expect("chromedriver; `cargo xtask browser` installs it"),
        );
        let begin = Instant::now();
        loop {
            let mut capabilities = DesiredCapabilities::chrome();
            // Root has no sandbox, and a container little shared memory.
            for argument in [
                "--headless=new",
                "--no-sandbox",
                "--disable-dev-shm-usage",
                "--disable-gpu",
                "--hide-scrollbars",
            ] {
                capabilities.add_arg(argument).expect("an argument");
            }
            match WebDriver::new(format!("http://127.0.0.1:{port}"), capabilities).await {
                Ok(driver) => {
                    return Self {
                        driver,
                        _process: process,
                    };
                }
                Err(error) if begin.elapsed() > 2 * PATIENCE => panic!("no browser: {error}"),
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
        tools
            .send_raw("Emulation.setDeviceMetricsOverride", size)
            .await
            .expect("a size");
        tools
            .send_raw("Emulation.setEmulatedMedia", media)
            .await
            .expect("a scheme");
    }

    /// What a script on the page says.
    pub async fn ask<T: serde::de::DeserializeOwned>(&self, script: &str) -> T {
        let answer = self.driver.execute(script, Vec::new()).await;
        let answer = answer.unwrap_or_else(|error| panic!("{script}: {error}"));
        answer
            .convert()
            .unwrap_or_else(|error| panic!("{script}: {error}"))
    }

    /// The text of an element.
    pub async fn text(&self, id: &str) -> String {
        self.ask(&format!(
            "return document.getElementById('{id}').textContent"
        ))
        .await
    }

    /// Waits until an element says so; how long it took.
    pub async fn wait(&self, id: &str, what: &str, mut is: impl FnMut(&str) -> bool) -> Duration {
        let begin = Instant::now();
        loop {
            let text = self.text(id).await;
            if is(&text) {
                return begin.elapsed();
            }
            assert!(
                begin.elapsed() < PATIENCE,
                "#{id}: expected {what}, found `{text}`"
            );
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
        let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../target/browser");
        std::fs::create_dir_all(&folder).expect("a folder");
        std::fs::write(folder.join(format!("{name}.png")), &png).expect("written");
        png
    }

    /// Ends the browser's session; the driver ends with the value.
    pub async fn quit(self) {
        let _ = self.driver.clone().quit().await;
    }
}
