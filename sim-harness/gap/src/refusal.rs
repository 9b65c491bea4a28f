//! Why there is no answer.

use crate::leap::Leap;
use rundown::model::effects::EffectError;
use rundown_check::gradients::Doubt;
use rundown_files::off_track::OffTrack;
use rundown_files::refusal::ReadError;
use rundown_files::statistics::MEDIAN_TO_SD;
use rundown_pages::numbers::counted;
use thiserror::Error;

/// ` (2 logs were left out: a.csv: ...)`
fn left_out_words(count: usize, first: Option<&str>) -> String {
    let why = first.map_or_else(String::new, |first| format!(": {first}"));
    if count > 0 { format!(" ({} left out{why})", counted(count, "log was", "logs were")) } else { String::new() }
}

/// Why there is no answer.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum Refusal {
    /// A file or a folder.
    #[error("{text}")]
    Unread {
        /// Names it.
        text: String,
        /// The place in a file, where it is known.
        place: Option<Box<rundown_files::refusal::Refusal>>,
    },
    /// Too few runs.
    #[error(
        "{runs} usable runs{}, expected at least {least}: what one driver or one day does would pass for an effect; nothing was written",
        left_out_words(*left_out, first.as_deref())
    )]
    TooFew {
        /// How many runs there are.
        runs: usize,
        /// How many logs could not be used.
        left_out: usize,
        /// Of the first of them why.
        first: Option<String>,
        /// How many an analysis needs.
        least: usize,
    },
    /// The runs are on another line, or on another chainage.
    #[error("track: {off}. Expected at most {most_percent:.0} % of them; nothing was written")]
    OffTrack {
        /// How many, and where they are.
        off: OffTrack,
        /// The largest share with which anything can be said, %.
        most_percent: f64,
    },
    /// The locations leap at one place.
    #[error(
        "locations: expected as far as the trains go, found {:.0} m {} near km {:.1} in {} of {all} runs: the chainage leaps there, and what is described behind it would be taken for effects. Take the leap out of the locations, or out of the track; nothing was written",
        leap.by_m.abs(),
        if leap.by_m > 0.0 { "further" } else { "less" },
        leap.at_m / 1000.0,
        leap.runs
    )]
    Leap {
        /// Where, and by how much.
        leap: Leap,
        /// How many runs there are.
        all: usize,
    },
    /// The effort column is in another unit, or counts in the other direction.
    #[error(
        "effort column: expected what the motion of the trains needs where they are driven hardest, found {factor:.2} times as much; it looks like {}; nothing was written",
        remedy(*factor)
    )]
    EffortColumn {
        /// Times the effort that is needed.
        factor: f64,
    },
    /// So many runs cannot be held out.
    #[error(
        "--hold-out {wanted}: an analysis needs {least} runs and there are {runs}, so at most {most} can be held out; nothing was written"
    )]
    HoldOut {
        /// How many were to be.
        wanted: usize,
        /// How many can be.
        most: usize,
        /// How many runs there are.
        runs: usize,
        /// How many an analysis needs.
        least: usize,
    },
    /// What is not known of the gradients would be taken for an effect.
    #[error(
        "track: gradients may be off by {sd_permille} permille (standard deviation), expected at most {most_permille}: the gap would be theirs. Describe them, or write gradient_sd_permille = 0 for a line that is flat; nothing was written"
    )]
    Gradients {
        /// Standard deviation of a gradient.
        sd_permille: f64,
        /// The largest with which anything can be said.
        most_permille: f64,
    },
    /// The slopes of the whole track are not those of the line.
    #[error(
        "track: gradients: expected those that the motion of the trains needs, found slopes that fit it when taken {factor:.2} \u{b1} {sd:.2} times (standard deviation over parts of the line): {}; nothing was written",
        misdescribed(*factor, *most)
    )]
    Slopes {
        /// Times the described slopes that the motion needs.
        factor: f64,
        /// Its standard deviation, from parts of the line.
        sd: f64,
        /// The largest factor that is taken for right.
        most: f64,
    },
    /// Coasts or measured efforts say that the gradients are wrong.
    #[error("track: {doubt}; the gap would be theirs; nothing was written")]
    WrongGradients {
        /// What they say.
        doubt: Doubt,
    },
    /// A line that is described as level has slopes.
    #[error(
        "track: gradients: expected a level line, as described, found that the motion of the trains needs slopes beyond {:.1} permille at half of its places: the gap would be theirs. Describe the gradients; nothing was written",
        sd_permille / MEDIAN_TO_SD
    )]
    NotLevel {
        /// Standard deviation of the slopes that the motion needs, from their median.
        sd_permille: f64,
    },
    /// No run has enough.
    #[error(
        "{} too little to compare: expected moving samples with location and speed, and an effort column or long coasting; nothing was written",
        counted(*runs, "run has", "runs have")
    )]
    TooLittle {
        /// How many runs there are.
        runs: usize,
    },
    /// What was found is more than a board takes.
    #[error("what was found cannot be put into a model: {0}; nothing was written")]
    Effects(#[from] EffectError),
}

/// Slopes of which the motion needs less than this are no survey of the line. Judgement.
const ANOTHER_LINE: f64 = 0.3;
/// Less than this share of the needed effort is none. Judgement: beyond all units of forces.
const NO_EFFORT: f64 = 0.01;
/// Efforts that are right but for their sign are within this factor. Judgement: as `effort.most_factor`.
const RIGHT_SIZE: f64 = 1.5;

/// What slopes look like of which the motion needs so many times.
fn misdescribed(factor: f64, most: f64) -> String {
    if (-most..=-1.0 / most).contains(&factor) {
        "the sign is turned (uphill is positive)".to_owned()
    } else if factor < ANOTHER_LINE {
        "they are those of another line, or stand elsewhere along it".to_owned()
    } else if factor < 1.0 {
        format!("they are {:.1} times too steep, or in another unit", 1.0 / factor)
    } else {
        format!("they are {factor:.1} times too gentle, or in another unit")
    }
}

/// What an effort column needs that is off by so much.
fn remedy(factor: f64) -> String {
    if factor.abs() < NO_EFFORT {
        "a column without traction: leave it out".to_owned()
    } else if (-RIGHT_SIZE..-1.0 / RIGHT_SIZE).contains(&factor) {
        "the other sign: turn it (traction is above 0, braking below)".to_owned()
    } else {
        format!("another unit{}: divide it by {factor:.3}", if factor < 0.0 { " and the other sign" } else { "" })
    }
}

impl Refusal {
    /// A file or a folder that cannot be read.
    pub(crate) fn unread(error: ReadError) -> Self {
        let text = error.to_string();
        let place = match error {
            ReadError::Refused(refusal) => Some(Box::new(refusal)),
            _ => None,
        };
        Self::Unread { text, place }
    }
}
