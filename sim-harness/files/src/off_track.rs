//! Locations of moving trains that are not on the described track: nothing is known of gradients there.

use crate::sample::Sample;
use crate::track_file::TrackFile;
use core::fmt;

/// A location may be this far beyond an end of the line, m: half a train, and the noise of a receiver.
pub const BEYOND_M: f64 = 300.0;

/// Slower is standing, m/s: a depot beside the line is no journey.
const MOVING_MPS: f64 = 2.0;

/// How many locations of moving trains are not on a track, and where they are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OffTrack {
    length_m: f64,
    beyond_m: f64,
    /// Locations off the track, and all.
    counts: [usize; 2],
    /// The least and the largest location, m.
    ends_m: [f64; 2],
}

impl OffTrack {
    /// Of no location yet.
    pub fn new(track: &TrackFile, beyond_m: f64) -> Self {
        Self { length_m: track.length_m, beyond_m, counts: [0; 2], ends_m: [f64::INFINITY, f64::NEG_INFINITY] }
    }

    /// Counts the rows of a run.
    pub fn add<'a>(&mut self, rows: impl IntoIterator<Item = &'a Sample>) {
        let line = -self.beyond_m..=self.length_m + self.beyond_m;
        for row in rows {
            let Some(at) = row.location_m.filter(|_| row.speed_mps.is_some_and(|v| v > MOVING_MPS)) else { continue };
            self.counts[1] += 1;
            self.counts[0] += usize::from(!line.contains(&at));
            self.ends_m = [self.ends_m[0].min(at), self.ends_m[1].max(at)];
        }
    }

    /// None where all are on the track.
    pub fn any(self) -> Option<Self> {
        (self.counts[0] > 0).then_some(self)
    }

    /// Share of the locations that are off the track.
    pub fn share(&self) -> f64 {
        self.counts[0] as f64 / self.counts[1].max(1) as f64
    }
}

impl fmt::Display for OffTrack {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ([off, all], [first_m, last_m]) = (self.counts, self.ends_m);
        write!(
            f,
            "{off} of {all} locations of moving trains ({:.0} %) are not on the described track: they go from {first_m:.0} to {last_m:.0} m, the track from 0 to {:.0} m. Nothing is known of gradients there; bring the runs onto its chainage with `rundown import --chainage align`, or describe the track from where their locations count, with its whole length_m",
            100.0 * self.share(),
            self.length_m
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn locations_of_moving_trains_beyond_the_ends_are_counted() {
        let track = TrackFile { length_m: 1000.0, ..TrackFile::default() };
        let row = |at, v| Sample { location_m: Some(at), speed_mps: Some(v), ..Sample::default() };
        let mut off = OffTrack::new(&track, 300.0);
        off.add(&[row(-200.0, 10.0), row(500.0, 10.0), row(1300.0, 10.0), row(5000.0, 0.0)]);
        assert_eq!(off.any(), None);
        off.add(&[row(1301.0, 10.0)]);
        assert_eq!(off.any().map(|off| off.share()), Some(0.25));
        let said = "1 of 4 locations of moving trains (25 %) are not on the described track: they go from -200 to 1301 m, the track from 0 to 1000 m.";
        assert!(off.to_string().starts_with(said), "{off}");
    }
}
