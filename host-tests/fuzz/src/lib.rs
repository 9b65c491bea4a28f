//! A conversation with a board, read from arbitrary bytes.
//!
//! In: the bytes of the fuzzer. Out: steps ([`Step`]); what the board says is checked by [`Conversation::hear`]. Random
//! bytes never carry a valid MAC, so some steps are signed here.
#![forbid(unsafe_code)]
#![warn(missing_docs)]

use host_tests::board::PROVISIONING;
use host_tests::coasting::with_targets;
use host_tests::prelude::*;
use rundown::model::effects::*;
use rundown::onboard::auth::Signer;
use rundown::onboard::task::DATA_ID;
use rundown::uplink::{self, OPEN, SECURED, Uplink};
use rundown_wire::{Body, Downlink, MAX_MESSAGE};
use std::collections::VecDeque;
use std::sync::LazyLock;

/// What happens next.
#[derive(Clone, Debug)]
pub enum Step {
    /// The clock ticks.
    Tick,
    /// The line takes no message, until the next such step.
    Deaf(bool),
    /// A message arrives.
    Message(Vec<u8>),
    /// Bytes that are no message arrive on the line.
    Noise(Vec<u8>),
}

/// The bytes of the fuzzer, taken piece by piece; zeros when they are used up.
#[derive(Debug)]
pub struct Script<'a>(pub &'a [u8]);

impl Script<'_> {
    /// The next byte.
    pub fn byte(&mut self) -> u8 {
        let [byte] = self.array();
        byte
    }

    /// The next bytes.
    pub fn array<const N: usize>(&mut self) -> [u8; N] {
        let mut bytes = [0; N];
        let taken = self.0.len().min(N);
        let (now, later) = self.0.split_at(taken);
        bytes[..taken].copy_from_slice(now);
        self.0 = later;
        bytes
    }

    /// As many of the next bytes as the next two say.
    pub fn bytes(&mut self) -> Vec<u8> {
        let length = usize::from(u16::from_le_bytes(self.array())) % (MAX_MESSAGE + 16);
        let (now, later) = self.0.split_at(length.min(self.0.len()));
        self.0 = later;
        now.to_vec()
    }

    /// Any number, all bit patterns; often a usual one.
    fn number(&mut self) -> f64 {
        match self.byte() % 4 {
            0 => f64::from_le_bytes(self.array()),
            1 => f64::from(i16::from_le_bytes(self.array())),
            2 => f64::from(self.byte()) / 3.6,
            _ => f64::from(u16::from_le_bytes(self.array())) / 65.535,
        }
    }

    fn field(&mut self) -> Option<f64> {
        (!self.byte().is_multiple_of(8)).then(|| self.number())
    }
}

/// Requests that describe a board and make it run, in the order in which they work.
static REQUESTS: LazyLock<Vec<Request>> = LazyLock::new(|| {
    let description = described();
    let mut requests = description.requests(PROVISIONING.train.0);
    let track_id = description.track_id();
    requests.push(Request::Surroundings(Surroundings { temperature_c: Some(-5.0), day: Some(20_500.0) }));
    for command in [
        Command::Pace(Pace::Lockstep),
        Command::Begin { direction: Direction::Up, track_id },
        Command::Snapshot,
        Command::End,
        Command::Begin { direction: Direction::Down, track_id },
        Command::Pace(Pace::Clock),
        Command::Status,
        Command::Forget,
        Command::ClearEffects,
    ] {
        requests.push(Request::Command(command));
    }
    requests
        .extend([Mode::Paper, Mode::Measured, Mode::Gated].map(|mode| Request::Setting(uplink::Setting::Mode(mode))));
    requests
});

/// A train and a track with something of everything: every request has a pattern to bend.
fn described() -> Description {
    let curve = |from_m| Curve { from_m, to_m: from_m + 300.0, radius_m: 600.0 };
    let effects = [
        Effect::CurveResistance(CurveResistance { coefficient_roeckl: 0.8 }),
        Effect::TemperatureResistance(TemperatureResistance { dr0_per_deg_c: -1e-4, ref_c: 15.0 }),
        Effect::SeasonalDrift(SeasonalDrift { dr0_over_period: 1e-3, period_days: 365.0, reference_day: 20_000.0 }),
        Effect::SpeedScale(SpeedScale { measured_over_true: 1.01 }),
        Effect::Unknown(Unknown {
            coordinate: Coordinate::Temperature,
            table: [(-10.0, 4e-3), (20.0, 0.0)].into_iter().collect(),
        }),
    ];
    Description {
        curves: (0..20).map(|i| curve(1000.0 * f64::from(i))).collect(),
        effects: Effects::try_new(effects).expect("effects that a train can have"),
        ..with_targets(Config::default(), &Scenario::default())
    }
}

/// Requests of [`REQUESTS`] after which a run is under way in lockstep.
static PREPARING: LazyLock<usize> = LazyLock::new(|| {
    let begin = |request: &Request| matches!(request, Request::Command(Command::Begin { .. }));
    REQUESTS.iter().position(begin).unwrap_or(0) + 1
});

/// One end of a conversation.
#[derive(Debug)]
pub struct Conversation<'a> {
    script: Script<'a>,
    signer: Option<Signer>,
    sequence: u16,
    time_s: f64,
    location_m: f64,
    /// Snapshot pieces of the board, which may come back.
    heard: Vec<Request>,
    waiting: VecDeque<Step>,
    preparing: std::ops::Range<usize>,
}

impl<'a> Conversation<'a> {
    /// Begins with a request for the status, so that signing is possible. The first byte decides whether the board is
    /// described before the rest.
    pub fn new(bytes: &'a [u8]) -> Self {
        let mut script = Script(bytes);
        let prepared = !script.byte().is_multiple_of(4);
        let mut conversation = Self {
            script,
            signer: None,
            sequence: 0,
            time_s: 0.0,
            location_m: 0.0,
            heard: Vec::new(),
            waiting: VecDeque::new(),
            preparing: 0..if prepared { *PREPARING } else { 0 },
        };
        let status = conversation.open(Request::Command(Command::Status));
        conversation.waiting.push_back(status);
        conversation
    }

    /// The next step; none when the bytes are used up.
    pub fn next_step(&mut self) -> Option<Step> {
        if let Some(step) = self.waiting.pop_front() {
            return Some(step);
        }
        if let Some(index) = self.preparing.next() {
            return Some(self.secured(&REQUESTS[index].clone()));
        }
        if self.script.0.is_empty() {
            return None;
        }
        let script = &mut self.script;
        Some(match script.byte() % 12 {
            0 => Step::Tick,
            1 => Step::Deaf(script.byte().is_multiple_of(2)),
            2 => Step::Noise(script.bytes()),
            3 => Step::Message(script.bytes()),
            4 => Step::Message([&[uplink::VERSION, OPEN], &script.bytes()[..]].concat()),
            5 => {
                let payload = script.bytes();
                self.sign(&payload)
            }
            6 => {
                let request = REQUESTS[usize::from(script.byte()) % REQUESTS.len()].clone();
                self.secured(&request)
            }
            7 => self.bent(),
            8 if !self.heard.is_empty() => {
                let index = usize::from(script.byte()) % self.heard.len();
                let request = self.heard[index].clone();
                self.secured(&request)
            }
            9 => self.coasting(),
            _ => self.measurement(),
        })
    }

    /// What the board says must be readable, and every number in it a number.
    pub fn hear(&mut self, message: &[u8]) {
        let frame = Downlink::decode(message).expect("the board's own frames are readable");
        let text = format!("{:?}", frame.body);
        let mut words = text.split(|c: char| !c.is_alphanumeric() && c != '_');
        assert!(!words.any(|word| word == "NaN" || word == "inf"), "a number that is none: {text}");
        match frame.body {
            Body::Status(status) => {
                let Some(announcement) = &status.announcement else {
                    return;
                };
                match &mut self.signer {
                    Some(signer) => signer.hear(announcement).expect("the same key"),
                    None => self.signer = Signer::new(&PROVISIONING, announcement).ok(),
                }
            }
            Body::SnapshotPart(part) => {
                if part.first == 0 {
                    self.heard.clear();
                }
                self.heard.push(Request::Snapshot(part));
            }
            _ => {}
        }
    }

    /// A known request with one byte changed, if it still is one; signed in any case.
    fn bent(&mut self) -> Step {
        let index = usize::from(self.script.byte()) % REQUESTS.len();
        let mut payload = self.payload(&REQUESTS[index].clone());
        let at = usize::from(self.script.byte()) % payload.len();
        let [with, more] = self.script.array();
        payload[at] ^= with;
        // Numbers are 8 bytes: their exponents lie at the end.
        if let Some(byte) = payload.get_mut(at + 1) {
            *byte ^= more;
        }
        self.sign(&payload)
    }

    fn measurement(&mut self) -> Step {
        let script = &mut self.script;
        let time_s = match script.byte() % 8 {
            0 => script.number(),
            1 => self.time_s + script.number(),
            n => self.time_s + 5.0 * f64::from(n),
        };
        let measurement = Measurement {
            time_s,
            location_m: script.field(),
            speed_mps: script.field(),
            effort_n_per_kg: script.field(),
        };
        if time_s.is_finite() {
            self.time_s = time_s;
        }
        self.open(Request::Measurement(measurement))
    }

    /// Minutes of a train that coasts, so that something is learned.
    fn coasting(&mut self) -> Step {
        let mut speed_mps = f64::from(self.script.byte() % 45);
        for _ in 0..self.script.byte() % 32 {
            self.time_s += 10.0;
            self.location_m += 10.0 * speed_mps;
            speed_mps = (speed_mps - 0.4).max(0.0);
            let step = self.open(Request::Measurement(Measurement {
                time_s: self.time_s,
                location_m: Some(self.location_m),
                speed_mps: Some(speed_mps),
                effort_n_per_kg: None,
            }));
            self.waiting.push_back(step);
        }
        Step::Tick
    }

    fn payload(&mut self, request: &Request) -> Vec<u8> {
        self.sequence = self.sequence.wrapping_add(1);
        let uplink = Uplink { sequence: self.sequence, request: request.clone() };
        let mut buffer = [0; MAX_MESSAGE];
        let message = uplink::encode(&uplink, OPEN, &mut buffer).expect("known requests are short");
        message[2..].to_vec()
    }

    fn open(&mut self, request: Request) -> Step {
        let payload = self.payload(&request);
        Step::Message([&[uplink::VERSION, OPEN], &payload[..]].concat())
    }

    fn secured(&mut self, request: &Request) -> Step {
        let payload = self.payload(request);
        self.sign(&payload)
    }

    /// A message with a valid MAC, whatever is in it; without one while the board has not announced its freshness.
    fn sign(&mut self, payload: &[u8]) -> Step {
        let bare = [&[uplink::VERSION, SECURED], payload].concat();
        let mut buffer = [0; 2 * MAX_MESSAGE];
        let sealed = self.signer.as_mut().and_then(|signer| signer.seal(DATA_ID, &bare, &mut buffer).ok());
        Step::Message(sealed.map(<[u8]>::to_vec).unwrap_or(bare))
    }
}
