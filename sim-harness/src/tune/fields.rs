//! What stands in `tune.json`: path, unit, meaning, null rule.

use super::parameters::PARAMETERS;
use crate::output::fields::{Field, below, owned};
use crate::output::json::GRADIENT_SD;
use crate::study::fields::answer;

/// Of `tune.json`.
pub fn fields() -> Vec<Field> {
    let mut fields = owned(&[
        ["evaluations", "", "configurations that the search tried", ""],
        ["unsettled", "", "searches of two that ended with the evaluations, before an optimum; 0: it is one", ""],
    ]);
    for (prefix, of) in [("table1", "Table 1 of the paper"), ("optimum", "the optimum")] {
        let value = |name: &str, unit: &str| {
            let path = format!("{prefix}.values.{name}");
            [path, unit.to_owned(), format!("parameter `{name}` of {of}"), String::new()]
        };
        fields.extend(PARAMETERS.iter().map(|parameter| value(parameter.name, parameter.unit)));
        fields.extend(below(&format!("{prefix}.score."), SCORE));
    }
    fields.extend(below("sensitivity[].", SENSITIVITY));
    fields.extend(answer("slope.table1."));
    fields.extend(answer("slope.optimum."));
    fields.extend(owned(&[GRADIENT_SD]));
    fields
}

const SCORE: &[[&str; 4]] = &[
    ["log_likelihood", "1", "logarithm of the likelihood of all samples", ""],
    ["samples", "", "samples that have one", ""],
    ["negative_samples", "", "samples with a coefficient below zero", ""],
    [
        "negative_depth",
        "1",
        "how far the coefficients are below zero, as a share of the described, mean over samples",
        "",
    ],
    ["repaired", "", "samples at which the covariance had to be repaired", ""],
];

const SENSITIVITY: &[[&str; 4]] = &[
    ["which", "", "coefficients whose initial deviation is changed", ""],
    ["factor", "1", "by how much", ""],
    ["negative_runs", "", "runs in which a coefficient fell below zero", ""],
    ["runs", "", "runs that were tried", ""],
    ["least_share[]", "1", "least value of r0, r1, r2 over all samples, as a share of the described", ""],
];
