//! Rundown: on-board train motion estimator after Cunillera et al. 2022, `no_std`, in fixed memory.
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
//! [`estimator`] alone knows this order. Beside it stand [`onboard::store`] (the vehicle survives the power cut) and [`onboard::auth`] (who may change what).
//!
//! | equation, section | item |
//! |---|---|
//! | Eq. (1) solved for the effort | [`model::effort`] |
//! | Eq. (2) Davis | [`model::resistance::Davis`] |
//! | Eq. (3)-(5) motion | [`model::motion::Motion`] |
//! | Eq. (6) measurement | [`tick::learning::LocationAndSpeed`] |
//! | Eq. (7)-(18) filter | [`filter::ukf::Ukf`], [`filter::elimination`] |
//! | Table 1 | [`tick::paper::PaperConfig`] |
//! | Eq. (1) at no effort, over distance | [`coast_ahead`] |
//! | section 3.2 regimes | [`tick::regime::PaperRule`], [`tick::regime::Recogniser`] |
//! | section 3.3 features | [`features`] |
//!
//! What leaves the board and what comes to it are messages of [`link`], over a serial line or CAN.
//!
//! *Tick*: one measurement and its answer. *Run*: from one long stop to the next. *Regime*: what the driver does. *Vehicle*: what is known of the train beyond the day.
//! *Final coast*: coasting before the brake that leaves line speed. Effort and resistance are per rotating mass γ m, in N/kg; traction positive, brake negative, uphill positive,
//! resistance positive against travel.
//!
//! ```
//! use rundown::model::{track::Gradient, train::TrainDescription};
//! use rundown::{Config, Davis, Direction, Estimator, Measurement, Track, Train};
//!
//! let train = Train::try_new(TrainDescription::CASE_STUDY)?;
//! let track = Track::try_new(32e3, [Gradient { from_m: 0.0, permille: 0.0 }])?;
//! let estimator = Estimator::try_new(Config::default(), train, track)?;
//! let mut vehicle = estimator.new_vehicle();
//! let mut run = estimator.begin_run(&vehicle, Direction::Up);
//!
//! // A train coasts from 140 km/h with a tenth less resistance than described.
//! let (mut location_m, mut speed_mps) = (0.0, 140.0 / 3.6);
//! for tick in 0..30 {
//!     estimator.step(&mut run, &Measurement {
//!         time_s: 10.0 * f64::from(tick),
//!         location_m: Some(location_m),
//!         speed_mps: Some((speed_mps * 3.6_f64).round() / 3.6),
//!         effort_n_per_kg: None,
//!     })?;
//!     for _ in 0..100 {
//!         let r = 0.9 * train.davis().resistance_n_per_kg(speed_mps);
//!         location_m += 0.1 * speed_mps;
//!         speed_mps -= 0.1 * r;
//!     }
//! }
//! let summary = estimator.end_run(&mut run, &mut vehicle);
//! let [r0, r1, r2] = summary.run_davis.mean.into();
//! let learned = Davis { r0, r1, r2 }.resistance_n_per_kg(30.0) / train.davis().resistance_n_per_kg(30.0);
//! assert!((learned - 0.9).abs() < 0.02, "{learned}");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
#![no_std]
#![forbid(unsafe_code)]
#![warn(missing_docs)]
// Parts of the model are set in place by a board only.
#![cfg_attr(not(feature = "onboard"), allow(dead_code, unused_imports))]

pub mod coast_ahead;
pub mod estimator;
pub mod features;
pub mod filter;
mod listed;
pub mod model;
#[cfg(feature = "onboard")]
pub mod onboard;
pub mod tick;
pub mod uplink;

pub use estimator::{Estimator, config::Config};
pub use model::{direction::Direction, resistance::Davis, track::Track, train::Train};
pub use rundown_wire::link;
pub use tick::measurement::Measurement;

/// Number type of the whole estimator. With the spread of the paper textbook weights are near 1.7e6, so single precision is not enough.
pub type Real = f64;
