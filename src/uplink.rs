//! Uplink: what is sent to the board. What only asks (a measurement, [`Command::Status`]) comes open or secured; all
//! else changes the board and must be secured, and measurements too where [`SecurityConfig`] says so.
//!
//! ```text
//! open       version, 0, postcard of Uplink
//! secured    version, 1, postcard of Uplink, then the trailer of `auth`: epoch, counter, MAC
//! ```
//!
//! The MAC is checked before anything behind the second byte is read.

use crate::Real;
use crate::coast_ahead::CoastConfig;
use crate::estimator::config::{Config, Mode, SecurityConfig};
use crate::features::FeatureConfig;
use crate::model::direction::Direction;
use crate::model::effects::Surroundings;
use crate::model::track::{Curve, Gradient, Target};
use crate::model::train::TrainDescription;
use crate::plain::{self, Bytes, Plain, plain, plain_choice};
use crate::tick::effort_reading::EffortReadingConfig;
use crate::tick::learning::LearningConfig;
use crate::tick::measurement::Measurement;
use crate::tick::memory::MemoryConfig;
use crate::tick::paper::{PaperConfig, PaperDriftConfig};
use crate::tick::plausibility::PlausibilityConfig;
use crate::tick::regime::{PaperRule, RecogniserConfig};
use crate::tick::sensor::SensorConfig;
use crate::tick::short_hops::ShortHopConfig;
use crate::tick::track_doubt::TrackDoubtConfig;
use heapless::Vec;
use rundown_wire::{Effect, SnapshotPart};
use serde::{Deserialize, Serialize};

/// Version of the uplink messages.
pub const VERSION: u8 = 1;
/// Second byte of an open message.
pub const OPEN: u8 = 0;
/// Second byte of a secured message.
pub const SECURED: u8 = 1;
/// Gradients in one [`TrackPart`].
pub const GRADIENTS: usize = 24;

/// One frame to the board.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Uplink {
    /// Counts the sender's frames; wraps. The board answers with it.
    pub sequence: u16,
    /// What it asks.
    pub request: Request,
}

plain_choice! {
    /// The frames. New ones are appended, so that the numbers of the old ones stay.
    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    #[non_exhaustive]
    pub enum Request {
        /// 0: one measurement.
        Measurement(Measurement),
        /// 1: the train, between runs.
        Train(TrainFrame),
        /// 2: a part of the track, between runs; it is in force once the last part has come.
        Track(TrackPart),
        /// 3: a section of the configuration, between runs.
        Setting(Setting),
        /// 4: a named effect for the model, between runs.
        Effect(Effect),
        /// 5: something to do.
        Command(Command),
        /// 6: a part of a snapshot to go on from.
        Snapshot(SnapshotPart),
        /// 7: temperature and date, for the effects that depend on them; at any time.
        Surroundings(Surroundings),
        /// 8: curves of the track in force, between runs.
        Curves(CurvePart),
        /// 9: stops and permitted speeds of the track in force, between runs.
        Targets(TargetPart),
    }
}

/// The train.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct TrainFrame {
    /// Which train; must be the one that the board is provisioned for.
    pub id: u64,
    /// Its description.
    pub description: TrainDescription,
}

/// A part of the track.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TrackPart {
    /// Which track, and which version of it.
    pub id: u32,
    /// Length of the track, m.
    pub length_m: Real,
    /// Gradients of the whole track.
    pub total: u16,
    /// Number of the first one here; parts come in order.
    pub first: u16,
    /// The gradients.
    pub gradients: Vec<Gradient, GRADIENTS>,
}

/// Curves in one [`CurvePart`].
pub const CURVES: usize = 16;

/// Curves of the track in force. Each part is in force as soon as it has come.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CurvePart {
    /// The track that the sender means.
    pub track_id: u32,
    /// Number of the first one here; parts come in order, and 0 begins a new list.
    pub first: u16,
    /// The curves.
    pub curves: Vec<Curve, CURVES>,
}

/// Stops and permitted speeds in one [`TargetPart`].
pub const TARGETS: usize = 24;

/// Stops and permitted speeds of the track in force. Each part is in force as soon as it has come.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TargetPart {
    /// The track that the sender means.
    pub track_id: u32,
    /// Number of the first one here; parts come in order, and 0 begins a new list.
    pub first: u16,
    /// The places.
    pub targets: Vec<Target, TARGETS>,
}

macro_rules! sections {
    ($($(#[$doc:meta])* $Section:ident($Type:ty) is $field:ident,)*) => {
        plain_choice! {
            /// A section of the configuration; the whole is checked before it takes the old one's place.
            #[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
            #[non_exhaustive]
            pub enum Setting {
                $($(#[$doc])* $Section($Type),)*
            }
        }

        impl Setting {
            /// All sections of a configuration.
            pub fn all(config: &Config) -> [Self; 15] {
                [$(Self::$Section(config.$field)),*]
            }

            /// Puts the section into a configuration.
            pub fn apply(&self, config: &mut Config) {
                match *self {
                    $(Self::$Section(section) => config.$field = section,)*
                }
            }
        }
    };
}

sections! {
    /// 0: source of the effort.
    Mode(Mode) is mode,
    /// 1: what the readings are worth.
    Sensor(SensorConfig) is sensor,
    /// 2: the paper's filter.
    Paper(PaperConfig) is paper,
    /// 3: learning.
    Learning(LearningConfig) is learning,
    /// 4: what is carried from run to run.
    Memory(MemoryConfig) is memory,
    /// 5: the paper's regime rule.
    PaperRule(PaperRule) is paper_rule,
    /// 6: the recogniser.
    Recogniser(RecogniserConfig) is recogniser,
    /// 7: windows of the features.
    Features(FeatureConfig) is features,
    /// 8: when a reading is not believed.
    Plausibility(PlausibilityConfig) is plausibility,
    /// 9: coast-ahead prediction.
    Coast(CoastConfig) is coast,
    /// 10: what may come without a MAC.
    Security(SecurityConfig) is security,
    /// 11: what is expected of an effort column.
    EffortReading(EffortReadingConfig) is effort_reading,
    /// 12: learning on short hops.
    ShortHops(ShortHopConfig) is short_hops,
    /// 13: how far the described gradients may be off.
    TrackDoubt(TrackDoubtConfig) is track_doubt,
    /// 14: what the paper's filter lets change during a run.
    PaperDrift(PaperDriftConfig) is paper_drift,
}

/// When a tick happens.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Pace {
    /// By the board's clock, with the newest measurement.
    #[default]
    Clock,
    /// With each measurement, at once: logs are played faster than they were recorded.
    Lockstep,
}

/// Something to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[non_exhaustive]
pub enum Command {
    /// 0: begin a run; one that is under way ends first.
    Begin {
        /// Direction of travel.
        direction: Direction,
        /// The track that the sender means.
        track_id: u32,
    },
    /// 1: end the run; what it said goes into the vehicle's memory.
    End,
    /// 2: when ticks happen.
    Pace(Pace),
    /// 3: say how you are.
    Status,
    /// 4: send the next pieces of the snapshot that is on its way, or the first ones of a new one.
    Snapshot,
    /// 5: forget what was learned of the vehicle, between runs.
    Forget,
    /// 6: take all named effects out of the model, between runs.
    ClearEffects,
}

plain! {
    struct Uplink { sequence, request }
    struct TrainFrame { id, description }
    struct TrackPart { id, length_m, total, first, gradients }
    struct CurvePart { track_id, first, curves }
    struct TargetPart { track_id, first, targets }
}

plain! {
    enum Pace { Clock, Lockstep }
}

impl Plain for Command {
    const START: Self = Self::Status;

    fn pass(&mut self, bytes: &mut Bytes<'_>) {
        let now = match self {
            Self::Begin { .. } => 0,
            Self::End => 1,
            Self::Pace(_) => 2,
            Self::Status => 3,
            Self::Snapshot => 4,
            Self::Forget => 5,
            Self::ClearEffects => 6,
        };
        let chosen = bytes.choice(now, 7);
        if bytes.are_read() {
            *self = match chosen {
                0 => Self::Begin { direction: Plain::START, track_id: 0 },
                1 => Self::End,
                2 => Self::Pace(Plain::START),
                4 => Self::Snapshot,
                5 => Self::Forget,
                6 => Self::ClearEffects,
                // 3, for no more than 7 can be chosen.
                _ => Self::Status,
            };
        }
        match self {
            Self::Begin { direction, track_id } => {
                direction.pass(bytes);
                track_id.pass(bytes);
            }
            Self::Pace(pace) => pace.pass(bytes),
            Self::End | Self::Status | Self::Snapshot | Self::Forget | Self::ClearEffects => {}
        }
    }
}

/// Reads the payload of a message whose MAC was checked, or that may come open.
pub fn decode(payload: &[u8]) -> Option<Uplink> {
    let mut uplink = Uplink::START;
    plain::read_all(&mut uplink, payload).then_some(uplink)
}

/// Whether a payload may come open, by its first bytes; none: it is too short, or of no kind. The rest of it is not
/// read.
pub fn may_come_open(security: &SecurityConfig, payload: &[u8]) -> Option<bool> {
    const MEASUREMENT: u32 = 0;
    const COMMAND: u32 = 5;
    const LAST: u32 = 9;
    const STATUS: u32 = 3;
    let (mut head, mut command) = ((0_u16, 0), 0);
    let rest = plain::read(&mut head, payload)?;
    let (_, request) = head;
    match request {
        MEASUREMENT => Some(!security.secured_measurements),
        COMMAND => plain::read(&mut command, rest).map(|_| command == STATUS),
        _ => (request <= LAST).then_some(false),
    }
}

/// Writes version, protection ([`OPEN`] or [`SECURED`]) and payload; a secured message still lacks its trailer.
///
/// # Errors
/// [`rundown_wire::EncodeError`]: the buffer is too short.
pub fn encode<'a>(
    uplink: &Uplink,
    protection: u8,
    buffer: &'a mut [u8],
) -> Result<&'a [u8], rundown_wire::EncodeError> {
    let (head, rest) = buffer.split_at_mut_checked(2).ok_or(rundown_wire::EncodeError)?;
    head.copy_from_slice(&[VERSION, protection]);
    let length = postcard::to_slice(uplink, rest).map_err(|_| rundown_wire::EncodeError)?.len();
    buffer.get(..2 + length).ok_or(rundown_wire::EncodeError)
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::listed::listed;

    fn requests() -> impl Iterator<Item = Request> {
        let effect = Effect { kind: 3, section_m: Some([1e3, 2e3]), values: [0.5, -1.0].into_iter().collect() };
        let part =
            SnapshotPart { tick: 300, setup: 7, crc: u32::MAX, total: 9, first: 0, bytes: listed(*b"abcdefghi") };
        let commands = [
            Command::Begin { direction: Direction::Down, track_id: 77_777 },
            Command::End,
            Command::Pace(Pace::Lockstep),
            Command::Status,
            Command::Snapshot,
            Command::Forget,
            Command::ClearEffects,
        ];
        let others = [
            Request::Measurement(Measurement { time_s: 10.0, speed_mps: Some(38.9), ..Default::default() }),
            Request::Train(TrainFrame { id: 1 << 63, description: TrainDescription::CASE_STUDY }),
            Request::Track(TrackPart {
                id: 1,
                length_m: 32e3,
                total: 300,
                first: 24,
                gradients: listed([Gradient { from_m: 100.0, permille: -3.5 }]),
            }),
            Request::Effect(effect),
            Request::Snapshot(part),
            Request::Surroundings(Surroundings { temperature_c: Some(-4.0), day: None }),
            Request::Curves(CurvePart {
                track_id: 1,
                first: 0,
                curves: listed([Curve { from_m: 1.0, to_m: 2.0, radius_m: 300.0 }]),
            }),
            Request::Targets(TargetPart {
                track_id: 1,
                first: 2,
                targets: listed([Target { at_m: 9e3, limit_mps: None }]),
            }),
        ];
        let settings = Setting::all(&Config::default()).into_iter().map(Request::Setting);
        others.into_iter().chain(commands.into_iter().map(Request::Command)).chain(settings)
    }

    /// Each request, whole, with every byte changed and cut short everywhere, is read as postcard reads it, who writes
    /// it.
    #[test]
    fn every_request_is_read_as_it_was_written() {
        for request in requests() {
            let uplink = Uplink { sequence: 300, request };
            let mut buffer = [0; 600];
            let length = encode(&uplink, OPEN, &mut buffer).unwrap().len();
            let payload = &mut buffer[2..length];
            let may_open = matches!(uplink.request, Request::Measurement(_) | Request::Command(Command::Status));
            assert_eq!(may_come_open(&SecurityConfig::default(), payload), Some(may_open), "{uplink:?}");
            assert_eq!(decode(payload), Some(uplink));
            for at in 0..payload.len() {
                assert_eq!(decode(&payload[..at]), None, "{at}");
                for change in [1, 0x80, 0xFF] {
                    payload[at] ^= change;
                    let expected = postcard::take_from_bytes::<Uplink>(payload).ok();
                    let expected = expected.filter(|(_, rest)| rest.is_empty()).map(|(uplink, _)| uplink);
                    let (found, expected) = (std::format!("{:?}", decode(payload)), std::format!("{expected:?}"));
                    assert_eq!(found, expected, "byte {at} changed by {change}");
                    payload[at] ^= change;
                }
            }
        }
    }
}
