//! From what the estimator says to the frames of the wire: single precision, and only what a display needs.

use crate::Real;
use crate::coast_ahead::{CoastAhead, Outcome};
use crate::estimator::RunSummary;
use crate::features::{self, Features};
use crate::filter::gaussian::Gaussian;
use crate::listed::listed;
use crate::model::resistance::Davis;
use crate::model::state::{LOCATION, R0, SPEED};
use crate::tick::digest;
use crate::tick::estimate::Estimate;
use crate::tick::memory::Vehicle;
use rundown_wire as wire;
use rundown_wire::{Learned, Value};

/// Where, how fast, which regime.
pub fn estimate(estimate: &Estimate) -> wire::Estimate {
    let value =
        |component| Value { value: estimate.belief.mean[component] as f32, sd: estimate.belief.sd(component) as f32 };
    wire::Estimate {
        time_s: estimate.time_s,
        dt_s: estimate.dt_s as f32,
        location_m: value(LOCATION),
        speed_mps: value(SPEED),
        regime: estimate.regime,
        confirmed: estimate.confirmed,
        learning: estimate.learning,
        validity: estimate.validity,
        digest: digest::of_estimate(estimate),
    }
}

/// The running resistance: coefficients as published, with the uncertainty of the estimate.
pub fn parameters(
    estimate: &Estimate,
    published: &Davis,
    learned: Learned,
    gain: Option<(Real, Real)>,
) -> wire::Parameters {
    let belief = &estimate.belief;
    let sd = |i| belief.sd(R0 + i);
    let value = |i, value: Real| Value { value: value as f32, sd: sd(i) as f32 };
    let correlation = |i: usize, j: usize| {
        let both = sd(i) * sd(j);
        if both > 0.0 { (belief.covariance[(R0 + i, R0 + j)] / both) as f32 } else { 0.0 }
    };
    wire::Parameters {
        r0: value(0, published.r0),
        r1: value(1, published.r1),
        r2: value(2, published.r2),
        correlation: [correlation(0, 1), correlation(0, 2), correlation(1, 2)],
        learned,
        gain: gain.map(|(value, sd)| Value { value: value as f32, sd: sd as f32 }),
    }
}

/// Applied effort and its bounds; `limits_n_per_kg` of traction and brake as
/// [`Estimator::limits_n_per_kg`](crate::estimator::Estimator::limits_n_per_kg) gives them.
pub fn effort(estimate: &Estimate, limits_n_per_kg: (Real, Real)) -> wire::Effort {
    let (traction_n_per_kg, brake_n_per_kg) = limits_n_per_kg;
    wire::Effort {
        effort_n_per_kg: estimate.effort_n_per_kg.map(|effort| effort as f32),
        acceleration_mps2: estimate.acceleration_mps2.map(|rate| rate as f32),
        gradient_n_per_kg: estimate.gradient_n_per_kg as f32,
        max_traction_n_per_kg: traction_n_per_kg as f32,
        max_brake_n_per_kg: brake_n_per_kg as f32,
    }
}

/// What coasting leads to.
pub fn coast_ahead(ahead: &CoastAhead) -> wire::CoastAhead {
    let value = |value: Real, sd: Real| Value { value: value as f32, sd: sd as f32 };
    wire::CoastAhead {
        from_time_s: ahead.from.time_s,
        from_location_m: ahead.from.location_m as f32,
        from_speed_mps: ahead.from.speed_mps as f32,
        target: ahead.target.map(|target| wire::CoastTarget {
            at_m: target.at_m as f32,
            limit_mps: target.limit_mps.map(|limit_mps| limit_mps as f32),
        }),
        outcome: match ahead.outcome {
            Outcome::Unknown => wire::CoastOutcome::Unknown,
            Outcome::NoTarget => wire::CoastOutcome::NoTarget,
            Outcome::Arrives(arrival) => wire::CoastOutcome::Arrives(wire::CoastArrival {
                speed_mps: value(arrival.speed_mps, arrival.speed_sd_mps),
                time_s: arrival.time_s,
                time_sd_s: arrival.time_sd_s as f32,
            }),
            Outcome::MayStop => wire::CoastOutcome::MayStop,
            Outcome::Stops { location_m, sd_m } => wire::CoastOutcome::Stops(value(location_m, sd_m)),
        },
    }
}

fn statistic(statistic: &features::Statistic) -> wire::Statistic {
    wire::Statistic { count: statistic.count, mean: statistic.mean as f32, sd: statistic.sd as f32 }
}

fn phase(phase: &features::Phase) -> wire::Phase {
    wire::Phase {
        start_time_s: phase.start_time_s,
        start_location_m: phase.start_location_m as f32,
        start_speed_mps: phase.start_speed_mps as f32,
        duration_s: phase.duration_s as f32,
        length_m: phase.length_m as f32,
    }
}

/// Driving style and limits.
pub fn features(features: &Features) -> wire::Features {
    let energy = &features.energy;
    wire::Features {
        max_effort: features.max_effort.as_ref().map(|line| wire::EffortLine {
            effort_n_per_kg: statistic(&line.effort),
            at_lower_n_per_kg: line.at_lower_n_per_kg as f32,
            slope: line.slope as f32,
        }),
        power_w_per_kg: statistic(&features.power_w_per_kg),
        max_power_w_per_kg: features.max_power_w_per_kg.map(|power| power as f32),
        brake_rate_mps2: features.brake_rate_mps2.each_ref().map(statistic),
        cruise_speed_mps: statistic(&features.cruise_speed_mps),
        cruise_speed_median_mps: features.cruise_speed_median_mps.map(|speed| speed as f32),
        final_coast: features.final_coast.as_ref().map(phase),
        final_brake: features.final_brake.as_ref().map(phase),
        regime_time_s: features.regime_time_s.map(|time_s| time_s as f32),
        traction_j_per_kg: energy.traction_j_per_kg as f32,
        brake_j_per_kg: energy.brake_j_per_kg as f32,
        resistance_j_per_kg: [
            energy.r0_j_per_kg as f32,
            energy.r1_j_per_kg as f32,
            energy.r2_j_per_kg as f32,
            energy.gradient_j_per_kg as f32,
        ],
    }
}

/// The switching points from `first` on, as many as one frame holds.
pub fn switching_points(features: &Features, first: usize) -> wire::SwitchingPoints {
    let all = &features.switching_points;
    let points = all.iter().skip(first).take(wire::SWITCHING_POINTS).map(|point| wire::SwitchingPoint {
        time_s: point.time_s,
        location_m: point.location_m as f32,
        speed_mps: point.speed_mps as f32,
        from: point.from,
        to: point.to,
    });
    wire::SwitchingPoints {
        first: u16::try_from(first).unwrap_or(u16::MAX),
        total: u16::try_from(all.len()).unwrap_or(u16::MAX),
        lost: features.switching_points_lost,
        points: listed(points),
    }
}

/// The end of a run; `wind_sd_mps` as the vehicle's memory has it.
pub fn run_summary(summary: &RunSummary, vehicle: &Vehicle, wind_sd_mps: Real) -> wire::RunSummary {
    let davis = |belief: &Gaussian<3>| {
        let value = |i: usize, value: Real| Value { value: value as f32, sd: belief.sd(i) as f32 };
        let [r0, r1, r2] = belief.mean.into();
        [value(0, r0), value(1, r1), value(2, r2)]
    };
    wire::RunSummary {
        run: vehicle.runs(),
        run_davis: davis(&summary.run_davis),
        vehicle_davis: davis(&vehicle.davis()),
        wind_sd_mps: wind_sd_mps as f32,
        gain: Value { value: summary.gain.0 as f32, sd: summary.gain.1 as f32 },
        learned_s: summary.learned_s as f32,
    }
}
