//! What `WIRE.md` says: its tables, and the ranges in them.

use host_tests::fields::{Fields, varint};
use std::collections::BTreeMap;

/// A table of the document.
pub struct Table {
    columns: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Table {
    /// The cells of a row in these columns.
    pub fn cells<const N: usize>(&self, columns: [&str; N]) -> impl Iterator<Item = [&str; N]> {
        let at = columns.map(|name| {
            let found = self.columns.iter().position(|column| column == name);
            found.unwrap_or_else(|| panic!("no column {name} in {:?}", self.columns))
        });
        self.rows.iter().map(move |row| at.map(|column| row[column].as_str()))
    }

    pub fn has(&self, column: &str) -> bool {
        self.columns.iter().any(|found| found == column)
    }
}

/// All tables, each by the last word of the heading that stands above it: the type that it describes.
pub struct Tables(BTreeMap<String, Table>);

impl Tables {
    pub fn read() -> Self {
        let document = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../WIRE.md")).expect("WIRE.md");
        let mut tables = BTreeMap::<String, Table>::new();
        let mut heading = "";
        for line in document.lines() {
            if line.starts_with('#') {
                heading = line.rsplit(' ').next().unwrap_or_default().trim_matches('`');
            } else if let Some(row) = line.strip_prefix("| ") {
                let cells = row.trim_end_matches('|').split('|');
                let cells: Vec<String> = cells.map(|cell| cell.trim().replace('`', "")).collect();
                match tables.get_mut(heading) {
                    Some(table) => table.rows.push(cells),
                    None => drop(tables.insert(heading.into(), Table { columns: cells, rows: Vec::new() })),
                }
            }
        }
        Self(tables)
    }

    pub fn find(&self, name: &str) -> Option<&Table> {
        self.0.get(name)
    }

    pub fn of(&self, name: &str) -> &Table {
        self.find(name).unwrap_or_else(|| panic!("WIRE.md has no table of {name}"))
    }

    /// How many ranges there are in the tables of fields.
    pub fn ranges(&self) -> usize {
        let tables = self.0.values().filter(|table| table.has("range"));
        tables.flat_map(|table| table.cells(["range"])).filter(|[cell]| cell.contains(" .. ")).count()
    }

    /// How many defaults there are in the tables of settings.
    pub fn defaults(&self) -> usize {
        let tables = self.0.values().filter(|table| table.has("default"));
        tables.map(|table| table.cells(["default"]).count()).sum()
    }

    /// Fields that are lists, with the most items that they hold.
    pub fn lists(&self) -> impl Iterator<Item = (&str, &str)> {
        let tables = self.0.values().filter(|table| table.has("field"));
        let rows = tables.flat_map(|table| table.cells(["field", "type"]));
        rows.filter_map(|[field, kind]| Some((field, kind.split_once(" up to ")?.1)))
    }

    /// Number and word of each value of an enum, in its own table or in the one of all enums.
    pub fn numbers(&self, name: &str) -> Vec<(String, String)> {
        let own = |[number, word]: [&str; 2]| (number.to_owned(), word.to_owned());
        match self.find(name) {
            Some(table) => table.cells(["number", "word"]).map(own).collect(),
            None => {
                let all = self.of("Enums").cells(["enum", "number", "word"]);
                all.filter(|[of, ..]| *of == name).map(|[_, number, word]| own([number, word])).collect()
            }
        }
    }
}

/// A range as `0.01 .. 5`; in a train's table also as a multiple of the rotating mass.
pub fn range(cell: &str, rotating_mass_kg: f64) -> Option<[f64; 2]> {
    let (least, most) = cell.split_once(" .. ")?;
    let number = |text: &str| match text.strip_suffix(" γ m") {
        Some(share) => share.parse::<f64>().unwrap() * rotating_mass_kg,
        None => text.parse().unwrap(),
    };
    Some([number(least), number(most)])
}

/// A message with another number in one field (of an array: in its first item).
pub fn with_number(fields: &Fields, path: &str, value: f64) -> Vec<u8> {
    let field = fields.fields.iter().rfind(|field| field.path == path && !["some", "none"].contains(&&*field.value));
    let field = field.unwrap_or_else(|| panic!("no field {path}"));
    let put = |of: &host_tests::fields::Field| match of.bytes.as_slice() {
        bytes if !std::ptr::eq(of, field) => bytes.to_vec(),
        bytes if bytes.len() >= 8 => [&value.to_le_bytes(), &bytes[8..]].concat(),
        _ => varint(value as u64),
    };
    fields.fields.iter().flat_map(put).collect()
}
