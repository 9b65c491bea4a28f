//! A conversation with a board: a message, and everything that comes back until it is answered.
//!
//! In: a link, a desk, a run. Out: frames in order, as bytes and read.

use crate::link::Clock;
use rundown::estimator::config::Config;
use rundown::link::{Link, LinkError};
use rundown::model::{direction::Direction, effects::Effects, track::Gradient, train::Train};
use rundown::tick::measurement::Measurement;
use rundown::uplink::{Command, Pace, Request};
use rundown_desk::{Description, Desk, DeskError};
use rundown_files::track_file::TrackFile;
use rundown_wire::{Answer, Body, DecodeError, Downlink, Refusal};
use std::fmt::Display;
use std::time::{Duration, Instant};

/// How long a board may take for an answer. The emulator on a busy machine needs up to a second.
pub const PATIENCE: Duration = Duration::from_secs(10);

/// How long a board that may be just starting is given for its status, before it is asked again.
const ASK_AGAIN: Duration = Duration::from_millis(500);

/// How long an answer may be late before the question counts as lost and is asked again.
const LATE: Duration = Duration::from_secs(3);

/// Of the files that `replay` takes, without their effects: a board has the same in all runs, so the caller says which.
pub fn description(train: &Train, track: &TrackFile, config: Config) -> Description {
    let gradients = track.gradient.iter().map(|entry| Gradient { from_m: entry.from_m, permille: entry.permille });
    Description {
        train: *train.description(),
        track_length_m: track.length_m,
        gradients: gradients.collect(),
        curves: track.curve.clone(),
        targets: track.targets(),
        effects: Effects::NONE,
        config,
    }
}

/// A frame as it came.
#[derive(Clone, Debug, PartialEq)]
pub struct Heard {
    /// Its bytes.
    pub message: Vec<u8>,
    /// What they say.
    pub frame: Downlink,
}

/// Why a conversation ended.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "said by the messages")]
pub enum SessionError {
    #[error("link: {0}")]
    Link(String),
    #[error("no answer to {to} within {} s: is the board powered, and the line connected both ways?", after.as_secs())]
    Silent { to: &'static str, after: Duration },
    #[error("the board refused {what}: {}: {}", refusal.as_str(), remedy(*refusal))]
    Refused { what: &'static str, refusal: Refusal },
    /// A message from the board is no frame.
    #[error("{0}")]
    Decode(DecodeError),
    #[error(transparent)]
    Desk(#[from] DeskError),
}

/// What helps against a refusal.
const fn remedy(refusal: Refusal) -> &'static str {
    match refusal {
        Refusal::Version => "flash the firmware of this program",
        Refusal::Malformed => "its firmware may be older than this program",
        Refusal::NotSecured => "give the board's `--key`",
        Refusal::Unprovisioned => "the board has no key: write one to it (`rundown provision`)",
        Refusal::WrongMac => "give the `--key` that was written to the board",
        Refusal::Stale => "another program talks to the board, or it has restarted: try again",
        Refusal::OtherTrain => "give the number of the train for which the board was provisioned",
        Refusal::OtherTrack => "describe the track before the run",
        Refusal::OutOfRange => "a value is beyond what WIRE.md allows",
        Refusal::OutOfOrder => "a part was lost: try again",
        Refusal::Running => "end the run first",
        Refusal::NotRunning => "begin a run first",
        Refusal::NotDescribed => "describe train and track first",
        Refusal::TimeNotIncreasing => "look at the clock of the log",
        Refusal::Snapshot => "it is damaged, of another description, or of a run that is over",
        Refusal::UnknownEffect => "this firmware has no such effect: flash that of this program",
        Refusal::HeartbeatOnly => "it has crashed too often: take its power away, and read its log",
        _ => "its firmware is newer than this program",
    }
}

/// A board at the other end of a link.
pub struct Session<L> {
    link: L,
    clock: Clock,
    desk: Desk,
}

impl<L: Link> Session<L>
where
    L::PortError: Display,
{
    /// Over this link, with the words of this desk.
    pub fn new(link: L, desk: Desk) -> Self {
        Self { link, clock: Clock::new(), desk }
    }

    /// What the desk has heard.
    pub fn desk(&self) -> &Desk {
        &self.desk
    }

    /// The next frame, if one has come.
    pub fn listen(&mut self) -> Result<Option<Heard>, SessionError> {
        let message = self.link.receive(self.clock.now_us()).map_err(|error| SessionError::Link(error.to_string()))?;
        let Some(message) = message else {
            return Ok(None);
        };
        let frame = Downlink::decode(&message).map_err(SessionError::Decode)?;
        self.desk.hear(&frame)?;
        Ok(Some(Heard { message: message.to_vec(), frame }))
    }

    /// Sends a message.
    pub fn tell(&mut self, message: &[u8]) -> Result<(), SessionError> {
        let begin = Instant::now();
        loop {
            match self.link.send(message, self.clock.now_us()) {
                Ok(()) => return Ok(()),
                Err(LinkError::Busy) if begin.elapsed() < PATIENCE => {
                    std::thread::sleep(Duration::from_millis(1));
                }
                Err(error) => return Err(SessionError::Link(error.to_string())),
            }
        }
    }

    /// Adds the frames that come, until one closes the exchange or the time is up; whether one did.
    fn collect(
        &mut self,
        patience: Duration,
        heard: &mut Vec<Heard>,
        closes: impl Fn(&Body) -> bool,
    ) -> Result<bool, SessionError> {
        let begin = Instant::now();
        while begin.elapsed() < patience {
            let Some(next) = self.listen()? else {
                std::thread::yield_now();
                continue;
            };
            let closed = closes(&next.frame.body);
            heard.push(next);
            if closed {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Asks until it is answered: by an answer to one of the questions, not to an earlier one, or by what else closes
    /// it. With the frames: the refusal, if the last one is one, unless it only shows that the board did what was asked
    /// for before, and its answer was lost.
    fn exchange(
        &mut self,
        to: &'static str,
        late: Duration,
        question: impl Fn(&mut Desk) -> Result<Vec<u8>, DeskError>,
        closes: impl Fn(&Body) -> bool,
        shows_done: impl Fn(Refusal) -> bool,
    ) -> Result<(Vec<Heard>, Option<Refusal>), SessionError> {
        let begin = Instant::now();
        let (mut asked, mut heard) = (Vec::new(), Vec::new());
        while begin.elapsed() < PATIENCE {
            let message = question(&mut self.desk)?;
            asked.push(self.desk.sequence());
            let known = heard.len();
            self.tell(&message)?;
            let answers = |body: &Body| matches!(body, Body::Answer(answer) if asked.contains(&answer.to));
            if self.collect(late, &mut heard, |body| answers(body) || closes(body))? {
                let refusal = heard.last().and_then(|last| refusal_in(&last.frame.body));
                let repeated = asked.len() > 1;
                if refusal.is_some_and(|refusal| repeated && shows_done(refusal)) {
                    heard.pop();
                    return Ok((heard, None));
                }
                return Ok((heard, refusal));
            }
            // A board that cannot read a message, or may not, does not know its number.
            if let Some(refusal) = heard.iter().skip(known).find_map(|heard| nameless_refusal(&heard.frame.body)) {
                return Err(SessionError::Refused { what: to, refusal });
            }
        }
        Err(SessionError::Silent { to, after: PATIENCE })
    }

    /// Asks something that changes the board.
    pub fn ask(&mut self, request: Request, what: &'static str) -> Result<Vec<Heard>, SessionError> {
        let question = |desk: &mut Desk| desk.secured(request.clone());
        let shows_done = |refusal| shows_done(&request, refusal);
        match self.exchange(what, LATE, question, |_| false, shows_done)? {
            (_, Some(refusal)) => Err(SessionError::Refused { what, refusal }),
            (heard, None) => Ok(heard),
        }
    }

    /// Describes train, track and configuration, and begins a run. Asks for the status first, until the board answers:
    /// it may be just starting.
    pub fn prepare(
        &mut self,
        description: &Description,
        direction: Direction,
        pace: Pace,
    ) -> Result<Vec<Heard>, SessionError> {
        let mut heard = self.greet()?;
        for request in self.desk.preparation(description, direction, pace) {
            heard.extend(self.ask(request, "the description of train, track and configuration")?);
        }
        Ok(heard)
    }

    /// Asks for the status until the board answers.
    pub fn greet(&mut self) -> Result<Vec<Heard>, SessionError> {
        let question = |desk: &mut Desk| desk.open(Request::Command(Command::Status));
        let (heard, _) = self.exchange("the question for its status", ASK_AGAIN, question, |_| false, |_| false)?;
        Ok(heard)
    }

    /// One measurement in lockstep: the frames of its tick, or the answer that refuses it.
    pub fn measure(&mut self, measurement: &Measurement) -> Result<Vec<Heard>, SessionError> {
        let question = |desk: &mut Desk| desk.measurement(measurement);
        let its = |body: &Body| matches!(body, Body::Estimate(estimate) if estimate.time_s == measurement.time_s);
        // Its estimate was lost.
        let shows_done = |refusal| refusal == Refusal::TimeNotIncreasing;
        let (heard, _) = self.exchange("a measurement", LATE, question, its, shows_done)?;
        Ok(heard)
    }

    /// Frames that come within this time, until the summary of a run is among them.
    pub fn summary(&mut self, patience: Duration) -> Result<Vec<Heard>, SessionError> {
        let mut heard = Vec::new();
        self.collect(patience, &mut heard, |body| matches!(body, Body::RunSummary(_)))?;
        Ok(heard)
    }

    /// Ends the run.
    pub fn end_run(&mut self) -> Result<Vec<Heard>, SessionError> {
        self.ask(Request::Command(Command::End), "the end of the run")
    }

    /// A measurement by the clock: nothing is waited for.
    pub fn report(&mut self, measurement: &Measurement) -> Result<(), SessionError> {
        let message = self.desk.measurement(measurement)?;
        self.tell(&message)
    }
}

/// Whether the refusal of a request that was repeated shows that it had been carried out.
fn shows_done(request: &Request, refusal: Refusal) -> bool {
    match request {
        Request::Track(_) | Request::Curves(_) | Request::Targets(_) | Request::Effect(_) | Request::Snapshot(_) => {
            refusal == Refusal::OutOfOrder
        }
        Request::Command(Command::End) => refusal == Refusal::NotRunning,
        _ => false,
    }
}

fn refusal_in(body: &Body) -> Option<Refusal> {
    match body {
        Body::Answer(answer) => answer.result.err(),
        _ => None,
    }
}

/// The refusal of a message whose number the board does not know.
fn nameless_refusal(body: &Body) -> Option<Refusal> {
    match body {
        Body::Answer(Answer { to: 0, result }) => result.err(),
        _ => None,
    }
}
