//! What may be asked of the board, and when: the description between runs, commands at any time.

use super::pieces::{Due, Then};
use super::{LONG_STOP_S, LONGEST_STEP_S, MOVING_MPS, Port, Task};
use crate::coast_ahead::Steady;
use crate::estimator::config::Mode;
use crate::model::direction::Direction;
use crate::model::effects::FrameError;
use crate::model::state::SPEED;
use crate::model::table::Table;
use crate::model::track::Track;
use crate::model::train::Train;
use crate::onboard::auth::KeySource;
use crate::onboard::event::Event;
use crate::plain::{self, Plain as _};
use crate::tick::estimate::Estimate;
use crate::tick::regime::Regime;
use crate::uplink::{Command, Pace, Request, Setting, TrackPart, TrainFrame};
use embedded_storage::nor_flash::NorFlash;
use rundown_wire::{Body, Effect, Refusal};

impl<F: NorFlash, K: KeySource> Task<'_, F, K> {
    #[inline(never)]
    pub(super) fn carry_out(&mut self, request: &Request, to: u16, port: &mut impl Port) -> Result<(), Refusal> {
        match request {
            Request::Command(command) => self.command(*command, to, port),
            Request::Surroundings(surroundings) if !surroundings.are_plausible() => Err(Refusal::OutOfRange),
            Request::Surroundings(surroundings) => {
                self.estimator.set_surroundings(self.run, *surroundings);
                Ok(())
            }
            _ if self.running => Err(Refusal::Running),
            Request::Train(frame) => self.take_train(frame),
            Request::Track(part) => self.take_track(part),
            Request::Setting(setting) => self.take_setting(setting),
            Request::Snapshot(part) => self.take_snapshot(part),
            Request::Effect(effect) => self.take_effect(effect, port),
            Request::Curves(part) => {
                self.take_entries(|track| &mut track.curves, part.track_id, part.first, &part.curves)
            }
            Request::Targets(part) => {
                self.take_entries(|track| &mut track.targets, part.track_id, part.first, &part.targets)
            }
            // Taken care of before.
            Request::Measurement(_) => Err(Refusal::Malformed),
        }
    }

    fn command(&mut self, command: Command, to: u16, port: &mut impl Port) -> Result<(), Refusal> {
        match command {
            Command::Begin { direction, track_id } => {
                if !self.described() {
                    return Err(Refusal::NotDescribed);
                }
                if self.track_id != Some(track_id) {
                    return Err(Refusal::OtherTrack);
                }
                if self.running {
                    self.due = Due::End(Then::Begin(to, direction));
                } else {
                    self.begin(direction);
                }
            }
            Command::End if self.running => self.due = Due::End(Then::Answer(to)),
            Command::End => return Err(Refusal::NotRunning),
            Command::Pace(pace) => {
                self.pace = pace;
                // What waits for a tick of the clock would wait for ever.
                if pace == Pace::Lockstep {
                    self.newest = None;
                }
            }
            Command::Status => self.send_status(port),
            Command::Snapshot if self.running => {
                self.take_snapshot_of_the_run();
                self.send_snapshot_parts(port);
            }
            Command::Snapshot => return Err(Refusal::NotRunning),
            Command::Forget if self.train_id.is_none() => return Err(Refusal::NotDescribed),
            Command::Forget if self.running => return Err(Refusal::Running),
            Command::Forget => self.forget(),
            Command::ClearEffects if self.running => return Err(Refusal::Running),
            Command::ClearEffects => {
                self.estimator.effects_mut().clear();
                self.effects_changed(port);
            }
        }
        Ok(())
    }

    pub(super) fn begin(&mut self, direction: Direction) {
        // Once, and not with each of their frames.
        if self.effects_unsaved && self.keeps() {
            self.write();
        }
        self.judge_by_description();
        self.estimator.begin_run_in(self.run, &self.vehicle, direction);
        self.running = true;
        self.note(Event::RunBegins);
        // So that a run gives the same frames whatever was before it.
        self.tick = 0;
        self.sequence = 0;
        self.moved = false;
        self.standing_since_s = None;
        self.coast = Steady::NONE;
        self.newest = None;
        self.last_time_s = None;
    }

    /// How well r is known by the description alone; the same all through a run.
    #[inline(never)]
    pub(super) fn judge_by_description(&mut self) {
        self.initial_sds = self.estimator.initial_sds();
    }

    /// A long stop ends the run.
    pub(super) fn is_over(&mut self, estimate: &Estimate) -> bool {
        let stands = estimate.regime == Regime::Standstill;
        // In single precision, which the board compares at once.
        let dt_s = estimate.dt_s as f32;
        let stood_s = (estimate.time_s - *self.standing_since_s.get_or_insert(estimate.time_s)) as f32;
        // A single row far ahead may have a wrong time: the next one shows it.
        let stood_s = if stands && dt_s <= LONGEST_STEP_S { stood_s } else { stood_s - dt_s };
        if !stands {
            self.standing_since_s = None;
        }
        let is_over = self.moved && dt_s > 0.0 && stood_s >= LONG_STOP_S;
        self.moved |= estimate.belief.mean[SPEED] > MOVING_MPS;
        is_over
    }

    #[inline(never)]
    fn take_train(&mut self, frame: &TrainFrame) -> Result<(), Refusal> {
        if self.verifier.train().is_some_and(|train| train.0 != frame.id) {
            return Err(Refusal::OtherTrain);
        }
        let train = Train::try_new(frame.description).map_err(|_| Refusal::OutOfRange)?;
        // A train that is described once more keeps what was learned of it.
        let known = self.train_id == Some(frame.id) && *self.estimator.train().description() == frame.description;
        if !known {
            self.estimator.set_train(train);
            self.train_id = Some(frame.id);
            self.restore_vehicle();
            self.settle();
        }
        Ok(())
    }

    /// Parts come in order; the old track stays in force until the last one is there.
    fn take_track(&mut self, part: &TrackPart) -> Result<(), Refusal> {
        if part.first == 0 {
            self.incoming.restart(part.length_m).map_err(|_| Refusal::OutOfRange)?;
            self.incoming_id = part.id;
        }
        let there = usize::from(part.first);
        let same = part.id == self.incoming_id
            && part.length_m == self.incoming.length_m()
            && there == self.incoming.entries();
        if !same {
            return Err(Refusal::OutOfOrder);
        }
        for gradient in &part.gradients {
            self.incoming.push(*gradient).map_err(|_| Refusal::OutOfRange)?;
        }
        if self.incoming.entries() > usize::from(part.total) {
            return Err(Refusal::OutOfOrder);
        }
        if self.incoming.entries() == usize::from(part.total) {
            self.estimator.swap_track(self.incoming);
            self.track_id = Some(part.id);
            self.settle();
        }
        Ok(())
    }

    /// Curves or targets of the track in force.
    #[inline(never)]
    fn take_entries<T: Table>(
        &mut self,
        table: impl FnOnce(&mut Track) -> &mut T,
        track_id: u32,
        first: u16,
        entries: &[T::Entry],
    ) -> Result<(), Refusal>
    where
        T::Entry: Copy,
    {
        if self.track_id != Some(track_id) {
            return Err(Refusal::OtherTrack);
        }
        let table = table(self.estimator.track_mut());
        if first == 0 {
            table.clear();
        }
        let taken = if table.len() != usize::from(first) {
            Err(Refusal::OutOfOrder)
        } else if entries.iter().all(|entry| table.push(*entry)) {
            Ok(())
        } else {
            // A partial description is rejected.
            table.clear();
            Err(Refusal::OutOfRange)
        };
        self.settle();
        taken
    }

    #[inline(never)]
    fn take_effect(&mut self, effect: &Effect, port: &mut impl Port) -> Result<(), Refusal> {
        self.estimator.effects_mut().take(effect).map_err(|error| match error {
            FrameError::UnknownKind => Refusal::UnknownEffect,
            FrameError::OutOfOrder => Refusal::OutOfOrder,
            FrameError::Shape | FrameError::Refused(_) => Refusal::OutOfRange,
        })?;
        self.effects_changed(port);
        Ok(())
    }

    fn effects_changed(&mut self, port: &mut impl Port) {
        self.effects_received = true;
        self.effects_unsaved = true;
        self.settle();
        self.send(Body::Effects(self.estimator.effects().to_frame()), port);
    }

    // Of its own: the whole configuration is gone from the stack before a vehicle is restored.
    #[inline(never)]
    fn set(&mut self, setting: &Setting) -> Result<(), Refusal> {
        let mut config = *self.estimator.config();
        setting.apply(&mut config);
        self.estimator.set_config(config).map_err(|_| Refusal::OutOfRange)
    }

    fn take_setting(&mut self, setting: &Setting) -> Result<(), Refusal> {
        let before = self.estimator.config().mode;
        self.set(setting)?;
        let now = self.estimator.config().mode;
        // The paper's vehicle begins with deviations of its own.
        if (before == Mode::Paper) != (now == Mode::Paper) && self.train_id.is_some() {
            self.restore_vehicle();
        }
        self.settle();
        Ok(())
    }

    /// Train, track, configuration or effects in force have changed.
    pub(super) fn settle(&mut self) {
        let (mut train_id, mut track_id, mut parts) =
            (self.train_id, self.track_id, self.estimator.effects().len() as u32);
        self.setup = plain::digest(|bytes| {
            train_id.pass(bytes);
            track_id.pass(bytes);
            self.estimator.pass_setup(bytes);
        });
        if parts > 0 {
            self.setup = plain::digest(|bytes| {
                self.setup.pass(bytes);
                parts.pass(bytes);
                for effect in self.estimator.effects().iter() {
                    effect.parts().for_each(|mut part| part.pass(bytes));
                }
            });
        }
    }
}
