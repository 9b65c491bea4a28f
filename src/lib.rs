//! Rundown: on-board train motion estimator after Cunillera et al. 2022, `no_std`, in fixed memory. It learns the
//! running resistance of a train that coasts:
//!
//! ```
//! use rundown::{Config, Direction, Estimator, Measurement, Track, Train, TrainDescription};
//!
//! # // Whole km/h every 10 s of a train that coasts from 140 km/h with a tenth less resistance than described.
//! # fn coasting() -> impl Iterator<Item = Measurement> {
//! #     let davis = TrainDescription::CASE_STUDY.davis;
//! #     let (mut location_m, mut speed_mps) = (0.0, 140.0 / 3.6);
//! #     (0..30).map(move |tick| {
//! #         let reading_mps = (speed_mps * 3.6_f64).round() / 3.6;
//! #         let measurement = Measurement {
//! #             time_s: 10.0 * f64::from(tick),
//! #             location_m: Some(location_m),
//! #             speed_mps: Some(reading_mps),
//! #             effort_n_per_kg: None,
//! #         };
//! #         for _ in 0..100 {
//! #             let r = 0.9 * davis.resistance_n_per_kg(speed_mps);
//! #             location_m += 0.1 * speed_mps;
//! #             speed_mps -= 0.1 * r;
//! #         }
//! #         measurement
//! #     })
//! # }
//! let train = Train::try_new(TrainDescription::CASE_STUDY)?;
//! let estimator = Estimator::try_new(Config::default(), train, Track::try_new(32e3, [])?)?;
//! let (mut run, mut learned) = (estimator.begin_run(&estimator.new_vehicle(), Direction::Up), train.davis());
//! for measurement in coasting() { learned = estimator.step(&mut run, &measurement)?.davis(); }
//! let share = learned.resistance_n_per_kg(30.0) / train.davis().resistance_n_per_kg(30.0);
//!
//! assert!((share - 0.9).abs() < 0.02, "{share}: the train has a tenth less resistance than described");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! With [`Estimator::end_run`] what was learned goes into the vehicle, from which the next run begins.
//!
//! ```text
//!              set once: Config, Train, Track                        carried from run to run: Vehicle (memory)
//!                          |                                                  |            ^
//!                          v                                                  v            |
//! measurement -> plausibility -> kinematics -> effort -> regime -> learning (ukf, motion) -+-> estimate
//!                                     |                    |                                     |
//!                                     |                    +-- one tick later, confirmed --> features -> summary
//!                                     +-> paper (ukf, motion), instead of regime and learning in the `paper` mode
//!
//! estimate + track with its targets -> coast_ahead: speed and time at the next one
//! ```
//!
//! [`estimator`] alone knows this order. Beside it stand [`onboard::store`] (the vehicle survives the power cut) and
//! [`onboard::auth`] (who may change what).
//!
//! | equation, section | item |
//! |---|---|
//! | Eq. (1) solved for the effort | [`model::effort`] |
//! | Eq. (2) Davis | [`model::resistance::Davis`] |
//! | Eq. (3)-(5) motion | [`model::motion::Motion`] |
//! | Eq. (6) measurement | [`tick::learning::LocationAndSpeed`] |
//! | Eq. (7)-(18) filter | [`filter::ukf::Ukf`], [`filter::elimination`]; of any system [`filter::general::GeneralUkf`] |
//! | Table 1 | [`tick::paper::PaperConfig`] |
//! | Eq. (1) at no effort, over distance | [`coast_ahead`] |
//! | section 3.2 regimes | [`tick::regime::PaperRule`], [`tick::regime::Recogniser`] |
//! | section 3.3 features | [`features`] |
//!
//! What leaves the board and what comes to it are messages of [`link`], over a serial line or CAN.
//!
//! *Tick*: one measurement and its answer. *Run*: from one long stop to the next. *Regime*: what the driver does.
//! *Vehicle*: what is known of the train beyond the day. *Final coast*: coasting before the brake that leaves line
//! speed. Effort and resistance are per rotating mass γ m, in N/kg; traction positive, brake negative, uphill positive,
//! resistance positive against travel.
//!
//! | feature | default | adds |
//! |---|---|---|
//! | `onboard` | yes | [`onboard`]: store, authentication, task, serial line; with it `embedded-storage`, `embedded-hal-nb` |
//! | `alloc` | no | effects are read and written by name (TOML, JSON), which takes an allocator |
//! | `can` | no | CAN beside the serial line in the firmware of the B-L475E-IOT01A; nothing in the library |
//! | `mps2`, `emulator`, `filter-step` | no | test firmware for the emulator; nothing in the library |
#![no_std]
#![forbid(unsafe_code)]
#![warn(missing_docs)]
// What a board sets in place or writes as plain bytes, a replay does not.
#![cfg_attr(not(feature = "onboard"), allow(dead_code))]

pub mod coast_ahead;
pub mod estimator;
mod extremes;
pub mod features;
pub mod filter;
mod listed;
pub mod model;
#[cfg(feature = "onboard")]
pub mod onboard;
mod plain;
mod roots;
pub mod tick;
pub mod uplink;

pub use estimator::{Estimator, config::Config};
pub use model::{
    direction::Direction,
    resistance::Davis,
    track::Track,
    train::{Train, TrainDescription},
};
pub use rundown_wire::link;
pub use tick::measurement::Measurement;

/// Number type of the whole estimator. With the spread of the paper textbook weights are near 1.7e6, so single
/// precision is not enough.
pub type Real = f64;
