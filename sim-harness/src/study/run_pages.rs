//! A page for each run of a study that its page lists, as the gated mode saw it, with the truth where it is known. Written chunk by chunk: what is
//! drawn of a run is forgotten with its chunk.

use super::figures::run::truth_view;
use super::gather::{LISTED, LookedAt};
use crate::output::json::mode_word;
use crate::report::{Report, RunView, TruthView, begin_run_pages, write_run_pages};
use rundown::estimator::{Estimator, config::Mode};
use rundown::{features::FeatureConfig, model::train::Train};
use rundown_files::WriteError;
use std::path::PathBuf;

/// The pages so far.
#[derive(Debug)]
pub struct RunPages {
    folder: PathBuf,
    title: String,
    train: Train,
    features: FeatureConfig,
    written: usize,
    /// Name of the last one.
    last: Option<String>,
}

impl RunPages {
    /// Makes the folder of the pages within the folder of the results.
    pub fn begin(folder: PathBuf, title: String, estimator: &Estimator) -> Result<Self, WriteError> {
        begin_run_pages(&folder)?;
        let (train, features) = (*estimator.train(), estimator.config().features);
        Ok(Self { folder, title, train, features, written: 0, last: None })
    }

    /// Writes those of a chunk, as far as they are listed.
    pub fn add(&mut self, chunk: &[LookedAt]) -> Result<(), WriteError> {
        let listed = &chunk[..chunk.len().min(LISTED - self.written)];
        let truths: Vec<Option<TruthView>> = listed.iter().map(|one| one.truth().map(truth_view)).collect();
        let view = |(one, truth)| RunView::of(LookedAt::gated(one), Option::as_ref(truth));
        let report = Report {
            title: self.title.clone(),
            train: &self.train,
            runs: listed.iter().zip(&truths).map(view).collect(),
            first: self.written,
            before: self.last.take(),
            has_run_pages: true,
            mode: mode_word(Mode::Gated),
            features: self.features,
            vehicle: Vec::new(),
        };
        write_run_pages(&self.folder, &report)?;
        self.written += listed.len();
        self.last = listed.last().map(|one| LookedAt::gated(one).name.clone());
        Ok(())
    }
}
