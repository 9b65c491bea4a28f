//! Do the efforts of the measured mode teach what the coasts of the same runs do?
//!
//! In: the first runs of each unit, replayed once more in the gated mode; the vehicles after all runs. Out: a note for
//! each unit whose efforts say something else; and how well the coasts of each run are foreseen by what efforts taught
//! before it.
//!
//! Nothing else looks at an effort column as a whole: a lever that goes on and off between momentary readings, efforts
//! that are cut off or frozen, and a brake that is not in the column each explain the speeds with another resistance,
//! and consistently so. A coast needs no column.

use super::before_brakes::withhold_if_unknown;
use super::vehicle::{After, named, scatters};
use super::with_efforts::CoastsOf;
use crate::report::resistance::Resistance;
use nalgebra::Matrix3;
use rayon::prelude::*;
use rundown::estimator::Estimator;
use rundown::estimator::config::{Config, Mode};
use rundown::filter::gaussian::Gaussian;
use rundown::model::resistance::Davis;
use rundown::tick::foresight::Trust;
use rundown::tick::published::WORSE_BY;
use rundown_check::figure::HALF_95;
use rundown_files::recording::Recording;
use rundown_files::replay::{self, ReplayedRun, Tick, replay_units_by};
use rundown_wire::Learned;
use std::borrow::Cow;
use std::collections::{BTreeMap, HashMap};
use std::ops::Range;

/// So many runs of a unit are replayed twice: what they teach is sure to a few per cent.
const RUNS: usize = 20;
/// A mean effort beyond this share of the described resistance, at this speed, km/h, is one that a coast has not.
const EFFORT_SHARE: f64 = 0.05;
const EFFORT_KMH: f64 = 40.0;
/// Speeds at which both are compared, km/h, and at the ends of those that taught both.
const COMPARED_KMH: [f64; 4] = [40.0, 60.0, 90.0, 120.0];
/// Where coasts are predicted, m/s.
const COASTS_MPS: Range<f64> = 16.0..34.0;
/// So many standard deviations of both apart is no chance ...
const SURE: f64 = 3.0;
/// ... and so large a share of the resistance is worth a word.
const LEAST_SHARE: f64 = 0.04;

/// The same model in the mode that learns from coasts.
pub fn gated(estimator: &Estimator) -> Option<Estimator> {
    let config = Config { mode: Mode::Gated, ..*estimator.config() };
    let gated = Estimator::try_new(config, *estimator.train(), estimator.track().clone()).ok()?;
    Some(gated.with_effects(estimator.effects().clone()))
}

/// What coasts of a unit teach, and how many of them have efforts beside them.
#[derive(Debug)]
pub(super) struct OfCoasts {
    pub(super) after: After,
    pub(super) all: usize,
    pub(super) with_efforts: usize,
    /// Those with efforts taught, too, for the others teach too little.
    pub(super) by_all: bool,
}

impl OfCoasts {
    fn advice(&self) -> String {
        if self.by_all && 2 * self.with_efforts > self.all {
            let Self { all, with_efforts, .. } = self;
            format!("the column has efforts beside {with_efforts} of these {all}: if it is right, they are no coasts")
        } else {
            "--mode gated learns from coasts alone".to_owned()
        }
    }
}

/// What the coasts of each unit teach: those beside which the column has no effort, where these teach enough.
pub(super) fn taught(gated: &Estimator, recordings: &[Recording], tick: Tick) -> BTreeMap<String, OfCoasts> {
    let mut of_unit: HashMap<&str, usize> = HashMap::new();
    let mut first: Vec<Cow<Recording>> = Vec::new();
    for recording in recordings {
        let count = of_unit.entry(&recording.unit).or_default();
        *count += 1;
        if *count <= RUNS {
            first.push(Cow::Borrowed(recording));
        }
    }
    let replayed = |recordings: &[Cow<Recording>]| {
        let runs = replay_units_by(&|_| gated, recordings, tick, &mut HashMap::new(), || ());
        let mut units = BTreeMap::new();
        runs.iter().for_each(|run| After::add(&mut units, run));
        (runs, units)
    };
    let (runs, by_all) = replayed(&first);
    let most = most_effort(gated);
    let coasts: Vec<CoastsOf> = runs.iter().zip(&first).map(|(run, of)| CoastsOf::found(run, &of.rows, most)).collect();
    let mut free = BTreeMap::new();
    if coasts.iter().any(|of_run| of_run.with_efforts() > 0) {
        for (recording, of_run) in first.iter_mut().zip(&coasts) {
            if let Some(left) = of_run.left_of(recording) {
                *recording = Cow::Owned(left);
            }
        }
        free = replayed(&first).1;
    }
    let found = by_all.into_iter().map(|(unit, after)| {
        let of_unit = || runs.iter().zip(&coasts).filter(|(run, _)| run.unit == unit).map(|(_, of_run)| of_run);
        let free = free.remove(&unit).filter(|free| free.speaks_for(&after));
        let with_efforts = of_unit().map(CoastsOf::with_efforts).sum();
        let all = of_unit().map(|of_run| of_run.all).sum();
        let found = OfCoasts { all, with_efforts, by_all: free.is_none(), after: free.unwrap_or(after) };
        (unit, found)
    });
    found.collect()
}

/// The largest mean effort of a coast, N/kg.
fn most_effort(gated: &Estimator) -> f64 {
    EFFORT_SHARE * gated.train().davis().resistance_n_per_kg(EFFORT_KMH / 3.6)
}

/// Says how coasts are foreseen by what efforts taught before them. What foresees them worse than the description, and
/// excludes it, is not published. `trusts`: by unit, by the runs before. Out: by how much the coasts widen what each
/// run began with, and what it taught.
pub(super) fn foresee(
    gated: &Estimator,
    recordings: &[Recording],
    tick: Tick,
    runs: &mut [ReplayedRun],
    trusts: &mut HashMap<String, Trust>,
) -> Vec<[f64; 2]> {
    let most = most_effort(gated);
    let foreseen = runs.par_iter().zip(recordings).map(|(run, recording)| {
        let of = |recording: &Recording| replay::replay(gated, &mut run.began_with.clone(), recording, tick);
        let all = of(recording);
        let coasts = CoastsOf::found(&all, &recording.rows, most);
        let free = coasts.left_of(recording).map(|left| of(&left).summary.foresight);
        (coasts, all.summary.foresight, free)
    });
    let foreseen: Vec<_> = foreseen.collect();
    let mut of_units: HashMap<String, [usize; 2]> = HashMap::new();
    for (run, (coasts, ..)) in runs.iter().zip(&foreseen) {
        let [all, with_efforts] = of_units.entry(run.unit.clone()).or_default();
        (*all, *with_efforts) = (*all + coasts.all, *with_efforts + coasts.with_efforts());
    }
    for (run, (_, all, free)) in runs.iter_mut().zip(foreseen) {
        let [coasts, with_efforts] = of_units[&run.unit];
        // Where most have efforts the column may be wrong.
        run.summary.foresight = free.filter(|_| 2 * with_efforts <= coasts).unwrap_or(all);
    }
    let Davis { r0, r1, r2 } = gated.train().davis();
    let described = Gaussian::independent([r0, r1, r2], [f64::EPSILON; 3]);
    let of_run = |run: &mut ReplayedRun| {
        let trust = trusts.entry(run.unit.clone()).or_insert(Trust::NONE);
        let before = beyond(trust, run.began_with.trust());
        trust.add(&run.summary.foresight.trust);
        let after = beyond(trust, &run.trust);
        if after > 1.0 {
            run.trust = *trust;
        }
        let is_excluded = || apart(&run.vehicle_after, &described, COASTS_MPS).is_some();
        if run.learned == Learned::Learned && trust.worse_by() > WORSE_BY && is_excluded() {
            run.learned = Learned::PredictsWorse;
        }
        [before, after]
    };
    runs.iter_mut().map(of_run).collect()
}

/// Variance of what efforts taught over what it has, where coasts scatter around it: as what coasts taught is doubted
/// in the gated mode. `own`: what the vehicle has for the coasts of short hops that taught it.
fn beyond(trust: &Trust, own: &Trust) -> f64 {
    let times = |trust: &Trust| trust.inflation() * trust.doubt();
    if scatters(trust) { (times(trust) / times(own)).max(1.0) } else { 1.0 }
}

/// What filters say of the vehicle before and after a run, and of the run, before anything else doubts it.
#[derive(Debug)]
pub struct ByFilters([Matrix3<f64>; 3]);

impl ByFilters {
    pub fn of(run: &ReplayedRun) -> Self {
        Self([run.vehicle_before, run.vehicle_after, run.summary.run_davis].map(|davis| davis.covariance))
    }

    /// Widens it by the scatter of the coasts, `times` before and after the run, beside what else doubts it.
    pub fn widen(&self, estimator: &Estimator, times: [f64; 2], run: &mut ReplayedRun) {
        let [before, after] = times.map(|times| times - 1.0);
        let doubted = [&mut run.vehicle_before, &mut run.vehicle_after, &mut run.summary.run_davis];
        for (davis, (own, more)) in doubted.into_iter().zip(self.0.iter().zip([before, after, after])) {
            davis.covariance += own * more;
        }
        withhold_if_unknown(estimator, run);
    }
}

/// Does not publish what runs end with that coasts contradict, or that coasts of short hops taught which have efforts.
pub(super) fn withhold(
    vehicles: &BTreeMap<String, After>,
    coasts: &BTreeMap<String, OfCoasts>,
    runs: &mut [ReplayedRun],
) {
    for run in runs.iter_mut().filter(|run| run.learned == Learned::Learned) {
        if vehicles.get(&run.unit).is_some_and(After::is_of_powered_coasts) {
            run.learned = Learned::NotYet;
        }
        let Some([efforts, coasts]) = both(&run.unit, vehicles, coasts) else { continue };
        if both_mps(efforts, coasts).and_then(|mps| apart(&run.vehicle_after, &coasts.davis, mps)).is_some() {
            run.learned = Learned::NotYet;
        }
    }
}

/// What efforts and coasts of a unit taught, where both did.
fn both<'a>(
    unit: &str,
    vehicles: &'a BTreeMap<String, After>,
    coasts: &'a BTreeMap<String, OfCoasts>,
) -> Option<[&'a After; 2]> {
    let [efforts, coasts] = [vehicles.get(unit)?, &coasts.get(unit)?.after];
    (efforts.learned != Learned::NotYet && coasts.learned == Learned::Learned).then_some([efforts, coasts])
}

/// The speeds that taught both, m/s: beyond what taught it a resistance is the description's.
fn both_mps(efforts: &After, coasts: &After) -> Option<Range<f64>> {
    let by_both = efforts.all_taught_mps.as_ref().zip(coasts.all_taught_mps.as_ref());
    by_both.map(|(a, b)| a.start.max(b.start)..a.end.min(b.end))
}

/// The units whose efforts teach another resistance.
pub(super) fn notes(vehicles: &BTreeMap<String, After>, coasts: &BTreeMap<String, OfCoasts>) -> Vec<String> {
    let of_unit = |(unit, of_coasts): (&String, &OfCoasts)| {
        if let Some(After { ticks_taught: [all, with_effort], .. }) =
            vehicles.get(unit).filter(|after| after.is_of_powered_coasts())
        {
            return Some(format!(
                "{}: short hops teach by coasts, and beside {with_effort} of {all} rows of what taught as such the column has \
                 efforts: r is not published. Speeds that are held by a little power look so, and a column whose zero is off",
                named(unit)
            ));
        }
        let [efforts, coasts] = both(unit, vehicles, coasts)?;
        let Apart { kmh, efforts, coasts } = apart(&efforts.davis, &coasts.davis, both_mps(efforts, coasts)?)?;
        let said = |r: Resistance| format!("{:.4} ± {:.4} N/kg", r.mean_n_per_kg, HALF_95 * r.sd_n_per_kg);
        Some(format!(
            "{}: its efforts teach r({kmh:.0} km/h) = {}, the coasts of its first runs {}: one of both is wrong, and r is \
             not published. Efforts that are cut off or frozen, or read between the strokes of a lever, and brakes that drag \
             look so, and coasts with a little power or brake in them; {}",
            named(unit),
            said(efforts),
            said(coasts),
            of_coasts.advice()
        ))
    };
    coasts.iter().filter_map(of_unit).collect()
}

/// Resistances at a speed.
struct Apart {
    kmh: f64,
    efforts: Resistance,
    coasts: Resistance,
}

/// Where both differ most of the speeds that taught both, m/s, if that is no chance.
fn apart(efforts: &Gaussian<3>, coasts: &Gaussian<3>, both_mps: Range<f64>) -> Option<Apart> {
    let of = |kmh: f64| {
        let at = |davis| Resistance::at(davis, kmh / 3.6);
        Some(Apart { kmh, efforts: at(efforts)?, coasts: at(coasts)? })
    };
    let away = |Apart { efforts, coasts, .. }: &Apart| {
        (efforts.mean_n_per_kg - coasts.mean_n_per_kg).abs() / efforts.sd_n_per_kg.hypot(coasts.sd_n_per_kg)
    };
    let ends_kmh = [3.6 * both_mps.start, 3.6 * both_mps.end];
    let compared_kmh = COMPARED_KMH.into_iter().filter(|kmh| (ends_kmh[0]..=ends_kmh[1]).contains(kmh));
    let ends_kmh = ends_kmh.into_iter().filter(|_| !both_mps.is_empty());
    let most = compared_kmh.chain(ends_kmh).filter_map(of).max_by(|a, b| away(a).total_cmp(&away(b)))?;
    let share = (most.efforts.mean_n_per_kg / most.coasts.mean_n_per_kg - 1.0).abs();
    (away(&most) > SURE && share > LEAST_SHARE).then_some(most)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::advice::tests::{estimator, replayed};

    #[test]
    fn resistances_are_apart_beyond_chance_and_by_a_share_that_counts() {
        let davis =
            |scale: f64, sd: f64| Gaussian::independent([0.01 * scale, 1e-4 * scale, 3e-5 * scale], [sd, 1e-9, 1e-9]);
        let found = |scale, sd| apart(&davis(1.0, sd), &davis(scale, sd), 5.0..40.0).map(|apart| apart.kmh.round());
        assert_eq!(found(1.3, 2e-4), Some(144.0));
        assert_eq!(found(1.3, 1e-2), None);
        assert_eq!(found(1.02, 1e-6), None);
    }

    #[test]
    fn resistances_are_compared_where_both_were_taught() {
        // Alike up to 100 km/h, twice as much at 200.
        let davis = |r2: f64| Gaussian::independent([0.01, 1e-4, r2], [1e-4, 1e-9, 1e-9]);
        let found = |both_mps| apart(&davis(3e-6), &davis(3e-6 * 1.5), both_mps).map(|apart| apart.kmh.round());
        assert_eq!(found(5.0..15.0), None);
        assert_eq!(found(5.0..40.0), Some(144.0));
        assert_eq!(found(40.0..5.0), None);
    }

    #[test]
    fn what_efforts_taught_is_doubted_where_coasts_scatter_around_it() {
        let (gated, mut runs) = (estimator(Config::with_mode(Mode::Gated)), replayed().runs);
        let scattered = |squares: f64| Trust { coasts: 20.0, squares, ..Trust::NONE };
        let mut after = |squares: f64, own: Trust| {
            runs.truncate(1);
            let known = runs[0].clone();
            runs[0].trust = own;
            let mut trusts = HashMap::from([(runs[0].unit.clone(), scattered(squares))]);
            let times = foresee(&gated, &[Recording::default()], Tick::EverySample, &mut runs, &mut trusts);
            ByFilters::of(&known).widen(&gated, times[0], &mut runs[0]);
            let times = runs[0].vehicle_after.covariance[(0, 0)] / known.vehicle_after.covariance[(0, 0)];
            runs[0] = known;
            times
        };
        assert!((after(20.0, Trust::NONE) - 1.0).abs() < 1e-12);
        // What the vehicle has for its own coasts is not doubted again.
        assert!((after(125.0, scattered(125.0)) - 1.0).abs() < 1e-12);
        // Five times the expected variance, by so many coasts: half of them may have an additional force.
        let inflation = (5.0 + 0.97 * 125.0) / (5.0 + 0.97 * 20.0);
        let expected = inflation + 0.97 * 20.0 * (inflation - 2.25);
        assert!((after(125.0, Trust::NONE) / expected - 1.0).abs() < 1e-3, "{expected}");
    }
}
