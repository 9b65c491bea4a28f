//! Tractive effort over speed, as other tools have it; here it is a largest effort and a largest power.
//!
//! ```text
//! F(v) = min(F_max, P_max / v)
//! ```

use rundown::model::units::KmPerHour;

/// Speeds of a written curve, km/h apart.
const STEP_KMH: f64 = 5.0;
/// A curve that differs from F(v) by less is one that follows it, written with few digits.
const ALIKE: f64 = 0.005;

/// Points of F(v) up to `max_speed_kmh`: speed in km/h, effort in N. Constant up to the speed where the power bounds
/// it.
pub(super) fn points(effort_n: f64, power_w: f64, max_speed_kmh: f64) -> Vec<(f64, f64)> {
    let knee_kmh = 3.6 * power_w / effort_n;
    let force_n = |kmh: f64| effort_n.min(power_w / KmPerHour(kmh).to_mps());
    let mut speeds_kmh = vec![0.0];
    if knee_kmh + 0.1 < max_speed_kmh {
        speeds_kmh.push(knee_kmh);
        // Not so near that both would be written as one speed.
        let first = ((knee_kmh + 0.1) / STEP_KMH).floor() as u32 + 1;
        let rounds = (first..).map(|i| STEP_KMH * f64::from(i));
        speeds_kmh.extend(rounds.take_while(|kmh| *kmh < max_speed_kmh));
    }
    speeds_kmh.push(max_speed_kmh);
    speeds_kmh.into_iter().map(|kmh| (kmh, force_n(kmh))).collect()
}

/// Largest effort, N, and power, W, of a curve read.
pub(super) struct Limits {
    pub effort_n: f64,
    pub power_w: f64,
    /// What they lack of the curve.
    pub note: Option<String>,
}

/// Of points in m/s and N. `None` without a point with both speed and effort.
pub(super) fn limits(points: &[(f64, f64)]) -> Option<Limits> {
    let largest = |value: fn(&(f64, f64)) -> f64| points.iter().map(value).fold(0.0, f64::max);
    let effort_n = largest(|(_, force_n)| *force_n);
    let power_w = largest(|(mps, force_n)| mps * force_n);
    if !(effort_n.is_finite() && power_w.is_finite() && power_w > 0.0) {
        return None;
    }
    let off = |(mps, force_n): &(f64, f64)| 1.0 - force_n / effort_n.min(power_w / mps);
    let most = points.iter().map(off).fold(0.0, f64::max);
    let last_n = points.iter().max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, force_n)| *force_n);
    let note = if last_n == Some(effort_n) {
        Some("the effort curve is constant: max_power_w is the power at its end, the train may have more".to_owned())
    } else if most > ALIKE {
        let percent = 100.0 * most;
        Some(format!(
            "the effort curve of {} points is kept as largest effort and largest power, which exceed it by up to {percent:.1} %",
            points.len()
        ))
    } else {
        None
    };
    Some(Limits { effort_n, power_w, note })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_speed_of_the_curve_is_written_twice() {
        for knee_kmh in [39.96, 40.0, 40.04, 139.97, 150.0] {
            let curve = points(1e5, 1e5 * knee_kmh / 3.6, 140.0);
            let written: Vec<String> = curve.iter().map(|(kmh, _)| format!("{kmh:.1}")).collect();
            let mut once = written.clone();
            once.dedup();
            assert_eq!(written, once);
            assert_eq!(written.last().map(String::as_str), Some("140.0"));
        }
    }

    #[test]
    fn a_curve_of_another_shape_says_by_how_much() {
        let flat = limits(&[(0.0, 100.0), (10.0, 100.0)]).unwrap();
        assert_eq!((flat.effort_n, flat.power_w), (100.0, 1000.0));
        assert!(flat.note.unwrap().contains("may have more"));
        // At 10 m/s 80 N, where 1000 W would give 100 N.
        let sagging = limits(&[(0.0, 200.0), (10.0, 80.0), (20.0, 50.0)]).unwrap();
        assert!(sagging.note.unwrap().contains("by up to 20.0 %"));
        assert!(limits(&[(0.0, 200.0), (0.0, 80.0)]).is_none());
        assert!(limits(&[]).is_none());
    }
}
