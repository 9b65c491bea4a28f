//! Reports in a folder, made by the command, and what a test does with their pages.

use crate::browser::Browser;
use crate::display::binary;
use std::process::Command;
use tempfile::TempDir;

/// Simulated runs, and what the command made of them.
pub struct Reports {
    folder: TempDir,
}

/// Counts what goes wrong on a page, from before its first script.
const WATCH: &str = "window.wrong = [];
    addEventListener('error', (event) => wrong.push(event.message || 'not loaded: ' + (event.target.src || event.target.href)), true);
    addEventListener('unhandledrejection', (event) => wrong.push(String(event.reason)));
    console.error = (...words) => wrong.push(words.join(' '));";

impl Reports {
    /// `runs` simulated runs, in the folder `set`.
    pub fn of(runs: usize) -> Self {
        let reports = Self { folder: tempfile::tempdir().expect("a folder") };
        reports.rundown(&["simulate", "--out", "set", "--runs", &runs.to_string()]);
        reports
    }

    /// Gives the first simulated log another name, in the index, too.
    pub fn rename_first(&self, name: &str) {
        let runs = self.folder.path().join("set/runs");
        std::fs::rename(runs.join("run001.csv"), runs.join(format!("{name}.csv"))).expect("another name");
        let index = std::fs::read_to_string(runs.join("runs.csv")).expect("an index");
        std::fs::write(runs.join("runs.csv"), index.replace("run001.csv", &format!("{name}.csv"))).expect("written");
    }

    /// The command, in the folder.
    pub fn rundown(&self, arguments: &[&str]) {
        let said = Command::new(binary()).current_dir(self.folder.path()).args(arguments).output().expect("rundown");
        assert!(said.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&said.stderr));
    }

    /// `rundown replay` into `out`.
    pub fn replay(&self) {
        let described = ["--train", "set/train.toml", "--track", "set/track.toml"];
        self.rundown(&[&["replay", "--out", "out", "set/runs"][..], &described].concat());
    }

    /// `rundown gap` into `gap`, of at least seven runs.
    pub fn gap(&self) {
        let described = ["--train", "set/train.toml", "--track", "set/track.toml"];
        self.rundown(&[&["gap", "--out", "gap", "--runs", "set/runs"][..], &described].concat());
    }

    /// There is such a file or folder.
    pub fn has(&self, name: &str) -> bool {
        self.folder.path().join(name).exists()
    }

    /// Size of a file, bytes.
    pub fn size(&self, name: &str) -> u64 {
        std::fs::metadata(self.folder.path().join(name)).expect("a file").len()
    }

    /// Opens a page from the disk and watches for what goes wrong.
    pub async fn open(&self, browser: &Browser, name: &str) {
        browser.before_each_page(WATCH).await;
        let path = self.folder.path().join(name);
        browser.driver().goto(format!("file://{}", path.display())).await.expect("the page");
    }
}
