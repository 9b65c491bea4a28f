//! One thing that is the matter with a log: what, how much, where, and what was done.

use crate::agreement::Figure;
use serde::Serialize;
use std::fmt;

/// What is the matter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// The clock went back at midnight: seconds of the day.
    Midnight,
    /// The clock was set back.
    ClockSetBack,
    /// The clock was set forward: the train did not move as long as that.
    ClockSetForward,
    /// Rows hold the distance of one second more than their clock says.
    LostSeconds,
    /// No rows while the train stood.
    MissingStandstill,
    /// No rows while the train moved.
    Gaps,
    /// The odometer began again at zero after a full turn.
    Wrap,
    /// The locations began again elsewhere.
    Reset,
    /// Single locations far from both neighbours.
    LocationSpikes,
    /// The location stays although the speed does not.
    StuckLocation,
    /// The speed stays although the location says otherwise.
    StuckSpeed,
    /// There and back in one log.
    TwoDirections,
    /// Speeds are multiples of a step, the nearest one.
    RoundedSpeed,
    /// Speeds are multiples of a step, the one below.
    TruncatedSpeed,
    /// Speeds are multiples of a step; to the nearest or the one below is not known.
    SteppedSpeed,
    /// The speed reads too low or high by the same everywhere.
    SpeedOffset,
    /// The speed reads too low or high by a factor: a wheel that is not as believed.
    SpeedScale,
    /// That factor changes within a run, or from one run on.
    WheelChange,
    /// The speed is a mean over some seconds around its time.
    SmoothedSpeed,
    /// The speed is older than the location.
    Skew,
    /// The locations grow too fast or too slowly beside the described stops: an odometer with a wheel that is not as believed.
    LocationScale,
    /// A column holds another unit.
    OtherUnit,
    /// Readings that are no numbers, or beyond the range of their column.
    Impossible,
    /// Single speeds far from both neighbours.
    SpeedSpikes,
    /// Rows without a location or without a speed.
    MissingReadings,
    /// The readings of another log.
    SameRows,
    /// Faster than the track describes.
    AboveSpeedLimit,
    /// More tractive effort is measured than the train is described with.
    AboveTraction,
    /// More braking effort is measured than the train is described with.
    AboveBrake,
    /// The measured effort has nothing to do with the train's acceleration.
    EffortApart,
    /// The measured effort has steps as large as the resistance.
    EffortSteps,
    /// The train answers otherwise to the measured effort of this run than in the other runs.
    EffortUnlike,
    /// The measured effort is above zero while the train brakes.
    UnsignedBrake,
    /// The measured effort stands still for a while, beside a train that answers to another one.
    EffortHeld,
    /// The measured effort is older than the speed.
    EffortLate,
    /// The measured effort of a train that stands is not 0.
    EffortOffset,
    /// The measured effort is 0 where the train brakes, or holds its speed.
    EffortZeros,
    /// The speed reads zero below a threshold.
    DeadZone,
    /// The speed repeats the last value in some rows, and catches up after them.
    HeldSpeeds,
    /// Rows were written out of their order.
    OutOfOrder,
    /// Rows have the time of the row before.
    CoarseClock,
    /// Rows lie on straight lines between every few of them.
    Interpolated,
    /// Some of the readings are those of another log.
    SharedRows,
    /// The locations count from another place than those of the other runs.
    OtherChainage,
    /// The locations count from the other end of the line.
    TurnedChainage,
}

/// What was done about it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Done {
    /// Put right before anything else looks at it.
    PutRight,
    /// The readings concerned are left out.
    LeftOut,
    /// Said; nothing is changed.
    Said,
    /// The run is not used.
    Refused,
}

/// What was found in one run, or in all runs of one recorder.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Finding {
    /// What.
    pub kind: Kind,
    /// How much, in `unit`.
    pub figure: Figure,
    /// Unit of the figure.
    pub unit: &'static str,
    /// Times that it was seen; rows, where it is a matter of rows.
    pub count: usize,
    /// First line of the log where it is seen, 0 where it is a matter of the whole log.
    pub line: u64,
    /// What was done.
    pub done: Done,
}

impl Kind {
    /// What it is, in words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Midnight => "the clock goes back at midnight",
            Self::ClockSetBack => "the clock was set back",
            Self::ClockSetForward => "the clock was set forward",
            Self::LostSeconds => "rows hold one second more than their clock says",
            Self::MissingStandstill => "no rows while standing",
            Self::Gaps => "gaps while moving",
            Self::Wrap => "the odometer began again at zero",
            Self::Reset => "the locations began again elsewhere",
            Self::LocationSpikes => "single locations far from their neighbours",
            Self::StuckLocation => "the location stands still while the train runs",
            Self::StuckSpeed => "the speed stays the same while the locations say otherwise",
            Self::TwoDirections => "the train goes there and back in one log",
            Self::RoundedSpeed => "speeds are rounded to the nearest step",
            Self::TruncatedSpeed => "speeds are truncated to the step below",
            Self::SteppedSpeed => "speeds have a step; rounded or truncated is not known",
            Self::SpeedOffset => "the speed is off by the same everywhere: true less read",
            Self::SpeedScale => "the speed is off by a factor: read over true",
            Self::LocationScale => "the locations are off by a factor beside the described stops: read over described",
            Self::WheelChange => "the speed's scale changes: after over before",
            Self::SmoothedSpeed => "speeds are means over some time",
            Self::Skew => "the speed is older than the location",
            Self::OtherUnit => "a column holds another unit: location over speed is off by a factor",
            Self::Impossible => "readings are no numbers, or beyond what any train or line has",
            Self::SpeedSpikes => "single speeds far from their neighbours",
            Self::MissingReadings => "rows without a location or without a speed",
            Self::OtherChainage => "the locations are off from those of other runs by the same everywhere",
            Self::TurnedChainage => {
                "the locations count from the other end of the line: their sum with those of other runs"
            }
            Self::DeadZone => "the speed reads zero below a threshold: readings of zero beside movement",
            Self::HeldSpeeds => "the speed repeats its last value in some rows and catches up after them",
            Self::AboveSpeedLimit => "speeds are above the described limits",
            Self::AboveTraction => "measured efforts are above the described tractive effort",
            Self::AboveBrake => "measured efforts are beyond the described brake",
            Self::EffortApart => "measured efforts do not go with the train's acceleration: correlation",
            Self::EffortSteps => "measured efforts have steps too large for a resistance:",
            Self::EffortUnlike => {
                "efforts are unlike those of the other runs: acceleration for the effort, over theirs"
            }
            Self::UnsignedBrake => "efforts are above zero while the train brakes",
            Self::EffortHeld => "efforts stand still, as the last one that arrived does, for a mean of",
            Self::EffortLate => "measured efforts are older than the speed (below zero: the speed is)",
            Self::EffortOffset => "the effort of a train that stands is not 0 but",
            Self::EffortZeros => "the effort is 0 while the train brakes or holds its speed",
            Self::OutOfOrder => "rows are out of order",
            Self::Interpolated => "rows lie on straight lines between readings so far apart",
            Self::CoarseClock => "rows have the time of the row before, and other readings",
            Self::SharedRows => "the log shares rows with another one",
            Self::SameRows => "the log holds the same rows as another one",
        }
    }

    /// What one can do about it, where there is something.
    pub fn remedy(self) -> Option<&'static str> {
        match self {
            Self::TwoDirections => Some("cut the log where the train turns"),
            Self::OtherUnit => Some(
                "convert the column to the unit of its name; `rundown import` does with a --mapping that it prints",
            ),
            Self::SpeedScale | Self::LocationScale => {
                Some("compare the wheel diameter of the recorder, or the length of the track")
            }
            Self::SmoothedSpeed => {
                Some("record momentary speeds; starts, stops and coasts begin and end within so long")
            }
            Self::WheelChange => Some("look when the wheels were turned, or their diameter was entered"),
            Self::Interpolated => Some("export the rows of the recorder"),
            Self::SpeedOffset => Some("r(v) is learned at speeds that are off by as much"),
            Self::CoarseClock => Some("write the times as fine as the rows"),
            Self::SharedRows => Some("cut what is there twice: it teaches twice"),
            Self::StuckSpeed | Self::StuckLocation => Some("look at the sensor"),
            Self::Reset => Some("give the chainage where the log begins again"),
            Self::AboveSpeedLimit => Some("look whether the logs and the speed limits belong to this line"),
            Self::AboveTraction | Self::AboveBrake => {
                Some("look whether train and mass are the described ones, and in which unit the effort is")
            }
            Self::EffortZeros => Some("leave the field empty where no effort is recorded"),
            Self::EffortApart => Some("look at the column: which train's, which sign, which clock"),
            Self::EffortUnlike => {
                Some("look at the column: is it in another unit, halved, cut off, frozen, another train's?")
            }
            Self::UnsignedBrake => Some("write the effort of a brake below zero"),
            Self::EffortHeld => Some("look at the column: does a signal freeze, or come late?"),
            Self::EffortSteps => Some("record the effort with more digits"),
            Self::OtherChainage | Self::TurnedChainage => {
                Some("bring the runs onto one chainage: `rundown import --chainage align`")
            }
            _ => None,
        }
    }
}

impl Done {
    /// In words.
    pub fn words(self) -> &'static str {
        match self {
            Self::PutRight => "put right",
            Self::LeftOut => "left out",
            Self::Said => "not changed",
            Self::Refused => "the run is not used",
        }
    }
}

impl Finding {
    /// It is a defect of the log. That speeds are rounded to the nearest step is none: every display does, and their mean is right.
    pub fn is_defect(&self) -> bool {
        self.kind != Kind::RoundedSpeed
    }

    /// The figure with its 95 % interval, where it has one, and its unit.
    pub fn how_much(&self) -> String {
        let Self { figure, unit, .. } = self;
        let decimals = if *unit == "rows" { 0 } else { decimals(figure) };
        let mut text = match figure.sd > 0.0 {
            true => figure.with_interval(decimals),
            false => format!("{:.decimals$}", figure.value),
        };
        if !unit.is_empty() {
            text += &format!(" {unit}");
        }
        text
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { kind, count, line, done, .. } = self;
        if *line > 0 {
            write!(f, "line {line}: ")?;
        }
        write!(f, "{}: {}", kind.words(), self.how_much())?;
        if *count > 1 {
            write!(f, ", {count} times")?;
        }
        write!(f, "; {}", done.words())?;
        kind.remedy().map_or(Ok(()), |remedy| write!(f, ": {remedy}"))
    }
}

/// Digits after the point that the standard deviation deserves.
fn decimals(figure: &Figure) -> usize {
    let size = if figure.sd > 0.0 { figure.sd } else { figure.value.abs() / 100.0 };
    if size <= 0.0 { 0 } else { (1.0 - size.log10()).ceil().clamp(0.0, 6.0) as usize }
}
