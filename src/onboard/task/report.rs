//! Which frames a tick sends beside the estimate, which closes it.

use super::{Port, Task};
use crate::coast_ahead::Outcome;
use crate::estimator::config::Mode;
use crate::filter::gaussian::Gaussian;
use crate::model::state::{LOCATION, R0, SPEED};
use crate::onboard::auth::KeySource;
use crate::onboard::frames;
use crate::onboard::outbox::WhenFull;
use crate::onboard::versions::VERSIONS;
use crate::tick::estimate::{Cause, Estimate};
use embedded_storage::nor_flash::NorFlash;
use rundown_wire::{Body, CAUSES, Downlink, MAX_MESSAGE, Recorder, SWITCHING_POINTS, Status, Value};

/// Ticks from one features frame and status to the next: by the board's clock a minute.
const REPORT_TICKS: u32 = 6;
/// Ticks from one snapshot to the next: by the board's clock a brown-out loses two minutes at most.
const SNAPSHOT_TICKS: u32 = 12;

impl<F: NorFlash, K: KeySource> Task<'_, F, K> {
    /// What a tick adds to the features, and its first frames.
    #[inline(never)]
    pub(super) fn begin_report(&mut self, port: &mut impl Port) {
        let Some(estimate) = self.estimate else {
            return;
        };
        self.estimator.observe(self.run, &estimate, &self.taken);
        self.send_parameters(&estimate, port);
        let mean = &estimate.belief.mean;
        let limits = self.estimator.limits_n_per_kg(mean[LOCATION], mean[SPEED]);
        let effort = frames::effort(&estimate, limits);
        self.send(Body::Effort(effort), port);
    }

    /// The others, but for the estimate.
    pub(super) fn report(&mut self, estimate: &Estimate, port: &mut impl Port) {
        self.send_coast_ahead(estimate, port);
        if self.tick.is_multiple_of(REPORT_TICKS) {
            self.send_features(port);
            self.send_status(port);
            if !self.estimator.effects().is_empty() {
                self.send(Body::Effects(self.estimator.effects().to_frame()), port);
            }
            self.send_recorder(port);
        }
        // Between the minutes: no tick does everything.
        if self.takes_snapshot() {
            self.take_snapshot_of_the_run();
        }
        self.send_snapshot_parts(port);
    }

    #[inline(never)]
    fn send_parameters(&mut self, estimate: &Estimate, port: &mut impl Port) {
        let mut davis = Gaussian {
            mean: estimate.belief.mean.fixed_rows::<3>(R0).into_owned(),
            covariance: estimate.belief.covariance.fixed_view::<3, 3>(R0, R0).into_owned(),
        };
        let nominal = self.estimator.train().davis();
        self.vehicle.widen(&mut davis, self.run.hops_share());
        let worse_by = self.vehicle.trust().worse_by();
        let (published, learned) = self.published.judge(&nominal, self.initial_sds, &davis, worse_by);
        let gain = match self.estimator.config().mode {
            Mode::Measured => Some(self.run.gain()),
            Mode::Gated | Mode::Paper => None,
        };
        let parameters = frames::parameters(estimate, &published, learned, gain);
        self.send(Body::Parameters(parameters), port);
    }

    fn takes_snapshot(&self) -> bool {
        self.tick % SNAPSHOT_TICKS == REPORT_TICKS / 2
    }

    /// Where the track has targets. Not in the tick of the minute and not in that of a snapshot, which are the longest
    /// ones; what was said last is said again in the tick after the minute's, for a display that missed it.
    #[inline(never)]
    fn send_coast_ahead(&mut self, estimate: &Estimate, port: &mut impl Port) {
        let long = self.tick.is_multiple_of(REPORT_TICKS) || self.takes_snapshot();
        if long || self.estimator.track().targets() == 0 {
            return;
        }
        let mut ahead = self.estimator.coast_ahead(self.run, estimate);
        if self.published.is_withheld() {
            ahead.outcome = Outcome::Unknown;
        }
        let news = self.coast.is_news(&self.estimator.config().coast, &ahead);
        let again = self.tick % REPORT_TICKS == 1;
        if let Some(said) = self.coast.said().filter(|_| news || again) {
            let frame = frames::coast_ahead(said);
            self.send(Body::CoastAhead(frame), port);
        }
    }

    fn send_features(&mut self, port: &mut impl Port) {
        let config = &self.estimator.config().features;
        let features = &mut self.summary.features;
        self.run.features().features_in(config, features);
        // The last ones: the places of older points are known.
        let first = features.switching_points.len().saturating_sub(SWITCHING_POINTS);
        self.send_features_frame(port);
        self.send_switching_points(first, port);
    }

    #[inline(never)]
    fn send_features_frame(&mut self, port: &mut impl Port) {
        let frame = frames::features(&self.summary.features);
        self.send(Body::Features(frame), port);
    }

    #[inline(never)]
    fn send_switching_points(&mut self, first: usize, port: &mut impl Port) {
        let points = frames::switching_points(&self.summary.features, first);
        self.send(Body::SwitchingPoints(points), port);
    }

    pub(super) fn send_summary(&mut self, port: &mut impl Port) {
        self.send_features_frame(port);
        for first in (0..self.summary.features.switching_points.len()).step_by(SWITCHING_POINTS) {
            self.send_switching_points(first, port);
        }
        let wind_sd_mps = self.vehicle.wind_sd_mps(&self.estimator.memory_config());
        let frame = frames::run_summary(self.summary, &self.vehicle, wind_sd_mps);
        self.send(Body::RunSummary(frame), port);
        self.send_recorder(port);
        self.send_status(port);
    }

    /// Where it cuts speeds off.
    #[inline(never)]
    fn send_recorder(&mut self, port: &mut impl Port) {
        let found = self.vehicle.speed_offset().found().filter(|_| self.estimator.cuts_off(&self.vehicle));
        if let Some((value, sd)) = found {
            let put_right = self.run.puts_right();
            self.send(Body::Recorder(Recorder { speed_offset_mps: Value { value, sd }, put_right }), port);
        }
    }

    #[inline(never)]
    pub(super) fn send_status(&mut self, port: &mut impl Port) {
        let counters = self.run.counters();
        let mut causes = [0; CAUSES];
        for (count, cause) in causes.iter_mut().zip(Cause::ALL) {
            *count = counters.of(cause);
        }
        let health = port.health();
        let status = Status {
            announcement: self.verifier.announcement(),
            train_id: self.train_id,
            track_id: self.track_id,
            setup: self.setup,
            running: self.running,
            silent_ticks: self.silent_ticks,
            causes,
            time_not_increasing: counters.time_not_increasing,
            refusals: self.refusals,
            missed: self.missed,
            duplicate: self.duplicate,
            not_sent: health.not_sent,
            memory: self.memory,
            records: self.records,
        };
        self.send(Body::Status(status), port);
        self.send(Body::Health(health), port);
        self.send(Body::Versions(VERSIONS), port);
    }

    pub(super) fn send(&mut self, body: Body, port: &mut impl Port) {
        self.send_as(body, WhenFull::DropOldest, port);
    }

    #[inline(never)]
    pub(super) fn send_as(&mut self, body: Body, when_full: WhenFull, port: &mut impl Port) {
        let frame = Downlink { sequence: self.sequence, tick: self.tick, body };
        // A frame that finds no room is a gap in the sequence for the other side.
        self.sequence = self.sequence.wrapping_add(1);
        let mut buffer = [0; MAX_MESSAGE];
        // The largest one of each kind fits, which tests of the wire format show.
        if let Ok(message) = frame.encode(&mut buffer) {
            port.send(message, when_full);
        }
    }
}
