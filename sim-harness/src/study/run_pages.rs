//! A page for each run of a study that its page lists, as the gated mode saw it, with the truth where it is known.
//! Written chunk by chunk: what is drawn of a run is forgotten with its chunk, but for the last run of a chunk: its
//! page links to the first run of the next one.

use super::figures::run::truth_view;
use super::gather::{LISTED, LookedAt};
use crate::report::{Report, RunView, TruthView, begin_run_pages, write_run_pages};
use rundown::estimator::Estimator;
use rundown::estimator::config::Mode;
use rundown::{features::FeatureConfig, model::train::Train};
use rundown_files::{WriteError, replay::ReplayedRun};
use std::path::PathBuf;

/// The pages so far.
#[derive(Debug)]
pub struct RunPages {
    folder: PathBuf,
    title: String,
    train: Train,
    features: FeatureConfig,
    mode: Mode,
    written: usize,
    /// Name of the last run that has a page.
    last: Option<String>,
    /// The run after it, whose page waits for the name of the next one.
    held: Option<Shown>,
}

/// What a page shows.
type Shown = (ReplayedRun, Option<TruthView>);

impl RunPages {
    /// Makes the folder of the pages within the folder of the results.
    pub fn begin(folder: PathBuf, title: String, estimator: &Estimator) -> Result<Self, WriteError> {
        begin_run_pages(&folder)?;
        let (train, config) = (*estimator.train(), estimator.config());
        let (features, mode) = (config.features, config.mode);
        Ok(Self { folder, title, train, features, mode, written: 0, last: None, held: None })
    }

    /// Writes those of a chunk, as far as they are listed, but for the last.
    pub fn add(&mut self, chunk: &[LookedAt]) -> Result<(), WriteError> {
        let held = self.held.take();
        let room = LISTED - self.written - usize::from(held.is_some());
        let shown = |one: &LookedAt| (one.gated().clone(), one.truth().map(truth_view));
        let mut runs: Vec<Shown> = held.into_iter().chain(chunk.iter().take(room).map(shown)).collect();
        self.held = runs.pop();
        let after = self.held.as_ref().map(|(run, _)| run.name.clone());
        self.write(&runs, after)
    }

    /// Writes the last one.
    pub fn end(mut self) -> Result<(), WriteError> {
        let last: Vec<Shown> = self.held.take().into_iter().collect();
        self.write(&last, None)
    }

    fn write(&mut self, runs: &[Shown], after: Option<String>) -> Result<(), WriteError> {
        let report = Report {
            title: self.title.clone(),
            train: &self.train,
            runs: runs.iter().map(|(run, truth)| RunView::of(run, truth.as_ref())).collect(),
            first: self.written,
            before: self.last.take(),
            after,
            has_run_pages: true,
            mode: self.mode,
            features: self.features,
            vehicles: Vec::new(),
            notes: &[],
            failed: &[],
        };
        write_run_pages(&self.folder, &report)?;
        self.written += runs.len();
        self.last = runs.last().map(|(run, _)| run.name.clone()).or(report.before);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::case::case_study;
    use crate::study::gather::{Estimators, gather};
    use crate::study::{description, source::RunSource};
    use rundown::estimator::config::Config;

    #[test]
    fn a_page_links_to_the_runs_beside_it_over_the_ends_of_chunks() {
        let folder = tempfile::tempdir().unwrap();
        let simulation = case_study().unwrap();
        let described = description::of(&simulation).unwrap();
        let estimators = Estimators::try_new(Config::default(), described.train, &described.track).unwrap();
        let mut source = RunSource::simulated(simulation, 4, 4, false);
        let mut pages = RunPages::begin(folder.path().to_owned(), "title".to_owned(), &estimators.gated).unwrap();
        let mut sink = |rows: &crate::study::gather::Rows| {
            let (first, rest) = rows.used.split_at(1);
            [first, rest, &[]].into_iter().try_for_each(|chunk| pages.add(chunk)).unwrap();
            Ok(())
        };
        gather(&mut source, &estimators, None, &mut sink, |_| ()).unwrap();
        pages.end().unwrap();
        let page = |number: usize| std::fs::read_to_string(folder.path().join(format!("report/run000{number}.html")));
        for number in 1..=4 {
            let page = page(number).unwrap();
            let link = |word: &str, to: usize| page.contains(&format!("href=\"run000{to}.html\">{word}: "));
            assert_eq!(link("before", number.wrapping_sub(1)), number > 1, "{number}");
            assert_eq!(link("next", number + 1), number < 4, "{number}");
        }
        assert!(page(5).is_err());
    }
}
