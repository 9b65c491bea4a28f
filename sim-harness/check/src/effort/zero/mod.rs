//! What an effort column has for no effort: a zero that is off, and zeros that are no effort of 0 but none that is
//! known.
//!
//! In: rows of all runs of a unit, put right. Out: the reading of trains that stand; and how many trains hold their
//! speed or brake with an effort of 0.
//!
//! A constant on the effort goes into the resistance one to one, and at standstill it is seen alone. A column that has
//! traction only, or drops what is small, has zeros where a coast has them: as measurements of a coast they would teach
//! the deceleration of the brake, or no resistance at all.

pub(crate) mod of_run;

use crate::effort::coasting::CoastingEffort;
use crate::effort::stretches;
use crate::figure::Figure;
use crate::{Known, SURE};
use rundown::model::line::Line;
use rundown_files::recording::Recording;
use rundown_files::sample::Sample;
use rundown_files::statistics::{extremes, mean_of, median};
use std::ops::Range;

/// So many rows at standstill tell the zero, and this share of them has it within [`SAME_N_PER_KG`].
const LEAST_STANDING: usize = 20;
const MOST_STANDING: f64 = 0.8;
const SAME_N_PER_KG: f64 = 2e-4;
/// More than this is the brake that holds the train, not a zero, N/kg.
const LARGEST_ZERO_N_PER_KG: f64 = 0.02;

/// Regimes are looked for in stretches of so long, s.
const STRETCH_S: f64 = 20.0;
/// A train that slows down faster than this brakes, m/s²: on any gradient of a railway a coast is slower.
const BRAKES_MPS2: f64 = 0.45;
/// A slope that overcomes this share of the described resistance may hold a coasting train, whose own is another one;
/// on a steeper one it gains speed.
const DRIVEN: Range<f64> = 0.5..2.0;
/// The same of its own resistance, which trains with efforts of 0 mostly show.
const AROUND_USUAL: Range<f64> = 0.7..1.4;
/// A train at this speed, m/s, that changes it by less than this over a stretch, m/s, holds it, on gradients that
/// repeat in both directions or not.
const HOLDS_FROM_MPS: f64 = 12.0;
const HOLDS_WITHIN_MPS: f64 = 0.15;
/// A smaller effort below zero is noise around none, N/kg.
const LEAST_BRAKE_N_PER_KG: f64 = 0.01;
/// Where no effort is ever below that, so many stops tell that the column has no brake: of a train that runs out on the
/// level none would be seen.
const LEAST_STOPS: usize = 5;
/// So many such stretches, and this share of them with zeros, tell.
const LEAST_STRETCHES: usize = 20;
const LEAST_SHARE: f64 = 0.7;
/// So many fast stretches are enough to see a zero in.
const LEAST_MOVES: usize = 100;
/// Where slopes are described, a train keeps its speed that changes it by less than this, m/s; whole km/h hide whether
/// it holds it. So many stretches with zeros are more than slopes, where the column has a gap above 0.
const KEEPS_WITHIN_MPS: f64 = 0.3;
const LEAST_KEPT: usize = 5;
/// Held speeds are this share of the stretches with zeros: fewer are coasts on slopes that just keep the speed.
const LEAST_OF_ZEROS: f64 = 0.4;
/// A zero is none of a coast from where the train slows down faster than this, m/s², until it powers again, and for so
/// long before, s.
const SLOWS_MPS2: f64 = 0.15;
const BEFORE_S: f64 = 10.0;

/// The effort that the column has where trains stand, N/kg, and in how many rows; nothing where it differs, or a brake
/// holds them.
pub(crate) fn at_standstill<'a>(recordings: impl Iterator<Item = &'a Recording>) -> Option<(Figure, usize)> {
    let standing = recordings.flat_map(|recording| {
        // The rows beside it may hold the mean of an interval in which the train still moved.
        recording.rows.windows(3).filter(|rows| rows.iter().all(|row| row.speed_mps == Some(0.0)))
    });
    let efforts: Vec<f64> = standing.filter_map(|rows| rows[1].effort_n_per_kg).collect();
    let zero = median(&efforts)?;
    let same: Vec<f64> = efforts.iter().copied().filter(|effort| (effort - zero).abs() < SAME_N_PER_KG).collect();
    let is_one = same.len() as f64 >= MOST_STANDING * efforts.len() as f64;
    let value = mean_of(&same);
    (same.len() >= LEAST_STANDING && is_one && zero.abs() < LARGEST_ZERO_N_PER_KG)
        .then_some((Figure { value, sd: 0.0 }, same.len()))
}

/// The zero of an effort column.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Zero {
    pub(crate) figure: Figure,
    /// By how much it may be wrong: all of it, where something that acts may look so, else what rounding hides, N/kg.
    pub(crate) doubt_n_per_kg: f64,
    /// Something that acts may look so.
    pub(crate) may_act: bool,
    /// In what.
    pub(crate) seen: String,
}

/// What trains that stand and trains that coast say together.
pub(crate) fn decided(standing: Option<(Figure, usize)>, coasts: Option<CoastingEffort>) -> Option<Zero> {
    let of_coasts = |one: &CoastingEffort| format!("in {} stretches of 20 s of trains that coast", one.count);
    let of_standing = |count: usize| format!("in {count} rows of trains that stand");
    match (standing, coasts) {
        (Some((stands, count)), Some(coasting)) => {
            let apart = (stands.value - coasting.effort.value).abs();
            if apart < SAME_N_PER_KG.max(SURE * coasting.effort.sd) {
                let (coasted, stood) = (of_coasts(&coasting), of_standing(count));
                let seen = format!("{coasted}, and {stood}");
                let doubt_n_per_kg = coasting.rounded_n_per_kg;
                return Some(Zero { figure: coasting.effort, doubt_n_per_kg, may_act: false, seen });
            }
            if !is_off(stands) && !coasting.is_sure {
                // The column is right, and the motors drag.
                return Some(Zero { figure: stands, doubt_n_per_kg: 0.0, may_act: false, seen: of_standing(count) });
            }
            // A train that stands may hold a light brake.
            decided(None, Some(coasting))
        }
        (None, Some(coasting)) => {
            let may_act = !coasting.is_sure;
            let by_acting = if may_act { coasting.effort.value.abs() } else { 0.0 };
            let doubt_n_per_kg = by_acting + coasting.rounded_n_per_kg;
            Some(Zero { figure: coasting.effort, doubt_n_per_kg, may_act, seen: of_coasts(&coasting) })
        }
        (Some((stands, count)), None) => {
            let doubt_n_per_kg = stands.value.abs();
            Some(Zero { figure: stands, doubt_n_per_kg, may_act: true, seen: of_standing(count) })
        }
        (None, None) => None,
    }
}

/// More than noise around 0.
pub(crate) fn is_off(zero: Figure) -> bool {
    zero.value.abs() >= SAME_N_PER_KG && zero.away_from(0.0) > SURE
}

/// Stretches of moving trains, and how many of them have efforts of 0 throughout.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Stretches {
    pub all: usize,
    pub with_zeros: usize,
}

impl Stretches {
    fn add(&mut self, is_zero: bool) {
        self.all += 1;
        self.with_zeros += usize::from(is_zero);
    }

    fn tell(self) -> bool {
        self.are(LEAST_STRETCHES)
    }

    fn are(self, least: usize) -> bool {
        self.all >= least && self.with_zeros as f64 >= LEAST_SHARE * self.all as f64
    }
}

/// By what a moving train does.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Zeros {
    pub brakes: Stretches,
    pub stops: Stretches,
    /// An effort below zero was read while the train moved.
    shows_brakes: bool,
    pub holds: Stretches,
    /// Stretches with zeros in which the train keeps its speed.
    pub kept: usize,
    /// Whatever it does.
    moves: Stretches,
}

impl Zeros {
    /// The column has no brake: its zeros are none while the train brakes.
    pub fn lack_the_brake(&self) -> bool {
        self.brakes.tell()
    }

    /// Trains keep their speed with an effort of 0, though most do not.
    pub fn keep_some(&self) -> bool {
        self.kept >= LEAST_KEPT
    }

    /// The column has traction only: no zero is surely that of a coast.
    pub fn never_show_a_brake(&self) -> bool {
        !self.shows_brakes && self.stops.are(LEAST_STOPS)
    }

    /// Enough trains move to see what they do.
    pub fn are_of_many(&self) -> bool {
        self.moves.all >= LEAST_MOVES
    }

    /// The column drops what is small: no zero is one.
    pub fn drop_what_is_small(&self) -> bool {
        let share = self.holds.with_zeros as f64 / self.moves.with_zeros.max(1) as f64;
        self.holds.tell() && share >= LEAST_OF_ZEROS
    }
}

/// Takes the efforts out that are 0.
pub(crate) fn leave_out_zeros(rows: &mut [Sample]) -> usize {
    let zeros = rows.iter_mut().filter(|row| row.effort_n_per_kg == Some(0.0));
    zeros.map(|row| row.effort_n_per_kg = None).count()
}

/// Takes the efforts of 0 out while the train brakes.
pub(crate) fn leave_out_brakes(rows: &mut [Sample]) -> usize {
    let (mut count, mut from) = (0, 0);
    while from < rows.len() {
        let is_zero = |row: &Sample| row.effort_n_per_kg == Some(0.0);
        let long = rows[from..].iter().take_while(|row| is_zero(row)).count();
        let zeros = &mut rows[from..from + long];
        let slows = |after: &&[Sample]| {
            let speeds = after[0].speed_mps.zip(after[after.len() - 1].speed_mps);
            let long_s = after[after.len() - 1].time_s - after[0].time_s;
            speeds
                .is_some_and(|(first, last)| first > 0.0 && last - first < -SLOWS_MPS2 * long_s.max(f64::MIN_POSITIVE))
        };
        let first_s = zeros.windows(3).find(slows).map(|rows| rows[0].time_s - BEFORE_S);
        let braking = zeros.iter_mut().filter(|row| first_s.is_some_and(|first_s| row.time_s >= first_s));
        count += braking.map(|row| row.effort_n_per_kg = None).count();
        from += long.max(1);
    }
    count
}

/// A stretch of a moving train.
struct Moving {
    is_zero: bool,
    /// The speed stays within a narrow band.
    holds: bool,
    /// It is about the same at the end.
    keeps: bool,
    /// What slopes and the loss of speed take off it, of the described resistance: about 1 of a coast.
    driven: Option<f64>,
}

/// Slopes and the loss of speed over the described resistance.
fn driven(line: &Line<'_>, rows: &[Sample], mps2: f64) -> f64 {
    let driven = rows.iter().filter_map(|row| Some(-line.gradient_n_per_kg(row.location_m?) - mps2));
    let resistances = rows.iter().filter_map(|row| Some(line.train.davis().resistance_n_per_kg(row.speed_mps?)));
    driven.sum::<f64>() / resistances.sum::<f64>()
}

/// How much of the described resistance those have that coast, by what is usual where the efforts are 0.
fn of_coasts(all: &[Moving]) -> Range<f64> {
    let of_zeros: Vec<f64> = all.iter().filter(|one| one.is_zero).filter_map(|one| one.driven).collect();
    match median(&of_zeros) {
        Some(usual) if of_zeros.len() >= LEAST_STRETCHES && DRIVEN.contains(&usual) => {
            AROUND_USUAL.start * usual..AROUND_USUAL.end * usual
        }
        _ => DRIVEN,
    }
}

/// The last [`STRETCH_S`] of a train that slows down to a stop by more than [`SLOWS_MPS2`], where each row has a speed
/// and an effort.
fn stops(rows: &[Sample]) -> impl Iterator<Item = &[Sample]> {
    let is_moving = |row: &Sample| row.speed_mps.is_some_and(|mps| mps > 0.0);
    let ends = (1..rows.len()).filter(move |i| is_moving(&rows[i - 1]) && rows[*i].speed_mps == Some(0.0));
    ends.filter_map(|end| {
        let begin = rows[..end].partition_point(|row| row.time_s < rows[end].time_s - STRETCH_S);
        let stop = &rows[begin..end];
        let is_complete = stop.iter().all(|row| row.speed_mps.is_some() && row.effort_n_per_kg.is_some());
        let slows = stop.first()?.speed_mps? > SLOWS_MPS2 * STRETCH_S;
        (is_complete && slows).then_some(stop)
    })
}

/// Of all runs of a unit. Where the described slopes explain that a train holds its speed, a zero is one.
pub(crate) fn zeros<'a>(recordings: impl Iterator<Item = &'a Recording>, known: &Known) -> Zeros {
    let (mut found, mut moving) = (Zeros::default(), Vec::new());
    for recording in recordings {
        let is_brake = |row: &Sample| {
            row.speed_mps > Some(0.0) && row.effort_n_per_kg.is_some_and(|effort| effort < -LEAST_BRAKE_N_PER_KG)
        };
        found.shows_brakes |= recording.rows.iter().any(is_brake);
        for rows in stops(&recording.rows) {
            found.stops.add(rows.iter().all(|row| row.effort_n_per_kg == Some(0.0)));
        }
        for rows in stretches(&recording.rows, STRETCH_S) {
            let (low, high) = extremes(rows.iter().filter_map(|row| row.speed_mps));
            let (first, last) = (&rows[0], &rows[rows.len() - 1]);
            let long_s = last.time_s - first.time_s;
            let rate = (last.speed_mps.unwrap_or_default() - first.speed_mps.unwrap_or_default()) / long_s;
            let is_zero = rows.iter().all(|row| row.effort_n_per_kg == Some(0.0));
            if rate < -BRAKES_MPS2 {
                found.brakes.add(is_zero);
            }
            if low <= HOLDS_FROM_MPS {
                continue;
            }
            let holds = high - low < HOLDS_WITHIN_MPS;
            let line = known.line(recording.direction);
            let keeps = holds || (line.is_some() && (rate * long_s).abs() < KEEPS_WITHIN_MPS);
            moving.push(Moving { is_zero, holds, keeps, driven: line.map(|line| driven(&line, rows, rate)) });
        }
    }
    let of_coasts = of_coasts(&moving);
    for Moving { is_zero, holds, keeps, driven } in moving {
        let is_slope = keeps && driven.is_some_and(|driven| of_coasts.contains(&driven));
        if keeps && !is_slope {
            found.kept += usize::from(is_zero);
        }
        if !(holds && is_slope) {
            found.moves.add(is_zero);
            if holds {
                found.holds.add(is_zero);
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn trains_that_stand_and_trains_that_coast_decide_together() {
        let stands = |value| Some((Figure { value, sd: 0.0 }, 60));
        let coasts = |value, is_sure| {
            let effort = Figure { value, sd: 1e-5 };
            Some(CoastingEffort { effort, count: 80, is_sure, rounded_n_per_kg: 5e-4 })
        };
        let said = |standing, coasting| {
            let zero: Zero = decided(standing, coasting).unwrap();
            (zero.figure.value, (1e6 * zero.doubt_n_per_kg).round(), zero.may_act)
        };
        assert_eq!(said(stands(0.004), coasts(0.004, false)), (0.004, 500.0, false), "both say so");
        assert_eq!(said(stands(0.0), coasts(-0.004, false)), (0.0, 0.0, false), "motors that drag");
        assert_eq!(said(stands(-0.01), coasts(0.0, false)), (0.0, 500.0, true), "a light brake");
        assert_eq!(said(None, coasts(-0.004, false)), (-0.004, 4500.0, true), "one or the other");
        assert_eq!(said(None, coasts(-0.012, true)), (-0.012, 500.0, false), "more than motors drag");
        assert_eq!(said(stands(0.002), None), (0.002, 2000.0, true));
        assert_eq!(decided(None, None), None);
    }
}
