//! Estimated over true deviation of the resistance: the figure that the paper could not draw.

use super::Picture;
use crate::output::json::mode_word;
use crate::study::slope::{MODES, SelfTest, SlopeLook, fit};
use rundown::estimator::config::Mode;
use rundown_check::figure::HALF_95;
use rundown_files::column::{Column, filled};
use rundown_pages::chart::{Figure, Grid, Layer, Panel, Stroke};
use rundown_pages::colours;

const JUDGED_AT_KMH: f64 = 100.0;
const ENDS: std::ops::Range<f64> = -40.0..40.0;

/// A vehicle as a mode sees it.
#[derive(Debug)]
pub struct SlopeRow {
    mode: &'static str,
    vehicle: usize,
    runs: usize,
    true_deviation: f64,
    estimated_deviation: f64,
    reported_sd: f64,
}

/// The columns of `slope_after_*.csv`.
pub fn columns() -> Vec<Column<SlopeRow>> {
    let of = "deviation of r(v) from its description, as a share of it";
    vec![
        Column::text("mode", "`paper`, `gated` or `measured`", |row: &SlopeRow| row.mode),
        Column::count("vehicle", "number of the simulated vehicle, from 0", |row: &SlopeRow| row.vehicle),
        Column::count("runs", "runs that were learned from", |row: &SlopeRow| row.runs),
        Column::number("speed_kmh", "km/h", "speed v", |_: &SlopeRow| JUDGED_AT_KMH),
        Column::number("true_deviation", "1", &format!("true {of}"), |row: &SlopeRow| row.true_deviation),
        Column::number("estimated_deviation", "1", &format!("estimated {of}"), |row: &SlopeRow| {
            row.estimated_deviation
        }),
        Column::number("reported_sd", "1", "its standard deviation as the mode reports it", |row: &SlopeRow| {
            row.reported_sd
        }),
    ]
}

pub fn slope(test: &SelfTest, runs: usize) -> Picture {
    let (mut figures, mut rows) = (Vec::new(), Vec::new());
    for mode in MODES {
        let of = |look: &&SlopeLook| look.mode == mode && look.runs == runs;
        let mut points = Vec::new();
        let mut bars = Vec::new();
        for look in test.looks.iter().filter(of) {
            let Some([x, y, sd]) = look.deviations(&test.stated, JUDGED_AT_KMH) else {
                continue;
            };
            points.push((100.0 * x, 100.0 * y));
            let half = 100.0 * HALF_95 * sd;
            bars.push(vec![Some((100.0 * x, 100.0 * y - half)), Some((100.0 * x, 100.0 * y + half))]);
            let (mode, vehicle) = (mode_word(mode), look.vehicle);
            rows.push(SlopeRow { mode, vehicle, runs, true_deviation: x, estimated_deviation: y, reported_sd: sd });
        }
        figures.push(panel(mode, points, bars));
    }
    let plural = if runs == 1 { "run" } else { "runs" };
    Picture {
        name: format!("slope_after_{runs}_{plural}"),
        caption: format!(
            "Estimated over true deviation of the running resistance at {JUDGED_AT_KMH} km/h from its description, after {runs} {plural}, with the reported 95 % interval; each dot is a simulated vehicle. On the dashed line the estimate is the truth; on a level line it does not see it."
        ),
        drawing: Grid::new(
            format!("Estimated over true deviation of the resistance after {runs} {plural}"),
            "A panel for each mode: paper, gated, measured",
            MODES.len(),
            figures,
        )
        .into(),
        numbers: filled(columns(), rows),
    }
}

fn panel(mode: Mode, points: Vec<(f64, f64)>, bars: Vec<Vec<Option<(f64, f64)>>>) -> Figure {
    let line = fit(&points);
    let fitted = [ENDS.start, ENDS.end].map(|x| Some((x, line.offset + line.slope * x)));
    Figure::in_grid(
        "true deviation, %",
        ENDS,
        Panel::new(
            "estimated, %",
            560,
            vec![
                Layer::line("", colours::LIMIT, Stroke::Dashed, [ENDS.start, ENDS.end].map(|x| Some((x, x))).to_vec()),
                Layer::threads("", colours::MEASURED, 0.6, bars),
                Layer::dots("", colours::MEASURED, 0.9, points),
                Layer::line(
                    format!("{}: slope {:.2}", mode_word(mode), line.slope),
                    colours::ESTIMATED,
                    Stroke::Solid,
                    fitted.to_vec(),
                ),
            ],
            "no vehicle",
        )
        .within(ENDS),
    )
}
