//! Readings that mean nothing: locations while no signal comes, fixes of elsewhere.

use super::*;

/// A run with these locations in place of its own, by row.
fn with_locations(location_m: impl Fn(usize, f64) -> f64) -> String {
    let rows = drive(&STOPS_M, 30.0);
    table("time_s,location_m,speed_kmh", &rows, |t, x, v| {
        format!("{t},{:.1},{:.1}", location_m(t as usize, 412_000.0 + x), 3.6 * v)
    })
}

const NO_LOCATION: &str = "locations far from those around them, which agree with each other, taken as missing";

/// The rest of the run was moved by hundreds of kilometres, and such values cut runs and turned their directions.
#[test]
fn locations_while_no_signal_comes_are_missing() {
    type Lost = fn(usize) -> Option<f64>;
    let block: Lost = |row| (100..105).contains(&row).then_some(0.0);
    let singles: Lost = |row| [100, 102].contains(&row).then_some(65_535.0);
    let two: Lost = |row| (100..102).contains(&row).then_some(9_999_999.0);
    for (lost, count) in [(block, 5), (singles, 2), (two, 2)] {
        let text = with_locations(|row, at_m| lost(row).unwrap_or(at_m));
        let folder = Folder::new().with("a.csv", &text);
        folder.done(&["import", "a.csv"]);
        assert_eq!(folder.read("runs/runs.csv"), "file,departure_utc,unit,direction\na_01.csv,,,up\n");
        let found = csv(&folder, "runs/a_01.csv");
        for (row, read) in found.iter().enumerate() {
            assert_eq!(read[1].is_nan(), lost(row).is_some(), "{row}: {read:?}");
        }
        near(last(&found)[1], 423_900.0, 1.0);
        assert_eq!(folder.json("runs/import.json")["counts"][NO_LOCATION], count);
        let said = folder.done(&["check", "a.csv"]);
        let expected = if count > 3 { "locations that stand for none, far from" } else { "single locations far from" };
        assert!(said.out.contains(expected) && !said.out.contains("began again elsewhere"), "{}", said.out);
    }
}

#[test]
fn the_last_location_alone_turns_no_run() {
    let rows = drive(&STOPS_M, 30.0).len();
    for (last_m, left_out) in [(0.0, Some(1)), (65_535.0, None)] {
        let text = with_locations(|row, at_m| if row + 1 == rows { last_m } else { at_m });
        let folder = Folder::new().with("a.csv", &text);
        folder.done(&["import", "a.csv"]);
        assert!(folder.read("runs/runs.csv").ends_with("a_01.csv,,,up\n"), "{last_m}");
        assert_eq!(folder.json("runs/import.json")["counts"][NO_LOCATION].as_u64(), left_out);
    }
}

/// Where the receiver was switched off the day before: all fixes of the run were taken for jumps, or as many as a train
/// could not have come from there.
#[test]
fn a_first_fix_of_elsewhere_is_no_anchor() {
    let rows = drive(&STOPS_M, 30.0);
    for (north_deg, old) in [(-1.2, 1), (0.15, 1), (0.15, 3)] {
        let text = table("time,latitude,longitude", &rows, |t, x, _| {
            let (latitude, longitude) = place(x, 0.0);
            let latitude = latitude + if (t as usize) < old { north_deg } else { 0.0 };
            format!("{},{latitude:.7},{longitude:.7}", 1_740_000_000.0 + t)
        });
        let folder = Folder::new().with("a.csv", &text);
        folder.done(&["import", "a.csv"]);
        let counts = &folder.json("runs/import.json")["counts"];
        assert_eq!(counts["first fixes far from where the following ones begin, taken as missing"], old, "{counts}");
        assert!(counts["fixes that jump, taken as missing"].is_null(), "{counts}");
        let found = csv(&folder, "runs/a_01.csv");
        near(last(&found)[1] - found[old][1], 11_900.0, 20.0);
    }
}
