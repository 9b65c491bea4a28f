//! The tick: measurement -> plausibility -> `modes`: kinematics -> effort -> regime -> learning (ukf) -> features.
//! Only these two files know the order.
//!
//! What is set once ([`Estimator`]: configuration, train, track) comes by `&`, what changes every tick ([`RunState`])
//! by `&mut`. The board, the replay and the tests run the same [`Estimator::step`].

pub mod config;
mod modes;
pub mod run_state;

use crate::Real;
use crate::coast_ahead::{self, CoastAhead};
use crate::estimator::config::{Config, Mode};
use crate::estimator::run_state::RunState;
use crate::features::{Features, Observation};
use crate::filter::gaussian::Gaussian;
use crate::model::direction::Direction;
use crate::model::effects::{Acting, Effects, Surroundings};
use crate::model::effort;
use crate::model::line::Line;
use crate::model::point::Point;
use crate::model::resistance::Davis;
use crate::model::state::{LOCATION, SPEED};
use crate::model::track::Track;
use crate::model::train::Train;
use crate::plain::{Bytes, Plain};
use crate::tick::bounds::ConfigError;
use crate::tick::effort_reading::Column;
use crate::tick::estimate::{Cause, Counters, Estimate, Validity};
use crate::tick::foresight::Foresight;
use crate::tick::measurement::Measurement;
use crate::tick::memory::{MemoryConfig, Vehicle, beside_gain};
use crate::tick::plausibility::{Judged, is_out_of_range};
use crate::tick::published::{self, Published};
use crate::tick::regime::Regime;
use crate::tick::sensor::Rounding;
use crate::tick::truncation;
use core::borrow::{Borrow, BorrowMut};
use nalgebra::Vector3;
use rundown_wire::{Learned, errors};

/// Without a location for longer than this the location is invalid; the same for the speed, s.
const INVALID_AFTER_S: Real = 60.0;

/// What is set once: configuration, train, track, effects. The board lends its track and effects (`T = &mut Track`,
/// `E = &mut Effects`), for they take 16 kB and 2 kB.
#[derive(Clone, Debug)]
pub struct Estimator<T = Track, E = Effects> {
    config: Config,
    train: Train,
    track: T,
    effects: E,
}

errors! {
    /// Why a measurement gave no estimate. Nothing has changed but its counter.
    #[non_exhaustive]
    pub enum StepError {
        TimeNotIncreasing { last_s: Real, found_s: Real } => "time_s: expected one that goes on from {last_s}, found {found_s}",
        TimeOutOfRange { found_s: Real } =>
            "time_s: expected a time that goes on from the last one, by at most a day, found {found_s}",
    }
}

/// What is known at the end of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct RunSummary {
    /// Features of the run.
    pub features: Features,
    /// Davis coefficients of this run's train (wind and load of the day included).
    pub run_davis: Gaussian<3>,
    /// Gain of the measured effort, true over measured, and its standard deviation (`measured` mode).
    pub gain: (Real, Real),
    /// How long the resistance was learned, s; 0 where most of the run is invalid.
    pub learned_s: Real,
    /// How the coasts that taught had been foreseen.
    pub foresight: Foresight,
    /// How often each cause occurred.
    pub counters: Counters,
}

impl RunSummary {
    /// Of no run.
    pub const NONE: Self = Self {
        features: Features::NONE,
        run_davis: Gaussian::ZEROED,
        gain: (0.0, 0.0),
        learned_s: 0.0,
        foresight: Foresight::NONE,
        counters: Counters::ZEROED,
    };
}

/// What the readings of a tick were worth, for [`Estimator::observe`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Taken {
    time_s: Real,
    speed_mps: Option<Real>,
}

impl Taken {
    /// At no tick.
    pub(crate) const NOTHING: Self = Self { time_s: 0.0, speed_mps: None };
}

impl<T: Borrow<Track>> Estimator<T> {
    /// Checks the configuration. The model has no named effects yet.
    ///
    /// # Errors
    /// [`ConfigError`] names the first field that is out of range.
    pub fn try_new(config: Config, train: Train, track: T) -> Result<Self, ConfigError> {
        config.check()?;
        Ok(Self { config, train, track, effects: Effects::NONE })
    }

    /// The same with these effects in the model.
    ///
    /// ```
    /// use rundown::estimator::Estimator;
    /// use rundown::estimator::config::Config;
    /// use rundown::model::effects::*;
    /// use rundown::model::resistance::Davis;
    /// use rundown::model::{direction::Direction, track::*};
    /// use rundown::model::train::*;
    ///
    /// # let description = TrainDescription::CASE_STUDY;
    /// let train = Train::try_new(description)?;
    /// let track = Track::try_new(32e3, [])?;
    /// let tunnel = Effect::TunnelDrag(TunnelDrag { from_m: 4e3, to_m: 9e3, k: 1e-5 });
    /// let estimator = Estimator::try_new(Config::default(), train, track)?
    ///     .with_effects(Effects::try_new([tunnel])?);
    /// assert_eq!(estimator.effects().len(), 1);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn with_effects(self, effects: Effects) -> Self {
        Self { effects, ..self }
    }
}

impl<T: Borrow<Track>, E: Borrow<Effects>> Estimator<T, E> {
    /// Without a train, for a board that has no description yet: not to be stepped before train and track are set.
    pub(crate) fn undescribed(track: T, effects: E) -> Self {
        Self { config: Config::default(), train: Train::undescribed(), track, effects }
    }

    /// The named effects of the model.
    pub fn effects(&self) -> &Effects {
        self.effects.borrow()
    }

    /// To be changed between runs only.
    pub(crate) fn effects_mut(&mut self) -> &mut Effects
    where
        E: BorrowMut<Effects>,
    {
        self.effects.borrow_mut()
    }

    /// Configuration, train and track, for a digest.
    pub(crate) fn pass_setup(&mut self, bytes: &mut Bytes<'_>)
    where
        T: BorrowMut<Track>,
    {
        self.config.pass(bytes);
        let mut description = *self.train.description();
        description.pass(bytes);
        self.track_mut().pass(bytes);
    }

    /// To be changed between runs only.
    pub(crate) fn track_mut(&mut self) -> &mut Track
    where
        T: BorrowMut<Track>,
    {
        self.track.borrow_mut()
    }

    pub(crate) fn set_train(&mut self, train: Train) {
        self.train = train;
    }

    /// Takes the track and gives back the one before. In place: a track takes 16 kB.
    pub(crate) fn swap_track(&mut self, track: &mut Track)
    where
        T: BorrowMut<Track>,
    {
        core::mem::swap(self.track.borrow_mut(), track);
    }

    pub(crate) fn set_config(&mut self, config: Config) -> Result<(), ConfigError> {
        config.check()?;
        self.config = config;
        Ok(())
    }

    /// The track as it was described.
    pub fn track(&self) -> &Track {
        self.track.borrow()
    }

    /// The train as it was described.
    pub fn train(&self) -> &Train {
        &self.train
    }

    /// The configuration in force.
    pub fn config(&self) -> &Config {
        &self.config
    }

    /// The memory's settings; how windy the line is may be known as an effect.
    pub fn memory_config(&self) -> MemoryConfig {
        let memory = self.config.memory;
        MemoryConfig { wind_sd_mps: self.effects().wind_sd_mps().unwrap_or(memory.wind_sd_mps), ..memory }
    }

    /// Largest tractive effort and largest brake effort, N/kg, both positive, as the model believes them at a location
    /// and speed.
    pub fn limits_n_per_kg(&self, location_m: Real, speed_mps: Real) -> (Real, Real) {
        self.effects().limits_n_per_kg(&self.train, location_m, speed_mps)
    }

    /// Temperature and date, for the effects that depend on them; from the next tick on, until others are given.
    pub fn set_surroundings(&self, run: &mut RunState, surroundings: Surroundings) {
        run.journey.surroundings = surroundings;
    }

    /// The vehicle as its manufacturer describes it, before any run.
    pub fn new_vehicle(&self) -> Vehicle {
        match self.config.mode {
            Mode::Paper => Vehicle::independent(self.train.davis(), self.config.paper.initial_davis_sd),
            Mode::Gated | Mode::Measured => Vehicle::new(&self.memory_config(), self.train.davis()),
        }
    }

    /// What of a vehicle is published between runs, and how far it may be trusted.
    pub fn published(&self, vehicle: &Vehicle) -> (Davis, Learned) {
        let nominal = self.train.davis();
        Published::default().judge(&nominal, self.initial_sds(), &vehicle.davis(), vehicle.trust().worse_by())
    }

    /// Standard deviations of r by the description alone, N/kg, by which it is judged what was learned.
    pub(crate) fn initial_sds(&self) -> [Real; 2] {
        published::sds(&self.new_vehicle().davis())
    }

    /// Begins a run with what is known of the vehicle.
    pub fn begin_run(&self, vehicle: &Vehicle, direction: Direction) -> RunState {
        let mut run = RunState::idle();
        self.begin_run_in(&mut run, vehicle, direction);
        run
    }

    /// As [`Estimator::begin_run`], in the place of another run: a run takes 14 kB, which the board never has on its
    /// stack.
    pub fn begin_run_in(&self, run: &mut RunState, vehicle: &Vehicle, direction: Direction) {
        let gain_sd = self.config.learning.gain_sd;
        let begin = match self.config.mode {
            Mode::Paper => beside_gain(&vehicle.davis(), (1.0, gain_sd * gain_sd), &Vector3::zeros()),
            Mode::Gated | Mode::Measured => vehicle.constants(&self.memory_config(), gain_sd),
        };
        run.begin(begin, vehicle.column, direction);
        run.distances.begin_run(&self.config.sensor);
        run.truncated = self.config.mode != Mode::Paper && self.cuts_off(vehicle);
    }

    /// The runs have shown that speeds are cut off, which the configuration does not say: from the next run on they are
    /// put right, but for the `paper` mode.
    pub fn cuts_off(&self, vehicle: &Vehicle) -> bool {
        let sensor = &self.config.sensor;
        sensor.rounding == Rounding::Rounded && vehicle.speed_offset().is_truncated(sensor)
    }

    /// One tick.
    ///
    /// # Errors
    /// [`StepError`]: the measurement is dropped for its time and counted, nothing else changes.
    pub fn step(&self, run: &mut RunState, measurement: &Measurement) -> Result<Estimate, StepError> {
        let (estimate, taken) = self.estimate(run, measurement)?;
        self.observe(run, &estimate, &taken);
        Ok(estimate)
    }

    /// Most of [`Estimator::step`]; the rest is [`Estimator::observe`], for a board that does no more at once than it
    /// must.
    pub(crate) fn estimate(
        &self,
        run: &mut RunState,
        measurement: &Measurement,
    ) -> Result<(Estimate, Taken), StepError> {
        let config = &self.config;
        let measurement = &self.corrected(run, measurement);
        let judged = run
            .plausibility
            .judge(
                &config.plausibility,
                &truncation::sensor(&config.sensor, run.truncated),
                &self.train,
                self.track().length_m(),
                run.direction,
                measurement,
            )
            .map_err(|last_s| {
                run.counters.time_not_increasing = run.counters.time_not_increasing.saturating_add(1);
                let found_s = measurement.time_s;
                match last_s {
                    Some(last_s) if !is_out_of_range(Some(last_s), found_s) => {
                        StepError::TimeNotIncreasing { last_s, found_s }
                    }
                    _ => StepError::TimeOutOfRange { found_s },
                }
            })?;
        run.distances.observe(&config.sensor, run.direction.sign(), &judged, measurement.speed_mps);
        let line = Line { train: &self.train, track: self.track(), direction: run.direction };
        run.journey.measured(judged.time_s, judged.speed_mps.ok());
        let acting = Acting::new(self.effects.borrow(), run.journey);
        let validity = self.count(run, &judged);
        run.ticks = run.ticks.wrapping_add(1);
        run.invalid_ticks += u32::from(matches!(validity, Validity::Invalid(_)));
        let estimate = match config.mode {
            Mode::Paper => modes::paper_tick(config, run, &line, &acting, &judged, validity),
            Mode::Gated | Mode::Measured => modes::learning_tick(config, run, &line, &acting, &judged, validity),
        };
        Ok((estimate, Taken { time_s: judged.time_s, speed_mps: judged.speed_mps.ok() }))
    }

    /// The readings as the effects put them right. A location without a speed is carried on by the last one.
    fn corrected(&self, run: &RunState, measurement: &Measurement) -> Measurement {
        let effects = self.effects();
        if effects.is_empty() {
            return *measurement;
        }
        let speed_mps = measurement.speed_mps.map(|speed_mps| effects.true_speed_mps(speed_mps));
        let last_mps = run.last.map_or(0.0, |last| last.speed_mps);
        let location_m = measurement.location_m.map(|location_m| {
            let now_mps = speed_mps.unwrap_or(last_mps);
            effects.true_location_m(run.direction.sign(), location_m, now_mps)
        });
        Measurement { location_m, speed_mps, ..*measurement }
    }

    /// What coasting from the last tick's `estimate` on leads to, see [`crate::coast_ahead`]. Changes nothing.
    pub fn coast_ahead(&self, run: &RunState, estimate: &Estimate) -> CoastAhead {
        let line = Line { train: &self.train, track: self.track(), direction: run.direction };
        let acting = Acting::new(self.effects.borrow(), run.journey);
        // That of a tick of 10 s.
        let noise_mps2 = self.config.learning.acceleration_noise_mps2;
        let now = &estimate.belief.mean;
        let noise = 10.0 * noise_mps2 * noise_mps2 + self.config.track_doubt.density(&line, now[LOCATION], now[SPEED]);
        coast_ahead::predict(&self.config.coast, &line, &acting, noise, estimate)
    }

    /// Ends a run: what it said about the train goes into the vehicle's memory, unless most of it is invalid.
    pub fn end_run(&self, run: &mut RunState, vehicle: &mut Vehicle) -> RunSummary {
        let mut summary = RunSummary::NONE;
        self.end_run_in(run, vehicle, &mut summary);
        summary
    }

    /// As [`Estimator::end_run`], in the place of another summary: it takes 3 kB, which the board does not have on its
    /// stack.
    pub fn end_run_in(&self, run: &mut RunState, vehicle: &mut Vehicle, summary: &mut RunSummary) {
        self.teach(run, vehicle, summary);
        self.close(run, vehicle, summary);
    }

    /// The first half of [`Estimator::end_run_in`]: what the run said about the resistance goes into the memory.
    pub(crate) fn teach(&self, run: &RunState, vehicle: &mut Vehicle, summary: &mut RunSummary) {
        summary.run_davis = run.davis();
        summary.gain = run.learner.gain();
        summary.foresight = Foresight::NONE;
        if run.is_mostly_invalid() {
            return;
        }
        let column = match self.config.mode {
            Mode::Measured => Column::of_run(summary.gain, &run.effort_reading),
            Mode::Paper | Mode::Gated => vehicle.column,
        };
        match self.config.mode {
            Mode::Paper => vehicle.replace(&summary.run_davis),
            Mode::Gated | Mode::Measured => {
                let foresight = run.learner.foresight();
                let hops_share = run.hops_share();
                let end = run.learner.constants();
                vehicle.learn(&self.memory_config(), [&run.begin, end], column, &foresight, hops_share);
                vehicle.widen(&mut summary.run_davis, hops_share);
                summary.foresight = foresight;
            }
        }
        vehicle.column = column;
    }

    /// The second half: the features, and what the run said about the speeds.
    pub(crate) fn close(&self, run: &mut RunState, vehicle: &mut Vehicle, summary: &mut RunSummary) {
        if let Some(last) = run.unconfirmed.take() {
            run.features.observe(&self.config.features, &last);
        }
        run.features.end(&self.config.features);
        run.features.features_in(&self.config.features, &mut summary.features);
        summary.counters = run.counters;
        summary.learned_s = 0.0;
        if run.is_mostly_invalid() {
            return;
        }
        summary.learned_s = run.learner.learned_s();
        let cut_off = self.cuts_off(vehicle);
        vehicle.offset.add(&self.config.sensor, &run.distances);
        if self.cuts_off(vehicle) != cut_off && self.config.mode != Mode::Paper {
            vehicle.doubt_readings(&self.memory_config());
        }
    }

    fn count(&self, run: &mut RunState, judged: &Judged) -> Validity {
        if judged.begins && run.last.is_some() {
            run.counters.count(Cause::LongGap);
        }
        if judged.shifted {
            run.counters.count(Cause::Contradiction);
        }
        let mut age = |reading: &Result<Real, Cause>, age_s: &mut Real| {
            *age_s = if reading.is_ok() { 0.0 } else { *age_s + judged.dt_s };
            let cause = reading.err()?;
            run.counters.count(cause);
            Some(if *age_s > INVALID_AFTER_S { Validity::Invalid(cause) } else { Validity::Held(cause) })
        };
        let location = age(&judged.location_m, &mut run.without_location_s);
        let speed = age(&judged.speed_mps, &mut run.without_speed_s);
        if let Some(cause) = judged.contradiction {
            if judged.speed_mps != Err(cause) {
                run.counters.count(cause);
            }
            return Validity::Invalid(cause);
        }
        match (location, speed) {
            (Some(invalid @ Validity::Invalid(_)), _) | (_, Some(invalid @ Validity::Invalid(_))) => invalid,
            (Some(held), _) | (None, Some(held)) => held,
            (None, None) => Validity::Valid,
        }
    }

    /// Hands the last tick to the features, now that its regime is confirmed, and keeps this one, with what was `taken`
    /// at it.
    pub(crate) fn observe(&self, run: &mut RunState, estimate: &Estimate, taken: &Taken) {
        let line = Line { train: &self.train, track: self.track(), direction: run.direction };
        let acting = Acting::new(self.effects.borrow(), run.journey);
        if let (Some(mut last), Some(regime)) = (run.unconfirmed, estimate.confirmed) {
            if last.regime != Regime::Standstill {
                last.regime = regime;
            }
            run.features.observe(&self.config.features, &last);
        }
        let davis = estimate.davis();
        let now = Point {
            time_s: taken.time_s,
            location_m: estimate.belief.mean[LOCATION],
            speed_mps: estimate.belief.mean[SPEED],
        };
        // Readings, not filtered speeds: the paper's filtered speed lags by a sample.
        let reading = taken.speed_mps.map(|speed_mps| Point { speed_mps, ..now });
        let effort = match (run.reading, reading) {
            (Some(from), Some(to)) => Some(effort::over_interval(&line, &acting, &davis, &from, &to)),
            _ => None,
        };
        run.reading = reading;
        run.unconfirmed = Some(Observation {
            time_s: now.time_s,
            dt_s: estimate.dt_s,
            location_m: now.location_m,
            speed_mps: taken.speed_mps.unwrap_or(now.speed_mps),
            effort_n_per_kg: effort.map(|effort| effort.effort_n_per_kg),
            acceleration_mps2: effort.map(|effort| effort.acceleration_mps2),
            gradient_n_per_kg: estimate.gradient_n_per_kg,
            davis,
            // The paper's rule knows no standstill, but the features end their phases with one.
            regime: match taken.speed_mps {
                Some(0.0) => Regime::Standstill,
                _ => estimate.regime,
            },
        });
        // What the regime is at this tick may be taken back at the next one; a brake is not.
        if estimate.confirmed == Some(Regime::Brake) {
            run.journey.brake();
        }
    }
}
