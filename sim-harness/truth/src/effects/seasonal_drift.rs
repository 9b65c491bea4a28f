//! r0 changes linearly from 0 at the first run to this at the last.

use super::*;

parameters!(SeasonalDrift { dr0_over_period: f64 });

impl Law for SeasonalDrift {
    fn extra_n_per_kg(&self, _setting: &Setting, at: &Moment) -> f64 {
        self.dr0_over_period * at.season
    }
}
