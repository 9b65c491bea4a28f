//! What nearly every test of a board names: `use board_tests::prelude::*;`.

pub use rand::{Rng, RngExt, SeedableRng};
pub use rand_chacha::ChaCha8Rng;
pub use rundown::estimator::config::{Config, Mode};
pub use rundown::estimator::{Estimator, RunSummary};
pub use rundown::filter::gaussian::Gaussian;
pub use rundown::model::direction::Direction;
pub use rundown::model::motion::Evaluate;
pub use rundown::model::resistance::Davis;
pub use rundown::model::state::{LOCATION, SIZE, SPEED};
pub use rundown::model::track::{Curve, Gradient, Target, Track};
pub use rundown::model::train::{Train, TrainDescription};
pub use rundown::onboard::train_id::TrainId;
pub use rundown::tick::digest;
pub use rundown::tick::estimate::Estimate;
pub use rundown::tick::learning::LocationAndSpeed;
pub use rundown::tick::measurement::Measurement;
pub use rundown::tick::memory::Vehicle;
pub use rundown::uplink::{Command, Pace, Request};
pub use rundown_desk::{Description, Desk};
pub use rundown_truth::scenario::{Run, Scenario, drive_planned, simulate, simulate_planned};
pub use rundown_truth::sensors::Sensors;
