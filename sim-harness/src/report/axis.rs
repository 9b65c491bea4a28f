//! Where the samples of a run lie on the x axis of its figures, and where lines are broken.
//!
//! Figures of the motion go over the location, as the paper's; over the time when the train hardly moved. Figures of
//! the readings go over the time, because a standing train has many of them at one place.

use super::RunView;
use rundown::{Real, tick::estimate::Estimate};
use rundown_files::statistics::median;
use rundown_pages::chart::range_of;
use std::ops::Range;

/// A run that moved less has its figures over time, m.
const LEAST_DISTANCE_M: Real = 200.0;
/// A pause longer than this many usual ones is a gap.
const LONG_PAUSE: Real = 3.5;
/// Longer runs have their time in minutes, s.
const IN_MINUTES_S: Real = 300.0;

/// The x axis of a run, one place for each estimate.
#[derive(Clone, Debug)]
pub struct Axis {
    pub label: &'static str,
    /// Place of each estimate; none where it is unknown.
    pub x: Vec<Option<Real>>,
    pub range: Range<Real>,
    /// Zero and unit of the time, s; none where the axis is the location.
    clock_s: Option<[Real; 2]>,
    pauses: Vec<bool>,
}

impl Axis {
    /// Over the location in km, or over the time when the train hardly moved.
    pub fn of_motion(run: &RunView) -> Self {
        let locations_m: Vec<Real> = run.estimates.iter().map(|e| e.belief.mean[0]).collect();
        let ends_m = range_of(locations_m.iter().copied());
        if locations_m.is_empty() || ends_m.end - ends_m.start < LEAST_DISTANCE_M {
            return Self::of_time(run);
        }
        let x = locations_m.into_iter().map(|m| finite(m / 1000.0));
        Self::new(run, "location along the track, km", x.collect(), None)
    }

    /// Over the time since the first estimate.
    pub fn of_time(run: &RunView) -> Self {
        let time_s = || run.estimates.iter().map(|estimate| estimate.time_s);
        let first_s = time_s().find(|time_s| time_s.is_finite()).unwrap_or(0.0);
        let ends_s = range_of(time_s());
        let in_minutes = ends_s.end - ends_s.start > IN_MINUTES_S;
        let (label, unit_s) = match in_minutes {
            true => ("time since the first sample, min", 60.0),
            false => ("time since the first sample, s", 1.0),
        };
        let x = time_s().map(|time_s| finite((time_s - first_s) / unit_s));
        Self::new(run, label, x.collect(), Some([first_s, unit_s]))
    }

    fn new(run: &RunView, label: &'static str, x: Vec<Option<Real>>, clock_s: Option<[Real; 2]>) -> Self {
        let range = range_of(x.iter().flatten().copied());
        Self { label, range, x, clock_s, pauses: pauses(&run.estimates) }
    }

    /// The axis is the location.
    pub const fn is_location(&self) -> bool {
        self.clock_s.is_none()
    }

    /// Place on the axis of what happened at this location in m and time in s.
    pub fn at(&self, location_m: Real, time_s: Real) -> Real {
        match self.clock_s {
            None => location_m / 1000.0,
            Some([zero_s, unit_s]) => (time_s - zero_s) / unit_s,
        }
    }

    /// The train ran towards smaller locations.
    pub fn runs_backward(&self) -> bool {
        let mut ends = self.x.iter().flatten();
        let ends = (ends.next(), ends.next_back());
        matches!(ends, (Some(first), Some(last)) if self.is_location() && last < first)
    }

    /// A value for each estimate, with a gap where there is none and where there was a pause.
    pub fn series<T>(
        &self,
        estimates: &[Estimate],
        value: impl Fn(usize, &Estimate, Real) -> Option<T>,
    ) -> Vec<Option<T>> {
        let mut series = Vec::with_capacity(estimates.len());
        for (index, estimate) in estimates.iter().enumerate() {
            if self.has_pause_before(index) {
                series.push(None);
            }
            let x = self.x.get(index).copied().flatten();
            series.push(x.and_then(|x| value(index, estimate, x)));
        }
        series
    }

    /// Intervals between two estimates whose second one fulfils a condition, joined where they touch.
    pub fn spans(&self, estimates: &[Estimate], holds: impl Fn(usize, &Estimate) -> bool) -> Vec<Range<Real>> {
        let mut spans: Vec<Range<Real>> = Vec::new();
        let mut touches = false;
        for (index, estimate) in estimates.iter().enumerate() {
            let Some(end) = self.x.get(index).copied().flatten() else {
                touches = false;
                continue;
            };
            if !holds(index, estimate) {
                touches = false;
                continue;
            }
            let begun = match self.has_pause_before(index) {
                true => None,
                false => index.checked_sub(1).and_then(|before| self.x[before]),
            };
            match (spans.last_mut(), begun) {
                (Some(span), Some(_)) if touches => span.end = end,
                (_, begun) => spans.push(begun.unwrap_or(end)..end),
            }
            touches = true;
        }
        spans
    }

    /// The line is broken before this estimate.
    pub fn has_pause_before(&self, index: usize) -> bool {
        self.pauses.get(index).copied().unwrap_or(false)
    }
}

fn finite(value: Real) -> Option<Real> {
    value.is_finite().then_some(value)
}

/// Estimates that come long after the one before them, measured by the median of the run.
fn pauses(estimates: &[Estimate]) -> Vec<bool> {
    let steps_s = estimates.iter().skip(1).map(|estimate| estimate.dt_s);
    let Some(median_s) = median(steps_s.filter(|dt_s| *dt_s > 0.0 && dt_s.is_finite())) else {
        return vec![false; estimates.len()];
    };
    let mut pauses: Vec<bool> = estimates.iter().map(|e| e.dt_s > LONG_PAUSE * median_s).collect();
    if let Some(first) = pauses.first_mut() {
        *first = false;
    }
    pauses
}

#[cfg(test)]
mod tests {
    use super::super::example;
    use super::*;
    use rundown_files::replay::ReplayedRun;

    #[test]
    fn a_pause_is_a_gap_and_the_usual_step_is_none() {
        let gaps = |run: &ReplayedRun| -> Vec<usize> {
            let view = RunView::of(run, None);
            let series = Axis::of_time(&view).series(&view.estimates, |_, e, x| Some((x, e.time_s)));
            (0..series.len()).filter(|i| series[*i].is_none()).collect()
        };
        assert!(gaps(&example::run()).is_empty());
        assert_eq!(gaps(&example::without(20..32)), [20]);
    }

    #[test]
    fn touching_intervals_are_one_span() {
        let example = example::run();
        let view = RunView::of(&example, None);
        let axis = Axis::of_time(&view);
        let spans = axis.spans(&view.estimates, |i, _| (5..8).contains(&i) || i == 12);
        let x = |index: usize| axis.x[index].unwrap();
        assert_eq!(spans, [x(4)..x(7), x(11)..x(12)]);
        assert_eq!(axis.spans(&view.estimates, |i, _| i == 0), [x(0)..x(0)]);
    }

    #[test]
    fn a_train_that_hardly_moved_is_shown_over_time() {
        let example = example::standing();
        assert!(!Axis::of_motion(&RunView::of(&example, None)).is_location());
        let example = example::run();
        let axis = Axis::of_motion(&RunView::of(&example, None));
        assert!(axis.is_location() && !axis.runs_backward());
    }
}
