//! Powering at full power on hold-out runs: the limits of the model against what the train did.

use crate::holdout::forward::Compared;
use crate::traction::pulls::{Pull, by_number};
use rundown::model::effects::Effects;
use rundown::model::train::Train;

/// Full power: the change of speed that limit and driver's share foresee, against the one that was.
pub fn powered(train: &Train, effects: &Effects, pulls: &[Pull], dt_s: f64) -> Vec<Compared> {
    let none = Effects::NONE;
    let limit = |effects: &Effects, pull: &Pull| {
        effects.limits(train, pull.location_m, pull.speed_mps).traction_n_per_kg(pull.speed_mps)
            / train.max_effort_n_per_kg(pull.speed_mps)
    };
    // What the driver asks for in this pull: what it shows where no limit of the effects holds it back. Held back all the way, it was some share between
    // what the train gives and everything.
    let asked = |parts: &[&Pull]| {
        let free = parts.iter().filter(|part| {
            let limit = limit(effects, part);
            limit > 0.99 && limit < 1.01 || part.ratio < limit - 2.0 * part.sd
        });
        let mut ratios: Vec<f64> = free.map(|part| part.ratio).collect();
        ratios.sort_by(f64::total_cmp);
        match ratios.get(ratios.len() * 4 / 5) {
            Some(ratio) => *ratio,
            None => {
                let given = parts.iter().map(|part| limit(effects, part));
                let given = given.fold(1.0, f64::min);
                given.max(0.5 * (1.0 + given))
            }
        }
    };
    let mut compared = Vec::new();
    for parts in by_number(pulls) {
        for by_power in [false, true] {
            let parts: Vec<&Pull> = parts.iter().filter(|p| p.by_power == by_power).collect();
            if parts.is_empty() {
                continue;
            }
            let asked = asked(&parts);
            compared.extend(parts.into_iter().map(|pull| {
                let most = train.max_effort_n_per_kg(pull.speed_mps);
                let error = |effects: &Effects| (asked.min(limit(effects, pull)) - pull.ratio) * most * dt_s;
                Compared {
                    run: pull.run,
                    time_s: 0.0,
                    since_s: 0.0,
                    location_m: pull.location_m,
                    measured_mps: pull.speed_mps,
                    before_mps: error(&none),
                    after_mps: error(effects),
                    floor: (pull.sd * most * dt_s).powi(2),
                }
            }));
        }
    }
    compared
}
