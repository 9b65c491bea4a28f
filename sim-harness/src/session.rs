//! A conversation with a board: a message, and everything that comes back until it is answered.
//!
//! In: a link, a desk, a run. Out: frames in order, as bytes and read.

use crate::desk::{Description, Desk, DeskError};
use crate::link::Clock;
use rundown::link::{Link, LinkError};
use rundown::model::direction::Direction;
use rundown::onboard::uplink::{Command, Pace, Request};
use rundown::tick::measurement::Measurement;
use rundown_wire::{Body, DecodeError, Downlink, Refusal};
use std::fmt;
use std::time::{Duration, Instant};

/// How long a board may take for an answer. The emulator on a busy machine needs up to a second.
pub const PATIENCE: Duration = Duration::from_secs(10);

/// A frame as it came.
#[derive(Clone, Debug, PartialEq)]
pub struct Heard {
    /// Its bytes.
    pub message: Vec<u8>,
    /// What they say.
    pub frame: Downlink,
}

/// Why a conversation ended.
#[derive(Debug)]
#[non_exhaustive]
pub enum SessionError {
    /// The link failed.
    Link(String),
    /// No answer came.
    Silent {
        /// To what.
        to: &'static str,
        /// How long it was waited for.
        after: Duration,
    },
    /// The board refused what it must not refuse.
    Refused {
        /// What.
        what: &'static str,
        /// Why.
        refusal: Refusal,
    },
    /// A message from the board is no frame.
    Decode(DecodeError),
    /// A message could not be made.
    Desk(DeskError),
}

impl fmt::Display for SessionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Link(error) => write!(f, "link: {error}"),
            Self::Silent { to, after } => write!(
                f,
                "no answer to {to} within {} s: is the board powered, and the line connected both ways?",
                after.as_secs()
            ),
            Self::Refused { what, refusal } => {
                write!(f, "the board refused {what}: {}", refusal.as_str())
            }
            Self::Decode(error) => error.fmt(f),
            Self::Desk(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for SessionError {}

impl From<DeskError> for SessionError {
    fn from(error: DeskError) -> Self {
        Self::Desk(error)
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
    L::PortError: fmt::Display,
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
    ///
    /// # Errors
    /// The link fails, or the frame cannot be read.
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
    ///
    /// # Errors
    /// The link fails.
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

    /// Sends a message and collects frames until it is answered: by an answer, or by the estimate that closes a tick.
    fn exchange(&mut self, message: &[u8], to: &'static str) -> Result<Vec<Heard>, SessionError> {
        self.tell(message)?;
        let begin = Instant::now();
        let mut heard = Vec::new();
        while begin.elapsed() < PATIENCE {
            let Some(next) = self.listen()? else {
                std::thread::yield_now();
                continue;
            };
            let answered = matches!(next.frame.body, Body::Answer(_) | Body::Estimate(_));
            heard.push(next);
            if answered {
                return Ok(heard);
            }
        }
        Err(SessionError::Silent { to, after: PATIENCE })
    }

    /// Asks something that changes the board.
    ///
    /// # Errors
    /// It is refused, or not answered.
    pub fn ask(&mut self, request: Request, what: &'static str) -> Result<Vec<Heard>, SessionError> {
        let message = self.desk.secured(request)?;
        let heard = self.exchange(&message, what)?;
        match heard.last().map(|last| &last.frame.body) {
            Some(Body::Answer(answer)) => match answer.result {
                Ok(()) => Ok(heard),
                Err(refusal) => Err(SessionError::Refused { what, refusal }),
            },
            _ => Ok(heard),
        }
    }

    /// Describes train, track and configuration, and begins a run. Asks for the status first, until the board answers: it may be just starting.
    ///
    /// # Errors
    /// The board is silent, or refuses a part of it.
    pub fn prepare(
        &mut self,
        description: &Description,
        direction: Direction,
        pace: Pace,
    ) -> Result<Vec<Heard>, SessionError> {
        let mut heard = self.greet()?;
        for message in self.desk.prepare(description, direction, pace)? {
            let what = "the description of train, track and configuration";
            let frames = self.exchange(&message, what)?;
            if let Some(Body::Answer(answer)) = frames.last().map(|last| &last.frame.body)
                && let Err(refusal) = answer.result
            {
                return Err(SessionError::Refused { what, refusal });
            }
            heard.extend(frames);
        }
        Ok(heard)
    }

    /// Asks for the status until the board answers.
    ///
    /// # Errors
    /// It does not.
    pub fn greet(&mut self) -> Result<Vec<Heard>, SessionError> {
        let begin = Instant::now();
        loop {
            let message = self.desk.open(Request::Command(Command::Status))?;
            self.tell(&message)?;
            let asked = Instant::now();
            let mut heard = Vec::new();
            while asked.elapsed() < Duration::from_millis(500) {
                let Some(next) = self.listen()? else {
                    std::thread::yield_now();
                    continue;
                };
                let answered = matches!(next.frame.body, Body::Answer(_));
                heard.push(next);
                if answered {
                    return Ok(heard);
                }
            }
            if begin.elapsed() > PATIENCE {
                return Err(SessionError::Silent { to: "the question for its status", after: PATIENCE });
            }
        }
    }

    /// One measurement in lockstep: the frames of its tick, or the answer that refuses it.
    ///
    /// # Errors
    /// The board is silent.
    pub fn measure(&mut self, measurement: &Measurement) -> Result<Vec<Heard>, SessionError> {
        let message = self.desk.open(Request::Measurement(*measurement))?;
        self.exchange(&message, "a measurement")
    }

    /// Ends the run.
    ///
    /// # Errors
    /// None is under way, or the board is silent.
    pub fn end_run(&mut self) -> Result<Vec<Heard>, SessionError> {
        self.ask(Request::Command(Command::End), "the end of the run")
    }

    /// A measurement by the clock: nothing is waited for.
    ///
    /// # Errors
    /// The link fails.
    pub fn report(&mut self, measurement: &Measurement) -> Result<(), SessionError> {
        let message = self.desk.open(Request::Measurement(*measurement))?;
        self.tell(&message)
    }
}
