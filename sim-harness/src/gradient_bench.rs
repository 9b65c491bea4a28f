//! Wrong gradients of known kind: how often they are named, and how often right ones are accused.
//!
//! ```text
//! line, seed -> runs of a vehicle off its description -> gradients described right or wrong -> doubt? of which kind?
//! ```
//!
//! Right ones are described to trains that hop and hold speeds, too (`hopping`).

mod hopping;

use crate::accuracy_bench::fleets::{self, Fleet};
use crate::accuracy_bench::scales;
use crate::study::case::Case;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};
use rayon::prelude::*;
use rundown::model::track::{Gradient, Track};
use rundown::model::train::Train;
use rundown_check::gradients::{Coasts, Doubt, Version};
use rundown_files::recording::Recording;
use rundown_truth::line::Line;
use rundown_truth::plan::{Headings, plan};
use rundown_truth::scenario::{Scenario, simulate_planned};
use serde::Serialize;

/// Runs of a set.
const RUNS: usize = 20;
/// Lines and trains on which coasts last a minute, by the names of the accuracy bench ...
const LONG: [&str; 4] = ["wind", "hills", "on-off", "freight"];
/// ... and those with short hops, where hardly a stretch of 20 s is coasted as a whole.
const HOPS: [&str; 2] = ["suburban", "metro"];
/// So many more sets of trains that hop and hold speeds, where right gradients are most easily accused.
const HOPPING: u64 = 10;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum DescribedGradients {
    Right,
    /// In whole permille, as many tables have them.
    Rounded,
    /// Each off by half a permille, standard deviation.
    Survey,
    SignTurned,
    PerCent,
    Permille,
    OtherEnd,
    Shifted,
    OtherLine,
    Twice,
    Half,
    Level,
}

impl DescribedGradients {
    const ALL: [Self; 12] = [
        Self::Right,
        Self::Rounded,
        Self::Survey,
        Self::SignTurned,
        Self::PerCent,
        Self::Permille,
        Self::OtherEnd,
        Self::Shifted,
        Self::OtherLine,
        Self::Twice,
        Self::Half,
        Self::Level,
    ];

    fn words(self) -> &'static str {
        match self {
            Self::Right => "as they are",
            Self::Rounded => "rounded to whole permille",
            Self::Survey => "each off by 0.5 permille, standard deviation",
            Self::SignTurned => "the sign turned",
            Self::PerCent => "in per cent",
            Self::Permille => "ten times as steep",
            Self::OtherEnd => "from the other end",
            Self::Shifted => "moved by 1 to 3 km",
            Self::OtherLine => "of another line",
            Self::Twice => "twice as steep",
            Self::Half => "half as steep",
            Self::Level => "as level",
        }
    }

    const fn is_right(self) -> bool {
        matches!(self, Self::Right | Self::Rounded | Self::Survey)
    }

    /// The kind that is named.
    fn is_named(self, better: Version) -> bool {
        match self {
            Self::SignTurned => better == Version::SignTurned,
            Self::PerCent => better == Version::PerCent,
            Self::Permille => better == Version::TenthOfIt,
            Self::OtherEnd => better == Version::OtherEnd,
            Self::Shifted => matches!(better, Version::Shifted(_)),
            Self::OtherLine => matches!(better, Version::Level | Version::ByPlace),
            Self::Level => better == Version::ByPlace,
            Self::Twice => better == Version::HalfOfIt || is_times(better, 0.5),
            Self::Half => better == Version::TwiceOfIt || is_times(better, 2.0),
            Self::Right | Self::Rounded | Self::Survey => false,
        }
    }

    fn track(self, line: &Line, random: &mut ChaCha8Rng) -> Result<Track, String> {
        let length_m = line.length_m();
        let shift_m = random.random_range(1_000.0..3_000.0) * if random.random_bool(0.5) { 1.0 } else { -1.0 };
        let normal = Normal::new(0.0, 0.5).map_err(|e| e.to_string())?;
        let other = Line::hilly(random.random_range(1_000..1_000_000));
        let reversed = line.reversed();
        let source = match self {
            Self::OtherEnd => &reversed,
            Self::OtherLine => &other,
            _ => line,
        };
        let mut gradient = |&(from_m, permille): &(f64, f64)| {
            let permille = match self {
                Self::Rounded => permille.round(),
                Self::Survey => permille + normal.sample(random),
                Self::SignTurned => -permille,
                Self::PerCent => 0.1 * permille,
                Self::Permille => 10.0 * permille,
                Self::Twice => 2.0 * permille,
                Self::Half => 0.5 * permille,
                Self::Level => 0.0,
                _ => permille,
            };
            Gradient { from_m: if self == Self::Shifted { from_m + shift_m } else { from_m }, permille }
        };
        let gradients: Vec<Gradient> = source.gradients_permille().iter().map(&mut gradient).collect();
        Track::try_new(length_m, gradients).map_err(|e| e.to_string())
    }
}

/// Measured efforts say how many times as steep, and within a tenth of it.
fn is_times(better: Version, times: f64) -> bool {
    better.times().is_some_and(|found| (found / times - 1.0).abs() < 0.1)
}

/// What came of sets with gradients described in one way.
#[derive(Clone, Debug, Default, Serialize)]
pub struct GradientCount {
    /// Sets.
    pub sets: usize,
    /// Sets in which the gradients were said to look wrong.
    pub doubted: usize,
    /// Sets in which the kind was named.
    pub named: usize,
}

/// Sets with gradients described in one way.
#[derive(Clone, Debug, Serialize)]
pub struct GradientRow {
    /// How.
    pub what: &'static str,
    /// Whether that is right.
    pub is_right: bool,
    /// Where coasts last a minute.
    pub long: GradientCount,
    /// On short hops.
    pub hops: GradientCount,
    /// What was said of each doubted set, with its line.
    pub said: Vec<String>,
}

/// Of `gradients.json`: path, unit, meaning, null rule.
pub const FIELDS: &[[&str; 4]] = &[
    ["[].what", "", "how the gradients are described", ""],
    ["[].is_right", "", "whether that is right", ""],
    ["[].long.sets", "", "sets of runs on lines where coasts last a minute", ""],
    ["[].long.doubted", "", "those of which the gradients were said to look wrong", ""],
    ["[].long.named", "", "those of which the kind was named", ""],
    ["[].hops.sets", "", "sets of runs on short hops", ""],
    ["[].hops.doubted", "", "those of which the gradients were said to look wrong", ""],
    ["[].hops.named", "", "those of which the kind was named", ""],
    ["[].said[]", "", "line, description and what was said of each set whose gradients were said to look wrong", ""],
];

impl GradientRow {
    fn new(what: &'static str, is_right: bool) -> Self {
        Self { what, is_right, long: GradientCount::default(), hops: GradientCount::default(), said: Vec::new() }
    }

    fn add(&mut self, fleet: &Fleet, doubt: Option<Doubt>, is_named: impl Fn(Version) -> bool) {
        let is_long = LONG.contains(&fleet.name) && self.what != HOPPING_WORDS && self.what != LEVEL_WORDS;
        let count = if is_long { &mut self.long } else { &mut self.hops };
        count.sets += 1;
        if let Some(doubt) = doubt {
            count.doubted += 1;
            count.named += usize::from(is_named(doubt.better));
            self.said.push(format!("{}, described {}: {doubt}", fleet.what, self.what));
        }
    }
}

/// Diagnoses so many sets of each line with gradients described in each way. Out: a row for each way.
///
/// # Errors
/// A run that could not be simulated, or a track that is refused; in words.
pub fn bench(sets: u64, seed: u64, done: impl Fn() + Sync) -> Result<Vec<GradientRow>, String> {
    let fleets = fleets::all().into_iter();
    let fleets: Vec<Fleet> = fleets.filter(|fleet| LONG.contains(&fleet.name) || HOPS.contains(&fleet.name)).collect();
    let each: Vec<_> = fleets.iter().flat_map(|fleet| (0..sets).map(move |set| (fleet, set))).collect();
    let set = |(fleet, number)| {
        let found = doubts(fleet, seed.wrapping_add(104_729 * number))?;
        done();
        Ok((fleet, found))
    };
    let all = each.into_par_iter().map(set).collect::<Result<Vec<_>, String>>()?;
    let row = |(index, described): (usize, &DescribedGradients)| {
        let mut row = GradientRow::new(described.words(), described.is_right());
        all.iter().for_each(|(fleet, doubts)| row.add(fleet, doubts[index], |better| described.is_named(better)));
        row
    };
    let rows = DescribedGradients::ALL.iter().enumerate().map(row);
    Ok(rows.chain(hopping_rows(sets, seed, done)?).collect())
}

const HOPPING_WORDS: &str = "as they are, to trains that hop and hold speeds";
const LEVEL_WORDS: &str = "as level, to the same on a level line";

/// Right gradients of trains that hop and hold speeds.
fn hopping_rows(sets: u64, seed: u64, done: impl Fn() + Sync) -> Result<[GradientRow; 2], String> {
    let set = |number| {
        let seed = seed.wrapping_add(7_919 * number);
        let fleet = hopping::fleet(seed)?;
        let level = hopping::on_level(&fleet);
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut doubt = |fleet: &Fleet| {
            let track = DescribedGradients::Right.track(&fleet.scenario.line, &mut random)?;
            let train = fleet.train().ok_or("the train's description is refused")?;
            Ok::<_, String>(coasts(&fleet.scenario, &train, seed)?.doubt(&train, &track, 0.0))
        };
        let doubts = [doubt(&fleet)?, doubt(&level)?];
        done();
        Ok((fleet, doubts))
    };
    let all = (0..HOPPING * sets).into_par_iter().map(set).collect::<Result<Vec<_>, String>>()?;
    let mut rows = [HOPPING_WORDS, LEVEL_WORDS].map(|words| GradientRow::new(words, true));
    for (fleet, doubts) in &all {
        rows.iter_mut().zip(doubts).for_each(|(row, doubt)| row.add(fleet, *doubt, |_| false));
    }
    Ok(rows)
}

/// Steps of [`bench()`].
pub const fn steps(sets: u64) -> u64 {
    ((LONG.len() + HOPS.len()) as u64 + HOPPING) * sets
}

/// What is said of the same runs with gradients described in each way.
fn doubts(fleet: &Fleet, seed: u64) -> Result<Vec<Option<Doubt>>, String> {
    let mut random = ChaCha8Rng::seed_from_u64(seed ^ 0x6AD);
    let davis_scale = scales(50)[random.random_range(0..50)];
    let scenario =
        Scenario { wind_sd_mps: 2.0, load_sd: 0.03, headings: Headings::Both, davis_scale, ..fleet.scenario.clone() };
    let train = fleet.train().ok_or("the train's description is refused")?;
    let coasts = coasts(&scenario, &train, seed)?;
    let doubt =
        |described: &DescribedGradients| Ok(coasts.doubt(&train, &described.track(&scenario.line, &mut random)?, 0.0));
    DescribedGradients::ALL.iter().map(doubt).collect()
}

/// What the runs of a set say of gradients.
fn coasts(scenario: &Scenario, train: &Train, seed: u64) -> Result<Coasts, String> {
    let recording = |plan| {
        let run = simulate_planned(scenario, plan).map_err(|e| e.to_string())?;
        Ok(Case::simulated("run".to_owned(), String::new(), run).recording)
    };
    let recordings: Vec<Recording> = plan(scenario, RUNS, seed).iter().map(recording).collect::<Result<_, String>>()?;
    let mut coasts = Coasts::default();
    coasts.add(&recordings, train);
    Ok(coasts)
}

/// As in `docs/check.md`.
pub fn table(rows: &[GradientRow]) -> String {
    let mut text = String::from(
        "| gradients are described | said to look wrong | kind named | on short hops |\n|---|---|---|---|\n",
    );
    for GradientRow { what, is_right, long, hops, .. } in rows {
        let of = |count, sets| if sets == 0 { "-".to_owned() } else { format!("{count} of {sets}") };
        let named = if *is_right { "-".to_owned() } else { of(long.named, long.sets) };
        let [long, hops] = [long, hops].map(|count| of(count.doubted, count.sets));
        text += &format!("| {what} | {long} | {named} | {hops} |\n");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrong_gradients_are_named_and_right_ones_are_not_accused() {
        let rows = bench(1, 4712, || ()).unwrap();
        println!("{}", table(&rows));
        for row in &rows {
            if row.is_right {
                assert_eq!((row.long.doubted, row.hops.doubted), (0, 0), "{row:#?}");
            } else if row.what == DescribedGradients::Half.words() {
                // On gentle lines what is missing is no more than coasts scatter.
                assert!(2 * row.long.named >= row.long.sets, "{row:#?}");
            } else {
                // Of ramps that lie far apart not every shift is seen.
                assert!(row.long.doubted + 1 >= row.long.sets && row.long.named + 1 >= row.long.sets, "{row:#?}");
            }
        }
    }
}
