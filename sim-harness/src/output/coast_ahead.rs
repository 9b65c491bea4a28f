//! `<run>.coast_ahead.csv`: what coasting from each tick on leads to, [`rundown::coast_ahead`]. Written where the track
//! has stops or speed limits.
//!
//! A board makes no prediction in the ticks in which it has the most to do (each sixth, and each twelfth from the third
//! on); else it says those of the rows with `published` 1.

use rundown::coast_ahead::{Arrival, CoastAhead, CoastConfig, Outcome, Steady};
use rundown_files::column::Column;
use rundown_files::replay::ReplayedRun;

/// Name of the file of a run, without its end.
pub fn stem(run: &ReplayedRun) -> String {
    format!("{}.coast_ahead", run.name)
}

pub(crate) const fn outcome_word(outcome: &Outcome) -> &'static str {
    match outcome {
        Outcome::Unknown => "unknown",
        Outcome::NoTarget => "no_target",
        Outcome::Arrives(_) => "arrives",
        Outcome::MayStop => "may_stop",
        Outcome::Stops { .. } => "stops",
    }
}

/// A tick.
#[derive(Clone, Copy, Debug)]
pub struct CoastRow {
    ahead: CoastAhead,
    published: bool,
}

const NO_TARGET: &str = "there is no target ahead";
const NO_ARRIVAL: &str = "`outcome` is not `arrives`";
const NO_STOP: &str = "`outcome` is not `stops`";

/// The columns of the file.
pub fn columns() -> Vec<Column<CoastRow>> {
    let limit = "speed limit behind the target, 0 at a stop";
    let outcome = "`arrives`, `may_stop`, `stops`, `no_target` or `unknown`";
    let published = "1 where the prediction is another one than that published before it";
    let mut columns = vec![
        Column::number("time_s", "s", "time of the tick", |r: &CoastRow| r.ahead.from.time_s),
        Column::number("location_m", "m", "estimated location from which the train coasts", |r: &CoastRow| {
            r.ahead.from.location_m
        }),
        Column::number("speed_mps", "m/s", "estimated speed from which the train coasts", |r: &CoastRow| {
            r.ahead.from.speed_mps
        }),
        Column::text("outcome", outcome, |r: &CoastRow| outcome_word(&r.ahead.outcome)),
        Column::number("target_m", "m", "location of the next stop or fall of the speed limit", |r: &CoastRow| {
            r.ahead.target.map(|target| target.at_m)
        })
        .empty_when(NO_TARGET),
        Column::number("target_limit_mps", "m/s", limit, |r: &CoastRow| {
            r.ahead.target.map(|target| target.limit_mps.unwrap_or(0.0))
        })
        .empty_when(NO_TARGET),
    ];
    columns.extend(arrival());
    columns.extend([
        Column::number("stop_m", "m", "where the train stands before the target", |r: &CoastRow| r.stop().map(|s| s.0))
            .empty_when(NO_STOP),
        Column::number("sd_stop_m", "m", "standard deviation of `stop_m`", |r: &CoastRow| r.stop().map(|s| s.1))
            .empty_when(NO_STOP),
        Column::count("published", published, |r: &CoastRow| r.published),
    ]);
    columns
}

fn arrival() -> [Column<CoastRow>; 4] {
    let of = |value: fn(&Arrival) -> f64| move |r: &CoastRow| r.arrival().map(|arrival| value(&arrival));
    let sd = "standard deviation of it; a 90 % interval is 1.645 of them to either side";
    [
        Column::number("target_speed_mps", "m/s", "speed at the target", of(|a| a.speed_mps)),
        Column::number("sd_target_speed_mps", "m/s", sd, of(|a| a.speed_sd_mps)),
        Column::number("target_time_s", "s", "time at the target, on the clock of `time_s`", of(|a| a.time_s)),
        Column::number("sd_target_time_s", "s", sd, of(|a| a.time_sd_s)),
    ]
    .map(|column| column.empty_when(NO_ARRIVAL))
}

impl CoastRow {
    fn arrival(&self) -> Option<Arrival> {
        match self.ahead.outcome {
            Outcome::Arrives(arrival) => Some(arrival),
            _ => None,
        }
    }

    fn stop(&self) -> Option<(f64, f64)> {
        match self.ahead.outcome {
            Outcome::Stops { location_m, sd_m } => Some((location_m, sd_m)),
            _ => None,
        }
    }
}

/// The ticks of a run.
pub fn rows<'a>(run: &'a ReplayedRun, config: &'a CoastConfig) -> impl Iterator<Item = CoastRow> + 'a {
    let mut steady = Steady::NONE;
    run.coast_ahead.iter().map(move |ahead| CoastRow { ahead: *ahead, published: steady.is_news(config, ahead) })
}
