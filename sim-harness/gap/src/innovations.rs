//! What the estimator of the board makes of it: its innovations of the speed with the believed and with the repaired model.
//!
//! Each held-out run is replayed on its own, in the `gated` mode, from the described resistance on: so the innovations are those of the model, not of what was learned
//! in other runs.

use rundown::estimator::Estimator;
use rundown::filter::ukf::Reading;
use rundown::model::effects::Effects;
use rundown_files::recording::Recording;
use rundown_files::replay::{Tick, replay};

/// Root mean squares, m/s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Innovations {
    /// With the believed model.
    pub before_mps: f64,
    /// With the repaired one.
    pub after_mps: f64,
    /// How many of each, before and after.
    pub count: [u32; 2],
}

/// Of these runs. `estimator`: of the believed train and track; `believed` and `repaired` give the effects of a run. `None`: there are no innovations.
pub fn innovations(
    estimator: &Estimator,
    recordings: &[&Recording],
    believed: impl Fn(&str) -> Effects,
    repaired: impl Fn(&str) -> Effects,
) -> Option<Innovations> {
    let of = |effects: &dyn Fn(&str) -> Effects| {
        let (mut sum, mut count) = (0.0, 0);
        for recording in recordings {
            let estimator = estimator.clone().with_effects(effects(&recording.name));
            let tick = Tick::Period { seconds: 10.0 };
            let run = replay(&estimator, &mut estimator.new_vehicle(), recording, tick);
            for found in run.estimates.iter().filter_map(|e| e.innovation.as_ref()) {
                if found.readings[1] != Reading::Missing {
                    sum += found.value[1] * found.value[1];
                    count += 1;
                }
            }
        }
        (count > 0).then(|| ((sum / f64::from(count)).sqrt(), count))
    };
    let ((before_mps, before), (after_mps, after)) = (of(&believed)?, of(&repaired)?);
    Some(Innovations { before_mps, after_mps, count: [before, after] })
}
