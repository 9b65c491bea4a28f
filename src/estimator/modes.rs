//! A judged measurement to its estimate, by mode.
//!
//! ```text
//! Paper               paper's loop -> recognise -> assemble
//! Gated, Measured     take up -> recognise -> learn -> assemble
//! ```

use super::config::{Config, Mode};
use super::run_state::RunState;
use crate::Real;
use crate::filter::elimination::NotPositiveDefinite;
use crate::filter::gaussian::Gaussian;
use crate::filter::ukf::Innovation;
use crate::model::effects::Acting;
use crate::model::effort::{self, Effort};
use crate::model::line::Line;
use crate::model::point::Point;
use crate::model::resistance::Davis;
use crate::model::state::{LOCATION, SIZE, SPEED, resistance_sd};
use crate::tick::estimate::{Cause, Estimate, Validity};
use crate::tick::kinematics::Kinematics;
use crate::tick::learning::Tick;
use crate::tick::paper::PaperLoop;
use crate::tick::plausibility::Judged;
use crate::tick::regime::{Evidence, Recogniser, Regime};

/// Without a speed for longer than this the regime is unknown, s.
const LOST_S: Real = 60.0;

/// The paper's loop: one filter over the whole run.
pub(super) fn paper_tick(
    config: &Config,
    run: &mut RunState,
    line: &Line<'_>,
    acting: &Acting<'_>,
    judged: &Judged,
    validity: Validity,
) -> Estimate {
    let paper = &config.paper;
    let (location_m, speed_mps) = (judged.location_m.ok(), judged.speed_mps.ok());
    let time_s = judged.time_s;
    let begin = |davis: &Gaussian<3>| PaperLoop::begin(paper, line, acting, time_s, davis, location_m, speed_mps);
    let davis = run.davis();
    let mut innovation = None;
    let mut validity = validity;
    let mut next = match run.paper {
        Some(before) if !judged.begins => before,
        _ => begin(&davis),
    };
    if !judged.begins {
        match next.step(paper, line, acting, time_s, judged.dt_s, [location_m, speed_mps]) {
            Ok(found) => innovation = Some(found),
            Err(_) => {
                // The covariance is of no use any more: begin again with what was learned.
                run.counters.count(Cause::Numerics);
                validity = Validity::Held(Cause::Numerics);
                next = begin(&run.begin);
            }
        }
    }
    run.paper = Some(next);
    run.last = Some(point(time_s, &next.belief));
    let confirmed = run.unconfirmed.map(|_| run.regime);
    run.regime = config.paper_rule.recognise(next.effort_n_per_kg, next.acceleration_mps2);
    Estimate {
        effort_n_per_kg: Some(next.effort_n_per_kg),
        acceleration_mps2: Some(next.acceleration_mps2),
        confirmed,
        learning: innovation.is_some(),
        innovation,
        ..assemble(judged, line, next.belief, run.regime, validity)
    }
}

/// The resistance is learned in segments of known effort: none while coasting, or measured.
pub(super) fn learning_tick(
    config: &Config,
    run: &mut RunState,
    line: &Line<'_>,
    acting: &Acting<'_>,
    judged: &Judged,
    validity: Validity,
) -> Estimate {
    let now = take_up(config, run, line, judged);
    let read = judged.speed_mps.is_ok();
    let standing = read && now.speed_mps <= 0.25 * config.sensor.speed_quantum_kmh / 3.6;
    let recognition = recognise(config, run, line, acting, &now, Reading { read, standing });
    let effort = known_effort(config, run, judged, &now, &recognition, standing);
    run.last_effort_n_per_kg = judged.effort_n_per_kg;
    let (innovation, validity) = match learn(config, run, line, acting, judged, effort) {
        Ok(innovation) => (innovation, validity),
        Err(_) => {
            run.counters.count(Cause::Numerics);
            (None, Validity::Held(Cause::Numerics))
        }
    };
    if read {
        run.last = Some(now);
    }
    Estimate {
        effort_n_per_kg: recognition.effort.map(|effort| effort.effort_n_per_kg),
        acceleration_mps2: recognition.effort.map(|effort| effort.acceleration_mps2),
        confirmed: recognition.confirmed,
        learning: innovation.is_some() && run.learner.in_segment(),
        innovation,
        ..assemble(judged, line, run.belief(), run.regime, validity)
    }
}

/// What every estimate says, whatever was recognised and learned.
fn assemble(judged: &Judged, line: &Line<'_>, belief: Gaussian<SIZE>, regime: Regime, validity: Validity) -> Estimate {
    Estimate {
        time_s: judged.sender_s,
        dt_s: judged.dt_s,
        belief,
        effort_n_per_kg: None,
        acceleration_mps2: None,
        gradient_n_per_kg: line.gradient_n_per_kg(belief.mean[LOCATION]),
        regime,
        confirmed: None,
        learning: false,
        innovation: None,
        validity,
    }
}

fn point<const N: usize>(time_s: Real, belief: &Gaussian<N>) -> Point {
    Point { time_s, location_m: belief.mean[LOCATION], speed_mps: belief.mean[SPEED] }
}

/// Takes up the readings. Out: where the train is, by them.
fn take_up(config: &Config, run: &mut RunState, line: &Line<'_>, judged: &Judged) -> Point {
    let (location_m, speed_mps) = (judged.location_m.ok(), judged.speed_mps.ok());
    if judged.begins {
        run.kinematics = Kinematics::begin(&config.sensor, location_m, speed_mps);
        run.recogniser = Recogniser::default();
        run.anchor = None;
        run.last = None;
        run.last_effort_n_per_kg = None;
        run.learner.end();
    } else {
        run.kinematics.step(&config.sensor, line.direction.sign(), judged.dt_s, location_m, speed_mps);
        if let Some(location_m) = location_m
            && (location_m - run.kinematics.belief().mean[LOCATION]).abs() > config.plausibility.location_jump_m
        {
            run.kinematics.anchor(&config.sensor, location_m);
            run.learner.end();
        }
    }
    point(judged.time_s, &run.kinematics.belief())
}

/// What the speed reading of a tick says at once.
#[derive(Clone, Copy)]
struct Reading {
    /// There is one.
    read: bool,
    /// And it is that of a standing train.
    standing: bool,
}

/// What the recogniser says at a tick.
struct Recognition {
    effort: Option<Effort>,
    confirmed: Option<Regime>,
    /// Probability that the whole interval was coasted.
    coasted: Real,
}

/// Effort and regime over the piece of evidence that ends now.
fn recognise(
    config: &Config,
    run: &mut RunState,
    line: &Line<'_>,
    acting: &Acting<'_>,
    now: &Point,
    Reading { read, standing }: Reading,
) -> Recognition {
    let belief = run.learner.provisional();
    let [r0, r1, r2] = belief.mean.into();
    let over = |anchor| (anchor, effort::over_interval(line, acting, &Davis { r0, r1, r2 }, &anchor, now));
    let over = run.anchor.filter(|_| read).map(over);
    let mut recognition = Recognition {
        effort: over.map(|(_, effort)| effort),
        confirmed: run.unconfirmed.map(|_| run.regime),
        coasted: 0.0,
    };
    if standing {
        run.recogniser = Recogniser::standing();
        run.regime = Regime::Standstill;
        run.anchor = Some(*now);
        return recognition;
    }
    let Some((anchor, effort)) = over else {
        if read {
            run.anchor = Some(*now);
            run.regime = run.recogniser.regime();
        } else if run.anchor.is_some_and(|anchor| now.time_s - anchor.time_s > LOST_S) {
            run.anchor = None;
            run.recogniser = Recogniser::default();
        }
        return recognition;
    };
    let evidence = evidence(config, line, acting, &belief, [&anchor, now], &effort);
    let recognised = run.recogniser.step(&config.recogniser, &evidence);
    run.regime = recognised.now.regime();
    recognition.coasted = recognised.coasted;
    let slow_log = run.last.is_none_or(|last| last.time_s == anchor.time_s);
    // In a fast log the regime a tick later is the answer; in a slow one the interval speaks for its beginning.
    recognition.confirmed = run.unconfirmed.map(|last| match (last.regime, slow_log) {
        (Regime::Standstill, _) => Regime::Standstill,
        (_, true) => recognised.before.regime(),
        (_, false) => run.regime,
    });
    if evidence.interval_s >= 0.95 * config.recogniser.interval_s {
        run.recogniser = recognised.now;
        run.anchor = Some(*now);
    }
    recognition
}

fn evidence(
    config: &Config,
    line: &Line<'_>,
    acting: &Acting<'_>,
    belief: &Gaussian<3>,
    [from, to]: [&Point; 2],
    effort: &Effort,
) -> Evidence {
    let interval_s = to.time_s - from.time_s;
    let midway_mps = 0.5 * (from.speed_mps + to.speed_mps);
    let (max_effort_n_per_kg, _) = acting.limits_n_per_kg(line.train, to.location_m, midway_mps);
    Evidence {
        interval_s,
        acceleration_mps2: effort.acceleration_mps2,
        acceleration_sd_mps2: core::f64::consts::SQRT_2 * config.sensor.speed_sd_mps() / interval_s,
        resistance_n_per_kg: effort.resistance_n_per_kg,
        resistance_sd_n_per_kg: resistance_sd(belief, midway_mps),
        max_effort_n_per_kg,
    }
}

/// An effort over the interval and its standard deviation, N/kg.
type Known = (Real, Real);

/// The effort, where it is known well enough to learn from.
fn known_effort(
    config: &Config,
    run: &RunState,
    judged: &Judged,
    now: &Point,
    recognition: &Recognition,
    standing: bool,
) -> Option<Known> {
    let learning = &config.learning;
    match config.mode {
        Mode::Gated => {
            let enough = if run.learner.in_segment() { learning.end_probability } else { learning.begin_probability };
            let fast = now.speed_mps > learning.min_speed_kmh / 3.6;
            (recognition.coasted > enough && fast).then_some((0.0, 0.0))
        }
        // Its mean, and how uncertain that is. Not while braking, whose effort has another gain.
        Mode::Measured if !standing => {
            let (before, now) = (run.last_effort_n_per_kg?, judged.effort_n_per_kg?);
            let applied = before.min(now) > -0.01 && judged.speed_mps.ok()? > 3.0;
            applied.then_some((0.5 * (before + now), learning.effort_change_share * (now - before).abs()))
        }
        Mode::Measured | Mode::Paper => None,
    }
}

/// Begins, continues or ends a segment. Out: the innovation of a step of a segment with a known effort.
fn learn(
    config: &Config,
    run: &mut RunState,
    line: &Line<'_>,
    acting: &Acting<'_>,
    judged: &Judged,
    effort: Option<Known>,
) -> Result<Option<Innovation<2>>, NotPositiveDefinite> {
    let tick = |(effort_n_per_kg, effort_sd_n_per_kg)| Tick {
        time_s: judged.time_s,
        dt_s: judged.dt_s,
        location_m: judged.location_m.ok(),
        speed_mps: judged.speed_mps.ok(),
        effort_n_per_kg,
        effort_sd_n_per_kg,
    };
    let contradicted = judged.contradiction.is_some();
    let read = judged.speed_mps.is_ok();
    // A missing speed says nothing about the regime: a coasted segment waits for the next one.
    let waits = !read && !contradicted && config.mode == Mode::Gated;
    match effort.filter(|_| !contradicted) {
        Some(known) if run.learner.in_segment() => {
            return run.learner.step(&config.learning, &config.sensor, line, acting, &tick(known));
        }
        Some(_) if read && judged.location_m.is_ok() => run.learner.begin(judged.time_s, &run.kinematics.belief()),
        Some(_) => {}
        None if waits && run.learner.in_segment() => {
            if run.learner.step(&config.learning, &config.sensor, line, acting, &tick((0.0, 0.0))).is_err() {
                run.learner.end();
            }
        }
        None => run.learner.end(),
    }
    Ok(None)
}
