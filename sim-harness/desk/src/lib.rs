//! The other end of the link: what a DAS computer says to the board, and in which order.
//!
//! In: train, track, configuration, measurements. Out: messages, secured where they must be. The link that carries them
//! is the caller's.
#![warn(missing_docs)]

use rundown::model::effects::{Effect, Effects};
use rundown::model::track::{Curve, Gradient, Target, Track};
use rundown::model::train::{Train, TrainDescription};
use rundown::onboard::auth::{Provisioning, Refusal, SealError, Signer};
use rundown::tick::measurement::Measurement;
use rundown::uplink::{
    self, CURVES, Command, CurvePart, GRADIENTS, Pace, Request, SECURED, Setting, TARGETS, TargetPart, TrackPart,
    TrainFrame, Uplink,
};
use rundown::{
    estimator::Estimator, estimator::config::Config, model::direction::Direction, onboard::task::DATA_ID, tick::digest,
};
use rundown_wire::{Body, Downlink, EncodeError, MAX_MESSAGE, SnapshotPart, Versions};

/// Number of the first section of the configuration that the boards of the first version do not know.
const FIRST_LATER: usize = 10;

/// What a board gets before a run.
#[derive(Clone, Debug, PartialEq)]
#[expect(missing_docs, reason = "as in the files")]
pub struct Description {
    pub train: TrainDescription,
    pub track_length_m: f64,
    pub gradients: Vec<Gradient>,
    pub curves: Vec<Curve>,
    pub targets: Vec<Target>,
    /// Named effects, which take the place of the board's; with none the board keeps those that it has.
    pub effects: Effects,
    pub config: Config,
}

impl Description {
    /// The estimator that the board makes of it.
    ///
    /// # Errors
    /// What the board would refuse, in words.
    pub fn estimator(&self) -> Result<Estimator, String> {
        let train = Train::try_new(self.train).map_err(|error| error.to_string())?;
        let track = Track::try_new(self.track_length_m, self.gradients.iter().copied())
            .and_then(|track| track.with_curves(self.curves.iter().copied()))
            .and_then(|track| track.with_targets(self.targets.iter().copied()))
            .map_err(|error| error.to_string())?;
        Estimator::try_new(self.config, train, track)
            .map(|estimator| estimator.with_effects(self.effects.clone()))
            .map_err(|error| error.to_string())
    }

    /// Tells tracks and their versions apart.
    pub fn track_id(&self) -> u32 {
        if self.curves.is_empty() {
            return digest::of(&(self.track_length_m, &self.gradients));
        }
        digest::of(&(self.track_length_m, &self.gradients, &self.curves))
    }

    /// The requests that describe it to the board of this train.
    pub fn requests(&self, train_id: u64) -> Vec<Request> {
        // Of the later ones not the defaults, which a board of an earlier version does not know.
        let defaults = Setting::all(&Config::default());
        let settings = Setting::all(&self.config).into_iter().zip(defaults).enumerate();
        let known = settings.filter(|(number, (setting, default))| *number < FIRST_LATER || setting != default);
        let mut requests: Vec<Request> = known.map(|(_, (setting, _))| Request::Setting(setting)).collect();
        requests.push(Request::Train(TrainFrame { id: train_id, description: self.train }));
        let total = u16::try_from(self.gradients.len()).unwrap_or(u16::MAX);
        let mut parts: Vec<&[Gradient]> = self.gradients.chunks(GRADIENTS).collect();
        if parts.is_empty() {
            parts.push(&[]);
        }
        let first = |index: usize, size: usize| u16::try_from(index * size).unwrap_or(u16::MAX);
        let (id, track_id) = (self.track_id(), self.track_id());
        requests.extend(parts.into_iter().enumerate().map(|(index, part)| {
            let gradients = part.iter().copied().collect();
            Request::Track(TrackPart {
                id,
                length_m: self.track_length_m,
                total,
                first: first(index, GRADIENTS),
                gradients,
            })
        }));
        requests.extend(self.curves.chunks(CURVES).enumerate().map(|(index, part)| {
            let curves = part.iter().copied().collect();
            Request::Curves(CurvePart { track_id, first: first(index, CURVES), curves })
        }));
        requests.extend(self.targets.chunks(TARGETS).enumerate().map(|(index, part)| {
            let targets = part.iter().copied().collect();
            Request::Targets(TargetPart { track_id, first: first(index, TARGETS), targets })
        }));
        if !self.effects.is_empty() {
            requests.push(Request::Command(Command::ClearEffects));
            let parts = self.effects.iter().flat_map(Effect::parts);
            requests.extend(parts.map(Request::Effect));
        }
        requests
    }
}

/// Why a message could not be made.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DeskError {
    /// The board has not yet announced its freshness; ask it for its status first.
    #[error(
        "the board has announced no freshness: ask for its status; where that does not help, it has no key (`rundown provision`), cannot write its flash, or has crashed too often and only says how it is"
    )]
    NotAnnounced,
    /// The board's announcement was made with another key.
    #[error(
        "key: expected the one that the board was provisioned with, found another one: give that one, or write this one to the board"
    )]
    WrongKey(Refusal),
    /// The message is longer than the link allows.
    #[error("message: expected at most {} bytes, found more", MAX_MESSAGE)]
    TooLong,
    /// No more messages in this epoch: restart the board.
    #[error("{0}")]
    Seal(SealError),
}

impl From<EncodeError> for DeskError {
    fn from(_: EncodeError) -> Self {
        Self::TooLong
    }
}

/// One end of a conversation with a board.
#[derive(Clone, Debug)]
pub struct Desk {
    provisioning: Provisioning,
    signer: Option<Signer>,
    sequence: u16,
    snapshot: Vec<SnapshotPart>,
    /// The board that was described asks for secured measurements.
    secures_measurements: bool,
    versions: Option<Versions>,
}

impl Desk {
    /// `provisioning` is the record that the board was given.
    pub fn new(provisioning: Provisioning) -> Self {
        Self {
            provisioning,
            signer: None,
            sequence: 0,
            snapshot: Vec::new(),
            secures_measurements: false,
            versions: None,
        }
    }

    /// Takes from a frame of the board what the next messages need: the freshness, and the pieces of a snapshot.
    ///
    /// # Errors
    /// [`DeskError::WrongKey`]: the board has another key.
    pub fn hear(&mut self, frame: &Downlink) -> Result<(), DeskError> {
        match &frame.body {
            Body::Status(status) => {
                if let Some(announcement) = &status.announcement {
                    match &mut self.signer {
                        Some(signer) => signer.hear(announcement),
                        None => Signer::new(&self.provisioning, announcement).map(|signer| self.signer = Some(signer)),
                    }
                    .map_err(DeskError::WrongKey)?;
                }
            }
            Body::Versions(versions) => self.versions = Some(*versions),
            Body::SnapshotPart(part) => {
                if part.first == 0 {
                    self.snapshot.clear();
                }
                self.snapshot.push(part.clone());
            }
            _ => {}
        }
        Ok(())
    }

    /// Which firmware the board is, once it has said so; boards of before this frame do not.
    pub fn versions(&self) -> Option<Versions> {
        self.versions
    }

    /// The last snapshot, if all of it has come.
    pub fn snapshot(&self) -> Option<&[SnapshotPart]> {
        let mut next = 0;
        for part in &self.snapshot {
            if usize::from(part.first) != next || part.crc != self.snapshot[0].crc {
                return None;
            }
            next += part.bytes.len();
        }
        (next > 0 && next == usize::from(self.snapshot[0].total)).then_some(&self.snapshot)
    }

    /// A message that changes the board.
    ///
    /// # Errors
    /// [`DeskError::NotAnnounced`] before the board's first status.
    pub fn secured(&mut self, request: Request) -> Result<Vec<u8>, DeskError> {
        let uplink = self.uplink(request);
        let signer = self.signer.as_mut().ok_or(DeskError::NotAnnounced)?;
        let mut bare = [0; MAX_MESSAGE];
        let mut sealed = [0; MAX_MESSAGE];
        let bare = uplink::encode(&uplink, SECURED, &mut bare)?;
        let sealed = signer.seal(DATA_ID, bare, &mut sealed).map_err(DeskError::Seal)?;
        Ok(sealed.to_vec())
    }

    /// A message that asks only: a measurement, or [`Command::Status`].
    pub fn open(&mut self, request: Request) -> Result<Vec<u8>, DeskError> {
        let uplink = self.uplink(request);
        let mut buffer = [0; MAX_MESSAGE];
        Ok(uplink::encode(&uplink, uplink::OPEN, &mut buffer)?.to_vec())
    }

    /// A measurement: open, unless the board was described as one that asks for secured ones.
    ///
    /// # Errors
    /// As [`secured`](Self::secured).
    pub fn measurement(&mut self, measurement: &Measurement) -> Result<Vec<u8>, DeskError> {
        let request = Request::Measurement(*measurement);
        if self.secures_measurements { self.secured(request) } else { self.open(request) }
    }

    /// Everything up to the first measurement.
    pub fn prepare(
        &mut self,
        description: &Description,
        direction: Direction,
        pace: Pace,
    ) -> Result<Vec<Vec<u8>>, DeskError> {
        let requests = self.preparation(description, direction, pace);
        requests.into_iter().map(|request| self.secured(request)).collect()
    }

    /// What [`Desk::prepare`] secures.
    pub fn preparation(&mut self, description: &Description, direction: Direction, pace: Pace) -> Vec<Request> {
        self.secures_measurements = description.config.security.secured_measurements;
        let mut requests = description.requests(self.provisioning.train.0);
        requests.push(Request::Command(Command::Pace(pace)));
        requests.push(Request::Command(Command::Begin { direction, track_id: description.track_id() }));
        requests
    }

    /// Sequence number of the message that was made last; an answer names it.
    pub fn sequence(&self) -> u16 {
        self.sequence
    }

    fn uplink(&mut self, request: Request) -> Uplink {
        // 0 is what a board answers to that could not read the message.
        self.sequence = self.sequence.checked_add(1).unwrap_or(1);
        Uplink { sequence: self.sequence, request }
    }
}
