//! Downlink: what the board says. Each frame is a value of [`Body`]; numbers are `f32` in SI units, times `f64`.
//!
//! In a tick the frames come in this order: parameters, effort, coast_ahead, the others that are due, and [`Estimate`]
//! last: it closes the tick.

use crate::coast::CoastAhead;
use crate::envelope::{self, DecodeError, EncodeError};
use crate::health::Health;
use crate::words::{Cause, Regime, Validity, Value, words};
use core::fmt;
use heapless::Vec;
use serde::{Deserialize, Serialize, Serializer};

/// One frame of the board.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Downlink {
    /// Counts every frame of the board; wraps, and begins at 0 with each run. A gap is a loss.
    pub sequence: u16,
    /// Ticks of the run.
    pub tick: u32,
    /// What it says.
    pub body: Body,
}

impl Downlink {
    /// Writes the message.
    ///
    /// # Errors
    /// [`EncodeError`]: the buffer is shorter than [`MAX_MESSAGE`](crate::MAX_MESSAGE) and than the message.
    pub fn encode<'a>(&self, buffer: &'a mut [u8]) -> Result<&'a [u8], EncodeError> {
        envelope::encode(self, buffer)
    }

    /// Reads a message.
    ///
    /// # Errors
    /// [`DecodeError`]; nothing panics, whatever the bytes are.
    pub fn decode(message: &[u8]) -> Result<Self, DecodeError> {
        envelope::decode(message)
    }
}

/// The frames. New ones are appended, so that the numbers of the old ones stay.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
#[serde(rename_all = "snake_case")]
pub enum Body {
    /// 0: where, how fast, which regime. Closes a tick.
    Estimate(Estimate),
    /// 1: the running resistance.
    Parameters(Parameters),
    /// 2: applied effort and what bounds it.
    Effort(Effort),
    /// 3: what the run has said of the driving style and the train's limits.
    Features(Features),
    /// 4: some of the run's switching points.
    SwitchingPoints(SwitchingPoints),
    /// 5: the named effects in the board's model.
    Effects(Effects),
    /// 6: what the board has, and what it has counted.
    Status(Status),
    /// 7: what is known at the end of a run.
    RunSummary(RunSummary),
    /// 8: a piece of a snapshot of the whole run.
    SnapshotPart(SnapshotPart),
    /// 9: what became of an uplink frame.
    Answer(Answer),
    /// 10: how the hardware is.
    Health(Health),
    /// 11: what coasting from here leads to.
    CoastAhead(CoastAhead),
    /// 12: which firmware it is.
    Versions(Versions),
    /// 13: what the runs have shown of the recorder.
    Recorder(Recorder),
}

impl Body {
    /// The word used in every output.
    pub const fn as_str(&self) -> &'static str {
        match self {
            Self::Estimate(_) => "estimate",
            Self::Parameters(_) => "parameters",
            Self::Effort(_) => "effort",
            Self::Features(_) => "features",
            Self::SwitchingPoints(_) => "switching_points",
            Self::Effects(_) => "effects",
            Self::Status(_) => "status",
            Self::RunSummary(_) => "run_summary",
            Self::SnapshotPart(_) => "snapshot_part",
            Self::Answer(_) => "answer",
            Self::Health(_) => "health",
            Self::CoastAhead(_) => "coast_ahead",
            Self::Versions(_) => "versions",
            Self::Recorder(_) => "recorder",
        }
    }
}

/// Where, how fast, which regime.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    /// Time of the measurement, s, on the sender's clock.
    pub time_s: f64,
    /// Time since the measurement before, s; 0 at the first one, and after a long gap.
    pub dt_s: f32,
    /// Location of the front, m.
    pub location_m: Value,
    /// Speed, m/s.
    pub speed_mps: Value,
    /// Regime as far as it is known at this tick.
    pub regime: Regime,
    /// Regime of the tick before, with one more sample known.
    pub confirmed: Option<Regime>,
    /// The resistance was learned from this measurement.
    pub learning: bool,
    /// How far location and speed may be trusted.
    pub validity: Validity,
    /// CRC-32C of the estimate in full precision: equal digests, equal states.
    #[serde(with = "postcard::fixint::le")]
    pub digest: u32,
}

words! {
    /// How far the resistance may be trusted.
    #[derive(Default)]
    #[non_exhaustive]
    Learned {
        /// Nothing to speak of yet: these are the manufacturer's values.
        #[default]
        NotYet "not_yet",
        /// Learned from this train's runs.
        Learned "learned",
        /// The estimate lies outside what a train can have; the values are cut off there.
        OutOfBounds "out_of_bounds",
        /// Coasts are foreseen worse by what was learned than by the description, whose coefficients are published
        /// instead.
        PredictsWorse "predicts_worse",
    }
}

/// The running resistance r(v) = r0 + r1 v + r2 v² per rotating mass.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Parameters {
    /// Constant term, N/kg.
    pub r0: Value,
    /// Linear term, N/(kg m/s).
    pub r1: Value,
    /// Quadratic term, N/(kg (m/s)²).
    pub r2: Value,
    /// Correlations r0-r1, r0-r2, r1-r2: with them r(v) has a standard deviation at any speed.
    pub correlation: [f32; 3],
    /// How far they may be trusted. Changes with hysteresis.
    pub learned: Learned,
    /// Gain of the measured effort, true over measured, where the board learns it.
    pub gain: Option<Value>,
}

impl Parameters {
    /// r(v) in N/kg at a speed in m/s, with its standard deviation √(h P hᵀ), h = (1, v, v²).
    ///
    /// ```
    /// use rundown_wire::{Learned, Parameters, Value};
    ///
    /// let parameters = Parameters {
    ///     r0: Value { value: 0.01, sd: 3e-3 },
    ///     r1: Value::default(),
    ///     r2: Value { value: 1e-4, sd: 4e-5 },
    ///     correlation: [0.0; 3],
    ///     learned: Learned::Learned,
    ///     gain: None,
    /// };
    /// let r = parameters.at(10.0);
    /// assert!((r.value - 0.02).abs() < 1e-7);
    /// assert!((r.sd - 5e-3).abs() < 1e-7);
    /// ```
    pub fn at(&self, speed_mps: f32) -> Value {
        let v = f64::from(speed_mps);
        // In double precision: the terms of the variance nearly cancel.
        let h = [1.0, v, v * v];
        let terms = [self.r0, self.r1, self.r2];
        let [of_01, of_02, of_12] = self.correlation.map(f64::from);
        let [a, b, c] = [0, 1, 2].map(|i| h[i] * f64::from(terms[i].sd));
        let variance = a * a + b * b + c * c + 2.0 * (of_01 * a * b + of_02 * a * c + of_12 * b * c);
        let value: f64 = h.iter().zip(&terms).map(|(h, term)| h * f64::from(term.value)).sum();
        Value { value: value as f32, sd: libm::sqrt(variance.max(0.0)) as f32 }
    }
}

/// Applied effort per rotating mass, N/kg, and what bounds it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Effort {
    /// Applied effort, mean since the measurement before; traction positive.
    pub effort_n_per_kg: Option<f32>,
    /// Acceleration, m/s², mean since the measurement before.
    pub acceleration_mps2: Option<f32>,
    /// Resistance of the gradient under the train, uphill positive.
    pub gradient_n_per_kg: f32,
    /// Largest traction at this location and speed by the description and the named effects.
    pub max_traction_n_per_kg: f32,
    /// Largest brake effort there by the description and the named effects, positive.
    pub max_brake_n_per_kg: f32,
}

/// Number of values, their mean and standard deviation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Statistic {
    /// Number of values; 0 means that there is none.
    pub count: u32,
    /// Mean.
    pub mean: f32,
    /// Standard deviation.
    pub sd: f32,
}

/// A stretch of one regime.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Phase {
    /// Time of its start, s, on the sender's clock; where that is set during a run, on the clock as it was before.
    pub start_time_s: f64,
    /// Location of its start, m.
    pub start_location_m: f32,
    /// Speed at its start, m/s.
    pub start_speed_mps: f32,
    /// Duration, s.
    pub duration_s: f32,
    /// Length, m.
    pub length_m: f32,
}

/// The largest tractive effort as a line over speed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct EffortLine {
    /// Efforts of the fit, N/kg.
    pub effort_n_per_kg: Statistic,
    /// Effort at the lower end of the speed window, N/kg.
    pub at_lower_n_per_kg: f32,
    /// Slope, N/kg per m/s.
    pub slope: f32,
}

/// What the run has said of the driving style and the train's limits.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Features {
    /// Largest tractive effort at low speed.
    pub max_effort: Option<EffortLine>,
    /// Mean tractive power per rotating mass, W/kg.
    pub power_w_per_kg: Statistic,
    /// Its largest value, W/kg.
    pub max_power_w_per_kg: Option<f32>,
    /// Brake rates by ATB-EG step, m/s², positive: above 130, 130-80, 80-60, 60-40, below 40 km/h.
    pub brake_rate_mps2: [Statistic; 5],
    /// Cruise speed, m/s; its count is in s.
    pub cruise_speed_mps: Statistic,
    /// Median of the cruise speed, m/s.
    pub cruise_speed_median_mps: Option<f32>,
    /// The coasting before the final brake.
    pub final_coast: Option<Phase>,
    /// The brake into the last stop.
    pub final_brake: Option<Phase>,
    /// Time in standstill, traction, cruise, coast, brake, s.
    pub regime_time_s: [f32; 5],
    /// Work of the traction, J/kg.
    pub traction_j_per_kg: f32,
    /// Work taken out by the brake, J/kg.
    pub brake_j_per_kg: f32,
    /// Work of r0, r1 v, r2 v² and the gradient, J/kg.
    pub resistance_j_per_kg: [f32; 4],
}

/// Where one regime followed another.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SwitchingPoint {
    /// Time, s, on the sender's clock; where that is set during a run, on the clock as it was before.
    pub time_s: f64,
    /// Location, m.
    pub location_m: f32,
    /// Speed, m/s.
    pub speed_mps: f32,
    /// Regime before.
    pub from: Regime,
    /// Regime after.
    pub to: Regime,
}

/// Switching points in one frame.
pub const SWITCHING_POINTS: usize = 16;

/// Some of the run's switching points.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SwitchingPoints {
    /// Number of the first one here, counted from 0 over the run.
    pub first: u16,
    /// How many the run has.
    pub total: u16,
    /// How many more there were than the board keeps.
    pub lost: u32,
    /// The points.
    pub points: Vec<SwitchingPoint, SWITCHING_POINTS>,
}

/// Values that an effect may have.
pub const EFFECT_VALUES: usize = 4;

/// A named effect of the model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Effect {
    /// Its number in the table of `WIRE.md`.
    pub kind: u8,
    /// Where it begins and ends, m; none: everywhere.
    pub section_m: Option<[f64; 2]>,
    /// Its parameters, in the order of the table.
    pub values: Vec<f64, EFFECT_VALUES>,
}

/// Effects in one frame, and on the board.
pub const EFFECTS: usize = 8;

/// The named effects in the board's model.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Effects {
    /// The effects.
    pub effects: Vec<Effect, EFFECTS>,
}

/// How the memory that survives power is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
#[serde(rename_all = "snake_case")]
pub enum Memory {
    /// Nothing was kept: the vehicle is as described.
    #[default]
    Empty,
    /// What was kept is in force.
    Restored,
    /// The newest record was damaged, the one before is in force.
    RestoredOlder,
    /// A record of another train or of another layout was not taken.
    Foreign,
    /// A record held values that no train has.
    Implausible,
    /// The memory cannot be written.
    ReadOnly,
}

/// Number of [`Cause`]s.
pub const CAUSES: usize = Cause::ALL.len();
/// Number of [`Refusal`]s.
pub const REFUSALS: usize = Refusal::ALL.len();

/// A number of 64 bits, in formats for people as hexadecimal digits.
mod hexadecimal {
    use core::fmt::Write as _;
    use heapless::String;
    use serde::{Deserialize, Deserializer, Serialize, Serializer, de::Error};

    pub fn serialize<S: Serializer>(number: &Option<u64>, serializer: S) -> Result<S::Ok, S::Error> {
        if !serializer.is_human_readable() {
            return number.serialize(serializer);
        }
        let digits = number.map(|number| {
            let mut digits = String::<16>::new();
            // 64 bits are 16 digits: they have room.
            let _written = write!(digits, "{number:x}");
            digits
        });
        digits.serialize(serializer)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<u64>, D::Error> {
        if !deserializer.is_human_readable() {
            return Option::deserialize(deserializer);
        }
        let digits = Option::<String<16>>::deserialize(deserializer)?;
        let number = |digits: String<16>| u64::from_str_radix(&digits, 16).map_err(D::Error::custom);
        digits.map(number).transpose()
    }
}

/// What the board has, and what it has counted.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Status {
    /// Epoch and counter of the authentication with their MAC, each start of the board another one; none while
    /// everything secured is refused.
    pub announcement: Option<[u8; 16]>,
    /// Which train is described; where people read, hexadecimal digits: a number of 64 bits loses some in JSON.
    #[serde(with = "hexadecimal")]
    pub train_id: Option<u64>,
    /// Which track is described.
    pub track_id: Option<u32>,
    /// CRC-32C of train, track and configuration in force.
    #[serde(with = "postcard::fixint::le")]
    pub setup: u32,
    /// A run is under way.
    pub running: bool,
    /// Ticks in a row without a new measurement.
    pub silent_ticks: u32,
    /// How often each cause occurred in this run, in the order of [`Cause::ALL`].
    pub causes: [u32; CAUSES],
    /// Measurements of this run whose time did not go on.
    pub time_not_increasing: u32,
    /// How often uplink frames were refused since the start, in the order of [`Refusal::ALL`].
    pub refusals: [u32; REFUSALS],
    /// Gaps in the sequence of the other side. Where measurements are secured, an open message that is not the next one
    /// makes none.
    pub missed: u32,
    /// Messages that came twice.
    pub duplicate: u32,
    /// Frames that the link had no room for; as in [`Health`](crate::Health::not_sent).
    pub not_sent: u32,
    /// The memory that survives power.
    pub memory: Memory,
    /// Records written since the start, and those that failed.
    pub records: [u32; 2],
}

/// Which firmware it is. Differs between a board and a host that replays its log, as [`Health`] does.
///
/// ```
/// use rundown_wire::Versions;
///
/// let board = Versions { firmware: [0, 1, 0], commit: Some(0x0A1B_2C3D), changed: false, downlink: 1, uplink: 1 };
/// assert_eq!(board.to_string(), "firmware 0.1.0 (0a1b2c3d), messages 1 down, 1 up");
/// let test = Versions { commit: None, ..board };
/// assert_eq!(test.to_string(), "firmware 0.1.0 (commit unknown), messages 1 down, 1 up");
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Versions {
    /// Version of the firmware: major, minor, patch.
    pub firmware: [u16; 3],
    /// First 32 bits of the commit that it was built from; none: not known.
    pub commit: Option<u32>,
    /// It was built from sources that differ from that commit.
    pub changed: bool,
    /// Version of the messages that it sends.
    pub downlink: u8,
    /// Version of the messages that it reads.
    pub uplink: u8,
}

impl fmt::Display for Versions {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [major, minor, patch] = self.firmware;
        write!(f, "firmware {major}.{minor}.{patch} (")?;
        match self.commit {
            Some(commit) => write!(f, "{commit:08x}")?,
            None => f.write_str("commit unknown")?,
        }
        let changed = if self.changed { ", changed" } else { "" };
        write!(f, "{changed}), messages {} down, {} up", self.downlink, self.uplink)
    }
}

/// The recorder cuts its speeds off: true is half a step more than read, as the locations of the runs have shown beyond
/// doubt.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Recorder {
    /// True less read speed as the locations show it, m/s.
    pub speed_offset_mps: Value,
    /// Half a step is added to each speed of this run; where it was found in this run, from the next one on.
    pub put_right: bool,
}

/// What is known at the end of a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunSummary {
    /// Number of the run in this vehicle's life.
    pub run: u32,
    /// r0, r1, r2 of this run's train, SI units per rotating mass.
    pub run_davis: [Value; 3],
    /// r0, r1, r2 of the vehicle, the run taken up.
    pub vehicle_davis: [Value; 3],
    /// Wind along the line from run to run as learned, standard deviation, m/s.
    pub wind_sd_mps: f32,
    /// Gain of the measured effort.
    pub gain: Value,
    /// How long the resistance was learned, s; 0 where more than half of the ticks are invalid: such a run does not
    /// change the vehicle.
    pub learned_s: f32,
}

/// Bytes of a snapshot in one frame.
pub const SNAPSHOT_BYTES: usize = 448;

/// A piece of a snapshot. The same frame comes up again to restore it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SnapshotPart {
    /// Tick at which it was taken.
    pub tick: u32,
    /// Train, track and configuration that it belongs to, as in [`Status::setup`].
    #[serde(with = "postcard::fixint::le")]
    pub setup: u32,
    /// CRC-32C of the whole snapshot.
    #[serde(with = "postcard::fixint::le")]
    pub crc: u32,
    /// Length of the whole snapshot, bytes.
    pub total: u16,
    /// Where this piece begins.
    pub first: u16,
    /// The piece.
    #[serde(serialize_with = "as_bytes")]
    pub bytes: Vec<u8, SNAPSHOT_BYTES>,
}

/// All at once: the same bytes as one by one, in a tenth of the time.
fn as_bytes<S: Serializer>(bytes: &[u8], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_bytes(bytes)
}

/// What became of an uplink frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Answer {
    /// Sequence number of that frame; 0 where it could not be read, was refused before the board knew that it is of its
    /// desk, or only at its tick.
    pub to: u16,
    /// Taken, or why not.
    pub result: Result<(), Refusal>,
}

words! {
    /// Why an uplink frame was refused. It has changed nothing but its counter; a part of a list empties the list.
    #[non_exhaustive]
    Refusal {
        /// Another version.
        Version "version",
        /// No frame that the board knows.
        Malformed "malformed",
        /// It changes something and carries no MAC.
        NotSecured "not_secured",
        /// The board has no key.
        Unprovisioned "unprovisioned",
        /// The MAC is wrong.
        WrongMac "wrong_mac",
        /// Its freshness is not above the last one's, or of another start of the board.
        Stale "stale",
        /// For another train.
        OtherTrain "other_train",
        /// For another track.
        OtherTrack "other_track",
        /// A value is out of range; the old ones stay in force. Of a measurement: its time is more than a day ahead, or
        /// none.
        OutOfRange "out_of_range",
        /// A part came out of order; send the first one again.
        OutOfOrder "out_of_order",
        /// Not while a run is under way.
        Running "running",
        /// No run is under way.
        NotRunning "not_running",
        /// Train and track must come first.
        NotDescribed "not_described",
        /// The time of the measurement does not go on from the last one.
        TimeNotIncreasing "time_not_increasing",
        /// The snapshot is damaged, or was taken with another train, track or configuration, or in a run that is over.
        Snapshot "snapshot",
        /// The model of this board has no such effect.
        UnknownEffect "unknown_effect",
        /// The board has started too often in a short time and only says how it is.
        HeartbeatOnly "heartbeat_only",
    }
}
