//! Standstills where no station is.
//!
//! A station is where the track describes a stop, or where a fifth of the runs that come by stand, begin or end.

use super::{Cause, LEAST_OTHERS, Perturbation};
use crate::rows::profile::Profile;
use rundown_files::statistics::median;

/// A place is a station where such a share of the runs stops.
const STATION_SHARE: f64 = 0.2;
/// Trains miss a platform by up to 100 m, and signals stand nearer where stations do: this share of the usual way
/// between stops, within limits, m.
const NEAR_SHARE: f64 = 0.15;
const NEAR_M: [f64; 2] = [75.0, 300.0];

/// What is known of stations.
pub struct Stations<'a> {
    /// Described stops along the direction of travel, m.
    pub described_m: &'a [f64],
    /// How far from a station a train may stop, m.
    pub near_m: f64,
}

/// How far apart two trains may stop at one station, m.
pub fn near_m(profiles: &[Profile]) -> f64 {
    let mut hops_m: Vec<f64> = Vec::new();
    for profile in profiles {
        let [first_m, last_m] = profile.ends_m;
        let places: Vec<f64> =
            [first_m].into_iter().chain(profile.stands.iter().map(|stand| stand.at_m)).chain([last_m]).collect();
        hops_m.extend(places.windows(2).map(|pair| pair[1] - pair[0]));
    }
    let usual_m = median(hops_m).unwrap_or(0.0);
    let [least, most] = NEAR_M;
    (NEAR_SHARE * usual_m).clamp(least, most)
}

impl Stations<'_> {
    /// Stops of one run that are at no station; none where neither others nor a description can tell.
    pub fn unscheduled(&self, profiles: &[Profile], run: usize) -> Option<Vec<Perturbation>> {
        let profile = &profiles[run];
        let mut found = Vec::new();
        let along = profiles.iter().enumerate().filter(|(i, other)| *i != run && other.shares_way(profile));
        let is_known = along.count() >= LEAST_OTHERS;
        for stand in profile.stands.iter().filter(|stand| profile.passes(stand.at_m, self.near_m)) {
            if self.described_m.iter().any(|at_m| (at_m - stand.at_m).abs() <= NEAR_M[1]) {
                continue;
            }
            let others = || profiles.iter().enumerate().filter(|(i, _)| *i != run).map(|(_, other)| other);
            let reaching = || others().filter(|other| other.reaches(stand.at_m, self.near_m));
            let (passing, stopping) =
                (reaching().count(), reaching().filter(|other| other.calls_at(stand.at_m, self.near_m)).count());
            let few = ((stopping + 1) as f64) < STATION_SHARE * (passing + 1) as f64;
            if few && passing >= LEAST_OTHERS {
                found.push(Perturbation {
                    cause: Cause::UnscheduledStop,
                    from_m: stand.at_m,
                    to_m: stand.at_m,
                    duration_s: stand.duration_s,
                    speed_kmh: 0.0,
                    others_kmh: None,
                    others_stopping: stopping,
                    others: passing,
                });
            }
        }
        is_known.then_some(found)
    }
}

impl Profile {
    /// At least half of another run's way is on this one's, too.
    fn shares_way(&self, other: &Self) -> bool {
        let [begin_m, end_m] = other.ends_m;
        let shared_m = self.ends_m[1].min(end_m) - self.ends_m[0].max(begin_m);
        shared_m >= 0.5 * (end_m - begin_m)
    }

    /// The run comes by a place, or ends there.
    fn reaches(&self, at_m: f64, near_m: f64) -> bool {
        (self.ends_m[0] - near_m..=self.ends_m[1] + near_m).contains(&at_m)
    }
}
