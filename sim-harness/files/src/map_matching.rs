//! Latitude and longitude onto the track's centre line.
//!
//! In: fixes in the order of time. Out: distance along the track, or the reason why there is none.
//!
//! Each fix is projected on the nearest segment, in a plane that touches the ellipsoid there. "Nearest" is searched
//! only where the train can have got to since the last match, so that a line that comes near itself (a loop, a hairpin)
//! does not throw it about. A fix farther from the line than [`MAX_DISTANCE_M`] gives no location: it is counted, never
//! guessed. The first and last segments go on straight for as far as that, so a train that stands before the first
//! point has a location too.
//!
//! Assumes that the line does not cross the date line or a pole.

use crate::ellipsoid::metres_of_radian;
use crate::track_file::CentreLinePoint;
use std::ops::Range;

/// Farthest believable distance of a fix from the line, m: several times the error of a phone at a window seat.
pub const MAX_DISTANCE_M: f64 = 100.0;
/// Fastest believable travel along the line, m/s.
const MAX_SPEED_MPS: f64 = 120.0;
/// How far two neighbouring matches may lie apart beyond that, m.
const MATCH_ERROR_M: f64 = 2.0 * MAX_DISTANCE_M;

/// The centre line of a track, ready for matching.
#[derive(Clone, Debug)]
pub struct CentreLine {
    segments: Vec<Segment>,
}

/// What is remembered from fix to fix.
#[derive(Clone, Copy, Debug, Default)]
pub struct MatchState {
    last: Option<(f64, f64)>,
}

/// Where a fix lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Match {
    /// Distance along the track, m.
    pub location_m: f64,
    /// Distance from the line, m.
    pub distance_m: f64,
}

/// Why a fix gave no location.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum NoMatch {
    /// Latitude or longitude is missing.
    NotSent,
    /// Latitude or longitude is no place on Earth.
    OutOfRange,
    /// Farther from the line than [`MAX_DISTANCE_M`], where the train can have got to.
    OffTheLine,
}

impl NoMatch {
    /// All reasons.
    pub const ALL: [Self; 3] = [Self::NotSent, Self::OutOfRange, Self::OffTheLine];

    /// The word used in every output.
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::NotSent => "not_sent",
            Self::OutOfRange => "out_of_range",
            Self::OffTheLine => "off_the_line",
        }
    }
}

#[derive(Clone, Copy, Debug)]
struct Segment {
    from: CentreLinePoint,
    to_at_m: f64,
    /// Metres for each degree, north and east, at the segment.
    scale: (f64, f64),
    /// The segment in the plane, north and east, m.
    along: (f64, f64),
}

impl CentreLine {
    /// None when there are fewer than two points. The points must be sorted by `at_m`, as [`crate::track_file`] checks.
    ///
    /// ```
    /// use rundown_files::map_matching::{CentreLine, MatchState};
    /// use rundown_files::track_file::CentreLinePoint;
    ///
    /// let point = |at_m, latitude_deg| CentreLinePoint { at_m, latitude_deg, longitude_deg: 5.0 };
    /// let line = CentreLine::new(&[point(0.0, 51.0), point(1112.6, 51.01)]).unwrap();
    /// let fix = line.locate(&mut MatchState::default(), 0.0, Some(51.005), Some(5.001))?;
    /// assert!((fix.location_m - 556.3).abs() < 0.1);
    /// assert!((fix.distance_m - 70.2).abs() < 0.1);
    /// # Ok::<(), rundown_files::map_matching::NoMatch>(())
    /// ```
    pub fn new(points: &[CentreLinePoint]) -> Option<Self> {
        let segments: Vec<Segment> = points.windows(2).map(|pair| Segment::new(pair[0], pair[1])).collect();
        (!segments.is_empty()).then_some(Self { segments })
    }

    /// Locates one fix. A fix that gives no location leaves `state` as it was.
    ///
    /// # Errors
    /// [`NoMatch`] says why there is no location.
    pub fn locate(
        &self,
        state: &mut MatchState,
        time_s: f64,
        latitude_deg: Option<f64>,
        longitude_deg: Option<f64>,
    ) -> Result<Match, NoMatch> {
        let (Some(latitude_deg), Some(longitude_deg)) = (latitude_deg, longitude_deg) else {
            return Err(NoMatch::NotSent);
        };
        let on_earth = (-90.0..=90.0).contains(&latitude_deg) && (-180.0..=180.0).contains(&longitude_deg);
        if !on_earth {
            return Err(NoMatch::OutOfRange);
        }
        let found = self.segments[self.reachable(state, time_s)]
            .iter()
            .map(|segment| segment.project(latitude_deg, longitude_deg, self.is_end(segment)))
            .min_by(|a, b| a.distance_m.total_cmp(&b.distance_m))
            .filter(|found| found.distance_m <= MAX_DISTANCE_M)
            .ok_or(NoMatch::OffTheLine)?;
        state.last = Some((time_s, found.location_m));
        Ok(found)
    }

    /// Segments that the train can have reached since the last match.
    fn reachable(&self, state: &MatchState, time_s: f64) -> Range<usize> {
        let Some((last_s, last_m)) = state.last else {
            return 0..self.segments.len();
        };
        let reach_m = MAX_SPEED_MPS * (time_s - last_s).abs() + MATCH_ERROR_M;
        let begin = self.segments.partition_point(|segment| segment.to_at_m < last_m - reach_m);
        let end = self.segments.partition_point(|segment| segment.from.at_m <= last_m + reach_m);
        // Beyond an end of the line the end is what can be reached.
        let begin = begin.min(self.segments.len() - 1);
        begin..end.max(begin + 1)
    }

    /// The segment is the first one, the last one.
    fn is_end(&self, segment: &Segment) -> (bool, bool) {
        let is = |end: Option<&Segment>| end.is_some_and(|end| end.from.at_m == segment.from.at_m);
        (is(self.segments.first()), is(self.segments.last()))
    }
}

impl Segment {
    fn new(from: CentreLinePoint, to: CentreLinePoint) -> Self {
        let (meridian_m, parallel_m) = metres_of_radian(0.5 * (from.latitude_deg + to.latitude_deg));
        let scale = (meridian_m.to_radians(), parallel_m.to_radians());
        Self {
            from,
            to_at_m: to.at_m,
            scale,
            along: ((to.latitude_deg - from.latitude_deg) * scale.0, (to.longitude_deg - from.longitude_deg) * scale.1),
        }
    }

    fn project(&self, latitude_deg: f64, longitude_deg: f64, (is_first, is_last): (bool, bool)) -> Match {
        let north = (latitude_deg - self.from.latitude_deg) * self.scale.0;
        let east = (longitude_deg - self.from.longitude_deg) * self.scale.1;
        let squared = self.along.0 * self.along.0 + self.along.1 * self.along.1;
        // Two points at one place make a segment without direction; its beginning stands for it.
        let share = if squared > 0.0 { (north * self.along.0 + east * self.along.1) / squared } else { 0.0 };
        let beyond = MAX_DISTANCE_M / squared.sqrt().max(1.0);
        let least = if is_first { -beyond } else { 0.0 };
        let most = if is_last { 1.0 + beyond } else { 1.0 };
        let share = share.clamp(least, most);
        Match {
            location_m: self.from.at_m + share * (self.to_at_m - self.from.at_m),
            distance_m: (north - share * self.along.0).hypot(east - share * self.along.1),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A plane of metres around 51° north, 5° east.
    fn at(at_m: f64, north_m: f64, east_m: f64) -> CentreLinePoint {
        CentreLinePoint { at_m, latitude_deg: 51.0 + north_m / 111_257.0, longitude_deg: 5.0 + east_m / 70_197.0 }
    }

    /// 1 km north, 50 m east, 1 km back south: two legs 50 m apart.
    fn hairpin() -> CentreLine {
        CentreLine::new(&[at(0.0, 0.0, 0.0), at(1000.0, 1000.0, 0.0), at(1050.0, 1000.0, 50.0), at(2050.0, 0.0, 50.0)])
            .unwrap()
    }

    fn locate(
        line: &CentreLine,
        state: &mut MatchState,
        time_s: f64,
        north_m: f64,
        east_m: f64,
    ) -> Result<Match, NoMatch> {
        let fix = at(0.0, north_m, east_m);
        line.locate(state, time_s, Some(fix.latitude_deg), Some(fix.longitude_deg))
    }

    #[test]
    fn fix_is_projected_on_the_nearest_segment() {
        let found = locate(&hairpin(), &mut MatchState::default(), 0.0, 400.0, -20.0).unwrap();
        assert!((found.location_m - 400.0).abs() < 0.1, "{found:?}");
        assert!((found.distance_m - 20.0).abs() < 0.1, "{found:?}");
        let found = locate(&hairpin(), &mut MatchState::default(), 0.0, 400.0, 60.0).unwrap();
        assert!((found.location_m - 1650.0).abs() < 0.1, "{found:?}");
    }

    #[test]
    fn continuity_beats_distance_where_the_line_comes_near_itself() {
        let line = hairpin();
        let mut state = MatchState::default();
        locate(&line, &mut state, 0.0, 100.0, 0.0).unwrap();
        // 30 m aside: nearer to the leg back, which cannot be reached in 1 s.
        let found = locate(&line, &mut state, 1.0, 110.0, 30.0).unwrap();
        assert!((found.location_m - 110.0).abs() < 0.1, "{found:?}");
        // After a long silence the nearest leg counts again.
        let found = locate(&line, &mut state, 60.0, 110.0, 30.0).unwrap();
        assert!((found.location_m - 1940.0).abs() < 0.1, "{found:?}");
    }

    #[test]
    fn ends_go_on_straight_for_a_while() {
        let line = hairpin();
        let found = locate(&line, &mut MatchState::default(), 0.0, -60.0, 10.0).unwrap();
        assert!((found.location_m + 60.0).abs() < 0.1, "{found:?}");
        assert_eq!(locate(&line, &mut MatchState::default(), 0.0, -260.0, 10.0), Err(NoMatch::OffTheLine));
    }

    #[test]
    fn what_gives_no_location_says_why_and_changes_nothing() {
        let line = hairpin();
        let mut state = MatchState::default();
        locate(&line, &mut state, 0.0, 100.0, 0.0).unwrap();
        assert_eq!(line.locate(&mut state, 1.0, None, Some(5.0)), Err(NoMatch::NotSent));
        assert_eq!(line.locate(&mut state, 1.0, Some(f64::NAN), Some(5.0)), Err(NoMatch::OutOfRange));
        assert_eq!(line.locate(&mut state, 1.0, Some(0.0), Some(0.0)), Err(NoMatch::OffTheLine));
        let found = locate(&line, &mut state, 2.0, 120.0, 1.0).unwrap();
        assert!((found.location_m - 120.0).abs() < 0.1);
    }

    #[test]
    fn a_line_of_one_point_is_none() {
        assert!(CentreLine::new(&[at(0.0, 0.0, 0.0)]).is_none());
    }

    #[test]
    fn two_points_at_one_place_do_no_harm() {
        let line = CentreLine::new(&[at(0.0, 0.0, 0.0), at(5.0, 0.0, 0.0), at(105.0, 100.0, 0.0)]).unwrap();
        let found = locate(&line, &mut MatchState::default(), 0.0, 50.0, 0.0).unwrap();
        assert!((found.location_m - 55.0).abs() < 0.1, "{found:?}");
    }
}
