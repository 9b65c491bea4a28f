//! What measured efforts say of the described gradients: are they right, how many times as steep, and by how much off
//! at their places?
//!
//! ```text
//! dv/dt = q u - k g(s) - b0 - b1 v - b2 v²          k: 1 described rightly, -1 with the sign turned, 0 of another line
//! ```
//!
//! Speeds that are held by a fine hand fall and rise with the slopes, run after run at the same places, as coasts on
//! other slopes would. With known efforts they are explained. How surely k is known is what places say of it; what the
//! slopes are off by is what different runs have in common at a place, with k = 1.

use super::length::{self, OtherLength};
use super::locations::{self, OffFromRunToRun};
use super::places::{self, Leaves, Recurring};
use super::steepness::first_over_places;
use super::{Doubt, SeenBy, SmallErrors, Version, off_by_place_permille};
use crate::effort::driven::Driven;
use crate::effort::least_squares;
use crate::figure::Figure;
use nalgebra::SVector;
use rundown::model::direction::Direction;
use rundown::model::track::Track;
use rundown::model::train::Train;
use rundown_files::statistics::{mean_of, rms};
use std::collections::BTreeSet;

/// Fewer windows say nothing.
const LEAST_WINDOWS: usize = 200;
/// Fewer runs share a driver or a day.
const LEAST_RUNS: usize = 4;
/// k of described gradients is within this of 1 ...
const NEAR: f64 = 0.15;
/// ... by so many standard deviations less; and it is not by so many more.
const SURE: f64 = 2.0;
const SURELY_NOT: f64 = 3.0;
/// Where less of the slopes is seen, they are those of another place or line; as much with the other sign is that.
/// Judgement.
const LEAST_STEEP: f64 = 0.4;
/// And the accelerations scatter by less than this share of what they do as described; else errors are small.
/// Judgement.
const LEAST_SHARPER: f64 = 0.95;
/// Efforts that leave more of the accelerations unexplained than this are not known there, N/kg: of trains that power
/// on and off between two rows.
const MOST_SD_N_PER_KG: f64 = 0.025;
/// And a steepness that is off by more than this, and by [`SURELY_NOT`] standard deviations, is an error, too, where
/// readings hide the places. Judgement: right gradients leave up to 0.02 with momentary efforts every 10 s.
const LEAST_OFF: f64 = 0.02;
/// Errors of the gradients come again at their places by so many standard errors. Judgement: they only widen intervals.
const LEAST_Z: f64 = 2.0;
/// A resistance at places by so many more: it is one of every line.
const LEAST_Z_RESISTS: f64 = 3.0;
/// Smaller ones are those of the readings, N/kg: right gradients leave up to 0.0009.
const LEAST_SD_N_PER_KG: f64 = 0.001;

/// What efforts say of the gradients.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ByEfforts {
    /// Times as steep as described, k.
    pub(super) steep: Figure,
    /// Scatter of the accelerations with k, and as described, N/kg.
    pub(super) sds_n_per_kg: [f64; 2],
    /// What the described ones are off by at their places; none where that is nothing.
    pub(super) off: Option<Recurring>,
    /// What acts at places alike in both directions, and more than errors of slopes.
    pub(super) resists: Option<Recurring>,
    /// Force of the described climbs, root mean square, N/kg.
    pub(super) climbs_n_per_kg: f64,
    /// The train has another length than the described one.
    pub(super) length: Option<OtherLength>,
    /// Locations are not the same in all runs.
    pub(super) locations: Option<OffFromRunToRun>,
    /// Way over which a run sees them at a place, m.
    pub(super) mean_way_m: f64,
    /// Windows, and runs that they are of.
    pub(super) windows: usize,
    runs: usize,
}

impl ByEfforts {
    /// The described gradients are those that the efforts need.
    pub(super) fn vouch(&self) -> bool {
        (self.steep.value - 1.0).abs() + SURE * self.steep.sd < NEAR
    }

    /// They surely need others: so many times as steep, with the sign turned, or those of another place or line.
    pub(super) fn other_steepness(&self, train: &Train) -> Option<Doubt> {
        let [sd, described] = self.sds_n_per_kg;
        let better = match self.steep.value {
            k if k > LEAST_STEEP => Version::Times(k),
            k if k < -LEAST_STEEP => Version::SignTurned,
            _ => Version::Level,
        };
        let matters = sd < LEAST_SHARPER * described;
        (self.surely_off() > NEAR && matters && self.runs >= LEAST_RUNS).then(|| Doubt {
            better,
            seen_by: SeenBy::Efforts,
            sd_n_per_kg: sd,
            described_sd_n_per_kg: described,
            log_likelihood: None,
            z: self.steep.away_from(1.0),
            stretches: self.windows,
            off_permille: self.as_steep(train).sd_permille,
        })
    }

    /// How far the gradients are off at their places, or all of them; none where that is nothing.
    pub(super) fn small_errors(&self, train: &Train) -> Option<SmallErrors> {
        let seen_by = SeenBy::Efforts;
        let at_places = self.off.map(|off| SmallErrors {
            sd_permille: off_by_place_permille(off.sd_n_per_kg, self.mean_way_m, train),
            seen_by,
            follows: None,
        });
        let is_off = self.surely_off() > 0.0 && (self.steep.value - 1.0).abs() > LEAST_OFF;
        let steepness = is_off.then(|| self.as_steep(train));
        let length = self.length.map(|length| SmallErrors::of_length(length, seen_by, train));
        let locations = self.locations.map(|off| SmallErrors::of_locations(off, seen_by, train));
        SmallErrors::largest([at_places, steepness, length, locations])
    }

    /// By how much k is off at least.
    fn surely_off(&self) -> f64 {
        (self.steep.value - 1.0).abs() - SURELY_NOT * self.steep.sd
    }

    fn as_steep(&self, train: &Train) -> SmallErrors {
        SmallErrors::of_steepness(self.steep, self.climbs_n_per_kg, SeenBy::Efforts, train)
    }
}

/// Of all windows; nothing from too few. Whether the efforts are means or of the moment is what explains more, and how
/// much it matters is a part of the doubt: drivers change them with the slope.
pub(super) fn read(windows: &[Driven], train: &Train, track: &Track) -> Option<ByEfforts> {
    if windows.len() < LEAST_WINDOWS {
        return None;
    }
    let climbs: Vec<f64> = windows.iter().map(|window| window.climb_n_per_kg(train, track)).collect();
    let [means, moments] = [read_as(0, windows, &climbs)?, read_as(1, windows, &climbs)?];
    let apart = means.0.steep.value - moments.0.steep.value;
    let which = usize::from(moments.0.sds_n_per_kg[0] < means.0.sds_n_per_kg[0]);
    let (better, left_mps2) = if which == 1 { moments } else { means };
    let steep = Figure { sd: better.steep.sd.hypot(0.5 * apart), ..better.steep };
    (better.sds_n_per_kg[0] < MOST_SD_N_PER_KG).then(|| {
        let length = length::by_efforts(which, windows, train, track);
        let locations = locations::by_efforts(windows, &left_mps2, train, track);
        // What a length that is off leaves at a place is alike in both directions, too.
        let resists = better.resists.filter(|_| length.is_none() && locations.is_none());
        ByEfforts { steep, length, locations, resists, ..better }
    })
}

/// With one of the two efforts, and what it leaves of the accelerations; `climbs_n_per_kg`: of each window. Length and
/// locations are not asked yet.
fn read_as(which: usize, windows: &[Driven], climbs_n_per_kg: &[f64]) -> Option<(ByEfforts, Vec<f64>)> {
    let others = |window: &Driven| {
        let v = window.speed_mps;
        [window.efforts_n_per_kg[which], 1.0, v, v * v]
    };
    let freely = windows.iter().zip(climbs_n_per_kg).map(|(window, climb)| {
        let [u, one, v, squared] = others(window);
        (SVector::from([-climb, u, one, v, squared]), window.acceleration_mps2)
    });
    let freely: Vec<(SVector<f64, 5>, f64)> = freely.collect();
    let (beta, inverse, left) = least_squares(&freely)?;
    let steep = first_over_places(&freely, windows.iter().map(|window| window.fronts_m), (&beta, &inverse))?;
    let described = windows.iter().zip(climbs_n_per_kg);
    let described = described.map(|(window, climb)| (SVector::from(others(window)), window.acceleration_mps2 + climb));
    let described: Vec<(SVector<f64, 4>, f64)> = described.collect();
    let (gamma, ..) = least_squares(&described)?;
    let residuals: Vec<f64> = described.iter().map(|(x, y)| y - x.dot(&gamma)).collect();
    let recurring = |along: fn(Direction) -> f64| {
        let of_run = |(window, residual): (&Driven, &f64)| Leaves {
            cell: places::cell(window.fronts_m),
            run: window.run,
            share: 1.0,
            residual: along(window.direction) * residual,
        };
        let found = places::recurring(windows.iter().zip(&residuals).map(of_run));
        found.filter(|off| off.z > LEAST_Z && off.sd_n_per_kg > LEAST_SD_N_PER_KG)
    };
    let (off, resists) = (recurring(Direction::sign), recurring(|_| 1.0));
    let is_other = |resists: &Recurring| {
        resists.z > LEAST_Z_RESISTS && off.is_none_or(|off| off.sd_n_per_kg < resists.sd_n_per_kg)
    };
    let left_mps2: Vec<f64> = freely.iter().map(|(x, y)| y - x.dot(&beta)).collect();
    let sds_n_per_kg = [(left / freely.len() as f64).sqrt(), rms(&residuals)];
    let found = ByEfforts {
        steep,
        sds_n_per_kg,
        off,
        resists: resists.filter(is_other),
        // All windows of a run at a place are one.
        mean_way_m: mean_of(windows.iter().map(|window| window.way_m)).max(places::PLACE_M),
        climbs_n_per_kg: rms(climbs_n_per_kg),
        length: None,
        locations: None,
        windows: windows.len(),
        runs: windows.iter().map(|window| window.run).collect::<BTreeSet<usize>>().len(),
    };
    Some((found, left_mps2))
}

#[cfg(test)]
mod tests {
    use super::super::answer::{FOLLOWS_SLOPES, Follows};
    use super::*;
    use crate::effort::driven::climb_n_per_kg;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use rundown::model::track::Gradient;
    use rundown::model::train::TrainDescription;

    /// 40 km of slopes, so many times as steep, each off by so many permille in turn.
    fn track(steep: f64, off_permille: f64) -> Track {
        let permille = |i: u32| steep * (f64::from(i * 7 % 11) - 5.0) + off_permille * (f64::from(i * 5 % 3) - 1.0);
        let gradient = |i: u32| Gradient { from_m: 1000.0 * f64::from(i), permille: permille(i) };
        Track::try_new(40_000.0, (0..40).map(gradient)).unwrap()
    }

    fn train() -> Train {
        Train::try_new(TrainDescription::CASE_STUDY).unwrap()
    }

    /// What drivers of ten runs, there and back, who hold the speed roughly do on slopes as described, seconds late.
    fn driven(noise_n_per_kg: f64) -> Vec<Driven> {
        let (mut rng, track, train) = (ChaCha8Rng::seed_from_u64(3), track(1.0, 0.0), train());
        let window = |i: u32| {
            let run = i as usize / 150;
            let direction = if run.is_multiple_of(2) { Direction::Up } else { Direction::Down };
            let at_m = f64::from(i * 150 % 39_000) + 400.0;
            let fronts = |at_m: f64| [-150.0, 150.0].map(|by_m| at_m + direction.sign() * by_m);
            let climb = |at_m: f64| climb_n_per_kg(fronts(at_m), 300.0, direction, train.length_m(), (&train, &track));
            let effort_n_per_kg = 0.02 + climb(at_m - direction.sign() * 300.0) + rng.random_range(-0.02..0.02);
            let resistance = 0.01 + 2e-5 * 900.0 + climb(at_m);
            let noise = rng.random_range(-1.0..1.0) * noise_n_per_kg;
            Driven {
                fronts_m: fronts(at_m),
                way_m: 300.0,
                direction,
                run,
                speed_mps: 30.0 + rng.random_range(-5.0..5.0),
                acceleration_mps2: 1.03 * effort_n_per_kg - resistance + noise,
                efforts_n_per_kg: [effort_n_per_kg; 2],
            }
        };
        (0..1500).map(window).collect()
    }

    fn said(described: &Track) -> ByEfforts {
        read(&driven(0.01), &train(), described).unwrap()
    }

    #[test]
    fn efforts_vouch_for_the_slopes_that_they_go_over_and_for_no_others() {
        let right = said(&track(1.0, 0.0));
        assert!(right.vouch() && right.other_steepness(&train()).is_none(), "{right:?}");
        assert_eq!(right.small_errors(&train()), None);
        for steep in [-1.0, 0.1, 0.5, 0.8, 1.3, 2.0] {
            assert!(!said(&track(steep, 0.0)).vouch(), "{steep}");
        }
    }

    #[test]
    fn slopes_with_another_steepness_are_denied_with_it_and_with_what_they_are_off_by() {
        for steep in [0.5, 0.75, 1.3, 2.0] {
            let doubt = said(&track(steep, 0.0)).other_steepness(&train()).unwrap();
            let times = doubt.better.times().unwrap();
            assert!((times * steep - 1.0).abs() < 0.03, "{steep}: {doubt:?}");
            // As described they have a root mean square of 3.2 permille times that; seen over a window and a train a
            // little less.
            let off_permille = FOLLOWS_SLOPES * (times - 1.0).abs() * 3.2 * steep;
            assert!((0.8..1.0).contains(&(doubt.off_permille / off_permille)), "{off_permille}: {doubt:?}");
        }
    }

    #[test]
    fn errors_at_places_are_found_as_large_as_they_are() {
        // -0.8, 0 and 0.8 permille in turn.
        let off_permille = said(&track(1.0, 0.8)).small_errors(&train()).unwrap().sd_permille;
        assert!((0.5..0.9).contains(&off_permille), "{off_permille}");
        // A tenth too flat, which comes out at no single place.
        let flat = ByEfforts { off: None, ..said(&track(0.9, 0.0)) };
        let small = flat.small_errors(&train()).unwrap();
        assert!((0.5..0.7).contains(&small.sd_permille) && flat.other_steepness(&train()).is_none());
    }

    #[test]
    fn a_train_that_is_described_with_another_length_is_found_by_the_slopes_that_it_reaches_over() {
        for times in [0.5, 1.6, 2.5] {
            let length_m = times * train().length_m();
            let described = Train::try_new(TrainDescription { length_m, ..TrainDescription::CASE_STUDY }).unwrap();
            let small = read(&driven(0.01), &described, &track(1.0, 0.0)).unwrap().small_errors(&described).unwrap();
            let Some(Follows::Length(found)) = small.follows else { panic!("{times}: {small:?}") };
            assert!((found.value * times - 1.0).abs() < 0.15, "{times}: {small:?}");
        }
    }

    #[test]
    fn locations_that_are_off_from_run_to_run_are_seen_and_a_chainage_that_begins_elsewhere_is_none() {
        let follows = |off_m: fn(usize) -> f64| {
            let windows: Vec<Driven> =
                driven(0.005).into_iter().map(|window| window.moved(off_m(window.run))).collect();
            read(&windows, &train(), &track(1.0, 0.0)).unwrap().small_errors(&train()).and_then(|small| small.follows)
        };
        // 60 m up and down the line in turn.
        let Some(Follows::Locations(metres)) = follows(|run| if run % 4 < 2 { 60.0 } else { -60.0 }) else {
            panic!("{:?}", follows(|run| if run % 4 < 2 { 60.0 } else { -60.0 }))
        };
        assert!((40.0..90.0).contains(&metres.value), "{metres:?}");
        assert!(!matches!(follows(|_| 60.0), Some(Follows::Locations(_))));
        assert_eq!(follows(|_| 0.0), None);
    }

    #[test]
    fn a_resistance_at_places_alike_in_both_directions_is_no_error_of_the_slopes() {
        let with_curves = |resistance_n_per_kg: f64| {
            let mut windows = driven(0.005);
            for window in &mut windows {
                let is_curved = places::cell(window.fronts_m).rem_euclid(6) == 0;
                window.acceleration_mps2 -= if is_curved { resistance_n_per_kg } else { 0.0 };
            }
            read(&windows, &train(), &track(1.0, 0.0)).unwrap()
        };
        // Of a sixth of the line: 0.37 times as much is the standard deviation.
        let resists = with_curves(0.012).resists.unwrap();
        assert!((0.003..0.006).contains(&resists.sd_n_per_kg), "{resists:?}");
        assert_eq!(with_curves(0.0).resists, None);
        assert_eq!(said(&track(1.0, 0.8)).resists, None);
    }

    #[test]
    fn efforts_that_do_not_explain_the_accelerations_and_a_few_say_nothing() {
        let right = track(1.0, 0.0);
        assert_eq!(read(&driven(0.06), &train(), &right), None);
        assert_eq!(read(&driven(0.01)[..LEAST_WINDOWS - 1], &train(), &right), None);
        let near = |window: &Driven| window.fronts_m[0].max(window.fronts_m[1]) < 9000.0;
        let at_few_places: Vec<Driven> = driven(0.01).into_iter().filter(near).collect();
        assert!(at_few_places.len() > LEAST_WINDOWS, "{}", at_few_places.len());
        assert_eq!(read(&at_few_places, &train(), &right), None);
    }

    #[test]
    fn slopes_with_the_sign_turned_and_those_of_another_line_are_denied_as_that() {
        let denied = |track: &Track| said(track).other_steepness(&train()).map(|doubt| doubt.better);
        assert_eq!(denied(&track(-1.0, 0.0)), Some(Version::SignTurned));
        let other = |i: u32| Gradient { from_m: 1000.0 * f64::from(i), permille: f64::from(i * 4 % 9) - 4.0 };
        let other = Track::try_new(40_000.0, (0..40).map(other)).unwrap();
        assert_eq!(denied(&other), Some(Version::Level));
    }
}
