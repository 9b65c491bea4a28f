//! Does a train come back from each format as it went?

use super::*;
use crate::learned_train::Limit;
use proptest::prelude::*;
use rundown::{model::resistance::Davis, model::train::TrainDescription, model::units::KmPerHour};
use rundown_files::train_file::TrainFile;
use std::collections::BTreeMap;

fn learned(train: TrainFile) -> LearnedTrain {
    let limit = |described| Limit { described, used: None };
    let (effort, power) = (limit(train.max_tractive_effort_n), limit(train.max_power_w));
    LearnedTrain {
        train,
        davis_sd: [1e-4, 1e-6, 1e-7],
        runs: 7,
        learned_kmh: Some([60.0, 130.0]),
        effort,
        power,
        notes: Vec::new(),
    }
}

fn identity() -> Identity {
    Identity {
        company: "0084".to_owned(),
        id: "six \"decks\" & -- more".to_owned(),
        version: "1".to_owned(),
        traction: Traction::Electrical { volts: 1500, millihertz: 0 },
        max_speed_kmh: 200,
    }
}

/// Written, read, and completed with what the format lacks.
fn there_and_back(format: ExchangeFormat, train: &TrainFile) -> TrainFile {
    let bytes = write(format, &learned(train.clone()), &identity()).unwrap();
    let text = String::from_utf8(bytes).unwrap();
    let path = Path::new(format.file_name());
    let ForeignFile::Train(draft) = read(path, &text).unwrap_or_else(|error| panic!("{error}\n{text}")) else {
        panic!("expected a train");
    };
    let lacking = [
        ("max_brake_mps2", train.max_brake_mps2),
        ("max_tractive_effort_n", train.max_tractive_effort_n),
        ("max_power_w", train.max_power_w),
    ];
    let set: BTreeMap<&'static str, f64> =
        lacking.into_iter().filter(|(field, _)| !draft.values.contains_key(field)).collect();
    let expected_lacking = match format {
        ExchangeFormat::Sfera => 1,
        ExchangeFormat::Altrios => 2,
        ExchangeFormat::Sumo | ExchangeFormat::SumoTable | ExchangeFormat::Osrd | ExchangeFormat::Trainruns => 0,
    };
    assert_eq!(set.len(), expected_lacking, "{format:?}");
    draft.complete(path, &set).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

fn trains() -> impl Strategy<Value = TrainFile> {
    let davis = (3e-3..3e-2f64, prop_oneof![Just(0.0), 0.0..8e-4f64], 1e-6..8e-5f64);
    // SFERA and ALTRIOS state whole tonnes and metres, or digits: whole ones here, so that what is compared is the
    // form.
    let sizes = (40u32..2000, 30u32..700, 1.0..1.3f64);
    // Effort and power per rotating mass; the knee is then below 29 m/s.
    let limits = (0.2..1.0f64, 3.0..5.8f64, 0.3..1.3f64);
    (davis, sizes, limits).prop_map(|((r0, r1, r2), (tonnes, length, factor), (effort, power, brake))| {
        let mass_kg = 1000.0 * f64::from(tonnes);
        let rotating_mass_kg = factor * mass_kg;
        let description = TrainDescription {
            mass_kg,
            rotating_mass_factor: factor,
            length_m: f64::from(length),
            davis: Davis { r0, r1, r2 },
            max_tractive_effort_n: effort * rotating_mass_kg,
            max_power_w: power * rotating_mass_kg,
            max_brake_mps2: brake,
        };
        TrainFile::of("a \"train\": it's #1 -- <and> more", &description)
    })
}

proptest! {
    #[test]
    fn a_train_comes_back_from_every_format(train in trains()) {
        for format in ExchangeFormat::ALL {
            let back = there_and_back(format, &train);
            let numbers = |train: &TrainFile| {
                let TrainFile { mass_kg, rotating_mass_factor, length_m, max_brake_mps2, .. } = *train;
                [mass_kg, rotating_mass_factor, length_m, max_brake_mps2, train.davis.r0, train.davis.r1, train.davis.r2]
            };
            // Seven digits; TrainRuns' coefficients are differences of such, of the size of r at 100 km/h.
            for (before, after) in numbers(&train).into_iter().zip(numbers(&back)) {
                prop_assert!((before - after).abs() < 3e-6 * before.abs() + 1e-9, "{format:?}: {before} {after}");
            }
            for v in [10.0, 100.0 / 3.6, 50.0] {
                let share = back.davis.resistance_n_per_kg(v) / train.davis.resistance_n_per_kg(v);
                prop_assert!((share - 1.0).abs() < 1e-6, "{format:?}: {share} at {v} m/s");
            }
            // SFERA's curve has whole newtons: half of one, of the smallest force, at the largest speed.
            let half_newton = 0.5 * KmPerHour(200.0).to_mps() / train.max_power_w;
            let tolerance = 1e-6 + if format == ExchangeFormat::Sfera { half_newton } else { 0.0 };
            for (before, after) in
                [(train.max_tractive_effort_n, back.max_tractive_effort_n), (train.max_power_w, back.max_power_w)]
            {
                prop_assert!((after / before - 1.0).abs() < tolerance, "{format:?}: {before} {after}");
            }
            let name = if format == ExchangeFormat::Sfera { identity().id } else { train.name.clone() };
            prop_assert_eq!(back.name, name);
        }
    }
}

#[test]
fn every_file_says_what_is_learned_how_sure_and_what_is_described() {
    let train = TrainFile::of("t", &TrainDescription::CASE_STUDY);
    for format in ExchangeFormat::ALL {
        let text = String::from_utf8(write(format, &learned(train.clone()), &identity()).unwrap()).unwrap();
        for words in ["learned by Rundown from 7 runs, with 95 % intervals", "+/-", "capability as described"] {
            assert!(text.contains(words), "{format:?}: {text}");
        }
    }
}

#[test]
fn what_is_no_train_is_refused() {
    let error = read("x.txt".as_ref(), "time_s,speed_kmh\n").err().unwrap().to_string();
    assert!(error.starts_with("x.txt: expected a train of SFERA, SUMO"), "{error}");
    let several = "<additional><vType id='a' carFollowModel='Rail'/><vType id='b' carFollowModel='Rail'/></additional>";
    let error = read("x.xml".as_ref(), several).err().unwrap().to_string();
    assert_eq!(error, "x.xml: vType: expected one vType with carFollowModel=\"Rail\", found 2");
    let builtin = "<additional>\n  <vType id='a' carFollowModel='Rail' trainType='ICE1'/></additional>";
    let error = read("x.xml".as_ref(), builtin).err().unwrap().to_string();
    assert!(error.starts_with("x.xml:2:3: trainType: expected `custom`, found `ICE1`"), "{error}");
    let broken = "{\n \"rolling_resistance\": 3 }";
    assert!(read("x.json".as_ref(), broken).err().unwrap().to_string().starts_with("x.json:2:"));
}

/// The facts of RailJSON 3.4 that `editoast` checks when it reads a rolling stock.
#[test]
fn osrd_finds_every_field_that_it_needs() {
    let train = TrainFile::of("t", &TrainDescription::CASE_STUDY);
    let text = write(ExchangeFormat::Osrd, &learned(train.clone()), &identity()).unwrap();
    let stock: serde_json::Value = serde_json::from_slice(&text).unwrap();
    for number in ["length", "max_speed", "startup_time", "startup_acceleration", "comfort_acceleration", "const_gamma"]
    {
        assert!(stock[number].as_f64().is_some(), "{number}");
    }
    for number in ["inertia_coefficient", "mass", "electrical_power_startup_time", "raise_pantograph_time"] {
        assert!(stock[number].as_f64().is_some(), "{number}");
    }
    let gauges = ["G1", "G2", "GA", "GB", "GB1", "GC", "FR3.3", "FR3.3/GB/G2", "GLOTT"];
    assert!(gauges.contains(&stock["loading_gauge"].as_str().unwrap()));
    let resistance = &stock["rolling_resistance"];
    assert_eq!(resistance.as_object().unwrap().len(), 4, "no field that OSRD does not know");
    // Newtons of the whole train, at 100 km/h.
    let v = stock["max_speed"].as_f64().unwrap() / 2.0;
    let [a, b, c] = ["A", "B", "C"].map(|name| resistance[name].as_f64().unwrap());
    let expected_n = train.rotating_mass_factor * train.mass_kg * train.davis.resistance_n_per_kg(v);
    assert!(((a + b * v + c * v * v) / expected_n - 1.0).abs() < 1e-3);
    let modes = &stock["effort_curves"];
    let mode = &modes["modes"][modes["default_mode"].as_str().unwrap()];
    assert_eq!(mode.as_object().unwrap().len(), 3);
    assert!(mode["is_electric"].as_bool().unwrap() && mode["curves"].as_array().unwrap().is_empty());
    let curve = |name: &str| -> Vec<f64> {
        mode["default_curve"][name].as_array().unwrap().iter().map(|value| value.as_f64().unwrap()).collect()
    };
    let (speeds, efforts) = (curve("speeds"), curve("max_efforts"));
    assert!(speeds.len() == efforts.len() && speeds.len() >= 2);
    assert!(speeds.windows(2).all(|pair| pair[0] < pair[1]) && efforts.iter().all(|effort| *effort >= 0.0));
    let categories = ["primary_category", "other_categories", "supported_signaling_systems", "power_restrictions"];
    assert!(categories.iter().all(|name| !stock[name].is_null()));
    let texts = ["detail", "family", "type", "grouping", "series", "subseries", "unit", "number", "reference"];
    let metadata = stock["metadata"].as_object().unwrap();
    assert!(metadata.len() == texts.len() && texts.iter().all(|name| metadata[*name].is_string()));
}

#[test]
fn tables_of_another_shape_are_refused_with_how_far_they_are_off() {
    let file = |resistance: &str| {
        format!(
            "<additional><vType id=\"t\" carFollowModel=\"Rail\" trainType=\"custom\" length=\"100\" mass=\"1e5\" massFactor=\"1.05\" decel=\"0.9\" \
             speedTable=\"0 10 20 30\" tractionTable=\"100 100 50 33.33\" resistanceTable=\"{resistance}\"/></additional>"
        )
    };
    let read = |resistance: &str| match read(Path::new("t.xml"), &file(resistance)) {
        Ok(ForeignFile::Train(draft)) => Ok(draft),
        Ok(ForeignFile::Track(..)) => panic!("expected a train"),
        Err(error) => Err(error.to_string()),
    };
    // 1 + 0.05 v + 0.002 v² kN.
    let draft = read("1 1.7 2.8 4.3").unwrap();
    for (found, expected) in draft.resistance_n.iter().zip([1000.0, 50.0, 2.0]) {
        assert!((found - expected).abs() < 1e-6 * expected, "{:?}", draft.resistance_n);
    }
    assert_eq!((draft.values["max_tractive_effort_n"], draft.values["max_power_w"]), (1e5, 1e6));
    assert!(draft.notes.is_empty(), "{:?}", draft.notes);
    let error = read("1 4 2 4.3").unwrap_err();
    assert!(error.contains("resistanceTable: expected A + B v + C v² within 5 %"), "{error}");
    let error = read("1 1.7 2.8").unwrap_err();
    assert!(error.contains("resistanceTable: expected 4 numbers, as in speedTable, found 3"), "{error}");
    let error = read("1 1.7 x 4").unwrap_err();
    assert!(error.contains("expected numbers between spaces, found `x`"), "{error}");
    let error = read("0 1.7 2.8 4.3").unwrap_err();
    assert!(error.contains("resistanceTable: expected resistances above 0 kN, found 0 at 0 m/s"), "{error}");
    // Parameters win, each for itself, as in SUMO.
    let beside = |resistance: &str| read(&format!("1 1.7 2.8 4.3\" {resistance} x=\"")).unwrap();
    let both = "resCoef_constant=\"2\" resCoef_linear=\"0.1\" resCoef_quadratic=\"0.004\"";
    assert_eq!(beside(both).resistance_n, [2000.0, 100.0, 4.0]);
    assert!(beside(both).notes.iter().any(|note| note.starts_with("resistanceTable is ignored")));
    let power = beside("maxTraction=\"80\" maxPower=\"900\"");
    assert_eq!((power.values["max_tractive_effort_n"], power.values["max_power_w"]), (8e4, 9e5));
    assert!((power.resistance_n[0] - 1000.0).abs() < 1e-3);
}
