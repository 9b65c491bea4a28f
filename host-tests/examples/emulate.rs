//! `cargo xtask emulate`: a run through the firmware in the emulator and through the task on the host; the first tick
//! that differs is named.
//!
//! Arguments: RUN.csv TRAIN.toml TRACK.toml [FRAMES.bin]

use host_tests::prelude::*;
use host_tests::target::{compare, firmware};
use rundown::link::serial;
use rundown_files::map_matching::CentreLine;
use sim_harness::session::description;
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let (run, train, track, frames) = match arguments.as_slice() {
        [run, train, track] => (run, train, track, None),
        [run, train, track, frames] => (run, train, track, Some(frames)),
        _ => return Err("expected RUN.csv TRAIN.toml TRACK.toml [FRAMES.bin]".into()),
    };
    let settings = firmware()?;
    let (_, train) = TrainFile::read(train)?;
    let (track, _) = TrackFile::read(track)?;
    let line = CentreLine::new(&track.centre_line);
    for file in RunSet::find(std::slice::from_ref(run))?.files {
        let recording = Recording::read(&file, BadRows::Refuse, line.as_ref(), DirectionChoice::Auto)?;
        let log: Vec<_> = recording.rows.iter().map(Sample::measurement).collect();
        let description = description(&train, &track, Config::default());
        let same = compare(&settings, &description, recording.direction, &[&log])?;
        println!(
            "{}: {} ticks, {} frames, {} bytes on the line: the same as on the host",
            recording.name, same.ticks, same.frames, same.line_bytes
        );
        println!(
            "stack_bytes={} longest_us={} line_bytes_per_tick={:.0}",
            same.health.stack_bytes,
            same.health.longest_us,
            same.line_bytes as f64 / same.ticks as f64
        );
        if let Some(frames) = frames {
            write(frames, &same.messages)?;
        }
    }
    Ok(())
}

/// The messages as they came over the serial line.
fn write(path: &Path, messages: &[Vec<u8>]) -> Result<(), Box<dyn Error>> {
    let mut bytes = Vec::new();
    for message in messages {
        bytes.extend_from_slice(&serial::encode(message)?);
    }
    std::fs::write(path, bytes)?;
    println!("frames: {}", path.display());
    Ok(())
}
