//! Messages of a recording at the pace of the train.
//!
//! In: messages in their order. Out: the same, each tick when it is due by the times of its estimates.
//!
//! A tick is held back until its estimate, which closes it, says when it is due. Between runs time may go back; a pause
//! of more than [`LONGEST_S`] is cut short.

use super::hub::Hub;
use rundown_wire::{Body, Downlink};
use std::time::{Duration, Instant};

/// Longest pause between two ticks, s of the recording.
pub const LONGEST_S: f64 = 30.0;

pub struct Player<'a> {
    hub: &'a Hub,
    // None: as fast as it goes.
    speed: Option<f64>,
    tick: Vec<Vec<u8>>,
    last: Option<(f64, Instant)>,
}

impl<'a> Player<'a> {
    /// At this many times the speed of the recording; none: at once.
    pub fn new(hub: &'a Hub, speed: Option<f64>) -> Self {
        Self { hub, speed, tick: Vec::new(), last: None }
    }

    pub fn message(&mut self, message: &[u8]) {
        let Some(speed) = self.speed else {
            self.hub.message(message);
            return;
        };
        self.tick.push(message.to_vec());
        if let Ok(Downlink { body: Body::Estimate(estimate), .. }) = Downlink::decode(message) {
            let due = self.last.map_or_else(Instant::now, |(last_s, at)| {
                let pause_s = (estimate.time_s - last_s).clamp(0.0, LONGEST_S) / speed;
                at + Duration::try_from_secs_f64(pause_s).unwrap_or_default()
            });
            std::thread::sleep(due.saturating_duration_since(Instant::now()));
            self.last = Some((estimate.time_s, due));
            self.flush();
        }
    }

    /// What comes without an estimate behind it: the end, or a recording that has none for a while.
    pub fn flush(&mut self) {
        for message in self.tick.drain(..) {
            self.hub.message(&message);
        }
    }
}
