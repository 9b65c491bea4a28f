//! `rundown display` as a process.

use std::io::{BufRead, BufReader};
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};

/// A running display; ends with the value.
pub struct Display {
    child: Child,
    /// Where its page is.
    pub url: String,
}

impl Display {
    /// Starts it with these arguments and a free port for the page.
    pub fn start(arguments: &[&str]) -> Self {
        let mut child = Command::new(binary())
            .arg("display")
            .args(arguments)
            .args(["--http", "0"])
            .stdout(Stdio::piped())
            .spawn()
            .expect("rundown starts; `cargo xtask browser` builds it");
        let mut line = String::new();
        let stdout = child.stdout.as_mut().expect("piped");
        BufReader::new(stdout).read_line(&mut line).expect("its first line");
        let url = line.split_whitespace().nth(1).unwrap_or_else(|| panic!("no address in `{line}`"));
        Self { url: url.to_owned(), child }
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// `rundown` beside this test's folder.
pub(crate) fn binary() -> PathBuf {
    let test = std::env::current_exe().expect("a test has a file");
    let profile = test.parent().and_then(|deps| deps.parent()).expect("target/PROFILE/deps");
    profile.join(format!("rundown{}", std::env::consts::EXE_SUFFIX))
}
