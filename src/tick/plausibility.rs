//! Which readings to believe.
//!
//! In: a measurement. Out: the time since the last one, and location and speed, each with its value or the cause why
//! there is none.
//!
//! | input | behaviour |
//! |---|---|
//! | time equal (by less than [`SOONEST_S`]) or back, beyond [`FAR_S`], or no time at all (beyond [`LATEST_S`]) | the measurement is dropped and counted; three in a row that agree with each other are believed: the clock was set, location and speed are initialised again (old rows that come late lie behind the train, and must be four times as many, unless they go on from before a pause behind which there is one row only); the same row again, and a late one of that clock, change nothing, nor do rows of one other clock between them |
//! | no measurement for more than `long_gap_s` | location and speed begin again, what was learned stays |
//! | not finite, negative, off the track, faster than any train | the field is dropped, the other one is used |
//! | location far from where the speed leads | dropped; three in a row that agree with each other are believed, counted as `Contradiction` |
//! | the same location while the train runs | dropped for as long as it lasts |
//! | locations that go back as fast as the speed goes on | `Reversing`: location and speed are used, nothing is learned |
//! | the same speed while the locations say otherwise | speed dropped |
//! | speed changes faster than a train can | dropped; three in a row that agree with each other are believed |

use crate::Real;
use crate::extremes::Extremes;
use crate::model::direction::Direction;
use crate::model::train::Train;
use crate::plain::plain;
use crate::tick::bounds::settings;
use crate::tick::estimate::Cause;
use crate::tick::measurement::Measurement;
use crate::tick::sensor::SensorConfig;

/// Gravity on a descent of 30 permille, N/kg.
const DESCENT_N_PER_KG: Real = 0.3;

/// A time that is further ahead is not believed by itself, s.
pub const FAR_S: f32 = 86_400.0;
/// A time that is further from zero is none, s: the last bit is half of [`SOONEST_S`], and a clock of ms since 1970
/// shows less until 2096.
pub const LATEST_S: Real = 4e12;
/// A time that is less ahead is the same time, s: no sensor reads so often, and a change of speed over less is no
/// acceleration.
pub const SOONEST_S: f32 = 1e-3;
/// So many times more must agree where they lie behind the train: rows that come late do, a clock that was set does
/// not.
const BEHIND: u32 = 4;
/// Behind is more than this share of a jump of the location: more than its noise.
const BEHIND_SHARE: Real = 0.125;

settings! {
    /// When a reading is not believed.
    PlausibilityConfig in "plausibility" {
        /// Fastest believable speed, km/h.
        max_speed_kmh: Real = 400.0, 1.0 to 1000.0;
        /// Largest believable change of speed, m/s², and not more than twice the train's effort upwards; slip and slide
        /// lie beyond.
        max_acceleration_mps2: Real = 2.0, 0.1 to 100.0;
        /// How far a location may lie from where the speed leads, m, beyond `location_share`.
        location_jump_m: Real = 120.0, 1.0 to 1e6;
        /// The same as a share of the distance run since the last location.
        location_share: Real = 0.2, 0.0 to 10.0;
        /// How far a location may lie beyond the ends of the track, m.
        off_track_m: Real = 2000.0, 0.0 to 1e9;
        /// A longer pause is a new beginning, s.
        long_gap_s: Real = 600.0, 10.0 to 86_400.0;
        /// Rejected readings in a row which, agreeing with each other, are believed.
        agreeing: u32 = 3, 1.0 to 100.0;
    }
}

/// A measurement with every field judged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Judged {
    /// Time on a clock that was never set back, s.
    pub time_s: Real,
    /// The same on the sender's clock, s.
    pub sender_s: Real,
    /// Time since the last measurement, s; 0 when location and speed begin.
    pub dt_s: Real,
    /// Location and speed begin here: first measurement, or a long gap.
    pub begins: bool,
    /// Location, m.
    pub location_m: Result<Real, Cause>,
    /// Speed, m/s: the middle of the reading's interval.
    pub speed_mps: Result<Real, Cause>,
    /// Measured effort, N/kg.
    pub effort_n_per_kg: Option<Real>,
    /// Location and speed were both read, but contradict each other.
    pub contradiction: Option<Cause>,
    /// Locations that the speed does not lead to agreed with each other: it is taken up where they are.
    pub shifted: bool,
}

/// A clock that rows show which are not believed.
#[derive(Clone, Copy, Debug, Default)]
struct RejectedClock {
    /// Of its last row, s.
    time_s: Real,
    /// How many rows in a row agree.
    agreeing: u32,
}

impl RejectedClock {
    const NONE: Self = Self { time_s: 0.0, agreeing: 0 };

    fn ahead_s(&self, time_s: Real) -> f32 {
        ahead_s(self.time_s, time_s)
    }
}

plain! {
    struct RejectedClock { time_s, agreeing }
}

/// What must be remembered to judge the next measurement.
#[derive(Clone, Copy, Debug, Default)]
pub struct Plausibility {
    last_time_s: Option<Real>,
    /// What a clock that was set has to be put forward by to go on from the old one, s.
    shift_s: Real,
    /// Clocks that are not believed, the one first that a row has shown last. Where a single row stands behind a pause
    /// one of them is that of the rows before the pause; and the clock that was left is one.
    rejected: [RejectedClock; 2],
    /// Last believed speed, and for how long it has been carried on.
    speed: Option<(Real, Real)>,
    /// Where the train should be by now.
    expected_m: Option<Real>,
    /// Distance run by speed since the last believed location.
    since_location_m: Real,
    /// Last location read, whether believed or not.
    raw_location_m: Option<Real>,
    /// Rejected locations in a row that agree with each other.
    agreeing_locations: u32,
    /// Last rejected speed, and how many in a row agree.
    rejected_speed: Option<(Real, u32)>,
    /// How many times in a row the very same speed was read.
    same_speed: u32,
    /// While the speed reads the same: how far the locations have run ahead of it, and how far it has run itself, m.
    drift_m: Real,
    same_speed_run_m: Real,
    /// Steps in a row that went backwards.
    backward: u32,
}

plain! {
    struct Plausibility {
        last_time_s,
        shift_s,
        rejected,
        speed,
        expected_m,
        since_location_m,
        raw_location_m,
        agreeing_locations,
        rejected_speed,
        same_speed,
        drift_m,
        same_speed_run_m,
        backward,
    }
}

impl Plausibility {
    /// Zeros, as by default.
    pub(crate) const ZEROED: Self = Self {
        last_time_s: None,
        shift_s: 0.0,
        rejected: [RejectedClock::NONE; 2],
        speed: None,
        expected_m: None,
        since_location_m: 0.0,
        raw_location_m: None,
        agreeing_locations: 0,
        rejected_speed: None,
        same_speed: 0,
        drift_m: 0.0,
        same_speed_run_m: 0.0,
        backward: 0,
    };

    /// Judges one measurement.
    ///
    /// # Errors
    /// The time of the last measurement, if there was one: this one's is not after it, too far ahead, or not finite,
    /// and too few agree with it.
    pub fn judge(
        &mut self,
        config: &PlausibilityConfig,
        sensor: &SensorConfig,
        train: &Train,
        track_length_m: Real,
        direction: Direction,
        measurement: &Measurement,
    ) -> Result<Judged, Option<Real>> {
        let sender_s = measurement.time_s;
        let (dt_s, begins) = self.judge_time(config, direction, measurement)?;
        let time_s = sender_s + self.shift_s;

        let before_mps = self.speed.map(|(speed_mps, _)| speed_mps);
        let mut speed_mps = self.judge_speed(config, sensor, train, dt_s, measurement.speed_mps);
        let now_mps = speed_mps.ok().or(before_mps);
        let run_m = match (before_mps, now_mps) {
            (Some(before), Some(now)) => 0.5 * (before + now) * dt_s,
            _ => 0.0,
        };
        if let Some(expected_m) = &mut self.expected_m {
            *expected_m += direction.sign() * run_m;
        }
        self.since_location_m += run_m;

        let before_m = self.raw_location_m;
        let mut contradiction = None;
        let mut shifted = false;
        let location_m = match measurement.location_m {
            None => Err(Cause::NoLocation),
            Some(m) if !m.is_finite() => Err(Cause::LocationOutOfRange),
            Some(m) if m < -config.off_track_m || m > track_length_m + config.off_track_m => {
                Err(Cause::LocationOutOfRange)
            }
            Some(m) => {
                self.raw_location_m = Some(m);
                let step_m = before_m.map(|before_m| direction.sign() * (m - before_m));
                let (location_m, against_speed) = self.judge_location(config, m, step_m, run_m);
                shifted = against_speed == Some(Cause::Contradiction);
                contradiction = against_speed.filter(|_| !shifted);
                if contradiction == Some(Cause::StuckSpeed) && speed_mps.is_ok() {
                    speed_mps = Err(Cause::StuckSpeed);
                }
                location_m
            }
        };
        let effort_n_per_kg = measurement.effort_n_per_kg.filter(|effort| effort.abs() < 10.0);
        Ok(Judged { time_s, sender_s, dt_s, begins, location_m, speed_mps, effort_n_per_kg, contradiction, shifted })
    }

    /// Time since the last measurement, and whether location and speed begin again; the last time, if this one is not
    /// believed.
    fn judge_time(
        &mut self,
        config: &PlausibilityConfig,
        direction: Direction,
        measurement: &Measurement,
    ) -> Result<(Real, bool), Option<Real>> {
        let time_s = measurement.time_s;
        if !is_time(time_s) {
            return Err(self.last_time_s);
        }
        let order = self.order(config, time_s);
        let Some(last_s) = self.last_time_s else {
            self.last_time_s = Some(time_s);
            return Ok((0.0, true));
        };
        let [newest, other] = &mut self.rejected;
        match order {
            Order::Next => {
                // Only rows one after the other agree.
                (newest.agreeing, other.agreeing) = (0, 0);
                self.last_time_s = Some(time_s);
                return Ok((time_s - last_s, false));
            }
            Order::Pause => {
                // `agreeing` rows that go on from before it are believed, wherever they lie.
                self.begin_again(time_s, self.shift_s, before_pause(config));
                return Ok((0.0, true));
            }
            Order::Same => return Err(Some(last_s)),
            Order::Agreeing | Order::Other => {}
        }
        // One that comes late is of the clock, too.
        let is_of = |clock: &RejectedClock| clock.ahead_s(time_s).abs() <= config.long_gap_s as f32;
        if !is_of(newest) {
            if !is_of(other) {
                *other = RejectedClock { time_s, agreeing: 0 };
            }
            core::mem::swap(newest, other);
        }
        if newest.agreeing > 0 && order == Order::Other {
            return Err(Some(last_s));
        }
        newest.time_s = time_s;
        newest.agreeing = newest.agreeing.saturating_add(1);
        let agreeing = newest.agreeing;
        let ahead_m = measurement.location_m.zip(self.raw_location_m);
        let ahead_m = ahead_m.map_or(0.0, |(now_m, last_m)| direction.sign() * (now_m - last_m));
        let behind = ahead_m < -BEHIND_SHARE * config.location_jump_m;
        let needed = if behind || agreeing > before_pause(config) { BEHIND * config.agreeing } else { config.agreeing };
        if agreeing < needed {
            return Err(Some(last_s));
        }
        // As after a long gap.
        let steady_s = last_s + self.shift_s + config.long_gap_s;
        self.begin_again(time_s, steady_s - time_s, 0);
        Ok((0.0, true))
    }

    /// How a time lies to those before.
    #[inline(never)]
    pub(crate) fn order(&self, config: &PlausibilityConfig, time_s: Real) -> Order {
        let Some(last_s) = self.last_time_s else {
            return Order::Next;
        };
        let (ahead_s, long_gap_s) = (ahead_s(last_s, time_s), config.long_gap_s as f32);
        if (SOONEST_S..=long_gap_s).contains(&ahead_s) {
            return Order::Next;
        }
        let mut order = if ahead_s > 0.0 && ahead_s <= FAR_S { Order::Pause } else { Order::Other };
        let mut is_same = ahead_s.abs() < SOONEST_S;
        // Zeros are no clock.
        for clock in self.rejected.iter().filter(|clock| clock.agreeing > 0 || clock.time_s.to_bits() != 0) {
            let ahead_s = clock.ahead_s(time_s);
            is_same |= clock.agreeing > 0 && ahead_s.abs() < SOONEST_S;
            if ahead_s.abs() <= long_gap_s {
                order = if ahead_s > 0.0 || order == Order::Agreeing { Order::Agreeing } else { Order::Other };
            }
        }
        if is_same { Order::Same } else { order }
    }

    /// Location and speed begin, by a clock that the steady one is ahead of by `shift_s`. For how many rows those count
    /// that go on from the last one.
    #[inline(never)]
    fn begin_again(&mut self, time_s: Real, shift_s: Real, agreeing: u32) {
        let [newest, _] = self.rejected;
        let left = RejectedClock { time_s: self.last_time_s.unwrap_or_default(), agreeing };
        *self = Self::ZEROED;
        self.shift_s = shift_s;
        self.last_time_s = Some(time_s);
        self.rejected = [left, RejectedClock { agreeing: 0, ..newest }];
    }

    fn judge_speed(
        &mut self,
        config: &PlausibilityConfig,
        sensor: &SensorConfig,
        train: &Train,
        dt_s: Real,
        reading_mps: Option<Real>,
    ) -> Result<Real, Cause> {
        if let Some((_, age_s)) = &mut self.speed {
            *age_s += dt_s;
        }
        let reading_mps = reading_mps.ok_or(Cause::NoSpeed)?;
        if !(0.0..=config.max_speed_kmh / 3.6).contains(&reading_mps) {
            return Err(Cause::SpeedOutOfRange);
        }
        let speed_mps = sensor.centre_mps(reading_mps);
        let quantum_mps = sensor.speed_quantum_kmh / 3.6;
        let possible = |from_mps: Real, age_s: Real| {
            let margin_mps = quantum_mps + 6.0 * sensor.speed_noise_kmh / 3.6;
            // Twice what the train is described to do and a steep descent: descriptions are rough.
            let by_train = 2.0 * train.max_effort_n_per_kg(from_mps) + DESCENT_N_PER_KG;
            let up = config.max_acceleration_mps2.at_most(by_train);
            let change_mps = speed_mps - from_mps;
            -config.max_acceleration_mps2 * age_s <= change_mps + margin_mps && change_mps <= up * age_s + margin_mps
        };
        if let Some((last_mps, age_s)) = self.speed {
            if !possible(last_mps, age_s) {
                let agreeing = match self.rejected_speed {
                    Some((rejected_mps, count)) if possible(rejected_mps, dt_s) => count + 1,
                    _ => 1,
                };
                self.rejected_speed = Some((speed_mps, agreeing));
                if agreeing < config.agreeing {
                    return Err(Cause::SpeedJump);
                }
            }
            if speed_mps == last_mps && speed_mps > 0.0 {
                self.same_speed = self.same_speed.saturating_add(1);
            } else {
                self.same_speed = 0;
                self.drift_m = 0.0;
                self.same_speed_run_m = 0.0;
            }
        }
        self.rejected_speed = None;
        self.speed = Some((speed_mps, 0.0));
        Ok(speed_mps)
    }

    /// The location, and how it contradicts the speed; `Contradiction`: by a shift that is believed.
    fn judge_location(
        &mut self,
        config: &PlausibilityConfig,
        location_m: Real,
        step_m: Option<Real>,
        run_m: Real,
    ) -> (Result<Real, Cause>, Option<Cause>) {
        let Some(expected_m) = self.expected_m else {
            self.believe(location_m, 1.0);
            return (Ok(location_m), None);
        };
        let allowed_m = config.location_jump_m + config.location_share * self.since_location_m;
        let step_m = step_m.unwrap_or(run_m);
        let agrees = |a: Real, b: Real| (a - b).abs() <= 0.3 * b.abs().at_least(a.abs()) + 15.0;

        if run_m > 15.0 && step_m < -10.0 && agrees(-step_m, run_m) {
            self.backward = self.backward.saturating_add(1);
        } else if step_m > 0.0 || run_m == 0.0 {
            self.backward = 0;
        }
        if self.backward >= config.agreeing {
            self.believe(location_m, 1.0);
            return (Ok(location_m), Some(Cause::Reversing));
        }

        // A speed that never changes is believed as long as the locations go along with it, up to a twentieth
        // (rounding, worn wheels).
        if self.same_speed > 0 && step_m.abs() < 0.5 * config.location_jump_m + 2.0 * run_m {
            self.drift_m += step_m - run_m;
            self.same_speed_run_m += run_m;
        }
        let stuck_m = 0.5 * config.location_jump_m + 0.05 * self.same_speed_run_m;
        let moves = step_m.abs() > 1e-3;
        if self.same_speed + 1 >= config.agreeing && self.drift_m.abs() > stuck_m && moves {
            self.believe(location_m, 1.0);
            return (Ok(location_m), Some(Cause::StuckSpeed));
        }

        if (location_m - expected_m).abs() <= allowed_m {
            self.believe(location_m, 0.3);
            return (Ok(location_m), None);
        }
        if step_m.abs() < 0.05 * run_m {
            self.agreeing_locations = 0;
            return (Err(Cause::StuckLocation), None);
        }
        self.agreeing_locations = if agrees(step_m, run_m) { self.agreeing_locations.saturating_add(1) } else { 1 };
        if self.agreeing_locations >= config.agreeing {
            self.believe(location_m, 1.0);
            return (Ok(location_m), Some(Cause::Contradiction));
        }
        (Err(Cause::LocationJump), None)
    }

    fn believe(&mut self, location_m: Real, share: Real) {
        let expected_m = self.expected_m.unwrap_or(location_m);
        self.expected_m = Some(expected_m + share * (location_m - expected_m));
        self.since_location_m = 0.0;
        self.agreeing_locations = 0;
    }
}

/// What the rows before a pause count for, beside those that go on from them.
const fn before_pause(config: &PlausibilityConfig) -> u32 {
    (BEHIND - 1) * config.agreeing
}

/// A number that a clock could show.
pub(crate) fn is_time(time_s: Real) -> bool {
    time_s.abs() <= LATEST_S
}

/// A time that is refused for being none or too far ahead, and not for coming too early.
pub(crate) fn is_out_of_range(last_s: Option<Real>, time_s: Real) -> bool {
    !is_time(time_s) || last_s.is_some_and(|last_s| ahead_s(last_s, time_s) > FAR_S)
}

/// How a time lies to those before; the later the variant, the better it goes on from them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Order {
    /// It is that of the last tick, or of a row that was not believed.
    Same,
    /// It lies before the last tick, or more than [`FAR_S`] after it.
    Other,
    /// The same, and it goes on from rows that were not believed.
    Agreeing,
    /// It comes after a pause.
    Pause,
    /// It is the next one.
    Next,
}

/// One time comes after the other, and not by too much.
pub(crate) fn is_later(before_s: Real, time_s: Real) -> bool {
    (SOONEST_S..=FAR_S).contains(&ahead_s(before_s, time_s))
}

/// In single precision, which the board compares at once.
#[inline(never)]
fn ahead_s(before_s: Real, time_s: Real) -> f32 {
    (time_s - before_s) as f32
}

#[cfg(test)]
mod tests;
