//! `<run>.coast_ahead.csv`: what coasting from each tick on leads to, [`rundown::coast_ahead`]. Written where the track has stops or speed limits.
//!
//! | columns | what |
//! |---|---|
//! | `time_s`, `location_m`, `speed_mps` | the estimate that the prediction begins with |
//! | `outcome` | `arrives`, `may_stop`, `stops`, `no_target`, `unknown` |
//! | `target_m`, `target_limit_mps` | the next stop (limit 0) or fall of the speed limit, with the limit behind it |
//! | `target_speed_mps`, `sd_target_speed_mps`, `target_time_s`, `sd_target_time_s` | speed and time there; a 90 % interval is 1.645 standard deviations to either side |
//! | `stop_m`, `sd_stop_m` | where the train stands before the target |
//! | `published` | 1 where the prediction is another one than that published before it |
//!
//! A board makes no prediction in the ticks in which it has the most to do (each sixth, and each twelfth from the third on); else it says those of the rows with a 1.

use rundown::coast_ahead::{CoastAhead, CoastConfig, Outcome, Steady};
use rundown_files::replay::ReplayedRun;
use rundown_files::table::{Cell, Record, write_csv};
use std::io::{self, Write};

pub fn file_name(run: &ReplayedRun) -> String {
    format!("{}.coast_ahead.csv", run.name)
}

pub const fn outcome_word(outcome: &Outcome) -> &'static str {
    match outcome {
        Outcome::Unknown => "unknown",
        Outcome::NoTarget => "no_target",
        Outcome::Arrives(_) => "arrives",
        Outcome::MayStop => "may_stop",
        Outcome::Stops { .. } => "stops",
    }
}

pub fn write(writer: impl Write, run: &ReplayedRun, config: &CoastConfig) -> io::Result<()> {
    let mut steady = Steady::NONE;
    let records: Vec<Record> =
        run.coast_ahead.iter().map(|ahead| record(ahead, steady.is_news(config, ahead))).collect();
    write_csv(writer, &records)
}

fn record(ahead: &CoastAhead, published: bool) -> Record {
    let arrival = match ahead.outcome {
        Outcome::Arrives(arrival) => Some(arrival),
        _ => None,
    };
    let stop = match ahead.outcome {
        Outcome::Stops { location_m, sd_m } => Some((location_m, sd_m)),
        _ => None,
    };
    let target = ahead.target;
    let limit_mps = target.map(|target| target.limit_mps.unwrap_or(0.0));
    let cells = [
        ("time_s", Cell::from(ahead.from.time_s)),
        ("location_m", Cell::from(ahead.from.location_m)),
        ("speed_mps", Cell::from(ahead.from.speed_mps)),
        ("outcome", Cell::from(outcome_word(&ahead.outcome))),
        ("target_m", Cell::from(target.map(|target| target.at_m))),
        ("target_limit_mps", Cell::from(limit_mps)),
        ("target_speed_mps", Cell::from(arrival.map(|a| a.speed_mps))),
        ("sd_target_speed_mps", Cell::from(arrival.map(|a| a.speed_sd_mps))),
        ("target_time_s", Cell::from(arrival.map(|a| a.time_s))),
        ("sd_target_time_s", Cell::from(arrival.map(|a| a.time_sd_s))),
        ("stop_m", Cell::from(stop.map(|(location_m, _)| location_m))),
        ("sd_stop_m", Cell::from(stop.map(|(_, sd_m)| sd_m))),
        ("published", Cell::Count(u64::from(published))),
    ];
    cells.into_iter().map(|(name, cell)| (name.to_owned(), cell)).collect()
}
