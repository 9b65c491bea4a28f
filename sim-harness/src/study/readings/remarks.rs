//! Which remarks of section 4.2 on the filter hold for a reading, on the runs of one seed.
//!
//! A remark that can be read in two ways stands here twice. A filter that does not move satisfies "r0 stays within
//! 0.0072 to 0.00738" idly, so both ends of that interval are asked for. A change counts from the size on that a reader
//! could see: [`visible`].

use super::pass::{Filter, Pass, R0_NOISE, way};
use crate::study::moments::Moments;
use crate::study::tallies::R0_BAND;
use crate::study::{dynamics, dynamics::SLOW_MPS, visible};
use rundown_files::statistics::{mean, sorted};

/// Runs of a seed on which other settings are tried.
pub const TRIED: usize = 20;
/// "Besides the outliers": this share of the samples at either end.
const OUTLIERS: f64 = 0.01;
/// How near the ends of r0 must come to the paper's: a third of its interval.
const MARGIN_SHARE: f64 = 1.0 / 3.0;
/// Noise of the acceleration, m/s²: small, any of them, and strong.
pub const SMALL_MPS2: [f64; 4] = [1e-4, 1e-3, 3e-3, 1e-2];
pub const STRONG_MPS2: [f64; 2] = [0.1, 1.0];
/// "At higher speeds": above, m/s.
pub const FAST_MPS: f64 = 100.0 / 3.6;

/// A remark as a short name and as the paper has it.
pub const REMARKS: [(&str, &str); COUNT] = [
    ("tracks", "Fig. 3: the speed is accurately reproduced (filtered less read speed below 1 km/h, rms)"),
    (
        "falls",
        "Fig. 3: r0 decreases at the beginning (how far below its first value it gets until the last sample above 80 km/h, 1e-5 N/kg and further than above in at least half of the runs)",
    ),
    (
        "rises",
        "Fig. 3: r0 increases again at lower speeds (from the last sample above 80 km/h to the end, by 1e-5 N/kg in at least half)",
    ),
    (
        "inverse",
        "Fig. 3: a hint of r0 being larger the lower the speed (after the largest, mean below 80 above that over 100 km/h by 1e-5 N/kg)",
    ),
    (
        "alike",
        "Fig. 3: similar dynamics of r0, r1, r2 (median over runs of the least correlation above 0.8, of those in which r0 moves by 1e-5 N/kg; at least half do)",
    ),
    ("lower end", "Fig. 4: r0 reaches down to 0.0072 N/kg besides outliers (1 % quantile within 0.00006)"),
    ("upper end", "Fig. 4: and stays below 0.00738 N/kg (99 % quantile at most 0.00006 above)"),
    (
        "skewness",
        "Fig. 4: negative skewness of r0, r1, r2 (at most -0.5, with a standard deviation of r0 of 1e-5 N/kg)",
    ),
    ("not negative", "4.2: no negative coefficient with Table 1"),
    ("sd x 10", "4.2: a hundred times the covariance of r0, r1 or r2: negative coefficients for at least one of them"),
    ("sd x 100", "4.2: the same of the printed deviation: negative coefficients for at least one of them"),
    ("each x 100", "4.2: the same, negative coefficients for each of them"),
    (
        "richer",
        "4.2: small acceleration noise (1e-4 to 0.01 m/s\u{b2}, Q or drawn) moves r0 by 1e-5 N/kg more in a run, none is negative",
    ),
    ("strong noise", "4.2: strong acceleration noise (0.1 or 1 m/s\u{b2}, Q or drawn) gives negative coefficients"),
    ("noise of r", "4.2: small noise of r0 (3e-5 N/kg a step, Q or drawn) gives negative coefficients"),
];
pub const COUNT: usize = 15;

/// What a reading gives on the runs of one seed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JudgedRuns {
    pub holds: [bool; COUNT],
    pub log_likelihood_per_sample: f64,
    /// Of filtered less read speed, km/h.
    pub rms_kmh: f64,
    /// Quantiles of r0 beyond which outliers are, N/kg.
    pub r0_ends: [f64; 2],
    pub skewness: [f64; 3],
    /// Share of the tried runs with a negative coefficient where the deviations of r0, of r1, of r2 are ten and a
    /// hundred times as large.
    pub negative: [[f64; 3]; 2],
    /// Noise of the acceleration in Q, and drawn.
    pub noise: [NoiseRemarks; 2],
}

/// What noise of the acceleration does.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NoiseRemarks {
    /// What r0 covers with each small one, as a multiple of what it covers without.
    pub way: [f64; SMALL_MPS2.len()],
    /// What it covers more in a run, mean over runs, N/kg.
    pub more_n_per_kg: [f64; SMALL_MPS2.len()],
    /// Share of the runs with a negative coefficient with each small one.
    pub small_negative: [f64; SMALL_MPS2.len()],
    /// The same with each strong one.
    pub strong_negative: [f64; STRONG_MPS2.len()],
}

impl NoiseRemarks {
    fn of(filter: &Filter, few: &[Pass], again: &impl Fn(&Filter) -> Vec<Pass>, with: fn(&mut Filter, f64)) -> Self {
        let noisy = |sd_mps2: f64| {
            let mut filter = *filter;
            with(&mut filter, sd_mps2);
            again(&filter)
        };
        let small = SMALL_MPS2.map(noisy);
        Self {
            way: small.each_ref().map(|passes| way(passes) / way(few)),
            more_n_per_kg: small.each_ref().map(|passes| (way(passes) - way(few)) / few.len().max(1) as f64),
            small_negative: small.each_ref().map(|passes| share(passes, Pass::is_negative)),
            strong_negative: STRONG_MPS2.map(|sd_mps2| share(&noisy(sd_mps2), Pass::is_negative)),
        }
    }

    /// Some small noise moves r0 more and leaves the coefficients above zero.
    fn is_richer(&self) -> bool {
        let mut small = self.more_n_per_kg.iter().zip(&self.small_negative);
        small.any(|(more_n_per_kg, negative)| visible::R0.sees(*more_n_per_kg) && *negative == 0.0)
    }
}

/// Judges a filter. `passes` are all runs; `again` runs the first [`TRIED`] with another filter.
pub fn judge(filter: &Filter, passes: &[Pass], again: impl Fn(&Filter) -> Vec<Pass>) -> JudgedRuns {
    let mut moments: [Moments; 3] = Default::default();
    passes.iter().flat_map(|pass| &pass.davis).for_each(|davis| {
        moments.iter_mut().zip(davis).for_each(|(moments, value)| moments.add(*value));
    });
    let skewness = moments.each_ref().map(|moments| moments.skewness().unwrap_or(f64::NAN));
    let rms_kmh = 3.6 * rms(passes.iter().flat_map(|pass| pass.off_mps.iter().copied()));
    let likelihoods = passes.iter().flat_map(|pass| &pass.log_likelihood);
    let r0_ends = [OUTLIERS, 1.0 - OUTLIERS]
        .map(|share| nearest_quantile(passes.iter().flat_map(|pass| &pass.davis).map(|davis| davis[0]), share));
    let margin = MARGIN_SHARE * (R0_BAND.end() - R0_BAND.start());
    let negative = [10.0, 100.0].map(|factor| negative_with(factor, filter, &again));
    let few = &passes[..passes.len().min(TRIED)];
    let of_r = [
        again(&Filter { davis_noise: [R0_NOISE, 0.0, 0.0], ..*filter }),
        again(&Filter { drawn_r0: R0_NOISE, ..*filter }),
    ];
    let noise = [
        NoiseRemarks::of(filter, few, &again, |filter, sd| filter.config.acceleration_noise_mps2 = sd),
        NoiseRemarks::of(filter, few, &again, |filter, sd| filter.drawn_mps2 = sd),
    ];
    JudgedRuns {
        holds: [
            rms_kmh < 1.0,
            share(passes, falls) >= 0.5,
            share(passes, rises) >= 0.5,
            share(passes, is_larger_when_slow) >= 0.5,
            share(passes, |pass| alike(pass).is_some()) >= 0.5
                && nearest_quantile(passes.iter().filter_map(alike), 0.5) > 0.8,
            (r0_ends[0] - R0_BAND.start()).abs() <= margin,
            r0_ends[1] <= R0_BAND.end() + margin,
            skewness.iter().all(|skewness| visible::SKEWNESS.sees(-skewness))
                && moments[0].sd().is_some_and(|sd| visible::R0.sees(sd)),
            !passes.iter().any(Pass::is_negative),
            negative[0].iter().any(|share| *share > 0.0),
            negative[1].iter().any(|share| *share > 0.0),
            negative[1].iter().all(|share| *share > 0.0),
            noise.iter().any(NoiseRemarks::is_richer),
            noise.iter().any(|noise| noise.strong_negative.iter().any(|share| *share > 0.0)),
            of_r.iter().flatten().any(Pass::is_negative),
        ],
        log_likelihood_per_sample: mean(likelihoods).unwrap_or_default(),
        rms_kmh,
        r0_ends,
        skewness,
        negative,
        noise,
    }
}

/// Share of the runs with a negative coefficient where the initial deviation of r0, of r1, of r2 is so many times as
/// large.
fn negative_with(factor: f64, filter: &Filter, again: &impl Fn(&Filter) -> Vec<Pass>) -> [f64; 3] {
    std::array::from_fn(|index| {
        let mut filter = *filter;
        filter.config.initial_davis_sd[index] *= factor;
        share(&again(&filter), Pass::is_negative)
    })
}

fn share(passes: &[Pass], is: impl Fn(&Pass) -> bool) -> f64 {
    passes.iter().filter(|pass| is(pass)).count() as f64 / passes.len().max(1) as f64
}

fn rms(values: impl Iterator<Item = f64>) -> f64 {
    values.map(|value| value * value).collect::<Moments>().mean().map_or(f64::NAN, f64::sqrt)
}

/// The value nearest to that below which this share lies; NaN without values.
fn nearest_quantile(values: impl IntoIterator<Item = f64>, share: f64) -> f64 {
    let values = sorted(values);
    let last = values.len().saturating_sub(1);
    values.get((share * last as f64).round() as usize).copied().unwrap_or(f64::NAN)
}

fn falls(pass: &Pass) -> bool {
    dynamics::falls(&pass.davis, &pass.speed_mps).is_some_and(|fall| visible::R0.sees(fall))
}

fn rises(pass: &Pass) -> bool {
    dynamics::rises(&pass.davis, &pass.speed_mps).is_some_and(|rise| visible::R0.sees(rise))
}

fn is_larger_when_slow(pass: &Pass) -> bool {
    let (mut slow, mut fast) = (Moments::default(), Moments::default());
    for (davis, speed_mps) in pass.davis.iter().zip(&pass.speed_mps).skip(dynamics::fastest(&pass.speed_mps)) {
        match *speed_mps {
            v if v < SLOW_MPS => slow.add(davis[0]),
            v if v > FAST_MPS => fast.add(davis[0]),
            _ => {}
        }
    }
    slow.mean().zip(fast.mean()).is_some_and(|(slow, fast)| visible::R0.sees(slow - fast))
}

/// None where r0 does not move visibly.
fn alike(pass: &Pass) -> Option<f64> {
    dynamics::range(&pass.davis).filter(|range| visible::R0.sees(*range))?;
    dynamics::alike(&pass.davis)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rundown::tick::paper::PaperConfig;

    /// r0 and speed of each sample.
    fn pass(rows: &[(f64, f64)]) -> Pass {
        Pass {
            davis: rows.iter().map(|(r0, _)| [*r0, 2e-2 * r0, 4e-3 * r0]).collect(),
            speed_mps: rows.iter().map(|(_, kmh)| kmh / 3.6).collect(),
            off_mps: vec![0.1; rows.len()],
            log_likelihood: vec![-3.0; rows.len()],
            ..Pass::default()
        }
    }

    fn held(name: &str, judged: &JudgedRuns) -> bool {
        judged.holds[REMARKS.iter().position(|(remark, _)| *remark == name).unwrap()]
    }

    #[test]
    fn a_filter_that_does_not_move_is_not_the_papers() {
        let still = vec![pass(&[(0.00738, 10.0), (0.00738, 140.0), (0.00738, 50.0)])];
        let judged = judge(&Filter::from(PaperConfig::default()), &still, |_| still.clone());
        for name in ["falls", "rises", "alike", "lower end", "skewness", "sd x 10", "each x 100", "noise of r"] {
            assert!(!held(name, &judged), "{name}");
        }
        assert!(held("tracks", &judged) && held("upper end", &judged) && held("not negative", &judged));
        assert_eq!(judged.log_likelihood_per_sample, -3.0);
    }

    #[test]
    fn one_that_falls_and_rises_is() {
        let moves = pass(&[
            (0.00738, 10.0),
            (0.00736, 90.0),
            (0.00720, 140.0),
            (0.00736, 101.0),
            (0.00737, 79.0),
            (0.00738, 40.0),
        ]);
        let negative = pass(&[(-1e-4, 10.0), (0.0, 140.0)]);
        let wilder = |filter: &Filter| match filter.drawn_mps2 {
            noise if noise == SMALL_MPS2[0] => vec![pass(&[(0.00738, 10.0), (0.00680, 140.0)])],
            _ => vec![negative.clone()],
        };
        let judged = judge(&Filter::from(PaperConfig::default()), &[moves], wilder);
        assert_eq!(judged.holds, [true; COUNT], "{judged:?}");
    }

    #[test]
    fn noise_of_r_may_be_drawn() {
        let still = vec![pass(&[(0.00738, 10.0), (0.00738, 140.0)])];
        let drawn = |filter: &Filter| match filter.drawn_r0 {
            0.0 => still.clone(),
            _ => vec![pass(&[(-1e-4, 10.0), (0.0, 140.0)])],
        };
        let judged = judge(&Filter::from(PaperConfig::default()), &still, drawn);
        assert!(held("noise of r", &judged) && !held("strong noise", &judged));
    }

    #[test]
    fn a_quantile_is_a_value() {
        assert_eq!(nearest_quantile([3.0, 1.0, 2.0], 0.5), 2.0);
        assert!(nearest_quantile([], 0.5).is_nan());
    }
}
