//! What a vehicle's resistance is worth after the runs: how its coasts were foreseen, and whether its description can
//! be right.
//!
//! In: the runs as replayed, the description and what is believed of vehicles before any run. Out: notes, one line a
//! unit.

use crate::report::taught_mps;
use core::ops::Range;
use nalgebra::Vector3;
use rundown::estimator::Estimator;
use rundown::estimator::config::Mode;
use rundown::filter::gaussian::Gaussian;
use rundown::model::resistance::Davis;
use rundown::tick::foresight::Trust;
use rundown::tick::published::{LEAST_RISE, rises};
use rundown_check::gradients::{CONVERSIONS, converted};
use rundown_files::replay::ReplayedRun;
use rundown_wire::Learned;
use std::collections::BTreeMap;

/// A description this many prior standard deviations away is no description of this train.
const FAR: f64 = 4.0;
/// A conversion is worth a word if it comes so much nearer to what was learned than the description, which holds back
/// what is learned.
const NEARER: f64 = 0.6;
/// A description that is so far off at the speeds that taught, root mean square of the logarithm, and a conversion that
/// is no further than the second and this share of it: trains that never run fast do not get far from a description per
/// km/h, whose largest term is right.
const OTHER_UNITS: (f64, f64, f64) = (0.25, 0.1, 0.35);
/// A conversion is no more than this share as far off as the nearest plain multiple, for a train that has less
/// resistance than it is described to have is in no other units.
const THAN_A_MULTIPLE: f64 = 0.5;
/// No description is off by a larger factor but in other units.
const MOST_MULTIPLE: f64 = 4.0;
/// Speeds at which it is judged where nothing says which taught, m/s.
const USUAL_MPS: Range<f64> = 16.7..33.3;
/// Coasts that scatter so much more than expected are worth a word ...
const SCATTER: f64 = 1.5;
/// ... if there are this many.
const FEW_COASTS: f64 = 8.0;

/// An effort of this share of the resistance is one that a coast has not.
const POWERED_SHARE: f64 = 0.3;
/// Speeds this near to those of another are the same, m/s.
const SAME_SPEEDS_MPS: f64 = 4.0;

/// From this share on, what short hops taught is worth a word.
pub(super) const MANY_HOPS: f64 = 0.5;

/// A vehicle after a run.
#[derive(Debug)]
pub struct After {
    pub(super) davis: Gaussian<3>,
    pub(super) learned: Learned,
    trust: Trust,
    pub(super) hops_share: f64,
    hops_sd: f64,
    /// Speeds that the last run taught the resistance at, m/s.
    taught_mps: Range<f64>,
    /// The same of all runs; none where none did.
    pub(super) all_taught_mps: Option<Range<f64>>,
    /// Ticks that taught, and of these those with an effort.
    pub(super) ticks_taught: [usize; 2],
}

impl After {
    /// `before`: after the run before of the same vehicle.
    pub(super) fn of(run: &ReplayedRun, before: Option<Self>) -> Self {
        let own_mps = taught_mps(core::slice::from_ref(run));
        let [all, with_effort] = before.as_ref().map_or([0; 2], |before| before.ticks_taught);
        let [own, own_with_effort] = ticks_taught(run);
        let ticks_taught = [all + own, with_effort + own_with_effort];
        let all_mps = before.and_then(|before| before.all_taught_mps).into_iter().chain(own_mps.clone());
        let all_taught_mps = all_mps.reduce(|a, b| a.start.min(b.start)..a.end.max(b.end));
        let ReplayedRun { vehicle_after: davis, learned, trust, hops_share, hops_sd, .. } = *run;
        let taught_mps = own_mps.unwrap_or(USUAL_MPS);
        Self { davis, learned, trust, hops_share, hops_sd, taught_mps, all_taught_mps, ticks_taught }
    }

    /// Short hops taught most of it, by coasts of which most have efforts.
    pub(super) fn is_of_powered_coasts(&self) -> bool {
        self.hops_share >= MANY_HOPS && 2 * self.ticks_taught[1] > self.ticks_taught[0]
    }

    /// It was taught at the speeds that another was.
    pub(super) fn speaks_for(&self, other: &Self) -> bool {
        let both = self.all_taught_mps.as_ref().zip(other.all_taught_mps.as_ref());
        let is_same = |(own, all): (&Range<f64>, &Range<f64>)| {
            own.start <= all.start + SAME_SPEEDS_MPS && own.end >= all.end - SAME_SPEEDS_MPS
        };
        self.learned == Learned::Learned && both.is_some_and(is_same)
    }

    /// What is known of the units after their last runs.
    pub(super) fn add(units: &mut BTreeMap<String, Self>, run: &ReplayedRun) {
        let before = units.remove(&run.unit);
        units.insert(run.unit.clone(), Self::of(run, before));
    }
}

/// Ticks of a run that taught, and of these those with an effort worth the name.
fn ticks_taught(run: &ReplayedRun) -> [usize; 2] {
    let taught = run.estimates.iter().zip(&run.measurements).filter(|(estimate, _)| estimate.learning);
    taught.fold([0; 2], |[all, with_effort], (estimate, row)| {
        let resistance = estimate.davis().resistance_n_per_kg(estimate.belief.mean[1]);
        let has_effort = row.effort_n_per_kg.is_some_and(|effort| effort.abs() > POWERED_SHARE * resistance);
        [all + 1, with_effort + usize::from(has_effort)]
    })
}

/// Notes on the vehicles, each after its last run, by their units; of doubtful gradients only where nothing else says
/// why they are doubted (`gradients_are_said`).
pub(super) fn notes(
    estimator: &Estimator,
    vehicles: &BTreeMap<String, After>,
    gradients_are_said: bool,
) -> Vec<String> {
    let mut notes: Vec<String> = vehicles.iter().flat_map(|(unit, after)| of_vehicle(estimator, unit, after)).collect();
    let sd = estimator.config().track_doubt.gradient_sd_permille;
    if sd > 0.0 && !gradients_are_said {
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
            let efforts = if estimator.config().mode == Mode::Measured { "the efforts this train's, and " } else { "" };
            say(format!(
                "the description predicts coasts better than what was learned, which is not published; \
                 are {efforts}the gradients those of this line?"
            ))
        }
        Learned::OutOfBounds => say(format!(
            "the learned resistance is none of a train (less than half or more than twice the described one, or rising by less than {:.0} % \
                 from 20 to 80 km/h): a board publishes it cut off there; are train, gradients and units right{}?",
            100.0 * LEAST_RISE,
            if rises(&estimator.train().davis()) { "" } else { ", r1 and r2 of the description per m/s and (m/s)²" }
        )),
        _ => {}
    }
    if scatters(trust) {
        say(format!(
            "coasts scatter {:.1} times as much as expected: wind, gradients or the recorder are not as described, or \
             some coasts were braked a little; the interval of r is {:.1} times as wide for that",
            trust.inflation().sqrt(),
            (trust.inflation() * trust.doubt()).sqrt()
        ));
    }
    if after.learned == Learned::Learned && after.hops_share >= MANY_HOPS {
        say(format!(
            "learned on short hops, from coasts of 10 to 40 s, which may be off together: the interval of r(v) has ± {:.0} % \
             for that",
            200.0 * after.hops_sd
        ));
    }
    let away = deviations(estimator, &after.davis);
    let described = Off::of(&estimator.train().davis(), after);
    let nearest = Off::nearest(&estimator.train().davis(), after);
    if away > FAR {
        let hint = nearest.filter(|(_, off)| off.rms < NEARER * described.rms);
        let hint = hint.map_or_else(String::new, |(words, _)| format!("; nearest to it would be {words}"));
        say(format!(
            "the described resistance looks wrong: what was learned is {away:.0} standard deviations away from it, as trains differ from their descriptions{hint}"
        ));
    } else if let Some((words, _)) = nearest.filter(|(_, off)| off.may_be_units(&described)) {
        say(format!(
            "the described resistance may be in other units: at {:.0} km/h, the fastest speed that taught, {:.0} % of it were \
             learned, as {words} would have it",
            3.6 * after.taught_mps.end,
            100.0 * described.fastest
        ));
    }
    notes
}

/// Coasts scatter by more than wind and rounding make them.
pub(super) fn scatters(trust: &Trust) -> bool {
    trust.coasts >= FEW_COASTS && trust.inflation() > SCATTER
}

/// How far the vehicle is from its description, in standard deviations of vehicles.
fn deviations(estimator: &Estimator, found: &Gaussian<3>) -> f64 {
    let described = estimator.new_vehicle().davis();
    let apart = found.mean - described.mean;
    described.covariance.try_inverse().map_or(0.0, |weight| apart.dot(&(weight * apart)).max(0.0).sqrt())
}

/// How far what was learned is from a description at the speeds that taught.
#[derive(Clone, Copy)]
struct Off {
    /// Root mean square of the logarithm of the ratio.
    rms: f64,
    /// The same of the nearest multiple of it.
    of_multiple_rms: f64,
    /// Learned over described at the fastest speed.
    fastest: f64,
}

impl Off {
    /// From this description.
    fn of(described: &Davis, after: &After) -> Self {
        let Range { start, end } = after.taught_mps;
        let ratio = |v: f64| {
            let learned = Vector3::new(1.0, v, v * v).dot(&after.davis.mean);
            (learned / described.resistance_n_per_kg(v)).max(f64::MIN_POSITIVE)
        };
        let logarithms = [start, 0.5 * (start + end), end].map(|v| ratio(v).ln());
        let mean = |of: [f64; 3]| of.iter().sum::<f64>() / 3.0;
        let multiple = mean(logarithms).clamp(-MOST_MULTIPLE.ln(), MOST_MULTIPLE.ln());
        let rms = |beside: f64| mean(logarithms.map(|one| (one - beside).powi(2))).sqrt();
        Self { rms: rms(0.0), of_multiple_rms: rms(multiple), fastest: ratio(end) }
    }

    /// From the conversion of the description that is nearest to what was learned.
    fn nearest(described: &Davis, after: &After) -> Option<(&'static str, Self)> {
        let tried =
            CONVERSIONS.into_iter().map(|(words, factors)| (words, Self::of(&converted(described, factors), after)));
        tried.min_by(|a, b| a.1.rms.total_cmp(&b.1.rms))
    }

    /// This conversion is what was learned, and the description is not.
    fn may_be_units(&self, described: &Self) -> bool {
        let (far, near, share) = OTHER_UNITS;
        described.rms > far && self.rms < near.min(share * described.rms) && self.beats_multiples(described)
    }

    /// This conversion is nearer to what was learned than any plain multiple of the description.
    fn beats_multiples(&self, described: &Self) -> bool {
        self.rms < THAN_A_MULTIPLE * described.of_multiple_rms
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TRAM: Davis = Davis { r0: 0.021, r1: 3.4e-4, r2: 5.1e-5 };

    /// What is said of a tram's description, where the runs taught the true coefficients from 10 to 50 km/h.
    fn nearest(described: Davis) -> Option<&'static str> {
        nearest_of(TRAM, 10.0..50.0, described)
    }

    /// The same of any train and speeds, km/h.
    fn nearest_of(truth: Davis, taught_kmh: Range<f64>, described: Davis) -> Option<&'static str> {
        let after = After {
            davis: Gaussian::independent([truth.r0, truth.r1, truth.r2], [1e-3, 1e-4, 1e-5]),
            learned: Learned::Learned,
            trust: Trust::NONE,
            hops_share: 1.0,
            hops_sd: 0.05,
            taught_mps: taught_kmh.start / 3.6..taught_kmh.end / 3.6,
            all_taught_mps: None,
            ticks_taught: [0; 2],
        };
        let (words, off) = Off::nearest(&described, &after)?;
        off.may_be_units(&Off::of(&described, &after)).then_some(words)
    }

    #[test]
    fn a_tram_that_is_described_per_kmh_is_recognised_and_one_that_is_a_third_off_is_not() {
        let Davis { r0, r1, r2 } = TRAM;
        let per_kmh = nearest(Davis { r0, r1: r1 / 3.6, r2: r2 / 12.96 }).unwrap();
        assert!(per_kmh.starts_with("r1 and r2 per km/h"), "{per_kmh}");
        for factor in [0.7, 0.8, 1.0, 1.25, 1.4] {
            assert_eq!(nearest(Davis { r0: factor * r0, r1: factor * r1, r2: factor * r2 }), None, "{factor}");
            assert_eq!(nearest(Davis { r0: factor * r0, r1, r2: r2 / factor }), None, "{factor}");
        }
    }

    /// Between 50 and 80 km/h a freight train without air drag has 0.7 times the resistance, too.
    #[test]
    fn a_freight_train_that_is_described_by_a_multiple_is_in_no_other_units() {
        let freight = Davis { r0: 0.0110, r1: 1.41e-4, r2: 1.26e-5 };
        let of = |factors| nearest_of(freight, 50.0..80.0, converted(&freight, factors));
        for factor in [0.7, 1.3, 1.4, 1.5, 2.0] {
            assert_eq!(of([factor; 3]), None, "{factor}");
        }
        let named = [[1.0, 1.0, 100.0], [1.0, 1.0 / 3.6, 1.0 / 12.96], [1e3; 3]].map(of);
        assert!(named.iter().all(Option::is_some), "{named:?}");
    }
}
