//! Coasts beside which the effort column has a little power or brake: the motion alone takes them for coasts, and they
//! teach a resistance that is too small or too large by it.
//!
//! In: a run as replayed from its speeds and locations alone, and its rows. Out: how many of its coasts have efforts,
//! and the rows without these coasts.

use rundown::tick::regime::Regime;
use rundown_check::rows::steps;
use rundown_files::recording::Recording;
use rundown_files::replay::ReplayedRun;
use rundown_files::sample::Sample;
use rundown_files::statistics::midmean;

/// An effort of one step of the column may be none: it is rounded.
const STEPS: f64 = 1.5;

/// The coasts of a run by the motion alone.
#[derive(Debug, Default)]
pub(super) struct CoastsOf {
    pub(super) all: usize,
    /// First and last time of those with efforts, s.
    with_efforts_s: Vec<[f64; 2]>,
}

impl CoastsOf {
    /// A coast has efforts where their mean is beyond `most`, N/kg, and beyond one step of the column, whatever the
    /// speed: a zero that is off does not make some of them pass. The motion shows where it begins and ends some
    /// seconds late.
    pub(super) fn found(run: &ReplayedRun, rows: &[Sample], most: f64) -> Self {
        let mut found = Self::default();
        let most = most.max(STEPS * steps::of_effort_n_per_kg(rows.iter()).unwrap_or_default());
        let times_s = run.estimates.iter().map(|estimate| estimate.time_s);
        let regimes: Vec<(f64, bool)> = times_s.zip(run.regimes.iter().map(|one| *one == Regime::Coast)).collect();
        for coast in regimes.chunk_by(|a, b| a.1 == b.1).filter(|coast| coast[0].1) {
            let [from_s, to_s] = [coast[0].0, coast[coast.len() - 1].0];
            let inside = rows.iter().filter(|row| (from_s..=to_s).contains(&row.time_s));
            let efforts: Vec<Option<f64>> = inside.map(|row| row.effort_n_per_kg).collect();
            let known: Vec<f64> = efforts.iter().copied().flatten().collect();
            found.all += 1;
            // Where zeros are left out the ends of a coast alone have efforts.
            if 2 * known.len() > efforts.len() && midmean(known).is_some_and(|effort| effort.abs() > most) {
                found.with_efforts_s.push([from_s, to_s]);
            }
        }
        found
    }

    pub(super) fn with_efforts(&self) -> usize {
        self.with_efforts_s.len()
    }

    /// The recording without the rows of coasts with efforts; none where there are no such coasts.
    pub(super) fn left_of(&self, recording: &Recording) -> Option<Recording> {
        let is_in =
            |row: &Sample| self.with_efforts_s.iter().any(|[from_s, to_s]| (*from_s..=*to_s).contains(&row.time_s));
        (!self.with_efforts_s.is_empty()).then(|| {
            let mut left = recording.clone();
            left.rows.retain(|row| !is_in(row));
            left
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::advice::tests::replayed;

    fn row_with(row: Sample, effort_n_per_kg: Option<f64>) -> Sample {
        Sample { effort_n_per_kg, ..row }
    }

    /// These rows, with such an effort while the run coasts.
    fn with_coasts(run: &ReplayedRun, rows: &[Sample], effort: Option<f64>) -> Vec<Sample> {
        let each = rows.iter().zip(&run.regimes);
        each.map(|(row, regime)| if *regime == Regime::Coast { row_with(*row, effort) } else { *row }).collect()
    }

    #[test]
    fn coasts_with_efforts_are_counted_and_left_out() {
        let run = &replayed().runs[0];
        let row =
            |effort: f64| move |time_s: f64| Sample { time_s, effort_n_per_kg: Some(effort), ..Sample::default() };
        let rows = |effort| run.estimates.iter().map(|one| one.time_s).map(row(effort)).collect::<Vec<Sample>>();
        let free = CoastsOf::found(run, &rows(0.0), 1e-3);
        assert!(free.all > 0 && free.with_efforts() == 0);
        let recording = Recording { rows: rows(-0.01), ..Recording::default() };
        assert_eq!(free.left_of(&recording), None);
        let powered = CoastsOf::found(run, &recording.rows, 1e-3);
        assert_eq!(powered.with_efforts(), powered.all);
        // A column of such steps has none that is smaller, and one that is mostly empty says nothing.
        let of_steps = |at: usize| (at % 40) as f64 * 0.01;
        let coarse: Vec<Sample> =
            rows(0.0).into_iter().enumerate().map(|(at, row)| row_with(row, Some(of_steps(at)))).collect();
        assert_eq!(CoastsOf::found(run, &with_coasts(run, &coarse, Some(0.01)), 1e-3).with_efforts(), 0);
        let mostly_empty = |(at, row): (usize, Sample)| row_with(row, at.is_multiple_of(3).then_some(0.05));
        let sparse: Vec<Sample> = rows(0.0).into_iter().enumerate().map(mostly_empty).collect();
        assert_eq!(CoastsOf::found(run, &sparse, 1e-3).with_efforts(), 0);
        let coasts = run.regimes.iter().filter(|regime| **regime == Regime::Coast).count();
        assert_eq!(powered.left_of(&recording).unwrap().rows.len(), recording.rows.len() - coasts);
    }
}
