//! Whether these runs can be compared with this model at all: asked before anything is searched.

use crate::config::{GapConfig, TrackConfig};
use crate::data::believed::Context;
use crate::data::rows::Row;
use crate::efforts::rows_as_read;
use crate::input::Input;
use crate::investigation::most_held_out;
use crate::leap::leap;
use crate::readings::brakes::{needed, powered_hard};
use crate::readings::delay::{self, delay};
use crate::refusal::Refusal;
use crate::slopes;
use rundown_check::figure::Figure;
use rundown_files::off_track::OffTrack;
use rundown_files::statistics::median;

/// # Errors
/// [`Refusal`]: why they cannot.
pub fn admitted(input: &Input, given: &Context<'_>, hold_out: Option<usize>) -> Result<(), Refusal> {
    let config = given.config;
    let (runs, least) = (input.runs.len(), config.holdout.least_training);
    if runs < least {
        return Err(Refusal::TooFew { runs, left_out: input.left_out, first: input.first_left_out.clone(), least });
    }
    let most = most_held_out(runs, &config.holdout);
    if let Some(wanted) = hold_out.filter(|wanted| *wanted > most) {
        return Err(Refusal::HoldOut { wanted, most, runs, least });
    }
    let (sd_permille, most_permille) =
        (input.track_file.gradient_sd_permille(), config.track.most_gradient_sd_permille);
    if sd_permille > most_permille {
        return Err(Refusal::Gradients { sd_permille, most_permille });
    }
    let most = config.track.most_off_share;
    if let Some(off) = off_track(input, config).filter(|off| off.share() > most) {
        return Err(Refusal::OffTrack { off, most_percent: 100.0 * most });
    }
    if let Some(leap) = leap(&input.runs, config) {
        return Err(Refusal::Leap { leap, all: runs });
    }
    let mut rows = rows_as_read(given, &input.runs).unwrap_or_default();
    if wrong_factor(given, &rows).is_some() {
        // On short hops a column that is late has little to do with the motion.
        let late = delay(given, &input.runs, false);
        let moved = delay::put_right(given, &input.runs, late.reading, late.delay_s.map_or(0.0, |late| late.value));
        rows = rows_as_read(given, &moved).unwrap_or_default();
    }
    match wrong_factor(given, &rows) {
        Some(factor) => Err(Refusal::EffortColumn { factor }),
        None => slopes(input, given, &rows),
    }
}

/// What no gain of a column explains.
fn wrong_factor(given: &Context<'_>, rows: &[Row]) -> Option<f64> {
    let most = given.config.effort.most_factor;
    effort_factor(given, rows).filter(|factor| !(1.0 / most..=most).contains(factor))
}

/// The described slopes are those of the line: by the effort column, and without one, or where it does not show them,
/// by the coasts.
fn slopes(input: &Input, given: &Context<'_>, rows: &[Row]) -> Result<(), Refusal> {
    let TrackConfig { most_slope_factor: most, slope_sure: sure, most_gradient_sd_permille, .. } = given.config.track;
    if given.surroundings.is_level
        && let Some(found) = slopes::of_level(given, rows).filter(|found| *found > most_gradient_sd_permille)
    {
        return Err(Refusal::NotLevel { sd_permille: found });
    }
    let found = slopes::factor(given, rows);
    // From the nearest factor that is taken for right.
    let beyond = |factor: &Figure| factor.away_from(factor.value.max(1.0 / most).min(most));
    match (found, input.gradient_doubt) {
        (Some(factor), _) if beyond(&factor) > sure => {
            Err(Refusal::Slopes { factor: factor.value, sd: factor.sd, most })
        }
        // Slopes that the effort column confirms are right, whatever coasts look like.
        (Some(factor), _) if beyond(&factor) == 0.0 && factor.away_from(0.0) > sure => Ok(()),
        (_, Some(doubt)) if doubt.is_decisive() => Err(Refusal::WrongGradients { doubt }),
        _ => Ok(()),
    }
}

/// Locations that are not on the described track.
pub fn off_track(input: &Input, config: &GapConfig) -> Option<OffTrack> {
    let mut off = OffTrack::new(&input.track_file, config.interval.beyond_m);
    input.runs.iter().for_each(|run| off.add(&run.samples));
    off.any()
}

/// How many times the effort that the motion of the train needs the column has, where trains are driven hardest: there
/// the acceleration outweighs what is not known of resistance and gradients. None from too few intervals.
fn effort_factor(given: &Context<'_>, rows: &[Row]) -> Option<f64> {
    // By the motion: of a brake the column may have a part.
    let hardest = powered_hard(rows);
    if hardest.len() < given.config.search.least_rows {
        return None;
    }
    median(hardest.iter().map(|row| row.effort_n_per_kg / needed(row)))
}
