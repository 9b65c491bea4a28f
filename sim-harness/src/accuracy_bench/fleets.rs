//! The fleets of the bench: which train, on which line, driven how, recorded by what.

use rundown::estimator::config::{Config, Mode};
use rundown::model::resistance::Davis;
use rundown::model::train::{Train, TrainDescription};
use rundown_truth::habits::DriverKind;
use rundown_truth::line::Line;
use rundown_truth::recorders::odometer;
use rundown_truth::scenario::Scenario;
use rundown_truth::sensors::{Sensors, SpeedReading};
use rundown_truth::train::{DavisTruth, TrainTruth};

/// One fleet: what is simulated, how it is estimated, and where its resistance is judged.
#[derive(Clone, Debug)]
pub struct Fleet {
    /// Short name, for the command line.
    pub name: &'static str,
    /// In words.
    pub what: &'static str,
    /// The world of each vehicle, but for its resistance.
    pub scenario: Scenario,
    /// How the resistance is learned.
    pub mode: Mode,
    /// Speeds of this kind of train, km/h.
    pub band_kmh: [f64; 2],
    /// Standard deviation of a vehicle's gain of the effort column.
    pub effort_gain_sd: f64,
}

impl Fleet {
    fn new(name: &'static str, what: &'static str, scenario: Scenario) -> Self {
        Self { name, what, scenario, mode: Mode::Gated, band_kmh: [20.0, 140.0], effort_gain_sd: 0.0 }
    }

    fn band(self, band_kmh: [f64; 2]) -> Self {
        Self { band_kmh, ..self }
    }

    /// With an effort column of 2 % white noise and an unknown gain.
    fn measured(self) -> Self {
        let mut fleet = Self { mode: Mode::Measured, effort_gain_sd: 0.03, ..self };
        fleet.scenario.sensors.effort_noise_share = 0.02;
        fleet
    }

    /// Settings of the estimator: nothing that the log would have to say.
    pub fn config(&self) -> Config {
        Config::with_mode(self.mode)
    }

    /// The train as it is described.
    pub fn description(&self) -> TrainDescription {
        let train = &self.scenario.train;
        let DavisTruth { r0, r1, r2 } = train.davis;
        TrainDescription {
            mass_kg: train.mass_kg,
            rotating_mass_factor: train.gamma,
            length_m: train.length_m,
            davis: Davis { r0, r1, r2 },
            max_tractive_effort_n: train.max_tractive_effort_n,
            max_power_w: train.max_power_w,
            max_brake_mps2: train.max_brake_mps2,
        }
    }

    /// The same as the estimator takes it; all trains here are ones.
    pub fn train(&self) -> Option<Train> {
        Train::try_new(self.description()).ok()
    }
}

/// Every fleet of the bench.
pub fn all() -> Vec<Fleet> {
    let case_study = Scenario::default;
    let every = |sampling_s| Sensors { sampling_s, ..Sensors::default() };
    let sensed = |sensors: Sensors| Scenario { sensors, ..Scenario::default() };
    vec![
        Fleet::new("calm", "intercity, calm, 10 s", case_study()),
        Fleet::new("1s", "intercity, calm, 1 s", sensed(every(1.0))),
        Fleet::new("wind", "wind of 2 m/s between runs", Scenario { wind_sd_mps: 2.0, ..case_study() }),
        Fleet::new("hills", "hills of 10 permille", Scenario { line: Line::hilly(3), ..case_study() }),
        Fleet::new(
            "on-off",
            "speed held by cycles of power and coasting",
            Scenario { cycle_share: 1.0, ..case_study() },
        ),
        Fleet::new("holding", "speed held by holding it", Scenario { cycle_share: 0.0, ..case_study() }),
        Fleet::new(
            "missing",
            "a tenth of the readings missing",
            sensed(Sensors { dropout_probability: 0.1, ..every(10.0) }),
        ),
        Fleet::new(
            "truncated",
            "speeds cut off to whole km/h, and not declared",
            sensed(Sensors { speed: SpeedReading::Truncated, ..every(10.0) }),
        ),
        Fleet::new("odometer", "odometer in whole metres, rounded speed, 1 s", sensed(odometer())),
        Fleet::new("effort", "effort column: mean, 2 % noise, unknown gain", case_study()).measured(),
        Fleet::new("effort-1s", "the same effort column at 1 s", sensed(every(1.0))).measured(),
        Fleet::new(
            "momentary",
            "momentary efforts, and not declared",
            sensed(Sensors { effort_momentary: true, ..every(10.0) }),
        )
        .measured(),
        Fleet::new(
            "late",
            "mean efforts one second late, and not declared",
            sensed(Sensors { effort_lag_s: 1.0, ..every(10.0) }),
        )
        .measured(),
        Fleet::new("late-1s", "mean efforts one second late, 1 s", sensed(Sensors { effort_lag_s: 1.0, ..every(1.0) }))
            .measured(),
        Fleet::new("effort-wind", "effort column, wind of 2 m/s", Scenario { wind_sd_mps: 2.0, ..case_study() })
            .measured(),
        Fleet::new("metro", "metro, 90 km/h, 1.2 km between stops, 1 s", metro(1.0)).band([20.0, 90.0]),
        Fleet::new("tram", "tram, 50 km/h, 500 m between stops, 1 s", tram(1.0)).band([15.0, 50.0]),
        Fleet::new("suburban", "suburban, 120 km/h, 3 km between stops, 10 s", suburban(10.0)).band([20.0, 120.0]),
        Fleet::new("suburban-1s", "suburban, the same at 1 s", suburban(1.0)).band([20.0, 120.0]),
        Fleet::new("metro-tenths", "metro, speeds in tenths of a km/h", tenths(metro(1.0))).band([20.0, 90.0]),
        Fleet::new("tram-tenths", "tram, speeds in tenths of a km/h", tenths(tram(1.0))).band([15.0, 50.0]),
        Fleet::new("suburban-tenths", "suburban, 1 s, speeds in tenths of a km/h", tenths(suburban(1.0)))
            .band([20.0, 120.0]),
        Fleet::new("suburban-effort", "suburban, 1 s, effort column: mean, 2 % noise, unknown gain", suburban(1.0))
            .measured()
            .band([20.0, 120.0]),
        Fleet::new("freight", "freight, 90 km/h, 10 s", freight()).band([20.0, 90.0]),
        Fleet::new("high-speed", "high speed, 300 km/h, 10 s", high_speed()).band([60.0, 300.0]),
    ]
}

/// A line that is level but for short ramps of a few permille, with a stop every so many metres.
fn stopping(length_m: f64, hop_m: f64, limit_kmh: f64) -> Line {
    let ramps = (1..).map(|i| f64::from(i) * 0.7 * hop_m).take_while(|at_m| *at_m < length_m);
    let permille = [2.0, -3.0, 1.0, 0.0, 3.0, -2.0, -1.0];
    let gradients = std::iter::once((0.0, 0.0)).chain(ramps.zip(permille.into_iter().cycle()));
    let mut line = Line::new(length_m, gradients.collect(), vec![(0.0, limit_kmh)]);
    let calls = (1..).map(|i| f64::from(i) * hop_m).take_while(|at_m| *at_m < length_m - 0.5 * hop_m);
    line.set_calls(calls.collect());
    line
}

fn hops(driver: DriverKind, train: TrainTruth, line: Line, sampling_s: f64) -> Scenario {
    let sensors = Sensors { sampling_s, ..Sensors::default() };
    Scenario { train, line, driver, sensors, ..Scenario::default() }
}

/// The same with speeds in tenths of a km/h.
fn tenths(mut scenario: Scenario) -> Scenario {
    scenario.sensors.speed_quantum_kmh = 0.1;
    scenario
}

fn metro(sampling_s: f64) -> Scenario {
    let train = TrainTruth {
        mass_kg: 180_000.0,
        gamma: 1.08,
        length_m: 110.0,
        davis: DavisTruth { r0: 1.1e-2, r1: 2.4e-4, r2: 4.5e-5 },
        max_tractive_effort_n: 190_000.0,
        max_power_w: 1_900_000.0,
        max_brake_mps2: 1.1,
    };
    hops(DriverKind::HopAndCoast, train, stopping(18_000.0, 1_200.0, 90.0), sampling_s)
}

fn tram(sampling_s: f64) -> Scenario {
    let train = TrainTruth {
        mass_kg: 45_000.0,
        gamma: 1.1,
        length_m: 32.0,
        davis: DavisTruth { r0: 1.8e-2, r1: 4.0e-4, r2: 9.0e-5 },
        max_tractive_effort_n: 55_000.0,
        max_power_w: 480_000.0,
        max_brake_mps2: 1.2,
    };
    hops(DriverKind::HopAndCoast, train, stopping(9_000.0, 500.0, 50.0), sampling_s)
}

fn suburban(sampling_s: f64) -> Scenario {
    let train = TrainTruth {
        mass_kg: 130_000.0,
        gamma: 1.07,
        length_m: 75.0,
        davis: DavisTruth { r0: 9.0e-3, r1: 2.0e-4, r2: 4.2e-5 },
        max_tractive_effort_n: 130_000.0,
        max_power_w: 1_800_000.0,
        max_brake_mps2: 1.0,
    };
    hops(DriverKind::ShortHop, train, stopping(36_000.0, 3_000.0, 120.0), sampling_s)
}

fn freight() -> Scenario {
    let train = TrainTruth {
        mass_kg: 1_600_000.0,
        gamma: 1.05,
        length_m: 520.0,
        davis: DavisTruth { r0: 1.2e-2, r1: 1.0e-4, r2: 2.6e-5 },
        max_tractive_effort_n: 300_000.0,
        max_power_w: 5_600_000.0,
        max_brake_mps2: 0.35,
    };
    Scenario { train, line: stopping(45_000.0, 45_000.0, 90.0), ..Scenario::default() }
}

fn high_speed() -> Scenario {
    let train = TrainTruth {
        mass_kg: 420_000.0,
        gamma: 1.04,
        length_m: 200.0,
        davis: DavisTruth { r0: 6.5e-3, r1: 9.0e-5, r2: 1.15e-5 },
        max_tractive_effort_n: 270_000.0,
        max_power_w: 8_800_000.0,
        max_brake_mps2: 0.7,
    };
    Scenario { train, line: stopping(110_000.0, 110_000.0, 300.0), ..Scenario::default() }
}
