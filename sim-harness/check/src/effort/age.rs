//! By how much the measured effort is older than the speed.
//!
//! In: rows of a run, put right. Out: the age, with its standard deviation; and efforts that are moved by it.
//!
//! With `E(t)` the integral of the column over time, an age `a` and the mean over windows of some seconds,
//!
//! ```text
//! Δv/Δt = k (E(t1 + a) - E(t0 + a))/Δt - r0 - r1 v - r2 v² + noise
//! ```
//!
//! Gain and resistance are fitted for each age; the one with the least squares is the age of the run. A row may hold
//! the mean since the row before or the effort at the moment: both readings are tried, and what they do not decide is
//! doubt. Gradients count where the track is described. Where a driver holds the speed the effort follows them, seconds
//! late, which would look like an age; so windows around which the effort changes little do not count. Where none
//! counts, as of freight trains, whose efforts are small, smaller changes count that come at once.

use crate::figure::Figure;
use nalgebra::{Matrix4, Vector4};
use rundown::model::line::Line;
use rundown_files::sample::Sample;
use rundown_files::statistics::{extremes, median_of, spread};

/// A window is at least so long, s.
const WINDOW_S: f64 = 4.0;
/// Ages up to this are tried, s; where rows are far apart, up to so many rows. The two largest steps of the search are
/// never an answer: the true age may be beyond them.
const MOST_S: f64 = 12.0;
const MOST_ROWS: f64 = 3.0;
/// Fewer windows of a moving train say nothing.
const LEAST_WINDOWS: usize = 60;
/// Efforts that change by less within the ages that are tried may follow a gradient. Holding the speed over 10 permille
/// takes as much.
const LARGE: LeastChange = LeastChange { n_per_kg: 0.1, at_once_n_per_kg: 0.0 };
/// A lever that is set to coast, or to power, from one row to the next.
const AT_ONCE: LeastChange = LeastChange { n_per_kg: 0.03, at_once_n_per_kg: 0.02 };
/// Slower trains may stand within the window, m/s.
const SLOWEST_MPS: f64 = 1.0;
/// Efforts are late by whole rows that are so to this share of a row.
const WHOLE: f64 = 0.1;
/// Nats by which one reading of the column must beat the other.
const CLEARLY: f64 = 20.0;

/// Change of the effort around a window that counts.
#[derive(Clone, Copy)]
struct LeastChange {
    /// Within the ages that are tried, N/kg.
    n_per_kg: f64,
    /// From one row to the next, N/kg.
    at_once_n_per_kg: f64,
}

/// What a row of the column holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Reading {
    /// The mean since the row before.
    Mean,
    /// The effort at the moment.
    Momentary,
}

/// The age of the efforts of one run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Age {
    pub(crate) age_s: Figure,
    pub(crate) log_likelihood: f64,
}

/// The efforts of rows that follow each other without a gap.
struct EffortStretch {
    /// Time, s, effort, N/kg, and its integral, N s/kg.
    rows: Vec<[f64; 3]>,
    reading: Reading,
}

impl EffortStretch {
    fn of(rows: &[&Sample], reading: Reading) -> Self {
        let mut known: Vec<[f64; 3]> = Vec::with_capacity(rows.len());
        for row in rows {
            let effort = row.effort_n_per_kg.unwrap_or_default();
            let sum = known.last().map_or(0.0, |[time_s, before, sum]| {
                let mean = if reading == Reading::Mean { effort } else { 0.5 * (before + effort) };
                sum + mean * (row.time_s - time_s)
            });
            known.push([row.time_s, effort, sum]);
        }
        Self { rows: known, reading }
    }

    /// The effort at a time and its integral up to there; none beyond the ends.
    fn at(&self, time_s: f64) -> Option<[f64; 2]> {
        let after = self.rows.partition_point(|[row_s, ..]| *row_s < time_s);
        let [to_s, to, to_sum] = *self.rows.get(after)?;
        if after == 0 {
            return (to_s == time_s).then_some([to, to_sum]);
        }
        let [from_s, from, from_sum] = self.rows[after - 1];
        let dt = time_s - from_s;
        let effort = if self.reading == Reading::Mean { to } else { from + (to - from) * dt / (to_s - from_s) };
        let mean = if self.reading == Reading::Mean { to } else { 0.5 * (from + effort) };
        Some([effort, from_sum + mean * dt])
    }
}

/// Rows with speed and effort, cut at gaps.
fn stretches(rows: &[Sample], step_s: f64) -> Vec<Vec<&Sample>> {
    let mut found: Vec<Vec<&Sample>> = vec![Vec::new()];
    let mut before_s = f64::NEG_INFINITY;
    for row in rows {
        let complete = row.speed_mps.is_some() && row.effort_n_per_kg.is_some();
        if !complete || row.time_s - before_s > 3.5 * step_s || row.time_s <= before_s {
            found.push(Vec::new());
        }
        before_s = row.time_s;
        if complete && let Some(last) = found.last_mut() {
            last.push(row);
        }
    }
    // Rows that are not complete leave empty ones behind: a column with few values has as many as rows.
    found.retain(|rows| !rows.is_empty());
    found
}

/// Ends of a window, s, their mean speed, m/s, and the acceleration, m/s².
struct Window {
    stretch: usize,
    ends_s: [f64; 2],
    speed_mps: f64,
    /// Gravity's part taken out.
    acceleration_mps2: f64,
}

fn windows(stretches: &[Vec<&Sample>], line: Option<Line<'_>>, most_s: f64, least: LeastChange) -> Vec<Window> {
    let gradient = |row: &Sample| line.zip(row.location_m).map_or(0.0, |(line, at_m)| line.gradient_n_per_kg(at_m));
    let mut found = Vec::new();
    for (stretch, rows) in stretches.iter().enumerate() {
        let Some((first, last)) = rows.first().zip(rows.last()) else { continue };
        let mut begin: Option<&Sample> = None;
        for row in rows {
            let mps = row.speed_mps.unwrap_or_default();
            let is_within = row.time_s - first.time_s > most_s && last.time_s - row.time_s > most_s;
            if !is_within || mps < SLOWEST_MPS {
                begin = None;
                continue;
            }
            let Some(from) = begin else {
                begin = Some(row);
                continue;
            };
            let long_s = row.time_s - from.time_s;
            if long_s >= WINDOW_S {
                begin = Some(row);
                if !least.is_in(rows, [from.time_s - most_s, row.time_s + most_s]) {
                    continue;
                }
                let from_mps = from.speed_mps.unwrap_or_default();
                found.push(Window {
                    stretch,
                    ends_s: [from.time_s, row.time_s],
                    speed_mps: 0.5 * (mps + from_mps),
                    acceleration_mps2: (mps - from_mps) / long_s + 0.5 * (gradient(from) + gradient(row)),
                });
            }
        }
    }
    found
}

impl LeastChange {
    /// The efforts between two times change so much.
    fn is_in(self, rows: &[&Sample], [from_s, to_s]: [f64; 2]) -> bool {
        let [from, to] = [from_s, to_s].map(|time_s| rows.partition_point(|row| row.time_s < time_s));
        let efforts: Vec<f64> = rows[from..to].iter().filter_map(|row| row.effort_n_per_kg).collect();
        let (least, most) = extremes(&efforts);
        let at_once = efforts.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
        most - least >= self.n_per_kg && at_once >= self.at_once_n_per_kg
    }
}

fn residuals(windows: &[Window], efforts: &[EffortStretch], age_s: f64) -> Option<Vec<f64>> {
    let mut rows = Vec::with_capacity(windows.len());
    let (mut normal, mut score) = (Matrix4::zeros(), Vector4::zeros());
    for Window { stretch, ends_s: [from_s, to_s], speed_mps, acceleration_mps2 } in windows {
        let [[_, from], [_, to]] = [efforts[*stretch].at(from_s + age_s)?, efforts[*stretch].at(to_s + age_s)?];
        let x = Vector4::new((to - from) / (to_s - from_s), 1.0, *speed_mps, speed_mps * speed_mps);
        normal += x * x.transpose();
        score += x * *acceleration_mps2;
        rows.push((x, *acceleration_mps2));
    }
    let beta = normal.cholesky()?.solve(&score);
    Some(rows.iter().map(|(x, y)| y - x.dot(&beta)).collect())
}

/// A run whose efforts are asked for their age.
#[derive(Clone, Copy)]
pub(crate) struct Asked<'a> {
    pub(crate) rows: &'a [Sample],
    pub(crate) step_s: f64,
    /// Where the track is described.
    pub(crate) line: Option<Line<'a>>,
}

/// The age of the efforts of a run, read in this way; none where too little of it powers and brakes.
pub(crate) fn of_run(run: Asked<'_>, reading: Reading) -> Option<Age> {
    of_changes(run, reading, LARGE)
}

fn of_changes(Asked { rows, step_s, line }: Asked<'_>, reading: Reading, least: LeastChange) -> Option<Age> {
    let most_s = MOST_S.max(MOST_ROWS * step_s);
    let stretches = stretches(rows, step_s);
    let windows = windows(&stretches, line, most_s + step_s, least);
    if windows.len() < LEAST_WINDOWS {
        return None;
    }
    let efforts: Vec<EffortStretch> = stretches.iter().map(|rows| EffortStretch::of(rows, reading)).collect();
    let squares = |age_s: f64| {
        let left = residuals(&windows, &efforts, age_s)?;
        Some(left.iter().map(|one| one * one).sum::<f64>())
    };
    let grid_s = 0.1 * step_s.max(5.0);
    let best = |ages: &mut dyn Iterator<Item = f64>| {
        let tried = ages.filter_map(|age_s| Some((age_s, squares(age_s)?)));
        tried.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(age_s, _)| age_s)
    };
    let count = (most_s / (2.0 * grid_s)).floor() as i32;
    let near_s = best(&mut (-count..=count).map(|i| 2.0 * grid_s * f64::from(i)))?;
    let at_s = best(&mut (-2..=2).map(|i| near_s + grid_s * f64::from(i)))?;
    if at_s.abs() > most_s - 2.0 * grid_s {
        return None;
    }
    let [before, least, after] = [squares(at_s - grid_s)?, squares(at_s)?, squares(at_s + grid_s)?];
    let bend = before - 2.0 * least + after;
    if bend <= 0.0 {
        return None;
    }
    let n = windows.len() as f64;
    let left = residuals(&windows, &efforts, at_s)?;
    let products = left.windows(2).map(|pair| pair[0] * pair[1]).sum::<f64>();
    let kept = (products / least.max(f64::MIN_POSITIVE)).clamp(0.0, 0.9);
    let variance = 2.0 * least / (n - 5.0) * grid_s * grid_s / bend * (1.0 + kept) / (1.0 - kept);
    let age_s = Figure { value: at_s + 0.5 * grid_s * (before - after) / bend, sd: variance.sqrt() };
    Some(Age { age_s, log_likelihood: -0.5 * n * (least / n).ln() })
}

/// The age of a column in several runs.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Usual {
    /// Between both readings, where neither is clearly better.
    pub(crate) age_s: Figure,
    /// How much it differs from run to run, s.
    pub(crate) spread_s: f64,
    /// The same once the column is read as means, s.
    as_means_s: f64,
    /// Means or momentary, that is clear.
    is_clear: bool,
}

impl Usual {
    /// By how many rows efforts are late that are late by whole rows.
    pub(crate) fn whole_rows(&self, step_s: f64) -> Option<isize> {
        let rows = (self.age_s.value / step_s).round();
        let is_whole = (self.age_s.value - rows * step_s).abs() < WHOLE * step_s;
        (self.is_clear && is_whole && rows != 0.0).then_some(rows as isize)
    }
}

/// The usual age in some runs; none where none is known.
pub(crate) fn usual(runs: &[Asked<'_>]) -> Option<Usual> {
    let ages = |least: LeastChange| -> Vec<[Age; 2]> {
        let of = |run: Asked<'_>, reading| of_changes(run, reading, least);
        runs.iter().filter_map(|run| Some([of(*run, Reading::Mean)?, of(*run, Reading::Momentary)?])).collect()
    };
    let ages = [LARGE, AT_ONCE].into_iter().map(ages).find(|ages| !ages.is_empty())?;
    let [(mean, spread_s), (momentary, _)] = [0, 1].map(|i| pooled(ages.iter().map(|both| both[i].age_s)));
    let gain: f64 = ages.iter().map(|[mean, momentary]| mean.log_likelihood - momentary.log_likelihood).sum();
    let half_s = 0.5 * (momentary.value - mean.value);
    let age_s = match gain {
        CLEARLY.. => mean,
        _ if gain < -CLEARLY => momentary,
        // Anywhere between the two.
        _ => Figure { value: mean.value + half_s, sd: mean.sd.max(momentary.sd).hypot(half_s / 3.0_f64.sqrt()) },
    };
    Some(Usual { age_s, spread_s, as_means_s: mean.value, is_clear: gain.abs() >= CLEARLY })
}

/// Mean, and the standard deviation between runs.
pub(crate) fn pooled(ages: impl Iterator<Item = Figure> + Clone) -> (Figure, f64) {
    let values: Vec<f64> = ages.clone().map(|age| age.value).collect();
    let middle_s = median_of(&values);
    let spread_s = spread(values.iter().map(|value| value - middle_s));
    let weight = |age: Figure| (age.sd.powi(2) + spread_s * spread_s).recip();
    let all: f64 = ages.clone().map(weight).sum();
    let value = ages.map(|age| weight(age) * age.value).sum::<f64>() / all;
    (Figure { value, sd: all.sqrt().recip() }, spread_s)
}

/// Brings the efforts of a run to the rows that they belong to, so many rows before them; beside a gap they are lost.
pub(crate) fn move_by_rows(rows: &mut [Sample], step_s: f64, by: isize) {
    let read: Vec<(f64, Option<f64>)> = rows.iter().map(|row| (row.time_s, row.effort_n_per_kg)).collect();
    for (at, row) in rows.iter_mut().enumerate() {
        let from = at.checked_add_signed(by).and_then(|from| read.get(from));
        let is_near =
            |(time_s, _): &&(f64, Option<f64>)| ((time_s - row.time_s) - by as f64 * step_s).abs() < WHOLE * step_s;
        row.effort_n_per_kg = from.filter(is_near).and_then(|(_, effort)| *effort);
    }
}

/// Brings the efforts of a run to the age of its speeds, as means since the row before. As such they are read, too,
/// whatever they were: of one at the moment the age comes out half a row less, and its mean is right.
pub(crate) fn move_efforts(rows: &mut [Sample], step_s: f64, line: Option<Line<'_>>, usual: &Usual) {
    let run = Asked { rows, step_s, line };
    let alone = [LARGE, AT_ONCE].into_iter().find_map(|least| of_changes(run, Reading::Mean, least));
    let age_s = alone.map_or(usual.as_means_s, |own| own.age_s.drawn(usual.as_means_s, usual.spread_s));
    let efforts: Vec<EffortStretch> =
        stretches(rows, step_s).iter().map(|rows| EffortStretch::of(rows, Reading::Mean)).collect();
    let within = |time_s: f64| {
        let ends_before = |stretch: &EffortStretch| stretch.rows.last().is_none_or(|[last_s, ..]| *last_s < time_s);
        efforts.get(efforts.partition_point(ends_before))
    };
    let mut before_s = f64::NEG_INFINITY;
    for row in rows {
        let now_s = row.time_s + age_s;
        row.effort_n_per_kg = row.effort_n_per_kg.and_then(|_| {
            let stretch = within(now_s)?;
            let [effort, sum] = stretch.at(now_s)?;
            Some(stretch.at(before_s).map_or(effort, |[_, before]| (sum - before) / (now_s - before_s)))
        });
        before_s = now_s;
    }
}
