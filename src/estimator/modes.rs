//! A judged measurement to its estimate, by mode.
//!
//! ```text
//! Paper               paper's loop -> recognise -> assemble
//! Gated, Measured     take up -> recognise -> learn -> assemble
//! ```

use super::config::{Config, Mode};
use super::run_state::RunState;
use crate::Real;
use crate::extremes::Extremes;
use crate::filter::elimination::NotPositiveDefinite;
use crate::filter::gaussian::Gaussian;
use crate::filter::ukf::Innovation;
use crate::model::effects::Acting;
use crate::model::effort::{self, Effort};
use crate::model::line::Line;
use crate::model::point::Point;
use crate::model::resistance::Davis;
use crate::model::state::{LOCATION, SIZE, SPEED, resistance_sd};
use crate::tick::effort_reading::MeanEffort;
use crate::tick::estimate::{Cause, Estimate, Validity};
use crate::tick::kinematics::Kinematics;
use crate::tick::learning::{self, Counts, LearningConfig, LeastChange, Tick, davis_of};
use crate::tick::paper::PaperLoop;
use crate::tick::plausibility::Judged;
use crate::tick::regime::{Evidence, Recogniser, Regime};
use crate::tick::short_hops::{self, Pieces};

/// Without a speed for longer than this the regime is unknown, s.
const LOST_S: Real = 60.0;
/// Where coasting is less likely than this no segment is tried.
const LEAST_COASTS: Real = 0.02;
/// An effort beyond this share of the described resistance is none of a coasting train, whatever the zero and the noise
/// of its sensor.
const POWERED_SHARE: Real = 0.5;
/// Below, wheels slip and couplers stretch, m/s.
const SLOWEST_MEASURED_MPS: Real = 3.0;

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
        next.drift(&config.paper_drift, judged.dt_s);
        match next.step(paper, line, acting, time_s, judged.dt_s, [location_m, speed_mps]) {
            Ok(found) => innovation = Some(found),
            Err(_) => {
                // The covariance is of no use any more: begin again with what was learned.
                run.counters.count(Cause::Numerics);
                validity = Validity::Held(Cause::Numerics);
                next = begin(&davis_of(&run.begin));
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
    if let Ok(speed_mps) = judged.speed_mps {
        run.hops.observe(&config.short_hops, judged.time_s, speed_mps, standing);
    }
    run.staircase.observe(&config.sensor, judged.dt_s as f32, judged.speed_mps.ok().map(|speed_mps| speed_mps as f32));
    let short_hops = run.hops.pieces(&config.short_hops, judged.time_s, run.staircase.is_clean());
    let reading = &mut run.effort_reading;
    let read_effort = match config.mode {
        Mode::Measured => {
            let change_share = config.learning.effort_change_share;
            reading.read(&config.effort_reading, change_share, judged.dt_s, judged.effort_n_per_kg)
        }
        Mode::Gated | Mode::Paper => None,
    };
    let recognition = recognise(config, run, line, acting, &now, ReadNow { read, standing, short_hops });
    let learned = match config.mode {
        // Of hops the effort column shows the ends of powering only, for then the train brakes: what its age and gain
        // are off by there the resistance would be. Coasts need neither.
        Mode::Measured if short_hops.is_some() => {
            run.waits = None;
            learn_coasting(config, run, line, acting, judged, &recognition, short_hops)
        }
        Mode::Measured => learn_measured(config, run, line, acting, judged, read_effort),
        Mode::Gated | Mode::Paper => learn_coasting(config, run, line, acting, judged, &recognition, short_hops),
    };
    let (innovation, validity) = match learned {
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
        learning: innovation.is_some() && run.learner.is_learning(),
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
        run.effort_reading.interrupt();
        run.waits = None;
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
struct ReadNow {
    /// There is one.
    read: bool,
    /// And it is that of a standing train.
    standing: bool,
    /// Of a train on short hops: what of its coasts counts.
    short_hops: Option<Pieces>,
}

/// What the recogniser says at a tick.
struct Recognition {
    effort: Option<Effort>,
    confirmed: Option<Regime>,
    /// Probability that the whole interval was coasted.
    coasted: Real,
    /// Where an interval ends, and the next one begins: the probability that the train coasts now.
    coasts: Option<Real>,
}

/// Effort and regime over the piece of evidence that ends now.
fn recognise(
    config: &Config,
    run: &mut RunState,
    line: &Line<'_>,
    acting: &Acting<'_>,
    now: &Point,
    ReadNow { read, standing, short_hops }: ReadNow,
) -> Recognition {
    let belief = run.learner.provisional();
    let [r0, r1, r2] = belief.mean.into();
    let davis = Davis { r0, r1, r2 };
    let over = |anchor| (anchor, effort::over_interval(line, acting, &davis, &anchor, now));
    let over = run.anchor.filter(|_| read).map(over);
    let mut recognition = Recognition {
        effort: over.map(|(_, effort)| effort),
        confirmed: run.unconfirmed.map(|_| run.regime),
        coasted: 0.0,
        coasts: None,
    };
    if standing {
        run.recogniser = Recogniser::standing();
        run.regime = Regime::Standstill;
        run.anchor = Some(*now);
        run.effort_reading.begin_interval();
        return recognition;
    }
    let Some((anchor, effort)) = over else {
        if read {
            run.anchor = Some(*now);
            run.effort_reading.begin_interval();
            run.regime = run.recogniser.regime();
        } else if run.anchor.is_some_and(|anchor| now.time_s - anchor.time_s > LOST_S) {
            run.anchor = None;
            run.recogniser = Recogniser::default();
        }
        return recognition;
    };
    let mut evidence = evidence(config, line, acting, &belief, [&anchor, now], &effort);
    let speed_sd_mps = evidence.acceleration_sd_mps2 * evidence.interval_s;
    if let Some(sd_mps) = short_hops.and_then(|pieces| pieces.speed_sd_mps) {
        evidence.acceleration_sd_mps2 = (core::f32::consts::SQRT_2 * sd_mps / evidence.interval_s as f32).into();
    }
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
    let usual_s = config.recogniser.interval_s;
    let interval_s = short_hops.map_or(usual_s, |pieces| usual_s.at_most(pieces.interval_s));
    if evidence.interval_s >= 0.95 * interval_s {
        recognition.coasts = Some(recognised.now.of(Regime::Coast));
        run.recogniser = recognised.now;
        run.anchor = Some(*now);
        if config.mode == Mode::Measured && anchor.speed_mps.at_most(now.speed_mps) > SLOWEST_MEASURED_MPS {
            let sd = [speed_sd_mps, evidence.resistance_sd_n_per_kg];
            let effort = effort::over_steps(line, acting, &davis, [&anchor, now], config.learning.sub_step_s);
            run.effort_reading.compare(&config.effort_reading, evidence.interval_s, &effort, sd, run.learner.gain());
        } else {
            run.effort_reading.begin_interval();
        }
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
    let of_track = config.track_doubt.mean_sd_n_per_kg(line, to.location_m, midway_mps, interval_s);
    let of_train = resistance_sd(belief, midway_mps);
    Evidence {
        interval_s,
        acceleration_mps2: effort.acceleration_mps2,
        acceleration_sd_mps2: core::f64::consts::SQRT_2 * config.sensor.speed_sd_mps() / interval_s,
        resistance_n_per_kg: effort.resistance_n_per_kg,
        // The same where the track is certain, and there for nothing.
        resistance_sd_n_per_kg: if of_track > 0.0 { crate::roots::hypotenuse(of_train, of_track) } else { of_train },
        max_effort_n_per_kg,
    }
}

/// Of no effort.
fn tick(config: &Config, run: &RunState, line: &Line<'_>, judged: &Judged) -> Tick {
    let now = &run.kinematics.belief().mean;
    Tick {
        track_density: config.track_doubt.density(line, now[LOCATION], now[SPEED]),
        time_s: judged.time_s,
        dt_s: judged.dt_s,
        location_m: judged.location_m.ok(),
        speed_mps: judged.speed_mps.ok(),
        effort: MeanEffort::default(),
    }
}

/// One row of measured effort: the tick that waits teaches, of which the `effort` is known now, and the one that ends
/// here waits. Rows without an effort lie within a tick. Out: the innovation of a step of the segment.
fn learn_measured(
    config: &Config,
    run: &mut RunState,
    line: &Line<'_>,
    acting: &Acting<'_>,
    judged: &Judged,
    effort: Option<MeanEffort>,
) -> Result<Option<Innovation<2>>, NotPositiveDefinite> {
    // A speed that is missing says nothing; one that is not believed may be a slip.
    let read = judged.speed_mps.is_ok() || judged.speed_mps == Err(Cause::NoSpeed);
    let runs = run.kinematics.belief().mean[SPEED] > SLOWEST_MEASURED_MPS;
    let usual = read && runs && judged.contradiction.is_none();
    let within = run.effort_reading.waits();
    let learned = if within { Ok(None) } else { learn_waiting(config, run, line, acting, effort) };
    if !usual {
        run.waits = None;
    } else if !within {
        let ends = Tick { dt_s: run.effort_reading.tick_s(), ..tick(config, run, line, judged) };
        run.waits = Some((ends, run.kinematics.belief()));
    }
    // Where no tick waits the segment would stay one behind.
    if run.waits.is_none() {
        run.learner.end();
    }
    learned
}

/// Begins, continues or ends a segment of measured effort with the tick that waits. Out: the innovation of a step of
/// it.
fn learn_waiting(
    config: &Config,
    run: &mut RunState,
    line: &Line<'_>,
    acting: &Acting<'_>,
    effort: Option<MeanEffort>,
) -> Result<Option<Innovation<2>>, NotPositiveDefinite> {
    match (&mut run.waits, effort) {
        (Some((tick, _)), Some(effort)) if run.learner.in_segment() => {
            tick.effort = effort;
            return run.learner.step(
                &config.learning,
                &config.sensor,
                line,
                acting,
                tick,
                &usual(config, LeastChange::None),
            );
        }
        (Some((tick, moving)), Some(_)) if tick.location_m.is_some() && tick.speed_mps.is_some() => {
            run.learner.begin(tick.time_s, moving, true);
        }
        (Some(_), Some(_)) => {}
        _ => run.learner.end(),
    }
    Ok(None)
}

/// By its effort column the train powers or brakes, which the speed alone may not show: a speed that is held on a
/// gentle slope falls and rises like a coast.
fn is_powered(config: &Config, judged: &Judged, described_n_per_kg: Real) -> bool {
    let is_power = |effort: Real| effort.abs() > POWERED_SHARE * described_n_per_kg;
    config.mode == Mode::Measured && judged.effort_n_per_kg.is_some_and(is_power)
}

/// What of a segment counts, but on short hops: it was believed when it began.
fn usual(config: &Config, least_change: LeastChange) -> Counts {
    let LearningConfig { end_cut_s, min_segment_s, .. } = config.learning;
    Counts {
        believed: false,
        end_cut_s,
        min_segment_s,
        least_change,
        on_short_hops: false,
        edge: None,
        speed_sd_mps: None,
    }
}

/// The same of coasting. On short hops a segment runs on trial from the end of an interval on, until it is believed or
/// not; else it begins after an interval that was coasted as a whole.
fn learn_coasting(
    config: &Config,
    run: &mut RunState,
    line: &Line<'_>,
    acting: &Acting<'_>,
    judged: &Judged,
    recognition: &Recognition,
    short_hops: Option<Pieces>,
) -> Result<Option<Innovation<2>>, NotPositiveDefinite> {
    let Config { learning, short_hops: short, .. } = config;
    let coasted = recognition.coasted;
    let are_short = short_hops.is_some();
    let speed_mps = run.kinematics.belief().mean[SPEED];
    let visible = if are_short {
        let described_n_per_kg = line.train.davis().resistance_n_per_kg(speed_mps);
        described_n_per_kg > short.min_resistance_n_per_kg
            && !is_powered(config, judged, described_n_per_kg)
            && !run.staircase.is_another_unit()
    } else {
        speed_mps > learning.min_speed_kmh / 3.6
    };
    let read = judged.speed_mps.is_ok();
    // A missing speed says nothing about the regime: a segment waits for the next one.
    let least = if are_short { short_hops::END_PROBABILITY } else { learning.end_probability };
    let goes_on = judged.contradiction.is_none() && (!read || (visible && coasted > least));
    if !are_short && !run.learner.is_learning() {
        // On trial since a hop that was expected to be short.
        run.learner.end();
    }
    let mut innovation = None;
    if !goes_on {
        run.learner.end();
    } else if run.learner.in_segment() {
        let counts = if let Some(Pieces { end_cut_s, min_segment_s, least_change, speed_sd_mps, .. }) = short_hops {
            let believed = read && run.learner.unbroken(coasted) > short.believe_probability;
            Counts {
                believed,
                end_cut_s,
                min_segment_s,
                least_change,
                on_short_hops: true,
                // Such speeds are finer than an edge.
                edge: run.staircase.edge().filter(|_| speed_sd_mps.is_none()),
                speed_sd_mps,
            }
        } else {
            usual(config, LeastChange::Share(learning::MIN_CHANGE_SHARE))
        };
        let tick = tick(config, run, line, judged);
        let stepped = run.learner.step(learning, &config.sensor, line, acting, &tick, &counts)?;
        innovation = stepped.filter(|_| read && run.learner.is_learning());
    } else if !are_short && read && coasted > learning.begin_probability && judged.location_m.is_ok() {
        run.learner.begin(judged.time_s, &run.kinematics.belief(), true);
    }
    if let Some(coasts) = recognition.coasts.filter(|_| are_short && visible && judged.contradiction.is_none()) {
        run.learner.end_of_interval(coasted, coasts, short.begin_probability);
        if !run.learner.in_segment() && coasts > LEAST_COASTS && judged.location_m.is_ok() {
            run.learner.begin(judged.time_s, &run.kinematics.belief(), false);
        }
    }
    Ok(innovation)
}
