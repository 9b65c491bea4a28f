//! What an experiment says: its rows, a table of means, one picture.

use super::plan::Plan;
use crate::output::json::mode_word;
use crate::study::figures::Picture;
use crate::study::moments::Moments;
use plotters::style::RGBColor;
use rundown::estimator::config::Mode;
use rundown_files::column::{self, Column, Filled, filled};
use rundown_pages::chart::{Figure, Grid, Layer, Panel, Stroke, range_of};
use rundown_pages::{colours, numbers};

/// Who says a number: a mode, a filter of the experiment, or the truth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arm {
    pub name: &'static str,
    pub colour: RGBColor,
}

impl Arm {
    pub const TRUTH: Self = Self { name: "truth", colour: colours::TRUTH };

    pub const fn of(mode: Mode) -> Self {
        let colour = match mode {
            Mode::Paper => colours::ESTIMATED,
            Mode::Gated => colours::MEASURED,
            Mode::Measured => colours::GRADIENT,
        };
        Self { name: mode_word(mode), colour }
    }
}

/// What an arm says of a set of runs; a value for each column.
#[derive(Clone, Debug, PartialEq)]
pub struct ArmRow {
    pub variant: String,
    pub x: f64,
    pub arm: Arm,
    /// Counted from 0.
    pub set: usize,
    pub values: Vec<Option<f64>>,
}

/// What an arm says of a variant over all sets, in words.
#[derive(Clone, Debug, PartialEq)]
pub struct TableRow<'a> {
    pub variant: &'a str,
    pub arm: &'static str,
    pub cells: Vec<String>,
}

/// Between two arms of a kind, where the next kind is 1 away.
const ASIDE: f64 = 0.12;

/// The axis on which the variants stand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VariantAxis {
    /// At their values; the name ends with their unit.
    Values(&'static str),
    /// Side by side, each under its name.
    Kinds(&'static str),
}

impl VariantAxis {
    const fn label(self) -> &'static str {
        match self {
            Self::Values(label) | Self::Kinds(label) => label,
        }
    }
}

#[derive(Clone, Debug)]
pub struct Answer {
    pub name: &'static str,
    pub question: &'static str,
    pub axis: VariantAxis,
    /// Name with its unit, and label of the axis.
    pub columns: Vec<(&'static str, &'static str)>,
    pub rows: Vec<ArmRow>,
    /// What is said besides, each a sentence.
    pub notes: Vec<String>,
    sets: usize,
    runs: usize,
    seed: u64,
}

impl Answer {
    pub fn new(
        plan: &Plan<'_>,
        axis: VariantAxis,
        columns: Vec<(&'static str, &'static str)>,
        rows: Vec<ArmRow>,
    ) -> Self {
        let Plan { name, question, sets, runs, seed, .. } = *plan;
        Self { name, question, axis, columns, rows, notes: Vec::new(), sets, runs, seed }
    }

    /// With a sentence more.
    pub fn noting(mut self, note: String) -> Self {
        self.notes.push(note);
        self
    }

    /// Variants and arms in the order in which they came.
    fn groups(&self) -> Vec<(&str, f64, Arm)> {
        let mut groups: Vec<(&str, f64, Arm)> = Vec::new();
        for row in &self.rows {
            let group = (row.variant.as_str(), row.x, row.arm);
            if !groups.contains(&group) {
                groups.push(group);
            }
        }
        groups
    }

    /// Of a column, over the sets.
    pub fn moments(&self, variant: &str, arm: &str, column: usize) -> Moments {
        let of = self.rows.iter().filter(|row| row.variant == variant && row.arm.name == arm);
        of.filter_map(|row| row.values[column]).collect()
    }

    /// The table: a row for each variant and arm, a cell for each column.
    pub fn table(&self) -> Vec<TableRow<'_>> {
        let cell = |variant: &str, arm: Arm, column: usize| {
            let found = self.moments(variant, arm.name, column);
            match (found.mean(), found.sd()) {
                (Some(mean), Some(sd)) => format!("{} \u{b1} {}", short(mean), short(sd)),
                (Some(mean), None) => short(mean),
                _ => numbers::NOTHING.to_owned(),
            }
        };
        let row = |(variant, _, arm): (_, f64, Arm)| TableRow {
            variant,
            arm: arm.name,
            cells: (0..self.columns.len()).map(|column| cell(variant, arm, column)).collect(),
        };
        self.groups().into_iter().map(row).collect()
    }

    /// The table on the screen.
    pub fn words(&self) -> String {
        let rows = self.table();
        let wide = rows.iter().map(|row| row.variant.chars().count()).max().unwrap_or(0).max(7);
        let arms = rows.iter().map(|row| row.arm.chars().count()).max().unwrap_or(0).max(4);
        let mut text = format!("{}: {}\n\n{:wide$} {:arms$}", self.name, self.question, "variant", "mode");
        for (name, _) in &self.columns {
            text += &format!("  {name:>18}");
        }
        text += "\n";
        for TableRow { variant, arm, cells } in rows {
            text += &format!("{variant:wide$} {arm:arms$}");
            for (cell, (name, _)) in cells.iter().zip(&self.columns) {
                text += &format!("  {cell:>width$}", width = name.chars().count().max(18));
            }
            text += "\n";
        }
        for note in &self.notes {
            text += &format!("\n{note}\n");
        }
        text + &format!("\nMean \u{b1} standard deviation over {}.\n", self.extent())
    }

    fn extent(&self) -> String {
        format!("{} sets of {} simulated runs, seed {}", self.sets, self.runs, self.seed)
    }

    /// A row for each set, variant and arm.
    pub fn numbers(&self) -> Filled {
        filled(columns(&self.columns), &self.rows)
    }

    pub fn picture(&self) -> Picture {
        let figures = (0..self.columns.len()).map(|column| self.panel(column)).collect();
        Picture {
            name: self.name.to_owned(),
            caption: format!("{} Mean and standard deviation over {}.", self.question, self.extent()),
            drawing: Grid::new(format!("Experiment: {}", self.name), self.question, 2, figures).into(),
            numbers: self.numbers(),
        }
    }

    /// What stands at which place of the axis, where that are kinds.
    pub fn names(&self) -> Vec<(f64, String)> {
        let mut names: Vec<(f64, String)> = Vec::new();
        if let VariantAxis::Kinds(_) = self.axis {
            names.extend(self.groups().into_iter().map(|(variant, x, _)| (x, variant.to_owned())));
            names.dedup();
        }
        names
    }

    fn panel(&self, column: usize) -> Figure {
        let groups = self.groups();
        let ends = range_of(groups.iter().map(|(_, x, _)| *x));
        let margin = match self.axis {
            VariantAxis::Values(_) => 0.06 * (ends.end - ends.start).max(1e-6),
            VariantAxis::Kinds(_) => 0.5,
        };
        let x = ends.start - margin..ends.end + margin;
        let mut arms: Vec<Arm> = Vec::new();
        for (.., arm) in &groups {
            if !arms.contains(arm) {
                arms.push(*arm);
            }
        }
        let mut layers = Vec::new();
        let middle = 0.5 * (arms.len() as f64 - 1.0);
        for (number, arm) in arms.into_iter().enumerate() {
            // Of kinds the arms stand beside each other, so that none hides another.
            let aside = match self.axis {
                VariantAxis::Values(_) => 0.0,
                VariantAxis::Kinds(_) => ASIDE * (number as f64 - middle),
            };
            let (mut line, mut bars) = (Vec::new(), Vec::new());
            for (variant, x, _) in groups.iter().filter(|(.., of)| *of == arm) {
                let found = self.moments(variant, arm.name, column);
                let Some(mean) = found.mean() else { continue };
                let sd = found.sd().unwrap_or(0.0);
                let x = *x + aside;
                line.push(Some((x, mean)));
                bars.push(vec![Some((x, mean - sd)), Some((x, mean + sd))]);
            }
            let dots = line.iter().flatten().copied().collect();
            layers.push(Layer::threads("", arm.colour, 0.8, bars));
            match self.axis {
                VariantAxis::Values(_) => {
                    layers.push(Layer::line(arm.name, arm.colour, Stroke::Thin, line));
                    layers.push(Layer::dots("", arm.colour, 1.0, dots));
                }
                // Between two kinds there is nothing.
                VariantAxis::Kinds(_) => layers.push(Layer::dots(arm.name, arm.colour, 1.0, dots)),
            }
        }
        let panel = Panel::new(self.columns[column].1, 420, layers, "no value");
        Figure::in_grid(self.axis.label(), x, panel).with_names(self.names())
    }
}

/// The columns of an experiment's CSV; `measured` has a name and a label that ends with its unit, if it has one.
pub fn columns(measured: &[(&'static str, &'static str)]) -> Vec<Column<ArmRow>> {
    let of_axis = "that of the axis";
    let mut columns = vec![
        Column::text("variant", "what is varied", |row: &ArmRow| row.variant.clone()),
        Column::number("x", of_axis, "where the variant stands on the axis of the picture", |row: &ArmRow| row.x),
        Column::text("mode", "a mode, a filter of the experiment, or `truth`", |row: &ArmRow| row.arm.name),
        Column::count("set", "number of the set of runs, from 1", |row: &ArmRow| row.set + 1),
    ];
    columns.extend(measured.iter().enumerate().map(|(index, (name, label))| {
        let (meaning, unit) = label.rsplit_once(", ").unwrap_or((label, "1"));
        Column::number(name, unit, meaning, move |row: &ArmRow| row.values[index]).empty_when("nothing is known of it")
    }));
    columns
}

/// Three digits that count.
fn short(value: f64) -> String {
    let digits = match value.abs() {
        size if size >= 100.0 => 0,
        size if size >= 10.0 => 1,
        size if size >= 0.1 || size == 0.0 => 2,
        _ => 4,
    };
    numbers::number(value, digits)
}

pub fn to_json(answer: &Answer) -> serde_json::Value {
    let rows: Vec<_> = column::records(&answer.numbers()).iter().map(rundown_files::table::to_json).collect();
    serde_json::json!({
        "experiment": answer.name,
        "question": answer.question,
        "sets": answer.sets,
        "runs": answer.runs,
        "seed": answer.seed,
        "rows": rows,
        "notes": answer.notes,
    })
}
