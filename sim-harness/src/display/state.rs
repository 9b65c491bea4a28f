//! What is known, folded from frames: the present values, the run so far, the runs before.
//!
//! In: frames in their order. Out: [`State`], of which every view shows a part. A frame that is late or came twice
//! changes nothing.
//!
//! A value that has not come is `None`, never a zero. With a new run the values of the old one are gone; its speed over
//! location and what it has taught stay.

use super::judged::Conclusion;
use rundown_wire::{
    Body, CoastAhead, Effect, EffectKind, Effort, Estimate, Features, Health, Order, Parameters, Received, Recorder,
    Regime, RunSummary, Status, SwitchingPoint, Validity, Versions,
};
use serde::Serialize;

/// Points of a run that are kept: two days at 10 s. Then the older half goes.
const MOST_POINTS: usize = 20_000;
const MOST_RUNS: usize = 200;
/// A train that stands adds no points; its location is noise within this.
const STANDING_M: f32 = 25.0;

/// Points at the end that may still change: the last one's regime is confirmed by the next, and at a stop it is
/// replaced.
pub const UNSETTLED: usize = 2;

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(into = "PointRow")]
pub struct Point {
    pub location_m: f32,
    pub speed_mps: f32,
    pub speed_sd_mps: f32,
    /// Regime: the estimate's, then the confirmed one.
    pub regime: Regime,
    /// How far location and speed may be trusted.
    pub validity: Validity,
    /// Time on the sender's clock, s.
    pub time_s: f64,
    pub effort_n_per_kg: Option<f32>,
    /// The resistance was learned from it.
    pub learning: bool,
    /// Estimates before it are missing: no line leads here.
    pub gap: bool,
}

/// A point as JSON has it, in the order of its fields: thousands go to each browser. Regime as in [`Regime::ALL`]; 0
/// valid, 1 held, 2 invalid.
pub type PointRow = (f32, f32, f32, u8, u8, f64, Option<f32>, bool, bool);

impl From<Point> for PointRow {
    fn from(point: Point) -> Self {
        let validity = match point.validity {
            Validity::Valid => 0,
            Validity::Held(_) => 1,
            Validity::Invalid(_) => 2,
        };
        (
            point.location_m,
            point.speed_mps,
            point.speed_sd_mps,
            point.regime as u8,
            validity,
            point.time_s,
            point.effort_n_per_kg,
            point.learning,
            point.gap,
        )
    }
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PastRun {
    /// Time of its last estimate on the sender's clock, s.
    pub ended_s: Option<f64>,
    pub summary: RunSummary,
    /// What it has said of driving style and limits.
    pub features: Option<Features>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EffectValue {
    pub label: &'static str,
    pub value: f64,
    /// Its unit; empty for none.
    pub unit: &'static str,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NamedEffect {
    /// Its name, or its number if that is newer than this program.
    pub name: String,
    /// Where it acts, m; none: everywhere.
    pub section_m: Option<[f64; 2]>,
    pub values: Vec<EffectValue>,
}

impl NamedEffect {
    fn new(effect: &Effect) -> Self {
        let kind = EffectKind::from_number(effect.kind);
        let labels =
            kind.iter().flat_map(|kind| kind.parameters()).map(|parameter| (parameter.meaning, parameter.unit));
        let labels = labels.chain(std::iter::repeat(("", "")));
        let value = |(&value, (label, unit))| EffectValue { label, value, unit };
        Self {
            name: kind.map_or_else(|| format!("effect {}", effect.kind), |kind| kind.name().to_owned()),
            section_m: effect.section_m,
            values: effect.values.iter().zip(labels).map(value).collect(),
        }
    }
}

#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Now {
    pub tick: Option<u32>,
    pub estimate: Option<Estimate>,
    pub parameters: Option<Parameters>,
    pub effort: Option<Effort>,
    /// What coasting from here leads to, as said last.
    pub coast_ahead: Option<CoastAhead>,
    pub features: Option<Features>,
    /// Switching points of this run, as far as they have come.
    pub switching_points: Vec<SwitchingPoint>,
    pub effects: Vec<NamedEffect>,
    /// What the board has, and what it has counted.
    pub status: Option<Status>,
    pub health: Option<Health>,
    /// Which firmware it is.
    pub versions: Option<Versions>,
    /// The recorder cuts speeds off, as said in this run.
    pub recorder: Option<Recorder>,
    /// What these frames say together.
    pub judged: Conclusion,
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct State {
    /// Another number whenever [`State::points`] are not the old ones with more behind, the last [`UNSETTLED`] aside.
    pub epoch: u32,
    pub now: Now,
    pub points: Vec<Point>,
    pub previous: Vec<Point>,
    /// Runs that are over, the oldest first.
    pub past: Vec<PastRun>,
    pub ended: u32,
    /// Runs between those that have ended here, of which no end came. Each run numbers its frames from 0 on,
    /// so what these have lost is in no count of frames.
    pub missing_runs: u32,
}

impl State {
    pub fn take(&mut self, received: &Received) {
        let frame = &received.frame;
        match received.order {
            Order::Late | Order::Repeated => return,
            Order::Restart => self.begin_run(),
            Order::Next | Order::After { .. } => {}
        }
        // The board has restarted its count and the first number was lost.
        if self.now.tick.is_some_and(|tick| frame.tick < tick) {
            self.begin_run();
        }
        self.now.tick = Some(frame.tick);
        match &frame.body {
            Body::Estimate(estimate) => self.estimate(estimate),
            Body::Parameters(parameters) => {
                self.now.judged.parameters(parameters);
                self.now.parameters = Some(*parameters);
            }
            Body::Effort(effort) => self.now.effort = Some(*effort),
            Body::CoastAhead(ahead) => {
                self.now.judged.coast_ahead(ahead);
                self.now.coast_ahead = Some(*ahead);
            }
            Body::Features(features) => self.now.features = Some(*features),
            Body::SwitchingPoints(part) => {
                let kept = &mut self.now.switching_points;
                kept.truncate(part.first.into());
                // What lies between was lost with a frame.
                if kept.len() == usize::from(part.first) {
                    kept.extend_from_slice(&part.points);
                }
            }
            Body::Effects(effects) => {
                self.now.effects = effects.effects.iter().map(NamedEffect::new).collect();
            }
            Body::Status(status) => {
                self.now.judged.status(status);
                self.now.status = Some(*status);
            }
            Body::Health(health) => self.now.health = Some(*health),
            Body::Versions(versions) => self.now.versions = Some(*versions),
            Body::RunSummary(summary) => self.end_run(summary),
            Body::Recorder(recorder) => self.now.recorder = Some(*recorder),
            // For the desk, and for who asked.
            Body::SnapshotPart(_) | Body::Answer(_) => {}
            // Newer than this program.
            _ => {}
        }
    }

    fn estimate(&mut self, estimate: &Estimate) {
        self.now.estimate = Some(*estimate);
        self.now.judged.estimate(estimate);
        if let (Some(confirmed), Some(last)) = (estimate.confirmed, self.points.last_mut()) {
            last.regime = confirmed;
        }
        let last_s = self.points.last().map(|last| last.time_s);
        let longest_s = 1.5 * f64::from(estimate.dt_s);
        let point = Point {
            location_m: estimate.location_m.value,
            speed_mps: estimate.speed_mps.value,
            speed_sd_mps: estimate.speed_mps.sd,
            regime: estimate.regime,
            validity: estimate.validity,
            time_s: estimate.time_s,
            effort_n_per_kg: self.now.effort.and_then(|effort| effort.effort_n_per_kg),
            learning: estimate.learning,
            gap: last_s.is_some_and(|last_s| estimate.time_s - last_s > longest_s),
        };
        if let [.., one, two] = &self.points[..]
            && [one, two, &point]
                .iter()
                .all(|of| of.regime == Regime::Standstill && (of.location_m - point.location_m).abs() < STANDING_M)
        {
            // Same place: only the newest of a stop is kept beside its first.
            self.points.pop();
        }
        self.points.push(point);
        if self.points.len() > MOST_POINTS {
            self.points.drain(..MOST_POINTS / 2);
            self.epoch = self.epoch.wrapping_add(1);
        }
    }

    fn begin_run(&mut self) {
        let Now { parameters, effects, status, health, versions, judged, .. } = std::mem::take(&mut self.now);
        // These are not of the run alone.
        let judged = judged.next_run();
        self.now = Now { parameters, effects, status, health, versions, judged, ..Now::default() };
        if !self.points.is_empty() {
            self.previous = std::mem::take(&mut self.points);
        }
        self.epoch = self.epoch.wrapping_add(1);
    }

    fn end_run(&mut self, summary: &RunSummary) {
        if let Some(before) = self.past.last() {
            // A number that goes back is another vehicle, or a board that has forgotten.
            let between = summary.run.saturating_sub(before.summary.run).saturating_sub(1);
            self.missing_runs = self.missing_runs.saturating_add(between);
        }
        if self.past.len() == MOST_RUNS {
            self.past.remove(0);
        }
        self.past.push(PastRun {
            ended_s: self.now.estimate.map(|estimate| estimate.time_s),
            summary: *summary,
            features: self.now.features,
        });
        self.ended = self.ended.wrapping_add(1);
    }
}
