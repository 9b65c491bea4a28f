//! The driver: from what can be seen ahead to an effort and a regime, step by step.
//!
//! In: time, location and speed. Out: effort in N/kg for the next step, and what the driver is doing.
//!
//! ```text
//! Stand -> Power -> Hold (or Power <-> Coast) -> Coast -> Brake -> Hold or Coast at 40 km/h -> Brake -> Stand
//! ```
//!
//! Effort never jumps: it is raised at the driver's own rate, let go faster, and the brake builds up over 2 to 3 s. A
//! regime begins when the effort has followed: power being let go before a coast is still traction or cruise, and
//! before a brake as well. The driver is skilled: the load of the train is known, so braking ends where it should
//! whatever the gradient.

use crate::habits::{Cruising, Habits, Plateau};
use crate::motion::Motion;
pub use crate::regime::Regime;
use crate::world::{History, World};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};

/// Power is let go this fast, N/kg per s.
const LET_GO_N_PER_KG_S: f64 = 0.15;
/// The brake is released this fast, N/kg per s.
const RELEASE_N_PER_KG_S: f64 = 0.3;
/// Gains of the hold, 1/s and 1/s².
const HOLD_GAIN: f64 = 0.08;
const HOLD_INTEGRAL_GAIN: f64 = 0.004;
/// Power tapers as the wanted speed comes near, 1/s.
const TAPER_GAIN: f64 = 0.25;
/// Gravity on a climb that may brake harder than wanted, N/kg, and the share of the traction used against it.
const STEEP_N_PER_KG: f64 = 0.11;
const POWER_ON_CLIMB: f64 = 0.9;
/// Time constant of the wander of the speed held, s.
const WANDER_S: f64 = 20.0;
/// The final coast ends in a brake for a stop that is at most this far behind the sign, m; further if all signs between
/// lower the limit.
const APPROACH_M: f64 = 1_500.0;
/// The final coast begins where the speed kept is above this share of the cruise speed.
const LEAST_OPEN_SHARE: f64 = 0.5;
const LONG_APPROACH_M: f64 = 5_000.0;
/// A coast this much above the limit on a downgrade is restrained, m/s.
const OVERSPEED_MPS: f64 = 0.6;

/// A lever with notches is moved after at least this time, s.
const NOTCH_S: f64 = 3.0;

/// The trial of the brake takes this much speed off, m/s.
const BRAKE_TEST_MPS: f64 = 10.0 / 3.6;

/// A place to stop at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stop {
    /// Where, m.
    pub at_m: f64,
    /// How long, s.
    pub dwell_s: f64,
    /// At a platform: known in advance, so coasted to. Otherwise a red signal: braked for at the last moment.
    pub planned: bool,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Target {
    at_m: f64,
    speed_mps: f64,
    /// Part of the approach to a planned stop.
    approach: bool,
    /// A sign or a stop stands there; without, the brake is only tried.
    sign: bool,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum CoastKind {
    Final,
    Cycle,
    Plateau,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Phase {
    Stand { until_s: f64 },
    Power,
    Hold,
    Coast(CoastKind),
    Restrain(CoastKind),
    Brake(Target),
}

/// One driver on one line. Asked once a step with [`Driver::act`].
#[derive(Debug)]
pub struct Driver<'a> {
    habits: Habits,
    world: &'a World,
    history: History,
    stops: Vec<Stop>,
    stops_made: usize,
    phase: Phase,
    regime: Regime,
    effort_n_per_kg: f64,
    /// Of a lever that has notches, and since when.
    notch: u8,
    notch_since_s: f64,
    integral_n_per_kg: f64,
    wander_mps: f64,
    wander_rng: ChaCha8Rng,
    seconds: f64,
    /// A lower limit already braked for but not yet passed.
    ahead: Option<Target>,
    /// Between the approach brake and the stop.
    plateau: bool,
    /// Location of the last stop.
    left_m: f64,
    /// Where the approach to the next stop begins: its first sign, or itself.
    approach_from_m: f64,
    /// The first top of a cycle has been reached.
    cycling: bool,
    /// This coast keeps a little of the brake on.
    brakes_lightly: bool,
    /// The brake has been tried, or need not be.
    brake_tested: bool,
}

impl<'a> Driver<'a> {
    /// A driver standing at the first platform. `stops` in order; the last one ends the run.
    pub fn new(habits: Habits, world: &'a World, stops: Vec<Stop>, wander_rng: ChaCha8Rng) -> Self {
        let approach_from_m = stops.first().map_or(0.0, |stop| approach_from_m(world, stop));
        Self {
            habits,
            world,
            history: History::default(),
            stops,
            stops_made: 0,
            phase: Phase::Stand { until_s: habits.departure_s },
            regime: Regime::Standstill,
            effort_n_per_kg: 0.0,
            notch: 0,
            notch_since_s: f64::NEG_INFINITY,
            integral_n_per_kg: 0.0,
            wander_mps: 0.0,
            wander_rng,
            seconds: -1.0,
            ahead: None,
            plateau: false,
            left_m: 0.0,
            approach_from_m,
            cycling: false,
            brakes_lightly: false,
            brake_tested: false,
        }
    }

    /// What is done in the step that begins here: demanded effort (held over the step) and its label while moving.
    /// `at` is what the driver sees: the speed is that of the speedometer.
    pub fn act(&mut self, history: History, at: Motion, step_s: f64) -> (f64, Regime) {
        let time_s = history.time_s;
        self.history = history;
        // Slow decisions on whole seconds, so that a finer step changes nothing else.
        let second = (time_s + step_s / 2.0).floor();
        if second > self.seconds {
            self.seconds = second;
            self.wander();
            self.begin_final_coast(at);
        }
        let coasted = matches!(self.phase, Phase::Coast(_));
        self.choose(time_s, at);
        // Without such a driver nothing is drawn, and all else stays as it is.
        if !coasted && matches!(self.phase, Phase::Coast(_)) && self.world.coast_brake_n_per_kg > 0.0 {
            self.brakes_lightly = self.wander_rng.random_bool(0.5);
        }
        let wanted = self.wanted_n_per_kg(at, step_s);
        let wanted = if self.world.notches == 0 { wanted } else { self.by_notches_n_per_kg(wanted, time_s, at) };
        self.effort_n_per_kg = self.follow(wanted, at, step_s);
        self.regime = self.label();
        (self.effort_n_per_kg, self.regime)
    }

    /// Between the approach brake and the stop.
    pub fn on_plateau(&self) -> bool {
        self.plateau
    }

    /// Stops made so far.
    pub fn stops_made(&self) -> usize {
        self.stops_made
    }

    fn load_n_per_kg(&self, at: Motion) -> f64 {
        self.world.load_n_per_kg(self.history, at)
    }

    fn next_stop(&self) -> Option<Stop> {
        self.stops.get(self.stops_made).copied()
    }

    /// The speed this driver keeps under a limit.
    fn kept_mps(&self, limit_mps: f64) -> f64 {
        if limit_mps > self.habits.cruise_mps - 2.0 / 3.6 {
            self.habits.cruise_mps
        } else {
            limit_mps * self.habits.zone_share
        }
    }

    fn permitted_mps(&self, at: Motion) -> f64 {
        let world = self.world;
        world.line.permitted_mps(at.location_m, world.train.length_m)
    }

    fn desired_mps(&self, at: Motion) -> f64 {
        let here = self.kept_mps(self.permitted_mps(at));
        self.ahead.map_or(here, |target| here.min(target.speed_mps))
    }

    fn wander(&mut self) {
        let keep = (-1.0 / WANDER_S).exp();
        let unit = Normal::new(0.0, 1.0).expect("constant").sample(&mut self.wander_rng);
        self.wander_mps = keep * self.wander_mps + self.habits.wander_sd_mps * (1.0 - keep * keep).sqrt() * unit;
    }

    /// The first place ahead that must be braked for now.
    fn due(&self, at: Motion) -> Option<Target> {
        let stop = self.next_stop()?;
        let stop_m = if stop.planned { stop.at_m + self.habits.stop_error_m } else { stop.at_m };
        let full = self.habits.brake.distance_m(at.speed_mps) + at.speed_mps * self.habits.brake.build_up_s / 2.0;
        let limits = self.world.line.limits_kmh();
        let signs = limits
            .windows(2)
            .filter(|pair| pair[1].1 < pair[0].1 && pair[1].0 > at.location_m && pair[1].0 < stop_m)
            .map(|pair| Target {
                at_m: pair[1].0,
                speed_mps: self.kept_mps(pair[1].1 / 3.6),
                approach: stop.planned && pair[1].0 >= self.approach_from_m,
                sign: true,
            });
        let stop = Target { at_m: stop_m, speed_mps: 0.0, approach: stop.planned, sign: true };
        signs.chain([stop]).find(|target| {
            let needed_m = full - self.habits.brake.distance_m(target.speed_mps);
            (target.speed_mps == 0.0 || at.speed_mps > target.speed_mps + 0.3)
                && needed_m >= target.at_m - at.location_m
        })
    }

    /// Begins the final coast when it would now last as long as the driver likes, or less.
    fn begin_final_coast(&mut self, at: Motion) {
        let cruising = match self.phase {
            Phase::Power | Phase::Hold => true,
            Phase::Coast(kind) => kind == CoastKind::Cycle,
            _ => false,
        };
        let desired_mps = self.desired_mps(at);
        let open_line = desired_mps > LEAST_OPEN_SHARE * self.habits.cruise_mps && at.speed_mps >= 0.9 * desired_mps;
        if cruising && open_line && self.coast_reaches_brake(at) {
            self.phase = Phase::Coast(CoastKind::Final);
        }
    }

    /// Looks ahead in steps of a second: does a coast from here end in the brake for the platform, in time and not too
    /// slow?
    fn coast_reaches_brake(&self, mut at: Motion) -> bool {
        let Some(stop) = self.next_stop().filter(|stop| stop.planned) else {
            return false;
        };
        let coast_s = self.habits.coast_on_s(stop.at_m - self.left_m);
        // Too far even without any loss of speed and with 1 km for the brake: spares the look ahead on most of the
        // line.
        let reach_m = 1.3 * self.habits.cruise_mps * coast_s + 3_000.0;
        if coast_s == 0.0 || self.approach_from_m - at.location_m > reach_m {
            return false;
        }
        let mut time_s = 0.0;
        while time_s <= coast_s && at.speed_mps >= self.habits.least_coast_mps {
            if let Some(target) = self.due(at) {
                return target.approach;
            }
            let then = History { time_s: self.history.time_s + time_s, ..self.history };
            at = self.world.advance(then, at, 0.0, 1.0);
            at.speed_mps = at.speed_mps.min(self.permitted_mps(at) + OVERSPEED_MPS);
            time_s += 1.0;
        }
        false
    }

    fn choose(&mut self, time_s: f64, at: Motion) {
        if self.ahead.is_some_and(|target| at.location_m > target.at_m) {
            self.ahead = None;
        }
        match self.phase {
            Phase::Stand { until_s } => {
                if time_s >= until_s && self.next_stop().is_some() {
                    self.phase = Phase::Power;
                }
            }
            Phase::Brake(target) if target.speed_mps == 0.0 => {
                if at.speed_mps == 0.0 {
                    self.arrive(time_s, at.location_m);
                }
            }
            Phase::Brake(target) => self.phase = self.brake_to(target, at),
            _ => {
                let due = self.due(at).or_else(|| self.brake_test(at));
                self.phase = due.map_or_else(|| self.drive_on(at), Phase::Brake);
            }
        }
    }

    /// On from a brake to a lower speed: for a stop behind it, or as it is driven there.
    fn brake_to(&mut self, target: Target, at: Motion) -> Phase {
        if let Some(stop) = self.due(at).filter(|t| t.speed_mps == 0.0) {
            return Phase::Brake(stop);
        }
        if at.speed_mps > target.speed_mps + 0.05 {
            return Phase::Brake(target);
        }
        if !target.sign {
            return Phase::Power;
        }
        self.ahead = Some(target);
        self.plateau = target.approach;
        if target.approach && self.habits.plateau == Plateau::Coast {
            Phase::Coast(CoastKind::Plateau)
        } else {
            self.hold(at)
        }
    }

    /// The brake is tried once, where the train is fast enough under power.
    fn brake_test(&mut self, at: Motion) -> Option<Target> {
        let is_now = self.phase == Phase::Power
            && !self.brake_tested
            && self.habits.brake_test_mps.is_some_and(|v| at.speed_mps >= v);
        if !is_now {
            return None;
        }
        self.brake_tested = true;
        let speed_mps = at.speed_mps - BRAKE_TEST_MPS;
        let brake = &self.habits.brake;
        Some(Target {
            at_m: at.location_m + brake.distance_m(at.speed_mps) - brake.distance_m(speed_mps)
                + at.speed_mps * brake.build_up_s,
            speed_mps,
            approach: false,
            sign: false,
        })
    }

    /// Where nothing is braked for.
    fn drive_on(&mut self, at: Motion) -> Phase {
        let desired = self.desired_mps(at);
        let cycles = match self.habits.cruising {
            Cruising::Cycles { half_width_mps, .. } if desired == self.habits.cruise_mps => Some(half_width_mps),
            _ => None,
        };
        match (self.phase, cycles) {
            (Phase::Power, Some(half)) if at.speed_mps >= desired + half => {
                self.cycling = true;
                Phase::Coast(CoastKind::Cycle)
            }
            (Phase::Power, None) if at.speed_mps >= desired - 0.15 => self.hold(at),
            (Phase::Hold, _) if at.speed_mps < desired - 2.0 => Phase::Power,
            (Phase::Coast(CoastKind::Cycle), Some(half)) if at.speed_mps <= desired - half => Phase::Power,
            (Phase::Coast(CoastKind::Final), _) if at.speed_mps < self.habits.least_coast_mps => Phase::Power,
            (Phase::Coast(CoastKind::Plateau), _) if at.speed_mps < 25.0 / 3.6 => self.hold(at),
            (Phase::Coast(kind), _)
                if at.speed_mps > self.permitted_mps(at) + OVERSPEED_MPS && self.load_n_per_kg(at) < 0.0 =>
            {
                Phase::Restrain(kind)
            }
            (Phase::Restrain(kind), _)
                if at.speed_mps < self.permitted_mps(at) + 0.1 || self.load_n_per_kg(at) >= 0.0 =>
            {
                Phase::Coast(kind)
            }
            (same, _) => same,
        }
    }

    fn hold(&mut self, at: Motion) -> Phase {
        self.integral_n_per_kg = self.load_n_per_kg(at);
        Phase::Hold
    }

    fn arrive(&mut self, time_s: f64, at_m: f64) {
        self.left_m = at_m;
        let dwell_s = self.next_stop().map_or(0.0, |stop| stop.dwell_s);
        self.stops_made += 1;
        if let Some(stop) = self.next_stop() {
            self.approach_from_m = approach_from_m(self.world, &stop);
        }
        self.plateau = false;
        self.cycling = false;
        self.ahead = None;
        self.phase = Phase::Stand { until_s: time_s + dwell_s };
    }

    fn wanted_n_per_kg(&mut self, at: Motion, step_s: f64) -> f64 {
        let desired = self.desired_mps(at);
        let traction = self.world.max_effort_n_per_kg(at, self.habits.effort_share, self.habits.power_share);
        match self.phase {
            Phase::Stand { .. } => 0.0,
            Phase::Coast(_) if self.brakes_lightly => -self.world.coast_brake_n_per_kg,
            Phase::Coast(_) => 0.0,
            Phase::Power => match self.habits.cruising {
                Cruising::Cycles { effort_n_per_kg, .. } if desired == self.habits.cruise_mps => {
                    if self.cycling {
                        traction.min(effort_n_per_kg)
                    } else {
                        traction
                    }
                }
                _ => traction.min(self.load_n_per_kg(at) + TAPER_GAIN * (desired - at.speed_mps)),
            },
            Phase::Hold => {
                let short = desired + self.wander_mps - at.speed_mps;
                let wanted = self.integral_n_per_kg + HOLD_GAIN * short;
                // The integral waits while the effort is at its limit.
                if wanted < traction {
                    self.integral_n_per_kg += HOLD_INTEGRAL_GAIN * short * step_s;
                }
                wanted.clamp(-0.3, traction)
            }
            Phase::Restrain(_) => {
                let over = at.speed_mps - self.permitted_mps(at);
                (self.load_n_per_kg(at) - 0.1 * over).clamp(-0.3, 0.0)
            }
            Phase::Brake(target) => {
                let needed_m =
                    self.habits.brake.distance_m(at.speed_mps) - self.habits.brake.distance_m(target.speed_mps);
                let left_m = (target.at_m - at.location_m).max(1e-3);
                let scale = (needed_m / left_m).clamp(0.5, 1.6);
                let deceleration = self.habits.brake.rate_mps2(at.speed_mps) * scale;
                let most = self.world.max_brake_n_per_kg();
                // On a steep climb the hill brakes too hard, and power takes the train to the mark.
                let climbs = self.world.gravity_n_per_kg(at) > STEEP_N_PER_KG;
                let power = if climbs { POWER_ON_CLIMB * traction } else { 0.0 };
                (self.load_n_per_kg(at) - deceleration).clamp(-most, power)
            }
        }
    }

    /// What the notch nearest to the wanted effort gives; up one notch at a time, down by any number.
    fn by_notches_n_per_kg(&mut self, wanted: f64, time_s: f64, at: Motion) -> f64 {
        if wanted <= 0.0 {
            self.notch = 0;
            return wanted;
        }
        let given = |notch: u8| {
            let share = f64::from(notch) / f64::from(self.world.notches);
            self.world.max_effort_n_per_kg(at, share, share)
        };
        if time_s - self.notch_since_s >= NOTCH_S {
            let off = |notch: &u8| (given(*notch) - wanted).abs();
            let nearest = (0..=self.world.notches).min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(0);
            let next = nearest.min(self.notch.saturating_add(1));
            if next != self.notch {
                (self.notch, self.notch_since_s) = (next, time_s);
            }
        }
        given(self.notch)
    }

    /// The effort after one step towards the wanted one.
    fn follow(&self, wanted: f64, at: Motion, step_s: f64) -> f64 {
        if let Phase::Stand { .. } = self.phase {
            return 0.0;
        }
        let now = self.effort_n_per_kg;
        let up = if now < 0.0 { RELEASE_N_PER_KG_S } else { self.habits.effort_rise_n_per_kg_s };
        let down = if now > 0.0 {
            LET_GO_N_PER_KG_S
        } else {
            self.habits.brake.rate_mps2(at.speed_mps) / self.habits.brake.build_up_s
        };
        let next = wanted.clamp(now - down * step_s, now + up * step_s);
        // Power ends at zero before the brake begins, and the other way round.
        if next * now < 0.0 { 0.0 } else { next }
    }

    fn label(&self) -> Regime {
        let effort = self.effort_n_per_kg;
        match self.phase {
            Phase::Stand { .. } => Regime::Standstill,
            Phase::Power if effort >= 0.0 => Regime::Traction,
            Phase::Hold | Phase::Restrain(_) => Regime::Cruise,
            Phase::Coast(_) if effort == 0.0 => Regime::Coast,
            Phase::Coast(_) if effort < 0.0 => Regime::Brake,
            Phase::Brake(_) if effort <= 0.0 => Regime::Brake,
            // Power on a climb towards the mark.
            Phase::Brake(_) if self.regime == Regime::Brake => Regime::Cruise,
            _ => self.regime,
        }
    }
}

/// The first sign towards a stop from which on the limit only falls, not too far from it; the stop itself if there is
/// none.
fn approach_from_m(world: &World, stop: &Stop) -> f64 {
    let limits = world.line.limits_kmh();
    let before = &limits[..limits.partition_point(|l| l.0 < stop.at_m)];
    let mut from_m = stop.at_m;
    let mut falling = true;
    for pair in before.windows(2).rev() {
        falling &= pair[1].1 < pair[0].1;
        let far_m = stop.at_m - pair[1].0;
        if pair[1].1 < pair[0].1 && (far_m <= APPROACH_M || falling && far_m <= LONG_APPROACH_M) {
            from_m = pair[1].0;
        }
    }
    from_m
}
