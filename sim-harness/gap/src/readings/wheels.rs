//! The wheel of a single train: a run whose odometer differs from those of the others.
//!
//! | compared | what it shows |
//! |---|---|
//! | speed against location, run by run, as the diagnosis of the logs has it | a wrong wheel diameter beside locations of a satellite receiver |
//! | distances between stops against those of the other runs | a wrong wheel diameter whose odometer gave the locations, too |
//!
//! A platform may be described some way off, so runs are compared with where the others stand; where platforms are
//! described, all runs together are compared with these, as surely as platforms are known. What all runs of a recorder
//! have alike in the first is put right before.

use crate::config::{GapConfig, WheelConfig};
use crate::data::{believed::Surroundings, runs::Run};
use crate::named::{Named, around, beside};
use crate::trial::Trial;
use crate::trials::of_scale;
use rundown::model::direction::Direction;
use rundown::model::effects::{Effect, SpeedScale};
use rundown_check::figure::Figure;
use rundown_files::sample::Sample;
use rundown_files::statistics::{mean_of, median, spread};
use std::collections::BTreeSet;

/// A wheel that is not as believed.
#[derive(Clone, Debug, PartialEq)]
pub struct Wheel {
    /// Indices of the runs; none: all.
    pub runs: Vec<usize>,
    pub measured_over_true: f64,
    pub sd: f64,
    /// The odometer gave the locations, too.
    pub locations: bool,
    /// It rests on single distances: these runs may as well have stopped elsewhere, all at one place.
    pub or_stops: bool,
    /// What each of the runs says of it, by its index.
    pub each: Vec<(usize, Figure)>,
}

#[derive(Clone, Copy, Debug)]
struct Scale {
    run: usize,
    value: f64,
    sd: f64,
    /// It rests on a single distance, and a stop elsewhere makes it as well: at a signal, or short of the yard.
    is_single: bool,
}

impl Scale {
    /// Beside that of the other runs.
    fn over(&self, usual: f64) -> (usize, Figure) {
        (self.run, Figure { value: self.value / usual, sd: self.sd / usual })
    }
}

/// All wheels that are not as believed.
pub fn wheels(runs: &[Run], surroundings: &Surroundings, config: &GapConfig) -> Vec<Wheel> {
    let by_speed: Vec<Scale> = runs
        .iter()
        .enumerate()
        .filter_map(|(run, one)| {
            let own = one.recorded.own_scale?;
            Some(Scale { run, value: own.value / one.recorded.correction.scale, sd: own.sd, is_single: false })
        })
        .collect();
    let mut found = exceptions(&by_speed, false, &config.wheel);
    let by_runs = scales_by_stops(runs, &surroundings.stops, false, &config.wheel);
    found.extend(exceptions(&by_runs, true, &config.wheel));
    if !surroundings.stops.is_empty() {
        found.extend(common(&scales_by_stops(runs, &surroundings.stops, true, &config.wheel), &config.wheel));
    }
    found
}

/// Middle and scatter of many runs, which a few exceptions do not move.
fn middle(scales: &[Scale], config: &WheelConfig) -> Option<(f64, f64)> {
    let middle = median(scales.iter().map(|s| s.value))?;
    let scatter = spread(scales.iter().map(|s| s.value - middle));
    Some((middle, scatter.max(config.least_scatter)))
}

/// Runs unlike the others, those with one wheel together.
fn exceptions<'a>(scales: &'a [Scale], locations: bool, config: &WheelConfig) -> Vec<Wheel> {
    let Some((middle, scatter)) = middle(scales, config) else {
        return Vec::new();
    };
    let unlike = |s: &&Scale| {
        let off = (s.value - middle).abs();
        (config.least..config.most).contains(&off) && off > config.sure * scatter.max(s.sd)
    };
    let (mut unlike, others): (Vec<&'a Scale>, Vec<&'a Scale>) = scales.iter().partition(unlike);
    let most = others.iter().map(|s| (s.value - middle).abs()).fold(0.0, f64::max);
    unlike.retain(|s| (s.value - middle).abs() > config.beyond * most);
    if scales.len() < config.least_runs || unlike.len() as f64 > config.most_share * scales.len() as f64 {
        return Vec::new();
    }
    unlike.sort_by(|a, b| a.value.total_cmp(&b.value));
    let wheels = unlike.chunk_by(|a, b| b.value - a.value < config.same);
    let mean = |of: &[&Scale]| mean_of(of.iter().map(|s| s.value));
    let or_stops = |of: &[&Scale]| of.iter().all(|s| s.is_single);
    let is_at = |s: &Scale, at: f64| (s.value - at).abs() < config.agreeing * scatter.max(s.sd);
    // Beside runs with several distances one with a single distance counts where it agrees with them.
    let of_wheel = |of: &[&'a Scale]| -> Vec<&'a Scale> {
        let several: Vec<&Scale> = of.iter().copied().filter(|s| !s.is_single).collect();
        let counts = |s: &&Scale| several.is_empty() || !s.is_single || is_at(s, mean(&several));
        of.iter().copied().filter(counts).collect()
    };
    let agree = |of: &[&Scale]| of.iter().all(|s| is_at(s, mean(of)));
    let tells = |of: &Vec<&Scale>| !or_stops(of) || (of.len() >= config.least_stops && agree(of));
    let wheel = |of: Vec<&Scale>| {
        let (count, value) = (of.len() as f64, mean(&of));
        let each = of.iter().map(|s| s.over(middle)).collect();
        let mut runs: Vec<usize> = of.iter().map(|s| s.run).collect();
        runs.sort_unstable();
        let sd = scatter / count.sqrt();
        Wheel { runs, measured_over_true: value / middle, sd, locations, or_stops: or_stops(&of), each }
    };
    wheels.map(of_wheel).filter(tells).map(wheel).collect()
}

/// All runs against the described platforms.
fn common(scales: &[Scale], config: &WheelConfig) -> Option<Wheel> {
    let (middle, scatter) = middle(scales, config)?;
    let off = (middle - 1.0).abs();
    // What the runs scatter, and what the platforms are off in all of them alike.
    let (of_runs, of_platforms) = (scatter / (scales.len() as f64).sqrt(), median(scales.iter().map(|s| s.sd))?);
    let sure = off > config.sure * of_runs && off > config.sure_of_platforms * of_platforms;
    let sd = of_runs.hypot(of_platforms);
    (scales.len() >= config.least_runs && off > config.least && sure).then_some(Wheel {
        runs: Vec::new(),
        measured_over_true: middle,
        sd,
        locations: true,
        or_stops: false,
        each: scales.iter().map(|s| s.over(1.0)).collect(),
    })
}

/// Each run's distance between its stops over that between the places where trains stop: where the other runs stand, or
/// the platforms as they are described, which are also taken where too few runs stand at the same places.
fn scales_by_stops(runs: &[Run], described: &[f64], as_described: bool, config: &WheelConfig) -> Vec<Scale> {
    let stops: Vec<Vec<f64>> = runs.iter().map(|run| stops(run, config.standing_mps)).collect();
    let places = |direction: Direction| -> Vec<f64> {
        if as_described {
            return described.to_vec();
        }
        let of = runs.iter().zip(&stops).enumerate();
        let of = of.filter(|(_, (run, _))| run.direction == direction);
        let all: Vec<(f64, usize)> =
            of.flat_map(|(index, (_, stops))| stops.iter().map(move |at| (*at, index))).collect();
        if described.is_empty() {
            return visited(all, config);
        }
        let places: Vec<f64> = described.iter().filter_map(|place| stood_at(*place, &all, config)).collect();
        if places.len() < 2 { described.to_vec() } else { places }
    };
    let place_sd_m = if as_described { config.platform_sd_m } else { 0.0 };
    let [up, down] = [Direction::Up, Direction::Down].map(places);
    let of = runs.iter().zip(&stops).enumerate();
    of.filter_map(|(run, (one, stops))| {
        let places = match one.direction {
            Direction::Up => &up,
            Direction::Down => &down,
        };
        let (Figure { value, sd }, is_single) = scale_by_stops(stops, places, place_sd_m, config)?;
        Some(Scale { run, value, sd, is_single })
    })
    .collect()
}

/// Where a run stands, m, in its order.
fn stops(run: &Run, standing_mps: f64) -> Vec<f64> {
    let located = |s: &Sample| Some((s.location_m?, s.speed_mps?));
    let read: Vec<(f64, f64)> = run.samples.iter().filter_map(located).collect();
    let standing = read.chunk_by(|a, b| (a.1 < standing_mps) == (b.1 < standing_mps));
    standing.filter(|part| part[0].1 < standing_mps).filter_map(|part| median(part.iter().map(|(at, _)| *at))).collect()
}

/// Where the runs stand that stop at a described platform. `None`: too few do.
fn stood_at(place_m: f64, all: &[(f64, usize)], config: &WheelConfig) -> Option<f64> {
    let near: Vec<(f64, usize)> =
        all.iter().copied().filter(|(at, _)| (at - place_m).abs() < 2.0 * config.stop_m).collect();
    let enough = runs_of(&near) >= config.least_stops.max(runs_of(all) / 3);
    median(near.iter().map(|(at, _)| *at)).filter(|_| enough)
}

fn runs_of(stops: &[(f64, usize)]) -> usize {
    stops.iter().map(|(_, run)| run).collect::<BTreeSet<_>>().len()
}

/// Places at which at least three runs, and a third of all, stand. `all`: location and run.
fn visited(mut all: Vec<(f64, usize)>, config: &WheelConfig) -> Vec<f64> {
    let least = config.least_stops.max(runs_of(&all) / 3);
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    all.chunk_by(|a, b| b.0 - a.0 < config.near_m)
        .filter(|stops| runs_of(stops) >= least)
        .filter_map(|stops| median(stops.iter().map(|(at, _)| *at)))
        .collect()
}

/// Scale of the distances from the first stop at a known place to the later ones, and whether it is a single distance
/// that a stop elsewhere makes as well: any that is too short, for a train is held at signals, but few that are too
/// long.
fn scale_by_stops(stops: &[f64], places: &[f64], place_sd_m: f64, config: &WheelConfig) -> Option<(Figure, bool)> {
    let (first, begin, from) = stops.iter().enumerate().find_map(|(i, at)| {
        let near = |place: &&f64| (*place - at).abs() < 2.0 * config.stop_m;
        places.iter().find(near).map(|place| (i, *at, *place))
    })?;
    let distances: Vec<f64> = stops[first + 1..].iter().map(|at| at - begin).collect();
    // Every place that a stop may be, each with its scale.
    let likely = |distance: f64| {
        let long = move |place: &&f64| (**place - from).abs() > config.least_distance_m;
        let scale = move |place: &f64| (distance / (place - from), place - from);
        let near = |(scale, _): &(f64, f64)| (scale - 1.0).abs() < config.most;
        places.iter().filter(long).map(scale).filter(near)
    };
    let off = |scale: f64, (other, distance): (f64, f64)| ((other - scale) * distance).abs();
    // The scale that most stops agree on; of those the nearest to the others' runs.
    let agreeing = |scale: f64| -> Vec<(f64, f64)> {
        let best = |distance: &f64| {
            let places = likely(*distance);
            places.min_by(|a, b| off(scale, *a).total_cmp(&off(scale, *b)))
        };
        let near = |one: &(f64, f64)| off(scale, *one) < config.stop_m;
        distances.iter().filter_map(best).filter(near).collect()
    };
    let tried = distances.iter().flat_map(|distance| likely(*distance)).map(|(s, _)| s);
    let better = |a: &f64, b: &f64| {
        let votes = agreeing(*a).len().cmp(&agreeing(*b).len());
        votes.then((b - 1.0).abs().total_cmp(&(a - 1.0).abs()))
    };
    let kept = agreeing(tried.max_by(better)?);
    // A wheel is in all distances: one that most do not share is a stop elsewhere.
    let known = distances.iter().filter(|distance| likely(**distance).next().is_some()).count();
    if (kept.len() as f64) < config.agreeing_share * known as f64 {
        return None;
    }
    let squares: f64 = kept.iter().map(|(_, distance)| distance * distance).sum();
    let value = kept.iter().map(|(s, distance)| s * distance * distance).sum::<f64>() / squares;
    // The first place is in all distances.
    let sum: f64 = kept.iter().map(|(_, distance)| distance.abs()).sum();
    let of_places = place_sd_m * (squares + sum * sum).sqrt() / squares;
    // They differ by what stops do, or by more.
    let apart: f64 = kept.iter().map(|one| off(value, *one).powi(2)).sum::<f64>();
    let stop_sd_m = config.stop_sd_m.max((apart / (kept.len() - 1).max(1) as f64).sqrt());
    let scale = Figure { value, sd: of_places.hypot(stop_sd_m / squares.sqrt()) };
    // A train that draws up to a signal stands twice at one place.
    let is_one_place = kept.iter().all(|(_, distance)| *distance == kept[0].1);
    let is_single = is_one_place && kept[0].1.abs() * (value - 1.0) < config.beyond_m;
    Some((scale, is_single))
}

/// The runs with their speeds, and locations where the odometer gave them, put right.
pub fn put_right(runs: &[Run], wheels: &[Wheel]) -> Vec<Run> {
    let mut right = runs.to_vec();
    for wheel in wheels {
        let scale = wheel.measured_over_true;
        let concerned = |i: &usize| wheel.runs.is_empty() || wheel.runs.contains(i);
        let runs = right.iter_mut().enumerate();
        for (_, run) in runs.filter(|(i, _)| concerned(i)) {
            if !wheel.locations {
                run.recorded.correction.scale *= scale;
            }
            let begin_m = run.samples.iter().find_map(|s| s.location_m);
            for sample in &mut run.samples {
                sample.speed_mps = sample.speed_mps.map(|v| v / scale);
                if let (true, Some(begin_m)) = (wheel.locations, begin_m) {
                    let put = |at: f64| begin_m + (at - begin_m) / scale;
                    sample.location_m = sample.location_m.map(put);
                }
            }
        }
    }
    right
}

impl Wheel {
    pub fn named(&self, runs: &[Run], config: &GapConfig) -> Named {
        let value = self.measured_over_true;
        let effect = Effect::SpeedScale(SpeedScale { measured_over_true: value });
        let off = (value - 1.0) / self.sd;
        let interval = around("measured_over_true", value, self.sd);
        let mut named = Named::plain(effect, vec![interval], 0.5 * off * off, config.certainty.most_gain);
        named.runs = self.runs.iter().map(|i| runs[*i].name.clone()).collect();
        if !self.runs.is_empty() {
            named.confidence = beside(named.confidence, config.certainty.unforeseen);
        }
        named.tried(self.trial(runs), config);
        if self.or_stops {
            named.or_else("stops of these runs elsewhere", config.wheel.elsewhere_odds, "runs with more stops");
        }
        named
    }

    /// It can be put right: nothing else explains it, and it repeats.
    pub fn stands(&self, runs: &[Run], config: &GapConfig) -> bool {
        !self.or_stops && self.trial(runs).is_none_or(|trial| trial.is_stood(config))
    }

    /// In halves of its runs; none of a single one.
    pub fn trial(&self, runs: &[Run]) -> Option<Trial> {
        of_scale(self.measured_over_true, &self.each, runs)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::load::Loaded;
    use rundown_files::recording::Recording;

    const PLACES_M: [f64; 5] = [0.0, 4_000.0, 9_000.0, 15_500.0, 24_000.0];

    fn runs(scales: &[f64], odometer: bool) -> Vec<Run> {
        runs_between(&PLACES_M, scales, odometer)
    }

    /// Runs from place to place, each stopping a few metres off; `odometer` gives the locations, too.
    fn runs_between(places_m: &[f64], scales: &[f64], odometer: bool) -> Vec<Run> {
        let run = |(i, scale): (usize, &f64)| {
            let mut samples = Vec::new();
            let mut time_s = 0.0;
            for pair in places_m.windows(2) {
                let off_m = 5.0 * ((i * 7 + samples.len()) as f64).sin();
                let distance_m = pair[1] - pair[0];
                // Constant rise and fall of the speed: the mean of the readings is that of the distance.
                let steps = 80;
                for k in 0..=steps {
                    let t = f64::from(k) / f64::from(steps);
                    let turn = std::f64::consts::TAU * t;
                    let at_m = pair[0] + distance_m * (t - turn.sin() / std::f64::consts::TAU);
                    let speed_mps = distance_m / 400.0 * (1.0 - turn.cos());
                    let shown_m = if odometer { at_m * scale } else { at_m };
                    samples.push(Sample {
                        time_s,
                        location_m: Some((shown_m + off_m * t).round()),
                        speed_mps: Some(speed_mps * scale),
                        ..Sample::default()
                    });
                    time_s += 5.0;
                }
            }
            Recording {
                name: format!("run{i}"),
                path: format!("run{i}.csv").into(),
                rows: samples,
                ..Recording::default()
            }
        };
        Loaded::of(scales.iter().enumerate().map(run).collect()).runs
    }

    #[test]
    fn a_wheel_unlike_the_others_is_found_by_speed_and_by_stops() {
        for odometer in [false, true] {
            let runs = runs(&[1.0, 1.0, 1.013, 1.0, 1.0, 1.0, 1.0], odometer);
            let found = wheels(&runs, &Surroundings::default(), &GapConfig::default());
            assert_eq!(found.len(), 1, "{found:?}");
            assert_eq!(found[0].runs, [2]);
            assert_eq!(found[0].locations, odometer);
            assert!((found[0].measured_over_true - 1.013).abs() < 0.001, "{found:?}");
            let again = wheels(&put_right(&runs, &found), &Surroundings::default(), &GapConfig::default());
            assert_eq!(again, []);
        }
    }

    #[test]
    fn runs_that_stop_short_of_the_only_other_place_have_no_wheel() {
        // Of 26 runs over 35 km three stop 318, 247 and 271 m before the others, as at signals.
        let scales = |short_m: [f64; 3]| -> Vec<f64> {
            short_m.map(|short_m| 1.0 - short_m / 35_000.0).into_iter().chain([1.0; 23]).collect()
        };
        let found = |places_m: &[f64], short_m: [f64; 3]| {
            let runs = runs_between(places_m, &scales(short_m), true);
            let config = GapConfig::default();
            let found = wheels(&runs, &Surroundings::default(), &config);
            found.iter().map(|wheel| (wheel.named(&runs, &config), wheel.stands(&runs, &config))).collect::<Vec<_>>()
        };
        assert!(found(&[0.0, 35_000.0], [318.0, 247.0, 271.0]).is_empty());
        // One run alone has none, however far it is from there.
        assert!(found(&[0.0, 35_000.0], [1_200.0, 0.0, 0.0]).is_empty());
        // Nor one that stops twice there.
        let places_m = [0.0, 33_800.0, 33_830.0];
        let mut drawn_up = runs_between(&[0.0, 35_000.0], &[1.0; 25], true);
        drawn_up.extend(runs_between(&places_m, &[1.0], true));
        assert_eq!(wheels(&drawn_up, &Surroundings::default(), &GapConfig::default()), []);
        // All at one place: a wheel or a signal.
        let one_place = found(&[0.0, 35_000.0], [280.0; 3]);
        let [(named, stands)] = &one_place[..] else { panic!("{one_place:?}") };
        assert!(named.or_else.is_some() && named.confidence < 0.5 && !stands, "{named:?}");
        // Other stops show that it is a wheel.
        let more_stops = found(&[0.0, 12_000.0, 35_000.0], [280.0; 3]);
        let [(named, stands)] = &more_stops[..] else { panic!("{more_stops:?}") };
        assert!(named.or_else.is_none() && named.confidence > 0.8 && *stands, "{named:?}");
    }

    #[test]
    fn described_platforms_judge_all_odometers_together() {
        let runs = runs(&[1.013; 6], true);
        assert_eq!(wheels(&runs, &Surroundings::default(), &GapConfig::default()), []);
        let described = Surroundings { stops: PLACES_M.to_vec(), ..Surroundings::default() };
        let found = wheels(&runs, &described, &GapConfig::default());
        assert_eq!(found.len(), 1, "{found:?}");
        assert!(found[0].runs.is_empty());
        assert!((found[0].measured_over_true - 1.013).abs() < 0.001, "{found:?}");
    }

    #[test]
    fn platforms_that_are_described_some_way_off_are_no_wheel() {
        let off_m = [40.0, -90.0, 95.0, -60.0, 100.0];
        let stops = PLACES_M.iter().zip(off_m).map(|(at, off)| at + off).collect();
        let described = Surroundings { stops, ..Surroundings::default() };
        assert_eq!(wheels(&runs(&[1.0; 8], true), &described, &GapConfig::default()), []);
        let found = wheels(&runs(&[1.0, 1.0, 1.013, 1.0, 1.0, 1.0, 1.0], true), &described, &GapConfig::default());
        assert!(matches!(found.as_slice(), [wheel] if wheel.runs == [2]), "{found:?}");
    }

    #[test]
    fn equal_wheels_are_no_finding() {
        for odometer in [false, true] {
            assert_eq!(wheels(&runs(&[1.0; 8], odometer), &Surroundings::default(), &GapConfig::default()), []);
        }
    }
}
