//! What the recorder and the filter's settings change: a measured effort, the sampling, the process noise.

use super::variants;
use crate::study::Refused;
use crate::study::experiments::answer::VariantAxis;
use crate::study::experiments::metrics::{BIAS, BRAKE, INSIDE, NEGATIVE, POWER, REGIMES, RESISTANCE, TRACKING};
use crate::study::experiments::sweep::{Estimated, Own, Sweep};
use crate::study::experiments::variant::Variant;

/// Section 5: "measurements, which are required to obtain an accurate estimation".
pub fn measured_effort() -> Result<Sweep, Refused> {
    Ok(Sweep {
        variants: variants(&[
            ("exact", ""),
            ("noise 0.01 N/kg", "[effort]\nnoise_n_per_kg = 0.01"),
            ("gain 3 % too large", "[effort]\ngain = 1.03"),
            ("1 s late", "[effort]\nlag_s = 1.0"),
            ("momentary", "[effort]\nmomentary = true"),
        ])?,
        axis: VariantAxis::Kinds("effort column"),
        own: Some(Own {
            axis: "white noise of the column, N/kg",
            variant: |noise| {
                Variant::parse(format!("noise {noise} N/kg"), noise, &format!("[effort]\nnoise_n_per_kg = {noise:?}"))
            },
        }),
        arms: &[Estimated::PAPER, Estimated::GATED, Estimated::MEASURED],
        metrics: vec![RESISTANCE, BIAS, INSIDE, POWER],
    })
}

/// Section 4.2 and 5: smaller sampling times "might lead to more accurate estimates".
pub fn sampling() -> Result<Sweep, Refused> {
    let axis = "sampling time, s";
    let every = |sampling_s: f64| {
        let fields = format!("[sensors]\nsampling_s = {sampling_s:?}");
        Variant::parse(format!("{sampling_s} s"), sampling_s, &fields)
    };
    Ok(Sweep {
        variants: [1.0, 2.0, 5.0, 10.0, 20.0, 30.0, 60.0].into_iter().map(every).collect::<Result<_, _>>()?,
        axis: VariantAxis::Values(axis),
        own: Some(Own { axis, variant: every }),
        arms: &[Estimated::PAPER, Estimated::GATED, Estimated::MEASURED],
        metrics: vec![RESISTANCE, REGIMES, BRAKE, POWER],
    })
}

/// Section 4.2: no process noise, "due to the difficulty of quantifying it without using ground data".
pub fn process_noise() -> Result<Sweep, Refused> {
    let of = |sd_mps2: f64| {
        let variant = Variant::parse(format!("{sd_mps2} m/s\u{b2}"), sd_mps2, "")?;
        Ok(variant.estimated_by(|config| config.paper.acceleration_noise_mps2 = sd_mps2))
    };
    let at = |(place, sd_mps2): (usize, f64)| Ok::<_, Refused>(Variant { x: 1.0 + place as f64, ..of(sd_mps2)? });
    Ok(Sweep {
        variants: [0.0, 1e-4, 1e-3, 0.01, 0.1, 1.0].into_iter().enumerate().map(at).collect::<Result<_, _>>()?,
        axis: VariantAxis::Kinds("standard deviation of the acceleration in Q"),
        own: Some(Own { axis: "standard deviation of the acceleration in Q, m/s\u{b2}", variant: of }),
        arms: &[Estimated::PAPER, Estimated::BACKWARD],
        metrics: vec![RESISTANCE, TRACKING, NEGATIVE, REGIMES],
    })
}
