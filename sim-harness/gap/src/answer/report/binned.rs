//! Means over bins of a coordinate, with standard errors that take a run as the unit.

use std::{collections::BTreeMap, ops::Range};

#[derive(Clone, Copy, Debug)]
pub(super) struct Value {
    pub run: usize,
    /// Where it lies on the coordinate.
    pub at: f64,
    pub value: f64,
    /// How much it counts.
    pub weight: f64,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Bin {
    pub at: f64,
    pub mean: f64,
    /// Runs that have values in it.
    pub runs: usize,
    /// Standard error of the mean; none with less than three runs.
    pub se: Option<f64>,
}

/// A round width (1, 2 or 5 times a power of ten) that gives at most `most` bins.
pub(super) fn width(range: &Range<f64>, most: usize) -> f64 {
    let least = ((range.end - range.start) / most.max(1) as f64).max(1e-9);
    let power = 10_f64.powf(least.log10().floor());
    let round = [1.0, 2.0, 5.0, 10.0].map(|step| step * power);
    round.into_iter().find(|w| *w >= least).unwrap_or(10.0 * power)
}

/// The bins that have values, in their order.
///
/// Values of one run are not independent, so the error of the mean is that of the runs' sums about it:
///
/// ```text
/// se² = R/(R - 1) Σ_r (Σ_{i in r} w_i (y_i - mean))² / (Σ w)²
/// ```
pub(super) fn binned(values: &[Value], width: f64) -> Vec<Bin> {
    let mut bins: BTreeMap<i64, Vec<&Value>> = BTreeMap::new();
    for value in values {
        if value.at.is_finite() && value.value.is_finite() {
            let place = (value.at / width).floor() as i64;
            bins.entry(place).or_default().push(value);
        }
    }
    let bins = bins.into_iter().filter_map(|(place, values)| {
        let total: f64 = values.iter().map(|v| v.weight).sum();
        if total <= 0.0 {
            return None;
        }
        let mean = values.iter().map(|v| v.weight * v.value).sum::<f64>() / total;
        let mut of_runs: BTreeMap<usize, f64> = BTreeMap::new();
        for v in &values {
            *of_runs.entry(v.run).or_default() += v.weight * (v.value - mean);
        }
        let runs = of_runs.len() as f64;
        let squares: f64 = of_runs.values().map(|sum| sum * sum).sum();
        Some(Bin {
            at: (place as f64 + 0.5) * width,
            mean,
            runs: of_runs.len(),
            se: (runs >= 3.0).then(|| (squares * runs / (runs - 1.0)).sqrt() / total),
        })
    });
    bins.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(run: usize, at: f64, value: f64) -> Value {
        Value { run, at, value, weight: 1.0 }
    }

    #[test]
    fn repeating_a_value_within_its_run_makes_no_mean_surer() {
        let once: Vec<Value> = (0..3).map(|run| value(run, 5.0, run as f64)).collect();
        let ten: Vec<Value> = (0..30).map(|i| value(i / 10, 5.0, (i / 10) as f64)).collect();
        let (once, ten) = (binned(&once, 10.0), binned(&ten, 10.0));
        assert_eq!(once[0].at, 5.0);
        assert!((once[0].mean - 1.0).abs() < 1e-12 && (ten[0].mean - 1.0).abs() < 1e-12);
        // Three runs at 0, 1, 2: standard deviation 1, over the root of three.
        assert!((once[0].se.unwrap() - 1.0 / 3_f64.sqrt()).abs() < 1e-12);
        assert!((ten[0].se.unwrap() - once[0].se.unwrap()).abs() < 1e-12);
    }

    #[test]
    fn two_runs_have_no_error_and_what_counts_nothing_no_bin() {
        let bins = binned(&[value(0, 1.0, 1.0), value(1, 1.0, 3.0)], 2.0);
        assert_eq!(bins, [Bin { at: 1.0, mean: 2.0, runs: 2, se: None }]);
        let nothing = Value { weight: 0.0, ..value(0, 1.0, 1.0) };
        assert!(binned(&[nothing], 2.0).is_empty());
    }

    #[test]
    fn widths_are_round() {
        assert_eq!(width(&(0.0..36.0), 40), 1.0);
        assert_eq!(width(&(0.0..41.0), 40), 2.0);
        assert_eq!(width(&(0.0..140.0), 15), 10.0);
    }
}
