//! What the workflow reads: the believed train and track, and the runs.

use crate::data::load::Loaded;
use crate::data::{believed::Surroundings, load, runs::Run};
use crate::refusal::Refusal;
use rundown::estimator::config::Config;
use rundown::model::{track::Track, train::Train};
use rundown_check::{
    Check,
    gradients::{Coasts, Doubt, SmallErrors},
};
use rundown_files::folder::Provenance;
use rundown_files::map_matching::CentreLine;
use rundown_files::recording::{DirectionChoice, Recording};
use rundown_files::run_rows::{self, RunTable};
use rundown_files::{effect_file, run_set::RunSet, track_file::TrackFile, train_file::TrainFile};
use std::path::{Path, PathBuf};

/// The believed train and track, and the runs that they are compared with.
#[derive(Clone, Debug)]
pub struct Input {
    /// The train as described.
    pub train_file: TrainFile,
    /// The same as the board takes it.
    pub train: Train,
    /// The track as described.
    pub track_file: TrackFile,
    /// The same as the board takes it.
    pub track: Track,
    /// What else is known of the line.
    pub surroundings: Surroundings,
    /// The runs.
    pub runs: Vec<Run>,
    /// The same as an estimator replays them: put right but for the scale of the speed, which it has as an effect.
    pub recordings: Vec<Recording>,
    /// What their recorders did to them; none where they were taken as recorded.
    pub check: Option<Check>,
    /// Where the runs come from.
    pub dataset: String,
    /// What coasts say of the described gradients; none where nothing is wrong, or nothing shows.
    pub gradient_doubt: Option<Doubt>,
    /// By how much these gradients, or an effect at places, are off where coasts of different runs agree. The workflow
    /// does not doubt the track by it.
    pub small_errors: Option<SmallErrors>,
    /// When the work began, and the files that are read.
    pub provenance: Provenance,
    /// How many logs could not be used.
    pub left_out: usize,
    /// Of the first of them why.
    pub first_left_out: Option<String>,
    /// What was said while they were read.
    pub notes: Vec<String>,
}

/// Train and track.
struct Described {
    files: [PathBuf; 2],
    train_file: TrainFile,
    train: Train,
    track_file: TrackFile,
    track: Track,
}

impl Described {
    fn read(train: &Path, track: &Path) -> Result<Self, Refusal> {
        let files = [train, track].map(Path::to_owned);
        let (train_file, train) = TrainFile::read(train).map_err(Refusal::unread)?;
        let (track_file, track) = TrackFile::read(track).map_err(Refusal::unread)?;
        Ok(Self { files, train_file, train, track_file, track })
    }

    /// `names`: of the runs that were to be read.
    fn with(self, loaded: Loaded, names: &[String], dataset: String, provenance: Provenance) -> Input {
        let Self { train_file, train, track_file, track, .. } = self;
        let Loaded { runs, recordings, check, notes, first_left_out } = loaded;
        let mut coasts = Coasts::default();
        coasts.add(&recordings, &train);
        let said = coasts.answer(&train, &track, track_file.said_sd_permille(&Config::default()));
        let doubt = said.gradients.map(|doubt| format!("{doubt}; the gap is then theirs"));
        let units = said.resistance.map(|units| format!("{units}; the gap is then its"));
        let is_read = |name: &str| names.iter().any(|one| one == name);
        let of_no_run = effect_file::of_no_run(&train_file.effect, &track_file.effect, is_read);
        Input {
            train,
            train_file,
            surroundings: load::surroundings(&track_file),
            track_file,
            track,
            left_out: names.len() - runs.len(),
            first_left_out,
            runs,
            recordings,
            check,
            dataset,
            gradient_doubt: said.gradients,
            small_errors: said.small,
            provenance,
            notes: notes.into_iter().chain(of_no_run).chain(doubt).chain(units).collect(),
        }
    }
}

impl Input {
    /// Reads files: a train, a track, and folders of run logs or run logs. `direction`: of the runs that no index
    /// names. What the diagnosis of the logs finds is put right; with `as_recorded` it is not asked.
    ///
    /// # Errors
    /// [`Refusal`] names the file.
    pub fn read(
        train: &Path,
        track: &Path,
        runs: &[PathBuf],
        direction: DirectionChoice,
        as_recorded: bool,
    ) -> Result<Self, Refusal> {
        let described = Described::read(train, track)?;
        let set = RunSet::find(runs).map_err(Refusal::unread)?;
        let provenance = Provenance::begin(&[described.files.to_vec(), set.paths()].concat());
        let mut loaded = load::runs(&set, &described.train, &described.track_file, direction, as_recorded);
        loaded.notes.splice(0..0, set.notes.iter().cloned());
        let dataset: Vec<String> = runs.iter().map(|path| path.display().to_string()).collect();
        let names: Vec<String> = set.files.into_iter().map(|file| file.name).collect();
        Ok(described.with(loaded, &names, dataset.join(" "), provenance))
    }

    /// The same with tables of runs in memory, which say the directions themselves.
    ///
    /// # Errors
    /// [`Refusal`] names the file, or the column of a table.
    pub fn of_tables(train: &Path, track: &Path, tables: Vec<RunTable>, as_recorded: bool) -> Result<Self, Refusal> {
        let described = Described::read(train, track)?;
        let provenance = Provenance::begin(&described.files);
        let dataset: Vec<String> = tables.iter().map(|table| table.path.display().to_string()).collect();
        let line = CentreLine::new(&described.track_file.centre_line);
        let recordings = run_rows::recordings(tables, line.as_ref()).map_err(Refusal::unread)?;
        let names: Vec<String> = recordings.iter().map(|recording| recording.name.clone()).collect();
        let loaded = load::of_tables(recordings, &described.train, &described.track_file, as_recorded);
        Ok(described.with(loaded, &names, dataset.join(" "), provenance))
    }

    /// Reads a folder as `rundown simulate` writes it.
    ///
    /// # Errors
    /// [`Refusal`] names the file.
    pub fn of_set(folder: &Path) -> Result<Self, Refusal> {
        let runs = [folder.join("runs")];
        Self::read(&folder.join("train.toml"), &folder.join("track.toml"), &runs, DirectionChoice::Auto, false)
    }
}
