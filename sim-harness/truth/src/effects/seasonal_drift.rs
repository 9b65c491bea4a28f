//! r0 changes linearly from 0 at the first run to this at the last.

use super::{EffectError, Expect, Law, Moment, Setting};
use serde::{Deserialize, Serialize};

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SeasonalDrift {
    pub dr0_over_period: f64,
}

impl Law for SeasonalDrift {
    fn check(&self, expect: &Expect) -> Result<(), EffectError> {
        expect.finite("dr0_over_period", self.dr0_over_period)
    }

    fn extra_n_per_kg(&self, _setting: &Setting, at: &Moment) -> f64 {
        self.dr0_over_period * at.season
    }
}
