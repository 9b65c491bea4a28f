//! Fig. 4: histograms of r0, r1, r2 at all samples, and Fig. 7: of cruise speed, final coast and final brake.

use super::{Drawn, Eyes, Picture};
use crate::study::view::{Seen, ViewOutcome};
use rundown::model::resistance::Davis;
use rundown_files::column::{Column, filled};
use rundown_files::statistics::mean_of;
use rundown_files::table::Cell;
use rundown_pages::chart::{Drawing, Figure, Grid, Layer, Panel, Stroke, range_of};
use rundown_pages::colours;
use std::ops::Range;

const BINS: usize = 40;

/// A bin of a histogram.
#[derive(Debug)]
pub struct BinRow {
    quantity: String,
    bin: Range<f64>,
    count: u64,
    of: &'static str,
}

/// The columns of `fig4_davis_*.csv` and `fig7_style_*.csv`.
pub fn columns() -> Vec<Column<BinRow>> {
    let unit = "that of the quantity";
    let quantity = "`r0` (N/kg), `r1` (N/kg per m/s), `r2` (N/kg per (m/s)²), or in Fig. 7 a name with its unit, \
        `true_` before it in truth";
    vec![
        Column::text("quantity", quantity, |row: &BinRow| row.quantity.clone()),
        Column::number("from", unit, "lower edge of the bin, which belongs to it", |row: &BinRow| row.bin.start),
        Column::number("to", unit, "upper edge", |row: &BinRow| row.bin.end),
        Column::count("count", "how many lie in the bin", |row: &BinRow| Cell::Count(row.count)),
        Column::text("of", "of what: `samples` or `runs`", |row: &BinRow| row.of),
    ]
}

/// Counts values in bins of one width; the edges are whole multiples of it.
pub fn bins(values: &[f64], width: f64) -> Vec<(Range<f64>, f64)> {
    let place = |value: f64| (value / width).floor();
    let finite: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
    if finite.is_empty() || width <= 0.0 {
        return Vec::new();
    }
    let ends = range_of(finite.iter().map(|value| place(*value)));
    let count = (ends.end - ends.start) as usize + 1;
    let mut bins: Vec<(Range<f64>, f64)> = (0..count)
        .map(|i| {
            let from = ends.start + i as f64;
            (from * width..(from + 1.0) * width, 0.0)
        })
        .collect();
    for value in finite {
        let index = (place(value) - ends.start) as usize;
        bins[index].1 += 1.0;
    }
    bins
}

pub fn davis(drawn: &[Drawn], eyes: Eyes, manufacturer: &Davis) -> Picture {
    let coefficients = [
        ("r0", "r0, 10\u{207b}\u{b3} N/kg", 1e3, manufacturer.r0),
        ("r1", "r1, 10\u{207b}\u{2074} N/(kg m/s)", 1e4, manufacturer.r1),
        ("r2", "r2, 10\u{207b}\u{2075} N/(kg (m/s)\u{b2})", 1e5, manufacturer.r2),
    ];
    let mut figures = Vec::new();
    let mut rows = Vec::new();
    let mut outside = Vec::new();
    for (index, (name, label, per_unit, stated)) in coefficients.into_iter().enumerate() {
        let samples = drawn.iter().flat_map(|run| &eyes.of(run).points.davis);
        let values: Vec<f64> = samples.map(|davis| per_unit * davis[index]).collect();
        let ends = range_of(values.iter().copied().chain([per_unit * stated]));
        let counted = bins(&values, ((ends.end - ends.start) / BINS as f64).max(1e-9));
        let truths = drawn.iter().flat_map(|run| &run.truth);
        let truths = truths.map(|t| per_unit * t.outcome.davis[index]);
        let mean = mean_of(truths);
        let margin = 0.04 * (ends.end - ends.start).max(1e-6);
        let x = ends.start - margin..ends.end + margin;
        let mut layers = vec![
            Layer::histogram("", colours::MEASURED, 0.5, counted.clone()),
            Layer::verticals("manufacturer", colours::LIMIT, Stroke::Dashed, vec![per_unit * stated]),
        ];
        if x.contains(&mean) {
            layers.push(Layer::verticals("mean truth", colours::TRUTH, Stroke::Solid, vec![mean]));
        } else if mean.is_finite() {
            outside.push(format!("{name} {mean:.3}"));
        }
        figures.push(panel(label, x, layers, "samples"));
        rows.extend(counts(name, "samples", &counted, 1.0 / per_unit));
    }
    let mut caption =
        format!("Occurrence of the coefficients at all samples of {} runs, {} mode.", drawn.len(), eyes.word());
    if !outside.is_empty() {
        caption += &format!(" The mean true values lie outside these axes, in their units: {}.", outside.join(", "));
    }
    Picture {
        name: format!("fig4_davis_{}", eyes.word()),
        caption,
        drawing: grid("Fig. 4: histograms of r0, r1, r2", figures),
        numbers: filled(columns(), rows),
    }
}

pub fn style(drawn: &[Drawn], eyes: Eyes) -> Picture {
    type Pick = fn(&ViewOutcome) -> Option<f64>;
    let quantities: [(&str, &str, f64, Pick); 3] = [
        ("cruise_speed_kmh", "cruise speed, km/h", 1.0, |o| o.cruise_kmh),
        ("final_coast_min", "final coast, min", 0.5, |o| o.coast_s.map(|s| s / 60.0)),
        ("final_brake_s", "final brake, s", 10.0, |o| o.brake_s),
    ];
    let mut figures = Vec::new();
    let mut rows = Vec::new();
    for (name, label, width, pick) in quantities {
        let of = |view: &Seen| pick(&view.outcome);
        let seen: Vec<f64> = drawn.iter().filter_map(|r| of(eyes.of(r))).collect();
        let truths = drawn.iter().flat_map(|run| &run.truth);
        let truths: Vec<f64> = truths.filter_map(of).collect();
        let (seen, truths) = (bins(&seen, width), bins(&truths, width));
        let edges = seen.iter().chain(&truths).flat_map(|(b, _)| [b.start, b.end]);
        let ends = range_of(edges);
        let x = ends.start - width..ends.end + width;
        let mut layers = vec![Layer::histogram(format!("{} mode", eyes.word()), colours::MEASURED, 0.5, seen.clone())];
        if !truths.is_empty() {
            layers.push(Layer::histogram("true", colours::TRUTH, 0.12, truths.clone()));
        }
        figures.push(panel(label, x, layers, "runs"));
        rows.extend(counts(name, "runs", &seen, 1.0));
        rows.extend(counts(&format!("true_{name}"), "runs", &truths, 1.0));
    }
    Picture {
        name: format!("fig7_style_{}", eyes.word()),
        caption: format!(
            "Cruise speed, length of the final coast and of the final brake of {} runs, {} mode.",
            drawn.len(),
            eyes.word()
        ),
        drawing: grid("Fig. 7: cruise speed, final coast, final brake", figures),
        numbers: filled(columns(), rows),
    }
}

fn panel(x_label: &str, x: Range<f64>, layers: Vec<Layer>, of: &str) -> Figure {
    Figure::in_grid(x_label, x, Panel::new(of, 420, layers, "no value"))
}

fn grid(title: &str, figures: Vec<Figure>) -> Drawing {
    Grid::new(title, "Histograms side by side", 3, figures).into()
}

fn counts(name: &str, of: &'static str, bins: &[(Range<f64>, f64)], unit: f64) -> impl Iterator<Item = BinRow> {
    bins.iter().map(move |(bin, count)| BinRow {
        quantity: name.to_owned(),
        bin: bin.start * unit..bin.end * unit,
        count: *count as u64,
        of,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_edge_belongs_to_the_bin_above() {
        let found = bins(&[0.9, 1.0, 2.5, 2.6], 1.0);
        assert_eq!(found, [(0.0..1.0, 1.0), (1.0..2.0, 1.0), (2.0..3.0, 2.0)]);
    }
}
