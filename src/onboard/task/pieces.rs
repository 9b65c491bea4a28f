//! What a tick and the end of a run do, piece by piece, so that no call takes long.
//!
//! ```text
//! tick         message -> estimate -> features, parameters, effort -> coast ahead, status, snapshot -+-> estimate
//! end of run   -+-> what it taught -> record, summary -> what it was ended for                       |
//!               +----------------------------------------------------------------- a long stop ------+
//! ```
//!
//! In: what the last piece left behind. Out: frames, in the order in which they would come from one call. The next
//! message or tick is taken up behind the last piece. Power that goes between two pieces costs what it costs just
//! before the record is written.

use super::{Origin, Port, Task};
use crate::model::direction::Direction;
use crate::onboard::auth::KeySource;
use crate::onboard::event::Event;
use crate::onboard::frames;
use embedded_storage::nor_flash::NorFlash;
use rundown_wire::Body;

/// What is still to be done.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Due {
    Nothing,
    /// The estimate of the newest measurement; a refusal answers this request.
    Estimate(u16, Origin),
    /// The features of a tick, and its first frames.
    Frames,
    /// The others.
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

impl<F: NorFlash, K: KeySource> Task<'_, F, K> {
    /// Something is still to be done.
    pub fn is_busy(&self) -> bool {
        self.due != Due::Nothing
    }

    /// The next piece of what is to be done; nothing where there is none.
    pub fn go_on(&mut self, port: &mut impl Port) {
        match core::mem::replace(&mut self.due, Due::Nothing) {
            Due::Nothing => {}
            Due::Estimate(to, origin) => match self.step() {
                Ok(()) => self.due = Due::Frames,
                Err(refusal) => {
                    self.refuse(to, refusal, origin, port);
                    self.be_silent(port);
                }
            },
            Due::Frames => {
                self.begin_report(port);
                self.due = Due::Report;
            }
            Due::Report => self.go_on_reporting(port),
            Due::End(then) => {
                self.estimator.teach(self.run, &mut self.vehicle, self.summary);
                self.due = Due::Keep(then);
            }
            Due::Keep(then) => {
                self.close();
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

    /// What the run taught is complete.
    fn close(&mut self) {
        self.estimator.close(self.run, &mut self.vehicle, self.summary);
        self.running = false;
        self.newest = None;
        self.note(Event::learned(self.summary.learned_s, &self.vehicle.davis()));
    }
}
