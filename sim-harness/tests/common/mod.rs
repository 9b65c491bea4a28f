//! The command, as a user runs it.
#![allow(dead_code, reason = "each test uses its part")]

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;

/// What came of a command.
#[derive(Debug)]
pub struct Said {
    pub code: Option<i32>,
    pub out: String,
    pub err: String,
}

/// The run that the reference implementation was given.
pub const RUN: &str = include_str!("../../../data/reference/run01.csv");

/// The run once more, everywhere so many centimetres further: a log that is given twice counts once, and one that has
/// some of its rows is said.
pub fn another(by_cm: u32) -> String {
    let (header, rows) = RUN.trim_end().split_once('\n').unwrap();
    let moved = rows.lines().map(|row| {
        let mut fields: Vec<String> = row.split(',').map(str::to_owned).collect();
        fields[1] = format!("{:.4}", fields[1].parse::<f64>().unwrap() + 0.01 * f64::from(by_cm));
        fields.join(",") + "\n"
    });
    format!("{header}\n{}", moved.collect::<String>())
}

/// A tunnel that a scenario hides, or a track describes.
pub const TUNNEL: &str = "[[effect]]\nname = \"tunnel_drag\"\nfrom_m = 18100.0\nto_m = 21000.0\nk = 1.2e-5\n";

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

    /// With a data set `set` of this scenario.
    pub fn simulated(scenario: &str) -> Self {
        let folder = Self::new().with("s.toml", scenario);
        folder.done(&["simulate", "--scenario", "s.toml", "--out", "set"]);
        folder
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub fn with(self, name: &str, text: &str) -> Self {
        self.write(name, text);
        self
    }

    pub fn write(&self, name: &str, text: &str) {
        let path = self.path(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }

    pub fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.path(name)).unwrap()
    }

    pub fn json(&self, name: &str) -> Value {
        serde_json::from_str(&self.read(name)).unwrap()
    }

    /// `rundown` in this folder.
    pub fn rundown(&self, arguments: &[&str]) -> Said {
        let mut command = Command::new(env!("CARGO_BIN_EXE_rundown"));
        let output = command.current_dir(self.0.path()).args(arguments).output().unwrap();
        let [out, err] = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
        Said { code: output.status.code(), out, err }
    }

    /// The same, where it must succeed.
    pub fn done(&self, arguments: &[&str]) -> Said {
        let said = self.rundown(arguments);
        assert_eq!(said.code, Some(0), "{}", said.err);
        said
    }

    /// `rundown replay` with the reference train and track, results in `out`.
    pub fn replay(&self, arguments: &[&str]) -> Said {
        self.replay_on(&reference("track.toml"), arguments)
    }

    /// The same on another track.
    pub fn replay_on(&self, track: &str, arguments: &[&str]) -> Said {
        let described = ["replay", "--train", &reference("train.toml"), "--track", track, "--out", "out"];
        self.rundown(&[&described, arguments].concat())
    }
}
