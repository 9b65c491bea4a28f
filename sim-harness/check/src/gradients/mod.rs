//! Do the described gradients explain how trains coast, or would another reading of them?
//!
//! In: runs whose readings are put right, train and track as described. Out: a [`Doubt`] where another version of the gradients explains the coasts
//! clearly better, in both halves of the runs.
//!
//! ```text
//! e = (v1² - v0²)/(2 D) + r(v) + g/γ (h1 - h0)/D        effort over a stretch of 20 s, N/kg; zero while coasting
//! ```
//!
//! Which stretches are coasted is not asked of the estimator, whose answer depends on the gradients, but of each version: with the right gradients many
//! stretches have no effort at all, with wrong ones the same stretches scatter. So each version's efforts are a narrow normal distribution around zero
//! in a broad uniform one (`mixture`), and versions are compared by their likelihoods.

mod mixture;
mod stretch;

use mixture::{Fit, MOST_SD_N_PER_KG};
use rundown::model::direction::Direction;
use rundown::model::track::Track;
use rundown::model::train::Train;
use rundown_files::recording::Recording;
use serde::{Serialize, Serializer};
use std::fmt;
use stretch::Stretch;

/// Runs that are looked at; further ones say the same.
const MOST_RUNS: usize = 60;
/// A version must be better by this log-likelihood in each half of the runs: stretches at one place share errors of the gradients, so much more than chance asks.
const LEAST_GAIN: f64 = 12.0;
/// And its scatter less than this share of the described one's.
const LEAST_SHARPER: f64 = 0.8;
/// So many coasted stretches must say it.
const LEAST_STRETCHES: f64 = 20.0;
/// Coasts are explained where they scatter by less than this share of the most that is taken for coasting.
const EXPLAINED: f64 = 0.9;
/// Standard deviation of the gradients of a line of which nothing is known, permille: as where a track file describes none.
const UNKNOWN_PERMILLE: f64 = 5.0;
/// Shifts along the line that are tried, m.
const SHIFT_STEP_M: f64 = 100.0;
const MOST_SHIFT_M: f64 = 5_000.0;
/// A smaller shift is a matter of where the chainage begins, m.
const LEAST_SHIFT_M: f64 = 300.0;

/// A reading of the described gradients.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Version {
    /// As described.
    Described,
    /// Uphill taken for downhill.
    SignTurned,
    /// Per cent taken for permille: ten times as steep.
    PerCent,
    /// Ten times less steep.
    TenthOfIt,
    /// Twice as steep.
    TwiceOfIt,
    /// Half as steep.
    HalfOfIt,
    /// A level line: the described gradients belong to another one.
    Level,
    /// Described from the other end.
    OtherEnd,
    /// The chainage of the runs plus so many metres is that of the gradients.
    Shifted(f64),
}

impl Version {
    /// In one word, for programs.
    pub fn word(self) -> &'static str {
        match self {
            Self::Described => "described",
            Self::SignTurned => "sign_turned",
            Self::PerCent => "per_cent",
            Self::TenthOfIt => "tenth_of_it",
            Self::TwiceOfIt => "twice_of_it",
            Self::HalfOfIt => "half_of_it",
            Self::Level => "level",
            Self::OtherEnd => "other_end",
            Self::Shifted(_) => "shifted",
        }
    }

    /// By how much, where it is shifted, m.
    pub fn shift_m(self) -> Option<f64> {
        match self {
            Self::Shifted(by_m) => Some(by_m),
            _ => None,
        }
    }
}

impl Serialize for Version {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.word())
    }
}

impl fmt::Display for Version {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Described => write!(f, "as described"),
            Self::SignTurned => write!(f, "with the sign turned (downhill where uphill is described)"),
            Self::PerCent => write!(f, "ten times as steep (per cent written as permille)"),
            Self::TenthOfIt => write!(f, "a tenth as steep (permille multiplied by ten)"),
            Self::TwiceOfIt => write!(f, "twice as steep"),
            Self::HalfOfIt => write!(f, "half as steep"),
            Self::Level => write!(f, "without any (they are those of another line)"),
            Self::OtherEnd => write!(f, "described from the other end of the line"),
            Self::Shifted(by_m) => write!(f, "moved by {:+.1} km along the line", -by_m / 1000.0),
        }
    }
}

/// The described gradients look wrong.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Doubt {
    /// What explains the coasts best.
    pub better: Version,
    /// Scatter of coasted stretches with it, standard deviation, N/kg.
    pub sd_n_per_kg: f64,
    /// Scatter of the same stretches with the gradients as described, N/kg.
    pub described_sd_n_per_kg: f64,
    /// Log-likelihood of the better version less that of the described one.
    pub log_likelihood: f64,
    /// Stretches of 20 s that are coasted.
    pub stretches: usize,
    /// By how much the described gradients are off, root mean square over these stretches, permille.
    pub off_permille: f64,
}

impl Doubt {
    /// The described slopes have the wrong sign or scale: with another one they leave no more scatter than coasts have, and as described they leave more. No
    /// other version decides: short hops on a right line at times look like a level line, which a tenth all but is, or another place.
    pub fn is_decisive(&self) -> bool {
        let scaled = match self.better {
            Version::SignTurned | Version::PerCent | Version::TwiceOfIt | Version::HalfOfIt => true,
            Version::Described | Version::TenthOfIt | Version::Level | Version::OtherEnd | Version::Shifted(_) => false,
        };
        scaled && explains(self.sd_n_per_kg) && !explains(self.described_sd_n_per_kg)
    }
}

fn explains(sd_n_per_kg: f64) -> bool {
    sd_n_per_kg < EXPLAINED * MOST_SD_N_PER_KG
}

impl fmt::Display for Doubt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { better, sd_n_per_kg, described_sd_n_per_kg, log_likelihood, stretches, .. } = self;
        write!(
            f,
            "gradients look wrong: {better} they would explain the coasts: {stretches} stretches of 20 s scatter by \
             {sd_n_per_kg:.4} in place of {described_sd_n_per_kg:.4} N/kg, log-likelihood ratio {log_likelihood:.0}, \
             and both halves of the runs agree"
        )
    }
}

/// What runs say of gradients, run by run.
#[derive(Clone, Debug, Default)]
pub struct Coasts {
    runs: usize,
    stretches: Vec<Stretch>,
}

impl Coasts {
    /// Takes runs; those behind the first sixty say the same.
    pub fn add(&mut self, recordings: &[Recording], train: &Train) {
        for recording in recordings {
            if self.runs == MOST_RUNS {
                return;
            }
            let half = self.runs % 2;
            self.stretches.extend(stretch::of(&recording.rows, recording.direction, half, train));
            self.runs += 1;
        }
    }

    /// What is wrong with the described gradients; none where nothing is, or nothing can be said.
    pub fn doubt(&self, train: &Train, track: &Track) -> Option<Doubt> {
        let climbs = |version| self.climbs(version, train, track);
        let described_n_per_kg = climbs(Version::Described);
        // A level line has one version only.
        described_n_per_kg.iter().any(|climb| climb.abs() > 1e-6).then_some(())?;
        let fit = |climbs_n_per_kg: &[f64]| Fit::of(&self.stretches, climbs_n_per_kg);
        let described = fit(&described_n_per_kg)?;
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
        let tried = fixed.into_iter().chain(shifts).filter_map(|version| Some((version, fit(&climbs(version))?)));
        // Between the described slopes and none there is always something that fits a little better.
        let is_between = |version: &Version| matches!(version, Version::TwiceOfIt | Version::HalfOfIt);
        let tried = tried.filter(|(version, fit)| !is_between(version) || explains(fit.sd_n_per_kg));
        let (nearest, best) = tried.max_by(|a, b| a.1.log_likelihood().total_cmp(&b.1.log_likelihood()))?;
        // Two lines may be alike by chance; the right gradients leave no such scatter.
        let better = if explains(best.sd_n_per_kg) { nearest } else { Version::Level };
        let better_n_per_kg = climbs(better);
        let described_sd = described.sd_of(&self.stretches, &described_n_per_kg, &best.shares);
        let agree = (0..2).all(|half| best.by_half[half] - described.by_half[half] > LEAST_GAIN);
        let clear = best.coasted() >= LEAST_STRETCHES && best.sd_n_per_kg < LEAST_SHARPER * described_sd;
        (agree && clear).then(|| Doubt {
            better,
            sd_n_per_kg: best.sd_n_per_kg,
            described_sd_n_per_kg: described_sd,
            log_likelihood: best.log_likelihood() - described.log_likelihood(),
            stretches: best.coasted().round() as usize,
            off_permille: off_permille(&best.shares, &described_n_per_kg, &better_n_per_kg, better, train),
        })
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
                Version::Level => 0.0,
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

/// Root mean square of the difference between two versions over the coasted stretches. Of another line nothing is known but that it is no flatter than most.
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
