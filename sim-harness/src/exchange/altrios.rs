//! ALTRIOS's rail vehicle, YAML: the whole train as one vehicle of a `TrainConfig`.
//!
//! | field | unit | from |
//! |---|---|---|
//! | `mass_static_base_kilograms` | kg | m |
//! | `mass_rot_per_axle_kilograms`, times `axle_count` | kg | (γ - 1) m |
//! | `rolling_ratio` | - | γ r0 / g |
//! | `davis_b_seconds_per_meter` | s/m | γ r1 / g |
//! | `cd_area_square_meters` | m² | γ m r2 / ρ |
//! | `braking_ratio` | - | γ b / g, b the largest deceleration |
//! | `length_meters`, `speed_max_meters_per_second` | m, m/s | length, as given |
//!
//! ALTRIOS computes the resistance as (`rolling_ratio` + `davis_b` v) times the weight, `cd_area` ρ v² with ρ = 1.225
//! kg/m³, and a force for each axle (`bearing_res_per_axle`, here 0). Effort and power belong to its locomotives: a
//! rail vehicle has no place for them. Its weight includes that of the locomotives, so one that hauls this vehicle must
//! have no mass of its own.

use super::{draft::Draft, number::decimal};
use rundown::model::units::{GRAVITY_MPS2, KmPerHour};
use rundown_files::refusal::{Place, ReadError};
use rundown_files::train_file::TrainFile;
use serde::Deserialize;
use std::path::Path;

/// Density of air that ALTRIOS takes, kg/m³.
const AIR_KG_PER_M3: f64 = 1.225;
/// Axles are not described; the rotating mass is shared out over these.
const AXLES: f64 = 4.0;

pub(super) fn write(train: &TrainFile, max_speed_kmh: f64, said: &[String]) -> String {
    let TrainFile { mass_kg, rotating_mass_factor, davis, .. } = train;
    let per_weight = |r: f64| decimal(rotating_mass_factor * r / GRAVITY_MPS2);
    let name = serde_json::Value::from(train.name.as_str());
    let fields = [
        ("car_type", name.to_string()),
        ("freight_type", name.to_string()),
        ("length_meters", decimal(train.length_m)),
        ("axle_count", decimal(AXLES)),
        ("brake_count", "1".to_owned()),
        ("mass_static_base_kilograms", decimal(*mass_kg)),
        ("mass_freight_kilograms", "0".to_owned()),
        ("speed_max_meters_per_second", decimal(KmPerHour(max_speed_kmh).to_mps())),
        ("braking_ratio", per_weight(train.max_brake_mps2)),
        ("mass_rot_per_axle_kilograms", decimal((rotating_mass_factor - 1.0) * mass_kg / AXLES)),
        ("bearing_res_per_axle_newtons", "0".to_owned()),
        ("rolling_ratio", per_weight(davis.r0)),
        ("davis_b_seconds_per_meter", per_weight(davis.r1)),
        ("cd_area_square_meters", decimal(rotating_mass_factor * mass_kg * davis.r2 / AIR_KG_PER_M3)),
        ("curve_coeff_0", "0".to_owned()),
        ("curve_coeff_1", "0".to_owned()),
        ("curve_coeff_2", "0".to_owned()),
    ];
    let mut text: String = said.iter().map(|line| format!("# {line}\n")).collect();
    text += "# The whole train is one vehicle; effort and power, which belong to a locomotive, are not in this file.\n";
    text += "# Axles, brakes and resistance in curves are not known: 4, 1 and none.\n---\n";
    text + &fields.map(|(name, value)| format!("{name}: {value}\n")).concat()
}

#[derive(Deserialize)]
struct AltriosVehicle {
    car_type: String,
    length_meters: f64,
    axle_count: f64,
    mass_static_base_kilograms: f64,
    #[serde(default)]
    mass_freight_kilograms: f64,
    speed_max_meters_per_second: Option<f64>,
    braking_ratio: f64,
    mass_rot_per_axle_kilograms: f64,
    bearing_res_per_axle_newtons: f64,
    rolling_ratio: f64,
    davis_b_seconds_per_meter: f64,
    cd_area_square_meters: f64,
    #[serde(default)]
    curve_coeff_0: f64,
    #[serde(default)]
    curve_coeff_1: f64,
    #[serde(default)]
    curve_coeff_2: f64,
}

pub(super) fn read(path: &Path, text: &str) -> Result<Draft, ReadError> {
    let vehicle: AltriosVehicle = super::yaml::read(path, text, "a rail vehicle of ALTRIOS")?;
    let mass_kg = vehicle.mass_static_base_kilograms + vehicle.mass_freight_kilograms;
    if mass_kg <= 0.0 || !mass_kg.is_finite() {
        let message = format!("expected a mass above 0, found {mass_kg}");
        return Err(Place::of_file(path).refuse("mass_static_base_kilograms", message).into());
    }
    let weight_n = GRAVITY_MPS2 * mass_kg;
    let rotating_mass_factor = 1.0 + vehicle.mass_rot_per_axle_kilograms * vehicle.axle_count / mass_kg;
    let mut draft = Draft {
        name: vehicle.car_type.clone(),
        resistance_n: [
            vehicle.rolling_ratio * weight_n + vehicle.bearing_res_per_axle_newtons * vehicle.axle_count,
            vehicle.davis_b_seconds_per_meter * weight_n,
            vehicle.cd_area_square_meters * AIR_KG_PER_M3,
        ],
        ..Draft::default()
    };
    draft.put("mass_kg", Some(mass_kg));
    draft.put("rotating_mass_factor", Some(rotating_mass_factor));
    draft.put("length_m", Some(vehicle.length_meters));
    draft.put("max_brake_mps2", Some(vehicle.braking_ratio * GRAVITY_MPS2 / rotating_mass_factor));
    draft.notes.push(
        "the file is one rail vehicle: a train of several needs its mass, length and resistance summed".to_owned(),
    );
    if vehicle.speed_max_meters_per_second.is_some() {
        draft.notes.push("not kept: speed_max_meters_per_second".to_owned());
    }
    if [vehicle.curve_coeff_0, vehicle.curve_coeff_1, vehicle.curve_coeff_2]
        .iter()
        .any(|coefficient| *coefficient != 0.0)
    {
        draft.notes.push("not kept: curve_coeff_0, curve_coeff_1, curve_coeff_2".to_owned());
    }
    Ok(draft)
}
