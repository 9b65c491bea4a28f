//! Two causes that together look like one: rivals that a search does not find, because it replaces one term at a time.

use crate::candidate::Naming;
use crate::candidates::separates;
use crate::data::rows::Row;
use crate::named::Named;
use rundown::model::effects::{DavisError, Effect, EffectKind};

/// Adds to what was named the causes that it may be in truth. `gain_told`: the effort column was put right by a gain.
pub fn confounded(all: &mut [Named], gain_told: bool, naming: &Naming<'_>) {
    let (have, odds) = (naming.have(), naming.context.config.certainty.confounded);
    for named in all {
        let rivals: &[EffectKind] = match &named.effect {
            // Beside another mass, or what else changes r(v), a wind is no single rival.
            Effect::DavisError(davis) => match (!have.both_directions && is_like_wind(davis, naming), gain_told) {
                (true, true) => &[EffectKind::SteadyWind, EffectKind::MassError],
                (true, false) => &[EffectKind::SteadyWind],
                (false, true) => &[EffectKind::MassError],
                (false, false) => &[],
            },
            // A climb that nobody has described: without efforts the power goes into it.
            Effect::PowerLimitSection(_) if naming.context.surroundings.is_level && !naming.measured => {
                &[EffectKind::GradientError]
            }
            _ => &[],
        };
        for rival in rivals {
            if !named.ambiguous_with.contains(rival) {
                named.rival(*rival, odds, separates(named.effect.kind(), *rival, have));
            }
        }
    }
}

/// A wind that blows would add as much at the usual speed: r2 ((v + w)² - v²).
fn is_like_wind(davis: &DavisError, naming: &Naming<'_>) -> bool {
    let speeds = || naming.rows.iter().map(|row: &Row| row.interval.mean_speed_mps());
    let speed_mps = speeds().sum::<f64>() / speeds().count().max(1) as f64;
    let extra = davis.dr0 + davis.dr1 * speed_mps + davis.dr2 * speed_mps * speed_mps;
    let air = speed_mps * speed_mps + extra / naming.context.believed.train().davis().r2;
    let wind_mps = air.max(0.0).sqrt() - speed_mps;
    air > 0.0 && wind_mps.abs() < naming.context.config.certainty.most_wind_mps
}
