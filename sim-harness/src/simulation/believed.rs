//! The descriptions that the estimator gets: track and train as they are believed to be, before any effect.

use rundown::model::track::{Curve, Gradient};
use rundown::{model::resistance::Davis, model::train::TrainDescription};
use rundown_files::track_file::{FeedingSection, SpeedLimit, Stop, TrackFile, Tunnel};
use rundown_files::train_file::TrainFile;
use rundown_truth::line::{self, Line};
use rundown_truth::train::TrainTruth;

/// What the train of the case study is called.
pub const TRAIN_NAME: &str = "double-deck electric unit, six cars";
/// A stop this near to an end of the line is that end, m.
const END_M: f64 = 200.0;

/// The description of the corridor of the case study, flat or hilly. Tunnel and feeding sections are invented.
pub fn corridor(line: &Line, name: String) -> TrackFile {
    let section = |from_m, to_m, name: &str| FeedingSection { from_m, to_m, name: name.to_owned() };
    let stop = |at_m, name: &str| Stop { at_m, name: name.to_owned() };
    TrackFile {
        effect: Vec::new(),
        name,
        length_m: line.length_m(),
        // A line that is simulated flat is described as flat.
        gradient_sd_permille: line.gradients_permille().is_empty().then_some(0.0),
        gradient: line.gradients_permille().iter().map(|&(from_m, permille)| Gradient { from_m, permille }).collect(),
        curve: line
            .curves()
            .iter()
            .map(|curve| Curve { from_m: curve.from_m, to_m: curve.to_m, radius_m: curve.radius_m })
            .collect(),
        tunnel: vec![Tunnel { from_m: 9_100.0, to_m: 11_000.0 }],
        speed_limit: line.limits_kmh().iter().map(|&(from_m, kmh)| SpeedLimit { from_m, kmh }).collect(),
        feeding_section: vec![
            section(0.0, 4_000.0, "departure"),
            section(4_000.0, 18_000.0, "south"),
            section(18_000.0, line.length_m(), "north"),
        ],
        stop: vec![stop(0.0, "departure"), stop(line.length_m(), "arrival")],
        centre_line: Vec::new(),
    }
}

/// The line of a track file. Stops at its ends are its ends.
pub fn line_of(track: &TrackFile) -> Line {
    let gradients = track.gradient.iter().map(|g| (g.from_m, g.permille));
    let limits = track.speed_limit.iter().map(|l| (l.from_m, l.kmh));
    let mut line = Line::new(track.length_m, gradients.collect(), limits.collect());
    let curve = |curve: &Curve| line::Curve { from_m: curve.from_m, to_m: curve.to_m, radius_m: curve.radius_m };
    line.set_curves(track.curve.iter().map(curve).collect());
    let between = END_M..track.length_m - END_M;
    let calls = track.stop.iter().map(|stop| stop.at_m);
    line.set_calls(calls.filter(|at_m| between.contains(at_m)).collect());
    line
}

/// The description of a train that is as described.
pub fn train_file(name: &str, train: &TrainTruth) -> TrainFile {
    let TrainTruth { mass_kg, gamma: rotating_mass_factor, length_m, davis, .. } = *train;
    let TrainTruth { max_tractive_effort_n, max_power_w, max_brake_mps2, .. } = *train;
    let davis = Davis { r0: davis.r0, r1: davis.r1, r2: davis.r2 };
    let limits =
        TrainDescription { max_tractive_effort_n, max_power_w, max_brake_mps2, ..TrainDescription::CASE_STUDY };
    TrainFile::of(name, &TrainDescription { mass_kg, rotating_mass_factor, length_m, davis, ..limits })
}
