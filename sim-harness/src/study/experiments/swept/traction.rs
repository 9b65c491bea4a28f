//! Whether a limit of power or effort is the train's, the supply's, the rail's or the driver's.

use super::variants;
use crate::study::Refused;
use crate::study::experiments::answer::VariantAxis;
use crate::study::experiments::metrics::{
    AT_THE_TOP, BRAKE, COAST, LARGEST_EFFORT, LARGEST_POWER, LOW_EFFORT, MEAN_POWER, POWER, POWER_SPREAD, RESISTANCE,
};
use crate::study::experiments::sweep::{Estimated, Own, Sweep};
use crate::study::experiments::variant::Variant;

const ARMS: &[Estimated] = &[Estimated::PAPER, Estimated::GATED];

/// Section 4.4: the relevance of nonhuman sources of variability "could be assessed by analyzing data from ATO-driven
/// trains".
pub fn automatic_operation() -> Result<Sweep, Refused> {
    let weak = "[[effect]]\nname = \"power_limit_section\"\nfrom_m = 0.0\nto_m = 8000.0\nfactor = 0.8\nruns = 0.4";
    let ato = "[driver]\nkind = \"ato\"\n";
    let loaded = "[load]\nsd = 0.05\n";
    Ok(Sweep {
        variants: variants(&[
            ("drivers", ""),
            ("drivers, supply weak in 40 % of runs", weak),
            ("ATO", ato),
            ("ATO, load sd 5 %", &format!("{ato}{loaded}")),
            ("ATO, supply weak in 40 % of runs", &format!("{ato}{weak}")),
        ])?,
        axis: VariantAxis::Kinds("who drives, and what varies besides"),
        own: Some(Own {
            axis: "ATO, load sd, of the described mass",
            variant: |sd| {
                let fields = format!("[driver]\nkind = \"ato\"\n[load]\nsd = {sd:?}");
                Variant::parse(format!("ATO, load sd {sd}"), sd, &fields)
            },
        }),
        arms: ARMS,
        metrics: vec![POWER_SPREAD, MEAN_POWER, RESISTANCE, COAST, BRAKE],
    })
}

/// Section 4.4: the transition of power "may be due to the presence of several power stations".
pub fn supply() -> Result<Sweep, Refused> {
    fn section(factor: f64) -> String {
        format!(
            "[[effect]]\nname = \"power_limit_section\"\nfrom_m = 0.0\nto_m = 4000.0\nfactor = {factor:?}\n[[effect]]\nname = \"traction_scale\"\nfactor = 1.2"
        )
    }
    Ok(Sweep {
        variants: variants(&[
            ("as strong as the motors", "[[effect]]\nname = \"traction_scale\"\nfactor = 1.2"),
            ("100 % of the described power", &section(1.0)),
            ("90 %", &section(0.9)),
            ("75 %", &section(0.75)),
        ])?,
        axis: VariantAxis::Kinds("supply of the first 4 km, motors of 120 % of the described power"),
        own: Some(Own {
            axis: "supply of the first 4 km, of the described power; motors of 1.2",
            variant: |factor| Variant::parse(format!("{factor} of the described power"), factor, &section(factor)),
        }),
        arms: ARMS,
        metrics: vec![LARGEST_POWER, MEAN_POWER, POWER, POWER_SPREAD],
    })
}

/// Section 3.3: "a lower adhesion condition may lead to wheel slip, lowering the effective applicable tractive effort".
pub fn adhesion() -> Result<Sweep, Refused> {
    fn slippery(factor: f64) -> String {
        format!("[[effect]]\nname = \"low_adhesion\"\nfactor = {factor:?}\nbelow_kmh = 60.0\nruns = 0.4")
    }
    let every_second = "[sensors]\nsampling_s = 1.0\n";
    Ok(Sweep {
        variants: variants(&[
            ("dry", ""),
            ("70 % on 40 % of the days", &slippery(0.7)),
            ("40 % on 40 % of the days", &slippery(0.4)),
            ("dry, every second", every_second),
            ("40 % on 40 % of the days, every second", &format!("{every_second}{}", slippery(0.4))),
        ])?,
        axis: VariantAxis::Kinds("largest effort below 60 km/h, of the described"),
        own: Some(Own {
            axis: "effort below 60 km/h on 40 % of the days, of the described",
            variant: |factor| Variant::parse(format!("{factor} on 40 % of the days"), factor, &slippery(factor)),
        }),
        arms: ARMS,
        metrics: vec![LARGEST_EFFORT, LOW_EFFORT],
    })
}

/// Section 3.3: what is observed "might not correspond to the real maximum capability of the engine".
pub fn capability() -> Result<Sweep, Refused> {
    fn limited(factor: f64, runs: f64) -> String {
        format!(
            "[[effect]]\nname = \"power_limit_section\"\nfrom_m = 0.0\nto_m = 32103.0\nfactor = {factor:?}\nruns = {runs:?}"
        )
    }
    Ok(Sweep {
        variants: variants(&[
            ("habit: drivers use 75 to 100 %", ""),
            ("capability: motors give 82 %", &limited(0.82, 1.0)),
            ("both: 82 % in half of the runs", &limited(0.82, 0.5)),
            ("ATO: all that there is", "[driver]\nkind = \"ato\""),
        ])?,
        axis: VariantAxis::Kinds("what limits the power"),
        own: Some(Own {
            axis: "what the motors give, of the described power",
            variant: |factor| Variant::parse(format!("motors give {factor}"), factor, &limited(factor, 1.0)),
        }),
        arms: ARMS,
        metrics: vec![LARGEST_POWER, AT_THE_TOP, MEAN_POWER, POWER_SPREAD],
    })
}
