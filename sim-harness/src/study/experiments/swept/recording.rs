//! What the recorder and the filter's settings change: a measured effort, the sampling, the process noise.

use super::variants;
use crate::study::Refused;
use crate::study::experiments::answer::Answer;
use crate::study::experiments::metrics::{BIAS, BRAKE, INSIDE, NEGATIVE, POWER, REGIMES, RESISTANCE, TRACKING};
use crate::study::experiments::plan::Plan;
use crate::study::experiments::sweep::{Estimated, Sweep};
use crate::study::experiments::variant::Variant;

/// Section 5: "measurements, which are required to obtain an accurate estimation".
pub fn measured_effort(plan: &Plan<'_>) -> Result<Answer, Refused> {
    let sweep = Sweep {
        variants: variants(&[
            ("exact", 1.0, ""),
            ("noise 0.01 N/kg", 2.0, "[effort]\nnoise_n_per_kg = 0.01"),
            ("gain 3 % too large", 3.0, "[effort]\ngain = 1.03"),
            ("1 s late", 4.0, "[effort]\nlag_s = 1.0"),
            ("momentary", 5.0, "[effort]\nmomentary = true"),
        ])?,
        axis: "effort column",
        arms: &[Estimated::PAPER, Estimated::GATED, Estimated::MEASURED],
        metrics: vec![RESISTANCE, BIAS, INSIDE, POWER],
    };
    sweep.answer(plan)
}

/// Section 4.2 and 5: smaller sampling times "might lead to more accurate estimates".
pub fn sampling(plan: &Plan<'_>) -> Result<Answer, Refused> {
    let every = |sampling_s: f64| {
        let fields = format!("[sensors]\nsampling_s = {sampling_s:?}");
        Variant::parse(format!("{sampling_s} s"), sampling_s, &fields)
    };
    let sweep = Sweep {
        variants: [1.0, 2.0, 5.0, 10.0, 20.0, 30.0, 60.0].into_iter().map(every).collect::<Result<_, _>>()?,
        axis: "sampling time, s",
        arms: &[Estimated::PAPER, Estimated::GATED, Estimated::MEASURED],
        metrics: vec![RESISTANCE, REGIMES, BRAKE, POWER],
    };
    sweep.answer(plan)
}

/// Section 4.2: no process noise, "due to the difficulty of quantifying it without using ground data".
pub fn process_noise(plan: &Plan<'_>) -> Result<Answer, Refused> {
    let of = |(place, sd_mps2): (usize, f64)| {
        let variant = Variant::parse(format!("{sd_mps2} m/s\u{b2}"), place as f64, "")?;
        Ok::<_, Refused>(variant.estimated_by(|config| config.paper.acceleration_noise_mps2 = sd_mps2))
    };
    let sweep = Sweep {
        variants: [0.0, 1e-4, 1e-3, 0.01, 0.1, 1.0].into_iter().enumerate().map(of).collect::<Result<_, _>>()?,
        axis: "standard deviation of the acceleration in Q",
        arms: &[Estimated::PAPER, Estimated::BACKWARD],
        metrics: vec![RESISTANCE, TRACKING, NEGATIVE, REGIMES],
    };
    sweep.answer(plan)
}
