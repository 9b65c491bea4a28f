//! Final coast and final brake, section 3.3.
//!
//! In: the switching points up to the last standstill, where the train still is, and the top speed since the stop
//! before it. Out: two [`Phase`]s.
//!
//! - The final brake begins with the first brake application by which the train leaves line speed, and ends where the
//!   train stands. A 40 km/h zone before the platform is inside it: brake to 40 km/h, holding or coasting there, brake
//!   to the platform. What is done at less than `approach_share` of the top speed does not begin a new final brake, it
//!   continues the one before. A brake at line speed after which the train coasts on is not final.
//! - The final coast is the coasting from which this brake begins; cruising may lie between them, traction may not.

use super::{Phase, SwitchingPoint};
use crate::Real;
use crate::extremes::Extremes;
use crate::tick::regime::Regime;

/// Final coast and final brake, of so many switching points. None before the train has stood after a brake, and none
/// where it `is_there` no more.
pub(super) fn final_phases<'a>(
    points: usize,
    at: impl Fn(usize) -> Option<&'a SwitchingPoint>,
    is_there: impl Fn(&SwitchingPoint) -> bool,
    line_speed_mps: Real,
) -> (Option<Phase>, Option<Phase>) {
    let backwards = |from: usize| (0..from).rev().filter_map(|i| Some((i, at(i)?)));
    let last_stop = backwards(points).find(|(_, point)| point.to == Regime::Standstill);
    let Some((stop, end)) = last_stop.filter(|(_, point)| is_there(point)) else {
        return (None, None);
    };
    let mut brake = None;
    for (i, point) in backwards(stop) {
        if point.to == Regime::Standstill {
            break;
        }
        if point.to == Regime::Brake {
            brake = Some((i, point));
        }
        if point.speed_mps > line_speed_mps {
            break;
        }
    }
    let Some((brake, start)) = brake else {
        return (None, None);
    };
    let coast = backwards(brake)
        .find(|(_, point)| point.to != Regime::Cruise)
        .filter(|(_, point)| point.to == Regime::Coast)
        .and_then(|(i, point)| Some(phase(point, at(i + 1)?)));
    (coast, Some(phase(start, end)))
}

fn phase(start: &SwitchingPoint, end: &SwitchingPoint) -> Phase {
    Phase {
        start_time_s: start.time_s,
        start_location_m: start.location_m,
        start_speed_mps: start.speed_mps,
        duration_s: (end.time_s - start.time_s).at_least(0.0),
        length_m: (end.location_m - start.location_m).abs(),
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use Regime::{Brake, Coast, Cruise, Standstill, Traction};

    fn starts(rows: &[(Regime, Real)]) -> (Option<Real>, Option<Real>) {
        let mut from = Standstill;
        let mut points = std::vec::Vec::new();
        for (k, &(to, kmh)) in rows.iter().enumerate() {
            let time_s = 100.0 * k as Real;
            points.push(SwitchingPoint { time_s, location_m: 0.0, speed_mps: kmh / 3.6, from, to });
            from = to;
        }
        let (coast, brake) = final_phases(points.len(), |i| points.get(i), |_| true, 70.0 / 3.6);
        (coast.map(|phase| phase.start_time_s), brake.map(|phase| phase.start_time_s))
    }

    #[test]
    fn coast_then_brake_then_stop() {
        let rows = [(Traction, 0.0), (Cruise, 140.0), (Coast, 140.0), (Brake, 80.0), (Standstill, 0.0)];
        assert_eq!(starts(&rows), (Some(200.0), Some(300.0)));
        assert_eq!(starts(&rows[..4]), (None, None));
    }

    #[test]
    fn the_zone_before_the_platform_is_part_of_the_final_brake() {
        let rows = [
            (Traction, 0.0),
            (Coast, 140.0),
            (Brake, 80.0),
            (Cruise, 40.0),
            (Coast, 40.0),
            (Traction, 35.0),
            (Coast, 42.0),
            (Brake, 41.0),
            (Coast, 5.0),
            (Standstill, 0.0),
        ];
        assert_eq!(starts(&rows), (Some(100.0), Some(200.0)));
        let from_below =
            [(Traction, 0.0), (Coast, 140.0), (Brake, 65.0), (Coast, 40.0), (Brake, 38.0), (Standstill, 0.0)];
        assert_eq!(starts(&from_below), (Some(100.0), Some(200.0)));
    }

    #[test]
    fn a_brake_at_line_speed_is_not_final() {
        let rows = [(Traction, 0.0), (Coast, 140.0), (Brake, 120.0), (Coast, 110.0), (Brake, 80.0), (Standstill, 0.0)];
        assert_eq!(starts(&rows), (Some(300.0), Some(400.0)));
    }

    #[test]
    fn a_brake_out_of_traction_has_no_final_coast() {
        let rows = [(Traction, 0.0), (Coast, 140.0), (Traction, 90.0), (Brake, 130.0), (Standstill, 0.0)];
        assert_eq!(starts(&rows), (None, Some(300.0)));
        let held = [(Traction, 0.0), (Coast, 140.0), (Cruise, 80.0), (Brake, 80.0), (Standstill, 0.0)];
        assert_eq!(starts(&held), (Some(100.0), Some(300.0)));
    }

    #[test]
    fn an_earlier_stop_is_another_run_section() {
        let rows =
            [(Coast, 140.0), (Brake, 80.0), (Standstill, 0.0), (Traction, 0.0), (Brake, 60.0), (Standstill, 0.0)];
        assert_eq!(starts(&rows), (None, Some(400.0)));
    }
}
