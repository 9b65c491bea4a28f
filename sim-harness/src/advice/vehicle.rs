//! What a vehicle's resistance is worth after the runs: how its coasts were foreseen, and whether its description can be right.
//!
//! In: the runs as replayed, the description and what is believed of vehicles before any run. Out: notes, one line a unit.

use nalgebra::Vector3;
use rundown::estimator::Estimator;
use rundown::filter::gaussian::Gaussian;
use rundown::model::resistance::Davis;
use rundown::tick::foresight::Trust;
use rundown::tick::memory::SHORT_HOPS_SD;
use rundown_files::replay::ReplayedRun;
use rundown_wire::Learned;
use std::collections::BTreeMap;

/// A description this many prior standard deviations away is no description of this train.
const FAR: f64 = 4.0;
/// A conversion is worth a word if it comes so much nearer to what was learned than the description, which holds back what is learned.
const NEARER: f64 = 0.6;
/// Speeds at which it is judged, km/h: where trains coast.
const JUDGED_KMH: [f64; 3] = [60.0, 90.0, 120.0];
/// Coasts that scatter so much more than expected are worth a word ...
const SCATTER: f64 = 1.5;
/// ... if there are this many.
const FEW_COASTS: f64 = 8.0;

/// From this share on, what short hops taught is worth a word.
const MANY_HOPS: f64 = 0.5;

/// By what described coefficients have to be multiplied if they were written in other units.
const CONVERSIONS: [(&str, [f64; 3]); 6] = [
    ("r1 and r2 per km/h and (km/h)²: r1 x 3.6, r2 x 12.96", [1.0, 3.6, 12.96]),
    (
        "r1 and r2 multiplied by 3.6 and 12.96 although they were per m/s: r1 / 3.6, r2 / 12.96",
        [1.0, 1.0 / 3.6, 1.0 / 12.96],
    ),
    ("r2 a hundred times too large: r2 / 100", [1.0, 1.0, 0.01]),
    ("r2 a hundred times too small: r2 x 100", [1.0, 1.0, 100.0]),
    ("N/t in place of N/kg: all / 1000", [1e-3; 3]),
    ("kN/kg in place of N/kg: all x 1000", [1e3; 3]),
];

/// A vehicle after a run.
#[derive(Debug)]
pub struct After {
    pub(super) davis: Gaussian<3>,
    pub(super) learned: Learned,
    trust: Trust,
    hops_share: f64,
}

impl After {
    pub(super) fn of(run: &ReplayedRun) -> Self {
        Self { davis: run.vehicle_after, learned: run.learned, trust: run.trust, hops_share: run.hops_share }
    }
}

/// Notes on the vehicles, each after its last run, by their units; of doubtful gradients only where they are not said to look wrong (`look_wrong`).
pub(super) fn notes(estimator: &Estimator, vehicles: &BTreeMap<String, After>, look_wrong: bool) -> Vec<String> {
    let mut notes: Vec<String> = vehicles.iter().flat_map(|(unit, after)| of_vehicle(estimator, unit, after)).collect();
    let sd = estimator.config().track_doubt.gradient_sd_permille;
    if sd > 0.0 && !look_wrong {
        notes.push(format!(
            "track: gradients are taken to be off by {sd} permille (standard deviation), so the resistance is learned less surely; \
             describe the gradients, or write gradient_sd_permille = 0 for a line that is flat"
        ));
    }
    notes
}

/// A unit in a sentence; where no index names one, all runs are of one vehicle.
pub fn named(unit: &str) -> String {
    if unit.is_empty() { "the vehicle".to_owned() } else { format!("unit {unit}") }
}

fn of_vehicle(estimator: &Estimator, unit: &str, after: &After) -> Vec<String> {
    let mut notes = Vec::new();
    let mut say = |text: String| notes.push(format!("{}: {text}", named(unit)));
    let trust = &after.trust;
    match after.learned {
        Learned::PredictsWorse => {
            say("the description foresees coasts better than what was learned, which is not published; \
             are the gradients those of this line?"
                .to_owned())
        }
        Learned::OutOfBounds => {
            say("the learned resistance is none of a train (less than half or more than twice the described one, or \
             falling with speed): a board publishes it cut off there; are train, gradients and units right?"
                .to_owned())
        }
        _ => {}
    }
    if trust.coasts >= FEW_COASTS && trust.inflation() > SCATTER {
        say(format!(
            "coasts scatter {:.1} times as much as expected: wind, gradients or the recorder are not as described, or \
             some coasts were braked a little; the interval of r is {:.1} times as wide for that",
            trust.inflation().sqrt(),
            (trust.inflation() * trust.doubt()).sqrt()
        ));
    }
    if after.learned == Learned::Learned && after.hops_share >= MANY_HOPS {
        say(format!(
            "learned on short hops, from coasts of 10 to 40 s, which are off by several per cent together: the interval of r(v) \
             has ± {:.0} % for that, however many runs there are",
            200.0 * SHORT_HOPS_SD * after.hops_share
        ));
    }
    let away = deviations(estimator, &after.davis);
    if away > FAR {
        let conversion = conversion(&estimator.train().davis(), &after.davis);
        let hint = conversion.map_or_else(String::new, |words| format!("; nearest to it would be {words}"));
        say(format!(
            "the described resistance looks wrong: what was learned is {away:.0} standard deviations of trains away from it{hint}"
        ));
    }
    notes
}

/// How far the vehicle is from its description, in standard deviations of vehicles.
fn deviations(estimator: &Estimator, found: &Gaussian<3>) -> f64 {
    let described = estimator.new_vehicle().davis();
    let apart = found.mean - described.mean;
    described.covariance.try_inverse().map_or(0.0, |weight| apart.dot(&(weight * apart)).max(0.0).sqrt())
}

/// The conversion of the description that is nearest to what was learned, if it is much nearer than the description itself.
fn conversion(described: &Davis, found: &Gaussian<3>) -> Option<&'static str> {
    let off = |factors: [f64; 3]| {
        let at = |kmh: f64| {
            let v = kmh / 3.6;
            let converted = described.r0 * factors[0] + v * (described.r1 * factors[1] + v * described.r2 * factors[2]);
            let ratio = Vector3::new(1.0, v, v * v).dot(&found.mean) / converted;
            ratio.max(f64::MIN_POSITIVE).ln().powi(2)
        };
        JUDGED_KMH.map(at).into_iter().sum::<f64>().sqrt()
    };
    let tried = CONVERSIONS.into_iter().map(|(words, factors)| (words, off(factors)));
    let (words, nearest) = tried.min_by(|a, b| a.1.total_cmp(&b.1))?;
    (nearest < NEARER * off([1.0; 3])).then_some(words)
}
