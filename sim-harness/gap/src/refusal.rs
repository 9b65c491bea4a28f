//! Why there is no answer.

use rundown::model::effects::EffectError;
use rundown_files::refusal::ReadError;
use thiserror::Error;

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
    /// No run has enough.
    #[error(
        "{runs} runs have too little to compare: expected moving samples with location and speed, and an effort column or long coasting; nothing was written"
    )]
    TooLittle {
        /// How many runs there are.
        runs: usize,
    },
    /// What was found is more than a board takes.
    #[error("what was found cannot be put into a model: {0}; nothing was written")]
    Effects(#[from] EffectError),
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
