//! `rundown import`: logs of any recorder in; run logs, their index, and an account of what was done out.

use super::{Failure, SOME_RUNS_FAILED, Strict, screen};
use crate::alike::few;
use crate::import::{ImportError, ImportOrder, Imported, Method};
use std::path::PathBuf;
use std::process::ExitCode;

const EXAMPLES: &str = "\
Examples:
  Look first: columns, units, first rows, open questions; and a picture of the speeds:
    rundown import --preview export.csv
    rundown import --preview=speeds.svg export.csv

  Make run logs of it, and a track of what the runs say about one:
    rundown import export.csv --out runs --track-out track.toml

  The same again, or with new files of the same recorder:
    rundown import --mapping runs/import.toml --out again
    rundown import --mapping runs/import.toml new/*.csv --out more

CSV of any delimiter and encoding, Excel and OpenDocument sheets, GPX, NMEA, JSON lines, Parquet. What no header says is
found by evidence, or asked for: docs/import.md has every key of import.toml.";

#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES, after_long_help = format!("{EXAMPLES}\n\n{}", super::AFTER_HELP))]
pub struct Arguments {
    /// Files, or folders of files; without any those that the mapping names
    #[arg(value_name = "FILE", required_unless_present = "mapping")]
    files: Vec<PathBuf>,
    /// What the files do not say, or an import.toml of an earlier import
    #[arg(long, value_name = "import.toml")]
    mapping: Option<PathBuf>,
    /// Folder for the run logs; it is replaced when an import wrote it
    #[arg(long, value_name = "FOLDER", default_value = "runs")]
    out: PathBuf,
    /// How the runs come onto one chainage; found from what is there if not given
    #[arg(long, value_enum)]
    chainage: Option<Method>,
    /// Track that has the chainage: its centre line for positions, else its stops
    #[arg(long, value_name = "K.toml")]
    track: Option<PathBuf>,
    /// Write a track to begin with: length, stations, centre line, gradients
    #[arg(long, value_name = "K.toml")]
    track_out: Option<PathBuf>,
    #[command(flatten)]
    strict: Strict,
    /// Show columns, units and first rows, and write nothing but a picture of the speeds where a file for it is named
    #[arg(long, value_name = "FILE.svg", num_args = 0..=1, require_equals = true)]
    preview: Option<Option<PathBuf>>,
}

impl From<ImportError> for Failure {
    fn from(error: ImportError) -> Self {
        match error {
            ImportError::Nothing { message, .. } => Self::no_runs(message),
            ImportError::Refused(error) => error.into(),
            ImportError::Strict(message) => Self { message, code: SOME_RUNS_FAILED },
            ImportError::Write(error) => error.into(),
        }
    }
}

pub(super) fn run(arguments: &Arguments) -> Result<ExitCode, Failure> {
    let mut order = ImportOrder::new(arguments.files.clone(), arguments.mapping.clone(), arguments.out.clone())?;
    order.place_by(arguments.chainage, arguments.track.clone());
    order.track_out.clone_from(&arguments.track_out);
    order.strict = arguments.strict.strict;
    let done = if let Some(path) = &arguments.preview {
        let looked = order.preview()?;
        if let Some(path) = path {
            if path.extension().is_none_or(|extension| extension != "svg") {
                let found = path.display();
                return Err(Failure::arguments(format_args!(
                    "--preview: expected a name that ends in .svg, found {found}"
                )));
            }
            crate::output::files::whole(path, &looked.picture())?;
        }
        looked.found
    } else {
        let waiting = screen::waiting();
        waiting.set_message("reading");
        let done = order.import();
        waiting.finish_and_clear();
        done?
    };
    Ok(said(&done, arguments))
}

fn said(done: &Imported, arguments: &Arguments) -> ExitCode {
    few(done.errors.iter().map(ToString::to_string)).iter().for_each(|error| screen::error(error));
    few(&done.notes).iter().for_each(|note| screen::note(note));
    screen::print(&match &arguments.preview {
        Some(Some(path)) => format!("{}\npicture: {}\n", done.lines.join("\n"), path.display()),
        Some(None) => format!("{}\n--preview=FILE.svg draws the speeds\n", done.lines.join("\n")),
        None => done.words(&arguments.out),
    });
    if done.errors.is_empty() && done.left_out == 0 { ExitCode::SUCCESS } else { ExitCode::from(SOME_RUNS_FAILED) }
}
