//! What sensors do to the residuals: no effects of a train, and nothing that a board needs to know.

use crate::candidates::kit::*;

/// An effort that is shown too large by a share of it.
pub static EFFORT_GAIN: &dyn Candidate = &Sensor::EffortGain;
/// Speed read later than the effort: step of the effort over the interval's length; coefficient in s.
pub static DELAY: &dyn Candidate = &Sensor::Delay;
/// Location read late, beyond what was put right: the gradient of v seconds back less the one here, over 1 s.
pub static LATE_LOCATION: &dyn Candidate = &Sensor::LateLocation;

/// Half the distance over which the change of the gradient is taken, m.
const SLOPE_M: f64 = 15.0;

enum Sensor {
    EffortGain,
    Delay,
    LateLocation,
}

impl Candidate for Sensor {
    fn facts(&self) -> Facts {
        Facts {
            nature: Nature { may_be_large: true, ..Nature::default() },
            prior: Prior {
                least: 0.003,
                most: 0.03,
                shapes: &[],
                source: "Gain of the effort sensor less 1. Judgement: a sensor is off by about so much; what is more is another mass.",
            },
            ..Facts::default()
        }
    }

    fn name(&self) -> &'static str {
        match self {
            Self::EffortGain => "effort_gain",
            Self::Delay => "delay",
            Self::LateLocation => "late",
        }
    }

    /// Delay and late location are in every fit, and none to be found.
    fn families(&self, offer: &Offer<'_>) -> Vec<Family> {
        let gain = || Family::Shapes(vec![Term { of: EFFORT_GAIN, shape: Shape::Law }]);
        (matches!(self, Self::EffortGain) && offer.measured).then(gain).into_iter().collect()
    }

    fn columns(&self, _: &Shape, context: &Context<'_>, rows: &[Row]) -> Vec<Vec<f64>> {
        vec![match self {
            Self::EffortGain => along(context, rows, |_, row, _| row.effort_n_per_kg),
            Self::Delay => along(context, rows, |_, row, _| row.interval.effort_step_n_per_kg / row.interval.dt_s),
            Self::LateLocation => along(context, rows, |line, _, p| {
                let sign = line.direction.sign();
                let ahead = line.gradient_n_per_kg(p.location_m + sign * SLOPE_M);
                let behind = line.gradient_n_per_kg(p.location_m - sign * SLOPE_M);
                p.speed_mps * (ahead - behind) / (2.0 * SLOPE_M)
            }),
        }]
    }

    fn is_plausible(&self, size: &Size<'_>) -> bool {
        (size.least()..size.largest()).contains(&size.beta[0].abs())
    }
}
