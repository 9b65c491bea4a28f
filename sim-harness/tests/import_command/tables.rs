//! Workbooks and Parquet become run logs.

use super::*;
use rundown_files::column::{About, Kind};
use rundown_files::parquet::TableWriter;
use rundown_files::table::{Cell, Record};

#[test]
fn a_workbook_is_read() {
    let folder = Folder::new();
    let mut book = rust_xlsxwriter::Workbook::new();
    book.add_worksheet().set_name("Notes").unwrap().write(0, 0, "made by hand").unwrap();
    let sheet = book.add_worksheet().set_name("Log").unwrap();
    let date = rust_xlsxwriter::Format::new().set_num_format("yyyy-mm-dd hh:mm:ss");
    sheet.write(0, 0, "Unit 7").unwrap();
    for (column, name) in ["Fecha y hora", "Distancia (m)", "Velocidad (km/h)", "Fecha hora"].into_iter().enumerate() {
        sheet.write(2, column as u16, name).unwrap();
    }
    let rows = drive(&STOPS_M, 30.0);
    for (row, (t, x, v)) in (3..).zip(&rows) {
        sheet.write(row, 1, *x).unwrap();
        sheet.write(row, 2, 3.6 * v).unwrap();
        sheet.write_with_format(row, 3, 45_700.25 + t / 86_400.0, &date).unwrap();
    }
    book.save(folder.path("log.xlsx")).unwrap();
    folder.done(&["import", "log.xlsx"]);
    let found = csv(&folder, "runs/log_01.csv");
    assert_eq!(found.len(), rows.len());
    near(last(&found)[0], rows.last().unwrap().0, 0.01);
    near(last(&found)[1], 11_900.0, 1.0);
    assert!(folder.read("runs/runs.csv").contains("2025-02-12T06:00:00Z"), "{}", folder.read("runs/runs.csv"));
}

#[test]
fn a_table_of_parquet_is_read_and_split_by_its_runs() {
    let folder = Folder::new();
    let mut records: Vec<Record> = Vec::new();
    for (number, begin) in [("101", 0.0), ("102", 2000.0)] {
        for (t, x, v) in drive(&STOPS_M, 30.0) {
            let cells = [
                ("zugnummer", Cell::Text(number.to_owned())),
                ("time_s", Cell::Number(begin + t)),
                ("location_m", Cell::Number(x)),
                ("v [m/s]", Cell::Number(v)),
            ];
            records.push(cells.map(|(name, cell)| (name.to_owned(), cell)).to_vec());
        }
    }
    let number = |name| About::new(name, Kind::Number, "");
    let columns =
        vec![About::new("zugnummer", Kind::Text, ""), number("time_s"), number("location_m"), number("v [m/s]")];
    let mut writer = TableWriter::new(&folder.path("log.parquet"), columns);
    writer.write(&records).unwrap();
    writer.close().unwrap();
    folder.done(&["import", "log.parquet", "--chainage", "as-is"]);
    for name in ["runs/log_101_01.csv", "runs/log_102_01.csv"] {
        near(csv(&folder, name).iter().map(|row| row[2]).fold(0.0, f64::max), 108.0, 0.1);
    }
}

/// A sheet of rows, its times after so many seconds.
fn sheet_of(book: &mut rust_xlsxwriter::Workbook, name: &str, begin_s: f64, rows: &[(f64, f64, f64)]) {
    let sheet = book.add_worksheet().set_name(name).unwrap();
    for (column, header) in ["Zeit [s]", "Weg [m]", "v [km/h]"].into_iter().enumerate() {
        sheet.write(0, column as u16, header).unwrap();
    }
    for (row, (t, x, v)) in (1..).zip(rows) {
        for (column, value) in [begin_s + t, *x, 3.6 * v].into_iter().enumerate() {
            sheet.write(row, column as u16, value).unwrap();
        }
    }
}

const OTHER_SHEETS: &str = "sheets with other columns, not read";

#[test]
fn sheets_with_the_same_header_are_one_log() {
    let (folder, rows) = (Folder::new(), drive(&STOPS_M, 30.0));
    let mut book = rust_xlsxwriter::Workbook::new();
    for (day, name) in (0..).zip(["Monday", "Tuesday", "Wednesday"]) {
        sheet_of(&mut book, name, 86_400.0 * f64::from(day), &rows);
    }
    book.add_worksheet().set_name("Empty").unwrap();
    book.save(folder.path("days.xlsx")).unwrap();
    let said = folder.done(&["import", "days.xlsx", "--chainage", "as-is", "--strict"]);
    assert!(said.out.contains("3 runs in"), "{}", said.out);
    for run in 1..=3 {
        assert_eq!(csv(&folder, &format!("runs/days_{run:02}.csv")).len(), rows.len());
    }
    let preview = folder.done(&["import", "--preview", "days.xlsx"]).out;
    assert!(preview.contains("sheets Monday, Tuesday, Wednesday"), "{preview}");
    folder.done(&["import", "--mapping", "runs/import.toml", "--out", "again"]);
    assert_eq!(folder.read("runs/days_03.csv"), folder.read("again/days_03.csv"));
    assert_eq!(folder.read("runs/import.toml"), folder.read("again/import.toml"));
    // One of them is asked for: the others are no loss.
    folder.write("m.toml", "[[source]]\nlayout.sheet = \"Tuesday\"\n");
    let said = folder.done(&["import", "days.xlsx", "--mapping", "m.toml", "--out", "one", "--strict"]);
    assert!(said.out.contains("1 run in"), "{}", said.out);
}

#[test]
fn sheets_whose_times_begin_again_are_runs_of_their_own() {
    let (folder, rows) = (Folder::new(), drive(&STOPS_M, 30.0));
    let mut book = rust_xlsxwriter::Workbook::new();
    ["Out", "Again"].into_iter().for_each(|name| sheet_of(&mut book, name, 0.0, &rows));
    book.save(folder.path("trips.xlsx")).unwrap();
    let said = folder.done(&["import", "trips.xlsx", "--chainage", "as-is", "--strict"]);
    assert!(said.out.contains("2 runs in"), "{}", said.out);
    assert_eq!(csv(&folder, "runs/trips_01.csv"), csv(&folder, "runs/trips_02.csv"));
    let begins = &folder.json("runs/import.json")["runs"][1]["begins_because"];
    assert_eq!(begins, "the sheet \"Again\" begins, earlier than the one before ends");
}

#[test]
fn sheets_with_other_columns_are_named() {
    let (folder, rows) = (Folder::new(), drive(&STOPS_M, 30.0));
    let mut book = rust_xlsxwriter::Workbook::new();
    sheet_of(&mut book, "Log", 0.0, &rows);
    let other = book.add_worksheet().set_name("Brakes").unwrap();
    other.write(0, 0, "Zeit [s]").unwrap().write(0, 1, "p [bar]").unwrap().write(1, 0, 3.0).unwrap();
    sheet_of(&mut book, "Log 2", 86_400.0, &rows);
    book.save(folder.path("log.xlsx")).unwrap();
    let said = folder.done(&["import", "log.xlsx", "--chainage", "as-is"]);
    assert!(said.out.contains("2 runs in") && said.out.contains(&format!("{OTHER_SHEETS}: 1")), "{}", said.out);
    let place = "log.xlsx: expected the columns of the sheet \"Log\", found others in \"Brakes\"";
    assert_eq!(folder.json("runs/import.json")["places"][OTHER_SHEETS][0], place);
    let preview = folder.done(&["import", "--preview", "log.xlsx"]).out;
    assert!(preview.contains("sheets Log, Log 2 (not read: Brakes)"), "{preview}");
    let strict = folder.rundown(&["import", "log.xlsx", "--out", "strict", "--strict"]);
    assert!(strict.code == Some(1) && strict.err.contains(OTHER_SHEETS), "{}", strict.err);
}

#[test]
fn errors_of_a_table_calculation_are_counted() {
    let rows = drive(&STOPS_M, 30.0);
    let text = table("time_s,location_m,speed_kmh", &rows, |t, x, v| {
        let speed = if (100.0..300.0).contains(&t) { "#N/A".to_owned() } else { format!("{:.2}", 3.6 * v) };
        format!("{t},{x:.1},{speed}")
    });
    let folder = Folder::new().with("export.csv", &text);
    let place = "export.csv:102:3: speed_kmh: expected a number, found \"#N/A\"";
    loses(&folder, "export.csv", UNREADABLE, 200, place);
    let mut book = rust_xlsxwriter::Workbook::new();
    sheet_of(&mut book, "Log", 0.0, &rows);
    let sheet = book.worksheet_from_name("Log").unwrap();
    for row in 50..60 {
        sheet.write_formula(row, 2, rust_xlsxwriter::Formula::new("=1/0").set_result("#DIV/0!")).unwrap();
    }
    book.save(folder.path("sheet.xlsx")).unwrap();
    let place = "sheet.xlsx:51:3: v [km/h]: expected a number, found \"#DIV/0!\"";
    loses(&folder, "sheet.xlsx", UNREADABLE, 10, place);
}

#[test]
fn texts_of_a_sheet_have_the_decimal_sign_of_most_numbers() {
    let (folder, rows) = (Folder::new(), drive(&STOPS_M, 30.0));
    let comma = |number: String| number.replace('.', ",");
    let mut book = rust_xlsxwriter::Workbook::new();
    let sheet = book.add_worksheet();
    let mut lines = String::new();
    for (column, header) in ["Zeit [s]", "Weg (km)", "v (km/h)"].into_iter().enumerate() {
        sheet.write(0, column as u16, header).unwrap();
    }
    for (row, (t, x, v)) in (1..).zip(&rows) {
        let [km, kmh] = [comma(format!("{:.3}", x / 1000.0)), comma(format!("{:.1}", 3.6 * v))];
        writeln!(lines, "{{\"time_s\": {t}, \"location_km\": \"{km}\", \"speed_kmh\": \"{kmh}\"}}").unwrap();
        sheet.write(row, 0, *t).unwrap();
        sheet.write(row, 1, km).unwrap();
        sheet.write(row, 2, kmh).unwrap();
    }
    book.save(folder.path("a.xlsx")).unwrap();
    folder.write("b.jsonl", &lines);
    folder.done(&["import", "a.xlsx", "b.jsonl", "--chainage", "as-is", "--strict"]);
    for name in ["runs/a_01.csv", "runs/b_01.csv"] {
        let found = csv(&folder, name);
        found.iter().zip(&rows).for_each(|(found, (_, x, v))| {
            near(found[1], *x, 0.51);
            near(found[2], 3.6 * v, 0.051);
        });
    }
}

/// Parquet whose times, s since 1970, are of this type, so many ticks a second.
fn parquet_of(path: &std::path::Path, time: &str, ticks: i64, rows: &[(f64, f64, f64)]) {
    use parquet::data_type::{DoubleType, Int64Type};
    let schema = format!(
        "message log {{ REQUIRED INT64 time ({time}); REQUIRED DOUBLE location_m; REQUIRED DOUBLE speed_kmh; }}"
    );
    let schema = parquet::schema::parser::parse_message_type(&schema).unwrap();
    let file = std::fs::File::create(path).unwrap();
    let mut writer =
        parquet::file::writer::SerializedFileWriter::new(file, schema.into(), std::sync::Arc::default()).unwrap();
    let mut group = writer.next_row_group().unwrap();
    let times: Vec<i64> = rows.iter().map(|(t, ..)| ticks * *t as i64).collect();
    let mut column = group.next_column().unwrap().unwrap();
    column.typed::<Int64Type>().write_batch(&times, None, None).unwrap();
    column.close().unwrap();
    for value in [|row: &(f64, f64, f64)| row.1, |row: &(f64, f64, f64)| 3.6 * row.2] {
        let mut column = group.next_column().unwrap().unwrap();
        let values: Vec<f64> = rows.iter().map(value).collect();
        column.typed::<DoubleType>().write_batch(&values, None, None).unwrap();
        column.close().unwrap();
    }
    group.close().unwrap();
    writer.close().unwrap();
}

#[test]
fn timestamps_of_parquet_without_a_zone_are_of_that_of_the_mapping() {
    let mut rows = drive(&STOPS_M, 30.0);
    // 2025-05-05 07:37:33.
    rows.iter_mut().for_each(|(t, ..)| *t += 1_746_430_653.0);
    let folder = Folder::new().with("m.toml", "[[source]]\nzone = \"Europe/Berlin\"\n");
    for (unit, ticks) in [("MILLIS", 1000), ("MICROS", 1_000_000), ("NANOS", 1_000_000_000)] {
        for (is_utc, hour) in [(false, 5), (true, 7)] {
            parquet_of(&folder.path("a.parquet"), &format!("TIMESTAMP({unit},{is_utc})"), ticks, &rows);
            let said = folder.done(&["import", "a.parquet", "--mapping", "m.toml"]).err;
            let index = folder.read("runs/runs.csv");
            assert!(index.contains(&format!("a_01.csv,2025-05-05T0{hour}:37:33Z")), "{unit} {is_utc}: {index}");
            assert_eq!(said.contains("zone \"Europe/Berlin\" is not used"), is_utc, "{unit}: {said}");
        }
    }
}
