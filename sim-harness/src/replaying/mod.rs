//! `replay`: recorded runs, a train and a track in; what the board would have learned out. The command and the Python
//! module do this.
//!
//! ```text
//! Request -> open -> Opened -> replay -> Replayed -> tables, replay.json, report.html
//!                           -> stream -> tables of a row a run, replay.json
//! ```

mod doubted;
mod source;
mod stream;

pub use source::Runs;
pub use stream::{CHUNK, StreamError};

use crate::advice::{Advice, before_brakes::BeforeBrakes, coasts, coasts::ByFilters, left_open::LeftOpen};
use crate::learned_train::Results;
use crate::logs::{self, Failed};
use crate::output::json;
use crate::report::{Report, RunView, Vehicle, figures, write_report};
use crate::{output::tables::Tables, output::write_tables};
use rundown::estimator::config::{Config, Mode};
use rundown::tick::{bounds::ConfigError, sensor::Rounding};
use rundown::{
    estimator::Estimator,
    model::effects::{Effect, EffectError},
    model::track::TrackError,
    model::train::Train,
};
use rundown_check::Known;
use rundown_check::gradients::{Doubt, SmallErrors};
use rundown_check::limits::Described;
use rundown_check::rows::same::Seen;
use rundown_files::folder::{self, Provenance};
use rundown_files::off_track::{BEYOND_M, OffTrack};
use rundown_files::parquet::ParquetError;
use rundown_files::recording::{DirectionChoice, Recording};
use rundown_files::refusal::ReadError;
use rundown_files::replay::{ReplayedRun, Tick, replay_apart_by, replay_carried_by};
use rundown_files::track_file::TrackFile;
use rundown_files::{WriteError, config_file, effect_file};
use rundown_files::{map_matching::CentreLine, run_log::BadRows, train_file::TrainFile};
use serde_json::Value;
use source::Source;
use std::collections::{HashMap, HashSet};
use std::fmt;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// What is expected of a [`Tick::Period`].
pub const PERIOD: &str = "expected a number of seconds above 0, at most 600";

/// Whether a [`Tick::Period`] may have this length: after a longer pause the estimator restarts.
pub fn is_period(seconds: f64) -> bool {
    seconds > 0.0 && seconds <= 600.0
}

/// What is to be replayed.
#[derive(Clone, Debug)]
pub struct Request {
    /// The runs.
    pub runs: Runs,
    /// Description of the train.
    pub train: PathBuf,
    /// Description of the track.
    pub track: PathBuf,
    /// Configuration; none is every default.
    pub config: Option<PathBuf>,
    /// Replaces the mode of the configuration.
    pub mode: Option<Mode>,
    /// Which rows are steps.
    pub tick: Tick,
    /// Direction of the runs that no index names.
    pub direction: DirectionChoice,
    /// A unit's vehicle is carried from run to run.
    pub carried: bool,
    /// What a diagnosis of the logs would put right is left as it is.
    pub as_recorded: bool,
    /// What is done about rows that cannot be read.
    pub bad_rows: BadRows,
    /// Which tables are written.
    pub tables: Tables,
    /// The report has a page for each run, 0.24 MB each.
    pub run_pages: bool,
    /// Nothing is written by [`Opened::stream`] where anything is to be warned of.
    pub strict: bool,
}

/// Why nothing was replayed.
#[derive(Debug, Error)]
#[error(transparent)]
#[non_exhaustive]
#[expect(missing_docs, reason = "said by the messages")]
pub enum ReplayError {
    Read(#[from] ReadError),
    Config(#[from] ConfigError),
    Effect(#[from] EffectError),
    Track(#[from] TrackError),
    Parquet(#[from] ParquetError),
}

/// Descriptions that were read, and the logs to be read.
pub struct Opened {
    request: Request,
    config: Config,
    train: TrainFile,
    core_train: Train,
    track: TrackFile,
    /// With the effects that act in all runs.
    estimator: Estimator,
    source: Source,
    /// Onto which positions are matched.
    line: Option<CentreLine>,
    /// Logs that were read.
    seen: Seen,
    /// Names of the runs that were read, also of those that cannot be used.
    named: HashSet<String>,
    /// What of the readings and of the line is not put right.
    left_open: LeftOpen,
    provenance: Provenance,
}

impl fmt::Debug for Opened {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Opened").field("request", &self.request).finish_non_exhaustive()
    }
}

/// Runs as replayed, and what is to be said about them.
#[derive(Clone, Debug)]
pub struct Replayed {
    /// The estimator's configuration.
    pub config: Config,
    /// The train as described.
    pub train: TrainFile,
    /// The same as the estimator takes it.
    pub core_train: Train,
    /// The track as described.
    pub track: TrackFile,
    /// The runs in their order.
    pub runs: Vec<ReplayedRun>,
    /// Logs that could not be used.
    pub failed: Vec<Failed>,
    /// What a person should know about all of them.
    pub notes: Vec<String>,
    /// The described gradients look wrong.
    pub gradient_doubt: Option<Doubt>,
    /// They are off by little, as the coasts say and the track does not.
    pub small_errors: Option<SmallErrors>,
    provenance: Provenance,
    carried: bool,
    tick: Tick,
    tables: Tables,
    run_pages: bool,
}

/// What came of runs that are not kept.
#[derive(Clone, Debug, Default)]
pub struct Summary {
    /// How many were replayed.
    pub runs: usize,
    /// Of these, those from which nothing went into the vehicle.
    pub unused: usize,
    /// Anything was learned from any of them.
    pub learned: bool,
    /// How many warnings they have.
    pub warnings: usize,
    /// Logs that could not be used.
    pub failed: Vec<Failed>,
    /// What a person should know about all of them.
    pub notes: Vec<String>,
    /// The described gradients look wrong.
    pub gradient_doubt: Option<Doubt>,
    /// They are off by little, as the coasts say and the track does not.
    pub small_errors: Option<SmallErrors>,
}

impl Request {
    /// Runs with a train and a track, everything else as `rundown replay` has it by default; where rows cannot be read,
    /// the log is refused.
    pub fn new(runs: Vec<PathBuf>, train: PathBuf, track: PathBuf) -> Self {
        Self {
            runs: Runs::Paths(runs),
            train,
            track,
            config: None,
            mode: None,
            tick: Tick::EverySample,
            direction: DirectionChoice::default(),
            carried: true,
            as_recorded: false,
            bad_rows: BadRows::Refuse,
            tables: Tables::default(),
            run_pages: true,
            strict: false,
        }
    }

    /// Reads the descriptions, and finds the logs.
    ///
    /// # Errors
    /// [`ReplayError`] names the file and the place in it.
    pub fn open(mut self) -> Result<Opened, ReplayError> {
        let (train, core_train) = TrainFile::read(&self.train)?;
        let (track, mut core_track) = TrackFile::read(&self.track)?;
        if !self.tables.each_tick {
            // What coasting leads to is not written: it need not be foreseen.
            core_track = core_track.with_targets([])?;
        }
        let mut config = self.config.as_deref().map_or_else(|| Ok(Config::default()), config_file::read)?;
        config.mode = self.mode.unwrap_or(config.mode);
        let effects = effect_file::effects(&track.effect, &train.effect, None)?;
        let config = track.doubted(config);
        let estimator = Estimator::try_new(config, core_train, core_track)?.with_effects(effects);
        let line = CentreLine::new(&track.centre_line);
        // A table is moved: it may be large.
        let runs = std::mem::replace(&mut self.runs, Runs::Paths(Vec::new()));
        let source = Source::open(runs, line.as_ref())?;
        let described = [Some(&self.train), Some(&self.track), self.config.as_ref()];
        let inputs = described.into_iter().flatten().cloned().chain(source.paths());
        let provenance = Provenance::begin(&inputs.collect::<Vec<PathBuf>>());
        let seen = Seen::default();
        let named = HashSet::new();
        let left_open = LeftOpen::default();
        Ok(Opened {
            request: self,
            config,
            train,
            core_train,
            track,
            estimator,
            source,
            line,
            seen,
            named,
            left_open,
            provenance,
        })
    }
}

impl Opened {
    /// The estimator's configuration.
    pub fn config(&self) -> &Config {
        &self.config
    }

    /// How many logs there are.
    pub fn runs(&self) -> usize {
        self.source.runs()
    }

    /// Reads and replays the logs; `done` is called once for each that is replayed.
    ///
    /// # Errors
    /// [`ReplayError`]: effects that act in some runs cannot act together.
    pub fn replay(mut self, done: impl Fn() + Sync) -> Result<Replayed, ReplayError> {
        let mut summary = Summary { notes: self.first_notes(), ..Summary::default() };
        let mut read = Vec::new();
        while let Some(chunk) = self.next_chunk(usize::MAX)? {
            read.extend(chunk);
        }
        let mut recordings = self.diagnosed(read, &mut summary)?;
        source::tell_apart(&mut recordings);
        self.named.extend(recordings.iter().map(|recording| recording.name.clone()));
        summary.notes.extend(self.of_no_run());
        let mut off = self.off_track();
        self.leave_out_beyond(&mut off, &mut recordings);
        summary.first(&off);
        self.doubt_descriptions(&recordings, &mut summary)?;
        let own = self.own_estimators(&recordings)?;
        let model = |recording: &Recording| own.get(&recording.name).unwrap_or(&self.estimator);
        let (carried, tick) = (self.request.carried, self.request.tick);
        let mut runs = if carried {
            replay_carried_by(&model, &recordings, tick, done)
        } else {
            replay_apart_by(&model, &recordings, tick, done)
        };
        let (mut before_brakes, mut advice) = (BeforeBrakes::default(), Advice::default());
        self.judge(&recordings, &own, &mut runs, (&mut before_brakes, &mut advice));
        summary.notes.extend(advice.notes(&self.estimator, summary.says_gradients()));
        summary.notes.extend(before_brakes.notes());
        let Summary { failed, notes, gradient_doubt, small_errors, .. } = summary;
        let Request { tables, run_pages, .. } = self.request;
        let Self { config, train, core_train, track, provenance, .. } = self;
        Ok(Replayed {
            config,
            train,
            core_train,
            track,
            runs,
            failed,
            notes,
            gradient_doubt,
            small_errors,
            provenance,
            carried,
            tick,
            tables,
            run_pages,
        })
    }

    /// Judges what runs have taught, and withholds what is not to be published.
    fn judge(
        &self,
        recordings: &[Recording],
        own: &HashMap<String, Estimator>,
        runs: &mut [ReplayedRun],
        (before_brakes, advice): (&mut BeforeBrakes, &mut Advice),
    ) {
        let by_filters: Vec<ByFilters> = runs.iter().map(ByFilters::of).collect();
        before_brakes.judge(&self.estimator, self.request.carried, |name| own.contains_key(name), runs);
        self.left_open.doubt(&self.estimator, runs);
        let gated = self.beside_efforts(own);
        let scatter = gated.map(|gated| advice.foresee(&gated, recordings, self.request.tick, runs));
        advice.add(runs);
        advice.withhold(runs);
        // Last: efforts and coasts are compared by what each of them taught.
        for ((run, by_filters), times) in runs.iter_mut().zip(by_filters).zip(scatter.into_iter().flatten()) {
            by_filters.widen(&self.estimator, times, run);
        }
    }

    /// Counts what was beyond the line, and leaves it out but for replays as recorded.
    fn leave_out_beyond(&self, off: &mut OffTrack, recordings: &mut [Recording]) {
        for recording in recordings {
            off.add(&recording.rows);
            if !self.request.as_recorded {
                off.leave_out(&mut recording.rows);
            }
        }
    }

    /// What coasts are asked beside efforts that teach: where the same effects act in all runs.
    fn beside_efforts(&self, own: &HashMap<String, Estimator>) -> Option<Estimator> {
        let is_measured = self.config.mode == Mode::Measured && self.request.carried && own.is_empty();
        is_measured.then(|| coasts::gated(&self.estimator)).flatten()
    }

    /// What is to be said before any log is read.
    fn first_notes(&self) -> Vec<String> {
        self.source.notes().iter().cloned().chain(self.track.beyond_the_line()).collect()
    }

    /// Effects of runs that none of the logs is; call it once all are read.
    fn of_no_run(&self) -> Vec<String> {
        effect_file::of_no_run(&self.train.effect, &self.track.effect, |name| self.named.contains(name))
    }

    /// Of no location yet.
    fn off_track(&self) -> OffTrack {
        OffTrack::new(&self.track, BEYOND_M)
    }

    fn next_chunk(&mut self, most: usize) -> Result<Option<Vec<Result<Recording, Failed>>>, ReplayError> {
        self.source.next_chunk(most, self.request.bad_rows, self.line.as_ref(), self.request.direction)
    }

    /// The recordings that can be used; why others cannot, and what is to be said, goes into `summary`.
    fn diagnosed(
        &mut self,
        read: Vec<Result<Recording, Failed>>,
        summary: &mut Summary,
    ) -> Result<Vec<Recording>, ReplayError> {
        let mut recordings = Vec::new();
        for result in read {
            match result {
                Ok(recording) => {
                    self.named.insert(recording.name.clone());
                    recordings.push(recording);
                }
                Err(failure) => {
                    self.named.extend(failure.file.file_stem().map(|name| name.to_string_lossy().into_owned()));
                    summary.failed.push(failure);
                }
            }
        }
        if self.request.as_recorded {
            return Ok(recordings);
        }
        // A wheel of some runs counts, too: it must not be put right twice.
        let mut effects = self.train.effect.iter().chain(&self.track.effect);
        let known = Known {
            truncates: self.config.sensor.rounding == Rounding::Truncated,
            scale: effects.any(|entry| matches!(entry.effect, Effect::SpeedScale(_))),
            stops_m: self.track.stops_m(),
            limits: Described::of(Some(self.core_train), Some(&self.track)),
            track: Some(self.estimator.track().clone()),
            moves_locations: true,
        };
        let (used, refused, found) = logs::diagnosed(recordings, &known, &mut self.seen);
        summary.failed.extend(refused);
        summary.notes.extend(found.notes());
        found.recorders.iter().for_each(|recorder| self.left_open.add(recorder, self.config.mode));
        summary
            .notes
            .extend(found.perturbed_note().map(|note| format!("{note}; they were learned from as the others")));
        if summary.runs == 0 {
            summary.notes.extend(self.doubt_speeds(&found)?);
            summary.notes.extend(self.doubt_efforts(&found)?);
        }
        Ok(used)
    }

    fn head(&self) -> json::Head<'_> {
        json::Head {
            config: &self.config,
            train: &self.train,
            track: &self.track.name,
            carried: self.request.carried,
            tick: self.request.tick,
            tables: self.request.tables,
        }
    }

    /// The estimators of the runs in which not the same effects act as in all.
    fn own_estimators(&self, recordings: &[Recording]) -> Result<HashMap<String, Estimator>, EffectError> {
        let mut own = HashMap::new();
        for recording in recordings {
            let effects = effect_file::effects(&self.track.effect, &self.train.effect, Some(&recording.name))?;
            if effects != *self.estimator.effects() {
                own.insert(recording.name.clone(), self.estimator.clone().with_effects(effects));
            }
        }
        Ok(own)
    }
}

impl Summary {
    /// How many warnings, notes and refused logs there are.
    pub fn said(&self) -> usize {
        self.warnings + self.notes.len() + self.failed.len()
    }

    /// Why there is nothing to be written, where no run could be used.
    pub fn nothing(&self) -> String {
        nothing(&self.failed)
    }

    /// It is said why gradients are doubted.
    fn says_gradients(&self) -> bool {
        self.gradient_doubt.is_some() || self.small_errors.is_some()
    }
}

fn learned(run: &ReplayedRun, mode: Mode) -> bool {
    run.is_used && (mode == Mode::Paper || run.summary.learned_s > 0.0)
}

fn nothing(failed: &[Failed]) -> String {
    match failed.len() {
        0 => "expected at least one run log, found none; nothing was written".to_owned(),
        failed => format!("none of {failed} run logs could be used; nothing was written"),
    }
}

impl Replayed {
    /// Anything was learned. The paper's mode learns from each step.
    pub fn learned(&self) -> bool {
        self.runs.iter().any(|run| learned(run, self.config.mode))
    }

    /// Why there is nothing to be written: no run could be used.
    pub fn nothing(&self) -> Option<String> {
        self.runs.is_empty().then(|| nothing(&self.failed))
    }

    /// `replay.json`.
    pub fn json(&self) -> Value {
        let head = json::Head {
            config: &self.config,
            train: &self.train,
            track: &self.track.name,
            carried: self.carried,
            tick: self.tick,
            tables: self.tables,
        };
        let end = json::End {
            failed: &self.failed,
            notes: &self.notes,
            gradient_doubt: self.gradient_doubt.as_ref(),
            gradient_sd_permille: self.config.track_doubt.gradient_sd_permille,
        };
        json::value(&head, &self.runs, &end)
    }

    /// Writes the tables and the report into a folder, which is made when it does not exist. Out: `replay.json`.
    ///
    /// # Errors
    /// [`WriteError`] names the file.
    pub fn write(&self, folder: &Path) -> Result<Value, WriteError> {
        let json = self.json();
        folder::write("replay", folder, &self.provenance, |folder| {
            write_tables(folder, &self.runs, &self.config, self.tables.format, &json)?;
            write_report(folder, &self.report())
        })?;
        Ok(json)
    }

    /// For an export.
    pub fn results(&self) -> Results {
        // The text, not its value: a number that is read again may differ in the last bit, and is to be that of the
        // file.
        let json = format!("{:#}\n", self.json());
        Results::Replayed { json, train: Box::new(self.train.clone()), provenance: self.provenance.clone() }
    }

    /// Names of the pictures that [`Replayed::picture`] knows; all but the first two are of a run.
    pub const PICTURES: [&str; 6] = ["resistance", "history", "motion", "terms", "regimes", "innovations"];

    /// A picture of the report as SVG, of the run at `index` or of the unit that made it; none where there is no such
    /// picture or run.
    pub fn picture(&self, name: &str, index: usize) -> Option<String> {
        let report = self.report();
        let run = report.runs.get(index)?;
        let vehicle = report.vehicles.iter().find(|vehicle| vehicle.unit == run.unit)?;
        let drawing = match name {
            "resistance" => report.resistance_curve(Some(vehicle)),
            "history" => figures::vehicle_history(&vehicle.after, &self.core_train, report.shown_kmh()),
            "motion" => figures::motion(run, &self.core_train),
            "terms" => figures::resistance_terms(run),
            "regimes" => figures::regimes(run),
            "innovations" => figures::innovations(run),
            _ => return None,
        };
        Some(drawing.to_svg())
    }

    fn report(&self) -> Report<'_> {
        Report {
            title: format!("{} on {}", self.train.name, self.track.name),
            train: &self.core_train,
            runs: self.runs.iter().map(|run| RunView::of(run, None)).collect(),
            first: 0,
            before: None,
            after: None,
            has_run_pages: self.run_pages,
            mode: self.config.mode,
            features: self.config.features,
            vehicles: Vehicle::of_runs(&self.runs),
            notes: &self.notes,
            failed: &self.failed,
        }
    }
}
