//! Does the noise fit? What is left in whitened rows should be white and normal, with a standard deviation of 1.

use crate::candidate::Fitted;
use crate::config::GapConfig;
use crate::data::{believed::Context, rows::Row};
use crate::noise::calibrate::Calibrated;
use crate::noise::habits::regime;
use crate::trials::column;
use rundown_files::statistics::{mean, quantile, sorted};
use serde_json::{Value, json};

/// Where the quantiles are taken: standard deviations of the normal distribution.
const REACH: i32 = 30;
const STEPS_A_DEVIATION: f64 = 10.0;

/// What the model and its noise leave of the rows, in standard deviations.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Whiteness {
    /// Standard deviations that these shares of a normal distribution have, and that of the residuals.
    pub quantiles: Vec<(f64, f64)>,
    /// Coasting, powering, braking: how large the residuals are there; none from too few rows.
    pub regimes: [Option<f64>; 3],
    /// Correlation of neighbours of one run.
    pub neighbours: f64,
    /// Share of the residuals beyond three standard deviations; of a normal distribution it is 0.0027.
    pub beyond_3: f64,
}

/// As [`Whiteness::regimes`] has them.
const REGIMES: [(i8, &str); 3] = [(0, "coasting"), (1, "powering"), (-1, "braking")];

impl Whiteness {
    /// Of rows with a model; none from too few of them.
    pub fn of(context: &Context<'_>, rows: &[Row], calibrated: &Calibrated, model: &[Fitted]) -> Option<Self> {
        let config = &context.config.evidence;
        let mut left: Vec<f64> = rows.iter().map(|row| row.residual_n_per_kg).collect();
        for fitted in model {
            left.iter_mut().zip(column(context, rows, fitted)).for_each(|(left, of_it)| *left -= of_it);
        }
        // Outliers, which count less in the fit, are to be seen here.
        let as_all = Calibrated { spread: vec![1.0; rows.len()], ..calibrated.clone() };
        let whitening = as_all.whitening(context, rows);
        let white = whitening.whiten(&left);
        let mean_square = |which: i8| {
            let those = rows.iter().zip(white.iter()).filter(|(row, _)| regime(row, config) == which);
            let squares: Vec<f64> = those.map(|(_, value)| value * value).collect();
            mean(&squares).filter(|_| squares.len() >= config.least_rows)
        };
        let in_runs = whitening.runs().iter().flat_map(|run| (run.start + 1..run.end).map(|i| white[i - 1] * white[i]));
        let sorted = sorted(white.iter());
        let at = |step: i32| {
            let z = f64::from(step) / STEPS_A_DEVIATION;
            Some((z, quantile(&sorted, 0.5 * libm::erfc(-z / core::f64::consts::SQRT_2))?))
        };
        (rows.len() >= config.least_rows).then(|| Self {
            quantiles: (-REACH..=REACH).filter_map(at).collect(),
            regimes: REGIMES.map(|(which, _)| mean_square(which).map(f64::sqrt)),
            neighbours: in_runs.sum::<f64>() / white.norm_squared(),
            beyond_3: white.iter().filter(|value| value.abs() > 3.0).count() as f64 / rows.len() as f64,
        })
    }

    /// Confidences and p-values rest on noise that is not what the rows have.
    pub fn is_off(&self, config: &GapConfig) -> bool {
        let most = config.noise.most_off;
        let off = |sd: &f64| *sd > most || *sd < 1.0 / most;
        self.regimes.iter().flatten().any(off) || self.neighbours.abs() > config.noise.most_neighbours
    }

    /// For a person.
    pub fn sentence(&self) -> String {
        let each = REGIMES.iter().zip(self.regimes).filter_map(|((_, word), sd)| Some(format!("{:.2} {word}", sd?)));
        format!(
            "standardised residuals, which should be 1: {}; correlation of neighbours, which should be 0: {:.2}; beyond three standard deviations {:.1} %, of a normal distribution 0.3 %",
            each.collect::<Vec<_>>().join(", "),
            self.neighbours,
            100.0 * self.beyond_3
        )
    }

    /// As in `gap.json`.
    pub fn json(&self) -> Value {
        let [coasting, powering, braking] = self.regimes;
        json!({
            "coasting": coasting,
            "powering": powering,
            "braking": braking,
            "neighbours": self.neighbours,
            "beyond_3": self.beyond_3,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::believed::tests::on_a_level_line;
    use crate::noise::whitening::Noise;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};
    use rundown::model::direction::Direction;

    /// Of rows that scatter by 0.01 N/kg, so many times as much where they brake, each with a share of the one before.
    fn found(wider: f64, carried: f64) -> (Whiteness, bool) {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let (mut rows, mut before) = (Vec::new(), 0.0);
        for i in 0..3000 {
            let brakes = i % 3 == 0;
            let mut row = Row::coasting(Direction::Up, 1000.0, 25.0);
            row.interval.run = i / 100;
            row.effort_n_per_kg = if brakes { -0.3 } else { 0.0 };
            let noise: f64 = StandardNormal.sample(&mut rng);
            before = carried * before + (1.0 - carried * carried).sqrt() * noise;
            row.residual_n_per_kg = 0.01 * if brakes { wider * before } else { before };
            rows.push(row);
        }
        let noise = Noise { acceleration_mps2: 0.01, ..Noise::default() };
        // As if all that brakes had been taken for outliers.
        let spread = rows.iter().map(|row| if row.effort_n_per_kg < 0.0 { wider } else { 1.0 }).collect();
        let calibrated = Calibrated { noise, spread, ..Calibrated::default() };
        on_a_level_line(30, |context| {
            let found = Whiteness::of(context, &rows, &calibrated, &[]).unwrap();
            let is_off = found.is_off(context.config);
            (found, is_off)
        })
    }

    #[test]
    fn noise_as_found_is_white_and_normal() {
        let (white, is_off) = found(1.0, 0.0);
        assert!(!is_off, "{white:?}");
        for (expected, seen) in white.quantiles.iter().filter(|(z, _)| z.abs() < 2.5) {
            assert!((expected - seen).abs() < 0.2, "{expected} {seen}");
        }
        assert!(white.neighbours.abs() < 0.06 && (0.001..0.006).contains(&white.beyond_3), "{white:?}");
        assert!(white.regimes[1].is_none(), "nobody powers");
    }

    #[test]
    fn a_regime_that_scatters_more_and_neighbours_that_are_alike_are_said() {
        let (wider, is_off) = found(3.0, 0.0);
        assert!(is_off && (wider.regimes[2].unwrap() - 3.0).abs() < 0.2, "{wider:?}");
        assert!(wider.beyond_3 > 0.05 && wider.sentence().contains("braking"), "{}", wider.sentence());
        let (alike, is_off) = found(1.0, 0.6);
        assert!(is_off && (alike.neighbours - 0.6).abs() < 0.1, "{alike:?}");
    }
}
