//! When a prediction is published again: with hysteresis.

use super::{CoastAhead, CoastConfig, Outcome};
use crate::extremes::Extremes;
use crate::plain::plain;

/// Least worth of a metre that is divided by, (m/s)/m.
const LEAST_SPEED_PER_M: crate::Real = 1e-6;

/// What was published last.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Steady {
    said: Option<CoastAhead>,
}

plain! {
    struct Steady { said }
}

impl Steady {
    /// Nothing was published yet.
    pub const NONE: Self = Self { said: None };

    /// True: `found` is another prediction than the published one, and is now the published one.
    ///
    /// ```
    /// use rundown::coast_ahead::{Arrival, CoastAhead, CoastConfig, Outcome, Steady};
    /// use rundown::model::point::Point;
    ///
    /// let arrives = |speed_mps| CoastAhead {
    ///     from: Point { time_s: 0.0, location_m: 0.0, speed_mps: 38.0 },
    ///     target: None,
    ///     outcome: Outcome::Arrives(Arrival { speed_mps, speed_sd_mps: 0.3, time_s: 300.0, time_sd_s: 2.0, speed_per_m: 0.002 }),
    /// };
    /// let (config, mut steady) = (CoastConfig::default(), Steady::NONE);
    /// assert!(steady.is_news(&config, &arrives(25.0)));
    /// assert!(!steady.is_news(&config, &arrives(25.2)), "100 m of the coasting point");
    /// assert!(steady.is_news(&config, &arrives(25.4)), "200 m");
    /// ```
    pub fn is_news(&mut self, config: &CoastConfig, found: &CoastAhead) -> bool {
        let same =
            self.said.is_some_and(|said| said.target == found.target && same(config, &said.outcome, &found.outcome));
        if !same {
            self.said = Some(*found);
        }
        !same
    }

    /// What was published last.
    pub fn said(&self) -> Option<&CoastAhead> {
        self.said.as_ref()
    }
}

fn same(config: &CoastConfig, said: &Outcome, found: &Outcome) -> bool {
    match (said, found) {
        (Outcome::Arrives(said), Outcome::Arrives(found)) => {
            let faster_mps = (found.speed_mps - said.speed_mps).abs();
            let moved_m = faster_mps / found.speed_per_m.at_least(LEAST_SPEED_PER_M);
            moved_m <= config.coasting_point_m && (found.time_s - said.time_s).abs() <= config.arrival_s
        }
        (Outcome::Stops { location_m: said_m, .. }, Outcome::Stops { location_m: found_m, .. }) => {
            (found_m - said_m).abs() <= config.coasting_point_m
        }
        (Outcome::Unknown, Outcome::Unknown)
        | (Outcome::NoTarget, Outcome::NoTarget)
        | (Outcome::MayStop, Outcome::MayStop) => true,
        (Outcome::Unknown | Outcome::NoTarget | Outcome::Arrives(_) | Outcome::MayStop | Outcome::Stops { .. }, _) => {
            false
        }
    }
}
