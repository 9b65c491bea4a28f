//! What the estimator of the board makes of it: its innovations of the speed with the believed and with the repaired
//! model.
//!
//! Each hold-out run is replayed on its own, in the `gated` mode, from the described resistance on: so the innovations
//! are those of the model, not of what was learned in other runs.

use crate::refusal::Refusal;
use rundown::estimator::{Estimator, config::Config};
use rundown::filter::ukf::Reading;
use rundown::model::{effects::Effects, track::Track, train::Train};
use rundown_files::replay::{Tick, replay};
use rundown_files::{effect_file, recording::Recording, track_file::TrackFile, train_file::TrainFile};

/// Root mean squares, m/s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Innovations {
    /// With the believed model.
    pub before_mps: f64,
    /// With the repaired one.
    pub after_mps: f64,
    pub count: [u32; 2],
}

/// Of these runs, with the believed train and track and with the repaired ones. `None`: there are no innovations.
pub fn innovations(
    train: &Train,
    track: &Track,
    (repaired_train, repaired_track): &(TrainFile, TrackFile),
    recordings: &[&Recording],
) -> Result<Option<Innovations>, Refusal> {
    let estimator = Estimator::try_new(Config::default(), *train, track.clone())
        .map_err(|error| Refusal::Unread { text: error.to_string(), place: None })?;
    let acting = |run: &str| effect_file::effects(&repaired_track.effect, &repaired_train.effect, Some(run));
    let acting = recordings.iter().map(|recording| acting(&recording.name)).collect::<Result<Vec<_>, _>>()?;
    let of = |effects: &dyn Fn(usize) -> Effects| {
        let (mut sum, mut count) = (0.0, 0);
        for (i, recording) in recordings.iter().enumerate() {
            let estimator = estimator.clone().with_effects(effects(i));
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
    let before_and_after = of(&|_| Effects::NONE).zip(of(&|i| acting[i].clone()));
    Ok(before_and_after.map(|((before_mps, before), (after_mps, after))| Innovations {
        before_mps,
        after_mps,
        count: [before, after],
    }))
}
