//! Figs. 3, 5 and 6: one run through one pair of eyes, and what was true.

use super::{Eyes, Picture, number, text};
use crate::report::{RunView, TruthView, figures};
use crate::{study::case::CaseTruth, study::gather::Example};
use rundown::{model::resistance::Davis, model::state, model::train::Train};
use rundown_files::{replay::ReplayedRun, table::Record};
use rundown_pages::chart::Drawing;

pub fn pictures(example: &Example, eyes: Eyes, train: &Train) -> [Picture; 3] {
    let run = eyes.pick(&example.paper, &example.gated);
    let truth = example.truth.as_ref().map(truth_view);
    let view = RunView::of(run, truth.as_ref());
    let word = eyes.word();
    let picture = |name: &str, caption: String, drawing: Drawing, columns: &str| Picture {
        name: format!("{name}_{word}"),
        caption,
        drawing,
        records: records(run, example.truth.as_ref(), train, columns),
    };
    let of = format!("{}, {word} mode", run.name);
    [
        picture(
            "fig3_run",
            format!(
                "Speed, acceleration, effort and the three coefficients of {of}. Dashed: the largest deceleration, the largest tractive effort at each speed, the manufacturer's coefficients."
            ),
            figures::motion(&view, train),
            "measured_kmh estimated_kmh acceleration_mps2 effort_n_per_kg max_effort_n_per_kg r0 r1 r2 \
                true_effort_n_per_kg true_r0 true_r1 true_r2",
        ),
        picture(
            "fig5_resistance",
            format!(
                "Terms of the running resistance of {of}, stacked, and the resistance of the gradient in the same scale on the right axis."
            ),
            figures::resistance_terms(&view),
            "constant_n_per_kg linear_n_per_kg quadratic_n_per_kg gradient_n_per_kg true_resistance_n_per_kg",
        ),
        picture(
            "fig6_regimes",
            format!("Driving regimes of {of}."),
            figures::regimes(&view),
            "estimated_kmh regime true_regime",
        ),
    ]
}

/// What is drawn of the truth.
pub fn truth_view(truth: &CaseTruth) -> TruthView {
    let facts = &truth.facts;
    let starts = facts.final_coast.iter().chain([&facts.final_brake]);
    TruthView {
        davis: Davis { r0: facts.davis.r0, r1: facts.davis.r1, r2: facts.davis.r2 },
        effort_n_per_kg: truth.samples.iter().map(|s| s.mean_effort_n_per_kg).collect(),
        resistance_n_per_kg: truth.samples.iter().map(|s| s.resistance_n_per_kg).collect(),
        starts: starts.map(|mark| (mark.location_m, mark.speed_mps)).collect(),
    }
}

/// Time, location and the columns asked for, a row a sample.
fn records(run: &ReplayedRun, truth: Option<&CaseTruth>, train: &Train, columns: &str) -> Vec<Record> {
    let rows = run.estimates.iter().enumerate();
    rows.map(|(index, estimate)| {
        let speed_mps = estimate.belief.mean[state::SPEED];
        let davis = estimate.davis();
        let terms = davis.terms_n_per_kg(speed_mps);
        let measured = run.measurements.get(index).and_then(|m| m.speed_mps);
        let sample = truth.and_then(|truth| truth.samples.get(index));
        let true_davis = truth.map(|truth| truth.facts.davis);
        let mut record =
            vec![number("time_s", estimate.time_s), number("location_m", estimate.belief.mean[state::LOCATION])];
        record.extend(columns.split_whitespace().map(|column| match column {
            "measured_kmh" => number(column, measured.map(|v| 3.6 * v)),
            "estimated_kmh" => number(column, 3.6 * speed_mps),
            "acceleration_mps2" => number(column, estimate.acceleration_mps2),
            "effort_n_per_kg" => number(column, estimate.effort_n_per_kg),
            "max_effort_n_per_kg" => number(column, train.max_effort_n_per_kg(speed_mps.max(0.0))),
            "r0" => number(column, davis.r0),
            "r1" => number(column, davis.r1),
            "r2" => number(column, davis.r2),
            "constant_n_per_kg" => number(column, terms[0]),
            "linear_n_per_kg" => number(column, terms[1]),
            "quadratic_n_per_kg" => number(column, terms[2]),
            "gradient_n_per_kg" => number(column, estimate.gradient_n_per_kg),
            "regime" => text(column, run.regimes.get(index).unwrap_or(&estimate.regime).as_str()),
            "true_regime" => text(column, sample.map_or("", |s| s.regime.as_str())),
            "true_effort_n_per_kg" => number(column, sample.map(|s| s.mean_effort_n_per_kg)),
            "true_resistance_n_per_kg" => number(column, sample.map(|s| s.resistance_n_per_kg)),
            "true_r0" => number(column, true_davis.map(|d| d.r0)),
            "true_r1" => number(column, true_davis.map(|d| d.r1)),
            "true_r2" => number(column, true_davis.map(|d| d.r2)),
            other => number(other, None),
        }));
        record
    })
    .collect()
}
