//! Where one run differs from its recorder: another wheel, another age of the speed. Put right in its rows.
//!
//! ```text
//! v = (v_r + o)/s            x(t - τ) = x(t) - ∫ v_r dt from t to t + τ
//! ```
//!
//! The location is moved to the age of the speed, not the speed to that of the location: the steps of a rounded speed
//! stay what they are.

use crate::agreement::{Agreement, pooled};
use crate::figure::Figure;
use crate::finding::{Done, Kind};
use crate::recorder::correction::Correction;
use crate::recorder::diagnosis::RecorderCheck;
use crate::rows::ways;
use crate::run::RunCheck;
use crate::{Known, LEAST_SCALE, SURE, put_right};
use nalgebra::{Matrix2, Vector2};
use rundown_files::sample::Sample;
use std::slice;

/// A run is accused of a skew that its recorder does not have only beyond this, s ...
const LEAST_OWN_SKEW_S: f64 = 1.0;
/// ... and so many standard deviations: those of skews are a little too small.
const OWN_SURE: f64 = 6.0;
/// A smaller offset of one run is a matter of its driver's style, km/h.
const LEAST_OWN_OFFSET_KMH: f64 = 0.3;

/// What is put right in one run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Own {
    grown: Grown,
    correction: Correction,
    /// By how much the speed is older than the location, s; 0 where that stays.
    skew_s: f64,
}

/// By how much more the speeds of a run read high than those of the runs before a change of the wheel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Grown {
    /// All of them.
    pub(crate) all: f64,
    /// Those after a time, s, once more.
    pub(crate) after: Option<(f64, f64)>,
}

impl Grown {
    /// The wheel stays what it is.
    pub(crate) const NOT: Self = Self { all: 1.0, after: None };

    /// Brings all speeds to the scale from before.
    pub(crate) fn undo(&self, rows: &mut [Sample]) {
        for row in rows {
            row.speed_mps = row.speed_mps.map(|mps| mps / self.at(row.time_s));
        }
    }

    fn at(&self, time_s: f64) -> f64 {
        self.after.filter(|(from_s, _)| time_s > *from_s).map_or(self.all, |(_, ratio)| self.all * ratio)
    }
}

/// Scale and skew of a run, its offset known or not; `values`: 1/s - 1 and o/s of its recorder, with their covariance;
/// `ratio`: by which its wheel has changed.
pub(crate) fn judged(
    recorder: &RecorderCheck,
    run: &mut RunCheck,
    (agreement, ratio): (&Agreement, f64),
    (values, covariance): &(Vector2<f64>, Matrix2<f64>),
) {
    run.skew_s = Some(agreement.skew_s(*values, covariance));
    if recorder.has(Kind::Creep) {
        return;
    }
    let scale = pooled(slice::from_ref(agreement)).map(|one| times(one.scale_at(values[1]), ratio));
    run.scale = scale.map(|scale| recorder.beside_the_line(scale));
}

fn times(scale: Figure, ratio: f64) -> Figure {
    Figure { value: ratio * scale.value, sd: ratio * scale.sd }
}

/// Compares a run with its recorder, and says where they differ. `grown`: how its wheel has changed, which is not in
/// the agreement any more.
pub(crate) fn of(
    recorder: &RecorderCheck,
    run: &mut RunCheck,
    (agreement, grown): (Option<&Agreement>, Grown),
    known: &Known,
) -> Own {
    let put = if known.scale { Grown::NOT } else { grown };
    let mut own = Own { grown: put, correction: recorder.correction, skew_s: 0.0 };
    let Some(agreement) = agreement else {
        // A run that does not say how late its speeds are has those of its recorder.
        let usual_s = recorder.skew_s.filter(|_| known.moves_locations && recorder.has(Kind::Skew));
        own.skew_s = usual_s.map_or(0.0, |skew| skew.value);
        return own;
    };
    match wheel(recorder, agreement) {
        Some(Wheel::Offset(offset_kmh)) => run.found(Kind::SpeedOffset, offset_kmh, "km/h", Done::Said),
        Some(Wheel::Scale(scale)) => {
            let figure = recorder.beside_the_line(times(scale, grown.all));
            run.found(Kind::SpeedScale, figure, "", put_right(!known.scale));
            own.correction.scale = if known.scale { 1.0 } else { scale.value };
        }
        None => (),
    }
    if let Some(skew) = run.skew_s {
        let of_recorder = recorder.has(Kind::Skew);
        let beyond = skew.value.abs() > LEAST_OWN_SKEW_S && skew.away_from(0.0) > OWN_SURE;
        if !of_recorder && beyond {
            run.found(Kind::Skew, skew, "s", put_right(known.moves_locations));
        }
        let skew_s = if of_recorder { drawn(recorder, skew) } else { skew.value };
        own.skew_s = if known.moves_locations && (of_recorder || beyond) { skew_s } else { 0.0 };
    }
    own
}

/// What the speed of one run has and that of its recorder does not.
enum Wheel {
    Offset(Figure),
    Scale(Figure),
}

/// Asks the run alone: one that differs spoils what the recorder says of the others.
fn wheel(recorder: &RecorderCheck, agreement: &Agreement) -> Option<Wheel> {
    let has = |kind| recorder.has(kind);
    // Where the model does not fit the recorder, or says nothing of it, it does not fit its runs.
    if recorder.compared < 2 || has(Kind::SpeedOffset) || has(Kind::Creep) || recorder.scale.is_none() {
        return None;
    }
    // What one run's location drifts by beside the others looks like a wheel of its own.
    if has(Kind::DriftingLocation) {
        return None;
    }
    let alone = pooled(slice::from_ref(agreement))?;
    let offset_kmh = alone.offset_kmh();
    let decided_kmh = recorder.offset_of_step_kmh();
    let half_kmh = decided_kmh.filter(|kmh| *kmh != 0.0).unwrap_or(0.5 * recorder.speed_step_kmh.unwrap_or(0.0));
    let is_odd = |plausible_kmh: f64| {
        let off_kmh = (offset_kmh.value - plausible_kmh).abs();
        off_kmh > LEAST_OWN_OFFSET_KMH && offset_kmh.away_from(plausible_kmh) > SURE
    };
    if is_odd(0.0) && is_odd(half_kmh) {
        return Some(Wheel::Offset(offset_kmh));
    }
    // Nor is a run's scale a wheel's where that of its recorder is none.
    if has(Kind::SpeedScale) && !recorder.is_wheel {
        return None;
    }
    let usual = recorder.scale.map_or(1.0, |all| if has(Kind::SpeedScale) { all.value } else { 1.0 });
    let is_own = |scale: &Figure| (scale.value - usual).abs() > LEAST_SCALE && scale.away_from(usual) > SURE;
    let scale = match decided_kmh {
        Some(kmh) => Some(alone.scale_at(kmh / 3.6)).filter(is_own),
        None => Some(alone.scale()).filter(is_own).or_else(|| {
            let beside_most = times(recorder.of_most?.ratio(&alone), usual);
            is_own(&beside_most).then_some(beside_most)
        }),
    };
    scale.map(Wheel::Scale)
}

/// The skew of a run, drawn to the usual one by what is known of both, s.
fn drawn(recorder: &RecorderCheck, own: Figure) -> f64 {
    let (Some(usual), Some(spread_s)) = (recorder.skew_s, recorder.skew_spread_s) else {
        return own.value;
    };
    own.drawn(usual.value, spread_s)
}

impl Own {
    /// Puts the speeds right, then moves the locations to their age.
    pub(crate) fn put_right(&self, rows: &mut [Sample]) {
        for row in rows.iter_mut() {
            let scale = self.correction.scale * self.grown.at(row.time_s);
            row.speed_mps = row.speed_mps.map(|mps| Correction { scale, ..self.correction }.true_mps(mps));
        }
        if self.skew_s == 0.0 {
            return;
        }
        let sign = ways::heading(rows);
        let travelled = Travelled::of(rows);
        for row in rows.iter_mut() {
            let since_m = travelled.at(row.time_s + self.skew_s) - travelled.at(row.time_s);
            row.location_m = row.location_m.map(|m| m - sign * since_m);
        }
    }
}

/// Distance by speed.
struct Travelled {
    /// Time, s, speed, m/s, distance up to there, m.
    rows: Vec<[f64; 3]>,
}

impl Travelled {
    fn of(rows: &[Sample]) -> Self {
        let mut known: Vec<[f64; 3]> = Vec::new();
        for row in rows {
            let Some(mps) = row.speed_mps else { continue };
            let before = known.last().copied().unwrap_or([row.time_s, mps, 0.0]);
            let dt = row.time_s - before[0];
            // A row that comes late is dropped by what follows.
            if dt > 0.0 || known.is_empty() {
                known.push([row.time_s, mps, before[2] + 0.5 * dt * (mps + before[1])]);
            }
        }
        Self { rows: known }
    }

    /// Up to a time, m: the speed between two readings in a straight line, beyond the ends that at the end.
    fn at(&self, time_s: f64) -> f64 {
        let after = self.rows.partition_point(|[read_s, ..]| *read_s <= time_s);
        let from = self.rows.get(after.saturating_sub(1)).copied().unwrap_or_default();
        let [from_s, mps, distance_m] = from;
        let slope = match self.rows.get(after).filter(|_| after > 0) {
            Some([to_s, to_mps, _]) => (to_mps - mps) / (to_s - from_s),
            None => 0.0,
        };
        let dt = time_s - from_s;
        distance_m + dt * (mps + 0.5 * dt * slope)
    }
}
