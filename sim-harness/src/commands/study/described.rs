//! The case that is studied: train, track and where its runs come from.

use super::Arguments;
use crate::commands::Failure;
use crate::commands::recorded::OpenedCase;
use crate::simulation::scenario_file::Simulation;
use crate::study::source::RunSource;
use crate::study::{description, readings::comparison};
use rundown::{estimator::config::Config, model::track::Track, model::train::Train};
use rundown_check::gradients::SmallErrors;
use rundown_files::{track_file::TrackFile, train_file::TrainFile};
use std::path::PathBuf;

pub(super) struct DescribedCase {
    pub(super) train_name: String,
    pub(super) track_name: String,
    pub(super) train: Train,
    pub(super) track: Track,
    pub(super) source: RunSource,
    pub(super) words: String,
    /// Of simulated runs: what recorded ones bring with them.
    pub(super) files: Option<(TrainFile, TrackFile)>,
    /// Other sets on which the claims are judged, too.
    pub(super) others: Vec<RunSource>,
    /// The files that are read.
    pub(super) inputs: Vec<PathBuf>,
    /// Of the estimator, where the track has a doubt of its own.
    pub(super) config: Option<Config>,
    /// The gradients of recorded runs are off by little.
    pub(super) small_errors: Option<SmallErrors>,
}

pub(super) fn described(
    arguments: &Arguments,
    config: &Config,
    simulation: Simulation,
    as_recorded: bool,
) -> Result<DescribedCase, Failure> {
    let Some(opened) = arguments.recorded.open(config)? else {
        let seed = arguments.seed.unwrap_or(simulation.seed);
        let count = arguments.count.unwrap_or(simulation.runs);
        let seeds = usize::from(arguments.seeds.unwrap_or(1));
        return simulated(simulation, seed, count, seeds, as_recorded);
    };
    let OpenedCase { train_file, train, track_file, track, source, inputs, mut config, answer, .. } = opened;
    answer.raise(&mut config.track_doubt);
    Ok(DescribedCase {
        train_name: train_file.name,
        track_name: track_file.name,
        train,
        track,
        source,
        words: "read from files".to_owned(),
        files: None,
        inputs,
        config: Some(config),
        small_errors: answer.small,
        others: Vec::new(),
    })
}

pub(super) fn simulated(
    simulation: Simulation,
    seed: u64,
    count: usize,
    seeds: usize,
    as_recorded: bool,
) -> Result<DescribedCase, Failure> {
    let of_scenario = description::of(&simulation)?;
    let other = |index| RunSource::simulated(simulation.clone(), comparison::seed_of(seed, index), count, as_recorded);
    let words = match seeds {
        1 => format!("simulated with seed {seed}"),
        _ => format!("simulated with seed {seed}, claims also judged on {} other sets", seeds - 1),
    };
    Ok(DescribedCase {
        train_name: format!("{} (simulated)", simulation.train.name),
        track_name: simulation.track.name.clone(),
        config: None,
        small_errors: None,
        inputs: simulation.file.iter().cloned().collect(),
        files: Some((simulation.train.clone(), simulation.track.clone())),
        train: of_scenario.train,
        track: of_scenario.track,
        words,
        others: (1..seeds).map(other).collect(),
        source: RunSource::simulated(simulation, seed, count, as_recorded),
    })
}
