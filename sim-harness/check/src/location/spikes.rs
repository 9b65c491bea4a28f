//! Spikes: a few wild locations between others that agree with each other.

use crate::figure::Figure;
use crate::finding::{Done, Finding, Kind};
use crate::rows::stuck::{StuckRows, is_beside};
use crate::rows::times;
use crate::rows::ways::{between, fastest_mps, heading, reaches};
use crate::rows::wild::wild;
use rundown_files::sample::Sample;

/// A location nearer to its neighbours is none of a spike, m.
const LEAST_SPIKE_M: f64 = 80.0;

/// Locations far from both neighbours, which agree with each other: left out. Beside speeds that stand still, `stuck`,
/// they seem to be.
pub(crate) fn leave_out(rows: &mut [Sample], stuck: &[StuckRows], findings: &mut Vec<Finding>) {
    let sign = heading(rows);
    let located: Vec<usize> = (0..rows.len()).filter(|i| rows[*i].location_m.is_some()).collect();
    let fastest_mps = fastest_mps(rows);
    let off_m = |a: usize, b: usize| {
        let [a, b] = [a, b].map(|i| &rows[i]);
        let step_m = b.location_m.unwrap_or_default() - a.location_m.unwrap_or_default();
        // Between rows far apart a train starts or stops, and runs another way than the mean of both speeds says.
        let reach = reaches(a, b, fastest_mps).filter(|_| b.time_s - a.time_s > times::MOST_MEAN_S);
        reach.map_or_else(
            || (step_m - sign * between(a, b)).abs(),
            |reach| {
                let way_m = sign * step_m;
                (reach.start() - way_m).max(way_m - reach.end()).max(0.0)
            },
        )
    };
    let found = wild(&located, |[before, first, last, after]| {
        if is_beside(stuck, [before, after]) {
            return None;
        }
        // Hardly any is, and most are asked no more than this.
        let first_m = off_m(before, first);
        if first_m <= LEAST_SPIKE_M {
            return None;
        }
        let least_m = first_m.min(off_m(last, after));
        (least_m > LEAST_SPIKE_M && least_m > 5.0 * off_m(before, after)).then_some(first_m)
    });
    if let Some((first, _)) = found.first() {
        let largest_m = found.iter().map(|(_, off)| *off).fold(0.0, f64::max);
        let (kind, figure) = (Kind::LocationSpikes, Figure { value: largest_m, sd: 0.0 });
        let (count, line) = (found.len(), rows[*first].line);
        findings.push(Finding { kind, figure, unit: "m", count, line, done: Done::LeftOut });
        found.iter().for_each(|(i, _)| rows[*i].location_m = None);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A start and a stop within 60 s at 0.6 m/s²: 229 m beside the mean of both speeds.
    #[test]
    fn starts_and_stops_between_rows_far_apart_make_no_location_wild() {
        let speed_mps = |second: f64| (0.6 * ((second % 400.0) - 50.0).min(350.0 - (second % 400.0))).clamp(0.0, 30.0);
        let log = |phase: usize| -> Vec<Sample> {
            let mut at_m = 0.0;
            let row = |second: usize| {
                let time_s = second as f64;
                at_m += speed_mps(time_s - 0.5);
                Sample { time_s, location_m: Some(at_m), speed_mps: Some(speed_mps(time_s)), ..Sample::default() }
            };
            (0..4000).map(row).skip(phase).step_by(60).collect()
        };
        for phase in [0, 13, 29, 47] {
            let (mut rows, mut findings) = (log(phase), Vec::new());
            leave_out(&mut rows, &[], &mut findings);
            assert_eq!(findings, [], "{phase}");
            rows[20].location_m = rows[20].location_m.map(|m| m + 4000.0);
            leave_out(&mut rows, &[], &mut findings);
            assert_eq!(findings.len(), 1, "{phase}");
        }
    }
}
