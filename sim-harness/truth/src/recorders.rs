//! Recorders as they are met on trains: which properties of [`Sensors`] come together.
//!
//! | recorder | speed | location | clock |
//! |---|---|---|---|
//! | event recorder | cut off to whole km/h, 0.2 to 4 s old | odometer of the same wheel, whole metres | loses a second every 106 s; no rows while standing |
//! | phone | satellites, 0.1 km/h | satellites: white and slow noise, lost fixes, positions that stand still | |
//! | tram | whole km/h, 0.2 to 2 s old | satellites between houses: slow noise of 8 m, gaps | |
//! | juridical recording unit | rounded to whole km/h | odometer of the same wheel, whole metres | seconds of the day, every 5 s, across midnight |

use crate::sensors::{Bursts, LocationWalk, Sensors, SpeedReading};
use serde::Deserialize;

/// A kind of recorder.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Recorder {
    /// Of a locomotive.
    EventRecorder,
    /// A phone on the train.
    Phone,
    /// A tram with a receiver of satellites beside its speedometer.
    TramGnss,
    /// The juridical recording unit of a train with ETCS.
    Jru,
}

impl Recorder {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::EventRecorder, Self::Phone, Self::TramGnss, Self::Jru];

    /// As in scenario files.
    pub fn name(self) -> &'static str {
        match self {
            Self::EventRecorder => "event_recorder",
            Self::Phone => "phone",
            Self::TramGnss => "tram_gnss",
            Self::Jru => "jru",
        }
    }

    /// What it does to the truth.
    pub fn sensors(self) -> Sensors {
        let second = Sensors { sampling_s: 1.0, ..Sensors::default() };
        let odometer = odometer();
        match self {
            Self::EventRecorder => Sensors {
                speed: SpeedReading::Truncated,
                speed_lag_s: [0.2, 4.0],
                lost_second_every_s: 106.0,
                standing_rows: false,
                ..odometer
            },
            Self::Phone => Sensors {
                speed_quantum_kmh: 0.1,
                speed_noise_kmh: 0.5,
                location_noise_m: 2.0,
                location_walk: Some(LocationWalk::of(5.0)),
                dropout_probability: 0.01,
                bursts: Some(Bursts { probability: 0.002, samples: [5, 40] }),
                location_stuck: Some(Bursts { probability: 0.001, samples: [8, 25] }),
                ..second
            },
            Self::TramGnss => Sensors {
                speed_lag_s: [0.2, 2.0],
                location_noise_m: 3.0,
                location_walk: Some(LocationWalk::of(8.0)),
                bursts: Some(Bursts { probability: 0.004, samples: [3, 20] }),
                ..second
            },
            Self::Jru => Sensors { sampling_s: 5.0, day_clock_s: Some([84_900.0, 86_300.0]), ..odometer },
        }
    }
}

/// Every second the location of an odometer, whole metres by the same wheel as the speed, which is rounded.
pub fn odometer() -> Sensors {
    Sensors {
        sampling_s: 1.0,
        location_noise_m: 0.0,
        location_by_wheel: true,
        location_step_m: 1.0,
        ..Sensors::default()
    }
}
