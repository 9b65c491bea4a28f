//! Pictures of a recorder: speed against location, the digits of its speeds, what differs from run to run.

use plotters::style::RGBColor;
use rundown_check::figure::{Figure as Value, HALF_95};
use rundown_check::{RecorderCheck, Row, RunCheck, parts};
use rundown_files::recording::Recording;
use rundown_files::sample::Sample;
use rundown_files::statistics::{Pairs, upper_quantile};
use rundown_pages::chart::{Drawing, Figure, Grid, Layer, Panel, Point, Stroke, range_of};
use rundown_pages::colours;
use std::ops::Range;

/// Mean speeds are compared over at least this long: locations a few metres off are then 1 km/h.
const WINDOW_S: f64 = 20.0;
/// Slower windows are left out: a train that stands says nothing of its wheel.
const LEAST_KMH: f64 = 5.0;
/// Width of the classes of speed of which means are drawn.
const CLASS_KMH: f64 = 10.0;
/// Fewer windows have no interval.
const LEAST_IN_CLASS: usize = 5;
/// More dots are one blot, and heavy to open.
pub(super) const MOST_DOTS: usize = 3000;
const SHADES: RGBColor = RGBColor(90, 90, 90);

/// A window of a run: mean speed as read, and true less read speed, km/h.
pub(super) type ComparedWindow = Point;

/// Mean speed by the location less mean speed as read, each in windows of [`WINDOW_S`]; the skew is taken out.
pub(super) fn compared(run: &RunCheck, recorder: &RecorderCheck, right: &Recording) -> Vec<ComparedWindow> {
    let skew_s = run.skew_s.map_or(0.0, |skew| skew.value);
    let mut windows = Vec::new();
    for part in parts(&right.rows, run.step_s) {
        let read: Vec<Row> =
            part.iter().map(|row| Row { speed_mps: recorder.correction.read_mps(row.speed_mps), ..*row }).collect();
        windows.extend(of_part(&read, skew_s).into_iter().filter(|(kmh, _)| *kmh > LEAST_KMH));
    }
    windows
}

fn of_part(rows: &[Row], skew_s: f64) -> Vec<ComparedWindow> {
    let mut windows = Vec::new();
    let mut first = 0;
    for last in 1..rows.len() {
        let time_s = rows[last].time_s - rows[first].time_s;
        if time_s < WINDOW_S {
            continue;
        }
        let steps = rows[first..=last].windows(2);
        let read_m: f64 =
            steps.map(|pair| 0.5 * (pair[1].time_s - pair[0].time_s) * (pair[0].speed_mps + pair[1].speed_mps)).sum();
        let moved_m = rows[last].location_m - rows[first].location_m;
        let late_m = skew_s * (rows[last].speed_mps - rows[first].speed_mps);
        windows.push((3.6 * read_m / time_s, 3.6 * (moved_m - read_m - late_m) / time_s));
        first = last;
    }
    windows
}

/// Each window a dot, their means with 95 % intervals, and what was fitted.
pub(super) fn speed_against_location(recorder: &RecorderCheck, windows: &[ComparedWindow]) -> Drawing {
    // Up to the end of a class: the fastest windows do not lie on the frame.
    let fastest_kmh = range_of(windows.iter().map(|w| w.0)).end.max(CLASS_KMH);
    let x = 0.0..CLASS_KMH * (1.0 + (fastest_kmh / CLASS_KMH).floor());
    let every = windows.len().div_ceil(MOST_DOTS).max(1);
    let dots = windows.iter().step_by(every).copied().collect();
    let (means, bars) = classes(windows);
    let mut layers = vec![
        Layer::dots("a stretch of 20 s or more", SHADES, 0.25, dots),
        Layer::threads("95 % interval of the mean", colours::MEASURED, 1.0, bars),
        Layer::dots("mean in 10 km/h", colours::MEASURED, 1.0, means.clone()),
    ];
    if let (Some(scale), Some(offset_kmh)) = (recorder.scale, recorder.decided_offset_kmh()) {
        // read = scale v - offset
        let line = |kmh: f64| Some((kmh, (kmh + offset_kmh) / scale.value - kmh));
        let points = (0..=20).map(|i| line(x.end * f64::from(i) / 20.0)).collect();
        let legend = format!("fitted: scale {:.4}, offset {offset_kmh:.2} km/h", scale.value);
        layers.push(Layer::line(legend, colours::ESTIMATED, Stroke::Solid, points));
    }
    // The spread of single windows is that of the locations: the means must still be seen.
    let spread = upper_quantile(windows.iter().map(|w| w.1.abs()), 0.9).unwrap_or(1.0);
    let of_means = range_of(means.iter().map(|mean| mean.1));
    let y = of_means.start.min(0.0) - 1.3 * spread..of_means.end.max(0.0) + 1.3 * spread;
    let empty = "too little moves with both readings";
    let panel = Panel::new("speed by location \u{2212} speed as read, km/h", 460, layers, empty).within(y);
    Figure::new(
        "Speed against location",
        "Difference of the speed by the location and the speed as read, over the speed",
        "speed as read, km/h",
        x,
        [panel],
    )
    .into()
}

/// Means in classes of speed, and their 95 % intervals.
fn classes(windows: &[ComparedWindow]) -> (Vec<Point>, Vec<Vec<Option<Point>>>) {
    let mut by_class: Vec<Vec<ComparedWindow>> = Vec::new();
    for window in windows {
        let class = (window.0 / CLASS_KMH) as usize;
        if by_class.len() <= class {
            by_class.resize(class + 1, Vec::new());
        }
        by_class[class].push(*window);
    }
    let (mut means, mut bars) = (Vec::new(), Vec::new());
    for class in by_class.iter().filter(|class| class.len() >= LEAST_IN_CLASS) {
        let n = class.len() as f64;
        let Pairs { x, y, yy, .. } = Pairs::of(class);
        let half = HALF_95 * (yy / (n - 1.0) / n).sqrt();
        means.push((x, y));
        bars.push(vec![Some((x, y - half)), Some((x, y + half))]);
    }
    (means, bars)
}

/// The digits of the speeds, and scale and skew run by run.
pub(super) fn digits_and_runs(runs: &[&RunCheck], recorded: &[&[Sample]]) -> Drawing {
    let values = |of: fn(&RunCheck) -> Option<Value>| -> Vec<(f64, Option<Value>)> {
        runs.iter().enumerate().map(|(i, run)| ((i + 1) as f64, of(run))).collect()
    };
    let figures = vec![
        fractions(recorded),
        by_run("speed over location, run by run", 1.0, &values(|run| run.scale)),
        by_run("speed older than location, s", 0.0, &values(|run| run.skew_s)),
    ];
    Grid::new(
        "Digits of the speeds, scale and skew of each run",
        "Histogram of the fraction of a km/h of the speeds; scale and skew of each run with 95 % intervals",
        3,
        figures,
    )
    .into()
}

/// Which fractions of a km/h the speeds have: a recorder that shows whole km/h has only one.
fn fractions(recorded: &[&[Sample]]) -> Figure {
    const BINS: usize = 20;
    let mut counts = [0.0; BINS];
    let moving = recorded.iter().copied().flatten().filter_map(|row| row.speed_mps).filter(|mps| *mps > 0.0);
    for mps in moving {
        let bin = (BINS as f64 * (3.6 * mps).fract()).round() as usize % BINS;
        counts[bin] += 1.0;
    }
    let all = counts.iter().sum::<f64>().max(1.0);
    let width = 1.0 / BINS as f64;
    let bin = |(i, count): (usize, f64)| (width * (i as f64 - 0.5)..width * (i as f64 + 0.5), 100.0 * count / all);
    let bins = counts.into_iter().enumerate().map(bin).collect();
    let layers = [Layer::histogram("share of the readings above 0", colours::MEASURED, 0.5, bins)];
    let panel = Panel::new("readings, %", 300, layers, "no speed above 0");
    Figure::in_grid("fraction of a speed, km/h", -0.5 * width..1.0 - 0.5 * width, panel)
}

fn by_run(label: &str, right: f64, values: &[(f64, Option<Value>)]) -> Figure {
    let known = || values.iter().filter_map(|(x, value)| value.map(|value| (*x, value)));
    let bars = known().map(|(x, value)| value.interval().map(|end| Some((x, end))).to_vec()).collect();
    let x = 0.5..values.len().max(1) as f64 + 0.5;
    let layers = [
        Layer::threads("95 % interval", colours::MEASURED, 0.7, bars),
        Layer::dots("of the run alone", colours::MEASURED, 1.0, known().map(|(x, value)| (x, value.value)).collect()),
        Layer::level("", colours::LIMIT, Stroke::Dashed, &x, right),
    ];
    let panel = Panel::new(label, 300, layers, "too little moves");
    Figure::in_grid("run, in the order of the table", x, panel).over_counts()
}

/// Where a run has no rows for longer than this many usual steps.
pub(super) const GAP_STEPS: f64 = 3.5;

/// Stretches without rows, by the time of the rows before and after.
pub(super) fn gaps(rows: &[Sample], step_s: f64) -> Vec<Range<f64>> {
    let longest_s = (GAP_STEPS * step_s).max(10.0);
    let long = |pair: &&[Sample]| pair[1].time_s - pair[0].time_s > longest_s;
    rows.windows(2).filter(long).map(|pair| pair[0].time_s..pair[1].time_s).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A train that accelerates to 30 m/s and back, read by a wheel that is 2 % too fast.
    fn rows(scale: f64) -> Vec<Row> {
        let row = |i: u32| {
            let t = f64::from(i);
            let (speed, location_m) = (20.0 - 10.0 * (t / 100.0).cos(), 20.0 * t - 1000.0 * (t / 100.0).sin());
            Row { time_s: t, location_m, speed_mps: scale * speed }
        };
        (0..1200).map(row).collect()
    }

    #[test]
    fn a_wheel_is_a_slope_of_the_windows() {
        for (kmh, difference) in of_part(&rows(1.02), 0.0) {
            assert!((difference - kmh * (1.0 / 1.02 - 1.0)).abs() < 1e-3, "{kmh} {difference}");
        }
        let (means, bars) = classes(&of_part(&rows(1.0), 0.0));
        assert!(means.len() >= 7 && means.len() == bars.len());
        assert!(means.iter().all(|mean| mean.1.abs() < 1e-3));
    }

    #[test]
    fn whole_kilometres_an_hour_have_one_fraction() {
        let rows =
            |kmh: f64| (1..50).map(move |i| Sample { speed_mps: Some(f64::from(i) * kmh / 3.6), ..Sample::default() });
        let shares = |kmh: f64| {
            let rows: Vec<Sample> = rows(kmh).collect();
            let figure = fractions(&[&rows]);
            match &figure.panels[0].layers[0] {
                Layer::Histogram { bins, .. } => bins.iter().map(|(_, share)| *share).collect::<Vec<f64>>(),
                other => panic!("{other:?}"),
            }
        };
        assert_eq!(shares(1.0)[0], 100.0);
        assert!(shares(0.137).iter().all(|share| *share < 20.0));
    }
}
