use super::*;
extern crate std;
use crate::model::state::resistance_sd;
use crate::tick::effort_reading::EffortReading;
use crate::tick::snapshot::InPlace as _;
use nalgebra::{Matrix4, Vector4};

/// Reported standard deviation of r(100 km/h) after runs that each tell the coefficients with a standard deviation
/// of such a share, with a share of the track in it, and coasts that scatter so far.
fn sd_after(runs: &[Real], track_share: Real, squares: Real) -> Real {
    let config = MemoryConfig { drift_sd: 0.0, ..MemoryConfig::default() };
    let mut vehicle = Vehicle::new(&config, Davis { r0: 7.38e-3, r1: 1.6e-4, r2: 2.8e-5 });
    let trust = Trust { coasts: 10.0, squares, ..Trust::NONE };
    let run = Foresight { trust, track_share: 10.0 * track_share, ..Foresight::NONE };
    for sd in runs {
        let begin = vehicle.constants(&config, 0.03);
        let mut end = begin;
        let unit = Vector4::new(1.0 / 7.38e-3, 1.0 / 1.6e-4, 1.0 / 2.8e-5, 0.0);
        let before = begin.covariance.try_inverse().unwrap();
        end.covariance = (before + Matrix4::from_diagonal(&unit.map(|u| u * u / (sd * sd)))).try_inverse().unwrap();
        vehicle.learn(&config, [&begin, &end], Column::default(), &run, 0.0);
    }
    assert_eq!(vehicle.runs() as usize, runs.len());
    resistance_sd(&vehicle.davis(), 100.0 / 3.6)
}

/// A vehicle with the column's gain after so many runs, each of which tells the coefficients with this standard
/// deviation, shares, if the gain is 1: where it is `1 + x`, all seem `10 x` larger. The truth is 1.1 of the
/// description, and the gain 1.
fn after_runs_by_effort(runs: usize, sd: Real) -> Vehicle {
    let config = MemoryConfig { drift_sd: 0.0, ..MemoryConfig::default() };
    let mut vehicle = Vehicle::new(&config, Davis { r0: 7.38e-3, r1: 1.6e-4, r2: 2.8e-5 });
    let unit = [1.0 / 7.38e-3, 1.0 / 1.6e-4, 1.0 / 2.8e-5];
    // What each coefficient less ten times the gain is, shares.
    let seen = Matrix4::from_fn(|row, column| match (row, column) {
        (3, _) => 0.0,
        (_, 3) => -10.0 / sd,
        (row, column) if row == column => unit[row] / sd,
        _ => 0.0,
    });
    let told = Vector4::new(-8.9 / sd, -8.9 / sd, -8.9 / sd, 0.0);
    for _ in 0..runs {
        let begin = vehicle.constants(&config, 0.03);
        let before = begin.covariance.try_inverse().unwrap();
        let covariance = (before + seen.transpose() * seen).try_inverse().unwrap();
        let end = Gaussian { mean: covariance * (before * begin.mean + seen.transpose() * told), covariance };
        let column = Column::of_run((end.mean[3], end.sd(3)), &EffortReading::ZEROED);
        vehicle.learn(&config, [&begin, &end], column, &Foresight::NONE, 0.0);
        vehicle.column = column;
    }
    vehicle
}

#[test]
fn a_gain_that_is_not_known_leaves_its_doubt_in_the_resistance_of_any_number_of_runs() {
    let sd = |runs| after_runs_by_effort(runs, 0.1).davis().sd(0) / 7.38e-3;
    let (one, many) = (sd(1), sd(60));
    // What the runs tell is the gain, by the description, and the resistance under it: 15 % of three coefficients
    // that are 15 % off each.
    assert!(one > 0.1 && many > 0.4 * one, "{one} {many}");
    let (few, all) = (after_runs_by_effort(10, 0.1), after_runs_by_effort(60, 0.1));
    let moved = (all.davis().mean - few.davis().mean).component_div(&few.davis().mean).amax();
    assert!(moved < few.davis().sd(0) / 7.38e-3, "{moved}");
}

/// Nobody knows yet how windy the line is.
#[test]
fn what_a_single_run_taught_is_doubted_by_the_wind_that_is_set() {
    let (config, v) = (MemoryConfig::default(), 140.0 / 3.6);
    // Each run tells r at one speed, as described.
    let tells = Vector4::new(1.0, v, v * v, 0.0) / 1e-5;
    let after = |runs: usize| {
        let mut vehicle = Vehicle::new(&config, Davis { r0: 7.38e-3, r1: 1.6e-4, r2: 2.8e-5 });
        for _ in 0..runs {
            let begin = vehicle.constants(&config, 0.03);
            let before = begin.covariance.try_inverse().unwrap();
            let covariance = (before + tells * tells.transpose()).try_inverse().unwrap();
            let end = Gaussian { mean: begin.mean, covariance };
            vehicle.learn(&config, [&begin, &end], Column::default(), &Foresight::NONE, 0.0);
        }
        resistance_sd(&vehicle.davis(), v)
    };
    let by_wind = 2.0 * 2.8e-5 * v * config.wind_sd_mps;
    assert!((0.7..1.0).contains(&(after(1) / by_wind)), "{}", after(1) / by_wind);
    assert!(after(30) < 0.1 * after(1), "{}", after(30) / by_wind);
}

#[test]
fn runs_over_a_doubtful_track_say_no_more_than_one() {
    let (one, exact, doubtful) =
        (sd_after(&[0.05], 0.0, 0.0), sd_after(&[0.05; 50], 0.0, 0.0), sd_after(&[0.05; 50], 1.0, 0.0));
    assert!(exact < 0.3 * one, "{exact} {one}");
    assert!((doubtful / one - 1.0).abs() < 0.2, "{doubtful} {one}");
    let half = sd_after(&[0.05; 50], 0.5, 0.0);
    assert!(exact < half && half < doubtful);
}

#[test]
fn a_poor_run_over_a_doubtful_track_does_not_erase_rich_ones() {
    let (rich, then_poor) =
        (sd_after(&[0.05; 20], 1.0, 0.0), sd_after(&[[0.05; 20].as_slice(), &[0.5]].concat(), 1.0, 0.0));
    assert!(then_poor < 1.02 * rich, "{then_poor} {rich}");
}

#[test]
fn coasts_that_scatter_count_for_less() {
    let (expected, scattered) = (sd_after(&[0.05; 20], 0.0, 10.0), sd_after(&[0.05; 20], 0.0, 90.0));
    assert!(scattered > 1.5 * expected, "{scattered} {expected}");
}

#[test]
fn short_hops_keep_a_doubt_that_no_number_of_runs_averages_away() {
    let config = MemoryConfig::default();
    let after = |shares: &[Real]| {
        let mut vehicle = Vehicle::new(&config, Davis { r0: 7.38e-3, r1: 1.6e-4, r2: 2.8e-5 });
        for share in shares {
            let begin = vehicle.constants(&config, 0.03);
            let mut end = begin;
            end.covariance *= 0.1;
            vehicle.learn(&config, [&begin, &end], Column::default(), &Foresight::NONE, *share);
        }
        vehicle
    };
    let sd_share = |vehicle: &Vehicle| {
        let (found, v) = (vehicle.davis(), 60.0 / 3.6);
        resistance_sd(&found, v) / found.mean.dot(&Vector3::new(1.0, v, v * v))
    };
    let hops = [1.0; 40];
    let [on_hops, mixed, on_lines] =
        [&hops[..], &[1.0, 0.0].repeat(20), &[0.0; 40]].map(|shares| sd_share(&after(shares)));
    assert!(on_lines < 0.01 && (0.05..0.055).contains(&on_hops), "{on_lines} {on_hops}");
    assert!((0.02..0.04).contains(&mixed), "{mixed}");
    // It goes as other runs come, and says nothing about the next run's beginning.
    assert!(sd_share(&after(&[hops.as_slice(), &[0.0; 100]].concat())) < 0.012);
    let begins = |shares: &[Real]| after(shares).next_run(&config);
    assert_eq!(begins(&hops), begins(&[0.0; 40]));
}

/// Standard deviation of r(v), share, that short hops leave after runs of so many coasts each, with speeds in
/// tenths of a km/h (share below zero) or in whole ones.
fn hops_sd(share: Real, coasts: Real, squares: Real, runs: usize) -> Real {
    let config = MemoryConfig::default();
    let mut vehicle = Vehicle::new(&config, Davis { r0: 7.38e-3, r1: 1.6e-4, r2: 2.8e-5 });
    let trust = Trust { coasts, squares, ..Trust::NONE };
    for _ in 0..runs {
        let begin = vehicle.constants(&config, 0.03);
        let mut end = begin;
        end.covariance *= 0.1;
        vehicle.learn(&config, [&begin, &end], Column::default(), &Foresight { trust, ..Foresight::NONE }, share);
    }
    assert!((vehicle.hops_share() - share.abs()).abs() < 1e-6);
    vehicle.hops_sd()
}

#[test]
fn what_fine_speeds_taught_is_doubted_by_the_number_of_coasts_and_their_scatter() {
    let (few, some, many) = (hops_sd(-1.0, 1.0, 1.0, 20), hops_sd(-1.0, 4.0, 4.0, 20), hops_sd(-1.0, 8.0, 8.0, 67));
    assert!(few > 0.14, "{few}: a speed that is held now and then");
    assert!((0.03..0.05).contains(&some) && (0.014..0.016).contains(&many), "{some} {many}");
    assert!(hops_sd(-1.0, 8.0, 40.0, 67) > 4.0 * many);
    assert_eq!(hops_sd(-0.5, 8.0, 8.0, 67), 0.5 * many);
    assert!((hops_sd(1.0, 8.0, 8.0, 67) - SHORT_HOPS_SD).abs() < 1e-6, "whole km/h hide what a coast began with");
}

#[test]
fn before_the_first_run_ends_its_own_share_of_short_hops_counts() {
    let config = MemoryConfig::default();
    let vehicle = Vehicle::new(&config, Davis { r0: 7.38e-3, r1: 1.6e-4, r2: 2.8e-5 });
    let mut found = Gaussian::independent([7e-3, 2e-4, 3e-5], [0.0; 3]);
    vehicle.widen(&mut found, 1.0);
    let v = 30.0;
    let r = found.mean.dot(&Vector3::new(1.0, v, v * v));
    assert!((resistance_sd(&found, v) / r - SHORT_HOPS_SD).abs() < 1e-12);
}
