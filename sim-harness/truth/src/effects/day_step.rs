//! More resistance from a day on (a worn bearing); `from_share` of the period of the runs.

use super::*;

parameters!(DayStep { from_share: f64, drag_n_per_kg: f64 });

impl Law for DayStep {
    fn check(&self, expect: &Expect) -> Result<(), EffectError> {
        expect.within("from_share", self.from_share, 0.0, 1.0)
    }

    fn extra_n_per_kg(&self, _setting: &Setting, at: &Moment) -> f64 {
        if at.season >= self.from_share { self.drag_n_per_kg } else { 0.0 }
    }

    fn unknown_coordinate(&self) -> Option<&'static str> {
        Some("day")
    }
}
