//! What is wrong with a recorder, or with the description of a line, and no effect of a train: an investigation has to
//! tell it, not to name an effect for it.

use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rundown_check::finding::Kind;
use rundown_files::track_file::{Stop, TrackFile};
use rundown_gap::readings::nuisances::NuisanceKind;
use rundown_truth::effects::{Affected, TrainLengthError};
use rundown_truth::scenario::{Scenario, UnscheduledStop};
use rundown_truth::sensors::SpeedReading;
use serde::Serialize;

/// A kind of nuisance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, clap::ValueEnum)]
#[serde(rename_all = "snake_case")]
pub enum Nuisance {
    /// The effort column is 6 to 12 % too high or too low.
    EffortGain,
    /// The brake readings of the effort column are 20 to 50 % too low beside the power readings.
    BrakeGain,
    /// The effort column has the electric brake only.
    ElectricBrake,
    /// The effort column is one sample late.
    EffortLate,
    /// All locations are 40 to 80 m off along the line.
    LocationOff,
    /// Trains call at four platforms, and each is described 20 to 100 m off.
    PlatformsOff,
    /// The recorder truncates its speeds to whole km/h.
    Truncated,
    /// The recorder's clock loses a second after each 80 to 130 s.
    LostSeconds,
    /// Half of the runs are stopped between stations, at one place.
    MixedStops,
    /// Half of the runs are made by a train of another length, by 40 to 100 %.
    MixedLengths,
}

/// Another length in some of the runs, which has a name of the catalogue.
pub const LENGTH_IN_RUNS: &str = "length_in_runs";

/// Where trains call, m.
const PLATFORMS_M: [f64; 4] = [5_000.0, 11_500.0, 17_500.0, 24_500.0];

/// A nuisance with its size.
#[derive(Clone, Debug, PartialEq)]
pub enum DrawnNuisance {
    /// In the scenario already: the figure that an investigation should tell.
    Told(f64),
    /// Stops as they are described.
    Stops(Vec<Stop>),
    /// In the scenario already, and nothing to be told.
    Nowhere,
}

impl Nuisance {
    /// In tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::EffortGain => "effort 6 to 12 % too high or low, share",
            Self::BrakeGain => "brake readings 20 to 50 % too low, share",
            Self::ElectricBrake => "electric brake only",
            Self::EffortLate => "effort one sample late, s",
            Self::LocationOff => "locations 40 to 80 m off, m",
            Self::PlatformsOff => "platforms described 20 to 100 m off",
            Self::Truncated => "speeds truncated, km/h",
            Self::LostSeconds => "a second in 80 to 130 s lost, % of the rows",
            Self::MixedStops => "half of the runs stopped on the way",
            Self::MixedLengths => "half of the runs with another length, m",
        }
    }

    /// As the investigation calls it; none: it has nothing to tell of it.
    pub fn reported_as(self) -> Option<&'static str> {
        match self {
            Self::EffortGain => Some(NuisanceKind::EffortGain.name()),
            Self::BrakeGain | Self::ElectricBrake => Some(NuisanceKind::BrakeGain.name()),
            Self::EffortLate => Some(NuisanceKind::EffortDelay.name()),
            Self::LocationOff => Some(NuisanceKind::LocationOffset.name()),
            Self::Truncated => Some("truncated_speed"),
            Self::LostSeconds => Some("lost_seconds"),
            Self::MixedLengths => Some(LENGTH_IN_RUNS),
            Self::PlatformsOff | Self::MixedStops => None,
        }
    }

    /// What the diagnosis of the logs tells, before anything is investigated.
    pub fn diagnosed_as(self) -> Option<Kind> {
        match self {
            Self::Truncated => Some(Kind::TruncatedSpeed),
            Self::LostSeconds => Some(Kind::LostSeconds),
            Self::EffortGain
            | Self::BrakeGain
            | Self::ElectricBrake
            | Self::EffortLate
            | Self::LocationOff
            | Self::PlatformsOff
            | Self::MixedStops
            | Self::MixedLengths => None,
        }
    }

    /// Draws its size, and puts it into what is simulated.
    pub fn draw(self, seed: u64, scenario: &mut Scenario) -> DrawnNuisance {
        let mut rng = ChaCha8Rng::seed_from_u64(seed ^ 0x5E_ED0F);
        let sign = |rng: &mut ChaCha8Rng| if rng.next_u32() & 1 == 0 { 1.0 } else { -1.0 };
        let signed = |rng: &mut ChaCha8Rng, least: f64, most: f64| rng.random_range(least..most) * sign(rng);
        let sensors = &mut scenario.sensors;
        match self {
            Self::EffortGain => {
                let off = signed(&mut rng, 0.06, 0.12);
                sensors.effort_gain *= 1.0 + off;
                DrawnNuisance::Told(off)
            }
            Self::BrakeGain => {
                let off = -rng.random_range(0.2..0.5);
                sensors.brake_gain *= 1.0 + off;
                DrawnNuisance::Told(off)
            }
            Self::ElectricBrake => {
                scenario.electric_brake_only = true;
                DrawnNuisance::Nowhere
            }
            Self::EffortLate => {
                sensors.effort_lag_s = sensors.sampling_s;
                DrawnNuisance::Told(sensors.effort_lag_s)
            }
            Self::LocationOff => {
                sensors.location_offset_m = signed(&mut rng, 40.0, 80.0);
                DrawnNuisance::Told(sensors.location_offset_m)
            }
            Self::PlatformsOff => {
                scenario.line.set_calls(PLATFORMS_M.to_vec());
                let mut stop = |at_m| Stop { at_m: at_m + signed(&mut rng, 20.0, 100.0), name: String::new() };
                DrawnNuisance::Stops(PLATFORMS_M.map(&mut stop).into())
            }
            Self::Truncated => {
                sensors.speed = SpeedReading::Truncated;
                DrawnNuisance::Told(sensors.speed_quantum_kmh)
            }
            Self::LostSeconds => {
                sensors.lost_second_every_s = rng.random_range(80.0..130.0);
                DrawnNuisance::Told(100.0 * sensors.sampling_s / sensors.lost_second_every_s)
            }
            Self::MixedStops => {
                let at_m = rng.random_range(6_000.0..24_000.0);
                scenario.unscheduled_stop = Some(UnscheduledStop { at_m, dwell_s: 60.0, share: 0.5 });
                DrawnNuisance::Nowhere
            }
            Self::MixedLengths => {
                let true_length_m = scenario.train.length_m * rng.random_range(1.4_f64..2.0).powf(sign(&mut rng));
                let runs = Affected::Share(0.5);
                scenario.effects.push(TrainLengthError { true_length_m, runs }.into());
                DrawnNuisance::Told(true_length_m)
            }
        }
    }
}

impl DrawnNuisance {
    /// What of it is in the description of the line.
    pub fn described(&self, track: &mut TrackFile) {
        if let Self::Stops(stops) = self {
            let arrival = track.stop.len().min(1);
            track.stop.splice(arrival..arrival, stops.iter().cloned());
        }
    }

    /// The figure that an investigation should tell.
    pub fn told(&self) -> Option<f64> {
        if let Self::Told(value) = self { Some(*value) } else { None }
    }
}
