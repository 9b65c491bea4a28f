//! The columns of a table that is written: name, unit, meaning and when a cell is empty stand once, beside what fills
//! the cell.
//!
//! In: rows of any type. Out: CSV, records for JSON and Parquet, and the document of all columns.

use crate::table::{Cell, Record};
use std::io::{self, Write};
use std::{borrow::Borrow, fmt};

/// What the cells of a column hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Words.
    Text,
    /// A number of things; 0 or 1 where it answers yes or no.
    Count,
    /// A number with a unit.
    Number,
}

impl Kind {
    /// As the document says it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Text => "text",
            Self::Count => "count",
            Self::Number => "number",
        }
    }
}

/// A column without its values.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct About {
    /// Its name in the file.
    pub name: String,
    /// What its cells hold.
    pub kind: Kind,
    /// Unit; empty where there is none.
    pub unit: &'static str,
    /// What it says.
    pub meaning: String,
    /// When a cell is empty; empty itself where that never happens.
    pub empty: &'static str,
}

impl About {
    /// A column that has a unit in its name, or none.
    pub fn new(name: &str, kind: Kind, meaning: &str) -> Self {
        Self { name: name.to_owned(), kind, unit: "", meaning: meaning.to_owned(), empty: "" }
    }
}

/// What columns are, without what fills them.
pub fn about<Row>(columns: Vec<Column<Row>>) -> Vec<About> {
    columns.into_iter().map(|column| column.about).collect()
}

/// A column of a table with rows of this type.
pub struct Column<Row> {
    /// What it is.
    pub about: About,
    cell: Box<dyn Fn(&Row) -> Cell + Send + Sync>,
}

impl<Row> fmt::Debug for Column<Row> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.about.fmt(f)
    }
}

impl<Row: 'static> Column<Row> {
    /// A column of words.
    pub fn text<C: Into<Cell>>(name: &str, meaning: &str, cell: impl Fn(&Row) -> C + Send + Sync + 'static) -> Self {
        Self::new(name, Kind::Text, "", meaning, cell)
    }

    /// A column that counts.
    pub fn count<C: Into<Cell>>(name: &str, meaning: &str, cell: impl Fn(&Row) -> C + Send + Sync + 'static) -> Self {
        Self::new(name, Kind::Count, "", meaning, cell)
    }

    /// A column of numbers with a unit.
    pub fn number<C: Into<Cell>>(
        name: &str,
        unit: &'static str,
        meaning: &str,
        cell: impl Fn(&Row) -> C + Send + Sync + 'static,
    ) -> Self {
        Self::new(name, Kind::Number, unit, meaning, cell)
    }

    fn new<C: Into<Cell>>(
        name: &str,
        kind: Kind,
        unit: &'static str,
        meaning: &str,
        cell: impl Fn(&Row) -> C + Send + Sync + 'static,
    ) -> Self {
        let about = About { name: name.to_owned(), kind, unit, meaning: meaning.to_owned(), empty: "" };
        Self { about, cell: Box::new(move |row| cell(row).into()) }
    }

    /// The same, and when a cell is empty.
    pub fn empty_when(mut self, when: &'static str) -> Self {
        self.about.empty = when;
        self
    }

    /// The same column of rows that have this one as a part.
    pub fn of_part<Whole: 'static>(self, part: impl Fn(&Whole) -> &Row + Send + Sync + 'static) -> Column<Whole> {
        let cell = self.cell;
        Column { about: self.about, cell: Box::new(move |whole| cell(part(whole))) }
    }
}

impl<Row> Column<Row> {
    /// What a row has in it.
    pub fn cell(&self, row: &Row) -> Cell {
        (self.cell)(row)
    }
}

/// A table as columns, whatever its rows were: for formats that go column by column.
pub type Filled = Vec<(About, Vec<Cell>)>;

/// All cells of some rows, column by column.
pub fn cells<Row>(columns: &[Column<Row>], rows: impl IntoIterator<Item: Borrow<Row>>) -> Vec<Vec<Cell>> {
    let mut cells: Vec<Vec<Cell>> = vec![Vec::new(); columns.len()];
    for row in rows {
        for (column, cells) in columns.iter().zip(&mut cells) {
            cells.push(column.cell(row.borrow()));
        }
    }
    cells
}

/// The same with what the columns are.
pub fn filled<Row>(columns: Vec<Column<Row>>, rows: impl IntoIterator<Item: Borrow<Row>>) -> Filled {
    let cells = cells(&columns, rows);
    columns.into_iter().map(|column| column.about).zip(cells).collect()
}

/// A row with the names of its columns.
pub fn record<Row>(columns: &[Column<Row>], row: &Row) -> Record {
    columns.iter().map(|column| (column.about.name.clone(), column.cell(row))).collect()
}

/// The rows of a filled table, each with the names of its columns.
pub fn records(table: &Filled) -> Vec<Record> {
    let rows = table.first().map_or(0, |(_, cells)| cells.len());
    let record = |row: usize| table.iter().map(|(about, cells)| (about.name.clone(), cells[row].clone())).collect();
    (0..rows).map(record).collect()
}

/// Writes a filled table as CSV, a header line first.
///
/// # Errors
/// Those of `writer`.
pub fn write_filled(writer: impl Write, table: &Filled) -> io::Result<()> {
    let mut csv = csv::Writer::from_writer(writer);
    csv.write_record(table.iter().map(|(about, _)| &about.name))?;
    let rows = table.first().map_or(0, |(_, cells)| cells.len());
    for row in 0..rows {
        csv.write_record(table.iter().map(|(_, cells)| cells[row].to_field()))?;
    }
    csv.flush()
}

/// Writes rows as CSV, a header line first.
///
/// # Errors
/// Those of `writer`.
pub fn write_csv<Row>(
    writer: impl Write,
    columns: &[Column<Row>],
    rows: impl IntoIterator<Item: Borrow<Row>>,
) -> io::Result<()> {
    let mut csv = csv::Writer::from_writer(writer);
    csv.write_record(columns.iter().map(|column| &column.about.name))?;
    for row in rows {
        csv.write_record(columns.iter().map(|column| column.cell(row.borrow()).to_field()))?;
    }
    csv.flush()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_written_by_their_columns_and_a_table_without_rows_has_its_header() {
        let half = Column::number("half_m", "m", "half of it", |row: &f64| Some(0.5 * row)).empty_when("never");
        let word = Column::text("word", "which", |row: &f64| if *row > 1.0 { "much" } else { "little" });
        let columns = [half, word];
        let text = |rows: &[f64]| {
            let mut bytes = Vec::new();
            write_csv(&mut bytes, &columns, rows).unwrap();
            String::from_utf8(bytes).unwrap()
        };
        assert_eq!(text(&[]), "half_m,word\n");
        assert_eq!(text(&[1.0, 4.0]), "half_m,word\n0.5,little\n2.0,much\n");
        assert_eq!(record(&columns, &4.0)[1], ("word".to_owned(), Cell::from("much")));
        let found = filled(columns.into(), [4.0]);
        assert_eq!((found[0].0.unit, &found[1].1), ("m", &vec![Cell::from("much")]));
        let mut bytes = Vec::new();
        write_filled(&mut bytes, &found).unwrap();
        assert_eq!(String::from_utf8(bytes).unwrap(), "half_m,word\n2.0,much\n");
        assert_eq!(records(&found)[0][1], ("word".to_owned(), Cell::from("much")));
    }
}
