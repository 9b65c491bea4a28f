//! What stands in the JSON files of a study: path, unit, meaning, null rule.

use super::slope::ERROR_KMH;
use crate::output::fields::{Field, below, owned};
use crate::output::json::GRADIENT_SD;

/// An answer of the self-test, as in `slope.json` and `tune.json`.
pub fn answer(prefix: &str) -> Vec<Field> {
    let few = "there are fewer than three vehicles";
    let rmse = format!("root mean square error of r(v) at {} km/h", ERROR_KMH.map(|kmh| kmh.to_string()).join(", "));
    below(
        prefix,
        &[
            ["mode", "", "`paper`, `gated` or `measured`", ""],
            ["runs", "", "runs of each vehicle that were learned from", ""],
            ["vehicles", "", "simulated vehicles", ""],
            [
                "slope[]",
                "1",
                "slope of the estimated on the true deviation of r(v) from the description at 60, 100 and 140 km/h",
                few,
            ],
            ["spread_percent[]", "%", "standard deviation about that line, of the described resistance", few],
            ["rmse_percent", "%", &rmse, ""],
            ["bound_percent", "%", "root mean square of the Cram\u{e9}r-Rao bound over the same", ""],
            ["efficiency", "1", "square of the bound over that of the error", ""],
            ["coverage", "1", "share of the truths in the 95 % interval", ""],
        ],
    )
}

/// Of `slope.json`.
pub fn slope() -> Vec<Field> {
    let mut fields = owned(&[
        ["vehicles", "", "simulated vehicles", ""],
        ["runs", "", "runs of each vehicle", ""],
        ["seed", "", "seed of everything that is simulated", ""],
    ]);
    fields.extend(answer("answers[]."));
    fields
}

/// What `rundown study --json` prints of the case study.
pub fn case_study() -> Vec<Field> {
    let mut fields = owned(&[
        ["runs", "", "runs that were used", ""],
        ["runs_with_truth", "", "those whose truth is known", ""],
        ["failed", "", "runs that could not be used", ""],
        ["set_aside", "", "runs that were set aside as perturbed", ""],
        [
            "diagnosis[].*",
            "",
            "the fields of `check.json`, for each part of recorded runs that was read at once",
            "as in `check.json`",
        ],
        GRADIENT_SD,
        ["sets", "", "sets of runs on which the claims were judged", ""],
        ["sets_needed", "", "in how many a claim must hold: 90 %, rounded up", ""],
        ["claims_by_kind[].kind", "", "`input`, `recovered` or `predicted`", ""],
        ["claims_by_kind[].claims", "", "claims of that kind", ""],
        ["claims_by_kind[].reproduced", "", "those that hold over all sets", ""],
        ["claims_by_kind[].not_reproduced", "", "those that too many sets contradict", ""],
        ["claims_by_kind[].not_visible", "", "those whose change is smaller than a reader of the paper could see", ""],
        ["claims_by_kind[].no_data", "", "those on which too few sets have data", ""],
        [
            "claims_by_kind[].not_judged",
            "",
            "those with numbers of the paper's own line, train or drivers, where the runs are others",
            "",
        ],
        ["claims[].*", "", "the columns of `claims.csv`", "the cell of the table is empty"],
    ]);
    fields.extend(answer("truth_slope[]."));
    fields
}

/// What `rundown study --experiment NAME --json` prints.
pub const EXPERIMENT: &[[&str; 4]] = &[
    ["experiment", "", "name of the experiment", ""],
    ["question", "", "what it asks", ""],
    ["sets", "", "sets of runs", ""],
    ["runs", "", "runs of each set", ""],
    ["seed", "", "seed of the first set", ""],
    ["rows[].*", "", "the columns of `<experiment>.csv`", "the cell of the table is empty"],
    ["notes[]", "", "what is said besides, each a sentence", ""],
];

/// Of `readings.json`.
pub const READINGS: &[[&str; 4]] = &[
    ["runs", "", "runs of each set", ""],
    ["seeds", "", "sets of runs", "the runs are recorded"],
    ["seed", "", "seed of the first set", "the runs are recorded"],
    ["notes[]", "", "what was found in recorded runs, and what they say nothing of, each a sentence", ""],
    ["combinations[].*", "", "the columns of `readings.csv`", "the cell of the table is empty"],
];

/// Of `tunnel.json`.
pub const TUNNEL: &[[&str; 4]] = &[
    ["runs", "", "runs through the tunnel", ""],
    ["truth.from_m", "m", "where the tunnel begins", ""],
    ["truth.to_m", "m", "where it ends", ""],
    ["truth.k", "N/kg per (m/s)\u{b2}", "its extra drag by the square of speed", ""],
    [
        "r0_differs_by.backward",
        "1",
        "largest difference of r0 of the paper's mode with and without the tunnel, as a share, with the backward effort",
        "",
    ],
    ["r0_differs_by.forward", "1", "the same with the forward effort", ""],
    ["found[].from_m", "m", "where a tunnel begins that `rundown gap` names", ""],
    ["found[].to_m", "m", "where it ends", ""],
    ["found[].k", "N/kg per (m/s)\u{b2}", "its extra drag by the square of speed", ""],
    ["named[]", "", "all effects that `rundown gap` names", ""],
];
