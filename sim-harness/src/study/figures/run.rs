//! Figs. 3, 5 and 6: one run through one pair of eyes, and what was true.

use super::{Eyes, NO_TRUTH, Picture};
use crate::report::{RunView, TruthView, figures};
use crate::{study::case::CaseTruth, study::gather::Example, study::view::dropped_words};
use rundown::tick::estimate::Estimate;
use rundown::tick::regime::Regime;
use rundown::{model::resistance::Davis, model::state, model::train::Train};
use rundown_files::column::{Column, filled};
use rundown_files::replay::ReplayedRun;
use rundown_pages::chart::Drawing;
use rundown_truth::{sensors::TruthSample, train::DavisTruth};

pub fn pictures(example: &Example, eyes: Eyes, train: &Train) -> [Picture; 3] {
    let run = eyes.pick(&example.paper, &example.gated);
    let with_regimes = eyes.pick(example.features(), &example.gated);
    let truth = example.truth.as_ref().map(truth_view);
    let [view, view_of_regimes] = [run, with_regimes].map(|run| RunView::of(run, truth.as_ref()));
    let word = eyes.word();
    let [rows, rows_of_regimes] = [run, with_regimes].map(|run| rows(run, example.truth.as_ref(), train));
    let picture =
        |name: &str, caption: String, drawing: Drawing, columns: Vec<Column<SampleRow>>, rows: &[SampleRow]| Picture {
            name: format!("{name}_{word}"),
            caption,
            drawing,
            numbers: filled(columns, rows),
        };
    let of = format!("{}, {word} mode", run.name);
    let dropped = if eyes == Eyes::Paper { dropped_words(run) } else { None };
    let dropped = dropped.map_or_else(String::new, |words| format!(" {words}."));
    [
        picture(
            "fig3_run",
            format!(
                "Speed, acceleration, effort and the three coefficients of {of}. Dashed: the largest deceleration, the largest tractive effort at each speed, the manufacturer's coefficients.{dropped}"
            ),
            figures::motion(&view, train),
            motion_columns(),
            &rows,
        ),
        picture(
            "fig5_resistance",
            format!(
                "Terms of the running resistance of {of}, stacked, and the resistance of the gradient in the same scale on the right axis."
            ),
            figures::resistance_terms(&view),
            term_columns(),
            &rows,
        ),
        picture(
            "fig6_regimes",
            format!("Driving regimes of {of}."),
            figures::regimes(&view_of_regimes),
            regime_columns(),
            &rows_of_regimes,
        ),
    ]
}

fn davis(truth: &CaseTruth) -> Davis {
    let DavisTruth { r0, r1, r2 } = truth.facts.davis;
    Davis { r0, r1, r2 }
}

/// What is drawn of the truth.
pub fn truth_view(truth: &CaseTruth) -> TruthView {
    let facts = &truth.facts;
    let starts = facts.final_coast.iter().chain([&facts.final_brake]);
    TruthView {
        davis: davis(truth),
        effort_n_per_kg: truth.samples.iter().map(|s| s.mean_effort_n_per_kg).collect(),
        resistance_n_per_kg: truth.samples.iter().map(|s| s.resistance_n_per_kg).collect(),
        starts: starts.map(|mark| (mark.location_m, mark.speed_mps)).collect(),
    }
}

/// What is drawn of a sample, and what was true.
#[derive(Debug)]
pub struct SampleRow {
    estimate: Estimate,
    measured_mps: Option<f64>,
    regime: Regime,
    max_effort_n_per_kg: f64,
    truth: Option<(Option<TruthSample>, Davis)>,
}

impl SampleRow {
    fn speed_mps(&self) -> f64 {
        self.estimate.belief.mean[state::SPEED]
    }

    fn terms_n_per_kg(&self) -> [f64; 3] {
        self.estimate.davis().terms_n_per_kg(self.speed_mps())
    }

    fn sample(&self) -> Option<TruthSample> {
        self.truth.and_then(|(sample, _)| sample)
    }

    fn true_davis(&self) -> Option<Davis> {
        self.truth.map(|(_, davis)| davis)
    }
}

fn rows(run: &ReplayedRun, truth: Option<&CaseTruth>, train: &Train) -> Vec<SampleRow> {
    let row = |(index, estimate): (usize, &Estimate)| SampleRow {
        estimate: *estimate,
        measured_mps: run.measurements.get(index).and_then(|measurement| measurement.speed_mps),
        regime: *run.regimes.get(index).unwrap_or(&estimate.regime),
        max_effort_n_per_kg: train.max_effort_n_per_kg(estimate.belief.mean[state::SPEED].max(0.0)),
        truth: truth.map(|truth| (truth.samples.get(index).copied(), davis(truth))),
    };
    run.estimates.iter().enumerate().map(row).collect()
}

fn place() -> Vec<Column<SampleRow>> {
    vec![
        Column::number("time_s", "s", "time of the sample", |row: &SampleRow| row.estimate.time_s),
        Column::number("location_m", "m", "estimated location", |row: &SampleRow| {
            row.estimate.belief.mean[state::LOCATION]
        }),
    ]
}

fn estimated_kmh() -> Column<SampleRow> {
    Column::number("estimated_kmh", "km/h", "estimated speed", |row: &SampleRow| 3.6 * row.speed_mps())
}

/// The columns of `fig3_run_*.csv`.
pub fn motion_columns() -> Vec<Column<SampleRow>> {
    let missing = "a reading was missing, or the run begins here";
    let true_effort = |row: &SampleRow| row.sample().map(|sample| sample.mean_effort_n_per_kg);
    let mut columns = place();
    columns.extend([
        Column::number("measured_kmh", "km/h", "measured speed", |row: &SampleRow| {
            row.measured_mps.map(|mps| 3.6 * mps)
        })
        .empty_when("the reading was missing"),
        estimated_kmh(),
        Column::number("acceleration_mps2", "m/s\u{b2}", "mean since the sample before", |row: &SampleRow| {
            row.estimate.acceleration_mps2
        })
        .empty_when(missing),
        Column::number(
            "effort_n_per_kg",
            "N/kg",
            "estimated effort, mean since the sample before",
            |row: &SampleRow| row.estimate.effort_n_per_kg,
        )
        .empty_when(missing),
        Column::number(
            "max_effort_n_per_kg",
            "N/kg",
            "described largest tractive effort at this speed",
            |row: &SampleRow| row.max_effort_n_per_kg,
        ),
    ]);
    columns.extend(coefficients("", "estimated", |row| Some(row.estimate.davis()), ""));
    columns.push(
        Column::number("true_effort_n_per_kg", "N/kg", "true effort, mean since the sample before", true_effort)
            .empty_when(NO_TRUTH),
    );
    columns.extend(coefficients("true_", "true", SampleRow::true_davis, NO_TRUTH));
    columns
}

fn coefficients(
    prefix: &str,
    word: &str,
    davis: fn(&SampleRow) -> Option<Davis>,
    empty: &'static str,
) -> impl Iterator<Item = Column<SampleRow>> {
    let units = ["N/kg", "N/kg per m/s", "N/kg per (m/s)\u{b2}"];
    let column = |(index, unit): (usize, &'static str)| {
        let meaning = format!("{word} Davis coefficient");
        let of = move |row: &SampleRow| davis(row).map(|davis| [davis.r0, davis.r1, davis.r2][index]);
        Column::number(&format!("{prefix}r{index}"), unit, &meaning, of).empty_when(empty)
    };
    units.into_iter().enumerate().map(column).collect::<Vec<_>>().into_iter()
}

/// The columns of `fig5_resistance_*.csv`.
pub fn term_columns() -> Vec<Column<SampleRow>> {
    let mut columns = place();
    let terms = [("constant", "r0"), ("linear", "r1 v"), ("quadratic", "r2 v\u{b2}")];
    columns.extend(terms.into_iter().enumerate().map(|(index, (name, term))| {
        let of = move |row: &SampleRow| row.terms_n_per_kg()[index];
        Column::number(&format!("{name}_n_per_kg"), "N/kg", &format!("term {term} of the running resistance"), of)
    }));
    let of_truth = |row: &SampleRow| row.sample().map(|sample| sample.resistance_n_per_kg);
    columns.extend([
        Column::number(
            "gradient_n_per_kg",
            "N/kg",
            "resistance of the gradient, uphill positive",
            |row: &SampleRow| row.estimate.gradient_n_per_kg,
        ),
        Column::number("true_resistance_n_per_kg", "N/kg", "true running resistance", of_truth).empty_when(NO_TRUTH),
    ]);
    columns
}

/// The columns of `fig6_regimes_*.csv`.
pub fn regime_columns() -> Vec<Column<SampleRow>> {
    let of_truth = |row: &SampleRow| row.sample().map(|sample| sample.regime.as_str());
    let mut columns = place();
    columns.extend([
        estimated_kmh(),
        Column::text("regime", "regime as known one sample later", |row: &SampleRow| row.regime.as_str()),
        Column::text("true_regime", "what the driver did", of_truth).empty_when(NO_TRUTH),
    ]);
    columns
}
