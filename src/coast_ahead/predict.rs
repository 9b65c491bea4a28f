//! From an estimate to what coasting leads to.

use super::outcome::NINETY_PERCENT;
use super::way::{Stands, Way};
use super::{Arrival, CoastAhead, CoastConfig, Outcome};
use crate::Real;
use crate::extremes::Extremes;
use crate::model::effects::Acting;
use crate::model::line::Line;
use crate::model::pieces::pieces;
use crate::model::point::Point;
use crate::model::state::{LOCATION, SIZE, SPEED};
use crate::model::track::Target;
use crate::tick::estimate::{Estimate, Validity};

/// A target that is nearer than this is passed, m: the location is not known better while a train leaves its stop.
const PASSED_M: Real = 50.0;
/// Slower than this the train stands or is about to, m/s.
const LEAST_MPS: Real = 3.0;
/// Length of a step, m, and most steps: what lies behind `STEP_M x MOST_STEPS` is reached with longer ones. The longest
/// call of the board has room for so many in the ticks that send neither features nor status; `tests` below measures
/// what the steps cost in accuracy.
const STEP_M: Real = 400.0;
const MOST_STEPS: u32 = 20;

/// Of a tick; `noise` is the spectral density of the acceleration beyond the model, m²/s³.
pub(crate) fn predict(
    config: &CoastConfig,
    line: &Line<'_>,
    acting: &Acting<'_>,
    noise: Real,
    estimate: &Estimate,
) -> CoastAhead {
    let finite = estimate.belief.is_finite();
    // NaN is no message.
    let mean = |component| {
        if finite { estimate.belief.mean[component] } else { 0.0 }
    };
    let from = Point { time_s: estimate.time_s, location_m: mean(LOCATION), speed_mps: mean(SPEED) };
    let sign = line.direction.sign();
    let ahead_m = |target: &Target| sign * (target.at_m - from.location_m);
    let target = line
        .track
        .next_target(line.direction, from.location_m, PASSED_M)
        .filter(|target| ahead_m(target) <= config.horizon_m);
    let known = !matches!(estimate.validity, Validity::Invalid(_))
        && finite
        && from.speed_mps >= LEAST_MPS
        && estimate.davis().resistance_n_per_kg(from.speed_mps) > 0.0;
    let outcome = match &target {
        _ if !known => Outcome::Unknown,
        None => Outcome::NoTarget,
        Some(target) => coast(config, line, acting, noise, estimate, &from, ahead_m(target)),
    };
    CoastAhead { from, target, outcome: if outcome.is_finite() { outcome } else { Outcome::Unknown } }
}

#[inline(never)]
fn coast(
    config: &CoastConfig,
    line: &Line<'_>,
    acting: &Acting<'_>,
    noise: Real,
    estimate: &Estimate,
    from: &Point,
    ahead_m: Real,
) -> Outcome {
    let davis = estimate.davis();
    let sign = line.direction.sign();
    let mut way = Way::begin(line, acting, &davis, noise, from);
    let speed_mps = way.speed_mps;
    let here = Here {
        sign: sign as f32,
        speed_mps,
        braking_n_per_kg: way.braking_n_per_kg(),
        by_wind: 2.0 * (config.wind_change_mps * davis.r2) as f32,
    };
    let steps = pieces(ahead_m, STEP_M, MOST_STEPS);
    let step_m = ahead_m / Real::from(steps);
    for _ in 0..steps {
        if let Err(Stands { after_m }) = way.advance(step_m) {
            // v² is nearly straight over the distance, and its deviation is that of where the step began.
            let sd = here.sd_of(here.energy(&way.by_energy), &way.by_energy, estimate, way.noise_energy);
            let sd_m = Real::from(0.5 * sd / way.braking_n_per_kg().at_least(davis.r0 as f32));
            let location_m = way.location_m + sign * Real::from(after_m);
            let left_m = ahead_m - sign * (location_m - from.location_m);
            // NaN goes on and is found to be none.
            return if left_m < NINETY_PERCENT * sd_m { Outcome::MayStop } else { Outcome::Stops { location_m, sd_m } };
        }
    }
    let sd = here.sd_of(here.energy(&way.by_energy), &way.by_energy, estimate, way.noise_energy);
    if Real::from(way.energy) < NINETY_PERCENT * Real::from(sd) {
        return Outcome::MayStop;
    }
    let time_sd = here.sd_of(here.time(&way.by_time), &way.by_time, estimate, way.noise_time);
    let level = davis.resistance_n_per_kg(from.speed_mps) as f32;
    Outcome::Arrives(Arrival {
        speed_mps: Real::from(way.speed_mps),
        speed_sd_mps: Real::from(0.5 * sd / way.speed_mps),
        time_s: from.time_s + Real::from(way.time_s),
        time_sd_s: Real::from(time_sd),
        speed_per_m: Real::from(way.by_energy[0] * level / way.speed_mps),
    })
}

/// Where the prediction begins.
struct Here {
    /// +1 up, -1 down.
    sign: f32,
    speed_mps: f32,
    /// Resistance and gradient.
    braking_n_per_kg: f32,
    /// What the wind ahead may add to r1, by its standard deviation.
    by_wind: f32,
}

impl Here {
    /// How v² at a place of the way answers to the location: a train that is further ahead has less distance to go.
    fn energy(&self, by: &[f32; 4]) -> f32 {
        2.0 * by[0] * self.braking_n_per_kg * self.sign
    }

    /// The same of the time.
    fn time(&self, by: &[f32; 4]) -> f32 {
        (2.0 * by[0] * self.braking_n_per_kg - 1.0 / self.speed_mps) * self.sign
    }

    /// Standard deviation of what answers so to the location, and to v², r0, r1, r2 of the estimate.
    fn sd_of(&self, location: f32, by: &[f32; 4], estimate: &Estimate, noise: f32) -> f32 {
        let [energy, r0, r1, r2] = *by;
        let answers = [location, 2.0 * self.speed_mps * energy, r0, r1, r2];
        let wind = self.by_wind * r1;
        crate::roots::square_root((variance(estimate, &answers) + wind * wind + noise).into()) as f32
    }
}

/// Variance of what answers so to the state.
fn variance(estimate: &Estimate, answers: &[f32; SIZE]) -> f32 {
    let covariance = &estimate.belief.covariance;
    let mut sum = 0.0;
    for (column, answer) in covariance.column_iter().zip(answers) {
        let row = column.iter().zip(answers).map(|(p, a)| *p as f32 * a);
        sum += answer * row.sum::<f32>();
    }
    // Rounding may leave a little below 0 of a state that is known exactly. NaN stays.
    if sum < 0.0 { 0.0 } else { sum }
}

impl Outcome {
    /// No number in it is NaN or infinite.
    fn is_finite(&self) -> bool {
        match self {
            Self::Unknown | Self::NoTarget | Self::MayStop => true,
            Self::Arrives(arrival) => {
                [arrival.speed_mps, arrival.speed_sd_mps, arrival.time_s, arrival.time_sd_s, arrival.speed_per_m]
                    .iter()
                    .all(|value| value.is_finite())
            }
            Self::Stops { location_m, sd_m } => location_m.is_finite() && sd_m.is_finite(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::filter::gaussian::Gaussian;
    use crate::model::direction::Direction;
    use crate::model::effects::{Effect, Effects, Journey, TunnelDrag};
    use crate::model::resistance::Davis;
    use crate::model::state::{R0, R1, R2};
    use crate::model::track::{Gradient, Track};
    use crate::model::train::{Train, TrainDescription};
    use crate::tick::estimate::Cause;
    use crate::tick::regime::Regime;

    const DAVIS: Davis = Davis { r0: 7.38e-3, r1: 1.6e-4, r2: 2.8e-5 };
    const END_M: Real = 30e3;

    fn train() -> Train {
        Train::try_new(TrainDescription::CASE_STUDY).unwrap()
    }

    /// Hills of up to 8 permille that change every 700 m, with a stop at both ends.
    fn hills() -> Track {
        let gradient = |i: u32| Gradient { from_m: 700.0 * Real::from(i), permille: Real::from(i * 7 % 17) - 8.0 };
        Track::try_new(END_M, (0..43).map(gradient)).unwrap()
    }

    fn flat() -> Track {
        Track::try_new(END_M, []).unwrap()
    }

    fn with_stop(track: Track, at_m: Real) -> Track {
        track.with_targets([Target { at_m, limit_mps: None }]).unwrap()
    }

    fn estimate(location_m: Real, speed_mps: Real, davis: Davis, sd: [Real; SIZE]) -> Estimate {
        let mean = [location_m, speed_mps, davis.r0, davis.r1, davis.r2];
        Estimate {
            time_s: 1000.0,
            dt_s: 10.0,
            belief: Gaussian::independent(mean, sd),
            effort_n_per_kg: None,
            acceleration_mps2: None,
            gradient_n_per_kg: 0.0,
            regime: Regime::Coast,
            confirmed: None,
            learning: false,
            innovation: None,
            validity: Validity::Valid,
        }
    }

    fn ahead(track: &Track, effects: &Effects, direction: Direction, estimate: &Estimate) -> CoastAhead {
        let line = Line { train: &train(), track, direction };
        let acting = Acting::new(effects, Journey::default());
        predict(&calm(), &line, &acting, 0.0, estimate)
    }

    /// A wind that stays as it is.
    fn calm() -> CoastConfig {
        CoastConfig { wind_change_mps: 0.0, ..CoastConfig::default() }
    }

    fn arrival(track: &Track, direction: Direction, estimate: &Estimate) -> Arrival {
        match ahead(track, &Effects::NONE, direction, estimate).outcome {
            Outcome::Arrives(arrival) => arrival,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn against_air_alone_it_is_the_closed_form() {
        let track = with_stop(flat(), 12e3);
        let air = Davis { r0: 0.0, r1: 0.0, r2: 2.8e-5 };
        let found = arrival(&track, Direction::Up, &estimate(2e3, 38.0, air, [0.0; SIZE]));
        let share = libm::exp(2.8e-5 * 10e3);
        assert!((found.speed_mps - 38.0 / share).abs() < 2e-3, "{found:?}");
        let took_s = (share - 1.0) / (2.8e-5 * 38.0);
        assert!((found.time_s - 1000.0 - took_s).abs() < 0.02, "{found:?} {took_s}");
    }

    #[test]
    fn coarse_steps_over_hills_come_where_fine_ones_do() {
        let train = train();
        let mut largest = [0.0; 2];
        for direction in [Direction::Up, Direction::Down] {
            for ahead_m in [600.0, 2e3, 5e3, 8e3, 14e3, 20e3, 25e3] {
                for speed_mps in [25.0, 38.0] {
                    let sign = direction.sign();
                    let (begin_m, track) = match direction {
                        Direction::Up => (29e3 - ahead_m, with_stop(hills(), 29e3)),
                        Direction::Down => (1e3 + ahead_m, with_stop(hills(), 1e3)),
                    };
                    let estimate = estimate(begin_m, speed_mps, DAVIS, [0.0; SIZE]);
                    let found = ahead(&track, &Effects::NONE, direction, &estimate).outcome;
                    // Steps of 50 ms by the midpoint rule, over time.
                    let (mut s, mut v, mut t) = (begin_m, speed_mps, 1000.0);
                    let a = |s, v| {
                        let line = Line { train: &train, track: &track, direction };
                        -DAVIS.resistance_n_per_kg(v) - line.gradient_n_per_kg(s)
                    };
                    let mut left_m = ahead_m;
                    while left_m > 0.0 && v > 1.0 {
                        let middle = v + 0.025 * a(s, v);
                        let next = v + 0.05 * a(s + sign * 0.025 * v, middle);
                        s += sign * 0.05 * middle;
                        left_m -= 0.05 * middle;
                        v = next;
                        t += 0.05;
                    }
                    match found {
                        Outcome::Arrives(found) => {
                            assert!(left_m <= 0.0);
                            let late_s = (found.time_s - t).abs();
                            let errors = [(found.speed_mps - v).abs(), late_s / (t - 1000.0)];
                            largest = [0, 1].map(|i| largest[i].at_least(errors[i]));
                        }
                        Outcome::Stops { location_m, .. } => {
                            assert!((location_m - s).abs() < 60.0, "{location_m} {s} {ahead_m}");
                        }
                        other => panic!("{other:?} {ahead_m} {v}"),
                    }
                }
            }
        }
        // m/s and share of the time. The largest are those of trains that crawl over the last hill after 20 km; above
        // 40 km/h they are 0.02 m/s and 0.1 %.
        assert!(largest[0] < 0.1 && largest[1] < 0.011, "{largest:?}");
    }

    #[test]
    fn deviations_are_what_a_change_of_the_state_makes() {
        let step = [5.0, 0.05, 1e-4, 1e-6, 1e-7];
        for direction in [Direction::Up, Direction::Down] {
            let track = with_stop(hills(), 15e3);
            let begin_m = 15e3 - direction.sign() * 9e3;
            for component in [LOCATION, SPEED, R0, R1, R2] {
                let at = |sign: Real| {
                    let mut state = estimate(begin_m, 36.0, DAVIS, [0.0; SIZE]);
                    state.belief.mean[component] += sign * step[component];
                    arrival(&track, direction, &state)
                };
                let (more, less) = (at(1.0), at(-1.0));
                let by = |f: fn(&Arrival) -> Real| 0.5 * (f(&more) - f(&less)).abs();
                let mut sd = [0.0; SIZE];
                sd[component] = step[component];
                let found = arrival(&track, direction, &estimate(begin_m, 36.0, DAVIS, sd));
                for (sd, expected) in [(found.speed_sd_mps, by(|a| a.speed_mps)), (found.time_sd_s, by(|a| a.time_s))] {
                    // A place a few metres on lies on another mean gradient.
                    let least = if component == LOCATION { 0.85 } else { 0.97 };
                    let share = sd / expected;
                    assert!((least..1.0 / least).contains(&share), "{direction:?} {component}: {sd} {expected}");
                }
            }
        }
    }

    #[test]
    fn noise_alone_gives_the_variances_of_an_integrated_random_walk() {
        let track = with_stop(flat(), 12e3);
        let line = Line { train: &train(), track: &track, direction: Direction::Up };
        let effects = Effects::NONE;
        let acting = Acting::new(&effects, Journey::default());
        let light = Davis { r0: 1e-9, r1: 0.0, r2: 0.0 };
        let estimate = estimate(2e3, 40.0, light, [0.0; SIZE]);
        let q = 2.5e-6;
        let Outcome::Arrives(found) = predict(&CoastConfig::default(), &line, &acting, q, &estimate).outcome else {
            panic!("no arrival");
        };
        // 250 s at 40 m/s: sd of v is sqrt(q t), of the place sqrt(q t³/3), of the time that over v.
        let t: Real = 250.0;
        assert!((found.speed_sd_mps / libm::sqrt(q * t) - 1.0).abs() < 1e-3, "{found:?}");
        let time_sd_s = libm::sqrt(q * t * t * t / 3.0) / 40.0;
        assert!((found.time_sd_s / time_sd_s - 1.0).abs() < 0.01, "{found:?} {time_sd_s}");
    }

    #[test]
    fn another_wind_ahead_is_as_uncertain_as_the_linear_term_that_it_adds() {
        let (track, train) = (with_stop(hills(), 15e3), train());
        let line = Line { train: &train, track: &track, direction: Direction::Up };
        let effects = Effects::NONE;
        let acting = Acting::new(&effects, Journey::default());
        let config = CoastConfig { wind_change_mps: 0.5, ..CoastConfig::default() };
        let state = estimate(6e3, 36.0, DAVIS, [0.0; SIZE]);
        let Outcome::Arrives(found) = predict(&config, &line, &acting, 0.0, &state).outcome else {
            panic!("no arrival");
        };
        // r2 (v + w)² adds 2 r2 w to r1.
        let sd = [0.0, 0.0, 0.0, 2.0 * DAVIS.r2 * 0.5, 0.0];
        let expected = arrival(&track, Direction::Up, &estimate(6e3, 36.0, DAVIS, sd));
        assert!((found.speed_sd_mps / expected.speed_sd_mps - 1.0).abs() < 1e-4);
        assert!((found.time_sd_s / expected.time_sd_s - 1.0).abs() < 1e-4);
        assert!(found.speed_sd_mps > 0.05, "{found:?}");
    }

    #[test]
    fn a_tunnel_on_the_way_slows_the_train() {
        let track = with_stop(flat(), 12e3);
        let tunnel = Effect::TunnelDrag(TunnelDrag { from_m: 4e3, to_m: 8e3, k: 1e-5 });
        let effects = Effects::try_new([tunnel]).unwrap();
        let state = estimate(2e3, 38.0, DAVIS, [0.0; SIZE]);
        let free = arrival(&track, Direction::Up, &state).speed_mps;
        let Outcome::Arrives(found) = ahead(&track, &effects, Direction::Up, &state).outcome else {
            panic!("no arrival");
        };
        // 4 km of 1e-5 v²: v² falls by the share exp(-2 k l) there.
        let expected = free * libm::exp(-1e-5 * 4e3);
        assert!((found.speed_mps - expected).abs() < 0.2, "{} {expected}", found.speed_mps);
    }

    #[test]
    fn a_train_that_stands_before_has_a_place_and_no_speed() {
        let track = with_stop(flat(), 20e3);
        let outcome = |location_m, r0_sd| {
            let state = estimate(location_m, 20.0, DAVIS, [0.0, 0.0, r0_sd, 0.0, 0.0]);
            ahead(&track, &Effects::NONE, Direction::Up, &state).outcome
        };
        let Outcome::Stops { location_m, sd_m } = outcome(1e3, 1e-4) else {
            panic!("{:?}", outcome(1e3, 1e-4));
        };
        assert!((12e3..16e3).contains(&location_m) && sd_m > 10.0, "{location_m} {sd_m}");
        let reach_m = location_m - 1e3;
        assert!(matches!(outcome(20e3 - reach_m + 300.0, 1e-3), Outcome::MayStop));
        assert!(matches!(outcome(20e3 - reach_m - 300.0, 1e-3), Outcome::MayStop));
        assert!(matches!(outcome(16e3, 1e-4), Outcome::Arrives(_)));
    }

    #[test]
    fn without_a_target_or_a_state_there_is_no_prediction() {
        let track = with_stop(flat(), 20e3);
        let none = |track: &Track, state: &Estimate| ahead(track, &Effects::NONE, Direction::Up, state).outcome;
        let good = estimate(10e3, 38.0, DAVIS, [10.0, 0.1, 1e-4, 1e-6, 1e-7]);
        assert!(matches!(none(&track, &good), Outcome::Arrives(_)));
        assert_eq!(none(&flat(), &good), Outcome::NoTarget);
        let mut passed = good;
        passed.belief.mean[LOCATION] = 19_970.0;
        assert_eq!(none(&track, &passed), Outcome::NoTarget);
        let far = with_stop(Track::try_new(1e5, []).unwrap(), 90e3);
        assert_eq!(none(&far, &good), Outcome::NoTarget);
        let mut invalid = good;
        invalid.validity = Validity::Invalid(Cause::NoLocation);
        assert_eq!(none(&track, &invalid), Outcome::Unknown);
        let mut standing = good;
        standing.belief.mean[SPEED] = 0.0;
        assert_eq!(none(&track, &standing), Outcome::Unknown);
        let mut pushed = good;
        pushed.belief.mean[R0] = -1.0;
        assert_eq!(none(&track, &pushed), Outcome::Unknown);
    }

    #[test]
    fn odd_numbers_give_no_panic_and_no_nan() {
        let odd = [Real::NAN, Real::INFINITY, Real::NEG_INFINITY, Real::MAX, -1e300, 1e-300, 0.0, -0.0];
        let track = with_stop(hills(), 20e3);
        for direction in [Direction::Up, Direction::Down] {
            for value in odd {
                for index in 0..SIZE + SIZE * SIZE {
                    let mut state = estimate(10e3, 38.0, DAVIS, [10.0, 0.1, 1e-4, 1e-6, 1e-7]);
                    if let Some(mean) = state.belief.mean.get_mut(index) {
                        *mean = value;
                    } else {
                        state.belief.covariance[index - SIZE] = value;
                    }
                    let found = ahead(&track, &Effects::NONE, direction, &state);
                    assert!(found.outcome.is_finite(), "{found:?}");
                    assert!(found.from.location_m.is_finite() && found.from.speed_mps.is_finite());
                }
            }
        }
    }
}
