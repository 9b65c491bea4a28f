//! Where recorded runs and the believed model disagree, which effect is missing, and what remains of the gap with it.
//!
//! ```text
//! runs, train, track                                        Input
//!      |  wheels, lag, age of the effort, locations         readings/
//!      v
//! intervals of 10 s --> residuals                           data/, coasting (without an effort column), efforts
//!      |                    |
//!      |                    v
//!      |               noise, differences between runs      noise/
//!      |                    |
//!      v                    v
//! limits of traction   missing terms, their rivals          traction/, search/ among candidates/
//!      \                   /
//!       v                 v
//!      named effects, intervals, confidence                 naming/
//!               |
//!               v
//!      hold-out runs simulated before and after             holdout/, evidence
//!               |
//!               v
//!      gap.json, page, story, tables, model, frame          Answer
//! ```
//!
//! The thresholds and priors by which it decides are in [`GapConfig`], those of what recorders did to their logs in
//! [`rundown_check`]; everything about one kind of effect is in its file below `candidates/`.
//!
//! ```no_run
//! use rundown_gap::config::GapConfig;
//! use rundown_gap::{input::Input, run};
//!
//! let input = Input::of_set("set".as_ref())?;
//! let answer = run(input, GapConfig::default(), None, |step| eprintln!("{step}"))?;
//! for one in &answer.found.named {
//!     println!("{} with confidence {:.2}", one.effect.name(), one.confidence);
//! }
//! answer.write("gap".as_ref(), true)?; // with a page for each run
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
#![forbid(unsafe_code)]
#![warn(missing_docs)]

mod admission;
mod analysis;
pub mod answer;
mod axis;
mod candidate;
pub mod candidates;
mod chance;
mod coasting;
mod columns;
pub mod config;
mod data;
mod efforts;
mod evidence;
mod explained;
mod findings;
mod fit;
pub mod holdout;
pub mod input;
pub mod investigation;
mod leap;
pub mod levels;
pub mod named;
mod naming;
mod noise;
pub mod readings;
pub mod refusal;
mod search;
mod slopes;
mod traction;
pub mod trial;
mod trials;
pub mod verdict;
mod wording;

pub use candidate::{HiddenSize, Hide};

use admission::admitted;
use answer::rivals::rivals;
use answer::whole::{Answer, repaired};
use config::GapConfig;
use data::believed::{Believed, Conditions, Context};
use holdout::innovations::innovations;
use input::Input;
use investigation::investigate;
use refusal::Refusal;
use rundown_files::recording::Recording;

/// Does all of it. `hold_out`: how many runs evaluate the repaired model; a fifth without it. `progress` gets a line
/// for each step.
///
/// # Errors
/// [`Refusal`]: too few runs, or to hold out so many; runs that are not on the track, in another unit of effort, or
/// have too little to compare; or more effects than a board takes.
pub fn run(
    input: Input,
    config: GapConfig,
    hold_out: Option<usize>,
    mut progress: impl FnMut(&str),
) -> Result<Answer, Refusal> {
    let given = Context {
        believed: Believed::new(&input.train, &input.track),
        surroundings: &input.surroundings,
        conditions: Conditions::default(),
        config: &config,
    };
    admitted(&input, &given, hold_out)?;
    let runs = input.runs.len();
    let found = investigate(&given, &input.runs, hold_out, &mut progress)?.ok_or(Refusal::TooLittle { runs })?;
    progress("who else would explain it");
    let context = Context { conditions: found.findings.conditions, ..given };
    let rivals = rivals(&found.named, &found.findings, &context);
    progress("the estimator's innovations with both models");
    let held_out: Vec<&Recording> = found.held_out.iter().filter_map(|i| input.recordings.get(*i)).collect();
    let innovations = innovations(&input.train, &input.track, &repaired(&found, &input), &held_out)?;
    Ok(Answer { input, config, found, rivals, innovations })
}
