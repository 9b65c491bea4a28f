//! `report.html`: what the estimator said of some runs, for a railway engineer who reads from top to bottom; and a page
//! for each run.
//!
//! ```text
//! Report -> page (words, tables) ------------> report.html, report/run0001.html ...
//!        -> figures -> axis, chart -> SVG ->
//! ```
//!
//! In: a `Report`, which borrows what the replay has. Out: HTML files that ask for nothing outside their folder. The
//! first has what concerns all runs, so that a thousand of them open at once; a run's page is read when the reader goes
//! there. The figures are functions of their own (`figures`) for other reports.
//!
//! A missing value is a gap in a figure and a dash in a table, with its reason beside it; a number that is not finite
//! is never shown.

mod axis;
pub(crate) mod figures;
pub(crate) mod page;
pub mod resistance;

#[cfg(test)]
pub(crate) mod example;

use crate::logs::Failed;
use crate::output::files;
use rayon::prelude::*;
use rundown::estimator::config::Mode;
use rundown::{
    Real, features::FeatureConfig, filter::gaussian::Gaussian, model::resistance::Davis, model::state,
    model::train::Train, tick::estimate::Estimate, tick::measurement::Measurement, tick::regime::Regime,
};
use rundown_files::{WriteError, replay::ReplayedRun};
use rundown_pages::assets::SCRIPT;
use rundown_pages::chart::Drawing;
use rundown_pages::run_pages;
use std::ops::{Deref, Range};
use std::path::Path;

#[derive(Clone, Debug)]
pub(crate) struct Report<'a> {
    pub title: String,
    pub train: &'a Train,
    pub runs: Vec<RunView<'a>>,
    /// How many runs come before these, and the names of the runs before and after them: pages of very many runs are
    /// written in parts.
    pub first: usize,
    pub before: Option<String>,
    pub after: Option<String>,
    /// The runs of the table have pages.
    pub has_run_pages: bool,
    pub mode: Mode,
    /// Windows and steps of the features, for their labels.
    pub features: FeatureConfig,
    /// Each unit with what is learned of it, in the order of their first runs.
    pub vehicles: Vec<Vehicle>,
    /// What a person should know about all runs, and the logs that are none of them.
    pub notes: &'a [String],
    pub failed: &'a [Failed],
}

/// A unit, and its Davis coefficients after each of its runs.
#[derive(Clone, Debug, Default)]
pub(crate) struct Vehicle {
    /// Empty: not known.
    pub unit: String,
    /// Name of the run, and what is believed after it.
    pub after: Vec<(String, Gaussian<3>)>,
}

impl Vehicle {
    /// Of runs in their order.
    pub fn of_runs(runs: &[ReplayedRun]) -> Vec<Self> {
        let mut vehicles: Vec<Self> = Vec::new();
        for run in runs {
            let after = (run.name.clone(), run.vehicle_after);
            match vehicles.iter_mut().find(|vehicle| vehicle.unit == run.unit) {
                Some(vehicle) => vehicle.after.push(after),
                None => vehicles.push(Self { unit: run.unit.clone(), after: vec![after] }),
            }
        }
        vehicles
    }

    /// What is believed after its last run.
    pub fn last(&self) -> Option<&Gaussian<3>> {
        self.after.last().map(|(_, belief)| belief)
    }

    /// As a person calls it.
    pub fn name(&self) -> String {
        if self.unit.is_empty() { "the unit without a name".to_owned() } else { format!("unit {}", self.unit) }
    }
}

/// A replayed run, and what was true of a simulated one.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RunView<'a> {
    run: &'a ReplayedRun,
    truth: Option<&'a TruthView>,
}

impl Deref for RunView<'_> {
    type Target = ReplayedRun;

    fn deref(&self) -> &ReplayedRun {
        self.run
    }
}

impl<'a> RunView<'a> {
    pub const fn of(run: &'a ReplayedRun, truth: Option<&'a TruthView>) -> Self {
        Self { run, truth }
    }
}

/// What was true of a run, a value for each estimate; drawn where it has as many.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct TruthView {
    pub davis: Davis,
    /// Mean effort since the sample before, N/kg.
    pub effort_n_per_kg: Vec<Real>,
    pub resistance_n_per_kg: Vec<Real>,
    /// Location in m and speed in m/s where the final coast and the final brake began.
    pub starts: Vec<(Real, Real)>,
}

/// Writes `report.html` and, unless they are not wanted, the pages of the runs into a folder.
pub(crate) fn write_report(folder: &Path, report: &Report) -> Result<(), WriteError> {
    files::text(&folder.join("report.html"), &page::html(report))?;
    if !report.has_run_pages {
        return Ok(());
    }
    begin_run_pages(folder)?;
    write_run_pages(folder, report)
}

/// Makes the folder of the pages of runs within a folder, with the script that they share.
pub(crate) fn begin_run_pages(folder: &Path) -> Result<(), WriteError> {
    let pages = folder.join(run_pages::FOLDER);
    files::folder(&pages)?;
    files::text(&pages.join(run_pages::SCRIPT_FILE), SCRIPT)
}

/// Writes the pages of the runs of this report into the folder that was made for them.
pub(crate) fn write_run_pages(folder: &Path, report: &Report) -> Result<(), WriteError> {
    let file = |at: usize| folder.join(run_pages::file(report.first + at));
    let write = |at: usize| files::text(&file(at), &page::run_html(at, report));
    (0..report.runs.len()).into_par_iter().try_for_each(write)
}

impl Report<'_> {
    fn learned(&self) -> Learned {
        self.runs.iter().map(RunView::learned).fold(Learned::default(), |all, run| all.and(&run))
    }

    pub(crate) fn shown_kmh(&self) -> Real {
        shown_kmh(self.learned().speeds_mps.map(|speeds| speeds.end))
    }

    /// r(v) of a vehicle after its last run, as the page has it.
    pub(crate) fn resistance_curve(&self, vehicle: Option<&Vehicle>) -> Drawing {
        let its =
            |run: &&RunView<'_>| vehicle.is_none_or(|vehicle| run.unit == vehicle.unit) || self.vehicles.len() == 1;
        let learned = self.runs.iter().filter(its).map(RunView::learned);
        let learned = learned.fold(Learned::default(), |all, run| all.and(&run));
        figures::resistance_curve(vehicle.and_then(Vehicle::last), self.train, learned.speeds_mps)
    }
}

impl RunView<'_> {
    /// The confirmed regime of an estimate; its first one where no other is known.
    fn regime(&self, index: usize) -> Regime {
        let first = || self.estimates.get(index).map(|estimate| estimate.regime);
        self.regimes.get(index).copied().or_else(first).unwrap_or_default()
    }

    fn truth(&self) -> Option<&TruthView> {
        let count = self.estimates.len();
        self.truth
            .filter(|truth| truth.effort_n_per_kg.len() == count)
            .filter(|truth| truth.resistance_n_per_kg.len() == count)
    }

    fn measurement(&self, index: usize) -> Option<&Measurement> {
        let time_s = self.estimates.get(index)?.time_s;
        let same = |measurement: &&Measurement| measurement.time_s == time_s;
        self.measurements.get(index).filter(same)
    }

    fn duration_s(&self) -> Real {
        let times_s = || self.estimates.iter().map(|e| e.time_s).filter(|t| t.is_finite());
        let ends = times_s().next().zip(times_s().next_back());
        ends.map_or(0.0, |(first, last)| last - first)
    }

    fn distance_m(&self) -> Real {
        let location_m = |estimate: &Estimate| estimate.belief.mean[state::LOCATION];
        let locations_m = || self.estimates.iter().map(location_m).filter(|s| s.is_finite());
        let ends = locations_m().next().zip(locations_m().next_back());
        ends.map_or(0.0, |(first, last)| (last - first).abs())
    }

    fn learned(&self) -> Learned {
        let mut learned = Learned::default();
        for estimate in self.estimates.iter().filter(|estimate| estimate.learning) {
            let speed_mps = estimate.belief.mean[state::SPEED];
            if !(speed_mps.is_finite() && estimate.dt_s.is_finite()) {
                continue;
            }
            let one = Learned {
                samples: 1,
                time_s: estimate.dt_s,
                distance_m: speed_mps * estimate.dt_s,
                speeds_mps: Some(speed_mps..speed_mps),
            };
            learned = learned.and(&one);
        }
        learned
    }
}

/// What of some runs taught the resistance.
#[derive(Clone, Debug, Default, PartialEq)]
struct Learned {
    samples: usize,
    time_s: Real,
    distance_m: Real,
    speeds_mps: Option<Range<Real>>,
}

impl Learned {
    fn and(&self, other: &Self) -> Self {
        let all = self.speeds_mps.iter().chain(&other.speeds_mps).cloned();
        Self {
            samples: self.samples + other.samples,
            time_s: self.time_s + other.time_s,
            distance_m: self.distance_m + other.distance_m,
            speeds_mps: all.reduce(|a, b| a.start.min(b.start)..a.end.max(b.end)),
        }
    }
}

/// Speed at which r(v) is shown, km/h: 100, or the fastest that taught where trains never get there, in whole tens.
/// Beyond what taught it r is the description's as much as the runs', and its interval knows only descriptions that are
/// about right.
pub(crate) fn shown_kmh(fastest_mps: Option<Real>) -> Real {
    const USUAL_KMH: Real = 100.0;
    let fastest_kmh = fastest_mps.map_or(USUAL_KMH, |fastest| 3.6 * fastest);
    (10.0 * (fastest_kmh / 10.0).floor()).clamp(10.0, USUAL_KMH)
}

/// The slowest and the fastest speed that taught the resistance in these runs, m/s.
pub(crate) fn taught_mps(runs: &[ReplayedRun]) -> Option<Range<Real>> {
    let learned = runs.iter().map(|run| RunView::of(run, None).learned());
    learned.fold(Learned::default(), |all, run| all.and(&run)).speeds_mps
}

/// Share of the time in each regime, indexed by `Regime as usize`; none when no time went by.
pub(crate) fn regime_shares(run: &ReplayedRun) -> Option<[Real; 5]> {
    let times_s = run.summary.features.regime_time_s;
    let total_s: Real = times_s.iter().sum();
    (total_s > 0.0 && total_s.is_finite()).then(|| times_s.map(|time_s| time_s / total_s))
}

#[cfg(test)]
mod tests {
    use super::example::{self, report, train};
    use super::*;

    #[test]
    fn the_page_is_written() {
        let folder = std::env::temp_dir().join(format!("rundown-report-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        write_report(&folder, &report(&[example::run()], &train())).unwrap();
        let read = |name: &str| std::fs::read_to_string(folder.join(name)).unwrap();
        let (first, of_run, script) = (read("report.html"), read("report/run0001.html"), read("report/pages.js"));
        std::fs::remove_dir_all(&folder).unwrap();
        assert!(first.starts_with("<!DOCTYPE html>") && first.contains("href=\"report/run0001.html\""));
        assert!(of_run.contains("<script src=\"pages.js\">") && of_run.contains("href=\"../report.html#runs\""));
        assert_eq!(script, SCRIPT);
        assert!(write_report(Path::new("/no/such/folder"), &report(&[], &train())).is_err());
    }

    #[test]
    fn learned_is_time_distance_and_range_of_speeds() {
        let example = example::run();
        let learned = RunView::of(&example, None).learned();
        // Most of the 47 samples of coasting from 36 to 20 m/s, at 10 s.
        assert!((30..47).contains(&learned.samples), "{learned:?}");
        assert!((learned.time_s - 10.0 * learned.samples as Real).abs() < 1e-9);
        let speeds_mps = learned.speeds_mps.clone().unwrap();
        assert!(speeds_mps.start > 15.0 && speeds_mps.end < 37.0, "{learned:?}");
        let mean_mps = 0.5 * (speeds_mps.start + speeds_mps.end);
        assert!((learned.distance_m / learned.time_s / mean_mps - 1.0).abs() < 0.1, "{learned:?}");
        assert_eq!(Learned::default().and(&learned), learned);
    }
}
