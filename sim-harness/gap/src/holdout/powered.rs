//! Powering at full power on hold-out runs: the limits of the model against what the train did.

use crate::config::HoldoutConfig;
use crate::holdout::forward::Compared;
use crate::traction::powering::{SteadyPower, by_number};
use rundown::model::{effects::Effects, train::Train};
use rundown_files::statistics::upper_quantile;

/// Full power: the change of speed that limit and driver's share foresee, against the one that was.
pub fn powered(
    train: &Train,
    effects: &Effects,
    powering: &[SteadyPower],
    dt_s: f64,
    config: &HoldoutConfig,
) -> Vec<Compared> {
    let none = Effects::NONE;
    let limit = |effects: &Effects, power: &SteadyPower| {
        effects.limits(train, power.location_m, power.speed_mps).traction_n_per_kg(power.speed_mps)
            / train.max_effort_n_per_kg(power.speed_mps)
    };
    // What the driver demands in this powering phase: what it shows where no limit of the effects holds it back. Held
    // back throughout, it was some share between what the train gives and everything.
    let demand = |parts: &[&SteadyPower]| {
        let free = parts.iter().filter(|part| {
            let limit = limit(effects, part);
            let described = 1.0 - config.free_share < limit && limit < 1.0 + config.free_share;
            described || part.ratio < limit - config.free_sd * part.sd
        });
        upper_quantile(free.map(|part| part.ratio), 0.8).unwrap_or_else(|| {
            let given = parts.iter().map(|part| limit(effects, part));
            0.5 * (1.0 + given.fold(1.0, f64::min))
        })
    };
    let mut compared = Vec::new();
    for parts in by_number(powering) {
        for by_power in [false, true] {
            let parts: Vec<&SteadyPower> = parts.iter().filter(|p| p.by_power == by_power).collect();
            if parts.is_empty() {
                continue;
            }
            let demand = demand(&parts);
            compared.extend(parts.into_iter().map(|power| {
                let most = train.max_effort_n_per_kg(power.speed_mps);
                let error = |effects: &Effects| (demand.min(limit(effects, power)) - power.ratio) * most * dt_s;
                Compared {
                    run: power.run,
                    time_s: 0.0,
                    since_s: 0.0,
                    location_m: power.location_m,
                    measured_mps: power.speed_mps,
                    before_mps: error(&none),
                    after_mps: error(effects),
                    floor: (power.sd * most * dt_s).powi(2),
                    variance: (power.sd * most * dt_s).powi(2),
                }
            }));
        }
    }
    compared
}
