//! What changes every tick of a run, and its snapshot.
//!
//! In: nothing but what [`crate::estimator`] writes here. Out: the belief at any time; the whole state as bytes, from
//! which the run goes on.

use crate::Real;
use crate::features::{FeatureExtractor, Observation};
use crate::filter::gaussian::Gaussian;
use crate::model::direction::Direction;
use crate::model::effects::Journey;
use crate::model::point::Point;
use crate::model::state::{LOCATION, R0, SIZE};
use crate::plain::{self, Plain as _};
use crate::tick::effort_reading::{Column, EffortReading};
use crate::tick::estimate::Counters;
use crate::tick::kinematics::Kinematics;
use crate::tick::learning::{Learner, Tick};
use crate::tick::paper::PaperLoop;
use crate::tick::plausibility::Plausibility;
use crate::tick::regime::{Recogniser, Regime};
use crate::tick::short_hops::Hops;
use crate::tick::snapshot::{InPlace, in_place};
use crate::tick::staircase::Staircase;
use crate::tick::truncation::Distances;
use rundown_wire::errors;

in_place! {
    /// What changes every tick of a run. Made by [`Estimator::begin_run`](crate::estimator::Estimator::begin_run).
    #[derive(Clone, Debug)]
    pub struct RunState {
        pub(crate) direction: Direction = (Direction::Up);
        /// What was believed of this run's train when it began.
        pub(crate) begin: Gaussian<4> = (Gaussian::ZEROED);
        pub(crate) plausibility: Plausibility = (Plausibility::ZEROED);
        pub(crate) kinematics: Kinematics = (Kinematics::ZEROED);
        pub(crate) paper: Option<PaperLoop> = (None, zeroed Some(PaperLoop::ZEROED));
        pub(crate) learner: Learner = (in place);
        /// Regimes at the anchor.
        pub(crate) recogniser: Recogniser = (Recogniser::default(), zeroed Recogniser::ZEROED);
        /// Regime at the last tick.
        pub(crate) regime: Regime = (Regime::Standstill);
        /// Where the current piece of evidence began.
        pub(crate) anchor: Option<Point> = (None);
        /// Last tick with a speed, for the effort of one interval.
        pub(crate) last: Option<Point> = (None);
        pub(crate) effort_reading: EffortReading = (in place);
        /// The last tick and where the train was by its readings: it waits for the next row of the effort.
        pub(crate) waits: Option<(Tick, Gaussian<2>)> = (None, zeroed Some((Tick::START, Gaussian::ZEROED)));
        pub(crate) hops: Hops = (in place);
        pub(crate) staircase: Staircase = (in place);
        /// The recorder cuts its speeds off, as the runs before have shown.
        pub(crate) truncated: bool = (false);
        pub(crate) distances: Distances = (in place);
        /// Last speed reading, for the features.
        pub(crate) reading: Option<Point> = (None);
        /// The last tick waits here until its regime is confirmed.
        pub(crate) unconfirmed: Option<Observation> = (None, zeroed Some(Observation::ZEROED));
        pub(crate) without_location_s: Real = (0.0);
        pub(crate) without_speed_s: Real = (0.0);
        pub(crate) ticks: u32 = (0);
        pub(crate) invalid_ticks: u32 = (0);
        pub(crate) counters: Counters = (Counters::ZEROED);
        pub(crate) journey: Journey = (Journey::ZEROED);
        pub(crate) features: FeatureExtractor = (in place);
    }
}

/// Most bytes that a snapshot takes. Held by a test over a run that fills every buffer.
pub const MAX_SNAPSHOT: usize = 12 * 1024;

errors! {
    /// Why bytes are no snapshot. The run is idle afterwards: a partial state is rejected.
    #[derive(Eq)]
    pub struct NoSnapshot => "snapshot: expected one of a run of this version, found other bytes";
}

impl RunState {
    /// Zeros: as a static it takes no flash, and its start no stack. No run before [`RunState::reset`].
    pub const ZEROED: Self = InPlace::ZEROED;

    /// No run.
    pub fn idle() -> Self {
        let mut run = Self::ZEROED;
        run.reset();
        run
    }

    /// To no run, in place.
    pub fn reset(&mut self) {
        self.journey = Journey::ZEROED;
        self.begin(Gaussian::ZEROED, Column::default(), Direction::Up);
    }

    /// Begins with a belief of this run's train and the gain of its effort column, in place and without a copy of the
    /// features' buffers. The surroundings stay.
    pub(crate) fn begin(&mut self, begin: Gaussian<4>, column: Column, direction: Direction) {
        let mut journey = self.journey;
        journey.begin();
        self.clear_fields();
        self.journey = journey;
        self.direction = direction;
        let [_, share] = column.next_run();
        self.learner.begin_run(&begin);
        self.effort_reading.begin_run(share, column);
        self.features.begin();
        self.begin = begin;
    }

    /// Direction of travel.
    pub fn direction(&self) -> Direction {
        self.direction
    }

    /// Regime at the last tick.
    pub fn regime(&self) -> Regime {
        self.regime
    }

    /// How often each cause occurred in this run.
    pub fn counters(&self) -> &Counters {
        &self.counters
    }

    /// Gain of the measured effort, true over measured, and its standard deviation.
    pub fn gain(&self) -> (Real, Real) {
        self.learner.gain()
    }

    /// Share of what it has taught that it taught on short hops, below zero where its speeds are finer than whole km/h.
    pub fn hops_share(&self) -> Real {
        let share = self.learner.hops_share();
        if self.hops.speed_sd_mps().is_some() { -share } else { share }
    }

    /// Ticks whose location or speed is not to be trusted.
    pub fn invalid_ticks(&self) -> u32 {
        self.invalid_ticks
    }

    /// More than half of its ticks are invalid: it does not change the vehicle.
    pub fn is_mostly_invalid(&self) -> bool {
        self.invalid_ticks > self.ticks / 2
    }

    /// Half a step is added to each speed that is read: the recorder cuts them off, as the runs before have shown.
    pub fn puts_right(&self) -> bool {
        self.truncated
    }

    /// What the features have seen of this run.
    pub fn features(&self) -> &FeatureExtractor {
        &self.features
    }

    /// Writes the whole state, and changes nothing of it. The bytes are of this version of the library only; at most
    /// [`MAX_SNAPSHOT`].
    ///
    /// # Errors
    /// [`NoSnapshot`]: `buffer` is too small.
    pub fn snapshot<'a>(&mut self, buffer: &'a mut [u8]) -> Result<&'a [u8], NoSnapshot> {
        plain::write(self, buffer).ok_or(NoSnapshot)
    }

    /// Goes on where the snapshot was taken. Field by field in place: a whole run on the stack would be 14 kB.
    ///
    /// # Errors
    /// [`NoSnapshot`]; the run is idle then, in the same surroundings.
    pub fn restore(&mut self, bytes: &[u8]) -> Result<(), NoSnapshot> {
        let journey = self.journey;
        if !(plain::read_all(self, bytes) && self.is_sound()) {
            self.journey = journey;
            self.begin(Gaussian::ZEROED, Column::default(), Direction::Up);
            return Err(NoSnapshot);
        }
        Ok(())
    }

    /// What a filter needs to go on: finite numbers.
    fn is_sound(&self) -> bool {
        self.begin.is_finite() && self.davis().is_finite() && self.belief().is_finite()
    }

    /// This run's Davis coefficients.
    pub(crate) fn davis(&self) -> Gaussian<3> {
        match &self.paper {
            Some(paper) => Gaussian {
                mean: paper.belief.mean.fixed_rows::<3>(R0).into_owned(),
                covariance: paper.belief.covariance.fixed_view::<3, 3>(R0, R0).into_owned(),
            },
            None => self.learner.davis(),
        }
    }

    /// The whole state: location and speed of the segment where one runs, of the readings elsewhere; the coefficients
    /// as far as they are valid.
    pub(crate) fn belief(&self) -> Gaussian<SIZE> {
        // Where a tick waits the segment is one behind.
        let moving = self.learner.moving().filter(|_| self.waits.is_none());
        let moving = moving.unwrap_or_else(|| self.kinematics.belief());
        let davis = self.learner.davis();
        let mut belief = Gaussian::<SIZE>::ZEROED;
        belief.mean.fixed_rows_mut::<2>(LOCATION).copy_from(&moving.mean);
        belief.mean.fixed_rows_mut::<3>(R0).copy_from(&davis.mean);
        belief.covariance.fixed_view_mut::<2, 2>(LOCATION, LOCATION).copy_from(&moving.covariance);
        belief.covariance.fixed_view_mut::<3, 3>(R0, R0).copy_from(&davis.covariance);
        belief
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;

    #[test]
    fn a_snapshot_of_another_length_is_refused_and_leaves_an_idle_run() {
        let mut buffer = std::vec![0; MAX_SNAPSHOT];
        let bytes = RunState::idle().snapshot(&mut buffer).unwrap().to_vec();
        let mut run = RunState::idle();
        assert_eq!(run.restore(&bytes), Ok(()));
        run.without_speed_s = 7.0;
        run.journey.surroundings.temperature_c = Some(-4.0);
        for wrong in [&bytes[..bytes.len() - 1], &[&bytes[..], &[0]].concat()] {
            assert_eq!(run.restore(wrong), Err(NoSnapshot));
            assert_eq!(run.without_speed_s, 0.0);
            assert_eq!(run.journey.surroundings.temperature_c, Some(-4.0), "they hold until they are replaced");
        }
    }

    #[test]
    fn numbers_that_are_none_are_refused() {
        let mut run = RunState::idle();
        run.begin.mean[1] = Real::NAN;
        let mut buffer = std::vec![0; MAX_SNAPSHOT];
        let bytes = run.snapshot(&mut buffer).unwrap().to_vec();
        assert_eq!(RunState::idle().restore(&bytes), Err(NoSnapshot));
    }
}
