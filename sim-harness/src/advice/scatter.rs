//! Do speeds scatter so much that no coast is recognised in them?
//!
//! In: the measurements of the runs. Out: words for it.
//!
//! A second difference v(i-1) - 2 v(i) + v(i+1) has the motion of a train hardly in it, and six times the variance of a
//! reading: of its noise, or of what a step of 3 km/h hides.

use rundown::tick::measurement::Measurement;

/// Farther rows have the motion in them, s.
const LONGEST_STEP_S: f64 = 2.5;
/// Speeds that scatter by less show a coast, km/h (standard deviation): whole km/h do, by 0.3.
const HIDES_KMH: f64 = 0.5;

/// Squares of second differences of speeds, (m/s)².
#[derive(Debug, Default)]
pub(super) struct Scatter {
    squares: f64,
    count: usize,
}

impl Scatter {
    pub(super) fn add(&mut self, rows: &[Measurement]) {
        for three in rows.windows(3) {
            let [Some(a), Some(b), Some(c)] = [0, 1, 2].map(|i| three[i].speed_mps) else { continue };
            if three[2].time_s - three[0].time_s <= 2.0 * LONGEST_STEP_S && b > 0.0 {
                self.squares += (a - 2.0 * b + c).powi(2);
                self.count += 1;
            }
        }
    }

    /// What else keeps coasts from being recognised; empty where nothing does.
    pub(super) fn hides_coasts(&self) -> String {
        let kmh = 3.6 * (self.squares / 6.0 / self.count.max(1) as f64).sqrt();
        if kmh < HIDES_KMH {
            return String::new();
        }
        format!("; speeds that scatter by {kmh:.1} km/h from row to row hide where trains coast")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_and_coarse_steps_hide_coasts_and_the_motion_does_not() {
        let said = |read: &dyn Fn(f64, f64) -> f64| {
            let row = |second: u32| {
                let time_s = f64::from(second);
                let kmh = 60.0 + 50.0 * f64::sin(time_s / 40.0);
                Measurement { time_s, speed_mps: Some(read(time_s, kmh) / 3.6), ..Measurement::default() }
            };
            let mut scatter = Scatter::default();
            scatter.add(&(0..600).map(row).collect::<Vec<_>>());
            scatter.hides_coasts()
        };
        assert_eq!(said(&|_, kmh| kmh), "");
        assert_eq!(said(&|_, kmh| kmh.round()), "");
        assert!(
            said(&|_, kmh| (kmh / 3.0).round() * 3.0).contains("0.9 km/h"),
            "{}",
            said(&|_, kmh| (kmh / 3.0).round() * 3.0)
        );
        let noise = |second: f64| 2.0_f64.sqrt() * f64::sin(2.7 * second * second);
        assert!(
            said(&|second, kmh| kmh + noise(second)).contains("1.0 km/h"),
            "{}",
            said(&|second, kmh| kmh + noise(second))
        );
    }
}
