//! `rundown link`: plays recorded runs to a board, over a real line or the emulator's, and keeps what it says.

use super::{Failure, screen};
use crate::session::{self, Heard, Session, SessionError};
use crate::{link::address::Address, link::record::RecordingLink, logs};
use rundown::onboard::auth::provisioning::{Provisioning, SIZE};
use rundown::uplink::{Command, Pace, Request};
use rundown::{link::Link, model::effects::Effects};
use rundown_desk::{Description, Desk};
use rundown_files::recording::{DirectionChoice, Recording};
use rundown_files::{
    effect_file, effect_frame, map_matching::CentreLine, run_log::BadRows, run_set::RunSet, track_file::TrackFile,
    train_file::TrainFile,
};
use rundown_pages::numbers::counted;
use rundown_wire::{Body, RunSummary, Versions};
use std::collections::{BTreeMap, HashSet};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use std::{fs::File, io::BufWriter, process::ExitCode};

const EXAMPLES: &str = "\
Examples:
  Play a log to a board as fast as it answers:
    rundown link --to /dev/ttyACM0@115200 --key key.bin --train t.toml --track k.toml run.csv

  In real time, with the board's own 10 s tick:
    rundown link --to tcp:127.0.0.1:5475 --real-time --key key.bin --train t.toml --track k.toml run.csv

--to is one of /dev/ttyACM0@115200, tcp:HOST:PORT, slcan:/dev/ttyACM0@115200, can:can0 (docs/link.md).
--key is the provisioning record that the board was given (`rundown provision`).
--record keeps every message of both directions (docs/formats.md).";

#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    /// Run logs, or folders of run logs
    #[arg(value_name = "RUN.csv", required = true)]
    runs: Vec<PathBuf>,
    /// Where the board is
    #[arg(long, value_name = "ADDRESS")]
    to: Address,
    /// Provisioning record of the board
    #[arg(long, value_name = "KEY.bin")]
    key: PathBuf,
    /// Description of the train
    #[arg(long, value_name = "T.toml")]
    train: PathBuf,
    /// Description of the track
    #[arg(long, value_name = "K.toml")]
    track: PathBuf,
    /// Configuration; what it leaves out keeps its default
    #[arg(long, value_name = "C.toml")]
    config: Option<PathBuf>,
    /// Effects for the board (`effect.frame` of `rundown gap`) instead of those of train and track
    #[arg(long, value_name = "effect.frame")]
    effects: Option<PathBuf>,
    /// Send each measurement at its time, and let the board's clock tick
    #[arg(long)]
    real_time: bool,
    /// File for every message of both directions
    #[arg(long, value_name = "FILE")]
    record: Option<PathBuf>,
    /// Direction of the runs that no index names
    #[arg(long, value_enum, default_value_t)]
    direction: DirectionChoice,
}

/// How long the summary of a run may be late.
const LAST_FRAMES: Duration = Duration::from_secs(3);

pub(super) fn run(arguments: &Arguments) -> Result<ExitCode, Failure> {
    let (train_file, train) = TrainFile::read(&arguments.train)?;
    let (track, _) = TrackFile::read(&arguments.track)?;
    let config = track.doubted(super::config(arguments.config.as_deref())?);
    let effects = match &arguments.effects {
        Some(path) => read_effects(path)?,
        None => effect_file::effects(&track.effect, &train_file.effect, None)?,
    };
    let description = Description { effects, ..session::description(&train, &track, config) };
    let recordings = recordings(arguments, &track)?;
    let desk = Desk::new(read_key(&arguments.key)?);
    let link = arguments.to.open().map_err(Failure::board)?;
    match &arguments.record {
        None => play(arguments, Session::new(link, desk), &description, &recordings)?,
        Some(path) => {
            let at = |error: std::io::Error| Failure::not_written(format!("{}: {error}", path.display()));
            let file = BufWriter::new(File::create(path).map_err(at)?);
            let mut recorder = RecordingLink::new(link, file).map_err(at)?;
            let played = play(arguments, Session::new(&mut recorder, desk), &description, &recordings);
            recorder.finish().map_err(at)?;
            log::info!("wrote {}", path.display());
            played?;
        }
    }
    Ok(ExitCode::SUCCESS)
}

/// The record that a board was given.
pub(super) fn read_key(path: &Path) -> Result<Provisioning, Failure> {
    let at = |error: String| Failure::refused(format!("{}: {error}", path.display()));
    let bytes = std::fs::read(path).map_err(|error| at(error.to_string()))?;
    log::info!("read {}", path.display());
    let found = bytes.len();
    let record: [u8; SIZE] = bytes.try_into().map_err(|_| at(format!("expected {SIZE} bytes, found {found}")))?;
    Provisioning::from_bytes(&record).map_err(|error| at(error.to_string()))
}

fn read_effects(path: &Path) -> Result<Effects, Failure> {
    let at = |error: String| Failure::refused(format!("{}: {error}", path.display()));
    let bytes = std::fs::read(path).map_err(|error| at(error.to_string()))?;
    log::info!("read {}", path.display());
    effect_frame::read(&bytes).map_err(|error| at(error.to_string()))
}

fn recordings(arguments: &Arguments, track: &TrackFile) -> Result<Vec<Recording>, Failure> {
    let set = RunSet::find(&arguments.runs)?;
    set.notes.iter().for_each(|text| screen::note(text));
    let line = CentreLine::new(&track.centre_line);
    let read = |file| logs::read(file, BadRows::Refuse, line.as_ref(), arguments.direction);
    set.files
        .iter()
        .map(|file| read(file).map_err(|failed| Failure::no_runs(format!("{}; nothing was played", failed.error))))
        .collect()
}

fn play<L: Link>(
    arguments: &Arguments,
    mut session: Session<L>,
    description: &Description,
    recordings: &[Recording],
) -> Result<(), Failure>
where
    L::PortError: std::fmt::Display,
{
    let board = |error: SessionError| Failure::board(error.to_string());
    let ticks: usize = recordings.iter().map(|recording| recording.rows.len()).sum();
    let bar = screen::progress(ticks);
    // What the board had from an earlier session is not known.
    let mut sent = None;
    let mut greeted = false;
    for recording in recordings {
        let pace = if arguments.real_time { Pace::Clock } else { Pace::Lockstep };
        session.prepare(description, recording.direction, pace).map_err(board)?;
        if !std::mem::replace(&mut greeted, true) {
            bar.suspend(|| screen::note(&board_words(session.desk().versions())));
        }
        let mut said = Said::default();
        let begin = Instant::now();
        let first_s = recording.rows.first().map_or(0.0, |row| row.time_s);
        let mut surroundings = recording.surroundings();
        for row in &recording.rows {
            if arguments.real_time {
                let due = Duration::try_from_secs_f64(row.time_s - first_s);
                while due.as_ref().is_ok_and(|due| begin.elapsed() < *due) {
                    match session.listen().map_err(board)? {
                        Some(heard) => said.hear(&[heard]),
                        None => std::thread::sleep(Duration::from_millis(5)),
                    }
                }
            }
            row.update(&mut surroundings);
            if sent.replace(surroundings) != Some(surroundings) {
                let request = Request::Surroundings(surroundings);
                let what = "the temperature and the date";
                said.hear(&session.ask(request, what).map_err(board)?);
            }
            if arguments.real_time {
                session.report(&row.measurement()).map_err(board)?;
            } else {
                said.hear(&session.measure(&row.measurement()).map_err(board)?);
            }
            bar.inc(1);
        }
        let end = Request::Command(Command::End);
        said.hear(&session.ask(end, "the end of the run").map_err(board)?);
        if said.summary.is_none() {
            said.hear(&session.summary(LAST_FRAMES).map_err(board)?);
        }
        let line = said.line(&recording.name).map_err(Failure::board)?;
        bar.suspend(|| screen::print(&line));
    }
    bar.finish_and_clear();
    Ok(())
}

/// Which firmware answers.
fn board_words(versions: Option<Versions>) -> String {
    versions.map_or_else(
        || "the board does not say its version: its firmware is older than this program".to_owned(),
        |versions| format!("the board: {versions}"),
    )
}

#[derive(Default)]
struct Said {
    /// Each once: a link may double them, and the second one need not follow the first.
    frames: HashSet<Vec<u8>>,
    estimates: usize,
    /// How often the board refused something, by its reason.
    refused: BTreeMap<&'static str, usize>,
    summary: Option<RunSummary>,
}

impl Said {
    fn hear(&mut self, frames: &[Heard]) {
        for heard in frames {
            if !self.frames.insert(heard.message.clone()) {
                continue;
            }
            match &heard.frame.body {
                Body::Estimate(_) => self.estimates += 1,
                Body::RunSummary(summary) => self.summary = Some(*summary),
                Body::Answer(answer) => {
                    if let Err(refusal) = answer.result {
                        *self.refused.entry(refusal.as_str()).or_default() += 1;
                    }
                }
                _ => {}
            }
        }
    }

    /// What came of a run, in a line; the reason, where there is no summary.
    fn line(&self, name: &str) -> Result<String, String> {
        let Self { frames, estimates, refused, .. } = self;
        let counts =
            [counted(frames.len(), "frame", "frames"), counted(*estimates, "estimate", "estimates")].join(", ");
        let reasons: Vec<String> = refused.iter().map(|(reason, count)| format!("{count} {reason}")).collect();
        let refused =
            if reasons.is_empty() { "0 refused".to_owned() } else { format!("refused: {}", reasons.join(", ")) };
        let Some(summary) = &self.summary else {
            return Err(format!(
                "{name}: expected the summary of the run, found none ({counts}, {refused}): the frames were lost on the link, or another program talks to the board"
            ));
        };
        let [r0, r1, r2] = summary.run_davis.map(|term| term.value);
        let learned = format!("r = {r0:.3e} + {r1:.3e} v + {r2:.3e} v2 N/kg, learned over {:.0} s", summary.learned_s);
        Ok(format!("{name}: {counts}, {refused}; {learned}\n"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rundown_wire::{Answer, Downlink, Refusal};

    fn heard(sequence: u16, body: Body) -> Heard {
        let frame = Downlink { sequence, tick: 1, body };
        let message = frame.encode(&mut [0; rundown_wire::MAX_MESSAGE]).unwrap().to_vec();
        Heard { message, frame }
    }

    #[test]
    fn a_frame_that_comes_twice_counts_once() {
        let refused = |to| Body::Answer(Answer { to, result: Err(Refusal::OutOfRange) });
        let (one, other) = (heard(1, refused(7)), heard(2, refused(8)));
        let mut said = Said::default();
        said.hear(&[one.clone(), one.clone(), other.clone()]);
        said.hear(&[other, one]);
        assert_eq!(said.frames.len(), 2);
        assert_eq!(said.refused.into_iter().collect::<Vec<_>>(), [("out_of_range", 2)]);
    }
}
