//! Prints the diagnosis of run logs: `cargo run -p rundown-check --example diagnose RUNS/`.

use rundown_check::check;
use rundown_files::map_matching::CentreLine;
use rundown_files::recording::{DirectionChoice, Recording};
use rundown_files::run_log::BadRows;
use rundown_files::run_set::RunSet;
use std::path::PathBuf;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let paths: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let set = RunSet::find(&paths)?;
    let line: Option<CentreLine> = None;
    let read = |file| Recording::read(file, BadRows::LeaveOut, line.as_ref(), DirectionChoice::Auto);
    let mut recordings = set.files.iter().map(read).collect::<Result<Vec<_>, _>>()?;
    let found = check(&mut recordings);
    for run in &found.runs {
        for finding in &run.findings {
            println!("{}: {finding}", run.name);
        }
    }
    for recorder in &found.recorders {
        println!(
            "{}: {} of {} runs compared, {:?}",
            recorder.unit, recorder.compared, recorder.runs, recorder.skew_spread_s
        );
        println!(
            "  offset {:?} scale {:?} skew {:?} step {:?} {:?}",
            recorder.offset_kmh, recorder.scale, recorder.skew_s, recorder.speed_step_kmh, recorder.location_step_m
        );
        for finding in &recorder.findings {
            println!("  {finding}");
        }
    }
    Ok(())
}
