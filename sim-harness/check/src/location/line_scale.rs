//! An odometer that counts with another wheel than the line is measured by: its locations grow too fast or too slowly
//! beside the described stops.
//!
//! In: runs whose readings are clean, and the described stops. Out: by which factor the locations of a recorder are
//! off; they are put right.
//!
//! ```text
//! read location of a stop = offset of the run + scale × described location + platforms
//! ```
//!
//! Where the odometer gives the speed, too, both agree, and nothing else shows the wheel. Once the locations are right,
//! the speed is off beside them by as much, and what the stops leave open of the locations is open of the speed. All
//! runs of a recorder have one scale, or two where a wheel was changed or two trains recorded, and each an offset, for
//! odometers begin anywhere.

use crate::figure::Figure;
use crate::rows::profile::Profile;
use crate::{LEAST_SCALE, SURE};
use rundown_files::recording::Recording;
use rundown_files::statistics::{Pairs, median, spread};

/// A wheel is off by less, worn out or described wrongly.
pub const MOST_OFF: f64 = 0.03;
/// A stop is at a described one within so much, m: platforms are long, and described half a train off.
const NEAR_M: f64 = 120.0;
/// So many stops of a run must agree, for two of them agree always.
pub const LEAST_STOPS: usize = 4;
/// And such a share.
const LEAST_SHARE: f64 = 0.8;
/// So many stops from either end of a run are tried as described ones.
const ENDS: usize = 3;
/// Two scales of one recorder are in at least so many runs each.
const LEAST_RUNS: usize = 3;
/// How far a platform is from where it is described, in all runs alike, standard deviation, m: what is believed before
/// the stops are seen.
const PLATFORM_SD_M: f64 = 50.0;
/// So many platforms that belief is worth beside those that a line goes through. Those of a tram are known to metres,
/// of a freight line to none.
const BELIEVED_PLATFORMS: f64 = 5.0;

/// Stops of a run at the described ones: the straight line through them.
#[derive(Clone, Copy, Debug)]
pub struct StopsLine {
    /// Read over described.
    pub scale: f64,
    /// What is read where the line begins, m.
    pub offset_m: f64,
    /// Stops that agree.
    pub stops: usize,
    /// Root of the sum of squares of the described locations about their mean, m.
    spread_m: f64,
    /// How far platforms are from where they are described, by the stops beside the line, standard deviation, m.
    platform_sd_m: f64,
}

/// Where a run stands, and the line through those of its stops that are described ones.
#[derive(Clone, Debug)]
pub(crate) struct RunStops {
    calls_m: Vec<f64>,
    /// Of a wheel that is as described, or nearly.
    line: Option<StopsLine>,
}

/// Where a recorder's locations grow otherwise than the line.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scaled {
    /// Read over described.
    pub(crate) scale: Figure,
    /// Runs whose stops say so, with the most stops that agree in one.
    runs: usize,
    stops: usize,
    platform_sd_m: f64,
    /// The other runs of the recorder have another scale.
    is_part: bool,
}

impl Scaled {
    pub(crate) fn evidence(&self) -> String {
        let Self { runs, stops, platform_sd_m, is_part, .. } = self;
        let others = if *is_part { "; the other runs have another scale" } else { "" };
        format!(
            "up to {stops} stops of a run agree so, in {runs} runs{others}; platforms are known to {platform_sd_m:.0} m"
        )
    }
}

/// Miles, nautical miles and yards that are taken for kilometres and metres, and the reverse.
const OTHER_UNITS: [f64; 6] = [1.0 / 1.609_344, 1.609_344, 1.0 / 1.852, 1.852, 1.0 / 0.9144, 0.9144];

/// The stops of a run beside the described ones. None where these are too few to tell anything.
pub(crate) fn of_run(recording: &Recording, described_m: &[f64]) -> Option<RunStops> {
    if described_m.len() < LEAST_STOPS {
        return None;
    }
    let sign = recording.direction.sign();
    let calls_m = Profile::of(&recording.rows, sign).map_or_else(Vec::new, |profile| profile.calls_m());
    let calls_m: Vec<f64> = calls_m.into_iter().map(|at_m| sign * at_m).collect();
    Some(RunStops { line: most_agree(&calls_m, described_m, 1.0), calls_m })
}

impl RunStops {
    /// By which factor the locations are those of another unit: all of the stops are described ones so, and not as they
    /// are. And how many.
    pub(crate) fn other_unit(&self, described_m: &[f64]) -> Option<(f64, usize)> {
        if self.line.is_some() {
            return None;
        }
        let line = |factor: &f64| Some((*factor, most_agree(&self.calls_m, described_m, *factor)?.stops));
        OTHER_UNITS.iter().filter_map(line).max_by_key(|(_, stops)| *stops)
    }
}

/// Puts right the locations of the runs of one recorder, where they are off beyond doubt. `stops`: of all runs. Out:
/// for all of its runs, or for each part of them that has a scale of its own.
pub(crate) fn put_right(
    recordings: &mut [Recording],
    usable: &[usize],
    stops: &[Option<RunStops>],
    described_m: &[f64],
) -> Vec<Scaled> {
    let parts = of_two(usable, stops).unwrap_or_else(|| vec![usable.to_vec()]);
    let is_part = parts.len() > 1;
    let scaled = parts.iter().filter_map(|part| put_part_right(recordings, part, stops, described_m));
    scaled.map(|scaled| Scaled { is_part, ..scaled }).collect()
}

/// The runs of a recorder in two parts, where these have scales that surely differ.
fn of_two(usable: &[usize], stops: &[Option<RunStops>]) -> Option<Vec<Vec<usize>>> {
    let line = |i: &usize| Some((*i, stops[*i].as_ref()?.line?));
    let mut lines: Vec<(usize, StopsLine)> = usable.iter().filter_map(line).collect();
    lines.sort_by(|a, b| a.1.scale.total_cmp(&b.1.scale));
    let step = |at: &usize| lines[*at].1.scale - lines[*at - 1].1.scale;
    let split = (1..lines.len()).max_by(|a, b| step(a).total_cmp(&step(b)))?;
    let parts = [&lines[..split], &lines[split..]];
    let of = |part: &[(usize, StopsLine)]| {
        let lines: Vec<StopsLine> = part.iter().map(|(_, line)| *line).collect();
        // What one run says: platforms of the two may be others.
        (lines.len() >= LEAST_RUNS).then(|| middle(&lines, 1.0)).flatten()
    };
    let [low, high] = [of(parts[0])?, of(parts[1])?];
    let apart = high.value - low.value;
    let are_two = apart > LEAST_SCALE && apart > SURE * low.sd.hypot(high.sd);
    are_two.then(|| parts.map(|part| part.iter().map(|(i, _)| *i).collect()).to_vec())
}

fn put_part_right(
    recordings: &mut [Recording],
    usable: &[usize],
    stops: &[Option<RunStops>],
    described_m: &[f64],
) -> Option<Scaled> {
    let line = |i: &usize| stops[*i].as_ref().and_then(|of_run| of_run.line);
    let lines: Vec<StopsLine> = usable.iter().filter_map(line).collect();
    let scale = usual(&lines)?;
    for i in usable {
        let recording = &mut recordings[*i];
        let offset_m = line(i).map_or_else(|| own_offset_m(recording, described_m, scale.value), |line| line.offset_m);
        let located = recording.rows.iter_mut().filter_map(|row| row.location_m.as_mut());
        located.for_each(|at_m| *at_m = (*at_m - offset_m) / scale.value);
        // Positions do not turn with the wheel.
        if recording.speed_is_computed() && recording.rows.iter().all(|row| row.latitude_deg.is_none()) {
            let speeds = recording.rows.iter_mut().filter_map(|row| row.speed_mps.as_mut());
            speeds.for_each(|mps| *mps /= scale.value);
        }
    }
    let stops = lines.iter().map(|line| line.stops).max().unwrap_or_default();
    let platform_sd_m = median(lines.iter().map(|line| line.platform_sd_m))?;
    Some(Scaled { scale, runs: lines.len(), stops, platform_sd_m, is_part: false })
}

/// A run with too few stops begins where it is described to.
fn own_offset_m(recording: &Recording, described_m: &[f64], scale: f64) -> f64 {
    let Some(first_m) = recording.rows.iter().find_map(|row| row.location_m) else { return 0.0 };
    let near = described_m.iter().filter(|stop| (*stop - first_m).abs() < NEAR_M);
    let begins_m = near.min_by(|a, b| (*a - first_m).abs().total_cmp(&(*b - first_m).abs())).unwrap_or(&first_m);
    first_m - scale * begins_m
}

/// The scale of all runs of a recorder, where it matters and is beyond doubt.
fn usual(fits: &[StopsLine]) -> Option<Figure> {
    let scale = middle(fits, fits.len() as f64)?;
    ((scale.value - 1.0).abs() > LEAST_SCALE && scale.away_from(1.0) > SURE).then_some(scale)
}

/// The scale in the middle of these runs, as surely as so many of them say.
fn middle(fits: &[StopsLine], runs: f64) -> Option<Figure> {
    let value = median(fits.iter().map(|fit| fit.scale))?;
    let of_runs = spread(fits.iter().map(|fit| fit.scale - value)) / runs.sqrt();
    let of_platforms = median(fits.iter().map(|fit| fit.platform_sd_m / fit.spread_m))?;
    Some(Figure { value, sd: of_runs.hypot(of_platforms) })
}

/// The line through the stops of a run, at the place at which most of them agree, with a scale near `usual`.
fn most_agree(calls_m: &[f64], described_m: &[f64], usual: f64) -> Option<StopsLine> {
    // A run may begin or end elsewhere: one of its first stops and one of its last are described ones.
    let ends = |far: usize| (far < calls_m.len()).then(|| (calls_m[far], calls_m[calls_m.len() - 1 - far]));
    let of_ends = (0..ENDS).filter_map(ends);
    let ways = of_ends.clone().flat_map(|(first_m, _)| of_ends.clone().map(move |(_, last_m)| (first_m, last_m)));
    let pairs = || described_m.iter().flat_map(|from| described_m.iter().map(move |to| (*from, *to)));
    let tried = ways.flat_map(|way| pairs().map(move |pair| (way, pair)));
    let fit = |((first_m, last_m), (from_m, to_m)): ((f64, f64), (f64, f64))| {
        let scale = (last_m - first_m) / (to_m - from_m);
        ((scale / usual - 1.0).abs() < MOST_OFF)
            .then(|| through(calls_m, described_m, scale, first_m - scale * from_m))?
    };
    // As they are, too: then most agree, and the line through them is that of the platforms.
    let found = tried.filter_map(fit).chain(through(calls_m, described_m, usual, 0.0));
    let best = found.max_by_key(|fit| fit.stops)?;
    (best.stops >= LEAST_STOPS && best.stops as f64 >= LEAST_SHARE * calls_m.len() as f64).then_some(best)
}

/// Least squares through the stops that are near described ones with this scale and offset. None where they are at one
/// place.
///
/// ```
/// use rundown_check::location::line_scale::through;
///
/// // An odometer that began at 700 m and counts 1 % too much.
/// let fit = through(&[700.0, 10_810.0, 20_895.0], &[0.0, 10_000.0, 20_000.0], 1.01, 700.0).unwrap();
/// assert!((fit.scale - 1.01).abs() < 1e-3 && fit.stops == 3);
/// ```
pub fn through(calls_m: &[f64], described_m: &[f64], scale: f64, offset_m: f64) -> Option<StopsLine> {
    let near = |call_m: &f64| {
        let off_m = |stop_m: &f64| (call_m - offset_m - scale * stop_m).abs();
        let nearest = described_m.iter().min_by(|a, b| off_m(a).total_cmp(&off_m(b)))?;
        (off_m(nearest) < NEAR_M).then_some((*nearest, *call_m))
    };
    let agree: Vec<(f64, f64)> = calls_m.iter().filter_map(near).collect();
    let n = agree.len() as f64;
    let pairs = Pairs::of(&agree);
    let (scale, offset_m) = (pairs.slope(), pairs.offset());
    // A line has two numbers; the others are the posterior mean of a variance.
    let platforms = BELIEVED_PLATFORMS + (n - 2.0).max(0.0);
    let platform_sd_m = ((BELIEVED_PLATFORMS * PLATFORM_SD_M.powi(2) + pairs.left(&agree)) / platforms).sqrt();
    let fit = StopsLine { scale, offset_m, stops: agree.len(), spread_m: pairs.xx.sqrt(), platform_sd_m };
    scale.is_finite().then_some(fit)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use rundown_files::sample::Sample;

    const STOPS_M: [f64; 5] = [0.0, 9_000.0, 22_000.0, 41_000.0, 60_000.0];

    /// Runs that stop within some metres of platforms which are themselves off, counted by a wheel that is off.
    fn runs_along(read: f64, platforms: &[(f64, f64)], within_m: f64) -> Vec<Recording> {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let run = |index: usize| {
            let (mut rows, mut time_s) = (Vec::new(), 0.0);
            for (stop, off_m) in platforms {
                let at_m = stop + off_m + rng.random_range(-within_m..within_m);
                for (ahead_m, mps) in [(-100.0, 10.0), (0.0, 0.0), (0.0, 0.0), (0.0, 0.0), (100.0, 10.0)] {
                    time_s += 10.0;
                    let location_m = Some(700.0 + read * (at_m + ahead_m));
                    rows.push(Sample { time_s, location_m, speed_mps: Some(mps), ..Sample::default() });
                }
            }
            Recording { name: index.to_string(), path: format!("{index}.csv").into(), rows, ..Recording::default() }
        };
        (0..6).map(run).collect()
    }

    fn runs(read: f64, platforms: [f64; 5]) -> Vec<Recording> {
        let platforms: Vec<(f64, f64)> = STOPS_M.into_iter().zip(platforms).collect();
        runs_along(read, &platforms, 15.0)
    }

    fn all_found(recordings: &mut [Recording], described_m: &[f64]) -> Vec<Scaled> {
        let stops: Vec<Option<RunStops>> = recordings.iter().map(|one| of_run(one, described_m)).collect();
        put_right(recordings, &[0, 1, 2, 3, 4, 5], &stops, described_m)
    }

    fn found_along(recordings: &mut [Recording], described_m: &[f64]) -> Option<Scaled> {
        let found = all_found(recordings, described_m);
        assert!(found.len() < 2, "{found:?}");
        found.first().copied()
    }

    fn found(recordings: &mut [Recording]) -> Option<Scaled> {
        found_along(recordings, &STOPS_M)
    }

    fn other_unit(recording: &Recording) -> Option<(f64, usize)> {
        of_run(recording, &STOPS_M).unwrap().other_unit(&STOPS_M)
    }

    #[test]
    fn an_odometer_with_another_wheel_is_put_right_by_the_described_stops() {
        for read in [1.013, 0.985] {
            let mut recordings = runs(read, [0.0, 40.0, -60.0, 30.0, -20.0]);
            let one = found(&mut recordings).unwrap();
            assert!(one.scale.away_from(read) < 2.0 && one.scale.sd < 0.0015, "{one:?}");
            let last_m = recordings[0].rows.last().unwrap().location_m.unwrap();
            assert!((last_m - 60_080.0).abs() < 120.0, "{last_m}");
        }
    }

    #[test]
    fn a_wheel_that_half_of_the_runs_have_is_put_right_in_these() {
        let platforms = [0.0, 40.0, -60.0, 30.0, -20.0];
        let mut recordings = runs(1.0, platforms);
        for (own, other) in recordings.iter_mut().zip(runs(1.013, platforms)).step_by(2) {
            *own = other;
        }
        let found = all_found(&mut recordings, &STOPS_M);
        let [one] = &found[..] else { panic!("{found:?}") };
        assert!(one.scale.away_from(1.013) < 2.0 && one.runs == 3, "{one:?}");
        assert!(one.evidence().contains("in 3 runs; the other runs have another scale;"), "{}", one.evidence());
        for (index, first_m) in [(0, 0.0), (1, 700.0)] {
            let last_m = recordings[index].rows.last().unwrap().location_m.unwrap();
            assert!((last_m - first_m - 60_080.0).abs() < 130.0, "{last_m}");
        }
    }

    /// 20 stops in 9 km: with platforms known to 50 m a wheel shows from 1.8 % on.
    #[test]
    fn stops_that_are_all_near_their_line_show_a_smaller_wheel_than_scattered_ones() {
        let described_m: Vec<f64> = (0..20).map(|stop| 450.0 * f64::from(stop)).collect();
        let along = |read: f64, off_m: f64| {
            // No straight line in it.
            let off = |i: usize| off_m * [1.0, -1.0, -1.0, 1.0][i % 4];
            let platforms: Vec<(f64, f64)> = described_m.iter().enumerate().map(|(i, at_m)| (*at_m, off(i))).collect();
            found_along(&mut runs_along(read, &platforms, 3.0), &described_m)
        };
        for read in [0.985, 0.988, 1.012, 1.015] {
            let one = along(read, 5.0).unwrap().scale;
            assert!(one.away_from(read) < 2.0 && one.sd < 0.0025, "{one:?}");
            assert!(along(read, 60.0).is_none(), "{read}");
        }
        assert!(along(1.0, 5.0).is_none());
    }

    #[test]
    fn stops_that_are_described_in_another_unit_are_found() {
        let miles = runs(1.0 / 1.609_344, [0.0; 5]);
        assert_eq!(other_unit(&miles[0]), Some((1.0 / 1.609_344, 5)));
        assert_eq!(other_unit(&runs(1.013, [0.0; 5])[0]), None);
    }

    #[test]
    fn platforms_that_are_off_are_no_wheel() {
        assert!(found(&mut runs(1.0, [80.0, -40.0, 60.0, -90.0, -100.0])).is_none());
        assert!(found(&mut runs(1.002, [0.0; 5])).is_none());
    }
}
