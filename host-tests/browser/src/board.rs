//! A board behind a TCP port: the frames of simulated runs, as much of them as the test wants, and a line that it may
//! cut.

use rundown_wire::link::serial;
use rundown_wire::{Body, CoastAhead, Downlink, Effort, Estimate, Features, Parameters};
use sim_harness::display::demo;
use std::io::Write;
use std::net::{SocketAddr, TcpListener, TcpStream};

/// The newest frame of each kind, read by itself.
#[derive(Clone, Copy, Debug, Default)]
pub struct Said {
    pub frames: u32,
    pub estimate: Option<Estimate>,
    pub parameters: Option<Parameters>,
    pub effort: Option<Effort>,
    pub coast_ahead: Option<CoastAhead>,
    pub features: Option<Features>,
}

impl Said {
    fn hear(&mut self, message: &[u8]) {
        self.frames += 1;
        match Downlink::decode(message).expect("a frame of the task").body {
            Body::Estimate(estimate) => self.estimate = Some(estimate),
            Body::Parameters(parameters) => self.parameters = Some(parameters),
            Body::Effort(effort) => self.effort = Some(effort),
            Body::CoastAhead(ahead) => self.coast_ahead = Some(ahead),
            Body::Features(features) => self.features = Some(features),
            _ => {}
        }
    }
}

/// A board that plays runs.
pub struct Board {
    listener: TcpListener,
    line: Option<TcpStream>,
    messages: Vec<Vec<u8>>,
    next: usize,
    /// What the display should know.
    pub said: Said,
}

impl Board {
    /// With the frames of so many runs.
    pub fn new(runs: usize) -> Self {
        let mut messages = Vec::new();
        demo::play_runs(runs, |message| messages.push(message.to_vec())).expect("simulated runs");
        Self {
            listener: TcpListener::bind("127.0.0.1:0").expect("a free port"),
            line: None,
            messages,
            next: 0,
            said: Said::default(),
        }
    }

    pub fn address(&self) -> SocketAddr {
        self.listener.local_addr().expect("bound")
    }

    /// Waits for the display.
    pub fn accept(&mut self) {
        let (line, _) = self.listener.accept().expect("the display connects");
        self.line = Some(line);
    }

    /// Cuts the line in the middle of the next message, which is lost.
    pub fn cut(&mut self) {
        let message = serial::encode(&self.messages[self.next]).expect("short");
        self.write(&message[..message.len() / 2]);
        self.next += 1;
        self.line = None;
    }

    /// Bytes that are no message.
    pub fn noise(&mut self, bytes: &[u8]) {
        self.write(bytes);
    }

    /// Says nothing of the next messages; how many.
    pub fn lose(&mut self, messages: usize) -> usize {
        let lost = messages.min(self.messages.len() - self.next);
        self.next += lost;
        lost
    }

    /// Plays on to the end of the tick whose estimate is like this.
    pub fn play_until(&mut self, mut last: impl FnMut(&Estimate) -> bool) {
        loop {
            let message = self.messages.get(self.next).expect("such an estimate").clone();
            self.next += 1;
            let line = serial::encode(&message).expect("short");
            self.write(&line);
            self.said.hear(&message);
            let frame = Downlink::decode(&message).expect("a frame of the task");
            if let Body::Estimate(estimate) = frame.body
                && last(&estimate)
            {
                return;
            }
        }
    }

    /// The messages so far.
    pub fn played(&self) -> &[Vec<u8>] {
        &self.messages[..self.next]
    }

    /// All messages as a recording of the serial line.
    pub fn recording(&self) -> Vec<u8> {
        self.messages.iter().flat_map(|message| serial::encode(message).expect("short")).collect()
    }

    /// Those that the recording ends with.
    pub fn last_parameters(&self) -> Parameters {
        let mut said = Said::default();
        self.messages.iter().for_each(|message| said.hear(message));
        said.parameters.expect("a run has parameters")
    }

    fn write(&mut self, bytes: &[u8]) {
        let line = self.line.as_mut().expect("connected");
        line.write_all(bytes).expect("the display reads");
    }
}
