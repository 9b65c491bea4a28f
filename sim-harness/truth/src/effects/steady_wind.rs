//! Headwind in the `up` direction in every run.

use super::*;

parameters!(SteadyWind { wind_mps: f64 });

impl Law for SteadyWind {
    fn alter(&self, world: &mut Altered) {
        world.headwind_mps += world.up_sign * self.wind_mps;
    }
}
