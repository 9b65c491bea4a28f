//! A track from runs: its length, where trains stop, the centre line, and gradients by the altitudes with their doubt.

use rundown_files::WriteError;
use rundown_files::statistics::{Pairs, median, rms, squares_about};
use rundown_files::track_file::CentreLinePoint;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::path::Path;

/// Stops nearer than this are one station, m.
const STATION_M: f64 = 200.0;
/// Shortest section with one gradient, m, and how far beyond its ends altitudes count.
const SECTION_M: f64 = 1000.0;
const MOST_SECTIONS: f64 = 500.0;
const BIN_M: f64 = 100.0;
/// Altitudes of satellites drift by so much over a section where only one run has them, m.
const DRIFT_M: f64 = 5.0;

/// How a skeleton begins.
const MADE: &str = "# Made from ";

/// A track that a person has described is not replaced.
pub fn may_replace(path: &Path) -> Result<(), WriteError> {
    let is_described = std::fs::read_to_string(path).is_ok_and(|text| !text.starts_with(MADE));
    let error =
        || std::io::Error::new(std::io::ErrorKind::AlreadyExists, "is there and no skeleton; choose another name");
    if is_described { Err(crate::output::files::failed(path, error())) } else { Ok(()) }
}

/// What a run says of the track, on its chainage.
#[derive(Clone, Debug, Default)]
pub struct Passed {
    pub ends_m: (f64, f64),
    pub stops_m: Vec<f64>,
    /// Location and altitude.
    pub altitudes: Vec<(f64, f64)>,
}

pub fn track_toml(runs: &[Passed], line: &[CentreLinePoint]) -> String {
    let furthest = runs.iter().map(|run| run.ends_m.1).fold(0.0, f64::max);
    let length_m = line.last().map_or(furthest, |last| last.at_m.max(furthest)).ceil().max(1.0);
    let mut text = format!(
        "{MADE}{} runs by `rundown import --track-out`. A skeleton: look at it.\nname = \"imported\"\nlength_m = {length_m:.1}\n",
        runs.len()
    );
    let sections = gradients(runs, length_m);
    if sections.is_empty() {
        text +=
            "\n# No gradients: the logs have no altitude. Without them hardly anything is learned of the resistance.\n";
    } else {
        let _ = writeln!(text, "gradient_sd_permille = {:.2}", rms(sections.iter().map(|(_, _, sd)| sd)));
    }
    for (from_m, permille, sd) in sections {
        let _ = write!(text, "\n[[gradient]]\nfrom_m = {from_m:.1}\npermille = {permille:.2} # sd {sd:.2}\n");
    }
    for (number, (at_m, count, sd_m)) in stations(runs).iter().enumerate() {
        let name = number + 1;
        let _ =
            write!(text, "\n[[stop]]\nat_m = {at_m:.1} # {count} times, sd {sd_m:.0} m\nname = \"station {name}\"\n");
    }
    for CentreLinePoint { at_m, latitude_deg, longitude_deg } in line {
        let _ = write!(
            text,
            "\n[[centre_line]]\nat_m = {at_m:.2}\nlatitude_deg = {latitude_deg:.7}\nlongitude_deg = {longitude_deg:.7}\n"
        );
    }
    text
}

/// Where trains stand: place, how often, scatter. One of many runs that stands somewhere stands at a signal.
fn stations(runs: &[Passed]) -> Vec<(f64, usize, f64)> {
    let mut stops: Vec<(f64, usize)> =
        runs.iter().enumerate().flat_map(|(run, passed)| passed.stops_m.iter().map(move |at| (*at, run))).collect();
    stops.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut groups: Vec<Vec<(f64, usize)>> = Vec::new();
    for stop in stops {
        match groups.last_mut() {
            Some(group) if stop.0 - group[group.len() / 2].0 < STATION_M => group.push(stop),
            _ => groups.push(vec![stop]),
        }
    }
    let station = |group: &Vec<(f64, usize)>| {
        let at_m = median(group.iter().map(|stop| stop.0))?;
        let passing =
            runs.iter().filter(|run| run.ends_m.0 - STATION_M <= at_m && at_m <= run.ends_m.1 + STATION_M).count();
        let of_runs = group.iter().map(|stop| stop.1).collect::<BTreeSet<_>>().len();
        let often = of_runs >= 2.min(passing) && 4 * of_runs >= passing;
        often.then(|| (at_m.max(0.0), of_runs, rms(group.iter().map(|stop| stop.0 - at_m))))
    };
    groups.iter().filter_map(station).take(150).collect()
}

/// From where, permille, standard deviation. The slope of each run by itself: its receiver's offset does not matter.
fn gradients(runs: &[Passed], length_m: f64) -> Vec<(f64, f64, f64)> {
    let section_m = SECTION_M.max(length_m / MOST_SECTIONS);
    let mut found: Vec<(f64, f64, f64)> = Vec::new();
    let mut from_m = 0.0;
    while from_m < length_m {
        let (low, high) = (from_m - 0.5 * section_m, from_m + 1.5 * section_m);
        let slopes: Vec<f64> = runs.iter().filter_map(|run| slope(run, low, high)).collect();
        if let Some(permille) = median(&slopes) {
            let count = slopes.len() as f64;
            let square = squares_about(permille, &slopes);
            let alone = 1000.0 * DRIFT_M / section_m;
            let sd = if slopes.len() > 2 { (square / (count - 1.0) / count).sqrt().max(0.1) } else { alone };
            found.push((from_m, permille.clamp(-60.0, 60.0), sd));
        } else if found.last().is_some_and(|last| last.1 != 0.0) {
            found.push((from_m, 0.0, 10.0));
        }
        from_m += section_m;
    }
    found
}

/// Least squares of altitude over location, permille.
fn slope(run: &Passed, low: f64, high: f64) -> Option<f64> {
    let inside: Vec<&(f64, f64)> = run.altitudes.iter().filter(|(at_m, _)| (low..=high).contains(at_m)).collect();
    let mut bins: BTreeMap<i64, Vec<f64>> = BTreeMap::new();
    for (at_m, altitude_m) in inside {
        bins.entry((at_m / BIN_M).floor() as i64).or_default().push(*altitude_m);
    }
    let points: Vec<(f64, f64)> =
        bins.into_iter().filter_map(|(bin, all)| Some((bin as f64 * BIN_M, median(all)?))).collect();
    let (first, last) = (points.first()?.0, points.last()?.0);
    if last - first < 0.5 * (high - low) || points.len() < 5 {
        return None;
    }
    let Pairs { xx, xy, .. } = Pairs::of(&points);
    (xx > 0.0).then_some(1000.0 * xy / xx)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rundown_files::track_file::TrackFile;

    #[test]
    fn a_skeleton_is_a_track() {
        let run = |shift_m: f64| Passed {
            ends_m: (0.0, 8000.0),
            stops_m: vec![0.0, 3000.0 + shift_m, 8000.0],
            altitudes: (0..400).map(|i| (20.0 * f64::from(i), shift_m + 0.1 * f64::from(i).min(200.0))).collect(),
        };
        let text = track_toml(&[run(0.0), run(10.0), run(20.0)], &[]);
        let (track, _) = TrackFile::parse("track.toml".as_ref(), &text).unwrap();
        assert_eq!(track.stops_m(), [0.0, 3010.0, 8000.0]);
        assert!((track.gradient[1].permille - 5.0).abs() < 0.1 && track.gradient[6].permille.abs() < 0.1, "{text}");
    }
}
