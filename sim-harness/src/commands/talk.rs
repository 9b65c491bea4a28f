//! How much a command says on stderr: `-q`, nothing of them, `-v`.
//!
//! | | stdout | errors | notes, warnings, progress | stages |
//! |---|---|---|---|---|
//! | `-q` | yes | yes | | |
//! | | yes | yes | yes | |
//! | `-v` | yes | yes | yes | yes |
//!
//! A stage is a line `[  0.123 s] read train.toml`: what was done, and when since the start.

use std::io::Write;
use std::sync::OnceLock;
use std::time::Instant;

/// The options, of every command.
#[derive(Clone, Copy, Debug, clap::Args)]
pub(super) struct Talk {
    /// Say results and errors only: no notes, warnings, progress
    #[arg(short, long, global = true, display_order = 100, conflicts_with = "verbose")]
    quiet: bool,
    /// Say what is read and written, and when
    #[arg(short, long, global = true, display_order = 100)]
    verbose: bool,
}

static QUIET: OnceLock<bool> = OnceLock::new();
static BEGIN: OnceLock<Instant> = OnceLock::new();

impl Talk {
    /// Holds until the process ends. Called a second time in one process (the Python module), the first call counts.
    pub fn apply(self) {
        let _ = QUIET.set(self.quiet);
        if self.verbose && log::set_logger(&Stages).is_ok() {
            let _ = BEGIN.set(Instant::now());
            log::set_max_level(log::LevelFilter::Info);
        }
    }
}

/// Whether notes, warnings and progress are left out.
pub(super) fn quiet() -> bool {
    QUIET.get().copied().unwrap_or_default()
}

/// A line on stderr. Where nobody reads it the work goes on.
pub(super) fn say(line: std::fmt::Arguments<'_>) {
    let _ = writeln!(std::io::stderr(), "{line}");
}

/// Says stages, with the time since the beginning.
struct Stages;

impl log::Log for Stages {
    fn enabled(&self, metadata: &log::Metadata<'_>) -> bool {
        ["rundown", "sim_harness"].iter().any(|ours| metadata.target().starts_with(ours))
    }

    fn log(&self, record: &log::Record<'_>) {
        if self.enabled(record.metadata()) {
            let seconds = BEGIN.get().map_or(0.0, |begin| begin.elapsed().as_secs_f64());
            say(format_args!("[{seconds:7.3} s] {}", record.args()));
        }
    }

    fn flush(&self) {}
}
