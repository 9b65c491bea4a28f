//! Whether the points of Fig. 9 are two clouds or one.
//!
//! Section 4.4 observes two clouds, one in the lower left below the manufacturer's power and one in the upper right
//! above it, and says that the transition takes place at no specific speed. So no line of speed parts them: each point
//! belongs to either with a probability that rises with the speed, and powers of a cloud are normal about its mean. One
//! cloud, on the other hand, may lean and bend: powers normal about a parabola over the speed, with one spread or one
//! that grows with the speed, as that of readings in whole km/h does. What describes the points better counts, by
//! Schwarz's criterion.

use nalgebra::{Matrix2, Matrix3, Vector2, Vector3};
use std::f64::consts::TAU;

/// Middle and half of the window of powers, km/h: speeds in about -1 to 1.
const MIDDLE_KMH: f64 = 90.0;
const HALF_KMH: f64 = 40.0;
/// Numbers that one cloud has, a parabola and a spread, and two have: means, spreads, place and width of the change.
const OF_ONE: f64 = 4.0;
const OF_TWO: f64 = 6.0;
/// Fewer points are no cloud.
const FEWEST: f64 = 10.0;
/// Steps of expectation and maximisation; more change nothing that is printed.
const STEPS: usize = 200;
/// Where they end: a log-likelihood that grows by less.
const SETTLED: f64 = 1e-4;
/// Bounds of an exponent, so that no probability becomes 0 or 1.
const STEEPEST: f64 = 30.0;
/// Width of the change of clouds at the start, km/h.
const FIRST_WIDTH_KMH: f64 = 5.0;

/// Power of one cloud, kW.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cloud {
    pub mean_kw: f64,
    pub sd_kw: f64,
}

/// Points as two clouds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clouds {
    pub slow: Cloud,
    pub fast: Cloud,
    /// At this speed a point is of either with the same probability, km/h.
    pub change_kmh: f64,
    /// By how much two are better than one: twice the difference of the logarithms, penalised after Schwarz (1978).
    pub better: f64,
}

/// A point of Fig. 9, and how likely it belongs to the faster cloud.
struct Member {
    speed_kmh: f64,
    power_kw: f64,
    fast: f64,
}

impl Member {
    /// In about -1 to 1.
    fn place(&self) -> f64 {
        (self.speed_kmh - MIDDLE_KMH) / HALF_KMH
    }
}

/// Probability of the faster cloud over the place.
#[derive(Clone, Copy, Debug)]
struct Change(Vector2<f64>);

impl Change {
    fn at(kmh: f64) -> Self {
        let per_place = HALF_KMH / FIRST_WIDTH_KMH;
        Self(Vector2::new(-per_place * (kmh - MIDDLE_KMH) / HALF_KMH, per_place))
    }

    fn fast(&self, place: f64) -> f64 {
        1.0 / (1.0 + (-(self.0[0] + self.0[1] * place).clamp(-STEEPEST, STEEPEST)).exp())
    }

    fn kmh(&self) -> f64 {
        MIDDLE_KMH - HALF_KMH * self.0[0] / self.0[1]
    }

    /// A step towards the largest likelihood, no further than where the expansion is good.
    fn improved(self, points: &[Member]) -> Self {
        let (mut slope, mut curvature) = (Vector2::zeros(), Matrix2::identity() * 1e-6);
        for point in points {
            let (x, fast) = (Vector2::new(1.0, point.place()), self.fast(point.place()));
            slope += (point.fast - fast) * x;
            curvature += fast * (1.0 - fast) * x * x.transpose();
        }
        let step = curvature.try_inverse().map_or(Vector2::zeros(), |inverse| inverse * slope);
        Self(self.0 + step * (3.0 / step.amax().max(3.0)))
    }
}

/// None with fewer than ten points up to `split_kmh` or above it. `split_kmh`: where the search begins; a cloud's
/// spread is no less than `least_sd_kw`.
pub fn clouds(points: impl Iterator<Item = (f64, f64)>, split_kmh: f64, least_sd_kw: f64) -> Option<Clouds> {
    let point = |(speed_kmh, power_kw)| Member { speed_kmh, power_kw, fast: f64::from(speed_kmh > split_kmh) };
    let mut points: Vec<Member> = points.map(point).collect();
    let all = points.len() as f64;
    let of_fast = |points: &[Member]| points.iter().map(|point| point.fast).sum::<f64>();
    let (mut change, mut before) = (Change::at(split_kmh), f64::NEG_INFINITY);
    let mut best: Option<(f64, [Cloud; 2], Change)> = None;
    for _ in 0..STEPS {
        let fast = of_fast(&points);
        if fast < FEWEST || all - fast < FEWEST {
            break;
        }
        let both = [1.0, 0.0].map(|of_slow| cloud(&points, of_slow, least_sd_kw));
        change = change.improved(&points);
        let likelihood: f64 = points.iter_mut().map(|point| assigned(point, &both, change)).sum();
        best = Some((likelihood, both, change));
        if likelihood - before < SETTLED {
            break;
        }
        before = likelihood;
    }
    let (two, [slow, fast], change) = best?;
    let one = [false, true].map(|grows| as_one(&points, grows)).into_iter().fold(f64::NEG_INFINITY, f64::max);
    let better = 2.0 * (two - one) - (OF_TWO - OF_ONE) * all.ln();
    Some(Clouds { slow, fast, change_kmh: change.kmh(), better })
}

/// `of_slow`: 1 for the slower cloud, 0 for the faster one.
fn cloud(points: &[Member], of_slow: f64, least_sd_kw: f64) -> Cloud {
    let weight = |point: &Member| (of_slow - point.fast).abs();
    let mean_of = |of: &dyn Fn(&Member) -> f64| {
        let sum: f64 = points.iter().map(|point| weight(point) * of(point)).sum();
        sum / points.iter().map(weight).sum::<f64>()
    };
    let mean_kw = mean_of(&|point| point.power_kw);
    let variance = mean_of(&|point| (point.power_kw - mean_kw).powi(2));
    Cloud { mean_kw, sd_kw: variance.sqrt().max(least_sd_kw) }
}

/// Assigns a point to the clouds; its log-likelihood.
fn assigned(point: &mut Member, [slow, fast]: &[Cloud; 2], change: Change) -> f64 {
    let log_normal = |cloud: &Cloud| {
        let off = (point.power_kw - cloud.mean_kw) / cloud.sd_kw;
        -0.5 * off * off - cloud.sd_kw.ln() - 0.5 * TAU.ln()
    };
    let share = change.fast(point.place());
    let [of_slow, of_fast] = [(1.0 - share).ln() + log_normal(slow), share.ln() + log_normal(fast)];
    let larger = of_slow.max(of_fast);
    let sum = larger + ((of_slow - larger).exp() + (of_fast - larger).exp()).ln();
    point.fast = (of_fast - sum).exp();
    sum
}

/// Log-likelihood of the points as one cloud about a parabola; `grows`: its spread is in proportion to the speed.
fn as_one(points: &[Member], grows: bool) -> f64 {
    let scale = |point: &Member| if grows { point.speed_kmh.max(1.0) } else { 1.0 };
    let powers = |point: &Member| Vector3::new(1.0, point.place(), point.place().powi(2));
    let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for point in points {
        let x = powers(point) / scale(point);
        normal += x * x.transpose();
        right += x * (point.power_kw / scale(point));
    }
    let Some(parabola) = normal.try_inverse().map(|inverse| inverse * right) else {
        return f64::NEG_INFINITY;
    };
    let square = |point: &Member| ((point.power_kw - powers(point).dot(&parabola)) / scale(point)).powi(2);
    let all = points.len() as f64;
    let variance = points.iter().map(square).sum::<f64>() / all;
    let log_scales: f64 = points.iter().map(|point| scale(point).ln()).sum();
    -0.5 * all * ((TAU * variance).ln() + 1.0) - log_scales
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 600 points from 50 to 130 km/h, each power off by what a repeatable scatter of ± `scatter` makes of it.
    fn found(scatter: f64, power_kw: impl Fn(f64) -> f64) -> Clouds {
        let points = (0..600_u32).map(|index| {
            let off =
                (f64::from(index) * 0.618_033_988_749_895).fract() + (f64::from(index) * 0.414_213_56).fract() - 1.0;
            // The change of clouds is at no specific speed.
            let speed_kmh = 50.0 + 80.0 * (f64::from(index) + 0.5) / 600.0;
            (
                speed_kmh,
                power_kw(speed_kmh + 10.0 * ((f64::from(index) * 0.732_050_8).fract() - 0.5)) * (1.0 + scatter * off),
            )
        });
        clouds(points, 115.0, 20.0).unwrap()
    }

    #[test]
    fn a_step_of_power_makes_two_clouds() {
        let found = found(0.15, |kmh| if kmh > 112.0 { 2400.0 } else { 1800.0 });
        assert!(found.better > 100.0, "{found:?}");
        assert!((found.slow.mean_kw - 1800.0).abs() < 30.0 && (found.fast.mean_kw - 2400.0).abs() < 60.0, "{found:?}");
        assert!((found.change_kmh - 112.0).abs() < 4.0, "{found:?}");
    }

    #[test]
    fn one_cloud_is_one_however_it_leans_or_spreads() {
        let flat = found(0.3, |_| 1900.0);
        let leaning = found(0.15, |kmh| 20.0 * kmh);
        let bent = found(0.15, |kmh| 1800.0 + 0.4 * (kmh - 60.0).powi(2));
        for one in [flat, leaning, bent] {
            assert!(one.better < 0.0, "{one:?}");
        }
    }

    #[test]
    fn a_few_points_are_no_cloud() {
        let of = |fast: usize| {
            clouds(
                (0..50).map(|i| (60.0 + i as f64, 1800.0)).chain((0..fast).map(|i| (120.0, 2300.0 + i as f64))),
                115.0,
                20.0,
            )
        };
        assert!(of(9).is_none() && of(10).is_some());
    }
}
