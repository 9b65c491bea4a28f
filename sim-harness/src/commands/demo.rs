//! `rundown demo`: the replay of a run that is built in, and a short table of what it says.

use super::replay::{Results, Setup, write};
use super::{Failure, screen};
use crate::recording::{DirectionChoice, Recording};
use crate::replay::{ReplayedRun, Tick, replay_carried};
use crate::run_log::{BadRows, RunLog};
use crate::run_set::RunFile;
use crate::track_file::TrackFile;
use crate::train_file::TrainFile;
use rundown::config::Config;
use rundown::estimator::Estimator;
use rundown::features::Phase;
use rundown::regime::Regime;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

const RUN: &str = include_str!("../../../data/reference/run01.csv");
const TRACK: &str = include_str!("../../../data/reference/track.toml");
const TRAIN: &str = include_str!("../../../data/reference/train.toml");

/// Arguments of `rundown demo`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Folder for the results; made when it does not exist
    #[arg(long, value_name = "DIR", default_value = "out/demo")]
    out: PathBuf,
}

/// Replays the run, writes what `rundown replay` writes, and prints the table.
pub(super) fn run(arguments: &Arguments) -> Result<ExitCode, Failure> {
    let setup = setup()?;
    let path = Path::new("run01.csv");
    let log = RunLog::parse(path, RUN.as_bytes(), BadRows::Refuse).map_err(Failure::refused)?;
    let file = RunFile {
        path: path.to_owned(),
        name: "run01".to_owned(),
        unit: String::new(),
        direction: None,
        departure_utc: None,
    };
    let recording =
        Recording::new(&file, &log, None, DirectionChoice::Auto).map_err(Failure::refused)?;
    let results = Results {
        runs: replay_carried(&setup.estimator, &[recording], Tick::EverySample, || ()),
        failed: Vec::new(),
        notes: Vec::new(),
        carried: true,
        tick: Tick::EverySample,
    };
    write(&arguments.out, &setup, &results)?;
    for run in &results.runs {
        screen::print(&table(&setup, run));
    }
    let report = arguments.out.join("report.html");
    screen::print(&format!("\nreport: {}\n", report.display()));
    Ok(ExitCode::SUCCESS)
}

fn setup() -> Result<Setup, Failure> {
    let (train, core_train) =
        TrainFile::parse(Path::new("train.toml"), TRAIN).map_err(Failure::refused)?;
    let (track, core_track) =
        TrackFile::parse(Path::new("track.toml"), TRACK).map_err(Failure::refused)?;
    let config = Config::default();
    let estimator = Estimator::try_new(config, core_train, core_track).map_err(Failure::refused)?;
    Ok(Setup {
        config,
        train,
        core_train,
        track,
        estimator,
    })
}

fn table(setup: &Setup, run: &ReplayedRun) -> String {
    let features = &run.summary.features;
    let mut text = format!(
        "{} on {}, {} samples\n\n",
        setup.train.name, setup.track.name, run.rows
    );
    text += "share of the time     ";
    for (regime, share) in Regime::ALL.into_iter().zip(screen::shares(run)) {
        text += &format!(" {regime} {:.1} % ", 100.0 * share);
    }
    text += &format!(
        "\nfinal coast            {}\n",
        phase(features.final_coast.as_ref())
    );
    text += &format!(
        "final brake            {}\n\n",
        phase(features.final_brake.as_ref())
    );
    text += &format!(
        "{:22} {:32} {}\n",
        "running resistance", "before the run", "after the run"
    );
    for speed_kmh in [60.0, 100.0, 140.0] {
        let before = screen::resistance(&run.vehicle_before, speed_kmh);
        let after = screen::resistance(&run.vehicle_after, speed_kmh);
        text += &format!(
            "{:22} {before:32} {after}\n",
            format!("  at {speed_kmh} km/h")
        );
    }
    text
}

fn phase(phase: Option<&Phase>) -> String {
    let Some(phase) = phase else {
        return "not seen".to_owned();
    };
    format!(
        "from {:.2} km at {:.0} km/h, {:.0} s, {:.0} m",
        phase.start_location_m / 1000.0,
        3.6 * phase.start_speed_mps,
        phase.duration_s,
        phase.length_m
    )
}
