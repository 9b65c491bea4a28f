//! One thing that is the matter with a log: what, how much, where, and what was done.

use crate::figure::Figure;
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt;

/// Each kind, what it is in words, and what one can do about it, where there is something.
macro_rules! kinds {
    ($($Kind:ident $words:literal $(=> $remedy:literal)?;)*) => {
        /// What is the matter.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize)]
        #[serde(rename_all = "snake_case")]
        pub enum Kind {
            $(#[doc = $words] $Kind,)*
        }

        impl Kind {
            /// What it is, in words.
            pub fn words(self) -> &'static str {
                match self { $(Self::$Kind => $words,)* }
            }

            /// What one can do about it, where there is something.
            pub fn remedy(self) -> Option<&'static str> {
                match self { $(Self::$Kind => None $(.or(Some($remedy)))?,)* }
            }
        }
    };
}

kinds! {
    Midnight "the clock goes back at midnight";
    ClockSetBack "the clock was set back";
    ClockSetForward "the clock was set forward";
    LostSeconds "rows hold one second more than their clock says";
    MissingStandstill "no rows while standing";
    Gaps "gaps while moving";
    Wrap "the odometer began again at zero";
    Reset "the locations began again elsewhere" => "give the chainage where the log begins again";
    NoLocation "locations that stand for none, far from those around them, which agree with each other"
        => "leave the field empty where no location is known";
    LocationSpikes "single locations far from their neighbours";
    StuckLocation "the location stands still while the train runs" => "look at the sensor";
    StuckSpeed "the speed stays the same while the locations say otherwise" => "look at the sensor";
    SaturatedSpeed "speeds end at a largest value, beyond which the train runs"
        => "look at the range of the signal: what is beyond it was not recorded";
    TwoDirections "the train goes there and back in one log" => "cut the log where the train turns";
    RoundedSpeed "speeds are rounded to the nearest step";
    TruncatedSpeed "speeds are truncated to the step below";
    RoundedUpSpeed "speeds are rounded up to the step above";
    SteppedSpeed "speeds have a step; rounded or truncated is not known";
    RewrittenSpeed "speeds are counted in one unit and written in steps of another, which is taken back: unit"
        => "export the speeds in the unit of the recorder, or with more digits";
    ComputedSpeed "speeds were computed from the locations, and say nothing beyond them";
    SpeedOffset "the speed is off by the same everywhere: true less read"
        => "look at the zero of its sensor; where it is not changed r(v) is learned at speeds that are off by as much";
    SpeedScale "the speed is off by a factor: read over true"
        => "compare the wheel diameter of the recorder, or the length of the track";
    Creep "the speed reads more while it rises than while it falls or the train brakes, as of wheels that creep while they power: by"
        => "take the speed from an axle that is not driven, or from a radar";
    WheelChange "the speed's scale changes: after over before"
        => "look when the wheels were turned, or their diameter was entered";
    TrailingSpeed "speeds trail behind the train in a filter of first order: time constant";
    SmoothedSpeed "speeds are means over some time"
        => "record momentary speeds; starts, stops and coasts begin and end within so long";
    Skew "the speed is older than the location";
    LocationScale "the locations are off by a factor beside the described stops: read over described"
        => "compare the wheel diameter of the recorder, or the length of the track";
    DriftingLocation "the location drifts between corrections that bring it back, by this of the way"
        => "look at the diameter of the wheel that counts the way";
    OtherUnit "a column holds another unit: location over speed is off by a factor"
        => "convert the column to the unit of its name; `rundown import` does with a --mapping that it prints";
    Impossible "readings are no numbers, or beyond what any train or line has";
    SpeedSpikes "single speeds far from their neighbours";
    MissingReadings "rows without a location or without a speed";
    SameRows "the log holds the same rows as another one";
    AboveSpeedLimit "speeds are above the described limits"
        => "look whether the logs and the speed limits belong to this line";
    AboveTraction "measured efforts are above the described tractive effort"
        => "look whether train and mass are the described ones, and in which unit the effort is";
    AboveBrake "measured efforts are beyond the described brake"
        => "look whether train and mass are the described ones, and in which unit the effort is";
    EffortApart "measured efforts do not go with the train's acceleration: correlation"
        => "look at the column: which train's, which sign, which clock";
    EffortDemanded "efforts are what the lever asks for, or are cut off at a maximum, and not what acts: the fast train needs this share of them, where the slow one needs all"
        => "record the effort that the traction gives";
    EffortSmall "small efforts have this many times the gain of large ones, as speeds that are held on slopes show beside starts and coasts"
        => "calibrate the column where little effort is asked for";
    EffortCut "efforts are cut off at a maximum, where the motion of the trains needs this many times as much"
        => "look at the range of the column's signal";
    EffortSteps "measured efforts have steps too large for a resistance:" => "record the effort with more digits";
    EffortUnlike "efforts are unlike those of the other runs: acceleration for the effort, over theirs"
        => "look at the column: is it in another unit, halved, cut off, frozen, another train's?";
    UnsignedBrake "efforts are above zero while the train brakes" => "write the effort of a brake below zero";
    EffortHeld "efforts stand still, as the last one that arrived does, for a mean of"
        => "look at the column: does a signal freeze, or come late?";
    EffortLate "measured efforts are older than the speed (below zero: the speed is)";
    EffortOffset "the zero of the effort is off: trains that coast, or stand without a brake, have";
    EffortZerosDiffer "the zero of the effort differs from run to run, by (standard deviation)"
        => "look when the sensor of the effort is set to zero";
    EffortZeroUnseen "nothing shows the zero of the effort, as no trains coast for 20 s or stand without a brake: taken on trust, in"
        => "compare r with what --mode gated learns";
    EffortZeros "the effort is 0 while the train brakes or holds its speed"
        => "leave the field empty where no effort is recorded";
    DeadZone "the speed reads zero below a threshold: readings of zero beside movement";
    HeldSpeeds "the speed repeats its last value in some rows and catches up after them";
    Stairs "the speed stands still from row to row and then changes at once, by"
        => "record the speed of each row; of a coast a few readings are left";
    Slips "the wheels slip while the train powers: the speed reads too much, by"
        => "look at the wheel slide protection, or take the speed from an axle that is not driven";
    Slides "the wheels slide while the train brakes: the speed reads too little, by"
        => "look at the wheel slide protection, or take the speed from an axle that is not braked";
    EffortStairs "the effort stands still from row to row and then changes at once, by" => "record the effort of each row";
    OutOfOrder "rows are out of order";
    Bursts "rows are stamped when they arrive, so many at once" => "write the time of the reading";
    CoarseClock "rows have the time of the row before, and other readings" => "write the times as fine as the rows";
    Interpolated "rows lie on straight lines between readings so far apart" => "export the rows of the recorder";
    Bridged "a straight line bridges rows without a reading, as of a receiver in a tunnel: off, by the speeds, by up to"
        => "export the rows as they were received";
    SharedRows "the log shares rows with another one" => "cut what is there twice: it teaches twice";
    OtherChainage "the locations are off from those of other runs by the same everywhere"
        => "bring the runs onto one chainage: `rundown import --chainage align`";
    TurnedChainage "the locations count from the other end of the line: their sum with those of other runs"
        => "bring the runs onto one chainage: `rundown import --chainage align`";
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

impl Done {
    /// What it is, in words.
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
    /// It is a defect of the log. That speeds are rounded to the nearest step is none: every display does, and their
    /// mean is right. Nor is that a receiver gives no speeds.
    pub fn is_defect(&self) -> bool {
        !matches!(self.kind, Kind::RoundedSpeed | Kind::ComputedSpeed)
    }

    /// It changed a reading, or spoils results and was not changed.
    pub(crate) fn spoils(&self) -> bool {
        match self.done {
            Done::PutRight | Done::LeftOut => true,
            Done::Refused => false,
            Done::Said => matches!(
                self.kind,
                Kind::AboveBrake
                    | Kind::AboveSpeedLimit
                    | Kind::AboveTraction
                    | Kind::Bursts
                    | Kind::CoarseClock
                    | Kind::Creep
                    | Kind::EffortApart
                    | Kind::EffortLate
                    | Kind::EffortSteps
                    | Kind::EffortZeroUnseen
                    | Kind::EffortZerosDiffer
                    | Kind::MissingReadings
                    | Kind::OtherChainage
                    | Kind::Reset
                    | Kind::SharedRows
                    | Kind::Skew
                    | Kind::Slides
                    | Kind::SmoothedSpeed
                    | Kind::SpeedOffset
                    | Kind::TurnedChainage
                    | Kind::WheelChange
            ),
        }
    }

    /// The figure with its 95 % interval, where it has one, and its unit.
    pub fn how_much(&self) -> String {
        let Self { figure, unit, .. } = self;
        let decimals = if ["rows", "runs"].contains(unit) { 0 } else { decimals(figure) };
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

/// A finding as a sentence, with what says so.
pub(crate) fn with_evidence(finding: &Finding, evidence: &BTreeMap<Kind, String>) -> String {
    match evidence.get(&finding.kind) {
        Some(evidence) => format!("{finding} ({evidence})"),
        None => finding.to_string(),
    }
}

/// Digits after the point that the standard deviation deserves.
fn decimals(figure: &Figure) -> usize {
    let size = if figure.sd > 0.0 { figure.sd } else { figure.value.abs() / 100.0 };
    if size <= 0.0 { 0 } else { (1.0 - size.log10()).ceil().clamp(0.0, 6.0) as usize }
}
