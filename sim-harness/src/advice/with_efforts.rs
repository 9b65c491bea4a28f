//! Coasts beside which the effort column has a little power or brake: the motion alone takes them for coasts, and they
//! teach a resistance that is too small or too large by it.
//!
//! In: a run as replayed from its speeds and locations alone, and its rows. Out: how many of its coasts have efforts, and
//! the rows without these coasts.

use rundown::tick::regime::Regime;
use rundown_files::recording::Recording;
use rundown_files::replay::ReplayedRun;
use rundown_files::sample::Sample;
use rundown_files::statistics::midmean;

/// The coasts of a run by the motion alone.
#[derive(Debug, Default)]
pub(super) struct CoastsOf {
    pub(super) all: usize,
    /// First and last time of those with efforts, s.
    with_efforts_s: Vec<[f64; 2]>,
}

impl CoastsOf {
    /// A coast has efforts where their mean is beyond `most`, N/kg, whatever the speed: a zero that is off does not make
    /// some speeds pass. The motion shows where it begins and ends some seconds late.
    pub(super) fn found(run: &ReplayedRun, rows: &[Sample], most: f64) -> Self {
        let mut found = Self::default();
        let times_s = run.estimates.iter().map(|estimate| estimate.time_s);
        let regimes: Vec<(f64, bool)> = times_s.zip(run.regimes.iter().map(|one| *one == Regime::Coast)).collect();
        for coast in regimes.chunk_by(|a, b| a.1 == b.1).filter(|coast| coast[0].1) {
            let [from_s, to_s] = [coast[0].0, coast[coast.len() - 1].0];
            let inside = rows.iter().filter(|row| (from_s..=to_s).contains(&row.time_s));
            found.all += 1;
            if midmean(inside.filter_map(|row| row.effort_n_per_kg)).is_some_and(|effort| effort.abs() > most) {
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
        let coasts = run.regimes.iter().filter(|regime| **regime == Regime::Coast).count();
        assert_eq!(powered.left_of(&recording).unwrap().rows.len(), recording.rows.len() - coasts);
    }
}
