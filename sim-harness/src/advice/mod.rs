//! What a person should know before trusting the results: things that are no error of any log, and still spoil all of
//! it.
//!
//! In: the estimator, the runs as replayed. Out: notes, one line each.

pub(crate) mod before_brakes;
mod changed;
pub(crate) mod coasts;
pub(crate) mod foreseen;
pub(crate) mod left_open;
mod scatter;
mod taught;
mod two_sorts;
mod unlike;
pub(crate) mod vehicle;
mod with_efforts;

use rundown::estimator::Estimator;
use rundown::estimator::config::Mode;
use rundown::tick::foresight::Trust;
use rundown::tick::measurement::Measurement;
use rundown_files::recording::Recording;
use rundown_files::replay::{ReplayedRun, Tick};
use rundown_wire::Learned;
use std::collections::{BTreeMap, BTreeSet, HashMap};

const NAMED: usize = 3;
/// A tick of the measured mode ends with a row that has an effort, and there it compares speed and location.
const EFFORT_BESIDE_BOTH: &str = "effort, speed and location in one row, and no row has all three";
/// A described resistance that is not seen at this speed is seen at none, km/h.
const MOST_KMH: u16 = 400;

/// What is collected of the runs as they come.
#[derive(Debug, Default)]
pub struct Advice {
    runs: usize,
    learned: bool,
    /// Of all runs, m/s.
    fastest_mps: f64,
    scatter: scatter::Scatter,
    without_speed: NamedRuns,
    without_effort: NamedRuns,
    with_effort: NamedRuns,
    /// A row has an effort beside a speed and a location.
    effort_beside_both: bool,
    /// By unit.
    vehicles: BTreeMap<String, vehicle::After>,
    foreseen: foreseen::Foreseen,
    /// What each run taught by itself.
    taught: Vec<taught::Taught>,
    /// What coasts teach of each beside its efforts.
    coasts: BTreeMap<String, coasts::OfCoasts>,
    /// How coasts were foreseen by what efforts taught, by unit.
    trusts: HashMap<String, Trust>,
}

impl Advice {
    pub fn add(&mut self, runs: &[ReplayedRun]) {
        self.foreseen.add(runs);
        for run in runs {
            self.runs += 1;
            self.learned |= run.is_used && run.summary.learned_s > 0.0;
            let rows = || run.measurements.iter();
            self.scatter.add(&run.measurements);
            self.fastest_mps = rows().filter_map(|row| row.speed_mps).fold(self.fastest_mps, f64::max);
            self.without_speed.add(run, rows().all(|measurement| measurement.speed_mps.is_none()));
            self.without_effort.add(run, rows().all(|measurement| measurement.effort_n_per_kg.is_none()));
            self.with_effort.add(run, rows().any(|measurement| measurement.effort_n_per_kg.is_some()));
            self.effort_beside_both |= rows().any(has_effort_beside_both);
            self.taught.extend(taught::Taught::of(run).filter(|_| run.is_used));
            vehicle::After::add(&mut self.vehicles, run);
        }
    }

    /// Asks coasts what efforts taught: what the first of them teach themselves, and how well they are foreseen. Call
    /// it before the runs are added. Out: by how much the coasts widen what each began with, and what it taught.
    pub fn foresee(
        &mut self,
        gated: &Estimator,
        recordings: &[Recording],
        tick: Tick,
        runs: &mut [ReplayedRun],
    ) -> Vec<[f64; 2]> {
        if self.runs == 0 {
            self.coasts = coasts::taught(gated, recordings, tick);
        }
        coasts::foresee(gated, recordings, tick, runs, &mut self.trusts)
    }

    /// What efforts taught of a resistance that coasts contradict is not published, nor what runs of two trains did.
    /// Call it once the runs are added.
    pub fn withhold(&self, runs: &mut [ReplayedRun]) {
        coasts::withhold(&self.vehicles, &self.coasts, runs);
        let is_of_neither = |(unit, after): &(&String, &vehicle::After)| {
            self.two_sorts(unit, after).is_some_and(|sorts| sorts.is_of_neither)
        };
        let units = self.vehicles.iter().filter(is_of_neither);
        let of_neither: BTreeSet<&str> = units.map(|(unit, _)| unit.as_str()).collect();
        let learned = runs.iter_mut().filter(|run| run.learned == Learned::Learned);
        learned.filter(|run| of_neither.contains(&*run.unit)).for_each(|run| run.learned = Learned::NotYet);
    }

    /// Of a unit whose runs are of two sorts; not where it has changed at once, if one sort comes after the other.
    fn two_sorts(&self, unit: &str, after: &vehicle::After) -> Option<two_sorts::Note> {
        let sorts = two_sorts::note(unit, &self.taught, &after.davis)?;
        let is_a_change = sorts.may_be_a_change && self.changed(unit, after).is_some();
        (!is_a_change).then_some(sorts)
    }

    fn changed(&self, unit: &str, after: &vehicle::After) -> Option<String> {
        changed::note(unit, &self.taught, &after.davis)
    }

    pub fn notes(&self, estimator: &Estimator, gradients_are_said: bool) -> Vec<String> {
        let config = estimator.config();
        if self.runs == 0 {
            return Vec::new();
        }
        let without_speed = "no speed_kmh in any row, without which nothing is known of the train";
        let without_effort = "no effort_n_per_kg that can be used, without which the measured mode learns from \
                              the coasts of short hops alone; --mode gated learns from all coasts";
        let mut notes: Vec<String> = self.without_speed.note(without_speed).into_iter().collect();
        if config.mode == Mode::Measured {
            notes.extend(self.without_effort.note(without_effort));
        } else {
            notes.extend(self.with_effort.note("effort_n_per_kg is not used: --mode measured learns from it"));
        }
        if config.mode == Mode::Paper {
            notes.push(
                "in the paper mode the estimate does not follow the true resistance, and its deviation is no measure of accuracy"
                    .to_owned(),
            );
            return notes;
        }
        if !self.learned {
            let what = match config.mode {
                Mode::Gated => self.coasting(estimator),
                _ if self.with_effort.count > 0 && !self.effort_beside_both => EFFORT_BESIDE_BOTH.to_owned(),
                _ => effort_in_one_piece(estimator),
            };
            let doubt = config.track_doubt.gradient_sd_permille;
            let slopes = if doubt > 0.0 {
                format!(", on gradients that are known better than by {doubt:.1} permille")
            } else {
                String::new()
            };
            let hidden = self.scatter.hides_coasts();
            notes.push(format!("nothing was learned about the resistance: it takes {what}{slopes}{hidden}"));
        }
        notes.extend(coasts::notes(&self.vehicles, &self.coasts));
        notes.extend(self.foreseen.notes());
        notes.extend(unlike::note(&self.taught, |unit| self.vehicles.get(unit).map(|after| after.davis)));
        let not_one = |(unit, after): (&String, &vehicle::After)| {
            self.two_sorts(unit, after).map(|sorts| sorts.text).or_else(|| self.changed(unit, after))
        };
        notes.extend(self.vehicles.iter().filter_map(not_one));
        notes.extend(vehicle::notes(estimator, &self.vehicles, gradients_are_said));
        notes
    }

    /// The coasts that the gated mode learns from, and how fast these runs were.
    fn coasting(&self, estimator: &Estimator) -> String {
        let learning = &estimator.config().learning;
        format!(
            "{} s of coasting above {} km/h in one piece{}; the fastest of these runs reached {:.0} km/h",
            learning.min_segment_s,
            learning.min_speed_kmh,
            on_hops(estimator).map_or_else(String::new, |[coast, hop]| format!(", or {coast} {hop}")),
            3.6 * self.fastest_mps
        )
    }
}

/// `run01, run02 and 3 more`
fn first_of(all: impl ExactSizeIterator<Item = String>, most: usize) -> String {
    let more = all.len().saturating_sub(most);
    let first = all.take(most).collect::<Vec<_>>().join(", ");
    if more > 0 { format!("{first} and {more} more") } else { first }
}

fn has_effort_beside_both(row: &Measurement) -> bool {
    row.effort_n_per_kg.is_some() && row.speed_mps.is_some() && row.location_m.is_some()
}

/// The efforts that the measured mode learns from. Those of short hops it does not, whatever the column has: they show
/// the ends of powering alone.
fn effort_in_one_piece(estimator: &Estimator) -> String {
    let efforts =
        format!("{} s of known effort without braking in one piece", estimator.config().learning.min_segment_s);
    match on_hops(estimator) {
        Some([coast, hop]) => format!("{efforts}; {hop} no effort teaches, but {coast}"),
        None => efforts,
    }
}

/// The coasts of hops that teach in both learning modes, and after which hops.
fn on_hops(estimator: &Estimator) -> Option<[String; 2]> {
    let short_hops = &estimator.config().short_hops;
    let is_seen = |kmh: &u16| {
        let r = estimator.train().davis().resistance_n_per_kg(f64::from(*kmh) / 3.6);
        r > short_hops.min_resistance_n_per_kg
    };
    let kmh = (1..=MOST_KMH).find(is_seen).filter(|_| short_hops.hop_s > 0.0)?;
    let (hop_s, least_s) = (short_hops.hop_s, short_hops.min_segment_s + short_hops.end_cut_s);
    Some([format!("{least_s} s of coasting above {kmh} km/h"), format!("after a hop of at most {hop_s} s")])
}

/// Runs of which the same is to be said: the first names, and how many they are.
#[derive(Debug, Default)]
struct NamedRuns {
    first: Vec<String>,
    count: usize,
}

impl NamedRuns {
    fn add(&mut self, run: &ReplayedRun, is_one: bool) {
        self.count += usize::from(is_one);
        if is_one && self.first.len() < NAMED {
            self.first.push(run.name.clone());
        }
    }

    /// `run01, run02, run03 and 4 more runs: text`
    fn note(&self, text: &str) -> Option<String> {
        let names = self.first.join(", ");
        match self.count.checked_sub(NAMED) {
            _ if self.count == 0 => None,
            None | Some(0) => Some(format!("{names}: {text}")),
            Some(1) => Some(format!("{names} and 1 more run: {text}")),
            Some(more) => Some(format!("{names} and {more} more runs: {text}")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::replaying::{Replayed, Request};
    use crate::report::resistance::Resistance;
    use rundown::estimator::config::Config;
    use rundown::model::direction::Direction;
    use rundown_check::figure::Figure;
    use rundown_files::{track_file::TrackFile, train_file::TrainFile};
    use std::path::{Path, PathBuf};

    fn reference(name: &str) -> PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../data/reference").join(name)
    }

    pub(super) fn replayed() -> Replayed {
        let request = Request::new(vec![reference("run01.csv")], reference("train.toml"), reference("track.toml"));
        request.open().unwrap().replay(|| ()).unwrap()
    }

    pub(super) fn estimator(config: Config) -> Estimator {
        let (_, train) = TrainFile::read(&reference("train.toml")).unwrap();
        let (_, track) = TrackFile::read(&reference("track.toml")).unwrap();
        Estimator::try_new(config, train, track).unwrap()
    }

    /// The vehicle does not have what a run taught that was set aside.
    #[test]
    fn what_a_run_taught_that_is_not_used_was_not_learned() {
        let mut replayed = replayed();
        let estimator = estimator(replayed.config);
        for is_used in [true, false] {
            replayed.runs[0].is_used = is_used;
            let mut advice = Advice::default();
            advice.add(&replayed.runs);
            let is_said = advice.notes(&estimator, false).iter().any(|note| note.starts_with("nothing was learned"));
            assert_eq!(is_said, !is_used);
        }
    }

    #[test]
    fn what_efforts_teach_is_not_published_where_coasts_contradict_it() {
        let published = |times: f64| {
            let mut runs = replayed().runs;
            runs[0].learned = Learned::Learned;
            let mut advice = Advice::default();
            advice.add(&runs);
            let taught = runs[0].vehicle_after;
            runs[0].vehicle_after.mean *= times;
            let after = vehicle::After::of(&runs[0], None);
            advice.coasts.insert(String::new(), coasts::OfCoasts { after, all: 1, with_efforts: 0, by_all: true });
            runs[0].vehicle_after = taught;
            advice.withhold(&mut runs);
            (
                runs[0].learned,
                advice.notes(&estimator(Config::default()), false).join("\n").contains("is not published"),
            )
        };
        assert_eq!(published(1.0), (Learned::Learned, false));
        assert_eq!(published(1.5), (Learned::NotYet, true));
    }

    #[test]
    fn what_coasts_of_short_hops_teach_that_have_efforts_is_not_published() {
        let published = |hops_share: f64, effort_n_per_kg: f64| {
            let mut runs = replayed().runs;
            (runs[0].learned, runs[0].hops_share) = (Learned::Learned, hops_share);
            assert!(runs[0].estimates.iter().any(|estimate| estimate.learning));
            runs[0].measurements.iter_mut().for_each(|row| row.effort_n_per_kg = Some(effort_n_per_kg));
            let mut advice = Advice::default();
            advice.add(&runs);
            let after = vehicle::After::of(&runs[0], None);
            advice.coasts.insert(String::new(), coasts::OfCoasts { after, all: 1, with_efforts: 0, by_all: true });
            advice.withhold(&mut runs);
            let notes = advice.notes(&estimator(Config::default()), false).join("\n");
            (runs[0].learned, notes.contains("short hops teach by coasts"))
        };
        assert_eq!(published(0.8, 0.05), (Learned::NotYet, true));
        assert_eq!(published(0.8, 0.001), (Learned::Learned, false));
        assert_eq!(published(0.2, 0.05), (Learned::Learned, false));
    }

    /// The notes on nine runs, each with so many times the resistance of the vehicle, and what else it is.
    fn said_of(times_and_run: impl Fn(u32) -> (f64, taught::Taught)) -> String {
        let mut advice = Advice::default();
        advice.add(&replayed().runs);
        let r_n_per_kg = Resistance::at(&advice.vehicles[""].davis, 25.0).unwrap().mean_n_per_kg;
        let run = |i: u32| {
            let (times, run) = times_and_run(i);
            taught::Taught { r_n_per_kg: Figure { value: times * r_n_per_kg, sd: 1e-5 }, ..run }
        };
        advice.taught = (0..9).map(run).collect();
        advice.notes(&estimator(Config::default()), false).join("\n")
    }

    fn taught(i: u32, share: f64) -> taught::Taught {
        taught::Taught {
            name: format!("run{i}"),
            unit: String::new(),
            direction: if i.is_multiple_of(2) { Direction::Up } else { Direction::Down },
            share,
            speed_mps: 25.0,
            r_n_per_kg: Figure { value: 0.0, sd: 0.0 },
        }
    }

    #[test]
    fn runs_of_two_sorts_are_said_with_their_names() {
        let said = |more: &[u32]| said_of(|i| (if more.contains(&i) { 1.25 } else { 1.0 }, taught(i, 0.5)));
        let few = said(&[1, 2, 5, 8]);
        let expected = "the vehicle: its runs are of two sorts: 4 of 9 that teach enough by themselves have 25 % more \
                        resistance than the others (at about 90 km/h), run1, run2, run5, run8: coaches, a load";
        assert!(few.contains(expected) && few.contains("is not published; replay each sort by itself"), "{few}");
        let many = said(&[0, 1, 2, 5, 8]);
        assert!(
            many.contains("4 of 9") && many.contains("20 % less") && many.contains("run3, run4, run6, run7"),
            "{many}"
        );
        assert!(said(&[1, 3, 5, 7]).contains("one for each direction: a steady wind"), "{}", said(&[1, 3, 5, 7]));
        // One sort after the other: a change, had the runs taught enough to say so.
        assert!(said(&[5, 6, 7, 8]).contains("two sorts"), "{}", said(&[5, 6, 7, 8]));
    }

    #[test]
    fn what_runs_of_two_trains_teach_is_not_published() {
        let published = |more: &[u32]| {
            let mut runs = replayed().runs;
            runs[0].learned = Learned::Learned;
            let mut advice = Advice::default();
            advice.add(&runs);
            let r_n_per_kg = Resistance::at(&advice.vehicles[""].davis, 25.0).unwrap().mean_n_per_kg;
            let run = |i: u32| {
                let times = if more.contains(&i) { 1.25 } else { 1.0 };
                taught::Taught { r_n_per_kg: Figure { value: times * r_n_per_kg, sd: 1e-5 }, ..taught(i, 0.5) }
            };
            advice.taught = (0..9).map(run).collect();
            advice.withhold(&mut runs);
            runs[0].learned
        };
        assert_eq!(published(&[1, 2, 5, 8]), Learned::NotYet);
        // One sort for each direction: what both teach has neither wind nor slope in it.
        assert_eq!([published(&[]), published(&[1, 3, 5, 7])], [Learned::Learned; 2]);
    }

    #[test]
    fn a_train_that_changes_at_once_is_said_with_the_run() {
        let said = |since: f64| said_of(|i| (if i < 4 { 1.0 } else { since }, taught(i, 1.0)));
        let expected =
            "the vehicle: from run4 on it has 30 % more resistance (at about 90 km/h, by 4 runs before and 5 since";
        assert!(said(1.3).contains(expected), "{}", said(1.3));
        assert!(said(0.7).contains("from run4 on it has 30 % less resistance"), "{}", said(0.7));
        assert!(!said(1.05).contains("on it has"), "{}", said(1.05));
    }

    /// Speed and effort each have rows of their own: of the effort there is a minute in one piece, and that was asked
    /// for.
    #[test]
    fn efforts_without_a_speed_in_their_rows_are_said() {
        let mut replayed = replayed();
        let mut said = |apart: bool| {
            replayed.runs[0].summary.learned_s = 0.0;
            for (index, row) in replayed.runs[0].measurements.iter_mut().enumerate() {
                row.effort_n_per_kg = (!apart || index % 2 == 0).then_some(0.1);
                row.speed_mps = (!apart || index % 2 == 1).then_some(20.0);
            }
            let mut advice = Advice::default();
            advice.add(&replayed.runs);
            advice.notes(&estimator(Config::with_mode(Mode::Measured)), false).join("\n")
        };
        assert!(said(true).contains("it takes effort, speed and location in one row, and no row has all three"));
        assert!(said(false).contains("it takes 60 s of known effort without braking in one piece"));
    }

    /// The gated mode takes efforts to be unknown, though the analyst may think that they were used.
    #[test]
    fn an_effort_column_that_the_mode_does_not_use_is_said() {
        let mut replayed = replayed();
        let mut said = |effort_n_per_kg: Option<f64>, mode: Mode| {
            replayed.runs[0].measurements.iter_mut().for_each(|one| one.effort_n_per_kg = effort_n_per_kg);
            let estimator = estimator(Config::with_mode(mode));
            let mut advice = Advice::default();
            advice.add(&replayed.runs);
            let notes = advice.notes(&estimator, false);
            notes.iter().any(|note| note == "run01: effort_n_per_kg is not used: --mode measured learns from it")
        };
        assert!(said(Some(0.1), Mode::Gated) && said(Some(0.1), Mode::Paper));
        assert!(!said(Some(0.1), Mode::Measured) && !said(None, Mode::Gated));
    }
}
