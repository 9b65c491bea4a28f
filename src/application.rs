//! What the firmware does with bytes and ticks. The only place that knows the application; board and host call these three functions.
//!
//! In: bytes of the line, ticks. Out: whole frames, by `send`.
//! A measurement (time, location, speed: three little-endian f64, COBS) is answered by mean and covariance of the filter, bit for bit.

use rundown::Real;
use rundown::config::Config;
use rundown::estimator::{Estimator, RunState};
use rundown::measurement::Measurement;
use rundown::onboard::health::Health;
use rundown::onboard::kept::Boot;
use rundown::resistance::Davis;
use rundown::track::{Direction, Gradient, Track};
use rundown::train::{Train, TrainDescription};

/// Longest frame.
pub const MOST_BYTES: usize = 192;

/// State of the application. Large: lives in a static, never on the stack.
pub struct Application {
    running: Option<(Estimator, RunState)>,
    received: heapless::Vec<u8, MOST_BYTES>,
}

impl Application {
    /// Before [`Self::begin`].
    pub const IDLE: Self = Self {
        running: None,
        received: heapless::Vec::new(),
    };

    /// After boot, with the record that was written at the depot.
    // In a frame of its own: if it overflows the stack, the boot before it has already been counted as one more crash.
    #[inline(never)]
    pub fn begin(&mut self, _boot: &Boot, _record: &[u8; 64], send: &mut impl FnMut(&[u8])) {
        let train = Train::try_new(TrainDescription {
            mass_kg: 364e3,
            rotating_mass_factor: 1.06,
            length_m: 162.0,
            davis: Davis {
                r0: 7.38e-3,
                r1: 1.6e-4,
                r2: 2.8e-5,
            },
            max_tractive_effort_n: 192.92e3,
            max_power_w: 2.036e6,
            max_brake_mps2: 0.66,
        });
        let flat = [Gradient {
            from_m: 0.0,
            permille: 0.0,
        }];
        let (Ok(train), Ok(track)) = (train, Track::try_new(32e3, flat)) else {
            return;
        };
        let Ok(estimator) = Estimator::try_new(Config::default(), train, track) else {
            return;
        };
        let run = estimator.begin_run(&estimator.new_vehicle(), Direction::Up);
        self.running = Some((estimator, run));
        // An empty frame: ready.
        send(&[1, 0]);
    }

    /// A byte came over the line.
    pub fn receive(&mut self, byte: u8, send: &mut impl FnMut(&[u8])) {
        if byte != 0 {
            // A frame that is too long fails to decode.
            let _ = self.received.push(byte);
            return;
        }
        let mut frame = [0; 24];
        let decoded = cobs::decode(&self.received, &mut frame);
        self.received.clear();
        if !decoded.is_ok_and(|report| report.frame_size() == frame.len()) {
            return;
        }
        let mut values = frame
            .chunks_exact(8)
            .filter_map(|bytes| Some(Real::from_le_bytes(bytes.try_into().ok()?)));
        let (Some(time_s), location_m, speed_mps) = (values.next(), values.next(), values.next())
        else {
            return;
        };
        let Some((estimator, run)) = &mut self.running else {
            return;
        };
        let measurement = Measurement {
            time_s,
            location_m,
            speed_mps,
            effort_n_per_kg: None,
        };
        let Ok(estimate) = estimator.step(run, &measurement) else {
            return;
        };
        let mut answer = heapless::Vec::<u8, MOST_BYTES>::new();
        let belief = &estimate.belief;
        for value in belief
            .mean
            .iter()
            .chain(belief.covariance.diagonal().iter())
        {
            let _ = answer.extend_from_slice(&value.to_le_bytes());
        }
        let mut encoded = [0; MOST_BYTES];
        if let Ok(length) = cobs::try_encode(&answer, &mut encoded)
            && let Some(frame) = encoded.get(..length + 1)
        {
            send(frame);
        }
    }

    /// Time has passed: the period of the tick.
    #[cfg_attr(
        not(target_os = "none"),
        expect(dead_code, reason = "the host has no timer")
    )]
    pub fn tick(&mut self, _health: &Health, _send: &mut impl FnMut(&[u8])) {}

    /// In place of everything else after too many crashes; [`Self::begin`] was not called.
    #[cfg_attr(
        not(target_os = "none"),
        expect(dead_code, reason = "the host has no crash loop")
    )]
    pub fn heartbeat(&mut self, _health: &Health, send: &mut impl FnMut(&[u8])) {
        send(&[1, 0]);
    }
}
