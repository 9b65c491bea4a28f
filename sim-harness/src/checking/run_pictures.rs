//! Pictures of one log: its readings against each other, and its clock.

use super::pictures::gaps;
use rundown_check::RunCheck;
use rundown_check::rows::ways;
use rundown_files::recording::Recording;
use rundown_files::sample::Sample;
use rundown_pages::chart::{Drawing, Figure, Layer, Panel, Point, Stroke, range_of};
use rundown_pages::colours;
use std::collections::HashMap;

const MINUTE_S: f64 = 60.0;
/// Steps of the clock beyond so many usual ones lie outside the picture.
const STEPS_SHOWN: f64 = 8.0;

/// Speed, and location less the distance by the speed, as recorded and as put right, over the time that was put right.
pub(super) fn readings(run: &RunCheck, recorded: &[Sample], right: &Recording) -> Drawing {
    let rows = &right.rows;
    let first_s = rows.first().map_or(0.0, |row| row.time_s);
    let minutes = |time_s: f64| (time_s - first_s) / MINUTE_S;
    let at: HashMap<u64, f64> = rows.iter().map(|row| (row.line, minutes(row.time_s))).collect();
    let x_of = |row: &Sample| at.get(&row.line).copied();
    let speeds = |rows: &[Sample]| rows.iter().map(|row| Some((x_of(row)?, 3.6 * row.speed_mps?))).collect();
    let pauses: Vec<_> = gaps(rows, run.step_s).into_iter().map(|gap| minutes(gap.start)..minutes(gap.end)).collect();
    let mut speed = vec![Layer::line("as recorded", colours::MEASURED, Stroke::Thin, speeds(recorded))];
    if !pauses.is_empty() {
        speed.insert(0, Layer::spans("no rows", colours::HELD, 0.2, pauses));
    }
    let distance = |legend: &str, colour, rows: &[Sample]| {
        let layers = [Layer::line(legend, colour, Stroke::Thin, less_distance(rows, &x_of))];
        Panel::new("location \u{2212} distance by speed, m", 260, layers, "location and speed are not both there")
    };
    // Each with its own heights: a jump of an hour would flatten what is right.
    let mut distances = vec![distance("as recorded", colours::MEASURED, recorded)];
    if rows.as_slice() != recorded {
        speed.push(Layer::line("put right", colours::ESTIMATED, Stroke::Thin, speeds(rows)));
        distances.push(distance("put right", colours::ESTIMATED, rows));
    }
    let panels: Vec<Panel> =
        std::iter::once(Panel::new("speed, km/h", 360, speed, "no speed")).chain(distances).collect();
    let x = range_of(rows.iter().map(|row| minutes(row.time_s)));
    Figure::new(
        format!("Readings of {}", run.name),
        "Speed, and location less the distance by the speed, as recorded and as put right",
        "time since the first row, min",
        x,
        panels,
    )
    .into()
}

/// Distance along the track less the integral of the speed, m, from 0 on; the line is broken where a reading is
/// missing.
fn less_distance(rows: &[Sample], x_of: &impl Fn(&Sample) -> Option<f64>) -> Vec<Option<Point>> {
    let sign = ways::heading(rows);
    let mut last: Option<(f64, f64)> = None;
    let mut by_speed_m = 0.0;
    let mut first_m = None;
    let mut points = Vec::with_capacity(rows.len());
    for row in rows {
        let (Some(location_m), Some(speed_mps)) = (row.location_m, row.speed_mps) else {
            points.push(None);
            continue;
        };
        if let Some((time_s, before_mps)) = last {
            by_speed_m += 0.5 * (row.time_s - time_s) * (speed_mps + before_mps);
        }
        last = Some((row.time_s, speed_mps));
        let moved_m = sign * location_m - *first_m.get_or_insert(sign * location_m);
        points.push(x_of(row).map(|x| (x, moved_m - by_speed_m)));
    }
    points
}

/// Time from row to row, as recorded, over the lines of the log.
pub(super) fn clock(run: &RunCheck, recorded: &[Sample]) -> Drawing {
    let [least, most] = [-1.0, STEPS_SHOWN].map(|steps| steps * run.step_s.max(0.1));
    let steps = recorded.windows(2).map(|pair| (pair[1].line as f64, pair[1].time_s - pair[0].time_s));
    let (mut shown, mut beyond) = (Vec::new(), Vec::new());
    for (line, step_s) in steps {
        let inside = (least..=most).contains(&step_s);
        shown.push(inside.then_some((line, step_s)));
        if !inside {
            beyond.push((line, if step_s > most { most } else { least }));
        }
    }
    let legend = format!("beyond {least:.0} to {most:.0} s");
    let mut layers = vec![Layer::line("from the row before", colours::MEASURED, Stroke::Thin, shown)];
    if !beyond.is_empty() {
        layers.push(Layer::marks(legend, colours::INVALID, beyond));
    }
    let air = 0.06 * (most - least);
    let panel = Panel::new("step of the clock, s", 260, layers, "fewer than two rows").within(least - air..most + air);
    Figure::new(
        format!("Clock of {}", run.name),
        "Time between rows as recorded, over the lines of the log",
        "line of the log",
        range_of(recorded.iter().map(|row| row.line as f64)),
        [panel],
    )
    .into()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(count: u32) -> Vec<Sample> {
        let row = |i: u32| Sample {
            line: u64::from(i) + 2,
            time_s: f64::from(i),
            location_m: Some(1000.0 - 10.0 * f64::from(i)),
            speed_mps: Some(10.0),
            ..Sample::default()
        };
        (0..count).map(row).collect()
    }

    #[test]
    fn location_and_speed_that_agree_leave_nothing_in_either_direction() {
        let rows = rows(100);
        let left = less_distance(&rows, &|row| Some(row.time_s));
        assert!(left.iter().all(|point| point.is_some_and(|(_, m)| m.abs() < 1e-6)));
    }

    #[test]
    fn a_jump_of_the_clock_is_marked_and_does_not_flatten_the_picture() {
        let mut rows = rows(100);
        rows.iter_mut().skip(50).for_each(|row| row.time_s -= 3600.0);
        let run = RunCheck {
            name: "run".to_owned(),
            speed_is_computed: false,
            unit: String::new(),
            rows: 100,
            step_s: 1.0,
            skew_s: None,
            location_noise_m: None,
            scale: None,
            findings: vec![],
            evidence: Default::default(),
            perturbations: vec![],
        };
        let Drawing::One(figure) = clock(&run, &rows) else { panic!("one figure") };
        let marks = figure.panels[0].layers.iter().find_map(|layer| match layer {
            Layer::Marks { points, .. } => Some(points.clone()),
            _ => None,
        });
        assert_eq!(marks, Some(vec![(52.0, -1.0)]));
        assert!(figure.panels[0].y.clone().is_some_and(|y| y.end < 10.0));
    }
}
