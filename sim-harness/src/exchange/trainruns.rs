//! Rolling stock of railtoolkit's schema (2022.05), YAML, as TrainRuns.jl reads it.
//!
//! TrainRuns has no Davis coefficients. With weights m g, x = v / (100 km/h), δ = 15 km/h / (100 km/h) for the wind
//! that it adds, and f in permille:
//!
//! ```text
//! traction unit   R / (m g) = base_resistance + air_resistance (x + δ)²
//! passenger car   R / (m g) = base_resistance + rolling_resistance x + air_resistance (x + δ)²
//! freight car     R / (m g) = base_resistance + air_resistance x²
//! ```
//!
//! A traction unit and one car, each of half the mass and length, give any a + b x + c x² back exactly: where b >= 2 δ
//! c with a passenger car that has the rest of b, else with a freight car that has the c which the traction unit's b
//! leaves. So the formation is a device of this file, not one of the train.

use super::{draft::Draft, effort_curve, number::decimal, yaml};
use rundown::model::units::{GRAVITY_MPS2, KmPerHour};
use rundown_files::refusal::{Place, ReadError};
use rundown_files::train_file::TrainFile;
use serde::Deserialize;
use serde::de::IgnoredAny;
use std::path::Path;

/// What `schema` of a file says.
pub(super) const SCHEMA: &str = "https://railtoolkit.org/schema/rolling-stock.json";

/// Wind that TrainRuns adds to the speed, over 100 km/h.
const WIND: f64 = 0.15;

/// Resistance per weight, permille, over speed in 100 km/h.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct PerWeight {
    base: f64,
    rolling: f64,
    air: f64,
}

/// Of traction unit and car, and the car's type.
fn split(train: &TrainFile) -> Result<(PerWeight, PerWeight, &'static str), String> {
    let per_weight = 1000.0 * train.rotating_mass_factor / GRAVITY_MPS2;
    let speed_mps = KmPerHour(100.0).to_mps();
    let a = per_weight * train.davis.r0;
    let b = per_weight * train.davis.r1 * speed_mps;
    let c = per_weight * train.davis.r2 * speed_mps * speed_mps;
    if b >= 2.0 * WIND * c {
        let unit = PerWeight { base: positive(a - WIND * WIND * c)?, rolling: 0.0, air: c };
        return Ok((unit, PerWeight { rolling: 2.0 * (b - 2.0 * WIND * c), ..unit }, "passenger"));
    }
    let air = b / (2.0 * WIND);
    let unit = PerWeight { base: positive(a - 0.5 * WIND * b)?, rolling: 0.0, air: 2.0 * air };
    Ok((unit, PerWeight { air: 2.0 * (c - air), ..unit }, "freight"))
}

fn positive(base: f64) -> Result<f64, String> {
    if base > 0.0 {
        return Ok(base);
    }
    Err(format!(
        "base_resistance: expected above 0, found {base:.4} permille: r0 is smaller than the resistance of the 15 km/h of wind that TrainRuns adds"
    ))
}

/// The file. `Err`: why TrainRuns cannot hold this resistance.
pub(super) fn write(train: &TrainFile, max_speed_kmh: f64, said: &[String]) -> Result<String, String> {
    let (unit, car, kind) = split(train)?;
    let name = serde_json::Value::from(train.name.as_str());
    let mut text = "%YAML 1.2\n---\n".to_owned();
    said.iter().for_each(|line| text += &format!("# {line}\n"));
    text +=
        "# Traction unit and car share mass and length by halves, so that together they have the learned resistance;\n";
    text += "# the real formation is not known.\n";
    text += &format!("schema: {SCHEMA}\nschema_version: \"2022.05\"\n");
    text += &format!("trains:\n  - name: {name}\n    id: train\n    formation: [traction, car]\nvehicles:\n");
    let vehicle = |id: &str, kind: &str, of: PerWeight| {
        let mut fields = vec![
            ("vehicle_type", kind.to_owned()),
            ("length", decimal(0.5 * train.length_m)),
            ("mass", decimal(0.5 * train.mass_kg / 1000.0)),
            ("speed_limit", decimal(max_speed_kmh)),
            ("rotation_mass", decimal(train.rotating_mass_factor)),
        ];
        let coefficients =
            [("base_resistance", of.base), ("rolling_resistance", of.rolling), ("air_resistance", of.air)];
        // The schema has no coefficient of 0; one that is left out is 0.
        let there = coefficients.into_iter().filter(|(_, value)| *value > 0.0);
        fields.extend(there.map(|(name, value)| (name, decimal(value))));
        let lines: String = fields.iter().map(|(name, value)| format!("    {name}: {value}\n")).collect();
        format!("  - name: {id}\n    id: {id}\n{lines}")
    };
    text += &vehicle("car", kind, car);
    text += &vehicle("traction", "traction unit", unit);
    text += &format!("    mass_traction: {}\n", decimal(0.5 * train.mass_kg / 1000.0));
    text += &format!("    a_braking: {}\n    tractive_effort:\n", decimal(-train.max_brake_mps2));
    let mut curve = effort_curve::points(train.max_tractive_effort_n, train.max_power_w, max_speed_kmh);
    if let [first, last] = curve[..] {
        // The schema asks for three points.
        curve = vec![first, (0.5 * last.0, first.1), last];
    }
    curve.iter().for_each(|(kmh, force_n)| text += &format!("      - [{}, {}]\n", decimal(*kmh), decimal(*force_n)));
    Ok(text)
}

#[derive(Deserialize)]
struct TrainRunsFile {
    trains: Vec<TrainsEntry>,
    vehicles: Vec<TrainRunsVehicle>,
}

#[derive(Deserialize)]
struct TrainsEntry {
    name: String,
    formation: Vec<String>,
}

#[derive(Deserialize)]
struct TrainRunsVehicle {
    id: String,
    vehicle_type: String,
    length: f64,
    mass: f64,
    #[serde(default)]
    load_limit: f64,
    mass_traction: Option<f64>,
    rotation_mass: Option<f64>,
    a_braking: Option<f64>,
    /// A train file has no place for it, nor for the next one.
    speed_limit: Option<IgnoredAny>,
    power_type: Option<IgnoredAny>,
    #[serde(default)]
    base_resistance: f64,
    #[serde(default)]
    rolling_resistance: f64,
    #[serde(default)]
    air_resistance: f64,
    #[serde(default)]
    tractive_effort: Vec<(f64, f64)>,
}

impl TrainRunsVehicle {
    fn has_traction(&self) -> bool {
        ["traction unit", "multiple unit"].contains(&self.vehicle_type.as_str())
    }

    /// As loaded, kg.
    fn mass_kg(&self) -> f64 {
        1000.0 * (self.mass + self.load_limit)
    }

    /// a, b, c of a resistance a + b x + c x², N.
    fn resistance_n(&self, passengers: bool) -> [f64; 3] {
        let Self { base_resistance: base, rolling_resistance: rolling, air_resistance: air, .. } = *self;
        let windy = [WIND * WIND * air, 2.0 * WIND * air, air];
        let (weight_kg, [a, b, c]) = if self.has_traction() {
            // Its base resistance is that of the driven axles, its rolling resistance that of the others.
            let driven = self.mass_traction.unwrap_or(self.mass) / self.mass;
            (1000.0 * self.mass, [driven * base + (1.0 - driven) * rolling + windy[0], windy[1], windy[2]])
        } else if passengers {
            (self.mass_kg(), [base + windy[0], rolling + windy[1], windy[2]])
        } else {
            (self.mass_kg(), [base, 0.0, air])
        };
        [a, b, c].map(|permille| permille / 1000.0 * weight_kg * GRAVITY_MPS2)
    }
}

pub(super) fn read(path: &Path, text: &str) -> Result<Draft, ReadError> {
    let file: TrainRunsFile = yaml::read(path, text, "rolling stock of railtoolkit")?;
    let refuse = |field: &str, message: String| ReadError::from(Place::of_file(path).refuse(field, message));
    let train = file.trains.first().ok_or_else(|| refuse("trains", "expected one, found none".to_owned()))?;
    let formation = train.formation.iter().map(|id| {
        let found = file.vehicles.iter().find(|vehicle| vehicle.id == *id);
        found.ok_or_else(|| refuse("vehicles", format!("expected `{id}` of the formation, found no such vehicle")))
    });
    let formation: Vec<&TrainRunsVehicle> = formation.collect::<Result<_, _>>()?;
    let powered: Vec<&&TrainRunsVehicle> = formation.iter().filter(|vehicle| vehicle.has_traction()).collect();
    let [unit] = powered[..] else {
        let message =
            format!("expected one traction unit or multiple unit, as TrainRuns uses, found {}", powered.len());
        return Err(refuse("trains[0].formation", message));
    };
    let passengers =
        formation.iter().any(|vehicle| ["passenger", "multiple unit"].contains(&vehicle.vehicle_type.as_str()));
    let speed_mps = KmPerHour(100.0).to_mps();
    let mut draft = Draft { name: train.name.clone(), ..Draft::default() };
    for vehicle in &formation {
        let [a, b, c] = vehicle.resistance_n(passengers);
        let terms = [a, b / speed_mps, c / (speed_mps * speed_mps)];
        draft.resistance_n.iter_mut().zip(terms).for_each(|(sum, term)| *sum += term);
    }
    let mass_kg: f64 = formation.iter().map(|vehicle| vehicle.mass_kg()).sum();
    let rotating_kg: Option<f64> =
        formation.iter().map(|vehicle| vehicle.rotation_mass.map(|factor| factor * vehicle.mass_kg())).sum();
    draft.put("mass_kg", Some(mass_kg));
    draft.put("rotating_mass_factor", rotating_kg.map(|rotating_kg| rotating_kg / mass_kg));
    draft.put("length_m", Some(formation.iter().map(|vehicle| vehicle.length).sum()));
    draft.put("max_brake_mps2", unit.a_braking.map(f64::abs));
    let points: Vec<(f64, f64)> = unit.tractive_effort.iter().map(|(kmh, n)| (KmPerHour(*kmh).to_mps(), *n)).collect();
    let limits = effort_curve::limits(&points);
    draft.put("max_tractive_effort_n", limits.as_ref().map(|limits| limits.effort_n));
    draft.put("max_power_w", limits.as_ref().map(|limits| limits.power_w));
    draft.notes = notes(&file, &formation);
    draft.notes.extend(limits.and_then(|limits| limits.note));
    Ok(draft)
}

fn notes(file: &TrainRunsFile, formation: &[&TrainRunsVehicle]) -> Vec<String> {
    let is_there =
        |field: fn(&TrainRunsVehicle) -> Option<IgnoredAny>| formation.iter().any(|one| field(one).is_some());
    let fields = [("speed_limit", is_there(|of| of.speed_limit)), ("power_type", is_there(|of| of.power_type))];
    let lost: Vec<&str> = fields.into_iter().filter(|(_, is_there)| *is_there).map(|(name, _)| name).collect();
    let mut notes: Vec<String> =
        (!lost.is_empty()).then(|| format!("not kept: {}", lost.join(", "))).into_iter().collect();
    if file.trains.len() > 1 {
        notes.push(format!("read is the first of {} trains", file.trains.len()));
    }
    if formation.iter().any(|vehicle| vehicle.load_limit > 0.0) {
        notes.push("the mass is that of the train fully loaded: mass and load_limit of each vehicle".to_owned());
    }
    notes
}

#[cfg(test)]
mod tests {
    use super::*;
    use rundown::{model::resistance::Davis, model::train::TrainDescription};

    fn train(r1: f64) -> TrainFile {
        let davis = Davis { r0: 7.1e-3, r1, r2: 2.7e-5 };
        TrainFile::of("t", &TrainDescription { davis, ..TrainDescription::CASE_STUDY })
    }

    #[test]
    fn car_and_traction_unit_have_the_resistance_at_100_km_h() {
        // A linear term below, and above, what the wind of TrainRuns brings with it: 2 * 15 km/h * r2 = 2.25e-4.
        for (r1, kind) in [(0.0, "freight"), (1.5e-4, "freight"), (3e-4, "passenger")] {
            let train = train(r1);
            let (unit, car, found) = split(&train).unwrap();
            assert_eq!(found, kind);
            let weight_n = 0.5 * train.mass_kg * 9.80665;
            let windy = 1.15 * 1.15;
            let unit_n = (unit.base + unit.air * windy) / 1000.0 * weight_n;
            let car_air = if kind == "freight" { car.air } else { car.air * windy };
            let car_n = (car.base + car.rolling + car_air) / 1000.0 * weight_n;
            let v = 100.0 / 3.6;
            let expected_n = 1.06 * train.mass_kg * (7.1e-3 + r1 * v + 2.7e-5 * v * v);
            assert!(((unit_n + car_n) / expected_n - 1.0).abs() < 1e-9, "{unit_n} {car_n} {expected_n}");
        }
    }

    #[test]
    fn only_fields_that_a_file_has_are_said_to_be_lost() {
        let text = write(&train(3e-4), 160.0, &[]).unwrap();
        let notes = |text: &str| read("t.yaml".as_ref(), text).unwrap().notes;
        let is_lost =
            |notes: &[String]| notes.iter().filter(|note| note.starts_with("not kept: ")).cloned().collect::<Vec<_>>();
        assert_eq!(is_lost(&notes(&text)), ["not kept: speed_limit"]);
        let powered = text.replace("    a_braking", "    power_type: diesel\n    a_braking");
        assert_eq!(is_lost(&notes(&powered)), ["not kept: speed_limit, power_type"]);
        let neither: String =
            text.lines().filter(|line| !line.contains("speed_limit")).map(|line| format!("{line}\n")).collect();
        assert_eq!(is_lost(&notes(&neither)), Vec::<String>::new());
    }

    #[test]
    fn less_base_resistance_than_the_wind_is_refused() {
        let mut train = train(3e-4);
        train.davis.r0 = 1e-4;
        assert!(split(&train).unwrap_err().starts_with("base_resistance: expected above 0, found -"));
    }
}
