//! Other trains: those of the accuracy bench, and a diesel whose lever has notches.

use crate::accuracy_bench::fleets;
use crate::study::Refused;
use crate::study::experiments::answer::VariantAxis;
use crate::study::experiments::metrics::{INSIDE, POWER, POWER_SPREAD, REGIMES, RESISTANCE};
use crate::study::experiments::sweep::{Estimated, Sweep};
use crate::study::experiments::variant::Variant;

/// Of the accuracy bench, from slow to fast.
const FLEETS: [&str; 5] = ["tram", "metro", "suburban", "freight", "high-speed"];
/// A lever as diesel locomotives have it.
const NOTCHES: u8 = 8;

/// Section 5: "different types of trains: from high speed trains to light rail and metro".
pub fn other_trains() -> Result<Sweep, Refused> {
    let all = fleets::all();
    let mut variants = vec![Variant::parse("intercity", 0.0, "")?];
    for (place, name) in FLEETS.into_iter().enumerate() {
        let fleet = all.iter().find(|fleet| fleet.name == name).ok_or("a fleet of the bench has another name")?;
        variants.push(Variant::of_fleet(1.0 + place as f64, fleet)?);
    }
    let diesel = Variant::parse("diesel, 8 notches", 6.0, "")?;
    variants.push(diesel.driven_by(|scenario| scenario.notches = NOTCHES));
    let arms = &[Estimated::PAPER, Estimated::GATED, Estimated::MEASURED];
    Ok(Sweep {
        variants,
        axis: VariantAxis::Kinds("train"),
        own: None,
        arms,
        metrics: vec![RESISTANCE, INSIDE, REGIMES, POWER],
    })
}

/// Section 3.3: with a diesel "the maximum tractive power is not unique, since each engine notch can apply a different"
/// one.
pub fn diesel() -> Result<Sweep, Refused> {
    let of = |(place, notches): (usize, u8)| {
        let name = if notches == 0 { "without steps".to_owned() } else { format!("{notches} notches") };
        let variant = Variant::parse(name, place as f64, "")?;
        Ok::<_, Refused>(variant.driven_by(|scenario| scenario.notches = notches))
    };
    let variants = [0, 16, 8, 4].into_iter().enumerate().map(of).collect::<Result<_, _>>()?;
    let arms = &[Estimated::PAPER, Estimated::GATED, Estimated::MEASURED];
    Ok(Sweep {
        variants,
        axis: VariantAxis::Kinds("lever"),
        own: None,
        arms,
        metrics: vec![POWER, POWER_SPREAD, RESISTANCE, REGIMES],
    })
}
