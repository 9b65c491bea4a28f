//! Locations of moving trains that are not on the described track: nothing is known of gradients there.

use crate::sample::Sample;
use crate::track_file::TrackFile;
use core::fmt;
use serde::Serialize;

/// A location may be this far beyond an end of the line, m: half a train, and the noise of a receiver.
pub const BEYOND_M: f64 = 300.0;

/// Slower is standing, m/s: a depot beside the line is no journey.
const MOVING_MPS: f64 = 2.0;

/// How many locations of moving trains are not on a track, and where they are.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct OffTrack {
    /// Locations off the track.
    off: usize,
    /// All of them.
    locations: usize,
    /// The least and the largest location, m.
    least_m: f64,
    most_m: f64,
    length_m: f64,
    #[serde(skip)]
    beyond_m: f64,
}

impl OffTrack {
    /// Of no location yet.
    pub fn new(track: &TrackFile, beyond_m: f64) -> Self {
        let (least_m, most_m) = (f64::INFINITY, f64::NEG_INFINITY);
        Self { off: 0, locations: 0, least_m, most_m, length_m: track.length_m, beyond_m }
    }

    fn is_off(&self, at_m: f64) -> bool {
        !(-self.beyond_m..=self.length_m + self.beyond_m).contains(&at_m)
    }

    /// Takes away what a run did beyond the line, where most of its way was on it: without gradients it would teach
    /// what is not so. Where most was not, the track is of another line, or counted otherwise. A row without a location
    /// is where the one before it was.
    pub fn leave_out(&self, rows: &mut Vec<Sample>) {
        let mut of_run = Self { off: 0, locations: 0, ..*self };
        of_run.add(&*rows);
        if of_run.off > 0 && 2 * of_run.off < of_run.locations {
            let mut is_off = false;
            rows.retain(|row| {
                is_off = row.location_m.map_or(is_off, |at_m| self.is_off(at_m));
                !is_off
            });
        }
    }

    /// Counts the rows of a run.
    pub fn add<'a>(&mut self, rows: impl IntoIterator<Item = &'a Sample>) {
        for row in rows {
            let Some(at) = row.location_m.filter(|_| row.speed_mps.is_some_and(|v| v > MOVING_MPS)) else { continue };
            self.locations += 1;
            self.off += usize::from(self.is_off(at));
            (self.least_m, self.most_m) = (self.least_m.min(at), self.most_m.max(at));
        }
    }

    /// None where all are on the track.
    pub fn any(self) -> Option<Self> {
        (self.off > 0).then_some(self)
    }

    /// Share of the locations that are off the track.
    pub fn share(&self) -> f64 {
        self.off as f64 / self.locations.max(1) as f64
    }
}

impl fmt::Display for OffTrack {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { off, locations, least_m, most_m, length_m, .. } = self;
        write!(
            f,
            "{off} of {locations} locations of moving trains ({:.0} %) are not on the described track: they go from {least_m:.0} to {most_m:.0} m, the track from 0 to {length_m:.0} m. Nothing is known of gradients there: a replay leaves them out, but for runs that are mostly there; bring the runs onto its chainage with `rundown import --chainage align`, or describe the track from where their locations count, with its whole length_m",
            100.0 * self.share(),
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
        // Locations are seldom, and at last it stands.
        let unread = Sample { speed_mps: Some(10.0), ..Sample::default() };
        let on = [row(500.0, 10.0), unread, unread, row(800.0, 10.0), row(900.0, 10.0), unread];
        let beyond =
            [row(1400.0, 10.0), unread, row(1500.0, 0.0), row(1500.0, 0.0), row(1500.0, 0.0), row(1500.0, 0.0)];
        let mut rows = [on, beyond].concat();
        off.leave_out(&mut rows);
        assert_eq!(rows, on);
        let other = vec![row(500.0, 10.0), unread, unread, row(1400.0, 10.0), unread];
        let mut rows = other.clone();
        off.leave_out(&mut rows);
        assert_eq!(rows, other, "half of its way is of another line");
        let said = "1 of 4 locations of moving trains (25 %) are not on the described track: they go from -200 to 1301 m, the track from 0 to 1000 m.";
        assert!(off.to_string().starts_with(said), "{off}");
    }
}
