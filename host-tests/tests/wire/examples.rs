//! One value of each frame, and the largest one.

use host_tests::board::PROVISIONING;
use host_tests::fields::Fields;
use rundown::coast_ahead::CoastConfig;
use rundown::estimator::config::Config;
use rundown::model::direction::Direction;
use rundown::model::effects::Surroundings;
use rundown::model::track::{Curve, Gradient, Target};
use rundown::model::train::TrainDescription;
use rundown::onboard::auth::{Signer, Verifier};
use rundown::onboard::task::DATA_ID;
use rundown::tick::measurement::Measurement;
use rundown::tick::paper::Difference;
use rundown::uplink::{
    self, CURVES, Command, CurvePart, GRADIENTS, OPEN, Pace, Request, SECURED, Setting, TARGETS, TargetPart, TrackPart,
    TrainFrame, Uplink,
};
use rundown_wire::link::Counters;
use rundown_wire::*;

/// Epoch of the examples; each secured one is the first message after the board's start.
const EPOCH: u32 = 3;

/// A frame in either direction.
#[derive(Clone, Debug, PartialEq)]
pub enum Frame {
    Down(Downlink),
    /// Open or secured.
    Up(u8, Uplink),
}

/// A board that has just started.
pub fn verifier() -> Verifier {
    Verifier::new(Ok(PROVISIONING), Ok(EPOCH))
}

impl Frame {
    /// As the code writes it.
    pub fn message(&self) -> Vec<u8> {
        let (mut bare, mut sealed) = ([0; MAX_MESSAGE], [0; MAX_MESSAGE]);
        match self {
            Self::Down(frame) => frame.encode(&mut bare).unwrap().to_vec(),
            Self::Up(protection, frame) => {
                let bare = uplink::encode(frame, *protection, &mut bare).unwrap();
                if *protection == OPEN {
                    return bare.to_vec();
                }
                let announcement = verifier().announcement().unwrap();
                let mut signer = Signer::new(&PROVISIONING, &announcement).unwrap();
                signer.seal(DATA_ID, bare, &mut sealed).unwrap().to_vec()
            }
        }
    }

    /// As the code reads a message of the same direction.
    pub fn read(&self, message: &[u8]) -> Option<Self> {
        match (self, message) {
            (Self::Down(_), _) => Downlink::decode(message).ok().map(Self::Down),
            (Self::Up(..), [uplink::VERSION, OPEN, payload @ ..]) => Some(Self::Up(OPEN, uplink::decode(payload)?)),
            (Self::Up(..), [uplink::VERSION, SECURED, ..]) => {
                let opened = verifier().open(DATA_ID, message).ok()?;
                Some(Self::Up(SECURED, uplink::decode(opened.get(2..)?)?))
            }
            _ => None,
        }
    }

    /// As the second encoder sees it, without version, protection and trailer.
    pub fn fields(&self) -> Fields {
        match self {
            Self::Down(frame) => Fields::of(frame),
            Self::Up(_, frame) => Fields::of(frame),
        }
    }
}

fn down(name: &str, body: Body) -> (String, Frame) {
    let frame = Downlink { sequence: 7, tick: 300, body };
    (format!("down {name}"), Frame::Down(frame))
}

fn up(name: &str, protection: u8, request: Request) -> (String, Frame) {
    let frame = Uplink { sequence: 21, request };
    (format!("up {name}"), Frame::Up(protection, frame))
}

fn value(value: f32, sd: f32) -> Value {
    Value { value, sd }
}

fn statistic(count: u32, mean: f32, sd: f32) -> Statistic {
    Statistic { count, mean, sd }
}

/// Counters of `N` things, a few of which happened.
fn counted<const N: usize>() -> [u32; N] {
    let mut counts = [0; N];
    counts[0] = 2;
    counts[N - 1] = 300;
    counts
}

fn snapshot_part() -> SnapshotPart {
    SnapshotPart { tick: 288, setup: 0x1234_5678, crc: 0x9ABC_DEF0, total: 9000, first: 8960, bytes: (0..40).collect() }
}

fn effect() -> Effect {
    Effect { kind: 1, section_m: Some([1200.0, 3400.0]), values: [1.25e-5].into_iter().collect() }
}

pub fn features() -> Features {
    Features {
        max_effort: Some(EffortLine {
            effort_n_per_kg: statistic(12, 0.45, 0.03),
            at_lower_n_per_kg: 0.47,
            slope: -0.006,
        }),
        power_w_per_kg: statistic(40, 4.8, 0.4),
        max_power_w_per_kg: Some(5.25),
        brake_rate_mps2: [
            statistic(0, 0.0, 0.0),
            statistic(9, 0.31, 0.05),
            statistic(4, 0.36, 0.04),
            statistic(4, 0.4, 0.03),
            statistic(6, 0.42, 0.06),
        ],
        cruise_speed_mps: statistic(410, 38.5, 0.25),
        cruise_speed_median_mps: Some(38.6),
        final_coast: Some(Phase {
            start_time_s: 2280.0,
            start_location_m: 26_400.0,
            start_speed_mps: 38.3,
            duration_s: 110.0,
            length_m: 3900.0,
        }),
        final_brake: Some(Phase {
            start_time_s: 2400.0,
            start_location_m: 31_000.0,
            start_speed_mps: 32.5,
            duration_s: 70.0,
            length_m: 1100.0,
        }),
        regime_time_s: [60.0, 420.0, 410.0, 900.0, 210.0],
        traction_j_per_kg: 1900.0,
        brake_j_per_kg: 760.0,
        resistance_j_per_kg: [240.0, 160.0, 700.0, 40.0],
    }
}

/// The downlink frames, in the order of their numbers.
fn downlink() -> Vec<(String, Frame)> {
    let bodies = [
        Body::Estimate(Estimate {
            time_s: 3000.0,
            dt_s: 10.0,
            location_m: value(12_345.5, 3.25),
            speed_mps: value(38.5, 0.125),
            regime: Regime::Coast,
            confirmed: Some(Regime::Cruise),
            learning: true,
            validity: Validity::Held(Cause::NoLocation),
            digest: 0xDEAD_BEEF,
        }),
        Body::Parameters(Parameters {
            r0: value(0.0072, 0.0005),
            r1: value(0.00015, 0.00003),
            r2: value(0.000027, 0.000001),
            correlation: [-0.5, 0.25, -0.75],
            learned: Learned::Learned,
            gain: Some(value(1.01, 0.02)),
        }),
        Body::Effort(Effort {
            effort_n_per_kg: Some(0.25),
            acceleration_mps2: Some(0.125),
            gradient_n_per_kg: -0.05,
            max_traction_n_per_kg: 0.5,
            max_brake_n_per_kg: 0.66,
        }),
        Body::Features(features()),
        Body::SwitchingPoints(SwitchingPoints {
            first: 4,
            total: 5,
            lost: 0,
            points: [SwitchingPoint {
                time_s: 2280.0,
                location_m: 26_400.0,
                speed_mps: 38.3,
                from: Regime::Cruise,
                to: Regime::Coast,
            }]
            .into_iter()
            .collect(),
        }),
        Body::Effects(Effects { effects: [effect()].into_iter().collect() }),
        Body::Status(Status {
            announcement: verifier().announcement(),
            train_id: Some(0x2451),
            track_id: Some(70_000),
            setup: 0x1234_5678,
            running: true,
            silent_ticks: 0,
            causes: counted(),
            time_not_increasing: 1,
            refusals: counted(),
            missed: 3,
            duplicate: 1,
            not_sent: 0,
            memory: Memory::Restored,
            records: [12, 0],
        }),
        Body::RunSummary(RunSummary {
            run: 12,
            run_davis: [value(0.0072, 0.0005), value(0.00015, 0.00003), value(0.000027, 0.000001)],
            vehicle_davis: [value(0.0073, 0.0003), value(0.00016, 0.00002), value(0.0000275, 0.0000005)],
            wind_sd_mps: 1.5,
            gain: value(1.0, 0.03),
            learned_s: 640.0,
        }),
        Body::SnapshotPart(snapshot_part()),
        Body::Answer(Answer { to: 21, result: Err(Refusal::UnknownEffect) }),
        Body::Health(Health {
            uptime_s: 3600,
            reset_cause: ResetCause::Watchdog,
            failure: Failure::Stalled(Stalled { tick: true, link: false }),
            resets: 1,
            slow_clock: false,
            stack_bytes: 14_000,
            longest_us: 95_000,
            flash_errors: 0,
            line: LineCounts { overrun: 1, framing: 2, noise: 3, other: 4, ring_full: 5 },
            messages: Counters { sent: 1500, received: 400, checksum: 2, ..Counters::ZERO },
            not_sent: 6,
        }),
        Body::CoastAhead(CoastAhead {
            from_time_s: 3000.0,
            from_location_m: 24_345.5,
            from_speed_mps: 38.5,
            target: Some(CoastTarget { at_m: 31_683.0, limit_mps: Some(11.0) }),
            outcome: CoastOutcome::Arrives(CoastArrival {
                speed_mps: value(24.25, 0.5),
                time_s: 3239.5,
                time_sd_s: 1.25,
            }),
        }),
        Body::Versions(Versions {
            firmware: [0, 1, 300],
            commit: Some(0x0A1B_2C3D),
            changed: true,
            downlink: VERSION,
            uplink: uplink::VERSION,
        }),
        Body::Recorder(Recorder { speed_offset_mps: value(0.1375, 0.01), put_right: true }),
    ];
    bodies.into_iter().map(|body| down(body.as_str(), body)).collect()
}

/// The uplink frames, in the order of their numbers; of settings and commands each one.
fn uplink() -> Vec<(String, Frame)> {
    let mut frames = vec![
        up(
            "measurement",
            OPEN,
            Request::Measurement(Measurement {
                time_s: 3000.0,
                location_m: Some(12_345.5),
                speed_mps: Some(38.5),
                effort_n_per_kg: Some(-0.25),
            }),
        ),
        up(
            "train",
            SECURED,
            Request::Train(TrainFrame { id: PROVISIONING.train.0, description: TrainDescription::CASE_STUDY }),
        ),
        up(
            "track",
            SECURED,
            Request::Track(TrackPart {
                id: 70_000,
                length_m: 32e3,
                total: 2,
                first: 0,
                gradients: [(0.0, 0.0), (500.0, -2.5)]
                    .map(|(from_m, permille)| Gradient { from_m, permille })
                    .into_iter()
                    .collect(),
            }),
        ),
    ];
    // Tuning may move a default; the bytes of an example stay.
    let mut config = Config::default();
    // As when these frames were first written; today's default is the other.
    config.paper.difference = Difference::Backward;
    config.learning.acceleration_noise_mps2 = 0.001;
    config.learning.effort_change_share = 0.6;
    config.memory.vehicle_shape_sd = 0.1;
    config.coast = CoastConfig { horizon_m: 25e3, wind_change_mps: 0.3, coasting_point_m: 150.0, arrival_s: 3.0 };
    for setting in Setting::all(&config) {
        let request = Request::Setting(setting);
        frames.push(up(&format!("setting {}", word(&request)), SECURED, request));
    }
    frames.push(up("effect", SECURED, Request::Effect(effect())));
    for command in COMMANDS {
        let protection = if command == Command::Status { OPEN } else { SECURED };
        let request = Request::Command(command);
        frames.push(up(&format!("command {}", word(&request)), protection, request));
    }
    frames.push(up("snapshot", SECURED, Request::Snapshot(snapshot_part())));
    frames.push(up(
        "surroundings",
        SECURED,
        Request::Surroundings(Surroundings { temperature_c: Some(-7.5), day: Some(20_513.5) }),
    ));
    frames.push(up(
        "curves",
        SECURED,
        Request::Curves(CurvePart {
            track_id: 70_000,
            first: 0,
            curves: [(1000.0, 1400.0, 500.0)]
                .map(|(from_m, to_m, radius_m)| Curve { from_m, to_m, radius_m })
                .into_iter()
                .collect(),
        }),
    ));
    frames.push(up(
        "targets",
        SECURED,
        Request::Targets(TargetPart {
            track_id: 70_000,
            first: 0,
            targets: [(0.0, None), (900.0, Some(39.0)), (31_683.0, Some(11.0))]
                .map(|(at_m, limit_mps)| Target { at_m, limit_mps })
                .into_iter()
                .collect(),
        }),
    ));
    frames
}

/// All commands.
pub const COMMANDS: [Command; 7] = [
    Command::Begin { direction: Direction::Down, track_id: 70_000 },
    Command::End,
    Command::Pace(Pace::Lockstep),
    Command::Status,
    Command::Snapshot,
    Command::Forget,
    Command::ClearEffects,
];

/// The word of a setting or a command.
fn word(request: &Request) -> String {
    Fields::of(request).variants[1].2.clone()
}

/// All examples of the document.
pub fn all() -> Vec<(String, Frame)> {
    [downlink(), uplink()].concat()
}

/// As many as there is room for.
fn full<T: Clone, const N: usize>(item: &T) -> heapless::Vec<T, N> {
    let mut list = heapless::Vec::new();
    while list.push(item.clone()).is_ok() {}
    list
}

fn largest_snapshot_part() -> SnapshotPart {
    SnapshotPart { tick: u32::MAX, total: u16::MAX, first: u16::MAX, bytes: full(&0), ..snapshot_part() }
}

fn largest_effect() -> Effect {
    Effect { values: full(&0.0), ..effect() }
}

/// The largest value of each body: of the example, with every list full and every number at its largest.
fn largest_body(body: Body) -> Body {
    const MOST: u32 = u32::MAX;
    match body {
        Body::Estimate(_) | Body::Parameters(_) | Body::Effort(_) | Body::CoastAhead(_) => body,
        Body::Features(mut features) => {
            let most = |statistic: &mut Statistic| statistic.count = MOST;
            features.max_effort.iter_mut().for_each(|line| most(&mut line.effort_n_per_kg));
            features.brake_rate_mps2.iter_mut().for_each(most);
            most(&mut features.power_w_per_kg);
            most(&mut features.cruise_speed_mps);
            Body::Features(features)
        }
        Body::SwitchingPoints(SwitchingPoints { points, .. }) => Body::SwitchingPoints(SwitchingPoints {
            first: u16::MAX,
            total: u16::MAX,
            lost: MOST,
            points: full(&points[0]),
        }),
        Body::Effects(_) => Body::Effects(Effects { effects: full(&largest_effect()) }),
        Body::Status(status) => Body::Status(Status {
            train_id: Some(u64::MAX),
            track_id: Some(MOST),
            silent_ticks: MOST,
            causes: [MOST; CAUSES],
            time_not_increasing: MOST,
            refusals: [MOST; REFUSALS],
            missed: MOST,
            duplicate: MOST,
            not_sent: MOST,
            records: [MOST; 2],
            ..status
        }),
        Body::RunSummary(summary) => Body::RunSummary(RunSummary { run: MOST, ..summary }),
        Body::SnapshotPart(_) => Body::SnapshotPart(largest_snapshot_part()),
        Body::Answer(answer) => Body::Answer(Answer { to: u16::MAX, ..answer }),
        Body::Health(health) => Body::Health(Health {
            uptime_s: MOST,
            failure: Failure::Panic { line: MOST, file: [0; FILE_TAIL] },
            resets: MOST,
            stack_bytes: MOST,
            longest_us: MOST,
            flash_errors: MOST,
            line: LineCounts { overrun: MOST, framing: MOST, noise: MOST, other: MOST, ring_full: MOST },
            messages: Counters {
                sent: MOST,
                received: MOST,
                checksum: MOST,
                coding: MOST,
                too_long: MOST,
                too_short: MOST,
                sequence: MOST,
                timeout: MOST,
                refused: MOST,
            },
            not_sent: MOST,
            ..health
        }),
        Body::Versions(versions) => Body::Versions(Versions {
            firmware: [u16::MAX; 3],
            commit: Some(MOST),
            downlink: u8::MAX,
            uplink: u8::MAX,
            ..versions
        }),
        Body::Recorder(recorder) => Body::Recorder(recorder),
        other => panic!("no largest value of {}", other.as_str()),
    }
}

/// The largest message of each frame, by name; whatever may come secured is.
pub fn largest() -> Vec<(String, Frame)> {
    let widen = |(name, frame)| match frame {
        Frame::Down(Downlink { body, .. }) => {
            let frame = Downlink { sequence: u16::MAX, tick: u32::MAX, body: largest_body(body) };
            (name, Frame::Down(frame))
        }
        Frame::Up(_, Uplink { request, .. }) => {
            let request = match request {
                Request::Train(train) => Request::Train(TrainFrame { id: u64::MAX, ..train }),
                Request::Track(part) => Request::Track(TrackPart {
                    id: u32::MAX,
                    total: u16::MAX,
                    first: u16::MAX,
                    gradients: full::<_, GRADIENTS>(&part.gradients[0]),
                    ..part
                }),
                Request::Effect(_) => Request::Effect(largest_effect()),
                Request::Command(Command::Begin { direction, .. }) => {
                    Request::Command(Command::Begin { direction, track_id: u32::MAX })
                }
                Request::Snapshot(_) => Request::Snapshot(largest_snapshot_part()),
                Request::Curves(part) => Request::Curves(CurvePart {
                    track_id: u32::MAX,
                    first: u16::MAX,
                    curves: full::<_, CURVES>(&part.curves[0]),
                }),
                Request::Targets(part) => Request::Targets(TargetPart {
                    track_id: u32::MAX,
                    first: u16::MAX,
                    targets: full::<_, TARGETS>(&part.targets[1]),
                }),
                Request::Setting(Setting::Features(mut windows)) => {
                    windows.bridge_samples = u32::MAX;
                    Request::Setting(Setting::Features(windows))
                }
                Request::Setting(Setting::Plausibility(mut config)) => {
                    config.agreeing = u32::MAX;
                    Request::Setting(Setting::Plausibility(config))
                }
                other => other,
            };
            let sequence = u16::MAX;
            (name, Frame::Up(SECURED, Uplink { sequence, request }))
        }
    };
    all().into_iter().map(widen).collect()
}
