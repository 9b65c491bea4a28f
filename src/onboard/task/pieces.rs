//! What a tick and the end of a run do, piece by piece, so that no call takes long.
//!
//! ```text
//! tick         estimate, parameters, effort -> coast ahead, features, status, snapshot -+-> estimate
//! end of run   -+-> what it taught -> record, summary -> what it was ended for          |
//!               +---------------------------------------------------- a long stop ------+
//! ```
//!
//! In: what the last piece left behind. Out: frames, in the order in which they would come from one call. The next
//! message or tick is taken up behind the last piece. Power that goes between two pieces costs what it costs just
//! before the record is written.

use super::{Port, Task};
use crate::model::direction::Direction;
use crate::onboard::event::Event;
use crate::onboard::frames;
use embedded_storage::nor_flash::NorFlash;
use rundown_wire::Body;

/// What is still to be done.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Due {
    Nothing,
    /// The other frames of a tick.
    Report,
    /// What the run taught goes into the vehicle.
    End(Then),
    /// And into the flash; its summary goes out.
    Keep(Then),
    /// What it was ended for.
    After(Then),
}

/// What the end of a run is followed by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Then {
    /// The estimate of the tick that ended it, and the next run: nothing that is to be learned waits for somebody to
    /// say so.
    Estimate,
    /// The answer to this request.
    Answer(u16),
    /// A run in this direction, and the answer.
    Begin(u16, Direction),
}

impl<F: NorFlash> Task<'_, F> {
    /// Something is still to be done.
    pub fn is_busy(&self) -> bool {
        self.due != Due::Nothing
    }

    /// The next piece of what is to be done; nothing where there is none.
    pub fn go_on(&mut self, port: &mut impl Port) {
        match core::mem::replace(&mut self.due, Due::Nothing) {
            Due::Nothing => {}
            Due::Report => self.go_on_reporting(port),
            Due::End(then) => {
                self.end();
                self.due = Due::Keep(then);
            }
            Due::Keep(then) => {
                self.keep();
                self.send_summary(port);
                self.due = Due::After(then);
            }
            Due::After(Then::Estimate) => {
                self.send_estimate(port);
                self.begin(self.run.direction());
            }
            Due::After(Then::Answer(to)) => self.answer(to, Ok(()), port),
            Due::After(Then::Begin(to, direction)) => {
                self.begin(direction);
                self.answer(to, Ok(()), port);
            }
        }
    }

    /// All of it.
    pub(super) fn finish(&mut self, port: &mut impl Port) {
        while self.is_busy() {
            self.go_on(port);
        }
    }

    /// What of a tick comes behind the first frames. The estimate closes it, behind the end of the run where it ends.
    #[inline(never)]
    fn go_on_reporting(&mut self, port: &mut impl Port) {
        let Some(estimate) = self.estimate else {
            return;
        };
        self.report(&estimate, port);
        if self.is_over(&estimate) {
            self.due = Due::End(Then::Estimate);
        } else {
            self.send_estimate(port);
        }
    }

    #[inline(never)]
    fn send_estimate(&mut self, port: &mut impl Port) {
        if let Some(estimate) = &self.estimate {
            let frame = frames::estimate(estimate);
            self.send(Body::Estimate(frame), port);
        }
    }

    /// What the run taught goes into the vehicle.
    #[inline(never)]
    fn end(&mut self) {
        self.estimator.end_run_in(self.run, &mut self.vehicle, self.summary);
        self.running = false;
        self.newest = None;
        self.note(Event::learned(self.summary.learned_s, &self.vehicle.davis()));
    }
}
