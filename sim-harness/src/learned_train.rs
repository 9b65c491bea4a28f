//! The train as its runs have shown it: the description with what was learned in the place of what was stated.
//!
//! In: the folder of a replay, the train file it was made with. Out: a [`LearnedTrain`], which is a train file again, and which of its values are learned.
//!
//! | value | from |
//! |---|---|
//! | r0, r1, r2 | the vehicle after the unit's last run |
//! | largest tractive effort | median over the runs of their largest effort at low speed |
//! | largest power | median over the runs of their largest power |
//! | all else | the description: mass, rotating mass factor, length, brake |
//!
//! A limit that fewer than [`LEAST_RUNS`] runs have shown stays as described. A learned limit is what the runs have used: what drivers did not demand was not observed.

use rundown::model::resistance::Davis;
use rundown_files::train_file::TrainFile;
use serde::Deserialize;
use std::path::Path;

/// Runs that must have shown a limit before it takes the described one's place.
pub const LEAST_RUNS: usize = 3;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// Learned in this many runs.
    Learned { runs: usize },
    /// As described: too few runs have shown it.
    Described,
}

#[derive(Clone, Debug, PartialEq)]
pub struct LearnedTrain {
    pub train: TrainFile,
    pub davis_sd: [f64; 3],
    pub runs: usize,
    pub effort: Origin,
    pub power: Origin,
}

#[derive(Debug, Deserialize)]
struct ReplayJson {
    train: String,
    carried: bool,
    runs: Vec<Run>,
}

#[derive(Debug, Deserialize)]
struct Run {
    unit: String,
    vehicle: Vehicle,
    foresight: Foresight,
    features: Features,
}

#[derive(Debug, Deserialize)]
struct Foresight {
    published: String,
}

#[derive(Debug, Deserialize)]
struct Vehicle {
    r0: f64,
    r1: f64,
    r2: f64,
    sd_r0: f64,
    sd_r1: f64,
    sd_r2: f64,
}

#[derive(Debug, Deserialize)]
struct Features {
    max_effort_mean_n_per_kg: Option<f64>,
    power_max_w_per_kg: Option<f64>,
}

/// Reads the results in `folder`; `unit` where the replay has several. What is wrong is said.
pub fn read(folder: &Path, train: &Path, unit: Option<&str>) -> Result<LearnedTrain, String> {
    let (described, _) = TrainFile::read(train).map_err(|error| error.to_string())?;
    let path = folder.join("replay.json");
    let refused = |place: String, message: String| format!("{}{place}: {message}", path.display());
    let text = std::fs::read_to_string(&path);
    let text = text.map_err(|error| refused(String::new(), format!("cannot be read: {error}")))?;
    let results = serde_json::from_str(&text).map_err(|error| {
        let place = format!(":{}:{}", error.line(), error.column());
        refused(place, format!("expected the results of `rundown replay`, found {error}"))
    })?;
    learn(described, results, unit).map_err(|message| refused(String::new(), message))
}

fn learn(described: TrainFile, results: ReplayJson, unit: Option<&str>) -> Result<LearnedTrain, String> {
    if results.train != described.name {
        let (found, expected) = (results.train, described.name);
        return Err(format!("train: expected `{expected}`, as in the train file, found `{found}`"));
    }
    if !results.carried {
        let expected = "expected a vehicle that is carried from run to run";
        return Err(format!("carried: {expected}, found a replay made with --no-carry"));
    }
    let mut units: Vec<&String> = results.runs.iter().map(|run| &run.unit).collect();
    units.sort();
    units.dedup();
    let chosen = match (unit, units.as_slice()) {
        (None, [only]) => only.as_str(),
        (Some(named), _) if units.iter().any(|unit| *unit == named) => named,
        _ => {
            let found = unit.map_or_else(|| "none named".to_owned(), |unit| format!("{unit:?}"));
            return Err(format!("unit: expected one of {units:?}, found {found}"));
        }
    };
    let runs: Vec<&Run> = results.runs.iter().filter(|run| run.unit == chosen).collect();
    let Some(last) = runs.last() else {
        return Err("runs: expected at least one, found none".to_owned());
    };
    let published = &last.foresight.published;
    if ["out_of_bounds", "predicts_worse"].contains(&published.as_str()) {
        return Err(format!(
            "runs: expected a resistance that would be published, found `{published}` after the last run of unit {chosen:?}; \
             the notes of the replay say what to look at"
        ));
    }
    let Vehicle { r0, r1, r2, .. } = last.vehicle;
    let rotating_mass_kg = described.rotating_mass_factor * described.mass_kg;
    let seen = |value: fn(&Features) -> Option<f64>| {
        let values: Vec<f64> = runs.iter().filter_map(|run| value(&run.features)).collect();
        let runs = values.len();
        (runs >= LEAST_RUNS).then(|| (rotating_mass_kg * median(values), Origin::Learned { runs }))
    };
    let described_as = |value: f64| (value, Origin::Described);
    let (max_tractive_effort_n, effort) =
        seen(|f| f.max_effort_mean_n_per_kg).unwrap_or(described_as(described.max_tractive_effort_n));
    let (max_power_w, power) = seen(|f| f.power_max_w_per_kg).unwrap_or(described_as(described.max_power_w));
    let train = TrainFile { davis: Davis { r0, r1, r2 }, max_tractive_effort_n, max_power_w, ..described };
    train.train().map_err(|error| format!("what was learned is no train: {error}"))?;
    Ok(LearnedTrain {
        train,
        davis_sd: [last.vehicle.sd_r0, last.vehicle.sd_r1, last.vehicle.sd_r2],
        runs: runs.len(),
        effort,
        power,
    })
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    if values.len() % 2 == 1 { values[middle] } else { 0.5 * (values[middle - 1] + values[middle]) }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TRAIN: &str = "name = \"unit\"\nmass_kg = 364000\nrotating_mass_factor = 1.06\nlength_m = 162\n\
        max_tractive_effort_n = 192920.0\nmax_power_w = 2036377.8\nmax_brake_mps2 = 0.66\n\
        [davis]\nr0 = 0.00738\nr1 = 1.6e-4\nr2 = 2.8e-5\n";

    fn run(unit: &str, r0: f64, effort: &str, power: &str) -> String {
        format!(
            "{{\"unit\":\"{unit}\",\"vehicle\":{{\"r0\":{r0},\"r1\":1.5e-4,\"r2\":2.7e-5,\"sd_r0\":1e-4,\"sd_r1\":1e-5,\"sd_r2\":1e-7}},\
            \"foresight\":{{\"published\":\"learned\"}},\"features\":{{\"max_effort_mean_n_per_kg\":{effort},\"power_max_w_per_kg\":{power}}}}}"
        )
    }

    fn learned(runs: &[String], unit: Option<&str>) -> Result<LearnedTrain, String> {
        let (train, _) = TrainFile::parse("t.toml".as_ref(), TRAIN).unwrap();
        let text = format!("{{\"train\":\"unit\",\"carried\":true,\"runs\":[{}]}}", runs.join(","));
        learn(train, serde_json::from_str(&text).unwrap(), unit)
    }

    #[test]
    fn the_last_run_has_the_resistance_and_the_median_run_the_limits() {
        let runs = [run("7", 0.0070, "0.4", "5.0"), run("7", 0.0071, "0.6", "null"), run("7", 0.0072, "0.5", "5.2")];
        let found = learned(&runs, None).unwrap();
        assert_eq!(found.train.davis.r0, 0.0072);
        assert_eq!((found.runs, found.davis_sd[0]), (3, 1e-4));
        assert!((found.train.max_tractive_effort_n - 0.5 * 385_840.0).abs() < 1e-6);
        assert_eq!(found.effort, Origin::Learned { runs: 3 });
        // Two runs have shown a power.
        assert_eq!(found.train.max_power_w, 2_036_377.8);
        assert_eq!(found.power, Origin::Described);
    }

    #[test]
    fn what_is_not_published_is_no_train() {
        let worse = run("7", 0.0070, "null", "null").replace("\"learned\"", "\"predicts_worse\"");
        assert!(learned(std::slice::from_ref(&worse), None).unwrap_err().contains("found `predicts_worse`"));
        assert!(learned(&[worse, run("7", 0.0070, "null", "null")], None).is_ok());
    }

    #[test]
    fn a_unit_is_asked_for_where_there_are_several() {
        let runs = [run("7", 0.0070, "null", "null"), run("8", 0.0080, "null", "null")];
        let error = learned(&runs, None).unwrap_err();
        assert_eq!(error, "unit: expected one of [\"7\", \"8\"], found none named");
        assert_eq!(learned(&runs, Some("8")).unwrap().train.davis.r0, 0.0080);
        assert!(learned(&runs, Some("9")).is_err());
        assert!(learned(&[], None).is_err());
    }

    #[test]
    fn what_no_train_has_is_refused() {
        let error = learned(&[run("7", -0.1, "null", "null")], None).unwrap_err();
        assert_eq!(error, "what was learned is no train: davis.r0: expected 0.00001 to 1, found -0.1");
    }
}
