//! Is no row of any log lost in silence? Texts of all kinds, also broken ones.

use proptest::prelude::*;
use rundown_files::run_log::{BadRows, RunLog};

/// A field as recorders and their faults write it.
fn field() -> impl Strategy<Value = String> {
    prop_oneof![
        4 => any::<f64>().prop_map(|number| number.to_string()),
        4 => (0_i32..2000).prop_map(|number| number.to_string()),
        2 => Just(String::new()),
        1 => "[ -~]{0,6}",
        1 => "\\PC{0,4}",
        1 => Just("\"".to_owned()),
    ]
}

fn line() -> impl Strategy<Value = String> {
    prop_oneof![
        8 => prop::collection::vec(field(), 3).prop_map(|fields| fields.join(",")),
        1 => prop::collection::vec(field(), 0..6).prop_map(|fields| fields.join(",")),
        1 => Just("# remark".to_owned()),
    ]
}

proptest! {
    #[test]
    fn every_line_is_a_sample_or_a_named_bad_row(lines in prop::collection::vec(line(), 0..30), ending in "\r?\n") {
        let header = "time_s,location_m,speed_kmh".to_owned();
        let text = std::iter::once(&header).chain(&lines).map(|line| format!("{line}{ending}")).collect::<String>();
        let rows = lines.iter().filter(|line| !line.trim().is_empty() && !line.trim_start().starts_with('#')).count();
        match RunLog::parse("run.csv".as_ref(), text.as_bytes(), BadRows::LeaveOut) {
            Ok(log) => prop_assert_eq!(log.samples.len() + log.bad_rows.len(), rows),
            Err(error) => prop_assert!(error.to_string().starts_with("run.csv"), "{}", error),
        }
    }

    #[test]
    fn any_bytes_give_a_log_or_an_error_that_names_the_file(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        if let Err(error) = RunLog::parse("run.csv".as_ref(), &bytes, BadRows::Refuse) {
            prop_assert!(error.to_string().starts_with("run.csv"), "{}", error);
        }
    }

    #[test]
    fn numbers_survive_being_written_and_read(values in prop::collection::vec((-1e7..1e7, 0.0..400.0), 1..20)) {
        let mut text = "time_s,location_m,speed_kmh\n".to_owned();
        for (index, (location_m, speed_kmh)) in values.iter().enumerate() {
            text += &format!("{index},{location_m:.16e},{speed_kmh}\n");
        }
        let log = RunLog::parse("run.csv".as_ref(), text.as_bytes(), BadRows::Refuse).unwrap();
        for (sample, (location_m, speed_kmh)) in log.samples.iter().zip(values) {
            prop_assert_eq!(sample.location_m, Some(location_m));
            prop_assert_eq!(sample.speed_mps, Some(speed_kmh / 3.6));
        }
    }
}
