//! From an estimate to what coasting leads to.

use super::outcome::NINETY_PERCENT;
use super::way::{Stands, Way};
use super::{Arrival, CoastAhead, CoastConfig, Outcome};
use crate::Real;
use crate::effects::Acting;
use crate::effort::Point;
use crate::estimate::{Estimate, Validity};
use crate::motion::Line;
use crate::state::{LOCATION, SIZE, SPEED};
use crate::track::Target;

/// A target that is nearer than this is passed, m: the location is not known better while a train leaves its stop.
const PASSED_M: Real = 50.0;
/// Slower than this the train stands or is about to, m/s.
const LEAST_MPS: Real = 3.0;
/// Length of a step, m, and most steps: what lies behind `STEP_M x MOST_STEPS` is reached with longer ones. The longest call of the board has room for so many in
/// the ticks that send neither features nor status; `tests` below measures what the steps cost in accuracy.
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
        if finite {
            estimate.belief.mean[component]
        } else {
            0.0
        }
    };
    let from = Point {
        time_s: estimate.time_s,
        location_m: mean(LOCATION),
        speed_mps: mean(SPEED),
    };
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
        Some(target) => coast(line, acting, noise, estimate, &from, ahead_m(target)),
    };
    CoastAhead {
        from,
        target,
        outcome: if outcome.is_finite() {
            outcome
        } else {
            Outcome::Unknown
        },
    }
}

#[inline(never)]
fn coast(
    line: &Line<'_>,
    acting: &Acting<'_>,
    noise: Real,
    estimate: &Estimate,
    from: &Point,
    ahead_m: Real,
) -> Outcome {
    let davis = estimate.davis();
    let sign = line.direction.sign();
    let mut way = Way::begin(line, acting, davis, noise, *from);
    let here = Here {
        sign,
        speed_mps: from.speed_mps,
        braking_n_per_kg: way.braking_n_per_kg(),
    };
    let steps = libm::ceil(ahead_m / STEP_M).clamp(1.0, Real::from(MOST_STEPS));
    let step_m = ahead_m / steps;
    for _ in 0..steps as u32 {
        if let Err(Stands { after_m }) = way.advance(step_m) {
            // v² is nearly straight over the way, and its deviation is that of where the step began.
            let sd_m =
                energy_sd(estimate, &here, &way) / (2.0 * davis.r0.max(way.braking_n_per_kg()));
            let location_m = way.at.location_m + sign * after_m;
            let left_m = ahead_m - sign * (location_m - from.location_m);
            // NaN goes on and is found to be none.
            return if left_m < NINETY_PERCENT * sd_m {
                Outcome::MayStop
            } else {
                Outcome::Stops { location_m, sd_m }
            };
        }
    }
    let sd = energy_sd(estimate, &here, &way);
    if way.energy < NINETY_PERCENT * sd {
        return Outcome::MayStop;
    }
    let by_energy = way.by_energy[0];
    let speed_mps = way.at.speed_mps;
    Outcome::Arrives(Arrival {
        speed_mps,
        speed_sd_mps: 0.5 * sd / speed_mps,
        time_s: way.at.time_s,
        time_sd_s: time_sd_s(estimate, &here, &way),
        speed_per_m: by_energy * davis.resistance_n_per_kg(from.speed_mps) / speed_mps,
    })
}

/// Where the prediction begins.
struct Here {
    /// +1 up, -1 down.
    sign: Real,
    speed_mps: Real,
    /// Resistance and gradient.
    braking_n_per_kg: Real,
}

/// Standard deviation of v² at a place of the way, m²/s².
fn energy_sd(estimate: &Estimate, here: &Here, way: &Way<'_>) -> Real {
    let [energy, r0, r1, r2] = way.by_energy;
    // A train that is further ahead has less of the way to go.
    let location = 2.0 * energy * here.braking_n_per_kg * here.sign;
    let answers = [location, 2.0 * here.speed_mps * energy, r0, r1, r2];
    libm::sqrt(variance(estimate, &answers) + way.noise_energy)
}

/// Standard deviation of the time at a place of the way, s.
fn time_sd_s(estimate: &Estimate, here: &Here, way: &Way<'_>) -> Real {
    let [energy, r0, r1, r2] = way.by_time;
    let location = (2.0 * energy * here.braking_n_per_kg - 1.0 / here.speed_mps) * here.sign;
    let answers = [location, 2.0 * here.speed_mps * energy, r0, r1, r2];
    libm::sqrt(variance(estimate, &answers) + way.noise_time)
}

/// Variance of what answers so to the state.
fn variance(estimate: &Estimate, answers: &[Real; SIZE]) -> Real {
    let covariance = &estimate.belief.covariance;
    let mut sum = 0.0;
    for (column, answer) in covariance.column_iter().zip(answers) {
        let row: Real = column.iter().zip(answers).map(|(p, a)| p * a).sum();
        sum += answer * row;
    }
    // Rounding may leave a little below 0 of a state that is known exactly. NaN stays.
    if sum < 0.0 { 0.0 } else { sum }
}

impl Outcome {
    /// No number in it is NaN or infinite.
    fn is_finite(&self) -> bool {
        match self {
            Self::Unknown | Self::NoTarget | Self::MayStop => true,
            Self::Arrives(arrival) => [
                arrival.speed_mps,
                arrival.speed_sd_mps,
                arrival.time_s,
                arrival.time_sd_s,
                arrival.speed_per_m,
            ]
            .iter()
            .all(|value| value.is_finite()),
            Self::Stops { location_m, sd_m } => location_m.is_finite() && sd_m.is_finite(),
        }
    }
}
