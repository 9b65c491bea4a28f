//! What an effort column says between two samples: the mean effort, and how much it changes beyond what is understood.

use crate::config::IntervalConfig;
use crate::data::interval::POINTS;
use crate::data::runs::EffortReading;
use rundown_files::sample::Sample;

/// The effort column of a run.
#[derive(Clone, Copy)]
pub(super) struct Efforts<'a> {
    pub(super) samples: &'a [Sample],
    pub(super) reading: EffortReading,
    pub(super) config: &'a IntervalConfig,
}

impl Efforts<'_> {
    /// The log has such a column.
    pub(super) fn are_there(&self) -> bool {
        self.samples.iter().any(|sample| sample.effort_n_per_kg.is_some())
    }

    /// 0 where it is not known.
    pub(super) fn at(&self, sample: usize) -> f64 {
        self.samples[sample].effort_n_per_kg.unwrap_or(0.0)
    }

    /// Speeds at two samples between which the power, not the effort, changes evenly: of a train under power that is
    /// not slow.
    fn by_power(&self, from: usize, to: usize) -> Option<[f64; 2]> {
        let speeds = [self.samples[from].speed_mps?, self.samples[to].speed_mps?];
        let is_fast = speeds[0].min(speeds[1]) > self.config.by_power_mps;
        (is_fast && self.at(from) > 0.0 && self.at(to) > 0.0).then_some(speeds)
    }

    /// Mean effort between two momentary readings. Under power the straight line between two efforts would be too high
    /// by up to 7e-4 N/kg at 10 s.
    fn mean_between(&self, from: usize, to: usize) -> f64 {
        let [a, b] = [self.at(from), self.at(to)];
        let Some([v0, v1]) = self.by_power(from, to) else { return 0.5 * (a + b) };
        let at = |i: usize| {
            let t = (i as f64 + 0.5) / POINTS as f64;
            (a * v0 + (b * v1 - a * v0) * t) / (v0 + (v1 - v0) * t)
        };
        (0..POINTS).map(at).sum::<f64>() / POINTS as f64
    }

    /// Change of the effort from one sample to another beyond what constant power explains.
    fn change_beyond_power(&self, from: usize, to: usize) -> Option<f64> {
        let [a, b] = [self.samples[from].effort_n_per_kg?, self.samples[to].effort_n_per_kg?];
        let at_power = self.by_power(from, to).map(|[v0, v1]| (b * v1 - a * v0) / (0.5 * (v0 + v1)));
        Some(at_power.filter(|at_power| at_power.abs() < (b - a).abs()).unwrap_or(b - a))
    }

    /// Effort at a sample. A mean lies half a row back, so that of means the middle of neighbours is taken: the noise
    /// of an interval's own effort, which would be taken for a delay, is hardly in the difference of two.
    pub(super) fn around(&self, sample: usize) -> f64 {
        match self.mean_after(sample) {
            Some(next) => 0.5 * (self.at(sample) + self.at(next)),
            None => self.at(sample),
        }
    }

    /// Change from one momentary reading to the next at a sample; of means, which miss nothing between two, none.
    pub(super) fn change_at(&self, sample: usize) -> Option<f64> {
        let known = |sample: usize| self.samples.get(sample).and_then(|sample| sample.effort_n_per_kg);
        let change = || Some(0.5 * (known(sample + 1)? - known(sample.checked_sub(1)?)?));
        if self.reading == EffortReading::MeanSinceLast { None } else { change() }
    }

    /// The sample after one of a column of means, unless a gap lies between.
    fn mean_after(&self, sample: usize) -> Option<usize> {
        let samples = self.samples;
        let next = samples.get(sample + 1).filter(|next| next.effort_n_per_kg.is_some())?;
        let (before_s, now_s) = (samples[sample.checked_sub(1)?].time_s, samples[sample].time_s);
        let is_mean = self.reading == EffortReading::MeanSinceLast;
        (is_mean && next.time_s - now_s < self.config.gap * (now_s - before_s)).then_some(sample + 1)
    }

    /// How much the effort changes from the sample before to this one, not negative; the first sample has none before.
    /// A mean is judged by those around it: the noise of a mean is in its change, too, so that those which count
    /// because they hardly change would be too high wherever the effort falls.
    fn change_into(&self, sample: usize) -> Option<f64> {
        let before = sample.checked_sub(1)?;
        let own = self.change_beyond_power(before, sample)?.abs();
        let is_zero = |sample: usize| self.at(sample).abs() <= self.config.coasting_n_per_kg;
        let coasts = is_zero(before) && is_zero(sample);
        let next = self.mean_after(sample).filter(|_| !coasts);
        let around = next.and_then(|next| Some((next, self.change_beyond_power(before, next)?)));
        Some(around.map_or(own, |(next, change)| (0.5 * change).abs().max(self.off_middle([before, sample, next]))))
    }

    /// How far the effort of the second of three samples is from the middle of the others, or of their power.
    fn off_middle(&self, three: [usize; 3]) -> f64 {
        let [a, b, c] = three.map(|sample| self.at(sample));
        let off = (b - 0.5 * (a + c)).abs();
        match self.by_power(three[0], three[2]).zip(self.samples[three[1]].speed_mps) {
            Some(([v0, v2], v1)) => off.min((b - 0.5 * (a * v0 + c * v2) / v1.max(self.config.by_power_mps)).abs()),
            None => off,
        }
    }

    /// Mean and change of the effort between two samples.
    pub(super) fn mean_and_change(&self, from: usize, to: usize) -> Option<(f64, f64)> {
        let (mut sum, mut time_s, mut change) = (0.0, 0.0, 0.0);
        for now in from + 1..=to {
            let (before, is_known) = (now - 1, |sample: usize| self.samples[sample].effort_n_per_kg.is_some());
            let dt_s = self.samples[now].time_s - self.samples[before].time_s;
            let mean = match self.reading {
                EffortReading::Momentary if is_known(before) && is_known(now) => self.mean_between(before, now),
                EffortReading::MeanSinceLast if is_known(now) => self.at(now),
                EffortReading::Momentary | EffortReading::MeanSinceLast => return None,
            };
            // Over many samples the steps inside an interval are seen, and only their own halves are uncertain.
            change += self.change_into(now).unwrap_or(0.0) * dt_s;
            sum += mean * dt_s;
            time_s += dt_s;
        }
        (time_s > 0.0).then(|| (sum / time_s, change / time_s))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn straight_lines_between_momentary_readings_miss_a_twelfth_of_what_the_effort_bends() {
        let at = |time_s: f64| 0.001 * time_s * time_s;
        let read = |second: u32| {
            let time_s = 2.0 * f64::from(second);
            Sample { time_s, effort_n_per_kg: Some(at(time_s)), ..Sample::default() }
        };
        let samples: Vec<Sample> = (0..8).map(read).collect();
        let config = IntervalConfig::default();
        let efforts = |reading| Efforts { samples: &samples, reading, config: &config };
        let momentary = efforts(EffortReading::Momentary);
        // Readings 2 s apart, from 2 s to 12 s: the mean of t²/1000 is (12³ - 2³) / 30 000.
        let (mean, _) = momentary.mean_and_change(1, 6).unwrap();
        let missed = mean - (12.0_f64.powi(3) - 2.0_f64.powi(3)) / 30_000.0;
        let bend = momentary.change_at(6).unwrap() - momentary.change_at(1).unwrap();
        assert!((missed - 2.0 / 12.0 * bend / 10.0).abs() < 1e-12, "{missed}");
        assert!(missed > 1e-4);
        // Means miss nothing; at the ends of a log it is not known.
        assert_eq!(efforts(EffortReading::MeanSinceLast).change_at(6), None);
        assert_eq!([0, 7].map(|end| momentary.change_at(end)), [None; 2]);
    }
}
