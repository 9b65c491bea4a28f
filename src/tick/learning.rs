//! Learning of the resistance while the effort is known: gated learning.
//!
//! In: each tick's readings, and the effort if it is known (zero in established coasting, or measured). Out: the belief
//! of this run's Davis coefficients.
//!
//! The paper's loop computes the effort from the very speed that it then explains, so the true resistance cancels out.
//! Here a filter runs only over *segments* in which the effort is known. It begins a segment with location and speed
//! from the readings, free of any correlation with r (the speed of the very reading that began it is not believed);
//! between segments r and its covariance are frozen. A segment begins after an interval that was recognised as coasted
//! as a whole, so its beginning is cut; its end is cut because what was learned becomes valid `end_cut_s` late: the
//! last interval before a brake that nobody announced never counts. A segment shorter than `min_segment_s` does not
//! count at all.

use crate::Real;
use crate::extremes::Extremes;
use crate::filter::elimination::NotPositiveDefinite;
use crate::filter::gaussian::Gaussian;
use crate::filter::ukf::{Innovation, MeasurementModel, Reading, Spread, Ukf};
use crate::model::effects::Acting;
use crate::model::line::Line;
use crate::model::motion::{Evaluate, Motion};
use crate::model::pieces::pieces;
use crate::model::resistance::Davis;
use crate::model::state::{LOCATION, R0, SIZE_WITH_GAIN, SPEED, davis, resistance_variance};
use crate::plain::plain;
use crate::tick::bounds::settings;
use crate::tick::effort_reading::MeanEffort;
use crate::tick::foresight::{Course, Foresight, Leg, Lines};
use crate::tick::memory::beside_gain;
use crate::tick::sensor::SensorConfig;
use crate::tick::snapshot::{InPlace, in_place};
use crate::tick::staircase::{self, Edge};
use heapless::Deque;
use nalgebra::Vector3;

settings! {
    /// When and how the resistance is learned.
    LearningConfig in "learning" {
        /// Spread of the sigma points.
        spread: Spread<SIZE_WITH_GAIN> = Spread::WIDE;
        /// Slowest speed at which coasting is learned from, km/h: below, holding a speed and coasting look alike.
        min_speed_kmh: Real = 50.0, 5.0 to 300.0;
        /// Probability that a whole interval was coasted, above which a segment begins; the interval itself is cut off.
        begin_probability: Real = 0.9, 0.5 to 1.0;
        /// The same, below which it ends. Lower: a segment that a single unlucky reading may end would keep the lucky
        /// ones, and r would come out too large where coasting and holding are near each other.
        end_probability: Real = 0.3, 0.0 to 1.0;
        /// Time cut from the end of a segment, s.
        end_cut_s: Real = 15.0, 0.0 to 600.0;
        /// Shortest segment that counts, s, cuts taken off.
        min_segment_s: Real = 60.0, 0.0 to 3600.0;
        /// A reading further from what is expected than this many standard deviations (of r's uncertainty too) ends the
        /// segment.
        gate: Real = 4.0, 1.0 to 1e3;
        /// Standard deviation of the acceleration beyond the model over one tick of 10 s, m/s²: gusts, track
        /// description.
        acceleration_noise_mps2: Real = 0.0005, 0.0 to 1.0;
        /// Time over which the rounding of neighbouring speed readings is correlated, s: faster readings count as one
        /// of these. A coasting train needs about this long to cross 1 km/h.
        staircase_s: Real = 6.25, 0.0 to 60.0;
        /// Longest sub-step of the motion inside a tick, s.
        sub_step_s: Real = 2.5, 0.1 to 60.0;
        /// Longest time without a speed, or without a location, inside a segment, s.
        max_gap_s: Real = 30.0, 1.0 to 600.0;
        /// Standard deviation of the gain of a measured effort.
        gain_sd: Real = 0.03, 1e-6 to 0.5;
        /// Share of a change of the measured effort by which its mean over a tick stays uncertain, once it is known how
        /// the column was made.
        effort_change_share: Real = 0.05, 0.0 to 10.0;
    }
}

/// Location and speed are read as they are; variances of the two readings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocationAndSpeed {
    /// Variance of the location, m².
    pub location_variance: Real,
    /// Variance of the speed, (m/s)².
    pub speed_variance: Real,
}

impl MeasurementModel<2> for LocationAndSpeed {
    const COMPONENTS: [usize; 2] = [LOCATION, SPEED];

    fn variance(&self, i: usize) -> Real {
        if i == 0 { self.location_variance } else { self.speed_variance }
    }
}

/// The readings of a segment. Those of the speed share their rounding, so each counts as a part of one; none of them
/// is further off for that.
struct Shared {
    readings: LocationAndSpeed,
    own_speed_variance: Real,
}

impl MeasurementModel<2> for Shared {
    const COMPONENTS: [usize; 2] = LocationAndSpeed::COMPONENTS;

    fn variance(&self, i: usize) -> Real {
        self.readings.variance(i)
    }

    fn gate_variance(&self, i: usize) -> Real {
        if i == 0 { self.readings.location_variance } else { self.own_speed_variance }
    }
}

/// What one tick brings to a segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tick {
    /// Time, s.
    pub time_s: Real,
    /// Time since the last tick, s.
    pub dt_s: Real,
    /// Location reading, m.
    pub location_m: Option<Real>,
    /// Speed reading, m/s.
    pub speed_mps: Option<Real>,
    /// Effort over the interval.
    pub effort: MeanEffort,
    /// Spectral density of the acceleration by the doubt of the track, m²/s³.
    pub track_density: Real,
}

plain! {
    struct Tick { time_s, dt_s, location_m, speed_mps, effort, track_density }
}

/// What of a segment counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Counts {
    /// It is believed to be one; it stays so.
    pub believed: bool,
    /// Time cut from its end, s.
    pub end_cut_s: Real,
    /// Shortest one, s.
    pub min_segment_s: Real,
    /// Least change of the speed since its beginning. Where a falling gradient balances the resistance a speed that is
    /// held, by a notch or a light brake, looks like a coast, and the believed resistance chooses which of them do.
    pub least_change: LeastChange,
    /// It is one of short hops.
    pub on_short_hops: bool,
    /// What the steps of its speeds say of this tick, if they teach: on short hops, where a piece that is no coast is
    /// one of many. A long one would decide the first run of an intercity, in too narrow an interval.
    pub edge: Option<Edge>,
    /// Standard deviation of a speed, m/s, where it is less than the sensor's.
    pub speed_sd_mps: Option<f32>,
}

/// How much the speed of a segment must change, so that it counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LeastChange {
    /// Not at all: the effort is measured.
    None,
    /// By this share of the speed at its beginning, up or down.
    Share(Real),
    /// It must fall by so much, m/s², in the mean.
    Fall(Real),
}

/// [`LeastChange::Share`] of coasts: a driver keeps a speed within a few km/h, and a train that coasts for a minute
/// loses more.
pub const MIN_CHANGE_SHARE: Real = 0.08;

/// Standard deviation of the speed with which a segment begins, m/s: so wide that the reading counts for nothing. It
/// was chosen, for a segment begins where the readings look like coasting; one that is too low does so more often, and
/// believed it made r 0.2 % too small at 140 km/h and 0.9 % too large at 20 km/h.
const BEGIN_SPEED_SD_MPS: Real = 1.0;

/// A coast goes astray by at least this share of r(v).
const STRAY_SHARE: Real = 0.25;

/// Of a tick: a filter that is set to shorter ones would take longer than the tick.
pub(crate) const MOST_SUB_STEPS: u32 = 1000;

/// Beliefs that wait for the end cut to pass.
const WAITING: usize = 8;

/// A belief of the constants with the time when it was reached.
#[derive(Clone, Copy, Debug)]
struct Reached {
    time_s: Real,
    speed_mps: Real,
    constants: Gaussian<4>,
}

plain! {
    struct Reached { time_s, speed_mps, constants }
}

in_place! {
    /// A running segment.
    #[derive(Clone, Debug)]
    struct Segment {
        begin_s: Real = (0.0);
        begin_mps: Real = (0.0);
        /// Probability that all of it was coasted, if the train coasts now.
        unbroken: Real = (0.0);
        /// Whether it is believed by now.
        believed: bool = (false);
        /// Up to here what was learned is valid.
        settled_s: Real = (0.0);
        belief: Gaussian<SIZE_WITH_GAIN> = (Gaussian::ZEROED);
        last_speed_s: Real = (0.0);
        last_location_s: Real = (0.0);
        course: Course = (Course::ZEROED);
        /// How it was foreseen up to one or two end cuts ago, to the last time that was marked, and when that was, s.
        settled: Lines = (Lines::ZEROED);
        marked: Lines = (Lines::ZEROED);
        marked_s: Real = (0.0);
        waiting: Deque<Reached, WAITING> = (in place);
    }
}

in_place! {
    /// What is learned in one run.
    #[derive(Clone, Debug)]
    pub struct Learner {
        /// r0, r1, r2 and the gain of the effort.
        constants: Gaussian<4> = (Gaussian::ZEROED);
        segment: Option<Segment> = (in place);
        learned_s: Real = (0.0);
        /// Of these, on short hops.
        on_hops_s: Real = (0.0);
        foresight: Foresight = (Foresight::NONE);
    }
}

impl Learner {
    /// Begins with a belief of the run's Davis coefficients.
    pub fn new(config: &LearningConfig, davis: &Gaussian<3>) -> Self {
        let mut learner = Self::ZEROED;
        learner.clear_fields();
        let gain = (1.0, config.gain_sd * config.gain_sd);
        learner.begin_run(&beside_gain(davis, gain, &Vector3::zeros()));
        learner
    }

    /// After [`InPlace::clear_fields`].
    pub(crate) fn begin_run(&mut self, constants: &Gaussian<4>) {
        self.constants = *constants;
    }

    /// r0, r1, r2 and the gain of the effort as learned so far.
    pub fn constants(&self) -> &Gaussian<4> {
        &self.constants
    }

    /// The run's Davis coefficients as learned so far.
    pub fn davis(&self) -> Gaussian<3> {
        davis_of(&self.constants)
    }

    /// The best belief at this moment, for recognising: what the running segment has reached, before it is known
    /// whether it counts.
    pub fn provisional(&self) -> Gaussian<3> {
        self.believed().map_or_else(|| self.davis(), |segment| davis_of(&segment.constants()))
    }

    /// Gain of the measured effort, true over measured, with its standard deviation.
    pub fn gain(&self) -> (Real, Real) {
        (self.constants.mean[3], self.constants.sd(3))
    }

    /// A segment is running, which may turn out to be none.
    pub fn in_segment(&self) -> bool {
        self.segment.is_some()
    }

    /// A segment is running that is believed by now.
    pub fn is_learning(&self) -> bool {
        self.believed().is_some()
    }

    /// Share of what this run taught that it taught on short hops.
    pub fn hops_share(&self) -> Real {
        if self.learned_s > 0.0 { self.on_hops_s / self.learned_s } else { 0.0 }
    }

    /// How the segments that counted were foreseen, the running one included.
    pub fn foresight(&self) -> Foresight {
        let counted = self.segment.as_ref().filter(|segment| segment.settled_s > segment.begin_s);
        let running = counted.and_then(|segment| segment.course.coast(&segment.settled));
        running.map_or(self.foresight, |coast| self.foresight.with(&coast))
    }

    fn believed(&self) -> Option<&Segment> {
        self.segment.as_ref().filter(|segment| segment.believed)
    }

    /// Probability that the running segment was coasted to this moment. `coasted`: that of the interval up to here.
    pub fn unbroken(&self, coasted: Real) -> Real {
        self.segment.as_ref().map_or(0.0, |segment| segment.unbroken * coasted)
    }

    /// An interval of the recogniser ends, at whose end the train coasts with probability `coasts`. A segment on trial
    /// that began too early, by a probability below `least`, ends: what comes later does not tell (the regimes are a
    /// Markov chain).
    pub fn end_of_interval(&mut self, coasted: Real, coasts: Real, least: Real) {
        // At most 1, for what coasted throughout coasts at the end.
        let unbroken = self.unbroken(coasted) / coasts.at_least(Real::MIN_POSITIVE);
        match &mut self.segment {
            Some(segment) if segment.believed || unbroken >= least => segment.unbroken = unbroken,
            _ => self.end(),
        }
    }

    /// Time of the segments that counted, cuts taken off, s.
    pub fn learned_s(&self) -> Real {
        self.learned_s
    }

    /// Location and speed of the running segment with their covariance; none before its first speed reading, without
    /// which its speed is known less well than it is read.
    pub fn moving(&self) -> Option<Gaussian<2>> {
        self.believed().filter(|segment| segment.last_speed_s > segment.begin_s).map(|segment| Gaussian {
            mean: segment.belief.mean.fixed_rows::<2>(0).into_owned(),
            covariance: segment.belief.covariance.fixed_view::<2, 2>(0, 0).into_owned(),
        })
    }

    /// Begins a segment, on trial or `believed`, where location and speed are known from readings alone; the speed is
    /// left to the next reading, see `BEGIN_SPEED_SD_MPS`.
    pub fn begin(&mut self, time_s: Real, moving: &Gaussian<2>, believed: bool) {
        let mut belief = Gaussian::<SIZE_WITH_GAIN>::ZEROED;
        belief.mean.fixed_rows_mut::<2>(LOCATION).copy_from(&moving.mean);
        belief.covariance.fixed_view_mut::<2, 2>(LOCATION, LOCATION).copy_from(&moving.covariance);
        belief.covariance[(SPEED, SPEED)] = BEGIN_SPEED_SD_MPS * BEGIN_SPEED_SD_MPS;
        belief.mean.fixed_rows_mut::<4>(R0).copy_from(&self.constants.mean);
        belief.covariance.fixed_view_mut::<4, 4>(R0, R0).copy_from(&self.constants.covariance);
        let segment = self.segment.insert(Segment::ZEROED);
        segment.begin_s = time_s;
        segment.begin_mps = moving.mean[SPEED];
        segment.unbroken = 1.0;
        segment.believed = believed;
        segment.settled_s = time_s;
        segment.marked_s = time_s;
        segment.belief = belief;
        segment.last_speed_s = time_s;
        segment.last_location_s = time_s;
        segment.course.begin(time_s, &davis_of(&self.constants));
    }

    /// Ends the segment: what waits for the end cut is forgotten.
    pub fn end(&mut self) {
        self.foresight = self.foresight();
        self.segment = None;
    }

    /// One tick of the running segment. `None`: there is no segment, or this tick ended it.
    ///
    /// # Errors
    /// [`NotPositiveDefinite`]: the segment is dropped, what was learned before stays.
    pub fn step(
        &mut self,
        config: &LearningConfig,
        sensor: &SensorConfig,
        line: &Line<'_>,
        acting: &Acting<'_>,
        tick: &Tick,
        counts: &Counts,
    ) -> Result<Option<Innovation<2>>, NotPositiveDefinite> {
        let mut goes_on = true;
        let stepped = self.advance(config, sensor, line, acting, (tick, counts), &mut goes_on);
        if !goes_on {
            self.end();
        }
        stepped
    }

    /// `goes_on`: the segment does, or there is none.
    // Called from two places, and 10 kB; of its own, so that what it takes on the stack is given back before the
    // segment ends.
    #[inline(never)]
    fn advance(
        &mut self,
        config: &LearningConfig,
        sensor: &SensorConfig,
        line: &Line<'_>,
        acting: &Acting<'_>,
        (tick, counts): (&Tick, &Counts),
        goes_on: &mut bool,
    ) -> Result<Option<Innovation<2>>, NotPositiveDefinite> {
        let Some(segment) = &mut self.segment else {
            return Ok(None);
        };
        segment.believed |= counts.believed;
        *goes_on = false;
        let (innovation, believed) = segment.step(config, sensor, line, acting, tick, counts)?;
        if believed {
            self.settle(counts, tick.time_s);
            *goes_on = true;
        }
        Ok(Some(innovation))
    }

    /// What was reached `end_cut_s` ago becomes valid, if the segment was long enough by then; what is reached now
    /// begins to wait.
    fn settle(&mut self, counts: &Counts, time_s: Real) {
        let Some(segment) = &mut self.segment else {
            return;
        };
        while let Some(reached) = segment.waiting.front().copied() {
            if time_s - reached.time_s < counts.end_cut_s {
                break;
            }
            if !segment.believed {
                // Full: what was reached long ago is worth less than what comes.
                if segment.waiting.is_full() {
                    segment.waiting.pop_front();
                }
                break;
            }
            segment.waiting.pop_front();
            let is_long = reached.time_s - segment.begin_s >= counts.min_segment_s;
            if is_long && segment.changed(&reached, counts.least_change) {
                self.constants = reached.constants;
                let counted_s = reached.time_s - segment.settled_s;
                self.learned_s += counted_s;
                if counts.on_short_hops {
                    self.on_hops_s += counted_s;
                }
                segment.settled_s = reached.time_s;
            }
        }
        if time_s - segment.marked_s >= counts.end_cut_s {
            segment.settled = core::mem::replace(&mut segment.marked, segment.course.lines());
            segment.marked_s = time_s;
        }
        // Ticks of a fast log need not all wait: so few are enough that the ring is never full.
        let spacing_s = counts.end_cut_s / (WAITING - 2) as Real;
        let due = segment.waiting.back().is_none_or(|last| time_s - last.time_s >= spacing_s);
        if due {
            let reached = Reached { time_s, speed_mps: segment.belief.mean[SPEED], constants: segment.constants() };
            // Cannot be full, see above; if it were, this belief would merely not wait.
            let _waits = segment.waiting.push_back(reached).is_ok();
        }
    }
}

pub(crate) fn davis_of(constants: &Gaussian<4>) -> Gaussian<3> {
    Gaussian {
        mean: constants.mean.fixed_rows::<3>(0).into_owned(),
        covariance: constants.covariance.fixed_view::<3, 3>(0, 0).into_owned(),
    }
}

impl Segment {
    /// The speed has changed by enough since the beginning.
    fn changed(&self, reached: &Reached, least: LeastChange) -> bool {
        match least {
            LeastChange::None => true,
            LeastChange::Share(share) => (self.belief.mean[SPEED] - self.begin_mps).abs() >= share * self.begin_mps,
            LeastChange::Fall(mps2) => self.begin_mps - reached.speed_mps >= mps2 * (reached.time_s - self.begin_s),
        }
    }

    /// r0, r1, r2 and the gain as reached so far.
    fn constants(&self) -> Gaussian<4> {
        Gaussian {
            mean: self.belief.mean.fixed_rows::<4>(R0).into_owned(),
            covariance: self.belief.covariance.fixed_view::<4, 4>(R0, R0).into_owned(),
        }
    }

    /// It moved r(v) by more standard deviations than `gate` of what it could teach, and by a large share of it. A
    /// gentle brake moves no single reading out of the gate, and r would follow it. Less may be a brake that drags in
    /// some coasts: it must teach, or r would stay that of the first ones, and none would speak against it. Asked on
    /// short hops alone, where a piece of a few seconds counts: a train whose description is far off has to be learned.
    // What it takes on the stack is given back before effects are asked.
    #[inline(never)]
    fn strays(&self, gate: Real) -> bool {
        let (before, now) = (self.course.before(), davis_of(&self.constants()));
        let speed_mps = self.belief.mean[SPEED];
        let [r0, r1, r2] = before.mean.into();
        let r_before = Davis { r0, r1, r2 }.resistance_n_per_kg(speed_mps);
        let moved = davis(&self.belief.mean).resistance_n_per_kg(speed_mps) - r_before;
        let taught = resistance_variance(before, speed_mps) - resistance_variance(&now, speed_mps);
        moved.abs() > STRAY_SHARE * r_before && moved * moved > gate * gate * taught
    }

    /// Predicts in sub-steps and updates. `false`: the readings left the gate, or r went astray.
    fn step(
        &mut self,
        config: &LearningConfig,
        sensor: &SensorConfig,
        line: &Line<'_>,
        acting: &Acting<'_>,
        tick: &Tick,
        counts: &Counts,
    ) -> Result<(Innovation<2>, bool), NotPositiveDefinite> {
        let ukf = Ukf { spread: config.spread, gate: [Some(config.gate); 2], reuse_points: false };
        let count = pieces(tick.dt_s, config.sub_step_s, MOST_SUB_STEPS);
        let sub_steps = Real::from(count);
        let h_s = tick.dt_s / sub_steps;
        // White acceleration noise of this tick, spread over its sub-steps so that their sum has the same variance.
        let gusts = config.acceleration_noise_mps2 * config.acceleration_noise_mps2 * 10.0;
        let effort = Real::from(tick.effort.variance);
        let noise_mps2 = crate::roots::square_root(((gusts + tick.track_density) / tick.dt_s + effort) * sub_steps);
        let mut begin_s = tick.time_s - tick.dt_s;
        let (began_mps, believed) = (self.belief.mean[SPEED], davis(&self.belief.mean));
        for _ in 0..count {
            let (x, evaluate) = (&self.belief.mean, Evaluate::Midway);
            let motion = Motion::new(line, x, tick.effort.n_per_kg.into(), h_s, evaluate)
                .with_effects(line, acting, x, begin_s, evaluate);
            begin_s += h_s;
            ukf.predict(&mut self.belief, &motion.with_noise(noise_mps2))?;
        }
        // A coasting train crosses a fine step within a second.
        let (speed_sd_mps, staircase) = match counts.speed_sd_mps {
            Some(sd_mps) => (sd_mps.into(), 1.0),
            None => (sensor.speed_sd_mps(), (config.staircase_s / tick.dt_s).at_least(1.0)),
        };
        let speed_variance = speed_sd_mps * speed_sd_mps * staircase + Real::from(tick.effort.unseen);
        let mut observation = Shared {
            readings: LocationAndSpeed {
                location_variance: sensor.location_sd_m * sensor.location_sd_m,
                speed_variance,
            },
            own_speed_variance: speed_variance / staircase,
        };
        let ends_mps = self.belief.mean[SPEED];
        let edge = counts.edge.filter(|_| tick.dt_s as f32 <= staircase::LONGEST_ROW_S);
        let mut speed_mps = tick.speed_mps;
        if let Some(Edge::Passed { mps, sd_mps, row_s }) = edge {
            // Passed at any moment of the tick alike.
            let half_mps = 0.5 * (ends_mps - began_mps) * Real::from(row_s) / tick.dt_s;
            let noise_mps = (sensor.speed_noise_kmh / 3.6).at_least(sd_mps.into());
            speed_mps = Some(Real::from(mps) + half_mps);
            observation.readings.speed_variance = half_mps * half_mps / 3.0 + noise_mps * noise_mps;
        }
        // A measured effort has errors of its own, which would be taken for those of the resistance.
        let coasts = tick.effort.variance == 0.0;
        let leg = Leg {
            time_s: tick.time_s,
            dt_s: tick.dt_s,
            midway_mps: 0.5 * (began_mps + ends_mps),
            foreseen_mps: ends_mps - began_mps,
            believed,
            described: line.train.davis(),
            // Between edges little is read.
            speed_mps: speed_mps.filter(|_| edge != Some(Edge::None)),
            speed_variance: observation.readings.speed_variance,
            gusts,
            track: tick.track_density,
        };
        if coasts {
            self.course.add(&leg);
        }
        let innovation = ukf.update(&mut self.belief, &observation, &[tick.location_m, speed_mps])?;
        let [location, speed] = innovation.readings;
        if location == Reading::Used {
            self.last_location_s = tick.time_s;
        }
        if speed == Reading::Used {
            self.last_speed_s = tick.time_s;
        }
        let gap_s = tick.time_s - self.last_speed_s.at_most(self.last_location_s);
        let goes_on = speed != Reading::Gated && gap_s <= config.max_gap_s;
        Ok((innovation, goes_on && !(counts.on_short_hops && self.strays(config.gate))))
    }
}
