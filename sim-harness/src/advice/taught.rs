//! What a run teaches of the resistance by itself.
//!
//! In: the estimates of a run. Out: the resistance at the speed of which it taught most, without what was known before.
//!
//! ```text
//! run  = prior + (posterior - prior) / K,   K = 1 - posterior's variance / prior's
//! ```

use crate::report::resistance::Resistance;
use rundown::filter::gaussian::Gaussian;
use rundown::model::direction::Direction;
use rundown::model::state::R0;
use rundown::tick::estimate::Estimate;
use rundown_check::figure::Figure;
use rundown_files::replay::ReplayedRun;

/// A run that taught less of its resistance says nothing by itself: what it says is multiplied by the inverse.
/// Judgement.
const LEAST_TAUGHT: f64 = 0.25;
/// One that taught more says much. Judgement.
const MUCH: f64 = 0.7;
/// Speeds that are asked, km/h: that of which a run taught most counts.
const ASKED_KMH: [f64; 5] = [40.0, 60.0, 80.0, 100.0, 120.0];

/// The last runs of a unit are asked whether it changed or is two: what was before has long been learned, and each
/// further run is another split.
const MOST_RUNS: usize = 128;

/// What a run teaches by itself.
#[derive(Debug)]
pub(super) struct Taught {
    pub(super) name: String,
    pub(super) unit: String,
    pub(super) direction: Direction,
    /// Which share of what was not known before it taught.
    pub(super) share: f64,
    /// Speed at which the run taught most, m/s ...
    pub(super) speed_mps: f64,
    /// ... and the resistance there.
    pub(super) r_n_per_kg: Figure,
}

/// The resistance of an estimate, as the train has it on this run.
fn davis(estimate: &Estimate) -> Gaussian<3> {
    let Gaussian { mean, covariance } = &estimate.belief;
    Gaussian {
        mean: mean.fixed_rows::<3>(R0).into_owned(),
        covariance: covariance.fixed_view::<3, 3>(R0, R0).into_owned(),
    }
}

impl Taught {
    /// `None`: too little.
    pub(super) fn of(run: &ReplayedRun) -> Option<Self> {
        let ends = [davis(run.estimates.first()?), davis(run.estimates.last()?)];
        let of = |kmh: f64| {
            let speed_mps = kmh / 3.6;
            let [prior, posterior] = ends.map(|belief| Resistance::at(&belief, speed_mps));
            let (prior, posterior) = (prior?, posterior?);
            let taught = 1.0 - (posterior.sd_n_per_kg / prior.sd_n_per_kg).powi(2);
            let value = prior.mean_n_per_kg + (posterior.mean_n_per_kg - prior.mean_n_per_kg) / taught;
            Some((taught, speed_mps, Figure { value, sd: posterior.sd_n_per_kg / taught.sqrt() }))
        };
        let taught = ASKED_KMH.into_iter().filter_map(of).filter(|(taught, ..)| *taught > LEAST_TAUGHT);
        let (share, speed_mps, r_n_per_kg) = taught.max_by(|a, b| a.0.total_cmp(&b.0))?;
        Some(Self {
            name: run.name.clone(),
            unit: run.unit.clone(),
            direction: run.direction,
            share,
            speed_mps,
            r_n_per_kg,
        })
    }

    /// It taught most of it, and says much by itself.
    pub(super) fn teaches_much(&self) -> bool {
        self.share > MUCH
    }

    /// Its resistance over that of a vehicle, less 1.
    pub(super) fn over(&self, vehicle: &Gaussian<3>) -> Option<Figure> {
        let r_n_per_kg = Resistance::at(vehicle, self.speed_mps)?.mean_n_per_kg;
        Some(Figure { value: self.r_n_per_kg.value / r_n_per_kg - 1.0, sd: self.r_n_per_kg.sd / r_n_per_kg })
    }
}

/// The last runs of a unit that are `asked`, in order, each with its resistance over that of the vehicle, less 1.
pub(super) fn last_of<'a>(
    unit: &str,
    runs: &'a [Taught],
    vehicle: &Gaussian<3>,
    asked: impl Fn(&Taught) -> bool,
) -> Vec<(&'a Taught, Figure)> {
    let of_unit = runs.iter().filter(|run| run.unit == unit && asked(run));
    let mut of_unit: Vec<(&Taught, Figure)> = of_unit.filter_map(|run| Some((run, run.over(vehicle)?))).collect();
    of_unit.drain(..of_unit.len().saturating_sub(MOST_RUNS));
    of_unit
}
