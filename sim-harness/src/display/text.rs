//! One line a frame, for logs and other programs.
//!
//! In: a frame. Out: words and numbers for a person, or JSON with the field names of `WIRE.md` in SI units.

use rundown_wire::{
    Body, CoastAhead, CoastArrival, CoastOutcome, Effect, EffectKind, Effects, Effort, Estimate, Features, Learned,
    Order, Parameters, Phase, Received, RunSummary, Value,
};
use serde::Serialize;
use std::fmt::Write;

pub const KMH: f32 = 3.6;
/// Half of the 95 % interval of a value that is estimated: what stands behind ±, in standard deviations.
pub const HALF_95: f32 = rundown_check::figure::HALF_95 as f32;

#[derive(Serialize)]
struct JsonLine<'a> {
    /// `next`, `after` a loss, `late`, `repeated`, `restart`.
    order: &'static str,
    /// Frames missing before this one.
    lost: u16,
    #[serde(flatten)]
    frame: &'a rundown_wire::Downlink,
}

pub fn json(received: &Received) -> String {
    let lost = match received.order {
        Order::After { lost } => lost,
        _ => 0,
    };
    let line = JsonLine { order: word(received.order), lost, frame: &received.frame };
    // Nothing in a frame that JSON does not have: NaN is written as null.
    serde_json::to_string(&line).unwrap_or_default()
}

const fn word(order: Order) -> &'static str {
    match order {
        Order::Next => "next",
        Order::After { .. } => "after",
        Order::Late => "late",
        Order::Repeated => "repeated",
        Order::Restart => "restart",
    }
}

/// The frame as a line for a person: sequence, tick, kind, what it says. What is missing before it stands in a mark in
/// front.
pub fn line(received: &Received) -> String {
    let frame = &received.frame;
    let mark = match received.order {
        Order::Next => String::new(),
        Order::After { lost } => format!("({lost} lost) "),
        order => format!("({}) ", word(order)),
    };
    format!("{:>5} {:>6}  {:16} {mark}{}", frame.sequence, frame.tick, frame.body.as_str(), said(&frame.body))
}

fn said(body: &Body) -> String {
    match body {
        Body::Estimate(estimate) => of_estimate(estimate),
        Body::Parameters(parameters) => of_parameters(parameters),
        Body::Effort(effort) => of_effort(effort),
        Body::CoastAhead(ahead) => of_coast_ahead(ahead, None),
        Body::Features(features) => of_features(features),
        Body::SwitchingPoints(points) => match points.points.last() {
            Some(last) => format!(
                "{} in the run; last {} to {} at {:.3} km, {:.1} km/h",
                points.total,
                last.from,
                last.to,
                last.location_m / 1000.0,
                last.speed_mps * KMH
            ),
            None => "none yet".to_owned(),
        },
        Body::Effects(effects) => of_effects(effects),
        Body::Status(status) => format!(
            "run {}, train {}, track {}, {} readings not used, {} requests refused, {} frames not sent",
            if status.running { "under way" } else { "none" },
            status.train_id.map_or_else(|| "unknown".to_owned(), |id| format!("{id:x}")),
            status.track_id.map_or_else(|| "unknown".to_owned(), |id| format!("{id:08x}")),
            status.causes.iter().fold(0_u32, |sum, count| sum.saturating_add(*count)),
            status.refusals.iter().fold(0_u32, |sum, count| sum.saturating_add(*count)),
            status.not_sent
        ),
        Body::RunSummary(summary) => of_summary(summary),
        Body::SnapshotPart(part) => {
            format!("bytes {} to {} of {}", part.first, usize::from(part.first) + part.bytes.len(), part.total)
        }
        Body::Answer(answer) => match answer.result {
            Ok(()) => format!("to {}: taken", answer.to),
            Err(refusal) => format!("to {}: refused, {}", answer.to, refusal.as_str()),
        },
        Body::Health(health) => format!(
            "up {} s, started by {}, {} crashes, stack {} B, longest {} us",
            health.uptime_s,
            health.reset_cause.as_str(),
            health.resets,
            health.stack_bytes,
            health.longest_us
        ),
        Body::Versions(versions) => versions.to_string(),
        Body::Recorder(recorder) => format!(
            "speeds are cut off: true is {:.2} \u{b1}{:.2} km/h more than read; half a step is added {}",
            recorder.speed_offset_mps.value * KMH,
            HALF_95 * recorder.speed_offset_mps.sd * KMH,
            if recorder.put_right { "to each" } else { "from the next run on" }
        ),
        // Newer than this program.
        _ => String::new(),
    }
}

fn of_estimate(estimate: &Estimate) -> String {
    let Estimate { time_s, location_m, speed_mps, regime, validity, .. } = estimate;
    let mut text = format!(
        "{time_s:.1} s  {:.3} km \u{b1}{:.0} m  {:.1} \u{b1}{:.1} km/h  {regime}  {}",
        location_m.value / 1000.0,
        HALF_95 * location_m.sd,
        speed_mps.value * KMH,
        HALF_95 * speed_mps.sd * KMH,
        validity.as_str()
    );
    if let Some(cause) = validity.cause() {
        let _ = write!(text, " ({})", cause.as_str());
    }
    if estimate.learning {
        text.push_str("  learning");
    }
    text
}

/// `not learned yet`, or nothing to say.
pub const fn learned_words(learned: Learned) -> &'static str {
    match learned {
        Learned::NotYet => "not learned yet",
        Learned::Learned => "learned",
        Learned::OutOfBounds => "out of bounds",
        Learned::PredictsWorse => "predicts worse than the description",
        _ => "unknown",
    }
}

fn of_parameters(parameters: &Parameters) -> String {
    let at = parameters.at(100.0 / KMH);
    let term = |name: &str, value: Value| format!("{name} {:.3e} \u{b1}{:.1e}", value.value, HALF_95 * value.sd);
    format!(
        "this run: r(100 km/h) {:.5} \u{b1}{:.5} N/kg, {}; {}, {}, {}",
        at.value,
        HALF_95 * at.sd,
        learned_words(parameters.learned),
        term("r0", parameters.r0),
        term("r1", parameters.r1),
        term("r2", parameters.r2)
    )
}

fn of_effort(effort: &Effort) -> String {
    let known = |value: Option<f32>| value.map_or_else(|| "unknown".to_owned(), |value| format!("{value:+.4}"));
    format!(
        "{} N/kg within -{:.3} to {:.3}; acceleration {} m/s2, gradient {:+.4} N/kg",
        known(effort.effort_n_per_kg),
        effort.max_brake_n_per_kg,
        effort.max_traction_n_per_kg,
        known(effort.acceleration_mps2),
        effort.gradient_n_per_kg
    )
}

/// Two-sided 90 % of a normal distribution, in standard deviations.
pub const NINETY: f32 = 1.645;

/// What coasting leads to, with 90 % intervals; the time on the board's clock, or from `now_s` of it.
pub fn of_coast_ahead(ahead: &CoastAhead, now_s: Option<f64>) -> String {
    let target = ahead.target.map_or_else(String::new, |target| {
        let place = format!("{:.3} km", target.at_m / 1000.0);
        match target.limit_mps {
            Some(limit) => format!("the {:.0} km/h limit at {place}", limit * KMH),
            None => format!("the stop at {place}"),
        }
    });
    match ahead.outcome {
        CoastOutcome::Arrives(CoastArrival { speed_mps, time_s, time_sd_s }) => {
            let time = match now_s {
                None => format!("at {time_s:.0} s"),
                Some(now_s) => {
                    let left_s = (time_s - now_s).max(0.0).round() as u32;
                    format!("in {}:{:02}", left_s / 60, left_s % 60)
                }
            };
            format!(
                "{:.0} \u{b1}{:.0} km/h at {target} {time} \u{b1}{:.0} s (90 %)",
                speed_mps.value * KMH,
                NINETY * speed_mps.sd * KMH,
                NINETY * time_sd_s
            )
        }
        CoastOutcome::Stops(place) => format!(
            "stops at {:.1} \u{b1}{:.1} km (90 %), before {target}",
            place.value / 1000.0,
            NINETY * place.sd / 1000.0
        ),
        CoastOutcome::MayStop => format!("may stop before {target}"),
        CoastOutcome::NoTarget => "no stop or limit within the horizon".to_owned(),
        // Unknown, or newer than this program.
        _ => "no prediction".to_owned(),
    }
}

fn of_phase(phase: &Option<Phase>) -> String {
    phase.as_ref().map_or_else(
        || "none".to_owned(),
        |phase| {
            format!(
                "{:.0} s from {:.3} km, {:.1} km/h",
                phase.duration_s,
                phase.start_location_m / 1000.0,
                phase.start_speed_mps * KMH
            )
        },
    )
}

fn of_features(features: &Features) -> String {
    let power = features.max_power_w_per_kg.map_or_else(|| "none".to_owned(), |power| format!("{power:.2} W/kg"));
    let cruise =
        features.cruise_speed_median_mps.map_or_else(|| "none".to_owned(), |speed| format!("{:.1} km/h", speed * KMH));
    let rates: Vec<String> = features
        .brake_rate_mps2
        .iter()
        .map(|rate| if rate.count == 0 { "-".to_owned() } else { format!("{:.2}", rate.mean) })
        .collect();
    format!(
        "max power {power}, cruise {cruise}, brake {} m/s2, final coast {}, final brake {}",
        rates.join("/"),
        of_phase(&features.final_coast),
        of_phase(&features.final_brake)
    )
}

fn of_effects(effects: &Effects) -> String {
    let one = |effect: &Effect| {
        let name = EffectKind::from_number(effect.kind).map_or("unknown kind", EffectKind::name);
        let place = effect
            .section_m
            .map_or_else(String::new, |[from, to]| format!(" {:.3}-{:.3} km", from / 1000.0, to / 1000.0));
        let values: Vec<String> = effect.values.iter().map(|value| format!("{value}")).collect();
        format!("{name}{place} {}", values.join(" "))
    };
    let all: Vec<String> = effects.effects.iter().map(one).collect();
    if all.is_empty() { "none".to_owned() } else { all.join("; ") }
}

fn of_summary(summary: &RunSummary) -> String {
    let [r0, r1, r2] = summary.vehicle_davis.map(|term| term.value);
    format!(
        "run {}: the vehicle has r = {r0:.3e} + {r1:.3e} v + {r2:.3e} v2 N/kg; learned over {:.0} s",
        summary.run, summary.learned_s
    )
}
