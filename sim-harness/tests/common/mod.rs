//! The command, as a user runs it.

use std::path::Path;
use std::process::{Command, Output};

/// What came of `rundown` in a folder.
pub fn rundown(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_rundown")).current_dir(folder).args(arguments).output().unwrap()
}

/// The same, where it must succeed.
pub fn done(folder: &Path, arguments: &[&str]) -> Output {
    let output = rundown(folder, arguments);
    let words = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{words}");
    output
}
