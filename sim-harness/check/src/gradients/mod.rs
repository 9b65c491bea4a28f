//! Do the described gradients explain how trains coast, or would another reading of them?
//!
//! In: runs whose readings are put right, train and track as described. Out: a [`Doubt`] where another version of the
//! gradients explains the coasts clearly better, in both halves of the runs and over the places of the line.
//!
//! ```text
//! e = (v1² - v0²)/(2 D) + r(v) + g/γ (h1 - h0)/D        effort over a stretch of 20 s, N/kg; zero while coasting
//! ```
//!
//! Which stretches are coasted is not asked of the estimator, whose answer depends on the gradients, but of each
//! version: with the right gradients many stretches have no effort at all, with wrong ones the same stretches scatter.
//! So each version's efforts are a narrow normal distribution around zero beside held speeds and a broad uniform one
//! (`mixture`), and versions are compared by their likelihoods, place by place (`places`). Where none of them explains
//! the coasts, what comes again at a place in other runs is the slope that is not described.

mod answer;
mod by_efforts;
mod doubt;
mod length;
mod locations;
mod mixture;
mod places;
mod steepness;
mod stretch;
mod units;
mod version;

pub use answer::{Answer, Follows, ResistsAtPlaces, SmallErrors};
pub use doubt::{Doubt, SeenBy};
pub use units::{CONVERSIONS, OtherUnits, converted};
pub use version::Version;

use crate::effort::driven::{self, Driven};
use by_efforts::ByEfforts;
use doubt::explains;
use mixture::{MOST_SD_N_PER_KG, MixtureFit};
use places::{AtPlaces, Locked};
use rundown::model::direction::Direction;
use rundown::model::track::Track;
use rundown::model::train::Train;
use rundown::tick::track_doubt::TrackDoubtConfig;
use rundown_files::recording::Recording;
use rundown_files::statistics::{mean_of, rms};
use stretch::Stretch;

/// Runs that are looked at; further ones say the same.
const MOST_RUNS: usize = 60;
/// A version must be better by this log-likelihood in each half of the runs: stretches at one place share errors of the
/// gradients, so much more than chance asks.
const LEAST_GAIN: f64 = 12.0;
/// And by so many standard errors over the places, for what drivers do at a few places is no slope: where a version
/// explains the coasts ...
const LEAST_Z: f64 = 1.7;
/// ... and where none does, as of another line; speeds that are held roughly look like that, too.
const LEAST_Z_UNEXPLAINED: f64 = 2.5;
/// The resistance of the coasts is so many times their scatter.
const LEAST_SEEN: f64 = 1.5;
/// And its scatter less than this share of the described one's.
const LEAST_SHARPER: f64 = 0.8;
/// So many coasted stretches must say it.
const LEAST_STRETCHES: f64 = 20.0;
/// Standard deviation of the gradients of a line of which nothing is known, permille: as where a track file describes
/// none.
const UNKNOWN_PERMILLE: f64 = 5.0;
/// Scatter that comes again at its place, of a line that is described level: by so many standard errors over the
/// places, and so much of it, N/kg.
const LOCKED_ON_LEVEL: (f64, f64) = (3.1, 0.003);
/// So many where that is more than half of all scatter.
const LOCKED_MOSTLY: (f64, f64) = (2.4, 0.5);
/// Of a line that is described with gradients, where speeds that are held on them come again, too.
const LOCKED_ON_SLOPES: (f64, f64) = (4.0, 0.02);
/// And so many times as much as without the described gradients.
const LEAST_WORSE: f64 = 1.2;
/// Coasts on slopes that nobody described scatter by no more, N/kg.
const MOST_LOCKED_SD_N_PER_KG: f64 = 0.04;
/// Beyond, of a steep line only the gentle slopes are seen, N/kg.
const STEEP_N_PER_KG: f64 = 0.01;
/// Small errors of described gradients are seen where coasts agree on them by so many standard errors over the places.
const LEAST_Z_SMALL: f64 = 2.5;
/// Of so many runs: a few share a wind or a driver.
const LEAST_RUNS_SMALL: usize = 8;
/// And are no larger, permille: held speeds come again at their places, too.
const MOST_SMALL_PERMILLE: f64 = 1.0;
/// Shifts along the line that are tried, m.
const SHIFT_STEP_M: f64 = 100.0;
const MOST_SHIFT_M: f64 = 5_000.0;
/// A smaller shift is a matter of where the chainage begins, m.
const LEAST_SHIFT_M: f64 = 300.0;

/// What runs say of gradients, run by run.
#[derive(Clone, Debug, Default)]
pub struct Coasts {
    runs: usize,
    stretches: Vec<Stretch>,
    /// Windows with a steady effort.
    driven: Vec<Driven>,
}

/// The stretches on the gradients as described.
struct AsDescribed {
    /// Force of the climb over each, N/kg.
    climbs_n_per_kg: Vec<f64>,
    /// Those that coast, as other versions of the gradients and of the resistance are compared with; none from too few.
    fit: Option<MixtureFit>,
    /// What efforts say of them; none of too few, on a level line, and where they do not explain the accelerations.
    efforts: Option<ByEfforts>,
}

impl AsDescribed {
    fn of(stretches: &[Stretch], climbs_n_per_kg: Vec<f64>) -> Self {
        let fit = MixtureFit::of(stretches, &climbs_n_per_kg, MOST_SD_N_PER_KG);
        Self { climbs_n_per_kg, fit, efforts: None }
    }

    /// What coasts have in common at a place, where slopes that nobody described may add to their scatter; none from
    /// too few.
    fn locked(&self, stretches: &[Stretch], asked: AtPlaces) -> Option<Locked> {
        let sds = [asked.least_sd(stretches).min(MOST_LOCKED_SD_N_PER_KG), MOST_LOCKED_SD_N_PER_KG];
        let fit = MixtureFit::within(stretches, &self.climbs_n_per_kg, sds)?;
        Locked::of(stretches, &fit, &self.climbs_n_per_kg, asked)
    }
}

impl Coasts {
    /// Takes runs; those behind the first sixty say the same.
    pub fn add(&mut self, recordings: &[Recording], train: &Train) {
        for recording in recordings {
            if self.runs == MOST_RUNS {
                return;
            }
            self.stretches.extend(stretch::of(&recording.rows, recording.direction, self.runs, train));
            self.driven.extend(driven::windows(&recording.rows, recording.direction, self.runs));
            self.runs += 1;
        }
    }

    /// What is wrong with the described gradients; none where nothing is, or nothing can be said. `said_permille`: how
    /// far they may be off by their own description, standard deviation; what scatters no more than that is not said
    /// again.
    pub fn doubt(&self, train: &Train, track: &Track, said_permille: f64) -> Option<Doubt> {
        self.doubt_of(&self.as_described(train, track), train, track, said_permille)
    }

    fn as_described(&self, train: &Train, track: &Track) -> AsDescribed {
        let coasts = AsDescribed::of(&self.stretches, self.climbs(Version::Described, train, track));
        AsDescribed { efforts: by_efforts::read(&self.driven, train, track), ..coasts }
    }

    fn doubt_of(&self, described: &AsDescribed, train: &Train, track: &Track, said_permille: f64) -> Option<Doubt> {
        // A level line has one version only.
        let is_level = described.efforts.is_none() && described.climbs_n_per_kg.iter().all(|climb| climb.abs() <= 1e-6);
        let other = (!is_level).then(|| self.other_version(train, track, described)).flatten();
        let steeper = || described.efforts?.other_steepness(train);
        let by_place = || self.by_place(train, described, is_level);
        // Efforts know better how many times as steep.
        let is_multiple = other.is_some_and(|doubt| matches!(doubt.better, Version::TwiceOfIt | Version::HalfOfIt));
        let doubt = if is_multiple { steeper().or(other) } else { other.or_else(steeper) };
        let doubt = doubt.or_else(|| by_place().filter(|doubt| doubt.off_permille > said_permille));
        doubt.filter(|_| is_level || !described.efforts.is_some_and(|efforts| efforts.vouch()))
    }

    /// What is wrong with the described gradients, or with the units of the described resistance: one of the two, which
    /// explains the coasts better.
    pub fn doubts(&self, train: &Train, track: &Track, said_permille: f64) -> (Option<Doubt>, Option<OtherUnits>) {
        self.doubts_of(&self.as_described(train, track), train, track, said_permille)
    }

    fn doubts_of(
        &self,
        described: &AsDescribed,
        train: &Train,
        track: &Track,
        said_permille: f64,
    ) -> (Option<Doubt>, Option<OtherUnits>) {
        let gradients = self.doubt_of(described, train, track, said_permille);
        // Known beside any resistance.
        if gradients.is_some_and(|doubt| doubt.better.times().is_some()) {
            return (gradients, None);
        }
        let by_gradients = gradients.and_then(|doubt| doubt.log_likelihood).unwrap_or(0.0);
        match self.other_units(&train.davis(), described).filter(|units| units.log_likelihood > by_gradients) {
            Some(units) => (None, Some(units)),
            None => (gradients, None),
        }
    }

    /// How far the described gradients are off, standard deviation: what efforts, or else coasts, of different runs
    /// have in common at a place, or make of all slopes. None where that is nothing, or may be chance; larger errors in
    /// coasts are a [`Doubt`].
    fn small_errors(&self, train: &Train, track: &Track, described: &AsDescribed) -> Option<SmallErrors> {
        if self.runs < LEAST_RUNS_SMALL {
            return None;
        }
        if let Some(efforts) = &described.efforts {
            return efforts.small_errors(train);
        }
        let climbs = &described.climbs_n_per_kg;
        let steepness = steepness::by_coasts(&self.stretches, climbs)
            .map(|steep| SmallErrors::of_steepness(steep, rms(climbs), SeenBy::Coasts, train));
        let locked = described.locked(&self.stretches, AtPlaces::SmallErrors);
        let is_seen = |found: &Locked| found.stretches >= LEAST_STRETCHES && found.z > LEAST_Z_SMALL;
        let at_places = locked.filter(is_seen).map(|found| SmallErrors {
            sd_permille: self.off_by_place_permille(found.sd_n_per_kg, train).min(MOST_SMALL_PERMILLE),
            seen_by: SeenBy::Coasts,
            follows: None,
        });
        let length = length::by_coasts(&self.stretches, train, track);
        let length = length.map(|length| SmallErrors::of_length(length, SeenBy::Coasts, train));
        SmallErrors::largest([at_places, steepness, length])
    }

    /// Another version explains the coasts better.
    fn other_version(&self, train: &Train, track: &Track, described: &AsDescribed) -> Option<Doubt> {
        let climbs = |version| self.climbs(version, train, track);
        let fit = |climbs_n_per_kg: &[f64]| MixtureFit::of(&self.stretches, climbs_n_per_kg, MOST_SD_N_PER_KG);
        let (described, described_n_per_kg) = (described.fit.as_ref()?, &described.climbs_n_per_kg);
        let tried = versions().filter_map(|version| Some((version, fit(&climbs(version))?)));
        // Between the described slopes and none there is always something that fits a little better.
        let is_between = |version: &Version| matches!(version, Version::TwiceOfIt | Version::HalfOfIt);
        let tried = tried.filter(|(version, fit)| !is_between(version) || explains(fit.sd_n_per_kg));
        let (nearest, best) = tried.max_by(|a, b| a.1.log_likelihood().total_cmp(&b.1.log_likelihood()))?;
        // Two lines may be alike by chance; the right gradients leave no such scatter.
        let (better, least_z) =
            if explains(best.sd_n_per_kg) { (nearest, LEAST_Z) } else { (Version::Level, LEAST_Z_UNEXPLAINED) };
        let better_n_per_kg = climbs(better);
        // Coasts that scatter nearly as much as they are slowed may be held speeds.
        let sees = best.resistance_n_per_kg(&self.stretches) > LEAST_SEEN * best.sd_n_per_kg;
        let described_sd = described.sd_of(&self.stretches, described_n_per_kg, &best.shares);
        let [one, two] = self.gains(&best, described);
        let agree = one > LEAST_GAIN && two > LEAST_GAIN;
        let clear = best.coasted() >= LEAST_STRETCHES && best.sd_n_per_kg < LEAST_SHARPER * described_sd;
        let z = places::better_by(&self.stretches, &best, described);
        // Of a speed that is held for half of a stretch, half of the slope and of the resistance are left.
        let may_be_held = better.is_gentler() && best.has_least_resistance();
        (agree && clear && sees && !may_be_held && z > least_z).then(|| Doubt {
            better,
            seen_by: SeenBy::Coasts,
            sd_n_per_kg: best.sd_n_per_kg,
            described_sd_n_per_kg: described_sd,
            log_likelihood: Some(one + two),
            z,
            stretches: best.coasted().round() as usize,
            off_permille: off_permille(&best.shares, described_n_per_kg, &better_n_per_kg, better, train),
        })
    }

    /// Log-likelihood of a version less that of another one, in each half of the runs.
    fn gains(&self, better: &MixtureFit, other: &MixtureFit) -> [f64; 2] {
        let mut gains = [0.0; 2];
        for (stretch, (a, b)) in self.stretches.iter().zip(better.log_likelihoods.iter().zip(&other.log_likelihoods)) {
            gains[stretch.half()] += a - b;
        }
        gains
    }

    /// Coasts at the same place in different runs agree on a slope that is not described.
    fn by_place(&self, train: &Train, described: &AsDescribed, is_level: bool) -> Option<Doubt> {
        let found = described.locked(&self.stretches, AtPlaces::OtherSlopes)?;
        let (least_z, least_n_per_kg) = if is_level { LOCKED_ON_LEVEL } else { LOCKED_ON_SLOPES };
        let mostly = found.z > LOCKED_MOSTLY.0 && found.sd_n_per_kg > LOCKED_MOSTLY.1 * found.all_sd_n_per_kg;
        let is_clear = found.z > least_z || is_level && mostly;
        // Slopes that are off by as much would show beside the efforts.
        let is_denied = described.efforts.is_some_and(|efforts| efforts.sds_n_per_kg[1] < found.sd_n_per_kg);
        let is_locked =
            is_clear && !is_denied && found.sd_n_per_kg > least_n_per_kg && found.stretches >= LEAST_STRETCHES;
        let is_worse = || {
            let level = AsDescribed::of(&self.stretches, vec![0.0; self.stretches.len()]);
            level
                .locked(&self.stretches, AtPlaces::OtherSlopes)
                .is_some_and(|level| found.sd_n_per_kg > LEAST_WORSE * level.sd_n_per_kg)
        };
        let rest = found.all_sd_n_per_kg.powi(2) - found.sd_n_per_kg.powi(2);
        (is_locked && (is_level || is_worse())).then(|| Doubt {
            better: Version::ByPlace,
            seen_by: SeenBy::Coasts,
            sd_n_per_kg: rest.max(0.0).sqrt(),
            described_sd_n_per_kg: found.all_sd_n_per_kg,
            log_likelihood: None,
            z: found.z,
            stretches: found.stretches.round() as usize,
            off_permille: self.off_by_place_permille(found.sd_n_per_kg, train),
        })
    }

    fn off_by_place_permille(&self, sd_n_per_kg: f64, train: &Train) -> f64 {
        let mean_way_m = mean_of(self.stretches.iter().map(|s| s.way_m));
        let permille = off_by_place_permille(sd_n_per_kg, mean_way_m, train);
        if sd_n_per_kg > STEEP_N_PER_KG { permille.max(UNKNOWN_PERMILLE) } else { permille }
    }

    /// Force of the climb over each stretch, N/kg.
    fn climbs(&self, version: Version, train: &Train, track: &Track) -> Vec<f64> {
        let height_m = |front_m: f64, stretch: &Stretch| {
            let length_m = train.length_m();
            let under = |front_m, direction| track.height_integral_m2(front_m, length_m, direction) / length_m;
            match version {
                Version::Described => under(front_m, stretch.direction),
                Version::SignTurned => -under(front_m, stretch.direction),
                Version::PerCent => 10.0 * under(front_m, stretch.direction),
                Version::TenthOfIt => 0.1 * under(front_m, stretch.direction),
                Version::TwiceOfIt => 2.0 * under(front_m, stretch.direction),
                Version::HalfOfIt => 0.5 * under(front_m, stretch.direction),
                Version::Times(times) => times * under(front_m, stretch.direction),
                Version::Level | Version::ByPlace => 0.0,
                Version::OtherEnd => under(track.length_m() - front_m, opposite(stretch.direction)),
                Version::Shifted(by_m) => under(front_m + by_m, stretch.direction),
            }
        };
        let climb = |stretch: &Stretch| {
            let [from_m, to_m] = stretch.fronts_m.map(|front_m| height_m(front_m, stretch));
            train.gravity_n_per_kg() * (to_m - from_m) / stretch.way_m
        };
        self.stretches.iter().map(climb).collect()
    }
}

/// What is tried beside the description.
fn versions() -> impl Iterator<Item = Version> {
    let steps = (MOST_SHIFT_M / SHIFT_STEP_M) as i32;
    let shifts = (-steps..=steps).map(|step| f64::from(step) * SHIFT_STEP_M);
    let shifts = shifts.filter(|by_m| by_m.abs() >= LEAST_SHIFT_M).map(Version::Shifted);
    let fixed = [
        Version::SignTurned,
        Version::PerCent,
        Version::TenthOfIt,
        Version::TwiceOfIt,
        Version::HalfOfIt,
        Version::Level,
        Version::OtherEnd,
    ];
    fixed.into_iter().chain(shifts)
}

/// Standard deviation of a gradient whose mean over a way and the train has this one.
fn off_by_place_permille(sd_n_per_kg: f64, way_m: f64, train: &Train) -> f64 {
    let ways = (way_m + train.length_m()) / TrackDoubtConfig::default().alike_m;
    // Of errors whose correlation falls exponentially.
    let of_mean = 2.0 / ways - 2.0 / (ways * ways) * (1.0 - (-ways).exp());
    1e3 * sd_n_per_kg / train.gravity_n_per_kg() / of_mean.sqrt()
}

/// Root mean square of the difference between two versions over the coasted stretches. Of another line nothing is known
/// but that it is no flatter than most.
fn off_permille(shares: &[f64], described: &[f64], better: &[f64], version: Version, train: &Train) -> f64 {
    let squares = shares.iter().zip(described).zip(better).map(|((share, a), b)| share * (a - b).powi(2));
    let off_n_per_kg = (squares.sum::<f64>() / shares.iter().sum::<f64>().max(1.0)).sqrt();
    let least = if version == Version::Level { UNKNOWN_PERMILLE } else { 0.0 };
    (1e3 * off_n_per_kg / train.gravity_n_per_kg()).max(least)
}

fn opposite(direction: Direction) -> Direction {
    match direction {
        Direction::Up => Direction::Down,
        Direction::Down => Direction::Up,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rundown::model::track::Gradient;
    use rundown::model::train::TrainDescription;
    use rundown_files::recording::Recording;
    use rundown_files::sample::Sample;

    /// Runs over hills, as sampled each second: the train takes `share` of slope and resistance for as long as it
    /// coasts, over slopes that are `times` as steep as described.
    fn runs(train: &Train, track: &Track, share: f64, times: f64) -> Vec<Recording> {
        let run = |number: usize| {
            let (mut location_m, mut mps) = (500.0 + 37.0 * number as f64, 0.0);
            let (mut rows, mut is_powered) = (Vec::new(), true);
            let height_m =
                |at_m: f64| track.height_integral_m2(at_m, train.length_m(), Direction::Up) / train.length_m();
            for second in 0..1500 {
                let slope = times * train.gravity_n_per_kg() * (height_m(location_m + 1.0) - height_m(location_m));
                let taken = share * (train.davis().resistance_n_per_kg(mps) + slope);
                is_powered = if is_powered { mps < 24.0 } else { mps < 17.0 };
                let noise = 0.003 * f64::sin((7 * second + 13 * number) as f64);
                let before_mps = mps;
                mps += if is_powered { 0.5 } else { noise - taken };
                location_m += 0.5 * (before_mps + mps);
                let (location_m, speed_mps) = (Some(location_m), Some(mps));
                rows.push(Sample { time_s: second as f64, location_m, speed_mps, ..Sample::default() });
            }
            Recording { rows, ..Recording::default() }
        };
        (0..12).map(run).collect()
    }

    #[test]
    fn half_of_slope_and_resistance_are_a_speed_held_in_part_and_no_gentler_slope() {
        let train = Train::try_new(TrainDescription::CASE_STUDY).unwrap();
        let hills = (0..60_u32).map(|i| {
            let permille = [6.0, -4.0, 9.0, -8.0, 2.0, -6.0, 0.0][i as usize % 7];
            Gradient { from_m: 800.0 * f64::from(i), permille }
        });
        let track = Track::try_new(48_000.0, hills).unwrap();
        let doubt = |share: f64, times: f64| {
            let mut coasts = Coasts::default();
            coasts.add(&runs(&train, &track, share, times), &train);
            coasts.doubt(&train, &track, 0.0).map(|doubt| doubt.better)
        };
        assert_eq!(doubt(1.0, 1.0), None);
        assert_eq!(doubt(1.0, 0.5), Some(Version::HalfOfIt));
        assert_eq!(doubt(0.5, 1.0), None);
    }

    #[test]
    fn slopes_that_act_more_or_less_than_described_or_on_a_longer_train_are_small_errors_of_all_of_them() {
        let train = Train::try_new(TrainDescription::CASE_STUDY).unwrap();
        let hills =
            (0..60_u32).map(|i| Gradient { from_m: 800.0 * f64::from(i), permille: f64::from(i * 7 % 11) - 5.0 });
        let track = Track::try_new(48_000.0, hills).unwrap();
        let steepness = |times: f64| {
            let mut coasts = Coasts::default();
            coasts.add(&runs(&train, &track, 1.0, times), &train);
            match coasts.answer(&train, &track, None).small?.follows? {
                Follows::Steepness(times) => Some(times),
                Follows::Length(_) | Follows::Locations(_) => None,
            }
        };
        assert_eq!(steepness(1.0), None);
        let length_m = 2.0 * train.length_m();
        let longer = Train::try_new(TrainDescription { length_m, ..TrainDescription::CASE_STUDY }).unwrap();
        let mut coasts = Coasts::default();
        coasts.add(&runs(&longer, &track, 1.0, 1.0), &longer);
        let follows = coasts.answer(&train, &track, None).small.and_then(|small| small.follows);
        let Some(Follows::Length(times)) = follows else { panic!("{follows:?}") };
        assert!((times.value - 2.0).abs() < 0.2, "{times:?}");
        for times in [0.93, 1.05] {
            let found = steepness(times).unwrap();
            assert!((found.value - times).abs() < 0.015, "{times}: {found:?}");
        }
    }
}
