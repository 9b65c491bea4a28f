//! What the train meets besides its Davis coefficients: seasons, gradients that are described wrongly, wind, load.

use super::variants;
use crate::study::Refused;
use crate::study::experiments::answer::VariantAxis;
use crate::study::experiments::metrics::{BIAS, COAST, INSIDE, POWER, RESISTANCE};
use crate::study::experiments::sweep::{Estimated, Own, Sweep};
use crate::study::experiments::variant::Variant;

const ARMS: &[Estimated] = &[Estimated::PAPER, Estimated::GATED, Estimated::MEASURED];

/// Section 5: "seasonal parameter variations, like the ones due to different temperature ..., and train wear".
pub fn seasons() -> Result<Sweep, Refused> {
    Ok(Sweep {
        variants: variants(&[
            ("none", "[dates]\ndays = 300.0"),
            (
                "wear: r0 +0.001 N/kg",
                "[dates]\ndays = 300.0\n[[effect]]\nname = \"seasonal_drift\"\ndr0_over_period = 1e-3",
            ),
            (
                "wear: r0 +0.002 N/kg",
                "[dates]\ndays = 300.0\n[[effect]]\nname = \"seasonal_drift\"\ndr0_over_period = 2e-3",
            ),
            (
                "cold: r0 +0.0001 N/kg per degree",
                "[dates]\ndays = 300.0\n[[effect]]\nname = \"temperature_resistance\"\ndr0_per_degC = -1e-4\nref_c = 10.0",
            ),
        ])?,
        axis: VariantAxis::Kinds("seasonal change"),
        own: Some(Own {
            axis: "growth of r0 over 300 days, N/kg",
            variant: |dr0| {
                let effect = "[dates]\ndays = 300.0\n[[effect]]\nname = \"seasonal_drift\"\ndr0_over_period = ";
                Variant::parse(format!("r0 {dr0:+} N/kg"), dr0, &format!("{effect}{dr0:?}"))
            },
        }),
        arms: ARMS,
        metrics: vec![RESISTANCE, BIAS, INSIDE],
    })
}

/// Section 2: a described gradient that is wrong "might be up to some extent mitigated by overfitting the running
/// resistance parameters".
pub fn gradient() -> Result<Sweep, Refused> {
    const WHERE_IT_COASTS: &str =
        "[[effect]]\nname = \"gradient_error\"\nfrom_m = 22000.0\nto_m = 28000.0\ndelta_permille = ";
    let cruise = "[[effect]]\nname = \"gradient_error\"\nfrom_m = 8000.0\nto_m = 14000.0\ndelta_permille = ";
    let fields = |section: &str, permille: &str| format!("{section}{permille}");
    Ok(Sweep {
        variants: variants(&[
            ("as described", ""),
            ("cruise, 0.5 \u{2030} off", &fields(cruise, "0.5")),
            ("cruise, 2 \u{2030} off", &fields(cruise, "2.0")),
            ("coast, 0.5 \u{2030} off", &fields(WHERE_IT_COASTS, "0.5")),
            ("coast, 2 \u{2030} off", &fields(WHERE_IT_COASTS, "2.0")),
        ])?,
        axis: VariantAxis::Kinds("where 6 km are steeper than described"),
        own: Some(Own {
            axis: "6 km in which trains coast are steeper by, permille",
            variant: |permille| {
                Variant::parse(
                    format!("coast, {permille} \u{2030} off"),
                    permille,
                    &format!("{WHERE_IT_COASTS}{permille:?}"),
                )
            },
        }),
        arms: ARMS,
        metrics: vec![RESISTANCE, BIAS, INSIDE, COAST],
    })
}

/// Section 2: the values "are significantly influenced by external factors like wind".
pub fn wind() -> Result<Sweep, Refused> {
    Ok(Sweep {
        variants: variants(&[
            ("still air", ""),
            ("sd 1 m/s between runs", "[wind]\nsd_mps = 1.0"),
            ("sd 2 m/s between runs", "[wind]\nsd_mps = 2.0"),
            ("sd 4 m/s between runs", "[wind]\nsd_mps = 4.0"),
            ("headwind of 4 m/s in all", "[[effect]]\nname = \"steady_wind\"\nwind_mps = 4.0"),
        ])?,
        axis: VariantAxis::Kinds("wind along the line"),
        own: Some(Own {
            axis: "wind along the line, sd between runs, m/s",
            variant: |mps| {
                Variant::parse(format!("sd {mps} m/s between runs"), mps, &format!("[wind]\nsd_mps = {mps:?}"))
            },
        }),
        arms: ARMS,
        metrics: vec![RESISTANCE, BIAS, INSIDE],
    })
}

/// Section 2: load varies at stations, and the fuel mass of a diesel decreases.
pub fn load() -> Result<Sweep, Refused> {
    Ok(Sweep {
        variants: variants(&[
            ("as described", ""),
            ("load, sd 2 %", "[load]\nsd = 0.02"),
            ("load, sd 5 %", "[load]\nsd = 0.05"),
            ("load, sd 10 %", "[load]\nsd = 0.10"),
            ("fuel used up: 4 % lighter", "[[effect]]\nname = \"mass_error\"\nrelative = -0.04"),
            ("10 % heavier than described", "[[effect]]\nname = \"mass_error\"\nrelative = 0.10"),
        ])?,
        axis: VariantAxis::Kinds("mass"),
        own: Some(Own {
            axis: "load, sd between runs, of the described mass",
            variant: |sd| Variant::parse(format!("load, sd {sd}"), sd, &format!("[load]\nsd = {sd:?}")),
        }),
        arms: ARMS,
        metrics: vec![RESISTANCE, BIAS, INSIDE, POWER],
    })
}
