//! The command, as a user runs it.
#![allow(dead_code, reason = "each test uses its part")]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// What came of `rundown` in a folder.
pub fn rundown(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_rundown")).current_dir(folder).args(arguments).output().unwrap()
}

/// The same, where it must succeed.
pub fn done(folder: &Path, arguments: &[&str]) -> Output {
    let output = rundown(folder, arguments);
    assert_eq!(code(&output), Some(0), "{}", stderr(&output));
    output
}

pub fn code(output: &Output) -> Option<i32> {
    output.status.code()
}

pub fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

pub fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

/// The run that the reference implementation was given.
pub const RUN: &str = include_str!("../../../data/reference/run01.csv");

/// A file of `data/reference`.
pub fn reference(name: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../data/reference").join(name).display().to_string()
}

/// A folder of its own for a test.
pub struct Folder(tempfile::TempDir);

impl Folder {
    pub fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub fn with(self, name: &str, text: &str) -> Self {
        let path = self.path(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
        self
    }

    pub fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.path(name)).unwrap()
    }

    pub fn rundown(&self, arguments: &[&str]) -> Output {
        rundown(self.0.path(), arguments)
    }

    /// `rundown replay` with the reference train and track, results in `out`.
    pub fn replay(&self, arguments: &[&str]) -> Output {
        self.replay_on(&reference("track.toml"), arguments)
    }

    /// The same on another track.
    pub fn replay_on(&self, track: &str, arguments: &[&str]) -> Output {
        let described = ["replay", "--train", &reference("train.toml"), "--track", track, "--out", "out"];
        self.rundown(&[&described, arguments].concat())
    }
}
