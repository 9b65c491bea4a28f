//! What the two benches run: the reference run, its efforts known beforehand, so that a step is predict and update and
//! nothing else.

use host_tests::prelude::*;
use host_tests::reference::{data, train_and_track};
use host_tests::textbook::{self, PlainSpread, Read};
use nalgebra::SMatrix;
use rundown::filter::ukf::{Spread, Ukf};
use rundown::model::line::Line;
use rundown::model::motion::Motion;
use std::hint::black_box;

/// Steps of one run.
pub const RUN: usize = 90;
const DT_S: f64 = 10.0;
const OBSERVATION: LocationAndSpeed = LocationAndSpeed { location_variance: 16.0, speed_variance: 1.0 / (3.6 * 3.6) };

/// Everything that is set once.
pub struct Drive {
    train: Train,
    track: Track,
    begin: Gaussian<SIZE>,
    /// Effort before, location and speed of each step.
    steps: Vec<(f64, f64, f64)>,
}

impl Drive {
    /// Track, train and run of `data/reference`.
    pub fn of_reference() -> Self {
        let (train, track) = train_and_track();
        let table = std::fs::read_to_string(data("reference/A_run01.csv")).expect("reference");
        let mut lines = table.lines();
        let columns: Vec<&str> = lines.next().expect("header").split(',').collect();
        let column = |name: &str| columns.iter().position(|c| *c == name).expect("column");
        let (z_s, z_kmh, u) = (column("z_s"), column("z_kmh"), column("u_prev"));
        let number = |cell: &str| cell.parse().unwrap_or(0.0);
        let steps: Vec<(f64, f64, f64)> = lines
            .map(|line| line.split(',').collect::<Vec<_>>())
            .map(|cells| (number(cells[u]), number(cells[z_s]), number(cells[z_kmh]) / 3.6))
            .collect();
        let davis = train.davis();
        Self {
            begin: Gaussian::independent(
                [steps[0].1, steps[0].2, davis.r0, davis.r1, davis.r2],
                [1.0, 0.0005, 1e-6, 1e-8, 1e-9],
            ),
            train,
            track,
            steps: steps[1..=RUN].to_vec(),
        }
    }

    fn line(&self) -> Line<'_> {
        Line { train: &self.train, track: &self.track, direction: Direction::Up }
    }

    /// `steps` steps of `one`; a new run begins after each `RUN`.
    #[inline(always)]
    fn run(&self, steps: usize, one: impl Fn(&mut Gaussian<SIZE>, f64, f64, f64)) -> Gaussian<SIZE> {
        let mut belief = self.begin;
        for i in 0..steps {
            if i % RUN == 0 {
                belief = self.begin;
            }
            let &(effort, location_m, speed_mps) = black_box(&self.steps[i % RUN]);
            one(black_box(&mut belief), effort, location_m, speed_mps);
        }
        belief
    }

    /// Steps of `rundown::filter::ukf`.
    pub fn ours(&self, steps: usize) -> Gaussian<SIZE> {
        let line = self.line();
        // As in a replay, where they come from a file: nothing is worked out beforehand.
        let (spread, reuse_points, observation, dt_s) = black_box((Spread::PAPER, true, OBSERVATION, DT_S));
        let ukf = Ukf { spread, gate: [None; 2], reuse_points };
        self.run(steps, |belief, effort, location_m, speed_mps| {
            let motion = Motion::new(&line, &belief.mean, effort, dt_s, Evaluate::Beginning);
            let z = [Some(location_m), Some(speed_mps)];
            black_box(ukf.step(belief, &motion, &observation, &z)).expect("positive definite");
        })
    }

    /// Steps of the textbook form.
    pub fn textbook(&self, steps: usize) -> Gaussian<SIZE> {
        let shape = black_box(PlainSpread { alpha: 1e-3, beta: 2.0, kappa: -2.0 });
        self.run(steps, |belief, effort, location_m, speed_mps| {
            let motion = textbook::Motion::new(self.line(), &belief.mean, effort, DT_S, Evaluate::Beginning);
            let read = |component, value, variance| Read { component, value, variance };
            let readings =
                [read(0, location_m, OBSERVATION.location_variance), read(1, speed_mps, OBSERVATION.speed_variance)];
            let step = textbook::step(shape, belief, |x| motion.advance(x), &SMatrix::zeros(), true, &readings);
            *belief = black_box(step).expect("positive definite").posterior;
        })
    }

    /// The loop alone.
    #[allow(dead_code, reason = "only one of the two benches takes it off")]
    pub fn nothing(&self, steps: usize) -> Gaussian<SIZE> {
        self.run(steps, |belief, effort, location_m, speed_mps| {
            black_box((belief, effort, location_m, speed_mps));
        })
    }
}
